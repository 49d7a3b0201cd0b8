// SPDX-License-Identifier: BSD-3-Clause
// node pack.mjs FOLDER_OF_CONUS PAGE_FOLDER OUT.html: makes one file of the page, its worker and conus.
// The names in braces in page.html are replaced; the policy (CSP) allows this code, by its hash, and no network.
import { execFileSync } from "node:child_process";
import crypto from "node:crypto";
import fs from "node:fs";
import path from "node:path";

const [built, folder, out] = process.argv.slice(2);
const bundle = (entry, ...more) =>
  execFileSync("esbuild", [path.join(folder, entry), "--bundle", "--minify", "--format=iife", "--target=es2021", "--log-level=error", ...more], { maxBuffer: 1 << 26 }).toString();
const packed = (data) => execFileSync("gzip", ["-9nc"], { input: data, maxBuffer: 1 << 26 }).toString("base64"); // smaller than node's, the same everywhere
const hash = (text) => `'sha256-${crypto.createHash("sha256").update(text).digest("base64")}'`;

const main = bundle("main.js").trim();
const worker = bundle("worker.js", `--alias:conus.mjs=${path.resolve(built, "conus.mjs")}`, "--define:import.meta.url=\"\"", "--external:fs", "--external:path", "--external:crypto");
const style = execFileSync("esbuild", [path.join(folder, "page.css"), "--minify"]).toString().trim();
if (/<\/script|<!--/i.test(worker) || /<\/script/i.test(main) || /\{\{/.test(style)) throw new Error("the code has what ends it");
const parts = {
  csp: `default-src 'none'; script-src ${hash(main)} 'wasm-unsafe-eval' blob:; worker-src blob:; style-src ${hash(style)}; img-src blob: data:; connect-src 'none'; form-action 'none'; base-uri 'none'`,
  style, main, wasm: packed(fs.readFileSync(path.join(built, "conus.wasm"))), worker,
};
const page = fs.readFileSync(path.join(folder, "page.html"), "utf8").replace(/\{\{(\w+)\}\}/g, (_, name) => parts[name]);
fs.writeFileSync(out, page);
