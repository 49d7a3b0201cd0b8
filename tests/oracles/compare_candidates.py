#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""conus plan --from, --toward, --tilt and --roll against candidates that are made here (Eq. 22).

Every candidate is listed, since the only constraint is a length that all have. Entries are made anew from an icosphere
(as GIFTI, with a label file of its vertices), the border voxels of a mask and a table of points: normals, what spacing,
within and without leave. Targets are made from the voxels of the atlas. Ids, positions, directions, far ends and entry
angles agree within 1e-6, and poses that are written and asked again are the same numbers.

usage: compare_candidates.py CONUS; exit 77 = skipped."""

import csv
import os
import subprocess
import sys
import tempfile

from compare_query import nibabel  # or skips
from compare_clearance import GRIDS, blobs, save

import numpy as np


def icosphere(levels, radius, middle):
    """Vertices and triangles, wound outwards."""
    g = (1 + 5**0.5) / 2
    points = np.array([[-1, g, 0], [1, g, 0], [-1, -g, 0], [1, -g, 0], [0, -1, g], [0, 1, g], [0, -1, -g], [0, 1, -g],
                       [g, 0, -1], [g, 0, 1], [-g, 0, -1], [-g, 0, 1]])
    faces = np.array([[0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11], [1, 5, 9], [5, 11, 4], [11, 10, 2],
                      [10, 7, 6], [7, 1, 8], [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9], [4, 9, 5], [2, 4, 11],
                      [6, 2, 10], [8, 6, 7], [9, 8, 1]])
    for _ in range(levels):
        edges, halves = np.unique(np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0, return_inverse=True)
        middles = halves.reshape(-1, 3) + len(points)
        points = np.vstack([points, points[edges].mean(1)])
        a, b, c = faces.T
        ab, bc, ca = middles.T
        faces = np.concatenate([np.stack(one, 1) for one in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    return (points * radius * [1, 0.8, 1.2] + middle).astype("f4"), faces.astype("i4")


def save_surface(path, points, faces):
    arrays = [nibabel.gifti.GiftiDataArray(points, "NIFTI_INTENT_POINTSET"),
              nibabel.gifti.GiftiDataArray(faces, "NIFTI_INTENT_TRIANGLE")]
    nibabel.save(nibabel.gifti.GiftiImage(darrays=arrays), path)


def save_labels(path, values):
    table = nibabel.gifti.GiftiLabelTable()
    for key, name in enumerate(("none", "craniotomy", "ear")):
        label = nibabel.gifti.GiftiLabel(key, *(1.0, 0.0, 0.0, 1.0))
        label.label = name
        table.labels.append(label)
    array = nibabel.gifti.GiftiDataArray(values.astype("i4"), "NIFTI_INTENT_LABEL")
    nibabel.save(nibabel.gifti.GiftiImage(darrays=[array], labeltable=table), path)


def vertex_normals(points, faces):
    """Area-weighted, outwards by the signed volume."""
    a, b, c = (points[faces[:, k]].astype(float) for k in range(3))
    normals = np.zeros(points.shape)
    for k in range(3):
        np.add.at(normals, faces[:, k], np.cross(b - a, c - a))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum()
    return np.sign(volume) * normals / np.linalg.norm(normals, axis=1, keepdims=True)


def spaced(points, least):
    """Whether each is taken: in their order, unless a taken one is nearer."""
    taken = []
    for k, point in enumerate(points):
        if not taken or np.linalg.norm(points[taken] - point, axis=1).min() >= least:
            taken.append(k)
    return np.array(taken)


def voxel_at(affine, shape, points):
    """Voxel of each point, as an index into the flattened array with one more behind for those outside."""
    at = np.floor((points - affine[:3, 3]) @ np.linalg.inv(affine[:3, :3]).T + 0.5).astype(int)
    inside = ((at >= 0) & (at < shape)).all(1)
    return np.where(inside, np.ravel_multi_index(np.where(inside[:, None], at, 0).T, shape), np.prod(shape))


def value_at(affine, values, points):
    return np.append(values.ravel(), 0)[voxel_at(affine, values.shape, points)]


def in_file_order(mask):
    """Voxels of a mask, the first index fastest."""
    return np.argwhere(mask.transpose(2, 1, 0))[:, ::-1]


def to_world(affine, voxels):
    return voxels @ affine[:3, :3].T + affine[:3, 3]


def border(mask):
    padded = np.pad(mask, 1)
    inner = np.ones(mask.shape, bool)
    for axis in range(3):
        for step in (1, -1):
            inner &= np.roll(padded, step, axis)[1:-1, 1:-1, 1:-1]
    return mask & ~inner


def depths(affine, mask):
    """mm from the centre of each voxel to the nearest one that is not of the mask, in a grid along the axes."""
    size = np.abs(np.diag(affine)[:3])
    others = np.argwhere(~np.pad(mask, 1)) - 1
    inside = in_file_order(mask)
    return inside, np.sqrt((((inside[:, None] - others[None]) * size)**2).sum(-1).min(1))


def frame(axis):
    """The device's x and y of a direction (Eq. 2)."""
    up = np.array([0, 0, 1.0]) if abs(axis[2]) <= 0.999 else np.array([0, 1.0, 0])
    x = np.cross(up, -axis)
    x /= np.linalg.norm(x)
    return x, np.cross(-axis, x)


