#!/usr/bin/env bats
# Atlases by name: the folder layouts of the programs that install atlases, the meaning of a name, and the limits of the
# list.
load helpers

# alone: uses nothing of this computer; each test makes its own folders.
alone() {
    local name
    for name in CONUS_ATLAS_PATH FSLDIR SUBJECTS_DIR FREESURFER_HOME TEMPLATEFLOW_HOME AFNI_ATLAS_PATH \
        AFNI_SUPP_ATLAS_DIR AFNI_PLUGINPATH SPM_DIR NILEARN_DATA NILEARN_SHARED_DATA MRICROGL_DIR XDG_DATA_HOME \
        XDG_CACHE_HOME BRAINGLOBE_CONFIG_DIR; do
        unset "$name"
    done
    export HOME=$PWD/home XDG_DATA_DIRS=$PWD/usr/share
    mkdir -p home usr/share
}

setup() {
    mkdir "$BATS_TEST_TMPDIR/work"
    cd "$BATS_TEST_TMPDIR/work" || return
    alone
}

# make_volumes: the volumes of the tests. l.nii(.gz): labels 1 and 2, two cubes; t1.nii.gz: an image; prob.nii.gz: two
# volumes of probabilities; aseg.mgz: labels 17 and 53.
make_volumes() {
    /usr/bin/python3 - "$@" <<'END'
import nibabel, numpy
labels = numpy.zeros((8, 8, 8), "u1")
labels[1:4, 2:6, 2:6], labels[4:7, 2:6, 2:6] = 1, 2
def save(name, data, edge=2, intent=None):
    image = nibabel.Nifti1Image(data, numpy.diag([edge, edge, edge, 1]))
    if intent:
        image.header.set_intent(intent)
    image.to_filename(name)
save("l.nii.gz", labels)
save("l.nii", labels)
save("fine.nii.gz", labels, 1)
save("marked.nii.gz", labels, 2, "label")
save("t1.nii.gz", numpy.arange(512, dtype="i2").reshape(8, 8, 8) * 7919 % 1000)
save("prob.nii.gz", numpy.stack([labels == 1, labels == 2], 3).astype("f4"))
nibabel.MGHImage((labels * 36 - 19 * (labels > 0)).astype("i4"), numpy.diag([1, 1, 1, 1])).to_filename("aseg.mgz")
END
}

# put FROM FILE...: copies of the volume.
put() {
    local from=$1 file
    shift
    for file; do
        mkdir -p "$(dirname "$file")"
        cp "$from" "$file"
    done
}

# write FILE TEXT
write() {
    mkdir -p "$(dirname "$1")"
    printf "$2" >"$1"
}

# listed: "source name" of each atlas, in the order of the list.
listed() {
    conus atlases --format tsv "$@" | tail -n +2 | awk -F'\t' '{ print $2, $1 }'
}

# lists LINE...: asserts that these are all, and that each loads under source:name as the file in the list.
lists() {
    local source name kind spacing path labels
    listed | diff - <(printf '%s\n' "$@")
    conus atlases --format tsv >list
    while IFS=$'\t' read -r name source kind spacing path labels; do
        [ "$source" != source ] || continue
        conus info "$source:$name" --format json >info
        jq -e --arg path "$path" --arg name "$name" --arg source "$source" '.installed.path == $path and
            .installed.name == $name and .installed.source == $source and (.objects | length) > 0' info
    done <list
}

# field NAME COLUMN: a cell of the atlas in the list.
field() {
    conus atlases --format tsv | awk -F'\t' -v name="$1" -v column="$2" '
        NR == 1 { for (i = 1; i <= NF; i++) if ($i == column) at = i } $1 == name { print $at }'
}

# fsl_xml FILE TYPE IMAGE...: an atlas XML of the labels "one" and "two" whose images these are; their first voxels are
# at (1, 2, 2) and (4, 2, 2).
fsl_xml() {
    local file=$1 type=$2 image
    shift 2
    mkdir -p "$(dirname "$file")"
    {
        echo "<atlas version=\"1.0\"><header><name>N</name><type>$type</type>"
        for image; do
            echo "<images><imagefile>/$image-prob</imagefile><summaryimagefile>/$image</summaryimagefile></images>"
        done
        echo '</header><data><label index="0" x="1" y="2" z="2">one</label>'
        echo '<label index="1" x="4" y="2" z="2">two</label></data></atlas>'
    } >"$file"
}

# Places

