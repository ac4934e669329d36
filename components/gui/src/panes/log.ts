// Messages of all components with a filter.
import type {LogLine} from "../shared/state";
import type {Store} from "../state/store";
import {button, clockText, h, select} from "./dom";
import {Pane} from "./pane";

const order = ["Debug", "Info", "Warning", "Error"];

export class LogPane extends Pane {
  private readonly body = h("div", {class: "log scroll", attrs: {tabindex: "0", role: "log", "aria-label": "messages of the components"}});
  private lowest = "Info";
  private text = "";
  private drawn: LogLine[] = [];
  /** The newest message is shown, until somebody scrolls up. */
  private follows = true;

  constructor(store: Store) {
    super(store, "log");
    const filter = h("input", {attrs: {type: "search", placeholder: "filter", "aria-label": "show messages that contain"}});
    filter.addEventListener("input", () => { this.text = filter.value.toLowerCase(); this.drawn = []; this.draw(); });
    this.element.append(h("div", {class: "toolbar"}, select("lowest level", order.map(l => [l, l.toLowerCase()] as const), this.lowest, value => {
      this.lowest = value;
      this.drawn = [];
      this.draw();
    }), filter, button("clear", "empty this list", () => { store.log.value = []; })), this.body);
    this.body.addEventListener("scroll", () => { this.follows = this.body.scrollTop + this.body.clientHeight >= this.body.scrollHeight - 30; });
    const observer = new ResizeObserver(() => this.showEnd());
    observer.observe(this.body);
    this.whenDone(() => observer.disconnect());
    this.follow(() => { void store.log.value; this.draw(); });
  }

  protected override onVisible(): void {
    // Read from the first look on, so that nothing is missed while another tab is in front.
    if (this.visible) this.store.send({kind: "watchLog", on: true});
    this.draw();
  }

  private draw(): void {
    if (!this.visible) return;
    const lines = this.store.log.value.filter(l => order.indexOf(l.level) >= order.indexOf(this.lowest) &&
      (this.text === "" || `${l.component} ${l.text}`.toLowerCase().includes(this.text))).sort((a, b) => a.stampUs - b.stampUs).slice(-400);
    if (lines.length === this.drawn.length && lines.at(-1) === this.drawn.at(-1)) return;
    this.drawn = lines;
    this.body.replaceChildren(...lines.map(l => h("div", {class: `line ${l.level.toLowerCase()}`}, h("span", {class: "dim", text: clockText(l.stampUs)}),
      h("b", {text: l.component}), messageOf(l.level === "Info" || l.level === "Debug" ? l.text : `${l.level.toUpperCase()} ${l.text}`))));
    if (lines.length === 0) this.body.append(h("p", {class: "dim", text: "No messages of this level yet."}));
    this.showEnd();
  }

  private showEnd(): void { if (this.follows) this.body.scrollTop = this.body.scrollHeight; }
}

/** A long message shows its first line; the rest opens. */
function messageOf(text: string): HTMLElement {
  const lines = text.split("\n");
  return lines.length < 4 ? h("span", {text}) : h("details", {}, h("summary", {text: `${lines[0]} (${lines.length - 1} lines)`}), h("span", {text: lines.slice(1).join("\n")}));
}
