// SPDX-License-Identifier: BSD-3-Clause
// conus/niivue with the real NiiVue in Chromium: node niivue.mjs, in a folder whose node_modules has conus, NiiVue, esbuild
// and playwright-core. A click moves the crosshair; the rows of its cone are those of the program $CONUS, and what they
// name has conus's colours in the volume.
import assert from "node:assert";
import { execFileSync } from "node:child_process";
import fs from "node:fs";
import http from "node:http";
import { createRequire } from "node:module";
import path from "node:path";
import { pathToFileURL } from "node:url";

const here = createRequire(path.join(process.cwd(), "app.js"));
const { chromium } = here("playwright-core");
const APP = `import NiiVue from "@niivue/niivue/webgl2";
import { attachConus } from "conus/niivue";
const nv = new NiiVue({ backend: "webgl2" });
await nv.attachTo("gl");
await nv.loadVolumes([{ url: "./tubes.nii.gz" }]);
const { I, labels } = await (await fetch("./names.json")).json();
const part = I.map((label) => label % 256);
await nv.setColormapLabel(0, { R: part, G: part, B: part, A: I.map((i) => (i ? 255 : 0)), I, labels });
const own = [...nv.volumes[0].colormapLabel.lut];
window.test = { nv, own, answers: [], errors: [], attachConus, lut: () => [...nv.volumes[0].colormapLabel.lut] };
const cone = test.cone = await attachConus(nv, { origin: [0, 0, 90], angle: 20, layers: "all" });
cone.onanswer = (rows, question) => test.answers.push({ rows, question, colours: cone.atlas.colours, lut: test.lut() });
cone.onerror = (error) => test.errors.push(String(error));
window.isReady = true;`;
const conus = (...words) => execFileSync(process.env.CONUS, words, { encoding: "utf8" });
conus("phantom", "tubes", "-o", ".", "--oblique", "30");
const areas = conus("info", "tubes.nii.gz", "--format", "tsv").trim().split("\n").slice(1).map((row) => row.split("\t").slice(1, 3));
fs.writeFileSync("tubes.tsv", [["index", "name"], ...areas].map((row) => `${row.join("\t")}\n`).join("")); // as NiiVue has them
const I = [0, ...areas.map(([index]) => Number(index))];
fs.writeFileSync("names.json", JSON.stringify({ I, labels: ["", ...areas.map(([, name]) => name)] }));
fs.writeFileSync("app.js", APP);
execFileSync(path.join(path.dirname(here.resolve("esbuild/package.json")), "bin/esbuild"), ["app.js", "--bundle", "--format=esm", "--outfile=bundled/app.js", "--log-level=error"]);
for (const name of ["worker.js", "conus.wasm"]) fs.copyFileSync(`node_modules/conus/lib/${name}`, `bundled/${name}`);

// Of NiiVue and conus here only their times are: of what it is painted in, the red of label 1, whose own is 9.
const { Cone } = await import(pathToFileURL("node_modules/conus/lib/niivue.mjs"));
const coneOf = (failures, select) => {
  const volume = { colormapLabel: { labels: ["", "a"], lut: Uint8ClampedArray.of(0, 0, 0, 0, 9, 9, 9, 255) } }, reds = [], errors = [];
  const nv = { volumes: [volume], createExtensionContext: () => ({ on() {}, dispose() {} }), async setColormapLabel(_, { R }) {
    if (failures-- > 0) throw new Error("no context");
    reds.push(R[1]);
  } };
  return { reds, errors, cone: Object.assign(new Cone(nv, volume, { colours: ["#ff0000"], select, close() {} }, {}), { onerror: (error) => errors.push(error.message) }) };
};
const rows = [{ rank: 1, index: 1 }];
const failing = coneOf(2, async () => rows); // the answer's colours, and then its own
for (const x of [0, 1]) await failing.cone.point([x, 0, 0]);
assert.deepEqual([failing.errors, failing.reds], [["no context", "no context"], [255]]);
let give;
const closing = coneOf(0, () => new Promise((done) => { give = done; }));
const asked = closing.cone.point([0, 0, 0]);
give(rows);
await closing.cone.dispose();
await asked;
assert.deepEqual(closing.reds, [9]);

