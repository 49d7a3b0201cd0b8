#!/usr/bin/env bats
# --segments: the objects along an axis; --order depth; and shanks for SpikeGLX and Open Ephys.
#
# The U of u-shape: arms of 10 mm from x = -22 to -12 and 12 to 22, and a ball of 5 mm radius between them, in voxels of
# 1 mm whose faces are at whole numbers. An axis from x = 40 along -x at z = 5 passes arm, ball and arm at the depths 18
# to 28, 35 to 45 and 52 to 62.

load helpers

AXIS='u-shape.nii.gz --origin 40,0,5 --direction=-1,0,0'

u_shape() {
    conus phantom u-shape -o .
}

# depths FILE: kind, name, entry and exit of each row.
depths() {
    cut -f 3,5,7,8 "$1" | sed 1d | tr '\t\n' ' ;'
}

shanks() {
    printf 'query_id\tx\ty\tz\ttx\tty\ttz\nfirst\t40\t0\t5\t0\t0\t5\nsecond\t40\t0\t4.5\t0\t0\t4.5\n'
}

@test "each crossing has a row, and so has what lies between" {
    u_shape
    run -0 --separate-stderr conus query --force $AXIS --range 0,80 --segments rows.tsv
    [[ $output == cone\ of* ]]
    [ "$(depths rows.tsv)" = "unassigned unassigned 0 18;area U 18 28;unassigned unassigned 28 35;area Ball 35 45;unassigned unassigned 45 52;area U 52 62;unassigned unassigned 62 80;" ]
    [ "$(head -1 rows.tsv | tr '\t' ' ')" = "query order kind index name abbreviation entry_mm exit_mm length_mm entry_x entry_y entry_z exit_x exit_y exit_z" ]
    [ "$(sed -n 3p rows.tsv | tr '\t' ' ')" = "1 2 area 1 U U 18 28 10 22 0 5 12 0 5" ]
    [ "$(jq -r '.Settings.range_mm | join(" ")' rows.json)" = "0 80" ]
    [ "$(jq -r '.Settings | has("engine")' rows.json)" = false ]
    [ "$(jq -r '.Queries[0] | keys | join(" ")' rows.json)" = "query world_from_device_ras" ]
    [ "$(jq -r '.entry_mm.Units' rows.json)" = mm ]
}

# The arm begins at x = 22, and an axis at 24.5 2.5 mm before it.
@test "rows of needles say that one begins outside of all objects" {
    u_shape
    printf 'name,entry_x,entry_y,entry_z,target_x,target_y,target_z\nA,22,0,5,-18,0,5\nB,24.5,0,5,-18,0,5\n' >needles.csv
    run -0 --separate-stderr conus query u-shape.nii.gz --pose needles.csv --segments rows.tsv
    [[ "$stderr" == "conus: note: 1 axis begins outside of the atlas's objects (the first in line 3, 2.50 mm before one): \
depths are from the position of a pose, not from the surface" ]]
    run -0 --separate-stderr conus query u-shape.nii.gz --pose needles.csv --segments rows.tsv -q --force
    [ -z "$stderr" ]
    # From 1.5 mm deep on, an axis begins 1 mm before the arm; its depths are still from x = 24.5.
    run -0 --separate-stderr conus query u-shape.nii.gz --pose needles.csv --range 1.5,target --segments rows.tsv --force
    [[ "$stderr" == *"1 axis begins outside of the atlas's objects (the first in line 3, 1.00 mm before one)"* ]]
    run -0 --separate-stderr conus query --force $AXIS --range 0,80 --segments rows.tsv # no needle
    [ -z "$stderr" ]
}

