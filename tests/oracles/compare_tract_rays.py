#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""tests/oracles/compare_tract_rays.py DUMP_TRACT_HITS: first hits of 25,088 rays (100,352 in scripts/test --long) on
streamlines against all capsules in numpy (Eq. 18).

The other way: a line meets a capsule's surface where a quadratic has its roots, of the cylinder where that is between
the ends, else of one of the balls; in double, from the apex. Distances have to be equal within 1e-6 mm, and the point
is one of a segment that the line enters there, within 1e-6 mm. A ray that only one of the two lets hit has to be a
tangent: its line is within 1e-9 mm of a radius from the nearest segment.
"""
import subprocess
import sys

try:
    import numpy as np
except ImportError:
    print("skipped: there is no numpy")
    sys.exit(77)

from sample import LONG

BLOCKS, RAYS, RADIUS = 392 if LONG else 98, 256, 0.5


def make_streamlines(random):
    """16 walks of 15 points within about 30 mm of 0, now and then a point twice; one of a single point."""
    points, first = [], [0]
    for number in range(16):
        count = 1 if number == 7 else 15
        steps = random.uniform(-2, 2, (count, 3)) * (random.uniform(0, 1, (count, 1)) > 0.1)
        points.append(random.uniform(-20, 20, 3) + np.cumsum(steps, axis=0))
        first.append(first[-1] + count)
    return np.concatenate(points).astype(np.float32), np.array(first, np.uint64)


def make_rays(random, points):
    """From 0, 40 or 1000 mm away, towards points of streamlines, up to 2 mm beside them."""
    distances = random.choice([0, 40, 1000], (BLOCKS, 1))
    away = random.normal(size=(BLOCKS, 3))
    origins = away / np.linalg.norm(away, axis=1, keepdims=True) * distances
    targets = points[random.integers(0, len(points), (BLOCKS, RAYS))] + random.uniform(-2, 2, (BLOCKS, RAYS, 3))
    directions = targets - origins[:, None]
    return origins, directions / np.linalg.norm(directions, axis=2, keepdims=True)


def ball(origin, directions, centre):
    """Entry and exit of lines in a ball; NaN = a miss."""
    along = directions @ (origin - centre)
    with np.errstate(invalid="ignore"):
        root = np.sqrt(along * along - ((origin - centre) @ (origin - centre) - RADIUS**2))
    return -along - root, -along + root


def capsule(origin, directions, a, b):
    """Entry and exit of lines in a capsule; NaN = a miss."""
    side, to = b - a, origin - a
    entries, exits = zip(ball(origin, directions, a), ball(origin, directions, b))
    length = side @ side
    if length:
        slope, height = directions @ side, to @ side
        square = length - slope * slope
        half = length * (directions @ to) - height * slope
        rest = length * (to @ to) - height * height - RADIUS**2 * length
        with np.errstate(invalid="ignore", divide="ignore"):
            root = np.sqrt(half * half - square * rest)
            ends = (-half - root) / square, (-half + root) / square
        inside = [np.where((0 <= height + t * slope) & (height + t * slope <= length), t, np.nan) for t in ends]
        entries, exits = (*entries, *inside), (*exits, *inside)
    return np.fmin.reduce(entries), np.fmax.reduce(exits)


def distance(origin, direction, points, segments):
    """Of a line from the nearest segment: the least over a fine grid on each, made finer."""
    least = np.inf
    for k in segments:
        low, high = 0.0, 1.0
        for _ in range(40):
            s = np.linspace(low, high, 9)[:, None]
            way = points[k] + s * (points[k + 1] - points[k]) - origin
            away = np.linalg.norm(way - (way @ direction)[:, None] * direction, axis=1)
            at = int(np.argmin(away))
            low, high = s[max(at - 1, 0), 0], s[min(at + 1, 8), 0]
        least = min(least, away.min())
    return least


def main(program):
    random = np.random.default_rng(18)
    floats, first = make_streamlines(random)
    points = floats.astype(np.float64)
    origins, directions = make_rays(random, points)
    text = np.array([len(points), len(first) - 1, BLOCKS], np.uint64).tobytes() + np.float64(RADIUS).tobytes()
    text += floats.tobytes() + first.tobytes()
    for origin, rays in zip(origins, directions):
        text += origin.tobytes() + np.ascontiguousarray(rays.T).tobytes()
    out = subprocess.run([program], input=text, stdout=subprocess.PIPE, check=True).stdout
    got = np.frombuffer(out, np.float64).reshape(BLOCKS, 2, RAYS)
    got_points = np.frombuffer(out, np.uint64).reshape(BLOCKS, 2, RAYS)[:, 1]
    ends = set(int(f) - 1 for f in first[1:])
    segments = [k for k in range(len(points)) if k not in ends or k - 1 in ends]  # a single point is one, too
    farther = hits = tangents = 0
    for block in range(BLOCKS):
        best = np.full(RAYS, np.inf)
        mine = np.full(RAYS, np.inf)  # of the segment that conus names
        for k in segments:
            b = points[k] if k in ends else points[k + 1]
            entry, leave = capsule(origins[block], directions[block], points[k], b)
            t = np.where(leave >= 0, np.maximum(entry, 0), np.inf)
            best = np.fmin(best, t)
            mine = np.where(got_points[block] == k, t, mine)
        t = got[block, 0]
        hits += np.isfinite(t).sum()
        both = np.isfinite(t) & np.isfinite(best)
        with np.errstate(invalid="ignore"):  # two infinities
            off, mine_off = np.abs(t - best), np.abs(mine - best)
        wrong = np.where(both, ~((off <= 1e-6) & (mine_off <= 1e-6)), np.isfinite(t) != np.isfinite(best))
        farther = max(farther, off[both & ~wrong].max(initial=0))
        for ray in np.flatnonzero(wrong):
            away = distance(origins[block], directions[block, ray], points, [k for k in segments if k not in ends])
            tangents += 1
            if abs(away - RADIUS) > 1e-9:
                print(f"block {block}, ray {ray}: {t[ray]!r} at {got_points[block, ray]}, numpy {best[ray]!r}, the"
                      f" line is {away!r} mm away")
                return 1
    print(f"{BLOCKS * RAYS} rays, {hits} hits, distances equal within {farther:.2g} mm, {tangents} tangents")
    return 0 if 0.3 * BLOCKS * RAYS < hits < 0.95 * BLOCKS * RAYS and tangents < 20 else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
