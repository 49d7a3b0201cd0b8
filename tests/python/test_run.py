# SPDX-License-Identifier: BSD-3-Clause
"""conus.run gives the program what is in memory, and the answer is that for files."""
import nibabel
import numpy as np
import pandas
import pytest

import conus
from support import AFFINE, NAMES, plates, run_conus

CONE = "--origin -60,19,19 --toward 19,19,19 --angle 20 -q"


@pytest.fixture(name="image")
def make_image():
    return nibabel.Nifti1Image(plates(), AFFINE)


@pytest.fixture(name="names")
def make_names():
    return pandas.DataFrame({"index": NAMES.keys(), "name": NAMES.values()})


def test_rows_are_those_of_files(image, names, tmp_path):
    image.to_filename(tmp_path / "plates.nii")
    names.to_csv(tmp_path / "names.tsv", sep="\t", index=False)
    rows = run_conus("query", tmp_path / "plates.nii", "--labels", tmp_path / "names.tsv", *CONE.split(), "--format", "tsv")
    assert rows["name"].tolist() == ["left", "unassigned"]
    pandas.testing.assert_frame_equal(conus.run(f"query {{atlas}} --labels {{names}} {CONE}", atlas=image, names=names), rows)
    line = "query {atlas} --labels {names} --origin {at} --toward {to} --angle {angle} -q"
    found = conus.run(line, atlas=image, names=names, at=(-60, 19, 19), to=np.array([19.0, 19, 19]), angle=20)
    pandas.testing.assert_frame_equal(found, rows)


def test_positions_and_probes(image, names):
    points = np.array([[-30.5, 0, 0], [30, 1, 2]])
    found = conus.run("query {atlas} --labels {names} --pose {points} -q", atlas=image, names=names, points=points)
    found = found[found["kind"] == "area"]
    assert found["name"].tolist() == ["left", "right"] and found["x"].tolist() == [-30.5, 30]
    probe = {"specification": "probeinterface", "probes": [{
        "ndim": 2, "si_units": "mm", "contact_positions": [[0, 0], [0, 60]], "device_channel_indices": [0, 1],
        "probe_planar_contour": [[-1, 70], [0, -5], [1, 70]]}]}
    found = conus.run("query {atlas} --labels {names} --probe {np} --origin -35,1,2 --direction -1,0,0 --up 0,0,1 -q",
                      atlas=image, names=names, np=probe)
    assert found[found["kind"] == "area"]["name"].tolist() == ["left", "right"]


def test_files_come_back(image, names):
    found = conus.run(f"query {{atlas}} --labels {{names}} {CONE} --mask {{inside.nii.gz}} -o {{rows}} --layers all",
                      atlas=image, names=names, inside=conus.OUT, rows=conus.OUT)
    assert set(found) == {"inside", "rows"} and found["rows"]["name"].tolist() == ["left", "right", "unassigned"]
    assert np.allclose(found["inside"].affine, AFFINE) and np.asarray(found["inside"].dataobj).any()
    text = conus.run("info {atlas} --labels {names} --format json", atlas=image, names=names)
    assert isinstance(text, str) and text.startswith("{")


def test_notes_and_refusals(image, names):
    with pytest.raises(conus.ArgumentError, match="nowhere"):
        conus.run("query {atlas} --labels {names} --nowhere 1", atlas=image, names=names)
    with pytest.raises(conus.Error, match="nowhere.tsv") as told:
        conus.run("query {atlas} --labels {names} --point left -q", atlas=image, names="nowhere.tsv")
    assert "/conus-" not in str(told.value)
    with pytest.raises(conus.Error, match=r"^np\.json: "):
        conus.run("query {atlas} --probe {np} --origin 1,2,3 --direction 0,0,1", atlas=image, np={"specification": "other"})


@pytest.mark.parametrize(("line", "values", "match"), [
    ("query {atlas}", {}, "{atlas}: there is no such value"),
    ("atlases", {"atlas": 1}, "atlas: the line has no {atlas}"),
    ("query aal --point {at}", {"at": object()}, "at: .*wanted is a path"),
    ("query aal --point {at}", {"at": np.zeros((2, 2))}, "at: .*wanted is a path"),
    ("query aal --point {at}", {"at": ["a", "b"]}, "at: .*wanted is a path"),
])
def test_values_that_are_none(line, values, match):
    with pytest.raises(conus.ArgumentError, match=match):
        conus.run(line, **values)


def test_no_value_is_an_option_or_two_words(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for value in ("--version", "-h", "x; touch y", "$(touch y)", "a b"):
        with pytest.raises(conus.Error):
            conus.run("info {atlas}", atlas=value)
    assert not list(tmp_path.iterdir())
