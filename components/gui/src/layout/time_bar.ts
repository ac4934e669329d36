// The last 5 minutes as a bar: pause and scrub back; with a recording also the log, which seeks.
import {effect} from "@preact/signals-core";
import {nowMs} from "../shared/messages";
import {button, fixed, h, say} from "../panes/dom";
import type {Store} from "../state/store";

const spanMs = 300_000;

export class TimeBar {
  readonly element = h("footer", {class: "time-bar"});
  private readonly slider = h("input", {class: "ring", attrs: {type: "range", min: "-300", max: "0", step: "0.05", value: "0", "aria-label": "moment shown, seconds before now"}});
  private readonly marks = h("div", {class: "ring-marks"});
  private readonly text = h("span", {class: "time-text"});
  private readonly pause: HTMLButtonElement;
  private lastSeek = 0;

  constructor(private readonly store: Store) {
    this.pause = button("pause", "hold this moment (P)", () => this.togglePause());
    const live = button("live", "back to the present (L)", () => store.scrub(null));
    const box = h("div", {class: "ring-box"}, this.slider, this.marks);
    this.element.append(this.pause, button("-1", "one second back (,)", () => this.step(-1000)), button("+1", "one second on (.)", () => this.step(1000)), box, live, this.text);
    if (store.config.proxies.Replay) this.element.append(this.makeLog());
    this.slider.addEventListener("input", () => this.slide());
    effect(() => this.draw());
    window.addEventListener("keydown", event => {
      if ((event.target as HTMLElement).matches("input:not([type=range]), textarea, select") || event.ctrlKey || event.altKey || event.metaKey) return;
      if (event.key === "p") this.togglePause();
      else if (event.key === "l") store.scrub(null);
      else if (event.key === ",") this.step(-1000);
      else if (event.key === ".") this.step(1000);
    });
  }

  private togglePause(): void { this.store.scrub(this.store.past.value === null ? nowMs() - 1 : null); }

  private step(ms: number): void {
    const t = (this.store.past.value ?? nowMs()) + ms;
    this.store.scrub(t >= nowMs() ? null : this.held(t));
  }

  private held(t: number): number { return Math.max(t, this.store.timeline.value?.from ?? t); }

  private slide(): void {
    const before = this.slider.valueAsNumber * 1000;
    this.store.scrub(before > -50 ? null : this.held(nowMs() + before));
  }

  private draw(): void {
    const {timeline, past} = this.store, info = timeline.value;
    say(this.pause, past.value === null ? "pause" : "resume");
    if (!info) return say(this.text, "nothing held yet");
    if (document.activeElement !== this.slider || past.value === null) this.slider.value = String(past.value === null ? 0 : (past.value - info.to) / 1000);
    const share = Math.min(1, (info.to - info.from) / spanMs);
    this.slider.style.setProperty("--held", `${(100 * (1 - share)).toFixed(1)}%`);
    say(this.text, `${past.value === null ? "live" : `${fixed((past.value - info.to) / 1000, 1)} s`} \u00b7 holds ${fixed((info.to - info.from) / 1000, 0)} s, ${fixed(info.bytes / 1048576, 1)} of ${fixed(info.budget / 1048576, 0)} MB, old images ${fixed(info.oldRate, 1)}/s`);
    this.drawMarks(info.marks, info.to);
  }

  private drawMarks(marks: readonly {t: number; kind: string; text: string}[], to: number): void {
    while (this.marks.children.length > marks.length) this.marks.lastChild!.remove();
    marks.forEach((mark, i) => {
      let item = this.marks.children[i] as HTMLElement | undefined;
      if (!item) this.marks.append(item = h("span", {}));
      if (item.className !== `mark ${mark.kind}`) item.className = `mark ${mark.kind}`;
      item.title = mark.text;
      item.style.left = `${(100 * (1 + (mark.t - to) / spanMs)).toFixed(2)}%`;
    });
  }

  /** The recording: seeks on release, at most 5 times a second while dragging. */
  private makeLog(): HTMLElement {
    const slider = h("input", {class: "log-seek", attrs: {type: "range", min: "0", max: "1", step: "0.01", value: "0", "aria-label": "place in the recording, seconds"}}), text = h("span", {class: "time-text"});
    const seek = () => {
      const r = this.store.replay.value;
      if (r) void this.store.act(`replay at ${fixed(slider.valueAsNumber, 1)} s`, "seek", Math.round(r.firstUs + slider.valueAsNumber * 1e6));
    };
    slider.addEventListener("input", () => { if (performance.now() - this.lastSeek > 200) { this.lastSeek = performance.now(); seek(); } });
    slider.addEventListener("change", seek);
    effect(() => {
      const r = this.store.replay.value;
      if (!r) return;
      slider.max = String((r.lastUs - r.firstUs) / 1e6);
      if (document.activeElement !== slider || performance.now() - this.lastSeek > 1000) slider.value = String((r.stampUs - r.firstUs) / 1e6);
      say(text, `log ${fixed((r.stampUs - r.firstUs) / 1e6, 1)} of ${fixed((r.lastUs - r.firstUs) / 1e6, 1)} s`);
    });
    return h("div", {class: "log-box"}, slider, text);
  }
}
