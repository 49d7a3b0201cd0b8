# SPDX-License-Identifier: BSD-3-Clause
"""Needles on arcs (Eq. 26): all combinations of small instances, looked through one by one, and a foreign yardstick.

The poses are made of their arc and slider angles, so that nothing here measures these. What a needle has of its own is
what `conus plan` says of it alone."""
import itertools
import json
import pathlib
import sys

import numpy as np
import pytest

import conus
from support import call_conus

sys.path.append(str(pathlib.Path(__file__).parents[1] / "oracles"))
import certificate

EPS = 1e-9
#: Of tests/test_arc_angles.py of aind-mri-utils 0.13, degrees about the x and the y axis: one after the other they turn
#: the device's z to the way out.
COMPOUND = [(14, 20), (30, 30), (45, 20), (-25, 15), (10, -40)]


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def way_out(arc, slider):
    a, m = np.radians(arc), np.radians(slider)
    return np.array([np.sin(m), np.cos(m) * np.sin(a), np.cos(m) * np.cos(a)])


def write_poses(path, poses):
    """poses: (name, tip, way out, length)"""
    rows = ["query_id\tx\ty\tz\tdx\tdy\tdz\tfar"]
    rows += ["\t".join([name, *(f"{number:.17g}" for number in [*(tip + length * out), *-out, length])])
             for name, tip, out, length in poses]
    pathlib.Path(path).write_text("\n".join(rows) + "\n")


