#!/usr/bin/env bats
# Atlases of probabilities and --probability, as a user types them.
load helpers

# maps.nii: 8 x 8 x 12 voxels of 1 mm, the middle of the grid at the origin, two volumes in percent: A = 8 k, B = 88 -
# 8 k. maps.xml names them in the way of FSL.
maps() {
    command -v python3 >/dev/null || skip 'no python3'
    python3 - <<'END'
import struct
dim = (8, 8, 12)
head = bytearray(352)
struct.pack_into("<i", head, 0, 348)
struct.pack_into("<8h", head, 40, 4, *dim, 2, 1, 1, 1)
struct.pack_into("<2h", head, 70, 2, 8)
struct.pack_into("<8f", head, 76, 1, 1, 1, 1, 1, 1, 1, 1)
struct.pack_into("<2f", head, 108, 352, 1)
struct.pack_into("<2h", head, 252, 0, 1)
for row in range(3):
    line = [0.0] * 4
    line[row], line[3] = 1, -(dim[row] - 1) / 2
    struct.pack_into("<4f", head, 280 + 16 * row, *line)
head[344:348] = b"n+1\0"
up = bytes(8 * (n // 64) for n in range(64 * 12))
open("maps.nii", "wb").write(bytes(head) + up + up[::-1])
END
    printf '%s' '<atlas><header><type>Probabilistic</type><images><imagefile>/maps</imagefile></images></header><data>' \
        '<label index="0">A</label><label index="1">B</label></data></atlas>' >maps.xml
}
AIM='--origin 0.2,0.3,-40 --toward 0.2,0.3,0 --radius 1 --quiet'

# row NAME COLUMN...: these cells of the object's row of rows.tsv.
row() {
    awk -F '\t' -v name="$1" -v wanted="${*:2}" 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; n = split(wanted, w, " ") }
        $at["name"] == name { for (i = 1; i <= n; i++) printf "%s%s", $at[w[i]], i < n ? " " : "\n" }' rows.tsv
}

@test "--probability says from which probability on a voxel belongs to an area" {
    maps
    voxels() { run -0 --separate-stderr "$CONUS" info "$@" --format json; jq -c '[.objects[].voxels]' <<<"$output"; }
    [ "$(voxels maps.xml)" = '[512,512]' ] # 8 k reaches 25 in 8 planes of 64
    [ "$(voxels maps.xml --probability 0.5)" = '[320,320]' ]
    [ "$(voxels maps.xml --probability 0.88)" = '[64,64]' ]
    [ "$(voxels maps.xml --probability 1)" = '[0,0]' ]
    run -0 --separate-stderr "$CONUS" info maps.xml --probability 0.5
    [[ "$stderr$output" == *'2 areas by probabilities of 0.5 and more (values: percent)'* ]]
    # The option has priority over the manifest.
    echo '{"conus_atlas": 1, "probabilities": [{"fsl": "maps.xml", "threshold": 0.8}]}' >maps.atlas.json
    [ "$(voxels maps.atlas.json)" = '[128,128]' ]
    [ "$(voxels maps.atlas.json --probability 0.5)" = '[320,320]' ]
}

@test "contacts, their values and the settings follow it, in every command" {
    maps
    # A has 0.56 in plane 7, from z = 7 - 6 = 1 on; with the threshold 0.25 it begins in plane 4.
    answers query --force maps.xml --only A $AIM -o rows.tsv
    [ "$(row A distance_mm contact_value)" = '38 0.319999993' ]
    answers query --force maps.xml --only A $AIM --probability 0.5 -o rows.tsv
    [ "$(row A distance_mm contact_value)" = '41 0.560000002' ]
    jq -e '.Atlas.volumes[0].threshold == 0.5' rows.json
    cp rows.tsv wanted.tsv
    printf 'x\ty\tz\ttx\tty\ttz\ttime_s\n0.2\t0.3\t-40\t0.2\t0.3\t0\t0\n' >poses.tsv
    run -0 "$CONUS" batch maps.xml --only A --poses poses.tsv --radius 1 --probability 0.5 -q -o batch.tsv
    cut -f 1,4- batch.tsv | cmp - wanted.tsv # without row and time_s
    run -0 "$CONUS" track --force maps.xml --only A --poses poses.tsv --radius 1 --probability 0.5 -q --format tsv -o rows.tsv
    [ "$(row A distance_mm contact_value)" = '41 0.560000002' ]
    # The centre of B that a growing cone reaches first is the farthest, in plane 4: 38.5 mm away, and 0.3 and 0.2 mm
    # off the axis.
    answers sweep --force maps.xml --only B --origin 0.2,0.3,-40 --toward 0.2,0.3,0 --probability 0.5 -q --format tsv -o rows.tsv
    row B distance_mm | awk '{ exit !($1 - sqrt(38.5 ^ 2 + 0.3 ^ 2 + 0.2 ^ 2) < 1e-6) }'
    row B distance_mm | awk '{ exit !($1 > 38.5) }'
    gl render maps.xml --probability 0.5 --only A --origin 0.2,0.3,-40 --toward 0.2,0.3,0 --size 160x120 -q -o half.png
    gl render maps.xml --only A --origin 0.2,0.3,-40 --toward 0.2,0.3,0 --size 160x120 -q -o quarter.png
    not cmp half.png quarter.png
}

@test "another number, and an atlas without probabilities, are refused" {
    maps
    sphere --size 16
    local tried
    for tried in 0 -0.5 1.5 nan x; do
        fails 2 "--probability" query maps.xml $AIM --probability=$tried
    done
    fails 2 '--probability: 0 is out of range, allowed is more than 0 to 1' query maps.xml $AIM --probability 0
    printf '{"conus_atlas": 1, "parcellation": "sphere.nii.gz"}' >s.json
    fails 2 '--probability 0.5: s.json has no areas of probabilities' query s.json $AIM --probability 0.5
    fails 2 '--probability 0.5: s.json has no areas' query s.json $AIM --probability 0.5 --pathway maps.nii,volume=0
    nothing_left maps.nii maps.xml sphere.nii.gz sphere.tsv sphere.json s.json
}

# 8 k and 88 - 8 k reach 50 (of percent) in 5 of 12 planes of 64 voxels, 25 in 8.
@test "one map is an area where its name or --probability states it" {
    maps
    voxels() { run -0 --separate-stderr "$CONUS" info "$@" --format json; jq -c '[.objects[].voxels]' <<<"$output"; }
    cp maps.nii maps_probseg.nii
    [ "$(voxels maps.nii,volume=0 --probability 0.5)" = '[320]' ]
    [ "$(voxels maps_probseg.nii,volume=1 --probability 0.5)" = '[320]' ]
    [ "$(voxels maps_probseg.nii,volume=0)" = '[512]' ]
    fails 2 'as its name or --probability states, and nothing names them: --labels FILE does' query maps_probseg.nii $AIM
    fails 2 'states that its values are probabilities, but none is 1 or more (up to 0.88)' \
        query maps.nii,volume=0 $AIM --probability 1
    # A table that does not name the largest value is no second reading; one that does is.
    sphere --size 16
    run -0 --separate-stderr "$CONUS" info sphere.nii.gz --probability 0.5 --format tsv
    [[ "$stderr" == *'sphere.nii.gz: its values are stated to be probabilities, so BIDS label table in sphere.tsv, which names 1 label'* ]]
    printf 'index\tname\n88\tArea\n' | tee maps.tsv >maps_probseg.tsv
    fails 2 'maps.nii: --probability states that its values are probabilities, but BIDS label table in maps.tsv names 1 label, its largest value among them; without --probability the values are labels' \
        query maps.nii,volume=0 $AIM --probability 0.5
    [ "$(voxels maps_probseg.nii,volume=0 --probability 0.5)" = '[320]' ]
}

@test "conus manifest writes probabilities, and pathways beside a parcellation" {
    maps
    mkdir xml probseg both
    cp maps.nii maps.xml xml
    cp maps.nii probseg/maps_probseg.nii
    printf 'A\nB\n' >probseg/maps_probseg.txt
    cp maps.nii maps.xml both
    conus phantom slabs -o both --size 24
    # written FOLDER JQ: the result of a jq filter on the folder's manifest, which must load.
    written() {
        run -0 --separate-stderr "$CONUS" manifest "$1"
        run -0 --separate-stderr "$CONUS" info "$1/$1.atlas.json" --format json
        jq -c "[.objects[] | [.kind, .name, .voxels]]" <<<"$output" >objects
        jq -c "$2" "$1/$1.atlas.json"
    }
    [ "$(written xml .probabilities)" = '[{"fsl":"maps.xml"}]' ]
    [ "$(cat objects)" = '[["area","A",512],["area","B",512]]' ]
    [ "$(written probseg .probabilities)" = '[{"file":"maps_probseg.nii","names":["A","B"]}]' ]
    [ "$(cat objects)" = '[["area","A",512],["area","B",512]]' ]
    [ "$(written both '[.probabilities, .pathways]')" = '[null,[{"fsl":"maps.xml"}]]' ]
    [ "$(jq -c '[.[] | .[0]]' objects)" = '["area","area","pathway","pathway"]' ]
    rm both/both.atlas.json
    run -0 --separate-stderr "$CONUS" manifest both
    [[ "$stderr" == *'maps.xml: pathways, because a manifest with a parcellation or surfaces has no areas by'* ]]
}
