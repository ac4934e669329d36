// Which element lies under the pointer: the nearest one on the screen within some pixels. No WebGL.
import type {Pose2, Vec2} from "../shared/geometry";
import {distanceToSegment, transform2} from "../shared/geometry";
import {mapRowSize, rowSize} from "../shared/state";
import type {MapState, Moment} from "../shared/state";
import type {Selection} from "../state/store";
import {outlineOf, placeOf} from "./content";

export type ToScreen = (x: number, y: number, z: number) => {x: number; y: number} | null;

/** End of a line of map or memory that lies next to the pointer. */
export function endUnder(px: number, py: number, reach: number, moment: Moment, map: MapState | null, odomInWorld: Pose2, toScreen: ToScreen): Vec2 | null {
  let best = reach, found: Vec2 | null = null;
  const offer = (p: Vec2, z: number) => {
    const q = toScreen(p.x, p.y, z), distance = q ? Math.hypot(q.x - px, q.y - py) : Infinity;
    if (distance >= best) return;
    best = distance;
    found = p;
  };
  const offerEnds = (rows: Float32Array, count: number, size: number, place: (x: number, y: number) => Vec2) => {
    for (let i = 0; i < count; ++i)
      for (const k of [i * size, i * size + 3]) offer(place(rows[k]!, rows[k + 1]!), rows[k + 2]!);
  };
  if (map) offerEnds(map.rows, map.rows.length / mapRowSize, mapRowSize, (x, y) => ({x, y}));
  if (moment.memory) offerEnds(moment.memory.rows, moment.memory.ids.length, rowSize, (x, y) => transform2(odomInWorld, x, y));
  return found;
}

export function pick(px: number, py: number, reach: number, moment: Moment, map: MapState | null, odomInWorld: Pose2, toScreen: ToScreen): Selection | null {
  let best = reach, found: Selection | null = null;
  const offer = (distance: number, selection: Selection) => {
    if (distance >= best) return;
    best = distance;
    found = selection;
  };
  const inOdom = (x: number, y: number, z: number) => {
    const p = transform2(odomInWorld, x, y);
    return toScreen(p.x, p.y, z);
  };
  const between = (a: {x: number; y: number} | null, b: {x: number; y: number} | null) => a && b ? distanceToSegment(px, py, a.x, a.y, b.x, b.y) : Infinity;
  const {memory, gaze, estimate} = moment, robot = moment.analysis?.robot ?? memory?.robot;
  if (memory) {
    for (let i = 0; i < memory.ids.length; ++i) {
      const r = memory.rows, k = i * rowSize;
      offer(between(inOdom(r[k]!, r[k + 1]!, r[k + 2]!), inOdom(r[k + 3]!, r[k + 4]!, r[k + 5]!)), {kind: "segment", id: memory.ids[i]!});
    }
    for (const p of memory.primitives) {
      const points = outlineOf(p).map(q => inOdom(q.x, q.y, 0));
      // A primitive lies on the segments that it is made of: those come first.
      for (let i = 0; i < points.length; ++i) offer(between(points[i]!, points[(i + 1) % points.length]!) + 3, {kind: "primitive", id: p.id});
    }
  }
  for (const race of estimate?.races ?? []) {
    const p = toScreen(race.pose.x, race.pose.y, 0);
    if (p) offer(Math.hypot(p.x - px, p.y - py) - 4, {kind: "race", id: race.id});
  }
  if (gaze && robot) {
    for (const point of gaze.points) {
      const at = placeOf(point, robot), p = inOdom(at.x, at.y, at.z);
      if (p) offer(Math.hypot(p.x - px, p.y - py), {kind: "attention", id: point.id});
    }
  }
  if (found || !map) return found;
  for (let i = 0; i < map.rows.length; i += mapRowSize) {
    const r = map.rows;
    offer(between(toScreen(r[i]!, r[i + 1]!, r[i + 2]!), toScreen(r[i + 3]!, r[i + 4]!, r[i + 5]!)), {kind: "map", id: i / mapRowSize});
  }
  return found;
}
