#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Composites that ITK itself writes at random (itk_points.cpp, compiled here), of affines, fields and B-splines: ITK and
conus take points to the same places, in double precision within 1e-9 mm, in single within ITK's own rounding. Then 10^6
points through an affine and two fields, and the time of both. Only in scripts/test --long: ITK's headers take minutes.

usage: compare_itk.py DUMP_POINTS CONUS_HDF5 [COUNT]: COUNT random files, else 200; exit 77 = skipped."""
import glob
import os
import resource
import subprocess
import sys
import tempfile

from sample import LONG

LIBRARIES = ["ITKIOTransformHDF5", "ITKIOTransformBase", "ITKTransformFactory", "ITKTransform", "ITKCommon",
             "ITKVNLInstantiation", "itkvnl_algo", "itkvnl", "itksys"]


def skip(words):
    print(f"skipped: {words}")
    sys.exit(77)


try:
    import numpy as np
except ImportError:
    skip("no python3-numpy")


def compiled(folder):
    """The program, by the newest ITK in /usr/include."""
    headers = sorted(glob.glob("/usr/include/ITK-*"))
    if not headers:
        skip("no libinsighttoolkit5-dev")
    version = headers[-1].split("ITK-")[1]
    program = os.path.join(folder, "itk_points")
    source = os.path.join(os.path.dirname(os.path.abspath(__file__)), "itk_points.cpp")
    command = [os.environ.get("CXX", "c++"), "-std=c++17", "-O1", "-w", f"-I{headers[-1]}", source, "-o", program]
    subprocess.run(command + [f"-l{name}-{version}" for name in LIBRARIES], check=True)
    return program, version


def moved(dump, path, points):
    """Where conus takes them, and the processor's seconds."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([dump, path], input=np.ascontiguousarray(points).tobytes(), capture_output=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert done.returncode == 0, (path, done.stderr)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return np.frombuffer(done.stdout).reshape(-1, 3), seconds


def main():
    dump, os.environ["CONUS_HDF5"] = map(os.path.abspath, sys.argv[1:3])
    if not LONG and len(sys.argv) < 4:
        skip("ITK's headers take minutes to compile: CONUS_TEST_LONG=1")
    count = int(sys.argv[3]) if len(sys.argv) > 3 else 200
    with tempfile.TemporaryDirectory() as folder:
        program, version = compiled(folder)
        subprocess.run([program, str(count), folder], check=True)
        worst = [0, 0]
        for i in range(count):
            points = np.fromfile(os.path.join(folder, f"{i}.points")).reshape(-1, 6)
            got, _ = moved(dump, os.path.join(folder, f"{i}.h5"), points[:, :3])
            error = np.abs(got - points[:, 3:]).max(axis=1)
            worst[i % 2] = max(worst[i % 2], error.max())
            assert error.max() <= (1e-9, 1e-3)[i % 2], (i, error.max(), np.flatnonzero(error > 1e-9))
        large, table = os.path.join(folder, "large.h5"), os.path.join(folder, "large.points")
        seconds = float(subprocess.run([program, "1000000", large, table], check=True, capture_output=True).stdout)
        points = np.fromfile(table).reshape(-1, 6)
        got, ours = moved(dump, large, points[:, :3])
        _, opening = moved(dump, large, points[:1, :3])
        error = np.abs(got - points[:, 3:]).max()
        assert error <= 1e-5, error
    print(f"{count} composites of ITK {version}: double within {worst[0]:.1e} mm, single within {worst[1]:.1e}; 10^6 points "
          f"through two fields within {error:.1e} mm: {ours - opening:.2f} s, by ITK {seconds:.2f} s, opening {opening:.2f} s")


if __name__ == "__main__":
    main()
