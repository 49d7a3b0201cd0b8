#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What a user would pick instead of `conus batch`, on the same poses: peers.py CONUS [ATLAS] [CONES].

numpy and nibabel walk all rays of a cone through the voxels' planes at once, exactly; vtkCellLocator looks for the first
triangle of each ray on the surfaces that `conus mesh` makes. Processor time per cone, without loading, and how many cones
have the same pixels of every area as conus. Needs nibabel, numpy and VTK for Python.
"""
import csv
import os
import resource
import subprocess
import sys
import tempfile
import time

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[name] = "1"
import nibabel
import numpy as np

N, ANGLE = 16, 5.0


def make_poses(count, affine, shape):
    random = np.random.default_rng(2010)
    centre = affine[:3, :3] @ ((np.array(shape) - 1) / 2) + affine[:3, 3]
    z, turn, far = random.uniform(-1, 1, count), random.uniform(0, 2 * np.pi, count), random.uniform(200, 300, count)
    around = np.stack([np.sqrt(1 - z * z) * np.cos(turn), np.sqrt(1 - z * z) * np.sin(turn), z], 1)
    target = centre + random.uniform(-0.25, 0.25, (count, 3)) * np.array(shape) @ np.abs(affine[:3, :3])
    return np.round(np.hstack([centre + around * far[:, None], target]), 3)


def rays_of(pose):
    """Unit directions of the pixels in the circle (docs/model.md, Eq. 2 and 3)."""
    back = pose[:3] - pose[3:]
    back /= np.linalg.norm(back)
    up = np.array([0.0, 0, 1]) if abs(back[2]) <= 0.999 else np.array([0.0, 1, 0])
    right = np.cross(up, back)
    right /= np.linalg.norm(right)
    over = np.cross(back, right)
    u, v = np.meshgrid((2 * np.arange(N) + 1) / N - 1, (2 * np.arange(N) + 1) / N - 1)
    inside = u * u + v * v <= 1
    slope = np.tan(np.radians(ANGLE) / 2)
    rays = slope * u[inside][:, None] * right + slope * v[inside][:, None] * over - back
    return rays / np.linalg.norm(rays, axis=1)[:, None]


def numpy_cone(labels, voxel_from_world, pose):
    """The first label on each ray, from the order in which it crosses the planes between the voxels (Eq. 5)."""
    origin = voxel_from_world[:3, :3] @ pose[:3] + voxel_from_world[:3, 3]
    step = rays_of(pose) @ voxel_from_world[:3, :3].T
    with np.errstate(divide="ignore", invalid="ignore"):
        times = [(np.arange(n + 1) - 0.5 - o) / step[:, a, None] for a, (n, o) in enumerate(zip(labels.shape, origin))]
    times = np.sort(np.maximum(np.concatenate(times, axis=1), 0), axis=1)
    middle = (times[:, 1:] + times[:, :-1]) / 2
    cells = np.floor(origin + middle[:, :, None] * step[:, None, :] + 0.5).astype(np.int32)
    inside = np.all((cells >= 0) & (cells < labels.shape), axis=2) & (times[:, 1:] > times[:, :-1])
    cells[~inside] = 0
    hit = np.where(inside, labels[cells[..., 0], cells[..., 1], cells[..., 2]], 0)
    return hit[np.arange(len(hit)), np.argmax(hit != 0, axis=1)]


def count(found):
    return {int(label): int(n) for label, n in zip(*np.unique(found, return_counts=True)) if label}


def conus_rows(conus, atlas, poses, folder, name):
    """Pixels by cone and label, and processor seconds."""
    path, out = os.path.join(folder, name + ".tsv"), os.path.join(folder, name + "-rows.tsv")
    with open(path, "w") as file:
        file.write("x\ty\tz\ttx\tty\ttz\n")
        file.writelines("\t".join("%.3f" % x for x in pose) + "\n" for pose in poses)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([conus, "batch", atlas, "--poses", path, "--angle", str(ANGLE), "--resolution", "16", "--threads", "1", "-q", "-o", out], check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    answers = [{} for _ in poses]
    with open(out) as file:
        for row in csv.DictReader(file, delimiter="\t"):
            if row["kind"] == "area" and row["pixels"] != "0":
                answers[int(row["query"]) - 1][int(row["index"])] = int(row["pixels"])
    return answers, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def conus_speed(conus, atlas, poses, folder, name):
    """Answers, and seconds per cone without what loading takes: of 100 times the poses less those of one."""
    answers, _ = conus_rows(conus, atlas, poses, folder, name)
    _, once = conus_rows(conus, atlas, poses[:1], folder, name + "-one")
    _, often = conus_rows(conus, atlas, np.tile(poses, (100, 1)), folder, name + "-often")
    return answers, (often - once) / (100 * len(poses))


def report(what, seconds, conus_seconds, answers, wanted):
    same = sum(a == b for a, b in zip(answers, wanted))
    print("%-24s %9.3f ms per cone, conus %.4f ms, ratio %.0f; %d of %d cones have the same pixels"
          % (what, 1e3 * seconds, 1e3 * conus_seconds, seconds / conus_seconds, same, len(wanted)))


def with_numpy(conus, atlas, poses, labels, affine, folder):
    wanted, conus_seconds = conus_speed(conus, atlas, poses, folder, "volume")
    start = time.process_time()
    answers = [count(numpy_cone(labels, np.linalg.inv(affine), pose)) for pose in poses]
    report("numpy, nibabel", (time.process_time() - start) / len(poses), conus_seconds, answers, wanted)


def with_vtk(conus, atlas, poses, folder):
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
    meshes = os.path.join(folder, "meshes")
    subprocess.run([conus, "mesh", atlas, "-o", meshes, "-q"], check=True)
    wanted, conus_seconds = conus_speed(conus, meshes, poses, folder, "mesh")
    points, cells, labels, offset = [], [], [], 0
    for name in sorted(os.listdir(meshes)):
        vertices, triangles = nibabel.load(os.path.join(meshes, name)).agg_data()
        points.append(vertices)
        cells.append(triangles + offset)
        labels.append(np.full(len(triangles), int(name.split("_")[0])))
        offset += len(vertices)
    points, cells, labels = np.concatenate(points), np.concatenate(cells), np.concatenate(labels)
    surface, corners, faces = vtk.vtkPolyData(), vtk.vtkPoints(), vtk.vtkCellArray()
    corners.SetData(numpy_to_vtk(points.astype(np.float32), deep=True))
    faces.SetData(3, numpy_to_vtkIdTypeArray(cells.astype(np.int64).ravel(), deep=True))
    surface.SetPoints(corners)
    surface.SetPolys(faces)
    locator = vtk.vtkCellLocator()
    locator.SetDataSet(surface)
    locator.BuildLocator()
    start = time.process_time()
    answers = []
    t, x, coordinates, part, cell = vtk.mutable(0), [0.0] * 3, [0.0] * 3, vtk.mutable(0), vtk.mutable(0)
    for pose in poses:
        ends = pose[:3] + 1000 * rays_of(pose)
        found = [labels[int(cell)] if locator.IntersectWithLine(pose[:3], end, 1e-9, t, x, coordinates, part, cell) else 0
                 for end in ends]
        answers.append(count(found))
    report("vtkCellLocator", (time.process_time() - start) / len(poses), conus_seconds, answers, wanted)


def main():
    conus = sys.argv[1]
    atlas = sys.argv[2] if len(sys.argv) > 2 else "/usr/share/mricron/templates/aal.nii.gz"
    image = nibabel.load(atlas)
    labels = np.asarray(image.dataobj).astype(np.int32)
    poses = make_poses(int(sys.argv[3]) if len(sys.argv) > 3 else 100, image.affine, labels.shape)
    with tempfile.TemporaryDirectory() as folder:
        with_numpy(conus, atlas, poses, labels, image.affine, folder)
        with_vtk(conus, atlas, poses, folder)


if __name__ == "__main__":
    main()
