#!/usr/bin/env bats
# --pathway FILE,band=LOW:HIGH:NAME: several objects of one scalar volume, as a user types them.
load helpers

# ramp.nii: 8 x 8 x 12 voxels of 1 mm, uint8, the middle of the grid at the origin; value = 10 k, 0 to 110.
ramp() {
    command -v python3 >/dev/null || skip 'no python3'
    PYTHONPATH="$BATS_TEST_DIRNAME" python3 -B -c 'import nifti; nifti.write("ramp.nii", (8, 8, 12), "B", lambda i, j, k: 10 * k)'
    conus phantom sphere -o . --size 16
    printf '%s' '{"conus_atlas": 1, "pathways": [{"file": "ramp.nii", "bands": [
        {"name": "High", "low": 80}, {"name": "Low", "low": 20, "high": 50}, {"name": "Middle", "low": 50, "high": 80}
        ]}]}' >ramp.atlas.json
}
AIM='--origin 0.2,0.3,-40 --toward 0.2,0.3,0 --radius 1 --quiet'

@test "bands are pathways: the voxels, the first hits, the paths of a ray along the ramp" {
    ramp
    # Values 20, 30, 40 are Low: three planes of 64 voxels, from z = 2 - 6 = -4 on, 36 mm from the apex; and so on.
    answers query ramp.atlas.json $AIM --layers all -o rows.tsv
    [ "$(cut -f 4,5,7 rows.tsv | tail -n +2 | wc -l)" -eq 4 ]
    row() { awk -F '\t' -v name="$1" 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i }
        $at["name"] == name { print $at["kind"], $at["index"], $at["share"], $at["entry_mm"], $at["path_mm"] }' rows.tsv; }
    [ "$(row Low)" = 'pathway 2 1 36 3' ]
    [ "$(row Middle)" = 'pathway 3 0 39 3' ]
    [ "$(row High)" = 'pathway 1 0 42 4' ]
    gl query ramp.atlas.json $AIM --layers all --engine gl -o gl.tsv
    cmp rows.tsv gl.tsv
}

@test "one option, several options and a manifest give the same, and the file is read once" {
    ramp
    answers query ramp.atlas.json $AIM -o wanted.tsv
    local low=band=20:50:Low middle=band=50:80:Middle high=band=80::High
    answers query sphere.nii.gz --only Low,Middle,High $AIM --pathway "ramp.nii,$high,$low,$middle" -o one.tsv
    cmp one.tsv wanted.tsv
    answers query sphere.nii.gz --only Low,Middle,High $AIM --pathway "ramp.nii,$high" --pathway "ramp.nii,$low" \
        --pathway "ramp.nii,$middle" -o three.tsv
    cmp three.tsv wanted.tsv
    run -0 --separate-stderr "$CONUS" info sphere.nii.gz --pathway "ramp.nii,$high" --pathway "ramp.nii,$low,$middle"
    [ "$(grep -c '^  file ' <<<"$output")" -eq 2 ]
    has 'Pathway 2: Low'
    has '  band         from 20 to below 50, 192 voxels'
    has '  band         from 80 on, 256 voxels'
}

@test "the bands are reported: below the table, in JSON, in sidecars" {
    ramp
    answers query ramp.atlas.json --origin 0.2,0.3,-40 --toward 0.2,0.3,0
    has 'bands of ramp.nii: High from 80 on, Low from 20 to below 50, Middle from 50 to below 80'
    answers query ramp.atlas.json $AIM -o rows.tsv
    tr -d ' \n' <rows.json | grep -qF '"bands":[{"name":"High","low":80.0,"high":null},{"name":"Low","low":20.0,"high":50.0}'
    run -0 "$CONUS" info ramp.atlas.json --format json
    tr -d ' \n' <<<"$output" | grep -qF '"bands":[{"name":"High","low":80,"high":null}'
}

@test "a threshold stays what it was, also of a file that has bands" {
    ramp
    answers query sphere.nii.gz --only ramp $AIM --pathway ramp.nii,threshold=50 --pathway ramp.nii,band=0:50:Low \
        --format tsv
    [ "$(cell name 1)/$(cell distance_mm 1)" = ramp/39 ]
}

@test "a band is hidden and shown by its name, drawn in a mask, and sampled by slices" {
    ramp
    answers query ramp.atlas.json $AIM --hide Low --format tsv
    [ "$(cell name 1)" = Middle ]
    answers query ramp.atlas.json $AIM --only High --format tsv
    [ "$(cell name 1)/$(cell distance_mm 1)" = High/42 ]
    conus query ramp.atlas.json $AIM --mask high.nii.gz --mask-object High
    # N = 16 slices of floor(1.41 * 12), F = 1/16: one plane, in the middle of 12 mm: at z = 0, where Middle ends and
    # the voxel of value 60 begins.
    answers query ramp.atlas.json $AIM --sampling slices --slice-fraction 0.0625 --format tsv
    [ "$(cell name 1)/$(cell distance_mm 1)" = Middle/40 ]
    gl query ramp.atlas.json $AIM --sampling slices --slice-fraction 0.5 --engine gl -o gl.tsv
    answers query ramp.atlas.json $AIM --sampling slices --slice-fraction 0.5 -o rays.tsv
    cmp gl.tsv rays.tsv
}

@test "an invalid band is one line" {
    ramp
    local start="query sphere.nii.gz $AIM --pathway"
    fails 2 'band=20 is not LOW:HIGH:NAME' $start ramp.nii,band=20
    fails 2 'band=20:30 is not LOW:HIGH:NAME' $start ramp.nii,band=20:30
    fails 2 'band=20:30: is not LOW:HIGH:NAME' $start ramp.nii,band=20:30:
    fails 2 'band=x:30:A: LOW and HIGH are numbers, or nothing' $start ramp.nii,band=x:30:A
    fails 2 'band=nan:30:A: LOW and HIGH are numbers, or nothing' $start ramp.nii,band=nan:30:A
    fails 2 'band= and threshold= exclude each other' $start ramp.nii,band=20:30:A,threshold=3
    fails 2 'band= and name= exclude each other' $start ramp.nii,name=B,band=20:30:A
    fails 2 'band A: from 30 to below 20 holds no value' $start ramp.nii,band=30:20:A
    fails 2 'the bands A (from 20 to below 30) and B (from 25 to below 40) overlap' $start ramp.nii,band=20:30:A \
        --pathway ramp.nii,band=25:40:B
    fails 2 'two bands are called A' $start ramp.nii,band=20:30:A,band=30:40:A
    fails 2 'band A: from 111 on, the values are from 0 to 110' $start ramp.nii,band=111::A
    sed -i 's/"low": 80/"low": 70/' ramp.atlas.json
    fails 3 'pathways[0]: ' query ramp.atlas.json $AIM
    check_message 'overlap'
}

@test "a suspicious band has a note" {
    ramp
    run -0 --separate-stderr "$CONUS" info sphere.nii.gz --pathway ramp.nii,band=41:49:Gap,band=60:110:Top
    has 'pathway Gap: no voxel has a value from 41 to below 49'
    has 'pathway Top: values are below 110, the largest of the volume, whose voxels are not in it'
}
