# SPDX-License-Identifier: BSD-3-Clause
"""Doses of weights (Eq. 33): each form against brute force by numpy, closed forms, and hard against nothing. $CONUS is
conus."""
import io
import math
import os
import subprocess

import nibabel
import numpy as np
import pandas
import pytest

import conus
from support import AAL, call_conus, needs_aal

TIP = np.array([1.0, -2.0, 3.0])
ALONG = np.array([0.2, 0.9, -0.3]) / np.linalg.norm([0.2, 0.9, -0.3])


# The forms of Eq. 30, written from the page and not from the program; r is the offset, z the depth, t the angle.
def coil(d, w):
    return lambda r, z: 2.0 ** (-z / d - (r / w) ** 2)


def focus(f, l, a):
    return lambda r, z: 2.0 ** (-4 * ((r / l) ** 2 + ((z - f) / a) ** 2))


def fibre(r0, na, s=7.37, k=0.125, n=1.36):
    a = 1 + k / s
    b = math.sqrt(a * a - 1)

    def value(r, z):
        wide = r0 + z * math.tan(math.asin(na / n))
        x = b * s * np.hypot(r, z)
        return np.where(z < 0, 0, (r0 / wide) ** 2 * np.exp(-2 * (r / wide) ** 2) * b / (a * np.sinh(x) + b * np.cosh(x)))

    return value


def gauss(sigma):
    def value(r, z):
        t = np.arctan2(r, z)
        return np.exp(-((np.degrees(t) / sigma) ** 2) / 2) * np.where(t > 0, t / np.sin(np.maximum(t, 1e-12)), 1)

    return value


def light_ends(value):
    """Where W on the axis is 1/512, by halving."""
    low, high = 0.0, 100.0
    for _ in range(100):
        middle = (low + high) / 2
        low, high = (middle, high) if value(0.0, middle) > 1 / 512 else (low, middle)
    return low


def voxels(shape=(23, 27, 25), edges=(2.0, 2.5, 3.0), seed=1, reach=0.0, flip=False):
    """Labels of blocks on an oblique grid that is sheared, and perhaps flipped, in front of the tip."""
    random = np.random.default_rng(seed)
    turn = np.linalg.qr(random.normal(size=(3, 3)))[0]
    axes = turn @ np.diag(edges)
    axes[:, 1] += 0.2 * axes[:, 0]
    axes[:, 0] *= -1 if flip else 1
    affine = np.eye(4)
    affine[:3, :3] = axes
    affine[:3, 3] = TIP + reach * ALONG - axes @ ((np.array(shape) - 1) / 2)
    blocks = random.integers(0, 6, [math.ceil(n / 6) for n in shape])
    labels = np.kron(blocks, np.ones((6, 6, 6), int))[: shape[0], : shape[1], : shape[2]]
    return labels.astype("u1"), affine


def offsets_of(points):
    v = points - TIP
    z = v @ ALONG
    return np.linalg.norm(v - z[..., None] * ALONG, axis=-1), z


def brute(labels, affine, value, inside, parts=8):
    """By label: the integral over cells whose centre is inside, of parts^3 middles each; volume; the largest at a centre."""
    where = np.argwhere(labels > 0)
    r, z = offsets_of(where @ affine[:3, :3].T + affine[:3, 3])
    where, found = where[inside(r, z)], {}
    cube, few = (np.stack(np.meshgrid(*[(np.arange(n) + 0.5) / n - 0.5] * 3, indexing="ij"), -1).reshape(-1, 3) for n in (parts, 4))
    cell = abs(np.linalg.det(affine[:3, :3]))
    for label in np.unique(labels[tuple(where.T)]):
        mine = where[labels[tuple(where.T)] == label]
        means, points = (np.array([value(*offsets_of((v + c) @ affine[:3, :3].T + affine[:3, 3])) for v in mine]) for c in (cube, few))
        centres = value(*offsets_of(mine @ affine[:3, :3].T + affine[:3, 3]))
        found[int(label)] = {"dose": cell * means.mean(1).sum(), "volume": cell * len(mine), "largest": centres.max(),
                             "at": mine[centres.argmax()] @ affine[:3, :3].T + affine[:3, 3],
                             "above": lambda level, points=points: cell * (points >= level).mean(1).sum()}
    return found


def whole_of(value, rim, near, far, square=False, steps=1200):
    """The integral over the region, by middles."""
    z = near + (np.arange(steps) + 0.5) / steps * (far - near)
    if square:
        at = (np.arange(400) + 0.5) / 400
        x, y = np.meshgrid(at, at)
        return sum(4 * (value(np.hypot(x, y) * rim(d), np.full_like(x, d))).mean() * rim(d) ** 2 for d in z) * (far - near) / steps
    s = (np.arange(steps) + 0.5) / steps
    r = s[None, :] * rim(z)[:, None]
    return (2 * np.pi * r * value(r, np.broadcast_to(z[:, None], r.shape)) * rim(z)[:, None]).mean() * (far - near)


