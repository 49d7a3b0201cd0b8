#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Mesh files of other programs against VTK: real files, and files that VTK, and this program, write here.

VTK's reader for the format, then its triangle filter, gives the triangles that are wanted: the same corners, bit by bit
as float32, in the same order, but those without area, which conus leaves out. OFF and MZ3, which VTK does not read, are
written here from known arrays. conus is asked with its locale set to one with a decimal comma, if there is one.

usage: compare_foreign.py DUMP_MESH [SHARED_FOLDER]; exit 77 = skipped."""

import glob
import gzip
import json
import math
import os
import struct
import subprocess
import sys
import tempfile
from fractions import Fraction

try:
    import numpy as np
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonCore import VTK_DOUBLE, vtkPoints, vtkStringArray
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
    from vtkmodules.vtkFiltersCore import vtkStripper, vtkTriangleFilter
    from vtkmodules.vtkIOGeometry import vtkOBJReader, vtkOBJWriter, vtkSTLReader, vtkSTLWriter
    from vtkmodules.vtkIOLegacy import vtkPolyDataReader, vtkPolyDataWriter
    from vtkmodules.vtkIOPLY import vtkPLYReader, vtkPLYWriter
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLPolyDataWriter
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

DUMP = sys.argv[1]
HERE = os.path.dirname(os.path.abspath(__file__))
SHARED = sys.argv[2] if len(sys.argv) > 2 else os.environ.get(
    "CONUS_SHARED_DATA", os.path.join(HERE, "../../../shared/data"))
READERS = {".vtk": vtkPolyDataReader, ".vtp": vtkXMLPolyDataReader, ".ply": vtkPLYReader, ".stl": vtkSTLReader,
           ".obj": vtkOBJReader}
ENVIRONMENT = {**os.environ, "LC_ALL": "de_DE.UTF-8"}


def ask(path):
    """Vertices and triangles by conus, or its message."""
    with tempfile.NamedTemporaryFile() as out:
        run = subprocess.run([DUMP, "surface", path, out.name, "ras"], capture_output=True, encoding="utf-8",
                             check=False, env=ENVIRONMENT)
        if run.returncode:
            return None, run.stderr.strip()
        counts = dict(line.split(" ", 1) for line in run.stdout.splitlines())
        data = out.read()
    split = 12 * int(counts["vertices"])
    return (np.frombuffer(data[:split], "<f4").reshape(-1, 3), np.frombuffer(data[split:], "<u4").reshape(-1, 3)), ""


def cells_of(cells):
    """The cells of a vtkCellArray as lists of indices."""
    ends = vtk_to_numpy(cells.GetOffsetsArray())
    corners = vtk_to_numpy(cells.GetConnectivityArray())
    return [list(corners[a:b]) for a, b in zip(ends, ends[1:])]


def by_vtk(path):
    """Points as float32, triangles by VTK."""
    reader = READERS[os.path.splitext(path)[1]]()
    if isinstance(reader, vtkSTLReader):
        reader.MergingOff()
    reader.SetFileName(path)
    reader.Update()
    poly = reader.GetOutput()
    triangulate = vtkTriangleFilter()
    triangulate.PassVertsOff()
    triangulate.PassLinesOff()
    triangulate.SetInputData(poly)
    triangulate.Update()
    cells = [cell for cell in cells_of(triangulate.GetOutput().GetPolys()) if len(cell) == 3]
    points = vtk_to_numpy(poly.GetPoints().GetData()).astype(np.float32)
    return points, np.array(cells, dtype=np.int64).reshape(-1, 3)


def with_area(corners):
    wide = corners.astype(np.float64)
    normals = np.cross(wide[:, 1] - wide[:, 0], wide[:, 2] - wide[:, 0])
    return corners[np.linalg.norm(normals, axis=1) > 0]


def in_order(corners):
    """Triangles sorted, each beginning with its smallest corner."""
    turned = [min(t[k:] + t[:k] for k in range(3)) for t in corners.tolist()]
    return np.array(sorted(turned), dtype=np.float32)


def without_holes(ours, theirs, faces):
    """Both without the polygons that VTK leaves a hole in: those that the rounding of a text bends, one in a hundred.
    A polygon of n corners has n - 2 triangles; conus finds them all."""
    owner = np.repeat(np.arange(len(faces)), [len(face) for face in faces])
    wanted = np.array([len(face) - 2 for face in faces])
    found = np.bincount(owner[theirs[:, 0]], minlength=len(faces))
    if not np.array_equal(np.bincount(owner[ours[:, 0]], minlength=len(faces)), wanted) or sum(found < wanted) > 2:
        sys.exit(f"polygons with a hole: {sum(found < wanted)} of VTK's, or one of conus's")
    whole = found == wanted
    return ours[whole[owner[ours[:, 0]]]], theirs[whole[owner[theirs[:, 0]]]]


def compare(path, wanted=None, same_vertices=True, faces=None):
    """Fails unless conus finds the wanted triangles, by default VTK's. faces: polygons without common corners."""
    points, triangles = wanted or by_vtk(path)
    got, message = ask(path)
    if not got:
        sys.exit(f"{path}: refused: {message}")
    if same_vertices and not np.array_equal(got[0], points):
        sys.exit(f"{path}: vertices differ: {got[0].shape}, {points.shape}")
    indices = got[1]
    if faces:
        indices, triangles = without_holes(indices, triangles, faces)
    ours, theirs = got[0][indices], with_area(points[triangles])
    if "double" in path:  # VTK cuts polygons by the doubles, and of equally good ears may take the other one first
        ours, theirs = in_order(ours), in_order(theirs)
    if ours.shape != theirs.shape or not np.array_equal(ours, theirs):
        where = np.argmax((ours != theirs).any(axis=(1, 2))) if ours.shape == theirs.shape else -1
        sys.exit(f"{path}: triangles differ: {ours.shape}, {theirs.shape}, the first at {where}"
                 + (f": {ours[where].tolist()}, {theirs[where].tolist()}" if where >= 0 else ""))
    return len(ours)


