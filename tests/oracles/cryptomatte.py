#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The Cryptomatte layer of `conus query --image`, read by OpenImageIO and decoded from the specification alone.

usage: cryptomatte.py CONUS; exit 77 = skipped."""
import json
import os
import subprocess
import sys
import tempfile

try:
    import numpy as np
    import OpenImageIO as oiio
except ImportError:
    print("skipped: no python3-openimageio")
    sys.exit(77)


def murmur3_32(data):
    def rotate(x, bits):
        return (x << bits | x >> 32 - bits) & 0xFFFFFFFF

    h = 0
    whole = len(data) // 4 * 4
    for at in range(0, whole, 4):
        k = int.from_bytes(data[at : at + 4], "little")
        h ^= rotate(k * 0xCC9E2D51 & 0xFFFFFFFF, 15) * 0x1B873593 & 0xFFFFFFFF
        h = (rotate(h, 13) * 5 + 0xE6546B64) & 0xFFFFFFFF
    if data[whole:]:
        k = int.from_bytes(data[whole:], "little")
        h ^= rotate(k * 0xCC9E2D51 & 0xFFFFFFFF, 15) * 0x1B873593 & 0xFFFFFFFF
    h ^= len(data)
    h = (h ^ h >> 16) * 0x85EBCA6B & 0xFFFFFFFF
    h = (h ^ h >> 13) * 0xC2B2AE35 & 0xFFFFFFFF
    return h ^ h >> 16


def normal(h):
    return h ^ 1 << 23 if h >> 23 & 255 in (0, 255) else h


def read(path):
    source = oiio.ImageInput.open(path)
    spec = source.spec()
    names = list(spec.channelnames)
    ids = np.array(source.read_image(0, 0, names.index("id"), names.index("id") + 1, oiio.UINT32))
    hashes = np.array(source.read_image(0, 0, names.index("CryptoObject00.R"), names.index("CryptoObject00.R") + 1,
                                        oiio.FLOAT))
    return spec, ids.reshape(-1), hashes.reshape(-1).view(np.uint32)


def main():
    conus = sys.argv[1]
    with tempfile.TemporaryDirectory() as folder:
        image = os.path.join(folder, "seen.exr")
        subprocess.run([conus, "phantom", "u-shape", "-o", folder], check=True)
        subprocess.run([conus, "query", os.path.join(folder, "u-shape.nii.gz"), "--origin=5,-80,60", "--toward=0,0,0",
                        "--angle", "50", "--image", image, "-o", os.path.join(folder, "seen.tsv")], check=True)
        spec, ids, hashes = read(image)
        with open(os.path.join(folder, "u-shape.tsv"), encoding="utf-8") as table:
            rows = [line.split("\t") for line in table.read().splitlines()[1:]]
    name_of = {int(row[0]): row[1] for row in rows}
    prefix = "cryptomatte/%07x/" % (normal(murmur3_32(b"CryptoObject")) >> 4)
    assert spec[prefix + "name"] == "CryptoObject", spec[prefix + "name"]
    assert spec[prefix + "hash"] == "MurmurHash3_32" and spec[prefix + "conversion"] == "uint32_to_float32"
    manifest = json.loads(spec[prefix + "manifest"])
    for name, digits in manifest.items():
        assert int(digits, 16) == normal(murmur3_32(name.encode())), name
    named = {int(digits, 16): name for name, digits in manifest.items()}
    hit = ids != 0
    assert (hashes[~hit] == 0).all() and hit.any() and not hit.all()
    assert [named[h] for h in hashes[hit]] == [name_of[i] for i in ids[hit]]
    assert set(named.values()) == {name_of[i] for i in ids[hit]}
    print(f"{hit.sum()} pixels lead to {sorted(named.values())}")


if __name__ == "__main__":
    main()
