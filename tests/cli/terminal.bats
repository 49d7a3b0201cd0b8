#!/usr/bin/env bats
# Output on a terminal: tables that fit, bold headers, colours, progress. terminal.py plays the terminal.
load helpers

# on COLUMNS COMMAND...: runs it on a terminal of that width.
on() {
    /usr/bin/python3 "$BATS_TEST_DIRNAME/terminal.py" "$@"
}

setup_nested() {
    conus phantom nested -o . --size 32 --spacing 2,2,2
    ask=(query nested.nii.gz --origin 0,0,100 --toward 0,0,0 --angle 20 --layers all --quiet) # no note of a slow opening
    export TERM=xterm
    unset NO_COLOR COLUMNS
}

# plain: removes the sequences that make text bold or coloured.
plain() {
    sed 's/\x1b\[[0-9;]*m//g'
}

@test "on a terminal the columns that do not fit are left out from the last on, and a line says which" {
    setup_nested
    conus "${ask[@]}" >all
    [ "$(wc -L <all)" -gt 100 ]
    for width in 60 80 100; do
        on $width "$CONUS" "${ask[@]}" | plain >fitted
        [ "$(grep -E '^(rank| +of cone| +[0-9]+  )' fitted | wc -L)" -le $width ] # but not the lines between tables
        [ "$(grep -c ' left out: .*; -o FILE or --format tsv has all$' fitted)" -eq 1 ]
        # Each line is the beginning of the whole one, up to the end of a column of its header.
        paste -d '\n' all <(grep -v ' left out: ' fitted) | awk 'NR % 2 { whole = $0; next }
            substr(whole, 1, length($0)) != $0 { print "not its beginning: " $0; exit 1 }'
        header=$(grep '^rank' fitted)
        [[ "$(grep '^rank' all)" == "$header  "* ]]
        left=$(grep '^rank' all | cut -c "$((${#header} + 1))-" | sed 's/^  *//; s/   */, /g; s/  /, /g')
        count=$(grep '^rank' all | cut -c "$((${#header} + 1))-" | sed 's/^  *//; s/   */\n/g; s/  /\n/g' | wc -l)
        grep -qx "$count columns* left out: $left; -o FILE or --format tsv has all" fitted
    done
    on 200 "$CONUS" "${ask[@]}" | plain | cmp - all
    on 0 "$CONUS" "${ask[@]}" | plain | cmp - all
    COLUMNS=80 on 0 "$CONUS" "${ask[@]}" | plain | grep -q ' left out: '
    COLUMNS=200 on 80 "$CONUS" "${ask[@]}" | plain | grep -q ' left out: ' # the terminal's own width counts
}

@test "where answers and messages are on one screen a warning is there once" {
    setup_nested
    ask=(query nested.nii.gz --point 300,0,0)
    [ "$(on 200 "$CONUS" "${ask[@]}" | plain | grep -c 'warning: the point lies outside')" -eq 1 ]
    on 200 bash -c '"$@" 2>/dev/null' - "$CONUS" "${ask[@]}" | plain | grep -q '^warning: the point lies outside'
    on 200 bash -c '"$@" >file' - "$CONUS" "${ask[@]}" | plain | grep -q '^conus: warning: the point lies outside'
    grep -q '^warning: the point lies outside' file
}

@test "a file, a pipe and other formats have all columns, and no colour" {
    setup_nested
    conus "${ask[@]}" >all
    on 40 bash -c '"$@" | cat >piped' - "$CONUS" "${ask[@]}"
    cmp piped all
    on 40 "$CONUS" "${ask[@]}" -o file.txt
    cmp file.txt all
    for format in tsv csv ndjson; do
        conus "${ask[@]}" --format $format >wanted
        on 40 "$CONUS" "${ask[@]}" --format $format | cmp - wanted
    done
}

@test "the header is bold and the word note is coloured, unless NO_COLOR or TERM=dumb forbid it" {
    setup_nested
    ask=(query nested.nii.gz --origin 0,0,0 --toward 0,0,50)
    on 200 "$CONUS" "${ask[@]}" >shown
    grep -q $'^\x1b\\[1mrank  name' shown
    grep -q $'^conus: \x1b\\[33mnote:\x1b\\[0m the device lies inside' shown
    plain <shown | grep -q '^conus: note: the device lies inside'
    on 80 "$CONUS" query nested.nii.gz --nonsense >shown || [ $? -eq 2 ]
    grep -q $'^\x1b\\[1mconus:\x1b\\[0m unknown option --nonsense' shown
    for setting in NO_COLOR=1 TERM=dumb TERM=; do
        env "$setting" /usr/bin/python3 "$BATS_TEST_DIRNAME/terminal.py" 200 "$CONUS" "${ask[@]}" >shown
        not grep -q $'\x1b' shown
        grep -q '^conus: note: the device lies inside' shown
    done
    env NO_COLOR= /usr/bin/python3 "$BATS_TEST_DIRNAME/terminal.py" 200 "$CONUS" "${ask[@]}" | grep -q $'\x1b' # an empty one counts as none
    run -0 --separate-stderr conus "${ask[@]}"
    [[ $stderr != *$'\x1b'* ]]
}

