// What clients cost the robot's side: node load_test.mjs FILE [SECONDS], by hand, on a machine that does nothing else.
// One round: 0, 1 and 10 clients for SECONDS (60) each: the page, and nine of Node's that make its calls, of which one stands still. Rounds collect in
// FILE; each call prints the table of their medians. The exit code is 0 when three rounds keep the limits.
import {spawn} from "node:child_process";
import {appendFileSync, readFileSync} from "node:fs";
import {fileURLToPath} from "node:url";
import {loadavg} from "node:os";
import {avm, cpuSeconds, Ice, pssMegabytes, Robot, sleep} from "./support/robot.mjs";

const none = new Ice.Long(0xffffffff, 0xffffffff), smallest = new Ice.Long(0x80000000, 0);
const clientCounts = [0, 1, 10];

/** The page's calls, as often as it makes them; prints the images and snapshots that came, once a second. */
function runClient(ports) {
  const communicator = Ice.initialize(["--Ice.MessageSizeMax=16384", "--Ice.Default.InvocationTimeout=3000"]);
  const proxy = (type, identity, port, connection) => avm[`${type}Prx`].uncheckedCast(communicator.stringToProxy(`${identity}:tcp -h 127.0.0.1 -p ${ports[port]}`)).ice_connectionId(connection);
  const forever = async step => { for (;;) await step().catch(() => sleep(500)); };
  const camera = proxy("Camera", "cameraA", 9999, "images"), memory = proxy("VisualMemory", "VisualMemory", 9970, "m"), localization = proxy("Localization", "Localization", 9971, "l");
  const gaze = proxy("Gaze", "Gaze", 9970, "m"), odometry = proxy("Odometry", "Encoders", 9999, "o"), simulation = proxy("Simulation", "Simulation", 9999, "o"), base = proxy("Base", "Motors", 9999, "o");
  let seq = none, revision = new Ice.Long(0, 0), estimate = new Ice.Long(0, 0), stamp = smallest, moved = smallest, truth = smallest, images = 0, snapshots = 0;
  forever(async () => { seq = (await camera.getNext("JPEG", seq)).image.seq; ++images; });
  forever(async () => { revision = (await memory.next(revision)).update.snapshot.revision; ++snapshots; });
  forever(async () => { estimate = (await localization.next(estimate)).estimate.revision; });
  forever(async () => { stamp = (await gaze.next(stamp)).status.stampUs; await sleep(80); });
  forever(async () => { moved = (await odometry.samplesSince(moved)).samples.at(-1)?.stampUs ?? moved; await sleep(95); });
  forever(async () => { truth = (await simulation.truthSince(truth)).samples.at(-1)?.stampUs ?? truth; await sleep(62); });
  forever(async () => { await simulation.status(); await sleep(500); });
  forever(async () => { await base.holder(); await sleep(700); });
  for (const [name, port] of [["simulator", 9999], ["active_visual_memory", 9970], ["localization", 9971]]) {
    const component = proxy("Component", `${name}/component`, port, "c");
    forever(async () => { await component.getStatus(); await sleep(600); });
  }
  setInterval(() => { console.log(JSON.stringify({images, snapshots})); images = snapshots = 0; }, 1000);
}

const programs = ["simulator", "active_visual_memory", "localization", "gui_server"];
const pidOf = (robot, name) => robot.processes.get(name).child.pid;
const memoryOf = robot => programs.reduce((sum, name) => sum + pssMegabytes(pidOf(robot, name)), 0);
const usedBy = robot => programs.reduce((sum, name) => sum + cpuSeconds(pidOf(robot, name)), 0);

class Client {
  rates = [];
  constructor(robot) {
    this.child = spawn(process.execPath, [fileURLToPath(import.meta.url), "client", JSON.stringify(Object.fromEntries(robot.ports))], {stdio: ["ignore", "pipe", "ignore"]});
    this.child.stdout.on("data", text => { for (const line of String(text).trim().split("\n")) this.rates.push(JSON.parse(line)); });
  }
}

