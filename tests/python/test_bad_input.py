# SPDX-License-Identifier: BSD-3-Clause
"""Whatever is given, the answer is right or a conus.Error of one line."""
import os
import subprocess
import sys

import nibabel
import numpy as np
import pandas
import pytest

import conus
from support import AAL, AFFINE, NAMES, needs_aal, plates, same

NAN = float("nan")
RIGHT = {"origin": (0, 0, 0), "direction": (1, 0, 0)}
MANY = {"origins": [[0, 0, 0]], "directions": [[1, 0, 0]]}


def image(values):
    return nibabel.Nifti1Image(values, AFFINE)


def table(**columns):
    return pandas.DataFrame(columns)


def assert_is_an_error(call, *kinds):
    with pytest.raises(kinds or conus.ArgumentError) as caught:
        call()
    assert isinstance(caught.value, conus.Error)
    assert str(caught.value) and "\n" not in str(caught.value)


# Atlases

ATLASES = {
    "a flat array": {"source": np.zeros((3, 3))},
    "nothing": {"source": None},
    "texts in lists": {"source": [[["a"]]]},
    "no number": {"source": np.full((3, 3, 3), NAN)},
    "endless": {"source": np.full((3, 3, 3), np.inf)},
    "too large a label": {"source": np.full((3, 3, 3), 2**33, "u8")},
    "too large a float": {"source": np.full((3, 3, 3), 2.0**33)},
    "an affine of texts": {"affine": [["a"] * 4] * 4},
    "labels that are a list": {"labels": ["left"]},
    "labels that are a path": {"labels": "/labels.tsv"},
    "a label below 0": {"labels": {-1: "x"}},
    "a label of 33 bits": {"labels": {2**32: "x"}},
    "a label that is a fraction": {"labels": {1.5: "x"}},
    "a label that is a text": {"labels": {"x": "x"}},
    "a name with a zero byte": {"labels": {1: "a\0b"}},
    "a name that is not Unicode": {"labels": {1: "a\udcff"}},
    "a table without names": {"labels": table(index=[1])},
    "a table without numbers": {"labels": table(name=["x"])},
    "a table with a gap": {"labels": table(index=[1, NAN], name=["x", "y"])},
    "a hemisphere of two letters": {"labels": table(index=[1], name=["x"], hemisphere=["LR"])},
    "a parent below 0": {"labels": table(index=[1], name=["x"], parent=[-1])},
    "a 4-D pathway": {"pathways": [image(np.ones((3, 3, 3, 2), "f4"))]},
    "an empty pathway": {"pathways": [image(np.ones((0, 3, 3), "f4"))]},
    "a pathway of NaN": {"pathways": [image(np.full((3, 3, 3), NAN, "f4"))]},
    "a threshold of NaN": {"pathways": [(image(np.ones((3, 3, 3), "f4")), NAN)]},
    "a threshold of text": {"pathways": [(image(np.ones((3, 3, 3), "f4")), "a")]},
    "a bare array as pathway": {"pathways": [np.ones((3, 3, 3))]},
    "a path as list of pathways": {"pathways": "tract.nii"},
    "no such pathway": {"pathways": ["no such file"]},
    "a 4-D context": {"context": image(np.ones((3, 3, 3, 2), "f4"))},
    "no such context": {"context": "no such file"},
    "blocks of NaN": {"context": image(np.ones((3, 3, 3), "f4")), "context_blocks": NAN},
    "blocks of text": {"context": image(np.ones((3, 3, 3), "f4")), "context_blocks": "a"},
    "labels perhaps": {"labels_anyway": "no"},
    "blocks without a context": {"context_blocks": 0.5},
    "only a number": {"only": 3},
    "only nothing": {"only": ""},
    "hidden bytes": {"hide": b"left"},
    "memory below 0": {"max_memory": -1},
    "half a byte": {"max_memory": 0.5},
    "a path with a zero byte": {"source": "a\0b", "affine": None},
    "a path that is not Unicode": {"source": "a\ud800", "affine": None},
    "a folder": {"source": os.path.dirname(__file__), "affine": None},
    "a table that is a number": {"source": "x.nii", "affine": None, "labels": 3},
}


