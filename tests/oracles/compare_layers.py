#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""conus query --layers all against an independent reference (Eq. 10).

As in compare_query.py: labels from nibabel; per ray all crossings of cell planes, sorted, with the label looked up at the middle
of every interval between them. An area is pierced by a ray if it has an interval there; its path is the sum of their
lengths. Pierced pixels must be equal; entries, exits and path lengths within 1e-4 mm. Half of the poses have a range of
depths, a quarter are cylinders.

usage: compare_layers.py CONUS POSES_PER_CASE [TEMPLATE_FOLDER]; exit 77 = skipped."""

import csv
import io
import math
import random
import subprocess
import sys

from compare_query import device_frame, intervals, labelled_volumes, random_pose  # or skips

import numpy as np

VOLUMES = ["aal", "brodmann", "inia19-NeuroMaps", "JHU-WhiteMatter-labels-2mm"]
RESOLUTION = 16


def rays(pose, radius):
    """Origins, unit directions, and mm along each per mm of depth, of the pixels with r <= 1 (Eq. 3)."""
    origin, angle = np.array(pose[0:3]), pose[6]
    x, y, z = device_frame(np.array(pose[3:6]))
    c = (2 * np.arange(RESOLUTION) + 1) / RESOLUTION - 1
    u, v = np.meshgrid(c, c)
    inside = u**2 + v**2 <= 1
    u, v = u[inside][:, None], v[inside][:, None]
    if radius:
        origins = origin + radius * (u * x + v * y)
        return origins, np.broadcast_to(-z, origins.shape), np.ones(len(u))
    slope = math.tan(math.radians(angle) / 2)
    directions = u * slope * x + v * slope * y - z
    lengths = np.linalg.norm(directions, axis=1)
    return np.broadcast_to(origin, directions.shape), directions / lengths[:, None], lengths


def reference(labels, voxel_from_world, pose, radius, depths):
    """{label: [pierced, length, entry, exit]}"""
    result = {}
    for origin, ray, per_depth in zip(*rays(pose, radius)):
        near, far = (depths[0] * per_depth, depths[1] * per_depth) if depths else (0.0, math.inf)
        hit, entries, exits = intervals(labels, voxel_from_world, origin, ray, near, far)
        for label in np.unique(hit):
            mine = hit == label
            row = result.setdefault(int(label), [0, 0.0, math.inf, 0.0])
            row[0] += 1
            row[1] += (exits[mine] - entries[mine]).sum()
            row[2] = min(row[2], entries[mine].min())
            row[3] = max(row[3], exits[mine].max())
    return result


def query(conus, path, pose, radius, depths):
    command = [conus, "query", path, "--quiet", "--resolution", "16", "--origin=" + ",".join(map(repr, pose[:3])),
               "--direction=" + ",".join(map(repr, pose[3:6])), "--layers", "all", "--format", "tsv"]
    command += ["--radius", repr(radius)] if radius else ["--angle", repr(pose[6])]
    command += ["--range", f"{depths[0]!r},{depths[1]!r}"] if depths else []
    out = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    return {int(row["index"]): row for row in csv.DictReader(io.StringIO(out), delimiter="\t")
            if row["kind"] == "area" and int(row["pierced"])}


def check(where, got, wanted):
    assert set(got) == set(wanted), f"{where}: areas {sorted(got)}, reference {sorted(wanted)}"
    for label, (pierced, length, entry, exit_) in wanted.items():
        row = got[label]
        assert int(row["pierced"]) == pierced, f"{where}: label {label}: {row['pierced']}, reference {pierced}"
        for column, value in (("path_mm", length / pierced), ("entry_mm", entry), ("exit_mm", exit_)):
            assert abs(float(row[column]) - value) < 1e-4, f"{where}: label {label}: {column} {row[column]}, reference {value}"


def main():
    conus, count = sys.argv[1], int(sys.argv[2])
    folder = sys.argv[3] if len(sys.argv) > 3 else "/usr/share/mricron/templates"
    volumes = areas = 0
    for name, path, labels, voxel_from_world, corners in labelled_volumes(VOLUMES, folder):
        generator = random.Random("layers " + name)
        volumes += 1
        for i in range(count):
            pose = random_pose(generator, corners)
            radius = round(generator.uniform(0.5, 20), 3) if i % 4 == 3 else 0
            near = round(generator.uniform(0, 100), 3)
            depths = (near, near + round(generator.uniform(1, 100), 3)) if i % 2 else None
            wanted = reference(labels, voxel_from_world, pose, radius, depths)
            check(f"{name}, pose {pose}, radius {radius}, depths {depths}",
                  query(conus, path, pose, radius, depths), wanted)
            areas += len(wanted)
    print(f"{volumes} volumes, {count} poses each, {areas} rows: pierced equal, lengths within 1e-4 mm")


if __name__ == "__main__":
    main()
