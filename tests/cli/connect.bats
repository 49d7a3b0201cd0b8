#!/usr/bin/env bats
# conus connect, query --endpoints and --connectivity: the areas that streamlines connect.

load helpers

@test "without streamlines there is nothing to connect" {
    conus phantom u-shape -o .
    fails 2 "no streamlines" connect u-shape.nii.gz
    fails 2 "no streamlines" query u-shape.nii.gz --point 0,0,0 --radius 9 --endpoints rows.tsv
    fails 2 "no streamlines" query u-shape.nii.gz --point 0,0,0 --radius 9 --connectivity rows.tsv
    [ ! -e rows.tsv ]
}

@test "options that cannot be are refused" {
    conus phantom u-shape -o .
    fails 2 "allowed are 0 to 100" connect u-shape.nii.gz --endpoint-radius 101
    fails 2 "allowed are 0 to 100" connect u-shape.nii.gz --endpoint-radius=-1
    fails 2 "no effect without" query u-shape.nii.gz --point 0,0,0 --radius 9 --endpoint-radius 1
    fails 2 "ends in none of .tsv, .csv and .json" connect u-shape.nii.gz --connectivity matrix.txt
    fails 2 "needs a file" query u-shape.nii.gz --point 0,0,0 --radius 9 --endpoints -
    fails 2 "are the same file" connect u-shape.nii.gz -o rows.tsv --connectivity rows.tsv
    fails 2 "would overwrite" connect u-shape.nii.gz --connectivity u-shape.tsv
    fails 2 "--connectivity" connect u-shape.nii.gz --atlas u-shape.nii.gz --connectivity matrix.tsv
}

# The arms of the U are boxes from x = -22 to -12 and 12 to 22, the ball reaches from -5 to 5. The streamlines: two from
# arm to arm, the second from right to left, at z = 15; one from the left arm to the ball; one to 1.5 mm before the
# right arm; and one in no area.
lines() {
    conus phantom u-shape -o .
    python3 "$BATS_TEST_DIRNAME/tck.py" lines.tck -17,0,5 17,0,5 -- 17,0,5 -17,0,15 17,0,5 -- -17,0,5 0,0,5 -- \
        0,0,5 10.5,0,5 -- 0,40,0 0,50,0
    U='u-shape.nii.gz --streamlines lines.tck'
}

# rows FILE: ends, streamlines and lengths.
rows() {
    cut -f 4,5,6,8 "$1" | sed 1d | tr '\t\n' ' ;'
}

@test "rows of whole bundles, with a sidecar that is verified" {
    lines
    run -0 conus connect $U -q -o rows.tsv --connectivity matrix.tsv
    [ "$(head -1 rows.tsv | tr '\t' ' ')" = "query kind bundle end_a end_b streamlines fraction mean_length_mm bundle_index end_a_index end_b_index" ]
    # 34 mm, and there and back with 10 mm across: 2 * sqrt(34^2 + 10^2) = 70.880; 17 and 10.5 mm; 10 mm
    [ "$(rows rows.tsv)" = "U U 2 52.4400903;U Ball 2 13.75;unassigned unassigned 1 10;" ]
    [ "$(sed -n 3p rows.tsv | tr '\t' ' ')" = "1 bundle lines U Ball 2 0.4 13.75 1 1 2" ]
    [ "$(tr '\t\n' ' ;' <matrix.tsv)" = "area U Ball unassigned;U 2 2 0;Ball 2 0 0;unassigned 0 0 1;" ]
    [ "$(jq -r '.Queries[0].endpoint_radius_mm' rows.json)" = 2 ]
    says_identical rows.tsv
}

says_identical() {
    run -0 conus verify "$1"
    has identical
}

@test "streamlines of another unit are warned of" {
    lines
    run -0 --separate-stderr conus connect $U -q
    [[ "$stderr" != *"at either end"* ]] # one of five has no area
    python3 "$BATS_TEST_DIRNAME/tck.py" between.tck 0,15,-5 0,18,-5 -- 0,15,5 0,18,5 -- -17,0,5 17,0,5
    run -0 --separate-stderr "$CONUS" connect u-shape.nii.gz between.tck -q
    [[ "$stderr" == *'warning: 2 of 3 streamlines have no area at either end: are they in the atlas'* ]] # -q keeps it
    conus phantom nested -o . # all around
    run -0 --separate-stderr "$CONUS" connect nested.nii.gz between.tck -q --atlas u-shape.nii.gz
    [[ "$stderr" == *'warning: u-shape: 2 of 3 streamlines have'* && "$stderr" != *'nested: '*'either end'* ]]
    run -0 --separate-stderr "$CONUS" connect u-shape.nii.gz between.tck -q --only Ball,between
    [[ "$stderr" != *"at either end"* ]]
}

