#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""tests/architecture/check_layers.py BUILD: every #include goes along the arrows of docs/architecture.md.

The table below names, for each folder, the folders whose headers it may include. Each file may include the headers of
its own folder. A folder with sources that the table lacks is an error, and so are an arrow that no include uses, and an
include that names no file of the project.

So are circles of any length: between files, where one file's object of the build folder BUILD uses a symbol that the
other's defines, and between folders, where one folder includes another's header or uses its symbol. They are printed
with the arrows that make them.

A folder has one header that other folders include, and one that only it includes. APART names the others, with the
reason; a name that has become needless is an error.
"""
import collections
import itertools
import json
import pathlib
import re
import subprocess
import sys

BUILD = pathlib.Path(sys.argv[1]).resolve()
ROOT = pathlib.Path(re.search("CMAKE_HOME_DIRECTORY:INTERNAL=(.*)", (BUILD / "CMakeCache.txt").read_text())[1])

PUBLIC = "include/conus"
APPS = {
    "apps/link": "apps/options",
    "apps/options": "",
    "apps/settings": "apps/link apps/options",
    "apps/figures": "apps/options",
    "apps/pages": "apps/options",
    "apps/cli/batch": "apps/options apps/settings apps/cli/answers",
    "apps/cli/answers": "apps/options apps/settings",
    "apps/cli/verify": "apps/options apps/cli/answers",
    "apps/cli/cite": "apps/options",
    "apps/cli/mcp": "apps/options apps/pages apps/cli/answers",
    "apps/cli": "apps/link apps/options apps/settings apps/figures apps/pages apps/cli/batch apps/cli/answers"
    " apps/cli/verify apps/cli/cite apps/cli/mcp",
    "apps/mesh": "loaders/extraction",  # mesh_protocol.h: the messages between conus and conus-mesh
    "apps/web": "atlas/nets apps/options apps/pages",  # surfaces for a headset, which no other program asks for
    "apps/hdf5": "base base/child",  # hdf5_protocol.h: the messages between conus and conus-hdf5
    "apps/viewer/pictures": "apps/link apps/options",
    "apps/viewer/devices": "apps/link",
    "apps/viewer/model": "apps/options apps/settings apps/figures apps/viewer/pictures",
    "apps/viewer/tools": "apps/link apps/options apps/settings apps/viewer/devices apps/viewer/model",
    "apps/viewer/ui": "",
    "apps/viewer/window": "apps/options apps/figures apps/viewer/pictures apps/viewer/model apps/viewer/tools"
    " apps/viewer/ui",
    "apps/viewer/session": "apps/options apps/viewer/model apps/viewer/window",
    "apps/viewer/commands": "apps/options apps/settings apps/viewer/model apps/viewer/tools apps/viewer/ui"
    " apps/viewer/window apps/viewer/session",
    "apps/viewer/panes": "apps/options apps/settings apps/viewer/pictures apps/viewer/model apps/viewer/tools apps/viewer/ui"
    " apps/viewer/window apps/viewer/commands",
    "apps/viewer/opening": "apps/options apps/settings apps/viewer/model apps/viewer/window apps/viewer/session",
    # loop.c joins the panes and panels; the window itself knows neither.
    "apps/viewer": "apps/link apps/options apps/settings apps/pages apps/viewer/model apps/viewer/ui"
    " apps/viewer/window apps/viewer/panes apps/viewer/session apps/viewer/commands apps/viewer/opening",
}
LIBRARY = {
    "base": "base/system",
    "base/system": "",
    "base/files": "base base/system",
    "base/simd": "",
    "base/geometry": "base",
    "base/child": "base base/files base/system base/job",
    "base/formats": "base base/files base/job base/child",
    "base/job": "base base/files",
    "atlas/surface": "base base/geometry",
    "atlas/deformation": "base base/geometry",
    "atlas/tracts": "base base/files base/geometry base/simd",
    "atlas/labels": "base",
    "atlas": "base base/files base/geometry atlas/surface atlas/deformation atlas/tracts atlas/labels",
    "atlas/areas": "base base/files base/geometry atlas/labels atlas",
    "atlas/warp": "base base/geometry atlas/deformation atlas",
    "atlas/fit": "base base/geometry atlas/surface atlas",
    "atlas/nets": "base atlas atlas/fit",
    "atlas/phantom": "base base/geometry atlas/labels atlas/surface atlas",
    "poses/rows": "base base/files base/formats base/geometry base/job base/system sources",
    "poses/programs": "base base/files base/child base/geometry base/formats poses/rows",
    "poses": "base base/child base/geometry base/formats base/system sources poses/rows poses/programs",
    # What a file is, for every room that reads files. It knows none of their readers.
    "sources": "base base/files base/formats base/child base/job base/system",
    # refuse.c asks the table of formats, and the readers of label tables.
    "loaders": "base/formats loaders/labels sources",
    "loaders/tiff": "base base/job sources",
    "loaders/zarr": "base base/formats base/job base/system",
    "loaders/brainglobe": "base base/job base/geometry base/formats base/system",
    "loaders/tracts": "base base/job base/files base/geometry base/formats atlas/tracts loaders loaders/surfaces/foreign sources",
    "loaders/volumes/text": "base base/job base/geometry atlas/labels atlas",
    "loaders/volumes": "base base/files base/child base/geometry base/formats base/job atlas/labels atlas"
    " loaders loaders/tiff loaders/zarr loaders/brainglobe loaders/volumes/text sources loaders/labels",
    "loaders/cifti": "base base/files base/geometry base/formats loaders/volumes loaders/labels"
    " sources",
    "loaders/labels": "base base/system base/job base/files base/geometry base/formats atlas/labels sources",
    "loaders/extraction": "base base/child base/job base/system atlas/surface atlas",
    "loaders/surfaces/foreign": "base base/geometry base/formats base/job atlas/labels atlas/surface loaders sources",
    "loaders/surfaces": "base base/job base/files base/geometry base/formats atlas/labels atlas/surface atlas loaders"
    " loaders/labels loaders/cifti loaders/extraction loaders/surfaces/foreign sources loaders/volumes",
    "loaders/phantom": "base base/files base/geometry atlas/labels atlas atlas/phantom loaders/volumes loaders/surfaces",
    "loaders/manifest": "base base/files base/formats base/job atlas/labels atlas/surface atlas/areas loaders/volumes loaders/labels sources",
    "loaders/transform": "base base/job base/files base/geometry base/child atlas/deformation atlas loaders loaders/volumes sources",
    "loaders/maps": "base base/job base/files base/child base/geometry atlas atlas/fit loaders/volumes loaders/labels"
    " loaders/manifest sources",
    "loaders/scene": "base base/files base/geometry base/formats base/job atlas/labels atlas/surface atlas atlas/areas atlas/fit"
    " atlas/warp loaders/maps loaders loaders/volumes loaders/labels loaders/cifti loaders/surfaces/foreign loaders/surfaces"
    " loaders/manifest loaders/transform loaders/tracts loaders/brainglobe sources",
    "loaders/catalogue": "base base/system base/files base/formats base/job loaders/brainglobe loaders/volumes loaders/labels sources",
    "loaders/arrays": "base atlas atlas/areas loaders/labels loaders/maps loaders/volumes loaders/scene loaders/tracts",
    "render/gl": "base base/geometry base/system",
    "render/passes": "base base/geometry atlas/surface atlas render/gl",
    "render/draw": "base base/formats",
    "render/image": "base base/files render/draw",
    "render/colour": "base base/files base/geometry base/system atlas render/gl render/passes render/image",
    "render/flat": "base base/geometry atlas render/draw render/colour",
    "selection/cone": "base base/geometry poses/rows",
    "selection/evidence": "base atlas selection/cone",
    "selection/engine/voxels": "base base/simd base/geometry atlas selection/evidence",
    "selection/engine/triangles": "base base/geometry atlas/surface selection/evidence",
    "selection/engine/tracts": "base base/simd base/geometry atlas/tracts selection/evidence",
    "selection/engine": "base base/geometry atlas render/gl render/passes selection/cone selection/evidence selection/engine/voxels"
    " selection/engine/tracts selection/engine/triangles",
    "selection/region": "base/simd base/geometry atlas/tracts atlas selection/cone",
    "selection/weight": "base base/geometry poses/rows sources selection/cone",
    "selection/measure": "base base/geometry atlas/surface atlas/tracts atlas selection/cone selection/evidence selection/region"
    " selection/weight",
    "selection/table": "base base/geometry atlas selection/cone",
    "selection/lists": "base base/geometry selection/table",
    "selection": "base base/geometry atlas atlas/areas poses/rows selection/region selection/evidence selection/engine selection/measure"
    " selection/weight",
    "selection/study": "base base/geometry atlas/surface atlas poses/rows selection/measure selection/table selection",
    "selection/plan/together": "base base/geometry poses/rows selection/table",
    "selection/plan": "base base/geometry atlas/surface atlas/tracts atlas atlas/areas poses poses/rows selection/evidence"
    " selection/measure selection selection/study selection/report selection/batch selection/table selection/plan/together",
    "selection/connectivity": "base base/geometry atlas/surface atlas selection/measure selection/engine/voxels selection/table selection",
    "selection/picture": "base base/geometry render/draw render/image render/colour render/flat selection/measure selection"
    " selection/study",
    "selection/report": "base base/geometry atlas poses/programs selection selection/connectivity selection/plan/together selection/study selection/table"
    " selection/weight",
    "pack": "base base/files base/geometry base/system atlas atlas/tracts loaders/maps loaders/scene selection/engine/voxels sources",
    "selection/batch": "base base/geometry base/system poses poses/rows selection selection/study selection/report",
}
RULES = {**LIBRARY, **APPS}
# What programs link beside the library (conus_system in base/CMakeLists.txt, conus_keys in sources), and vectors, which
# are inline.
SHARED = {"base/child/process.h", "base/geometry/math3.h", "base/look.h", "base/order.h", "base/path.h",
          "base/system/system.h", "base/text.h", "base/writer.h", "sources/names.h"}
# {folder: (headers beside its one for others and its one for itself, why)}.
APART = {
    "apps/cli": ("cmd_plan cmd_render request", "parts of some commands; commands.h lists all of them"),
    "apps/hdf5": ("memory_limit", "is compiled into libhdf5 (scripts/libraries)"),
    "apps/options": ("messages output progress provenance", "messages are for everyone, options for commands, files for"
                     " who writes some, progress for long work; sidecars need JSON and SHA-256"),
    "apps/viewer/model": ("additions columns", "know files and lists, and no state of the window"),
    "apps/viewer/session": ("property", "is a table, which keys and scripts read, too"),
    "apps/viewer/window": ("start", "is the page without an atlas, and what is kept between runs"),
    "atlas": ("space volume", "a grid is known before there are voxels, and engines know volumes only"),
    "atlas/surface": ("mesh_space", "is C++, too, in conus-mesh"),
    "atlas/tracts": ("tract_leaf_lanes tract_node", "a kernel's body, and memory that engines walk themselves"),
    "base": ("byte_order library look options order path status text threads tolerance writer",
             "each is one word of all others' vocabulary, and programs may use some of them (SHARED)"),
    "base/child": ("hdf5 hdf5_protocol process", "what is asked of conus-hdf5, what conus-hdf5 itself includes, and what"
                   " programs have, too (SHARED)"),
    "base/formats": ("encoding json_text matlab table xml", "are as many formats, some with libraries"),
    "base/simd": ("lanes", "is the vocabulary of kernels, which define LANES first"),
    "loaders/extraction": ("mesh_protocol", "is C++, too, in conus-mesh"),
    "loaders/labels": ("label_format", "is for readers of other files that have entries of such tables"),
    "poses/rows": ("columns", "tables whose columns are guessed; most know rows only"),
    "render/gl": ("camera", "needs no OpenGL"),
    "render/passes": ("shapes", "needs no OpenGL"),
    "selection/engine/triangles": ("embree", "includes Embree"),
    "selection/engine/voxels": ("distance_map traverse_lanes", "maps are packed with an atlas; a kernel's body"),
    "selection/measure": ("score", "knows results only, and not how they are measured"),
    "sources": ("names", "programs have it beside the library (SHARED)"),
}
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
            if target in (room, PUBLIC) or (room in APPS and header.as_posix() in SHARED):
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
    return faults


def check_headers():
    """Faults of folders with more headers than one for others and one for themselves."""
    users = {path.relative_to(ROOT): set() for path in find_sources() if path.suffix == ".h"}
    for path in find_sources():
        for header in {find_header(path, name) for name in INCLUDE.findall(path.read_text())} & set(users):
            users[header].add(path.parent.relative_to(ROOT))
    faults = [f"{folder}/{name}.h stands apart, but is not there" for folder, (names, _) in APART.items()
              for name in names.split() if not (ROOT / folder / f"{name}.h").is_file()]
    for folder in sorted({header.parent for header in users}):
        apart = APART.get(folder.as_posix(), ("", ""))[0].split()
        for whose in ("other folders", "only its own files"):
            headers = {header.stem for header in users if header.parent == folder
                       and bool(users[header] - {folder}) == (whose == "other folders")}
            joined = sorted(headers - set(apart))
            if len(joined) > 1:
                faults.append(f"{folder}: {whose} include {', '.join(joined)}: make one header of them")
            if headers and not joined:
                faults.append(f"{folder}: {' '.join(sorted(headers))} need not all stand apart: no other is there")
    return faults


def find_objects():
    """{object: source}, both as paths, of the product's sources that BUILD compiles. Generated sources are left out."""
    objects = {}
    for entry in json.loads((BUILD / "compile_commands.json").read_text()):
        source, output = pathlib.Path(entry["file"]), re.search(r" -o (\S+)", entry["command"])
        path = pathlib.Path(entry["directory"]) / output[1]
        if source.is_relative_to(ROOT) and not source.is_relative_to(BUILD) and path.is_file():
            name = source.relative_to(ROOT)
            if name.parts[0] != "tests":
                objects[str(path)] = name.as_posix()
    return objects


