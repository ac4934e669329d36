// Poses and the camera, by hand-worked examples and round trips.
import assert from "node:assert/strict";
import {test} from "node:test";
import {CameraView, compose, distort, ellipse, inverse, undistort} from "@gui/shared/geometry";
import {AgeMeter, RateMeter} from "@gui/ice/meters";

const near = (a: number, b: number, within = 1e-9) => assert.ok(Math.abs(a - b) <= within, `${a} for ${b}`);
const lens = {width: 320, height: 240, fx: 277, fy: 277, cx: 159.5, cy: 119.5, k1: -0.3, k2: 0.1, p1: 0.001, p2: -0.002, k3: 0};
/** Looks along the robot's x: camera z = robot x, camera x = -robot y, camera y = -robot z. */
const forward = {x: 0, y: 0, z: 0.45, qw: 0.5, qx: -0.5, qy: 0.5, qz: -0.5};

test("a pose and its inverse cancel", () => {
  const a = {x: 1, y: -2, theta: 2.5}, e = compose(a, inverse(a));
  near(e.x, 0);
  near(e.y, 0);
  near(e.theta, 0);
});

test("a point 2 m ahead at the height of the lens is seen at the principal point", () => {
  const view = new CameraView({x: 3, y: 1, theta: Math.PI / 2}, forward, {...lens, k1: 0, k2: 0, p1: 0, p2: 0});
  const p = view.toCamera({x: 3, y: 3, z: 0.45});
  near(p.x, 0);
  near(p.y, 0);
  near(p.z, 2);
  const [q] = view.projectSegment({x: 3, y: 3, z: 0.45}, {x: 3, y: 3, z: 0});
  near(q!.x, 159.5);
  near(q!.y, 119.5);
});

test("the point of the floor under a pixel projects onto that pixel", () => {
  const view = new CameraView({x: 3, y: 1, theta: 0.4}, forward, lens);
  for (const [u, v] of [[100, 200], [250, 180], [10, 230]] as const) {
    const p = view.pointAt(u, v), [q] = view.projectSegment(p, p);
    assert.equal(p.z, 0);
    near(q!.x, u, 0.01);
    near(q!.y, v, 0.01);
  }
});

test("above the horizon a point 4 m on the ray is taken", () => {
  const view = new CameraView({x: 0, y: 0, theta: 0}, forward, lens), p = view.pointAt(159.5, 40);
  assert.ok(p.z > 0.45);
  near(Math.hypot(p.x, p.y, p.z - 0.45), 4, 1e-6);
});

test("distortion and back", () => {
  const d = distort(lens, 30, 40), u = undistort(lens, d.x, d.y);
  near(u.x, 30, 0.02);
  near(u.y, 40, 0.02);
});

test("an ellipse of a diagonal covariance has its sigmas as half axes", () => {
  const points = ellipse(0.04, 0, 0.01, 1, 360);
  near(Math.max(...points.map(p => p.x)), 0.2, 1e-4);
  near(Math.max(...points.map(p => p.y)), 0.1, 1e-4);
});

test("age is over the best, whatever the clocks", () => {
  const age = new AgeMeter();
  age.addRoundTrip(4);
  age.add(1000, 0, 1);
  near(age.ageMs, 2);
  age.add(1050, 33_000, 1);
  near(age.ageMs, 17 + 2, 1e-6);
  age.add(2000, 0, 1);
  near(age.ageMs, 2, 1e-6);
});

test("age of a source at another speed, and after its time stood", () => {
  const age = new AgeMeter();
  for (let i = 0; i <= 200; ++i) age.add(i * 33, i * 8250, 0.25);
  near(age.ageMs, 0, 1e-6);
  for (let i = 1; i <= 200; ++i) age.add(6600 + i * 8.25, 1_650_000 + i * 33_000, 4);
  near(age.ageMs, 0, 1e-6);
  age.restart();
  age.add(20_000, 8_283_000, 1);
  near(age.ageMs, 0, 1e-6);
  age.add(20_043, 8_316_000, 1);
  near(age.ageMs, 10, 1e-6);
});

test("rates over two seconds", () => {
  const rate = new RateMeter();
  for (let t = 0; t < 4000; t += 40) rate.count(t);
  near(rate.hz(3960), 25, 0.6);
  assert.equal(rate.hz(9000), 0);
});
