#!/usr/bin/env bats
# conus-mpi batch against conus batch.
load helpers

# OpenMPI does not free memory of parts that it unloads, for which LeakSanitizer would end it with another code.
export ASAN_OPTIONS=detect_leaks=0
mpi=(mpirun --oversubscribe --allow-run-as-root)

# ranks N ARGUMENT...: conus-mpi batch on N ranks.
ranks() {
    local count=$1
    shift
    "${mpi[@]}" -n "$count" "$CONUS_MPI" batch "$@" 3>&-
}

# setup_poses [N]: a ball, and N poses (700 unless given).
setup_poses() {
    command -v mpirun >/dev/null || skip "no mpirun"
    sphere --size 32 --spacing 2,2,2
    awk -v count="${1:-700}" 'BEGIN {
        print "x\ty\tz\ttx\tty\ttz"
        for (i = 0; i < count; i++)
            printf "%.3f\t%.3f\t%.3f\t%.3f\t%.3f\t0\n", 90 * cos(i), 90 * sin(i), i % 60 - 30, i % 3 * 15, i % 7
    }' >poses.tsv
}

@test "one SHA-256 for any number of ranks" {
    setup_poses
    conus batch sphere.nii.gz --poses poses.tsv -o rows.tsv
    for n in 1 2 4; do
        ranks "$n" sphere.nii.gz --poses poses.tsv --block 8 -o "ranks$n.tsv"
        cmp rows.tsv "ranks$n.tsv"
        [ ! -e "ranks$n.tsv.part" ]
    done
    diff <(grep -Ev 'CommandLine|Checksum' rows.json) <(grep -Ev 'CommandLine|Checksum' ranks4.json)
    ranks 2 sphere.nii.gz --poses poses.tsv --threads 2 --block 44 -o threads.ndjson
    conus batch sphere.nii.gz --poses poses.tsv --format ndjson | cmp - threads.ndjson
}

@test "the name of an installed atlas" {
    setup_poses 20
    mkdir own
    cp sphere.nii.gz own/ball_atlas.nii.gz
    cp sphere.tsv own/ball_atlas.tsv
    export CONUS_ATLAS_PATH=$PWD/own
    conus batch sphere.nii.gz --poses poses.tsv -o rows.tsv
    ranks 2 ball_atlas --poses poses.tsv -o ranks.tsv
    cmp rows.tsv ranks.tsv
}

@test "error rows and exit codes are those of conus batch" {
    setup_poses
    printf '1\t1\tx\t4\t5\t6\n' >>poses.tsv
    printf '1\t1\ty\t4\t5\t6\n' >>poses.tsv # another one behind it, which a rank may reach first
    conus batch sphere.nii.gz --poses poses.tsv -o rows.tsv 2>alone || [ $? -eq 1 ]
    grep -q 'no answer to 2 of .* poses, the first in line .*"x"' alone
    for n in 2 3; do
        ranks $n sphere.nii.gz --poses poses.tsv --block 1 -o ranks.tsv --force 2>said && return 1 || [ $? -eq 1 ]
        cmp rows.tsv ranks.tsv
        diff alone <(grep '^conus: ' said)
    done
}

@test "several atlases: the file of conus batch, and what it says" {
    setup_poses 300
    printf '1\t1\tx\t4\t5\t6\n' >>poses.tsv
    conus phantom slabs -o . --size 16
    mkdir own
    cp slabs.nii.gz slabs.tsv own
    export CONUS_ATLAS_PATH=$PWD/own
    both=(sphere.nii.gz --atlas slabs --atlas slabs.nii.gz --poses poses.tsv)
    conus batch "${both[@]}" -o rows.tsv 2>said || [ $? -eq 1 ]
    for n in 1 3; do
        ranks "$n" "${both[@]}" --block 2 -o "ranks$n.tsv" 2>"ranks$n" && return 1 || [ $? -eq 1 ]
        cmp rows.tsv "ranks$n.tsv"
        diff <(grep '^conus: ' said) <(grep '^conus: ' "ranks$n")
    done
    diff <(grep -Ev 'CommandLine|Checksum' rows.json) <(grep -Ev 'CommandLine|Checksum' ranks3.json)
    [ "$(cut -f 2 rows.tsv | sort -u | tr '\n' ' ')" = "atlas slabs slabs-2 sphere " ]
    ranks 2 "${both[@]}" --verbose -o verbose.tsv 2>loud && return 1 || [ $? -eq 1 ]
    grep -q 'conus: atlas: [0-9]* bytes, in memory once' loud
}

