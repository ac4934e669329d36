// The streams of the robot: long-polls that keep one call outstanding each, never a queue; what comes goes to the history, the video and the page.
/* eslint-disable @typescript-eslint/no-explicit-any */
import {defaultOverlays, nowMs} from "../shared/messages";
import type {FromWorker, GuiConfig, OverlayOptions} from "../shared/messages";
import {emptyMoment, timeStands} from "../shared/state";
import type {AnalysisState, ComponentInfo, FrameState, Moment, ReplayInfo, SimulationInfo, VideoInfo} from "../shared/state";
import {History} from "../state/history";
import type {StoredImage} from "../state/image_ring";
import {
  analysisOf, estimateOf, gazeOf, LabelTable, logLineOf, mapOf, memoryOf, num, pose2, recorderOf, replayOf, simulationOf, statusOf, truthOf, word,
} from "./convert";
import {Driver} from "./driver";
import {avm, describe, Ice, Link, longOf, minusOne, sleep, smallestLong} from "./link";
import type {Peer} from "./link";
import {LightMeter} from "./light_meter";
import {AgeMeter, RateMeter} from "./meters";
import {Video} from "./video";

/** Least time between two messages with the scene [ms]: 15 a second. */
const momentEveryMs = 62;
/** While a moment of the past is shown: for plots and trajectories, which go on. */
const unseenEveryMs = 200;
/** An image waits so long for the analysis of its own pixels; lines would swim on a turning camera otherwise. */
const analysisWaitMs = 60;

export class Streams {
  readonly history = new History();
  readonly video = new Video();
  readonly live: Moment = {...emptyMoment};
  driver: Driver | null = null;
  overlays: OverlayOptions = defaultOverlays;
  pageVisible = true;
  cameraVisible = true;
  logWatched = false;
  /** Moment of the past that is shown; null: live. */
  past: number | null = null;
  /** Of the image on the canvas, live or past. */
  shownAnalysis: AnalysisState | null = null;
  private generation = 0;
  private pending: Partial<Moment> = {};
  private lastMoment = 0;
  private momentTimer: ReturnType<typeof setTimeout> | null = null;
  private readonly labels = new LabelTable();
  private stampBaseUs: number | null = null;
  private readonly rate = new RateMeter();
  private readonly age = new AgeMeter();
  private readonly light = new LightMeter();
  private lastSeq: number | null = null;
  private waiting: StoredImage | null = null;
  private drawing = false;
  private readonly sourceRate = new RateMeter();
  private simulation: SimulationInfo | null = null;
  private replay: ReplayInfo | null = null;
  private videoInfo: VideoInfo = {fps: 0, sourceFps: 0, ageMs: 0, roundTripMs: 0, stampUs: 0, width: 0, height: 0, brightness: null, state: "Waiting", message: "no image yet", last: 0};
  private readonly components = new Map<string, ComponentInfo>();
  private analysisArrived: (() => void) | null = null;
  private speed = 1;

  constructor(private readonly config: GuiConfig, private readonly link: Link, private readonly publish: (message: FromWorker, transfer?: Transferable[]) => void) {}

  start(): void {
    const proxies = this.config.proxies;
    const starters: Record<string, [any, (peer: Peer) => void]> = {
      Camera: [avm.CameraPrx, peer => this.startCamera(peer)],
      VisualMemory: [avm.VisualMemoryPrx, peer => this.startMemory(peer)],
      Localization: [avm.LocalizationPrx, peer => this.startLocalization(peer)],
      Gaze: [avm.GazePrx, peer => this.startGaze(peer)],
      Odometry: [avm.OdometryPrx, peer => this.startOdometry(peer)],
      Simulation: [avm.SimulationPrx, peer => this.startSimulation(peer)],
      Replay: [avm.ReplayPrx, peer => this.startReplay(peer)],
      Base: [avm.BasePrx, peer => this.startBase(peer)],
      PanTilt: [avm.PanTiltPrx, () => {}],
      Recorder: [avm.RecorderPrx, peer => this.startRecorder(peer)],
    };
    for (const [name, [type, start]] of Object.entries(starters)) {
      const proxy = proxies[name];
      if (proxy) start(this.link.add(name, proxy, type, name === "Camera" ? "images" : undefined));
    }
    for (const component of this.config.components) this.startComponent(component.name, component.proxy);
    setInterval(() => this.everyHalfSecond(), 500);
  }

  // ---- streams ----

