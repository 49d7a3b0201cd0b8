# SPDX-License-Identifier: BSD-3-Clause
"""Soft cones: weights of first hits and what is meant, against closed forms, an oracle and samples. $CONUS is conus."""
import io
import math
import os
import subprocess

import numpy as np
import pandas
import pytest

import conus
from support import AAL, call_conus, needs_aal

CENTRE = (0.0, 0.0, 0.0)


def labelled(side_of):
    """A box of 60 mm whose near face is 40 mm from the origin along y; side_of(x, z) gives the label of voxels of 1 mm."""
    grid = np.arange(-29.5, 30)
    x, _, z = np.meshgrid(grid, grid[:4], grid, indexing="ij")
    affine = np.eye(4)
    affine[:3, 3] = grid[0], 40.5, grid[0]
    labels = side_of(x, z).astype("u1")
    return conus.load(labels, affine, labels={i: f"part {i}" for i in range(1, int(labels.max()) + 1)})


def ask(atlas, direction=(0, 1, 0), **options):
    frame = atlas.select(CENTRE, direction=direction, up=(0, 0, 1), **options).to_dataframe()
    return frame.set_index("name")


# The tilt is Rayleigh: in polar coordinates (angle off the axis, direction) it is a normal error of two axes.
def share_of_half(sigma, off):
    """The part of tilts that end beyond a plane through the apex, `off` degrees from the axis; within 4 sigma."""
    theta, phi = np.meshgrid((np.arange(800) + 0.5) / 200 * sigma, np.radians(np.arange(0.25, 360, 0.5)), indexing="ij")
    t, a = np.radians(theta), math.radians(off)
    beyond = np.sin(t) * np.cos(phi) * math.cos(a) > np.cos(t) * math.sin(a)
    density = theta * np.exp(-(theta**2) / 2 / sigma**2)
    return (density * beyond).sum() / density.sum()


@pytest.mark.parametrize("off", [0, 1, 2.5])
def test_half_of_space_is_the_integral_of_the_normal_error(off):
    atlas = labelled(lambda x, z: np.where(x > 0, 2, 1))
    turned = math.radians(off)
    rows = ask(atlas, (-math.sin(turned), math.cos(turned), 0), weight="gauss=2")
    assert rows.loc["part 2", "weight"] == pytest.approx(share_of_half(2, off), abs=0.002)
    assert rows.loc["part 2", "weight"] + rows.loc["part 1", "weight"] == pytest.approx(1, abs=1e-12)
    assert abs(rows.loc["part 2", "weight"] - share_of_half(2, off)) < 3 * rows.loc["part 2", "weight_error"]


def test_a_quarter_of_space_is_a_quarter():
    rows = ask(labelled(lambda x, z: 1 + (x > 0) + 2 * (z > 0)), weight="gauss=1.5")
    for i in range(1, 5):
        assert rows.loc[f"part {i}", "weight"] == pytest.approx(0.25, abs=1e-9)


def oracle(atlas, hits, opening, resolution, weight, radius=0.0, square=False):
    """Eq. 3, 4, 15, 30, 31 and 32 with the objects that pixels hit, and nothing else of conus."""
    objects = hits.image("object")[::-1].astype(int)  # row 0 at the bottom
    u = (2 * np.arange(resolution) + 1) / resolution - 1
    r = np.hypot(*np.meshgrid(u, u))
    half = math.radians(opening / 2)
    if radius:
        x, w = r * radius, np.ones_like(r)
    elif opening > 120:
        theta = r * half
        x, w = np.degrees(theta), np.sin(theta) / theta
    else:
        x, w = np.degrees(np.arctan(r * math.tan(half))), (1 + (r * math.tan(half)) ** 2) ** -1.5
    inside = np.ones_like(r, bool) if square else r <= 1
    soft = np.where(inside, w * weight(x), 0)
    found = {}
    for number in [0, *np.unique(objects[inside & (objects > 0)])]:
        hit = objects == number
        border = np.zeros_like(hit)
        for axis in (0, 1):
            both = np.logical_and(*(np.take(inside, k, axis) for k in (range(1, resolution), range(resolution - 1))))
            differ = np.diff(hit.astype(int), axis=axis).astype(bool) & both
            border |= np.insert(differ, 0, False, axis) | np.insert(differ, resolution - 1, False, axis)
        found[number] = (soft[hit].sum() / soft.sum(), math.sqrt((soft[border & inside] ** 2).sum() / 12) / soft.sum(),
                         (w * inside)[hit].sum() / (w * inside).sum())
    return found


