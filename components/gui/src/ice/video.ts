// The camera's picture with overlays on the page's canvas, drawn by the worker.
import {bend, CameraView, compose, distort, inverse} from "../shared/geometry";
import type {Pose2, Vec2} from "../shared/geometry";
import {defaultOverlays} from "../shared/messages";
import type {ImagePlace, OverlayOptions} from "../shared/messages";
import {colour, labelColour} from "../shared/palette";
import type {AnalysisState, EstimateState, GazeState, MapState} from "../shared/state";
import {mapRowSize} from "../shared/state";

export interface Picture {
  bitmap: ImageBitmap;
  width: number;
  height: number;
  analysis: AnalysisState | null;
  estimate: EstimateState | null;
  gaze: GazeState | null;
  /** Said across the picture; empty while it is fresh. */
  note: string;
}

export class Video {
  overlays: OverlayOptions = defaultOverlays;
  map: MapState | null = null;
  place: ImagePlace = {x: 0, y: 0, scale: 1, width: 0, height: 0};
  private canvas: OffscreenCanvas | null = null;
  private context: OffscreenCanvasRenderingContext2D | null = null;
  private ratio = 1;
  private last: Picture | null = null;

  setCanvas(canvas: OffscreenCanvas): void {
    this.canvas = canvas;
    this.context = canvas.getContext("2d", {alpha: false});
  }

  resize(width: number, height: number, ratio: number): void {
    if (!this.canvas || width < 1 || height < 1) return;
    this.ratio = ratio;
    const w = Math.round(width * ratio), h = Math.round(height * ratio);
    if (this.canvas.width === w && this.canvas.height === h) return;
    this.canvas.width = w;
    this.canvas.height = h;
    this.redraw();
  }

  /** Takes the bitmap over and closes it when the next one comes. */
  show(picture: Picture): void {
    if (this.last && this.last.bitmap !== picture.bitmap) this.last.bitmap.close();
    this.last = picture;
    this.redraw();
  }

  /** Says something across the last picture. */
  note(text: string): void {
    if (this.last?.note === text) return;
    if (this.last) this.last.note = text;
    this.redraw();
  }

  redraw(): void {
    const {context: c, canvas} = this;
    if (!c || !canvas) return;
    c.setTransform(1, 0, 0, 1, 0, 0);
    c.fillStyle = "#0b0e12";
    c.fillRect(0, 0, canvas.width, canvas.height);
    const picture = this.last;
    if (!picture) return;
    const scale = Math.min(canvas.width / picture.width, canvas.height / picture.height);
    const x = Math.floor((canvas.width - picture.width * scale) / 2), y = Math.floor((canvas.height - picture.height * scale) / 2);
    this.place = {x: x / this.ratio, y: y / this.ratio, scale: scale / this.ratio, width: picture.width, height: picture.height};
    c.imageSmoothingEnabled = scale < 3;
    c.drawImage(picture.bitmap, x, y, picture.width * scale, picture.height * scale);
    c.save();
    c.beginPath();
    c.rect(x, y, picture.width * scale, picture.height * scale);
    c.clip();
    // Pixel centres are on whole numbers: pixel (0, 0) covers -0.5..0.5.
    c.setTransform(scale, 0, 0, scale, x + scale / 2, y + scale / 2);
    this.drawOverlays(c, picture, scale / this.ratio);
    c.restore();
    if (picture.note) this.drawNote(c, picture.note);
  }

  private drawNote(c: OffscreenCanvasRenderingContext2D, text: string): void {
    const {width, height} = this.canvas!, size = 14 * this.ratio;
    c.setTransform(1, 0, 0, 1, 0, 0);
    c.strokeStyle = "rgba(255,138,76,0.35)";
    c.lineWidth = 2 * this.ratio;
    c.beginPath();
    for (let i = -height; i < width; i += 24 * this.ratio) { c.moveTo(i, height); c.lineTo(i + height, 0); }
    c.stroke();
    c.font = `600 ${size}px sans-serif`;
    c.textAlign = "center";
    c.fillStyle = "rgba(11,14,18,0.85)";
    c.fillRect(0, height / 2 - size, width, size * 2);
    c.fillStyle = "#ffb38a";
    c.textBaseline = "middle";
    c.fillText(text, width / 2, height / 2, width - 10);
  }

