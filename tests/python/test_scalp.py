# SPDX-License-Identifier: BSD-3-Clause
"""Positions on a scalp (Eq. 35): an ellipsoid, whose sections are ellipses, by this file's own arcs."""
import json
import os
import subprocess

import nibabel
import numpy as np
import pytest

import conus
from support import AAL, call_conus, needs_aal

CURVES = [
    ("Nz Cz Iz", 10, "Fpz AFz Fz FCz - CPz Pz POz Oz"), ("LPA Cz RPA", 10, "T7 C5 C3 C1 - C2 C4 C6 T8"),
    ("Fpz T7 Oz", 10, "Fp1 AF7 F7 FT7 - TP7 P7 PO7 O1"), ("Fpz T8 Oz", 10, "Fp2 AF8 F8 FT8 - TP8 P8 PO8 O2"),
    ("F7 Fz F8", 8, "F5 F3 F1 - F2 F4 F6"), ("FT7 FCz FT8", 8, "FC5 FC3 FC1 - FC2 FC4 FC6"),
    ("TP7 CPz TP8", 8, "CP5 CP3 CP1 - CP2 CP4 CP6"), ("P7 Pz P8", 8, "P5 P3 P1 - P2 P4 P6"),
    ("AF7 AFz AF8", 4, "AF3 - AF4"), ("PO7 POz PO8", 4, "PO3 - PO4"),
]


def ellipsoid(axes, centre, n=160):
    """Vertices and triangles: a grid of latitudes and longitudes, closed at the poles."""
    theta, phi = np.linspace(0, np.pi, n)[1:-1], np.linspace(0, 2 * np.pi, 2 * n, endpoint=False)
    t, p = np.meshgrid(theta, phi, indexing="ij")
    points = np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], -1).reshape(-1, 3)
    points = np.vstack([points, [0, 0, 1], [0, 0, -1]])
    at = np.arange(len(theta) * len(phi)).reshape(len(theta), len(phi))
    right = np.roll(at, -1, 1)
    quads = np.stack([at[:-1], at[1:], right[1:], at[:-1], right[1:], right[:-1]], -1).reshape(-1, 3)
    top, bottom = np.full(len(phi), len(points) - 2), np.full(len(phi), len(points) - 1)
    caps = np.vstack([np.stack([top, at[0], right[0]], 1), np.stack([bottom, right[-1], at[-1]], 1)])
    return points * axes + centre, np.vstack([quads, caps])


def write(path, points, triangles):
    arrays = [nibabel.gifti.GiftiDataArray(points.astype("f4"), "NIFTI_INTENT_POINTSET"),
              nibabel.gifti.GiftiDataArray(triangles.astype("i4"), "NIFTI_INTENT_TRIANGLE")]
    nibabel.gifti.GiftiImage(darrays=arrays).to_filename(path)


