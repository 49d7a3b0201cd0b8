# SPDX-License-Identifier: BSD-3-Clause
"""Areas of the electrodes and dipoles of MNE-Python.

    conus.mne.label(raw, "sub-01/mri/aparc+aseg.mgz", trans="sub-01-trans.fif", subject="sub-01")

MNE is the user's, and nibabel, which reads the subject's T1; nothing else of conus needs MNE.
"""
from __future__ import annotations

import importlib
import json
import logging
import os
import tempfile
from typing import TYPE_CHECKING, Any, Optional, Sequence, Union

import numpy as np

from ._answers import Answers, Array
from ._atlas import Atlas, load
from ._library import ArgumentError, Error
from ._pose_file import Poses, read_poses
from ._poses import warn

if TYPE_CHECKING:
    from ._atlas import Path

#: The frame of MNE in which positions of MNI 305 are, and the words of BIDS for it and for one person's scan.
_TALAIRACH, _MNI305, _SCAN = "mni_tal", "MNI305", "ScanRAS"
_HEAD, _MRI = 4, 5  # FIFFV_COORD_HEAD and _MRI of the FIF format


def label(
    source: Any,
    atlas: Union[Atlas, Path],
    *,
    trans: Any = None,
    subject: Optional[str] = None,
    subjects_dir: Optional[Path] = None,
    space: Optional[str] = None,
    radius: float = 0,
) -> Answers:
    """Answers what is at each electrode or dipole, and where that is nothing, what is nearest.

    Parameters
    ----------
    source
        A montage, an Info, a Raw, Epochs or Evoked with one, a Dipole, or an array (n, 3) of RAS mm.
    atlas
        A name, a path, or what :func:`load` gives.
    trans
        Of positions in MNE's frame ``head``, as dipoles are: a -trans.fif or a Transform, in either direction.
    subject, subjects_dir
        Of positions in the frames ``head`` and ``mri``: whose ``mri/T1.mgz`` leads from FreeSurfer's surface RAS to the
        scan. They are positions in that person's own scan, which a template refuses. ``fsaverage`` is MNI 305.
    space
        Of positions in the frame ``ras``, and of an array: the brain that they are in, as BIDS calls it:
        "MNI152NLin2009cAsym", "MNI305", "ScanRAS" for one person's own scan, and so on.
    radius
        mm, as for :meth:`Atlas.near_many`.

    Returns
    -------
    Answers
        In the order of the channels or of the dipoles' times, whose names are in the column ``query``. A channel without
        a position has no answer, with a PoseWarning. Positions of MNI 305 are moved to MNI 152 by FreeSurfer's matrix, with a PoseWarning,
        unless the atlas is of MNI 305.

    Raises
    ------
    ArgumentError
        Where the frame needs what was not given.
    DataError
        Where positions and atlas are of different brains.
    """
    names, points, brain = _positions(source, trans, subject, subjects_dir, space)
    loaded = atlas if isinstance(atlas, Atlas) else load(atlas)
    poses, notes = _as_poses(names, points, brain, loaded)
    if notes:
        warn(notes)
    return loaded.near_many(poses, radius)


def _positions(source: Any, trans: Any, subject: Any, subjects_dir: Any, space: Any) -> tuple[list[str], Array, str]:
    """Names, RAS mm, and the brain that these are in, as BIDS calls it."""
    names, points, frame = ([], source, "ras") if isinstance(source, np.ndarray) else _in_frame(source)
    points = np.array(points, float)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ArgumentError(f"source: shape {points.shape}, needed is (n, 3)")
    names = names or [str(i + 1) for i in range(len(points))]
    if space is not None and frame != "ras":
        raise ArgumentError(f'space: positions are in the frame "{frame}" of MNE, which says whose brain they are in')
    if frame == "head":
        points, frame = _from_head(points, trans), "mri"
    elif trans is not None:
        raise ArgumentError(f'trans: positions are in the frame "{frame}", not in the head\'s')
    if subject is not None and frame != "mri":
        raise ArgumentError(f'subject: positions are in the frame "{frame}", the frame "mri" needs it')
    if frame == "mri" and subject != "fsaverage":
        return names, _apply(_scan_from_surface(subject, subjects_dir), points), _SCAN
    if frame in ("mri", _TALAIRACH):
        return names, points, _MNI305
    if frame != "ras":
        raise ArgumentError(f'source: positions are in the frame "{frame}", allowed are head, mri, {_TALAIRACH} and ras')
    if not space:
        raise ArgumentError('source: positions in RAS mm do not say whose brain they are in: space="ScanRAS" is one '
                            'person\'s own scan, space="MNI152NLin2009cAsym" or space="MNI305" a template')
    return names, points, space


