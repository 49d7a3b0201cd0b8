#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Julich-Brain's surfaces and the 18 Juelich fibre pathways in one manifest: what conus query hits first, against a
reference that shares nothing with conus.

The reference reads GIFTI and NIfTI with nibabel and OBJ by itself. Per ray it intersects every triangle (Moeller and
Trumbore) and, per pathway, finds the first voxel of at least a quarter of the scale by all crossings of cell planes. A
cone of one pixel is one ray. Where the two nearest objects are closer than 1e-3 mm, either is right.

usage: compare_manifest.py CONUS SHARED_DATA; exit 77 = skipped."""

import csv
import glob
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

from sample import LONG

THRESHOLD = 65535 / 4  # uint16 over its whole range
RAYS = 120 if LONG else 40
RIGHT_OFFSET = 1000


def read_index(path):
    with open(path, encoding="utf-8") as file:
        return {int(row["index"]): row for row in csv.DictReader(file, delimiter="\t")}


def read_gifti(path):
    arrays = nibabel.load(path).darrays
    return np.asarray(arrays[0].data, float), np.asarray(arrays[1].data)


def read_obj(path):
    with open(path, encoding="utf-8") as file:
        rows = [line.split() for line in file]
    vertices = [[float(x) for x in row[1:4]] for row in rows if row and row[0] == "v"]
    faces = [[int(x.split("/")[0]) - 1 for x in row[1:4]] for row in rows if row and row[0] == "f"]
    return np.array(vertices), np.array(faces)


class Scene:
    """All triangles in three arrays of corners with an object each, and the pathways' volumes."""

    def __init__(self, areas, pathways):
        self.names = [name for name, _, _ in areas]
        self.corners = [np.concatenate([v[f[:, k]] for _, v, f in areas]) for k in range(3)]
        self.owner = np.concatenate([np.full(len(f), i) for i, (_, _, f) in enumerate(areas)])
        self.pathways = []
        for name, path in pathways:
            image = nibabel.load(path)
            self.pathways.append((name, np.asanyarray(image.dataobj) >= THRESHOLD, np.linalg.inv(image.affine)))

    def trace(self, origin, ray):
        """[(distance, kind, name)] of the nearest contact with each object, sorted."""
        hits = self.trace_surfaces(origin, ray) + self.trace_pathways(origin, ray)
        return sorted(hits)

    def trace_surfaces(self, origin, ray):
        a, b, c = self.corners
        e, g = b - a, c - a
        p = np.cross(ray, g)
        det = np.einsum("ij,ij->i", e, p)
        with np.errstate(divide="ignore", invalid="ignore"):
            s = origin - a
            u = np.einsum("ij,ij->i", s, p) / det
            q = np.cross(s, e)
            v = q @ ray / det
            t = np.einsum("ij,ij->i", g, q) / det
            hit = (u >= 0) & (v >= 0) & (u + v <= 1) & (t >= 0)
        nearest = {}
        for i in np.flatnonzero(hit):
            name = self.names[self.owner[i]]
            nearest[name] = min(nearest.get(name, np.inf), t[i])
        return [(t, "area", name) for name, t in nearest.items()]

    def trace_pathways(self, origin, ray):
        hits = []
        for name, mask, voxel_from_world in self.pathways:
            o = voxel_from_world[:3, :3] @ origin + voxel_from_world[:3, 3]
            d = voxel_from_world[:3, :3] @ ray
            crossings = [np.zeros(1)]
            for axis in range(3):
                if d[axis]:
                    crossings.append((np.arange(mask.shape[axis] + 1) - 0.5 - o[axis]) / d[axis])
            t = np.unique(np.concatenate(crossings))
            t = t[t >= 0]
            middle = (t[1:] + t[:-1]) / 2
            cells = np.floor(o + middle[:, None] * d + 0.5).astype(int)
            inside = ((cells >= 0) & (cells < mask.shape)).all(axis=1)
            full = np.zeros(len(middle), bool)
            full[inside] = mask[tuple(cells[inside].T)]
            if full.any():
                hits.append((t[np.argmax(full)], "pathway", name))
        return hits


def load_scene(data):
    folder = os.path.join(data, "meshes/julich31-areas")
    areas = []
    for side, ending, reader, offset in [("lh", "gii", read_gifti, 0), ("rh", "obj", read_obj, RIGHT_OFFSET)]:
        index = read_index(os.path.join(folder, side + "-INDEX.tsv"))
        for path in sorted(glob.glob(os.path.join(folder, side, "*." + ending))):
            number = int(os.path.basename(path).split("_")[0])
            areas.append(((number + offset, index[number]["name"]), *reader(path)))
    paths = sorted(glob.glob(os.path.join(data, "prob/juelich-fibre-pathways-u16/*.nii.gz")))
    pathways = [(os.path.basename(path)[:-len(".nii.gz")].replace("_", " "), path) for path in paths]
    return areas, pathways


