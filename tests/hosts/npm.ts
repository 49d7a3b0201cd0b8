// SPDX-License-Identifier: BSD-3-Clause
// What the types of npm's package allow, and what they do not: tsc --strict.
import { ConusError, load, type Question, type Row } from "conus";
import { run } from "conus/run";

const atlas = await load({ "aal.nii.gz": new Uint8Array(8), "aal.nii.txt": new Blob(["1 A"]) });
const cone: Question = { origin: [0, 0, 90], toward: [0, 0, 0], angle: 10 };
const rows: Row[] = await atlas.select({ ...cone, layers: "all", range: [40, 80] });
const share: number = rows[0].share + (rows[0].distance_mm ?? 0);
const text: string = await atlas.text("sidecar");
console.log(share, text, atlas.low[2], atlas.objects[0].rgb[0], new ConusError("").message);
const { code, files } = await run(["info", "a.nii"], { "a.nii": new ArrayBuffer(8) });
const out: [number, Uint8Array] = [code, files["a.tsv"]];
console.log(out);

// @ts-expect-error words are a list
await run("info a.nii");
// @ts-expect-error a place has three numbers
await atlas.select({ origin: [0, 0], toward: [0, 0, 0], angle: 10 });
// @ts-expect-error the angle is not guessed
await atlas.select({ origin: [0, 0, 1], toward: [0, 0, 0] });
// @ts-expect-error a range has two ends
await atlas.select({ ...cone, range: [40] });
// @ts-expect-error there are two kinds of layers
await atlas.select({ ...cone, layers: "some" });
// @ts-expect-error rows are text
await atlas.text("xml");
