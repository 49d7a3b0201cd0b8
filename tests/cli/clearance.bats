#!/usr/bin/env bats
# --clearance: the distance of needles from objects, and the nearest places.
#
# The arms of u-shape are boxes with a face at x = 12 and y from -6 to 6; its ball has cells up to x = 5, whose
# outermost reach from y = -2 to 2. So a needle along y at x = 8 passes the arm at 4 mm from y = -6 on, and the ball at
# 3 mm from y = -2 on.

load helpers

NEEDLE='u-shape.nii.gz --origin 8,-20,5 --direction 0,1,0 --range 0,40 --radius 1'

u_shape() {
    conus phantom u-shape -o .
}

poses() {
    printf 'query_id\tx\ty\tz\tdx\tdy\tdz\nlost\tnan\t0\t0\t1\t0\t0\n'
    for ((i = 0; i < 40; i++)); do printf 'n%d\t%d.5\t%d\t5\t0.1\t1\t0\n' $i $((i % 13 - 6)) $((-20 - i)); done
}

@test "the nearest is first, with its place on the needle and where it lies" {
    u_shape
    conus query $NEEDLE -q --clearance rows.tsv -o answer.tsv
    [ "$(tr '\t\n' ' ;' <rows.tsv)" = "query kind index name distance_mm clearance_mm depth_mm x y z near_x near_y near_z;1 area 2 Ball 3 2 18 8 -2 5 5 -2 5;1 area 1 U 4 3 14 8 -6 5 12 -6 5;" ]
    [ "$(jq -c .Settings rows.json)" = '{"range_mm":[0,40],"radius_mm":1,"within_mm":10}' ]
    [ "$(jq -r '.Queries[0] | keys | join(" ")' rows.json)" = "query world_from_device_ras" ]
    # The tip is at y = -9, and the limit just includes the distance.
    mkdir sub=1,within=2
    conus query $NEEDLE -q --clearance sub=1,within=2/x,y.tsv -o again.tsv # folders may be called anything
    cmp rows.tsv sub=1,within=2/x,y.tsv
    answers query ${NEEDLE/0,40/0,11} -q --clearance -,within=4 --format tsv
    [ "$(sed 1d <<<"$output" | tr '\t' ' ')" = "1 area 1 U 5 4 11 8 -9 5 12 -6 5" ]
    printf 'x\ty\tz\tdx\tdy\tdz\tfar\n8\t-20\t5\t0\t1\t0\t11\n' >own.tsv # the same tip, from the row's own range
    [ "$(conus query u-shape.nii.gz --pose own.tsv --range 0,40 --radius 1 -q --clearance -,within=4 --format tsv)" = "$output" ]
    answers query ${NEEDLE/0,40/0,11} -q --clearance -,within=3.999
    has 'no area, pathway or bundle is that near'
}

@test "a list of axes without an end has a note, and one that states it has none" {
    u_shape
    printf 'x\ty\tz\tdx\tdy\tdz\n8\t-20\t5\t0\t1\t0\n' >endless.tsv
    run conus query u-shape.nii.gz --pose endless.tsv --radius 1 --clearance rows.tsv -o answer.tsv
    has 'axes without an end go on behind their targets: --range 0,target ends them there'
    run conus query u-shape.nii.gz --pose endless.tsv --radius 1 --clearance rows.tsv -o answer.tsv --range 0,40
    [[ "$output" != *'axes without an end'* ]]
}

@test "people read what touches and what is pierced, other formats have the numbers" {
    u_shape
    conus phantom sphere -o . # of 20 mm around 0, which begins at depth 3
    conus query ${NEEDLE/--radius 1/--radius 3} -q --atlas sphere.nii.gz --clearance rows.txt -o answer.txt
    grep -q '^needle of radius 3 mm from (8.00, -20.00, 5.00) along (0.0000, 1.0000, 0.0000), 0 to 40 mm deep, RAS mm$' rows.txt
    grep -qE '^Ball +2 +touches +3.00 +18.00 ' rows.txt
    grep -qE '^U +1 +1.00 +4.00 +14.00 +8.00 +-6.00 +5.00 +12.00 +-6.00 +5.00$' rows.txt
    grep -qE '^Sphere +1 +pierces +0.00 ' rows.txt
    for ending in tsv csv json ndjson; do
        conus query --force ${NEEDLE/--radius 1/} -q --atlas sphere.nii.gz --clearance rows.$ending -o answer.$ending
    done
    [ "$(cut -f 2,5-7 rows.tsv | tr '\t\n' ' ;' | cut -d' ' -f 1-9)" = "atlas name distance_mm clearance_mm;u-shape Ball 3 3;u-shape U 4" ]
    [ "$(tr ',' '\t' <rows.csv | tr -d '\r' | cmp - rows.tsv && echo same)" = same ]
    [ "$(jq -r '.Rows | length' rows.json)" -eq 3 ]
    [ "$(jq -r .clearance_mm rows.ndjson | head -2 | tr '\n' ' ')" = '3 4 ' ]
}

