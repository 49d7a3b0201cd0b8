#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""compare_readers.py CONUS CONUS_HDF5 SOURCES PYTHON [--table]: what each reader makes of what files of other programs
are like.

A table of readers and kinds of files. Each cell writes such a file from bytes and compares the answer, or the refusal,
with what numpy, Python's codecs or arithmetic by hand say; or it says why no such file can be. The readers are those
that the program's sources and its help list: a reader without a row, and a row without a cell, fail.

PYTHON is the folder of the built package of Python. --table prints every cell, in Markdown. Exit 77 = skipped."""

import base64
import gzip
import json
import os
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import zipfile

try:
    import h5py
    import numpy as np
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

CONUS = os.path.abspath(sys.argv[1])
os.environ.update(CONUS_HDF5=os.path.abspath(sys.argv[2]))
SOURCES = pathlib.Path(sys.argv[3]).resolve()

KINDS = ("slope 1/255", "slope 0.1", "2^24+1", "BOM", "1252", "CRLF", "empty rows", "decimal comma", "NaN", "-1", "LPS",
         "big-endian", "out of range")
TYPOGRAPHIC = "L\u2019aire\u2013gauche"  # in Windows-1252 the bytes 92 and 96
LETTERS = TYPOGRAPHIC.encode("cp1252")

ROWS = {}  # (family, reader): {kind: cell}


class Never(str):
    """A cell that cannot occur, and why."""


def row(family, reader, **cells):
    """The cells of a reader; keyword arguments have the kinds' names in letters only."""
    ROWS[family, reader] = {kind: cells[key_of(kind)] for kind in KINDS if key_of(kind) in cells}
    unknown = set(cells) - {key_of(kind) for kind in KINDS}
    assert not unknown, (reader, unknown)


def key_of(kind):
    return {"-1": "minus", "2^24+1": "large", "1252": "windows", "slope 1/255": "byte_scale",
            "slope 0.1": "tenth"}.get(kind, re.sub(r"[^a-z]", "_", kind.lower()))


# ---- asking the program


def run(*words, stdin=None):
    return subprocess.run([CONUS, *map(str, words)], capture_output=True, text=True, check=False, input=stdin)


def rows_of(*words, warns=None):
    """The rows of a query as TSV, as dictionaries; its messages must have the text `warns`."""
    done = run("query", *words, "--format", "tsv")
    assert done.returncode == 0, done.stderr
    assert warns is None or re.search(warns, done.stderr), f"said: {done.stderr!r}, wanted: {warns!r}"
    head, *lines = [line.split("\t") for line in done.stdout.splitlines()]
    return [dict(zip(head, line)) for line in lines]


def refuses(text, *words, code=3):
    """That the query ends with a refusal whose one line has the text."""
    done = run("query", *words)
    assert done.returncode == code, (done.returncode, done.stdout[-300:], done.stderr)
    assert text in done.stderr and len(done.stderr.splitlines()) == 1, f"said: {done.stderr!r}, wanted: {text!r}"


def write(path, data):
    pathlib.Path(path).write_bytes(data)
    return path


# ---- volumes: 4 x 5 x 6 voxels of 2 mm, all of label 1 but for voxel (1, 2, 3), whose centre is (-1, 2, -3)

SHAPE, VOXEL, ORIGIN = (4, 5, 6), (1, 2, 3), np.array([-3.0, -2.0, -9.0])
PLACE = tuple(ORIGIN + 2 * np.array(VOXEL))
AT = ("--point=" + ",".join(f"{x:g}" for x in PLACE), "--radius", 0.5)
NO_SCALE = Never("the format has no scale")
BINARY = Never("the header is binary and holds no text that is used")
RAS_ONLY = Never("the format's world is RAS")


def voxels(value, dtype, rest=1):
    array = np.full(SHAPE, rest, dtype)
    array[VOXEL] = value
    return array


def ordered(array, big):
    """Its bytes, i fastest."""
    return array.astype(array.dtype.newbyteorder(">" if big else "<")).tobytes(order="F")


NIFTI_CODES = {"u1": 2, "i2": 4, "i4": 8, "f4": 16, "f8": 64}


def nifti(array, slope=0.0, big=False, version=1, offset=None, intent=0, dim=None):
    """A header of NIfTI-1 or -2 with an sform of scanner coordinates, and the voxels."""
    order = ">" if big else "<"
    dim = [array.ndim, *array.shape] if dim is None else dim
    dim = dim + [1] * (8 - len(dim))
    code = NIFTI_CODES[array.dtype.str[1:]]
    lines = [2.0, 0, 0, ORIGIN[0], 0, 2.0, 0, ORIGIN[1], 0, 0, 2.0, ORIGIN[2]]
    head = bytearray(348 if version == 1 else 540)

    def put(at, kind, *values):
        struct.pack_into(order + kind, head, at, *values)

    bits = 8 * array.dtype.itemsize
    pixdim = [1.0, 2, 2, 2, 1, 1, 1, 1]
    if version == 1:
        put(0, "i", 348), put(40, "8h", *dim), put(68, "3h", intent, code, bits), put(76, "8f", *pixdim)
        put(108, "3f", 352 if offset is None else offset, slope, 0), head.__setitem__(123, 2)
        put(252, "2h", 0, 1), put(280, "12f", *lines)
        head[344:348] = b"n+1\0" if offset is None else b"ni1\0"
    else:
        put(0, "i", 540), put(12, "2h", code, bits), put(16, "8q", *dim), put(104, "8d", *pixdim)
        head[4:12] = b"n+2\0\r\n\x1a\n"
        put(168, "q", 544), put(176, "2d", slope, 0), put(344, "2i", 0, 1), put(400, "12d", *lines)
        put(500, "i", 2), put(504, "i", intent)
    return bytes(head), (b"" if offset is not None else bytes(4)) + ordered(array, big)


def write_nifti(name, array, **more):
    return write(f"{name}.nii", b"".join(nifti(array, **more)))


def write_nifti_2(name, array, **more):
    return write_nifti(name, array, version=2, **more)


def write_pair(name, array, **more):
    head, data = nifti(array, offset=0, **more)
    write(f"{name}.img", data)
    return write(f"{name}.hdr", head)


def write_mgh(name, array, big=True):
    assert big  # the format's only order
    kinds = {"u1": 0, "i4": 1, "f4": 3, "i2": 4}
    centre = ORIGIN + 2 * np.array(SHAPE) / 2
    head = struct.pack(">7ih3f9f3f", 1, *SHAPE, 1, kinds[array.dtype.str[1:]], 0, 1, 2, 2, 2, 1, 0, 0, 0, 1, 0, 0, 0, 1,
                       *centre)
    return write(f"{name}.mgh", head.ljust(284, b"\0") + ordered(array, True))


NRRD_TYPES = {"u1": "uint8", "i2": "int16", "i4": "int32", "f4": "float", "f8": "double"}


def write_nrrd(name, array, big=False, text=bytes, detached=False, lps=False, more=b""):
    sign = -1 if lps else 1
    head = (f"NRRD0004\ntype: {NRRD_TYPES[array.dtype.str[1:]]}\ndimension: 3\n"
            f"space: {'left-posterior' if lps else 'right-anterior'}-superior\nsizes: 4 5 6\n"
            f"space directions: ({2 * sign},0,0) (0,{2 * sign},0) (0,0,2)\nencoding: raw\n"
            f"endian: {'big' if big else 'little'}\n"
            f"space origin: ({sign * ORIGIN[0]},{sign * ORIGIN[1]},{ORIGIN[2]})\n").encode()
    data = ordered(array, big)
    if detached:
        write(f"{name}.raw", data)
        return write(f"{name}.nhdr", text(head + more + f"data file: {name}.raw\n".encode()))
    return write(f"{name}.nrrd", text(head + more + b"\n") + data)


META_TYPES = {"u1": "UCHAR", "i2": "SHORT", "i4": "INT", "f4": "FLOAT", "f8": "DOUBLE"}


def write_meta(name, array, big=False, text=bytes, detached=False, slope=None):
    scale = f"ElementToIntensityFunctionSlope = {slope}\n" if slope else ""
    head = (
        f"ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = {big}\n"
        f"TransformMatrix = -1 0 0 0 -1 0 0 0 1\nOffset = {-ORIGIN[0]} {-ORIGIN[1]} {ORIGIN[2]}\n"
        f"ElementSpacing = 2.0 2.0 2.0\nDimSize = 4 5 6\n{scale}ElementType = MET_{META_TYPES[array.dtype.str[1:]]}\n"
        f"ElementDataFile = {name + '.raw' if detached else 'LOCAL'}\n").encode()
    data = ordered(array, big)
    if detached:
        write(f"{name}.raw", data)
        return write(f"{name}.mhd", text(head))
    return write(f"{name}.mha", text(head) + data)


AFNI_TYPES = {"u1": 0, "i2": 1, "i4": 2, "f4": 3, "f8": 4}


def write_afni(name, array, big=False, text=bytes, slope=0.0, more=""):
    def attribute(kind, key, values):
        if kind == "string":
            return f"\ntype = string-attribute\nname = {key}\ncount = {len(values) + 1}\n'{values}~\n"
        return f"\ntype = {kind}-attribute\nname = {key}\ncount = {len(values)}\n " + " ".join(map(str, values)) + "\n"

    matrix = [-2.0, 0, 0, -ORIGIN[0], 0, -2.0, 0, -ORIGIN[1], 0, 0, 2.0, ORIGIN[2]]  # DICOM's order is LPS
    head = (attribute("string", "TYPESTRING", "3DIM_HEAD_ANAT") + attribute("integer", "DATASET_RANK", [3, 1]) +
            attribute("integer", "DATASET_DIMENSIONS", [4, 5, 6, 0, 0]) +
            attribute("integer", "SCENE_DATA", [0, 0, 0]) +
            attribute("integer", "BRICK_TYPES", [AFNI_TYPES[array.dtype.str[1:]]]) +
            attribute("float", "BRICK_FLOAT_FACS", [slope]) + attribute("float", "IJK_TO_DICOM_REAL", matrix) +
            attribute("string", "BYTEORDER_STRING", "MSB_FIRST" if big else "LSB_FIRST") + more)
    write(f"{name}+orig.BRIK", ordered(array, big))
    return write(f"{name}+orig.HEAD", text(head.encode()))


def tiff(array, big=False):
    """Pages of one strip each: column, row and page are i, j, k."""
    order = ">" if big else "<"
    width, height, pages = array.shape
    kind = {"u": 1, "i": 2, "f": 3}[array.dtype.kind]
    size = width * height * array.dtype.itemsize
    out = b"MM\0*" if big else b"II*\0"
    out += struct.pack(order + "I", 8)
    for page in range(pages):
        data = ordered(array[:, :, page], big)
        at = len(out) + 2 + 12 * 10 + 4
        tags = [(256, width), (257, height), (258, 8 * array.dtype.itemsize), (259, 1), (262, 1), (273, at), (277, 1),
                (278, height), (279, size), (339, kind)]
        out += struct.pack(order + "H", len(tags))
        for tag, value in tags:
            out += struct.pack(order + "HHI", tag, 4, 1) + struct.pack(order + "I", value)
        out += struct.pack(order + "I", at + size if page + 1 < pages else 0) + data
    return out


def write_tiff(name, array, big=False, orientation="lpi"):
    """A stack whose origin is the corner of the first voxel: the place of the voxel is no longer PLACE."""
    return write(f"{name}.tiff", tiff(array, big)) + f",resolution=2000,orientation={orientation}"


def at_corner(*signs):
    """The point of the voxel in a grid that begins with a corner at 0."""
    return "--point=" + ",".join(f"{s * (2 * n + 1):g}" for s, n in zip(signs, VOXEL)), "--radius", 0.5


def write_minc(name, array, slope=None):
    path = f"{name}.mnc"
    with h5py.File(path, "w") as file:
        image = file.create_dataset("minc-2.0/image/0/image", data=np.ascontiguousarray(array.transpose(2, 1, 0)))
        image.attrs["dimorder"] = np.bytes_("zspace,yspace,xspace")
        if array.dtype.kind != "f":
            low, high = (0, 255) if slope else (np.iinfo(array.dtype).min, np.iinfo(array.dtype).max)
            image.attrs["valid_range"] = np.array([low, high], float)
            file["minc-2.0/image/0/image-min"] = float(low) * (slope or 1)
            file["minc-2.0/image/0/image-max"] = float(high) * (slope or 1)
        for axis, key in enumerate(("xspace", "yspace", "zspace")):
            node = file.create_dataset(f"minc-2.0/dimensions/{key}", data=np.int32(0))
            cosines = np.zeros(3)
            cosines[axis] = 1
            node.attrs.update({
                "start": ORIGIN[axis], "step": 2.0, "length": np.int32(SHAPE[axis]), "spacing": np.bytes_("regular__"),
                "direction_cosines": cosines
            })
    return path