@pytest.mark.parametrize("case", ATLASES)
def test_bad_atlas_is_an_error(case):
    options = {"source": plates(), "affine": AFFINE, **ATLASES[case]}
    assert_is_an_error(lambda: conus.load(**options), conus.ArgumentError, conus.DataError, conus.FileError)


@needs_aal
def test_file_above_max_memory_is_an_error():
    assert_is_an_error(lambda: conus.load(AAL, max_memory=10), conus.OutOfMemoryError)


def test_max_memory_may_be_above_4_gib(tmp_path):
    """And up to what 64 bits hold, wherever it is given."""
    (tmp_path / "p.tsv").write_text("x\ty\tz\tdx\tdy\tdz\n0\t0\t0\t1\t0\t0\n")
    for size in (2**33, 2**64 - 1):
        atlas = conus.load(plates(), AFFINE, labels=NAMES, max_memory=size)
        assert len(atlas.overlap((plates() > 0, AFFINE), max_memory=size)) >= 2
        assert len(conus.read_poses(tmp_path / "p.tsv", max_memory=size)) == 1


def test_missing_cells_of_a_table_say_nothing():
    labels = table(index=[1.0, 2.0], name=["x", NAN], abbreviation=[None, "b"], hemisphere=[NAN, "R"], parent=[NAN, 1])
    info = conus.load(plates(), AFFINE, labels=labels).info()
    assert list(info["name"]) == ["x", "2"] and list(info["abbreviation"]) == ["", "b"]
    assert list(info["hemisphere"]) == ["", "R"] and list(info["parent"]) == [0, 1]
    series = conus.load(plates(), AFFINE, labels=pandas.Series({1: "x", 2: "Précunéus"})).info()
    assert list(series["name"]) == ["x", "Précunéus"]


def swapped(array):
    """The same values, in the other byte order, not to be written and not in one piece."""
    wide = np.zeros((*array.shape[:-1], 2 * array.shape[-1]), array.dtype.newbyteorder())
    wide[..., ::2] = array
    view = wide[..., ::2]
    view.flags.writeable = False
    return view


def test_pathways_contexts_and_affines_are_taken_in_any_layout():
    values = np.zeros((40, 30, 30), "f4")
    values[15:18] = 0.9
    aim = {"origin": (0, 0, 0), "direction": (-1, 0, 0)}
    wanted = conus.load(plates(), AFFINE, labels=NAMES, pathways=[image(values)]).select(**aim)
    other = conus.load(swapped(plates("i2")), swapped(AFFINE), labels=NAMES, pathways=[image(swapped(values))])
    assert wanted[0].kind == "pathway" and same(other.select(**aim).results, wanted.results)
    walled = conus.load(plates(), AFFINE, context=image(swapped(values)), context_blocks=0.5)
    assert walled.select(**aim)[0].name == "unassigned"


def test_paths_of_every_file_have_bytes(tmp_path):
    folder = os.fsencode(tmp_path) + b"/\xff\xfe b"
    os.mkdir(folder)
    for name, values in (("atlas", plates()), ("tract", plates("f4") / 2)):
        nibabel.save(image(values), tmp_path / f"{name}.nii")
        os.rename(tmp_path / f"{name}.nii", folder + f"/{name}.nii".encode())
    with open(folder + b"/table.tsv", "w", encoding="utf-8") as file:
        file.write("index\tname\n1\tlinks\n2\trechts\n")
    atlas, tract, names = folder + b"/atlas.nii", folder + b"/tract.nii", folder + b"/table.tsv"
    loaded = conus.load(os.fsdecode(atlas), labels=names, pathways=[tract, (os.fsdecode(tract), 0.75)], context=tract)
    assert list(loaded.info()["name"])[:2] == ["links", "rechts"] and len(loaded) == 4


# Poses

