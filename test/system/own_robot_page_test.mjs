// The page of scripts/own_robot NAME page in a browser, in a copy of the project's cfg/; the programs behind the steps are shell scripts.
// node own_robot_page_test.mjs PROJECT CHROMIUM. AVM_PICTURES: folder for pictures.
import assert from "node:assert/strict";
import {spawn} from "node:child_process";
import {chmodSync, cpSync, existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, symlinkSync, writeFileSync} from "node:fs";
import {createRequire} from "node:module";
import {tmpdir} from "node:os";
import {join} from "node:path";
import {createInterface} from "node:readline";

const [project, executablePath] = process.argv.slice(2);
const require = createRequire(join(project, "components/gui/package.json"));
const {chromium} = require("playwright-core"), axe = readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");
const root = mkdtempSync(join(tmpdir(), "vismem-own-robot-page-")), at = name => join(root, name);
cpSync(join(project, "cfg"), at("cfg"), {recursive: true});
for (const name of ["scripts", "components"]) symlinkSync(join(project, name), at(name));
mkdirSync(at("build/release/bin"), {recursive: true});

function program(name, script) {
  writeFileSync(at(`build/release/bin/${name}`), `#!/bin/sh\n${script}`);
  chmodSync(at(`build/release/bin/${name}`), 0o755);
}

let server = null;
async function serve() {
  server = spawn(at("scripts/own_robot"), ["mine", "page", "--port", "0"], {stdio: ["ignore", "pipe", "inherit"]});
  for await (const line of createInterface({input: server.stdout})) return line.replace("page ", "");
}
const ended = () => new Promise(resolve => { server.exitCode === null ? server.on("exit", resolve) : resolve(); server.kill("SIGTERM"); });

const browser = await chromium.launch({executablePath, args: ["--no-sandbox", "--disable-gpu"]});
const context = await browser.newContext({viewport: {width: 1280, height: 860}, colorScheme: "dark"}), errors = [];
let page = null;
async function open(address) {
  page = await context.newPage();
  page.on("pageerror", error => errors.push(error.stack));
  page.on("console", message => { if (message.type() === "error") errors.push(message.text()); });
  await page.goto(address);
  await page.waitForSelector("nav button");
}
const picture = async name => { if (process.env.AVM_PICTURES) await page.screenshot({path: join(process.env.AVM_PICTURES, `${name}.png`)}); };
const show = step => page.locator(`[data-step=${step}]`).click();
const run = async step => { await show(step); await page.locator("#start").click(); };
const says = (selector, pattern) => page.waitForFunction(([where, what]) => new RegExp(what).test(document.querySelector(where)?.textContent ?? ""),
  [selector, pattern.source], {timeout: 20000});
const states = () => page.locator("nav button").evaluateAll(all => Object.fromEntries(all.map(one => [one.dataset.step, one.dataset.state])));

async function accessible(what) {
  await page.evaluate(axe);
  const {violations} = await page.evaluate(() => window.axe.run(document, {runOnly: ["wcag2a", "wcag2aa", "wcag21aa", "wcag22aa"]}));
  assert.deepEqual(violations.map(one => `${what}: ${one.id}: ${one.nodes.map(node => node.target).join(" ")}`), []);
}

