// Snapshots of the visual memory of the last minutes: a whole one each 5 s, between them what differs. No DOM.
//
// A difference holds the rows that are new or whose geometry moved by more than 0.1 mm since what the ring has of them, the ids that went, and
// life and salience of all as 16 bits (1/65535 of the largest value of that snapshot). Pose, stamps, ids, labels and numbers are exact.
import {column, rowSize} from "../shared/state";
import type {MemoryState, Primitive} from "../shared/state";
import {TimedList} from "./timed_list";

interface Record {
  t: number;
  stampUs: number;
  revision: number;
  epoch: number;
  robot: {x: number; y: number; theta: number};
  whole: boolean;
  removed: Float64Array;
  ids: Float64Array;
  rows: Float32Array;
  labels: Uint16Array;
  ground: Uint8Array;
  lifeScale: number;
  salienceScale: number;
  /** Life, then salience, of all segments in the order of their ids. */
  levels: Uint16Array;
  primitives: Primitive[];
  hypotheses: {primitive: number; x: number; y: number}[];
  bytes: number;
}

interface Row { values: Float32Array; label: number; ground: number }

const keyMs = 5000;
const closeEnough = 1e-4;
/** A record's objects and typed arrays themselves, beside what is in the arrays. */
const recordObjects = 1500;

function moved(a: Float32Array, b: Float32Array): boolean {
  for (let i = 0; i < 18; ++i) if (Math.abs(a[i]! - b[i]!) > closeEnough) return true;
  return a[column.lastSeen] !== b[column.lastSeen];
}

/** Applies a record to the rows of the snapshot before it. */
function apply(rows: Map<number, Row>, record: Record): void {
  if (record.whole) rows.clear();
  for (const id of record.removed) rows.delete(id);
  record.ids.forEach((id, i) => rows.set(id, {
    values: record.rows.slice(i * rowSize, (i + 1) * rowSize), label: record.labels[i]!, ground: record.ground[i]!,
  }));
}

export class SnapshotRing {
  bytes = 0;
  private readonly records = new TimedList<Record>();
  private known = new Map<number, Row>();
  private lastKey = -Infinity;
  private lastEpoch = -1;
  private lastPrimitives: Primitive[] = [];
  private labelNames: string[] = [];
  private stampBaseUs = 0;

  constructor(readonly spanMs: number) {}

  get length(): number { return this.records.length; }
  get from(): number | undefined { return this.records.first?.t; }

  push(state: MemoryState): void {
    this.labelNames = state.labelNames;
    this.stampBaseUs = state.stampBaseUs;
    const whole = state.t - this.lastKey >= keyMs || state.epoch !== this.lastEpoch;
    const record = this.encode(state, whole);
    apply(this.known, record);
    if (whole) this.lastKey = state.t;
    this.lastEpoch = state.epoch;
    this.records.push(record);
    this.bytes += record.bytes;
    // A difference without its whole one says nothing: drop up to the next whole one.
    while (this.records.first && this.records.first.t < state.t - this.spanMs && this.nextWhole() < state.t - this.spanMs) {
      do this.bytes -= this.records.shift()!.bytes;
      while (this.records.first && !this.records.first.whole);
    }
  }

  private nextWhole(): number {
    for (let i = 1; i < this.records.length; ++i) if (this.records.at(i)!.whole) return this.records.at(i)!.t;
    return Infinity;
  }

