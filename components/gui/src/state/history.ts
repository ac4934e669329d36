// What the page remembers: the last 5 minutes of every stream in at most 96 MB. No DOM, no Ice.
import {emptyMoment} from "../shared/state";
import type {
  AnalysisState, EstimateState, GazeState, Mark, MemoryState, Moment, OdometryState, TimelineInfo, TruthState,
} from "../shared/state";
import {hashOf, ImageRing} from "./image_ring";
import type {StoredImage} from "./image_ring";
import {SnapshotRing} from "./snapshot_ring";
import {TimedList} from "./timed_list";

export const spanMs = 300_000;
export const budgetBytes = 96 * 1024 * 1024;
const imageBudget = 64 * 1024 * 1024;
/** Of the smaller streams, which are counted by their number: about what an object with these fields takes. */
const entryBytes = {estimate: 1500, gaze: 4000, truth: 250, odometry: 250};

/** Analyses that wait for their image, which comes on a connection of its own. */
const waitingAnalyses = 8;
/** So much older than its image an analysis may be shown with it [ms]. */
const analysisReachMs = 500;

export class History {
  readonly images = new ImageRing(imageBudget, spanMs);
  readonly snapshots = new SnapshotRing(spanMs);
  readonly marks = new TimedList<Mark>();
  private readonly estimates = new TimedList<EstimateState>();
  private readonly gazes = new TimedList<GazeState>();
  private readonly truths = new TimedList<TruthState>();
  private readonly odometries = new TimedList<OdometryState>();
  private lastSnapshot = -Infinity;
  private lastEpoch = -1;
  private lastKidnaps = -1;
  private early: AnalysisState[] = [];

  addImage(image: Omit<StoredImage, "hash" | "analysis">): StoredImage {
    const analysis = this.early.find(a => a.frameSeq === image.seq) ?? null;
    if (analysis) this.early = this.early.filter(a => a.frameSeq > image.seq);
    const stored = {...image, hash: hashOf(image.jpeg), analysis};
    this.images.push(stored);
    return stored;
  }

  /** Comes before or after its image. */
  addAnalysis(analysis: AnalysisState): void {
    if (!this.images.attach(analysis)) this.early = [...this.early, analysis].slice(-waitingAnalyses);
  }

  /** At most 10 a second. */
  addMemory(memory: MemoryState): void {
    if (this.lastEpoch >= 0 && memory.epoch !== this.lastEpoch) this.mark({t: memory.t, kind: "epoch", text: `memory begins anew (epoch ${memory.epoch})`});
    const due = memory.t - this.lastSnapshot >= 95 || memory.epoch !== this.lastEpoch;
    this.lastEpoch = memory.epoch;
    if (!due) return;
    this.lastSnapshot = memory.t;
    this.snapshots.push(memory);
  }

  addEstimate(estimate: EstimateState): void { this.add(this.estimates, estimate, 60); }
  addGaze(gaze: GazeState): void { this.add(this.gazes, gaze, 95); }
  addOdometry(odometry: OdometryState): void { this.add(this.odometries, odometry, 60); }

  addTruth(truth: TruthState): void {
    if (this.lastKidnaps >= 0 && truth.kidnaps > this.lastKidnaps) this.mark({t: truth.t, kind: "kidnap", text: "the robot was put elsewhere"});
    this.lastKidnaps = truth.kidnaps;
    this.add(this.truths, truth, 60);
  }

  mark(mark: Mark): void {
    this.marks.push(mark);
    this.marks.dropBefore(mark.t - spanMs);
    while (this.marks.length > 500) this.marks.shift();
  }

  private add<T extends {t: number}>(list: TimedList<T>, item: T, everyMs: number): void {
    if (list.last && item.t - list.last.t < everyMs) return;
    list.push(item);
    list.dropBefore(item.t - spanMs);
  }

  get bytes(): number {
    return this.images.bytes + this.snapshots.bytes + this.estimates.length * entryBytes.estimate + this.gazes.length * entryBytes.gaze +
      this.truths.length * entryBytes.truth + this.odometries.length * entryBytes.odometry;
  }

  get from(): number | undefined {
    const starts = [this.images.from, this.snapshots.from, this.estimates.first?.t].filter((t): t is number => t !== undefined);
    return starts.length > 0 ? Math.min(...starts) : undefined;
  }

  /** The last value of every stream at or before t. */
  momentAt(t: number): {moment: Moment; image: StoredImage | null} {
    const image = this.images.before(t) ?? null;
    const frame = image ? {t: image.t, stampUs: image.stampUs, seq: image.seq, width: image.width, height: image.height, bytes: image.jpeg.byteLength, hash: image.hash} : null;
    return {
      image,
      moment: {
        ...emptyMoment, t, live: false, frame, analysis: this.images.analysisBefore(t, analysisReachMs), memory: this.snapshots.before(t), estimate: this.estimates.before(t) ?? null,
        gaze: this.gazes.before(t) ?? null, truth: this.truths.before(t) ?? null, odometry: this.odometries.before(t) ?? null,
      },
    };
  }

  timeline(now: number): TimelineInfo {
    return {
      from: Math.max(this.from ?? now, now - spanMs), to: now, bytes: this.bytes, budget: budgetBytes, images: this.images.length,
      snapshots: this.snapshots.length, oldRate: 1000 / this.images.spacingMs, marks: [...this.marks],
    };
  }
}