@test "all ranks hide the same" {
    setup_poses 60
    conus phantom nested -o .
    conus batch nested.nii.gz --hide 'Shell outer' --poses poses.tsv -o rows.tsv
    ranks 3 nested.nii.gz --hide 'Shell outer' --poses poses.tsv --block 8 -o ranks.tsv
    cmp rows.tsv ranks.tsv
    not grep -q 'Shell outer' ranks.tsv
    diff <(grep -Ev 'CommandLine|Checksum' rows.json) <(grep -Ev 'CommandLine|Checksum' ranks.json)
}

# Two early and two late poses are in different parts: with --block 1 a part has 16 poses, and the ranks share them.
@test "poses that lie or look where they hardly should are told of once, as conus batch does" {
    setup_poses 120
    printf '0\t0\t5\t0\t0\t90\n0\t0\t90\t0\t0\t180\n' >>poses.tsv
    sed -i '30i 0\t0\t4\t0\t0\t90\n0\t0\t91\t0\t0\t180' poses.tsv
    conus batch sphere.nii.gz --poses poses.tsv --angle 4 -o rows.tsv 2>wanted
    [ "$(grep -c . wanted)" -eq 3 ]
    grep -q 'poses.tsv: 2 of 124 devices lie inside an area, the first in line 30, inside Sphere' wanted
    for n in 1 3; do
        ranks "$n" sphere.nii.gz --poses poses.tsv --angle 4 --block 1 -o ranks.tsv --force 2>said
        diff wanted said
    done
    ranks 2 sphere.nii.gz --poses poses.tsv --angle 4 -o ranks.tsv --force --quiet 2>said
    [ ! -s said ]
}

@test "an error is reported once, and nothing is left" {
    setup_poses
    ranks 3 sphere.nii.gz --poses none.tsv -o rows.tsv 2>said && return 1 || [ $? -eq 3 ]
    [ "$(grep -c '^conus: ' said)" -eq 1 ]
    ranks 2 sphere.nii.gz --poses poses.tsv 2>said && return 1 || [ $? -eq 2 ]
    grep -q 'conus-mpi batch needs files for --poses and --output' said
    mkfifo pipe.tsv
    ranks 2 sphere.nii.gz --poses pipe.tsv -o rows.tsv 2>said && return 1 || [ $? -eq 2 ]
    grep -q 'conus-mpi batch needs files for --poses and --output' said
    ranks 2 --poses poses.tsv 2>said && return 1 || [ $? -eq 2 ]
    [ "$(grep -c '^conus: ATLAS is missing; conus-mpi batch --help shows how' said)" -eq 1 ]
    rm said
    nothing_left sphere.nii.gz sphere.tsv sphere.json poses.tsv
    conus batch sphere.nii.gz --poses poses.tsv -o rows.tsv
    ranks 2 sphere.nii.gz --poses poses.tsv -o rows.tsv 2>said && return 1 || [ $? -eq 2 ]
    grep -q 'there is a file already' said
}

@test "the ranks of a node share one atlas: areas, surfaces, pathways, context" {
    setup_poses 200
    conus phantom brain -o . >/dev/null
    conus batch brain.atlas.json --poses poses.tsv --angle 20 -o rows.tsv
    ranks 3 brain.atlas.json --poses poses.tsv --angle 20 --block 2 -o ranks.tsv --verbose 2>said
    grep -q '^conus: atlas: [0-9]* bytes, in memory once for all processes of a node' said
    cmp rows.tsv ranks.tsv
    conus batch brain.atlas.json --poses poses.tsv --angle 20 --layers all -o rows.tsv --force
    ranks 3 brain.atlas.json --poses poses.tsv --angle 20 --layers all --block 2 -o ranks.tsv --force
    cmp rows.tsv ranks.tsv
    conus batch sphere.nii.gz --hemispheres split --poses poses.tsv -o rows.tsv --force
    ranks 2 sphere.nii.gz --hemispheres split --poses poses.tsv --block 2 -o ranks.tsv --force
    cmp rows.tsv ranks.tsv
}

