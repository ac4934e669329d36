// All that is known of the element that was clicked, its history included.
import {colour} from "../shared/palette";
import {column, mapRowSize, rowSize} from "../shared/state";
import type {Moment} from "../shared/state";
import type {Selection, Store} from "../state/store";
import {button, degrees, fixed, h, say} from "./dom";
import {Pane} from "./pane";

export class DetailsPane extends Pane {
  private readonly title = h("b", {text: "nothing selected"});
  private readonly table = h("table", {class: "facts"});
  private readonly canvas = h("canvas", {class: "history", attrs: {role: "img", "aria-label": "life and salience of the selected segment over time"}});
  private lastHistory = 0;
  private lastFacts = "";

  constructor(store: Store) {
    super(store, "details");
    this.element.append(h("div", {class: "toolbar"}, this.title, button("clear", "select nothing", () => { store.selection.value = null; })),
      h("div", {class: "scroll", attrs: {tabindex: "0", role: "region", "aria-label": "selected element"}}, this.table, this.canvas));
    this.follow(() => { void [store.selection.value, store.moment.value]; this.draw(); });
  }

  protected override onVisible(): void { this.draw(); }

  private draw(): void {
    if (!this.visible) return;
    const {store} = this, s = store.selection.value;
    say(this.title, s ? `${s.kind} ${s.id}` : "Click an element of the scene.");
    const facts = s ? factsOf(s, store.moment.value, store) : [];
    const key = JSON.stringify(facts);
    if (key !== this.lastFacts) {
      this.lastFacts = key;
      this.table.replaceChildren(h("tbody", {}, ...facts.map(([name, value]) => h("tr", {}, h("th", {text: name}), h("td", {text: value})))));
    }
    this.canvas.classList.toggle("hidden", s?.kind !== "segment");
    if (s?.kind === "segment" && performance.now() - this.lastHistory > 3000) {
      this.lastHistory = performance.now();
      void this.drawHistory(s.id);
    }
  }

  private async drawHistory(id: number): Promise<void> {
    const values = await this.store.call<Float64Array>("historyOf", id), c = this.canvas.getContext("2d"), {clientWidth: w, clientHeight: hh} = this.canvas;
    if (!c || w === 0) return;
    const ratio = Math.min(devicePixelRatio, 2), n = values.length / 4, theme = this.store.theme.value;
    this.canvas.width = Math.round(w * ratio);
    this.canvas.height = Math.round(hh * ratio);
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    c.font = "11px system-ui, sans-serif";
    if (n < 2) return;
    const from = values[0]!, to = values[(n - 1) * 4]!;
    for (const [k, name, tint] of [[1, "life", "memory"], [2, "salience", "gaze"], [3, "length", "matched"]] as const) {
      let most = 1e-9;
      for (let i = 0; i < n; ++i) most = Math.max(most, values[i * 4 + k]!);
      c.strokeStyle = c.fillStyle = colour(tint, theme);
      c.fillText(`${name} up to ${most.toPrecision(3)}`, 4 + (k - 1) * w / 3, 11);
      c.beginPath();
      for (let i = 0; i < n; ++i) {
        const x = (values[i * 4]! - from) / Math.max(1, to - from) * (w - 4) + 2, y = hh - 4 - (hh - 22) * values[i * 4 + k]! / most;
        if (i === 0) c.moveTo(x, y); else c.lineTo(x, y);
      }
      c.stroke();
    }
  }
}

function factsOf(s: Selection, m: Moment, store: Store): [string, string][] {
  switch (s.kind) {
    case "segment": return segmentFacts(s.id, m);
    case "primitive": {
      const p = m.memory?.primitives.find(q => q.id === s.id);
      return p ? [["shape", p.kind], ["centre", `${fixed(p.x, 3)}, ${fixed(p.y, 3)} m (odom)`], ["heading", `${fixed(degrees(p.heading), 1)} deg`], ["length, width, radius", `${fixed(p.lengthM, 3)}, ${fixed(p.widthM, 3)}, ${fixed(p.radiusM, 3)} m`],
        ["quality", fixed(p.quality, 2)], ["life", fixed(p.life, 1)], ["salience", fixed(p.salience, 2)], ["hidden corner", p.hiddenVertex < 0 ? "none" : String(p.hiddenVertex)], ["segments", p.segments.join(", ")]] : [["gone", "not in this moment"]];
    }
    case "race": {
      const r = m.estimate?.races.find(q => q.id === s.id);
      return r ? [["pose", `${fixed(r.pose.x, 3)}, ${fixed(r.pose.y, 3)} m, ${fixed(degrees(r.pose.theta), 1)} deg`], ["health", fixed(r.health, 3)], ["weight", fixed(r.weight, 3)], ["victories", String(r.victories)], ["age", `${r.age} iterations`], ["winner", r.winner ? "yes" : "no"]] : [["gone", "this race ended"]];
    }
    case "attention": {
      const p = m.gaze?.points.find(q => q.id === s.id);
      return p ? [["kind", p.kind], ["salience", fixed(p.salience, 3)], ["where", p.isPlace ? `${fixed(p.x, 3)}, ${fixed(p.y, 3)}, ${fixed(p.z, 3)} m (odom)` : `pan ${fixed(degrees(p.pan), 1)}, tilt ${fixed(degrees(p.tilt), 1)} deg`]] : [["gone", "it competes no more"]];
    }
    case "map": {
      const map = store.map.value, k = s.id * mapRowSize;
      if (!map) return [];
      const r = map.rows;
      return [["label", map.labels[r[k + 7]!] ?? ""], ["from", `${fixed(r[k], 3)}, ${fixed(r[k + 1], 3)}, ${fixed(r[k + 2], 3)} m (map)`], ["to", `${fixed(r[k + 3], 3)}, ${fixed(r[k + 4], 3)}, ${fixed(r[k + 5], 3)} m`], ["length", `${fixed(Math.hypot(r[k + 3]! - r[k]!, r[k + 4]! - r[k + 1]!, r[k + 5]! - r[k + 2]!), 3)} m`], ["width", r[k + 6]! > 0 ? `${fixed(r[k + 6], 3)} m` : "an edge"], ["map", map.name]];
    }
  }
}

/** By the value of `ground`. */
const groundNames = ["not confirmed yet", "confirmed from a second viewpoint", "off the floor, or it moves by itself"];

function segmentFacts(id: number, m: Moment): [string, string][] {
  const memory = m.memory, i = memory ? memory.ids.indexOf(id) : -1;
  if (!memory || i < 0) return [["gone", "not in this moment"]];
  const r = memory.rows.subarray(i * rowSize, (i + 1) * rowSize), sigma = (at: number) => Math.sqrt(Math.max(0, r[at]! + r[at + 3]!));
  const now = (memory.stampUs - memory.stampBaseUs) / 1e6;
  return [["label", memory.labelNames[memory.labels[i]!] ?? ""], ["state", groundNames[memory.ground[i]!]!],
    ["ends (odom)", `${fixed(r[0], 3)}, ${fixed(r[1], 3)} to ${fixed(r[3], 3)}, ${fixed(r[4], 3)} m`], ["length", `${fixed(Math.hypot(r[3]! - r[0]!, r[4]! - r[1]!), 3)} m`],
    ["sigma of the ends", `${fixed(sigma(column.covA), 3)}, ${fixed(sigma(column.covB), 3)} m`], ["life", fixed(r[column.life], 1)], ["salience", fixed(r[column.salience], 2)],
    ["first seen", `${fixed(now - r[column.firstSeen]!, 1)} s ago`], ["last seen", `${fixed(now - r[column.lastSeen]!, 1)} s ago`]];
}
