#!/usr/bin/env bats
# conus verify: results of every kind are answered again from their sidecars, and every change is named.
load helpers

# make NAME COMMAND ARGUMENT...: makes a result out/NAME; rows without an answer are allowed.
make() {
    local name=$1
    shift
    conus "$@" -q -o "out/$name" || [ $? -eq 1 ]
    results+=("out/$name")
}

inputs() {
    conus phantom sphere -o atlas --size 24 --spacing 3,3,3
    conus phantom slabs -o atlas --size 16 --spacing 4,4,4
    conus phantom nested -o atlas --size 24 --spacing 3,3,3
    conus phantom brain -o brain
    printf 'index\tname\tparent_id\n1\tOuter\t20\n300\tInner\t20\n20\tShell\tn/a\n4000000001\tCore\tn/a\n' >tree.tsv
    printf 'Shell\nCore\n' >list.txt
    printf '1 0 0 7\n0 1 0 0\n0 0 1 0\n0 0 0 1\n' >right.txt
    cp right.txt right.mat # a matrix of FSL
    printf '{"conus_atlas": 1, "parcellation": "atlas/nested.nii.gz",
        "transform": {"file": "right.mat", "from": "atlas/sphere.nii.gz", "to": "atlas/nested.nii.gz"}}' >right.atlas.json
    python3 "$BATS_TEST_DIRNAME/fields.py" rel atlas/slabs.nii.gz field.nii.gz 8
    printf 'query_id\tx\ty\tz\ttx\tty\ttz\tangle\terror_deg\n' >poses.tsv
    printf 'front\t0\t100\t0\t0\t0\t0\t5\t1\nlost\t0\t0\t0\t0\t0\t0\t5\t1\nleft\t-90\t9\t9\t0\t0\t0\tn/a\t2\n' >>poses.tsv
    printf 'time_s\tx\ty\tz\ttx\tty\ttz\ttrigger\n0\t0\t0\t90\t0\t0\t0\t0\n0.1\t0\t0\t90\t0\t9\t0\t0\n0.3\t0\t0\t90\t3\t0\t0\t1\n' >hand.tsv
    printf 'query_id\tx\ty\tz\ttx\tty\ttz\tfar\nfront\t0\t100\t0\t0\t0\t0\t99\nside\t0\t0\t90\t0\t9\t0\t80\n' >needles.tsv
    printf 'name\tx\ty\tz\tsize\nR1\t80\t0\t0\t1\nR2\t70\t0\t0\t1\n' >in_electrodes.tsv
    printf '{"iEEGCoordinateSystem": "Other", "iEEGCoordinateUnits": "mm"}\n' >in_coordsystem.json
    printf 'name\tx\ty\tz\tsize\nA0\t0\t-12\t0.5\t1\nA1\t0\t-11\t0.5\t1\nA2\t0\t-10\t0.5\t1\n' >probe.tsv
    python3 "$BATS_TEST_DIRNAME/tck.py" lines.tck -30,0,0 30,0,0 -- 0,-20,0 0,0,9 -- 0,0,0 0,4,4
    mkdir -p out own
    cp atlas/sphere.nii.gz own/ball_atlas.nii.gz
    cp atlas/sphere.tsv own/ball_atlas.tsv
}

