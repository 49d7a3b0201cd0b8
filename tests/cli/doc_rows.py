# SPDX-License-Identifier: BSD-3-Clause
"""doc_rows.py PAGE ROWS...: whether docs/commands.md says of options what their rows say, `conus help --json`: each command's
section names each of its options, or says "as for `query`" of what is the very row of query, and no other; a form in the head of an item has no word that the row lacks; and a
default in the item of one option is the row's; and whether each option stands in a page beside it, too, so that somebody meets
it. Prints what is not so, and how many options there were."""
import json
import pathlib
import re
import sys

COMMON = {"help", "version"}


def words(text):
    return set(re.findall(r"[A-Za-z0-9]+", text))


def is_form(form, row):
    known = words(" ".join([row.get("value", ""), row["help"], *row.get("choices", [])]))
    return '"' in form or words(form) <= known


def sections(page):
    """The text under the heading of each command, with what a link to another's list stands for."""
    found = {}
    for part in re.split(r"^## conus ", page, flags=re.M)[1:]:
        found[part.split()[0]] = part.split("\n## ")[0]
    return found


def items(text):
    """The forms in the head of each item of a list, and the item."""
    for item in re.findall(r"^\* (`-.*?)(?=^\* |^\n|^#|\Z)", text, re.M | re.S):
        item = " ".join(item.split())
        yield re.findall(r"`([^`]*)`", re.match(r"(?:`[^`]*`(?:, | and )?)+", item)[0]), item


def check(name, text, rows, of_query):
    said = set(re.findall(r"`--([a-z-]+)", text))
    if "as for `query`" in text:
        said |= {option for option in rows if rows[option]["help"] == of_query.get(option, {}).get("help")}
    for option in rows.keys() - said - COMMON:
        yield f"{name}: --{option} is not in the page"
    for forms, item in items(text):
        for form in forms:
            head = re.match(r"--([a-z-]+)[ =]?([^-].*)?$", form)
            if head and head[1] in rows and head[2] and not is_form(head[2], rows[head[1]]):
                yield f"{name}: `{form}`: the program has {rows[head[1]].get('value')}"
        options = [form[2:].split()[0] for form in forms if form.startswith("--")]
        default = re.search(r"[;(] ?default (-?[0-9][0-9.,x]*[KMGT]?)(?=[ .;,)]|$)", item)
        if default and len(options) == 1 and "=" not in rows.get(options[0], {}).get("value", "="):
            given, is_so = default[1].rstrip(".,"), rows[options[0]].get("default", rows[options[0]].get("otherwise", ""))
            if given not in re.split(r"[ ,]+(?=[a-z])", is_so) and given != is_so:
                yield f"{name}: --{options[0]}: default {given}, the program has {is_so}"


def main():
    commands = {}
    for path in sys.argv[2:]:
        with open(path, encoding="utf-8") as file:
            commands.update({command["name"]: {row["name"]: row for row in command["options"]}
                             for command in json.load(file)["commands"]})
    with open(sys.argv[1], encoding="utf-8") as file:
        text = sections(file.read())
    every = {option for rows in commands.values() for option in rows}
    faults = [fault for name, rows in commands.items() for fault in check(name, text[name], rows, commands["query"])]
    faults += [f"{name}: --{option} is no option" for name in commands
               for option in sorted(set(re.findall(r"`--([a-z-]+)", text[name])) - every)]
    page = pathlib.Path(sys.argv[1])
    guides = " ".join(guide.read_text(encoding="utf-8") for guide in page.parent.glob("*.md") if guide.name != page.name)
    faults += [f"--{option} is in no guide" for option in sorted(every - COMMON - {"output"})  # which all know as -o
               if not re.search(rf"--{option}(?![a-z-])", guides)]
    print(*faults, f"{sum(map(len, commands.values()))} options", sep="\n")
    return len(faults) > 0


sys.exit(main())
