// The sentences of the lost panel: each cause alone, and their order.
import assert from "node:assert/strict";
import {test} from "node:test";
import {causesOf, CauseWatch, fitShare, isProblem, meanResultant, verdictOf} from "@gui/why/rules";
import type {Signals} from "@gui/why/rules";
import {emptyMoment, rowSize, timeStands} from "@gui/shared/state";
import type {AnalysisState, ComponentInfo, EstimateState, MapState, MemoryState} from "@gui/shared/state";

const lens = {width: 320, height: 240, fx: 277, fy: 277, cx: 159.5, cy: 119.5, k1: 0, k2: 0, p1: 0, p2: 0, k3: 0};
const now = 100_000;

function memoryOf(lines: number[][], labels: string[]): MemoryState {
  const names = [...new Set(labels)], rows = new Float32Array(lines.length * rowSize);
  lines.forEach(([ax, ay, bx, by], i) => rows.set([ax!, ay!, 0, bx!, by!, 0], i * rowSize));
  return {t: now, stampUs: 0, revision: 1, epoch: 0, robot: {x: 0, y: 0, theta: 0}, ids: Float64Array.from(lines, (_, i) => i + 1), rows,
    labels: Uint16Array.from(labels, l => names.indexOf(l)), ground: new Uint8Array(lines.length), labelNames: names, stampBaseUs: 0, primitives: [], hypotheses: []};
}

function analysisOf(observed: number, predicted: number, matched: number, label = "skirting"): AnalysisState {
  return {t: now, stampUs: 0, frameSeq: 1, lens, robot: {x: 0, y: 0, theta: 0}, camera: {x: 0, y: 0, z: 0.45, qw: 1, qx: 0, qy: 0, qz: 0}, observed: new Float32Array(observed * 5),
    observedLabels: new Uint16Array(observed), predicted: new Float32Array(predicted * 4), predictedIds: new Float64Array(predicted), matches: new Uint16Array(matched * 2), labelNames: [label, "unknown"]};
}

function mapOf(labels: string[]): MapState {
  return {id: "m", name: "m.csv", labels, rows: Float32Array.of(0, 0, 0, 10, 0, 0, 0, 0)};
}

const estimate: EstimateState = {t: now, stampUs: 0, revision: 5, hasPose: true, world: {x: 0, y: 0, theta: 0}, odom: {x: 0, y: 0, theta: 0}, covariance: [0, 0, 0, 0, 0, 0], reliability: 0.9, races: []};
const square = [[0, 0, 1, 0], [1, 0, 1, 1], [1, 1, 0, 1], [0, 1, 0, 0]];

function signals(change: Partial<Signals> & {moment?: Signals["moment"]}): Signals {
  return {now, moment: {...emptyMoment, t: now}, video: {fps: 30, sourceFps: 30, ageMs: 5, roundTripMs: 1, stampUs: 1, width: 320, height: 240, brightness: 120, state: "Running", message: "", last: now - 30},
    hasCamera: true, links: [], components: [], map: null, replay: null, setup: "sim", bestFit: null, paused: false, ...change};
}

const ids = (s: Signals) => causesOf(s).map(c => c.id);

test("a robot that works gives no cause", () => {
  const moment = {...emptyMoment, t: now, analysis: analysisOf(10, 8, 8), memory: memoryOf(square, ["skirting", "skirting", "skirting", "skirting"]), estimate};
  assert.deepEqual(ids(signals({moment, map: mapOf(["skirting"])})), []);
});

test("a component that ended is the first cause, by its name", () => {
  const dead: ComponentInfo = {name: "base_server", alive: false, message: "connection refused", since: now - 4000, state: "", reason: "", version: "0.1.0", uptimeS: 0, peers: [], rates: [], latencies: [], gauges: [], errors: []};
  const causes = new CauseWatch().update(causesOf(signals({components: [dead], video: null})), now);
  assert.equal(causes[0]!.cause.id, "dead base_server");
  assert.match(causes[0]!.cause.text, /base_server is gone \(connection refused\)/);
  assert.match(causes[0]!.cause.advice, /scripts\/start sim base_server/);
});

test("a component that hangs is no component that ended", () => {
  const silent: ComponentInfo = {name: "base_server", alive: false, message: "no answer in time", since: now - 4000, state: "", reason: "", version: "0.1.0", uptimeS: 0, peers: [], rates: [], latencies: [], gauges: [], errors: []};
  const [cause] = causesOf(signals({components: [silent, {...silent, name: "simulator", alive: true}]}));
  assert.match(cause!.text, /base_server hangs, or the network to it is lost/);
  assert.match(cause!.advice, /scripts\/stop sim base_server; scripts\/start sim base_server/, "start alone refuses what runs");
  const [all] = causesOf(signals({components: [silent, {...silent, name: "simulator"}]}));
  assert.match(all!.advice, /Is the network there/);
});

