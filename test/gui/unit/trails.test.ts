// The trail of the robot: five minutes of it, without jumps.
import assert from "node:assert/strict";
import {test} from "node:test";
import {Trail} from "@gui/scene/trails";

test("a trail holds five minutes of a robot that keeps driving", () => {
  const trail = new Trail();
  const lengths: number[] = [];
  for (let s = 0; s < 1800; s += 0.1) {
    trail.add(1000 * s, 0.03 * 10 * s, 0);
    if (Math.abs(s % 300) < 0.05) lengths.push(trail.length);
  }
  assert.ok(trail.length >= 3000 && trail.length <= 3300, `${trail.length} points (${lengths})`);
});

test("a robot that stands adds nothing, and a jump is no piece", () => {
  const trail = new Trail();
  for (let t = 0; t < 1000; t += 10) trail.add(t, 1, 1);
  assert.equal(trail.length, 1);
  trail.add(1000, 1.1, 1);
  trail.add(2000, 4, 1);
  trail.add(3000, 4.1, 1);
  const pieces: number[] = [];
  trail.forEachPiece(2500, (_ax, _ay, bx) => pieces.push(bx));
  assert.deepEqual(pieces, [1.1], "the jump is left out, and what came after 2.5 s");
});
