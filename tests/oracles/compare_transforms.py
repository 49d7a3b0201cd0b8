#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""--atlas-transform against numpy: matrices in each format, written by this script from the formats' descriptions or by
scipy and nibabel, move AAL; then `conus info` has it where numpy puts it, and a pose under the same affine has the same
answer, with lengths and volumes as the affine scales them.

usage: compare_transforms.py CONUS; exit 77 = skipped."""
import csv
import importlib.util
import io
import json
import os
import subprocess
import sys
import tempfile

ATLAS = "/usr/share/mricron/templates/aal.nii.gz"
HEAD = "/usr/share/mricron/templates/ch2.nii.gz"

try:
    import nibabel
    import numpy as np
except ImportError:
    print("skipped: no python3-nibabel")
    sys.exit(77)
if not os.path.exists(ATLAS):
    print("skipped: no mricron-data")
    sys.exit(77)

FLIP = np.diag([-1.0, -1, 1, 1])


def run(conus, *words):
    return subprocess.run([conus, *words], check=True, stdout=subprocess.PIPE, universal_newlines=True).stdout


def rows(conus, *words):
    return list(csv.DictReader(io.StringIO(run(conus, *words, "--format", "tsv", "--quiet")), delimiter="\t"))


def placed(conus, *words):
    """Where the voxels lie by the sidecar of an answer."""
    answer = json.loads(run(conus, "query", ATLAS, "--origin=0,0,200", "--direction=0,0,-1", "--format", "json",
                            "--quiet", *words))
    return np.array(answer["Atlas"]["volumes"][0]["world_from_voxel"])


def turn(axis, angle):
    """A right-handed turn about an axis, as a 3 x 3 matrix."""
    c, s = np.cos(angle), np.sin(angle)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(3)
    matrix[i, i] = matrix[j, j] = c
    matrix[j, i], matrix[i, j] = s, -s
    return matrix


def affine(linear, translation):
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = linear, translation
    return matrix


def about(linear, centre, translation):
    """p -> L (p - c) + c + t, of LPS, in RAS."""
    centre = np.array(centre)
    return FLIP @ affine(linear, centre + translation - linear @ centre) @ FLIP


def words_of(numbers):
    return " ".join(repr(float(x)) for x in np.ravel(numbers))


def itk(name, parameters, fixed, number=0):
    return f"#Transform {number}\nTransform: {name}_double_3_3\nParameters: {words_of(parameters)}\n" \
           f"FixedParameters: {words_of(fixed)}\n"


ITK_HEAD = "#Insight Transform File V1.0\n"


def cases(folder):
    """(words of the option, the matrix from poses to atlas)."""
    random = np.random.default_rng(11)
    linear = np.eye(3) + random.uniform(-0.2, 0.2, (3, 3))
    shift, centre = random.uniform(-20, 20, 3), random.uniform(-30, 30, 3)
    angles = random.uniform(-0.5, 0.5, 3)

    def write(name, text):
        path = os.path.join(folder, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    general = about(linear, centre, shift)
    text = ITK_HEAD + itk("AffineTransform", [*np.ravel(linear), *shift], centre)
    yield write("affine.tfm", text), general
    yield write("affine2.txt", text.replace("AffineTransform_double", "MatrixOffsetTransformBase_float")), general
    yield write("affine3.tfm", text) + ",inverse", np.linalg.inv(general)
    x, y, z = (turn(axis, angle) for axis, angle in enumerate(angles))
    euler = [*angles, *shift]
    yield write("euler.txt", ITK_HEAD + itk("Euler3DTransform", euler, centre)), about(z @ x @ y, centre, shift)
    yield write("zyx.txt", ITK_HEAD + itk("Euler3DTransform", euler, [*centre, 1])), about(z @ y @ x, centre, shift)
    axis = random.normal(size=3)
    axis /= np.linalg.norm(axis)
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    rotation = np.eye(3) + np.sin(0.7) * cross + (1 - np.cos(0.7)) * cross @ cross  # Rodrigues
    versor = [*(np.sin(0.35) * axis), *shift]
    rigid = about(rotation, centre, shift)
    yield write("versor.tfm", ITK_HEAD + itk("VersorRigid3DTransform", versor, centre)), rigid
    yield write("similar.tfm", ITK_HEAD + itk("Similarity3DTransform", [*versor, 1.2], centre)), \
        about(1.2 * rotation, centre, shift)
    yield write("shift.tfm", ITK_HEAD + itk("TranslationTransform", shift, [])), about(np.eye(3), centre, shift)
    both = ITK_HEAD + "#Transform 0\nTransform: CompositeTransform_double_3_3\n" + \
        itk("AffineTransform", [*np.ravel(linear), *shift], centre, 1) + itk("VersorRigid3DTransform", versor, centre, 2)
    yield write("both.txt", both), general @ rigid  # points go through the last one first
    matlab = b""
    for name, values in (("AffineTransform_double_3_3", [*np.ravel(linear), *shift]), ("fixed", centre)):
        matlab += np.array([0, len(values), 1, 0, len(name) + 1], "<i4").tobytes() + name.encode() + b"\0"
        matlab += np.array(values, "<f8").tobytes()
    with open(os.path.join(folder, "0GenericAffine.mat"), "wb") as file:
        file.write(matlab)
    yield os.path.join(folder, "0GenericAffine.mat"), general
    if importlib.util.find_spec("scipy"):
        import scipy.io
        path = os.path.join(folder, "scipy.mat")
        scipy.io.savemat(path, {"AffineTransform_double_3_3": np.array([[*np.ravel(linear), *shift]]).T,
                                "fixed": np.array([centre]).T}, format="4")
        yield path, general
    yield write("plain.txt", "# RAS mm\n" + "\n".join(words_of(row) for row in general) + "\n"), general
    yield write("to.xfm", "MNI Transform File\n% by hand\n\nTransform_Type = Linear;\nLinear_Transform =\n" +
                "\n".join(words_of(row) for row in general[:3]) + ";\n"), general
    subject = nibabel.Nifti1Image(np.zeros((100, 110, 90), "u1"),
                                  affine(turn(2, 0.2) @ np.diag([-1.5, 2, 2.5]), (70, -90, -80)))
    subject.to_filename(os.path.join(folder, "subject.nii"))
    subject = nibabel.load(os.path.join(folder, "subject.nii"))  # whose matrix is rounded
    template = nibabel.load(HEAD)
    for kind, matrix in ((1, general), (0, np.linalg.inv(template.affine) @ general @ subject.affine)):
        volumes = ""
        for which, image in (("src", subject), ("dst", template)):
            spacing = np.linalg.norm(image.affine[:3, :3], axis=0)
            middle = image.affine @ [*(np.array(image.shape[:3]) / 2), 1]
            volumes += f"{which} volume info\nvalid = 1  # volume info valid\nfilename = x.nii\n"
            volumes += f"volume = {' '.join(map(str, image.shape[:3]))}\nvoxelsize = {words_of(spacing)}\n"
            for a in range(3):
                volumes += f"{'xyz'[a]}ras = {words_of(image.affine[:3, a] / spacing[a])}\n"
            volumes += f"cras = {words_of(middle[:3])}\n"
        yield write(f"{kind}.lta", f"# transform file\n\ntype      = {kind} # kind\nnxforms   = 1\nmean      = 0 0 0\n"
                    "sigma     = 10000\n1 4 4\n" + "\n".join(words_of(row) for row in matrix) + "\n" + volumes), general

    def flirt(image):  # voxel -> FLIRT's mm
        size = np.linalg.norm(image.affine[:3, :3], axis=0)
        scale = np.diag([*size, 1.0])
        if np.linalg.det(image.affine) > 0:
            scale[0, 0], scale[0, 3] = -size[0], size[0] * (image.shape[0] - 1)
        return scale

    fsl = flirt(template) @ np.linalg.inv(template.affine) @ general @ subject.affine @ np.linalg.inv(flirt(subject))
    yield write("flirt.mat", "\n".join(words_of(row) + "  " for row in fsl) + "\n") + \
        f",from={folder}/subject.nii,to={HEAD}", general


def main():
    conus = sys.argv[1]
    home = nibabel.load(ATLAS).affine
    compared = 0
    with tempfile.TemporaryDirectory() as folder:
        for option, matrix in cases(folder):
            place = placed(conus, "--atlas-transform", option)
            assert np.allclose(place, np.linalg.inv(matrix) @ home, rtol=0, atol=1e-6), (option, place)
            compared += 1
        # a turn and a scale keep a cone's shape: the same rows, lengths by the scale
        scale = 1.25
        similar = affine(scale * turn(0, 0.3) @ turn(2, -0.8), (10, -20, 15))
        path = os.path.join(folder, "similar.txt")
        np.savetxt(path, similar)
        back = np.linalg.inv(similar)
        point = [words_of((back @ [*p, 1])[:3]).replace(" ", ",") for p in ((-90.3, 20.7, 20.1), (0.2, -10.4, 10.3))]
        up = words_of(np.linalg.inv(similar[:3, :3]) @ (0, 0, 1)).replace(" ", ",")
        moved = rows(conus, "query", ATLAS, "--atlas-transform", path, f"--origin={point[0]}", f"--toward={point[1]}",
                     f"--up={up}", "--angle=20", "--layers=all")
        plain = rows(conus, "query", ATLAS, "--origin=-90.3,20.7,20.1", "--toward=0.2,-10.4,10.3", "--up=0,0,1", "--angle=20",
                     "--layers=all")
        assert [row["name"] for row in moved] == [row["name"] for row in plain]
        for a, b in zip(moved, plain):
            assert a["pixels"] == b["pixels"] and a["voxels"] == b["voxels"], (a, b)
            for name, factor in (("distance_mm", scale), ("entry_mm", scale), ("volume_mm3", scale ** 3),
                                 ("fraction", 1), ("share", 1)):
                if b[name] != "n/a":
                    assert np.isclose(float(a[name]) * factor, float(b[name]), rtol=1e-6), (name, a, b)
        first, second = (os.path.join(folder, name) for name in ("similar.txt", "affine.tfm"))
        place = placed(conus, "--atlas-transform", first, "--atlas-transform", second)
        general = dict(cases(folder))[second]
        assert np.allclose(place, np.linalg.inv(general @ similar) @ home, atol=1e-6)
    print(f"{compared} files place AAL as numpy does; {len(moved)} rows of a moved pose are those of the other")


if __name__ == "__main__":
    main()
