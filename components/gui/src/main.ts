// The page: what its server says, the panes, and the bars above and below.
import {effect} from "@preact/signals-core";
import "dockview/dist/styles/dockview.css";
import "./style/page.css";
import {Dock} from "./layout/dock";
import type {PaneMaker} from "./layout/dock";
import {makeLogin} from "./layout/login";
import {presetNames} from "./layout/presets";
import type {PresetName} from "./layout/presets";
import {TimeBar} from "./layout/time_bar";
import {TopBar} from "./layout/top_bar";
import {ActionsPane} from "./panes/actions";
import {AttentionPane} from "./panes/attention";
import {CameraPane} from "./panes/camera";
import {ComponentsPane} from "./panes/components";
import {DetailsPane} from "./panes/details";
import {DrivePane} from "./panes/drive";
import {h, say} from "./panes/dom";
import {LogPane} from "./panes/log";
import {PlotsPane} from "./panes/plots";
import {SettingsPane} from "./panes/settings";
import {WhyPane} from "./panes/why";
import {WorldPane} from "./panes/world";
import type {GuiConfig} from "./shared/messages";
import {Store} from "./state/store";

const titles: Record<string, string> = {
  camera: "camera", world: "scene", plots: "plots", attention: "attention", why: "why", drive: "drive", actions: "actions", components: "components",
  details: "details", log: "log", settings: "settings",
};

function makersOf(store: Store): Record<string, PaneMaker> {
  return {
    camera: () => new CameraPane(store), world: () => new WorldPane(store), plots: () => new PlotsPane(store), attention: () => new AttentionPane(store),
    why: () => new WhyPane(store), drive: () => new DrivePane(store), actions: () => new ActionsPane(store), components: () => new ComponentsPane(store),
    details: () => new DetailsPane(store), log: () => new LogPane(store), settings: () => new SettingsPane(store),
  };
}

function showNotices(store: Store, body: HTMLElement): void {
  const box = h("div", {class: "notice hidden", attrs: {role: "status", "aria-live": "polite"}});
  body.append(box);
  let timer: ReturnType<typeof setTimeout> | undefined;
  effect(() => {
    const notice = store.notice.value;
    if (!notice) return;
    clearTimeout(timer);
    box.className = `notice ${notice.kind}`;
    say(box, notice.text);
    timer = setTimeout(() => { box.className = "notice hidden"; }, notice.kind === "bad" ? 8000 : 3500);
  });
}

function presetOf(config: GuiConfig): PresetName {
  const wanted = location.hash.slice(1) || localStorage.getItem("avm.preset") || (config.proxies.Replay ? "replay" : "watch");
  return presetNames.find(p => p === wanted) ?? "watch";
}

async function start(): Promise<void> {
  const response = await fetch("config.json");
  if (!response.ok) throw new Error(`config.json: ${response.status} ${await response.text()}`);
  const store = new Store(await response.json() as GuiConfig);
  // For tests and for people at the browser's console: the moment that is shown, and the robot's commands by name.
  Object.assign(globalThis, {avmPage: {moment: () => store.moment.value, call: store.call.bind(store)}});
  effect(() => { document.documentElement.dataset.theme = store.theme.value; });
  const dockHost = h("main", {class: "dock"}), app = document.getElementById("app")!;
  const dock = new Dock(dockHost, makersOf(store), titles), top = new TopBar(store, dock, titles);
  app.replaceChildren(top.element, dockHost, new TimeBar(store).element);
  if (store.config.gateway) app.append(makeLogin(store));
  showNotices(store, app);
  top.load(presetOf(store.config));
  document.addEventListener("visibilitychange", () => store.send({kind: "visible", page: !document.hidden, camera: true}));
  // A menu is open until somebody clicks elsewhere.
  document.addEventListener("pointerdown", event => {
    for (const menu of document.querySelectorAll<HTMLDetailsElement>("details.menu[open]")) if (!menu.contains(event.target as Node)) menu.open = false;
  });
  window.addEventListener("pagehide", () => store.send({kind: "stop"}));
  // A page that comes back from the browser's cache has a closed worker: begin anew.
  window.addEventListener("pageshow", event => { if (event.persisted) location.reload(); });
  let narrow = dockHost.clientWidth < 900;
  new ResizeObserver(() => {
    if (dockHost.clientWidth < 900 === narrow) return;
    narrow = !narrow;
    top.load(presetOf(store.config));
  }).observe(dockHost);
  document.title = `${store.config.robot || store.config.setup || "robot"}: attentive visual memory`;
}

start().catch((failure: Error) => {
  document.getElementById("app")!.replaceChildren(h("p", {class: "fatal", text: `The page cannot start: ${failure.message}`}));
});
