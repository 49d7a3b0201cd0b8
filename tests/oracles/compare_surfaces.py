#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""conus mesh on AAL, read by nibabel: every file is GIFTI with its area's name and colour, and its surface encloses what
numpy counts in the voxels. A volume that is flipped and turned gives the same surfaces, moved likewise.
Every fourth surface is measured, all of them in scripts/test --long.

    compare_surfaces.py CONUS
"""
import os
import subprocess
import sys
import tempfile

SKIP = 77
try:
    import nibabel
    import numpy
except ImportError:
    print("skipped: no nibabel")
    sys.exit(SKIP)

from sample import every

AAL = "/usr/share/mricron/templates/aal.nii.gz"
VOLUME_SLACK, SMALL_VOLUME_SLACK, LARGE_MM3, CENTROID_SLACK_MM = 0.03, 0.06, 1000.0, 0.5


def run(conus, *words):
    return subprocess.run([conus, *words], check=True, capture_output=True, text=True).stdout


def measure(points, triangles):
    """Enclosed volume and its centroid, and whether every edge is passed once in each direction."""
    points = points.astype(float)
    p = points[triangles] - points.mean(0)
    volumes = numpy.einsum("ij,ij->i", p[:, 0], numpy.cross(p[:, 1], p[:, 2])) / 6
    centroid = (volumes[:, None] * p.sum(1) / 4).sum(0) / volumes.sum() + points.mean(0)
    edges = numpy.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).astype(numpy.int64)
    there = edges[:, 0] * len(points) + edges[:, 1]
    back = edges[:, 1] * len(points) + edges[:, 0]
    closed = len(numpy.unique(there)) == len(there) and numpy.array_equal(numpy.sort(there), numpy.sort(back))
    return volumes.sum(), centroid, closed


def check(folder, image, names, colours):
    labels = numpy.asarray(image.dataobj)
    cell = abs(numpy.linalg.det(image.affine[:3, :3]))
    files = sorted(os.listdir(folder))
    assert len(files) == len(names), (len(files), len(names))
    worst, measured = [0.0, 0.0], every(4, files)
    for file in files:
        gifti = nibabel.load(os.path.join(folder, file))
        label = int(file.split("_")[0])
        entry = gifti.labeltable.labels[0]
        assert gifti.labeltable.get_labels_as_dict() == {label: names[label]}, file
        assert file == "%d_%s.gii" % (label, names[label]), file
        assert gifti.meta["Name"] == names[label]
        colour = "#%02x%02x%02x" % tuple(round(255 * c) for c in entry.rgba[:3])
        assert colour == colours[label], (file, colour, colours[label])
        if file not in measured:
            continue
        points, triangles = gifti.agg_data("pointset"), gifti.agg_data("triangle")
        volume, centroid, closed = measure(points, triangles)
        voxels = numpy.argwhere(labels == label)
        wanted = len(voxels) * cell
        place = image.affine[:3, :3] @ voxels.mean(0) + image.affine[:3, 3]
        off = numpy.linalg.norm(centroid - place)
        slack = VOLUME_SLACK if wanted > LARGE_MM3 else SMALL_VOLUME_SLACK
        assert closed, file
        assert abs(volume / wanted - 1) <= slack, (file, volume, wanted)
        assert off <= CENTROID_SLACK_MM, (file, off)
        if wanted > LARGE_MM3:
            worst = [max(worst[0], abs(volume / wanted - 1)), max(worst[1], off)]
    return worst


def turned(image):
    """The same brain on a grid whose i grows to the left, and which is turned by 0.3 about z in the world."""
    data = numpy.asarray(image.dataobj)[::-1]
    flip = numpy.diag([-1.0, 1, 1, 1])
    flip[0, 3] = data.shape[0] - 1
    turn = numpy.eye(4)
    turn[:2, :2] = [[numpy.cos(0.3), -numpy.sin(0.3)], [numpy.sin(0.3), numpy.cos(0.3)]]
    return nibabel.Nifti1Image(data, turn @ image.affine @ flip)


def main():
    conus = sys.argv[1]
    if not os.path.exists(AAL):
        print("skipped: no mricron-data")
        return SKIP
    with tempfile.TemporaryDirectory() as folder:
        table = [row.split("\t") for row in run(conus, "info", AAL, "--format", "tsv").splitlines()]
        column = {name: i for i, name in enumerate(table[0])}
        names = {int(row[column["index"]]): row[column["name"]] for row in table[1:]}
        colours = {int(row[column["index"]]): row[column["color"]] for row in table[1:]}
        image = nibabel.load(AAL)
        out = os.path.join(folder, "out")
        run(conus, "mesh", AAL, "-o", out)
        print("AAL: largest error of a volume %.4f, of a centroid %.3f mm" % tuple(check(out, image, names, colours)))
        image = turned(image)
        path = os.path.join(folder, "turned.nii.gz")
        nibabel.save(image, path)
        out = os.path.join(folder, "turned")
        run(conus, "mesh", path, "-o", out, "--labels", AAL.replace(".nii.gz", ".nii.txt"), "--quiet")
        print("turned: largest error of a volume %.4f, of a centroid %.3f mm" %
              tuple(check(out, nibabel.load(path), names, colours)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
