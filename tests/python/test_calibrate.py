# SPDX-License-Identifier: BSD-3-Clause
"""Calibration (Eq. 34) by scipy, from trials that this file makes itself."""
import math
import os
import subprocess

import nibabel
import numpy as np
import pandas
import pytest

import conus
from support import call_conus

scipy_stats = pytest.importorskip("scipy.stats")
scipy_optimize = pytest.importorskip("scipy.optimize")

BIAS, SIGMA = (0.6, -0.5), 1.7


def make_trials(seed, count, sigma=(SIGMA, SIGMA), bias=BIAS):
    """Trials in all directions whose axis points by known errors to the right and up of the aim; and these errors."""
    rng = np.random.default_rng(seed)
    rows, errors = [], rng.normal(bias, sigma, (count, 2))
    for error in errors:
        at = rng.normal(0, 90, 3)
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        up = np.cross(axis, rng.normal(size=3))
        up /= np.linalg.norm(up)
        right = np.cross(axis, up)
        angle, (a, b) = math.radians(np.hypot(*error)), error / np.hypot(*error)
        aim = at + rng.uniform(50, 400) * (math.cos(angle) * axis - math.sin(angle) * (a * right + b * up))
        rows.append([*at, *axis, *up, *aim])
    columns = [*"xyz", "dx", "dy", "dz", "ux", "uy", "uz", "aim_x", "aim_y", "aim_z"]
    return pandas.DataFrame(rows, columns=columns), errors


def wanted_of(errors):
    """Eq. 34: value, low, high and p of each parameter."""
    n = len(errors)
    mean, centred = errors.mean(0), errors - errors.mean(0)
    sigma = math.sqrt((centred**2).sum() / (2 * (n - 1)))
    half = scipy_stats.t.ppf(0.975, 2 * (n - 1)) * sigma / math.sqrt(n)
    spread = centred.T @ centred / n
    kurtosis = (np.einsum("ni,ij,nj->n", centred, np.linalg.inv(spread), centred) ** 2).mean()
    ratio = -n * math.log(np.linalg.det(spread) / (np.trace(spread) / 2) ** 2)

    def deviation(squares, free):
        low, high = (math.sqrt(squares / scipy_stats.chi2.ppf(part, free)) for part in (0.975, 0.025))
        return [math.sqrt(squares / free), low, high, math.nan]

    return {"bias_x": [mean[0], mean[0] - half, mean[0] + half, math.nan],
            "bias_y": [mean[1], mean[1] - half, mean[1] + half, math.nan],
            "sigma": deviation((centred**2).sum(), 2 * (n - 1)),
            "sigma_x": deviation((centred[:, 0] ** 2).sum(), n - 1),
            "sigma_y": deviation((centred[:, 1] ** 2).sum(), n - 1),
            "kurtosis": [kurtosis, math.nan, math.nan, 2 * scipy_stats.norm.sf(abs(kurtosis - 8) * math.sqrt(n) / 8)],
            "isotropy": [ratio, math.nan, math.nan, scipy_stats.chi2.sf(ratio, 2)]}


@pytest.mark.parametrize("seed, count, sigma", [(1, 5, (1, 1)), (2, 6, (0.2, 3)), (3, 23, (1.7, 1.7)), (4, 400, (2, 0.3)), (5, 3000, (1, 1))])
def test_parameters_are_those_of_scipy(seed, count, sigma):
    trials, errors = make_trials(seed, count, sigma)
    rows = conus.run("calibrate --poses {trials} -q", trials=trials)
    assert list(rows.columns) == ["parameter", "value", "low", "high", "p", "n"]
    assert (rows["n"] == count).all()
    wanted = wanted_of(errors)
    assert list(rows["parameter"]) == list(wanted)
    np.testing.assert_allclose(rows[["value", "low", "high", "p"]].to_numpy(float), list(wanted.values()), rtol=1e-7, atol=1e-9)