  private startCamera(peer: Peer): void {
    let last = minusOne();
    void this.link.loop(peer, async () => {
      if (!(this.pageVisible && this.cameraVisible) && this.driver?.deadMan.isMoving !== true) {
        // Hidden: an image a second keeps the history alive without costing much.
        await sleep(900);
      }
      const begin = performance.now();
      const result = await peer.proxy.getNext("JPEG", last);
      this.videoInfo.state = word(result.state) as VideoInfo["state"];
      this.videoInfo.message = result.message;
      if (this.videoInfo.state !== "Running") {
        // An answer without an image came at once (a log's end): no busy loop.
        if (performance.now() - begin < 300) await sleep(300);
        return;
      }
      last = result.image.seq;
      this.takeImage(result.image);
    });
    // A second loop measures the round trip with a call that asks nothing.
    void this.link.loop(this.link.add("Camera latency", this.config.proxies.Camera!, avm.CameraPrx, "images-ping"), async () => {
      const begin = performance.now();
      await this.link.peers.get("Camera latency")!.proxy.ice_ping();
      this.age.addRoundTrip(performance.now() - begin);
      await sleep(2000);
    });
  }

  private takeImage(image: any): void {
    const t = nowMs(), seq = num(image.seq), stampUs = num(image.stampUs);
    if (this.lastSeq !== null && seq > this.lastSeq) for (let i = this.lastSeq; i < seq && i < this.lastSeq + 60; ++i) this.sourceRate.count(t);
    this.lastSeq = seq;
    // The answer's bytes are a view of Ice's buffer: keep a copy of their own.
    const jpeg = new Uint8Array(image.pixels);
    const stored = this.history.addImage({t, stampUs, seq, width: image.width, height: image.height, jpeg});
    if (this.driver) this.driver.lastFrame = t;
    this.age.add(t, stampUs, this.speed);
    Object.assign(this.videoInfo, {last: t, stampUs, width: image.width, height: image.height, ageMs: this.age.ageMs, roundTripMs: this.age.roundTripMs});
    this.live.frame = frameOf(stored);
    this.announce({frame: this.live.frame});
    if (this.past !== null || !this.pageVisible || !this.cameraVisible) return;
    this.waiting = stored;
    if (!this.drawing) void this.drawWaiting();
  }

  /** One image is decoded at a time; of those that come meanwhile the newest is next. */
  private async drawWaiting(): Promise<void> {
    this.drawing = true;
    try {
      for (let image = this.waiting; image; image = this.waiting) {
        this.waiting = null;
        await this.drawLive(image);
      }
    } catch (failure) {
      this.videoInfo.message = `an image cannot be decoded: ${describe(failure)}`;
    } finally {
      this.drawing = false;
    }
  }

  private async drawLive(image: StoredImage): Promise<void> {
    const generation = this.generation;
    const decoded = createImageBitmap(new Blob([image.jpeg as Uint8Array<ArrayBuffer>], {type: "image/jpeg"}));
    const [bitmap] = await Promise.all([decoded, this.waitForAnalysis(image.seq)]);
    if (generation !== this.generation) return bitmap.close();
    const analysis = image.analysis ?? this.live.analysis;
    const now = nowMs(), first = this.rate.hz(now) === 0;
    this.shownAnalysis = analysis;
    this.light.look(bitmap, now);
    this.video.show({bitmap, width: image.width, height: image.height, analysis, estimate: this.live.estimate, gaze: this.live.gaze, note: ""});
    this.rate.count(now);
    if (first) this.publishVideo(now);
  }

  /** Until the analysis of this image came, or 60 ms. */
  private async waitForAnalysis(seq: number): Promise<void> {
    const isThere = () => (this.live.analysis?.frameSeq ?? -1) >= seq;
    if (this.overlays.raw || !this.link.peers.get("VisualMemory")?.info.connected) return;
    const deadline = performance.now() + analysisWaitMs;
    while (!isThere() && performance.now() < deadline) {
      await Promise.race([sleep(deadline - performance.now()), new Promise<void>(resolve => { this.analysisArrived = resolve; })]);
    }
  }

  private startMemory(peer: Peer): void {
    let revision = longOf(0);
    void this.link.loop(peer, async () => {
      if (!this.pageVisible) await sleep(800);
      const result = await peer.proxy.next(revision);
      if (word(result.state) !== "Running") return sleep(200);
      const t = nowMs(), {snapshot, analysis} = result.update;
      revision = snapshot.revision;
      this.stampBaseUs ??= num(snapshot.stampUs);
      this.live.analysis = analysisOf(analysis, t, this.labels);
      this.live.memory = memoryOf(snapshot, t, this.labels, this.stampBaseUs);
      this.history.addAnalysis(this.live.analysis);
      this.history.addMemory(this.live.memory);
      this.analysisArrived?.();
      this.announce({memory: this.live.memory, analysis: this.live.analysis});
    });
  }

