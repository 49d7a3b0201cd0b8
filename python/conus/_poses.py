# SPDX-License-Identifier: BSD-3-Clause
"""Poses as the library takes them, and what looks wrong about them."""
from __future__ import annotations

import os
import sys
import warnings
from typing import Any, Optional

import numpy as np

from ._answers import Array
from ._conus import ffi, lib
from ._library import ArgumentError, PoseWarning, check, numbers, owned, shown, text, unmasked, vector
from ._pose_file import Poses


def pose_of(origin: Any, toward: Any, direction: Any, up: Any, pose: Any, frame: Any = ffi.NULL) -> Any:
    """A conus_pose of what `select` is given, turned as in the conus_frame."""
    out = ffi.new("conus_pose *")
    if pose is not None:
        matrix = numbers("pose", pose)
        if matrix.shape != (4, 4) or any(other is not None for other in (origin, toward, direction, up)):
            raise ArgumentError("pose: a matrix of shape (4, 4), without origin, toward, direction and up")
        values = ffi.new("double[16]", matrix.T.ravel().tolist())
        check(lib.conus_pose_array_at(out, ffi.new("conus_pose_array *", {"matrix": values, "frame": frame}), 0))
        return out
    if origin is None or (toward is None) == (direction is None):
        raise ArgumentError("pose: needs origin and either toward or direction")
    above = ffi.NULL if up is None else vector("up", up)
    if toward is not None:
        check(lib.conus_pose_toward(out, vector("origin", origin), vector("toward", toward), above))
    else:
        check(lib.conus_pose_along(out, vector("origin", origin), vector("direction", direction), above))
    if frame:
        lib.conus_frame_turn_pose(out, frame, up is not None)
    return out


def rows_of(name: str, values: Any, shape: tuple[int, ...]) -> Array:
    """(n, *shape) numbers, one after the other in memory."""
    array = np.ascontiguousarray(numbers(name, values))
    if array.ndim != 1 + len(shape) or array.shape[1:] != shape:
        raise ArgumentError(f"{name}: an array of shape {array.shape}, wanted is {('n', *shape)}".replace("'", ""))
    return array


class PoseArray:
    """Many poses: ``struct`` is a conus_pose_array, which lives no longer than this."""

    def __init__(self, origins: Any, directions: Any, poses: Any, up: Any, angle: Any, near: Any, far: Any,
                 frame: Any) -> None:
        self.struct, self.frame = ffi.new("conus_pose_array *", {"frame": frame}), frame
        self._alive: list[Array] = []
        self.names: Optional[dict[str, Array]] = None  #: of each pose; None = numbers
        self.reasons: dict[int, str] = {}  #: why a pose of a file is none
        if isinstance(poses, Poses):
            self.names, self.reasons = poses._marks(), poses.errors
            if np.ndim(unmasked("angle", angle)) == 0 and not np.isnan(poses.angles).all():
                angle = np.nan_to_num(poses.angles)  # 0 = the default
            if near is None and far is None and not np.isnan(poses.ranges).all():
                near, far = poses.ranges.T
            poses = poses.matrices
        if isinstance(poses, (str, bytes, os.PathLike)):
            raise ArgumentError(f"poses: a path, wanted are matrices or what conus.read_poses({shown(poses)}) gives")
        if poses is not None:
            if any(other is not None for other in (origins, directions, up)):
                raise ArgumentError("poses: either matrices, or both origins and directions")
            matrices = rows_of("poses", poses, (4, 4))
            self._add("matrix", np.ascontiguousarray(matrices.transpose(0, 2, 1)))
        elif origins is None or directions is None:
            raise ArgumentError("poses: either matrices, or both origins and directions")
        else:
            self._add("origin", rows_of("origins", origins, (3,)))
            self._add("direction", rows_of("directions", directions, (3,)))
            if up is not None:
                self._add("up", rows_of("up", up, (3,)))
        if np.ndim(unmasked("angle", angle)):
            self._add("angle", rows_of("angle", angle, ()))
        if near is not None or far is not None:
            none = np.full(len(self._alive[0]), np.nan)
            ends = [none if end is None else rows_of(name, end, ()) for name, end in (("near", near), ("far", far))]
            self._alive += ends
            if len(ends[0]) == len(ends[1]):
                self._add("range", np.column_stack(ends))
        self.struct.count = len(self._alive[0])
        if any(len(rows) != len(self) for rows in self._alive):
            raise ArgumentError(f"poses: arrays of {', '.join(str(len(rows)) for rows in self._alive)} rows")

    def _add(self, member: str, rows: Array) -> None:
        self._alive.append(rows)
        setattr(self.struct, member, ffi.cast("double *", rows.ctypes.data))

    def __len__(self) -> int:
        return int(self.struct.count)

    def fill(self, pose: Any, index: int) -> int:
        """Makes a conus_pose of one of them; gives the status."""
        return int(lib.conus_pose_array_at(pose, self.struct, index))

    def range(self, index: int) -> Any:
        """For conus_selector_set_range()."""
        return self.struct.range + 2 * index if self.struct.range else ffi.NULL

    def angle(self, index: int, default: float) -> float:
        """Full opening, degrees; where it is 0, the default."""
        return float(self.struct.angle[index]) or default if self.struct.angle else default


