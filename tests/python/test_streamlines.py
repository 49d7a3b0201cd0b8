# SPDX-License-Identifier: BSD-3-Clause
"""Streamlines of an atlas: from files, from nibabel and from arrays they are the same."""
import json
import logging
import os
import pickle
import subprocess

import nibabel
import numpy as np
import pandas
import pytest

import conus
from support import AFFINE, NAMES, plates

# Lengths 3 + 4 = 7, and 12 mm.
LINES = [np.array([[0, 0, 0], [3, 0, 0], [3, 4, 0]], "f4"), np.array([[0, 0, -5], [0, 0, 7]], "f4")]


def load(*streamlines, **options):
    return conus.load(plates(), AFFINE, labels=NAMES, streamlines=streamlines, **options)


def tractogram(affine=None):
    fa = [np.array([[0.1], [0.2], [0.3]], "f4"), np.array([[0.4], [0.5]], "f4")]
    return nibabel.streamlines.Tractogram(
        LINES, data_per_point={"fa": fa}, data_per_streamline={"weight": [[1], [2]]},
        affine_to_rasmm=np.eye(4) if affine is None else affine)


def assert_lines(found, scale=1):
    assert (found.streamlines, found.points, found.length_mm) == (2, 5, 19 * scale)
    assert np.array_equal(found.box, scale * np.array([[0, 0, -5], [3, 4, 7]]))


def test_arrays_are_a_bundle():
    atlas = load(LINES, {"source": LINES, "radius": 0.25, "name": "Arc"})
    first, second = atlas.tractograms
    assert_lines(first)
    assert (first.path, first.format, first.sha256, first.radius) == ("array", "array", "", 0.5)
    assert (second.radius, second.bundles, second.scalars, second.half) == (0.25, ("Arc",), (), False)
    info = atlas.info()
    assert list(info["kind"][-2:]) == ["bundle", "bundle"]
    assert list(info["name"][-2:]) == ["array", "Arc"]
    assert list(info["streamlines"])[-2:] == [2, 2] and list(info["length_mm"])[-1] == 19
    assert not info["streamlines"][:-2].any()
    assert conus.load(plates(), AFFINE).tractograms == []


def test_a_tractogram_is_told_by_its_beginning(tmp_path):
    nibabel.streamlines.save(tractogram(), str(tmp_path / "a.tck"))
    (tmp_path / "b.tck").write_text("nothing of the kind")
    assert conus.is_tractogram(tmp_path / "a.tck")
    assert not conus.is_tractogram(tmp_path / "b.tck") and not conus.is_tractogram(tmp_path / "none.tck")


def test_sides_are_of_areas():
    labels = pandas.DataFrame({"index": [1, 2], "name": ["Left_Plate", "Plate"], "hemisphere": [None, "R"]})
    atlas = conus.load(plates(), AFFINE, labels=labels, streamlines=[LINES])
    assert atlas.sides.tolist() == ["", "L", "R", ""]


@pytest.mark.parametrize("ending", ["tck", "trk"])
def test_files_are_as_nibabel_wrote_them(tmp_path, ending):
    path = tmp_path / f"lines.{ending}"
    nibabel.streamlines.save(tractogram(), str(path))
    (found,) = load(path).tractograms
    assert_lines(found)
    assert found.bundles == ("lines",) and len(found.sha256) == 64
    assert found.scalars == (("fa", "weight") if ending == "trk" else ())
    (again,) = load(nibabel.streamlines.load(str(path))).tractograms
    assert_lines(again)
    assert again.scalars == found.scalars and again.path == "nibabel tractogram"


def test_nibabel_s_affine_places_the_points():
    (found,) = load(tractogram(np.diag([2, 2, 2, 1]))).tractograms
    assert_lines(found, 2)
    assert found.scalars == ("fa", "weight")


def test_a_copy_in_another_process_has_them():
    (found,) = pickle.loads(pickle.dumps(load(tractogram()))).tractograms
    assert_lines(found)
    assert found.scalars == ("fa", "weight")


def test_no_streamline_at_all():
    (found,) = load([]).tractograms
    assert (found.streamlines, found.points) == (0, 0) and np.isnan(found.box).all()


@pytest.mark.parametrize("bad, message", [
    ([np.zeros((4, 2))], r"number 0 \(from 0\) has the shape \(4, 2\)"),
    ({"radius": 1}, "wanted are source"),
    (3, "3, wanted are paths"),
    ({"source": LINES, "width": 1}, "wanted are source"),
    ({"source": LINES, "radius": -1}, "radius -1 mm, allowed is above 0 to 100"),
    ({"source": LINES, "radius": "thin"}, "radius"),
    ([np.full((2, 3), np.nan)], "found"),
    (nibabel.streamlines.Tractogram(LINES), "affine_to_rasmm is None"),
])
def test_what_is_none_is_refused(bad, message):
    with pytest.raises(conus.Error, match=message):
        load(bad)


def test_one_that_is_no_list_is_refused():
    for one in ("lines.tck", tractogram(), {"source": LINES}):
        with pytest.raises(conus.ArgumentError, match="wanted is a list"):
            conus.load(plates(), AFFINE, streamlines=one)


def test_a_missing_file_and_another_space(tmp_path, caplog):
    with pytest.raises(conus.FileError):
        load(tmp_path / "none.tck")
    with caplog.at_level(logging.INFO, "conus"):
        atlas = load([line + 500 for line in LINES])
    note = "bundle array: none of 5 points is in the box around the areas: is it in their space?"
    assert note in atlas.notes and any(note in record.getMessage() for record in caplog.records)


