#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""conus query against an independent reference, as a user would run it.

The reference reads the labels with nibabel and, per ray, sorts all crossings of cell planes and looks up the cell at the
middle of every interval between them: no traversal, no skipping, nothing shared with conus. Pixels per area must be
equal, distances must agree within 1e-4 mm, shares must sum to 1 within 1e-6. A pixel whose ray touches a cell's edge
within 1e-9 voxel could differ by rounding; none of the fixed poses has one.
Half of the poses are asked, all of them in scripts/test --long.

usage: compare_query.py CONUS POSES_PER_CASE [TEMPLATE_FOLDER]; exit 77 = skipped."""

import csv
import io
import math
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

from sample import LONG

VOLUMES = ["aal", "AICHAmc", "brodmann", "HarvardOxford-cort-maxprob-thr0-1mm", "inia19-NeuroMaps",
           "JHU-WhiteMatter-labels-1mm", "JHU-WhiteMatter-labels-2mm", "jhu189", "natbrainlab"]
RESOLUTIONS = [1, 5, 16, 33, 64]


def device_frame(direction):
    """Eq. 2, written from docs/model.md."""
    d = direction / np.linalg.norm(direction)
    up = np.array([0, 1, 0]) if abs(d[2]) > 0.999 else np.array([0, 0, 1])
    z = -d
    x = np.cross(up, z)
    x /= np.linalg.norm(x)
    return x, np.cross(z, x), z


def cone_rays(direction, angle, n):
    """Unit rays (m, 3) of the pixels with r <= 1, and their weights (Eq. 3, 4)."""
    x, y, z = device_frame(direction)
    c = (2 * np.arange(n) + 1) / n - 1
    u, v = np.meshgrid(c, c)
    inside = u**2 + v**2 <= 1
    u, v = u[inside], v[inside]
    slope = math.tan(math.radians(angle) / 2)
    rays = u[:, None] * slope * x + v[:, None] * slope * y - z
    weights = (1 + slope**2 * (u**2 + v**2)) ** -1.5
    return rays / np.linalg.norm(rays, axis=1)[:, None], weights


def intervals(labels, voxel_from_world, origin, ray, near=0.0, far=math.inf):
    """(labels, entries, exits) of the ray's intervals inside cells with a label, between two distances."""
    nothing = np.zeros(0, int), np.zeros(0), np.zeros(0)
    o = voxel_from_world[:3, :3] @ origin + voxel_from_world[:3, 3]
    d = voxel_from_world[:3, :3] @ ray
    crossings = []
    for axis, size in enumerate(labels.shape):
        if d[axis] == 0:
            if not -0.5 <= o[axis] < size - 0.5:
                return nothing
            continue
        t = (np.arange(size + 1) - 0.5 - o[axis]) / d[axis]
        near, far = max(near, t.min()), min(far, t.max())
        crossings.append(t)
    if near >= far:
        return nothing
    t = np.concatenate(crossings)
    t = np.concatenate([[near], np.sort(t[(t > near) & (t < far)]), [far]])
    cell = np.floor(o[:, None] + d[:, None] * (t[1:] + t[:-1]) / 2 + 0.5).astype(int)
    cell = np.clip(cell, 0, np.array(labels.shape)[:, None] - 1)
    hit = labels[cell[0], cell[1], cell[2]]
    inside = (hit != 0) & (t[1:] > t[:-1])
    return hit[inside], t[:-1][inside], t[1:][inside]


def first_contact(labels, voxel_from_world, origin, ray):
    """(label, t) of the first cell with a label, (0, inf) if none."""
    hit, entries, _ = intervals(labels, voxel_from_world, origin, ray)
    return (int(hit[0]), float(entries[0])) if hit.size else (0, math.inf)


def reference(labels, voxel_from_world, pose, n):
    """{label: [pixels, weight, nearest]} with label 0 for what hit nothing."""
    origin, direction, angle = np.array(pose[0:3]), np.array(pose[3:6]), pose[6]
    result = {}
    for ray, weight in zip(*cone_rays(direction, angle, n)):
        label, t = first_contact(labels, voxel_from_world, origin, ray)
        row = result.setdefault(label, [0, 0.0, math.inf])
        row[0] += 1
        row[1] += weight
        row[2] = min(row[2], t)
    return result


