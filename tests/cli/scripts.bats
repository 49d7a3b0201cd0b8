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
