// The page through the gateway of deploy/gateway, over wss with a certificate that the browser checks: as an operator and as a viewer.
import assert from "node:assert/strict";
import {execFileSync, spawn} from "node:child_process";
import {mkdirSync, mkdtempSync, rmSync} from "node:fs";
import {createRequire} from "node:module";
import {loadavg, tmpdir} from "node:os";
import {join} from "node:path";
import {loadText, longRun, text, waitForVideo} from "../support/page.mjs";
import {eventually, freePorts, gui, pages, Robot, root, sleep} from "../support/robot.mjs";

const {chromium} = createRequire(join(gui, "package.json"))("playwright-core");
const leastFps = 15;
const objects = {Camera: ["cameraA", 9999], Base: ["Motors", 9990], Odometry: ["Encoders", 9997], PanTilt: ["PanTilt", 9977], VisualMemory: ["VisualMemory", 9970],
  Gaze: ["Gaze", 9970], Localization: ["Localization", 9971], Simulation: ["Simulation", 9972]};
const components = {simulator: 9999, active_visual_memory: 9970, localization: 9971};

/** Files, processes and ports of a gateway in front of a robot. */
class Gateway {
  static async start(robot) {
    const gateway = new Gateway();
    gateway.robot = robot;
    gateway.folder = mkdtempSync(join(tmpdir(), "avm-gateway-"));
    const [access, ...ports] = await freePorts(7);
    gateway.ports = {access, operator: {ssl: ports[0], wss: ports[1], page: ports[2]}, viewer: {ssl: ports[3], wss: ports[4], page: ports[5]}};
    execFileSync(join(root, "deploy/pki/certificates"), [gateway.folder, "make", "gateway", "gateway", "127.0.0.1"]);
    for (const [role, user] of [["operator", "ana"], ["viewer", "vera"]])
      execFileSync(join(root, "deploy/gateway/gateway_user"), [role, "add", user], {input: "open sesame\n", env: {...process.env, VISMEM_GATEWAY: gateway.folder}});
    // Where Chromium looks for authorities that its user trusts.
    const store = join(gateway.folder, ".pki/nssdb");
    mkdirSync(store, {recursive: true});
    execFileSync("certutil", ["-N", "--empty-password", "-d", `sql:${store}`]);
    execFileSync("certutil", ["-A", "-n", "vismem", "-t", "C,,", "-i", join(gateway.folder, "ca.pem"), "-d", `sql:${store}`]);
    robot.commands.gateway_access = ["--Ice.Config=deploy/gateway/gateway_access.cfg", `--GatewayAccess.Endpoints=tcp -h 127.0.0.1 -p ${access}`,
      `--GatewayAccess.Operators=${join(gateway.folder, "operators")}`, `--GatewayAccess.Viewers=${join(gateway.folder, "viewers")}`,
      `--GatewayAccess.Leased.Base.Proxy=Motors:tcp -h 127.0.0.1 -p ${robot.port(9990)}`,
      `--GatewayAccess.Leased.PanTilt.Proxy=PanTilt:tcp -h 127.0.0.1 -p ${robot.port(9977)}`];
    await robot.launch("gateway_access");
    gateway.routers = {operator: gateway.router("operator"), viewer: gateway.router("viewer")};
    return gateway;
  }

  router(role) {
    const {access} = this.ports, {ssl, wss} = this.ports[role];
    const reached = [...new Set(Object.values(objects).map(([, port]) => `127.0.0.1:${this.robot.port(port)}`))].join(" ");
    return spawn("glacier2router", [`--Ice.Config=${join(root, `deploy/gateway/${role}.cfg`)}`,
      `--Glacier2.Client.Endpoints=ssl -h 127.0.0.1 -p ${ssl}:wss -h 127.0.0.1 -p ${wss}`,
      `--Glacier2.PermissionsVerifier=${role}s:tcp -h 127.0.0.1 -p ${access}`, `--Glacier2.SessionManager=sessions:tcp -h 127.0.0.1 -p ${access}`,
      `--Glacier2.Filter.Address.Accept=${reached}`, `--IceSSL.DefaultDir=${this.folder}`], {stdio: "ignore"});
  }