def test_trials_in_other_spaces_and_units_are_the_same(tmp_path):
    trials, _ = make_trials(7, 40)
    plain = conus.calibrate(trials)
    flipped = trials.copy()
    for name in trials.columns:
        flipped[name] *= -1 if name[-1] in "xy" else 1
    pandas.testing.assert_frame_equal(conus.calibrate(flipped, space="lps"), plain, rtol=1e-7)
    lengths = ["x", "y", "z", "aim_x", "aim_y", "aim_z"]
    inches = trials.copy()
    inches[lengths] /= 10
    inches.to_csv(tmp_path / "cm.tsv", sep="\t", index=False)
    pandas.testing.assert_frame_equal(conus.calibrate(str(tmp_path / "cm.tsv") + ",unit=cm"), plain, rtol=1e-7)
    named = inches.rename(columns={name: f"{name} (cm)" for name in lengths})
    pandas.testing.assert_frame_equal(conus.calibrate(named), plain, rtol=1e-7)


def test_people_get_the_weight_to_copy(tmp_path):
    trials, _ = make_trials(8, 100, (1.7, 1.7))
    trials.to_csv(tmp_path / "trials.tsv", sep="\t", index=False)
    text = call_conus("calibrate", "--poses", tmp_path / "trials.tsv").stdout.decode()
    value = conus.calibrate(trials).set_index("parameter")["value"]
    weight = f"gauss={value['sigma']:.4g},bias={value['bias_x']:.4g}:{value['bias_y']:.4g}"
    assert f"to copy: --weight {weight}\n" in text
    assert "hardly" not in text
    for sigma, bias in [((23, 23), (0, 0)), ((0.001, 0.001), (0, 0)), ((1, 1), (50, 0))]:  # which --weight refuses
        make_trials(9, 100, sigma, bias)[0].to_csv(tmp_path / "odd.tsv", sep="\t", index=False)
        text = call_conus("calibrate", "--poses", tmp_path / "odd.tsv").stdout.decode()
        assert "to copy" not in text and "no --weight has such errors" in text
    flat, _ = make_trials(10, 100, (3, 0.5))
    flat.to_csv(tmp_path / "flat.tsv", sep="\t", index=False)
    text = call_conus("calibrate", "--poses", tmp_path / "flat.tsv").stdout.decode()
    assert "the errors are hardly alike in all directions" in text and "hardly normal" not in text


def areas_of(seed):
    """40 cells of a plate before y = 40, as an image."""
    grid = np.arange(-29.5, 30)
    x, _, z = np.meshgrid(grid, grid[:4], grid, indexing="ij")
    points = np.random.default_rng(seed).uniform(-30, 30, (40, 2))
    labels = 1 + ((x[..., None] - points[:, 0]) ** 2 + (z[..., None] - points[:, 1]) ** 2).argmin(-1)
    affine = np.eye(4)
    affine[:3, 3] = grid[0], 40.5, grid[0]
    return nibabel.Nifti1Image(labels.astype("u1"), affine)


def wanted_reliability(chances, meant):
    """Eq. 34 of a list of {area: posterior} and what was meant."""
    said = np.array([max(c.values(), default=0) for c in chances])
    right = np.array([bool(c) and max(c, key=c.get) == m for c, m in zip(chances, meant)])

    def loss(power):
        of = [c.get(m, 0) ** power / sum(v**power for v in c.values()) if c else 0 for c, m in zip(chances, meant)]
        return -np.log(np.maximum(of, 1e-4)).mean()

    rows = []
    for low, high in [(0, 1.1), (0, 0.2), (0.2, 0.4), (0.4, 0.6), (0.6, 0.8), (0.8, 1.1)]:
        of = (said >= low) & (said < high)
        n = int(of.sum())
        row = [n, said[of].mean(), right[of].mean()] if n else [0, math.nan, math.nan]
        limits = scipy_stats.binomtest(int(right[of].sum()), n).proportion_ci(0.95, "wilson") if n else (math.nan, math.nan)
        rows.append([*row, *limits])
    best = min(np.exp(np.linspace(math.log(0.25), math.log(8), 2001)), key=loss)
    return np.array(rows), loss(1), best


