# SPDX-License-Identifier: BSD-3-Clause
"""What conus is for other programs' objects, without these programs: scripts/hosts asks the programs themselves."""
import json

import nibabel
import numpy as np
import pandas
import pytest

import conus
import conus.ibl
import conus.mne
import conus.nilearn
from support import AAL, needs_aal

PROBE = {"specification": "probeinterface", "version": "0.2.16", "probes": [
    {"ndim": 2, "si_units": "mm", "contact_positions": [[0, 10 * i] for i in range(10)],
     "device_channel_indices": list(range(10)), "probe_planar_contour": [[-1, 200], [0, -5], [1, 200]]}]}


def test_areas_of_a_probe_in_memory(atlas):
    # The tip is at x = -50, contacts at -45, -35 and so on; the plates lie from -40 to -20 and from 20 to 40.
    areas = conus.brain_areas(PROBE, atlas, origin=(-50, 1, 2), direction=(-1, 0, 0), up=(0, 0, 1))
    assert areas == ["none", "left", "left", "none", "none", "none", "none", "right", "right", "none"]
    with pytest.raises(conus.ArgumentError, match="path: 3, wanted is a path, a Probe"):
        conus.brain_areas(3, atlas, origin=(0, 0, 0), direction=(0, 0, -1))
    with pytest.raises(conus.DataError, match="^probe: "):
        conus.read_probe({"specification": "other"})


def test_the_tip_is_where_it_is_said_to_be(atlas):
    # The contour has it 5 mm below the lowest contact, which comes 10 mm further up: at -35, in the plate, and so on.
    aim = {"origin": (-50, 1, 2), "direction": (-1, 0, 0), "up": (0, 0, 1)}
    wanted = ["left", "left", "none", "none", "none", "none", "right", "right", "none", "none"]
    assert conus.brain_areas(PROBE, atlas, tip=15, **aim) == wanted
    assert conus.brain_areas(conus.read_probe(PROBE, tip=15), atlas, **aim) == wanted
    with pytest.raises(conus.ArgumentError, match="^tip: the probe has been read already"):
        conus.brain_areas(conus.read_probe(PROBE), atlas, tip=15, **aim)


def test_probes_that_are_none(atlas):
    # run() could not tell the program the tip that read_probe() was told.
    with pytest.raises(conus.ArgumentError, match="^path: <conus.Probe: 10 contacts, .*wanted is a path, a Probe of probeinterface"):
        conus.read_probe(conus.read_probe(PROBE))
    with pytest.raises(conus.ArgumentError, match=r"^run: np: <conus.Probe: 10 contacts, .*wanted is .*what read_probe\(\) takes"):
        conus.run("query aal --probe {np} --origin 0,0,0 --direction 0,0,1", np=conus.read_probe(PROBE))
    with pytest.raises(conus.ArgumentError, match="^probe: .*ndarray.*array_as_list=True"):
        conus.read_probe({**PROBE, "probes": [{**PROBE["probes"][0], "contact_positions": np.zeros((10, 2))}]})


class Probe:
    """What conus takes of a Probe of probeinterface."""

    contact_positions = PROBE["probes"][0]["contact_positions"]

    def to_dict(self, array_as_list=False):
        assert array_as_list
        return PROBE["probes"][0]


class Recording:
    def get_probe(self):
        return Probe()


class Group:
    probes = [Probe(), Probe()]


def test_recordings_and_groups(atlas):
    one = conus.brain_areas(Recording(), atlas, origin=(-50, 1, 2), direction=(-1, 0, 0), up=(0, 0, 1), outside="void")
    assert one[:3] == ["void", "left", "left"]
    assert len(conus.read_probe(Group()).tips) == 2


def small_ccf(folder, names):
    """10 x 8 x 11.4 mm of layers in the CCF; {id: acronym}, a layer of 2 mm each from the top."""
    voxels = np.zeros((132, 80, 114), np.uint32)
    for layer, number in enumerate(names):
        voxels[:, 20 * layer:20 * layer + 20] = number
    head = ("NRRD0004\ntype: uint32\ndimension: 3\nspace: left-posterior-superior\nsizes: 132 80 114\n"
            "space directions: (100,0,0) (0,100,0) (0,0,100)\nkinds: domain domain domain\nendian: little\nencoding: raw\n"
            "space origin: (0,0,0)\n\n")
    (folder / "annotation_100.nrrd").write_bytes(head.encode() + voxels.tobytes(order="F"))
    rows = "".join(f"{number}\t{acronym}\tThe {acronym}\n" for number, acronym in names.items())
    (folder / "annotation_100.tsv").write_text("index\tabbreviation\tname\n" + rows, encoding="utf-8")
    return conus.load(folder / "annotation_100.nrrd")


