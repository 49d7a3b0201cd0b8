#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""tests/architecture/check_system.py: only base/system asks the operating system.

All other folders include headers of ISO C, of named libraries, pthread.h and strings.h, and call no function that is
another one on another system: base/system/system.h has those, base/text.h what only GNU's library has. The files that
may more are named below, with the reason; one that has become needless is an error. Each rule has an example that
breaks it, which the rule must find, so that none is blind.
"""
import fnmatch
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
ROOMS = "base sources atlas poses loaders render selection pack include apps".split()

ISO_C = """assert ctype errno fenv float inttypes limits locale math setjmp stdalign stdarg stdatomic stdbool stddef stdint
    stdio stdlib string time"""
LIBRARIES = """jansson libdeflate zlib zstd expat nettle/* epoxy/* png openexr cairo* ft2build embree?/*
    GLFW/* imgui* backends/imgui* spnav X11/Xlib hdf5 vtk* *mmintrin wasm_simd128 emscripten cpuid conus/*"""
HEADERS = [f"{name}.h" for name in f"{ISO_C} pthread strings {LIBRARIES}".split()]
CXX = re.compile(r"[a-z_]+")  # C++ has no ending

# Files that include and call what they like, and why. The rooms of labels, catalogue and scene are written anew.
FREE = {
    "base/system/*": "is the room of the system",
    "base/child/process_*.c": "start processes",
    "apps/link/station.c": "has sockets",
    "apps/viewer/devices/spacemouse.c": "has a socket",
    "apps/hdf5/memory_space.c": "limits a libhdf5 of the system, on Linux",
    "apps/mesh/*": "is started by child.c, on Linux",
    "apps/web/web.c": "is for emscripten alone",
}

# What is another function elsewhere: words, names, an example.
NAMES = [
    ("files are opened and made by base/system", """open openat creat fopen freopen fmemopen? open_memstream mkostemps? mkstemps?
     mkdtemp mkdirat? mkfifo pipe2? memfd_create""", 'FILE *file = fopen(path, "r");'),
    ("files are asked about, moved and removed by base/system", """[fl]?stat fstatat access faccessat opendir fdopendir readdir
     scandir nftw rename renameat unlink unlinkat rmdir linkat? symlink realpath readlink getcwd chdir futimens utimensat
     umask fchmod statfs statvfs fstatvfs""", "if (stat(path, &info) == 0) {"),
    ("reading and writing at a place, mapping and locking are those of base/system", """pread pwrite readv writev mmap munmap
     madvise flock fsync fdatasync posix_fallocate""", "munmap(memory, size);"),
    ("signals, processes and limits are those of base/system and base/child", """sigaction signal sigfillset sigemptyset
     pthread_sigmask kill alarm v?fork execv[pe]* waitpid posix_spawnp? prctl [gs]etrlimit [gs]etpriority
     sched_getaffinity sysconf getentropy""", "sigfillset(&all);"),
    ("libraries, waiting and terminals are those of base/system", "dlopen dlsym dlclose poll select eventfd ioctl",
     "while (poll(wanted, 2, -1) < 0) {"),
    ("text is that of base/text.h: only GNU's library has this", """memmem memrchr mempcpy rawmemchr strchrnul stpcpy
     strsep strndup strcasestr fnmatch getline getdelim""", "char *word = strsep(&rest, \" \");"),
]
WORDS = [
    ("a path has SYSTEM_PATH bytes, a name SYSTEM_NAME", r"\b(?:PATH|NAME)_MAX\b", "char path[PATH_MAX];"),
    ("macros of a system's header stand in base/system", r"\b(?:[ORWXF]_OK|S_IS[A-Z]+|O_[A-Z]{4,}|SIG[A-Z]{3,}|st_mode)\b",
     "if (S_ISDIR(info.st_mode)) {"),
]
RULES = [(words, rf"(?<![\w.>])(?:{'|'.join(names.split())})\s*\(", example) for words, names, example in NAMES] + WORDS
INCLUDE = re.compile(r'^\s*#\s*include\s*<([^>]+)>', re.M)


def without_comments(text):
    """Comments and texts leave their lines."""
    blank = lambda match: re.sub(r"[^\n]", " ", match[0])
    return re.sub(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"', blank, text, flags=re.S)


def is_allowed(header):
    return any(fnmatch.fnmatchcase(header, name) for name in HEADERS) or CXX.fullmatch(header)


def findings(text):
    """Line and words of each."""
    code = without_comments(text)
    for match in INCLUDE.finditer(code):
        if not is_allowed(match[1]):
            yield match.start(1), f"<{match[1]}> is a header of the system, or of a library that is not named"
    for words, pattern, _ in RULES:
        for match in re.finditer(pattern, code):
            yield match.start(), words


def check_rules():
    """Each rule finds its example, and neither a member nor a function of ours of that name."""
    yield from (f"blind: {words}" for words, _, example in RULES if words not in [found for _, found in findings(example)])
    yield from (f"blind: {header}" for header in ("unistd.h", "sys/stat.h", "signal.h", "fnmatch.h", "vtk/stat.hpp")
                if is_allowed(header))
    right = '#include <stdio.h>\nreader->open(x); file.stat(y); system_stat(z); my_open(a); /* open(b) */ "open(c)";'
    yield from (f"finds what is right: {words}" for _, words in findings(right))


FAULTS = list(check_rules())
UNUSED = set(FREE)
for path in sorted(path for room in ROOMS for path in (ROOT / room).rglob("*") if path.suffix in (".c", ".h", ".cpp")):
    name = path.relative_to(ROOT).as_posix()
    text = path.read_text()
    found = [f"{name}:{text.count(chr(10), 0, at) + 1}: {words}" for at, words in findings(text)]
    free = [pattern for pattern in FREE if fnmatch.fnmatchcase(name, pattern)]
    FAULTS += [] if free else found
    UNUSED -= set(free) if found else set()
FAULTS += [f"{pattern} may what it does not: delete the line" for pattern in sorted(UNUSED)]
print("\n".join(FAULTS))
sys.exit(1 if FAULTS else 0)
