#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""in_step.py COUNT SEED WINDOW PID: does so many actions in a window, and compares what it shows after each.

Half of them are commands of scripts, which go to stdout, half are mouse and keys of xdotool. After each the window is
left alone until it has nothing more to do: `state` then says of which answer, plan, scene and second answer list, names,
status line, cuts and 3-D picture are, without a frame of its own that could make it right. Ends with 1 where one of them
is of another than the window has: it is late, and would stay so until the mouse moves.
"""
import collections
import importlib.machinery
import json
import os
import random
import subprocess
import sys
import time

HERE = os.path.dirname(os.path.abspath(__file__))
random_actions = importlib.machinery.SourceFileLoader("random_actions", f"{HERE}/random_actions").load_module()

LEFT, RIGHT, HIGH = 50, 395, 360  # the pictures in a window of 640 x 400
KEYS = "x g l m y h i r f t n c b k 2 Return space Escape F7 F9 ctrl+z ctrl+y ctrl+1 ctrl+4 Tab Up Down".split()
PLACES = ("list", "labels", "status", "picture")


def commands(rng):
    """What random_actions does, but for what only writes files, and what is not in a window of one size."""
    aside = ("save", "size", "settle", "wait", "zoom", "picture", "results", "export")
    kinds = random_actions.actions(rng, [])
    more = [
        lambda: f"opacity {rng.choice(('slab', 'anterior', 'posterior'))} {rng.uniform(0, 1):.2f}",
        lambda: f"choose {rng.choice(('slab', 'anterior', 'posterior'))}",
        lambda: f"target {rng.choice(('anterior', 'posterior', ''))}",
        lambda: f"avoid {rng.choice(('anterior', 'posterior'))}{rng.choice(('', ' off'))}",
        lambda: f"second aim {random_actions.place(rng, 90)} {random_actions.place(rng, 20)}",
        lambda: rng.choice(("ask", "ask --radius 3", "ask --layers all", "ask --resolution 8", "ask --range 10,60")),
        lambda: f"fade {rng.random():.2f}",
    ]
    aim = lambda: f"aim {random_actions.place(rng, 90)} {random_actions.place(rng, 10)}"
    point = lambda: f"point {rng.uniform(0.2, 0.8):.3f} {rng.uniform(0.2, 0.8):.3f}"
    angle = lambda: f"angle {rng.uniform(2, 60):.1f}"
    while True:
        line = rng.choice(kinds + more + 3 * [aim, point, angle])()
        if line.split()[0] not in aside:
            yield line


def by_hand(rng):
    """Arguments of xdotool."""
    place = lambda: [str(rng.randint(LEFT, RIGHT)), str(rng.randint(10, HIGH))]
    move = lambda: ["mousemove", "--window", "%1", *place()]
    while True:
        yield rng.choice(
            (
                move,
                move,
                lambda: move() + ["click", "1"],
                lambda: move() + ["click", rng.choice("45")],
                lambda: move() + ["mousedown", "1"] + move() + ["mouseup", "1"],
                lambda: move() + ["mousedown", "3"] + move() + ["mouseup", "3"],
                lambda: ["key", "--window", "%1", rng.choice(KEYS)],
            )
        )()


def await_file(path, process):
    while not os.path.exists(path):
        os.kill(process, 0)
        time.sleep(0.002)


def find_late(state):
    late = [p for p in PLACES for key, number in state.get(p, {}).items() if number != state["is"][key]]
    return late + ["cut" for cut in state["cuts"] if cut != state["colours"]]


def ways_back(state):
    """Keys that bring back what an action hid: a page, the panels, panes beside one that fills the middle."""
    if "status" not in state:
        return ["escape"] if "picture" not in state else ["f"]
    return (["z"] if len(state["cuts"]) < 3 or "picture" not in state else []) + (["\\"] if "list" not in state else [])


def main():
    count, seed, window, process = int(sys.argv[1]), int(sys.argv[2]), sys.argv[3], int(sys.argv[4])
    rng = random.Random(seed)
    scripted, handed = commands(rng), by_hand(rng)
    late, seen, answers = 0, collections.Counter(), set()
    for i in range(count):
        action = next(handed if rng.random() < 0.5 else scripted)
        if isinstance(action, str):
            print(action)
        else:
            subprocess.run(["xdotool"] + [window if word == "%1" else word for word in action], check=True)
        print(f"state {i}.json\ntimes {i}.done", flush=True)
        await_file(f"{i}.done", process)
        state = json.load(open(f"{i}.json"))
        wrong = find_late(state)
        seen.update(p for p in PLACES if p in state)
        seen["cut"] += len(state["cuts"])
        answers.add(state["is"]["answer"])
        late += bool(wrong)
        for key in ways_back(state):
            print(f"key {key}")
    print(late, "late of", count, dict(seen), len(answers), "answers", file=sys.stderr)
    assert min(seen[p] for p in (*PLACES, "cut")) > count * 2 // 3, "what is hidden cannot be late"
    assert len(answers) > count // 6, "few answers"
    return late > 0


if __name__ == "__main__":
    sys.exit(main())
