#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""conus query with streamlines against all segments one by one (Eq. 19): which come in, how long, and the nearest point.

The segments are those of random walks in a tractogram. For each, the distances along it at which it may cross the
region's border (planes, and the roots of the quadratic by the school formula) are sorted, and the middle of each piece
between them is asked whether it is inside. There is no tree, no convexity and no special case. A thousand cones,
cylinders and balls, with and without a range: the numbers of streamlines must be equal, and lengths, nearest
points and places along the bundle within 1e-5 mm (the numbers of the tables have 9 digits).

usage: compare_streamlines.py CONUS QUESTIONS; exit 77 = skipped."""
import csv
import math
import subprocess
import sys
import tempfile

try:
    import numpy as np
except ImportError:
    print("numpy is not installed")
    sys.exit(77)

TOLERANCE = 1e-5
EMPTY = np.array([[np.nan] * 3], "f4")


def walks(random, count):
    """Streamlines of 2 to 60 steps of 2 mm."""
    lines = []
    for _ in range(count):
        steps = random.normal(size=(random.integers(1, 60), 3)).cumsum(0) * 0.3 + random.normal(size=3)
        steps *= 2 / np.linalg.norm(steps, axis=1, keepdims=True)
        lines.append((np.vstack([np.zeros(3), steps.cumsum(0)]) + random.uniform(-50, 50, 3)).astype("f4"))
    return lines


def save(path, lines):
    head = f"mrtrix tracks\ndatatype: Float32LE\ncount: {len(lines)}\nfile: . 100\nEND\n".encode()
    points = np.vstack([part for line in lines for part in (line, EMPTY)] + [np.full((1, 3), np.inf, "f4")])
    with open(path, "wb") as file:
        file.write(head.ljust(100, b"\0") + points.astype("<f4").tobytes())


def frame(direction):
    """right, up, forward; which way is up matters to a pyramid alone."""
    z = direction / np.linalg.norm(direction)
    helper = np.array([0.0, 0, 1]) if abs(z[2]) < 0.9 else np.array([0.0, 1, 0])
    y = helper - (helper @ z) * z
    y /= np.linalg.norm(y)
    return np.stack([np.cross(z, y), y, z])


def has(question, p):
    """Whether points, in the frame of the device, are in the region."""
    x, y, z = p[..., 0], p[..., 1], p[..., 2]
    if question["shape"] == "ball":
        return x * x + y * y + z * z <= question["radius"] ** 2
    rim = question["radius"] if question["shape"] == "cylinder" else z * question["slope"]
    near, far = question["range"] or (0, math.inf)
    return (near <= z) & (z <= far) & (x * x + y * y <= rim * rim)


def cuts(question, a, u):
    """s of each segment a + s u at which it may cross the border, sorted between 0 and 1: (segments, cuts)."""
    weights = {"ball": (1, 1, 1), "cylinder": (1, 1, 0), "cone": (1, 1, -question["slope"] ** 2)}[question["shape"]]
    inner = lambda p, q: (p * q * np.array(weights)).sum(1)
    square, mixed, rest = inner(u, u), inner(a, u), inner(a, a) - question["radius"] ** 2
    with np.errstate(all="ignore"):
        root = np.sqrt(mixed * mixed - square * rest)
        found = [(-mixed - root) / square, (-mixed + root) / square, np.zeros(len(a)), np.ones(len(a))]
        found += [(depth - a[:, 2]) / u[:, 2] for depth in question["range"] or (0,)]
    found = np.stack(found, 1)
    return np.sort(np.clip(np.where(np.isfinite(found), found, 0), 0, 1), 1)


def answer(question, bundle):
    """(streamlines, mm, nearest distance, along) by all segments."""
    a, u, owner, lengths = bundle["a"], bundle["u"], bundle["owner"], bundle["lengths"]
    origin = np.array(question["origin"])
    axes = frame(np.array(question["direction"])) if question["shape"] != "ball" else np.eye(3)
    v, w = (a - origin) @ axes.T, u @ axes.T
    s = cuts(question, v, w)
    middle = (s[:, :-1] + s[:, 1:]) / 2
    inside = has(question, v[:, None] + middle[..., None] * w[:, None]) & (s[:, 1:] > s[:, :-1])
    mm = (inside * np.diff(s, axis=1)).sum(1) * lengths
    foot = -(v * w).sum(1) / (w * w).sum(1)
    at = np.clip(foot[:, None], s[:, :-1], s[:, 1:])
    away = np.where(inside, np.linalg.norm(v[:, None] + at[..., None] * w[:, None], axis=2), np.inf)
    best = np.unravel_index(away.argmin(), away.shape)
    k = owner[best[0]]
    mine = np.flatnonzero(owner == k)
    along = (lengths[mine[mine < best[0]]].sum() + at[best] * lengths[best[0]]) / lengths[mine].sum()
    ends, longest = bundle["ends"][k], bundle["longest"]
    like = np.linalg.norm(ends - longest, axis=1).sum()
    unlike = np.linalg.norm(ends - longest[::-1], axis=1).sum()
    return len(np.unique(owner[inside.any(1)])), mm.sum(), away[best], 1 - along if unlike < like else along


def prepare(lines):
    """All segments of streamlines, as double."""
    whole = [np.asarray(line, float) for line in lines]
    owner = np.concatenate([np.full(len(line) - 1, k) for k, line in enumerate(whole)])
    u = np.concatenate([np.diff(line, axis=0) for line in whole])
    lengths = np.linalg.norm(u, axis=1)
    longest = whole[np.argmax(np.bincount(owner, lengths))]
    return {"a": np.concatenate([line[:-1] for line in whole]), "u": u, "owner": owner, "lengths": lengths,
            "ends": np.stack([line[[0, -1]] for line in whole]), "longest": longest[[0, -1]]}


def ask(conus, folder, questions):
    """The rows of the bundle, by question, of one run: all have one shape and range."""
    first = questions[0]
    is_ball, is_cone = first["shape"] == "ball", first["shape"] == "cone"
    path = f"{folder}/run_electrodes.tsv" if is_ball else f"{folder}/run.tsv"
    columns = ["size"] if is_ball else ["dx", "dy", "dz"] + ["angle"] * is_cone
    with open(path, "w", encoding="ascii") as file:
        file.write("\t".join(["name", "x", "y", "z", *columns]) + "\n")
        for i, q in enumerate(questions):
            numbers = [*q["origin"], *([1] if is_ball else [*q["direction"]] + [q["degrees"]] * is_cone)]
            file.write("\t".join([str(i), *(repr(float(n)) for n in numbers)]) + "\n")
    options = ["--radius", repr(first["radius"])] if first["radius"] else []
    options += ["--range", "{!r},{!r}".format(*first["range"])] if first["range"] else []
    text = subprocess.run(
        [conus, "query", f"{folder}/slabs.nii.gz", "--streamlines", f"{folder}/walks.tck", "--pose", path,
         "--layers", "all", "--resolution", "1", "--format", "tsv", "-q", *options],
        check=True, capture_output=True, text=True).stdout
    return {int(row["query"]): row for row in csv.DictReader(text.splitlines(), delimiter="\t")
            if row["kind"] == "bundle"}


def make_questions(random, count):
    """Lists of questions that one run answers."""
    runs = []
    for i in range(20):
        shape = ("cone", "cylinder", "ball", "cone")[i % 4]
        radius = 0 if shape == "cone" else float(np.round(10 ** random.uniform(-0.3, 1.5), 3))
        depths = tuple(np.round(np.sort(random.uniform(0, 90, 2)), 3).tolist()) if i % 8 > 3 and shape != "ball" else None
        run = []
        for _ in range(count // 20):
            degrees = float(np.round(random.uniform(1, 100), 4)) if shape == "cone" else 0
            run.append({"shape": shape, "radius": radius, "range": depths, "degrees": degrees,
                        "slope": math.tan(math.radians(degrees) / 2), "origin": random.uniform(-60, 60, 3).round(4),
                        "direction": random.normal(size=3).round(4)})
        runs.append(run)
    return runs


def check(row, question, wanted):
    """The difference in mm of what has to be equal but for rounding."""
    streamlines, mm, away, along = wanted
    where = f"{question}: {row}"
    if not streamlines:
        assert row is None or row["streamlines"] == "0", where
        return 0
    assert row and int(row["streamlines"]) == streamlines, where
    near = np.array([float(row[f"near_{axis}"]) for axis in "xyz"])
    off = max(abs(float(row["length_mm"]) - mm) / max(1, mm), abs(np.linalg.norm(near - question["origin"]) - away),
              abs(float(row["along"]) - along))
    assert off < TOLERANCE, f"{where}: {wanted}"
    return off


def main():
    conus, count = sys.argv[1], int(sys.argv[2])
    random = np.random.default_rng(19)
    lines = walks(random, 150)
    bundle = prepare(lines)
    worst, found = 0, 0
    with tempfile.TemporaryDirectory() as folder:
        save(f"{folder}/walks.tck", lines)
        subprocess.run([conus, "phantom", "slabs", "-o", folder, "--size", "16"], check=True, capture_output=True)
        for run in make_questions(random, count):
            rows = ask(conus, folder, run)
            for i, question in enumerate(run):
                wanted = answer(question, bundle)
                found += wanted[0] > 0
                worst = max(worst, check(rows.get(i), question, wanted))
    print(f"{count} regions, {found} with streamlines of {len(lines)}: numbers equal, the rest within {worst:.2g} mm")
    assert found > count / 3


main()
