#!/usr/bin/env bats
# conus batch, as a user types it.
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
    for part in 0/2 all/2; do
        run -2 --separate-stderr conus batch sphere.nii.gz --poses <(cat poses.tsv) --angle 12 -o other.tsv --shard $part
        check_message '--shard needs a file of poses, not a pipe'
        run -2 --separate-stderr conus batch sphere.nii.gz --poses -,unit=mm --angle 12 -o other.tsv --shard $part <poses.tsv
        check_message '--shard needs a file of poses, not standard input'
    done
    run -2 --separate-stderr conus batch sphere.nii.gz --poses <(cat poses.tsv) --angle 12 -o piped.tsv # nobody knows what came
    check_message 'piped.tsv: there is a file already; --force replaces it'
}

@test "a file that is there has the words behind its poses" {
    setup_ball 30
    conus batch sphere.nii.gz --poses poses.tsv,unit=mm --angle 12 -q -o rows.tsv || [ $? -eq 1 ]
    run -2 --separate-stderr conus batch sphere.nii.gz --poses poses.tsv,unit=cm --angle 12 -q -o rows.tsv
    check_message 'rows.tsv: there is a file already, of other poses, atlases, settings or another version; --force replaces it'
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
    run -1 --separate-stderr conus batch sphere.nii.gz --poses poses.tsv -o rows.tsv --quiet
    check_message 'poses.tsv: no answer to 2 of 4 poses'
    run -1 --separate-stderr conus batch sphere.nii.gz --poses poses.tsv --shard 1/2 -o part.tsv
    check_message 'no answer to 1 of 2 poses, the first in line 5: column x: "(null)" is not a finite number'
    run -1 --separate-stderr conus batch sphere.nii.gz --poses poses.tsv --shard all/2 -o part.tsv --quiet
    check_message "poses.tsv: no answer to 2 of 4 poses, $first"
    cmp part.tsv rows.tsv
    sed -i '2,3d;5d' poses.tsv
    answers batch sphere.nii.gz --poses poses.tsv -o fine.tsv
}

# same_but_words ONE OTHER: whether two sidecars say the same of rows that two command lines asked for.
same_but_words() {
    diff <(grep -Ev 'CommandLine|Checksum' "$1") <(grep -Ev 'CommandLine|Checksum' "$2")
}

# parts N FILE ARGUMENT...: the file of one run, answered in N parts by N processes, all but the last of them, and joined.
parts() {
    local count=$1 file=$2 i
    shift 2
    for ((i = 0; i < count - 1; i++)); do
        conus batch "$@" -q --shard "$i/$count" -o "$file" 2>said || [ $? -eq 1 ]
    done
    conus batch "$@" -q --shard "all/$count" -o "$file" 2>said || [ $? -eq 1 ]
}

# bats test_tags=main
@test "parts joined are the file of one run" {
    setup_ball 101
    for ending in tsv csv ndjson; do
        batch -o rows.$ending --force
        for count in 1 2 3 7; do
            parts $count joined.$ending sphere.nii.gz --poses poses.tsv --angle 12
            cmp rows.$ending joined.$ending
            same_but_words rows*.json joined*.json
            conus verify joined.$ending
            rm joined.*
        done
        rm rows*.json
    done
    batch --shard 0/1 | cmp - rows.tsv # standard output has no parts to be joined
    batch --shard 0/3 | cmp - <(head -n "$(batch --shard 0/3 | wc -l)" rows.tsv)
}

@test "a part is a whole file, named by its number and verified by itself" {
    setup_ball 101
    batch -q --shard 3/12 -o rows.tsv
    batch -q --shard 03/12 -o rows.tsv
    batch -q --shard 4/10 -o rows --format tsv
    batch -q --shard 3/12 -o some.rows.ndjson
    nothing_left sphere.nii.gz sphere.tsv sphere.json poses.tsv rows.03-of-12.tsv rows.03-of-12.json \
        rows.4-of-10 rows.4-of-10.json some.rows.03-of-12.ndjson some.rows.03-of-12.ndjson.json
    [ "$(head -1 rows.03-of-12.tsv)" = "$(batch -q | head -1)" ]
    [ "$(jq -c '[.Batch.shard, .Batch.first, .Batch.poses]' rows.03-of-12.json)" = '[[3,12],27,9]' ]
    conus verify rows.03-of-12.tsv
    conus cite rows.03-of-12.tsv
    run -0 conus diff rows.03-of-12.tsv rows.03-of-12.tsv
    conus batch sphere.nii.gz --poses poses.tsv --angle 12 -o words.tsv --shard=3/012 -q
    grep -q -- '--shard=3/12' words.03-of-12.json
    batch -q --shard all/12 -o rows.tsv
    nothing_left sphere.nii.gz sphere.tsv sphere.json poses.tsv rows.tsv rows.json rows.4-of-10 rows.4-of-10.json \
        some.rows.03-of-12.ndjson some.rows.03-of-12.ndjson.json words.03-of-12.tsv words.03-of-12.json
}

