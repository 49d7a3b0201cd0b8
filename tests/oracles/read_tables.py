#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""What conus writes, as pandas and the rules of BIDS and AFNI read it.

Every table of query, batch, sweep and track, with a pose that has no answer in it: columns are those that the sidecar
describes, numbers are numbers, n/a is missing, and TSV, NDJSON and JSON are the same table. A table of electrodes keeps
BIDS's rules for columns (initial columns in their order, unique names, no empty cell, described additions), AFNI's tables
the print formats of whereami (thd_ttatlas_query.c), and both have the answers of the TSV.

usage: read_tables.py CONUS; exit 77 = skipped."""

import csv
import json
import os
import re
import subprocess
import sys
import tempfile

try:
    import numpy as np
    import pandas as pd
except ImportError:
    print("skipped: no python3-pandas")
    sys.exit(77)

TEXTS = {"query", "kind", "name", "abbreviation", "measured", "runner_up", "error", "pathway",
         "area", "area_error"}
POSES = """query_id\tx\ty\tz\tdx\tdy\tdz\ttime_s
first\t0\t0\t90\t0\t0\t-1\t0
5"x"\t0\t90\t0\t0\t-1\t0\t0.1
lost\t0\t90\t0\t0\t0\t0\t0.2
past\t0\t90\t0\t0\t1\t0\t0.3
"""
ELECTRODES = """name\tx\ty\tz\tsize\tgroup
A1\t0\t9\t0\t2\tA
A2\t0\t0\t0\tn/a\tA
A3\tn/a\tn/a\tn/a\t2\tA
B1\t0\t-9\t0\t2\tB
"""


def run(conus, *words, code=0):
    more = [] if words[0] == "phantom" else ["--quiet", "--force"] if "-o" in words else ["--quiet"]
    result = subprocess.run([conus, *words, *more], capture_output=True, text=True, check=False)
    assert result.returncode == code, (words, result.returncode, result.stderr)
    return result.stdout


def read_tsv(path):
    """As a user reads it. conus quotes nothing, so that quotation marks are letters."""
    return pd.read_csv(path, sep="\t", quoting=csv.QUOTE_NONE, na_values=["n/a"], keep_default_na=False,
                       float_precision="round_trip")


def check_columns(table, sidecar):
    described = [key for key, value in sidecar.items() if isinstance(value, dict) and "Description" in value]
    assert list(table.columns) == described, (list(table.columns), described)
    for column in table.columns:
        is_text = table[column].dtype == object
        missing = table[column].isna().all()  # is float then
        assert missing or is_text == (column in TEXTS), (column, table[column].dtype)


def same(one, other, what, tolerance=0.0):
    assert list(one.columns) == list(other.columns), what
    assert len(one) == len(other), what
    for column in one.columns:
        a, b = one[column], other[column]
        assert (a.isna() == b.isna()).all(), (what, column)
        if column in TEXTS:
            assert (a.dropna() == b.dropna()).all(), (what, column)
        else:
            assert np.allclose(a.dropna().astype(float), b.dropna().astype(float), tolerance, 0), (what, column)


def check_tables(conus, words, rows):
    """One command in all formats; *rows* is how many there must be, None = some."""
    run(conus, *words, "-o", "rows.tsv", code=1)
    table = read_tsv("rows.tsv")
    with open("rows.json", encoding="utf-8") as file:
        check_columns(table, json.load(file))
    assert rows is None or len(table) == rows, (words, len(table))
    queries = set(table["query"])
    assert {"first", '5"x"'} <= queries, queries
    if "lost" in queries:  # conus track leaves such a row out
        lost = table[table["query"] == "lost"]
        assert list(lost["kind"]) == ["error"]
        reason = lost["error"] if "error" in table else lost["name"]
        assert reason.iloc[0].startswith("line 4: direction: ")
        kept = ["query", "row", "time_s", "kind", "error" if "error" in table else "name"]
        assert lost.drop(columns=kept, errors="ignore").isna().all(axis=None)
    run(conus, *words, "-o", "rows.ndjson", code=1)
    same(table, pd.read_json("rows.ndjson", lines=True, convert_dates=False, dtype=False, precise_float=True), words)
    if words[0] != "batch":
        run(conus, *words, "-o", "whole.json", code=1)
        with open("whole.json", encoding="utf-8") as file:
            same(table, pd.DataFrame(json.load(file)["Rows"], columns=table.columns), words, 5e-9)  # track has more digits
    return len(table)


def check_voxels(conus):
    run(conus, "query", "slabs.nii.gz", "--point", "0,0,0", "--radius", "8", "--voxels", "voxels.tsv", "--voxels-of", "all")
    table = read_tsv("voxels.tsv")
    assert len(table) > 100
    assert (np.hypot(np.hypot(table["x"], table["y"]), table["z"]) <= 8).all()
    assert set(table["kind"]) == {"area"} and table["pathway"].isna().all() == table["value"].isna().all()


def check_electrodes(conus):
    """Rules of BIDS 1.8 for *_electrodes.tsv of iEEG, and for tables and additional columns."""
    run(conus, "batch", "slabs.nii.gz", "--poses", "in_electrodes.tsv", "--radius", "3", "--format", "bids", "-o",
        "out_electrodes.tsv", code=1)
    run(conus, "batch", "slabs.nii.gz", "--poses", "in_electrodes.tsv", "--radius", "3", "--summary", "--layers", "all",
        "-o", "summary.tsv")
    with open("out_electrodes.tsv", encoding="utf-8", newline="") as file:
        text = file.read()
    assert text.endswith("\n") and "\r" not in text and not text.startswith("\ufeff")
    cells = [line.split("\t") for line in text.splitlines()]
    assert cells[0][:5] == ["name", "x", "y", "z", "size"]
    assert len(set(cells[0])) == len(cells[0])
    assert all(len(row) == len(cells[0]) and all(cell.strip() == cell != "" for cell in row) for row in cells)
    assert len({row[0] for row in cells}) == len(cells)
    with open("out_electrodes.json", encoding="utf-8") as file:
        sidecar = json.load(file)
    for column in cells[0][6:]:
        assert re.fullmatch("[a-z][a-z0-9_]*", column) and sidecar[column]["Description"], column
    table, before, summary = read_tsv("out_electrodes.tsv"), read_tsv("in_electrodes.tsv"), read_tsv("summary.tsv")
    assert before.equals(table[before.columns])
    assert list(table["area"].fillna("-")) == ["Slab anterior", "unassigned", "-", "Slab posterior"]
    placed = table[table["x"].notna()].reset_index(drop=True)  # a summary passes over a contact without a position
    for ours, theirs in (("area", "name"), ("area_index", "index"), ("area_share", "share"), ("area_distance_mm", "distance_mm"),
                         ("runner_up", "runner_up"), ("runner_up_share", "runner_up_share"), ("area_error", "error")):
        assert [*placed[ours].fillna("n/a")] == [*summary[theirs].fillna("n/a")], ours


def check_afni(conus):
    """The blocks of whereami -tab, cell by cell by the formats that they are printed with."""
    with open("points.txt", "w", encoding="utf-8") as file:
        file.write("0 9 0\n0.4 1.5 -3\n-12 -2 0\n0 60 0\n")
    text = run(conus, "batch", "slabs.nii.gz", "--poses", "points.txt", "--radius", "9.5", "--format", "afni")
    run(conus, "batch", "slabs.nii.gz", "--poses", "points.txt", "--radius", "9.5", "--layers", "all", "-o", "near.tsv")
    near = read_tsv("near.tsv")
    blocks = text.split("+++++++ nearby Atlas structures +++++++\n")
    assert blocks[0] == "" and len(blocks) == 5
    for number, block in enumerate(blocks[1:], 1):
        lines = block.split("\n")
        assert lines[0] == "" and lines[1] == "%-36s\t%-12s" % ("Focus point (LPI)", "Coord.Space")
        assert re.fullmatch(r"[ \d-]{4} mm \[[RL]\],[ \d-]{4} mm \[[AP]\],[ \d-]{4} mm \[[SI]\] *\t\{\w+\} *", lines[2]), lines[2]
        assert lines[3] == "%-15s\t%-3s\t%-32s\t%-3s\t%-3s" % ("Atlas", "Within", "Label", "Prob.", "Code")
        wanted = near[(near["query"] == number) & (near["kind"] == "area")].sort_values("distance_mm", kind="stable")
        rows = [line for line in lines[4:] if "\t" in line]
        assert rows or lines[4] == "***** Not near any region stored in databases *****"
        assert rows == ["%-15s\t%-3s\t%-32s\t%-3s\t%-3d" % ("slabs", "%.1f" % row.distance_mm, row.name_, "---", row.index_)
                        for row in wanted.rename(columns={"name": "name_", "index": "index_"}).itertuples()], rows


def main():
    conus = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        run(conus, "phantom", "slabs", "-o", ".")
        for name, text in (("poses.tsv", POSES), ("in_electrodes.tsv", ELECTRODES)):
            with open(name, "w", encoding="utf-8") as file:
                file.write(text)
        atlas = "slabs.nii.gz"
        rows = check_tables(conus, ["query", atlas, "--pose", "poses.tsv"], None)
        check_tables(conus, ["batch", atlas, "--poses", "poses.tsv"], rows)
        check_tables(conus, ["query", atlas, "--pose", "poses.tsv", "--layers", "all"], None)
        check_tables(conus, ["batch", atlas, "--poses", "poses.tsv", "--summary"], 4)
        check_tables(conus, ["sweep", atlas, "--pose", "poses.tsv", "--angle", "40"], None)
        check_tables(conus, ["sweep", atlas, "--pose", "poses.tsv", "--angles", "2,4"], None)
        check_tables(conus, ["sweep", atlas, "--pose", "poses.tsv", "--jitter", "2,2", "--samples", "16"], None)
        check_tables(conus, ["track", atlas, "--poses", "poses.tsv"], None)
        check_voxels(conus)
        check_electrodes(conus)
        check_afni(conus)
        os.chdir("/")
    print("every table is what its readers expect")


main()