  private drawOverlays(c: OffscreenCanvasRenderingContext2D, picture: Picture, scale: number): void {
    const a = picture.analysis, o = this.overlays;
    if (!a) return;
    // The memory looks at fine images in blocks of pixels.
    const block = picture.width / a.lens.width;
    c.transform(block, 0, 0, block, (block - 1) / 2, (block - 1) / 2);
    const px = 1 / Math.max(scale * block, 0.1);
    if (o.map && picture.estimate?.hasPose) this.drawMap(c, a, picture.estimate, px);
    if (o.horizon) this.drawHorizon(c, a, px);
    if (o.observed) this.drawSegments(c, a, a.observed, 5, "observed", 1.5 * px, []);
    if (o.predicted) this.drawSegments(c, a, a.predicted, 4, "predicted", 1.5 * px, [2 * px, 3 * px]);
    if (o.matched) this.drawMatches(c, a, px);
    if (o.labels) this.drawLabels(c, a, px);
    if (o.gaze && picture.gaze?.target) this.drawGaze(c, a, picture.gaze, px);
  }

  private path(c: OffscreenCanvasRenderingContext2D, points: Vec2[]): void {
    points.forEach((p, i) => i === 0 ? c.moveTo(p.x, p.y) : c.lineTo(p.x, p.y));
  }

  private drawSegments(c: OffscreenCanvasRenderingContext2D, a: AnalysisState, data: Float32Array, stride: number, name: "observed" | "predicted",
    width: number, dash: number[]): void {
    c.beginPath();
    for (let i = 0; i < data.length; i += stride) {
      const p = {x: data[i]!, y: data[i + 1]!}, q = {x: data[i + 2]!, y: data[i + 3]!};
      this.path(c, bend(a.lens, p, q));
      if (name !== "observed") continue;
      // A tick on the brighter side, which lies to the left of a -> b.
      const l = Math.hypot(q.x - p.x, q.y - p.y) || 1, mx = (p.x + q.x) / 2, my = (p.y + q.y) / 2, m = distort(a.lens, mx, my);
      c.moveTo(m.x, m.y);
      c.lineTo(m.x + (q.y - p.y) / l * 3 * width, m.y - (q.x - p.x) / l * 3 * width);
    }
    c.setLineDash(dash);
    c.lineWidth = width;
    c.strokeStyle = colour(name, "dark");
    c.stroke();
    c.setLineDash([]);
  }

  private drawMatches(c: OffscreenCanvasRenderingContext2D, a: AnalysisState, px: number): void {
    c.strokeStyle = colour("matched", "dark");
    c.beginPath();
    for (let k = 0; k < a.matches.length; k += 2) {
      const i = a.matches[k]! * 5, d = a.observed;
      this.path(c, bend(a.lens, {x: d[i]!, y: d[i + 1]!}, {x: d[i + 2]!, y: d[i + 3]!}));
    }
    c.lineWidth = 3 * px;
    c.stroke();
    c.beginPath();
    for (let k = 0; k < a.matches.length; k += 2) {
      const i = a.matches[k]! * 5, j = a.matches[k + 1]! * 4, d = a.observed, e = a.predicted;
      const p = distort(a.lens, (d[i]! + d[i + 2]!) / 2, (d[i + 1]! + d[i + 3]!) / 2), q = distort(a.lens, (e[j]! + e[j + 2]!) / 2, (e[j + 1]! + e[j + 3]!) / 2);
      c.moveTo(p.x, p.y);
      c.lineTo(q.x, q.y);
    }
    c.lineWidth = px;
    c.stroke();
  }

