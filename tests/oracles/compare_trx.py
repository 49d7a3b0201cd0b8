#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Tractograms as TRX, in VTK's formats and in DSI Studio's, which this program writes, against readings that share no
code with conus.

TRX is written and read by Python's zipfile and numpy: stored, deflated, with ZIP64's sizes, as a stream whose sizes
stand behind the files, and as a folder; positions of every precision, offsets of both, with and without the last one,
numbers of every type, groups that overlap. Damaged archives are refused. VTK's writers write, and its readers read,
polylines as text and binary numbers, in both layouts of cells, in every encoding of XML, with numbers of points and
lines. All numbers are equal, bit by bit. DSI Studio's are random walks, whose steps numpy takes and adds up again; the
affine is applied in float64, so that points differ by half a step of float32 at most.

usage: compare_trx.py DUMP_TRACT; exit 77 = skipped."""

import gzip
import io
import itertools
import json
import os
import struct
import subprocess
import sys
import tempfile
import warnings
import zipfile

try:
    import numpy as np
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonCore import VTK_DOUBLE, vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
    from vtkmodules.vtkIOLegacy import vtkPolyDataReader, vtkPolyDataWriter
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLPolyDataWriter
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

DUMP = sys.argv[1]
ENVIRONMENT = {**os.environ, "LC_ALL": "de_DE.UTF-8"}
INTEGERS = ["int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64"]
FAULTS = []


def ask(path):
    """What conus reads, as a dict; or None and its message."""
    with tempfile.NamedTemporaryFile() as out:
        run = subprocess.run([DUMP, path, out.name], capture_output=True, encoding="utf-8", check=False,
                             env=ENVIRONMENT)
        if run.returncode:
            return None, run.stderr.strip()
        text, _, data = out.read().partition(b"\n\n")
    lines = [line.split("\t") for line in text.decode().splitlines()]
    said = {line[0]: line[1] for line in lines}
    streamlines, points = int(said["streamlines"]), int(said["points"])
    got = {"format": said["format"], "scalars": {}, "groups": {}}

    def take(count, kind):
        nonlocal data
        size = count * np.dtype(kind).itemsize
        part, data = np.frombuffer(data[:size], kind), data[size:]
        return part

    got["first"] = take(streamlines + 1, "<u8")
    got["points"] = take(3 * points, "<f2" if said["format"].endswith("float16") else "<f4").reshape(-1, 3)
    for word, name, *rest in lines:
        if word in ("per_point", "per_streamline"):
            components = int(rest[0])
            count = points if word == "per_point" else streamlines
            got["scalars"][word, name] = take(count * components, "<f4").reshape(count, components)
    for word, name, *rest in lines:
        if word == "group":
            got["groups"][name] = take(int(rest[0]), "<u4")
    assert not data, path
    return got, run.stderr


def same(a, b):
    a, b = np.asarray(a), np.asarray(b)
    return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()


def compare(name, got, wanted):
    for key in ("first", "points"):
        if not same(got[key], wanted[key]):
            FAULTS.append(f"{name}: {key} differ")
    for key in ("scalars", "groups"):
        if got[key].keys() != wanted[key].keys():
            FAULTS.append(f"{name}: {key} {sorted(got[key])}, wanted {sorted(wanted[key])}")
            continue
        FAULTS.extend(f"{name}: {key} {k} differ" for k in got[key] if not same(got[key][k], wanted[key][k]))


# TRX


def files_of(rng, streamlines, precision, offset_type, has_last):
    """Names and bytes of a random TRX."""
    counts = rng.integers(0, 12, streamlines)
    first = np.concatenate([[0], np.cumsum(counts)])
    points = int(first[-1])
    files = {"header.json": json.dumps({"VOXEL_TO_RASMM": np.eye(4).tolist(), "DIMENSIONS": [9, 9, 9],
                                        "NB_STREAMLINES": streamlines, "NB_VERTICES": points}).encode(),
             f"positions.3.{precision}": rng.normal(0, 60, (points, 3)).astype(precision).tobytes(),
             f"offsets.{offset_type}": first[:None if has_last else -1].astype(offset_type).tobytes()}
    for kind in INTEGERS:
        limits = np.iinfo(kind)
        files[f"dps/a.{kind}.{kind}"] = rng.integers(limits.min, limits.max, streamlines, kind, True).tobytes()
        files[f"dpv/b_{kind}.2.{kind}"] = rng.integers(limits.min, limits.max, 2 * points, kind, True).tobytes()
    for kind in ("float16", "float32", "float64"):
        numbers = rng.normal(0, 1, streamlines).astype(kind)
        numbers[::7] = np.nan
        files[f"dps/c{kind}.{kind}"] = numbers.tobytes()
        files[f"dpv/d{kind}.3.{kind}"] = rng.normal(0, 9, 3 * points).astype(kind).tobytes()
    for i in range(4):
        members = rng.choice(streamlines, rng.integers(0, streamlines), replace=False).astype("<u4")
        files[f"groups/Bündel {i}.uint32"] = members.tobytes()
    files["dpg/Bündel 0/volume.float32"] = b"abcd"
    return files


def expected(files):
    """What these files mean."""
    header = json.loads(files["header.json"])
    wanted = {"scalars": {}, "groups": {}}
    for name, data in files.items():
        folder, _, base = name.rpartition("/")
        kind = base.rpartition(".")[2]
        if folder in ("dps", "dpv"):
            rest = base[:-len(kind) - 1]
            components = rest.rpartition(".")[2]
            is_count = components.isdigit()
            rest = rest[:-len(components) - 1] if is_count else rest
            word = "per_point" if folder == "dpv" else "per_streamline"
            with np.errstate(over="ignore"):
                wanted["scalars"][word, rest] = np.frombuffer(data, kind).astype("<f4").reshape(
                    -1, int(components) if is_count else 1)
        elif folder == "groups":
            wanted["groups"][base[:-len(".uint32")]] = np.unique(np.frombuffer(data, "<u4"))
        elif base.startswith("positions"):
            points = np.frombuffer(data, kind)
            wanted["points"] = (points if kind == "float16" else points.astype("<f4")).reshape(-1, 3)
        elif base.startswith("offsets"):
            first = np.frombuffer(data, kind).astype("<u8")
            wanted["first"] = np.append(first[:header["NB_STREAMLINES"]], np.uint64(header["NB_VERTICES"]))
    return wanted


class Stream(io.RawIOBase):
    """Where nobody can go back, so that sizes are written behind the files."""

    def __init__(self, file):
        super().__init__()
        self.file = file

    def writable(self):
        return True

    def write(self, data):
        return self.file.write(data)


def write_trx(path, files, way):
    if way == "folder":
        for name, data in files.items():
            os.makedirs(os.path.dirname(os.path.join(path, name)), exist_ok=True)
            with open(os.path.join(path, name), "wb") as file:
                file.write(data)
        return
    method = zipfile.ZIP_DEFLATED if way in ("deflated", "streamed") else zipfile.ZIP_STORED
    with open(path, "wb") as file:
        with zipfile.ZipFile(Stream(file) if way == "streamed" else file, "w", method) as archive:
            for name, data in files.items():
                with archive.open(name, "w", force_zip64=way == "zip64") as member:
                    member.write(data)


def read_trx(path, way):
    """The files again, by zipfile, or from the folder."""
    if way != "folder":
        with zipfile.ZipFile(path) as archive:
            return {name: archive.read(name) for name in archive.namelist()}
    files = {}
    for folder, _, names in os.walk(path):
        for name in names:
            with open(os.path.join(folder, name), "rb") as file:
                files[os.path.relpath(os.path.join(folder, name), path)] = file.read()
    return files


def compare_trx(folder):
    rng = np.random.default_rng(19)
    ways = ["stored", "deflated", "zip64", "streamed", "folder"]
    offsets = itertools.cycle(itertools.product(("uint32", "uint64"), (True, False)))
    count = 0
    for precision, way in itertools.product(("float16", "float32", "float64"), ways * 2):
        offset_type, has_last = next(offsets)
        path = os.path.join(folder, f"{count}-{precision}-{offset_type}-{has_last}-{way}.trx")
        write_trx(path, files_of(rng, int(rng.integers(1, 60)), precision, offset_type, has_last), way)
        got, message = ask(path)
        count += 1
        if got is None:
            FAULTS.append(f"{path}: refused: {message}")
            continue
        compare(path, got, expected(read_trx(path, way)))
        if "dpg: values of groups are not read" not in message:
            FAULTS.append(f"{path}: no note about dpg")
    return count


def damage(folder):
    """Archives that no reader should take, and a part of the message."""
    rng = np.random.default_rng(20)
    good = files_of(rng, 20, "float32", "uint64", True)
    cases = {"positions.3.float32": (good["positions.3.float32"][:-1], "positions.3.float32: "),
             "offsets.uint64": (good["offsets.uint64"][::-1], "offsets.uint64: number 0"),
             "groups/Bündel 0.uint32": (np.uint32([20]).tobytes(), "group 'Bündel 0': found streamline 20"),
             "header.json": (b"{}", "header.json: NB_STREAMLINES"),
             "dpv/../../x.uint8": (b"1", "a file's name is absolute"),
             "/x.uint8": (b"1", "a file's name is absolute")}
    for i, (name, (data, part)) in enumerate(cases.items()):
        path = os.path.join(folder, f"damaged-{i}.trx")
        write_trx(path, {**good, name: data}, "deflated")
        yield path, part
    path = os.path.join(folder, "twice.trx")
    with zipfile.ZipFile(path, "w") as archive, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for name, data in [*good.items(), ("header.json", good["header.json"])]:
            archive.writestr(name, data)
    yield path, "header.json: there are two of this name"
    for name, change in (("bent", lambda data: data[:200] + bytes([data[200] ^ 1]) + data[201:]),
                         ("cut", lambda data: data[:-100])):
        path = os.path.join(folder, name + ".trx")
        write_trx(path, good, "stored")
        with open(path, "rb") as file:
            data = file.read()
        with open(path, "wb") as file:
            file.write(change(data))
        yield path, "zip: "


# VTK


def lines_of(rng, is_double):
    """Polylines that share points, between vertices and triangles, with numbers of points and cells."""
    count = 50
    points = vtkPoints()
    if is_double:
        points.SetDataType(VTK_DOUBLE)
    for point in rng.normal(0, 60, (count, 3)):
        points.InsertNextPoint(point)
    poly = vtkPolyData()
    poly.SetPoints(points)
    cells = {"Verts": [1] * 3, "Lines": list(rng.integers(2, 9, 12)), "Polys": [3] * 5}
    for word, sizes in cells.items():
        array = vtkCellArray()
        for size in sizes:
            array.InsertNextCell(int(size))
            for index in rng.choice(count, size, replace=False):
                array.InsertCellPoint(int(index))
        getattr(poly, "Set" + word)(array)
    for data, number in ((poly.GetPointData(), count), (poly.GetCellData(), sum(map(len, cells.values())))):
        for name, kind, components in (("FA of it", "f4", 1), ("colour", "u1", 3), ("wide", "f8", 2), ("n", "i4", 1)):
            values = numpy_to_vtk((rng.normal(0, 1, (number, components)) * 50 + 100).astype(kind), deep=True)
            values.SetName(name)
            data.AddArray(values)
        data.SetActiveScalars("FA of it")
        data.SetActiveVectors("colour")
    return poly


def by_vtk(reader, path):
    """Points of each line, and numbers of points and lines, by VTK's reader."""
    for word in ("Scalars", "Vectors", "Fields"):
        if hasattr(reader, "ReadAll" + word + "On"):
            getattr(reader, "ReadAll" + word + "On")()
    reader.SetFileName(path)
    reader.Update()
    poly = reader.GetOutput()
    lines = poly.GetLines()
    corners = vtk_to_numpy(lines.GetConnectivityArray())
    wanted = {"first": vtk_to_numpy(lines.GetOffsetsArray()).astype("<u8"), "groups": {}, "scalars": {},
              "points": vtk_to_numpy(poly.GetPoints().GetData()).astype("<f4")[corners]}
    before, count = poly.GetNumberOfVerts(), poly.GetNumberOfLines()
    for word, data in (("per_point", poly.GetPointData()), ("per_streamline", poly.GetCellData())):
        for i in range(data.GetNumberOfArrays()):
            values = vtk_to_numpy(data.GetArray(i)).astype("<f4")
            values = values.reshape(len(values), -1)
            rows = corners if word == "per_point" else np.arange(before, before + count)
            wanted["scalars"][word, data.GetArrayName(i)] = values[rows]
    return wanted


