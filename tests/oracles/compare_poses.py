#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The readers of poses against writers that share nothing with them, as a user would run them.

Random devices are written in every format, space and matrix convention of docs/formats.md, by the definitions of the
programs that those formats come from (SimNIBS's axes for Brainsight and Localite, Slicer's schema, BIDS, SimNIBS's
structures, InVesalius's angles, the tables of NIBS-BIDS, Lead-DBS's cells); conus query must give their poses back
within what the format's digits allow. scipy writes the files of MATLAB; without it they are left out.

usage: compare_poses.py CONUS; exit 77 = skipped."""

import importlib.util
import io
import json
import os
import subprocess
import sys
import tempfile

try:
    import numpy as np
except ImportError:
    print("skipped: no python3-numpy")
    sys.exit(77)

COUNT = 40
FLIP = np.diag([-1.0, -1.0, 1.0, 1.0])  # RAS to LPS and back


def random_devices(generator):
    """[COUNT] world_from_coil in RAS, in SimNIBS's axes: z into the head."""
    for _ in range(COUNT):
        q, r = np.linalg.qr(generator.normal(size=(3, 3)))
        q = q * np.sign(np.diag(r))
        if np.linalg.det(q) < 0:
            q[:, 0] = -q[:, 0]
        m = np.eye(4)
        m[:3, :3] = q
        m[:3, 3] = generator.uniform(-90, 90, 3)
        yield m


def brainsight(coils, space, digits):
    """simnibs/utils/nnav.py, class brainsight: x and z of the coil turned round; columns are m0n*, m1n*, m2n*."""
    names = ["Loc. X", "Loc. Y", "Loc. Z"] + [f"m{i}n{j}" for i in range(3) for j in range(3)]
    lines = [f"# Coordinate system: {space}", "# Units: millimetres, degrees", "\t".join(["# Target Name"] + names)]
    for i, coil in enumerate(coils):
        m = coil @ np.diag([-1.0, 1.0, -1.0, 1.0])
        if space == "World":
            m = FLIP @ m
        numbers = list(m[:3, 3]) + list(m[:3, :3].T.ravel())
        lines.append("\t".join([f"coil {i}"] + [f"{n:.{digits}f}" for n in numbers]))
    return "\n".join(lines) + "\n"


def localite(coils, space, triggers):
    """Likewise, class localite: its x is the coil's z, its y the coil's -y, its z the coil's x."""
    axes = np.array([[0, 0, 1, 0], [0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 0, 1.0]])
    kind = "TriggerMarker" if triggers else "InstrumentMarker"
    lines = ['<?xml version="1.0" encoding="UTF-8"?>', f'<{kind}List coordinateSpace="{space}">']
    for i, coil in enumerate(coils):
        m = coil @ axes
        if space == "LPS":
            m = FLIP @ m
        matrix = " ".join(f'data{r}{c}="{m[r, c]:+.17f}"' for r in range(4) for c in range(4))
        if triggers:
            lines.append(f'<{kind} description="coil {i}" recordingTime="{i}"><Matrix4D {matrix}/></{kind}>')
        else:
            lines.append(f'<{kind} index="{i}"><Marker description="coil {i}" set="true"><Matrix4D {matrix}/></Marker></{kind}>')
    return "\n".join(lines + [f"</{kind}List>"]) + "\n"


def markups(coils, space):
    """Lines from the coil's centre to 50 mm along its beam."""
    flip = FLIP if space == "LPS" else np.eye(4)
    lines = []
    for i, coil in enumerate(coils):
        ends = [flip @ coil @ [0, 0, depth, 1] for depth in (0, 50)]
        points = [{"label": f"{i}-{k}", "position": list(end[:3]), "positionStatus": "defined"} for k, end in enumerate(ends)]
        lines.append({"type": "Line", "name": f"coil {i}", "coordinateSystem": space, "controlPoints": points})
    return json.dumps({"@schema": "", "markups": lines})