  /** The server of the page of a role, on the person's machine. */
  async servePage(role) {
    const {wss, page} = this.ports[role], name = role === "viewer" ? "Viewer" : "Operator";
    const proxy = (identity, port) => `${identity}:tcp -h 127.0.0.1 -p ${this.robot.port(port)}`;
    this.robot.commands.gui_server = [`--GuiServer.Endpoints=tcp -h 127.0.0.1 -p 0`, `--GuiServer.Http.Endpoints=http -h 127.0.0.1 -p ${page}`,
      `--GuiServer.Pages=${pages}`, `--GuiServer.Setup=sim`, `--GuiServer.ReadOnly=${role === "viewer" ? "yes" : "no"}`,
      `--GuiServer.Gateway.Router=${name}/router:wss -h 127.0.0.1 -p ${wss}`,
      ...Object.entries(objects).map(([key, [identity, port]]) => `--GuiServer.${key}.Proxy=${proxy(identity, port)}`),
      ...Object.entries(components).map(([key, port]) => `--GuiServer.Components.${key}.Proxy=${proxy(`${key}/component`, port)}`)];
    await this.robot.launch("gui_server");
    return `http://127.0.0.1:${page}/`;
  }

  stop() {
    for (const router of Object.values(this.routers)) router.kill();
    rmSync(this.folder, {recursive: true, force: true});
  }
}

async function logIn(page, user, password) {
  await page.fill("form.login input[name=user]", user);
  await page.fill("form.login input[name=password]", password);
  await page.click("form.login button");
}

const showsVideo = words => /[1-9]\d*(\.\d+)? fps/.test(words);

/** Mean rate of the images that are drawn, over some seconds. */
async function fps(page) {
  const rates = [];
  for (let i = 0; i < 10; ++i) {
    await sleep(500);
    rates.push(Number((await text(page, ".top-bar .link")).match(/(\d+(?:\.\d+)?) fps/)?.[1] ?? 0));
  }
  return rates.reduce((a, b) => a + b, 0) / rates.length;
}

const refusalOf = (page, name, ...values) => page.evaluate(([n, v]) => globalThis.avmPage.call(n, ...v).then(() => "", error => error.message), [name, values]);

async function asOperator(gateway, browser) {
  const page = await browser.newPage();
  await page.goto(await gateway.servePage("operator"));
  await logIn(page, "vera", "open sesame");
  await eventually("a viewer is no operator", async () => /wrong user or password/.test(await text(page, "form.login [role=status]")));
  await logIn(page, "ana", "open sesame");
  await waitForVideo(page);
  await page.waitForSelector("form.login", {state: "hidden"});
  const rate = await fps(page);
  console.log(`  operator over wss: ${rate.toFixed(1)} fps (${loadText()})`);
  assert.equal(await refusalOf(page, "gazeMode", "Attend"), "");
  assert.equal(await refusalOf(page, "stop"), "");
  assert.equal(await refusalOf(page, "setParameter", "simulator", "Base.MaximumSpeed_mps", 0.5), "");
  // A router that starts again: the page opens a session by itself.
  gateway.routers.operator.kill();
  await eventually("the loss is shown", async () => !showsVideo(await text(page, ".top-bar .link")), 20_000);
  gateway.routers.operator = gateway.router("operator");
  await eventually("video again", async () => showsVideo(await text(page, ".top-bar .link")), 20_000);
  assert.equal(await refusalOf(page, "gazeMode", "Attend"), "");
  await page.close();
  gateway.robot.kill("gui_server", "SIGTERM");
  await gateway.robot.ended("gui_server");
  return rate;
}

async function asViewer(gateway, browser) {
  const page = await browser.newPage();
  await page.goto(await gateway.servePage("viewer"));
  await logIn(page, "vera", "open sesame");
  await waitForVideo(page);
  const rate = await fps(page);
  console.log(`  viewer over wss: ${rate.toFixed(1)} fps (${loadText()})`);
  const commands = [["gazeMode", "Hold"], ["relocalize"], ["setPose", {x: 1, y: 1, theta: 0}], ["resetMemory"], ["pauseSimulation", true], ["stop"],
    ["kidnap", {x: 5, y: 2.25, theta: 0}], ["setParameter", "simulator", "Base.MaximumSpeed_mps", 0.1]];
  for (const [name, ...values] of commands) assert.match(await refusalOf(page, name, ...values), /not allowed|has no base/, name);
  assert.equal(await refusalOf(page, "configuration", "simulator"), "", "a viewer reads");
  await page.close();
  return rate;
}

export async function gateway() {
  const robot = await Robot.start({without: ["gui_server"]});
  const front = await Gateway.start(robot);
  const browser = await chromium.launch({executablePath: process.env.AVM_CHROMIUM ?? "/usr/bin/chromium", args: ["--no-sandbox", "--disable-gpu"],
    env: {...process.env, HOME: front.folder}});
  try {
    const rates = [await asOperator(front, browser), await asViewer(front, browser)];
    // Processes that wait for others' turns draw fewer images: then only that the video flows.
    const least = longRun || loadavg()[0] < 3 ? leastFps : 1;
    for (const rate of rates) assert.ok(rate >= least, `${rate} fps (at least ${least})`);
  } finally {
    await browser.close();
    front.stop();
    await robot.stop();
  }
}