# Makes every kind of result, of every command that writes one, in the folder study. study/results lists them.
setup_file() {
    local aim='--origin 0,-100,0 --toward 0,0,0 --angle 30' results=()
    local S=atlas/sphere.nii.gz L=atlas/slabs.nii.gz N=atlas/nested.nii.gz
    mkdir "$BATS_FILE_TMPDIR/study"
    cd "$BATS_FILE_TMPDIR/study"
    inputs
    make q.tsv query $S $aim
    make qc.csv query $S $aim
    make qj.json query $S $aim
    make q.ndjson query $S $aim
    make q.txt query $S $aim
    make q-format query $S $aim --format tsv
    make layers.tsv query $N $aim --layers all --voxels out/voxels.tsv --voxels-of all --image out/seen.exr \
        --mask out/in_dseg.nii.gz
    make mask.tsv query $N $aim --mask out/in_mask.nii.gz --mask-object Core --image out/seen.png
    make plan.tsv plan $S --poses needles.tsv --reach Sphere,length=5
    make range.tsv query $S $aim --range 70,95 --aperture square --resolution 40
    make tube.tsv query $S --origin=-90,1,2 --direction=1,0.1,0 --up 0,1,1 --radius 4
    make slices.tsv query $S $aim --sampling slices --slices 90 --slice-fraction 0.5
    make score.tsv query $N $aim --score '0.5*share+0.5*centre'
    make lps.tsv query $L $aim --space lps --hemispheres split
    make level.tsv query $N --labels tree.tsv $aim --level 1 --layers all
    make list.tsv query $N --labels tree.tsv $aim --level @list.txt
    make only.tsv query $N --labels tree.tsv $aim --only @list.txt --hide Inner
    make context.tsv query $S $aim --context $N --context-blocks 1
    make pathway.tsv query $S $aim --pathway "$N,threshold=1,name=a path" --pathway "$L,band=1:9:low" --layers all
    make moved.tsv query $S $aim --atlas-transform right.txt --atlas-transform right.txt,inverse
    make images.tsv query $N $aim --atlas-transform right.mat,from=$S,to=$N --segments out/images-rows.tsv
    make field.tsv query $N $aim --atlas-transform field.nii.gz,from=$L,to=$N,grid=$S
    make manifest.tsv query right.atlas.json $aim
    make several.tsv query $S --atlas $L --atlas $N $aim
    make all.json query $S --atlas $L $aim
    make point.tsv query $S --point 0,-23,0 --radius 5
    make scene.tsv query brain/brain.atlas.json --origin=-200,3,4 --toward 0,0,0 --layers all
    make folder.tsv query brain --origin=-200,3,4 --toward 0,0,0
    make surface.tsv query brain/brain-11-Cor.surf.gii --origin=-200,3,4 --toward 0,0,0
    make poses.tsv query $S --pose poses.tsv --angle 7
    make afni query $S --pose poses.tsv --format afni
    make out_electrodes.tsv query $S --pose in_electrodes.tsv --radius 2 --format bids --any-space
    make shafts.tsv query $S --pose in_electrodes.tsv --radius 2 --along-shafts --any-space
    make glx query $S --pose probe.tsv --radius 2 --format spikeglx
    make ephys query $S --pose probe.tsv --radius 2 --format open-ephys
    CONUS_ATLAS_PATH=own make name.tsv query ball-atlas $aim
    make depth.tsv query $N $aim --layers all --order depth --segments out/passed.tsv
    make shown.tsv query $N $aim --segments - --clearance out/shown-near.csv >shown.txt
    make beside.tsv query $N $aim --layers all --segments out/beside-rows.json
    make pairs.tsv connect $N --streamlines lines.tck --connectivity out/matrix.json
    make shank query $N --origin=-100,0,0 --direction=1,0,0 --range 0,110 --format open-ephys --contacts 16,2,1,1
    make quotes.tsv query "atlas/../atlas/./sphere.nii.gz" $aim --score "share + centre"
    make batch.tsv batch $S --poses poses.tsv
    make threads.csv batch $S --atlas $L --poses poses.tsv --threads 3 --block 1 --force
    make batch.ndjson batch $S --poses poses.tsv --summary
    make batch-list.tsv batch $N --labels tree.tsv --poses poses.tsv --level @list.txt
    make batch-rows.tsv batch $S --poses poses.tsv --segments out/batch-passed.tsv
    conus batch $S --poses poses.tsv --segments out/batch-only.csv -q || [ $? -eq 1 ]
    make batch-afni batch $S --poses poses.tsv --format afni
    conus batch $S --poses poses.tsv --shard 0/2 -q -o out/s.tsv || [ $? -eq 1 ]
    conus batch $S --poses poses.tsv --shard 1/2 -q -o out/s.tsv
    conus batch $S --poses poses.tsv --shard all/3 -q -o out/joined.tsv || [ $? -eq 1 ]
    make sweep.tsv sweep $N $aim
    make angles.csv sweep $N --origin 0,-100,0 --toward 0,0,20 --angles 5:25:5
    make jitter.tsv sweep $S $aim --jitter 3,2 --samples 64
    make columns.json sweep $S --pose poses.tsv --jitter columns --samples 16
    make track.tsv track $S --poses hand.tsv --score intenselect
    make selected.json track $S --atlas $L --poses hand.tsv --selected --delay 0.1
    make track.ndjson track $S --poses hand.tsv
    make overlap.tsv overlap $N out/in_mask.nii.gz
    make regions.json overlap $N out/in_mask.nii.gz atlas/slabs.nii.gz --atlas $L --threshold 1
    make connect.json connect $N --streamlines lines.tck --connectivity out/matrix.tsv
    make ends.tsv query $N --streamlines lines.tck $aim --endpoints out/ends-rows.tsv --streamlines-out out/lines.tck
    make listed.csv overlap $N --labels tree.tsv out/in_mask.nii.gz --level @list.txt
    make covered.tsv overlap $N out/in_mask.nii.gz --clusters out/clusters.tsv
    make tubes.tsv query $S --origin 0,-100,0 --toward 0,0,0 --radius 0.5 --clearance out/near.tsv,within=30
    make warned.tsv query $S --point 900,0,0 --radius 1
    conus query $S $aim --format tsv -q --sidecar out/stdout.tsv.json >out/stdout.tsv
    results+=(out/{images-rows,ends-rows,s.0-of-2,s.1-of-2,joined,passed,batch-passed,clusters,near}.tsv out/batch-only.csv
        out/{beside-rows,matrix}.json
        out/{in_dseg,in_mask}.nii.gz out/stdout.tsv)
    printf '%s\n' "${results[@]}" >results
    cp -r . "$BATS_FILE_TMPDIR/kept"
}

# study: the folder of one test, with unchanged copies of all results. Replays have their folders elsewhere.
study() {
    cp -r "$BATS_FILE_TMPDIR/study/." .
    mkdir -p "$BATS_TEST_TMPDIR/tmp"
    export TMPDIR="$BATS_TEST_TMPDIR/tmp"
}

# inventory: every file here with its checksum.
inventory() {
    find . -type f -exec sha256sum {} + | sort
}

