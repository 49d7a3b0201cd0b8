# SPDX-License-Identifier: BSD-3-Clause
"""The Python package. $PYTHONPATH has it, $CONUS is the program conus."""
import copy
import faulthandler
import logging
import math
import multiprocessing
import os
import pathlib
import pickle
import shutil
import signal
import subprocess
import sys
import threading
import warnings

import nibabel
import numpy as np
import pandas
import pytest

import conus
from support import AAL, AFFINE, NAMES, assert_rows_of_the_program, call_conus, needs_aal, page_blocks, plates, run_conus, same


def test_a_library_of_another_version_is_refused(tmp_path):
    """The declarations are those of one version: members of structs may lie elsewhere in another."""
    package, other = pathlib.Path(conus.__file__).parent, tmp_path / "conus"
    shutil.copytree(package, other)
    name = {"nt": "conus.dll"}.get(os.name, "libconus.so.0")
    if not (other / name).exists():  # in a wheel it is there
        (other / name).symlink_to((package / "../.." / name).resolve(strict=True))
    with open(other / "_declarations.py", "a", encoding="utf-8") as file:
        file.write("VERSION = '9.8.7'\n")
    path = os.pathsep.join([str(tmp_path), *sys.path])
    done = subprocess.run([sys.executable, "-c", "import conus"], env={**os.environ, "PYTHONPATH": path},
                          capture_output=True, text=True, check=False)
    assert done.returncode == 1 and done.stderr.splitlines()[-1] == (
        f"ImportError: conus: {other / name} is of version {conus.__version__}, wanted is 9.8.7, the package's own")


# One cone


def heard(caplog):
    return [(r.name, r.levelno, r.getMessage()) for r in caplog.records]


def test_notes_go_to_the_logger(caplog, tmp_path):
    caplog.set_level(logging.INFO, "conus")
    twice = pandas.DataFrame({"index": [1, 1, 2], "name": ["left", "other", "right"]})
    atlas = conus.load(plates(), AFFINE, labels=twice)
    said = 'label 1 is named twice in the label table: "left" is used, "other" is not'
    assert heard(caplog) == [("conus", logging.WARNING, "array: " + said)]
    assert atlas.notes == [said]
    caplog.clear()
    image = nibabel.Nifti1Image(np.linspace(0, 1, 8, dtype="f4").reshape(2, 2, 2), AFFINE)
    nibabel.save(image, tmp_path / "p.nii")
    conus.load(plates(), AFFINE, labels=NAMES, pathways=[tmp_path / "p.nii"], context=tmp_path / "p.nii")
    words = "pathway p: values up to 1, taken as probabilities; threshold 0.25"
    assert heard(caplog) == [("conus", logging.INFO, f"{tmp_path / 'p.nii'}: {words}")]


def test_the_brain_may_be_stated(tmp_path):
    path = tmp_path / "v.nii"
    nibabel.save(nibabel.Nifti1Image(plates(), AFFINE), path)
    assert conus.load(path).brain == "unknown"
    assert conus.load(path, template="none").brain == "one person's own"
    assert conus.load(f"{path},template=colin27").brain == "Colin 27"
    with pytest.raises(conus.ArgumentError, match="template"):
        conus.load(path, template="mni")
    with pytest.raises(conus.ArgumentError, match="template: of a path only"):
        conus.load(plates(), AFFINE, template="none")


def test_exchanged_sides_have_a_note():
    labels = np.arange(1, 7, dtype=np.uint8).reshape(6, 1, 1)  # x grows to the right
    for sides, said in (("LLLRRR", None), ("RRRLLL", "3 of 3 pairs of a left and a right area lie the other way round")):
        names = {i + 1: f"{'ABCABC'[i]}_{side}" for i, side in enumerate(sides)}
        note = conus.load(labels, AFFINE, labels=names).exchanged
        assert note is None if said is None else note.startswith(said)
        assert conus.load(labels, AFFINE, labels=names).warnings == ([] if said is None else [note])
        assert (conus.load(labels, AFFINE, labels=names, sides="exchanged").exchanged is None) == (said is not None)


def test_notes_of_a_load_that_fails_go_to_the_logger(caplog, tmp_path):
    image = nibabel.Nifti1Image(plates(), None)
    image.header["sform_code"] = image.header["qform_code"] = 0
    path = tmp_path / "v.nii"
    nibabel.save(image, path)
    with pytest.raises(conus.FileError, match="none.txt"):
        conus.load(path, labels=tmp_path / "none.txt")
    (note,) = heard(caplog)
    assert note[1] == logging.WARNING and note[2].startswith(f"{path}: neither sform nor qform is set")


def test_what_a_handler_raises_is_raised(monkeypatch):
    def interrupt(*_unused):
        raise KeyboardInterrupt

    monkeypatch.setattr(logging.getLogger("conus"), "handle", interrupt)
    with pytest.raises(KeyboardInterrupt):
        conus.load(plates(), AFFINE, labels=pandas.DataFrame({"index": [1, 1], "name": ["a", "b"]}))


def test_plate_is_hit_where_it_begins(atlas):
    """From the middle along -x the plate's face is at voxel edge x = -39 + 2 * 9.5 = -20."""
    hits = atlas.select(origin=(0, 0, 0), direction=(-5, 0, 0), angle=10)
    assert [hit.name for hit in hits] == ["left", "unassigned"]
    assert hits[0].index == 1 and hits[0].rank == 1 and hits[0].kind == "area"
    assert hits[0].share == pytest.approx(1)
    assert hits[0].contact[0] == pytest.approx(-20)
    assert 20 <= hits[0].distance_mm < 20.1
    assert hits[1].rank == 0 and hits[1].pixels == 0


def test_pose_is_a_matrix_that_points_along_minus_z(atlas):
    pose = np.eye(4)
    pose[:3, :3] = [[0, 0, -1], [0, 1, 0], [1, 0, 0]]  # its z is world -x, so that it points along +x
    assert atlas.select(pose=pose)[0].name == "right"


def test_angle_is_ten_degrees_if_not_given(atlas):
    default, ten = (atlas.select((0, 0, 0), direction=(1, 0, 0), **o).results for o in ({}, {"angle": 10}))
    assert same(default, ten)


def test_cylinder_has_no_angle(atlas):
    hits = atlas.select((0, 0, 0), direction=(1, 0, 0), radius=3)
    assert hits[0].contact[0] == pytest.approx(20)


def test_ball_has_the_voxels_around_a_point(atlas):
    """The ball's 5 mm about (21, 1, 1), a voxel's centre, in steps of 2 mm: counted here."""
    steps = np.stack(np.meshgrid(*[np.arange(-4, 5, 2)] * 3), -1).reshape(-1, 3)
    steps = steps[(steps**2).sum(1) <= 25]
    wanted = (21 + steps[:, 0] > 20).sum()
    near = atlas.near((21, 1, 1), 5, layers="all")
    assert near.to_dataframe().set_index("name").voxels["right"] == wanted


def test_value_at_the_contact(tmp_path):
    """Along x: the first voxel of the row in an area of 25 % and more, and in the pathway from 300 on."""
    percent = np.zeros((6, 1, 1, 1), "u1")
    percent[:, 0, 0, 0] = 0, 10, 24, 42, 80, 0
    nibabel.save(nibabel.Nifti1Image(percent, np.eye(4)), tmp_path / "maps.nii")
    header = "<header><type>Probabilistic</type><images><imagefile>/maps</imagefile></images></header>"
    (tmp_path / "a.xml").write_text(f"<atlas>{header}<data><label index='0'>A</label></data></atlas>")
    grey = nibabel.Nifti1Image(np.arange(0, 600, 100, dtype="i2").reshape(6, 1, 1), np.eye(4))
    atlas = conus.load(tmp_path / "a.xml", pathways=[(grey, 300)])
    hits = atlas.select((-9, 0, 0), direction=(1, 0, 0), radius=0.1)
    assert hits[0].name == "A" and hits[0].contact[0] == pytest.approx(2.5)
    assert hits[0].contact_value == pytest.approx(percent[3, 0, 0, 0] / 100)
    assert math.isnan(hits[-1].contact_value)
    assert list(hits.to_dataframe()["contact_value"][:1]) == [hits[0].contact_value]
    near = {hit.name: hit.contact_value for hit in atlas.near((4.2, 0, 0), 0.1)}
    half = conus.load(tmp_path / "a.xml", probability=0.5).select((-9, 0, 0), direction=(1, 0, 0), radius=0.1)
    assert half[0].contact_value == pytest.approx(percent[4, 0, 0, 0] / 100)
    assert near["A"] == pytest.approx(percent[4, 0, 0, 0] / 100) and near[atlas.objects.names[2]] == 400


