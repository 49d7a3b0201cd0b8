#!/usr/bin/env bats
# Answers as other programs read them: BIDS, AFNI, SpikeGLX, Open Ephys (docs/formats.md).
load helpers

# A probe along +y through both slabs, whose faces lie between its contacts: 30 of them, 1 mm apart, on shanks A and B.
probe() {
    conus phantom slabs -o .
    printf 'name\tx\ty\tz\tsize\n' >probe.tsv
    for shank in A:0 B:-5; do
        for i in {0..29}; do
            awk -v s="${shank%:*}" -v x="${shank#*:}" -v i="$i" 'BEGIN { printf "%s%d\t%g\t%g\t0.5\t1\n", s, i, x, i - 14.5 }'
        done
    done >>probe.tsv
}

@test "SpikeGLX: the faces of two slabs, in micrometres from the first contact, for each shank" {
    probe
    run -0 --separate-stderr conus query slabs.nii.gz --pose probe.tsv --radius 0.3 --format spikeglx --quiet
    local region='\(2500,8500,[0-9]+,[0-9]+,[0-9]+,SlP\)\(20500,26500,[0-9]+,[0-9]+,[0-9]+,SlA\)'
    [ "${#lines[@]}" -eq 2 ]
    [[ "${lines[0]}" =~ ^\[0,0\]$region$ ]]
    [[ "${lines[1]}" =~ ^\[0,1\]$region$ ]]
}

@test "Open Ephys: channels are counted from 0 through all shanks, those without an answer too" {
    probe
    sed -i 's/^A4\t[^\t]*/A4\tn\/a/' probe.tsv
    run -1 --separate-stderr conus query slabs.nii.gz --pose probe.tsv --radius 0.3 --format open-ephys --quiet
    check_message 'probe.tsv:6: column x: "n/a" is not a finite number'
    [[ "$output" =~ ^3-3,SlP,[0-9A-F]{6}\;5-8,SlP,[0-9A-F]{6}\;21-26,SlA,[0-9A-F]{6}\;33-38,SlP,[0-9A-F]{6}\;51-56,SlA,[0-9A-F]{6}$ ]]
}

@test "contacts without a position are passed over, but keep their channels and their lines" {
    probe
    sed -i 's/^A4\t[^\t]*\t[^\t]*\t[^\t]*/A4\tn\/a\tn\/a\tn\/a/' probe.tsv
    run -0 --separate-stderr conus query slabs.nii.gz,template=none --pose probe.tsv --radius 0.3 --format tsv
    has_no_row() { ! grep -q "^$1	" <<<"$output"; }
    has_no_row A4
    [[ "$stderr" == *'note: probe.tsv: 1 rows without coordinates (n/a) passed over, the first in line 6'* ]]
    run -1 --separate-stderr conus query slabs.nii.gz --pose probe.tsv --radius 0.3 --format open-ephys --quiet
    check_message 'probe.tsv:6: x: not known (n/a)'
    [[ "$output" == '3-3,SlP,'*';5-8,SlP,'* ]]
}

@test "BIDS: the table as it was, with columns added and described" {
    probe
    { head -1 probe.tsv; sed -n '4,5p;18p' probe.tsv; printf 'bad\tn/a\t0\t0\t1\nshort\t0\n'; } | sed 's/$/\r/' >in_electrodes.tsv
    run -1 --separate-stderr conus query slabs.nii.gz --pose in_electrodes.tsv --radius 0.4 --format bids -o out_electrodes.tsv --quiet
    output=$(<out_electrodes.tsv)
    diff <(tr -d '\r' <in_electrodes.tsv | head -5) <(cut -f 1-5 out_electrodes.tsv | head -5)
    [ "$(awk -F'\t' '{ print NF }' out_electrodes.tsv | sort -u)" -eq 12 ]
    [ "$(cell area 1)/$(cell area 2)/$(cell area 3)/$(cell area 4)" = "unassigned/Slab posterior/unassigned/n/a" ]
    [ "$(cell area_index 2)/$(cell area_share 2)/$(cell area_distance_mm 2)" = 300/n/a/0 ]
    [ "$(cell area_error 4)/$(cell area_error 1)" = 'line 5: column x: "n/a" is not a finite number/n/a' ]
    [ "$(cell x 5)/$(cell size 5)/$(cell area_error 5)" = '0/n/a/line 6: 2 fields, the header has 5' ]
    for column in $(head -1 out_electrodes.tsv | cut -f 6-); do
        grep -q "^ \"$column\": {" out_electrodes.json
    done
}

