# SPDX-License-Identifier: BSD-3-Clause
"""What arrays may be: no masked element is taken for a number, no other matrix for an affine, and bool is 0 and 1."""
import inspect
import os
import pathlib
import subprocess

import nibabel
import numpy as np
import pytest

import conus
from support import AFFINE, NAMES, plates, same

RIGHT = {"origin": (0, 0, 0), "direction": (1, 0, 0)}
MANY = {"origins": [[0, 0, 0]], "directions": [[1, 0, 0]]}
LINE = np.array([[0.0, 0, 0], [3, 0, 0]])

# Each function that takes numbers, with valid arguments.
CALLS = {
    "load": (lambda atlas: conus.load, {"source": plates(), "affine": AFFINE}),
    "find": (lambda atlas: atlas.find, {"name": 1}),
    "Selector": (lambda atlas: lambda **o: conus.Selector(atlas, **o), {}),
    "select": (lambda atlas: atlas.select, RIGHT),
    "near": (lambda atlas: atlas.near, {"point": (21, 1, 1), "radius": 5}),
    "sweep": (lambda atlas: atlas.sweep, RIGHT),
    "jitter": (lambda atlas: atlas.jitter, {**RIGHT, "mm": 1}),
    "segments": (lambda atlas: atlas.segments, RIGHT),
    "segments_many": (lambda atlas: atlas.segments_many, MANY),
    "select_many": (lambda atlas: atlas.select_many, MANY),
    "track": (lambda atlas: atlas.track, {"times_s": [0], **MANY}),
    "overlap": (lambda atlas: atlas.overlap, {"roi": (plates(), AFFINE)}),
    "clusters": (lambda atlas: atlas.clusters, {"roi": (plates(), AFFINE)}),
    "connectivity": (lambda atlas: bundled().connectivity, {}),
    "endpoints": (lambda atlas: bundled().select(**RIGHT).endpoints, {}),
    "Tracker": (lambda atlas: lambda **o: conus.Tracker(atlas.selector(), **o), {}),
    "step": (lambda atlas: atlas.selector().tracker().step, {"time_s": 0, **RIGHT}),
    "selected": (lambda atlas: stepped(atlas).selected, {}),
}
SIGNATURES = {"Selector": conus.Selector, "Tracker": conus.Tracker}
SHAPES = ((), (1,), (2,), (3,), (1, 3), (4, 4), (1, 4, 4), (40, 30, 30))

# Arguments that are no numbers: paths, names, choices, flags, functions.
WORDS = {
    "labels", "pathways", "context", "hemispheres", "only", "hide", "labels_anyway", "progress", "safe_colours", "palette",
    "template", "sides", "layers", "level", "score", "weight", "prior", "error", "aperture", "sampling", "engine", "space", "name",
}  # fmt: skip


def bundled():
    return conus.load(plates(), AFFINE, streamlines=[[LINE]])


def stepped(atlas):
    tracker = atlas.selector().tracker()
    tracker.step(0, **RIGHT)
    return tracker


def arguments():
    for call, (function, _) in CALLS.items():
        about = SIGNATURES.get(call) or function(conus.load(plates(), AFFINE))
        for name, parameter in inspect.signature(about).parameters.items():
            if parameter.kind != parameter.VAR_KEYWORD and name not in WORDS | {"atlas", "selector"}:
                yield call, name


def refusals(call, given):
    """The messages for all shapes of what ``given`` makes of a masked array."""
    for shape in SHAPES:
        for values in (np.ma.masked_all(shape), np.ma.masked_all(shape, "u1"), [np.ma.masked_all(shape)]):
            with pytest.raises(conus.Error) as caught:
                call(given(values))
            yield str(caught.value)