# Files made here


def bumpy_sphere(rows, columns, random):
    """A closed surface of quadrangles that are not flat, and of triangles at its poles."""
    points = [(0, 0, 50 + random.uniform(-1, 1)), (0, 0, -50 + random.uniform(-1, 1))]
    for i in range(1, rows):
        for k in range(columns):
            up, round_ = math.pi * i / rows, 2 * math.pi * k / columns
            radius = 50 + random.uniform(-3, 3)
            points.append((radius * math.sin(up) * math.cos(round_), radius * math.sin(up) * math.sin(round_),
                           radius * math.cos(up)))
    at = lambda i, k: 2 + (i - 1) * columns + k % columns
    faces = [(0, at(1, k), at(1, k + 1)) for k in range(columns)]
    faces += [(at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)) for i in range(1, rows - 1)
              for k in range(columns)]
    faces += [(1, at(rows - 1, k + 1), at(rows - 1, k)) for k in range(columns)]
    return np.array(points), faces


def stars(random, count):
    """Flat polygons that are not convex, turned any way, and convex ones of up to 12 corners; no two share a corner."""
    points, faces = [], []
    for n in range(count):
        corners = random.integers(4, 13)
        axes = np.linalg.qr(random.normal(size=(3, 3)))[0]
        radii = random.uniform(0.55, 1, corners) if n % 2 else np.ones(corners)
        angles = 2 * math.pi * (np.arange(corners) + random.uniform(0, 0.6, corners)) / corners
        start = len(points)
        points += [10 * radius * (math.cos(angle) * axes[0] + math.sin(angle) * axes[1]) + 30 * axes[2]
                   for radius, angle in zip(radii, angles)]
        faces.append(tuple(range(start, start + corners)))
    return np.array(points), faces


def poly_data(points, faces, wide=False):
    poly, places, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
    if wide:
        places.SetDataType(VTK_DOUBLE)
    for point in points:
        places.InsertNextPoint(*point)
    for face in faces:
        cells.InsertNextCell(len(face), face)
    poly.SetPoints(places)
    poly.SetPolys(cells)
    return poly


def in_strips(poly):
    triangulate, stripper = vtkTriangleFilter(), vtkStripper()
    triangulate.SetInputData(poly)
    stripper.SetInputConnection(triangulate.GetOutputPort())
    stripper.Update()
    return stripper.GetOutput()


def write_legacy(folder, name, poly):
    for binary in (False, True):
        for version in (42, 51):
            writer = vtkPolyDataWriter()
            writer.SetInputData(poly)
            writer.SetFileVersion(version)
            (writer.SetFileTypeToBinary if binary else writer.SetFileTypeToASCII)()
            writer.SetFileName(f"{folder}/{name}-{version}-{'binary' if binary else 'ascii'}.vtk")
            writer.Write()


