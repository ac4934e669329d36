// The page's only place that speaks Ice: everything between the robot and the page goes through this worker.
import type {FromWorker, SessionInfo, ToWorker} from "../shared/messages";
import {makeCommands} from "./commands";
import type {Command} from "./commands";
import {nowMs} from "../shared/messages";
import {describe, isDenied, Link, sleep} from "./link";
import type {Login} from "./link";
import {Streams} from "./streams";

const publish = (message: FromWorker, transfer: Transferable[] = []) => self.postMessage(message, {transfer});

let link: Link | null = null;
let streams: Streams | null = null;
let commands: Record<string, Command> = {};
let early: ToWorker[] = [];

async function run(id: number, name: string, values: unknown[]): Promise<void> {
  try {
    const command = commands[name];
    if (!command) throw new Error(`no command ${name}`);
    publish({kind: "reply", id, ok: true, value: await command(...values), error: ""});
  } catch (failure) {
    publish({kind: "reply", id, ok: false, value: null, error: describe(failure)});
  }
}

const announce = (state: SessionInfo["state"], message = "") => publish({kind: "session", session: {state, message}});

let begun = false;
function begin(): void {
  if (begun) return;
  begun = true;
  streams!.start();
}

/** Opens a session, and again whenever it is lost, until the gateway refuses the password. */
async function enter(l: Link, login: Login): Promise<void> {
  for (;;) {
    announce("trying");
    try {
      let end = () => {};
      const ended = new Promise<void>(resolve => { end = resolve; });
      await l.logIn(login, () => end());
      announce("open");
      begin();
      await ended;
      if (!l.running) return;
      announce("away", "the session was lost");
    } catch (failure) {
      if (isDenied(failure)) return announce("needed", describe(failure));
      announce("away", describe(failure));
    }
    await sleep(500);
  }
}

function take(message: ToWorker, s: Streams): void {
  switch (message.kind) {
    case "canvas": s.video.setCanvas(message.canvas); break;
    case "canvasSize": s.video.resize(message.width, message.height, message.ratio); break;
    case "overlays":
      s.overlays = message.options;
      s.video.overlays = message.options;
      s.video.redraw();
      break;
    case "visible":
      s.pageVisible = message.page;
      s.cameraVisible = message.camera;
      break;
    case "command": void run(message.id, message.name, message.values); break;
    case "drive": s.driver?.deadMan.report({held: message.held, v: message.v, w: message.w, at: message.sentMs}, nowMs()); break;
    case "scrub":
      if (message.t !== null) s.driver?.deadMan.bar("a moment of the past is shown");
      s.scrub(message.t, message.generation);
      break;
    case "mark": s.history.mark({t: nowMs(), kind: "user", text: message.text}); break;
    case "watchLog": s.logWatched = message.on; break;
    case "logIn": void enter(link!, {user: message.user, password: message.password}); break;
    case "stop": void link?.close(); break;
    case "start": break;
  }
}

self.onmessage = ({data}: MessageEvent<ToWorker>) => {
  if (data.kind === "start") {
    link = new Link(links => publish({kind: "links", links}), data.config.gateway);
    streams = new Streams(data.config, link, publish);
    commands = makeCommands(link, streams);
    for (const message of early) take(message, streams);
    early = [];
    if (data.config.gateway) announce("needed");
    else begin();
  } else if (streams) {
    take(data, streams);
  } else {
    early.push(data);
  }
};
