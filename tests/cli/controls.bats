#!/usr/bin/env bats
# The controls of the window: it shows what conus query and conus sweep print with the same options.
load helpers
load window

# nested.nii.gz: a ball of three shells, with a tree over them, tree.tsv.
nested() {
    conus phantom nested -o .
    printf 'index\tname\tabbreviation\tparent_id\n1\tOuter\tO\t20\n300\tInner\tI\t20\n' >tree.tsv
    printf '20\tShell\tS\t40\n4000000001\tCore\tC\t40\n40\tBall\tB\tn/a\n' >>tree.tsv
}

# Options of conus query and of the window's command `ask`, each used for five poses. Behind a colon: options of the
# atlas.
questions=(
    ''
    '--layers=all --order=depth'
    '--range=20,70'
    '--layers=all --level=2 --range=10,75.5'
    '--level=Shell --score=nearness'
    '--aperture=square --resolution=24'
    '--sampling=slices --slices=40 --slice-fraction=0.5'
    '--radius=4 --layers=all'
    '--engine=gl --resolution=9'
    ':Inner --layers=all'
)

@test "the list is what conus query answers, for 50 poses and with all options" {
    need_all
    nested
    awk 'BEGIN { srand(7); print "x\ty\tz\ttx\tty\ttz"; for (i = 0; i < 50; i++) {
        a = 6.2831853 * rand(); z = 80 * rand() - 40
        printf "%.3f\t%.3f\t%.3f\t%.3f\t%.3f\t%.3f\n", 70 * cos(a), 70 * sin(a), z, 20 * rand() - 10, 20 * rand() - 10, 20 * rand() - 10
    } }' >poses.tsv
    local k row
    i=0
    for k in "${!questions[@]}"; do
        [[ ${questions[k]} != :* ]] || printf 'choose Inner\nkey i\n'
        echo "ask ${questions[k]#:Inner}"
        for row in 1 2 3 4 5; do
            i=$((i + 1))
            sed -n "$((i + 1))s/^/aim /p" poses.tsv
            printf 'results view%02d.tsv\n' $i
        done
    done | { echo 'angle 14'; cat; } >commands
    view nested.nii.gz --labels tree.tsv <commands
    i=0 # bats may have left a value in i
    for k in "${!questions[@]}"; do
        { head -1 poses.tsv; sed -n "$((i + 2)),$((i + 6))p" poses.tsv; } >five.tsv
        local options=(--angle 14)
        [[ ${questions[k]} != *--radius* ]] || options=()
        [[ ${questions[k]} != :* ]] || options+=(--only Inner)
        # shellcheck disable=SC2086 # several words
        conus query nested.nii.gz --labels tree.tsv --pose five.tsv "${options[@]}" ${questions[k]#:Inner} --format tsv -q |
            cut -f 2- >wanted
        for row in 1 2 3 4 5; do
            tail -n +$((row == 1 ? 1 : 2)) "$(printf 'view%02d.tsv' $((i + row)))" | cut -f 2-
        done | diff - wanted
        i=$((i + 5))
        [ "$(wc -l <wanted)" -gt 6 ] # the poses hit something
    done
    [ $i -eq 50 ]
}

@test "level, range and order are changed by keys, kept in sessions and taken back" {
    nested
    view nested.nii.gz --labels tree.tsv <<'END'
angle 14
aim 60 3 2 0 0 0
key space
key l
results first.tsv
key f7
key f7
key f4
key f4
key f5
key f3
key y
results asked.tsv
save asked.json
key ctrl+z
key ctrl+z
key ctrl+z
key ctrl+z
key ctrl+z
key ctrl+z
key ctrl+z
results back.tsv
open asked.json
results opened.tsv
save opened.json
END
    at='--origin 60,3,2 --toward 0,0,0 --angle 14 --layers all'
    # shellcheck disable=SC2086 # several words
    conus query nested.nii.gz --labels tree.tsv $at --format tsv -q | diff first.tsv -
    # shellcheck disable=SC2086
    conus query nested.nii.gz --labels tree.tsv $at --level 2 --range 1,50 --order depth --format tsv -q | diff asked.tsv -
    diff first.tsv back.tsv
    diff asked.tsv opened.tsv
    diff asked.json opened.json
    jq -e '.level == "2" and .range_mm == [1, 50] and .order == "depth"' asked.json
}

@test "the keys of the wand move it, and change nothing of what is asked" {
    conus phantom slabs -o .
    {
        echo 'aim 60 3 2 0 0 0'
        echo 'pointer wand'
        echo 'save start.json'
        for key in w s a d e q up down left right; do
            printf 'key %s\nsave %s.json\n' "$key" "$key"
        done
    } >presses
    view slabs.nii.gz <presses
    before=start
    for key in w s a d e q up down left right; do
        diff <(jq -S 'del(.world_from_device)' start.json) <(jq -S 'del(.world_from_device)' "$key.json")
        [ "$(jq -c .world_from_device "$before.json")" != "$(jq -c .world_from_device "$key.json")" ]
        before=$key
    done
}

