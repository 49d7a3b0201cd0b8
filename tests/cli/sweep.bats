#!/usr/bin/env bats
# conus sweep: the angles that admit objects, shares by angle, probabilities under errors of the pose.

load helpers

aim='--origin 0,-60,0.2 --toward 0,0,0.2'

@test "areas are admitted by angle, nearest first" {
    conus phantom nested -o .
    answers sweep nested.nii.gz --origin 0,-100,40 --direction 0,1,0 --angle 90 --format tsv
    [ "${#lines[@]}" -eq 4 ]
    has $'query\tkind\tindex\tname\tabbreviation\trank\tangle_deg\thalf_angle_deg\tmargin_deg\tdistance_mm\tx\ty\tz\tmeasured'
    [ "$(cell index 1)" = 1 ]
    [ "$(cell index 2)" = 300 ]
    [ "$(cell index 3)" = 4000000001 ]
    [ "$(cell measured 1)" = "voxel centre" ]
    [ "$(cell margin_deg 3)" = n/a ]
    awk -F'\t' 'NR > 1 && ($7 - 2 * $8) ^ 2 > 1e-12 { exit 1 }' <<<"$output"
    # the tangents of balls of 24 and 8 mm at 107.7 mm, half a voxel more or less
    awk -F'\t' 'NR == 2 && ($8 < 8.0 || $8 > 9.5) { exit 1 }' <<<"$output"
    awk -F'\t' 'NR == 4 && ($8 < 17.0 || $8 > 18.4) { exit 1 }' <<<"$output"
}

@test "only what the widest cone admits is listed, with the margin to what comes next" {
    conus phantom nested -o .
    answers sweep nested.nii.gz --origin 0,-100,40 --direction 0,1,0 --angle 20 --format tsv
    [ "${#lines[@]}" -eq 2 ]
    [ "$(cell margin_deg 1)" != n/a ]
    run -0 --separate-stderr "$CONUS" sweep nested.nii.gz --origin 0,-100,40 --direction 0,1,0 --angle 1 --quiet
    [ "${#lines[@]}" -eq 5 ] # the warning, that it points away, stands above the table
    run -0 --separate-stderr "$CONUS" sweep nested.nii.gz --origin 0,-100,0 --direction 0,-1,0 --angle 179 --format tsv --quiet
    [ "${#lines[@]}" -eq 1 ]
}

@test "a range leaves out what lies beyond, and levels and spaces hold" {
    conus phantom nested -o .
    answers sweep nested.nii.gz $aim --range 70,80 --angle 179 --format tsv
    [ "$(cut -f 3 <<<"$output" | tr '\n' ' ')" = "index 1 300 " ]
    awk -F'\t' 'NR > 1 && ($10 < 70 || $10 > 80.1) { exit 1 }' <<<"$output"
    answers sweep nested.nii.gz --origin 5,-60,0.2 --toward 5,0,0.2 --angle 30 --format tsv
    local x
    x=$(cell x 1)
    answers sweep nested.nii.gz --origin -5,60,0.2 --toward -5,0,0.2 --space lps --angle 30 --format tsv
    [ "$(cell x 1)" = "-$x" ]
    printf 'index\tname\tparent_id\n1\tOuter\t20\n300\tInner\t20\n20\tShell\tn/a\n4000000001\tCore\tn/a\n' >tree.tsv
    answers sweep nested.nii.gz -q --labels tree.tsv --origin 0,-100,40 --direction 0,1,0 --angle 90 --format tsv
    local angle
    angle=$(cell angle_deg 1)
    answers sweep nested.nii.gz -q --labels tree.tsv --origin 0,-100,40 --direction 0,1,0 --angle 90 --level 1 --format tsv
    [ "$(cut -f 4 <<<"$output" | tr '\n' ' ')" = "name Shell Core " ]
    [ "$(cell angle_deg 1)" = "$angle" ]
    answers sweep nested.nii.gz -q --labels tree.tsv $aim --angle 20 --jitter 9,5 --level 1 --layers all --format tsv
    [ "$(cut -f 4 <<<"$output" | tr '\n' ' ')" = "name Shell Core unassigned " ]
}

