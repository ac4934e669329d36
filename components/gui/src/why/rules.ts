// Why the robot does not know where it is: pure rules from signals to sentences, the most likely cause first.
import {transform2, compose, inverse} from "../shared/geometry";
import {column, mapRowSize, rowSize} from "../shared/state";
import type {ComponentInfo, LinkInfo, MapState, Moment, ReplayInfo, VideoInfo} from "../shared/state";

export interface Signals {
  /** [ms of the page's clock] */
  now: number;
  moment: Moment;
  video: VideoInfo | null;
  hasCamera: boolean;
  links: readonly LinkInfo[];
  components: readonly ComponentInfo[];
  map: MapState | null;
  replay: ReplayInfo | null;
  /** Folder of cfg/ that the robot was started with; empty: not known. */
  setup: string;
  /** Best "explained" share over all places of the map; null: not asked yet. */
  bestFit: {value: number; at: number} | null;
  /** Nothing moves on purpose: a paused simulation or replay. */
  paused: boolean;
}

export interface Cause {
  id: string;
  text: string;
  advice: string;
  /** 0..1; the list is sorted by it. */
  weight: number;
}

const nothingSeen = 3;
/** Of 255: a covered lens, or night. */
const black = 25;
const unknownShare = 0.6;
const fitsNowhere = 0.35;
const poseIsOldMs = 2000;
/** Reliability from which on the pose is believed. */
const sure = 0.7;

function seconds(ms: number): string { return `${Math.max(0, ms / 1000).toFixed(0)} s`; }

/** All causes that hold at this moment. What is lost weighs more than what is concluded from what is left. */
export function causesOf(s: Signals): Cause[] {
  return [...componentCauses(s), ...cameraCauses(s), ...viewCauses(s), ...mapCauses(s), ...poseCauses(s)];
}

/** @param stands the robot's time is paused, or its recording is at the end: who waits for images then does what it should. */
export function isProblem(c: ComponentInfo, stands: boolean): boolean {
  return !c.alive || (c.state !== "Running" && !(stands && c.state === "Degraded" && c.peers.every(p => p.connected)));
}

/** Nothing came back, not even a refusal: a process that hangs, or a network that drops all. */
export const isSilent = (c: ComponentInfo) => c.message === "no answer in time";

function componentCauses(s: Signals): Cause[] {
  const causes: Cause[] = [], dead = s.components.filter(c => !c.alive && c.version !== ""), setup = s.setup || "SETUP";
  if (dead.length > 1 && dead.length === s.components.length)
    return [{id: "all dead", weight: 1, text: `The robot is gone: none of its ${dead.length} components answers (${dead[0]!.message}).`,
      advice: dead.every(isSilent) ? "Is the network there, and the robot's computer on?" : `Start it again: scripts/start ${setup}`}];
  for (const c of s.components) {
    if (!c.alive && c.version !== "" && isSilent(c))
      causes.push({id: `dead ${c.name}`, weight: 1, text: `${c.name} hangs, or the network to it is lost (${c.message}).`, advice: `If it hangs: scripts/stop ${setup} ${c.name}; scripts/start ${setup} ${c.name}`});
    else if (!c.alive && c.version !== "")
      causes.push({id: `dead ${c.name}`, weight: 1, text: `${c.name} is gone (${c.message}).`, advice: `Start it again: scripts/start ${setup} ${c.name}`});
    else if (!c.alive && s.now - c.since > 2000)
      causes.push({id: `absent ${c.name}`, weight: 0.996, text: `${c.name} does not answer (${c.message}).`, advice: `Is it started? scripts/status ${setup} shows what runs.`});
    for (const p of c.alive ? c.peers : []) {
      if (!p.connected) causes.push({id: `peer ${c.name} ${p.name}`, weight: 0.994, text: `${c.name} has lost ${p.name} (${p.message}).`, advice: "It is asked again by itself; see the pane components."});
    }
    if (c.alive && c.state === "Degraded" && isProblem(c, s.paused) && c.peers.every(p => p.connected))
      causes.push({id: `degraded ${c.name}`, weight: 0.9, text: `${c.name}: ${c.reason}.`, advice: "See the log of that component."});
  }
  return causes;
}

function cameraCauses(s: Signals): Cause[] {
  if (!s.hasCamera || !s.moment.live || s.paused) return [];
  const v = s.video, age = v && v.last > 0 ? s.now - v.last : Infinity;
  if (age < 1000) return [];
  const link = s.links.find(l => l.name === "Camera"), why = link && !link.connected ? `the camera does not answer (${link.message})` : v?.message || "the camera gives none";
  return [{id: "no images", weight: 0.992, text: age === Infinity ? `No image yet: ${why}.` : `No images for ${seconds(age)}: ${why}.`, advice: "Check the camera's server and cable."}];
}

