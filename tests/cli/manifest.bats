#!/usr/bin/env bats
# conus manifest, and manifests as atlases, as a user types it.
load helpers

# makes ARGUMENT...: conus manifest succeeds, whatever it says on stderr.
makes() {
    run -0 --separate-stderr "$CONUS" manifest "$@"
}

# said TEXT: the last run said TEXT on stderr.
said() {
    # shellcheck disable=SC2154 # bats sets stderr
    [[ "$stderr" == *"$1"* ]] || { echo "said: $stderr"; echo "wanted: $1"; return 1; }
}

@test "a folder becomes a scene" {
    mkdir scene
    conus phantom slabs -o scene --size 24
    conus phantom sphere -o other --size 24
    cp other/sphere.nii.gz scene/fornix.nii.gz # without its table: ones, mostly zero
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
    awk -F '\t' 'NR > 1 { print $11, $2 }' voxels.tsv | sort -u >met
    [ "$(cat met)" = "pathway fornix" ]
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
    answers info brain/brain.atlas.json --format tsv
    [ "$(grep -c ^area <<<"$output")" -eq 11 ]
    [ "$(grep -c ^pathway <<<"$output")" -eq 1 ]
    answers query --quiet brain/brain.atlas.json --origin 120,20,40 --toward 0,-18,10 --angle 30 --format tsv
    grep -qP '\tarea\t8\tLateral right\t' <<<"$output"
    grep -qP '\tpathway\t1\tArc\t' <<<"$output"
}

@test "surfaces in folders get labels of their own" {
    conus phantom brain -o brain
    mkdir -p set/left set/right
    cp brain/brain-0[13579]-*.gii set/left
    cp brain/brain-0[2468]-*.gii set/right
    mv set/right/brain-02-AntR.surf.gii set/right/anterior.surf.gii # one without a number
    makes set
    answers info set/set.atlas.json --format tsv
    [ "$(grep -c ^area <<<"$output")" -eq 9 ]
    [ "$(cut -f 2 <<<"$output" | sort | uniq -d | wc -l)" -eq 0 ]
}

@test "an empty folder and none at all are errors" {
    mkdir empty
    fails 3 'neither parcellation nor surfaces nor pathways in this folder' manifest empty
    fails 3 'nowhere: there is no such folder' manifest nowhere
    fails 2 'a name without / is needed' manifest empty --name a/b
}

# complaint TEXT JSON: info must refuse the manifest with exit code 3 and one line that holds TEXT.
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
