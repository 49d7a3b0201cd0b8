#!/usr/bin/env bats
# Probes that ProbeInterface describes, as --probe takes them; positions and tables are those of oracle.compare_probe.
load helpers

# probe: np.json, a shank with 20 contacts 1 mm apart and 2 mm above the tip, wired from the last to the first, one not.
# It points along +y: contact i is at y = 12.6 - i, so that 1 to 6 and 19 are in slabs, from 6 to 12 and -12 to -6 mm.
probe() {
    conus phantom slabs -o .
    awk 'BEGIN {
        printf "{\"specification\":\"probeinterface\",\"version\":\"0.2.26\",\"probes\":[{\"ndim\":2,\"si_units\":\"mm\",\"contact_positions\":["
        for (i = 0; i < 20; i++) printf "%s[0,%d]", i ? "," : "", i + 7
        printf "],\"contact_ids\":["
        for (i = 0; i < 20; i++) printf "%s\"e%d\"", i ? "," : "", i
        printf "],\"device_channel_indices\":["
        for (i = 0; i < 20; i++) printf "%s%d", i ? "," : "", i == 8 ? -1 : 19 - i
        print "],\"probe_planar_contour\":[[-1,30],[-1,6],[0,5],[1,6],[1,30]]}]}"
    }' >np.json
}

AIM=(--origin 0,14.6,0 --direction 0,1,0)

@test "contacts in the order of the file, with shank and channel; points alone are answered alike" {
    probe
    printf 'x\ty\tz\tdx\tdy\tdz\n0\t14.6\t0\t0\t1\t0\n' >pose.tsv
    run -0 --separate-stderr conus query slabs.nii.gz --probe np.json --pose pose.tsv --format tsv
    check_message 'np.json: probe1: the tip is at x 0, y 5000 um'
    check_message 'its x axis points along 1,0,0'
    printf '%s\n' "$output" | awk -F'\t' '!($1 in seen) { seen[$1]; print $4 }' >of_probe
    awk 'BEGIN { for (i = 0; i < 20; i++) print 0, 14.6 - 2 - i, 0 }' >points.txt
    conus query slabs.nii.gz --pose points.txt --radius 0.000001 --format tsv -q | awk -F'\t' '!($1 in seen) { seen[$1]; print $4 }' >alone
    sed 1d of_probe | diff <(sed 1d alone) -
    [ "$(cell query 1)/$(cell probe 1)/$(cell shank_id 1)/$(cell channel 1)" = e0/probe1/n/a/19 ]
    conus query slabs.nii.gz --probe np.json "${AIM[@]}" --format tsv -q | diff <(printf '%s\n' "$output") -
    # Depths from the entry, 30 mm before the tip.
    conus query slabs.nii.gz --probe np.json --origin 0,-15.4,0 --direction 0,1,0 --range 0,30 --format tsv -q | diff <(printf '%s\n' "$output") -
    printf 'x\ty\tz\tdx\tdy\tdz\tnear\tfar\n0\t-15.4\t0\t0\t1\t0\t0\t30\n' >entry.tsv
    conus query slabs.nii.gz --probe np.json --pose entry.tsv --range 0,7 --format tsv -q | diff <(printf '%s\n' "$output") -
}

@test "points in a file of many poses for a probe are not asked as points" {
    probe
    printf 'x\ty\tz\n0\t14.6\t0\n' >points.tsv
    run --separate-stderr conus batch slabs.nii.gz --probe np.json --poses points.tsv
    [[ "$stderr" != *'asked as points'* ]]
}

@test "contacts that lie outside of the atlas are told, by the name of their file" {
    probe
    run -0 --separate-stderr conus query slabs.nii.gz --probe np.json --origin 0,300,500 --direction 0,0,-1 --format tsv
    [[ "$stderr" == *"warning: np.json: 20 of 20 points lie farther from the atlas than a quarter of its length, the first in line "* ]]
}

@test "channels decide the string of Open Ephys, heights above the tip that of SpikeGLX" {
    probe
    answers query slabs.nii.gz --probe np.json "${AIM[@]}" --format open-ephys -q
    [[ "$output" =~ ^0-0,SlP,[0-9A-F]{6}\;13-18,SlA,[0-9A-F]{6}$ ]]
    answers query slabs.nii.gz --probe np.json "${AIM[@]}" --format spikeglx -q
    [[ "$output" =~ ^\[0,0\]\(2500,8500,[0-9]+,[0-9]+,[0-9]+,SlA\)\(20500,21000,[0-9]+,[0-9]+,[0-9]+,SlP\)$ ]]
}

