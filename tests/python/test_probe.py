# SPDX-License-Identifier: BSD-3-Clause
"""Probes of ProbeInterface: answers are the program's, and NWB gets their tables."""
import io
import json
import pathlib
import subprocess
import sys
import types

import nibabel
import numpy as np
import pandas
import pytest

import conus
from conus import nwb
from support import AFFINE, NAMES, assert_rows_of_the_program, call_conus, plates

TIP, UP = (-50, 1, 2), (0, 0, 1)  # along +x through both plates, -40 to -20 and 20 to 40


def describe(path, count=1, **more):
    """Probes with ten contacts 10 mm apart, the first 5 mm above the tip."""
    probe = {"ndim": 2, "si_units": "mm", "contact_positions": [[0, 10 * i] for i in range(10)],
             "device_channel_indices": [9 - i if i != 3 else -1 for i in range(10)],
             "probe_planar_contour": [[-1, 200], [0, -5], [1, 200]], **more}
    path.write_text(json.dumps({"specification": "probeinterface", "probes": [probe] * count}), encoding="utf-8")
    return path


@pytest.fixture(name="folder")
def write_files(tmp_path):
    nibabel.save(nibabel.Nifti1Image(plates(), AFFINE), tmp_path / "plates.nii")
    pandas.DataFrame({"index": NAMES.keys(), "name": NAMES.values()}).to_csv(tmp_path / "plates.tsv", sep="\t", index=False)
    describe(tmp_path / "np.json", shank_ids=["a"] * 5 + ["b"] * 5)
    return tmp_path


def aim():
    """Down along -x from the base: the contacts are at x = -45, -35 and so on."""
    return {"origin": TIP, "direction": (-1, 0, 0), "up": UP}


def test_what_a_file_says(folder):
    probe = conus.read_probe(folder / "np.json")
    assert probe.ids.tolist() == [str(i) for i in range(10)] and len(probe) == 10
    assert probe.channels.tolist() == [9, 8, 7, -1, 5, 4, 3, 2, 1, 0]
    assert probe.shanks.tolist() == ["a"] * 5 + ["b"] * 5
    assert probe.tips[0, :2].tolist() == [0, -5000] and np.isnan(probe.tips[0, 2])
    assert probe.positions[9, :2].tolist() == [0, 90000]
    with pytest.raises(conus.DataError, match="probe_planar_contour: there is none"):
        conus.read_probe(describe(folder / "blunt.json", probe_planar_contour=None))
    assert conus.read_probe(folder / "blunt.json", tip=5).tips[0, 1] == -5000


@pytest.mark.parametrize("radius", [0, 7.5])
def test_rows_are_the_programs(folder, radius):
    atlas = conus.load(folder / "plates.nii", labels=folder / "plates.tsv")
    contacts = atlas.contacts(conus.read_probe(folder / "np.json"), **aim(), roll=30, radius=radius)
    words = ["query", folder / "plates.nii", "--labels", folder / "plates.tsv", "--probe", folder / "np.json", "-q",
             "--origin=-50,1,2", "--direction=-1,0,0", "--up", "0,0,1", "--probe-roll", "30", "--layers", "all", "--format", "tsv"]
    out = call_conus(*words, *(["--radius", radius] if radius else [])).stdout
    rows = pandas.read_csv(io.BytesIO(out), sep="\t", na_values="n/a", keep_default_na=False, dtype={"query": str})
    assert_rows_of_the_program(contacts.to_dataframe(), rows)


def test_contacts_lie_where_the_pose_puts_them(folder, atlas):
    probe = conus.read_probe(folder / "np.json")
    contacts = atlas.contacts(probe, **aim())
    assert np.allclose(contacts.points, [[-45 + 10 * i, 1, 2] for i in range(10)], atol=1e-12)
    assert contacts.areas.tolist() == [0, 1, 1, 0, 0, 0, 0, 2, 2, 0]
    matrix = np.array([[0, 0, 1, -50], [1, 0, 0, 1], [0, 1, 0, 2], [0, 0, 0, 1.0]])
    again = atlas.contacts(probe, pose=matrix)
    assert np.allclose(again.points, contacts.points) and len(again) == 10
    assert "4 of 10" in repr(contacts) and "10 contacts" in repr(probe)


