#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The census of conus query, and its masks, against numpy (Eq. 10).

Volumes are read with nibabel. Every voxel's centre goes through the predicate as docs/model.md writes it: cones, square
pyramids, cylinders, square rods and balls, with and without a range, from seeded random poses. The mask of the region
must have exactly these voxels, the masks of areas, labels and values exactly those of them, on the atlas's grid, with
its affine, its sform and qform codes. Rows: voxels exactly, volumes, fractions, sums, means, maxima and centroids to
the digits that are written; of a ball, the distance to the nearest cell of every object, computed by clamping.

usage: compare_census.py CONUS POSES_PER_CASE [SHARED_DATA [TEMPLATE_FOLDER]]; exit 77 = skipped."""

import csv
import glob
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

from compare_query import box_corners, device_frame, random_pose

CONTENTS = ["all", "areas", "labels", "values"]


class Volume:
    def __init__(self, path, threshold=0):
        self.path, self.threshold = path, threshold
        self.image = nibabel.load(path)
        self.data = np.asanyarray(self.image.dataobj).reshape(self.image.shape[:3])
        if threshold:
            self.data = self.data.astype(np.float32)
        self.m = self.image.affine
        self.mm3 = abs(np.linalg.det(self.m[:3, :3]))
        i, j, k = np.ogrid[: self.data.shape[0], : self.data.shape[1], : self.data.shape[2]]
        self.p = [self.m[a, 0] * i + self.m[a, 1] * j + self.m[a, 2] * k + self.m[a, 3] for a in range(3)]

    def member(self):
        return self.data >= self.threshold if self.threshold else self.data != 0


def inside(volume, region):
    """Which voxels have their centre in the region."""
    v = [volume.p[a] - region["origin"][a] for a in range(3)]
    if region["shape"] == "ball":
        return v[0] * v[0] + v[1] * v[1] + v[2] * v[2] <= region["radius"] * region["radius"]
    right, up, back = device_frame(np.array(region["direction"]))
    x, y, z = (v[0] * e[0] + v[1] * e[1] + v[2] * e[2] for e in (right, up, -back))
    w = math.tan(math.radians(region["angle"]) / 2) * z if region["shape"] == "cone" else region["radius"]
    near, far = region["range"] or (0, math.inf)
    depth = (z >= near) & (z <= far)
    if region["square"]:
        return depth & (abs(x) <= w) & (abs(y) <= w)
    return depth & (w >= 0) & (x * x + y * y <= w * w)


def random_region(generator, index, corners):
    pose = random_pose(generator, corners)
    region = {"origin": pose[:3], "direction": pose[3:6], "angle": pose[6], "square": generator.random() < 0.25,
              "shape": ("cone", "cylinder", "cone", "ball")[index % 4], "radius": round(generator.uniform(0.5, 25), 3)}
    near = round(generator.uniform(0, 120), 3)
    region["range"] = (near, near + round(generator.uniform(1, 100), 3)) if generator.random() < 0.4 else None
    if region["shape"] == "ball":
        region["origin"] = [round(generator.uniform(low, high), 3)
                            for low, high in zip(corners.min(axis=0), corners.max(axis=0))]
    return region


def query(conus, volume, pathway, region, content, mask):
    numbers = lambda values: ",".join(map(repr, values))
    command = [conus, "query", volume.path, "--quiet", "--format", "tsv", "--mask", mask, "--force", "--mask-of", content]
    if pathway:
        command += ["--pathway", f"{pathway.path},threshold={pathway.threshold},name=pathway"]
    if region["shape"] == "ball":
        command += ["--point=" + numbers(region["origin"]), "--radius", repr(region["radius"])]
    else:
        command += ["--origin=" + numbers(region["origin"]), "--direction=" + numbers(region["direction"]), "--layers",
                    "all", "--resolution", "2", "--aperture", "square" if region["square"] else "circle"]
        command += ["--angle", repr(region["angle"])] if region["shape"] == "cone" else ["--radius", repr(region["radius"])]
        command += ["--range", numbers(region["range"])] if region["range"] else []
    out = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    return list(csv.DictReader(io.StringIO(out), delimiter="\t"))


def check_mask(where, path, content, volume, pathway, region):
    mask = nibabel.load(path)
    source = pathway if content == "values" else volume
    found = inside(source, region)
    wanted = {"all": lambda: found, "areas": lambda: found & source.member(),
              "labels": lambda: np.where(found, source.data, 0),
              "values": lambda: np.where(found & source.member(), source.data, 0)}[content]()
    got = np.asanyarray(mask.dataobj)
    assert got.shape == wanted.shape and (got == wanted).all(), f"{where}: {np.count_nonzero(got != wanted)} voxels differ"
    assert np.array_equal(mask.affine, source.m), f"{where}: affine {mask.affine}"
    header, original = mask.header, source.image.header
    used = "sform_code" if original["sform_code"] > 0 else "qform_code"
    assert header["sform_code"] == original[used] == header["qform_code"], f"{where}: codes"
    assert np.allclose(mask.get_qform(), source.m, atol=1e-4), f"{where}: qform"
    return int(found.sum())


def near(got, wanted, where):
    assert abs(float(got) - wanted) <= 2e-8 * max(1, abs(wanted)), f"{where}: {got}, reference {wanted}"


def check_row(where, row, volume, member, found, areas):
    both = member & found
    count = int(both.sum())
    assert int(row["voxels"]) == count, f"{where}: {row['voxels']} voxels, reference {count}"
    near(row["volume_mm3"], count * volume.mm3, where)
    near(row["fraction"], count / member.sum(), where)
    if row["kind"] == "area" and areas:
        near(row["cone_fraction"], count / areas, where)
    if not count:
        return
    values = volume.data[both].astype(np.float64)
    weights = values if row["kind"] == "pathway" else np.ones(count)
    if row["kind"] == "pathway":
        for name, value in (("sum_value", values.sum()), ("mean_value", values.mean()), ("max_value", values.max())):
            near(row[name], value, f"{where}: {name}")
    for axis, name in enumerate("xyz"):
        at = np.broadcast_to(volume.p[axis], both.shape)[both]
        near(row["centroid_" + name], (at * weights).sum() / weights.sum(), f"{where}: centroid {name}")


def check_distances(where, rows, volume, region):
    """Of grids with perpendicular axes: the nearest point of a cell, by clamping."""
    voxel = np.linalg.inv(volume.m) @ np.append(region["origin"], 1)
    spacing = np.linalg.norm(volume.m[:3, :3], axis=0)
    square = 0
    for axis in range(3):
        index = np.arange(volume.data.shape[axis]).reshape([-1 if a == axis else 1 for a in range(3)])
        square = square + (spacing[axis] * np.maximum(abs(index - voxel[axis]) - 0.5, 0)) ** 2
    reached = volume.member() & (square <= region["radius"] ** 2)
    wanted = {int(label): math.sqrt(square[reached & (volume.data == label)].min())
              for label in np.unique(volume.data[reached])}
    got = {int(row["index"]): float(row["distance_mm"]) for row in rows if row["kind"] == "area"}
    assert set(got) == set(wanted), f"{where}: {sorted(got)}, reference {sorted(wanted)}"
    for label, distance in wanted.items():
        assert abs(got[label] - distance) < 1e-6, f"{where}: label {label}: {got[label]}, reference {distance}"


def check_rows(where, rows, volume, pathway, region):
    found = inside(volume, region)
    areas = int((found & volume.member()).sum())
    seen = set()
    for row in rows:
        if row["kind"] == "area":
            seen.add(int(row["index"]))
            check_row(where, row, volume, volume.data == int(row["index"]), found, areas)
        elif row["kind"] == "pathway":
            check_row(where, row, pathway, pathway.member(), inside(pathway, region), 0)
        else:
            assert int(row["voxels"]) == int((found & ~volume.member()).sum()), f"{where}: background"
    missing = set(np.unique(volume.data[found & volume.member()]).tolist()) - seen
    assert not missing, f"{where}: no row for {sorted(missing)}"
    if pathway and (inside(pathway, region) & pathway.member()).any():
        assert any(row["kind"] == "pathway" for row in rows), f"{where}: no row for the pathway"
    if region["shape"] == "ball":
        check_distances(where, rows, volume, region)
    return len(rows)


def phantom(conus, folder):
    subprocess.run([conus, "phantom", "tubes", "-o", folder, "--size", "48", "--spacing", "1.5,2,1.25", "--oblique", "25",
                    "--flip", "xz"], check=True, capture_output=True)
    return os.path.join(folder, "tubes.nii.gz")


def cases(conus, shared, templates, folder):
    pathways = sorted(glob.glob(os.path.join(shared, "prob/juelich-fibre-pathways-u16/*.nii.gz")))
    for name, threshold in (("aal", 6553.6), ("HarvardOxford-cort-maxprob-thr0-1mm", 3000), ("JHU-WhiteMatter-labels-2mm", 1)):
        path = os.path.join(templates, name + ".nii.gz")
        if os.path.exists(path):
            pathway = pathways.pop(0) if pathways else None
            yield Volume(path), Volume(pathway, threshold) if pathway else None
    yield Volume(phantom(conus, folder)), None


def main():
    conus, count = sys.argv[1], int(sys.argv[2])
    if not os.environ.get("CONUS_TEST_LONG"):
        count = min(count, 2)  # the volumes together still have each shape and each content
    shared = sys.argv[3] if len(sys.argv) > 3 else "../shared/data"
    templates = sys.argv[4] if len(sys.argv) > 4 else "/usr/share/mricron/templates"
    generator = random.Random("census")
    volumes = voxels = rows = 0
    with tempfile.TemporaryDirectory() as folder:
        mask = os.path.join(folder, "mask.nii.gz")
        for volume, pathway in cases(conus, shared, templates, folder):
            corners = box_corners(volume.data.shape, volume.m)
            for i in range(count):
                number = volumes * count + i
                region = random_region(generator, number, corners)
                content = CONTENTS[(number + number // 4) % (4 if pathway else 3)]
                where = f"{os.path.basename(volume.path)}, {region}, {content}"
                found = query(conus, volume, pathway, region, content, mask)
                rows += check_rows(where, found, volume, pathway, region)
                voxels += check_mask(where, mask, content, volume, pathway, region)
            volumes += 1
    print(f"{volumes} volumes, {count} regions each: {voxels} voxels in them and no other, {rows} rows equal")


if __name__ == "__main__":
    main()
