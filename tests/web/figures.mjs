// SPDX-License-Identifier: BSD-3-Clause
// scripts/web --figures: how fast the page is in a headless Chromium, against conus for this machine, both in this run.
import { execFileSync, spawnSync } from "node:child_process";
import fs from "node:fs";
import { createRequire } from "node:module";
import os from "node:os";
import path from "node:path";
import zlib from "node:zlib";
import { CONUS, PAGE, TEMPLATES, random } from "./conus.mjs";

const { chromium } = createRequire(path.join(process.env.NODE_PATH, "x.js"))("playwright-core");
const ROOT = path.resolve(import.meta.url.slice(7), "../../..");
const NATIVE = path.resolve(CONUS, "../../..");
const QUESTIONS = 300;
const SIDE = 400;
const folder = fs.mkdtempSync(path.join(os.tmpdir(), "conus-web-"));
const aal = path.join(TEMPLATES, "aal.nii.gz");
const percentile = (numbers, n) => [...numbers].sort((a, b) => a - b)[Math.min(numbers.length - 1, Math.floor(n / 100 * numbers.length))];
const summary = (numbers) => `median ${percentile(numbers, 50).toFixed(2)}, 95th percentile ${percentile(numbers, 95).toFixed(2)}`;
const bar = (value, limit) => `${value.toFixed(2)} (bar ${limit}: ${value <= limit ? "met" : "MISSED"})`;
const load = () => os.loadavg()[0].toFixed(1);

execFileSync("cc", ["-O1", `-I${ROOT}/include`, `-I${ROOT}`, path.join(ROOT, "tests/web/figures.c"), "-o", path.join(folder, "figures"), "-Wl,--wrap=traverse_best_kernel",
  path.join(NATIVE, "libconus.a"), ..."z deflate zstd expat jansson nettle m pthread dl".split(" ").map((name) => `-l${name}`)]);
const native = (input) => spawnSync(path.join(folder, "figures"), [aal, String(SIDE)], { input, encoding: "utf8" }).stdout;
const next = random(3);
const between = (low, high) => low + next() * (high - low);
const questions = Array.from({ length: QUESTIONS }, () => [between(-120, 120), between(-150, 110), between(-90, 130), between(-60, 60), between(-90, 60), between(-40, 70), 20]);
execFileSync(CONUS, ["page", aal, "--origin", "-90,20,20", "--toward", "0,-10,10", "--template", path.join(PAGE, "page.html"), "-o", "aal.html", "--quiet"], { cwd: folder });
const file = `file://${path.join(folder, "aal.html")}`;
console.log(`${os.cpus()[0].model}, ${os.cpus().length} processors, load ${load()}; node ${process.version}`);

const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: ["--no-sandbox", "--disable-gpu"] });
console.log(`Chromium ${browser.version()}, headless, without a GPU`);

/** The processor time of all Chromium's processes, in ticks of 10 ms. */
function spent() {
  let ticks = 0;
  for (const id of fs.readdirSync("/proc").filter((name) => Number(name))) {
    try {
      const [, name, rest] = fs.readFileSync(`/proc/${id}/stat`, "utf8").match(/\((.*)\) (.*)/);
      if (name.startsWith("chromium")) ticks += rest.split(" ").slice(11, 13).reduce((sum, part) => sum + Number(part), 0);
    } catch {} // it has ended
  }
  return ticks;
}

/** Waits, 10 s at most, until Chromium has loaded its own pages: until it takes no processor time for 0.3 s. */
async function settle() {
  for (let i = 0, before = -1; i < 33 && before !== spent(); i++) {
    before = spent();
    await new Promise((done) => { setTimeout(done, 300); });
  }
}