# says CODE TEXT ARGUMENT...: asserts that verify ends with CODE and writes TEXT, on stderr if there is no verdict.
says() {
    local code=$1 text=$2
    shift 2
    if [ "$code" -eq 3 ]; then
        fails 3 "$text" verify "$@"
    else
        run -"$code" --separate-stderr "$CONUS" verify "$@"
        [ -z "$stderr" ] || { echo "said: $stderr"; return 1; }
        has "$text"
    fi
    [ -z "$(ls "${TMPDIR:?is set by study}")" ] # nothing is left
}

# bats test_tags=main
@test "results of every kind are identical, in any locale, time zone and folder" {
    study
    export CONUS_ATLAS_PATH=own TZ=Asia/Kathmandu LC_ALL=C.UTF-8
    inventory >"$BATS_TEST_TMPDIR/before"
    local verified=0
    while read -r result; do
        says 0 "$result: identical" "$result"
        verified=$((verified + 1))
    done <results
    [ "$verified" -ge 50 ]
    inventory | diff "$BATS_TEST_TMPDIR/before" - # it wrote nothing here
    says 0 identical out/voxels.tsv --sidecar out/layers.json
    says 0 identical out/seen.exr --sidecar out/layers.json
    says 0 identical out/seen.png --sidecar out/mask.json
    cd /
    says 0 identical "$BATS_TEST_TMPDIR/work/out/layers.tsv"
}

@test "rows that were edited are named, in every format" {
    study
    sed -i '2s/0.818221158/0.818221159/' out/q.tsv
    says 1 'line 2, query 1: area 1 Sphere: score: 0.818221159, answered again: 0.818221158' out/q.tsv
    has 'why: out/q.tsv was changed after conus wrote it: it has another SHA-256 than out/q.json records'
    sed -i 2d out/layers.tsv
    says 1 'line 2, query 1: area 1 Shell outer: nothing, answered again: this row' out/layers.tsv
    has 'why: out/layers.tsv was changed'
    sed -i 's/another point is needed/another point is neaded/' out/threads.csv
    says 1 'name: line 3: toward: is the origin itself, another point is neaded, answered again: line 3: ' out/threads.csv
    has 'another length or CRC-32 than out/threads.json records'
    sed -i '1s/score/Score/' out/qc.csv
    says 1 'line 1, Score: this column, answered again: nothing' out/qc.csv
    sed -i 's/"pixels": 2616/"pixels": 2615/' out/qj.json
    says 1 '"pixels": 2615,, answered again: "pixels": 2616,' out/qj.json
    has 'was changed after conus wrote it: it has another SHA-256'
    printf ' ' >>out/q.txt
    says 1 'why: out/q.txt was changed' out/q.txt
    truncate -s -1 out/q.ndjson
    says 1 'line 2: ' out/q.ndjson
    : >out/sweep.tsv
    says 1 'line 1: nothing, answered again: query' out/sweep.tsv
    cp atlas/nested.nii.gz out/in_mask.nii.gz
    says 1 'its bytes differ from those of the new answer' out/in_mask.nii.gz
    has 'out/in_mask.nii.gz was changed after conus wrote it'
    says 0 'out/in_mask.nii.gz, which the same command wrote, was changed' out/mask.tsv
    cp atlas/nested.nii.gz out/seen.exr
    says 1 'its bytes differ' out/seen.exr --sidecar out/layers.json
    conus query atlas/nested.nii.gz --origin 0,-100,1 --toward 0,0,0 --angle 30 --layers all --image out/seen.exr -q -o x.tsv --force
    says 1 'of 4096 pixels differ' out/seen.exr --sidecar out/layers.json
    tac out/several.tsv | tail -1 >sorted # rows in another order
    head -n -1 out/several.tsv | tail -n +2 | tac >>sorted
    tail -1 out/several.tsv >>sorted
    cp sorted out/several.tsv
    says 1 'line 2: ' out/several.tsv
}

# A source that is another file is not read.
# bats test_tags=main
@test "one byte of a source changed: the source is named" {
    study
    local file results
    changes() { # changes FILE RESULT...: asserts that each is different once a byte of FILE is another
        file=$1
        shift
        printf '\xff' | dd of="$file" bs=1 seek=$(($(stat -c %s "$file") / 2)) conv=notrunc status=none
        for result in "$@"; do
            says 1 "why: $file changed: its SHA-256 is not the recorded one" "$result"
            has 'not answered again from '
        done
        cp "$BATS_FILE_TMPDIR/kept/$file" "$file"
    }
    changes atlas/sphere.nii.gz out/q.tsv
    changes atlas/sphere.tsv out/{q,jitter}.tsv
    changes poses.tsv out/{poses,batch}.tsv
    changes field.nii.gz out/field.tsv
    changes list.txt out/{only,list,batch-list}.tsv
    changes tree.tsv out/level.tsv
    changes in_coordsystem.json out/out_electrodes.tsv
    changes brain/brain.atlas.json out/scene.tsv
    changes out/in_mask.nii.gz out/overlap.tsv
    changes atlas/slabs.nii.gz out/{several,pathway}.tsv
    changes lines.tck out/{connect.json,ends.tsv}
}