function viewCauses(s: Signals): Cause[] {
  const a = s.moment.analysis, m = s.moment.memory;
  const causes: Cause[] = [];
  if (!a || s.moment.t - a.t > 2000) return causes;
  const n = a.observedLabels.length;
  const light = s.video?.brightness ?? null;
  if (n < nothingSeen && light !== null && light < black) {
    causes.push({id: "dark", weight: 0.9915, text: `The picture is black (brightness ${light.toFixed(0)} of 255): is the lens covered, or the light off?`, advice: "Free the lens, or switch the light on."});
  } else if (n < nothingSeen) {
    causes.push({id: "nothing seen", weight: 0.991, text: `Almost no lines in view (${n}): a plain wall, or something right before the lens?`, advice: "Turn the robot, or free the view."});
  } else {
    const unknown = a.labelNames.indexOf("unknown");
    let count = 0;
    for (const label of a.observedLabels) if (label === unknown) ++count;
    if (count / n > unknownShare && n >= 6)
      causes.push({id: "labels unknown", weight: 0.7, text: `${(100 * count / n).toFixed(0)} % of the lines in view have no known colours: wrong palette or changed light?`, advice: "Learn the palette again, or light the scene as before."});
  }
  if (a.predictedIds.length >= 5 && a.matches.length / 2 < 0.3 * a.predictedIds.length)
    causes.push({id: "memory wrong", weight: 0.6, text: `What is seen is not where it was remembered (${a.matches.length / 2} of ${a.predictedIds.length} expected lines found): wheels slipped, or the robot was moved.`, advice: "Wait: the memory begins anew by itself; or reset it."});
  if (m) {
    const r = meanResultant(m.rows, m.ids.length);
    if (m.ids.length >= 4 && r > 0.9)
      causes.push({id: "one direction", weight: 0.55, text: "All remembered lines run one way: the place along them cannot be known.", advice: "Drive to where lines cross, or look round."});
  }
  return causes;
}

/** Length of the mean of doubled directions, weighted by length: 1 when all lines are parallel. */
export function meanResultant(rows: Float32Array, count: number): number {
  let c = 0, s = 0, total = 0;
  for (let i = 0; i < count; ++i) {
    const k = i * rowSize, dx = rows[k + column.bx]! - rows[k]!, dy = rows[k + column.by]! - rows[k + 1]!, l = Math.hypot(dx, dy);
    if (l < 0.05) continue;
    const angle = 2 * Math.atan2(dy, dx);
    c += l * Math.cos(angle);
    s += l * Math.sin(angle);
    total += l;
  }
  return total > 0 ? Math.hypot(c, s) / total : 0;
}

function mapCauses(s: Signals): Cause[] {
  const causes: Cause[] = [], {map} = s, memory = s.moment.memory;
  const misfits = s.bestFit !== null && s.now - s.bestFit.at < 8000 && s.bestFit.value < fitsNowhere;
  if (s.bestFit && misfits)
    causes.push({id: "fits nowhere", weight: 0.99, text: `No place of this map fits: the best one explains ${(100 * s.bestFit.value).toFixed(0)} % of what is seen. Is it the map of another world?`, advice: "Give the map of this world: Localization.Map."});
  if (!map || !memory || memory.ids.length < 4 || map.labels.includes("any")) return causes;
  const seen = new Map<string, number>();
  memory.labels.forEach(label => {
    const name = memory.labelNames[label] ?? "";
    if (name !== "unknown") seen.set(name, (seen.get(name) ?? 0) + 1);
  });
  const lacking = [...seen].filter(([name]) => !map.labels.includes(name)).sort((a, b) => b[1] - a[1]);
  const all = [...seen.values()].reduce((a, b) => a + b, 0), foreign = lacking.reduce((a, [, n]) => a + n, 0);
  // A few foreign labels are a misread colour, unless no place fits anyway.
  if (foreign > 0 && (misfits || foreign >= 0.2 * all))
    causes.push({id: "labels lacking", weight: 0.98, text: `The map lacks ${lacking.slice(0, 4).map(([name, n]) => `'${name}' (the memory has ${n})`).join(", ")}.`, advice: "The map, or its palette, is of another world."});
  const unseen = map.labels.filter(name => !seen.has(name));
  if (misfits && foreign === 0 && unseen.length > 0)
    causes.push({id: "labels unseen", weight: 0.975, text: `The map has ${unseen.slice(0, 4).map(name => `'${name}'`).join(", ")}, which the memory has not seen.`, advice: "The map may be of another world."});
  return causes;
}

/** Whether the memory has labels and the map has none of them: then no place can explain anything. */
export function sharesNoLabel(m: Moment, map: MapState): boolean {
  if (!m.memory || m.memory.ids.length < 4 || map.labels.includes("any")) return false;
  const names = [...m.memory.labels].map(label => m.memory!.labelNames[label] ?? "").filter(name => name !== "unknown");
  return names.length > 0 && names.every(name => !map.labels.includes(name));
}

