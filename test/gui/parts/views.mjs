// Views: layout, accessibility, every pane, rates, time travel, keyboard, size.
import assert from "node:assert/strict";
import {readFileSync} from "node:fs";
import {createRequire} from "node:module";
import {join} from "node:path";
import {avm, eventually, gui, hashOf, Ice, sleep} from "../support/robot.mjs";
import {driven, loadText, longRun, median, openPage, pictures, setTool, showPane, text, waitForVideo} from "../support/page.mjs";

const axe = readFileSync(createRequire(join(gui, "package.json")).resolve("axe-core/axe.min.js"), "utf8");

export async function looks(robot) {
  await begins(robot);
  const page = await openPage(robot);
  await waitForVideo(page);
  await driven(robot, 0.25, 0, () => sleep(9000));
  for (const [preset, theme] of [["watch", "dark"], ["tune", "dark"], ["replay", "dark"], ["watch", "light"]]) {
    await page.locator(`.presets button:has-text("${preset}")`).click();
    await page.evaluate(theme => { if (document.documentElement.dataset.theme !== theme) [...document.querySelectorAll("button")].find(b => b.textContent === "theme").click(); }, theme);
    for (const [width, height] of [[1280, 800], [1024, 768]]) {
      await page.setViewportSize({width, height});
      await sleep(900);
      await checkLayout(page, `${preset} ${theme} ${width}x${height}`);
      if (width === 1280 || preset === "watch") await page.screenshot({path: join(pictures, `${preset}${theme === "dark" ? "" : `_${theme}`}${width === 1280 ? "" : `_${width}`}.png`)});
    }
    await checkAccessible(page, `${preset} ${theme}`);
  }
  page.checkErrors();
  await page.context().close();
}

/** From navigation to the first image, and until every view of the page has something of the robot. */
async function begins(robot) {
  const firsts = [], wholes = [];
  for (let run = 0; run < 3; ++run) {
    const page = await openPage(robot, {before: noteBeginning});
    const {image, whole} = await eventually("every view", () => page.evaluate(() => globalThis.began.whole > 0 && globalThis.began), 20_000);
    firsts.push(Math.round(image));
    wholes.push(Math.round(whole));
    page.checkErrors();
    await page.context().close();
  }
  console.log(`  first image ${firsts.join(", ")} ms, every view ${wholes.join(", ")} ms after navigation, ${loadText()}`);
  if (!longRun) return;
  assert.ok(median(firsts) <= 1500, `first image after ${median(firsts)} ms`);
  assert.ok(median(wholes) <= 2000, `every view after ${median(wholes)} ms`);
}

/** Runs in the page: looks with each frame, notes milliseconds since the navigation. */
function noteBeginning() {
  const began = globalThis.began = {image: 0, whole: 0}, text = selector => document.querySelector(selector)?.textContent ?? "";
  const views = [() => began.image > 0, () => /\d+ segments/.test(text(".stage .stamp")) && Number(document.querySelector(".world-canvas")?.dataset.renders ?? 0) > 0, () => text(".pane-why .verdict") !== "",
    () => /[\d.]+ ?[\d.]*$/.test(text(".plot figcaption")), () => /holds/.test(text(".time-bar")), () => /all running/.test(text(".problems"))];
  const look = () => {
    if (began.image === 0 && /\d fps/.test(text(".top-bar .link"))) began.image = performance.now();
    if (views.every(shown => shown())) began.whole = performance.now();
    else requestAnimationFrame(look);
  };
  requestAnimationFrame(look);
}

/** Nothing overlaps: bars, groups and controls of one toolbar lie beside each other, inside the page. */
async function checkLayout(page, what) {
  // After a change of size the panes take their places within some frames.
  let problems = [];
  await eventually(`no overlap: ${what}`, async () => (problems = await layoutProblems(page)).length === 0, 4000, 200).catch(() => {});
  assert.deepEqual(problems, [], what);
}

