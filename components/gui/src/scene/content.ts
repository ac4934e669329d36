// What the scene shows of a moment, as lines and symbols. The group `odom` holds what is known in the odometry's frame.
import {DataTexture, DoubleSide, Group, Mesh, MeshBasicMaterial, NearestFilter, PlaneGeometry, RGBAFormat, Scene, Shape, ShapeGeometry, Color} from "three";
import {CameraView, compose, ellipse, inverse} from "../shared/geometry";
import type {Pose2, Vec2} from "../shared/geometry";
import {colour, heat, labelColour, rgb} from "../shared/palette";
import type {Theme} from "../shared/palette";
import {column, ground, mapRowSize, rowSize} from "../shared/state";
import type {AttentionPoint, HealthGrid, MapState, MemoryState, Moment, Primitive} from "../shared/state";
import type {Selection} from "../state/store";
import {LineBuilder, ThinLines, WideLines} from "./lines";
import {Trail} from "./trails";

export type ColourBy = "kind" | "label" | "life" | "age" | "uncertainty";

export interface SceneOptions {
  colourBy: ColourBy;
  map: boolean; memory: boolean; ellipses: boolean; primitives: boolean; attention: boolean; races: boolean; trails: boolean; frustum: boolean;
}
export const defaultSceneOptions: SceneOptions =
  {colourBy: "kind", map: true, memory: true, ellipses: true, primitives: true, attention: true, races: true, trails: true, frustum: true};

export interface SceneInput {
  moment: Moment;
  map: MapState | null;
  options: SceneOptions;
  theme: Theme;
  selection: Selection | null;
  grid: HealthGrid | null;
  ghost: Pose2 | null;
  /** Boxes that were put into a simulated world, of 0.4 m. */
  occluders: readonly Vec2[];
  /** Ends of what is measured. */
  measured: readonly [Vec2, Vec2] | null;
}

type RGB = [number, number, number];

/** A triangle that points along x, about one unit long. */
const triangle = [{x: 0.65, y: 0}, {x: -0.4, y: 0.4}, {x: -0.2, y: 0}, {x: -0.4, y: -0.4}];

export class SceneContent {
  readonly scene = new Scene();
  readonly trails = {estimate: new Trail(), odometry: new Trail(), truth: new Trail()};
  /** T_world_odom as drawn; identity without a pose. */
  odomInWorld: Pose2 = {x: 0, y: 0, theta: 0};
  private readonly odom = new Group();
  private readonly mapLines = new ThinLines();
  private readonly confirmed = new WideLines(2.5);
  private readonly unconfirmed = new WideLines(2, {on: 0.06, off: 0.05});
  private readonly offFloor = new ThinLines(0.7);
  private readonly selected = new WideLines(5);
  private readonly ellipses = new ThinLines(0.7);
  private readonly primitives = new WideLines(1.5);
  private readonly attention = new ThinLines();
  private readonly target = new WideLines(2);
  private readonly frustum = new ThinLines(0.8);
  private readonly trailLines = new ThinLines();
  private readonly raceLines = new ThinLines();
  private readonly symbols = new WideLines(2);
  private readonly robot: Mesh<ShapeGeometry, MeshBasicMaterial>;
  private heat: Mesh<PlaneGeometry, MeshBasicMaterial> | null = null;
  private heatOf: HealthGrid | null = null;
  private mapDrawn = "";
  private anchor: Pose2 | null = null;
  private lastEpoch = -1;
  private lastRevision = -1;

  constructor() {
    const shape = new Shape();
    triangle.forEach((p, i) => i === 0 ? shape.moveTo(p.x, p.y) : shape.lineTo(p.x, p.y));
    this.robot = new Mesh(new ShapeGeometry(shape), new MeshBasicMaterial({side: DoubleSide}));
    this.odom.add(this.confirmed, this.unconfirmed, this.offFloor, this.selected, this.ellipses, this.primitives, this.attention, this.target, this.frustum);
    this.scene.add(this.mapLines, this.odom, this.trailLines, this.raceLines, this.symbols, this.robot);
  }

