#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""AAL in pieces, joined by "parcellations", against numpy.

The pieces: the deep nuclei, grown by 3 mm and sampled on a turned grid of 1.7 mm; the left half, the right half with
other labels, and the vermis, all on AAL's own grid. The nuclei come first, so that they take voxels of both halves. Once
more with the nuclei last, where they lose what they have grown into.

By numpy: voxels of each area, after the later pieces have lost those whose centres earlier ones hold; and per ray the
area of the first cell, by all crossings of cell planes of each grid. Where two grids are entered within 1e-6 mm, either
is right. Written without a look at conus's code.

usage: compare_parcellations.py CONUS; exit 77 = skipped."""

import csv
import hashlib
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

AAL = "/usr/share/mricron/templates/aal.nii.gz"
NUCLEI = range(71, 79)  # caudate, putamen, pallidum, thalamus; left ones are odd, as everywhere up to 108
RIGHT_OFFSET = 2000
RAYS = 150


def turned_grid():
    """1.7 mm, turned by 20 degrees about z and by 10 about x, around the nuclei."""
    a, b = np.radians(20), np.radians(10)
    z = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    x = np.array([[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]])
    shape = (64, 64, 44)
    affine = np.eye(4)
    affine[:3, :3] = 1.7 * (z @ x)
    affine[:3, 3] = np.array([0.13, -2.21, 6.37]) - affine[:3, :3] @ (np.array(shape) / 2)
    return shape, affine.astype(np.float32).astype(float)  # as NIfTI stores it


def cells_at(points, affine, shape):
    """Index of the cell that holds each point (clipped), and which lie inside."""
    inverse = np.linalg.inv(affine)
    cells = np.floor(points @ inverse[:3, :3].T + inverse[:3, 3] + 0.5).astype(int)
    inside = ((cells >= 0) & (cells < shape)).all(axis=1)
    return np.clip(cells, 0, np.array(shape) - 1), inside


def centres(index, affine):
    return index @ affine[:3, :3].T + affine[:3, 3]


def grow(labels, steps):
    """Each step gives background voxels the label of a neighbour."""
    for _ in range(steps):
        for axis in range(3):
            for shift in (-1, 1):
                labels = np.where(labels == 0, np.roll(labels, shift, axis), labels)
    return labels


def make_pieces(image):
    aal = np.asanyarray(image.dataobj).astype(np.int32)
    shape, affine = turned_grid()
    grown = grow(np.where(np.isin(aal, NUCLEI), aal, 0), 3)
    cells, inside = cells_at(centres(np.argwhere(np.ones(shape)), affine), image.affine, aal.shape)
    nuclei = np.where(inside, grown[tuple(cells.T)], 0).reshape(shape)
    left = np.where((aal <= 108) & (aal % 2 == 1), aal, 0)
    right = np.where((aal > 0) & (aal <= 108) & (aal % 2 == 0), aal - 1, 0)  # called like the left ones
    return [("nuclei", nuclei, affine, {"label_offset": 500}), ("left", left, image.affine, {"hemisphere": "L"}),
            ("right", right, image.affine, {"hemisphere": "R", "label_offset": RIGHT_OFFSET}),
            ("vermis", np.where(aal > 108, aal, 0), image.affine, {})]


def join(pieces):
    """The pieces with the labels of the atlas, without the voxels that earlier ones have."""
    done = []
    for name, labels, affine, entry in pieces:
        labels = np.where(labels > 0, labels + entry.get("label_offset", 0), 0)
        for _, earlier, other in done:
            index = np.argwhere(labels)
            cells, inside = cells_at(centres(index, affine), other, earlier.shape)
            labels[tuple(index[inside & (earlier[tuple(cells.T)] > 0)].T)] = 0
        done.append((name, labels, affine))
    return done


def first_hit(pieces, origin, ray):
    """[(mm, label)] of the first area's cell on each grid, nearest first."""
    hits = []
    for _, labels, affine in pieces:
        inverse = np.linalg.inv(affine)
        o, d = inverse[:3, :3] @ origin + inverse[:3, 3], inverse[:3, :3] @ ray
        planes = [(np.arange(n + 1) - 0.5 - o[a]) / d[a] for a, n in enumerate(labels.shape)]
        t = np.unique(np.concatenate([[0.0], *planes]))
        t = t[t >= 0]
        cells = np.floor(o + ((t[1:] + t[:-1]) / 2)[:, None] * d + 0.5).astype(int)
        inside = ((cells >= 0) & (cells < labels.shape)).all(axis=1)
        found = np.zeros(len(cells), int)
        found[inside] = labels[tuple(cells[inside].T)]
        if found.any():
            hits.append((t[np.argmax(found > 0)], int(found[np.argmax(found > 0)])))
    return sorted(hits)


def write_scene(folder, pieces):
    entries = []
    for name, labels, affine, entry in pieces:
        image = nibabel.Nifti1Image(labels.astype(np.int16), affine)
        image.header.set_sform(affine, 4)
        nibabel.save(image, os.path.join(folder, name + ".nii.gz"))
        entries.append({"file": name + ".nii.gz", **entry})
    path = os.path.join(folder, "pieces.atlas.json")
    with open(path, "w", encoding="utf-8") as file:
        json.dump({"conus_atlas": 1, "parcellations": entries}, file)
    return path


