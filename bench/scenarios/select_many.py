# SPDX-License-Identifier: BSD-3-Clause
"""select_many.py ATLAS POSES ROWS ANGLE: the part of the scenario `python` that runs in Python.

POSES is a table with x, y, z, tx, ty, tz; ROWS is where `conus batch` writes. For each line read, it works and answers
with a line. "many": loads the atlas and makes a DataFrame of all answers. "read": reads ROWS into one. "same": yes if
the two last made hold the same numbers, but for rounding to the nine digits of ROWS.
"""
import sys

import numpy as np
import pandas

import conus

ATLAS, POSES, ROWS, ANGLE = sys.argv[1:]
FRAMES = {}


def many():
    poses = np.loadtxt(POSES, skiprows=1, ndmin=2)
    answers = conus.load(ATLAS).select_many(poses[:, :3], poses[:, 3:] - poses[:, :3], angle=float(ANGLE), resolution=16)
    FRAMES["many"] = answers.to_dataframe()
    return "done"


def read():
    FRAMES["read"] = pandas.read_csv(ROWS, sep="\t", na_values="n/a", keep_default_na=False)
    return "done"


def same():
    ours, theirs = FRAMES["many"], FRAMES["read"]
    if len(ours) != len(theirs) or list(ours.columns) != list(theirs.columns):
        return "no"
    for column in ours.columns:
        a, b = ours[column], theirs[column]
        if a.dtype.kind not in "iuf":
            equal = list(a.astype(object).fillna("")) == list(b.astype(object).fillna(""))
        else:
            equal = np.allclose(a.astype(float), b.astype(float), rtol=1e-8, atol=1e-9, equal_nan=True)
        if not equal:
            return "no"
    return "yes"


print("ready", flush=True)
for line in sys.stdin:
    print({"many": many, "read": read, "same": same}[line.strip()](), flush=True)