@pytest.mark.parametrize("call, name", arguments())
def test_no_argument_takes_a_masked_element(atlas, call, name):
    """The others are as they must be; those that exclude it, such as the origin of a pose, are left out."""
    function, right = CALLS[call]
    others = {"pose": ("origin", "direction"), "poses": ("origins", "directions"), "toward": ("direction",)}
    kept = {key: value for key, value in right.items() if key not in others.get(name, ())}
    if name == "bregma":
        kept["space"] = "bregma"
    if name in ("slices", "slice_fraction"):
        kept["sampling"] = "slices"
    wrap = {"streamlines": lambda values: [values], "transforms": lambda values: [values],
            "roi": lambda values: (values, AFFINE)}.get(name, lambda values: values)  # fmt: skip
    said = list(refusals(lambda value: function(atlas)(**{**kept, name: value}), wrap))
    assert any("masked elements" in message and "filled" in message for message in said), said


def test_masked_voxels_are_refused_and_filled_ones_are_background():
    """The mask hides all areas: filled with 0, no area is left."""
    hidden = np.ma.masked_greater(plates(), 0)
    for call in (
        lambda: conus.load(hidden, AFFINE),
        lambda: conus.load(nibabel.Nifti1Image(hidden, AFFINE)),
        lambda: conus.load(plates(), AFFINE, pathways=[nibabel.Nifti1Image(hidden, AFFINE)]),
        lambda: conus.load(plates(), AFFINE, context=nibabel.Nifti1Image(hidden, AFFINE)),
        lambda: conus.load(plates(), AFFINE).overlap(nibabel.Nifti1Image(hidden, AFFINE)),
        lambda: conus.load(plates(), np.ma.masked_equal(AFFINE, 2)),
        lambda: conus.load(plates(), AFFINE, transforms=[np.ma.masked_equal(AFFINE, 2)]),
        lambda: conus.load(plates(), AFFINE, streamlines=[[np.ma.masked_equal(LINE, 3)]]),
        lambda: conus.load(plates(), AFFINE, streamlines=[[list(np.ma.masked_equal(LINE, 3))]]),
    ):
        with pytest.raises(conus.ArgumentError, match=r"masked elements have no value; array\.filled\("):
            call()
    assert len(conus.load(hidden.filled(0), AFFINE)) == 0
    seen = np.ma.masked_equal(plates(), 1).filled(0)  # the left plate is masked
    assert conus.load(seen, AFFINE).select((0, 0, 0), direction=(-1, 0, 0))[0].name == "unassigned"
    shown = np.ma.array(plates(), mask=False)  # hides nothing
    assert conus.load(shown, AFFINE, labels=NAMES).select(**RIGHT)[0].name == "right"


def test_a_masked_pose_is_refused_and_a_filled_one_fails(atlas):
    origins = np.ma.masked_array(np.zeros((2, 3)), [[0, 0, 0], [1, 1, 1]])
    with pytest.raises(conus.ArgumentError, match="origins: masked"):
        atlas.select_many(origins, [[1, 0, 0]] * 2)
    answers = atlas.select_many(origins.filled(np.nan), [[1, 0, 0]] * 2)
    assert list(answers.errors) == [1] and len(answers[0]) == 2


@pytest.mark.parametrize("row", [(0, 0, 1, 1), (0, 0, 0, 2), (2e-6, 0, 0, 1), (0, 0, 0, np.nan)])
def test_an_affine_ends_with_0_0_0_1(atlas, row):
    """Whatever else stands there is a perspective or a scale, which the first three rows alone do not say."""
    bent = np.vstack([AFFINE[:3], row])
    image = nibabel.Nifti1Image(plates(), AFFINE)
    image._affine = bent
    line = nibabel.streamlines.Tractogram([LINE], affine_to_rasmm=np.eye(4))
    line._affine_to_rasmm = bent
    for call in (
        lambda: conus.load(plates(), bent),
        lambda: conus.load(image),
        lambda: conus.load(plates(), AFFINE, pathways=[image]),
        lambda: conus.load(plates(), AFFINE, context=image),
        lambda: conus.load(plates(), AFFINE, transforms=[bent]),
        lambda: conus.load(plates(), AFFINE, streamlines=[line]),
        lambda: atlas.overlap((plates(), bent)),
        lambda: atlas.overlap(image),
    ):
        with pytest.raises(conus.ArgumentError, match="last row is .*wanted is 0 0 0 1"):
            call()
    pose = np.vstack([np.eye(4)[:3], row])
    for call in (lambda: atlas.select(pose=pose), lambda: atlas.selector().tracker().step(0, pose)):
        with pytest.raises(conus.ArgumentError, match="pose matrix"):
            call()
    assert list(atlas.select_many(poses=[pose, np.eye(4)]).errors) == [0]
    assert list(atlas.segments_many(poses=[np.eye(4), pose]).errors) == [1]


