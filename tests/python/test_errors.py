# SPDX-License-Identifier: BSD-3-Clause
"""Published errors of poses: the table against the numbers that studies print, and where a name may stand."""
import csv
import math
import os
import pathlib
import re

import numpy
import pandas
import pytest

import conus

SHARED = pathlib.Path(os.environ.get("CONUS_SHARED_DATA") or pathlib.Path(__file__).parents[3] / "shared/data")
TABLE = SHARED / "published/errors.tsv"
KEYS = {"mm": "shift_mm", "deg": "tilt_deg", "entry": "entry_mm", "target": "target_mm", "depth": "depth_mm"}


def sigma_of(row):
    """Of a normal error of 2 or 3 axes, from the mean or median of its length (Eq. 29)."""
    if not re.fullmatch(r"[\d.]+", row["value"]) or row["axes"] not in "23":
        return None
    factor = {("2", "mean"): math.sqrt(math.pi / 2), ("2", "median"): math.sqrt(2 * math.log(2)),
              ("3", "mean"): math.sqrt(8 / math.pi), ("3", "median"): 1.5382}
    is_difference = "differences" in row["statistic"] or "mapped twice" in row["quantity"] or row["name"] == "tms-hotspot-other"
    return float(row["value"]) / factor[row["axes"], re.split("[ ,]", row["statistic"])[0]] / (math.sqrt(2) if is_difference else 1)


@pytest.mark.skipif(not TABLE.exists(), reason="published/errors.tsv of the shared data is not here")
def test_each_name_and_number_is_that_of_the_table():
    errors = conus.errors().to_dataframe()
    known, met = {error["name"]: error for error in errors.to_dict("records")}, {}
    source = {}
    for row in csv.DictReader(TABLE.open(encoding="utf-8"), delimiter="\t"):
        source.setdefault(row["name"], row["source"].split(";")[0])
        for kind in row["maps_to"].split(", "):
            if kind != "n/a":
                met.setdefault(row["name"], {})[KEYS[kind]] = float(row["sigma"])
                derived = sigma_of(row)
                assert derived is None or derived == pytest.approx(float(row["sigma"]), abs=6e-4), row["name"]
        if re.fullmatch(r"[\d.]+", row["value"]):
            assert row["value"] in known[row["name"]]["measured"], row
    assert set(known) == set(source)
    for name, error in known.items():
        assert {key: error[key] for key in KEYS.values() if error[key]} == met[name], name
        assert error["source"] == source[name]


@pytest.fixture
def halves():
    labels = numpy.zeros((20, 20, 20), "u1")
    labels[:10], labels[10:] = 1, 2
    return conus.load(labels, numpy.diag([2, 2, 2, 1]), labels={1: "left", 2: "right"})


AIM = dict(origin=(19, 19, -60), toward=(19, 19, 19), angle=4)


def test_a_name_stands_for_its_numbers(halves):
    cap = halves.jitter(**AIM, error="tms-cap", samples=256).to_dataframe()
    assert cap.equals(halves.jitter(**AIM, degrees=6.216, mm=6.68, samples=256).to_dataframe())
    # of a target W degrees wide: the root mean square of both axes, by the published coefficients
    wide = math.sqrt(((0.2130 + 0.1102 * 8) ** 2 + (0.2311 + 0.0715 * 8) ** 2) / 2)
    hand = halves.jitter(**AIM, error="vr-controller:8", samples=256).to_dataframe()
    by_number = halves.jitter(**AIM, degrees=wide, samples=256).to_dataframe()
    pandas.testing.assert_frame_equal(hand, by_number, rtol=1e-12)  # the root may be off by a last digit


def test_needles_have_errors_of_both_ends(halves):
    asked = dict(reach={"left": 1}, origins=[[10, 19, -60]], directions=[[0, 0, 1]], depth=80, samples=256)
    by_name = halves.plan(jitter="seeg-robot", **asked).to_dataframe()
    assert by_name.equals(halves.plan(jitter={"entry": 0.662, "target": 1.151, "depth": 1.151}, **asked).to_dataframe())


@pytest.mark.parametrize("name, said", [
    ("tms-hat", "did you mean tms-cap"), ("cap", r"; did you mean tms-cap, eeg-cap\?$"),
    ("", r"no published error; there are .*, tms-cap,"), ("xyzzy", r"; there are .*, eeg-cap, vr-controller$"), ("seeg-robot", "plan"), ("vr-controller", "width"),
    ("vr-controller:-1", "width"), ("vr-controller:nan", "width"),
])
def test_other_names_are_refused(halves, name, said):
    with pytest.raises(conus.ArgumentError, match=said):
        halves.jitter(**AIM, error=name)


def test_a_name_has_its_own_numbers(halves):
    with pytest.raises(conus.ArgumentError, match="of its own"):
        halves.jitter(**AIM, error="dbs", mm=1)