def test_a_space_that_is_stated(tmp_path):
    """x and y of LPS change their signs, of arrays and of files that do not state a space, as DIPY's VTK."""
    file = tmp_path / "lines.vtk"
    file.write_text("# vtk DataFile Version 3.0\nnone\nASCII\nDATASET POLYDATA\nPOINTS 5 float\n"
                    "0 0 0 3 0 0 3 4 0 0 0 -5 0 0 7\nLINES 2 7 3 0 1 2 2 3 4\n")
    turned = [[-3, -4, -5], [0, 0, 7]]
    for source in (file, LINES, tractogram()):
        first, second = load({"source": source, "space": "lps", "name": "a"}, {"source": source, "name": "b"}).tractograms
        assert np.array_equal(first.box, turned)
        assert_lines(second)
    with pytest.raises(conus.ArgumentError, match="streamlines: space: 'las', allowed is as-stated, ras, lps"):
        load({"source": LINES, "space": "las"})


def test_what_moves_goes_with_the_atlas():
    back = np.eye(4)
    back[0, 3] = -30  # so the atlas is moved by 30 mm along x
    first, second = load(LINES, {"source": LINES, "moves": True, "name": "Own"}, transforms=[back]).tractograms
    assert first.bundles == ("Own",) and np.array_equal(first.box, [[30, 0, -5], [33, 4, 7]])
    assert_lines(second)
    with pytest.raises(conus.ArgumentError, match="there is no transform that could move them"):
        load({"source": LINES, "moves": True})
    with pytest.raises(conus.ArgumentError, match="moves"):
        load({"source": LINES, "moves": 2}, transforms=[back])


def test_the_streamlines_that_come_in(tmp_path):
    away = [line + np.float32(10) for line in LINES]  # "away" has 0 at (10 to 13, 10 to 14, 10), 1 at (10, 10, 5 to 17)
    atlas = load(LINES, {"source": LINES + away, "name": "Arc"})
    found = atlas.near((3, 4, 0), 1).streamlines()
    assert len(found) == 2 and found.tractograms.tolist() == [0, 1] and found.numbers.tolist() == [0, 0]
    assert all(line.dtype == np.float32 and np.array_equal(line, LINES[0]) for line in found)
    found = atlas.near((10, 10, 10), 20).streamlines("Arc")
    assert found.tractograms.tolist() == [1] * 4 and found.numbers.tolist() == [0, 1, 2, 3]
    for line, wanted in zip(found, LINES + away):
        assert np.array_equal(line, wanted)
    assert np.array_equal(found[-1], away[1]) and found.numbers.dtype == np.uint32
    with pytest.raises(IndexError):
        found[4]
    # A cylinder about the axis z that holds line 1 alone, in whole: a range leaves the plane of line 0 out.
    cone = atlas.select((0, 0, 10), toward=(0, 0, 0), radius=0.5, range=(2, 9))
    found = cone.streamlines("array")
    assert found.numbers.tolist() == [1] and np.array_equal(found[0], LINES[1])
    del atlas, cone
    found.save(tmp_path / "in.tck")
    (again,) = nibabel.streamlines.load(str(tmp_path / "in.tck")).streamlines
    assert np.array_equal(again, LINES[1])
    with pytest.raises(conus.FileError):
        found.save(tmp_path / "none" / "in.tck")


def test_a_ball_has_the_columns_of_the_program():
    """LINES[0] goes 3 mm along x and then 4 along y; a ball of 1 mm round its corner holds 1 mm of each."""
    row = load(LINES).near((3, 0, 0), 1).to_dataframe().set_index("kind").loc["bundle"]
    assert (row["streamlines"], row["streamlines_total"]) == (1, 2) and row["length_mm"] == pytest.approx(2)
    assert (row["near_x"], row["near_y"], row["near_z"]) == (3, 0, 0) and row["along"] == pytest.approx(3 / 7)
    assert row["distance_mm"] == 0


def test_no_streamlines_of_what_is_no_bundle():
    atlas = load(LINES)
    ball = atlas.near((30, 30, 30), 1)
    assert len(ball.streamlines()) == 0 and list(ball.streamlines("array")) == []
    with pytest.raises(conus.ArgumentError, match="a bundle is needed"):
        ball.streamlines("left")
    with pytest.raises(conus.ArgumentError, match="there is no bundle"):
        conus.load(plates(), AFFINE).near((0, 0, 0), 1).streamlines()
    with pytest.raises(conus.ArgumentError, match="array is hidden"):
        load(LINES, hide="array").near((0, 0, 0), 1).streamlines("array")


def test_the_bundle_phantom_lies_on_its_rings(tmp_path):
    subprocess.run([os.environ["CONUS"], "phantom", "bundle", "-o", tmp_path], check=True)
    rings = json.loads((tmp_path / "bundle.json").read_text())["rings"]
    lines = list(nibabel.streamlines.load(str(tmp_path / "bundle.tck")).streamlines)
    assert len(lines) == sum(ring["count"] for ring in rings) == 144
    for ring, line in zip(np.repeat(rings, 12), lines):
        assert np.allclose(np.hypot(line[:, 0], line[:, 1]), ring["radius"], atol=2e-6, rtol=0)
        assert np.array_equal(line[:, 2], np.arange(-30, 31))
        steps = np.linalg.norm(np.diff(line.astype("f8"), axis=0), axis=1)
        assert steps.sum() == pytest.approx(ring["length_mm"], rel=1e-6)
    # The closed form for a cone from (0, 0, 100): its points decide, by the deepest one.
    for reach in (0.5, 3.5, 8.5, 13):
        slope = reach / 130
        inside = sum((np.hypot(line[:, 0], line[:, 1]) <= (100 - line[:, 2]) * slope).any() for line in lines)
        assert inside == 12 * min(int(reach), 12)
