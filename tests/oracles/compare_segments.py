#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""conus batch --segments against 1-D walks of its own (Eq. 17): on AAL, and where it is on surfaces of the Allen atlas.

A probe through a volume is cut at all planes between cells, sorted, with the label looked up at the middle of every
piece; pieces in a row with one label are a segment. A probe through surfaces crosses every triangle that a line meets,
tried in double; a segment is where the number of ways in and out is not 0. Every segment must be there, entries and exits
within 1e-4 mm, and nothing else; segments and gaps fill the probe.

usage: compare_segments.py CONUS PROBES SHARED_DATA; exit 77 = skipped."""

import csv
import os
import random
import subprocess
import sys
import tempfile

from compare_query import intervals, nibabel  # or skips
from compare_scenes import brainglobe

import numpy as np

AAL = "/usr/share/mricron/templates/aal.nii.gz"
ALLEN = "meshes/brainglobe-allen-ccf2017-subset"
TOLERANCE = 1e-4


def joined(pieces):
    """(label, entry, exit) with those in a row of one label as one."""
    rows = []
    for label, entry, exit_ in pieces:
        if rows and rows[-1][0] == label and entry - rows[-1][2] < 1e-9:
            rows[-1][2] = exit_
        else:
            rows.append([label, entry, exit_])
    return rows


def in_volume(volume, origin, ray, depths):
    labels, voxel_from_world = volume
    return joined(zip(*(found.tolist() for found in intervals(labels, voxel_from_world, origin, ray, *depths))))


def crossings(vertices, triangles, origin, ray):
    """(distance, +1 in or -1 out) of the triangles that a half-line meets."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    e, g = b - a, c - a
    det = np.einsum("ij,ij->i", e, np.cross(ray, g))
    with np.errstate(divide="ignore", invalid="ignore"):
        u = np.einsum("ij,ij->i", origin - a, np.cross(ray, g)) / det
        q = np.cross(origin - a, e)
        v, t = q @ ray / det, np.einsum("ij,ij->i", g, q) / det
        hit = (u >= 0) & (v >= 0) & (u + v <= 1) & (t >= 0)
    return sorted(zip(t[hit].tolist(), np.sign(det[hit]).tolist()))


def may_meet(vertices, origin, ray):
    """Whether a line passes the box around a surface."""
    with np.errstate(divide="ignore"):
        ends = np.sort(np.stack([vertices.min(0) - origin, vertices.max(0) - origin]) / ray, axis=0)
    return ends[0].max() <= ends[1].min() + 1e-6


def in_surfaces(areas, origin, ray, depths):
    rows = []
    for label, vertices, triangles in areas:
        if not may_meet(vertices, origin, ray):
            continue
        met = crossings(vertices, triangles, origin, ray)
        winding, entry, pieces = -sum(side for _, side in met), 0.0, []
        for t, side in met:
            if winding == 0:
                entry = t
            winding += side
            if winding == 0:
                pieces.append((label, max(entry, depths[0]), min(t, depths[1])))
        rows += [row for row in joined(pieces) if row[1] < row[2]]
    return sorted(rows, key=lambda row: row[1])


def ask(conus, atlas, probes, depths):
    """{number of a probe: its rows}"""
    with tempfile.TemporaryDirectory() as folder:
        poses, rows = os.path.join(folder, "probes.tsv"), os.path.join(folder, "rows.tsv")
        with open(poses, "w", encoding="utf-8") as file:
            file.write("x\ty\tz\ttx\tty\ttz\n")
            file.writelines("\t".join(map(repr, probe)) + "\n" for probe in probes)
        command = [conus, "batch", atlas, "--poses", poses, "--segments", rows, "--quiet"]
        subprocess.run(command + (["--range", f"{depths[0]!r},{depths[1]!r}"] if depths[1] < np.inf else []), check=True)
        found = {}
        with open(rows, encoding="utf-8", newline="") as file:
            for row in csv.DictReader(file, delimiter="\t"):
                found.setdefault(int(row["query"]), []).append(row)
        return found