class Ellipsoid:
    """A unit ball that is scaled: a plane cuts the ball in a circle, which becomes an ellipse."""

    def __init__(self, axes, centre):
        self.axes, self.centre = np.array(axes, float), np.array(centre, float)

    def on(self, direction):
        return direction / np.linalg.norm(direction) * self.axes + self.centre

    def nearest(self, point):
        """By Newton's rule for t of x_i = a_i^2 y_i / (a_i^2 + t)."""
        y, t = point - self.centre, 0.0
        for _ in range(60):
            x = self.axes**2 * y / (self.axes**2 + t)
            t += ((x / self.axes) ** 2).sum() / 2 / (x**2 / self.axes**2 / (self.axes**2 + t)).sum() - 0.5 / (
                x**2 / self.axes**2 / (self.axes**2 + t)).sum()
        return self.axes**2 * y / (self.axes**2 + t) + self.centre

    def arc(self, a, m, b):
        """Points of the section from a over m to b, and how far along it they are."""
        p = [(q - self.centre) / self.axes for q in (a, m, b)]
        normal = np.cross(p[1] - p[0], p[2] - p[0])
        normal /= np.linalg.norm(normal)
        middle = (p[0] @ normal) * normal
        u = p[0] - middle
        radius = np.linalg.norm(u)
        u /= radius
        v = np.cross(normal, u)
        over, to = (np.arctan2((q - middle) @ v, (q - middle) @ u) % (2 * np.pi) for q in p[1:])
        angles = np.linspace(0, to if over < to else to - 2 * np.pi, 20001)[:, None]
        points = (middle + radius * (np.cos(angles) * u + np.sin(angles) * v)) * self.axes + self.centre
        return points, np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])

    def part(self, a, m, b, part):
        points, along = self.arc(a, m, b)
        return np.array([np.interp(part * along[-1], along, points[:, k]) for k in range(3)])

    def positions(self, landmarks):
        found = dict(landmarks)
        up = np.cross(found["RPA"] - found["LPA"], found["Nz"] - found["Iz"])
        start = (sum(landmarks.values()) / 4 - self.centre) / self.axes
        ray = up / self.axes
        b, c = start @ ray / (ray @ ray), (start @ start - 1) / (ray @ ray)
        cz = (start + (-b + np.sqrt(b * b - c)) * ray) * self.axes + self.centre
        for _ in range(200):
            cz = self.nearest((self.part(found["Nz"], cz, found["Iz"], 0.5) + self.part(found["LPA"], cz, found["RPA"], 0.5)) / 2)
        found["Cz"] = cz
        for through, parts, names in CURVES:
            a, m, b = (found[name] for name in through.split())
            for k, name in enumerate(names.split()):
                if name != "-":
                    found[name] = self.part(a, m, b, (k + 1) / parts)
        return found

    def normal(self, point):
        n = (point - self.centre) / self.axes**2
        return n / np.linalg.norm(n)


def option(path, landmarks):
    keys = zip(("nasion", "inion", "lpa", "rpa"), ("Nz", "Iz", "LPA", "RPA"))
    return f"{path}," + ",".join(f"{key}=" + ":".join(f"{v:.9g}" for v in landmarks[name]) for key, name in keys)


HEADS = {
    "ball": ((90, 90, 90), (0, 0, 0), [(0, 1, -0.3), (0, -1, -0.2), (-1, 0, -0.3), (1, 0, -0.3)]),
    "head": ((78, 98, 92), (2, -14, 8), [(0.02, 1, -0.35), (0, -1, -0.3), (-1, -0.05, -0.4), (1, 0.02, -0.36)]),
}


def make(head):
    axes, centre, directions = HEADS[head]
    shape = Ellipsoid(axes, centre)
    return shape, dict(zip(("Nz", "Iz", "LPA", "RPA"), (shape.on(np.array(d, float)) for d in directions)))


@pytest.mark.parametrize("head", HEADS)
def test_positions_are_those_of_closed_forms(tmp_path, head):
    shape, landmarks = make(head)
    write(tmp_path / "scalp.surf.gii", *ellipsoid(shape.axes, shape.centre))
    rows = conus.run("positions --scalp {scalp} -q", scalp=option(tmp_path / "scalp.surf.gii", landmarks))
    wanted = shape.positions(landmarks)
    assert sorted(rows["query_id"]) == sorted(wanted) and len(wanted) == 65
    for row in rows.itertuples():
        assert np.linalg.norm(np.array([row.x, row.y, row.z]) - wanted[row.query_id]) < 0.5, row.query_id
        if row.query_id in landmarks:
            assert np.isnan(row.dx)
        else:
            off = np.degrees(np.arccos(min(1, -shape.normal(wanted[row.query_id]) @ [row.dx, row.dy, row.dz])))
            assert off < 2, row.query_id
    assert rows["error_deg"].isna().all() and rows["error_mm"].isna().all()
    assert (rows["space"] == "individual").all()