def matrices(coils, space):
    """The coil's own matrix, row by row; it looks along +z."""
    flip = FLIP if space == "lps" else np.eye(4)
    lines = [",".join(["query_id"] + [f"m{r}{c}" for r in range(4) for c in range(4)])]
    lines += [",".join([f"coil {i}"] + [repr(n) for n in (flip @ coil).ravel()]) for i, coil in enumerate(coils)]
    return "\n".join(lines) + "\n"


def directions(coils, toward):
    """With the coil's y up, so that the whole frame is known: conus's y is the coil's, its z the coil's -z."""
    names = ["query_id", "x", "y", "z"] + (["tx", "ty", "tz"] if toward else ["dx", "dy", "dz"]) + ["ux", "uy", "uz"]
    lines = ["\t".join(names)]
    for i, coil in enumerate(coils):
        there = (coil @ [0, 0, 7, 1])[:3] if toward else 7 * coil[:3, 2]
        numbers = list(coil[:3, 3]) + list(there) + list(coil[:3, 1])
        lines.append("\t".join([f"coil {i}"] + [repr(float(n)) for n in numbers]))
    return "\n".join(lines) + "\n"


def electrodes(coils):
    """Pairs of contacts 3.5 mm apart along the beam, the second first."""
    lines = ["name\tx\ty\tz\tsize\tgroup"]
    for i, coil in enumerate(coils):
        for number in (2, 1):
            p = coil @ [0, 0, 3.5 * (number - 1), 1]
            lines.append(f"S{i}-{number}\t" + "\t".join(repr(float(n)) for n in p[:3]) + f"\t5\tS{i}")
    return "\n".join(lines) + "\n"


def simnibs_text(coils):
    return "\n".join("\n".join(" ".join(repr(float(n)) for n in row) for row in coil) + "\n" for coil in coils)


def simnibs_session(coils, packed):
    """As SimNIBS's sim_struct2mat() has it: a SESSION with a cell of two TMSLISTs, each with an array of POSITIONs."""
    import scipy.io
    fields = ["type", "name", "date", "istrig", "matORG", "orient", "matsimnibs", "didt", "fnamefem", "centre", "pos_ydir",
              "distance"]
    kind = np.dtype([(field, "O") for field in fields])
    rows = [np.array([("POSITION", f"coil {i}", "", False, "", "", coil.tolist(), 1e6, "", "", "", 4.0)], dtype=kind)
            for i, coil in enumerate(coils)]
    lists = [{"type": "TMSLIST", "fnamecoil": "coil.ccd", "pos": np.concatenate(part)} for part in (rows[:7], rows[7:])]
    file = io.BytesIO()
    scipy.io.savemat(file, {"type": "SESSION", "poslist": lists, "fiducials": {"Nz": []}}, do_compression=packed)
    return file.getvalue()


def invesalius(coils):
    """Its coil's z points out of the head: SimNIBS's x and z turned round. Angles by the formula of Tait and Bryan: the
    turn is Rz(gamma) Ry(beta) Rx(alpha)."""
    names = ["marker_id", "x", "y", "z", "alpha", "beta", "gamma", "label", "marker_type", "x_world", "y_world", "z_world",
             "alpha_world", "beta_world", "gamma_world"]
    lines = ["##INVESALIUS3_MARKER_FILE_4", "\t".join(f'"{name}"' for name in names)]
    for i, coil in enumerate(coils):
        m = coil @ np.diag([-1.0, 1.0, -1.0, 1.0])
        angles = np.degrees([np.arctan2(m[2, 1], m[2, 2]), np.arcsin(-m[2, 0]), np.arctan2(m[1, 0], m[0, 0])])
        world = "\t".join(repr(float(n)) for n in [*m[:3, 3], *angles])
        lines.append(f'{i}\t1.0\t2.0\t3.0\t4.0\t5.0\t6.0\t"coil {i}"\t3\t{world}')
    return "\n".join(lines) + "\n"


