// What the page knows, as signals that panes follow, and the one way to the worker.
import {effect, signal} from "@preact/signals-core";
import {defaultOverlays, nowMs} from "../shared/messages";
import type {FromWorker, GuiConfig, ImagePlace, OverlayOptions, SessionInfo, ToWorker} from "../shared/messages";
import type {Theme} from "../shared/palette";
import {emptyMoment, timeStands} from "../shared/state";
import type {
  ComponentInfo, HealthGrid, LeaseInfo, LinkInfo, LogLine, MapState, Moment, RecorderInfo, ReplayInfo, SimulationInfo, TimelineInfo, VideoInfo,
} from "../shared/state";
import {Columns} from "./columns";

export type Tool = "select" | "measure" | "gaze" | "pose" | "kidnap" | "occluder";

export interface Selection { kind: "segment" | "primitive" | "race" | "attention" | "map"; id: number }

export interface Notice { kind: "good" | "bad" | "info"; text: string; at: number }

function saved<T>(key: string, fallback: T): T {
  try {
    const text = localStorage.getItem(`avm.${key}`);
    return text === null ? fallback : JSON.parse(text) as T;
  } catch {
    return fallback;
  }
}

/** A signal whose value outlives the page. */
function kept<T>(key: string, fallback: T) {
  const result = signal<T>(saved(key, fallback));
  let first = true;
  effect(() => {
    const value = result.value;
    if (!first) localStorage.setItem(`avm.${key}`, JSON.stringify(value));
    first = false;
  });
  return result;
}

/** The boxes that pages have put into a simulated world. */
export function occludersOf(simulation: SimulationInfo | null): SimulationInfo["models"] {
  return simulation?.models.filter(m => m.name.startsWith("occluder_") && m.present) ?? [];
}

/** All that this browser keeps of the page, as a file. */
export function keptAsText(): string {
  return JSON.stringify(Object.fromEntries(Object.entries(localStorage).filter(([key]) => key.startsWith("avm."))), null, 1);
}

/** Replaces all that is kept. @throws Error with what is wrong; then nothing was changed. */
export function keepText(text: string): void {
  const kept = JSON.parse(text) as unknown;
  const entries = typeof kept === "object" && kept !== null ? Object.entries(kept) : [];
  if (entries.length === 0 || !entries.every(([key, value]) => key.startsWith("avm.") && typeof value === "string")) throw new Error("the file has no arrangement of this page (must be one that \"save as a file\" made)");
  for (const key of Object.keys(localStorage)) if (key.startsWith("avm.")) localStorage.removeItem(key);
  for (const [key, value] of entries) localStorage.setItem(key, value as string);
}

