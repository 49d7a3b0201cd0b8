# SPDX-License-Identifier: BSD-3-Clause
"""in_slicer.py FOLDER ATLAS LABELS: 3D Slicer's own parser takes the forms in FOLDER, and its logic runs conus query on a label
map, a colour table and a line of its scene. Prints the rows of the table that comes back. PyPI's slicer-core; in a
process of its own, since Slicer's nodes outlive Python's."""
import ctypes
import glob
import json
import os
import pathlib
import sys
import tempfile

import slicer
import slicer_core
import vtk

folder, atlas_file, label_file = sys.argv[1:]
libraries = os.path.dirname(slicer_core.__file__)
std = ctypes.CDLL("libstdc++.so.6", ctypes.RTLD_GLOBAL)
parser = ctypes.CDLL(glob.glob(libraries + "/third_party.libs/libModuleDescriptionParser.so")[0], ctypes.RTLD_GLOBAL)
cli = ctypes.CDLL(libraries + "/libMRMLCLI.so", ctypes.RTLD_GLOBAL)


def old_string(value):
    """A std::string of the old ABI, which the wheel has."""
    out, spare = ctypes.create_string_buffer(64), ctypes.create_string_buffer(8)
    std._ZNSsC1EPKcRKSaIcE(out, ctypes.c_char_p(value), spare)
    return out


def register(form):
    """Neither the parser nor RegisterModuleDescription() is wrapped for Python: they are called by their names of C++."""
    module = ctypes.create_string_buffer(1 << 16)  # larger than any ModuleDescription
    parser._ZN17ModuleDescriptionC1Ev(module)
    parse = parser._ZN23ModuleDescriptionParser5ParseERKSsR17ModuleDescription
    assert not parse(ctypes.create_string_buffer(64), old_string(form.read_bytes()), module), form
    for name, value in (("9SetTarget", str(form.with_suffix(".py"))), ("7SetType", "CommandLineModule"), ("11SetLocation", "")):
        getattr(parser, f"_ZN17ModuleDescription{name}ERKSs")(module, old_string(value.encode()))
    cli._ZN28vtkMRMLCommandLineModuleNode25RegisterModuleDescriptionE17ModuleDescription(module)


scene = slicer.vtkMRMLScene()
for kind in ("vtkMRMLCommandLineModuleNode", "vtkMRMLMarkupsLineNode", "vtkMRMLMarkupsJsonStorageNode"):
    if not scene.GetClassNameByTag(getattr(slicer, kind)().GetNodeTagName()):
        scene.RegisterNodeClass(getattr(slicer, kind)())
forms = sorted(pathlib.Path(folder).glob("*.xml"))
for one in forms:
    register(one)
titles = [slicer.vtkMRMLCommandLineModuleNode.GetRegisteredModuleNameByIndex(i) for i in range(len(forms))]
node = slicer.vtkMRMLCommandLineModuleNode()
node.SetModuleDescription(next(title for title in titles if title.startswith("conus query")))
scene.AddNode(node)

atlas = scene.AddNewNodeByClass("vtkMRMLLabelMapVolumeNode", "atlas")
store = slicer.vtkMRMLVolumeArchetypeStorageNode()
scene.AddNode(store)
store.SetFileName(atlas_file)
store.SetSingleFile(1)
assert store.ReadData(atlas)
names = dict(line.split()[:2] for line in open(label_file, encoding="latin-1") if len(line.split()) > 1)
colours = scene.AddNewNodeByClass("vtkMRMLColorTableNode", "names")
colours.SetTypeToUser()
colours.SetNumberOfColors(max(map(int, names)) + 1)
for label, name in names.items():
    colours.SetColor(int(label), name, .5, .5, .5, 1.0)
line = scene.AddNewNodeByClass("vtkMRMLMarkupsLineNode", "needle")
line.AddControlPoint(vtk.vtkVector3d(-90, 20, 20))
line.AddControlPoint(vtk.vtkVector3d(0, -10, 10))
table = scene.AddNewNodeByClass("vtkMRMLTableNode", "answer")

with tempfile.TemporaryDirectory() as scratch:
    application = slicer.vtkSlicerApplicationLogic()
    application.SetMRMLScene(scene)
    application.SetTemporaryPath(scratch)
    logic = slicer.vtkSlicerCLIModuleLogic()
    logic.SetMRMLScene(scene)
    logic.SetMRMLApplicationLogic(application)
    logic.SetDeleteTemporaryFiles(1)
    for key, value in {"atlas": atlas.GetID(), "labels": colours.GetID(), "pose": line.GetID(), "output": table.GetID(),
                       "angle": "20"}.items():
        node.SetParameterAsString(key, value)
    logic.ApplyAndWait(node, False)
    assert node.GetStatusString() == "Completed", node.GetErrorText()
    written, = pathlib.Path(scratch).glob("*.tsv")  # Slicer's own reading, by its window's queue, does not run here
    print("\n" + json.dumps({"title": node.GetModuleTitle(), "rows": written.read_text()}))
