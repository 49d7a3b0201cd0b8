#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Where --atlas-transform brings AAL, and what conus says about it, against numpy.

A patient's head is made of a template (mricron's ch2bet, a brain; ch2, a head; the middle third of ch2bet's slices) by
a random affine. The files that conus gets are right, or have what people mistake: the other direction, LPS for RAS,
metres for mm. Numbers of `conus info` are compared with numpy, which finds the head in all voxels by itself; and it is
counted what the notes say.

usage: compare_fit.py CONUS [CASES]; so many of each kind (docs/verification.md has those of 15); without, one of each
of the brain only, moved far, and in scripts/test --long less far, too. Exit 77 = skipped."""
import json
import os
import subprocess
import sys
import tempfile

TEMPLATES = "/usr/share/mricron/templates/"

try:
    import nibabel
    import numpy as np
except ImportError:
    print("skipped: no python3-nibabel")
    sys.exit(77)
if not os.path.exists(TEMPLATES + "aal.nii.gz"):
    print("skipped: no mricron-data")
    sys.exit(77)

from sample import LONG

FLIP = np.diag([-1.0, -1, 1, 1])
SIZES = {"small": (5, 10, 0.05), "medium": (15, 30, 0.15), "large": (30, 60, 0.2)}  # degrees, mm, scale
WORDS = {"right": None, "inverse": "in the other direction it", "LPS": "with LPS in the place of RAS it",
         "metres": "with a translation 1000 times as long (metres) it"}


def random_affine(random, degrees, mm, scale):
    linear = np.diag(1 + random.uniform(-scale, scale, 3)) + np.triu(random.uniform(-scale, scale, (3, 3)), 1) / 4
    for axis, angle in enumerate(np.radians(random.uniform(-degrees, degrees, 3))):
        turn, i, j = np.eye(3), (axis + 1) % 3, (axis + 2) % 3
        turn[i, i] = turn[j, j] = np.cos(angle)
        turn[j, i], turn[i, j] = np.sin(angle), -np.sin(angle)
        linear = turn @ linear
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = linear, random.uniform(-mm, mm, 3)
    return matrix


def mistaken(kind, matrix):
    if kind == "inverse":
        return np.linalg.inv(matrix)
    if kind == "LPS":
        return FLIP @ matrix @ FLIP
    wrong = matrix.copy()
    wrong[:3, 3] /= 1000 if kind == "metres" else 1
    return wrong


def apply(matrix, points):
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def head_of(values):
    """Otsu's threshold over all voxels, then what is enclosed along two axes."""
    counts, edges = np.histogram(values, bins=256)
    middles = (edges[:-1] + edges[1:]) / 2
    below, mass = np.cumsum(counts)[:-1], np.cumsum(counts * middles)[:-1]
    total, whole = counts.sum(), (counts * middles).sum()
    between = (whole * below / total - mass) ** 2 / np.maximum(below * (total - below), 1)
    mask = values >= edges[np.argmax(between) + 1]
    sides = sum((np.maximum.accumulate(mask, a) & np.flip(np.maximum.accumulate(np.flip(mask, a), a), a)).astype(int)
                for a in range(3))
    return mask | (sides >= 2)


class Patient:
    """A template that can be put anywhere."""

    def __init__(self, name, slices=slice(None)):
        image = nibabel.load(TEMPLATES + name)
        self.values = np.asarray(image.dataobj)[:, :, slices]
        self.own = image.affine @ np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, slices.start or 0], [0, 0, 0, 1]])
        self.head = head_of(self.values.astype(float))

    def write(self, path, template_from_patient):
        self.affine = np.linalg.inv(template_from_patient) @ self.own
        nibabel.Nifti1Image(self.values, self.affine).to_filename(path)

    def shares(self, points):
        voxel = np.floor(apply(np.linalg.inv(self.affine), points) + 0.5).astype(int)
        inside = np.all((voxel >= 0) & (voxel < self.values.shape), axis=1)
        return inside.mean(), self.head[tuple(voxel[inside].T)].sum() / len(points)