FIBRE = fibre(0.3, 0.39)
END = light_ends(FIBRE)
FORMS = {
    "coil": ("coil=20:9", coil(20, 9), dict(reach=40), 27, (0, 180)),
    "focus": ("focus=40:12:30", focus(40, 12, 30), dict(reach=40), 18, (0, 85)),
    "narrow focus": ("focus=30:4:20", focus(30, 4, 20), dict(reach=30), 6, (0, 60)),
    "fibre": ("fibre=0.3:0.39", FIBRE, dict(reach=1, edges=(0.2, 0.25, 0.3)), 1.77 * (0.3 + END * math.tan(math.asin(0.39 / 1.36))), (0, END)),
}


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("flip", [False, True])
def test_a_form_is_its_integral(form, flip):
    text, value, place, radius, (near, far) = FORMS[form]
    labels, affine = voxels(flip=flip, **place)
    atlas = conus.load(labels, affine, labels={i: f"part {i}" for i in range(1, 6)})
    hits = atlas.select(TIP, direction=ALONG, weight=text)
    assert hits.to_dataframe()["dose"].notna().all()
    found = brute(labels, affine, value, lambda r, z: (r <= radius) & (z >= near) & (z <= far))
    whole = whole_of(value, lambda z: np.full_like(z, radius), near, far)
    seen = {int(r["object"]): r for r in hits.results}
    assert set(seen) == {0, *found} and len(found) >= 3
    level = 0.5 * max(f["largest"] for f in found.values())
    total = sum(f["dose"] for f in found.values())
    for label, expected in found.items():
        row = seen[label]
        assert row["dose"] == pytest.approx(expected["dose"], rel=0.005, abs=1e-4 * total)
        assert row["dose_share"] == pytest.approx(expected["dose"] / max(whole, total), rel=0.005, abs=1e-4)
        assert row["mean_weight"] == pytest.approx(expected["dose"] / expected["volume"], rel=0.005, abs=1e-4 * total / expected["volume"])
        assert row["max_weight"] == pytest.approx(expected["largest"], rel=1e-9)
        assert row["max_at"] == pytest.approx(expected["at"], abs=1e-9)
        assert row["above"] == pytest.approx(expected["above"](level), rel=1e-9)
        assert math.isnan(row["weight"]) and math.isnan(row["value_dose"])
    areas = [row for label, row in seen.items() if label]
    assert sum(row["dose_share"] for row in areas) + seen[0]["dose_share"] == pytest.approx(1, abs=1e-9)
    assert seen[0]["dose"] == pytest.approx(max(whole, total) - sum(row["dose"] for row in areas), abs=2e-3 * whole)


def block(edge, half, reach):
    """One area: a cube around the axis."""
    n = int(2 * half / edge)
    affine = np.diag([edge, edge, edge, 1.0])
    affine[:3, 3] = TIP + reach * ALONG - edge * (n - 1) / 2
    return conus.load(np.ones((n, n, n), "u1"), affine, labels={1: "all"})


def test_volumes_above_and_integrals_have_closed_forms():
    """Eq. 30's W is above P times its largest in an ellipsoid (focus) or under a paraboloid (coil)."""
    focus_rows = block(1, 50, 70).select(TIP, direction=ALONG, weight="focus=70:20:40,above=50%").to_dataframe().set_index("name")
    # ((r/20)^2 + (z/40)^2) <= 1/4: semi-axes 10, 10, 20
    volume = 4 / 3 * math.pi * 10 * 10 * 20
    assert focus_rows.loc["all", "above"] == pytest.approx(volume, rel=2e-3)
    assert focus_rows.loc["all", "above_share"] + focus_rows.loc["unassigned", "above_share"] == pytest.approx(1, abs=1e-12)
    # V_L of the whole region itself: what the area has, and what is unassigned; the area's share of it
    assert focus_rows["above"].sum() == pytest.approx(volume, rel=2e-3)
    # the integral over the cylinder: (pi l^2 / (4 ln 2)) (1 - 2^-9) times that along the axis
    along = 40 / 2 * math.sqrt(math.pi / math.log(2)) * math.erf(3 * math.sqrt(math.log(2)))
    whole = math.pi * 400 / (4 * math.log(2)) * (1 - 2**-9) * along
    assert focus_rows["dose"].sum() == pytest.approx(whole, rel=1e-6)
    coil_rows = block(1, 30, 30).select(TIP, direction=ALONG, weight="coil=10:12,above=50%").to_dataframe().set_index("name")
    assert coil_rows["above"].sum() == pytest.approx(math.pi * 144 * 10 / 2, rel=2e-3)  # V1/2 = pi w^2 d / 2
    whole = 10 / math.log(2) * (1 - 2**-9) * math.pi * 144 / math.log(2) * (1 - 2**-9)
    assert coil_rows["dose"].sum() == pytest.approx(whole, rel=1e-6)
    square = block(1, 30, 30).select(TIP, direction=ALONG, weight="coil=10:12", aperture="square").to_dataframe()
    side = 12 * math.sqrt(math.pi / math.log(2)) * math.erf(3 * math.sqrt(math.log(2)))  # along one edge, from -3 w to 3 w
    assert square["dose"].sum() == pytest.approx(10 / math.log(2) * (1 - 2**-9) * side**2, rel=1e-6)


