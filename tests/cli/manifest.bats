#!/usr/bin/env bats
# conus manifest, and manifests as atlases, as a user types it.
load helpers

# makes ARGUMENT...: asserts that conus manifest succeeds, whatever it prints on stderr.
makes() {
    run -0 --separate-stderr "$CONUS" manifest "$@"
}

# said TEXT: asserts that the last run printed TEXT on stderr.
said() {
    # shellcheck disable=SC2154 # bats sets stderr
    [[ "$stderr" == *"$1"* ]] || { echo "said: $stderr"; echo "wanted: $1"; return 1; }
}

@test "a folder that has only a manifest for an atlas is told so" {
    mkdir -p bundles/empty
    conus phantom bundle -o bundles
    fails 3 'bundles: no surfaces in this folder, but a manifest: bundles/bundle.atlas.json is the atlas' info bundles
    fails 3 'bundles: no surfaces in this folder, but a manifest: bundles/bundle.atlas.json is the atlas' info bundles/
    answers info bundles/bundle.atlas.json
    fails 3 'bundles/empty: no surfaces in this folder (or ' info bundles/empty
}

@test "a folder becomes a scene" {
    mkdir scene
    conus phantom slabs -o scene --size 24
    conus phantom sphere -o other --size 24
    cp other/sphere.nii.gz scene/fornix.nii.gz # without its table: mostly zero, otherwise one
    makes scene
    [ "$output" = scene/scene.atlas.json ]
    said 'slabs.nii.gz: parcellation, named by a label table'
    said 'fornix.nii.gz: pathway, mostly zero'
    answers info scene/scene.atlas.json
    has '2 areas (0 without a name, 0 without a shape), 1 pathway'
    has 'Pathway 1: fornix'
    answers query --quiet scene/scene.atlas.json --origin 0,60,0 --toward 0,0,0 --angle 30 --voxels voxels.tsv \
        --format tsv
    grep -q 'Slab anterior' <<<"$output"
    grep -q 'fornix' <<<"$output"
    awk -F '\t' 'NR > 1 { print $11, $2 }' voxels.tsv | sort -u >hit
    [ "$(cat hit)" = "pathway fornix" ]
}

@test "a transform in the folder is said, and left to the user" {
    conus phantom slabs -o scene --size 24
    printf '#Insight Transform File V1.0\n#Transform 0\nTransform: TranslationTransform_double_3_3\n%s\n%s\n' \
        'Parameters: -7 0 0' 'FixedParameters:' >scene/to_mni.tfm
    printf '1 0 0 7\n0 1 0 0\n0 0 1 0\n0 0 0 1\n' >scene/flirt.mat
    echo nonsense >scene/other.mat
    makes scene
    said 'to_mni.tfm: a transform, left out: where it leads is not known; "transform": "to_mni.tfm" in the manifest'
    said 'flirt.mat: a transform, left out'
    not grep -q other.mat <<<"$stderr"
    sed -i 's/"conus_atlas": 1,/& "transform": "to_mni.tfm",/' scene/scene.atlas.json
    answers info scene/scene.atlas.json --format json
    [ "$(jq '.moved.atlas_from_world[0][3]' <<<"$output")" = 7 ]
}

# An intent code of 1007 makes a field of ITK or SPM, 2006 one of fnirt; 2007 is of coefficients.
@test "deformation fields in the folder are no pathways" {
    conus phantom slabs -o scene --size 16
    for kind in itk spm rel abs; do
        python3 "$BATS_TEST_DIRNAME/fields.py" $kind scene/slabs.nii.gz scene/$kind.nii.gz 8
    done
    python3 - <<'END'
import gzip, struct
data = bytearray(gzip.open("scene/rel.nii.gz").read())
for code, name in ((2006, "fnirt"), (2007, "splines"), (2018, "topup")):
    data[68:70] = struct.pack("<h", code)
    gzip.open(f"scene/{name}.nii.gz", "wb").write(data)
END
    rm scene/rel.nii.gz scene/abs.nii.gz
    makes scene
    said 'itk.nii.gz: a deformation field of ITK or SPM, left out: where it leads is not known; "transform": "itk.nii.gz"'
    said 'spm.nii.gz: a deformation field of '
    said 'fnirt.nii.gz: a deformation field of fnirt, left out'
    said 'splines.nii.gz: coefficients of a field of fnirt, left out: it moves no areas'
    said 'topup.nii.gz: a field of topup, left out'
    answers info scene/scene.atlas.json
    has '2 areas (0 without a name, 0 without a shape), 0 pathways'
}