@test "words behind a file of poses are no part of its name" {
    conus phantom sphere -o . --size 24 --spacing 3,3,3
    printf 'x\ty\tz\ttx\tty\ttz\n9\t0\t0\t0\t0\t0\n' >p.tsv
    conus batch sphere.nii.gz --poses p.tsv,unit=cm -q -o b.tsv
    conus query sphere.nii.gz --pose p.tsv,unit=cm -q -o c.tsv
    [ "$(jq -r '.Batch | .pose_file + " " + .pose_words' b.json)" = 'p.tsv unit=cm' ]
    local result
    for result in b c; do
        answers verify "$result.tsv"
    done
}

@test "a sidecar that was changed is named, and what it changes" {
    study
    sed -i 's/--angle 30/--angle 31/' out/q.json
    says 1 'why: out/q.json was changed after conus wrote it: its Checksum does not fit' out/q.tsv
    has 'Queries[0].angle_deg is 30.0 there, and 31.0 when it is answered again'
    has 'line 2, query 1: area 1 Sphere: score: 0.818221158, answered again: 0.7'
    study
    sed -i 's/"resolution": 64/"resolution": 65/' out/q.json
    says 1 'Settings.resolution is 65 there, and 64 when it is answered again' out/q.tsv
    has 'its Checksum does not fit'
    sed -i '2i "TaskName": "rest",' out/tube.json # keys of other programs are theirs
    sed -i 's/"Description": "pixels of/"LongName": "Pixels", &/' out/tube.json
    says 0 identical out/tube.tsv
    sed -i 's/"Units": "degree"/"Units": "radian"/' out/tube.json # the checksum does not cover it
    says 1 'offset_deg.Units is "radian" there, and "degree" when it is answered again' out/tube.tsv
    jq 'del(.Checksum)' out/sweep.json >edited
    cp edited out/sweep.json
    says 1 'out/sweep.json has no Checksum: it may have been changed' out/sweep.tsv
    sed -i 's/"CommandLine": "conus track/"CommandLine": "conus trick/' out/selected.json
    says 3 'begins with "conus trick"' out/selected.json
    jq '.Batch = {}' "$BATS_FILE_TMPDIR/kept/out/range.json" >out/range.json # written by conus alone
    says 3 'Batch: no shard' out/range.tsv
}

# Each value of each kind of sidecar is changed alone, with a Checksum that fits; leaves.py lists those that are free.
@test "every value of a sidecar that is changed is noticed, with the checksum recomputed" {
    study
    mapfile -t results <results
    run -0 python3 "$BATS_TEST_DIRNAME/leaves.py" "$CONUS" "${results[@]}"
    echo "$output"
    count=$(sed -nE 's/^([0-9]+) values changed, \1 noticed$/\1/p' <<<"$output")
    if [ -n "${CONUS_TEST_LONG-}" ]; then [ "$count" -ge 2000 ]; else [ "$count" -ge 250 ]; fi
    [ "${#lines[@]}" -eq 1 ]
}

# reseal FILTER NAME: the sidecar out/NAME.json through jq, with a checksum that fits.
reseal() {
    jq "$1" "out/$2.json" >old.json
    jq --arg sum "$(python3 "$BATS_TEST_DIRNAME/leaves.py" --seal old.json)" '.Checksum = $sum' old.json >"out/$2.json"
}

@test "results of other versions are answered again, and all that they say is compared" {
    study
    for name in q poses batch layers; do
        reseal '.GeneratedBy[0].Version = "0.0.1"' $name
    done
    says 0 identical out/layers.tsv
    says 0 identical out/batch.tsv
    says 0 'note: it was written by conus 0.0.1; this is' out/q.tsv
    sed -i '2s/1/2/' out/poses.tsv
    says 1 'line 2' out/poses.tsv
    says 1 'why: it was written by conus 0.0.1; this is' out/poses.tsv
    reseal 'del(.Outputs)' q
    says 1 'out/q.json: Outputs is missing there' out/q.tsv
    jq 'del(.GeneratedBy[0].CommandLine)' out/q.json >old
    mv old out/q.json
    says 3 'written by the library, its Python package or a page, not by the program' out/q.tsv
    study
    for version in '' 'x' '0.1.0 ' '0.0.9}, note = {\\input{/etc/passwd}' 0.00000000000000000000000000000000000000; do
        jq --arg version "$version" '.GeneratedBy[0].Version = $version' "$BATS_FILE_TMPDIR/kept/out/q.json" >out/q.json
        says 3 "GeneratedBy: Version: \"${version:0:40}\" is none of conus's" out/q.tsv
        fails 3 "Version" cite out/q.tsv --format bibtex
    done
    study
    reseal '.Settings.engine |= sub(",.*"; ", {\\TeX}")' q # instructions of a processor are known words
    says 1 'Settings.engine is "rays, {' out/q.tsv
}

