# SPDX-License-Identifier: BSD-3-Clause
"""leaves.py CONUS RESULT...: changes every value in the sidecar of every result, one at a time, and adds Units and Levels to columns without, recomputes the
Checksum as docs/formats.md has it, and runs `conus verify`, which must notice each but those of FREE, which it must not.
Prints those of which that is not so, and how many others there were. Without CONUS_TEST_LONG, values of one name (Inputs.0.path and Inputs.1.path have one) are changed
in the first result that has them only, the first and the last. leaves.py --seal FILE prints the Checksum that a sidecar
should have."""
import concurrent.futures
import copy
import hashlib
import json
import os
import subprocess
import sys
import tempfile

SEALED = ["Space", "GeneratedBy", "Atlas", "Atlases", "Settings", "Queries", "Batch", "Inputs", "Outputs", "Sources",
          "Question", "Plan", "Warnings", "Places", "Understood", "Kept"]
# All that docs/commands.md lets differ, in the sidecar of whatever result, and how each may be changed.
FREE = {
    "GeneratedBy.CommandLine": lambda words: words.replace(" -q", "", 1),  # what is asked: the rest must follow from it
    "GeneratedBy.Version": lambda version: version + ".1",  # a note names it
    "Settings.engine": lambda engine: engine.split(",")[0] + ", scalar",  # the processor's instructions
    "Outputs.bytes": lambda size: size + 1,  # of pictures and rows in JSON, which have the command line in them
    "Outputs.sha256": lambda sum: "0" * 64,
}
PICTURES = ("image",)
ROWS = ("segments", "connectivity")  # of the results


class Real(str):
    """A number with a fraction, as it stands in the file."""


def dump(value):
    """Compact, keys sorted by their bytes, numbers with 9 digits as C's %.9g has them."""
    if isinstance(value, dict):
        keys = sorted(value, key=str.encode)
        return "{" + ",".join(f"{json.dumps(key, ensure_ascii=False)}:{dump(value[key])}" for key in keys) + "}"
    if isinstance(value, list):
        return "[" + ",".join(map(dump, value)) + "]"
    if isinstance(value, Real):
        text = f"{float(value):.9g}".replace("e+0", "e").replace("e-0", "e-").replace("e+", "e")
        return text if "." in text or "e" in text else text + ".0"
    return json.dumps(value, ensure_ascii=False)


def seal(root):
    return hashlib.sha256(dump({key: root[key] for key in SEALED if key in root}).encode()).hexdigest()


def load(path):
    with open(path, encoding="utf-8") as file:
        root = json.load(file, parse_float=Real)
    root.pop("Rows", None)
    return root


def sidecar_of(result):
    stem = result
    for ending in (".nii.gz", ".tsv", ".csv", ".nii"):
        stem = stem.removesuffix(ending)
    return next(path for path in (result + ".json", stem + ".json", result) if os.path.exists(path))


def leaves(value, path=()):
    if isinstance(value, (dict, list)):
        for key, inner in value.items() if isinstance(value, dict) else enumerate(value):
            yield from leaves(inner, (*path, key))
    else:
        yield path


def changed(path, value):
    if isinstance(value, Real):
        return Real(float(value) + 1)
    if isinstance(value, bool):
        return not value
    if isinstance(value, int):
        return value + 1
    return "x" + (value or "")


def first_and_last(paths, seen):
    """Of the paths of each name that is not in `seen` yet the first and the last."""
    named = {}
    for path in paths:
        named.setdefault(tuple(key for key in path if isinstance(key, str)), []).append(path)
    new = {name: same for name, same in named.items() if name not in seen}
    seen.update(new)
    return sorted({path for same in new.values() for path in (same[0], same[-1])}, key=paths.index)


def has_command_line(output):
    return output["option"] in PICTURES or (output["option"] in ROWS and output["path"].endswith(".json"))


def freedom(path, root):
    """How this value may be changed without a difference; None where it may not."""
    name = ".".join(key for key in path if isinstance(key, str))
    is_other = path[0] == "Outputs" and not has_command_line(root["Outputs"][path[1]])
    is_device = name == "Settings.engine" and not root["Settings"]["engine"].startswith("rays")
    return None if is_other or is_device else FREE.get(name)


def encode(value):
    """Numbers as they stand."""
    if isinstance(value, dict):
        return "{" + ",".join(f"{json.dumps(key)}:{encode(inner)}" for key, inner in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ",".join(map(encode, value)) + "]"
    return str(value) if isinstance(value, Real) else json.dumps(value)


def verify(conus, result, root):
    with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
        file.write(encode(root))
        file.flush()
        return subprocess.run([conus, "verify", result, "--sidecar", file.name], capture_output=True, text=True)


def edited(root, path, change):
    own = copy.deepcopy(root)
    inner = own
    for key in path[:-1]:
        inner = inner[key]
    inner[path[-1]] = change(inner[path[-1]])
    if path != ("Checksum",):
        own["Checksum"] = seal(own)
    return own


def is_noticed(conus, result, root, path):
    return verify(conus, result, edited(root, path, lambda value: changed(path, value))).returncode in (1, 3)


def is_free(conus, result, root, path):
    return verify(conus, result, edited(root, path, freedom(path, root))).returncode == 0


def is_added_noticed(conus, result, root, path):
    """Of a value that is not there."""
    own = copy.deepcopy(root)
    own[path[0]][path[1]] = "x"
    return verify(conus, result, own).returncode == 1


def main():
    conus, *results = sys.argv[1:]
    if conus == "--seal":
        print(seal(load(results[0])))
        return
    count = missed = 0
    seen = set()
    with concurrent.futures.ThreadPoolExecutor() as pool:
        for result in results:
            root = load(sidecar_of(result))
            if seal(root) != root["Checksum"]:
                sys.exit(f"{result}: its Checksum is not the one of docs/formats.md")
            if verify(conus, result, root).returncode:
                sys.exit(f"{result}: not identical before any change")
            paths = list(leaves(root))
            if not os.environ.get("CONUS_TEST_LONG"):
                paths = first_and_last(paths, seen)
            columns = [key for key, value in root.items() if isinstance(value, dict) and "Description" in value]
            added = [(key, word) for key in columns for word in ("Units", "Levels") if word not in root[key]]
            added = added if os.environ.get("CONUS_TEST_LONG") else [path for path in added if not path[0] in seen]
            seen.update(dict(added))
            free = [path for path in paths if freedom(path, root)]
            for path, same in zip(free, pool.map(lambda path: is_free(conus, result, root, path), free)):
                if not same:
                    print(f"{result}: {'.'.join(map(str, path))}: is free, and is different")
            paths = [path for path in paths if path[-1] != "CommandLine" and path not in free] + [
                path for path in free if path[0] != "Outputs" and path[-1] != "CommandLine"]
            found = [*pool.map(lambda path: is_noticed(conus, result, root, path), paths),
                     *pool.map(lambda path: is_added_noticed(conus, result, root, path), added)]
            for path, noticed in zip(paths + added, found):
                count += 1
                missed += not noticed
                if not noticed:
                    print(f"{result}: {'.'.join(map(str, path))}: not noticed")
    print(f"{count} values changed, {count - missed} noticed")


main()