def find_calls():
    """{(file, file): symbols of the second that the first uses}."""
    objects = find_objects()
    if not objects:
        return {}
    defined, used = collections.defaultdict(set), collections.defaultdict(set)
    listing = subprocess.run(["nm", "-A", "-P", "-g", *objects], capture_output=True, text=True, check=True).stdout
    for line in listing.splitlines():
        path, name, kind = line.split()[:3]
        (used if kind in "Uwv" else defined)[name].add(objects[path[:-1]])
    calls = collections.defaultdict(set)
    for name, users in used.items():
        # A name that several files define is main(), an inline function of C++, or a file's second copy for another
        # program.
        for user, owner in itertools.product(users, defined[name]):
            if user != owner and len(defined[name]) == 1:
                calls[user, owner].add(name)
    return calls


def find_includes():
    """{(folder, folder): headers of the second that the first includes}."""
    includes = collections.defaultdict(set)
    for path in itertools.chain.from_iterable((ROOT / top).rglob("*") for top in {room.split("/")[0] for room in RULES}):
        if path.suffix in (".c", ".h", ".cpp", ".hpp"):
            for name in INCLUDE.findall(path.read_text()):
                header = find_header(path, name)
                if header and header.parent not in (path.parent.relative_to(ROOT), pathlib.Path(PUBLIC)):
                    includes[path.parent.relative_to(ROOT).as_posix(), header.parent.as_posix()].add(
                        f"{path.name} includes {header.name}")
    return includes


