#!/usr/bin/env bats
# scripts/abi tells changes that break compiled callers from those that do not, in a library of four functions.
load ../cli/helpers

setup_file() {
    mkdir -p "$BATS_FILE_TMPDIR/a library"/{include/conus,inner,scripts}
    cd "$BATS_FILE_TMPDIR/a library" || return
    cp "$BATS_TEST_DIRNAME/../../scripts/abi" scripts/
    cat >include/conus/thing.h <<'END'
#include <stdbool.h>
#include <stddef.h>
typedef enum kind { SMALL, LARGE } kind;
typedef struct thing thing;
typedef struct options { size_t struct_size; int first; char second; } options;
typedef struct answer { int count; double share; } answer;
thing *thing_create(const options *options);
void thing_destroy(thing *thing);
kind thing_kind(const thing *thing);
answer thing_answer(const thing *thing);
END
    # A file with the name of the public header.
    cat >inner/thing.h <<'END'
#include <conus/thing.h>
struct part { int number; };
struct thing { struct part part; };
END
    cat >library.c <<'END'
#include <stdlib.h>
#include "inner/thing.h"
thing *thing_create(const options *options) { return calloc(options->first, sizeof(thing)); }
void thing_destroy(thing *thing) { free(thing); }
kind thing_kind(const thing *thing) { return thing->part.number; }
answer thing_answer(const thing *thing) { return (answer){.count = thing->part.number}; }
END
    cat >CMakeLists.txt <<'END'
cmake_minimum_required(VERSION 3.20)
project(library LANGUAGES C)
add_library(conus SHARED library.c)
target_include_directories(conus PRIVATE . include)
set_target_properties(conus PROPERTIES SOVERSION 0)
END
    git init -q .
    commit old
}

# commit NAME: commits the library as it is.
commit() {
    git add CMakeLists.txt include inner library.c scripts
    git -c user.name=nobody -c user.email=nobody@example.org commit -q -m "$1"
}

# changed SED: makes this change in each file of the library as it was; then runs scripts/abi.
changed() {
    command -v abidw >/dev/null || skip "no abigail-tools"
    cd "$BATS_FILE_TMPDIR/a library"
    git checkout -q .
    sed -i "$1" include/conus/thing.h inner/thing.h library.c CMakeLists.txt
    ! git diff --quiet || { echo "no line is like that: $1"; return 1; }
    run scripts/abi HEAD
}

# holds SED: asserts that compiled callers still run after this change.
holds() {
    changed "$1"
    [ "$status" -eq 0 ] && [[ "$output" == *'run with this library: libconus.so.0, '* ]] || { echo "$1: $output"; return 1; }
}

# breaks SED TEXT: asserts that they do not, and that TEXT says why.
breaks() {
    changed "$1"
    [ "$status" -eq 1 ] && [[ "$output" == *"$2"*'do not run with this library' ]] || { echo "$1: $output"; return 1; }
}

@test "a function that is gone, or that has other parameters or another result, breaks callers" {
    breaks '/thing_destroy/d' "thing_destroy"
    breaks 's/thing_destroy(thing \*thing)/thing_destroy(thing *thing, int how)/' "parameter 2 of type 'int' was added"
    breaks 's/^kind thing_kind/double thing_kind/' 'return type changed'
}

@test "a member that moves, has another type, or makes a struct larger breaks callers" {
    breaks 's/char second;/bool second;/' "type of 'char second' changed"
    breaks 's/int first; char second;/char second; int first;/' "'int first' offset changed"
    breaks 's/int first;/double new; int first;/' "'char second' offset changed"
    # In the bytes behind the last member, which old callers do not set.
    breaks 's/char second;/char second; char new;/' "'char new'"
    breaks 's/double share;/double share; int new;/' "'int new'"
}

@test "a constant with another value breaks callers" {
    breaks 's/SMALL, LARGE/SMALL, LARGE = 4/' "LARGE"
}

@test "what is new at the end, and what is private, breaks none" {
    holds 's/^answer thing_answer.*;$/&\nint thing_more(void);/; s/^void thing.*}$/&\nint thing_more(void) { return 1; }/'
    [[ "$output" == *'5 functions, 1 of them new' ]]
    holds 's/SMALL, LARGE/SMALL, LARGE, HUGE/'
    holds 's/char second;/char second; double new; char more[9];/'
    holds 's/int number;/char name[40]; double number;/'
}

@test "what own.h declares breaks none, and what moves there does" {
    command -v abidw >/dev/null || skip "no abigail-tools"
    cd "$BATS_FILE_TMPDIR/a library"
    git checkout -q .
    local own=include/conus/own.h
    echo 'typedef struct thing thing;' >"$own"
    sed -n '/^void thing_destroy/p' include/conus/thing.h >>"$own"
    sed -i '/^void thing_destroy/d' include/conus/thing.h
    sed -i 's/"inner\/thing.h"/&\n#include <conus\/own.h>/' library.c
    run scripts/abi HEAD
    [ "$status" -eq 1 ]
    has "thing_destroy"
    git add include
    commit "own.h"
    sed -i 's/thing_destroy(thing \*thing)/thing_destroy(thing *thing, int how)/' "$own" library.c
    run -0 scripts/abi HEAD
    has '3 functions, 0 of them new'
    git checkout -q .
    git reset -q --hard HEAD~
}

@test "libraries of two SOVERSIONs are not compared" {
    changed 's/SOVERSION 0/SOVERSION 1/; /thing_destroy/d'
    [ "$status" -eq 0 ]
    has 'libconus.so.1 is another library than libconus.so.0'
}

@test "the last tag is meant where no commit is named" {
    changed 's/ char second;//'
    run -2 scripts/abi
    has 'there is no tag'
    run -2 scripts/abi nothing
    has 'nothing is no commit'
    git tag v1
    run -1 scripts/abi
    commit 'second is gone'
    git tag v2
    run -0 scripts/abi
    run -1 scripts/abi v1
}
