// SPDX-License-Identifier: BSD-3-Clause
// npm's package as whoever depends on it has it: node --test npm.mjs, in a folder whose node_modules has conus. Its rows
// and files are those of the program $CONUS; of AAL, where mricron's templates are.
import assert from "node:assert";
import { execFileSync, spawnSync } from "node:child_process";
import fs from "node:fs";
import { createRequire } from "node:module";
import os from "node:os";
import path from "node:path";
import test from "node:test";
import { pathToFileURL } from "node:url";

const from = createRequire(path.join(process.cwd(), "app.js")).resolve("conus/package.json");
const inPackage = (name) => import(pathToFileURL(path.join(path.dirname(from), name)));
const { exports } = JSON.parse(fs.readFileSync(from, "utf8"));
const { ConusError, load } = await inPackage(exports["."].node);
const { run } = await inPackage(exports["./run"].node);

const folder = fs.mkdtempSync(path.join(os.tmpdir(), "conus-npm-"));
process.on("exit", () => fs.rmSync(folder, { recursive: true }));
const conus = (...words) => execFileSync(process.env.CONUS, words, { cwd: folder, encoding: "utf8" });
conus("phantom", "nested", "-o", ".", "--size", "24");
conus("phantom", "slabs", "-o", ".");
conus("phantom", "tubes", "-o", ".", "--oblique", "30"); // of which clang's SLP vectorizer loses voxels
const templates = process.env.CONUS_TEMPLATES ?? "/usr/share/mricron/templates";
const aal = fs.existsSync(`${templates}/aal.nii.gz`);
const taken = (...names) => Object.fromEntries(names.map((name) => [name, fs.readFileSync(path.join(aal && name.startsWith("aal") ? templates : folder, name))]));
const atlases = fs.readdirSync(folder).filter((name) => name.endsWith(".nii.gz"));
if (aal) for (const name of ["aal.nii.gz", "aal.nii.txt"]) fs.copyFileSync(`${templates}/${name}`, path.join(folder, name));

/** What lies beside an atlas, the atlas first. */
const beside = (atlas) => taken(atlas, ...fs.readdirSync(folder).filter((name) => name !== atlas && name.startsWith(atlas.split(".")[0]) && !name.endsWith(".json")));
const random = ((x) => () => (x = (Math.imul(x, 1664525) + 1013904223) >>> 0) / 2 ** 32)(7);
const place = (reach) => [0, 1, 2].map(() => Number((reach * (2 * random() - 1)).toFixed(2)));

for (const atlas of [...atlases, ...(aal ? ["aal.nii.gz"] : [])]) {
  test(`rows of ${atlas} are those of conus query`, async () => {
    const opened = await load(beside(atlas));
    let hits = 0;
    for (let i = 0; i < 12; i++) {
      const cone = { origin: place(90), toward: place(20), angle: Number((1 + 100 * random()).toFixed(2)), layers: i % 2 ? "all" : "visible", resolution: i % 3 ? 64 : 17, range: i % 4 ? undefined : [20, 20 + place(60)[0] ** 2] };
      const words = ["query", atlas, `--origin=${cone.origin}`, `--toward=${cone.toward}`, `--angle=${cone.angle}`, "--layers", cone.layers, `--resolution=${cone.resolution}`, ...(cone.range ? [`--range=${cone.range}`] : []), "-q", "--format"];
      const rows = await opened.select(cone);
      const wanted = conus(...words, "ndjson").trim().split("\n").map((line) => JSON.parse(line));
      assert.deepEqual(rows, wanted);
      assert.equal(await opened.text("tsv"), conus(...words, "tsv"));
      hits += rows.filter(({ pixels }) => pixels).length;
    }
    assert.ok(hits > 12);
    opened.close();
  });
}

