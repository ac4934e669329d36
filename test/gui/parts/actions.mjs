// Actions: gaze, driving, pose, kidnapping.
import assert from "node:assert/strict";
import {join} from "node:path";
import {avm, eventually, sleep} from "../support/robot.mjs";
import {driven, loadMargin, loadText, openPage, pictures, setTool, showPane, text, waitForVideo} from "../support/page.mjs";

/** Click to gaze: the ray of the clicked pixel against where the camera points after the saccade. */
export async function gaze(robot) {
  const page = await openPage(robot);
  await waitForVideo(page);
  // In the middle of the corridor, and the head ahead, so that the clicked points lie within the joints' limits.
  await robot.simulation.kidnap(new avm.Pose2(3, 2.25, Math.PI));
  await sleep(1500);
  const {x, y, theta} = (await robot.memory.latest()).analysis.robotInOdom;
  await robot.gaze.fixate(new avm.Vector3(x + 2 * Math.cos(theta), y + 2 * Math.sin(theta), 0));
  await sleep(500);
  await stillHead(robot);
  const errors = [];
  for (const [fx, fy] of [[0.7, 0.7], [0.3, 0.55], [0.6, 0.4]]) {
    await robot.gaze.setMode(avm.GazeMode.Hold);
    const analysis = await stillHead(robot), place = await imagePlace(page, analysis.cameraModel);
    const u = fx * analysis.cameraModel.width, v = fy * analysis.cameraModel.height, wanted = directionOf(analysis, u, v);
    await page.mouse.click(place.x + (u + 0.5) * place.scale, place.y + (v + 0.5) * place.scale);
    await eventually("notice", async () => new RegExp(`gaze to pixel ${u.toFixed(0)}, `).test(await text(page, ".notice")));
    await sleep(300);
    const after = await stillHead(robot), got = directionOf(after, after.cameraModel.cx, after.cameraModel.cy);
    errors.push(Math.acos(Math.min(1, wanted.x * got.x + wanted.y * got.y + wanted.z * got.z)) * 180 / Math.PI);
  }
  console.log(`  angle between clicked point and axis of the camera: ${errors.map(e => e.toFixed(2)).join(", ")} deg`);
  for (const error of errors) assert.ok(error < 1, `${error} deg`);
  await robot.gaze.setMode(avm.GazeMode.Attend);
  page.checkErrors();
  await page.context().close();
}

/** The analysis of an image that was taken 0.5 s of the robot's time after the head had come to rest: a busy machine simulates slowly. */
async function stillHead(robot) {
  let still = (await robot.memory.latest()).analysis;
  await eventually("the head rests", async () => {
    const now = (await robot.memory.latest()).analysis, a = directionOf(still, still.cameraModel.cx, still.cameraModel.cy), b = directionOf(now, now.cameraModel.cx, now.cameraModel.cy);
    if (Math.hypot(a.x - b.x, a.y - b.y, a.z - b.z) > 1e-3) still = now;
    return now.stampUs.toNumber() - still.stampUs.toNumber() > 500_000;
  });
  return (await robot.memory.latest()).analysis;
}

/** Where the image lies in the page: whole in the canvas, in its middle. */
async function imagePlace(page, lens) {
  const box = await page.locator(".video").boundingBox(), scale = Math.min(box.width / lens.width, box.height / lens.height);
  return {x: box.x + (box.width - scale * lens.width) / 2, y: box.y + (box.height - scale * lens.height) / 2, scale};
}

/** Unit direction of a pixel's ray in the robot's frame; the robot stands. The simulated lens has no distortion. */
function directionOf(a, u, v) {
  const {fx, fy, cx, cy} = a.cameraModel, q = a.cameraOnRobot, x = (u - cx) / fx, y = (v - cy) / fy, n = Math.hypot(x, y, 1), d = [x / n, y / n, 1 / n];
  const {qw: w, qx: i, qy: j, qz: k} = q, t = [2 * (j * d[2] - k * d[1]), 2 * (k * d[0] - i * d[2]), 2 * (i * d[1] - j * d[0])];
  return {x: d[0] + w * t[0] + j * t[2] - k * t[1], y: d[1] + w * t[1] + k * t[0] - i * t[2], z: d[2] + w * t[2] + i * t[1] - j * t[0]};
}

