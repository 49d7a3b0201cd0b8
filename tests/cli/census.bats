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

@test "a point without a radius: what is here, and its neighbours, nearest first" {
    nested
    answers query nested.nii.gz --point 0,0,0
    [ "${lines[0]}" = 'ball of radius 8 mm around (0.00, 0.00, 0.00), RAS mm' ] # 2 mm, doubled until the inner shell, 6.6 mm off, is in the ball
    [ "${lines[1]}" = 'at the point: Core' ]
    has 'ranked by share, then distance, nearest first'
    answers query nested.nii.gz --point 0,0,0 --format json
    has '"radius_mm": 8'
    # The point 13 mm off the centre is in the inner shell; the core is 13 - 8 mm away, the outer shell 16 - 13.
    answers query nested.nii.gz --point 13,0,0 --radius 12 --format tsv
    [ "$(cell name 1)" = 'Shell outer' ] # the one with more voxels has rank 1
    answers query nested.nii.gz --point 13,0,0 --radius 12 --order depth --format tsv
    [ "$(cell name 1)" = 'Shell inner' ]
    answers query nested.nii.gz --point 13,0,0 --format tsv
    [ "$(cell name 1)" = 'Shell inner' ]
    run -0 --separate-stderr conus query nested.nii.gz --point 30,0,0 --format tsv
    check_message 'note: the point lies outside of the atlas; the nearest to it is Shell outer, 6.00 mm away'
    [ "$(cell distance_mm 1)" = 6 ]
    run -0 --separate-stderr conus query nested.nii.gz --point 300,0,0 --radius 5
    check_message 'warning: the point lies outside of the atlas; the nearest to it is Shell outer, 276.00 mm away'
    has 'at the point: no area, pathway or bundle'
    # Several atlases are asked about one ball, that of the first: 8 mm, which lies wholly in it.
    conus phantom sphere -o . --size 64
    answers query nested.nii.gz --atlas sphere.nii.gz --point 0,0,0
    has 'at the point: Sphere'
    [ "$(grep -c '^ball of radius 8 mm' <<<"$output")" -eq 1 ]
    # Counted here: voxels of 1 mm with centres at halves.
    voxels=$(awk 'BEGIN { for (i = -8.5; i < 9; i++) for (j = -8.5; j < 9; j++) for (k = -8.5; k < 9; k++)
        n += i * i + j * j + k * k <= 64; print n }')
    has "100.00 %      $voxels     $voxels.0"
    run -0 --separate-stderr conus query nested.nii.gz --point 300,0,0 --radius 5 --quiet
    check_message 'warning: the point lies outside of the atlas; the nearest to it is Shell outer, 276.00 mm away'
    answers query nested.nii.gz --point 30,0,0 --radius 5 --quiet
}

@test "points of a file with --radius are balls" {
    nested
    printf '0 0 0 origin\n0 0 20 above\n' >points.txt
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
