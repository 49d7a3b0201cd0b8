# SPDX-License-Identifier: BSD-3-Clause
"""What a needle has of a structure, by brute force: its length in it and how deep it is inside (Eq. 17, 22), in numpy.

A structure is a union of voxels of one grid, or of closed surfaces. `pieces` are its own, for distances (Eq. 21),
`border` are those of what is not the structure that may be nearest to a point in it."""

import numpy as np

import needles as by

STEPS = 36  # of bisection: 1e-9 mm of 60


def merged(parts):
    """Union of intervals, in order."""
    rows = []
    for first, last in sorted(parts):
        if rows and first <= rows[-1][1]:
            rows[-1][1] = max(rows[-1][1], last)
        else:
            rows.append([first, last])
    return rows


def length_without(inside, taken):
    """Length of the union of intervals `inside` that no interval `taken` covers."""
    total = 0.0
    for first, last in inside:
        reached = first
        for begin, end in taken:
            begin, end = max(begin, first), min(end, last)
            if end > begin and end > reached:
                total += max(0.0, begin - reached)
                reached = end
        total += max(0.0, last - reached)
    return total


class Structure:
    def length(self, line):
        return sum(last - first for first, last in self.inside(line))

    def nearest(self, line, limit=np.inf):
        """(distance, Found) of the nearest piece."""
        found = [one for one in self.pieces.nearest(line, limit).values()]
        return min(found, key=lambda one: (one.distance, one.first.min())) if found else None

    def depth(self, point):
        """Distance of a point from what is not the structure, 0 outside."""
        return self.away(np.arange(len(self.border.owners)), point).min() if self.has(point) else 0.0

    def length_below(self, line, delta):
        """Length of the parts of the axis that are at least delta inside: without what each grown piece takes."""
        inside, end = self.inside(line), self.border.end(line)
        if not inside:
            return 0.0
        chosen = np.flatnonzero(self.all_near(line, delta))
        distances, firsts, _ = self.border.measure(chosen, line)
        chosen, middle = chosen[distances < delta], firsts[distances < delta]
        ends = []
        for limit in (line.near, end):
            outer, inner = np.full(len(chosen), limit), middle.copy()
            within = self.each_away(chosen, line.origin + outer[:, None] * line.axis) < delta
            for _ in range(STEPS):
                half = (outer + inner) / 2
                is_in = self.each_away(chosen, line.origin + half[:, None] * line.axis) < delta
                inner, outer = np.where(is_in, half, inner), np.where(is_in, outer, half)
            ends.append(np.where(within, limit, inner))
        return length_without(inside, merged(zip(*map(np.ndarray.tolist, ends))))

    def all_near(self, line, delta):
        """Which pieces of the border may be nearer than delta to the needle."""
        centres = self.border.centres.T + self.border.middle
        t = np.clip((centres - line.origin) @ line.axis, line.near, self.border.end(line))
        away = np.linalg.norm(centres - line.origin - t[:, None] * line.axis, axis=1)
        return away - self.border.spheres <= delta + by.SLACK

    def leeway(self, line, length, steps=40):
        """The largest delta for which the needle is still in it for a length, by bisection; NaN where it is not."""
        if self.length(line) < length:
            return np.nan
        low, high = 0.0, 1.0
        while self.length_below(line, high) >= length:
            low, high = high, 2 * high
        for _ in range(steps):
            middle = (low + high) / 2
            low, high = (middle, high) if self.length_below(line, middle) >= length else (low, middle)
        return low


class VoxelStructure(Structure):
    def __init__(self, affine, mask):
        self.mask, self.inverse = mask, np.linalg.inv(affine)
        self.pieces = by.cells_of_labels(affine, mask.astype("i1"))
        padded = np.pad(mask, 1)
        beside = np.zeros_like(padded)
        for axis in range(3):
            for step in (-1, 1):
                beside |= np.roll(padded, step, axis)
        voxels = np.argwhere(beside & ~padded) - 1
        self.border = by.Cells(affine, voxels, np.zeros(len(voxels), int))

    def inside(self, line):
        """Intervals of the needle in it: cut at all planes between voxels, with the voxel at the middle of every part."""
        o = self.inverse[:3, :3] @ line.origin + self.inverse[:3, 3]
        d = self.inverse[:3, :3] @ line.axis
        cuts = [np.array([line.near, self.pieces.end(line)])]
        for axis, size in enumerate(self.mask.shape):
            if d[axis]:
                cuts.append((np.arange(size + 1) - 0.5 - o[axis]) / d[axis])
        t = np.sort(np.clip(np.concatenate(cuts), *cuts[0]))
        voxel = np.floor(o[:, None] + d[:, None] * (t[1:] + t[:-1]) / 2 + 0.5).astype(int)
        shape = np.array(self.mask.shape)[:, None]
        within = ((voxel >= 0) & (voxel < shape)).all(0) & (t[1:] > t[:-1])
        within[within] = self.mask[tuple(voxel[:, within])]
        return [part for part in merged(zip(t[:-1][within].tolist(), t[1:][within].tolist()))]

    def has(self, point):
        voxel = np.floor(self.inverse[:3, :3] @ point + self.inverse[:3, 3] + 0.5).astype(int)
        return bool((voxel >= 0).all() and (voxel < self.mask.shape).all() and self.mask[tuple(voxel)])

    def away(self, pieces, point):
        return self.border.away(pieces, point)

    def each_away(self, pieces, points):
        return self.border.away(pieces, points)


class SurfaceStructure(Structure):
    """Closed surfaces {owner: (n, 3, 3)} that are not in each other."""

    def __init__(self, surfaces):
        self.pieces = self.border = by.Triangles({owner: [part] for owner, part in surfaces.items()})
        self.surfaces = list(surfaces.values())

    def inside(self, line):
        parts = []
        for corners in self.surfaces:
            a, e, g = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
            p, det = np.cross(line.axis, g), 0
            det = (e * p).sum(1)
            w = line.origin - a
            q = np.cross(w, e)
            with np.errstate(divide="ignore", invalid="ignore"):
                u, v, t = (w * p).sum(1) / det, q @ line.axis / det, (g * q).sum(1) / det
                met = (u >= 0) & (v >= 0) & (u + v <= 1)
            crossed = sorted(zip(t[met].tolist(), np.sign(det[met]).tolist()))
            winding = 0
            for k, (at, side) in enumerate(crossed[:-1]):
                winding += side
                if winding:
                    parts.append((max(at, line.near), min(crossed[k + 1][0], line.far)))
        return merged((first, last) for first, last in parts if last > first)

    def has(self, point):
        return any(round(by.windings(point, corners).sum()) != 0 for corners in self.surfaces)

    def away(self, pieces, point):
        return self.border.away(pieces, point)

    def each_away(self, pieces, points):
        """Distances of triangles from a point each."""
        corners = self.border.corners[pieces]
        a, e, g, w = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0], points - corners[:, 0]
        n = np.cross(e, g)
        nn = (n * n).sum(1)
        u, v = (np.cross(w, g) * n).sum(1) / nn, (np.cross(e, w) * n).sum(1) / nn
        over = (u >= 0) & (v >= 0) & (u + v <= 1)
        edges = [by.point_distance(points, corners[:, k], corners[:, (k + 1) % 3]) for k in range(3)]
        return np.where(over, abs((w * n).sum(1)) / np.sqrt(nn), np.min(edges, axis=0))
