// 3-D scene and top view: one WebGL context, two viewports, drawn only when something has changed.
import {ColorManagement, LinearSRGBColorSpace, MOUSE, OrthographicCamera, PerspectiveCamera, Plane, Raycaster, TOUCH, Vector2, Vector3, WebGLRenderer} from "three";
import type {Camera} from "three";
import {OrbitControls} from "three/addons/controls/OrbitControls.js";
import {compose} from "../shared/geometry";
import type {Pose2, Vec2} from "../shared/geometry";
import {mapRowSize} from "../shared/state";
import type {MapState, Moment} from "../shared/state";
import {defaultSceneOptions, SceneContent} from "../scene/content";
import type {ToScreen} from "../scene/picking";
import type {ColourBy, SceneInput, SceneOptions} from "../scene/content";
import {endUnder, pick} from "../scene/picking";
import {occludersOf} from "../state/store";
import type {Store, Tool} from "../state/store";
import {button, degrees, fixed, h, numberField, saveFile, say, select} from "./dom";
import {layers, Legend, signsOf} from "./legend";
import {Measure} from "./measure";
import {Pane} from "./pane";

// Colours are given as they shall look on the screen: no conversion on the way.
ColorManagement.enabled = false;

type Layout = "both" | "3d" | "top";
interface View { camera: PerspectiveCamera | OrthographicCamera; controls: OrbitControls; element: HTMLElement; top: boolean }

export class WorldPane extends Pane {
  private readonly content = new SceneContent();
  private readonly canvas = h("canvas", {class: "world-canvas", attrs: {"aria-hidden": "true"}});
  private readonly stage = h("div", {class: "stage"});
  private readonly status = h("div", {class: "stamp", attrs: {role: "status"}});
  private readonly empty = h("div", {class: "empty"});
  private readonly legend = new Legend();
  private readonly measure = new Measure();
  private readonly scaleBar = h("div", {class: "scale-bar"});
  private readonly form = h("form", {class: "pose-form hidden"});
  private readonly renderer: WebGLRenderer | null;
  private readonly views: View[] = [];
  private readonly software: boolean;
  private options: SceneOptions = {...defaultSceneOptions};
  private layout: Layout = "both";
  private followed: "none" | "3d" | "both" = "3d";
  private fitted = "";
  private ghost: Pose2 | null = null;
  private dragFrom: Vector3 | null = null;
  private scheduled = false;
  private lastDraw = 0;
  private renders = 0;
  private sized = {width: 0, height: 0};

  constructor(store: Store) {
    super(store, "world");
    this.layout = (localStorage.getItem("avm.world.layout") as Layout | null) ?? (innerWidth < 700 ? "top" : "both");
    this.element.append(this.makeToolbar(), this.stage);
    this.stage.append(this.canvas);
    this.renderer = this.makeRenderer();
    this.software = this.isSoftware();
    this.renderer?.setPixelRatio(this.software ? 1 : Math.min(devicePixelRatio, 2));
    this.views.push(this.makeView(false), this.makeView(true));
    // The form lies over the views: one that takes room would move the floor under the pointer in the middle of a drag.
    this.stage.append(this.status, this.empty, this.scaleBar, this.legend.element, this.measure.element, this.form);
    this.makeForm();
    const observer = new ResizeObserver(() => this.arrange());
    observer.observe(this.stage);
    this.whenDone(() => { observer.disconnect(); this.renderer?.dispose(); });
    this.follow(() => { this.content.follow(store.live.value); });
    this.follow(() => {
      void [store.moment.value, store.map.value, store.simulation.value, store.theme.value, store.selection.value, store.healthGrid.value];
      this.ask();
    });
    this.follow(() => {
      const tool = store.tool.value, setsPose = tool === "pose" || tool === "kidnap", drags = setsPose || tool === "measure";
      // A drag is an arrow or a length then, and must not move the view as well. The wheel and the right button go on.
      for (const {controls, top} of this.views) {
        controls.mouseButtons.LEFT = drags ? null : top ? MOUSE.PAN : MOUSE.ROTATE;
        controls.touches.ONE = drags ? null : top ? TOUCH.PAN : TOUCH.ROTATE;
      }
      if (!setsPose) this.setGhost(null);
      if (tool !== "measure") this.measure.show(null, null, "map");
    });
  }

