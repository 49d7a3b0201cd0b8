# SPDX-License-Identifier: BSD-3-Clause
"""Windows of arcs (Eq. 22, 26) and covers (Eq. 27): angles and contacts by numpy from the poses alone, and all combinations
of small instances, looked through one by one. What a needle has of its own is what `conus plan` says of it alone."""
import gzip
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
SHELLS = {"ShO": 1, "ShI": 300, "Cor": 4000000001}


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    call_conus("phantom", "nested", "-o", ".")


def voxels():
    """Labels [x, y, z], and the affine, of the phantom's file."""
    data = gzip.decompress(pathlib.Path("nested.nii.gz").read_bytes())
    dim = np.frombuffer(data, "<i2", 3, 42)
    affine = np.vstack([np.frombuffer(data, "<f4", 12, 280).reshape(3, 4), [0, 0, 0, 1]]).astype(float)
    start = int(np.frombuffer(data, "<f4", 1, 108)[0])
    return np.frombuffer(data, "<u4", int(np.prod(dim)), start).reshape(dim, order="F"), affine


def unit(vector):
    return vector / np.linalg.norm(vector)


def angles(out):
    """Arc and slider angle, degrees, of ways out (n, 3) with right, anterior, dorsal."""
    return np.degrees([np.arctan2(out[:, 1], out[:, 2]), np.arcsin(out[:, 0])])


def table(path, columns, rows):
    pathlib.Path(path).write_text("\n".join("\t".join(f"{cell:.17g}" if isinstance(cell, float) else str(cell) for cell in row)
                                            for row in [columns, *rows]) + "\n")


@pytest.mark.parametrize("seed", range(20))
def test_windows_hold_as_numpy_says(seed):
    """Ten windows a seed, of random poses in two spaces, with and without a pitch."""
    rng = np.random.default_rng(seed)
    out = np.array([unit(v) for v in rng.normal(size=(60, 3))])
    table("poses.tsv", ["query_id", "x", "y", "z", "dx", "dy", "dz", "far"],
          [[f"p{i}", *(30 * v).tolist(), *(-v).tolist(), 30.0] for i, v in enumerate(out)])
    for _ in range(10):
        space = str(rng.choice(["ras", "lps"]))
        arc, slider = angles(out * (1 if space == "ras" else np.array([-1, -1, 1])))
        window = [np.sort(rng.uniform(-360, 360, 2)), np.sort(rng.uniform(-90, 90, 2))]
        if rng.random() < 0.5:  # an end at a pose's own angle belongs to it
            window[0][0], window[1][1] = arc[0], slider[0]
            window = [np.sort(w) for w in window]
        window[0][1] = min(window[0][1], window[0][0] + 360)
        turns = np.array([-720, -360, 0, 360, 720])
        in_arc = ((arc[:, None] + turns >= window[0][0] - EPS) & (arc[:, None] + turns <= window[0][1] + EPS)).any(1)
        wanted = in_arc & (slider >= window[1][0] - EPS) & (slider <= window[1][1] + EPS)
        text = ",".join(":".join(f"{end:.17g}" for end in w) for w in window)
        call_conus("plan", "nested.nii.gz", "--poses", "poses.tsv", "--space", space, "--reach", "Cor", f"--arc-window={text}", "--top",
                   "all", "--infeasible", "--format", "tsv", "-q", "--force", "-o", "plan.tsv")
        rows = {row["query"]: row for row in certificate.read_table("plan.tsv")}
        assert [rows[f"p{i}"]["feasible"] for i in range(60)] == ["1" if holds else "0" for holds in wanted]
        said = np.array([[float(rows[f"p{i}"][name]) for i in range(60)] for name in ("arc1_deg", "slider1_deg")])
        away = said - [arc, slider]
        assert np.abs(away - 360 * np.round(away / 360)).max() <= 1e-6


def test_along_the_axis_of_the_rig_the_arc_angle_is_0():
    """However its zeros are signed, and whatever rounding leaves of them: one needle has one angle."""
    columns = ["query_id", "x", "y", "z", "dx", "dy", "dz", "far"]
    rests = ["0", "-0", "1e-17", "-1e-17"]
    table("poses.tsv", columns, [[f"p{side}{i}{k}", str(40 * side), "0", "0", str(-side), a, b, "40"]
                                 for side in (1, -1) for i, a in enumerate(rests) for k, b in enumerate(rests)])
    call_conus("plan", "nested.nii.gz", "--poses", "poses.tsv", "--arc-window=-1:1,-90:90", "--top", "all", "--infeasible",
               "-q", "-o", "plan.tsv")
    rows = certificate.read_table("plan.tsv")
    assert len(rows) == 32
    assert {(row["feasible"], row["arc1_deg"], abs(float(row["slider1_deg"]))) for row in rows} == {("1", "0", 90.0)}


