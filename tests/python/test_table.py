# SPDX-License-Identifier: BSD-3-Clause
"""Tables: read-only views of the library's columns, which outlive all that they were made of."""
import gc
import os
import random

import numpy as np
import pytest

import conus
from conus._conus import ffi, lib


def make_atlas():
    labels = np.zeros((12, 12, 12), "u1")
    labels[:6], labels[6:] = 1, 2
    return conus.load(labels, np.diag([2.0, 2, 2, 1]), labels={1: "left", 2: "right"})


AIM = {"origin": (-40, 11, 11), "toward": (11, 11, 11)}


def test_columns_are_read_only_views():
    sweep = make_atlas().sweep(**AIM, angle=40)
    assert isinstance(sweep, conus.Table) and len(sweep) == 2
    assert sweep.columns[:4] == ("kind", "index", "name", "abbreviation")
    assert sweep["angle_deg"].dtype == np.float64 and sweep["rank"].dtype == np.int64
    # both rows of voxel centres are as far from the axis, so the farther one has the smaller angle
    assert sweep["name"].tolist() == ["right", "left"] and sweep["abbreviation"].tolist() == [None, None]
    assert sweep.unit("x") == "mm" and sweep.unit("rank") == "" and "cone" in sweep.help("angle_deg")
    for name in ("angle_deg", "rank"):
        assert not sweep[name].flags.writeable and not sweep[name].flags.owndata
        with pytest.raises(ValueError):
            sweep[name][0] = 1
        assert sweep[name].ctypes.data == sweep[name].ctypes.data  # no copy
    with pytest.raises(KeyError):
        sweep["no such column"]
    frame = sweep.to_dataframe()
    assert list(frame.columns) == list(sweep.columns) and frame["abbreviation"].isna().all()
    np.testing.assert_array_equal(frame["distance_mm"], sweep["distance_mm"])
    assert "left" in sweep._repr_html_() and "angle_deg" in repr(sweep)


def test_an_answer_without_rows_has_columns():
    empty = make_atlas().sweep(origin=(-40, 11, 11), direction=(-1, 0, 0), angle=10)
    assert len(empty) == 0 and empty["x"].shape == (0,) and list(empty.to_dataframe().columns) == list(empty.columns)


def test_positions_are_in_the_space_of_the_selector():
    atlas = make_atlas()
    ras = atlas.sweep(**AIM)
    lps = atlas.sweep(origin=(40, -11, 11), toward=(-11, -11, 11), space="lps")
    np.testing.assert_array_equal(lps["x"], -ras["x"])
    np.testing.assert_array_equal(lps["y"], -ras["y"])
    np.testing.assert_array_equal(lps["z"], ras["z"])


def test_tables_of_many_poses_are_tables():
    many = make_atlas().segments_many([(-40, 11, 11), (np.nan, 0, 0), (11, 11, 60)], [(1, 0, 0), (1, 0, 0), (0, 0, -1)])
    assert type(many) is conus.Table and many.starts[-1] == len(many) and list(many.errors) == [1]
    assert many.unit("entry_mm") == "mm" and many.help("entry_mm") and not many["entry_mm"].flags.writeable
    assert "query" in many.to_dataframe() and "<table" in many._repr_html_()
    with pytest.raises(KeyError):
        many.part("pairs")
    one = make_atlas().segments((-40, 11, 11), direction=(1, 0, 0))
    assert one.starts.tolist() == [0, len(one)] and one.errors == {}
    for name in one.columns:
        np.testing.assert_array_equal(many[name][:many.starts[1]], one[name])
    many.arrays().clear()
    assert len(many["entry_mm"]) == len(many)
    for table in (one, many):  # how many rows a view has is not the caller's to say
        assert not table.starts.flags.writeable
    one.starts = np.array([0, 10**6])
    assert one["entry_mm"].shape == many["entry_mm"][:many.starts[1]].shape