def tilts(axis, most, step):
    """The direction itself, then rings of ceil(2 pi sin(theta) / step) directions, from +y towards +x."""
    x, y = frame(axis)
    found = [axis]
    for ring in range(1, int(np.floor(most / step + 1e-9)) + 1 if step else 1):
        theta = np.radians(ring * step)
        count = int(np.ceil(2 * np.pi * np.sin(theta) / np.radians(step) - 1e-9))
        for k in range(count):
            phi = 2 * np.pi * k / count
            found.append(np.cos(theta) * axis + np.sin(theta) * (np.cos(phi) * y + np.sin(phi) * x))
    return found


def candidates(entries, normals, targets, tilt=(0, 0), beyond=None, rolls=1):
    """{(entry, target, tilt, turn), from 1: (position, direction, far, entry angle in degrees, device's y)}"""
    made = {}
    for e, entry in enumerate(entries):
        for t, target in enumerate([None] if targets is None else targets):
            way = -normals[e] if target is None else target - entry
            axis = way / np.linalg.norm(way)
            far = np.linalg.norm(way) + beyond if target is not None and beyond is not None else None
            for k, turned in enumerate(tilts(axis, *tilt)):
                angle = np.nan
                if normals is not None:
                    angle = np.degrees(np.arctan2(np.linalg.norm(np.cross(turned, -normals[e])), turned @ -normals[e]))
                x, y = frame(turned)
                for r in range(rolls):  # +y towards +x
                    phi = 2 * np.pi * r / rolls
                    made[e + 1, t + 1, k + 1, r + 1] = entry, turned, far, angle, np.cos(phi) * y + np.sin(phi) * x
    return made


def cell(text):
    return np.nan if text == "n/a" else float(text)


def numbers_of(name, wanted):
    """"e3-t7-k2-r4": what does not vary is left out."""
    given = {part[0]: int(part[1:]) for part in name.split("-") if part}
    most = [max(key[k] for key in wanted) for k in range(4)]
    assert set(given) == {letter for letter, count in zip("etkr", most) if count > 1} or set(given) >= {"e"}, name
    return tuple(given.get(letter, 1) for letter in "etkr")


def check_turns(name, path, wanted):
    """The table says how each device is turned, unless all are as their axes alone say."""
    with open(path, encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file, delimiter="\t"))
    assert ("ux" in rows[0]) == (max(key[3] for key in wanted) > 1), (name, rows[0])
    for row in rows:
        up = wanted[numbers_of(row["query_id"], wanted)][4]
        assert "ux" not in row or abs(np.array([float(row[column]) for column in ("ux", "uy", "uz")]) - up).max() < 1e-9, (name, row, up)


