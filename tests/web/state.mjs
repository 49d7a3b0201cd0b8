// SPDX-License-Identifier: BSD-3-Clause
// Links: what is written is read again, and what is not known is refused.
import assert from "node:assert";
import { execFileSync } from "node:child_process";
import { existsSync, readFileSync } from "node:fs";
import test from "node:test";
import { candidates } from "../../apps/web/page/files.js";
import { CONUS, TEMPLATES, start } from "./conus.mjs";

globalThis.CONUS_ROWS = JSON.parse((await start()).form());
globalThis.document = { createElement: () => ({ getContext: () => null }) };
const { ROWS, START, fromFragment, inPage, toCommand, toFragment, toMethods } = await import("../../apps/web/page/state.js");
const { Headset } = await import("../../apps/web/page/vr.js");

const seeded = (x) => () => (x = (Math.imul(x, 1664525) + 1013904223) >>> 0) / 2 ** 32;

test("10,000 random questions come back from their links", () => {
  const next = seeded(1);
  const number = (low, high) => Number((low + next() * (high - low)).toFixed(3));
  const point = () => [number(-300, 300), number(-300, 300), number(-300, 300)];
  for (let i = 0; i < 10000; i++) {
    const question = { origin: point(), toward: point(), angle: number(0.01, 170), layers: next() < 0.5 ? "visible" : "all", resolution: 1 + Math.floor(next() * 256), range: next() < 0.5 ? null : [number(0, 50), number(51, 300)], weight: next() < 0.5 ? null : `gauss=${number(0.01, 20)}`, cut: point() };
    const atlas = next() < 0.2 ? "" : `${String.fromCodePoint(...Array.from({ length: 9 }, () => 32 + Math.floor(next() * 900)))}@1f3c9a2b`;
    const text = toFragment(question, atlas);
    assert.deepEqual(fromFragment(`#${text}`), { question, atlas, embed: false }, text);
    assert.ok(atlas.length > 30 || text.length <= 300, text);
  }
});

test("the page begins with the rays of all programs", () => {
  const header = readFileSync(new URL("../../include/conus/selection.h", import.meta.url), "utf8");
  assert.equal(START.resolution, Number(/CONUS_RESOLUTION_DEFAULT (\d+)/.exec(header)[1]));
});

test("an empty link is the start, embed is a mode", () => {
  assert.deepEqual(fromFragment(""), { question: START, atlas: "", embed: false });
  assert.equal(fromFragment("#embed=1").embed, true);
});

for (const [link, words] of [["v=2", /version 2/], ["colour=red", /"colour"/], ["origin=1,2", /three numbers/], ["origin=1,2,x", /origin: x is not a number/], ["angle=0", /0.001 to 170/],
  ["angle=1e3", /number/], ["angle=", /number/], ["layers=some", /visible and all/], ["resolution=1025", /1 to 1024/], ["range=40", /two numbers/], ["range=40,40", /first below/], ["range=-1,40", /0 to/], ["resolution=16.5", /no whole number/], ["weight=gauss=1%26angle=3", /no weight/], ["origin=Infinity,0,0", /number/], ["toward=1e999,0,0", /number/],
  ["angle=20&angle=30", /"angle" twice/], ["__proto__=1", /__proto__/], ["origin=%ZZ", /malformed/i], [`atlas=${"x".repeat(2000)}`, /longer/], ["cut=<img src=x>", /number|three/]]) {
  test(`#${link.slice(0, 30)} is refused`, () => assert.throws(() => fromFragment(`#${link}`), words));
}

test("small numbers are read as conus page writes them", () => {
  assert.deepEqual(fromFragment("#origin=-90,20,1.0000000000000001e-05&angle=2.5").question, { ...START, origin: [-90, 20, 1e-5], angle: 2.5 });
});

test("cuts that nobody has placed are not in a link", () => {
  const link = toFragment(START, "");
  assert.doesNotMatch(link, /cut/);
  assert.deepEqual(fromFragment(link).question, START);
});

for (const [message, words] of [["/atlas/a.nii: no voxels", "a.nii: no voxels"], ["/atlas/my --best.nii: no voxels; --labels x uses it all the same", "my --best.nii: no voxels"],
  ["a.annot: a FreeSurfer annotation: give it as --labels, and the surface as ATLAS; needed is a volume", "a.annot: a FreeSurfer annotation; needed is a volume"],
  ["a.trx: 5 bytes, allowed are 4 (--max-memory)", "a.trx: 5 bytes, allowed are 4"],
  ["t1.nii: looks like an image; an atlas is needed ('conus atlases' lists those that are installed), --context draws an image, --pathway selects what is bright in it, --labels-anyway takes every value as a label",
    "t1.nii: looks like an image; an atlas is needed, “Image under the areas…” draws an image"]]) {
  test(`${message.slice(0, 30)} in the page's words`, () => assert.equal(inPage(message), words));
}

test("the command has what differs from the defaults", () => {
  assert.equal(toCommand(START, "aal.nii.gz"), "conus query aal.nii.gz --origin -90,20,20 --toward 0,-10,10 --angle 20");
  assert.equal(toCommand({ ...START, layers: "all", resolution: 32 }, "it's.nii"),
    "conus query 'it'\\''s.nii' --origin -90,20,20 --toward 0,-10,10 --angle 20 --layers all --resolution 32");
});

