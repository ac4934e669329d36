// Bundles the page's unit tests, which are TypeScript, and runs them: node run_unit.mjs GUI_FOLDER OUT_FOLDER
import {spawnSync} from "node:child_process";
import {readdirSync} from "node:fs";
import {createRequire} from "node:module";
import {dirname, join, resolve} from "node:path";
import {fileURLToPath} from "node:url";

const [gui, out] = process.argv.slice(2).map(path => resolve(path));
const unit = join(dirname(fileURLToPath(import.meta.url)), "unit");
const esbuild = createRequire(join(gui, "package.json"))("esbuild");
const tests = readdirSync(unit).filter(name => name.endsWith(".test.ts"));
await esbuild.build({
  entryPoints: tests.map(name => join(unit, name)), outdir: out, outExtension: {".js": ".mjs"}, bundle: true, platform: "node", format: "esm", target: "node18",
  external: ["node:*"], nodePaths: [join(gui, "node_modules")], alias: {"@gui": join(gui, "src")}, logLevel: "warning",
});
const result = spawnSync(process.execPath, ["--test", ...tests.map(name => join(out, name.replace(/\.ts$/, ".mjs")))], {stdio: "inherit"});
process.exit(result.status ?? 1);