  // ---- parts ----

  private makeToolbar(): HTMLElement {
    const bar = h("div", {class: "toolbar", attrs: {role: "toolbar", "aria-label": "scene"}});
    bar.append(select("arrangement", [["both", "3-D and top"], ["3d", "3-D"], ["top", "top view"]], this.layout, value => {
      this.layout = value as Layout;
      localStorage.setItem("avm.world.layout", value);
      this.arrange();
    }));
    bar.append(this.makeTools());
    bar.append(select("colour of segments", [["kind", "colour: state"], ["label", "colour: label"], ["life", "colour: life"], ["age", "colour: age"],
      ["uncertainty", "colour: sigma"]], this.options.colourBy, value => { this.options.colourBy = value as ColourBy; this.ask(); }));
    bar.append(this.makeLayers(), select("which view keeps the robot in its middle", [["3d", "follow: 3-D"], ["both", "follow: both"], ["none", "follow: none"]], this.followed,
      value => { this.followed = value as typeof this.followed; this.ask(); }),
      button("fit", "show the whole map", () => { this.fitted = ""; this.ask(); }), button("picture", "save this view as a PNG file", () => this.save()));
    return bar;
  }

  /** Which layers are drawn, with what their forms and colours mean. */
  private makeLayers(): HTMLElement {
    const menu = h("details", {class: "menu"}, h("summary", {text: "layers", class: "button", title: "what is drawn, and what its colours mean"})), list = h("div", {class: "menu-list layers"});
    for (const {option, text} of layers) {
      const box = h("input", {attrs: {type: "checkbox"}}), signs = h("span", {class: "signs"});
      box.checked = this.options[option] as boolean;
      box.addEventListener("change", () => { this.options = {...this.options, [option]: box.checked}; this.ask(); });
      list.append(h("label", {class: "check"}, box, text), signs);
      this.follow(() => signs.replaceChildren(...signsOf(option, this.store.theme.value)));
    }
    menu.append(list);
    return menu;
  }

  private makeTools(): HTMLElement {
    const tools: [string, string][] = [["select", "tool: select"], ["measure", "tool: measure"], ["gaze", "tool: look at"], ["pose", "tool: set pose"]];
    if (this.store.config.viewer) tools.length = 2;
    else if (this.store.config.proxies.Simulation && this.store.config.truth) tools.push(["kidnap", "tool: kidnap"], ["occluder", "tool: occluder"]);
    const box = select("what a click does", tools, "select", value => { this.store.tool.value = value as Tool; });
    this.follow(() => { box.value = this.store.tool.value; });
    return box;
  }

  private makeRenderer(): WebGLRenderer | null {
    try {
      const renderer = new WebGLRenderer({canvas: this.canvas, antialias: false, preserveDrawingBuffer: false});
      renderer.autoClear = false;
      renderer.outputColorSpace = LinearSRGBColorSpace;
      this.canvas.addEventListener("webglcontextlost", () => say(this.empty, "3-D view restarts"));
      this.canvas.addEventListener("webglcontextrestored", () => this.ask());
      return renderer;
    } catch (failure) {
      say(this.empty, `no 3-D view: ${(failure as Error).message}`);
      return null;
    }
  }

  private isSoftware(): boolean {
    const gl = this.renderer?.getContext();
    const info = gl?.getExtension("WEBGL_debug_renderer_info");
    return info !== null && info !== undefined && /swiftshader|llvmpipe/i.test(String(gl!.getParameter(info.UNMASKED_RENDERER_WEBGL)));
  }

