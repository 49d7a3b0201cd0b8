#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""compare_zarr.py DUMP_VOLUME SHARED_DATA: stores of Zarr 3 and 2, written here by their specifications with numpy,
zlib, /usr/bin/zstd and libblosc, and read by conus: voxel by voxel the array, and where the axes lie, by the rule of
OME (scale and translation count from the centre of the first voxel); of the stores every fifth, so that each layout
has one or two types of numbers, and all in scripts/test --long. Random levels of Zarr 2 that zarr-python writes, if it
is there, and random arrays of Zarr 3 that npm's zarrita writes, if $NODE_PATH has it. Then the samples of other
writers, against the counts of labels in their expected.json; and what must be refused, with its words.

Exit 77 = skipped."""

import ctypes
import itertools
import json
import os
import random
import struct
import subprocess
import sys
import tempfile
import zlib

try:
    import numpy as np
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

from sample import every

SHAPE = (11, 14, 9)  # a multiple of no chunk
ALL = 2**64 - 1
PLACE = ",resolution=25:20:10,orientation=asr"


def crc32c(data):
    total = 0xFFFFFFFF
    for byte in data:
        total ^= byte
        for _ in range(8):
            total = total >> 1 ^ (0x82F63B78 if total & 1 else 0)
    return struct.pack("<I", total ^ 0xFFFFFFFF)


def zstd(data):
    return subprocess.run(["zstd", "-c", "-q"], input=data, capture_output=True, check=True).stdout


def gzip(data):
    packer = zlib.compressobj(wbits=31)
    return packer.compress(data) + packer.flush()


def blosc(data):
    library = ctypes.CDLL("libblosc.so.1")
    out = ctypes.create_string_buffer(len(data) + 16)
    size = library.blosc_compress_ctx(5, 1, ctypes.c_size_t(4), ctypes.c_size_t(len(data)), data, out,
                                      ctypes.c_size_t(len(out)), b"zstd", ctypes.c_size_t(0), 1)
    return out.raw[:size]


PACKERS = {"zstd": zstd, "gzip": gzip, "zlib": zlib.compress, "blosc": blosc, "crc32c": lambda b: b + crc32c(b)}


def pack(chunk, order, endian, packings):
    data = np.ascontiguousarray(chunk.transpose(order)).astype(chunk.dtype.newbyteorder(endian)).tobytes()
    for packing in packings:
        data = PACKERS[packing](data)
    return data


def chunks_of(array, shape):
    """(key, whole chunk padded with ones) of all chunks."""
    for at in itertools.product(*(range(-(-n // c)) for n, c in zip(array.shape, shape))):
        chunk = np.ones(shape, array.dtype)
        part = array[tuple(slice(a * c, (a + 1) * c) for a, c in zip(at, shape))]
        chunk[tuple(slice(0, n) for n in part.shape)] = part
        yield at, chunk, bool(part.any())


def shard(chunk, inner, first, chain):
    """A shard: chunks in the reverse order with gaps between them, those of zeros left out."""
    parts = [(at, None if not any_ else pack(part, *chain)) for at, part, any_ in chunks_of(chunk, inner)]
    index_size = 16 * len(parts) + 4
    entries, data = {}, b""
    for at, part in reversed(parts):
        entries[at] = (ALL, ALL) if part is None else (len(data) + (index_size if first else 0) + 3, len(part))
        data += b"" if part is None else b"gap" + part
    index = b"".join(struct.pack("<QQ", *entries[at]) for at, _ in parts)
    index += crc32c(index)
    return index + data if first else data + index


def codec(name):
    return {"name": name, "configuration": {"zstd": {"level": 0, "checksum": False}, "gzip": {"level": 5}}.get(name, {})}


def write_three(folder, array, case):
    rank = array.ndim
    order = case.get("order", range(rank))
    endian = case.get("endian", "<")
    packings = case.get("packings", ())
    codecs = [{"name": "bytes", "configuration": {"endian": {"<": "little", ">": "big"}[endian]}}]
    codecs += [codec(name) for name in packings]
    if "order" in case:
        codecs.insert(0, {"name": "transpose", "configuration": {"order": list(order)}})
    chunk = case["chunk"]
    if "inner" in case:
        codecs = [{"name": "sharding_indexed", "configuration": {
            "chunk_shape": case["inner"], "codecs": codecs, "index_location": "start" if case.get("first") else "end",
            "index_codecs": [{"name": "bytes", "configuration": {"endian": "little"}}, {"name": "crc32c"}]}}]
    encoding = case.get("encoding", {"name": "default"})
    metadata = {"zarr_format": 3, "node_type": "array", "shape": array.shape, "data_type": array.dtype.name,
                "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": chunk}},
                "chunk_key_encoding": encoding, "fill_value": 0, "codecs": codecs, "attributes": {}}
    os.makedirs(folder)
    with open(os.path.join(folder, "zarr.json"), "w", encoding="utf-8") as stream:
        json.dump(metadata, stream)
    prefix = ["c"] if encoding["name"] == "default" else []
    separator = encoding.get("configuration", {}).get("separator", "/" if prefix else ".")
    for at, part, any_ in chunks_of(array, chunk):
        if any_:
            chain = (order, endian, packings)
            data = shard(part, case["inner"], case.get("first"), chain) if "inner" in case else pack(part, *chain)
            put(os.path.join(folder, separator.join(prefix + [str(a) for a in at])), data)


def put(path, data):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as stream:
        stream.write(data)


def write_two(folder, array, case):
    packings = case.get("packings", ())
    metadata = {"zarr_format": 2, "shape": array.shape, "chunks": case["chunk"], "fill_value": 0, "filters": None,
                "dtype": array.dtype.newbyteorder(case.get("endian", "<")).str, "order": case.get("letter", "C"),
                "compressor": {"id": packings[0]} if packings else None,
                "dimension_separator": case.get("separator", ".")}
    put(os.path.join(folder, ".zarray"), json.dumps(metadata).encode())
    order = range(array.ndim)[::-1] if case.get("letter") == "F" else range(array.ndim)
    for at, part, any_ in chunks_of(array, case["chunk"]):
        if any_:
            data = pack(part, order, case.get("endian", "<"), packings)
            put(os.path.join(folder, metadata["dimension_separator"].join(map(str, at))), data)


def cases():
    chunk = (4, 5, 6)
    for packings in ((), ("zstd",), ("gzip",), ("blosc",), ("crc32c",), ("zstd", "crc32c"), ("crc32c", "gzip")):
        yield 3, {"chunk": chunk, "packings": packings}
        yield 3, {"chunk": (4, 10, 6), "inner": (2, 5, 3), "packings": packings, "first": len(packings) == 1}
    for order in itertools.permutations(range(3)):
        yield 3, {"chunk": chunk, "order": order, "endian": ">"}
        yield 3, {"chunk": (4, 10, 6), "inner": (4, 5, 3), "order": order, "packings": ("zstd",)}
    for encoding in ({"name": "default", "configuration": {"separator": "."}}, {"name": "v2"},
                     {"name": "v2", "configuration": {"separator": "/"}}):
        yield 3, {"chunk": (20, 20, 20), "encoding": encoding}
    for packings in ((), ("zstd",), ("gzip",), ("zlib",), ("blosc",)):
        yield 2, {"chunk": chunk, "packings": packings}
        yield 2, {"chunk": chunk, "packings": packings, "letter": "F", "endian": ">", "separator": "/"}


def make_array(kind, rank):
    generator = np.random.default_rng(5)
    top = {"1": 100, "2": 30000}.get(kind[1], 2**31 - 1)
    array = generator.integers(0, top, SHAPE).astype(kind)
    array[:, :5, :6] = 0  # whole chunks that are not written
    return array.reshape((1,) * (rank - 3) + SHAPE)


def read(dump, path, folder):
    """(uint32 labels in the array's order, {key: words}), or (None, message)."""
    outputs = [os.path.join(folder, name) for name in ("values", "labels")]
    done = subprocess.run([dump, path, *outputs], capture_output=True, text=True, check=False)
    if done.returncode:
        return None, done.stderr.strip()
    said = dict(line.split(" ", 1) for line in done.stdout.splitlines() if not line.startswith("note"))
    shape = [int(x) for x in said["dim"].split()][::-1]
    return np.fromfile(outputs[1], "u4").reshape(shape), said


def fail(*words):
    print(*words)
    sys.exit(1)


def compare_written(dump, folder):
    count = 0
    for (version, case), kind in every(5, itertools.product(cases(), ("u1", "u2", "i4", "u4", "u8", "f4"))):
        rank = 5 if kind == "u2" and "order" not in case else 3
        extra = (1,) * (rank - 3)
        case = dict(case, **{k: extra + case[k] for k in ("chunk", "inner") if k in case})
        array = make_array(kind, rank)
        store = os.path.join(folder, str(count))
        (write_three if version == 3 else write_two)(store, array, case)
        got, said = read(dump, store + PLACE, folder)
        if got is None or not np.array_equal(got, array.reshape(SHAPE).astype("u4")):
            fail(version, case, kind, said)
        count += 1
    return count


def group_of(levels, unit, orientation):
    axes = [{"name": n, "type": "space", "unit": unit, "orientation": {"type": "anatomical", "value": o}}
            for n, o in zip("zyx", orientation)]
    datasets = [{"path": path, "coordinateTransformations": [{"type": "scale", "scale": scale},
                                                              {"type": "translation", "translation": translation}]}
                for path, scale, translation in levels]
    return {"zarr_format": 3, "node_type": "group",
            "attributes": {"ome": {"version": "0.5", "multiscales": [{"axes": axes, "datasets": datasets}]}}}


def compare_places(dump, folder):
    """Axes to the left, back and below, levels of 20 and 40 um; a level by number, by size and by its folder."""
    store = os.path.join(folder, "places.ome.zarr")
    array = make_array("u2", 3)
    levels = [("s0", [20, 20, 20], [0, 0, 0]), ("s1", [40, 40, 40], [10, 10, 10])]
    for path, *_ in levels:
        write_three(os.path.join(store, path), array[::2] if path == "s1" else array, {"chunk": (6, 6, 6)})
    ways = ("anterior-to-posterior", "superior-to-inferior", "right-to-left")
    put(os.path.join(store, "zarr.json"), json.dumps(group_of(levels, "micrometer", ways)).encode())
    axes = np.array([[0, -1, 0], [0, 0, -1], [-1, 0, 0]])  # in the world, of the array's axes
    for path, level in ((store, 0), (store + ",level=1", 1), (store + ",resolution=40", 1), (store + "/s1", 1),
                        (store + "/", 0)):
        got, said = read(dump, path, folder)
        if got is None:
            fail(path, said)
        _, scale, translation = levels[level]
        wanted = np.eye(4)
        wanted[:3, :3] = (axes.T * np.array(scale) / 1000)[:, ::-1]
        wanted[:3, 3] = axes.T @ np.array(translation) / 1000
        affine = np.array(said["affine"].split(), float).reshape(4, 4)
        if got.shape[0] != (array[::2] if level else array).shape[0] or not np.allclose(affine, wanted, atol=1e-12):
            fail(path, affine, wanted)
    corner, said = read(dump, store + ",level=1,resolution=40,orientation=asr", folder)
    if corner is None or not np.allclose(np.array(said["affine"].split(), float).reshape(4, 4)[:3, 3], -0.02):
        fail("the corner of the first voxel is the origin where the place is stated", said)
    for words, path in (("level: found 2, allowed are 0 to 1", store + ",level=2"),
                        ("no level has voxels of 30", store + ",resolution=30")):
        got, said = read(dump, path, folder)
        if got is not None or words not in said:
            fail(path, said)


def random_level(registry, group, path, source):
    """Writes an array of random shape, type, chunks, order and codec: (its voxels, leading axis and all)."""
    shape = [source.randint(1, 20) for _ in range(3)]
    lead = [source.randint(1, 3)] if source.random() < 0.3 else []
    kind = source.choice("<>") + source.choice(["u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8"])
    top = 100 if kind[2] == "1" else 30000
    array = np.random.default_rng(source.getrandbits(32)).integers(0, top, lead + shape).astype(kind)
    array.reshape(-1, *shape)[:, : shape[0] // 2] = 7  # which is the fill value: the writer leaves such chunks out
    array[..., -1, -1, -1] = 8
    compressor = source.choice([None, {"id": "zlib", "level": 3}, {"id": "gzip", "level": 5}, {"id": "zstd", "level": 2}] + [
        {"id": "blosc", "cname": name, "shuffle": shuffle, "clevel": 5}
        for name, shuffle in (("lz4", 0), ("zstd", 1), ("zlib", 2))])
    out = group.create_dataset(path, shape=array.shape, dtype=kind, fill_value=7, write_empty_chunks=False,
                               chunks=[1] * len(lead) + [source.randint(1, n + 3) for n in shape],
                               order=source.choice("CF"), compressor=compressor and registry.get_codec(compressor))
    out[...] = array
    return array


def compare_another_writer(dump, folder):
    try:
        import zarr as writer
        from numcodecs import registry
    except ImportError as missing:
        print(f"skipped: stores of zarr-python: {missing}")
        return
    source = random.Random(11)
    count = 0
    for i in range(40):
        path = os.path.join(folder, f"other{i}.ome.zarr")
        separator = source.choice("./")
        group = writer.group(writer.DirectoryStore(path, dimension_separator=separator))
        arrays = [random_level(registry, group, str(level), source) for level in range(source.randint(1, 4))]
        datasets = [{"path": str(k), "coordinateTransformations": [{"type": "scale", "scale": [k + 1] * array.ndim}]}
                    for k, array in enumerate(arrays)]
        group.attrs["multiscales"] = [{"version": "0.4", "datasets": datasets}]
        for level, array in enumerate(arrays):
            for volume, voxels in enumerate(array.reshape(-1, *array.shape[-3:])):
                got, said = read(dump, f"{path}{PLACE},level={level},volume={volume}", folder)
                if got is None or not np.array_equal(got, voxels.astype("u4")):
                    fail("zarr-python", writer.__version__, path, level, volume, group[str(level)].info, said)
            count += 1
    print(f"zarr-python {writer.__version__}: {count} levels of 40 stores")


def compare_zarrita(dump, folder):
    modules = os.environ.get("NODE_PATH", "")
    if not os.path.isdir(os.path.join(modules, "zarrita")):
        print("skipped: stores of zarrita: $NODE_PATH has none (npm install zarrita)")
        return
    here = os.path.dirname(os.path.abspath(__file__))
    stores = os.path.join(folder, "zarrita")
    with open(os.path.join(here, "zarrita_stores.mjs"), encoding="utf-8") as script:
        lines = subprocess.run(["node", "--input-type=module", "-", stores, "200"], stdin=script, check=True,
                               capture_output=True, text=True, cwd=os.path.dirname(modules)).stdout.splitlines()
    for i, line in enumerate(lines):
        case = json.loads(line)
        array = np.full(case["shape"], case["fill"], "u4")
        array[tuple(slice(n) for n in case["written"])] = np.reshape(case.pop("values"), case["written"])
        for volume, voxels in enumerate(array.reshape(-1, *array.shape[-3:])):
            got, said = read(dump, f"{stores}/{i}{PLACE},volume={volume}", folder)
            if got is None or not np.array_equal(got, voxels):
                fail("zarrita", i, volume, case, said)
    with open(os.path.join(modules, "zarrita/package.json"), encoding="utf-8") as stream:
        print(f"zarrita {json.load(stream)['version']}: {len(lines)} arrays")


def compare_samples(dump, folder, shared):
    samples = os.path.join(shared, "files-2026")
    if not os.path.isdir(samples):
        print(f"skipped: the samples of other writers: {samples} is not there")
        return
    with open(os.path.join(samples, "omezarr/expected.json"), encoding="utf-8") as stream:
        expected = json.load(stream)
    for name, wanted in expected.items():
        got, said = read(dump, os.path.join(samples, "omezarr", name) + ",orientation=asr", folder)
        if got is None or list(got.shape) != wanted["shape"] or int(got.sum(dtype="u8")) != wanted["sum"]:
            fail(name, said)
        for label, count in wanted["voxels_by_label"].items():
            if int((got == int(label)).sum()) != count:
                fail(name, "label", label, int((got == int(label)).sum()), "not", count)
        spacing = np.abs(np.array(said["affine"].split(), float).reshape(4, 4)[:3, :3]).sum(axis=0)[::-1]
        unit = {"micrometer": 1000, "millimeter": 1}[wanted["unit"]]
        if not np.allclose(spacing * unit, wanted["scale"]):
            fail(name, spacing)
    for name in ("cut", "crc_wrong", "index_beyond"):
        got, said = read(dump, os.path.join(samples, "zarr_hostile", name + ".ome.zarr") + ",orientation=asr", folder)
        if got is not None or "\n" in said or not any(w in said for w in ("damaged", "index of the shard")):
            fail(name, "is read, or refused with other words:", said)


def main():
    dump, shared = sys.argv[1:3]
    with tempfile.TemporaryDirectory() as folder:
        count = compare_written(dump, folder)
        compare_places(dump, folder)
        compare_another_writer(dump, folder)
        compare_zarrita(dump, folder)
        compare_samples(dump, folder, shared)
    print(f"{count} stores, levels and samples: the same voxels")


if __name__ == "__main__":
    main()