def write_vtp(folder, name, poly):
    for mode in ("ascii", "binary", "appended", "raw"):
        for header in (32, 64):
            for packer in ("none", "zlib"):
                for order in ("little", "big"):
                    writer = vtkXMLPolyDataWriter()
                    writer.SetInputData(poly)
                    (writer.SetDataModeToAscii if mode == "ascii" else
                     writer.SetDataModeToBinary if mode == "binary" else writer.SetDataModeToAppended)()
                    writer.SetEncodeAppendedData(mode == "appended")
                    (writer.SetHeaderTypeToUInt32 if header == 32 else writer.SetHeaderTypeToUInt64)()
                    (writer.SetCompressorTypeToNone if packer == "none" else writer.SetCompressorTypeToZLib)()
                    (writer.SetByteOrderToLittleEndian if order == "little" else writer.SetByteOrderToBigEndian)()
                    writer.SetBlockSize(4096)
                    writer.SetFileName(f"{folder}/{name}-{mode}-{header}-{packer}-{order}.vtp")
                    writer.Write()


def write_ply(folder, name, poly):
    for binary, big in ((False, False), (True, False), (True, True)):
        writer = vtkPLYWriter()
        writer.SetInputData(poly)
        (writer.SetFileTypeToBinary if binary else writer.SetFileTypeToASCII)()
        (writer.SetDataByteOrderToBigEndian if big else writer.SetDataByteOrderToLittleEndian)()
        writer.SetFileName(f"{folder}/{name}-{binary}-{big}.ply")
        writer.Write()


def write_others(folder, name, poly):
    for binary in (False, True):
        writer = vtkSTLWriter()
        triangulate = vtkTriangleFilter()
        triangulate.SetInputData(poly)
        triangulate.Update()
        writer.SetInputData(triangulate.GetOutput())
        (writer.SetFileTypeToBinary if binary else writer.SetFileTypeToASCII)()
        writer.SetFileName(f"{folder}/{name}-{binary}.stl")
        writer.Write()
    writer = vtkOBJWriter()
    writer.SetInputData(poly)
    writer.SetFileName(f"{folder}/{name}.obj")
    writer.Write()


def write_obj_dialects(folder, points, faces):
    """With texture coordinates and normals, indices from the end, and digits beyond a float's."""
    count = len(points)
    for style in ("{0}", "{0}/{0}", "{0}//{0}", "{0}/{0}/{0}"):
        lines = ["# made"] + ["v " + " ".join(f"{x:.{n % 17 + 4}g}" for x in p) for n, p in enumerate(points)]
        lines += [f"vt {k / count} 0" for k in range(count)] + ["vn 0 0 1"] * count
        lines += ["f " + " ".join(style.format(i + 1) for i in face) for face in faces]
        with open(f"{folder}/dialect-{style.count('/')}{'//' in style}.obj", "w", encoding="ascii") as file:
            file.write("\n".join(lines) + "\n")
    with open(f"{folder}/crlf.obj", "w", encoding="ascii", newline="\r\n") as file:
        file.write("".join("v %r %r %r\n" % tuple(map(float, p)) for p in points))
        file.write("".join("f " + " ".join(str(i + 1) for i in face) + "\n" for face in faces))


def compare_off(folder, points, faces, triangles):
    """Text of four dialects; the numbers have the 9 digits that make a float."""
    narrow = points.astype(np.float32)
    for name, word, tail in (("plain", "OFF\n", ""), ("none", "# OFF\n", ""), ("normals", "NOFF\n", " 0 0 1"),
                             ("colours", "COFF # made\n", " 0.5 0.25 1 1"), ("one-line", "OFF ", "")):
        path = f"{folder}/{name}.off"
        with open(path, "w", encoding="ascii") as file:
            file.write(f"{word}{len(points)} {len(faces)} 0\n\n")
            file.write("".join("%.9g %.9g %.9g" % tuple(map(float, p)) + tail + "\n" for p in narrow))
            file.write("".join(f"{len(f)} " + " ".join(map(str, f)) + ("  255 0 0\n" if "c" in name else "\n")
                               for f in faces))
        compare(path, (narrow, triangles))


def compare_mz3(folder, points, triangles):
    narrow, table = points.astype("<f4"), json.dumps({"R": [1], "labels": ["a"]}).encode()
    values = np.arange(len(points), dtype="<u4").tobytes()
    for attributes, skipped, tail in ((3, b"", b""), (7, b"skip", values), (11, b"", values + values),
                                      (75, table, values), (19, b"", values + values)):
        data = struct.pack("<2sHIII", b"MZ", attributes, len(triangles), len(points), len(skipped))
        data += skipped + triangles.astype("<u4").tobytes() + narrow.tobytes() + tail
        for packed in (False, True):
            path = f"{folder}/{attributes}-{packed}.mz3"
            with open(path, "wb") as file:
                file.write(gzip.compress(data) if packed else data)
            compare(path, (narrow, triangles))