@test "other tables fit, too" {
    setup_nested
    for command in "info nested.nii.gz" "sweep nested.nii.gz --origin 0,0,100 --toward 0,0,0 --angle 20" \
        "query nested.nii.gz --point 0,0,20" "query nested.nii.gz --origin 0,0,100 --toward 0,0,0 --segments -" \
        "query nested.nii.gz --origin 0,0,100 --toward 0,0,0 --clearance -"; do
        read -ra words <<<"$command"
        on 50 "$CONUS" "${words[@]}" | plain | grep -E '[^ ]   *[^ ]+   *[^ ]' >fitted || true
        [ -s fitted ] && [ "$(wc -L <fitted)" -le 50 ] || { echo "$command:"; cat fitted; return 1; }
    done
}

# On a terminal a line is rewritten in place: \r, then the sequence that clears the line. It is gone at the end.
@test "long work shows how far it is, with the time left, and leaves no trace of it" {
    setup_nested
    conus phantom sphere -o . --size 64
    grow() { # grow COMMAND: runs it with 4096, 8192, ... poses or samples, until it succeeds: progress is shown after 100 ms
        local n
        for ((n = 4096; n <= 1048576; n *= 2)); do
            rm -f chances.* rows.* query.*
            awk -v n=$n 'BEGIN { print "x\ty\tz\ttx\tty\ttz"; for (i = 0; i < n; i++) print i % 50 "\t0\t100\t0\t0\t0" }' >poses.tsv
            ! "$1" $n || return 0
        done
        echo "$1: no progress of $n"
        return 1
    }
    shows() { # shows TEXT COMMAND...: asserts that it shows a progress with TEXT, and that nothing of it is left
        local text=$1
        shift
        on 100 "$@" >shown
        tr '\r' '\n' <shown | grep -qE $'^\x1b\\[K'"[0-9]+ of $text, [0-9.]+/s, [0-9]+ %, [0-9.]+ (s|min|h) left" ||
            { echo "$*:"; head -c 2000 shown | cat -v; return 1; }
    }
    sweep() {
        shows '[0-9]+ samples' "$CONUS" sweep sphere.nii.gz --origin 0,0,100 --toward 0,0,0 --jitter 2,2 --samples "$1" -o chances.tsv
    }
    batch() {
        shows "$1 poses" "$CONUS" batch sphere.nii.gz --poses poses.tsv -o rows.tsv --block 16 --threads 1
    }
    query() {
        shows "$1 poses" "$CONUS" query sphere.nii.gz --pose poses.tsv -o query.tsv
    }
    grow sweep
    grow batch
    grow query
    [[ "$(tail -c 5 shown)" == *$'\r\x1b[K' ]]
    on 100 "$CONUS" query sphere.nii.gz --pose poses.tsv -o quiet.tsv --quiet >shown
    [ ! -s shown ]
    conus query sphere.nii.gz --pose poses.tsv -o plain.tsv 2>said
    [ ! -s said ]
    cmp plain.tsv query.tsv
}

# Five needles that hardly find room: a bound that never rises, and a best one that never falls.
@test "a search for several needles shows the best so far and what none exceeds, and its tables fit" {
    setup_nested
    conus phantom u-shape -o .
    for name in A B C D E; do
        awk -v name=$name 'BEGIN { srand(index("ABCDE", name)); print "query_id\tx\ty\tz\tdx\tdy\tdz\tfar"
            for (i = 0; i < 300; i++) print name i "\t40\t" 8 * rand() - 4 "\t" 2 + 6 * rand() "\t-1\t0\t0\t26" }' >$name.tsv
    done
    { echo needle,poses && printf '%s\n' A,A.tsv B,B.tsv C,C.tsv D,D.tsv E,E.tsv; } >needles.csv
    on 80 "$CONUS" plan u-shape.nii.gz --needles needles.csv --reach U,length=2 --avoid Ball,margin=1 --between 2.6 \
        --effort 2 --threads 1 >shown
    tr '\r' '\n' <shown | sed -nE 's/.*\/s; combination 1: leeway ([0-9.]+) mm, at most ([0-9.]+)$/\1 \2/p' >steps
    awk '$1 < best || $1 > $2 || (bound && $2 > bound) { print "line " NR; exit 1 } { best = $1; bound = $2 }
        END { exit !NR }' steps || { cat steps; return 1; }
    plain <shown | grep -A 3 '^combination 1: ' | grep -qE '^needle +x +y +z +tip x +tip y +tip z$'
    not grep -q ' left out: ' shown
}

@test "where opening files took more than a second a note names conus pack; a pack has none" {
    [ -n "${CONUS_HOLD_OPEN-}" ] || skip "hold_open is built with the window"
    setup_nested
    conus pack nested.nii.gz -o nested.conus
    export HOLD_FOLDER=$PWD
    is_old() { [ -n "$(find begun -not -newermt '1.2 seconds ago')" ]; }
    for atlas in nested.nii.gz nested.conus; do
        rm -f begun released
        background on 200 env HOLD_NAME=$atlas LD_PRELOAD="$CONUS_HOLD_OPEN" ASAN_OPTIONS=verify_asan_link_order=0 \
            "$CONUS" query $atlas --origin 0,0,100 --toward 0,0,0 >$atlas.said
        wait_until "$child" test -e begun
        wait_until "$child" is_old
        touch released
        wait "$child"
    done
    plain <nested.nii.gz.said |
        grep -qE '^conus: note: opening took [0-9.]+ s; conus pack nested.nii.gz ... -o NAME.conus makes a file that opens at once$'
    not grep -q 'opening took' nested.conus.said
}