@test "where an atlas cannot be shared, each rank has its own" {
    setup_poses
    ranks 1 sphere.nii.gz --poses poses.tsv -o alone.tsv --verbose 2>said
    run ! grep 'in memory once' said
    sphere --size 256
    conus batch sphere.nii.gz --poses poses.tsv -o rows.tsv
    ranks 2 sphere.nii.gz --poses poses.tsv --block 8 -o shared.tsv --verbose 2>said
    grep -q 'in memory once' said
    (
        ulimit -f 20000 # in KB; the shared memory is a file, too
        ranks 2 sphere.nii.gz --poses poses.tsv --block 8 -o own.tsv --verbose 2>said
    )
    run ! grep 'in memory once' said
    cmp rows.tsv shared.tsv
    cmp rows.tsv own.tsv
    # of two atlases the one that fits is shared, and the rows are the same
    conus phantom slabs -o . --size 16
    conus batch slabs.nii.gz --atlas sphere.nii.gz --poses poses.tsv --summary -q -o both.tsv
    (
        ulimit -f 20000
        ranks 2 slabs.nii.gz --atlas sphere.nii.gz --poses poses.tsv --summary --block 8 -o one.tsv --verbose 2>said
    )
    grep -q 'in memory once' said
    cmp both.tsv one.tsv
}

# setup_begun: makes poses, the wanted rows, and a batch killed.tsv that had room for at most 20 KB of them.
setup_begun() {
    setup_poses 1000
    conus batch sphere.nii.gz --poses poses.tsv -o rows.tsv
    (ulimit -f 20 && "$CONUS" batch sphere.nii.gz --poses poses.tsv --block 16 -o killed.tsv) && return 1
    has_lines 5 killed.tsv.journal
}

# all_catch_signals: whether all ranks, which are children of process $pid, are answering poses.
all_catch_signals() {
    read -r -a children <"/proc/$pid/task/$pid/children" || true # the line has no end
    [ "${#children[@]}" -eq "$1" ] || return
    for child in "${children[@]}"; do
        catches_signals "$child" "$CONUS_MPI" || return
    done
    children_held=("${children[@]}")
    children=()
}

# hold_ranks N: resumes killed.tsv on ranks that are children of process $pid, and that cannot finish: the first waits
# to write its progress into a pipe that is full, and the others wait for it.
hold_ranks() {
    local command=("$CONUS_MPI" batch sphere.nii.gz --poses poses.tsv --block 1 -o killed.tsv --resume -q --progress json)
    fill_progress
    env --default-signal=INT "${mpi[@]}" -n 1 bash -c 'exec "$@" 2>progress' first "${command[@]}" \
        : -n $(($1 - 1)) "${command[@]}" 2>others 3>&- 6>&- &
    pid=$!
    wait_until "$pid" all_catch_signals "$1"
}

# end_held SIGNAL PID...: sends the signal to these processes, and waits until all that hold_ranks has started have
# ended.
end_held() {
    kill "$@"
    wait "$pid" 2>/dev/null && return 1
    exec 6>&-
    flock --timeout $HANG killed.tsv.journal true
    [ ! -e killed.tsv ]
}

# resume COMMAND...: resumes the killed batch, whose file must become that of one run.
resume() {
    "$@" sphere.nii.gz --poses poses.tsv -o killed.tsv --resume
    cmp rows.tsv killed.tsv
    [ ! -e killed.tsv.part ] && [ ! -e killed.tsv.journal ]
    diff <(grep -Ev 'CommandLine|Checksum' rows.json) <(grep -Ev 'CommandLine|Checksum' killed.json)
}

@test "killed and resumed, with any number of ranks and by conus batch: the file of one run" {
    setup_begun
    ranks 2 sphere.nii.gz --poses poses.tsv -o killed.tsv 2>again && return 1 || [ $? -eq 2 ]
    grep -q 'killed.tsv: an unfinished batch is there; --resume continues it, --force begins anew' again
    ranks 2 sphere.nii.gz --poses poses.tsv -o killed.tsv --angle 11 --resume 2>again && return 1 || [ $? -eq 2 ]
    [ "$(grep -c '^conus: .*written with other settings' again)" -eq 1 ]
    hold_ranks 4
    end_held -KILL "$pid" "${children_held[@]}" # all processes
    hold_ranks 3
    end_held -KILL "${children_held[1]}" # a rank
    cp killed.tsv.part part
    cp killed.tsv.journal journal
    resume ranks 2
    rm killed.tsv killed.json
    mv part killed.tsv.part
    mv journal killed.tsv.journal
    resume conus batch
    ranks 2 sphere.nii.gz --poses poses.tsv -o killed.tsv --resume
    ranks 2 sphere.nii.gz --poses poses.tsv -o killed.tsv --resume --angle 11 2>said && return 1 || [ $? -eq 2 ]
    grep -q 'there is a file already' said
}

