# SPDX-License-Identifier: BSD-3-Clause
"""conus.mne against MNE: areas of contacts of a person whose MRI is oblique, in each frame that MNE has."""
import mne
import nibabel
import numpy as np
import pytest

import conus
import conus.mne

NAMES = {2: "Left-Cerebral-White-Matter", 41: "Right-Cerebral-White-Matter", 17: "Left-Hippocampus", 53: "Right-Hippocampus",
         18: "Left-Amygdala", 10: "Left-Thalamus"}


def rotation(*degrees):
    matrix = np.eye(3)
    for axis, angle in enumerate(np.deg2rad(degrees)):
        a, b = (axis + 1) % 3, (axis + 2) % 3
        turn = np.eye(3)
        turn[[a, a, b, b], [a, b, a, b]] = np.cos(angle), -np.sin(angle), np.sin(angle), np.cos(angle)
        matrix = turn @ matrix
    return matrix


@pytest.fixture(name="subjects", scope="module")
def make_subject(tmp_path_factory):
    folder = tmp_path_factory.mktemp("subjects")
    (folder / "S" / "mri").mkdir(parents=True)
    at = np.indices((96, 100, 90))
    labels = np.where(at[0] < 48, 2, 41).astype(np.int32)
    for number, centre, radius in ((17, (30, 40, 40), 12), (53, (66, 40, 40), 12), (18, (30, 60, 35), 8), (10, (40, 45, 55), 9)):
        labels[((at - np.reshape(centre, (3, 1, 1, 1))) ** 2).sum(0) < radius ** 2] = number
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rotation(7, -11, 5) @ np.diag([-1.2, 1.1, 1.3]), (60, -50, -40)
    nibabel.save(nibabel.MGHImage(labels, matrix), folder / "S" / "mri" / "aparc+aseg.mgz")
    nibabel.save(nibabel.MGHImage(labels.astype(np.float32), matrix), folder / "S" / "mri" / "T1.mgz")
    (folder / "names.tsv").write_text("index\tname\n" + "".join(f"{i}\t{n}\n" for i, n in NAMES.items()), encoding="utf-8")
    return folder


@pytest.fixture(name="metres", scope="module")
def make_contacts(subjects):
    # Centres of voxels, since MNE rounds to the voxel.
    voxels = np.rint(np.random.default_rng(0).uniform(4, [92, 96, 86], (60, 3)))
    matrix = nibabel.load(subjects / "S" / "mri" / "T1.mgz").header.get_vox2ras_tkr()
    return nibabel.affines.apply_affine(matrix, voxels) / 1000


def montage_of(metres, frame):
    landmarks = {"nasion": [0, .1, 0], "lpa": [-.08, 0, 0], "rpa": [.08, 0, 0]} if frame == "head" else {}
    return mne.channels.make_dig_montage({f"A{i}": p for i, p in enumerate(metres)}, coord_frame=frame, **landmarks)


def areas_of(answers):
    rows = answers.to_dataframe()
    return rows[rows["distance_mm"] == 0].groupby("query")["name"].agg(list).to_dict()


def test_every_frame_of_a_person(subjects, metres):
    own, _ = mne.get_montage_volume_labels(montage_of(metres, "mri"), "S", subjects_dir=subjects, aseg="aparc+aseg", dist=0)
    assert len(own) == 60 and sum(map(len, own.values())) > 30
    atlas = conus.load(subjects / "S" / "mri" / "aparc+aseg.mgz", labels=subjects / "names.tsv", template="none")
    person = {"subject": "S", "subjects_dir": subjects}
    wanted = {name: areas for name, areas in own.items() if areas}
    assert areas_of(conus.mne.label(montage_of(metres, "mri"), atlas, **person)) == wanted

    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rotation(3, 4, -6), (.002, -.01, .03)
    to_mri = mne.transforms.Transform("head", "mri", matrix)
    to_head = mne.transforms.invert_transform(to_mri)
    head = mne.transforms.apply_trans(to_head, metres)
    raw = mne.io.RawArray(np.zeros((60, 10)), mne.create_info([f"A{i}" for i in range(60)], 100.0, "seeg"))
    raw.set_montage(montage_of(head, "head"))
    for trans in (to_mri, to_head):
        assert areas_of(conus.mne.label(raw, atlas, trans=trans, **person)) == wanted
        assert areas_of(conus.mne.label(raw.info, atlas, trans=trans, **person)) == wanted
    dipole = mne.Dipole(np.arange(60) / 100, head, np.ones(60), np.tile([0, 0, 1.0], (60, 1)), np.ones(60))
    found = areas_of(conus.mne.label(dipole, atlas, trans=to_mri, **person))
    assert [found[f"{i / 100:.3f} s"] for i in range(60) if own[f"A{i}"]] == list(wanted.values())


def test_a_template_refuses_a_persons_positions(subjects, metres):
    aal = conus.load("aal")
    with pytest.raises(conus.DataError, match="ScanRAS"):
        conus.mne.label(montage_of(metres, "mri"), aal, subject="S", subjects_dir=subjects)
    with pytest.raises(conus.ArgumentError, match="need the subject"):
        conus.mne.label(mne.channels.make_standard_montage("standard_1020"), aal)
    with pytest.raises(conus.ArgumentError, match="needed is from head to MRI"):
        conus.mne.label(montage_of(metres, "head"), aal, trans=mne.transforms.Transform("meg", "head"))


def test_mni305_is_moved_and_said():
    with pytest.warns(conus.PoseWarning, match="moved to MNI 152"):
        talairach = conus.mne.label(montage_of(np.array([[-.03, -.02, -.015]]), "mni_tal"), "aal").to_dataframe()
    with pytest.warns(conus.PoseWarning, match="moved to MNI 152"):
        average = conus.mne.label(montage_of(np.array([[-.03, -.02, -.015]]), "mri"), "aal", subject="fsaverage").to_dataframe()
    assert talairach["name"].tolist() == average["name"].tolist() == ["Hippocampus_L"]
