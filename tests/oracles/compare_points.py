#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""conus query --point without --radius against numpy: random points in and around a labelled volume.

The area at a point is the label of its voxel. The distance of an area is the least one of all boxes of its voxels,
each measured. The radius begins at a twentieth of the diagonal of the box around all areas, rounded down to 1, 2 or 5
times a power of ten, and doubles until an area is in it that is not at the point; every area within has a row.

usage: compare_points.py CONUS ATLAS COUNT; exit 77 = skipped."""

import csv
import io
import math
import os
import subprocess
import sys

from compare_query import nibabel  # or skips

import numpy as np


def round_number(length):
    unit = 10.0 ** math.floor(math.log10(length))
    return max(factor * unit for factor in (1, 2, 5) if factor * unit <= length)


def main():
    program, path, count = sys.argv[1], sys.argv[2], int(sys.argv[3])
    if not os.path.exists(path):
        print("no", path)
        sys.exit(77)
    image = nibabel.load(path)
    labels, matrix = np.asarray(image.dataobj), image.affine
    voxels = np.argwhere(labels)
    of = labels[tuple(voxels.T)]
    spacing = np.linalg.norm(matrix[:3, :3], axis=0)
    axes = matrix[:3, :3] / spacing
    assert np.allclose(axes.T @ axes, np.eye(3), atol=1e-6)  # so that a cell is a box in these axes
    corners = (np.array([voxels.min(0), voxels.max(0)]) + [[-0.5], [0.5]]) * spacing
    first = round_number(np.linalg.norm(corners[1] - corners[0]) / 20)
    names = sorted(set(of))
    random = np.random.default_rng(5)
    size = np.array(labels.shape)
    for number in range(count):
        at = random.uniform(-0.3 * size, 1.3 * size)  # some are outside of the grid
        point = matrix[:3, :3] @ at + matrix[:3, 3]
        text = ",".join(f"{x:.6f}" for x in point)
        at = np.linalg.solve(matrix[:3, :3], np.array([float(x) for x in text.split(",")]) - matrix[:3, 3])
        distance = np.linalg.norm(np.maximum(np.abs(voxels - at) - 0.5, 0) * spacing, axis=1)
        wanted = {label: distance[of == label].min() for label in names}
        cell = np.floor(at + 0.5).astype(int)
        here = labels[tuple(cell)] if (cell >= 0).all() and (cell < size).all() else 0
        assert [label for label in names if wanted[label] == 0] == ([here] if here else [])
        nearest = min(wanted.values())
        wanted = {label: d for label, d in wanted.items() if d <= nearest + 1e-9}
        out = subprocess.run([program, "query", path, f"--point={text}", "--format", "tsv", "--quiet"], check=True,
                             capture_output=True, text=True).stdout
        rows = [row for row in csv.DictReader(io.StringIO(out), delimiter="\t", quoting=csv.QUOTE_NONE)
                if row["kind"] == "area"]
        found = {int(row["index"]): float(row["distance_mm"]) for row in rows}
        assert found.keys() == wanted.keys(), (text, found, wanted)
        worst = max(abs(found[label] - wanted[label]) for label in found)
        assert worst < 1e-5, (text, worst)  # nine digits, and an affine of floats
        assert list(found.values()) == sorted(found.values()), text
    print(count, "points: the areas at them, or else nearest to them, and distances are the same")


main()