test("no images for three seconds, with the camera's reason", () => {
  const s = signals({});
  s.video = {...s.video!, last: now - 3200};
  s.links = [{name: "Camera", connected: false, message: "connection refused", since: now - 3000}];
  assert.match(causesOf(s)[0]!.text, /No images for 3 s: the camera does not answer \(connection refused\)/);
  assert.deepEqual(ids({...s, paused: true}), [], "a paused simulation gives none on purpose");
});

test("a paused replay is no problem of those who wait for its images", () => {
  const waits: ComponentInfo = {name: "localization", alive: true, message: "", since: now - 4000, state: "Degraded", reason: "no update", version: "0.2.0", uptimeS: 9, peers: [], rates: [], latencies: [], gauges: [], errors: []};
  const moment = {...emptyMoment, t: now, estimate: {...estimate, t: now - 9000}};
  assert.deepEqual(ids(signals({components: [waits], moment, paused: true})), []);
  assert.deepEqual(ids(signals({components: [waits], moment})), ["degraded localization", "estimate late"]);
  assert.ok(isProblem(waits, false) && !isProblem(waits, true));
  assert.ok(isProblem({...waits, alive: false}, true), "one that is gone");
  assert.ok(isProblem({...waits, peers: [{name: "memory", connected: false, message: "", proxy: ""}]}, true), "one that has lost a peer");
});

test("time stands while a replay that answers is paused or at its end", () => {
  const replay = {state: "FINISHED", file: "", firstUs: 0, lastUs: 1, stampUs: 1, rate: 1, loop: false};
  assert.ok(timeStands(() => true, null, replay));
  assert.ok(!timeStands(() => false, null, replay), "its server is gone");
  assert.ok(!timeStands(() => true, null, {...replay, state: "PLAYING"}));
});

test("a plain wall", () => assert.deepEqual(ids(signals({moment: {...emptyMoment, t: now, analysis: analysisOf(1, 0, 0)}})), ["nothing seen"]));

test("a covered lens is told from a plain wall", () => {
  const s = signals({moment: {...emptyMoment, t: now, analysis: analysisOf(0, 6, 0)}});
  s.video = {...s.video!, brightness: 3};
  assert.deepEqual(ids(s), ["dark", "memory wrong"]);
  assert.match(causesOf(s)[0]!.text, /The picture is black \(brightness 3 of 255\)/);
  s.video = {...s.video, brightness: null};
  assert.equal(ids(s)[0], "nothing seen", "no picture was drawn: nothing is said of its light");
  s.bestFit = {value: 0.1, at: now - 500};
  const watch = new CauseWatch();
  assert.deepEqual(watch.update(causesOf(s), now).map(c => c.cause.id), ["fits nowhere"], "a short look at a wall is no cause");
  watch.update(causesOf(s), now + 800);
  assert.equal(watch.update(causesOf(s), now + 1600)[0]!.cause.id, "nothing seen", "what is not seen now weighs more than what an old memory fits");
});

test("unknown labels", () => {
  const analysis = analysisOf(10, 0, 0);
  analysis.observedLabels.fill(1, 0, 8);
  assert.match(causesOf(signals({moment: {...emptyMoment, t: now, analysis}}))[0]!.text, /80 % of the lines/);
});

test("the map of another world: fits nowhere first, then the labels that the map lacks", () => {
  const moment = {...emptyMoment, t: now, analysis: analysisOf(10, 8, 8), memory: memoryOf(square, ["door_jamb", "door_jamb", "skirting", "skirting"]), estimate: {...estimate, hasPose: false, reliability: 0}};
  const causes = new CauseWatch().update(causesOf(signals({moment, map: mapOf(["line"]), bestFit: {value: 0.12, at: now - 500}})), now).map(c => c.cause);
  assert.match(causes[0]!.text, /No place of this map fits: the best one explains 12 %/);
  assert.match(causes[1]!.text, /The map lacks 'door_jamb' \(the memory has 2\), 'skirting' \(the memory has 2\)/);
});

