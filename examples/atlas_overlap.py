# SPDX-License-Identifier: BSD-3-Clause
# %% [markdown]
# # Two atlases, one cone: what does the other one call it?
#
# AAL names gyri, Brodmann's map numbers fields of the cortex. Both lie in MNI space, on the same grid. Which fields are
# in the gyri that a cone reaches?
#
# Needs Debian's mricron-data, python3-nibabel, python3-pandas and python3-matplotlib. Runs as a script or, cell by
# cell, as a notebook.

# %%
import matplotlib.pyplot as pyplot
import nibabel
import numpy as np
import pandas

import conus

FOLDER = "/usr/share/mricron/templates/"
CONE = {"origin": (-52, -28, 84), "toward": (-37, -22, 55), "angle": 30, "range": (0, 45), "layers": "all"}

aal = conus.load(FOLDER + "aal.nii.gz")
brodmann = conus.load(nibabel.load(FOLDER + "brodmann.nii.gz"), labels={n: f"BA {n}" for n in range(1, 53)})

# %% [markdown]
# ## What the cone hits, and what is in it
#
# The share is of what its rays hit first. The volume counts every voxel in it, down to 45 mm.

# %%
inside = {}
for title, atlas in (("AAL", aal), ("Brodmann", brodmann)):
    hits = atlas.select(**CONE)
    inside[title] = hits
    table = hits.to_dataframe()[["name", "share", "volume_mm3", "fraction"]]
    print(title)
    print(table[table["volume_mm3"] > 100].round(3).to_string(index=False))

# %% [markdown]
# ## Voxel by voxel
#
# `mask(of="labels")` gives the voxels of the cone with the labels of their areas, as an image of nibabel. The two masks
# are on one grid, so that they can be counted together.

# %%
masks = [hits.mask(of="labels") for hits in inside.values()]
assert np.array_equal(masks[0].affine, masks[1].affine)
gyri, fields = (np.asanyarray(mask.dataobj).ravel() for mask in masks)
both = (gyri > 0) & (fields > 0)


def names_of(atlas, labels):
    """The names of areas that have these labels."""
    info = atlas.info()
    return pandas.Categorical(labels).rename_categories(dict(zip(info["index"], info["name"])))


overlap = pandas.crosstab(names_of(aal, gyri[both]), names_of(brodmann, fields[both]))
overlap = overlap.loc[overlap.sum(axis=1) > 50, overlap.sum() > 50]
for gyrus, row in overlap.iterrows():
    print(f"{gyrus}: {row.idxmax()} is {100 * row.max() / row.sum():.0f} % of what both atlases name")

# The masks hold as many voxels as the tables say.
for hits, values in zip(inside.values(), (gyri, fields)):
    table = hits.to_dataframe().set_index("index")["voxels"]
    counted = dict(zip(*np.unique(values[values > 0], return_counts=True)))
    assert all(table[label] == count for label, count in counted.items())

# %% [markdown]
# ## A figure

# %%
figure, (shares, heat) = pyplot.subplots(1, 2, figsize=(13, 4.8), width_ratios=(1, 1.5), layout="constrained")

for y, (title, hits) in enumerate(inside.items()):
    end = 0.0
    for hit in hits:
        if hit.share > 0.005:
            shares.barh(y, 100 * hit.share, left=end, edgecolor="black",
                        color=hits.atlas.objects.colours[hits.atlas.find(hit.name)] / 255 if hit.rank else "white")
            shares.text(end + 50 * hit.share, y, f"{hit.name}\n{100 * hit.share:.0f} %", ha="center", va="center",
                        bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1.5})
            end += 100 * hit.share
shares.set_yticks(range(len(inside)), list(inside))
shares.set(title="what the cone hits first", xlabel="share of the cone, %", xlim=(0, 100))
shares.invert_yaxis()

part = 100 * overlap.div(overlap.sum(axis=1), axis=0)
drawn = heat.imshow(part, cmap="Blues", vmin=0, vmax=100, aspect="auto")
for (row, column), value in np.ndenumerate(part.to_numpy()):
    if value >= 0.5:
        heat.text(column, row, f"{value:.0f}", ha="center", va="center", color="white" if value > 60 else "black")
heat.set_xticks(range(len(part.columns)), part.columns)
heat.set_yticks(range(len(part.index)), part.index)
heat.set_title("of each gyrus in the cone, the part in each field, %")
figure.colorbar(drawn, label="%")
figure.savefig("atlas_overlap.png", dpi=100)
