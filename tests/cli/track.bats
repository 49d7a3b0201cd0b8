#!/usr/bin/env bats
# conus track, as a user types it.
load helpers

# hand ROW...: poses in hand.tsv; a row is time, y of the point aimed at, trigger. The sphere of 20 mm is at the origin.
hand() {
    {
        printf 'time_s\tx\ty\tz\ttx\tty\ttz\ttrigger\n'
        for row in "$@"; do
            read -r time y trigger <<<"$row"
            printf '%s\t0\t0\t90\t0\t%s\t0\t%s\n' "$time" "$y" "${trigger:-0}"
        done
    } >hand.tsv
}

# skips TEXT ARGUMENT...: asserts that conus track ends with code 1 and one message with TEXT.
skips() {
    local text=$1
    shift
    run -1 --separate-stderr conus track "$@"
    check_message "$text"
}

@test "every step has the rows of a query, and time, selected and confirmed" {
    sphere --size 16
    hand '0 0' '0.1 0' '0.2 80 1'
    answers track sphere.nii.gz --poses hand.tsv --score intenselect_plus --resolution 16 --format tsv
    [ "${#lines[@]}" -eq 7 ]
    conus query sphere.nii.gz --origin 0,0,90 --toward 0,0,0 --format tsv | head -1 >columns
    [ "${lines[0]}" = "$(cat columns)"$'\ttime_s\tselected\tconfirmed' ]
    [ "$(cell time_s 1)/$(cell selected 1)/$(cell confirmed 1)/$(cell score 1)" = 0/1/0/0 ]
    [ "$(cell kind 2)/$(cell selected 2)" = unassigned/0 ]
    [ "$(cell time_s 5)/$(cell name 5)/$(cell pixels 5)/$(cell distance_mm 5)" = 0.2/Sphere/0/n/a ]
    [ "$(cell selected 5)/$(cell confirmed 5)/$(cell query 5)" = 1/1/3 ]
    awk -v s="$(cell score 5)" 'BEGIN { exit !(s > 0.4 && s < 0.5) }'
}

@test "--selected leaves only what is selected or confirmed" {
    sphere --size 16
    hand '0 0' '0.1 0' '0.2 80 1' '0.3 80'
    answers track sphere.nii.gz --poses hand.tsv --selected --format tsv
    [ "${#lines[@]}" -eq 5 ]
    [ "$(cell name 1)/$(cell selected 1)" = Sphere/1 ]
    [ "$(cell name 3)/$(cell selected 3)/$(cell confirmed 3)" = Sphere/0/1 ] # no object is selected by then
    [ "$(cell kind 4)/$(cell confirmed 4)" = unassigned/0 ]
}

@test "--delay 0 confirms what the press itself sees" {
    sphere --size 16
    hand '0 0' '0.1 0' '0.2 80 1'
    answers track sphere.nii.gz --poses hand.tsv --selected --delay 0 --format tsv
    [ "$(cell kind 3)/$(cell confirmed 3)" = unassigned/0 ]
    answers track sphere.nii.gz --poses hand.tsv --selected --delay 0.1 --format tsv
    [ "$(cell name 3)/$(cell confirmed 3)" = Sphere/1 ]
}

@test "a pipe is followed as it comes" {
    sphere --size 16
    mkfifo poses answers
    "$CONUS" track sphere.nii.gz --poses - --format ndjson <poses >answers &
    exec 5>poses 6<answers
    printf 'time_s\tx\ty\tz\ttx\tty\ttz\n0\t0\t0\t90\t0\t0\t0\n' >&5
    read -r -t $HANG line <&6
    [[ "$line" == '{"query":"1","kind":"area","index":1,'*'"time_s":0,"selected":1,"confirmed":0}' ]]
    read -r -t $HANG line <&6
    printf '1700000000.125\t0\t0\t90\t0\t0\t0\n' >&5
    read -r -t $HANG line <&6
    [[ "$line" == *'"time_s":1700000000.125,'* ]]
    exec 5>&-
    wait $!
    exec 6<&-
}

@test "Ctrl-C ends a silent pipe, and what it brought is kept; of a file, half would be no answer" {
    sphere --size 16
    hand '0 0' '0.1 0' '0.2 80'
    "$CONUS" track sphere.nii.gz --poses hand.tsv -o wanted.tsv
    mkfifo silent
    for signal in INT TERM; do
        env --default-signal=INT "$CONUS" track sphere.nii.gz --poses - -o "$signal.tsv" <silent 3>&- &
        exec 5>silent
        { cat hand.tsv; printf '0.3\t0\t0'; } >&5
        wait_until $! catches_signals $! # it has read the header by then, and everything that came with it
        kill -"$signal" $!
        wait $!
        exec 5>&-
        cmp wanted.tsv "$signal.tsv"
    done
    awk 'NR == 1; NR == 2 { for (i = 0; i < 300000; i++) print }' hand.tsv >long.tsv
    env --default-signal=INT "$CONUS" track sphere.nii.gz --poses long.tsv -o long.steps.tsv 3>&- &
    wait_until $! is_conus $!
    kill -INT $!
    wait $! && return 1 || [ $? -eq 130 ]
    [ ! -e long.steps.tsv ]
}

