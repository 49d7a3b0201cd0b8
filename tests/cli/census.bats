#!/usr/bin/env bats
# Everything in the cone or around a point, voxel by voxel: --layers all, --point, --mask, --voxels, as a user types them.
load helpers

# Concentric balls of radius 24, 16 and 8 mm around 0, labels 1, 300 and 4000000001, voxels of 2 mm.
nested() {
    conus phantom nested -o . --size 32 --spacing 2,2,2
}
AIM='--origin 0,0,100 --toward 0,0,0 --angle 20'

@test "with --layers all, rows have volumes, parts and centroids" {
    nested
    answers query nested.nii.gz $AIM --layers all --format tsv
    [ "$(cell name 2)" = Core ] || [ "$(cell name 3)" = Core ]
    awk -F'\t' 'NR == 1 { for (i = 1; i <= NF; i++) c[$i] = i; next }
        $c["kind"] == "area" { sum += $c["cone_fraction"]; if ($c["volume_mm3"] != 8 * $c["voxels"]) bad = 1 }
        $c["name"] == "Core" && $c["fraction"] != 1 { bad = 1 }
        $c["kind"] == "unassigned" && !($c["voxels"] > 0) { bad = 1 }
        END { exit bad || sum < 1 - 1e-6 || sum > 1 + 1e-6 }' <<<"$output"
}

