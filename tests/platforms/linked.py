#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""tests/platforms/linked.py TARGET FILE...: does what was linked for a target start on the oldest system we promise?

    tests/platforms/linked.py macos-arm64 build/macos-arm64/apps/cli/conus

TARGET is macos-arm64, macos-x86-64, linux-arm64, linux-x86-64 or windows; FILE a program, or a library. Each has the
target's processor, at most 4.5 MB, an identity of its build, for debuggers, and needs no library but the
system's. Besides:

    macos-*    it asks for macOS 11.0, no newer one, is loaded anywhere (PIE), and takes only functions of 11.0's
               libSystem (tests/platforms/libsystem.txt, which says how that is known); on arm64, which starts no other
               programs, it has an ad-hoc signature, whose hash of each page is computed again here
    linux-*    it takes no function that came to glibc after 2.28 (readelf)
    windows    each library is a part of Windows 10 (llvm-readobj)

Prints a line for each fault. Exit status: 0 none, 1 some, 2 wrong arguments.
"""
import hashlib
import pathlib
import re
import struct
import subprocess
import sys

LARGEST = 9 << 19
GLIBC = (2, 28)
MACHINES = {"macos-arm64": 0x0100000C, "macos-x86-64": 0x01000007, "linux-arm64": "AArch64", "linux-x86-64": "X86-64",
            "windows": "AMD64"}
LIBSYSTEM = "/usr/lib/libSystem.B.dylib"
LINUX = r"(lib(c|m)\.so\.6|lib(pthread)\.so\.0|libdl\.so\.2|librt\.so\.1|ld-linux-.*)"
WINDOWS = r"(?i)(kernel32|advapi32|shell32|ntdll|bcrypt|api-ms-win-crt-.*-l1-1-0)\.dll"


def listed(path):
    """The words of a file without its comments."""
    return set(re.sub(r"#.*", "", path.read_text()).split())


def output(*words):
    return subprocess.run(words, check=True, capture_output=True, text=True).stdout


class MachO:
    """The head of a file for macOS, by <mach-o/loader.h>, and its signature, by XNU's cs_blobs.h."""

    def __init__(self, data):
        self.data = data
        magic, self.machine, _, self.kind, count, _, self.flags, _ = struct.unpack_from("<8I", data)
        if magic != 0xFEEDFACF:
            raise ValueError("it is no file of macOS, of 64 bits")
        self.libraries, self.identity, self.oldest, self.signature, self.undefined = [], "", None, None, set()
        at = 32
        for _ in range(count):
            command, size = struct.unpack_from("<2I", data, at)
            if command in (0xC, 0x80000018, 0x8000001F):  # LC_LOAD_DYLIB, _WEAK_, LC_REEXPORT_DYLIB
                name = at + struct.unpack_from("<I", data, at + 8)[0]
                self.libraries.append(data[name:at + size].split(b"\0")[0].decode())
            elif command == 0x1B:  # LC_UUID
                self.identity = data[at + 8:at + 24].hex()
            elif command == 0x32:  # LC_BUILD_VERSION: platform 1 is macOS
                platform, version = struct.unpack_from("<2I", data, at + 8)
                self.oldest = (version >> 16, version >> 8 & 255) if platform == 1 else None
            elif command == 0x1D:  # LC_CODE_SIGNATURE
                self.signature = struct.unpack_from("<2I", data, at + 8)
            elif command == 2:  # LC_SYMTAB
                self.take_names(*struct.unpack_from("<3I", data, at + 8))
            at += size

    def take_names(self, at, count, texts):
        for i in range(count):
            name, kind, section = struct.unpack_from("<IBB", self.data, at + 16 * i)
            if kind & 0xE0 == 0 and kind & 0x0E == 0 and section == 0:  # N_STAB, N_TYPE = N_UNDF
                self.undefined.add(self.data[texts + name:].split(b"\0", 1)[0].decode())

    def signature_fault(self):
        """All numbers of a signature have their high byte first."""
        if not self.signature:
            return "it has no signature"
        start, size = self.signature
        blob = self.data[start:start + size]
        magic, _, count = struct.unpack_from(">3I", blob)
        places = [struct.unpack_from(">2I", blob, 12 + 8 * i)[1] for i in range(count)] if magic == 0xFADE0CC0 else []
        pages = [at for at in places if struct.unpack_from(">I", blob, at)[0] == 0xFADE0C02]
        if not pages:
            return "its signature has no hashes of its pages"
        code = blob[pages[0]:]
        flags, hashes, _, _, slots, limit = struct.unpack_from(">6I", code, 12)
        width, kind, _, shift = struct.unpack_from("4B", code, 36)
        if not flags & 2 or (width, kind) != (32, 2):
            return "its signature is not an ad-hoc one by SHA-256"
        if limit != start or start + size != len(self.data) or slots != -(-limit >> shift):
            return "its signature is not of all bytes before it"
        for i in range(slots):
            page = self.data[i << shift:min((i + 1) << shift, limit)]
            if hashlib.sha256(page).digest() != code[hashes + width * i:hashes + width * (i + 1)]:
                return f"its signature is not that of page {i}"
        return None