def test_a_query_takes_the_position_of_the_scalp(tmp_path):
    shape, landmarks = make("head")
    write(tmp_path / "scalp.surf.gii", *ellipsoid(shape.axes, shape.centre))
    labels = np.zeros((40, 40, 40), "u1")
    labels[10:30, 10:30, 10:30] = 1
    nibabel.Nifti1Image(labels, np.array([[5, 0, 0, -98], [0, 5, 0, -114], [0, 0, 5, -92], [0, 0, 0, 1.0]])).to_filename(tmp_path / "own.nii")
    scalp = option(tmp_path / "scalp.surf.gii", landmarks)
    call_conus("positions", "C3", "--scalp", scalp, "--out", "5", "-o", tmp_path / "c3.tsv")
    aim = ["--angle", "20", "--format", "tsv"]
    by_file = call_conus("query", tmp_path / "own.nii", "--pose", tmp_path / "c3.tsv", *aim).stdout.decode().split("\n")
    call_conus("query", tmp_path / "own.nii", "--origin", "C3", "--inward", "--scalp", scalp, "--out", "5", *aim, "-o", tmp_path / "answer.tsv")
    direct = (tmp_path / "answer.tsv").read_text().split("\n")
    assert len(direct) > 2 and direct[1].split("\t")[5:7] == by_file[1].split("\t")[5:7]
    done = subprocess.run([os.environ["CONUS"], "query", f"{tmp_path / 'own.nii'},template=mni152", "--pose", tmp_path / "c3.tsv", *aim],
                          capture_output=True, check=False)
    assert done.returncode == 3 and b'positions are in "individual"' in done.stderr, done.stderr
    for words in (["--origin", "0,90,20"], ["--pose", tmp_path / "c3.tsv"]):  # which a scalp does not move
        done = subprocess.run([os.environ["CONUS"], "query", tmp_path / "own.nii", *words, "--inward", "--scalp", scalp],
                              capture_output=True, check=False)
        assert done.returncode == 2 and b"--scalp" in done.stderr, done.stderr
    for result in ("c3.tsv", "answer.tsv"):
        assert "on a scalp by sections" in " ".join(call_conus("cite", tmp_path / result).stdout.decode().split())
    assert json.loads((tmp_path / "answer.json").read_text())["Places"][0]["head"] == "own"
    for result in ("c3.tsv", "answer.tsv"):
        assert b"identical" in call_conus("verify", tmp_path / result).stdout


