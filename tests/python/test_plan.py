# SPDX-License-Identifier: BSD-3-Clause
"""Plans of needles through plates, in closed form."""
import math

import numpy as np
import pytest

import conus
from support import AFFINE, NAMES, plates

# From x = 0 along x at y = z = 0, so that the right plate, x = 20 to 40, is entered at the depth 20; and along -x.
ORIGINS = np.zeros((4, 3))
DIRECTIONS = np.array([[1, 0, 0], [1, 0, 0], [1, 0, 0], [-1, 0, 0]], float)
DEPTHS = np.array([25, 30, 15, 18], float)


@pytest.fixture
def atlas():
    return conus.load(plates(), AFFINE, labels=NAMES)


def test_rows_and_arrays(atlas):
    plan = atlas.plan({"right": 4}, {"left": 3}, origins=ORIGINS, directions=DIRECTIONS, depth=DEPTHS, radius=1)
    # 5 and 10 mm in the right plate; the left one is 20 mm from the apex
    assert list(plan.ids) == ["2", "1"] and plan.funnel == [2, 2] and plan.candidates == 4
    table = plan.to_dataframe()
    assert table["reach1_mm"].tolist() == [10, 5] and table["avoid1_mm"].tolist() == [20, 20]
    assert table["clearance_mm"].tolist() == [19, 19] and table["clearance_of"].tolist() == ["left", "left"]
    assert np.allclose(plan.poses[:, :3, 2], [-1, 0, 0]) and plan.far.tolist() == [30, 25] and len(plan) == 2
    assert plan.leeway_mm.tolist() == pytest.approx([6, 1], abs=1e-6)  # 10 - d = 4 and 5 - d = 4, less than 20 - 1 - 3
    assert plan.constraints == ["at least 4 mm of the axis in right", "more than 3 mm of clearance from left"]
    verdicts = plan.verdicts()[["query", "kind", "value", "holds"]].values.tolist()
    assert verdicts[:2] == [["2", "reach", 10, 1], ["2", "avoid", 20, 1]]
    tolerance = plan.tolerance("tip").set_index(["query", "freedom", "side"])
    assert len(tolerance) == 40 and set(tolerance.method) == {"exact"}
    assert tolerance.holds_to["2", "depth", "-"] == pytest.approx(6, abs=2e-6)  # 10 mm, of which 4 are needed
    with pytest.raises(conus.ArgumentError, match="pivot"):
        plan.tolerance("middle")
    profile = plan.profile(20)[["query", "depth_mm", "distance_mm"]].values.tolist()
    assert profile[:3] == [["2", 0, 20], ["2", 20, 40], ["2", 30, 50]]


def test_measures_of_the_cone(atlas):
    plan = atlas.plan({"right": {"share": 0.5}, "left": {"volume": 1}}, {"left": {"share": 0.1}}, origins=ORIGINS,
                      directions=DIRECTIONS, depth=[30, 30, 15, 30], angle=20, layers="all", infeasible=True)
    rows = plan.to_dataframe().set_index("query")
    assert rows["reach1_share"].to_dict() == {"1": 1, "2": 1, "3": 0, "4": 0}  # the plates are wider than the cone
    assert rows["avoid1_share"].to_dict() == {"1": 0, "2": 0, "3": 0, "4": 1}
    left = atlas.select([0, 0, 0], direction=[-1, 0, 0], angle=20, layers="all", range=(0, 30)).to_dataframe()
    assert rows.loc["4", "reach2_mm3"] == left["volume_mm3"].dropna().iloc[0] > 0
    with pytest.raises(conus.ArgumentError, match="layers"):
        atlas.plan({"right": {"volume": 5}}, origins=ORIGINS, directions=DIRECTIONS, depth=30)
    with pytest.raises(conus.ArgumentError, match="is not what avoid can ask"):
        atlas.plan(avoid={"right": {"volume": 5}}, origins=ORIGINS, directions=DIRECTIONS, depth=30)


