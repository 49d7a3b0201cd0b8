# SPDX-License-Identifier: BSD-3-Clause
"""Tractograms: streamlines for an atlas, and what it tells of them."""
from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from ._answers import Array
from ._conus import ffi, lib
from ._library import ArgumentError, affine_of, check, choice, flag, numbers, path_of, real, shown, text, unmasked, utf8
from ._table import ask_table


def is_tractogram(path: Any) -> bool:
    """Whether a file, or a folder, begins like a tractogram that :func:`load` takes as ``streamlines``."""
    return bool(lib.conus_path_is_tractogram(path_of("path", path)))


class Tractogram(NamedTuple):
    """Streamlines of an atlas, from one file or from memory."""

    path: str  #: as opened, or what stands for it
    format: str  #: "TrackVis 2", "array"
    sha256: str  #: of the file; "" of a folder and of memory
    streamlines: int
    points: int  #: of all streamlines together
    length_mm: float  #: of all streamlines, added up
    radius: float  #: mm; a ray hits what is nearer than this to a streamline
    box: Array  #: (2, 3): lowest and highest x, y, z of the points, RAS mm; NaN without a point
    half: bool  #: the points have half precision
    bundles: tuple[str, ...]  #: names of the objects that are its streamlines
    scalars: tuple[str, ...]  #: names of the numbers that points or streamlines have


def moves(given: Any) -> bool:
    """Whether an entry of ``streamlines`` is moved with the atlas."""
    return isinstance(given, Mapping) and flag("streamlines: moves", given.get("moves", False))


SPACES = ("as-stated", "ras", "lps")


def _settings(given: Any) -> tuple[Any, float, Any, int]:
    """Source, radius, name and space of an entry of ``streamlines``."""
    if not isinstance(given, Mapping):
        return given, 0, None, 0
    keys = dict(given)
    keys.pop("moves", None)
    source, radius, name = keys.pop("source", None), keys.pop("radius", 0), keys.pop("name", None)
    space = choice("streamlines: space", keys.pop("space", SPACES[0]), SPACES)
    if keys or source is None:
        wanted = "wanted are source, and perhaps radius, name, space and moves"
        raise ArgumentError(f"streamlines: {sorted(given)}, {wanted}")
    return source, real("streamlines: radius", radius), name, space


def _of_nibabel(tractogram: Any) -> tuple[Array, list[int], list[tuple[str, bool, Any]]]:
    """Points, lengths and scalars of a nibabel tractogram."""
    streamlines, affine = tractogram.streamlines, tractogram.affine_to_rasmm
    if not hasattr(streamlines, "get_data"):
        raise ArgumentError("streamlines: a lazy tractogram of nibabel, wanted is one that is in memory")
    if affine is None:
        raise ArgumentError("streamlines: the tractogram's affine_to_rasmm is None: where it lies is not known")
    lengths = [len(points) for points in streamlines]
    points = numbers("streamlines", streamlines.get_data()).reshape(-1, 3)
    affine = affine_of("streamlines: affine_to_rasmm", affine)
    if not np.array_equal(affine, np.eye(4)):
        points = points @ affine[:3, :3].T + affine[:3, 3]
    scalars = [(name, True, data.get_data()) for name, data in tractogram.data_per_point.items()]
    return points, lengths, scalars + [(name, False, data) for name, data in tractogram.data_per_streamline.items()]


def _of_arrays(source: Any) -> tuple[Array, list[int], list[tuple[str, bool, Any]]]:
    """Points and lengths of arrays, each a streamline."""
    try:
        arrays = [numbers("streamlines", points) for points in unmasked("streamlines", source)]
    except TypeError:
        wanted = "wanted are paths, tractograms of nibabel or lists of arrays"
        raise ArgumentError(f"streamlines: {shown(source)}, {wanted}") from None
    for number, points in enumerate(arrays):
        if points.ndim != 2 or points.shape[1] != 3:
            raise ArgumentError(f"streamlines: number {number} (from 0) has the shape {points.shape}, wanted is (n, 3)")
    return np.concatenate([np.empty((0, 3)), *arrays]), [len(points) for points in arrays], []


def _fill_scalar(entry: Any, name: str, per_point: bool, data: Any, count: int) -> list[Any]:
    data = numbers(f"streamlines: {name}", data)
    values = np.ascontiguousarray(data, "f4").reshape(count, -1) if count else np.empty((0, 1), "f4")
    alive = [utf8("streamlines", name), values]
    entry.struct_size, entry.name = ffi.sizeof("conus_tract_scalar"), alive[0]
    entry.per_point, entry.components = per_point, values.shape[1]
    entry.values = ffi.cast("const float *", values.ctypes.data)
    return alive


def polylines_of(source: Any) -> tuple[Any, list[Any]]:
    """A conus_polylines, and what must live as long as it."""
    tractogram = getattr(source, "tractogram", source)
    is_nibabel = hasattr(tractogram, "streamlines")
    points, lengths, scalars = _of_nibabel(tractogram) if is_nibabel else _of_arrays(source)
    points = np.ascontiguousarray(points, "f8")
    first = np.concatenate([[0], np.cumsum(lengths)]).astype("u8")
    polylines, entries = ffi.new("conus_polylines *"), ffi.new("conus_tract_scalar[]", max(len(scalars), 1))
    alive: list[Any] = [points, first, entries, path_of("name", "nibabel tractogram" if is_nibabel else "array")]
    for entry, (name, per_point, data) in zip(entries, scalars):
        alive.append(_fill_scalar(entry, name, per_point, data, len(points) if per_point else len(lengths)))
    polylines.points, polylines.type = ffi.cast("const void *", points.ctypes.data), lib.CONUS_SCALAR_FLOAT64
    polylines.point_count, polylines.streamline_count = len(points), len(lengths)
    polylines.first = ffi.cast("const uint64_t *", first.ctypes.data)
    polylines.scalars, polylines.scalar_count, polylines.name = entries, len(scalars), alive[3]
    return polylines, alive


def options_of(given: Any, max_memory: int) -> tuple[Any, Any, Any]:
    """The source of an entry of ``streamlines``, its conus_streamlines_options, and what must live as long."""
    source, radius, name, space = _settings(given)
    options = ffi.new("conus_streamlines_options *")
    options.space = space
    options.radius, options.max_memory = radius, max_memory
    alive = None if name is None else utf8("streamlines: name", name)
    options.name = ffi.NULL if alive is None else alive
    return source, options, alive


def _scalar_names(atlas: Any, index: int, count: int) -> tuple[str, ...]:
    names = []
    for number in range(count):
        scalar = ffi.new("conus_tract_scalar *")
        check(lib.conus_atlas_tractogram_scalar(scalar, atlas, index, number))
        names.append(text(scalar.name))
    return tuple(names)


def tractograms_of(atlas: Any) -> list[Tractogram]:
    """The tractograms of an atlas."""
    table, out = ask_table(lib.conus_atlas_list, atlas, b"tractograms"), []
    columns = {name: table[name].tolist() for name in table.columns}
    for i, first in enumerate(table.objects.tolist()):
        row = {name: values[i] for name, values in columns.items()}
        bundles = [lib.conus_atlas_object(atlas, first + k).name for k in range(row["bundles"])]
        out.append(Tractogram(
            row["path"] or "", row["format"] or "", row["sha256"] or "", row["streamlines"], row["points"],
            row["length_mm"], row["radius_mm"],
            np.array([[row[f"{end}_{axis}"] for axis in "xyz"] for end in ("low", "high")]), bool(row["half"]),
            tuple(map(text, bundles)), _scalar_names(atlas, i, row["scalars"])))
    return out
