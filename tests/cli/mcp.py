# SPDX-License-Identifier: BSD-3-Clause
"""mcp.py transcript|tools CONUS, mcp.py hostile CONUS LINES: `conus mcp`, as a client and as an enemy see it.

hostile: of so many lines, a fixed sequence, each is answered by one line or, a notification, by none. strace lists what
the server and its children open: beside what honest calls open, and folders that they lie in, only what is in the root.
Nothing is opened for writing, no socket is made, the root is as before, and no answer has a word of a secret file in it."""
import hashlib
import json
import os
import random
import re
import shlex
import shutil
import subprocess
import sys

CONUS = os.path.abspath(sys.argv[2])
AIM = {"origin": [0, 0, 90.5], "toward": [0, 0, 0], "angle": 20}
SECRET = "Xq7SecretWordOfAFile"
ENVIRONMENT = {**os.environ, "CONUS_ATLAS_PATH": os.path.abspath("installed")}


def call(tool, members, number=1):
    return {"jsonrpc": "2.0", "id": number, "method": "tools/call", "params": {"name": tool, "arguments": members}}


def make_files():
    for folder in ("root/sub", "root/study (1)", "root/50%", "installed", "outside"):
        os.makedirs(folder)
    for words in ("phantom nested -o root --size 24", "phantom sphere -o installed --size 24"):
        subprocess.run([CONUS, *words.split()], check=True, capture_output=True)
    for folder in ("root/study (1)", "root/50%"):
        shutil.copy("root/nested.nii.gz", folder)
    for path in ("root/secret.txt", "outside/secret.txt", "root/sub/names.txt"):
        with open(path, "w", encoding="utf-8") as file:
            file.write(f"{SECRET} {SECRET}\n{SECRET}\t1\n")
    with open("root/sub/poses.tsv", "w", encoding="utf-8") as file:
        file.write("query_id\tx\ty\tz\tdx\tdy\tdz\na\t0\t0\t60\t0\t0\t-1\n")
    os.symlink(os.path.abspath("outside"), "root/out")
    with open("root/secret.xml", "w", encoding="utf-8") as file:
        file.write(f'<{SECRET} a="{SECRET}">"{SECRET}</{SECRET}>\n')
    os.symlink(os.path.abspath("outside/secret.txt"), "root/out.txt")
    os.symlink(os.path.abspath("outside/secret.txt"), "root/(out)")
    os.symlink(os.path.abspath("outside/missing.txt"), "root/dangling.txt")


def serve(lines, before=()):
    """The answers to lines of bytes. Leaks cannot be looked for where strace looks."""
    leaks = {"ASAN_OPTIONS": os.environ.get("ASAN_OPTIONS", "") + ":detect_leaks=0"} if before else {}
    done = subprocess.run([*before, CONUS, "mcp", "--root", "root"], input=b"".join(line + b"\n" for line in lines),
                          capture_output=True, check=False, env={**ENVIRONMENT, **leaks})
    assert done.returncode == 0, (done.returncode, done.stderr[-2000:])
    return [json.loads(line) for line in done.stdout.split(b"\n") if line]


def ask(*messages):
    return serve([json.dumps(message).encode() for message in messages])


def program(*words):
    done = subprocess.run([CONUS, *words], capture_output=True, check=False, cwd="root", env=ENVIRONMENT)
    return done.stdout, done.stderr.decode().splitlines()


def same(answer, text):
    """Whether an answer is what the program says; the command line, and so the checksum, are their own."""
    other = json.loads(text)
    for one in (answer, other):
        one.pop("Checksum", None)
        for maker in one.get("GeneratedBy", []):
            maker.pop("CommandLine")
    return answer == other