@test "a matrix has all areas, or those of a list in its order" {
    lines
    printf 'Ball\n# a comment\nU\n' >areas.txt
    run -0 conus connect $U -q -o rows.tsv --connectivity matrix.tsv --only @areas.txt
    [ "$(tr '\t\n' ' ;' <matrix.tsv)" = "area Ball U unassigned;Ball 0 2 0;U 2 2 0;unassigned 0 0 1;" ]
    says_identical rows.tsv
    conus connect $U -q --force -o rows.json --connectivity matrix.json --only @areas.txt
    [ "$(jq -c '[.Rows[] | [.area, .streamlines]]' matrix.json)" = \
        '[["Ball",[0,2,0]],["U",[2,2,0]],["unassigned",[0,0,1]]]' ]
    says_identical matrix.json
    python3 "$BATS_TEST_DIRNAME/tck.py" none.tck 0,40,0 0,50,0
    conus connect u-shape.nii.gz none.tck -q -o none.tsv --force --connectivity matrix.tsv
    [ "$(tr '\t\n' ' ;' <matrix.tsv)" = "area U Ball unassigned;U 0 0 0;Ball 0 0 0;unassigned 0 0 1;" ]
}

@test "a list of areas keeps all bundles, one with bundles those, and what hides them is an error elsewhere" {
    lines
    conus connect $U -q -o all.tsv --only U,Ball
    conus connect $U --streamlines lines.tck,name=other -q -o one.tsv --only U,Ball,lines
    conus connect $U --streamlines lines.tck,name=other -q -o left.tsv --only U,Ball --hide other
    [ "$(rows all.tsv)" = "$(rows one.tsv)" ]
    [ "$(rows all.tsv)" = "$(rows left.tsv)" ]
    # An end in a hidden area may get a near one, which is said; of the U's neighbours there is none.
    run -0 --separate-stderr "$CONUS" connect $U --only Ball -o ball.tsv
    check_message "note: 1 area is hidden: an end in one of them has the nearest area that is not"
    run -0 --separate-stderr "$CONUS" connect $U --only Ball -o none.tsv --endpoint-radius 0
    [ -z "$stderr" ]
    fails 2 "all streamlines are hidden" connect $U --hide lines
    fails 2 "all streamlines are hidden" query $U --point 0,0,5 --radius 9 --only U --connectivity matrix.tsv
    conus query $U --point 0,0,5 --radius 9 --only Ball,U,lines --connectivity matrix.tsv -q >answer.txt
    [ "$(head -1 matrix.tsv | tr '\t' ' ')" = "area Ball U unassigned" ]
}

@test "tractograms stand behind ATLAS" {
    lines
    conus connect $U -q -o option.tsv
    conus connect u-shape.nii.gz lines.tck -q -o operand.tsv
    cmp option.tsv operand.tsv
    says_identical operand.tsv
    conus connect u-shape.nii.gz lines.tck,name=first lines.tck,name=second --streamlines lines.tck -q -o three.tsv
    [ "$(cut -f 3 three.tsv | sed 1d | uniq | tr '\n' ' ')" = "first second lines " ]
    says_identical three.tsv
    fails 2 "FILE is empty" connect u-shape.nii.gz ""
    fails 2 "would overwrite" connect u-shape.nii.gz lines.tck -o lines.tck --format tsv --force
}

@test "the radius round an end" {
    lines
    conus connect $U -q -o near.tsv --endpoint-radius 1.4
    [ "$(rows near.tsv)" = "U U 2 52.4400903;U Ball 1 17;Ball unassigned 1 10.5;unassigned unassigned 1 10;" ]
    conus connect $U -q -o none.tsv --endpoint-radius 0
    cmp near.tsv none.tsv
    [ "$(jq -r '.Queries[0].endpoint_radius_mm' none.json)" = 0 ]
}

