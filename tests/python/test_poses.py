# SPDX-License-Identifier: BSD-3-Clause
"""Files of poses: what Python reads and answers is what the program reads and answers."""
import io
import json
import logging
import math
import pathlib
import warnings

import nibabel
import numpy as np
import pandas
import pytest

import conus
from support import AFFINE, NAMES, assert_rows_of_the_program, call_conus, plates, same

CORPUS = pathlib.Path(__file__).parents[1] / "fuzz" / "corpus" / "poses"

# A device at the origin along +x, and one that was not tracked.
BRAINSIGHT = """# Version: 12
# Coordinate system: NIfTI:Scanner
# Target Name\tLoc. X\tLoc. Y\tLoc. Z\tm0n0\tm0n1\tm0n2\tm1n0\tm1n1\tm1n2\tm2n0\tm2n1\tm2n2
right hand\t0.000\t0.000\t0.000\t0.000\t0.000\t1.000\t0.000\t1.000\t0.000\t-1.000\t0.000\t0.000
lost\t(null)\t(null)\t(null)\t(null)\t(null)\t(null)\t(null)\t(null)\t(null)\t(null)\t(null)\t(null)
"""


@pytest.fixture(name="_quiet", autouse=True)
def no_warnings():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", conus.PoseWarning)
        yield


@pytest.fixture(name="paths")
def write_files(tmp_path):
    nibabel.save(nibabel.Nifti1Image(plates(), AFFINE), tmp_path / "plates.nii")
    pandas.DataFrame({"index": NAMES.keys(), "name": NAMES.values()}).to_csv(tmp_path / "plates.tsv", sep="\t", index=False)
    return tmp_path


def batch(paths, *words):
    """The program's rows, with ids as they are."""
    out = call_conus("batch", paths / "plates.nii", "--labels", paths / "plates.tsv", "-q", *words).stdout
    return pandas.read_csv(io.BytesIO(out), sep="\t", na_values="n/a", keep_default_na=False, dtype={"query": str})


def load(paths):
    return conus.load(paths / "plates.nii", labels=paths / "plates.tsv")


# Every file


@pytest.mark.parametrize("name", sorted(path.name for path in CORPUS.iterdir()))
def test_every_file_has_the_rows_of_the_program(paths, name):
    """The corpus has files of every format, good and bad ones: both refuse, or both give the same rows."""
    words = ["--poses", CORPUS / name, "--any-space"]
    try:
        poses = conus.read_poses(CORPUS / name, any_space=True)
    except conus.Error as error:
        with pytest.raises(AssertionError) as refused:
            batch(paths, *words)
        assert str(error).split(": ")[-1][:40] in str(refused.value)
        return
    if len(poses) and all("a point, " in why or "number" in why for why in poses.errors.values()) and np.isnan(
            poses.matrices).all():  # asked as points, without an option of an axis
        rows = batch(paths, *words)
        assert rows["name"][rows["kind"] == "error"].size == sum("a point, " not in why for why in poses.errors.values())
        return
    rows = batch(paths, *words, "--angle=12")
    of_points = "the direction that --angle needs: "
    rows["name"] = [name.replace("--axis", "axis=").partition(of_points)[0] + "the direction that a cone needs" * (
        of_points in name) for name in rows["name"]]
    if len(poses):
        assert_rows_of_the_program(load(paths).select_many(poses=poses, angle=12).to_dataframe(), rows)