def macos_faults(path, target):
    file = MachO(path.read_bytes())
    new = file.undefined - listed(pathlib.Path(__file__).with_name("libsystem.txt"))
    yield file.machine != MACHINES[target] and "it is for another processor"
    yield file.libraries != [LIBSYSTEM] and f"it needs {', '.join(file.libraries)}, not only {LIBSYSTEM}"
    yield file.oldest != (11, 0) and f"it is made for macOS {file.oldest}, not 11.0"
    yield file.kind == 2 and not file.flags & 0x200000 and "it cannot be loaded anywhere (no PIE)"
    yield not file.undefined and "it names no function of libSystem"
    yield new and f"libsystem.txt has not {', '.join(sorted(new))}"
    yield not file.identity and "it has no identity (LC_UUID)"
    yield (target == "macos-arm64" or file.signature) and file.signature_fault()


def linux_faults(path, target):
    head = output("readelf", "-W", "--file-header", "--dynamic", "--notes", "--version-info", path)
    needed = re.findall(r"\(NEEDED\).*\[(.*)\]", head)
    new = {name for name in re.findall(r"GLIBC_[\d.]+", head) if tuple(map(int, name[6:].split("."))) > GLIBC}
    other = [name for name in needed if not re.fullmatch(LINUX, name)]
    yield not re.search(rf"Machine:.*{MACHINES[target]}", head) and "it is for another processor"
    yield other and f"it needs {', '.join(other)}"
    yield not needed and "it names no library"
    yield new and f"it needs {', '.join(sorted(new))}, newer than {GLIBC[0]}.{GLIBC[1]}"
    yield not re.search(r"Build ID: \w+", head) and "it has no identity (a build ID)"


def windows_faults(path, target):
    head = output("llvm-readobj", "--file-headers", "--coff-imports", "--coff-debug-directory", path)
    needed = re.findall(r"Import \{\s*Name: (\S+)", head)
    other = [name for name in needed if not re.fullmatch(WINDOWS, name)]
    yield f"IMAGE_FILE_MACHINE_{MACHINES[target]}" not in head and "it is for another processor"
    yield other and f"it needs {', '.join(other)}"
    yield not needed and "it names no library"
    yield "PDBGUID" not in head and "it has no identity (--build-id)"


def faults(target, path):
    path = pathlib.Path(path)
    of = {"macos": macos_faults, "linux": linux_faults, "windows": windows_faults}[target.split("-")[0]]
    try:
        found = list(of(path, target))
    except (ValueError, struct.error, subprocess.CalledProcessError) as error:
        found = [f"it cannot be read: {error}"]
    size = path.stat().st_size
    found.append(size > LARGEST and f"it has {size} bytes, more than {LARGEST}")
    return [fault for fault in found if fault]


if __name__ == "__main__":
    if len(sys.argv) == 2 and sys.argv[1] in ("-h", "--help"):
        sys.exit(print(__doc__.strip()))
    if len(sys.argv) < 3 or sys.argv[1] not in MACHINES:
        sys.exit(print(f"usage: tests/platforms/linked.py {'|'.join(MACHINES)} FILE...", file=sys.stderr) or 2)
    lines = [f"{path}: {fault}" for path in sys.argv[2:] for fault in faults(sys.argv[1], path)]
    print("\n".join(lines or [f"{sys.argv[1]}: {len(sys.argv) - 2} as promised"]))
    sys.exit(1 if lines else 0)