def test_poses_of_a_file_have_openings_of_their_own(atlas, tmp_path):
    path = tmp_path / "own.tsv"
    path.write_text("x\ty\tz\tdx\tdy\tdz\tfar\tangle\n" + "".join(f"0\t0\t0\t1\t0\t0\t30\t{a}\n" for a in (20, 60, "n/a")))
    plan = atlas.plan({"right": {"volume": 1}}, poses=conus.read_poses(path), angle=40, layers="all", infeasible=True)
    found = plan.to_dataframe().set_index("query")["reach1_mm3"]
    for query, angle in (("1", 20), ("2", 60), ("3", 40)):  # from 20 to 30 mm, in voxels of 8 mm^3
        cone = math.pi * math.tan(math.radians(angle / 2)) ** 2 * (30 ** 3 - 20 ** 3) / 3
        assert found[query] == pytest.approx(cone, rel=0.05)


def test_a_pose_that_is_not_exactly_known(atlas):
    # The far end has an error of 4 mm (normal): 10 and 5 mm in the plate are 6 and 1 more than needed, and the 40 mm to
    # the left are none.
    plan = atlas.plan({"right": 4}, {"left": 3}, origins=ORIGINS, directions=DIRECTIONS, depth=DEPTHS, radius=1,
                      jitter={"entry": 0, "target": 0, "depth": 4}, samples=4096, rank="p_ok")
    below = lambda x: 0.5 * math.erfc(-x / math.sqrt(2))  # noqa: E731
    rows = plan.to_dataframe()
    assert rows["query"].tolist() == ["2", "1"] and rows["p_avoid1"].tolist() == [1, 1]
    assert rows["p_ok"].tolist() == pytest.approx([below(6 / 4), below(1 / 4)], abs=0.002) == rows["p_reach1"].tolist()
    assert set(plan.verdicts()["p_holds"]) == set(rows["p_ok"]) | {1}
    tried = plan.try_pose([0, 0, 0], direction=[1, 0, 0], depth=22)  # 2 mm in the plate
    assert not tried["feasible"] and tried["broken"] == 0 and tried["p_ok"] == pytest.approx(below(-2 / 4), abs=0.002)
    assert [one["value"] for one in tried["verdicts"]] == [2, 20] and tried["far"] == 22
    tilted = atlas.plan({"right": 4}, origins=ORIGINS, directions=DIRECTIONS, depth=DEPTHS, jitter=(2, 0))
    assert (tilted.to_dataframe()["p_ok"] > 0.99).all()
    for arguments, said in (({"jitter": {"exit": 1}}, "exit"), ({"jitter": (1,)}, "jitter"), ({"samples": 64}, "without jitter"),
                            ({"jitter": (1, 1), "samples": 100}, "powers of two"), ({"rank": "p_ok"}, "p_ok")):
        with pytest.raises(conus.ArgumentError, match=said):
            atlas.plan({"right": 4}, origins=ORIGINS, directions=DIRECTIONS, depth=DEPTHS, **arguments)


def test_contacts_and_tolerance(atlas):
    asked = dict(origins=ORIGINS, directions=DIRECTIONS, depth=DEPTHS)
    plan = atlas.plan({"right": {"contacts": 2}}, contacts=(4, 1, 2, 1), **asked)  # to 25: at 24, 22, 20, 18
    assert plan.to_dataframe().set_index("query")["reach1_contacts"].to_dict() == {"1": 3, "2": 4}
    with pytest.raises(conus.ArgumentError, match="not known"):
        atlas.plan({"right": {"contacts": 2}}, **asked)
    with pytest.raises(conus.ArgumentError, match="no effect"):
        atlas.plan({"right": 2}, contacts=(4, 1, 2, 1), **asked)
    with pytest.raises(conus.ArgumentError, match="whole numbers"):
        atlas.plan({"right": {"contacts": 2}}, contacts=(4, 1.5, 2, 1), **asked)
    with pytest.raises(conus.ArgumentError, match="no probabilities"):
        atlas.plan({"right": {"probability": 0.5}}, **asked)
    rows = atlas.tolerance({"right": 4}, **asked).set_index(["query", "freedom", "side"])
    assert len(rows) == 80 and rows.holds_to["3", "depth", "+"] == 0  # it is not feasible itself
    assert rows.holds_to["2", "depth", "-"] == pytest.approx(6, abs=2e-6)


