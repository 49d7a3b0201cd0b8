# SPDX-License-Identifier: BSD-3-Clause
"""The spaces of positions: the world's, and those of the Allen CCF."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Optional

import numpy as np

from ._conus import ffi, lib
from ._library import ArgumentError, Bound, check, choice, numbers, text, utf8, vector

_NAMES = ("ras", "lps", "ccf", "bregma")


_KINDS = ("numbers", "inner point", "centroid", "nearest point", "position")  # of conus_place_kind


@dataclass(frozen=True)
class Place:
    """A point that words mean: :meth:`Atlas.place` makes one. ``str()`` says how they were understood."""

    point: Any  #: (3,) RAS mm
    kind: str  #: "numbers", "inner point", "centroid", "nearest point" or "position"
    name: str  #: of the area or the position; "" of numbers
    number: int  #: of the area or pathway; 0 = none
    inside_mm: float  #: of an inner point: how far it is from what is not the area; else nan
    outward: Any  #: (3,) of a position: away from the head; 0, 0, 0 where that is not known
    words: str  #: "Hippocampus_L: (-27.0, -13.0, -15.0), 6.0 mm inside"

    def __str__(self) -> str:
        return self.words


def place_of(atlas: Any, name: str, words: str, frame: Any, other: Any = None, has_axis: bool = False) -> Place:
    """What words mean in the conus_atlas; numbers are in the conus_frame, or NULL."""
    out, said = ffi.new("conus_place *"), ffi.new("char[512]")
    options = ffi.new("conus_place_options *", {"frame": frame, "has_axis": has_axis})
    there = ffi.NULL if other is None else ffi.new("double[3]", vector("the other end", other))
    options.other = there
    try:
        check(lib.conus_place_find(out, atlas, utf8(name, words), options))
    except ArgumentError as error:
        raise ArgumentError(f"{name}: {error}") from None
    lib.conus_place_text(said, out, frame)
    return Place(np.array(list(out.point)), _KINDS[out.kind], text(out.name), out.object, out.depth,
                 np.array(list(out.outward)), text(said))


class Space(Bound):
    """Takes positions and directions, (3,) or (n, 3), to world mm and back."""

    def __init__(self, atlas: Any, name: str, bregma: Any = None) -> None:
        self.name = name
        self.is_own = name in ("ccf", "bregma")  #: of the atlas, wherever it was moved to
        self._frame = ffi.new("conus_frame *")
        number = choice("space", name, _NAMES)
        if bregma is not None and name != "bregma":
            raise ArgumentError('bregma: has no effect without space="bregma"')
        where = ffi.NULL if bregma is None else vector("bregma", bregma)
        check(lib.conus_frame_find(self._frame, atlas, number, where))
        self._matrix = np.array(list(self._frame.world_from_space)).reshape(4, 4).T
        self._inverse = np.linalg.inv(self._matrix)

    def to_world(self, name: str, points: Any) -> Any:
        """Positions; None stays None. Of many, those that are not finite stay as they are: poses without an answer."""
        return self._each(name, points, lib.conus_frame_to_world, True)

    def directions_to_world(self, name: str, directions: Any) -> Any:
        """Directions; None stays None."""
        return self._each(name, directions, lib.conus_frame_direction_to_world, False)

    def matrices_to_world(self, name: str, poses: Any) -> Any:
        """(..., 4, 4) matrices from device to this space; None stays None."""
        if poses is not None and self.is_own:
            raise ArgumentError(f"{name}: a matrix is of ras or lps, not of {self.name}")
        matrices = None if poses is None else numbers(name, poses)
        if matrices is None or matrices.shape[-2:] != (4, 4):
            return matrices  # whose shape the caller refuses
        return self._matrix @ matrices

    def from_world(self, points: Any) -> Any:
        """Positions; numbers that are none stay none."""
        return points @ self._inverse[:3, :3].T + self._inverse[:3, 3]

    def _each(self, name: str, given: Any, function: Any, is_checked: bool) -> Any:
        if given is None:
            return None
        array = np.array(numbers(name, given), order="C")
        if not array.size or array.shape[-1] != 3:
            return array  # whose shape the caller refuses
        at = ffi.cast("double *", array.ctypes.data)
        for row in range(array.size // 3):
            status = function(at + 3 * row, self._frame, at + 3 * row)
            if is_checked and (array.ndim == 1 or np.isfinite(array.reshape(-1, 3)[row]).all()):
                check(status)
        return array


def frame_of(space: Optional[Space], atlas: Any, matrices: Any) -> Any:
    """A conus_frame in whose axes devices are turned, or NULL: that of the space, and for left-handed matrices, which
    ``read_poses()`` gives in a world that is a mirror image of the CCF, that of the CCF.
    """
    if space:
        return space._frame
    try:
        given = np.asarray(matrices)
    except ValueError:
        return ffi.NULL  # the caller refuses what are no matrices
    if given.dtype.kind not in "fiu" or given.shape[-2:] != (4, 4):
        return ffi.NULL
    frame, is_turned = ffi.new("conus_frame *"), (np.linalg.det(np.nan_to_num(given)[..., :3, :3]) < 0).any()
    return frame if is_turned and not lib.conus_frame_find(frame, atlas, _NAMES.index("ccf"), ffi.NULL) else ffi.NULL


def mirrors(frame: Any) -> bool:
    """Whether the world is a mirror image of the conus_frame's space: AP, DV, ML of the CCF are right-handed."""
    if not frame or frame.space < lib.CONUS_SPACE_CCF:
        return False
    linear = np.array(list(frame.world_from_space)).reshape(4, 4)[:3, :3]
    return bool((np.linalg.det(linear) < 0) == (frame.space == lib.CONUS_SPACE_CCF))


def space_of(atlas: Any, name: str, bregma: Any) -> Optional[Space]:
    """None where positions are the world's already."""
    return None if name == "ras" and bregma is None else Space(atlas, name, bregma)
