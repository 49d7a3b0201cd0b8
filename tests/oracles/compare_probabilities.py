#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Probabilistic atlases in the layout of FSL, against nibabel and numpy.

The atlas is made of areas of Debian's AAL at 2 mm: a voxel's probability to be an area is the percentage of the 5 x 5 x 5
voxels around it that are. So areas overlap, and one below 25 % everywhere is among them. conus gets ATLAS.xml and the 4-D
image beside it. Of every area: voxels from 25 % on in the whole volume; voxels, mean and largest probability in random
cones, cylinders and balls (the predicate of compare_census.py); pixels that hit it first, as the nearest entry of all
areas' intervals along each ray (those of compare_query.py). The value at a contact is that of the voxel whose cell
holds the point 1 micrometre behind it, also by slices.

usage: compare_probabilities.py CONUS REGIONS [TEMPLATE_FOLDER]; exit 77 = skipped."""

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

from compare_census import inside, random_region
from compare_query import box_corners, cone_rays, intervals

LABELS = [1, 2, 3, 4, 29, 30, 37, 38, 79, 80]
WIDTH = 5


def percentages(mask):
    """Of the WIDTH^3 voxels around each that are in the mask, rounded as they are stored."""
    sums = np.pad(mask.astype(np.int32), WIDTH // 2)
    for axis in range(3):
        total = np.cumsum(np.insert(sums, 0, 0, axis=axis), axis=axis)
        size = mask.shape[axis]
        sums = np.take(total, range(WIDTH, WIDTH + size), axis) - np.take(total, range(size), axis)
    return (100 * sums // WIDTH**3).astype(np.uint8)


class Maps:
    """What compare_census.inside() wants to know of a volume, and the probabilities."""

    def __init__(self, image):
        self.m = image.affine
        self.data = np.asanyarray(image.dataobj)
        self.members = [self.data[..., k] >= 25 for k in range(self.data.shape[3])]
        i, j, k = np.ogrid[: self.data.shape[0], : self.data.shape[1], : self.data.shape[2]]
        self.p = [self.m[a, 0] * i + self.m[a, 1] * j + self.m[a, 2] * k + self.m[a, 3] for a in range(3)]


def write_atlas(folder, aal):
    labels = np.asanyarray(aal.dataobj)[::2, ::2, ::2]
    affine = aal.affine @ np.diag([2, 2, 2, 1])
    maps = np.stack([percentages(labels == label) for label in LABELS] + [percentages(labels == 1) // 5], axis=3)
    os.mkdir(os.path.join(folder, "AAL"))
    nibabel.save(nibabel.Nifti1Image(maps, affine), os.path.join(folder, "AAL/AAL-prob-2mm.nii.gz"))
    names = "".join(f'<label index="{i}" x="0" y="0" z="0">area {i + 1}</label>' for i in range(maps.shape[3]))
    path = os.path.join(folder, "AAL.xml")
    with open(path, "w") as out:
        out.write("<atlas version='1.0'><header><name>AAL</name><type>Probabilistic</type><images>"
                  "<imagefile>/AAL/AAL-prob-2mm</imagefile><summaryimagefile>/AAL/none</summaryimagefile></images>"
                  f"</header><data>{names}</data></atlas>")
    return path, Maps(nibabel.load(os.path.join(folder, "AAL/AAL-prob-2mm.nii.gz")))


def query(conus, path, region, how=("--layers", "all")):
    numbers = lambda values: ",".join(map(repr, values))
    command = [conus, "query", path, "--quiet", "--format", "tsv"]
    if region["shape"] == "ball":
        command += ["--point=" + numbers(region["origin"]), "--radius", repr(region["radius"])]
    else:
        command += ["--origin=" + numbers(region["origin"]), "--direction=" + numbers(region["direction"]), *how,
                    "--aperture", "square" if region["square"] else "circle"]
        command += ["--resolution", "16"]
        command += ["--angle", repr(region["angle"])] if region["shape"] == "cone" else ["--radius", repr(region["radius"])]
        command += ["--range", numbers(region["range"])] if region["range"] else []
    out = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    return {int(row["index"]): row for row in csv.DictReader(io.StringIO(out), delimiter="\t") if row["kind"] == "area"}


def check_values(where, rows, maps, region):
    found = inside(maps, region)
    for k, member in enumerate(maps.members):
        values = maps.data[..., k][found & member] / 100
        row = rows.get(k + 1)
        assert (row is not None and int(row["voxels"]) == len(values)) or not len(values), f"{where}: area {k + 1}"
        if len(values):
            for name, value in (("mean_value", values.mean()), ("max_value", values.max())):
                assert abs(float(row[name]) - value) < 1e-6, f"{where}: area {k + 1}: {name} {row[name]}, {value}"
    return len(rows)


def check_contacts(where, rows, maps, region):
    """Behind a contact is where the ray goes on, or away from the middle of a ball; 9 digits are written."""
    voxel_from_world = np.linalg.inv(maps.m)
    checked = 0
    for index, row in rows.items():
        if row["contact_x"] == "n/a":
            assert row["contact_value"] == "n/a", f"{where}: area {index}: {row['contact_value']} without a contact"
            continue
        contact = np.array([float(row["contact_" + axis]) for axis in "xyz"])
        ray = np.array(region["direction"]) if region["shape"] == "cylinder" else contact - region["origin"]
        ray = ray / max(np.linalg.norm(ray), 1e-9)
        voxel = np.floor(voxel_from_world @ np.append(contact + 1e-3 * ray, 1) + 0.5).astype(int)[:3]
        wanted = maps.data[(*voxel, index - 1)] / 100
        got = float(row["contact_value"])
        assert abs(got - wanted) < 1e-6, f"{where}: area {index}: {got} at the contact, {wanted} in voxel {voxel}"
        checked += 1
    return checked


def check_pixels(where, rows, maps, region):
    """Of a round cone without a range."""
    voxel_from_world = np.linalg.inv(maps.m)
    wanted = np.zeros(len(maps.members) + 1, int)
    for ray in cone_rays(np.array(region["direction"]), region["angle"], 16)[0]:
        entries = []
        for member in maps.members:
            hits = intervals(member, voxel_from_world, np.array(region["origin"]), ray)[1]
            entries.append(hits[0] if len(hits) else np.inf)
        wanted[1 + int(np.argmin(entries)) if min(entries) < np.inf else 0] += 1
    got = [int(rows[k]["pixels"]) if k in rows else 0 for k in range(1, len(wanted))]
    assert got == wanted[1:].tolist(), f"{where}: pixels {got}, reference {wanted[1:].tolist()}"
    return int(wanted.sum())


def main():
    conus, count = sys.argv[1], int(sys.argv[2])
    templates = sys.argv[3] if len(sys.argv) > 3 else "/usr/share/mricron/templates"
    if not os.path.exists(os.path.join(templates, "aal.nii.gz")):
        print("skipped: no mricron-data")
        sys.exit(77)
    generator = random.Random("probabilities")
    rows = contacts = pixels = 0
    with tempfile.TemporaryDirectory() as folder:
        path, maps = write_atlas(folder, nibabel.load(os.path.join(templates, "aal.nii.gz")))
        info = json.loads(subprocess.run([conus, "info", path, "--format", "json"], check=True, capture_output=True).stdout)
        wanted = [int(member.sum()) for member in maps.members]
        assert [area["voxels"] for area in info["objects"]] == wanted and wanted[-1] == 0, wanted
        image = os.path.join(folder, "AAL/AAL-prob-2mm")
        with open(image + ".tsv", "w") as out:
            out.write("index\tname\n" + "".join(f"{k}\tarea {k}\n" for k in range(1, len(wanted) + 1)))
        command = [conus, "info", image + ".nii.gz", "--format", "json"]
        info = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
        assert [area["voxels"] for area in info["objects"]] == wanted, "the image with a table beside it"
        corners = box_corners(maps.data.shape[:3], maps.m)
        for i in range(count):
            region = random_region(generator, i, corners)
            where = str(region)
            found = query(conus, path, region)
            rows += check_values(where, found, maps, region)
            contacts += check_contacts(where, found, maps, region)
            if i < 4 and region["shape"] != "ball" and not region["range"]:
                slices = query(conus, path, region, ("--sampling", "slices", "--slice-fraction", "1"))
                contacts += check_contacts(where + " by slices", slices, maps, region)
            if region["shape"] == "cone" and not region["range"] and not region["square"] and region["angle"] <= 120:
                pixels += check_pixels(where, found, maps, region)
    print(f"{len(wanted)} areas, {count} regions: {rows} rows, {contacts} values at contacts and {pixels} pixels equal")


if __name__ == "__main__":
    main()
