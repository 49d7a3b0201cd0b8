#!/usr/bin/env bats
# Every script says what it does when it is asked with --help or -h, and does nothing else.
load helpers
ROOT=$BATS_TEST_DIRNAME/../..

@test "every script explains itself" {
    cp -r "$ROOT/scripts" scripts
    chmod -R a-w scripts
    find . | sort >../before
    for script in scripts/*; do
        [ -x "$script" ] || continue
        for option in --help -h; do
            run -0 --separate-stderr "$script" $option
            [[ "${lines[0]}" == "$script"* ]]
            [ ${#lines[@]} -ge 2 ]
            [ -z "$stderr" ]
        done
    done
    find . | sort >../after
    diff ../before ../after
}

@test "scripts/test finds what a test left in its home, and not what a user does beside it" {
    sed -n '/^leftovers()/,/^}/p' "$ROOT/scripts/test" >leftovers.bash
    grep -q find leftovers.bash
    mkdir -p user build/dev/home/.cache/mesa build/sanitize/home
    mkdir -p user/.local/state/conus && touch user/.local/state/conus/recent
    HOME=$PWD/user run -0 bash -c '. ./leftovers.bash; leftovers'
    mkdir -p build/sanitize/home/.local/state/conus
    run -1 bash -c '. ./leftovers.bash; leftovers'
    [[ "$output" == *build/sanitize/home/.local/state/conus* ]]
}

@test "scripts/test says how many of all tests it has run, and takes one option" {
    sed -n '/^left_out()/,/^}/p' "$ROOT/scripts/test" >left_out.bash
    grep -q Total left_out.bash
    printf '%s\n' ' 1/3 Test #1: no.more .....   Passed    0.01 sec' '33% tests passed, 1 tests failed out of 4' '' \
        'The following tests did not run:' $'\t  2 - oracle.one (Skipped)' $'\t 33 - two (Not Run)' '' \
        'The following tests FAILED:' $'\t  4 - three (Failed)' >tests-dev.log
    # shellcheck disable=SC2016 # of that shell
    run -0 bash -c 'logs=. left="the rest"; ctest() { echo "Total Tests: 9"; }; . ./left_out.bash; left_out'
    [ "$output" = "2 of 9 tests; the rest" ]
    for words in --everything "--all --quick" "--all x"; do
        # shellcheck disable=SC2086 # words
        run -2 "$ROOT/scripts/test" $words
        [ "$output" = "usage: scripts/test [--quick | --all | --long]" ]
    done
}