def table_of(path, value, x, z, name="offset_mm"):
    """A table of a form, as k-Wave's users write one: metres times 1000, in any order."""
    rows = [f"{a:.9g}\t{d:.9g}\t{w:.9g}" for d in z for a, w in zip(x, value(x, d))]
    np.random.default_rng(1).shuffle(rows)
    path.write_text(f"# unit: V/m\n{name}\tdepth_mm\tweight\n" + "\n".join(rows) + "\n")
    return str(path)


def test_a_table_of_a_form_is_the_form(tmp_path):
    labels, affine = voxels(reach=40)
    atlas = conus.load(labels, affine, labels={i: f"part {i}" for i in range(1, 6)})
    path = table_of(tmp_path / "field.tsv", focus(40, 12, 30), np.linspace(0, 18, 91), np.linspace(0, 85, 341))
    by_table, by_form = (atlas.select(TIP, direction=ALONG, weight=w).to_dataframe().set_index("name").sort_index() for w in (path, "focus=40:12:30"))
    for column in ("dose", "dose_share", "mean_weight", "max_weight"):
        ours, theirs = by_table[column].fillna(0), by_form[column].fillna(0)
        assert ours.to_numpy() == pytest.approx(theirs.to_numpy(), rel=2e-3, abs=2e-4 * theirs.max())
    # by angle and depth, in a cone: W = z up to 10 degrees is z whatever the angle
    path = table_of(tmp_path / "cone.tsv", lambda t, z: 0 * t + z, np.array([0.0, 10.0]), np.array([10.0, 60.0]), "angle_deg")
    found = brute(labels, affine, lambda r, z: z, lambda r, z: (np.degrees(np.arctan2(r, z)) <= 10) & (z >= 10) & (z <= 60))
    hits = atlas.select(TIP, direction=ALONG, weight=path)
    for row in hits.results[:-1]:
        assert row["dose"] == pytest.approx(found[int(row["object"])]["dose"], rel=0.005)
    # the whole: the integral of z dV over the cone is pi tan^2(10 degrees) (60^4 - 10^4) / 4
    assert hits.results["dose"].sum() == pytest.approx(math.pi * math.tan(math.radians(10)) ** 2 * (60**4 - 10**4) / 4, rel=1e-6)


def test_a_ring_in_a_cone_is_no_weight_of_0(tmp_path):
    """Offsets are mm at every depth: a cone of 12 degrees reaches 12 mm off its axis, though half of it is 6 degrees."""
    labels, affine = voxels(reach=100, edges=(3, 3, 3))
    nibabel.save(nibabel.Nifti1Image(labels, affine), tmp_path / "a.nii")
    path = table_of(tmp_path / "ring.tsv", lambda r, z: np.interp(r, [0, 8, 9, 20], [0, 0, 1, 0]) + 0 * z, np.array([0.0, 8, 9, 20]), np.array([10.0, 180]))
    far = TIP + ALONG
    done = call_conus("query", tmp_path / "a.nii", "--labels-anyway", "--origin=%g,%g,%g" % tuple(TIP), "--toward=%.9g,%.9g,%.9g" % tuple(far),
                      "--angle=12", f"--weight={path}", "--format=tsv")
    rows = pandas.read_csv(io.BytesIO(done.stdout), sep="\t", na_values="n/a", keep_default_na=False)
    assert done.returncode == 0 and rows["dose"].max() > 0 and b"0 everywhere" not in done.stderr


