// The bar on top of every preset: who, what, STOP, verdict, link.
import {effect} from "@preact/signals-core";
import {nowMs} from "../shared/messages";
import {button, fileButton, fixed, h, holderOf, saveFile, say, select} from "../panes/dom";
import {keepText, keptAsText} from "../state/store";
import type {Store} from "../state/store";
import {isProblem, verdictOf} from "../why/rules";
import type {Dock, MoveTo} from "./dock";
import {presetNames} from "./presets";
import type {PresetName} from "./presets";

export class TopBar {
  readonly element = h("header", {class: "top-bar"});
  private readonly presets = h("div", {class: "presets", attrs: {role: "group", "aria-label": "arrangement of panes"}});

  constructor(private readonly store: Store, private readonly dock: Dock, private readonly titles: Record<string, string>) {
    const name = store.config.robot || store.config.setup || "robot";
    const mode = h("span", {class: "mode"}), who = h("span", {class: "who"}), verdict = h("span", {class: "verdict", title: "what the localization believes, and its reliability, 0 to 1", attrs: {role: "status"}});
    const link = h("span", {class: "link", title: "images a second, and the age of the one that is shown"}), problems = h("button", {class: "button problems", attrs: {type: "button"}, on: {click: () => dock.show("components")}});
    const stop = button("STOP", "stops the base at once (Space or Escape)", () => void this.stop(), "stop");
    this.element.append(h("span", {class: "robot", text: name}), mode);
    if (!store.config.viewer && store.config.proxies.Base) this.element.append(who, stop);
    this.element.append(verdict, link, problems, h("span", {class: "spring"}), this.presets, this.paneMenu(), this.themeButton());
    for (const preset of presetNames) this.presets.append(button(preset, `panes for ${preset === "watch" ? "watching the robot" : preset === "tune" ? "tuning" : "a recording"}`, () => this.load(preset)));
    effect(() => this.drawMode(mode));
    effect(() => this.drawWho(who));
    effect(() => {
      // Components are asked once a second: the age of a pose is written anew.
      void store.components.value;
      const v = verdictOf(store.moment.value, nowMs(), store.stands);
      say(verdict, v.text);
      verdict.dataset.level = v.level;
    });
    let slowSince = Infinity;
    effect(() => {
      const v = store.video.value, behind = v && !store.stands && v.sourceFps > 1 && v.fps < 0.7 * v.sourceFps;
      // A page that was busy for a moment catches up: only what lasts is the link's.
      slowSince = behind ? Math.min(slowSince, nowMs()) : Infinity;
      const slow = v && nowMs() - slowSince > 2500;
      say(link, !v || v.last === 0 ? "no video" : store.past.value !== null ? `keeps ${fixed(v.sourceFps, 0)} fps` : slow ? `${fixed(v.fps, 0)} of ${fixed(v.sourceFps, 0)} fps, link slow` : `${fixed(v.fps, 0)} fps${store.stands ? "" : `  ${fixed(v.ageMs, 0)} ms`}`);
    });
    effect(() => {
      const bad = store.components.value.filter(c => isProblem(c, store.stands));
      if (store.components.value.length === 0) return say(problems, "connecting");
      say(problems, bad.length === 0 ? "all running" : `${bad.length} ${bad.length === 1 ? "problem" : "problems"}: ${bad.map(c => c.name).join(", ")}`);
      problems.dataset.level = bad.length === 0 ? "good" : bad.some(c => !c.alive) ? "bad" : "warning";
    });
    window.addEventListener("keydown", event => this.key(event), {capture: true});
  }

  load(preset: PresetName, anew = false): void {
    localStorage.setItem("avm.preset", preset);
    this.dock.load(preset, anew);
    this.presets.querySelectorAll("button").forEach(b => b.setAttribute("aria-pressed", String(b.textContent === preset)));
  }

  private key(event: KeyboardEvent): void {
    const target = event.target as HTMLElement;
    const typing = target.matches("input, textarea, select, button, summary, [role=tab]");
    if ((event.code === "Space" && !typing) || (event.key === "Escape" && this.store.driving.peek().active)) {
      event.preventDefault();
      void this.stop();
    }
  }

  private async stop(): Promise<void> {
    if (this.store.config.viewer || !this.store.config.proxies.Base) return;
    await this.store.stop();
  }

  private drawMode(element: HTMLElement): void {
    const past = this.store.past.value, replay = this.store.config.proxies.Replay !== undefined;
    const paused = this.store.simulation.value?.paused || this.store.replay.value?.state === "PAUSED";
    // Read the video's signal so that the age of the past is written anew.
    void this.store.video.value;
    say(element, past !== null ? `PAST -${((nowMs() - past) / 1000).toFixed(0)} s` : paused ? "PAUSED" : this.store.replay.value?.state === "FINISHED" ? "AT THE END" : replay ? "REPLAY" : "LIVE");
    element.dataset.mode = past !== null ? "past" : paused ? "paused" : "live";
  }

  private drawWho(element: HTMLElement): void {
    const lease = this.store.lease.value, mine = this.store.driving.value.active;
    say(element, lease?.mine || (mine && !lease?.held) ? "you drive" : lease?.held ? `${holderOf(lease)} drives` : "nobody drives");
  }

  /** What a file kept replaces what this browser keeps; the page begins anew with it. */
  private take(text: string): void {
    try {
      keepText(text);
      location.reload();
    } catch (failure) {
      this.store.say("bad", `not loaded: ${(failure as Error).message}`);
    }
  }

  private themeButton(): HTMLElement {
    return button("theme", "dark or light", () => { this.store.theme.value = this.store.theme.value === "dark" ? "light" : "dark"; });
  }

  /** Shows panes, and moves one beside another without a pointer. */
  private paneMenu(): HTMLElement {
    const menu = h("details", {class: "menu right"}, h("summary", {text: "panes", class: "button"})), list = h("div", {class: "menu-list"});
    const names = Object.entries(this.titles);
    list.append(h("b", {text: "show"}), h("div", {class: "pane-buttons"}, ...names.map(([name, title]) => button(title, "", () => { this.dock.show(name); menu.open = false; }))));
    const which = select("pane to move", names, "camera", () => {}), where = select("where to", [["within", "into the tabs of"], ["left", "left of"], ["right", "right of"], ["above", "above"], ["below", "below"]], "within", () => {});
    const other = select("beside which pane", names, "world", () => {});
    list.append(h("b", {text: "move"}), which, where, other, button("move", "", () => this.dock.move(which.value, where.value as MoveTo, other.value)),
      h("b", {text: "everything that is kept: panes, plots, overlays, theme"}), button("save as a file", "to load it in another browser", () => saveFile("page.json", new Blob([keptAsText()], {type: "application/json"}))),
      fileButton("load a file", text => this.take(text)),
      button("reset arrangement", "the preset as it was made", () => { this.load((localStorage.getItem("avm.preset") as PresetName | null) ?? "watch", true); menu.open = false; }));
    menu.append(list);
    menu.addEventListener("keydown", event => { if (event.key === "Escape" && menu.open) { event.stopPropagation(); menu.open = false; menu.querySelector("summary")!.focus(); } });
    return menu;
  }
}
