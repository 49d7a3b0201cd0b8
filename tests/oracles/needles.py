# SPDX-License-Identifier: BSD-3-Clause
"""Distances of needles from objects by brute force (Eq. 21), in numpy, for compare_clearance.py and compare_plan.py.

A needle is the part of a line from depth near to depth far. Objects are sets of pieces: cells of voxels, triangles,
capsules. A sphere round each piece tells which can be the nearest; those are measured exactly. There is no tree."""

import collections
import functools
import itertools

import numpy as np

SLACK = 1e-3  # mm by which bounds in single precision are widened

Needle = collections.namedtuple("Needle", "origin axis near far")
# Distance of an object; for each piece that is as near as that, its number, and the least and the greatest such depth.
Found = collections.namedtuple("Found", "distance pieces first last")


def needle(origin, axis, near=0.0, far=np.inf):
    axis = np.asarray(axis, float)
    return Needle(np.asarray(origin, float), axis / np.linalg.norm(axis), float(near), float(far))


def needle_from_row(row, near=0.0, far=np.inf):
    """x y z dx dy dz, then perhaps near and far."""
    return needle(row[:3], row[3:6], *(row[6:8] if len(row) > 6 else (near, far)))


@functools.lru_cache(8)
def choices(numbers, rows, size):
    """(bound unknowns, free ones, pseudo-inverse of these ones' columns), for a matrix of these numbers."""
    matrix = np.frombuffer(numbers).reshape(rows, size)
    every = itertools.chain.from_iterable(itertools.combinations(range(size), n) for n in range(rows + 1))
    return [([k for k in range(size) if k not in free], list(free),
             np.linalg.pinv(matrix[:, free]) if free else np.zeros((0, rows))) for free in every]


def least_square(matrix, offsets, low, high):
    """min |offset + matrix x| over low <= x <= high, for each offset: (distance, x[0] least, x[0] greatest).

    For every choice of which unknowns lie at which bound the others are solved for, and cut to their bounds. The choice
    of an optimum finds it, all others find something that is allowed. An optimal set that is no point has corners, which
    are found likewise."""
    distances, firsts = [], []
    for fixed, free, inverse in choices(np.ascontiguousarray(matrix).tobytes(), *matrix.shape):
        corners = np.array([*itertools.product(*zip(low[fixed], high[fixed]))])
        rest = offsets + (corners @ matrix[:, fixed].T)[:, None]
        x = np.minimum(np.maximum(-rest @ inverse.T, low[free]), high[free])
        rest += x @ matrix[:, free].T
        distances.extend(np.sqrt(np.einsum("cik,cik->ci", rest, rest)))
        firsts.extend(x[..., free.index(0)] if 0 in free else np.repeat(corners[:, [fixed.index(0)]], len(offsets), 1))
    distances, firsts = np.array(distances), np.array(firsts)
    distances[distances < 1e-12] = 0
    best = distances.min(0)
    tied = distances <= best + 1e-12 * (1 + best)
    return best, np.where(tied, firsts, np.inf).min(0), np.where(tied, firsts, -np.inf).max(0)


def begins_inside(line, found):
    """What was found of an object's border, and the beginning of the needle, which is inside."""
    pieces, firsts, lasts = (found.pieces, found.first, found.last) if found and found.distance == 0 else ([], [], [])
    return Found(0.0, np.array(pieces, int), np.append(firsts, line.near), np.append(lasts, line.near))


class Pieces:
    """What all kinds have: `owners` (sorted), `centres` and `spheres` of the pieces."""

    def __init__(self, owners, centres, spheres):
        self.owners, self.spheres = owners, spheres.astype("f4")
        self.middle = centres.mean(0) if len(centres) else np.zeros(3)
        self.centres = (centres - self.middle).T.astype("f4").copy()
        self.names, self.starts = np.unique(owners, return_index=True)
        self.numbers = np.repeat(np.arange(len(self.names)), np.diff(np.append(self.starts, len(owners))))
        self.reach = np.linalg.norm(centres - self.middle, axis=1).max() + spheres.max() if len(centres) else 0.0

    def end(self, line):
        """A finite far end: what is beyond is farther from everything."""
        return min(line.far, max(line.near, (self.middle - line.origin) @ line.axis + self.reach + 1))

    def candidates(self, line, limit):
        """Pieces that may be the nearest of their owner, if that is within the limit."""
        shift = np.clip((self.middle - line.origin) @ line.axis, line.near, self.end(line))
        base = (line.origin + shift * line.axis - self.middle).astype("f4")
        axis, low, high = line.axis.astype("f4"), np.float32(line.near - shift), np.float32(self.end(line) - shift)
        x, y, z = (self.centres[k] - base[k] for k in range(3))
        t = np.clip(x * axis[0] + y * axis[1] + z * axis[2], low, high)
        x -= t * axis[0]
        y -= t * axis[1]
        z -= t * axis[2]
        away = np.sqrt(x * x + y * y + z * z)
        upper = np.minimum.reduceat(away + self.spheres, self.starts) + SLACK
        return np.flatnonzero(away - self.spheres <= np.minimum(upper, limit + SLACK)[self.numbers] + SLACK)

    def nearest(self, line, limit=np.inf):
        """{owner: Found} of those within the limit."""
        if not len(self.owners):
            return {}
        chosen = self.candidates(line, limit)
        if not len(chosen):
            return {}
        distances, firsts, lasts = self.measure(chosen, line)
        found = {}
        for owner in np.unique(self.owners[chosen]):
            mine = self.owners[chosen] == owner
            best = distances[mine].min()
            tied = mine & (distances <= best + 1e-9)
            if best <= limit:
                found[owner.item()] = Found(best, chosen[tied], firsts[tied], lasts[tied])
        return found


