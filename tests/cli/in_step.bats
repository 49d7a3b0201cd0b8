#!/usr/bin/env bats
# 3-D picture, cuts, names, list and status line are of one answer, whatever is done.
load helpers
load window

# random_changes COUNT SEED: so many beside a bundle, where areas are left out of 3-D.
random_changes() {
    conus phantom slabs -o .
    conus phantom bundle -o .
    live slabs.nii.gz --streamlines bundle.tck --size 640x400
    /usr/bin/python3 -B "$BATS_TEST_DIRNAME/in_step.py" "$1" "$2" "$window" "$child" >&4
    leave
}

@test "after none of 40 random actions a picture is of another answer than the list" {
    random_changes 40 7
}

@test "after none of 500 random actions a picture is of another answer than the list" {
    [ -n "$CONUS_TEST_LONG" ] || skip "only with CONUS_TEST_LONG=1"
    random_changes 500 102
}

@test "a state that cannot be written ends the script" {
    need_window
    conus phantom slabs -o .
    printf 'state no/where.json\nscreenshot late.png\n' >script
    fails 3 'script:1: state FILE.json: the file cannot be written' view slabs.nii.gz --script script --quiet
    [ ! -e late.png ]
}
