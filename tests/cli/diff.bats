#!/usr/bin/env bats
# conus diff, as a user types it.
load helpers

result() {
    printf 'query\tkind\tindex\tname\tpixels\tshare\n'
    printf '1\tarea\t11\tFrontal\t188\t%s\n' "${1:-0.9}"
    printf '1\tarea\t%s\tPrecentral\t16\t0.1\n' "${2:-1}"
}

@test "equal results are the same" {
    result >a.tsv
    answers diff a.tsv a.tsv
    [ "$output" = "2 rows the same, 0 changed, 0 removed, 0 added" ]
}

@test "the order of rows and the line ends do not matter" {
    result >a.tsv
    { head -1 a.tsv; tail -1 a.tsv; sed -n 2p a.tsv; } | sed 's/$/\r/' >b.tsv
    answers diff a.tsv b.tsv
}

@test "changes are named with column and values, within a tolerance" {
    result >a.tsv
    result 0.91 >b.tsv
    run -1 conus diff a.tsv b.tsv
    [ "${lines[0]}" = "changed   query 1: area 11 Frontal: share 0.9 -> 0.91" ]
    [ "${lines[1]}" = "1 rows the same, 1 changed, 0 removed, 0 added" ]
    answers diff a.tsv b.tsv --tolerance 0.0101
    run -1 conus diff a.tsv b.tsv --tolerance 0.009
}

# Columns of names and labels are compared as texts, also where they look like numbers; so are columns that no result of
# conus has.
@test "names that look like numbers are no numbers" {
    head='query\tkind\tindex\tname\tabbreviation\tatlas\tshare\tgroup\n'
    row='1\tarea\t1\t%s\t%s\taal\t%s\t%s\n'
    printf "$head$row" 1e1 4 0.10 7 >a.tsv
    printf "$head$row" 10 4 0.1 7 >b.tsv
    run -1 conus diff a.tsv b.tsv
    [ "${lines[0]}" = "changed   query 1, aal: area 1 1e1: name 1e1 -> 10" ]
    for cells in '10 4.0 0.1 7' '11 4 0.1 7' '10 4 0.1 07'; do
        printf "$head$row" $cells >c.tsv
        run -1 conus diff b.tsv c.tsv --tolerance 1
        [ "${lines[1]}" = "0 rows the same, 1 changed, 0 removed, 0 added" ]
    done
    printf "$head$row" 10 4 1e-1 7 >c.tsv
    answers diff b.tsv c.tsv
    printf 'query\tkind\tindex\tname\trunner_up\trunner_up_index\tmargin\n1\tarea\t1\tA\t4\t4\t0.5\n' >a.tsv
    for other in '5\t4\t0.5' '4\t5\t0.5'; do
        printf 'query\tkind\tindex\tname\trunner_up\trunner_up_index\tmargin\n1\tarea\t1\tA\t'"$other\n" >b.tsv
        run -1 conus diff a.tsv b.tsv --tolerance 1
    done
}