@test "AFNI: the focus point, and what is near, nearest first" {
    conus phantom slabs -o .
    printf '0 9 0\n0 1.5 0\n0 30 30\n' >points.txt
    answers query slabs.nii.gz --pose points.txt --radius 9 --format afni --quiet
    [ "$(grep -c '^+++++++ nearby Atlas structures +++++++$' <<<"$output")" -eq 3 ]
    [ "$(grep -c '^Focus point (LPI)  *	Coord.Space *$' <<<"$output")" -eq 3 ]
    has '   0 mm [R],   9 mm [A],   0 mm [S] 	{'
    grep -E '^slabs  ' <<<"$output" | tr -s ' ' | cut -f 2-3 | sed 's, *$,,' >near
    printf '0.0\tSlab anterior\n4.5\tSlab anterior\n7.5\tSlab posterior\n' | diff - near
    has '***** Not near any region stored in databases *****'
}

@test "formats of other programs say what they need" {
    probe
    fails 2 '--pose FILE names them' query slabs.nii.gz --point 0,0,0 --radius 1 --format spikeglx
    printf '0 0 0\n' >points.txt
    fails 3 'the columns name, x, y and z' query slabs.nii.gz --pose points.txt --radius 1 --format bids --quiet
    sed -i 's/size$/area/' probe.tsv
    fails 3 'a column area already' query slabs.nii.gz --pose probe.tsv --radius 1 --format bids --quiet
    fails 2 'none of its choices' track slabs.nii.gz --poses probe.tsv --format bids
}

# contacts N: probe.tsv of N contacts along +y through both slabs; some of them have no position.
contacts() {
    conus phantom slabs -o .
    awk -v n="$1" 'BEGIN {
        print "name\tx\ty\tz\tsize"
        for (i = 0; i < n; i++)
            printf "A%d\t%s\t%g\t%g\t%s\n", i, i % 7 == 3 ? "n/a" : i % 40 - 20, i % 29 - 14, i % 11 - 5, i % 5 ? 2 : "small"
    }' >probe.tsv
}

@test "conus batch writes them as conus query does, with any threads, blocks and shards, and after a break" {
    contacts 300
    for format in afni bids spikeglx open-ephys; do
        conus query slabs.nii.gz --pose probe.tsv --radius 4 --format $format --quiet -o "wanted.$format" 2>said || [ $? -eq 1 ]
        conus batch slabs.nii.gz --poses probe.tsv --radius 4 --format $format --quiet >rows 2>said && return 1 || [ $? -eq 1 ]
        cmp "wanted.$format" rows
        [[ "$(cat said)" == *'conus: probe.tsv: no answer to '*' of 300 poses, the first in line '* ]]
        conus batch slabs.nii.gz --poses - --radius 4 --format $format --quiet <probe.tsv | cmp - "wanted.$format"
        for settings in "1 1" "2 7" "3 1000"; do
            conus batch slabs.nii.gz --poses probe.tsv --radius 4 --format $format --quiet \
                --threads "${settings% *}" --block "${settings#* }" | cmp - "wanted.$format"
        done
        run -1 conus batch slabs.nii.gz --poses probe.tsv --radius 4 --format $format --quiet -o "rows.$format"
        cmp "wanted.$format" "rows.$format"
        run -1 conus batch slabs.nii.gz --poses probe.tsv --radius 4 --format $format --quiet -o "rows.$format"
        run -2 conus batch slabs.nii.gz --poses probe.tsv --radius 5 --format $format --quiet -o "rows.$format"
    done
    for format in afni bids; do
        for part in 1/3 2/3 all/3; do
            conus batch slabs.nii.gz --poses probe.tsv --radius 4 --format $format --quiet --shard $part -o "joined.$format" 2>said || [ $? -eq 1 ]
        done
        cmp "wanted.$format" "joined.$format"
        [ "$(jq -r .Batch.errors "joined.$format.json")" -eq 43 ]
    done
    fails 2 '--shard: a probe' batch slabs.nii.gz --poses probe.tsv --radius 4 --format spikeglx --shard 0/2
    fails 2 '--summary: formats of other programs' batch slabs.nii.gz --poses probe.tsv --radius 4 --format bids --summary
}

