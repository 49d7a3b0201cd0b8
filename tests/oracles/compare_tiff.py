#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""compare_tiff.py DUMP_VOLUME: stacks that tifffile writes, and that libtiff's tiffcp copies into its own strips, tiles,
byte orders and compressions, read by conus's TIFF reader. The voxels must be those of the array.

The array's axes are page, row and column; conus's i, j and k run the other way round, so that the bytes have the same
order. What both programs can write is tried: every combination in scripts/test --long, else of tifffile's every fifth and
of tiffcp's every seventh, so that each choice meets each other. A file that conus is meant to refuse stands in refusals()
with the words.

Exit 77 = skipped."""

import itertools
import json
import os
import shutil
import subprocess
import sys
import tempfile

try:
    import numpy as np
    import tifffile
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

from sample import every

PLACE = ",resolution=25,orientation=asr"
TYPES = ("u1", "i1", "u2", "i2", "u4", "i4", "f4", "u8", "f8")
SHAPE = (5, 67, 83)  # not a multiple of any tile
# tiffcp's own predictor and tiles; -B and -L are the byte orders, -8 is BigTIFF.
COPIES = [("-c", "none", "-r", "7"), ("-c", "lzw", "-r", "9"), ("-c", "lzw:2"), ("-c", "zip", "-r", "1"),
          ("-c", "zip:2"), ("-c", "lzw", "-t", "-w", "32", "-l", "16"), ("-c", "zip:2", "-t", "-w", "128", "-l", "128"),
          ("-c", "none", "-t", "-w", "16", "-l", "48"), ("-c", "lzw:2", "-t", "-w", "48", "-l", "16")]
LAYOUTS = [(), ("-B",), ("-8",), ("-8", "-B")]


def array_of(kind, smooth):
    """Noise, which breaks wrong orders; or slopes and plateaus, from which compression makes long strings."""
    generator = np.random.default_rng(7)
    if smooth:
        k, j, i = np.indices(SHAPE)
        values = (k * 3 + j // 9 * 5 + i // 11) % 120
    else:
        bits = 7 if kind[1] == "1" else 15
        values = generator.integers(0, 1 << bits, SHAPE)
        if kind in ("u4", "u8"):
            values = generator.integers(0, 1 << 32, SHAPE)
    return values.astype(kind)


def read(dump, path, folder, place=PLACE):
    """(float32 voxels, uint32 labels or None) in the array's order, or conus's message."""
    outputs = [os.path.join(folder, name) for name in ("values", "labels")]
    for output in outputs:
        if os.path.exists(output):
            os.remove(output)
    done = subprocess.run([dump, path + place, *outputs], capture_output=True, text=True, check=False)
    if done.returncode:
        return done.stderr.strip()
    dim = [int(x) for x in done.stdout.split("\n")[0].split()[1:]]
    shape = dim[::-1]
    values = np.fromfile(outputs[0], "f4").reshape(shape)
    labels = np.fromfile(outputs[1], "u4").reshape(shape) if os.path.exists(outputs[1]) else None
    return values, labels


def check(dump, path, folder, array, what):
    got = read(dump, path, folder)
    if isinstance(got, str):
        return [f"{what}: {got}"]
    values, labels = got
    wrong = []
    if not np.array_equal(values, array.astype("f4")):
        wrong.append(f"{what}: values differ")
    if labels is None or not np.array_equal(labels, array.astype("u4")):
        wrong.append(f"{what}: labels differ")
    return wrong


def written_by_tifffile(folder):
    path = os.path.join(folder, "tifffile.tif")
    kinds = itertools.product(TYPES, (False, True), "<>", (None, "zlib"), (False, True))
    for kind, smooth, order, compression, big in every(5, kinds):
        array = array_of(kind, smooth)
        options = [{}]
        if compression:
            options = [{}, {"predictor": True}] if kind[0] in "ui" and kind != "u8" else [{}]
            options += [{"tile": (32, 48)}, {"rowsperstrip": 10}]
        for option in options:
            tifffile.imwrite(path, array.astype(order + kind), byteorder=order, compression=compression, bigtiff=big,
                             photometric="minisblack", **option)
            yield path, array, f"tifffile {kind} {order} {compression} big={big} {option}"
    for kind in ("u1", "u2", "f4"):  # what ImageJ opens
        array = array_of(kind, True)
        tifffile.imwrite(path, array, imagej=True, photometric="minisblack")
        yield path, array, f"ImageJ {kind}"


def copied_by_libtiff(folder):
    source, path = os.path.join(folder, "source.tif"), os.path.join(folder, "copy.tif")
    kinds = itertools.product(("u1", "u2", "u4", "i2", "f4"), (False, True), COPIES, LAYOUTS)
    for kind, smooth, copy, layout in every(7, kinds):
        if kind == "f4" and any(":2" in word for word in copy):
            continue  # tiffcp has another predictor for these
        array = array_of(kind, smooth)
        tifffile.imwrite(source, array, photometric="minisblack")
        subprocess.run(["tiffcp", *layout, *copy, source, path], check=True, capture_output=True)
        yield path, array, f"tiffcp {kind} smooth={smooth} {' '.join(layout + copy)}"


def imagej_of_one_directory(path, array):
    """As ImageJ writes stacks above 4 GB: one directory, the pages behind one another, big-endian."""
    text = f"ImageJ=1.53t\nimages={len(array)}\nslices={len(array)}\nloop=false\n"
    tifffile.imwrite(path, array[0].astype(">u2"), byteorder=">", description=text, metadata=None,
                     photometric="minisblack")
    with open(path, "ab") as file:
        file.write(array[1:].astype(">u2").tobytes())


def refusals(folder):
    """(path, words of the message)."""
    path = os.path.join(folder, "refused.tif")
    array = array_of("u1", True)
    tifffile.imwrite(path, np.zeros((3, 20, 20, 3), "u1"), photometric="rgb")
    yield path, "SamplesPerPixel: found 3, allowed is 1: one number a pixel, no colours (RGB)"
    tifffile.imwrite(path, np.zeros((20, 20), "u1"), photometric="miniswhite")
    yield path, "PhotometricInterpretation: found 0"
    with tifffile.TiffWriter(path) as writer:
        writer.write(array[0], contiguous=False)
        writer.write(array[1, :40], contiguous=False)
    yield path, "page 1: 83 x 40 pixels of 8 bits, SampleFormat 1, but page 0 has 83 x 67 of 8 bits"
    with tifffile.TiffWriter(path) as writer:
        writer.write(array[0], contiguous=False)
        writer.write(array[0].astype("u2"), contiguous=False)
    yield path, "page 1: 83 x 67 pixels of 16 bits"
    tifffile.imwrite(path, np.zeros((20, 20), "c8"))
    yield path, "BitsPerSample: found 64 of SampleFormat 6"
    tifffile.imwrite(path, np.zeros((20, 20), "f2"))
    yield path, "BitsPerSample: found 16 of SampleFormat 3"
    tifffile.imwrite(path, array_of("f4", True), photometric="minisblack", compression="zlib")
    floating = os.path.join(folder, "floating.tif")
    subprocess.run(["tiffcp", "-c", "zip:3", path, floating], check=True, capture_output=True)
    yield floating, "Predictor: found 3"
    tifffile.imwrite(path, array, photometric="minisblack")
    packed = os.path.join(folder, "packbits.tif")
    subprocess.run(["tiffcp", "-c", "packbits", path, packed], check=True, capture_output=True)
    yield packed, "Compression: found 32773, allowed are 1 (none), 5 (LZW) and 8 (deflate)"
    tifffile.imwrite(path, array_of("u1", True).reshape(1, 5, 1, 67, 83).repeat(2, 0), imagej=True,
                     metadata={"axes": "TZCYX"})
    yield path, "ImageDescription: found 5 slices, 1 channels and 2 frames"
    text = "ImageJ=1.53t\nimages=9\nslices=9\n"
    tifffile.imwrite(path, array[0], description=text, metadata=None, photometric="minisblack")
    yield path, "ImageJ says images=9, the file has 1 pages and too few bytes behind its first"


def check_places(dump, folder):
    """What a stack without, with half of and with all of its place says."""
    path = os.path.join(folder, "lone.tif")
    tifffile.imwrite(path, array_of("u1", True), photometric="minisblack")
    wrong = []
    cases = [
        ("", None, ": no resolution and no orientation is given, and there is no metadata.json beside it; give"),
        (",resolution=25", None, ": no orientation is given, and"),
        (",orientation=asr", {"resolution": [25, 25, 25], "shape": SHAPE}, ""),
        ("", {"resolution": [25, 25, 25], "orientation": "asr"}, ""),
        ("", {"resolution": [25, 25, 25]}, ": no orientation in metadata.json beside it; give"),
        ("", {"resolution": [25, 25], "orientation": "asr"}, "resolution: three numbers above 0"),
        ("", {"resolution": [25, 25, 25], "orientation": "asr", "shape": [67, 5, 83]},
         "shape: metadata.json says 67 x 5 x 83, the stack has 5 pages of 67 rows and 83 columns"),
        ("", {"resolution": [25, 25, 25], "orientation": "aas"}, "orientation: found \"aas\""),
        (",resolution=25:0:1,orientation=asr", None, "resolution: found \"25:0:1\""),
        (",resolution=25,orientation=axr", None, "orientation: found \"axr\""),
    ]
    for place, metadata, words in cases:
        beside = os.path.join(folder, "metadata.json")
        if os.path.exists(beside):
            os.remove(beside)
        if metadata:
            with open(beside, "w", encoding="utf-8") as file:
                json.dump(metadata, file)
        got = read(dump, path, folder, place)
        got = got if isinstance(got, str) else ""
        if (words not in got) if words else got:
            wrong.append(f"place \"{place}\" {metadata}: \"{got}\"")
    return wrong, len(cases)


def main():
    dump = sys.argv[1]
    wrong, files = [], 0
    if not shutil.which("tiffcp"):
        print("skipped: no tiffcp")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as folder:
        for path, array, what in itertools.chain(written_by_tifffile(folder), copied_by_libtiff(folder)):
            wrong += check(dump, path, folder, array, what)
            files += 1
        path = os.path.join(folder, "imagej.tif")
        array = array_of("u2", False)
        imagej_of_one_directory(path, array)
        wrong += check(dump, path, folder, array, "ImageJ, one directory")
        for path, words in refusals(folder):
            got = read(dump, path, folder)
            if not isinstance(got, str) or words not in got or "\n" in got:
                wrong.append(f"not refused with \"{words}\": {got if isinstance(got, str) else 'read'}")
            files += 1
        more, count = check_places(dump, folder)
        wrong += more
    print(f"{files + 1} stacks, {count} places; {len(wrong)} differ")
    print("\n".join(wrong[:20]), end="\n" if wrong else "")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
