#!/usr/bin/env bats
# tests/equal/outputs finds what differs between two builds, and from tests/equal/expected.
load helpers

equal() {
    TMPDIR=$PWD "$BATS_TEST_DIRNAME"/../equal/outputs "$@" # what differs stays there
}

# as_before COMMAND: compares the build with one whose program ends with this command.
as_before() {
    mkdir -p old new
    ln -sf "$CONUS" new/conus
    printf '#!/bin/bash\n"%s" "$@"; code=$?; %s; exit $code\n' "$CONUS" "$1" >old/conus
    chmod +x old/conus
    equal --only diffs old new
}

@test "one changed word, a command more and a command less are differences from what is expected" {
    cp -r "$BATS_TEST_DIRNAME"/../equal/expected expected
    run -0 equal --only help --expected expected "$CONUS"
    sed -i '0,/full opening angle/s//full angle/; /^\$ conus nonsense$/,/= 2/d' expected/help.txt
    printf '$ conus more\n    = 3\n' >>expected/help.txt
    run -1 equal --only help --expected expected "$CONUS"
    [[ $output = *"-    "*"full angle"*"+    "*"full opening angle"*'$ conus more'*"3 differences"* ]]
    run -2 equal --only diffs --expected expected "$CONUS"
    [[ $output = *"diffs: nothing is expected of it"* ]]
}

@test "a changed file, a file more, another exit code are differences between two builds" {
    run -0 as_before true
    run -1 as_before '[[ "$*" != *pair/a.tsv\ --voxels* ]] || { echo >>pair/a.tsv; echo >pair/more; }'
    [[ $output = *"pair/a.tsv differs"*"pair/more is missing"* ]]
    run -1 as_before '[[ "$*" != *pair/a.exr ]] || code=7'
    [[ $output = *'$ conus diff pair/a.exr pair/a.exr'*"-    = 7"*"1 differences"* ]]
}
