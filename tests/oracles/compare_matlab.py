#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The reader of MATLAB's files against scipy's, on files that MATLAB wrote: those that Debian's python3-scipy has for its
own tests, of MATLAB 5.3 to 8, of Solaris (big-endian), Linux and Windows, packed and not.

usage: compare_matlab.py DUMP_MATLAB; exit 77 = skipped."""

import json
import os
import subprocess
import sys
import warnings

try:
    import numpy as np
    import scipy.io
except ImportError:
    print("skipped: no python3-scipy")
    sys.exit(77)

FOLDER = os.path.join(os.path.dirname(scipy.io.__file__), "matlab", "tests", "data")

# A name that is not ASCII, which scipy refuses, and fields of one name, which scipy renames; conus finds the first.
LEFT_OUT = {"bad_miutf8_array_name.mat", "nasty_duplicate_fieldnames.mat"}


def plain(value):
    """What scipy gives, as dump_matlab writes it; None for what conus does not read."""
    is_object = isinstance(value, (scipy.io.matlab.MatlabObject, scipy.io.matlab.MatlabFunction))
    if is_object or not isinstance(value, np.ndarray) or value.dtype.kind == "c":
        return None
    if value.dtype.names:
        return [{name: plain(element[name]) for name in value.dtype.names} for element in value.ravel("F")]
    if value.dtype.kind == "U":
        return "" if value.size == 0 else str(value[0]) if value.size == 1 else None
    if value.dtype.kind == "O":  # cells; an element that is None is a structure without fields
        return [{} if element is None else plain(element) for element in value.ravel("F")]
    return {"rows": value.shape[0], "columns": value.shape[1], "values": [float(n) for n in value.ravel("F")]}


def known(variables):
    """Those that are read; MATLAB's notes to itself have no name."""
    return {name: value for name, value in variables.items() if name and value is not None}


def read_by_scipy(path):
    """The variables, or None where scipy refuses the file, too."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            variables = scipy.io.loadmat(path, struct_as_record=True)
    except Exception as error:  # pylint: disable=broad-except; of many kinds
        print(f"{os.path.basename(path)}: scipy: {error}")
        return None
    return known({name: plain(value) for name, value in variables.items() if not name.startswith("__")})


def main():
    dump = sys.argv[1]
    if not os.path.isdir(FOLDER):
        print("skipped: python3-scipy without the files of its tests")
        sys.exit(77)
    counts = {"equal": 0, "refused by both": 0, "different": 0}
    for name in sorted(os.listdir(FOLDER)):
        path = os.path.join(FOLDER, name)
        with open(path, "rb") as file:
            if file.read(19) != b"MATLAB 5.0 MAT-file" or name in LEFT_OUT:
                continue
        run = subprocess.run([dump, path], capture_output=True, text=True, errors="replace", check=False)
        wanted = read_by_scipy(path)
        got = known(json.loads(run.stdout)) if run.returncode == 0 else None
        same = got == wanted
        counts["different" if not same else "equal" if got is not None else "refused by both"] += 1
        if not same:
            print(f"{name}: {run.stderr.strip() or str(got)[:300]}, scipy has {str(wanted)[:300]}")
    print(", ".join(f"{count} files {what}" for what, count in counts.items()))
    return 1 if counts["different"] or counts["equal"] < 50 else 0


if __name__ == "__main__":
    sys.exit(main())
