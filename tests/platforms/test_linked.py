#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""tests/platforms/test_linked.py: linked.py refuses what it should.

Links small programs by zig (build/zig, of scripts/packages cross), and breaks one thing in each. Exits with 77, which is
a skipped test, where there is no zig.
"""
import os
import pathlib
import struct
import subprocess
import sys
import tempfile

import linked

ROOT = pathlib.Path(__file__).resolve().parents[2]
ZIG = pathlib.Path(os.environ.get("CONUS_ZIG", ROOT / "build/zig/ziglang/zig"))
TRIPLES = {"macos-arm64": "aarch64-macos.11.0", "macos-x86-64": "x86_64-macos.11.0",
           "linux-x86-64": "x86_64-linux-gnu.2.28", "windows": "x86_64-windows-gnu"}
BUILD_ID = {"linux": ["-Wl,--build-id=sha1"], "windows": ["-Wl,--build-id"], "macos": []}
MAIN = """NEEDS
int main(void)
{
    return CONSTANT;
}
"""


class Linker:
    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.count = 0

    def link(self, target, *options, constant="0", needs="", triple=None):
        """The path of a program; `needs` is C ahead of its main()."""
        self.count += 1
        source = self.folder / f"{self.count}.c"
        out = source.with_suffix(".exe")
        source.write_text(MAIN.replace("NEEDS", needs).replace("CONSTANT", constant))
        build_id = BUILD_ID[target.split("-")[0]]
        subprocess.run([ZIG, "cc", "-target", triple or TRIPLES[target], "-O2", "-s", *build_id, "-o", out, source, *options], check=True, cwd=self.folder)
        return out


def refused(word, target, path):
    found = linked.faults(target, path)
    assert any(word in fault for fault in found), (word, found)


def changed(path, at, to):
    data = bytearray(path.read_bytes())
    data[at:at + len(to)] = to
    path.write_bytes(data)
    return path


def check_macos(linker, target):
    other = linker.folder / "libother.dylib"
    (linker.folder / "other.c").write_text("int other(void) { return 1; }\n")
    subprocess.run([ZIG, "cc", "-target", TRIPLES[target], "-shared", "-o", other, linker.folder / "other.c"], check=True)
    refused("libother.dylib", target, linker.link(target, other, needs="int other(void);", constant="other()"))
    # The headers say that freadlink() came with macOS 13.0.
    refused("_freadlink", target, linker.link(target, needs="long freadlink(int, char *, unsigned long);",
                                              constant="(int)freadlink(0, 0, 0)"))
    refused("made for macOS (13, 0)", target, linker.link(target, triple=TRIPLES[target].replace("11.0", "13.0")))
    program = linker.link(target)
    flags = struct.unpack_from("<I", program.read_bytes(), 24)[0]
    refused("PIE", target, changed(program, 24, struct.pack("<I", flags & ~0x200000)))
    refused("another processor", "macos-arm64" if target == "macos-x86-64" else "macos-x86-64", linker.link(target))
    if target == "macos-arm64":
        program = linker.link(target)
        size = len(program.read_bytes())
        byte = program.read_bytes()[0x1000]
        refused("page", target, changed(program, 0x1000, bytes([byte ^ 1])))
        refused("all bytes before it", target, changed(linker.link(target), size, b"x"))


def check_others(linker):
    # pthread_create() is one of libc's own since glibc 2.34.
    refused("GLIBC_2.34", "linux-x86-64", linker.link(
        "linux-x86-64", triple="x86_64-linux-gnu.2.34", needs="int pthread_join(unsigned long, void **);",
        constant="pthread_join(0, 0)"))
    refused("libz.so.1", "linux-x86-64", patched_needed(linker))
    refused("WS2_32", "windows", linker.link("windows", "-lws2_32", needs="int __stdcall WSACleanup(void);",
                                             constant="WSACleanup()"))


def patched_needed(linker):
    """A program that needs a library of this name."""
    library = linker.folder / "libz.so.1"
    (linker.folder / "z.c").write_text("int z(void) { return 1; }\n")
    subprocess.run([ZIG, "cc", "-target", TRIPLES["linux-x86-64"], "-shared", "-Wl,-soname,libz.so.1", "-o", library,
                    linker.folder / "z.c"], check=True)
    return linker.link("linux-x86-64", library, needs="int z(void);", constant="z()")


if not ZIG.exists():
    print(f"{ZIG} is not there: scripts/packages cross")
    sys.exit(77)
with tempfile.TemporaryDirectory() as folder:
    linker = Linker(folder)
    for target in TRIPLES:
        found = linked.faults(target, linker.link(target))
        assert not found, (target, found)
        if target.startswith("macos"):
            check_macos(linker, target)
    check_others(linker)
