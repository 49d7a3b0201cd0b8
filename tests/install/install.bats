#!/usr/bin/env bats
# cmake --install: programs, library and headers work where they are installed, also after a move, and are removed
# again.
load ../cli/helpers
: "${CONUS_BUILD:?is the folder of the build}"

SOURCES=$BATS_TEST_DIRNAME

setup_file() {
    cmake --install "$CONUS_BUILD" --prefix "$BATS_FILE_TMPDIR/a prefix" >"$BATS_FILE_TMPDIR/log"
    MOVED="$BATS_FILE_TMPDIR/moved elsewhere"
    mv "$BATS_FILE_TMPDIR/a prefix" "$MOVED"
    LIBRARIES=$(dirname "$(find "$MOVED" -name libconus.so)")
    ATLAS=$(realpath "$SOURCES/../../data-samples/u-shape.nii.gz")
    # The consumers' question, answered by the program of the build: 0.7 radians are 40.107 degrees.
    EXPECTED="$("$CONUS" --version | cut -d ' ' -f 2) $("$CONUS" query "$ATLAS" --origin 0,0,60 --toward 0,0,0 \
        --angle 40.107045 --format tsv | sed -n '2p' | cut -f 4)"
    export MOVED LIBRARIES ATLAS EXPECTED
}

# needs_plain_build: other projects' programs cannot be linked with a library that has sanitizers.
needs_plain_build() {
    [ -z "${CONUS_SANITIZE-}" ] || skip "the library is built with sanitizers"
}

# consumer_answers PROGRAM: asserts that it answers as conus itself does.
consumer_answers() {
    run -0 "$1" "$ATLAS"
    [ "$output" = "$EXPECTED" ] || { echo "wrote: $output"; return 1; }
}

@test "the installed program runs from where it was moved to" {
    run -0 "$MOVED/bin/conus" --version
    [ "$output" = "$(conus --version)" ]
    ldd "$MOVED/bin/conus" >libraries
    not grep 'not found' libraries
    grep -qF "$MOVED" libraries
}

