// Messages between the page and its worker, both ways.
import type {
  ComponentInfo, HealthGrid, LeaseInfo, LinkInfo, LogLine, MapState, Moment, RecorderInfo, ReplayInfo, SimulationInfo, TimelineInfo, VideoInfo,
} from "./state";

export interface GuiConfig {
  version: string;
  robot: string;
  setup: string;
  /** False: the map has a frame of its own, in which the true pose of a simulation has no meaning. */
  truth: boolean;
  /** True: read-only faces; the page offers no actions. */
  viewer: boolean;
  /** Proxy of a router at which people log in; empty: the page reaches the components themselves. */
  gateway: string;
  proxies: Record<string, string>;
  components: {name: string; proxy: string}[];
}

/** Of a gateway. "away": it was lost or is not reached; the worker tries again. */
export interface SessionInfo { state: "none" | "needed" | "trying" | "open" | "away"; message: string }

export interface OverlayOptions {
  observed: boolean; predicted: boolean; matched: boolean; labels: boolean; horizon: boolean; map: boolean; gaze: boolean;
  /** Draws an image at once instead of waiting up to 60 ms for its analysis. */
  raw: boolean;
}
export type OverlayName = keyof OverlayOptions;
export const defaultOverlays: OverlayOptions =
  {observed: true, predicted: false, matched: true, labels: false, horizon: false, map: false, gaze: true, raw: false};

/** Where the image lies on the canvas [CSS px]. */
export interface ImagePlace { x: number; y: number; scale: number; width: number; height: number }

export type ToWorker =
  | {kind: "start"; config: GuiConfig}
  | {kind: "logIn"; user: string; password: string}
  | {kind: "canvas"; canvas: OffscreenCanvas}
  | {kind: "canvasSize"; width: number; height: number; ratio: number}
  | {kind: "overlays"; options: OverlayOptions; theme: "dark" | "light"}
  | {kind: "visible"; page: boolean; camera: boolean}
  | {kind: "command"; id: number; name: string; values: unknown[]}
  | {kind: "drive"; held: boolean; v: number; w: number; sentMs: number}
  | {kind: "scrub"; t: number | null; generation: number}
  | {kind: "mark"; text: string}
  | {kind: "watchLog"; on: boolean}
  | {kind: "stop"};

export type FromWorker =
  | {kind: "moment"; moment: Partial<Moment>; generation: number}
  | {kind: "video"; video: VideoInfo; place: ImagePlace}
  | {kind: "links"; links: LinkInfo[]}
  | {kind: "session"; session: SessionInfo}
  | {kind: "components"; components: ComponentInfo[]}
  | {kind: "map"; map: MapState}
  | {kind: "simulation"; simulation: SimulationInfo}
  | {kind: "replay"; replay: ReplayInfo}
  | {kind: "recorder"; recorder: RecorderInfo}
  | {kind: "lease"; lease: LeaseInfo}
  | {kind: "log"; lines: LogLine[]; lost: number}
  | {kind: "timeline"; timeline: TimelineInfo}
  | {kind: "driving"; active: boolean; why: string}
  | {kind: "reply"; id: number; ok: boolean; value: unknown; error: string};

export interface CommandReply { adjusted: boolean; message: string }
export type HealthGridReply = HealthGrid;

/** Milliseconds of a clock that page and worker share. */
export function nowMs(): number {
  return performance.timeOrigin + performance.now();
}