def _in_frame(source: Any) -> tuple[list[str], Array, str]:
    """Names, mm and frame of MNE's objects, which have metres."""
    if hasattr(source, "pos") and hasattr(source, "times"):  # a Dipole
        return [f"{time:.3f} s" for time in source.times], 1000 * np.asarray(source.pos), "head"
    montage = source if hasattr(source, "get_positions") else source.get_montage() if hasattr(source, "get_montage") else None
    if montage is None:
        what = "has no montage, hence no positions" if hasattr(source, "get_montage") else "is nothing of MNE with positions"
        raise ArgumentError(f"source: {type(source).__name__} {what}")
    found = montage.get_positions()
    points = np.array(list(found["ch_pos"].values()), float).reshape(-1, 3)
    return list(found["ch_pos"]), 1000 * points, str(found["coord_frame"])


def _apply(matrix: Array, points: Array) -> Array:
    return np.asarray(points @ matrix[:3, :3].T + matrix[:3, 3])


def _from_head(points: Array, trans: Any) -> Array:
    """mm in the MRI's surface RAS of mm in the head's frame."""
    if trans is None:
        raise ArgumentError("trans: positions in the head's frame need the head's place in the MRI, a -trans.fif")
    transforms = importlib.import_module("mne.transforms")
    found = trans if isinstance(trans, transforms.Transform) else transforms.read_trans(trans)
    if {int(found["from"]), int(found["to"])} != {_HEAD, _MRI}:
        raise ArgumentError(f"trans: leads from {found.from_str} to {found.to_str}, needed is from head to MRI")
    matrix = np.array((found if found["to"] == _MRI else transforms.invert_transform(found))["trans"])
    matrix[:3, 3] *= 1000
    return _apply(matrix, points)


def _scan_from_surface(subject: Any, subjects_dir: Any) -> Array:
    """FreeSurfer's surface RAS to the scan's RAS, mm, of the subject's T1."""
    if subject is None:
        raise ArgumentError("subject: positions in the MRI's surface RAS need the subject, whose T1.mgz places them")
    folder = importlib.import_module("mne.utils").get_subjects_dir(subjects_dir, raise_error=True)
    header = importlib.import_module("nibabel").load(os.path.join(folder, subject, "mri", "T1.mgz")).header
    return np.asarray(header.get_vox2ras() @ np.linalg.inv(header.get_vox2ras_tkr()))


def _as_poses(names: Sequence[str], points: Array, brain: str, atlas: Atlas) -> tuple[Poses, list[str]]:
    """Positions as a file of BIDS states them, so that whatever is asked of files is asked of them; and its notes."""
    odd = [name for name in names if not name.strip() or any(ord(c) < 32 for c in name)]
    if odd:
        raise ArgumentError(f"source: a channel is called {odd[0]!r}")
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "source_electrodes.tsv")
        with open(path, "w", encoding="utf-8") as file:
            file.write("x\ty\tz\tname\n")  # a row that began with a name of "#1" would be a comment
            for name, point in zip(names, points):
                cells = [f"{x!r}" for x in point.tolist()] if np.isfinite(point).all() else ["n/a"] * 3
                file.write("\t".join((*cells, name)) + "\n")
        with open(os.path.join(folder, "source_coordsystem.json"), "w", encoding="utf-8") as file:
            json.dump({"iEEGCoordinateSystem": brain, "iEEGCoordinateUnits": "mm"}, file)

        def in_words(text: str) -> str:
            return text.replace(path, "source").replace(folder + os.sep, "")

        def is_of_another(record: logging.LogRecord) -> bool:
            return folder not in record.getMessage()

        logger = logging.getLogger("conus")
        logger.addFilter(is_of_another)  # the notes of this file are warnings
        try:
            poses = read_poses(path, atlas=atlas)
            return poses, [in_words(note) for note in poses.notes]
        except Error as error:
            raise type(error)(in_words(str(error))) from None
        finally:
            logger.removeFilter(is_of_another)
