#!/usr/bin/env bats
# SPDX-License-Identifier: BSD-3-Clause
# Whose brain an atlas is, and that no answer of another one is quiet.

load helpers
SAMPLES=$BATS_TEST_DIRNAME/../fuzz/corpus/poses

need() {
    [ -e "/usr/share/mricron/templates/$1.nii.gz" ] || skip "no $1"
}

@test "a warning is said under --quiet, in JSON, in the sidecar, in the table and in cite" {
    need JHU-WhiteMatter-labels-1mm
    local ask='query JHU-WhiteMatter-labels-1mm --origin=-90,0,10 --toward=0,0,10 --angle 20'
    local words='21 of 21 pairs of a left and a right area lie the other way round'
    run -0 --separate-stderr "$CONUS" $ask
    [[ "$stderr" == *"conus: warning: $words"*'--sides exchanged mirrors the atlas'* ]]
    [[ "${lines[0]}" == "warning: $words"* ]]
    run -0 --separate-stderr "$CONUS" $ask -q
    check_message "warning: $words"
    run -0 --separate-stderr "$CONUS" $ask -q --format tsv
    check_message "warning: $words"
    [[ "$output" == query$'\t'* && "$output" != *"$words"* ]]
    run -0 --separate-stderr "$CONUS" $ask -q --format json
    jq -e --arg words "$words" '.Warnings | length == 1 and (.[0] | startswith($words))' <<<"$output"
    "$CONUS" $ask -q -o jhu.tsv
    jq -e --arg words "$words" '.Warnings | length == 1 and (.[0] | startswith($words))' jhu.json
    "$CONUS" verify jhu.tsv
    run -0 "$CONUS" cite jhu.tsv
    output=$(tr '\n' ' ' <<<"$output")
    has "conus warned: \"$words"
    run -0 --separate-stderr "$CONUS" $ask --sides exchanged -q -o mended.tsv
    [ -z "$stderr" ]
    jq -e 'has("Warnings") | not' mended.json
    "$CONUS" verify mended.tsv
    diff <(cut -f 4 jhu.tsv | sed 's/_R$/_L/') <(cut -f 4 mended.tsv)
}

@test "a result without warnings has no key Warnings, and one whose warnings were changed does not verify" {
    sphere --size 16
    "$CONUS" query sphere.nii.gz --origin 0,0,90 --toward 0,0,0 -q -o q.tsv
    jq -e 'has("Warnings") | not' q.json
    "$CONUS" query sphere.nii.gz --origin 0,0,90 --direction 0,0,1 -q -o away.tsv
    jq -e '.Warnings == ["the cone points away from the atlas; looking the other way it would hit Sphere first"]' away.json
    "$CONUS" verify away.tsv
    sed -i 's/the cone points away/the cone points near/' away.json
    run -1 "$CONUS" verify away.tsv
}

@test "batch and its parts keep the warnings, each of its own poses, and what is joined those of all" {
    sphere --size 16
    printf 'x\ty\tz\tdx\tdy\tdz\n0\t0\t90\t0\t0\t1\n0\t0\t91\t0\t0\t1\n0\t0\t90\t0\t0\t-1\n0\t0\t90\t0\t0\t-1\n' >poses.tsv
    for i in 0 1; do
        "$CONUS" batch sphere.nii.gz --poses poses.tsv --shard $i/2 -q -o joined.tsv
    done
    jq -e '.Warnings == ["poses.tsv: 2 of 2 cones point away from the atlas, the first in line 2; looking the other way (--axis, or the signs of dx dy dz) it would hit Sphere first"]' joined.0-of-2.json
    jq -e 'has("Warnings") | not' joined.1-of-2.json
    "$CONUS" batch sphere.nii.gz --poses poses.tsv --shard all/2 -q -o joined.tsv
    jq -e 'has("Warnings") | not' joined.json
    "$CONUS" batch sphere.nii.gz --poses poses.tsv -q -o all.tsv # 2 of 4 are no more than half
    jq -e 'has("Warnings") | not' all.json
    cmp all.tsv joined.tsv
    "$CONUS" verify joined.tsv
}