# Poses that look wrong


class Aims:
    """Says of one pose after the other what is odd. The atlas's box, which takes milliseconds, is found once."""

    def __init__(self, selector: Any) -> None:
        out = ffi.new("conus_pose_check **")
        check(lib.conus_pose_check_create(out, selector))
        self._p = owned(out[0], lib.conus_pose_check_destroy, selector)
        self._number = 2**63

    @property
    def found(self) -> Any:
        """The conus_pose_findings of all poses so far."""
        return lib.conus_pose_check_found(self._p)

    def add(self, number: int, pose: Any, angle: float) -> None:
        lib.conus_pose_check_add(self._p, number, pose, angle)

    def of(self, pose: Any, angle: float) -> Any:
        """A conus_pose_findings of this pose alone."""
        before = {kind: getattr(self.found, kind).count for kind in ("inside", "away", "tiny")}
        self._number -= 1  # the lowest so far: an finding is that of the last pose
        self.add(self._number, pose, angle)
        alone = ffi.new("conus_pose_findings *", self.found[0])
        for kind, count in before.items():
            getattr(alone, kind).count -= count
        return alone


def notes_of(found: Any, selector: Any, atlas: Any, many: bool) -> list[str]:
    """The program's notes about the poses of a conus_pose_findings; for many by their indices."""

    def say(finding: Any, one: str, several: str, end: str) -> str:
        return f"{finding.count} of {found.poses} {several}, the first is pose {finding.first}{end}" if many else one

    def name_of(number: int) -> str:
        return text(lib.conus_atlas_object(atlas, number).name)

    reading = ffi.new("conus_pose_suggestion *")
    check(lib.conus_pose_check_suggest(reading, found, selector))
    remedy = f"; {text(reading.words)} it would hit {name_of(reading.object)} first" if reading.object else ""
    if reading.of_tiny:  # in metres, all else is otherwise, too
        near = "within 1 mm of the world's origin"
        return [say(found.tiny, f"the device lies {near}{remedy}", f"devices lie {near}", remedy)]
    notes = []
    if found.inside.count:
        name = name_of(found.inside.object)
        one, several = f"the device lies inside {name}", "devices lie inside an area"
        notes.append(say(found.inside, one, several, f", inside {name}"))
    if found.away.count:
        words = ("cone", "cones point") if found.away.angle > 0 else ("cylinder", "cylinders point")
        one, several = f"the {words[0]} points away from the atlas", f"{words[1]} away from the atlas"
        notes.append(say(found.away, one + remedy, several, remedy))
    return notes


def warn(notes: list[str]) -> None:
    """Each note as a warning about the line that called the package."""
    frame, level = sys._getframe(), 1
    while frame.f_back and str(frame.f_globals.get("__name__")).startswith(f"{__package__}."):
        frame, level = frame.f_back, level + 1
    for note in notes:
        warnings.warn(note, PoseWarning, stacklevel=level)
