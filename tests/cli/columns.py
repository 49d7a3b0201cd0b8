# SPDX-License-Identifier: BSD-3-Clause
"""columns.py CONUS TABLE...: changes the first number in each column of each result by 0.25, and asks `conus diff
--tolerance 0.5`, which must take it for the same unless the column is one of names and labels. Prints what is not so,
and how many columns were tried."""
import subprocess
import sys
import tempfile

NAMES = {"query", "kind", "index", "name", "abbreviation", "atlas", "bundle", "end_a", "end_b", "bundle_index",
         "end_a_index", "end_b_index", "runner_up", "runner_up_index", "pathway", "error"}
KEYS = {"query", "kind", "index", "atlas", "i", "j", "k", "order", "bundle_index", "end_a_index", "end_b_index", "end_a",
        "end_b"}  # keys of rows that belong together


def is_number(cell):
    try:
        return cell != "n/a" and abs(float(cell)) >= 0
    except ValueError:
        return False


conus, *paths = sys.argv[1:]
tried = 0
for path in paths:
    with open(path, encoding="utf-8") as file:
        header, *rows = [line.rstrip("\n").split("\t") for line in file]
    if "kind" not in header or "query" not in header:
        continue
    for column, name in enumerate(header):
        row = next((at for at, cells in enumerate(rows) if is_number(cells[column])), None)
        if row is None or name in KEYS:
            continue
        cells = [list(line) for line in rows]
        cells[row][column] = repr(float(cells[row][column]) + 0.25)
        with tempfile.NamedTemporaryFile("w", suffix=".tsv") as file:
            file.write("".join("\t".join(line) + "\n" for line in [header, *cells]))
            file.flush()
            code = subprocess.run([conus, "diff", path, file.name, "--tolerance", "0.5"], stdout=subprocess.DEVNULL).returncode
        tried += 1
        if (code == 0) == (name in NAMES):
            print(f"{path}: {name}: exit code {code}")
print(f"{tried} columns tried")
