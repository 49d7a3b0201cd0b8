#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""conus query --level against voxels relabelled by numpy beforehand (Eq. 10).

The areas of real atlases get random trees. An answer rolled up to a depth or a list must have the same rows as that of a
volume in which nibabel wrote the group's label into every voxel: the same bytes, but for sums over voxels, whose last digit may
differ. The second atlas is left to scripts/test --long.

usage: compare_levels.py CONUS POSES_PER_CASE [TEMPLATE_FOLDER]; exit 77 = skipped."""

import csv
import io
import os
import random
import subprocess
import sys
import tempfile

try:
    import nibabel
    import numpy as np
except ImportError:
    print("skipped: no python3-nibabel")
    sys.exit(77)

from compare_query import random_pose
from sample import every

VOLUMES = ["aal", "brodmann", "JHU-WhiteMatter-labels-2mm"]
SUMS = {"volume_mm3", "fraction", "cone_fraction", "centroid_x", "centroid_y", "centroid_z", "sum_value", "mean_value"}


def random_tree(labels, rng):
    """{label: (name, parent)} of the areas and of groups above them, three deep; some areas stay roots."""
    tops = [10001 + i for i in range(3)]
    middles = [20001 + i for i in range(9)]
    tree = {top: (f"top {top}", 0) for top in tops}
    tree.update({middle: (f"middle, {middle}", rng.choice(tops)) for middle in middles})
    tree.update({label: (f"area {label}", rng.choice(middles + tops + [0])) for label in labels})
    return tree


def chain(tree, label):
    """The label and its ancestors, from itself up."""
    found = []
    while label:
        found.append(label)
        label = tree[label][1]
    return found


def group_at_depth(tree, label, depth):
    return chain(tree, label)[::-1][:depth][-1]


def group_of_list(tree, label, listed):
    return next((area for area in chain(tree, label) if area in listed), label)


def write_table(path, tree):
    with open(path, "w", encoding="utf-8") as out:
        out.write("index\tname\tparent_id\n")
        out.writelines(f"{label}\t{name}\t{parent or 'n/a'}\n" for label, (name, parent) in tree.items())


def query(conus, path, table, pose, more):
    command = [conus, "query", path, "--labels", table, "--quiet", "--origin=" + ",".join(map(repr, pose[:3])),
               "--direction=" + ",".join(map(repr, pose[3:6])), "--angle", repr(pose[6]), "--layers", "all",
               "--format", "tsv"] + more
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    return list(csv.DictReader(io.StringIO(text), delimiter="\t"))


def differs(column, mine, other):
    if mine == other or column not in SUMS or "n/a" in (mine, other):
        return mine != other
    return abs(float(mine) - float(other)) > 1e-6 * (1 + abs(float(other)))


def compare(rolled, relabelled, case):
    if [row["name"] for row in rolled] != [row["name"] for row in relabelled]:
        sys.exit(f"{case}: rows {[row['name'] for row in rolled]}, {[row['name'] for row in relabelled]}")
    for mine, other in zip(rolled, relabelled):
        for column in mine:
            if differs(column, mine[column], other[column]):
                sys.exit(f"{case}: {mine['name']}: {column} is {mine[column]}, {other[column]} when relabelled")
    return len(rolled)


def specs(tree, rng):
    """(--level, function from label to group) of two depths and two lists."""
    for depth in (1, 2):
        yield str(depth), lambda label, depth=depth: group_at_depth(tree, label, depth)
    for size in (2, 5):
        listed = set(rng.sample(sorted(tree), size))
        words = [f'"{tree[label][0]}"' if rng.random() < 0.5 else f'"{label}"' for label in sorted(listed)]
        yield ",".join(words), lambda label, listed=listed: group_of_list(tree, label, listed)


def main():
    conus, poses = sys.argv[1], int(sys.argv[2])
    folder = sys.argv[3] if len(sys.argv) > 3 else "/usr/share/mricron/templates"
    rng = random.Random(20261120)
    rows = 0
    with tempfile.TemporaryDirectory() as scratch:
        table, relabelled = os.path.join(scratch, "tree.tsv"), os.path.join(scratch, "relabelled.nii.gz")
        for name in every(2, VOLUMES):
            path = os.path.join(folder, name + ".nii.gz")
            if not os.path.exists(path):
                print(f"skipped: no {path}")
                sys.exit(77)
            image = nibabel.load(path)
            labels = np.asarray(image.dataobj).astype(np.int32)
            box = np.array(np.meshgrid(*[[-0.5, n - 0.5] for n in labels.shape])).reshape(3, -1).T
            corners = nibabel.affines.apply_affine(image.affine, box)
            tree = random_tree([int(label) for label in np.unique(labels) if label], rng)
            write_table(table, tree)
            for spec, group in specs(tree, rng):
                of_label = np.arange(labels.max() + 1, dtype=np.int32)
                for label in np.unique(labels)[1:]:
                    of_label[label] = group(int(label))
                header = image.header.copy()
                header.set_data_dtype(np.int32)
                header.set_slope_inter(1, 0)
                nibabel.save(nibabel.Nifti1Image(of_label[labels], None, header), relabelled)
                for _ in range(poses):
                    pose = random_pose(rng, corners)
                    case = f"{name} --level {spec} from {pose}"
                    rows += compare(query(conus, path, table, pose, ["--level", spec]),
                                    query(conus, relabelled, table, pose, []), case)
    print(f"{rows} rows are those of relabelled volumes")


if __name__ == "__main__":
    main()
