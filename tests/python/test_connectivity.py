# SPDX-License-Identifier: BSD-3-Clause
"""Which areas streamlines connect: of plates in closed form, and in AAL against numpy and nibabel."""
import nibabel
import numpy as np
import pandas
import pytest

import conus
from conus._conus import ffi, lib
from support import AAL, AFFINE, NAMES, needs_aal, plates


def with_lines(atlas, lines, name="lines"):
    """The atlas with streamlines as a bundle. It is not copied."""
    points = np.ascontiguousarray(np.concatenate([np.asarray(line, "f4").reshape(-1, 3) for line in lines]))
    first = np.concatenate([[0], np.cumsum([len(line) for line in lines])]).astype("u8")
    polylines = ffi.new("conus_polylines *")
    text = ffi.new("char[]", name.encode())
    polylines.points = ffi.cast("void *", points.ctypes.data)
    polylines.type = lib.CONUS_SCALAR_FLOAT32
    polylines.point_count, polylines.streamline_count = len(points), len(lines)
    polylines.first = ffi.cast("uint64_t *", first.ctypes.data)
    polylines.name = text
    assert lib.conus_atlas_add_polylines(atlas._p, polylines, ffi.NULL) == 0
    return conus.Atlas(atlas._p)


@pytest.fixture
def lined():
    """Plates from x = -40 to -20 and 20 to 40: three lines from one to the other, of 60, 60 and 90 mm, one that ends
    5 mm before the right one, and one within the left."""
    atlas = conus.load(plates(), AFFINE, labels=NAMES)
    return with_lines(atlas, [
        [(-30, 0, 0), (30, 0, 0)],
        [(30, 1, 0), (-30, 1, 0)],
        [(-30, 0, 0), (-30, 15, 0), (30, 15, 0), (30, 0, 0)],
        [(-30, 0, 0), (15, 0, 0)],
        [(-30, 0, 0), (-25, 0, 0)],
    ])


def test_connections_of_plates(lined):
    frame = lined.connectivity().to_dataframe()
    left, right = NAMES[1], NAMES[2]
    assert [tuple(row) for row in frame[["end_a", "end_b", "streamlines", "fraction", "mean_length_mm"]].values] == [
        (left, right, 3, 0.6, 70), (left, left, 1, 0.2, 5), (left, "unassigned", 1, 0.2, 45)]
    assert list(frame["bundle"]) == 3 * ["lines"] and frame["end_b_index"].isna().tolist() == [False, False, True]
    near = lined.connectivity(radius=5)
    assert near["streamlines"].tolist() == [4, 1] and len(near) == 2
    assert near.part("areas").objects.tolist() == [1, 2, 0] and near.part("areas")["name"].tolist() == [left, right, "unassigned"]
    assert near.matrix().values.tolist() == [[1, 4, 0], [4, 0, 0], [0, 0, 0]]
    lengths = near.matrix("mean_length_mm").values
    assert lengths[0, :2].tolist() == [5, 255 / 4] and np.isnan(lengths[1, 1])
    assert near.matrix().loc[left, right] == 4


def test_parts_stay_when_the_table_is_gone(lined):
    pairs = lined.connectivity(radius=5).part("pairs")
    streamlines = pairs["streamlines"]
    assert pairs.columns == ("end_a", "end_b", "streamlines", "fraction", "mean_length_mm", "area_a", "area_b")
    assert pairs.to_dataframe()["end_b"].tolist() == [NAMES[2], NAMES[1]] and pairs.objects.tolist() == [0, 0]
    del pairs
    assert streamlines.tolist() == [4, 1]
    with pytest.raises(KeyError):
        lined.connectivity().part("pair")
    with pytest.raises(conus.ArgumentError, match="allowed is streamlines, mean_length_mm"):
        lined.connectivity().matrix("fraction")


def test_only_streamlines_in_the_cone(lined):
    """A ball round (0, 15, 0) has the detour alone; a cone from above, 12 mm wide at z = 0, all but it and the last."""
    assert lined.near((0, 15, 0), 3).endpoints()["streamlines"].tolist() == [1]
    cone = lined.select((0, 0, 60), toward=(0, 0, 0), angle=10)
    assert cone.endpoints()["streamlines"].tolist() == [2, 1]
    assert cone.endpoints(radius=5)["streamlines"].tolist() == [3]
    assert len(lined.near((0, -19, 0), 1).endpoints()) == 0
    for radius in (-1, 101, np.nan, "1 mm"):
        with pytest.raises((conus.ArgumentError, TypeError)):
            lined.connectivity(radius)