  /** Notes where the robot was; for every live moment, also while nothing is drawn. */
  follow(m: Moment): void {
    const e = m.estimate;
    if (e && e.revision < this.lastRevision) {
      this.anchor = null;
      for (const trail of Object.values(this.trails)) trail.clear();
    }
    this.lastRevision = e?.revision ?? -1;
    if (m.truth) this.trails.truth.add(m.t, m.truth.pose.x, m.truth.pose.y);
    if (!e?.hasPose) return;
    this.trails.estimate.add(m.t, e.world.x, e.world.y);
    // Odometry has no place in the world of its own: it begins where the localization was first sure.
    if (!this.anchor && e.reliability > 0.6) this.anchor = compose(e.world, inverse(e.odom));
    if (this.anchor) {
      const p = compose(this.anchor, e.odom);
      this.trails.odometry.add(m.t, p.x, p.y);
    }
  }

  update(input: SceneInput): void {
    const {moment: m, options: o, theme} = input;
    const e = m.estimate;
    this.odomInWorld = e?.hasPose ? compose(e.world, inverse(e.odom)) : {x: 0, y: 0, theta: 0};
    this.odom.position.set(this.odomInWorld.x, this.odomInWorld.y, 0);
    this.odom.rotation.z = this.odomInWorld.theta;
    this.scene.background = new Color(colour("background", theme));
    this.drawMap(input);
    this.drawMemory(input);
    this.drawPrimitives(input);
    this.drawAttention(input);
    this.drawFrustum(m, o.frustum, theme);
    this.drawTrails(m, o.trails, theme);
    this.drawHeat(input.grid);
    this.lastEpoch = m.memory?.epoch ?? this.lastEpoch;
  }

  /** Symbols have a least size on the screen, so they are drawn for each view. @param metresPerPixel at the robot. */
  drawSymbols(input: SceneInput, metresPerPixel: number): void {
    const {moment: m, theme} = input, size = Math.max(0.45, 16 * metresPerPixel), lines = new LineBuilder(), races = new LineBuilder();
    const e = m.estimate, centre = m.analysis?.robot && e?.hasPose ? compose(this.odomInWorld, m.analysis.robot) : e?.hasPose ? e.world : m.memory?.robot;
    this.robot.visible = centre !== undefined;
    if (centre) {
      this.robot.position.set(centre.x, centre.y, 0.02);
      this.robot.rotation.z = centre.theta;
      this.robot.scale.setScalar(size);
      this.robot.material.color.setStyle(colour("estimate", theme));
    }
    if (e?.hasPose) {
      const c = rgb(colour("estimate", theme)), [xx, xy, , yy] = e.covariance;
      lines.chain(ellipse(xx!, xy!, yy!, 2).map(p => ({x: e.world.x + p.x, y: e.world.y + p.y})), 0.02, c, true);
    }
    if (m.truth) lines.chain(placed(triangle, m.truth.pose, size), 0.03, rgb(colour("truth", theme)), true);
    if (this.anchor && m.odometry && input.options.trails) this.drawCross(lines, compose(this.anchor, m.odometry.pose), size * 0.4, rgb(colour("odometry", theme)));
    if (input.options.races && e) {
      for (const race of e.races) {
        const strength = 0.35 + 0.65 * race.weight, c = mixed(rgb(colour("race", theme)), rgb(colour("background", theme)), strength);
        races.chain(placed(triangle, race.pose, size * (0.6 + 0.5 * race.health)), 0.025, c, true);
      }
    }
    for (const {x, y} of input.occluders) {
      const r = 0.2;
      lines.chain([{x: x - r, y: y - r}, {x: x + r, y: y - r}, {x: x + r, y: y + r}, {x: x - r, y: y + r}], 0.02, rgb(colour("truth", theme)), true);
    }
    if (input.ghost) {
      const c = rgb(colour("selection", theme)), g = input.ghost, tip = {x: g.x + 1.6 * size * Math.cos(g.theta), y: g.y + 1.6 * size * Math.sin(g.theta)};
      lines.chain(placed(triangle, g, size * 1.1), 0.05, c, true);
      lines.add(g.x, g.y, 0.05, tip.x, tip.y, 0.05, c);
    }
    if (input.measured) {
      const c = rgb(colour("selection", theme)), [a, b] = input.measured;
      lines.add(a.x, a.y, 0.05, b.x, b.y, 0.05, c);
      for (const end of input.measured) this.drawCross(lines, {...end, theta: 0}, size * 0.25, c);
    }
    this.symbols.set(lines);
    this.raceLines.set(races);
  }