const skip = !existsSync(`${TEMPLATES}/aal.nii.gz`) && "mricron-data is not installed";
test("the rows of a weight are those of its command, whatever was asked before", { skip }, async () => {
  const conus = await start();
  for (const name of ["aal.nii.gz", "aal.nii.txt"]) conus.put(`${TEMPLATES}/${name}`);
  conus.open("/atlas/aal.nii.gz");
  const asked = [[1, "visible"], [4, "visible"], [4, "all"], [0.2, "visible"]].map(([sigma, layers], i) => ({ ...START, origin: [-90, 20 - 9 * i, 20], angle: 8 * sigma, layers, weight: `gauss=${sigma}` }));
  const wrong = (weight) => JSON.parse(conus.ask(-90, 20, 20, 0, -10, 10, `angle=20&weight=${weight}`)).error;
  for (const question of [START, ...asked, asked[0], START]) {
    const { origin, toward, angle, layers, resolution, weight } = question;
    assert.equal(JSON.parse(conus.ask(...origin, ...toward, `angle=${angle}&layers=${layers}&resolution=${resolution}${weight ? `&weight=${weight}` : ""}`)).error, undefined);
    const [, ...words] = toCommand(question, `${TEMPLATES}/aal.nii.gz`).split(" ");
    assert.equal(conus.rows(4), execFileSync(CONUS, [...words, "--format", "ndjson", "-q"]).toString(), words.join(" "));
    assert.match(wrong("gauss=99"), /^--weight: gauss: 99 is out of range/);
    assert.match(wrong("hard"), /gauss=DEGREES alone/);
  }
});

// A clock of the test's own: a frame of 10 ms, in which the hand moves by a degree. What is held is what was pointed at 150 ms
// before the press, so 15 degrees before, however soon presses follow one another.
test("a quick double press holds and lets go, and a third one holds what was before it", () => {
  const held = [], source = { targetRayMode: "tracked-pointer", handedness: "right", targetRaySpace: "ray" };
  const headset = new Headset({ draw() {}, show() {}, paint() {} }, { question: { ...START }, low: [-90, -90, -90], high: [90, 90, 90], hold: (question) => held.push(question), ask: () => new Promise(() => {}) });
  Object.assign(headset, { space: {}, session: { visibilityState: "visible", inputSources: [source] }, isTracked: false });
  headset.board.step = () => false;
  let time = 1000, turn = 0;
  const poseOf = (degrees) => {
    const [s, c] = [Math.sin(degrees * Math.PI / 180), Math.cos(degrees * Math.PI / 180)];
    return { transform: { matrix: Float32Array.of(c, 0, -s, 0, 0, 1, 0, 0, s, 0, c, 0, 0, 1.6, 0, 1) }, views: [] };
  };
  const frame = { getViewerPose: () => poseOf(0), getPose: () => poseOf(turn) };
  const run = (count) => {
    for (let i = 0; i < count; i++) headset.draw(time += 10, frame, turn++);
  };
  const press = () => {
    headset.press({ inputSource: source, frame });
    headset.release({ inputSource: source });
  };
  const pointed = () => [...headset.past[headset.newest].numbers];
  const before = [];
  const runWhole = (count) => {
    for (let i = 0; i < count; i++) {
      run(1);
      before.push(pointed());
    }
  };
  const isHeld = (at) => assert.deepEqual([...headset.held], before.at(at));
  runWhole(40);
  press();
  isHeld(-16);
  runWhole(6); // 60 ms later
  press();
  assert.equal(headset.held, null);
  runWhole(3);
  press();
  isHeld(-16); // 90 ms after the first press: what was pointed at before that
  press(); // in the same frame
  assert.equal(headset.held, null);
  assert.deepEqual(held.map(({ origin, toward }) => [...origin, ...toward]), [before[24], before[33]].map((numbers) => numbers.slice(0, 6)));
});

test("another row is in links, commands and methods", () => {
  const more = [{ name: "slice-fraction", type: "number", default: "0.2", range: { low: 0, high: 1 } }, { name: "no-sky", type: "flag" }];
  ROWS.push(...more);
  try {
    const question = { ...START, "slice-fraction": 0.0005, "no-sky": true };
    assert.match(toFragment(question, ""), /&slice-fraction=0.0005&no-sky=1/);
    assert.ok(toCommand(question, "a.nii").endsWith(" --angle 20 --slice-fraction 0.0005 --no-sky"));
    assert.match(toMethods(question, { version: "0", name: "a", transform: "" }), / Other settings were --slice-fraction 0.0005 --no-sky\. /);
    assert.doesNotMatch(toMethods({ ...question, "slice-fraction": undefined, "no-sky": undefined }, { name: "a" }), /Other/);
  } finally {
    ROWS.splice(-2);
  }
});

test("the likeliest atlas of several files comes first", () => {
  assert.deepEqual(candidates(["aal.nii.txt", "aal.nii.lut", "t1.nii.gz", "aal.nii.gz", "x.atlas.json", "readme"]), ["x.atlas.json", "t1.nii.gz", "aal.nii.gz"]);
  assert.deepEqual(candidates(["readme"]), []);
});