@test "more parts than poses: some are empty, and join all the same" {
    setup_ball 2
    batch -o rows.tsv
    batch --shard 2/3 -o joined.tsv
    [ "$(wc -l <joined.2-of-3.tsv)" -eq 1 ]
    parts 3 joined.tsv sphere.nii.gz --poses poses.tsv --angle 12
    cmp rows.tsv joined.tsv
    same_but_words rows.json joined.json
}

# The warnings, the notes and the region of a question are those of all poses, whichever process answered them.
@test "what is said of the poses, and recorded, is that of one run" {
    setup_ball 1
    { printf 'x\ty\tz\ttx\tty\ttz\n'
      for i in 1 2 3 4 5 6 7 8; do printf '0\t0\t%d\t0\t0\t900\n' $((90 + i)); done # away from the ball
      printf '0\t0\t5\t0\t0\t90\n0\t0\t90\t0\t0\t0\n'
      printf 'q\t0\t90\t0\t0\t0\n'; } >poses.tsv # no pose
    run -1 --separate-stderr conus batch sphere.nii.gz --poses poses.tsv --angle 12 -o rows.tsv
    whole=$stderr
    grep -q '8 of 10 cones point away from the atlas, the first in line 2' <<<"$whole"
    [ "$(jq '.Warnings | length' rows.json)" -eq 1 ]
    for count in 2 5; do
        for ((i = 0; i < count; i += 2)); do
            run conus batch sphere.nii.gz --poses poses.tsv --angle 12 -o joined.tsv --shard $i/$count
        done
        run -1 --separate-stderr conus batch sphere.nii.gz --poses poses.tsv --angle 12 -o joined.tsv --shard all/$count
        grep -v 'parts are there already' <<<"$stderr" | sed 's/, the first in line 12.*//' |
            diff - <(sed 's/, the first in line 12.*//' <<<"$whole")
        cmp rows.tsv joined.tsv
        same_but_words rows.json joined.json
        run -0 conus verify joined.tsv
        rm joined.*
    done
}