@test "BEP032: electrodes, probes and a sidecar that calls it a draft; the result is verified" {
    probe
    run -0 --separate-stderr conus query slabs.nii.gz --probe np.json "${AIM[@]}" --format bep032 -q --probes sub-1_probes.tsv \
        -o sub-1_electrodes.tsv
    [ "$(head -1 sub-1_probes.tsv)" = $'probe_name\ttype\themisphere\tanatomical_location\tanatomical_location_id' ]
    [ "$(wc -l <sub-1_electrodes.tsv)" -eq 21 ]
    grep -q '"BIDSExtension": "draft BEP032' sub-1_electrodes.json
    answers verify sub-1_electrodes.tsv
    has 'identical'
    [[ "$output" != *note:* ]]
    answers verify sub-1_probes.tsv --sidecar sub-1_electrodes.json
    has 'sub-1_probes.tsv: identical'
    sed -i 2s/probe/prod/ sub-1_probes.tsv
    answers verify sub-1_electrodes.tsv
    has 'note: sub-1_probes.tsv, which the same command wrote, was changed; with --sidecar sub-1_electrodes.json it is'
    run -1 conus verify sub-1_probes.tsv --sidecar sub-1_electrodes.json
    rm sub-1_probes.tsv
    answers verify sub-1_electrodes.tsv
    has 'note: sub-1_probes.tsv, which the same command wrote, was not compared: it is missing'
    sed -i '5s/Slab/Slob/' sub-1_electrodes.tsv
    run -1 conus verify sub-1_electrodes.tsv
}

# Six slabs of 10 mm from left to right; the three on the left are named right, or, with the names of the table, left.
@test "BEP032: no hemisphere where left and right are exchanged" {
    probe
    PYTHONPATH="$BATS_TEST_DIRNAME" python3 -B -c 'import nifti; nifti.write("six.nii", (6, 6, 6), "B",
        lambda i, j, k: i + 1, edge=10)'
    printf '%s\n' 'index	name' '1	A_R' '2	B_R' '3	C_R' '4	A_L' '5	B_L' '6	C_L' >wrong.tsv
    tr LR RL <wrong.tsv >right.tsv
    side() {
        conus query six.nii --labels "$1.tsv" --probe np.json --origin=-15,14.6,0 --direction 0,1,0 --format bep032 -q |
            sed -n 10p | cut -f 6,8
    }
    [ "$(side right)" = $'L\tB_L' ]
    [ "$(side wrong)" = $'n/a\tB_R' ]
}

@test "BEP032: positions in a space, with the file that describes it" {
    probe
    conus query slabs.nii.gz --probe np.json --origin 0,-14.6,0 --direction 0,-1,0 --space lps --format bep032 -q \
        -o sub-1_space-scan_electrodes.tsv --coordsystem sub-1_space-scan_coordsystem.json
    [ "$(sed -n 4p sub-1_space-scan_electrodes.tsv | cut -f 1-5)" = $'e2\tprobe1\t0\t-10.6\t0' ]
    python3 -m json.tool sub-1_space-scan_coordsystem.json >parsed.json
    grep -q '"MicroephysCoordinateUnits": "mm"' parsed.json
    answers verify sub-1_space-scan_electrodes.tsv
    has 'identical'
    fails 2 '--coordsystem is written beside --format bep032' query slabs.nii.gz --probe np.json "${AIM[@]}" -o out.tsv \
        --coordsystem sub-1_coordsystem.json
    fails 3 'not known to be the Allen CCF' query slabs.nii.gz --probe np.json "${AIM[@]}" --format bep032 --space ccf -o out.tsv \
        --coordsystem sub-1_coordsystem.json
    [ ! -e out.tsv ] && [ ! -e sub-1_coordsystem.json ]
}