def is_rectangular(matrix):
    gram = matrix.T @ matrix
    return not (gram - np.diag(np.diag(gram))).any()


def box_distance(offsets, speed, half, near, far):
    """Distance of offset + t speed, near <= t <= far, from the box [-half, half]: (distance, least t, greatest t).

    Half of the derivative of the squared distance, the sum of speed times how far beyond the box, never falls, and is
    linear between the depths at which a face's plane is passed. Its root is solved for between two of them."""
    with np.errstate(divide="ignore", invalid="ignore"):
        stops = np.concatenate([(half - offsets) / speed, (-half - offsets) / speed], 1)
    stops = np.where(np.isfinite(stops), stops, near)
    ends = np.broadcast_to([near, far], (len(offsets), 2))
    stops = np.sort(np.clip(np.concatenate([stops, ends], 1), near, far), 1)
    place = offsets[:, None] + stops[..., None] * speed
    slope = (np.sign(place) * np.maximum(abs(place) - half, 0) @ speed)

    def root(level):
        """The least stop or root where the slope is at least a level, far where it is nowhere."""
        after = (slope >= level).argmax(1)
        row = np.arange(len(slope))
        before = np.maximum(after - 1, 0)
        g0, g1, t0, t1 = slope[row, before], slope[row, after], stops[row, before], stops[row, after]
        with np.errstate(divide="ignore", invalid="ignore"):
            at = np.where(g1 > g0, t0 + (level - g0) / (g1 - g0) * (t1 - t0), t1)
        return np.where((slope < level).all(1), far, np.where(after == 0, stops[:, 0], at))

    first = root(-1e-11)
    away = np.maximum(abs(offsets + root(0.0)[:, None] * speed) - half, 0)
    return np.linalg.norm(away, axis=1), first, np.maximum(first, root(1e-11))


class Cells(Pieces):
    """Voxels (n, 3) of the owners, in a grid with a 4 x 4 matrix: those at their owner's border, as a needle comes in
    there. Where it begins inside an object the voxels around its beginning are asked, too."""

    def __init__(self, affine, voxels, owners, labels=np.zeros((0, 0, 0))):
        """labels: owners of all voxels, 0 = none, for needles that begin inside."""
        order = np.lexsort((*voxels.T[::-1], owners))
        self.voxels, self.affine = voxels[order], affine
        self.matrix = affine[:3, :3]
        half = [self.matrix @ corner / 2 for corner in itertools.product((-1, 1), repeat=3)]
        sphere = np.linalg.norm(half, axis=1).max()
        super().__init__(owners[order], self.voxels @ self.matrix.T + affine[:3, 3], np.full(len(voxels), sphere))
        self.labels = labels

    def measure(self, chosen, line):
        return self.measure_voxels(self.voxels[chosen], line)

    def measure_voxels(self, voxels, line):
        offsets = line.origin - (voxels @ self.matrix.T + self.affine[:3, 3])
        end = self.end(line)
        if is_rectangular(self.matrix):
            edges = np.linalg.norm(self.matrix, axis=0)
            turn = self.matrix / edges
            return box_distance(offsets @ turn, line.axis @ turn, edges / 2, line.near, end)
        matrix = np.column_stack([line.axis, -self.matrix])
        return least_square(matrix, offsets, np.array([line.near, *[-0.5] * 3]), np.array([end, *[0.5] * 3]))

    def nearest(self, line, limit=np.inf):
        found = super().nearest(line, limit)
        start = np.linalg.inv(self.affine) @ np.append(line.origin + line.near * line.axis, 1)
        around = np.floor(start[:3] + 0.5).astype(int) + list(itertools.product((-1, 0, 1), repeat=3))
        voxels = around[((around >= 0) & (around < self.labels.shape)).all(1)]
        owners = self.labels[tuple(voxels.T)]
        for owner in np.unique(owners[owners != 0]).tolist():
            distances, firsts, _ = self.measure_voxels(voxels[owners == owner], line)
            if (distances == 0).any() and firsts[distances == 0].min() <= line.near + 1e-12:
                found[owner] = begins_inside(line, found.get(owner))
        return found

    def away(self, pieces, point):
        """Distances of cells from a point, or from one each."""
        offsets = point - (self.voxels[pieces] @ self.matrix.T + self.affine[:3, 3])
        if is_rectangular(self.matrix):
            edges = np.linalg.norm(self.matrix, axis=0)
            return np.linalg.norm(np.maximum(abs(offsets @ (self.matrix / edges)) - edges / 2, 0), axis=1)
        return least_square(-self.matrix, offsets, np.full(3, -0.5), np.full(3, 0.5))[0]


