// The processes of the robot: state, peers, rates, latencies, gauges, errors, configuration.
import {nowMs} from "../shared/messages";
import type {ComponentInfo} from "../shared/state";
import type {Store} from "../state/store";
import {isSilent} from "../why/rules";
import {button, clockText, fixed, h, readable, say} from "./dom";
import {Pane} from "./pane";

/** One process. Its elements stay, so that what is clicked or read is not replaced under the hand. */
class Card {
  readonly details = h("details", {class: "component"});
  private readonly state = h("span");
  private readonly numbers = h("span", {class: "dim"});
  private readonly body = h("div");
  private info: ComponentInfo | null = null;
  private shown = "";

  constructor(name: string, private readonly tables: (c: ComponentInfo) => HTMLElement[], showConfiguration: () => void) {
    this.details.dataset.component = name;
    this.details.append(h("summary", {}, h("b", {text: name}), this.state, this.numbers), this.body,
      button("configuration", `every key of ${name} with its value`, showConfiguration));
    this.details.addEventListener("toggle", () => this.drawBody());
  }

  draw(c: ComponentInfo): void {
    this.info = c;
    const level = !c.alive ? "bad" : c.state === "Running" ? "good" : "warning", cpu = c.gauges.find(g => g.name === "cpu");
    this.state.className = `state ${level}`;
    this.details.dataset.alive = String(c.alive);
    say(this.state, !c.alive ? `${isSilent(c) ? "silent" : "gone"} for ${((nowMs() - c.since) / 1000).toFixed(0)} s: ${c.message}` : c.state.toLowerCase() + (c.reason ? `: ${c.reason}` : ""));
    say(this.numbers, c.alive ? `${cpu ? `${fixed(cpu.value, 0)} % cpu, ` : ""}${c.rates.map(r => `${r.name} ${fixed(r.hz, 1)}/s`).join(", ")}` : "");
    this.drawBody();
  }

  private drawBody(): void {
    if (!this.details.open || !this.info) return;
    const tables = this.tables(this.info), key = tables.map(t => t.textContent).join();
    if (key === this.shown) return;
    this.shown = key;
    this.body.replaceChildren(...tables);
  }
}

export class ComponentsPane extends Pane {
  private readonly list = h("div", {class: "components"});
  private readonly configuration = h("div", {class: "configuration hidden"});
  private readonly cards = new Map<string, Card>();

  constructor(store: Store) {
    super(store, "components");
    this.element.append(h("div", {class: "scroll", attrs: {tabindex: "0", role: "region", "aria-label": "components"}}, this.list, this.configuration));
    this.follow(() => { void store.components.value; this.draw(); });
  }

  protected override onVisible(): void { this.draw(); }

  private draw(): void {
    if (!this.visible) return;
    for (const c of this.store.components.value) {
      let card = this.cards.get(c.name);
      if (!card) {
        this.cards.set(c.name, card = new Card(c.name, info => this.tables(info), () => void this.showConfiguration(c.name)));
        this.list.append(card.details);
      }
      card.draw(c);
    }
  }

  private tables(c: ComponentInfo): HTMLElement[] {
    const table = (heads: string[], rows: string[][]) => rows.length === 0 ? null : h("table", {}, h("thead", {}, h("tr", {}, ...heads.map(t => h("th", {text: t})))),
      h("tbody", {}, ...rows.map(r => h("tr", {}, ...r.map(t => h("td", {text: t}))))));
    return [
      table(["peer", "state", "at"], c.peers.map(p => [p.name, p.connected ? "connected" : p.message || "away", p.proxy])),
      table(["latency", "p50 ms", "p95", "p99", "max"], c.latencies.map(l => [l.name, fixed(l.p50, 1), fixed(l.p95, 1), fixed(l.p99, 1), fixed(l.max, 1)])),
      table(["gauge", "value", "sigma"], c.gauges.map(g => [g.name, `${readable(g.value)} ${g.unit}`, g.sigma > 0 ? readable(g.sigma) : ""])),
      table(["error", ""], c.errors.slice(-5).map(e => [clockText(e.stampUs), e.text])),
    ].filter((t): t is HTMLTableElement => t !== null);
  }

  private async showConfiguration(name: string): Promise<void> {
    try {
      const settings = await this.store.call<[string, string][]>("configuration", name);
      this.configuration.classList.remove("hidden");
      this.configuration.replaceChildren(h("div", {class: "toolbar"}, h("b", {text: `${name}: effective configuration`}), button("close", "", () => this.configuration.classList.add("hidden"))),
        h("table", {}, h("tbody", {}, ...settings.map(([key, value]) => h("tr", {}, h("td", {text: key}), h("td", {text: value}))))));
      // It stands below all components.
      this.configuration.scrollIntoView();
    } catch (failure) {
      this.store.say("bad", `configuration of ${name}: ${(failure as Error).message}`);
    }
  }
}
