// The page in a real browser on real components: node page_test.mjs [PART...]; without names all parts.
// AVM_PICTURES: folder for the pictures of docs/gui.md. AVM_GUI_LONG=1: whole runs with the limits of an idle machine.
import {join} from "node:path";
import {drive, gaze, pose} from "./parts/actions.mjs";
import {blindness, odometryLost, wrongMap} from "./parts/causes.mjs";
import {crowd} from "./parts/crowd.mjs";
import {gateway} from "./parts/gateway.mjs";
import {recording, replay} from "./parts/recording.mjs";
import {foreign, loss, viewer} from "./parts/safety.mjs";
import {bundle, keyboard, looks, numbers, panes, rates, tablet, timeTravel} from "./parts/views.mjs";
import {browser, pictures} from "./support/page.mjs";
import {Robot} from "./support/robot.mjs";

const shared = {looks, panes, numbers, tablet, rates, gaze, drive, pose, timeTravel, keyboard, bundle, foreign, blindness, crowd, loss};
const own = {viewer, gateway, wrongMap, odometryLost, recording, replay};
const wanted = process.argv.slice(2), chosen = name => wanted.length === 0 || wanted.includes(name);
let failed = 0;

async function run(name, part, robot) {
  const begin = Date.now();
  try {
    await part(robot);
    console.log(`ok ${name} (${((Date.now() - begin) / 1000).toFixed(1)} s)`);
  } catch (failure) {
    ++failed;
    console.log(`FAILED ${name}: ${failure.stack ?? failure}`);
    for (const context of browser.contexts()) {
      for (const page of context.pages()) await page.screenshot({path: join(pictures, `failed_${name}.png`)}).catch(() => {});
      await context.close();
    }
  }
}

if (Object.keys(shared).some(chosen)) {
  const robot = await Robot.start();
  for (const [name, part] of Object.entries(shared)) if (chosen(name)) await run(name, part, robot);
  await robot.stop();
}
for (const [name, part] of Object.entries(own)) if (chosen(name)) await run(name, part);
await browser.close();
console.log(failed === 0 ? "all parts passed" : `${failed} parts failed; pictures in ${pictures}`);
process.exit(failed === 0 ? 0 : 1);
