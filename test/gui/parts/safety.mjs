// Losses, pages of other origins, viewers.
import assert from "node:assert/strict";
import {readFileSync} from "node:fs";
import {createServer} from "node:http";
import {join} from "node:path";
import {avm, eventually, gui, Ice, Robot, sleep} from "../support/robot.mjs";
import {browser, loadMargin, loadText, openPage, pictures, showPane, text, waitForVideo} from "../support/page.mjs";

/** A component that is killed shows within 2 s, and recovery follows by itself. */
export async function loss(robot) {
  const page = await openPage(robot);
  page.expected.push(/WebSocket|ERR_CONNECTION/);
  await waitForVideo(page);
  await showPane(page, "settings");
  const settings = () => page.evaluate(() => [...document.querySelector(".settings").children].map(e => e.querySelector(".name")?.textContent ?? `${e.textContent}:`));
  const before = await eventually("parameters of both components", async () => {
    const now = await settings();
    return now.includes("localization:") && now.includes("active_visual_memory:") && now;
  });
  for (const name of ["localization", "active_visual_memory"]) {
    robot.kill(name);
    const begin = Date.now();
    await eventually(`${name} is shown as gone`, async () => new RegExp(name).test(await text(page, ".problems")) && /problem/.test(await text(page, ".problems")), 5000, 20);
    const shown = Date.now() - begin;
    await eventually(`the lost panel names ${name}`, async () => new RegExp(`${name} is gone`).test(await text(page, ".causes")), 5000);
    if (name === "localization") await page.locator(".pane-why").screenshot({path: join(pictures, "why_component.png")});
    await robot.ended(name);
    await robot.launch(name);
    const again = Date.now();
    await eventually("all run again", async () => /all running/.test(await text(page, ".problems")), 20_000);
    console.log(`  ${name}: shown after ${shown} ms, back ${Date.now() - again} ms after its start, ${loadText()}`);
    assert.ok(shown <= 2000 + loadMargin(), `${shown} ms`);
  }
  await eventually("every parameter stands below its component again", async () => (await settings()).join() === before.join());
  page.checkErrors();
  await page.context().close();
}

/** A page of another origin can neither read the token nor reach an object. */
export async function foreign(robot) {
  const server = createServer((_q, r) => { r.setHeader("content-type", "text/html"); r.end("<!doctype html><title>foreign</title>"); });
  await new Promise(done => server.listen(0, "127.0.0.1", done));
  const page = await (await browser.newContext()).newPage();
  await page.goto(`http://127.0.0.1:${server.address().port}/`);
  const read = await page.evaluate(url => fetch(url).then(r => r.text(), e => `refused: ${e.message}`), `${robot.url}config.json`);
  assert.match(read, /^refused/);
  const opaque = await page.evaluate(url => fetch(url, {mode: "no-cors"}).then(r => r.text(), e => `refused: ${e.message}`), `${robot.url}config.json`);
  assert.ok(opaque === "" || opaque.startsWith("refused"), opaque);
  // With Ice of its own the foreign page reaches the port, but knows no identity that answers.
  await page.addScriptTag({content: readFileSync(join(gui, "node_modules/ice/lib/Ice.min.js"), "utf8")});
  const answers = await page.evaluate(async port => {
    const {Ice} = globalThis, communicator = Ice.initialize(), tried = [];
    for (const identity of ["cameraA", "Motors", "robot/cameraA", "robot/Motors", "robot.view/cameraA", "view/Motors", "simulator/component", "robot.wrong/Motors"]) {
      const proxy = communicator.stringToProxy(`${identity}:ws -h 127.0.0.1 -p ${port}`).ice_invocationTimeout(2000);
      tried.push(await proxy.ice_ping().then(() => `${identity} answers`, e => e.ice_name ? e.ice_name() : String(e)));
    }
    await communicator.destroy();
    return tried;
  }, robot.port(11000));
  for (const answer of answers) assert.match(answer, /ObjectNotExist/, answers.join());
  // A name that is bound to this machine's address is another origin, too: its Host is refused.
  const bound = await fetch(`${robot.url}config.json`, {headers: {Host: "evil.example"}}).then(r => r.status, () => "no fetch");
  assert.ok(bound === 403 || bound === 200, String(bound));
  await page.context().close();
  server.close();
}

/** A viewer's page watches and has no actions. */
export async function viewer() {
  const robot = await Robot.start({viewer: true});
  try {
    const page = await openPage(robot);
    await waitForVideo(page);
    assert.equal(await page.locator(".stop").count(), 0);
    await showPane(page, "actions");
    assert.match(await text(page, ".pane-actions"), /only watches/);
    const refused = await page.evaluate(() => globalThis.avmPage.call("kidnap", {x: 0, y: 0, theta: 0}).then(() => "taken", e => e.message));
    assert.match(refused, /not allowed/);
    page.checkErrors();
    await page.context().close();
  } finally {
    await robot.stop();
  }
}
