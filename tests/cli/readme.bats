#!/usr/bin/env bats
# What the README shows is what the program says.
load helpers

README=$BATS_TEST_DIRNAME/../../README.md

# block COMMAND: what the README's console block shows below "$ COMMAND".
block() {
    awk -v command="\$ $1" '/^```/ { inside = 0 } inside { print } $0 == command { inside = 1 }' "$README"
}

@test "the query of the README gives the table of the README" {
    need_aal
    local arguments="query $aal --origin=-90,20,20 --toward=0,-10,10 --angle 20"
    local shown
    shown=$(block "conus $arguments" | sed 's/engine rays, [a-z0-9]*/engine rays/')
    [ -n "$shown" ]
    # shellcheck disable=SC2086 # the README's words
    answers $arguments --engine rays
    [ "$(sed 's/engine rays, [a-z0-9]*/engine rays/' <<<"$output")" = "$shown" ]
}