class Instance:
    """Some needles with some candidates each, and what is asked of them."""

    def __init__(self, seed):
        rng = np.random.default_rng(seed)
        pick = lambda *values: values[rng.integers(len(values))]
        self.count = int(rng.integers(2, 5))
        self.between = float(pick(0.2, 1, 3, 6))
        self.spacing = float(pick(5, 10, 16, 20))
        self.slider, self.same = pick(None, 5.0, 12.0), pick(None, 0.1, 2.0)
        self.most, self.each = pick(None, 1, 2, 3), pick(None, None, 1, 2)
        self.arcs = [pick("", "", "", "a", "b") for _ in range(self.count)]
        self.top = int(pick(1, 1, 2))
        self.items = []  # of each needle (name, arc, slider, tip, length)
        for i in range(self.count):
            self.items.append([])
            for c in range(int(rng.integers(3, 8))):
                arc = float(pick(-20, -10, -5, 0, 0, 5, 10, 20)) + pick(0, 0, 0.3, rng.uniform(-2, 2))
                slider = float(pick(-20, -8, 0, 4, 16)) + pick(0, 0, rng.uniform(-2, 2))
                tip = rng.uniform([-12, -12, 17], [12, 12, 24])
                self.items[i].append((f"n{i}-{c}", arc, slider, tip, float(rng.uniform(20, 40))))
        for i, items in enumerate(self.items):
            write_poses(f"{i}.tsv", [(name, tip, way_out(arc, slider), length) for name, arc, slider, tip, length in items])

    def ask(self):
        """Whether each candidate holds alone, its leeway and depth, nm; and the program's answer."""
        call_conus("phantom", "sphere", "-o", ".")
        self.alone = []
        for i in range(self.count):
            call_conus("plan", "sphere.nii.gz", "--poses", f"{i}.tsv", "--avoid", "Sphere,margin=0.5", "--infeasible", "--top",
                       "100", "-q", "--force", "-o", "alone.tsv")
            rows = {row["query"]: row for row in certificate.read_table("alone.tsv")}
            self.alone.append([(rows[name]["feasible"] == "1", certificate.nanometres_or_none(rows[name]["leeway_mm"]),
                                int(certificate.nanometres(float(rows[name]["far_mm"])))) for name, *_ in self.items[i]])
        table = "".join(f"{i}\t{i}.tsv\t{arc}\n" for i, arc in enumerate(self.arcs))
        pathlib.Path("needles.tsv").write_text("needle\tposes\tarc\n" + table)
        keys = "".join(f",{key}={value:g}" for key, value in (
            ("slider", self.slider), ("same", self.same), ("most", self.most), ("each", self.each)) if value is not None)
        more = ["--top", self.top, "--diverse", 0] if self.top > 1 else []
        call_conus("plan", "sphere.nii.gz", "--needles", "needles.tsv", "--avoid", "Sphere,margin=0.5", "--between",
                   self.between, "--arcs", f"{self.spacing:g}{keys}", *more, "-q", "-o", "plan.tsv", "--candidates",
                   "candidates.tsv", "--pairs", "pairs.tsv")
        return certificate.read_table("plan.tsv"), json.loads(pathlib.Path("plan.json").read_text())["Plan"]

    def pair(self, i, a, k, b):
        """The leeway of a pair, nm; None where it breaks."""
        (_, arc, slider, tip, length), (_, arc2, slider2, tip2, length2) = self.items[i][a], self.items[k][b]
        ways = [way_out(arc, slider) * length, way_out(arc2, slider2) * length2]
        distance = certificate.segments_distance(tip[None], ways[0][None], tip2[None], ways[1][None])[0, 0]
        slack = distance - self.between
        one_arc, other_arc = self.arcs[i], self.arcs[k]
        on_one = self.is_one(arc, arc2) and abs(slider - slider2) >= (self.slider or self.spacing) - EPS
        on_two = abs(arc - arc2) >= self.spacing - EPS
        if one_arc and other_arc:
            on_one, on_two = on_one and one_arc == other_arc, on_two and one_arc != other_arc
        return int(certificate.nanometres(slack / 2)) if slack > EPS and (on_one or on_two) else None

    def is_one(self, arc, other):
        return abs(arc - other) <= (0.5 if self.same is None else self.same) + EPS

    def on_arcs(self, chosen):
        """How many are on each arc."""
        arcs = [self.items[i][c][1] for i, c in enumerate(chosen)]
        sets = {frozenset(k for k, other in enumerate(arcs) if self.is_one(arc, other)) for arc in arcs}
        assert sum(map(len, sets)) == len(arcs), "being on one arc is no equivalence"
        return [len(one) for one in sets]

    def combinations(self, needles):
        """All combinations of these needles of which all pairs hold, with their key: larger is better."""
        domains = [[c for c, (holds, *_) in enumerate(self.alone[i]) if holds] for i in needles]
        pairs = {(i, a, k, b): self.pair(i, a, k, b) for i, k in itertools.combinations(needles, 2)
                 for a in domains[needles.index(i)] for b in domains[needles.index(k)]}
        for chosen in itertools.product(*domains):
            leeways = [pairs[i, a, k, b] for (i, a), (k, b) in itertools.combinations(zip(needles, chosen), 2)]
            if None not in leeways:
                own = [self.alone[i][c] for i, c in zip(needles, chosen)]
                yield (min(leeways + [leeway for _, leeway, _ in own]), sum(leeway for _, leeway, _ in own),
                       -sum(depth for *_, depth in own), *(-c for c in chosen)), chosen

    def is_within(self, chosen, most, each):
        arcs = self.on_arcs(chosen)
        return len(arcs) <= (most or 99) and max(arcs) <= (each or 99)


def check(seed):
    """Whether there was a combination."""
    instance = Instance(seed)
    rows, plan = instance.ask()
    whole = list(range(instance.count))
    fitting = list(instance.combinations(whole))
    found = sorted((one for one in fitting if instance.is_within(one[1], instance.most, instance.each)), reverse=True)
    assert [bool(entry["proven"]) for entry in plan["combinations"]] == [True] * min(len(found), instance.top)
    names = [row["query"] for row in rows]
    for n, (key, chosen) in enumerate(found[:instance.top]):
        mine = rows[n * instance.count:(n + 1) * instance.count]
        said = [certificate.nanometres_or_none(mine[0][name]) for name in ("all_leeway_mm", "all_sum_mm", "all_depth_mm")]
        assert np.abs(np.array(said) - [key[0], key[1], -key[2]]).max() <= 2 * instance.count
        wanted = [instance.items[i][c][0] for i, c in enumerate(chosen)]
        rivals = [other for other, _ in found if other[:2] != key[:2] and abs(other[0] - key[0]) <= 2]
        assert rivals or names[n * instance.count:(n + 1) * instance.count] == wanted
    assert len(rows) == instance.count * min(len(found), instance.top)
    if found:
        assert plan["conflict"] is None
        assert certificate.confirm("plan.tsv", "plan.json", "candidates.tsv") == min(len(found), instance.top)
        return "found"
    if fitting:  # limits of arcs alone
        least = lambda test: next((n for n in range(1, instance.count + 1) if any(test(n, one) for _, one in fitting)), None)
        most = least(lambda n, one: instance.is_within(one, n, instance.each)) if instance.most else None
        each = least(lambda n, one: instance.is_within(one, instance.most, n)) if instance.each else None
        assert plan["conflict"]["arcs"] == {"most": most, "each": each}
        assert plan["conflict"]["needles"] == [str(i) for i in whole]
        return "limits"
    sizes = (subset for size in whole for subset in itertools.combinations(whole, size + 1))
    first = next(list(subset) for subset in sizes if not any(True for _ in instance.combinations(list(subset))))
    assert plan["conflict"]["needles"] == [str(i) for i in first] and "arcs" not in plan["conflict"]
    return "pairs"


