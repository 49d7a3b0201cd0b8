// SPDX-License-Identifier: BSD-3-Clause
// Cuts of WebAssembly against those of conus for this machine (cuts.c), each byte of colours and objects.
import assert from "node:assert";
import { execFileSync } from "node:child_process";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import test from "node:test";
import { CONUS, TEMPLATES, compile, random, start } from "./conus.mjs";

const folder = fs.mkdtempSync(path.join(os.tmpdir(), "conus-web-"));
process.on("exit", () => fs.rmSync(folder, { recursive: true }));
const CUTS = compile("cuts", folder);
execFileSync(CONUS, ["phantom", "brain", "-o", "brain"], { cwd: folder });
const AXES = [[0, 1], [0, 2], [1, 2]]; // to the right and up: axial, coronal, sagittal
const PLANES = Number(process.env.CONUS_PLANES ?? 60);

/** Asks both for random planes, sizes, and cones. @param {string[]} files the atlas first; @param {string} [context] */
async function compare(files, atlas, context) {
  const conus = await start();
  for (const file of [...files, ...(context ? [context] : [])]) conus.put(file);
  const info = JSON.parse(conus.open(`/atlas/${atlas}`));
  assert.equal(info.error, undefined);
  if (context) assert.equal(JSON.parse(conus.add_context(`/atlas/${path.basename(context)}`)).error, undefined);
  const next = random(11);
  const within = (margin) => info.low.map((v, a) => Number((v - margin + next() * (info.high[a] - v + 2 * margin)).toFixed(3)));
  const below = (n) => Math.floor(next() * n);
  const planes = Array.from({ length: PLANES }, () => ({ cone: [...within(40), ...within(0), 1 + 60 * next()], axes: AXES[below(3)],
    view: [...within(-5), 1 + below(400), 1 + below(400), 0.1 + next()], fill: [0, 0.3, 0.55, 1][below(4)] }));
  const theirs = execFileSync(CUTS, [path.join(path.dirname(files[0]), atlas), ...(context ? [context] : [])], { maxBuffer: 1 << 29,
    input: Buffer.from(Float64Array.from(planes.flatMap(({ cone, axes, view, fill }) => [...cone, ...axes, ...view, fill])).buffer) });
  let at = 0;
  const seen = new Set();
  for (const plane of planes) {
    const { cone, axes, view, fill } = plane;
    const [width, height] = view.slice(3);
    const size = 4 * width * height;
    assert.equal(JSON.parse(conus.ask(...cone.slice(0, 6), `angle=${cone[6]}&resolution=16`)).error, undefined);
    const rgba = conus.cut(...axes, ...view, fill, 0, 0);
    const objects = conus.part(6);
    assert.ok(rgba && objects);
    for (const from of [rgba, objects]) {
      const ours = Buffer.from(conus.module.HEAPU8.buffer, from, size);
      assert.ok(ours.equals(theirs.subarray(at, at + size)), JSON.stringify(plane));
      at += size;
    }
    for (const object of new Uint32Array(conus.module.HEAPU8.buffer, objects, width * height)) seen.add(object);
  }
  assert.equal(at, theirs.length);
  assert.ok(seen.size > 5, `${seen.size}`); // not of planes beside the atlas alone
  return `${planes.length} planes, ${at / 8} pixels, ${seen.size - 1} objects`;
}

const aal = ["aal.nii.gz", "aal.nii.txt", "aal.nii.lut"].map((name) => path.join(TEMPLATES, name));
const skip = !fs.existsSync(aal[0]) && "mricron-data is not installed";
test("AAL", { skip }, async (t) => t.diagnostic(await compare(aal, "aal.nii.gz")));
test("AAL over a T1", { skip }, async (t) => t.diagnostic(await compare(aal, "aal.nii.gz", path.join(TEMPLATES, "ch2.nii.gz"))));
test("surfaces and a pathway over an image", async (t) => {
  const files = fs.readdirSync(path.join(folder, "brain")).map((name) => path.join(folder, "brain", name));
  t.diagnostic(await compare(files, "brain.atlas.json"));
});
