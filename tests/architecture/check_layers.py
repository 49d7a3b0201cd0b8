#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""tests/architecture/check_layers.py [ROOT]: every #include goes along the arrows of docs/architecture.md.

The table below names, for each folder, the folders whose headers it may include. Each file may include the headers of
its own folder. A folder with sources that the table lacks is an error, and so are an arrow that no include uses, an
include that names no file of the project, and two arrows that make a circle.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else __file__).resolve()
ROOT = ROOT if ROOT.is_dir() else ROOT.parents[2]

PUBLIC = "include/conus"
APPS = {
    "apps/link": "",
    "apps/common": "apps/link",
    "apps/options": "apps/common",
    "apps/settings": "apps/link apps/common apps/options",
    "apps/figures": "apps/common apps/options",
    "apps/pages": "apps/common apps/options",
    "apps/batch": "apps/common apps/options apps/settings",
    "apps/cli/answers": "apps/common apps/options apps/settings",
    "apps/cli/verify": "apps/common apps/options",
    "apps/cli/cite": "apps/common apps/options",
    "apps/cli/pictures": "apps/common apps/options",
    "apps/cli": "apps/link apps/common apps/options apps/settings apps/figures apps/pages apps/batch apps/cli/answers"
    " apps/cli/verify apps/cli/cite apps/cli/pictures",
    "apps/mpi": "apps/common apps/pages apps/batch",
    "apps/mesh": "loaders/child",  # mesh_protocol.h: what conus and conus-mesh send each other
    "apps/viewer/pictures": "apps/link",
    "apps/viewer/devices": "apps/link",
    "apps/viewer/model": "apps/link apps/common apps/options apps/settings apps/viewer/pictures",
    "apps/viewer/tools": "apps/link apps/viewer/devices apps/viewer/model",
    "apps/viewer/ui": "",
    "apps/viewer/window": "apps/link apps/common apps/figures apps/viewer/pictures apps/viewer/devices"
    " apps/viewer/model apps/viewer/tools apps/viewer/ui",
    "apps/viewer/panes": "apps/settings apps/viewer/pictures apps/viewer/model apps/viewer/tools apps/viewer/ui"
    " apps/viewer/window",
    "apps/viewer/session": "apps/common apps/viewer/model apps/viewer/window",
    "apps/viewer/commands": "apps/common apps/settings apps/viewer/model apps/viewer/tools apps/viewer/ui"
    " apps/viewer/window apps/viewer/session",
    "apps/viewer/opening": "apps/common apps/settings apps/viewer/model apps/viewer/window apps/viewer/session",
    # draw.c joins the panes and panels; the window itself knows neither.
    "apps/viewer": "apps/link apps/common apps/settings apps/pages apps/viewer/model apps/viewer/ui"
    " apps/viewer/window apps/viewer/panes apps/viewer/session apps/viewer/commands apps/viewer/opening",
}
LIBRARY = {
    "base": "",
    "base/files": "base",
    "base/simd": "",
    "base/geometry": "base",
    "base/cache": "base base/files base",
    "base/formats": "base base/files base",
    "atlas/surface": "base base/geometry base",
    "atlas/deformation": "base base/geometry base",
    "atlas/tracts": "base base/files base/geometry base",
    "atlas/labels": "base",
    "atlas": "base base/files base/geometry atlas/surface atlas/deformation atlas/tracts atlas/labels",
    "atlas/areas": "base base/files base/geometry atlas/labels atlas",
    "atlas/warp": "base base/geometry atlas/deformation atlas",
    "atlas/fit": "base base/geometry atlas/surface atlas",
    "atlas/phantom": "base base/geometry atlas/labels atlas/surface atlas",
    "poses/rows": "base base/files base/geometry base",
    "poses/programs": "base base/files base/geometry base/formats poses/rows",
    "poses": "base base/geometry base/formats poses/rows poses/programs",
    # file_kind.c asks the readers what a file is; they ask it for the words of their errors.
    "loaders": "base base/files base/formats loaders/volumes loaders/labels loaders/surfaces",
    "loaders/tiff": "base base/files base",
    "loaders/brainglobe": "base base/files base/geometry base/formats",
    "loaders/tracts": "base base/files base/geometry base/formats atlas/tracts loaders loaders/surfaces/foreign",
    "loaders/volumes/text": "base base/geometry base/formats atlas/labels atlas loaders/volumes/stored",
    "loaders/volumes/stored": "base base/files base/cache base/formats",
    "loaders/volumes": "base base/files base/geometry base/formats atlas/labels atlas loaders/volumes/stored loaders loaders/tiff"
    " loaders/brainglobe loaders/volumes/text",
    "loaders/cifti": "base base/files base/geometry base/formats loaders/volumes loaders/labels atlas/labels",
    "loaders/labels": "base base/files base/geometry base/formats loaders loaders/volumes loaders/volumes/text atlas/labels",
    "loaders/child": "base base/files base/cache atlas/surface atlas",
    "loaders/surfaces/foreign": "base base/files base/geometry base/formats atlas/labels atlas/surface loaders",
    "loaders/surfaces": "base base/files base/geometry base/formats atlas/labels atlas/surface atlas loaders loaders/labels loaders/cifti"
    " loaders/child loaders/surfaces/foreign",
    "loaders/phantom": "base base/files base/geometry atlas/labels atlas atlas/phantom loaders/volumes loaders/surfaces",
    "loaders/manifest": "base base/files base/formats atlas/labels atlas/surface atlas/areas loaders/volumes loaders/labels",
    "loaders/transform": "base base/files base/geometry base/formats atlas/deformation loaders loaders/volumes",
    "loaders/maps": "base base/files atlas/labels atlas atlas/fit loaders/volumes loaders/labels",
    "loaders/scene": "base base/files base/geometry base/formats atlas/labels atlas/surface atlas atlas/areas atlas/fit atlas/warp loaders/maps"
    " loaders loaders/volumes loaders/labels loaders/cifti loaders/surfaces/foreign loaders/surfaces"
    " loaders/manifest loaders/transform loaders/tracts loaders/brainglobe",
    "loaders/catalogue": "base base/files base/formats loaders/volumes loaders/labels",
    "loaders/arrays": "base atlas atlas/areas loaders/maps loaders/volumes loaders/scene",
    "render/gl": "base base/geometry base",
    "render/tubes": "base base/geometry atlas render/gl",
    "render/id": "base base/geometry atlas/surface atlas/tracts atlas render/gl render/tubes",
    "render/image": "base base/files base",
    "render/colour": "base base/files base/geometry atlas render/gl render/id render/image",
    "render/flat": "base base/geometry atlas render/image render/colour",
    "selection/cone": "base base/geometry poses/rows",
    "selection/evidence": "base atlas selection/cone",
    "selection/engine/voxels": "base base/simd base/geometry atlas selection/evidence",
    "selection/engine/triangles": "base base/geometry atlas/surface selection/evidence",
    "selection/engine/tracts": "base base/simd base/geometry atlas/tracts selection/evidence",
    "selection/engine": "base base/geometry atlas render/gl render/id selection/cone selection/evidence selection/engine/voxels"
    " selection/engine/tracts selection/engine/triangles",
    "selection/region": "base/simd base/geometry atlas/tracts atlas selection/cone",
    "selection/measure": "base base/geometry atlas/surface atlas selection/cone selection/evidence selection/region",
    "selection": "base base/geometry atlas atlas/areas selection/region selection/evidence selection/engine selection/measure",
    "selection/study": "base base/geometry atlas/surface atlas selection/region selection/cone selection/measure selection",
    "selection/ends": "base base/geometry atlas/surface atlas selection/cone selection/measure selection",
    "selection/picture": "base base/geometry render/image render/colour render/flat selection/measure selection",
    "selection/report": "base base/geometry atlas poses/programs selection selection/ends selection/study",
    "cache": "base base/files base/cache atlas loaders/scene selection/batch",
    "selection/batch": "base base/geometry atlas/tracts atlas poses selection/engine/voxels selection selection/study selection/report",
}
RULES = {**LIBRARY, **APPS}
CIRCLES = {frozenset(("loaders", wing)) for wing in ("loaders/volumes", "loaders/surfaces", "loaders/labels")}
INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.MULTILINE)