def place(conus, matrix, context, folder):
    path = os.path.join(folder, "m.txt")
    np.savetxt(path, matrix, fmt="%.17g")
    out = subprocess.run([conus, "info", TEMPLATES + "aal.nii.gz", "--atlas-transform", path, "--context", context,
                          "--format", "json"], check=True, stdout=subprocess.PIPE).stdout
    answer = json.loads(out)
    said = [note for note in answer["notes"] if "% of the atlas is in the head of" in note]
    assert len(said) <= 1, said
    return answer["moved"], said[0] if said else None


def check(moved, matrix, voxels, own, patient):
    world = apply(np.linalg.inv(matrix), own)
    grid, head = patient.shares(world)
    found = moved["context"]
    assert abs(found["in_grid"] - grid) < 0.005 and abs(found["in_head"] - head) < 0.01, (found, grid, head)
    assert np.isclose(moved["growth"], 1 / abs(np.linalg.det(matrix[:3, :3])), rtol=1e-6)
    assert np.allclose(moved["centre"], world.mean(axis=0), atol=0.05)
    assert np.isclose(moved["distance_mm"], np.linalg.norm(world.mean(axis=0) - own.mean(axis=0)), atol=0.05)
    shape = nibabel.load(TEMPLATES + "aal.nii.gz").affine
    corners = np.array([[x, y, z] for x in (-.5, .5) for y in (-.5, .5) for z in (-.5, .5)])
    for low, high, m in (("own_low", "own_high", shape), ("low", "high", np.linalg.inv(matrix) @ shape)):
        cells = np.concatenate([apply(m, voxels + corner) for corner in corners])
        assert np.allclose(moved[low], cells.min(axis=0), atol=1e-5), (moved[low], cells.min(axis=0))
        assert np.allclose(moved[high], cells.max(axis=0), atol=1e-5)


def main():
    conus, cases = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 0
    aal = nibabel.load(TEMPLATES + "aal.nii.gz")
    voxels = np.argwhere(np.asarray(aal.dataobj) > 0)
    own = apply(aal.affine, voxels)
    random = np.random.default_rng(5)
    table, checked = {}, 0
    names = {"brain": ("ch2bet.nii.gz",), "head": ("ch2.nii.gz",), "slab": ("ch2bet.nii.gz", slice(60, 120))}
    with tempfile.TemporaryDirectory() as folder:
        for name, what in names.items() if cases else [("brain", names["brain"])]:
            patient = Patient(*what)
            for size, limits in SIZES.items() if cases else [*SIZES.items()][1 if LONG else 2:]:
                for kind in [*WORDS] * max(cases, 1):
                    matrix = random_affine(random, *limits)
                    patient.write(os.path.join(folder, "t1.nii"), matrix)
                    wrong = mistaken(kind, matrix)
                    moved, said = place(conus, wrong, os.path.join(folder, "t1.nii"), folder)
                    if checked < max(cases, 1):
                        check(moved, wrong, voxels, own, patient)
                        checked += 1
                    apart = np.linalg.norm(apply(np.linalg.inv(wrong), own[::99]) - apply(np.linalg.inv(matrix), own[::99]),
                                           axis=1).mean()
                    advice = "silent" if not said else "other image" if "of another image" in said else \
                        "right" if WORDS[kind] and f"; {WORDS[kind]}" in said else "wrong"
                    table.setdefault((name, size, kind), []).append((advice, apart))
    for key, found in table.items():
        counts = {advice: sum(a == advice for a, _ in found) for advice in ("silent", "right", "wrong", "other image")}
        silent = max((apart for advice, apart in found if advice == "silent"), default=0)
        print(*key, counts, f"silent up to {silent:.1f} mm apart")
    alarms = [key for key, found in table.items() if key[2] == "right" and key[0] != "slab" and
              any(advice != "silent" for advice, _ in found)]
    assert not alarms, alarms
    large = [advice for (name, size, kind), found in table.items() if name == "brain" and size == "large" and
             kind == "inverse" for advice, _ in found]
    assert large.count("right") >= 0.9 * len(large), large
    print(f"{checked} placement(s) as by numpy; no right transform is doubted")


if __name__ == "__main__":
    main()
