// Commands of memory, localization, simulation and replay, with the page's marks.
import {nowMs} from "../shared/messages";
import {occludersOf} from "../state/store";
import type {Store} from "../state/store";
import {button, fixed, h, numberField, say, select} from "./dom";
import {Pane} from "./pane";

export class ActionsPane extends Pane {
  constructor(store: Store) {
    super(store, "actions");
    const {proxies, viewer} = store.config;
    const body = h("div", {class: "scroll actions", attrs: {tabindex: "0", role: "region", "aria-label": "actions"}});
    this.element.append(body);
    if (viewer) body.append(h("p", {class: "note", text: "This page only watches: its server offers no actions."}));
    else {
      if (proxies.VisualMemory || proxies.Localization) body.append(this.estimators());
      if (proxies.Simulation) body.append(this.simulation());
      if (proxies.Replay) body.append(this.replay());
      if (proxies.Recorder) body.append(this.recorder());
    }
    body.append(this.marks());
  }

  private group(title: string, ...children: (Node | null)[]): HTMLElement {
    return h("fieldset", {}, h("legend", {text: title}), ...children);
  }

  private estimators(): HTMLElement {
    const {store} = this, {proxies} = store.config;
    return this.group("memory and pose",
      proxies.VisualMemory ? button("reset memory", "set the memory aside and begin anew", () => void store.act("memory begins anew", "resetMemory")) : null,
      proxies.Localization ? button("relocalize", "forget the pose and search everywhere", () => void store.act("searching everywhere", "relocalize")) : null,
      proxies.Localization ? button("set pose", "drag an arrow in the scene or type a pose", () => { store.tool.value = "pose"; store.say("info", "Drag an arrow in the scene; Enter applies, Escape drops."); }) : null);
  }

  private simulation(): HTMLElement {
    const {store} = this, state = h("div", {class: "note"}), pause = button("pause", "simulated time stands still", () => {
      const paused = store.simulation.value?.paused === true;
      void store.act(paused ? "simulation goes on" : "simulation paused", "pauseSimulation", !paused);
    });
    const speed = select("simulated seconds per second", ["0.1", "0.25", "0.5", "1", "2", "4"].map(v => [v, `speed ${v}`] as const), "1", v => void store.act(`speed ${v}`, "speed", Number(v)));
    const models = h("div", {class: "models"}), seed = numberField("seed", 1, 1);
    let seedShown: number | null = null;
    this.follow(() => {
      const s = store.simulation.value;
      if (!s) return say(state, "the simulator has not answered yet");
      say(pause, s.paused ? "resume" : "pause");
      showChoice(speed, s.speed, "speed");
      if (s.seed !== seedShown) seed.input.value = String(seedShown = s.seed);
      say(state, `${s.world}, ${fixed(s.stampUs / 1e6, 1)} s simulated, runs at ${fixed(s.realSpeed, 2)}${s.lockStep > 0 ? `, in lock-step with ${s.lockStep}` : ""}`);
      const mine = occludersOf(s), key = mine.map(m => m.name).join();
      if (models.dataset.key !== key) {
        models.dataset.key = key;
        models.replaceChildren(...mine.map(m => button(`remove ${m.name}`, `at ${fixed(m.x, 1)}, ${fixed(m.y, 1)} m`, () => void store.act(`${m.name} removed`, "removeModel", m.name))));
      }
    });
    return this.group("simulation", state, pause, button("step 0.1 s", "ten steps of 10 ms, while paused", () => void store.act("0.1 s simulated", "step", 10)), speed,
      ...(store.config.truth ? [button("kidnap", "drag the robot to another place in the scene", () => { store.tool.value = "kidnap"; store.say("info", "Drag an arrow in the scene where the robot shall stand."); }),
      button("occluder", "click in the scene where a box shall stand", () => { store.tool.value = "occluder"; store.say("info", "Click in the scene: a box stands there."); })] : []), models,
      seed.element, button("reset", "everything from the beginning with this seed", () => void store.act("simulation begins anew", "resetSimulation", seed.input.valueAsNumber || 0)));
  }

