// What all parts of the test of the page share: the browser, a page that fails on console errors, small actions.
import assert from "node:assert/strict";
import {mkdtempSync} from "node:fs";
import {createRequire} from "node:module";
import {loadavg, tmpdir} from "node:os";
import {join} from "node:path";
import {ensureFolder, eventually, gui} from "./robot.mjs";

const {chromium} = createRequire(join(gui, "package.json"))("playwright-core");
export const pictures = process.env.AVM_PICTURES ? ensureFolder(process.env.AVM_PICTURES) : mkdtempSync(join(tmpdir(), "avm-gui-pictures-"));
/** Whole runs with the limits, for a machine that does nothing else; otherwise short ones. */
export const longRun = process.env.AVM_GUI_LONG === "1";

export const browser = await chromium.launch({executablePath: process.env.AVM_CHROMIUM ?? "/usr/bin/chromium", args: ["--no-sandbox", "--disable-gpu"]});

/** A page of a robot, whose console errors fail the test. @param options.before runs in the page before its own scripts. */
export async function openPage(robot, {width = 1280, height = 800, theme = "dark", preset = "watch", touch = false, before} = {}) {
  const context = await browser.newContext({viewport: {width, height}, colorScheme: theme, hasTouch: touch});
  if (before) await context.addInitScript(before);
  const page = await context.newPage(), errors = [];
  page.on("console", message => { if (message.type() === "error") errors.push(message.text()); });
  page.on("pageerror", error => errors.push(error.stack));
  page.expected = [];
  page.checkErrors = () => assert.deepEqual(errors.filter(e => !page.expected.some(x => x.test(e))), [], "errors on the console");
  await page.goto(`${robot.url}#${preset}`);
  await page.waitForSelector(".world-canvas", {state: "attached"});
  return page;
}

export const text = (page, selector) => page.locator(selector).first().textContent();

export const showPane = (page, title) => page.locator(`.dv-tab:has-text("${title}")`).first().click();

export const setTool = (page, tool) => page.locator("select[aria-label='what a click does']").selectOption(tool);

/** Runs `drive` while the robot is driven from outside. */
export async function driven(robot, v, w, during) {
  const timer = setInterval(() => robot.base.setVelocity(v, w).catch(() => {}), 100);
  try { return await during(); } finally { clearInterval(timer); await robot.base.setVelocity(0, 0).catch(() => {}); }
}

export const median = values => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];

/** On a machine that is busy with other work processes wait for their turn. */
export function loadMargin() { return longRun ? 0 : Math.max(0, loadavg()[0] - 1) * 150; }

export const loadText = () => `load ${loadavg()[0].toFixed(1)}`;
export async function waitForVideo(page) {
  await eventually("video", async () => /\d fps/.test(await text(page, ".top-bar .link")), 15_000);
}
