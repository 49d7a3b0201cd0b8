#!/usr/bin/env bats
# Pictures of the window that somebody has looked at: tests/golden/window-*.txt are scripts, window-*.png their
# pictures. CONUS_WRITE_GOLDEN=1 writes those anew that differ (scripts/golden).
load helpers

GOLDEN=$BATS_TEST_DIRNAME/../golden

# The screen is larger than the windows, so that the mouse, in its middle, is not over them.
setup_file() {
    start_screen 2400x1600
}

teardown_file() {
    stop_screen
}

# looks_as NAME ATLAS [OPTION...]: asserts that the script NAME.txt shows NAME.png. A pixel differs if a channel does by
# more than 0.05 of white, in linear light; one pixel in 1000 may, since drivers differ at edges.
looks_as() {
    local name=$1 differing
    shift
    need_window
    run -0 --separate-stderr timeout $HANG "$CONUS" view "$@" --script "$GOLDEN/$name.txt" --size 600x400 --scale 0.62 --quiet
    [ -z "$stderr" ] || { echo "said: $stderr"; return 1; }
    run --separate-stderr "$CONUS" diff --tolerance 0.05 "$name.png" "$GOLDEN/$name.png"
    differing=${output%% *}
    [ "${differing:-240000}" -gt 240 ] || return 0
    [ -z "${CONUS_WRITE_GOLDEN:-}" ] || { cp "$name.png" "$GOLDEN/$name.png"; return; }
    echo "$output$stderr"
    cp "$name.png" "${TMPDIR:-/tmp}/$name-differs.png" && echo "it is ${TMPDIR:-/tmp}/$name-differs.png"
    return 1
}

@test "surfaces and a pathway" {
    conus phantom brain -o brain
    mkdir surfaces
    mv brain/*.gii surfaces
    looks_as window-surfaces surfaces --pathway brain/brain-pathway.nii.gz
}

@test "voxels in all layers" {
    conus phantom nested -o .
    looks_as window-layers nested.nii.gz
}

@test "hidden, confirmed and searched over a context" {
    conus phantom slabs -o .
    sphere
    looks_as window-hidden slabs.nii.gz --context sphere.nii.gz
}

@test "two atlases, the second drawn" {
    conus phantom nested -o .
    conus phantom slabs -o .
    looks_as window-atlases nested.nii.gz --atlas slabs.nii.gz
}

@test "the last view of a head that is lost" {
    conus phantom u-shape -o .
    looks_as window-head u-shape.nii.gz
}

@test "the start page" {
    export ASAN_OPTIONS=detect_leaks=0 # Mesa forgets 128 bytes of a driver that is unloaded before anything was drawn
    export XDG_STATE_HOME=$PWD XDG_DATA_DIRS=/none HOME=$PWD
    mkdir conus
    cat >conus/recent.json <<'END'
{"conus_recent": 1, "atlases": ["/data/atlases/Schaefer2018_400Parcels_7Networks_order_FSLMNI152_1mm.nii.gz",
 "/data/allen/annotation_25.nii.gz,volume=2", "/data/subjects/bert/surf", "/data/\u001b[31mred\n\u202eback.nii"]}
END
    looks_as window-start
}
