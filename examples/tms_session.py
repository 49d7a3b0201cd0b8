# SPDX-License-Identifier: BSD-3-Clause
# %% [markdown]
# # A TMS session: which area did each pulse reach?
#
# The plan is the motor pose of docs/recipes.md: a coil over the left hemisphere, in MNI space. 30 mm below it the coil
# reaches 8 mm to the side, a cone of 30 degrees. A hand holds it, so that each of 400 pulses is off by some 5 degrees
# and 3 mm. Here these poses are drawn at random; yours come from the navigation system.
#
# Needs Debian's mricron-data, python3-pandas and python3-matplotlib. Runs as a script or, cell by cell, as a notebook.

# %%
import matplotlib.pyplot as pyplot
import numpy as np

import conus

ATLAS = "/usr/share/mricron/templates/aal.nii.gz"
ORIGIN, TARGET, ANGLE = np.array([-52, -28, 84]), np.array([-37, -22, 55]), 30
DEGREES, MM, PULSES = 5, 3, 400

atlas = conus.load(ATLAS)
plan = atlas.select(ORIGIN, toward=TARGET, angle=ANGLE)
for hit in plan[:-1]:
    print(f"planned: {hit.name} {100 * hit.share:.1f} %, {hit.distance_mm:.1f} mm below the coil")

# %% [markdown]
# ## The session
#
# The axis tilts about two axes across it, and the coil shifts along three.

# %%
random = np.random.default_rng(1)
axis = (TARGET - ORIGIN) / np.linalg.norm(TARGET - ORIGIN)
side = np.cross(axis, [0, 0, 1])
side /= np.linalg.norm(side)
across = np.stack([side, np.cross(side, axis)])
tilt = np.radians(random.normal(scale=DEGREES, size=(PULSES, 2)))
size = np.linalg.norm(tilt, axis=1, keepdims=True)
directions = np.cos(size) * axis + np.sinc(size / np.pi) * (tilt @ across)  # sinc(x / pi) is sin(x) / x
origins = ORIGIN + random.normal(scale=MM, size=(PULSES, 3))

session = atlas.select_many(origins, directions, angle=ANGLE).to_dataframe()
share = session.pivot_table(index="query", columns="name", values="share", fill_value=0, observed=True)
best = session[session["rank"] == 1]["name"].astype(str)
counted = best.value_counts() / PULSES
print(f"observed: {counted.index[0]} is the best in {100 * counted.iloc[0]:.1f} % of {PULSES} pulses")

# %% [markdown]
# ## What was to be expected
#
# `jitter()` gives the same probabilities without chance. Those observed must lie within their statistical error: no
# further off than three standard deviations of a binomial distribution.

# %%
expected = atlas.jitter(ORIGIN, toward=TARGET, angle=ANGLE, degrees=DEGREES, mm=MM).to_dataframe()
expected = expected[expected["kind"] == "area"].set_index("name")["p_hit"]
for name in expected.index[:2]:
    p, seen = expected[name], counted.get(name, 0)
    print(f"expected: {name} {100 * p:.1f} %, observed {100 * seen:.1f} %")
    assert abs(seen - p) < 3 * np.sqrt(p * (1 - p) / PULSES)

# %% [markdown]
# ## A figure
#
# The picture of the plan needs OpenGL 4.5, in hardware or software; without it its place stays empty.

# %%
names = [name for name in expected.index if expected[name] > 0.005]
colours = {name: tuple(atlas.objects.colours[atlas.find(name)] / 255) for name in names}
widths = (1.1, 1.6, 1)
figure, (brain, pulses, bars) = pyplot.subplots(1, 3, figsize=(15, 4.6), width_ratios=widths, layout="constrained")

brain.set_title("the plan")
brain.axis("off")
try:
    brain.imshow(atlas.render(plan, size=(800, 600)).array)
except conus.GLError as error:
    print(f"no picture: {error}")

order = np.argsort(share[names[0]].to_numpy())
shares = [100 * share[name].to_numpy()[order] for name in names]
shares.append(100 - sum(shares))
pulses.stackplot(np.arange(PULSES), shares, labels=[*names, "other"], colors=[*colours.values(), "black"], step="mid")
pulses.set(title="what each pulse reached", xlim=(0, PULSES - 1), ylim=(0, 100))
pulses.set(xlabel=f"{PULSES} pulses, ordered by {names[0]}", ylabel="share of the cone, %")
pulses.legend(loc="lower right")

place, style = np.arange(len(names)), {"width": 0.38, "color": list(colours.values()), "edgecolor": "black"}
bars.bar(place - 0.2, [100 * expected[name] for name in names], label="expected", **style)
bars.bar(place + 0.2, [100 * counted.get(name, 0) for name in names], label="observed", hatch="//", **style)
bars.set_xticks(place, names)
bars.set(title="how often each area is the best", ylabel="of the pulses, %")
bars.legend()
figure.savefig("tms_session.png", dpi=100)