  private makeView(top: boolean): View {
    const element = h("div", {class: "viewport", attrs: {role: "img", tabindex: "0", "aria-label": top ? "map from above" : "3-D scene"}});
    this.stage.append(element);
    const camera: PerspectiveCamera | OrthographicCamera = top ? new OrthographicCamera(-5, 5, 5, -5, 0.1, 200) : new PerspectiveCamera(50, 1, 0.05, 300);
    camera.up.set(0, 0, 1);
    if (top) camera.position.set(0, 0, 50);
    else camera.position.set(-4, -5, 5);
    const controls = new OrbitControls(camera, element);
    controls.enableRotate = !top;
    controls.screenSpacePanning = top;
    controls.maxPolarAngle = Math.PI / 2 - 0.02;
    if (top) {
      controls.mouseButtons = {LEFT: MOUSE.PAN, MIDDLE: MOUSE.DOLLY, RIGHT: MOUSE.PAN};
      controls.touches = {ONE: TOUCH.PAN, TWO: TOUCH.DOLLY_PAN};
      controls.maxPolarAngle = 0;
      controls.minAzimuthAngle = controls.maxAzimuthAngle = 0;
    }
    controls.listenToKeyEvents(element);
    controls.addEventListener("change", this.ask);
    const view = {camera, controls, element, top};
    element.addEventListener("pointerdown", event => this.pointerDown(view, event));
    element.addEventListener("pointermove", event => this.pointerMove(view, event));
    element.addEventListener("pointerup", event => this.pointerUp(view, event));
    return view;
  }

  /** A pose is shown as a ghost first; it can be typed; Enter applies and Escape drops it. */
  private makeForm(): void {
    // A dragged pose is seldom a multiple of the fields' steps: the browser would refuse it.
    this.form.noValidate = true;
    const fields = {x: numberField("x", 0, 0.01, "m"), y: numberField("y", 0, 0.01, "m"), heading: numberField("heading", 0, 1, "deg")};
    const read = () => {
      this.ghost = {x: fields.x.input.valueAsNumber || 0, y: fields.y.input.valueAsNumber || 0, theta: (fields.heading.input.valueAsNumber || 0) * Math.PI / 180};
      this.ask();
    };
    for (const field of Object.values(fields)) field.input.addEventListener("input", read);
    const apply = h("button", {class: "button primary", text: "apply", attrs: {type: "submit"}});
    this.form.append(fields.x.element, fields.y.element, fields.heading.element, apply, button("drop", "Escape", () => this.setGhost(null)));
    this.form.addEventListener("submit", event => {
      event.preventDefault();
      void this.applyGhost();
    });
    this.stage.addEventListener("keydown", event => {
      // After a drag the view has the focus.
      if (event.key !== "Enter" || !(event.target as HTMLElement).matches(".viewport")) return;
      void this.applyGhost();
    });
    this.element.addEventListener("keydown", event => {
      if (event.key !== "Escape" || (!this.ghost && !this.measure.from)) return;
      event.stopPropagation();
      this.measure.show(null, null, "map");
      this.setGhost(null);
    });
    this.showGhost = () => {
      fields.x.input.value = fixed(this.ghost?.x, 3);
      fields.y.input.value = fixed(this.ghost?.y, 3);
      fields.heading.input.value = this.ghost ? fixed(degrees(this.ghost.theta), 1) : "";
      say(apply, this.store.tool.value === "kidnap" ? "put the robot here" : "the robot is here");
    };
  }
  private showGhost: () => void = () => {};

  private setGhost(ghost: Pose2 | null): void {
    this.ghost = ghost;
    this.form.classList.toggle("hidden", ghost === null);
    this.showGhost();
    this.ask();
  }

  private async applyGhost(): Promise<void> {
    const g = this.ghost;
    if (!g) return;
    const before = this.store.moment.value.estimate, kidnap = this.store.tool.value === "kidnap";
    const text = `${kidnap ? "put the robot to" : "pose set to"} ${g.x.toFixed(2)}, ${g.y.toFixed(2)}, ${degrees(g.theta).toFixed(0)} deg`;
    const done = await this.store.act(text, kidnap ? "kidnap" : "setPose", g);
    if (!done) return;
    this.setGhost(null);
    this.store.tool.value = "select";
    if (!kidnap && before?.hasPose) this.offerUndo(before.world);
  }

