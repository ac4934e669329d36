// What the page may ask of the robot, by name. Each resolves to a plain value or rejects with words for people.
/* eslint-disable @typescript-eslint/no-explicit-any */
import {CameraView, compose, inverse} from "../shared/geometry";
import type {Pose2} from "../shared/geometry";
import type {CommandReply} from "../shared/messages";
import {gridOf, parameterOf} from "./convert";
import {avm, longOf} from "./link";
import type {Link, Peer} from "./link";
import type {Streams} from "./streams";

export type Command = (...values: any[]) => Promise<unknown>;

const replyOf = (reply: any): CommandReply => ({adjusted: reply.adjusted, message: reply.message});
const pose = (p: Pose2) => new avm.Pose2(p.x, p.y, p.theta);

export function makeCommands(link: Link, streams: Streams): Record<string, Command> {
  const peer = (name: string): Peer => {
    const found = link.peers.get(name);
    if (!found) throw new Error(`this robot has no ${name}`);
    return found;
  };
  const proxy = (name: string) => peer(name).proxy;
  const call = (name: string, operation: string): Command => async (...values) => replyOf(await proxy(name)[operation](...values));
  const modes: Record<string, any> = {Attend: avm.GazeMode.Attend, Fixate: avm.GazeMode.Fixate, Hold: avm.GazeMode.Hold, Off: avm.GazeMode.Off};
  const shapes: Record<string, any> = {box: avm.PropKind.PropBox, cylinder: avm.PropKind.PropCylinder, robot: avm.PropKind.PropRobot};

  return {
    ...gazeCommands(streams, proxy, modes),
    ...localizationCommands(proxy),
    resetMemory: call("VisualMemory", "reset"),
    stop: async () => streams.driver ? streams.driver.stop() : Promise.reject(new Error("this robot has no base")),

    kidnap: async (p: Pose2) => replyOf(await proxy("Simulation").kidnap(pose(p))),
    pauseSimulation: call("Simulation", "setPaused"),
    step: call("Simulation", "step"),
    speed: call("Simulation", "setSpeed"),
    resetSimulation: async (seed: number) => replyOf(await proxy("Simulation").reset(longOf(seed))),
    addOccluder: async (name: string, kind: string, x: number, y: number, size: number[], colour: number[]) => replyOf(await proxy("Simulation").addModel(
      name, new avm.PropShape(shapes[kind], new avm.Vector3(...size), new avm.Vector3(...colour)),
      new avm.Pose3(new avm.Vector3(x, y, 0), 1, 0, 0, 0))),
    removeModel: call("Simulation", "removeModel"),

    startRecording: async () => ({adjusted: false, message: await proxy("Recorder").start("")}),
    stopRecording: async () => ({adjusted: false, message: await proxy("Recorder").stop()}),
    markRecording: async (text: string) => { await proxy("Recorder").mark(text); return {adjusted: false, message: ""}; },
    saveRing: async () => ({adjusted: false, message: await proxy("Recorder").saveRing("")}),

    pauseReplay: call("Replay", "setPaused"),
    stepReplay: call("Replay", "step"),
    seek: async (stampUs: number) => replyOf(await proxy("Replay").seek(longOf(stampUs))),
    rateReplay: call("Replay", "setRate"),
    loopReplay: call("Replay", "setLoop"),

    ...componentCommands(link),
    historyOf: async (id: number) => streams.history.snapshots.historyOf(id),
  };
}

function gazeCommands(streams: Streams, proxy: (name: string) => any, modes: Record<string, any>): Record<string, Command> {
  return {
    /** A pixel of the image that is shown and so many pixels wide, also one of the past. */
    gazeAtPixel: async (u: number, v: number, width: number) => {
      const a = streams.shownAnalysis;
      if (!a) throw new Error("no analysis of an image yet: the pixel's direction is not known");
      const block = width / a.lens.width;
      const p = new CameraView(a.robot, a.camera, a.lens).pointAt((u + 0.5) / block - 0.5, (v + 0.5) / block - 0.5);
      return {...replyOf(await proxy("Gaze").fixate(new avm.Vector3(p.x, p.y, p.z))), place: p};
    },
    /** A point of the world. */
    gazeAtWorld: async (x: number, y: number, z: number) => {
      const e = streams.live.estimate, T = e?.hasPose ? compose(e.odom, inverse(e.world)) : {x: 0, y: 0, theta: 0};
      const p = compose(T, {x, y, theta: 0});
      return {...replyOf(await proxy("Gaze").fixate(new avm.Vector3(p.x, p.y, z))), place: {x: p.x, y: p.y, z}};
    },
    gazeMode: async (mode: string) => replyOf(await proxy("Gaze").setMode(modes[mode])),
  };
}

function localizationCommands(proxy: (name: string) => any): Record<string, Command> {
  return {
    setPose: async (p: Pose2) => replyOf(await proxy("Localization").setPose(pose(p))),
    relocalize: async () => replyOf(await proxy("Localization").relocalize()),
    healthMap: async (rating: string, theta: number | null, headings: number, cellM: number, area: number[] | null) => {
      const request = new avm.HealthMapRequest(avm.PlaceRating[rating], theta !== null, theta ?? 0, theta === null ? headings : 1, cellM, area !== null,
        new avm.Vector2(area?.[0] ?? 0, area?.[1] ?? 0), new avm.Vector2(area?.[2] ?? 0, area?.[3] ?? 0));
      return gridOf(await proxy("Localization").ice_invocationTimeout(60000).healthMap(request));
    },
  };
}

function componentCommands(link: Link): Record<string, Command> {
  const proxy = (component: string) => {
    const peer = link.peers.get(`component ${component}`);
    if (!peer) throw new Error(`no component ${component}`);
    return peer.proxy;
  };
  return {
    configuration: async (component: string) => (await proxy(component).getConfiguration()).map((s: any) => [s.key, s.value]),
    parameters: async (component: string) => (await proxy(component).parameters()).map((p: any) => parameterOf(component, p)),
    setParameter: async (component: string, name: string, value: number) => replyOf(await proxy(component).setParameter(name, value)),
  };
}
