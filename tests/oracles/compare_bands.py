#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Bands of values (Eq. 6) of conus against numpy.

Volumes are read with nibabel, scaled, and compared with the bands' ends as float32. The voxels of each band are counted.
Then single rays along the axes of the grid go through random columns of voxels, from either side. Along such a ray the
cells are those of one column: the first hit is the first voxel of the column in a band, the path in a band is its number
of voxels there times their edge.

usage: compare_bands.py CONUS RAYS [SHARED_DATA [TEMPLATE_FOLDER]]; exit 77 = skipped."""

import csv
import io
import json
import os
import random
import subprocess
import sys
import tempfile

try:
    import nibabel
    import numpy as np
except ImportError:
    print("skipped: no python3-nibabel")
    sys.exit(77)

NAMES = ["First", "Second", "Third"]


def run(*words):
    return subprocess.run(words, check=True, capture_output=True, text=True).stdout


def number_of(data, ends):
    """1 to 3 per voxel by its band, 0 where it is in none."""
    number = np.zeros(data.shape, int)
    for n, (low, high) in enumerate(ends, 1):
        inside = np.isfinite(data)
        inside &= data >= np.float32(low) if low is not None else True
        inside &= data < np.float32(high) if high is not None else True
        number[inside] = n
    return number


def random_rays(image, count, seed):
    """Rays from 20 mm before the grid, each through the middles of a column's cells."""
    chance = random.Random(seed)
    matrix, shape = image.affine, image.shape[:3]
    for _ in range(count):
        axis, back = chance.randrange(3), chance.random() < 0.5
        index = [chance.randrange(n) for n in shape]
        step = np.linalg.norm(matrix[:3, axis])
        along = matrix[:3, axis] / step * (-1 if back else 1)
        index[axis] = shape[axis] - 0.5 if back else -0.5
        origin = matrix[:3, :3] @ index + matrix[:3, 3] - 20 * along
        column = [slice(n, n + 1) for n in map(int, index)]
        column[axis] = slice(None, None, -1 if back else 1)
        yield origin, along, step, tuple(column)


def compare(conus, path, ends, count, folder):
    image = nibabel.load(path)
    data = np.asanyarray(image.dataobj).reshape(image.shape[:3]).astype("f4")
    number = number_of(data, ends)
    manifest = os.path.join(folder, "bands.atlas.json")
    entries = [{"name": n, **{k: e for k, e in zip(("low", "high"), pair) if e is not None}} for n, pair in zip(NAMES, ends)]
    with open(manifest, "w", encoding="utf-8") as out:
        volume = {"file": os.path.abspath(path), "bands": entries}
        json.dump({"conus_atlas": 1, "allow_outside": True, "pathways": [volume]}, out)
    objects = json.loads(run(conus, "info", manifest, "--format", "json"))["objects"]
    assert [entry["name"] for entry in objects] == NAMES
    for n, entry in enumerate(objects, 1):
        assert entry["voxels"] == np.count_nonzero(number == n), (path, entry, np.count_nonzero(number == n))
    rays = list(random_rays(image, count, 2010))
    poses = os.path.join(folder, "poses.tsv")
    with open(poses, "w", encoding="utf-8") as out:
        out.write("x\ty\tz\tdx\tdy\tdz\n")
        for origin, along, _, _ in rays:
            out.write("\t".join(repr(float(v)) for v in (*origin, *along)) + "\n")
    options = ["--radius", "0.001", "--resolution", "1", "--layers", "all", "--format", "tsv", "-q"]
    rows = {}
    for row in csv.DictReader(io.StringIO(run(conus, "query", manifest, "--pose", poses, *options)), delimiter="\t"):
        rows[int(row["query"]), row["name"]] = row
    hits = 0
    for query, (_, _, step, column) in enumerate(rays, 1):
        cells = number[column].ravel()
        first = int(np.flatnonzero(cells)[0]) if cells.any() else None
        for n, name in enumerate(NAMES, 1):
            row, voxels = rows.get((query, name)), np.count_nonzero(cells == n)
            assert (float(row["path_mm"]) if row else 0) == 0 or voxels, (path, query, name)
            assert not voxels or abs(float(row["path_mm"]) - voxels * step) < 2e-4, (path, query, name, row, voxels)
            wins = first is not None and cells[first] == n
            assert not voxels or float(row["share"]) == wins, (path, query, name, row)
            if wins:
                assert abs(float(row["distance_mm"]) - (20 + first * step)) < 2e-4, (path, query, name, row)
        hits += first is not None
    assert hits > count / 4, hits
    counts = ", ".join(f"{name} {np.count_nonzero(number == n)}" for n, name in enumerate(NAMES, 1))
    print(f"{os.path.basename(path)}: {counts} voxels; {hits} of {count} rays hit one")


def main():
    conus, count = sys.argv[1], int(sys.argv[2])
    shared = sys.argv[3] if len(sys.argv) > 3 else ""
    templates = sys.argv[4] if len(sys.argv) > 4 else "/usr/share/mricron/templates"
    cases = [
        (os.path.join(templates, "ch2.nii.gz"), [(30, 60), (60, 90), (90, None)]),
        (os.path.join(templates, "ch2.nii.gz"), [(100, 120), (None, 20), (20, 70.5)]),
        (os.path.join(shared, "bonsai", "bonsai.nii.gz"), [(28, 48), (48, 110), (110, None)]),
    ]
    cases = [case for case in cases if os.path.exists(case[0])]
    if not cases:
        print("skipped: no ch2.nii.gz and no bonsai.nii.gz")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        for path, ends in cases:
            compare(conus, path, ends, count, folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
