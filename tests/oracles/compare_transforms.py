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

    for image, name in ((subject, "anatomical"), (template, "movable")):
        kept = nibabel.MGHImage(np.zeros(image.shape[:3], "u1"), image.affine)
        kept.to_filename(os.path.join(folder, name + ".mgz"))
    anatomical, movable = (nibabel.load(f"{folder}/{name}.mgz") for name in ("anatomical", "movable"))
    tkr = movable.header.get_vox2ras_tkr() @ np.linalg.inv(movable.affine) @ general @ anatomical.affine \
        @ np.linalg.inv(anatomical.header.get_vox2ras_tkr())
    yield write("register.dat", "bert\n1.0\n1.0\n0.15\n" + "\n".join(words_of(row) for row in tkr) + "\nround\n") + \
        f",from={folder}/anatomical.mgz,to={folder}/movable.mgz", general

    def flirt(image):  # voxel -> FLIRT's mm
        size = np.linalg.norm(image.affine[:3, :3], axis=0)
        scale = np.diag([*size, 1.0])
        if np.linalg.det(image.affine) > 0:
            scale[0, 0], scale[0, 3] = -size[0], size[0] * (image.shape[0] - 1)
        return scale

    fsl = flirt(template) @ np.linalg.inv(template.affine) @ general @ subject.affine @ np.linalg.inv(flirt(subject))
    yield write("flirt.mat", "\n".join(words_of(row) + "  " for row in fsl) + "\n") + \
        f",from={folder}/subject.nii,to={HEAD}", general


def spline_weights(t):
    """Of the four nodes around a place that is t behind the second of them: the cubic B-spline at their distances."""
    distance = np.abs(t + np.array([1.0, 0, -1, -2]))
    return np.where(distance < 1, (4 - 6 * distance ** 2 + 3 * distance ** 3) / 6, (2 - distance) ** 3 / 6)


def spline_point(point, dim, origin, spacing, direction, coefficients):
    """Where ITK's B-spline takes a point of RAS; a point outside of 1 to dim - 2 stays."""
    index = np.linalg.solve(direction * spacing, FLIP[:3, :3] @ point - origin)
    if np.any(index < 1) or np.any(index > np.array(dim) - 2):
        return np.array(point)
    first = np.minimum(np.floor(index).astype(int) - 1, np.array(dim) - 4)
    weights = [spline_weights(index[a] - first[a] - 1) for a in range(3)]
    moved = np.zeros(3)
    for c in range(3):
        block = coefficients[c].reshape(dim[::-1])  # the last index fastest: k, j, i
        near = block[first[2]:first[2] + 4, first[1]:first[1] + 4, first[0]:first[0] + 4]
        moved[c] = np.einsum("kji,k,j,i", near, weights[2], weights[1], weights[0])
    return point + FLIP[:3, :3] @ moved


def check_spline(conus, folder):
    """Contacts of a spline's atlas, and where numpy takes them; another affine of the file comes before. Gives how
    many."""
    random = np.random.default_rng(12)
    dim, spacing = [7, 8, 9], np.array([40.0, 41, 38])
    direction = turn(2, 0.1) @ turn(0, -0.2)
    origin = -direction * spacing @ ((np.array(dim) - 1) / 2)
    coefficients = random.uniform(-6, 6, (3, int(np.prod(dim))))
    shift = np.array([3.0, -2, 4])
    path = os.path.join(folder, "spline.tfm")
    with open(path, "w", encoding="utf-8") as file:
        file.write(ITK_HEAD + "Transform: CompositeTransform_double_3_3\n" +
                   itk("BSplineTransform", coefficients, [*dim, *origin, *spacing, *np.ravel(direction)], 1) +
                   itk("TranslationTransform", FLIP[:3, :3] @ shift, [], 2))
    poses = os.path.join(folder, "poses.tsv")
    with open(poses, "w", encoding="utf-8") as file:
        file.write("x\ty\tz\ttx\tty\ttz\n")
        for _ in range(40):
            aim = random.normal(size=3)
            start = 160 * aim / np.linalg.norm(aim)
            file.write("\t".join(words_of(np.append(start, random.uniform(-20, 20, 3))).split()) + "\n")
    count = 0
    for row in rows(conus, "batch", ATLAS, "--poses", poses, "--angle", "10", "--atlas-transform", path):
        if row["contact_x"] != "n/a":
            contact, own = (np.array([float(row[kind + a]) for a in "xyz"]) for kind in ("contact_", "atlas_"))
            wanted = spline_point(contact + shift, dim, origin, spacing, direction, coefficients)
            assert np.allclose(own, wanted, rtol=0, atol=2e-6), (contact, own, wanted)
            count += 1
    assert count > 100
    return count


def main():
    conus = sys.argv[1]
    home = nibabel.load(ATLAS).affine
    compared = 0
    with tempfile.TemporaryDirectory() as folder:
        for option, matrix in cases(folder):
            place = placed(conus, "--atlas-transform", option)
            rounded = 1e-5 if ".mgz" in option else 1e-6  # nibabel multiplies MGH's matrices in single precision
            assert np.allclose(place, np.linalg.inv(matrix) @ home, rtol=0, atol=rounded), (option, place)
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
        contacts = check_spline(conus, folder)
    print(f"{compared} files place AAL as numpy does; {len(moved)} rows of a moved pose are those of the other; "
          f"{contacts} contacts go through a B-spline as numpy has it")


if __name__ == "__main__":
    main()