def test_windows_and_grids_count_from_the_pitch():
    pathlib.Path("target.tsv").write_text("x\ty\tz\n0\t0\t0\n")
    pathlib.Path("needles.tsv").write_text("needle\nA\n")
    ask = ["plan", "nested.nii.gz", "--needles", "needles.tsv", "--from", "angles,arc=-30:30:10,slider=-20:20:10,back=30",
           "--toward", "target.tsv", "--depth", "target", "--reach", "Cor", "--arc-window=10:20,-10:0", "-q", "-o", "plan.tsv",
           "--candidates", "candidates.tsv", "--force"]
    for pitch in (0, 14, -14):
        call_conus(*ask, "--arcs", f"16,pitch={pitch}")
        rows = certificate.read_table("candidates.tsv")
        arc, slider = angles(-np.array([[float(row[name]) for name in ("dx", "dy", "dz")] for row in rows]))
        assert {(round(a + pitch, 6), round(m, 6) + 0.0) for a, m in zip(arc, slider)} <= {(a, m) for a in (10, 20) for m in (-10, 0)}
        placed = certificate.read_table("plan.tsv")[0]
        arc, slider = angles(-np.array([[float(placed[name]) for name in ("dx", "dy", "dz")]]))
        assert np.allclose([float(placed["arc_deg"]), float(placed["slider_deg"])], [arc[0] + pitch, slider[0]], atol=1e-6)
        feasible = json.loads(pathlib.Path("plan.json").read_text())["Plan"]["rows"][0]["feasible"]
        assert feasible == 4


