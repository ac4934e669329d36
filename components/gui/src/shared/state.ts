// What the robot was at a moment, as plain values that go between worker and page. No Ice, no DOM.
import type {Intrinsics, Pose2, Pose3} from "./geometry";

/** Columns of a row of MemoryState.rows. */
export const rowSize = 22;
export const column = {ax: 0, ay: 1, az: 2, bx: 3, by: 4, bz: 5, covA: 6, covB: 12, life: 18, salience: 19, firstSeen: 20, lastSeen: 21} as const;

/** What is known of a remembered segment's place on the floor. */
export const ground = {notYet: 0, confirmed: 1, off: 2} as const;

export interface Primitive {
  id: number;
  kind: "Stripe" | "Parallelogram" | "Triangle" | "Arrow" | "Circle";
  /** x, y in odom [m], in turn. */
  vertices: number[];
  x: number; y: number; heading: number; lengthM: number; widthM: number; radiusM: number;
  hiddenVertex: number; quality: number; life: number; salience: number; segments: number[];
}

/** One snapshot of the visual memory. Row i belongs to ids[i]; ids ascend. */
export interface MemoryState {
  /** Received [ms of the page's clock]. */
  t: number;
  stampUs: number;
  revision: number;
  epoch: number;
  robot: Pose2;
  ids: Float64Array;
  /** rowSize numbers a segment: ends in odom [m], covariances of the ends (upper triangle) [m^2], life, salience, first and last
   *  seen [s after stampBaseUs]. */
  rows: Float32Array;
  labels: Uint16Array;
  /** A value of `ground` each. */
  ground: Uint8Array;
  labelNames: string[];
  stampBaseUs: number;
  primitives: Primitive[];
  hypotheses: {primitive: number; x: number; y: number}[];
}

/** The 2-D side of one image. */
export interface AnalysisState {
  t: number;
  stampUs: number;
  frameSeq: number;
  lens: Intrinsics;
  robot: Pose2;
  camera: Pose3;
  /** ax, ay, bx, by [ideal px], strength. */
  observed: Float32Array;
  observedLabels: Uint16Array;
  /** ax, ay, bx, by [ideal px]. */
  predicted: Float32Array;
  predictedIds: Float64Array;
  /** Pairs observed, predicted. */
  matches: Uint16Array;
  labelNames: string[];
}

export interface Race {
  id: number; pose: Pose2; health: number; weight: number; victories: number; age: number; winner: boolean;
}

export interface EstimateState {
  t: number;
  stampUs: number;
  revision: number;
  hasPose: boolean;
  world: Pose2;
  odom: Pose2;
  /** Upper triangle of (x, y, theta). */
  covariance: number[];
  reliability: number;
  races: Race[];
}

export interface AttentionPoint {
  id: number;
  kind: "Segment" | "Primitive" | "Scanning" | "Hypothesis" | "Client";
  isPlace: boolean;
  /** In odom [m] when isPlace. */
  x: number; y: number; z: number;
  /** Of the head [rad] otherwise. */
  pan: number; tilt: number;
  salience: number;
}

export interface GazeState {
  t: number;
  stampUs: number;
  mode: "Attend" | "Fixate" | "Hold" | "Off";
  state: "Select" | "Saccade" | "Analyse" | "Track";
  target: AttentionPoint | null;
  points: AttentionPoint[];
  visits: number;
  givenUp: number;
}

export interface TruthState { t: number; stampUs: number; pose: Pose2; inCollision: boolean; kidnaps: number }
export interface OdometryState { t: number; stampUs: number; pose: Pose2; v: number; w: number }

export interface MapState {
  id: string;
  name: string;
  labels: string[];
  /** ax, ay, az, bx, by, bz in world [m], width [m], index of the label. */
  rows: Float32Array;
}
export const mapRowSize = 8;