def check_gaps(rows, wanted, depths):
    """The rows in no object are what the others leave."""
    reached, gaps = depths[0], []
    for _, entry, exit_ in wanted:
        if entry > reached + 1e-9:
            gaps.append((reached, entry))
        reached = max(reached, exit_)
    end = depths[1] if depths[1] < np.inf else reached if wanted else None
    if end is None or end > reached + 1e-9:
        gaps.append((reached, end))
    found = [row for row in rows if row["kind"] == "unassigned"]
    assert len(found) == len(gaps), (found, gaps)
    for row, (entry, exit_) in zip(found, gaps):
        assert abs(float(row["entry_mm"]) - entry) < TOLERANCE, (row, entry)
        assert (row["exit_mm"] == "n/a") == (exit_ is None), (row, exit_)
        assert exit_ is None or abs(float(row["exit_mm"]) - exit_) < TOLERANCE, (row, exit_)


def check_probe(rows, wanted, origin, ray):
    """Gives how many segments are of an area that the probe was in before."""
    assert [int(row["order"]) for row in rows] == list(range(1, len(rows) + 1))
    found = sorted((int(row["index"]), float(row["entry_mm"]), row) for row in rows if row["kind"] == "area")
    assert len(found) == len(wanted), (found, wanted)
    for (label, entry, row), (index, start, end) in zip(found, sorted(wanted)):
        assert label == index and abs(entry - start) < TOLERANCE, (row, index, start)
        assert abs(float(row["exit_mm"]) - end) < TOLERANCE, (row, end)
        assert abs(float(row["length_mm"]) - (end - start)) < TOLERANCE, (row, end - start)
        for name, depth in (("entry", start), ("exit", end)):
            at = np.array([float(row[f"{name}_{axis}"]) for axis in "xyz"])
            assert np.abs(at - (origin + depth * ray)).max() < TOLERANCE, (row, name)
    return len(wanted) - len({label for label, _, _ in wanted})


def compare(conus, atlas, probes, depths, walk):
    found, again, count = ask(conus, atlas, probes, depths), 0, 0
    assert len(found) == len(probes)
    for number, probe in enumerate(probes, 1):
        origin, target = np.array(probe[:3]), np.array(probe[3:])
        ray = (target - origin) / np.linalg.norm(target - origin)
        wanted = walk(origin, ray, depths)
        again += check_probe(found[number], wanted, origin, ray)
        check_gaps(found[number], wanted, depths)
        count += len(wanted)
    return count, again


def in_box(low, high):
    return [random.uniform(a, b) for a, b in zip(low, high)]


def near(points, beside):
    return [x + random.uniform(-beside, beside) for x in points[random.randrange(len(points))]]


def run(name, conus, atlas, goal, reach, count, walk):
    """Probes begin anywhere within `reach` of where they point."""
    for depths, part in (((0.0, np.inf), count - count // 4), ((0.3 * reach, 1.5 * reach), count // 4)):
        probes = [(goal(), in_box([-reach] * 3, [reach] * 3)) for _ in range(part)]
        probes = [[a + b for a, b in zip(target, beside)] + target for target, beside in probes]
        segments, again = compare(conus, atlas, probes, depths, walk)
        print(f"{name}, depths {depths}: {part} probes, {segments} segments, {again} of them in an area passed before")
        assert segments > part / 2 and again > part // 25


def main():
    conus, count, shared = sys.argv[1], int(sys.argv[2]), os.environ.get("CONUS_SHARED_DATA", sys.argv[3])
    random.seed(4)
    if os.path.exists(AAL):
        image = nibabel.load(AAL)
        volume = np.asanyarray(image.dataobj), np.linalg.inv(image.affine)
        run("AAL", conus, AAL, lambda: in_box((-60, -90, -40), (60, 60, 70)), 100, count,
            lambda *probe: in_volume(volume, *probe))
    folder = os.path.join(shared, ALLEN)
    if os.path.isdir(folder):
        areas = [(label, vertices, triangles) for (label, _), vertices, triangles in brainglobe(folder)]
        corners = np.concatenate([vertices for _, vertices, _ in areas])
        run("Allen", conus, folder, lambda: near(corners, 0.2), 4, count, lambda *probe: in_surfaces(areas, *probe))
    if not os.path.exists(AAL) and not os.path.isdir(folder):
        print(f"skipped: neither {AAL} nor {folder}")
        sys.exit(77)


main()
