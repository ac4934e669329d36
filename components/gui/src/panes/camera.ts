// The camera's picture with overlays. The worker draws it; a click points the gaze.
import type {OverlayName} from "../shared/messages";
import type {Store} from "../state/store";
import {clockText, fixed, h, say, toggle} from "./dom";
import {Pane} from "./pane";

const overlays: readonly (readonly [OverlayName, string, string])[] = [
  ["observed", "observed", "segments found in this image; the tick is on the brighter side"],
  ["predicted", "predicted", "segments that the memory expects in this image"],
  ["matched", "matched", "observed segments that fulfil a prediction, joined to it"],
  ["labels", "labels", "the colour pair of each observed segment"],
  ["horizon", "horizon", "where the floor ends"],
  ["map", "map", "the map's lines as the best pose would show them"],
  ["gaze", "gaze", "what the camera is to look at"],
  ["raw", "at once", "draw each image at once instead of waiting up to 60 ms for its analysis"],
];

export class CameraPane extends Pane {
  private readonly canvas: HTMLCanvasElement;
  private readonly stamp: HTMLElement;
  private readonly empty = h("div", {class: "empty"});

  constructor(store: Store) {
    super(store, "camera");
    const bar = h("div", {class: "toolbar", attrs: {role: "toolbar", "aria-label": "overlays"}});
    for (const [name, text, title] of overlays)
      bar.append(toggle(text, title, store.overlays.value[name], on => { store.overlays.value = {...store.overlays.value, [name]: on}; }));
    this.canvas = h("canvas", {class: "video", attrs: {role: "img", "aria-label": "camera picture; click to look there", tabindex: "0"}});
    this.stamp = h("div", {class: "stamp"});
    const frame = h("div", {class: "canvas-frame"}, this.canvas, this.empty, this.stamp);
    this.element.append(bar, frame);
    const offscreen = this.canvas.transferControlToOffscreen();
    store.send({kind: "canvas", canvas: offscreen}, [offscreen]);
    const observer = new ResizeObserver(() => this.resize(frame));
    observer.observe(frame);
    this.whenDone(() => observer.disconnect());
    this.canvas.addEventListener("click", event => this.lookAt(event.offsetX, event.offsetY));
    this.follow(() => this.drawStamp());
  }

  private resize(frame: HTMLElement): void {
    const {clientWidth: width, clientHeight: height} = frame;
    if (width > 0 && height > 0) this.store.send({kind: "canvasSize", width, height, ratio: Math.min(devicePixelRatio, 2)});
  }

  protected override onVisible(): void {
    this.store.send({kind: "visible", page: !document.hidden, camera: this.visible});
  }

  private lookAt(x: number, y: number): void {
    if (this.store.config.viewer) return;
    const place = this.store.imagePlace;
    const u = (x - place.x) / place.scale - 0.5, v = (y - place.y) / place.scale - 0.5;
    if (u < -0.5 || v < -0.5 || u > place.width - 0.5 || v > place.height - 0.5) return;
    void this.store.act(`gaze to pixel ${u.toFixed(0)}, ${v.toFixed(0)}`, "gazeAtPixel", u, v, place.width);
  }

  private drawStamp(): void {
    const video = this.store.video.value, moment = this.store.moment.value, none = !this.store.config.proxies.Camera;
    say(this.empty, none ? "This setup has no camera." : !video || video.last === 0 ? `No image yet${video?.message ? `: ${video.message}` : ""}.` : "");
    this.stamp.classList.toggle("hidden", this.empty.textContent !== "");
    if (!video) return;
    if (!moment.live) return say(this.stamp, `${stampText(moment.frame?.stampUs)}, ${fixed(((moment.frame?.t ?? moment.t) - moment.t) / 1000, 2)} s from this moment`);
    const a = moment.analysis;
    say(this.stamp, `${stampText(video.stampUs)}${this.store.stands ? "" : `  age ${fixed(video.ageMs, 0)} ms`}  ${fixed(video.fps, 0)} fps  ${video.width}x${video.height}` +
        (a ? `  ${a.observedLabels.length} observed, ${a.predictedIds.length} predicted, ${a.matches.length / 2} matched` : ""));
  }
}

/** Simulated and recorded stamps as seconds, real ones as the time of day. */
export function stampText(us: number | undefined): string {
  if (us === undefined) return "-";
  if (us < 1e14) return `${(us / 1e6).toFixed(2)} s`;
  return clockText(us);
}