@test "what is no part of this batch is refused by its name, and nothing is joined" {
    setup_ball 20
    for i in 0 1 2; do
        batch --shard "$i/3" -o rows.tsv
    done
    mkdir good
    cp rows.* good
    refused() { # TEXT: what is said of it; and nothing has changed
        fails 3 "$1" batch sphere.nii.gz --poses poses.tsv --angle 12 -q -o rows.tsv --shard all/3
        [ ! -e rows.tsv ] && [ ! -e rows.json ]
        cp good/* .
    }
    conus batch sphere.nii.gz --poses poses.tsv --angle 12 --resolution 8 -q --force --shard 1/3 -o rows.tsv
    refused 'rows.1-of-3.tsv: there is a file already, of other poses, atlases, settings or another version'
    cp rows.1-of-3.tsv rows.2-of-3.tsv
    cp rows.1-of-3.json rows.2-of-3.json
    refused 'rows.2-of-3.tsv: there is a file already, which is part 1/3 and not 2/3'
    sed -i '$s/unassigned/Unassigned/' rows.2-of-3.tsv
    refused 'rows.2-of-3.tsv: there is a file already, which is not the one that rows.2-of-3.json describes'
    truncate -s -10 rows.0-of-3.tsv
    refused 'rows.0-of-3.tsv: there is a file already, which is not the one that rows.0-of-3.json describes'
    sed -i 's/"errors": 0/"errors": 1/' rows.1-of-3.json
    refused 'rows.1-of-3.tsv: there is a file already; --force replaces it'
    rm rows.1-of-3.json
    refused 'rows.1-of-3.tsv: there is a file already; --force replaces it'
    echo '{}' >rows.1-of-3.json
    fails 2 'rows.1-of-3.json: there is a file that is no sidecar' batch sphere.nii.gz --poses poses.tsv --angle 12 -q \
        -o rows.tsv --shard all/3
    rm rows.1-of-3.json
    mkfifo rows.1-of-3.json
    fails 3 'rows.1-of-3.json: cannot write: is a device or pipe' batch sphere.nii.gz --poses poses.tsv --angle 12 -q \
        -o rows.tsv --shard all/3
    rm rows.1-of-3.json
    cp poses.tsv rows.1-of-3.tsv
    fails 2 'would overwrite the input rows.1-of-3.tsv' batch sphere.nii.gz --poses rows.1-of-3.tsv --angle 12 -q -o rows.tsv \
        --shard all/3 --force
    cp good/* .
    touch rows.0-of-03.tsv.x rows.-of-4.tsv rows.1-of-.tsv row.1-of-4.tsv rows.1-of-4.csv # are no parts
    batch --shard 3/12 -o rows.tsv
    fails 3 'rows.03-of-12.tsv: is one of 12 parts, not of 3; --shard all/12 joins them, --force leaves them alone' \
        batch sphere.nii.gz --poses poses.tsv --angle 12 -q -o rows.tsv --shard all/3
    mkdir elsewhere
    cp rows.03-of-12.* elsewhere
    fails 3 'elsewhere/rows.03-of-12.tsv: is one of 12 parts' \
        batch sphere.nii.gz --poses poses.tsv --angle 12 -q -o elsewhere/rows.tsv --shard all/3
    rm -r elsewhere rows.03-of-12.* rows.0-of-03.tsv.x rows.-of-4.tsv rows.1-of-.tsv row.1-of-4.tsv rows.1-of-4.csv
    rm rows.1-of-3.* # one that is missing is answered
    batch -q --shard all/3 -o rows.tsv
    batch -q -o whole.tsv
    cmp whole.tsv rows.tsv
    cp good/rows.1-of-3.* . # parts that an earlier run left when it was killed
    cp good/rows.0-of-3.json .
    batch -q --shard all/3 -o rows.tsv
    nothing_left sphere.nii.gz sphere.tsv sphere.json poses.tsv rows.tsv rows.json whole.tsv whole.json \
        good/rows.{0,1,2}-of-3.tsv good/rows.{0,1,2}-of-3.json
    fails 2 'rows.tsv: there is a file already, of other' batch sphere.nii.gz --poses poses.tsv --angle 9 -q -o rows.tsv --shard all/3
    answers batch sphere.nii.gz --poses poses.tsv --angle 9 -q -o rows.tsv --shard all/3 --force
}

# source WANTED VARIABLE=VALUE...: the part that --shard auto finds in an environment with these variables.
source_of() {
    local wanted=$1
    shift
    run -0 --separate-stderr env -u SLURM_PROCID -u SLURM_STEP_ID -u SLURM_STEP_NUM_TASKS "$@" "$CONUS" batch sphere.nii.gz \
        --poses poses.tsv --angle 12 -o auto.tsv --force --shard auto
    [[ "$stderr" == *"conus: note: --shard $wanted, from "* ]] || { echo "said: $stderr"; return 1; }
    local files=(auto*.tsv)
    [[ "$wanted" == 0/1 && "${files[0]}" == auto.tsv ||
        "${files[0]}" =~ ^auto\.0*${wanted%/*}-of-${wanted#*/}\.tsv$ ]] || { ls; return 1; }
    grep -q -- "--shard $wanted\"" auto*.json
    rm auto.*
}

# no_source TEXT VARIABLE=VALUE...: --shard auto is refused, with this text.
no_source() {
    local text=$1
    shift
    run -2 --separate-stderr env "$@" "$CONUS" batch sphere.nii.gz --poses poses.tsv --angle 12 -o auto.tsv --shard auto
    check_message "$text"
}