def write_zarr(name, array, version=3, big=False, orientation=("left-to-right", "posterior-to-anterior")):
    """One level of one chunk; the axes z, y, x in millimetres."""
    folder = pathlib.Path(f"{name}.ome.zarr")
    words = {"x": orientation[0], "y": orientation[1], "z": "inferior-to-superior"}
    axes = [{
        "name": key, "type": "space", "unit": "millimeter", "orientation": {"type": "anatomical", "value": words[key]}
    } for key in "zyx"]
    first = [ORIGIN["xyz".index(key)] for key in "zyx"]
    images = [{
        "axes": axes, "version": "0.5" if version == 3 else "0.4", "datasets": [{
            "path": "0", "coordinateTransformations": [{"type": "scale", "scale": [2.0] * 3},
                                                       {"type": "translation", "translation": first}]
        }]
    }]
    level = folder / "0"
    data = ordered(array, big)
    kind = np.dtype(array.dtype).name
    if version == 3:
        (level / "c/0/0").mkdir(parents=True)
        write(
            folder / "zarr.json",
            json.dumps({
                "zarr_format": 3, "node_type": "group",
                "attributes": {"ome": {"version": "0.5", "multiscales": images}}
            }).encode())
        write(
            level / "zarr.json",
            json.dumps({
                "zarr_format": 3, "node_type": "array", "shape": SHAPE[::-1], "data_type": kind, "fill_value": 0,
                "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": SHAPE[::-1]}},
                "chunk_key_encoding": {"name": "default", "configuration": {"separator": "/"}},
                "codecs": [{"name": "bytes", "configuration": {"endian": "big" if big else "little"}}]
            }).encode())
        write(level / "c/0/0/0", data)
    else:
        level.mkdir(parents=True)
        write(folder / ".zgroup", b'{"zarr_format": 2}')
        write(folder / ".zattrs", json.dumps({"multiscales": images}).encode())
        write(
            level / ".zarray",
            json.dumps({
                "zarr_format": 2, "shape": SHAPE[::-1], "chunks": SHAPE[::-1], "fill_value": 0, "order": "C",
                "filters": None, "compressor": None, "dtype": array.dtype.newbyteorder(">" if big else "<").str
            }).encode())
        write(level / "0.0.0", data)
    return str(folder)


def label_at(file, *more, at=AT, warns=None):
    """The label of the area at the place."""
    found = [line for line in rows_of(file, *at, *more, warns=warns) if line["kind"] == "area"]
    assert len(found) == 1, found
    return int(found[0]["index"])


def is_label(wanted, make, at=AT, warns=None):
    def cell(name):
        found = label_at(make(name), at=at, warns=warns)
        assert found == wanted, f"label {found}, wanted is {wanted}"

    return cell


def is_refused(text, make, at=AT, code=3):
    return lambda name: refuses(text, make(name), *at, code=code)


# 70 times float32(0.1) is 7 in single precision, as FSL, ITK and SPM compute it, and 7.0000001 in double.
TENTH = np.float32(0.1)
assert np.float32(70) * TENTH == 7 and 70 * float(TENTH) != 7
# 255 times float32(1/255) is 1 in single precision, and above 1 in double: 153 is the probability 0.6 all the same.
BYTE_SCALE = np.float32(1 / 255)
assert np.float32(255) * BYTE_SCALE == 1 < 255 * float(BYTE_SCALE)
assert abs(float(np.float32(153) * BYTE_SCALE) - 0.6) < 1e-6
# float32 has 24 bits: 2^24 + 1 is stored as 2^24, and nobody can tell which was meant.
LARGE = 2**24 + 1
assert int(np.float32(LARGE)) == 2**24
CANNOT_TELL = r"float32"  # the warning says so
CANNOT_TELL_APART = "is 16777216 as float32"  # and where a table has 2^24 + 1, it is an error
NOT_WHOLE = "allowed labels are whole numbers from 0 to 4294967295"


def is_probable(make, at=AT):
    """0.6 at the place, as a pathway, in an atlas of one label."""
    def cell(name):
        kinds = voxels(153, "u1", 0)
        kinds[3, 0, 0] = 255
        atlas = write_nifti(f"{name}_all", np.ones((9, 9, 9), "u1")) if at is AT else make(f"{name}_all", kinds * 0 + 1)
        file = make(name, kinds)
        found = [line for line in rows_of(atlas, "--pathway", file, *at) if line["kind"] == "pathway"]
        assert len(found) == 1 and abs(float(found[0]["max_value"]) - 0.6) < 1e-6, found

    return cell


def volume(reader, make, at=AT, scale=None, tenth=None, order=True, text=None, beyond="f8", **cells):
    """A row of a reader of volumes, whose files `make(name, array, big=, text=, slope=)` writes."""
    whole = voxels(7, "i2")
    if scale:
        cells.setdefault("byte_scale", is_probable(lambda name, kinds: make(name, kinds, slope=scale(BYTE_SCALE)), at))
        cells.setdefault("tenth", is_label(7, lambda name: make(name, voxels(70, "i2", 10), slope=scale(TENTH)), at))
    cells.setdefault("byte_scale", NO_SCALE)
    cells.setdefault("tenth", NO_SCALE)
    cells.setdefault("large", is_label(2**24, lambda name: make(name, voxels(LARGE, "f4")), at, warns=CANNOT_TELL))
    if text:
        cells.setdefault("crlf",
                         is_label(7, lambda name: make(name, whole, text=lambda b: b.replace(b"\n", b"\r\n")), at))
    for key in ("bom", "windows", "crlf", "empty_rows", "decimal_comma"):
        cells.setdefault(key, BINARY)
    cells.setdefault("nan", is_refused(NOT_WHOLE, lambda name: make(name, voxels(np.nan, "f4")), at))
    cells.setdefault("minus", is_refused(NOT_WHOLE, lambda name: make(name, voxels(-1, "i2")), at))
    cells.setdefault("lps", RAS_ONLY)
    if order:
        cells.setdefault("big_endian", is_label(7, lambda name: make(name, whole, big=True), at))
    cells.setdefault("out_of_range", is_refused(NOT_WHOLE, lambda name: make(name, voxels(2**32, beyond)), at))
    row("volume", reader, **cells)


def same(slope):
    return float(slope)


volume("NIfTI-1", write_nifti, scale=same)
volume("NIfTI-1 in two files", write_pair, scale=same)
volume("NIfTI-2", write_nifti_2, scale=same)
volume("MGH", write_mgh, beyond="f4", order=False, big_endian=is_label(7,
                                                                       lambda name: write_mgh(name, voxels(7, "i2"))))

BEGINS_OTHERWISE = "needed is"
volume(
    "NRRD", write_nrrd, text=True,
    bom=is_refused(BEGINS_OTHERWISE,
                   lambda name: write_nrrd(name, voxels(7, "i2"), text=lambda b: b"\xef\xbb\xbf" + b)),
    windows=lambda name: has_name(
        write_nrrd(name, voxels(7, "i2"), more=b"Segment0_Name:=" + LETTERS +
                   b"\nSegment0_LabelValue:=7\nSegment0_Layer:=0\n")),
    empty_rows=Never("an empty line ends the header"), decimal_comma=is_refused(
        "space origin", lambda name: write_nrrd(name, voxels(7, "i2"), text=lambda b: b.replace(b"-3.0,", b"-3,0,"))),
    lps=is_label(7, lambda name: write_nrrd(name, voxels(7, "i2"), lps=True)))
volume(
    "NRRD with detached voxels", lambda name, array, **more: write_nrrd(name, array, detached=True, **more), text=True,
    bom=is_refused(BEGINS_OTHERWISE,
                   lambda name: write_nrrd(name, voxels(7, "i2"), detached=True, text=lambda b: b"\xef\xbb\xbf" + b)),
    windows=lambda name: has_name(
        write_nrrd(name, voxels(7, "i2"), detached=True, more=b"Segment0_Name:=" + LETTERS +
                   b"\nSegment0_LabelValue:=7\nSegment0_Layer:=0\n")),
    empty_rows=is_label(7, lambda name: write_nrrd(name, voxels(7, "i2"), detached=True, text=lambda b: b + b"\n\n")),
    decimal_comma=is_refused(
        "space origin",
        lambda name: write_nrrd(name, voxels(7, "i2"), detached=True, text=lambda b: b.replace(b"-3.0,", b"-3,0,"))),
    lps=is_label(7, lambda name: write_nrrd(name, voxels(7, "i2"), detached=True, lps=True)))

NO_NAMES = Never("the header has no names of areas")
for reader, detached in (("MetaImage", False), ("MetaImage with detached voxels", True)):

    def meta(name, array, detached=detached, **more):
        return write_meta(name, array, detached=detached, **more)

    volume(
        reader, meta, text=True, windows=NO_NAMES,
        byte_scale=is_refused("ElementToIntensityFunctionSlope",
                              lambda name, meta=meta: meta(name, voxels(153, "u1"), slope=float(BYTE_SCALE))),
        tenth=is_refused("ElementToIntensityFunctionSlope",
                         lambda name, meta=meta: meta(name, voxels(70, "i2"), slope=float(TENTH))),
        bom=is_refused(BEGINS_OTHERWISE,
                       lambda name, meta=meta: meta(name, voxels(7, "i2"), text=lambda b: b"\xef\xbb\xbf" + b)),
        empty_rows=is_label(
            7,
            lambda name, meta=meta: meta(name, voxels(7, "i2"), text=lambda b: b.replace(b"\nOffset", b"\n\nOffset"))),
        decimal_comma=is_refused(
            "ElementSpacing", lambda name, meta=meta: meta(name, voxels(7, "i2"), text=lambda b: b.replace(
                b"2.0 2.0 2.0", b"2,0 2,0 2,0"))), lps=is_label(7, lambda name, meta=meta: meta(name, voxels(7, "i2"))))

AFNI_TABLE = (b"<VALUE_LABEL_DTABLE\n  ni_type=\"2*String\"\n  ni_dimen=\"1\" >\n \"7\" \"" + LETTERS +
              b"\"\n</VALUE_LABEL_DTABLE>")


def afni_named(name):
    more = f"\ntype = string-attribute\nname = VALUE_LABEL_DTABLE\ncount = {len(AFNI_TABLE) + 1}\n'@~\n"
    return write_afni(name, voxels(7, "i2"), more=more, text=lambda b: b.replace(b"@", AFNI_TABLE))


volume(
    "AFNI", write_afni, scale=same, text=True, windows=lambda name: has_name(afni_named(name)),
    bom=is_refused(BEGINS_OTHERWISE,
                   lambda name: write_afni(name, voxels(7, "i2"), text=lambda b: b"\xef\xbb\xbf" + b)),
    empty_rows=is_label(7,
                        lambda name: write_afni(name, voxels(7, "i2"), text=lambda b: b.replace(b"\n\n", b"\n\n\n"))),
    decimal_comma=is_refused(
        "IJK_TO_DICOM_REAL",
        lambda name: write_afni(name, voxels(7, "i2"), text=lambda b: b.replace(b" -2.0 0 0", b" -2,0 0 0"))),
    lps=is_label(7, lambda name: write_afni(name, voxels(7, "i2"))))
volume("TIFF", lambda name, array, **more: write_tiff(name, array, orientation="ipl", **more), at=at_corner(1, 1, 1),
       lps=is_label(7, lambda name: write_tiff(name, voxels(7, "i2"), orientation="sar"), at_corner(-1, -1, -1)))
volume("MINC", write_minc, scale=same, order=False,
       big_endian=is_label(7, lambda name: write_minc(name, voxels(7, ">i2"))))
for version in (2, 3):

    def zarr(name, array, version=version, **more):
        return write_zarr(name, array, version=version, **more)

    # Axes to the left and to the front count t + 2 n the other way.
    volume(
        f"OME-Zarr of Zarr {version}", zarr, lps=is_label(
            7,
            lambda name, zarr=zarr: zarr(name, voxels(7, "i2"), orientation=("right-to-left", "anterior-to-posterior")),
            (f"--point={-PLACE[0]:g},{-PLACE[1]:g},{PLACE[2]:g}", "--radius", 0.5)))


def has_name(file, *more, wanted=TYPOGRAPHIC, at=AT):
    found = [line["name"] for line in rows_of(file, *at, *more) if line["kind"] == "area"]
    assert found == [wanted], f"{found!r}, wanted is {wanted!r}"


# ---- label tables: @N is the number of the label 7, @T its name

NO_VOXELS = Never("a table of names has no scale and no voxels")
WHOLE = Never("the table has whole numbers only")
NO_PLACES = Never("a table of names has no places")
TEXT = Never("text has no byte order")
EMPTY_TABLE = "not a label table"


