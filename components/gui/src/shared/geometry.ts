// Poses in the plane, the pinhole camera with Brown-Conrady distortion, and the floor. Frames and units as in interfaces/avm/common.ice:
// metres, radians counter-clockwise; camera x right, y down, z forward.

export interface Pose2 { x: number; y: number; theta: number }
export interface Vec2 { x: number; y: number }
export interface Vec3 { x: number; y: number; z: number }
/** Pose of a frame in another one, with a unit quaternion. */
export interface Pose3 { x: number; y: number; z: number; qw: number; qx: number; qy: number; qz: number }
export interface Intrinsics {
  width: number; height: number; fx: number; fy: number; cx: number; cy: number;
  k1: number; k2: number; p1: number; p2: number; k3: number;
}

export function wrapAngle(angle: number): number {
  const turns = Math.round(angle / (2 * Math.PI));
  return angle - 2 * Math.PI * turns;
}

/** T_a_c = T_a_b * T_b_c. */
export function compose(a: Pose2, b: Pose2): Pose2 {
  const c = Math.cos(a.theta), s = Math.sin(a.theta);
  return {x: a.x + c * b.x - s * b.y, y: a.y + s * b.x + c * b.y, theta: wrapAngle(a.theta + b.theta)};
}

export function inverse(a: Pose2): Pose2 {
  const c = Math.cos(a.theta), s = Math.sin(a.theta);
  return {x: -c * a.x - s * a.y, y: s * a.x - c * a.y, theta: wrapAngle(-a.theta)};
}

export function transform2(a: Pose2, x: number, y: number): Vec2 {
  const c = Math.cos(a.theta), s = Math.sin(a.theta);
  return {x: a.x + c * x - s * y, y: a.y + s * x + c * y};
}

/** Rotation matrix by rows of a unit quaternion. */
export function rotationOf(q: {qw: number; qx: number; qy: number; qz: number}): Float64Array {
  const {qw: w, qx: x, qy: y, qz: z} = q;
  return Float64Array.of(
    1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
    2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
    2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y));
}

/** A camera at a moment: where it stands in a reference frame (odom or world) and its lens. */
export class CameraView {
  private readonly rotation: Float64Array;
  private readonly cos: number;
  private readonly sin: number;

  /** @param robot pose of the robot in the reference frame. @param camera pose of the camera frame on the robot. */
  constructor(readonly robot: Pose2, readonly camera: Pose3, readonly lens: Intrinsics) {
    this.rotation = rotationOf(camera);
    this.cos = Math.cos(robot.theta);
    this.sin = Math.sin(robot.theta);
  }

  /** A point of the reference frame in the camera frame [m]. */
  toCamera(p: Vec3): Vec3 {
    const dx = p.x - this.robot.x, dy = p.y - this.robot.y;
    const x = this.cos * dx + this.sin * dy - this.camera.x;
    const y = -this.sin * dx + this.cos * dy - this.camera.y;
    const z = p.z - this.camera.z;
    const r = this.rotation;
    return {x: r[0]! * x + r[3]! * y + r[6]! * z, y: r[1]! * x + r[4]! * y + r[7]! * z, z: r[2]! * x + r[5]! * y + r[8]! * z};
  }

  /** Where the lens stands in the reference frame [m]. */
  centre(): Vec3 {
    const p = transform2(this.robot, this.camera.x, this.camera.y);
    return {x: p.x, y: p.y, z: this.camera.z};
  }

  /** Unit direction in the reference frame of the ray through an ideal (undistorted) pixel. */
  ray(u: number, v: number): Vec3 {
    const x = (u - this.lens.cx) / this.lens.fx, y = (v - this.lens.cy) / this.lens.fy;
    const r = this.rotation;
    const rx = r[0]! * x + r[1]! * y + r[2]!, ry = r[3]! * x + r[4]! * y + r[5]!, rz = r[6]! * x + r[7]! * y + r[8]!;
    const n = Math.hypot(rx, ry, rz);
    return {x: (this.cos * rx - this.sin * ry) / n, y: (this.sin * rx + this.cos * ry) / n, z: rz / n};
  }

