# SPDX-License-Identifier: BSD-3-Clause
"""Answers of conus plan --needles are proved again by tests/oracles/certificate.py, from --candidates (Eq. 28)."""
import copy
import csv
import json
import pathlib
import sys

import numpy as np
import pytest

from support import call_conus

sys.path.append(str(pathlib.Path(__file__).parents[1] / "oracles"))
import certificate

SHAFTS = "needle\tposes\tradius\nA\ta.tsv\t0.5\nB\tb.tsv\t0.2\nC\tc.tsv\t\n"
ALIKE = 'needle\tposes\tpart\tonce\nP,Q\ta.tsv\t0.4,-2:1\t0\nP,Q,R\tb.tsv\t0.3,0:2,0.5,0,tip\t1\nR\tc.tsv\t\t0\n'


def write_poses(name, rng, count):
    """Needles into the U of the phantom, about along -x."""
    axes = np.column_stack([-np.ones(count), rng.normal(0, 0.05, (count, 2))])
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    at = np.column_stack([np.full(count, 40.0), rng.uniform(-5, 5, count), rng.uniform(3, 7, count)])
    rows = "".join(f"{name}-{i}\t" + "\t".join(f"{x:.17g}" for x in [*at[i], *axes[i], rng.uniform(22, 27)]) + "\n"
                   for i in range(count))
    pathlib.Path(f"{name}.tsv").write_text("query_id\tx\ty\tz\tdx\tdy\tdz\tfar\n" + rows)


def plan(seed, table, *options, of_all=("--reach", "U,length=2")):
    """(Plan, rows, candidates) of an answer in the current folder."""
    rng = np.random.default_rng(seed)
    call_conus("phantom", "u-shape", "-o", ".")
    for name in "abc":
        write_poses(name, rng, 30)
    pathlib.Path("needles.tsv").write_text(table)
    call_conus("plan", "u-shape.nii.gz", "--needles", "needles.tsv", *of_all, "-q", "--force", "-o",
               "plan.tsv", "--candidates", "candidates.tsv", *options)
    return (json.loads(pathlib.Path("plan.json").read_text())["Plan"], certificate.read_table("plan.tsv"),
            certificate.read_table("candidates.tsv"))


def write(sidecar, rows, candidates):
    pathlib.Path("plan.json").write_text(json.dumps({"Plan": sidecar}))
    for name, table in (("plan.tsv", rows), ("candidates.tsv", candidates)):
        with open(name, "w", newline="") as file:
            writer = csv.DictWriter(file, table[0], delimiter="\t")
            writer.writeheader()
            writer.writerows(table)


def confirm():
    return certificate.confirm("plan.tsv", "plan.json", "candidates.tsv")


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("table, options", [
    (SHAFTS, ["--between", "1"]),
    (SHAFTS, ["--between", "0.5,parts=0.3", "--entry-distance", "2", "--part", "0.4,-3:1", "--top", "3", "--diverse", "1.5"]),
    (ALIKE, ["--between", "0.4,parts=0.1", "--top", "2", "--diverse", "1,2", "--shanks", "0,0;0,0.5"]),
])
def test_answers_are_confirmed(seed, table, options):
    sidecar, rows, candidates = plan(seed, table, *options)
    assert sidecar["combinations"], "no combination: nothing is shown"
    assert confirm() == len(sidecar["combinations"])
    cuts = {needle["name"]: needle["cut_mm"] for needle in sidecar["needles"]}
    assert all(float(row["leeway_mm"]) >= cuts[row["needle"]] - 1e-9 for row in candidates)
    every = sum(len(row["needles"]) * row["feasible"] for row in sidecar["rows"])
    assert len(candidates) < every, "the cuts leave nothing out"


def test_given_needles_are_candidates():
    write_poses("a", np.random.default_rng(1), 1)
    pathlib.Path("given.tsv").write_text(pathlib.Path("a.tsv").read_text().replace("a-0", "A"))
    sidecar, _, candidates = plan(3, SHAFTS, "--between", "0.3", "--given", "given.tsv")
    assert confirm() == 1 and [row["query_id"] for row in candidates if row["needle"] == "A"] == ["A"]


@pytest.mark.parametrize("seed", range(4))
def test_a_second_best_is_refuted(seed):
    sidecar, rows, candidates = plan(seed, SHAFTS, "--between", "1", "--top", "2", "--diverse", "0")
    second = [{**row, "combination": "1"} for row in rows if row["combination"] == "2"]
    write({**sidecar, "combinations": sidecar["combinations"][1:], "top": 1, "diverse": None}, second, candidates)
    with pytest.raises(certificate.Refuted, match="combination 1: .* is better"):
        confirm()
    first = [row for row in rows if row["combination"] == "1"]
    write(sidecar, first + [{**row, "combination": "2"} for row in first], candidates)
    with pytest.raises(certificate.Refuted, match="combination 2: it is too much like one before it"):
        confirm()
    write({**sidecar, "combinations": [sidecar["combinations"][0], {**sidecar["combinations"][1], "last": True}]}, rows,
          candidates)
    with pytest.raises(certificate.Refuted, match="its cut is"):
        confirm()


