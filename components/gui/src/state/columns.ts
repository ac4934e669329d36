// Numbers over time for the plots: bounded columns, 5 values a second, the last 5 minutes. No DOM.
import {wrapAngle} from "../shared/geometry";
import type {Pose2} from "../shared/geometry";
import type {ComponentInfo, Moment, TruthState, VideoInfo} from "../shared/state";
import {column, ground, rowSize} from "../shared/state";

const everyMs = 200;
const most = 1500;

/** Values of one name at shared times; NaN where there is none. */
export class Group {
  readonly times: number[] = [];
  readonly series = new Map<string, number[]>();
  version = 0;

  add(t: number, values: Record<string, number | undefined>): void {
    this.times.push(t);
    for (const name of Object.keys(values)) {
      if (!this.series.has(name)) this.series.set(name, new Array<number>(this.times.length - 1).fill(NaN));
    }
    for (const [name, list] of this.series) list.push(values[name] ?? NaN);
    if (this.times.length > most + 200) {
      this.times.splice(0, 200);
      for (const list of this.series.values()) list.splice(0, 200);
    }
    ++this.version;
  }
}

/** The true poses of the last seconds: an estimate is of an image, which is older than the newest of them. */
class Truths {
  private list: TruthState[] = [];

  add(truth: TruthState | null): void {
    const newest = this.list.at(-1);
    if (!truth || truth.stampUs === newest?.stampUs) return;
    if (newest && truth.stampUs < newest.stampUs) this.list = [];  // the simulation began anew
    this.list.push(truth);
    if (this.list.length > 64) this.list.shift();
  }

  /** Between its neighbours; null beyond them. */
  at(stampUs: number): Pose2 | null {
    const i = this.list.findIndex(truth => truth.stampUs >= stampUs), after = this.list[i], before = this.list[i - 1];
    if (!after || !before) return after?.stampUs === stampUs ? after.pose : null;
    const share = (stampUs - before.stampUs) / (after.stampUs - before.stampUs), {pose: a} = before, {pose: b} = after;
    return {x: a.x + share * (b.x - a.x), y: a.y + share * (b.y - a.y), theta: a.theta + share * wrapAngle(b.theta - a.theta)};
  }
}

export class Columns {
  readonly pose = new Group();
  readonly health = new Group();
  readonly memory = new Group();
  readonly rates = new Group();
  readonly latency = new Group();
  readonly cpu = new Group();
  readonly motion = new Group();
  readonly gauges = new Group();
  private readonly truths = new Truths();
  private error: {metres: number; radians: number} | null = null;
  private last = 0;
  private lastComponents = 0;

  addMoment(m: Moment): void {
    this.truths.add(m.truth);
    if (m.t - this.last < everyMs) return;
    this.last = m.t;
    const e = m.estimate;
    const winner = e?.races.find(r => r.winner);
    const fresh = e && m.t - e.t < 1500 && e.hasPose;
    const truth = fresh ? this.truths.at(e.stampUs) : null;
    // The truth of the newest estimate may still be on its way: the error before stays until then.
    if (!fresh) this.error = null;
    else if (truth) this.error = {metres: Math.hypot(e.world.x - truth.x, e.world.y - truth.y), radians: Math.abs(wrapAngle(e.world.theta - truth.theta))};
    this.pose.add(m.t, {
      "error (m)": this.error?.metres,
      "heading error (deg)": this.error ? this.error.radians * 180 / Math.PI : undefined,
      "sigma (m)": fresh ? Math.sqrt(Math.max(0, e.covariance[0]! + e.covariance[3]!)) : undefined,
      "heading sigma (deg)": fresh ? Math.sqrt(Math.max(0, e.covariance[5]!)) * 180 / Math.PI : undefined,
    });
    this.motion.add(m.t, {
      "x (m)": fresh ? e.world.x : undefined, "y (m)": fresh ? e.world.y : undefined, "heading (deg)": fresh ? e.world.theta * 180 / Math.PI : undefined,
      "speed (m/s)": m.odometry?.v, "turn rate (deg/s)": m.odometry ? m.odometry.w * 180 / Math.PI : undefined,
    });
    this.health.add(m.t, {reliability: e?.reliability, health: winner?.health, weight: winner?.weight});
    this.memory.add(m.t, this.counts(m));
  }

