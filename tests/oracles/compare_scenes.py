#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""A BrainGlobe folder, FSL probabilistic atlases and FreeSurfer surfaces with annotations, as conus query names what it
hits: names, numbers and distances against readers that share nothing with conus.

compare_manifest.py, which has the search of every triangle and voxel, does the same with Julich-Brain. Here
structures.json is read by json, OBJ line by line, FSL's XML by ElementTree, volumes and annotations by nibabel.

usage: compare_scenes.py CONUS SHARED_DATA; exit 77 = skipped."""

import glob
import json
import os
import random
import sys
import tempfile
import xml.etree.ElementTree as tree

try:
    import nibabel
    import numpy as np
    from nibabel import freesurfer
except ImportError:
    print("skipped: no python3-nibabel")
    sys.exit(77)

from compare_manifest import RAYS, Scene, ask, check, read_gifti, read_obj


def brainglobe(folder):
    """Its finest structures that have a surface. Stored from the anterior, superior, right corner, in micrometres."""
    with open(os.path.join(folder, "structures.json"), encoding="utf-8") as file:
        structures = json.load(file)
    paths = {s["id"]: os.path.join(folder, "meshes", f"{s['id']}.obj") for s in structures}
    present = {s["id"] for s in structures if os.path.exists(paths[s["id"]])}
    above = {parent for s in structures if s["id"] in present for parent in s["structure_id_path"][:-1]}
    areas = []
    for structure in structures:
        if structure["id"] in present - above:
            stored, triangles = read_obj(paths[structure["id"]])
            areas.append(((structure["id"], structure["name"]), -stored[:, [2, 0, 1]] / 1000, triangles))
    return areas


def annotated(data):
    """Both hemispheres of fsaverage5, cut by the corners' majority; the right one's labels from 101 on."""
    areas = []
    for side, name, offset in (("lh", "left", 0), ("rh", "right", 100)):
        points, triangles = read_gifti(os.path.join(data, f"meshes/fsaverage5/pial_{name}.gii.gz"))
        labels, _, names = freesurfer.read_annot(os.path.join(data, f"meshes/fsaverage5/{side}.aparc.annot"))
        corners = labels[triangles]
        owner = np.where(corners[:, 1] == corners[:, 2], corners[:, 1], corners[:, 0])
        for label in np.unique(owner[owner > 0]):
            areas.append(((int(label) + offset, names[label].decode()), points, triangles[owner == label]))
    return areas


def fsl_pathways(xml, image):
    """(name, volume as a mask, voxel_from_world) of each label; values are percent."""
    picture = nibabel.load(image)
    values = np.asanyarray(picture.dataobj)
    inverse = np.linalg.inv(picture.affine)
    return [(label.text, values[..., int(label.get("index"))] >= 25, inverse)
            for label in tree.parse(xml).getroot().find("data").findall("label")]


def scene_of(areas, pathways):
    scene = Scene(areas or [((0, ""), np.zeros((3, 3)), np.array([[0, 1, 2]]))], [])
    scene.pathways = pathways
    return scene


def random_rays(areas, pathways, size):
    """From `size` mm away or a quarter of it, at vertices of surfaces and voxels of pathways, or a little beside."""
    generator = random.Random(4)
    goals = [points for _, points, _ in areas]
    goals += [nibabel.affines.apply_affine(np.linalg.inv(inverse), np.argwhere(mask)) for _, mask, inverse in pathways]
    goals = [points for points in goals if len(points)]
    rays = []
    for i in range(RAYS):
        way = np.array([generator.gauss(0, 1) for _ in range(3)])
        points = goals[generator.randrange(len(goals))]
        beside = [generator.uniform(-0.05, 0.05) * size for _ in range(3)]
        target = np.round(points[generator.randrange(len(points))] + beside, 3)
        rays.append((np.round(target + size * (1 if i % 3 else 0.25) * way / np.linalg.norm(way), 3), target))
    return rays


def compare(conus, what, manifest, areas, pathways, size):
    scene = scene_of(areas, pathways)
    rays = random_rays(areas, pathways, size)
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "scene.atlas.json")
        with open(path, "w", encoding="utf-8") as file:
            json.dump({"conus_atlas": 1, "allow_outside": True, **manifest}, file)
        answers = ask(conus, path, rays, folder)
    complaints, found_names, hits = [], set(), 0
    for number, (origin, target) in enumerate(rays, 1):
        found = scene.trace(origin, (target - origin) / np.linalg.norm(target - origin))
        complaints.append(check(answers.get(number), found, number))
        hits += bool(found)
        found_names |= {found[0][2]} if found else set()
    complaints = [c for c in complaints if c]
    print(f"{what}: {len(areas)} surfaces, {len(pathways)} pathways, {len(rays)} rays, {hits} hit one of "
          f"{len(found_names)} objects; {len(complaints)} differ")
    print("\n".join(complaints[:5]), end="\n" if complaints else "")
    assert hits > len(rays) / 3 and len(found_names) > 5, f"{what}: the rays hit too little"
    return bool(complaints)


def main():
    conus, data = sys.argv[1], os.environ.get("CONUS_SHARED_DATA", sys.argv[2])
    if not os.path.isdir(os.path.join(data, "meshes/fsaverage5")):
        print("skipped: no shared data")
        sys.exit(77)
    wrong = 0
    entries = [{"file": f"{data}/meshes/fsaverage5/pial_{name}.gii.gz", "hemisphere": side[0].upper(),
                "vertex_labels": f"{data}/meshes/fsaverage5/{side}.aparc.annot", "label_offset": offset}
               for side, name, offset in (("lh", "left", 0), ("rh", "right", 100))]
    wrong += compare(conus, "fsaverage5", {"areas": entries, "space": "ras"}, annotated(data), [], 160)
    for name, image in (("JHU-tracts", "JHU/JHU-ICBM-tracts-prob-1mm"), ("Thalamus", "Thalamus/Thalamus-prob-2mm")):
        xml = os.path.join(data, f"prob/fsl/atlases/{name}.xml")
        pathways = fsl_pathways(xml, os.path.join(data, f"prob/fsl/atlases/{image}.nii.gz"))
        wrong += compare(conus, name, {"pathways": [{"fsl": xml}], "threshold": 25}, [], pathways, 160)
    folder = glob.glob(os.path.join(data, "meshes/brainglobe-*"))[0]
    wrong += compare(conus, "BrainGlobe", {"areas": [{"brainglobe": folder}]}, brainglobe(folder), [], 12)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