@test "--angles gives the shares at each" {
    conus phantom nested -o .
    answers sweep nested.nii.gz $aim --angles 10:60:25 --format tsv
    [ "$(cut -f 25 <<<"$output" | sort -u | tr '\n' ' ')" = "10 35 60 angle_deg " ]
    awk -F'\t' 'NR > 1 { sum[$25] += $9 } END { for (a in sum) if (sum[a] < 0.999999 || sum[a] > 1.000001) exit 1 }' \
        <<<"$output"
    answers query nested.nii.gz $aim --angle 35 --format tsv
    local share
    share=$(cell share 1)
    answers sweep nested.nii.gz $aim --angles 35 --format tsv
    [ "$(cell share 1)" = "$share" ]
    answers sweep nested.nii.gz $aim --angles 60,10,35
    has 'cones from (0.00, -60.00, 0.20)'
    has '    60      10      35'
    answers sweep nested.nii.gz $aim --angles 0.1:1:0.1 --format tsv
    [ "$(cut -f 25 <<<"$output" | sort -u | wc -l)" -eq 11 ]
}

@test "--jitter gives probabilities that sum to 1, the same every time" {
    conus phantom slabs -o .
    local at='--origin 18,-80,0 --direction 0,1,0 --angle 2 --resolution 1'
    answers sweep slabs.nii.gz $at --jitter 0,4 --format tsv
    awk -F'\t' 'NR > 1 { hit += $7; share += $11 } END { exit hit != 1 || share != 1 }' <<<"$output"
    # the slab ends at x = 20 mm, z = -20 and 20: P(x < 20) P(|z| < 20) of normal errors of 4 mm
    awk -F'\t' '$3 == 300 && ($7 < 0.685 || $7 > 0.698) { exit 1 }' <<<"$output"
    [ "$(cell samples 1)" = 1024 ]
    [ "$(cell error_mm 1)" = 4 ]
    [ "$(cell p_in_cone 1)" = n/a ]
    local first=$output
    answers sweep slabs.nii.gz $at --jitter 0,4 --format tsv
    [ "$output" = "$first" ]
    answers sweep slabs.nii.gz $at --jitter 1,0 --layers all --samples 16
    has 'in cone'
    has '16 poses with errors of 1 degrees about each axis and 0 mm along each'
}

@test "rows of a pose file have errors of their own" {
    conus phantom slabs -o .
    printf 'query_id,x,y,z,dx,dy,dz,angle,error_deg,error_mm\n' >poses.csv
    printf 'sure,0,-80,0,0,1,0,3,0,0\nunsure,0,-80,0,0,1,0,3,20,\nas told,0,-80,0,0,1,0,3,,\nlost,0,-80,0,0,0,0,3,,\n' >>poses.csv
    run -1 --separate-stderr "$CONUS" sweep slabs.nii.gz --pose poses.csv --jitter columns --format tsv
    [ "${stderr_lines[0]}" = 'conus: poses.csv:4: no error_deg or error_mm for --jitter columns' ]
    [[ "${stderr_lines[1]}" == 'conus: poses.csv:5: '* ]] && [ "${#stderr_lines[@]}" -eq 2 ]
    [ "$(awk -F'\t' '$1 == "sure" && $6 == 1 { print $7, $14, $15 }' <<<"$output")" = "1 0 0" ]
    [ "$(awk -F'\t' '$1 == "unsure" && $6 == 1 { print $14, $15 }' <<<"$output")" = "20 0" ]
    [ "$(awk -F'\t' '$1 == "as told" { print $2 }' <<<"$output")" = error ]
    fails 2 '--jitter columns: without --pose FILE there are none' \
        sweep slabs.nii.gz --origin 0,-80,0 --toward 0,0,0 --jitter columns
    for question in --angles=2,4 --layers=visible; do
        [ "$question" != --layers=visible ] || question=
        # shellcheck disable=SC2086 # none, or one
        run -1 --separate-stderr "$CONUS" sweep slabs.nii.gz --pose poses.csv $question --format tsv
        [ "$(tail -1 <<<"$output" | cut -f 1-5)" = $'lost\terror\tn/a\tline 5: direction: 0,0,0, allowed are finite numbers that are not all 0\tn/a' ]
        # shellcheck disable=SC2086
        run -1 --separate-stderr "$CONUS" sweep slabs.nii.gz --pose poses.csv $question
        has 'query lost: no answer: line 5: direction: '
    done
}

