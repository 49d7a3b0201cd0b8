#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Volumes of the Allen atlas's surfaces in cones, pyramids and cylinders (Eq. 10) against a Monte Carlo.

Points are spread at random over the box around a surface. How often the surface winds around each is counted along the
line upwards from it; whether it is in the region is asked as Eq. 10 has it. The mean of the product, times the box, is
the volume. It must be that of conus batch within SIGMAS of its standard error, and no fraction may be above 1.
Every third surface is asked, all of them in scripts/test --long.

usage: compare_solids.py CONUS POSES POINTS SHARED_DATA; exit 77 = skipped."""

import csv
import os
import subprocess
import sys
import tempfile

from compare_query import nibabel  # noqa: F401, or skips
from compare_scenes import brainglobe
from sample import every

import numpy as np

ALLEN = "meshes/brainglobe-allen-ccf2017-subset"
SIGMAS = 4

# options; half the angle, radius, square, range
SHAPES = [(["--angle", "30"], 15.0, 0.0, False, (0.0, np.inf)),
          (["--angle", "60", "--range", "3,6"], 30.0, 0.0, False, (3.0, 6.0)),
          (["--angle", "50", "--aperture", "square"], 25.0, 0.0, True, (0.0, np.inf)),
          (["--radius", "1.5"], 0.0, 1.5, False, (0.0, np.inf)),
          (["--radius", "1.2", "--aperture", "square", "--range", "2,5"], 0.0, 1.2, True, (2.0, 5.0))]


def windings(points, vertices, triangles):
    """How often the surface winds around each point: ways out less ways in, upwards."""
    low, high = vertices[:, :2].min(0), vertices[:, :2].max(0)
    cells = int(np.sqrt(len(points) / 10)) + 1  # along both edges of the grid by which points are found
    cell = np.minimum((points[:, :2] - low) / (high - low) * cells, cells - 1).astype(int)
    order = np.argsort(cell[:, 0] * cells + cell[:, 1], kind="stable")
    first = np.searchsorted((cell[:, 0] * cells + cell[:, 1])[order], np.arange(cells * cells + 1))
    sorted_points, counts = points[order], np.zeros(len(points), int)
    corners = vertices[triangles]
    ends = np.stack([corners[:, :, :2].min(1), corners[:, :, :2].max(1)], 1)
    ends = np.clip((ends - low) / (high - low) * cells, 0, cells - 1).astype(int)
    for (a, b, c), (begin, end) in zip(corners, ends):
        det = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
        for row in range(begin[0], end[0] + 1) if det else ():
            near = slice(first[row * cells + begin[1]], first[row * cells + end[1] + 1])
            x, y, z = sorted_points[near].T
            u = ((x - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (y - a[1])) / det
            v = ((b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1])) / det
            above = (u >= 0) & (v >= 0) & (u + v <= 1) & (a[2] + u * (b[2] - a[2]) + v * (c[2] - a[2]) > z)
            counts[near][above] += 1 if det > 0 else -1
    out = np.empty_like(counts)
    out[order] = counts
    return out


def are_in(points, pose, half, radius, square, depths):
    origin, target = pose
    z = -(target - origin) / np.linalg.norm(target - origin)  # Eq. 2
    x = np.cross((0, 1, 0) if abs(z[2]) > 0.999 else (0, 0, 1), z)
    x /= np.linalg.norm(x)
    right, up, depth = ((points - origin) @ np.stack([x, np.cross(z, x), -z], 1)).T
    reach = radius or np.tan(np.radians(half)) * depth
    beside = np.maximum(abs(right), abs(up)) <= reach if square else right**2 + up**2 <= reach**2
    return (depth >= depths[0]) & (depth <= depths[1]) & beside & (reach >= 0)


def ask(conus, atlas, poses, options):
    """{(number of a pose, label): its row}"""
    with tempfile.TemporaryDirectory() as folder:
        asked, rows = os.path.join(folder, "poses.tsv"), os.path.join(folder, "rows.tsv")
        with open(asked, "w", encoding="utf-8") as file:
            file.write("x\ty\tz\ttx\tty\ttz\n")
            file.writelines("\t".join(map(repr, map(float, (*a, *b)))) + "\n" for a, b in poses)
        subprocess.run([conus, "batch", atlas, "--poses", asked, "--layers", "all", "--quiet", "-o", rows, *options],
                       check=True)
        with open(rows, encoding="utf-8", newline="") as file:
            return {(int(row["query"]), int(row["index"])): row
                    for row in csv.DictReader(file, delimiter="\t") if row["kind"] == "area"}


def main():
    conus, count, points = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    folder = os.path.join(os.environ.get("CONUS_SHARED_DATA", sys.argv[4]), ALLEN)
    if not os.path.isdir(folder):
        print(f"skipped: no {folder}")
        sys.exit(77)
    generator = np.random.default_rng(8)
    areas = [(label, vertices, triangles) for (label, _), vertices, triangles in brainglobe(folder)]
    corners = np.concatenate([vertices for _, vertices, _ in areas])
    areas = every(3, areas)
    asked = []
    for number in range(count):
        target = corners[generator.integers(len(corners))]
        pose = target + generator.normal(size=3) * generator.uniform(1, 4), target
        asked.append((SHAPES[number % len(SHAPES)], pose))
    found = {}
    for shape in SHAPES:
        numbers = [k for k in range(count) if asked[k][0] is shape]
        rows = ask(conus, folder, [asked[k][1] for k in numbers], shape[0]) if numbers else {}
        found.update({(numbers[query - 1], label): row for (query, label), row in rows.items()})
    worst, parts, largest = 0.0, 0, 0.0
    for label, vertices, triangles in areas:
        low, size = vertices.min(0), np.ptp(vertices, 0)
        spread = low + size * generator.random((points, 3))
        a, b, c = (vertices[triangles[:, k]] for k in range(3))
        facing = np.sign(np.einsum("ij,ij->", a, np.cross(b, c)))  # outwards or inwards
        winding = facing * windings(spread, vertices, triangles)
        for number, (shape, pose) in enumerate(asked):
            inside = winding * are_in(spread, pose, *shape[1:])
            wanted = inside.mean() * size.prod()
            error = max(inside.std(), 1 / np.sqrt(points)) * size.prod() / np.sqrt(points)
            row = found.get((number, label))
            got = float(row["volume_mm3"]) if row else 0.0
            off = abs(got - wanted) / error
            assert off <= SIGMAS, (label, number, shape, pose, got, wanted, off)
            assert not row or 0 <= float(row["fraction"]) <= 1, row
            worst, parts = max(worst, off), parts + (row is not None and 0 < float(row["fraction"]) < 1)
            largest = max(largest, float(row["fraction"]) if row else 0.0)
    print(f"{len(areas)} surfaces, {count} poses, {points} points each: {parts} surfaces were cut; "
          f"{worst:.2f} standard errors at most; largest fraction {largest!r}")
    assert parts > count * len(areas) // 20


main()