@test "--shard auto: each way by which a process is told its number, and of how many" {
    setup_ball 20
    slurm_array=(SLURM_ARRAY_TASK_ID=14 SLURM_ARRAY_TASK_MIN=10 SLURM_ARRAY_TASK_MAX=16 SLURM_ARRAY_TASK_STEP=2 SLURM_ARRAY_TASK_COUNT=4)
    sge_array=(SGE_TASK_ID=4 SGE_TASK_FIRST=1 SGE_TASK_LAST=9 SGE_TASK_STEPSIZE=3)
    source_of 2/5 OMPI_COMM_WORLD_RANK=2 OMPI_COMM_WORLD_SIZE=5 PMIX_RANK=2 SLURM_PROCID=0 SLURM_STEP_ID=0 SLURM_STEP_NUM_TASKS=1
    source_of 3/4 PMI_RANK=3 PMI_SIZE=4
    source_of 0/4 MV2_COMM_WORLD_RANK=0 MV2_COMM_WORLD_SIZE=4
    source_of 1/2 FLUX_TASK_RANK=1 FLUX_JOB_SIZE=2
    source_of 1/3 SLURM_PROCID=1 SLURM_STEP_NUM_TASKS=3 SLURM_STEP_ID=0 SLURM_NTASKS=8
    source_of 0/1 SLURM_PROCID=0 SLURM_STEP_NUM_TASKS=1 SLURM_STEP_ID=0
    source_of 2/4 "${slurm_array[@]}"
    source_of 2/4 "${slurm_array[@]}" SLURM_PROCID=0 SLURM_NTASKS=8 # a script without srun
    source_of 1/3 "${sge_array[@]}"
    source_of 6/8 LSB_JOBINDEX=7 LSB_JOBINDEX_END=8
    source_of 7/12 "${slurm_array[@]}" PMI_RANK=1 PMI_SIZE=3 # ranks in an array: 2 * 3 + 1
    source_of 8/12 "${slurm_array[@]}" SLURM_PROCID=2 SLURM_STEP_NUM_TASKS=3 SLURM_STEP_ID=0
    source_of 2/4 "${slurm_array[@]}" SGE_TASK_ID=undefined LSB_JOBINDEX=0
    no_source 'the environment does not say which part this process is' SLURM_PROCID=0 SLURM_NTASKS=8
    no_source 'the environment does not say which part this process is' -u SLURM_STEP_ID SLURM_PROCID=0 SLURM_STEP_NUM_TASKS=1
    no_source 'the environment does not say which part this process is' SGE_TASK_ID=undefined
    no_source 'SLURM_ARRAY_TASK_ID=3 is not one of a whole range of numbers' SLURM_ARRAY_TASK_ID=3 SLURM_ARRAY_TASK_MIN=3 \
        SLURM_ARRAY_TASK_MAX=5 SLURM_ARRAY_TASK_STEP=1 SLURM_ARRAY_TASK_COUNT=2
    no_source 'SLURM_ARRAY_TASK_ID=15 is not one' "${slurm_array[@]}" SLURM_ARRAY_TASK_ID=15
    no_source 'SLURM_ARRAY_TASK_ID=18 is not one' "${slurm_array[@]}" SLURM_ARRAY_TASK_ID=18
    no_source 'PMI_RANK=4 is not one' PMI_RANK=4 PMI_SIZE=4
    no_source 'PMI_RANK=-1 is not one' PMI_RANK=-1 PMI_SIZE=4
    no_source 'PBS_ARRAY_INDEX=3 does not say of how many; --shard "$((PBS_ARRAY_INDEX - 1))/N" does' PBS_ARRAY_INDEX=3
    no_source 'PBS_ARRAYID=3 does not say' PBS_ARRAYID=3 PMI_RANK=1 PMI_SIZE=4
    no_source 'PMIX_RANK=3 does not say of how many; --shard "$PMIX_RANK/N" does' PMIX_RANK=3
    # Without --shard each task of an array answers everything, which is said.
    run -0 --separate-stderr env "${slurm_array[@]}" "$CONUS" batch sphere.nii.gz --poses poses.tsv --angle 12 -o all.tsv
    [[ "$stderr" == *'note: in an array of jobs (SLURM_ARRAY_TASK_ID=14); --shard auto divides the poses'* ]]
    run -0 --separate-stderr env PBS_ARRAYID=1 "$CONUS" batch sphere.nii.gz --poses poses.tsv --angle 12 -o all.tsv
    [[ "$stderr" == *'note: in an array of jobs (PBS_ARRAYID=1); --shard I/N divides the poses'* ]]
}