  private replay(): HTMLElement {
    const {store} = this;
    const state = h("div", {class: "note"}), stands = () => ["PAUSED", "FINISHED"].includes(store.replay.value?.state ?? "");
    const pause = button("pause", "the log stands still", () => { const on = stands(); void store.act(on ? "replay goes on" : "replay paused", "pauseReplay", !on); });
    const rate = select("log seconds per second", ["0.1", "0.25", "0.5", "1", "2", "4"].map(v => [v, `rate ${v}`] as const), "1", v => void store.act(`rate ${v}`, "rateReplay", Number(v)));
    const loop = button("loop", "whether it begins again at the end", () => { const on = !(store.replay.value?.loop ?? false); void store.act(on ? "the log repeats" : "the log ends at its end", "loopReplay", on); });
    this.follow(() => {
      const r = store.replay.value;
      if (!r) return say(state, "the replay has not answered yet");
      say(pause, r.state === "FINISHED" ? "play again" : stands() ? "play" : "pause");
      showChoice(rate, r.rate, "rate");
      say(loop, r.loop ? "do not loop" : "loop");
      say(state, `${r.file.split("/").pop()}: ${fixed((r.stampUs - r.firstUs) / 1e6, 1)} of ${fixed((r.lastUs - r.firstUs) / 1e6, 1)} s, ${r.state.toLowerCase()}`);
    });
    const step = (images: number) => void store.act(`${images > 0 ? "one image on" : "one image back"}, paused`, "stepReplay", images);
    return this.group("replay", state, pause, button("-1 image", "pauses at the image before", () => step(-1)), button("+1 image", "pauses at the next image", () => step(1)), rate,
      button("-5 s", "back", () => this.jump(-5)), button("+5 s", "on", () => this.jump(5)), button("to the start", "", () => this.jump(-Infinity)), loop);
  }

  private recorder(): HTMLElement {
    const {store} = this, state = h("div", {class: "note"});
    const record = button("record", "begin a recording, or end it", () => {
      const on = store.recorder.value?.state === "Recording";
      void store.act(on ? "recording ended" : "recording", on ? "stopRecording" : "startRecording");
    });
    this.follow(() => {
      const r = store.recorder.value;
      if (!r) return say(state, "the recorder has not answered yet");
      say(record, r.state === "Recording" ? "stop recording" : "record");
      say(state, r.state === "Failed" ? `failed: ${r.message}` : `${r.state.toLowerCase()}${r.path ? ` ${r.path}` : ""}, ${fixed(r.seconds, 1)} s, ${fixed(r.bytes / 1048576, 1)} MB, ${r.messages} messages`);
    });
    return this.group("recorder", state, record, button("save the last seconds", "what is still in memory, as a recording of its own", () => void store.act("last seconds saved", "saveRing")));
  }

  private jump(seconds: number): void {
    const r = this.store.replay.value;
    if (!r) return;
    const to = Math.min(r.lastUs, Math.max(r.firstUs, r.stampUs + seconds * 1e6));
    void this.store.act(`replay at ${fixed((to - r.firstUs) / 1e6, 1)} s`, "seek", to);
  }

  private marks(): HTMLElement {
    const {store} = this, text = h("input", {attrs: {type: "text", placeholder: "what happens here", "aria-label": "text of the mark"}}), list = h("ol", {class: "marks"});
    const set = () => {
      store.send({kind: "mark", text: text.value || "mark"});
      if (store.recorder.value?.state === "Recording") void store.act("mark recorded", "markRecording", text.value || "mark");
      text.value = "";
    };
    text.addEventListener("keydown", event => { if (event.key === "Enter") set(); });
    this.follow(() => {
      const marks = (store.timeline.value?.marks ?? []).slice(-12).reverse(), key = marks.map(m => m.t).join();
      if (list.dataset.key !== key) list.replaceChildren(...marks.map(m => h("li", {}, button("", "go to that moment", () => store.scrub(m.t)))));
      list.dataset.key = key;
      // The ages go on.
      list.querySelectorAll("button").forEach((b, i) => say(b, `${((nowMs() - marks[i]!.t) / 1000).toFixed(0)} s ago: ${marks[i]!.text}`));
    });
    return this.group("marks", text, button("mark now", "a mark on the time bar", set), list);
  }
}

/** The value that holds, which another client or an option of the program may have set, also one that the list lacks. */
function showChoice(list: HTMLSelectElement, value: number, name: string): void {
  const text = String(value);
  if (list.value === text || document.activeElement === list) return;
  if (![...list.options].some(o => o.value === text)) list.append(h("option", {text: `${name} ${text}`, attrs: {value: text}}));
  list.value = text;
}