@pytest.mark.parametrize("square", [False, True])
def test_gauss_in_a_cone_with_a_far_end(square):
    labels, affine = voxels(reach=60)
    atlas = conus.load(labels, affine, labels={i: f"part {i}" for i in range(1, 6)})
    hits = atlas.select(TIP, direction=ALONG, weight="gauss=3", layers="all", range=(30, 90), aperture="square" if square else "circle", angle=24, up=(0, 0, 1))
    slope = math.tan(math.radians(12))
    across = np.cross(ALONG, [0, 0, 1]) / np.linalg.norm(np.cross(ALONG, [0, 0, 1]))
    axes = np.stack([across, np.cross(across, ALONG)], -1)

    def inside(r, z):
        points = np.argwhere(labels > 0) @ affine[:3, :3].T + affine[:3, 3] - TIP
        beside = np.abs(points @ axes).max(-1) if square else r
        return (beside <= slope * z) & (z >= 30) & (z <= 90)

    found = brute(labels, affine, gauss(3), inside)
    assert {int(r["object"]) for r in hits.results} >= set(found)
    for row in hits.results[:-1]:
        assert row["dose"] == pytest.approx(found[int(row["object"])]["dose"], rel=0.005)
    assert hits.results["dose"].sum() == pytest.approx(whole_of(gauss(3), lambda z: slope * z, 30, 90, square, 60 if square else 1200), rel=1e-3)
    assert not np.isnan(hits.results["weight"]).any()


def test_a_region_without_an_end_has_doses_but_no_shares():
    labels, affine = voxels(reach=60)
    rows = conus.load(labels, affine).select(TIP, direction=ALONG, weight="gauss=3", layers="all").to_dataframe()
    assert rows["dose"][:-1].notna().all() and rows["dose"].isna().iloc[-1] and rows[["dose_share", "above_share"]].isna().all(axis=None)


def test_scores_rank_by_dose():
    labels, affine = voxels(reach=40)
    for score in ("dose", "dose_share"):
        results = conus.load(labels, affine).select(TIP, direction=ALONG, weight="coil=20:9", score=score).results[:-1]
        assert list(results["score"]) == list(results[score]) == sorted(results[score], reverse=True)


def test_a_ball_by_distance_is_the_integral(tmp_path):
    """W = 1 - s/20 about a point: dose = the integral over cells whose centre is within 20 mm."""
    labels, affine = voxels(edges=(1.5, 2.0, 2.5))
    atlas = conus.load(labels, affine, labels={i: f"part {i}" for i in range(1, 6)})
    path = tmp_path / "ball.tsv"
    path.write_text("distance_mm\tweight\n0\t1\n20\t0.25\n")
    value = lambda r, z: np.maximum(1 - 0.0375 * np.hypot(r, z), 0.25)
    found = brute(labels, affine, value, lambda r, z: np.hypot(r, z) <= 20)
    for radius in (0, 20):
        hits = atlas.selector(weight=str(path)).near(TIP, radius)
        rows = {int(r["object"]): r for r in hits.results}
        assert set(rows) >= set(found)
        for label, expected in found.items():
            assert rows[label]["dose"] == pytest.approx(expected["dose"], rel=0.005)
            assert rows[label]["max_weight"] == pytest.approx(expected["largest"], rel=1e-9)
        # the integral of (1 - 0.0375 s) 4 pi s^2 from 0 to 20
        assert hits.results["dose"].sum() == pytest.approx(4 * math.pi * (20**3 / 3 - 0.0375 * 20**4 / 4), rel=1e-6)
        assert hits.results["dose_share"].sum() == pytest.approx(1, abs=1e-9)


def ball_mesh(centre, radius, parts=40):
    """A ball of latitudes and longitudes."""
    t, p = np.pi * np.arange(1, parts) / parts, 2 * np.pi * np.arange(2 * parts) / (2 * parts)
    ring = np.stack([np.outer(np.sin(t), np.cos(p)), np.outer(np.sin(t), np.sin(p)), np.outer(np.cos(t), np.ones_like(p))], -1)
    points = np.concatenate([[[0, 0, 1]], ring.reshape(-1, 3), [[0, 0, -1]]])
    n, faces = 2 * parts, []
    at = lambda i, k: 1 + i * n + k % n
    for k in range(n):
        faces.append((0, at(0, k), at(0, k + 1)))
        faces.append((len(points) - 1, at(parts - 2, k + 1), at(parts - 2, k)))
        for i in range(parts - 2):
            faces += [(at(i, k), at(i + 1, k), at(i + 1, k + 1)), (at(i, k), at(i + 1, k + 1), at(i, k + 1))]
    return np.array(centre) + radius * points, np.array(faces)


