# SPDX-License-Identifier: BSD-3-Clause
"""The wheel. Its module is built against the libconus that pkg-config finds, and needs it where it runs."""
import pathlib
import re

from setuptools import setup

HEADER = pathlib.Path(__file__).resolve().parent.parent / "include" / "conus" / "version.h"

setup(
    version=".".join(re.findall(r"#define CONUS_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", HEADER.read_text())),
    cffi_modules=["build_conus.py:wheel_builder"],
    options={"bdist_wheel": {"py_limited_api": "cp39"}},
)