@pytest.mark.parametrize("needle", range(3))
def test_a_cut_that_is_too_high_is_refuted(needle):
    sidecar, rows, candidates = plan(5, SHAFTS, "--between", "1")
    raised = copy.deepcopy(sidecar)
    raised["needles"][needle]["cut_mm"] += 3e-6  # 2 nm are forgiven
    write(raised, rows, candidates)
    with pytest.raises(certificate.Refuted, match="its cut is"):
        confirm()


def test_a_leeway_or_place_that_is_not_so_is_refuted():
    sidecar, rows, candidates = plan(5, SHAFTS, "--between", "1")
    write(sidecar, [{**row, "all_leeway_mm": str(float(row["all_leeway_mm"]) + 1e-5)} for row in rows], candidates)
    with pytest.raises(certificate.Refuted, match="its leeway is"):
        confirm()
    for name, value, why in (("all_leeway_mm", "n/a", "its leeway is"), ("all_sum_mm", "9", "all_sum_mm is"),
                             ("all_depth_mm", "9", "all_depth_mm is"), ("leeway_mm", "9", "another leeway in its row"),
                             ("feasible", "0", "not said to be"), ("combination", "2", "its rows are not")):
        write(sidecar, [*rows[:2], {**rows[2], name: value}], candidates)
        with pytest.raises(certificate.Refuted, match=why):
            confirm()
    write(sidecar, [{**rows[0], "y": str(float(rows[0]["y"]) + 1e-4)}, *rows[1:]], candidates)
    with pytest.raises(certificate.Refuted, match="0 candidates are its place"):
        confirm()


def test_what_is_not_there_is_refuted():
    sidecar, rows, candidates = plan(5, SHAFTS, "--between", "1")
    of_a = sorted((row for row in candidates if row["needle"] == "A"), key=lambda row: float(row["leeway_mm"]))
    chosen = next(row["query"] for row in rows if row["needle"] == "A")
    middle = next(row for row in of_a[:-1] if row["query_id"] != chosen)
    write(sidecar, rows, [row for row in candidates if row is not middle])
    with pytest.raises(certificate.Refuted, match=f"A: {len(of_a) - 1} of {len(of_a)} candidates are there"):
        confirm()
    fewer = [{**sidecar["needles"][0], "candidates": len(of_a) - 1}, *sidecar["needles"][1:]]
    write({**sidecar, "needles": fewer}, rows, [row for row in candidates if row is not of_a[-1]])
    with pytest.raises(certificate.Refuted, match="A: .* is not the largest leeway"):
        confirm()
    for key in ("largest_leeway_mm", "cut_mm"):
        needles = [{**sidecar["needles"][0], key: None}, *sidecar["needles"][1:]]
        write({**sidecar, "needles": needles}, rows, candidates)
        with pytest.raises(certificate.Refuted, match="A: .* is not said"):
            confirm()


def test_a_needle_of_which_some_candidates_have_leeways_has_a_cut():
    table = "needle\tposes\treach\tlength\nM\ta.tsv\tU,length=2\t\nM\tb.tsv\t\t1,90\nB\tc.tsv\tU,length=2\t\n"
    sidecar, rows, candidates = plan(2, table, "--between", "1", of_all=())
    assert confirm() == 1
    cut = sidecar["needles"][0]["cut_mm"]
    leeways = [row["leeway_mm"] for row in candidates if row["needle"] == "M"]
    assert leeways.count("n/a") == sidecar["rows"][1]["feasible"]
    assert min(float(leeway) for leeway in leeways if leeway != "n/a") >= cut - 1e-9
    assert len(leeways) < sidecar["rows"][0]["feasible"] + sidecar["rows"][1]["feasible"], "the cut leaves nothing out"
    sidecar["needles"][0]["candidates"] -= 1
    write(sidecar, rows, [row for row in candidates if row["query_id"] != "b-7"])
    with pytest.raises(certificate.Refuted, match="M: 29 of 30 candidates of row 2"):
        confirm()


def test_a_last_combination_is_confirmed_and_another_one_behind_it_refutes():
    sidecar, rows, candidates = plan(4, SHAFTS, "--between", "1", "--top", "100", "--diverse", "7,3")
    count = len(sidecar["combinations"])
    assert count > 1 and sidecar["combinations"][-1]["last"] and confirm() == count
    early = [*sidecar["combinations"][:-2], {**sidecar["combinations"][-2], "last": True}]
    write({**sidecar, "combinations": early}, [row for row in rows if row["combination"] != str(count)], candidates)
    with pytest.raises(certificate.Refuted, match="there is another combination behind the last one"):
        confirm()