function layoutProblems(page) {
  return page.evaluate(() => {
    const found = [], box = e => e.getBoundingClientRect(), name = e => `${e.className} ${e.textContent.slice(0, 20)}`;
    const overlap = (a, b) => Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1 && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 1;
    const sets = [[...document.querySelectorAll(".top-bar, .dock, .time-bar")], [...document.querySelectorAll(".dv-groupview")], [...document.querySelector(".top-bar").children],
      [...document.querySelector(".time-bar").children], ...[...document.querySelectorAll(".setting")].map(s => [...s.children]), ...[...document.querySelectorAll(".toolbar")].map(t => [...t.children])];
    const canvas = document.querySelector(".world-canvas");
    if (canvas.clientWidth > 0 && Math.abs(canvas.width / canvas.height - canvas.clientWidth / canvas.clientHeight) > 0.05) found.push(`the scene of ${canvas.width}x${canvas.height} is drawn into ${canvas.clientWidth}x${canvas.clientHeight}`);
    for (const set of sets) {
      const shown = set.filter(e => box(e).width > 0 && box(e).height > 0 && getComputedStyle(e).visibility !== "hidden");
      shown.forEach((a, i) => shown.slice(i + 1).forEach(b => { if (overlap(box(a), box(b))) found.push(`${name(a)} over ${name(b)}`); }));
      for (const e of shown) if (!e.closest(".scroll") && (box(e).right > innerWidth + 1 || box(e).bottom > innerHeight + 1)) found.push(`${name(e)} leaves the page`);
    }
    return found;
  });
}

/** A tablet held either way, and a telephone: controls are large enough for fingers, and nothing overlaps. */
export async function tablet(robot) {
  for (const [width, height] of [[1024, 768], [768, 1024], [390, 844], [844, 390]]) {
    const page = await openPage(robot, {width, height, touch: true});
    await waitForVideo(page);
    for (const preset of ["watch", "tune", "replay"]) {
      await page.locator(`.presets button:has-text("${preset}")`).tap();
      await sleep(700);
      await checkLayout(page, `tablet ${preset} ${width}x${height}`);
    }
    const small = await page.evaluate(() => [...document.querySelectorAll(".top-bar .button, .time-bar .button, .toolbar .button, .dv-tab")].filter(e => e.offsetHeight > 0 && e.offsetHeight < 44).map(e => e.textContent));
    assert.deepEqual(small, [], "controls of less than 44 px");
    await page.locator(".presets button:has-text('watch')").tap();
    await sleep(500);
    const seen = await page.locator(".pane-camera .canvas-frame").evaluate(e => e.clientHeight);
    assert.ok(seen > 80, `the picture has ${seen} pixels of ${width}x${height}`);
    await page.screenshot({path: join(pictures, `tablet_${width}.png`)});
    for (const menu of ["panes", "layers"]) {
      const summary = page.locator(`summary:text-is("${menu}")`).first();
      await summary.tap();
      const [left, right] = await page.locator(".menu[open] .menu-list").evaluate(e => [e.getBoundingClientRect().left, innerWidth - e.getBoundingClientRect().right]);
      assert.ok(left >= 0 && right >= 0, `menu ${menu} leaves the page of ${width}x${height}: ${left}, ${right}`);
      await summary.tap();
    }
    await page.locator(".presets button:has-text('tune')").tap();
    const hidden = await eventually("parameters", () => page.evaluate(() => {
      const list = document.querySelector(".pane-settings .scroll");
      return list.querySelector(".setting") && [list.scrollWidth - list.clientWidth];
    }));
    assert.deepEqual(hidden, [0], `pixels of the parameters that do not fit ${width}x${height}`);
    page.checkErrors();
    await page.context().close();
  }
}

async function checkAccessible(page, what) {
  await page.evaluate(axe);
  const {violations} = await page.evaluate(() => globalThis.axe.run(document, {runOnly: ["wcag2a", "wcag2aa", "wcag21aa", "wcag22aa"]}));
  const serious = violations.filter(v => v.impact === "serious" || v.impact === "critical").map(v => `${v.id}: ${v.nodes.slice(0, 4).map(n => `${n.html.slice(0, 140)} ${n.failureSummary.slice(0, 160)}`).join(" | ")}`);
  assert.deepEqual(serious, [], what);
}

