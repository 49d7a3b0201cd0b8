#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""packaging/sbom.py VERSION FOLDER: writes an SPDX 2.3 document of a release: conus, the Debian packages that its library
is built with (Build-Depends), the sources of those that are in programs and wheels of other systems
(cmake/libraries.sums), and the files in FOLDER with their SHA-256. For scripts/release; packaging/wheel/complete.py
writes that of a wheel by document()."""
import datetime
import hashlib
import json
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
TOOLS = re.compile(r"cmake|debhelper.*|dh-.*|ninja-build|pkgconf")


def package(name, version, **more):
    identifier = "SPDXRef-Package-" + re.sub(r"[^A-Za-z0-9.-]", "-", name)
    return {"SPDXID": identifier, "name": name, "versionInfo": version, "downloadLocation": "NOASSERTION",
            "filesAnalyzed": False, "licenseConcluded": "NOASSERTION", "licenseDeclared": "NOASSERTION",
            "copyrightText": "NOASSERTION", **more}


def installed(name):
    """The version of a Debian package that is here."""
    shown = subprocess.run(["dpkg-query", "-W", "-f", "${Version}", name], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                           text=True)
    return shown.stdout or "NOASSERTION"


def build_depends():
    """Names of the Debian packages, and their versions where they are installed."""
    control = (ROOT / "packaging" / "debian" / "control").read_text()
    names = re.findall(r"(?m)^ ([a-z0-9.+-]+)", re.search(r"Build-Depends:\n((?: .*\n)+)", control)[1])
    for name in sorted(set(names)):
        if not TOOLS.fullmatch(name):
            yield name, installed(name)


def linked():
    """Debian's archives that scripts/libraries builds from, with their SHA-256; the font; the compilers, which add parts of their own,
    such as mingw-w64's start of a program."""
    for line in (ROOT / "cmake" / "libraries.sums").read_text().splitlines():
        if not line.startswith("#"):
            digest, archive = line.split()
            name, found = re.fullmatch(r"(.+)_(.+)\.tar\.\w+", archive).groups()
            yield package(f"{name}-source-{found.rpartition('.')[2]}", found.rpartition(".")[0], packageFileName=archive,
                          checksums=[{"algorithm": "SHA256", "checksumValue": digest}])
    found, digest = re.search(r"ziglang==(\S+) --hash=sha256:(\w+)", (ROOT / "scripts" / "packages").read_text()).groups()
    yield package("zig", found, checksums=[{"algorithm": "SHA256", "checksumValue": digest}])
    yield package("fonts-liberation2", installed("fonts-liberation2"))
    yield package("emscripten", installed("emscripten"))


def document(name, version, others, how, files=()):
    """SPDX of conus as it is in what has this name; the other packages are related to it by this word."""
    when = datetime.datetime.fromtimestamp(int(os.environ["SOURCE_DATE_EPOCH"]), datetime.timezone.utc)
    home = re.search(r'^url: "(.*)"$', (ROOT / "CITATION.cff").read_text(), re.M)[1]
    own = package("conus", version, licenseConcluded="BSD-3-Clause", licenseDeclared="BSD-3-Clause",
                  copyrightText="2026 The conus authors", homepage=home)
    content = hashlib.sha256(json.dumps([files, others]).encode()).hexdigest()
    return json.dumps({
        "spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT", "name": name,
        "documentNamespace": f"{home}/spdx/{name}-{content[:16]}",
        "creationInfo": {"created": when.strftime("%Y-%m-%dT%H:%M:%SZ"), "creators": ["Organization: The conus authors"]},
        "packages": [own, *others], "files": files,
        "relationships": [
            {"spdxElementId": "SPDXRef-DOCUMENT", "relationshipType": "DESCRIBES", "relatedSpdxElement": own["SPDXID"]},
            *({"spdxElementId": other["SPDXID"], "relationshipType": how, "relatedSpdxElement": own["SPDXID"]}
              for other in others),
            *({"spdxElementId": file["SPDXID"], "relationshipType": "GENERATED_FROM", "relatedSpdxElement": own["SPDXID"]}
              for file in files)],
    }, indent=1) + "\n"


def main(version, folder):
    others = [*(package(name, found) for name, found in build_depends()), *linked()]
    files = [{"SPDXID": f"SPDXRef-File-{number}", "fileName": f"./{file.relative_to(folder)}",
              "checksums": [{"algorithm": "SHA256", "checksumValue": hashlib.sha256(file.read_bytes()).hexdigest()},
                            {"algorithm": "SHA1", "checksumValue": hashlib.sha1(file.read_bytes()).hexdigest()}],
              "licenseConcluded": "NOASSERTION", "copyrightText": "NOASSERTION"}
             for number, file in enumerate(sorted(folder.rglob("*"))) if file.is_file() and not file.name.endswith(".part")]
    sys.stdout.write(document(f"conus-{version}", version, others, "BUILD_DEPENDENCY_OF", files))


if __name__ == "__main__":
    if len(sys.argv) != 3:
        raise SystemExit(__doc__)
    main(sys.argv[1], pathlib.Path(sys.argv[2]))
