# SPDX-License-Identifier: BSD-3-Clause
"""What others' programs read of the project: versions, citations, descriptors, workflows. $CONUS is the program."""
import importlib.machinery
import importlib.util
import json
import os
import pathlib
import re
import shutil
import subprocess
import xml.etree.ElementTree

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
CONUS = os.environ["CONUS"]


def run(*words, **more):
    return subprocess.run([str(word) for word in words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **more)


def yaml_of(name):
    return pytest.importorskip("yaml").safe_load((ROOT / name).read_text())


def script(name):
    loader = importlib.machinery.SourceFileLoader(name, str(ROOT / "scripts" / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    loader.exec_module(module)
    return module


def test_all_files_say_the_same():
    done = run(ROOT / "scripts" / "metadata")
    assert (done.returncode, done.stdout) == (0, "")


@pytest.mark.parametrize("source, old, new, wanted", [
    ("include/conus/version.h", "#define CONUS_VERSION_MINOR 1", "#define CONUS_VERSION_MINOR 7", '"version": "0.7.0"'),
    ("CITATION.cff", 'url: "https://conus.example.org"', 'url: "https://brains.example.net"', '"https://brains.example.net"'),
    ("CITATION.cff", "email: conus@example.org", "email: mail@example.net", '"email": "mail@example.net"'),
])
def test_a_change_is_carried_everywhere(tmp_path, source, old, new, wanted):
    """Places say something else at first, and the same as its source in the end."""
    for name in {"include/conus/version.h", "CITATION.cff", "scripts/metadata", *(place[0] for place in script("metadata").PLACES)}:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    text = (tmp_path / source).read_text()
    assert old in text
    (tmp_path / source).write_text(text.replace(old, new))
    done = run(tmp_path / "scripts" / "metadata")
    assert done.returncode == 1 and "codemeta.json: the " in done.stdout
    assert run(tmp_path / "scripts" / "metadata", "--write").returncode == 0
    assert wanted in (tmp_path / "codemeta.json").read_text()
    done = run(tmp_path / "scripts" / "metadata")
    assert (done.returncode, done.stdout) == (0, "")


def test_version_is_the_program_s():
    assert yaml_of("CITATION.cff")["version"] == run(CONUS, "--version").stdout.split()[1]


def test_citation_has_what_its_format_requires():
    """Citation File Format 1.2.0: required keys, and the form of those that programs read."""
    citation = yaml_of("CITATION.cff")
    assert citation["cff-version"] == "1.2.0" and citation["message"] and citation["title"] == "conus"
    assert citation["type"] == "software"
    assert re.fullmatch(r"\d{4}-\d\d-\d\d", citation["date-released"])
    for who in (*citation["authors"], *citation["contact"]):
        assert who.get("name") or who.get("family-names")
    for reference in citation["references"]:
        assert reference["type"] and reference["title"] and reference["authors"]
        assert re.fullmatch(r"10\.\d{4,9}/\S+", reference["doi"])
    assert (ROOT / "LICENSES" / f"{citation['license']}.txt").read_text() == (ROOT / "LICENSE").read_text()


def test_citations_agree():
    citation, codemeta = yaml_of("CITATION.cff"), json.loads((ROOT / "codemeta.json").read_text())
    zenodo = json.loads((ROOT / ".zenodo.json").read_text())
    assert citation["keywords"] == codemeta["keywords"] == zenodo["keywords"]
    assert citation["abstract"] == codemeta["description"] == re.sub("<.*?>", "", zenodo["description"])
    assert codemeta["license"].endswith("/" + citation["license"]) and zenodo["license"] == citation["license"]
    assert codemeta["referencePublication"][0]["identifier"].endswith(citation["references"][0]["doi"])


def test_codemeta_has_addresses_where_its_context_wants_them():
    """CodeMeta 2.0: what is no address there, and no term of it, a reader of JSON-LD leaves out."""
    codemeta = json.loads((ROOT / "codemeta.json").read_text())
    assert codemeta["developmentStatus"].startswith("https://www.repostatus.org/#")
    assert codemeta["license"].startswith("https://") and codemeta["url"].startswith("https://")
    for publication in codemeta["referencePublication"]:
        assert publication["@type"].startswith("schema:") and publication["identifier"].startswith("https://")


def test_validate_asks_the_schema(tmp_path):
    pytest.importorskip("jsonschema")
    pytest.importorskip("yaml")
    validate = script("validate")
    for name in validate.SCHEMAS:
        schema = tmp_path / f"{pathlib.Path(name).name}.schema.json"
        schema.write_text('{"type": "object"}')
        assert validate.check_schema(name, tmp_path) == ""
        schema.write_text('{"required": ["nobody"]}')
        assert validate.check_schema(name, tmp_path) == "$: 'nobody' is a required property"


def test_source_package_has_what_cmake_builds():
    """The rooms of CMakeLists.txt, and what setup.py reads, are in the list of the Python source package."""
    lists = (ROOT / "CMakeLists.txt").read_text()
    rooms = {*re.search(r"foreach\(module IN ITEMS (.*)\)\n +add_subdirectory", lists)[1].split(), "apps", "cmake", "include",
             "python"}
    packed = set(re.findall(r"(?m)^graft (\S+)$", (ROOT / "MANIFEST.in").read_text()))
    assert len(rooms) >= 10 and packed == rooms


def test_paper_cites_what_it_lists():
    paper, listed = ((ROOT / "packaging" / "paper" / name).read_text() for name in ("paper.md", "paper.bib"))
    assert set(re.findall(r"(?<![\w.])@(\w+)", paper)) == set(re.findall(r"@\w+\{(\w+),", listed))
    for picture in re.findall(r"\]\(([^)]*\.png)\)", paper):
        assert (ROOT / "packaging" / "paper" / picture).exists()


def commands(node):
    """The lines that a workflow's jobs run."""
    if isinstance(node, dict):
        for key, value in node.items():
            if key in ("run", "script", "before_script") and not isinstance(value, dict):
                yield from ([value] if isinstance(value, str) else value)
            else:
                yield from commands(value)
    elif isinstance(node, list):
        for item in node:
            yield from commands(item)


@pytest.mark.parametrize("name", [".github/workflows/ci.yml", ".gitlab-ci.yml"])
def test_workflows_run_what_is_there(name):
    lines = list(commands(yaml_of(name)))
    scripts = {word for line in lines for word in re.findall(r"(?<!\S)scripts/\S+", line)}
    assert {"scripts/test", "scripts/package", "scripts/wheel", "scripts/site"} <= scripts
    for script in scripts:
        assert os.access(ROOT / script, os.X_OK), script
    presets = {preset["name"] for preset in json.loads((ROOT / "CMakePresets.json").read_text())["configurePresets"]}
    assert {preset for line in lines for preset in re.findall(r"--preset (\S+)", line)} <= presets


def test_containers_run_what_is_there():
    for name in ("Dockerfile", "conus.def"):
        text = (ROOT / "packaging" / "container" / name).read_text()
        assert re.search(r"(?m)(^RUN |^ +)scripts/wheel\b", text) and os.access(ROOT / "scripts" / "wheel", os.X_OK)


def test_conda_asks_for_switches_that_exist():
    recipe = yaml_of("packaging/conda/recipe.yaml")
    lists = "".join((ROOT / name).read_text() for name in ("CMakeLists.txt", "python/CMakeLists.txt"))
    switches = set(re.findall(r"-D(CONUS_\w+)=", f"{recipe['build']['script']} {recipe['context']}"))
    assert switches and all(re.search(rf"\b{switch}\b", lists) for switch in switches)
    assert "skip" not in recipe["build"]


def test_source_package_has_what_its_wheel_is_built_and_installed_from():
    """The wheel is made from it, without the window and its files of the desktop."""
    asked = set(re.findall(r"(?<![\w/])(?:packaging|scripts)/[\w./-]+", (ROOT / "cmake" / "install.cmake").read_text()))
    lines = [line.split() for line in (ROOT / "MANIFEST.in").read_text().splitlines()]
    included = {name for words in lines if words[0] == "include" for name in words[1:]}
    assert "scripts/descriptors" in asked and asked - {"packaging/desktop"} <= included


def test_homebrew_and_scoop_ask_for_what_a_release_has():
    formula = (ROOT / "packaging" / "homebrew" / "conus.rb").read_text()
    lists = (ROOT / "CMakeLists.txt").read_text()
    parts = re.search(r"%w\[([A-Z0-9 ]+)\]", formula)[1].split()
    assert parts and all(re.search(rf"(?m)^option\(CONUS_{part}\b", lists) for part in parts)
    scoop = json.loads((ROOT / "packaging" / "scoop" / "conus.json").read_text())
    archive = scoop["architecture"]["64bit"]
    assert archive["url"].endswith(archive["extract_dir"] + ".zip") and scoop["version"] in archive["extract_dir"]


@pytest.fixture(scope="module")
def descriptors(tmp_path_factory):
    folder = tmp_path_factory.mktemp("descriptors")
    done = run(ROOT / "scripts" / "descriptors", folder, env={**os.environ, "CONUS": str(CONUS)})
    assert done.returncode == 0, done.stdout
    return folder


def flags_of(command):
    text = run(CONUS, command, "--help", "--long").stdout
    return set(re.findall(r"(?m)^ +(?:-\w, )?(--[a-z][a-z0-9-]*)", text)) - {"--help", "--long", "--version"}


def test_boutiques_rules(descriptors):
    """Descriptors by the rules of Boutiques 0.5, of each command but the window: every option of its help is in it."""
    files = sorted((descriptors / "boutiques").glob("conus-*.json"))
    assert len(files) >= 18
    for file in files:
        tool = json.loads(file.read_text())
        inputs = tool["inputs"]
        ids = [item["id"] for item in (*inputs, *tool.get("output-files", []))]
        keys = [item["value-key"] for item in inputs]
        assert tool["schema-version"] == "0.5" and len(set(ids)) == len(ids) and len(set(keys)) == len(keys), file
        assert re.findall(r"\[\w+\]", tool["command-line"]) == keys
        for item in inputs:
            assert re.fullmatch(r"\w+", item["id"]) and item["type"] in ("String", "File", "Flag", "Number")
            assert item["type"] != "Flag" or item["command-line-flag"] and item["optional"]
            assert "value-choices" not in item or item["type"] in ("String", "Number")
            assert not {"integer", "minimum", "maximum"} & set(item) or item["type"] == "Number"
            assert "list-separator" not in item or item["list"]
            assert "default-value" not in item
            assert set(item.get("disables-inputs", []) + item.get("requires-inputs", [])) <= set(ids)
        flags = {item["command-line-flag"] for item in inputs if "command-line-flag" in item}
        missing = flags_of(file.stem.removeprefix("conus-")) ^ flags
        assert missing <= {"--listen", "--connect", "--seconds"}, (file, missing)  # a device is no input


def test_boutiques_command_line_answers(descriptors, tmp_path):
    """Filled in by hand, it gives the rows of conus batch itself."""
    tool = json.loads((descriptors / "boutiques" / "conus-batch.json").read_text())
    run(CONUS, "phantom", "sphere", "--size", "16", "-o", tmp_path)
    (tmp_path / "poses.tsv").write_text("x\ty\tz\ttx\tty\ttz\n0\t0\t90\t0\t0\t0\n0\t90\t0\t0\t0\t0\n")
    values = {"atlas": "sphere.nii.gz", "poses": "poses.tsv", "angle": "12", "layers": "all", "range": "1,200", "output": "rows.tsv"}
    line = tool["command-line"]
    for item in tool["inputs"]:
        value = values.get(item["id"])
        line = line.replace(item["value-key"], f"{item.get('command-line-flag', '')} {value}" if value else "")
    environment = {**os.environ, "PATH": f"{pathlib.Path(CONUS).parent}:{os.environ['PATH']}"}
    done = run(*line.split(), cwd=tmp_path, env=environment)
    assert done.returncode == 0, done.stdout
    run(CONUS, "batch", "sphere.nii.gz", *"--poses poses.tsv --angle 12 --layers all --range 1,200 -o plain.tsv".split(), cwd=tmp_path)
    rows = (tmp_path / "rows.tsv").read_text()
    assert rows == (tmp_path / "plain.tsv").read_text() and len(rows.splitlines()) >= 3


def test_slicer_forms(descriptors, tmp_path):
    """The forms by the rules of Slicer's parser, and a module as Slicer runs it: with _ in flags, onto a file that is there."""
    forms = sorted((descriptors / "slicer").glob("*.xml"))
    assert [form.stem for form in forms] == ["ConusOverlap", "ConusPlan", "ConusQuery"]
    for form in forms:
        root = xml.etree.ElementTree.parse(form).getroot()
        known = flags_of(form.stem.removeprefix("Conus").lower())
        inputs = [item for group in root.iter("parameters") for item in group if item.find("name") is not None]
        names = [item.find("name").text for item in inputs]
        assert len(set(names)) == len(names) and all(re.fullmatch(r"[A-Za-z]\w*", name) for name in names)
        assert [item.find("index").text for item in inputs if item.find("index") is not None] in (["0"], ["0", "1"])
        for item in inputs:
            flag = item.find("longflag")
            assert flag is None or "-" not in flag.text and "--" + flag.text.replace("_", "-") in known, (form, flag.text)
            assert (item.tag in ("image", "table", "file", "pointfile")) == (item.find("channel") is not None)
            assert (item.tag == "boolean") == (item.find("default") is not None), item.find("name").text
    run(CONUS, "phantom", "sphere", "--size", "16", "-o", tmp_path)
    module = descriptors / "slicer" / "ConusQuery.py"
    environment = {**os.environ, "CONUS": str(CONUS)}
    asked = "--angle 12 --layers all --max_memory 1G --output rows.tsv --force sphere.nii.gz".split()
    (tmp_path / "rows.tsv").write_text("made by Slicer\n")
    done = run(module, "--origin", "0,0,90", "--toward", "0,0,0", *asked, cwd=tmp_path, env=environment)
    assert done.returncode == 0 and len((tmp_path / "rows.tsv").read_text().splitlines()) >= 2, done.stdout


@pytest.mark.parametrize("words", [
    ("reuse", "lint"),
    ("appstreamcli", "validate", "--no-net", "packaging/desktop/conus-view.metainfo.xml"),
    ("desktop-file-validate", "packaging/desktop/conus-view.desktop", "packaging/debian/conus-page.desktop"),
])
def test_validators_find_nothing(words):
    if not shutil.which(words[0]) or words[0] == "reuse" and not (ROOT / ".git").exists():
        pytest.skip(f"no {words[0]} here, or no clone")
    done = run(*words, cwd=ROOT)
    assert done.returncode == 0, done.stdout