def contacts_in(atlas, wiring=tuple(range(10)), **space):
    # Down from DV 0: contacts 1 mm apart from 7.5 mm (the lowest, 0.5 mm above the tip at 8 mm) to -1.5 mm, outside.
    probe = json.loads(json.dumps(PROBE))
    probe["probes"][0]["contact_positions"] = [[0, i] for i in range(10)]
    probe["probes"][0]["probe_planar_contour"] = [[-1, 20], [0, -0.5], [1, 20]]
    del probe["probes"][0]["device_channel_indices"]
    if wiring is not None:
        probe["probes"][0]["device_channel_indices"] = list(wiring)
    return atlas.contacts(conus.read_probe(probe), **space)


def test_files_of_ibl(tmp_path):
    atlas = small_ccf(tmp_path, {315: "Isocortex", 382: "CA1", 672: "CP", 1097: "HY"})
    contacts = contacts_in(atlas, origin=(5400, 8000, 3739), direction=(0, 1, 0), up=(0, 0, 1), space="ccf")
    paths = conus.ibl.write_channels(tmp_path / "alf", contacts)
    assert len(paths) == 4
    ids = np.load(tmp_path / "alf" / "channels.brainLocationIds_ccf_2017.npy")
    assert ids.tolist() == [1097, 1097, 672, 672, 382, 382, 315, 315, 0, 0]
    # To the right, to the front, upwards of 5739, 5400, 332: the contact 0.5 mm above the tip is at ML 3739, AP 5400, DV 7500.
    mlapdv = np.load(tmp_path / "alf" / "channels.mlapdv.npy")
    assert mlapdv[0].tolist() == [-2000, 0, 332 - 7500] and mlapdv[1].tolist() == [-2000, 0, 332 - 6500]
    assert np.load(tmp_path / "alf" / "channels.localCoordinates.npy")[2].tolist() == [0, 2000]
    document = json.loads((tmp_path / "alf" / "channel_locations.json").read_text(encoding="utf-8"))
    assert document["channel_4"]["brain_region"] == "CA1" and document["channel_9"]["brain_region"] == "void"
    assert document["origin"]["bregma"] == [5739, 5400, 332]
    back = conus.read_poses(tmp_path / "alf" / "channel_locations.json", space="ccf", atlas=atlas)
    assert np.abs(back.origins - contacts.points).max() < 1e-9
    with pytest.raises(conus.FileError, match="channels.mlapdv.npy: exists"):
        conus.ibl.write_channels(tmp_path / "alf", contacts)


LAYERS = {315: "Isocortex", 382: "CA1", 672: "CP", 1097: "HY"}
AIM = {"origin": (5400, 8000, 3739), "direction": (0, 1, 0), "up": (0, 0, 1), "space": "ccf"}