def labels(reader, table, ending="txt", columns="", colour=None, second=7, **cells):
    """A row of a reader of label tables; `table` is a file whose `second` entry has the number @N and the name @T."""
    def fill(number="7", name=TYPOGRAPHIC.encode(), text=bytes):
        return lambda path: write(f"{path}.{ending}", text(table.replace(b"@N", number.encode()).replace(b"@T", name)))

    def is_named(value=second, dtype="i2", **more):
        def cell(path):
            atlas = write_nifti(f"{path}_atlas", voxels(value, dtype))
            file = fill(**more)(path) + columns
            facts = json.loads(run("info", atlas, "--labels", file, "--format", "json").stdout)
            assert facts["labels"] == f"{reader} in {file}", facts["labels"]
            area = next(area for area in facts["objects"] if area["index"] == value)
            assert area["color" if colour else "name"] == (colour or TYPOGRAPHIC), area

        return cell

    def comma_is_refused(words, old, new):
        def cell(path):
            atlas = write_nifti(f"{path}_atlas", voxels(7, "i2"))
            refuses(words, atlas, "--labels", fill(text=lambda text: text.replace(old, new))(path) + columns, *AT)

        return cell

    def number_is_refused(number, words=None):
        def cell(path):
            atlas = write_nifti(f"{path}_atlas", voxels(7, "i2"))
            refuses(words or f'label "{number}"', atlas, "--labels", fill(number=number)(path) + columns, *AT)

        return cell

    def spaced(text):
        """Empty lines between the rows, and behind them what Excel writes of an empty row."""
        separator = {"csv": b";" if b";" in table else b",", "tsv": b"\t"}.get(ending, b"")
        return text.replace(b"\n", b"\n\n") + separator + b"\n"

    cells.setdefault("large", is_named(LARGE, "i4", number=str(LARGE)))
    cells.setdefault("bom", is_named(text=lambda text: b"\xef\xbb\xbf" + text))
    cells.setdefault("windows", is_named(name=LETTERS))
    cells.setdefault("crlf", is_named(text=lambda text: text.replace(b"\n", b"\r\n")))
    cells.setdefault("empty_rows", is_named(text=spaced))
    cells.setdefault("decimal_comma", WHOLE)
    cells.setdefault("nan", number_is_refused("nan"))
    cells.setdefault("minus", number_is_refused("-1"))
    cells.setdefault("out_of_range", number_is_refused("4294967296"))
    for key, value in cells.items():
        if isinstance(value, tuple) and isinstance(value[0], bytes):  # (old, new), and it is read
            cells[key] = is_named(text=lambda text, pair=value: text.replace(*pair))
        elif isinstance(value, tuple):  # (number, words), or (words, old, new)
            cells[key] = (comma_is_refused if len(value) == 3 else number_is_refused)(*value)
    row("labels", reader, byte_scale=NO_VOXELS, tenth=NO_VOXELS, lps=NO_PLACES, **{"big_endian": TEXT, **cells})


labels("MRIcron text", b"1\tOne\n@N\t@T\n2\tTwo\n")
labels("FreeSurfer colour table", b"#No. Label Name: R G B A\n1 One 1 2 3 0\n@N @T 220 216 20 0\n2 Two 4 5 6 0\n")
labels("Slicer colour table", b"# Color table file x\n1 One 1 2 3 255\n@N @T 4 5 6 255\n2 Two 4 5 6 255\n", "ctbl")
labels("MRtrix or FreeSurfer colour table", b"1 A One 1 2 3 255\n@N B @T 4 5 6 255\n2 C Two 4 5 6 255\n")
labels("FSLeyes colour table", b"1 0.1 0.9 1.0 One\n@N 0.2 0.3 0.4 @T\n2 0.2 0.3 0.4 Two\n", "lut",
       decimal_comma=("decimals are written with a point", b"0.", b"0,"))
labels("ITK-SNAP labels", b'1 255 0 0 1.00 1 1 "One"\n@N 0 255 0 1.00 1 1 "@T"\n2 0 255 0 1.00 1 1 "Two"\n', "label",
       decimal_comma=("a number from 0 to 1 is needed", b"1.00", b"1,00"))
labels("AAL text", b"ONE One 1\nTWO @T @N\nTHREE Two 2\n")
labels("Workbench label list", b"One\n1 255 0 0 255\n@T\n@N 0 255 0 255\nTwo\n2 0 255 0 255\n")
labels("FSLeyes colours", b"1 0 0.5 1\n@N 1 1 1\n16777218 1 1 1\n", "lut", colour="#ffffff", windows=NO_NAMES,
       decimal_comma=(EMPTY_TABLE, b"0.5", b"0,5"), nan=("nan", EMPTY_TABLE), minus=("-1", EMPTY_TABLE),
       out_of_range=("4294967296", EMPTY_TABLE))
labels("list of names", b"One\n@T\n", second=2, **dict.fromkeys(("large", "nan", "minus", "out_of_range"),
                                                                Never("names alone count from 1")))
labels("BIDS label table", b"index\tname\n1\tOne\n@N\t@T\n2\tTwo\n", "tsv")
labels("CSV label table", b"index,name\n1,One\n@N,@T\n2,Two\n", "csv")
labels("CSV without a header", b"1,One\n@N,@T\n2,Two\n", "csv")
labels("label table", b"Nr;Bezeichnung\n1;One\n@N;@T\n2;Two\n", "csv", ",label=Nr,name=Bezeichnung")
labels("JSON map of names", b'{"1": "One",\n"@N": "@T"}\n', "json")


def in_json(where):
    """What JSON has instead of such a number."""
    words = where + " must be a whole number from 0 to 4294967295"
    return {"nan": ("nan", "invalid token near 'nan'"), "minus": ("-1", words), "out_of_range": ("4294967296", words)}


labels("JSON list of labels", b'[{"label": 1, "name": "One"},\n{"label": @N, "name": "@T"}]\n', "json",
       **in_json("object 2: label"))
labels(
    "BrainGlobe structures",
    b'[{"id": 1, "acronym": "O", "name": "One", "structure_id_path": [1], "rgb_triplet": [1, 2, 3]},\n'
    b'{"id": @N, "acronym": "T", "name": "@T", "structure_id_path": [1, @N], "rgb_triplet": [1, 2, 3]}]\n', "json",
    **in_json("structure 2: id"))
labels("NiiVue labels", b'{"R": [1, 2], "G": [3, 4], "B": [5, 6],\n"I": [1, @N], "labels": ["One", "@T"]}\n', "json",
       **{**in_json("labels[1]: I"), "minus": Never("entries below 0 are nothing, as documented")})
labels("nnU-Net dataset.json", b'{"channel_names": {"0": "T1"},\n"labels": {"background": 0, "One": 1,\n"@T": @N}}\n',
       "json", **in_json("gauche"))
labels(
    "neuroglancer segment properties",
    b'{"@type": "neuroglancer_segment_properties", "inline": {"ids": ["1",\n"@N"],\n"properties": [{"id": "label",\n'
    b'"type": "label", "values": ["One", "@T"]}]}}\n', "json")
labels(
    "OME image-label",
    b'{"attributes": {"ome": {"image-label": {"colors": [{"label-value": 1, "rgba": [1, 2, 3, 255]}],\n'
    b'"properties": [{"label-value": 1, "name": "One"}, {"label-value": @N, "name": "@T"}]}}}}\n', "json",
    **in_json("properties[1]: label-value"))
labels(
    "Workbench label table", b'<CaretExtension><VolumeInformation Index="0"><LabelTable>\n'
    b'<Label Key="1" Red="1" Green="0" Blue="0" Alpha="1">One</Label>\n'
    b'<Label Key="@N" Red="0.5" Green="0" Blue="0" Alpha="1">@T</Label>\n'
    b'</LabelTable></VolumeInformation></CaretExtension>\n', "xml",
    decimal_comma=(b"0.5", b"0,5"))  # of the colour, which a note says is left out
labels(
    "FSL atlas XML", b'<atlas><header><name>A</name><type>Label</type></header><data>\n'
    b'<label index="1" x="0" y="0" z="0">One</label>\n<label index="@N" x="0" y="0" z="0">@T</label>\n</data></atlas>\n',
    "xml")
labels(
    "SPM atlas XML", b'<atlas><header><name>A</name><type>Label</type></header><data>\n'
    b'<label><index>1</index><name>One</name></label>\n<label><index>@N</index><name>@T</name></label>\n</data></atlas>\n',
    "xml")
labels("AFNI label table",
       b'<VALUE_LABEL_DTABLE\n ni_type="2*String"\n ni_dimen="2" >\n "1" "One"\n "@N" "@T"\n</VALUE_LABEL_DTABLE>\n',
       "niml.lt")

# ---- poses and probes: a position that is in the only voxel of label 7, or above it and points down

NO_ROWS = Never("positions have no scale")
NO_LABELS = Never("positions have no labels")
NO_NUMBERS = Never("the format counts nothing")
JSON_NUMBERS = Never("in JSON a comma ends a number")
NO_TEXT = Never("the file has no text that is used")
HEIGHT = "57"  # of a device, 60 mm above the voxel


def only_voxel(path):
    return write_nifti(f"{path}_atlas", voxels(7, "i2", 0))


def brain_of_mouse(path):
    """13.2 x 8 x 11.4 mm, the Allen CCF's, in voxels of 0.6 x 1.1 x 1 mm; label 7 where AP is 4900 um from the front
    (y: voxel 4 of 12), DV 3332 from above (z: voxel 3 of 8) and ML 6739 from the left (x: voxel 11)."""
    array = np.zeros((19, 12, 8), "i2")
    array[11, 11 - 4, 7 - 3] = 7
    head, data = nifti(array)
    head = bytearray(head)
    struct.pack_into("<8f", head, 76, 1, 0.6, 1.1, 1, 1, 1, 1, 1)
    struct.pack_into("<12f", head, 280, 0.6, 0, 0, -5.4, 0, 1.1, 0, -6.05, 0, 0, 1, -3.5)
    return write(f"{path}_atlas.nii", bytes(head) + data)


class Poses:
    """A reader of poses: `make(path, x=, y=, z=, name=, text=)` writes a file of one position, called by its name."""
    def __init__(self, make, *words, atlas=only_voxel, named=True, place=(f"{PLACE[0]:g}", f"{PLACE[1]:g}")):
        self.make, self.words, self.atlas, self.named, self.place = make, words, atlas, named, place

    def ask(self, path, place=None, **more):
        x, y = place or self.place
        file = self.make(path, x=x, y=y, **more)
        return [self.atlas(path), *(file if isinstance(file, tuple) else ("--pose", file)), *self.words]

    def answers(self, name=None, more=(), **how):
        def cell(path):
            found = rows_of(*self.ask(path, name=name or "T", **how), *more)
            assert [line["index"] for line in found if line["kind"] == "area"] == ["7"], found
            called = {line["query"] for line in found}
            assert not name or any(name in word for word in called), f"called {called!r}, wanted is {name!r}"

        return cell

    def says(self, text, code=1, **how):
        """That the only row is an error with these words, or the file is refused with them (code 3)."""
        def cell(path):
            done = run("query", *self.ask(path, **{"name": "T", **how}), "--format", "tsv", "-q")
            assert done.returncode == code, (done.returncode, done.stdout[-300:], done.stderr)
            assert text in done.stderr, f"said: {done.stderr!r}, wanted: {text!r}"

        return cell


def poses(reader, make, *words, nan='"nan" is not a finite number', far='"1e400" is not a finite number',
          comma="is not a finite number; decimals are written with a point", is_text=True, family="poses",
          large=NO_LABELS, minus=NO_NUMBERS, empty=b"", **cells):
    """The row of a reader of poses. nan, far, comma: the words about such a coordinate, or (words, exit code), None =
    it is read; empty: what a spreadsheet writes of an empty row."""
    options = {key: cells.pop(key) for key in ("atlas", "named", "place") if key in cells}
    asked = Poses(make, *words, **options)
    x, y = asked.place

    def said(words, *place):
        if isinstance(words, str):
            words = (words, 1)
        return words if isinstance(words[0], Never) else asked.says(*words, place=place)

    cells.setdefault("bom", asked.answers(text=lambda text: b"\xef\xbb\xbf" + text) if is_text else NO_TEXT)
    cells.setdefault("crlf", asked.answers(text=lambda text: text.replace(b"\n", b"\r\n")) if is_text else NO_TEXT)
    cells.setdefault("empty_rows",
                     asked.answers(text=lambda text: text.replace(b"\n", b"\n\n") + empty) if is_text else NO_TEXT)
    if not asked.named:
        cells["windows"] = Never("the file has no names")
    elif "windows" not in cells:
        cells["windows"] = asked.answers(name=TYPOGRAPHIC, encoding="cp1252")
    elif not isinstance(cells["windows"], Never):
        cells["windows"] = asked.says(*cells["windows"], name=TYPOGRAPHIC, encoding="cp1252")
    cells.setdefault("big_endian", TEXT)
    cells.setdefault("nan", said(nan, "nan", y))
    cells.setdefault("decimal_comma",
                     comma if isinstance(comma, Never) else
                     asked.answers(place=(x.replace(".", ",") + ",0" * ("." not in x), y)) if comma is None else
                     said(comma, x.replace(".", ",") + ",5" * ("." not in x), y))
    cells.setdefault("out_of_range", said(far, "1e400", y))
    lps = cells.get("lps")
    if lps is None or isinstance(lps, (tuple, dict)):
        turned = [f"{-float(word):g}" for word in asked.place]
        how = {"more": lps} if isinstance(lps, tuple) else lps or {}
        cells["lps"] = asked.answers(place=turned, **how)
    row(family, reader, byte_scale=NO_ROWS, tenth=NO_ROWS, large=large, minus=minus, **cells)