def compare(name, conus, atlas, folder, options, wanted, fixed=None):
    """The list of all candidates; the poses that it writes, asked again."""
    plan, poses = os.path.join(folder, "plan.tsv"), os.path.join(folder, "best.tsv")
    done = subprocess.run([conus, "plan", atlas, *options, "--length", "0,1000", "--top", "all", "--rank", "depth", "-o", plan,
                           "--poses-out", poses, "--force", *(["--depth", str(fixed)] if fixed else [])],
                          capture_output=True, text=True, check=False)
    assert done.returncode == 0, (name, done.stderr)
    with open(plan, encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file, delimiter="\t"))
    assert len(rows) == len(wanted), (name, len(rows), len(wanted), done.stderr)
    seen = set()
    for row in rows:
        key = numbers_of(row["query"], wanted)
        position, axis, far, angle, _ = wanted[key]
        seen.add(key)
        given = np.array([float(row[column]) for column in ("x", "y", "z", "dx", "dy", "dz")])
        assert abs(given[:3] - position).max() < 2e-6 and abs(given[3:] - axis).max() < 1e-6, (name, row, position, axis)
        assert abs(float(row["far_mm"]) - (fixed or far)) < 2e-6, (name, row, far)
        assert np.isnan(angle) == (row["entry_angle_deg"] == "n/a"), (name, row, angle)
        assert np.isnan(angle) or abs(cell(row["entry_angle_deg"]) - angle) < 2e-6, (name, row, angle)
    assert seen == set(wanted), name
    check_turns(name, poses, wanted)
    subprocess.run([conus, "plan", atlas, "--poses", poses, "--length", "0,1000", "--top", "all", "--rank", "depth", "-o", plan,
                    "--force", "-q"], check=True)
    with open(plan, encoding="utf-8", newline="") as file:
        twice = list(csv.DictReader(file, delimiter="\t"))
    shared = ("query", "x", "y", "z", "dx", "dy", "dz", "tip_x", "tip_y", "tip_z", "far_mm")
    assert [[row[c] for c in shared] for row in twice] == [[row[c] for c in shared] for row in rows], name
    print(f"{name}: {len(rows)} candidates")


