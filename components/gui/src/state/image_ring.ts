// Encoded images of the last minutes within a budget of bytes: all of the last 30 s, then 5 per second. No DOM.
import type {AnalysisState} from "../shared/state";
import {TimedList} from "./timed_list";

export interface StoredImage {
  t: number;
  stampUs: number;
  seq: number;
  width: number;
  height: number;
  jpeg: Uint8Array;
  hash: number;
  analysis: AnalysisState | null;
}

/** Objects and typed arrays themselves, beside what is in the arrays. */
const imageObjects = 400;
const analysisObjects = 1500;

function sizeOf(image: StoredImage): number {
  const a = image.analysis;
  return image.jpeg.byteLength + imageObjects + (a ? a.observed.byteLength + a.predicted.byteLength + a.predictedIds.byteLength + a.matches.byteLength + analysisObjects : 0);
}

export class ImageRing {
  readonly recent = new TimedList<StoredImage>();
  readonly old = new TimedList<StoredImage>();
  bytes = 0;
  /** Distance of images in the older part [ms]; doubled when the budget does not last. */
  spacingMs = 200;
  private recentMs = 30_000;

  constructor(readonly budget: number, readonly spanMs: number) {}

  push(image: StoredImage): void {
    this.recent.push(image);
    this.bytes += sizeOf(image);
    this.age(image.t);
    // Never cut the span: thin the older part, and in the end shorten the part that holds every image.
    while (this.bytes > this.budget && this.length > 2) {
      if (this.spacingMs < 10_000) this.spacingMs *= 2;
      else if (this.recentMs > 1_000) this.recentMs /= 2;
      else break;
      this.thin();
      this.age(image.t);
    }
  }

  /** Gives an image its analysis. @return false when that image is not among the last ones. */
  attach(analysis: AnalysisState): boolean {
    for (let i = this.recent.length - 1; i >= 0 && i >= this.recent.length - 30; --i) {
      const image = this.recent.at(i)!;
      if (image.seq !== analysis.frameSeq) continue;
      this.bytes -= sizeOf(image);
      image.analysis = analysis;
      this.bytes += sizeOf(image);
      return true;
    }
    return false;
  }

  before(t: number): StoredImage | undefined {
    return this.recent.before(t) ?? this.old.before(t);
  }

  /** The analysis of the last image at or before t that has one, at most `reachMs` older: the memory passes images over. */
  analysisBefore(t: number, reachMs: number): AnalysisState | null {
    for (const list of [this.recent, this.old]) {
      for (let i = list.indexAt(t); i >= 0 && list.at(i)!.t >= t - reachMs; --i) {
        const {analysis} = list.at(i)!;
        if (analysis) return analysis;
      }
    }
    return null;
  }

  get length(): number { return this.recent.length + this.old.length; }
  get from(): number | undefined { return (this.old.first ?? this.recent.first)?.t; }

  private age(now: number): void {
    while (this.recent.first && this.recent.first.t < now - this.recentMs) {
      const image = this.recent.shift()!;
      const last = this.old.last;
      if (!last || Math.floor(image.t / this.spacingMs) !== Math.floor(last.t / this.spacingMs)) this.old.push(image);
      else this.bytes -= sizeOf(image);
    }
    while (this.old.first && this.old.first.t < now - this.spanMs) this.bytes -= sizeOf(this.old.shift()!);
  }

  private thin(): void {
    let last = -1;
    this.old.filter(image => {
      const bucket = Math.floor(image.t / this.spacingMs);
      const keep = bucket !== last;
      last = bucket;
      if (!keep) this.bytes -= sizeOf(image);
      return keep;
    });
  }
}

/** FNV-1a of the bytes, 32 bits. */
export function hashOf(bytes: Uint8Array): number {
  let hash = 0x811c9dc5;
  for (let i = 0; i < bytes.length; ++i) hash = Math.imul(hash ^ bytes[i]!, 0x01000193);
  return hash >>> 0;
}