@test "a batch in another program's format is answered again after it was killed, and known as the same" {
    contacts 4000
    mv slabs.tsv labels.tsv
    mv probe.tsv in_electrodes.tsv # in the space of the atlas, so that no warning goes where progress does
    printf '{"iEEGCoordinateSystem": "ScanRAS", "iEEGCoordinateUnits": "mm"}\n' >in_coordsystem.json
    for format in afni bids; do
        conus batch slabs.nii.gz,template=none --poses in_electrodes.tsv --radius 4 --labels labels.tsv --format $format --quiet -o "whole.$format" || [ $? -eq 1 ]
        hold batch slabs.nii.gz,template=none --poses in_electrodes.tsv --radius 4 --labels labels.tsv --format $format -o "rows.$format"
        wait_for_block
        stop_held KILL 137
        [ ! -e "rows.$format" ]
        conus batch slabs.nii.gz,template=none --poses in_electrodes.tsv --radius 4 --labels labels.tsv --format $format --quiet -o "rows.$format" || [ $? -eq 1 ]
        cmp "whole.$format" "rows.$format"
    done
    mv slabs.nii.gz other.nii.gz
    for format in afni:2 bids:1; do # AFNI's rows have the file's name
        run -"${format#*:}" conus batch other.nii.gz,template=none --poses in_electrodes.tsv --radius 4 --labels labels.tsv --format "${format%:*}" --quiet \
            -o "rows.${format%:*}"
    done
}

@test "a probe of a batch is what fits into one block" {
    contacts 70000
    fails 2 'format: a probe is written as a whole, but these are contacts 1 to 65536, and there may be more' \
        batch slabs.nii.gz --poses probe.tsv --radius 1 --format open-ephys --quiet -o probe.txt
    [ ! -e probe.txt ]
    printf '0 9 0\n' >points.txt
    fails 3 'points.txt: --format bids adds to a table of electrodes' batch slabs.nii.gz --poses points.txt --radius 1 --format bids
    sed -i '1s/size$/area/' probe.tsv
    fails 3 'a column area already' batch slabs.nii.gz --poses probe.tsv --radius 1 --format bids --quiet
}

# oddly_named: names.tsv with names that need quotation marks in CSV.
oddly_named() {
    printf 'index\tname\n1\tfirst, "upper" part\n300\t=cmd|x!A0\n' >names.tsv
}

# same_cells A.csv B.tsv: Python's csv and pandas read the same cells from both; lines end as RFC 4180 requires.
same_cells() {
    /usr/bin/python3 - "$1" "$2" <<'PYTHON'
import csv, sys
import pandas
with open(sys.argv[1], newline="") as file:
    text = file.read()
rows = list(csv.reader(text.splitlines(keepends=True), strict=True))
wanted = [line.split("\t") for line in open(sys.argv[2]).read().splitlines()]
assert rows == wanted, (rows, wanted)
assert text.endswith("\r\n") and text.count("\n") == text.count("\r\n") == len(wanted)
pandas.testing.assert_frame_equal(pandas.read_csv(sys.argv[1]), pandas.read_csv(sys.argv[2], sep="\t", quoting=3))
PYTHON
}

