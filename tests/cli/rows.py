# SPDX-License-Identifier: BSD-3-Clause
"""rows.py CONUS: a given default is as good as none, and rows say what options are.

Of each option of each command whose row has a default (`conus help --json`), the question of QUESTIONS is asked with
the default and without: exit code, standard output and error and all files must be the same, byte for byte. Only the
command line may differ, which JSON has in GeneratedBy and so in the Checksum, and pictures in their text: conus diff
compares these. A number that is only just another one, by a part in 10^12, is no default to the program, but must
answer with the same rows: so the default that is documented is the one that counts. NEEDS has what the option has no effect
without. Prints what is not so, and how many options there were.

Checked of the rows themselves: a file that is named has a content and a role, a number of a unit has it in its row,
what an option excludes excludes it, and a default is within its range and among its choices."""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

CONUS = os.path.abspath(sys.argv[1])
AIM = "nested.nii.gz --origin 0,0,90 --toward 0,0,0"
QUESTIONS = {
    "query": f"{AIM} -o out/a.tsv", "batch": "nested.nii.gz --poses poses.tsv -o out/a.tsv --threads 1",
    "track": "nested.nii.gz --poses poses.tsv -o out/a.tsv --score intenselect_plus", "sweep": f"{AIM} -o out/a.tsv",
    "overlap": "nested.nii.gz nested.nii.gz --threshold 1 -o out/a.tsv",
    "connect": "nested.nii.gz bundle.tck -o out/a.tsv",
    "plan": "nested.nii.gz --poses poses.tsv --length 1,100 --depth 60 -o out/a.tsv", "info": "nested.nii.gz",
    "atlases": "", "render": f"{AIM} --engine rays --size 64x48 -o out/a.png", "mesh": "nested.nii.gz -o out",
    "manifest": "folder", "phantom": "sphere -o out", "diff": "rows.tsv rows.tsv", "verify": "rows.tsv",
    "calibrate": "--poses trials.tsv -o out/a.tsv", "positions": "C3 F4 -o out/a.tsv", "cite": "rows.tsv", "pack": "nested.nii.gz -o out/a.conus",
    "page": "nested.nii.gz --template template.html -o out/a.html", "mcp": "", "report": "rows.tsv -o report",
}
NEEDS = {
    "bregma": None,  # an atlas in the CCF, which tests/cli/ccf.bats has
    "slice-fraction": "--sampling slices", "samples": "--jitter 2,1", "pivot": "--tolerance out/b.tsv",
    "endpoint-radius": "--streamlines bundle.tck --connectivity out/b.tsv --layers all", "turn": None, "fill": "--cuts axial",
}
OWN = {("connect", "endpoint-radius"): "--connectivity out/b.tsv", ("page", "angle"): None,  # which is in its link
       ("plan", "angle"): "--reach Core,share=0.001", ("calibrate", "angle"): "nested.nii.gz --weight hard"}


def run(folder, words):
    done = subprocess.run([CONUS, *words], cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, check=False,
                          env={**os.environ, "CONUS_ATLAS_PATH": folder, "NO_COLOR": "1"})
    return done.returncode, done.stdout, done.stderr


def make_inputs(folder):
    for words in ("phantom nested -o . --size 24", "phantom bundle -o ."):
        assert run(folder, words.split())[0] == 0
    os.mkdir(f"{folder}/folder")
    shutil.copy(f"{folder}/nested.nii.gz", f"{folder}/folder")
    rows = "query_id\ttime_s\tx\ty\tz\tdx\tdy\tdz\na\t0\t0\t0\t60\t0\t0\t-1\nb\t1\t60\t0\t0\t-1\t0\t0\n"
    trials = "x\ty\tz\tdx\tdy\tdz\taim_x\taim_y\taim_z\tmeant\n" + "".join(
        f"0\t0\t0\t{n % 3}\t{n % 5 - 2}\t-60\t0\t0\t-60\tCore\n" for n in range(12))
    for name, text in (("poses.tsv", rows), ("trials.tsv", trials), ("template.html", "<p><!-- atlas --></p>")):
        with open(f"{folder}/{name}", "w", encoding="utf-8") as file:
            file.write(text)
    assert run(folder, f"query {AIM} -o rows.tsv".split())[0] == 0


def without_command(text):
    """Of JSON what does not follow from the command line."""
    root = json.loads(text)
    for program in root.get("GeneratedBy", []) if isinstance(root, dict) else []:
        program.pop("CommandLine", None)
    if isinstance(root, dict):
        root.pop("Checksum", None)
    return root


