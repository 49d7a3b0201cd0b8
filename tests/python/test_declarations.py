# SPDX-License-Identifier: BSD-3-Clause
"""What cffi made of the headers is what C compilers make of them: members, enumerators, and functions.

A compiler checks it, by assertions about the headers themselves. As a program it prints these.
"""
import os
import pathlib
import re
import subprocess

import pytest

from conus._conus import ffi, lib

ROOT = pathlib.Path(__file__).parents[2]
COMPILER = os.environ.get("CONUS_COMPILER")
ZIG = ROOT / "build" / "zig" / "ziglang" / "zig"
TARGETS = ["x86_64-windows-gnu", "aarch64-linux-gnu", "aarch64-macos", "x86_64-macos"]

OWN = [  # what the package calls of own.h
    "conus_atlas_attach", "conus_atlas_is_hidden", "conus_atlas_is_path", "conus_atlas_is_warped", "conus_atlas_pack",
    "conus_atlas_packed_size", "conus_catalogue_create", "conus_catalogue_destroy", "conus_catalogue_find_image",
    "conus_context_is_surface", "conus_inputs_keep", "conus_path_is_tractogram", "conus_path_is_vertex_labels",
    "conus_place_is_near", "conus_places_check", "conus_pose_array_at", "conus_pose_list_note",
    "conus_report_add_together", "conus_together_pairs", "conus_together_question", "conus_weight_path_length",
    "conus_weight_region", "conus_write_file",
]


def types():
    """{what C calls it: type} of those with a layout: structs that are not only named, and enums."""
    found = {name: ffi.typeof(name) for name in ffi.list_types()[0]}
    return {name: kind for name, kind in found.items() if getattr(kind, "fields", None) or kind.kind == "enum"}


def functions():
    """{name: type}"""
    members = {name: getattr(lib, name) for name in dir(lib)}
    return {name: ffi.typeof(member) for name, member in members.items() if not isinstance(member, int)}


def assertions():
    """In C. cffi knows no const."""
    yield "#include <stdbool.h>\n#include <stddef.h>\n#include <stdint.h>\n#define const\n#include <conus/own.h>"
    for name, kind in types().items():
        yield f'_Static_assert(sizeof({name}) == {ffi.sizeof(kind)}, "{name}");'
        for member, field in getattr(kind, "fields", None) or ():
            yield f'_Static_assert(offsetof({name}, {member}) == {field.offset}, "{name}.{member}");'
            yield ffi.getctype(field.type, f"*check_{name}_{member}") + f" = &(({name} *)0)->{member};"
        for number, constant in sorted(getattr(kind, "elements", {}).items()):
            yield f'_Static_assert({constant} == {number}, "{constant}");'
    for name, kind in functions().items():
        yield ffi.getctype(kind, f"check_{name}") + f" = {name};"


def compile_c(lines, folder, command):
    """The lines in which a compiler finds errors."""
    (folder / "declarations.c").write_text("\n".join([*lines, ""]), encoding="utf-8")
    done = subprocess.run([*command, "-std=c17", "-Werror", "-I", ROOT / "include", "-c", "declarations.c", "-o", "declarations.o"],
                          cwd=folder, env={**os.environ, **dict.fromkeys(["ZIG_GLOBAL_CACHE_DIR", "ZIG_LOCAL_CACHE_DIR"], folder)},
                          capture_output=True, text=True, check=False)
    assert bool(done.returncode) == ("error: " in done.stderr), done.stderr
    return [int(line.split(":")[1]) for line in done.stderr.splitlines() if "error: " in line]


@pytest.mark.skipif(not COMPILER, reason="no compiler in $CONUS_COMPILER")
def test_a_compiler_agrees(tmp_path):
    assert len(types()) > 100 and not compile_c(assertions(), tmp_path, [COMPILER])


@pytest.mark.skipif(os.name == "nt" or not ZIG.exists(), reason="no zig (scripts/packages cross)")
@pytest.mark.parametrize("target", TARGETS)
def test_compilers_for_other_systems_agree(tmp_path, target):
    assert not compile_c(assertions(), tmp_path, [ZIG, "cc", "-target", target])


@pytest.mark.skipif(not COMPILER, reason="no compiler in $CONUS_COMPILER")
@pytest.mark.parametrize(
    "piece, wrong",
    [
        ("sizeof(conus_result) == ", "1 + sizeof(conus_result) == "),
        ("offsetof(conus_result, rank) == ", "1 + offsetof(conus_result, rank) == "),
        ("(CONUS_ERROR_IO == ", "(1 + CONUS_ERROR_IO == "),
        ("double *check_conus_result_score", "float *check_conus_result_score"),
        ("(* check_conus_write_file)(char *, void *, size_t)", "(* check_conus_write_file)(char *, void *, double)"),
    ],
)
def test_a_compiler_finds_what_is_wrong(tmp_path, piece, wrong):
    text = "\n".join(assertions())
    assert text.count(piece) == 1
    at = text[: text.index(piece)].count("\n") + 1
    assert compile_c([text.replace(piece, wrong)], tmp_path, [COMPILER]) == [at]


def test_the_functions_are_those_of_the_library():
    symbols = (ROOT / "packaging" / "debian" / "libconus0.symbols").read_text(encoding="utf-8")
    assert sorted(functions()) == sorted(re.findall(r"^ (?:\(optional\))?(conus_\w+)@", symbols, re.M))


def test_at_most_180_functions_are_installed():
    code = [re.sub(r"/\*.*?\*/", "", path.read_text(encoding="utf-8"), flags=re.S)
            for path in (ROOT / "include" / "conus").glob("*.h") if path.name != "own.h"]
    installed = {name for text in code for name in re.findall(r"^CONUS_(?:API|CHECKED) [^(]*?\b(conus_\w+)\(", text, re.M)}
    assert 150 < len(installed) <= 180 and installed <= set(functions())


def test_the_package_uses_few_functions_that_are_not_public():
    header = (ROOT / "include" / "conus" / "own.h").read_text(encoding="utf-8")
    own = set(re.findall(r"\b(conus_\w+)\(", re.sub(r"/\*.*?\*/", "", header, flags=re.S)))
    used = {name for path in (ROOT / "python" / "conus").glob("*.py")
            for name in re.findall(r"lib\.(conus_\w+)", path.read_text(encoding="utf-8"))}
    assert sorted(own & used) == OWN


if __name__ == "__main__":
    print("\n".join(assertions()))