# Poses of people's own scans and in spaces of templates, on what there is of atlases: r refused, w warning, n note,
# - nothing.
@test "each list of poses on each atlas: refused, warned of, noted, or answered without a word" {
    need aal
    need inia19-NeuroMaps
    sphere --size 16
    local places='<Marker description="a"><Matrix4D data00="0" data01="0" data02="1" data03="-90" data10="0" data11="1"
data12="0" data13="0" data20="-1" data21="0" data22="0" data23="10" data30="0" data31="0" data32="0" data33="1"/></Marker>'
    local space
    for space in RAS LPS MNI; do
        printf '<InstrumentMarkerList coordinateSpace="%s"><InstrumentMarker>%s</InstrumentMarker></InstrumentMarkerList>\n' \
            $space "$places" >localite-$space.txt
    done
    printf '<InstrumentMarkerList><InstrumentMarker>%s</InstrumentMarker></InstrumentMarkerList>\n' "$places" >localite-none.txt
    sed 's/NIfTI:Scanner/NIfTI:Aligned/' "$SAMPLES/brainsight.txt" >aligned.txt
    cp "$SAMPLES/brainsight.txt" scanner.txt
    cp "$SAMPLES/simnibs.mat" simnibs.txt
    cp "$SAMPLES/invesalius.mkss" invesalius.txt
    printf 'name\tx\ty\tz\nA1\t-40\t-20\t50\n' >contact
    for space in individual MNI152NLin2009cAsym MNI152NLin6Asym Talairach fsaverage tkRAS; do
        mkdir $space
        cp contact $space/sub-1_electrodes.tsv
        printf '{"iEEGCoordinateSystem": "%s", "iEEGCoordinateUnits": "mm"}' $space >$space/sub-1_coordsystem.json
    done
    "$CONUS" phantom slabs --size 24 -o .
    /usr/bin/python3 - slabs.nii.gz <<'END' # as large as the Allen CCF, 13.2 x 8 x 11.4 mm along y, z and x
import gzip, struct, sys
data = bytearray(gzip.open(sys.argv[1]).read())
steps = [(11.4 / 24, 0, 0, -5.7), (0, 13.2 / 24, 0, -6.6), (0, 0, 8 / 24, -4)]
struct.pack_into("<3f", data, 80, 11.4 / 24, 13.2 / 24, 8 / 24)
struct.pack_into("<2h", data, 252, 0, 1)
for row, step in enumerate(steps):
    struct.pack_into("<4f", data, 280 + 16 * row, *step)
gzip.open("mouse.nii.gz", "wb").write(data)
END
    local atlases=(aal HarvardOxford-cort-maxprob-thr0-1mm JHU-WhiteMatter-labels-1mm inia19-NeuroMaps mouse.nii.gz aal,template=none sphere.nii.gz)
    local file wanted found atlas
    while read -r file wanted; do
        found=
        for atlas in "${atlases[@]}"; do
            run --separate-stderr "$CONUS" query "$atlas" --pose "$file" --radius 3 --format tsv
            local said
            said=$(grep 'ositions are in "' <<<"$stderr" || true)
            case $status/$said in
                3/*': positions are in "'*) found+=r ;;
                [01]/*warning:*) found+=w ;;
                [01]/*note:*) found+=n ;;
                [01]/) found+=- ;;
                *) found+="?" ;;
            esac
            if [[ $found == *[rw] ]]; then # and so it is under --quiet
                run --separate-stderr "$CONUS" query "$atlas" --pose "$file" --radius 3 --format tsv -q
                [[ "$stderr" == *'ositions are in "'* ]]
            fi
        done
        [ "$found" = "$wanted" ] || { echo "$file: $found, wanted $wanted"; return 1; }
    done <<'END'
localite-RAS.txt rrrrr-w
localite-LPS.txt rrrrr-w
localite-none.txt rrrrr-w
localite-MNI.txt n--rrrw
scanner.txt rrrrr-w
aligned.txt wwwwwww
simnibs.txt rrrrr-w
invesalius.txt rrrrr-w
individual/sub-1_electrodes.tsv rrrrr-w
tkRAS/sub-1_electrodes.tsv rrrrrrr
MNI152NLin2009cAsym/sub-1_electrodes.tsv nwwrrrw
MNI152NLin6Asym/sub-1_electrodes.tsv n--rrrw
Talairach/sub-1_electrodes.tsv rrrrrrw
fsaverage/sub-1_electrodes.tsv n--rrrw
END
}

# A scan's list on AAL, whose header has code 4 and whose grid is Colin 27's: whoever overrides that is told and cited.
@test "a template that the files deny is warned of, and cite names both overrides" {
    need aal
    cp "$BATS_TEST_DIRNAME/../corpus/points/localite-ras.xml" native.xml
    local words="',template=none' says one person's own, but its files say Colin 27"
    local ask='query aal,template=none --pose native.xml'
    fails 3 "or take an atlas made of that scan (ATLAS,template=none), or move" query aal --pose native.xml
    printf '# Leksell frame\nname,x,y,z\nleft STN,112.3,97.5,119.2\nright STN,88,97.9,119\n' >frame.csv
    fails 3 "convert them to the atlas's, by way of the scan, or move" query aal --pose frame.csv
    fails 3 'positions are in "Leksell", the atlas in another space (one person' query aal,template=none --pose frame.csv
    run -0 --separate-stderr "$CONUS" $ask -q --format tsv
    check_message "warning: $words"
    run -0 --separate-stderr "$CONUS" $ask -q --format json
    jq -e --arg words "$words" '.Atlas.template == "none" and (.Warnings | length == 1 and (.[0] | startswith($words)))' <<<"$output"
    "$CONUS" $ask -q -o stated.tsv
    "$CONUS" verify stated.tsv
    run -0 "$CONUS" cite stated.tsv
    output=$(tr '\n' ' ' <<<"$output")
    has 'Whose brain it is was stated (template=none), not taken from its files.'
    has "conus warned: \"$words"
    run -0 --separate-stderr "$CONUS" query aal --pose native.xml --any-space -o any.tsv
    jq -e '(has("Warnings") or (.Atlas | has("template"))) | not' any.json
    run -0 "$CONUS" cite any.tsv
    output=$(tr '\n' ' ' <<<"$output")
    has 'What poses, a scalp or regions say of their space was not used (--any-space): they were taken as they are.'
}

@test "positions in MNI 305 are moved but where the atlas lies there, too" {
    need aal
    cp "$BATS_TEST_DIRNAME/../corpus/points/surfcluster.summary" .
    printf '# coordinates in MNI305\nname,x,y,z\na,-40,-20,50\n' >list.csv
    local template file
    for file in surfcluster.summary list.csv; do
        run -0 --separate-stderr "$CONUS" query aal,template=mni305 --pose $file --format tsv
        [[ $stderr != *'moved to MNI 152'* ]]
        local at305=$output
        run -0 --separate-stderr "$CONUS" query aal,template=mni152 --pose $file --format tsv
        [[ $stderr == *'305'*"moved to MNI 152 by FreeSurfer's matrix"* ]]
        [ "$output" != "$at305" ]
        fails 3 ', the atlas in another space (one person' query aal,template=none --pose $file
        [[ $stderr == *'positions are in "MNI'*305* ]]
    done
    run -0 --separate-stderr "$CONUS" query aal,template=mni305 --pose list.csv --format tsv -q
    diff <(cut -f2-16 <<<"$output") <("$CONUS" query aal --point -40,-20,50 --format tsv -q | cut -f2-16)
}

@test "a point that says MNI is warned of where the brain is not known" {
    need inia19-NeuroMaps
    need aal
    sphere --size 16
    run -0 --separate-stderr "$CONUS" query sphere.nii.gz --point 'MNI -42 -20 50' -q
    [[ "${stderr_lines[0]}" == *'warning: --point: "MNI -42 -20 50" is in MNI, and it is not known whether the atlas lies there;'* ]]
    [[ "${stderr_lines[1]}" == *'warning: the point lies outside of the atlas;'* ]]
    [[ $output == *'point (-42.0, -20.0, 50.0), in MNI, where it is not known that the atlas lies'* ]]
    run -0 --separate-stderr "$CONUS" query aal --point 'MNI -42 -20 50' -q
    [ -z "$stderr" ]
    run -0 --separate-stderr "$CONUS" query inia19-NeuroMaps,template=mni152 --point 'MNI -42 -20 50' -q
    [[ $stderr == *'warning: the point lies outside of the atlas;'*"',template=mni152' says MNI 152, but its voxels are"* ]]
    fails 2 'it says MNI, but the atlas is another brain' query inia19-NeuroMaps,template=none --point 'MNI -42 -20 50'
    fails 2 'it says MNI, but the atlas is another brain' query inia19-NeuroMaps --point 'MNI -42 -20 50'
}

@test "atlases of other brains beside each other are told" {
    need aal
    local ask='--origin=-90,0,10 --toward=0,0,10 --angle 20 --format tsv'
    run -0 --separate-stderr "$CONUS" query aal --atlas HarvardOxford-cort-maxprob-thr0-1mm $ask
    [[ "$stderr" == *'note: aal (Colin 27) and HarvardOxford-cort-maxprob-thr0-1mm (MNI 152, earlier than NLin2009) are different brains'* ]]
    run -0 --separate-stderr "$CONUS" query aal --atlas aal,template=mni305 $ask -q
    [[ $stderr == *'warning: aal (Colin 27) and aal-2 (MNI 305) are different brains: a pose may be some mm off in one' ]]
    run -0 --separate-stderr "$CONUS" query aal --atlas aal,template=none $ask -q
    [[ $stderr == *"warning: aal (Colin 27) and aal-2 (one person's own) are different brains: one pose fits one of them only" ]]
    [ ! -e "$TEMPLATES/inia19-NeuroMaps.nii.gz" ] || run -0 --separate-stderr "$CONUS" query aal --atlas inia19-NeuroMaps --point 1,2,3 -q
    [[ $stderr == *'are different brains: one pose fits one of them only' ]]
}

@test "an animal's template is refused on people's and on another animal's, and taken on its own" {
    need inia19-NeuroMaps
    need aal
    printf '# %s template, mm\nname,x,y,z\nM1,-15.2,3.1,15.4\nV1,-8.5,-30.2,3.0\n' D99 >d99.csv
    printf '# %s template, mm\nname,x,y,z\nM1,-15.2,3.1,15.4\nV1,-8.5,-30.2,3.0\n' INIA19 >inia19.csv
    for at in aal inia19-NeuroMaps; do
        run -3 --separate-stderr "$CONUS" query $at --pose d99.csv
        [[ "$stderr" == *'positions are in "D99", the atlas in another space'* ]]
    done
    run -3 "$CONUS" query aal --pose inia19.csv
    run -0 --separate-stderr "$CONUS" query inia19-NeuroMaps --pose inia19.csv -q
    [ -z "$stderr" ]
}

@test "centimetres are warned of in an atlas of a part of MNI's brain" {
    need JHU-WhiteMatter-labels-1mm # 117 mm long
    printf 'name,x,y,z\nA,-4.2,-2.0,5.0\nB,3.8,1.4,-0.4\nC,-0.8,-9.2,0.2\n' >cm.csv
    run -0 --separate-stderr "$CONUS" query JHU-WhiteMatter-labels-1mm --pose cm.csv -q
    [[ "$stderr" == *'are they in centimetres? Then type cm.csv,unit=cm'* ]]
}

@test "a person's centimetres are warned of in a macaque's brain, where they lie in its middle" {
    need inia19-NeuroMaps # 84 mm long
    printf 'name,x,y,z\nM1,-4.2,-2.0,5.0\nInsula,3.8,1.4,-0.4\nV1,-0.8,-9.2,0.2\n' >cm.csv
    run -0 --separate-stderr "$CONUS" query inia19-NeuroMaps --pose cm.csv -q
    [[ "$stderr" == *'are they in centimetres? Then type cm.csv,unit=cm; else cm.csv,unit=mm'* ]]
    run -0 --separate-stderr "$CONUS" query inia19-NeuroMaps --pose cm.csv,unit=mm -q
    [ -z "$stderr" ]
    sed 's/M1,-4.2/M1,-14.2/' cm.csv >mm.csv
    run -0 --separate-stderr "$CONUS" query inia19-NeuroMaps --pose mm.csv -q
    [ -z "$stderr" ]
}

@test "a saved cap says whose head it is on" {
    need aal inia19-NeuroMaps
    "$CONUS" positions C3 F3 P3 -o cap.tsv
    run -0 --separate-stderr "$CONUS" query aal --pose cap.tsv --angle 10 -q
    [ -z "$stderr" ]
    run -3 --separate-stderr "$CONUS" query inia19-NeuroMaps --pose cap.tsv --angle 10
    [[ "$stderr" == *'positions are in "MNI 152", the atlas in another space'* ]]
}