@test "without a radius contacts are points, in the table and in what is cited" {
    probe
    conus query slabs.nii.gz "${AIM[@]}" --probe np.json -q >table.txt
    conus query slabs.nii.gz "${AIM[@]}" --probe np.json -q -o points.tsv
    # A line for contacts side by side at which is the same: how many, the first and the last, and what.
    conus query slabs.nii.gz "${AIM[@]}" --probe np.json -q --format json |
        jq -r '(.Rows | map(select(.kind == "area") | {(.query): .name}) | add) as $at
            | .Queries[] | [.query, .shank_id // "", $at[.query] // "no area, pathway or bundle"] | @tsv' |
        awk -F '\t' '$2 "/" $3 != key { if (n) print n, from (n > 1 ? ", " to : "") "  " what; n = 0; from = $1 }
            { key = $2 "/" $3; what = $3; to = $1; n++ } END { print n, from (n > 1 ? ", " to : "") "  " what }' >wanted.txt
    sed -n '/^ *[0-9]/p' table.txt | sed -E 's/^ *([0-9]+)  (.*[^ ]) +[-0-9.]+ +[-0-9.]+ +[-0-9.]+  /\1 \2  /' | diff - wanted.txt
    conus cite points.tsv | tr '\n' ' ' >cited.txt
    grep -q 'The areas at each of [0-9]* points were determined with' cited.txt
    ! grep -q 'ball' cited.txt || false
    conus query slabs.nii.gz "${AIM[@]}" --probe np.json --radius 1 -q -o balls.tsv
    conus cite balls.tsv | tr '\n' ' ' | grep -q 'a ball with a radius of 1 mm'
}

@test "options that exclude each other are refused, and no file is left" {
    probe
    local q=(query slabs.nii.gz "${AIM[@]}")
    sed 's/"probe_planar_contour".*\]\]/"annotations":{}/' np.json >blunt.json
    sed 's/"e1"/"e0"/' np.json >twice.json
    head -c 200 np.json >cut.json
    printf 'x\ty\tz\tdx\tdy\tdz\n0\t0\t0\t0\t1\t0\n0\t0\t0\t0\t1\t0\n' >two.tsv
    printf '0 0 0\n' >point.txt
    fails 3 'probes[0]: probe_planar_contour: there is none' "${q[@]}" --probe blunt.json -o out.tsv
    fails 3 'two contacts are called "e0"' "${q[@]}" --probe twice.json -o out.tsv
    fails 3 'cut.json: line 1' "${q[@]}" --probe cut.json -o out.tsv
    fails 3 'none.json: cannot open' "${q[@]}" --probe none.json -o out.tsv
    sed 's/"probes":\[\(.*\)\]}$/"probes":[\1,\1]}/' np.json >pair.json
    fails 3 'found 1 poses, wanted are 2' "${q[@]}" --probe pair.json -o out.tsv
    fails 3 'has 2 probes, wanted is one' batch slabs.nii.gz --probe pair.json --poses two.tsv -q
    fails 3 'without the direction that a probe needs' query slabs.nii.gz --probe np.json --pose point.txt -o out.tsv
    fails 2 'bep032 lists the contacts of probes' "${q[@]}" --format bep032
    fails 2 'beside --format bep032' "${q[@]}" --probe np.json --probes probes.tsv
    fails 2 'bids adds to a table' "${q[@]}" --probe np.json --format bids
    fails 2 'exclude each other' "${q[@]}" --probe np.json --angle 5
    fails 2 'has no effect without --probe' "${q[@]}" --probe-tip 1
    fails 2 'out of range' "${q[@]}" --probe np.json --probe-tip 0
    [ ! -e out.tsv ] && [ ! -e out.json ] && [ ! -e probes.tsv ]
    conus "${q[@]}" --probe blunt.json --probe-tip 2 --format tsv -q | diff - <(conus "${q[@]}" --probe np.json --format tsv -q)
}

@test "two insertions of one probe: by query, and by batch, shards and all" {
    probe
    printf 'name\tx\ty\tz\tdx\tdy\tdz\tfar\nleft\t-3\t-15.4\t0\t0\t1\t0\t30\nright\t3\t12\t0\t0\t1\t0\tn/a\n' >two.tsv
    local one
    for one in left right; do # each alone, with its name before those of the contacts
        grep -E "^(name|$one)" two.tsv >$one.tsv
        conus query slabs.nii.gz --probe np.json --pose $one.tsv --format tsv -q |
            awk -F'\t' -v OFS='\t' -v name=$one 'NR > 1 { $1 = name ":" $1; $(NF - 2) = name; print }'
    done >wanted
    run -0 --separate-stderr conus query slabs.nii.gz --probe np.json --pose two.tsv --format tsv -q
    sed 1d <<<"$output" | diff wanted -
    conus batch slabs.nii.gz --probe np.json --poses two.tsv -q --block 1 | diff - <(printf '%s\n' "$output")
    answers batch slabs.nii.gz --probe np.json --poses two.tsv -q -o rows.tsv
    conus batch slabs.nii.gz --probe np.json --poses two.tsv -q | cmp - rows.tsv
    for part in 1/2 all/2; do answers batch slabs.nii.gz --probe np.json --poses two.tsv -q --shard $part -o joined.tsv; done
    cmp joined.tsv rows.tsv
    answers verify rows.tsv
    has 'identical'
    [[ "$(conus cite joined.tsv | tr '\n' ' ')" == *'each of the 20 contacts of a probe at each of 2 poses of the device'* ]]
    sed -i 's/"e1"/"e99"/' np.json
    run -1 conus verify rows.tsv # the file of the probe is another
    sed -i 's/"e99"/"e1"/' np.json
    [ "$(conus query slabs.nii.gz --probe np.json --pose two.tsv --format open-ephys -q | wc -l)" -eq 2 ]
    conus query slabs.nii.gz --probe np.json --pose two.tsv --format spikeglx -q | cut -c 1-5 | diff - <(printf '[0,0]\n[1,0]\n')
    conus query slabs.nii.gz --probe np.json --pose two.tsv --format bep032 -q --probes sub-1_probes.tsv -o sub-1_electrodes.tsv
    [ "$(cut -f 1 sub-1_probes.tsv | paste -sd,)" = probe_name,left,right ]
    [ "$(cut -f 1 sub-1_electrodes.tsv | sort | uniq -d | wc -l)" -eq 0 ]
    fails 2 'of many probes tsv, csv and ndjson' batch slabs.nii.gz --probe np.json --poses two.tsv --format spikeglx
    sed 's/right/left/' two.tsv >same.tsv
    fails 3 'poses 1 and 2 are both called "left"' query slabs.nii.gz --probe np.json --pose same.tsv -q
    [ "$(conus batch slabs.nii.gz --probe np.json --poses same.tsv -q | cut -f 1,2 | sed -n '2p;$p' | paste -sd' ')" = \
        $'left:e0\t1 left:e19\t2' ]
    printf 'bad\t0\t0\tz\t0\t1\t0\tn/a\n' >>two.tsv
    run -1 --separate-stderr conus batch slabs.nii.gz --probe np.json --poses two.tsv --summary
    [ "$(cell query 41)/$(cell kind 41)/$(cell error 41)/$(cell probe 41)" = \
        'bad/error/line 4: column z: "z" is not a finite number/n/a' ]
    [[ "$stderr" == *'two.tsv: the 20 contacts of np.json at each pose'*'no answer to 1 of 3 poses'* ]]
}

@test "JSON of points is verified, whatever their names hold; and not when a point was moved" {
    probe
    sed -i 's/"e0"/"e\\"0\\\\, {"/; s/"e1"/"\\u00e9 ],"/; s/"e2"/"\\"Queries\\": []"/' np.json
    conus query slabs.nii.gz --probe np.json "${AIM[@]}" --format json -q -o points.json
    grep -qF '"query": "e\"0\\, {"' points.json
    answers verify points.json
    sed -i '0,/12.6/s//12.7/' points.json
    run -1 conus verify points.json
}

# recording: run.ap.meta, four channels of a Neuropixels 1.0 in banks 0 to 2, of which the second was not saved; rows are
# 20 um, and the lowest one is 0.209 mm above the tip: contacts are at y = 14.391, 10.531 and 6.691.
recording() {
    conus phantom slabs -o .
    printf '%s\n' acqApLfSy=4,4,1 imDatPrb_pn=NP1000 snsApLfSy=3,0,1 snsSaveChanSubset=0,2:3,8 \
        '~imroTbl=(0,4)(0 0 0 500 250 1)(1 0 0 500 250 1)(2 1 0 500 250 1)(3 2 0 500 250 1)' >run.ap.meta
}

@test "the probe of a recording is placed by its part number, or by a stated tip" {
    recording
    printf '0 14.391 0\n0 10.531 0\n0 6.691 0\n' >points.txt
    conus query slabs.nii.gz --pose points.txt --radius 0.000001 --format tsv -q | awk -F'\t' '!($1 in seen) { seen[$1]; print $4 }' >alone
    answers query slabs.nii.gz --probe run.ap.meta "${AIM[@]}" --format tsv -q
    printf '%s\n' "$output" | awk -F'\t' '!($1 in seen) { seen[$1]; print $4 }' | diff alone -
    [ "$(printf '%s\n' "$output" | awk -F'\t' 'NR > 1 { print $1 }' | uniq | xargs)" = 'AP0 AP2 AP3' ]
    [ "$(cell channel 1)" = 0 ]
    run --separate-stderr conus query slabs.nii.gz --probe run.ap.meta "${AIM[@]}"
    [[ "$stderr" == *'run.ap.meta: probe1: the tip is at x 35, y -209 um'* ]]
    run --separate-stderr conus query slabs.nii.gz --probe run.ap.meta --probe-tip 0.25 "${AIM[@]}"
    [[ "$stderr" == *'run.ap.meta: probe1: the tip is at x 35, y -250 um'* ]]
    sed 's/NP1000/NP7777/' run.ap.meta >other.ap.meta
    fails 3 'other.ap.meta: a table of sites of a probe "NP7777": its positions are not known' \
        query slabs.nii.gz --probe other.ap.meta "${AIM[@]}"
    fails 3 'says where contacts are on the probe, and not where it lies: --probe takes it' \
        query slabs.nii.gz --pose run.ap.meta
}