def test_what_is_missed(atlas, tmp_path):
    plan = atlas.plan({"right": 4}, {"left": 50}, origins=ORIGINS, directions=DIRECTIONS, depth=DEPTHS)
    assert len(plan) == 0 and plan.funnel == [2, 0] and plan.misses == [None, "1"]
    assert atlas.plan({"right": "tip"}, origins=ORIGINS, directions=DIRECTIONS, depth=DEPTHS).funnel == [2]
    of_part = atlas.plan({"right": {"length": 3, "part": (0, 4)}}, origins=ORIGINS, directions=DIRECTIONS, depth=DEPTHS)
    assert of_part.to_dataframe()["reach1_mm"].tolist() == [4, 4]
    kinds = atlas.plan(length=(0, 28), lean=[((1, 0, 0), 10)], apart=[([[(0, 5, 0), (9, 5, 0)]], 4)], first=["right"],
                       origins=ORIGINS, directions=DIRECTIONS, depth=DEPTHS, top=None)
    assert list(kinds.ids) == ["1"] and kinds.funnel == [3, 2, 2, 1]
    for wrong in ({"lean": ((1, 0, 0), 10)}, {"lean": (1, 0, 0, 10)}, {"apart": ([[(0, 5, 0), (9, 5, 0)]], 4)},
                  {"apart": [([(0, 5, 0), (9, 5, 0)], 4)]}, {"apart": [([0, 5, 0, 9, 5], 4)]}):  # points, no needles
        with pytest.raises(conus.ArgumentError, match="wanted is"):
            atlas.plan(origins=ORIGINS, directions=DIRECTIONS, depth=DEPTHS, **wrong)
    kinds.save(tmp_path / "plan.tsv")
    assert len((tmp_path / "plan.tsv").read_text().splitlines()) == 2


def test_a_file_of_poses_has_ends_of_its_own(atlas, tmp_path):
    path = tmp_path / "needles.tsv"
    path.write_text('id\tx\ty\tz\tdx\tdy\tdz\tfar\n"a ""b"\t0\t0\t0\t1\t0\t0\t26.5\n'
                    "none\t0\t0\t0\t0\t0\t0\t9\nc\t0\t0\t0\t1\t0\t0\t\n")
    poses = conus.read_poses(path)
    plan = atlas.plan(["right"], poses=poses)
    assert list(plan.ids) == ['a "b'] and plan.far.tolist() == [26.5] and list(plan.errors) == [1]
    assert atlas.plan(["right"], poses=poses, depth=33).far.tolist() == [33, 33]


@pytest.mark.parametrize("given, message", [
    (dict(reach={"nobody": 1}), "no area has the name"),
    (dict(reach={"right": "length"}), "not what reach can ask|is no"),
    (dict(avoid={"right": {"volume": 1}}), "not what avoid can ask"),
    (dict(avoid={"right": 101}), "margin: 101 mm"),
    (dict(reach={"right": math.nan}), "nan"),
    (dict(reach={"right": 1}, avoid={"right": 1}), "avoids all"),
    (dict(reach="right", rank="leewy"), "leewy"),
    (dict(reach="right", top=0), "top"),
    (dict(), "constraint"),
])
def test_what_cannot_be(atlas, given, message):
    with pytest.raises(conus.ArgumentError, match=message):
        atlas.plan(**{"origins": ORIGINS, "directions": DIRECTIONS, "depth": DEPTHS, **given})


def test_no_candidate(atlas):
    with pytest.raises(conus.ArgumentError, match="no candidate: "):
        atlas.plan(["right"], origins=ORIGINS, directions=DIRECTIONS)


def test_maps_are_of_the_best_pose_of_each_site(atlas):
    entries = np.array([(0.0, y, 0) for y in range(4)] + [(0.0, 60, 0)])
    targets = [(20.0, 0, 0), (20, 3, 2), (-20, 0, 0)]
    asked = dict(entries=entries, targets=targets, depth="target+5", top=None)
    plan = atlas.plan({"right": 4}, maps=True, **asked)
    assert plan.map("feasible").tolist() == [np.sum(plan.entries == i + 1) for i in range(5)]
    table = plan.to_dataframe()
    for of, sites in (("entries", plan.entries), ("targets", plan.targets)):
        count = len(entries if of == "entries" else targets)
        assert plan.sources[of].tolist() == list(range(count))
        best = [next(iter(np.nonzero(sites == i + 1)[0]), None) for i in range(count)]  # by the rank
        columns = {"leeway_mm": "leeway_mm", "slack_mm": "slack_mm", "depth_mm": "far_mm", "reach1": "reach1_mm"}
        for key, column in columns.items():
            expected = [math.nan if i is None else float(table[column][i]) for i in best]
            np.testing.assert_allclose(plan.map(key, of), expected, rtol=1e-8)
        assert [number == 0 for number in plan.map("candidate", of)] == [i is None for i in best]
    assert np.isnan(plan.map("leeway_mm", "targets")[2])  # it is in the other plate
    with pytest.raises(conus.ArgumentError, match="wanted is one of leeway_mm"):
        plan.map("leeway")
    with pytest.raises(conus.ArgumentError, match="maps=True"):
        atlas.plan({"right": 4}, **asked).map("leeway_mm")
    with pytest.raises(conus.ArgumentError, match="no effect without entries"):
        atlas.plan({"right": 4}, origins=ORIGINS, directions=DIRECTIONS, depth=DEPTHS, maps=True)


