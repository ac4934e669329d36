// Whether the page's memory is flat once its five minutes are full: node soak_test.mjs [MINUTES], by hand; 16 minutes unless said.
// Each minute: the JavaScript heaps of page and worker after a forced collection, what the worker's history holds of them by its own account (it holds
// more images when they come faster), and the memory of the browser's processes (Pss: shared pages count in parts, so no other browser may run).
// The exit code is 0 when from the 6th minute on the heaps grow by at most 5 %, the browser and the heaps without the history by at most 10 %: medians of
// the first and last three, and of the heaps without the history the least of each half, because the page's own 8 MB swing by 3 MB even after a collection.
import {readdirSync, readFileSync} from "node:fs";
import {loadavg} from "node:os";
import {pssMegabytes, Robot, sleep} from "./support/robot.mjs";
import {browser, driven, median, openPage, waitForVideo} from "./support/page.mjs";

const fullAfterMinutes = 6;

/** Processes below this one that belong to the browser. */
function browserProcesses() {
  const parents = new Map(), names = new Map();
  for (const pid of readdirSync("/proc").filter(n => /^\d+$/.test(n))) {
    try {
      const [, name, rest] = readFileSync(`/proc/${pid}/stat`, "utf8").match(/\((.*)\) (.*)/);
      parents.set(Number(pid), Number(rest.split(" ")[1]));
      names.set(Number(pid), name);
    } catch {
      // It ended meanwhile.
    }
  }
  const isBelow = pid => pid === process.pid || (parents.has(pid) && parents.get(pid) > 1 && isBelow(parents.get(pid)));
  return [...parents.keys()].filter(pid => /chrom/.test(names.get(pid)) && isBelow(pid));
}

/** Bytes of the heaps of the page and of its worker, which holds the history. */
async function heaps(session, worker) {
  await session.send("HeapProfiler.collectGarbage");
  const page = (await session.send("Runtime.getHeapUsage")).usedSize;
  await worker("HeapProfiler.collectGarbage");
  const {usedSize, backingStorageSize = 0} = await worker("Runtime.getHeapUsage");
  return {page: page / 1e6, worker: usedSize / 1e6, buffers: backingStorageSize / 1e6};
}

/** A way to speak with the page's worker, which has a session of its own. */
async function workerSession(session) {
  const answers = new Map();
  let next = 1;
  const attached = new Promise(done => session.on("Target.attachedToTarget", event => done(event.sessionId)));
  session.on("Target.receivedMessageFromTarget", ({message}) => {
    const {id, result} = JSON.parse(message);
    answers.get(id)?.(result);
    answers.delete(id);
  });
  await session.send("Target.setAutoAttach", {autoAttach: true, waitForDebuggerOnStart: false, flatten: false});
  const sessionId = await attached;
  return method => new Promise(done => {
    answers.set(next, done);
    void session.send("Target.sendMessageToTarget", {sessionId, message: JSON.stringify({id: next++, method})});
  });
}

const minutes = Number(process.argv[2] ?? 16), robot = await Robot.start(), page = await openPage(robot), samples = [];
await waitForVideo(page);
const session = await page.context().newCDPSession(page), worker = await workerSession(session);
await driven(robot, 0.1, 0.2, async () => {
  for (let minute = 1; minute <= minutes; ++minute) {
    await sleep(60_000);
    const {page: own, worker: history, buffers} = await heaps(session, worker), pss = browserProcesses().reduce((sum, pid) => sum + pssMegabytes(pid), 0);
    const bar = await page.locator(".time-bar .time-text").first().textContent(), held = Number(bar.match(/([\d.]+) of \d+ MB/)[1]);
    console.log(`minute ${minute}: heap of the page ${own.toFixed(1)} MB, of the worker ${history.toFixed(1)} MB and ${buffers.toFixed(1)} MB of buffers; browser ${pss.toFixed(0)} MB; ${bar}; load ${loadavg()[0].toFixed(1)}`);
    if (minute >= fullAfterMinutes) samples.push({heap: own + history + buffers, rest: own + history + buffers - held, pss});
  }
});
page.checkErrors();
await robot.stop();
await browser.close();
const percent = (before, after) => 100 * (after / before - 1);
const growth = key => percent(median(samples.slice(0, 3).map(s => s[key])), median(samples.slice(-3).map(s => s[key])));
const least = part => Math.min(...part.map(s => s.rest));
const half = Math.floor(samples.length / 2);
const [heap, rest, pss] = [growth("heap"), percent(least(samples.slice(0, half)), least(samples.slice(-half))), growth("pss")];
console.log(`from minute ${fullAfterMinutes} to ${minutes}: heaps ${heap.toFixed(1)} %, without the history ${rest.toFixed(1)} %, browser ${pss.toFixed(1)} %`);
process.exit(heap <= 5 && rest <= 10 && pss <= 10 ? 0 : 1);