@test "ranks that cannot go on in the midst of writing, and are resumed" {
    setup_begun
    printf 'ulimit -f 40\nexec "$@"\n' >limited.sh # what makes a file larger than 40 KB is not written
    local command=(bash limited.sh "$CONUS_MPI" batch sphere.nii.gz --poses poses.tsv --block 1 -o killed.tsv --resume)
    "${mpi[@]}" --mca btl 'tcp,self' -n 2 "${command[@]}" 3>&- &>said && return 1
    grep -q 'killed.tsv: cannot write: ' said
    flock --timeout $HANG killed.tsv.journal true
    has_lines 6 killed.tsv.journal
    resume ranks 3
}

@test "conus batch killed, and resumed on ranks" {
    setup_begun
    hold batch sphere.nii.gz --poses poses.tsv --block 10 -o killed.tsv --resume
    wait_until "$pid" catches_signals "$pid"
    end_held -KILL "$pid"
    resume ranks 3 --block 7
}

# said_how_to_go_on FILE: asserts that the advice was given once, or not at all if there was no time; and nothing else.
said_how_to_go_on() {
    local wanted='^conus: interrupted after [0-9]* poses; continue with: conus-mpi batch .* -o killed.tsv .*--resume$'
    [ "$(grep -c "$wanted" "$1")" -le 1 ] || { cat "$1"; return 1; }
    [ "$(grep '^conus: ' "$1" | grep -vc "$wanted")" -eq 0 ] || { cat "$1"; return 1; }
}

@test "SIGTERM to a rank and SIGINT to mpirun end it, and --resume goes on" {
    setup_begun
    hold_ranks 2
    kill -TERM "${children_held[1]}"
    wait_until "$pid" took_signal "${children_held[1]}"
    let_go 143
    said_how_to_go_on said
    hold_ranks 2
    end_held -INT "$pid" # mpirun ends the ranks
    said_how_to_go_on others
    resume ranks 2
}

@test "an error of one rank ends all, and --resume goes on" {
    setup_poses
    conus batch sphere.nii.gz --poses poses.tsv -o rows.tsv
    local command=("$CONUS_MPI" batch sphere.nii.gz --poses poses.tsv --block 1 -o full.tsv)
    printf 'trap "" XFSZ\nulimit -f 20\nexec "$@"\n' >limited.sh # no more than 20 KB
    "${mpi[@]}" -n 1 bash limited.sh "${command[@]}" : -n 1 "${command[@]}" 2>said 3>&- && return 1 || [ $? -eq 3 ]
    [ "$(grep '^conus: ' said | grep -vc '^conus: note: ')" -eq 1 ]
    grep -q '^conus: full.tsv: cannot write' said
    [ ! -e full.tsv ]
    ranks 2 sphere.nii.gz --poses poses.tsv -o full.tsv --resume
    cmp rows.tsv full.tsv
}

@test "shards, given or a Slurm array's" {
    setup_poses 301
    conus batch sphere.nii.gz --poses poses.tsv -o rows.tsv
    for i in 0 1 2; do
        ranks 2 sphere.nii.gz --poses poses.tsv --block 3 --shard "$i/3" -o "rows.$i.tsv"
    done
    conus batch sphere.nii.gz --poses poses.tsv --shard 1/3 | cmp - rows.1.tsv
    conus merge rows.?.tsv -o merged.tsv
    cmp rows.tsv merged.tsv
    SLURM_ARRAY_TASK_ID=12 SLURM_ARRAY_TASK_COUNT=3 SLURM_ARRAY_TASK_MIN=10 \
        ranks 2 sphere.nii.gz --poses poses.tsv -o slurm.tsv 2>said
    cmp rows.2.tsv slurm.tsv
    [ "$(grep -c '^conus: note: shard 2/3, from SLURM_ARRAY_TASK_ID=12' said)" -eq 1 ]
    ranks 2 sphere.nii.gz --poses poses.tsv --shard 3/3 -o no.tsv 2>said && return 1 || [ $? -eq 2 ]
    [ "$(grep -c '^conus: --shard: "3/3" is not I/N' said)" -eq 1 ]
}