@test "without a range the last object is the last row, and nothing has one row" {
    u_shape
    answers query $AXIS --segments - --format tsv -q
    [ "$(depths - <<<"$output")" = "unassigned unassigned 0 18;area U 18 28;unassigned unassigned 28 35;area Ball 35 45;unassigned unassigned 45 52;area U 52 62;" ]
    answers query u-shape.nii.gz --origin 40,0,5 --direction 1,0,0 --segments - --format tsv -q
    [ "$(depths - <<<"$output")" = "unassigned unassigned 0 n/a;" ]
}

@test "cones, cylinders, layers and engines pass the same" {
    u_shape
    conus query $AXIS -q --segments plain.tsv >cone.txt
    conus query $AXIS -q --radius 3 --layers all --resolution 32 --segments tube.tsv >tube.txt
    conus query $AXIS -q --sampling slices --angle 60 --segments slices.tsv >slices.txt
    cmp plain.tsv tube.tsv
    cmp plain.tsv slices.tsv
}

@test "the ending says the format, - is in place of the answer" {
    u_shape
    for ending in tsv csv json ndjson txt; do
        conus query --force $AXIS -q --segments rows.$ending -o answer.$ending
    done
    [ "$(jq -r '.Rows | length' rows.json)" -eq 6 ]
    [ "$(wc -l <rows.ndjson)" -eq 6 ]
    [ "$(tr ',' '\t' <rows.csv | tr -d '\r' | cmp - rows.tsv && echo same)" = same ]
    grep -q '^order  name' rows.txt
    conus query $AXIS -q --segments - >stdout.txt
    cmp rows.txt stdout.txt
    conus query $AXIS -q --segments - -o answer2.tsv >stdout.txt
    cmp rows.txt stdout.txt
    cmp answer.tsv answer2.tsv
}

@test "what cannot be written is refused with a line" {
    u_shape
    fails 2 'ends in none of .tsv, .csv' query $AXIS --segments rows.xlsx
    fails 2 "formats of other programs hold no segments" query $AXIS --segments - --format afni
    fails 2 '--point and --segments exclude each other' query u-shape.nii.gz --point 0,0,0 --radius 2 --segments rows.tsv
    fails 2 'the same file' query $AXIS -o rows.tsv --segments rows.tsv
    fails 2 '--segments u-shape.tsv would overwrite' query $AXIS --segments u-shape.tsv
    fails 2 'in formats up to NDJSON' query $AXIS --order depth --format afni
    fails 2 '--order has no effect' query $AXIS --order depth --segments -
    fails 2 '--sidecar has no effect' query $AXIS --sidecar rows.json --segments -
    shanks >poses.tsv
    fails 2 'ends in none of .tsv, .csv, .ndjson' batch u-shape.nii.gz --poses poses.tsv --segments rows.json
    fails 2 'the same file' batch u-shape.nii.gz --poses poses.tsv -o rows.tsv --segments rows.tsv
    fails 2 'would overwrite the input' batch u-shape.nii.gz --poses poses.tsv --segments poses.tsv --force
    fails 2 'would overwrite the input' batch u-shape.nii.gz --poses poses.tsv -o poses.tsv --segments rows.tsv --force
    fails 2 'the same file' batch u-shape.nii.gz --poses poses.tsv -o - --segments -
    fails 2 '--summary has no effect without --output' batch u-shape.nii.gz --poses poses.tsv --segments rows.tsv --summary
    fails 2 '--order has no effect without --output' batch u-shape.nii.gz --poses poses.tsv --segments rows.tsv --order depth
    fails 2 'needs a file of poses, not standard input' batch u-shape.nii.gz --poses - -o a.tsv --segments b.tsv <poses.tsv
    fails 2 "formats of other programs hold no segments" batch u-shape.nii.gz --poses poses.tsv --segments rows.txt --format bids
    [ ! -e rows.tsv ]
}