def surface_atlas(tmp_path, balls):
    for number, (centre, radius) in enumerate(balls):
        points, faces = ball_mesh(centre, radius)
        lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in points] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
        (tmp_path / f"ball{number}.obj").write_text("\n".join(lines) + "\n")
    return conus.load(str(tmp_path) + ",space=ras") if len(balls) > 1 else conus.load(str(tmp_path / "ball0.obj") + ",space=ras")


def points_in(centre, radius, edge):
    at = np.arange(-radius + edge / 2, radius, edge)
    points = np.stack(np.meshgrid(at, at, at, indexing="ij"), -1).reshape(-1, 3)
    return centre + points[np.linalg.norm(points, axis=-1) <= radius]


@pytest.mark.parametrize("text, value, radius, far, angle", [
    ("coil=20:9", coil(20, 9), 27, 180, None), ("focus=40:12:30", focus(40, 12, 30), 18, 85, None), ("gauss=4", gauss(4), 0, 90, 32)])
def test_a_surface_is_its_integral(tmp_path, text, value, radius, far, angle):
    centre, size = TIP + 42 * ALONG + [6, 2, 0], 12
    options = {} if radius else {"layers": "all", "range": (0, far), "angle": angle}
    row = surface_atlas(tmp_path, [(centre, size)]).select(TIP, direction=ALONG, weight=text, **options).results[0]
    points = points_in(centre, size, 0.25)
    r, z = offsets_of(points)
    inside = (r <= (radius if radius else z * math.tan(math.radians(angle / 2)))) & (z >= 0) & (z <= far)
    w = value(r, z)[inside]
    assert row["dose"] == pytest.approx(w.sum() * 0.25**3, rel=0.015)
    assert row["mean_weight"] == pytest.approx(w.mean(), rel=0.015)
    assert row["max_weight"] == pytest.approx(w.max(), rel=0.02)
    assert row["above"] == pytest.approx((w >= 0.5 * row["max_weight"]).sum() * 0.25**3, rel=0.02)


def test_a_surface_in_a_ball_is_its_integral(tmp_path):
    (tmp_path / "w.tsv").write_text("distance_mm\tweight\n0\t1\n5\t1\n20\t0.25\n")
    centre = TIP + np.array([9.0, 4, 0])
    row = surface_atlas(tmp_path, [(centre, 12)]).selector(weight=str(tmp_path / "w.tsv")).near(TIP, 20).results[0]
    s = np.linalg.norm(points_in(centre, 12, 0.25) - TIP, axis=-1)
    w = np.interp(s[s <= 20], [0, 5, 20], [1, 1, 0.25])
    assert row["dose"] == pytest.approx(w.sum() * 0.25**3, rel=0.01)
    assert row["above"] == pytest.approx((w >= 0.5).sum() * 0.25**3, rel=0.01)
    assert row["max_weight"] == pytest.approx(1, abs=0.01)


@pytest.mark.parametrize("shape", ["cylinder", "ball"])
def test_a_bundle_is_its_integral(tmp_path, shape):
    random = np.random.default_rng(5)
    lines = [np.cumsum(np.concatenate([TIP + 40 * ALONG + random.normal(size=(1, 3)) * 10, random.normal(size=(40, 3)) * 2]), axis=0) for _ in range(30)]
    labels, affine = voxels(reach=40)
    atlas = conus.load(labels, affine, streamlines=[[line.astype("f4") for line in lines]])
    (tmp_path / "w.tsv").write_text("distance_mm\tweight\n0\t1\n60\t0.25\n")
    if shape == "ball":
        value, hits = lambda p: 1 - 0.0125 * np.linalg.norm(p - TIP, axis=-1), atlas.selector(weight=str(tmp_path / "w.tsv")).near(TIP, 45)
        inside = lambda p: np.linalg.norm(p - TIP, axis=-1) <= 45
    else:
        value, hits = lambda p: coil(20, 9)(*offsets_of(p)), atlas.select(TIP, direction=ALONG, weight="coil=20:9")
        inside = lambda p: (offsets_of(p)[0] <= 27) & (offsets_of(p)[1] >= 0) & (offsets_of(p)[1] <= 180)
    row, = [r for r in hits.results if r["streamlines_total"]]
    level = 0.5 * max(r["max_weight"] for r in hits.results if r["object"] and not r["streamlines_total"])
    dose, largest, above = 0.0, 0.0, 0
    for line in lines:
        line = line.astype("f4").astype(float)
        s = (np.arange(400) + 0.5) / 400
        points = line[:-1, None] + s[None, :, None] * np.diff(line, axis=0)[:, None]
        steps = np.linalg.norm(np.diff(line, axis=0), axis=-1)[:, None] / 400
        w = np.where(inside(points), value(points), 0)
        dose, largest = dose + (w * steps).sum(), max(largest, w.max())
        above += (w >= level).any()
    assert row["dose"] == pytest.approx(dose, rel=2e-3) and row["mean_weight"] == pytest.approx(dose / row["length"], rel=2e-3)
    assert row["max_weight"] == pytest.approx(largest, rel=0.01) and row["above"] == above
    assert math.isnan(row["dose_share"]) and math.isnan(row["above_share"])


