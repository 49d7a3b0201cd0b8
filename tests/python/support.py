# SPDX-License-Identifier: BSD-3-Clause
"""The atlases of the tests, and the program's answers as tables."""
import io
import os
import pathlib
import re
import subprocess

import numpy as np
import pandas
import pytest

AAL = os.path.abspath("/usr/share/mricron/templates/aal.nii.gz")  # on Windows with its drive
needs_aal = pytest.mark.skipif(not os.path.exists(AAL), reason="mricron-data is not installed")

AFFINE = np.array([[2, 0, 0, -39], [0, 2, 0, -29], [0, 0, 2, -29], [0, 0, 0, 1]], float)
NAMES = {1: "left", 2: "right"}


def plates(dtype="u1", order="C"):
    """Two plates of 20 mm before x = -20 and behind x = 20; the middle of the array is the origin."""
    labels = np.zeros((40, 30, 30), dtype, order)
    labels[:10], labels[30:] = 1, 2
    return labels


def page_blocks():
    """The Python of docs/python.md, block by block."""
    page = pathlib.Path(__file__).parents[2] / "docs" / "python.md"
    return re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), re.S)


def same(a, b):
    """Whether records are equal to the bit, but for the bytes between their members."""
    return len(a) == len(b) and all(
        np.ascontiguousarray(a[m]).tobytes() == np.ascontiguousarray(b[m]).tobytes() for m in a.dtype.names
    )


def call_conus(*arguments):
    """The program, done; a step without an answer (1) is no failure."""
    done = subprocess.run([os.environ["CONUS"], *map(str, arguments)], capture_output=True, check=False)
    assert done.returncode in (0, 1), done.stderr.decode()
    return done


def run_conus(*arguments):
    """The table that the program writes."""
    return pandas.read_csv(io.BytesIO(call_conus(*arguments).stdout), sep="\t", na_values="n/a", keep_default_na=False)


def assert_rows_of_the_program(frame, rows):
    """The frame has the program's columns, in its order, and its values, to the digits that it writes: "n/a" is missing.

    Only the column query may be left out, of one pose.
    """
    assert list(frame.columns) == [c for c in rows.columns if c != "query" or "query" in frame.columns]
    assert len(frame) == len(rows)
    for column in frame.columns:
        ours, theirs = frame[column], rows[column]
        assert list(ours.isna()) == list(theirs.isna()), column
        ours, theirs = ours[ours.notna()], theirs[theirs.notna()]
        if theirs.dtype == object:
            assert list(ours.astype(str)) == list(theirs.astype(str)), column
        else:
            np.testing.assert_allclose(ours.astype(float), theirs, rtol=1e-8, atol=1e-9, err_msg=column)
