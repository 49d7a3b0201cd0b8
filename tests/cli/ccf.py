#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""ccf.py: a made-up annotation on the Allen CCF's grid, in the forms in which that comes, with Python's own library.

The array is 66 x 40 x 57 voxels of 200 micrometres: AP from anterior, DV from superior, ML as the Allen Institute
counts, from the left. Written here: allen.nrrd, with the header of the Allen Institute; ras.nii, turned to RAS, with
another origin; globe/, as BrainGlobe has it; points.txt and expected.txt: positions in CCF and the labels there;
bregma.txt: the same positions in mm from bregma.
"""
import array
import itertools
import json
import pathlib
import struct

SHAPE = 66, 40, 57
BREGMA = 5400, 332, 5739  # AP, DV, ML


def label(i, j, k):
    """Blocks of 6 x 8 x 19 voxels, each with a label of its own, so that no axis can be mistaken for another."""
    return 1 + i // 6 + 11 * (j // 8) + 55 * (k // 19)


def write_nrrd(path):
    head = """NRRD0004
type: unsigned short
dimension: 3
space: left-posterior-superior
sizes: 66 40 57
space directions: (200,0,0) (0,200,0) (0,0,200)
kinds: domain domain domain
endian: little
encoding: raw
space origin: (0,0,0)

"""
    voxels = array.array("H", [label(i, j, k) for k, j, i in itertools.product(*map(range, reversed(SHAPE)))])
    pathlib.Path(path).write_bytes(head.encode() + voxels.tobytes())


def write_nifti(path):
    """x = ML - 5.7, y = 5 - AP, z = 1 - DV mm: i is k of the array, j and k count i and j backward."""
    head = bytearray(352)
    struct.pack_into("<i", head, 0, 348)
    struct.pack_into("<8h", head, 40, 3, 57, 66, 40, 1, 1, 1, 1)
    struct.pack_into("<2h", head, 70, 512, 16)
    struct.pack_into("<8f", head, 76, 1, 0.2, 0.2, 0.2, 1, 1, 1, 1)
    struct.pack_into("<2f", head, 108, 352, 1)
    struct.pack_into("<2h", head, 252, 0, 1)
    for row, first in enumerate((-5.7 + 0.1, 5 - 13.2 + 0.1, 1 - 8 + 0.1)):
        line = [0.0] * 4
        line[row], line[3] = 0.2, first
        struct.pack_into("<4f", head, 280 + 16 * row, *line)
    head[344:348] = b"n+1\0"
    voxels = [label(65 - b, 39 - c, a) for c in range(40) for b in range(66) for a in range(57)]
    pathlib.Path(path).write_bytes(bytes(head) + array.array("H", voxels).tobytes())


def write_tiff(path):
    """Pages along AP, rows along DV, columns along ML; each page is one strip, and its directory follows it."""
    pages, rows, columns = SHAPE
    size = 2 * rows * columns
    data = bytearray(b"II*\0" + struct.pack("<I", 8 + size))
    for i in range(pages):
        start = len(data)
        data += array.array("H", [label(i, j, k) for j in range(rows) for k in range(columns)]).tobytes()
        tags = ((256, columns), (257, rows), (258, 16), (259, 1), (262, 1), (273, start), (277, 1), (278, rows),
                (279, size))
        data += struct.pack("<H", len(tags)) + b"".join(struct.pack("<HHII", tag, 4, 1, value) for tag, value in tags)
        data += struct.pack("<I", len(data) + 4 + size if i + 1 < pages else 0)
    path.write_bytes(bytes(data))


def write_globe(folder):
    folder.mkdir()
    write_tiff(folder / "annotation.tiff")
    names = [{"id": n, "acronym": f"A{n}", "name": f"area {n}", "structure_id_path": [n],
              "rgb_triplet": [n % 256, 9, 9]} for n in range(1, 166)]
    (folder / "structures.json").write_text(json.dumps(names))
    (folder / "metadata.json").write_text(json.dumps(
        {"name": "allen_mouse", "orientation": "asr", "resolution": [200.0] * 3, "shape": SHAPE}))


def main():
    write_nrrd("allen.nrrd")
    write_nifti("ras.nii")
    write_globe(pathlib.Path("globe"))
    points = [(5433, 341, 5761), (30, 40, 50), (13170, 7960, 11350), (8230, 4444, 2020), (1550, 1650, 3750),
              (9990, 6410, 9630)]
    labels = [label(*(um // 200 for um in point)) for point in points]
    mm = [((BREGMA[0] - ap) / 1000, (ml - BREGMA[2]) / 1000, (BREGMA[1] - dv) / 1000) for ap, dv, ml in points]
    for name, rows in (("points.txt", points), ("bregma.txt", mm), ("expected.txt", [(n,) for n in labels])):
        pathlib.Path(name).write_text("".join(" ".join(map(str, row)) + "\n" for row in rows))


main()