test("what nobody said is as conus query has it, and settings are rows of options", async () => {
  const atlas = await load(beside("nested.nii.gz"));
  const cone = { origin: [0, 0, 90], toward: [0, 0, 0], angle: 10 };
  await atlas.select(cone);
  assert.equal(await atlas.text(), conus("query", "nested.nii.gz", "--origin", "0,0,90", "--toward", "0,0,0", "-q", "--format", "tsv"));
  assert.equal(JSON.parse(await atlas.text("sidecar")).GeneratedBy[0].Name, "conus");
  const refused = async (words, asked) => {
    await assert.rejects(atlas.select(asked), (error) => error instanceof ConusError && words.test(error.message) || assert.fail(String(error)));
    await assert.rejects(atlas.text(), /no answer/); // nor the one before
  };
  await refused(/^angle: how wide/, { ...cone, angle: undefined });
  await refused(/^angle: 171 is out of range/, { ...cone, angle: 171 });
  await refused(/^angle: "NaN" is not a number/, { ...cone, angle: NaN });
  await refused(/^angle: "0x14" is not a number/, { ...cone, angle: "0x14" });
  for (const angle of [false, true, null, [20], "20&layers=all", "20\0", () => 20]) await refused(/^angle: a number, a word or two/, { ...cone, angle });
  await refused(/^layers: a number, a word/, { ...cone, layers: "all&resolution=1" });
  await refused(/^layers=all&resolution: a number, a word/, { ...cone, "layers=all&resolution": 1 });
  await refused(/^resolution: "16.5" is not a whole/, { ...cone, resolution: 16.5 });
  for (const range of [[40], [40, 80, 90], [40, "80"], [40, NaN], [40, Infinity], [[40], 80]]) await refused(/^range: a number, a word or two/, { ...cone, range });
  await refused(/^range: "80,40" is not two numbers, the lower one first/, { ...cone, range: [80, 40] });
  await refused(/^angle: "10,20" is not a number/, { ...cone, angle: [10, 20] });
  await refused(/^cut: rows have none/, { ...cone, cut: [0, 0, 0] });
  await refused(/^layers: "some" is none/, { ...cone, layers: "some" });
  await refused(/^radius: a page asks nothing of this name/, { ...cone, radius: 3 });
  await refused(/^toward: is the origin/, { ...cone, toward: [0, 0, 90] });
  await refused(/^toward: a position is three numbers/, { ...cone, toward: [0, 0] });
  await refused(/^toward: a position is three numbers/, { ...cone, toward: [0, "1", 0] });
  assert.equal((await atlas.select({ ...cone, layers: undefined, resolution: undefined }))[0].name, JSON.parse(conus("query", "nested.nii.gz", "--origin", "0,0,90", "--toward", "0,0,0", "-q", "--format", "ndjson").split("\n")[0]).name);
  await assert.rejects(atlas.text("xml"), /none of sidecar, tsv/);
  const late = atlas.select(cone);
  atlas.close();
  await assert.rejects(late, /closed/);
  await assert.rejects(atlas.select(cone), /closed/);
});

test("what is no atlas is refused in conus's words", async () => {
  await assert.rejects(load(new Uint8Array(10), { name: "x.nii.gz" }), (error) => error instanceof ConusError && /^x\.nii\.gz: /.test(error.message));
  await assert.rejects(load(new Uint8Array(10)), /^ConusError: name: /);
  for (const source of [{}, [new Uint8Array(10)], "x.nii", null]) await assert.rejects(load(source), /^ConusError: name: /);
  const worker = () => ({ postMessage() { queueMicrotask(() => this.onerror({})); }, terminate() {} }); // as where its file is missing
  await assert.rejects(load({ "x.nii": new Uint8Array(1) }, { worker }), /^ConusError: the worker cannot be started/);
});

/** What the program says, and the files that it writes into a folder which has these. */
function asked(words, files) {
  const place = fs.mkdtempSync(path.join(folder, "asked-"));
  for (const [name, bytes] of Object.entries(files)) {
    fs.mkdirSync(path.dirname(path.join(place, name)), { recursive: true });
    fs.writeFileSync(path.join(place, name), bytes);
  }
  const { status: code, stdout, stderr } = spawnSync(process.env.CONUS, words, { cwd: place, encoding: "utf8", input: "" });
  const made = fs.readdirSync(place, { recursive: true }).filter((name) => !Object.hasOwn(files, name) && fs.statSync(path.join(place, name)).isFile());
  return { code, stdout, stderr, files: Object.fromEntries(made.map((name) => [name, fs.readFileSync(path.join(place, name))])) };
}

