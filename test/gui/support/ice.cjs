// Ice for the tests' own clients, in Node over tcp: generated from the same Slice files as the page's.
const {execFileSync} = require("node:child_process");
const {mkdirSync, readdirSync} = require("node:fs");
const {createRequire, Module} = require("node:module");
const {join} = require("node:path");

/** @param gui the folder components/gui. @param interfaces the folder of Slice files. @param out where generated files go. */
exports.load = function load(gui, interfaces, out, slice2js = "/usr/bin/slice2js") {
  for (const folder of ["jderobot", "avm"]) {
    mkdirSync(join(out, folder), {recursive: true});
    const files = readdirSync(join(interfaces, folder)).filter(n => n.endsWith(".ice")).map(n => join(interfaces, folder, n));
    execFileSync(slice2js, [`-I${interfaces}`, "--output-dir", join(out, folder), ...files]);
  }
  // Generated files require("avm/common") and require("ice").
  process.env.NODE_PATH = [out, join(gui, "node_modules")].join(":");
  Module._initPaths();
  const here = createRequire(join(out, "index.js"));
  const {Ice} = here("ice");
  let avm;
  for (const name of readdirSync(join(out, "avm"))) ({avm} = here(join(out, "avm", name)));
  return {Ice, avm};
};
