#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Deformation fields against numpy: fields of a smooth map, written as ITK, SPM and FSL describe them, move AAL and a
surface. Each voxel has the label that numpy finds for it, each centre is where numpy has it in the atlas, and each
vertex goes back to where it came from. The same map in all three formats gives the same atlas.

usage: compare_warps.py DUMP_WARPED; exit 77 = skipped."""
import os
import subprocess
import sys
import tempfile

ATLAS = "/usr/share/mricron/templates/aal.nii.gz"

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
DIM = (36, 42, 35)


def turn(axis, angle):
    """A right-handed turn about an axis, as a 4 x 4 matrix."""
    matrix = np.eye(4)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix[i, i] = matrix[j, j] = np.cos(angle)
    matrix[j, i], matrix[i, j] = np.sin(angle), -np.sin(angle)
    return matrix


def shift(*mm):
    matrix = np.eye(4)
    matrix[:3, 3] = mm
    return matrix


def apply(matrix, points):
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def nodes(dim=DIM):
    """Indices of all voxels, [x, y, z, 3]."""
    return np.stack(np.meshgrid(*(np.arange(n, dtype=float) for n in dim), indexing="ij"), -1)


def wave(points):
    """A smooth map of points to points, mm: ways of some mm, and slopes below 0.5."""
    x, y, z = np.moveaxis(points, -1, 0)
    way = np.stack([5 * np.sin(y / 17 + 1) * np.cos(z / 23), 4 * np.sin(x / 15) + 2 * np.cos(z / 19 + 2),
                    6 * np.cos(x / 21 + y / 29)], -1)
    return points + way


class Field:
    """A field as numpy has it: where nodes go, RAS mm, as the file's float32 say; linear between nodes. Of displacements
    `beyond` takes a step between nodes to the place to which they are added."""

    def __init__(self, affine, goes, outside, beyond=np.zeros((4, 4))):
        self.affine, self.goes, self.outside, self.beyond = affine, goes, outside, beyond[:3, :3]

    def __call__(self, points):
        q = apply(np.linalg.inv(self.affine), points)
        dim = np.array(self.goes.shape[:3])
        held = np.all((q >= -0.5) & (q < dim - 0.5), -1)
        # beyond the last node the vector is that of the border; a displacement is added to the point itself
        inside = np.clip(q, 0, dim - 1)
        low = np.minimum(inside.astype(int), dim - 2)
        part = inside - low
        out = np.zeros(points.shape)
        for corner in np.ndindex(2, 2, 2):
            weight = np.prod(np.where(corner, part, 1 - part), -1)
            out += weight[..., None] * self.goes[tuple(np.moveaxis(low + corner, -1, 0))]
        out += (q - inside) @ self.beyond.T
        if self.outside == "stays":
            return np.where(held[..., None], out, points)
        return np.where(held[..., None], out, np.nan)


def save(path, data, affine, code, name=""):
    image = nibabel.Nifti1Image(data, affine)
    image.header["intent_code"] = code
    image.header["intent_name"] = name
    image.header.set_xyzt_units("mm")
    image.to_filename(path)
    return nibabel.load(path).affine  # rounded


def itk(path, affine, goes):
    """Displacements in LPS on the grid, five dimensions, intent 1007."""
    affine = nibabel.Nifti1Image(np.zeros((2, 2, 2)), affine).affine.astype("f4").astype(float)
    places = apply(affine, nodes(goes.shape[:3]))
    ways = ((goes - places) * [-1, -1, 1]).astype("f4")
    affine = save(path, ways[..., None, :], affine, 1007)
    return Field(affine, apply(affine, nodes(goes.shape[:3])) + ways.astype(float) * [-1, -1, 1], "stays", affine)


def spm(path, affine, goes):
    """Positions in RAS, five dimensions, called Mapping."""
    affine = save(path, goes.astype("f4")[..., None, :], affine, 1007, "Mapping")
    return Field(affine, goes.astype("f4").astype(float), "nowhere")


def flirt(image):
    """From voxels to FSL's mm."""
    size = np.linalg.norm(image.affine[:3, :3], axis=0)
    scale = np.diag([*size, 1.0])
    if np.linalg.det(image.affine) > 0:
        scale[0, 0], scale[0, 3] = -size[0], size[0] * (image.shape[0] - 1)
    return scale


def fsl(path, affine, goes, to, absolute, code):
    """Positions in the second image's mm, or what is to be added to the first one's; four dimensions."""
    save(path, np.zeros((*goes.shape[:3], 3), "f4"), affine, 0)
    own = flirt(nibabel.load(path))
    to = nibabel.load(to)
    there = flirt(to) @ np.linalg.inv(to.affine)
    here = apply(own, nodes(goes.shape[:3]))
    stored = (apply(there, goes) - (0 if absolute else here)).astype("f4")
    affine = save(path, stored, affine, code)
    there = np.linalg.inv(there)
    return Field(affine, apply(there, stored.astype(float) + (0 if absolute else here)), "nowhere",
                 0 * own if absolute else there @ own)