def in_lines(template, ending, **fixed):
    """make() of a text with @T, @X, @Y and @Z."""
    def make(path, x, y, name="T", text=bytes, encoding="utf-8", **more):
        z = fixed.get("z", f"{PLACE[2]:g}")
        words = template
        for key, value in {"@T": name, "@X": x, "@Y": y, "@Z": z, **{"@" + k: v
                                                                     for k, v in {**fixed, **more}.items()}}.items():
            words = words.replace(key, value)
        return write(f"{path}{ending}", text(words.encode(encoding)))

    return make


BALL, CONE = ("--radius", "0.5"), ("--angle", "0.5", "--range", "0,70")
LPS = ("--space", "lps")
NOT_DECODED = "unable to decode byte 0x92", 3
NO_POINTS = ("neither names of columns nor three numbers in a line", 3)
poses("table", in_lines("name;x;y;z;dx;dy;dz;space\n@T;@X;@Y;57;0;0;-1;@S\n", ".csv", S="ras"), *CONE, comma=None,
      empty=b";;;;;;;\n", lps={"S": "lps"})
poses("matrix", in_lines("1 0 0 @X\n0 1 0 @Y\n0 0 1 57\n0 0 0 1\n", ".txt"), *CONE, named=False, lps=LPS,
      nan="nan in row 1, column 4", far="inf in row 1, column 4", comma=("4 numbers in a line", 3))
poses("points", in_lines("@X @Y @Z @T\n", ".txt"), *BALL, empty=b",,,\n", lps=LPS, nan=NO_POINTS,
      far=NO_POINTS, comma=None)
poses("list", in_lines("@X @Y @Z\ninfo\nnumpoints 1\nuseRealRAS 1\n", ".dat"), *BALL, named=False,
      windows=Never("the file has no names"), empty=b"\n", lps=RAS_ONLY, nan=("not whole", 3),
      far=("not whole", 3), comma=("not whole", 3))
poses(
    "brainsight",
    in_lines(
        "# Version: 12\n# Coordinate system: @S\n# Encoding: UTF-8\n"
        "# Target Name\tLoc. X\tLoc. Y\tLoc. Z\tm0n0\tm0n1\tm0n2\tm1n0\tm1n1\tm1n2\tm2n0\tm2n1\tm2n2\n"
        "@T\t@X\t@Y\t57\t1\t0\t0\t0\t1\t0\t0\t0\t1\n", ".txt", S="NIfTI:Scanner"), *CONE,
    empty=b"\t" * 12 + b"\n", lps={"S": "World"}, comma=None)
poses(
    "localite",
    in_lines(
        '<InstrumentMarkerList coordinateSpace="@S">\n<InstrumentMarker>\n'
        '<Marker description="@T" set="true">\n<Matrix4D data00="0" data01="0" data02="1" data03="@X" data10="0" data11="1" '
        'data12="0" data13="@Y" data20="-1" data21="0" data22="0" data23="57" data30="0" data31="0" data32="0" data33="1"/>\n'
        "</Marker>\n</InstrumentMarker>\n</InstrumentMarkerList>\n", ".xml", S="RAS"), *CONE, lps={"S": "LPS"})
poses("electrodes", in_lines("name\tx\ty\tz\n@T\t@X\t@Y\t@Z\n", "_electrodes.tsv"), *BALL,
      empty=b"\t\t\t\n", lps=RAS_ONLY, comma=None)
poses(
    "markups",
    in_lines(
        '{"markups": [{"type": "Fiducial", "coordinateSystem": "@S", "coordinateUnits": "mm",\n'
        '"controlPoints": [{"label": "@T", "position": [@X, @Y, @Z], "positionStatus": "defined"}]}]}\n', ".mrk.json",
        S="RAS"), *BALL, lps={"S": "LPS"}, nan=("invalid token near 'nan'", 3),
    far=("real number overflow", 3), comma="position: three numbers are needed")
poses(
    "markups as .fcsv",
    in_lines(
        "# Markups fiducial file version = 4.11\n# CoordinateSystem = @S\n"
        "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n"
        "0,@X,@Y,@Z,0,0,0,1,1,1,0,@T,,\n", ".fcsv", S="RAS"), *BALL, empty=b"," * 13 + b"\n",
    lps={"S": "LPS"}, comma="15 fields, the header has 14")
poses("nibs", in_lines("nibs_position_id\ttarget_x\ttarget_y\ttarget_z\n@T\t@X\t@Y\t@Z\n", "_markers.tsv"), *BALL,
      empty=b"\t\t\t\n", lps=RAS_ONLY)
poses(
    "invesalius",
    in_lines(
        '##INVESALIUS3_MARKER_FILE_4\n"label"\t"alpha"\t"marker_type"\t"x_world"\t"y_world"\t"z_world"\t"alpha_world"\t'
        '"beta_world"\t"gamma_world"\n"@T"\t0.0\t2\t@X\t@Y\t57\t0.0\t0.0\t0.0\n', ".mkss"), *CONE,
    empty=b"\t" * 8 + b"\n", lps=RAS_ONLY)


