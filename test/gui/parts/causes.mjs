// Why the robot is lost, in words: each cause stands first.
import assert from "node:assert/strict";
import {join} from "node:path";
import {avm, eventually, Robot, sleep} from "../support/robot.mjs";
import {driven, loadMargin, openPage, pictures, text, waitForVideo} from "../support/page.mjs";

const causes = page => page.locator(".causes .cause").allTextContents();

/** The map of another world: within 10 s the first two lines say that it fits nowhere and which labels it lacks. */
export async function wrongMap() {
  for (const map of ["field_6x4", "furniture"]) await wrongMapOf(map);
}

async function wrongMapOf(map) {
  const robot = await Robot.start({arguments: {localization: [`--Localization.Map=cfg/maps/${map}.csv`, `--Localization.Palette=cfg/maps/${map === "field_6x4" ? "field" : map}.palette`]}});
  try {
    const page = await openPage(robot), begin = Date.now();
    await driven(robot, 0.2, 0, () => eventually("fits nowhere, and the labels that are lacking", async () => {
      const lines = await page.locator(".causes .cause").allTextContents();
      return /No place of this map fits/.test(lines[0] ?? "") && /The map (lacks|has) '/.test(lines[1] ?? "");
    }, 25_000));
    const ms = Date.now() - begin;
    console.log(`  ${map}: named after ${(ms / 1000).toFixed(1)} s: ${(await page.locator(".causes .cause").allTextContents()).slice(0, 2).join(" ")}`);
    await page.locator(".pane-why").screenshot({path: join(pictures, `why_wrong_map_${map}.png`)});
    assert.ok(ms <= 10_000 + 10 * loadMargin(), `${ms} ms`);
    await page.context().close();
  } finally {
    await robot.stop();
  }
}

const grey = new avm.Vector3(0.5, 0.5, 0.5), noLight = new avm.Vector3(0, 0, 0);

/** A box right before the camera: grey it is a plain wall, black it covers the lens. */
export async function blindness(robot) {
  const page = await openPage(robot);
  await waitForVideo(page);
  await robot.simulation.kidnap(new avm.Pose2(3, 2.25, Math.PI));
  await sleep(300);
  await robot.gaze.setMode(avm.GazeMode.Hold);
  const lease = await robot.panTilt.acquire("test of the page", 50, 60);
  await robot.panTilt.moveTo(new avm.PanTiltAngles(0, 0), 0, 0, new Map([["lease", lease.id]]));
  for (const [name, tint, words] of [["plain_wall", grey, /^Almost no lines in view \(\d\): a plain wall/], ["covered_lens", noLight, /^The picture is black \(brightness \d+ of 255\)/]]) {
    await robot.simulation.addModel(name, new avm.PropShape(avm.PropKind.PropBox, new avm.Vector3(0.1, 3, 3), tint), new avm.Pose3(new avm.Vector3(2.66, 2.25, 0), 1, 0, 0, 0));
    const begin = Date.now();
    await eventually(`${name} is named first`, async () => words.test((await causes(page))[0] ?? ""), 15_000);
    console.log(`  ${name.replace("_", " ")}: named after ${((Date.now() - begin) / 1000).toFixed(1)} s: ${(await causes(page))[0]}`);
    await page.locator(".pane-why").screenshot({path: join(pictures, `why_${name}.png`)});
    await robot.simulation.removeModel(name);
    await eventually("lines are seen again", async () => !words.test((await causes(page))[0] ?? ""), 15_000);
  }
  await robot.panTilt.release(lease.id);
  await robot.gaze.setMode(avm.GazeMode.Attend);
  page.checkErrors();
  await page.context().close();
}

/** A robot with servers of its own: the one of odometry dies, and the memory that needs it says so. */
export async function odometryLost() {
  const robot = await Robot.start({setup: "files"});
  try {
    const page = await openPage(robot);
    page.expected.push(/WebSocket|ERR_CONNECTION/);
    await waitForVideo(page);
    await eventually("nothing is lost yet", async () => !/gone|has lost/.test((await causes(page)).join()));
    robot.kill("base_server");
    const begin = Date.now();
    await eventually("the server is named first, then who misses it", async () => {
      const [first, second] = await causes(page);
      return /^base_server is gone/.test(first ?? "") && /^active_visual_memory has lost Odometry/.test(second ?? "");
    }, 10_000);
    console.log(`  odometry server: named after ${((Date.now() - begin) / 1000).toFixed(1)} s: ${(await causes(page)).slice(0, 2).join(" ")}`);
    await page.locator(".pane-why").screenshot({path: join(pictures, "why_odometry.png")});
    await robot.ended("base_server");
    await page.locator(".stop").click();
    await eventually("a stop that did not arrive is not called one", async () => /^STOP DID NOT REACH THE BASE/.test(await text(page, ".notice")));
    await robot.launch("base_server");
    await eventually("nothing is lost again", async () => !/gone|has lost/.test((await causes(page)).join()), 20_000);
    page.checkErrors();
    await page.context().close();
  } finally {
    await robot.stop();
  }
}