# A file that moved or was renamed: by its path in the folder, by less of it, by its bytes.
@test "results and sources that moved are found in the folder" {
    study
    mkdir -p else/far else/atlas
    mv out/q.tsv out/q.json else/
    says 0 identical else/q.tsv # seen from this folder the paths are as they were
    mv atlas away
    says 3 'atlas/sphere.nii.gz is missing; --folder FOLDER says where it is; atlas/sphere.tsv is missing' else/q.tsv
    says 0 'note: atlas/sphere.nii.gz is now ' else/q.tsv --folder away # by its name
    mkdir bytes
    cp away/sphere.nii.gz bytes/renamed.bin
    cp away/sphere.tsv bytes/names
    says 0 'note: atlas/sphere.nii.gz is now ' else/q.tsv --folder bytes
    has "$PWD/bytes/renamed.bin"
    says 3 'atlas/sphere.nii.gz is missing' else/q.tsv --folder . # not below
    printf x >>bytes/names
    says 3 'atlas/sphere.tsv is missing' else/q.tsv --folder bytes
    mkdir -p new/atlas
    cp away/sphere.* new/atlas
    says 0 identical else/q.tsv --folder new
    printf x >>new/atlas/sphere.tsv
    says 1 'why: atlas/sphere.tsv changed' else/q.tsv --folder new
    # A manifest, with everything below it.
    mkdir moved
    mv brain moved/brain
    says 0 identical out/scene.tsv --folder moved
    says 0 identical out/folder.tsv --folder moved
    says 3 'is missing' out/q.txt --folder none
}

@test "absolute paths that moved, and names of atlases that are no longer installed" {
    study
    local here=$PWD aim='--origin 0,-100,0 --toward 0,0,0'
    mkdir a
    cp -r atlas right.txt tree.tsv list.txt a
    conus query "$here/a/atlas/nested.nii.gz" --labels "$here/a/tree.tsv" --level "@$here/a/list.txt" $aim -q \
        --pathway "$here/a/atlas/slabs.nii.gz,threshold=1" -o abs.tsv
    conus overlap "$here/a/atlas/nested.nii.gz" "$here/a/atlas/slabs.nii.gz" -q --threshold 1 --format json >region.json
    conus batch "$here/a/atlas/nested.nii.gz" --poses needles.tsv -q -o batch.tsv
    says 0 identical abs.tsv
    mv a b
    says 0 identical abs.tsv --folder b
    says 0 identical batch.tsv --folder b
    # `overlap` names a region by its path, which has changed: verify says so.
    says 1 "\"query\": \"$here/a/atlas/slabs.nii.gz" region.json --folder b
    CONUS_ATLAS_PATH=own says 0 identical out/name.tsv
    says 0 identical out/name.tsv
    mkdir owned
    mv own owned
    says 0 identical out/name.tsv --folder owned
}

@test "files of one command have one sidecar, and a note tells of those that are not as they were written" {
    study
    local aim='--origin 0,-100,0 --toward 0,0,0 --angle 30' N=atlas/nested.nii.gz
    conus query $N --streamlines lines.tck $aim --streamlines-out own.tck -q -o own.tsv
    says 0 'own.tck: identical' own.tck
    conus connect $N --streamlines lines.tck --connectivity table.tsv -q -o pairs.tsv
    says 0 identical pairs.tsv
    not has note
    cp table.tsv copy.tsv # with the bytes that are recorded
    echo >>table.tsv
    says 0 'note: table.tsv, which the same command wrote, was changed' pairs.tsv
    rm table.tsv copy.tsv
    says 0 'note: table.tsv, which the same command wrote, was not compared: it is missing' pairs.tsv
    says 0 identical out/pairs.tsv
    not has note
    echo >>out/matrix.json
    says 0 'note: out/matrix.json, which the same command wrote, was changed' out/pairs.tsv
}

# bats test_tags=main
@test "what cannot be verified is said" {
    study
    rm out/q.json
    says 3 'no .json beside it that says how it was made (pictures, pages and meshes have none); --sidecar FILE.json names it' out/q.tsv
    says 3 'cannot open' out/none.tsv
    cp out/tube.json out/range.json
    says 1 'out/range.json is the sidecar of out/tube.tsv, and neither name nor SHA-256 of out/range.tsv are recorded there' out/range.tsv
    : >out/tube.json
    says 3 'is no JSON object' out/tube.tsv
    conus query atlas/sphere.nii.gz --pose - -q -o piped.tsv <poses.tsv || [ $? -eq 1 ]
    says 3 'its poses came from standard input' piped.tsv
    says 3 'not a sidecar of conus' atlas/sphere.tsv --sidecar atlas/sphere.json
    says 3 'more than the 100 bytes that are read' out/several.tsv --max-memory 100
    says 3 'conus verify' out/several.tsv --max-memory 2000 || says 3 'atlas/' out/several.tsv --max-memory 2000
}

# hostile COMMAND-LINE TEXT [CODE]: asserts that a sidecar with it is refused, and that nothing else happens.
hostile() {
    jq --arg line "$1" '.GeneratedBy[0].CommandLine = $line | del(.Checksum)' "$BATS_FILE_TMPDIR/kept/out/q.json" >out/q.json
    cp "$BATS_FILE_TMPDIR/kept/out/q.tsv" out/q.tsv
    inventory >"$BATS_TEST_TMPDIR/before"
    says "${3:-3}" "$2" out/q.tsv
    inventory | diff "$BATS_TEST_TMPDIR/before" -
}

