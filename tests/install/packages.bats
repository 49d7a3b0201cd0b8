#!/usr/bin/env bats
# packaging/debian against the files of `cmake --install`. scripts/package builds the packages.
load ../cli/helpers
: "${CONUS_BUILD:?is the folder of the build}"

DEBIAN=$BATS_TEST_DIRNAME/../../packaging/debian

setup_file() {
    cmake --install "$CONUS_BUILD" --prefix "$BATS_FILE_TMPDIR/usr" >"$BATS_FILE_TMPDIR/log"
    local folder # Debian has libraries in a folder of the machine's architecture
    mkdir "$BATS_FILE_TMPDIR/usr/lib/x"
    folder=$(dirname "$(find "$BATS_FILE_TMPDIR/usr" -name libconus.so)")
    mv "$folder"/libconus* "$folder/cmake" "$folder/pkgconfig" "$BATS_FILE_TMPDIR/usr/lib/x"
}

# claimed: the files in the lists of packages and in that of files in none; each as often as it is listed. Only the web
# page's files are not below usr: they come from another build.
claimed() {
    local pattern
    sed -n '/^usr/p' "$DEBIAN"/*.install "$DEBIAN/not-installed" | while read -r pattern _; do
        # shellcheck disable=SC2086 # a pattern
        (cd "$BATS_FILE_TMPDIR" && find $pattern ! -type d)
    done
}

@test "each installed file is in one package, or is listed as in none" {
    [ -x "$BATS_FILE_TMPDIR/usr/bin/conus-view" ] &&
        [ -x "$BATS_FILE_TMPDIR/usr/bin/conus-mesh" ] && [ -x "$BATS_FILE_TMPDIR/usr/bin/conus-hdf5" ] &&
        [ -d "$BATS_FILE_TMPDIR/usr/lib/python3" ] ||
        skip "not all programs are built"
    claimed | sort >claimed
    (cd "$BATS_FILE_TMPDIR" && find usr ! -type d) | sort >installed
    diff installed claimed
}

@test "each package has a list, and each list a package" {
    sed -n 's/^Package: //p' "$DEBIAN/control" | sort >packages
    find "$DEBIAN" -name '*.install' -printf '%f\n' | sed 's/\.install$//' | sort | diff packages -
}

@test "the symbols are those of the library" {
    nm -D --defined-only "$BATS_FILE_TMPDIR/usr/lib/x/libconus.so" | sed -n 's/.* [TBDRV] //p' | sort >exported
    sed -nE 's/^ (\(optional\))?(.*)@Base .*/\2/p' "$DEBIAN/libconus0.symbols" | sort | diff exported -
}

@test "what own.h declares is optional, and the programs need the library of their own version" {
    local headers=$BATS_TEST_DIRNAME/../../include/conus
    sed -nE 's/^ \(optional\)(.*)@Base .*/\1/p' "$DEBIAN/libconus0.symbols" | sort >optional
    grep -hE '^CONUS_(API|CHECKED) ' "$headers/own.h" | grep -oE 'conus_[a-z0-9_]+\(' | tr -d '(' | sort | diff optional -
    for package in conus conus-view; do
        sed -n "/^Package: $package\$/,/^\$/p" "$DEBIAN/control" | grep -F 'libconus0 (= ${binary:Version})'
    done
}

@test "the version is that of the program" {
    [ "$(sed -n '1s/.*(\(.*\)-[0-9]*).*/\1/p' "$DEBIAN/changelog")" = "$("$CONUS" --version | cut -d ' ' -f 2)" ]
}