@test "ranks of mpirun answer a part each" {
    command -v mpirun >/dev/null || skip "no mpirun"
    setup_ball 101
    batch -q -o whole.tsv
    mpirun --oversubscribe --allow-run-as-root -n 3 "$CONUS" batch sphere.nii.gz --poses poses.tsv --angle 12 -q --threads 1 \
        --shard auto -o rows.tsv 3>&-
    batch --shard all/3 -o rows.tsv 2>said
    grep -q 'rows.tsv: 3 of 3 parts are there already' said
    cmp whole.tsv rows.tsv
}

@test "mistakes in --shard, --threads, --block and the outputs are reported" {
    setup_ball 3
    fails 2 '--shard: "4/4" is not I/N' batch sphere.nii.gz --poses poses.tsv --shard 4/4
    fails 2 '--shard: "1" is not I/N' batch sphere.nii.gz --poses poses.tsv --shard 1
    fails 2 '--shard: "-1/2" is not I/N' batch sphere.nii.gz --poses poses.tsv --shard=-1/2
    fails 2 '--shard needs a file of poses' batch sphere.nii.gz --poses - --shard 0/2
    fails 2 '--threads' batch sphere.nii.gz --poses poses.tsv --threads 0
    fails 2 '--block' batch sphere.nii.gz --poses poses.tsv --block 100000
    fails 2 '--poses FILE is missing' batch sphere.nii.gz
    fails 2 '--shard all/N needs a file for --output' batch sphere.nii.gz --poses poses.tsv --shard all/3
    fails 2 '--shard all/N needs a file for --output' batch sphere.nii.gz --poses poses.tsv --shard all/3 -o -
    fails 2 '--shard: "all" is not I/N' batch sphere.nii.gz --poses poses.tsv --shard all -o rows.tsv
    fails 2 '--shard: "all/0" is not I/N' batch sphere.nii.gz --poses poses.tsv --shard all/0 -o rows.tsv
    fails 2 '--shard: 1000001 parts, allowed are 1000000' batch sphere.nii.gz --poses poses.tsv --shard 1/1000001 -o rows.tsv
    fails 2 '--force has no effect without a file for --output' batch sphere.nii.gz --poses poses.tsv --force -o -
    fails 2 'would overwrite the input' batch sphere.nii.gz --poses poses.tsv --format tsv -o sphere.nii.gz --force
    fails 2 'would overwrite the input' batch sphere.nii.gz --poses poses.tsv -o poses.tsv --force
    fails 3 'none.tsv' batch sphere.nii.gz --poses none.tsv
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
        fails 3 "$name.tsv: cannot write: $kind" batch sphere.nii.gz --poses poses.tsv -o $name.tsv --shard all/2 --force
    done
    fails 3 'rows.json: cannot write: is a device or pipe' batch sphere.nii.gz --poses poses.tsv -o rows.tsv --force
    mkfifo rows.1-of-2.json
    fails 3 'rows.1-of-2.json: cannot write: is a device or pipe' batch sphere.nii.gz --poses poses.tsv -o rows.tsv --shard 1/2
    rm rows.1-of-2.json
    [ -p pipe.tsv ] && [ -d folder.tsv ] && [ -L link.tsv ] && [ -p rows.json ]
    nothing_left sphere.nii.gz sphere.tsv sphere.json poses.tsv whole.tsv whole.json
}

# bats test_tags=main
@test "nothing is overwritten without --force; what is there with the same question is left, and said" {
    setup_ball 5
    batch -o rows.tsv
    local before=$(hash_of rows.tsv) sidecar=$(hash_of rows.json)
    run -0 --separate-stderr conus batch sphere.nii.gz --poses poses.tsv --angle 12 --threads 3 -o rows.tsv
    [[ "$stderr" == *'conus: note: rows.tsv: is there already, with these answers' ]]
    [ "$(hash_of rows.tsv)/$(hash_of rows.json)" = "$before/$sidecar" ]
    fails 2 'rows.tsv: there is a file already, of other poses, atlases, settings or another version; --force replaces it' \
        batch sphere.nii.gz --poses poses.tsv -q -o rows.tsv
    [ "$(hash_of rows.tsv)" = "$before" ]
    answers batch sphere.nii.gz --poses poses.tsv -o rows.tsv --force
    [ "$(hash_of rows.tsv)" != "$before" ]
    rm rows.tsv # a sidecar that is left, of this question or another
    answers batch sphere.nii.gz --poses poses.tsv -o rows.tsv
    rm rows.tsv
    fails 2 'rows.json: there is a file already, of other' batch sphere.nii.gz --poses poses.tsv --angle 7 -q -o rows.tsv
    rm rows.json
    echo mine >rows.tsv
    fails 2 'rows.tsv: there is a file already; --force replaces it' batch sphere.nii.gz --poses poses.tsv -q -o rows.tsv
    [ "$(cat rows.tsv)" = mine ]
}

