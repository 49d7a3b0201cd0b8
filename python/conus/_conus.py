# SPDX-License-Identifier: BSD-3-Clause
"""The library: beside this file in a wheel, in the build or where it is installed, else the system's."""
from __future__ import annotations

import os
import sys
from typing import Any

from ._declarations import FOLDERS, VERSION, ffi

_NAME = {"win32": "conus.dll", "darwin": "libconus.0.dylib"}.get(sys.platform, "libconus.so.0")


def _open_library() -> Any:
    here = os.path.dirname(os.path.abspath(__file__))
    paths = (os.path.join(here, folder, _NAME) for folder in FOLDERS)
    path = next(filter(os.path.exists, paths), _NAME)
    try:
        opened = ffi.dlopen(path)
    except OSError as error:
        raise ImportError(f"conus: the library cannot be opened: {error}") from None
    found = ffi.string(opened.conus_version()).decode()
    if found != VERSION:
        raise ImportError(f"conus: {path} is of version {found}, wanted is {VERSION}, the package's own")
    return opened


lib = _open_library()
__all__ = ["ffi", "lib"]