# A cylinder of 1 mm along y through (8, 0, 5) contains parts of the first and the fourth streamline, the next one of
# the last.
@test "streamlines in cylinders of several poses" {
    lines
    printf 'query_id\tx\ty\tz\tdx\tdy\tdz\n%s\n%s\n%s\n' $'first\t8\t-20\t5\t0\t1\t0' $'second\t0\t20\t0\t0\t1\t0' \
        $'third\t0\t-45\t0\t0\t-1\t0' >poses.tsv
    run -0 conus query $U -q --pose poses.tsv --radius 1 -o answers.tsv --endpoints ends.tsv
    [ "$(cut -f 1 ends.tsv | sed 1d | tr '\n' ' ')" = "first first second " ]
    [ "$(rows ends.tsv)" = "U U 1 34;U Ball 1 10.5;unassigned unassigned 1 10;" ]
    fails 2 "--connectivity shows one pose" query $U --pose poses.tsv --radius 1 --connectivity matrix.tsv
    says_identical ends.tsv
    says_identical answers.tsv
}

@test "streamlines in a cone, the table as CSV and JSON" {
    lines
    local aim='--origin 8,0,60 --toward 8,0,5 --angle 4 -q'
    conus query $U $aim --endpoints ends.json --connectivity matrix.json >answer.txt
    [ "$(jq -c '[.Rows[] | [.end_a, .end_b, .streamlines]]' ends.json)" = '[["U","U",2],["U","Ball",1]]' ]
    [ "$(jq -c '.Rows[] | [.area, .index, .streamlines, .mean_length_mm]' matrix.json | tr '\n' ' ')" = \
        '["U",1,[2,1,0],[52.4400903,10.5,null]] ["Ball",2,[1,0,0],[10.5,null,null]] ["unassigned",null,[0,0,0],[null,null,null]] ' ]
    [ "$(jq -r '.Atlas.volumes[0].path' matrix.json)" = u-shape.nii.gz ]
    conus query $U $aim --connectivity matrix.csv >answer.txt
    [ "$(tr -d '\r' <matrix.csv | tr '\n' ';')" = "area,U,Ball,unassigned;U,2,1,0;Ball,1,0,0;unassigned,0,0,0;" ]
    says_identical ends.json
    says_identical matrix.json
}

@test "the paragraph about it" {
    lines
    conus connect $U -q -o rows.tsv
    answers cite rows.tsv
    output=$(tr '\n' ' ' <<<"$output")
    has 'The areas at both ends of all streamlines were determined with conus'
    has 'An end was assigned to the area that it lies in, else to the nearest one within 2 mm.'
    [[ "$output" != *cone* && "$output" != *Rick* && "$output" != *geometric* ]]
    conus query $U --origin 8,0,60 --toward 8,0,5 --angle 4 -q --endpoints ends.tsv --endpoint-radius 0 >answer.txt
    answers cite ends.tsv
    output=$(tr '\n' ' ' <<<"$output")
    has "of all streamlines that come into a cone about the device's axis, with its apex at the device's position and a full"
    has 'opening angle of 4°, were determined for one pose of the device with conus'
    has 'An end was assigned to the area that it lies in. '
    [[ "$output" != *rays* && "$output" != *'the axis crosses'* ]]
}

@test "hidden areas have no ends" {
    lines
    conus connect $U -q --hide Ball -o rows.tsv
    [ "$(rows rows.tsv)" = "U U 2 52.4400903;U unassigned 2 13.75;unassigned unassigned 1 10;" ]
}

# of_atlas NAME FILE: the rows of one of several atlases, without the atlas's column.
of_atlas() {
    awk -F'\t' -v OFS='\t' -v name="$1" 'NR == 1 || $2 == name { $2 = ""; sub(OFS OFS, OFS); print }' "$2"
}

@test "several atlases answer as in commands of their own" {
    lines
    conus phantom nested -o .
    printf '1 0 0 0\n0 1 0 1\n0 0 1 0\n0 0 0 1\n' >shift.txt # y by 1 mm
    local options='--streamlines lines.tck,name=Still --streamlines lines.tck,moves,radius=1 --atlas-transform shift.txt'
    # shellcheck disable=SC2086 # words
    conus connect u-shape.nii.gz --atlas nested.nii.gz $options -q -o all.tsv
    [ "$(head -1 all.tsv | cut -f 1-4 | tr '\t' ' ')" = "query atlas kind bundle" ]
    for atlas in u-shape nested; do
        # shellcheck disable=SC2086
        conus connect $atlas.nii.gz $options -q -o of-$atlas.tsv
        of_atlas $atlas all.tsv | cmp - of-$atlas.tsv
    done
    run ! cmp -s of-u-shape.tsv of-nested.tsv
    says_identical all.tsv
}