@pytest.mark.parametrize("options", [{"radius": 12.0, "layers": "all"}, {"layers": "all"}, {"layers": "all", "range": (20, 60), "aperture": "square"}])
def test_hard_is_the_volume_of_surfaces_and_the_length_of_bundles(tmp_path, options):
    random = np.random.default_rng(5)
    lines = [(TIP + 40 * ALONG + random.normal(size=(40, 3)) * 10).astype("f4") for _ in range(20)]
    surface_atlas(tmp_path, [(TIP + 42 * ALONG + [6, 2, 0], 12)])
    labels, affine = voxels(reach=40)
    for atlas, extent in ((conus.load(str(tmp_path / "ball0.obj") + ",space=ras"), "volume"), (conus.load(labels, affine, streamlines=[lines]), "length")):
        plain, hard = (atlas.select(TIP, direction=ALONG, **options, **more) for more in ({}, {"weight": "hard"}))
        for a, b in zip(plain.results, hard.results):
            assert all(np.array_equal(a[m], b[m], equal_nan=True) for m in ("object", "share", "volume", "length", "pierced", "fraction", "streamlines"))
        rows = [r for r in hard.results if r["object"] and r[extent] > 0]
        assert rows and all(r["dose"] == r[extent] and r["mean_weight"] == r["max_weight"] == 1 for r in rows)
        for r in rows:
            assert r["above"] == (r["streamlines"] if extent == "length" else r[extent]) or math.isnan(r["above"])


def test_a_pathway_weighs_its_values():
    labels, affine = voxels(reach=40)
    values = np.random.default_rng(3).uniform(0.2, 1, labels.shape).astype("f4")
    atlas = conus.load(labels, affine, pathways=[(nibabel.Nifti1Image(values, affine), 0.1)])
    row, = [r for r in atlas.select(TIP, direction=ALONG, weight="coil=20:9").results if r["object"] and r["sum_value"] > 0]
    inside = lambda r, z: (r <= 27) & (z >= 0) & (z <= 180)
    found = brute(np.ones_like(labels), affine, coil(20, 9), inside, 6)[1]
    assert row["dose"] == pytest.approx(found["dose"], rel=0.005)
    where = np.argwhere(labels >= 0)
    r, z = offsets_of(where @ affine[:3, :3].T + affine[:3, 3])
    mine = where[inside(r, z)]
    w = coil(20, 9)(*offsets_of(mine @ affine[:3, :3].T + affine[:3, 3])) * values[tuple(mine.T)]
    assert row["value_dose"] == pytest.approx(w.sum() * abs(np.linalg.det(affine[:3, :3])), rel=0.02)


@pytest.mark.parametrize("options, said", [
    ({"weight": "coil=20"}, "2 numbers are needed, d:w"), ({"weight": "coil=20:0"}, "coil: w 0 is out of range, allowed is 0.01 to 1000 mm"),
    ({"weight": "coil=nan:5"}, "coil: d nan is out of range"), ({"weight": "focus=10:2"}, "3 numbers are needed, f:l:a"),
    ({"weight": "focus=-1:2:3"}, "focus: f -1 is out of range"), ({"weight": "fibre=0.1:1.4"}, "NA 1.4 is out of range, allowed is less than n, 1.36"),
    ({"weight": "fibre=0.1:0.2:3"}, r"2 numbers are needed, r:NA\[:S:K:n\]"), ({"weight": "coil=1:2:3"}, "2 numbers"), ({"weight": "coil"}, "2 numbers"),
    ({"weight": "coil=20:18,above=0"}, "above: \"0\""), ({"weight": "coil=20:18,above=120%"}, "P up to 100"), ({"weight": "coil=20:18,above=5%areas"}, "above"),
    ({"weight": "coil=20:18,bias=1:1"}, "bias"), ({"weight": "coil=20:18", "layers": "visible"}, "needs layers"),
    ({"weight": "coil=20:18", "prior": "equal"}, "depends on the depth"), ({"weight": "coil=20:18", "score": "posterior"}, "depends on the depth"),
    ({"weight": "coil=20:18", "score": "weight"}, "depends on the depth"), ({"score": "dose", "layers": "all"}, "needs a weight"),
    ({"score": "dose", "weight": "gauss=1"}, "layers"), ({"weight": "coil=20:18", "sampling": "slices"}, "exact sampling"),
])
def test_wrong_words_are_refused(options, said):
    labels, affine = voxels()
    with pytest.raises(conus.ArgumentError, match=said):
        conus.load(labels, affine).selector(**options)