@test "mricron: labels are listed, images are not" {
    make_volumes
    local templates=usr/share/mricron/templates
    put marked.nii.gz $templates/brodmann.nii.gz $templates/jhu189.nii.gz
    put l.nii.gz $templates/aal.nii.gz
    write $templates/aal.nii.txt '1 one 10\n2 two 20\n'
    put t1.nii.gz $templates/ch2.nii.gz $templates/ch2bet.nii.gz
    lists "mricron aal" "mricron brodmann" "mricron jhu189"
    [ "$(field aal voxel_mm)" = 2 ]
    [ "$(field aal path)" = "$PWD/$templates/aal.nii.gz" ]
    # The user's own data folder comes before the system's.
    put marked.nii.gz home/.local/share/mricron/templates/mine.nii.gz
    lists "mricron mine" "mricron aal" "mricron brodmann" "mricron jhu189"
}

@test "CONUS_ATLAS_PATH: several folders, in their order, two deep" {
    make_volumes
    put l.nii.gz 'a b/my atlas.nii.gz' b/one/two/labels_2mm.nii.gz b/one/two/three/too_deep_atlas.nii.gz
    put l.nii b/pair_atlas.nii
    put t1.nii.gz b/sub-01_T1w.nii.gz
    write b/one/scene.atlas.json '{"conus_atlas": 1, "parcellation": "two/labels_2mm.nii.gz"}'
    export CONUS_ATLAS_PATH="$PWD/b::$PWD/a b:$PWD/none"
    lists "own pair_atlas" "own scene" "own labels_2mm" "own my atlas"
    [ "$(field scene kind)" = scene ]
}