class Dump:
    """What dump_warped says of an atlas under transforms: (file, from, to, grid, vectors)."""

    def __init__(self, program, atlas, folder, *transforms):
        out = os.path.join(folder, "out")
        words = [word or "-" for transform in transforms for word in (*transform, *[None] * (5 - len(transform)))]
        run = subprocess.run([program, atlas, out, *words], stdout=subprocess.PIPE, universal_newlines=True)
        lines = [line.split(" ", 1) for line in run.stdout.splitlines()]
        self.said = run.stdout
        self.notes = [rest for word, rest in lines if word == "note"]
        if run.returncode:
            self.error = next(rest for word, rest in lines if word == "error")
            return
        raw, at = open(out, "rb").read(), 0
        for word, rest in lines:
            if word == "dim":
                dim = [int(n) for n in rest.split()]
                count = int(np.prod(dim))
                self.labels = np.frombuffer(raw, "u4", count).reshape(dim, order="F")
                own = np.frombuffer(raw, "f8", 3 * count, 4 * count).reshape(dim[2], dim[1], dim[0], 3)
                self.own = own.transpose(2, 1, 0, 3)
                at = 28 * count
            elif word == "affine":
                self.affine = np.array([float(n) for n in rest.split()]).reshape(4, 4)
        self.vertices = np.frombuffer(raw, "f4", offset=at).reshape(-1, 3).astype(float)


def nearest(image, points):
    """Labels of the nearest voxels."""
    voxel = np.floor(apply(np.linalg.inv(image.affine), points) + 0.5)
    held = np.all((voxel >= 0) & (voxel < image.shape), -1)
    voxel = np.where(held[..., None], voxel, 0).astype(int)
    return np.where(held, np.asarray(image.dataobj)[tuple(np.moveaxis(voxel, -1, 0))], 0)


def parted(affine, behind=np.eye(4)):
    """The grid that the atlas, of 1 mm where affines `behind` lead, gets from nodes at `affine`: each step in so many parts
    that none is longer than 1.05 mm there, and nodes are centres still."""
    parts = np.ceil(np.linalg.norm((behind @ affine)[:3, :3], axis=0) / 1.05)
    return affine @ shift(*-(np.floor(parts / 2) / parts)) @ np.diag([*(1 / parts), 1])


def check(dump, image, place, way):
    """Voxels of the grid at `place` against numpy, which takes their centres `way`: all, of a large grid every third
    along each axis. Returns how many."""
    some = (slice(None, None, 3 if dump.labels.size > 1e6 else 1),) * 3
    points = way(apply(place, nodes(dump.labels.shape)[some]))
    assert np.allclose(dump.affine, place, rtol=0, atol=1e-9), (dump.affine, place)
    assert np.array_equal(np.isnan(dump.own[some]), np.isnan(points))
    assert np.nanmax(np.abs(dump.own[some] - points)) < 1e-6
    wanted = nearest(image, points)
    assert wanted.any() and np.array_equal(dump.labels[some], wanted), np.count_nonzero(dump.labels[some] != wanted)
    return wanted.size


def write_sphere(path, centre, radius):
    """A closed surface of 2 + 39 x 60 vertices, as OBJ."""
    rings = [(np.sin(a) * np.cos(b), np.sin(a) * np.sin(b), np.cos(a))
             for a in np.linspace(0, np.pi, 41)[1:-1] for b in np.linspace(0, 2 * np.pi, 61)[:-1]]
    points = np.array([(0, 0, 1), *rings, (0, 0, -1)]) * radius + centre
    last = len(points)
    faces = [(1, 2 + i, 2 + (i + 1) % 60) for i in range(60)]
    faces += [(last, last - 60 + (i + 1) % 60, last - 60 + i) for i in range(60)]
    for ring in range(38):
        for i in range(60):
            a, b = 2 + 60 * ring + i, 2 + 60 * ring + (i + 1) % 60
            faces += [(a, a + 60, b), (b, a + 60, b + 60)]
    with open(path, "w", encoding="utf-8") as file:
        file.write("".join("v %.9g %.9g %.9g\n" % tuple(p) for p in points))
        file.write("".join("f %d %d %d\n" % face for face in faces))
    return points