@test "--jitter wins over the file's columns, and says so once" {
    conus phantom slabs -o .
    printf 'query_id,x,y,z,dx,dy,dz,error_deg,error_mm\n' >poses.csv
    printf 'one,0,-80,0,0,1,0,20,9\ntwo,0,-80,0,0,1,0,,9\n' >>poses.csv
    run -0 --separate-stderr "$CONUS" sweep slabs.nii.gz --pose poses.csv --jitter 5,2 --samples 16 --format tsv
    check_message 'note: poses.csv: error_deg and error_mm are not used, --jitter 5,2 is; --jitter columns takes them'
    [ "$(awk -F'\t' 'NR > 1 { print $14, $15 }' <<<"$output" | sort -u)" = "5 2" ]
    answers sweep slabs.nii.gz --pose poses.csv --jitter 5,2 --samples 16 --quiet
    answers sweep slabs.nii.gz --pose poses.csv --jitter columns --samples 16 --format tsv
    [ "$(awk -F'\t' 'NR > 1 { print $1, $14, $15 }' <<<"$output" | sort -u)" = "$(printf 'one 20 9\ntwo 0 9')" ]
}

@test "surfaces are admitted by their nearest point" {
    conus phantom brain -o .
    answers sweep brain.atlas.json --origin 0,-150,0 --toward 0,0,0 --angle 179 --format tsv --quiet
    [ "$(awk -F'\t' '$14 == "surface"' <<<"$output" | wc -l)" -eq 11 ]
    [ "$(awk -F'\t' '$2 == "pathway" { print $14 }' <<<"$output")" = "voxel centre" ]
    [ "$(cell angle_deg 1)" = 0 ]
}

@test "bundles are admitted by the nearest point of their lines" {
    conus phantom slabs -o . --size 32
    python3 "$BATS_TEST_DIRNAME/tck.py" arc.tck -10,3,0 10,3,0 -- 0,30,10
    python3 "$BATS_TEST_DIRNAME/tck.py" dot.tck 0,4,0
    local aim='--origin 0,0,100 --direction 0,0,-1 --angle 40 --quiet --format tsv'
    local both='--streamlines arc.tck --streamlines dot.tck'
    # shellcheck disable=SC2086
    answers sweep slabs.nii.gz $aim $both --only arc,dot
    [ "$(cell name 1)/$(cell kind 1)/$(cell measured 1)" = arc/bundle/streamline ]
    [ "$(cell x 1)/$(cell y 1)/$(cell z 1)" = 0/3/0 ]
    python3 -c '
import math, sys
assert all(math.isclose(float(a), 2 * math.degrees(math.atan(b / 100)), rel_tol=1e-8)
           for a, b in zip(sys.argv[1:], (3, 4)))' "$(cell angle_deg 1)" "$(cell angle_deg 2)"
    # shellcheck disable=SC2086
    answers sweep slabs.nii.gz $aim $both --only arc,dot --range 0,95 # only the one point of arc
    [ "$(cell name 1)/$(cell y 1)/$(cell z 1)/$(wc -l <<<"$output")" = arc/30/10/2 ]
    # shellcheck disable=SC2086
    answers sweep slabs.nii.gz $aim $both --hide arc
    [[ "$output" != *arc* ]]
    has dot
}

