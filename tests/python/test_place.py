# SPDX-License-Identifier: BSD-3-Clause
"""Places in words: as points of cones and balls, and what is refused."""
import numpy as np
import pytest

import conus

# Two blocks of 7 x 5 x 5 voxels of 1 mm, mirror images of each other, and one area on both sides.
LABELS = np.zeros((24, 9, 9), "u1")
LABELS[1:8, :5, :5], LABELS[16:23, :5, :5], LABELS[1:23, 6:9, 6:9] = 1, 2, 3
LABELS[8:16, 6:9, 6:9] = 0
AFFINE = np.eye(4)
AFFINE[:3, 3] = [-11.5, -4, -4]
NAMES = {1: "Core_L", 2: "Core_R", 3: "Both"}


@pytest.fixture
def atlas():
    return conus.load(LABELS, AFFINE, labels=NAMES)


def test_words_become_points(atlas):
    place = atlas.place("left core")
    assert place.point.tolist() == [-7.5, -2, -2] and place.inside_mm == 3 and place.name == "Core_L"
    assert place.kind == "inner point" and place.number == 1 and str(place) == "Core_L: (-7.5, -2.0, -2.0), 3.0 mm inside"
    assert atlas.place("(1, 2, 3)").point.tolist() == [1, 2, 3]
    cap = atlas.place("1020:C3")
    assert cap.kind == "position" and np.linalg.norm(cap.outward) == pytest.approx(1, abs=2e-3)


def test_names_far_from_their_areas_are_warned_of(atlas, tmp_path, recwarn):
    rows = [("Core_L", -7.5, -2, -2), ("Core_R", 7.5, -2, -2), ("right core", 8, -2, -2)]
    path = tmp_path / "list.csv"
    path.write_text("name,x,y,z\n" + "".join(f"{name},{x},{y},{z}\n" for name, x, y, z in rows))
    conus.read_poses(path, atlas=atlas)
    assert not recwarn.list
    path.write_text("name,x,y,z\n" + "".join(f"{name},{x},{y + 30},{z}\n" for name, x, y, z in rows))
    with pytest.warns(conus.PoseWarning, match="3 points are called as areas of the atlas, and half of them lie 28 mm"):
        conus.read_poses(path, atlas=atlas)


def test_names_in_a_file_are_places(atlas, tmp_path):
    path = tmp_path / "areas.csv"
    path.write_text("area,radius\nleft core,5\nBoth,\nCore_R,0\n1020:C3,n/a\n")
    poses = conus.read_poses(path, atlas=atlas)
    assert poses.origins[[0, 2]].tolist() == [[-7.5, -2, -2], [7.5, -2, -2]]
    assert poses.origins[3].tolist() == atlas.place("1020:C3").point.tolist()
    assert "Both lies on both sides" in poses.errors[1] and np.isnan(poses.origins[1]).all()
    assert np.allclose(poses.radii, [5, np.nan, 0, np.nan], equal_nan=True)
    with pytest.raises(conus.DataError, match="x y z, the positions, are missing"):
        conus.read_poses(path)


def test_a_way_leads_into_the_head(atlas):
    assert atlas.inward([0, 3, 60]).tolist() == [0, 0, -1]
    assert np.allclose(atlas.inward("1020:C3"), [0.815, -0.177, -0.552], atol=1e-3)
    with pytest.raises(conus.ArgumentError, match="it lies in the hull of the atlas"):
        atlas.inward("left core")


def test_places_are_ends_and_points(atlas):
    wanted = atlas.select([-7.5, -2, 60], toward=[-7.5, -2, -2], angle=20)
    given = atlas.select("-7.5 -2 60", toward="left core", angle=20)
    assert given.to_dataframe().equals(wanted.to_dataframe())
    near = atlas.select("near:Core_L", toward=[7.5, -2, -2], angle=20)
    assert near.to_dataframe().equals(atlas.select([-4.5, -2, -2], toward=[7.5, -2, -2], angle=20).to_dataframe())
    assert atlas.near("Core_R", 2).to_dataframe().equals(atlas.near([7.5, -2, -2], 2).to_dataframe())
    lps = atlas.select("7.5 2 60", toward="left core", angle=20, space="lps")
    assert lps.to_dataframe()["share"].tolist() == wanted.to_dataframe()["share"].tolist()


@pytest.mark.parametrize("words, message", [
    ("core", "toward: .*may be any of 2"), ("Both", "toward: Both lies on both sides.*near:Both is its point"),
    ("C3", "toward: C3 is a position on the head of MNI 152"), ("1 2", "two numbers"), ("near:Both", "near: is nearest"),
])
def test_what_has_two_readings_is_refused(atlas, words, message):
    with pytest.raises(conus.ArgumentError, match=message):
        atlas.select("near:Core_L" if words.startswith("near") else [0, 0, 90], toward=words)
