# SPDX-License-Identifier: BSD-3-Clause
"""Small scalar maps, with nothing but Python's own library."""
import array
import itertools
import struct


def write(path, dim, kind, value, edge=1):
    """A NIfTI-1 file of value(i, j, k); kind is "B" (uint8) or "H" (uint16). Voxels have edges of `edge` mm, and the
    middle of the grid is the origin."""
    head = bytearray(352)
    struct.pack_into("<i", head, 0, 348)
    struct.pack_into("<8h", head, 40, 3, *dim, 1, 1, 1, 1)
    struct.pack_into("<2h", head, 70, {"B": 2, "H": 512}[kind], 8 * array.array(kind).itemsize)
    struct.pack_into("<8f", head, 76, 1, edge, edge, edge, 1, 1, 1, 1)
    struct.pack_into("<2f", head, 108, 352, 1)
    struct.pack_into("<2h", head, 252, 0, 1)
    for row in range(3):
        line = [0.0] * 4
        line[row], line[3] = edge, -edge * (dim[row] - 1) / 2
        struct.pack_into("<4f", head, 280 + 16 * row, *line)
    head[344:348] = b"n+1\0"
    slowest_first = itertools.product(*map(range, reversed(dim)))
    with open(path, "wb") as file:
        file.write(bytes(head) + array.array(kind, [value(i, j, k) for k, j, i in slowest_first]).tobytes())