def transcript():
    text = lambda reply: reply["result"]["content"][0]["text"]
    aimed = ["--origin=0,0,90.5", "--toward=0,0,0", "--angle=20", "--format=json", "nested.nii.gz"]
    for tool, members, words in (
            ("query", {"atlas": "nested.nii.gz", **AIM}, ["query", *aimed]),
            ("query", {"atlas": "sphere", **AIM}, ["query", *aimed[:-1], "sphere"]),
            ("query", {"atlas": "nested.nii.gz", "point": [[0, 0, 0], [1, 2, 3.5]]},
             ["query", "--point=0,0,0", "--point=1,2,3.5", "--format=json", "nested.nii.gz"]),
            ("query", {"atlas": "nested.nii.gz", **AIM, "layers": "all", "range": [10, 95], "only": ["Core"], "labels_anyway": True},
             ["query", *aimed[:3], "--layers=all", "--range=10,95", "--only=Core", "--labels-anyway", *aimed[3:]]),
            ("overlap", {"atlas": "nested.nii.gz", "roi": ["nested.nii.gz"], "threshold": 1},
             ["overlap", "--threshold=1", "--format=json", "nested.nii.gz", "nested.nii.gz"]),
            ("info", {"atlas": "study (1)/nested.nii.gz"}, ["info", "--format=json", "study (1)/nested.nii.gz"]),
            ("info", {"atlas": "50%/nested.nii.gz"}, ["info", "--format=json", "50%/nested.nii.gz"]),
            ("info", {"atlas": "nested.nii.gz"}, ["info", "--format=json", "nested.nii.gz"]),
            ("atlases", {}, ["atlases", "--format=json"])):
        (reply,) = ask(call(tool, members, 7))
        out, notes = program(*words)
        assert "structuredContent" in reply["result"], reply
        content = reply["result"]["structuredContent"]
        assert reply["id"] == 7 and reply["result"]["isError"] is False and out
        assert json.loads(text(reply)) == content and content["notes"] == notes, (content["notes"], notes)
        assert content["command"] == shlex.join(["conus", *words]), content["command"]
        assert same(content["answer"], out), tool
    (reply,) = ask(call("cite", {"result": "nested.nii.gz"}))
    assert text(reply).encode() == program("cite", "nested.nii.gz")[0]

    many = [[x / 100, 0, 0] for x in range(300)]  # the rows are cut, and that is said
    (reply,) = ask(call("query", {"atlas": "nested.nii.gz", "point": many}))
    content = reply["result"]["structuredContent"]
    assert len(content["answer"]["Rows"]) == 200 and "note: Rows: the first 200 of 300" in content["notes"], content["notes"]

    for version, answered in (("2025-06-18", "2025-06-18"), ("1999-01-01", "2025-11-25")):
        (reply,) = ask({"jsonrpc": "2.0", "id": "a", "method": "initialize", "params": {"protocolVersion": version}})
        assert reply["id"] == "a" and reply["result"]["protocolVersion"] == answered
    replies = ask({"jsonrpc": "2.0", "id": 1, "method": "server/discover"}, {"jsonrpc": "2.0", "method": "notifications/initialized"},
                  {"jsonrpc": "2.0", "id": 2, "method": "ping"}, {"jsonrpc": "2.0", "id": 3, "method": "resources/list"},
                  {"jsonrpc": "2.0", "id": 4.5, "method": "ping"}, [], {"id": 5, "method": "ping"})
    assert replies[0]["result"]["supportedVersions"] == ["2026-07-28", "2025-11-25", "2025-06-18", "2025-03-26", "2024-11-05"]
    assert replies[1] == {"jsonrpc": "2.0", "id": 2, "result": {}}
    assert [reply["error"]["code"] for reply in replies[2:]] == [-32601, -32600, -32600, -32600]
    assert [reply["error"]["code"] for reply in serve([b"{", b"", b"\xff", b'{"a":1,"a":2}', b" " * (1 << 20) + b"1"])] == [-32700] * 5

    outside = os.path.abspath("outside/secret.txt")
    for members, why in (
            ({}, "atlas is missing"), ({"atlas": 1}, "atlas: wanted is a text"), ({"atlas": "all", "point": [0, 0, 0]}, "no installed atlas"),
            ({"atlas": "nested.nii.gz", "output": "a.tsv"}, 'no member "output"'), ({"atlas": "nested.nii.gz", "force": True}, 'no member "force"'),
            ({"atlas": "nested.nii.gz", "origin": [1, 2]}, "wanted are 3 numbers"), ({"atlas": "nested.nii.gz", "angle": "20"}, "wanted is a number"),
            ({"atlas": "nested.nii.gz", "point": [0, 0, 0], "only": ["Coer"]}, 'did you mean "'),
            ({"atlas": "--help"}, 'begins with "-"'), ({"atlas": "nested.nii.gz", "pose": "-"}, 'begins with "-"'),
            ({"atlas": "nested.nii.gz", "only": ["@sub/names.txt"]}, "a list in a file"),
            ({"atlas": "nested.nii.gz", "only": ["sub/names.txt"]}, "is a file"),
            *(({"atlas": path}, "is not in a folder") for path in (
                outside, "../outside/secret.txt", "out/secret.txt", "out.txt", "(out)", "a/" * 2000 + "..", "dangling.txt",
                "sub/../../outside", "/etc/passwd", "/")),
            *(({"atlas": "nested.nii.gz", "labels": f"{begin}{outside}{end}"}, "is not in a folder")
              for begin in ("", "label=", "x,name=", "x:", "x;", "file://", "x|", "study (1)/nested.nii.gz,name=") for end in ("", ",name=a")),
            ({"atlas": "nested.nii.gz", "labels": "label=(out)"}, "is not in a folder"),
            *(({"atlas": path, **AIM}, "a/a") for path in ("a/" * 2040, ("a/" * 32 + ",") * 62))):  # neither deep nor slow
        (reply,) = ask(call("query", members))
        assert reply["result"]["isError"] is True and why in text(reply), (members, text(reply))
        assert SECRET not in text(reply)
    for members in ({"atlas": "nested.nii.gz", **AIM, "labels": "secret.txt"}, {"atlas": "secret.txt", **AIM},
                    {"atlas": "nested.nii.gz", **AIM, "labels": "secret.xml,name=x"}, {"atlas": "nested.nii.gz", "pose": "secret.xml"}):
        (reply,) = ask(call("query", members))
        assert SECRET[:4] not in json.dumps(reply), text(reply)