  private encode(state: MemoryState, whole: boolean): Record {
    const n = state.ids.length, changed: number[] = [], present = new Set<number>();
    let lifeScale = 1e-9, salienceScale = 1e-9;
    for (let i = 0; i < n; ++i) {
      present.add(state.ids[i]!);
      lifeScale = Math.max(lifeScale, state.rows[i * rowSize + column.life]!);
      salienceScale = Math.max(salienceScale, state.rows[i * rowSize + column.salience]!);
      const known = this.known.get(state.ids[i]!);
      if (whole || !known || known.ground !== state.ground[i] || known.label !== state.labels[i] ||
          moved(known.values, state.rows.subarray(i * rowSize, (i + 1) * rowSize))) changed.push(i);
    }
    const levels = new Uint16Array(2 * n);
    for (let i = 0; i < n; ++i) {
      levels[i] = Math.round(65535 * state.rows[i * rowSize + column.life]! / lifeScale);
      levels[n + i] = Math.round(65535 * state.rows[i * rowSize + column.salience]! / salienceScale);
    }
    const rows = new Float32Array(changed.length * rowSize);
    changed.forEach((i, k) => rows.set(state.rows.subarray(i * rowSize, (i + 1) * rowSize), k * rowSize));
    const removed = whole ? new Float64Array(0) : Float64Array.from([...this.known.keys()].filter(id => !present.has(id)));
    const same = !whole && JSON.stringify(this.lastPrimitives) === JSON.stringify(state.primitives);
    if (!same) this.lastPrimitives = state.primitives;
    return {
      t: state.t, stampUs: state.stampUs, revision: state.revision, epoch: state.epoch, robot: state.robot, whole, removed,
      ids: Float64Array.from(changed, i => state.ids[i]!), rows, labels: Uint16Array.from(changed, i => state.labels[i]!),
      ground: Uint8Array.from(changed, i => state.ground[i]!), lifeScale, salienceScale, levels, primitives: this.lastPrimitives,
      hypotheses: state.hypotheses,
      bytes: rows.byteLength + changed.length * 11 + removed.byteLength + levels.byteLength + recordObjects +
        (same ? 0 : state.primitives.length * 250) + state.hypotheses.length * 40,
    };
  }

  /** The last snapshot at or before t. */
  before(t: number): MemoryState | null {
    const end = this.records.indexAt(t);
    if (end < 0) return null;
    let start = end;
    while (start > 0 && !this.records.at(start)!.whole) --start;
    const rows = new Map<number, Row>();
    for (let i = start; i <= end; ++i) apply(rows, this.records.at(i)!);
    return this.assemble(this.records.at(end)!, rows);
  }

  private assemble(record: Record, rows: Map<number, Row>): MemoryState {
    const ids = Float64Array.from([...rows.keys()].sort((a, b) => a - b)), n = ids.length;
    const state: MemoryState = {
      t: record.t, stampUs: record.stampUs, revision: record.revision, epoch: record.epoch, robot: record.robot, ids,
      rows: new Float32Array(n * rowSize), labels: new Uint16Array(n), ground: new Uint8Array(n), labelNames: this.labelNames,
      stampBaseUs: this.stampBaseUs, primitives: record.primitives, hypotheses: record.hypotheses,
    };
    ids.forEach((id, i) => {
      const row = rows.get(id)!;
      state.rows.set(row.values, i * rowSize);
      state.rows[i * rowSize + column.life] = record.levels[i]! / 65535 * record.lifeScale;
      state.rows[i * rowSize + column.salience] = record.levels[n + i]! / 65535 * record.salienceScale;
      state.labels[i] = row.label;
      state.ground[i] = row.ground;
    });
    return state;
  }

  /** Life, salience and length of one segment over the time that is held: t, life, salience, length in turn. */
  historyOf(id: number): Float64Array {
    const values: number[] = [], rows = new Map<number, Row>();
    for (const record of this.records) {
      apply(rows, record);
      if (!rows.has(id)) continue;
      const sorted = [...rows.keys()].sort((a, b) => a - b), i = sorted.indexOf(id), n = sorted.length, v = rows.get(id)!.values;
      values.push(record.t, record.levels[i]! / 65535 * record.lifeScale, record.levels[n + i]! / 65535 * record.salienceScale,
        Math.hypot(v[3]! - v[0]!, v[4]! - v[1]!, v[5]! - v[2]!));
    }
    return Float64Array.from(values);
  }
}