@pytest.mark.parametrize("group", range(6))
def test_small_instances_are_as_all_combinations(group):
    seen = []
    for seed in range(35 * group, 35 * group + 35):
        for path in pathlib.Path().iterdir():
            path.unlink()
        seen.append(check(seed))
    assert {"found", "limits", "pairs"} <= set(seen), "a kind of answer is not there: nothing is shown of it"


def test_candidates_at_angles_of_a_rig():
    call_conus("phantom", "sphere", "-o", ".")
    targets = [(0, 0, 10), (3, -4, 5)]
    pathlib.Path("targets.tsv").write_text("x\ty\tz\n" + "".join("%g\t%g\t%g\n" % target for target in targets))
    call_conus("plan", "sphere.nii.gz", "--from", "angles,arc=-15:10:5,slider=-8:8.5:4,back=45", "--toward", "targets.tsv", "--depth",
               "target+1", "--reach", "Sphere", "--infeasible", "--top", "1000", "-q", "-o", "plan.tsv", "--poses-out", "all.tsv")
    rows = {row["query_id"]: row for row in certificate.read_table("all.tsv")}
    grid = [(arc, slider) for arc in (-15, -10, -5, 0, 5, 10) for slider in (-8, -4, 0, 4, 8)]
    assert len(rows) == len(grid) * len(targets)
    for (e, (arc, slider)), (t, target) in itertools.product(enumerate(grid), enumerate(targets)):
        row = rows[f"e{e + 1}-t{t + 1}"]
        numbers = lambda *names: np.array([float(row[name]) for name in names])
        assert np.allclose(numbers("x", "y", "z"), np.array(target) + 45 * way_out(arc, slider), rtol=0, atol=1e-9)
        assert np.allclose(numbers("dx", "dy", "dz"), -way_out(arc, slider), rtol=0, atol=1e-12)
        assert float(row["far"]) == pytest.approx(46, abs=1e-9)


def test_needles_at_angles_of_a_rig_share_arcs():
    call_conus("phantom", "sphere", "-o", ".")
    pathlib.Path("needles.tsv").write_text("needle\ttoward\nA\ta.tsv\nB\tb.tsv\nC\tc.tsv\nD\td.tsv\n")
    for name, x in zip("abcd", (-6, -2, 2, 6)):
        pathlib.Path(f"{name}.tsv").write_text(f"x\ty\tz\n{x}\t{x / 2}\t15\n")
    call_conus("plan", "sphere.nii.gz", "--needles", "needles.tsv", "--from", "angles,arc=-40:40:4,slider=-40:40:4,back=20",
               "--depth", "target", "--reach", "Sphere,length=2", "--between", "1", "--arcs", "16,most=2,each=3", "-q", "-o",
               "plan.tsv", "--candidates", "candidates.tsv", "--pairs", "pairs.tsv")
    assert certificate.confirm("plan.tsv", "plan.json", "candidates.tsv") == 1
    pairs = certificate.read_table("pairs.tsv")
    on_one = [row for row in pairs if float(row["arc_deg"]) < 1e-9]
    assert len(on_one) in (2, 3) and all(float(row["slider_deg"]) >= 16 - 1e-9 for row in on_one)
    assert all(float(row["arc_deg"]) >= 16 - 1e-9 for row in pairs if row not in on_one)


