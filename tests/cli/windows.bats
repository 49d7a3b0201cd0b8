#!/usr/bin/env bats
# What base/system and base/path promise on Windows: a program of scripts/libraries' compiler, in wine.
load helpers

@test "base/system and base/path keep on Windows what they promise" {
    root=$BATS_TEST_DIRNAME/../..
    compiler=$root/build/windows-sysroot/bin/clang
    wine=$(command -v wine64 || echo /usr/lib/wine/wine64)
    [[ -x $compiler && -x $wine ]] || skip "needs scripts/libraries windows, and wine64"
    export WINEDEBUG=-all WINEPREFIX=$BATS_FILE_TMPDIR/wine
    cd "$BATS_TEST_TMPDIR" || return
    "$compiler" -std=c17 -Wall -Wextra -Werror -D_GNU_SOURCE -D_FILE_OFFSET_BITS=64 -I"$root" -o windows.exe \
        "$root"/tests/base/windows.c "$root"/base/{path,text_gnu}.c "$root"/base/system/system_windows.c \
        -lshell32 -ladvapi32
    mkdir empty
    cd empty || return
    # A file: wine's server lives on for a while, and would keep a pipe open.
    "$wine" ../windows.exe 'ä b"c' >../said 2>../wine 3>&- || { cat ../said; return 1; }
    [[ $(cat ../said) = "0 failures" ]]
}