def writers():
    for version, is_text in itertools.product((42, 51), (True, False)):
        writer = vtkPolyDataWriter()
        writer.SetFileVersion(version)
        (writer.SetFileTypeToASCII if is_text else writer.SetFileTypeToBinary)()
        yield f"legacy-{version}-{is_text}.vtk", writer, vtkPolyDataReader
    for mode, packed, encoded in itertools.product(("Ascii", "Binary", "Appended"), (True, False), (True, False)):
        writer = vtkXMLPolyDataWriter()
        getattr(writer, f"SetDataModeTo{mode}")()
        (writer.SetCompressorTypeToZLib if packed else writer.SetCompressorTypeToNone)()
        writer.SetEncodeAppendedData(encoded)
        yield f"xml-{mode}-{packed}-{encoded}.vtp", writer, vtkXMLPolyDataReader


def compare_vtk(folder):
    rng = np.random.default_rng(21)
    count = 0
    for number, (name, writer, reader) in enumerate(writers()):
        is_double = number % 3 == 0
        path = os.path.join(folder, f"{is_double}-{name}")
        writer.SetInputData(lines_of(rng, is_double))
        writer.SetFileName(path)
        writer.Write()
        got, message = ask(path)
        count += 1
        if got is None:
            FAULTS.append(f"{path}: refused: {message}")
            continue
        compare(path, got, by_vtk(reader(), path))
    return count