function poseCauses(s: Signals): Cause[] {
  const causes: Cause[] = [], {moment: m, map} = s, e = m.estimate;
  if (!e) return causes;
  const late = m.t - e.t;
  if (late > poseIsOldMs && m.live && !s.paused) causes.push({id: "estimate late", weight: 0.65, text: `The last pose is ${seconds(late)} old.`, advice: "Is the visual memory running?"});
  if (!e.hasPose && e.races.length === 0) causes.push({id: "no pose", weight: 0.5, text: "Searching everywhere: no place is good enough to follow yet.", advice: "Let the robot look round or drive a little."});
  const sorted = [...e.races].sort((a, b) => b.weight - a.weight), [first, second] = sorted;
  if (first && second && e.reliability < sure && second.weight > 0.2 && Math.hypot(first.pose.x - second.pose.x, first.pose.y - second.pose.y) > 1)
    causes.push({id: "ambiguous", weight: 0.58, text: `Two places fit: ${(100 * first.weight).toFixed(0)} % and ${(100 * second.weight).toFixed(0)} %.`, advice: "Drive to where they differ; both are drawn."});
  if (m.truth?.inCollision) causes.push({id: "base held", weight: 0.52, text: "The base stands against something.", advice: "Drive back."});
  if (e.hasPose && map && m.memory && e.reliability < 0.5) {
    const share = fitShare(m, map);
    if (share !== null && share < 0.35) causes.push({id: "fits badly", weight: 0.57, text: `Only ${(100 * share).toFixed(0)} % of what is remembered lies on lines of the map at the estimated pose.`, advice: "Relocalize, or set the pose."});
  }
  return causes;
}

/** Share of remembered length whose middle lies within 20 cm of a line of the map. */
export function fitShare(m: Moment, map: MapState): number | null {
  const e = m.estimate, memory = m.memory;
  if (!e?.hasPose || !memory || memory.ids.length < 4) return null;
  const T = compose(e.world, inverse(e.odom)), r = map.rows;
  let good = 0, total = 0;
  for (let i = 0; i < memory.ids.length; ++i) {
    const k = i * rowSize, v = memory.rows, l = Math.hypot(v[k + 3]! - v[k]!, v[k + 4]! - v[k + 1]!);
    const p = transform2(T, (v[k]! + v[k + 3]!) / 2, (v[k + 1]! + v[k + 4]!) / 2);
    total += l;
    for (let j = 0; j < r.length; j += mapRowSize) {
      const dx = r[j + 3]! - r[j]!, dy = r[j + 4]! - r[j + 1]!, n = dx * dx + dy * dy;
      const t = n > 0 ? Math.min(1, Math.max(0, ((p.x - r[j]!) * dx + (p.y - r[j + 1]!) * dy) / n)) : 0;
      if (Math.hypot(p.x - r[j]! - t * dx, p.y - r[j + 1]! - t * dy) < 0.2 + r[j + 6]! / 2) { good += l; break; }
    }
  }
  return total > 0 ? good / total : null;
}

export interface Verdict { level: "good" | "warning" | "bad"; text: string }

/** @param stands the robot's time is paused, or its recording is at the end: a pose does not grow old then. */
export function verdictOf(m: Moment, now: number, stands: boolean): Verdict {
  const e = m.estimate;
  if (!e) return {level: "bad", text: "no pose yet"};
  if (m.live && !stands && now - e.t > poseIsOldMs) return {level: "bad", text: `no pose for ${seconds(now - e.t)}`};
  if (!e.hasPose) return {level: "bad", text: "searching everywhere"};
  const r = e.reliability.toFixed(2);
  if (e.reliability >= sure) return {level: "good", text: `knows where it is, ${r}`};
  return e.reliability >= 0.4 ? {level: "warning", text: `not sure, ${r}`} : {level: "bad", text: `lost, ${r}`};
}

/** Keeps causes for which a short look is not enough, and since when each holds. */
export class CauseWatch {
  private readonly since = new Map<string, number>();
  private readonly lastSeen = new Map<string, number>();

  /** @return causes that have held for `holdMs` (0 for losses of components), sorted, with their start. */
  update(causes: readonly Cause[], now: number): {cause: Cause; since: number}[] {
    const slow = new Set(["nothing seen", "dark", "labels unknown", "memory wrong", "one direction", "ambiguous", "fits badly"]);
    for (const cause of causes) {
      if (now - (this.lastSeen.get(cause.id) ?? -Infinity) > 1500) this.since.set(cause.id, now);
      this.lastSeen.set(cause.id, now);
    }
    return causes.map(cause => ({cause, since: this.since.get(cause.id)!}))
      .filter(({cause, since}) => !slow.has(cause.id) || now - since >= 1500)
      .sort((a, b) => b.cause.weight - a.cause.weight);
  }
}
