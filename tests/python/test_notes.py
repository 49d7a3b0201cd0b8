# SPDX-License-Identifier: BSD-3-Clause
"""Warnings about poses are the program's notes. $CONUS is the program conus."""
import re
import warnings

import nibabel
import numpy as np
import pandas
import pytest

import conus
from support import call_conus

AWAY = "the cone points away from the atlas"
ORIGIN = "the device lies within 1 mm of the world's origin"
HIT = "it would hit cube first"
LPS = "with x and y negated (LPS for RAS)"

# The cube is 20 mm wide around (60, 50, 10), so that no pose hits it by chance when x and y are negated. Each pose has
# an origin, a direction, and its mistake: the step that makes it from (160, 50, 10) along (-1, 0, 0), which is right.
POSES = {
    "good": ((160, 50, 10), (-1, 0, 0), None),
    "good, near 0": ((0.6, 0.5, 0.1), (6, 5, 1), None),
    "LPS": ((-160, -50, 10), (1, 0, 0), f"{AWAY}; {LPS} {HIT}"),
    "reversed": ((160, 50, 10), (1, 0, 0), f"{AWAY}; looking the other way {HIT}"),
    "place": ((-160, -50, 10), (-1, 0, 0), f"{AWAY}; with x and y of its position negated (LPS for RAS) {HIT}"),
    "metres": ((0.16, 0.05, 0.01), (-1, 0, 0), f"{ORIGIN}; with its position times 1000 (metres for mm) {HIT}"),
    "LPS, metres": ((-0.16, -0.05, 0.01), (1, 0, 0), f"{ORIGIN}; {LPS} and times 1000 (metres) {HIT}"),
    "um": ((16e4, 5e4, 1e4), (-1, 0, 0), f"{AWAY}; with its position divided by 1000 (micrometres for mm) {HIT}"),
    "LPS, um": ((-16e4, -5e4, 1e4), (1, 0, 0), f"{AWAY}; {LPS} and divided by 1000 {HIT}"),
    "nowhere": ((160, 50, 10), (0, 0, 1), AWAY),
    "inside": ((60, 50, 10), (0, 0, 1), "the device lies inside cube"),
}


@pytest.fixture(name="image", scope="module")
def make_image():
    labels = np.zeros((20, 20, 20), "u1")
    labels[5:15, 5:15, 5:15] = 1
    return nibabel.Nifti1Image(labels, np.array([[2, 0, 0, 41], [0, 2, 0, 31], [0, 0, 2, -9], [0, 0, 0, 1]], float))


@pytest.fixture(name="cube", scope="module")
def make_cube(image):
    return conus.load(image, labels={1: "cube"})


@pytest.fixture(name="path")
def save_image(image, tmp_path):
    nibabel.save(image, tmp_path / "cube.nii")
    (tmp_path / "cube.tsv").write_text("index\tname\n1\tcube\n")
    return tmp_path / "cube.nii"


def warned(ask, *arguments, **options):
    """The texts of the warnings of a call, which are about the line that calls."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        ask(*arguments, **options)
    assert all(w.category is conus.PoseWarning and w.filename == __file__ for w in caught)
    return [str(w.message) for w in caught]


def noted(*arguments):
    """The program's notes about poses."""
    lines = call_conus(*arguments).stderr.decode().splitlines()
    return [re.split("note: |warning: ", line)[1] for line in lines if re.search("(device|cone|cylinder)s? ", line)]


@pytest.mark.parametrize("name", POSES)
def test_a_pose_has_the_warning_that_is_the_note_of_the_program(cube, path, name):
    origin, direction, note = POSES[name]
    wanted = [note] if note else []
    words = [f"--{n}={','.join(map(str, v))}" for n, v in (("origin", origin), ("direction", direction))]
    for ask in (cube.select, cube.selector().select, cube.sweep, cube.jitter):
        assert warned(ask, origin, direction=direction, angle=10) == wanted
    assert noted("query", path, *words, "--angle=10") == wanted


def test_a_selector_tells_of_each_pose_alone(cube):
    selector = cube.selector()
    for name in [*POSES, *reversed(POSES), *POSES]:
        origin, direction, note = POSES[name]
        assert warned(selector.select, origin, direction=direction) == ([note] if note else [])


def test_a_cylinder_points_away_and_may_begin_inside(cube):
    origin, direction, note = POSES["reversed"]
    assert warned(cube.select, origin, direction=direction, radius=2) == [note.replace("cone", "cylinder")]
    assert warned(cube.select, *POSES["inside"][:1], direction=(0, 0, 1), radius=2) == []


def test_what_is_near_a_point_has_no_warning(cube):
    assert warned(cube.near, (0.1, 0.1, 0.1), 1) == [] == warned(cube.near, (60, 50, 10), 1)


@pytest.mark.parametrize("names", [("good", "nowhere", "inside", "LPS", "inside"), ("um", "metres", "metres")])
def test_many_poses_have_the_notes_of_the_program(cube, path, tmp_path, names):
    """Line 1 of the file is its header, so that pose 0 is in line 2."""
    origins, directions = (np.array([POSES[name][i] for name in names], float) for i in (0, 1))
    table = pandas.DataFrame(np.hstack([origins, directions]), columns=["x", "y", "z", "dx", "dy", "dz"])
    table.to_csv(tmp_path / "poses.tsv", sep="\t", index=False)
    notes = noted("batch", path, "--poses", f"{tmp_path / 'poses.tsv'},unit=mm", "--angle=10")
    texts = [re.split(r"poses\.tsv(?:,unit=mm)?: ", note)[1] for note in notes[1:]]  # the first says what is asked
    texts = [re.sub(r"in line (\d+)", lambda m: f"is pose {int(m[1]) - 2}", text) for text in texts]
    assert warned(cube.select_many, origins, directions, angle=10) == texts
    assert len(texts) == (1 if "metres" in names else 2)


def test_good_poses_have_no_warning(cube):
    assert warned(cube.select_many, [POSES["good"][0]] * 3, [POSES["good"][1]] * 3) == []
