# SPDX-License-Identifier: BSD-3-Clause
"""The contacts of a probe as the tools of the International Brain Laboratory read them.

    contacts = atlas.contacts(probe, origin=tip, direction=axis, space="ccf")
    conus.ibl.write_channels("alf/probe00/pykilosort", contacts)
"""
from __future__ import annotations

import json
import os
from typing import Any, Callable

import numpy as np

from ._answers import Array
from ._library import ArgumentError, FileError
from ._probe import Contacts

#: Bregma in the CCF, micrometres: ML, AP, DV of channel_locations.json (iblapps, iblatlas).
_BREGMA_UM = np.array([5739.0, 5400.0, 332.0])

#: Ids and acronyms of Allen's structures (allen_structure_tree.csv): what an atlas calls by these numbers tells whether its
#: labels are ids of Allen.
_ALLEN = {
    997: "root", 8: "grey", 1009: "fiber tracts", 382: "CA1", 423: "CA2", 463: "CA3", 672: "CP", 56: "ACB", 733: "VPM",
    718: "VPL", 218: "LP", 1020: "PO", 797: "ZI", 381: "SNr", 155: "LD", 262: "RT", 362: "MD", 181: "RE", 593: "VISp1",
    821: "VISp2/3", 721: "VISp4", 778: "VISp5", 33: "VISp6a", 315: "Isocortex", 549: "TH", 1097: "HY", 771: "P", 354: "MY",
    313: "MB", 776: "cc", 567: "CH", 1089: "HPF",
}


def channels(contacts: Contacts) -> dict[str, Any]:
    """What :func:`write_channels` writes.

    Parameters
    ----------
    contacts
        What :meth:`Atlas.contacts` gives with ``space="ccf"`` or ``space="bregma"``, of one probe and an atlas whose
        labels are Allen's ids and which has their acronyms.

    Returns
    -------
    dict
        "mlapdv": (n, 3) micrometres from bregma, to the right, to the front, upwards; "ids": (n,) Allen's ids, 0 = in no
        area, the same on both sides; "acronyms": n texts, "void" of 0; "local": (n, 2) micrometres across and along the
        probe, as its file has them. A row is a channel of the recording, from 0: that of the contact that is wired to
        it. Where the file has no wiring the contacts come in its order.

    Raises
    ------
    ArgumentError
        For several probes, and where a channel has no contact: IBL counts rows as channels.
    """
    order = _by_channel(contacts)
    if contacts.space is None or contacts.space.name not in ("ccf", "bregma"):
        raise ArgumentError('contacts: ask for them with space="ccf" or space="bregma": IBL counts from bregma in the CCF')
    info = contacts.atlas.info()
    numbers = info["index"].to_dict()
    acronyms = {index: str(acronym) for index, acronym in zip(info["index"], info["abbreviation"]) if isinstance(acronym, str)}
    _check_ids(acronyms)
    ids = np.array([numbers[area] if area else 0 for area in contacts.areas[order].tolist()], np.int64)
    return {
        "mlapdv": _from_bregma(contacts)[order],
        "ids": ids,
        "acronyms": [acronyms.get(number, "void") for number in ids.tolist()],
        "local": contacts.probe.positions[order, :2],
    }


def _by_channel(contacts: Contacts) -> Array:
    """Which contact each channel has."""
    wiring = contacts.probe.channels
    if len(contacts.probe.tips) != 1:
        raise ArgumentError(f"contacts: of {len(contacts.probe.tips)} probes, wanted are those of one: IBL has a folder for each")
    if (wiring < -1).all():
        return np.arange(len(wiring))
    order = np.argsort(wiring, kind="stable")[np.count_nonzero(wiring < 0):]
    gaps = np.flatnonzero(wiring[order] != np.arange(len(order)))  # no two have one channel: read_probe() refuses them
    if gaps.size:
        raise ArgumentError(f"contacts: channel {gaps[0]} has no contact: IBL counts rows as channels, from 0")
    if not order.size:
        raise ArgumentError("contacts: none is wired to a channel")
    return order


def _from_bregma(contacts: Contacts) -> Array:
    """ML, AP, DV micrometres from IBL's bregma, which is its own place in the CCF whatever bregma the selector has."""
    ap, dv, ml = contacts.atlas.selector(space="ccf").space.from_world(contacts.points).T  # type: ignore[union-attr]
    return np.column_stack((ml - _BREGMA_UM[0], _BREGMA_UM[1] - ap, _BREGMA_UM[2] - dv))


def _check_ids(acronyms: dict[int, str]) -> None:
    known = {number: acronyms[number] for number in _ALLEN if number in acronyms}
    other = [number for number, acronym in known.items() if acronym != _ALLEN[number]]
    if other:
        raise ArgumentError(f'contacts: the atlas calls {other[0]} "{known[other[0]]}", Allen "{_ALLEN[other[0]]}": IBL reads '
                            "Allen's ids")
    if not known:
        raise ArgumentError("contacts: the atlas has none of the ids and acronyms of Allen's that are known: IBL reads Allen's "
                            "ids")


def write_channels(folder: Any, contacts: Contacts) -> list[str]:
    """Writes ``channel_locations.json`` and ALF's ``channels.mlapdv.npy``, ``channels.brainLocationIds_ccf_2017.npy`` and
    ``channels.localCoordinates.npy``, which ONE and brainbox load.

    Parameters
    ----------
    folder
        It is made if it does not exist.
    contacts
        As for :func:`channels`.

    Returns
    -------
    list of str
        The paths.

    Raises
    ------
    FileError
        Where one of the files exists: nothing is written.
    """
    found = channels(contacts)
    local, rows = found["local"], found["mlapdv"]
    located = {
        f"channel_{i}": {"x": x, "y": y, "z": z, "axial": float(local[i, 1]), "lateral": float(local[i, 0]),
                         "brain_region_id": int(found["ids"][i]), "brain_region": found["acronyms"][i]}
        for i, (x, y, z) in enumerate(rows.tolist())
    }
    document = json.dumps({**located, "origin": {"bregma": _BREGMA_UM.tolist()}}, indent=2) + "\n"
    writers: dict[str, Callable[[Any], Any]] = {
        "channels.mlapdv.npy": lambda file: np.save(file, np.rint(rows).astype(np.int32)),
        "channels.brainLocationIds_ccf_2017.npy": lambda file: np.save(file, found["ids"].astype(np.int32)),
        "channels.localCoordinates.npy": lambda file: np.save(file, local.astype(np.float32)),
        "channel_locations.json": lambda file: file.write(document.encode()),
    }
    paths = {name: os.path.join(os.fspath(folder), name) for name in writers}
    there = [path for path in paths.values() if os.path.lexists(path)]
    if there:
        raise FileError(f"{there[0]}: exists")
    os.makedirs(folder, exist_ok=True)
    for name, write in writers.items():
        with open(paths[name], "xb") as file:
            write(file)
    return list(paths.values())