def nearest_float(word):
    """The float nearest to a decimal number, by exact fractions; of two equally near ones that with the even bits."""
    near = np.float32(float(word))
    bits = int(near.view(np.uint32))
    return min((np.uint32(b).view(np.float32) for b in (max(bits - 1, 0), bits, bits + 1)),
               key=lambda x: (abs(Fraction(float(x)) - Fraction(word)), int(x.view(np.uint32)) % 2))


def compare_numbers(folder, random):
    """Decimal numbers near the middle between two floats, and exactly there."""
    bits = random.integers(0x30000000, 0x4e000000, 3000, dtype=np.uint32)
    low = bits.view(np.float32).astype(np.float64)
    high = (bits + 1).view(np.float32).astype(np.float64)
    middle = (low + high) / 2
    words = []
    for n, value in enumerate(middle):
        digits = f"{value:.{n % 40 + 5}f}"[:60]
        words.append(digits if n % 3 else digits.rstrip("0") + "0" * 10 + "1")
    words = [word[:63] for word in words]
    path = f"{folder}/middle.obj"
    with open(path, "w", encoding="ascii") as file:
        for n in range(0, len(words), 3):
            file.write("v " + " ".join(words[n:n + 3]) + "\n")
        file.write("".join(f"f {n + 1} {n + 2} {n + 3}\n" for n in range(0, len(words) // 3 - 2)))
    got, message = ask(path)
    if not got:
        sys.exit(f"{path}: refused: {message}")
    wanted = np.array([nearest_float(word) for word in words]).reshape(-1, 3)
    if not np.array_equal(got[0], wanted):
        where = np.argmax((got[0] != wanted).any(axis=1))
        sys.exit(f"{path}: vertex {where}: {got[0][where]}, {wanted[where]}, {words[3 * where:3 * where + 3]}")
    return len(words)


def compare_made():
    random = np.random.default_rng(20)
    files = triangles = 0
    with tempfile.TemporaryDirectory() as folder:
        for name, (points, faces) in (("sphere", bumpy_sphere(9, 14, random)), ("stars", stars(random, 200))):
            poly = poly_data(points, faces)
            write_legacy(folder, name, poly)
            write_legacy(folder, name + "-double", poly_data(points, faces, True))
            write_legacy(folder, name + "-strips", in_strips(poly))
            write_vtp(folder, name, poly)
            write_vtp(folder, name + "-strips", in_strips(poly_data(points, faces, True)))
            write_ply(folder, name, poly)
            write_others(folder, name, poly)
        polygons = faces
        points, faces = bumpy_sphere(9, 14, random)
        write_obj_dialects(folder, points, faces)
        for path in sorted(glob.glob(folder + "/*")):
            apart = "/stars" in path and "strips" not in path and not path.endswith(".stl")
            triangles += compare(path, same_vertices=not path.endswith(".stl") and "dialect" not in path,
                                 faces=polygons if apart else None)
            files += 1
        cut = vtkTriangleFilter()
        cut.SetInputData(poly_data(points, faces))
        cut.Update()
        wanted = np.array(cells_of(cut.GetOutput().GetPolys()))
        compare_off(folder, points, faces, wanted)
        compare_mz3(folder, points, wanted)
        words = compare_numbers(folder, random)
    print(f"{files} files of VTK's and 15 of OFF and MZ3, {triangles} triangles, {words} numbers")


def compare_real():
    paths = [path for ending in READERS for path in sorted(glob.glob(SHARED + "/meshes/**/*" + ending, recursive=True))]
    triangles = sum(compare(path, same_vertices=not path.endswith(".stl")) for path in paths)
    print(f"{len(paths)} real files, {triangles} triangles")
    for path in sorted(glob.glob(SHARED + "/meshes/**/*.mz3", recursive=True)):
        with gzip.open(path) as file:
            data = file.read()
        faces, vertices, skipped = struct.unpack("<III", data[4:16])
        at = 16 + skipped
        triangles = np.frombuffer(data, "<u4", 3 * faces, at).reshape(-1, 3)
        points = np.frombuffer(data, "<f4", 3 * vertices, at + 12 * faces).reshape(-1, 3)
        print(f"{os.path.basename(path)}: {compare(path, (points, triangles))} triangles")
    cube = SHARED + "/meshes/format-zoo/cube.off"
    if os.path.exists(cube):
        compare(cube, by_vtk(SHARED + "/meshes/format-zoo/cube.ply"))


if os.path.isdir(SHARED + "/meshes"):
    compare_real()
else:
    print(f"no real files: {SHARED} is absent")
compare_made()
