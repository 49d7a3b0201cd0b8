#!/usr/bin/env bats
# conus-mpi batch against conus batch.
load helpers

# ranks N ARGUMENT...: conus-mpi batch on N ranks. OpenMPI forgets memory of parts that it unloads, so that LeakSanitizer,
# where there is one, would end it with a code of its own.
ranks() {
    local count=$1
    shift
    ASAN_OPTIONS=detect_leaks=0 mpirun --oversubscribe --allow-run-as-root -n "$count" "$CONUS_MPI" batch "$@" 3>&-
}

setup_poses() {
    command -v mpirun >/dev/null || skip "no mpirun"
    sphere --size 32 --spacing 2,2,2
    awk 'BEGIN {
        print "x\ty\tz\ttx\tty\ttz"
        for (i = 0; i < 700; i++)
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
    diff <(grep -v CommandLine rows.json) <(grep -v CommandLine ranks4.json)
    ranks 2 sphere.nii.gz --poses poses.tsv --threads 2 --block 44 -o threads.ndjson
    conus batch sphere.nii.gz --poses poses.tsv --format ndjson | cmp - threads.ndjson
}

@test "error rows and exit codes are those of conus batch" {
    setup_poses
    printf '1\t1\tx\t4\t5\t6\n' >>poses.tsv
    conus batch sphere.nii.gz --poses poses.tsv -o rows.tsv || [ $? -eq 1 ]
    ranks 2 sphere.nii.gz --poses poses.tsv --block 8 -o ranks.tsv 2>said && return 1 || [ $? -eq 1 ]
    cmp rows.tsv ranks.tsv
}

@test "what is wrong is said once, and nothing is left" {
    setup_poses
    ranks 3 sphere.nii.gz --poses none.tsv -o rows.tsv 2>said && return 1 || [ $? -eq 3 ]
    [ "$(grep -c '^conus: ' said)" -eq 1 ]
    ranks 2 sphere.nii.gz --poses poses.tsv 2>said && return 1 || [ $? -eq 2 ]
    grep -q 'conus-mpi batch needs ATLAS, --poses and --output' said
    rm said
    nothing_left sphere.nii.gz sphere.tsv sphere.json poses.tsv
    conus batch sphere.nii.gz --poses poses.tsv -o rows.tsv
    ranks 2 sphere.nii.gz --poses poses.tsv -o rows.tsv 2>said && return 1 || [ $? -eq 2 ]
    grep -q 'there is a file already' said
}