def test_several_probes_have_a_pose_each(folder, atlas):
    probe = conus.read_probe(describe(folder / "two.json", 2))
    matrices = np.array([[[0, 0, 1, -50], [1, 0, 0, y], [0, 1, 0, 2], [0, 0, 0, 1.0]] for y in (1, -8)])
    contacts = atlas.contacts(probe, poses=matrices)
    assert probe.ids[10] == "probe2:0" and np.allclose(contacts.points[10], [-45, -8, 2])
    for wrong in ({"poses": matrices[:1]}, aim(), {**aim(), "poses": matrices}):
        with pytest.raises(conus.ArgumentError, match="poses"):
            atlas.contacts(probe, **wrong)
    with pytest.raises(conus.ArgumentError, match="read_probe"):
        atlas.contacts(folder / "two.json", poses=matrices)


# The tip is 12.5 mm behind x = -50, and the first contact 5 mm before it.
def test_the_tip_is_at_the_far_end_of_a_file_s_pose(folder, atlas):
    probe = conus.read_probe(folder / "np.json")
    (folder / "line.tsv").write_text("x\ty\tz\tdx\tdy\tdz\tfar\n-50\t1\t2\t1\t0\t0\t12.5\n")
    deep = atlas.contacts(probe, poses=conus.read_poses(folder / "line.tsv")).points
    (folder / "line.tsv").write_text("x\ty\tz\tdx\tdy\tdz\n-50\t1\t2\t1\t0\t0\n")
    flat = atlas.contacts(probe, poses=conus.read_poses(folder / "line.tsv")).points
    assert np.allclose(deep[0], [-50 + 12.5 - 5, 1, 2]) and np.allclose(deep - flat, [12.5, 0, 0])


class Recorded(types.SimpleNamespace):
    """An object of pynwb that keeps what it is given."""

    def __init__(self, **given):
        super().__init__(**given, rows=[], added=[])

    def add_row(self, **row):
        self.rows.append(row)

    def add_lab_meta_data(self, items):
        self.added += items

    add_spaces = add_anatomical_coordinates_tables = add_lab_meta_data


@pytest.fixture(name="ndx")
def stand_in(monkeypatch):
    """The classes of the extension, as its README uses them: pynwb is no package of Debian."""
    module = types.ModuleType("ndx_anatomical_localization")
    for name in ("Space", "AllenCCFv3Space", "AnatomicalCoordinatesTable", "Localization"):
        setattr(module, name, type(name, (Recorded,), {}))
    monkeypatch.setitem(sys.modules, "ndx_anatomical_localization", module)
    return module


def test_nwb_gets_plain_tables(folder, atlas, ndx):
    contacts = atlas.contacts(conus.read_probe(folder / "np.json"), **aim())
    table = nwb.coordinates(contacts)
    assert table["brain_region"][:4] == ["unknown", "left", "left", "unknown"]
    assert table["x"][2] == pytest.approx(-25) and table["space"] == "ras"
    assert table["method"].startswith(f"conus {conus.__version__}, atlas ")
    file = Recorded(electrodes=range(10))
    written = nwb.add_localization(file, contacts, rows=contacts.probe.channels)
    assert [row["localized_entity"] for row in written.rows] == [9, 8, 7, 5, 4, 3, 2, 1, 0]
    assert written.rows[1] == {"x": table["x"][1], "y": table["y"][1], "z": table["z"][1], "brain_region": "left",
                               "localized_entity": 8}
    assert (written.space.units, written.space.orientation, written.target) == ("mm", "RAS", file.electrodes)
    spaces, tables = file.added[0].added
    assert spaces is written.space and tables is written and isinstance(file.added[0], ndx.Localization)
    assert [row["localized_entity"] for row in nwb.add_localization(file, contacts).rows] == list(range(10))


def test_nwb_has_the_allen_ccf_as_posterior_inferior_right(folder, ndx):
    labels = np.zeros((66, 40, 57), "u1")
    labels[20:40] = 1  # 4000 to 8000 um behind the front
    ccf = conus.load(labels, np.diag([0.2, 0.2, 0.2, 1]), labels={1: "middle"})
    probe = conus.read_probe(describe(folder / "um.json", si_units="um"))
    contacts = ccf.contacts(probe, origin=(5000, 3000, 4000), direction=(0, 1, 0), space="ccf")
    written = nwb.add_localization(Recorded(electrodes=range(10)), contacts)
    assert isinstance(written.space, ndx.AllenCCFv3Space)
    assert [written.rows[0][axis] for axis in "xyz"] == pytest.approx([5000, 2995, 4000])
    assert {row["brain_region"] for row in written.rows} == {"middle"}


