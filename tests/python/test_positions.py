# SPDX-License-Identifier: BSD-3-Clause
"""Positions of caps (Eq. 35): the table by its published file, poses by vectors of this file."""
import csv
import os
import pathlib
import subprocess

import numpy as np
import pytest

import conus
from support import AAL, call_conus, needs_aal, run_conus

PUBLISHED = pathlib.Path(os.environ.get("CONUS_SHARED_DATA") or pathlib.Path(__file__).parents[3] / "shared/data") / "published/positions.tsv"


def vectors(rows, letter):
    return rows[[f"{letter}x", f"{letter}y", f"{letter}z"]].to_numpy(float)


def wanted_handle(name, outward, degrees):
    """The handle by Eq. 35: backwards, turned to its side (Rodrigues' formula), clockwise to the left if seen from outside."""
    is_up = abs(outward[1]) > np.cos(np.radians(15))
    back = np.array([0.0, 0, 1] if is_up else [0.0, -1, 0])
    back = back - (back @ outward) * outward
    back /= np.linalg.norm(back)
    turn = degrees if name[-1] in "02468" else -degrees  # to the right, seen from outside counterclockwise
    turn = np.radians(-turn if is_up and outward[1] < 0 else turn)
    k = np.array([[0, -outward[2], outward[1]], [outward[2], 0, -outward[0]], [-outward[1], outward[0], 0]])
    return back + np.sin(turn) * k @ back + (1 - np.cos(turn)) * k @ k @ back


@pytest.mark.parametrize("degrees, out", [(0, 0), (45, 10), (-90, -3)])
def test_devices_stand_as_the_equation_says(degrees, out):
    plain, turned = conus.positions(), conus.positions(handle=degrees, out=out)
    assert list(plain.columns) == ["query_id", *"xyz", "dx", "dy", "dz", "ux", "uy", "uz", "error_deg", "error_mm", "space"]
    assert (plain["space"] == "MNI152").all()
    assert len(plain) == 79 and plain["dx"].isna().sum() == 18
    has = plain["dx"].notna()
    assert (turned["x"].notna() == (has | (out == 0))).all()
    along, up = vectors(turned[has], "d"), vectors(turned[has], "u")
    np.testing.assert_allclose(along, vectors(plain[has], "d"), atol=1e-8)
    np.testing.assert_allclose(vectors(turned[has], ""), vectors(plain[has], "") - out * along, atol=1e-6)
    wanted = [wanted_handle(name, -d, degrees) for name, d in zip(turned["query_id"][has], along)]
    np.testing.assert_allclose(-up, wanted, atol=1e-8)
    assert (plain["error_deg"][has] == 3.8).all() and (plain["error_mm"][has] == 5.708).all()


def test_a_coil_at_c3_points_backwards_and_to_the_left():
    c3, c4 = (-vectors(conus.positions(name, handle=45), "u")[0] for name in ("C3", "c4"))
    assert c3[0] < -0.3 and c3[1] < -0.5
    assert c4[0] > 0.3 and c4[1] < -0.5
    assert (-vectors(conus.positions("Oz", "Fpz", handle=0), "u")[:, 2] > 0.9).all()
    back, front = -vectors(conus.positions("Oz", "Fpz", handle=90), "u")
    assert back[0] < -0.9 and front[0] < -0.9


def test_handles_at_the_sides_point_down():
    """Where a normal points down a little, as at T7 and P7, too: outwards of an ear is down, not up."""
    names = ["F7", "FT7", "T7", "TP7", "P7", "PO7", "F8", "FT8", "T8", "TP8", "P8", "PO8"]
    assert (-vectors(conus.positions(*names, handle=45), "u")[:, 2] < -0.6).all()
    assert (-vectors(conus.positions(*names, handle=-45), "u")[:, 2] > 0.6).all()