def gauss(sigma):
    return lambda x: np.exp(-(x**2) / 2 / sigma**2) * np.radians(x + 1e-9) / np.sin(np.radians(x + 1e-9))


def posterior_of(found, solid_angle, prior, power=1.0, by_size=False):
    degree = math.radians(1) ** 2
    likely = {i: (prior.get(i, 1) * weight / (1 if by_size else share * solid_angle + degree)) ** power
              for i, (weight, _, share) in found.items() if i}
    return {i: value / sum(likely.values()) for i, value in likely.items()}


def random_areas(seed):
    points = np.random.default_rng(seed).uniform(-30, 30, (40, 2))
    return labelled(lambda x, z: 1 + ((x[..., None] - points[:, 0]) ** 2 + (z[..., None] - points[:, 1]) ** 2).argmin(-1))


@pytest.mark.parametrize("options, opening, weight", [
    ({"weight": "gauss=2"}, 16, gauss(2)),
    ({"weight": "gauss=2", "resolution": 33}, 16, gauss(2)),
    ({"weight": "gauss=4", "resolution": 16, "angle": 20}, 20, gauss(4)),
    ({"weight": "gauss=20", "resolution": 40}, 160, gauss(20)),
    ({"weight": "gauss=3", "aperture": "square", "angle": 30}, 30, gauss(3)),
    ({"weight": "gauss=2", "prior": "size"}, 16, gauss(2)),
    ({"weight": "gauss=2", "score": "posterior", "prior": "equal,power=2.5"}, 16, gauss(2)),
    ({"weight": "gauss=2", "layers": "all", "prior": "equal"}, 16, gauss(2)),
])
def test_numbers_are_those_of_the_oracle(options, opening, weight):
    for seed in (1, 2):
        atlas = random_areas(seed)
        hits = atlas.select(CENTRE, direction=(0.05, 1, 0.02), up=(0, 0, 1), **options)
        n, square = options.get("resolution", 64), options.get("aperture") == "square"
        found = oracle(atlas, hits, opening, n, weight, square=square)
        seen = {int(r["object"]): r for r in hits.results if r["pixels"]}
        assert set(seen) == {i for i in found if found[i][2]} and len(seen) > 3
        solid = 2 * math.pi * (1 - math.cos(math.radians(opening / 2)))
        prior = options.get("prior", "") + ","
        expected = posterior_of(found, solid, {}, 2.5 if "2.5" in prior else 1, prior.startswith("size")) if not square else {}
        for number, record in seen.items():
            assert record["weight"] == pytest.approx(found[number][0], abs=1e-6)
            assert record["weight_error"] == pytest.approx(found[number][1], abs=1e-6)
            if number and "prior" in options:
                assert record["posterior"] == pytest.approx(expected[number], abs=1e-6)
            else:
                assert math.isnan(record["posterior"])
        if options.get("score"):
            assert list(hits.results["score"][:-1]) == sorted(hits.results["posterior"][:-1], reverse=True)
        if "all" in options.get("layers", ""):
            hidden = [r for r in hits.results if not r["pixels"] and r["object"]]
            assert all(r["weight"] == 0 and math.isnan(r["posterior"]) for r in hidden)


def test_a_table_is_the_form_that_it_holds(tmp_path):
    atlas, path = random_areas(3), tmp_path / "bell.tsv"
    angles = np.linspace(0, 8, 801)
    rows = [f"{w:.12g};{a:.12g}" for a, w in zip(angles, gauss(2)(angles))]
    np.random.default_rng(1).shuffle(rows)  # in any order
    path.write_text("# unit: V/m\nweight;angle_deg\n" + "\n".join(rows) + "\n")
    by_table, by_form = ask(atlas, weight=str(path)), ask(atlas, weight="gauss=2")
    assert by_table["weight"].to_numpy() == pytest.approx(by_form["weight"].to_numpy(), abs=1e-5)
    # by offset, in a cylinder of the last row's radius: linear between rows, 0 behind the last one
    path.write_text("offset_mm\tweight\n0\t1\n6\t0.25\n")
    hits = atlas.select(CENTRE, direction=(0, 1, 0), up=(0, 0, 1), weight=str(path))
    found = oracle(atlas, hits, 0, 64, lambda x: 1 - 0.125 * x, radius=6)
    for record in hits.results:
        assert record["weight"] == pytest.approx(found[record["object"]][0], abs=1e-6)
        assert math.isnan(record["posterior"])


