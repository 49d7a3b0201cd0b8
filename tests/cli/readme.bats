#!/usr/bin/env bats
# The README shows the program's real output.
load helpers

README=$BATS_TEST_DIRNAME/../../README.md

# block FIRST SECOND: the lines of the README's console block below the command "$ FIRST \", newline, "SECOND".
block() {
    awk -v first="\$ $1 \\\\" -v second="    $2" '
        /^```/ { inside = 0 } inside { print } previous == first && $0 == second { inside = 1 } { previous = $0 }' "$README"
}

@test "the query of the README gives the table of the README" {
    need_aal
    local arguments='--origin=-90,20,20 --toward=0,-10,10 --angle 20'
    local shown
    shown=$(block "conus query $aal" "$arguments" | sed 's/engine rays, [a-z0-9]*/engine rays/')
    [ -n "$shown" ]
    # shellcheck disable=SC2086 # the README's words
    answers query "$aal" $arguments --engine rays
    [ "$(sed 's/engine rays, [a-z0-9]*/engine rays/' <<<"$output")" = "$shown" ]
}
