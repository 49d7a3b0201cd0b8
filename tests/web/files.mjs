// SPDX-License-Identifier: BSD-3-Clause
// Hostile and truncated files: an error in words, never a trap of WebAssembly, and the next file opens all the same.
import assert from "node:assert";
import { execFileSync } from "node:child_process";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import test from "node:test";
import zlib from "node:zlib";
import { CONUS, random, start } from "./conus.mjs";

const ROOT = path.resolve(import.meta.url.slice(7), "../../..");
const folder = fs.mkdtempSync(path.join(os.tmpdir(), "conus-web-"));
process.on("exit", () => fs.rmSync(folder, { recursive: true }));
const run = (...words) => execFileSync(CONUS, words, { cwd: folder, stdio: "pipe" });
run("phantom", "slabs", "-o", ".", "--size", "16");
const good = fs.readFileSync(path.join(folder, "slabs.nii.gz"));
let conus = await start();

/** Opens bytes under a name: the words of the error, "" if there is none. */
function open(name, bytes) {
  conus.module.FS.writeFile(`/atlas/${name}`, bytes);
  try {
    return JSON.parse(conus.open(`/atlas/${name}`)).error ?? "";
  } finally {
    conus.module.FS.unlink(`/atlas/${name}`);
  }
}

function isStillRight() {
  assert.equal(open("good.nii.gz", good), "");
}

/** A NIfTI-1 of uint8 whose header claims these sizes, with few voxels behind it. */
function nifti(dim, type = 2, bits = 8) {
  const head = new DataView(new ArrayBuffer(352 + 64));
  head.setInt32(0, 348, true);
  [dim.length, ...dim, 1, 1, 1, 1].slice(0, 8).forEach((v, i) => head.setInt16(40 + 2 * i, v, true));
  head.setInt16(70, type, true);
  head.setInt16(72, bits, true);
  for (let i = 0; i < 8; i++) head.setFloat32(76 + 4 * i, 1, true);
  head.setFloat32(108, 352, true);
  head.setInt16(254, 4, true);
  [0, 5, 10].forEach((i) => head.setFloat32(280 + 4 * i, 1, true));
  head.setUint32(344, 0x00312b6e, true);
  return new Uint8Array(head.buffer);
}

test("sizes whose product is beyond 32 and 64 bits are refused", () => {
  for (const dim of [[2048, 2048, 1024], [32767, 32767, 32767], [1626, 1626, 1625], [65, 32767, 2017], [1024, 1024, 4096, 4096], [16384, 16384, 16]]) {
    for (const [type, bits] of [[2, 8], [4, 16], [16, 32], [64, 64]]) {
      for (const [name, pack] of [["a.nii", (x) => x], ["a.nii.gz", zlib.gzipSync]]) {
        assert.notEqual(open(name, pack(nifti(dim, type, bits))), "", `${dim} ${type} ${name}`);
      }
    }
  }
  isStillRight();
});

test("no side is told of an atlas in which left and right are exchanged", () => {
  const labels = [1, 2, 3, 4, 5, 6]; // along x
  const names = labels.map((label) => `${label}\t${"ABC"[(label - 1) % 3]}_${label < 4 ? "L" : "R"}`);
  const bytes = Uint8Array.of(...nifti([6, 1, 1]).slice(0, 352), ...labels);
  for (const [exchanged, rows] of [[false, names], [true, names.map((row) => row.replace(/[LR]$/, (side) => ({ L: "R", R: "L" })[side]))]]) {
    conus.module.FS.writeFile("/atlas/six.tsv", ["index\tname", ...rows, ""].join("\n"));
    assert.equal(open("six.nii", bytes), "");
    const sides = JSON.parse(conus.objects()).map((object) => object[4]).join("");
    assert.equal(sides, exchanged ? "" : "LLLRRR");
  }
  conus.module.FS.unlink("/atlas/six.tsv");
});

test("every prefix of a packed volume is refused", () => {
  for (let size = 0; size < good.length; size += Math.max(1, good.length >> 8)) assert.notEqual(open("a.nii.gz", good.subarray(0, size)), "", `${size}`);
  isStillRight();
});

test("2,000 volumes with bytes that lie: words or an atlas", () => {
  const next = random(3);
  const plain = zlib.gunzipSync(good);
  for (let i = 0; i < 2000; i++) {
    const bytes = Uint8Array.from(plain);
    for (let k = 0; k < 1 + next() * 6; k++) bytes[Math.floor(next() * 352)] = Math.floor(next() * 256);
    open("a.nii", bytes);
  }
  isStillRight();
});

test("the corpora of the fuzz targets: words or an atlas", (t) => {
  const corpora = path.join(ROOT, "tests/fuzz/corpus");
  let count = 0;
  for (const file of fs.existsSync(corpora) ? fs.readdirSync(corpora, { recursive: true }) : []) {
    const from = path.join(corpora, file);
    if (!fs.statSync(from).isFile()) continue;
    for (const ending of [".nii", ".nii.gz", ".gii", ".nrrd", ".tif", ".mgz", ".atlas.json", ".trk"]) open(`a${ending}`, fs.readFileSync(from));
    count++;
  }
  t.diagnostic(`${count} files`);
  isStillRight();
});

test("messages are the program's own", () => {
  for (const [name, bytes] of [["none.nii.gz", null], ["a.nii", Buffer.from("no atlas")], ["b.nii.gz", good.subarray(0, 100)], ["c.nii", nifti([300, 300, 300])], ["d.atlas.json", Buffer.from("{\"conus_atlas\": 1, \"x\": 2}")]]) {
    if (bytes) fs.writeFileSync(path.join(folder, name), bytes);
    let theirs = "";
    try {
      run("info", `./${name}`);
    } catch (error) {
      theirs = error.stderr.toString().trim().replace(/^conus: /, "").replaceAll("./", "");
    }
    const ours = bytes ? open(name, bytes) : JSON.parse(conus.open(`/atlas/${name}`)).error;
    assert.equal(ours.replaceAll("/atlas/", ""), theirs);
  }
});
