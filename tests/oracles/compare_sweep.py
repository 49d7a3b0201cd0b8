#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""`conus sweep` on AAL against numpy: the angle of every voxel's centre, and its least per area (Eq. 13).

usage: compare_sweep.py CONUS; exit 77 = skipped."""
import csv
import io
import os
import subprocess
import sys

ATLAS = "/usr/share/mricron/templates/aal.nii.gz"
POSES = [((-90, 20, 20), (0, -10, 10), 179, None), ((0, 0, 0), (10, 30, -5), 40, None),
         ((100, -120, 80), (0, 0, 0), 60, (120, 190))]

try:
    import nibabel
    import numpy as np
except ImportError:
    print("skipped: no python3-nibabel")
    sys.exit(77)
if not os.path.exists(ATLAS):
    print("skipped: no mricron-data")
    sys.exit(77)


def sweep(conus, origin, toward, angle, depths):
    command = [conus, "sweep", ATLAS, "--origin=%g,%g,%g" % origin, "--toward=%g,%g,%g" % toward, "--angle", str(angle),
               "--format", "tsv"] + (["--range", "%g,%g" % depths] if depths else [])
    text = subprocess.run(command, check=True, stdout=subprocess.PIPE, universal_newlines=True).stdout
    return {int(row["index"]): row for row in csv.DictReader(io.StringIO(text), delimiter="\t")}


def main():
    image = nibabel.load(ATLAS)
    labels = np.asarray(image.dataobj).reshape(-1, order="F")
    at = np.stack(np.unravel_index(np.flatnonzero(labels), image.shape[:3], order="F"), 1)
    labels = labels[labels != 0]
    world = at @ image.affine[:3, :3].T + image.affine[:3, 3]
    compared = 0
    for origin, toward, angle, depths in POSES:
        rows = sweep(sys.argv[1], origin, toward, angle, depths)
        axis = np.subtract(toward, origin) / np.linalg.norm(np.subtract(toward, origin))
        away = world - origin
        depth = away @ axis
        across = np.linalg.norm(np.cross(away, axis), axis=1)
        opening = np.degrees(2 * np.arctan2(across, depth))
        low, high = depths or (0, np.inf)
        opening[(depth < low) | (depth > high)] = np.inf
        least = {label: opening[labels == label].min() for label in np.unique(labels)}
        assert {label for label, value in least.items() if value <= angle} == set(rows), (origin, toward)
        for label, row in rows.items():
            assert abs(float(row["angle_deg"]) - least[label]) < 1e-6, (label, row, least[label])
            compared += 1
        order = sorted(least.values())
        for place, row in enumerate(rows.values()):
            margin = order[place + 1] - order[place] if place + 1 < len(order) else np.inf
            assert row["margin_deg"] == "n/a" if np.isinf(margin) else abs(float(row["margin_deg"]) - margin) < 1e-6
    print(f"{compared} areas in {len(POSES)} cones as numpy has them")


if __name__ == "__main__":
    main()
