#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""tests/growth/growth.py CONUS [--most N] [--only WORD,...] [--check]: what each reader costs against the size of its
input.

For example `tests/growth/growth.py build/quick/apps/cli/conus --most 1000000`: each reader is given files of 1,000,
10,000, ... N things, and twice N at last. One line a size: CPU seconds and peak memory of one process. The
exponents are those between the last two sizes; a cap of the reader ends its row, and is named.

--check makes no table. Each of CHECKS gets CHECKED things and must end within LIMIT_S of processor time, where
quadratic ones take minutes; other processes on the machine do not count. Its memory must not be more than 2.6
times that of half as many: the square would take 4 times, and what malloc doubles or gives back differs by some."""
import argparse
import ctypes
import json
import math
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import zipfile
import zlib

CHECKED, LIMIT_S = 60000, 20
# The parts whose time once grew with the square of their size, or could.
CHECKS = ("rows, TSV", "rows of one name", "parents that are missing", "--only", "depth, TSV",
          "depth, from the root down", "a circle", "tree of a manifest, voxels", "OBJ objects", "GIFTI labels",
          "TRX groups", "parts of a surface", "contacts of a shaft", "diff, rows")
CONE = ["--origin", "0,0,60", "--toward", "0,0,0", "--angle", "5", "--resolution", "16"]
AFFINE = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"


# Files

def write(path, data):
    with open(path, "wb" if isinstance(data, bytes) else "w") as file:
        file.write(data)
    return path


def nifti(path, dim, code, each, data, intent=1002):
    """A NIfTI-1 of voxels of 1 mm from -dim/2 on; intent 1002: labels."""
    head = bytearray(352)
    struct.pack_into("<i", head, 0, 348)
    struct.pack_into("<8h", head, 40, 3, *dim, 1, 1, 1, 1)
    struct.pack_into("<3h", head, 68, intent, code, 8 * each)
    struct.pack_into("<8f", head, 76, *[1.0] * 8)
    struct.pack_into("<2f", head, 108, 352, 1)
    head[123] = 2
    struct.pack_into("<h", head, 254, 1)
    struct.pack_into("<12f", head, 280, 1, 0, 0, -dim[0] // 2, 0, 1, 0, -dim[1] // 2, 0, 0, 1, -dim[2] // 2)
    head[344:348] = b"n+1\0"
    return write(path, bytes(head) + data)


SLABS = struct.pack("<1000h", *[1 + i // 200 for i in range(1000)])


def small(folder):
    """Ten cubed voxels with labels 1 to 5."""
    return nifti(f"{folder}/small.nii", (10, 10, 10), 4, 2, SLABS)


def table(folder, name, text):
    return ["info", small(folder), "--labels", write(f"{folder}/{name}", text)]


def grid(n):
    """Vertices and triangles of a flat sheet of n triangles or one more."""
    wide = max(1, math.isqrt(n // 2))
    tall = -(-n // (2 * wide))
    points = [(x * 0.1, y * 0.1, (x + y) % 2 * 0.01) for y in range(tall + 1) for x in range(wide + 1)]
    corners = []
    for y in range(tall):
        for x in range(wide):
            a = y * (wide + 1) + x
            corners += [(a, a + 1, a + wide + 1), (a + 1, a + wide + 2, a + wide + 1)]
    return points, corners


def lines(rows, form):
    return "".join([form % tuple(row) for row in rows])


def triangle_soup(n):
    """n triangles that share no corner."""
    return [(i % 100, i // 100 % 100, i // 10000) for i in range(n)]


# Labels

def labels(folder, n):
    tall = -(-n // 10000)
    wide = -(-n // tall)
    wide = (min(wide, 100), -(-wide // 100), tall)
    count = wide[0] * wide[1] * wide[2]
    data = b"".join([struct.pack("<I", 1 + i % n) for i in range(count)])
    return ["info", nifti(f"{folder}/v.nii", wide, 768, 4, data)]


def rows_tsv(folder, n):
    return table(folder, "t.tsv", "index\tname\n" + "".join([f"{i}\tn{i}\n" for i in range(1, n + 1)]))


def rows_query(folder, n):
    rows = rows_tsv(folder, n)
    return ["query", *rows[1:], *CONE]


def columns_tsv(folder, n):
    head = "index\tname" + "".join([f"\tc{i}" for i in range(n)])
    return table(folder, "t.tsv", head + "\n1\tA" + "\tx" * n + "\n2\tB" + "\tx" * n + "\n")


def same_names(folder, n):
    return table(folder, "t.tsv", "index\tname\n" + "".join([f"{i}\tname\n" for i in range(1, n + 1)]))


def sides_tsv(folder, n):
    return table(folder, "t.tsv", "index\tname\n" +
                 "".join([f"{i}\t{'Left' if i % 2 else 'Right'}-n{i // 2}\n" for i in range(2, n + 2)]))


def sides_merged(folder, n):
    return ["info", *sides_tsv(folder, n)[1:], "--hemispheres", "merged"]


def twice_tsv(folder, n):
    return table(folder, "t.tsv", "index\tname\n" + "".join([f"{1 + i // 2}\tn{i}\n" for i in range(n)]))


def no_parent(folder, n):
    return table(folder, "t.tsv", "index\tname\tparent_id\n" +
                 "".join([f"{i}\tn{i}\t{i + 2000000}\n" for i in range(1, n + 1)]))


def chain_text(n, last="n/a"):
    return "index\tname\tparent_id\n" + "".join([f"{i}\tn{i}\t{i - 1 if i > 1 else last}\n" for i in range(1, n + 1)])


def chain(folder, n):
    return table(folder, "t.tsv", chain_text(n))


def circle(folder, n):
    return table(folder, "t.tsv", chain_text(n, n))


def chain_down(folder, n):
    return table(folder, "t.tsv", "index\tname\tparent_id\n" +
                 "".join([f"{i}\tn{i}\t{i + 1 if i < n else 'n/a'}\n" for i in range(1, n + 1)]))


def chain_tree(folder, n):
    return [*chain(folder, n), "--format", "tree"]


def chain_json(folder, n):
    return [*chain(folder, n), "--format", "json"]


def chain_query(folder, n):
    return ["query", *chain(folder, n)[1:], *CONE]


def chain_level(folder, n):
    return [*chain_query(folder, n), "--level", str(n // 2)]


def chain_sides(folder, n):
    rows = "".join([f"{i}\t{'Left' if i % 2 else 'Right'}-n{i // 2}\t{i - 2 if i > 3 else 'n/a'}\n"
                    for i in range(2, n + 2)])
    return ["info", *table(folder, "t.tsv", "index\tname\tparent_id\n" + rows)[1:], "--hemispheres", "merged"]


def structures(folder, n):
    nodes = [{"id": i, "name": f"n{i}", "acronym": f"a{i}", "rgb_triplet": [1, 2, 3],
              "structure_id_path": list(range(max(1, i - 3), i + 1))} for i in range(1, n + 1)]
    return table(folder, "structures.json", json.dumps(nodes))


def json_map(folder, n):
    return table(folder, "t.json", json.dumps({str(i): f"n{i}" for i in range(1, n + 1)}))


def json_list(folder, n):
    return table(folder, "t.json", json.dumps([{"label": i, "name": f"n{i}"} for i in range(1, n + 1)]))


def json_properties(folder, n):
    return table(folder, "t.json", json.dumps([{"label": 1, "name": "a", **{f"p{i}": i for i in range(n)}}]))


def json_nesting(folder, n):
    return table(folder, "t.json", "[" * n + "]" * n)


def niivue(folder, n):
    return table(folder, "t.json", json.dumps({"R": [1] * n, "G": [2] * n, "B": [3] * n,
                                               "labels": [f"n{i}" for i in range(n)]}))


def freesurfer_lut(folder, n):
    return table(folder, "t.txt", "".join([f"{i} n{i} 1 2 3 0\n" for i in range(1, n + 1)]))


def itksnap(folder, n):
    return table(folder, "t.txt", "".join([f'{i} 1 2 3 1.00 1 1 "n{i}"\n' for i in range(1, n + 1)]))


def mricron(folder, n):
    return table(folder, "t.txt", "".join([f"{i} n{i} {i + 7}\n" for i in range(1, n + 1)]))


def csv_plain(folder, n):
    return table(folder, "t.csv", "".join([f"{i},n{i},{i + 7}\n" for i in range(1, n + 1)]))


def workbench(folder, n):
    return table(folder, "t.xml", "<LabelTable>" + "".join(
        [f'<Label Key="{i}" Red="1" Green="0" Blue="0" Alpha="1">n{i}</Label>' for i in range(1, n + 1)]) +
        "</LabelTable>")


def afni_table(folder, n):
    return table(folder, "t.niml.lt", f'<VALUE_LABEL_DTABLE ni_type="2*String" ni_dimen="{n}" >\n' +
                 "".join([f'"{i}" "n{i}"\n' for i in range(1, n + 1)]) + "</VALUE_LABEL_DTABLE>\n")


def fsl_xml(folder, n):
    return table(folder, "t.xml", "<atlas><header><name>A</name><type>Label</type></header><data>" + "".join(
        [f'<label index="{i}" x="1" y="1" z="1">n{i}</label>' for i in range(n)]) + "</data></atlas>")


def xml_images(folder, n):
    return table(folder, "t.xml", "<atlas><header><name>A</name><type>Label</type>" + "".join(
        [f"<images><imagefile>/i{i}</imagefile></images>" for i in range(n)]) +
        '</header><data><label index="1" x="1" y="1" z="1">a</label></data></atlas>')


def xml_nesting(folder, n):
    return table(folder, "t.xml", "<atlas>" + "<a>" * n + "</a>" * n + "</atlas>")


def xml_attributes(folder, n):
    return table(folder, "t.xml", "<LabelTable><Label " + "".join([f'a{i}="1" ' for i in range(n)]) +
                 'Key="1">a</Label></LabelTable>')


def folder_of_tables(folder, n):
    volume = small(folder)
    for i in range(n):
        write(f"{folder}/t{i}.tsv", "index\tname\n1\tA\n")
    return ["info", volume]


def only_list(folder, n):
    return [*rows_query(folder, n), "--only", "@" + write(f"{folder}/names.txt",
                                                          "".join([f"n{i}\n" for i in range(1, n + 1)]))]


# Surfaces

def obj(folder, n):
    points, corners = grid(n)
    return ["info", write(f"{folder}/s.obj", lines(points, "v %g %g %g\n") +
                          lines([[i + 1 for i in c] for c in corners], "f %d %d %d\n"))]


def obj_objects(folder, n):
    text = "".join([f"o n{i}\nv {x} {y} {z}\nv {x + 1} {y} {z}\nv {x} {y + 1} {z}\nf -3 -2 -1\n"
                    for i, (x, y, z) in enumerate(triangle_soup(n))])
    return ["info", write(f"{folder}/s.obj", text)]


def ply(folder, n):
    points, corners = grid(n)
    head = (f"ply\nformat ascii 1.0\nelement vertex {len(points)}\nproperty float x\nproperty float y\n"
            f"property float z\nelement face {len(corners)}\nproperty list uchar int vertex_indices\nend_header\n")
    return ["info", write(f"{folder}/s.ply", head + lines(points, "%g %g %g\n") + lines(corners, "3 %d %d %d\n"))]


def ply_properties(folder, n):
    head = ("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n" +
            "".join([f"property float p{i}\n" for i in range(n)]) +
            "element face 1\nproperty list uchar int vertex_indices\nend_header\n")
    more = " 0" * n
    return ["info", write(f"{folder}/s.ply", head + f"0 0 0{more}\n1 0 0{more}\n0 1 0{more}\n3 0 1 2\n")]


def ply_elements(folder, n):
    head = "ply\nformat ascii 1.0\n" + "".join([f"element e{i} 0\nproperty float x\n" for i in range(n)]) + (
        "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
        "property list uchar int vertex_indices\nend_header\n")
    return ["info", write(f"{folder}/s.ply", head + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")]


def ply_polygon(folder, n):
    head = (f"ply\nformat ascii 1.0\nelement vertex {n}\nproperty float x\nproperty float y\n"
            "property float z\nelement face 1\nproperty list int int vertex_indices\nend_header\n")
    ring = [(math.cos(2 * math.pi * i / n), math.sin(2 * math.pi * i / n), 0) for i in range(n)]
    return ["info", write(f"{folder}/s.ply", head + lines(ring, "%g %g %g\n") + f"{n} " +
                          " ".join(map(str, range(n))) + "\n")]


def stl(folder, n):
    one = "facet normal 0 0 1\nouter loop\nvertex %g %g %g\nvertex %g %g %g\nvertex %g %g %g\nendloop\nendfacet\n"
    rows = [(x, y, z, x + 1, y, z, x, y + 1, z) for x, y, z in triangle_soup(n)]
    return ["info", write(f"{folder}/s.stl", "solid a\n" + lines(rows, one) + "endsolid a\n")]


def stl_solids(folder, n):
    one = ("solid a\nfacet normal 0 0 1\nouter loop\nvertex %g %g %g\nvertex %g %g %g\nvertex %g %g %g\nendloop\n"
           "endfacet\nendsolid a\n")
    rows = [(x, y, z, x + 1, y, z, x, y + 1, z) for x, y, z in triangle_soup(n)]
    return ["info", write(f"{folder}/s.stl", lines(rows, one))]


def off(folder, n):
    points, corners = grid(n)
    return ["info", write(f"{folder}/s.off", f"OFF\n{len(points)} {len(corners)} 0\n" + lines(points, "%g %g %g\n") +
                          lines(corners, "3 %d %d %d\n"))]


def vtk(folder, n):
    points, corners = grid(n)
    return ["info", write(f"{folder}/s.vtk", "# vtk DataFile Version 3.0\na\nASCII\nDATASET POLYDATA\n"
                          f"POINTS {len(points)} float\n" + lines(points, "%g %g %g\n") +
                          f"POLYGONS {len(corners)} {4 * len(corners)}\n" + lines(corners, "3 %d %d %d\n"))]


def vtp_text(points, corners, more=""):
    return ('<VTKFile type="PolyData" version="0.1" byte_order="LittleEndian"><PolyData>'
            f'<Piece NumberOfPoints="{len(points)}" NumberOfPolys="{len(corners)}">{more}<Points>'
            '<DataArray type="Float32" NumberOfComponents="3" format="ascii">' + lines(points, "%g %g %g\n") +
            '</DataArray></Points><Polys><DataArray type="Int32" Name="connectivity" format="ascii">' +
            lines(corners, "%d %d %d\n") + '</DataArray><DataArray type="Int32" Name="offsets" format="ascii">' +
            "".join([f"{3 * i + 3} " for i in range(len(corners))]) +
            "</DataArray></Polys></Piece></PolyData></VTKFile>")


def vtp(folder, n):
    return ["info", write(f"{folder}/s.vtp", vtp_text(*grid(n)))]


def vtp_pieces(folder, n):
    whole = vtp_text([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    start, end = whole.index("<Piece"), whole.index("</PolyData>")
    return ["info", write(f"{folder}/s.vtp", whole[:start] + whole[start:end] * n + whole[end:])]


def gifti_text(points, corners, table_text=""):
    def array(intent, kind, dims, text):
        return (f'<DataArray Intent="NIFTI_INTENT_{intent}" DataType="NIFTI_TYPE_{kind}" '
                f'ArrayIndexingOrder="RowMajorOrder" Dimensionality="{len(dims)}" ' +
                " ".join([f'Dim{i}="{d}"' for i, d in enumerate(dims)]) +
                f' Encoding="ASCII" Endian="LittleEndian"><Data>{text}</Data></DataArray>')
    return ('<?xml version="1.0"?><GIFTI Version="1.0">' + table_text +
            array("POINTSET", "FLOAT32", (len(points), 3), lines(points, "%g %g %g\n")) +
            array("TRIANGLE", "INT32", (len(corners), 3), lines(corners, "%d %d %d\n")) + "</GIFTI>")


def gifti(folder, n):
    return ["info", write(f"{folder}/s.gii", gifti_text(*grid(n)))]


def gifti_arrays(folder, n):
    text = gifti_text([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    one = text[text.index("<DataArray"):text.index("</DataArray>") + 12]
    return ["info", write(f"{folder}/s.gii", text.replace("</GIFTI>", one * n + "</GIFTI>"))]


def labelled(folder, n, text):
    """A surface with n vertices, and labels of them."""
    points, corners = grid(2 * n)
    surface = write(f"{folder}/s.surf.gii", gifti_text(points, corners))
    return ["info", surface, "--labels", write(f"{folder}/s.label.gii", text(len(points)))]


def gifti_labels(folder, n):
    def text(count):
        return ('<?xml version="1.0"?><GIFTI Version="1.0"><LabelTable>' +
                "".join([f'<Label Key="{i}">n{i}</Label>' for i in range(count)]) + "</LabelTable>"
                '<DataArray Intent="NIFTI_INTENT_LABEL" DataType="NIFTI_TYPE_INT32" ArrayIndexingOrder="RowMajorOrder" '
                f'Dimensionality="1" Dim0="{count}" Encoding="ASCII" Endian="LittleEndian"><Data>' +
                " ".join(map(str, range(count))) + "</Data></DataArray></GIFTI>")
    return labelled(folder, n, text)


def annot(folder, n):
    points, corners = grid(2 * n)
    count = len(points)
    surface = write(f"{folder}/lh.gii", gifti_text(points, corners))
    data = struct.pack(">i", count) + b"".join([struct.pack(">2i", i, i + 1) for i in range(count)])
    data += struct.pack(">5i", 1, -2, count, 2, 0)[:16] + b"t\0" + struct.pack(">i", count)
    for i in range(count):
        name = b"n%d\0" % i
        c = i + 1
        data += struct.pack(">2i", i, len(name)) + name + struct.pack(">4i", c & 255, c >> 8 & 255, c >> 16, 0)
    return ["info", surface, "--labels", write(f"{folder}/lh.annot", data)]


def freesurfer(folder, n):
    points, corners = grid(n)
    data = b"\xff\xff\xfecreated by a test\n\n" + struct.pack(">2i", len(points), len(corners))
    data += b"".join([struct.pack(">3f", *p) for p in points]) + b"".join([struct.pack(">3i", *c) for c in corners])
    return ["info", write(f"{folder}/lh.pial", data)]


# Streamlines

def with_tracts(folder, name, data):
    return ["info", small(folder), "--streamlines", write(f"{folder}/{name}", data)]


def tck(folder, n):
    head = b"mrtrix tracks\ndatatype: Float32LE\ncount: %d\nfile: . 100\nEND\n" % n
    body = b"".join([struct.pack("<9f", i % 90, i // 90 % 90, 0, i % 90, i // 90 % 90, 1, *[math.nan] * 3)
                     for i in range(n)])
    return with_tracts(folder, "t.tck", head.ljust(100, b" ") + body + struct.pack("<3f", *[math.inf] * 3))


def tck_header(folder, n):
    text = b"mrtrix tracks\n" + b"".join([b"key%d: a\n" % i for i in range(n)]) + b"datatype: Float32LE\n"
    size = len(text) + 40
    return with_tracts(folder, "t.tck", (text + b"file: . %d\nEND\n" % size).ljust(size, b"\n") +
                       struct.pack("<3f", *[math.inf] * 3))


def trk(folder, n):
    head = bytearray(1000)
    head[:6] = b"TRACK\0"
    struct.pack_into("<3h", head, 6, 100, 100, 100)
    struct.pack_into("<3f", head, 12, 1, 1, 1)
    struct.pack_into("<16f", head, 440, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1)
    head[948:951] = b"RAS"
    struct.pack_into("<3i", head, 988, n, 2, 1000)
    return with_tracts(folder, "t.trk", bytes(head) + b"".join(
        [struct.pack("<i6f", 2, i % 90, i // 90 % 90, 0, i % 90, i // 90 % 90, 1) for i in range(n)]))


def trx(folder, n, more=lambda archive: None, packing=zipfile.ZIP_STORED):
    path = f"{folder}/t.trx"
    with zipfile.ZipFile(path, "w", packing) as archive:
        archive.writestr("header.json", json.dumps({"DIMENSIONS": [10, 10, 10], "NB_VERTICES": 2 * n,
                                                    "NB_STREAMLINES": n}))
        archive.writestr("positions.3.float32", b"".join(
            [struct.pack("<6f", i % 90, i // 90 % 90, 0, i % 90, i // 90 % 90, 1) for i in range(n)]))
        archive.writestr("offsets.uint64", b"".join([struct.pack("<Q", 2 * i) for i in range(n + 1)]))
        more(archive)
    return ["info", small(folder), "--streamlines", path]


def groups_of(n, name):
    def add(archive):
        for i in range(n):
            archive.writestr(name % i, bytes(4))
    return add


def trx_groups(folder, n):
    return trx(folder, 1, groups_of(n, "groups/g%d.uint32"))


def trx_groups_query(folder, n):
    return ["query", *trx_groups(folder, n)[1:], *CONE]


def trx_other(folder, n):
    return trx(folder, 1, groups_of(n, "other/g%d.txt"))


def trx_scalars(folder, n):
    return trx(folder, 1, groups_of(n, "dps/g%d.float32"))


def trx_in_groups(folder, n):
    def add(archive):
        archive.writestr("groups/a.uint32", b"".join([struct.pack("<I", n - 1 - i) for i in range(n)]))
    return trx(folder, n, add, zipfile.ZIP_DEFLATED)


def vtk_lines(folder, n):
    points = [p for i in range(n) for p in ((i % 90, i // 90 % 90, 0), (i % 90, i // 90 % 90, 1))]
    return with_tracts(folder, "t.vtk", "# vtk DataFile Version 3.0\na\nASCII\nDATASET POLYDATA\n"
                       f"POINTS {2 * n} float\n" + lines(points, "%g %g %g\n") + f"LINES {n} {3 * n}\n" +
                       "".join([f"2 {2 * i} {2 * i + 1}\n" for i in range(n)]))


def vtk_arrays(folder, n):
    return with_tracts(folder, "t.vtk", "# vtk DataFile Version 3.0\na\nASCII\nDATASET POLYDATA\nPOINTS 2 float\n"
                       f"0 0 0\n1 0 0\nLINES 1 3\n2 0 1\nPOINT_DATA 2\nFIELD f {n}\n" +
                       "".join([f"a{i} 1 2 float\n0 1\n" for i in range(n)]))


def vtp_line_arrays(folder, n):
    arrays = "".join([f'<DataArray type="Float32" Name="a{i}" format="ascii">0 1</DataArray>' for i in range(n)])
    return with_tracts(folder, "t.vtp", '<VTKFile type="PolyData" version="0.1" byte_order="LittleEndian"><PolyData>'
                       f'<Piece NumberOfPoints="2" NumberOfLines="1"><PointData>{arrays}</PointData><Points>'
                       '<DataArray type="Float32" NumberOfComponents="3" format="ascii">0 0 0 1 0 0</DataArray>'
                       '</Points><Lines><DataArray type="Int32" Name="connectivity" format="ascii">0 1</DataArray>'
                       '<DataArray type="Int32" Name="offsets" format="ascii">2</DataArray></Lines></Piece></PolyData>'
                       "</VTKFile>")


def tt(folder, n):
    def variable(name, kind, rows, columns, data):
        name += b"\0"
        return struct.pack("<5i", kind, rows, columns, 0, len(name)) + name + data
    one = struct.pack("<I3i3b", 6, 32, 32, 32, 1, 1, 1)
    data = variable(b"dimension", 20, 1, 3, struct.pack("<3i", 90, 90, 90))
    data += variable(b"trans_to_mni", 10, 4, 4, struct.pack("<16f", 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1))
    data += variable(b"track", 50, 1, n * len(one), one * n)
    return with_tracts(folder, "t.tt", data)


# Manifests

def manifest(folder, **content):
    return ["info", write(f"{folder}/m.atlas.json", json.dumps({"conus_atlas": 1, **content}))]


def manifest_tree(folder, n):
    small(folder)
    tree = [{"label": 1, "parent": 1000}] + [{"label": 999 + i, "parent": 1000 + i, "name": f"t{i}"}
                                             for i in range(1, n)] + [{"label": 999 + n, "name": "root"}]
    return manifest(folder, parcellation="small.nii", tree=tree)


def manifest_tree_surfaces(folder, n):
    write(f"{folder}/s.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    tree = [{"label": 1, "parent": 1000}] + [{"label": 999 + i, "parent": 1000 + i, "name": f"t{i}"}
                                             for i in range(1, n)] + [{"label": 999 + n, "name": "root"}]
    return manifest(folder, areas=[{"file": "s.obj", "label": 1}], tree=tree)


def manifest_areas(folder, n):
    write(f"{folder}/s.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    for i in range(n):
        os.link(f"{folder}/s.obj", f"{folder}/s{i + 1}.obj")
    return manifest(folder, areas=[{"file": f"s{i + 1}.obj", "label": i + 1} for i in range(n)])


def manifest_parts(folder, n):
    gifti_labels(folder, n)
    return manifest(folder, areas=[{"file": "s.surf.gii", "vertex_labels": "s.label.gii"}])


def manifest_pathways(folder, n):
    small(folder)
    nifti(f"{folder}/p.nii", (2, 2, 2), 16, 4, struct.pack("<8f", *[1] * 8), 0)
    return manifest(folder, parcellation="small.nii",
                    pathways=[{"file": "p.nii", "name": f"p{i}", "threshold": 0.5} for i in range(n)])


def manifest_bands(folder, n):
    small(folder)
    nifti(f"{folder}/p.nii", (2, 2, 2), 16, 4, struct.pack("<8f", *range(1, 9)), 0)
    return manifest(folder, parcellation="small.nii", pathways=[
        {"file": "p.nii", "bands": [{"name": f"b{i}", "low": 1 + 7 * i / n, "high": 1 + 7 * (i + 1) / n}
                                    for i in range(n)]}])


def manifest_streamlines(folder, n):
    tck(folder, 1)
    return manifest(folder, parcellation="small.nii",
                    streamlines=[{"file": "t.tck", "name": f"s{i}"} for i in range(n)])


def manifest_parcellations(folder, n):
    small(folder)
    return manifest(folder, parcellations=[{"file": "small.nii", "label_offset": 10 * i} for i in range(n)])


def manifest_context(folder, n):
    small(folder)
    write(f"{folder}/s.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    return manifest(folder, parcellation="small.nii", context=["s.obj"] * n)


def manifest_transforms(folder, n):
    small(folder)
    write(f"{folder}/a.txt", AFFINE)
    return manifest(folder, parcellation="small.nii", transform=["a.txt"] * n)


def manifest_references(folder, n):
    small(folder)
    return manifest(folder, parcellation="small.nii", references=[f"r{i}" for i in range(n)])


def manifest_of_folder(folder, n):
    small(folder)
    for i in range(n):
        write(f"{folder}/s{i + 1}.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    return ["manifest", folder]


def itk_chain(folder, n):
    one = ("Transform: AffineTransform_double_3_3\nParameters: 1 0 0 0 1 0 0 0 1 0 0 0\nFixedParameters: 0 0 0\n")
    text = "#Insight Transform File V1.0\n#Transform 0\nTransform: CompositeTransform_double_3_3\n"
    text += "".join([f"#Transform {i + 1}\n{one}" for i in range(n)])
    return ["info", small(folder), "--atlas-transform", write(f"{folder}/a.tfm", text)]


# Poses

def posed(folder, name, text, *more):
    size = [] if "--radius" in more else ["--angle", "5"]
    return ["query", small(folder), "--pose", write(f"{folder}/{name}", text), *size, "--resolution", "4", "--format",
            "tsv", *more]


def poses_tsv(folder, n):
    return posed(folder, "p.tsv", "x\ty\tz\ttx\tty\ttz\n" + "0\t0\t60\t0\t0\t0\n" * n)


def poses_batch(folder, n):
    text = "x\ty\tz\ttx\tty\ttz\n" + "0\t0\t60\t0\t0\t0\n" * n
    poses = write(f"{folder}/p.tsv", text)
    return ["batch", small(folder), "--poses", poses, "--angle", "5", "--resolution", "4", "-o", f"{folder}/out.tsv"]


def poses_columns(folder, n):
    head = "x\ty\tz\ttx\tty\ttz" + "".join([f"\tc{i}" for i in range(n)])
    return posed(folder, "p.tsv", head + "\n0\t0\t60\t0\t0\t0" + "\t1" * n + "\n")


def poses_bad(folder, n):
    return posed(folder, "p.tsv", "x\ty\tz\ttx\tty\ttz\n" + "0\t0\t60\t0\t0\tx\n" * n)


def poses_names(folder, n):
    return posed(folder, "p.tsv", "id\tx\ty\tz\ttx\tty\ttz\n" + "same\t0\t0\t60\t0\t0\t0\n" * n)


def poses_points(folder, n):
    return posed(folder, "p.txt", "0 0 0 a\n" * n, "--radius", "1")


def poses_markups(folder, n):
    text = json.dumps({"@schema": "markups-schema-v1.0.3.json", "markups": [{
        "type": "Fiducial", "coordinateSystem": "RAS",
        "controlPoints": [{"id": str(i), "label": f"F{i}", "position": [0, 0, 0], "positionStatus": "defined"}
                          for i in range(n)]}]})
    return posed(folder, "p.mrk.json", text, "--radius", "1")


def poses_localite(folder, n):
    one = ('<InstrumentMarker set="true"><Marker description="m"><Matrix4D data00="0" data01="0" data02="1" data03="0" '
           'data10="0" data11="1" data12="0" data13="0" data20="-1" data21="0" data22="0" data23="60" data30="0" '
           'data31="0" data32="0" data33="1"/></Marker></InstrumentMarker>')
    return posed(folder, "p.xml", '<InstrumentMarkerList coordinateSpace="RAS">' + one * n + "</InstrumentMarkerList>")


def poses_electrodes(folder, n):
    rows = "".join([f"A{i + 1}\t0\t0\t{i % 50}\n" for i in range(n)])
    return posed(folder, "sub-1_electrodes.tsv", "name\tx\ty\tz\n" + rows, "--along-shafts", "--radius", "1")


def poses_shafts(folder, n):
    rows = "".join([f"A{i}\t0\t0\t{k}\ts{i}\n" for i in range(n // 2) for k in range(2)])
    return posed(folder, "sub-1_electrodes.tsv", "name\tx\ty\tz\tgroup\n" + rows, "--radius", "1")


def poses_brainsight(folder, n):
    head = ("# Version: 12\n# Coordinate system: NIfTI:Scanner\n# Target Name\tLoc. X\tLoc. Y\tLoc. Z\t"
            "m0n0\tm0n1\tm0n2\tm1n0\tm1n1\tm1n2\tm2n0\tm2n1\tm2n2\n")
    return posed(folder, "p.txt", head + "a\t0\t0\t60\t1\t0\t0\t0\t1\t0\t0\t0\t1\n" * n)


def poses_ibl(folder, n):
    text = json.dumps({**{f"channel_{i}": {"x": 100.0, "y": 100.0, "z": -100.0 - i} for i in range(n)},
                       "origin": {"bregma": [5739, 5400, 332]}})
    small(folder)
    atlas = manifest(folder, ccf="asr", parcellation="small.nii")[1]
    return ["query", atlas, "--pose", write(f"{folder}/channel_locations.json", text), "--space",
            "bregma", "--radius", "1", "--format", "tsv"]


def poses_matrices(folder, n):
    return posed(folder, "p.txt", "1 0 0 0 0 1 0 0 0 0 1 60 0 0 0 1\n" * n, "--poses-format", "simnibs", "--axis", "-z")


def matlab_element(kind, data):
    return struct.pack("<2I", kind, len(data)) + data + bytes(-len(data) % 8)


def matlab_matrix(kind, dims, name, *parts):
    body = (matlab_element(6, struct.pack("<2I", kind, 0)) + matlab_element(5, struct.pack(f"<{len(dims)}i", *dims)) +
            matlab_element(1, name) + b"".join(parts))
    return matlab_element(14, body)


def matlab_numbers(name, dims, values):
    return matlab_matrix(6, dims, name, matlab_element(9, struct.pack(f"<{len(values)}d", *values)))


def matlab_structs(count, names, *fields, name=b"pos"):
    """A row of structures; the names of their fields have 32 bytes each."""
    return matlab_matrix(2, (1, count), name, struct.pack("<HHi", 5, 4, 32), matlab_element(1, names), *fields)


POSE = [1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0, 0, 0, 60, 1]


def matlab_file(folder, *variables):
    return write(f"{folder}/p.mat", b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<H", 0x100) + b"IM" +
                 b"".join(variables))


def posed_matlab(folder, *variables):
    return ["query", small(folder), "--pose", matlab_file(folder, *variables), "--angle", "5", "--resolution", "4",
            "--format", "tsv", "--any-space"]


def matlab_poses(folder, n):
    return posed_matlab(folder, matlab_numbers(b"matsimnibs", (4, 4, n), POSE * n))


def matlab_variables(folder, n):
    return posed_matlab(folder, *[matlab_numbers(b"v%d" % i, (1, 1), [1]) for i in range(n)],
                        matlab_numbers(b"matsimnibs", (4, 4), POSE))


def matlab_struct(folder, n):
    names = b"matsimnibs".ljust(32, b"\0")
    one = matlab_numbers(b"", (4, 4), POSE)
    return posed_matlab(folder, matlab_structs(n, names, one * n))


def matlab_fields(folder, n):
    names = b"".join([(b"f%d" % i).ljust(32, b"\0") for i in range(n - 1)]) + b"matsimnibs".ljust(32, b"\0")
    one = matlab_numbers(b"", (1, 1), [1])
    return posed_matlab(folder, matlab_structs(1, names, one * (n - 1), matlab_numbers(b"", (4, 4), POSE)))


def track(folder, n):
    rows = "".join([f"{i * 0.01:.2f}\t0\t0\t60\t0\t0\t0\n" for i in range(n)])
    poses = write(f"{folder}/p.tsv", "time_s\tx\ty\tz\ttx\tty\ttz\n" + rows)
    return ["track", small(folder), "--poses", poses, "--angle", "5", "--resolution", "4", "-o",
            f"{folder}/t.tsv"]


# Volumes and results

def slabs(folder, name, head):
    return ["info", write(f"{folder}/{name}", head.encode() + SLABS), "--labels-anyway"]


def nrrd_keys(folder, n):
    head = "NRRD0004\n" + "".join([f"key{i}:=value\n" for i in range(n)]) + (
        "type: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 10 10 10\nspace directions: (1,0,0) (0,1,0) "
        "(0,0,1)\nspace origin: (0,0,0)\nendian: little\nencoding: raw\n\n")
    return slabs(folder, "v.nrrd", head)


def nrrd_segments(folder, n):
    head = "NRRD0004\ntype: int\ndimension: 3\nspace: left-posterior-superior\nsizes: 10 10 10\n" + (
        "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\nendian: little\nencoding: raw\n")
    head += "".join([f"Segment{i}_Name:=n{i}\nSegment{i}_LabelValue:={i + 1}\nSegment{i}_Layer:=0\n" for i in range(n)])
    return ["info", write(f"{folder}/v.seg.nrrd", head.encode() + b"\n" +
                          struct.pack("<1000i", *[1 + i // 200 for i in range(1000)]))]


def metaimage_keys(folder, n):
    head = "ObjectType = Image\nNDims = 3\n" + "".join([f"Key{i} = a\n" for i in range(n)]) + (
        "BinaryData = True\nBinaryDataByteOrderMSB = False\nTransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 0 0 0\n"
        "ElementSpacing = 1 1 1\nDimSize = 10 10 10\nElementType = MET_SHORT\nElementDataFile = LOCAL\n")
    return slabs(folder, "v.mha", head)


def nifti_extensions(folder, n):
    path = small(folder)
    data = open(path, "rb").read()
    head = bytearray(data[:352])
    more = struct.pack("<2i8x", 16, 6) * n
    struct.pack_into("<f", head, 108, 352 + len(more))
    head[348] = 1
    return ["info", write(path, bytes(head) + more + data[352:])]


def gzip_members(folder, n):
    data = open(small(folder), "rb").read()
    def member(part):
        pack = zlib.compressobj(9, zlib.DEFLATED, 31)
        return pack.compress(part) + pack.flush()
    return ["info", write(f"{folder}/v.nii.gz", member(data) + member(b"") * n)]


def result_text(n, name="A"):
    return "query\tkind\tindex\tname\tscore\n" + "".join([f"q{i}\tarea\t1\t{name}\t1\n" for i in range(n)])


def diff(folder, n):
    return ["diff", write(f"{folder}/a.tsv", result_text(n)), write(f"{folder}/b.tsv", result_text(n, "B"))]


def diff_columns(folder, n):
    def text(last):
        head = "query\tkind\tindex\tname\tscore" + "".join([f"\tc{i}" for i in range(n)])
        return head + "\nq\tarea\t1\tA\t1" + "\t1" * (n - 1) + f"\t{last}\n"
    return ["diff", write(f"{folder}/a.tsv", text(1)), write(f"{folder}/b.tsv", text(2))]


def diff_same_ids(folder, n):
    text = "query\tkind\tindex\tname\tscore\n" + "".join([f"q\tarea\t{i}\tA{i}\t1\n" for i in range(n)])
    return ["diff", write(f"{folder}/a.tsv", text), write(f"{folder}/b.tsv", text.replace("A5\t", "B5\t"))]


def sidecar(folder, n):
    write(f"{folder}/r.tsv", result_text(1))
    return ["verify", write(f"{folder}/r.json", json.dumps({"GeneratedBy": [{"Name": "conus", "Version": "0.1.0"}],
                                                            "Sources": [{"URI": f"f{i}"} for i in range(n)]}))]


def many_rois(folder, n):
    volume = small(folder)
    return ["overlap", volume, *[volume] * n]


def recon_matlab(folder, n):
    cell = matlab_numbers(b"", (n, 3), [0.0] * (3 * n))
    coords = matlab_matrix(1, (1, 1), b"", cell)
    mni = matlab_structs(1, b"coords_mm".ljust(32, b"\0"), coords, name=b"")
    reco = matlab_file(folder, matlab_structs(1, b"mni".ljust(32, b"\0"), mni, name=b"reco"))
    return ["query", small(folder), "--pose", reco, "--radius", "1", "--any-space", "--format", "tsv"]


# Group, description of what there are many of, and a function that writes files with so many.
CASES = [
    ("labels", "labels of a volume", labels),
    ("labels", "rows, TSV", rows_tsv),
    ("labels", "rows, a question", rows_query),
    ("labels", "columns, TSV", columns_tsv),
    ("labels", "rows of one name", same_names),
    ("labels", "rows of left and right", sides_tsv),
    ("labels", "the same, merged", sides_merged),
    ("labels", "labels named twice", twice_tsv),
    ("labels", "parents that are missing", no_parent),
    ("labels", "FreeSurfer", freesurfer_lut),
    ("labels", "ITK-SNAP", itksnap),
    ("labels", "MRIcron", mricron),
    ("labels", "CSV without a header", csv_plain),
    ("labels", "Workbench", workbench),
    ("labels", "AFNI", afni_table),
    ("labels", "FSL XML", fsl_xml),
    ("labels", "images of an FSL XML", xml_images),
    ("labels", "XML nesting", xml_nesting),
    ("labels", "XML attributes", xml_attributes),
    ("labels", "JSON map", json_map),
    ("labels", "JSON list", json_list),
    ("labels", "JSON properties", json_properties),
    ("labels", "JSON nesting", json_nesting),
    ("labels", "NiiVue", niivue),
    ("labels", "tables in the folder", folder_of_tables),
    ("labels", "--only", only_list),
    ("tree", "depth, TSV", chain),
    ("tree", "depth, from the root down", chain_down),
    ("tree", "depth, tree of info", chain_tree),
    ("tree", "depth, JSON of info", chain_json),
    ("tree", "depth, a question", chain_query),
    ("tree", "depth, --level", chain_level),
    ("tree", "depth of pairs, merged", chain_sides),
    ("tree", "a circle", circle),
    ("tree", "structures.json", structures),
    ("tree", "tree of a manifest, voxels", manifest_tree),
    ("tree", "tree of a manifest, surfaces", manifest_tree_surfaces),
    ("surface", "OBJ triangles", obj),
    ("surface", "OBJ objects", obj_objects),
    ("surface", "PLY triangles", ply),
    ("surface", "PLY properties", ply_properties),
    ("surface", "PLY elements", ply_elements),
    ("surface", "PLY corners of a polygon", ply_polygon),
    ("surface", "STL triangles", stl),
    ("surface", "STL solids", stl_solids),
    ("surface", "OFF triangles", off),
    ("surface", "VTK triangles", vtk),
    ("surface", "VTP triangles", vtp),
    ("surface", "VTP pieces", vtp_pieces),
    ("surface", "GIFTI triangles", gifti),
    ("surface", "GIFTI arrays", gifti_arrays),
    ("surface", "GIFTI labels", gifti_labels),
    ("surface", "annotation labels", annot),
    ("surface", "FreeSurfer triangles", freesurfer),
    ("streamlines", "MRtrix streamlines", tck),
    ("streamlines", "MRtrix keys", tck_header),
    ("streamlines", "TrackVis streamlines", trk),
    ("streamlines", "TRX streamlines", trx),
    ("streamlines", "TRX members of a group", trx_in_groups),
    ("streamlines", "TRX groups", trx_groups),
    ("streamlines", "TRX groups, a question", trx_groups_query),
    ("streamlines", "TRX other files", trx_other),
    ("streamlines", "TRX scalars", trx_scalars),
    ("streamlines", "VTK lines", vtk_lines),
    ("streamlines", "VTK arrays", vtk_arrays),
    ("streamlines", "VTP arrays", vtp_line_arrays),
    ("streamlines", "DSI Studio streamlines", tt),
    ("manifest", "areas", manifest_areas),
    ("manifest", "parts of a surface", manifest_parts),
    ("manifest", "pathways", manifest_pathways),
    ("manifest", "bands", manifest_bands),
    ("manifest", "streamlines", manifest_streamlines),
    ("manifest", "parcellations", manifest_parcellations),
    ("manifest", "surfaces of the context", manifest_context),
    ("manifest", "transforms", manifest_transforms),
    ("manifest", "references", manifest_references),
    ("manifest", "files of a folder", manifest_of_folder),
    ("transform", "ITK, a chain", itk_chain),
    ("poses", "table", poses_tsv),
    ("poses", "table, batch", poses_batch),
    ("poses", "columns", poses_columns),
    ("poses", "bad rows", poses_bad),
    ("poses", "rows of one name", poses_names),
    ("poses", "points", poses_points),
    ("poses", "markups", poses_markups),
    ("poses", "Localite", poses_localite),
    ("poses", "contacts of a shaft", poses_electrodes),
    ("poses", "shafts", poses_shafts),
    ("poses", "Brainsight", poses_brainsight),
    ("poses", "IBL", poses_ibl),
    ("poses", "SimNIBS, text", poses_matrices),
    ("poses", "MATLAB, one variable", matlab_poses),
    ("poses", "MATLAB, structures", matlab_struct),
    ("poses", "MATLAB, fields", matlab_fields),
    ("poses", "MATLAB, variables", matlab_variables),
    ("poses", "Lead-DBS", recon_matlab),
    ("poses", "track", track),
    ("volume", "NRRD keys", nrrd_keys),
    ("volume", "NRRD segments", nrrd_segments),
    ("volume", "MetaImage keys", metaimage_keys),
    ("volume", "NIfTI extensions", nifti_extensions),
    ("volume", "gzip members", gzip_members),
    ("results", "diff, rows", diff),
    ("results", "diff, columns", diff_columns),
    ("results", "diff, rows of one pose", diff_same_ids),
    ("results", "sources of a sidecar", sidecar),
    ("results", "ROIs", many_rois),
]


# Measuring

def run(conus, case, n, limit_s):
    """CPU seconds, peak bytes, the exit code and the message of one process; None where the limit ended it."""
    folder = tempfile.mkdtemp(prefix="growth-")
    try:
        arguments = [conus, *case(folder, n)]
        with open(f"{folder}/.err", "w+") as err, open(f"{folder}/.out", "w") as out:
            # A shell starts it as a child and ends at once, so that the child becomes ours: a fork of this process
            # would count this one's peak memory as its own.
            script = f'ulimit -t {limit_s}; "$@" & echo $! >"{folder}/.pid"'
            subprocess.run(["/bin/sh", "-c", script, "sh", *arguments], stdin=subprocess.DEVNULL, stdout=out, stderr=err, check=True)
            with open(f"{folder}/.pid", encoding="utf-8") as file:
                _, status, usage = os.wait4(int(file.read()), 0)
            err.seek(0)
            said = err.read(100000).strip().split("\n")
    finally:
        shutil.rmtree(folder)
    if os.WIFSIGNALED(status):
        return None, usage.ru_maxrss * 1024, -os.WTERMSIG(status), "killed"
    code = os.WEXITSTATUS(status)
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024, code, said[-1][-120:] if code else ""


def exponent(a, b, floor, ratio):
    """What `b` beyond `floor` is of `a`, as a power of the ratio of sizes."""
    return math.log((b - floor) / max(a - floor, floor / 100), ratio) if b > 1.3 * floor else 0.0


def wanted(cases, only):
    words = [w for w in (only or "").split(",") if w]
    return [c for c in cases if not words or any(w in f"{c[0]} {c[1]} {c[2].__name__}" for w in words)]


def make_table(conus, cases, most, limit_s):
    print(f"{'':12} {'':32} {'size':>9} {'CPU s':>9} {'MB':>9}")
    for group, name, case in cases:
        rows, n = [], 1000
        while n <= 2 * most:
            cpu, memory, code, message = run(conus, case, n, limit_s)
            rows.append((n, cpu, memory))
            print(f"{group:12} {name:32} {n:9} {cpu if cpu is None else round(cpu, 3)!s:>9} {memory / 1e6:9.1f}"
                  f"{'' if code == 0 else f'  {code} {message}'}", flush=True)
            if code not in (0, 1):
                break
            n = 10 * n if n < most else 2 * n
        if len(rows) > 1 and rows[-1][1] is not None:
            a, b = rows[-2], rows[-1]
            print(f"{group:12} {name:32} exponents {exponent(a[1], b[1], rows[0][1] * 0.5, b[0] / a[0]):.2f} "
                  f"{exponent(a[2], b[2], rows[0][2], b[0] / a[0]):.2f}", flush=True)


def check(conus, cases):
    failed = 0
    for group, name, case in cases:
        if name not in CHECKS:
            continue
        half = run(conus, case, CHECKED // 2, LIMIT_S)
        whole = run(conus, case, CHECKED, LIMIT_S)
        slow = whole[0] is None or half[0] is None
        large = not slow and whole[1] > 2.6 * half[1]
        broken = not slow and any(r[2] not in (0, 1, 3) or (r[2] == 3 and not r[3]) for r in (half, whole))
        if slow or large or broken:
            failed += 1
            print(f"{group}, {name}: {CHECKED // 2}: {half}, {CHECKED}: {whole}")
    return failed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("conus")
    parser.add_argument("--most", type=int, default=100000)
    parser.add_argument("--only")
    parser.add_argument("--limit", type=int, default=60, help="CPU seconds of one process")
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    cases = wanted(CASES, options.only)
    ctypes.CDLL(None).prctl(36, 1)  # PR_SET_CHILD_SUBREAPER
    if options.check:
        return 1 if check(options.conus, cases) else 0
    make_table(options.conus, cases, options.most, options.limit)
    return 0


if __name__ == "__main__":
    sys.exit(main())