  private counts(m: Moment): Record<string, number | undefined> {
    const memory = m.memory, a = m.analysis;
    let confirmed = 0, life = 0;
    if (memory) {
      for (const g of memory.ground) confirmed += g === ground.confirmed ? 1 : 0;
      for (let i = 0; i < memory.ids.length; ++i) life += memory.rows[i * rowSize + column.life]!;
    }
    return {
      segments: memory?.ids.length, confirmed: memory ? confirmed : undefined, primitives: memory?.primitives.length,
      observed: a ? a.observedLabels.length : undefined, matched: a ? a.matches.length / 2 : undefined,
      "mean life": memory && memory.ids.length > 0 ? life / memory.ids.length : undefined,
    };
  }

  addComponents(t: number, components: ComponentInfo[], video: VideoInfo | null): void {
    if (t - this.lastComponents < 900) return;
    this.lastComponents = t;
    const rates: Record<string, number> = {}, latency: Record<string, number> = {}, cpu: Record<string, number> = {}, gauges: Record<string, number> = {};
    for (const c of components.filter(c => c.alive)) {
      for (const r of c.rates) rates[`${short(c.name)} ${r.name}`] = r.hz;
      for (const l of c.latencies) latency[`${short(c.name)} ${l.name} p95`] = l.p95;
      for (const g of c.gauges) {
        if (g.name === "cpu") cpu[short(c.name)] = g.value;
        else gauges[`${short(c.name)} ${g.name}${g.unit ? ` (${g.unit})` : ""}`] = g.value;
      }
    }
    if (video) rates["page video"] = video.fps;
    this.rates.add(t, rates);
    this.latency.add(t, latency);
    this.cpu.add(t, cpu);
    this.gauges.add(t, gauges);
  }

  get groups(): [GroupName, Group][] { return (Object.keys(groupTitles) as GroupName[]).map(name => [name, this[name]]); }

  /** All that is held, as a table for other programs: a row for each time, empty cells where a number has no value then. */
  csv(): string {
    const rows = new Map<number, string[]>(), heads: string[] = [];
    for (const [title, group] of this.groups) {
      for (const [name, values] of group.series) {
        const at = heads.push(`${groupTitles[title]}: ${name}`) - 1;
        values.forEach((value, i) => {
          if (Number.isNaN(value)) return;
          const t = group.times[i]!, row = rows.get(t) ?? [];
          row[at] = String(value);
          rows.set(t, row);
        });
      }
    }
    const cells = (row: string[]) => heads.map((_, i) => row[i] ?? "").join(",");
    const lines = [...rows].sort(([a], [b]) => a - b).map(([t, row]) => `${new Date(t).toISOString()},${cells(row)}`);
    return [["time_utc", ...heads.map(h => /[",]/.test(h) ? `"${h.replace(/"/g, '""')}"` : h)].join(","), ...lines, ""].join("\n");
  }
}

/** What each group has, in the order of lists. */
export const groupTitles = {motion: "robot", pose: "errors", health: "localization", memory: "memory", gauges: "components", rates: "rate (Hz)", latency: "latency (ms)", cpu: "CPU (% of a core)"} as const;
export type GroupName = keyof typeof groupTitles;

const shorter: Record<string, string> = {active_visual_memory: "memory", localization: "localiz.", simulator: "sim", replay_server: "replay",
  camera_server: "camera", pantilt_server: "pan-tilt", base_server: "base", gui_server: "gui"};
export function short(component: string): string { return shorter[component] ?? component; }
