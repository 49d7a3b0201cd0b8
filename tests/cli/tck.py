# SPDX-License-Identifier: BSD-3-Clause
"""tck.py FILE [X,Y,Z ...] [-- X,Y,Z ...]...: an MRtrix tractogram of these streamlines, in mm."""
import struct
import sys

path, *words = sys.argv[1:]
streamlines = " ".join(words).split("--")
numbers = b"".join(
    b"".join(struct.pack("<3f", *map(float, point.split(","))) for point in line.split())
    + struct.pack("<3f", *3 * [float("nan")]) for line in streamlines if line.split()
) + struct.pack("<3f", *3 * [float("inf")])
head = "mrtrix tracks\ndatatype: Float32LE\ncount: %d\nfile: . 80\nEND\n" % sum(1 for line in streamlines if line.split())
with open(path, "wb") as file:
    file.write(head.encode().ljust(80, b"\0") + numbers)