def is_inner(labels):
    """Voxels whose six neighbours have the same label."""
    padded = np.pad(labels, 1)
    inner = np.ones(labels.shape, bool)
    for axis in range(3):
        for step in (0, 2):
            beside = [slice(1, -1)] * 3
            beside[axis] = slice(step, step + labels.shape[axis])
            inner &= padded[tuple(beside)] == labels
    return inner


def cells_of_labels(affine, labels):
    """Cells of all labels but 0."""
    voxels = np.argwhere((labels != 0) & ~is_inner(labels))
    return Cells(affine, voxels, labels[tuple(voxels.T)].astype(np.int64), labels)


def segment_distance(line, end, a, b):
    """Distances of segments a b (n, 3) from a needle: (distance, least depth, greatest depth)."""
    u, w = b - a, line.origin - a
    # |w + t d - s u|: a corner, an edge or the inside of the square of t and s, as least_square() has it
    uu, du, wd, wu = (u * u).sum(1), u @ line.axis, w @ line.axis, (w * u).sum(1)
    tries = []
    with np.errstate(divide="ignore", invalid="ignore"):
        det = uu - du * du
        tries.append(((wu * du - wd * uu) / det, (wu - wd * du) / det))
        for t in (line.near, end):
            tries += [(np.full(len(a), t), s) for s in ((wu + t * du) / uu, np.zeros(len(a)), np.ones(len(a)))]
        tries += [(s * du - wd, np.full(len(a), float(s))) for s in (0, 1)]
    distances, depths = [], []
    for t, s in tries:
        t = np.clip(np.where(np.isfinite(t), t, line.near), line.near, end)
        s = np.clip(np.where(np.isfinite(s), s, 0), 0, 1)
        distances.append(np.linalg.norm(w + t[:, None] * line.axis - s[:, None] * u, axis=1))
        depths.append(t)
    distances, depths = np.array(distances), np.array(depths)
    best = distances.min(0)
    tied = distances <= best + 1e-12 * (1 + best)
    return best, np.where(tied, depths, np.inf).min(0), np.where(tied, depths, -np.inf).max(0)


def point_distance(points, a, b):
    """Distances of points from segments a b (n, 3)."""
    u, w = b - a, points - a
    with np.errstate(divide="ignore", invalid="ignore"):
        s = np.nan_to_num(np.clip((w * u).sum(1) / (u * u).sum(1), 0, 1))
    return np.linalg.norm(w - s[:, None] * u, axis=1)


def windings(point, corners):
    """Solid angles of triangles (n, 3, 3) seen from a point, / 4 pi."""
    r = corners - point
    length = np.linalg.norm(r, axis=2)
    top = np.einsum("ij,ij->i", r[:, 0], np.cross(r[:, 1], r[:, 2]))
    bottom = length.prod(1) + sum((r[:, i] * r[:, (i + 1) % 3]).sum(1) * length[:, (i + 2) % 3] for i in range(3))
    return 2 * np.arctan2(top, bottom) / (4 * np.pi)


def are_closed(corners):
    """Whether triangles (n, 3, 3) pass every edge as often in one direction as in the other."""
    _, number = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    number = number.reshape(-1, 3)
    edges = np.concatenate([number[:, [k, (k + 1) % 3]] for k in range(3)])
    edges = edges[edges[:, 0] != edges[:, 1]]
    ways = [np.sort(edges[:, k] * len(corners) * 3 + edges[:, 1 - k]) for k in (0, 1)]
    return np.array_equal(*ways)


