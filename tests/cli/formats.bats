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
    check_message 'probe.tsv:6: x: not known'
    [[ "$output" =~ ^3-3,SlP,[0-9A-F]{6}\;5-8,SlP,[0-9A-F]{6}\;21-26,SlA,[0-9A-F]{6}\;33-38,SlP,[0-9A-F]{6}\;51-56,SlA,[0-9A-F]{6}$ ]]
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
    [ "$(cell area_error 4)/$(cell area_error 1)" = 'line 5: x: not known (n/a)/n/a' ]
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
    fails 2 'not standard input' query slabs.nii.gz --pose - --radius 1 --format bids
    printf '0 0 0\n' >points.txt
    fails 3 'the columns name, x, y and z' query slabs.nii.gz --pose points.txt --radius 1 --format bids --quiet
    sed -i 's/size$/area/' probe.tsv
    fails 3 'a column area already' query slabs.nii.gz --pose probe.tsv --radius 1 --format bids --quiet
    fails 2 'none of its choices' track slabs.nii.gz --poses probe.tsv --format bids
}
