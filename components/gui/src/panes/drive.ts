// Drives the base: keys, the stick on the screen, a gamepad. The robot moves only while something is held and this pane has the focus.
import {driveKeys, speedsOf} from "../drive/keys";
import {nowMs} from "../shared/messages";
import type {Store} from "../state/store";
import {button, degrees, fixed, h, holderOf, say} from "./dom";
import {Pane} from "./pane";

const reportEveryMs = 50;

export class DrivePane extends Pane {
  private readonly held = new Set<string>();
  private stick: {v: number; w: number} | null = null;
  private readonly knob = h("div", {class: "knob"});
  private readonly pad = h("div", {class: "stick", attrs: {"aria-hidden": "true"}}, this.knob);
  private readonly status = h("div", {class: "note", attrs: {role: "status"}});
  private readonly surface = h("div", {class: "drive-surface", attrs: {tabindex: "0", role: "application", "aria-label": "drive: hold W A S D or the arrow keys"}});
  private readonly speed = h("input", {attrs: {type: "range", min: "0.05", max: "0.6", step: "0.05", value: "0.3", "aria-label": "speed in metres per second"}});
  private readonly speedText = h("span", {class: "unit"});
  private reporting = false;
  /** After a loss of focus and the like everything must be let go first. */
  private disarmed = false;
  private gamepadHeld = false;

  constructor(store: Store) {
    super(store, "drive");
    const {surface} = this;
    surface.append(this.pad, h("div", {class: "drive-help"}, h("b", {text: "hold to drive"}), h("span", {class: "dim", text: "W A S D or arrows here, the stick, or a gamepad with its trigger"}), this.status));
    this.element.append(h("div", {class: "toolbar"}, h("label", {class: "check"}, "speed", this.speed, this.speedText), button("take over", "ends another operator's lease: STOP, then drive", () => void store.stop())), surface);
    this.speed.addEventListener("input", () => this.drawSpeed());
    this.drawSpeed();
    surface.addEventListener("keydown", event => this.keyDown(event));
    surface.addEventListener("keyup", event => { this.held.delete(event.code); if (this.held.size === 0) this.disarmed = false; this.report(); });
    this.listenToStick();
    const drop = (why: string) => () => this.letGo(why);
    const lost = {blur: "the window lost the focus", pagehide: "the page is left", freeze: "the page is frozen"};
    for (const [name, why] of Object.entries(lost)) window.addEventListener(name, drop(why));
    surface.addEventListener("blur", drop("the drive pane lost the focus"));
    document.addEventListener("visibilitychange", () => { if (document.hidden) this.letGo("the tab is hidden"); });
    window.addEventListener("gamepaddisconnected", drop("the gamepad is gone"));
    const timer = setInterval(() => this.tick(), reportEveryMs);
    this.whenDone(() => clearInterval(timer));
    this.follow(() => { if (store.past.value !== null) this.letGo("a moment of the past is shown"); });
    this.follow(() => this.drawStatus());
  }

  protected override onVisible(): void { if (!this.visible) this.letGo("the drive pane is hidden"); }

  private keyDown(event: KeyboardEvent): void {
    // Repeats say nothing new; with a modifier the release may get lost.
    if (!driveKeys.has(event.code) || event.isComposing || event.altKey || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    if (event.repeat || this.disarmed) return;
    this.held.add(event.code);
    this.report();
  }

  private listenToStick(): void {
    const {pad} = this;
    const move = (event: PointerEvent) => {
      const box = pad.getBoundingClientRect(), r = box.width / 2;
      const x = (event.clientX - box.left - r) / r, y = (event.clientY - box.top - r) / r, n = Math.max(1, Math.hypot(x, y));
      this.stick = {v: -y / n, w: -x / n};
      this.knob.style.transform = `translate(${x / n * r * 0.7}px, ${y / n * r * 0.7}px)`;
      this.report();
    };
    const end = () => {
      this.stick = null;
      this.disarmed = false;
      this.knob.style.transform = "";
      this.report();
    };
    pad.addEventListener("pointerdown", event => { pad.setPointerCapture(event.pointerId); this.surface.focus(); this.disarmed = false; move(event); });
    pad.addEventListener("pointermove", event => { if (this.stick) move(event); });
    for (const name of ["pointerup", "pointercancel", "lostpointercapture"] as const) pad.addEventListener(name, end);
  }

  /** Stick of the first gamepad, while its lower right trigger is pressed. */
  private gamepad(): {v: number; w: number} | null {
    const pad = navigator.getGamepads?.().find(g => g?.connected);
    this.gamepadHeld = (pad?.buttons[7]?.value ?? 0) > 0.3;
    if (!pad || !this.gamepadHeld || !document.hasFocus()) return null;
    const dead = (x: number) => Math.abs(x) < 0.1 ? 0 : x;
    return {v: -dead(pad.axes[1] ?? 0), w: -dead(pad.axes[0] ?? 0)};
  }

  private intent(): {held: boolean; v: number; w: number} {
    const gamepad = this.gamepad(), shares = this.stick ?? gamepad ?? speedsOf(this.held), limit = this.speed.valueAsNumber;
    const held = !this.disarmed && (this.stick !== null || gamepad !== null || this.held.size > 0);
    return {held, v: shares.v * limit, w: shares.w * Math.min(1.2, limit * 3)};
  }

  private tick(): void {
    if (this.intent().held || this.reporting) this.report();
  }

  private report(): void {
    const intent = this.intent();
    if (!intent.held && !this.reporting) return;
    this.reporting = intent.held;
    this.store.send({kind: "drive", ...intent, sentMs: nowMs()});
    this.surface.classList.toggle("driving", intent.held);
  }

  private letGo(why: string): void {
    if (!this.intent().held) return;
    this.held.clear();
    this.stick = null;
    this.disarmed = true;
    this.knob.style.transform = "";
    this.report();
    // Keys that are released elsewhere send no keyup here: a new press counts.
    this.disarmed = false;
    this.store.driving.value = {active: false, why};
  }

  private drawSpeed(): void { say(this.speedText, `${fixed(this.speed.valueAsNumber, 2)} m/s`); }

  private drawStatus(): void {
    const {store} = this, d = store.driving.value, o = store.moment.value.odometry, lease = store.lease.value;
    const who = lease?.held && !lease.mine ? ` ${holderOf(lease)} drives.` : "";
    say(this.status, `${d.active ? "driving" : d.why ? `stopped here: ${d.why}` : "not driven from here"}${o ? `, ${fixed(o.v, 2)} m/s, ${fixed(degrees(o.w), 0)} deg/s` : ""}.${who}`);
  }
}
