#!/usr/bin/env bats
# Every command runs once. scripts/test runs this file, and that of refused inputs, with the sanitizers; the files of
# the commands compare the answers without them.
load helpers

setup_file() {
    start_screen 1600x1000
    "$CONUS" phantom brain -o "$BATS_FILE_TMPDIR/brain" 3>&-
}

teardown_file() {
    stop_screen
}

# atlas: nested.nii.gz, a folder of surfaces, a pathway and poses.
atlas() {
    conus phantom nested -o . --size 24
    mkdir surfaces
    ln -s "$BATS_FILE_TMPDIR"/brain/*.gii surfaces
    ln -s "$BATS_FILE_TMPDIR/brain/brain-pathway.nii.gz" pathway.nii.gz
    printf 'time_s\tx\ty\tz\ttx\tty\ttz\n0\t0\t0\t90\t0\t0\t0\n1\t90\t0\t9\t0\t0\t0\n2\t0\t-90\t0\t0\t9\t0\n' >poses.tsv
    aim=(--origin 0,0,90 --toward 0,0,0 --angle 12)
}

@test "phantom, info, atlases, manifest, mesh" {
    for kind in sphere u-shape torus; do
        answers phantom $kind -o $kind --size 24
    done
    atlas
    for format in table json; do
        answers info nested.nii.gz --format $format
        answers info surfaces --format $format
    done
    CONUS_ATLAS_PATH=$PWD answers atlases
    answers manifest surfaces --name small --quiet
    if [ -x "${CONUS%/*}/conus-mesh" ]; then
        answers mesh nested.nii.gz -o meshes --quiet
    fi
}

@test "query, in each format, with each region, and what is written beside it" {
    atlas
    for format in table tsv csv json ndjson; do
        answers query nested.nii.gz --atlas surfaces "${aim[@]}" --layers all --format $format --quiet
    done
    answers query nested.nii.gz --pathway pathway.nii.gz "${aim[@]}" --quiet -o rows.tsv --voxels voxels.tsv \
        --voxels-of all --mask mask.nii.gz
    answers query nested.nii.gz --point 0,0,0 --radius 9 --quiet
    answers query nested.nii.gz --origin 0,0,90 --toward 0,0,0 --radius 4 --aperture square --quiet
    answers query nested.nii.gz --pose poses.tsv --quiet --space lps
    answers verify rows.tsv
    answers cite rows.tsv
    answers cite rows.tsv --format bibtex
    answers diff rows.tsv rows.tsv
}

@test "batch, and its parts joined" {
    atlas
    answers batch nested.nii.gz --poses poses.tsv --threads 2 --block 1 -o rows.tsv --quiet
    answers batch nested.nii.gz --poses poses.tsv --shard 1/2 -o joined.tsv --quiet
    answers batch nested.nii.gz --poses poses.tsv --shard all/2 -o joined.tsv --quiet
    cmp rows.tsv joined.tsv
    answers verify rows.tsv
}

@test "track, sweep, overlap, connect" {
    atlas
    answers track nested.nii.gz --poses poses.tsv --format ndjson --quiet
    answers sweep nested.nii.gz "${aim[@]}" --quiet
    answers sweep nested.nii.gz "${aim[@]}" --jitter 1,1 --samples 16 --quiet
    answers query nested.nii.gz "${aim[@]}" --mask region.nii.gz --quiet -o rows.tsv
    answers overlap nested.nii.gz region.nii.gz --quiet
    answers phantom bundle -o bundle
    answers connect nested.nii.gz --streamlines bundle/bundle.tck --quiet
}

@test "render, by rays and by OpenGL" {
    atlas
    gl render nested.nii.gz --pathway pathway.nii.gz "${aim[@]}" --size 64x48 -o picture.png --quiet
    gl render surfaces "${aim[@]}" --size 64x48 -o picture.exr --quiet
    gl query nested.nii.gz "${aim[@]}" --engine gl --layers all --quiet
    answers diff picture.png picture.png
}

# The scripts of the golden pictures use the panels, the second atlas, the context, the search and the tracked head.
@test "view does what a script says" {
    atlas
    need_window
    conus phantom slabs -o .
    golden=$BATS_TEST_DIRNAME/../golden
    for words in 'window-surfaces surfaces --pathway pathway.nii.gz' 'window-atlases nested.nii.gz --atlas slabs.nii.gz' \
        'window-hidden slabs.nii.gz --context nested.nii.gz' 'window-layers nested.nii.gz' 'window-head nested.nii.gz'; do
        # shellcheck disable=SC2086 # words
        run -0 --separate-stderr timeout $HANG "$CONUS" view ${words#* } --script "$golden/${words%% *}.txt" --size 600x400 --quiet
        [ -z "$stderr" ] || { echo "said: $stderr"; return 1; }
        [ -s "${words%% *}.png" ]
    done
}