@test "parcellations on two grids are one atlas" {
    conus phantom slabs -o two --size 24
    conus phantom sphere -o two --size 40
    echo '{"conus_atlas": 1, "parcellations": ["slabs.nii.gz", {"file": "sphere.nii.gz", "label_offset": 1000}]}' \
        >two/two.atlas.json
    local ask=(query two/two.atlas.json --origin "0,60,0" --toward "0,0,0" --angle 40 --quiet)
    run -0 "$CONUS" info two/two.atlas.json
    has 'parcellations: 2 on 2 grids (slabs.nii.gz; sphere.nii.gz)'
    has 'labels       BIDS label table in slabs.tsv; BIDS label table in sphere.tsv'
    answers "${ask[@]}"
    grep -qx 'atlas two.atlas.json, placed by sform, code 1 (scanner)' <<<"$output"
    answers "${ask[@]}" --format afni
    has 'two            	48.'
    answers "${ask[@]}" --layers all --format tsv
    has 'Slab anterior'
    has 'Slab posterior'
    has 'Sphere'
    run -2 "$CONUS" "${ask[@]}" --mask all.nii.gz
    has 'the areas lie on 2 different grids, name one of them (--mask-object)'
    answers "${ask[@]}" --mask one.nii.gz --mask-object 1001
    run -2 "$CONUS" "${ask[@]}" --labels two/slabs.tsv
    has 'the manifest has 2 parcellations, it can say of each (labels)'
    run -3 "$CONUS" "${ask[@]}" --hemispheres split
    has 'split: the areas lie on 2 grids'
    # AFNI's rows have the manifest's name, so another name makes another answer.
    printf 'name\tx\ty\tz\tsize\nA1\t0\t9\t0\tn/a\n' >sub_electrodes.tsv
    cp two/two.atlas.json two/same.atlas.json
    for name in two same; do
        run -0 "$CONUS" batch two/$name.atlas.json --poses sub_electrodes.tsv --radius 2 --format afni -o $name.txt --quiet
        grep -q "^$name  " $name.txt
        grep -o '"fingerprint": *"[0-9a-f]*"' $name.txt.json >$name.print
    done
    run -1 cmp -s two.print same.print
    run -0 "$CONUS" render two/two.atlas.json --origin 0,60,10 --toward 0,0,0 --angle 40 --size 160x120 -o two.png
}

@test "a manifest that is there is never replaced" {
    mkdir scene
    conus phantom sphere -o scene --size 16
    conus manifest scene --quiet
    echo mine >scene/scene.atlas.json
    fails 3 'scene/scene.atlas.json: there is a file already, which is not replaced' manifest scene --quiet
    [ "$(cat scene/scene.atlas.json)" = mine ]
    answers manifest scene --name other --quiet
    [ "$output" = scene/other.atlas.json ]
    [ "$(ls scene | grep -c part)" -eq 0 ]
}

@test "surfaces, pathway and context of the brain phantom are found again" {
    conus phantom brain -o brain
    makes brain --name found
    said '*.surf.gii: 11 surfaces, labels above 0'
    said 'brain-context.nii.gz: context, values almost everywhere'
    said 'brain-pathway.nii.gz: pathway, mostly zero'
    answers info brain/found.atlas.json
    has '11, of them 11 closed; 234444 triangles'
    run -0 --separate-stderr "$CONUS" info brain/brain.atlas.json --format tsv
    [ "$(grep -c ^area <<<"$output")" -eq 11 ]
    [ "$(grep -c ^pathway <<<"$output")" -eq 1 ]
    answers query --quiet brain/brain.atlas.json --origin 120,20,40 --toward 0,-18,10 --angle 30 --format tsv
    grep -qP '\tarea\t8\tLateral right\t' <<<"$output"
    grep -qP '\tpathway\t1\tArc\t' <<<"$output"
}

