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
const run = (...words) => execFileSync(CONUS, words, { cwd: folder, maxBuffer: 1 << 29 }).toString();
const POSES = 3000;
const POSES_ALL_LAYERS = process.env.CONUS_WEB_LONG ? POSES : 300; // which take 3 to 130 times as long
const NDJSON = 4;

const ROOT = path.resolve(import.meta.url.slice(7), "../../..");
run("phantom", "brain", "-o", "brain");
run("phantom", "tubes", "-o", "turned", "--oblique", "30"); // no row of voxels is along an axis of the world
execFileSync("python3", [path.join(ROOT, "tests/cli/ccf.py")], { cwd: folder });
const brain = JSON.parse(fs.readFileSync(path.join(folder, "brain/brain.atlas.json")));
for (const part of ["areas", "pathways"]) fs.writeFileSync(path.join(folder, `brain/${part}.atlas.json`), JSON.stringify({ conus_atlas: 1, [part]: brain[part] }));

/** Three blurred balls as a 4-D volume of probabilities in percent, uint8, 24 x 20 x 16 voxels of 2 mm. */
function probabilities() {
  const [nx, ny, nz] = [24, 20, 16];
  const head = new DataView(new ArrayBuffer(352));
  head.setInt32(0, 348, true);
  [4, nx, ny, nz, 3, 1, 1, 1].forEach((n, i) => head.setInt16(40 + 2 * i, n, true));
  head.setInt16(70, 2, true);
  head.setInt16(72, 8, true);
  [1, 2, 2, 2, 1].forEach((edge, i) => head.setFloat32(76 + 4 * i, edge, true));
  head.setFloat32(108, 352, true);
  head.setInt16(254, 1, true);
  [nx, ny, nz].forEach((n, i) => {
    head.setFloat32(280 + 20 * i, 2, true);
    head.setFloat32(292 + 16 * i, 1 - n, true);
  });
  head.setUint32(344, 0x00312b6e, true);
  const voxels = Uint8Array.from({ length: nx * ny * nz * 3 }, (_, i) => {
    const at = [i % nx, Math.floor(i / nx) % ny, Math.floor(i / nx / ny) % nz];
    const far = Math.hypot(...at.map((v, a) => v - [[7, 8, 8], [15, 12, 6], [12, 6, 11]][Math.floor(i / nx / ny / nz)][a]));
    return Math.max(0, 100 - 14 * far);
  });
  return Buffer.concat([Buffer.from(head.buffer), voxels]);
}
fs.mkdirSync(path.join(folder, "prob"));
fs.writeFileSync(path.join(folder, "prob/prob.nii"), probabilities());
fs.writeFileSync(path.join(folder, "prob/prob.xml"), `<?xml version="1.0"?><atlas version="1.0"><header><name>Balls</name><type>Probabilistic</type>
<images><imagefile>/prob</imagefile><summaryimagefile>/prob</summaryimagefile></images></header><data>
${["left", "right", "top"].map((name, i) => `<label index="${i}" x="0" y="0" z="0">${name}</label>`).join("\n")}</data></atlas>`);

/** Random poses around a box, with angles: no libm in them, so that both sides ask the same. */
function poses(low, high, seed, count) {
  const next = random(seed);
  const within = (margin) => low.map((v, a) => Number((v - margin + next() * (high[a] - v + 2 * margin)).toFixed(3)));
  return Array.from({ length: count }, () => ({ origin: within(40), toward: within(0), angle: Number((1 + 169 * next()).toFixed(2)) }));
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
  const asked = poses(info.low, info.high, 7, layers === "all" ? POSES_ALL_LAYERS : POSES);
  let ours = "";
  asked.forEach(({ origin, toward, angle }, i) => {
    assert.equal(JSON.parse(conus.ask(...origin, ...toward, `angle=${angle}&resolution=16&layers=${layers}`)).error, undefined);
    ours += conus.rows(NDJSON).replaceAll('"query": "1"', `"query": "${i + 1}"`).replaceAll('"query":"1"', `"query":"${i + 1}"`);
  });
  fs.writeFileSync(path.join(folder, "poses.tsv"), ["x\ty\tz\ttx\tty\ttz\tangle",
    ...asked.map(({ origin, toward, angle }) => [...origin, ...toward, angle].join("\t"))].join("\n") + "\n");
  const theirs = run("batch", files[0][0], "--poses", "poses.tsv", "--layers", layers, "--resolution", "16", "--format", "ndjson", "--quiet");
  const [a, b] = [ours, theirs].map((text) => text.trim().split("\n"));
  assert.equal(a.length, b.length);
  assert.deepEqual(a.flatMap((row, i) => (row === b[i] ? [] : [[row, b[i]]])), []);
  return `${a.length} rows`;
}

const real = ["aal.nii.gz", "aal.nii.txt", "aal.nii.lut"].map((name) => [path.join(TEMPLATES, name), name]).filter(([file]) => fs.existsSync(file));
const inside = (name) => fs.readdirSync(path.join(folder, name), { recursive: true }).map((file) => [path.join(folder, name, file), file]).filter(([file]) => fs.statSync(file).isFile());

const KINDS = { // folder and atlas of each
  "a manifest with surfaces, pathways and areas": ["brain", "brain.atlas.json"],
  "surfaces of GIFTI alone": ["brain", "areas.atlas.json"],
  "a surface of GIFTI without a manifest": ["brain", "brain-04-SupR.surf.gii"],
  "probabilistic pathways alone": ["brain", "pathways.atlas.json"],
  "areas on a turned grid": ["turned", "tubes.nii.gz"],
  "an FSL atlas of probabilities": ["prob", "prob.xml"],
  "a stack of TIFF on the Allen CCF's grid": ["globe", "annotation.tiff"],
};
for (const layers of ["visible", "all"]) {
  test(`AAL, ${layers}`, { skip: !real.length && "mricron-data is not installed" }, async (t) => t.diagnostic(`${await compare(real, "aal.nii.gz", layers)}`));
  for (const [kind, [where, atlas]] of Object.entries(KINDS)) {
    test(`${kind}, ${layers}`, async (t) => {
      const files = inside(where).sort(([, a], [, b]) => Number(b === atlas) - Number(a === atlas));
      t.diagnostic(`${await compare(files, atlas, layers)}`);
    });
  }
}

test("the question of the README", { skip: !real.length && "mricron-data is not installed" }, async () => {
  const conus = await start();
  for (const [file, name] of real) conus.put(file, name);
  conus.open("/atlas/aal.nii.gz");
  conus.ask(-90, 20, 20, 0, -10, 10, "angle=20&resolution=16");
  const rows = conus.rows(NDJSON).trim().split("\n").map((row) => JSON.parse(row));
  assert.deepEqual(rows.slice(0, 3).map((row) => [row.name, row.pixels]), [["Frontal_Inf_Oper_L", 188], ["Precentral_L", 16], ["Postcentral_L", 4]]);
  const native = run("query", real[0][0], "--origin", "-90,20,20", "--toward", "0,-10,10", "--angle", "20", "--resolution", "16", "--format", "ndjson", "--quiet");
  assert.equal(conus.rows(NDJSON), native);
});