@test "a file that has lost its end is not taken as finished" {
    setup_ball 5
    batch -o rows.tsv
    truncate -s -10 rows.tsv
    fails 2 'rows.tsv: there is a file already, which is not the one that rows.json describes' \
        batch sphere.nii.gz --poses poses.tsv --angle 12 -q -o rows.tsv
}

# in_parts FILE I: answers the poses in seven parts in the background, as process $child, until part I is there.
in_parts() {
    background "$CONUS" batch sphere.nii.gz --poses poses.tsv --angle 12 -q --threads 1 -o "$1" --shard all/7
    while runs "$child" && [ ! -e "${1%.tsv}.$2-of-7.tsv" ]; do
        read -rt 0.01 -u "$never" || true
    done
}

# bats test_tags=main
@test "killed and asked again until it is done: the file of one run, and nothing else" {
    setup_ball 20000
    batch -o rows.tsv
    for part in "" 1/3; do # one file and one part: nothing is left
        hold_batch -o killed.tsv ${part:+--shard $part}
        wait_for_block
        stop_held KILL 137
        rm -f progress said
        nothing_left sphere.nii.gz sphere.tsv sphere.json poses.tsv rows.tsv rows.json filled
    done
    for whole in 1 2 3; do # each time one part more is there
        in_parts killed.tsv "$whole"
        kill -KILL "$child" || true
        wait "$child" || true
        [ ! -e killed.tsv ] || break # it was too quick
    done
    fails 3 'killed.0-of-7.tsv: there is a file already, of other' batch sphere.nii.gz --poses poses.tsv --angle 13 -q -o killed.tsv --shard all/7
    batch --threads 3 -q -o killed.tsv --shard all/7
    cmp rows.tsv killed.tsv
    same_but_words rows.json killed.json
    rm -f progress said
    nothing_left sphere.nii.gz sphere.tsv sphere.json poses.tsv rows.tsv rows.json killed.tsv killed.json filled
}

@test "poses that change while they are answered: an error, and nothing is left" {
    setup_ball 20000
    batch -o rows.tsv
    cp poses.tsv old.tsv
    for part in "" all/3; do
        hold_batch --threads 1 -o changed.tsv ${part:+--shard $part}
        wait_for_block
        sed 's/^[0-9-]/1/' old.tsv >poses.tsv # the same file, with other bytes
        let_go 3
        grep -q 'conus: poses.tsv: changed while it was read' said
        [ ! -e changed.tsv ] && [ ! -e changed.json ] && [ ! -e changed.0-of-3.tsv ]
        cp old.tsv poses.tsv
    done
    batch -o changed.tsv --shard all/3
    cmp rows.tsv changed.tsv
}

@test "leftovers of other processes do no harm" {
    setup_ball 5
    batch -o rows.tsv
    # Partial files under the names of older versions, rows.json.PID.part, of the next processes.
    local next=$(sh -c 'echo $$')
    for pid in $(seq "$next" $((next + 300))); do
        echo left >"rows.json.$pid.part"
        echo left >"rows.tsv.$pid.part"
    done
    answers batch sphere.nii.gz --poses poses.tsv --angle 12 -o rows.tsv --force
    answers batch sphere.nii.gz --poses poses.tsv --angle 12 -o rows.tsv --shard all/3 --force
}

