# SPDX-License-Identifier: BSD-3-Clause
"""python3 fields.py KIND LIKE OUT MM: a deformation field on the grid of the volume LIKE (NIfTI-1, packed, little-endian,
with an sform along the axes), in which all points go MM to the right: "itk", "spm", "rel" and "abs" (FSL's), and broken
ones. With nothing but Python's own library."""
import array
import gzip
import itertools
import struct
import sys


def main():
    kind, like, out, mm = sys.argv[1:]
    mm = float(mm)
    with gzip.open(like) as file:
        old = file.read(348)
    dim = struct.unpack_from("<3h", old, 42)
    rows = [struct.unpack_from("<4f", old, 280 + 16 * row) for row in range(3)]
    size = [abs(rows[a][a]) for a in range(3)]
    right_handed = rows[0][0] * rows[1][1] * rows[2][2] > 0

    def place(*voxel):
        return [rows[a][a] * voxel[a] + rows[a][3] for a in range(3)]

    def flirt(*voxel):
        x, y, z = voxel
        return [size[0] * (dim[0] - 1 - x if right_handed else x), size[1] * y, size[2] * z]

    side = -1 if right_handed else 1  # of FSL's x, which goes to the left with a right-handed grid...
    side *= 1 if rows[0][0] > 0 else -1  # ... of which x goes to the right
    vectors = {
        "itk": lambda *v: (-mm, 0, 0),
        "nan": lambda *v: (-mm, 0, 0) if any(v) else (float("nan"), 0, 0),
        "metres": lambda *v: (-mm / 1000, 0, 0),
        "spm": lambda *v: (place(*v)[0] + mm, *place(*v)[1:]),
        "unsaid": lambda *v: (place(*v)[0] + mm, *place(*v)[1:]),
        "lps": lambda *v: (-place(*v)[0] - mm, -place(*v)[1], place(*v)[2]),
        "rel": lambda *v: (side * mm, 0, 0),
        "abs": lambda *v: (flirt(*v)[0] + side * mm, *flirt(*v)[1:]),
        "fold": lambda *v: (-mm * (v[0] - dim[0] / 2 if abs(v[0] - dim[0] / 2) < 3 else 0), 0, 0),
    }.get(kind, lambda *v: (-mm, 0, 0))
    head = bytearray(old) + bytes(4)
    four = kind in ("rel", "abs", "spline")
    struct.pack_into("<8h", head, 40, *((4, *dim, 3, 1, 1, 1) if four else (5, *dim, 1, 3, 1, 1)))
    if kind == "two":  # components
        struct.pack_into("<8h", head, 40, 5, *dim, 1, 2, 1, 1)
    code = {"rel": 2006, "abs": 0, "spline": 2007, "dense": 0}.get(kind, 1007)
    struct.pack_into("<h", head, 68, code)
    struct.pack_into("<2h", head, 70, 16, 32)
    struct.pack_into("<3f", head, 108, 352, 1, 0)
    name = {"spm": b"Mapping", "lps": b"Mapping", "reg": b"NREG_TRANS"}.get(kind, b"")
    head[328:344] = name + bytes(16 - len(name))
    nodes = [vectors(i, j, k) for k, j, i in itertools.product(*map(range, reversed(dim)))]
    with gzip.open(out, "wb", compresslevel=1) as file:
        file.write(bytes(head))
        for component in range(3):
            file.write(array.array("f", [node[component] for node in nodes]).tobytes())


main()