/** Of one count of clients: CPU of the robot's side [% of a core], rates and memory. */
async function measure(robot, clients, seconds, {openPage, median, waitForVideo}) {
  const page = clients > 0 ? await openPage(robot) : null;
  const others = Array.from({length: Math.max(0, clients - 1)}, () => new Client(robot));
  if (page) await waitForVideo(page);
  await sleep(8000);
  const stalled = others.shift();
  stalled?.child.kill("SIGSTOP");
  for (const other of others) other.rates = [];
  const begin = Date.now(), cpu = usedBy(robot), pss = memoryOf(robot), fps = [], elements = [];
  while (Date.now() - begin < seconds * 1000) {
    await sleep(1000);
    if (!page) continue;
    fps.push(Number((await page.locator(".top-bar .link").textContent()).match(/(\d+)(?: of \d+)? fps/)?.[1] ?? 0));
    elements.push(await page.evaluate(() => { const {memory} = globalThis.avmPage.moment(), last = globalThis.lastRevision ?? memory.revision; globalThis.lastRevision = memory.revision; return memory.revision - last; }));
  }
  const result = {clients, cpu: 100 * (usedBy(robot) - cpu) / ((Date.now() - begin) / 1000), fps: page ? median(fps) : null, memoryHz: page ? median(elements) : null,
    clientHz: others.length > 0 ? median(others.map(o => median(o.rates.map(r => r.images)))) : null, slowestHz: others.length > 0 ? Math.min(...others.map(o => median(o.rates.map(r => r.images)))) : null,
    pss, pssAfter: memoryOf(robot), load: loadavg()[0]};
  for (const other of stalled ? [stalled, ...others] : []) other.child.kill("SIGKILL");
  await page?.context().close();
  return result;
}

/** Medians over the rounds of FILE. @return whether there are three and the limits are kept. */
function report(file, median) {
  const all = readFileSync(file, "utf8").trim().split("\n").map(line => JSON.parse(line));
  const of = (clients, key) => median(all.filter(r => r.clients === clients).map(r => r[key])), shown = (value, digits = 1) => value === null ? "" : value.toFixed(digits);
  const rounds = all.filter(r => r.clients === 10).length;
  console.log(`| clients | CPU (% of a core), rounds | median | images/s of the page | snapshots/s of the page | images/s of a client, slowest | memory before, after (MB) | load |\n|---|---|---|---|---|---|---|---|`);
  for (const n of clientCounts) {
    console.log(`| ${n} | ${all.filter(r => r.clients === n).map(r => r.cpu.toFixed(1)).join(", ")} | ${shown(of(n, "cpu"))} | ${shown(of(n, "fps"), 0)} | ${shown(of(n, "memoryHz"), 0)} | ` +
      `${n > 1 ? `${shown(of(n, "clientHz"), 0)}, ${shown(of(n, "slowestHz"), 0)}` : ""} | ${shown(of(n, "pss"))}, ${shown(of(n, "pssAfter"))} | ${shown(of(n, "load"))} |`);
  }
  const [c0, c1, c10] = clientCounts.map(n => of(n, "cpu")), limit = Math.max(1.1 * (c0 + 10 * (c1 - c0)), c0 + 30);
  const cheap = c10 <= limit, even = of(10, "fps") >= 0.9 * of(1, "fps") && of(10, "slowestHz") >= 0.9 * of(1, "fps");
  console.log(`limit with ten clients ${limit.toFixed(1)} % of a core: ${cheap ? "kept" : "broken"}; rates with ten at most 10 % under one's: ${even ? "kept" : "broken"}; ${rounds} rounds`);
  return rounds >= 3 && cheap && even;
}

if (process.argv[2] === "client") {
  runClient(JSON.parse(process.argv[3]));
} else {
  const support = await import("./support/page.mjs"), file = process.argv[2], seconds = Number(process.argv[3] ?? 60);
  if (!file || !(seconds > 0)) {
    console.error("usage: node load_test.mjs FILE [SECONDS]");
    process.exit(2);
  }
  const robot = await Robot.start();
  await support.driven(robot, 0.1, 0.2, async () => {
    for (const clients of clientCounts) {
      const result = await measure(robot, clients, seconds, support);
      appendFileSync(file, `${JSON.stringify(result)}\n`);
      console.log(JSON.stringify(result));
    }
  });
  await robot.stop();
  await support.browser.close();
  process.exit(report(file, support.median) ? 0 : 1);
}
