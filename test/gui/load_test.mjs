// What clients cost the robot's side: node load_test.mjs [SECONDS [ROUNDS]], by hand, on a machine that does nothing else.
// Processor time of simulator, memory and localization with 0, 1 and 10 clients in turn (the page and nine of Node's that make its calls, one of
// them standing still), and the rates of the page with 1 and 10. SECONDS 60 and ROUNDS 3 are the issue's.
import {spawn} from "node:child_process";
import {readFileSync} from "node:fs";
import {fileURLToPath} from "node:url";
import {loadavg} from "node:os";
import {avm, cpuSeconds, Ice, Robot, sleep} from "./support/robot.mjs";

const none = new Ice.Long(0xffffffff, 0xffffffff), smallest = new Ice.Long(0x80000000, 0);

/** The page's calls, as fast as their answers come. */
function runClient(ports) {
  const communicator = Ice.initialize(["--Ice.MessageSizeMax=16384"]);
  const proxy = (type, identity, port, connection) => avm[`${type}Prx`].uncheckedCast(communicator.stringToProxy(`${identity}:tcp -h 127.0.0.1 -p ${port}`)).ice_connectionId(connection);
  const forever = async step => { for (;;) await step().catch(() => sleep(500)); };
  const camera = proxy("Camera", "cameraA", ports.source, "images"), memory = proxy("VisualMemory", "VisualMemory", ports.memory, "m"), localization = proxy("Localization", "Localization", ports.localization, "l");
  const gaze = proxy("Gaze", "Gaze", ports.memory, "m"), odometry = proxy("Odometry", "Encoders", ports.source, "o"), simulation = proxy("Simulation", "Simulation", ports.source, "o");
  let seq = none, revision = new Ice.Long(0, 0), estimate = new Ice.Long(0, 0), stamp = smallest, moved = smallest, truth = smallest;
  forever(async () => { seq = (await camera.getNext("JPEG", seq)).image.seq; });
  forever(async () => { revision = (await memory.next(revision)).update.snapshot.revision; });
  forever(async () => { estimate = (await localization.next(estimate)).estimate.revision; });
  forever(async () => { stamp = (await gaze.next(stamp)).status.stampUs; await sleep(80); });
  forever(async () => { moved = (await odometry.samplesSince(moved)).samples.at(-1)?.stampUs ?? moved; await sleep(95); });
  forever(async () => { truth = (await simulation.truthSince(truth)).samples.at(-1)?.stampUs ?? truth; await sleep(62); });
  for (const [name, port] of [["simulator", ports.source], ["active_visual_memory", ports.memory], ["localization", ports.localization]]) {
    const component = proxy("Component", `${name}/component`, port, "c");
    forever(async () => { await component.getStatus(); await sleep(600); });
  }
}

if (process.argv[2] === "client") {
  runClient(JSON.parse(process.argv[3]));
} else {
  const {browser, driven, median, openPage, waitForVideo} = await import("./support/page.mjs");
  const seconds = Number(process.argv[2] ?? 10), rounds = Number(process.argv[3] ?? 1);
  const robot = await Robot.start(), parts = ["simulator", "active_visual_memory", "localization"], results = {0: [], 1: [], 10: []}, rates = {1: [], 10: []};
  const memoryOf = () => parts.map(p => Number(readFileSync(`/proc/${robot.processes.get(p).child.pid}/smaps_rollup`, "utf8").match(/^Pss: *(\d+)/m)[1]) / 1024);
  const used = () => parts.reduce((sum, p) => sum + cpuSeconds(robot.processes.get(p).child.pid, readFileSync), 0);
  const before = memoryOf();
  await driven(robot, 0.1, 0.2, async () => {
    for (let round = 0; round < rounds; ++round) {
      for (const clients of [0, 1, 10]) {
        const page = clients > 0 ? await openPage(robot) : null;
        const others = Array.from({length: Math.max(0, clients - 1)}, () => spawn(process.execPath, [fileURLToPath(import.meta.url), "client", JSON.stringify(robot.ports.tcp)], {stdio: "ignore"}));
        if (page) await waitForVideo(page);
        await sleep(4000);
        others[0]?.kill("SIGSTOP");
        const begin = Date.now(), cpu = used(), fps = [];
        while (Date.now() - begin < seconds * 1000) {
          await sleep(1000);
          if (page) fps.push(Number((await page.locator(".top-bar .link").textContent()).match(/(\d+)(?: of \d+)? fps/)?.[1] ?? 0));
        }
        results[clients].push(100 * (used() - cpu) / ((Date.now() - begin) / 1000));
        if (page) rates[clients].push(median(fps));
        for (const other of others) { other.kill("SIGCONT"); other.kill("SIGKILL"); }
        await page?.context().close();
        console.log(`round ${round + 1}, ${clients} clients: ${results[clients].at(-1).toFixed(1)} % of a core${page ? `, page ${rates[clients].at(-1)} fps` : ""}, load ${loadavg()[0].toFixed(1)}`);
      }
    }
  });
  const [c0, c1, c10] = [0, 1, 10].map(n => median(results[n])), limit = Math.max(1.1 * (c0 + 10 * (c1 - c0)), c0 + 30);
  console.log(`medians: ${c0.toFixed(1)}, ${c1.toFixed(1)}, ${c10.toFixed(1)} % of a core; limit with ten ${limit.toFixed(1)}; page ${median(rates[1])} and ${median(rates[10])} fps; ` +
    `memory (Pss, MB) ${before.map(m => m.toFixed(0))} before, ${memoryOf().map(m => m.toFixed(0))} after`);
  await robot.stop();
  await browser.close();
  process.exit(c10 <= limit && median(rates[10]) >= 0.9 * median(rates[1]) ? 0 : 1);
}