export interface FrameState {
  t: number; stampUs: number; seq: number; width: number; height: number; bytes: number;
  /** FNV-1a of the JPEG file: two moments with equal numbers show the same image. */
  hash: number;
}

/** All that is shown at once: the newest of each stream, or the last of each at or before a moment of the past. */
export interface Moment {
  /** The moment itself [ms of the page's clock]. */
  t: number;
  live: boolean;
  frame: FrameState | null;
  analysis: AnalysisState | null;
  memory: MemoryState | null;
  estimate: EstimateState | null;
  gaze: GazeState | null;
  truth: TruthState | null;
  odometry: OdometryState | null;
}

export const emptyMoment: Moment = {
  t: 0, live: true, frame: null, analysis: null, memory: null, estimate: null, gaze: null, truth: null, odometry: null,
};

export interface ComponentInfo {
  name: string;
  alive: boolean;
  /** Why it does not answer; empty while it does. */
  message: string;
  /** Since when [ms of the page's clock]. */
  since: number;
  state: string;
  reason: string;
  version: string;
  uptimeS: number;
  peers: {name: string; proxy: string; connected: boolean; message: string; reconnections: number}[];
  rates: {name: string; hz: number; total: number}[];
  latencies: {name: string; samples: number; p50: number; p95: number; p99: number; max: number}[];
  gauges: {name: string; value: number; sigma: number; unit: string}[];
  errors: {stampUs: number; text: string}[];
}

export interface LinkInfo { name: string; connected: boolean; message: string; since: number }

export interface VideoInfo {
  /** Drawn frames per second, and those the source counted. */
  fps: number; sourceFps: number;
  /** Age over the best of the last 30 s [ms]; half of the smallest round trip is in it. */
  ageMs: number;
  roundTripMs: number;
  stampUs: number; width: number; height: number;
  /** Mean of the picture's colours [0..255]; null: none was drawn. */
  brightness: number | null;
  state: "Running" | "Waiting" | "Finished";
  message: string;
  /** When the last frame came [ms of the page's clock]; 0: never. */
  last: number;
}

export interface SimulationInfo {
  world: string; seed: number; stampUs: number; paused: boolean; speed: number; realSpeed: number; lockStep: number;
  models: {name: string; x: number; y: number; present: boolean; walking: boolean}[];
}

export interface ReplayInfo {
  state: string; file: string; firstUs: number; lastUs: number; stampUs: number; rate: number; loop: boolean;
}

/** Whether the robot's time stands still on purpose. @param answers whether the object of a name does. */
export function timeStands(answers: (name: string) => boolean, simulation: SimulationInfo | null, replay: ReplayInfo | null): boolean {
  return (answers("Simulation") && simulation?.paused === true) || (answers("Replay") && ["PAUSED", "FINISHED"].includes(replay?.state ?? ""));
}

export interface RecorderInfo {
  state: "Idle" | "Recording" | "Failed"; message: string; path: string; bytes: number; messages: number; seconds: number;
  /** Seconds in the ring buffer. */
  ringS: number;
}

export interface LeaseInfo { held: boolean; client: string; priority: number; implicit: boolean; remainingS: number; mine: boolean }

export interface LogLine { component: string; seq: number; stampUs: number; level: "Debug" | "Info" | "Warning" | "Error"; text: string }

export interface Parameter {
  component: string; name: string; unit: string; minimum: number; maximum: number; whole: boolean; value: number;
  configured: number; description: string;
}

export interface Mark { t: number; kind: "epoch" | "kidnap" | "lost" | "user"; text: string }

export interface TimelineInfo {
  /** First and last moment held [ms of the page's clock]. */
  from: number; to: number;
  bytes: number; budget: number;
  images: number; snapshots: number;
  /** Images a second in the older part. */
  oldRate: number;
  marks: Mark[];
}

export interface HealthGrid {
  stampUs: number; low: {x: number; y: number}; cellM: number; columns: number; rows: number; health: Float32Array; thetaRad: Float32Array;
}
