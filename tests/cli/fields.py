# SPDX-License-Identifier: BSD-3-Clause
"""python3 fields.py KIND LIKE OUT MM: a deformation field on the grid of the volume LIKE (NIfTI-1, packed, little-endian,
with an sform along the axes), in which all points go MM to the right: "itk", "spm", "rel" and "abs" (FSL's), "mrtrix"
and "ras" (positions and displacements of four dimensions in RAS), and broken ones. With nothing but Python's own library."""
import array
import gzip
import struct
import sys


def along(dim, axis, values):
    """A volume whose values differ along one axis only, i fastest."""
    row = array.array("f", values)
    if axis == 0:
        return row * (dim[1] * dim[2])
    step = dim[0] if axis == 1 else dim[0] * dim[1]
    spread = array.array("f")
    for value in row:
        spread.extend(array.array("f", [value]) * step)
    return spread * (dim[2] if axis == 1 else 1)


def main():
    kind, like, out, mm = sys.argv[1:]
    mm = float(mm)
    with gzip.open(like) as file:
        old = file.read(348)
    dim = struct.unpack_from("<3h", old, 42)
    rows = [struct.unpack_from("<4f", old, 280 + 16 * row) for row in range(3)]
    places = [[rows[a][a] * n + rows[a][3] for n in range(dim[a])] for a in range(3)]
    flirt = [[abs(rows[a][a]) * n for n in range(dim[a])] for a in range(3)]
    right_handed = rows[0][0] * rows[1][1] * rows[2][2] > 0
    if right_handed:
        flirt[0].reverse()
    side = -1 if right_handed else 1  # FSL's x goes to the left in a right-handed grid...
    side *= 1 if rows[0][0] > 0 else -1  # ... whose x goes to the right
    middle = [n - dim[0] / 2 for n in range(dim[0])]
    x = {
        "metres": [-mm / 1000] * dim[0],
        "spm": [p + mm for p in places[0]],
        "unsaid": [p + mm for p in places[0]],
        "mrtrix": [p + mm for p in places[0]],
        "ras": [mm] * dim[0],
        "lps": [-p - mm for p in places[0]],
        "rel": [side * mm] * dim[0],
        "abs": [p + side * mm for p in flirt[0]],
        "fold": [-mm * (n if abs(n) < 3 else 0) for n in middle],
    }.get(kind, [-mm] * dim[0])
    others = {"spm": places, "unsaid": places, "mrtrix": places, "lps": [[], [-p for p in places[1]], places[2]], "abs": flirt}
    y, z = others.get(kind, [[], [0] * dim[1], [0] * dim[2]])[1:]
    vectors = [along(dim, 0, x), along(dim, 1, y), along(dim, 2, z)]
    if kind == "nan":
        vectors[0][0] = float("nan")
    head = bytearray(old) + bytes(4)
    four = kind in ("rel", "abs", "spline", "ras", "mrtrix")
    struct.pack_into("<8h", head, 40, *((4, *dim, 3, 1, 1, 1) if four else (5, *dim, 1, 3, 1, 1)))
    if kind == "two":  # components
        struct.pack_into("<8h", head, 40, 5, *dim, 1, 2, 1, 1)
    code = {"rel": 2006, "abs": 0, "spline": 2007, "ras": 0, "mrtrix": 0}.get(kind, 1007)
    struct.pack_into("<h", head, 68, code)
    struct.pack_into("<f", head, 56, 2 if kind == "reg" else 0)  # NiftyReg's grid of control points
    struct.pack_into("<2h", head, 70, 16, 32)
    struct.pack_into("<3f", head, 108, 352, 1, 0)
    name = {"spm": b"Mapping", "lps": b"Mapping", "reg": b"NREG_TRANS"}.get(kind, b"")
    head[328:344] = name + bytes(16 - len(name))
    with gzip.open(out, "wb", compresslevel=1) as file:
        file.write(bytes(head) + b"".join(v.tobytes() for v in vectors))


main()
