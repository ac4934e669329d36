// Measures in the scene: a click says where a point of the floor is, a drag how far apart two are and in which direction.
import type {Vec2} from "../shared/geometry";
import {degrees, h, say} from "./dom";

export class Measure {
  readonly element = h("div", {class: "measure hidden", attrs: {role: "status"}});
  from: Vec2 | null = null;
  to: Vec2 | null = null;

  /** @param frame of the points. */
  show(from: Vec2 | null, to: Vec2 | null, frame: "map" | "odom"): void {
    this.from = from;
    this.to = to;
    this.element.classList.toggle("hidden", from === null);
    if (from) say(this.element, measureText(from, to ?? from, frame));
  }
}

export function measureText(from: Vec2, to: Vec2, frame: "map" | "odom"): string {
  const dx = to.x - from.x, dy = to.y - from.y, length = Math.hypot(dx, dy);
  const at = (p: Vec2) => `${p.x.toFixed(2)}, ${p.y.toFixed(2)}`;
  if (length === 0) return `${at(from)} m (${frame})`;
  return `${length.toFixed(3)} m at ${degrees(Math.atan2(dy, dx)).toFixed(1)} deg, from ${at(from)} to ${at(to)} m (${frame})`;
}