def ask(folder, command, words):
    """What is said and written; a picture stays where conus diff finds it."""
    out = f"{folder}/out"
    shutil.rmtree(out, ignore_errors=True)
    os.mkdir(out)
    said = run(folder, [command, *words])
    files = {}
    for name in sorted(os.listdir(out)):
        with open(f"{out}/{name}", "rb") as file:
            data = file.read()
        if name.endswith(".png"):
            kept = f"{folder}/{'b' if os.path.exists(f'{folder}/a.png') else 'a'}.png"
            os.replace(f"{out}/{name}", kept)
            data = b""
        if name.endswith(".conus"):  # which has the command line in its head
            data = run(folder, ["info", f"out/{name}", "--format", "tsv"])
        files[name] = without_command(data) if name.endswith(".json") else data
    for manifest in ("folder/folder.atlas.json",):
        if os.path.exists(f"{folder}/{manifest}"):
            os.remove(f"{folder}/{manifest}")
    return said, files


def fault_of(folder, command, words, more, rows_only=False):
    for name in "ab":
        if os.path.exists(f"{folder}/{name}.png"):
            os.remove(f"{folder}/{name}.png")
    one, other = ask(folder, command, words), ask(folder, command, [*words, *more])
    if rows_only:  # the number stands in JSON and in notes
        one, other = (((said[0], said[1]), {name: data for name, data in files.items() if not name.endswith(".json")})
                      for said, files in (one, other))
    if os.path.exists(f"{folder}/b.png") and run(folder, ["diff", "a.png", "b.png"])[0]:
        return f"another picture with {' '.join(more)}"
    return None if one == other else f"{other[0]} with {' '.join(more)}, and without {one[0]}"


def check_defaults(folder, commands):
    count = 0
    for command, rows in commands.items():
        words = QUESTIONS[command].split()
        code, _, error = ask(folder, command, words)[0]
        assert code == 0, f"{command}: {error}"
        for row in rows.values():
            default = row.get("default")
            if default is None or f"--{row['name']}" in words:
                continue
            count += 1
            fault = fault_of(folder, command, words, [f"--{row['name']}={default}"])
            if fault:
                yield f"{command} --{row['name']}: {fault}"
            needs = OWN.get((command, row["name"]), NEEDS.get(row["name"], ""))
            if row["type"] != "number" or needs is None or not float(default):
                continue
            near = repr(float(default) * (1 + 1e-12))
            fault = fault_of(folder, command, [*words, *needs.split()], [f"--{row['name']}={near}"], rows_only=True)
            if fault:
                yield f"{command} --{row['name']} is not {default} where it is not given: {fault}"
    assert count > 100
    yield count


def check_rows(commands):
    for command, rows in commands.items():
        for name, row in rows.items():
            where = f"{command} --{name}"
            value = row.get("value", "")
            if bool(re.search("FILE|DIR|FOLDER", value)) and not row["role"].startswith(("reads", "writes")):
                yield f"{where}: {value} is neither read nor written"
            if row["role"] in ("reads", "writes") and "holds" not in row:
                yield f"{where}: of what kind is the file?"
            if ("MM" == value, "DEGREES" == value) != (row.get("unit") == "mm" and value == "MM", row.get("unit") == "degrees" and value == "DEGREES"):
                yield f"{where}: {value} in {row.get('unit')}"
            for other in row.get("excludes", []):
                if name not in rows[other].get("excludes", []):
                    yield f"{where}: --{other} does not exclude it"
            default = row.get("default")
            if default is not None and row["type"] == "choice" and default not in row["choices"]:
                yield f"{where}: {default} is no choice"
            if default is not None and "otherwise" in row:
                yield f"{where}: has two defaults"
            limits = row.get("range")
            if default is not None and limits and row["type"] in ("number", "count") and not (
                    limits["low"] <= float(default) <= limits["high"]):
                yield f"{where}: {default} is out of range"


def main():
    root = json.loads(subprocess.run([CONUS, "help", "--json"], capture_output=True, check=True).stdout)
    commands = {command["name"]: {row["name"]: row for row in command["options"]}
                for command in root["commands"] if command["name"] != "view"}
    assert commands.keys() == QUESTIONS.keys(), "a command has no question"
    with tempfile.TemporaryDirectory() as folder:
        make_inputs(folder)
        *faults, count = [*check_rows(commands), *check_defaults(folder, commands)]
    print(*faults, f"{count} defaults given", sep="\n")
    return len(faults) > 0


sys.exit(main())
