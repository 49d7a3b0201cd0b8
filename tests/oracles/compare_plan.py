#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""conus plan --poses against constraints tried one by one (Eq. 17, 21, 22; needles.py, structures.py).

What is measured of every needle and constraint, verdicts, leeways, the funnel and the order of the list are
computed anew: on AAL, on a flipped and a sheared grid with a pathway and streamlines, on surfaces of the Allen atlas.
Lengths and distances agree within 1e-6 mm. A leeway is tried on both sides: with it the reach is long enough, with 2e-6
mm more it is not. Then: the same text as batch --segments and --clearance; the same bytes for any number of threads and
without pruning; of stricter constraints fewer poses; and of poses that are off by less than their leeway none breaks a
constraint.

usage: compare_plan.py CONUS PLAN_ALL SHARED_DATA; exit 77 = skipped."""

import csv
import os
import re
import subprocess
import sys
import tempfile

from compare_query import nibabel  # or skips
from compare_candidates import frame
from compare_clearance import AAL, ALLEN, GRIDS, LONG, as_kept, blobs, save, tolerance
from compare_scenes import brainglobe
import needles as by
import structures

import numpy as np

REACH = 1e-9  # mm, the least length where none is given
COLUMNS = "query_id x y z dx dy dz near far"
LEEWAYS = ("reach", "part", "tip", "avoid", "apart")


class Question:
    """Constraints, as options and as the oracle has them; structures: {name: Structure}."""

    plan_all = ""  # conus that measures everything of every pose

    def __init__(self, conus, atlas, constraints, found, radius=0.0, options=(), objects=None):
        """objects: {name: Structure} of each object there is, for what a needle meets first."""
        self.conus, self.atlas, self.constraints, self.radius = conus, atlas, constraints, radius
        self.structures, self.objects = found, objects
        self.options = [*options, *(["--radius", repr(radius)] if radius else [])]

    def arguments(self):
        words = []
        for kind, name, limit in self.constraints:
            if kind == "tip":
                words += ["--reach", f"{name},tip"]
            elif kind == "part":
                words += ["--reach", "{},length={!r},part={!r}:{!r}".format(name, *limit)]
            elif kind == "apart":
                words += ["--apart", f"{name},{limit[0]!r}"]
            elif kind in ("reach", "avoid"):
                key = "length" if kind == "reach" else "margin"
                words += [f"--{kind}", f"{name},{key}={limit!r}" if limit else name]
            else:
                words += [f"--{kind}", ",".join(map(repr, limit)) if limit else name]
        return words

    def run(self, table, folder, *more, program=None):
        """(rows of the list, rows of the constraints by pose, what is said on standard error, both texts)"""
        poses, plan, parts = (os.path.join(folder, name) for name in ("needles.tsv", "plan.tsv", "parts.tsv"))
        write_table(poses, table)
        done = subprocess.run([program or self.conus, "plan", self.atlas, "--poses", poses, *self.arguments(), *self.options,
                               "-o", plan, "--constraints", parts, "--force", *more], check=True, capture_output=True,
                              text=True)
        texts = [open(path, encoding="utf-8").read() for path in (plan, parts)]
        rows, verdicts = (list(csv.DictReader(text.splitlines(), delimiter="\t")) for text in texts)
        by_pose = {}
        for row in verdicts:
            by_pose.setdefault(row["query"], []).append(row)
        return rows, by_pose, done.stderr, texts

    def verdict(self, constraint, line):
        """(value, slack, whether it holds)"""
        kind, name, limit = constraint
        if kind in ("reach", "part"):
            value = self.structures[name].length(self.counted(constraint, line))
            least = (limit[0] if kind == "part" else limit) or REACH
            return value, value - least, value > least if least == REACH else value >= least
        if kind == "tip":
            inside = self.structures[name].has(line.origin + line.far * line.axis)
            return float(inside), float(inside) - 1, inside
        if kind == "avoid":
            distance = self.structures[name].nearest(line).distance
            slack = distance - self.radius - (limit or 0)
            return distance, slack, slack > 0
        if kind == "apart":
            value = by.segment_distance(line, line.far, *limit[1])[0].min()
            return value, value - limit[0], value > limit[0]
        if kind == "length":
            value = line.far - line.near
            slack = min(value - limit[0], limit[1] - value)
        elif kind == "lean":
            towards = np.array(limit[:3]) / np.linalg.norm(limit[:3])
            value = np.degrees(np.arctan2(np.linalg.norm(np.cross(line.axis, towards)), line.axis @ towards))
            slack = limit[3] - value
        elif kind == "first":
            value = float(self.first(line) in name.split(","))
            slack = value - 1
        return value, slack, slack >= 0

    def first(self, line):
        """Name of the object that is entered first."""
        entries = [(parts[0][0], name) for name, one in self.objects.items() for parts in [one.inside(line)] if parts]
        return min(entries)[1] if entries else ""

    @staticmethod
    def counted(constraint, line):
        """The part of the axis that counts."""
        if constraint[0] != "part":
            return line
        _, first, last = constraint[2]
        return line._replace(near=max(line.near, line.far - last), far=max(line.near, line.far - first))

    def check_leeway(self, constraint, line, leeway, slack):
        """It is as large as can be, up to 1e-6 mm."""
        kind, name, limit = constraint
        if kind in ("avoid", "apart"):
            return abs(leeway - slack) <= tolerance(leeway)
        if kind == "tip":
            return abs(self.structures[name].depth(line.origin + line.far * line.axis) - leeway) <= 1e-6 + tolerance(leeway)
        structure, least = self.structures[name], (limit[0] if kind == "part" else limit) or REACH
        counted = self.counted(constraint, line)
        rounding = 1e-8 * (1 + leeway)
        return (structure.length_below(counted, max(leeway - rounding, 0)) >= least - 1e-8
                and structure.length_below(counted, leeway + 1e-6 + rounding) < least + 1e-8)


def write_table(path, table):
    with open(path, "w", encoding="utf-8") as file:
        file.write("\t".join(COLUMNS.split()) + "\n")
        for number, row in enumerate(table, 1):
            file.write("\t".join([f"n{number}", *(repr(float(cell)) for cell in row)]) + "\n")


class Shanks(Question):
    """Parallel needles: each is a needle of its own, of which any, all, or one count."""

    def __init__(self, question, shanks, rules):
        """shanks: (n, 2) mm; rules: of each constraint "", "any", "all" or a number from 1."""
        super().__init__(question.conus, question.atlas, question.constraints, question.structures, 0.0,
                         question.options, question.objects)
        self.radius, self.shanks, self.rules = question.radius, np.array(shanks), rules
        self.options = [*self.options, "--shanks", ";".join(f"{x!r},{y!r}" for x, y in shanks)]

    def arguments(self):
        words = super().arguments()
        values = [k for k in range(1, len(words), 2) if words[k - 1] not in ("--length", "--lean")]
        for k, rule in zip(values, [rule for rule, one in zip(self.rules, self.constraints) if one[0] not in ("length", "lean")]):
            words[k] += f",shank={rule}" if rule else ""
        return words

    def counted_shanks(self, constraint):
        """(which ones count, whether any of them will do)"""
        rule = self.rules[self.constraints.index(constraint)]
        if isinstance(rule, int):
            return [rule - 1], False
        return range(len(self.shanks)), (rule or ("any" if constraint[0] in ("reach", "part", "tip") else "all")) == "any"

    def shank_lines(self, line):
        x, y = frame(line.axis)
        return [line._replace(origin=line.origin + a * x + b * y) for a, b in self.shanks]

    def verdict(self, constraint, line):
        which, is_any = self.counted_shanks(constraint)
        lines = self.shank_lines(line)
        verdicts = [super(Shanks, self).verdict(constraint, lines[k]) for k in which]
        return (max if is_any else min)(verdicts, key=lambda one: one[1])

    def check_leeway(self, constraint, line, leeway, slack):
        """The largest or the least: as one shank has it, and no other has more, or less."""
        which, is_any = self.counted_shanks(constraint)
        lines = [self.shank_lines(line)[k] for k in which]
        slacks = [super(Shanks, self).verdict(constraint, one) for one in lines]
        fits = [super(Shanks, self).check_leeway(constraint, one, leeway, verdict[1])
                for one, verdict in zip(lines, slacks) if verdict[2]]
        if constraint[0] == "avoid":
            held = [verdict[1] for verdict in slacks if verdict[2]]
            return abs(leeway - (max if is_any else min)(held)) <= tolerance(leeway)
        return any(fits)


def number(cell):
    return np.nan if cell == "n/a" else float(cell)


def check_pose(question, line, row, parts, counts):
    """Every verdict of one pose, and what the list says of all of them."""
    holds, leeways, slacks, clearances = [], [], [], []
    for constraint, part in zip(question.constraints, parts):
        value, slack, wanted = question.verdict(constraint, line)
        context = (constraint, part, value, slack, line)
        assert abs(number(part["value"]) - value) <= tolerance(value), context
        got = part["holds"] == "1"
        assert got == wanted or abs(slack) < 1e-6, context
        holds.append(got)
        if constraint[0] in LEEWAYS and got:
            leeways.append(number(part["leeway_mm"]))
            assert question.check_leeway(constraint, line, leeways[-1], slack), context
        if constraint[0] == "avoid":
            slacks.append(slack)
            clearances.append(value - question.radius)
        counts[constraint[0]] = counts.get(constraint[0], 0) + got
    assert (row["feasible"] == "1") == all(holds), (row, parts)
    assert (row["rank"] == "n/a") == (not all(holds)), row
    for column, wanted in (("slack_mm", slacks), ("clearance_mm", clearances), ("leeway_mm", leeways if all(holds) else [])):
        assert not wanted or abs(number(row[column]) - min(wanted)) <= tolerance(min(wanted)), (column, row, wanted)
    return holds


def check_order(rows, key, table):
    """Larger leeways first, of equal ones the shallower tip, then the first of the file; then those that break one."""
    feasible = [row for row in rows if row["feasible"] == "1"]
    assert rows[:len(feasible)] == feasible and [row["rank"] for row in feasible] == [str(k + 1) for k in range(len(feasible))]
    keys = [key(row) for row in feasible]
    assert keys == sorted(keys), [(a, b) for a, b in zip(keys, keys[1:]) if a > b]
    candidates = [int(row["query"][1:]) for row in rows[len(feasible):]]
    assert candidates == sorted(candidates) and len({row["query"] for row in rows}) == len(table)


def by_leeway(row):
    return -number(row["leeway_mm"]), number(row["far_mm"]), int(row["query"][1:])


def compare(name, question, table, folder):
    """The list of all poses. Gives its rows."""
    rows, parts, said, _ = question.run(table, folder, "--top", "all", "--infeasible")
    assert len(rows) == len(table) == len(parts), (len(rows), len(table))
    left, counts = [len(table)] + [0] * len(question.constraints), {}
    for row in rows:
        line = by.needle_from_row(table[int(row["query"][1:]) - 1])
        holds = check_pose(question, line, row, parts[row["query"]], counts)
        for k in range(len(holds)):
            left[k + 1] += all(holds[:k + 1])
    check_order(rows, by_leeway, table)
    funnel = [int(text.replace(",", "")) for text in re.findall(r"([\d,]*\d) (?:candidates|have|has|of these|of them)", said)]
    assert funnel == left, (funnel, left, said)
    print(f"{name}: {len(table)} needles, {left[1:]} left by one constraint after the other; single ones hold: {counts}")
    assert 0 < left[-1] < len(table), left
    return rows


def check_again(question, table, rows, folder):
    """B2: the same text as rows of batch."""
    poses, segments, clearances = (os.path.join(folder, name) for name in ("needles.tsv", "segments.tsv", "clear.tsv"))
    write_table(poses, table)
    for option, path in (("--segments", segments), ("--clearance", f"{clearances},within=1000")):
        subprocess.run([question.conus, "batch", question.atlas, "--poses", poses, option, path, "-q", "--force",
                        *question.options], check=True)
    found, near = {}, {}
    for path, into in ((segments, found), (clearances, near)):
        with open(path, encoding="utf-8", newline="") as file:
            for row in csv.DictReader(file, delimiter="\t"):
                into.setdefault((row["query"], row["name"]), []).append(row)
    same = 0
    for row in rows:
        reached = avoided = 0
        for kind, name, _ in question.constraints:
            if kind == "reach":
                reached += 1
                parts = [part for one in name.split(",") for part in found.get((row["query"], one), [])]
                if len(parts) == 1:
                    same += 1
                    assert row[f"reach{reached}_mm"] == parts[0]["length_mm"], (row, parts)
                else:
                    assert abs(number(row[f"reach{reached}_mm"]) - sum(float(p["length_mm"]) for p in parts)) < 1e-6, row
            elif kind == "avoid":
                avoided += 1
                parts = [part for one in name.split(",") for part in near[row["query"], one]]
                least = min(parts, key=lambda part: float(part["distance_mm"]))
                wanted = (least["distance_mm"], least["depth_mm"])
                tied = [(part["distance_mm"], part["depth_mm"]) for part in parts if part["distance_mm"] == wanted[0]]
                assert (row[f"avoid{avoided}_mm"], row[f"avoid{avoided}_at_mm"]) in tied, (row, parts)
                same += 1
    print(f"asked again: {same} cells have the same text")


def check_equal(question, table, folder):
    """B3: threads and pruning change no byte."""
    for top in (["--top", "all", "--infeasible"], ["--top", "5"]):
        wanted = question.run(table, folder, *top, "--threads", "1", program=question.plan_all)[3]
        for threads in ("1", "2", "7"):
            assert question.run(table, folder, *top, "--threads", threads)[3] == wanted, (top, threads)
        assert question.run(table, folder, *top, "--threads", "7", program=question.plan_all)[3] == wanted, top


def feasible(question, table, folder):
    return {row["query"] for row in question.run(table, folder, "--top", "all")[0]}


def check_monotone(question, table, folder, extra):
    """B5: of a larger margin, a longer reach or one constraint more fewer poses are left."""
    wanted, shrunk = feasible(question, table, folder), 0
    for k, (kind, name, limit) in enumerate(question.constraints):
        if kind in ("reach", "avoid"):
            question.constraints[k] = (kind, name, (limit or 0) + 1.0)
            fewer = feasible(question, table, folder)
            assert fewer <= wanted, (kind, name, fewer - wanted)
            shrunk += fewer < wanted
            question.constraints[k] = (kind, name, limit)
    question.constraints.append(extra)
    assert feasible(question, table, folder) <= wanted
    question.constraints.pop()
    assert shrunk


def off(random, row, delta):
    """A pose whose axis points all lie nearer than delta to those of a row: both ends do, and those between."""
    line = by.needle_from_row(row)
    ends = np.array([line.origin + t * line.axis for t in (line.near, line.far)])
    while True:
        moves = random.normal(size=(2, 3))
        moves *= delta * random.choice([1, 1, random.uniform()]) / np.linalg.norm(moves, axis=1, keepdims=True)
        axis = ends[1] + moves[1] - ends[0] - moves[0]
        axis /= np.linalg.norm(axis)
        begin = ends[0] + moves[0]
        if np.linalg.norm(begin + (line.far - line.near) * axis - ends[1]) < delta:
            return [*(begin - line.near * axis), *axis, line.near, line.far]


def check_leeways(question, table, rows, folder, random, count):
    """B9: none of many poses breaks a constraint that are off by less than 0.999 of the leeway."""
    chosen = [row for row in rows if row["feasible"] == "1" and number(row["leeway_mm"]) > 1e-3]
    moved = [off(random, table[int(row["query"][1:]) - 1], 0.999 * float(row["leeway_mm"]))
             for row in (chosen[k] for k in random.integers(0, len(chosen), count))]
    constraints = question.constraints
    question.constraints = [one for one in constraints if one[0] in LEEWAYS]
    broken = [row for row in question.run(moved, folder, "--top", "all", "--infeasible")[0] if row["feasible"] == "0"]
    question.constraints = constraints
    assert not broken, (broken[0], moved[int(broken[0]["query"][1:]) - 1])
    print(f"{count} poses off by less than their leeways: none breaks a constraint")


def check_ranks(question, table, folder):
    """Other keys, smaller first, and in steps."""
    for rank, key in (("slack,-depth", lambda row: (-number(row["slack_mm"]), number(row["far_mm"]))),
                      ("-reach,depth", lambda row: (number(row["reach1_mm"]), -number(row["far_mm"]))),
                      ("leeway/0.5,clearance/2,-reach", lambda row: (-np.floor(number(row["leeway_mm"]) / 0.5),
                                                                     -np.floor(number(row["clearance_mm"]) / 2),
                                                                     number(row["reach1_mm"])))):
        rows = question.run(table, folder, "--top", "all", "--rank", rank)[0]
        check_order(rows, lambda row: (*key(row), int(row["query"][1:])), rows)


def check_answers(question, table, folder, extra):
    """What must hold between answers."""
    check_equal(question, table, folder)
    check_monotone(question, table, folder, extra)
    check_ranks(question, table, folder)


def needles_towards(random, targets, count, low, high, beyond):
    """From a distance of low to high, and as far beyond the target."""
    table = []
    for target in targets[random.integers(0, len(targets), count)]:
        way = random.normal(size=3)
        way /= np.linalg.norm(way)
        away = random.uniform(low, high)
        table.append([*np.round(target + away * way, 4), *np.round(-way, 5), 0.0, round(away + random.uniform(-1, beyond), 4)])
    return table


def check_aal(conus, random, folder):
    image = nibabel.load(AAL)
    labels = np.asanyarray(image.dataobj)
    with open(AAL.replace(".gz", ".txt"), encoding="utf-8") as file:
        names = {row[1]: int(row[0]) for row in map(str.split, file) if row}

    def area(text):
        return structures.VoxelStructure(image.affine, np.isin(labels, [names[name] for name in text.split(",")]))

    constraints = [("reach", "Hippocampus_L", 5.0), ("avoid", "Insula_L", 2.0), ("avoid", "Thalamus_L,Putamen_L", 1.0),
                   ("length", "", (0.0, 75.0))]
    found = {name: area(name) for _, name, _ in constraints if name}
    found["ParaHippocampal_L"] = area("ParaHippocampal_L")
    question = Question(conus, AAL, constraints, found, 0.65)
    voxels = np.argwhere(labels == names["Hippocampus_L"])
    targets = voxels @ image.affine[:3, :3].T + image.affine[:3, 3] + random.uniform(-0.5, 0.5, voxels.shape)
    table = needles_towards(random, targets, 2000 if LONG else 30, 40, 80, 15)
    rows = compare("AAL", question, table, folder)
    best = [row for row in rows if row["feasible"] == "1"]
    spacious = max(best, key=lambda row: number(row["slack_mm"]))
    print(f"largest slack {spacious['slack_mm']} mm has a leeway of {spacious['leeway_mm']} mm; the best: {best[0]['slack_mm']}, "
          f"{best[0]['leeway_mm']} mm")
    check_again(question, table, rows, folder)
    if LONG:
        check_answers(question, table, folder, ("avoid", "ParaHippocampal_L", 0.5))
    check_leeways(question, table, rows, folder, random, 10000 if LONG else 500)
    question.constraints = [("reach", "Hippocampus_L", 0.0), ("tip", "ParaHippocampal_L", None), ("avoid", "Insula_L", 0.0),
                            ("lean", "", (0.3, 0.1, -1.0, 70.0))]
    compare("AAL, tip", question, table, folder)
    question.constraints = [("part", "Hippocampus_L", (2.0, 1.0, 12.5)), ("avoid", "Insula_L", 0.0)]
    rows = compare("AAL, part", question, table, folder)
    check_leeways(question, table, rows, folder, random, 10000 if LONG else 200)


def walks(random, path, affine, shape):
    """A tractogram of random walks in a grid, and its capsules."""
    points = [(random.normal(size=(20, 3)).cumsum(0) + random.uniform(0, 1, 3) * shape) for _ in range(3)]
    lines = [(line @ affine[:3, :3].T + affine[:3, 3]).astype("f4") for line in points]
    nibabel.streamlines.save(nibabel.streamlines.Tractogram(lines, affine_to_rasmm=np.eye(4)), path)
    bundle = structures.Structure()
    bundle.pieces = by.Capsules({1: (lines, 0.25)})
    return bundle


def check_grid(conus, random, folder, name, count):
    shape, path, image = (24, 20, 16), os.path.join(folder, "blobs.nii"), os.path.join(folder, "map.nii")
    labels = blobs(random, shape, 12)
    affine = save(path, labels, GRIDS[name])
    values = (random.uniform(size=(7, 6, 5)) > 0.9).astype("f4")
    other = save(image, values, np.array([[2.0, 0.1, 0, -4], [0, 2, 0, -1], [0.3, 0, 3, -12], [0, 0, 0, 1]]))
    found = {text: structures.VoxelStructure(affine, np.isin(labels, list(map(int, text.split(",")))))
             for text in ("3,4", "6", "7,8", "9")}
    found["Vessels"] = structures.VoxelStructure(other, values >= 0.5)
    objects = {str(label): structures.VoxelStructure(affine, labels == label) for label in range(1, 13)}
    objects["Vessels"] = found["Vessels"]
    constraints = [("reach", "3,4", 1.5), ("avoid", "6", 0.5), ("avoid", "7,8", 0.0), ("avoid", "Vessels", 0.3)]
    question = Question(conus, path, constraints, found, 0.2, ["--pathway", f"{image},threshold=0.5,name=Vessels"], objects)
    voxels = np.argwhere(np.isin(labels, [3, 4]))
    table = needles_towards(random, voxels @ affine[:3, :3].T + affine[:3, 3], 500 if LONG else count, 5, 30, 8)
    table += table[:3]  # equal poses are listed in their order
    rows = compare(f"grid {name}", question, table, folder)
    check_answers(question, table, folder, ("avoid", "9", 0.5))
    check_leeways(question, table, rows, folder, random, 10000 if LONG else 500)
    if LONG or count > 20:  # of one grid
        check_shanks(question, table if LONG else table[:14], folder, f"grid {name}")
    question.constraints = [("first", "3,4", None), ("reach", "3,4", 0.0)]
    compare(f"grid {name}, first", question, table, folder)
    others, walk = os.path.join(folder, "others.tsv"), os.path.join(folder, "walks.tck")
    write_table(others, table[5:8])
    ends = np.array([[line.origin + t * line.axis for t in (line.near, line.far)]
                     for line in map(by.needle_from_row, table[5:8])])
    question.structures["walks"] = walks(random, walk, affine, shape)
    question.options += ["--streamlines", f"{walk},radius=0.25"]
    question.constraints = [("avoid", "walks", 0.1), ("apart", others, (0.75, (ends[:, 0], ends[:, 1])))]
    rows = compare(f"grid {name}, apart", question, table, folder)
    check_leeways(question, table, rows, folder, random, 10000 if LONG else 500)


def check_shanks(question, table, folder, targets):
    """Four shanks: what any of them reaches and all keep clear of; others, by their numbers."""
    kept = question.constraints
    for rules in (["", "", "any", ""], [2, "all", 1, "all"]):
        question.constraints = kept
        probe = Shanks(question, [(-1.5, 0.0), (-0.5, 0.0), (0.5, 0.25), (1.5, 0.0)], rules)
        compare(f"{targets}, shanks {rules}", probe, table, folder)
        check_equal(probe, table, folder)


def check_surfaces(conus, random, folder, path):
    areas = {label: as_kept(vertices)[triangles] for (label, _), vertices, triangles in brainglobe(path)}
    label, avoided = 1061, [1029, 968]
    found = {str(label): structures.SurfaceStructure({label: areas[label]}),
             ",".join(map(str, avoided)): structures.SurfaceStructure({one: areas[one] for one in avoided})}
    question = Question(conus, path, [("reach", str(label), 0.05), ("avoid", ",".join(map(str, avoided)), 0.1)], found, 0.035)
    table = needles_towards(random, areas[label].mean(1), 500 if LONG else 12, 3, 8, 1)
    rows = compare("Allen", question, table, folder)
    check_leeways(question, table, rows, folder, random, 10000 if LONG else 300)


def main():
    conus, shared = sys.argv[1], os.environ.get("CONUS_SHARED_DATA", sys.argv[3])
    Question.plan_all = sys.argv[2]
    random = np.random.default_rng(22)
    with tempfile.TemporaryDirectory() as folder:
        check_grid(conus, random, folder, "flipped, of three sizes", 25)
        check_grid(conus, random, folder, "sheared", 9)
        if os.path.exists(AAL):
            check_aal(conus, random, folder)
        if os.path.isdir(os.path.join(shared, "meshes")):
            check_surfaces(conus, random, folder, os.path.join(shared, ALLEN))


if __name__ == "__main__":
    main()
