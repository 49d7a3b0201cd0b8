# SPDX-License-Identifier: BSD-3-Clause
"""What a script of a user of Python gets: each line of CALLS, and the table, value, error, notes and warnings of it.

tests/equal/outputs runs it in its scratch folder, beside ph/ and in/.
"""
import logging
import sys
import warnings

import nibabel
import numpy as np
import pandas

import conus

NAN = float("nan")
CALLS = """
nested = conus.load("ph/nested.nii.gz", labels="in/tree.tsv")
nested.info()
nested.notes, nested.tractograms, nested.placement()
nested.sides
array = np.zeros((20, 20, 20), "u1"); array[4:9] = 1; array[12:17] = 2
affine = np.diag([2.0, 2, 2, 1]); affine[:3, 3] = -19
plates = conus.load(array, affine, labels={1: "left", 2: "right"})
plates.info()
table = pandas.DataFrame({"index": [1, 2], "name": ["x", "y"], "hemisphere": ["L", None], "parent": [None, 1]})
conus.load(array, affine, labels=table).info()
conus.load(nibabel.Nifti1Image(array, affine)).info()
arc = ("ph/brain/brain-pathway.nii.gz", 30000)
scene = conus.load("ph/brain/brain.atlas.json", pathways=[arc], streamlines=["in/arcs.vtk"])
scene.info()
scene.notes
scene.tractograms
conus.is_tractogram("in/arcs.vtk"), conus.is_tractogram("in/tree.tsv")
conus.pose_formats()

aim = {"origin": (3, -100, 5), "toward": (0, 0, 0), "angle": 30}
nested.select(**aim)
nested.select(**aim).to_dataframe()
nested.select(**aim, layers="all").to_dataframe()
nested.select((0, -100, 0), direction=(0, 1, 0), radius=5, layers="all").to_dataframe()
nested.select((0, 100, 0), direction=(0, 1, 0), angle=5).to_dataframe()
nested.select((0, 0, 0), direction=(0, 1, 0), angle=5).to_dataframe()
nested.select(**aim, level=2).to_dataframe()
nested.near((4, -14, 3)).to_dataframe()
nested.near((4, -14, 3), 6).to_dataframe()
nested.sweep(**aim).to_dataframe()
nested.jitter(**aim, degrees=3, mm=2, samples=64).to_dataframe()
nested.segments((0, -100, 0), direction=(0, 1, 0), range=(0, 150)).to_dataframe()
nested.clearance((0, -100, 0), direction=(0, 1, 0), range=(0, 50), radius=1).to_dataframe()
nested.overlap("ph/u-shape.nii.gz").to_dataframe()
scene.connectivity(radius=2).to_dataframe()
scene.select((-110, -60, 60), toward=(-30, -20, 25), angle=20).to_dataframe()

origins = [[0, -100, 0], [50, -60, 5], [0, 0, NAN], [0, 100, 0]]
directions = [[0, 1, 0], [-5, 6, 0], [0, 1, 0], [0, 1, 0]]
answers = nested.select_many(origins, directions, angle=5)
answers.to_dataframe()
answers.errors
nested.segments_many(origins, directions).to_dataframe()
nested.clearance_many(origins, directions, radius=0.65, within=30).to_dataframe()
poses = conus.read_poses("in/quaternion.tsv")
poses.to_dataframe()
nested.select_many(poses=poses, angle=20).to_dataframe()
conus.read_poses("in/bad.tsv").errors
conus.read_poses("in/lines.mrk.json", any_space=True).to_dataframe()
entries, ways = [[0, -60, 0], [9, -60, 4], [0, 60, 0]], [[0, 1, 0], [-9, 60, 0], [0, 1, 0]]
aims = {"origins": entries, "directions": ways, "depth": 62}
plan = nested.plan({"Core": 2}, {"Inner": 0.5}, **aims, radius=0.5, top=5, infeasible=True)
plan.to_dataframe()
plan.verdicts()
plan.tolerance("tip")
plan.constraints, plan.funnel, plan.misses
nested.plan({"Core": 2}, {}, origins=entries, directions=ways, depth=62).to_dataframe()
times = np.arange(8) / 30
track = nested.track(times, [[0, -100, 0]] * 8, [[0.02 * i, 1, 0] for i in range(8)], score="intenselect")
track.to_dataframe()
track.selected
probe = conus.read_probe("in/probe.json")
nested.contacts(probe, origin=(0, -20, 0), direction=(0, 1, 0.1)).to_dataframe()
found = conus.verify("python/rows.tsv"); print(found.verdict, found.why, found.differences)
print(conus.cite("python/rows.tsv"))

conus.load(np.zeros((3, 3)))
conus.load(None)
conus.load([[["a"]]])
conus.load(np.full((3, 3, 3), NAN), affine)
conus.load(np.full((3, 3, 3), 0.5), affine)
conus.load(np.full((3, 3, 3), 2**33, "u8"), affine)
conus.load(array)
conus.load(array, [["a"] * 4] * 4)
conus.load(array, np.zeros((4, 4)))
conus.load(array, affine, labels=["left"])
conus.load(array, affine, labels={-1: "x"})
conus.load(array, affine, labels={1.5: "x"})
conus.load(array, affine, labels={"x": "x"})
conus.load(array, affine, labels=pandas.DataFrame({"index": [1]}))
conus.load(array, affine, labels=pandas.DataFrame({"index": [1], "name": ["x"], "hemisphere": ["LR"]}))
conus.load(array, affine, pathways=[array])
conus.load(array, affine, pathways="tract.nii")
conus.load(array, affine, pathways=["no such file"])
conus.load(array, affine, context="no such file")
conus.load(array, affine, context_blocks=0.5)
conus.load(array, affine, only=3)
conus.load(array, affine, only="")
conus.load(array, affine, hide="nothing")
conus.load(array, affine, max_memory=-1)
conus.load(array, affine, hemispheres="both")
conus.load(array, affine, transforms=["no such file"])
conus.load(array, affine, streamlines=["in/tree.tsv"])
conus.load(array, affine, unknown=1)
conus.load("a\\0b")
conus.load("in")
conus.load("no such atlas")
conus.load("in/tree.tsv")
conus.load("ph/brain/brain-context.nii.gz")
conus.load("ph/nested.nii.gz", labels="in/window-nested.txt")
conus.load("ph/nested.nii.gz", max_memory=1000)
conus.load("ph/nested.nii.gz", transforms=["in/tree.tsv"])

nested.select()
nested.select((0, 0, 0))
nested.select((0, 0, 0), toward=(0, 0, 0))
nested.select((0, 0), direction=(1, 0, 0))
nested.select((0, 0, NAN), direction=(1, 0, 0))
nested.select((0, 0, 0), direction=(1, 0, 0), toward=(1, 0, 0))
nested.select(**{**aim, "angle": 180})
nested.select(**aim, radius=1)
nested.select(**aim, layers="none")
nested.select(**aim, score="nothing")
nested.select(**aim, score="0.5*")
nested.select(**aim, level="None")
nested.select(**aim, aperture="round")
nested.select(**aim, resolution=0)
nested.select(**aim, range=(5, 2))
nested.select(**aim, sampling="some")
nested.select(**aim, engine="cpu")
nested.select(**aim, space="mni")
nested.select(**aim, unknown=1)
nested.select(pose=np.zeros((4, 4)))
nested.near((0, 0))
nested.near((0, 0, 0), -1)
nested.near("a")
nested.sweep()
nested.jitter(**aim)
nested.jitter(**aim, degrees=-1, mm=0)
nested.jitter(**aim, degrees=1, mm=1, samples=63)
nested.connectivity()
nested.overlap("no such file")
nested.overlap(array)
nested.select_many(origins, directions[:2])
nested.select_many(origins)
nested.select_many(poses=np.zeros((3, 3)))
nested.select_many(origins, directions, angle=[1, 2])
nested.track([0, 0], origins[:2], directions[:2])
nested.plan({}, {}, origins=entries, directions=ways, depth=10)
nested.plan({"None": 1}, {}, origins=entries, directions=ways, depth=10)
nested.plan({"Core": -1}, {}, origins=entries, directions=ways, depth=10)
nested.plan({"Core": 1}, {"Core": 200}, origins=entries, directions=ways, depth=10)
nested.plan({"Core": 1}, {}, origins=entries, directions=ways)
nested.find("None")
nested.select(**aim).image("Q")
nested.select(**aim).mask().shape
nested.select(**aim).streamlines()

conus.read_poses("no such file")
conus.read_poses("in/tree.tsv")
conus.read_poses("in/quaternion.tsv", format="none")
conus.read_poses("in/quaternion.tsv", axis="up")
conus.read_poses("in/lines.mrk.json", space="ccf")
conus.read_probe("in/tree.tsv")
conus.read_probe("no such file")
conus.verify("in/ball.tsv")
conus.cite("in/ball.tsv")
conus.verify("no such file")
"""


def is_expression(call):
    try:
        return bool(compile(call, "call", "eval"))
    except SyntaxError:
        return False


def show(value):
    if isinstance(value, (pandas.DataFrame, pandas.Series)):
        print(value.to_string(max_colwidth=200))
    elif value is not None:
        print(value)


warnings.simplefilter("always")
warnings.showwarning = lambda message, category, *_: print(f"{category.__name__}: {message}")
notes = logging.StreamHandler(sys.stdout)
notes.setFormatter(logging.Formatter("%(levelname)s: %(message)s"))
logging.getLogger("conus").addHandler(notes)
logging.getLogger("conus").setLevel(logging.INFO)
np.set_printoptions(precision=5)
names = dict(globals())
for call in filter(None, CALLS.split("\n")):
    print(f">>> {call}")
    try:
        show(eval(call, names) if is_expression(call) else exec(call, names))  # pylint: disable=eval-used,exec-used
    except Exception as error:  # pylint: disable=broad-except
        print(f"{type(error).__name__}: {error}")