def test_a_batch_takes_positions_of_the_scalp(tmp_path):
    shape, landmarks = make("head")
    write(tmp_path / "scalp.surf.gii", *ellipsoid(shape.axes, shape.centre))
    labels = np.zeros((40, 40, 40), "u1")
    labels[10:30, 10:30, 10:30] = 1 + np.arange(20)[:, None, None] // 5
    nibabel.Nifti1Image(labels, np.array([[5, 0, 0, -98], [0, 5, 0, -114], [0, 0, 5, -92], [0, 0, 0, 1.0]])).to_filename(tmp_path / "own.nii")
    scalp, names = option(tmp_path / "scalp.surf.gii", landmarks), ("C3", "F4", "Pz")
    (tmp_path / "caps.txt").write_text("".join(name + "\n" for name in names))
    aim = ["--inward", "--scalp", scalp, "--angle", "20", "-q"]
    call_conus("batch", tmp_path / "own.nii", "--poses", tmp_path / "caps.txt", *aim, "-o", tmp_path / "batch.tsv")
    rows = [line.split("\t", 1) for line in (tmp_path / "batch.tsv").read_text().split("\n")[1:] if line]
    for name in names:
        answer = call_conus("query", tmp_path / "own.nii", "--origin", name, *aim, "--format", "tsv").stdout.decode()
        wanted = [line.split("\t", 1)[1] for line in answer.split("\n")[1:] if line]
        assert [row for row in rows if row[0] == name] == [[name, line] for line in wanted], name
    assert "on a scalp by sections" in " ".join(call_conus("cite", tmp_path / "batch.tsv").stdout.decode().split())
    assert b"identical" in call_conus("verify", tmp_path / "batch.tsv").stdout
    assert "scalp.surf.gii" in " ".join(str(file) for file in json.loads((tmp_path / "batch.json").read_text())["Inputs"])
    call_conus("batch", tmp_path / "own.nii", "--poses", tmp_path / "caps.txt", *aim, "--shard", "all/2", "-o", tmp_path / "parts.tsv")
    assert (tmp_path / "parts.tsv").read_text() == (tmp_path / "batch.tsv").read_text()
    moved = option(tmp_path / "scalp.surf.gii", {**landmarks, "Nz": landmarks["Nz"] + [2, 0, 0]})  # parts of other landmarks are other
    aims = (aim, ["--inward", "--scalp", moved, "--angle", "20", "-q"])
    codes = [subprocess.run([os.environ["CONUS"], "batch", tmp_path / "own.nii", "--poses", tmp_path / "caps.txt", *words, "--shard", part,
                             "-o", tmp_path / "two.tsv"], capture_output=True, check=False).returncode
             for words, part in zip(aims, ("1/2", "all/2"))]
    assert codes == [0, 3], codes
    done = subprocess.run([os.environ["CONUS"], "batch", tmp_path / "own.nii", "--poses", tmp_path / "caps.txt", "--scalp", scalp],
                          capture_output=True, check=False)
    assert done.returncode == 2 and b"--scalp has no effect without --inward" in done.stderr, done.stderr
    (tmp_path / "xyz.csv").write_text("x,y,z\n-60,-15,60\n60,-15,60\n")  # which a scalp does not move
    done = subprocess.run([os.environ["CONUS"], "batch", tmp_path / "own.nii", "--poses", tmp_path / "xyz.csv", *aim],
                          capture_output=True, check=False)
    assert done.returncode == 3 and b"these are positions: take --scalp out" in done.stderr, done.stderr
    (tmp_path / "target.txt").write_text("x y z\n0 -14 8\n")
    needles = ["--toward", tmp_path / "target.txt", "--depth", "target", "--reach", "3", "--scalp", scalp, "-q", "--format", "tsv"]
    plan = call_conus("plan", tmp_path / "own.nii", "--from", tmp_path / "caps.txt", *needles).stdout.decode().split("\n")
    call_conus("plan", tmp_path / "own.nii", "--from", tmp_path / "caps.txt", *needles[:-2], "-o", tmp_path / "plan.tsv")
    said = " ".join(call_conus("cite", tmp_path / "plan.tsv").stdout.decode().split())
    assert f"--scalp {scalp} " in said and "were found on the scalp of its --scalp" in said
    at = call_conus("positions", *names, "--scalp", scalp, "--format", "tsv").stdout.decode().split("\n")
    entries = {line.split("\t")[0]: line.split("\t")[6:9] for line in plan[1:] if line}
    assert entries == {line.split("\t")[0]: line.split("\t")[1:4] for line in at[1:] if line}
    done = subprocess.run([os.environ["CONUS"], "plan", tmp_path / "own.nii", "--from", tmp_path / "scalp.surf.gii", *needles],
                          capture_output=True, check=False)
    assert done.returncode == 2 and b"--scalp has no effect" in done.stderr, done.stderr
    write(tmp_path / "scalp.surf.gii", *ellipsoid(shape.axes * 1.02, shape.centre))
    assert subprocess.run([os.environ["CONUS"], "verify", tmp_path / "batch.tsv"], capture_output=True, check=False).returncode