def tools():
    (reply,) = ask({"jsonrpc": "2.0", "id": 1, "method": "tools/list"})
    rows = {command["name"]: command for command in json.loads(program("help", "--json")[0])["commands"]}
    listed = reply["result"]["tools"]
    assert [tool["name"] for tool in listed] == ["query", "overlap", "plan", "info", "cite", "atlases"]
    for tool in listed:
        schema, command = tool["inputSchema"], rows[tool["name"]]
        options = {option["name"].replace("-", "_"): option for option in command["options"]}
        operands = [operand["name"].split("|")[0].rstrip(".").lower() for operand in command["operands"]]
        assert schema["additionalProperties"] is False and set(operands) <= set(schema["required"])
        known = {name.removeprefix("more_") for name in schema["properties"]} - set(operands)
        assert known <= set(options) | set(operands), known - set(options)
        for name, option in options.items():
            may = option["role"] in ("asks", "reads", "reads names") and not (name == "format" and "json" in option["choices"])
            if may and not option.get("needs"):
                assert name in known or f"more_{name}" in schema["properties"], name
            assert may or name not in known, name
            rule = schema["properties"].get(name, {})
            assert rule.get("enum") == option.get("choices") or not rule, name
            if option["type"] == "number" and rule and "range" in option and option["range"]["high"] < 1e9:
                assert option["range"]["high"] in (rule.get("maximum"), rule.get("exclusiveMaximum")), name


def hostile_values(rng):
    path = rng.choice(["/etc/passwd", "/etc/shadow", "/", "..", "../outside/secret.txt", "out/secret.txt", "out.txt", "dangling.txt",
                       os.path.abspath("outside/secret.txt"), "sub/../../outside/secret.txt", "secret.txt", "sub/names.txt", "nested.nii.gz",
                       "/proc/self/environ", "/dev/stdin", "~/.ssh/id_rsa", "//etc/passwd", "./nested.nii.gz", "sphere", "C:\\x", "\\\\h\\s"])
    return rng.choice([
        path, path, rng.choice(["@", "label=", "x,label=", "from=", "file://", "fsl:", "a;", "x|", " ", "gauss="]) + path,
        f"{path},name={path}", f"nested.nii.gz,{path}", "-", "--output=/tmp/x", "--help", "-o", "@", "", "\u0001\u001b[2J", "é" * 40,
        rng.randbytes(8).hex() * rng.choice([1, 300]), 0, -1, 1e308, True, None, [], {}, [path], [[path]], [1, 2, 3], ["Core"], "1,2,3",
        rng.uniform(-200, 200), rng.randrange(1 << 40)])