def main():
    conus = sys.argv[1]
    random = np.random.default_rng(23)
    with tempfile.TemporaryDirectory() as folder:
        path = {name: os.path.join(folder, name) for name in
                ("atlas.nii", "scalp.surf.gii", "parts.label.gii", "mask.nii", "holes.tsv", "aims.tsv")}
        labels = blobs(random, (24, 20, 16), 12)
        world = GRIDS["flipped, of three sizes"].copy()
        world[0, 3] = 40  # mm; with x = 0 at an edge of the grid nobody knows where left ends, and deepest is refused
        affine = save(path["atlas.nii"], labels, world)
        middle = to_world(affine, np.array([12, 10, 8]))
        points, faces = icosphere(2, 40.0, middle)
        parts = random.integers(0, 3, len(points))
        save_surface(path["scalp.surf.gii"], points, faces)
        save_labels(path["parts.label.gii"], parts)
        normals = vertex_normals(points, faces)
        points = points.astype(float)
        reach = ["--reach", "3"]
        area = in_file_order(labels == 3)
        voxels = to_world(affine, area)
        centroid = voxels.mean(0)
        atlas, surface = path["atlas.nii"], path["scalp.surf.gii"]

        def ask(name, options, wanted, fixed=None):
            compare(name, conus, atlas, folder, options, wanted, fixed)

        ask("vertices to the centroid", ["--from", surface, "--toward", "centroid,of=3", "--depth", "target+2.5"],
            candidates(points, normals, [centroid], beyond=2.5))
        chosen = spaced(points, 15)
        ask("vertices 15 mm apart", ["--from", f"{surface},spacing=15", "--toward", "centroid,of=3", "--depth", "target"],
            candidates(points[chosen], normals[chosen], [centroid], beyond=0))
        ask("against the normal, tilted", ["--from", f"{surface},spacing=15", "--toward", "normal", "--tilt", "10,5"],
            candidates(points[chosen], normals[chosen], None, (10, 5)), 40)
        ask("tilted and turned", ["--from", f"{surface},spacing=15", "--toward", "normal", "--tilt", "10,10", "--roll", "40"],
            candidates(points[chosen], normals[chosen], None, (10, 10), rolls=9), 40)
        ask("turned normals", ["--from", f"{surface},spacing=15,flip", "--toward", "normal"],
            candidates(points[chosen], -normals[chosen], None), 40)
        chosen = np.flatnonzero(parts != 0)
        ask("labelled vertices", ["--from", f"{surface},within={path['parts.label.gii']}", "--toward", "normal"],
            candidates(points[chosen], normals[chosen], None), 40)
        chosen = np.flatnonzero(parts == 0)
        ask("others", ["--from", f"{surface},without={path['parts.label.gii']}", "--toward", "normal"],
            candidates(points[chosen], normals[chosen], None), 40)
        inside, depth = depths(affine, labels == 3)
        equal = to_world(affine, inside[np.flatnonzero(depth >= depth.max() - 1e-9)])
        off = np.linalg.norm(equal - to_world(affine, inside).mean(0), axis=1)
        deepest = equal[[np.flatnonzero(off <= off.min() + 1e-9)[0]]]
        chosen = spaced(points, 20)
        ask("the deepest voxel", ["--from", f"{surface},spacing=20", "--toward", "deepest,of=3", "--depth", "target-1"],
            candidates(points[chosen], normals[chosen], deepest, beyond=-1))
        aims = voxels[spaced(voxels, 2)]
        ask("voxels 2 mm apart", ["--from", f"{surface},spacing=20", "--toward", "voxels,spacing=2,of=3", "--depth", "target"],
            candidates(points[chosen], normals[chosen], aims, beyond=0))
        # A shell as a mask, with a grid of its own, and an area that takes entries away.
        grid = np.stack(np.meshgrid(*map(np.arange, (14, 12, 10)), indexing="ij"), -1)
        mask = (np.linalg.norm((grid - [6.5, 5.5, 4.5]) / [6, 5, 4], axis=-1) < 1).astype("u1")
        other = np.diag([2.0, -3, 2.5, 1])
        other[:3, 3] = middle - other[:3, :3] @ [6.5, 5.5, 4.5] + 0.125
        other = save(path["mask.nii"], mask, other)
        shell = to_world(other, in_file_order(border(mask > 0)))
        holes = to_world(affine, random.uniform([4, 4, 0], [20, 16, 16], (40, 3))).round(3)
        ask("border of a mask", ["--from", path["mask.nii"], "--toward", "centroid,of=3", "--depth", "target"],
            candidates(shell, None, [centroid], beyond=0))
        with open(path["holes.tsv"], "w", encoding="utf-8") as file:
            file.write("".join("\t".join(map(repr, map(float, row))) + "\n" for row in holes))
        with open(path["aims.tsv"], "w", encoding="utf-8") as file:
            file.write("".join("\t".join(map(repr, map(float, row))) + "\n" for row in voxels[:3]))
        ask("points to points", ["--from", path["holes.tsv"], "--toward", path["aims.tsv"], "--depth", "target"],
            candidates(holes, None, voxels[:3], beyond=0))
        chosen = np.flatnonzero(value_at(other, mask, holes))
        assert 0 < len(chosen) < len(holes)
        ask("points in a mask", ["--from", f"{path['holes.tsv']},within={path['mask.nii']}", "--toward", "centroid,of=3",
                                 "--depth", "target"], candidates(holes[chosen], None, [centroid], beyond=0))
        chosen = np.flatnonzero(value_at(affine, labels, holes) != 5)
        ask("points not in an area", ["--from", f"{path['holes.tsv']},without=5", "--toward", "centroid,of=3", "--depth", "target"],
            candidates(holes[chosen], None, [centroid], beyond=0))


if __name__ == "__main__":
    main()