@test "a context by the name of an image" {
    make_volumes
    put l.nii.gz b/labels_2mm.nii.gz
    put t1.nii.gz b/sub-01_T1w.nii.gz
    export CONUS_ATLAS_PATH="$PWD/b"
    aim='--origin 0,0,99 --toward 0,0,0 --context-blocks 0.5 -q'
    run -0 conus query labels_2mm $aim --context "$PWD/b/sub-01_T1w.nii.gz" -o path.tsv
    run -0 conus query labels_2mm $aim --context SUB-01.T1w -o name.tsv
    cmp path.tsv name.tsv
    run -0 conus verify name.tsv
    [ "$(jq -r '.Atlas.volumes[] | select(.role == "context") | .path' name.json)" = "$PWD/b/sub-01_T1w.nii.gz" ]
    # An image is no atlas, and an atlas no image; what is near is named.
    fails 3 "no installed image has that name; did you mean sub-01_T1w?" query labels_2mm $aim --context sub-02_T1w
    fails 3 "no installed image has that name" query labels_2mm $aim --context labels_2mm
    fails 3 "no installed atlas has that name" info sub-01_T1w
    # Moved, it is found by its sum, as an atlas is.
    mkdir -p elsewhere && mv b/*.nii.gz elsewhere/
    unset CONUS_ATLAS_PATH
    run -0 conus verify name.tsv --folder elsewhere
    has identical
    # Two images of one name: both are shown.
    put t1.nii.gz b/sub-01_T1w.nii.gz c/sub-01_T1w.nii.gz
    put l.nii.gz b/labels_2mm.nii.gz
    export CONUS_ATLAS_PATH="$PWD/b:$PWD/c"
    fails 2 "2 images have that name" query labels_2mm $aim --context sub-01_T1w
}

@test "FSL: the labelled volumes of an XML, the finest under its name" {
    make_volumes
    export FSLDIR=$PWD/fsl
    local atlases=fsl/data/atlases
    fsl_xml $atlases/HarvardOxford-Cortical.xml Probabilistic \
        HarvardOxford/HarvardOxford-cort-maxprob-thr25-2mm HarvardOxford/HarvardOxford-cort-maxprob-thr25-1mm
    put l.nii.gz $atlases/HarvardOxford/HarvardOxford-cort-maxprob-thr25-2mm.nii.gz \
        $atlases/HarvardOxford/HarvardOxford-cort-maxprob-thr0-2mm.nii.gz
    put fine.nii.gz $atlases/HarvardOxford/HarvardOxford-cort-maxprob-thr25-1mm.nii.gz
    put prob.nii.gz $atlases/HarvardOxford/HarvardOxford-cort-maxprob-thr25-2mm-prob.nii.gz
    fsl_xml $atlases/JHU-labels.xml Label JHU/JHU-ICBM-labels-1mm
    sed -i 's/-prob</</' $atlases/JHU-labels.xml
    put fine.nii.gz $atlases/JHU/JHU-ICBM-labels-1mm.nii.gz
    put t1.nii.gz $atlases/JHU/JHU-ICBM-T1-1mm.nii.gz
    lists "fsl HarvardOxford-Cortical" "fsl HarvardOxford-Cortical-2mm" "fsl HarvardOxford-Cortical-prob" "fsl JHU-labels" \
        "fsl HarvardOxford-cort-maxprob-thr0-2mm"
    [ "$(field HarvardOxford-Cortical voxel_mm)" = 1 ]
    [ "$(field HarvardOxford-Cortical-2mm voxel_mm)" = 2 ]
    # The areas have the XML's names; words in the atlas's name may be separated otherwise.
    conus info fsl:harvard-oxford-cortical --format tsv | cut -f 3 | xargs | grep -qx 'name one two'
    # The XML itself lists the areas as probabilities.
    [ "$(field HarvardOxford-Cortical-prob kind)" = probabilities ]
    conus info harvard-oxford-cortical-prob --format json >json
    jq -e '[.objects[].name] == ["one", "two"] and .volumes[0].role == "probability"' json
    # A volume named in an XML has a name of its own, too.
    conus info HarvardOxford-cort-maxprob-thr25-2mm --format json >json
    jq -e '.installed.name == "HarvardOxford-Cortical-2mm"' json
}

@test "FSL: an XML whose volumes are not there is a note" {
    export FSLDIR=$PWD/fsl
    fsl_xml fsl/data/atlases/Gone.xml Probabilistic Gone/Gone-1mm
    run -0 --separate-stderr conus atlases --format names
    [ -z "$output" ]
    check_message 'note: fsl: '"$PWD"'/fsl/data/atlases/Gone.xml: none of the volumes that it names is there'
    answers atlases --format names --quiet
}

@test "FreeSurfer: segmentations with its table, annotations on the pial surface" {
    make_volumes
    export FREESURFER_HOME=$PWD/freesurfer SUBJECTS_DIR=$PWD/subjects
    write freesurfer/FreeSurferColorLUT.txt \
        '#No. Label Name: R G B A\n17 Left-Hippocampus 220 216 20 0\n53 Right-Hippocampus 220 216 20 0\n'
    put aseg.mgz subjects/sub-01/mri/aseg.mgz subjects/sub-01/mri/aparc+aseg.mgz subjects/sub-01/mri/T1.mgz \
        freesurfer/subjects/fsaverage/mri/aseg.mgz
    mkdir -p subjects/sub-01/{surf,label}
    /usr/bin/python3 - <<'END'
import nibabel.freesurfer as fs, numpy
corners = numpy.array([[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]], float)
points = numpy.vstack([corners, corners + 20])
faces = numpy.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
faces = numpy.vstack([faces, faces + 4])
for side in "lr":
    fs.write_geometry(f"subjects/sub-01/surf/{side}h.pial", points, faces)
    fs.write_geometry(f"subjects/sub-01/surf/{side}h.white", points, faces)
    for name in ("aparc", "aparc.a2009s"):
        fs.write_annot(f"subjects/sub-01/label/{side}h.{name}.annot", numpy.repeat([1, 2], 4),
                       numpy.array([[1, 1, 1, 0], [25, 5, 25, 0], [50, 60, 70, 0]]),
                       [b"unknown", b"bankssts", b"cuneus"], fill_ctab=True)
END
    lists "freesurfer sub-01.aparc+aseg" "freesurfer sub-01.aseg" "freesurfer sub-01.lh.aparc.a2009s" \
        "freesurfer sub-01.lh.aparc" "freesurfer sub-01.rh.aparc.a2009s" "freesurfer sub-01.rh.aparc" \
        "freesurfer fsaverage.aseg"
    conus info sub-01.aseg --format tsv | cut -f 3 | xargs | grep -qx 'name Left-Hippocampus Right-Hippocampus'
    conus info sub-01.lh.aparc --format tsv | cut -f 3 | xargs | grep -qx 'name bankssts cuneus'
    [ "$(field sub-01.lh.aparc path)" = "$PWD/subjects/sub-01/surf/lh.pial" ]
    [ "$(field sub-01.lh.aparc kind)" = surface ]
    # --labels on the command line replaces those of the list.
    write own.txt '17 mine\n53 yours\n'
    conus info sub-01.aseg --labels own.txt --format tsv | cut -f 3 | xargs | grep -qx 'name mine yours'
}

@test "BrainGlobe: folders, with and without their version" {
    local atlas=home/.brainglobe/example_mouse_100um_v1.2
    write $atlas/metadata.json '{"orientation": "asr", "resolution": [100, 100, 100]}'
    write $atlas/structures.json '[{"acronym": "root", "id": 997, "name": "root", "structure_id_path": [997],
        "rgb_triplet": [255, 255, 255]}, {"acronym": "A", "id": 8, "name": "area", "structure_id_path": [997, 8],
        "rgb_triplet": [1, 2, 3]}]'
    write $atlas/meshes/8.obj 'v 0 0 0\nv 900 0 0\nv 0 900 0\nv 0 0 900\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n'
    write home/.brainglobe/last_versions.conf '[atlases]\n'
    lists "brainglobe example_mouse_100um_v1.2"
    conus info example_mouse_100um --format json >json
    jq -e '.installed.name == "example_mouse_100um_v1.2"' json
    # With two versions the name alone means neither.
    cp -r $atlas home/.brainglobe/example_mouse_100um_v1.10
    fails 2 'example_mouse_100um: 2 atlases have that name' info example_mouse_100um
}

# third FOLDER VERSION [NAME]: an atlas of BrainGlobe's third release of 2 x 2 x 2 voxels, of which half are of area 8,
# in the folder brainglobe-atlasapi of FOLDER.
third() {
    local root=$1/brainglobe-atlasapi version=$2 name=${3:-toy_mouse}
    local store=$root/annotation-sets/$name/$version/annotations_compressed.ome.zarr
    write "$root/atlases/${name}_1000um/$version/manifest.json" '{"name": "'"$name"'", "resolution": [1000, 1000, 1000],
        "shape": [2, 2, 2], "orientation": "asr", "citation": "Someone 2026", "atlas_link": "https://example.org/toy",
        "annotation_set": {"location": "/annotation-sets/'"$name/$version"'"},
        "terminology": {"location": "/terminologies/'"$name/$version"'"}}'
    write "$root/terminologies/$name/$version/terminology.csv" \
        'identifier,parent_identifier,annotation_value,name\n997,,997,root\n8,997,8,area of '"$version"'\n'
    write "$store/zarr.json" '{"attributes": {"ome": {"multiscales": [{"axes": [{"unit": "millimeter"},
        {"unit": "millimeter"}, {"unit": "millimeter"}], "datasets": [{"path": "s0", "coordinateTransformations":
        [{"type": "scale", "scale": [1, 1, 1]}]}]}]}}}'
    write "$store/s0/zarr.json" '{"zarr_format": 3, "node_type": "array", "attributes": {}, "shape": [2, 2, 2],
        "data_type": "uint8", "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": [2, 2, 2]}},
        "chunk_key_encoding": {"name": "default"}, "fill_value": 0, "codecs": [{"name": "bytes"}]}'
    write "$store/s0/c/0/0/0" '\010\010\010\010\0\0\0\0'
}

@test "BrainGlobe's third release: the newest version, others by their number, and the folder of its settings" {
    third home/.brainglobe 1_0
    third home/.brainglobe 1_9
    third home/.brainglobe 1_10
    lists "brainglobe toy_mouse_1000um" "brainglobe toy_mouse_1000um_v1.9" "brainglobe toy_mouse_1000um_v1.0"
    conus atlases --format tsv | grep -qP '^toy_mouse_1000um\tbrainglobe\tvolume\t1\t.*/atlases/toy_mouse_1000um/1_10'
    conus info toy_mouse_1000um --format tsv | grep -q 'area of 1_10'
    conus info toy_mouse_1000um_v1.10 --format tsv | grep -q 'area of 1_10'
    conus info toy_mouse_1000um_v1.9 --format tsv | grep -q 'area of 1_9'
    conus query toy_mouse_1000um --origin=-1,9,-1 --toward=-1,0,-1 --angle 5 | grep -q '^atlas toy_mouse_1000um/1_10, placed'
    conus cite toy_mouse_1000um >cited
    grep -q 'Someone 2026' cited
    grep -q 'https://example.org/toy' cited
    # BrainGlobe's folder may be set in bg_config.conf; its section [default_dirs] counts.
    third elsewhere 1_1 other
    write settings/bg_config.conf "[x]\nbrainglobe_dir = /nowhere\n[default_dirs]\nbrainglobe_dir = $PWD/elsewhere\n"
    BRAINGLOBE_CONFIG_DIR=$PWD/settings conus info other_1000um --format tsv | grep -q 'area of 1_1'
    write home/.config/brainglobe/bg_config.conf "[default_dirs]\nbrainglobe_dir : ~/../elsewhere\n"
    conus info other_1000um --format tsv | grep -q 'area of 1_1'
}