def test_a_table_has_all_that_its_columns_say(tmp_path):
    """Row 2 has no direction, row 3 no position: they keep their places, and what else they say."""
    (tmp_path / "p.tsv").write_text(
        "query_id\tx\ty\tz\tdx\tdy\tdz\tangle\ttime_s\ttrigger\terror_deg\terror_mm\n"
        "A\t1\t2\t3\t0\t0\t2\t20\t0.5\t1\t2\t1.5\n"
        "B\t1\t2\t3\t0\t0\t0\tn/a\t0.6\t0\tn/a\tn/a\n"
        "A\tnan\t2\t3\t0\t0\t1\t30\t0.7\t1\t2\t2\n")
    poses = conus.read_poses(tmp_path / "p.tsv")
    assert len(poses) == 3 and list(poses.ids) == ["A", "B", "A"] and list(poses.lines) == [2, 3, 4]
    assert list(poses.errors) == [1, 2]
    assert poses.errors[1].startswith("line 3: direction: 0,0,0") and poses.errors[2].startswith("line 4: ")
    np.testing.assert_array_equal(poses.origins[0], (1, 2, 3))
    np.testing.assert_allclose(poses.directions[0], (0, 0, 1), atol=1e-15)
    np.testing.assert_allclose(poses.matrices[0] @ (0, 0, -2, 1), (1, 2, 5, 1), atol=1e-15)
    assert np.isnan(poses.matrices[1:]).all() and np.isnan(poses.directions[1:]).all()
    assert poses.angles[0] == pytest.approx(20) and poses.times_s[0] == 0.5 and poses.triggers.tolist() == [True, False, False]
    assert (poses.errors_deg[0], poses.errors_mm[0]) == (2, 1.5)
    np.testing.assert_array_equal(poses[0], poses.matrices[0])
    for which, why in (("C", "0 have the id 'C'"), ("A", "2 have the id 'A'"), ("B", "B: line 3: direction"), (1, "line 3")):
        with pytest.raises(conus.ArgumentError, match=why):
            poses[which]  # pylint: disable=pointless-statement
    with pytest.raises(IndexError):
        poses[3]  # pylint: disable=pointless-statement
    frame = poses.to_dataframe()
    assert list(frame.columns) == ["query", "x", "y", "z", "dx", "dy", "dz", "angle", "time_s", "error_deg", "error_mm", "error"]
    assert frame["error"][0] is None and frame["error"][1] == poses.errors[1]
    assert repr(poses) == f"<conus.Poses: 3 of {tmp_path / 'p.tsv'}, 2 errors>"


def test_each_pose_may_have_its_range(tmp_path):
    """Arrays and the columns of a file are the range of a selector, asked for one pose."""
    (tmp_path / "p.tsv").write_text(
        "x\ty\tz\tdx\tdy\tdz\tnear\tfar\n"
        "9\t0\t0\t1\t0\t0\t1\t12\n9\t0\t0\t1\t0\t0\tn/a\t10\n9\t0\t0\t1\t0\t0\tn/a\tn/a\n"
        "9\t0\t0\t1\t0\t0\t13\tn/a\n9\t0\t0\t1\t0\t0\t30\t20\n")
    poses = conus.read_poses(tmp_path / "p.tsv")
    assert list(poses.errors) == [4] and "range: 30 to 20 mm" in poses.errors[4]
    np.testing.assert_array_equal(poses.ranges, [(1, 12), (np.nan, 10), (np.nan, np.nan), (13, np.nan), (np.nan, np.nan)])
    wanted = [(1, 12), (2, 10), (2, 14), (13, 14)]
    atlas = conus.load(plates(), AFFINE)
    near, far = [1, np.nan, np.nan, 13, 5], [12, 10, np.nan, np.nan, 3]
    given = {"origins": np.tile((9.0, 0, 0), (5, 1)), "directions": np.tile((1.0, 0, 0), (5, 1)), "near": near, "far": far}
    for ways in ({"poses": poses}, given):
        many = atlas.select_many(**ways, range=(2, 14))
        segments = atlas.segments_many(**ways, range=(2, 14))
        clearances = atlas.clearance_many(**ways, range=(2, 14), within=50)
        for i, own in enumerate(wanted):
            alone = {"origin": (9, 0, 0), "direction": (1, 0, 0), "range": own}
            assert same(many[i], atlas.select(**alone).results)
            for rows, one in ((segments, atlas.segments(**alone)), (clearances, atlas.clearance(**alone, within=50))):
                for name in one.columns:
                    np.testing.assert_array_equal(rows[name][rows.starts[i]:rows.starts[i + 1]], one[name])
        for rows in (many, segments, clearances):
            assert list(rows.errors) == [4] and "range: " in rows.errors[4]
    assert [len(many[i]) for i in range(4)] == [2, 1, 2, 2]  # the plate begins at 11 mm
    track = atlas.track(range(5), poses=poses, range=(2, 14))
    assert list(track.errors) == [4]
    with pytest.raises(conus.ArgumentError, match="rows"):
        atlas.select_many(**{**given, "far": far[1:]})