  private offerUndo(pose: Pose2): void {
    const undo = button("undo set pose", "the pose before", () => { undo.remove(); void this.store.act("former pose set", "setPose", pose); });
    this.element.querySelector(".toolbar")!.append(undo);
    setTimeout(() => undo.remove(), 30_000);
  }

  // ---- pointer ----

  private floorAt(view: View, event: PointerEvent): Vector3 | null {
    const box = view.element.getBoundingClientRect();
    const caster = new Raycaster();
    caster.setFromCamera(new Vector2((event.clientX - box.left) / box.width * 2 - 1, 1 - (event.clientY - box.top) / box.height * 2), view.camera as Camera);
    return caster.ray.intersectPlane(new Plane(new Vector3(0, 0, 1), 0), new Vector3());
  }

  private pressed = {x: 0, y: 0};

  private pointerDown(view: View, event: PointerEvent): void {
    this.pressed = {x: event.clientX, y: event.clientY};
    const tool = this.store.tool.value;
    if (event.button !== 0) return;
    if (tool === "measure") {
      this.measureTo(view, event, true);
      return;
    }
    if (tool !== "pose" && tool !== "kidnap") return;
    this.dragFrom = this.floorAt(view, event);
    if (!this.dragFrom) return;
    const present = this.store.moment.value.estimate?.world.theta ?? 0;
    this.setGhost({x: this.dragFrom.x, y: this.dragFrom.y, theta: present});
  }

  private pointerMove(view: View, event: PointerEvent): void {
    if (this.store.tool.value === "measure" && (event.buttons & 1) !== 0) this.measureTo(view, event, false);
    if (!this.dragFrom || !this.ghost) return;
    const to = this.floorAt(view, event);
    if (!to || Math.hypot(event.clientX - this.pressed.x, event.clientY - this.pressed.y) < 8) return;
    this.setGhost({x: this.dragFrom.x, y: this.dragFrom.y, theta: Math.atan2(to.y - this.dragFrom.y, to.x - this.dragFrom.x)});
  }

  private pointerUp(view: View, event: PointerEvent): void {
    this.dragFrom = null;
    if (Math.hypot(event.clientX - this.pressed.x, event.clientY - this.pressed.y) > 5 || event.button !== 0) return;
    const floor = this.floorAt(view, event), tool = this.store.tool.value;
    if (tool === "select") this.choose(view, event);
    else if (tool === "gaze" && floor) void this.store.act(`gaze to ${floor.x.toFixed(2)}, ${floor.y.toFixed(2)} m`, "gazeAtWorld", floor.x, floor.y, 0);
    else if (tool === "occluder" && floor) {
      const name = `occluder_${Math.floor(Math.random() * 1e6)}`;
      void this.store.act(`occluder at ${floor.x.toFixed(2)}, ${floor.y.toFixed(2)} m`, "addOccluder", name, "box", floor.x, floor.y, [0.4, 0.4, 1.2], [0.5, 0.45, 0.4]);
    }
  }

  private choose(view: View, event: PointerEvent): void { this.store.selection.value = this.under(pick, 10, view, event); }

  /** What `search` finds within `reach` pixels of the pointer. */
  private under<T>(search: (px: number, py: number, reach: number, moment: Moment, map: MapState | null, odomInWorld: Pose2, toScreen: ToScreen) => T, reach: number, view: View, event: PointerEvent): T {
    const box = view.element.getBoundingClientRect(), v = new Vector3();
    return search(event.clientX - box.left, event.clientY - box.top, reach, this.store.moment.value, this.store.map.value, this.content.odomInWorld, (x, y, z) => {
      v.set(x, y, z).project(view.camera as Camera);
      return v.z > 1 || v.z < -1 ? null : {x: (v.x + 1) / 2 * box.width, y: (1 - v.y) / 2 * box.height};
    });
  }

