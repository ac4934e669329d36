// Values that may change while components run, with their ranges; everything else is in the components' configuration, read-only.
import type {Parameter} from "../shared/state";
import type {Store} from "../state/store";
import {button, h, say} from "./dom";
import {Pane} from "./pane";

/** Row of one parameter. It stays on the page while values change, so that a value that is being typed is kept. */
class ParameterRow {
  readonly element = h("div", {class: "setting"});
  private readonly slider = h("input", {attrs: {type: "range"}});
  private readonly field = h("input", {attrs: {type: "number"}});
  private readonly undo = button("undo", "", () => this.set(this.parameter.configured));

  constructor(private parameter: Parameter, isViewer: boolean, private readonly set: (value: number) => void) {
    const p = parameter, attrs = {min: String(p.minimum), max: String(p.maximum)};
    for (const [name, value] of Object.entries({...attrs, step: String(p.whole ? 1 : (p.maximum - p.minimum) / 200), "aria-label": `${p.name} ${p.unit}`})) this.slider.setAttribute(name, value);
    for (const [name, value] of Object.entries({...attrs, step: p.whole ? "1" : "any", "aria-label": `${p.name} as a number`})) this.field.setAttribute(name, value);
    this.slider.disabled = this.field.disabled = isViewer;
    this.slider.addEventListener("input", () => { this.field.value = this.slider.value; });
    for (const input of [this.slider, this.field]) input.addEventListener("change", () => { if (Number.isFinite(input.valueAsNumber)) this.set(input.valueAsNumber); });
    this.element.title = p.description;
    this.element.append(h("span", {class: "name", text: p.name}), this.slider, this.field, h("span", {class: "unit", text: p.unit}),
      h("span", {class: "dim", text: `${p.minimum}..${p.maximum}`}), this.undo, h("p", {class: "dim", text: p.description}));
    this.show(parameter);
  }

  /** Shows a value that was read. A control shows it only if its value differs from the one shown before. */
  show(parameter: Parameter): void {
    const isNew = this.field.value === "" || parameter.value !== this.parameter.value;
    this.parameter = parameter;
    if (isNew) this.slider.value = this.field.value = String(parameter.value);
    const isChanged = parameter.value !== parameter.configured;
    this.element.classList.toggle("changed", isChanged);
    this.undo.hidden = !isChanged;
    this.undo.title = `back to ${parameter.configured}`;
  }
}

export class SettingsPane extends Pane {
  private readonly list = h("div", {class: "settings"});
  private readonly summary = h("div", {class: "note", attrs: {role: "status"}});
  private readonly rows = new Map<string, ParameterRow>();
  private parameters: Parameter[] = [];
  private reads = 0;

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
    const read = ++this.reads, found: Parameter[] = [];
    for (const {name, alive} of this.store.components.value) {
      if (!alive) continue;
      try {
        found.push(...await this.store.call<Parameter[]>("parameters", name));
      } catch {
        // A component of another version has no parameters.
      }
    }
    if (read !== this.reads) return;  // a later read or a change overtook this one
    this.parameters = found;
    this.draw();
  }

  private draw(): void {
    const changed = this.parameters.filter(p => p.value !== p.configured).length;
    say(this.summary, this.parameters.length === 0 ? "No component offers parameters." : `${this.parameters.length} parameters, ${changed} changed`);
    const shown: string[] = [];
    for (const p of this.parameters) {
      const key = `${p.component} ${p.name} ${p.minimum} ${p.maximum}`;
      shown.push(key);
      const row = this.rows.get(key);
      if (row) row.show(p);
      else this.rows.set(key, new ParameterRow(p, this.store.config.viewer, value => void this.set(p.component, p.name, value)));
    }
    for (const key of this.rows.keys()) if (!shown.includes(key)) this.rows.delete(key);
    this.arrange();
  }

  /** Puts the rows below the names of their components. An arrangement that already stands is not touched: moving a row would take its focus. */
  private arrange(): void {
    const wanted: (string | HTMLElement)[] = [];
    let component = "";
    for (const [i, row] of [...this.rows.values()].entries()) {
      const p = this.parameters[i]!;
      if (p.component !== component) wanted.push(component = p.component);
      wanted.push(row.element);
    }
    const stands = [...this.list.children];
    if (stands.length === wanted.length && wanted.every((one, i) => typeof one === "string" ? stands[i]!.textContent === one : stands[i] === one)) return;
    this.list.replaceChildren(...wanted.map(one => typeof one === "string" ? h("h3", {text: one}) : one));
  }

  private async set(component: string, name: string, value: number): Promise<void> {
    const p = this.parameters.find(one => one.component === component && one.name === name);
    if (!p) return;
    ++this.reads;
    if (await this.store.act(`${name} = ${value} ${p.unit}`, "setParameter", component, name, value)) p.value = value;
    this.draw();
  }

  private async undoAll(): Promise<void> {
    for (const p of this.parameters.filter(p => p.value !== p.configured)) await this.store.act(`${p.name} = ${p.configured}`, "setParameter", p.component, p.name, p.configured);
    await this.read();
  }
}
