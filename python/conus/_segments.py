# SPDX-License-Identifier: BSD-3-Clause
"""The segments of probes, in order of depth, as arrays and tables."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional

import numpy as np

from ._answers import Array, identity_of, own_points_of, points_of, queries_of, with_errors
from ._conus import ffi, lib
from ._library import SEGMENT, array_of, owned

if TYPE_CHECKING:
    import pandas
    from ._atlas import Atlas
    from ._space import Space


def records_of(pointer: Any) -> Array:
    """The records of a conus_segments, which is ended."""
    segments = owned(pointer, lib.conus_segments_destroy)
    return array_of(lib.conus_segments_segment(segments, 0), lib.conus_segments_count(segments), SEGMENT)


class Segments:
    """The objects that the axis of a device passes: stretches inside each object and between them, the nearest first.

    ``records`` are the library's own. Of many poses, ``records[starts[i]:starts[i + 1]]`` are those of
    pose ``i``, and ``errors`` has the reason for each pose that has none, by its index; of one pose,
    ``starts`` is None.
    """

    def __init__(
        self, atlas: Atlas, records: Array, starts: Optional[Array] = None, errors: Optional[dict[int, str]] = None,
        names: Optional[Array] = None,
    ) -> None:
        self.atlas = atlas
        self.records = records
        self.starts = starts
        self.errors = errors or {}
        self._names = names
        self.space: Optional[Space] = None

    def __len__(self) -> int:
        return len(self.records)

    def __repr__(self) -> str:
        of = "" if self.starts is None else f" of {len(self.starts) - 1} poses"
        return f"<conus.Segments: {len(self)} segments{of}>"

    def to_dataframe(self) -> pandas.DataFrame:
        """The rows of ``--segments``; of many poses with ``query``, the pose's id in its file or its number from 1.

        A pose without an answer has one row of kind "error", whose name is the reason.
        """
        import pandas

        starts = np.array([0, len(self)]) if self.starts is None else self.starts
        query = np.repeat(np.arange(len(starts) - 1), np.diff(starts))
        objects, records = self.atlas.objects, self.records
        queries = queries_of(self._names, len(starts) - 1)
        columns = {} if self.starts is None else {"query": queries[query]}
        columns["order"] = np.arange(len(self)) - starts[query] + 1
        columns.update(identity_of(objects, records))
        columns["entry_mm"] = records["entry"]
        columns["exit_mm"] = np.where(np.isfinite(records["exit"]), records["exit"], np.nan)
        columns["length_mm"] = columns["exit_mm"] - columns["entry_mm"]
        for name in ("entry", "exit"):
            columns.update(points_of(f"{name}_", records[f"{name}_at"], self.space))
        for name in ("entry", "exit"):
            columns.update(own_points_of(self.atlas, f"atlas_{name}_", records[f"{name}_at"], self.space))
        return with_errors(pandas.DataFrame(columns), query, queries, self.errors)

    def _repr_html_(self) -> str:
        return str(self.to_dataframe()._repr_html_())


def follow_many(call: Any, atlas: Atlas, array: Any) -> Segments:
    """Asks ``call(out, pose)``, which gives the reason of a pose that has no answer, for each pose of an array."""
    pose, found, errors = ffi.new("conus_pose *"), [], {}
    starts = np.zeros(len(array) + 1, np.int64)
    for i in range(len(array)):
        out = ffi.new("conus_segments **")
        reason = call(out, array, i, pose)
        if reason is None:
            found.append(records_of(out[0]))
        else:
            errors[i] = array.reasons.get(i, reason)
        starts[i + 1] = starts[i] + (len(found[-1]) if reason is None else 0)
    return Segments(atlas, np.concatenate(found) if found else np.empty(0, SEGMENT), starts, errors, array.names)
