// Joins Ice's runtime and what slice2js makes of our Slice files into one module, "virtual:slice".
//
// Generated 3.7 code is a function over globals (Ice._require), not a module; npm's `ice` has the runtime, and the router Glacier2, in the
// same form.
// The export is called IceRuntime because a constant named Ice would hide the global that generated code uses.
import {execFileSync} from "node:child_process";
import {existsSync, readFileSync, readdirSync} from "node:fs";
import {join} from "node:path";
import type {Plugin} from "vite";

const virtualName = "virtual:slice";

/** Files of a folder tree of Slice files, each after those that it includes; as "avm/common.ice". */
export function sliceFilesInOrder(root: string): string[] {
  const ordered: string[] = [];
  const visit = (file: string) => {
    if (ordered.includes(file)) return;
    const text = readFileSync(join(root, file), "utf8");
    for (const [, included] of text.matchAll(/^\s*#include\s*[<"]([^>"]+)[>"]/gm)) {
      if (existsSync(join(root, included))) visit(included);
    }
    ordered.push(file);
  };
  for (const folder of ["jderobot", "avm"]) {
    for (const name of readdirSync(join(root, folder)).sort()) {
      if (name.endsWith(".ice")) visit(`${folder}/${name}`);
    }
  }
  return ordered;
}

/** The module's text. `slice2js` is Debian's program: the one of npm has no interpreter line and fails as a command. */
export function sliceModule(root: string, slice2js: string, iceRuntime: string, glacier2: string): string {
  const generated = sliceFilesInOrder(root).map(file =>
    execFileSync(slice2js, ["--stdout", `-I${root}`, join(root, file)], {encoding: "utf8"}));
  return [readFileSync(iceRuntime, "utf8"), readFileSync(glacier2, "utf8"), ...generated,
    "const IceRuntime = globalThis.Ice; const avmModule = globalThis.avm; const jderobotModule = globalThis.jderobot;",
    "const Glacier2Module = globalThis.Glacier2;",
    "export {IceRuntime, Glacier2Module, avmModule, jderobotModule};"].join("\n");
}

export function slice(options: {root: string; slice2js: string; iceRuntime: string; glacier2: string}): Plugin {
  return {
    name: "slice",
    resolveId: id => id === virtualName ? `\0${virtualName}` : undefined,
    load: id => id === `\0${virtualName}` ? sliceModule(options.root, options.slice2js, options.iceRuntime, options.glacier2) : undefined,
  };
}
