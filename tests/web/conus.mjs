// SPDX-License-Identifier: BSD-3-Clause
// conus in node, as the page's worker has it.
import { execFileSync } from "node:child_process";
import fs from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";
import { pathToFileURL } from "node:url";

export const PAGE = process.env.PAGE;
export const CONUS = process.env.CONUS;
export const TEMPLATES = process.env.CONUS_TEMPLATES ?? "/usr/share/mricron/templates";
globalThis.require = createRequire(import.meta.url); // what emscripten's module asks for in node
globalThis.__dirname = PAGE;
const { default: create } = await import(pathToFileURL(path.join(PAGE, "conus.mjs")));

/** A new conus with functions by their names in web.c. */
export async function start() {
  const module = await create({ wasmBinary: fs.readFileSync(path.join(PAGE, "conus.wasm")), print() {}, printErr() {} });
  module.FS.mkdir("/atlas");
  const wrap = (name, result, count, type = "number") => module.cwrap(`web_${name}`, result, Array(count).fill(type));
  return { module, open: wrap("open", "string", 1, "string"), form: wrap("form", "string", 0), ask: module.cwrap("web_ask", "string", [...Array(6).fill("number"), "string"]), rows: wrap("rows", "string", 1), cut: wrap("cut", "number", 12), part: wrap("part", "number", 1), objects: wrap("objects", "string", 0),
    add_context: wrap("add_context", "string", 1, "string"),
    put: (file, name = path.basename(file)) => module.FS.writeFile(`/atlas/${name}`, fs.readFileSync(file)) };
}

/** Builds tests/web/NAME.c with conus for this machine into a folder; its path. */
export function compile(name, folder) {
  const root = path.resolve(import.meta.url.slice(7), "../../..");
  const native = path.resolve(CONUS, "../../..");
  execFileSync("cc", ["-O1", `-I${root}/include`, path.join(root, `tests/web/${name}.c`), "-o", path.join(folder, name), `-L${native}`, `-Wl,-rpath,${native}`, "-lconus"]);
  return path.join(folder, name);
}

/** Numbers from 0 to 1, the same in every run (Numerical Recipes' quick generator). */
export function random(seed) {
  let x = seed;
  return () => (x = (Math.imul(x, 1664525) + 1013904223) >>> 0) / 2 ** 32;
}