  /** To the end of a line next to the pointer, else to the floor under it. */
  private measureTo(view: View, event: PointerEvent, begins: boolean): void {
    const to: Vec2 | null = this.under(endUnder, 8, view, event) ?? this.floorAt(view, event);
    if (!to) return;
    this.measure.show(begins ? to : this.measure.from ?? to, to, this.store.moment.value.estimate?.hasPose ? "map" : "odom");
    this.ask();
  }

  // ---- drawing ----

  private arrange(): void {
    const {clientWidth: width, clientHeight: height} = this.stage;
    if (width === 0 || height === 0) return;
    this.fitCanvas(width, height);
    const both = this.layout === "both", split = both && width > height * 1.1;
    this.views.forEach((view, i) => {
      const shown = both || (this.layout === "top") === view.top, s = view.element.style;
      s.display = shown ? "block" : "none";
      s.left = split && i === 1 ? "50%" : "0";
      s.top = both && !split && i === 1 ? "50%" : "0";
      s.width = split ? "50%" : "100%";
      s.height = both && !split ? "50%" : "100%";
    });
    this.ask();
  }

  /** Also before each drawing: while the dock rearranges, the stage has sizes that nobody hears of. */
  private fitCanvas(width: number, height: number): void {
    if (width === this.sized.width && height === this.sized.height) return;
    this.sized = {width, height};
    this.renderer?.setSize(width, height, false);
  }

  protected override onVisible(): void {
    if (this.visible) this.arrange();
  }

  private ask = (): void => {
    if (this.scheduled || !this.visible) return;
    this.scheduled = true;
    // Software rendering is capped at 15 Hz.
    const wait = this.software ? Math.max(0, this.lastDraw + 62 - performance.now()) : 0;
    setTimeout(() => requestAnimationFrame(() => {
      this.scheduled = false;
      this.lastDraw = performance.now();
      this.draw();
    }), wait);
  };

  private draw(): void {
    if (!this.renderer || !this.visible || this.stage.clientWidth === 0) return;
    const {store} = this;
    const input: SceneInput = {moment: store.moment.value, map: store.map.value, options: this.options, theme: store.theme.value, selection: store.selection.value,
      grid: store.healthGrid.value, ghost: this.ghost, occluders: occludersOf(store.simulation.value), measured: this.measure.from && this.measure.to && [this.measure.from, this.measure.to]};
    this.content.update(input);
    this.placeCameras(input);
    const height = this.stage.clientHeight;
    this.fitCanvas(this.stage.clientWidth, height);
    this.renderer.setScissorTest(false);
    this.renderer.clear();
    this.renderer.setScissorTest(true);
    for (const view of this.views) {
      if (view.element.style.display === "none") continue;
      const {offsetLeft: x, offsetTop: y, offsetWidth: w, offsetHeight: hh} = view.element;
      this.renderer.setViewport(x, height - y - hh, w, hh);
      this.renderer.setScissor(x, height - y - hh, w, hh);
      this.content.drawSymbols(input, this.metresPerPixel(view, w, hh));
      this.renderer.render(this.content.scene, view.camera as Camera);
    }
    this.legend.draw(this.options.colourBy, input.grid, input.moment, input.theme);
    this.canvas.dataset.renders = String(++this.renders);
    this.describe(input);
  }

  private metresPerPixel(view: View, width: number, height: number): number {
    const aspect = width / Math.max(1, height), camera = view.camera;
    if (camera instanceof OrthographicCamera) {
      const half = (camera.top - camera.bottom) / 2;
      camera.left = -half * aspect;
      camera.right = half * aspect;
      camera.updateProjectionMatrix();
      const m = 2 * half / camera.zoom / Math.max(1, height);
      this.drawScale(m);
      return m;
    }
    camera.aspect = aspect;
    camera.updateProjectionMatrix();
    return 0;
  }