@test "a batch has the rows of a query, beside segments and answers, in shards and by verify" {
    u_shape
    poses >poses.tsv
    needle='--range 0,60 --radius 0.5 -q'
    run -1 conus query u-shape.nii.gz --pose poses.tsv $needle --clearance wanted.tsv,within=7 -o answer.tsv
    [ "$(sed -n 2p wanted.tsv | cut -f 1-5)" = $'lost\terror\tn/a\tline 2: column x: "nan" is not a finite number\tn/a' ]
    run -1 --separate-stderr conus batch u-shape.nii.gz --poses poses.tsv $needle --threads 3 --block 4 \
        --clearance rows.tsv,within=7 --segments segments.tsv -o answers.tsv
    [ "$(wc -l <<<"$stderr")" -eq 1 ] # the note about the poses is given once
    cmp wanted.tsv rows.tsv
    cmp answer.tsv answers.tsv
    for part in 1/3 all/3; do
        conus batch u-shape.nii.gz --poses poses.tsv $needle --clearance joined.tsv,within=7 --shard $part || [ $part = all/3 ]
    done
    cmp wanted.tsv joined.tsv
    run -1 conus batch u-shape.nii.gz --poses poses.tsv $needle --clearance rows.tsv,within=7 # nothing is left to do
    fails 2 'there is a file already' batch u-shape.nii.gz --poses poses.tsv $needle --clearance rows.tsv,within=8
    for file in wanted rows joined; do
        run -0 "$CONUS" verify $file.tsv
        has "$file.tsv: identical"
    done
}

@test "invalid options are refused with a line" {
    u_shape
    for wrong in -1 x nan 1001 ''; do
        fails 2 "--clearance: within: found \"$wrong\", allowed is a number of mm from 0 to 1000" query $NEEDLE --clearance "rows.tsv,within=$wrong"
    done
    fails 2 'within: found "x", allowed is a number' batch u-shape.nii.gz --poses poses.tsv --clearance rows.tsv,within=x
    fails 2 '--clearance: found "with=3", allowed are within; did you mean within?' query $NEEDLE --clearance rows.tsv,with=3
    fails 2 'a number has a decimal point' query $NEEDLE --clearance rows.tsv,within=1,5
    fails 2 '",within=3" names no file' query $NEEDLE --clearance ,within=3
    fails 2 'are both on standard output' query $NEEDLE --clearance - --segments -
    fails 2 '--segments and --clearance are the same file' query $NEEDLE --clearance rows.tsv,within=3 --segments rows.tsv
    fails 2 '--clearance u-shape.tsv would overwrite' query $NEEDLE --clearance u-shape.tsv
    fails 2 'hold no clearance' query $NEEDLE --clearance - --format afni
    fails 2 '--point and --clearance exclude each other' query u-shape.nii.gz --point 0,0,0 --radius 2 --clearance rows.tsv
    fails 2 'needs --toward PLACE or --direction' query u-shape.nii.gz --origin 0,0,0 --clearance rows.tsv
    poses >poses.tsv
    fails 2 '--segments and --clearance are the same file' batch u-shape.nii.gz --poses poses.tsv --clearance - --segments -
    fails 2 '--segments and --clearance have one sidecar, a.json' batch u-shape.nii.gz --poses poses.tsv --clearance a.tsv --segments a.csv
    fails 2 'would overwrite the input' batch u-shape.nii.gz --poses poses.tsv --clearance poses.tsv --force
    [ ! -e rows.tsv ] && [ ! -e a.csv ]
    printf '0 0 5 A1\n' >points.txt
    answers query u-shape.nii.gz --pose points.txt --radius 2 --clearance points.tsv
    tail -1 points.tsv | cut -f 2,4 | grep -qx $'error\tline 1: a point, without the direction that an axis needs'
}
