// Recordings: the recorder's controls, time travel compared with what was recorded, a log that seeks.
import assert from "node:assert/strict";
import {existsSync, mkdtempSync, rmSync} from "node:fs";
import {tmpdir} from "node:os";
import {join} from "node:path";
import {avm, eventually, hashOf, Ice, Robot, root, sleep} from "../support/robot.mjs";
import {readJson} from "../support/bag.mjs";
import {driven, openPage, pictures, showPane, text, waitForVideo} from "../support/page.mjs";

const minusOne = new Ice.Long(0xffffffff, 0xffffffff);

/** In a frame of the map's own. The page's buttons begin and end a recording; moments of the page's past equal what was recorded: image, pose, segments. */
export async function recording() {
  const folder = mkdtempSync(join(tmpdir(), "avm-gui-recording-"));
  const robot = await Robot.start({recorder: true, arguments: {simulator: ["--Simulator.Seed=5"], gui_server: ["--GuiServer.Truth=no"], recorder: [`--Recorder.Folder=${folder}`, "--Recorder.StartNow=no", "--Recorder.Ring.Length_s=20"]}});
  let moments, path;
  try {
    const page = await openPage(robot);
    await waitForVideo(page);
    assert.equal(await page.evaluate(() => globalThis.avmPage.moment().truth), null, "a truth has no place in the map");
    assert.match(await text(page, ".plot figcaption"), /^position sigma/);
    path = await record(page, robot);
    moments = await pastMoments(page);
    await saveRing(page, robot);
    page.checkErrors();
    await page.context().close();
    await compareWithBag(moments, path);
  } finally {
    await robot.stop();
  }
  try {
    await compareImages(moments, path);
  } finally {
    rmSync(folder, {recursive: true, force: true});
  }
}

/** @return the path of what was recorded, with a mark in it. */
async function record(page, robot) {
  await showPane(page, "actions");
  const group = page.locator("fieldset:has(legend:text-is('recorder'))");
  await eventually("the seed that runs", async () => await page.locator("input[aria-label='seed']").inputValue() === "5");
  await eventually("the recorder answers", async () => /idle/.test(await group.locator(".note").textContent()));
  await group.locator("button:text-is('record')").click();
  await eventually("it records", async () => (await robot.recorder.status()).state === avm.RecorderState.Recording);
  await driven(robot, 0.2, 0.2, async () => {
    await sleep(4000);
    await page.locator("input[aria-label='text of the mark']").fill("a corner");
    await page.locator("button:text-is('mark now')").click();
    await sleep(4000);
    await eventually("the age of the mark goes on", async () => /^[4-9] s ago: a corner/.test(await text(page, ".marks button")));
  });
  await page.locator(".pane-actions").screenshot({path: join(pictures, "recorder.png")});
  await group.locator("button:text-is('stop recording')").click();
  await eventually("it stands", async () => (await robot.recorder.status()).state === avm.RecorderState.Idle);
  const {path, messages} = await robot.recorder.status();
  assert.ok(messages.toNumber() > 100, `${messages.toNumber()} messages`);
  assert.deepEqual(readJson(path).get("/recorder/marks")?.map(m => m.text), ["a corner"]);
  return path;
}

async function pastMoments(page) {
  const moments = [];
  await page.locator(".time-bar button:has-text('pause')").click();
  for (let k = 0; k < 9; ++k) {
    await page.locator(".time-bar button:has-text('-1')").click();
    await sleep(500);
    await eventually("image, memory and estimate of that moment", () => page.evaluate(() => {
      const {frame, memory, estimate} = globalThis.avmPage.moment();
      return Boolean(frame && memory && estimate);
    }));
    moments.push(await page.evaluate(() => {
      const {frame, memory, estimate} = globalThis.avmPage.moment();
      return {
        image: {stampUs: frame.stampUs, hash: frame.hash},
        memory: {stampUs: memory.stampUs, revision: memory.revision, robot: memory.robot, ids: [...memory.ids]},
        estimate: {stampUs: estimate.stampUs, revision: estimate.revision, world: estimate.world, reliability: estimate.reliability},
      };
    }));
  }
  await page.locator(".time-bar button:has-text('live')").click();
  return moments;
}

async function saveRing(page, robot) {
  await page.locator("button:text-is('save the last seconds')").click();
  await eventually("the ring is saved", async () => /last seconds saved/.test(await text(page, ".notice")), 15_000);
  assert.equal((await robot.recorder.status()).state, avm.RecorderState.Idle);
}