@test "several atlases, moved ones and hidden objects are heard" {
    u_shape
    conus phantom sphere -o .
    conus query --force $AXIS --atlas sphere.nii.gz -q --segments rows.tsv -o answer.tsv
    [ "$(cut -f 2,3,6 rows.tsv | tr '\t\n' ' ;')" = "atlas order name;u-shape 1 unassigned;u-shape 2 U;u-shape 3 unassigned;u-shape 4 Ball;u-shape 5 unassigned;u-shape 6 U;sphere 1 unassigned;sphere 2 Sphere;" ]
    conus query $AXIS --hide Ball -q --segments hidden.tsv -o hidden-answer.tsv
    [ "$(depths hidden.tsv)" = "unassigned unassigned 0 18;area U 18 28;unassigned unassigned 28 52;area U 52 62;" ]
    printf '1 0 0 10\n0 1 0 0\n0 0 1 0\n0 0 0 1\n' >shift.txt # x of the atlas is x of the pose + 10
    conus query $AXIS --atlas-transform shift.txt -q --segments moved.tsv -o moved-answer.tsv
    [ "$(sed -n 3p moved.tsv | cut -f 7-10,16-21 | tr '\t' ' ')" = "28 38 10 12 22 0 5 12 0 5" ]
    [ "$(head -1 moved.tsv | cut -f 16-21 | tr '\t' ' ')" = "atlas_entry_x atlas_entry_y atlas_entry_z atlas_exit_x atlas_exit_y atlas_exit_z" ]
}

@test "rows without a pose and points have a row of kind error" {
    u_shape
    { shanks && printf 'lost\tnan\t0\t0\t0\t0\t0\n'; } >poses.tsv
    run -1 --separate-stderr conus query --force u-shape.nii.gz --pose poses.tsv --segments rows.tsv -o answer.tsv
    [ "$(tail -1 rows.tsv | cut -f 1-3)" = "$(printf 'lost\tn/a\terror')" ]
    run -1 --separate-stderr conus batch u-shape.nii.gz --poses poses.tsv --segments batch.tsv
    cmp rows.tsv batch.tsv
    printf '0 0 5 A1\n' >points.txt
    answers query u-shape.nii.gz --pose points.txt --radius 2 --segments points.tsv
    tail -1 points.tsv | cut -f 3,5 | grep -qx $'error\tline 1: a point, without the direction that an axis needs'
}

@test "a batch has the rows of a query, in parts and again" {
    u_shape
    for ((i = 0; i < 40; i++)); do printf '%d\t0\t%d\t0\t0\t5\n' $((40 + i)) $((i % 7)); done | sed '1i x\ty\tz\ttx\tty\ttz' >poses.tsv
    conus query --force u-shape.nii.gz --pose poses.tsv -q --segments wanted.tsv -o answer.tsv
    conus batch u-shape.nii.gz --poses poses.tsv -q --segments rows.tsv --threads 3 --block 4
    cmp wanted.tsv rows.tsv
    conus batch u-shape.nii.gz --poses poses.tsv -q --segments both.tsv -o both-rows.tsv
    cmp wanted.tsv both.tsv
    cmp answer.tsv both-rows.tsv
    conus batch u-shape.nii.gz --poses - -q --segments - <poses.tsv | cmp wanted.tsv -
    for part in 2/3 all/3; do
        conus batch u-shape.nii.gz --poses poses.tsv -q --segments joined.tsv -o joined-rows.tsv --shard $part
    done
    cmp wanted.tsv joined.tsv
    cmp answer.tsv joined-rows.tsv
    answers diff wanted.tsv joined.tsv
    conus batch u-shape.nii.gz --poses poses.tsv -q --segments rows.tsv # there is nothing left to do
    fails 2 'there is a file already' batch u-shape.nii.gz --poses poses.tsv -q --range 0,30 --segments rows.tsv
    conus batch u-shape.nii.gz --poses poses.tsv -q --segments in-csv.csv
    conus batch u-shape.nii.gz --poses poses.tsv -q --segments in-ndjson.ndjson
    [ "$(wc -l <in-ndjson.ndjson)" -eq "$(sed 1d wanted.tsv | wc -l)" ]
}

