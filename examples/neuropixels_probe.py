# SPDX-License-Identifier: BSD-3-Clause
# %% [markdown]
# # A Neuropixels probe: which area is each contact in, and how sure is that?
#
# A shank goes into the left frontal lobe of a macaque, in the INIA19 atlas (voxels of 0.5 mm), and ends 15 mm below the
# surface of the brain. Its contacts are in rows 0.02 mm apart.
#
# Needs Debian's mricron-data, python3-nibabel and python3-matplotlib. Runs as a script or, cell by cell, as a notebook.

# %%
import matplotlib.pyplot as pyplot
import nibabel
import numpy as np

import conus

FOLDER = "/usr/share/mricron/templates/"
ABOVE, DIRECTION = np.array([-14, 2, 32]), np.array([0.1, 0, -1]) / np.linalg.norm([0.1, 0, -1])
DEPTHS = np.arange(0.01, 15, 0.02)

atlas = conus.load(FOLDER + "inia19-NeuroMaps.nii.gz")
whole = atlas.segments(ABOVE, direction=DIRECTION)
first = np.flatnonzero(whole.objects)[0]
entry = np.array([whole[f"entry_{axis}"][first] for axis in "xyz"])
name = whole["name"][first]
print("the shank enters the brain at {:.1f}, {:.1f}, {:.1f} mm, in {}".format(*entry, name))

# %% [markdown]
# ## What the shank passes
#
# One row for each stretch, in order of depth; an area that the shank comes back to has several.

# %%
shank = atlas.segments(entry, direction=DIRECTION, range=(0, 15))
for row in shank.to_dataframe().itertuples():
    print(f"{row.entry_mm:5.2f} to {row.exit_mm:5.2f} mm  {row.name}")

# %% [markdown]
# ## The area of each row
#
# With a range the stretches fill the shank, so a contact is in the first that ends below it.


# %%
def areas_at(depths, objects, exits):
    """The number of the object at each depth; 0 outside of the brain."""
    return objects[np.searchsorted(exits, depths, side="right")]


rows = entry + DEPTHS[:, None] * DIRECTION
areas = areas_at(DEPTHS, shank.objects, shank["exit_mm"])

image = nibabel.load(FOLDER + "inia19-NeuroMaps.nii.gz")
voxels = np.rint(nibabel.affines.apply_affine(np.linalg.inv(image.affine), rows)).astype(int)
labels = np.asanyarray(image.dataobj)[tuple(voxels.T)]
assert np.array_equal(atlas.objects.labels[areas], labels)  # as nibabel finds them, voxel by voxel

# %% [markdown]
# ## How sure is that?
#
# An insertion is off by some 0.5 mm along each axis and 2 degrees. 300 insertions say in which area a contact at a
# depth could be.

# %%
INSERTIONS, MM, DEGREES = 300, 0.5, 2
random = np.random.default_rng(1)
coarse = np.linspace(0.01, 14.99, 76)
side = np.cross(DIRECTION, [0, 1, 0])
across = np.stack([side, np.cross(side, DIRECTION)])
tilt = np.radians(random.normal(scale=DEGREES, size=(INSERTIONS, 2)))
ways = DIRECTION + np.tan(tilt) @ across
ways /= np.linalg.norm(ways, axis=1, keepdims=True)
starts = entry + random.normal(scale=MM, size=(INSERTIONS, 3))
insertions = atlas.segments_many(starts, ways, range=(0, 15))
parts = [np.split(values, insertions.starts[1:-1]) for values in (insertions.objects, insertions["exit_mm"])]
found = np.stack([areas_at(coarse, *part) for part in zip(*parts)])

numbers, counts = np.unique(found, return_counts=True)
numbers = numbers[np.argsort(-counts)]
chance = np.stack([(found == number).mean(axis=0) for number in numbers])
assert np.allclose(chance.sum(axis=0), 1)
planned = areas_at(coarse, shank.objects, shank["exit_mm"])
right = (found == planned).mean(axis=0)
print(f"the planned area is right in {100 * right.mean():.0f} % of all contacts; "
      f"at best {100 * right.max():.0f} %, at {coarse[right.argmax()]:.1f} mm")

# %% [markdown]
# ## A figure

# %%
figure, (slice_, plan, errors) = pyplot.subplots(1, 3, figsize=(13, 6), width_ratios=(2, 1, 2), layout="constrained")

scan = nibabel.load(FOLDER + "inia19-t1-brain.nii.gz")
j = round((entry[1] - scan.affine[1, 3]) / scan.affine[1, 1])
left, low = scan.affine[0, 3], scan.affine[2, 3]
extent = (left, left + 0.5 * scan.shape[0], low, low + 0.5 * scan.shape[2])
slice_.imshow(np.asanyarray(scan.dataobj)[:, j].T, cmap="gray", origin="lower", extent=extent)
tip = entry + 15 * DIRECTION
slice_.plot([ABOVE[0], tip[0]], [ABOVE[2], tip[2]], color="tab:orange", linewidth=2)
slice_.plot(entry[0], entry[2], "o", color="tab:orange", label="entry")
slice_.legend()
slice_.set(title=f"coronal, y = {entry[1]:.0f} mm", xlabel="x, mm (left is left)", ylabel="z, mm")

likely = chance.max(axis=1) > 0.1
shown = dict(zip(numbers[likely], chance[likely]))
palette = dict(zip((number for number in shown if number), pyplot.get_cmap("Set2").colors))
palette[0] = "lightgrey"
for number, top, bottom in zip(shank.objects, shank["entry_mm"], shank["exit_mm"]):
    plan.barh((top + bottom) / 2, 1, bottom - top, color=palette[number])
plan.set(title="as planned", xticks=[], ylabel="depth below the entry, mm", ylim=(15, 0), xlim=(0, 1))

below = np.zeros(len(coarse))
for number, part in shown.items():
    above = below + part
    name = atlas.objects.names[number] if number else "outside of all areas"
    errors.fill_betweenx(coarse, below, above, color=palette[number], label=name.replace("_", " "))
    below = above
errors.fill_betweenx(coarse, below, 1, facecolor="white", edgecolor="black", hatch="...", label="other areas")
errors.set(title=f"with errors of {MM} mm and {DEGREES}°", xlabel="probability", ylim=(15, 0), xlim=(0, 1))
errors.legend(loc="upper center", bbox_to_anchor=(0.5, -0.1), ncols=2)
figure.savefig("neuropixels_probe.png", dpi=100)
