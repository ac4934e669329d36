// A simulated or replayed robot with the page's server, as processes at free ports, and a client of its own.
import {spawn} from "node:child_process";
import {mkdirSync, mkdtempSync, rmSync} from "node:fs";
import {createRequire} from "node:module";
import {createServer} from "node:net";
import {tmpdir} from "node:os";
import {dirname, join, resolve} from "node:path";
import {fileURLToPath} from "node:url";

export const root = resolve(dirname(fileURLToPath(import.meta.url)), "../../..");
export const gui = join(root, "components/gui");
export const bin = process.env.AVM_BIN ?? join(root, "build/release/bin");
export const pages = process.env.AVM_PAGES ?? join(bin, "../gui");

const require = createRequire(import.meta.url);
const generated = mkdtempSync(join(tmpdir(), "avm-gui-slice-"));
process.on("exit", () => rmSync(generated, {recursive: true, force: true}));
export const {Ice, avm} = require("./ice.cjs").load(gui, join(root, "interfaces"), generated, process.env.AVM_SLICE2JS);

export const sleep = ms => new Promise(done => setTimeout(done, ms));

export async function eventually(what, check, timeoutMs = 10_000, everyMs = 50) {
  const end = Date.now() + timeoutMs;
  for (let last; ;) {
    try {
      const value = await check();
      if (value) return value;
      last = value;
    } catch (failure) {
      last = failure;
    }
    if (Date.now() > end) throw new Error(`not within ${timeoutMs} ms: ${what} (last: ${last})`);
    await sleep(everyMs);
  }
}

/** Free ports, all different. */
async function freePorts(count) {
  const servers = await Promise.all(Array.from({length: count}, () => new Promise((done, fail) => {
    const server = createServer().once("error", fail).listen(0, "127.0.0.1", () => done(server));
  })));
  const ports = servers.map(s => s.address().port);
  await Promise.all(servers.map(s => new Promise(done => s.close(done))));
  return ports;
}

export class Robot {
  processes = new Map();
  token = "test0123456789abcdef0123456789";
  viewToken = "view0123456789abcdef0123456789";

  /** @param options.setup "sim" or "replay"; options.arguments: more arguments by component; options.without: components left out;
   *  options.viewer: a page that only watches. */
  static async start(options = {}) {
    const robot = new Robot();
    robot.setup = options.setup ?? "sim";
    robot.options = options;
    const source = robot.setup === "replay" ? "replay_server" : "simulator";
    const names = [source, "active_visual_memory", "localization", "gui_server"].filter(n => !(options.without ?? []).includes(n));
    const ports = await freePorts(9);
    robot.ports = {tcp: {source: ports[0], memory: ports[1], localization: ports[2], gui: ports[3]}, ws: {source: ports[4], memory: ports[5], localization: ports[6]}, http: ports[7], second: ports[8]};
    robot.commands = robot.makeCommands(source);
    for (const name of names) await robot.launch(name);
    robot.url = `http://127.0.0.1:${robot.ports.http}/`;
    robot.communicator = Ice.initialize(["--Ice.MessageSizeMax=16384", "--Ice.Default.InvocationTimeout=3000"]);
    return robot;
  }

  makeCommands(source) {
    const {tcp, ws, http} = this.ports, at = port => `tcp -h 127.0.0.1 -p ${port}`, web = port => `ws -h 127.0.0.1 -p ${port}`;
    const prefix = source === "simulator" ? "Simulator" : "ReplayServer", extra = name => this.options.arguments?.[name] ?? [];
    const secret = [`--Robot.Token=${this.token}`, `--Robot.ViewToken=${this.viewToken}`];
    const page = {Camera: ["cameraA", ws.source], Base: ["Motors", ws.source], Odometry: ["Encoders", ws.source], PanTilt: ["PanTilt", ws.source], VisualMemory: ["VisualMemory", ws.memory],
      Gaze: ["Gaze", ws.memory], Localization: ["Localization", ws.localization], Simulation: ["Simulation", ws.source], Replay: ["Replay", ws.source]};
    if (source === "simulator") delete page.Replay;
    else { delete page.Simulation; delete page.Base; }
    const cfg = name => `--Ice.Config=cfg/${this.setup}/${name}.cfg`;
    return {
      [source]: [cfg(source), `--${prefix}.Endpoints=${at(tcp.source)}`, `--${prefix}.WebEndpoints=${web(ws.source)}`, ...secret, ...extra(source)],
      active_visual_memory: [cfg("active_visual_memory"), `--ActiveVisualMemory.Endpoints=${at(tcp.memory)}`, `--ActiveVisualMemory.WebEndpoints=${web(ws.memory)}`,
        `--ActiveVisualMemory.Camera.Proxy=cameraA:${at(tcp.source)}`, `--ActiveVisualMemory.PanTilt.Proxy=PanTilt:${at(tcp.source)}`, `--ActiveVisualMemory.Odometry.Proxy=Encoders:${at(tcp.source)}`, ...secret, ...extra("active_visual_memory")],
      localization: [cfg("localization"), `--Localization.Endpoints=${at(tcp.localization)}`, `--Localization.WebEndpoints=${web(ws.localization)}`,
        `--Localization.VisualMemory.Proxy=VisualMemory:${at(tcp.memory)}`, `--Localization.Gaze.Proxy=Gaze:${at(tcp.memory)}`, ...secret, ...extra("localization")],
      gui_server: [cfg("gui_server"), `--GuiServer.Endpoints=${at(tcp.gui)}`, `--GuiServer.Http.Endpoints=http -h 127.0.0.1 -p ${http}`, `--GuiServer.Pages=${pages}`,
        ...Object.entries(page).map(([name, [identity, port]]) => `--GuiServer.${name}.Proxy=${identity}:${web(port)}`),
        `--GuiServer.Components.${source}.Proxy=${source}/component:${web(ws.source)}`, `--GuiServer.Components.active_visual_memory.Proxy=active_visual_memory/component:${web(ws.memory)}`,
        `--GuiServer.Components.localization.Proxy=localization/component:${web(ws.localization)}`, ...(this.options.viewer ? ["--GuiServer.ReadOnly=yes"] : []), ...secret, ...extra("gui_server")],
    };
  }

