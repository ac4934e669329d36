// Numbers over time.
import assert from "node:assert/strict";
import {test} from "node:test";
import {emptyMoment} from "@gui/shared/state";
import type {EstimateState, TruthState} from "@gui/shared/state";
import {Columns} from "@gui/state/columns";

const truth = (ms: number): TruthState => ({t: ms, stampUs: 1000 * ms, pose: {x: 0.3e-3 * ms, y: 0, theta: 0}, inCollision: false, kidnaps: 0});

function estimate(ms: number): EstimateState {
  return {t: ms, stampUs: 1000 * ms, revision: ms, hasPose: true, world: {x: 0.3e-3 * ms + 0.002, y: 0, theta: 0}, odom: {x: 0, y: 0, theta: 0}, covariance: [0, 0, 0, 0, 0, 0], reliability: 1, races: []};
}

test("a driving robot's error is that of its estimate at its own stamp", () => {
  const columns = new Columns();
  // 0.3 m/s, 2 mm off; the estimate is 100 ms older than the truth, or 30 ms newer.
  for (let ms = 1000; ms < 4000; ms += 62) columns.addMoment({...emptyMoment, t: ms, truth: truth(ms), estimate: estimate(ms < 2500 ? ms - 100 : ms + 30)});
  const errors = columns.pose.series.get("error (m)")!.slice(1);
  assert.ok(errors.length > 10);
  for (const error of errors) assert.ok(Math.abs(error - 0.002) < 1e-6, `${error} m`);
});