class Triangles(Pieces):
    """Triangles of {owner: list of surfaces (n, 3, 3)}; closed ones have an inside."""

    def __init__(self, surfaces):
        order = sorted(surfaces)
        self.corners = np.concatenate([part for owner in order for part in surfaces[owner]])
        self.solids = {owner: [part for part in surfaces[owner] if are_closed(part)] for owner in order}
        owners = np.repeat(np.array(order), [sum(map(len, surfaces[owner])) for owner in order])
        centres = self.corners.mean(1)
        super().__init__(owners, centres, np.linalg.norm(self.corners - centres[:, None], axis=2).max(1))

    def measure(self, chosen, line):
        corners, end = self.corners[chosen], self.end(line)
        a, e, g = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        n = np.cross(e, g)
        tries = [segment_distance(line, end, corners[:, k], corners[:, (k + 1) % 3]) for k in range(3)]
        with np.errstate(divide="ignore", invalid="ignore"):
            crossing = ((a - line.origin) * n).sum(1) / (n @ line.axis)
            for t in (crossing, np.full(len(a), line.near), np.full(len(a), end)):
                p = line.origin + np.where(np.isfinite(t), t, 0)[:, None] * line.axis - a
                nn = (n * n).sum(1)
                u, v = (np.cross(p, g) * n).sum(1) / nn, (np.cross(e, p) * n).sum(1) / nn
                over = (u >= 0) & (v >= 0) & (u + v <= 1) & (t >= line.near) & (t <= end)
                away = abs((p * n).sum(1)) / np.sqrt(nn) if t is not crossing else np.zeros(len(a))
                tries.append((np.where(over, away, np.inf), t, t))
        distances, firsts, lasts = map(np.array, zip(*tries))
        best = distances.min(0)
        tied = distances <= best + 1e-12 * (1 + best)
        return best, np.where(tied, firsts, np.inf).min(0), np.where(tied, lasts, -np.inf).max(0)

    def is_inside(self, owner, point):
        return any((point >= part.min((0, 1))).all() and (point <= part.max((0, 1))).all()
                   and round(windings(point, part).sum()) != 0 for part in self.solids[owner])

    def nearest(self, line, limit=np.inf):
        found = super().nearest(line, limit)
        start = line.origin + line.near * line.axis
        for owner in self.solids:
            if self.is_inside(owner, start):
                found[owner] = begins_inside(line, found.get(owner))
        return found

    def away(self, pieces, point):
        return self.measure(pieces, Needle(point, np.array([1.0, 0, 0]), 0.0, 0.0))[0]


class Capsules(Pieces):
    """Streamlines of {owner: (list of points (n, 3), radius)}."""

    def __init__(self, bundles):
        order = sorted(bundles)
        begins, ends, owners, radii = [], [], [], []
        for owner in order:
            lines, radius = bundles[owner]
            lines = [np.asarray(line, float) for line in lines if len(line)]
            lines = [line if len(line) > 1 else np.repeat(line, 2, 0) for line in lines]
            begins += [line[:-1] for line in lines]
            ends += [line[1:] for line in lines]
            count = sum(len(line) - 1 for line in lines)
            owners.append(np.full(count, owner))
            radii.append(np.full(count, radius))
        self.a, self.b = np.concatenate(begins), np.concatenate(ends)
        self.radii = np.concatenate(radii)
        half = np.linalg.norm(self.b - self.a, axis=1) / 2
        super().__init__(np.concatenate(owners), (self.a + self.b) / 2, half + self.radii)

    def measure(self, chosen, line):
        a, b, radii, end = self.a[chosen], self.b[chosen], self.radii[chosen], self.end(line)
        distances, firsts, lasts = segment_distance(line, end, a, b)
        # The depth at which the needle enters a capsule: before the nearest place the distance only falls.
        k = np.flatnonzero(distances <= radii)
        low, high = np.full(len(k), line.near), firsts[k]
        for _ in range(100):
            middle = (low + high) / 2
            inside = point_distance(line.origin + middle[:, None] * line.axis, a[k], b[k]) <= radii[k]
            low, high = np.where(inside, low, middle), np.where(inside, middle, high)
        inside = point_distance(line.origin + line.near * line.axis, a[k], b[k]) <= radii[k]
        firsts[k] = lasts[k] = np.where(inside, line.near, high)
        return np.maximum(distances - radii, 0), firsts, lasts

    def away(self, pieces, point):
        """Distances of capsules from a point; of one inside, 0."""
        return np.maximum(point_distance(point, self.a[pieces], self.b[pieces]) - self.radii[pieces], 0)