@test "a hostile sidecar writes nowhere, reads nothing else and starts nothing" {
    study
    local aim="--origin 0,-100,0 --toward 0,0,0" word
    hostile 'conus mesh atlas/sphere.nii.gz -o meshes' 'only conus query, batch, sweep, track, overlap, connect, plan, calibrate and positions'
    hostile 'conus phantom sphere -o .' 'begins with "conus phantom"'
    hostile 'conus view --script x' 'begins with "conus view"'
    hostile 'conus verify out/q.tsv' 'begins with "conus verify"'
    hostile 'conus' 'begins with "conus "'
    hostile 'sh -c touch' 'begins with "sh -c"'
    hostile "conus query atlas/sphere.nii.gz $aim; touch x" 'is not quoted as conus does it'
    hostile "conus query atlas/sphere.nii.gz $aim  -q" 'is not quoted as conus does it'
    hostile "conus query atlas/sphere.nii.gz \$(touch x)" 'is not quoted as conus does it'
    hostile "conus query 'atlas" 'is not quoted as conus does it'
    hostile '' 'is empty'
    hostile "conus query --help" 'begins with "conus query"'
    hostile "conus track atlas/sphere.nii.gz --listen 18944" 'came from a tracker'
    hostile "conus track atlas/sphere.nii.gz --poses hand.tsv --world-from-tracker poses.tsv" 'has --world-from-tracker'
    hostile "conus query atlas/sphere.nii.gz $aim --nonsense 1" 'does not take its command line: unknown option'
    hostile "conus query atlas/sphere.nii.gz $aim -o $PWD/evil.tsv --voxels $PWD/evil2.tsv --voxels-of all --sidecar $PWD/evil.json --mask $PWD/evil.nii.gz" 'angle_deg' 1
    hostile "conus query atlas/sphere.nii.gz $aim -o ../../../evil.tsv --image ..png" 'angle_deg' 1
    hostile "conus query atlas/sphere.nii.gz $aim --max-memory 900T" 'angle_deg' 1
    hostile "conus batch --poses poses.tsv -o out/x.tsv" 'does not take its command line: ATLAS is missing'
    hostile "conus query atlas/sphere.nii.gz $aim -o /dev/stdout --voxels - --voxels-of all" 'angle_deg' 1
    # Files that are not recorded, in each place where a command line may have one.
    cp atlas/sphere.tsv secret.txt
    ln -s / outside
    for word in '--pose secret.txt' '--labels secret.txt' '--level @secret.txt' '--context secret.txt' "--labels $PWD/secret.txt" \
        '--labels atlas/../secret.txt' '--labels secret.txt,label=index' '--only Sphere,@secret.txt' '--hide @/etc/passwd' \
        '--atlas-transform right.txt' "--atlas-transform atlas/sphere.nii.gz,from=$PWD/secret.txt" '--pathway ../x.nii' \
        '--streamlines outside/etc/passwd' '--atlas /etc/passwd' '--probe secret.txt' '--level @../secret.txt' '--labels atlas/other.tsv'; do
        case $word in
        --pose*) hostile "conus query atlas/sphere.nii.gz $word" 'which is not recorded as an input' ;;
        --context*) hostile "conus query atlas/sphere.nii.gz $aim $word --context-blocks 1" 'which is not recorded as an input' ;;
        *) hostile "conus query atlas/sphere.nii.gz $aim $word" 'which is not recorded as an input' ;;
        esac
    done
    hostile "conus query secret.txt $aim" 'angle_deg' 1 # a name of no atlas stands for the recorded one
    hostile "conus query /etc/passwd $aim" 'reads /etc/passwd, which is not recorded as an input'
    hostile "conus query $aim -- --output=$PWD/evil.tsv" 'which is not recorded as an input'
    hostile "conus overlap atlas/sphere.nii.gz atlas/sphere.nii.gz secret.txt" 'reads secret.txt, which is not recorded'
    # A folder has no SHA-256 of its own.
    mkdir private
    cp atlas/sphere.* private
    jq --arg sum "$(sha256sum list.txt | cut -d ' ' -f 1)" '.Inputs = [{path: "private", sha256: $sum}] |
        .GeneratedBy[0].CommandLine = "conus query private --origin 0,-100,0 --toward 0,0,0"' \
        "$BATS_FILE_TMPDIR/kept/out/q.json" >out/q.json
    says 3 'private is a folder, and no file in it is recorded' out/q.tsv
    # Recorded paths that lead out of the folder.
    local sum
    sum=$(sha256sum poses.tsv | cut -d ' ' -f 1)
    jq '.Inputs = [{path: "../../../../x/../../y", sha256: null}]' "$BATS_FILE_TMPDIR/kept/out/q.json" >out/q.json
    says 3 'x/../../y is missing' out/q.tsv
    jq '.Inputs = [{path: "/a/../../y", bytes: 1, sha256: "short"}]' "$BATS_FILE_TMPDIR/kept/out/q.json" >out/q.json
    says 3 'sha256: is not 64 digits' out/q.tsv
    jq --arg sum "$sum" '.Inputs = [{path: "/a/../../y", bytes: '"$(stat -c %s poses.tsv)"', sha256: $sum}]' \
        "$BATS_FILE_TMPDIR/kept/out/q.json" >out/q.json
    says 3 '/a/../../y: has ".." in it, and moved' out/q.tsv
    jq --arg sum "$sum" --arg path "$(printf '../%.0s' {1..16})poses.tsv" \
        '.Inputs = [{path: $path, bytes: '"$(stat -c %s poses.tsv)"', sha256: $sum}]' \
        "$BATS_FILE_TMPDIR/kept/out/q.json" >out/q.json
    says 3 'has too many ".."' out/q.tsv
    jq '.Inputs = [{path: "poses.tsv", sha256: null}]' "$BATS_FILE_TMPDIR/kept/out/q.json" >out/q.json
    says 1 'why: poses.tsv has no recorded SHA-256' out/q.tsv
}

