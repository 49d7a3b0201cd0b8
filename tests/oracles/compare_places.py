#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The inner point of every area of real atlases against scipy.

The depth of a voxel is scipy's distance transform of the area's voxels, padded by a voxel of background, by the voxels'
edges. Of the deepest (to 1e-9 mm) the nearest to the area's centroid is wanted, then the lowest index, x fastest. An
area whose name has no side, with 20 % or more of its voxels on each side of x = 0, is to be refused, unless its point
is nearer to x = 0 than half its depth in an atlas some of whose areas have a side. A sample of these is asked, all with
CONUS_TEST_LONG.

usage: compare_places.py CONUS ATLAS...; those that are not there are skipped, and 77 means that all are."""

import csv
import io
import json
import os
import re
import subprocess
import sys
import time

from compare_query import nibabel  # or skips

import numpy as np

try:
    from scipy.ndimage import distance_transform_edt, find_objects
except ImportError:
    print("no scipy")
    sys.exit(77)

SIDE = re.compile(r"(?<![A-Za-z0-9])([LR]|left|right|Left|Right|LEFT|RIGHT|lh|rh|LH|RH)(?![A-Za-z0-9])|"
                  r"^[lr](?![A-Za-z0-9])|(?<![A-Za-z0-9])[lr]$")


def areas_of(conus, atlas):
    """{label: name} of the areas that have voxels."""
    text = subprocess.run([conus, "info", atlas, "--format", "tsv"], check=True, capture_output=True, text=True).stdout
    rows = csv.DictReader(io.StringIO(text), delimiter="\t", quoting=csv.QUOTE_NONE)
    return {int(row["index"]): row["name"] for row in rows if row["kind"] == "area" and int(row["voxels"])}


def inner_points(path, areas):
    """{label: (point, depth, refused)}"""
    image = nibabel.load(path)
    labels = np.asarray(image.dataobj).squeeze().round().astype(np.int64)
    matrix = image.affine
    edges = np.linalg.norm(matrix[:3, :3], axis=0)
    axes = matrix[:3, :3] / edges
    assert np.allclose(axes.T @ axes, np.eye(3), atol=1e-6), "the axes are not perpendicular"
    names = set(areas.values())
    swap = {"L": "R", "left": "right", "Left": "Right", "LEFT": "RIGHT", "lh": "rh", "LH": "RH", "l": "r"}
    swap.update({b: a for a, b in swap.items()})

    def has_side(name):
        """A word of several letters, or one letter whose opposite makes the name of another area."""
        for found in SIDE.finditer(name):
            word = found[0]
            if len(word) > 1 or name[:found.start()] + swap[word] + name[found.end():] in names:
                return True
        return False

    any_side = any(map(has_side, names))
    codes, dense = np.unique(labels, return_inverse=True)
    boxes = find_objects(dense.reshape(labels.shape))
    found = {}
    for label, name in areas.items():
        code = np.searchsorted(codes, label)
        box = boxes[code - 1]
        first = np.array([s.start for s in box])
        inside = labels[box] == label
        depth = distance_transform_edt(np.pad(inside, 1), sampling=edges)[1:-1, 1:-1, 1:-1]
        voxels = np.argwhere(inside.T)[:, ::-1]  # in the order of the file
        depths = depth[tuple(voxels.T)]
        world = (voxels + first) @ matrix[:3, :3].T + matrix[:3, 3]
        equal = np.flatnonzero(depths >= depths.max() - 1e-9)
        off = np.linalg.norm(world[equal] - world.mean(0), axis=1)
        chosen = equal[np.flatnonzero(off <= off.min() + 1e-9)[0]]
        left = (world[:, 0] < 0).mean()
        is_middle = any_side and abs(world[chosen, 0]) < depths.max() / 2
        refused = not has_side(name) and min(left, 1 - left) >= 0.2 and not is_middle
        found[label] = world[chosen], depths.max(), refused
    return found


def ask(conus, atlas, labels):
    command = [conus, "query", atlas, "--format", "json", "-q", "--radius", "0.001"]
    for label in labels:
        command += ["--point", f"index:{label}"]
    return subprocess.run(command, capture_output=True, text=True)


def compare(conus, atlas):
    areas = areas_of(conus, atlas)
    wanted = inner_points(atlas, areas)
    fine = [label for label in wanted if not wanted[label][2]]
    started = time.monotonic()
    places = []
    for first in range(0, len(fine), 200):
        answer = ask(conus, atlas, fine[first:first + 200])
        assert answer.returncode == 0, answer.stderr
        places += json.loads(answer.stdout)["Places"]
    seconds = time.monotonic() - started
    bad = 0
    for label, place in zip(fine, places, strict=True):
        point, depth, _ = wanted[label]
        if np.abs(point - place["at"]).max() > 1e-6 or abs(depth - place["inside_mm"]) > 1e-6 or \
                place["name"] != areas[label]:
            print(f"{atlas}: {areas[label]}: {place['at']}, {place['inside_mm']}, wanted {point}, {depth}")
            bad += 1
    refused = [label for label in wanted if wanted[label][2]]
    every = 1 if "CONUS_TEST_LONG" in os.environ else 1 + len(refused) // 8
    for label in refused[::every]:
        answer = ask(conus, atlas, [label])
        if answer.returncode != 2 or "lies on both sides" not in answer.stderr:
            print(f"{atlas}: {areas[label]}: is not refused: {answer.stderr}")
            bad += 1
    names = ", ".join(areas[label] for label in refused[:4])
    print(f"{os.path.basename(atlas)}: {len(fine)} points, {len(refused)} of both sides refused"
          f"{' (' + names + (', ...' if len(refused) > 4 else '') + ')' if refused else ''}; {seconds:.1f} s")
    return bad


def main():
    conus, atlases = sys.argv[1], sys.argv[2:]
    there = [atlas for atlas in atlases if os.path.exists(atlas)]
    if not there:
        print("none of the atlases is here")
        sys.exit(77)
    sys.exit(1 if sum(compare(conus, atlas) for atlas in there) else 0)


if __name__ == "__main__":
    main()
