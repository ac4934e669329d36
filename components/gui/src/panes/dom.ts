// Elements without markup text: nothing that comes from the robot is ever read as HTML.
import type {LeaseInfo} from "../shared/state";

type Child = Node | string | null | undefined | false;
type Properties = {
  class?: string; text?: string; title?: string; id?: string; attrs?: Record<string, string>;
  on?: Partial<{[K in keyof HTMLElementEventMap]: (event: HTMLElementEventMap[K]) => void}>;
};

export function h<K extends keyof HTMLElementTagNameMap>(tag: K, properties: Properties = {}, ...children: Child[]): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  if (properties.class) element.className = properties.class;
  if (properties.text !== undefined) element.textContent = properties.text;
  if (properties.title) element.title = properties.title;
  if (properties.id) element.id = properties.id;
  for (const [name, value] of Object.entries(properties.attrs ?? {})) element.setAttribute(name, value);
  for (const [name, handler] of Object.entries(properties.on ?? {})) element.addEventListener(name, handler as EventListener);
  element.append(...children.filter((c): c is Node | string => c !== null && c !== undefined && c !== false));
  return element;
}

export function button(text: string, title: string, click: () => void, more = ""): HTMLButtonElement {
  return h("button", {class: `button ${more}`.trim(), text, title, attrs: {type: "button"}, on: {click}});
}

/** A button that stays pressed. */
export function toggle(text: string, title: string, on: boolean, change: (on: boolean) => void): HTMLButtonElement {
  const element: HTMLButtonElement = button(text, title, () => {
    const next = element.getAttribute("aria-pressed") !== "true";
    element.setAttribute("aria-pressed", String(next));
    change(next);
  }, "toggle");
  element.setAttribute("aria-pressed", String(on));
  return element;
}

export function select(label: string, options: readonly (readonly [string, string])[], value: string, change: (value: string) => void): HTMLSelectElement {
  const element = h("select", {attrs: {"aria-label": label}, title: label}, ...options.map(([v, text]) => h("option", {text, attrs: {value: v}})));
  element.value = value;
  element.addEventListener("change", () => change(element.value));
  return element;
}

/** A number that can be typed, with its label and unit. */
export function numberField(label: string, value: number, step: number, unit = ""): {element: HTMLElement; input: HTMLInputElement} {
  const input = h("input", {attrs: {type: "number", step: String(step), value: String(value), "aria-label": `${label}${unit ? ` in ${unit}` : ""}`}});
  return {element: h("label", {class: "number"}, h("span", {text: label}), input, unit ? h("span", {class: "unit", text: unit}) : null), input};
}

/** Replaces text only when it differs: a live region is not read again, and nothing is laid out anew. */
export function say(element: Element, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

export function fixed(value: number | undefined, digits: number): string {
  // A rounded zero has no sign.
  return value === undefined || !Number.isFinite(value) ? "-" : value.toFixed(digits).replace(/^-(0\.?0*)$/, "$1");
}

/** At most three decimals, and no more digits than the eye compares. */
export function readable(value: number): string {
  const size = Math.abs(value);
  return fixed(value, size >= 100 || Number.isInteger(value) ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : 3);
}

/** Who has the lease: a name that was given, else where the program calls from. */
export function holderOf(lease: LeaseInfo): string { return lease.implicit ? `a program at ${lease.client}` : lease.client; }

/** The time of the day here, as the components' own logs have it. */
export function clockText(us: number): string {
  // Digits of the second alone would be all that is written.
  return new Date(us / 1000).toLocaleTimeString("en-GB", {hour: "2-digit", minute: "2-digit", second: "2-digit", fractionalSecondDigits: 3});
}

export const degrees = (radians: number) => radians * 180 / Math.PI;

/** Hands the person a file, as a download of the browser. */
export function saveFile(name: string, content: Blob): void {
  const link = h("a", {attrs: {download: name}});
  link.href = URL.createObjectURL(content);
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

/** Asks the person for a file and reads it as text. */
export function fileButton(text: string, take: (content: string) => void): HTMLButtonElement {
  const input = h("input", {attrs: {type: "file", accept: ".json"}, on: {change: () => void input.files?.[0]?.text().then(take)}});
  return button(text, "", () => { input.value = ""; input.click(); });
}

/** Redraws at most once per animation frame, only when asked. */
export class Redraw {
  private asked = false;
  constructor(private readonly draw: () => void) {}
  ask = (): void => {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => {
      this.asked = false;
      this.draw();
    });
  };
}