/** Opens the AAL page in a profile of its own; the page notes when it drew, and each frame. */
async function visit() {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 } });
  const page = await context.newPage();
  await page.addInitScript(() => {
    window.took = [];
    window.frames = [];
    const frame = (now) => { window.frames.push(now); requestAnimationFrame(frame); };
    requestAnimationFrame(frame);
    document.addEventListener("DOMContentLoaded", () => new MutationObserver(() => {
      window.first ??= performance.now();
      window.took.push(Number(document.body.dataset.took));
    }).observe(document.body, { attributeFilter: ["data-drawn"] }));
  });
  await settle();
  await page.goto(file);
  await page.locator("body[data-drawn][data-ready]").waitFor({ state: "attached", timeout: 60000 });
  return page;
}

// The first picture, from a file, against a process of conus that loads the atlas and draws the three cuts.
const firsts = [];
const processes = [];
for (let i = 0; i < 9; i++) {
  const page = await visit();
  firsts.push(await page.evaluate(() => window.first));
  await page.context().close();
  const begun = performance.now();
  native("");
  processes.push(performance.now() - begun);
}
console.log(`first picture, ms: ${summary(firsts)}; a native process: ${summary(processes)}; ratio ${bar(percentile(firsts, 50) / percentile(processes, 50), 3)}; 95th percentile, s: ${bar(percentile(firsts, 95) / 1000, 1.5)}`);