export class Store {
  /** What is shown. */
  readonly moment = signal<Moment>(emptyMoment);
  /** The present, also while a moment of the past is shown. */
  readonly live = signal<Moment>(emptyMoment);
  readonly video = signal<VideoInfo | null>(null);
  readonly links = signal<LinkInfo[]>([]);
  readonly components = signal<ComponentInfo[]>([]);
  readonly map = signal<MapState | null>(null);
  readonly simulation = signal<SimulationInfo | null>(null);
  readonly replay = signal<ReplayInfo | null>(null);
  readonly recorder = signal<RecorderInfo | null>(null);
  readonly lease = signal<LeaseInfo | null>(null);
  readonly timeline = signal<TimelineInfo | null>(null);
  readonly driving = signal<{active: boolean; why: string}>({active: false, why: ""});
  readonly log = signal<LogLine[]>([]);
  /** Moment that is shown [ms]; null: live. */
  readonly past = signal<number | null>(null);
  readonly selection = signal<Selection | null>(null);
  readonly tool = signal<Tool>("select");
  readonly notice = signal<Notice | null>(null);
  readonly healthGrid = signal<HealthGrid | null>(null);
  readonly bestFit = signal<{value: number; at: number} | null>(null);
  readonly session = signal<SessionInfo>({state: "none", message: ""});
  readonly overlays = kept<OverlayOptions>("overlays", defaultOverlays);
  readonly theme = kept<Theme>("theme", matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark");
  /** Numbers that are plotted on request: group and name as JSON. */
  readonly plots = kept<string[]>("plots", []);
  readonly columns = new Columns();
  /** Time that the cursors of all plots show [ms]; null: none. */
  readonly cursor = signal<number | null>(null);
  imagePlace: ImagePlace = {x: 0, y: 0, scale: 1, width: 0, height: 0};
  private readonly worker: Worker;
  private generation = 0;
  private nextCall = 1;
  private readonly calls = new Map<number, {resolve: (value: unknown) => void; reject: (error: Error) => void}>();

  constructor(readonly config: GuiConfig) {
    this.worker = new Worker(new URL("../ice/worker.ts", import.meta.url), {type: "module"});
    this.worker.onmessage = ({data}: MessageEvent<FromWorker>) => this.take(data);
    this.worker.onerror = event => this.say("bad", `the page's worker has failed: ${event.message}`);
    this.send({kind: "start", config});
    effect(() => this.send({kind: "overlays", options: this.overlays.value, theme: this.theme.value}));
  }

  /** Whether the robot's time stands still on purpose. */
  get stands(): boolean {
    return timeStands(name => this.links.value.some(l => l.name === name && l.connected), this.simulation.value, this.replay.value);
  }

  send(message: ToWorker, transfer: Transferable[] = []): void { this.worker.postMessage(message, transfer); }

  /** Asks the robot something by name. */
  call<T = unknown>(name: string, ...values: unknown[]): Promise<T> {
    const id = this.nextCall++;
    return new Promise<T>((resolve, reject) => {
      this.calls.set(id, {resolve: value => resolve(value as T), reject});
      this.send({kind: "command", id, name, values});
    });
  }

  /** A command whose outcome is said to the person. @param text what was done. @return whether it was taken. */
  async act(text: string, name: string, ...values: unknown[]): Promise<boolean> {
    try {
      const reply = await this.call<{adjusted?: boolean; message?: string} | string | null>(name, ...values);
      const more = reply !== null && typeof reply === "object" && reply.adjusted ? ` (adjusted: ${reply.message})` : "";
      this.say("good", text + more);
      return true;
    } catch (failure) {
      this.say("bad", `NOT DONE: ${text} (${(failure as Error).message})`);
      return false;
    }
  }

  /** Stops the base, whoever drives. Nobody may take a stop that did not arrive for one that did. */
  async stop(): Promise<void> {
    try {
      await this.call("stop");
      this.say("good", "stopped");
    } catch (failure) {
      this.say("bad", `STOP DID NOT REACH THE BASE: ${(failure as Error).message}`);
    }
  }

  say(kind: Notice["kind"], text: string): void { this.notice.value = {kind, text, at: nowMs()}; }

  scrub(t: number | null): void {
    this.past.value = t;
    this.send({kind: "scrub", t, generation: ++this.generation});
  }

  private take(message: FromWorker): void {
    switch (message.kind) {
      case "moment":
        // An answer to an older request is late: the newest request wins.
        if (message.generation !== this.generation) break;
        this.takeMoment(message.moment);
        break;
      case "video":
        this.video.value = message.video;
        this.imagePlace = message.place;
        break;
      case "links": this.links.value = message.links; break;
      case "session": this.session.value = message.session; break;
      case "components":
        this.components.value = message.components;
        this.columns.addComponents(nowMs(), message.components, this.video.value);
        break;
      case "map": this.map.value = message.map; break;
      case "simulation": this.simulation.value = message.simulation; break;
      case "replay": this.replay.value = message.replay; break;
      case "recorder": this.recorder.value = message.recorder; break;
      case "lease": this.lease.value = message.lease; break;
      case "timeline": this.timeline.value = message.timeline; break;
      case "driving": this.driving.value = {active: message.active, why: message.why}; break;
      case "log": this.log.value = [...this.log.value, ...message.lines].slice(-3000); break;
      case "reply": {
        const call = this.calls.get(message.id);
        this.calls.delete(message.id);
        if (message.ok) call?.resolve(message.value);
        else call?.reject(new Error(message.error));
      }
    }
  }

  private takeMoment(part: Partial<Moment>): void {
    if (part.live) {
      this.live.value = {...this.live.peek(), ...part};
      this.columns.addMoment(this.live.peek());
    }
    if (!part.live) this.moment.value = {...emptyMoment, ...part};
    else if (this.past.peek() === null) this.moment.value = this.live.peek();
  }
}
