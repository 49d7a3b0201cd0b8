#!/usr/bin/env bats
# tests/platforms/ask finds what another build says or writes otherwise, and each known difference that is none.
load helpers

# ask OPTION...: asks conus and the program `other`, a script, what stands in `corpus`.
ask() {
    chmod +x other
    # what differs stays there
    TMPDIR=$PWD "$BATS_TEST_DIRNAME"/../platforms/ask --corpus corpus --jobs 1 "$@" "$CONUS" -- ./other
}

# other SCRIPT: how the other build differs; its conus is $CONUS.
other() {
    printf '#!/bin/sh\nCONUS=%s\n%s\n' "$CONUS" "$1" >other
}

setup() {
    mkdir "$BATS_TEST_TMPDIR/work"
    cd "$BATS_TEST_TMPDIR/work" || return
    cat >corpus <<'END'
[inputs]
* conus phantom nested -o ph --size 24
[engine]
conus query ph/nested.nii.gz --origin=3,-100,5 --toward=0,0,0 --format json | grep -o '"engine": "[^"]*"'
[rows]
* conus query ph/nested.nii.gz --origin=3,-100,5 --toward=0,0,0 -q -o rows/rows.tsv
conus query ph/nested.nii.gz --origin=3,-100,5 --toward=0,0,0 --format json
conus query ph/none.nii.gz --origin=3,-100,5 --toward=0,0,0
    moon, mars: no file is missing there
        -! conus: ph/none.nii.gz: cannot …
        -= 3
        +! conus: what?
        += 5
END
    none='case " $* " in *none*) echo "conus: what?" >&2; exit 5 ;; esac'
}

@test "a build is equal to itself, and each line that is known to differ has to" {
    other 'exec "$CONUS" "$@"'
    run -0 ask
    [[ $output = *"0 known differences on no target; all else is equal" ]]
    run -0 ask --target sun
    run -1 ask --target mars
    [[ $output = *none.nii.gz*"no longer differs: no file is missing there"*"1 faults"* ]]
    run -0 ask --target mars --sample
    [[ $output != *engine* ]]
    run -0 ask --target mars --only engine
    run -2 ask --only nothing
    [[ $output = *"no section nothing; there are inputs, engine, rows" ]]
}

@test "a known difference counts on its target only, and has its own words only" {
    other "$none; exec \"\$CONUS\" \"\$@\""
    run -0 ask --target mars
    [[ $output = *none.nii.gz*"mars: no file is missing there"*"1 known differences on mars; all else is equal" ]]
    run -1 ask
    [[ $output = *none.nii.gz*"+! conus: what?"*"1 faults"* ]]
    other "${none/what/who}; exec \"\$CONUS\" \"\$@\""
    run -1 ask --target moon
    [[ $output = *none.nii.gz*"+! conus: who?"*"1 faults"* ]]
}

@test "one other byte on standard output, on standard error and in a file, another exit code, a file less and more" {
    other '"$CONUS" "$@" | sed "s/Shell outer/Shell Outer/"'
    run -1 ask
    # A pipe loses the exit code of none.nii.gz, the second fault.
    [[ $output = *'$ conus query'*'--format json'*'-'*'Shell outer'*'+'*'Shell Outer'*"2 faults"* ]]
    other '"$CONUS" "$@" 2>../err || { code=$?; sed "s/cannot/can not/" ../err >&2; exit $code; }'
    run -1 ask
    [[ $output = *'+! conus: ph/none.nii.gz: can not open'*"1 faults"* ]]
    other '"$CONUS" "$@" || exit; [ ! -e rows/rows.tsv ] || sed -i s/outer/Outer/ rows/rows.tsv'
    run -1 ask
    [[ $output = *"file rows/rows.tsv differs"*"1 faults"* ]]
    other '"$CONUS" "$@" || exit $(($? + 1))'
    run -1 ask
    [[ $output = *none.nii.gz*"-= 3"*"+= 4"*"1 faults"* ]]
    other '"$CONUS" "$@" || exit; rm -f rows/rows.json'
    run -1 ask
    [[ $output = *"file rows/rows.json is missing"*"1 faults"* ]]
    other '"$CONUS" "$@" || exit; [ ! -d rows ] || touch rows/more'
    run -1 ask
    [[ $output = *"file rows/more is only there"*"1 faults"* ]]
}

@test "the engine's name and the checksum over it may differ, but not where the name is asked" {
    other '"$CONUS" "$@" >../out; code=$?
        sed -E "s/rays, [a-z0-9]+/rays, scalar/; s/(\"Checksum\": \").{4}/\10000/" ../out; exit $code'
    run -1 ask
    [[ $output = *'+"engine": "rays, scalar"'*"1 faults"* ]]
    other '"$CONUS" "$@" >../out; code=$?; sed -E "s/(\"sha256\": \").{4}/\10000/" ../out; exit $code'
    run -1 ask
    [[ $output = *'+'*'"sha256": "0000'*"1 faults"* ]]
}

@test "the lines with a * of tests/platforms/corpus: a build is equal to itself" {
    other 'exec "$CONUS" "$@"'
    run -0 ask --sample --corpus "$BATS_TEST_DIRNAME/../platforms/corpus"
}
