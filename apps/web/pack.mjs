// SPDX-License-Identifier: BSD-3-Clause
// node pack.mjs FOLDER_OF_CONUS PAGE_FOLDER OUT.html: makes one file of the page, its worker and conus.
// The names in braces in page.html are replaced, {{form}} by fields of the rows of options; the policy (CSP) allows this code, by its hash, and no network. So are
// the names of base/look.h, LOOK_NAME, in the style and in texts of main.js; two hexadecimal digits behind a colour are
// its opacity.
import { execFileSync } from "node:child_process";
import crypto from "node:crypto";
import fs from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";
import { pathToFileURL } from "node:url";

const [built, folder, out] = process.argv.slice(2);
const bundle = (entry, ...more) =>
  execFileSync("esbuild", [path.join(folder, entry), "--bundle", "--minify", "--format=iife", "--target=es2021", "--log-level=error", ...more], { maxBuffer: 1 << 26 }).toString();
const packed = (data) => execFileSync("gzip", ["-9nc"], { input: data, maxBuffer: 1 << 26 }).toString("base64"); // smaller than node's, the same everywhere
const hash = (text) => `'sha256-${crypto.createHash("sha256").update(text).digest("base64")}'`;

const look = new Map();
const header = fs.readFileSync(path.join(folder, "../../../base/look.h"), "utf8");
for (const [, key, hex] of header.matchAll(/^ +(LOOK_\w+) = 0x(\w{6}),/gm)) look.set(key, `#${hex.toLowerCase()}`);
for (const [, key, size] of header.matchAll(/^ +(LOOK_\w+) = (\d+),/gm)) look.set(key, `${size}px`);
for (const [, key, dark, light] of header.matchAll(/ITEM\((\w+), 0x(\w{6}), 0x(\w{6})\)/g)) {
  look.set(`LOOK_DARK_${key}`, `#${dark.toLowerCase()}`).set(`LOOK_LIGHT_${key}`, `#${light.toLowerCase()}`);
}
const withLook = (text) => text.replace(/\b(LOOK_[A-Z_0-9]*?)([0-9a-f]{2})?\b(?!_)/g, (all, name, opacity) => {
  if (look.has(all)) return look.get(all);
  if (!look.has(name)) throw new Error(`${all} is not in base/look.h`);
  return look.get(name) + opacity;
});

// The rows of what is asked, from conus itself, and their fields.
globalThis.require = createRequire(import.meta.url); // what emscripten's module asks for in node
globalThis.__dirname = path.resolve(built);
const { default: create } = await import(pathToFileURL(path.resolve(built, "conus.mjs")));
const conus = await create({ wasmBinary: fs.readFileSync(path.join(built, "conus.wasm")) });
const rows = JSON.parse(conus.cwrap("web_form", "string", [])());
const plain = (text) => text.replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`);
const fieldOf = ({ name, type, help, unit = "", choices = [] }) => {
  const field = type === "choice" ? `<select name="${name}">${choices.map((word) => `<option value="${word}">${word}</option>`).join("")}</select>`
    : type === "flag" ? `<input type="checkbox" name="${name}" value="1">` : `<input name="${name}"${type === "range" || type === "text" ? "" : ' inputmode="decimal"'}>`;
  return `<label title="${plain(help.replace(/:$/, ""))}">${name[0].toUpperCase()}${name.slice(1).replaceAll("-", " ")} ${field} ${unit}</label>`;
};
const form = rows.map(fieldOf).join("\n");

const main = withLook(bundle("main.js", `--define:CONUS_ROWS=${JSON.stringify(rows)}`).trim());
const glue = path.resolve(built, "conus-worker.mjs"); // without what only other places need
fs.writeFileSync(glue, fs.readFileSync(path.join(built, "conus.mjs"), "utf8").replace(/\bvar (ENVIRONMENT_IS_\w+)=[^;]+;/g, ""));
const worker = bundle("worker.js", `--alias:conus.mjs=${glue}`, "--define:import.meta.url=\"\"", "--define:ENVIRONMENT_IS_WEB=false", "--define:ENVIRONMENT_IS_WORKER=true", "--define:ENVIRONMENT_IS_NODE=false");
fs.writeFileSync(path.join(path.dirname(out), "worker.js"), worker);
const css = withLook(fs.readFileSync(path.join(folder, "page.css"), "utf8"));
const style = execFileSync("esbuild", ["--loader=css", "--minify"], { input: css }).toString().trim();
if (/<\/script|<!--/i.test(worker) || /<\/script/i.test(main) || /\{\{/.test(style)) throw new Error("the code has what ends it");
const parts = {
  csp: `default-src 'none'; script-src ${hash(main)} 'wasm-unsafe-eval' blob:; worker-src blob:; style-src ${hash(style)}; img-src blob: data:; connect-src 'none'; form-action 'none'; base-uri 'none'`,
  style, main, form, wasm: packed(fs.readFileSync(path.join(built, "conus.wasm"))), worker,
};
const page = fs.readFileSync(path.join(folder, "page.html"), "utf8").replace(/\{\{(\w+)\}\}/g, (_, name) => parts[name]);
fs.writeFileSync(out, page);
