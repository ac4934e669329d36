// The page's memory of the last five minutes: budget, tiers, exactness.
import assert from "node:assert/strict";
import {test} from "node:test";
import {budgetBytes, History, spanMs} from "@gui/state/history";
import {hashOf, ImageRing} from "@gui/state/image_ring";
import {SnapshotRing} from "@gui/state/snapshot_ring";
import {column, rowSize} from "@gui/shared/state";
import type {AnalysisState, MemoryState} from "@gui/shared/state";

function image(t: number, bytes: number) {
  return {t, stampUs: t * 1000, seq: Math.round(t / 33), width: 640, height: 480, jpeg: new Uint8Array(bytes)};
}

function analysis(t: number, seq: number): AnalysisState {
  const lens = {width: 640, height: 480, fx: 500, fy: 500, cx: 320, cy: 240, k1: 0, k2: 0, p1: 0, p2: 0, k3: 0};
  return {t, stampUs: 0, frameSeq: seq, lens, robot: {x: 0, y: 0, theta: 0}, camera: {x: 0, y: 0, z: 0.45, qw: 1, qx: 0, qy: 0, qz: 0}, observed: new Float32Array(0),
    observedLabels: new Uint16Array(0), predicted: new Float32Array(0), predictedIds: new Float64Array(0), matches: new Uint16Array(0), labelNames: []};
}

/** Segments that wander a little, come and go; all values follow from k. */
function memory(k: number, t: number, segments = 40): MemoryState {
  const ids = Array.from({length: segments}, (_, i) => i + Math.floor(k / 7)), n = ids.length, rows = new Float32Array(n * rowSize);
  ids.forEach((id, i) => {
    const at = i * rowSize, moves = id % 5 === 0 ? 0.001 * k : 0;
    rows.set([id + moves, id / 2, 0, id + 1 + moves, id / 2 + 0.3, 0], at);
    for (let c = 6; c < 18; ++c) rows[at + c] = 0.0001 * c;
    rows[at + column.life] = (id * 13 + k) % 100;
    rows[at + column.salience] = (id * 7 + 3 * k) % 50;
    rows[at + column.firstSeen] = id;
    rows[at + column.lastSeen] = id % 5 === 0 ? t / 1000 : id;
  });
  return {
    t, stampUs: 1000 * t, revision: k, epoch: k < 400 ? 0 : 1, robot: {x: k * 0.01, y: -k * 0.02, theta: 0.001 * k}, ids: Float64Array.from(ids), rows,
    labels: Uint16Array.from(ids, id => id % 3), ground: Uint8Array.from(ids, id => id % 3), labelNames: ["a", "b", "c"], stampBaseUs: 0,
    primitives: [], hypotheses: [],
  };
}

test("twenty minutes of 40 kB images stay within the budget and reach back 299 s", () => {
  const history = new History();
  const end = 20 * 60_000;
  for (let t = 0; t <= end; t += 1000 / 30) history.addImage(image(t, 40_000));
  assert.ok(history.bytes <= budgetBytes, `${history.bytes} bytes`);
  assert.ok(history.images.bytes <= 64 * 1024 * 1024);
  assert.ok(history.from! <= end - 299_000, `oldest ${(end - history.from!) / 1000} s ago`);
  assert.ok(history.images.before(end - 200_000), "an image 200 s ago");
});

test("small images: every one of the last 30 s, five a second before", () => {
  const ring = new ImageRing(64 * 1024 * 1024, spanMs);
  for (let t = 0; t <= 120_000; t += 100 / 3) ring.push(image(t, 5000));
  assert.equal(ring.spacingMs, 200);
  assert.ok(Math.abs(ring.recent.length - 900) <= 2, `${ring.recent.length} recent`);
  assert.ok(Math.abs(ring.old.length - 450) <= 3, `${ring.old.length} old`);
});

test("images too large for the budget are thinned, not cut off", () => {
  const ring = new ImageRing(4 * 1024 * 1024, spanMs);
  for (let t = 0; t <= 200_000; t += 100 / 3) ring.push(image(t, 40_000));
  assert.ok(ring.bytes <= 4 * 1024 * 1024, `${ring.bytes} bytes`);
  assert.ok(ring.from! < 20_000, `oldest at ${ring.from}`);
});