  private startLocalization(peer: Peer): void {
    let revision = longOf(0), mapKnown = "";
    void this.link.loop(peer, async () => {
      if (mapKnown !== "yes") mapKnown = await this.readMap(peer);
      if (!this.pageVisible) await sleep(800);
      const result = await peer.proxy.next(revision);
      if (word(result.state) !== "Running") return sleep(200);
      revision = result.estimate.revision;
      this.live.estimate = estimateOf(result.estimate, nowMs());
      this.history.addEstimate(this.live.estimate);
      this.announce({estimate: this.live.estimate});
    });
    // A restarted server may have another map.
    setInterval(() => { if (!peer.info.connected) mapKnown = ""; }, 500);
  }

  private async readMap(peer: Peer): Promise<string> {
    try {
      const map = mapOf(await peer.proxy.getMap());
      this.video.map = map;
      this.publish({kind: "map", map});
    } catch (failure) {
      if (!(failure instanceof Ice.OperationNotExistException)) throw failure;
    }
    return "yes";
  }

  private startGaze(peer: Peer): void {
    let after = smallestLong(), hasNext = true;
    void this.link.loop(peer, async () => {
      if (!this.pageVisible) await sleep(800);
      const begin = performance.now();
      let status: any;
      if (hasNext) {
        try {
          const result = await peer.proxy.next(after);
          if (word(result.state) !== "Running") return sleep(200);
          status = result.status;
        } catch (failure) {
          if (!(failure instanceof Ice.OperationNotExistException)) throw failure;
          hasNext = false;
          return;
        }
      } else {
        status = await peer.proxy.status();
      }
      after = status.stampUs;
      this.live.gaze = gazeOf(status, nowMs());
      this.history.addGaze(this.live.gaze);
      this.announce({gaze: this.live.gaze});
      await sleep(Math.max(0, 95 - (performance.now() - begin)));
    });
  }

  private startOdometry(peer: Peer): void {
    let after = smallestLong();
    void this.link.loop(peer, async () => {
      const result = await peer.proxy.samplesSince(after);
      const sample = result.samples.at(-1);
      if (sample) {
        after = sample.stampUs;
        this.live.odometry = {t: nowMs(), stampUs: num(sample.stampUs), pose: pose2(sample.robotInOdom), v: sample.vMps, w: sample.wRadps};
        this.history.addOdometry(this.live.odometry);
        this.announce({odometry: this.live.odometry});
      }
      await sleep(this.pageVisible ? 95 : 1000);
    });
  }

  private startSimulation(peer: Peer): void {
    let after = smallestLong(), nextModels = 0, models: any[] = [];
    void this.link.loop(peer, async () => {
      const result = await peer.proxy.truthSince(after);
      const sample = result.samples.at(-1);
      if (sample) after = sample.stampUs;
      if (sample && this.config.truth) {
        this.live.truth = truthOf(sample, nowMs());
        this.history.addTruth(this.live.truth);
        this.announce({truth: this.live.truth});
      }
      await sleep(this.pageVisible ? 62 : 1000);
    });
    const status = this.link.add("Simulation status", this.config.proxies.Simulation!, avm.SimulationPrx);
    void this.link.loop(status, async () => {
      if (performance.now() >= nextModels) {
        models = await status.proxy.models();
        nextModels = performance.now() + 2000;
      }
      this.simulation = simulationOf(await status.proxy.status(), models);
      const {paused, speed, realSpeed, lockStep} = this.simulation;
      this.setSpeed(paused ? 0 : lockStep === 0 && Math.abs(realSpeed / speed - 1) < 0.05 ? speed : realSpeed);
      this.publish({kind: "simulation", simulation: this.simulation});
      await sleep(500);
    });
  }

  /** @param speed source seconds per second; 0: its time stands. */
  private setSpeed(speed: number): void {
    if (speed <= 0 || Math.abs(speed / this.speed - 1) > 0.2) this.age.restart();
    if (speed > 0) this.speed = speed;
  }

  private startReplay(peer: Peer): void {
    void this.link.loop(peer, async () => {
      this.replay = replayOf(await peer.proxy.info());
      this.setSpeed(this.replay.state === "PLAYING" ? this.replay.rate : 0);
      this.publish({kind: "replay", replay: this.replay});
      await sleep(200);
    });
  }

  private startRecorder(peer: Peer): void {
    void this.link.loop(peer, async () => {
      this.publish({kind: "recorder", recorder: recorderOf(await peer.proxy.status())});
      await sleep(1000);
    });
  }

  private startBase(peer: Peer): void {
    if (this.config.viewer) return;
    const client = `page ${Math.floor(Math.random() * 9000 + 1000)}`;
    this.driver = new Driver(peer, client, this.publish);
    this.driver.hasCamera = this.config.proxies.Camera !== undefined;
    void this.link.loop(peer, async () => {
      await this.driver!.look();
      await peer.proxy.ice_ping();
      await sleep(700);
    });
  }