def test_a_bias_is_taken_off():
    atlas = random_areas(4)
    # The device points 9 degrees to its right (x) and 12 up of what is meant: the axis of the cone is 15 degrees off.
    turn = math.radians(15)
    meant = (-0.6 * math.sin(turn), math.cos(turn), -0.8 * math.sin(turn))
    biased = atlas.select(CENTRE, direction=(0, 1, 0), up=(0, 0, 1), weight="gauss=1.5,bias=9:12")
    plain = atlas.select(CENTRE, direction=meant, up=(0, 0, 1), weight="gauss=1.5")
    matching = {r["object"]: r["weight"] for r in plain.results}
    for record in biased.results:  # rolled differently about the axis, so pixels lie elsewhere
        if record["weight"] > 0.01:
            assert record["weight"] == pytest.approx(matching[record["object"]], abs=0.02)
    assert biased[0].name == plain[0].name != atlas.select(CENTRE, direction=(0, 1, 0), up=(0, 0, 1), weight="gauss=1.5")[0].name


def test_a_prior_of_a_file(tmp_path):
    atlas, path = random_areas(1), tmp_path / "prior.csv"
    plain = atlas.select(CENTRE, direction=(0, 1, 0), up=(0, 0, 1), weight="gauss=2", prior="equal")
    first, second = plain[0], plain[1]
    path.write_text(f"name,prior\n{second.name},3\n{first.name},0\n")
    found = ask(atlas, weight="gauss=2", prior=str(path))["posterior"]
    equal = {h.name: p for h, p in zip(plain, plain.results["posterior"])}
    assert found[first.name] == 0
    rest = 1 - equal[first.name] + 2 * equal[second.name]
    assert found[second.name] == pytest.approx(3 * equal[second.name] / rest, rel=1e-9)
    path.write_text(f"index prior\n{second.index} 3\n")
    found = ask(atlas, weight="gauss=2", prior=str(path))["posterior"]
    assert found[second.name] == pytest.approx(3 * equal[second.name] / (1 + 2 * equal[second.name]), rel=1e-9)


@pytest.mark.parametrize("text, said", [
    ("angle_deg\tweight\n0\t1\n1\tnan\n", "line 3: weight: \"nan\" is not a finite number"),
    ("angle_deg\tweight\n0\t1\n1\tn/a\n", "weight: \"n/a\" is not a finite number"),
    ("angle_deg\tweight\n0\t1\n1\t-1\n", "weight: -1 is out of range, allowed is 0"),
    ("angle_deg\tweight\n0\t1\n1\t\n", "line 3: 1 fields"),
    ("angle_deg\tweight\n0\t1\n", "1 rows"),
    ("", "0 rows"),
    ("angle_deg\tweight\n0\t1\n1\t1\n0\t2\n", "angle_deg 0 is there twice"),
    ("angle_deg\tradius_mm\tweight\n0\t1\t1\n", "radius_mm\" is unknown, allowed are angle_deg, offset_mm, distance_mm, depth_mm, weight$"),
    ("angle_deg\toffset_mm\tweight\n0\t0\t1\n1\t1\t1\n", "needed"),
    ("angle_deg\n0\n1\n", "needed"),
    ("weight\n0\n1\n", "needed"),
    ("angle_deg,weight\n0,1\n5,0,5\n", "line 3: 3 fields, the header has 2"), ("angle_deg\tweight\n0\t1\n1\t1e308\n", "1e\\+308 is out of range"),
    ("angle_deg\tangle_deg\tweight\n0\t1\t1\n", "twice"),
])
def test_wrong_tables_are_data_errors(tmp_path, text, said):
    path = tmp_path / "field.tsv"
    path.write_text(text)
    with pytest.raises(conus.DataError, match=said) as caught:
        random_areas(1).selector(weight=str(path))
    assert "field.tsv:" in str(caught.value)