const watchdogMs = 250 + 150;

/** From the last command to standing the base needs its braking too: 0.3 m/s at 4 m/s^2 are 75 ms; the poll sees it 30 ms late. */
const allowedMs = watchdogMs + 75 + 30;

/** A picture that was late while the page began bars driving until the next press, as it shall. The tab takes the focus a moment after its click. */
async function pressUntilMoving(page, robot, name, {press, release}) {
  for (let attempt = 0; ; ++attempt) {
    await page.locator(".drive-surface").focus();
    await press(page);
    try {
      return await eventually(`the robot moves (${name})`, async () => await robot.speed() > 0.1, 2500, 30);
    } catch (failure) {
      if (attempt === 2) throw new Error(`${failure.message}; the page says: ${await text(page, ".pane-drive .note")}`);
      await release(page);
      await sleep(1200);
    }
  }
}

/** Driving stops, however the key is let go. */
export async function drive(robot) {
  const results = [];
  for (const [name, release, allowed, hand = keyW] of releases) {
    const page = await openPage(robot, {touch: hand === finger, before: hand.before});
    if (name === "network") page.expected.push(/./);
    await waitForVideo(page);
    await robot.simulation.kidnap(new avm.Pose2(3, 2.25, Math.PI));
    await showPane(page, "drive");
    await pressUntilMoving(page, robot, name, hand);
    const begin = Date.now(), done = release(page, robot);
    await eventually(`the robot stands after ${name}`, async () => await robot.speed() < 0.005, 4000, 10);
    const ms = Date.now() - begin;
    results.push(`${name} ${ms}`);
    await done;
    assert.ok(ms <= allowed + loadMargin(), `${name}: ${ms} ms (at most ${allowed})`);
    await sleep(300);
    assert.ok(await robot.speed() < 0.005, `stands after ${name}`);
    if (name !== "page closed") {
      page.checkErrors();
      await page.context().close();
    }
    await sleep(1300);
  }
  console.log(`  ms from letting go to standing: ${results.join(", ")}; ${loadText()}`);
}

/** What drives: how it is held, and how it is let go. */
const keyW = {press: page => page.keyboard.down("KeyW"), release: page => page.keyboard.up("KeyW")};
const finger = {press: touchStick, release: page => liftFinger(page, "touchEnd")};
const gamepad = {
  before: () => {
    const pad = {connected: true, axes: [0, 0, 0, 0], buttons: Array.from({length: 16}, () => ({pressed: false, value: 0}))};
    Object.assign(globalThis, {testPad: pad});
    navigator.getGamepads = () => [pad];
  },
  press: page => page.evaluate(() => { globalThis.testPad.axes[1] = -1; globalThis.testPad.buttons[7].value = 1; }),
  release: page => page.evaluate(() => { globalThis.testPad.buttons[7].value = 0; }),
};

/** A finger at the upper edge of the stick: straight on. */
async function touchStick(page) {
  // A touch belongs to the session that began it.
  page.fingers ??= await page.context().newCDPSession(page);
  const box = await page.locator(".stick").boundingBox();
  await page.fingers.send("Input.dispatchTouchEvent", {type: "touchStart", touchPoints: [{x: box.x + box.width / 2, y: box.y + 4}]});
}

function liftFinger(page, type) { return page.fingers.send("Input.dispatchTouchEvent", {type, touchPoints: []}); }