def find_header(source, name):
    """The header that the compiler finds, relative to ROOT; None if the project has none."""
    for folder in (source.parent, ROOT, ROOT / "apps", ROOT / "include"):
        if (folder / name).is_file():
            return (folder / name).resolve().relative_to(ROOT)
    return None


def find_sources():
    for top in sorted({room.split("/")[0] for room in RULES}):
        for path in sorted((ROOT / top).rglob("*")):
            if path.suffix in (".c", ".h", ".cpp", ".hpp"):
                yield path


def check():
    used, faults = set(), []
    for path in find_sources():
        room = path.parent.relative_to(ROOT).as_posix()
        if room not in RULES:
            faults.append(f"{path.relative_to(ROOT)}: no rule for the folder {room}")
            continue
        for name in INCLUDE.findall(path.read_text()):
            header = find_header(path, name)
            target = header.parent.as_posix() if header else None
            if target in (room, PUBLIC):
                continue
            if target is None:
                faults.append(f'{path.relative_to(ROOT)}: "{name}" is no header of this project')
            elif target not in RULES[room].split():
                faults.append(f"{path.relative_to(ROOT)}: {header} is against the arrows: {room} may include"
                              f" {RULES[room] or 'nothing'}")
            used.add((room, target))
    for room, targets in RULES.items():
        for target in targets.split():
            if (room, target) not in used:
                faults.append(f"the arrow from {room} to {target} is not used: delete it")
            if room in RULES.get(target, "").split() and frozenset((room, target)) not in CIRCLES:
                faults.append(f"a circle: {room} and {target}")
    return faults


FAULTS = check()
for fault in FAULTS:
    print(fault)
sys.exit(1 if FAULTS else 0)