def test_the_matrix_has_the_areas_of_a_list_in_its_order(tmp_path):
    lines = tmp_path / "lines.tck"
    points = [np.array(line, "f4") for line in ([(-30, 0, 0), (30, 0, 0)], [(-30, 1, 0), (-25, 0, 0)])]
    nibabel.streamlines.save(nibabel.streamlines.Tractogram(points, affine_to_rasmm=np.eye(4)), str(lines))
    left, right = NAMES[1], NAMES[2]

    def load(only):
        return conus.load(plates(), AFFINE, labels=NAMES, streamlines=[str(lines)], only=only)

    matrix = load(f"{right},{left},lines").connectivity().matrix()
    assert list(matrix.index) == list(matrix.columns) == [right, left, "unassigned"]
    assert matrix.values.tolist() == [[0, 1, 0], [1, 1, 0], [0, 0, 0]]
    alone = load(f"{left},lines").connectivity().matrix()
    assert alone.values.tolist() == [[1, 1], [1, 0]] and list(alone.index) == [left, "unassigned"]
    with pytest.raises(conus.ArgumentError, match="all streamlines are hidden"):
        load(right).connectivity()


def test_without_bundles_it_is_refused():
    atlas = conus.load(plates(), AFFINE, labels=NAMES)
    selection = atlas.near((0, 0, 0), 5)
    for ask in (atlas.connectivity, selection.endpoints):
        with pytest.raises(conus.ArgumentError, match="there are no streamlines"):
            ask()


def nearest_label(labels, voxel_from_world, spacing, point, radius):
    """By a search of all cells around a point, on a grid along the axes."""
    at = voxel_from_world[:3, :3] @ point + voxel_from_world[:3, 3]
    reach = np.ceil(radius / spacing).astype(int) + 1
    low = np.maximum(np.floor(at + 0.5).astype(int) - reach, 0)
    high = np.minimum(np.floor(at + 0.5).astype(int) + reach + 1, labels.shape)
    if (low >= high).any():
        return 0
    window = labels[low[0]:high[0], low[1]:high[1], low[2]:high[2]]
    index = np.argwhere(window)
    gap = np.maximum(np.abs(index + low - at) - 0.5, 0) * spacing
    distance = np.sqrt((gap**2).sum(1))
    found = window[tuple(index.T)]
    order = np.lexsort((found, distance.round(9)))
    return found[order[0]] if len(order) and distance[order[0]] <= radius else 0


@needs_aal
@pytest.mark.parametrize("radius", [0, 2, 3.7])
def test_random_streamlines_in_aal_as_in_numpy(radius):
    image = nibabel.load(AAL)
    labels = np.asarray(image.dataobj).astype(int)
    voxel_from_world = np.linalg.inv(image.affine)
    spacing = np.abs(np.diag(image.affine)[:3])
    assert np.count_nonzero(image.affine[:3, :3]) == 3
    random = np.random.default_rng(20)
    low, high = nibabel.affines.apply_affine(image.affine, [[0, 0, 0], np.array(labels.shape) - 1])
    lines = [random.uniform(low + 20, high - 20, (2, 3)).astype("f4") for _ in range(600)]
    pairs = {}
    for line in lines:
        ends = [nearest_label(labels, voxel_from_world, spacing, end.astype("f8"), radius) for end in line]
        key = tuple(sorted(ends, key=lambda label: label or 1 << 30))
        pairs.setdefault(key, []).append(np.linalg.norm(np.diff(line.astype("f8"), axis=0)))
    frame = with_lines(conus.load(AAL), lines).connectivity(radius).to_dataframe()
    frame[["end_a_index", "end_b_index"]] = frame[["end_a_index", "end_b_index"]].fillna(0)
    found = {(a, b): (n, length) for a, b, n, length in
             frame[["end_a_index", "end_b_index", "streamlines", "mean_length_mm"]].itertuples(index=False)}
    assert {key: len(lengths) for key, lengths in pairs.items()} == {key: n for key, (n, _) in found.items()}
    assert sum(n for n, _ in found.values()) == len(lines)
    for key, lengths in pairs.items():
        assert found[key][1] == pytest.approx(np.mean(lengths), rel=1e-12)
    assert isinstance(frame, pandas.DataFrame) and len(frame) > 150