def hostile_line(rng, tools_listed):
    kind = rng.randrange(10)
    if kind == 0:
        return rng.randbytes(rng.randrange(200)).replace(b"\n", b"")
    message = {"jsonrpc": "2.0", "id": rng.randrange(1000), "method": rng.choice(["tools/call", "tools/call", "ping", "initialize", "x", "tools/list"])}
    if kind == 1:
        message.update({rng.choice(["jsonrpc", "id", "method", "params"]): hostile_values(rng)})
        return json.dumps(message).encode()
    tool = rng.choice(tools_listed)
    names = [*tool["inputSchema"]["properties"], "output", "mask", "image", "sidecar", "force", "threads", "help", "clusters"]
    fine = {"query": {"atlas": "nested.nii.gz", **AIM}, "overlap": {"atlas": "nested.nii.gz", "roi": "nested.nii.gz", "threshold": 1},
            "plan": {"atlas": "nested.nii.gz", "poses": "sub/poses.tsv", "depth": "60"}, "info": {"atlas": "nested.nii.gz"},
            "cite": {"result": "sphere"}, "atlases": {}}[tool["name"]]
    members = fine if rng.random() < 0.7 else {}  # of which a part is hostile: what is asked otherwise gets as far as to files
    members = {**members, **{name: hostile_values(rng) for name in rng.sample(names, min(len(names), rng.randrange(3)))}}
    line = json.dumps(call(tool["name"], members, rng.randrange(1000))).encode()
    return line[:rng.randrange(len(line))] if kind == 2 else line


def traced(lines):
    """The answers, and what was opened, by the whole path; nothing was made, removed or sent."""
    kept = "trace=open,openat,openat2,creat,socket,connect,sendto,sendmsg,mkdir,mkdirat,unlink,unlinkat,rename,renameat,renameat2,link,linkat,symlink,symlinkat,truncate"
    answers = serve(lines, ["strace", "-f", "-qq", "-o", "trace", "-e", kept])
    opened = set()
    with open("trace", encoding="utf-8", errors="replace") as file:
        for line in file:
            found = re.match(r'\d+ +(?:open|openat|openat2)\((?:AT_FDCWD, )?"((?:[^"\\]|\\.)*)", (?:\{flags=)?([A-Z_|]+)', line)
            assert found or re.match(r"\d+ +(<\.\.\.|---|\+\+\+)", line), line
            if found:
                assert not re.search("O_WRONLY|O_RDWR|O_CREAT|O_TRUNC", found[2]), line
                opened.add(os.path.normpath(os.path.join(os.path.abspath("root"), found[1])))
    return answers, opened


def sums():
    return {path: hashlib.sha256(open(path, "rb").read()).hexdigest() for folder in ("root", "installed", "outside")
            for base, _, names in os.walk(folder) for path in (os.path.join(base, name) for name in names) if os.path.exists(path)}


def hostile(count):
    rng = random.Random(105)
    (listed,) = ask({"jsonrpc": "2.0", "id": 1, "method": "tools/list"})
    calls = [call("query", {"atlas": atlas, **AIM}) for atlas in ("nested.nii.gz", "sphere", "missing", "missing.nii.gz")]
    calls += [call("info", {"atlas": "nested.nii.gz"}), call("atlases", {}), call("cite", {"result": "sphere"}), call("cite", {"result": "missing"})]
    _, honest = traced([json.dumps(one).encode() for one in calls])
    before = sums()
    lines = [hostile_line(rng, listed["result"]["tools"]) for _ in range(count)]
    answers, opened = traced(lines)
    wanted = 0
    for line in lines:  # by Python's own parser
        try:
            message = json.loads(line)
            wanted += not (isinstance(message, dict) and message.get("jsonrpc") == "2.0" and isinstance(message.get("method"), str)
                           and "id" not in message)
        except ValueError:
            wanted += 1
    assert len(answers) == wanted, (len(answers), wanted)
    assert sum("result" in answer and answer["result"].get("isError") is False for answer in answers) > count / 100
    assert sums() == before and sorted(os.listdir(".")) == ["installed", "outside", "root", "trace"]
    places = [os.path.abspath(folder) + "/" for folder in ("root", "installed")]
    other = {path for path in opened - honest if not any((path + "/").startswith(place) for place in places)}
    assert not other, sorted(other)
    assert not any(path.startswith(os.path.abspath("root/out")) or path.endswith("dangling.txt") for path in opened), opened
    assert SECRET[:6] not in json.dumps(answers)
    print(f"{count} lines")


if __name__ == "__main__":
    make_files()
    {"transcript": transcript, "tools": tools, "hostile": lambda: hostile(int(sys.argv[3]))}[sys.argv[1]]()