  private drawScale(metresPerPixel: number): void {
    const steps = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20], length = steps.find(s => s / metresPerPixel > 50) ?? 50;
    this.scaleBar.style.width = `${length / metresPerPixel}px`;
    say(this.scaleBar, `${length} m`);
  }

  /** Fits map or memory once, and follows the robot where asked. */
  private placeCameras({moment, map}: SceneInput): void {
    const key = map ? `map ${map.id}` : moment.memory ? "memory" : "";
    const [three, top] = this.views as [View, View];
    const robot = moment.estimate?.hasPose ? moment.estimate.world : moment.memory?.robot;
    if (key !== this.fitted && key !== "" && this.stage.clientWidth > 0) {
      this.fitted = key;
      const box = boundsOf(map?.rows ?? null, moment);
      const ortho = top.camera as OrthographicCamera, aspect = top.element.clientWidth / Math.max(1, top.element.clientHeight) || 1;
      const half = Math.max(box.height / 2, box.width / 2 / aspect) * 1.1 + 0.2;
      ortho.top = half;
      ortho.bottom = -half;
      ortho.zoom = 1;
      top.controls.target.set(box.x, box.y, 0);
      ortho.position.set(box.x, box.y, 50);
      const eye = robot ?? {x: box.x, y: box.y, theta: 0}, back = compose(eye, {x: -3.2, y: 0, theta: 0});
      three.controls.target.set(eye.x, eye.y, 0.2);
      three.camera.position.set(back.x, back.y, 3.6);
      three.controls.update();
      top.controls.update();
    }
    if (this.followed !== "none" && robot) {
      for (const view of this.followed === "both" ? [three, top] : [three]) {
        const d = new Vector3(robot.x, robot.y, 0).sub(view.controls.target).setZ(0);
        view.controls.target.add(d);
        view.camera.position.add(d);
        view.controls.update();
      }
    }
  }

  private describe({moment, map}: SceneInput): void {
    const e = moment.estimate, memory = moment.memory;
    say(this.empty, !memory && !map ? this.whyEmpty() : "");
    const stale = memory && moment.t - memory.t > 1000 ? `  memory is ${((moment.t - memory.t) / 1000).toFixed(1)} s old` : "";
    say(this.status, (e?.hasPose ? `x ${fixed(e.world.x, 2)} y ${fixed(e.world.y, 2)} m  ${fixed(degrees(e.world.theta), 0)} deg  ` : "no pose: drawn in the frame of odometry  ") +
      (memory ? `${memory.ids.length} segments, ${memory.primitives.length} primitives` : "no memory yet") + stale);
    this.status.classList.toggle("stale", stale !== "");
  }

  private whyEmpty(): string {
    if (!this.store.config.proxies.VisualMemory) return "Nothing to show: this setup has no visual memory.";
    const link = this.store.links.value.find(l => l.name === "VisualMemory");
    return !link ? "Connecting ..." : link.connected ? "The visual memory has seen no image yet." :
      `Nothing to show: the visual memory does not answer (${link.message}).`;
  }

  private save(): void {
    this.draw();
    this.canvas.toBlob(blob => { if (blob) saveFile("scene.png", blob); });
  }
}

function boundsOf(rows: Float32Array | null, moment: SceneInput["moment"]): {x: number; y: number; width: number; height: number} {
  let x0 = Infinity, y0 = Infinity, x1 = -Infinity, y1 = -Infinity;
  const add = (x: number, y: number) => { x0 = Math.min(x0, x); x1 = Math.max(x1, x); y0 = Math.min(y0, y); y1 = Math.max(y1, y); };
  if (rows && rows.length > 0) {
    for (let i = 0; i < rows.length; i += mapRowSize) { add(rows[i]!, rows[i + 1]!); add(rows[i + 3]!, rows[i + 4]!); }
  } else {
    const robot = moment.memory?.robot ?? {x: 0, y: 0};
    add(robot.x - 4, robot.y - 4);
    add(robot.x + 4, robot.y + 4);
  }
  return {x: (x0 + x1) / 2, y: (y0 + y1) / 2, width: x1 - x0, height: y1 - y0};
}

