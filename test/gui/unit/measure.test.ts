// Measuring in the scene: ends that the pointer snaps to, and what is said.
import assert from "node:assert/strict";
import {test} from "node:test";
import {measureText} from "@gui/panes/measure";
import {endUnder} from "@gui/scene/picking";
import {emptyMoment, mapRowSize, rowSize} from "@gui/shared/state";
import type {MapState, MemoryState} from "@gui/shared/state";

const toScreen = (x: number, y: number) => ({x: 100 * x, y: -100 * y});
const rows = Float32Array.from({length: mapRowSize}, (_, i) => [1, 2, 0, 3, 2, 0][i] ?? 0);
const map = {rows, labels: ["a|b"], id: 1, name: "m"} as unknown as MapState;
const unmoved = {x: 0, y: 0, theta: 0};

test("the pointer snaps to the next end of a line within reach, never to its middle", () => {
  assert.deepEqual(endUnder(305, -203, 8, emptyMoment, map, unmoved, toScreen), {x: 3, y: 2});
  assert.equal(endUnder(309, -203, 8, emptyMoment, map, unmoved, toScreen), null);
  assert.equal(endUnder(200, -200, 8, emptyMoment, map, unmoved, toScreen), null);
});

test("ends of the memory stand where the scene draws them", () => {
  const memory = {ids: [7], rows: Float32Array.from({length: rowSize}, (_, i) => [0, 0, 0, 1, 0, 0][i] ?? 0)} as unknown as MemoryState;
  const end = endUnder(500, -600, 8, {...emptyMoment, memory}, null, {x: 5, y: 5, theta: Math.PI / 2}, toScreen)!;
  assert.ok(Math.hypot(end.x - 5, end.y - 6) < 1e-9);
});

test("a point and a length are said with unit and frame", () => {
  assert.equal(measureText({x: 1, y: 2}, {x: 1, y: 2}, "odom"), "1.00, 2.00 m (odom)");
  assert.equal(measureText({x: 1, y: 2}, {x: 1, y: 4.5}, "map"), "2.500 m at 90.0 deg, from 1.00, 2.00 to 1.00, 4.50 m (map)");
});