@test "a file that is there is known by all that decides the answers: coordinate system, label table" {
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
    ask -o rows.tsv
    grep -q "\"coordsystem_file_sha256\": \"$(sha256sum sub-1_coordsystem.json | cut -d ' ' -f 1)\"" rows.json
    system cm
    run -2 --separate-stderr ask -o rows.tsv
    check_message 'rows.tsv: there is a file already'
    system mm
    ask -o rows.tsv
    mv sub-1_coordsystem.json away
    run -2 ask -o rows.tsv
    mv away sub-1_coordsystem.json
    sed -i 's/Sphere/Ball/' sphere.tsv
    run -2 ask -o rows.tsv
    sed -i 's/Ball/Sphere/' sphere.tsv
    ask -o rows.tsv
    fails 2 'would overwrite the input sub-1_coordsystem.json' \
        batch sphere.nii.gz,template=none --poses sub-1_electrodes.tsv --radius 3 --quiet -o sub-1_coordsystem.tsv --force
    for command in "query --pose" "sweep --angle 5 --pose"; do
        # shellcheck disable=SC2086 # words
        fails 2 'would overwrite the input sub-1_coordsystem.json' \
            $command sub-1_electrodes.tsv sphere.nii.gz,template=none --along-shafts --quiet --format tsv -o sub-1_coordsystem.tsv
    done
}