const TYPES = { ".js": "text/javascript", ".wasm": "application/wasm" };
const server = http.createServer(({ url }, answer) => {
  const file = ["bundled", ""].map((folder) => path.join(process.cwd(), folder, url)).find((name) => path.extname(url) && fs.existsSync(name));
  answer.setHeader("Content-Type", file ? TYPES[path.extname(url)] ?? "application/octet-stream" : "text/html");
  answer.end(file ? fs.readFileSync(file) : '<!doctype html><canvas id="gl" width="900" height="600"></canvas><script type="module" src="/app.js"></script>');
}).listen(0);
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] });
const tab = await browser.newPage({ viewport: { width: 920, height: 640 } });
tab.on("pageerror", (error) => console.error(String(error)));
const base = `http://localhost:${server.address().port}`;
tab.on("request", (request) => assert.ok(/^(blob:|data:)|^http:\/\/localhost:/.test(request.url()), request.url()));
await tab.goto(base);
await tab.waitForFunction(() => window.isReady, null, { timeout: 120000 });

for (const [i, [x, y]] of [[250, 150], [640, 200], [200, 450]].entries()) {
  await tab.mouse.click(x, y);
  await tab.waitForFunction((count) => test.answers.length + test.errors.length > count, i);
  const { answer, errors, rest } = await tab.evaluate(() => ({ answer: test.answers.at(-1), errors: test.errors, rest: [190, 190, 190, 60] }));
  assert.deepEqual(errors, []);
  const { origin, toward, angle, layers } = answer.question;
  const wanted = conus("query", "tubes.nii.gz", `--origin=${origin}`, `--toward=${toward}`, `--angle=${angle}`, "--layers", layers, "-q", "--format", "ndjson");
  assert.deepEqual(answer.rows, wanted.trim().split("\n").map((row) => JSON.parse(row)));
  const hits = answer.rows.filter(({ rank }) => rank !== null);
  for (const label of I.slice(1)) {
    const place = hits.findIndex(({ index }) => index === label);
    const colour = place < 0 ? rest : [...answer.colours[place].matchAll(/\w\w/g)].map(([hex]) => parseInt(hex, 16)).concat(255);
    assert.deepEqual(answer.lut.slice(4 * label, 4 * label + 4), colour);
  }
  console.log(`niivue: a click, ${hits.length} areas as the program has them`);
}
if (process.env.SHOT) await tab.screenshot({ path: process.env.SHOT });

// Many moves at once: the last has its answer, and not every one between.
await tab.evaluate(async () => {
  test.answers.length = 0;
  await Promise.all(Array.from({ length: 40 }, (_, i) => test.cone.point([i / 10, 0, 0])));
});
await tab.waitForFunction(() => test.answers.at(-1)?.question.toward[0] === 3.9);
assert.ok(await tab.evaluate(() => test.answers.length < 40));
// What is refused takes the colours of the answer before away.
const refused = await tab.evaluate(async () => {
  test.cone.settings.angle = 200;
  await test.cone.point([0, 0, 0]);
  return [test.errors.at(-1), test.lut().join() === test.own.join()];
});
assert.match(refused[0], /^ConusError: angle: 200 is out of range/);
assert.ok(refused[1]);
const left = await tab.evaluate(async () => {
  test.cone.settings.angle = 20;
  await test.cone.point([0, 0, 0]);
  const painted = test.lut().join();
  await test.cone.dispose();
  const isOwn = painted !== test.own.join() && test.lut().join() === test.own.join();
  const why = (step) => step.then(() => "", String);
  const none = await why(test.attachConus(test.nv, { origin: [0, 0, 90], angle: 20, volume: 1 }));
  await test.nv.setColormapLabel(0, null);
  return [isOwn, none, await why(test.attachConus(test.nv, { origin: [0, 0, 90], angle: 20 }))];
});
assert.ok(left[0]);
assert.match(left[1], /volume: no volumes at 1 have names/);
assert.match(left[2], /volume: no volumes have names/);
await browser.close();
server.close();