@test "a shank may begin inside an area, and is told where it points away" {
    u_shape
    printf 'x\ty\tz\ttx\tty\ttz\n17\t0\t5\t0\t0\t5\n' >inside.tsv
    printf 'x\ty\tz\ttx\tty\ttz\n40\t0\t5\t90\t0\t5\n' >away.tsv
    run -0 --separate-stderr conus batch u-shape.nii.gz --poses inside.tsv --segments rows.tsv
    [[ $stderr != *"inside"* ]]
    [ "$(sed -n 2p rows.tsv | cut -f 3,7)" = $'area\t0' ]
    run -0 --separate-stderr conus batch u-shape.nii.gz --poses away.tsv --segments away-rows.tsv
    [[ $stderr == *"away from the atlas"* ]]
}

@test "diff tells crossings of one area apart" {
    u_shape
    conus query $AXIS -q --segments a.tsv -o a-rows.tsv
    sed 's/\t52\t62\t/\t52\t61\t/' a.tsv >b.tsv
    run -1 --separate-stderr conus diff a.tsv b.tsv
    has 'query 1: area 1 U: exit_mm 62 -> 61'
    has '5 rows the same, 1 changed, 0 removed, 0 added'
}

@test "the nearest may come first" {
    u_shape
    # A cone from above the ball into the left arm: the ball is near and small, the arm far and large.
    for layers in visible all; do
        column=$([ $layers = all ] && echo entry_mm || echo distance_mm)
        answers query u-shape.nii.gz --origin 40,0,14 --toward=-10,0,2 --angle 50 --layers $layers --order depth --format tsv -q
        awk -F'\t' -v name=$column 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
            $2 == "unassigned" { end = 1; next }
            { if (end || $at[name] < last) exit 1; last = $at[name]; ranks = ranks $6 }
            END { if (!end) exit 1 }' <<<"$output"
    done
    conus query u-shape.nii.gz --origin 0,0,40 --toward 0,0,0 --angle 60 --format tsv -q >rank.tsv
    conus query u-shape.nii.gz --origin 0,0,40 --toward 0,0,0 --angle 60 --format tsv -q --order depth >depth.tsv
    sort rank.tsv | cmp - <(sort depth.tsv)
    printf 'x\ty\tz\ttx\tty\ttz\n0\t0\t40\t0\t0\t0\n' >poses.tsv
    conus batch u-shape.nii.gz --poses poses.tsv --angle 60 -q --order depth -o batch.tsv
    cmp depth.tsv batch.tsv
    [ "$(jq -r .Settings.order batch.json)" = depth ]
    run -0 --separate-stderr conus query u-shape.nii.gz --origin 0,0,40 --toward 0,0,0 --order depth
    has 'ranked by share, in order of depth;'
}

@test "shanks go to SpikeGLX from the tip up" {
    u_shape
    colour() { conus info u-shape.nii.gz --format tsv | awk -F'\t' -v name="$1" '$3 == name { print $7 }' | tr -d '#'; }
    decimal() { printf '%d,%d,%d' "0x${1:0:2}" "0x${1:2:2}" "0x${1:4:2}"; }
    u=$(decimal "$(colour U)") ball=$(decimal "$(colour Ball)")
    wanted="(18000,28000,$u,U)(35000,45000,$ball,Bal)(52000,62000,$u,U)"
    answers query $AXIS --range 0,80 --format spikeglx -q
    [ "$output" = "[0,0]$wanted" ]
    # 80 - 62 = 18 mm are below the last object; a range that ends in an area cuts it.
    answers query $AXIS --range 20,60 --format spikeglx -q
    [ "$output" = "[0,0](0,8000,$u,U)(15000,25000,$ball,Bal)(32000,40000,$u,U)" ]
    shanks >poses.tsv
    answers query u-shape.nii.gz --pose poses.tsv --range 0,80 --format spikeglx -q
    [ "$output" = "[0,0]$wanted"$'\n'"[0,1]$wanted" ]
    [ "$(conus batch u-shape.nii.gz --poses poses.tsv --range 0,80 --format spikeglx -q)" = "$output" ]
    # The range of each row counts.
    awk -v OFS='\t' '{ print $0, NR == 1 ? "near\tfar" : NR == 2 ? "20\t60" : "n/a\t80" }' poses.tsv >ranged.tsv
    answers query u-shape.nii.gz --pose ranged.tsv --format spikeglx -q
    [ "$output" = "[0,0](0,8000,$u,U)(15000,25000,$ball,Bal)(32000,40000,$u,U)"$'\n'"[0,1]$wanted" ]
    [ "$(conus batch u-shape.nii.gz --poses ranged.tsv --format spikeglx -q)" = "$output" ]
}