# DSI Studio


def variable(name, kind, values):
    """A variable of a MAT-file of level 4."""
    data = np.asarray(values, {0: "<f8", 10: "<f4", 20: "<i4", 40: "<u2", 50: "u1"}[kind])
    return struct.pack("<5I", kind, 1, data.size, 0, len(name) + 1) + name.encode() + b"\0" + data.tobytes()


def walk_bytes(points):
    """A streamline as DSI Studio stores it: the number of coordinates, the first point, the steps to the next ones."""
    steps = np.diff(points, axis=0)
    assert abs(steps).max(initial=0) < 128
    return struct.pack("<I3i", points.size, *points[0]) + steps.astype("i1").tobytes()


def compare_dsi(folder):
    rng = np.random.default_rng(22)
    for number in range(8):
        walks = [np.cumsum(np.vstack([rng.integers(-9999, 9999, (1, 3)), rng.integers(-127, 128, (n, 3))]), axis=0)
                 for n in rng.integers(0, 3000, 20)]
        affine = np.vstack([np.float32(rng.normal(0, 2, (3, 4)) * [1, 1, 1, 50]), [0, 0, 0, 1]])
        clusters = rng.integers(0, 65536, 20) if number % 2 else []
        blocks = [b"".join(map(walk_bytes, walks[:9])), b"".join(map(walk_bytes, walks[9:]))]
        data = (variable("dimension", 20, [99, 99, 99]) + variable("voxel_size", 10, [2, 2, 2])
                + variable("trans_to_mni", 10 * (number % 2), affine.ravel())
                + variable("color", 20, [16752700]) + variable("cluster", 40, clusters)
                + variable("track", 50, np.frombuffer(blocks[0], "u1"))
                + variable("track1", 50, np.frombuffer(blocks[1], "u1")))
        path = os.path.join(folder, f"walk-{number}.tt" + (".gz" if number > 3 else ""))
        with (gzip.open if number > 3 else open)(path, "wb") as file:
            file.write(data)
        got, message = ask(path)
        if got is None:
            FAULTS.append(f"{path}: refused: {message}")
            continue
        world = np.vstack(walks) / 32 @ affine[:3, :3].T + affine[:3, 3]
        near = np.abs(got["points"] - world) <= 0.51 * np.spacing(np.abs(world).astype("<f4")) + 1e-12
        first = np.cumsum([0] + [len(walk) for walk in walks])
        if not near.all() or not np.array_equal(got["first"], first):
            FAULTS.append(f"{path}: points or streamlines differ")
        if [list(v.ravel()) for v in got["scalars"].values()] != ([list(clusters)] if len(clusters) else []):
            FAULTS.append(f"{path}: clusters differ")
    return 8


with tempfile.TemporaryDirectory() as FOLDER:
    TRX, VTK, DSI, REFUSED = compare_trx(FOLDER), compare_vtk(FOLDER), compare_dsi(FOLDER), list(damage(FOLDER))
    for PATH, PART in REFUSED:
        GOT, MESSAGE = ask(PATH)
        if GOT is not None or PART not in MESSAGE:
            FAULTS.append(f"{PATH}: {'read' if GOT else MESSAGE}, wanted a refusal with {PART!r}")
print(*FAULTS[:20], sep="\n")
print(f"{TRX} TRX, {VTK} VTK and {DSI} DSI Studio files read, {len(REFUSED)} refused, {len(FAULTS)} faults")
sys.exit(1 if FAULTS else 0)