# bats test_tags=main
@test "a full disk: a message, and nothing is left" {
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
    nothing_left sphere.nii.gz sphere.tsv sphere.json poses.tsv rows.tsv rows.json
    batch -o full.tsv
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

@test "SIGINT and SIGTERM finish the block and say how many poses are kept in whole parts" {
    setup_ball 20000
    batch -o rows.tsv
    hold_batch -o stopped.tsv
    wait_for_block
    stop_held INT 130
    grep -q 'conus: interrupted after 100 poses, of which nothing is kept; --shard all/N keeps whole parts' said
    [ ! -e stopped.tsv ] && [ ! -e stopped.json ]
    in_parts stopped.tsv 1 2>said
    kill -TERM "$child"
    wait "$child" || [ $? -eq 143 ]
    if [ ! -e stopped.tsv ]; then
        local kept=$(jq -s 'map(.Batch.poses) | add' stopped.*.json)
        grep -q "conus: interrupted after [0-9]* poses, $kept of them in whole parts; the same command goes on" said
    fi
    batch -o stopped.tsv --shard all/7
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
    : >piped.tsv # of the one before, which would be counted until this one begins
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

@test "two processes of one part: its bytes are those of either" {
    setup_ball 2000
    hold_batch -o rows.tsv --shard 1/2
    wait_for_block
    batch -q -o rows.tsv --shard 1/2
    cp rows.1-of-2.tsv first.tsv
    let_go 0
    cmp first.tsv rows.1-of-2.tsv
    conus verify rows.1-of-2.tsv
    batch -q -o rows.tsv --shard all/2
    hold_batch -o again.tsv --shard all/3
    wait_for_block
    batch -q -o again.tsv --shard all/3
    let_go 0
    cmp rows.tsv again.tsv
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
    # Parts count on, a file is read again, and another that is compared with it finds its rows.
    parts 2 joined.tsv sphere.nii.gz --poses repeat.tsv
    cmp joined.tsv repeat.out.tsv
    run -0 conus diff joined.tsv repeat.out.tsv
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
    parts 3 joined.csv sphere.nii.gz --poses kept.csv --summary --keep group,note
    cmp joined.csv rows.csv
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

@test "a batch says what it asks: shape and rays, and that the angle is the default" {
    setup_ball 3
    says() {
        local wanted=$1
        shift
        run -0 --separate-stderr conus batch sphere.nii.gz --poses poses.tsv --summary "$@"
        [ "$stderr" = "conus: note: poses.tsv: $wanted" ] || { echo "said: $stderr"; return 1; }
    }
    says 'cones of 10 degrees (the default; --angle DEGREES changes it); 16 x 16 rays' --resolution 16
    says 'cones of 12 degrees; 8 x 8 rays' --angle 12 --resolution 8
    says 'square rods of half width 2 mm; 16 x 16 rays' --radius 2 --aperture square --resolution 16
    run -0 --separate-stderr conus batch sphere.nii.gz --poses poses.tsv --summary --angle 12 -q
    [ -z "$stderr" ]
    run -0 --separate-stderr conus batch sphere.nii.gz --poses poses.tsv --range 0,90 --segments -
    [ -z "$stderr" ]
    # Axes that end at targets may be needles.
    printf 'name,entry_x,entry_y,entry_z,target_x,target_y,target_z\nA,0,0,90,0,0,10\n' >needles.csv
    run -0 --separate-stderr conus batch sphere.nii.gz --poses needles.csv --summary
    [[ "$stderr" == *'cones of 10 degrees (the default; --angle DEGREES or, for needles, --radius MM changes it); 64 x 64 rays' ]]
    run -0 --separate-stderr conus query sphere.nii.gz --pose needles.csv
    [ "$stderr" = 'conus: note: axes that end at a target or a depth are asked as cones of 10 degrees: --radius MM --layers all asks what a needle of that width passes, --segments FILE what the axis passes, in order' ]
    run -0 --separate-stderr conus query sphere.nii.gz --pose needles.csv --radius 1
    [ "$stderr" = 'conus: note: needles are asked for what they meet first: --layers all asks what they pass, --segments FILE what the axis passes, in order' ]
    # A depth is an end as a target is: the shank of a probe is no cone either.
    printf 'name,x,y,z,dx,dy,dz,depth\nA,0,0,60,0,0,-1,40\n' >shank.csv
    run -0 --separate-stderr conus query sphere.nii.gz --pose shank.csv
    [[ "$stderr" == *'conus: note: axes that end at a target or a depth are asked as cones of 10 degrees: '* ]]
    run -0 --separate-stderr conus query sphere.nii.gz --pose needles.csv --segments -
    [[ "$stderr" == 'conus: note: 1 axis begins outside of the atlas'* ]]
    for width in '--radius 1 --layers all' '--angle 12' '-q'; do
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

# example NAME [LANGUAGE]: prints the code of docs/batch.md whose fence has that name.
example() {
    awk -v fence="\`\`\`${2-sh} $1" '$0 == fence { inside = 1; next } /^```/ { inside = 0 } inside' \
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

# run_example NAME LINES: runs that example, which has as many lines, and then the last line of all.
run_example() {
    example "$1" >run.sh
    [ "$(wc -l <run.sh)" -eq "$2" ]
    PARALLEL_HOME=$PWD bash -eu run.sh
    joined_example
}

joined_example() {
    example last >last.sh
    [ "$(wc -l <last.sh)" -eq 1 ]
    bash -eu last.sh 2>said
    grep -q 'rows.tsv: 16 of 16 parts are there already' said
    cmp whole.tsv rows.tsv
}

@test "the example with GNU parallel" {
    command -v parallel >/dev/null || skip "no GNU parallel"
    setup_example
    run_example parallel 1
}

@test "the example with make" {
    command -v make >/dev/null || skip "no make"
    setup_example
    example make >Makefile
    make -j2 parts 3>&-
    [ -z "$(make -s parts)" ]
    joined_example
}

@test "the example with mpirun" {
    command -v mpirun >/dev/null || skip "no mpirun"
    setup_example
    export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1
    run_example mpirun 1 3>&-
}

@test "the example of a Slurm array, task by task" {
    setup_example
    example sbatch >array.sh
    grep -q '^#SBATCH --array=0-15' array.sh
    for task in {0..15}; do
        SLURM_ARRAY_TASK_ID=$task SLURM_ARRAY_TASK_COUNT=16 SLURM_ARRAY_TASK_MIN=0 SLURM_ARRAY_TASK_MAX=15 \
            SLURM_ARRAY_TASK_STEP=1 bash -eu array.sh
    done
    joined_example
}

@test "the example with Snakemake" {
    need_long
    command -v snakemake >/dev/null || skip "no snakemake"
    setup_example
    example snakemake >Snakefile
    snakemake --cores 2 --quiet 3>&-
    joined_example
}

# by_function NAME MODULE CODE: has the line of docs/batch.md for NAME, behind CODE, call the function there.
by_function() {
    need_long
    local python=${CONUS_ENGINES_PYTHON:-/usr/bin/python3}
    "$python" -c "import $2" || skip "no $2"
    setup_example
    { example part python
      echo "if __name__ == '__main__':"
      printf '    %s\n' "$3" "$(sed -n "s/ *# $1.*//p; /$1/p" "$BATS_TEST_DIRNAME/../../docs/batch.md" | grep -m 1 '(part')"
    } >run.py
    cat run.py
    "$python" run.py 3>&-
    joined_example
}

@test "the example with Dask" {
    by_function Dask distributed 'import distributed; client = distributed.Client(n_workers=2, threads_per_worker=1, dashboard_address=None)'
}

@test "the example with joblib" {
    by_function joblib joblib 'import joblib'
}