export async function panes(robot) {
  const page = await openPage(robot);
  await waitForVideo(page);
  await driven(robot, 0.2, 0.1, async () => {
    await sleep(4000);
    for (const title of ["attention", "drive", "actions", "why"]) {
      await showPane(page, title);
      await sleep(700);
      await page.locator(`.pane-${title}`).screenshot({path: join(pictures, `${title}.png`)});
    }
    await checkSelection(page);
    for (const title of ["components", "log", "settings", "plots"]) {
      await showPane(page, title);
      await sleep(1300);
      if (title === "components") await page.locator(".component summary").nth(1).click();
      await sleep(200);
      await page.locator(`.pane-${title}`).screenshot({path: join(pictures, `${title}.png`)});
    }
  });
  await checkConfiguration(page);
  await checkSimulation(page, robot);
  assert.match(await text(page, ".plot figcaption"), /error [\d.]+/, "the plot of the position error has values");
  await showPane(page, "log");
  assert.match(await text(page, ".log"), /configuration/, "the log of the components");
  await showPane(page, "settings");
  await checkSetting(page, robot);
  await showPane(page, "why");
  await page.locator(".pane-why button:has-text('show')").click();
  await eventually("health map", async () => /fits best at [-\d., ]+ m: 0\.\d+, the share of what is seen/.test(await page.locator(".pane-why .note").textContent()), 30_000);
  await sleep(500);
  await page.locator(".pane-world").screenshot({path: join(pictures, "health_map.png")});
  await page.locator(".pane-why button:has-text('clear')").click();
  await page.locator("select[aria-label='colour of segments']").selectOption("label");
  await checkMeasuring(page);
  await page.locator(".pane-world summary:has-text('layers')").click();
  await eventually("the legend names the labels", async () => /skirting/.test(await text(page, ".legend")));
  await page.locator(".pane-world").screenshot({path: join(pictures, "legend.png")});
  page.checkErrors();
  await page.context().close();
}

/** Any number becomes a plot that outlives the page, all of them a table, and what a browser keeps goes to another one as a file. */
export async function numbers(robot) {
  const page = await openPage(robot);
  await waitForVideo(page);
  const gauge = "memory mount pitch error (deg)", plot = p => p.locator(`.plot[aria-label='components: ${gauge} over time']`);
  const chooser = page.locator("select[aria-label='plot one more number']");
  await eventually("the gauge is offered", () => chooser.locator(`option:text-is("${gauge}")`).count());
  await chooser.selectOption({label: gauge});
  await chooser.selectOption({label: "x (m)"});
  await page.locator(".plot[aria-label='robot: x (m) over time'] .close").click();
  await page.reload();
  await waitForVideo(page);
  assert.equal(await page.locator(".plot .close").count(), 1, "one of the two was removed");
  await eventually("the plot has a value after the page came again", async () => /error \(deg\)-?[\d.]+/.test(await plot(page).locator("figcaption").textContent()));
  const table = await saved(page, page.getByRole("button", {name: "save CSV"}));
  const [head, ...rows] = table.trimEnd().split("\n").map(line => line.split(",")), at = head.indexOf(`components: ${gauge}`), gauges = (await robot.proxy("Component", "active_visual_memory/component", 9970).getStatus()).gauges;
  assert.ok(rows.every(r => r.length === head.length) && Math.abs(Date.parse(rows.at(-1)[0]) - Date.now()) < 20_000, table.slice(0, 500));
  const last = Number(rows.findLast(r => r[at] !== "")[at]), now = gauges.find(g => g.name === "mount pitch error").value;
  assert.ok(Math.abs(last - now) < 0.5, `the table's ${last}, the component's ${now}`);
  await page.locator("summary:has-text('panes')").click();
  const kept = await saved(page, page.getByRole("button", {name: "save as a file"}));
  page.checkErrors();
  await page.context().close();
  const other = await openPage(robot);
  for (const [content, wanted] of [["{}", /has no arrangement/], [kept, null]]) {
    await other.locator("summary:has-text('panes')").click();
    const [asked] = await Promise.all([other.waitForEvent("filechooser"), other.getByRole("button", {name: "load a file"}).click()]);
    await asked.setFiles({name: "page.json", mimeType: "application/json", buffer: Buffer.from(content)});
    if (wanted) await eventually("a wrong file is refused", async () => wanted.test(await text(other, ".notice")));
    else await eventually("the other browser has the plot", () => plot(other).count());
    if (wanted) await other.locator("summary:has-text('panes')").click();
  }
  other.checkErrors();
  await other.context().close();
}