  private drawLabels(c: OffscreenCanvasRenderingContext2D, a: AnalysisState, px: number): void {
    c.font = `${11 * px}px sans-serif`;
    c.textAlign = "center";
    c.textBaseline = "middle";
    c.lineWidth = 3 * px;
    c.strokeStyle = "rgba(11,14,18,0.9)";
    for (let i = 0; i < a.observedLabels.length; ++i) {
      const d = a.observed, k = i * 5, label = a.observedLabels[i]!;
      if (Math.hypot(d[k + 2]! - d[k]!, d[k + 3]! - d[k + 1]!) < 24 * px) continue;
      const m = distort(a.lens, (d[k]! + d[k + 2]!) / 2, (d[k + 1]! + d[k + 3]!) / 2);
      c.strokeText(a.labelNames[label] ?? "", m.x, m.y);
      c.fillStyle = labelColour(label, "dark");
      c.fillText(a.labelNames[label] ?? "", m.x, m.y);
    }
  }

  /** Where rays are level: the far end of the floor. */
  private drawHorizon(c: OffscreenCanvasRenderingContext2D, a: AnalysisState, px: number): void {
    const view = new CameraView(a.robot, a.camera, a.lens), centre = view.centre(), forward = view.ray(a.lens.cx, a.lens.cy);
    const heading = Math.atan2(forward.y, forward.x), points: Vec2[] = [];
    for (let d = -1.2; d < 1.2; d += 0.1) {
      const far = (angle: number) => ({x: centre.x + 1000 * Math.cos(heading + angle), y: centre.y + 1000 * Math.sin(heading + angle), z: centre.z});
      points.push(...view.projectSegment(far(d), far(d + 0.1)));
    }
    c.beginPath();
    this.path(c, points);
    c.setLineDash([10 * px, 5 * px]);
    c.lineWidth = px;
    c.strokeStyle = "#ffffff";
    c.stroke();
    c.setLineDash([]);
  }

  private drawMap(c: OffscreenCanvasRenderingContext2D, a: AnalysisState, estimate: EstimateState, px: number): void {
    if (!this.map) return;
    const robot = poseAt(estimate, a.robot), view = new CameraView(robot, a.camera, a.lens), r = this.map.rows;
    c.beginPath();
    for (let i = 0; i < r.length; i += mapRowSize) {
      const dx = (r[i]! + r[i + 3]!) / 2 - robot.x, dy = (r[i + 1]! + r[i + 4]!) / 2 - robot.y;
      const half = Math.hypot(r[i + 3]! - r[i]!, r[i + 4]! - r[i + 1]!) / 2;
      if (Math.hypot(dx, dy) - half > 8) continue;
      this.path(c, view.projectSegment({x: r[i]!, y: r[i + 1]!, z: r[i + 2]!}, {x: r[i + 3]!, y: r[i + 4]!, z: r[i + 5]!}));
    }
    c.lineWidth = 1.2 * px;
    c.strokeStyle = "#c8d2de";
    c.stroke();
  }

  private drawGaze(c: OffscreenCanvasRenderingContext2D, a: AnalysisState, gaze: GazeState, px: number): void {
    const target = gaze.target!;
    if (!target.isPlace) return;
    const view = new CameraView(a.robot, a.camera, a.lens), p = view.projectSegment(target, target)[0];
    if (!p) return;
    c.strokeStyle = colour("gaze", "dark");
    c.lineWidth = 2 * px;
    c.beginPath();
    c.arc(p.x, p.y, 9 * px, 0, 2 * Math.PI);
    for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]] as const) {
      c.moveTo(p.x + 6 * dx * px, p.y + 6 * dy * px);
      c.lineTo(p.x + 13 * dx * px, p.y + 13 * dy * px);
    }
    c.stroke();
  }
}

/** The estimate carried forward to where odometry says the robot is. */
export function poseAt(estimate: EstimateState, robotInOdom: Pose2): Pose2 {
  return compose(estimate.world, compose(inverse(estimate.odom), robotInOdom));
}
