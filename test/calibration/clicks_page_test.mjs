// The page of `learn_palette --show` in a browser: clicks become a file that learn_palette reads.
// node clicks_page_test.mjs LEARN_PALETTE GUI_FOLDER CHROMIUM
import assert from "node:assert/strict";
import {execFileSync} from "node:child_process";
import {mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync} from "node:fs";
import {createRequire} from "node:module";
import {tmpdir} from "node:os";
import {join} from "node:path";

const [program, gui, executablePath] = process.argv.slice(2);
const {chromium} = createRequire(join(gui, "package.json"))("playwright-core");
const folder = mkdtempSync(join(tmpdir(), "avm-clicks-"));
const learn = (...more) => JSON.parse(execFileSync(program,
  ["--images", join(folder, "images"), "--out", join(folder, "place.palette"), "--show", join(folder, "shown"), ...more],
  {encoding: "utf8"}).trim().split("\n").at(-1));

/** Four images of 320 x 240: above a yellow wall, below a grey floor. */
mkdirSync(join(folder, "images"));
for (let i = 0; i < 4; ++i) {
  const pixels = Buffer.alloc(320 * 240 * 3, 60);
  for (let at = 0; at < 320 * (100 + 5 * i); ++at) pixels.set([220, 200, 90], 3 * at);
  writeFileSync(join(folder, "images", `${i}.ppm`), Buffer.concat([Buffer.from("P6\n320 240\n255\n"), pixels]));
}

const browser = await chromium.launch({executablePath, args: ["--no-sandbox", "--disable-gpu"]});
const page = await browser.newPage(), errors = [];
page.on("pageerror", error => errors.push(error.stack));
await page.goto(`file://${learn().page}`);
const image = page.locator("img[alt='1.ppm']");
await image.click({position: {x: 100, y: 50}});
assert.match(await page.locator("#note").textContent(), /Type a name first/);
for (const [name, y] of [["hall_wall", 50], ["oops", 60], ["ground", 200]]) {
  await page.locator("#name").fill(name);
  await image.click({position: {x: 100, y}});
}
assert.equal(await page.locator("figure i").count(), 3);
await page.locator("#clicks li:has-text('oops') button").click();
const swatch = await page.locator("#clicks li b").first().evaluate(b => getComputedStyle(b).backgroundColor);
swatch.match(/\d+/g).forEach((value, k) => assert.ok(Math.abs(value - [220, 200, 90][k]) < 12, swatch));
const [download] = await Promise.all([page.waitForEvent("download"), page.locator("#save").click()]);
const clicks = join(folder, "place.clicks");
await download.saveAs(clicks);
assert.equal(readFileSync(clicks, "utf8"), "hall_wall 1.ppm 100 50\nground 1.ppm 100 200\n");
assert.deepEqual(learn("--clicks", clicks).classes.map(one => one.name).sort(), ["ground", "hall_wall"]);
// The next page goes on with them.
await page.reload();
await page.waitForSelector("figure i");
assert.equal(await page.locator("#clicks li").count(), 2);
assert.deepEqual(errors, []);
await browser.close();
rmSync(folder, {recursive: true});