class Instance:
    """Some needles with some candidates each, contacts and shanks, and what they are to cover."""

    def __init__(self, seed):
        rng = np.random.default_rng(1000 + seed)
        pick = lambda *values: values[rng.integers(len(values))]
        self.count, self.top = int(rng.integers(2, 5)), int(pick(1, 1, 2))
        self.between, self.entries = float(pick(0.1, 1, 4, 8)), float(pick(0, 0, 8))
        self.contacts = [(int(rng.integers(2, 10)), int(pick(1, 1, 2)), float(pick(0.7, 2, 3.5)), float(pick(0, 0.5, 2)))
                         for _ in range(self.count)]
        self.shanks = [pick([(0, 0)], [(0, 0)], [(-1, 0), (1, 0)], [(0, -0.5), (0, 1.5), (2, 0)]) for _ in range(self.count)]
        most = sum(contacts[0] * len(shanks) for contacts, shanks in zip(self.contacts, self.shanks))
        names = pick(["Cor"], ["ShI"], ["Cor,ShI"], ["Cor", "ShO"], ["ShI,ShO", "Cor"])
        self.covers = [(name, int(rng.integers(1, max(2, int(most * 0.7)))) if rng.random() < 0.8 else 0) for name in names]
        self.items = []
        for i in range(self.count):
            poses = []
            for _ in range(int(rng.integers(3, 8))):
                way, up = unit(rng.normal(size=3)), rng.normal(size=3)
                tip = rng.uniform(-14, 14, 3)
                length = float(rng.uniform(20, 40))
                poses.append((tip - length * way, way, unit(up - (up @ way) * way), length))
            self.items.append(poses)
            table(f"{i}.tsv", ["query_id", "x", "y", "z", "dx", "dy", "dz", "ux", "uy", "uz", "far"],
                  [[f"n{i}-{c}", *at.tolist(), *way.tolist(), *up.tolist(), far] for c, (at, way, up, far) in enumerate(poses)])
        self.is_given = [rng.random() < 0.1 for _ in range(self.count)]

    def options(self, i):
        return {"contacts": ",".join(f"{number:g}" for number in self.contacts[i]),
                "shanks": ";".join(f"{x:g},{y:g}" for x, y in self.shanks[i])}

    def ask(self):
        labels, affine = voxels()
        self.alone, self.covered = [], []
        for i in range(self.count):
            call_conus("plan", "nested.nii.gz", "--poses", f"{i}.tsv", "--reach", "ShI,Cor,length=0.5", "--shanks",
                       self.options(i)["shanks"], "--infeasible", "--top", "100", "-q", "--force", "-o", "alone.tsv")
            rows = {row["query"]: row for row in certificate.read_table("alone.tsv")}
            self.alone.append([(rows[f"n{i}-{c}"]["feasible"] == "1", certificate.nanometres_or_none(rows[f"n{i}-{c}"]["leeway_mm"]),
                                int(certificate.nanometres(float(rows[f"n{i}-{c}"]["far_mm"])))) for c in range(len(self.items[i]))])
            self.covered.append([self.count_contacts(i, c, labels, np.linalg.inv(affine)) for c in range(len(self.items[i]))])
        given = [i for i in range(self.count) if self.is_given[i]]
        rows = [pathlib.Path(f"{i}.tsv").read_text().splitlines() for i in given]
        if given:
            pathlib.Path("given.tsv").write_text("\n".join([rows[0][0], *(line[1].replace(f"n{i}-0", f"N{i}") for i, line in
                                                                          zip(given, rows))]) + "\n")
        table("needles.tsv", ["needle", "poses", "contacts", "shanks"],
              [[f"N{i}", f"{i}.tsv", self.options(i)["contacts"], self.options(i)["shanks"]] for i in range(self.count)])
        more = ["--top", self.top, "--diverse", 0] if self.top > 1 else []
        more += ["--given", "given.tsv"] if given else []
        for name, least in self.covers:
            more += ["--cover", f"{name},contacts={least}" if least else name]
        call_conus("plan", "nested.nii.gz", "--needles", "needles.tsv", "--reach", "ShI,Cor,length=0.5", "--between", self.between,
                   "--entry-distance", self.entries, *more, "-q", "-o", "plan.tsv", "--candidates", "candidates.tsv")
        return certificate.read_table("plan.tsv"), json.loads(pathlib.Path("plan.json").read_text())["Plan"]

    def count_contacts(self, i, c, labels, voxel_from_world):
        """How many contacts of all shanks of a candidate are in each cover, and in any."""
        at, way, up, far = self.items[i][c]
        count, columns, pitch, tip = self.contacts[i]
        right = np.cross(up, -way)
        found = []
        for (x, y), n in itertools.product(self.shanks[i], range(count)):
            depth = far - tip - n // columns * pitch
            voxel = np.rint(voxel_from_world @ [*(at + x * right + y * up + depth * way), 1])[:3].astype(int)
            inside = depth >= 0 and (voxel >= 0).all() and (voxel < labels.shape).all()
            label = labels[tuple(voxel)] if inside else 0
            found.append([label in [SHELLS[shell] for shell in name.split(",")] for name, _ in self.covers])
        found = np.array(found)
        return [*found.sum(0).tolist(), int(found.any(1).sum())]

    def pair(self, i, a, k, b):
        """The leeway of a pair, nm; None where it breaks."""
        ends = []
        for needle, candidate in ((i, a), (k, b)):
            at, way, up, far = self.items[needle][candidate]
            right = np.cross(up, -way)
            ends.append((np.array([at + x * right + y * up for x, y in self.shanks[needle]]), np.array([far * way] * len(self.shanks[needle]))))
        slack = certificate.segments_distance(*ends[0], *ends[1]).min() - self.between
        entries = np.linalg.norm(self.items[i][a][0] - self.items[k][b][0])
        return int(certificate.nanometres(slack / 2)) if slack > EPS and entries >= self.entries - EPS else None

    def combinations(self):
        domains = [[0] if self.is_given[i] else range(len(self.items[i])) for i in range(self.count)]
        domains = [[c for c in domain if self.alone[i][c][0]] for i, domain in enumerate(domains)]
        pairs = {(i, a, k, b): self.pair(i, a, k, b) for i, k in itertools.combinations(range(self.count), 2)
                 for a in domains[i] for b in domains[k]}
        for chosen in itertools.product(*domains):
            leeways = [pairs[i, a, k, b] for (i, a), (k, b) in itertools.combinations(enumerate(chosen), 2)]
            if None not in leeways:
                own = [self.alone[i][c] for i, c in enumerate(chosen)]
                yield (min(leeways + [leeway for _, leeway, _ in own]), sum(leeway for _, leeway, _ in own),
                       -sum(depth for *_, depth in own), *(-c for c in chosen)), chosen

    def sums(self, chosen):
        """Contacts in each cover, and in any."""
        return np.sum([self.covered[i][c] for i, c in enumerate(chosen)], 0).tolist()

    def holds(self, chosen, but=None):
        return all(own >= least for k, ((_, least), own) in enumerate(zip(self.covers, self.sums(chosen))) if k != but)