  /** Where the ray of a raw pixel meets the floor within `farthest` [m]; else the point at `otherwise` metres on the ray. */
  pointAt(u: number, v: number, farthest = 12, otherwise = 4): Vec3 {
    const ideal = undistort(this.lens, u, v);
    const d = this.ray(ideal.x, ideal.y), c = this.centre();
    const t = d.z < -1e-3 ? -c.z / d.z : Infinity;
    const range = t <= farthest ? t : otherwise;
    return {x: c.x + range * d.x, y: c.y + range * d.y, z: t <= farthest ? 0 : c.z + range * d.z};
  }

  /** The visible part of a segment as a polyline of raw pixels; empty when it lies behind the camera. */
  projectSegment(a: Vec3, b: Vec3): Vec2[] {
    const near = 0.05;
    let p = this.toCamera(a), q = this.toCamera(b);
    if (p.z < near && q.z < near) return [];
    if (p.z < near) p = cut(p, q, near);
    if (q.z < near) q = cut(q, p, near);
    const l = this.lens;
    return bend(l, {x: l.fx * p.x / p.z + l.cx, y: l.fy * p.y / p.z + l.cy}, {x: l.fx * q.x / q.z + l.cx, y: l.fy * q.y / q.z + l.cy});
  }
}

function cut(behind: Vec3, front: Vec3, near: number): Vec3 {
  const s = (near - behind.z) / (front.z - behind.z);
  return {x: behind.x + s * (front.x - behind.x), y: behind.y + s * (front.y - behind.y), z: near};
}

function isDistorted(l: Intrinsics): boolean {
  return l.k1 !== 0 || l.k2 !== 0 || l.k3 !== 0 || l.p1 !== 0 || l.p2 !== 0;
}

/** An ideal pixel as the lens shows it. */
export function distort(l: Intrinsics, u: number, v: number): Vec2 {
  if (!isDistorted(l)) return {x: u, y: v};
  const x = (u - l.cx) / l.fx, y = (v - l.cy) / l.fy, r2 = x * x + y * y;
  const radial = 1 + r2 * (l.k1 + r2 * (l.k2 + r2 * l.k3));
  return {
    x: l.fx * (x * radial + 2 * l.p1 * x * y + l.p2 * (r2 + 2 * x * x)) + l.cx,
    y: l.fy * (y * radial + l.p1 * (r2 + 2 * y * y) + 2 * l.p2 * x * y) + l.cy,
  };
}

/** The inverse of distort, by fixed-point iteration. */
export function undistort(l: Intrinsics, u: number, v: number): Vec2 {
  if (!isDistorted(l)) return {x: u, y: v};
  let x = u, y = v;
  for (let i = 0; i < 12; ++i) {
    const d = distort(l, x, y);
    x += u - d.x;
    y += v - d.y;
  }
  return {x, y};
}

/** A straight line of ideal pixels as the lens bends it. */
export function bend(l: Intrinsics, a: Vec2, b: Vec2): Vec2[] {
  if (!isDistorted(l)) return [a, b];
  const pieces = 8;
  return Array.from({length: pieces + 1}, (_, i) =>
    distort(l, a.x + (b.x - a.x) * i / pieces, a.y + (b.y - a.y) * i / pieces));
}

/** Points of the 1-sigma ellipse of a symmetric 2x2 covariance, `scale` sigmas large. */
export function ellipse(m00: number, m01: number, m11: number, scale: number, points = 24): Vec2[] {
  const half = (m00 + m11) / 2, root = Math.hypot((m00 - m11) / 2, m01);
  const major = Math.sqrt(Math.max(half + root, 0)) * scale, minor = Math.sqrt(Math.max(half - root, 0)) * scale;
  const angle = 0.5 * Math.atan2(2 * m01, m00 - m11), c = Math.cos(angle), s = Math.sin(angle);
  return Array.from({length: points}, (_, i) => {
    const t = 2 * Math.PI * i / points, x = major * Math.cos(t), y = minor * Math.sin(t);
    return {x: c * x - s * y, y: s * x + c * y};
  });
}

/** Distance of a point from a segment, all in the plane. */
export function distanceToSegment(px: number, py: number, ax: number, ay: number, bx: number, by: number): number {
  const dx = bx - ax, dy = by - ay, n = dx * dx + dy * dy;
  const s = n > 0 ? Math.min(1, Math.max(0, ((px - ax) * dx + (py - ay) * dy) / n)) : 0;
  return Math.hypot(px - ax - s * dx, py - ay - s * dy);
}
