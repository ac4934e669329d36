// Colours of the page: Okabe and Ito's, which people with any colour vision distinguish; form differs as well (docs/gui.md).

export type Theme = "dark" | "light";

const pairs = {
  background: ["#12161c", "#ffffff"],
  panel: ["#1b2129", "#f2f4f7"],
  text: ["#e6eaf0", "#1a1f26"],
  dim: ["#a3adba", "#4f5965"],
  grid: ["#2a323c", "#d5dae1"],
  memory: ["#56b4e9", "#0072b2"],
  observed: ["#f0e442", "#6f6200"],
  predicted: ["#cc79a7", "#a3457a"],
  matched: ["#00c391", "#00734f"],
  map: ["#8a94a3", "#5e6774"],
  estimate: ["#e69f00", "#8f5a00"],
  truth: ["#ffffff", "#000000"],
  odometry: ["#ee7733", "#b34700"],
  gaze: ["#f0e442", "#6f6200"],
  hypothesis: ["#cc79a7", "#a3457a"],
  primitive: ["#cbd95e", "#004d1f"],
  race: ["#b9a3ff", "#5b45b0"],
  bad: ["#ff8a4c", "#b34700"],
  warning: ["#e69f00", "#8f5a00"],
  good: ["#2fc99a", "#00734f"],
  selection: ["#ffd6ee", "#8a0050"],
} as const;

export type ColourName = keyof typeof pairs;

/** On an image, whatever the theme, the dark palette has the contrast. */
export function colour(name: ColourName, theme: Theme): string {
  return pairs[name][theme === "dark" ? 0 : 1];
}

const labelHues = [["#56b4e9", "#0072b2"], ["#e69f00", "#8f5a00"], ["#2fc99a", "#00734f"], ["#cc79a7", "#a3457a"], ["#f0e442", "#6f6200"],
  ["#ee7733", "#b34700"], ["#b9a3ff", "#5b45b0"], ["#d8dde4", "#4a525d"]] as const;

/** Eight hues in turn; labels come in the order in which they were met. */
export function labelColour(index: number, theme: Theme): string {
  return labelHues[index % labelHues.length]![theme === "dark" ? 0 : 1];
}

const viridis = [[68, 1, 84], [72, 40, 120], [62, 74, 137], [49, 104, 142], [38, 130, 142], [31, 158, 137], [53, 183, 121], [109, 205, 89],
  [180, 222, 44], [253, 231, 37]] as const;

/** Red, green, blue 0..1 of a value 0..1. */
export function heat(value: number): [number, number, number] {
  const x = Math.min(1, Math.max(0, value)) * (viridis.length - 1), i = Math.min(Math.floor(x), viridis.length - 2), s = x - i;
  const a = viridis[i]!, b = viridis[i + 1]!;
  return [(a[0] + s * (b[0] - a[0])) / 255, (a[1] + s * (b[1] - a[1])) / 255, (a[2] + s * (b[2] - a[2])) / 255];
}

export function rgb(hex: string): [number, number, number] {
  const n = parseInt(hex.slice(1), 16);
  return [(n >> 16 & 255) / 255, (n >> 8 & 255) / 255, (n & 255) / 255];
}
