// Where panes stand: three presets, each for a wide and a narrow page. Names of panes are those of panes/*.ts.

export type PresetName = "watch" | "tune" | "replay";
export const presetNames: readonly PresetName[] = ["watch", "tune", "replay"];

/** A tree: a list of tabs, or a split of parts with shares of the space. */
export type Part = {tabs: string[]; size: number} | {split: "row" | "column"; parts: Part[]; size: number};

const tabs = (size: number, ...names: string[]): Part => ({tabs: names, size});
const row = (size: number, ...parts: Part[]): Part => ({split: "row", parts, size});
const column = (size: number, ...parts: Part[]): Part => ({split: "column", parts, size});

const wide: Record<PresetName, Part> = {
  watch: row(1, column(0.42, tabs(0.56, "camera"), tabs(0.44, "why", "attention", "drive", "actions")), column(0.58, tabs(0.57, "world"), tabs(0.43, "plots", "details", "components", "log", "settings"))),
  tune: row(1, column(0.4, tabs(0.5, "camera"), tabs(0.5, "settings", "actions", "drive")), column(0.6, tabs(0.5, "plots", "world"), tabs(0.5, "components", "log", "attention", "details", "why"))),
  replay: row(1, column(0.42, tabs(0.55, "camera"), tabs(0.45, "actions", "why", "attention", "settings", "drive")), column(0.58, tabs(0.57, "world"), tabs(0.43, "plots", "log", "details", "components"))),
};

// Nobody drives blind: the camera shares its tabs with nothing that is driven by.
const narrow: Record<PresetName, Part> = {
  watch: column(1, tabs(0.5, "camera"), tabs(0.5, "world", "why", "drive", "actions", "plots", "attention", "details", "components", "log", "settings")),
  tune: column(1, tabs(0.4, "camera", "plots"), tabs(0.6, "settings", "components", "log", "world", "attention", "details", "why", "actions", "drive")),
  replay: column(1, tabs(0.5, "camera", "actions"), tabs(0.5, "world", "plots", "log", "why", "attention", "details", "components", "settings", "drive")),
};

/** flat: a telephone held across, where panes one below the other would have no height. */
export type Shape = "wide" | "narrow" | "flat";

export function shapeOf(width: number, height: number): Shape { return width >= 900 ? "wide" : width > 1.5 * height ? "flat" : "narrow"; }

export function partOf(preset: PresetName, shape: Shape): Part {
  const part = (shape === "wide" ? wide : narrow)[preset];
  return shape === "flat" && "split" in part ? {...part, split: "row"} : part;
}
