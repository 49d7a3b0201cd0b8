# SPDX-License-Identifier: BSD-3-Clause
"""Which brain areas and fibre pathways are in that cone, where exactly, and how surely?

>>> import numpy, conus
>>> labels = numpy.zeros((20, 20, 20), "u1")
>>> labels[:10], labels[10:] = 1, 2
>>> affine = numpy.diag([2, 2, 2, 1])
>>> atlas = conus.load(labels, affine, labels={1: "left", 2: "right"})
>>> hits = atlas.select(origin=(-60, 19, 19), toward=(19, 19, 19), angle=20)
>>> hits[0].name, round(hits[0].distance_mm)
('left', 59)

Positions are RAS mm, or in the space that a selector was given, and angles degrees; but ``results``
are the library's own structs, with world positions; angles are in degrees.
"""
from ._answers import Answers, Hit, Selection, Step, Track
from ._atlas import Atlas, InstalledAtlas, Placement, Selector, atlases, load
from ._conus import ffi as _ffi, lib as _lib
from ._library import (
    ArgumentError,
    CancelledError,
    DataError,
    Error,
    FileError,
    GLError,
    OutOfMemoryError,
    PoseWarning,
    UnsupportedError,
)
from ._pose_file import Poses, pose_formats, read_poses
from ._picture import Picture, Renderer, transfer_presets
from ._plan import Plan, errors
from ._probe import Contacts, Probe, brain_areas, read_probe
from ._program import Difference, SourceFile, Verification, cite, page, verify
from ._run import OUT, calibrate, positions, run
from ._space import Place
from ._table import Table
from ._together import Together
from ._track import Tracker
from ._tracts import Tractogram, is_tractogram

__version__ = _ffi.string(_lib.conus_version()).decode()
__all__ = [
    "Answers", "ArgumentError", "Atlas", "CancelledError", "Contacts", "DataError", "Difference", "Error", "FileError",
    "GLError", "Hit", "InstalledAtlas", "OUT", "OutOfMemoryError", "Picture", "Place", "Placement", "Plan", "PoseWarning", "Poses", "Probe", "Renderer",
    "Selection", "Selector", "SourceFile", "Step", "Table", "Together", "Track", "Tracker", "Tractogram",
    "UnsupportedError", "Verification", "atlases", "brain_areas", "calibrate", "cite", "errors", "is_tractogram", "load", "page", "pose_formats", "positions", "read_poses", "read_probe",
    "run", "transfer_presets", "verify",
]