def test_a_file_without_poses_has_none(tmp_path):
    (tmp_path / "p.tsv").write_text("x\ty\tz\tdx\tdy\tdz\n")
    poses = conus.read_poses(tmp_path / "p.tsv")
    assert len(poses) == 0 and poses.matrices.shape == (0, 4, 4) and poses.directions.shape == (0, 3)
    atlas = conus.load(plates(), AFFINE)
    assert len(atlas.select_many(poses=poses)) == 0 and len(poses.to_dataframe()) == 0


# Options

TABLE = "query_id\tx\ty\tz\tdx\tdy\tdz\n" "M1\t1\t2\t3\t1\t0\t0\n"
MATRIX = "0 0 -1 1\n0 1 0 2\n1 0 0 3\n0 0 0 1\n"


@pytest.mark.parametrize(
    "text, options, words",
    [
        (TABLE, {"space": "lps"}, ["--space=lps"]),
        (TABLE, {"format": "table"}, ["--poses-format=table"]),
        (MATRIX, {"axis": "+z"}, ["--axis=+z"]),
        (MATRIX, {"axis": "-y", "format": "matrix"}, ["--axis=-y", "--poses-format=matrix"]),
        (TABLE, {"angle": 40}, ["--angle=40"]),
        (TABLE.replace("dz", "dz\tangle").replace("\t0\t0\n", "\t0\t0\t35\n"), {"angle": 40}, ["--angle=40"]),
    ],
)  # fmt: skip
def test_options_are_those_of_the_program(paths, text, options, words):
    path = paths / "poses.txt"
    path.write_text(text)
    asked = {"angle": options.pop("angle")} if "angle" in options else {}
    frame = load(paths).select_many(poses=conus.read_poses(path, **options), **asked).to_dataframe()
    rows = batch(paths, "--poses", path, *words)
    positions = [c for c in rows.columns if c.startswith("contact_") and c != "contact_value"]
    if "space" in options:  # which is also the space of what is reported; in Python that is the selector's
        rows[positions[:2]] *= -1
    assert_rows_of_the_program(frame, rows)


def test_positions_of_the_ccf_are_read_with_the_atlas(tmp_path):
    """A grid of the CCF's size, 13.2 x 8 x 11.4 mm, in voxels of 0.2 mm: AP 6600, DV 4000, ML 5700 um is its middle."""
    values = np.zeros((66, 40, 57), "u2")
    values[30:36, 17:23, 26:31] = 9
    matrix = np.array([[0, 0, 0.2, 0.1], [-0.2, 0, 0, -0.1], [0, -0.2, 0, -0.1], [0, 0, 0, 1]])
    atlas = conus.load(values, matrix)
    path = tmp_path / "poses.tsv"
    path.write_text("x\ty\tz\tdx\tdy\tdz\n6600\t0\t5700\t0\t1\t0\n")
    with pytest.raises(conus.ArgumentError, match="atlas="):
        conus.read_poses(path, space="ccf")
    poses = conus.read_poses(path, space="ccf", atlas=atlas)
    straight = atlas.select((6600, 0, 5700), direction=(0, 1, 0), space="ccf")
    assert straight[0].index == 9
    assert atlas.select_many(poses=poses)[0]["object"][0] == straight.results["object"][0]
    np.testing.assert_allclose(atlas.select_many(poses=poses)[0]["contact"], straight.results["contact"])