  async launch(name, more = []) {
    const child = spawn(join(bin, name), [...this.commands[name], ...more], {cwd: root, stdio: ["ignore", "pipe", "pipe"]});
    const state = {child, out: "", error: "", code: null};
    this.processes.set(name, state);
    child.stdout.on("data", data => { state.out += data; });
    child.stderr.on("data", data => { state.error = (state.error + data).slice(-20_000); });
    child.on("exit", (code, signal) => { state.code = code ?? signal; });
    await eventually(`${name} ready`, () => state.code !== null || state.out.includes(`${name} ready`), 30_000);
    if (state.code !== null) throw new Error(`${name} ended with ${state.code}: ${state.error}`);
  }

  kill(name, signal = "SIGKILL") { this.processes.get(name).child.kill(signal); }

  async ended(name) { await eventually(`${name} ends`, () => this.processes.get(name).code !== null); }

  proxy(type, identity, which) {
    return avm[`${type}Prx`].uncheckedCast(this.communicator.stringToProxy(`${identity}:tcp -h 127.0.0.1 -p ${this.ports.tcp[which]}`));
  }
  get simulation() { return this.proxy("Simulation", "Simulation", "source"); }
  get localization() { return this.proxy("Localization", "Localization", "localization"); }
  get base() { return this.proxy("Base", "Motors", "source"); }
  get panTilt() { return this.proxy("PanTilt", "PanTilt", "source"); }
  get memory() { return this.proxy("VisualMemory", "VisualMemory", "memory"); }
  get replay() { return this.proxy("Replay", "Replay", "source"); }
  get camera() { return this.proxy("Camera", "cameraA", "source"); }

  /** The newest true pose. */
  async truth() {
    const batch = await this.simulation.truthSince(new Ice.Long(0x80000000, 0));
    return batch.samples.at(-1);
  }

  /** The true speed over the last 50 ms of simulated time [m/s]. */
  async speed() {
    const {samples} = await this.simulation.truthSince(new Ice.Long(0x80000000, 0));
    const a = samples.at(-6), b = samples.at(-1);
    return Math.hypot(b.robotInWorld.x - a.robotInWorld.x, b.robotInWorld.y - a.robotInWorld.y) / ((b.stampUs.toNumber() - a.stampUs.toNumber()) / 1e6);
  }

  async panTiltNow() {
    const {samples} = await this.panTilt.samplesSince(new Ice.Long(0x80000000, 0));
    return samples.at(-1);
  }

  async stop() {
    for (const {child, code} of this.processes.values()) if (code === null) child.kill("SIGTERM");
    await eventually("all end", () => [...this.processes.values()].every(p => p.code !== null), 8000).catch(() => {
      for (const {child} of this.processes.values()) child.kill("SIGKILL");
    });
    await this.communicator.destroy();
  }
}

/** Seconds of processor time of a process. */
export function cpuSeconds(pid, readFileSync) {
  const fields = readFileSync(`/proc/${pid}/stat`, "utf8").replace(/^.*\) /, "").split(" ");
  return (Number(fields[11]) + Number(fields[12])) / 100;
}

export function ensureFolder(path) { mkdirSync(path, {recursive: true}); return path; }
