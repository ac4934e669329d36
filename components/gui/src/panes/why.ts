// Says in words why the robot does not know where it is.
import {nowMs} from "../shared/messages";
import type {HealthGrid} from "../shared/state";
import {causesOf, CauseWatch, sharesNoLabel, verdictOf} from "../why/rules";
import type {Store} from "../state/store";
import {button, fixed, h, say, select} from "./dom";
import {Pane} from "./pane";

/** What rates a place: of PlaceRating, in the menu, and as the meaning of a value. */
const ratings = [
  ["Explained", "explained", "the share of what is seen and remembered that the map would explain there"],
  ["Likelihood", "likelihood", "the likelihood over that of the best place"],
  ["MemoryHealth", "memory health", "the chapter's health of the memory there"],
  ["ImageHealth", "image health", "the chapter's health of the last image there"],
] as const;

export class WhyPane extends Pane {
  private readonly verdict = h("div", {class: "verdict", attrs: {role: "status"}});
  private readonly list = h("ol", {class: "causes"});
  private readonly fit = h("div", {class: "note", title: "Places are tried on a grid: the estimated pose lies between them, and may fit better than the best of them."});
  private readonly watch = new CauseWatch();
  private readonly timer: ReturnType<typeof setInterval>;
  private asking = false;
  private shown = "";

  constructor(store: Store) {
    super(store, "why");
    this.element.append(this.verdict, this.list, this.makeHealthBar(), this.fit);
    this.timer = setInterval(() => this.draw(), 500);
    this.whenDone(() => clearInterval(this.timer));
    const asker = setInterval(() => void this.askFit(), 2500);
    this.whenDone(() => clearInterval(asker));
  }

  private makeHealthBar(): HTMLElement {
    const bar = h("div", {class: "toolbar"});
    let rating = "Explained", heading = "best";
    bar.append(h("span", {class: "dim", text: "health map"}),
      select("what rates a place", ratings.map(([name, text]) => [name, text] as const), rating, value => { rating = value; }),
      select("heading", [["best", "best of 16"], ["now", "present heading"], ["0", "0 deg"], ["90", "90 deg"], ["180", "180 deg"], ["-90", "-90 deg"]], heading, value => { heading = value; }),
      button("show", "rate every place of the map", () => void this.showGrid(rating, heading)),
      button("clear", "remove the health map", () => { this.store.healthGrid.value = null; }));
    return bar;
  }

  private async showGrid(rating: string, heading: string): Promise<void> {
    const present = this.store.moment.value.estimate?.world.theta ?? 0;
    const theta = heading === "best" ? null : heading === "now" ? present : Number(heading) * Math.PI / 180;
    try {
      const grid = await this.store.call<HealthGrid>("healthMap", rating, theta, 16, 0.15, null);
      this.store.healthGrid.value = grid;
      let best = 0;
      grid.health.forEach((value, i) => { if (value > grid.health[best]!) best = i; });
      const column = best % grid.columns, row = Math.floor(best / grid.columns);
      say(this.fit, `of ${grid.columns} x ${grid.rows} places, ${grid.cellM * 100} cm apart, the robot fits best at ${fixed(grid.low.x + column * grid.cellM, 2)}, ` +
        `${fixed(grid.low.y + row * grid.cellM, 2)} m: ${fixed(grid.health[best], 2)}, ${ratings.find(([name]) => name === rating)![2]}`);
    } catch (failure) {
      this.store.say("bad", `health map: ${(failure as Error).message}`);
    }
  }

  /** How well the best place of the map fits, while the robot is not sure and somebody looks. */
  private async askFit(): Promise<void> {
    const {store} = this, e = store.moment.value.estimate, memory = store.moment.value.memory;
    if (!this.visible || this.asking || !store.moment.value.live || !e || !memory || memory.ids.length < 4) return;
    if (e.hasPose && e.reliability > 0.7) {
      store.bestFit.value = null;
      return;
    }
    this.asking = true;
    try {
      const grid = await store.call<HealthGrid>("healthMap", "Explained", null, 16, 0.5, null);
      // The grid is coarse: a refined pose that is probably right fits better than the cell around it.
      let best = e.hasPose ? e.reliability : 0;
      for (const value of grid.health) best = Math.max(best, value);
      store.bestFit.value = {value: best, at: nowMs()};
    } catch {
      // The localization has nothing to rate places by when the map has none of the labels that are seen.
      const {map, moment} = store;
      store.bestFit.value = map.value && sharesNoLabel(moment.value, map.value) ? {value: 0, at: nowMs()} : null;
    } finally {
      this.asking = false;
    }
  }

  private draw(): void {
    const {store} = this, now = nowMs(), stands = store.stands;
    const causes = this.watch.update(causesOf({
      now, moment: {...store.moment.value, t: store.moment.value.live ? now : store.moment.value.t}, video: store.video.value, hasCamera: store.config.proxies.Camera !== undefined, links: store.links.value,
      components: store.components.value, map: store.map.value, setup: store.config.setup, replay: store.replay.value, bestFit: store.bestFit.value,
      paused: stands,
    }), now);
    const verdict = verdictOf(store.moment.value, now, stands);
    say(this.verdict, verdict.text);
    this.verdict.dataset.level = verdict.level;
    const key = JSON.stringify([verdict.level, ...causes.map(c => [c.cause.text, Math.floor((now - c.since) / 1000)])]);
    if (key === this.shown) return;
    this.shown = key;
    this.list.replaceChildren(...causes.map(({cause, since}) => h("li", {attrs: {"data-cause": cause.id}},
      h("span", {class: "cause", text: cause.text}), h("span", {class: "dim", text: ` for ${((now - since) / 1000).toFixed(0)} s. `}), h("span", {class: "advice", text: cause.advice}))));
    if (causes.length === 0) this.list.append(h("li", {class: "none", text: verdict.level === "good" ? "Nothing speaks against what it believes." : "No cause stands out yet."}));
  }
}