def nibs(coils, columns, values):
    """A table of NIBS-BIDS: @p values gives the numbers of each coil in threes."""
    header = ["nibs_position_id"] + [f"{column}_{k}" for column in columns for k in "xyz"]
    lines = ["\t".join(header)]
    for i, coil in enumerate(coils):
        lines.append("\t".join([f"coil {i}"] + [repr(float(n)) for vector in values(i, coil) for n in vector]))
    return "\n".join(lines) + "\n"


def nibs_tables(coils):
    def ahead(coil, depth):
        return (coil @ [0, 0, depth, 1])[:3]

    def towards(i, coil):
        return [ahead(coil, 0), ahead(coil, 60)]

    def beams(i, coil):
        return [ahead(coil, 0), 3 * coil[:3, 2], ahead(coil, -9)]

    def normals(i, coil):  # of both signs; the target is 5 mm beside the beam, and says which is right
        return [ahead(coil, 0), (-1) ** i * coil[:3, 2], ahead(coil, 40) + 5 * coil[:3, 0]]

    matrices = ["nibs_position_id\tposition_coil_transform"]
    matrices += [f"coil {i}\t{json.dumps(coil.tolist())}" for i, coil in enumerate(coils)]
    return [("coil_markers.tsv", nibs(coils, ["position_coil", "position"], towards), [], 1e-7, False),
            ("old_markers.tsv", nibs(coils, ["entry", "target"], towards), [], 1e-7, False),
            ("beam_markers.tsv", nibs(coils, ["position_transducer", "position_beam", "position"], beams), [], 1e-7, False),
            ("normal_markers.tsv", nibs(coils, ["coil", "normal", "target"], normals), [], 1e-7, False),
            ("matrix_markers.tsv", "\n".join(matrices) + "\n", ["--axis", "+z"], 1e-7, True)]


def reconstruction(coils):
    """Eight contacts each of a right and a left lead, in three spaces; [0] of them is the template's."""
    import scipy.io
    spaces = [[np.array([coil[:3, 3] for coil in coils[8 * k:8 * k + 8]]) + shift for k in (0, 1)] for shift in (0, 7, 30)]
    reco = {}
    for name, leads in zip(("mni", "scrf", "native"), spaces):
        cells = np.empty((1, 2), dtype=object)
        cells[0, 0], cells[0, 1] = leads
        reco[name] = {"coords_mm": cells, "trajectory": cells}
    file = io.BytesIO()
    scipy.io.savemat(file, {"reco": reco}, do_compression=True)
    return file.getvalue(), spaces


def compare_contacts(conus, coils):
    data, spaces = reconstruction(coils)
    worst = 0
    for options, leads in (([], spaces[0]), (["--poses-format", "lead-dbs-native"], spaces[1])):
        with open("ea_reconstruction.mat", "wb") as file:
            file.write(data)
        done = subprocess.run([conus, "query", "sphere.nii.gz", "--pose", "ea_reconstruction.mat", "--radius", "1",
                               "--any-space", "--quiet", "--format", "json"] + options, stdout=subprocess.PIPE, check=True)
        points = {query["query"]: query["point_ras"] for query in json.loads(done.stdout)["Queries"]}
        wanted = {f"{side}{i + 1}": point for side, lead in zip("RL", leads) for i, point in enumerate(lead)}
        worst = max(worst, np.abs(np.array([points[name] for name in wanted]) - list(wanted.values())).max())
        worst = worst if list(points) == list(wanted) else np.inf
    print(f"ea_reconstruction.mat: {len(wanted)} contacts in two spaces, largest difference {worst:.2g}, allowed 1e-07")
    return not worst <= 1e-7