def test_candidates(atlas, tmp_path):
    # From x = 0 to the right plate, 20 mm away, and 5 mm into it.
    entries, targets = np.array([(0.0, 0, 0), (0, 1, 0)]), [(20.0, 0, 0), (20, 1, 0)]
    plan = atlas.plan({"right": 4}, entries=entries, targets=np.array(targets), depth="target+5", top=None)
    assert plan.candidates == 4 and set(plan.ids) == {"e1-t1", "e1-t2", "e2-t1", "e2-t2"}
    assert sorted(zip(plan.entries.tolist(), plan.targets.tolist())) == [(1, 1), (1, 2), (2, 1), (2, 2)]
    by_id = dict(zip(plan.ids, plan.far))
    assert by_id["e1-t1"] == 25 and by_id["e1-t2"] == pytest.approx(math.sqrt(401) + 5)
    table = plan.to_dataframe()
    assert table["entry"].tolist() == plan.entries.tolist()
    tilted = atlas.plan({"right": 4}, entries=entries[:1], targets=targets[:1], depth=25, tilt=(10, 10), top=None)
    assert tilted.candidates == 1 + math.ceil(2 * math.pi * math.sin(math.radians(10)) / math.radians(10))
    of_voxels = atlas.plan({"right": None}, entries=(entries, {"spacing": 2}), targets=("voxels", {"spacing": 6}),
                           depth="target")
    assert set(of_voxels.entries.tolist()) == {1}  # the second is 1 mm from the first
    for target in ("centroid", "deepest"):
        assert atlas.plan({"right": None}, entries=entries, targets=target, depth="target").candidates == 2
    box = tmp_path / "box.ply"
    corners = "-9 -9 -9\n9 -9 -9\n9 9 -9\n-9 9 -9\n-9 -9 9\n9 -9 9\n9 9 9\n-9 9 9\n"
    faces = ["0 2 1", "0 3 2", "4 5 6", "4 6 7", "0 1 5", "0 5 4", "3 6 2", "3 7 6", "0 4 7", "0 7 3", "1 2 6", "1 6 5"]
    box.write_text("ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
                   "element face 12\nproperty list uchar int vertex_indices\nend_header\n" + corners
                   + "".join(f"3 {face}\n" for face in faces))
    inward = atlas.plan(length=(1, 9), entries=box, targets="normal", depth=9, entry_angle=1)
    assert inward.candidates == len(inward) == 8 and not inward.targets.any()
    assert (np.sign(inward.poses[:, :3, 2]) == np.sign(inward.poses[:, :3, 3])).all()  # -z leads to the middle
    outward = atlas.plan(length=(1, 9), entries=(box, {"flip": True, "without": "left"}), targets="normal", depth=9)
    assert (np.sign(outward.poses[:, :3, 2]) == -np.sign(outward.poses[:, :3, 3])).all()


