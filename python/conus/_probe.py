# SPDX-License-Identifier: BSD-3-Clause
"""Probes of ProbeInterface, and the answers at their contacts."""
from __future__ import annotations

import json
import os
import tempfile
from typing import TYPE_CHECKING, Any

import numpy as np

from ._answers import Answers, Array
from ._conus import ffi, lib
from ._library import ArgumentError, Bound, Error, byte_count, check, owned, path_of, real, shown
from ._table import ask_table

if TYPE_CHECKING:
    import pandas
    from ._atlas import Atlas, Path

_AREA = lib.CONUS_KIND_AREA


class Probe(Bound):
    """The contacts of the probes of a file, in its order; see docs/formats.md."""

    path: str
    ids: Array  #: (n,) texts: each once; of several probes "probe1:e3"
    probes: Array  #: (n,) index of the contact's probe
    shanks: Array  #: (n,) texts; "" where the file has none
    channels: Array  #: (n,) the trace of a contact, from 0; -1 = not wired, -2 = the file does not say
    positions: Array  #: (n, 3) as in the file, micrometres; the third is NaN of a probe in two dimensions
    tips: Array  #: (m, 3) the same, of each probe's tip

    def __init__(self, pointer: Any, path: str) -> None:
        self._p = owned(pointer, lib.conus_probe_destroy)
        self.path = path
        found = ask_table(lib.conus_probe_table, self._p)
        columns = found.arrays()
        self.ids = columns["id"]
        self.shanks = np.array([shank or "" for shank in columns["shank_id"]], object)
        self.probes = columns["number"] - 1
        self.channels = np.where(columns["missing", "channel"], -2, columns["channel"])
        self.positions = np.stack([columns[name] for name in ("x_um", "y_um", "z_um")], axis=1)
        tips = found.part("tips")
        self.tips = np.stack([tips[name] for name in ("x_um", "y_um", "z_um")], axis=1)

    def __len__(self) -> int:
        return len(self.ids)

    def __repr__(self) -> str:
        return f"<conus.Probe: {len(self)} contacts, {len(self.tips)} probes of {self.path}>"

    def _place(self, poses: Any, count: int, roll: float) -> Array:
        """(n, 3) world mm, of a C array of conus_pose."""
        out = ffi.new("conus_pose_list **")
        check(lib.conus_probe_place(out, self._p, poses, count, real("roll", roll)))
        rows = owned(out[0], lib.conus_pose_list_destroy)
        return np.array([list(lib.conus_pose_list_row(rows, i).pose.world_from_device)[12:15] for i in range(len(self))])


def is_probe(value: Any) -> bool:
    """A Probe or ProbeGroup of probeinterface, or the dictionary of its file; not what read_probe() gives."""
    return isinstance(value, dict) or hasattr(value, "contact_positions") or (
        hasattr(value, "probes") and not isinstance(value, Probe))


def probe_text(source: Any) -> str:
    """The file of what :func:`is_probe` is."""
    probes = getattr(source, "probes", [source] if hasattr(source, "contact_positions") else None)
    if probes is not None:
        source = {"specification": "probeinterface", "version": "", "probes": [p.to_dict(array_as_list=True) for p in probes]}
    try:
        return json.dumps(source)
    except (TypeError, ValueError) as error:
        raise ArgumentError(f"probe: {error}; to_dict(array_as_list=True) has what a file can have") from None


def read_probe(path: Any, *, tip: float = 0, max_memory: int = 0) -> Probe:
    """Reads the contacts of a file of ProbeInterface, or of a recording: give them to :meth:`Atlas.contacts`.

    Parameters
    ----------
    path
        A file; of a recording SpikeGLX's .ap.meta or .imro, or Open Ephys's settings.xml. Or what is in memory: a Probe
        or ProbeGroup of probeinterface, or the dictionary that its file has.
    tip
        mm from the tip to the lowest contact, in place of the contour in the file; 0 = by the contour. Of a recording
        to the lowest row of the probe, recorded or not; 0 = by its part number.
    max_memory
        Largest file, bytes; 0 = 1 GiB.
    """
    options, out = ffi.new("conus_probe_options *"), ffi.new("conus_probe **")
    options.tip, options.max_memory = real("tip", tip), byte_count("max_memory", max_memory)
    if isinstance(path, (str, bytes, os.PathLike)):
        check(lib.conus_probe_load(out, path_of("path", path), options))
        return Probe(out[0], os.fsdecode(path))
    if not is_probe(path):
        raise ArgumentError(f"path: {shown(path)}, wanted is a path, a Probe of probeinterface or its dictionary")
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "probe.json")
        with open(file, "x", encoding="utf-8") as written:
            written.write(probe_text(path))
        try:
            check(lib.conus_probe_load(out, path_of("path", file), options))
        except Error as error:
            raise type(error)(str(error).replace(file, "probe")) from None
    return Probe(out[0], "probe")