def box_corners(shape, world_from_voxel):
    """[8, 3] corners of a grid's box in mm."""
    corners = np.array([[i, j, k] for i in (0, shape[0]) for j in (0, shape[1]) for k in (0, shape[2])])
    return corners @ world_from_voxel[:3, :3].T + world_from_voxel[:3, 3]


def labelled_volumes(names, folder):
    """(file name, path, labels, voxel_from_world, corners) of those volumes of mricron-data that are there."""
    paths = [os.path.join(folder, name + ".nii.gz") for name in names]
    paths = [path for path in paths if os.path.exists(path)]
    if not paths:
        print("skipped: no mricron-data")
        sys.exit(77)
    for path in paths:
        image = nibabel.load(path)
        labels = np.asanyarray(image.dataobj).reshape(image.shape[:3]).astype(np.int64)
        yield (os.path.basename(path), path, labels, np.linalg.inv(image.affine),
               box_corners(labels.shape, image.affine))


def random_pose(generator, corners):
    """From outside or inside the box of the brain, towards a point in its middle half; half-angles of 0.5 to 45."""
    low, high = corners.min(axis=0), corners.max(axis=0)
    middle, extent = (low + high) / 2, high - low
    target = middle + extent * np.array([generator.uniform(-0.25, 0.25) for _ in range(3)])
    way = np.array([generator.gauss(0, 1) for _ in range(3)])
    way /= np.linalg.norm(way)
    reach = generator.choice([0.1, 0.4, 1.0, 3.0]) * np.linalg.norm(extent)
    origin = target + reach * way
    angle = math.exp(generator.uniform(0, math.log(90)))
    # the used numbers are the printed ones, so that both sides read the same decimals
    return [float("%.6f" % value) for value in [*origin, *(target - origin), angle]]


def query(conus, path, poses, n):
    with tempfile.NamedTemporaryFile("w", suffix=".tsv", delete=False) as table:
        table.write("query_id\tx\ty\tz\tdx\tdy\tdz\tangle\n")
        for i, pose in enumerate(poses):
            table.write("\t".join([str(i)] + [repr(value) for value in pose]) + "\n")
    try:
        out = subprocess.run([conus, "query", path, "--pose", table.name, "--resolution", str(n), "--format", "tsv"],
                             check=True, capture_output=True, text=True).stdout
    finally:
        os.unlink(table.name)
    answers = {}
    for row in csv.DictReader(io.StringIO(out), delimiter="\t"):
        answers.setdefault(int(row["query"]), []).append(row)
    return answers


def check(where, rows, wanted):
    total = sum(row[1] for row in wanted.values())
    got = {0 if row["kind"] == "unassigned" else int(row["index"]): row for row in rows}
    assert abs(sum(float(row["share"]) for row in rows) - 1) < 1e-6, f"{where}: shares do not sum to 1"
    hits = {label for label, row in got.items() if int(row["pixels"])}
    assert hits == set(wanted), f"{where}: areas {sorted(hits)}, reference {sorted(wanted)}"
    for label, (pixels, weight, nearest) in wanted.items():
        row = got[label]
        assert int(row["pixels"]) == pixels, f"{where}: label {label}: {row['pixels']} pixels, reference {pixels}"
        assert abs(float(row["share"]) - weight / total) < 1e-6, f"{where}: label {label}: share"
        if label:
            assert abs(float(row["distance_mm"]) - nearest) < 1e-4, \
                f"{where}: label {label}: {row['distance_mm']} mm, reference {nearest}"


def main():
    conus, count = sys.argv[1], int(sys.argv[2]) // (1 if LONG else 2)
    folder = sys.argv[3] if len(sys.argv) > 3 else "/usr/share/mricron/templates"
    volumes = poses_done = rays_done = 0
    for name, path, labels, voxel_from_world, corners in labelled_volumes(VOLUMES, folder):
        generator = random.Random(name)
        volumes += 1
        for n in RESOLUTIONS:
            few = max(1, count * 16 // max(n, 16) ** 2 * 16) if n > 16 else count
            poses = [random_pose(generator, corners) for _ in range(few)]
            answers = query(conus, path, poses, n)
            for i, pose in enumerate(poses):
                wanted = reference(labels, voxel_from_world, pose, n)
                check(f"{name}, n {n}, pose {pose}", answers[i], wanted)
                rays_done += sum(row[0] for row in wanted.values())
            poses_done += few
    print(f"{volumes} volumes, {poses_done} poses, {rays_done} rays: pixels equal, distances within 1e-4 mm")


if __name__ == "__main__":
    main()
