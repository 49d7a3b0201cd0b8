#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""complete.py WHEEL FOLDER [TARGET]: writes the wheel into FOLDER with the libraries that it needs inside, their licences
beside them, a list of them (SPDX, in the folder sboms), the page where scripts/web has made it in build/web, and the tag
of the glibc that it needs. As auditwheel does, which Debian does not have; for Debian only, whose packages know the
licences. Needs patchelf. Of a wheel for another processor, $CC is the compiler for it, and $_PYTHON_HOST_PLATFORM says
which it is, as it does to setuptools. In a wheel of a TARGET of scripts/libraries the libraries are linked already.

A library in the wheel has a part of its SHA-256 in its name, so that it is not taken for another one of that name,
which another package has loaded. Those that libconus loads by their name when it needs them keep it. Of these
Embree, which is nine tenths of all, is left out, and found where the user has it. So is OpenGL.
"""
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
import sbom  # pylint: disable=wrong-import-position

# Every Linux that pip installs wheels of this kind on has these, of at least the versions below (PEP 600).
EVERYWHERE = re.compile(r"(linux-vdso|ld-linux[-a-z0-9]*|lib(c|m|dl|rt|pthread|gcc_s|stdc\+\+))\.so\.\d+")
LEFT_OUT = ("libconus", "libembree", "libEGL", "libGL", "libOpenGL")  # of what is loaded; the last three are a driver's
PAGE = pathlib.Path("build", "web", "apps", "web", "page.html")
FONT = pathlib.Path("/usr/share/fonts/truetype/liberation2/LiberationSans-Regular.ttf")  # which the library has inside
TARGETS = {"windows": "win_amd64", "macos-arm64": "macosx_11_0_arm64", "macos-x86-64": "macosx_11_0_x86_64",
           "linux-arm64": "manylinux_2_28_aarch64", "linux-x86-64": "manylinux_2_28_x86_64"}
NEWEST = {"GLIBCXX": (3, 4, 30), "CXXABI": (1, 3, 13), "GCC": (12, 0, 0)}  # of manylinux_2_35


def run(*command):
    return subprocess.run([str(word) for word in command], check=True, stdout=subprocess.PIPE, text=True).stdout


def linked(file):
    """The names of the libraries that a file is linked with."""
    return set(re.findall(r"\(NEEDED\).*\[(.*)\]", run("readelf", "--dynamic", "--wide", file)))


def place(file, name):
    path = pathlib.Path(run(os.environ.get("CC", "gcc"), f"-print-file-name={name}").strip())
    if not path.is_absolute():
        raise SystemExit(f"complete.py: {file}: {name} is not here")
    return path.resolve()


def loaded(file):
    """{name: path} of the libraries that the file loads by their names, which stand in it beside those that it is linked with."""
    names = {name.decode() for name in re.findall(rb"\0(lib[\w.+-]+\.so\.\d+)(?=\0)", file.read_bytes())}
    return {name: place(file, name) for name in sorted(names - linked(file)) if not name.startswith(LEFT_OUT)}


def needed(file, more):
    """Where the libraries are that a file, and more of them, need: {name: path}, these included."""
    found, files = dict(more), [file, *more.values()]
    for file in files:  # which grows
        for name in sorted(linked(file)):
            if name not in found and not EVERYWHERE.fullmatch(name):
                found[name] = place(file, name)
                files.append(found[name])
    return found


def name_inside(name, path):
    stem, rest = name.split(".so", 1)
    return f"{stem}-{hashlib.sha256(path.read_bytes()).hexdigest()[:8]}.so{rest}"


def redirect(file, names, folders):
    """Makes it look for the libraries under their new names, in folders that are relative to its own."""
    run("patchelf", "--set-rpath", ":".join(f"$ORIGIN{folder}" for folder in folders), file)
    words = [word for old, new in names.items() if old != new for word in ("--replace-needed", old, new)]
    run("patchelf", *words, file)


def copy_licence(path, folder):
    """That of the package which a library is of, which may have it in /lib or in /usr/lib. Gives the package for SPDX."""
    found = subprocess.run(["dpkg", "-S", f"*/{path.parent.name}/{path.name}"], stdout=subprocess.PIPE,
                           stderr=subprocess.DEVNULL, text=True)
    if found.returncode:
        raise SystemExit(f"complete.py: {path}: of no package, so its licence is not known")
    package = found.stdout.split(": ")[0]
    name = package.split(":")[0]
    shutil.copy(f"/usr/share/doc/{name}/copyright", folder / f"{name}.txt")
    return sbom.package(name, run("dpkg-query", "-W", "-f", "${Version}", package))


def glibc(files):
    """The oldest glibc that has all functions which the files want."""
    wanted = (2, 17, 0)
    for file in files:
        for kind, digits in re.findall(r"Name: ([A-Z]+)_(\d[\d.]*)", run("readelf", "--version-info", "--wide", file)):
            version = (*map(int, digits.split(".")), 0, 0)[:3]
            if kind == "GLIBC":
                wanted = max(wanted, version)
            elif version > NEWEST.get(kind, version):
                raise SystemExit(f"complete.py: {file.name} needs {kind}_{digits}, which other machines may not have")
    return wanted


def add_libraries(top, licences):
    """Puts in what the library and the program need; gives the platform, and the Debian packages for SPDX."""
    package, inside = top / "conus", top / "conus.libs"
    own = {package / "libconus.so.0": "", package / "bin" / "conus": "/.."}
    by_name = loaded(package / "libconus.so.0")
    paths = needed(package / "libconus.so.0", by_name)
    names = {name: name if name in by_name else name_inside(name, path) for name, path in paths.items()}
    packages = []
    inside.mkdir()
    for name, path in sorted(paths.items()):
        library = inside / names[name]
        shutil.copy(path, library)
        os.chmod(library, 0o755)
        run("patchelf", "--set-soname", names[name], library)
        redirect(library, names, [""])
        packages.append(copy_licence(path, licences))
    for file, to_package in own.items():
        redirect(file, names, [to_package, f"{to_package}/../conus.libs"])
    packages.append(copy_licence(FONT, licences))
    version = glibc([*own, *inside.iterdir()])
    unique = [package for number, package in enumerate(packages) if package not in packages[:number]]
    return f"manylinux_{version[0]}_{version[1]}_{sysconfig.get_platform().partition('-')[2]}", unique


def add_page(package, licences):
    shutil.copy(PAGE, package / "bin")
    for file in pathlib.Path("build", "web-sysroot", "licences").iterdir():
        shutil.copy(file, licences)


def main(wheel, results, target=None):
    with tempfile.TemporaryDirectory() as scratch:
        run(sys.executable, "-m", "wheel", "unpack", "--dest", scratch, wheel)
        (top,) = pathlib.Path(scratch).iterdir()
        (information,) = top.glob("*.dist-info")
        licences = information / "licenses"
        licences.mkdir(exist_ok=True)
        for file in top.glob("conus/**/*conus*"):
            if file.suffix != ".py":
                os.chmod(file, 0o755)  # wheel unpack has forgotten it
        if PAGE.exists():
            add_page(top / "conus", licences)
        else:
            print("complete.py: note: the wheel has no page; scripts/web makes it", file=sys.stderr)
        if target:
            shutil.copytree(pathlib.Path("build", f"{target}-sysroot", "licences"), licences, dirs_exist_ok=True,
                            ignore=shutil.ignore_patterns("hdf5"))  # which conus-hdf5 has, and no wheel
        platform, packages = (TARGETS[target], []) if target else add_libraries(top, licences)
        tag = f"py3-none-{platform}"
        packages += [source for source in sbom.linked() if (licences / source["name"].partition("-source-")[0]).exists()]
        (information / "sboms").mkdir()
        (information / "sboms" / "conus.spdx.json").write_text(
            sbom.document(f"{top.name}-{tag}", top.name.partition("-")[2], packages, "CONTAINED_BY"))
        kind = information / "WHEEL"
        words = kind.read_text().replace("Root-Is-Purelib: true", "Root-Is-Purelib: false")
        kind.write_text(re.sub(r"^Tag: .*$", f"Tag: {tag}", words, flags=re.M))
        results.mkdir(parents=True, exist_ok=True)
        run(sys.executable, "-m", "wheel", "pack", "--dest-dir", results, top)
    print(tag)


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4):
        raise SystemExit(__doc__)
    main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), *sys.argv[3:])