def test_mask_has_the_voxels_of_the_cone(atlas):
    hits = atlas.select((0, 0, 0), direction=(1, 0, 0), angle=30, layers="all")
    mask = hits.mask()
    assert np.array_equal(mask.affine, AFFINE)
    inside = mask.get_fdata() == 1
    assert inside.sum() == hits.to_dataframe().set_index("name").voxels["right"]
    centres = nibabel.affines.apply_affine(AFFINE, np.argwhere(inside))
    angles = np.degrees(np.arctan2(np.hypot(centres[:, 1], centres[:, 2]), centres[:, 0]))
    assert angles.max() <= 15 and centres[:, 0].min() > 20
    assert np.array_equal(hits.mask(of="labels", name="right").get_fdata(), 2.0 * inside)


def test_channels_are_of_the_picture(atlas):
    hits = atlas.select((0, 0, 0), direction=(1, 0, 0), resolution=8)
    assert hits.image("id").shape == (8, 8)
    assert hits.image("id")[4, 4] == 2
    assert hits.image("X")[4, 4] == pytest.approx(20)
    with pytest.raises(KeyError):
        hits.image("nothing")


@needs_aal
def test_aal_pose_has_2921_238_69():
    """The pixels that three engines and an independent traversal agree on (docs/verification.md)."""
    hits = conus.load(AAL).select(origin=(-90, 20, 20), toward=(0, -10, 10), angle=20)
    assert [hit.pixels for hit in hits] == [2921, 238, 69, 0]


@needs_aal
@pytest.mark.parametrize("options", [{}, {"layers": "all"}, {"layers": "all", "level": None, "score": "unoccluded"}])
def test_rows_are_those_of_the_program(options):
    words = [w for name, value in options.items() if value for w in (f"--{name}", value)]
    rows = run_conus("query", AAL, "--origin=-90,20,20", "--toward=0,-10,10", "--angle=20", "--format=tsv", *words)
    frame = conus.load(AAL).select((-90, 20, 20), toward=(0, -10, 10), angle=20, **options).to_dataframe()
    assert_rows_of_the_program(frame, rows)


ASKED = {
    "cone": (lambda atlas: atlas.select((-80, 0, 0), direction=(1, 0.01, 0), angle=30),
             ["--origin=-80,0,0", "--direction=1,0.01,0", "--angle=30"]),
    "layers": (lambda atlas: atlas.select((-80, 0, 0), direction=(1, 0.01, 0), angle=30, layers="all"),
               ["--origin=-80,0,0", "--direction=1,0.01,0", "--angle=30", "--layers=all"]),
    "lps": (lambda atlas: atlas.select((80, 0, 0), direction=(-1, -0.01, 0), angle=30, space="lps"),
            ["--origin=80,0,0", "--direction=-1,-0.01,0", "--angle=30", "--space=lps"]),
    "ball": (lambda atlas: atlas.near((-30, 1, 2), 6), ["--point=-30,1,2", "--radius=6"]),
    "point": (lambda atlas: atlas.near((-30, 1, 2)), ["--point=-30,1,2"]),
    "far": (lambda atlas: atlas.near((3, 100, -2), space="lps"), ["--point=3,100,-2", "--space=lps"]),
}  # fmt: skip


@pytest.mark.parametrize("case", ASKED)
def test_rows_with_streamlines_are_those_of_the_program(case, tmp_path):
    """Three streamlines in the left plate, so that some columns are n/a for areas and others for bundles."""
    ask, words = ASKED[case]
    nibabel.save(nibabel.Nifti1Image(plates(), AFFINE), tmp_path / "plates.nii")
    (tmp_path / "plates.txt").write_text("1 left\n2 right\n")
    lines = [np.array([[-30, y, -20], [-30, y, 20]], "f4") for y in (-4, 0, 3)]
    nibabel.streamlines.save(nibabel.streamlines.Tractogram(lines, affine_to_rasmm=np.eye(4)), str(tmp_path / "up.tck"))
    frame = ask(conus.load(tmp_path / "plates.nii", streamlines=[tmp_path / "up.tck"])).to_dataframe()
    rows = run_conus("query", tmp_path / "plates.nii", "--streamlines", tmp_path / "up.tck", "--format=tsv", "-q", *words)
    assert_rows_of_the_program(frame, rows)
    others = {"layers": {"unassigned", "bundle"}, "ball": {"unassigned", "bundle"}, "point": set(), "far": set()}
    assert set(frame["kind"]) == {"area"} | others.get(case, {"unassigned"})


@pytest.mark.parametrize("radius", [0, 6])
def test_many_points_are_those_of_the_program(radius, tmp_path):
    """In a plate, between both, far off, no point, and one equally far from both."""
    points = [(-30, 1, 2), (5, 0, 0), (3, -200, 0), (np.nan, 0, 0), (0, 0, 0)]
    nibabel.save(nibabel.Nifti1Image(plates(), AFFINE), tmp_path / "plates.nii")
    (tmp_path / "plates.txt").write_text("1 left\n2 right\n")
    (tmp_path / "points.txt").write_text("".join(f"{x} {y} {z}\n" for x, y, z in points if np.isfinite(x)))
    words = ["--radius=6"] if radius else []
    rows = run_conus("batch", tmp_path / "plates.nii", "--poses", tmp_path / "points.txt", "-q", *words)
    atlas = conus.load(tmp_path / "plates.nii")
    many = atlas.near_many(points, radius)
    assert list(many.errors) == [3]
    assert_rows_of_the_program(atlas.near_many([p for p in points if np.isfinite(p[0])], radius).to_dataframe(), rows)
    of_file = atlas.near_many(conus.read_poses(tmp_path / "points.txt"), radius)
    assert np.array_equal(of_file.results["object"], many.results["object"])
    assert_rows_of_the_program(of_file.to_dataframe(), rows)
    for i in (0, 1, 2, 4):
        one = atlas.near(points[i], radius)
        for member in ("object", "distance", "volume"):
            np.testing.assert_array_equal(one.results[member], many[i][member])
    if not radius:
        assert [[hit.name for hit in atlas.near(p)] for p in (points[1], points[4])] == [["right"], ["left", "right"]]
    with pytest.raises(conus.ArgumentError, match="radius"):
        atlas.near_many(points, -1)
    with pytest.raises(conus.ArgumentError, match="range"):
        atlas.selector(range=(0, 20)).near_many(points)


@needs_aal
def test_sweep_and_jitter_are_those_of_the_program():
    atlas, aim = conus.load(AAL), ("--origin=-90,20,20", "--toward=0,-10,10", "--angle=20", "--format=tsv")
    sweep = atlas.sweep((-90, 20, 20), toward=(0, -10, 10), angle=20).to_dataframe()
    assert_rows_of_the_program(sweep, run_conus("sweep", AAL, *aim))
    jitter = atlas.jitter((-90, 20, 20), toward=(0, -10, 10), angle=20, degrees=2, mm=1).to_dataframe()
    assert_rows_of_the_program(jitter, run_conus("sweep", AAL, *aim, "--jitter=2,1"))


