# SPDX-License-Identifier: BSD-3-Clause
"""conus.brain_areas and conus.ibl with SpikeInterface, NeuroConv, pynwb, ONE and iblatlas."""
import datetime
import pathlib

import iblatlas
import numpy as np
import one.alf.io
import pandas
import probeinterface
import pynwb
import pytest
import spikeinterface
from iblatlas.regions import BrainRegions
from neuroconv.tools.spikeinterface import add_recording_to_nwbfile

import conus
import conus.ibl
from conus import nwb

LAYERS = ((0, 8, 0), (8, 18, 315), (18, 30, 382), (30, 50, 672), (50, 66, 1097), (66, 80, 0))  # voxels of 100 um, Allen's id
AIM = {"origin": (5400, 4000, 3739), "direction": (0, 1, 0), "up": (0, 0, 1), "space": "ccf"}


@pytest.fixture(name="atlas", scope="module")
def make_atlas(tmp_path_factory):
    folder = tmp_path_factory.mktemp("ccf")
    voxels = np.zeros((132, 80, 114), np.uint32)
    for top, bottom, number in LAYERS:
        voxels[:, top:bottom] = number
    head = ("NRRD0004\ntype: uint32\ndimension: 3\nspace: left-posterior-superior\nsizes: 132 80 114\n"
            "space directions: (100,0,0) (0,100,0) (0,0,100)\nkinds: domain domain domain\nendian: little\nencoding: raw\n"
            "space origin: (0,0,0)\n\n")
    (folder / "annotation_100.nrrd").write_bytes(head.encode() + voxels.tobytes(order="F"))
    tree = pandas.read_csv(pathlib.Path(iblatlas.__file__).parent / "allen_structure_tree.csv")
    rows = tree[tree["id"].isin([number for *_, number in LAYERS])][["id", "acronym", "name"]]
    rows.columns = ["index", "abbreviation", "name"]
    rows.to_csv(folder / "annotation_100.tsv", sep="\t", index=False)
    return conus.load(folder / "annotation_100.nrrd")


@pytest.fixture(name="recording", scope="module")
def make_recording():
    probe = probeinterface.generate_multi_columns_probe(
        num_columns=2, num_contact_per_column=48, xpitch=32, ypitch=60, contact_shapes="square", contact_shape_params={"width": 12})
    probe.set_contact_ids([f"e{i}" for i in range(96)])
    probe.set_device_channel_indices(np.random.default_rng(1).permutation(96))
    recording = spikeinterface.generate_recording(num_channels=96, durations=[1.0], set_probe=False)
    return recording.set_probe(probe) or recording


def test_channels_have_the_areas_of_the_layers(atlas, recording):
    areas, regions = conus.brain_areas(recording, atlas, **AIM), BrainRegions()
    contacts = atlas.contacts(conus.read_probe(recording.get_probe()), **AIM)
    depths = contacts.space.from_world(contacts.points)[:, 1]
    names = [next(regions.get(number)["name"][0] if number else "none" for top, bottom, number in LAYERS
                  if 100 * top <= depth < 100 * bottom) for depth in depths]
    assert areas == names and len(set(areas)) == 3
    # Depths are those of the recording's own channels: equal distances from the lowest.
    own = recording.get_channel_locations()[:, 1]
    assert depths.max() - depths == pytest.approx(own - own.min(), abs=1e-6)


def test_nwb_takes_them(atlas, recording, tmp_path):
    areas = conus.brain_areas(recording, atlas, **AIM)
    recording.set_property("brain_area", np.array(areas))
    file = pynwb.NWBFile("s", "id", datetime.datetime(2026, 1, 1, tzinfo=datetime.timezone.utc))
    with pytest.warns(UserWarning, match="gains and offsets"):
        add_recording_to_nwbfile(recording, file)
    assert list(file.electrodes["location"][:]) == areas
    table = nwb.add_localization(file, atlas.contacts(conus.read_probe(recording.get_probe()), **AIM))
    assert [area for area in table["brain_region"][:]] == areas
    with pynwb.NWBHDF5IO(tmp_path / "x.nwb", "w") as written:
        written.write(file)
    assert not pynwb.validate(path=str(tmp_path / "x.nwb"))


def test_one_and_iblatlas_read_them(atlas, recording, tmp_path):
    contacts = atlas.contacts(conus.read_probe(recording.get_probe()), **AIM)
    conus.ibl.write_channels(tmp_path, contacts)
    channels = one.alf.io.load_object(tmp_path, "channels")
    assert sorted(channels) == ["brainLocationIds_ccf_2017", "localCoordinates", "mlapdv"]
    theirs = BrainRegions().get(channels["brainLocationIds_ccf_2017"])["acronym"].tolist()
    assert theirs == conus.ibl.channels(contacts)["acronyms"] and len(set(theirs)) == 3


def test_ids_and_acronyms_are_allens():
    tree = pandas.read_csv(pathlib.Path(iblatlas.__file__).parent / "allen_structure_tree.csv")
    assert conus.ibl._ALLEN.items() <= dict(zip(tree["id"], tree["acronym"])).items()