@test "answers leave out a context that they do not need" {
    conus phantom brain -o brain
    local aim='--origin 120,20,40 --angle 30'
    conus query brain/brain.atlas.json $aim --toward 0,-18,10 -q -o out.tsv
    conus query brain/brain.atlas.json $aim --inward -q -o in.tsv
    sed 's/"transfer": "brain"/"blocks": 99999/' brain/brain.atlas.json >brain/blocks.atlas.json
    fails 3 'blocks from 99999 on' query brain/blocks.atlas.json $aim --toward 0,-18,10
    sed -i 's/99999/46000/' brain/blocks.atlas.json
    conus query brain/blocks.atlas.json $aim --toward 0,-18,10 -q -o blocked.tsv
    local roles='[.Atlas.volumes[].role] | join(" ")'
    [ "$(jq -r "$roles" out.json)" = pathway ]
    [ "$(jq -r "$roles" in.json)" = 'pathway context' ]
    [ "$(jq -r "$roles" blocked.json)" = 'pathway context' ]
    answers info brain/brain.atlas.json
    has 'answers      do not need it, without --inward or --atlas-transform'
    fails 2 'would overwrite the input brain/brain-context.nii.gz' query brain/brain.atlas.json $aim \
        --toward 0,-18,10 --force --format tsv -o brain/brain-context.nii.gz
    conus verify out.tsv # without the context
    conus render brain/brain.atlas.json --size 16x16 -q -o brain.png
}

@test "surfaces in folders get labels of their own" {
    conus phantom brain -o brain
    mkdir -p set/left set/right
    cp brain/brain-0[13579]-*.gii set/left
    cp brain/brain-0[2468]-*.gii set/right
    mv set/right/brain-02-AntR.surf.gii set/right/anterior.surf.gii # one has no number
    makes set
    run -0 --separate-stderr "$CONUS" info set/set.atlas.json --format tsv
    [ "$(grep -c ^area <<<"$output")" -eq 9 ]
    [ "$(cut -f 2 <<<"$output" | sort | uniq -d | wc -l)" -eq 0 ]
}

@test "an empty folder and none at all are errors" {
    mkdir empty
    fails 3 'neither parcellation nor surfaces, pathways or streamlines in this folder' manifest empty
    fails 3 'nowhere: there is no such folder' manifest nowhere
    fails 2 'a name without / is needed' manifest empty --name a/b
}

# complaint TEXT JSON: asserts that info refuses the manifest with exit code 3 and one line that has TEXT.
complaint() {
    printf '%s' "$2" >m.atlas.json
    fails 3 "m.atlas.json: $1" info m.atlas.json
}

@test "a mistake in a manifest is one line with its key" {
    sphere --size 16
    complaint 'line 1, column 18' '{"conus_atlas": 1,'
    complaint 'pathway: unknown key' '{"conus_atlas": 1, "pathway": []}'
    complaint 'parcellation: found "../a.nii"' '{"conus_atlas": 1, "parcellation": "../a.nii"}'
    complaint 'pathways[0].threshold: found 0' '{"conus_atlas": 1, "pathways": [{"file": "a", "threshold": 0}]}'
    complaint 'parcellation: ' '{"conus_atlas": 1, "parcellation": "missing.nii"}'
    complaint 'tree: label 1 lies below itself' \
        '{"conus_atlas": 1, "parcellation": "sphere.nii.gz", "tree": [{"label": 1, "parent": 1}]}'
}