@test "every format has the same rows, and a TSV its sidecar" {
    conus phantom nested -o .
    answers sweep nested.nii.gz $aim --angle 30 --jitter 2,1 -o a.tsv
    [ -z "$output" ]
    grep -q '"p_hit_error"' a.json
    grep -q '"Version"' a.json
    answers sweep nested.nii.gz $aim --angle 30 --jitter 2,1 --format ndjson
    [ "${#lines[@]}" -eq $(($(wc -l <a.tsv) - 1)) ]
    has '"p_hit":'
    answers sweep nested.nii.gz $aim --angle 30 --format json
    has '"margin_deg":'
    answers sweep nested.nii.gz $aim --angles 5,6 --format json
    has '"angle_deg": 6'
    nothing_left a.json a.tsv nested.json nested.nii.gz nested.tsv
}

@test "bad input is one line" {
    conus phantom nested -o .
    local angles
    for angles in 20:10:1 10:20:0 10:20:-1 10:20 10:20:1:1 a,b 10, ,10 1,nan 1:2:nan '' 1e999 0x10; do
        fails 2 --angles sweep nested.nii.gz $aim --angles "$angles"
    done
    fails 2 'is out of range, allowed is more than 0 and less than 180' sweep nested.nii.gz $aim --angles 10,180
    fails 2 'is out of range, allowed is more than 0 and less than 180' sweep nested.nii.gz $aim --angles -5
    fails 2 'has more than 1000 angles' sweep nested.nii.gz $aim --angles 1:179:0.01
    local jitter
    for jitter in 1 1,2,3 -1,2 1,-2 nan,1 1,inf 91,0 0,1e7 x ''; do
        fails 2 --jitter sweep nested.nii.gz $aim --jitter "$jitter"
    done
    fails 2 '--samples: 100 is no power of two' sweep nested.nii.gz $aim --jitter 1,1 --samples 100
    fails 2 '--samples: 8 is out of range' sweep nested.nii.gz $aim --jitter 1,1 --samples 8
    fails 2 '--samples has no effect without --jitter' sweep nested.nii.gz $aim --samples 64
    fails 2 '--angles' sweep nested.nii.gz $aim --angles 10 --jitter 1,1
    fails 2 '--angles' sweep nested.nii.gz $aim --angles 10 --angle 12
    fails 2 'which has no angle to sweep' sweep nested.nii.gz $aim --radius 4
    fails 2 'which has no angle to sweep' sweep nested.nii.gz $aim --radius 4 --angles 3
    fails 2 '--aperture has no effect without --angles or --jitter' sweep nested.nii.gz $aim --aperture square
    fails 2 '--engine has no effect without --angles or --jitter' sweep nested.nii.gz $aim --engine rays
    fails 2 '--layers has no effect without --angles or --jitter' sweep nested.nii.gz $aim --layers all
    fails 2 '--angle: 180 is out of range' sweep nested.nii.gz $aim --angle 180
    fails 2 'would overwrite the input' sweep nested.nii.gz $aim --format table -o nested.nii.gz
    fails 2 'no cone given' sweep nested.nii.gz
    nothing_left nested.json nested.nii.gz nested.tsv
    answers sweep nested.nii.gz $aim --radius 4 --jitter 1,1 --samples 16
    answers sweep nested.nii.gz $aim --aperture square --jitter 1,1 --samples 16 --resolution 1 --angle 179
}

@test "both engines give the same chances" {
    conus phantom nested -o .
    gl sweep nested.nii.gz $aim --jitter 5,3 --samples 32 --angle 40 --engine gl --format tsv
    local by_gl=$output
    answers sweep nested.nii.gz $aim --jitter 5,3 --samples 32 --angle 40 --engine rays --format tsv
    [ "$output" = "$by_gl" ]
}
