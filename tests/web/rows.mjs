// SPDX-License-Identifier: BSD-3-Clause
// Rows of WebAssembly against those of conus for this machine, byte by byte: both by the plain kernels, without Embree.
import assert from "node:assert";
import { execFileSync } from "node:child_process";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import test from "node:test";
import { CONUS, TEMPLATES, random, start } from "./conus.mjs";

const folder = fs.mkdtempSync(path.join(os.tmpdir(), "conus-web-"));
process.on("exit", () => fs.rmSync(folder, { recursive: true }));
const env = { ...process.env, CONUS_CACHE: "off" };
const run = (...words) => execFileSync(CONUS, words, { cwd: folder, env, maxBuffer: 1 << 29 }).toString();
const POSES = Number(process.env.CONUS_POSES ?? 3000);
const NDJSON = 4;

run("phantom", "brain", "-o", "brain");
run("phantom", "bundle", "-o", "bundle");

/** Random poses around a box, with angles: no libm in them, so that both sides ask the same. */
function poses(low, high, seed) {
  const next = random(seed);
  const within = (margin) => low.map((v, a) => Number((v - margin + next() * (high[a] - v + 2 * margin)).toFixed(3)));
  return Array.from({ length: POSES }, () => ({ origin: within(40), toward: within(0), angle: Number((1 + 60 * next()).toFixed(2)) }));
}

/** Asks both, of all poses. */
async function compare(files, atlas, layers) {
  const conus = await start();
  for (const [file, name] of files) {
    const parts = name.split("/");
    for (let i = 1; i < parts.length; i++) {
      const sub = `/atlas/${parts.slice(0, i).join("/")}`;
      if (!conus.module.FS.analyzePath(sub).exists) conus.module.FS.mkdir(sub);
    }
    conus.put(file, name);
  }
  const info = JSON.parse(conus.open(`/atlas/${atlas}`));
  assert.equal(info.error, undefined);
  const asked = poses(info.low, info.high, 7);
  let ours = "";
  asked.forEach(({ origin, toward, angle }, i) => {
    assert.equal(conus.ask(...origin, ...toward, angle, 16, layers === "all" ? 1 : 0), "{}");
    ours += conus.rows(NDJSON).replaceAll('"query": "1"', `"query": "${i + 1}"`).replaceAll('"query":"1"', `"query":"${i + 1}"`);
  });
  fs.writeFileSync(path.join(folder, "poses.tsv"), ["x\ty\tz\ttx\tty\ttz\tangle",
    ...asked.map(({ origin, toward, angle }) => [...origin, ...toward, angle].join("\t"))].join("\n") + "\n");
  const theirs = run("batch", files[0][0], "--poses", "poses.tsv", "--layers", layers, "--format", "ndjson", "--quiet");
  const [a, b] = [ours, theirs].map((text) => text.trim().split("\n"));
  assert.equal(a.length, b.length);
  for (let i = 0; i < a.length; i++) assert.equal(a[i], b[i]);
  return a.length;
}

const real = ["aal.nii.gz", "aal.nii.txt", "aal.nii.lut"].map((name) => [path.join(TEMPLATES, name), name]).filter(([file]) => fs.existsSync(file));
const inside = (name) => fs.readdirSync(path.join(folder, name), { recursive: true }).map((file) => [path.join(folder, name, file), file]).filter(([file]) => fs.statSync(file).isFile());

for (const layers of ["visible", "all"]) {
  test(`AAL, ${layers}`, { skip: !real.length && "mricron-data is not installed" }, async (t) => t.diagnostic(`${await compare(real, "aal.nii.gz", layers)} rows`));
  test(`a manifest with surfaces, pathways and areas, ${layers}`, async (t) => {
    const files = inside("brain").sort(([a], [b]) => Number(b.endsWith(".atlas.json")) - Number(a.endsWith(".atlas.json")));
    t.diagnostic(`${await compare(files, path.basename(files[0][1]), layers)} rows`);
  });
}

test("the question of the README", { skip: !real.length && "mricron-data is not installed" }, async () => {
  const conus = await start();
  for (const [file, name] of real) conus.put(file, name);
  conus.open("/atlas/aal.nii.gz");
  conus.ask(-90, 20, 20, 0, -10, 10, 20, 16, 0);
  const rows = conus.rows(NDJSON).trim().split("\n").map((row) => JSON.parse(row));
  assert.deepEqual(rows.slice(0, 3).map((row) => [row.name, row.pixels]), [["Frontal_Inf_Oper_L", 188], ["Precentral_L", 16], ["Postcentral_L", 4]]);
  const native = run("query", real[0][0], "--origin", "-90,20,20", "--toward", "0,-10,10", "--angle", "20", "--format", "ndjson", "--quiet");
  assert.equal(conus.rows(NDJSON), native);
});
