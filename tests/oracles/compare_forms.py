#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The same poses on AAL as a volume and as the surfaces that conus mesh makes of it, pixel by pixel: a cone of one pixel
is one ray, so that a row of answers is a pixel.

Areas agree in 97 % of the pixels that hit one. Where they differ, the pixel lies on a border: within half a voxel's
diagonal beside the ray, the volume shows what the surfaces show. The device is outside of all areas: a voxel around it
is hit at once (Eq. 5), a surface around it is hit from within (Eq. 9). So 2 in 1000 pixels may be elsewhere: those of a
device so close to an area that its surface is around the device already.

usage: compare_forms.py CONUS CONUS_MESH [TEMPLATE_FOLDER]; exit 77 = skipped."""

import csv
import io
import json
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

from compare_query import device_frame
from sample import LONG

POSES = 1000 if LONG else 300
N = 8  # pixels along a cone's edge
BESIDE = 16  # rays around one that differs


def cone_rays(direction, angle):
    """Unit rays of all pixels, row by row (Eq. 3)."""
    x, y, z = device_frame(direction)
    c = ((2 * np.arange(N) + 1) / N - 1) * math.tan(math.radians(angle) / 2)
    rays = np.array([u * x + v * y - z for v in c for u in c])
    return rays / np.linalg.norm(rays, axis=1)[:, None]


def random_rays(labels, affine):
    """Origins and rays of POSES cones, each towards a voxel of an area, from outside of all, 30 to 250 mm away."""
    generator = random.Random(5)
    cells = np.argwhere(labels)
    origins, rays = [], []
    while len(origins) < POSES:
        target = nibabel.affines.apply_affine(affine, cells[generator.randrange(len(cells))])
        way = np.array([generator.gauss(0, 1) for _ in range(3)])
        way /= np.linalg.norm(way)
        origin = target + generator.uniform(30, 250) * way
        voxel = np.rint(nibabel.affines.apply_affine(np.linalg.inv(affine), origin)).astype(int)
        if ((voxel >= 0) & (voxel < labels.shape)).all() and labels[tuple(voxel)]:
            continue
        rays.append(cone_rays(-way, math.exp(generator.uniform(math.log(3), math.log(40)))))
        origins.append(np.repeat(origin[None], N * N, axis=0))
    return np.concatenate(origins), np.concatenate(rays)


def first_hits(conus, atlas, origins, rays, folder):
    """What each ray hits first: label, 0 for nothing."""
    table = os.path.join(folder, "rays.tsv")
    np.savetxt(table, np.hstack([origins, rays]), "%.9f", "\t", header="x\ty\tz\tdx\tdy\tdz", comments="")
    run = subprocess.run([conus, "query", atlas, "--pose", table, "--resolution", "1", "--angle", "0.01", "--engine",
                          "rays", "--format", "tsv", "--quiet"], check=True, capture_output=True, text=True)
    hits = np.zeros(len(rays), np.int64)
    for row in csv.DictReader(io.StringIO(run.stdout), delimiter="\t"):
        if row["kind"] == "area":
            hits[int(row["query"]) - 1] = int(row["index"])
    return hits


def is_beside(conus, volume, origins, rays, wanted, reach, folder):
    """Whether the volume shows what is wanted on a parallel ray, `reach` mm or half that beside."""
    found = np.zeros(len(rays), bool)
    shifted, numbers = [], []
    for i, ray in enumerate(rays):
        x, y, _ = device_frame(ray)
        for k in range(BESIDE):
            turn = 2 * math.pi * k / (BESIDE / 2)
            away = reach * (0.5 if k < BESIDE / 2 else 1)
            shifted.append(origins[i] + away * (math.cos(turn) * x + math.sin(turn) * y))
            numbers.append(i)
    hits = first_hits(conus, volume, np.array(shifted), rays[numbers], folder)
    np.logical_or.at(found, numbers, hits == wanted[numbers])
    return found


def check_pixels(conus, volume, manifest, labels, affine, folder):
    origins, rays = random_rays(labels, affine)
    by_volume = first_hits(conus, volume, origins, rays, folder)
    by_surface = first_hits(conus, manifest, origins, rays, folder)
    hits = (by_volume != 0) | (by_surface != 0)
    differ = np.flatnonzero(by_volume != by_surface)
    agree = 1 - len(differ) / hits.sum()
    reach = np.linalg.norm(affine[:3, :3].sum(axis=1)) / 2
    beside = is_beside(conus, volume, origins[differ], rays[differ], by_surface[differ], reach, folder)
    away = len(differ) - beside.sum()
    print(f"{POSES} poses, {len(rays)} pixels, {hits.sum()} hit an area: {100 * agree:.2f} % agree; of {len(differ)} that "
          f"differ {beside.sum()} lie within {reach:.2f} mm of a border, {away} do not")
    assert hits.mean() > 0.5, "the poses look past the brain"
    assert agree >= 0.97, f"only {100 * agree:.2f} % agree"
    assert away <= 0.002 * hits.sum(), f"{away} pixels differ away from borders"


def main():
    conus, mesh = sys.argv[1:3]
    volume = os.path.join(sys.argv[3] if len(sys.argv) > 3 else "/usr/share/mricron/templates", "aal.nii.gz")
    if not os.path.exists(volume) or not os.path.exists(mesh):
        print("skipped: no mricron-data, or no conus-mesh")
        sys.exit(77)
    image = nibabel.load(volume)
    labels = np.asanyarray(image.dataobj).astype(np.int64)
    with tempfile.TemporaryDirectory() as folder:
        os.environ["CONUS_MESH"] = mesh
        surfaces = os.path.join(folder, "surfaces")
        subprocess.run([conus, "mesh", volume, "-o", surfaces, "--quiet"], check=True)
        manifest = os.path.join(surfaces, "aal.atlas.json")
        with open(manifest, "w", encoding="utf-8") as file:
            json.dump({"conus_atlas": 1, "areas": [{"files": "*.gii"}]}, file)
        check_pixels(conus, volume, manifest, labels, image.affine, folder)


if __name__ == "__main__":
    main()