def make_lines(atlas):
    """The atlas with a streamline from one area to the other."""
    points, first = ffi.new("float[6]", [5, 11, 11, 18, 11, 11]), ffi.new("uint64_t[2]", [0, 2])
    lines = ffi.new("conus_polylines *")
    lines.points, lines.type, lines.point_count = points, lib.CONUS_SCALAR_FLOAT32, 2
    lines.first, lines.streamline_count = first, 1
    assert lib.conus_atlas_add_polylines(atlas._p, lines, ffi.NULL) == 0
    return conus.Atlas(atlas._p)


ROI = (np.ones((6, 6, 6), "f4"), np.diag([2.0, 2, 2, 1]))
TABLES = {
    "sweep": lambda atlas, selector: selector.sweep(**AIM),
    "segments": lambda atlas, selector: selector.segments(**AIM),
    "overlap": lambda atlas, selector: selector.overlap(ROI),
    "many": lambda atlas, selector: selector.clearance_many([(-40, 11, 11)] * 2, [(1, 0, 0)] * 2),
    "connectivity": lambda atlas, selector: selector.connectivity(),
    "pairs": lambda atlas, selector: selector.connectivity().part("pairs"),
    "list": lambda atlas, selector: atlas.table("objects"),
}
ANSWERS = {
    "selection": lambda atlas, selector: selector.select(**AIM, angle=20),
    "answers": lambda atlas, selector: selector.select_many([(-40, 11, 11)], [(1, 0, 0)]),
    "streamlines": lambda atlas, selector: selector.select(**AIM, angle=20).streamlines(),
}


def content(array):
    if array.dtype.names:  # between members of records anything may stand
        return [array[name].tobytes() for name in array.dtype.names]
    return array.tolist() if array.dtype == object else array.tobytes()


def arrays_of(answer):
    if isinstance(answer, conus.Table):
        return [answer.objects, *map(answer.__getitem__, answer.columns)]
    return [answer.results] if hasattr(answer, "results") else [answer.numbers, answer[0]]


def test_columns_outlive_all_that_they_were_made_of_in_any_order():
    """Orders in which an atlas, its selector, answers and their arrays end; of what is left two are read after each.

    2,000, or 10^4 by CONUS_TEST_ALL, and with AddressSanitizer by CONUS_TEST_LONG.
    """
    all_of_them = "CONUS_TEST_LONG" if "asan" in os.environ.get("LD_PRELOAD", "") else "CONUS_TEST_ALL"
    rng = random.Random(7)
    makers = {**TABLES, **ANSWERS}
    atlas = make_lines(make_atlas())
    selector = atlas.selector()
    wanted = {name: [content(array) for array in arrays_of(make(atlas, selector))] for name, make in makers.items()}
    assert all(len(values) for arrays in wanted.values() for values in arrays)
    for _ in range(10_000 if os.environ.get(all_of_them) else 2_000):
        asked = rng.sample(list(makers), 2)
        held = {("answer", name): makers[name](atlas, selector) for name in asked}
        held.update({("array", name, i): array for name in asked for i, array in enumerate(arrays_of(held["answer", name]))})
        held["selector"], selector = selector, None
        is_last = rng.random() < 0.1
        if is_last:
            held["atlas"], atlas = atlas, None
        order = list(held)
        rng.shuffle(order)
        for end in order:
            gone = held.pop(end)
            if end == "atlas" and rng.random() < 0.5:
                gone.close()
            del gone
            left = [key for key in held if key[0] == "array"]
            for key in rng.sample(left, min(2, len(left))):
                assert content(held[key]) == wanted[key[1]][key[2]]
        if is_last:
            atlas = make_lines(make_atlas())
        selector = atlas.selector()
        if rng.random() < 0.01:
            gc.collect()


def test_an_atlas_lists_what_it_has():
    atlas = make_atlas()
    objects, notes = atlas.table("objects"), atlas.table("notes")
    with pytest.raises(conus.ArgumentError, match="what: areas, allowed are objects, surfaces"):
        atlas.table("areas")
    atlas.close()
    del atlas
    assert objects["name"].tolist() == objects["side"].tolist() == ["left", "right"]
    assert objects["depth"].tolist() == [1, 1] and objects.objects.tolist() == [1, 2]
    assert notes["kind"].tolist() == ["labels"] and notes["text"].tolist() == ["the program"]