@pytest.mark.parametrize(("wiring", "contacts"), [
    (None, range(10)),
    ((3, 1, 0, 2, 9, 8, 7, 6, 5, 4), (2, 1, 3, 0, 9, 8, 7, 6, 5, 4)),  # contact 2 has channel 0, and so on
    ((-1, 2, 1, 0, -1, 3, 4, 5, 6, 7), (3, 2, 1, 5, 6, 7, 8, 9)),
])
def test_rows_of_ibl_are_channels(tmp_path, wiring, contacts):
    # Contact i is i mm above the lowest, at DV 7.5 mm - i, in layers of 2 mm.
    found = conus.ibl.channels(contacts_in(small_ccf(tmp_path, LAYERS), wiring, **AIM))
    assert found["local"].tolist() == [[0, 1000 * i] for i in contacts]
    assert found["mlapdv"] == pytest.approx(np.array([[-2000, 0, 332 - 7500 + 1000 * i] for i in contacts]), abs=1e-6)
    acronyms = [("HY", "CP", "CA1", "Isocortex", "void")[i // 2] for i in contacts]
    assert found["acronyms"] == acronyms
    assert found["ids"].tolist() == [{**dict(map(reversed, LAYERS.items())), "void": 0}[name] for name in acronyms]


def test_channels_that_ibl_cannot_count(tmp_path):
    atlas = small_ccf(tmp_path, LAYERS)
    for wiring, match in (
        ((0, 1, 2, 3, 4, 5, 6, 7, 8, 10), "channel 9 has no contact"),
        ((1, 2, 3, 4, 5, 6, 7, 8, 9, 10), "channel 0 has no contact"),
        ((-1,) * 10, "none is wired"),
    ):
        with pytest.raises(conus.ArgumentError, match=match):
            conus.ibl.channels(contacts_in(atlas, wiring, **AIM))
    both = atlas.contacts(conus.read_probe(Group()), poses=np.array([np.eye(4)] * 2))
    with pytest.raises(conus.ArgumentError, match="of 2 probes"):
        conus.ibl.channels(both)
    with pytest.raises(conus.DataError, match="two contacts of probe1 have the channel 3"):
        contacts_in(atlas, (0, 1, 2, 3, 3, 4, 5, 6, 7, 8), **AIM)


def test_ibl_reads_ids_of_allen_alone(tmp_path, atlas):
    plain = atlas.contacts(conus.read_probe(PROBE), origin=(-50, 1, 2), direction=(-1, 0, 0), up=(0, 0, 1))
    with pytest.raises(conus.ArgumentError, match='space="ccf"'):
        conus.ibl.channels(plain)
    aim = {"origin": (5400, 8000, 3739), "direction": (0, 1, 0), "up": (0, 0, 1), "space": "ccf"}
    with pytest.raises(conus.ArgumentError, match='calls 382 "CA3", Allen "CA1"'):
        conus.ibl.channels(contacts_in(small_ccf(tmp_path, {382: "CA3", 315: "Isocortex"}), **aim))
    with pytest.raises(conus.ArgumentError, match="none of the ids and acronyms of Allen's"):
        conus.ibl.channels(contacts_in(small_ccf(tmp_path, {1: "one", 2: "two"}), **aim))


def test_names_of_clusters(atlas):
    # A cluster over the border of the left plate, x from -24 to -16 mm: half of it, as the plate ends at -20. On its own
    # grid of 1 mm, whose voxels' centres are not those of the atlas.
    labels = np.zeros((60, 20, 20), np.int32)
    labels[16:24, 5:9, 5:9], labels[50:52, 5:7, 5:7] = 1, 2
    image = nibabel.Nifti1Image(labels, np.array([[1, 0, 0, -39.5], [0, 1, 0, -9.5], [0, 0, 1, -9.5], [0, 0, 0, 1.0]]))
    table = pandas.DataFrame({"Cluster ID": [1, "1a", 2], "X": [-22.5, -18.5, 10.5], "Y": [-3.5] * 3, "Z": [-3.5] * 3,
                              "Peak Stat": [5.0, 4.0, 3.0], "Cluster Size (mm3)": [128, "", 8]})
    named = conus.nilearn.name_clusters(table, [image], atlas)
    assert named["Peak Area"].tolist() == ["left", "none", "none"]
    assert named["Cluster Areas"].tolist() == ["50.0 % left; 50.0 % none", "", "100.0 % none"]
    assert list(table) == list(named)[:6] and "Peak Area" not in table
    assert conus.nilearn.name_clusters(table[:1], image, atlas, least=0.6)["Cluster Areas"].tolist() == ["none"]
    with pytest.raises(conus.DataError, match=r"none has a cluster at the peak \[30.0, -3.5, -3.5\]"):
        conus.nilearn.name_clusters(table.assign(X=30.0), [image], atlas)
    with pytest.raises(conus.ArgumentError, match="the clusters of a surface"):
        conus.nilearn.name_clusters(table.drop(columns="X"), [image], atlas)


@needs_aal
def test_positions_say_whose_brain_they_are_in():
    aal, point = conus.load(AAL), np.array([[-30.0, -20, -15]])
    with pytest.raises(conus.ArgumentError, match="do not say whose brain"):
        conus.mne.label(point, aal)
    with pytest.raises(conus.DataError, match='^source: positions are in "ScanRAS"'):
        conus.mne.label(point, aal, space="ScanRAS")
    with pytest.warns(conus.PoseWarning):
        assert conus.mne.label(point, aal, space="MNI152NLin6Asym").to_dataframe()["name"].tolist() == ["Hippocampus_L"]
    with pytest.warns(conus.PoseWarning, match="moved to MNI 152 by FreeSurfer's matrix"):
        moved = conus.mne.label(point, aal, space="MNI305").to_dataframe()
    # FreeSurfer's matrix on its page "CoordinateSystems", case 8.
    matrix = np.array([[0.9975, -0.0073, 0.0176, -0.0429], [0.0146, 1.0009, -0.0024, 1.5496], [-0.0130, -0.0093, 0.9971, 1.1840]])
    assert moved[["contact_x", "contact_y", "contact_z"]].to_numpy()[0] == pytest.approx(matrix @ [-30, -20, -15, 1], abs=1e-6)


class Montage:
    """What conus takes of a montage of MNE."""

    def __init__(self, frame, **points):
        self.positions = {"coord_frame": frame, "ch_pos": {name: np.array(at) / 1000 for name, at in points.items()}}

    def get_positions(self):
        return self.positions


class Raw:
    def __init__(self, montage):
        self.montage = montage

    def get_montage(self):
        return self.montage


def test_what_mne_does_not_say(atlas):
    for source, more, match in (
        (Montage("head", A1=(0, 0, 0)), {}, "-trans.fif"),
        (Montage("mri", A1=(0, 0, 0)), {}, "need the subject"),
        (Montage("mri_voxel", A1=(0, 0, 0)), {}, '"mri_voxel", allowed are'),
        (Montage("mni_tal", A1=(0, 0, 0)), {"trans": "x-trans.fif"}, "not in the head's"),
        (Montage("mni_tal", A1=(0, 0, 0)), {"space": "MNI152"}, "says whose brain"),
        (Montage("mni_tal", **{"A\t1": (0, 0, 0)}), {}, "is called"),
        (Montage("mni_tal", A1=(0, 0, 0)), {"subject": "S"}, '"mni_tal", the frame "mri" needs it'),
        (np.zeros((1, 3)), {"space": "ScanRAS", "subject": "S"}, '^subject: .*"ras", the frame "mri" needs it'),
        (Raw(None), {}, "Raw has no montage"),
        ("x.fif", {}, "str is nothing of MNE"),
        (np.zeros(3), {"space": "MNI152"}, r"shape \(3,\), needed is \(n, 3\)"),
    ):
        with pytest.raises(conus.ArgumentError, match=match):
            conus.mne.label(source, atlas, **more)


def test_names_stay_and_gaps_are_said(atlas):
    source = Raw(Montage("ras", LA1=(-30, 1, 1), LA2=(np.nan,) * 3, RA1=(30, 1, 1)))
    with pytest.warns(conus.PoseWarning, match="1 rows without coordinates"):
        rows = conus.mne.label(source, atlas, space="ScanRAS").to_dataframe()
    assert rows["query"].tolist() == ["LA1", "RA1"] and rows["name"].tolist() == ["left", "right"]


@pytest.mark.filterwarnings("ignore:positions are in")
@pytest.mark.parametrize("name", ["#1", "%2", "//2", "n/a", '"a', "x y"])
def test_any_name_of_a_channel_stays(atlas, name):
    source = Montage("ras", **{name: (-30, 1, 1), "z": (30, 1, 1)})
    rows = conus.mne.label(source, atlas, space="ScanRAS").to_dataframe()
    assert rows["query"].tolist() == [name, "z"] and rows["name"].tolist() == ["left", "right"]


def test_a_space_is_one_text(atlas):
    with pytest.warns(conus.PoseWarning, match=r'^positions are in "a "space" of \\ mine"'):
        conus.mne.label(np.array([[-30.0, 1, 1]]), atlas, space='a "space" of \\ mine')


def test_a_note_is_said_once_and_of_no_folder(atlas, caplog):
    source = Montage("ras", A1=(-30, 1, 1), A2=(np.nan,) * 3)
    with pytest.warns(conus.PoseWarning) as told:
        conus.mne.label(source, atlas, space="ScanRAS")
    said = [str(warning.message) for warning in told]
    assert sum("without coordinates" in note for note in said) == 1 and not any("_electrodes.tsv" in note for note in said)
    assert not caplog.records
