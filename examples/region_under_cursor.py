# SPDX-License-Identifier: BSD-3-Clause
# %% [markdown]
# # The region under the cursor of 3D Slicer or napari
#
# Both programs tell a function of yours where the cursor is. Ask conus there: in a slice what is at the point, in a view
# of three dimensions what the line of sight meets first. Paste the next cell into Slicer's Python console, after
# `pip_install` of conus' wheel, or into napari's, and call `watch_slicer(atlas)` or `watch_napari(viewer, atlas)`.
#
# Needs Debian's mricron-data and python3-matplotlib. Runs as a script or, cell by cell, as a notebook, without either
# program: a stand-in moves the cursor.

# %%
import matplotlib.pyplot as pyplot
import numpy as np

import conus


def region_at(atlas, point):
    """The area at a point, RAS mm, or a word on the nearest one within 5 mm."""
    for hit in atlas.near(point, 5):
        if hit.name != "unassigned":
            return hit.name if hit.distance_mm == 0 else f"{hit.distance_mm:.1f} mm from {hit.name}"
    return ""


def region_along(atlas, eye, direction):
    """The area that most of a narrow cone along the line of sight hits first."""
    name = atlas.select(origin=eye, direction=direction, angle=1)[0].name
    return "" if name == "unassigned" else name


def watch_slicer(atlas, show=None):
    """Shows the region in the status bar while the cursor moves over a slice. Returns the crosshair and what to give to
    its RemoveObserver()."""
    import slicer  # in Slicer only

    show = show or (lambda text: slicer.util.showStatusMessage(text))
    crosshair = slicer.util.getNode("Crosshair")

    def moved(caller, event):
        ras = [0.0, 0.0, 0.0]
        crosshair.GetCursorPositionRAS(ras)
        show(region_at(atlas, ras))

    return crosshair, crosshair.AddObserver(slicer.vtkMRMLCrosshairNode.CursorPositionModifiedEvent, moved)


def watch_napari(viewer, atlas):
    """Shows the region over the picture. Layers lie in RAS mm: `viewer.add_image(array, affine=image.affine)`."""

    def moved(viewer, event):
        solid = viewer.dims.ndisplay == 3
        name = (region_along(atlas, event.position, event.view_direction) if solid
                else region_at(atlas, event.position))  # fmt: skip
        viewer.text_overlay.text = name

    viewer.text_overlay.visible = True
    viewer.mouse_move_callbacks.append(moved)


atlas = conus.load("/usr/share/mricron/templates/aal.nii.gz")

# %% [markdown]
# ## A stand-in for both programs
#
# It has only what the cell above asks for.

# %%
import sys
import types


class Crosshair:
    """Slicer's node, at one place after the other."""

    def AddObserver(self, event, call):
        self.call = call
        return 1

    def GetCursorPositionRAS(self, out):
        out[:] = self.at

    def move(self, point):
        self.at = list(point)
        self.call(self, "CursorPositionModifiedEvent")


node = Crosshair()
sys.modules["slicer"] = types.SimpleNamespace(
    util=types.SimpleNamespace(getNode={"Crosshair": node}.get),
    vtkMRMLCrosshairNode=types.SimpleNamespace(CursorPositionModifiedEvent=0),
)
viewer = types.SimpleNamespace(
    dims=types.SimpleNamespace(ndisplay=3), text_overlay=types.SimpleNamespace(text="", visible=False),
    mouse_move_callbacks=[],
)  # fmt: skip

# %% [markdown]
# ## The cursor moves
#
# In a slice from the left to the right, and over a head that is seen from the left, from the back to the front.

# %%
shown = []
watch_slicer(atlas, shown.append)
across = np.arange(-75, 76, 1.0)
for x in across:
    node.move((x, -20, 10))

watch_napari(viewer, atlas)
seen = []
along = np.arange(-105, 76, 1.0)
for y in along:
    event = types.SimpleNamespace(position=(-200, y, 10), view_direction=(1, 0, 0))
    for call in viewer.mouse_move_callbacks:
        call(viewer, event)
    seen.append(viewer.text_overlay.text)

for title, names in (("in the slice", shown), ("in the view", seen)):
    areas = [name for name in dict.fromkeys(names) if name and " from " not in name]
    print(f"{title}: {', '.join(areas)}")

# %% [markdown]
# ## A figure

# %%
figure, axes = pyplot.subplots(2, 1, figsize=(11, 6.4), layout="constrained")
rows = ((axes[0], across, shown, "x, mm", "cursor in a slice, y = -20, z = 10"),
        (axes[1], along, seen, "y, mm", "cursor over a head seen from the left, z = 10"))  # fmt: skip
for axis, places, names, label, title in rows:
    plain = [name if " from " not in name else "" for name in names]
    kinds = [name for name in dict.fromkeys(plain) if name]
    for row, kind in enumerate(kinds):
        spans = [(place - 0.5, 1) for place, name in zip(places, plain) if name == kind]
        axis.broken_barh(spans, (row - 0.4, 0.8), color=atlas.objects.colours[atlas.find(kind)] / 255)
    axis.set_yticks(range(len(kinds)), kinds)
    axis.invert_yaxis()
    axis.set(xlabel=label, title=title)
figure.savefig("region_under_cursor.png", dpi=100)
