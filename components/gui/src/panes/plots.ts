// Numbers over time. All plots share one cursor; dragging stops the following, "live" returns.
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import {nowMs} from "../shared/messages";
import {colour, labelColour} from "../shared/palette";
import {groupTitles} from "../state/columns";
import type {Group, GroupName} from "../state/columns";
import type {Store} from "../state/store";
import {button, h, readable, saveFile, select} from "./dom";
import {Pane} from "./pane";

interface PlotSpec { id: string; title: string; unit: string; group: GroupName; pick: (name: string) => boolean; fit?: boolean }

const specs: PlotSpec[] = [
  {id: "error", title: "position error", unit: "m", group: "pose", pick: n => !n.includes("heading")},
  {id: "heading", title: "heading error", unit: "deg", group: "pose", pick: n => n.includes("heading")},
  {id: "reliability", title: "reliability", unit: "", group: "health", pick: () => true},
  {id: "memory", title: "elements", unit: "", group: "memory", pick: n => n !== "mean life"},
  {id: "rates", title: "rates", unit: "Hz", group: "rates", pick: n => !n.includes("request") && !n.startsWith("recorder")},
  {id: "latency", title: "latency", unit: "ms", group: "latency", pick: () => true},
  {id: "cpu", title: "CPU", unit: "% of a core", group: "cpu", pick: () => true},
];

/** Errors are known in a simulation only. */
function withoutTruth(spec: PlotSpec): PlotSpec {
  return spec.group !== "pose" ? spec : {...spec, title: spec.title.replace("error", "sigma"), pick: n => spec.pick(n) && n.includes("sigma")};
}

/** A number that was chosen: a plot of its own. */
function specOf(key: string): PlotSpec {
  const [group, name] = JSON.parse(key) as [GroupName, string];
  return {id: key, title: `${groupTitles[group]}: ${name}`, unit: "", group, pick: n => n === name, fit: true};
}

class Chart {
  readonly element = h("figure", {class: "plot"});
  private readonly host = h("div", {class: "plot-host"});
  private readonly caption = h("figcaption", {});
  private plot: uPlot | null = null;
  private names: string[] = [];
  private theme = "";
  private drawn = -1;

  /** @param close of a plot that was chosen. */
  constructor(readonly spec: PlotSpec, private readonly store: Store, private readonly zoom: (from: number, to: number) => void, close?: () => void) {
    this.element.append(this.caption, this.host);
    if (close) this.element.append(button("\u00d7", `remove the plot of ${spec.title}`, close, "close"));
    this.element.setAttribute("aria-label", `${spec.title} over time`);
  }

  draw(range: {from: number; to: number}): void {
    const group = this.store.columns[this.spec.group], names = [...group.series.keys()].filter(this.spec.pick);
    const width = this.host.clientWidth, height = this.host.clientHeight;
    if (width < 40 || height < 30) return;
    if (!this.plot || names.join() !== this.names.join() || this.theme !== this.store.theme.value) this.make(names, width, height);
    const plot = this.plot!;
    if (plot.width !== width || plot.height !== height) plot.setSize({width, height});
    if (group.version !== this.drawn) {
      this.drawn = group.version;
      plot.setData([group.times.map(t => t / 1000), ...names.map(n => group.series.get(n)!.map(v => Number.isNaN(v) ? null : v))] as uPlot.AlignedData, false);
    }
    plot.setScale("x", {min: range.from / 1000, max: range.to / 1000});
    this.write(group, names);
  }

  /** Values at the cursor, or the last ones, beside the names. */
  private write(group: Group, names: string[]): void {
    const at = this.store.cursor.value ?? this.store.past.value;
    let index = group.times.length - 1;
    if (at !== null) { index = group.times.findIndex(t => t > at) - 1; if (index < 0) index = group.times.length - 1; }
    const parts: Node[] = [h("b", {text: this.spec.title + (this.spec.unit ? ` (${this.spec.unit})` : "")})];
    names.forEach((name, i) => {
      const value = group.series.get(name)![index];
      const key = h("span", {class: `key dash${Math.floor(i / 8) % 2}`, text: `${this.spec.fit ? "" : `${name.replace(/ \((m|deg)\)$/, "")} `}${value === undefined || Number.isNaN(value) ? "-" : readable(value)}`});
      key.style.color = labelColour(i, this.store.theme.value);
      parts.push(key);
    });
    if (names.length === 0) parts.push(h("span", {class: "dim", text: "no values yet"}));
    this.caption.replaceChildren(...parts);
  }

  private make(names: string[], width: number, height: number): void {
    this.plot?.destroy();
    this.names = names;
    this.drawn = -1;
    const theme = this.theme = this.store.theme.value, axis = {stroke: colour("dim", theme), grid: {stroke: colour("grid", theme), width: 1}, ticks: {stroke: colour("grid", theme), width: 1}, font: "11px system-ui, sans-serif"};
    const newest = () => nowMs() / 1000;
    this.plot = new uPlot({
      width, height, padding: [6, 8, 0, 0], legend: {show: false}, scales: {x: {time: false}, y: this.spec.fit ? {} : {range: (_u, min, max) => min === null || max === null ? [0, 1] : [Math.min(0, min), Math.max(max * 1.08, 0.01)]}},
      axes: [{...axis, size: 20, gap: 2, splits: (_u, _i, min, max) => ticksBefore(newest(), min, max), values: (_u, values) => values.map(v => `${Math.round(v - newest())} s`)}, {...axis, size: 46, gap: 3, space: 20, values: (_u, values) => values.map(v => String(Number(v.toPrecision(6))))}],
      cursor: {drag: {x: true, y: false, setScale: false}, points: {show: false}},
      series: [{}, ...names.map((name, i) => ({label: name, stroke: labelColour(i, theme), width: 1.5, points: {show: false}, ...(i >= 8 ? {dash: [5, 3]} : {})}))],
      hooks: {
        setCursor: [u => { this.store.cursor.value = u.cursor.left !== undefined && u.cursor.left >= 0 ? u.posToVal(u.cursor.left, "x") * 1000 : null; }],
        setSelect: [u => { if (u.select.width > 5) { this.zoom(u.posToVal(u.select.left, "x") * 1000, u.posToVal(u.select.left + u.select.width, "x") * 1000); u.setSelect({left: 0, top: 0, width: 0, height: 0}, false); } }],
        draw: [u => this.drawMoment(u)],
      },
    }, [[], ...names.map(() => [])], this.host);
    this.plot.over.addEventListener("dblclick", () => { const t = this.store.cursor.value; if (t !== null) this.store.scrub(t); });
  }

