# SPDX-License-Identifier: BSD-3-Clause
"""build_conus.py FILE.c: writes the C source of the module conus._conus.

The declarations are the public headers, without what only a compiler needs. So a function that is in
the headers is in the module, with the types that the headers say.
"""
import pathlib
import re
import sys

import cffi

HERE = pathlib.Path(__file__).resolve().parent
HEADERS = HERE.parent / "include" / "conus"

SOURCE = "#include <conus/conus.h>"
CALLBACKS = """
extern "Python" bool conus_py_receive(void *user, const conus_answers *answers);
extern "Python" void conus_py_log(void *user, const conus_note *note);
extern "Python" bool conus_py_load_progress(void *user, const char *path, size_t done, size_t total);
"""


def read_header(name, seen):
    """The header's text, with those that it includes before it, each once."""
    if name in seen or name == "export.h":
        return ""
    seen.add(name)
    text = (HEADERS / name).read_text()
    included = re.findall(r"^#include <conus/(.*)>", text, re.M)
    return "".join(read_header(other, seen) for other in included) + text


def declarations():
    text = read_header("conus.h", set())
    text = re.sub(r"/\*.*?\*/", "", text, flags=re.S)
    text = re.sub(r"#ifdef __cplusplus.*?#endif", "", text, flags=re.S)
    text = re.sub(r"^#(?:.*\\\n)*.*$", "", text, flags=re.M)
    return re.sub(r"\bCONUS_(API|CHECKED)\b", "", text) + CALLBACKS


def write_source(path):
    ffi = cffi.FFI()
    ffi.cdef(declarations())
    ffi.set_source("conus._conus", SOURCE, py_limited_api=True)
    ffi.emit_c_code(path)


if __name__ == "__main__":
    write_source(sys.argv[1])
