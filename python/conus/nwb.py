# SPDX-License-Identifier: BSD-3-Clause
"""The contacts of a probe in an NWB file, as tables of the extension ndx-anatomical-localization.

pynwb and ndx-anatomical-localization are the user's; nothing else of conus needs them.
"""
from __future__ import annotations

import importlib
import os
from typing import Any, Optional, Sequence

from ._conus import lib
from ._library import ArgumentError, text
from ._probe import Contacts

#: What the extension calls the spaces of conus: origin, unit, and the positive directions of x, y and z.
_SPACES = {
    "ras": ("that of the atlas's world", "mm", "RAS"),
    "lps": ("that of the atlas's world", "mm", "LPS"),
    "bregma": ("bregma", "mm", "ARS"),
}


def _method(contacts: Contacts) -> str:
    volume = lib.conus_atlas_volume(contacts.atlas._p, 0)
    name = os.path.basename(text(volume.path)) if volume else "of surfaces"
    version = text(lib.conus_version())
    return f"conus {version}, atlas {name}" + (f" sha256 {text(volume.sha256)}" if volume else "")


def coordinates(contacts: Contacts) -> dict[str, Any]:
    """What :func:`add_localization` writes, as plain lists.

    Parameters
    ----------
    contacts
        What :meth:`Atlas.contacts` gives. Positions are in its space: with ``space="ccf"`` AP, DV and ML in
        micrometres, which is the space AllenCCFv3.

    Returns
    -------
    dict
        "x", "y", "z" and "brain_region", one for each contact: the name of the area that holds it, or "unknown"; "space"
        and "method".
    """
    points = contacts.space.from_world(contacts.points) if contacts.space else contacts.points
    names = [contacts.atlas.objects.name(int(area)) if area else "unknown" for area in contacts.areas]
    table: dict[str, Any] = {axis: points[:, i].tolist() for i, axis in enumerate("xyz")}
    space = contacts.space.name if contacts.space else "ras"
    return {**table, "brain_region": names, "space": space, "method": _method(contacts)}


def add_localization(
    nwbfile: Any, contacts: Contacts, *, rows: Optional[Sequence[int]] = None, name: str = "conus",
) -> Any:
    """Adds where the electrodes of an NWB file are, in the space of ``contacts``.

    Parameters
    ----------
    nwbfile
        A pynwb.NWBFile with electrodes.
    contacts
        What :meth:`Atlas.contacts` gives.
    rows
        The row of ``nwbfile.electrodes`` of each contact; negative = none. ``contacts.probe.channels`` where electrodes
        are in the order of the traces. Without it, electrodes are in the order of the contacts.
    name
        Name of the table.

    Returns
    -------
    AnatomicalCoordinatesTable
        The table, which is part of the file.
    """
    try:
        ndx = importlib.import_module("ndx_anatomical_localization")
    except ImportError as error:
        raise ImportError("nwb: needs pynwb and ndx-anatomical-localization: pip install ndx-anatomical-localization") from error
    electrodes = nwbfile.electrodes
    count = 0 if electrodes is None else len(electrodes)
    given = list(range(len(contacts))) if rows is None else [int(row) for row in rows]
    if len(given) != len(contacts) or (rows is None and count != len(contacts)):
        wanted = f"{count} electrodes; rows= says which they are" if rows is None else f"{len(given)} rows"
        raise ArgumentError(f"nwb: {len(contacts)} contacts, but {wanted}")
    wired = [row for row in given if row >= 0]
    if len(set(wired)) != len(wired) or any(row >= count for row in wired):
        raise ArgumentError(f"rows: each once, allowed is up to {count - 1}, that of the last electrode")
    table = coordinates(contacts)
    space = table["space"]
    where = ndx.AllenCCFv3Space() if space == "ccf" else None
    if where is None:
        origin, units, orientation = _SPACES[space]
        where = ndx.Space(name=name + "_space", space_name=space, origin=origin, units=units, orientation=orientation)
    out = ndx.AnatomicalCoordinatesTable(name=name, target=electrodes, description="where the contacts of a probe are",
                                         method=table["method"], space=where)
    for i, row in enumerate(given):
        if row >= 0:
            out.add_row(**{key: table[key][i] for key in ("x", "y", "z", "brain_region")}, localized_entity=row)
    localization = ndx.Localization()
    nwbfile.add_lab_meta_data([localization])
    localization.add_spaces([where])
    localization.add_anatomical_coordinates_tables([out])
    return out
