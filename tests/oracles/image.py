#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""image.py make FOLDER [W H]         writes small OpenEXR and PNG files (W x H pixels) and prints their names
image.py refuse FOLDER             writes OpenEXR files that conus does not read, and prints their names
image.py compare FILE DUMP...      reads FILE with OpenImageIO and compares with what conus made of it

A dump is lines "channel NAME float|uint BYTES-IN-HEX" (little-endian, top row first) and "text NAME VALUE" or "matrix
NAME 16 NUMBERS". OpenEXR must agree bit for bit, PNG within 1e-6. DWA is left out, which OpenEXR's C library 3.1 does not
decode, and B44 of float and uint, which it decodes wrongly.
"""
import struct
import sys
import zlib

import numpy as np
import OpenImageIO as oiio

COMPRESSIONS = ["none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a"]


def picture(kind, width, height, channels=4):
    """Smooth in the middle, noisy at the right, with the values that break readers at the left."""
    random = np.random.default_rng(11)
    if kind == "uint32":
        values = random.integers(0, 2**32, (height, width, channels), np.uint32)
        values[:, 5:15] = 4294967295
        return values
    y, x, c = np.mgrid[0:height, 0:width, 0:channels]
    values = np.sin(x / 9 + c) * np.cos(y / 7) * 0.5 + 0.5
    values[:, 15:] = random.random((height, width - 15, channels))
    if kind == "float":
        values[:, 0] = [np.nan, np.inf, -np.inf, 1e-42][:channels]
    return values.astype(np.float16 if kind == "half" else np.float32)


def write(path, values, tile=0, corner=(0, 0), **attributes):
    height, width, channels = values.shape
    spec = oiio.ImageSpec(width, height, channels, {"f2": "half", "f4": "float", "u4": "uint"}[values.dtype.str[1:]])
    for name, value in attributes.items():
        spec.attribute(name.replace("_", ":"), value)
    spec.x, spec.y = corner  # of the data window
    spec.tile_width = spec.tile_height = tile
    output = oiio.ImageOutput.create(path)
    assert output.open(path, spec), output.geterror()
    assert output.write_image(values), output.geterror()
    output.close()
    print(path)


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


ADAM7 = [(0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2)]


def write_png(path, samples, bits, colour, interlaced, extra=b""):
    """samples [height, width, channels] as they are stored; no filter."""
    height, width = samples.shape[:2]
    data = b""
    for x, y, dx, dy in ADAM7 if interlaced else [(0, 0, 1, 1)]:
        part = samples[y::dy, x::dx]
        for row in part if part.size else []:
            values = row.reshape(-1)
            if bits == 16:
                packed = values.astype(">u2").tobytes()
            else:
                each = np.unpackbits(values.astype(np.uint8)[:, None], axis=1)[:, 8 - bits :]
                packed = np.packbits(each.reshape(-1)).tobytes()
            data += b"\0" + packed
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, colour, 0, 0,
                                                                      interlaced)))
        file.write(extra + chunk(b"IDAT", zlib.compress(data, 9)) + chunk(b"IEND", b""))
    print(path)


def make(folder, width=21, height=37):
    for compression in COMPRESSIONS:
        for kind in ["half"] if compression.startswith("b44") else ["half", "float", "uint32"]:
            write(f"{folder}/{kind}-{compression}.exr", picture(kind, width, height), compression=compression,
                  conus_space="RAS mm")
    for n, corner in enumerate([(-7, -40), (3, 5), (0, 100000)]):
        write(f"{folder}/corner-{n}.exr", picture("float", width, height), corner=corner, compression="zip")
    random = np.random.default_rng(12)
    channels = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}
    for colour, bits in [(0, 1), (0, 2), (0, 4), (0, 8), (0, 16), (2, 8), (2, 16), (3, 1), (3, 2), (3, 4), (3, 8),
                         (4, 8), (4, 16), (6, 8), (6, 16)]:
        samples = random.integers(0, 2**bits, (height, width, channels[colour]))
        extra = b""
        if colour == 3:
            extra = chunk(b"PLTE", random.bytes(3 * 2**bits)) + chunk(b"tRNS", random.bytes(2**bits))
        for interlaced in [0, 1]:
            write_png(f"{folder}/colour{colour}-{bits}bit-{'adam7' if interlaced else 'rows'}.png", samples, bits, colour,
                      interlaced, extra)


def refuse(folder):
    for kind, compression, tile in [("half", "dwaa", 0), ("half", "dwab", 0), ("float", "b44", 0), ("uint32", "b44a", 0),
                                    ("float", "zip", 16)]:
        write(f"{folder}/refuse-{kind}-{compression}-{tile}.exr", picture(kind, 32, 32), tile, compression=compression)
    path = f"{folder}/refuse-parts.exr"
    output = oiio.ImageOutput.create(path)
    specs = [oiio.ImageSpec(32, 32, 4, "float") for _ in range(2)]
    assert output.open(path, specs), output.geterror()
    assert output.write_image(picture("float", 32, 32)), output.geterror()
    assert output.open(path, specs[1], "AppendSubimage"), output.geterror()
    assert output.write_image(picture("float", 32, 32)), output.geterror()
    output.close()
    print(path)


def read_dump(path):
    channels, attributes = {}, {}
    with open(path, encoding="utf-8") as file:
        for line in file:
            kind, name, *rest = line.rstrip("\n").split(" ", 3 if line.startswith("channel") else 2)
            if kind == "channel":
                channels[name] = (rest[0], np.frombuffer(bytes.fromhex(rest[1]), np.uint32))
            else:
                attributes[name] = rest[0] if kind == "text" else np.array(rest[0].split(), float)
    return channels, attributes


def linear_from_srgb(s):
    return np.where(s <= 0.04045, s / 12.92, ((s + 0.055) / 1.055) ** 2.4)


def compare_png(source, channels, name):
    data = source.read_image(0, 0, 0, source.spec().nchannels, oiio.UINT16).astype(float) / 65535
    if data.shape[2] in (1, 2):
        data = np.concatenate([data[..., :1]] * 3 + [data[..., 1:]], -1)
    alpha = data[..., 3] if data.shape[2] == 4 else np.ones(data.shape[:2])
    for c, channel in enumerate("RGB"):
        wanted = linear_from_srgb(data[..., c]) * alpha
        got = channels[channel][1].view(np.float32).reshape(alpha.shape)
        assert np.abs(got - wanted).max() <= 1e-6, (name, channel)
    assert np.abs(channels["A"][1].view(np.float32).reshape(alpha.shape) - alpha).max() <= 1e-6, name


def compare_exr(source, channels, attributes, name):
    spec = source.spec()
    assert sorted(spec.channelnames) == sorted(channels), (name, spec.channelnames, list(channels))
    for c, channel in enumerate(spec.channelnames):
        kind, got = channels[channel]
        stored = str(spec.channelformat(c))
        assert (stored == "uint") == (kind == "uint"), (name, channel, stored)
        # ask for the type that is stored: OpenImageIO scales integers when it converts
        wanted = source.read_image(0, 0, c, c + 1, oiio.UINT32 if kind == "uint" else oiio.FLOAT).reshape(-1)
        same = (wanted.view(np.uint32) == got) | (np.isnan(wanted) & np.isnan(got.view(np.float32)))
        assert same.all(), (name, channel, np.flatnonzero(~same)[:5])
    for key, value in attributes.items():
        stored = spec.getattribute(key)
        if not key.startswith("conus:"):  # OpenImageIO has names of its own for the standard ones
            continue
        if isinstance(value, str):
            assert stored == value, (name, key, stored)
        else:
            assert np.array_equal(np.array(stored).reshape(-1), value), (name, key, stored)


def compare(path, dump):
    config = oiio.ImageSpec()
    config.attribute("oiio:UnassociatedAlpha", 1)
    source = oiio.ImageInput.open(path, config)
    assert source, oiio.geterror()
    channels, attributes = read_dump(dump)
    spec = source.spec()
    for _, values in channels.values():
        assert values.size == spec.width * spec.height, path
    if path.endswith(".png"):
        compare_png(source, channels, path)
    else:
        compare_exr(source, channels, attributes, path)


if __name__ == "__main__":
    if sys.argv[1] == "make":
        make(sys.argv[2], *map(int, sys.argv[3:]))
    elif sys.argv[1] == "refuse":
        refuse(sys.argv[2])
    else:
        for file, dump in zip(sys.argv[2::2], sys.argv[3::2]):
            compare(file, dump)