@test "BrainGlobe's third release: an annotation that was not downloaded is no empty brain" {
    third home/.brainglobe 1_0
    rm -r home/.brainglobe/brainglobe-atlasapi/annotation-sets/toy_mouse/1_0/*/s0/c
    fails 3 'the annotation of 1000 micrometres was not downloaded; python3 -c' info toy_mouse_1000um
    rm -r home/.brainglobe/brainglobe-atlasapi/annotation-sets
    fails 3 'the annotation of 1000 micrometres was not downloaded; python3 -c' info toy_mouse_1000um
    # A manifest.json of another program is no atlas.
    write web/manifest.json '{"name": "page"}'
    fails 3 'no surfaces in this folder' info web
}

@test "TemplateFlow: segmentations that were fetched" {
    make_volumes
    local cache=home/.cache/templateflow
    local mni=$cache/tpl-MNI152NLin2009cAsym/tpl-MNI152NLin2009cAsym_res-02
    put l.nii.gz "${mni}_atlas-Schaefer2018_desc-100Parcels7Networks_dseg.nii.gz" \
        $cache/tpl-MNIInfant/cohort-1/tpl-MNIInfant_cohort-1_res-1_dseg.nii.gz
    write $cache/tpl-MNI152NLin2009cAsym/tpl-MNI152NLin2009cAsym_atlas-Schaefer2018_desc-100Parcels7Networks_dseg.tsv \
        'index\tname\n1\tone\n2\ttwo\n'
    put t1.nii.gz "${mni}_T1w.nii.gz" "${mni}_label-GM_probseg.nii.gz" "${mni}_desc-brain_mask.nii.gz"
    # A file that was not fetched yet is empty.
    : >"${mni}_atlas-HOCPA_desc-th25_dseg.nii.gz"
    # datalad links to fetched files, and keeps equal files once.
    put l.nii.gz $cache/.git/annex/objects/content
    for cohort in 2 3; do
        mkdir $cache/tpl-MNIInfant/cohort-$cohort
        ln -s ../../.git/annex/objects/content \
            $cache/tpl-MNIInfant/cohort-$cohort/tpl-MNIInfant_cohort-${cohort}_res-1_dseg.nii.gz
    done
    ln -s ../../.git/annex/objects/missing $cache/tpl-MNIInfant/cohort-3/tpl-MNIInfant_cohort-3_res-2_dseg.nii.gz
    lists "templateflow tpl-MNI152NLin2009cAsym_res-02_atlas-Schaefer2018_desc-100Parcels7Networks" \
        "templateflow tpl-MNIInfant_cohort-1_res-1" "templateflow tpl-MNIInfant_cohort-2_res-1" \
        "templateflow tpl-MNIInfant_cohort-3_res-1"
    conus info tpl-MNI152NLin2009cAsym_res-02_atlas-Schaefer2018_desc-100Parcels7Networks --format tsv | cut -f 3 |
        xargs | grep -qx 'name one two'
    export TEMPLATEFLOW_HOME=$PWD/elsewhere
    mv $cache elsewhere
    listed | grep -qx 'templateflow tpl-MNIInfant_cohort-1_res-1'
}

@test "AFNI: volumes with its label tables, in its variables' folders and beside the program" {
    make_volumes
    /usr/bin/python3 - <<'END'
import nibabel
table = b"""<?xml version='1.0' ?><AFNI_attributes><AFNI_atr ni_type="String" atr_name="VALUE_LABEL_DTABLE">
"&lt;VALUE_LABEL_DTABLE
 ni_type=&quot;2*String&quot;
 ni_dimen=&quot;2&quot; &gt;
&quot;1&quot; &quot;one&quot;
&quot;2&quot; &quot;two&quot;
&lt;/VALUE_LABEL_DTABLE&gt;"</AFNI_atr></AFNI_attributes>"""
image = nibabel.load("l.nii.gz")
image.header.extensions.append(nibabel.nifti1.Nifti1Extension(4, table))
image.to_filename("afni.nii.gz")
END
    put afni.nii.gz abin/FS.afni.TTN27.nii.gz
    put t1.nii.gz abin/MNI152_2009_template.nii.gz
    put marked.nii.gz more/mine.nii.gz usr/share/afni/atlases/theirs.nii.gz
    write abin/afni '#!/bin/sh\n'
    chmod +x abin/afni
    mkdir bin
    ln -s ../abin/afni bin/afni
    export AFNI_ATLAS_PATH=$PWD/more
    PATH=$PWD/bin:$PATH lists "afni mine" "afni FS.afni.TTN27" "afni theirs"
    lists "afni mine" "afni theirs"
    AFNI_PLUGINPATH=$PWD/abin lists "afni mine" "afni FS.afni.TTN27" "afni theirs"
}

@test "SPM and CAT12: volumes with a table beside them" {
    make_volumes
    export SPM_DIR=$PWD/spm12
    put l.nii spm12/tpm/labels_Neuromorphometrics.nii spm12/toolbox/AAL3/AAL3v1.nii \
        spm12/toolbox/cat12/templates_MNI152NLin2009cAsym/cobra.nii
    put prob.nii.gz spm12/tpm/TPM.nii.gz
    write spm12/tpm/labels_Neuromorphometrics.xml '<?xml version="1.0"?><atlas version="1.0"><header><name>N</name>
        <type>Label</type></header><data><label><index>1</index><name>one</name></label></data></atlas>'
    write spm12/toolbox/AAL3/AAL3v1.nii.txt '1 one 10\n2 two 20\n'
    write spm12/toolbox/cat12/templates_MNI152NLin2009cAsym/cobra.csv 'ROIid;ROIabbr;ROIname\n1;A;one\n2;B;two\n'
    put t1.nii.gz spm12/toolbox/cat12/templates_MNI152NLin2009cAsym/Template_T1.nii.gz
    lists "spm labels_Neuromorphometrics" "spm AAL3v1" "cat12 cobra"
}

@test "nilearn: what its fetchers leave" {
    make_volumes
    local data=home/nilearn_data
    put l.nii.gz $data/schaefer_2018/Schaefer2018_100Parcels_7Networks_order_FSLMNI152_1mm.nii.gz \
        $data/yeo_2011/Yeo_JNeurophysiol11_MNI152/Yeo2011_7Networks_MNI152_FreeSurferConformed1mm.nii.gz \
        $data/destrieux_2009/destrieux2009_rois_lateralized.nii.gz \
        $data/fsl/data/atlases/HarvardOxford/HarvardOxford-cort-maxprob-thr25-2mm.nii.gz
    put l.nii $data/aal_SPM12/aal/atlas/AAL.nii
    put prob.nii.gz $data/difumo_atlases/64/3mm/maps.nii.gz
    put t1.nii.gz $data/icbm152_2009/mni_icbm152_nlin_sym_09a/mni_icbm152_t1_tal_nlin_sym_09a.nii.gz
    fsl_xml $data/fsl/data/atlases/HarvardOxford-Cortical.xml Probabilistic \
        HarvardOxford/HarvardOxford-cort-maxprob-thr25-2mm
    lists "nilearn AAL" "nilearn destrieux2009_rois_lateralized" "nilearn HarvardOxford-Cortical" \
        "nilearn Schaefer2018_100Parcels_7Networks_order_FSLMNI152_1mm" \
        "nilearn Yeo2011_7Networks_MNI152_FreeSurferConformed1mm"
    mv home/nilearn_data data
    NILEARN_DATA=$PWD/data listed | grep -qx 'nilearn AAL'
    NILEARN_SHARED_DATA=$PWD/data listed | grep -qx 'nilearn AAL'
}

@test "MRIcroGL: its atlas folder" {
    make_volumes
    put marked.nii.gz gl/Resources/atlas/natbrainlab.nii.gz
    MRICROGL_DIR=$PWD/gl lists "mricrogl natbrainlab"
    MRICROGL_DIR=$PWD/gl/Resources lists "mricrogl natbrainlab"
    write gl/MRIcroGL '#!/bin/sh\n'
    chmod +x gl/MRIcroGL
    PATH=$PWD/gl:$PATH lists "mricrogl natbrainlab"
    mkdir usr/share/MRIcroGL
    mv gl/Resources usr/share/MRIcroGL
    lists "mricrogl natbrainlab"
}

# Names

# two_places: mricron:aal and own:aal, with a voxel of difference, and mricron:brodmann.
two_places() {
    make_volumes
    put marked.nii.gz usr/share/mricron/templates/aal.nii.gz usr/share/mricron/templates/brodmann.nii.gz
    put fine.nii.gz own/aal.nii.gz
    export CONUS_ATLAS_PATH=$PWD/own
}

# bats test_tags=main
@test "a path comes first" {
    two_places
    put l.nii.gz brodmann
    conus info brodmann --format json >json
    jq -e '.installed == null and .volumes[0].path == "brodmann"' json
    rm brodmann
    conus info brodmann --format json >json
    jq -e '.installed.source == "mricron"' json
    # A text with a slash is never a name.
    fails 3 './brodmann: cannot open: No such file or directory' info ./brodmann
    put l.nii.gz brodmann.nii.gz
    conus info brodmann.nii.gz,volume=0 --format json >json
    jq -e '.installed == null' json
}

# bats test_tags=main
@test "an ambiguous name is an error with the candidates" {
    two_places
    fails 2 "aal: 2 atlases have that name: own:aal ($PWD/own/aal.nii.gz), mricron:aal" info aal
    check_message 'give one with its source, or a path'
    conus info own:aal --format json >json
    jq -e '.volumes[0].spacing_mm[0] == 1' json
    conus info mricron:aal --format json >json
    jq -e '.volumes[0].spacing_mm[0] == 2' json
    conus info MRICRON:AAL --format json >json
    jq -e '.volumes[0].spacing_mm[0] == 2' json
    [ "$(conus atlases --format names | xargs)" = "own:aal mricron:aal brodmann" ]
    # One file that is found in two ways is not ambiguous.
    rm own/aal.nii.gz
    ln -s ../usr/share/mricron/templates/aal.nii.gz own/aal.nii.gz
    conus info aal --format json >json
    jq -e '.installed.source == "own"' json
    # Two files of one source can be told apart by their paths only.
    put l.nii own/deeper/aal.nii
    fails 2 'give the path of one' info own:aal
}

# bats test_tags=main
@test "an unknown name is an error that suggests others" {
    two_places
    fails 3 "brodman: cannot open: No such file or directory, and no installed atlas has that name ('conus atlases'" \
        info brodman
    check_message 'did you mean brodmann?'
    fails 3 'did you mean aal?' info mricron:aall
    fails 3 "did you mean aal?" info aal3v1
    fails 3 "lists them)" info nothing-like-it
    not grep -q 'did you mean' <<<"$stderr"
    # Control characters of the command line are not printed.
    run -3 --separate-stderr "$CONUS" info $'x\e[31m'
    not grep -q $'\e' <<<"$stderr"
}

# bats test_tags=main
@test "a name stands for ATLAS in every command" {
    make_volumes
    put marked.nii.gz usr/share/mricron/templates/cubes.nii.gz
    local aim="--origin=7,7,-60 --toward=7,7,7 --angle 20"
    printf 'x\ty\tz\ttx\tty\ttz\ttime_s\n7\t7\t-60\t7\t7\t7\t0\n' >poses.tsv
    # shellcheck disable=SC2086
    {
        conus query cubes $aim --format tsv | diff - <(conus query marked.nii.gz $aim --format tsv)
        conus sweep cubes $aim --format tsv | diff - <(conus sweep marked.nii.gz $aim --format tsv)
    }
    conus batch cubes --poses poses.tsv -o a.tsv -q
    conus batch marked.nii.gz --poses poses.tsv -o b.tsv -q
    diff a.tsv b.tsv
    conus track cubes --poses poses.tsv --format tsv >a.tsv
    conus track marked.nii.gz --poses poses.tsv --format tsv | diff - a.tsv
    jq -e --arg path "$PWD/usr/share/mricron/templates/cubes.nii.gz" '[.. | strings] | any(. == $path)' \
        <(conus query cubes --origin=7,7,-60 --toward=7,7,7 --format json)
}

# The list

@test "an empty list says where it looked" {
    answers atlases
    has 'no atlas was found in any of these places'
    has '$FSLDIR/data/atlases'
    has "$PWD/usr/share/mricron/templates"
    [ "$(conus atlases --format tsv | wc -l)" -eq 1 ]
    [ -z "$(conus atlases --format names)" ]
    conus atlases --places --format tsv | grep -qxP "mricron\t\\\$XDG_DATA_DIRS/mricron/templates\t$PWD/usr/share/mricron/templates\tno such folder"
    conus atlases --places --format tsv | grep -qxP 'fsl\t\$FSLDIR/data/atlases\tn/a\tnot set'
    conus atlases --format json >json
    jq -e '.atlases == [] and (.places | any(.place == "$HOME/.brainglobe")) and .notes == []' json
    fails 2 '--places is for --format table and tsv' atlases --places --format json
}

# bats test_tags=main
@test "the list as a table and as JSON" {
    make_volumes
    put marked.nii.gz usr/share/mricron/templates/cubes.nii.gz
    answers atlases
    has "  cubes  mricron  volume         2  $PWD/usr/share/mricron/templates/cubes.nii.gz"
    has '1 atlas; a name, or source:name, may stand for ATLAS in every command'
    conus atlases --format json >list
    jq -e --arg path "$PWD/usr/share/mricron/templates/cubes.nii.gz" '.atlases == [{"name": "cubes", "source": "mricron",
        "kind": "volume", "voxel_mm": [2, 2, 2], "labels": null, "path": $path}]' list
    answers info cubes
    has "Installed atlas
  name         mricron:cubes
  file         $PWD/usr/share/mricron/templates/cubes.nii.gz
"
}

@test "names and paths cannot steer a terminal or break a line" {
    make_volumes
    put l.nii.gz $'own/\e]0;x\a_atlas.nii.gz' $'own/tab\tand\nline_atlas.nii.gz' $'own/\xff_atlas.nii.gz'
    export CONUS_ATLAS_PATH=$PWD/own
    for format in table tsv json names; do
        conus atlases --format $format >list
        not grep -qP '[\x00-\x08\x0b-\x1f\x7f]' list
        iconv -f UTF-8 -t UTF-8 list >/dev/null
    done
    [ "$(conus atlases --format tsv | wc -l)" -eq 4 ]
    [ "$(conus atlases --format tsv | awk -F'\t' '{ print NF }' | sort -u)" = 6 ]
    # Each name that is shown can be found.
    conus atlases --format names | while IFS= read -r name; do
        conus info "$name" --format tsv >/dev/null
    done
}

@test "links that lead around in circles, other kinds of files and damaged ones" {
    make_volumes
    put l.nii.gz own/a_atlas.nii.gz
    ln -s . own/loop
    ln -s ../own own/up
    ln -s nowhere own/dead_atlas.nii.gz
    mkfifo own/pipe_atlas.nii.gz
    mkdir own/folder_atlas.nii.gz
    head -c 100 l.nii >own/cut_atlas.nii
    printf '\x1f\x8b\x08' >own/cut_atlas.nii.gz
    write own/broken.xml '<atlas><header>'
    : >own/empty.atlas.json
    put prob.nii.gz own/prob_atlas.nii.gz
    export CONUS_ATLAS_PATH=$PWD/own
    lists "own a_atlas"
    [ -z "$(conus atlases -q --format names 2>&1 | grep -v a_atlas)" ]
}

@test "huge folders end with a note" {
    make_volumes
    mkdir own
    (cd own && seq -f 'x%g' 1 4100 | xargs touch)
    put l.nii.gz own/a_atlas.nii.gz
    export CONUS_ATLAS_PATH=$PWD/own
    run -0 --separate-stderr "$CONUS" atlases --format names
    check_message "note: own: $PWD/own: more than 4096 names: the others are left out"
}

@test "a folder that cannot be read is a note" {
    make_volumes
    put l.nii.gz own/closed/b_atlas.nii.gz own/a_atlas.nii.gz
    export CONUS_ATLAS_PATH=$PWD/own
    chmod 0 own/closed
    local plainly=()
    if [ -r own/closed ]; then # root can read it all the same
        plainly=(setpriv --bounding-set "-dac_override,-dac_read_search")
    fi
    if "${plainly[@]}" test -r own/closed; then
        chmod 700 own/closed
        skip "this user may read everything"
    fi
    run -0 --separate-stderr "${plainly[@]}" "$CONUS" atlases --format names
    chmod 700 own/closed
    [ "$output" = a_atlas ]
    check_message "note: own: $PWD/own/closed: cannot read this folder: Permission denied"
}

# bats test_tags=main
@test "AAL of mricron-data has a name" {
    need_aal
    XDG_DATA_DIRS=${TEMPLATES%/mricron/templates}
    conus query aal --origin=-90,20,20 --toward=0,-10,10 --angle 20 >named
    conus query "$aal" --origin=-90,20,20 --toward=0,-10,10 --angle 20 | diff - named
    not grep -q ch2 <(conus atlases)
}