  /** Where the page's moment of the past is, and the shared cursor of the other plots. */
  private drawMoment(u: uPlot): void {
    for (const [t, name] of [[this.store.past.value, "estimate"], [this.store.cursor.value, "dim"]] as const) {
      if (t === null) continue;
      const x = u.valToPos(t / 1000, "x", true);
      u.ctx.strokeStyle = colour(name, this.store.theme.value);
      u.ctx.lineWidth = 1;
      u.ctx.beginPath();
      u.ctx.moveTo(x, u.bbox.top);
      u.ctx.lineTo(x, u.bbox.top + u.bbox.height);
      u.ctx.stroke();
    }
  }

  dispose(): void { this.plot?.destroy(); }
}

export class PlotsPane extends Pane {
  private readonly fixedCharts: Chart[];
  private chosen: Chart[] = [];
  private readonly grid = h("div", {class: "plot-grid", attrs: {tabindex: "0", role: "region", "aria-label": "numbers over time"}});
  private readonly add = select("plot one more number", [["", "add a plot"]], "", key => this.choose([...this.store.plots.value, key]));
  private offered = "";
  private window = 60_000;
  private fixedRange: {from: number; to: number} | null = null;
  private readonly liveButton: HTMLButtonElement;

  constructor(store: Store) {
    super(store, "plots");
    this.liveButton = button("live", "follow the present again", () => { this.fixedRange = null; this.draw(); });
    const bar = h("div", {class: "toolbar"}, select("time span", [["15000", "15 s"], ["60000", "1 min"], ["300000", "5 min"]], "60000", value => {
      this.window = Number(value);
      this.fixedRange = null;
      this.draw();
    }), this.liveButton, this.add, button("save CSV", "all numbers of the last 5 minutes as a table", () => saveFile("numbers.csv", new Blob([store.columns.csv()], {type: "text/csv"}))),
    h("span", {class: "dim", text: "drag: zoom; double-click: go to that moment"}));
    this.fixedCharts = (store.config.proxies.Simulation && store.config.truth ? specs : specs.map(withoutTruth)).map(spec => new Chart(spec, store, this.zoom));
    this.element.append(bar, this.grid);
    this.choose(store.plots.value);
    const timer = setInterval(() => this.draw(), 500);
    this.whenDone(() => { clearInterval(timer); for (const chart of this.charts) chart.dispose(); });
    const observer = new ResizeObserver(() => this.draw());
    observer.observe(this.grid);
    this.whenDone(() => observer.disconnect());
  }

  private get charts(): Chart[] { return [...this.chosen, ...this.fixedCharts]; }

  private readonly zoom = (from: number, to: number): void => { this.fixedRange = {from, to}; this.draw(); };

  /** Plots of chosen numbers stand first, the newest in front. They outlive the page. */
  private choose(keys: string[]): void {
    this.store.plots.value = keys;
    for (const chart of this.chosen) chart.dispose();
    this.chosen = keys.map(key => new Chart(specOf(key), this.store, this.zoom, () => this.choose(this.store.plots.value.filter(k => k !== key)))).reverse();
    this.grid.replaceChildren(...this.charts.map(c => c.element));
    this.offered = "";
    this.draw();
  }

  /** Numbers appear as components report them. */
  private offer(): void {
    const taken = this.store.plots.value, groups = this.store.columns.groups.map(([group, {series}]) => [group, [...series.keys()].filter(n => !taken.includes(JSON.stringify([group, n])))] as const);
    const offered = JSON.stringify(groups);
    if (offered === this.offered || document.activeElement === this.add) return;
    this.offered = offered;
    this.add.replaceChildren(h("option", {text: "add a plot", attrs: {value: ""}}), ...groups.filter(([, names]) => names.length > 0).map(([group, names]) =>
      h("optgroup", {attrs: {label: groupTitles[group]}}, ...names.map(n => h("option", {text: n, attrs: {value: JSON.stringify([group, n])}})))));
  }

  protected override onVisible(): void { this.draw(); }

  private draw(): void {
    if (!this.visible || document.hidden) return;
    const to = nowMs();
    this.offer();
    this.liveButton.disabled = this.fixedRange === null;
    for (const chart of this.charts) chart.draw(this.fixedRange ?? {from: to - this.window, to});
  }
}

/** Round numbers of seconds before now, about five in the range. */
function ticksBefore(now: number, min: number, max: number): number[] {
  const step = [1, 2, 5, 10, 15, 30, 60, 120].find(s => (max - min) / s <= 5) ?? 300, ticks: number[] = [];
  for (let k = Math.floor((now - max) / step); now - k * step >= min; ++k) if (now - k * step <= max) ticks.unshift(now - k * step);
  return ticks;
}