# A message of the command may quote a file that whoever wrote the sidecar knows the SHA-256 of, and nothing else.
@test "what a file says that a stranger's sidecar names stands in no line" {
    study
    printf 'hunter2:secret\nmore\n' >secret.txt
    local sum line="conus query atlas/sphere.nii.gz --origin 0,-100,0 --toward 0,0,0 -q"
    sum=$(sha256sum secret.txt | cut -d ' ' -f 1)
    for rest in '--pose secret.txt' '--labels secret.txt' '--level @secret.txt' '--context secret.txt'; do
        [ "$rest" != '--pose secret.txt' ] || line="conus query atlas/sphere.nii.gz -q"
        for inputs in '[]' '[{path: "secret.txt", sha256: null}]' "[{path: \"secret.txt\", sha256: \"$sum\"}]"; do
            jq --arg line "$line $rest" ".GeneratedBy[0].CommandLine = \$line | .Inputs = $inputs" \
                "$BATS_FILE_TMPDIR/kept/out/q.json" >out/q.json
            run "$CONUS" verify out/q.tsv
            [ "$status" -eq 3 ] || [[ "$inputs" == *null* && "$status" -eq 1 ]]
            [[ "$output" != *hunter2* ]]
        done
        line="conus query atlas/sphere.nii.gz --origin 0,-100,0 --toward 0,0,0 -q"
    done
}

# store FOLDER: an image of Zarr 2 with two levels of 2 x 2 x 2 voxels; label 49 in front, 50 behind.
store() {
    mkdir -p "$1"/{0,1}
    local axis='{"type": "space", "unit": "millimeter"}' level
    printf '{"multiscales": [{"axes": [%s, %s, %s], "datasets": [
        {"path": "0", "coordinateTransformations": [{"type": "scale", "scale": [1, 1, 1]}]},
        {"path": "1", "coordinateTransformations": [{"type": "scale", "scale": [2, 2, 2]}]}]}]}' "$axis" "$axis" "$axis" >"$1/.zattrs"
    for level in 0 1; do
        echo '{"zarr_format": 2, "shape": [2, 2, 2], "chunks": [1, 2, 2], "dtype": "|u1", "order": "C", "compressor": null,
            "fill_value": '"$level}" >"$1/$level/.zarray"
        printf 1111 >"$1/$level/0.0.0"
        printf 2222 >"$1/$level/1.0.0"
    done
}

@test "a store of Zarr, with the keys that choose a level: in place, moved, changed, gone" {
    mkdir tmp
    export TMPDIR=$PWD/tmp
    store a/two.zarr
    conus query a/two.zarr,level=1,orientation=asr --point 0,0,0 --radius 0.5 -q -o rows.tsv
    says 0 'answered again from 3 files, 2 with the SHA-256' rows.tsv
    conus query "$PWD/a/two.zarr,level=1,orientation=asr" --point 0,0,0 --radius 0.5 -q -o full.tsv
    says 0 identical full.tsv
    mkdir b
    mv a/two.zarr b/
    says 3 'a/two.zarr is missing' rows.tsv
    says 0 'note: a/two.zarr is now ' rows.tsv --folder b
    says 0 'note: '"$PWD/a/two.zarr is now $PWD/b/two.zarr" full.tsv --folder b
    cp -r b/two.zarr a/
    mv b c
    mkdir d
    mv c/two.zarr/.zattrs d # nothing is written into the store
    rm -r a/two.zarr
    says 3 'zarr/.zattrs is missing' rows.tsv --folder c
    [ "$(find . -type l | wc -l)" -eq 0 ]
    mv d/.zattrs c/two.zarr/
    cp -r c/two.zarr a/
    printf 3333 >a/two.zarr/1/1.0.0 # in a chunk that is not read
    says 1 'it is answered the same again, but not all else is as it was' rows.tsv
    has 'answered again from 3 files, 2 with the SHA-256'
    has 'Atlas.volumes[0].sha256 is '
    run -1 "$CONUS" verify rows.tsv --format json
    [ "$(jq -c '[.files[] | [.path, .state]]' <<<"$output")" = \
        '[["a/two.zarr","not compared"],["a/two.zarr/.zattrs","same"],["a/two.zarr/1/.zarray","same"]]' ]
    printf 3333 >a/two.zarr/0/0.0.0 # another level
    printf 2222 >a/two.zarr/1/1.0.0
    says 0 identical rows.tsv
}

@test "the verdict as JSON" {
    study
    run -0 "$CONUS" verify out/q.tsv --format json
    [ "$(jq -c '[.verdict, .same_rows, .why, [.files[].state], .lines_that_differ]' <<<"$output")" = '["identical",true,[],["same","same"],0]' ]
    sed -i 's/Sphere/Sphare/' out/q.tsv
    run -1 "$CONUS" verify out/q.tsv --format json
    [ "$(jq -c '[.verdict, .same_rows, (.why | length), .differences[0]]' <<<"$output")" = \
        '["different",false,1,{"line":2,"where":"query 1: area 1 Sphare: name","recorded":"Sphare","again":"Sphere"}]' ]
    rm poses.tsv
    run -3 --separate-stderr "$CONUS" verify out/poses.tsv --format json
    [ "$(jq -c '[.verdict, ([.files[] | select(.path == "poses.tsv") | .state])]' <<<"$output")" = '["not verified",["missing"]]' ]
    [ -z "$stderr" ]
}