@pytest.mark.parametrize("options, said", [
    ({"weight": "beam"}, "\"beam\" is unknown, allowed are hard, gauss, coil, focus, fibre, or a file"), ({"weight": "coils=20:18"}, "unknown"),
    ({"weight": "gauss"}, "one number"), ({"weight": "gauss=vr-controler"}, "width of the target"),
    ({"weight": "gauss=vr-controller"}, "width of the target"), ({"weight": "gauss=tms-cap"}, "error of places, too"),
    ({"weight": "gauss=seeg-robot"}, "error of places, too"), ({"weight": "gauss=dbs"}, r"in one; jitter\(error=\) and plan\(jitter=\) take it"), ({"weight": "gauss=0"}, "0.01 to 20"), ({"weight": "gauss=inf"}, "0.01 to 20"),
    ({"weight": "gauss=1,above=-2"}, "above"), ({"weight": "gauss=1,over=2"}, "allowed are bias, above"), ({"weight": "hard,bias=1:1"}, "bias"), ({"weight": ""}, "unknown"),
    ({"weight": "gauss=1,bias=1:2:3"}, "two numbers"), ({"weight": "gauss=1", "radius": 3}, "cylinder"), ({"prior": "size"}, "needs a weight"),
    ({"score": "posterior"}, "needs a weight"), ({"score": "doses", "weight": "gauss=1"}, "unknown"),
    ({"weight": "gauss=1", "prior": "often"}, "\"often\" is unknown"), ({"weight": "gauss=1", "prior": "size,power=0"}, "0.01"),
    ({"weight": "gauss=1", "prior": "size,power=2,power=3"}, "power is given twice"),
])
def test_wrong_words_are_refused(options, said):
    with pytest.raises(conus.ArgumentError, match=said):
        random_areas(1).selector(**options)


def test_coordinates_have_ranges(tmp_path):
    path = tmp_path / "field.tsv"
    for text, said in (("angle_deg\tweight\n-1\t1\n1\t1\n", "0 to less than 90"), ("angle_deg\tweight\n0\t1\n90\t1\n", "less than 90"),
                       ("offset_mm\tweight\n-1\t1\n1\t1\n", "0 or more")):
        path.write_text(text)
        with pytest.raises(conus.ArgumentError, match=said):
            random_areas(1).selector(weight=str(path))


@pytest.mark.parametrize("text, said", [
    ("name\tprior\nparts 1\t2\n", "part 1"), ("name\tprior\npart 1\t-2\n", "prior: -2 is out of range, allowed is 0 or more"), ("name\tprior\npart 1\t1\npart 1\t2\n", "twice"),
    ("index\tprior\n77\t1\n", "nothing has the number 77"), ("name\tweight\npart 1\t1\n", "unknown"), ("name\nx\n", "needed"),
    ("", "no rows"), ("name\tprior\n", "no rows"), ("name,prior\npart 1,2,5\n", "line 2: 3 fields, the header has 2"),
])
def test_wrong_priors_are_data_errors(tmp_path, text, said):
    path = tmp_path / "prior.tsv"
    path.write_text(text)
    with pytest.raises(conus.DataError, match=said):
        random_areas(1).selector(weight="gauss=2", prior=str(path))


def test_where_nothing_weighs_there_is_no_number(tmp_path):
    path = tmp_path / "zero.tsv"
    path.write_text("angle_deg\tweight\n0\t0\n5\t0\n")
    rows = ask(random_areas(1), weight=str(path), prior="equal")
    assert rows[["weight", "weight_error", "posterior"]].isna().all(axis=None) and rows["share"].sum() == pytest.approx(1)
    ball = random_areas(1).selector(weight="hard", prior="equal").near((0, 45, 0), 5).to_dataframe()
    assert ball[["weight", "weight_error", "posterior"]].isna().all(axis=None)


def test_tracks_and_plans_have_no_weight():
    selector = random_areas(1).selector(weight="gauss=2")
    with pytest.raises(conus.ArgumentError, match="a track has none"):
        selector.tracker()
    with pytest.raises(conus.ArgumentError, match="a plan has none"):
        selector.plan({"part 1": 1}, origins=[CENTRE], directions=[(0, 1, 0)], depth=50)