ASKED = {
    "select": lambda atlas, **o: atlas.select(**{**RIGHT, **o}),
    "sweep": lambda atlas, **o: atlas.sweep(**{**RIGHT, **o}),
    "jitter": lambda atlas, **o: atlas.jitter(**{**RIGHT, "degrees": 1, **o}),
    "step": lambda atlas, **o: atlas.selector().tracker().step(0, **{**RIGHT, **o}),
}
AIMS = {
    "origin of NaN": {"origin": (NAN, 0, 0)},
    "endless origin": {"origin": (0, -np.inf, 0)},
    "origin of None": {"origin": (None, 0, 0)},
    "origin of texts": {"origin": "abc"},
    "ragged origin": {"origin": (0, (0, 0), 0)},
    "no direction": {"direction": (0, 0, 0)},
    "direction of NaN": {"direction": (NAN, 0, 0)},
    "up of NaN": {"up": (0, NAN, 0)},
    "up along the direction": {"up": (1, 0, 0)},
    "matrix of NaN": {"origin": None, "direction": None, "pose": np.full((4, 4), NAN)},
    "mirror": {"origin": None, "direction": None, "pose": np.diag([-1, 1, 1, 1])},
    "matrix of texts": {"origin": None, "direction": None, "pose": [["a"] * 4] * 4},
    "matrix with up": {"origin": None, "direction": None, "pose": np.eye(4), "up": (0, 0, 1)},
    "angle of NaN": {"angle": NAN},
    "angle of 0": {"angle": 0},
    "angle below 0": {"angle": -10},
    "angle of 180": {"angle": 180},
    "angle of texts": {"angle": "ten"},
    "angle of None in an array": {"angle": [None]},
    "complex angle": {"angle": 10 + 0j},
    "complex origin": {"origin": (0, 0, 1j)},
    "complex matrix": {"origin": None, "direction": None, "pose": np.eye(4) + 0j},
}


@pytest.mark.parametrize("asked", ASKED)
@pytest.mark.parametrize("case", AIMS)
def test_bad_pose_is_an_error(atlas, asked, case):
    assert_is_an_error(lambda: ASKED[asked](atlas, **AIMS[case]))


@pytest.mark.parametrize(
    "options",
    [
        {"resolution": -1},
        {"resolution": 1.5},
        {"resolution": 2**40},
        {"slices": -1, "sampling": "slices"},
        {"slices": 5},
        {"slice_fraction": 0.5},
        {"slice_fraction": 1.5, "sampling": "slices"},
        {"slice_fraction": -0.1, "sampling": "slices"},
        {"slice_fraction": NAN, "sampling": "slices"},
        {"slice_fraction": "a", "sampling": "slices"},
        {"range": (1,)},
        {"range": (1, 2, 3)},
        {"range": (NAN, 2)},
        {"range": (5, 2)},
        {"range": 3},
        {"radius": -1},
        {"radius": NAN},
        {"radius": "a"},
        {"radius": 3j},
        {"range": "ab"},
        {"radius": 3, "angle": 10},
        {"score": "share\0"},
        {"score": 3},
        {"score": "unoccluded"},
        {"level": "Lobe"},
        {"level": "\udcff"},
        {"engine": "vulkan"},
        {"aperture": None},
        {"layers": np.eye(3)},
        {"resolution": np.eye(3)},
        {"score": np.eye(3)},
    ],
)
def test_bad_option_is_an_error(atlas, options):
    assert_is_an_error(lambda: atlas.select(**RIGHT, **options))


@pytest.mark.parametrize("call", [
    lambda atlas: atlas.select((10**400, 0, 0), direction=(1, 0, 0)),
    lambda atlas: atlas.select(**RIGHT, angle=10**400),
    lambda atlas: atlas.select(**RIGHT, resolution=10**5000),
    lambda atlas: atlas.select(**RIGHT, level=10**5000),
    lambda atlas: atlas.select_many(**MANY, angle=[10**400]),
    lambda atlas: atlas.find(10**5000),
    lambda atlas: conus.load(plates(), [[10**400, 0, 0, 0]] * 4),
    lambda atlas: conus.load(plates(), AFFINE, labels={1: 10**5000}),
    lambda atlas: conus.load(plates(), AFFINE, max_memory=10**5000),
])
def test_numbers_beyond_all_types_are_an_error(atlas, call):
    assert_is_an_error(lambda: call(atlas))