def test_the_last_row_of_an_affine_may_be_rounded_to_float(atlas):
    """Half a unit in the last place of 1 in float, which programs that invert in float write, is 0 0 0 1."""
    rounded = np.vstack([AFFINE[:3], np.array([1e-8, 0, 0, 1 - 2.0**-24])])
    loaded = conus.load(plates(), rounded, labels=NAMES)
    assert same(loaded.select(**RIGHT).results, atlas.select(**RIGHT).results)
    assert rounded[3, 3] < 1  # and the given array is unchanged


@pytest.mark.parametrize("space", ["ras", "lps"])
@pytest.mark.parametrize("shape", [(3, 3), (4,), (2, 4, 4), ()])
def test_a_pose_of_another_shape_is_an_error_in_every_space(atlas, space, shape):
    with pytest.raises(conus.ArgumentError):
        atlas.select(pose=np.ones(shape), space=space)
    with pytest.raises(conus.ArgumentError):
        atlas.select_many(poses=np.ones((*shape, 3)), space=space)


def test_bool_is_0_and_1():
    """A mask is the label 1, or a region: the right plate of 10 x 30 x 30 voxels of 8 mm^3 is 72000 mm^3."""
    mask = plates() == 2
    for values in (mask, np.asfortranarray(mask), np.repeat(mask, 2, 2)[:, :, ::2]):
        atlas = conus.load(values, AFFINE, labels={1: "plate"})
        assert list(atlas.info()["index"]) == [1] and list(atlas.info()["volume_mm3"]) == [72000]
        wanted = conus.load(mask.astype("u1"), AFFINE, labels={1: "plate"}).select(**RIGHT)
        assert same(atlas.select(**RIGHT).results, wanted.results) and wanted[0].name == "plate"
    covered = conus.load(plates(), AFFINE, labels=NAMES).overlap((mask, AFFINE)).to_dataframe()
    assert covered["name"][0] == "right" and covered["volume_mm3"][0] == pytest.approx(72000, rel=1e-9)


def test_a_field_of_simnibs_is_a_region(tmp_path, monkeypatch):
    """Two tetrahedra of 36 and 72 mm^3, of the tissues 2 and 1."""
    program = pathlib.Path(os.environ.get("CONUS", "conus")).with_name("conus-hdf5")
    if not program.exists():
        pytest.skip("no conus-hdf5")
    monkeypatch.setenv("CONUS_HDF5", str(program))
    path = tmp_path / "field.hdf5"
    maker = pathlib.Path(__file__).parents[1] / "cli/hdf5.py"
    if subprocess.run(["/usr/bin/python3", maker, "field", path], check=False).returncode:
        pytest.skip("no python3-h5py")
    atlas = conus.load(plates(), AFFINE, labels=NAMES)
    for key, volume in (("", 108), (",tissue=2", 36), (",field=J,tissue=1", 72)):
        covered = atlas.overlap(f"{path}{key}", threshold=0.5).to_dataframe()
        assert covered["volume_mm3"].sum() == pytest.approx(volume, rel=1e-9)
    with pytest.raises(conus.ArgumentError, match="tissue: no tetrahedron"):
        atlas.overlap(f"{path},tissue=7", threshold=0.5)