@test "--voxels with --layers all lists every voxel of the cone, nearest first" {
    nested
    answers query nested.nii.gz $AIM --layers all --format tsv --voxels voxels.tsv --voxels-of all
    local counted
    counted=$(awk -F'\t' 'NR == 1 { for (i = 1; i <= NF; i++) c[$i] = i; next }
        $c["kind"] == "area" { sum += $c["voxels"] } END { print sum }' <<<"$output")
    [ "$(($(wc -l <voxels.tsv) - 1))" -eq "$counted" ]
    awk -F'\t' 'NR > 2 && $10 < last { exit 1 } NR > 1 { last = $10 }' voxels.tsv
    [ "$(tail -n +2 voxels.tsv | cut -f3-5 | sort -u | wc -l)" -eq "$counted" ]
}

@test "a ball: what is at a point, what is near, how far" {
    nested
    answers query nested.nii.gz --point 0,0,0 --radius 9 --format tsv
    [ "$(cell name 1)/$(cell distance_mm 1)/$(cell pixels 1)/$(cell rank 1)" = Core/0/n/a/1 ]
    awk -v d="$(cell distance_mm 2)" 'BEGIN { exit !(d > 6 && d < 9) }'
    awk -v f="$(cell fraction 1)" 'BEGIN { exit !(f == 1) }'
    [ "$(cell kind 3)/$(cell voxels 3)" = unassigned/0 ]
    answers query nested.nii.gz --point 0,0,0 --radius 9
    has 'ball of radius 9 mm around (0.00, 0.00, 0.00), RAS mm'
    has 'nearest point x, y, z'
    answers query nested.nii.gz --point -1,-2,3 --radius 9 --format json --space lps
    has '"point_ras": ['
    answers query nested.nii.gz --point 1,2,3 --radius 2 --format tsv
    local ras="$(cell voxels 1)"
    answers query nested.nii.gz --point -1,-2,3 --radius 2 --format tsv --space lps
    [ "$(cell voxels 1)" = "$ras" ]
}

@test "a point without a radius: what is at it, or else the nearest, however far" {
    nested
    answers query nested.nii.gz --point 0,0,0
    [ "${lines[0]}" = 'point (0.00, 0.00, 0.00), RAS mm' ]
    [ "${lines[1]}" = 'at the point: Core' ]
    [ "${lines[5]}" = 'ranked by distance' ] # one row
    answers query nested.nii.gz --point 0,0,0 --format json
    has '"radius_mm": 0'
    # The point 13 mm off the centre is in the inner shell; the core is 13 - 8 mm away, the outer shell 16 - 13.
    answers query nested.nii.gz --point 13,0,0 --radius 12 --format tsv
    [ "$(cell name 1)/$(cell x 1)" = 'Shell outer/13' ] # the one with more voxels has rank 1
    answers query nested.nii.gz --point 13,0,0 --radius 12 --order depth --format tsv
    [ "$(cell name 1)" = 'Shell inner' ]
    answers query nested.nii.gz --point 13,0,0 --format tsv
    [ "${#lines[@]}/$(cell name 1)/$(cell x 1)/$(cell y 1)/$(cell share 1)" = '2/Shell inner/13/0/n/a' ]
    answers query nested.nii.gz --point 30,0,0 --format tsv
    [ "${#lines[@]}/$(cell name 1)/$(cell distance_mm 1)" = '2/Shell outer/6' ]
    run -0 --separate-stderr conus query nested.nii.gz --point 300,0,0
    check_message 'warning: the point lies outside of the atlas; the nearest to it is Shell outer, 276.00 mm away'
    has 'at the point: no area, pathway or bundle; the nearest:'
    has '276.00' # 300 - 24
    run -0 --separate-stderr conus query nested.nii.gz --point 300,0,0 --radius 5
    check_message 'warning: the point lies outside of the atlas; the nearest to it is Shell outer, 276.00 mm away'
    has 'at the point: no area, pathway or bundle'
    run -0 --separate-stderr conus query nested.nii.gz --point 300,0,0 --radius 5 --quiet
    check_message 'warning: the point lies outside of the atlas; the nearest to it is Shell outer, 276.00 mm away'
    # Each atlas says what is there.
    conus phantom sphere -o . --size 64
    answers query nested.nii.gz --atlas sphere.nii.gz --point 0,0,22 --format tsv
    [ "$(cell name 1)/$(cell distance_mm 1)/$(cell name 2)/$(cell distance_mm 2)" = 'Shell outer/0/Sphere/2' ]
    # What lists a neighbourhood needs one.
    fails 2 '--mask needs --radius MM' query nested.nii.gz --point 0,0,0 --mask a.nii.gz
    fails 2 '--voxels needs --radius MM' query nested.nii.gz --point 0,0,0 --voxels a.tsv --voxels-of all
}

@test "points of a file are asked what is at them" {
    nested
    printf -- '-1 0 0 origin\n0 0 20 above\n0 0 30 out\n' >points.txt
    answers query nested.nii.gz --pose points.txt -q
    [ "${lines[0]}" = "asked as points in the atlas's space: what is at each, or else nearest to it" ]
    [ "$(tail -n +2 <<<"$output")" = "\
point                   at x, y, z  what is at it               label  distance
                                mm                                           mm
origin     -1.00     0.00     0.00  Core                   4000000001      0.00
above       0.00     0.00    20.00  Shell outer                     1      0.00
out         0.00     0.00    30.00  nearest: Shell outer            1      6.00
atlas nested.nii.gz, placed by sform, code 1 (scanner)" ]
    # Each atlas, marks of rows, a row without an answer.
    printf 'name,x,y,z,group\nIn,-1,0,5,a\nBad,b,0,0,b\n' >list.csv
    conus phantom sphere -o . --size 64
    run -1 --separate-stderr conus query nested.nii.gz --atlas sphere.nii.gz --pose list.csv --keep group -q
    [ "$(sed -n '2p;4,6p' <<<"$output")" = "\
point                          at x, y, z  atlas   what is at it       label  distance
In (group a)      -1.00     0.00     5.00  nested  Core           4000000001      0.00
                                           sphere  Sphere                  1      0.00
Bad (group b)  no answer: line 3: column x: \"b\" is not a finite number" ]
    answers query nested.nii.gz --pose points.txt --format tsv -q
    [ "$(cut -f 1,4,13 <<<"$output" | tail -n +2 | tr '\t\n' '/;')" = 'origin/Core/0;above/Shell outer/0;out/Shell outer/6;' ]
    [ "$(cell z 3)" = 30 ]
    local rows=$output
    answers query nested.nii.gz --pose points.txt --format json -q
    [ "$(jq -r .Understood <<<"$output")" = "asked as points in the atlas's space: what is at each, or else nearest to it" ]
    # A batch, its shards and a point by itself say the same.
    run -0 --separate-stderr conus batch nested.nii.gz --poses points.txt
    [ "$stderr" = "conus: note: points.txt: asked as points in the atlas's space: what is at each, or else nearest to it" ]
    [ "$output" = "$rows" ]
    answers query nested.nii.gz --point 0,0,30 --format tsv
    [ "$(tail -1 <<<"$output" | cut -f 2-19)" = "$(tail -1 <<<"$rows" | cut -f 2-19)" ]
    run -0 conus batch nested.nii.gz --poses points.txt --summary -q
    [ "$(cell name 3)/$(cell distance_mm 3)/$(cell z 3)" = 'Shell outer/6/30' ]
    conus batch nested.nii.gz --poses points.txt -q -o rows.tsv
    conus cite rows.tsv | grep -Eq 'areas at each of [0-9]+ points.*, or nearest to it'
    conus verify rows.tsv
    # An option of an axis asks for one.
    local option
    for option in '--angle 10' '--layers all' '--range 0,9' '--segments a.tsv' '--clearance a.tsv' '--image a.png'; do
        fails 3 "points.txt: a point, without the direction that ${option% *} needs" query nested.nii.gz --pose points.txt $option
        [ "$option" = '--image a.png' ] || fails 3 "that ${option% *} needs" batch nested.nii.gz --poses points.txt $option
    done
    fails 2 "--voxels needs --radius MM" query nested.nii.gz --pose points.txt --voxels a.tsv --voxels-of all
}

@test "points of a file with --radius are balls" {
    nested
    printf -- '-1 0 0 origin\n0 0 20 above\n' >points.txt
    answers query nested.nii.gz --pose points.txt --radius 3 --format tsv
    [ "$(cell query 1)/$(cell name 1)" = origin/Core ]
    [ "$(awk -F'\t' '$1 == "above" && $2 == "area"' <<<"$output" | cut -f5-6)" != "" ]
    printf '0 0 20\n' >point.txt
    run -1 --separate-stderr conus query nested.nii.gz --pose point.txt --radius 3 --range 1,2
    check_message 'point.txt:1: a ball has no axis'
}

@test "a ball is not mixed with what only a cone has" {
    nested
    fails 2 '--point and --origin exclude each other' query nested.nii.gz --point 0,0,0 --radius 3 --origin 1,2,3
    fails 2 '--point and --image exclude each other' query nested.nii.gz --point 0,0,0 --radius 3 --image a.png
    fails 2 '--radius' query nested.nii.gz --point 0,0,0 --radius 0
    fails 2 '--radius' query nested.nii.gz --point 0,0,0 --radius -1
    fails 2 '--point' query nested.nii.gz --point 0,nan,0 --radius 1
}

@test "a range must begin before it ends" {
    nested
    fails 2 '--range' query nested.nii.gz $AIM --range 20,10
    fails 2 '--range' query nested.nii.gz $AIM --range -5,10
    fails 2 '--range' query nested.nii.gz $AIM --range nan,10
}

@test "--mask writes the cone's voxels, and a sidecar" {
    nested
    answers query nested.nii.gz $AIM --layers all --format tsv --mask roi_mask.nii.gz
    local counted
    counted=$(awk -F'\t' 'NR == 1 { for (i = 1; i <= NF; i++) c[$i] = i; next }
        $c["kind"] == "area" { sum += $c["voxels"] } END { print sum }' <<<"$output")
    [ "$(jq .Voxels roi_mask.json)/$(jq -r .Type roi_mask.json)" = "$counted/ROI" ]
    run -0 --separate-stderr "$CONUS" info roi_mask.nii.gz --format tsv
    [ "$(cell index 1)/$(cell voxels 1)" = "1/$counted" ]
    nothing_left nested.nii.gz nested.tsv nested.json roi_mask.nii.gz roi_mask.json
}

@test "a mask's name or --mask-of says what it holds, --mask-object of what" {
    nested
    sphere --size 32
    conus query nested.nii.gz $AIM --mask a_dseg.nii --quiet >/dev/null
    [ "$(jq -r '.Labels["4000000001"]' a_dseg.json)" = Core ]
    conus info a_dseg.nii --format tsv --labels nested.tsv | grep -q Core
    conus query nested.nii.gz $AIM --mask b.nii.gz --mask-of all --quiet >/dev/null
    conus query nested.nii.gz $AIM --mask c.nii.gz --mask-object Core --quiet >/dev/null
    [ "$(jq .Voxels b.json)" -gt "$(jq .Voxels c.json)" ]
    conus query nested.nii.gz $AIM --pathway sphere.nii.gz --mask d_probseg.nii.gz --quiet >/dev/null
    [ "$(jq -r .Description d_probseg.json)" = 'conus 0.1.0: values of a pathway in a cone' ]
    conus query nested.nii.gz --point 0,0,0 --radius 5 --mask e.nii.gz --quiet >/dev/null
    [ "$(jq -r .Description e.json)" = 'conus 0.1.0: mask of areas in a ball' ]
}

@test "masks that cannot be are refused, and nothing is written" {
    nested
    fails 2 '--mask: "a.png" does not end in .nii.gz or .nii' query nested.nii.gz $AIM --mask a.png
    fails 2 '--mask-of has no effect without --mask' query nested.nii.gz $AIM --mask-of all
    fails 2 'did you mean "Core"?' query nested.nii.gz $AIM --mask a.nii --mask-object Corr
    fails 2 '--mask: map of values: there is no pathway' query nested.nii.gz $AIM --mask a.nii --mask-of values
    fails 2 '--mask: mask of everything: Core is an area' query nested.nii.gz $AIM --mask a.nii --mask-of all --mask-object Core
    fails 2 '--mask nested.nii.gz would overwrite the input nested.nii.gz' query nested.nii.gz $AIM --mask nested.nii.gz
    printf '0 0 0\n1 1 1\n' >points.txt
    fails 2 '--mask shows one pose, points.txt has 2' query nested.nii.gz --pose points.txt --radius 3 --mask a.nii
    nothing_left nested.nii.gz nested.tsv nested.json points.txt
}

# A beam of 40 mm at 60 mm is a cone of 2 atan(20 / 60) from its focus.
@test "a beam is the cone from its focus to the transducer" {
    need_all
    nested
    local beam=(--focus 0,0,0 --transducer 0,0,60 --aperture-diameter 40)
    answers query nested.nii.gz "${beam[@]}" --format tsv
    local rows=$output
    answers query nested.nii.gz --origin 0,0,0 --toward 0,0,60 --angle 36.86989764584402 --range 0,60 --layers all --format tsv -q
    [ "$rows" = "$output" ]
    # All that is within the cone's solid angle, 2 pi (1 - cos) r^3 / 3, of the ball of 24 mm: voxels of 8 mm^3.
    awk -F'\t' 'NR == 1 { for (i = 1; i <= NF; i++) c[$i] = i; next } $c["kind"] == "area" { sum += $c["volume_mm3"] }
        END { cone = 2 * 3.14159265 * (1 - 3 / sqrt(10)) * 24 ^ 3 / 3; exit !(sum > 0.9 * cone && sum < 1.1 * cone) }' <<<"$rows"
    answers query nested.nii.gz "${beam[@]}" --segments -
    has '60.00     36.00' # ends at the transducer
    answers query nested.nii.gz "${beam[@]}"
    [ "${lines[0]}" = 'asked as a beam: from its focus to the transducer, 40 mm wide there' ]
    # Beams of a file, for query and batch, each by its own distance.
    printf 'x,y,z,tx,ty,tz\n0,0,0,0,0,60\n0,0,0,0,0,20\n' >either.csv
    fails 3 'a beam has a focus and a transducer, and x y z or tx ty tz may be either: call them focus_x focus_y focus_z' \
        query nested.nii.gz --pose either.csv --aperture-diameter 40
    sed '1s/.*/focus_x,focus_y,focus_z,transducer_x,transducer_y,transducer_z/' either.csv >beams.csv
    awk -F, -v OFS=, '{ print $4, $5, $6, $1, $2, $3 }' beams.csv >turned.csv # the transducer first, as devices have it
    answers query nested.nii.gz --pose beams.csv --aperture-diameter 40 --format tsv
    [ "$(grep -P '^1\t' <<<"$output")" = "$(tail -n +2 <<<"$rows")" ]
    rows=$output
    answers query nested.nii.gz --pose turned.csv --aperture-diameter 40 --format tsv
    [ "$output" = "$rows" ]
    run -0 --separate-stderr conus batch nested.nii.gz --poses beams.csv --aperture-diameter 40 --format tsv
    [ "$(grep -c beam <<<"$stderr")" = 1 ]
    run -0 conus batch nested.nii.gz --poses beams.csv --aperture-diameter 40 -q
    [ "$output" = "$rows" ]
    answers query nested.nii.gz --pose beams.csv --aperture-diameter 40 --format json
    [ "$(jq -c '[.Queries[] | [.angle_deg, .range_mm]]' <<<"$output")" = '[[36.8698976,[0,60]],[90,[0,20]]]' ]
    local look=(--view cone --opacity 0.5 --legend none -q) # else it is seen across, in glass, and called a beam
    conus render nested.nii.gz "${beam[@]}" "${look[@]}" -o a.png
    conus render nested.nii.gz --origin 0,0,0 --toward 0,0,60 --angle 36.86989764584402 --range 0,60 --layers all \
        "${look[@]}" -o b.png
    cmp a.png b.png
    fails 2 '--focus has no effect without --transducer' query nested.nii.gz --focus 0,0,0
    fails 2 '--focus needs --aperture-diameter' query nested.nii.gz --focus 0,0,0 --transducer 0,0,60
    fails 2 'exclude each other' query nested.nii.gz "${beam[@]}" --angle 3
    fails 2 'another point is needed' query nested.nii.gz --focus 0,0,0 --transducer 0,0,0 --aperture-diameter 40
    fails 2 'exclude each other' query nested.nii.gz $AIM --aperture-diameter 40
}