@test "shanks go to Open Ephys by their contacts" {
    u_shape
    shanks >poses.tsv
    u=$(conus info u-shape.nii.gz --format tsv | awk -F'\t' '$3 == "U" { print toupper(substr($7, 2)) }')
    ball=$(conus info u-shape.nii.gz --format tsv | awk -F'\t' '$3 == "Ball" { print toupper(substr($7, 2)) }')
    # Rows of two at 16, 18, ... 54 mm from the tip. U is from 18 (half-open: the depth 62 is out, 52 in) to 28.
    wanted="4-13,U,$u;20-29,Bal,$ball;38-39,U,$u"
    answers query $AXIS --range 0,80 --format open-ephys --contacts 40,2,2,16 -q
    [ "$output" = "$wanted" ]
    answers query u-shape.nii.gz --pose poses.tsv --range 0,80 --format open-ephys --contacts 40,2,2,16 -q
    [ "$output" = "$wanted;44-53,U,$u;60-69,Bal,$ball;78-79,U,$u" ]
    [ "$(conus batch u-shape.nii.gz --poses poses.tsv --range 0,80 --format open-ephys --contacts 40,2,2,16 -q)" = "$output" ]
}

@test "axes that are no shanks are refused with a line" {
    u_shape
    fails 2 'range: a shank has its tip at the far end of the range' query $AXIS --format spikeglx
    fails 2 'contacts: Open Ephys counts those of a shank' query $AXIS --range 0,80 --format open-ephys
    fails 2 'contacts: the last is 84 mm from the tip, but the range is only 80 mm long' query $AXIS --range 0,80 --format open-ephys --contacts 5,1,20,4
    fails 2 'contacts: Open Ephys needs them' query $AXIS --range 0,80 --format spikeglx --contacts 5,1,1,1
    for wrong in 5,1,1 5,1,1,1,1 x,1,1,1 1.5,1,1,1 0,1,1,1 5,0,1,1 '' nan,1,1,1; do
        fails 2 'is not COUNT,COLUMNS,PITCH,TIP' query $AXIS --range 0,80 --format open-ephys "--contacts=$wrong"
    done
    for wrong in 5,1,0,1 5,1,-1,1 5,1,1,-1 65537,1,1,1; do
        fails 2 'allowed are up to 65536' query $AXIS --range 0,80 --format open-ephys "--contacts=$wrong"
    done
    fails 2 'the shanks of a probe have none' query $AXIS --range 0,80 --format spikeglx --voxels v.tsv --voxels-of all
    jq -n '{markups: [{type: "Line", coordinateSystem: "RAS", controlPoints: [{position: [40, 0, 5]}, {position: [0, 0, 5]}]},
                      {type: "Fiducial", coordinateSystem: "RAS", controlPoints: [{position: [0, 0, 5]}]}]}' >mixed.mrk.json
    fails 2 'of the poses 1 have a direction, as shanks do, and 1 are contacts' batch u-shape.nii.gz --poses mixed.mrk.json --radius 2 --format spikeglx
    fails 2 'is a contact, and no shank' query u-shape.nii.gz --pose mixed.mrk.json --radius 2 --format spikeglx
    printf '0 0 5 A1\n' >points.txt
    fails 2 'is a contact, and no shank' query u-shape.nii.gz --pose points.txt --radius 2 --format open-ephys --contacts 5,1,1,1
}

