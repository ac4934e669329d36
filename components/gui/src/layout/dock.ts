// Panes in dockable groups: presets, a layout that is kept, and a menu that moves panes without a pointer.
import {createDockview} from "dockview-core";
import type {AddPanelOptions, DockviewApi, IContentRenderer, IDockviewPanel, ITabRenderer} from "dockview-core";
import type {Pane} from "../panes/pane";
import {partOf, shapeOf} from "./presets";
import type {Part, PresetName, Shape} from "./presets";

export type PaneMaker = () => Pane;
export type MoveTo = "left" | "right" | "above" | "below" | "within";

class Content implements IContentRenderer {
  readonly element = document.createElement("div");
  constructor(readonly pane: Pane) {
    this.element.className = "pane-host";
    this.element.append(pane.element);
  }
  init(parameters: {api: {isVisible: boolean; onDidVisibilityChange: (use: (e: {isVisible: boolean}) => void) => void}}): void {
    parameters.api.onDidVisibilityChange(e => this.pane.setVisible(e.isVisible));
    this.pane.setVisible(parameters.api.isVisible);
  }
}

/** A tab with its title alone: a button to close it inside of it could not be told apart by a screen reader. */
class Tab implements ITabRenderer {
  readonly element = document.createElement("span");
  init(parameters: {title: string}): void {
    this.element.className = "tab-title";
    this.element.textContent = parameters.title;
  }
}

export class Dock {
  private readonly api: DockviewApi;
  /** A pane lives as long as the page: the camera's canvas belongs to the worker and cannot be made again. */
  private readonly contents = new Map<string, Content>();
  private preset: PresetName = "watch";
  private shape: Shape = "wide";
  private saving = true;

  constructor(private readonly host: HTMLElement, private readonly makers: Record<string, PaneMaker>, private readonly titles: Record<string, string>) {
    this.api = createDockview(host, {
      createComponent: options => this.contentOf(options.name),
      createTabComponent: () => new Tab(),
      defaultTabComponent: "plain",
      theme: {name: "avm", className: "dockview-theme-avm", gap: 4},
      disableFloatingGroups: true,
      defaultRenderer: "always",
    });
    this.api.onDidLayoutChange(() => this.keep());
    matchMedia("(orientation: landscape)").addEventListener("change", () => setTimeout(() => this.turned(), 200));
  }

  private contentOf(name: string): Content {
    let content = this.contents.get(name);
    if (!content) {
      const make = this.makers[name];
      if (!make) throw new Error(`no pane ${name}`);
      this.contents.set(name, content = new Content(make()));
    }
    return content;
  }

  private key(): string { return `avm.layout.${this.preset}.${this.shape}`; }

  /** A telephone that is turned gets the arrangement of its other shape, but not while somebody types: a keyboard on the screen takes height, too. */
  private turned(): void {
    if (shapeOf(this.host.clientWidth, this.host.clientHeight) !== this.shape && !document.activeElement?.matches("input, textarea, select")) this.load(this.preset);
  }

  /** The kept layout of a preset, else the preset as it is. */
  load(preset: PresetName, anew = false): void {
    this.preset = preset;
    this.shape = shapeOf(this.host.clientWidth, this.host.clientHeight);
    this.saving = false;
    if (anew) localStorage.removeItem(this.key());
    const kept = localStorage.getItem(this.key());
    try {
      if (!kept) throw new Error("none kept");
      this.api.fromJSON(JSON.parse(kept) as Parameters<DockviewApi["fromJSON"]>[0]);
    } catch {
      this.api.clear();
      // The first load comes before dockview has seen its own size: shares of nothing would become halves.
      this.api.layout(this.host.clientWidth, this.host.clientHeight);
      const part = partOf(preset, this.shape);
      this.build(part, null, undefined);
      this.resize(part, this.host.clientWidth, this.host.clientHeight);
    }
    setTimeout(() => { this.saving = true; }, 300);
  }

  /** @return the first panel of the part. */
  private build(part: Part, beside: IDockviewPanel | null, direction: "right" | "below" | undefined): IDockviewPanel {
    if ("tabs" in part) {
      let first: IDockviewPanel | null = null;
      for (const name of part.tabs) {
        const options: AddPanelOptions = {id: name, component: name, title: this.titles[name] ?? name, inactive: first !== null};
        if (first) options.position = {referencePanel: first, direction: "within"};
        else if (beside && direction) options.position = {referencePanel: beside, direction};
        const panel: IDockviewPanel = this.api.addPanel(options);
        first ??= panel;
      }
      return first!;
    }
    // The first leaves of all parts are placed before any part is divided further.
    const firsts: IDockviewPanel[] = [];
    const leaf = (p: Part): Part => "tabs" in p ? p : leaf(p.parts[0]!);
    part.parts.forEach((p, i) => firsts.push(this.build(leaf(p), i === 0 ? beside : firsts[i - 1]!, i === 0 ? direction : part.split === "row" ? "right" : "below")));
    part.parts.forEach((p, i) => this.divide(p, firsts[i]!));
    return firsts[0]!;
  }

  /** Adds what a part has beside its first leaf, which stands already. */
  private divide(part: Part, first: IDockviewPanel): void {
    if ("tabs" in part) return;
    this.divide(part.parts[0]!, first);
    let last = first;
    for (const p of part.parts.slice(1)) {
      const leaf = (q: Part): Part => "tabs" in q ? q : leaf(q.parts[0]!);
      last = this.build(leaf(p), last, part.split === "row" ? "right" : "below");
      this.divide(p, last);
    }
  }

  private resize(part: Part, width: number, height: number): void {
    if ("tabs" in part) {
      const panel = this.api.getPanel(part.tabs[0]!);
      panel?.api.group.api.setSize({width: Math.round(width), height: Math.round(height)});
      return;
    }
    const total = part.parts.reduce((sum, p) => sum + p.size, 0);
    for (const p of part.parts) this.resize(p, part.split === "row" ? width * p.size / total : width, part.split === "column" ? height * p.size / total : height);
  }

  private keep(): void {
    if (!this.saving) return;
    localStorage.setItem(this.key(), JSON.stringify(this.api.toJSON()));
  }

  show(name: string): void {
    const panel = this.api.getPanel(name) ?? this.api.addPanel({id: name, component: name, title: this.titles[name] ?? name});
    panel.api.setActive();
  }

  /** Moves a pane beside, or into the group of, another one. */
  move(name: string, to: MoveTo, other: string): void {
    const panel = this.api.getPanel(name), target = this.api.getPanel(other);
    if (!panel || !target || name === other) return;
    const position = ({left: "left", right: "right", above: "top", below: "bottom", within: "center"} as const)[to];
    panel.api.moveTo({group: target.api.group, position});
  }
}