@needs_aal
@pytest.mark.parametrize("shape", [["--angle=20"], ["--angle=150"], ["--radius=10"], ["--angle=8", "--layers=all"]])
@pytest.mark.parametrize("pixels", [[], ["--resolution=16"], ["--resolution=33", "--aperture=square"]])
def test_hard_changes_no_byte(shape, pixels):
    asked = ["query", AAL, "--origin=-60,-150,40", "--toward=0,0,10", "--format=tsv", "-q", *shape, *pixels]
    plain, hard = (pandas.read_csv(io.BytesIO(call_conus(*asked, *more).stdout), sep="\t", dtype=str, keep_default_na=False)
                   for more in ([], ["--weight=hard"]))
    doses = ["dose", "dose_share", "mean_weight", "max_weight", "max_x", "max_y", "max_z", "above", "above_share", "value_dose"]
    doses = doses if "--layers=all" in shape else []
    assert list(hard.columns) == [*plain.columns[:-1], "weight", "weight_error", *doses, plain.columns[-1]]
    assert hard[plain.columns].equals(plain) and hard["weight"].equals(plain["share"])


@pytest.mark.parametrize("words, said", [
    (["--weight=beam"], '--weight: "beam" is unknown, allowed are hard, gauss, coil, focus, fibre, or a file'),
    (["--weight=gauss=30"], "--weight: gauss: 30 is out of range, allowed is 0.01 to 20 degrees"),
    (["--weight=gauss=2", "--radius=4"], "--weight: an angle needs a cone, and --radius makes a cylinder"),
    (["--prior=size"], "--prior has no effect without --weight"),
    (["--score=posterior"], "--score: posterior needs --weight"),
])
def test_the_program_says_what_is_wrong(words, said):
    done = subprocess.run([os.environ["CONUS"], "query", "nowhere.nii.gz", "--origin=0,0,0", "--toward=0,0,1", *words],
                          capture_output=True, text=True, check=False)
    assert done.returncode == 2 and said in done.stderr


@needs_aal
def test_notes_and_methods(tmp_path):
    asked = ["query", AAL, "--origin=-60,-150,40", "--toward=0,0,10", "--weight=gauss=2,bias=1:-0.5", "--score=posterior"]
    done = call_conus(*asked, "--angle=4", "--resolution=2", "-o", tmp_path / "rows.tsv")
    assert b"its standard deviation is 1 pixels" in done.stderr and b"at the rim of the cone the weight is 61 %" in done.stderr
    text = call_conus("cite", tmp_path / "rows.tsv").stdout.decode().replace("\n", " ")
    assert "a standard deviation of 2° about each of two axes" in text and "1° to its right and -0.5° up" in text
    assert "if each object is meant as often (Eq. 32)" in text


@needs_aal
def test_a_published_error_is_its_tilt_and_cited(tmp_path):
    """The standard deviations of arXiv:2601.03522 for targets 4 degrees wide, along and across, in the root mean square."""
    sigma = math.hypot(0.2130 + 0.1102 * 4, 0.2311 + 0.0715 * 4) / math.sqrt(2)
    asked = ["query", AAL, "--origin=-60,-150,40", "--toward=0,0,10", "-q", "--angle=6"]
    named = call_conus(*asked, "--weight=gauss=vr-controller:4", "-o", tmp_path / "named.tsv")
    call_conus(*asked, f"--weight=gauss={sigma!r}", "-o", tmp_path / "number.tsv")
    assert not named.returncode and (tmp_path / "named.tsv").read_bytes() == (tmp_path / "number.tsv").read_bytes()
    text = call_conus("cite", tmp_path / "named.tsv").stdout.decode().replace("\n", " ")
    assert "This error is a published one (endpoint of a ray" in text and "vr-controller: arXiv:2601.03522" in text


