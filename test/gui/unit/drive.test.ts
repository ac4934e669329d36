// The dead-man: when velocities are sent, and that exactly one zero ends them.
import assert from "node:assert/strict";
import {test} from "node:test";
import {commandTooOldMs, DeadMan, freshMs, sendEveryMs} from "@gui/drive/dead_man";
import {speedsOf} from "@gui/drive/keys";

/** Ticks every 80 ms from `from` to `to`. */
function ticks(d: DeadMan, from: number, to: number): string[] {
  const kinds: string[] = [];
  for (let t = from; t <= to; t += sendEveryMs) kinds.push(d.tick(t).kind);
  return kinds;
}

test("sends while held, one zero at the release, then silence", () => {
  const d = new DeadMan();
  assert.deepEqual(ticks(d, 0, 160), ["none", "none", "none"]);
  d.report({held: true, v: 0.3, w: 0.1, at: 200}, 200);
  assert.deepEqual(d.tick(210), {kind: "send", v: 0.3, w: 0.1});
  d.report({held: false, v: 0, w: 0, at: 300}, 300);
  assert.deepEqual(ticks(d, 310, 700), ["zero", "none", "none", "none", "none"]);
});

test("a page that hangs stops the robot within 200 ms and a tick", () => {
  const d = new DeadMan();
  d.report({held: true, v: 0.3, w: 0, at: 0}, 0);
  assert.deepEqual(ticks(d, 0, 400), ["send", "send", "send", "zero", "none", "none"]);
  // The page wakes up with the key still held: it must be let go first.
  d.report({held: true, v: 0.3, w: 0, at: 500}, 500);
  assert.equal(d.tick(510).kind, "none");
  d.report({held: false, v: 0, w: 0, at: 600}, 600);
  d.report({held: true, v: 0.3, w: 0, at: 650}, 650);
  assert.equal(d.tick(660).kind, "send");
  assert.equal(freshMs, 200);
});

test("a intent that travelled too long counts as a release", () => {
  const d = new DeadMan();
  d.report({held: true, v: 0.3, w: 0, at: 0}, commandTooOldMs + 1);
  assert.equal(d.tick(commandTooOldMs + 5).kind, "none");
});

test("what bars driving says why, until the next press", () => {
  const d = new DeadMan();
  d.report({held: true, v: 0.3, w: 0, at: 0}, 0);
  d.tick(1);
  d.bar("another drives");
  assert.deepEqual(d.tick(2), {kind: "zero", why: "another drives"});
  assert.equal(d.tick(3).kind, "none");
});

test("keys", () => {
  assert.deepEqual(speedsOf(new Set(["KeyW"])), {v: 1, w: 0});
  assert.deepEqual(speedsOf(new Set(["ArrowUp", "ArrowLeft"])), {v: 1, w: 1});
  assert.deepEqual(speedsOf(new Set(["KeyS", "KeyD"])), {v: -1, w: -1});
  assert.deepEqual(speedsOf(new Set(["KeyW", "KeyS"])), {v: 0, w: 0});
});