def test_contacts_point_along_their_shafts(tmp_path):
    """A1 at 0, A2 at x = 5 mm: A1 points along +x."""
    (tmp_path / "sub-1_space-MNI_electrodes.tsv").write_text("name\tx\ty\tz\nA1\t0\t0\t0\nA2\t5\t0\t0\n")
    (tmp_path / "sub-1_space-MNI_coordsystem.json").write_text(
        json.dumps({"iEEGCoordinateSystem": "MNI152NLin6Asym", "iEEGCoordinateUnits": "mm"}))
    path, atlas = tmp_path / "sub-1_space-MNI_electrodes.tsv", conus.load(plates(), AFFINE, labels=NAMES)
    points = conus.read_poses(path)
    assert list(points.ids) == ["A1", "A2"] and points.origins.tolist() == [[0, 0, 0], [5, 0, 0]]
    assert points.errors == {i: f"line {i + 2}: a point, without the direction that a cone needs" for i in (0, 1)}
    assert list(atlas.select_many(poses=points).errors) == [0, 1]
    along = conus.read_poses(path, along_shafts=True)
    np.testing.assert_allclose(along.directions[0], (1, 0, 0), atol=1e-12)
    assert atlas.select(pose=along["A1"])[0].name == "right"


# One brain


def test_a_scan_does_not_fit_a_template(tmp_path, caplog):
    caplog.set_level(logging.INFO, "conus")
    image = nibabel.Nifti1Image(plates(), AFFINE)
    image.set_sform(AFFINE, 4)  # MNI 152
    template, path = conus.load(image, labels=NAMES), tmp_path / "b.txt"
    path.write_text(BRAINSIGHT)
    poses = conus.read_poses(path)
    for ask in (
        lambda: template.select_many(poses=poses),
        lambda: template.segments_many(poses=poses),
        lambda: template.track(np.arange(len(poses)), poses=poses),
        lambda: poses.match(template),
        lambda: conus.read_poses(path, atlas=template),
        lambda: template.plan(["left"], entries=poses, targets="voxels", depth=9),
        lambda: template.plan(["left"], entries=np.ones((1, 3)), targets=poses, depth=9),
    ):
        with pytest.raises(conus.DataError) as caught:
            ask()
        for words in (str(path), "another space", "transforms=", "any_space=True"):
            assert words in str(caught.value)
    answers = template.select_many(poses=conus.read_poses(path, any_space=True))
    assert list(answers.to_dataframe()["query"]) == ["right hand"] * 2 + ["lost"]
    plain = conus.load(plates(), AFFINE, labels=NAMES)
    assert plain.select_many(poses=poses).errors == {1: poses.errors[1]}
    assert plain.select(pose=poses["right hand"])[0].name == "right"
    assert any("space" in note for note in poses.notes) and any("space" in r.getMessage() for r in caplog.records)


def test_segments_and_tracks_take_files(tmp_path):
    (tmp_path / "p.tsv").write_text(
        "query_id\tx\ty\tz\tdx\tdy\tdz\ttime_s\ttrigger\nL\t0\t0\t0\t-1\t0\t0\t0\t0\nX\t0\t0\t0\t0\t0\t0\t0.1\t0\nR\t0\t0\t0\t1\t0\t0\t0.5\t1\n")
    atlas, poses = conus.load(plates(), AFFINE, labels=NAMES), conus.read_poses(tmp_path / "p.tsv")
    segments = atlas.segments_many(poses=poses)
    assert list(segments.errors.values()) == list(poses.errors.values())
    frame = segments.to_dataframe()
    assert list(frame["query"]) == ["L", "L", "X", "R", "R"] and frame["name"][2] == poses.errors[1]
    track = atlas.track(poses.times_s, poses=poses, trigger=poses.triggers)
    assert track.errors == poses.errors and list(track.selected) == ["left", None, "right"]
    rows = track.to_dataframe(selected=True)  # 0.15 s before the press the left one was selected
    assert list(zip(rows["query"], rows["name"], rows["confirmed"])) == [
        ("L", "left", False), ("R", "right", False), ("R", "left", True)]