  private startComponent(name: string, proxyText: string): void {
    const info: ComponentInfo = {
      name, alive: false, message: "not asked yet", since: nowMs(), state: "", reason: "", version: "", uptimeS: 0, peers: [], rates: [], latencies: [],
      gauges: [], errors: [],
    };
    this.components.set(name, info);
    const peer = this.link.add(`component ${name}`, proxyText, avm.ComponentPrx);
    const proxy = () => peer.proxy.ice_invocationTimeout(900);
    let afterLog = longOf(0), hasLog = true;
    void this.link.loop(peer, async () => {
      try {
        const status = statusOf(await proxy().getStatus());
        if (!info.alive) info.since = nowMs();
        Object.assign(info, status, {alive: true, message: ""});
      } catch (failure) {
        if (info.alive) {
          info.since = nowMs();
          this.history.mark({t: info.since, kind: "lost", text: `${name} is gone`});
        }
        Object.assign(info, {alive: false, message: describe(failure)});
        throw failure;
      }
      if (this.logWatched && hasLog) {
        try {
          const batch = await proxy().getLog(afterLog, avm.LogLevel.Debug, 200);
          afterLog = batch.lastSequence;
          if (batch.entries.length > 0) this.publish({kind: "log", lines: batch.entries.map((e: any) => logLineOf(name, e)), lost: num(batch.lost)});
        } catch (failure) {
          if (!(failure instanceof Ice.OperationNotExistException)) throw failure;
          hasLog = false;
        }
      }
      await sleep(600);
    });
  }

  // ---- to the page ----

  private everyHalfSecond(): void {
    const now = nowMs();
    const stands = timeStands(name => this.link.peers.get(name)?.info.connected === true, this.simulation, this.replay);
    if (this.past === null && this.videoInfo.last > 0 && now - this.videoInfo.last > 1500 && this.cameraVisible)
      this.video.note(stands ? "" : `no image for ${((now - this.videoInfo.last) / 1000).toFixed(0)} s`);
    this.publishVideo(now);
    this.publish({kind: "components", components: [...this.components.values()]});
    const timeline = this.history.timeline(now);
    this.publish({kind: "timeline", timeline});
    if (this.past !== null && timeline.from > this.past) this.show(timeline.from, this.generation);
  }

  private publishVideo(now: number): void {
    Object.assign(this.videoInfo, {fps: this.rate.hz(now), sourceFps: this.sourceRate.hz(now), brightness: this.light.brightness});
    this.publish({kind: "video", video: {...this.videoInfo}, place: this.video.place});
  }

  private announce(part: Partial<Moment>): void {
    Object.assign(this.pending, part);
    if (this.momentTimer !== null) return;
    const wait = Math.max(0, this.lastMoment + (this.past === null ? momentEveryMs : unseenEveryMs) - performance.now());
    this.momentTimer = setTimeout(() => {
      this.momentTimer = null;
      this.lastMoment = performance.now();
      this.publish({kind: "moment", moment: {...this.pending, t: nowMs(), live: true}, generation: this.generation});
      this.pending = {};
    }, wait);
  }

  /** Shows a moment of the past; null: live again. The history goes on growing meanwhile. */
  scrub(t: number | null, generation: number): void {
    this.generation = generation;
    if (t === null) {
      this.past = null;
      this.publish({kind: "moment", moment: {...this.live, t: nowMs(), live: true}, generation});
      return;
    }
    this.show(t, generation);
  }

  private show(t: number, generation: number): void {
    this.past = t;
    const {moment, image} = this.history.momentAt(t);
    this.shownAnalysis = moment.analysis;
    this.publish({kind: "moment", moment, generation});
    if (image) void this.showImage(image, moment, generation);
  }

  private async showImage(image: StoredImage, moment: Moment, generation: number): Promise<void> {
    const bitmap = await createImageBitmap(new Blob([image.jpeg as Uint8Array<ArrayBuffer>], {type: "image/jpeg"}));
    // The newest request wins: an answer to an older one is thrown away.
    if (generation !== this.generation) return bitmap.close();
    const old = moment.t - image.t;
    this.video.show({bitmap, width: image.width, height: image.height, analysis: moment.analysis, estimate: moment.estimate, gaze: moment.gaze,
      note: old > 1000 ? `the last image is ${(old / 1000).toFixed(1)} s older than this moment` : ""});
  }
}

function frameOf(image: StoredImage): FrameState {
  const {t, stampUs, seq, width, height, hash} = image;
  return {t, stampUs, seq, width, height, hash, bytes: image.jpeg.byteLength};
}