async function saved(page, button) {
  const [download] = await Promise.all([page.waitForEvent("download"), button.click()]);
  return readFileSync(await download.path(), "utf8");
}

/** The table of keys is in view once it was asked for. */
async function checkConfiguration(page) {
  await showPane(page, "components");
  await page.locator(".component button:has-text('configuration')").nth(1).click();
  const title = page.locator(".configuration b");
  await eventually("the configuration is in view", async () => {
    const box = await title.boundingBox(), pane = await page.locator(".pane-components").boundingBox();
    return box !== null && box.y >= pane.y && box.y + box.height <= pane.y + pane.height;
  });
  await page.locator(".configuration button:has-text('close')").click();
}

/** The controls of the simulation show what holds, whoever set it. */
async function checkSimulation(page, robot) {
  await showPane(page, "actions");
  const speed = page.locator("select[aria-label='simulated seconds per second']");
  await page.locator("button:text-is('step 0.1 s')").click();
  await eventually("a refused command is not said to be done", async () => /^NOT DONE: 0.1 s simulated \(.*pause it first/.test(await text(page, ".notice")));
  for (const value of [0.75, 1]) {
    await robot.simulation.setSpeed(value);
    await eventually(`speed ${value}`, async () => await speed.inputValue() === String(value));
  }
}

/** A drag across the top view measures what its scale bar says; Escape drops it, another tool as well. */
async function checkMeasuring(page) {
  await setTool(page, "measure");
  const box = await page.locator(".viewport").nth(1).boundingBox(), bar = page.locator(".scale-bar"), measured = page.locator(".measure");
  const metresPerPixel = parseFloat(await bar.textContent()) / await bar.evaluate(e => parseFloat(e.style.width));
  await page.mouse.move(box.x + box.width * 0.3, box.y + box.height * 0.5);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width * 0.7, box.y + box.height * 0.5, {steps: 4});
  await page.mouse.up();
  const [length, angle] = (await measured.textContent()).match(/-?[\d.]+/g).map(Number), expected = 0.4 * box.width * metresPerPixel;
  // Each end may be caught by a line's within 8 pixels.
  assert.ok(Math.abs(length - expected) <= 16 * metresPerPixel, `${length} m instead of ${expected} m`);
  assert.ok(Math.abs(angle) <= 16 / (0.4 * box.width) * 57.3 + 0.1, `${angle} deg`);
  await page.screenshot({path: join(pictures, "measure.png")});
  await page.keyboard.press("Escape");
  assert.equal(await measured.isVisible(), false, "Escape drops it");
  await setTool(page, "select");
}

/** Clicking a segment of the top view shows all that is known of it. */
async function checkSelection(page) {
  await showPane(page, "details");
  const box = await page.locator(".viewport").nth(1).boundingBox();
  let kind = "";
  for (let k = 0; k < 60 && !/segment/.test(kind); ++k) {
    await page.mouse.click(box.x + box.width * (0.1 + 0.8 * ((k * 7) % 60) / 60), box.y + box.height * (0.15 + 0.7 * k / 60));
    await sleep(60);
    kind = await text(page, ".pane-details .toolbar b");
  }
  assert.match(kind, /segment \d+|map \d+|attention|race/, "something was selected");
  await sleep(1300);
  await page.locator(".pane-details").screenshot({path: join(pictures, "details.png")});
}