@test "a half of an atlas is never dropped" {
    mkdir scene
    conus phantom slabs -o scene --size 24
    mv scene/slabs.nii.gz scene/left.nii.gz
    conus phantom nested -o scene --size 24
    fails 3 'scene/left.nii.gz and nested.nii.gz are both parcellations, and their names are not left and right of one' \
        manifest scene --quiet
    [ ! -e scene/scene.atlas.json ]
    mv scene/nested.nii.gz scene/right.nii.gz
    makes scene
    said 'right.nii.gz: left and right of one with left.nii.gz; its labels are 1000 further'
    cp scene/left.nii.gz scene/other.nii.gz
    rm scene/scene.atlas.json
    fails 3 'scene/left.nii.gz and other.nii.gz are both parcellations' manifest scene --quiet
}

@test "two FSL atlases of labels are refused, too" {
    mkdir scene
    conus phantom slabs -o scene --size 24
    rm scene/slabs.tsv
    for name in a b; do
        cp scene/slabs.nii.gz "scene/image$name.nii.gz"
        printf '<atlas><type>Label</type><images><imagefile>/image%s</imagefile></images>' $name >"scene/$name.xml"
        printf '<label index="1">one</label></atlas>' >>"scene/$name.xml"
    done
    rm scene/slabs.nii.gz
    fails 3 'scene/a.xml and b.xml are both parcellations' manifest scene --quiet
}

@test "what does not load is left out" {
    mkdir scene
    conus phantom slabs -o scene --size 24
    printf '<atlas><type>Label</type><images><imagefile>/gone</imagefile></images><label index="1">one</label></atlas>' \
        >scene/gone.xml
    printf '<atlas><type>Probabilistic</type><images><imagefile>/gone</imagefile></images>' >scene/gone2.xml
    printf '<label index="0">one</label></atlas>' >>scene/gone2.xml
    printf '<atlas version="2.0"><header><name>SPM</name></header><data><label><index>1</index></label></data></atlas>' \
        >scene/spm.xml
    printf '<?xml version="1.0"?><GIFTI Version="1.0" NumberOfDataArrays="0"></GIFTI>' >scene/lh.label.gii
    makes scene
    said 'gone.xml: left out, since it does not load'
    said 'gone2.xml: left out, since it does not load'
    said 'spm.xml: left out, since it does not load'
    said 'lh.label.gii: left out, since it does not load'
    said 'slabs.nii.gz: parcellation, named by a label table'
    run -0 --separate-stderr "$CONUS" info scene/scene.atlas.json
    has '2 areas'
}

@test "what is written of a folder of the shared data loads: of hostile ones and every fourth, of all in --long" {
    need_all
    local shared=${CONUS_SHARED_DATA:-$BATS_TEST_DIRNAME/../../../shared/data} loads=0 refused=0 folder step=4
    [ -z "${CONUS_TEST_LONG-}" ] || step=1
    [ -d "$shared" ] || skip "no shared data ($shared)"
    while read -r folder; do
        rm -rf copy
        mkdir copy
        ln -s "$folder"/* copy/ 2>/dev/null || true
        run --separate-stderr "$CONUS" manifest copy --quiet
        if [ "$status" -eq 0 ]; then
            run --separate-stderr "$CONUS" info copy/copy.atlas.json
            [ "$status" -eq 0 ] || { echo "$folder: $stderr"; return 1; }
            loads=$((loads + 1))
        else
            [ "$status" -eq 3 ]
            check_message copy/
            [[ "$stderr" == *'neither parcellation nor surfaces, pathways or streamlines in this folder' ||
                "$stderr" == *'are both parcellations'* ]] || { echo "$folder: $stderr"; return 1; }
            refused=$((refused + 1))
        fi
    done < <(find "$(realpath "$shared")" -type d | LC_ALL=C sort | awk -v step="$step" '/\/hostile/ || NR % step == 3 % step')
    echo "# $loads folders load, $refused are refused" >&3
    [ "$loads" -ge $((20 / step)) ]
}