def test_older_names_and_mistakes():
    assert list(conus.positions("T3", "t6")["query_id"]) == ["T7", "P8"]
    for words, message in [(["C33"], "did you mean C3?"), (["Hippocampus_L"], "is no position"), ([""], "empty"),
                           (["C3", "--handle", "361"], "361"), (["C3", "--out", "1e4"], "--out")]:
        done = subprocess.run([os.environ["CONUS"], "positions", *words], capture_output=True, check=False)
        assert done.returncode == 2 and message in done.stderr.decode(), words


RADIUS = 90


@pytest.fixture(name="ball", scope="module")
def make_ball(tmp_path_factory):
    """--scalp of a ball about the origin, whose landmarks are on its equator."""
    path, rings, around = tmp_path_factory.mktemp("ball") / "ball.off", 90, 180
    theta, phi = np.meshgrid(np.pi * np.arange(1, rings) / rings, 2 * np.pi * np.arange(around) / around, indexing="ij")
    points = RADIUS * np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], -1).reshape(-1, 3)
    points = np.vstack([[[0, 0, RADIUS], [0, 0, -RADIUS]], points])
    faces = []
    for k in range(around):
        rows = 2 + np.arange(rings - 1) * around
        a, b = rows + k, rows + (k + 1) % around
        faces += [(0, a[0], b[0]), (1, b[-1], a[-1])]
        faces += [f for i in range(rings - 2) for f in ((a[i], a[i + 1], b[i + 1]), (a[i], b[i + 1], b[i]))]
    with path.open("w", encoding="utf-8") as file:
        file.write(f"OFF\n{len(points)} {len(faces)} 0\n")
        np.savetxt(file, points, "%.6f")
        np.savetxt(file, np.hstack([np.full((len(faces), 1), 3), faces]), "%d")
    return f"{path},nasion=0:{RADIUS}:0,inion=0:-{RADIUS}:0,lpa=-{RADIUS}:0:0,rpa={RADIUS}:0:0"


def wanted_way(start, other, mm):
    """On a ball the shortest line, where a tape lies, is on the circle about its middle."""
    across = np.cross(start, other)
    side = np.cross(across / np.linalg.norm(across), start)
    return np.cos(mm / RADIUS) * start + np.sin(mm / RADIUS) * side


@pytest.mark.parametrize("start, other, mm", [("C3", "F3", 50), ("C3", "F3", 5), ("C3", "P3", 70), ("c4", "f4", 50), ("C3", "C4", 120),
                                              ("Fz", "Pz", 110), ("T3", "O1", 40), ("Fp2", "F4", 33.3), ("Cz", "C3", 20), ("C1", "Cz", 60),
                                              ("LPA", "F3", 30)])
def test_a_way_is_where_a_tape_lies(ball, start, other, mm):
    at = vectors(conus.positions(start, other, f"{start}>{other}:{mm}", scalp=ball), "")
    np.testing.assert_allclose(at[2], wanted_way(*at[:2], mm), atol=0.3)  # facets of 3 mm: n is up to 0.5 degrees off
    along = vectors(conus.positions(f"{start} > {other} : {mm}", scalp=ball), "d")[0]
    np.testing.assert_allclose(along, -at[2] / RADIUS, atol=0.03)


def test_ways_that_are_none(ball):
    for way, message in [("C3>C3:5", "two positions"), ("T7>T8:50", "two ways around"), ("C3>F3:0", "above 0"),
                         ("C3>F3:-5", "above 0"), ("C3>F3:500", "half of the section"), ("C3>F3", "C3>F3:50"), ("C3>F3:5 cm", "C3>F3:50"),
                         ("C3>Foo:5", "C3>F3:50"), ("C3>F9:5", "below the ring"), ("C33>F3:5", "is no position"), ("C3>F3:nan", "above 0")]:
        done = subprocess.run([os.environ["CONUS"], "positions", way, "--scalp", ball], capture_output=True, check=False)
        assert done.returncode == 2 and message in done.stderr.decode(), (way, done.stderr)
    done = subprocess.run([os.environ["CONUS"], "positions", "C3>F3:50"], capture_output=True, check=False)
    assert done.returncode == 2 and b"--scalp" in done.stderr