# Balls of 24, 16 and 8 mm around 0; the target is 80 mm from the device, in the outer shell.
@test "a range ends at the target: the answer, segments, clearance and picture" {
    need_all
    conus phantom nested -o . --size 32 --spacing 2,2,2
    local aim=(--origin 0,0,100 --toward 0,0,20 --radius 1) far files
    for far in target target+10; do
        local depth
        [ "$far" = target ] && depth=80 || depth=90
        files=(--segments s.tsv --clearance c.tsv --format tsv --layers all -q --force)
        conus query nested.nii.gz "${aim[@]}" --range "5,$far" "${files[@]}" -o a.tsv
        mkdir -p wanted
        (cd wanted && conus query ../nested.nii.gz "${aim[@]}" --range "5,$depth" "${files[@]}" -o a.tsv)
        for file in a s c; do cmp "$file.tsv" "wanted/$file.tsv"; done
        [ "$(tail -1 s.tsv | cut -f 8)" = "$depth" ]
        [ "$(jq -c '.Queries[0].range_mm' a.json)" = "[5,$depth]" ]
        conus verify a.tsv
        # Each row of a file has its own; a batch says the same, and its picture ends there.
        printf 'x,y,z,tx,ty,tz\n0,0,100,0,0,20\n0,0,100,0,0,90\n' >two.csv
        conus query nested.nii.gz --pose two.csv --radius 1 --range "5,$far" "${files[@]}" -o two.tsv
        [ "$(grep -P '^1\t' two.tsv)" = "$(tail -n +2 a.tsv)" ]
        [ "$(tail -1 s.tsv | cut -f 1,8)" = "2	$((depth - 70))" ]
        conus batch nested.nii.gz --poses two.csv --radius 1 --range "5,$far" --layers all -q --force -o batch.tsv
        cmp two.tsv batch.tsv
        conus verify batch.tsv
        conus render nested.nii.gz "${aim[@]}" --range "5,$far" -q -o a.png
        conus render nested.nii.gz "${aim[@]}" --range "5,$depth" -q -o b.png
        cmp a.png b.png
        head -2 two.csv >one.csv
        conus render nested.nii.gz --pose one.csv --radius 1 --range "5,$far" -q -o a.png
        cmp a.png b.png
        conus sweep nested.nii.gz --origin 0,0,100 --toward 0,0,20 --range "5,$far" --format tsv -q >sweep.tsv
        conus sweep nested.nii.gz --origin 0,0,100 --toward 0,0,20 --range "5,$depth" --format tsv -q | cmp sweep.tsv
    done
    fails 2 'not two numbers NEAR,FAR or NEAR,target[+MM]' query nested.nii.gz "${aim[@]}" --range 0,target-1
    fails 2 'the target is 80 mm away, and NEAR is 90' query nested.nii.gz "${aim[@]}" --range 90,target
    fails 2 'the target is 80 mm away, and NEAR is 90' query nested.nii.gz "${aim[@]}" --range 90,target+5
    fails 2 'needs the target of --toward' query nested.nii.gz --origin 0,0,100 --direction 0,0,-1 --range 0,target
    fails 2 'two numbers LOW,HIGH' query nested.nii.gz "${aim[@]}" --range 5
    printf 'x,y,z,dx,dy,dz\n0,0,100,0,0,-1\n' >along.csv
    run -1 --separate-stderr conus query nested.nii.gz --pose along.csv --range 0,target --format tsv
    check_message 'along.csv:2: a direction alone, without the target'
}
