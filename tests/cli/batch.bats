#!/usr/bin/env bats
# conus batch and conus merge, as a user types them.
load helpers

# poses N: poses.tsv with N poses around a ball, every third of which looks past it.
poses() {
    awk -v n="$1" 'BEGIN {
        print "x\ty\tz\ttx\tty\ttz"
        for (i = 0; i < n; i++)
            printf "%.3f\t%.3f\t%.3f\t%.3f\t%.3f\t0\n", 90 * cos(i), 90 * sin(i), i % 60 - 30, i % 3 * 13, i % 7
    }' >poses.tsv
}

# batch ARGUMENT...: conus batch on the ball.
batch() {
    conus batch sphere.nii.gz --poses poses.tsv --angle 12 "$@"
}

# hold_batch ARGUMENT...: the same in blocks of 100 poses, stopped after the first of them (helpers.bash).
hold_batch() {
    hold batch sphere.nii.gz --poses poses.tsv --angle 12 --block 100 "$@"
}

setup_ball() {
    sphere --size 32 --spacing 2,2,2
    poses "$1"
}

hash_of() {
    sha256sum <"$1"
}

# wait_for_lines N FILE: until FILE, which process $pid writes, has N lines.
wait_for_lines() {
    wait_until "$pid" has_lines "$@"
}

# bats test_tags=main
@test "the rows are those of conus query" {
    setup_ball 300
    answers batch sphere.nii.gz --poses poses.tsv --angle 12 -o rows.tsv
    answers query sphere.nii.gz --pose poses.tsv --angle 12 -o query.tsv
    cmp rows.tsv query.tsv
    answers batch sphere.nii.gz --poses poses.tsv --angle 12 -o rows.ndjson
    answers query sphere.nii.gz --pose poses.tsv --angle 12 -o query.ndjson
    cmp rows.ndjson query.ndjson
    batch | cmp - rows.tsv
    conus batch sphere.nii.gz --poses - --angle 12 --format ndjson <poses.tsv | cmp - rows.ndjson
    nothing_left sphere.nii.gz sphere.tsv sphere.json poses.tsv rows.tsv rows.json rows.ndjson rows.ndjson.json query.tsv query.json query.ndjson query.ndjson.json
}

@test "poses from a pipe that has a name are all answered, into a file, too" {
    setup_ball 20000
    batch -o rows.tsv
    conus batch sphere.nii.gz --poses <(cat poses.tsv) --angle 12 -o piped.tsv
    cmp rows.tsv piped.tsv
    run -2 --separate-stderr conus batch sphere.nii.gz --poses <(cat poses.tsv) --angle 12 -o other.tsv --resume
    check_message '--resume needs a file of poses, not a pipe'
    run -2 --separate-stderr conus batch sphere.nii.gz --poses -,unit=mm --angle 12 -o other.tsv --resume <poses.tsv
    check_message '--resume needs a file of poses, not standard input'
}

@test "a run that is resumed has the words behind its poses" {
    setup_ball 30
    conus batch sphere.nii.gz --poses poses.tsv,unit=mm --angle 12 -q -o rows.tsv || [ $? -eq 1 ]
    run -2 --separate-stderr conus batch sphere.nii.gz --poses poses.tsv,unit=cm --angle 12 -q -o rows.tsv --resume
    check_message 'rows.tsv: there is a file already'
}

# bats test_tags=main
@test "one SHA-256 for any number of threads and any size of blocks" {
    setup_ball 500
    batch --threads 1 -o rows.tsv
    for settings in "1 1" "2 7" "3 256" "2 65536" "16 3"; do
        batch --threads "${settings% *}" --block "${settings#* }" -o other.tsv --force
        cmp rows.tsv other.tsv
    done
}

# ranged_poses: poses around three shells with ranges; every fifth has none, every third only a far end.
ranged_poses() {
    awk -v n="$1" -v OFS='\t' 'BEGIN {
        print "query_id", "x", "y", "z", "tx", "ty", "tz", "near", "far"
        for (i = 1; i <= n; i++)
            print i, 40 * cos(i), 40 * sin(i), i % 7, i % 3 * 4, i % 5, 0,
                  (i % 5 && i % 3 ? i % 4 * 12 : "n/a"), (i % 5 ? 37 + i % 12 : "")
    }' >ranged.tsv
}

# alone ARGUMENT...: the answers to each row of ranged.tsv on its own, by --range; 20,44 stands for missing ends.
alone() {
    local pose near far first=1
    while IFS= read -r pose; do
        IFS=: read -r near far <<<"$(cut -f 8- <<<"$pose" | tr '\t' :)"
        printf 'query_id\tx\ty\tz\ttx\tty\ttz\n%s\n' "$(cut -f -7 <<<"$pose")" >one.tsv
        range=${near/n\/a/20},${far:-44}
        conus batch nested.nii.gz --poses one.tsv --threads 1 --range "$range" -q "$@" | tail -n "+$first"
        first=2
    done < <(tail -n +2 ranged.tsv)
}

@test "near and far of a row are its own --range" {
    conus phantom nested -o . --size 32
    ranged_poses 12
    local aim=(nested.nii.gz --range 20,44 -q)
    for what in "--angle 12" "--angle 12 --layers all" "--radius 2"; do
        alone $what >wanted.tsv
        [ "$(grep -c area wanted.tsv)" -gt 12 ]
        conus query "${aim[@]}" --pose ranged.tsv $what --format tsv | cmp - wanted.tsv
        for settings in "1 1" "2 7" "3 256"; do
            conus batch "${aim[@]}" --poses ranged.tsv $what --threads "${settings% *}" --block "${settings#* }" | cmp - wanted.tsv
        done
        run "$CONUS" batch "${aim[@]}" --poses ranged.tsv $what --engine gl --block 9
        if [ "$status" -ne 4 ] || ! lacks_gl; then
            cmp - wanted.tsv <<<"$output"
        fi
    done
    for rows in segments clearance; do
        alone "--$rows" - >wanted.tsv
        conus query "${aim[@]}" --pose ranged.tsv "--$rows" - --format tsv | cmp - wanted.tsv
        conus batch "${aim[@]}" --poses ranged.tsv "--$rows" - --threads 2 --block 3 | cmp - wanted.tsv
    done
    conus batch "${aim[@]}" --poses ranged.tsv -o rows.tsv
    [ "$(jq -c '[.Batch.own_ranges, .Settings.range_mm]' rows.json)" = '[true,[20,44]]' ]
    conus verify rows.tsv
    run conus cite rows.tsv
    [[ "$(tr '\n' ' ' <<<"$output")" == *"20 mm and 44 mm from the apex, or the pose's own where the file gives them."* ]]
    conus query "${aim[@]}" --pose ranged.tsv -o rows.json --force
    [ "$(jq -c '[.Queries[1, 2, 4, 7].range_mm]' rows.json)" = '[[24,39],[20,40],null,[0,45]]' ]
}