def matlab_5(name, values, big):
    """A MAT-file of level 5 with one matrix of doubles."""
    order = ">" if big else "<"
    data = np.asarray(values, order + "f8").tobytes(order="F")
    label = name.encode().ljust(-(-len(name) // 8) * 8, b"\0")
    body = (struct.pack(order + "4I", 6, 8, 6, 0) + struct.pack(order + "2I2i", 5, 8, *np.shape(values)) +
            struct.pack(order + "2I", 1, len(name)) + label + struct.pack(order + "2I", 9, len(data)) + data)
    return (b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack(order + "H", 0x100) + (b"MI" if big else b"IM") +
            struct.pack(order + "2I", 14, len(body)) + body)


def simnibs(path, x, y, big=False, **_):
    return write(f"{path}.mat",
                 matlab_5("matsimnibs", [[-1, 0, 0, float(x)], [0, 1, 0, float(y)], [0, 0, -1, 57], [0, 0, 0, 1]], big))


BINARY_NUMBERS = Never("numbers are binary")
poses("simnibs", simnibs, *CONE, named=False, is_text=False, lps=RAS_ONLY, nan="nan in row 1", far="inf in row 1",
      comma=BINARY_NUMBERS, big_endian=Poses(simnibs, *CONE).answers(big=True))


def lead_dbs(path, x, y, kind="<f8", **_):
    file = h5py.File(f"{path}.mat", "w", userblock_size=512)
    places = [("mni", (float(x), float(y), PLACE[2])), ("native", (float(x), float(y), PLACE[2]))]
    for space, place in places:
        contacts = file.create_dataset(f"#refs#/{space}", data=np.array([place], kind).T)
        contacts.attrs["MATLAB_class"] = np.bytes_("double")
        cells = np.empty((1, 1), h5py.ref_dtype)
        cells[0, 0] = contacts.ref
        node = file.create_dataset(f"reco/{space}/coords_mm", data=cells)
        node.attrs["MATLAB_class"] = np.bytes_("cell")
        file[f"reco/{space}"].attrs["MATLAB_class"] = np.bytes_("struct")
    file["reco"].attrs["MATLAB_class"] = np.bytes_("struct")
    file.close()
    with open(f"{path}.mat", "r+b") as begun:
        begun.write(b"MATLAB 7.3 MAT-file".ljust(116) + bytes(8) + b"\0\2IM")
    return f"{path}.mat"


for reader in ("lead-dbs", "lead-dbs-native"):
    words = (*BALL, "--poses-format", reader)
    poses(reader, lead_dbs, *words, named=False, is_text=False, lps=RAS_ONLY, nan="position: nan,2,-3",
          far="position: inf,2,-3", comma=BINARY_NUMBERS, big_endian=Poses(lead_dbs, *words).answers(kind=">f8"))
SMALL = ("--radius", "0.05")
poses("ibl", in_lines('{"channel_0": {"x": @X, "y": @Y, "z": -3000,\n"lateral": 0}}\n',
                      ".json"), *SMALL, "--space", "bregma", atlas=brain_of_mouse, place=("1000", "500"), named=False,
      lps=Never("micrometres from bregma have their own axes"), nan=("invalid token near 'nan'", 3),
      far=("real number overflow", 3), comma=JSON_NUMBERS)


def nwb(path, x, y, kind="<f4", name="probe0", encoding="utf-8", **_):
    with h5py.File(f"{path}.nwb", "w") as file:
        table = file.create_group("general/extracellular_ephys/electrodes")
        for key, value in zip("xyz", (float(x), float(y), 6739)):
            table[key] = np.array([value], kind)
        table["id"] = np.array([0])
        table["group_name"] = np.array([name.encode(encoding)], h5py.string_dtype(encoding="utf-8"))
    return f"{path}.nwb"


poses("nwb", nwb, *SMALL, "--space", "ccf", atlas=brain_of_mouse, place=("4900", "3332"), is_text=False,
      windows=Never("HDF5 says that strings are UTF-8"), lps=Never("micrometres of the CCF have their own axes"),
      nan="x, y, z: not known", far="x, y, z: not known", comma=BINARY_NUMBERS,
      big_endian=Poses(nwb, *SMALL, "--space", "ccf", atlas=brain_of_mouse, place=("4900", "3332")).answers(kind=">f4"))


def probe(path, x, y, name="T", text=bytes, encoding="utf-8", **_):
    """A contact 5 mm above the tip, which the pose puts 5 mm below the voxel."""
    write(
        f"{path}.json",
        text(('{"specification": "probeinterface", "version": "0.2.26", "probes": [{"ndim": 2,\n'
              f'"si_units": "mm", "contact_positions": [[{x}, {y}]], "contact_ids": ["{name}"],\n'
              '"probe_planar_contour": [[-1, 90], [0, 0], [1, 90]]}]}\n').encode(encoding)))
    return ("--probe", f"{path}.json", f"--origin={PLACE[0]:g},{PLACE[1]:g},{PLACE[2] - 5:g}", "--direction", "0,0,-1")


poses("ProbeInterface", probe, *BALL, windows=NOT_DECODED, family="probe", place=("0", "5"),
      lps=Never("positions are on the probe"), nan=("invalid token near 'nan'", 3), far=("real number overflow", 3),
      comma=("2 numbers are needed", 3), minus=Never("a channel of -1 is documented: not wired"))

# ---- surfaces: a tetrahedron below the device, hit from above

CORNERS = np.array([[-3, 0, -3], [1, 0, -3], [-1, 5, -3], [-1, 2, -1]], float)
FACES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
ABOVE = (f"--origin={PLACE[0]:g},{PLACE[1]:g},{HEIGHT}", "--direction", "0,0,-1", "--angle", "0.1")
NO_NUMBER = Never("vertices have no scale and no labels")
NEVER_TEXT = Never("the format is binary")


def flat(array):
    return " ".join(f"{value:g}" for value in np.ravel(array))


def lines(array):
    return "".join(flat(part) + "\n" for part in array)


def vtk(corners, cells, kind="POLYGONS", title="SPACE=RAS", binary=False):
    """A legacy file; binary numbers are big-endian."""
    cells = [[len(cell), *cell] for cell in cells]
    head = f"# vtk DataFile Version 3.0\n{title}\n{'BINARY' if binary else 'ASCII'}\nDATASET POLYDATA\nPOINTS {len(corners)} float\n"
    numbers = f"{kind} {len(cells)} {sum(map(len, cells))}\n"
    if binary:
        return (head.encode() + np.asarray(corners, ">f4").tobytes() + b"\n" + numbers.encode() +
                b"".join(np.asarray(cell, ">i4").tobytes() for cell in cells) + b"\n")
    return (head + lines(corners) + numbers + lines(cells)).encode()


def vtp(corners, cells, kind="Polys", space="RAS", big=None):
    """An XML file: text, or appended raw bytes in an order."""
    order = {None: "<", False: "<", True: ">"}[big]
    arrays = [("Points", "Float32", "Points", corners, "f4"),
              (kind, "Int32", "connectivity", np.concatenate(cells), "i4"),
              (kind, "Int32", "offsets", np.cumsum([len(cell) for cell in cells]), "i4")]
    parts, blob = {"Points": "", kind: ""}, b""
    for group, word, name, values, dtype in arrays:
        how = ' NumberOfComponents="3"' if group == "Points" else ""
        if big is None:
            parts[group] += f'<DataArray type="{word}" Name="{name}"{how} format="ascii">{flat(values)}</DataArray>\n'
        else:
            data = np.asarray(values, order + dtype).tobytes()
            parts[group] += f'<DataArray type="{word}" Name="{name}"{how} format="appended" offset="{len(blob)}"/>\n'
            blob += struct.pack(order + "I", len(data)) + data
    text = "".join(f"<{group}>\n{part}</{group}>\n" for group, part in parts.items())
    count = f'NumberOfPoints="{len(corners)}" NumberOf{kind}="{len(cells)}"'
    data = f'<FieldData><Array type="String" Name="SPACE" NumberOfTuples="1" format="ascii">{flat([*space.encode(), 0])}</Array></FieldData>\n'
    return (
        f'<VTKFile type="PolyData" version="1.0" byte_order="{"Big" if big else "Little"}Endian" header_type="UInt32">\n'
        f"<PolyData>\n{data}<Piece {count}>\n{text}</Piece>\n</PolyData>\n").encode() + (
            b'<AppendedData encoding="raw">_' + blob + b"</AppendedData>\n" if blob else b"") + b"</VTKFile>\n"


def gifti(arrays, table=b"", big=False, meta=b""):
    """Arrays (intent, values) as base64, or text where big is None."""
    out = b'<?xml version="1.0" encoding="UTF-8"?>\n<GIFTI Version="1.0" NumberOfDataArrays="%d">\n' % len(
        arrays) + meta + table
    for intent, values in arrays:
        values = np.asarray(values)
        dim = "".join(f' Dim{axis}="{size}"' for axis, size in enumerate(values.shape))
        kind = {"f4": "FLOAT32", "f8": "FLOAT64", "i4": "INT32"}[values.dtype.str[1:]]
        body = (flat(values).encode() if big is None else base64.b64encode(
            values.astype((">" if big else "<") + values.dtype.str[1:]).tobytes()))
        space = (b"<CoordinateSystemTransformMatrix><DataSpace>NIFTI_XFORM_SCANNER_ANAT</DataSpace><TransformedSpace>"
                 b"NIFTI_XFORM_SCANNER_ANAT</TransformedSpace><MatrixData>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</MatrixData>"
                 b"</CoordinateSystemTransformMatrix>") if intent == "POINTSET" else b""
        out += (
            f'<DataArray Intent="NIFTI_INTENT_{intent}" DataType="NIFTI_TYPE_{kind}" ArrayIndexingOrder="RowMajorOrder" '
            f'Dimensionality="{values.ndim}"{dim} Encoding="{"ASCII" if big is None else "Base64Binary"}" '
            f'Endian="{"Big" if big else "Little"}Endian">\n'
        ).encode() + space + b"<Data>" + body + b"</Data></DataArray>\n"
    return out + b"</GIFTI>\n"


def freesurfer(corners, faces):
    return (b"\xff\xff\xfemade\n\n" + struct.pack(">2i", len(corners), len(faces)) +
            np.asarray(corners, ">f4").tobytes() + np.asarray(faces, ">i4").tobytes())


def ply(corners, faces, order=None, space="RAS"):
    kind = {None: "ascii", "<": "binary_little_endian", ">": "binary_big_endian"}[order]
    head = (
        f"ply\nformat {kind} 1.0\ncomment SPACE={space}\nelement vertex {len(corners)}\nproperty float x\nproperty float y\n"
        f"property float z\nelement face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n").encode()
    if order is None:
        return head + (lines(corners) + "".join(f"3 {flat(face)}\n" for face in faces)).encode()
    return head + np.asarray(corners, order + "f4").tobytes() + b"".join(
        b"\3" + np.asarray(face, order + "i4").tobytes() for face in faces)


def stl(corners, faces, space="RAS", ascii=False):
    if ascii:
        text = "".join("facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {flat(corners[i])}\n"
                                                                    for i in face) + "endloop\nendfacet\n"
                       for face in faces)
        return f"solid SPACE={space}\n{text}endsolid\n".encode()
    return f"SPACE={space}".encode().ljust(80) + struct.pack("<I", len(faces)) + b"".join(
        bytes(12) + np.asarray(corners[face], "<f4").tobytes() + bytes(2) for face in faces)


def obj(corners, faces, space="RAS", name=b"T"):
    return (f"# SPACE={space}\n".encode() + b"o " + name + b"\n" +
            "".join(f"v {flat(corner)}\n" for corner in corners).encode() + "".join(f"f {flat(np.asarray(face) + 1)}\n"
                                                                                    for face in faces).encode())


def off(corners, faces):
    return f"OFF\n{len(corners)} {len(faces)} 0\n".encode() + (lines(corners) + "".join(f"3 {flat(f)}\n"
                                                                                        for f in faces)).encode()


def mz3(corners, faces):
    return gzip.compress(b"MZ" + struct.pack("<HIII", 3, len(faces), len(corners), 0) +
                         np.asarray(faces, "<i4").tobytes() + np.asarray(corners, "<f4").tobytes())


def surfaces(reader, ending, make, text=None, order=None, lps=RAS_ONLY, **cells):
    """A row of a reader of surfaces: make(corners, faces, **how) are its bytes, text those of its text form."""
    def is_hit(data, more=(), change=bytes):
        def cell(path):
            found = rows_of(write(path + ending, change(data())), *ABOVE, *more)
            assert [line["kind"] for line in found] == ["area", "unassigned"], found
            # The ray along the axis enters at the top corner.
            assert abs(float(found[0]["distance_mm"]) - (float(HEIGHT) - CORNERS[3, 2])) < 0.2, found

        return cell

    def fails(words, data, change=bytes):
        return lambda path: refuses(words, write(path + ending, change(data())), *ABOVE)

    plain = text or make
    broken, beyond, negative = CORNERS.copy(), FACES.copy(), FACES.copy()
    broken[0, 0], beyond[0, 0], negative[0, 0] = np.nan, 4, -1
    for key, change in (("bom", lambda data: b"\xef\xbb\xbf" + data), ("crlf",
                                                                       lambda data: data.replace(b"\n", b"\r\n")),
                        ("empty_rows", lambda data: data.replace(b"\n", b"\n\n"))):
        wanted = cells.get(key)
        if isinstance(wanted, str) and not isinstance(wanted, Never):
            cells[key] = fails(wanted, lambda: text(CORNERS, FACES), change)
        elif wanted is None:
            cells[key] = is_hit(lambda: text(CORNERS, FACES), change=change) if text else NEVER_TEXT
    for key, data, change in (("nan", lambda: make(broken, FACES),
                               bytes), ("minus", lambda: make(CORNERS, negative),
                                        bytes), ("out_of_range", lambda: make(CORNERS, beyond), bytes),
                              ("decimal_comma", lambda: plain(CORNERS + 0.5, FACES),
                               lambda data: data.replace(b"-2.5", b"-2,5"))):
        if isinstance(cells.get(key), str) and not isinstance(cells[key], Never):
            cells[key] = fails(cells[key], data, change)
    if order:
        cells["big_endian"] = is_hit(lambda: order(CORNERS, FACES))
    if not isinstance(lps, Never):
        cells["lps"] = is_hit(lambda: lps(CORNERS * [-1, -1, 1], FACES))
    cells.setdefault("lps", lps)
    cells.setdefault("decimal_comma", BINARY_NUMBERS)
    cells.setdefault("windows", Never("the format has no names"))
    row("surfaces", reader, byte_scale=NO_NUMBER, tenth=NO_NUMBER, large=NO_NUMBER, **cells)


surfaces("OBJ", ".obj", obj, text=obj, lps=lambda c, f: obj(c, f, "LPS"), nan="a vertex is three numbers",
         minus=Never("indices below 0 count from the end"), out_of_range="vertex 5, allowed are 1 to 4",
         decimal_comma="a vertex is three numbers", big_endian=TEXT,
         windows=lambda path: has_name(write(path + ".obj", obj(CORNERS, FACES, name=LETTERS)), at=ABOVE))
surfaces("PLY", ".ply", ply, bom=BEGINS_OTHERWISE, empty_rows="not a word of PLY's header", text=ply,
         order=lambda c, f: ply(c, f, ">"), lps=lambda c, f: ply(c, f, space="LPS"), nan="a coordinate is nan mm",
         minus="vertex index -1, allowed are", out_of_range="vertex index 4, allowed are",
         decimal_comma='"-2,5", needed is a number')
surfaces("STL", ".stl", stl, bom="a binary STL file of", text=lambda c, f: stl(c, f, ascii=True),
         lps=lambda c, f: stl(c, f, "LPS"), nan="a coordinate is nan mm", minus=Never("corners have no numbers"),
         out_of_range=Never("corners have no numbers"), decimal_comma='"-2,5", needed is a vertex',
         big_endian=Never("the format is little-endian"))
surfaces("OFF", ".off", off, bom="allowed are OFF, COFF", text=off, nan='"nan", needed is a vertex',
         minus='"-1", needed is the number of a vertex', out_of_range="vertex index 4, allowed are",
         decimal_comma='"-2,5", needed is a vertex', big_endian=TEXT)
surfaces("MZ3", ".mz3", mz3, nan="a coordinate is nan mm", minus="vertex index -1, allowed are",
         out_of_range="vertex index 4, allowed are", big_endian=Never("the format is little-endian"))
surfaces("VTK", ".vtk", vtk, bom=BEGINS_OTHERWISE, empty_rows="needed is ASCII or BINARY", text=vtk,
         order=lambda c, f: vtk(c, f, binary=True), lps=lambda c, f: vtk(c, f, title="SPACE=LPS"),
         nan='"nan", needed is a coordinate', minus="vertex index -1, allowed are",
         out_of_range="vertex index 4, allowed are", decimal_comma='"-2,5", needed is a coordinate')
surfaces("VTP", ".vtp", vtp, text=vtp, order=lambda c, f: vtp(c, f, big=True), lps=lambda c, f: vtp(c, f, space="LPS"),
         nan='"nan", needed is a number', minus="vertex index -1, the piece has 4",
         out_of_range="vertex index 4, the piece has 4", decimal_comma='"-2,5", needed is a number')


def surf_gii(corners, faces, big=False):
    return gifti([("POINTSET", np.asarray(corners, "f4")), ("TRIANGLE", np.asarray(faces, "i4"))], big=big)


def text_gii(corners, faces):
    return surf_gii(corners, faces, None)


surfaces("GIFTI", ".surf.gii", surf_gii, text=text_gii, order=lambda c, f: surf_gii(c, f, True),
         nan="a coordinate is nan mm", minus="vertex index -1, allowed are", out_of_range="vertex index 4, allowed are",
         decimal_comma='number 0 is "-2,5"')
surfaces("FreeSurfer", ".pial", freesurfer, order=freesurfer, nan="a coordinate is nan mm",
         minus="vertex index -1, allowed are", out_of_range="vertex index 4, allowed are")

# ---- labels of vertices: all four of label 7

NO_VERTEX_SCALE = Never("labels of vertices have no scale")


def vertex_labels(reader, make, label=7, **cells):
    """make(path, value, name=, **how) writes the labels of the tetrahedron's vertices."""
    def named(value=7, wanted=TYPOGRAPHIC, **how):
        def cell(path):
            found = [
                line for line in rows_of(write(f"{path}.surf.gii", surf_gii(CORNERS, FACES)), *ABOVE, "--labels",
                                         make(path, value, **how)) if line["kind"] == "area"
            ]
            assert [(line["index"], line["name"])
                    for line in found] == [(str(label if value == 7 else value), wanted)], found

        return cell

    def fails(words, value=7, **how):
        return lambda path: refuses(words, write(f"{path}.surf.gii", surf_gii(CORNERS, FACES)), *ABOVE, "--labels",
                                    make(path, value, **how))

    for key, how in (("bom", {"text": lambda data: b"\xef\xbb\xbf" + data}), ("windows", {"name": LETTERS}),
                     ("crlf", {"text": lambda data: data.replace(b"\n", b"\r\n")
                               }), ("empty_rows", {"text": lambda data: data.replace(b"\n", b"\n\n")
                                                   }), ("big_endian", {"big": True}), ("large", {"value": LARGE})):
        if cells.get(key) is None:
            cells[key] = named(**how)
        elif isinstance(cells[key], str) and not isinstance(cells[key], Never):
            cells[key] = fails(cells[key], **how)
    for key, value in (("minus", -1), ("out_of_range", 2**32), ("nan", np.nan)):
        if isinstance(cells.get(key), str) and not isinstance(cells[key], Never):
            cells[key] = fails(cells[key], value)
    row("vertex labels", reader, byte_scale=NO_VERTEX_SCALE, tenth=NO_VERTEX_SCALE, lps=NO_PLACES, **cells)


def label_gii(path, value, name=TYPOGRAPHIC.encode(), text=bytes, big=False):
    key = -1 if value != value or value < 0 else int(value)
    table = b'<LabelTable>\n<Label Key="0" Red="0.5" Green="0" Blue="0">none</Label>\n<Label Key="%d" Red="0.5" Green="0" Blue="0">%s</Label>\n</LabelTable>\n' % (
        key, name)
    return write(
        f"{path}.label.gii",
        text(
            gifti([("LABEL", np.full(
                4, value).astype("f4" if value != value or value == LARGE else "f8" if value == 2**32 else "i4"))],
                  table, big)))


vertex_labels("GIFTI labels", label_gii, windows="not well-formed XML", large=CANNOT_TELL_APART,
              minus="none of 4 triangles is labelled", nan="label nan, allowed are whole numbers up to 4294967295",
              out_of_range='label "4294967296", a whole number from 0 to 4294967295', decimal_comma=WHOLE)


def annot(path, value, name=TYPOGRAPHIC.encode(), **_):
    """Entry 7 of a table of eight has a colour of its own, which all vertices have."""
    colours = [entry + 256 * 9 + 65536 * 3 for entry in range(8)]
    out = struct.pack(">i", 4) + b"".join(
        struct.pack(">2i", vertex, colours[7] if value == 7 else int(value)) for vertex in range(4))
    out += struct.pack(">4i", 1, -2, 8, 2) + b"f\0" + struct.pack(">i", 8)
    for entry in range(8):
        word = (name if entry == 7 else b"entry%d" % entry) + b"\0"
        out += struct.pack(">2i", entry, len(word)) + word + struct.pack(">4i", entry, 9, 3, 0)
    return write(f"{path}.annot", out)


NO_COLOUR = Never("a vertex has a colour; one that no entry has is no area, and a note says so")
vertex_labels("FreeSurfer annotation", annot, large=Never("labels are numbers of entries"), bom=NEVER_TEXT,
              crlf=NEVER_TEXT, empty_rows=NEVER_TEXT, minus=NO_COLOUR, nan=NO_COLOUR, out_of_range=NO_COLOUR,
              decimal_comma=NEVER_TEXT)


def fs_label(path, value, name=b"", text=bytes, **_):
    rows = "".join(f"{vertex} 0.0 0.0 0.0 0.0\n" for vertex in ([0, 1, 2, value] if value != 7 else range(4)))
    return write(f"{TYPOGRAPHIC}.label", text(f"#!ascii label, from x\n4\n{rows}".encode()))


vertex_labels("FreeSurfer label", fs_label, bom=BEGINS_OTHERWISE,
              empty_rows="the number of vertices, 1 to 16777216, is needed", label=1,
              large=Never("it has one area, and no number"), windows=Never("the area is called as the file"),
              big_endian=TEXT, minus="vertex -1: this label is of voxels",
              nan="a vertex, 0 to 16777215, and four numbers", out_of_range="a vertex, 0 to 16777215, and four numbers",
              decimal_comma=Never("coordinates are not used"))


def cifti(path, value, name=TYPOGRAPHIC.encode(), big=False, **_):
    """A .dlabel.nii of the four vertices of the left cortex."""
    order = ">" if big else "<"
    key = -1 if value != value or value < 0 else int(value)
    xml = (
        b'<CIFTI Version="2"><Matrix><MatrixIndicesMap AppliesToMatrixDimension="0" IndicesMapToDataType="CIFTI_INDEX_TYPE_LABELS">'
        b'<NamedMap><MapName>m</MapName><LabelTable><Label Key="0" Red="0" Green="0" Blue="0" Alpha="0">none</Label>'
        b'<Label Key="%d" Red="1" Green="0" Blue="0" Alpha="1">%s</Label></LabelTable></NamedMap></MatrixIndicesMap>'
        b'<MatrixIndicesMap AppliesToMatrixDimension="1" IndicesMapToDataType="CIFTI_INDEX_TYPE_BRAIN_MODELS">'
        b'<BrainModel IndexOffset="0" IndexCount="4" ModelType="CIFTI_MODEL_TYPE_SURFACE" '
        b'BrainStructure="CIFTI_STRUCTURE_CORTEX_LEFT" SurfaceNumberOfVertices="4">'
        b"<VertexIndices>0 1 2 3</VertexIndices></BrainModel></MatrixIndicesMap></Matrix></CIFTI>") % (key, name)
    xml = xml.ljust(-(-(len(xml) + 8) // 16) * 16 - 8, b"\0")
    values = np.full((1, 4), value, "f4" if value != value or value == LARGE else "f8" if value == 2**32 else "i4")
    head, data = nifti(values, version=2, big=big, intent=3007, dim=[6, 1, 1, 1, 1, 1, 4])
    head = bytearray(head)
    struct.pack_into(order + "q", head, 168, 544 + 8 + len(xml))
    return write(f"{path}.dlabel.nii",
                 bytes(head) + b"\1\0\0\0" + struct.pack(order + "2i", 8 + len(xml), 32) + xml + data[4:])


vertex_labels("CIFTI labels", cifti, large="label 16777216, which the LabelTable of map \"m\" lacks",
              minus="none of 4 triangles is labelled", nan="label nan, allowed are whole numbers up to 4294967295",
              out_of_range='label "4294967296", a whole number from 0 to 4294967295', decimal_comma=WHOLE,
              bom=NEVER_TEXT, crlf=NEVER_TEXT, empty_rows=NEVER_TEXT)

# ---- streamlines: one from 2 mm below to 2 mm above the voxel

LINE = np.array([[PLACE[0], PLACE[1], PLACE[2] - 2], [PLACE[0], PLACE[1], PLACE[2] + 2]])
NO_SCALAR = Never("points have no scale")
POINT_NAN, POINT_FAR = "nan", "found (10000000000, 2, -1) mm, allowed is within 1e9 of 0"


def streamlines(reader, ending, make, text=None, order=None, lps=RAS_ONLY, **cells):
    """make(points, **how) are the bytes of a file of one streamline; text(points) those of a text form."""
    def is_hit(data, change=bytes, more=""):
        def cell(path):
            file = write(path + ending, change(data())) + more
            found = rows_of(only_voxel(path), "--streamlines", file, *AT)
            assert [line["kind"] for line in found if line["kind"] == "bundle"] == ["bundle"], found

        return cell

    def fails(words, data, change=bytes):
        return lambda path: refuses(words, only_voxel(path), "--streamlines", write(path + ending, change(data())), *AT)

    broken, far = LINE.copy(), LINE.copy()
    broken[1, 0], far[1, 0] = np.nan, 1e10
    plain = text or make
    for key, change in (("bom", lambda data: b"\xef\xbb\xbf" + data), ("crlf",
                                                                       lambda data: data.replace(b"\n", b"\r\n")),
                        ("empty_rows", lambda data: data.replace(b"\n", b"\n\n"))):
        if isinstance(cells.get(key), str) and not isinstance(cells[key], Never):
            cells[key] = fails(cells[key], lambda: text(LINE), change)
        elif cells.get(key) is None:
            cells[key] = is_hit(lambda: text(LINE), change) if text else NEVER_TEXT
        elif isinstance(cells[key], tuple):
            cells[key] = is_hit(*cells[key])
    for key, data, change in (("nan", lambda: make(broken), bytes), ("out_of_range", lambda: make(far), bytes),
                              ("decimal_comma", lambda: plain(LINE + [0.25, 0, 0]),
                               lambda data: data.replace(b"-0.75", b"-0,75"))):
        if isinstance(cells.get(key), str) and not isinstance(cells[key], Never):
            cells[key] = fails(cells[key], data, change)
    if order:
        cells["big_endian"] = is_hit(lambda: order(LINE))
    if not isinstance(lps, Never):
        cells["lps"] = is_hit(lambda: lps(LINE * [-1, -1, 1]))
    cells.setdefault("lps", lps)
    cells.setdefault("decimal_comma", BINARY_NUMBERS)
    cells.setdefault("windows", Never("a bundle is called as its file; names of scalars are no answer"))
    cells.setdefault("minus", NO_NUMBERS)
    row("streamlines", reader, byte_scale=NO_SCALAR, tenth=NO_SCALAR, large=NO_LABELS, **cells)


def tck(points, big=False, end="\n"):
    kind = ">f4" if big else "<f4"
    points = np.vstack([points, [[np.nan] * 3], [[np.inf] * 3]])
    head = f"mrtrix tracks\ndatatype: Float32{'BE' if big else 'LE'}\ncount: 1\nfile: . 100\nEND\n".replace(
        "\n", end).encode()
    return head.ljust(100, b"\0") + points.astype(kind).tobytes()


def trk(points, big=False, order=b"RAS"):
    """Voxels of 1 mm and a matrix that puts the centre of the first one at (-50, -50, -50)."""
    kind = ">" if big else "<"
    head = bytearray(1000)
    struct.pack_into(kind + "6s3h3f", head, 0, b"TRACK", 100, 100, 100, 1, 1, 1)
    struct.pack_into(kind + "16f", head, 440, 1, 0, 0, -50, 0, 1, 0, -50, 0, 0, 1, -50, 0, 0, 0, 1)
    head[948:951] = order
    struct.pack_into(kind + "3i", head, 988, 1, 2, 1000)
    return bytes(head) + np.array([len(points)],
                                  kind + "i4").tobytes() + (np.asarray(points) + 50.5).astype(kind + "f4").tobytes()


def trk_lps(points):
    """`points` in LPS, where x is -x. Axes that count from the other end of 100 voxels: where x + 50.5 is from the
    corner, 100 - (x + 50.5) is there, which trk() makes of -1 - x."""
    return trk(np.asarray(points) - [1, 1, 0], order=b"LPS")


def tt(points, big=False):
    def variable(name, kind, values, size=None):
        data = np.asarray(values, {10: "<f4", 20: "<i4", 50: "u1"}[kind])
        return struct.pack("<5I", kind, 1, data.size, 0, len(name) + 1) + name.encode() + b"\0" + data.tobytes()

    steps = np.rint(32 * np.where(np.abs(points) > 1e6, 0, points)).astype(int)
    track = struct.pack("<I3i", steps.size, *steps[0])
    for step in np.diff(np.vstack([steps[:1], np.linspace(steps[0], steps[1], 3)[1:]]), axis=0).astype(int):
        track += step.astype("i1").tobytes()
    track = struct.pack("<I", 9) + track[4:]
    matrix = np.eye(4)
    matrix[0, 3] = np.where(np.abs(points).max() > 1e6, 1e10, 0)
    return (variable("dimension", 20, [99, 99, 99]) + variable("voxel_size", 10, [1, 1, 1]) +
            variable("trans_to_mni", 10, matrix.ravel()) + variable("track", 50, np.frombuffer(track, "u1")))


def trx(points):
    out = pathlib.Path("made.trx")
    with zipfile.ZipFile(out, "w") as archive:
        archive.writestr(
            "header.json",
            json.dumps(
                {"NB_STREAMLINES": 1, "NB_VERTICES": 2, "DIMENSIONS": [9, 9, 9], "VOXEL_TO_RASMM": np.eye(4).tolist()}))
        archive.writestr("positions.3.float32", np.asarray(points, "<f4").tobytes())
        archive.writestr("offsets.uint32", np.array([0], "<u4").tobytes())
    return out.read_bytes()


streamlines("trk", ".trk", trk, order=lambda p: trk(p, True), lps=trk_lps, nan=POINT_NAN, out_of_range=POINT_FAR)
streamlines("tck", ".tck", tck, text=tck, bom=BEGINS_OTHERWISE, crlf=(lambda: tck(LINE, end="\r\n"), ),
            empty_rows=(lambda: tck(LINE, end="\n\n"), ), order=lambda p: tck(p, True), nan=POINT_NAN,
            out_of_range=POINT_FAR, decimal_comma=BINARY_NUMBERS)
streamlines("tt", ".tt", tt, nan=Never("steps are whole numbers"), out_of_range="allowed is within 1e9 of 0",
            big_endian=Never("the format is little-endian"))
streamlines("trx", ".trx", trx, nan=POINT_NAN, out_of_range=POINT_FAR, big_endian=Never("the format is little-endian"))
streamlines("vtk", ".vtk", bom=BEGINS_OTHERWISE, empty_rows="needed is ASCII or BINARY",
            make=lambda p: vtk(p, [[0, 1]], "LINES"), text=lambda p: vtk(p, [[0, 1]], "LINES"),
            order=lambda p: vtk(p, [[0, 1]], "LINES", binary=True),
            lps=lambda p: vtk(p, [[0, 1]], "LINES", "SPACE=LPS"), nan='"nan", needed is a coordinate',
            out_of_range=POINT_FAR, decimal_comma='"-0,75", needed is')
streamlines("vtp", ".vtp", lambda p: vtp(p, [[0, 1]], "Lines"), text=lambda p: vtp(p, [[0, 1]], "Lines"),
            order=lambda p: vtp(p, [[0, 1]], "Lines", big=True), lps=lambda p: vtp(p, [[0, 1]], "Lines", "LPS"),
            nan='"nan", needed is a number', out_of_range=POINT_FAR, decimal_comma='"-0,75", needed is')

# ---- transforms: points 2 mm to the left of the voxel are moved into it

LEFT = (f"--point={PLACE[0] - 2:g},{PLACE[1]:g},{PLACE[2]:g}", "--radius", "0.5")
NO_TRANSFORM_SCALE = Never("numbers of a transform have no scale")


def transform(reader, ending, make, text=None, order=None, keys="", lps=RAS_ONLY, **cells):
    """make(2, **how) are the bytes of a shift by +2 mm along x; of text, another number may stand there."""
    def is_moved(data, change=bytes):
        def cell(path):
            atlas = only_voxel(path)
            file = write(path + ending, change(data())) + keys.replace("@", atlas)
            assert label_at(atlas, "--atlas-transform", file, at=LEFT) == 7

        return cell

    def fails(words, data, change=bytes):
        return lambda path: refuses(words, only_voxel(path), "--atlas-transform",
                                    write(path + ending, change(data())) + keys.replace("@", f"{path}_atlas.nii"), *LEFT
                                    )

    for key, change in (("bom", lambda data: b"\xef\xbb\xbf" + data), ("crlf",
                                                                       lambda data: data.replace(b"\n", b"\r\n")),
                        ("empty_rows", lambda data: data.replace(b"\n", b"\n\n"))):
        if isinstance(cells.get(key), str) and not isinstance(cells[key], Never):
            cells[key] = fails(cells[key], lambda: make("2"), change)
        elif cells.get(key) is None:
            cells[key] = is_moved(lambda: make("2"), change) if text else NEVER_TEXT
    for key, number in (("nan", "nan"), ("decimal_comma", "2,0"), ("out_of_range", "1e400")):
        if isinstance(cells.get(key), str) and not isinstance(cells[key], Never):
            cells[key] = fails(cells[key], lambda number=number: make(number))
        elif key in cells and cells[key] is None:
            cells[key] = is_moved(lambda number=number: make(number))
    if order:
        cells["big_endian"] = is_moved(lambda: order("2"))
    cells["lps"] = lps if isinstance(lps, Never) else is_moved(lambda: lps("2"))
    cells.setdefault("big_endian", TEXT)
    cells.setdefault("decimal_comma", BINARY_NUMBERS)
    cells.setdefault("windows", Never("names in it are not used"))
    cells.setdefault("minus", NO_NUMBERS)
    row("transforms", reader, byte_scale=NO_TRANSFORM_SCALE, tenth=NO_TRANSFORM_SCALE, large=NO_LABELS, **cells)


def negative(number):
    """That number with its sign changed: LPS."""
    return number if number == "nan" else "-" + number


def itk_text(number):
    return (f"#Insight Transform File V1.0\n#Transform 0\nTransform: TranslationTransform_double_3_3\n"
            f"Parameters: {negative(number)} 0 0\nFixedParameters:\n").encode()


def matlab_4(variables, big):
    out = b""
    for name, values in variables:
        out += struct.pack((">" if big else "<") + "5I", 1000 if big else 0, len(values), 1, 0,
                           len(name) + 1) + name.encode() + b"\0"
        out += np.asarray(values, (">" if big else "<") + "f8").tobytes()
    return out


def itk_matlab(number, big=False):
    values = [1, 0, 0, 0, 1, 0, 0, 0, 1, float(negative(number)), 0, 0]
    return matlab_4([("AffineTransform_double_3_3", values), ("fixed", [0, 0, 0])], big)


def matrix_text(number, last="0 0 0 1\n"):
    return f"1 0 0 {number}\n0 1 0 0\n0 0 1 0\n{last}".encode()


def lta(number):
    volume = "valid = 1\nvolume = 4 5 6\nvoxelsize = 2 2 2\nxras = 1 0 0\nyras = 0 1 0\nzras = 0 0 1\ncras = 0 0 0\n"
    return (f"type = 1\nnxforms = 1\n1 4 4\n1 0 0 {number}\n0 1 0 0\n0 0 1 0\n0 0 0 1\nsrc volume info\n{volume}"
            f"dst volume info\n{volume}").encode()


def register(number):
    """tkregister's x runs to the left."""
    return f"bert\n2\n2\n0.15\n1 0 0 {negative(number)}\n0 1 0 0\n0 0 1 0\n0 0 0 1\nround\n".encode()


def hdf5_bytes(fill):
    with h5py.File("made.h5", "w") as file:
        fill(file)
    return pathlib.Path("made.h5").read_bytes()


def itk_hdf5(number, kind="<f8"):
    def fill(file):
        group = file.create_group("TransformGroup/0")
        group["TransformType"] = np.array([b"AffineTransform_double_3_3"], h5py.string_dtype())
        group["TransformParameters"] = np.array([1, 0, 0, 0, 1, 0, 0, 0, 1, float(negative(number)), 0, 0], kind)
        group["TransformFixedParameters"] = np.zeros(3, kind)

    return hdf5_bytes(fill)


def x5(number, kind="<f8"):
    def fill(file):
        file.attrs.update({"Format": "X5", "Version": np.uint16(1)})
        group = file.create_group("TransformGroup/0")
        group.attrs.update({"Type": "linear", "ArrayLength": 1})
        matrix = np.eye(4)
        matrix[0, 3] = float(number)
        group["Transform"] = matrix.astype(kind)

    return hdf5_bytes(fill)


def itk_spline(number):
    """6 x 6 x 6 nodes, 20 mm apart: coefficients that are all alike are a shift."""
    shift = " ".join([negative(number)] * 216) + " " + " ".join(["0"] * 432)
    return (f"#Insight Transform File V1.0\n#Transform 0\nTransform: BSplineTransform_double_3_3\nParameters: {shift}\n"
            f"FixedParameters: 6 6 6 -50 -50 -50 20 20 20 1 0 0 0 1 0 0 0 1\n").encode()


def field(number, kind, big=False):
    """A field on the voxels of the atlas."""
    grid = np.moveaxis(np.indices(SHAPE), 0, -1) * 2 + ORIGIN
    shift = np.array([float(number) if np.isfinite(float(number)) else 2, 0, 0])
    if kind == "itk":
        vectors, dim = np.broadcast_to(shift * [-1, -1, 1], SHAPE + (3, ))[:, :, :, None], 1007
    elif kind == "spm":
        vectors, dim = (grid + shift)[:, :, :, None], 1007
    else:  # x of FSL runs the other way
        vectors, dim = np.broadcast_to(shift * [-1, 1, 1], SHAPE + (3, )), 2006
    vectors = np.array(vectors, "f4")
    if not np.isfinite(float(number)):
        vectors[0, 0, 0, ..., 0] = float(number)
    head, data = nifti(vectors, big=big, intent=dim, dim=[vectors.ndim, *vectors.shape])
    head = bytearray(head)
    if kind == "spm":
        head[328:335] = b"Mapping"
    return bytes(head) + data


NUMBERS = dict(nan='"nan", four finite numbers are needed', decimal_comma=',0", four finite numbers are needed',
               out_of_range='1e400", four finite numbers are needed')
PARAMETERS = dict(nan='"nan", finite numbers are needed', decimal_comma='"-2,0", finite numbers are needed',
                  out_of_range='"-1e400", finite numbers are needed')
transform("MATRIX", ".txt", matrix_text, text=True, **NUMBERS)
transform("MATRIX of FSL", ".mat", lambda n: matrix_text(negative(n)), text=True, keys=",from=@,to=@", **NUMBERS)
transform("ITK", ".tfm", itk_text, text=True, lps=itk_text, **PARAMETERS)
transform("ITK with a B-spline", ".tfm", itk_spline, text=True, lps=itk_spline, **PARAMETERS)
transform("ITK_MATLAB", ".mat", itk_matlab, order=lambda n: itk_matlab(n, True), lps=itk_matlab,
          nan="a number that is not finite", out_of_range="a number that is not finite")
transform(
    "XFM", ".xfm", lambda n: b"MNI Transform File\nTransform_Type = Linear;\nLinear_Transform =\n" + matrix_text(n, "").
    rstrip(b"\n") + b";\n", text=True, **NUMBERS)
transform("LTA", ".lta", lta, text=True, **NUMBERS)
transform("REGISTER", ".dat", register, text=True, keys=",from=@,to=@", empty_rows=BEGINS_OTHERWISE, **NUMBERS)
transform("itk_hdf5", ".h5", itk_hdf5, order=lambda n: itk_hdf5(n, ">f8"), lps=itk_hdf5, nan="number 9 is not finite",
          out_of_range="number 9 is not finite")
transform("x5", ".x5", x5, order=lambda n: x5(n, ">f8"), nan="the matrix is singular",
          out_of_range="the matrix is singular")
NOT_FINITE = "voxel (0, 0, 0): a vector that is not finite"
for kind, keys in (("itk", ""), ("spm", ""), ("fsl", ",from=@,to=@")):

    def of_kind(number, kind=kind, big=False):
        return field(number, kind, big)

    # SPM's positions are not finite where nothing of the other image is: of one far corner here.
    wanted = {"itk": NOT_FINITE, "fsl": NOT_FINITE, "spm": None}[kind]
    transform(f"field of {kind}", ".nii", of_kind, order=lambda n, of_kind=of_kind: of_kind(n, big=True), keys=keys,
              nan=wanted, out_of_range=wanted, **({"lps": of_kind} if kind == "itk" else {}))

# ---- atlases of BrainGlobe: folders of several files

NO_SCALE_IN_FOLDER = Never("neither TIFF nor Zarr has a scale")
STRUCTURES = ('[{"id": 1, "acronym": "O", "name": "One", "structure_id_path": [1], "rgb_triplet": [1, 2, 3]},\n'
              '{"id": @N, "acronym": "T", "name": "@T", "structure_id_path": [1, @N], "rgb_triplet": [@R, 2, 3]}]\n')
TERMINOLOGY = "identifier,parent_identifier,annotation_value,name,abbreviation\n1,,1,One,O\n@N,1,@N,@T,T\n"


def brainglobe_2(path, array=None, name=TYPOGRAPHIC.encode(), number=7, text=bytes, big=False, orientation="ipl", red=1,
                 metadata=""):
    """annotation.tiff, structures.json and metadata.json; pages are z, rows y, columns x."""
    folder = pathlib.Path(path)
    folder.mkdir()
    array = voxels(7, "i2") if array is None else array
    write(folder / "annotation.tiff", tiff(array, big))
    write(
        folder / "metadata.json",
        text((f'{{"name": "made", "orientation": "{orientation}",\n'
              f'"resolution": [2000, 2000, 2000]{metadata}}}\n').encode()))
    write(
        folder / "structures.json",
        text(STRUCTURES.encode().replace(b"@N",
                                         str(number).encode()).replace(b"@T", name).replace(b"@R",
                                                                                            str(red).encode())))
    return str(folder)


def brainglobe_3(path, array=None, name=TYPOGRAPHIC.encode(), number=7, text=bytes, big=False, metadata="",
                 orientation="asr"):
    """An atlas of the third release, whose axes are AP, DV and ML: voxel (a, b, c) has its centre at
    x = -(2 c + 1), y = -(2 a + 1), z = -(2 b + 1), as all three start at the far side."""
    root = pathlib.Path(path) / "brainglobe-atlasapi"
    array = voxels(7, "i2") if array is None else array
    atlas, names = root / "atlases/made/1_0", root / "terminologies/made/1_0"
    store = root / "annotation-sets/made/1_0/annotations_compressed.ome.zarr"
    for folder in (atlas, names, store / "s0/c/0/0"):
        folder.mkdir(parents=True)
    shape = list(array.shape)
    write(
        atlas / "manifest.json",
        text((f'{{"name": "made", "resolution": [2000, 2000, 2000], "shape": {shape}, "orientation": "{orientation}",\n'
              f'"annotation_set": {{"location": "/annotation-sets/made/1_0"}},\n'
              f'"terminology": {{"location": "/terminologies/made/1_0"}}{metadata}}}\n').encode()))
    write(names / "terminology.csv", text(TERMINOLOGY.encode().replace(b"@N",
                                                                       str(number).encode()).replace(b"@T", name)))
    scale = {"type": "scale", "scale": [2, 2, 2]}
    write(
        store / "zarr.json",
        json.dumps({
            "attributes": {
                "ome": {
                    "multiscales": [{
                        "axes": [{"unit": "millimeter"}] * 3,
                        "datasets": [{"path": "s0", "coordinateTransformations": [scale]}]
                    }]
                }
            }
        }).encode())
    write(
        store / "s0/zarr.json",
        json.dumps({
            "zarr_format": 3, "node_type": "array", "attributes": {}, "shape": shape,
            "data_type": np.dtype(array.dtype).name,
            "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": shape}}, "fill_value": 0,
            "chunk_key_encoding": {"name": "default"},
            "codecs": [{"name": "bytes", "configuration": {"endian": "big" if big else "little"}}]
        }).encode())
    write(store / "s0/c/0/0/0", array.astype(array.dtype.newbyteorder(">" if big else "<")).tobytes())
    return str(atlas)


A, B, C = VOXEL
AT_ASR = (f"--point={-(2 * C + 1)},{-(2 * A + 1)},{-(2 * B + 1)}", "--radius", 0.5)


def brainglobe(reader, make, at, lps, **cells):
    def is_named(at=at, wanted=TYPOGRAPHIC, **how):
        return lambda path: has_name(make(path, **how), at=at, wanted=wanted)

    large = voxels(LARGE, "f4")
    row("folders", reader, byte_scale=NO_SCALE_IN_FOLDER, tenth=NO_SCALE_IN_FOLDER,
        large=lambda path: refuses(CANNOT_TELL_APART, make(path, array=large, number=LARGE), *at),
        bom=is_named(text=lambda text: b"\xef\xbb\xbf" + text), windows=is_named(name=LETTERS),
        crlf=is_named(text=lambda text: text.replace(b"\n", b"\r\n")),
        empty_rows=is_named(text=lambda text: text.replace(b"\n", b"\n\n")),
        nan=is_named(metadata=', "unused": NaN'), lps=lps(is_named), big_endian=is_named(big=True),
        minus=lambda path: refuses(NOT_WHOLE, make(path, array=voxels(-1, "i2")), *at),
        out_of_range=lambda path: refuses(NOT_WHOLE, make(path, array=voxels(2**32, "f8")), *at), **cells)


brainglobe("BrainGlobe 2", brainglobe_2, at_corner(1, 1,
                                                   1), lambda named: named(at=at_corner(-1, -1, 1), orientation="iar"),
           decimal_comma=Never("in JSON a comma ends a number"))
brainglobe("BrainGlobe 3", brainglobe_3, AT_ASR, lambda named: Never("its API takes every array as asr"),
           decimal_comma=Never("in JSON a comma ends a number"))

# ---- fields of SimNIBS as a region of overlap, and images of values


def simnibs_field(path, node=1, value=1.0, big=False):
    """Tetrahedra of 36 mm3 around the voxel, one for each value: none counts whose value is NaN."""
    kind = ">" if big else "<"
    with h5py.File(f"{path}.hdf5", "w") as file:
        corners = np.array([[0, 0, 0], [6, 0, 0], [0, 6, 0], [0, 0, 6]], float) + [-2, 1, -4]
        file["mesh/nodes/node_coord"] = corners.astype(kind + "f8")
        values = np.ravel(value).astype(kind + "f4")
        file["mesh/elm/elm_type"] = np.full(len(values), 4, kind + "i4")
        file["mesh/elm/tag1"] = np.full(len(values), 2, kind + "i4")
        file["mesh/elm/node_number_list"] = np.array([[node, 2, 3, 4]] * len(values), kind + "i4")
        file["mesh/elmdata/magnE"] = values
    return f"{path}.hdf5"


def covers(**how):
    def cell(path):
        done = run("overlap", only_voxel(path), simnibs_field(path, **how), "--threshold", "0.5", "--format", "tsv")
        assert done.returncode == 0, done.stderr
        head, *found = [line.split("\t") for line in done.stdout.splitlines()]
        assert [dict(zip(head, line))["index"] for line in found
                if line[head.index("kind")] == "area"] == ["7"], done.stdout

    return cell


def covers_not(words, **how):
    def cell(path):
        done = run("overlap", only_voxel(path), simnibs_field(path, **how), "--threshold", "0.5")
        assert done.returncode == 3 and words in done.stderr, (done.returncode, done.stderr)

    return cell


row("fields", "SimNIBS", byte_scale=NO_SCALE, tenth=NO_SCALE, large=Never("tissues are no areas"), bom=NEVER_TEXT,
    windows=NEVER_TEXT, crlf=NEVER_TEXT, empty_rows=NEVER_TEXT, decimal_comma=NEVER_TEXT, lps=RAS_ONLY,
    big_endian=covers(big=True), nan=covers(value=[1, np.nan]), minus=covers_not("found node -1, allowed are 1 to 4",
                                                                                 node=-1),
    out_of_range=covers_not("found node 5, allowed are 1 to 4", node=5))

# ---- images of values: 0.6 at the place, 0 elsewhere, and one other value in the corner

NO_NUMBERS_OF_AREAS = Never("values are no labels")


def pathway(path, array, slope=0.0, big=False):
    atlas = write_nifti(f"{path}_all", np.ones(SHAPE, "u1"))
    return "pathway", [atlas, "--pathway", write_nifti(path, array, slope=slope, big=big)]


def probabilities(path, array, slope=0.0, big=False):
    """Two maps, the second with the values, and a table that names them."""
    pair = np.stack([np.zeros_like(array), array], 3)
    pair[0, 4, 0, 0] = 1 if slope == 0 else round(1 / slope)
    write(f"{path}.tsv", b"index\tname\n1\tOne\n2\tTwo\n")
    return "area", [write_nifti(path, pair, slope=slope, big=big), "--labels", f"{path}.tsv"]


def named_probseg(path, array, slope=0.0, big=False):
    """One map, whose name says what it is."""
    return "area", [write_nifti(f"{path}_label-GM_probseg", array, slope=slope, big=big)]


def values(reader, make, **cells):
    def is_there(stored, dtype, other=None, slope=0.0, big=False, warns=None):
        def cell(path):
            array = voxels(stored, dtype, 0)
            array[3, 0, 0] = stored if other is None else other
            kind, words = make(path, array, slope=slope, big=big)
            found = [line for line in rows_of(*words, *AT, warns=warns) if line["kind"] == kind]
            assert len(found) == 1 and abs(float(found[0]["max_value"]) - 0.6) < 1e-6, found

        return cell

    def fails(words, other):
        def cell(path):
            array = voxels(0.6, "f4", 0)
            array[3, 0, 0] = other
            refuses(words, *make(path, array)[1], *AT)

        return cell

    for key, other in (("nan", np.nan), ("minus", -1), ("out_of_range", 1.5)):
        if isinstance(cells[key], str):
            cells[key] = fails(cells[key], other)
        elif isinstance(cells[key], tuple):  # answered, with that note
            cells[key] = is_there(0.6, "f4", other, warns=cells[key][0])
    row("values", reader, byte_scale=is_there(153, "u1", 255, slope=float(BYTE_SCALE)),
        tenth=is_there(6, "i2", slope=float(TENTH)), large=NO_NUMBERS_OF_AREAS, bom=BINARY, windows=BINARY, crlf=BINARY,
        empty_rows=BINARY, decimal_comma=BINARY, lps=RAS_ONLY, big_endian=is_there(0.6, "f4", big=True), **cells)


values("pathway", pathway, nan=("1 voxels are not finite numbers", ), minus=("", ),
       out_of_range=("1 voxels have values above the scale, 1, up to 1.5", ))
values("probabilities", probabilities, nan=("1 voxels are not finite numbers", ),
       minus="values from -1 to 1 are not probabilities",
       out_of_range=("1 voxels have values below 0 or above the scale, 1", ))
values("probabilities by name", named_probseg, nan=("1 voxels are not finite numbers", ),
       minus="no probability is below 0", out_of_range=("1 voxels have values below 0 or above the scale, 1", ))

# ---- arrays in Python

PYTHON = sys.argv[4] if pathlib.Path(sys.argv[4], "conus", "_conus.py").exists() else None
PRELUDE = f"""
import nibabel
import numpy as np
import conus
array = np.ones({SHAPE})
affine = np.array([[2, 0, 0, {ORIGIN[0]}], [0, 2, 0, {ORIGIN[1]}], [0, 0, 2, {ORIGIN[2]}], [0, 0, 0, 1]])
V, P = {VOXEL}, {PLACE}
def load(source, **more):
    return conus.load(source, **more) if hasattr(source, "shape") and hasattr(source, "affine") else conus.load(source, affine, **more)
def show(source, kind="area", **more):
    atlas = load(source, **more)
    table = atlas.near(P, 0.5).to_dataframe()
    print(*atlas.notes, sep="; ")
    print(table[table["kind"] == kind][["index", "max_value"]].to_numpy().tolist())
def scaled(stored, slope):
    nibabel.save(nibabel.Nifti1Image(stored, affine), "made.nii")
    data = bytearray(open("made.nii", "rb").read())
    data[112:116] = np.float32(slope).tobytes()
    open("made.nii", "wb").write(data)
    return nibabel.load("made.nii")
"""


def python(code, wanted):
    """Runs code, which prints `wanted`."""
    def cell(_):
        done = subprocess.run(["/usr/bin/python3", "-c", PRELUDE + code], capture_output=True, text=True, check=False,
                              env={**os.environ, "PYTHONPATH": PYTHON})
        assert wanted in done.stdout + done.stderr, f"{done.stdout + done.stderr!r}, wanted: {wanted!r}"

    return cell if PYTHON else Never("conus is built without Python")


STRINGS = Never("strings of Python are Unicode")
for reader, wrap in (("arrays", "({})"), ("nibabel images", "nibabel.Nifti1Image({}, affine)")):

    def shown(value, dtype, wanted, wrap=wrap):
        return python(f"array[V] = {value}\nshow({wrap.format(f'array.astype({dtype!r})')})", wanted)

    row(
        "python", reader, byte_scale=NO_SCALE if reader == "arrays" else python(
            "stored = np.zeros(array.shape, 'u1')\nstored[V], stored[3, 0, 0] = 153, 255\n"
            "show(nibabel.Nifti1Image(array.astype('u1'), affine), 'pathway', pathways=[scaled(stored, 1 / 255)])",
            "0.6000"), tenth=NO_SCALE if reader == "arrays" else python(
                "stored = np.full(array.shape, 10, 'i2')\nstored[V] = 70\nshow(scaled(stored, 0.1))", "[[7, "),
        large=shown(LARGE, "f4", CANNOT_TELL), bom=STRINGS, windows=STRINGS, crlf=STRINGS, empty_rows=STRINGS,
        decimal_comma=BINARY_NUMBERS, nan=shown("np.nan", "f4", NOT_WHOLE), minus=shown(-1, "i2", NOT_WHOLE),
        lps=Never("the affine says where the axes lead"), big_endian=shown(7, ">i2", "[[7, "),
        out_of_range=shown("2.0**32", "f8", NOT_WHOLE))

# ---- the readers of the program


def source(path):
    return (SOURCES / path).read_text(encoding="utf-8")


def readers_of_program():
    """{family: names}, from the program's tables, or from what it says where a file is none of them."""
    write("none", bytes(range(200, 250)) * 8)
    volumes = re.search(r"a labelled volume \(([^)]*)\)", run("info", "none").stderr)[1].split(", ")
    vertices = "GIFTI or CIFTI labels, or a FreeSurfer annotation or label"
    assert vertices in run("info", write("none.surf.gii", surf_gii(CORNERS, FACES)), "--labels", "none").stderr
    tables = re.search(r"struct label_format formats\[\] = \{\n(.*?)\n\};", source("loaders/labels/label_bytes.c"), re.S)[1]
    formats = re.search(r"auto\s+\(default\), (.*?)\n +--",
                        run("query", "--help").stdout[run("query", "--help").stdout.index("--poses-format"):], re.S)[1]
    rows = re.findall(r"\((\w+), ([A-Z_ |]*ROLE_[A-Z_ |]*)", source("sources/rows.c"))
    rows = {role: {name for name, roles in rows if name != "OTHER" and f"ROLE_{role}" in roles.split(" | ")}
            for role in ("SURFACE", "TRACTS", "TRANSFORM")}
    return {
        "volume": {name
                   for name in volumes},
        "labels": set(re.findall(r'^    \{"([^"]+)",(?! LABEL_PALETTE)', tables, re.M)),
        "poses": {name.strip()
                  for name in formats.split(",")},
        "probe": {"ProbeInterface"},
        "folders": {"BrainGlobe"},
        "fields": {"SimNIBS"},
        "python": {"arrays", "nibabel images"},
        "values": {"pathway", "probabilities"},
        "surfaces": {"FreeSurfer" if name == "FREESURFER" else name for name in rows["SURFACE"]},
        "vertex labels": {"GIFTI labels", "CIFTI labels", "FreeSurfer annotation", "FreeSurfer label"},
        "streamlines": {name.lower() for name in rows["TRACTS"]},
        "transforms": (rows["TRANSFORM"] - {"HDF5", "NIFTI", "NRRD", "METAIMAGE"}) | {"field"}
        | set(re.findall(r"(x5|itk_hdf5)_parse", source("loaders/transform/transform_file.c"))),
    }


def check_readers():
    for family, names in readers_of_program().items():
        rows = {reader for of, reader in ROWS if of == family}
        for name in sorted(names):
            if not any(reader == name or re.match(re.escape(name) + r"(-\d| )", reader) for reader in rows):
                yield f"{family}, {name}: the reader has no row in tests/oracles/compare_readers.py"
        for reader in sorted(rows):
            if not any(reader == name or re.match(re.escape(name) + r"(-\d| )", reader) for name in names):
                yield f"{family}, {reader}: the program has no such reader"


# ---- running


def print_table(failed):
    """Each cell: "+" where a file is written, asked and as it has to be, "WRONG", or why there is no such file."""
    print("| reader | " + " | ".join(KINDS) + " |\n|" + "---|" * (len(KINDS) + 1))
    for (family, reader), cells in ROWS.items():
        words = [
            cells[kind] if isinstance(cells[kind], Never) else "WRONG" if any(
                problem.startswith(f"{family}, {reader}: {kind}:") for problem in failed) else "+" for kind in KINDS
        ]
        print(f"| {family}: {reader} | " + " | ".join(words) + " |")


def check():
    failed = list(check_readers())
    for (family, reader), cells in ROWS.items():
        for kind in KINDS:
            cell = cells.get(kind)
            if cell is None:
                failed.append(f"{family}, {reader}: {kind}: the row has no such cell")
            elif not isinstance(cell, Never):
                folder = pathlib.Path(re.sub(r"\W+", "_", f"{family} {reader} {kind}"))
                folder.mkdir()
                os.chdir(folder)
                try:
                    cell("file")
                except AssertionError as problem:
                    failed.append(f"{family}, {reader}: {kind}: {problem}")
                except Exception as problem:
                    failed.append(f"{family}, {reader}: {kind}: {type(problem).__name__} {problem}")
                os.chdir("..")
    if "--table" in sys.argv:
        print_table(failed)
    print(*failed, sep="\n")
    print(f"{len(ROWS)} readers, {sum(map(len, ROWS.values()))} cells, {len(failed)} wrong")
    return bool(failed)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        code = check()
        os.chdir("/")
    sys.exit(code)