@needs_aal
@pytest.mark.parametrize("options", [{}, {"range": "10,60"}, {"range": "10,60", "only": "Insula_L"}])
def test_segments_are_those_of_the_program(options, tmp_path):
    table, words = tmp_path / "rows.tsv", [w for name, value in options.items() for w in (f"--{name}", value)]
    run_conus("query", AAL, "--origin=-90,20,20", "--toward=0,-10,10", "--format=tsv", "-q", *words, "--segments", table)
    rows = pandas.read_csv(table, sep="\t", na_values="n/a", keep_default_na=False)
    atlas, depths = conus.load(AAL, only=options.get("only")), {"range": (10, 60)} if "range" in options else {}
    frame = atlas.segments((-90, 20, 20), toward=(0, -10, 10), **depths).to_dataframe()
    assert_rows_of_the_program(frame, rows)
    assert list(rows.columns) == ["query", *frame.columns]
    many = atlas.segments_many([(-90, 20, 20)] * 2, [(90, -30, -10)] * 2, **depths)
    assert many.starts.tolist() == [0, len(frame), 2 * len(frame)]
    for query, part in many.to_dataframe().groupby("query"):
        pandas.testing.assert_frame_equal(part.drop(columns="query").reset_index(drop=True), frame)


def test_segments_of_plates(atlas):
    """Plates from x = -40 to -20 and 20 to 40; a pose that is none keeps its place; an axis may meet nothing."""
    segments = atlas.segments((-50, 0, 0), direction=(1, 0, 0))
    assert list(zip(segments.objects, segments["entry_mm"], segments["exit_mm"])) == [
        (0, 0, 10), (1, 10, 30), (0, 30, 70), (2, 70, 90)]
    many = atlas.segments_many([(-50, 0, 0), (np.nan, 0, 0), (0, 0, 0)], [(1, 0, 0), (1, 0, 0), (0, 0, 1)])
    assert many.starts.tolist() == [0, 4, 4, 5] and list(many.errors) == [1] and "nan" in many.errors[1]
    frame = many.to_dataframe()
    assert list(frame["kind"]) == ["unassigned", "area", "unassigned", "area", "error", "unassigned"]
    assert math.isnan(frame["exit_mm"].iloc[-1]) and many["exit_mm"][-1] == math.inf
    assert many.objects.tolist() == [0, 1, 0, 2, 0] and repr(many).startswith("<conus.Table: 5 rows about 3 poses of order, ")
    none = atlas.segments_many(np.empty((0, 3)), np.empty((0, 3)))
    assert len(none) == 0 and list(none.to_dataframe().columns) == list(frame.columns)
    lost = atlas.segments_many([(np.nan, 0, 0)], [(1, 0, 0)]).to_dataframe()
    assert list(lost.columns) == list(frame.columns) and list(lost["kind"]) == ["error"]
    with pytest.raises(KeyError):
        many["objects"]
    with pytest.raises(conus.ArgumentError, match="pose"):
        atlas.segments((0, 0, 0))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        atlas.segments((-30, 0, 0), direction=(1, 0, 0))  # a shank may begin inside
    with pytest.warns(conus.PoseWarning, match="away"):
        atlas.segments((-50, 0, 0), direction=(-1, 0, 0))


@needs_aal
def test_clearances_are_those_of_the_program(tmp_path):
    table, needle = tmp_path / "rows.tsv", {"range": (0, 50), "radius": 0.65}
    words = ("--origin=-70,-20,-10", "--toward=-25,-22,-12", "--range=0,50", "--radius=0.65", "--format=tsv", "-q")
    run_conus("query", AAL, *words, "--clearance", f"{table},within=5")
    rows = pandas.read_csv(table, sep="\t", na_values="n/a", keep_default_na=False)
    frame = conus.load(AAL).clearance((-70, -20, -10), toward=(-25, -22, -12), within=5, **needle).to_dataframe()
    assert_rows_of_the_program(frame, rows)
    assert list(rows.columns) == ["query", *frame.columns] and len(frame) > 4


def test_clearances_of_plates(atlas):
    """Plates from x = -40 to -20 and 20 to 40: a needle at x = 5 and 35 lies 15 mm beside the second, and in it."""
    needle = {"range": (0, 10), "radius": 2}
    beside = atlas.clearance((5, 0, 0), direction=(0, 0, 1), within=13, **needle)
    wanted = {"distance_mm": 15, "clearance_mm": 13, "depth_mm": 0, "x": 5, "y": 0, "z": 0, "near_x": 20, "near_y": 0, "near_z": 0}
    assert {name: beside[name].tolist() for name in wanted} == {name: [value] for name, value in wanted.items()}
    assert beside.objects.tolist() == [2] and beside["kind"].tolist() == ["area"]
    assert len(atlas.clearance((5, 0, 0), direction=(0, 0, 1), within=12.9, **needle)) == 0
    all_of_them = atlas.clearance((5, 0, 0), direction=(0, 0, 1), within=math.inf)
    assert all_of_them["clearance_mm"].tolist() == [15, 25]
    many = atlas.clearance_many([(5, 0, 0), (np.nan, 0, 0), (35, 0, 0)], [(0, 0, 1)] * 3, **needle, within=20)
    assert many.starts.tolist() == [0, 1, 1, 2] and list(many.errors) == [1] and "nan" in many.errors[1]
    assert len(many) == 2 and many["clearance_mm"].tolist() == [13, -2]
    frame = many.to_dataframe()
    assert list(frame["kind"]) == ["area", "error", "area"]
    assert frame["clearance_mm"].tolist()[::2] == [13, -2]
    for wrong in (-1, math.nan, "x"):
        with pytest.raises(conus.ArgumentError, match="within"):
            atlas.clearance_many([(5, 0, 0)], [(0, 0, 1)], within=wrong)
        with pytest.raises(conus.ArgumentError, match="within"):
            atlas.clearance((5, 0, 0), direction=(0, 0, 1), within=wrong)


@needs_aal
@pytest.mark.parametrize("layers", ["visible", "all"])
def test_the_nearest_come_first(layers):
    words = ("--origin=-90,20,20", "--toward=0,-10,10", "--angle=40", f"--layers={layers}", "--order=depth", "--format=tsv")
    selection = conus.load(AAL).select((-90, 20, 20), toward=(0, -10, 10), angle=40, layers=layers)
    frame = selection.to_dataframe(order="depth")
    assert_rows_of_the_program(frame, run_conus("query", AAL, *words))
    assert list(frame["rank"]) != list(selection.to_dataframe()["rank"])
    many = selection.atlas.select_many([(-90, 20, 20)] * 2, [(90, -30, -10)] * 2, angle=40, layers=layers)
    for _, part in many.to_dataframe(order="depth").groupby("query"):
        assert list(part["rank"]) == list(frame["rank"])
    with pytest.raises(conus.ArgumentError, match="order"):
        selection.to_dataframe(order="near")


@needs_aal
def test_overlap_is_that_of_the_program(tmp_path):
    random = np.random.default_rng(2)
    path = tmp_path / "map.nii"
    image = nibabel.Nifti1Image(random.normal(size=(30, 40, 30)).astype("f4"), np.diag([3.0, 3, 3, 1]))
    image.to_filename(path)
    atlas = conus.load(AAL)
    frame = atlas.overlap(path, 1.5).to_dataframe()
    assert not frame.pop("volume_error_mm3").any()
    for space in ("ras", "lps"):
        rows = run_conus("overlap", AAL, str(path), "--threshold=1.5", f"--space={space}", "--format=tsv", "--quiet")
        other = atlas.overlap(path, 1.5, space=space).to_dataframe()
        assert_rows_of_the_program(other.drop(columns="volume_error_mm3"), rows)
    for roi in (image, (image.get_fdata(dtype="f4"), image.affine)):
        pandas.testing.assert_frame_equal(
            atlas.overlap(roi, threshold=1.5).to_dataframe().drop(columns="volume_error_mm3"), frame
        )