@test "above the list it says which depths count, at which level, and what is hidden" {
    nested
    view nested.nii.gz --labels tree.tsv --size 1000x640 <<'END'
aim 60 3 2 0 0 0
shot plain
ask --range=0,1000
shot depths
ask --level=1
shot level
ask
choose Inner
key h
shot hidden
key v
shot shown
END
    pixels <<'END'
# texts of the accent's colour, 9cc7ff, or of that of trouble, ffaf55, right above the list, below the panel's title
def written(name, colour=[156, 199, 255]):
    top = oiio.ImageBuf(name + ".png").get_pixels(oiio.UINT8)[30:60, 700:, :3].astype(int)
    return (numpy.abs(top - colour).max(axis=2) < 40).sum()
counts = [written(name) for name in ("plain", "depths", "level")]
assert counts[0] == 0 and counts[1] > 20 and counts[2] > 5, counts
counts = [written(name, [255, 175, 85]) for name in ("plain", "hidden", "shown")]
assert counts[0] == counts[2] == 0 and counts[1] > 20, counts
END
}

@test "texts of the panels have the theme's colours, and pale ones its opacity" {
    panels=$BATS_TEST_DIRNAME/../../apps/viewer/panes
    run -1 grep -nE 'ui_(text_coloured|tint)\(\(ui_colour\)|\? \(ui_colour\)\{2|ui_dim\([^)]*[0-9]\.' "$panels"/panel_*.c
    # no tip names another widget's key
    run -1 grep -nE 'comma and full stop|\( and \) change|B changes it|< and > the nearer' "$panels"/panel_*.c
}

@test "sweep and jitter are what conus sweep prints, of each atlas and with all options" {
    need_all
    nested
    conus phantom slabs -o .
    view nested.nii.gz --labels tree.tsv --atlas slabs.nii.gz <<'END'
aim 60 3 2 0 0 0
angle 14
sweep 3 40 4.7
settle
study sweep.tsv
ask --layers=all --range=10,75 --level=2
settle
study deep.tsv
jitter 2 1.5 64
settle
study jitter.tsv
ask --radius=3
settle
study cylinder.tsv
ask
key n
choose "Slab anterior"
key i
settle
study only.tsv
jitter off
sweep 3 40 4.7
key 1
settle
study ray.tsv
END
    local at=(nested.nii.gz --labels tree.tsv --atlas slabs.nii.gz --origin=60,3,2 --toward=0,0,0 --format tsv -q)
    conus sweep "${at[@]}" --angles 3:40:4.7 | diff - sweep.tsv
    conus sweep "${at[@]}" --angles 3:40:4.7 --layers all --range 10,75 --level 2 | diff - deep.tsv
    conus sweep "${at[@]}" --angle 14 --layers all --range 10,75 --level 2 --jitter 2,1.5 --samples 64 | diff - jitter.tsv
    conus sweep "${at[@]}" --radius 3 --jitter 2,1.5 --samples 64 | diff - cylinder.tsv
    conus sweep slabs.nii.gz --origin=60,3,2 --toward=0,0,0 --angle 14 --jitter 2,1.5 --samples 64 \
        --only 'Slab anterior' --format tsv -q | tail -n +2 | cut -f 2- >wanted
    grep '^1.slabs' only.tsv | cut -f 3- | diff - wanted
    conus sweep "${at[@]}" --angles 3:40:4.7 --resolution 1 | grep nested | diff - <(grep nested ray.tsv)
}

@test "a study is begun by a key, and saved by a key" {
    nested
    view nested.nii.gz --labels tree.tsv <<'END'
aim 60 3 2 0 0 0
key space
key j
settle
key ctrl+j
key enter
wait 2
key j
settle
key ctrl+j
key enter
wait 2
save jitter.json
key ctrl+z
save sweep.json
END
    jq -e '.study == "jitter"' jitter.json
    jq -e '.study == "sweep"' sweep.json
    local saved=(conus-*.tsv)
    [ ${#saved[@]} -eq 2 ]
    conus sweep nested.nii.gz --labels tree.tsv --origin=60,3,2 --toward=0,0,0 --angles 2:40:2 --format tsv -q >sweep.tsv
    conus sweep nested.nii.gz --labels tree.tsv --origin=60,3,2 --toward=0,0,0 --angle 5 --jitter 2,1.5 --format tsv -q >jitter.tsv
    cat sweep.tsv jitter.tsv | sort | diff - <(sort "${saved[@]}")
}