@needs_aal
@pytest.mark.parametrize("table, options, said", [
    ("angle_deg,weight\n0,2\n5,1\n", [], b"the cone the weight is 50 % of its largest, and beyond nothing counts; its table ends at 5 degrees"),
    ("angle_deg,weight\n0,2\n5,1\n", ["--angle=4"], b"of the cone the weight is 80 % of its largest"),
    ("offset_mm,weight\n0,1\n4,2\n8,1\n", ["--radius=6"], b"of the cylinder the weight is 75 % of its largest, and beyond nothing counts; its table ends at 8 mm"),
    ("angle_deg,weight\n0,2\n5,0.08\n", [], b""),
    ("offset_mm,weight\n0,1\n8,0\n", ["--angle=10"], b"--angle 10 is the default, and has no effect beside --weight"),
    ("angle_deg,weight\n5,0\n6,1\n", ["--angle=8"], b"warning: the weight is 0 everywhere in a cone of 8 degrees: no"),
    ("offset_mm,weight\n5,0\n6,1\n", ["--radius=4"], b"warning: the weight is 0 everywhere in a cylinder of 4 mm: no"),
    ("angle_deg,weight\n5,0\n6,1\n", ["--angle=8", "--aperture=square"], b""),  # the corners are at 5.65 degrees
    ("offset_mm,weight\n5,0\n6,1\n", ["--radius=4", "--aperture=square"], b""),  # and 5.66 mm
])
def test_a_rim_and_a_weight_of_nothing_are_said(tmp_path, table, options, said):
    (tmp_path / "field.csv").write_text(table)
    done = call_conus("query", AAL, "--origin=-60,-150,40", "--toward=0,0,10", "--weight", tmp_path / "field.csv", *options)
    assert not done.returncode and (said in done.stderr if said else b"the weight is" not in done.stderr)


@needs_aal
def test_weights_are_the_chances_of_the_axis_under_that_error():
    """`sweep --resolution 1 --angle 0.001 --jitter sigma,0` says the same by samples. Of an object that no sample hits,
    the probability is below 3/N (Eq. 14), so its error is taken as 1/N."""
    atlas, random = conus.load(AAL), np.random.default_rng(7)
    one, compared, beyond, count = atlas.selector(resolution=1), 0, 0, 16384
    for _ in range(50):
        away = random.normal(size=3)
        origin = np.array([0, -20, 10]) + 200 * away / np.linalg.norm(away)
        toward, sigma = random.uniform(-40, 40, 3), float(random.choice([1, 2, 4]))
        rows = atlas.select(origin, toward=toward, weight=f"gauss={sigma:g}").to_dataframe()
        chances = one.jitter(origin, toward=toward, angle=0.001, degrees=sigma, samples=count).to_dataframe().set_index("name")
        for row in rows[rows["pixels"] > 0].itertuples():
            chance = chances.loc[row.name] if row.name in chances.index else {"p_hit": 0, "p_hit_error": 0}
            compared += 1
            beyond += abs(row.weight - chance["p_hit"]) > 3 * (max(chance["p_hit_error"], 1 / count) + row.weight_error)
    assert compared > 200 and beyond <= compared / 100


@needs_aal
def test_rows_do_not_depend_on_threads_and_are_those_of_query(tmp_path):
    random, poses = np.random.default_rng(3), tmp_path / "poses.tsv"
    table = pandas.DataFrame(random.uniform(-30, 30, (60, 6)), columns=["x", "y", "z", "tx", "ty", "tz"])
    table["x"] -= 150
    table.to_csv(poses, sep="\t", index=False)
    asked = [AAL, "--weight=gauss=2,bias=1:0.5", "--prior=equal,power=2", "--score=posterior", "-q"]
    rows = {n: call_conus("batch", *asked, "--poses", poses, f"--threads={n}", "--format=tsv").stdout for n in (1, 2, 7)}
    assert rows[1] == rows[2] == rows[7]
    assert call_conus("query", *asked, "--pose", poses, "--format=tsv").stdout == rows[1]
    call_conus("batch", *asked, "--poses", poses, "--shard=all/3", "-o", tmp_path / "rows.tsv")
    assert (tmp_path / "rows.tsv").read_bytes() == rows[1]
    assert call_conus("verify", tmp_path / "rows.tsv").returncode == 0
    frame = pandas.read_csv(io.BytesIO(rows[1]), sep="\t", na_values="n/a", keep_default_na=False)
    sums = frame.groupby("query")["posterior"].sum(min_count=1).dropna()  # what hits nothing has none
    assert len(sums) > 50 and sums.to_numpy() == pytest.approx(1)
    assert frame.groupby("query")["weight"].sum().to_numpy() == pytest.approx(1)
