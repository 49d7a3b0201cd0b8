#!/usr/bin/env bats
# Every file of the templates and of the collection of bad ones: an answer, or one clear line.
load helpers

# survives FILE: asserts that info and query end with a documented code; bad files need only be refused.
survives() {
    run --separate-stderr "$CONUS" info "$1"
    case $status in
    0) [ -z "$stderr" ] ;;
    2 | 3) check_message '' && [ -z "$output" ] ;;
    *) false ;;
    esac || { echo "info $1: code $status, said: $stderr"; return 1; }
    local seen=$status
    run --separate-stderr "$CONUS" query "$1" --origin 0,0,200 --toward 0,0,0 --quiet --format tsv
    [ "$status" -eq "$seen" ] || { echo "query $1: code $status, said: $stderr"; return 1; }
}

@test "all templates of mricron-data are answered or refused in one line" {
    need_aal
    local count=0
    for file in "$TEMPLATES"/*.nii.gz; do
        survives "$file"
        [ "$status" -ne 0 ] || count=$((count + 1))
    done
    [ "$count" -ge 9 ]
}

@test "files that break readers are answered or refused in one line" {
    local hostile=${CONUS_SHARED_DATA:-$BATS_TEST_DIRNAME/../../../shared/data}/hostile
    [ -d "$hostile" ] || skip "no shared data ($hostile)"
    find "$hostile" -type f | sort >files
    [ "$(wc -l <files)" -ge 50 ]
    while read -r file; do
        survives "$file"
    done <files
}

@test "no OpenGL library is loaded where none is needed" {
    sphere --size 16
    LD_DEBUG=files LD_DEBUG_OUTPUT=loaded "$CONUS" query sphere.nii.gz --origin 0,0,50 --toward 0,0,0 >answer
    [ -s "$(echo loaded.*)" ] || skip "this loader tells nothing"
    grep -q libz loaded.*
    run -1 grep -ohE 'lib(GL|EGL|GLX|GLdispatch|gallium|LLVM)[^ ]*' loaded.*
}

@test "too little memory for the process is exit code 3" {
    need_aal
    [ -z "$(nm "$CONUS" 2>/dev/null | grep -m 1 __asan_init)" ] || skip "the sanitizer needs address space"
    bash -c "ulimit -v 20000; '$CONUS' --version" || skip "not even the program fits"
    run -3 --separate-stderr bash -c "ulimit -v 20000; '$CONUS' query '$aal' --origin=-90,20,20 --toward=0,-10,10"
    check_message 'no memory for '
}
