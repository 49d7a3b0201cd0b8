# SPDX-License-Identifier: BSD-3-Clause
"""The examples in Python, as plain scripts in an empty folder, and as notebooks."""
import base64
import csv
import functools
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import matplotlib.image
import nibabel
import numpy as np
import pytest

from support import AAL, needs_aal

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDER = ROOT / "examples"
pytestmark = needs_aal


def notebooks():
    """The scripts with cells."""
    return [path for path in FOLDER.glob("*.py") if "# %%" in path.read_text()]


@functools.cache
def run_example(name):
    """What the script prints, without a warning. It leaves one figure, with more than a few colours."""
    environment = {**os.environ, "MPLBACKEND": "agg"}
    with tempfile.TemporaryDirectory() as name_of_folder:
        folder = pathlib.Path(name_of_folder)
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
    assert {path.stem for path in notebooks()} == tested
    assert {path.stem for path in FOLDER.glob("*.py")} == tested | {"thousand_poses"}
    for path in notebooks():
        assert len(re.findall("^# %%$", path.read_text(), re.M)) >= 4


def test_a_thousand_poses_are_those_of_the_program(tmp_path):
    """The nearest contact of each pose's best area, with two decimals, is that of conus batch."""
    turns = np.arange(1000) * (2 * np.pi / 1000)
    rows = [f"{float(100 * np.cos(t))!r}\t{float(100 * np.sin(t))!r}\t0\t{float(-np.cos(t))!r}\t{float(-np.sin(t))!r}\t0" for t in turns]
    (tmp_path / "poses.tsv").write_text("x\ty\tz\tdx\tdy\tdz\n" + "\n".join(rows) + "\n")
    asked = [os.environ["CONUS"], "batch", AAL, "--poses", tmp_path / "poses.tsv", "--summary", "-q", "--format", "csv"]
    said = csv.DictReader(subprocess.run(asked, capture_output=True, text=True, check=True).stdout.splitlines())
    printed = subprocess.run([sys.executable, FOLDER / "thousand_poses.py", AAL], capture_output=True, text=True, check=True).stdout
    assert [f"{float(row['distance_mm']):.2f}" for row in said] == printed.split()


def test_tms_session_prints_the_numbers_of_the_recipe():
    """docs/recipes.md has them of the program: shares 0.557496428 and 0.442503572, p_hit 0.6094 and 0.3906."""
    printed = run_example("tms_session")
    assert "planned: Postcentral_L 55.7 %" in printed and "planned: Precentral_L 44.3 %" in printed
    assert "expected: Postcentral_L 60.9 %" in printed and "expected: Precentral_L 39.1 %" in printed


def test_probe_prints_where_its_areas_are():
    """docs/recipes.md has, by the program, entries 10.8036, 18.8435 and 22.3610 mm from the same origin."""
    printed = run_example("neuropixels_probe")
    lines = re.findall(r"^ *([\d.]+) to +([\d.]+) mm  (\w+)$", printed, re.M)
    spans = [(float(start), float(end), name) for start, end, name in lines]
    assert spans[0][0] == 0 and spans[-1][1] == 15 and all(a[1] == b[0] for a, b in zip(spans, spans[1:]))
    starts = {name: start for start, _, name in reversed(spans)}
    assert starts["l_middle_frontal_gyrus"] == pytest.approx(18.8435 - 10.8036, abs=0.006)
    assert starts["l_frontal_white_matter"] == pytest.approx(22.3610 - 10.8036, abs=0.006)


def test_overlap_prints_what_the_voxels_say():
    """Counted here: voxels whose centre is within 15 degrees of the axis, and at most 45 mm along it."""
    printed = run_example("atlas_overlap")
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


def test_notebooks_print_what_the_scripts_print(tmp_path):
    """Executed by IPython, cell by cell; each leaves one figure, too, and has all of the script's text and code."""
    for module in ("nbformat", "nbclient", "ipykernel"):
        pytest.importorskip(module)
    subprocess.run([ROOT / "scripts" / "notebooks", tmp_path / "made"], check=True)
    names = sorted(path.stem for path in notebooks())
    assert sorted(os.listdir(tmp_path / "made")) == [f"{name}.ipynb" for name in names]
    for name in names:
        notebook = json.loads((tmp_path / "made" / f"{name}.ipynb").read_text())
        outputs = [output for cell in notebook["cells"] for output in cell.get("outputs", [])]
        printed = "".join("".join(output["text"]) for output in outputs if output.get("name") == "stdout")
        assert printed == run_example(name)
        (figure,) = [output["data"]["image/png"] for output in outputs if output["output_type"] == "display_data"]
        assert base64.b64decode("".join(figure)).startswith(b"\x89PNG")
        words = [word for cell in notebook["cells"] for word in "".join(cell["source"]).split()]
        text = re.sub(r"(?m)^# %%.*\n", "", (FOLDER / f"{name}.py").read_text().split("\n", 1)[1])
        assert [word for word in words if word != "#"] == [word for word in text.split() if word != "#"]


def test_the_region_under_a_cursor_is_the_voxel_there():
    """Counted here: labels of voxels along the cursor's way in a slice, and the first one along each line of sight."""
    printed = run_example("region_under_cursor")
    image = nibabel.load(AAL)
    aal = np.asanyarray(image.dataobj)
    with open(AAL.replace(".gz", ".txt")) as table:
        names = {int(words[0]): words[1] for words in map(str.split, table) if words}
    inverse = np.linalg.inv(image.affine)

    def label(point):
        return aal[tuple(np.floor(nibabel.affines.apply_affine(inverse, point) + 0.5).astype(int))]

    slice_labels = [label((x, -20, 10)) for x in range(-75, 76)]
    wanted = ", ".join(names[number] for number in dict.fromkeys(slice_labels) if number)
    assert f"in the slice: {wanted}\n" in printed
    first = [next(filter(None, (label((x, y, 10)) for x in range(-90, 91))), 0) for y in range(-105, 76)]
    seen = re.search("in the view: (.*)", printed)[1].split(", ")
    on_axis = {names[number] for number in first if number}
    assert on_axis <= set(seen) and len(seen) <= len(on_axis) + 2  # a cone of 1 degree is 3.5 mm wide there