const parts = {
  async "starts a simulated robot and shows what changed"() {
    await says("#count", /0 of 9 done/);
    assert.equal(await page.locator("[data-next=true]").getAttribute("data-step"), "start");
    await accessible("start");
    await page.getByLabel("a simulated robot").check();
    await page.locator("[id='start--simulated']").selectOption("room");
    await page.locator("[id='start--seed']").fill("3");
    await says("#command", /scripts\/own_robot mine start --simulated=room --seed=3/);
    await page.locator("#start").click();
    await says(".verdict", /Succeeded in \d+ s/);
    await says("#changes", /\+Simulator\.Seed = 3/);
    await says("#kind", /a simulated robot/);
    assert.deepEqual(await states(), {start: "done", devices: "any", target: "none", ruler: "none", lens: "none", body: "none", drive: "-",
      colours: "-", map: "-", localize: "-", robot: "any"});
    assert.equal(await page.locator("#start").count(), 0, "a setup is not made twice");
    assert.ok(await page.locator("#log").isVisible(), "few lines need no click");
    await picture("start_done");
    await show("lens");
    await says("#about", /not for a simulated robot: its lens and mounting are those of its setup/);
    assert.equal(await page.locator("#start").count(), 0);
  },

  async "names what comes first and shows a program's own error"() {
    await show("colours");
    await says("#about", /Comes first: Drive/);
    assert.ok(await page.locator("#start").isDisabled());
    await page.getByLabel("take a palette").check();
    await page.locator("[id='colours--palette']").fill("wrong.palette");
    await page.locator("#start").click();
    await says(".verdict", /Did not succeed.*exit code 2.*own_robot: --palette wrong\.palette: no such file \(expected a palette/);
    await picture("error");
    // A small file goes from the browser to the robot.
    writeFileSync(at("mine.palette"), "no palette\n");
    program("label_palette", "echo 'mine.palette:1: (must be KEY = VALUE)' >&2; exit 2\n");
    await page.locator("[id='colours--palette-pick']").setInputFiles(at("mine.palette"));
    await says("#command", /--palette=out\/own_robot\/mine\/page\/files\/mine\.palette/);
    await page.locator("#start").click();
    await says(".verdict", /mine\.palette:1: \(must be KEY = VALUE\).*cannot be used as a palette/);
    await accessible("error");
  },

  async "keeps what is typed and looked at, and says which field is wrong"() {
    await show("drive");
    assert.doesNotMatch(await page.locator("#about").textContent(), /needs/, "a simulated robot drives by itself");
    await page.locator("summary", {hasText: "more"}).click();
    const rate = page.locator("[id='drive--Simulator.Camera.Rate_hz']");
    await rate.fill("1");
    mkdirSync(at("out/recordings/new"), {recursive: true});  // one may take it instead: the form is drawn anew
    await page.waitForTimeout(2500);
    await page.keyboard.press("End");
    await page.keyboard.type("0");
    assert.equal(await rate.inputValue(), "10", "the field keeps focus and stays open");
    await rate.fill("-5");
    await page.locator("#start").click();
    assert.ok(await rate.evaluate(field => field === document.activeElement && !field.validity.valid), "what is wrong");
    await rate.fill("");
    assert.ok(!existsSync(at("out/own_robot/mine/page/drive.json")), "nothing was begun");
    program("list_devices", "echo found; sleep 1\n");
    await show("devices");
    await page.locator("#start").dblclick();
    await says(".verdict", /Succeeded/);
    assert.equal(await page.locator("#note").textContent(), "", "a double click starts once");
  },

  async "shows progress, goes on while it is closed, and stops"() {
    program("list_devices", "trap 'kill $!; exit 1' INT TERM; echo 'camera at http://127.0.0.1:8770/'; echo page http://127.0.0.1:8771/; i=0\n" +
      "while [ $i -lt 600 ]; do i=$((i+1)); echo \"steps: $i of 600, 1 min left\" >&2; sleep 0.1 & wait $!; done\n");
    await run("devices");
    await says("#progress", /steps: \d+ of 600, 1 min left/);
    await says("#log", /camera at/);
    assert.equal(await page.locator("#log a").first().getAttribute("href"), "http://127.0.0.1:8770/");
    assert.equal(await page.locator("#pages a").getAttribute("href"), "http://127.0.0.1:8771/", "where one drives");
    assert.equal(await page.locator("#bar").getAttribute("max"), "600");
    assert.match(await page.title(), /^\d+ % Devices: mine$/);
    await picture("runs");
    await show("drive");
    assert.ok(await page.locator("#start").isDisabled());
    await says("#buttons", /Devices runs: one step at a time/);
    await accessible("runs");
    const address = page.url().replace(/#.*/, "");
    await page.close();
    await open(address);
    assert.equal(await page.locator("[aria-current=step]").getAttribute("data-step"), "devices", "the step that runs");
    await says("#progress", /steps: \d+ of 600/);
    await says("#log", /camera at/);
    await page.locator("#stop").click();
    await says(".verdict", /Stopped after \d+ s.*exit code 130.*devices was stopped before its end and can be repeated/);
    assert.ok(await page.locator("#stop").isHidden());
  },

  async "shows pictures and figures, and applies changes"() {
    rmSync(at("cfg/mine"), {recursive: true});
    mkdirSync(at("out/own_robot/mine/board"), {recursive: true});
    writeFileSync(at("out/own_robot/mine/board/board.json"), "{}");
    program("calibrate", `case " $* " in *" --write "*) echo Written. The file before is x; exit 0 ;; esac
mkdir -p out/own_robot/mine/body out/own_robot/mine/lens
echo '{"corners": 160, "camera_at_zero": {"camera height": {"value": 434.419, "sigma": 0.0699, "unit": "mm", "observable": true}}}' > out/own_robot/mine/body/report.json
printf '%s' iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8z8BQDwAEhQGAhKmMIQAAAABJRU5ErkJggg== | base64 -d > out/own_robot/mine/lens/progress.png
echo 'Changes of cfg/mine/active_visual_memory.cfg:'
echo '-12: ActiveVisualMemory.Mount.PanTilt.Position_m = 0 0 0.45'
echo '+12: ActiveVisualMemory.Mount.PanTilt.Position_m = 0 0 0.434'
echo 'Nothing was written: add --write.'\n`);
    await run("body");
    await says("#changes", /\+12: ActiveVisualMemory\.Mount\.PanTilt\.Position_m = 0 0 0\.434/);
    await says("#results", /camera height434\.419 ± 0\.070 mm/);
    await accessible("body");
    await page.locator("#apply").click();
    await says("#log", /Written\. The file before is x/);
    await says(".verdict", /Succeeded/);
    assert.equal(await page.locator("#apply").count(), 0);
    assert.match(readFileSync(at("out/own_robot/mine/page/body.json"), "utf8"), /"body", "--write"\]/);
    await show("ruler");
    await page.locator("#start").click();
    assert.equal(await page.evaluate(() => document.activeElement.id), "rulerACROSS", "nobody's measure is 100 by itself");
    await run("start");
    await says("#next", /Next: Devices/);
    await page.locator("#next").click();
    assert.equal(await page.evaluate(() => document.activeElement.id), "detail", "the keyboard goes on from there");
    await show("lens");
    await page.waitForFunction(() => document.querySelector("#results img")?.naturalWidth === 1);
  },

  async "opens a page of clicks that reaches nothing of the server"() {
    mkdirSync(at("out/own_robot/mine/colours/shown"), {recursive: true});
    writeFileSync(at("out/own_robot/mine/colours/shown/clicks.html"), `<button id="save">save</button><script>
      document.getElementById("save").onclick = () => {
        Object.assign(document.createElement("a"), {href: URL.createObjectURL(new Blob(["floor 1.ppm 3 4\\n"])), download: "place.clicks"}).click();
      };</script>`);
    await show("colours");
    const link = page.locator("#results a", {hasText: "name colours by clicks"});
    const [clicks] = await Promise.all([context.waitForEvent("page"), link.click()]);
    const [download] = await Promise.all([clicks.waitForEvent("download"), clicks.locator("#save").click()]);
    const order = {method: "POST", headers: {"Content-Type": "application/json"}, body: "{}"};
    const reached = await clicks.evaluate(what => fetch("../../../stop", what).then(() => true, () => false), order);
    assert.equal(reached, false);
    await clicks.close();
    // What it saved goes to the step.
    await download.saveAs(at("place (1).clicks"));  // as a browser names what it saves again
    await page.getByLabel("learn with my clicks").check();
    await page.locator("[id='colours--clicks-pick']").setInputFiles(at("place (1).clicks"));
    await says("#command", /'--clicks=out\/own_robot\/mine\/page\/files\/place 1\.clicks'/);
    assert.equal(readFileSync(at("out/own_robot/mine/page/files/place 1.clicks"), "utf8"), "floor 1.ppm 3 4\n");
  },

  async "fits a telephone and the keyboard, dark and light"() {
    await page.locator("#theme").click();
    assert.equal(await page.locator("html").getAttribute("data-theme"), "light");
    await accessible("light");
    await page.setViewportSize({width: 390, height: 800});
    for (const step of ["start", "lens", "body", "drive", "localize"]) {
      await show(step);
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), `${step} is wider than the page`);
      await accessible(`narrow ${step}`);
    }
    await picture("narrow");
    await page.locator("[data-step=devices]").focus();
    await page.keyboard.press("Enter");
    program("list_devices", "echo by keyboard\n");
    await page.locator("#start").focus();
    await page.keyboard.press("Enter");
    await says("#log", /by keyboard/);
    assert.ok(await page.evaluate(() => document.activeElement !== document.body), "the focus stays");
  },

  async "says that its server has ended"() {
    await ended();
    await says("#gone", /server has ended.*scripts\/own_robot mine page starts it again/);
    errors.splice(0);  // the browser's own, of a server that is gone
    await page.close();
    await open(await serve());
    await show("devices");
    await says("#log", /by keyboard/);
  },
};

let failed = 0;
try {
  await open(await serve());
  for (const [name, part] of Object.entries(parts)) {
    await part();
    assert.deepEqual(errors, [], name);
    console.log(`ok: ${name}`);
  }
} catch (error) {
  failed = 1;
  console.log(error);
  const seen = join(tmpdir(), "own_robot_page_failed.png");
  await page?.screenshot({path: seen}).then(() => console.log(`picture: ${seen}`)).catch(() => {});
} finally {
  await browser.close();
  await ended();
  assert.ok(existsSync(root));
  rmSync(root, {recursive: true});
}
process.exit(failed);