def run(*command):
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"{' '.join(command)}: {done.stderr}")
    return done.stdout


def compare_areas(conus, path, pieces):
    wanted = {}
    for _, labels, affine in pieces:
        for label, count in zip(*np.unique(labels[labels > 0], return_counts=True)):
            wanted[int(label)] = (int(count), count * abs(np.linalg.det(affine[:3, :3])))
    wrong = []
    for area in json.loads(run(conus, "info", path, "--format", "json"))["objects"]:
        voxels, mm3 = wanted.pop(area["index"], (0, 0.0))
        if area["voxels"] != voxels or abs(area["volume_mm3"] - mm3) > 1e-5 * mm3:
            wrong.append(f"area {area['index']}: {area['voxels']} voxels of {area['volume_mm3']} mm3, wanted {voxels}, {mm3}")
    return wrong + [f"area {label} is missing" for label in wanted]


def compare_rays(conus, path, pieces, folder, rng):
    rays = []
    for i in range(RAYS):
        target = np.array([rng.uniform(-30, 30), rng.uniform(-45, 25), rng.uniform(-10, 30)])
        away = np.array([rng.gauss(0, 1) for _ in range(3)])
        distance = (0, 12, 130)[i % 3] or 1  # from within and from outside
        rays.append((np.round(target + distance * away / np.linalg.norm(away), 3), np.round(target, 3)))
    poses = os.path.join(folder, "poses.tsv")
    with open(poses, "w", encoding="utf-8") as file:
        file.write("x\ty\tz\ttx\tty\ttz\n")
        for origin, target in rays:
            file.write("\t".join(f"{v:.3f}" for v in [*origin, *target]) + "\n")
    text = run(conus, "query", path, "--pose", poses, "--resolution", "1", "--engine", "rays", "--format", "tsv",
               "--quiet", "--angle", "1")
    answers = {int(row["query"]): row for row in csv.DictReader(io.StringIO(text), delimiter="\t")
               if row["kind"] != "unassigned"}
    wrong, deep = [], 0
    for number, (origin, target) in enumerate(rays, 1):
        hits = first_hit(pieces, origin, (target - origin) / np.linalg.norm(target - origin))
        row = answers.get(number)
        right = [label for t, label in hits if t <= hits[0][0] + 1e-6] if hits else []
        same = int(row["index"]) in right and abs(float(row["distance_mm"]) - hits[0][0]) < 1e-5 if row and hits else \
            not row and not hits
        deep += bool(hits) and 500 < hits[0][1] < 600
        wrong += [] if same else [f"ray {number}: conus {row and (row['index'], row['distance_mm'])}, numpy {hits[:2]}"]
    return wrong, deep


def compare_sources(conus, path, folder):
    """An answer names every piece with its SHA-256, a mask of an area of the left half names them all as sources."""
    out = os.path.join(folder, "answer.json")
    mask = os.path.join(folder, "mask")
    run(conus, "query", path, "--origin=-90,0,10", "--toward=0,0,10", "--angle", "10", "--quiet", "--engine", "rays",
        "--format", "json", "-o", out, "--mask", mask + ".nii.gz", "--mask-object", "1", "--force")
    with open(mask + ".json", encoding="utf-8") as file:
        sources = {os.path.basename(source) for source in json.load(file)["Sources"]}
    os.remove(mask + ".nii.gz")
    with open(out, encoding="utf-8") as file:
        atlas = json.load(file)["Atlas"]
    sums = {os.path.basename(entry["path"]): entry["sha256"] for entry in atlas["volumes"] + atlas["files"]}
    wrong = []
    for name in os.listdir(folder):
        if name.endswith((".nii.gz", ".atlas.json")):
            wrong += [] if name in sources else [f"{name} is no source of the mask"]
            with open(os.path.join(folder, name), "rb") as file:
                if sums.get(name) != hashlib.sha256(file.read()).hexdigest():
                    wrong.append(f"{name}: SHA-256 {sums.get(name)}")
    return wrong


def main():
    conus = sys.argv[1]
    if not os.path.exists(AAL):
        print("skipped: no mricron-data")
        sys.exit(77)
    pieces = make_pieces(nibabel.load(AAL))
    wrong, deep = [], 0
    for order in (pieces, pieces[1:] + pieces[:1]):
        with tempfile.TemporaryDirectory() as folder:
            path = write_scene(folder, order)
            joined = join(order)
            wrong += compare_areas(conus, path, joined)
            complaints, nuclei = compare_rays(conus, path, joined, folder, random.Random(5))
            wrong += complaints + compare_sources(conus, path, folder)
            deep += nuclei
    print(f"2 orders of {len(pieces)} pieces, {RAYS} rays each, {deep} of them hit the turned grid; {len(wrong)} differ")
    print("\n".join(wrong[:10]))
    sys.exit(1 if wrong or deep < 10 else 0)


main()
