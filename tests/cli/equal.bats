#!/usr/bin/env bats
# tests/equal/outputs finds what differs from tests/equal/expected.
load helpers

equal() {
    TMPDIR=$PWD "$BATS_TEST_DIRNAME"/../equal/outputs "$@" "$CONUS" # what differs stays there
}

@test "one changed word, one changed sum, a command more and a command less are differences" {
    cp -r "$BATS_TEST_DIRNAME"/../equal/expected expected
    run -0 equal --only diffs --expected expected
    sed -i '0,/changed/s//altered/' expected/diffs.txt
    run -1 equal --only diffs --expected expected
    [[ $output = *"-    "*altered*"+    "*changed*"1 differences"* ]]
    cp "$BATS_TEST_DIRNAME"/../equal/expected/diffs.txt expected
    sed -i '0,/^[0-9a-f]\{4\}\(.*  pair.a.tsv\)$/s//0000\1/' expected/diffs.sums
    run -1 equal --only diffs --expected expected
    [[ $output = *"pair/a.tsv differs"*"1 differences"* ]]
    sed -i '/  pair.a.tsv$/d' expected/diffs.sums
    printf '$ conus diff pair/none.tsv pair/a.tsv\n    = 3\n' >>expected/diffs.txt
    run -1 equal --only diffs --expected expected
    [[ $output = *'$ conus diff pair/none.tsv pair/a.tsv'*"pair/a.tsv is new"*"2 differences"* ]]
}
