# SPDX-License-Identifier: BSD-3-Clause
"""The examples in Python, as plain scripts in an empty folder."""
import os
import pathlib
import re
import subprocess
import sys

import matplotlib.image
import nibabel
import numpy as np
import pytest

from support import AAL, needs_aal

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "examples"
pytestmark = needs_aal


def run_example(name, folder):
    """What the script prints, without a warning. It leaves one figure, with more than a few colours."""
    environment = {**os.environ, "MPLBACKEND": "agg"}
    done = subprocess.run(
        [sys.executable, "-W", "error::UserWarning", FOLDER / f"{name}.py"],
        cwd=folder, env=environment, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert os.listdir(folder) == [f"{name}.png"]
    figure = matplotlib.image.imread(folder / f"{name}.png")
    assert figure.shape[0] >= 400 and len(np.unique(figure.reshape(-1, 4), axis=0)) > 50
    return done.stdout


def test_every_script_is_tested_and_its_cells_are_marked():
    tested = set(re.findall(r'run_example\("(\w+)"', pathlib.Path(__file__).read_text()))
    assert {path.stem for path in FOLDER.glob("*.py")} == tested
    for path in FOLDER.glob("*.py"):
        assert len(re.findall("^# %%$", path.read_text(), re.M)) >= 4


def test_tms_session_prints_the_numbers_of_the_recipe(tmp_path):
    """docs/recipes.md has them of the program: shares 0.551742113 and 0.448257887, p_hit 0.6152 and 0.3848."""
    printed = run_example("tms_session", tmp_path)
    assert "planned: Postcentral_L 55.2 %" in printed and "planned: Precentral_L 44.8 %" in printed
    assert "expected: Postcentral_L 61.5 %" in printed and "expected: Precentral_L 38.5 %" in printed


def test_probe_prints_where_its_areas_are(tmp_path):
    """docs/recipes.md has, by the program, entries 10.8036, 18.8435 and 22.3610 mm from the same origin."""
    printed = run_example("neuropixels_probe", tmp_path)
    lines = re.findall(r"^ *([\d.]+) to +([\d.]+) mm  (\w+)$", printed, re.M)
    spans = [(float(start), float(end), name) for start, end, name in lines]
    assert spans[0][0] == 0 and spans[-1][1] == 15 and all(a[1] == b[0] for a, b in zip(spans, spans[1:]))
    starts = {name: start for start, _, name in reversed(spans)}
    assert starts["l_middle_frontal_gyrus"] == pytest.approx(18.8435 - 10.8036, abs=0.006)
    assert starts["l_frontal_white_matter"] == pytest.approx(22.3610 - 10.8036, abs=0.006)


def test_overlap_prints_what_the_voxels_say(tmp_path):
    """Counted here: voxels whose centre is within 15 degrees of the axis, and at most 45 mm along it."""
    printed = run_example("atlas_overlap", tmp_path)
    image = nibabel.load(AAL)
    aal, fields = (np.asanyarray(nibabel.load(AAL.replace("aal", name)).dataobj) for name in ("aal", "brodmann"))
    centres = nibabel.affines.apply_affine(image.affine, np.argwhere(aal)) - [-52, -28, 84]
    axis = np.array([15, 6, -29]) / np.linalg.norm([15, 6, -29])
    along = centres @ axis
    inside = (along >= np.linalg.norm(centres, axis=1) * np.cos(np.radians(15))) & (along <= 45)
    voxels = np.argwhere(aal)[inside]
    labels, numbers = aal[tuple(voxels.T)], fields[tuple(voxels.T)]
    for gyrus, label, field in (("Precentral_L", 1, 4), ("Postcentral_L", 57, 3)):
        of_gyrus = numbers[(labels == label) & (numbers > 0)]
        assert f"{gyrus}: BA {field} is {100 * (of_gyrus == field).mean():.0f} % of what both atlases name" in printed