@test "sweep, track and render take the row's range" {
    setup_ball 1
    local row='0\t0\t90\t0\t0\t0\t0'
    printf "x\ty\tz\ttx\tty\ttz\ttime_s\tnear\tfar\n$row\t0\t65\n$row\t75\tn/a\n" >poses.tsv
    for command in "sweep --pose" "sweep --angles 5 --pose" "sweep --jitter 1,1 --samples 32 --pose" "track --poses"; do
        # the ball is hit at 70 mm, and ends at 110
        conus ${command%% *} sphere.nii.gz ${command#* } poses.tsv --format tsv --range 0,100 -q >rows
        [ "$(cut -f 2,4 rows | grep -c area)" -eq 1 ]
    done
    conus render sphere.nii.gz --pose poses.tsv -o '{row}.png' --size 64x64 -q --range 0,100
    conus render sphere.nii.gz --pose poses.tsv -o 'cone{row}.png' --size 64x64 -q --range 0,65 --row 1
    cmp 1.png cone1.png
}

@test "a row whose near and far are no range has no answer" {
    setup_ball 1
    printf 'x\ty\tz\ttx\tty\ttz\tnear\tfar\n' >poses.tsv
    printf '0\t0\t90\t0\t0\t0\t%s\n' $'0\t80' $'30\t20' $'n/a\t0' $'\t80' $'40\t' $'-1\t9' $'nan\t80' $'0\tfar' >>poses.tsv
    run -1 --separate-stderr conus batch sphere.nii.gz --poses poses.tsv -q
    [ "$(cut -f 1-2 <<<"$output" | sort -u | grep -c error)" -eq 6 ]
    [[ "$output" == *'line 3: range: 30 to 20 mm, allowed is NEAR from 0 on and FAR beyond it'* ]]
    [[ "$output" == *'line 6: range: 40 to 0 mm'*'line 7: range: -1 to 9 mm'*'line 9: column far: "far" is not a finite number'* ]]
    batched=$output
    run -1 --separate-stderr conus query sphere.nii.gz --pose poses.tsv --format tsv -q
    [ "$output" = "$batched" ]
    run -1 --separate-stderr conus batch sphere.nii.gz --poses poses.tsv --sampling slices -q
    [[ "$output" == *'line 2: range: needs exact sampling, slices see only what is first'* ]]
}

# bats test_tags=main
@test "a pose without an answer gets a row that says why, and the exit code is 1" {
    setup_ball 2
    printf 'query_id\tx\ty\tz\ttx\tty\ttz\tangle\n' >poses.tsv
    printf 'a\t0\t0\t90\t0\t0\t0\t5\nb\t1\t1\t1\t1\t1\t1\t5\nc\tnan\t0\t0\t0\t0\t0\t5\nd\t0\t0\t90\t0\t0\t0\t180\n' >>poses.tsv
    printf 'e\t0\t0\t90\t0\t0\nf\t0\t90\t0\t0\t0\t0\t5\n' >>poses.tsv
    run -1 --separate-stderr conus batch sphere.nii.gz --poses poses.tsv
    check_message 'poses.tsv: no answer to 4 of 6 poses, the first in line 3: toward: is the origin itself, another point is needed'
    [ "$(cut -f 1,2 <<<"$output" | tr '\n\t' ' /')" = "query/kind a/area a/unassigned b/error c/error d/error e/error f/area f/unassigned " ]
    [ "$(cell name 3)" = "line 3: toward: is the origin itself, another point is needed" ]
    [[ "$(cell name 4)" == "line 4: "*nan* ]]
    [[ "$(cell name 5)" == "line 5: angle: 180 degrees"* ]]
    [ "$(cell pixels 5)/$(cell share 5)/$(cell index 5)" = n/a/n/a/n/a ]
    [ "$(awk -F'\t' '{ print NF }' <<<"$output" | sort -u)" = 24 ]
    run -1 --separate-stderr conus batch sphere.nii.gz --poses poses.tsv --format ndjson
    [[ "${lines[2]}" == '{"query":"b","kind":"error","index":null,"name":"line 3: '* ]]
    run -1 conus batch sphere.nii.gz --poses poses.tsv -o rows.tsv
    grep -q '"errors": 4' rows.json
}

@test "poses without an answer are counted at the end: from a pipe, by shards, of a file that is whole already, once" {
    setup_ball 3
    printf 'x\ty\tz\ttx\tty\ttz\n' >poses.tsv
    printf '%s\t0\t0\t0\t0\t0\n' 90 90,5,1 80 '(null)' >>poses.tsv # lines 2 to 5; 3 and 5 have no number
    first='the first in line 3: column x: "90,5,1" is not a finite number'
    run -1 --separate-stderr conus batch sphere.nii.gz --poses - --block 1 <poses.tsv
    check_message "standard input: no answer to 2 of 4 poses, $first"
    run -1 --separate-stderr conus batch sphere.nii.gz --poses poses.tsv -o rows.tsv --segments segments.tsv --quiet
    check_message "poses.tsv: no answer to 2 of 4 poses, $first"
    run -1 --separate-stderr conus batch sphere.nii.gz --poses poses.tsv -o rows.tsv --resume
    check_message 'poses.tsv: no answer to 2 of 4 poses'
    run -1 --separate-stderr conus batch sphere.nii.gz --poses poses.tsv --shard 1/2 -o rows.1.tsv
    check_message 'no answer to 1 of 2 poses, the first in line 5: column x: "(null)" is not a finite number'
    sed -i '2,3d;5d' poses.tsv
    answers batch sphere.nii.gz --poses poses.tsv -o fine.tsv
}

# bats test_tags=main
@test "shards joined are the file of one run" {
    setup_ball 101
    batch -o rows.tsv
    for i in 0 1 2 3; do
        batch --shard "$i/4" -o "rows.$i.tsv"
        batch --shard "$i/4" -o "rows.$i.ndjson"
    done
    answers merge rows.3.tsv rows.1.tsv rows.0.tsv rows.2.tsv -o merged.tsv
    cmp rows.tsv merged.tsv
    diff <(grep -Ev 'CommandLine|Checksum' rows.json) <(grep -Ev 'CommandLine|Checksum' merged.json) >differences || true
    run ! grep -v '"Name"\|"Version"\|^[0-9,acd]*$\|[{}]\|^---' differences
    batch -o rows.ndjson
    answers merge rows.?.ndjson -o merged.ndjson
    cmp rows.ndjson merged.ndjson
    batch --shard 0/1 | cmp - rows.tsv
}

@test "more shards than poses: some are empty, and join all the same" {
    setup_ball 2
    batch -o rows.tsv
    for i in 0 1 2; do
        batch --shard "$i/3" -o "rows.$i.tsv"
    done
    [ "$(wc -l <rows.2.tsv)" -eq 1 ]
    answers merge rows.2.tsv rows.1.tsv rows.0.tsv -o merged.tsv
    cmp rows.tsv merged.tsv
}

@test "shards that do not belong together are not joined" {
    setup_ball 20
    for i in 0 1 2; do
        batch --shard "$i/3" -o "rows.$i.tsv"
    done
    fails 3 'shard 1 of 3 is missing' merge rows.0.tsv rows.2.tsv -o merged.tsv
    fails 3 'shard 2 of 3 is missing' merge rows.0.tsv rows.1.tsv -o merged.tsv
    cp rows.1.tsv again.tsv
    cp rows.1.json again.json
    fails 3 'are both shard 1 of 3' merge rows.0.tsv rows.1.tsv rows.2.tsv again.tsv -o merged.tsv
    batch --shard 1/3 -o other.tsv --resolution 8
    fails 3 'are not shards of one batch' merge rows.0.tsv other.tsv rows.2.tsv -o merged.tsv
    cp rows.1.tsv odd.tsv
    sed 's/"heading": [0-9]*/"heading": 0/' rows.1.json >odd.json
    fails 3 'are not shards of one batch' merge rows.0.tsv odd.tsv rows.2.tsv -o merged.tsv
    fails 2 'would overwrite the input rows.0.tsv' merge rows.0.tsv rows.1.tsv rows.2.tsv -o rows.0.tsv
    fails 2 'would overwrite the input rows.1.json' merge rows.0.tsv rows.1.tsv rows.2.tsv -o rows.1.json --force
    sed -i '$s/unassigned/Unassigned/' rows.2.tsv
    fails 3 'rows.2.tsv: is not the file that rows.2.json describes' merge rows.0.tsv rows.1.tsv rows.2.tsv -o merged.tsv
    rm again.json
    fails 3 'again.json: ' merge rows.0.tsv again.tsv rows.2.tsv -o merged.tsv
    fails 2 '--output FILE is missing' merge rows.0.tsv
    [ ! -e merged.tsv ]
}

@test "the number of poses without an answer is that of the rows, in every format" {
    setup_ball 6
    local lost='"lost, ""one""",0,0,0,0,0,0'
    { echo query_id,x,y,z,tx,ty,tz; tail -n +2 poses.tsv | sed 's/\t/,/g; s/^/,/'; echo "$lost"; echo "$lost"; } >poses.csv
    printf 'name\tx\ty\tz\nA\t0\t0\t0\nB\tn/a\t0\t0\nC\t90\t90\t90\n' >sub_electrodes.tsv
    for format in csv ndjson afni; do
        run -1 conus batch sphere.nii.gz --poses poses.csv --force --format $format -o "rows.$format"
    done
    run -1 conus batch sphere.nii.gz --poses poses.csv --summary --format csv -o summary.csv
    run -1 conus batch sphere.nii.gz --poses sub_electrodes.tsv --radius 3 --quiet --format bids -o contacts.tsv
    run -1 conus batch sphere.nii.gz --poses poses.csv -o full.tsv
    for file in full.tsv:2 rows.csv:2 rows.ndjson:2 rows.afni:2 summary.csv:2 contacts.tsv:1; do
        local name=${file%:*} wanted=${file#*:} sidecar
        sidecar=$name.json
        [ -e "$sidecar" ] || sidecar=${name%.*}.json
        "$CONUS" merge "$name" -o "joined.$name" --force
        cmp "$name" "joined.$name"
        sed -i "s/\"errors\": $wanted,/\"errors\": 0,/" "$sidecar"
        fails 3 "$name: $wanted poses without an answer, $sidecar says 0" merge "$name" -o "joined.$name" --force
    done
}

@test "--shard comes from a Slurm job array, and is said" {
    setup_ball 50
    export SLURM_ARRAY_TASK_ID=12 SLURM_ARRAY_TASK_COUNT=4 SLURM_ARRAY_TASK_MIN=10
    run -0 --separate-stderr conus batch sphere.nii.gz --poses poses.tsv --angle 12 -o slurm.tsv
    check_message 'note: shard 2/4, from SLURM_ARRAY_TASK_ID=12'
    unset SLURM_ARRAY_TASK_ID
    batch --shard 2/4 | cmp - slurm.tsv
    export SLURM_ARRAY_TASK_ID=15
    fails 2 'SLURM_ARRAY_TASK_ID=15 does not say which part' batch sphere.nii.gz --poses poses.tsv
    export SLURM_ARRAY_TASK_ID=10 SLURM_ARRAY_TASK_MAX=14
    fails 2 'SLURM_ARRAY_TASK_ID=10 does not say which part' batch sphere.nii.gz --poses poses.tsv
    answers batch sphere.nii.gz --poses poses.tsv --shard 0/1 -o all.tsv
}

@test "mistakes in --shard, --threads, --block and the outputs are reported" {
    setup_ball 3
    fails 2 '--shard: "4/4" is not I/N' batch sphere.nii.gz --poses poses.tsv --shard 4/4
    fails 2 '--shard: "1" is not I/N' batch sphere.nii.gz --poses poses.tsv --shard 1
    fails 2 '--shard: "-1/2" is not I/N' batch sphere.nii.gz --poses poses.tsv --shard=-1/2
    fails 2 '--shard needs a file of poses' batch sphere.nii.gz --poses - --shard 0/2
    fails 2 '--resume needs a file of poses' batch sphere.nii.gz --poses - --resume -o rows.tsv
    fails 2 '--threads' batch sphere.nii.gz --poses poses.tsv --threads 0
    fails 2 '--block' batch sphere.nii.gz --poses poses.tsv --block 100000
    fails 2 '--poses FILE is missing' batch sphere.nii.gz
    fails 2 '--resume has no effect without a file for --output' batch sphere.nii.gz --poses poses.tsv --resume
    fails 2 '--resume has no effect without a file for --output' batch sphere.nii.gz --poses poses.tsv --resume -o -
    fails 2 '--force has no effect without a file for --output' batch sphere.nii.gz --poses poses.tsv --force -o -
    fails 2 '--force and --resume exclude each other' batch sphere.nii.gz --poses poses.tsv -o a.tsv --force --resume
    fails 2 'would overwrite the input' batch sphere.nii.gz --poses poses.tsv --format tsv -o sphere.nii.gz --force
    fails 2 'would overwrite the input' batch sphere.nii.gz --poses poses.tsv -o poses.tsv --force
    fails 3 'none.tsv' batch sphere.nii.gz --poses none.tsv
    for ending in part journal; do
        mv poses.tsv rows.tsv.$ending
        fails 2 "would overwrite the input rows.tsv.$ending" batch sphere.nii.gz --poses rows.tsv.$ending -o rows.tsv --force
        mv rows.tsv.$ending poses.tsv
    done
    nothing_left sphere.nii.gz sphere.tsv sphere.json poses.tsv
}

@test "only files are replaced: no device, pipe, folder or link" {
    setup_ball 3
    batch --shard 0/1 -o whole.tsv
    mkfifo pipe.tsv rows.json
    mkdir folder.tsv
    ln -s whole.tsv link.tsv
    for name in pipe folder link; do
        local kind="is a ${name/pipe/device or pipe}, which a file would replace"
        fails 3 "$name.tsv: cannot write: $kind" batch sphere.nii.gz --poses poses.tsv -o $name.tsv --force
        fails 3 "$name.tsv: cannot write: $kind" merge whole.tsv -o $name.tsv --force
    done
    fails 3 'rows.json: cannot write: is a device or pipe' batch sphere.nii.gz --poses poses.tsv -o rows.tsv --force
    fails 3 'rows.json: cannot write: is a device or pipe' merge whole.tsv -o rows.tsv --force
    [ -p pipe.tsv ] && [ -d folder.tsv ] && [ -L link.tsv ] && [ -p rows.json ]
    nothing_left sphere.nii.gz sphere.tsv sphere.json poses.tsv whole.tsv whole.json
}

# bats test_tags=main
@test "nothing is overwritten without --force" {
    setup_ball 5
    batch -o rows.tsv
    local before=$(hash_of rows.tsv)
    fails 2 'rows.tsv: there is a file already; --force replaces it' batch sphere.nii.gz --poses poses.tsv -o rows.tsv
    [ "$(hash_of rows.tsv)" = "$before" ]
    answers batch sphere.nii.gz --poses poses.tsv -o rows.tsv --force
    [ "$(hash_of rows.tsv)" != "$before" ]
}

@test "a file that has lost its end is not taken as finished" {
    setup_ball 5
    batch -o rows.tsv
    truncate -s -10 rows.tsv
    fails 2 'rows.tsv: there is a file already' batch sphere.nii.gz --poses poses.tsv --angle 12 -o rows.tsv --resume
}

# bats test_tags=main
@test "killed and resumed three times: the file of one run" {
    setup_ball 2000
    batch -o rows.tsv
    for blocks in 1 2 3; do
        hold_batch -o killed.tsv --resume
        wait_for_blocks "$blocks" killed.tsv
        stop_held KILL 137
        [ ! -e killed.tsv ]
        fails 2 'killed.tsv: an unfinished batch is there; --resume continues it, --force begins anew' \
            batch sphere.nii.gz --poses poses.tsv --angle 12 -o killed.tsv
        fails 2 'written with other settings' batch sphere.nii.gz --poses poses.tsv --angle 13 -o killed.tsv --resume
    done
    batch --threads 3 -o killed.tsv --resume
    cmp rows.tsv killed.tsv
    [ ! -e killed.tsv.part ] && [ ! -e killed.tsv.journal ]
    diff <(grep -Ev 'CommandLine|Checksum' rows.json) <(grep -Ev 'CommandLine|Checksum' killed.json)
    answers batch sphere.nii.gz --poses poses.tsv --angle 12 -o killed.tsv --resume
    fails 2 'there is a file already' batch sphere.nii.gz --poses poses.tsv --angle 13 -o killed.tsv --resume
}

@test "poses that change while they are answered: an error, and what is there goes on with the old ones" {
    setup_ball 20000
    batch -o rows.tsv
    cp poses.tsv old.tsv
    hold_batch --threads 1 -o changed.tsv
    wait_for_blocks 1 changed.tsv
    sed 's/^[0-9-]/1/' old.tsv >poses.tsv # the same file, with other bytes
    let_go 3
    grep -q 'conus: poses.tsv: changed while it was read' said
    [ ! -e changed.tsv ] && [ ! -e changed.json ] && [ -e changed.tsv.part ] && [ -e changed.tsv.journal ]
    fails 2 'written with other settings, poses' \
        batch sphere.nii.gz --poses poses.tsv --angle 12 --block 100 -o changed.tsv --resume
    cp old.tsv poses.tsv
    batch -o changed.tsv --resume
    cmp rows.tsv changed.tsv
}

@test "pipes in the place of a batch's own files are refused, not waited for" {
    setup_ball 5
    batch -o whole.tsv
    for ending in journal part; do
        rm -f rows.tsv.*
        touch rows.tsv.journal rows.tsv.part
        rm "rows.tsv.$ending"
        mkfifo "rows.tsv.$ending"
        for how in --resume --force; do
            run -3 --separate-stderr timeout 60 "$CONUS" batch sphere.nii.gz --poses poses.tsv -o rows.tsv $how
            check_message "rows.tsv.$ending: cannot write: is a device or pipe"
        done
    done
    mkfifo shard.tsv
    cp whole.json shard.json
    run -3 --separate-stderr timeout 60 "$CONUS" merge shard.tsv -o joined.tsv
    check_message 'shard.tsv: cannot read: is a pipe, a regular file is needed'
    rm shard.tsv shard.json
    cp whole.tsv shard.tsv
    mkfifo shard.json
    run -3 --separate-stderr timeout 60 "$CONUS" merge shard.tsv -o joined.tsv
    check_message 'shard.json: cannot read: is a pipe, a regular file is needed'
}

@test "leftovers of other processes do no harm" {
    setup_ball 5
    batch -o rows.tsv
    # Partial files under the names of older versions, rows.json.PID.part, of the next processes.
    local next=$(sh -c 'echo $$')
    for pid in $(seq "$next" $((next + 300))); do
        echo left >"rows.json.$pid.part"
        echo left >"joined.tsv.$pid.part"
    done
    answers batch sphere.nii.gz --poses poses.tsv --angle 12 -o rows.tsv --force
    answers merge rows.tsv -o joined.tsv
    cmp rows.tsv joined.tsv
}

@test "half-written rows of a crash are cut off" {
    setup_ball 2000
    batch -o rows.tsv
    for blocks in 1 2 3 4; do
        hold_batch -o torn.tsv --resume
        wait_for_blocks "$blocks" torn.tsv
        stop_held KILL 137
    done
    cp torn.tsv.part part
    cp torn.tsv.journal journal
    printf '17 0 1000 0123' >>torn.tsv.journal # a line that was being written
    batch -o torn.tsv --resume
    cmp rows.tsv torn.tsv
    rm torn.tsv torn.json
    cp journal torn.tsv.journal
    head -c 3000 part >torn.tsv.part # rows that never reached the disk
    batch -o torn.tsv --resume
    cmp rows.tsv torn.tsv
    rm torn.tsv torn.json
    cp journal torn.tsv.journal
    cp part torn.tsv.part
    printf X | dd of=torn.tsv.part bs=1 seek=9000 conv=notrunc status=none # or reached it damaged
    batch -o torn.tsv --resume
    cmp rows.tsv torn.tsv
    rm torn.tsv torn.json
    sed '4s/^\([0-9]*\) [0-9]* /\1 99 /' journal >torn.tsv.journal # the journal is damaged: other counts, the same bytes
    not cmp -s journal torn.tsv.journal
    cp part torn.tsv.part
    batch -o torn.tsv --resume
    cmp rows.tsv torn.tsv
    diff <(grep -Ev 'CommandLine|Checksum' rows.json) <(grep -Ev 'CommandLine|Checksum' torn.json)
    rm torn.tsv torn.json
    : >torn.tsv.journal
    cp part torn.tsv.part
    batch -o torn.tsv --resume
    cmp rows.tsv torn.tsv
}

@test "--resume notices files that decide the answers: coordinate system, label table" {
    setup_ball 2
    printf 'name\tx\ty\tz\tsize\nA1\t1\t2\t1\t5\nA2\t0\t0\t9\t5\n' >sub-1_electrodes.tsv
    system() {
        printf '{"iEEGCoordinateSystem": "ScanRAS", "iEEGCoordinateUnits": "%s"}' "$1" >sub-1_coordsystem.json
    }
    ask() {
        conus batch sphere.nii.gz,template=none --poses sub-1_electrodes.tsv --radius 3 --labels sphere.tsv --quiet "$@"
    }
    system mm
    ask -o rows.tsv
    ask -o rows.tsv --resume
    grep -q "\"coordsystem_file_sha256\": \"$(sha256sum sub-1_coordsystem.json | cut -d ' ' -f 1)\"" rows.json
    system cm
    run -2 --separate-stderr ask -o rows.tsv --resume
    check_message 'rows.tsv: there is a file already'
    system mm
    ask -o rows.tsv --resume
    mv sub-1_coordsystem.json away
    run -2 ask -o rows.tsv --resume
    mv away sub-1_coordsystem.json
    sed -i 's/Sphere/Ball/' sphere.tsv
    run -2 ask -o rows.tsv --resume
    sed -i 's/Ball/Sphere/' sphere.tsv
    ask -o rows.tsv --resume
    fails 2 'would overwrite the input sub-1_coordsystem.json' \
        batch sphere.nii.gz,template=none --poses sub-1_electrodes.tsv --radius 3 --quiet -o sub-1_coordsystem.tsv --force
    for command in "query --pose" "sweep --angle 5 --pose"; do
        # shellcheck disable=SC2086 # words
        fails 2 'would overwrite the input sub-1_coordsystem.json' \
            $command sub-1_electrodes.tsv sphere.nii.gz,template=none --along-shafts --quiet --format tsv -o sub-1_coordsystem.tsv
    done
}

# bats test_tags=main
@test "a full disk: a message, and --resume goes on" {
    setup_ball 5000
    batch -o rows.tsv
    (
        ulimit -f 200
        run -3 --separate-stderr conus batch sphere.nii.gz --poses poses.tsv --angle 12 -o full.tsv
        check_message 'full.tsv: cannot write: File too large'
        ulimit -f 1
        run -3 --separate-stderr conus query sphere.nii.gz --pose poses.tsv --angle 12 --format tsv -q -o query.tsv
        check_message 'query.json: cannot write: File too large'
    )
    [ ! -e full.tsv ]
    batch -o full.tsv --resume
    cmp rows.tsv full.tsv
    [ -e /dev/full ] || return 0
    conus batch sphere.nii.gz --poses poses.tsv 2>said >/dev/full && return 1 || [ $? -eq 3 ]
    grep -q 'standard output: cannot write: No space left on device' said
}

@test "a closed pipe ends it" {
    setup_ball 5000
    set +o pipefail
    { batch -q 2>said || echo $? >code; } | head -n 1 >first
    [ "$(cat code)" -eq 3 ]
    [ ! -s said ]
}

@test "SIGINT and SIGTERM finish the block and say how to go on" {
    setup_ball 2000
    batch -o rows.tsv
    hold_batch -o stopped.tsv
    wait_for_blocks 1 stopped.tsv
    stop_held INT 130
    grep -q 'conus: interrupted after 100 poses; continue with: conus batch .* -o stopped.tsv -q --progress json --resume' said
    hold_batch -o stopped.tsv --resume
    wait_for_blocks 2 stopped.tsv
    stop_held TERM 143
    grep -q 'conus: interrupted after 200 poses; continue' said
    batch -o stopped.tsv --resume
    cmp rows.tsv stopped.tsv
}

# stop SIGNAL CODE: ends process $pid with the signal; its exit code must be CODE.
stop() {
    local code=0
    kill "-$1" "$pid"
    wait "$pid" 2>/dev/null || code=$?
    [ "$code" -eq "$2" ] || { echo "ended with $code"; return 1; }
}

# pipe_in OPTION...: starts a batch in the background, process $pid, on a pipe that has the poses and half a line more,
# and then is silent.
pipe_in() {
    [ -p silent ] || mkfifo silent
    env --default-signal=INT "$CONUS" batch sphere.nii.gz --poses - --angle 12 --block 100 -q "$@" <silent >piped.tsv 2>said 3>&- &
    pid=$!
    exec 5>silent
    { cat poses.tsv; printf '1\t2\t3\t4\t5\t6'; } >&5
}

@test "SIGINT and SIGTERM end a batch that waits for a silent pipe, with all that came" {
    setup_ball 250
    batch -o rows.tsv
    local two_blocks=$(conus batch sphere.nii.gz --angle 12 --poses <(head -201 poses.tsv) | wc -l)
    for threads in 1 2 5; do
        pipe_in --threads $threads
        wait_for_lines "$two_blocks" piped.tsv
        stop INT 130
        exec 5>&-
        cmp rows.tsv piped.tsv
        [ "$(cat said)" = 'conus: interrupted after 250 poses' ]
    done
    pipe_in --threads 2 -o kept.tsv
    wait_for_lines "$two_blocks" kept.tsv.part
    stop TERM 143
    exec 5>&-
    cmp rows.tsv kept.tsv.part
}

@test "a reader that goes ends a batch that waits for a silent pipe" {
    setup_ball 2000
    mkfifo silent rows
    timeout $HANG "$CONUS" batch sphere.nii.gz --poses silent --angle 12 --threads 2 -q >rows 2>said 3>&- &
    pid=$!
    head -n 1 rows >first &
    exec 5>silent
    cat poses.tsv >&5 || true
    local code=0
    wait "$pid" || code=$?
    exec 5>&-
    [ "$code" -eq 3 ]
    [ ! -s said ]
}

@test "two runs do not write one file" {
    setup_ball 2000
    hold_batch -o rows.tsv
    wait_for_blocks 1 rows.tsv
    fails 3 'rows.tsv: another conus is writing this file' batch sphere.nii.gz --poses poses.tsv --angle 12 -o rows.tsv --resume
    let_go 0
}

@test "progress is JSON for programs, and nothing where nobody looks" {
    setup_ball 2000
    run -0 --separate-stderr conus batch sphere.nii.gz --poses poses.tsv --block 500 -q --progress json -o rows.tsv
    [[ "${stderr_lines[0]}" == '{"done":500,"total":2000,"errors":0,"rate":'*',"finished":false}' ]]
    [[ "${stderr_lines[-1]}" == '{"done":2000,"total":2000,"errors":0,"rate":'*',"finished":true}' ]]
    answers batch sphere.nii.gz --poses poses.tsv -o other.tsv
    answers batch sphere.nii.gz --poses poses.tsv -o third.tsv --progress none
}

# bats test_tags=main
@test "--summary: the best, the runner-up and the margin, one row per pose" {
    conus phantom nested -o . --size 48
    printf 'x\ty\tz\ttx\tty\ttz\n0\t0\t200\t0\t0\t0\n0\t0\t200\t0\t0\t400\n0\t0\t0\t0\t0\t0\n' >poses.tsv
    run -1 --separate-stderr conus batch nested.nii.gz --poses poses.tsv --angle 40 --summary
    [ "${#lines[@]}" -eq 4 ]
    local summary=$output
    conus query nested.nii.gz --origin 0,0,200 --toward 0,0,0 --angle 40 --format tsv >full
    [ "$(cell name 1)" = "$(awk -F'\t' 'NR == 2 { print $4 }' full)" ]
    [ "$(cell share 1)" = "$(awk -F'\t' 'NR == 2 { print $9 }' full)" ]
    [ "$(cell unassigned_share 1)" = "$(awk -F'\t' 'END { print $9 }' full)" ]
    [ "$(cell kind 2)/$(cell name 2)/$(cell runner_up 2)/$(cell unassigned_share 2)" = unassigned/unassigned/n/a/1 ]
    [ "$(cell kind 3)/$(cell name 3)/$(cell error 3)" = "error/n/a/line 4: toward: is the origin itself, another point is needed" ]
    conus batch nested.nii.gz --poses poses.tsv --angle 40 --summary --threads 2 --block 1 >other || true
    diff other - <<<"$summary"
    sphere --size 32
    printf 'x\ty\tz\ttx\tty\ttz\n0\t0\t100\t0\t0\t0\n' >poses.tsv
    answers batch sphere.nii.gz --poses poses.tsv --summary -o summary.tsv
    grep -q '"runner_up"' summary.json
}

@test "rows of poses with one name have a row number; those of others are as they were" {
    sphere --size 32 --spacing 2,2,2
    local head='name\tx\ty\tz\ttx\tty\ttz\n' one='0\t0\t90\t0\t0\t0\n' two='0\t90\t0\t0\t0\t0\n'
    printf "${head}a\t${one}b\t${two}c\t0\t0\t0\t0\t0\t0\n" >differ.tsv
    printf "${head}a\t${one}a\t${two}a\t0\t0\t0\t0\t0\t0\n" >repeat.tsv
    run -1 conus batch sphere.nii.gz --poses differ.tsv -q -o differ.out.tsv
    run -1 conus batch sphere.nii.gz --poses repeat.tsv -q -o repeat.out.tsv
    [ "$(head -1 differ.out.tsv | cut -f 1-3)" = $'query\tkind\tindex' ]
    [ "$(cut -f 1,2 repeat.out.tsv | uniq | paste -sd' ')" = $'query\trow a\t1 a\t2 a\t3' ]
    cut -f 1,3- repeat.out.tsv | cut -f 2- | diff - <(cut -f 2- differ.out.tsv)
    grep -q '"row": {' repeat.out.json
    not grep -q '"row"' differ.out.json
    # query says the same in every format, and so do summaries, segments and clearances.
    local format
    for format in tsv csv ndjson; do
        run -1 conus query sphere.nii.gz --pose repeat.tsv -q --format $format -o query.out
        run -1 conus batch sphere.nii.gz --poses repeat.tsv -q --format $format --force -o batch.out.$format
        cmp query.out batch.out.$format
        rm query.out query.out.json
    done
    run -1 --separate-stderr conus query sphere.nii.gz --pose repeat.tsv --format json -q
    [ "$(jq -c '[.Queries[].row]' <<<"$output")" = '[1,2,3]' ]
    run -1 --separate-stderr conus query sphere.nii.gz --pose repeat.tsv -q
    [ "$(grep -o '^query a (row [123]): [a-z]*' <<<"$output" | paste -sd,)" = 'query a (row 1): cone,query a (row 2): cone,query a (row 3): no' ]
    run -1 --separate-stderr conus batch sphere.nii.gz --poses repeat.tsv --summary -q
    [ "$(cut -f 1-3 <<<"$output" | tail -1)" = $'a\t3\terror' ]
    run -1 --separate-stderr conus batch sphere.nii.gz --poses repeat.tsv --range 0,90 --segments - -q
    [ "$(cut -f 1-3 <<<"$output" | sed -n '1p;$p' | paste -sd' ')" = $'query\trow\torder a\t3\tn/a' ]
    # Shards count on, a file is read again, and another that is compared with it finds its rows.
    for i in 0 1; do run -1 conus batch sphere.nii.gz --poses repeat.tsv -q --shard $i/2 -o part.$i.tsv || true; done
    run -0 conus merge part.0.tsv part.1.tsv -o merged.tsv
    cmp merged.tsv repeat.out.tsv
    run -0 conus diff merged.tsv repeat.out.tsv
    run -0 conus verify repeat.out.tsv
}

@test "--keep carries the texts of columns to the rows, in every format, and is verified" {
    sphere --size 32 --spacing 2,2,2
    printf 'name,Group,note,x,y,z,tx,ty,tz\nM1,patient,"says ""hi"", then",0,0,90,0,0,0\nM2,,b,0,90,0,0,0,0\nM3,control,c,0,0,q,0,0,0\n' >kept.csv
    run -1 conus batch sphere.nii.gz --poses kept.csv -q --summary --keep group,note -o rows.csv
    cut -d, -f 1,14- rows.csv | tr -d '\r' | sed 's/M3,control/control/' | diff - <(printf '%s\n' 'query,group,note' \
        'M1,patient,"says ""hi"", then"' 'M2,n/a,b' 'control,c')
    [ "$(jq -r '.Kept | keys | join(",")' rows.json)" = group,note ]
    run -0 conus verify rows.csv
    local format
    for format in tsv csv ndjson; do
        run -1 conus query sphere.nii.gz --pose kept.csv -q --keep note,group --format $format --force -o one.$format
        run -1 conus batch sphere.nii.gz --poses kept.csv -q --keep note,group --format $format --force -o two.$format
        cmp one.$format two.$format
    done
    run -1 --separate-stderr conus query sphere.nii.gz --pose kept.csv -q --keep group
    grep -q '^query M1 (group patient): cone' <<<"$output"
    for i in 0 1 2; do run conus batch sphere.nii.gz --poses kept.csv -q --summary --keep group,note --shard $i/3 -o part.$i.csv; done
    run -0 conus merge part.0.csv part.1.csv part.2.csv -o merged.csv
    cmp merged.csv rows.csv
    # A column that is kept is not passed over.
    run -1 --separate-stderr conus query sphere.nii.gz --pose kept.csv --format tsv
    [[ "$stderr" == *'columns passed over: "Group", "note"'* ]]
    run -1 --separate-stderr conus query sphere.nii.gz --pose kept.csv --format tsv --keep note
    [[ "$stderr" == *'columns passed over: "Group"'$'\n'* ]]
    fails 3 'keep: no column is called "grup"; columns found: "name", "Group"' batch sphere.nii.gz --poses kept.csv --keep grup -q
    fails 2 'a column "name" cannot be kept' batch sphere.nii.gz --poses kept.csv --keep note,name -q
    fails 2 'cannot be kept: the answer has one itself, or it is named twice' query sphere.nii.gz --pose kept.csv --keep note,note -q
    fails 2 'a name is empty' query sphere.nii.gz --pose kept.csv --keep note, -q
    fails 2 'no place for it' query sphere.nii.gz --pose kept.csv --keep note --format afni -q
    printf '0 0 0 a\n' >points.txt
    fails 3 'only a table with a header has columns to be kept' batch sphere.nii.gz --poses points.txt --radius 1 --keep a -q
}

@test "times are in every row, with the row number; a pipe that names its rows has the number, too" {
    sphere --size 16
    printf 'x,y,z,tx,ty,tz,time_s\n0,0,90,0,0,0,0.5\n0,0,90,0,0,1,n/a\n' >timed.csv
    answers batch sphere.nii.gz --poses timed.csv --summary -q
    [ "$(cut -f 1-4 <<<"$output" | paste -sd' ')" = $'query\trow\ttime_s\tkind 1\t1\t0.5\tarea 2\t2\tn/a\tarea' ]
    answers query sphere.nii.gz --pose timed.csv -q
    has 'query 1 (row 1, 0.5 s): cone'
    answers sweep sphere.nii.gz --pose timed.csv -q --format tsv
    [ "$(cell time_s 1)" = 0.5 ]
    printf 'name,x,y,z,tx,ty,tz\na,0,0,90,0,0,0\nb,0,0,90,0,0,1\n' >named.csv
    [ "$(conus batch sphere.nii.gz --poses - --summary -q <named.csv | cut -f 1,2 | paste -sd' ')" = $'query\trow a\t1 b\t2' ]
    [ "$(conus batch sphere.nii.gz --poses named.csv --summary -q | cut -f 1,2 | paste -sd' ')" = $'query\tkind a\tarea b\tarea' ]
}

@test "a batch says what it asks: shape and rays, and that no angle was given" {
    setup_ball 3
    says() {
        local wanted=$1
        shift
        run -0 --separate-stderr conus batch sphere.nii.gz --poses poses.tsv --summary "$@"
        [ "$stderr" = "conus: note: poses.tsv: $wanted" ] || { echo "said: $stderr"; return 1; }
    }
    says 'cones of 10 degrees (--angle DEGREES is not given); 16 x 16 rays' --resolution 16
    says 'cones of 12 degrees; 8 x 8 rays' --angle 12 --resolution 8
    says 'square rods of half width 2 mm; 16 x 16 rays' --radius 2 --aperture square --resolution 16
    run -0 --separate-stderr conus batch sphere.nii.gz --poses poses.tsv --summary --angle 12 -q
    [ -z "$stderr" ]
    run -0 --separate-stderr conus batch sphere.nii.gz --poses poses.tsv --range 0,90 --segments -
    [ -z "$stderr" ]
    # Axes that end at targets may be needles.
    printf 'name,entry_x,entry_y,entry_z,target_x,target_y,target_z\nA,0,0,90,0,0,10\n' >needles.csv
    run -0 --separate-stderr conus batch sphere.nii.gz --poses needles.csv --summary
    [[ "$stderr" == *'cones of 10 degrees (--angle DEGREES or, for needles, --radius MM is not given); 64 x 64 rays' ]]
    run -0 --separate-stderr conus query sphere.nii.gz --pose needles.csv
    [ "$stderr" = 'conus: note: axes that end at a target are asked as cones of 10 degrees: --radius MM asks a needle of that width, --segments FILE all that the axis passes' ]
    for width in '--radius 1' '--angle 10' '--segments -' '-q'; do
        # shellcheck disable=SC2086 # words
        run -0 --separate-stderr conus query sphere.nii.gz --pose needles.csv $width
        [ -z "$stderr" ]
    done
}

@test "two outputs have two sidecars, and there is an atlas" {
    setup_ball 40
    fails 2 'ATLAS is missing' batch --poses poses.tsv
    fails 2 '--output and --segments have one sidecar, e.json' batch sphere.nii.gz --poses poses.tsv -o e.tsv \
        --segments e.csv
}

# example NAME: prints the code of docs/batch.md whose fence has that name.
example() {
    awk -v fence="\`\`\`sh $1" '$0 == fence { inside = 1; next } /^```/ { inside = 0 } inside' \
        "$BATS_TEST_DIRNAME/../../docs/batch.md"
}

# setup_example: makes the files that the examples of docs/batch.md name.
setup_example() {
    setup_ball 100
    mv sphere.nii.gz aal.nii.gz
    mv sphere.tsv aal.tsv
    conus batch aal.nii.gz --poses poses.tsv -o whole.tsv
    mkdir bin
    ln -s "$CONUS" bin/conus
    PATH=$PWD/bin:$PATH
}

@test "the example with GNU parallel" {
    command -v parallel >/dev/null || skip "no GNU parallel"
    setup_example
    example parallel >run.sh
    [ "$(wc -l <run.sh)" -eq 3 ]
    PARALLEL_HOME=$PWD bash -eu run.sh
    cmp whole.tsv rows.tsv
}

@test "the example of a Slurm array, task by task" {
    setup_example
    example sbatch >array.sh
    grep -q '^#SBATCH --array=0-7' array.sh
    for task in 0 1 2 3 4 5 6 7; do
        SLURM_ARRAY_TASK_ID=$task SLURM_ARRAY_TASK_COUNT=8 SLURM_ARRAY_TASK_MIN=0 SLURM_ARRAY_TASK_STEP=1 \
            bash -eu array.sh
    done
    conus merge rows.[0-7].tsv -o rows.tsv
    cmp whole.tsv rows.tsv
}