@pytest.mark.parametrize("prior, power", [(None, 1.0), ("size", 1.0), ("equal,power=2", 2.0)])
def test_reliability_is_that_of_the_answers_to_each_trial(tmp_path, prior, power):
    image = areas_of(3)
    image.to_filename(tmp_path / "cells.nii")
    rng = np.random.default_rng(11)
    count = 120
    aims = np.stack([rng.uniform(-28, 28, count), np.full(count, 41.0), rng.uniform(-28, 28, count)], 1)
    aims[:3] = [80, 40, 80]  # hit nothing
    trials = pandas.DataFrame(np.hstack([np.zeros((count, 3)), aims]), columns=[*"xyz", "tx", "ty", "tz"])
    data = np.asarray(image.dataobj)
    near = np.clip(np.round(aims + rng.normal(0, 1.5, (count, 3)) + 29.5).astype(int), 0, 59)
    trials["meant"] = data[near[:, 0], 0, near[:, 2]]
    trials.to_csv(tmp_path / "meant.tsv", sep="\t", index=False)
    options = ["--weight", "gauss=2", *(["--prior", prior] if prior else [])]
    rows = conus.calibrate(trials, image, weight="gauss=2", resolution=64, **({"prior": prior} if prior else {}))
    asked = conus.run("query {atlas} --pose {poses} -q " + " ".join([*options, "--score", "posterior"]),
                      atlas=str(tmp_path / "cells.nii"), poses=trials.drop(columns="meant"))
    asked = asked[asked["posterior"] > 0]
    chances = [dict(zip(of["index"].astype(int), of["posterior"])) for of in (asked[asked["query"] == str(i + 1)] for i in range(count))]
    wanted, loss, best = wanted_reliability(chances, trials["meant"])
    assert list(rows["kind"]) == ["all"] + 5 * ["bin"]
    assert list(rows["low"]) == pytest.approx([0, 0, 0.2, 0.4, 0.6, 0.8]) and list(rows["high"]) == pytest.approx([1, 0.2, 0.4, 0.6, 0.8, 1])
    np.testing.assert_allclose(rows[["n", "said", "right", "right_low", "right_high"]].to_numpy(float), wanted, rtol=1e-7, atol=1e-9)
    assert rows.loc[0, "log_loss"] == pytest.approx(loss, rel=1e-7)
    assert math.log(rows.loc[0, "power"]) == pytest.approx(math.log(best * power), abs=4e-3)
    assert rows.loc[1:, ["log_loss", "power"]].isna().all(axis=None)


HEAD = "x\ty\tz\tdx\tdy\tdz\taim_x\taim_y\taim_z\tmeant\n"
GOOD = "".join(f"0\t0\t0\t0\t1\t0\t{x}\t100\t{z}\t1\n" for x, z in [(1, 0), (0, 1), (-1, 0), (0, -2), (3, 1), (2, 2)])


def refused(tmp_path, text, *options, atlas=False):
    (tmp_path / "trials.tsv").write_text(text)
    if atlas:
        areas_of(3).to_filename(tmp_path / "cells.nii")
    done = subprocess.run([os.environ["CONUS"], "calibrate", *(["cells.nii"] if atlas else []), "--poses", "trials.tsv", *options],
                          capture_output=True, check=False, cwd=tmp_path)
    return done.returncode, done.stderr.decode()