@needs_aal
def test_clusters_are_those_of_the_program(tmp_path):
    random = np.random.default_rng(2)
    image = nibabel.Nifti1Image(random.normal(size=(30, 40, 30)).astype("f4"), np.diag([3.0, 3, 3, 1]))
    path, table = tmp_path / "map.nii", tmp_path / "clusters.tsv"
    image.to_filename(path)
    atlas = conus.load(AAL)
    for threshold in (2.5, -3):
        clusters = atlas.clusters(image, threshold)
        call_conus("overlap", AAL, path, f"--threshold={threshold}", "--quiet", "--force", "--clusters", table,
                   "-o", tmp_path / "areas.tsv")
        frame = clusters.to_dataframe()
        assert not frame.pop("volume_error_mm3").any()
        assert_rows_of_the_program(frame, pandas.read_csv(table, sep="\t", na_values="n/a", keep_default_na=False))
        assert set(frame["kind"]) == {"cluster", "area", "unassigned", "maximum"}
        whole = atlas.overlap(image, threshold)
        parts = frame[frame["kind"].isin(["area", "unassigned"])].groupby("name", observed=True)["volume_mm3"].sum()
        for name, volume in zip(whole["name"], whole["volume_mm3"]):
            assert parts[name] == pytest.approx(volume, rel=1e-9)


def test_overlap_of_plates(atlas):
    """Half of the left plate, 5 of its 10 layers of 30 x 30 voxels of 8 mm^3."""
    mask = np.zeros((40, 30, 30), "u1")
    mask[:5] = 1
    overlap = atlas.overlap((mask, AFFINE))
    assert len(overlap) == 1
    assert [overlap[name][0] for name in ("volume_mm3", "fraction", "region_fraction")] == [36000, 0.5, 1]
    for roi, threshold, error in (((mask, AFFINE, 3), 0, conus.ArgumentError), ((mask, AFFINE), 2, conus.ArgumentError),
                                  ((0 * mask, AFFINE), 0, conus.DataError), ("nothing.nii", 0, conus.FileError)):
        with pytest.raises(error):
            atlas.overlap(roi, threshold)


@needs_aal
def test_a_moved_atlas_has_the_rows_of_the_program(tmp_path):
    file = tmp_path / "turn.txt"
    np.savetxt(file, [[0.8, -0.6, 0, 3], [0.6, 0.8, 0, -2], [0, 0, 1.1, 5], [0, 0, 0, 1]])
    rows = run_conus("query", AAL, "--origin=-90,20,20", "--toward=0,-10,10", "--angle=20", "--format=tsv", "--quiet",
                     f"--atlas-transform={file}")
    frame = conus.load(AAL, transforms=[file]).select((-90, 20, 20), toward=(0, -10, 10), angle=20).to_dataframe()
    assert_rows_of_the_program(frame, rows)
    assert "atlas_x" in frame.columns
    shifts = (f"Transform: TranslationTransform_double_3_3\nParameters: 0 0 {z}\nFixedParameters:\n" for z in (1, 2, 5))
    (tmp_path / "list.tfm").write_text("#Insight Transform File V1.0\n" + "".join(shifts))
    one = conus.load(AAL, transforms=[{"file": tmp_path / "list.tfm", "transform": 2}])
    contact = one.select((-90, 20, 20), toward=(0, -10, 10), angle=20).to_dataframe().iloc[0]
    assert contact["atlas_z"] == pytest.approx(contact["contact_z"] + 5)
    for bad in (tmp_path / "list.tfm", {"file": tmp_path / "list.tfm", "transform": 3}):
        with pytest.raises(conus.Error):
            conus.load(AAL, transforms=[bad])


@needs_aal
def test_a_warped_atlas_has_the_rows_of_the_program(tmp_path):
    """Nodes of 4 mm: ITK's displacements, in a chain with an affine, and SPM's positions on another grid."""
    grid = np.diag([4.0, 4, 4, 1])
    grid[:3, 3] = -92, -128, -74
    nodes = np.stack(np.meshgrid(*map(np.arange, (46, 55, 46)), indexing="ij"), -1) * 4.0 + grid[:3, 3]
    way = 4 * np.sin(nodes[..., [1, 2, 0]] / 20)
    file = tmp_path / "turn.txt"
    np.savetxt(file, [[0.8, -0.6, 0, 3], [0.6, 0.8, 0, -2], [0, 0, 1.1, 5], [0, 0, 0, 1]])
    for name, vectors in (("itk.nii.gz", way * (-1, -1, 1)), ("y_spm.nii.gz", nodes + way)):
        image = nibabel.Nifti1Image(vectors.astype("f4")[..., None, :], grid)
        image.header["intent_code"] = 1007
        image.to_filename(tmp_path / name)
        how = "absolute" if name[0] == "y" else "relative"
        transforms, words = [{"file": tmp_path / name, "vectors": how}], [f"{tmp_path / name},{how}"]
        if how == "absolute":
            transforms[0]["grid"], words[0] = AAL, f"{words[0]},grid={AAL}"
        else:
            transforms.insert(0, file)
            words.insert(0, str(file))
        rows = run_conus("query", AAL, "--origin=-90,20,20", "--toward=0,-10,10", "--angle=20", "--format=tsv",
                         "--quiet", *[f"--atlas-transform={word}" for word in words])
        atlas = conus.load(AAL, transforms=transforms)
        frame = atlas.select((-90, 20, 20), toward=(0, -10, 10), angle=20).to_dataframe()
        assert len(frame) > 1
        assert_rows_of_the_program(frame, rows)
        assert any("warped by" in note for note in atlas.notes)
    nibabel.Nifti1Image(way.astype("f4"), grid).to_filename(tmp_path / "synth.nii.gz")
    same = [conus.load(AAL, transforms=[how]).select((-90, 20, 20), toward=(0, -10, 10), angle=20).to_dataframe()
            for how in ({"file": tmp_path / "synth.nii.gz", "space": "ras", "vectors": "relative"},
                        {"file": tmp_path / "itk.nii.gz", "space": "lps", "vectors": "relative"})]
    assert len(same[0]) > 1 and same[0].equals(same[1])
    with pytest.raises(conus.ArgumentError, match="MRtrix"):
        conus.load(AAL, transforms=[tmp_path / "synth.nii.gz"])
    with pytest.raises(conus.UnsupportedError):
        conus.load(AAL, transforms=[{"file": tmp_path / "itk.nii.gz", "inverse": True}])
    with pytest.raises(conus.ArgumentError):
        conus.load(AAL, transforms=[tmp_path / "y_spm.nii.gz"])
    with pytest.raises(conus.ArgumentError):
        conus.load(AAL, transforms=[{"file": tmp_path / "itk.nii.gz", "vectors": "both"}])
    with pytest.raises(conus.OutOfMemoryError):
        conus.load(AAL, transforms=[{"file": tmp_path / "itk.nii.gz", "grid": AAL}], max_memory=10 << 20)


def test_transforms_bring_the_atlas_to_the_poses(tmp_path):
    """The pose's x is the atlas's less 7 mm: the right plate begins at 13 and no longer at 20 mm."""
    matrix = np.eye(4)
    matrix[0, 3] = 7
    file = tmp_path / "right.txt"
    np.savetxt(file, matrix)
    (tmp_path / "left.tfm").write_text(
        "#Insight Transform File V1.0\n#Transform 0\nTransform: TranslationTransform_double_3_3\n"
        "Parameters: 7 0 0\nFixedParameters:\n")
    for transforms in ([matrix], [file], [{"file": tmp_path / "left.tfm", "inverse": True}], [matrix / 2 + np.eye(4) / 2] * 2):
        moved = conus.load(plates(), AFFINE, labels=NAMES, transforms=transforms)
        hits = moved.select((0, 0.3, 0.2), direction=(1, 0, 0), angle=1)
        assert hits[0].contact[0] == pytest.approx(13, abs=1e-3)
        row = hits.to_dataframe().iloc[0]
        assert (row.atlas_x - 7, row.atlas_y) == pytest.approx((row.contact_x, row.contact_y))
    for bad, error in (([np.zeros((4, 4))], conus.ArgumentError), (matrix, conus.ArgumentError), (["none"], conus.FileError),
                       ([{"file": file, "colour": 1}], conus.ArgumentError), ([np.eye(3)], conus.ArgumentError)):
        with pytest.raises(error):
            conus.load(plates(), AFFINE, transforms=bad)