def main():
    program = sys.argv[1]
    image = nibabel.load(ATLAS)
    compared = 0
    with tempfile.TemporaryDirectory() as folder:

        def path(name):
            return os.path.join(folder, name)

        # 1. Each format on an oblique grid. Subject: turned and shifted against the atlas.
        home = turn(2, 0.2) @ turn(0, -0.1) @ shift(4, -6, 3)
        oblique = shift(-84, -112, -78) @ turn(1, 0.07) @ np.diag([4.8, 4.9, 5.0, 1])
        goes = wave(apply(home, apply(oblique, nodes())))
        subject = path("subject.nii")
        save(subject, np.zeros(DIM, "u1"), oblique, 0)
        plain = wave(apply(oblique, nodes()))
        fields = {
            "itk.nii.gz": (itk(path("itk.nii.gz"), oblique, plain), ()),
            "y_spm.nii": (spm(path("y_spm.nii"), oblique, goes), ()),
            "abs.nii.gz": (fsl(path("abs.nii.gz"), oblique, goes, ATLAS, True, 0), (subject, ATLAS)),
            "rel.nii.gz": (fsl(path("rel.nii.gz"), oblique, goes, ATLAS, False, 2006), (subject, ATLAS)),
        }
        for name, (field, images) in fields.items():
            dump = Dump(program, ATLAS, folder, (path(name), *images))
            assert not hasattr(dump, "error"), dump.said
            compared += check(dump, image, parted(field.affine), field)

        # 2. On another grid, which reaches beyond the field: there ITK leaves points where they are, and SPM has no
        # position for them.
        wide = shift(-100, -130, -95) @ np.diag([6, 6, 6.75, 1])
        save(path("wide.nii"), np.zeros((33, 40, 27), "u1"), wide, 0)
        for name in ("itk.nii.gz", "y_spm.nii"):
            dump = Dump(program, ATLAS, folder, (path(name), None, None, path("wide.nii")))
            compared += check(dump, image, wide, fields[name][0])

        # 3. Chains: affines before and behind a field, and two fields. The inverse is searched once, through the whole
        # chain.
        first, last = turn(0, 0.15) @ shift(3, 5, -4), shift(2, 1, 0) @ np.diag([1.02, 0.97, 1.03, 1])
        np.savetxt(path("first.txt"), first, fmt="%.17g")
        np.savetxt(path("last.txt"), last, fmt="%.17g")
        one, two = fields["itk.nii.gz"][0], fields["y_spm.nii"][0]
        affines = [(path("first.txt"),), (path("itk.nii.gz"),), (path("last.txt"),)]
        place = np.linalg.inv(first) @ parted(one.affine, last)
        compared += check(Dump(program, ATLAS, folder, *affines), image, place, lambda p: apply(last, one(apply(first, p))))
        affines[0] = (path("first.txt"), None, None, path("wide.nii"))
        compared += check(Dump(program, ATLAS, folder, *affines), image, wide, lambda p: apply(last, one(apply(first, p))))
        chain = [(path("itk.nii.gz"),), (path("first.txt"),), (path("y_spm.nii"),), (path("last.txt"),)]
        compared += check(Dump(program, ATLAS, folder, *chain), image, parted(one.affine, last @ first),
                          lambda p: apply(last, two(apply(first, one(p)))))

        # 4. One map in three formats: the same atlas. All numbers are whole multiples of 1 / 2048 mm, which float32
        # has, and none is half a voxel, so that no rounding decides.
        even = shift(-87, -123, -69) @ np.diag([5.0, 5, 5, 1])
        even_goes = np.round(wave(apply(even, nodes())) * 1024) / 1024 + 1 / 2048
        itk(path("itk.nii.gz"), even, even_goes)
        spm(path("y_spm.nii"), even, even_goes)
        save(subject, np.zeros(DIM, "u1"), even, 0)
        fsl(path("abs.nii.gz"), even, even_goes, ATLAS, True, 0)
        fsl(path("rel.nii.gz"), even, even_goes, ATLAS, False, 2006)
        same = [Dump(program, ATLAS, folder, (path(name), *images)) for name, (_, images) in fields.items()]
        for dump in same[1:]:
            assert np.array_equal(dump.labels, same[0].labels)
            inner = (slice(2, -2),) * 3  # beyond the last nodes positions stay those of the border, displacements go on
            assert np.allclose(dump.own[inner], same[0].own[inner], rtol=0, atol=1e-9)

        # 5. Vertices: numpy's field must take each of them back to its old place.
        centre = np.array([5.0, -15, 10])
        sphere = write_sphere(path("sphere.obj"), centre, 45)
        worst = 0
        for name, affine in (("itk.nii.gz", even), ("y_spm.nii", oblique)):
            field = itk(path(name), affine, wave(apply(affine, nodes()))) if name[0] == "i" else \
                spm(path(name), affine, goes)
            dump = Dump(program, path("sphere.obj"), folder, (path(name),))
            assert dump.vertices.shape == sphere.shape, dump.said
            # slopes of the inverse are below 2, so an error of m there is one of less than 2 m here
            worst = max(worst, 2 * np.max(np.linalg.norm(field(dump.vertices) - sphere.astype("f4"), axis=1)))
        assert worst < 1e-4, worst
    print(f"{compared} voxels have numpy's label; three formats give one atlas; vertices miss by {worst:.1e} mm at most")


if __name__ == "__main__":
    main()
