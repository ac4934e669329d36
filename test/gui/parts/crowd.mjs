// Many pages at once: all live, one drives, the others see who.
import assert from "node:assert/strict";
import {avm, eventually, Ice, sleep} from "../support/robot.mjs";
import {loadText, openPage, showPane, text, waitForVideo} from "../support/page.mjs";

const pagesAtOnce = 10;
/** Slow pages get fewer frames, never old ones: pixels wait for one decoding and one drawing at most. */
const oldestMs = 2000;

export async function crowd(robot) {
  await robot.simulation.kidnap(new avm.Pose2(3, 2.25, Math.PI));
  const pages = [];
  // Small ones without a scene: the browser draws all ten without a graphics card.
  for (let k = 0; k < pagesAtOnce; ++k) pages.push(await openPage(robot, {width: 480, height: 400, preset: "tune"}));
  for (const page of pages) await waitForVideo(page);
  await Promise.all(pages.map((page, k) => eventually(`page ${k + 1} shows memory and pose`, () => page.evaluate(() => {
    const {memory, estimate, frame} = globalThis.avmPage.moment();
    return memory !== null && estimate !== null && frame !== null;
  }), 30_000, 300)));
  const behind = await Promise.all(pages.map(page => behindMs(page, robot)));
  console.log(`  ${pagesAtOnce} pages: ${(await Promise.all(pages.map(p => text(p, ".top-bar .link")))).join(" | ")}; images of ${behind.map(ms => ms.toFixed(0)).join(", ")} ms of the robot's time ago; ${loadText()}`);
  for (const ms of behind) assert.ok(ms < oldestMs, `${ms} ms old`);
  await oneDrives(pages, robot);
  for (const page of pages) {
    page.checkErrors();
    await page.context().close();
  }
}

/** How far a page's newest image is behind the camera's. */
async function behindMs(page, robot) {
  const stampUs = await page.evaluate(() => globalThis.avmPage.moment().frame.stampUs);
  const {image} = await robot.camera.getNext("JPEG", new Ice.Long(0xffffffff, 0xffffffff));
  return (image.stampUs.toNumber() - stampUs) / 1000;
}

async function oneDrives([driver, ...others], robot) {
  await driver.bringToFront();
  await showPane(driver, "drive");
  await driver.locator(".drive-surface").focus();
  await driver.keyboard.down("KeyA");
  await eventually("one page drives", async () => (await robot.base.holder()).held, 10_000);
  const {client} = await robot.base.holder();
  assert.match(client, /^page \d+/);
  for (const page of others.slice(0, 3)) {
    await showPane(page, "drive");
    await eventually("another page names who drives", async () => (await text(page, ".pane-drive .note")).includes(`${client} drives`), 15_000);
  }
  await driver.keyboard.up("KeyA");
  await eventually("nobody drives", async () => !(await robot.base.holder()).held, 10_000);
  await sleep(300);
  assert.ok(await robot.speed() < 0.005);
}