def read(conus, atlas, text, name, options):
    """The poses that conus answers, in its own axes: [n] world_from_device in RAS."""
    with open(name, "wb") as file:
        file.write(text if isinstance(text, bytes) else text.encode())
    done = subprocess.run([conus, "query", atlas, "--pose", name, "--any-space", "--quiet", "--format", "json"] + options,
                          stdout=subprocess.PIPE, check=True)
    queries = json.loads(done.stdout)["Queries"]
    return [(query["query"], np.array(query["world_from_device_ras"])) for query in queries]


def main():
    conus = os.path.abspath(sys.argv[1])
    coils = list(random_devices(np.random.default_rng(5)))
    cases = [("nifti.txt", brainsight(coils, "NIfTI:Scanner", 4), [], 2e-4, True),
             ("three.txt", brainsight(coils, "NIfTI:Aligned", 3), [], 2e-3, True),
             ("world.txt", brainsight(coils, "World", 4), [], 2e-4, True),
             ("ras.xml", localite(coils, "RAS", False), [], 1e-7, False),
             ("lps.xml", localite(coils, "LPS", False), [], 1e-7, False),
             ("triggers.xml", localite(coils, "LPS", True), [], 1e-7, False),
             ("ras.mrk.json", markups(coils, "RAS"), [], 1e-7, False),
             ("lps.mrk.json", markups(coils, "LPS"), [], 1e-7, False),
             ("ras.csv", matrices(coils, "ras"), ["--axis", "+z"], 1e-7, True),
             ("lps.csv", matrices(coils, "lps"), ["--axis", "+z", "--space", "lps"], 1e-7, True),
             ("along.tsv", directions(coils, False), [], 1e-7, True),
             ("toward.tsv", directions(coils, True), [], 1e-7, True),
             ("markers.mkss", invesalius(coils), [], 1e-7, True),
             *nibs_tables(coils)]
    has_scipy = importlib.util.find_spec("scipy") is not None
    if has_scipy:
        cases += [(f"session{packed:d}.mat", simnibs_session(coils, packed), [], 1e-7, True) for packed in (False, True)]
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        subprocess.run([conus, "phantom", "sphere", "-o", ".", "--size", "16"], check=True)
        for name, text, options, tolerance, with_roll in cases:
            poses = read(conus, "sphere.nii.gz", text, name, options)
            worst = 0 if len(poses) == COUNT else np.inf
            for (label, m), (i, coil) in zip(poses, enumerate(coils)):
                worst = worst if label == f"coil {i}" else np.inf
                worst = max(worst, np.abs(m[:3, 3] - coil[:3, 3]).max(), np.abs(-m[:3, 2] - coil[:3, 2]).max())
                if with_roll:
                    worst = max(worst, np.abs(m[:3, 1] - coil[:3, 1]).max())
            failed += not worst <= tolerance
            print(f"{name}: {len(poses)} poses, largest difference {worst:.2g}, allowed {tolerance:g}")
        poses = read(conus, "sphere.nii.gz", simnibs_text(coils), "matsimnibs.txt", ["--poses-format", "simnibs"])
        worst = max([np.abs(m - coil @ np.diag([-1.0, 1, -1, 1])).max() for (_, m), coil in zip(poses, coils)])
        failed += not (worst <= 1e-7 and len(poses) == COUNT)
        print(f"matsimnibs.txt: {len(poses)} poses, largest difference {worst:.2g}, allowed 1e-07")
        if has_scipy:
            failed += compare_contacts(conus, coils)
        else:
            print("no python3-scipy: the files of MATLAB are left out")
        poses = dict(read(conus, "sphere.nii.gz", electrodes(coils), "sub-01_electrodes.tsv", ["--along-shafts"]))
        worst = max(np.abs(-poses[f"S{i}-{k}"][:3, 2] - coil[:3, 2]).max() for i, coil in enumerate(coils) for k in (1, 2))
        failed += not worst <= 1e-7
        print(f"electrodes: {len(poses)} poses, largest difference {worst:.2g}, allowed 1e-07")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