@pytest.mark.parametrize("text, error, said", [
    ("offset_mm\tdepth_mm\tweight\n0\t0\t1\n1\t0\t1\n0\t5\t1\n", conus.DataError, "lacks some offset_mm"),
    ("offset_mm\tdepth_mm\tweight\n0\t0\t1\n1\t0\t1\n0\t5\t1\n2\t5\t1\n", conus.DataError, "each combination is needed once"),
    ("offset_mm\tdepth_mm\tweight\n0\t0\t1\n1\t0\t1\n0\t5\t1\n0\t5\t1\n", conus.DataError, "there twice at depth_mm 5"),
    ("offset_mm\tdepth_mm\tweight\n0\t0\t1\n1\t0\t1\n", conus.ArgumentError, "one depth_mm, 0; at least two"),
    ("offset_mm\tdepth_mm\tweight\n0\t0\t1\n0\t1\t1\n", conus.DataError, "one offset_mm, at least two"),
    ("offset_mm\tdepth_mm\tweight\n0\t-1\t1\n1\t0\t1\n", conus.ArgumentError, "depth_mm: -1 is out of range"),
    ("distance_mm\tdepth_mm\tweight\n0\t1\t1\n1\t1\t1\n", conus.DataError, "no axis and no depth_mm"),
    ("offset_mm\tdepth_mm\tweight\n0\t0\t1\n1\tnan\t1\n", conus.DataError, "depth_mm: \"nan\" is not a finite number"),
    ("distance_mm\toffset_mm\tweight\n0\t1\t1\n1\t1\t1\n", conus.DataError, "are needed"),
    ("# unit: V/m\n# unit: MPa\noffset_mm\tweight\n0\t1\n1\t1\n", conus.DataError, "unit: it has more than 31 bytes, is no UTF-8, or differs"),
    ("# unit: 01234567890123456789012345678901\noffset_mm\tweight\n0\t1\n1\t1\n", conus.DataError, "unit"),
    ("# unit: \udcff\noffset_mm\tweight\n0\t1\n1\t1\n", conus.DataError, "unit"),
])
def test_wrong_tables_are_refused(tmp_path, text, error, said):
    labels, affine = voxels()
    (tmp_path / "field.tsv").write_bytes(text.encode(errors="surrogateescape"))
    with pytest.raises(error, match=said):
        conus.load(labels, affine).selector(weight=str(tmp_path / "field.tsv"))


def test_a_distance_needs_a_point_and_an_axis_none(tmp_path):
    labels, affine = voxels()
    (tmp_path / "w.tsv").write_text("distance_mm\tweight\n0\t1\n5\t1\n")
    atlas = conus.load(labels, affine)
    with pytest.raises(conus.ArgumentError, match="distance_mm is from a point"):
        atlas.select(TIP, direction=ALONG, weight=str(tmp_path / "w.tsv"))
    for text in ("coil=20:18", "gauss=2"):
        with pytest.raises(conus.ArgumentError, match="has an axis, which a point has not"):
            atlas.selector(weight=text).near(TIP, 5)
    with pytest.raises(conus.ArgumentError, match="has an axis, which a point has not"):
        atlas.selector(weight="gauss=2").near_many([TIP, TIP], 5)
    with pytest.raises(conus.ArgumentError, match="distance_mm is from a point"):
        atlas.selector(weight=str(tmp_path / "w.tsv")).select_many(origins=[TIP], directions=[ALONG])
    many, one = atlas.selector(weight=str(tmp_path / "w.tsv")).near_many([TIP]).to_dataframe(), atlas.selector(weight=str(tmp_path / "w.tsv")).near(TIP).to_dataframe()
    doses = ["dose", "dose_share", "mean_weight", "max_weight", "max_x", "max_y", "max_z", "above", "above_share", "value_dose"]
    pandas.testing.assert_frame_equal(many[doses], one[doses])


def test_a_weight_that_counts_nothing_is_refused():
    labels, affine = voxels(reach=40)
    atlas = conus.load(labels, affine)
    with pytest.raises(conus.ArgumentError, match="above has no effect without doses"):
        atlas.select(TIP, direction=ALONG, weight="gauss=2,above=50%")
    with pytest.raises(conus.ArgumentError, match="a point has no dose"):
        atlas.selector(weight="hard").near(TIP)
    assert atlas.selector(weight="hard,above=50%").near(TIP, 30).to_dataframe()["above"].notna().all()