def test_landmarks_come_from_a_coordsystem(tmp_path):
    shape, landmarks = make("head")
    write(tmp_path / "scalp.surf.gii", *ellipsoid(shape.axes, shape.centre))
    path = tmp_path / "sub-01_coordsystem.json"
    whole = option(tmp_path / "scalp.surf.gii", landmarks)
    inion = "inion=" + ":".join(f"{v:.9g}" for v in landmarks["Iz"])
    short = f"{tmp_path / 'scalp.surf.gii'},landmarks={path}"

    def state(scale, **keys):
        points = {ours: list(landmarks[name] / scale) for ours, name in (("NAS", "Nz"), ("LPA", "LPA"), ("RPA", "RPA"))}
        path.write_text(json.dumps({"EEGCoordinateSystem": "ScanRAS", "EEGCoordinateUnits": {1: "mm", 10: "cm", 1000: "m"}[scale],
                                    "AnatomicalLandmarkCoordinates": points, **keys}))

    def ask(scalp):
        done = subprocess.run([os.environ["CONUS"], "positions", "C3", "F4", "--scalp", scalp, "--format", "tsv", "-q"],
                              capture_output=True, check=False)
        return done.returncode, done.stdout.decode(), done.stderr.decode()

    wanted = ask(whole)
    assert wanted[0] == 0
    for scale in (1, 10, 1000):
        state(scale)
        code, out, said = ask(short + "," + inion)
        found, true = (np.array([line.split("\t")[1:10] for line in text.split("\n")[1:3]], float) for text in (out, wanted[1]))
        assert code == 0 and np.allclose(found, true, atol=1e-5), said
    code, _, said = ask(short)
    assert code == 2 and f"inion is missing in {path}" in said, said
    state(1, AnatomicalLandmarkCoordinates={"nasion": list(landmarks["Nz"]), "Inion": list(landmarks["Iz"]), "LPA": list(landmarks["LPA"]),
                                            "RPA": list(landmarks["RPA"])})
    assert ask(short)[:2] == wanted[:2]
    for keys, message in (({"EEGCoordinateSystem": "CTF"}, '"CTF" is not the world of an image'),
                          ({"AnatomicalLandmarkCoordinateSystem": "CapTrak"}, '"CapTrak" is not the world of an image'),
                          ({"AnatomicalLandmarkCoordinateSystem": "ALS"}, 'in "ALS"'), ({"EEGCoordinateSystem": "ScanLPS"}, 'in "ScanLPS"'),
                          ({"EEGCoordinateSystem": "tkRAS"}, 'in "tkRAS"'), ({"EEGCoordinateSystem": "D99"}, 'in "D99"'),
                          ({"AnatomicalLandmarkCoordinates": {"NAS": [1, 2, 3], "Nz": [1, 2, 4]}}, "another name of the same landmark"),
                          ({"EEGCoordinateUnits": "n/a"}, "allowed are mm, cm and m"), ({"AnatomicalLandmarkCoordinates": []}, "no Anatomical"),
                          ({"AnatomicalLandmarkCoordinates": {"NAS": [1, 2]}}, "NAS: three numbers are needed")):
        state(1, **keys)
        code, _, said = ask(short + "," + inion)
        assert code == 3 and message in said, said
    path.unlink()
    assert ask(short + "," + inion)[0] == 3
    code, _, said = ask(f"{tmp_path / 'scalp.surf.gii'},landmarks=")
    assert code == 2 and 'landmarks: found "", a file is needed' in said, said


def test_other_axes_of_landmarks_are_refused(tmp_path):
    """Axes to the front, left and up of a ball, which is the same in all: turned a little, the signs alone are right."""
    shape, landmarks = make("ball")
    write(tmp_path / "scalp.surf.gii", *ellipsoid(shape.axes, shape.centre))
    angle = np.radians(3)
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    als = {name: turn @ [at[1], -at[0], at[2]] for name, at in landmarks.items()}
    assert als["LPA"][0] < als["RPA"][0] and als["Iz"][1] < als["Nz"][1]
    done = subprocess.run([os.environ["CONUS"], "positions", "C3", "--scalp", option(tmp_path / "scalp.surf.gii", als)],
                          capture_output=True, check=False)
    assert done.returncode == 3 and b"do not lie along y" in done.stderr, done.stderr