test("what is lost comes before what is concluded from it", () => {
  const moment = {...emptyMoment, t: now, analysis: analysisOf(10, 8, 8), memory: memoryOf(square, ["door_jamb", "door_jamb", "skirting", "skirting"]), estimate: {...estimate, hasPose: false, reliability: 0}};
  const memory: ComponentInfo = {name: "active_visual_memory", alive: true, message: "", since: now - 9000, state: "Degraded", reason: "Odometry is away", version: "0.1.0", uptimeS: 60,
    peers: [{name: "Odometry", proxy: "", connected: false, message: "connection refused", reconnections: 0}], rates: [], latencies: [], gauges: [], errors: []};
  const dead = {...memory, name: "base_server", alive: false, peers: []}, absent = {...dead, name: "pantilt_server", version: ""};
  const s = signals({moment, map: mapOf(["line"]), bestFit: {value: 0.12, at: now - 500}, components: [memory, dead, absent]});
  s.video = {...s.video!, last: now - 3000};
  const order = new CauseWatch().update(causesOf(s), now).map(c => c.cause.id);
  assert.deepEqual(order.slice(0, 6), ["dead base_server", "absent pantilt_server", "peer active_visual_memory Odometry", "no images", "fits nowhere", "labels lacking"]);
});

test("one direction only", () => {
  const lines = [[0, 0, 3, 0.01], [0, 1, 3, 1], [0, 2, 3, 2], [3, 3, 0, 3]];
  const memory = memoryOf(lines, ["a", "a", "a", "a"]);
  assert.ok(meanResultant(memory.rows, 4) > 0.99);
  assert.deepEqual(ids(signals({moment: {...emptyMoment, t: now, analysis: analysisOf(9, 4, 4), memory}})), ["one direction"]);
});

test("a moved robot and two places alike", () => {
  const race = {id: 1, pose: {x: 0, y: 0, theta: 0}, health: 0.8, weight: 0.54, victories: 1, age: 9, winner: true};
  const moment = {...emptyMoment, t: now, analysis: analysisOf(10, 10, 2), estimate: {...estimate, reliability: 0.54, races: [race, {...race, id: 2, weight: 0.41, winner: false, pose: {x: 4, y: 0, theta: 0}}]}};
  assert.deepEqual(ids(signals({moment})), ["memory wrong", "ambiguous"]);
  assert.match(causesOf(signals({moment}))[1]!.text, /54 % and 41 %/);
  // A place that has a third of the belief is why the other is not sure.
  moment.estimate = {...estimate, reliability: 0.66, races: [{...race, weight: 0.66}, {...race, id: 2, weight: 0.33, pose: {x: 4, y: 0, theta: 0}}]};
  assert.deepEqual(ids(signals({moment})), ["memory wrong", "ambiguous"]);
});

test("share of remembered length on lines of the map", () => {
  const memory = memoryOf([[0, 0, 2, 0], [2, 0.1, 4, 0.1], [0, 5, 2, 5], [2, 5, 4, 5]], ["a", "a", "a", "a"]);
  assert.ok(Math.abs(fitShare({...emptyMoment, memory, estimate}, mapOf(["a"]))! - 0.5) < 1e-6);
});

test("short looks are no causes: a plain wall counts after 1.5 s", () => {
  const watch = new CauseWatch(), causes = causesOf(signals({moment: {...emptyMoment, t: now, analysis: analysisOf(0, 0, 0)}}));
  assert.equal(watch.update(causes, now).length, 0);
  assert.equal(watch.update(causes, now + 800).length, 0);
  assert.equal(watch.update(causes, now + 1600).length, 1);
});

test("a pose that is no longer renewed is not called sure, unless time stands", () => {
  const moment = {...emptyMoment, t: now, live: true, estimate};
  assert.match(verdictOf(moment, now + 500, false).text, /knows where it is/);
  assert.deepEqual(verdictOf(moment, now + 7000, false), {level: "bad", text: "no pose for 7 s"});
  assert.match(verdictOf(moment, now + 7000, true).text, /knows where it is/);
  assert.match(verdictOf({...moment, live: false}, now + 7000, false).text, /knows where it is/, "of a moment of the past");
});

test("a robot of which nothing answers is one cause", () => {
  const dead = (name: string): ComponentInfo => ({name, alive: false, message: "connection refused", since: now - 4000, state: "", reason: "", version: "0.1.0", uptimeS: 0, peers: [], rates: [], latencies: [], gauges: [], errors: []});
  const [first, ...rest] = causesOf(signals({components: [dead("simulator"), dead("localization")]}));
  assert.equal(first!.id, "all dead");
  assert.match(first!.text, /none of its 2 components answers \(connection refused\)/);
  assert.deepEqual(rest, []);
});
