# SPDX-License-Identifier: BSD-3-Clause
"""conus.nilearn on what nilearn makes: clusters whose voxels are counted here. scripts/hosts python runs it."""
import nibabel
import numpy as np
import pytest

import conus
import conus.nilearn

reporting = pytest.importorskip("nilearn.reporting")
AFFINE = np.diag([2.0, 2, 2, 1]) + [[0, 0, 0, -20], [0, 0, 0, -20], [0, 0, 0, -20], [0, 0, 0, 0]]


@pytest.fixture(scope="module")
def atlas():
    labels = np.zeros((20, 20, 20), np.int16)
    labels[:8], labels[8:15] = 1, 2
    return conus.load(labels, AFFINE, labels={1: "Left", 2: "Right"})


def stat_map():
    """Two clusters above, with a subpeak in one, and two below, on the atlas's grid."""
    data = np.zeros((20, 20, 20), np.float32)
    data[4:18, 5:10, 5:10] = 4
    data[5, 7, 7], data[17, 7, 7] = 9, 8  # 24 mm apart: peak, subpeak
    data[2:5, 15:18, 15:18] = 5
    data[10:14, 13:16, 2:5] = -5
    data[16:19, 1:3, 14:18] = -6
    return nibabel.Nifti1Image(data, AFFINE)


def counted(box, labels):
    voxels = np.zeros((20, 20, 20), bool)
    voxels[box] = True
    shares = [(name, np.sum(labels[voxels] == value) / voxels.sum()) for value, name in ((1, "Left"), (2, "Right"), (0, "none"))]
    return {name: f"{100 * share:.1f} % {name}" for name, share in shares if share >= 0.05}


def test_clusters_have_the_areas_that_counting_gives(atlas):
    labels = np.zeros((20, 20, 20), np.int16)
    labels[:8], labels[8:15] = 1, 2
    table, maps = reporting.get_clusters_table(stat_map(), 3, two_sided=True, return_label_maps=True)
    named = conus.nilearn.name_clusters(table, maps, atlas)
    assert list(table.columns) == list(named.columns)[:-2]
    large = named[named["Cluster Size (mm3)"] != ""]
    wanted = [counted(np.s_[4:18, 5:10, 5:10], labels), counted(np.s_[2:5, 15:18, 15:18], labels),
              counted(np.s_[10:14, 13:16, 2:5], labels), counted(np.s_[16:19, 1:3, 14:18], labels)]
    found = [set(text.split("; ")) for text in large["Cluster Areas"]]
    assert len(found) == 4
    for each in wanted:
        assert set(each.values()) in found, (each, found)
    subpeaks = named[named["Cluster Size (mm3)"] == ""]
    assert len(subpeaks) and set(subpeaks["Cluster Areas"]) == {""}
    for _, row in named.iterrows():
        voxel = tuple(int(round((float(row[axis]) + 20) / 2)) for axis in "XYZ")
        assert row["Peak Area"] == {0: "none", 1: "Left", 2: "Right"}[labels[voxel]]


def test_one_map_and_a_path_of_an_atlas(atlas, tmp_path):
    labels = np.zeros((20, 20, 20), np.uint8)
    labels[:8] = 1
    nibabel.save(nibabel.Nifti1Image(labels, AFFINE), tmp_path / "a.nii.gz")
    (tmp_path / "a.tsv").write_text("index\tname\n1\tOnly\n")
    table, maps = reporting.get_clusters_table(stat_map(), 3, two_sided=False, return_label_maps=True)
    named = conus.nilearn.name_clusters(table, maps[0], tmp_path / "a.nii.gz", least=0.5)
    assert set(named["Peak Area"]) <= {"Only", "none"} and "Only" in set(named["Peak Area"])


def test_what_does_not_belong_together_is_refused(atlas):
    table, maps = reporting.get_clusters_table(stat_map(), 3, return_label_maps=True)
    other = [nibabel.Nifti1Image(np.zeros((20, 20, 20), np.int16), AFFINE)]
    with pytest.raises(conus.DataError, match="none has a cluster at the peak"):
        conus.nilearn.name_clusters(table, other, atlas)
    with pytest.raises(conus.ArgumentError, match="surface"):
        conus.nilearn.name_clusters(table.drop(columns=["X", "Y", "Z"]), maps, atlas)


def test_a_grid_of_another_brain_has_a_warning(caplog):
    """FSL's grid of MNI 152 at 2 mm, and an atlas that is stated to be of Colin 27."""
    affine = np.array([[-2, 0, 0, 90], [0, 2, 0, -126], [0, 0, 2, -72], [0, 0, 0, 1.0]])
    data = np.zeros((91, 109, 91), np.float32)
    data[30:34, 60:64, 40:44] = 5
    labels = np.zeros((181, 217, 181), np.uint8)
    labels[50:] = 1
    colin = conus.load(labels, np.array([[1, 0, 0, -90], [0, 1, 0, -125], [0, 0, 1, -71], [0, 0, 0, 1.0]]), labels={1: "One"})
    assert colin.brain == "Colin 27"
    table, maps = reporting.get_clusters_table(nibabel.Nifti1Image(data, affine), 3, return_label_maps=True)
    conus.nilearn.name_clusters(table, maps, colin)
    assert [record.getMessage() for record in caplog.records if "label_maps" in record.getMessage()] == [
        "label_maps: their grid is that of MNI 152, earlier than NLin2009, and the atlas is of Colin 27: areas lie elsewhere there, by some mm"]