def test_other_scalps_are_refused(tmp_path):
    shape, landmarks = make("head")
    points, triangles = ellipsoid(shape.axes, shape.centre)
    write(tmp_path / "scalp.surf.gii", points, triangles)
    write(tmp_path / "open.surf.gii", points, triangles[5:])
    write(tmp_path / "metres.surf.gii", points / 1000, triangles)
    write(tmp_path / "cm.surf.gii", points / 10, triangles)
    good = option("scalp.surf.gii", landmarks)
    far = option("scalp.surf.gii", {**landmarks, "Nz": landmarks["Nz"] + [0, 25, 0]})
    exchanged = option("scalp.surf.gii", {**landmarks, "LPA": landmarks["RPA"], "RPA": landmarks["LPA"]})
    turned = option("scalp.surf.gii", {**landmarks, "Nz": landmarks["Iz"], "Iz": landmarks["Nz"]})
    for words, code, message in [
        (["--scalp", far], 3, "mm from the surface, allowed are 20"), (["--scalp", exchanged], 3, "lpa"), (["--scalp", turned], 3, "inion"),
        (["--scalp", option("metres.surf.gii", {name: at / 1000 for name, at in landmarks.items()})], 3, "are they in mm?"),
        (["--scalp", option("cm.surf.gii", {name: at / 10 for name, at in landmarks.items()})], 3, "mm apart, allowed are 50 to 400"),
        (["--scalp", option("open.surf.gii", landmarks)], 3, "not closed"), (["F9", "--scalp", good], 2, "below the ring of 10 %"),
        (["--scalp", "scalp.surf.gii"], 2, "nasion is missing"), (["--scalp", good.split(",rpa")[0]], 2, "rpa is missing"),
        (["--scalp", good + ":4"], 2, "X:Y:Z"), (["--scalp", good.replace("lpa=", "ear=")], 2, "ear"),
        (["--scalp", good.replace("scalp.", "none.")], 3, "none.surf.gii"), (["--scalp", good.replace("nasion=", "nasion=x")], 2, "nasion"),
    ]:
        done = subprocess.run([os.environ["CONUS"], "positions", *words], capture_output=True, check=False, cwd=tmp_path)
        assert done.returncode == code and message in done.stderr.decode(), (words, done.returncode, done.stderr)
    for part, warned in ((0.99, False), (0.85, True)):  # 0.8 and 12 mm under an ear of about 80 mm
        inside = option("scalp.surf.gii", {**landmarks, "LPA": part * landmarks["LPA"]})
        done = subprocess.run([os.environ["CONUS"], "positions", "C3", "-q", "--scalp", inside], capture_output=True, check=True, cwd=tmp_path)
        assert (b"warning: --scalp: LPA lies" in done.stderr) == warned, done.stderr


MNI = {"Cz": (0.0, -8.2, 97.3), "C3": (-67.7, -11.3, 61.2), "C4": (68.4, -11.2, 62.0), "Fz": (0.4, 59.6, 64.4), "Pz": (-0.4, -84.6, 79.3),
       "Oz": (0.0, -118.5, 8.2)}  # the published ones (SimNIBS, EEG10-10_UI_Jurak_2007.csv)


@needs_aal
@pytest.mark.parametrize("moved", [(0, 0, 0), (0, 25, -25), (5, -30, 28)])
def test_a_scalp_is_the_head_of_the_atlas(tmp_path, moved):
    """An ellipsoid about as large as the head of MNI 152: how far its positions lie from those is by closed forms."""
    shape = Ellipsoid((86, 112, 103), np.array([0, -18, 0]) + moved)
    landmarks = dict(zip(("Nz", "Iz", "LPA", "RPA"),
                         (shape.on(np.array(d, float)) for d in [(0, 1, -0.3), (0, -1, -0.3), (-1, 0, -0.4), (1, 0, -0.4)])))
    write(tmp_path / "scalp.surf.gii", *ellipsoid(shape.axes, shape.centre))
    found = shape.positions(landmarks)
    mm = np.sqrt(np.mean([((found[name] - at) ** 2).sum() for name, at in MNI.items()]))

    def ask(atlas, *more):
        scalp = option(tmp_path / "scalp.surf.gii", landmarks)
        done = subprocess.run([os.environ["CONUS"], "query", atlas, "--origin", "C3", "--inward", "--scalp", scalp, *more],
                              capture_output=True, check=False)
        return done.returncode, done.stderr.decode()

    code, said = ask(AAL)
    assert (code == 3) == (mm > 20) == any(moved), (mm, said)
    assert f"its positions lie {mm:.0f} mm from those of MNI 152 in the mean" in said and "Colin 27" in said
    assert ("',template=none' behind ATLAS says that it is of that head" in said) == (mm > 20)
    for atlas, more in ((f"{AAL},template=none", ()), (AAL, ("--any-space",))):
        code, said = ask(atlas, *more)
        assert code in (0, 1) and "--scalp" not in said, said
    labels = np.ones((20, 20, 20), "u1")
    nibabel.Nifti1Image(labels, np.array([[5, 0, 0, -50], [0, 5, 0, -70], [0, 0, 5, 0], [0, 0, 0, 1.0]])).to_filename(tmp_path / "own.nii")
    code, said = ask(tmp_path / "own.nii")
    assert code in (0, 1) and "nothing says whose head the atlas is of" in said, said
    code, said = ask(os.path.join(os.path.dirname(AAL), "inia19-NeuroMaps.nii.gz"))
    assert code == 3 and "The atlas is the macaque INIA19" in said, said
