// A simulated or replayed robot with the page's server, as processes at free ports, and a client of its own.
import {spawn} from "node:child_process";
import {existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync} from "node:fs";
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

/** Of the setups' recorder.cfg; scripts/start names it to the page's server. */
const recorderWebPort = 11008;

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
export async function freePorts(count) {
  const servers = await Promise.all(Array.from({length: count}, () => new Promise((done, fail) => {
    const server = createServer().once("error", fail).listen(0, "127.0.0.1", () => done(server));
  })));
  const ports = servers.map(s => s.address().port);
  await Promise.all(servers.map(s => new Promise(done => s.close(done))));
  return ports;
}

/** Every process that was started: none outlives a test that fails. */
const children = new Set();
process.on("exit", () => { for (const child of children) child.kill("SIGKILL"); });

/** In the order of their start. */
const programs = ["simulator", "replay_server", "camera_server", "pantilt_server", "base_server", "active_visual_memory", "localization", "recorder", "gui_server"];
const portPattern = /-p +(\d+)/g;

export class Robot {
  processes = new Map();
  commands = {};
  token = "test0123456789abcdef0123456789";
  viewToken = "view0123456789abcdef0123456789";

  /** A setup of cfg/ at free ports.
   *  @param options.setup its name, "sim" unless said; options.arguments: more arguments by component; options.without: components left out;
   *  options.recorder: with the recorder, as scripts/start --record; options.viewer: a page that only watches. */
  static async start(options = {}) {
    const robot = new Robot();
    robot.options = options;
    robot.setup = options.setup ?? "sim";
    const names = programs.filter(n => existsSync(join(root, robot.configurationOf(n))) && (n !== "recorder" || options.recorder) && !(options.without ?? []).includes(n));
    await robot.takePorts(names);
    for (const name of names) robot.commands[name] = robot.commandOf(name);
    for (const name of names) await robot.launch(name);
    robot.url = `http://127.0.0.1:${robot.port(8770)}/`;
    robot.communicator = Ice.initialize(["--Ice.MessageSizeMax=16384", "--Ice.Default.InvocationTimeout=3000"]);
    return robot;
  }

  configurationOf(name) { return `cfg/${this.setup}/${name}.cfg`; }

  /** A free port for every one that the setup names. */
  async takePorts(names) {
    const asked = new Set(names.flatMap(name => [...readFileSync(join(root, this.configurationOf(name)), "utf8").matchAll(portPattern)].map(m => Number(m[1]))));
    asked.add(recorderWebPort);
    const free = await freePorts(asked.size);
    this.ports = new Map([...asked].map((port, i) => [port, free[i]]));
  }

  /** Where this robot serves what the setup has at a port. */
  port(ofSetup) { return this.ports.get(ofSetup); }

  commandOf(name) {
    const moved = text => text.replace(portPattern, (_, port) => `-p ${this.port(Number(port))}`);
    const lines = readFileSync(join(root, this.configurationOf(name)), "utf8").matchAll(/^\s*([\w.]+(?:Proxy|Endpoints))\s*=\s*([^#\n]*)/gm);
    const command = [`--Ice.Config=${this.configurationOf(name)}`, ...[...lines].map(([, key, value]) => `--${key}=${moved(value.trim())}`), `--Robot.Token=${this.token}`, `--Robot.ViewToken=${this.viewToken}`];
    if (name === "gui_server") {
      command.push(`--GuiServer.Pages=${pages}`);
      if (this.options.viewer) command.push("--GuiServer.ReadOnly=yes");
      if (this.options.recorder) command.push(...["Recorder.Proxy=Recorder", "Components.recorder.Proxy=recorder/component"].map(proxy => moved(`--GuiServer.${proxy}:ws -h 127.0.0.1 -p ${recorderWebPort}`)));
    }
    return [...command, ...(this.options.arguments?.[name] ?? [])];
  }

  async launch(name, more = []) {
    const child = spawn(join(bin, name), [...this.commands[name], ...more], {cwd: root, stdio: ["ignore", "pipe", "pipe"]});
    const state = {child, out: "", error: "", code: null};
    this.processes.set(name, state);
    children.add(child);
    child.stdout.on("data", data => { state.out += data; });
    child.stderr.on("data", data => { state.error = (state.error + data).slice(-20_000); });
    child.on("exit", (code, signal) => {
      state.code = code ?? signal;
      children.delete(child);
    });
    await eventually(`${name} ready`, () => state.code !== null || state.out.includes(`${name} ready`), 30_000);
    if (state.code !== null) throw new Error(`${name} ended with ${state.code}: ${state.error}`);
  }

  kill(name, signal = "SIGKILL") { this.processes.get(name).child.kill(signal); }

  async ended(name) { await eventually(`${name} ends`, () => this.processes.get(name).code !== null); }

  /** @param port the one of the setup's configuration. */
  proxy(type, identity, port) {
    return avm[`${type}Prx`].uncheckedCast(this.communicator.stringToProxy(`${identity}:tcp -h 127.0.0.1 -p ${this.port(port)}`));
  }
  get simulation() { return this.proxy("Simulation", "Simulation", 9972); }
  get localization() { return this.proxy("Localization", "Localization", 9971); }
  get base() { return this.proxy("Base", "Motors", 9990); }
  get panTilt() { return this.proxy("PanTilt", "PanTilt", 9977); }
  get memory() { return this.proxy("VisualMemory", "VisualMemory", 9970); }
  get gaze() { return this.proxy("Gaze", "Gaze", 9970); }
  get replay() { return this.proxy("Replay", "Replay", 9973); }
  get camera() { return this.proxy("Camera", "cameraA", 9999); }
  get recorder() { return this.proxy("Recorder", "Recorder", 9992); }

  /** The newest true pose. */
  async truth() {
    const batch = await this.simulation.truthSince(new Ice.Long(0x80000000, 0));
    return batch.samples.at(-1);
  }

  /** The true speed between the last two samples [m/s]. */
  async speed() {
    const {samples} = await this.simulation.truthSince(new Ice.Long(0x80000000, 0));
    const a = samples.at(-2), b = samples.at(-1);
    return Math.hypot(b.robotInWorld.x - a.robotInWorld.x, b.robotInWorld.y - a.robotInWorld.y) / ((b.stampUs.toNumber() - a.stampUs.toNumber()) / 1e6);
  }

  async stop() {
    for (const {child, code} of this.processes.values()) if (code === null) child.kill("SIGTERM");
    await eventually("all end", () => [...this.processes.values()].every(p => p.code !== null), 8000).catch(() => {
      for (const {child} of this.processes.values()) child.kill("SIGKILL");
    });
    await this.communicator.destroy();
  }
}

/** FNV-1a, as the page notes it of every image. */
export function hashOf(bytes) {
  let hash = 0x811c9dc5;
  for (const byte of bytes) hash = Math.imul(hash ^ byte, 0x01000193);
  return hash >>> 0;
}

/** Seconds of processor time of a process. */
export function cpuSeconds(pid) {
  const fields = readFileSync(`/proc/${pid}/stat`, "utf8").replace(/^.*\) /, "").split(" ");
  return (Number(fields[11]) + Number(fields[12])) / 100;
}

/** Memory of a process, in which shared pages count in parts [MB]. */
export function pssMegabytes(pid) {
  return Number(readFileSync(`/proc/${pid}/smaps_rollup`, "utf8").match(/^Pss: *(\d+)/m)[1]) / 1024;
}

export function ensureFolder(path) { mkdirSync(path, {recursive: true}); return path; }
