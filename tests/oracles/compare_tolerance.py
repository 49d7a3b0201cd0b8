#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""conus plan --tolerance against verdicts of poses that are off (Eq. 23; compare_plan.py's, needles.py).

Each listed needle is moved along each degree of freedom, and its constraints are tried by brute force: at places up to
holds_to every one holds, and at fails_at the one breaks that is named. Motions are made here, from Eq. 2 and rotations by
Rodrigues' formula. On AAL, and on a flipped grid. Probabilities of --jitter (Eq. 14) are compared with those of pseudo-random
normal errors of our own, within 4.5 standard errors and 0.01.

usage: compare_tolerance.py CONUS SHARED_DATA; exit 77 = skipped."""

import csv
import os
import subprocess
import sys
import tempfile

from compare_query import nibabel  # or skips
from compare_candidates import frame, to_world
from compare_clearance import AAL, GRIDS, LONG, blobs, save
from compare_plan import Question, needles_towards, number, write_table
import needles as by
import structures

import numpy as np

TURNS = ("pitch", "yaw", "azimuth", "elevation")
PLACES = 100 if LONG else 6
NEAR = 2e-6  # mm or degrees that a verdict may be off


def turned(vector, axis, angle):
    return (np.cos(angle) * vector + np.sin(angle) * np.cross(axis, vector)
            + (1 - np.cos(angle)) * (axis @ vector) * axis)


def moved(line, freedom, amount, pivot):
    """The needle that is off by so many mm or degrees."""
    x, y = frame(line.axis)
    shifts = {"x": np.eye(3)[0], "y": np.eye(3)[1], "z": np.eye(3)[2], "side": x, "up": y}
    if freedom in shifts:
        return line._replace(origin=line.origin + amount * shifts[freedom])
    if freedom == "depth":
        return line._replace(far=line.far + amount)
    about = {"pitch": x, "yaw": y, "azimuth": np.array([0, 0, 1.0])}.get(freedom)
    if about is None:  # towards +z: about the line that is across both
        about = np.cross(line.axis, [0, 0, 1.0])
        about /= np.linalg.norm(about)
    centre = line.origin + pivot * line.axis
    angle = np.radians(amount)
    return line._replace(origin=centre + turned(line.origin - centre, about, angle), axis=turned(line.axis, about, angle))


def holds(question, line):
    """Whether all constraints hold, and the least slack of one that breaks or holds."""
    verdicts = [question.verdict(constraint, line) for constraint in question.constraints]
    return all(one[2] for one in verdicts), [one[1] for one in verdicts]


def check_row(question, line, row, pivot, counts):
    freedom, sign = row["freedom"], -1 if row["side"] == "-" else 1
    kept, fails = number(row["holds_to"]), number(row["fails_at"])
    cap = 30 if freedom in TURNS else 20
    unit = {"depth": line.far - line.near}.get(freedom, cap) if sign < 0 else cap
    assert 0 <= kept <= cap + 1e-9, row

    def verdict(amount):
        return holds(question, moved(line, freedom, sign * amount, pivot))

    places = np.linspace(0, max(kept - NEAR, 0), PLACES)
    for place in places:
        fine, slacks = verdict(place)
        assert fine, (row, place, slacks)
    if np.isnan(fails):
        assert kept >= min(cap, unit) - 1e-6, (row, cap, unit)
    else:
        fine, slacks = verdict(fails)
        assert not fine or min(np.abs(slacks)) < 1e-6, (row, slacks)
        if not fine:
            worst = [name.replace(",", ", ") or kind for (kind, name, _), slack in zip(question.constraints, slacks) if slack <= 0]
            assert row["breaks"] in worst, (row, worst)
        counts["exact"] += fails - kept < 3e-6
    counts["rows"] += 1


def ask(question, table, folder, pivot, top):
    poses, rows = os.path.join(folder, "needles.tsv"), os.path.join(folder, "tolerance.tsv")
    write_table(poses, table)
    subprocess.run([question.conus, "plan", question.atlas, "--poses", poses, *question.arguments(), *question.options, "--top",
                    str(top), "--tolerance", rows, "--pivot", pivot, "-o", os.path.join(folder, "plan.tsv"), "-q", "--force"],
                   check=True)
    with open(rows, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file, delimiter="\t"))


def compare(name, question, table, folder, top):
    counts = {"rows": 0, "exact": 0}
    for pivot in ("entry", "tip", "10"):
        for row in ask(question, table, folder, pivot, top):
            line = by.needle_from_row(table[int(row["query"][1:]) - 1])
            centre = {"entry": 0.0, "tip": line.far}.get(pivot)
            check_row(question, line, row, 10.0 if centre is None else centre, counts)
    assert counts["rows"] == 3 * 20 * top, counts
    print(f"{name}: {counts}")


def tilted(random, line, degrees, mm):
    x, y = frame(line.axis)
    about = np.radians(degrees) * (random.normal() * x + random.normal() * y)
    angle = np.linalg.norm(about)
    return line._replace(origin=line.origin + mm * random.normal(size=3), axis=turned(line.axis, about / angle, angle))


def between_ends(random, line, entry, target, depth):
    x, y = frame(line.axis)
    begin = line.origin + entry * (random.normal() * x + random.normal() * y)
    end = line.origin + line.far * line.axis + target * (random.normal() * x + random.normal() * y)
    return line._replace(origin=begin, axis=(end - begin) / np.linalg.norm(end - begin), far=line.far + depth * random.normal())


def check_jitter(name, question, table, folder, random, top):
    samples = 3000 if LONG else 300
    needles, path, worst, count = (*(os.path.join(folder, file) for file in ("needles.tsv", "jitter.tsv")), 0.0, 0)
    write_table(needles, table)
    for words, scatter, sizes in (("2,0.7", tilted, (2, 0.7)),
                                  ("entry=0.6,target=1.1,depth=0.8", between_ends, (0.6, 1.1, 0.8))):
        subprocess.run([question.conus, "plan", question.atlas, "--poses", needles, *question.arguments(), *question.options,
                        "--top", str(top), "--rank", "p_ok", "--jitter", words, "--samples", "4096", "-o", path, "-q",
                        "--force"], check=True)
        with open(path, encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file, delimiter="\t"))
        assert len(rows) == top, (name, len(rows))
        assert [number(row["p_ok"]) for row in rows] == sorted((number(row["p_ok"]) for row in rows), reverse=True), rows
        kinds = [kind for kind, _, _ in question.constraints]
        columns = [f"p_{kind}{kinds[:k + 1].count(kind)}" for k, kind in enumerate(kinds)]
        for row in rows[::max(1, top // 2)]:
            line = by.needle_from_row(table[int(row["query"][1:]) - 1])
            held = np.array([[question.verdict(constraint, off)[2] for constraint in question.constraints]
                             for off in (scatter(random, line, *sizes) for _ in range(samples))])
            for p, own in zip([number(row[column]) for column in ("p_ok", *columns)], [held.all(axis=1).mean(), *held.mean(axis=0)]):
                assert abs(p - own) < 4.5 * np.sqrt(p * (1 - p) / samples) + 0.01, (name, words, row, own, held.mean(axis=0))
                worst, count = max(worst, abs(p - own)), count + 1
    print(f"{name}: {count} probabilities, at most {worst:.3f} from those of {samples} random poses")


def check_grid(conus, random, folder):
    path = os.path.join(folder, "blobs.nii")
    labels = blobs(random, (24, 20, 16), 12)
    affine = save(path, labels, GRIDS["flipped, of three sizes"])
    found = {text: structures.VoxelStructure(affine, np.isin(labels, list(map(int, text.split(",")))))
             for text in ("3,4", "6", "7,8")}
    question = Question(conus, path, [("reach", "3,4", 1.5), ("avoid", "6", 0.5), ("avoid", "7,8", 0.0),
                                      ("lean", "", (0.0, 0.0, -1.0, 120.0)), ("length", "", (3.0, 50.0))], found, 0.2)
    voxels = to_world(affine, np.argwhere(np.isin(labels, [3, 4])))
    table = needles_towards(random, voxels, 60, 5, 30, 8)
    compare("grid", question, table, folder, 10 if LONG else 2)
    check_jitter("grid", question, table, folder, random, 4)


def check_aal(conus, random, folder):
    image = nibabel.load(AAL)
    labels = np.asanyarray(image.dataobj)
    with open(AAL.replace(".gz", ".txt"), encoding="utf-8") as file:
        names = {row[1]: int(row[0]) for row in map(str.split, file) if row}
    constraints = [("reach", "Hippocampus_L", 5.0), ("avoid", "Insula_L", 2.0), ("avoid", "Putamen_L", 1.0)]
    found = {name: structures.VoxelStructure(image.affine, labels == names[name]) for _, name, _ in constraints}
    question = Question(conus, AAL, constraints, found, 0.65)
    targets = to_world(image.affine, np.argwhere(labels == names["Hippocampus_L"]))
    table = needles_towards(random, targets, 200, 40, 80, 15)
    compare("AAL", question, table, folder, 10 if LONG else 1)
    if LONG:
        check_jitter("AAL", question, table, folder, random, 4)


def main():
    conus = sys.argv[1]
    random = np.random.default_rng(24)
    with tempfile.TemporaryDirectory() as folder:
        check_grid(conus, random, folder)
        if os.path.exists(AAL):
            check_aal(conus, random, folder)


if __name__ == "__main__":
    main()
