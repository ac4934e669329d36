// From Ice's values to those of src/shared/state.ts. Slice's `long` is an Ice.Long here; stamps and ids stay below 2^53 and become numbers.
/* eslint-disable @typescript-eslint/no-explicit-any */
import type {Intrinsics, Pose2, Pose3} from "../shared/geometry";
import {ground, rowSize} from "../shared/state";
import type {
  AnalysisState, AttentionPoint, ComponentInfo, EstimateState, GazeState, HealthGrid, LogLine, MapState, MemoryState, Parameter, Primitive,
  RecorderInfo, ReplayInfo, SimulationInfo, TruthState,
} from "../shared/state";

const num = (long: any): number => typeof long === "number" ? long : long.toNumber();
const word = (value: any): string => value?.name ?? String(value);
const pose2 = (p: any): Pose2 => ({x: p.x, y: p.y, theta: p.theta});
const pose3 = (p: any): Pose3 => ({x: p.position.x, y: p.position.y, z: p.position.z, qw: p.qw, qx: p.qx, qy: p.qy, qz: p.qz});

/** Names of labels, each with a number that stays. */
export class LabelTable {
  readonly names: string[] = [];
  private readonly numbers = new Map<string, number>();

  number(name: string): number {
    let n = this.numbers.get(name);
    if (n === undefined) {
      n = this.names.length;
      this.names.push(name);
      this.numbers.set(name, n);
    }
    return n;
  }
}

export function lensOf(m: any): Intrinsics {
  return {width: m.width, height: m.height, fx: m.fx, fy: m.fy, cx: m.cx, cy: m.cy, k1: m.k1, k2: m.k2, p1: m.p1, p2: m.p2, k3: m.k3};
}

function writeSymmetric(rows: Float32Array, at: number, c: any): void {
  rows[at] = c.m00; rows[at + 1] = c.m01; rows[at + 2] = c.m02; rows[at + 3] = c.m11; rows[at + 4] = c.m12; rows[at + 5] = c.m22;
}

function primitiveOf(p: any): Primitive {
  return {
    id: num(p.id), kind: word(p.kind) as Primitive["kind"], vertices: p.vertices.flatMap((v: any) => [v.x, v.y]), x: p.centre.x, y: p.centre.y,
    heading: p.heading, lengthM: p.lengthM, widthM: p.widthM, radiusM: p.radiusM, hiddenVertex: p.hiddenVertex, quality: p.quality, life: p.life,
    salience: p.salience, segments: p.segments.map(num),
  };
}

export function memoryOf(snapshot: any, t: number, labels: LabelTable, stampBaseUs: number): MemoryState {
  const segments = [...snapshot.segments].sort((a: any, b: any) => num(a.id) - num(b.id));
  const n = segments.length;
  const state: MemoryState = {
    t, stampUs: num(snapshot.stampUs), revision: num(snapshot.revision), epoch: snapshot.epoch, robot: pose2(snapshot.robotInOdom),
    ids: new Float64Array(n), rows: new Float32Array(n * rowSize), labels: new Uint16Array(n), ground: new Uint8Array(n),
    labelNames: labels.names, stampBaseUs, primitives: snapshot.primitives.map(primitiveOf),
    hypotheses: snapshot.hypotheses.map((h: any) => ({primitive: num(h.primitive), x: h.place.x, y: h.place.y})),
  };
  segments.forEach((s: any, i: number) => {
    const at = i * rowSize, r = state.rows;
    state.ids[i] = num(s.id);
    r[at] = s.a.x; r[at + 1] = s.a.y; r[at + 2] = s.a.z; r[at + 3] = s.b.x; r[at + 4] = s.b.y; r[at + 5] = s.b.z;
    writeSymmetric(r, at + 6, s.covarianceA);
    writeSymmetric(r, at + 12, s.covarianceB);
    r[at + 18] = s.life; r[at + 19] = s.salience;
    r[at + 20] = (num(s.firstSeenUs) - stampBaseUs) / 1e6; r[at + 21] = (num(s.lastSeenUs) - stampBaseUs) / 1e6;
    state.labels[i] = labels.number(s.label);
    state.ground[i] = s.offFloor ? ground.off : s.confirmed ? ground.confirmed : ground.notYet;
  });
  return state;
}

export function analysisOf(a: any, t: number, labels: LabelTable): AnalysisState {
  const observed = new Float32Array(a.observed.length * 5), observedLabels = new Uint16Array(a.observed.length);
  a.observed.forEach((s: any, i: number) => {
    observed.set([s.a.x, s.a.y, s.b.x, s.b.y, s.strength], i * 5);
    observedLabels[i] = labels.number(s.label);
  });
  const predicted = new Float32Array(a.predicted.length * 4), predictedIds = new Float64Array(a.predicted.length);
  a.predicted.forEach((s: any, i: number) => {
    predicted.set([s.a.x, s.a.y, s.b.x, s.b.y], i * 4);
    predictedIds[i] = num(s.id);
  });
  const matches = new Uint16Array(a.matches.length * 2);
  a.matches.forEach((m: any, i: number) => matches.set([m.observed, m.predicted], i * 2));
  return {
    t, stampUs: num(a.stampUs), frameSeq: num(a.frameSeq), lens: lensOf(a.cameraModel), robot: pose2(a.robotInOdom), camera: pose3(a.cameraOnRobot),
    observed, observedLabels, predicted, predictedIds, matches, labelNames: labels.names,
  };
}

