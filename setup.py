# SPDX-License-Identifier: BSD-3-Clause
"""The wheel: CMake builds the library and the program, and both go into the package, which opens the library by cffi.
So it is for one platform, and any Python. Where $CONUS_TARGET names a preset of zig, what lies in build/TARGET goes in."""
import os
import pathlib
import shutil
import subprocess
import sys
import sysconfig

from setuptools import setup
from setuptools.command.build_py import build_py

ROOT = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(ROOT / "python"))
import build_conus  # pylint: disable=wrong-import-position

PACKAGE = "lib/conus"
LEFT_OUT = ["TESTS", "BENCH", "MESH", "HDF5", "VIEW"]
LIBRARY = {"windows": "conus.dll", "macos-arm64": "libconus.0.dylib", "macos-x86-64": "libconus.0.dylib"}


def build(scratch):
    """Files of the package and where they are, by CMake."""
    there, stage = scratch / "cmake", scratch / "stage"
    shutil.rmtree(stage, ignore_errors=True)
    # With all of it in one folder, what CMake writes into programs finds the library there.
    subprocess.check_call([
        "cmake", "-S", ROOT, "-B", there, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
        f"-DCMAKE_C_FLAGS=-ffile-prefix-map={ROOT}=. {os.environ.get('CFLAGS', '')}",
        f"-DCMAKE_INSTALL_PREFIX={stage}", f"-DCMAKE_INSTALL_LIBDIR={PACKAGE}",
        f"-DCMAKE_INSTALL_BINDIR={PACKAGE}/bin", *(f"-DCONUS_{part}=OFF" for part in [*LEFT_OUT, "PYTHON"])])
    subprocess.check_call(["cmake", "--build", there])
    subprocess.check_call(["cmake", "--install", there, "--strip", "--component", "runtime"])
    return {name: stage / PACKAGE / name for name in ("libconus.so.0", "bin/conus")}


def built(target):
    """The same, of a preset."""
    library, program = LIBRARY.get(target, "libconus.so.0"), "conus.exe" if target == "windows" else "conus"
    return {library: ROOT / "build" / target / library, f"bin/{program}": ROOT / "build" / target / "apps" / "cli" / program}


class Build(build_py):
    def run(self):
        super().run()
        package, target = pathlib.Path(self.build_lib, "conus"), os.environ.get("CONUS_TARGET")
        scratch = pathlib.Path(self.get_finalized_command("build").build_temp).absolute()
        (package / "bin").mkdir(parents=True, exist_ok=True)
        build_conus.write_module(str(package / "_declarations.py"), [])
        for name, file in (built(target) if target else build(scratch)).items():
            shutil.copy2(file, package / name)


# With a platform, so that it is not for any.
setup(version=build_conus.version(), cmdclass={"build_py": Build},
      options={"bdist_wheel": {"plat_name": sysconfig.get_platform()}})