def write_manifest(path, data, pathways):
    folder = os.path.join(data, "meshes/julich31-areas")
    areas = [{"files": folder + "/lh/*.gii", "labels": folder + "/lh-INDEX.tsv", "hemisphere": "L"},
             {"files": folder + "/rh/*.obj", "labels": folder + "/rh-INDEX.tsv", "hemisphere": "R",
              "label_offset": RIGHT_OFFSET}]
    manifest = {"conus_atlas": 1, "allow_outside": True, "space": "ras", "areas": areas,
                "pathways": [{"file": file, "name": name} for name, file in pathways]}
    with open(path, "w", encoding="utf-8") as file:
        json.dump(manifest, file)


def random_rays(areas, rng):
    """From around the brain, towards vertices of areas and points near the middle."""
    rays = []
    for i in range(RAYS):
        direction = np.array([rng.gauss(0, 1) for _ in range(3)])
        direction /= np.linalg.norm(direction)
        vertices = areas[rng.randrange(len(areas))][1]
        target = vertices[rng.randrange(len(vertices))] if i % 2 else np.array([rng.uniform(-30, 30) for _ in range(3)])
        origin = np.round(target + (40 if i % 3 == 0 else 160) * direction, 3)
        rays.append((origin, np.round(target, 3)))
    return rays


def ask(conus, manifest, rays, folder):
    poses = os.path.join(folder, "poses.tsv")
    with open(poses, "w", encoding="utf-8") as file:
        file.write("x\ty\tz\ttx\tty\ttz\n")
        for origin, target in rays:
            file.write("\t".join(f"{v:.3f}" for v in [*origin, *target]) + "\n")
    run = subprocess.run([conus, "query", manifest, "--pose", poses, "--resolution", "1", "--engine", "rays", "--format",
                          "tsv", "--quiet", "--angle", "1"], capture_output=True, text=True, check=True)
    answers = {}
    for row in csv.DictReader(io.StringIO(run.stdout), delimiter="\t"):
        if row["kind"] != "unassigned":
            answers[int(row["query"])] = row
    return answers


def check(row, hits, number):
    """A complaint, or None."""
    if row is None or not hits:
        return None if row is None and not hits else f"ray {number}: conus {row and row['name']}, reference {hits[:1]}"
    distance = float(row["distance_mm"])
    for t, kind, key in hits:
        if t > hits[0][0] + 1e-3:
            break
        same = (int(row["index"]), row["name"]) == key if kind == "area" else row["name"] == key
        if same and row["kind"] == kind and abs(t - distance) < 1e-3:
            return None
    return f"ray {number}: conus {row['kind']} {row['index']} {row['name']} {distance}, reference {hits[:2]}"


def main():
    conus, data = sys.argv[1], os.environ.get("CONUS_SHARED_DATA", sys.argv[2])
    if not os.path.isdir(os.path.join(data, "meshes/julich31-areas")):
        print("skipped: no shared data")
        sys.exit(77)
    areas, pathways = load_scene(data)
    scene = Scene(areas, pathways)
    with tempfile.TemporaryDirectory() as folder:
        manifest = os.path.join(folder, "julich.atlas.json")
        write_manifest(manifest, data, pathways)
        rays = random_rays(areas, random.Random(3))
        answers = ask(conus, manifest, rays, folder)
    complaints = []
    kinds = {"area": 0, "pathway": 0}
    for i, (origin, target) in enumerate(rays, 1):
        ray = (target - origin) / np.linalg.norm(target - origin)
        hits = scene.trace(origin, ray)
        if hits:
            kinds[hits[0][1]] += 1
        complaints.append(check(answers.get(i), hits, i))
    complaints = [c for c in complaints if c]
    print(f"{len(areas)} surfaces, {len(scene.owner)} triangles, {len(pathways)} pathways, {len(rays)} rays: "
          f"{kinds['area']} hit an area first, {kinds['pathway']} a pathway; {len(complaints)} differ")
    print("\n".join(complaints[:10]))
    sys.exit(1 if complaints or not kinds["area"] or not kinds["pathway"] else 0)


if __name__ == "__main__":
    main()
