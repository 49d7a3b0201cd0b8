# SPDX-License-Identifier: BSD-3-Clause
"""Candidates of plans: needles from entries to targets."""
from __future__ import annotations

import contextlib
import os
from typing import TYPE_CHECKING, Any, Callable, ContextManager, Iterator, Optional

import numpy as np

from ._answers import Array
from ._conus import ffi, lib
from ._library import ArgumentError, check, flag, numbers, owned, path_of, real, shown, text, utf8, vector
from ._pose_file import Poses

if TYPE_CHECKING:
    from ._atlas import Selector

_KINDS = ("centroid", "deepest", "voxels")


def _with_keys(name: str, given: Any, allowed: tuple[str, ...]) -> tuple[Any, dict[str, Any]]:
    """What is given, and the keys beside it: ("scalp.surf.gii", {"spacing": 3})."""
    main, keys = given if isinstance(given, tuple) and len(given) == 2 and isinstance(given[1], dict) else (given, {})
    for key in keys:
        if key not in allowed:
            raise ArgumentError(f"{name}: there is no key {shown(key)}, allowed are {', '.join(allowed)}")
    return main, keys


def _points(selector: Selector, name: str, given: Any) -> Any:
    """Sites of the positions of poses, in the world, or of an array, in the selector's space."""
    if isinstance(given, Poses):
        given.match(selector.atlas)
    points = given.origins if isinstance(given, Poses) else numbers(name, given)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ArgumentError(f"{name}: an array of shape {points.shape}, wanted is (n, 3)")
    if selector.space and not isinstance(given, Poses):
        points = selector.space.to_world(name, points)
    points, out = np.ascontiguousarray(points), ffi.new("conus_sites **")
    check(lib.conus_sites_create(out, ffi.from_buffer("double[]", points), len(points)))
    return owned(out[0], lib.conus_sites_destroy)


def _mask(path: Any) -> Any:
    out = ffi.new("conus_roi **")
    check(lib.conus_roi_load(out, path, ffi.NULL))
    return owned(out[0], lib.conus_roi_destroy)


def _is_file(given: Any) -> bool:
    return isinstance(given, (str, os.PathLike))


def _thin_out(name: str, sites: Any, keys: dict[str, Any]) -> Any:
    if "spacing" in keys:
        check(lib.conus_sites_space(sites, real(f"{name}: spacing", keys["spacing"])))
    if not lib.conus_sites_count(sites):
        raise ArgumentError(f"{name}: no candidate: there is no point")
    return sites


def _entries(selector: Selector, given: Any) -> Any:
    main, keys = _with_keys("entries", given, ("spacing", "within", "without", "flip"))
    flip, out = flag("entries: flip", keys.get("flip", False)), ffi.new("conus_sites **")
    if _is_file(main):
        path = path_of("entries", main)
        is_surface = lib.conus_context_is_surface(path)
        check(lib.conus_sites_load(out, path, flip) if is_surface else lib.conus_sites_of_roi(out, _mask(path)))
        sites = owned(out[0], lib.conus_sites_destroy)
    else:
        sites, is_surface = _points(selector, "entries", main), False
    if flip and not is_surface:
        raise ArgumentError("entries: flip is for surfaces, since only they have normals")
    for key in ("within", "without"):
        what = keys.get(key)
        if what is not None and lib.conus_path_is_vertex_labels(path_of(key, what)):
            check(lib.conus_sites_keep_labelled(sites, path_of(key, what), key == "within"))
        elif what is not None and lib.conus_atlas_is_path(path_of(key, what)):
            lib.conus_sites_keep_roi(sites, _mask(path_of(key, what)), key == "within")
        elif what is not None:
            selector._call(lib.conus_sites_keep_named, sites, selector._p, utf8(key, what), key == "within")
    return _thin_out("entries", sites, keys)


def _targets(selector: Selector, given: Any, reached: Any) -> Any:
    """NULL of "normal"; ``reached`` are the names of the first reach, NULL = there is none."""
    main, keys = _with_keys("targets", given, ("spacing", "of"))
    if isinstance(main, str) and main in _KINDS:
        names, out = utf8("targets: of", keys["of"]) if "of" in keys else reached, ffi.new("conus_sites **")
        if names == ffi.NULL:
            raise ArgumentError(f"targets: {main} of which structure? reach, or the key of")
        selector._call(lib.conus_sites_find, out, selector._p, names, _KINDS.index(main))
        return _thin_out("targets", owned(out[0], lib.conus_sites_destroy), keys)
    if isinstance(main, str) and main == "normal" and not keys:
        return ffi.NULL
    if _is_file(main) or "of" in keys:
        raise ArgumentError(f"targets: {shown(main)}, wanted are {', '.join(_KINDS)}, normal, Poses or an array (n, 3)")
    return _thin_out("targets", _points(selector, "targets", main), keys)


def depth_of(depth: Any) -> tuple[Optional[float], Optional[float]]:
    """mm from the entry, or mm behind the target: "target+3"."""
    if not isinstance(depth, str):
        return (None if depth is None else real("depth", depth)), None
    beyond = depth[len("target"):] or "+0"
    try:
        if depth.startswith("target") and beyond[0] in "+-":
            return None, float(beyond)
    except ValueError:
        pass
    raise ArgumentError(f"depth: {shown(depth)}, wanted is a number or target[+MM]")


def candidates_of(selector: Selector, entries: Any, targets: Any, tilt: Any, roll: Any, beyond: Optional[float],
                  reached: Any, sources: Optional[dict[str, Array]]) -> Callable[[], ContextManager[Any]]:
    """Opens a conus_pose_stream of all needles from the entries to the targets, each time that it is called.

    ``sources`` gets the numbers of both.
    """
    places = _entries(selector, entries), _targets(selector, targets, reached)
    if sources is not None:
        for of, sites in zip(("entries", "targets"), places):
            count = lib.conus_sites_count(sites)
            sources[of] = np.array([lib.conus_sites_source(sites, i) for i in range(count)], np.uint64)
    asked = ffi.new("conus_candidates *")
    asked.entries, asked.normals = lib.conus_sites_points(places[0]), lib.conus_sites_normals(places[0])
    asked.entry_count = lib.conus_sites_count(places[0])
    if places[1]:
        asked.targets, asked.target_count = lib.conus_sites_points(places[1]), lib.conus_sites_count(places[1])
    if tilt is not None:
        asked.tilt_most, asked.tilt_step = vector("tilt", tilt, 2)
    asked.roll_step = 0 if roll is None else real("roll", roll)
    asked.to_target, asked.beyond = beyond is not None, beyond or 0
    asked.frame = selector.space._frame if selector.space else ffi.NULL

    @contextlib.contextmanager
    def stream() -> Iterator[Any]:
        out = ffi.new("conus_pose_stream **")
        check(lib.conus_candidates_open(out, asked))
        yield owned(out[0], lib.conus_pose_stream_destroy, *places)

    return stream