def ccf_array():
    """The Allen CCF's grid of 200 micrometres, AP, DV, ML each from its first voxel, in blocks with labels of their own;
    and its place in a world that is RAS, whose origin is the corner."""
    i, j, k = np.indices((66, 40, 57))
    affine = np.array([[0, 0, 0.2, 0.1], [-0.2, 0, 0, -0.1], [0, -0.2, 0, -0.1], [0, 0, 0, 1]])
    return (1 + i // 6 + 11 * (j // 8) + 55 * (k // 19)).astype(np.uint16), affine


def test_positions_are_of_the_ccf_or_from_bregma(tmp_path):
    """AP 5500, DV 2100, ML 4100 um is voxel 27, 10, 20 and so label 1 + 4 + 11 + 55; 0.1, 1.639 and 1.768 mm from
    bregma backward, to the left and down."""
    atlas = conus.load(*ccf_array())
    at, from_bregma = np.array([5500, 2100, 4100.0]), np.array([-0.1, -1.639, -1.768])
    for space, point, down, above in (("ccf", at, (0, 1, 0), at - [0, 4000, 0]),
                                      ("bregma", from_bregma, (0, 0, -1), from_bregma + [0, 0, 4])):
        near = atlas.near(point, 0.001, space=space)
        assert near[0].index == 71 and near[0].contact == pytest.approx(tuple(point))
        selector = atlas.selector(space=space)
        hits = selector.select(above, direction=down, angle=1)
        assert hits[0].index == 60 and hits[0].distance_mm == pytest.approx(1.9, abs=1e-3)
        same_cone = selector.select(above, toward=point, angle=1).to_dataframe()
        many = selector.select_many([above], [down], angle=1).to_dataframe()
        for frame in (same_cone, many):
            row = frame.iloc[0]
            assert row["index"] == 60
            assert (row.contact_x, row.contact_y, row.contact_z) == pytest.approx(hits[0].contact, rel=1e-9)
        with pytest.raises(conus.ArgumentError, match="a matrix is of ras or lps"):
            selector.select(pose=np.eye(4))
        lost = np.array(above, dtype=float) * [np.nan, 1, 1]
        some = selector.select_many([lost, above], [down, down], angle=1)
        assert list(some.errors) == [0] and "finite" in some.errors[0]
        assert list(some.to_dataframe().kind)[:2] == ["error", "area"]
        assert list(selector.segments_many([lost, above], [down, down]).to_dataframe().kind)[:2] == ["error", "unassigned"]
        with pytest.raises(conus.ArgumentError, match="finite"):
            selector.select(lost, direction=down)
        grown = selector.sweep(above, direction=down, angle=5).to_dataframe()
        assert {"x", "y", "z"} <= set(grown.columns)
    with pytest.raises(conus.ArgumentError, match="not micrometres"):
        atlas.near((-3400, 2000, -2500), 1, space="bregma")
    with pytest.raises(conus.ArgumentError, match="no effect"):
        atlas.near((1, 2, 3), 1, space="ccf", bregma=(1, 2, 3))
    assert atlas.near((0, 0, 0), 0.001, space="bregma", bregma=at)[0].index == 71
    lps = atlas.near((-4.1, 5.5, -2.1), 0.001, space="lps")
    assert lps[0].index == 71 and lps[0].contact == pytest.approx((-4.1, 5.5, -2.1))
    with pytest.raises(conus.Error, match="not known to be the Allen CCF"):
        conus.load(plates(), AFFINE).near((1, 2, 300), 1, space="ccf")


@needs_aal
def test_ten_lines_of_the_documents_draw_a_figure(tmp_path, monkeypatch, capsys):
    pytest.importorskip("matplotlib.pyplot")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "agg")
    lines = page_blocks()[0]
    assert len([line for line in lines.splitlines() if line]) <= 10
    exec(lines, {})
    assert capsys.readouterr().out.startswith("Frontal_Inf_Oper_L 0.906")
    assert (tmp_path / "hits.png").read_bytes()[:4] == b"\x89PNG"


@needs_aal
def test_other_lines_of_the_documents_run(tmp_path, monkeypatch):
    """All but the pictures, on files and arrays of the names that they use."""
    monkeypatch.chdir(tmp_path)
    for name in ("aal.nii.gz", "aal.nii.txt"):
        shutil.copy(os.path.join(os.path.dirname(AAL), name), name)
    for name in ("cst", "af", "t1"):
        nibabel.save(nibabel.Nifti1Image(plates("f4") / 2, AFFINE), f"{name}.nii.gz")
    nibabel.save(nibabel.Nifti1Image(plates(), AFFINE), "labels.nii.gz")
    corners = np.vstack([np.eye(3), -np.eye(3)]).astype("f4") * 150
    faces = np.array([[x, y, z] if (x < 3) ^ (y < 3) ^ (z < 3) else [x, z, y] for x in (0, 3) for y in (1, 4) for z in (2, 5)])
    scalp = [nibabel.gifti.GiftiDataArray(corners, "NIFTI_INTENT_POINTSET"),
             nibabel.gifti.GiftiDataArray(faces.astype("i4"), "NIFTI_INTENT_TRIANGLE")]  # fmt: skip
    nibabel.save(nibabel.gifti.GiftiImage(darrays=scalp), "scalp.surf.gii")
    ears = nibabel.gifti.GiftiDataArray(np.array([0, 1, 0, 0, 0, 0], "i4"), "NIFTI_INTENT_LABEL")
    nibabel.save(nibabel.gifti.GiftiImage(darrays=[ears]), "ears.label.gii")
    with open("scene.atlas.json", "w", encoding="utf-8") as file:
        file.write('{"conus_atlas": 1, "parcellation": {"file": "aal.nii.gz", "labels": "aal.nii.txt"}}')
    os.mkdir("atlases")
    shutil.copy(pathlib.Path(__file__).parents[1] / "fuzz" / "corpus" / "probe_interface" / "two_shanks.json", "np.json")
    with open("brainsight.txt", "w", encoding="utf-8") as file:
        file.write("query_id\tx\ty\tz\tdx\tdy\tdz\nM1\t-90\t20\t20\t1\t-0.3\t-0.1\n")
    call_conus("query", "aal.nii.gz", "--origin=-90,20,20", "--toward=0,-10,10", "-q", "-o", "rows.tsv")
    origins, directions = many_poses(30)
    given = {
        "array": plates(), "affine": AFFINE, "table": pandas.DataFrame({"index": [1], "name": ["V1"]}), "pressed": True,
        "origins": origins, "directions": directions, "times_s": np.arange(30) / 60, "time_s": 0, "pose": np.eye(4),
        "conus": conus, "nibabel": nibabel,
    }  # fmt: skip
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", conus.PoseWarning)
        for block in page_blocks()[1:]:
            if "render(" not in block:
                exec(block, given)
    assert len(given["answers"]) == 1 and len(given["track"]) == 30 and given["hits"].step is not None


# Many cones


def many_poses(count):
    random = np.random.default_rng(1)
    away = random.normal(size=(count, 3))
    away /= np.linalg.norm(away, axis=1)[:, None]
    return away * 120 + [0, -20, 20], -away + random.normal(size=(count, 3)) * 0.1


@needs_aal
def test_many_answers_are_those_of_the_program(tmp_path):
    origins, directions = many_poses(2000)
    table = pandas.DataFrame(np.hstack([origins, directions]), columns=["x", "y", "z", "dx", "dy", "dz"])
    table.to_csv(tmp_path / "poses.tsv", sep="\t", index=False, float_format="%.17g")
    rows = run_conus("batch", AAL, "--poses", str(tmp_path / "poses.tsv"), "--angle=5", "-q")
    frame = conus.load(AAL).select_many(origins, directions, angle=5).to_dataframe()
    assert "query" in frame.columns
    assert_rows_of_the_program(frame, rows)