def test_a_range_is_any_sequence_to_its_last_digit(atlas):
    """The plate begins at 20 mm: a range to just before it is empty, and is another one than to just behind it."""
    for kind in (tuple, list, np.array):
        for far, name in ((20 - 1e-12, "unassigned"), (20 + 1e-12, "right")):
            hits = atlas.select((0, 0, 0), direction=(1, 0, 0), radius=1, range=kind([0, far]))
            assert hits[0].name == name


@pytest.mark.parametrize("point, radius", [((NAN, 0, 0), 5), ((0, 0), 5), ((0, 0, 0), "a"), ((0, 0, 0), 5j), ("abc", 5), ((0, 0, 0), NAN), ((0, 0, 0), -1)])
def test_bad_ball_is_an_error(atlas, point, radius):
    assert_is_an_error(lambda: atlas.near(point, radius))


def test_near_without_a_radius_reaches_the_nearest(atlas):
    """The plate begins at 20 mm: seen from 0 it is 20 mm away, and nothing is at 0."""
    near = atlas.near((0, 0, 0))
    assert min(hit.distance_mm for hit in near if hit.kind == "area") == 20


@pytest.mark.parametrize(
    "errors",
    [{"degrees": NAN}, {"degrees": -1}, {"degrees": 91}, {"mm": -1}, {"mm": np.inf}, {"samples": 17}, {"samples": -1}, {"degrees": "a"}, {"mm": [1]}],
)
def test_bad_errors_of_the_pose_are_an_error(atlas, errors):
    assert_is_an_error(lambda: atlas.jitter(**RIGHT, **errors))


@pytest.mark.parametrize(
    "arrays",
    [
        {"origins": [["a", "b", "c"]]},
        {"origins": [[0, 0, 0], [0, 0]]},
        {"angle": NAN},
        {"angle": 0},
        {"angle": -1},
        {"angle": 180},
        {"angle": [[10]]},
        {"angle": ["a"]},
        {"angle": "a"},
        {"origins": [[0j, 0, 0]]},
        {"threads": -1},
        {"threads": 1.5},
        {"origins": None, "directions": None, "poses": np.eye(4)[None], "up": [[0, 0, 1]]},
        {"radius": 2, "angle": 10},
    ],
)
def test_bad_arrays_are_an_error(atlas, arrays):
    assert_is_an_error(lambda: atlas.select_many(**{**MANY, **arrays}))
    if "threads" not in arrays:
        assert_is_an_error(lambda: atlas.track([0], **{**MANY, **arrays}))


def test_every_pose_at_fault_has_its_reason(atlas):
    poses = np.stack([np.full((4, 4), NAN), np.diag([-1, 1, 1, 1]), np.eye(4)])
    answers = atlas.select_many(poses=poses, angle=[5, 5, NAN])
    assert list(answers.errors) == [0, 1, 2]
    assert all(why in answers.errors[i] for i, why in enumerate(("nan in row 1", "left-handed", "angle: nan")))


def test_arrays_of_poses_are_taken_in_any_layout(atlas):
    random = np.random.default_rng(3)
    origins, directions = random.normal(size=(2, 50, 3)) * 5
    directions += [20, 0, 0]
    wanted = atlas.select_many(origins, directions).results
    for layout in (swapped, np.asfortranarray, np.ndarray.tolist):
        assert same(atlas.select_many(layout(origins), layout(directions)).results, wanted)
    still = np.broadcast_to(np.array([0.0, 0, 0]), (50, 3))  # one row in memory, not to be written
    assert len(atlas.select_many(still, np.broadcast_to([1.0, 0, 0], (50, 3)))) == 50


# Names, hits and channels


def test_bad_name_is_an_error(atlas):
    hits = atlas.select(**RIGHT)
    for name in ("riht", "", None, "a\0", "\udcff", 3, b"right"):
        assert_is_an_error(lambda name=name: atlas.find(name))
    assert atlas.find("right") == atlas.find(2) == atlas.find("2") == 2
    for mask in ({"of": "voxels"}, {"name": "riht"}, {"of": "values"}):
        assert_is_an_error(lambda mask=mask: hits.mask(**mask))


