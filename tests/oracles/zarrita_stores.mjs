// SPDX-License-Identifier: BSD-3-Clause
// Writes random arrays of Zarr 3 with npm's zarrita, for compare_zarr.py: COUNT of them to OUT/0, OUT/1, ...; prints a
// line of JSON for each, with its shape, the voxels that were written, from a corner on, and the fill value of the rest.
//
// usage: cd FOLDER_WITH_NODE_MODULES && node --input-type=module - OUT COUNT <zarrita_stores.mjs
import FileSystemStore from "@zarrita/storage/fs";
import * as zarr from "zarrita";

const [out, count] = process.argv.slice(2);
const arrays = { uint8: Uint8Array, int8: Int8Array, uint16: Uint16Array, int16: Int16Array, uint32: Uint32Array,
    int32: Int32Array, uint64: BigUint64Array, int64: BigInt64Array, float32: Float32Array, float64: Float64Array };
const blosc = ["lz4", "lz4hc", "zstd", "zlib"];

let state = 7;
// mulberry32
function random() {
    state = (state + 0x6d2b79f5) | 0;
    let t = Math.imul(state ^ (state >>> 15), state | 1);
    t ^= t + Math.imul(t ^ (t >>> 7), t | 61);
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
}
const from = (low, high) => low + Math.floor(random() * (high - low + 1));
const pick = (list) => list[from(0, list.length - 1)];

for (let i = 0; i < Number(count); i++) {
    const data_type = pick(Object.keys(arrays));
    const lead = random() < 0.3 ? [from(1, 3)] : [];
    const shape = [...lead, from(1, 20), from(1, 20), from(1, 20)];
    const chunk_shape = shape.map((n, axis) => (axis < lead.length ? 1 : from(1, n + 2)));
    const written = shape.map((n, axis) => (axis < lead.length || random() < 0.7 ? n : from(1, n)));
    const codecs = [{ name: "bytes", configuration: { endian: pick(["little", "big"]) } }];
    if (random() < 0.5) {
        codecs.unshift({ name: "transpose", configuration: { order: shape.map((_, k) => shape.length - 1 - k) } });
    }
    const packing = pick(["none", "zstd", "blosc"]);
    if (packing === "zstd") {
        codecs.push({ name: "zstd", configuration: { level: from(1, 9), checksum: false } });
    } else if (packing === "blosc") {
        codecs.push({ name: "blosc", configuration: { cname: pick(blosc), clevel: from(1, 9), shuffle: "shuffle",
            typesize: arrays[data_type].BYTES_PER_ELEMENT, blocksize: 0 } });
    }
    const fill = from(0, 100);
    const is_wide = data_type.endsWith("64") && !data_type.startsWith("float");
    const top = data_type.endsWith("8") ? 100 : 30000;
    const values = Array.from({ length: written.reduce((a, b) => a * b) }, () => from(0, top));
    const array = await zarr.create(new zarr.Location(new FileSystemStore(`${out}/${i}`)), {
        shape, chunkShape: chunk_shape, dtype: data_type, codecs, fillValue: fill });
    let stride = 1;
    const strides = [];
    for (let k = shape.length; k-- > 0; stride *= written[k]) {
        strides[k] = stride;
    }
    await zarr.set(array, written.map((n) => zarr.slice(n)), {
        data: arrays[data_type].from(is_wide ? values.map(BigInt) : values), shape: written, stride: strides });
    console.log(JSON.stringify({ data_type, shape, chunk_shape, codecs, fill, written, values }));
}
