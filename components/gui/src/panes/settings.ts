// Values that may change while components run, with their ranges; everything else is in the components' configuration, read-only.
import type {Parameter} from "../shared/state";
import type {Store} from "../state/store";
import {button, h, say} from "./dom";
import {Pane} from "./pane";

export class SettingsPane extends Pane {
  private readonly list = h("div", {class: "settings"});
  private readonly summary = h("div", {class: "note", attrs: {role: "status"}});
  private parameters: Parameter[] = [];

  constructor(store: Store) {
    super(store, "settings");
    let alive = "";
    this.follow(() => {
      const now = store.components.value.filter(c => c.alive).map(c => c.name).join();
      if (now === alive) return;
      alive = now;
      if (this.visible) void this.read();
    });
    this.element.append(h("div", {class: "toolbar"}, this.summary, button("read again", "ask all components for their parameters", () => void this.read()),
      button("undo all", "back to the configured values", () => void this.undoAll())), h("div", {class: "scroll", attrs: {tabindex: "0", role: "region", "aria-label": "parameters"}}, this.list));
  }

  protected override onVisible(): void { if (this.visible) void this.read(); }

  private async read(): Promise<void> {
    const found: Parameter[] = [];
    for (const {name, alive} of this.store.components.value) {
      if (!alive) continue;
      try {
        found.push(...await this.store.call<Parameter[]>("parameters", name));
      } catch {
        // A component of another version has no parameters.
      }
    }
    this.parameters = found;
    this.draw();
  }

  private draw(): void {
    const changed = this.parameters.filter(p => p.value !== p.configured).length;
    say(this.summary, this.parameters.length === 0 ? "No component offers parameters." : `${this.parameters.length} parameters, ${changed} changed`);
    const rows: HTMLElement[] = [];
    let component = "";
    for (const p of this.parameters) {
      if (p.component !== component) rows.push(h("h3", {text: component = p.component}));
      rows.push(this.row(p));
    }
    this.list.replaceChildren(...rows);
  }

  private row(p: Parameter): HTMLElement {
    const step = p.whole ? 1 : (p.maximum - p.minimum) / 200, attrs = {min: String(p.minimum), max: String(p.maximum), step: String(step), value: String(p.value)};
    const slider = h("input", {attrs: {type: "range", ...attrs, "aria-label": `${p.name} ${p.unit}`}});
    const field = h("input", {attrs: {type: "number", ...attrs, step: p.whole ? "1" : "any", "aria-label": `${p.name} as a number`}});
    slider.disabled = field.disabled = this.store.config.viewer;
    const set = async (value: number) => {
      if (!Number.isFinite(value)) return;
      if (await this.store.act(`${p.name} = ${value} ${p.unit}`, "setParameter", p.component, p.name, value)) p.value = value;
      this.draw();
    };
    slider.addEventListener("input", () => { field.value = slider.value; });
    slider.addEventListener("change", () => void set(slider.valueAsNumber));
    field.addEventListener("change", () => void set(field.valueAsNumber));
    return h("div", {class: `setting${p.value !== p.configured ? " changed" : ""}`, title: p.description}, h("span", {class: "name", text: p.name}), slider, field, h("span", {class: "unit", text: p.unit}),
      h("span", {class: "dim", text: `${p.minimum}..${p.maximum}`}), p.value !== p.configured ? button("undo", `back to ${p.configured}`, () => void set(p.configured)) : null,
      h("p", {class: "dim", text: p.description}));
  }

  private async undoAll(): Promise<void> {
    for (const p of this.parameters.filter(p => p.value !== p.configured)) await this.store.act(`${p.name} = ${p.configured}`, "setParameter", p.component, p.name, p.configured);
    await this.read();
  }
}