  private drawCross(lines: LineBuilder, p: Pose2, size: number, c: RGB): void {
    const s = Math.sin(p.theta) * size, k = Math.cos(p.theta) * size;
    lines.add(p.x - k, p.y - s, 0.03, p.x + k, p.y + s, 0.03, c);
    lines.add(p.x + s, p.y - k, 0.03, p.x - s, p.y + k, 0.03, c);
  }

  private drawMap({map, options, theme, selection}: SceneInput): void {
    this.mapLines.visible = options.map && map !== null;
    const key = `${map?.id} ${theme} ${options.colourBy} ${selection?.kind === "map" ? selection.id : ""}`;
    if (!map || key === this.mapDrawn) return;
    this.mapDrawn = key;
    const lines = new LineBuilder(), r = map.rows;
    for (let i = 0; i < r.length; i += mapRowSize) {
      const chosen = selection?.kind === "map" && selection.id === i / mapRowSize;
      lines.add(r[i]!, r[i + 1]!, r[i + 2]!, r[i + 3]!, r[i + 4]!, r[i + 5]!, rgb(colour(chosen ? "selection" : "map", theme)));
    }
    this.mapLines.set(lines);
    this.mapLines.visible = options.map;
  }

  private drawMemory({moment, options: o, theme, selection}: SceneInput): void {
    const memory = moment.memory, sure = new LineBuilder(), unsure = new LineBuilder(), off = new LineBuilder(), rings = new LineBuilder(), chosen = new LineBuilder();
    if (memory && o.memory) {
      const colourOf = segmentColours(memory, o.colourBy, theme), ring = rgb(colour("dim", theme));
      for (let i = 0; i < memory.ids.length; ++i) {
        const r = memory.rows, k = i * rowSize, into = [unsure, sure, off][memory.ground[i]!]!;
        into.add(r[k]!, r[k + 1]!, r[k + 2]!, r[k + 3]!, r[k + 4]!, r[k + 5]!, colourOf(i));
        if (selection?.kind === "segment" && selection.id === memory.ids[i])
          chosen.add(r[k]!, r[k + 1]!, r[k + 2]!, r[k + 3]!, r[k + 4]!, r[k + 5]!, rgb(colour("selection", theme)));
        if (!o.ellipses) continue;
        for (const [end, cov] of [[column.ax, column.covA], [column.bx, column.covB]] as const) {
          const points = ellipse(r[k + cov]!, r[k + cov + 1]!, r[k + cov + 3]!, 2, 12);
          rings.chain(points.map(p => ({x: r[k + end]! + p.x, y: r[k + end + 1]! + p.y})), r[k + end + 2]!, ring, true);
        }
      }
    }
    this.confirmed.set(sure);
    this.unconfirmed.set(unsure);
    this.offFloor.set(off);
    this.ellipses.set(rings);
    this.selected.set(chosen);
  }