async function checkSetting(page, robot) {
  const field = await eventually("parameters", async () => await page.locator("input[type=number][aria-label^='Overlay.Rate_hz']").count() > 0 && page.locator("input[type=number][aria-label^='Overlay.Rate_hz']"));
  const component = robot.proxy("Component", "active_visual_memory/component", 9970);
  const parameters = await component.parameters(), configured = parameters.find(p => p.name === "Overlay.Rate_hz").value;
  // Another parameter is changed behind the page's back: its row says when the page has read again.
  const other = parameters.find(p => p.name === "Vision.MinimumLength_px"), row = page.locator(".setting", {has: page.getByText(other.name, {exact: true})});
  await field.fill("7");
  await component.setParameter(other.name, other.value + 1);
  await page.getByRole("button", {name: "read again"}).click();
  await eventually("the page has read again", async () => Number(await row.locator("input[type=number]").inputValue()) === other.value + 1);
  assert.equal(await field.inputValue(), "7", "reading again keeps a value that is being typed");
  await component.setParameter(other.name, other.value);
  await field.press("Enter");
  const rate = async () => (await component.parameters()).find(p => p.name === "Overlay.Rate_hz").value;
  await eventually("the component has the value", async () => await rate() === 7);
  await field.fill("100000");
  await field.press("Enter");
  await eventually("a refused value gives way to the component's", async () => await field.inputValue() === "7");
  assert.equal(await rate(), 7);
  await page.locator(".setting", {has: field}).getByRole("button", {name: "undo"}).click();
  await eventually("undo shows the configured value", async () => await field.inputValue() === String(configured));
}

/** Video and scene rates: printed, and held to half of what the issue asks for unless the long run is asked for. */
export async function rates(robot) {
  const page = await openPage(robot), video = [], scene = [], seconds = longRun ? 20 : 6;
  await waitForVideo(page);
  await driven(robot, 0.2, 0.1, async () => {
    for (let run = 0; run < 3; ++run) {
      const count = () => page.evaluate(() => Number(document.querySelector(".world-canvas").dataset.renders));
      const before = await count(), fps = [], begin = Date.now();
      while (Date.now() - begin < seconds * 1000) {
        await sleep(1000);
        fps.push(Number((await text(page, ".top-bar .link")).match(/(\d+)(?: of \d+)? fps/)?.[1] ?? 0));
      }
      scene.push((await count() - before) / ((Date.now() - begin) / 1000));
      video.push(median(fps));
    }
  });
  console.log(`  video ${video.join(", ")} fps, scene ${scene.map(s => s.toFixed(1)).join(", ")} Hz in runs of ${seconds} s, ${loadText()}`);
  if (longRun) {
    assert.ok(median(video) >= 25, `${median(video)} fps`);
    assert.ok(median(scene) >= 10, `${median(scene)} Hz`);
  } else {
    assert.ok(median(video) > 5 && median(scene) > 2, "pictures and scene go on");
  }
  page.checkErrors();
  await page.context().close();
}

