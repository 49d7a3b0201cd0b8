#!/usr/bin/env bats
# conus mcp: answers a line of JSON for a line, reads what it may, and writes nothing.
load helpers

mcp() {
    run -0 python3 "$BATS_TEST_DIRNAME/mcp.py" "$@"
    [ "$output" = "${said-}" ] || { echo "$output"; return 1; }
}

@test "a transcript: each answer is that of the command, and each refusal says why" {
    mcp transcript "$CONUS"
}

@test "tools are what the rows of options say, without those that write" {
    mcp tools "$CONUS"
}

@test "random and hostile lines end nothing, write nothing and read nothing else" {
    command -v strace >/dev/null || skip 'no strace'
    strace -f -o /dev/null true || skip 'strace may trace nothing here'
    said='600 lines' mcp hostile "$CONUS" 600
}

@test "roots" {
    fails 3 'missing: cannot open: No such file or directory' mcp --root missing </dev/null
    touch file
    fails 3 'file: is no folder' mcp --root file </dev/null
    run -0 --separate-stderr conus mcp </dev/null
    [ -z "$output$stderr" ]
}
