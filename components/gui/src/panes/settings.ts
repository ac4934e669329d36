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
  private shown: number | null = null;
  private readonly undo = button("undo", "", () => void this.set(this.parameter.configured));

  /** @param apply sets the parameter; false when the component refused. */
  constructor(private parameter: Parameter, isViewer: boolean, private readonly apply: (value: number) => Promise<boolean>) {
    const p = parameter, attrs = {min: String(p.minimum), max: String(p.maximum)};
    for (const [name, value] of Object.entries({...attrs, step: String(p.whole ? 1 : (p.maximum - p.minimum) / 200), "aria-label": `${p.name} ${p.unit}`})) this.slider.setAttribute(name, value);
    for (const [name, value] of Object.entries({...attrs, step: p.whole ? "1" : "any", "aria-label": `${p.name} as a number`})) this.field.setAttribute(name, value);
    this.slider.disabled = this.field.disabled = isViewer;
    this.slider.addEventListener("input", () => { this.field.value = this.slider.value; });
    for (const input of [this.slider, this.field]) input.addEventListener("change", () => void this.set(input.valueAsNumber));
    this.element.title = p.description;
    this.element.append(// A long name breaks at its full stops.
    h("span", {class: "name"}, ...p.name.split(".").flatMap((part, i) => i === 0 ? [part] : [".", h("wbr"), part])), this.slider, this.field, h("span", {class: "unit", text: p.unit}),
      h("span", {class: "dim", text: `${p.minimum}..${p.maximum}`}), this.undo, h("p", {class: "dim", text: p.description}));
    this.show(parameter);
  }

  /** Takes what was read. The controls change only with the value: what is being typed stays. */
  show(parameter: Parameter): void {
    this.parameter = parameter;
    if (parameter.value !== this.shown) this.showValue();
    const isChanged = parameter.value !== parameter.configured;
    this.element.classList.toggle("changed", isChanged);
    this.undo.classList.toggle("hidden", !isChanged);
    this.undo.title = `back to ${parameter.configured}`;
  }

  private showValue(): void {
    this.shown = this.parameter.value;
    this.slider.value = this.field.value = String(this.shown);
  }

  private async set(value: number): Promise<void> {
    if (Number.isFinite(value) && !await this.apply(value)) this.showValue();
  }
}

export class SettingsPane extends Pane {
  private readonly list = h("div", {class: "settings"});
  private readonly summary = h("div", {class: "note", attrs: {role: "status"}});
  private rows = new Map<string, ParameterRow>();
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
    if (read !== this.reads) return;  // a later one overtook it
    this.parameters = found;
    this.draw();
  }

  private draw(): void {
    const changed = this.parameters.filter(p => p.value !== p.configured).length;
    say(this.summary, this.parameters.length === 0 ? "No component offers parameters." : `${this.parameters.length} parameters, ${changed} changed`);
    const shown = new Map<string, ParameterRow>();
    const wanted: (string | HTMLElement)[] = [];
    let component = "";
    for (const p of this.parameters) {
      const key = `${p.component} ${p.name} ${p.minimum} ${p.maximum}`;
      const row = this.rows.get(key) ?? new ParameterRow(p, this.store.config.viewer, value => this.set(p, value));
      row.show(p);
      shown.set(key, row);
      if (p.component !== component) wanted.push(component = p.component);
      wanted.push(row.element);
    }
    this.rows = shown;
    // An arrangement that already stands is not touched: moving a row would take its focus.
    const stands = [...this.list.children];
    if (stands.length === wanted.length && wanted.every((one, i) => typeof one === "string" ? stands[i]!.textContent === one : stands[i] === one)) return;
    this.list.replaceChildren(...wanted.map(one => typeof one === "string" ? h("h3", {text: one}) : one));
  }

  private async set(p: Parameter, value: number): Promise<boolean> {
    const isSet = await this.store.act(`${p.name} = ${value} ${p.unit}`, "setParameter", p.component, p.name, value);
    await this.read();
    return isSet;
  }

  private async undoAll(): Promise<void> {
    for (const p of this.parameters.filter(p => p.value !== p.configured)) await this.store.act(`${p.name} = ${p.configured}`, "setParameter", p.component, p.name, p.configured);
    await this.read();
  }
}