@needs_aal
def test_a_way_is_a_place(ball, tmp_path):
    options = ["--inward", "--scalp", ball, "--angle", "10"]
    call_conus("query", f"{AAL},template=none", "--origin", "C3>F3:50", *options, "-o", tmp_path / "q.tsv")
    at = ",".join(str(x) for x in vectors(conus.positions("C3>F3:50", scalp=ball), "")[0])
    along = ",".join(str(x) for x in vectors(conus.positions("C3>F3:50", scalp=ball), "d")[0])
    plain = run_conus("query", AAL, "--origin", at, "--direction", along, "--angle", "10", "--format", "tsv", "-q")
    assert (tmp_path / "q.tsv").read_text().count("\n") == len(plain) + 1
    assert b"identical" in call_conus("verify", tmp_path / "q.tsv").stdout
    assert "50 mm from it towards F3" in " ".join(call_conus("cite", tmp_path / "q.tsv").stdout.decode().split())


@needs_aal
@pytest.mark.parametrize("error, aim, says", [("tms-navigated", "C3", True), ("tms-cap", "C3", False), ("tms-navigated", "-80,-10,60", False)])
def test_a_navigated_coil_is_not_found_by_a_cap(error, aim, says):
    said = call_conus("sweep", AAL, f"--origin={aim}", "--inward", "--jitter", error, "--samples", 16).stderr.decode()
    assert ("a place that a cap finds, as C3, is off by tms-cap" in said) == says, said


@pytest.mark.skipif(not PUBLISHED.exists(), reason="the published positions are not here")
def test_positions_are_the_published_ones():
    with PUBLISHED.open(encoding="utf-8") as file:
        rows = [row for row in csv.DictReader((line for line in file if not line.startswith("#")), delimiter="\t")]
    wanted = {row["name"]: [float(row[a]) for a in ("x", "y", "z")] for row in rows if row.get("set", "ui-10-10") == "ui-10-10"}
    found = conus.positions()
    assert wanted
    for name, at in zip(found["query_id"], vectors(found, "")):
        if name in wanted:
            np.testing.assert_allclose(at, wanted[name], atol=0.06, err_msg=name)


@needs_aal
def test_the_table_is_read_as_the_position_itself(tmp_path):
    call_conus("positions", "C3", "Fz", "--handle", "30", "--out", "4", "-o", tmp_path / "cap.tsv")
    rows = run_conus("query", AAL, "--pose", tmp_path / "cap.tsv", "--angle", "10", "--format", "tsv", "-q")
    options = ["--inward", "--handle", "30", "--out", "4", "--angle", "10", "--format", "tsv"]
    one = call_conus("query", AAL, "--origin", "C3", *options)
    assert b"a round cone does not see" in one.stderr
    alone = run_conus("query", AAL, "--origin", "C3", *options, "-q")
    of = rows[rows["query"] == "C3"]
    assert list(of["name"]) == list(alone["name"])
    np.testing.assert_allclose(of["share"], alone["share"], atol=1e-6)
    assert b"does not see" not in call_conus("query", AAL, "--origin", "C3", *options, "--weight", "gauss=2,bias=1:0").stderr
    assert b"identical" in call_conus("verify", tmp_path / "cap.tsv").stdout
    assert "Jurcak" in call_conus("cite", tmp_path / "cap.tsv").stdout.decode()


@needs_aal
def test_a_handle_needs_a_position():
    for words in (["--origin", "-60,0,60", "--inward", "--handle", "3"], ["--origin", "C3", "--toward", "0,0,0", "--handle", "3"],
                  ["--origin", "C3", "--inward", "--handle", "3", "--up", "0,0,1"], ["--origin", "C3", "--toward", "0,0,0", "--out", "3"],
                  ["--pose", "cap.tsv", "--inward", "--out", "3"], ["--pose", "cap.tsv", "--inward", "--handle", "3"]):
        done = subprocess.run([os.environ["CONUS"], "query", AAL, *words], capture_output=True, check=False)
        assert done.returncode == 2, (words, done.stderr)
