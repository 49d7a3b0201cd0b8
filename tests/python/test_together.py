# SPDX-License-Identifier: BSD-3-Clause
"""Several needles together: what the package answers is what the program writes."""
import numpy as np
import pandas
import pytest

import conus
from support import assert_rows_of_the_program, call_conus, run_conus


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    call_conus("phantom", "u-shape", "-o", ".")
    for name, places in {"a": [0, 1, 2.5], "b": [1, 2, 4], "c": [-3, -4, -2], "A": [0.5]}.items():
        rows = "".join(f"{name}{n if name != 'A' else ''}\t40\t{y}\t5\t-1\t0.0{n}\t-0.2\t26\n" for n, y in enumerate(places))
        with open(f"{name}.tsv", "w", encoding="utf-8") as file:
            file.write("query_id\tx\ty\tz\tdx\tdy\tdz\tfar\n" + rows)


@pytest.fixture
def atlas():
    return conus.load("u-shape.nii.gz")


def program(table, *options):
    with open("needles.tsv", "w", encoding="utf-8") as file:
        file.write(table)
    rows = run_conus("plan", "u-shape.nii.gz", "--needles", "needles.tsv", "--reach", "U,length=2", "-q", "--format", "tsv",
                     "--pairs", "pairs.tsv", "--force", *options)
    return rows, pandas.read_csv("pairs.tsv", sep="\t")


def three():
    return {"A": {"poses": conus.read_poses("a.tsv"), "radius": 1}, "B": {"poses": conus.read_poses("b.tsv"), "radius": 0.5},
            "C": {"poses": conus.read_poses("c.tsv")}}


TABLE = "needle\tposes\tradius\nA\ta.tsv\t1\nB\tb.tsv\t0.5\nC\tc.tsv\t\n"


@pytest.mark.parametrize("options, asked", [
    (["--between", "1"], {"between": 1}),
    (["--between", "0.2,parts=0.5", "--part", "0.4,-3:1", "--part", "0.3,0:2,0.5,0,tip", "--entry-distance", "1"],
     {"between": (0.2, 0.5), "parts": [(0.4, -3, 1), (0.3, 0, 2, 0.5, 0, "tip")], "entry_distance": 1}),
    (["--top", "3", "--diverse", "0.5,2"], {"top": 3, "diverse": (0.5, 2)}),
    (["--arcs", "16,slider=1e-9,same=6,most=1", "--space", "ras"], {"arcs": {"spacing": 16, "slider": 1e-9, "same": 6, "most": 1}}),
    (["--given", "A.tsv"], {"given": True}),
])
def test_answers_are_the_programs(atlas, options, asked):
    rows, pairs = program(TABLE, *options)
    if "given" in asked:
        asked = {"given": conus.read_poses("A.tsv")}
    found = atlas.plan_together(three(), reach={"U": 2}, threads=1, **asked)
    assert len(found) and len(rows) == 3 * len(found) and found.conflict is None
    assert_rows_of_the_program(found.to_dataframe(), rows)
    assert [bool(one["proven"]) for one in found.combinations] == rows["proven"][::3].astype(bool).tolist()
    assert found.needles == ["A", "B", "C"] and found.poses.shape == (len(found), 3, 4, 4)
    assert np.allclose(found.poses[..., :3, 3].reshape(-1, 3), rows[["x", "y", "z"]], atol=1e-6)
    assert np.allclose(found.far.ravel(), rows["far_mm"], atol=1e-6)
    frame = found.pairs.to_dataframe()
    assert list(frame.columns) == list(pairs.columns) and len(frame) == len(pairs) == 3 * len(found)
    assert np.allclose(frame["distance_mm"].astype(float), pairs["distance_mm"], atol=1e-6)
    assert repr(found) == f"<conus.Together: {len(found)} combinations of A, B, C>"