  private drawPrimitives({moment, options, theme, selection}: SceneInput): void {
    const lines = new LineBuilder(), hypothesis = rgb(colour("hypothesis", theme));
    if (options.primitives && moment.memory) {
      for (const p of moment.memory.primitives) {
        const chosen = selection?.kind === "primitive" && selection.id === p.id;
        const c = rgb(colour(chosen ? "selection" : "primitive", theme)), points = outlineOf(p);
        lines.chain(points, 0.01, c, p.kind !== "Stripe" && p.kind !== "Arrow");
      }
      for (const h of moment.memory.hypotheses) {
        const s = 0.07;
        lines.chain([{x: h.x - s, y: h.y - s}, {x: h.x + s, y: h.y - s}, {x: h.x + s, y: h.y + s}, {x: h.x - s, y: h.y + s}], 0.01, hypothesis, true);
      }
    }
    this.primitives.set(lines);
  }

  private drawAttention({moment, options, theme, selection}: SceneInput): void {
    const rings = new LineBuilder(), target = new LineBuilder(), gaze = moment.gaze, robot = moment.analysis?.robot ?? moment.memory?.robot;
    if (options.attention && gaze && robot) {
      const most = Math.max(1e-6, ...gaze.points.map(p => p.salience)), c = rgb(colour("gaze", theme));
      for (const p of gaze.points) {
        const at = placeOf(p, robot), chosen = selection?.kind === "attention" && selection.id === p.id;
        rings.chain(circle(at, 0.05 + 0.16 * p.salience / most), at.z, chosen ? rgb(colour("selection", theme)) : mixed(c, rgb(colour("background", theme)), 0.35 + 0.65 * p.salience / most), true);
      }
      if (gaze.target) {
        const at = placeOf(gaze.target, robot);
        target.chain(circle(at, 0.2), at.z, c, true);
        for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]] as const)
          target.add(at.x + 0.14 * dx, at.y + 0.14 * dy, at.z, at.x + 0.28 * dx, at.y + 0.28 * dy, at.z, c);
      }
    }
    this.attention.set(rings);
    this.target.set(target);
  }

  private drawFrustum(m: Moment, on: boolean, theme: Theme): void {
    const lines = new LineBuilder(), a = m.analysis;
    if (on && a) {
      const view = new CameraView(a.robot, a.camera, a.lens), c = rgb(colour("estimate", theme)), o = view.centre(), {width: w, height: h} = a.lens;
      const corners = [[0, 0], [w - 1, 0], [w - 1, h - 1], [0, h - 1]].map(([u, v]) => view.pointAt(u!, v!, 3, 3));
      corners.forEach((p, i) => {
        const q = corners[(i + 1) % 4]!;
        lines.add(o.x, o.y, o.z, p.x, p.y, p.z, c);
        lines.add(p.x, p.y, p.z, q.x, q.y, q.z, c);
      });
    }
    this.frustum.set(lines);
  }

  private drawTrails(m: Moment, on: boolean, theme: Theme): void {
    const lines = new LineBuilder(), until = m.live ? Infinity : m.t;
    if (on) {
      for (const name of ["truth", "odometry", "estimate"] as const) {
        const c = rgb(colour(name, theme));
        // Odometry is dash-dotted: form differs, not the colour alone.
        this.trails[name].forEachPiece(until, (ax, ay, bx, by, i) => { if (name !== "odometry" || i % 4 !== 0) lines.add(ax, ay, 0.015, bx, by, 0.015, c); });
      }
    }
    this.trailLines.set(lines);
  }

  private drawHeat(grid: HealthGrid | null): void {
    if (grid === this.heatOf) return;
    this.heatOf = grid;
    if (this.heat) {
      this.scene.remove(this.heat);
      this.heat.material.map?.dispose();
      this.heat.material.dispose();
      this.heat.geometry.dispose();
      this.heat = null;
    }
    if (!grid) return;
    const {columns, rows, cellM, low} = grid, data = new Uint8Array(columns * rows * 4);
    grid.health.forEach((value, i) => data.set([...heat(value).map(c => Math.round(c * 255)), 60 + Math.round(180 * value)], i * 4));
    const texture = new DataTexture(data, columns, rows, RGBAFormat);
    texture.magFilter = NearestFilter;
    texture.needsUpdate = true;
    this.heat = new Mesh(new PlaneGeometry(columns * cellM, rows * cellM), new MeshBasicMaterial({map: texture, transparent: true, depthWrite: false}));
    this.heat.position.set(low.x + (columns - 1) / 2 * cellM, low.y + (rows - 1) / 2 * cellM, -0.01);
    this.scene.add(this.heat);
  }
}