@test "AAL, by its path and by its name, on one processor" {
    need_aal
    mkdir "$BATS_TEST_TMPDIR/tmp"
    export TMPDIR="$BATS_TEST_TMPDIR/tmp"
    conus query "$aal" --origin=-90,20,20 --toward 0,-10,10 --angle 20 -q -o path.tsv
    conus query aal --origin=-90,20,20 --toward 0,-10,10 --angle 20 -q -o name.csv --sidecar name.json
    says 0 'path.tsv: identical' path.tsv
    run -0 taskset -c 0 "$CONUS" verify name.csv
    has 'name.csv: identical'
    sed -i '2s/Oper/Opel/' path.tsv
    says 1 'Frontal_Inf_Opel_L: name: Frontal_Inf_Opel_L, answered again: Frontal_Inf_Oper_L' path.tsv
}

# Whatever an option of a stranger's sidecar says, a file that is not recorded is not opened: verify says the same where
# it is there and where it is not, and names it where the row says that the option reads. The options are those of the
# rows, with what they exclude left out and what they need added.
@test "no option with a text, of no command that is answered, opens a file that is not recorded" {
    study
    local command option kept role values word refused=0 count=0 aim="--origin 0,-100,0 --toward 0,0,0" secret=$PWD/secret
    local -A asks=([query]="atlas/sphere.nii.gz $aim" [batch]="atlas/sphere.nii.gz --poses poses.tsv" [track]="atlas/sphere.nii.gz --poses hand.tsv"
        [sweep]="atlas/sphere.nii.gz $aim" [overlap]="atlas/sphere.nii.gz atlas/slabs.nii.gz --threshold 1"
        [connect]="atlas/nested.nii.gz --streamlines lines.tck" [plan]="atlas/sphere.nii.gz --poses needles.tsv --reach Sphere"
        [calibrate]="atlas/sphere.nii.gz --poses poses.tsv --weight hard" [positions]="C3")
    local -A needs=([prior]="--weight hard" [context]="--context-blocks 1" [given]="--needles needles.tsv" [world-from-tracker]="--listen 1")
    local -A instead=([query scalp]="atlas/sphere.nii.gz --origin 0,-100,0 --inward" [sweep scalp]="atlas/sphere.nii.gz --origin 0,-100,0 --inward" [batch scalp]="atlas/sphere.nii.gz --poses poses.tsv --inward" [plan scalp]="atlas/sphere.nii.gz --from needles.tsv --toward 0,0,0 --reach Sphere" [calibrate prior]="atlas/sphere.nii.gz --poses poses.tsv" [plan from]="atlas/sphere.nii.gz --toward 0,0,0 --reach Sphere" [plan toward]="atlas/sphere.nii.gz --from needles.tsv --reach Sphere")
    conus help --json | jq -r '.commands[] | select(.answers) | .name as $command | .options[]
        | select(.role != "ends" and (.type == "text" or .type == "list"))
        | [$command, .name, (.excludes // [] | index("origin") == null), .role] | @tsv' >options
    while IFS=$'\t' read -r command option kept role; do
        values=${instead[$command $option]-${asks[$command]:?}}${needs[$option]:+ ${needs[$option]}}
        [ "$kept" = true ] || values=${values/ $aim/}
        values=$(sed "s/ --$option [^ ]*//" <<<"$values")
        for word in "$secret" "@$secret"; do
            [[ $word != @* || $role == "reads names" || $role == asks ]] || continue # "@FILE" stands for names
            jq --arg line "conus $command $values --$option $word" '.GeneratedBy[0].CommandLine = $line | del(.Checksum)' \
                "$BATS_FILE_TMPDIR/kept/out/q.json" >out/q.json
            rm -f secret
            run "$CONUS" verify out/q.tsv
            local code=$status said=${output//conus-verify-??????/}
            printf 'query_id\tx\ty\tz\n' >secret
            run "$CONUS" verify out/q.tsv
            [ "$status:${output//conus-verify-??????/}" = "$code:$said" ] || { echo "$command --$option $word: $said, there: $output"; return 1; }
            if [[ $said == *'not recorded as an input'* || $said == *'asked again'* ]]; then
                refused=$((refused + 1))
            elif [[ $role == reads* ]]; then
                echo "$command --$option $word: $said"
                return 1
            fi
            count=$((count + 1))
        done
    done <options
    echo "$count words, $refused refused"
    [ "$count" -ge 150 ] && [ "$refused" -ge 150 ]
}

# What a user of another machine answers again (data-samples/README.md). A version that writes other bytes makes it anew.
# bats test_tags=main
@test "the result that is shipped is answered again, byte for byte" {
    cp "$BATS_TEST_DIRNAME"/../../data-samples/u-shape* .
    run -0 "$CONUS" verify u-shape-answers.tsv
    has 'u-shape-answers.tsv: identical'
    [ "$(cut -f 1 u-shape-answers.tsv | sort -u | wc -l)" -eq 61 ] # 60 poses and the header
}
