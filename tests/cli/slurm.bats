#!/usr/bin/env bats
# The job array and srun of docs/batch.md in a Slurm of one node, which this test starts itself.
load helpers

write_configuration() {
    local host
    host=$(hostname -s)
    cat <<END
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/munge
AuthInfo=socket=$slurm/munge
CryptoType=crypto/munge
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
StateSaveLocation=$slurm/state
SlurmdSpoolDir=$slurm/spool
SlurmctldPidFile=$slurm/slurmctld.pid
SlurmdPidFile=$slurm/slurmd.pid
SlurmctldPort=$(free_port)
SlurmdPort=$(free_port)
SlurmctldLogFile=$slurm/slurmctld.log
SlurmdLogFile=$slurm/slurmd.log
ReturnToService=2
SchedulerType=sched/builtin
SchedulerParameters=sched_min_interval=100000,sched_interval=1,batch_sched_delay=0
MpiDefault=none
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
END
}

# slurm_up: waits until a node is idle, or skips the test.
slurm_up() {
    for program in munged slurmctld slurmd sbatch; do
        command -v "$program" >/dev/null || skip "no $program"
    done
    [ "$(id -u)" = 0 ] || skip "not root, whom slurmd needs"
    slurm=$PWD/slurm
    mkdir -p "$slurm/state" "$slurm/spool"
    chmod 700 "$slurm"
    head -c 128 /dev/urandom >"$slurm/key"
    chmod 600 "$slurm/key"
    munged --force --socket="$slurm/munge" --key-file="$slurm/key" --pid-file="$slurm/munged.pid" \
        --log-file="$slurm/munged.log" --seed-file="$slurm/seed" 3>&- || skip "munged does not start"
    export SLURM_CONF=$slurm/slurm.conf
    write_configuration >"$SLURM_CONF"
    slurmctld 3>&- && slurmd 3>&- || skip "Slurm does not start"
    local begun=$SECONDS
    until sinfo -h 2>/dev/null | grep -q idle; do
        [ $((SECONDS - begun)) -lt $HANG ] || skip "Slurm's node does not come up"
        sleep 0.5
    done
}

# The daemons write to the folder until they have ended. munged misses a signal that comes just before it waits for its
# next client, so it is sent again.
teardown() {
    for daemon in slurmd slurmctld munged; do
        [ -s "slurm/$daemon.pid" ] || continue
        local pid
        pid=$(cat "slurm/$daemon.pid")
        while runs "$pid" && kill "$pid"; do
            sleep 0.05
        done
    done
}

# example NAME: the code of docs/batch.md whose fence has that name, for four parts: sixteen tasks of four processors
# would wait for each other here.
example() {
    awk -v fence="\`\`\`sh $1" '$0 == fence { inside = 1; next } /^```/ { inside = 0 } inside' \
        "$BATS_TEST_DIRNAME/../../docs/batch.md" |
        sed 's/array=0-15/array=0-3/; s/ntasks=16/ntasks=4 --overcommit/; s/cpus-per-task=4/cpus-per-task=1/; s|all/16|all/4|'
}

@test "the examples of docs/batch.md: an array, then srun; and the file of one run" {
    slurm_up
    sphere --size 32 --spacing 2,2,2
    mv sphere.nii.gz aal.nii.gz
    mv sphere.tsv aal.tsv
    awk 'BEGIN {
        print "x\ty\tz\ttx\tty\ttz"
        for (i = 0; i < 100; i++)
            printf "%.3f\t%.3f\t%.3f\t%.3f\t0\t0\n", 90 * cos(i), 90 * sin(i), i % 60 - 30, i % 3 * 15
    }' >poses.tsv
    conus batch aal.nii.gz --poses poses.tsv -o whole.tsv
    mkdir bin
    ln -s "$CONUS" bin/conus
    PATH=$PWD/bin:$PATH
    example sbatch >array.sh
    grep -q '^#SBATCH --array=0-3' array.sh
    timeout $HANG sbatch --wait array.sh
    grep -h 'note: --shard 3/4, from SLURM_ARRAY_TASK_ID=3' slurm-*_3.out
    example last >last.sh
    bash -eu last.sh 2>said
    grep -q 'rows.tsv: 4 of 4 parts are there already' said
    cmp whole.tsv rows.tsv
    rm rows.*
    example srun >srun.sh
    timeout $HANG bash -eu srun.sh >said 2>&1
    grep -q 'note: --shard 3/4, from SLURM_PROCID=3' said
    printf '#!/bin/bash\n%s\n' 'conus batch aal.nii.gz --poses poses.tsv --shard auto -o none.tsv' >alone.sh
    run -2 timeout $HANG sbatch --wait --ntasks=2 --overcommit -o alone.out alone.sh # no srun: all would be part 0
    grep -q 'the environment does not say which part this process is' alone.out
    bash -eu last.sh 2>said
    grep -q 'rows.tsv: 4 of 4 parts are there already' said
    cmp whole.tsv rows.tsv
}
