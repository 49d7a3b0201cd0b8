#!/usr/bin/env bats
# What base/system, base/path and base/child promise on Windows: programs of scripts/libraries' compiler, in wine.
load helpers

# build_for_windows SOURCE...: builds windows.exe of these and base/system, and goes to an empty folder.
build_for_windows() {
    root=$BATS_TEST_DIRNAME/../..
    compiler=$root/build/windows-sysroot/bin/clang
    wine=$(command -v wine64 || echo /usr/lib/wine/wine64)
    [[ -x $compiler && -x $wine ]] || skip "needs scripts/libraries windows, and wine64"
    # a program that crashes on purpose would start wine's debugger, which has been seen to wait for ever
    export WINEDEBUG=-all WINEPREFIX=$BATS_FILE_TMPDIR/wine WINEDLLOVERRIDES=winedbg.exe=d
    cd "$BATS_TEST_TMPDIR" || return
    "$compiler" -std=c17 -Wall -Wextra -Werror -D_GNU_SOURCE -D_FILE_OFFSET_BITS=64 -I"$root" -I"$root/include" -o windows.exe \
        "${@/#/$root/}" "$root"/base/system/system_windows.c -lshell32 -ladvapi32
    mkdir empty
    cd empty || return
}

# Its server writes into its folder for a while.
teardown_file() {
    [[ ! -d $BATS_FILE_TMPDIR/wine ]] || WINEPREFIX=$BATS_FILE_TMPDIR/wine /usr/lib/wine/wineserver64 -k || true
}

# A file takes what it says: wine's server lives on for a while, and would keep a pipe open.
says_no_failures() {
    "$wine" ../windows.exe "$@" >../said 2>../wine 3>&- || { cat ../said; return 1; }
    [[ $(cat ../said) = "0 failures" ]]
}

@test "base/system and base/path keep on Windows what they promise" {
    build_for_windows tests/base/windows.c base/path.c base/text_gnu.c
    says_no_failures 'ä b"c'
}

@test "base/child/child.h keeps on Windows what it promises" {
    build_for_windows tests/base/windows_process.c base/child/process_windows.c
    says_no_failures
}
