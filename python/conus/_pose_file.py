# SPDX-License-Identifier: BSD-3-Clause
"""Files of poses, as the command line reads them."""
from __future__ import annotations

import math
import os
from typing import TYPE_CHECKING, Any, Optional, Sequence, Union

import numpy as np

from ._answers import Array
from ._callback import Callback
from ._conus import ffi, lib
from ._library import (
    ArgumentError,
    DataError,
    Guarded,
    byte_count,
    check,
    choice,
    flag,
    owned,
    path_of,
    python_words,
    shown,
    text,
    utf8,
)
from ._space import space_of
from ._table import choices

if TYPE_CHECKING:
    import pandas
    from ._atlas import Atlas, Path

_AXES = ("format", "+x", "-x", "+y", "-y", "+z", "-z")
_POINT = "a point, without the direction that a cone needs"


def pose_formats() -> list[str]:
    """Names of the formats that :func:`read_poses` knows; docs/formats.md describes each."""
    return choices(b"pose formats")


class Poses(Guarded):
    """Poses of a file: give them as ``poses=`` to ``select_many``, ``segments_many`` and ``track``.

    All arrays have one row for each row of the file, also for one that is no pose; positions are RAS mm. ``poses[i]``
    and ``poses["M1"]`` are the matrix of one, for ``atlas.select(pose=...)``. Of the spaces of the mouse they are
    left-handed where the atlas's world is a mirror image of the space (docs/spaces.md).
    """

    path: str
    ids: Array  #: (n,) texts: the file's own names, or the row's number from 1
    lines: Array  #: (n,) of the file, from 1
    matrices: Array  #: (n, 4, 4) from device to world, the device points along its -z; NaN where there is no pose
    origins: Array  #: (n, 3) NaN where there is no position
    directions: Array  #: (n, 3) unit vectors; NaN where there is no pose, and of points
    angles: Array  #: (n,) full openings, degrees; NaN where the file has none
    times_s: Array  #: (n,) seconds; NaN where the file has none
    triggers: Array  #: (n,) bool; False where the file has none
    errors_deg: Array  #: (n,) how far off the direction may be, degrees; NaN where the file has none
    errors_mm: Array  #: (n,) the same of the position
    ranges: Array  #: (n, 2) near and far, mm; NaN where the file has none
    radii: Array  #: (n,) of the balls around points, mm; NaN where the file has none
    kept: dict[str, Array]  #: (n,) texts of the columns that ``keep`` names; "" of an empty cell
    errors: dict[int, str]  #: why a row is no pose, by its index; a point has no direction

    def __init__(self, pointer: Any, path: Any, any_space: bool, alive: Any, keep: Sequence[str] = ()) -> None:
        self._list = owned(pointer, lib.conus_pose_list_destroy)
        super().__init__()
        self._alive, self._any_space = alive, any_space
        self.path = path
        count = lib.conus_pose_list_count(self._list)
        rows = [lib.conus_pose_list_row(self._list, i) for i in range(count)]
        self.ids = np.array([text(row.id) for row in rows], object)
        self.lines = np.array([row.line for row in rows], np.uint64)
        self.kept = {name: np.array([text(row.kept[i]) if row.kept else "" for row in rows], object)
                     for i, name in enumerate(keep)}
        self.errors = {i: f"line {row.line}: {python_words(text(row.error)) or _POINT}"
                       for i, row in enumerate(rows) if row.error or row.is_point}
        matrices = np.array([list(row.pose.world_from_device) for row in rows]).reshape(count, 4, 4)
        self.matrices = matrices.transpose(0, 2, 1).copy()
        self.matrices[[i for i, row in enumerate(rows) if row.error]] = np.nan
        self.origins = self.matrices[:, :3, 3].copy()
        self.matrices[list(self.errors)] = np.nan
        self.directions = -self.matrices[:, :3, 2]
        numbers = np.array([(row.angle or math.nan, row.time_s, row.error_deg, row.error_mm, *row.range, row.radius)
                            for row in rows])
        numbers = numbers.reshape(count, 7)
        numbers[np.isnan(self.origins[:, 0])] = np.nan
        self.angles = numbers[:, 0]
        self.times_s, self.errors_deg, self.errors_mm = numbers[:, 1:4].T.copy()
        self.ranges, self.radii = numbers[:, 4:6].copy(), numbers[:, 6].copy()
        self.triggers = np.array([bool(row.trigger and not row.error) for row in rows], bool)

    def __len__(self) -> int:
        return len(self.ids)

    def __repr__(self) -> str:
        return f"<conus.Poses: {len(self)} of {self.path}, {len(self.errors)} errors>"

    def __getitem__(self, which: Union[int, str]) -> Array:
        """The matrix of one, by its index or its id."""
        if isinstance(which, str):
            found = np.flatnonzero(self.ids == which)
            if len(found) != 1:
                raise ArgumentError(f"poses: {len(found)} have the id {shown(which)}, wanted is one; ids has all")
            which = int(found[0])
        which = range(len(self))[which]
        if which in self.errors:
            raise ArgumentError(f"poses: {self.ids[which]}: {self.errors[which]}")
        return np.asarray(self.matrices[which])

    @property
    def notes(self) -> list[str]:
        """Notes about these poses."""
        notes: list[str] = []
        while note := lib.conus_pose_list_note(self._list, len(notes)):
            notes.append(python_words(text(note)))
        return notes

    def match(self, atlas: Atlas) -> None:
        """Checks that the poses and the atlas belong to one brain; whatever takes the poses asks this, too. A
        PoseWarning tells of points that lie far from the areas, or positions of a cap, that they are called as.

        Raises
        ------
        DataError
            Where they name different brains, a scan of one person and a template, say. ``any_space=True`` of
            :func:`read_poses` takes them nevertheless.
        """
        if self._any_space:
            return
        try:
            with self._lock:
                check(lib.conus_pose_list_match(self._list, atlas._p))
        except DataError as error:
            remedy = "load(..., transforms=[...]) brings it to them, read_poses(..., any_space=True) takes them as positions in the atlas's space"
            raise DataError(f"{self.path}: {error}; {remedy}") from None
        self._warn_of_names(atlas)

    def _warn_of_names(self, atlas: Atlas) -> None:
        from ._poses import warn

        found = ffi.new("conus_name_check *")
        check(lib.conus_places_check(found, atlas._p, self._list))
        for gap, what in ((found.areas, "areas of the atlas"), (found.positions, "positions of a cap")):
            if gap.is_far:
                warn([f"{self.path}: {gap.named} points are called as {what}, and half of them lie {gap.median:.0f} mm or "
                      f"more from there ({self.ids[gap.farthest]}: {gap.farthest_mm:.0f} mm); are they in its space and "
                      "unit, with its sides?"])

    def _marks(self) -> dict[str, Array]:
        """The columns of rows about these poses: query and, where ids repeat or there are times, row and time_s."""
        times = {} if np.isnan(self.times_s).all() else {"time_s": self.times_s}
        is_marked = times or len(set(self.ids)) < len(self)
        return {"query": self.ids, **({"row": np.arange(1, len(self) + 1)} if is_marked else {}), **times}

    def to_dataframe(self) -> pandas.DataFrame:
        """A row for each: query (its id), position, direction, and what else the file says; NA where it does not."""
        import pandas

        columns: dict[str, Any] = {"query": self.ids}
        columns.update(zip(("x", "y", "z"), self.origins.T))
        columns.update(zip(("dx", "dy", "dz"), self.directions.T))
        others = (("angle", self.angles), ("time_s", self.times_s), ("error_deg", self.errors_deg),
                  ("error_mm", self.errors_mm), ("near", self.ranges[:, 0]), ("far", self.ranges[:, 1]))
        columns.update((name, values) for name, values in others if not np.isnan(values).all())
        columns.update(self.kept)
        columns["error"] = [self.errors.get(i) for i in range(len(self))]
        return pandas.DataFrame(columns)

    def _repr_html_(self) -> str:
        return str(self.to_dataframe()._repr_html_())