@test "CSV has the cells of TSV, in every command that writes rows" {
    conus phantom slabs -o .
    oddly_named
    printf 'query_id,x,y,z,tx,ty,tz,time_s\n"one, two",0,-50,0,0,0,0,0\nlost,0,0,0,0,0,0,1\n3,5,-50,3,0,0,0,2\n' >poses.csv
    local of=(slabs.nii.gz --labels names.tsv --quiet)
    for format in csv tsv; do
        run -1 conus query "${of[@]}" --force --pose poses.csv -o "query.$format"
        run -1 conus query "${of[@]}" --pose poses.csv --layers all --format $format
        printf '%s\n' "$output" | grep -v '^conus: ' >"layers.$format"
        run -1 conus batch "${of[@]}" --poses poses.csv --force -o "batch.$format"
        run -1 conus batch "${of[@]}" --poses poses.csv --force --summary --format $format -o "summary.$format"
        run -1 conus track "${of[@]}" --force --poses poses.csv --score intenselect -o "track.$format"
        run -1 conus sweep "${of[@]}" --force --pose poses.csv -o "admissions.$format"
        run -1 conus sweep "${of[@]}" --force --pose poses.csv --angles 5,10 -o "shares.$format"
        run -1 conus sweep "${of[@]}" --force --pose poses.csv --jitter 2,1 --samples 16 -o "chances.$format"
    done
    for name in query layers batch summary track admissions shares chances; do
        same_cells $name.csv $name.tsv
    done
    grep -q ',"first, ""upper"" part",' layers.csv
    grep -q ',=cmd|x!A0,' layers.csv
    cmp query.csv batch.csv
    cmp query.csv <(conus batch "${of[@]}" --poses poses.csv --format csv)
    grep -q '"Units": "mm"' query.json
    answers diff query.csv query.tsv
    has ', 0 changed, 0 removed, 0 added'
    sed 's/upper/lower/' layers.csv >other.csv
    run -1 conus diff layers.csv other.csv
    has 'name first, "upper" part -> first, "lower" part'
}

@test "parts of CSV are joined as CSV" {
    conus phantom slabs -o .
    oddly_named
    printf 'x y z tx ty tz\n' | tr ' ' , >poses.csv
    for i in {1..20}; do echo "$i,-50,0,0,0,0"; done >>poses.csv
    local of=(slabs.nii.gz --labels names.tsv --poses poses.csv)
    answers batch "${of[@]}" -o whole.csv
    conus batch "${of[@]}" --shard 1/3 -o joined.csv
    conus batch "${of[@]}" --shard all/3 -o joined.csv
    cmp whole.csv joined.csv
    [ -e joined.json ]
}

@test "an ending that says no format is an error that lists those that do" {
    conus phantom slabs -o .
    local aim='slabs.nii.gz --origin 0,-50,0 --toward 0,0,0'
    printf 'x,y,z,tx,ty,tz,time_s\n0,-50,0,0,0,0,0\n' >poses.csv
    local most='ends in none of .tsv, .csv, .json, .ndjson, .jsonl and, for a table for people, .txt; --format says what else'
    for name in answer.xlsx answer answer.CSV.gz .tsv; do
        # shellcheck disable=SC2086 # words
        fails 2 "$name: --output $most" query $aim -o $name
        # shellcheck disable=SC2086
        fails 2 "$name: --output $most" sweep $aim -o $name
        fails 2 "$name: --output $most" track slabs.nii.gz --poses poses.csv -o $name
        fails 2 "$name: --output ends in none of .tsv, .csv, .ndjson and .jsonl; --format says what else" \
            batch slabs.nii.gz --poses poses.csv -o $name
    done
    fails 2 'rows.json: --output ends in none of' batch slabs.nii.gz --poses poses.csv -o rows.json
    fails 2 'rows.txt: --output ends in none of' batch slabs.nii.gz --poses poses.csv -o rows.txt
    # shellcheck disable=SC2086
    fails 2 'voxels.csv: --voxels writes TSV; end the name in .tsv' query $aim --voxels voxels.csv --voxels-of all
    nothing_left slabs.nii.gz slabs.tsv slabs.json poses.csv
    # shellcheck disable=SC2086
    answers query $aim --format csv -o answer.xlsx
    grep -q '^query,kind,' answer.xlsx
    # shellcheck disable=SC2086
    answers query $aim -o answer.CSV
    cmp answer.xlsx answer.CSV
    # shellcheck disable=SC2086
    answers query $aim -o answer.txt
    grep -q '^rank ' answer.txt
    # shellcheck disable=SC2086
    answers query $aim -o /dev/stdout
    has 'rank  name'
}