@pytest.mark.parametrize("text, options, atlas, code, message", [
    (HEAD + "".join(GOOD.splitlines(True)[:4]), (), False, 3, "trials.tsv: 4 trials, at least 5 are needed"),
    (HEAD, (), False, 3, "0 trials, at least 5 are needed"),
    (HEAD + 6 * "0\t0\t0\t0\t1\t0\t1\t100\t2\t1\n", (), False, 3, "all 6 trials are off alike"),
    (HEAD + GOOD + "0\t0\t0\t0\t1\t0\t1\t-100\t2\t1\n", (), False, 3, "trial 7: the device points 90 degrees or more away"),
    (HEAD + GOOD + "0\t0\t0\t0\t1\t0\t0\t0\t0\t1\n", (), False, 3, "trial 7: the device is where it was aimed at"),
    (HEAD + GOOD + "0\t0\t0\t0\t1\t0\tn/a\tn/a\tn/a\t1\n", (), False, 3, "trial 7: no point that was aimed at"),
    (HEAD + GOOD + "0\t0\t0\t0\t1\t0\tone\t2\t3\t1\n", (), False, 3, "trials.tsv:8: column aim_x: \"one\""),
    (HEAD + GOOD + "0\t0\t0\t0\t0\t0\t1\t2\t3\t1\n", (), False, 3, "trials.tsv:8: "),
    (HEAD.replace("\taim_z", "\tother") + GOOD, (), False, 3, "only some of the columns aim_x aim_y aim_z"),
    (HEAD.replace("aim_", "goal_") + GOOD, (), False, 3, "no point that was aimed at"),
    (HEAD.replace("x\ty\tz\t", "x (cm)\ty (cm)\tz (cm)\t", 1).replace("aim_x", "aim_x (mm)") + GOOD, (), False, 3, "two units"),
    ("x\ty\tz\taim_x\taim_y\taim_z\n" + 6 * "0\t0\t0\t1\t2\t3\n", (), False, 3, "without the direction"),
    (HEAD + GOOD, ("--weight", "gauss=2"), False, 2, "--weight has no effect without ATLAS"),
    (HEAD + GOOD, ("--resolution", "32"), False, 2, "--resolution has no effect without ATLAS"),
    (HEAD + GOOD, ("--space", "ccf"), False, 2, "read in ras or lps"),
    (HEAD + GOOD, (), True, 2, "ATLAS needs --weight"),
    (HEAD + GOOD, ("--weight", "gauss=2", "--radius", "3"), True, 2, "--radius"),
    (HEAD.replace("meant", "mint") + GOOD, ("--weight", "gauss=2"), True, 3, "no column is called \"meant\""),
    (HEAD + GOOD.replace("\t1\n", "\t77\n"), ("--weight", "gauss=2"), True, 3, "trials.tsv:2: "),
    (HEAD + GOOD.replace("\t1\n", "\t\n"), ("--weight", "gauss=2"), True, 3, "trials.tsv:2: "),
    (HEAD + GOOD, ("--weight", "table.tsv"), True, 3, "table.tsv"),
    *[(HEAD + GOOD, ("--weight", weight), True, 2, "--weight: conus calibrate needs one of directions")
      for weight in ("offsets.tsv", "depths.tsv", "coil=20:18", "focus=50:4:10", "fibre=0.1:0.39")],
])
def test_bad_trials_are_refused(tmp_path, text, options, atlas, code, message):
    (tmp_path / "table.tsv").write_text("offset_mm\tweight\n0\t1\n")
    (tmp_path / "offsets.tsv").write_text("offset_mm\tweight\n0\t1\n5\t0.5\n")
    (tmp_path / "depths.tsv").write_text("angle_deg\tdepth_mm\tweight\n0\t0\t1\n5\t0\t1\n0\t9\t1\n5\t9\t1\n")
    found, said = refused(tmp_path, text, *options, atlas=atlas)
    assert message in said
    assert found == code, said


def test_few_trials_get_a_note_and_results_are_verified(tmp_path):
    (tmp_path / "trials.tsv").write_text(HEAD + GOOD)
    done = call_conus("calibrate", "--poses", tmp_path / "trials.tsv", "-o", tmp_path / "out.tsv")
    assert b"6 trials are few" in done.stderr
    assert b"identical" in call_conus("verify", tmp_path / "out.tsv").stdout
    said = " ".join(call_conus("cite", tmp_path / "out.tsv").stdout.decode().split())
    assert "was determined from 6 trials" in said
    areas_of(3).to_filename(tmp_path / "cells.nii")
    call_conus("calibrate", tmp_path / "cells.nii", "--poses", tmp_path / "trials.tsv", "--weight", "gauss=2", "-o", tmp_path / "of.csv")
    assert b"identical" in call_conus("verify", tmp_path / "of.csv").stdout
    said = " ".join(call_conus("cite", tmp_path / "of.csv").stdout.decode().split())
    assert "From 6 trials it was determined how often the area" in said and "cells" in said