function placed(points: readonly {x: number; y: number}[], p: Pose2, size: number): {x: number; y: number}[] {
  const c = Math.cos(p.theta) * size, s = Math.sin(p.theta) * size;
  return points.map(q => ({x: p.x + c * q.x - s * q.y, y: p.y + s * q.x + c * q.y}));
}

function circle(centre: {x: number; y: number}, radius: number, n = 20): {x: number; y: number}[] {
  return Array.from({length: n}, (_, i) => ({x: centre.x + radius * Math.cos(2 * Math.PI * i / n), y: centre.y + radius * Math.sin(2 * Math.PI * i / n)}));
}

function mixed(a: RGB, b: RGB, share: number): RGB {
  return [b[0] + share * (a[0] - b[0]), b[1] + share * (a[1] - b[1]), b[2] + share * (a[2] - b[2])];
}

/** In odom; a direction of the head is shown where it meets the floor, 0.6 to 3 m away. */
export function placeOf(p: AttentionPoint, robot: Pose2): {x: number; y: number; z: number} {
  if (p.isPlace) return p;
  const range = p.tilt < -0.05 ? Math.min(3, Math.max(0.6, 0.45 / Math.tan(-p.tilt))) : 3, at = robot.theta + p.pan;
  return {x: robot.x + range * Math.cos(at), y: robot.y + range * Math.sin(at), z: 0};
}

export function outlineOf(p: Primitive): {x: number; y: number}[] {
  if (p.kind === "Circle") return circle(p, p.radiusM, 32);
  const points: {x: number; y: number}[] = [];
  for (let i = 0; i + 1 < p.vertices.length; i += 2) points.push({x: p.vertices[i]!, y: p.vertices[i + 1]!});
  if (p.kind !== "Arrow" || points.length < 4) return points;
  // Tip, tail, ends of the two heads: drawn tail, tip, left, tip, right.
  return [points[1]!, points[0]!, points[2]!, points[0]!, points[3]!];
}

function segmentColours(memory: MemoryState, by: ColourBy, theme: Theme): (i: number) => RGB {
  const value = (i: number, c: number) => memory.rows[i * rowSize + c]!, sure = rgb(colour("memory", theme)), paper = rgb(colour("background", theme)), dim = rgb(colour("dim", theme));
  const largest = (c: number) => { let m = 1e-9; for (let i = 0; i < memory.ids.length; ++i) m = Math.max(m, value(i, c)); return m; };
  const now = (memory.stampUs - memory.stampBaseUs) / 1e6;
  switch (by) {
    case "label": return i => rgb(labelColour(memory.labels[i]!, theme));
    case "life": { const m = largest(column.life); return i => heat(value(i, column.life) / m); }
    case "age": return i => heat(1 - Math.min(1, (now - value(i, column.lastSeen)) / 20));
    case "uncertainty":
      return i => heat(1 - Math.min(1, Math.sqrt(Math.max(value(i, column.covA) + value(i, column.covA + 3), value(i, column.covB) + value(i, column.covB + 3))) / 0.2));
    default: return i => memory.ground[i] === ground.off ? dim : memory.ground[i] === ground.confirmed ? sure : mixed(sure, paper, 0.6);
  }
}