def test_a_ball_has_no_picture(atlas):
    near = atlas.near((21, 1, 1), 5)
    assert_is_an_error(near.image)
    assert_is_an_error(near._repr_png_)


def test_hits_are_a_sequence(atlas):
    hits = atlas.select(**RIGHT)
    assert hits[-1].name == "unassigned"
    assert [hit.name for hit in hits[:1]] == ["right"] == [hit.name for hit in hits[-2:-1]]
    assert hits[5:] == [] and len(list(hits)) == len(hits) == 2
    for index in (2, -3):
        with pytest.raises(IndexError):
            hits[index]  # pylint: disable=pointless-statement
    with pytest.raises(IndexError):
        atlas.select_many(**MANY)[1]  # pylint: disable=expression-not-assigned


# Closed atlases, and exceptions


def test_nothing_asks_a_closed_atlas(atlas):
    selector, hits = atlas.selector(), atlas.select(**RIGHT)
    many = atlas.select_many(**MANY)
    atlas.close()
    for ask in (
        lambda: atlas.select(**RIGHT), lambda: atlas.near((0, 0, 0), 5), lambda: atlas.sweep(**RIGHT),
        lambda: atlas.jitter(**RIGHT, mm=1), lambda: atlas.select_many(**MANY), lambda: atlas.track([0], **MANY),
        atlas.selector, atlas.renderer, atlas.render, atlas.info, lambda: atlas.notes, lambda: atlas.find("left"),
        lambda: selector.select(**RIGHT), lambda: selector.near((0, 0, 0), 5), lambda: selector.sweep(**RIGHT),
        lambda: selector.jitter(**RIGHT, mm=1), lambda: selector.select_many(**MANY), selector.tracker,
        lambda: hits.mask(name="right"),
    ):  # fmt: skip
        with pytest.raises(conus.ArgumentError, match="closed"):
            ask()
    assert hits[0].name == "right" and hits.mask().get_fdata().any() and hits.to_dataframe()["name"][0] == "right"
    assert many.to_dataframe()["name"][0] == "right"
    atlas.close()  # again


@pytest.mark.parametrize("error", [ZeroDivisionError, KeyboardInterrupt, SystemExit, conus.DataError])
def test_exception_of_a_callback_comes_out_as_it_is(atlas, tmp_path, error):
    nibabel.save(image(plates()), tmp_path / "atlas.nii")

    def stop(*_):
        raise error("stopped")

    for call in (
        lambda: conus.load(tmp_path / "atlas.nii", progress=stop),
        lambda: atlas.select_many(**MANY, progress=stop),
        lambda: atlas.track([0], **MANY, progress=stop),
    ):
        with pytest.raises(error, match="stopped"):
            call()
    assert atlas.select(**RIGHT)[0].name == "right"


def test_a_callback_that_asks_the_selector_it_is_called_by_does_not_hang(atlas):
    """Another selector may be asked; asking this one, which waits for the callback, is an error."""
    names = []
    atlas.select_many(**MANY, progress=lambda *_: names.append(atlas.select(**RIGHT, resolution=8)[0].name))
    assert names == ["right"]
    with pytest.raises(conus.ArgumentError, match="callback"):
        atlas.select_many(**MANY, progress=lambda *_: atlas.select(**RIGHT))


def test_threads_end_with_the_interpreter():
    """An atlas, its selectors and answers that are still there at the end do not spoil it."""
    script = """
import conus, numpy
atlas = conus.load(numpy.ones((9, 9, 9), "u1"), numpy.eye(4))
tracker = atlas.selector().tracker()
hits = tracker.step(0, origin=(4, 4, 50), toward=(4, 4, 4))
answers = atlas.select_many(numpy.tile([4.0, 4, 50], (999, 1)), numpy.tile([0.0, 0, -1], (999, 1)))
"""
    done = subprocess.run([sys.executable, "-c", script], check=False, capture_output=True)
    assert (done.returncode, done.stderr) == (0, b"")
