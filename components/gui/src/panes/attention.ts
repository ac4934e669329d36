// Where the camera looks and why: the state machine, the target, and the points that compete with their salience over time.
import {labelColour, colour} from "../shared/palette";
import type {AttentionPoint, GazeState} from "../shared/state";
import type {Store} from "../state/store";
import {button, degrees, fixed, h, Redraw, say, select} from "./dom";
import {Pane} from "./pane";

const states = ["Select", "Saccade", "Analyse", "Track"] as const;
const spanMs = 20_000;

export class AttentionPane extends Pane {
  private readonly machine = h("ol", {class: "machine", attrs: {"aria-label": "state of the gaze"}});
  private readonly target = h("div", {class: "note"});
  private readonly canvas = h("canvas", {class: "salience", attrs: {role: "img", "aria-label": "salience of each point over the last 20 s"}});
  private readonly queue = h("table", {class: "queue"});
  private readonly rows = h("tbody");
  private readonly redraw = new Redraw(() => this.draw());
  /** Salience of each point: t, value in turn. */
  private readonly traces = new Map<string, number[]>();
  private lastTrace = 0;
  private lastTable = 0;

  constructor(store: Store) {
    super(store, "attention");
    this.machine.append(...states.map(s => h("li", {text: s.toLowerCase()})));
    const bar = h("div", {class: "toolbar"}, this.machine);
    if (!store.config.viewer) {
      const mode = select("mode of the gaze", ["Attend", "Fixate", "Hold", "Off"].map(m => [m, `gaze: ${m.toLowerCase()}`] as const), "Attend",
        value => void store.act(`gaze mode ${value.toLowerCase()}`, "gazeMode", value));
      this.follow(() => { const m = store.moment.value.gaze?.mode; if (m && document.activeElement !== mode) mode.value = m; });
      bar.append(mode, button("attend", "salience decides again", () => void store.act("gaze attends", "gazeMode", "Attend")));
    }
    this.queue.append(h("thead", {}, h("tr", {}, h("th", {text: "kind"}), h("th", {text: "id"}), h("th", {text: "where"}), h("th", {text: "salience"}))), this.rows);
    this.element.append(bar, this.target, this.canvas, h("div", {class: "scroll", attrs: {tabindex: "0", role: "region", "aria-label": "points that compete"}}, this.queue));
    const observer = new ResizeObserver(this.redraw.ask);
    observer.observe(this.canvas);
    this.whenDone(() => observer.disconnect());
    this.follow(() => { const {gaze, live} = store.moment.value; if (gaze && live) this.trace(gaze); if (this.visible) this.redraw.ask(); });
  }

  protected override onVisible(): void { if (this.visible) this.redraw.ask(); }

  private trace(g: GazeState): void {
    if (g.t - this.lastTrace < 180) return;
    this.lastTrace = g.t;
    for (const p of g.points) {
      const key = `${p.kind} ${p.id}`, list = this.traces.get(key) ?? [];
      list.push(g.t, p.salience);
      this.traces.set(key, list);
    }
    for (const [key, list] of this.traces) {
      while (list.length > 0 && list[0]! < g.t - spanMs) list.splice(0, 2);
      if (list.length === 0) this.traces.delete(key);
    }
  }

  private draw(): void {
    const g = this.store.moment.value.gaze;
    if (!this.visible) return;
    this.machine.querySelectorAll("li").forEach((item, i) => {
      if (g?.state === states[i]) item.setAttribute("aria-current", "step");
      else item.removeAttribute("aria-current");
    });
    if (!g) {
      say(this.target, this.store.config.proxies.Gaze ? "no state of the gaze yet" : "this setup has no gaze");
      return;
    }
    say(this.target, `${g.target ? `looks at ${describePoint(g.target)}` : "no target"}; ${g.points.length} points compete; ${g.visits} visits, ${g.givenUp} given up`);
    this.drawTraces(g);
    if (performance.now() - this.lastTable < 250) return;
    this.lastTable = performance.now();
    const most = Math.max(1e-9, ...g.points.map(p => p.salience));
    const top = [...g.points].sort((a, b) => b.salience - a.salience).slice(0, 14);
    this.rows.replaceChildren(...top.map(p => {
      const bar = h("span", {class: "bar"});
      bar.style.width = `${Math.round(60 * p.salience / most)}px`;
      bar.style.background = labelColour(Math.abs(p.id) % 8, this.store.theme.value);
      return h("tr", {class: p.kind === "Client" ? "client" : ""}, h("td", {text: p.kind.toLowerCase()}), h("td", {text: String(p.id)}), h("td", {text: wherePoint(p)}),
        h("td", {}, bar, ` ${fixed(p.salience, 2)}`));
    }));
  }

  /** The chapter's figure: each point's salience grows until it is looked at. */
  private drawTraces(g: GazeState): void {
    const {clientWidth: w, clientHeight: hh} = this.canvas, ratio = Math.min(devicePixelRatio, 2), c = this.canvas.getContext("2d");
    if (!c || w === 0) return;
    if (this.canvas.width !== Math.round(w * ratio) || this.canvas.height !== Math.round(hh * ratio)) { this.canvas.width = Math.round(w * ratio); this.canvas.height = Math.round(hh * ratio); }
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    c.clearRect(0, 0, w, hh);
    const end = this.store.moment.value.live ? this.lastTrace : this.store.moment.value.t, left = 30, bottom = hh - 16;
    let most = 1e-6;
    for (const list of this.traces.values()) for (let i = 1; i < list.length; i += 2) most = Math.max(most, list[i]!);
    c.font = "11px system-ui, sans-serif";
    c.fillStyle = colour("dim", this.store.theme.value);
    c.strokeStyle = colour("grid", this.store.theme.value);
    c.fillText(most.toFixed(most < 10 ? 1 : 0), 0, 12);
    c.fillText("0", 18, bottom);
    c.strokeRect(left, 3, w - left - 2, bottom - 3);
    for (const s of [20, 10, 0]) c.fillText(s === 0 ? "now" : `-${s} s`, Math.min(w - 26, left + (w - left - 2) * (1 - s * 1000 / spanMs)), hh - 3);
    let i = 0;
    for (const [key, list] of this.traces) {
      const id = Number(key.split(" ")[1]), chosen = g.target !== null && key === `${g.target.kind} ${g.target.id}`;
      c.strokeStyle = labelColour(Math.abs(id) % 8, this.store.theme.value);
      c.lineWidth = chosen ? 3 : 1.2;
      c.setLineDash(i++ % 2 === 0 ? [] : [4, 2]);
      c.beginPath();
      for (let k = 0; k < list.length; k += 2) {
        const x = left + (w - left - 2) * (1 - (end - list[k]!) / spanMs), y = bottom - (bottom - 6) * list[k + 1]! / most;
        if (x < left) continue;
        if (k === 0) c.moveTo(x, y); else c.lineTo(x, y);
      }
      c.stroke();
    }
    c.setLineDash([]);
  }
}

function wherePoint(p: AttentionPoint): string {
  return p.isPlace ? `${p.x.toFixed(2)}, ${p.y.toFixed(2)} m` : `pan ${degrees(p.pan).toFixed(0)}, tilt ${degrees(p.tilt).toFixed(0)} deg`;
}

function describePoint(p: AttentionPoint): string {
  return `${p.kind.toLowerCase()} ${p.id} (${wherePoint(p)}), salience ${p.salience.toFixed(2)}`;
}