def test_answers_do_not_depend_on_threads_or_layout(atlas):
    origins, directions = many_poses(700)
    origins /= 10
    angle = np.linspace(1, 90, 700)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", conus.PoseWarning)
        wanted = [atlas.select(o, direction=d, angle=a).results for o, d, a in zip(origins, directions, angle)]
        for threads in (1, 2, 5, None):
            for arrays in (
                (origins, directions),
                (np.asfortranarray(origins), directions[::-1][::-1]),
                (origins.tolist(), directions.astype(">f8")),
            ):
                answers = atlas.select_many(*arrays, angle=angle, threads=threads)
                assert len(answers) == 700
                assert all(same(a, w) for a, w in zip(answers, wanted))


def test_matrices_are_poses(atlas):
    poses = np.tile(np.eye(4), (2, 1, 1))
    poses[0, :3, :3] = [[0, 0, -1], [0, 1, 0], [1, 0, 0]]
    poses[1, :3, :3] = [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]
    answers = atlas.select_many(poses=poses)
    assert [atlas.objects.names[rows[0]["object"]] for rows in answers] == ["right", "left"]


def test_pose_at_fault_has_a_reason(atlas):
    answers = atlas.select_many([[0, 0, 0], [np.nan, 0, 0], [0, 0, 0]], [[1, 0, 0], [1, 0, 0], [0, 0, 0]])
    assert list(answers.errors) == [1, 2] and "nan" in answers.errors[1] and "direction" in answers.errors[2]
    frame = answers.to_dataframe()
    assert list(frame["query"]) == [1, 1, 2, 3] and list(frame["kind"])[2:] == ["error", "error"]
    assert frame["name"][2] == answers.errors[1]
    bad_angle = atlas.select_many([[0, 0, 0]] * 2, [[1, 0, 0]] * 2, angle=[20, 200])
    assert "200" in bad_angle.errors[1]


def test_no_poses_are_no_answers(atlas):
    answers = atlas.select_many(np.empty((0, 3)), np.empty((0, 3)))
    assert len(answers) == 0 and len(answers.to_dataframe()) == 0


def test_progress_is_told_and_its_exception_ends_the_run(atlas):
    origins, directions = np.zeros((2000, 3)), np.tile([1.0, 0, 0], (2000, 1))
    heard = []
    atlas.select_many(origins, directions, progress=lambda done, total: heard.append((done, total)))
    assert heard[-1] == (2000, 2000) and heard == sorted(heard)

    def stop(done, total):
        raise RuntimeError(f"stopped at {done} of {total}")

    with pytest.raises(RuntimeError, match="stopped at"):
        atlas.select_many(origins, directions, progress=stop)
    assert len(atlas.select_many(origins, directions)) == 2000  # the selector is unchanged


def test_ctrl_c_ends_a_run(atlas):
    origins, directions = np.zeros((100000, 3)), np.tile([1.0, 0, 0], (100000, 1))
    with pytest.raises(KeyboardInterrupt):
        atlas.select_many(origins, directions, progress=lambda *_: signal.raise_signal(signal.SIGINT))


def test_results_are_in_memory_once(atlas):
    """An eighth more than the results, at most, is allocated while they grow."""
    answers = atlas.select_many(np.zeros((5000, 3)), np.tile([1.0, 0, 0], (5000, 1)))
    assert answers.results.nbytes == len(answers.results) * answers.results.itemsize
    assert answers.results.base is None and answers.results.flags.owndata


# Atlases


@pytest.mark.parametrize("dtype", ["u1", "i1", "<u2", ">u2", "i2", "u4", ">i4", "u8", "i8", ">f4", "f8"])
@pytest.mark.parametrize("order", ["C", "F"])
def test_every_type_and_order_is_the_same_atlas(atlas, dtype, order):
    other = conus.load(plates(dtype, order), AFFINE, labels=NAMES)
    assert other.info().equals(atlas.info())


def test_views_are_taken_as_they_are(atlas):
    flipped = plates()[::-1, ::-1, ::-1]
    affine = AFFINE @ np.array([[-1, 0, 0, 39], [0, -1, 0, 29], [0, 0, -1, 29], [0, 0, 0, 1]])
    flipped.flags.writeable = False
    other = conus.load(flipped, affine, labels={2: "left", 1: "right"})
    assert other.select((0, 0, 0), direction=(1, 0, 0))[0].name == "left"
    assert len(atlas) == len(other) == 2


def test_labels_are_a_table(atlas):
    table = pandas.DataFrame({"index": [1, 2], "name": ["left", "right"], "hemisphere": ["L", "R"], "parent": [0, 1]})
    info = conus.load(plates(), AFFINE, labels=table).info()
    assert list(info["hemisphere"]) == ["L", "R"] and list(info["parent"]) == [0, 1]
    assert list(info["volume_mm3"]) == [10 * 30 * 30 * 8] * 2
    assert list(atlas.info()["hemisphere"]) == ["", ""]


def test_nibabel_images_are_atlases_pathways_and_contexts(tmp_path):
    image = nibabel.Nifti1Image(plates(), AFFINE)
    values = np.zeros((40, 30, 30), "f4")
    values[15:18] = 0.9
    bundle = nibabel.Nifti1Image(values, AFFINE)
    nibabel.save(bundle, tmp_path / "bundle.nii.gz")
    for pathway in (bundle, (bundle, 0.5), tmp_path / "bundle.nii.gz", (str(tmp_path / "bundle.nii.gz"), 0.5)):
        atlas = conus.load(image, labels=NAMES, pathways=[pathway])
        assert list(atlas.info()["kind"]) == ["area", "area", "pathway"]
        assert atlas.select((0, 0, 0), direction=(-1, 0, 0))[0].kind == "pathway"
    atlas = conus.load(image, labels=NAMES, context=bundle, context_blocks=0.5)
    assert atlas.select((0, 0, 0), direction=(-1, 0, 0))[0].name == "unassigned"


def test_bands_of_values_are_pathways(tmp_path):
    values = np.zeros((40, 30, 30), "f4")
    values[15:18], values[12:15], values[3:12] = 0.9, 0.5, -0.2
    image = nibabel.Nifti1Image(values, AFFINE)
    nibabel.save(image, tmp_path / "map.nii.gz")
    bands = {"High": (0.5, None), "Low": (None, 0)}
    for source in (image, tmp_path / "map.nii.gz"):
        atlas = conus.load(plates(), AFFINE, labels=NAMES, pathways=[(source, bands)])
        assert list(atlas.info()["name"])[2:] == ["High", "Low"]
        assert list(atlas.info()["voxels"])[2:] == [6 * 900, 9 * 900]
    for wrong in ({}, {"A": 3}, {"A": (1,)}, {"A": (math.nan, 1)}, {"A": (1, 0)}, {"A": (5, None)}, {3: (0, 1)},
                  {"A": ("a", 1)}, {"A": (0, 0.6), "B": (0.5, 1)}, {"": (0, 1)}, {"A\0": (0, 1)}):
        with pytest.raises(conus.ArgumentError):
            conus.load(plates(), AFFINE, labels=NAMES, pathways=[(image, wrong)])


def test_only_and_hide(atlas):
    assert atlas.select((0, 0, 0), direction=(1, 0, 0))[0].name == "right"
    hidden = conus.load(plates(), AFFINE, labels=NAMES, hide="right")
    with pytest.warns(conus.PoseWarning, match="it would hit left first"):
        assert hidden.select((0, 0, 0), direction=(1, 0, 0))[0].name == "unassigned"
    with pytest.raises(conus.ArgumentError, match="riht"):
        conus.load(plates(), AFFINE, labels=NAMES, only="riht")