const releases = [
  ["key", keyW.release, allowedMs],
  ["finger", finger.release, allowedMs, finger],
  ["touch cancelled", page => liftFinger(page, "touchCancel"), allowedMs, finger],
  // The page looks at the pad 20 times a second.
  ["trigger of a gamepad", gamepad.release, allowedMs + 50, gamepad],
  ["gamepad unplugged", page => page.evaluate(() => { globalThis.testPad.connected = false; }), allowedMs + 50, gamepad],
  ["focus lost", async page => {
    const session = await page.context().newCDPSession(page);
    await session.send("Emulation.setFocusEmulationEnabled", {enabled: false});
    const other = await page.context().newPage();
    await other.bringToFront();
    await page.evaluate(() => window.dispatchEvent(new Event("blur")));
  }, allowedMs],
  ["tab hidden", page => page.evaluate(() => {
    Object.defineProperty(document, "hidden", {value: true, configurable: true});
    document.dispatchEvent(new Event("visibilitychange"));
  }), allowedMs],
  ["page closed", page => page.context().close(), allowedMs],
  ["page hangs", page => page.evaluate(() => { const t = Date.now(); while (Date.now() - t < 1500); }), allowedMs],
  ["network", async page => { await page.context().setOffline(true); await sleep(1500); await page.context().setOffline(false); }, allowedMs],
  ["stop button", page => page.locator(".stop").click(), allowedMs],
];

export async function pose(robot) {
  const page = await openPage(robot);
  await waitForVideo(page);
  await robot.simulation.kidnap(new avm.Pose2(3, 2.25, Math.PI));
  await sleep(500);
  await setTool(page, "pose");
  const box = await page.locator(".viewport").nth(1).boundingBox();
  await page.mouse.move(box.x + box.width * 0.4, box.y + box.height * 0.5);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width * 0.7, box.y + box.height * 0.5, {steps: 5});
  await page.mouse.up();
  const form = page.locator(".pose-form");
  assert.equal(Math.abs(Number(await form.locator("input").nth(2).inputValue())) < 3, true, "the arrow points along x");
  await page.screenshot({path: join(pictures, "set_pose.png")});
  const dragged = await Promise.all([0, 1].map(i => form.locator("input").nth(i).inputValue().then(Number)));
  await page.keyboard.press("Enter");
  await eventually("the dragged pose is set as it is", async () => (await text(page, ".notice")).includes(`pose set to ${dragged.map(v => v.toFixed(2)).join(", ")}`) && form.isHidden());
  await setTool(page, "pose");
  await page.mouse.click(box.x + box.width * 0.4, box.y + box.height * 0.5);
  for (const [i, value] of ["3.00", "2.25", "180"].entries()) await form.locator("input").nth(i).fill(value);
  await page.keyboard.press("Enter");
  await eventually("the pose is set", async () => {
    const {robotInWorld: p} = await robot.localization.latest();
    return Math.hypot(p.x - 3, p.y - 2.25) < 0.1;
  });
  await kidnapAndRecover(page, robot);
  page.checkErrors();
  await page.context().close();
}

/** A kidnapping is marked on the time bar, and the robot finds itself again. */
async function kidnapAndRecover(page, robot) {
  await setTool(page, "kidnap");
  const box = await page.locator(".viewport").nth(1).boundingBox();
  await page.mouse.click(box.x + box.width * 0.5, box.y + box.height * 0.5);
  const form = page.locator(".pose-form");
  for (const [i, value] of ["1.50", "2.25", "180"].entries()) await form.locator("input").nth(i).fill(value);
  await form.locator("button[type=submit]").click();
  await eventually("the robot was put elsewhere", async () => Math.abs((await robot.truth()).robotInWorld.x - 1.5) < 0.3);
  await eventually("a mark on the bar", async () => await page.locator(".mark.kidnap").count() > 0);
  const begin = Date.now();
  await driven(robot, 0.15, 0, () => eventually("recovery", async () => {
    const e = await robot.localization.latest(), t = (await robot.truth()).robotInWorld;
    return e.hasPose && e.reliability > 0.6 && Math.hypot(e.robotInWorld.x - t.x, e.robotInWorld.y - t.y) < 0.3;
  }, 40_000, 200));
  console.log(`  found itself again after ${((Date.now() - begin) / 1000).toFixed(1)} s`);
}