// Cones and cuts, by the page's conus in the page, and by its worker with the message there and back.
const page = await visit();
const ours = await page.evaluate(async ([module, list, side]) => {
  const bytes = (element) => Uint8Array.from(atob(element.textContent.trim()), (c) => c.charCodeAt(0));
  const unpack = (id) => new Response(new Blob([bytes(document.getElementById(id))]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
  const files = [...document.querySelectorAll("script[data-file]")].map((block) => [block.dataset.file, bytes(block).buffer]);
  const { default: create } = await import(URL.createObjectURL(new Blob([module], { type: "text/javascript" })));
  const conus = await create({ wasmBinary: await unpack("wasm"), locateFile: (name) => name });
  conus.FS.mkdir("/atlas");
  for (const [name, data] of files) conus.FS.writeFile(`/atlas/${name}`, new Uint8Array(data));
  conus.cwrap("web_open", "string", ["string"])(`/atlas/${files[0][0]}`);
  const cone = conus.cwrap("web_ask", "string", Array(9).fill("number"));
  const cut = conus.cwrap("web_cut", "number", Array(12).fill("number"));
  const cones = [];
  const cuts = [];
  for (let round = 0; round < 3; round++) { // the first is compiled on the way
    for (const question of list) {
      const begun = performance.now();
      for (let i = 0; i < 4; i++) cone(...question, 16, 0); // the browser's clock ticks in 0.1 ms
      cones.push((performance.now() - begun) * 250);
      if (round === 0) continue;
      const cutting = performance.now();
      for (const [right, up] of [[0, 1], [0, 2], [1, 2]]) cut(right, up, ...question.slice(3, 6), side, side, 225 / side, 0.55, 0, 0, 0);
      cuts.push(performance.now() - cutting);
    }
    if (round === 0) cones.length = 0;
  }
  const worker = new Worker(URL.createObjectURL(new Blob([document.getElementById("worker").textContent], { type: "text/javascript" })));
  const ask = (call, data, give = []) => new Promise((done) => {
    worker.onmessage = (event) => done(event.data);
    worker.postMessage({ id: 1, call, ...data }, give);
  });
  await ask("start", { module: await WebAssembly.compile(await unpack("wasm")) });
  await ask("put", { files });
  await ask("open", { name: files[0][0] });
  const messages = [];
  const drawings = [];
  let given = []; // back, as the page does with what it has shown
  for (const list2 of [messages, drawings]) {
    for (const question of list) {
      const cuts = list2 === messages ? [] : [[0, 1], [0, 2], [1, 2]].map(([right, up]) => ({ right, up, centre: question.slice(3, 6), width: side, height: side, mm: 225 / side, fill: 0.55, window: [0, 0] }));
      const begun = performance.now();
      const drawn = await ask("draw", { given, question: { origin: question.slice(0, 3), toward: question.slice(3, 6), angle: question[6], resolution: 16, layers: "visible" }, cuts, view: null, chosen: 0 }, given);
      given = drawn.cuts.flatMap(({ rgba, objects }) => [rgba, objects]);
      list2.push(performance.now() - begun);
    }
  }
  worker.terminate();
  return { cones, cuts, messages: messages.slice(50), drawings: drawings.slice(50) };
}, [fs.readFileSync(path.join(PAGE, "conus.mjs"), "utf8"), questions, SIDE]);
await page.context().close();
const [cone, cut] = native(Buffer.from(Float64Array.from(questions.flat()).buffer)).trim().split(" ").map(Number);
console.log(`a cone of 208 rays, us: ${summary(ours.cones)}; native, plain kernel: ${cone.toFixed(2)}; ratio ${bar(percentile(ours.cones, 50) / cone, 3)}`);
console.log(`three cuts of ${SIDE} x ${SIDE}, ms: ${summary(ours.cuts)}; native: ${cut.toFixed(2)}; ratio ${bar(percentile(ours.cuts, 50) / cut, 3)}`);
console.log(`a cone with rows and message, ms: ${summary(ours.messages)}; 95th percentile ${bar(percentile(ours.messages, 95), 2)}`);
console.log(`that and three cuts of ${SIDE} x ${SIDE}, ms: ${summary(ours.drawings)}; 95th percentile ${bar(percentile(ours.drawings, 95), 16)}`);

// Dragging: from a frame's beginning to its rows and pictures; what the page's own thread did; and the frames.
for (const [what, pane, place] of [["the target in a cut", 0, [0.5, 0.52]], ["the start in a cut", 0, null], ["the 3-D view", 3, [0.5, 0.5]]]) {
  const page = await visit();
  const client = await page.context().newCDPSession(page);
  await client.send("Performance.enable");
  const metrics = async () => Object.fromEntries((await client.send("Performance.getMetrics")).metrics.map(({ name, value }) => [name, value]));
  const box = await page.locator(`[data-pane="${pane}"] .over`).boundingBox();
  const at = (u, v) => [box.x + u * box.width, box.y + v * box.height];
  let from = place && at(...place);
  if (!from) { // the start lies left of the atlas: put it where it is seen
    await page.locator("[name=origin0]").fill("-60");
    await page.locator("[name=origin1]").blur();
    from = at(0.5 - 60 / 271, 0.4);
  }
  if (pane === 0) { // whichever end it is, a click puts it there
    await page.locator(`[name=end][value=${place ? "toward" : "origin"}]`).check();
    await page.mouse.click(...from);
  }
  await page.waitForTimeout(1000);
  await page.mouse.move(...from);
  await page.mouse.down();
  await page.evaluate(() => { window.took = []; window.frames = []; });
  const before = await metrics();
  for (let i = 1; i <= 400; i++) await page.mouse.move(from[0] + 50 * Math.sin(i / 25), from[1] + 50 * Math.sin(i / 18));
  const after = await metrics();
  const { took, frames } = await page.evaluate(() => ({ took: window.took, frames: window.frames }));
  await page.mouse.up();
  await page.context().close();
  const gaps = frames.slice(1).map((now, i) => now - frames[i]);
  const perPicture = (name) => (1000 * (after[name] - before[name]) / took.length).toFixed(2);
  console.log(`dragging ${what}: ${took.length} pictures, ms each: ${summary(took)}; 95th percentile ${bar(percentile(took, 95), 16)}`);
  console.log(`  the page's thread, ms a picture: ${perPicture("TaskDuration")}, of which script ${perPicture("ScriptDuration")}, style ${perPicture("RecalcStyleDuration")}, layout ${perPicture("LayoutDuration")}`);
  console.log(`  frames, ms apart: ${summary(gaps)}; load ${load()}`);
}
const template = fs.readFileSync(path.join(PAGE, "page.html"));
// The page before it had a headset, 645,584, and 12,000.
console.log(`template, packed: ${bar(zlib.gzipSync(template).length, 657584)}; with AAL: ${bar(fs.statSync(path.join(folder, "aal.html")).size, 1200000)}`);
await browser.close();
fs.rmSync(folder, { recursive: true });
