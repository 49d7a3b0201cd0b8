#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What the window has to make of a mouse whose events all come between two frames.

quick_mouse.py atlas FILE.nii     writes a ball of 30 mm in voxels of 1 mm, whose eight octants are the areas 1 to 8.
quick_mouse.py actions COUNT      lists so many presses and as many drags, as arguments of xdotool.
quick_mouse.py check              reads these again and compares with the sessions N.json, and N.h.json where the chosen
                                  area is hidden: what a slow mouse would do, by an orbit, a pin-hole and steps along rays.
"""
import json
import math
import random
import sys

import nifti
import numpy

WIDE, HIGH = 500, 320  # pixels of the pane, which fills the window
RADIUS = 30
STEEPEST = 1.55


def octants():
    side = 2 * RADIUS + 4
    at = numpy.indices((side, side, side)) - (side - 1) / 2  # whole voxels to both sides of each plane
    label = 1 + (at[0] > 0) + 2 * (at[1] > 0) + 4 * (at[2] > 0)
    return numpy.where((at**2).sum(axis=0) < RADIUS**2, label, 0).astype(numpy.uint8)


LABELS = octants()


def write_atlas(path):
    nifti.write(path, LABELS.shape, "B", lambda i, j, k: int(LABELS[i, j, k]))


def chain(kind, a, b, c):
    move = lambda p: f"mousemove --window %1 {p[0]} {p[1]}"
    return {
        "press": [move(a), "click 1"],
        "leave": [move(a), "click 1", move(b)],
        "twice": [move(a), "click 1", move(b), "click 1"],
        "shake": [move(a), "mousedown 1", move((a[0] + 2, a[1] + 2)), "mouseup 1"],
        "drag": [move(a), "mousedown 1", move(b), "mouseup 1"],
        "bend": [move(a), "mousedown 1", move(b), move(c), "mouseup 1"],
        "back": [move(a), "mousedown 1", move(b), move(a), "mouseup 1"],
        "out": [move(a), "mousedown 1", move(b), "mouseup 1", move(c)],
    }[kind]


def actions(count):
    """Places on and beside the ball; the view never turns to where it cannot go further up or down."""
    dice = random.Random(66)
    elevation = 0.35
    kinds = ["press", "leave", "twice", "shake"], ["drag", "bend", "back", "out"]
    for i in range(2 * count):
        kind = kinds[i % 2][i // 2 % 4]
        place = lambda: (dice.randrange(90, 385), dice.randrange(80, HIGH - 10))  # beside buttons and the inset
        while True:
            a, b, c = place(), place(), place()
            down = {"drag": b, "bend": c, "out": b}.get(kind, a)[1] - a[1]
            if all(math.dist(p, q) > 12 for p, q in ((a, b), (b, c), (a, c))) and abs(elevation + down * 3.5 / HIGH) < 1.5:
                break
        elevation += down * 3.5 / HIGH
        yield kind, a, b, c


class Window:
    """What the window is to hold."""

    def __init__(self, session):
        *self.centre, self.distance, self.azimuth, self.elevation = session["orbit"]
        self.held, self.crosshair, self.chosen, self.pose = False, session["crosshair"], 0, None

    def look(self, p):
        """The ray through the middle of pixel p, and where it meets the ball: steps of 5 um, halfway to the last one."""
        a, e = self.azimuth, self.elevation
        back = numpy.array([-math.sin(a) * math.cos(e), math.cos(a) * math.cos(e), math.sin(e)])
        right = numpy.array([-math.cos(a), -math.sin(a), 0])
        up = numpy.cross(back, right)
        slope = math.tan(0.25)
        ray = -back + right * slope * (2 * p[0] - WIDE) / HIGH + up * slope * (HIGH - 2 * p[1]) / HIGH
        ray /= numpy.linalg.norm(ray)
        eye = numpy.array(self.centre) + self.distance * back
        steps = numpy.arange(self.distance - 2 * RADIUS, self.distance + 2 * RADIUS, 0.005)
        voxels = numpy.floor(eye + steps[:, None] * ray + LABELS.shape[0] / 2).astype(int)
        inside = ((voxels >= 0) & (voxels < LABELS.shape[0])).all(axis=1)
        found = numpy.zeros(len(steps), int)
        found[inside] = LABELS[tuple(voxels[inside].T)]
        if not found.any():
            return None
        first = numpy.argmax(found > 0)
        return ray, eye + (steps[first] - 0.0025) * ray, found[first]

    def move(self, p):
        at = self.look(p)
        self.pose = at if at and not self.held else self.pose

    def click(self, p):
        at = self.look(p)
        self.held = self.held != (self.pose is not None)
        self.move(p)
        if at:
            self.crosshair, self.chosen = at[1], at[2]

    def turn(self, a, b):
        self.azimuth = math.remainder(self.azimuth + (b[0] - a[0]) * 3.5 / HIGH, 2 * math.pi)
        self.elevation += (b[1] - a[1]) * 3.5 / HIGH

    def do(self, kind, a, b, c):
        self.move(a)
        if kind in ("press", "leave", "twice", "shake"):
            self.click(a)
            if kind in ("leave", "twice"):
                self.move(b)
            if kind == "twice":
                self.click(b)
        else:
            self.turn(a, {"bend": c, "back": a}.get(kind, b))
            if kind == "out":
                self.move(c)

    def wrong(self, session, hidden):
        pose = session["world_from_device"]
        orbit = session["orbit"]
        is_wrong = {
            "held": bool(session["frozen"]) != self.held,
            "has a pose": bool(session["has_pose"]) != (self.pose is not None),
            "azimuth": abs(math.remainder(orbit[4] - self.azimuth, 2 * math.pi)) > 1e-6,
            "elevation": abs(orbit[5] - self.elevation) > 1e-6,
            "crosshair": math.dist(session["crosshair"], self.crosshair) > 0.01,
            "apex": self.pose is not None and math.dist(pose[12:15], self.pose[1]) > 0.01,
            "axis": self.pose is not None and math.dist(pose[8:11], -self.pose[0]) > 1e-5,
            "chosen": hidden["hidden"] != ([int(self.chosen)] if self.chosen else []),
        }
        return [name for name, is_so in is_wrong.items() if is_so]


def check(count):
    load = lambda name: json.load(open(name))
    window = Window(load("0.json"))
    wrong = 0
    for i, action in enumerate(actions(count), 1):
        window.do(*action)
        errors = window.wrong(load(f"{i}.json"), load(f"{i}.h.json"))
        wrong += bool(errors)
        if errors:
            print(i, *action, "wrong:", *errors)
            saved = load(f"{i}.json")  # go on from there
            window.held, window.crosshair = bool(saved["frozen"]), saved["crosshair"]
            window.azimuth, window.elevation = saved["orbit"][4:6]
            m = saved["world_from_device"]
            window.pose = (-numpy.array(m[8:11]), numpy.array(m[12:15])) if saved["has_pose"] else None
            window.chosen = (load(f"{i}.h.json")["hidden"] or [0])[0]
    print(wrong, "wrong of", 2 * count)
    return wrong


if __name__ == "__main__":
    if sys.argv[1] == "atlas":
        write_atlas(sys.argv[2])
    elif sys.argv[1] == "actions":
        for action in actions(int(sys.argv[2])):
            print(*chain(*action))
    else:
        sys.exit(check(int(sys.argv[2])) > 0)
