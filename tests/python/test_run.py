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
    rows = rows.astype({"query": str, "abbreviation": object})  # which are texts of run(), and numbers of pandas
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


def test_a_program_that_a_signal_ends_has_failed(tmp_path, monkeypatch):
    # It has a note and rows, as one that the system ends for its memory may have.
    program = tmp_path / "conus"
    program.write_text("#!/bin/sh\nif [ $1 = help ]; then echo '{\"commands\": []}'; exit; fi\n"
                       "echo rows\necho 'conus: a note' >&2\nkill -9 $$\n", encoding="utf-8")
    program.chmod(0o755)
    monkeypatch.setenv("CONUS", str(program))
    with pytest.raises(conus.DataError, match="^conus ended with -9$"):
        conus.run("query aal --point 0,0,0")


def test_ids_stay_texts(image, names):
    at = pandas.DataFrame({"query": ["007", "1e3"], "x": [-30, 30], "y": [0, 0], "z": [0, 0],
                           "dx": [1, 1], "dy": [0, 0], "dz": [0, 0]})
    names = names.assign(name=["0" * number for number in names["index"]])
    line = "query {atlas} --labels {names} --pose {at} --angle 5 -q"
    found = conus.run(line, atlas=image, names=names, at=at)
    assert list(found["query"].unique()) == ["007", "1e3"]
    assert set(found[found["kind"] == "area"]["name"]) <= set(names["name"]) and (found["kind"] == "area").any()


def test_words_of_the_output(image, names, tmp_path):
    # Rows go to a file where -o and its value are one word; "--" ends options, and the format stands before it.
    line = f"query {{atlas}} --labels {{names}} {CONE}"
    assert conus.run(f"{line} -o{tmp_path}/rows.tsv", atlas=image, names=names) == ""
    assert (tmp_path / "rows.tsv").exists()
    assert len(conus.run(f"query --labels {{names}} {CONE} -- {{atlas}}", atlas=image, names=names)) == 2


def test_a_probe_that_is_named_twice(image, names):
    probe = {"specification": "probeinterface", "probes": [{
        "ndim": 2, "si_units": "mm", "contact_positions": [[0, 0]], "device_channel_indices": [0],
        "probe_planar_contour": [[-1, 70], [0, -5], [1, 70]]}]}
    with pytest.raises(conus.ArgumentError, match="probe.* is given twice"):
        conus.run("query {atlas} --labels {names} --probe {np} --origin 0,0,0 --direction 0,0,1 --probe {np}",
                  atlas=image, names=names, np=probe)