def read_poses(
    path: Path,
    *,
    format: str = "auto",
    axis: str = "format",
    along_shafts: bool = False,
    space: str = "ras",
    bregma: Any = None,
    atlas: Optional[Atlas] = None,
    any_space: bool = False,
    keep: Sequence[str] = (),
    max_memory: int = 0,
) -> Poses:
    """Reads a file of poses: tables, Brainsight, Localite, SimNIBS, and all else that ``conus batch --poses`` reads.

    Parameters
    ----------
    path
        A file.
    format
        "auto", the content decides, or one of ``pose_formats()``.
    axis
        The axis of the device, in the file's frame, along which it points: "+x" to "-z"; "format", as the file's
        format has it.
    along_shafts
        Contacts of electrodes (BIDS) point along their shafts, each to the next.
    space, bregma
        Space of the numbers in the file, where it does not say so itself: as for :class:`Selector`.
    atlas
        Where "ccf" and "bregma" are found, and names of places in place of coordinates. The poses are matched with it (:meth:`Poses.match`) at once.
    any_space
        Take the poses even if the file names another space than the atlas.
    keep
        Names of columns of a table whose texts ``Poses.kept`` has, as ``conus batch --keep``.
    max_memory
        Largest file of a format that is read whole, bytes; 0 = 1 GiB.

    Returns
    -------
    Poses
        A row that is no pose is in ``errors`` with the reason.

    Raises
    ------
    FileError, DataError, UnsupportedError
        For a file that cannot be read, is no file of poses, or is beyond conus.
    """
    options, out = ffi.new("conus_pose_options *"), ffi.new("conus_pose_list **")
    choice("format", format, pose_formats())
    word = utf8("format", format)
    options.format, options.axis = word, choice("axis", axis, _AXES)
    options.any_space = flag("any_space", any_space)
    options.along_shafts, options.max_memory = flag("along_shafts", along_shafts), byte_count("max_memory", max_memory)
    if space in ("ccf", "bregma") and atlas is None:
        raise ArgumentError(f"space: {space} lies where an atlas has it, atlas=... is needed")
    found = space_of(ffi.NULL if atlas is None else atlas._p, space, bregma)
    options.frame = found._frame if found else ffi.NULL
    if atlas is not None:
        options.atlas, options.find_place = atlas._p, ffi.addressof(lib, "conus_place_find")
    options.of_mni305 = atlas is not None and lib.conus_atlas_brain(atlas._p).brain == lib.CONUS_BRAIN_MNI305
    if isinstance(keep, str):
        raise ArgumentError("keep: a list of names is wanted, not a text")
    names = [ffi.new("char[]", str(name).encode()) for name in keep]
    kept = ffi.new("char *[]", names)
    options.keep, options.keep_count = ffi.cast("const char *const *", kept), len(names)
    state = Callback()
    handle = state.log_notes(options)
    status = lib.conus_pose_list_load(out, path_of("path", path), options)
    state.check(status)
    poses = Poses(out[0], os.fsdecode(path), flag("any_space", any_space), (state, handle), tuple(map(str, keep)))
    if atlas is not None:
        poses.match(atlas)
    return poses