@test "each installed program answers --version and --help, and refuses another option" {
    export ASAN_OPTIONS=detect_leaks=0 # OpenMPI does not free everything
    local programs=0
    for program in "$MOVED"/bin/*; do
        run -0 --separate-stderr "$program" --version
        [ "$output" = "$(conus --version)" ] && [ -z "$stderr" ] || { echo "$program: $output$stderr"; return 1; }
        for word in --help -h; do
            run -0 --separate-stderr "$program" $word
            [[ $'\n'"$output" == *$'\n'"usage: conus"* ]] && [ -z "$stderr" ] ||
                { echo "$program: $output$stderr"; return 1; }
        done
        run -2 --separate-stderr "$program" --nonsense
        [ -z "$output" ] && [ -n "$stderr" ] || { echo "$program: $output$stderr"; return 1; }
        programs=$((programs + 1))
    done
    [ "$programs" -eq "$(find "$MOVED/bin" -type f -perm /111 | wc -l)" ] && [ "$programs" -ge 1 ]
}

@test "a program that is not installed is named, with its package" {
    cp -r "$MOVED" alone
    rm -f alone/bin/conus-*
    sphere --size 16
    wanted_of_mesh='the program conus-mesh is not installed (Debian package conus-mesh)'
    run -3 --separate-stderr env -u CONUS_MESH PATH=/nowhere "$PWD/alone/bin/conus" mesh sphere.nii.gz -o out
    check_message "$wanted_of_mesh"
    run -3 --separate-stderr env CONUS_MESH=/nowhere/mesh "$PWD/alone/bin/conus" mesh sphere.nii.gz -o out
    check_message 'CONUS_MESH: /nowhere/mesh is no program; conus-mesh is needed (Debian package conus-mesh)'
    run -3 --separate-stderr env PATH=/nowhere "$PWD/alone/bin/conus" view sphere.nii.gz
    check_message 'the window, conus-view, is not installed (Debian package conus-view), and the page'
    mkdir closed # a folder in the place of a program
    printf 'no program' >closed/conus-view
    run -3 --separate-stderr env PATH="$PWD/closed" "$PWD/alone/bin/conus" view sphere.nii.gz
    check_message 'conus view: the program conus-view cannot be started: Permission denied'
}

@test "no program of the tree has a path of the build folder" {
    needs_plain_build
    for program in "$MOVED"/bin/*; do
        readelf -d "$program" >dynamic
        sed -nE 's/.*R(UN)?PATH.*\[(.*)\]/\2/p' dynamic >paths
        not grep -v '^\$ORIGIN/' paths
    done
}

@test "a project finds the library by find_package, shared and static, in C and C++" {
    needs_plain_build
    cmake -S "$SOURCES/consumer" -B built -G Ninja -DCMAKE_PREFIX_PATH="$MOVED" >log || { cat log; return 1; }
    cmake --build built >log || { cat log; return 1; }
    for program in conus_c conus_cpp conus_static_c conus_static_cpp; do
        consumer_answers "built/$program"
    done
    ldd built/conus_c | grep -q libconus.so.0
    ldd built/conus_static_c >libraries
    not grep libconus libraries
}

@test "find_package refuses another minor version" {
    needs_plain_build
    sed 's/conus 0.1/conus 0.2/' "$SOURCES/consumer/CMakeLists.txt" >CMakeLists.txt
    cp "$SOURCES"/consumer/consumer.* .
    run ! cmake -S . -B built -G Ninja -DCMAKE_PREFIX_PATH="$MOVED"
    [[ "$output" == *'version: 0.1.0'* ]]
}

@test "a program is built by pkg-config, shared and static" {
    needs_plain_build
    # A shell splits pkg-config's output, which escapes the spaces of paths for eval.
    export PKG_CONFIG_PATH="$LIBRARIES/pkgconfig"
    eval "cc -o shared '$SOURCES/consumer/consumer.c' $(pkg-config --cflags --libs conus)"
    eval "cc -o static '$SOURCES/consumer/consumer.c' $(pkg-config --cflags conus) '$LIBRARIES/libconus.a' \
        $(pkg-config --static --libs conus | sed 's/-lconus//')"
    LD_LIBRARY_PATH="$LIBRARIES" consumer_answers ./shared
    consumer_answers ./static
    ldd ./static >libraries
    not grep libconus libraries
    [ "$(pkg-config --modversion conus)" = "$(conus --version | cut -d ' ' -f 2)" ]
}

@test "the Python package finds the library in the moved tree" {
    needs_plain_build
    [ -e "$CONUS_BUILD/python/conus/_declarations.py" ] || skip "the Python package is not built"
    export PYTHONPATH=$MOVED/lib/python3/dist-packages
    run -0 /usr/bin/python3 -c "import conus; print(conus.__version__, conus.load('$ATLAS').select(
        (0, 0, 60), toward=(0, 0, 0), angle=40.107045)[0].name, conus.__file__)"
    [ "$output" = "$EXPECTED $PYTHONPATH/conus/__init__.py" ]
    not grep -rF "$CONUS_BUILD" "$PYTHONPATH"
}

@test "the shared library has the functions of the headers and of own.h, which is not installed, and no other" {
    nm -D --defined-only "$LIBRARIES/libconus.so" | sed -n 's/.* [TBDRV] //p' | sort >exported
    sed -n 's/.*\b\(conus_[a-z0-9_]*\)(.*/\1/p' "$MOVED"/include/conus/*.h >mentioned
    [ ! -e "$MOVED/include/conus/own.h" ]
    grep -hoE '^CONUS_(API|CHECKED) .*' "$MOVED"/include/conus/*.h "$BATS_TEST_DIRNAME/../../include/conus/own.h" | grep -oE 'conus_[a-z0-9_]+\(' | tr -d '(' | sort -u >declared
    [ "$(wc -l <declared)" -gt 100 ]
    diff declared exported
    [ "$(readelf -d "$LIBRARIES/libconus.so" | sed -n 's/.*SONAME.*\[\(.*\)\]/\1/p')" = libconus.so.0 ]
}

@test "a tree holds what its component says" {
    for component in runtime devel doc; do
        cmake --install "$CONUS_BUILD" --prefix "$PWD/$component" --component "$component" >log
    done
    [ -x runtime/bin/conus ]
    [ -e runtime/share/man/man1/conus-query.1 ]
    [ -e runtime/share/bash-completion/completions/conus ]
    [ -e runtime/share/zsh/site-functions/_conus ]
    [ -e runtime/share/fish/vendor_completions.d/conus.fish ]
    [ -e runtime/share/conus/matlab/conus.m ]
    [ -e runtime/share/conus/boutiques/conus-query.json ]
    [ -x runtime/share/conus/slicer/ConusQuery.py ]
    [ ! -e runtime/include ]
    [ -z "$(find runtime -name '*.a' -o -name '*.pc' -o -name libconus.so)" ]
    [ -e devel/include/conus/conus.h ]
    [ -n "$(find devel -name libconus.a)" ]
    [ ! -e devel/bin ]
    [ -z "$(find runtime devel -name '*.py' ! -path '*/conus/slicer/*')" ] # the package for Python is a component of its own
    [ -e doc/share/doc/conus/docs/commands.md ]
    for example in "$SOURCES"/../../examples/*.{c,py}; do
        cmp "$example" "doc/share/doc/conus/examples/${example##*/}"
    done
}

# check_uninstall TOP: asserts that everything installed there, and compiled by Python since, is removed.
check_uninstall() {
    [ -x "$1/bin/conus" ]
    [ ! -d "$1/lib/python3" ] || /usr/bin/python3 -m compileall -q "$1/lib/python3"
    cmake --build "$CONUS_BUILD" --target uninstall >log
    find . ! -type d ! -name log >../left
    diff /dev/null ../left
}

@test "uninstall removes every file, where paths have spaces, also below DESTDIR" {
    cmake --install "$CONUS_BUILD" --prefix "$PWD/a prefix" >log
    check_uninstall "a prefix"
    export DESTDIR="$PWD/a stage"
    cmake --install "$CONUS_BUILD" --prefix "/opt/a prefix" >log
    check_uninstall "a stage/opt/a prefix"
}

@test "desktop, MIME and AppStream files hold" {
    [ -e "$MOVED/bin/conus-view" ] || skip "conus-view is not built"
    local share=$MOVED/share
    grep -qx 'Exec=conus-view %f' "$share/applications/conus-view.desktop"
    [ -e "$share/icons/hicolor/scalable/apps/conus-view.svg" ]
    for type in $(sed -n 's/^MimeType=//p' "$share/applications/conus-view.desktop" | tr ';' ' '); do
        [ "$type" = inode/directory ] || grep -qF "type=\"$type\"" "$share/mime/packages/conus.xml"
    done
    ! command -v desktop-file-validate || desktop-file-validate "$share/applications/conus-view.desktop"
    if command -v appstreamcli; then
        appstreamcli validate --no-net "$share/metainfo/conus-view.metainfo.xml" >said || true
        not grep '^E:' said
    fi
    command -v xmllint || skip "there is no xmllint"
    xmllint --noout "$share"/mime/packages/conus.xml "$share"/metainfo/*.xml "$share"/icons/hicolor/scalable/apps/*.svg
}
