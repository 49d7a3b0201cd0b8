# SPDX-License-Identifier: BSD-3-Clause
"""The wheel: CMake builds the library, the program and the module, and all three go into the package."""
import os
import pathlib
import re
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = pathlib.Path(__file__).resolve().parent
HEADER = ROOT / "include" / "conus" / "version.h"
PACKAGE = "lib/conus"
LEFT_OUT = ["TESTS", "BENCH", "MESH", "HDF5", "VIEW", "MPI"]


class CMakeBuild(build_ext):
    def run(self):
        build, stage = (pathlib.Path(self.build_temp).absolute() / name for name in ("cmake", "stage"))
        shutil.rmtree(stage, ignore_errors=True)
        # With all of it in one folder, what CMake writes into programs finds the library there.
        subprocess.check_call([
            "cmake", "-S", ROOT, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
            f"-DCMAKE_C_FLAGS=-ffile-prefix-map={ROOT}=. {os.environ.get('CFLAGS', '')}",
            f"-DCMAKE_INSTALL_PREFIX={stage}", f"-DCMAKE_INSTALL_LIBDIR={PACKAGE}",
            f"-DCMAKE_INSTALL_BINDIR={PACKAGE}/bin", f"-DCONUS_PYTHON_FOLDER={PACKAGE}",
            f"-DCONUS_PYTHON_EXECUTABLE={sys.executable}", *(f"-DCONUS_{part}=OFF" for part in LEFT_OUT)])
        subprocess.check_call(["cmake", "--build", build])
        for component in ("runtime", "python"):
            subprocess.check_call(["cmake", "--install", build, "--strip", "--component", component])
        package = pathlib.Path(self.build_lib, "conus")
        (package / "bin").mkdir(parents=True, exist_ok=True)
        for name in ("_conus.abi3.so", "libconus.so.0", "bin/conus"):
            shutil.copy2(stage / PACKAGE / name, package / name)


setup(
    version=".".join(re.findall(r"#define CONUS_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", HEADER.read_text())),
    ext_modules=[Extension("conus._conus", [], py_limited_api=True)],
    cmdclass={"build_ext": CMakeBuild},
    options={"bdist_wheel": {"py_limited_api": "cp39"}},
)