test("a snapshot of the past equals the one that was given", () => {
  const ring = new SnapshotRing(spanMs), given: MemoryState[] = [];
  for (let k = 0; k < 900; ++k) {
    const state = memory(k, k * 100);
    given.push(state);
    ring.push(state);
  }
  for (const k of [0, 1, 49, 50, 333, 399, 400, 401, 777, 899]) {
    const back = ring.before(k * 100 + 50)!, state = given[k]!;
    assert.equal(back.stampUs, state.stampUs);
    assert.equal(back.revision, k);
    assert.equal(back.epoch, state.epoch);
    assert.deepEqual(back.robot, state.robot);
    assert.deepEqual([...back.ids], [...state.ids]);
    assert.deepEqual([...back.labels], [...state.labels]);
    assert.deepEqual([...back.ground], [...state.ground]);
    for (let i = 0; i < state.rows.length; ++i) {
      const c = i % rowSize, allowed = c < 18 ? 1.01e-4 : c < 20 ? 0.002 : 0;
      assert.ok(Math.abs(back.rows[i]! - state.rows[i]!) <= allowed, `snapshot ${k} value ${i}: ${back.rows[i]} for ${state.rows[i]}`);
    }
  }
});

test("snapshots older than five minutes go, and the oldest still decodes", () => {
  const ring = new SnapshotRing(20_000);
  for (let k = 0; k < 900; ++k) ring.push(memory(k, k * 100));
  assert.ok(ring.from! >= 89_900 - 26_000 && ring.from! <= 89_900 - 20_000 + 100, `from ${ring.from}`);
  assert.equal(ring.before(ring.from!)!.ids.length, 40);
  assert.equal(ring.before(ring.from! - 1), null);
});

test("differences are much smaller than whole snapshots", () => {
  const ring = new SnapshotRing(spanMs);
  let whole = 0;
  for (let k = 0; k < 600; ++k) {
    const state = memory(k, k * 100, 300);
    whole += state.rows.byteLength;
    ring.push(state);
  }
  assert.ok(ring.bytes < 0.5 * whole, `${ring.bytes} of ${whole}`);
});

test("the history of a segment follows its life", () => {
  const ring = new SnapshotRing(spanMs);
  for (let k = 0; k < 30; ++k) ring.push(memory(k, k * 100));
  const h = ring.historyOf(20);
  assert.equal(h.length, 30 * 4);
  assert.ok(Math.abs(h[4 * 10 + 1]! - (20 * 13 + 10) % 100) < 0.01, `life ${h[4 * 10 + 1]}`);
});

test("a moment has the last value of every stream at or before it", () => {
  const history = new History();
  const jpeg = Uint8Array.of(1, 2, 3);
  history.addImage({...image(1000, 3), jpeg});
  history.addTruth({t: 900, stampUs: 1, pose: {x: 1, y: 2, theta: 3}, inCollision: false, kidnaps: 0});
  history.addTruth({t: 1200, stampUs: 2, pose: {x: 5, y: 2, theta: 3}, inCollision: false, kidnaps: 1});
  const {moment} = history.momentAt(1100);
  assert.equal(moment.truth!.pose.x, 1);
  assert.equal(moment.frame!.hash, hashOf(jpeg));
  assert.equal(moment.memory, null);
  assert.equal([...history.marks][0]!.kind, "kidnap");
});

test("an analysis that comes before its image, or after it, is shown with it", () => {
  const history = new History();
  history.addAnalysis(analysis(990, 30));
  history.addImage({...image(1000, 3), seq: 30});
  history.addImage({...image(1033, 3), seq: 31});
  history.addAnalysis(analysis(1040, 31));
  assert.equal(history.momentAt(1010).moment.analysis!.frameSeq, 30);
  assert.equal(history.momentAt(1050).moment.analysis!.frameSeq, 31);
});

test("an image that the memory passed over has the analysis before it, of at most half a second", () => {
  const history = new History();
  history.addImage({...image(1000, 3), seq: 30});
  history.addAnalysis(analysis(1010, 30));
  for (let k = 1; k <= 20; ++k) history.addImage({...image(1000 + 50 * k, 3), seq: 30 + k});
  assert.equal(history.momentAt(1410).moment.analysis!.frameSeq, 30);
  assert.equal(history.momentAt(1600).moment.analysis, null);
});
