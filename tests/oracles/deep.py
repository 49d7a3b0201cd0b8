#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""`conus query --layers all --deep`, read by OpenImageIO, its names decoded from the file format's description alone,
against the rows that the same query reports.

usage: deep.py CONUS; exit 77 = skipped."""
import json
import math
import os
import struct
import subprocess
import sys
import tempfile
import zlib

try:
    import OpenImageIO as oiio
except ImportError:
    print("skipped: no python3-openimageio")
    sys.exit(77)


class Cursor:
    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, count):
        self.at += count
        return self.data[self.at - count : self.at]

    def number(self, form="<i"):
        return struct.unpack(form, self.take(struct.calcsize(form)))[0]

    def varint(self):
        value, shift = 0, 0
        while True:
            byte = self.take(1)[0]
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return value

    def strings(self):
        lengths = [self.varint() for _ in range(self.number())]
        return [self.take(length) for length in lengths]


def names_in(path):
    """{channel: {id: [texts]}} of the attribute idManifest."""
    with open(path, "rb") as file:
        data = file.read()
    start = data.index(b"idManifest\0idmanifest\0") + 22
    size = struct.unpack_from("<i", data, start)[0]
    whole = struct.unpack_from("<Q", data, start + 4)[0]
    plain = zlib.decompress(data[start + 12 : start + 4 + size])
    assert len(plain) == whole
    cursor = Cursor(plain)
    assert cursor.number() == 0
    texts = []
    for packed in cursor.strings():
        if texts:
            wide = len(texts[-1]) > 255
            shared = int.from_bytes(packed[: 1 + wide], "big")
            packed = texts[-1][:shared] + packed[1 + wide :]
        texts.append(packed)
    order = []
    for _ in range(cursor.number()):
        first, last = cursor.number(), cursor.number()
        order += [i for i in range(first, last + 1) if i not in order]
    groups = {}
    for _ in range(cursor.number()):
        channels, components = cursor.strings(), cursor.strings()
        assert cursor.take(1) == b"\2"
        assert cursor.take(cursor.number()) == b"none" and cursor.take(cursor.number()) == b"id"
        storage, number, table = cursor.take(1)[0], 0, {}
        for _ in range(cursor.number()):
            number += cursor.varint() if storage == 2 else cursor.number("<I")
            table[number] = [texts[order[cursor.varint()]].decode() for _ in components]
        groups[channels[0].decode()] = table
    assert cursor.at == len(plain)
    return groups


def samples_in(path):
    """[(column, row, {channel: value})], front to back in each pixel."""
    source = oiio.ImageInput.open(path)
    spec = source.spec()
    deep = source.read_native_deep_image()
    found = []
    for pixel in range(deep.pixels):
        for sample in range(deep.samples(pixel)):
            values = {}
            for c, name in enumerate(spec.channelnames):
                get = deep.deep_value_uint if name in ("id", "object") else deep.deep_value
                values[name] = get(pixel, c, sample)
            found.append((pixel % spec.width, pixel // spec.width, values))
    return spec.width, found


def main():
    conus, n, angle = sys.argv[1], 24, 50
    with tempfile.TemporaryDirectory() as folder:
        image = os.path.join(folder, "deep.exr")
        subprocess.run([conus, "phantom", "nested", "-o", folder], check=True)
        answer = subprocess.run([conus, "query", os.path.join(folder, "nested.nii.gz"), "--origin=5,-80,10",
                                 "--toward=0,0,0", "--angle", str(angle), "--layers", "all", "--resolution", str(n),
                                 "--deep", image, "--format", "json"], check=True, stdout=subprocess.PIPE).stdout
        width, samples = samples_in(image)
        groups = names_in(image)
    assert width == n
    rows = {row["index"]: row for row in json.loads(answer)["Rows"] if row["kind"] == "area"}
    seen = {}
    for x, y, values in samples:
        u, v = (2 * x + 1) / n - 1, 1 - (2 * y + 1) / n
        cosine = math.cos(math.atan(math.tan(math.radians(angle / 2)) * math.hypot(u, v)))
        assert abs(values["t"] * cosine - values["Z"]) < 1e-4 and abs(values["tBack"] * cosine - values["ZBack"]) < 1e-4
        assert values["A"] == 1
        if math.hypot(u, v) <= 1:
            seen.setdefault(values["id"], []).append((x, y, values["t"], values["tBack"]))
    assert set(seen) == set(rows) == set(groups["id"]) and 4000000001 in seen
    for label, intervals in seen.items():
        row = rows[label]
        pierced = len({(x, y) for x, y, _, _ in intervals})
        assert groups["id"][label] == [row["name"]], label
        assert pierced == row["pierced"], (pierced, row)
        assert abs(min(t for _, _, t, _ in intervals) - row["entry_mm"]) < 1e-4
        assert abs(max(t for _, _, _, t in intervals) - row["exit_mm"]) < 1e-4
        assert abs(sum(b - a for _, _, a, b in intervals) / pierced - row["path_mm"]) < 1e-4
    assert {tuple(texts[1:]) for texts in groups["object"].values()} == {(str(label), "area") for label in rows}
    print(f"{len(samples)} samples of {[row['name'] for row in rows.values()]}")


if __name__ == "__main__":
    main()
