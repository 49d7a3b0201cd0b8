#!/usr/bin/env bats
# A grey volume is no atlas: every command that takes an atlas says so in one line, before anything else.
load helpers

# The context of the brain phantom: 0 to 46000, smooth; areas would have three in four neighbours equal.
grey() {
    conus phantom brain -o brain
    cp brain/brain-context.nii.gz t1.nii.gz
    printf 'time_s\tx\ty\tz\ttx\tty\ttz\n0\t120\t20\t40\t0\t-18\t10\n' >poses.tsv
}

# refuses ARGUMENT...: asserts one line with advice, and that nothing is left behind.
refuses() {
    fails 3 't1.nii.gz: looks like an image, not like labels' "$@"
    [[ "$stderr" == *'conus atlases'*--context*--pathway*--labels-anyway* ]]
    nothing_left t1.nii.gz poses.tsv
}

@test "every command refuses a grey volume" {
    local aim='--origin 120,20,40 --toward 0,-18,10 --angle 30'
    grey
    rm -r brain
    refuses info t1.nii.gz
    # shellcheck disable=SC2086 # words
    refuses query t1.nii.gz $aim -o rows.tsv
    # shellcheck disable=SC2086
    refuses sweep t1.nii.gz $aim
    # shellcheck disable=SC2086
    refuses render t1.nii.gz $aim -o picture.png
    refuses batch t1.nii.gz --poses poses.tsv -o rows.tsv
    refuses track t1.nii.gz --poses poses.tsv
    refuses mesh t1.nii.gz -o meshes
}

@test "--labels-anyway takes it" {
    local aim='--origin 120,20,40 --toward 0,-18,10 --angle 5 --resolution 4 --quiet'
    grey
    run -0 --separate-stderr "$CONUS" info t1.nii.gz --labels-anyway --format tsv
    [ "$(grep -c ^area <<<"$output")" -gt 40000 ]
    run -0 --separate-stderr "$CONUS" info t1.nii.gz --labels-anyway
    [[ "$output" == *'t1.nii.gz: looks like an image, not like labels'*'its grey values are listed as areas'* ]]
    # shellcheck disable=SC2086
    answers query t1.nii.gz $aim --labels-anyway --format tsv
    [ "$(cell kind 1)" = area ]
    printf '{"conus_atlas": 1, "parcellation": "t1.nii.gz"}' >scene.atlas.json
    fails 3 'scene.atlas.json: parcellation: t1.nii.gz: looks like an image' info scene.atlas.json
    # shellcheck disable=SC2086
    answers query scene.atlas.json $aim --labels-anyway --format tsv
    run -0 --separate-stderr "$CONUS" batch t1.nii.gz --poses poses.tsv --angle 5 --labels-anyway -q
    [ "$(cell kind 1)" = area ]
}

@test "it is a context and a pathway" {
    grey
    run -0 --separate-stderr "$CONUS" info brain/brain.atlas.json --pathway t1.nii.gz,threshold=30000
    has 'Pathway 2: t1'
}