/** Pose and segments: exactly those with the same revision. */
async function compareWithBag(moments, path) {
  const topics = readJson(path), plain = p => ({x: p.x_m, y: p.y_m, theta: p.theta_rad});
  let memories = 0, estimates = 0;
  for (const {memory, estimate} of moments) {
    const snapshot = topics.get("/memory/snapshot").find(m => m.revision === memory.revision);
    if (snapshot) {
      ++memories;
      assert.equal(memory.stampUs, snapshot.stamp_us);
      assert.deepEqual(memory.robot, plain(snapshot.robot_in_odom));
      assert.deepEqual(memory.ids, snapshot.segments.map(s => s.id).sort((a, b) => a - b));
    }
    const pose = topics.get("/localization/estimate").find(e => e.revision === estimate.revision);
    if (pose) {
      ++estimates;
      assert.equal(estimate.stampUs, pose.stamp_us);
      assert.deepEqual(estimate.world, plain(pose.robot_in_world));
      assert.equal(estimate.reliability, pose.reliability);
    }
  }
  console.log(`  of ${moments.length} moments of the past ${memories} snapshots and ${estimates} poses are in the recording, equal`);
  assert.ok(memories >= 3 && estimates >= 3, `${memories} snapshots and ${estimates} poses compared`);
}

/** The recording is played: the image of each stamp, encoded anew from its pixels, has the page's bytes. */
async function compareImages(moments, path) {
  const robot = await Robot.start({setup: "replay", without: ["active_visual_memory", "localization", "gui_server"], arguments: {replay_server: [`--ReplayServer.File=${path}`, "--ReplayServer.Start=paused"]}});
  let images = 0;
  try {
    const {firstUs, lastUs} = await robot.replay.info();
    for (const {image} of moments) {
      if (image.stampUs < firstUs.toNumber() || image.stampUs > lastUs.toNumber()) continue;
      await robot.replay.seek(longOf(image.stampUs));
      const played = (await robot.camera.getNext("JPEG", minusOne)).image;
      // A busy machine's recorder may have passed this image over.
      if (played.stampUs.toNumber() !== image.stampUs) continue;
      ++images;
      assert.equal(hashOf(played.pixels), image.hash, `the image of ${image.stampUs / 1e6} s`);
    }
  } finally {
    await robot.stop();
  }
  console.log(`  ${images} images of the past have the bytes of the recorded ones`);
  assert.ok(images >= 3, `${images} images compared`);
}

function longOf(value) { return new Ice.Long(Math.floor(value / 4294967296), value % 4294967296 >>> 0); }

/** Paused and at the end nothing is said to be wrong, and no age counts the pause. */
async function stands(page, robot, length) {
  const group = page.locator("fieldset:has(legend:text-is('replay'))"), press = name => group.locator(`button:text-is('${name}')`).click();
  const state = async name => (await robot.replay.info()).state.name === name;
  await press("pause");
  await sleep(4000);
  assert.equal(await text(page, ".problems"), "all running", "who waits for the images of a paused replay has no problem");
  const at = (await robot.replay.info()).stampUs.toNumber();
  await press("+1 image");
  await eventually("one image on", async () => (await robot.replay.info()).stampUs.toNumber() > at);
  await press("play");
  await eventually("it plays", () => state("PLAYING"));
  await sleep(1500);
  const age = Number(/age (\d+) ms/.exec(await text(page, ".pane-camera .stamp"))?.[1]);
  assert.ok(age < 1500, `age ${age} ms after a pause of 4 s`);
  await page.locator(".log-seek").evaluate((bar, seconds) => { bar.value = String(seconds); bar.dispatchEvent(new Event("change")); }, length - 0.5);
  await press("play again");
  await eventually("it plays again", () => state("PLAYING"));
}

/** A recording of another robot: its bar seeks, forward and back, and the page shows that place. */
export async function replay() {
  const data = process.env.AVM_DATA ?? join(root, "../shared/data");
  const bag = process.env.AVM_BAG ?? join(data, "nao_field_2009/nao_field_2009.bag");
  if (!existsSync(bag)) return console.log(`  skipped: no recording at ${bag}`);
  const robot = await Robot.start({setup: "replay", arguments: {replay_server: [`--ReplayServer.File=${bag}`], active_visual_memory: ["--ActiveVisualMemory.Palette=cfg/maps/field.palette"], localization: ["--Localization.Map=cfg/maps/field_6x4.csv", "--Localization.Palette=cfg/maps/field.palette"]}});
  try {
    const page = await openPage(robot, {preset: "replay"});
    await waitForVideo(page);
    const {firstUs, lastUs} = await robot.replay.info(), length = (lastUs.toNumber() - firstUs.toNumber()) / 1e6;
    for (const share of [0.6, 0.1, 0.4]) {
      const goal = firstUs.toNumber() + share * length * 1e6;
      await page.locator(".log-seek").evaluate((bar, seconds) => { bar.value = String(seconds); bar.dispatchEvent(new Event("change")); }, share * length);
      await eventually(`the page shows the log at ${(share * length).toFixed(1)} s`, async () => {
        const stampUs = await page.evaluate(() => globalThis.avmPage.moment().frame?.stampUs);
        return stampUs >= goal - 0.2e6 && stampUs < goal + 4e6;
      });
    }
    await eventually("without a truth the first plot is the position's sigma", async () => /^position sigma \(m\)sigma [\d.]+$/.test(await text(page, ".plot figcaption")));
    await sleep(3000);
    await page.screenshot({path: join(pictures, "replay_recording.png")});
    await stands(page, robot, length);
    page.checkErrors();
    await page.context().close();
  } finally {
    await robot.stop();
  }
}