def test_a_table_in_a_folder_has_angles_and_its_targets_beside_it():
    call_conus("phantom", "sphere", "-o", ".")
    pathlib.Path("sub").mkdir()
    grid = "angles,arc=-20:20:4,slider=-20:20:4,back=20"
    pathlib.Path("sub/needles.tsv").write_text(f"needle\ttoward\tfrom\nA\ta.tsv\t{grid}\nB\tb.tsv\t{grid}\n")
    for name, x in zip("ab", (-6, 6)):
        pathlib.Path(f"sub/{name}.tsv").write_text(f"x\ty\tz\n{x}\t{x / 2}\t15\n")
    call_conus("plan", "sphere.nii.gz", "--needles", "sub/needles.tsv", "--depth", "target", "--reach", "Sphere,length=2", "--arcs",
               "16,most=1", "-q", "-o", "plan.tsv")
    assert len(certificate.read_table("plan.tsv")) == 2
    assert b"identical" in call_conus("verify", "plan.tsv").stdout


def test_arcs_are_in_the_axes_of_one_space():
    """A grid of the CCF's size in a world that is turned by 10 degrees about the right-left axis."""
    turn = np.eye(4)
    turn[1:3, 1:3] = [[np.cos(np.radians(10)), -np.sin(np.radians(10))], [np.sin(np.radians(10)), np.cos(np.radians(10))]]
    grid = np.diag([0.2, -0.2, -0.2, 1])
    grid[:3, 3] = -5.6, 5.9, 3.9
    for name, arc, x in (("a", 10, -1), ("b", -20, 1)):
        write_poses(f"{name}.tsv", [(name, np.array([x, 0, 0]), way_out(arc, 0), 3)])
    box = conus.load(np.ones((57, 66, 40), "u2"), turn @ grid)
    ask = lambda spaces, arcs: box.plan_together({name: {"space": space, "poses": conus.read_poses(f"{name}.tsv")} for name, space in
                                                  zip("ab", spaces)}, reach={"1": 1}, arcs=arcs).pairs.to_dataframe()["arc_deg"]
    for spaces in (("ras", "lps"), ("ccf", "bregma")):
        assert np.allclose(ask(spaces, 16).astype(float), 30, atol=1e-5)
    for spaces in (("ras", "bregma"), ("ccf", "ras")):
        with pytest.raises(conus.ArgumentError, match="arcs: b: .* other axes than that of a"):
            ask(spaces, 16)
        assert len(ask(spaces, None)) == 1


def test_compound_angles_are_those_of_aind_mri_utils():
    call_conus("phantom", "sphere", "-o", ".")
    poses = []
    for n, (rx, ry) in enumerate(COMPOUND):
        x, y = np.radians(-rx), np.radians(ry)
        about_x = np.array([[1, 0, 0], [0, np.cos(x), -np.sin(x)], [0, np.sin(x), np.cos(x)]])
        about_y = np.array([[np.cos(y), 0, np.sin(y)], [0, 1, 0], [-np.sin(y), 0, np.cos(y)]])
        poses.append((str(n), np.array([50.0 * n, 0, 60]), (about_x @ about_y)[:, 2], 30))
    write_poses("given.tsv", poses)
    pathlib.Path("needles.tsv").write_text("needle\n" + "".join(f"{n}\n" for n in range(5)))
    call_conus("plan", "sphere.nii.gz", "--needles", "needles.tsv", "--given", "given.tsv", "--avoid", "Sphere", "-q", "-o",
               "plan.tsv", "--pairs", "pairs.tsv")
    pairs = certificate.read_table("pairs.tsv")
    assert len(pairs) == 10
    for row in pairs:
        (arc, slider), (other_arc, other_slider) = COMPOUND[int(row["needle"])], COMPOUND[int(row["other"])]
        assert float(row["arc_deg"]) == pytest.approx(abs(arc - other_arc), abs=1e-7)
        assert float(row["slider_deg"]) == pytest.approx(abs(slider - other_slider), abs=1e-7)
