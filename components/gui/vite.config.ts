import {readFileSync, writeFileSync} from "node:fs";
import {dirname, resolve} from "node:path";
import {fileURLToPath} from "node:url";
import {defineConfig} from "vite";
import {gzipSync} from "node:zlib";
import type {Plugin} from "vite";
import {slice} from "./slice_plugin";

const here = dirname(fileURLToPath(import.meta.url));
const slicePlugin = () => slice({
  root: process.env.AVM_INTERFACES ?? resolve(here, "../../interfaces"),
  slice2js: process.env.AVM_SLICE2JS ?? "/usr/bin/slice2js",
  iceRuntime: resolve(here, "node_modules/ice/lib/Ice.js"),
  glacier2: resolve(here, "node_modules/ice/lib/Glacier2.js"),
});

/** Writes FILE.gz beside each file: the server sends it as it is. */
const packed: Plugin = {
  name: "packed",
  writeBundle({dir}, bundle) {
    for (const name of Object.keys(bundle)) writeFileSync(resolve(dir!, `${name}.gz`), gzipSync(readFileSync(resolve(dir!, name)), {level: 9}));
  },
};

export default defineConfig({
  root: here,
  base: "./",
  plugins: [slicePlugin(), packed],
  // A worker is bundled by itself: the plug-in must be named there too.
  worker: {format: "es", plugins: () => [slicePlugin()]},
  build: {
    outDir: process.env.AVM_GUI_OUT ?? resolve(here, "../../build/gui"),
    emptyOutDir: true,
    target: "es2022",
    // The Content-Security-Policy allows no data: addresses.
    assetsInlineLimit: 0,
    chunkSizeWarningLimit: 1500,
    modulePreload: {polyfill: false},
  },
});
