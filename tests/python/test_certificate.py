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


def plan(seed, table, *options):
    """(Plan, rows, candidates) of an answer in the current folder."""
    rng = np.random.default_rng(seed)
    call_conus("phantom", "u-shape", "-o", ".")
    for name in "abc":
        write_poses(name, rng, 30)
    pathlib.Path("needles.tsv").write_text(table)
    call_conus("plan", "u-shape.nii.gz", "--needles", "needles.tsv", "--reach", "U,length=2", "-q", "--force", "-o",
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
    write(sidecar, [{**rows[0], "y": str(float(rows[0]["y"]) + 1e-4)}, *rows[1:]], candidates)
    with pytest.raises(certificate.Refuted, match="0 candidates are its place"):
        confirm()