/** As texts in order, without the engine, which the processor names, and the sum of a sidecar that names it. */
function shown({ code, stdout, stderr, files }) {
  const plain = (text) => text.replaceAll(/rays, \w+/g, "rays").replace(/("Checksum": )"\w{64}"/, "$1");
  return { code, stdout: plain(stdout), stderr, files: Object.entries(files).map(([name, bytes]) => [name, plain(Buffer.from(bytes).toString("latin1"))]).sort() };
}

test("run: any command in memory as on a disk, to the byte", async () => {
  const poses = "query_id\tx\ty\tz\ttx\tty\ttz\na\t0\t0\t90\t0\t0\t0\nb\t80\t0\t0\t0\t3\t0\n";
  const files = { ...beside("nested.nii.gz"), "in/poses.tsv": Buffer.from(poses) };
  const aim = ["--origin", "0,0,90", "--toward", "0,0,0"];
  for (const words of [["--version"], ["help", "query"], ["info", "nested.nii.gz"], ["info", "nested.nii.gz", "--format", "tsv"],
    ["query", "nested.nii.gz", ...aim], ["query", "nested.nii.gz", ...aim, "-o", "in/a.tsv", "--mask", "in/mask.nii"],
    ["query", "nested.nii.gz", "--pose", "in/poses.tsv", "--format", "ndjson", "--layers", "all"],
    ["batch", "nested.nii.gz", "--poses", "in/poses.tsv", "--angle", "20", "-o", "in/rows.csv"],
    ["batch", "nested.nii.gz", "--poses", "-", "--angle", "20"],
    ["plan", "nested.nii.gz", "--poses", "in/poses.tsv", "--depth", "90", "--reach", "Core", "-o", "plan.json"],
    ["plan", "nested.nii.gz", "--poses", "in/poses.tsv", "--depth", "90", "--reach", "Core", "--avoid", "Shell outer,margin=2"],
    ["overlap", "nested.nii.gz", "nested.nii.gz", "--threshold", "1"], ["phantom", "slabs", "-o", "made"],
    ["query", "nested.nii.gz", "--angle", "200"], ["query", "nothing.nii", ...aim], ["nonsense"], []]) {
    assert.deepEqual(shown(await run(words, files)), shown(asked(words, files)), words.join(" "));
  }
});

test("run: a file that is replaced comes back, one that stays does not, and no call knows of another", async () => {
  const aim = ["query", "nested.nii.gz", "--origin", "0,0,90", "--toward", "0,0,0", "-q", "-o", "a.tsv"];
  const [first, second] = await Promise.all([aim, aim].map((words) => run(words, beside("nested.nii.gz"))));
  assert.deepEqual(first, second);
  const again = await run([...aim, "--force"], { ...beside("nested.nii.gz"), "a.tsv": new Uint8Array(3), "b/c.txt": new ArrayBuffer(2) });
  assert.deepEqual([again.code, Object.keys(again.files).sort()], [0, ["a.json", "a.tsv"]]);
  const hdf5 = await run(["info", "x.nwb"], { "x.nwb": Buffer.from("\x89HDF\r\n\x1a\n123456789", "latin1") });
  assert.match(hdf5.stderr, /x\.nwb: conus-hdf5 reads this, which WebAssembly/);
  await assert.rejects(run(["info", "x.nii"], { "x.nii": "text" }), /x\.nii: bytes are needed/);
  await assert.rejects(run("info x.nii"), /words: a list of texts is needed/);
  await assert.rejects(run(["info", "x.nii"], { "../x.nii": new Uint8Array(1) }), /a name of a file in the folder is needed/);
});
