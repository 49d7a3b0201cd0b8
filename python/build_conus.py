# SPDX-License-Identifier: BSD-3-Clause
"""build_conus.py FILE.py [FOLDER...]: writes the module conus._declarations, by cffi.

The declarations are the headers, public ones and own.h, without what only a compiler needs. So a function that is in
the headers is in the module, with the types that the headers say. Beside them stand the headers' version
and the folders in which the package looks for the library, from its own, which is the first.
"""
import pathlib
import re
import sys

import cffi

HERE = pathlib.Path(__file__).resolve().parent
HEADERS = HERE.parent / "include" / "conus"


def read_header(name, seen):
    """The header's text, with those that it includes before it, each once."""
    if name in seen:
        return ""
    seen.add(name)
    text = (HEADERS / name).read_text()
    included = re.findall(r"^#include <conus/(.*)>", text, re.M)
    return "".join(read_header(other, seen) for other in included) + text


def declarations():
    text = read_header("own.h", set())
    text = re.sub(r"/\*.*?\*/", "", text, flags=re.S)
    text = re.sub(r"#ifdef __cplusplus.*?#endif", "", text, flags=re.S)
    text = re.sub(r"^#(?:.*\\\n)*.*$", "", text, flags=re.M)
    return re.sub(r"\bCONUS_(API|CHECKED)\b", "", text)


def version():
    text = (HEADERS / "version.h").read_text()
    return ".".join(re.findall(r"#define CONUS_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", text))


def write_module(path, folders):
    ffi = cffi.FFI()
    ffi.cdef(declarations())
    ffi.set_source("conus._declarations", None)
    ffi.emit_python_code(path)
    with open(path, "a", encoding="utf-8") as file:
        file.write(f"VERSION = {version()!r}\nFOLDERS = {['', *folders]!r}\n")


if __name__ == "__main__":
    write_module(sys.argv[1], sys.argv[2:])
