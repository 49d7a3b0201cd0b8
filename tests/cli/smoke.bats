#!/usr/bin/env bats
# Every command but view and mcp runs once. scripts/test runs this file, and that of refused inputs, with the
# sanitizers; the files of the commands compare the answers without them.
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

# of_rows COMMAND: what it is asked, in each of its formats that is not for other programs.
of_rows() {
    case $1 in
    query) echo "nested.nii.gz --atlas surfaces ${aim[*]} --layers all" ;;
    batch) echo "nested.nii.gz --poses poses.tsv" ;;
    track) echo "nested.nii.gz --poses poses.tsv" ;;
    sweep) echo "nested.nii.gz ${aim[*]}" ;;
    overlap) echo "nested.nii.gz region.nii.gz" ;;
    connect) echo "nested.nii.gz --streamlines bundle/bundle.tck" ;;
    plan) echo "nested.nii.gz --poses needles.tsv --reach Core" ;;
    calibrate) echo "--poses trials.csv" ;;
    positions) echo "C3 F4" ;;
    info) echo surfaces ;;
    atlases) echo ;;
    render) echo "surfaces ${aim[*]} --size 64x48 --engine rays -o picture.png" ;;
    mesh) echo "nested.nii.gz -o meshes" ;;
    manifest) echo "surfaces --name small" ;;
    phantom) echo "torus -o torus --size 24" ;;
    diff) echo "rows.tsv rows.tsv" ;;
    verify | cite) echo rows.tsv ;;
    report) echo "rows.tsv -o report" ;;
    pack) echo "nested.nii.gz -o nested.conus" ;;
    page) echo "nested.nii.gz ${aim[*]} --template template.html -o page.html" ;;
    esac
}

@test "every command, in each of its formats" {
    atlas
    answers phantom bundle -o bundle
    printf 'query_id\tx\ty\tz\tdx\tdy\tdz\tfar\na\t0\t0\t90\t0\t0\t-1\t99\n' >needles.tsv
    { echo "x,y,z,dx,dy,dz,aim_x,aim_y,aim_z" && for n in {1..6}; do echo "0,0,0,$((n % 3)),$((n % 2)),-60,0,0,-60"; done; } >trials.csv
    printf '<p><!-- atlas --></p>' >template.html
    answers query nested.nii.gz "${aim[@]}" --mask region.nii.gz --quiet -o rows.tsv
    conus help --json | jq -r '.commands[] | select(.name | IN("view", "mcp") | not) | .name as $command | .options as $options
        | ([$options[] | select(.name == "format") | .choices[] | select(IN("afni", "bids", "spikeglx", "open-ephys", "bep032") | not)
            | "--format \(.)"] | if . == [] then [""] else . end)[]
        | "\($command) \(.)" + if any($options[]; .name == "quiet") then " --quiet" else "" end' >asked
    [ "$(wc -l <asked)" -ge 40 ]
    while read -r command more; do
        [[ $command != mesh || -x ${CONUS%/*}/conus-mesh ]] || continue
        [ "$command" = atlases ] || [ -n "$(of_rows "$command")" ] || { echo "$command: what is it asked?"; return 1; }
        # shellcheck disable=SC2046,SC2086 # words
        CONUS_ATLAS_PATH=$PWD answers $command $(of_rows "$command") $more
    done <asked
    for kind in sphere u-shape; do
        answers phantom $kind -o $kind --size 24
    done
    answers info nested.nii.gz
    answers info nested.nii.gz --format json
}

@test "query, with each region, and what is written beside it" {
    atlas
    answers query nested.nii.gz --pathway pathway.nii.gz "${aim[@]}" --quiet -o rows.tsv --voxels voxels.tsv \
        --voxels-of all --mask mask.nii.gz
    answers query nested.nii.gz --point 0,0,0 --radius 9 --quiet
    answers query nested.nii.gz --origin 0,0,90 --toward 0,0,0 --radius 4 --aperture square --quiet
    answers query nested.nii.gz --pose poses.tsv --quiet --space lps
    answers verify rows.tsv
}

@test "batch, and its parts joined" {
    atlas
    answers batch nested.nii.gz --poses poses.tsv --threads 2 --block 1 -o rows.tsv --quiet
    answers batch nested.nii.gz --poses poses.tsv --shard 1/2 -o joined.tsv --quiet
    answers batch nested.nii.gz --poses poses.tsv --shard all/2 -o joined.tsv --quiet
    cmp rows.tsv joined.tsv
    answers verify rows.tsv
}

@test "sweep of errors" {
    atlas
    answers sweep nested.nii.gz "${aim[@]}" --jitter 1,1 --samples 16 --quiet
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