# Bad input


@pytest.mark.parametrize(
    "options",
    [
        {"format": "tsv"},
        {"axis": "z"},
        {"along_shafts": "no"},
        {"any_space": None},
        {"max_memory": -1},
        {"space": "mni"},
        {"space": "ccf"},
        {"bregma": (1, 2, 3)},
        {"path": "no such file"},
        {"path": "a\0b"},
        {"path": None},
    ],
)
def test_bad_arguments_are_errors(tmp_path, options):
    (tmp_path / "p.tsv").write_text(TABLE)
    with pytest.raises(conus.Error) as caught:
        conus.read_poses(**{"path": tmp_path / "p.tsv", **options})
    assert str(caught.value) and "\n" not in str(caught.value)


def test_a_path_is_no_array(tmp_path):
    with pytest.raises(conus.ArgumentError, match=r"poses: a path.*conus\.read_poses\("):
        conus.load(plates(), AFFINE).select_many(poses=str(tmp_path / "p.tsv"))


def test_formats_have_names():
    assert {"auto", "table", "brainsight", "localite", "simnibs"} <= {*conus.pose_formats()}


def test_matrices_with_three_decimals_are_poses_for_both(paths):
    """Each entry is off by up to 0.0005, so that products of columns are off by up to 0.0005 * 2 * sqrt(3) = 0.0017."""
    random = np.random.default_rng(5)
    rotations = np.linalg.qr(random.normal(size=(300, 3, 3)))[0]
    rotations *= np.sign(np.linalg.det(rotations))[:, None, None]
    poses = np.tile(np.eye(4), (300, 1, 1))
    poses[:, :3, :3] = rotations.round(3)
    off = np.abs(np.swapaxes(poses[:, :3, :3], 1, 2) @ poses[:, :3, :3] - np.eye(3)).max()
    assert 0.001 < off < 0.0005 * 2 * math.sqrt(3)
    columns = [f"m{row}{column}" for row in range(4) for column in range(4)]
    pandas.DataFrame(poses.reshape(300, 16), columns=columns).to_csv(paths / "m.tsv", sep="\t", index=False)
    atlas = load(paths)
    answers = atlas.select_many(poses=poses)
    assert not answers.errors and not conus.read_poses(paths / "m.tsv").errors
    frame = answers.to_dataframe()
    frame["query"] = frame["query"].astype(str)
    assert_rows_of_the_program(frame, batch(paths, "--poses", paths / "m.tsv"))


def test_columns_are_kept_as_they_are(tmp_path):
    (tmp_path / "kept.csv").write_text('name,Group,x,y,z,tx,ty,tz\nM1,"a ""b"", c",0,0,9,0,0,0\nM2,,1,0,9,1,0,0\nM3,d,q,0,9,1,0,0\n')
    poses = conus.read_poses(tmp_path / "kept.csv", keep=["group", "tx"])
    assert list(poses.kept["group"]) == ['a "b", c', "", "d"] and list(poses.kept["tx"]) == ["0", "1", "1"]
    assert list(poses.to_dataframe()["group"]) == ['a "b", c', "", "d"]
    assert conus.read_poses(tmp_path / "kept.csv").kept == {}
    with pytest.raises(conus.DataError, match='no column is called "grup"'):
        conus.read_poses(tmp_path / "kept.csv", keep=["grup"])
    with pytest.raises(conus.ArgumentError, match="a list of names"):
        conus.read_poses(tmp_path / "kept.csv", keep="group")