# A column with a number as a name must be one of these: every other column of every result has numbers.
@test "columns are of names or of numbers as their cells are" {
    conus phantom nested -o . --size 24 --spacing 3,3,3
    conus phantom bundle -o .
    aim='--origin 0,-100,3 --toward 0,0,0 --angle 30 -q'
    printf 'x\ty\tz\ttx\tty\ttz\n0\t-100\t0\t0\t0\t0\n' >poses.tsv
    printf 'time_s\tx\ty\tz\ttx\tty\ttz\n0\t0\t0\t90\t0\t0\t0\n' >hand.tsv
    conus query nested.nii.gz $aim --layers all --streamlines bundle.tck --voxels voxels.tsv --voxels-of all --segments segments.tsv \
        --endpoints ends.tsv -o q.tsv
    conus sweep nested.nii.gz $aim -o admissions.tsv
    conus sweep nested.nii.gz --origin 0,-100,0 --toward 0,0,0 --angles 7 -q -o shares.tsv
    conus sweep nested.nii.gz $aim --jitter 2,2 --samples 16 -o chances.tsv
    conus overlap nested.nii.gz nested.nii.gz --threshold 300 -q -o coverages.tsv
    conus batch nested.nii.gz --poses poses.tsv --summary -q -o summary.tsv
    conus track nested.nii.gz --poses hand.tsv -q -o track.tsv
    run -0 python3 "$BATS_TEST_DIRNAME/columns.py" "$CONUS" ./*.tsv
    echo "$output"
    [ "${#lines[@]}" -eq 1 ]
    [[ "$output" =~ ^([0-9]+)" columns tried" ]]
    [ "${BASH_REMATCH[1]}" -ge 90 ]
}

@test "added and removed rows and columns are named" {
    result >a.tsv
    result 0.9 2 | sed 's/pixels/pixel/' >b.tsv
    run -1 conus diff a.tsv b.tsv
    has "column    pixels is only in the first"
    has "column    pixel is only in the second"
    has "removed   query 1: area 1 Precentral"
    has "added     query 1: area 2 Precentral"
    has "1 rows the same, 0 changed, 1 removed, 1 added"
}

@test "connections are rows of a bundle and two ends" {
    printf 'query\tkind\tbundle\tend_a\tend_b\tstreamlines\tbundle_index\tend_a_index\tend_b_index\n' >a.tsv
    printf '1\tbundle\tArc\tA\tB\t%s\t1\t11\t12\n1\tbundle\tArc\tA\tunassigned\t%s\t1\t11\tn/a\n' 7 5 >>a.tsv
    answers diff a.tsv a.tsv
    [ "$output" = "2 rows the same, 0 changed, 0 removed, 0 added" ]
    sed 's/B\t7/B\t8/; s/unassigned/C/; s,n/a,13,' a.tsv >b.tsv
    run -1 conus diff a.tsv b.tsv
    [ "${lines[0]}" = "changed   query 1: bundle 1 Arc A B: streamlines 7 -> 8" ]
    [ "${lines[1]}" = "removed   query 1: bundle 1 Arc A unassigned" ]
    [ "${lines[2]}" = "added     query 1: bundle 1 Arc A C" ]
    { cat a.tsv; tail -1 a.tsv; } >b.tsv
    fails 3 'b.tsv:4: the same query, kind and index as another line' diff a.tsv b.tsv
}

@test "lists of different things are refused" {
    result >a.tsv
    printf 'query\tkind\tbundle\tbundle_index\tend_a\tend_a_index\tend_b\tend_b_index\n' >b.tsv
    printf '1\tarea\tArc\t1\tA\t11\tB\t12\n' >>b.tsv
    fails 2 'a.tsv and b.tsv are lists of different things: one has a column "index", the other has none' diff a.tsv b.tsv
    sed '1s/$/\ti\tj\tk/; 2,$s/$/\t1\t2\t3/' a.tsv >c.tsv
    fails 2 'one has a column "i", the other has none' diff c.tsv a.tsv
}

@test "files that are no results are refused" {
    result >a.tsv
    fails 3 'none.tsv: cannot open: No such file or directory' diff a.tsv none.tsv
    fails 3 '.: cannot read: is a folder, a file or pipe is needed' diff a.tsv .
    : >b.tsv
    fails 3 'b.tsv: is empty' diff a.tsv b.tsv
    echo '{"rows": []}' >b.tsv
    fails 3 'b.tsv: looks like JSON' diff a.tsv b.tsv
    echo 'hello' >b.tsv
    fails 3 'b.tsv: no column "query": not a TSV or CSV result of conus' diff a.tsv b.tsv
    { result; printf '1\tarea\n'; } >b.tsv
    fails 3 'b.tsv:4: 2 fields, the header has 6' diff a.tsv b.tsv
    { result; result | tail -1; } >b.tsv
    fails 3 'b.tsv:4: the same query, kind and index as another line' diff a.tsv b.tsv
    fails 2 '--tolerance: -1 is out of range' diff a.tsv a.tsv --tolerance -1
}

@test "endless files are not read: devices not at all, pipes up to --max-memory" {
    result >a.tsv
    for device in /dev/zero /dev/null; do
        run -3 --separate-stderr timeout 60 "$CONUS" diff a.tsv $device
        check_message "$device: cannot read: is a device, a file or pipe is needed"
    done
    run -3 --separate-stderr timeout 60 "$CONUS" diff a.tsv <(yes) --max-memory 1M
    check_message 'more than the 1048576 bytes that are read'
    fails 3 "a.tsv: more than the 10 bytes that are read" diff a.tsv a.tsv --max-memory 10
    "$CONUS" diff a.tsv a.tsv --max-memory "$(wc -c <a.tsv)"
    "$CONUS" diff a.tsv <(cat a.tsv)
}

@test "control characters in names do not reach the terminal" {
    result >a.tsv
    sed $'s/Frontal/\x1b]0;title\x07\xc2\x9b31m\xe2\x80\xaelatnorF/' a.tsv >b.tsv
    not cmp -s a.tsv b.tsv
    run -1 conus diff a.tsv b.tsv
    [[ "$output" != *$'\x1b'* && "$output" != *$'\xc2\x9b'* && "$output" != *$'\xe2\x80\xae'* ]]
    has ' ]0;title  31m latnorF'
}

@test "two runs of one query are the same, another angle is not" {
    sphere --size 32
    local aim='--origin 0,0,100 --toward 0,0,0'
    conus query sphere.nii.gz $aim --angle 30 -o a.tsv
    conus query sphere.nii.gz $aim --angle 30 -o b.tsv
    answers diff a.tsv b.tsv
    conus query sphere.nii.gz $aim --angle 31 --force -o b.tsv
    run -1 conus diff a.tsv b.tsv
    has "changed   query 1: area 1 Sphere:"
}

@test "pictures are compared channel by channel" {
    sphere --size 32
    local aim='--origin 0,0,100 --toward 0,0,0 --force -o out.txt'
    conus query sphere.nii.gz $aim --angle 30 --image a.exr
    conus query sphere.nii.gz $aim --angle 30 --image b.exr
    conus query sphere.nii.gz $aim --angle 31 --image c.exr
    conus query sphere.nii.gz $aim --angle 30 --image d.exr --resolution 8
    conus query sphere.nii.gz $aim --angle 30 --image a.png
    answers diff a.exr b.exr
    [ "$output" = "0 of 4096 pixels differ" ]
    answers diff a.png a.png
    run -1 conus diff a.exr c.exr
    [[ "$output" =~ ^[1-9][0-9]*\ of\ 4096\ pixels\ differ\ by\ more\ than\ 0\;.*channel ]]
    run -1 conus diff a.exr d.exr
    [ "$output" = "the first is 64 x 64 pixels, the second 8 x 8" ]
    run -1 conus diff c.exr a.exr --tolerance 1e-9
    fails 2 'a.exr is a picture and out.txt is not' diff a.exr out.txt
    fails 3 'none.png: cannot open' diff a.png none.png
    echo text >text.png
    fails 3 'text.png: ' diff a.png text.png
}