export function estimateOf(e: any, t: number): EstimateState {
  const c = e.covariance;
  return {
    t, stampUs: num(e.stampUs), revision: num(e.revision), hasPose: e.hasPose, world: pose2(e.robotInWorld), odom: pose2(e.robotInOdom),
    covariance: [c.m00, c.m01, c.m02, c.m11, c.m12, c.m22], reliability: e.reliability,
    races: e.races.map((r: any) => ({id: num(r.id), pose: pose2(r.robotInWorld), health: r.health, weight: r.weight, victories: r.victories, age: r.age, winner: r.winner})),
  };
}

function attentionOf(p: any): AttentionPoint {
  const {place, direction} = p.target;
  return {
    id: num(p.id), kind: word(p.kind) as AttentionPoint["kind"], isPlace: p.target.isPlace, x: place.x, y: place.y, z: place.z,
    pan: direction.panRad, tilt: direction.tiltRad, salience: p.salience,
  };
}

export function gazeOf(g: any, t: number): GazeState {
  return {
    t, stampUs: num(g.stampUs), mode: word(g.mode) as GazeState["mode"], state: word(g.state) as GazeState["state"],
    target: g.hasTarget ? attentionOf(g.target) : null, points: g.points.map(attentionOf), visits: num(g.visits), givenUp: num(g.givenUp),
  };
}

export function truthOf(s: any, t: number): TruthState {
  return {t, stampUs: num(s.stampUs), pose: pose2(s.robotInWorld), inCollision: s.inCollision, kidnaps: s.kidnaps};
}

export function mapOf(m: any): MapState {
  const table = new LabelTable(), rows = new Float32Array(m.segments.length * 8);
  m.segments.forEach((s: any, i: number) => rows.set([s.a.x, s.a.y, s.a.z, s.b.x, s.b.y, s.b.z, s.widthM, table.number(s.label)], i * 8));
  return {id: m.id, name: m.name, labels: table.names, rows};
}

export function statusOf(s: any): Omit<ComponentInfo, "name" | "alive" | "message" | "since"> {
  return {
    state: word(s.state), reason: s.reason, version: s.version, uptimeS: s.uptimeS,
    peers: s.peers.map((p: any) => ({name: p.name, proxy: p.proxy, connected: p.connected, message: p.message, reconnections: p.reconnections})),
    rates: s.rates.map((r: any) => ({name: r.name, hz: r.hz, total: num(r.total)})),
    latencies: s.latencies.map((l: any) => ({name: l.name, samples: num(l.samples), p50: l.p50Ms, p95: l.p95Ms, p99: l.p99Ms, max: l.maxMs})),
    gauges: s.gauges.map((g: any) => ({name: g.name, value: g.value, sigma: g.sigma, unit: g.unit})),
    errors: s.errors.map((e: any) => ({stampUs: num(e.stampUs), text: e.text})),
  };
}

export function simulationOf(s: any, models: any[]): SimulationInfo {
  return {
    world: s.world, seed: num(s.seed), stampUs: num(s.stampUs), paused: s.paused, speed: s.speed, realSpeed: s.realSpeed, lockStep: s.lockStep,
    models: models.map((m: any) => ({name: m.name, x: m.modelInWorld.position.x, y: m.modelInWorld.position.y, present: m.present, walking: m.walking})),
  };
}

export function replayOf(r: any): ReplayInfo {
  return {
    state: word(r.state), file: r.file, firstUs: num(r.firstUs), lastUs: num(r.lastUs), stampUs: num(r.stampUs), rate: r.rate, loop: r.loop,
  };
}

export function recorderOf(r: any): RecorderInfo {
  return {state: word(r.state) as RecorderInfo["state"], message: r.message, path: r.path, bytes: num(r.bytes), messages: num(r.messages),
    seconds: (num(r.endUs) - num(r.beginUs)) / 1e6, ringS: r.ringS};
}

export function gridOf(g: any): HealthGrid {
  return {
    stampUs: num(g.stampUs), low: {x: g.low.x, y: g.low.y}, cellM: g.cellM, columns: g.columns, rows: g.rows,
    health: Float32Array.from(g.health), thetaRad: Float32Array.from(g.thetaRad),
  };
}

export function logLineOf(component: string, e: any): LogLine {
  return {component, seq: num(e.seq), stampUs: num(e.stampUs), level: word(e.level) as LogLine["level"], text: e.text};
}

export function parameterOf(component: string, p: any): Parameter {
  return {
    component, name: p.name, unit: p.unit, minimum: p.minimum, maximum: p.maximum, whole: p.whole, value: p.value, configured: p.configured,
    description: p.description,
  };
}

export {num, word, pose2, pose3};