def test_a_path_has_spaces_and_bytes(tmp_path):
    folder = os.fsencode(tmp_path) + b"/a b\xff"
    os.mkdir(folder)
    nibabel.save(nibabel.Nifti1Image(plates(), AFFINE), tmp_path / "atlas.nii.gz")
    os.rename(tmp_path / "atlas.nii.gz", folder + b"/at las.nii.gz")
    heard = []
    atlas = conus.load(folder + b"/at las.nii.gz", progress=lambda *what: heard.append(what))
    assert len(atlas) == 2 and os.fsencode(heard[0][0]) == folder + b"/at las.nii.gz"
    with pytest.raises(ZeroDivisionError):
        conus.load(folder + b"/at las.nii.gz", progress=lambda *what: 1 / 0)


BAD = {
    "no file": (lambda: conus.load("no such file"), conus.FileError),
    "two axes": (lambda: conus.load(np.zeros((2, 2)), AFFINE), conus.ArgumentError),
    "four axes": (lambda: conus.load(np.zeros((2, 2, 2, 2)), AFFINE), conus.ArgumentError),
    "no voxels": (lambda: conus.load(np.zeros((0, 2, 2)), AFFINE), conus.ArgumentError),
    "complex": (lambda: conus.load(np.zeros((2, 2, 2), complex), AFFINE), conus.ArgumentError),
    "texts": (lambda: conus.load(np.zeros((2, 2, 2), "U3"), AFFINE), conus.ArgumentError),
    "no affine": (lambda: conus.load(plates()), conus.ArgumentError),
    "small affine": (lambda: conus.load(plates(), np.eye(3)), conus.ArgumentError),
    "flat affine": (lambda: conus.load(plates(), np.diag([2, 2, 0, 1])), conus.DataError),
    "NaN affine": (lambda: conus.load(plates(), np.diag([2, 2, np.nan, 1])), conus.DataError),
    "a fraction": (lambda: conus.load(plates("f4") + np.float32(0.5), AFFINE), conus.DataError),
    "below zero": (lambda: conus.load(-plates("i2"), AFFINE), conus.DataError),
    "four-axis image": (lambda: conus.load(nibabel.Nifti1Image(np.ones((4, 4, 4, 2), "u1"), AFFINE)), conus.ArgumentError),
    "label 0": (lambda: conus.load(plates(), AFFINE, labels={0: "x"}), conus.ArgumentError),
    "a hemisphere": (
        lambda: conus.load(plates(), AFFINE, labels=pandas.DataFrame({"index": [1], "name": ["a"], "hemisphere": ["X"]})),
        conus.ArgumentError,
    ),
    "hemispheres": (lambda: conus.load(plates(), AFFINE, hemispheres="both"), conus.ArgumentError),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_atlas_is_an_error(case):
    call, error = BAD[case]
    with pytest.raises(error) as caught:
        call()
    assert str(caught.value) and "\n" not in str(caught.value)
    assert isinstance(caught.value, conus.Error)


@pytest.mark.parametrize(
    "aim",
    [
        {},
        {"origin": (0, 0, 0)},
        {"origin": (0, 0, 0), "toward": (0, 0, 0)},
        {"origin": (0, 0), "toward": (0, 0, 1)},
        {"origin": (0, 0, 0), "toward": (0, 0, 1), "direction": (0, 0, 1)},
        {"origin": (0, 0, np.inf), "toward": (0, 0, 1)},
        {"pose": np.eye(3)},
        {"pose": 2 * np.eye(4)},
        {"pose": np.eye(4), "origin": (0, 0, 0)},
        {"pose": np.eye(4), "angle": 180},
        {"pose": np.eye(4), "angle": np.nan},
        {"pose": np.eye(4), "layers": "some"},
        {"pose": np.eye(4), "resolution": 2000},
        {"pose": np.eye(4), "score": "nonsense"},
    ],
)
def test_bad_aim_is_an_error(atlas, aim):
    with pytest.raises(conus.ArgumentError):
        atlas.select(**aim)


@pytest.mark.parametrize(
    "arrays",
    [
        {},
        {"origins": np.zeros((2, 3))},
        {"origins": np.zeros((2, 3)), "directions": np.ones((3, 3))},
        {"origins": np.zeros((2, 2)), "directions": np.ones((2, 2))},
        {"origins": np.zeros(3), "directions": np.ones(3)},
        {"origins": np.zeros((2, 3)), "directions": np.ones((2, 3)), "angle": [1, 2, 3]},
        {"origins": np.zeros((2, 3)), "directions": np.ones((2, 3)), "up": np.ones((1, 3))},
        {"poses": np.zeros((2, 3, 3))},
        {"poses": np.zeros((2, 4, 4)), "origins": np.zeros((2, 3)), "directions": np.ones((2, 3))},
        {"origins": np.zeros((2, 3)), "directions": np.ones((2, 3)), "threads": 5000},
    ],
)
def test_bad_arrays_are_an_error(atlas, arrays):
    with pytest.raises(conus.ArgumentError):
        atlas.select_many(**arrays)


def test_a_closed_atlas_is_an_error_and_its_answers_live(atlas):
    hits = atlas.select((0, 0, 0), direction=(1, 0, 0))
    with atlas:
        pass
    for ask in (
        lambda: atlas.select((0, 0, 0), direction=(1, 0, 0)),
        lambda: atlas.select_many(np.zeros((1, 3)), np.ones((1, 3))),
        atlas.info,
        lambda: pickle.dumps(atlas),
    ):
        with pytest.raises(conus.ArgumentError, match="closed"):
            ask()
    assert hits[0].name == "right" and hits.image("id").any()


# Threads and processes


def name_on_the_right(atlas):
    return atlas.select((0, 0, 0), direction=(1, 0, 0))[0].name


def test_an_atlas_is_pickled(atlas):
    other = pickle.loads(pickle.dumps(atlas))
    assert other.info().equals(atlas.info()) and name_on_the_right(other) == "right"


def test_an_atlas_is_saved_as_a_pack(atlas, tmp_path):
    path = tmp_path / "sides.conus"
    atlas.save(path)
    other = conus.load(path)
    assert other.info().equals(atlas.info()) and name_on_the_right(other) == "right"
    path.write_bytes(path.read_bytes()[:-1])
    with pytest.raises(conus.DataError, match="pack it again"):
        conus.load(path)
    with pytest.raises(conus.ArgumentError, match="closed"):
        with atlas:
            pass
        atlas.save(path)


def test_a_damaged_pickle_is_an_error(atlas):
    """Every bit of the packed bytes counts: 64 of them, spread over the pickle, behind what pickle itself reads."""
    whole = pickle.dumps(atlas)
    for at in np.linspace(200, len(whole) - 60, 64).astype(int):
        damaged = bytearray(whole)
        damaged[at] ^= 1
        with pytest.raises(conus.DataError, match="pickled atlas"):
            pickle.loads(bytes(damaged))


def test_what_lives_in_a_process_is_not_pickled(atlas):
    hits = atlas.select((0, 0, 0), direction=(1, 0, 0))
    selector = atlas.selector()
    for one in (hits, selector, selector.tracker()):
        with pytest.raises(conus.UnsupportedError, match="cannot be pickled"):
            pickle.dumps(one)
    assert copy.copy(hits)[0].name == "right"


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork()")
def test_a_child_answers_whose_parent_was_asking(atlas):
    """A callback holds the selector and says so: the process is forked exactly then."""
    asked, forked = threading.Event(), threading.Event()

    def wait(done, total):
        asked.set()
        assert forked.wait(60)

    many = [(0, 0, 0)] * 3, [(1, 0, 0)] * 3
    other = threading.Thread(target=lambda: atlas.select_many(*many, progress=wait))
    other.start()
    assert asked.wait(60)
    child = os.fork()
    if not child:
        faulthandler.dump_traceback_later(30, exit=True)  # where it hangs
        os._exit(0 if name_on_the_right(atlas) == "right" else 1)
    forked.set()
    other.join()
    assert os.waitpid(child, 0)[1] == 0 and name_on_the_right(atlas) == "right"


@pytest.mark.parametrize("method", sorted({"fork", "spawn"} & {*multiprocessing.get_all_start_methods()}))
def test_processes_answer(atlas, method):
    name_on_the_right(atlas)
    with multiprocessing.get_context(method).Pool(2) as pool:
        assert pool.map(name_on_the_right, [atlas] * 4) == ["right"] * 4


def test_threads_may_ask_at_once(atlas):
    wanted = atlas.select((0, 0, 0), direction=(1, 0, 0)).results
    failures = []

    def ask():
        for _ in range(300):
            if not same(atlas.select((0, 0, 0), direction=(1, 0, 0)).results, wanted):
                failures.append(1)

    threads = [threading.Thread(target=ask) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failures


# Output in a notebook


def test_tables_are_escaped(atlas):
    evil = conus.load(plates(), AFFINE, labels={1: "<script>", 2: "b"})
    shown = evil.select((0, 0, 0), direction=(-1, 0, 0))._repr_html_()
    assert "&lt;script&gt;" in shown and "<script>" not in shown
    assert "100.00 %" in atlas.select((0, 0, 0), direction=(1, 0, 0))._repr_html_()


def test_picture_is_a_png(atlas):
    assert atlas.select((0, 0, 0), direction=(1, 0, 0))._repr_png_()[:8] == b"\x89PNG\r\n\x1a\n"


def quarters():
    """A wall whose quarters about the x axis are the labels 1, 3 and twice 2, with a wall of 4 behind it."""
    labels = np.zeros((40, 30, 30), "u1")
    labels[30, 15:, 15:], labels[30, 15:, :15], labels[30, :15], labels[35] = 1, 3, 2, 4
    return conus.load(labels, AFFINE, labels={1: "quarter", 2: "half", 3: "rest", 4: "behind"})


def test_bars_are_from_the_best_down(monkeypatch):
    """By symmetry of the wall: half 1/2, quarter 1/4, rest 1/4. The best bar is the topmost, each in its own colour."""
    monkeypatch.setenv("MPLBACKEND", "agg")
    pyplot = pytest.importorskip("matplotlib.pyplot")
    atlas = quarters()
    hits = atlas.select((0, 0, 0), direction=(1, 0, 0), angle=60, aperture="square", layers="all")
    axes = hits.plot(pyplot.figure().subplots())
    bars = sorted(axes.patches, key=lambda bar: -bar.get_y())
    assert [round(bar.get_width(), 9) for bar in bars] == [50, 25, 25]
    names = [label.get_text() for label in sorted(axes.get_yticklabels(), key=lambda label: -label.get_position()[1])]
    assert names == ["half", *(hit.name for hit in hits[1:3])] and {*names} == {"half", "quarter", "rest"}
    for bar, name in zip(bars, names):
        np.testing.assert_allclose(bar.get_facecolor()[:3], atlas.objects.colours[atlas.find(name)] / 255)
    assert axes.get_xlabel() == "share of the cone, %"
    assert repr(hits).startswith("<conus.Selection: half 50.0 %, ") and repr(hits).endswith(" 25.0 %, ...>")
    assert [hit.name for hit in hits[3:]] == ["behind", "unassigned"]
    pyplot.close("all")


def test_words_of_a_selection(atlas):
    assert repr(atlas.select((0, 0, 0), direction=(1, 0, 0))) == "<conus.Selection: right 100.0 %, unassigned 0.0 %>"
    assert repr(atlas) == "<conus.Atlas of 2 objects>"


def test_a_placement_says_where_the_areas_are():
    """20 x 20 x 20 voxels of 2 mm from 0: areas reach from -1 to 39 mm. By x' = x + 7 they begin at -8."""
    plain = conus.load(plates(), AFFINE, labels=NAMES).placement()
    assert (plain.growth, plain.mirrors, plain.in_grid, plain.in_head) == (1, False, None, None)
    matrix = np.diag([-1.0, 1, 2, 1])
    matrix[0, 3] = 7
    moved = conus.load(plates(), AFFINE, labels=NAMES, transforms=[matrix]).placement()
    assert moved.mirrors and moved.growth == pytest.approx(0.5)
    np.testing.assert_allclose(moved.atlas_from_world, matrix)
    np.testing.assert_allclose(moved.own_box, plain.box, atol=1e-9)
    np.testing.assert_allclose(moved.box[:, 0], 7 - plain.box[::-1, 0], atol=1e-9)
    np.testing.assert_allclose(moved.centre, (plain.centre * (-1, 1, 0.5)) + (7, 0, 0), atol=1e-9)
    assert moved.distance_mm == pytest.approx(np.linalg.norm(moved.centre - plain.centre))
    nibabel = pytest.importorskip("nibabel")
    head = nibabel.Nifti1Image(np.pad(np.ones((8, 8, 8), "u1"), 2), matrix @ np.diag([4, 4, 4, 1]))
    seen = conus.load(plates(), AFFINE, labels=NAMES, transforms=[matrix], context=head).placement()
    assert 0 < seen.in_head < seen.in_grid <= 1


def test_a_context_may_be_surfaces(tmp_path):
    """A box of 40 mm about the left plate's middle: the other plate of two is not in it."""
    corners = [(x, y, z) for x in (-45, -5) for y in (-40, 40) for z in (-40, 40)]
    faces = ["1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4"]
    box = tmp_path / "box.obj"
    box.write_text("".join("v %d %d %d\n" % c for c in corners) + "".join(f"f {f}\n" for f in faces))
    atlas = conus.load(plates(), AFFINE, context=[box], context_opacity=0.5)
    assert atlas.placement().in_head == pytest.approx(0.5, abs=0.01)
    plain = conus.load(plates(), AFFINE)
    hits = [one.select(origin=(0, 0, 0), direction=(-5, 0, 0), angle=10) for one in (atlas, plain)]
    assert str(hits[0]) == str(hits[1])
    for arguments, why in (
        ({"context": box, "context_blocks": 1}, "there is no context volume"),
        ({"context_opacity": 0.5}, "there is no surface"),
        ({"context": box, "context_opacity": 1.5}, "opacity of 1.5"),
        ({"context": ["a.nii", "b.nii"]}, "several volumes"),
    ):
        with pytest.raises(conus.ArgumentError, match=why):
            conus.load(plates(), AFFINE, **arguments)


def test_a_context_that_no_answer_needs_is_left_out(tmp_path):
    nibabel = pytest.importorskip("nibabel")
    nibabel.Nifti1Image(plates(), AFFINE).to_filename(tmp_path / "plates.nii")
    nibabel.Nifti1Image(plates("f4"), AFFINE).to_filename(tmp_path / "image.nii")
    scene = tmp_path / "a.atlas.json"
    scene.write_text('{"conus_atlas": 1, "parcellation": "plates.nii", "context": "image.nii"}')
    whole, bare = conus.load(scene), conus.load(scene, context=False)
    hits = [one.select(origin=(0, 0, 0), direction=(-5, 0, 0), angle=10) for one in (whole, bare)]
    assert str(hits[0]) == str(hits[1])
    whole.inward((0, 90, 0))
    with pytest.raises(conus.ArgumentError, match="loaded without its context"):
        bare.inward((0, 90, 0))


def test_a_manifest_has_its_transform(tmp_path):
    nibabel = pytest.importorskip("nibabel")
    nibabel.Nifti1Image(plates(), AFFINE).to_filename(tmp_path / "plates.nii")
    matrix = np.eye(4)
    matrix[0, 3] = 7
    np.savetxt(tmp_path / "right.txt", matrix)
    (tmp_path / "one.atlas.json").write_text(
        '{"conus_atlas": 1, "parcellation": "plates.nii", "transform": "right.txt"}')
    own = conus.load(tmp_path / "plates.nii", transforms=[matrix]).placement()
    kept = conus.load(tmp_path / "one.atlas.json").placement()
    np.testing.assert_array_equal(kept.atlas_from_world, matrix)
    np.testing.assert_array_equal(kept.box, own.box)
    twice = conus.load(tmp_path / "one.atlas.json", transforms=[matrix]).placement()
    assert twice.atlas_from_world[0, 3] == 14