/** A moment of the past: the image is the one that the camera gave with that stamp, pose and segments are of that time. */
export async function timeTravel(robot) {
  const page = await openPage(robot), seen = new Map();
  await waitForVideo(page);
  await driven(robot, 0.2, 0.2, async () => {
    const end = Date.now() + 6000;
    let frame = new Ice.Long(0xffffffff, 0xffffffff), revision = new Ice.Long(0, 0);
    const images = (async () => { while (Date.now() < end) { const r = await robot.camera.getNext("JPEG", frame); if (r.state === avm.SourceState.Running) { frame = r.image.seq; seen.set(`image ${r.image.stampUs.toNumber()}`, hashOf(r.image.pixels)); } } })();
    while (Date.now() < end) {
      const {state, update} = await robot.memory.next(revision);
      if (state !== avm.SourceState.Running) continue;
      revision = update.snapshot.revision;
      seen.set(`memory ${update.snapshot.stampUs.toNumber()}`, {n: update.snapshot.segments.length, pose: update.snapshot.robotInOdom});
    }
    await images;
  });
  await page.locator(".time-bar button:has-text('pause')").click();
  let compared = 0;
  // On a busy machine it takes some steps to get back to where this test was looking.
  for (let k = 0; k < 20 && compared < 6; ++k) {
    await page.locator(".time-bar button:has-text('-1')").click();
    await sleep(700);
    const moment = await page.evaluate(() => { const m = globalThis.avmPage.moment(); return {live: m.live, frame: m.frame, memory: m.memory && {stampUs: m.memory.stampUs, n: m.memory.ids.length, pose: m.memory.robot}}; });
    assert.equal(moment.live, false);
    const image = seen.get(`image ${moment.frame.stampUs}`), memory = seen.get(`memory ${moment.memory.stampUs}`);
    if (image !== undefined) { assert.equal(moment.frame.hash, image, "the image of that stamp"); ++compared; }
    if (memory !== undefined) {
      assert.equal(moment.memory.n, memory.n);
      assert.deepEqual(moment.memory.pose, {x: memory.pose.x, y: memory.pose.y, theta: memory.pose.theta});
      ++compared;
    }
  }
  assert.ok(compared >= 3, `${compared} moments compared`);
  assert.match(await text(page, ".mode"), /PAST/);
  await page.screenshot({path: join(pictures, "past.png")});
  await page.locator(".time-bar button:has-text('live')").click();
  await eventually("live again", async () => /LIVE/.test(await text(page, ".mode")));
  // Numbers went on while the past was shown.
  await showPane(page, "plots");
  const [head, ...rows] = (await saved(page, page.getByRole("button", {name: "save CSV"}))).trimEnd().split("\n").map(line => line.split(",")), at = head.indexOf("robot: x (m)");
  const times = rows.filter(r => r[at] !== "").map(r => Date.parse(r[0])), gap = Math.max(...times.slice(1).map((t, i) => t - times[i]));
  assert.ok(gap < 2500, `the numbers have a gap of ${gap} ms`);
  page.checkErrors();
  await page.context().close();
}

/** The keyboard alone: tabs, overlays, presets, driving. */
export async function keyboard(robot) {
  const page = await openPage(robot);
  await waitForVideo(page);
  const reached = new Set();
  for (let i = 0; i < 90; ++i) {
    await page.keyboard.press("Tab");
    reached.add(await page.evaluate(() => { const e = document.activeElement; return `${e.getAttribute("role") ?? e.tagName.toLowerCase()}:${(e.getAttribute("aria-label") ?? e.textContent ?? "").slice(0, 30)}`; }));
  }
  for (const wanted of [/STOP/, /watch/, /panes/, /theme/, /observed/, /tab:/, /3-D scene/, /map from above/, /moment shown/, /pause/])
    assert.ok([...reached].some(r => wanted.test(r)), `Tab reaches ${wanted}: ${[...reached].join("; ")}`);
  await page.keyboard.press("p");
  await eventually("P pauses", async () => /PAST/.test(await text(page, ".mode")));
  await page.keyboard.press("l");
  await eventually("L goes live", async () => /LIVE/.test(await text(page, ".mode")));
  page.checkErrors();
  await page.context().close();
}

/** Bytes that the browser fetches, compressed. */
export async function bundle(robot) {
  const {gzipSync} = await import("node:zlib");
  const page = await openPage(robot);
  await waitForVideo(page);
  const names = await page.evaluate(() => performance.getEntriesByType("resource").map(r => r.name));
  let total = 0;
  for (const name of new Set([...names.filter(n => n.startsWith(robot.url) && !n.endsWith(".json")), robot.url])) total += gzipSync(Buffer.from(await (await fetch(name)).arrayBuffer()), {level: 9}).length;
  const worker = await page.evaluate(() => performance.getEntriesByType("resource").some(r => r.name.includes("worker")));
  if (!worker) for (const match of (await (await fetch(names.find(n => /index.*js$/.test(n)))).text()).matchAll(/worker-[\w-]+\.js/g)) { total += gzipSync(Buffer.from(await (await fetch(`${robot.url}assets/${match[0]}`)).arrayBuffer()), {level: 9}).length; break; }
  console.log(`  ${Math.round(total / 1000)} kB compressed`);
  assert.ok(total < 500_000, `${total} bytes`);
  await page.context().close();
}