@needs_aal
@pytest.mark.parametrize("command, weight, options, said", [
    ("query", "coil=20:18", ["--origin=0,0,90", "--direction=0,0,-1", "--layers=visible"], b"needs --layers all"),
    ("query", "coil=20:18", ["--focus=0,0,0", "--transducer=0,0,90", "--aperture-diameter=40"], b"begins at its focus"),
    ("calibrate", "coil=20:18", ["--poses=none.tsv"], b"needs one of directions"),
    ("calibrate", "ball.tsv", ["--poses=none.tsv"], b"needs one of directions"),
])
def test_a_command_that_has_no_such_weight_says_so(tmp_path, command, weight, options, said):
    (tmp_path / "ball.tsv").write_text("distance_mm\tweight\n0\t1\n5\t1\n")
    weight = tmp_path / weight if weight.endswith("tsv") else weight
    done = subprocess.run([os.environ["CONUS"], command, AAL, f"--weight={weight}", *options], capture_output=True, check=False)
    assert done.returncode == 2 and said in done.stderr


@needs_aal
@pytest.mark.parametrize("shape", [["--angle=20", "--range=0,200"], ["--angle=20"], ["--radius=9", "--aperture=square"], ["--angle=150", "--resolution=16"]])
def test_hard_is_the_volume(shape):
    asked = ["query", AAL, "--origin=-60,-150,40", "--toward=0,0,10", "--layers=all", "--format=tsv", "-q", *shape]
    plain, hard = (pandas.read_csv(io.BytesIO(call_conus(*asked, *more).stdout), sep="\t", dtype=str, keep_default_na=False)
                   for more in ([], ["--weight=hard"]))
    assert hard[plain.columns].equals(plain)
    for column in ("dose", "above"):
        assert hard[column][:-1].equals(plain["volume_mm3"][:-1])
    held = plain["volume_mm3"][:-1] != "0"
    assert set(hard["mean_weight"][:-1][held]) == set(hard["max_weight"][:-1][held]) == {"1"}


@needs_aal
def test_rows_are_the_same_for_all_threads_and_parts_and_verify(tmp_path):
    random, poses = np.random.default_rng(3), tmp_path / "poses.tsv"
    table = pandas.DataFrame(random.uniform(-30, 30, (12, 6)), columns=["x", "y", "z", "tx", "ty", "tz"])
    table["x"] -= 80
    table.to_csv(poses, sep="\t", index=False)
    for weight in ("coil=20:18", "focus=60:4:20,above=0.3"):
        asked = [AAL, f"--weight={weight}", "--score=dose_share", "-q"]
        rows = {n: call_conus("batch", *asked, "--poses", poses, f"--threads={n}", "--format=tsv").stdout for n in (1, 3)}
        assert rows[1] == rows[3] == call_conus("query", *asked, "--pose", poses, "--format=tsv").stdout
        call_conus("batch", *asked, "--poses", poses, "--shard=all/3", "-o", tmp_path / "rows.tsv", "--force")
        assert (tmp_path / "rows.tsv").read_bytes() == rows[1]
        assert call_conus("verify", tmp_path / "rows.tsv").returncode == 0
        frame = pandas.read_csv(io.BytesIO(rows[1]), sep="\t", na_values="n/a", keep_default_na=False)
        assert frame.groupby("query")["dose_share"].sum().to_numpy() == pytest.approx(1, abs=1e-7)
    text = call_conus("cite", tmp_path / "rows.tsv").stdout.decode().replace("\n", " ")
    assert "a focus 60 mm deep, which falls to half at a width of 4 mm and a length of 20 mm" in text and "(Eq. 33)" in text


@needs_aal
@pytest.mark.parametrize("weight, options, said", [
    ("fibre=0.1:0.39", [], b"the weight changes within 0.05 mm, and voxels are 1 mm long"), ("coil=20:18", [], b""),
    ("coil=20:18", ["--range=0,30"], b"at the far end of the range, 30 mm, the weight is 35 % of its largest"),
    ("coil=20:18", ["--radius=18"], b"at the rim of the cylinder the weight is 50 % of its largest"),
    ("hard", ["--layers=all"], b"the region has no far end, so doses have no share; --range NEAR,FAR ends it"),
    ("gauss=2", ["--angle=10"], b"--angle 10 is the default, and has no effect beside --weight"),
])
def test_notes(weight, options, said):
    done = call_conus("query", AAL, "--origin=-60,-85,60", "--toward=-25,-35,35", "--weight", weight, *options)
    assert not done.returncode and (said in done.stderr if said else b"the weight" not in done.stderr)