class Contacts(Answers):
    """The answers at the contacts of a probe, in their order."""

    def __init__(self, probe: Probe, points: Array, atlas: Atlas, results: Array, starts: Array) -> None:
        super().__init__(atlas, results, starts, {}, True, {"query": probe.ids})
        self.probe = probe
        self.points = points  #: (n, 3) where the contacts are, RAS mm
        first = np.zeros(len(probe), np.int64)
        query = np.repeat(np.arange(len(probe)), np.diff(self.starts))
        holds = (self.results["kind"] == _AREA) & (self.results["distance"] == 0)
        first[query[holds][::-1]] = self.results["object"][holds][::-1]  # the best is written last
        self.areas = first  #: (n,) object number of the area that holds the contact, of several the best; 0 = none

    def __repr__(self) -> str:
        return f"<conus.Contacts: {np.count_nonzero(self.areas)} of {len(self)} in an area>"

    def to_dataframe(self, *, order: str = "rank") -> pandas.DataFrame:
        """The rows of ``conus query --probe --layers all``: its columns and values, what is "n/a" there is missing."""
        frame = super().to_dataframe(order=order)
        query, _ = self._rows(order)
        frame[["pixels", "pierced"]] = None  # which no ray looks for
        frame["probe"] = np.array([f"probe{i + 1}" for i in self.probe.probes], object)[query]
        frame["shank_id"] = np.array([shank or None for shank in self.probe.shanks], object)[query]
        frame["channel"] = np.where(self.probe.channels < -1, np.nan, self.probe.channels)[query]
        return frame


def poses_of_probe(array: Any, probe: Probe) -> Any:
    """A C array of conus_pose, one for each probe: of its tip, which is at the far end where a file of poses has one."""
    if len(array) != len(probe.tips):
        raise ArgumentError(f"poses: {len(array)}, wanted are {len(probe.tips)}: each probe has one of its own")
    if array.reasons:
        raise ArgumentError(f"poses: {next(iter(array.reasons.values()))}")
    poses = ffi.new("conus_pose[]", len(array))
    for i in range(len(array)):
        check(array.fill(poses + i, i))
        ends, matrix = array.range(i), poses[i].world_from_device
        for a in range(3 if ends and ends[1] >= 0 else 0):
            matrix[12 + a] -= ends[1] * matrix[8 + a]
    return poses


def brain_areas(
    source: Any, atlas: Any, *, origin: Any, direction: Any, up: Any = None, roll: float = 0, tip: float = 0,
    outside: str = "none", **options: Any,
) -> list[str]:
    """The area of each contact of a probe, or of each channel of a recording of SpikeInterface, in its order.

    ``recording.set_property("brain_area", conus.brain_areas(recording, atlas, origin=tip, direction=axis))``

    Parameters
    ----------
    source
        A recording with one probe, a Probe of probeinterface, or what :func:`read_probe` takes or gives.
    atlas
        A name, a path, or what :func:`load` gives.
    origin, direction, up, roll, options
        As for :meth:`Atlas.contacts`: ``origin`` is the tip, ``direction`` leads from the base to it, and ``space=`` says
        what they are in.
    tip
        As for :func:`read_probe`, unless ``source`` is what it gave.
    outside
        What a contact in no area is called.

    Returns
    -------
    list of str
        A contact on the border of two areas has the first of them in the atlas.
    """
    from ._atlas import Atlas, load

    loaded = atlas if isinstance(atlas, Atlas) else load(atlas)
    given = source.get_probe() if hasattr(source, "get_probe") else source
    if tip and isinstance(given, Probe):
        raise ArgumentError("tip: the probe has been read already, give it to read_probe()")
    probe = given if isinstance(given, Probe) else read_probe(given, tip=tip)
    contacts = loaded.contacts(probe, origin, direction=direction, up=up, roll=roll, **options)
    return [str(loaded.objects.name(int(area))) if area else outside for area in contacts.areas]