def check(seed):
    """What kind of answer it was."""
    instance = Instance(seed)
    rows, plan = instance.ask()
    fitting = list(instance.combinations())
    found = sorted((one for one in fitting if instance.holds(one[1])), reverse=True)
    if not found and all(instance.is_given):
        assert {row["combination"] for row in rows} == {"0"}
        return "given"
    assert [bool(entry["proven"]) for entry in plan["combinations"]] == [True] * min(len(found), instance.top)
    assert len(rows) == instance.count * min(len(found), instance.top)
    for n, (key, chosen) in enumerate(found[:instance.top]):
        mine = rows[n * instance.count:(n + 1) * instance.count]
        said = [certificate.nanometres_or_none(mine[0][name]) for name in ("all_leeway_mm", "all_sum_mm", "all_depth_mm")]
        assert np.abs(np.array(said) - [key[0], key[1], -key[2]]).max() <= 2 * instance.count
        rivals = [other for other, _ in found if other[:2] != key[:2] and abs(other[0] - key[0]) <= 2]
        wanted = [f"N{i}" if instance.is_given[i] else f"n{i}-{c}" for i, c in enumerate(chosen)]
        assert rivals or [row["query"] for row in mine] == wanted
        assert rivals or [*plan["combinations"][n]["covered"], int(mine[0]["all_contacts"])] == instance.sums(chosen)
    if found:
        assert plan["conflict"] is None
        if sum(least > 0 for _, least in instance.covers) < 2 and len(instance.covers) == 1:
            assert certificate.confirm("plan.tsv", "plan.json", "candidates.tsv") == min(len(found), instance.top)
        return "found"
    if fitting:  # covers alone
        had = [max((instance.sums(chosen)[k] for _, chosen in fitting if instance.holds(chosen, k)), default=None) if least else None
               for k, (_, least) in enumerate(instance.covers)]
        assert plan["conflict"]["contacts"] == had
        assert plan["conflict"]["needles"] == [f"N{i}" for i in range(instance.count)]
        return "covers"
    assert "contacts" not in plan["conflict"]
    return "pairs"


@pytest.mark.parametrize("group", range(4))
def test_small_instances_are_as_all_combinations(group):
    seen = []
    for seed in range(15 * group, 15 * group + 15):
        for path in pathlib.Path().glob("*.tsv"):
            if path.name != "nested.tsv":
                path.unlink()
        pathlib.Path("plan.json").unlink(missing_ok=True)
        seen.append(check(seed))
    assert {"found", "covers"} <= set(seen), "a kind of answer is not there: nothing is shown of it"


def test_python_covers_and_windows_as_the_program():
    labels, affine = voxels()
    box = conus.load("nested.nii.gz")
    table("p.tsv", ["query_id", "x", "y", "z", "dx", "dy", "dz", "far"],
          [["a", 30.0, 0.0, 30.0, -0.6, 0.0, -0.8, 45.0], ["b", -30.0, 0.0, 30.0, 0.6, 0.0, -0.8, 45.0]])
    needles = {"A": {}}
    ask = lambda **more: box.plan_together(needles, poses=conus.read_poses("p.tsv"), reach={"Cor": 1}, **more)
    whole = ask(contacts=(12, 1, 2, 1), cover={"Cor": 3, "ShO,ShI": None})
    device = whole.poses[0, 0]
    points = [np.linalg.inv(affine) @ (device[:, 3] - depth * device[:, 2]) for depth in 45 - 1 - 2 * np.arange(12)]
    inside = [labels[tuple(np.rint(point)[:3].astype(int))] for point in points]
    covered = [sum(label > 300 for label in inside), sum(0 < label <= 300 for label in inside)]
    assert whole.combinations[0]["covered"] == covered and whole.combinations[0]["contacts"] == sum(covered)
    none = ask(contacts=(12, 1, 2, 1), cover={"Cor": 100})
    assert len(none) == 0 and none.conflict["contacts"] == [covered[0]]
    right = lambda m, pitch=0: ask(arc_window=((-1 + pitch, 1 + pitch), m), arcs={"spacing": 9, "pitch": pitch})
    for pitch in (0, 30):
        assert right((30, 40), pitch).poses[0, 0, 0, 3] == 30 and right((-40, -30), pitch).poses[0, 0, 0, 3] == -30
    assert len(right((40, 50))) == 0 and len(box._selector({}).plan({"Cor": 1}, poses=conus.read_poses("p.tsv"), arc_window=((-1, 1), (30, 40)))) == 1
    for more, words in (({"cover": {"Cor": 3}}, "cover counts contacts"), ({"contacts": (12, 1, 2, 1)}, "no effect"),
                        ({"cover": {"Nix": 3}, "contacts": (12, 1, 2, 1)}, "Nix"), ({"cover": {"Cor": 0}, "contacts": (1, 1, 1, 1)}, "cover"),
                        ({"arc_window": (1, 2)}, "arc_window"), ({"arc_window": ((2, 1), (0, 1))}, "arc angle: 2 to 1"),
                        ({"arcs": {"spacing": 9, "pitch": 181}}, "pitch: 181 degrees")):
        with pytest.raises(conus.ArgumentError, match=words):
            ask(**more)
