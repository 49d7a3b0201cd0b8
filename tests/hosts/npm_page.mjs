// SPDX-License-Identifier: BSD-3-Clause
// npm's package in a page of Chromium, as it is and bundled by esbuild: node npm_page.mjs, in a folder whose node_modules
// has conus, esbuild and playwright-core. Rows are those of the program $CONUS; no request leaves this machine.
import assert from "node:assert";
import { execFileSync } from "node:child_process";
import fs from "node:fs";
import http from "node:http";
import { createRequire } from "node:module";
import path from "node:path";

const here = createRequire(path.join(process.cwd(), "app.js"));
const { chromium } = here("playwright-core");
const APP = `import { load } from "conus";
import { run } from "conus/run";
window.answer = async (bytes) => {
  const cone = { origin: [0, 0, 90], toward: [0, 0, 0], angle: 20 };
  const atlas = await load(new File([new Uint8Array(bytes)], "nested.nii.gz"));
  await atlas.select(cone);
  const rows = await atlas.text("tsv");
  const ran = await run(["query", "nested.nii.gz", "--origin", "0,0,90", "--toward", "0,0,0", "--angle", "20", "-q", "--format", "tsv"], { "nested.nii.gz": new Uint8Array(bytes) });
  return [rows, ran, await load(new Uint8Array(3), { name: "x.nii" }).catch(String)];
};`;
execFileSync(process.env.CONUS, ["phantom", "nested", "-o", ".", "--size", "24"]);
fs.rmSync("nested.tsv", { force: true });
const wanted = execFileSync(process.env.CONUS, ["query", "nested.nii.gz", "--origin", "0,0,90", "--toward", "0,0,0", "--angle", "20", "-q", "--format", "tsv"], { encoding: "utf8" });
fs.writeFileSync("app.js", APP);
// What bundlers copy that know new URL(..., import.meta.url), esbuild leaves where it is.
execFileSync(path.join(path.dirname(here.resolve("esbuild/package.json")), "bin/esbuild"), ["app.js", "--bundle", "--format=esm", "--outfile=bundled/app.js", "--log-level=error"]);
for (const name of ["worker.js", "conus.wasm", "conus-run.wasm"]) fs.copyFileSync(`node_modules/conus/lib/${name}`, `bundled/${name}`);

const imports = JSON.stringify({ imports: { conus: "/node_modules/conus/lib/index.mjs", "conus/run": "/node_modules/conus/lib/run.mjs" } });
const page = (src) => `<!doctype html><script type="importmap">${imports}</script><script type="module" src="${src}"></script>`;
const TYPES = { ".js": "text/javascript", ".mjs": "text/javascript", ".wasm": "application/wasm" };
const server = http.createServer(({ url }, answer) => {
  const file = path.join(process.cwd(), url);
  const isFile = path.extname(url) && fs.existsSync(file);
  answer.setHeader("Content-Type", isFile ? TYPES[path.extname(url)] : "text/html");
  answer.end(isFile ? fs.readFileSync(file) : page(`${url === "/" ? "" : url}/app.js`));
}).listen(0);
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: ["--no-sandbox"] });
for (const way of ["/", "/bundled"]) {
  const tab = await browser.newPage();
  const base = `http://localhost:${server.address().port}`;
  tab.on("request", (request) => assert.ok(/^(blob:)?http:\/\/localhost:/.test(request.url()), request.url()));
  await tab.goto(base + way);
  await tab.waitForFunction(() => window.answer);
  const [rows, ran, refused] = await tab.evaluate((bytes) => window.answer(bytes), [...fs.readFileSync("nested.nii.gz")]);
  assert.equal(rows, wanted);
  assert.deepEqual(ran, { code: 0, stdout: wanted, stderr: "", files: {} });
  assert.match(refused, /^ConusError: x\.nii: /);
  console.log(`npm: ${way} in Chromium has the program's rows`);
}
await browser.close();
server.close();