def find_circles(arrows):
    """The sets of nodes that reach each other along arrows (strongly connected components), larger than one node."""
    targets = collections.defaultdict(set)
    for source, target in arrows:
        targets[source].add(target)
    index, low, stack, circles = {}, {}, [], []

    def visit(node):  # Tarjan's algorithm
        index[node] = low[node] = len(index)
        stack.append(node)
        for target in sorted(targets[node]):
            if target not in index:
                visit(target)
            if target in stack:
                low[node] = min(low[node], low[target])
        if low[node] == index[node]:
            circle = set(itertools.takewhile(lambda other: other != node, reversed(stack))) | {node}
            del stack[-len(circle):]
            if len(circle) > 1:
                circles.append(circle)

    sys.setrecursionlimit(10000)
    for node in sorted({source for source, _ in arrows}):
        if node not in index:
            visit(node)
    return circles


def print_circles(what, arrows):
    """Prints the circles, largest first. Returns how many."""
    circles = sorted(find_circles(arrows), key=lambda circle: (-len(circle), sorted(circle)))
    for circle in circles:
        print(f"a circle of {len(circle)} {what}: {' '.join(sorted(circle))}")
        for (source, target), reasons in sorted(arrows.items()):
            if {source, target} <= circle:
                more = f" and {len(reasons) - 4} more" if len(reasons) > 4 else ""
                print(f"    {source} -> {target}: {', '.join(sorted(reasons)[:4])}{more}")
    return len(circles)


def check_circles():
    files = find_calls()
    folders = collections.defaultdict(set, find_includes())
    for (source, target), names in files.items():
        rooms = source.rpartition("/")[0], target.rpartition("/")[0]
        if rooms[0] != rooms[1]:
            folders[rooms].update(f"{source.rpartition('/')[2]} uses {name}" for name in names)
    return print_circles("files", files) + print_circles("folders", folders)


FAULTS = check() + check_headers()
for fault in FAULTS:
    print(fault)
sys.exit(1 if check_circles() or FAULTS else 0)