def test_nwb_says_what_is_wrong(folder, atlas, monkeypatch):
    contacts = atlas.contacts(conus.read_probe(folder / "np.json"), **aim())
    monkeypatch.setitem(sys.modules, "ndx_anatomical_localization", None)
    with pytest.raises(ImportError, match="needs pynwb and ndx-anatomical-localization"):
        nwb.add_localization(Recorded(electrodes=range(10)), contacts)


@pytest.mark.parametrize("electrodes, rows", [(9, None), (None, None), (10, [0] * 10), (10, [0]), (5, list(range(10)))])
def test_nwb_electrodes_must_fit(folder, atlas, ndx, electrodes, rows):
    contacts = atlas.contacts(conus.read_probe(folder / "np.json"), **aim())
    assert ndx
    file = Recorded(electrodes=electrodes and range(electrodes))
    with pytest.raises(conus.ArgumentError):
        nwb.add_localization(file, contacts, rows=rows)
    assert not file.added


# ccf.py has the labels by closed form in ML, AP, DV: in BrainGlobe's folders x grows to the other side.
@pytest.mark.parametrize("form", ["ras.nii", "globe", "turned.nii"])
def test_contacts_are_the_same_in_each_form_of_the_ccf(tmp_path, form):
    subprocess.run([sys.executable, pathlib.Path(__file__).parents[1] / "cli/ccf.py"], cwd=tmp_path, check=True)
    atlas, probe = conus.load(tmp_path / form), conus.read_probe(tmp_path / "probe.json")
    poses = conus.read_poses(tmp_path / "devices.tsv", space="bregma", atlas=atlas)
    table = pandas.read_csv(tmp_path / "devices.tsv", sep="\t")
    tip, along, up = (table[[prefix + axis for axis in ("ap", "ml", "dv")]].to_numpy() for prefix in ("", "d", "u"))
    selector = conus.Selector(atlas, space="bregma")
    wanted = np.loadtxt(tmp_path / "contacts.txt", int)
    for given in (poses, poses.matrices, [poses[i] for i in range(3)]):
        contacts = atlas.contacts(probe, poses=given)
        assert contacts.to_dataframe().query("kind == 'area'")["index"].tolist() == wanted.tolist()
    describe(tmp_path / "one.json", contact_positions=[[0, 0], [1, 0.3], [2.5, 0.9], [4.1, 2.1]],
             device_channel_indices=[0, 1, 2, 3], probe_planar_contour=[[0, 0], [9, 99], [-9, 99]])
    one = conus.read_probe(tmp_path / "one.json")
    for i in range(3):
        for aimed in ({"direction": along[i]}, {"toward": tip[i] + along[i]}):
            rows = selector.contacts(one, tip[i], up=up[i], **aimed).to_dataframe().query("kind == 'area'")
            assert rows["index"].tolist() == wanted[4 * i:4 * i + 4].tolist()
        rows = atlas.contacts(one, pose=poses[i]).to_dataframe().query("kind == 'area'")
        assert rows["index"].tolist() == wanted[4 * i:4 * i + 4].tolist()
    # 1.6 mm of the second shank are in area 72 (ccf.bats), 0 of its mirror image; up is to the front
    origin, down, front = (-1, -2.939, -0.168), (0, 0, -1), (1, 0, 0)
    (tmp_path / "down.tsv").write_text("ap\tml\tdv\tdap\tdml\tddv\tuap\tuml\tudv\n-1\t-2.939\t-0.168\t0\t0\t-1\t1\t0\t0\n")
    down_poses = conus.read_poses(tmp_path / "down.tsv", space="bregma", atlas=atlas)
    plan = selector.plan({"72" if form != "globe" else "A72": {"length": 0.5, "shank": 2}}, poses=down_poses, depth=3, shanks=[(0, 0), (2.5, 0)])
    assert abs(plan.verdicts()["value"][0] - 1.6) < 1e-6
    tried = plan.try_pose(origin, direction=down, up=front, depth=3)
    assert abs(tried["verdicts"][0]["value"] - 1.6) < 1e-6
    left_handed = np.diag([-1.0, 1, 1, 1])
    with pytest.raises(conus.ArgumentError, match="left-handed"):
        conus.load(tmp_path / "ras.nii").select(pose=left_handed)