def test_alternatives_and_needles_from_entries_to_targets(atlas):
    sites = {"entries": np.array([[40.0, y, 5] for y in (0, 1, 3, -3)]), "targets": np.array([[20.0, 0, 5]])}
    with open("sites.tsv", "w", encoding="utf-8") as file:
        file.write("x\ty\tz\n" + "".join("\t".join(map(str, at)) + "\n" for at in sites["entries"]))
    with open("targets.tsv", "w", encoding="utf-8") as file:
        file.write("x\ty\tz\n20\t0\t5\n")
    rows, _ = program("needle\tposes\tfrom\ttoward\tdepth\tonce\nR\ta.tsv\t\t\t\t\nR,S\t\tsites.tsv\ttargets.tsv\t10\t1\n"
                      "S\tc.tsv\t\t\t\t0\n")
    found = atlas.plan_together({"R": {"poses": conus.read_poses("a.tsv")}, "R,S": {**sites, "depth": 10, "once": True},
                                 "S": [{"poses": conus.read_poses("c.tsv")}]}, reach={"U": 2})
    assert_rows_of_the_program(found.to_dataframe(), rows)
    assert len(rows) == 2


def test_a_conflict_is_said(atlas):
    found = atlas.plan_together(three(), reach={"U": 2}, between=6)
    assert len(found) == 0 and found.conflict["needles"] == ["A", "B"] and found.conflict["between_mm"] < 6
    assert len(found.to_dataframe()) == 0 and found.poses.shape == (0, 3, 4, 4)
    limited = atlas.plan_together(three(), reach={"U": 2}, arcs={"spacing": 16, "slider": 1e-9, "same": 6, "each": 2})
    assert limited.conflict["needles"] == ["A", "B", "C"] and limited.conflict["arcs"] == {"most": None, "each": 3}


def test_what_is_not_allowed_is_refused(atlas):
    needles = {"A": {"poses": conus.read_poses("a.tsv")}}
    for wrong, why in (({"between": -1}, "between"), ({"between": (1, 2, 3)}, "between"), ({"arcs": {"tilt": 3}}, "tilt"), ({"arcs": {"spacing": 9, "pitch": 181}}, "pitch"),
                       ({"arcs": 0.5}, "arcs: same"), ({"top": 2}, "diverse"), ({"diverse": 1}, "diverse"), ({"top": 101}, "top"),
                       ({"effort": 0}, "effort"),
                       ({"effort": float("inf")}, "effort"), ({"arcs": 0}, "spacing: 0"), ({"arcs": {"most": 2}}, "spacing"),
                       ({"arcs": {"spacing": 16, "same": 0}}, "same: 0"), ({"arcs": {"spacing": 16, "slider": 0}}, "slider: 0"),
                       ({"entry_distance": 101}, "entry_distance"), ({"rank": "depth"}, "rank"),
                       ({"given": conus.read_poses("b.tsv")}, "b0 is no needle"), ({"parts": [(1, 2)]}, "parts"),
                       ({"parts": [(0, 2, 2)]}, "part 1"), ({"arc": 3}, "arc"),
                       ({"arc": "a"}, "A: arc has no effect without arcs"), ({"reach": {"Nowhere": 1}}, "Nowhere")):
        with pytest.raises(conus.ArgumentError, match=why):
            atlas.plan_together(needles, **{"reach": {"U": 2}, **wrong})
    for wrong in ({}, {"A": {}}, {"": needles["A"]}, {"A,A": needles["A"]}):
        with pytest.raises(conus.ArgumentError):
            atlas.plan_together(wrong, reach={"U": 2})
    with pytest.raises(conus.ArgumentError):
        atlas.plan_together(needles)  # no constraint


def test_an_error_while_candidates_are_opened_is_raised(atlas, monkeypatch):
    class Broken(Exception):
        pass

    def fail(*_):
        raise Broken

    monkeypatch.setattr("conus._atlas.stream_of", fail)
    with pytest.raises(Broken):
        atlas.plan_together(three(), reach={"U": 2})