@test "rows that are no step are left out, with a message each" {
    sphere --size 16
    hand '0 0' '0.1 0' '0.2 0'
    conus track sphere.nii.gz --poses hand.tsv --score intenselect --format tsv | cut -f 2- >clean
    hand '0 0' '0.1 0' '0.05 80' '0.2 0'
    skips 'hand.tsv:4: time_s: 0.05 is before the last step, 0.1' sphere.nii.gz --poses hand.tsv --score intenselect --format tsv
    diff clean <(cut -f 2- <<<"$output")
    hand '0 0' '0.1 0' '0.15 nan' '0.2 0'
    skips 'hand.tsv:4: column ty: "nan" is not a finite number' sphere.nii.gz --poses hand.tsv --score intenselect --format tsv
    diff clean <(cut -f 2- <<<"$output")
    hand '0 0' '0.1 0' 'n/a 80' '0.2 0'
    skips 'hand.tsv:4: no time_s, which a step needs' sphere.nii.gz --poses hand.tsv --score intenselect --format tsv
    diff clean <(cut -f 2- <<<"$output")
}

@test "poses without times are refused as a whole, in every format" {
    sphere --size 16
    printf 'x\ty\tz\ttx\tty\ttz\n0\t0\t90\t0\t0\t0\n0\t0\t90\t0\t0\t0\n' >still.tsv
    fails 3 'still.tsv: no time_s in it, which every step needs' track sphere.nii.gz --poses still.tsv --format tsv
    printf '0 0 90\n0 0 80\n' >points.txt
    fails 3 'standard input: no time_s in it' track sphere.nii.gz --poses - <points.txt
    fails 3 'lines.mrk.json: no time_s in it' track sphere.nii.gz \
        --poses "$BATS_TEST_DIRNAME/../fuzz/corpus/poses/lines.mrk.json" -o steps.tsv
    [ ! -e steps.tsv ]
}

@test "one row, equal times and long gaps are fine" {
    sphere --size 16
    hand '7 0'
    answers track sphere.nii.gz --poses hand.tsv --score time --format tsv
    [ "$(cell score 1)/$(cell selected 1)" = 0/1 ]
    hand '7 0' '7 0' '7 80' '7 0'
    answers track sphere.nii.gz --poses hand.tsv --score stability --format tsv
    [ "${#lines[@]}" -eq 9 ]
    hand '0 0' '1 0' '3.5 0'
    answers track sphere.nii.gz --poses hand.tsv --score time --format tsv
    [ "$(cell score 3)/$(cell score 5)" = 0.5/0 ]
    answers track sphere.nii.gz --poses hand.tsv --score time --window 5 --format tsv
    [ "$(cell score 5)" = 0.7 ]
}

@test "a file with its sidecar, which names the formula and the constants" {
    sphere --size 16
    hand '0 0' '0.1 0'
    answers track sphere.nii.gz --poses hand.tsv --score '0.5*time + 0.5*centre' --decay 3 -o steps.tsv
    [ -z "$output" ]
    [ "$(wc -l <steps.tsv)" -eq 5 ]
    grep -q '"score": "0.5\*time + 0.5\*centre"' steps.json
    grep -q '"decay_per_s": 3.0' steps.json
    grep -q '"confirmed": {' steps.json
    answers track sphere.nii.gz --poses hand.tsv -o steps.ndjson
    [ "$(wc -l <steps.ndjson)" -eq 4 ]
    answers track sphere.nii.gz --poses hand.tsv --format json
    [ "$(grep -c '"time_s": ' <<<"$output")" -eq 4 ]
}

@test "nothing is overwritten, and nothing left half written" {
    sphere --size 16
    hand '0 0'
    fails 2 '--output hand.tsv would overwrite the input hand.tsv' track sphere.nii.gz --poses hand.tsv -o hand.tsv
    cp hand.tsv steps.json
    fails 2 'the .json beside --output steps.json would overwrite the input steps.json' \
        track sphere.nii.gz --poses steps.json -o steps.tsv
    rm steps.json
    printf 'time_s\tx\n0\t0\n' >bad.tsv
    fails 3 'bad.tsv: header' track sphere.nii.gz --poses bad.tsv -o steps.tsv
    fails 3 'absent.tsv' track sphere.nii.gz --poses absent.tsv
    nothing_left sphere.nii.gz sphere.tsv sphere.json hand.tsv bad.tsv
}

@test "scores that need a history or all layers say so" {
    fails 2 '--score: intenselect needs a history, which single poses do not have; conus track has one' \
        query a.nii --origin 0,0,90 --toward 0,0,0 --score intenselect
    fails 2 '--score: time needs a history' batch a.nii --poses h.tsv -o b.tsv --score time
    fails 2 '--score: time needs a history' sweep a.nii --origin 0,0,90 --toward 0,0,0 --score time
    fails 2 '--score: 2*time needs a history' render a.nii -o a.png --origin 0,0,90 --toward 0,0,0 --score '2*time'
    fails 2 '--score: unoccluded needs --layers all' track a.nii --poses hand.tsv --score unoccluded
    fails 2 '--score: "intensect" is unknown; did you mean intenselect?' track a.nii --poses h.tsv --score intensect
    fails 2 '--score: column 7: the formula ends, expected is a number, a name or' track a.nii --poses h.tsv --score share+
    fails 2 '--score: division by 0' query a.nii --origin 0,0,90 --toward 0,0,0 --score share/0
}

@test "the constants have ranges" {
    fails 2 'no poses: --poses FILE, or a tracker by --listen or --connect' track a.nii
    fails 2 '--delay: -1 is out of range, allowed is 0 to 10' track a.nii --poses h.tsv --delay -1
    fails 2 '--window: 0 is out of range' track a.nii --poses h.tsv --window 0
    fails 2 '--stickiness: 1 is out of range, allowed is more than 0 and less than 1' track a.nii --poses h.tsv --stickiness 1
    fails 2 '--exponent: 2 is out of range, allowed is 0.01 to 1' track a.nii --poses h.tsv --exponent 2
    sphere --size 16
    hand '0 0'
    fails 2 'delay: 1 s, allowed is at most the window, 0.5 s' track sphere.nii.gz --poses hand.tsv --delay 1 --window 0.5
}