def test_shanks_are_single_needles(atlas):
    shanks = np.array([(0.5, -1), (6, 2), (-3, 9)])
    asked = dict(reach={"right": {"length": 4}}, avoid={"left": 3}, radius=1, depth=25, infeasible=True, top=None)
    probe = atlas.plan(entries=[(0.0, 0, 0), (-16, 0, 3)], targets=[(20.0, 0, 0)], tilt=(60, 30), roll=100, shanks=shanks,
                       **asked)
    assert probe.candidates % 4 == 0 and any(name.endswith("-r4") for name in probe.ids)
    table = probe.verdicts()
    for kind, best in (("reach", np.argmax), ("avoid", np.argmin)):
        singles = []
        for x, y in shanks:
            poses = probe.poses.copy()
            poses[:, :3, 3] += x * poses[:, :3, 0] + y * poses[:, :3, 1]
            rows = atlas.plan(poses=poses, **asked).verdicts()
            singles.append(rows[rows.kind == kind].astype({"query": int}).sort_values("query"))
        of_probe = table[table.kind == kind]
        slacks, leeways = (np.array([rows[name] for rows in singles], float) for name in ("slack", "leeway_mm"))
        assert of_probe.shank.tolist() == (best(slacks, axis=0) + 1).tolist() and of_probe.shank.nunique() > 1
        assert np.allclose(of_probe.slack, np.take_along_axis(slacks, best(slacks, axis=0)[None], 0)[0], atol=1e-9)
        of_all = leeways.max(axis=0) if kind == "reach" else leeways.min(axis=0)
        held = probe.to_dataframe().feasible.to_numpy() == 1
        assert held.any() and np.allclose(of_probe.leeway_mm[held].astype(float), of_all[held], atol=2e-6)
    both = atlas.plan({"right": {"length": 4, "shank": "all"}}, origins=ORIGINS, directions=DIRECTIONS, depth=DEPTHS,
                      shanks=[(0, 0), (0, 900)])
    assert both.funnel == [0]
    for given, said in (({"shanks": [1, 2]}, "wanted is"), ({"shanks": [(0, 1001)]}, "allowed are up to 1000"),
                        ({"reach": {"right": {"shank": 2}}}, "one shank"), ({"roll": 9}, "without entries")):
        with pytest.raises(conus.ArgumentError, match=said):
            atlas.plan(**{"reach": "right", "origins": ORIGINS, "directions": DIRECTIONS, "depth": DEPTHS, **given})


def test_candidates_that_cannot_be(atlas):
    point = [(0.0, 0, 0)]
    for arguments, said in (
        ({"targets": point}, "without entries"),
        ({"entries": point}, "targets go with them"),
        ({"entries": point, "targets": point, "origins": ORIGINS}, "targets go with them"),
        ({"entries": (point, {"spasing": 1}), "targets": point}, "spasing"),
        ({"entries": (point, {"flip": True}), "targets": point}, "flip is for surfaces"),
        ({"entries": (point, {"within": "right"}), "targets": point}, "no candidate"),
        ({"entries": (point, {"within": "rigth"}), "targets": point}, "did you mean"),
        ({"entries": point, "targets": "voxels"}, "of which structure"),
        ({"entries": point, "targets": "voxel"}, "wanted are centroid"),
        ({"entries": point, "targets": "normal"}, "has no normal"),
        ({"entries": point, "targets": [(0.0, 1)]}, "wanted is"),
        ({"entries": point, "targets": [(1.0, math.nan, 1)]}, "allowed are finite"),
        ({"entries": point, "targets": [(1.0, 1, 1)], "depth": "tip"}, "target"),
        ({"entries": point, "targets": [(1.0, 1, 1)], "tilt": (5, 6)}, "tilt"),
        ({"entries": point, "targets": point, "depth": 5}, "no candidate"),
    ):
        with pytest.raises(conus.ArgumentError, match=said):
            atlas.plan(length=(0, 9), **{"depth": 9, **arguments})


def test_no_file_that_was_read_is_replaced(tmp_path):
    nibabel = pytest.importorskip("nibabel")
    nibabel.save(nibabel.Nifti1Image(plates(), AFFINE), tmp_path / "plates.nii")
    table = tmp_path / "plates.tsv"
    table.write_text("index\tname\n" + "".join(f"{i}\t{name}\n" for i, name in NAMES.items()))
    before = table.read_bytes()
    plan = conus.load(tmp_path / "plates.nii").plan({"right": 4}, origins=ORIGINS, directions=DIRECTIONS, depth=DEPTHS)
    (tmp_path / "link.csv").symlink_to(table)
    (tmp_path / "hard.tsv").hardlink_to(table)
    names = ["plates.tsv", "hard.tsv"] + ["link.csv"] * (tmp_path / "link.csv").is_symlink()  # wine makes none, and says nothing
    for name in names:
        with pytest.raises(conus.ArgumentError, match="would overwrite the input .*plates.tsv"):
            plan.save(tmp_path / name)
    assert table.read_bytes() == before
    for _ in range(2):  # its own file may be made anew
        plan.save(tmp_path / "rows.tsv")
        assert conus.read_poses(tmp_path / "rows.tsv") is not None
