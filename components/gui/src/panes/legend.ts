// What the colours of the scene mean: a scale for values, a list for labels, and the forms of the layers.
import {colour, labelColour} from "../shared/palette";
import type {ColourName, Theme} from "../shared/palette";
import {column, rowSize} from "../shared/state";
import type {HealthGrid, Moment} from "../shared/state";
import type {ColourBy, SceneOptions} from "../scene/content";
import {fixed, h} from "./dom";

type Form = "line" | "thin" | "dashed" | "dash-dot" | "ring" | "triangle" | "hollow" | "cross";
const signs: Record<Form, string> = {line: "\u2501", thin: "\u2500", dashed: "\u2505", "dash-dot": "\u2501\u00b7", ring: "\u25cb", triangle: "\u25b2", hollow: "\u25b3", cross: "\u271a"};

/** What each layer draws. */
export const layers: readonly {option: keyof SceneOptions; text: string; signs: readonly (readonly [ColourName, Form, string])[]}[] = [
  {option: "map", text: "map", signs: [["map", "line", "map"]]},
  {option: "memory", text: "memory", signs: [["memory", "line", "confirmed"], ["memory", "dashed", "not yet"], ["dim", "thin", "off floor"], ["selection", "line", "selected"]]},
  {option: "ellipses", text: "covariances", signs: [["dim", "ring", "2 sigma of an end"]]},
  {option: "primitives", text: "primitives", signs: [["primitive", "line", "shape"], ["hypothesis", "ring", "inferred corner"]]},
  {option: "attention", text: "attention", signs: [["gaze", "ring", "larger: more salient"]]},
  {option: "races", text: "races", signs: [["race", "hollow", "larger: healthier"]]},
  {option: "trails", text: "trajectories", signs: [["estimate", "triangle", "estimate"], ["odometry", "cross", "odometry"], ["truth", "hollow", "true"]]},
  {option: "frustum", text: "camera", signs: [["estimate", "line", "what it sees"]]},
];

/** The forms of one layer, for its entry in the menu. */
export function signsOf(option: keyof SceneOptions, theme: Theme): HTMLElement[] {
  return layers.find(l => l.option === option)!.signs.map(([name, form, text]) => {
    const sign = h("span", {class: "sign", text: signs[form]});
    sign.style.color = colour(name, theme);
    return h("span", {class: "dim"}, sign, ` ${text}`);
  });
}

/** A scale of values between two words, or a colour of its own. */
type Entry = {name: string; low: string; high: string} | {name: string; tint: string};

/** Over the scene, where its colours need words. */
export class Legend {
  readonly element = h("div", {class: "legend"});
  private shown = "";

  draw(by: ColourBy, grid: HealthGrid | null, moment: Moment, theme: Theme): void {
    const entries = [...entriesOf(by, moment, theme), ...(grid ? [{name: "health map", low: "0: nothing fits there", high: "1: all fits"}] : [])], key = JSON.stringify(entries);
    if (key === this.shown) return;
    this.shown = key;
    this.element.replaceChildren(...entries.map(entry => {
      if ("low" in entry) return h("div", {}, h("b", {text: entry.name}), ` ${entry.low} `, h("span", {class: "heat"}), ` ${entry.high}`);
      const sign = h("span", {class: "sign", text: signs.line});
      sign.style.color = entry.tint;
      return h("div", {}, sign, ` ${entry.name}`);
    }));
  }
}

function entriesOf(by: ColourBy, {memory}: Moment, theme: Theme): Entry[] {
  if (!memory) return [];
  switch (by) {
    case "label": return [...new Set(memory.labels)].sort((a, b) => a - b).map(label => ({name: memory.labelNames[label] ?? "", tint: labelColour(label, theme)}));
    case "life": {
      let most = 0;
      for (let i = 0; i < memory.ids.length; ++i) most = Math.max(most, memory.rows[i * rowSize + column.life]!);
      return [{name: "life", low: "0", high: fixed(most, 0)}];
    }
    case "age": return [{name: "last seen", low: "20 s ago", high: "now"}];
    case "uncertainty": return [{name: "sigma of an end", low: "0.2 m", high: "0"}];
    default: return [];
  }
}