@test "progress is that of all ranks" {
    setup_poses 2000
    ranks 3 sphere.nii.gz --poses poses.tsv --block 8 -o rows.tsv --progress json 2>said
    [ "$(grep -c '"finished":true' said)" -eq 1 ]
    grep -q '^{"done":2000,"total":2000,"errors":0,.*"finished":true}$' said
}

@test "a file without poses becomes one without rows" {
    setup_poses 0
    conus batch sphere.nii.gz --poses poses.tsv -o rows.tsv 2>said
    ranks 2 sphere.nii.gz --poses poses.tsv -o ranks.tsv 2>also
    cmp rows.tsv ranks.tsv
    grep -q '^conus: ' said
    [ "$(grep '^conus: ' said)" = "$(grep '^conus: ' also)" ]
}

# pretend_nodes: `mpi` starts ranks on the nodes a, b and c, which are all this machine.
pretend_nodes() {
    cat >agent <<'END'
#!/bin/sh
# mpirun calls this instead of ssh HOST COMMAND...; nodes do not share temporary files.
host=$1
shift
mkdir -p "nodes/$host"
TMPDIR=$PWD/nodes/$host exec sh -c "$*"
END
    chmod +x agent
    export OMPI_MCA_plm_rsh_agent=$PWD/agent
    mpi=(timeout $HANG mpirun --oversubscribe --allow-run-as-root --mca btl 'tcp,self' --mca btl_tcp_if_include lo)
    mpi+=(-host 'a:8,b:8,c:8' --map-by node)
    "${mpi[@]}" -n 3 true 3>&- || skip "this mpirun cannot pretend to have several nodes"
}

@test "on several nodes, each with its atlas, by TCP" {
    setup_poses
    pretend_nodes
    printf '1\t1\tx\t4\t5\t6\n' >>poses.tsv
    conus batch sphere.nii.gz --poses poses.tsv -o rows.tsv || [ $? -eq 1 ]
    for n in 3 5; do
        ranks "$n" sphere.nii.gz --poses poses.tsv --block 8 -o "ranks$n.tsv" && return 1 || [ $? -eq 1 ]
        cmp rows.tsv "ranks$n.tsv"
    done
    ranks 4 none.nii.gz --poses poses.tsv -o none.tsv 2>said && return 1 || [ $? -eq 3 ]
    [ "$(grep -c '^conus: ' said)" -eq 1 ]
}

@test "other programs' formats are those of conus batch" {
    setup_poses
    { printf 'name\tx\ty\tz\tsize\n'; awk 'BEGIN { for (i = 0; i < 700; i++) printf "A%d\t%s\t%d\t%d\t2\n", i, i % 9 ? i % 50 - 25 : "n/a", i % 41 - 20, i % 7 }'; } >probe.tsv
    for format in bids afni spikeglx open-ephys; do
        conus batch sphere.nii.gz --poses probe.tsv --radius 3 --quiet --format $format -o "rows.$format" || [ $? -eq 1 ]
        ranks 2 sphere.nii.gz --poses probe.tsv --radius 3 --quiet --format $format --block 64 -o "ranks.$format" 2>said && return 1 || [ $? -eq 1 ]
        cmp "rows.$format" "ranks.$format"
    done
    ranks 2 sphere.nii.gz --poses probe.tsv --radius 3 --quiet --format spikeglx --block 8 -o short.txt 2>said && return 1 || [ $? -eq 2 ]
    grep -q 'a probe is written as a whole, but these are contacts 1 to 128' said
    [ ! -e short.txt ]
}

@test "segments and clearances are those of conus batch, alone and besides the rows" {
    setup_poses
    printf '1\t1\tx\t4\t5\t6\n' >>poses.tsv
    conus batch sphere.nii.gz --poses poses.tsv --segments segments.tsv --clearance near.tsv,within=3 -o rows.tsv || [ $? -eq 1 ]
    ranks 2 sphere.nii.gz --poses poses.tsv --block 8 --segments alone.tsv 2>said && return 1 || [ $? -eq 1 ]
    cmp segments.tsv alone.tsv
    ranks 3 sphere.nii.gz --poses poses.tsv --block 8 --segments both.tsv --clearance three.tsv,within=3 -o ranks.tsv 2>said && return 1 || [ $? -eq 1 ]
    cmp segments.tsv both.tsv
    cmp near.tsv three.tsv
    cmp rows.tsv ranks.tsv
    ranks 2 sphere.nii.gz --poses poses.tsv --segments - 2>said && return 1 || [ $? -eq 2 ]
    grep -q 'needs files for --poses and --segments' said
}
