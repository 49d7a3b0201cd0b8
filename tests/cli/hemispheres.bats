#!/usr/bin/env bats
# Left and right areas in the open window: split, merged, and one side only.
load helpers
load window

# bands.nii: 48 x 48 x 24 mm. On top a left and a right area, below four bands across x = 0.
bands() {
    PYTHONPATH="$BATS_TEST_DIRNAME" python3 -B -c 'import nifti; nifti.write("bands.nii", (24, 24, 12), "B",
        lambda i, j, k: 0 if i in (0, 23) else 1 + (i > 11) if k > 7 else 3 + j // 6, edge=2)'
    printf 'index\tname\n1\tTop_L\n2\tTop_R\n3\tThree\n4\tFour\n5\tFive\n6\tSix\n' >names.tsv
}

# Five poses from all sides towards them.
poses() {
    awk 'BEGIN { srand(11); print "x\ty\tz\ttx\tty\ttz"; for (i = 0; i < 5; i++) {
        a = 6.2831853 * rand()
        printf "%.3f\t%.3f\t%.3f\t%.3f\t%.3f\t%.3f\n", 70 * cos(a), 70 * sin(a), 60 * rand() - 20, 8 * rand() - 4, 30 * rand() - 15, 10 * rand()
    } }' >poses.tsv
}

# aims NAME: lines of a script for the poses and the files NAME1.tsv to NAME5.tsv.
aims() {
    local row
    for row in 1 2 3 4 5; do
        sed -n "$((row + 1))s/^/aim /p" poses.tsv
        printf 'results %s%d.tsv\n' "$1" $row
    done
}

# answers_are NAME [OPTION...]: asserts that those files are the answers of conus query with the options.
answers_are() {
    local name=$1 row
    shift
    conus query bands.nii --labels names.tsv --pose poses.tsv --angle 25 --format tsv -q "$@" | cut -f 2- >wanted
    [ "$(wc -l <wanted)" -gt 10 ] # the poses hit something
    for row in 1 2 3 4 5; do
        tail -n +$((row == 1 ? 1 : 2)) "$name$row.tsv" | cut -f 2-
    done | diff - wanted
}

@test "a left and a right area of one name are told apart in tables and legends" {
    bands
    printf 'index\tname\themisphere\n1\tTop\tL\n2\tTop\tR\n3\tThree\tL\n4\tFour\tR\n5\tFive\tL\n6\tSix\tR\n' >sides.tsv
    local cone=(bands.nii --labels sides.tsv --origin=0,0,60 --toward=0,0,0 --angle 20)
    answers query "${cone[@]}" -q
    grep -Eq '^ +[12]  Top +left 1 ' <<<"$output"
    grep -Eq '^ +[12]  Top +right 2 ' <<<"$output"
    gl render "${cone[@]}" --legend right --size 400x300 -o two.svg -q
    grep -q '>left Top</text>' two.svg
    grep -q '>right Top</text>' two.svg
    not grep -q '>Top</text>' two.svg
}

@test "lists are what conus query answers with the same hemispheres, forth and back" {
    bands
    poses
    {
        echo 'angle 25'
        aims asis
        echo 'hemispheres split'
        aims split
        echo 'side left'
        aims left
        echo 'side right'
        aims right
        printf 'side both\nhemispheres merged\n'
        aims merged
        printf 'second on\nsecond angle 25\nsecond aim %s\n' "$(sed -n 2p poses.tsv)"
        printf 'hemispheres split\nsecond results second.tsv\nask --layers=all\n'
        aims all
        printf 'key f8\nsettle\nkey f8\nsettle\n' # from split over merged to as is
        aims back
        echo 'save back.json'
    } >commands
    view bands.nii --labels names.tsv <commands
    answers_are asis
    answers_are split --hemispheres split
    answers_are left --hemispheres split --hide 'Top_R,Three right,Four right,Five right,Six right'
    answers_are right --hemispheres split --hide 'Top_L,Three left,Four left,Five left,Six left'
    answers_are merged --hemispheres merged
    diff second.tsv split1.tsv
    answers_are all --hemispheres split --layers all
    answers_are back --layers all
    jq -e '.opened.options | map(select(startswith("--hemispheres"))) == []' back.json
}

@test "sessions keep them, and open the atlas so" {
    need_window
    bands
    poses
    { printf 'angle 25\nhemispheres split\nchoose "Five left"\nkey h\nopacity "Six right" 0.5\n'; aims one
      printf 'aim -3 -90 -5 -3 0 -5\nkey enter\nsave one.json\n'; } | view bands.nii --labels names.tsv
    jq -e '.opened.options[-1] == "--hemispheres=split" and .objects == 10' one.json
    { echo 'save two.json'; aims two; printf 'hemispheres as-is\nsave three.json\nhemispheres split\nsave four.json\n'; } | view --session one.json
    answers_are two --hemispheres split --hide 'Five left'
    diff <(jq 'del(.atlas)' one.json) <(jq 'del(.atlas)' two.json) # the second one has a folder now
    # only one half was hidden, or less opaque: the whole is neither; split again, each half is as the whole is
    jq -e '.hidden == [] and .look.opacities == [] and .objects == 6' three.json
    jq -e '.hidden == [] and .look.opacities == []' four.json
    # a confirmed area keeps its name where there is no such area any more
    jq -e '.confirmed[0] | .object == 0 and .name == "Three left"' three.json
    echo 'save five.json' | view --session three.json
    diff <(jq .confirmed three.json) <(jq .confirmed five.json)
}

@test "undo loads the atlas as it was, and redo again" {
    bands
    poses
    aim="aim $(sed -n 2p poses.tsv)"
    view bands.nii --labels names.tsv --hemispheres merged <<END
angle 25
$aim
key space
choose Three
key h
wait 1
save 1.json
hemispheres split
wait 1
save 2.json
side left
wait 1
save 3.json
key ctrl+z
settle
save 2b.json
key ctrl+z
settle
save 1b.json
key ctrl+y
settle
save 2c.json
key ctrl+shift+z
settle
save 3b.json
key f8
key ctrl+z
settle
save 3c.json
key f8
key f8
settle
save 3d.json
key ctrl+z
key ctrl+z
settle
key ctrl+z
key f8
settle
wait 1
key ctrl+z
settle
save 2d.json
END
    for pair in '1 1b' '2 2b' '2 2c' '3 3b' '3 3c' '2 2d'; do
        # shellcheck disable=SC2086 # two words
        set -- $pair
        # what is chosen is no step of undo, and is nothing after a while without that area
        diff <(jq 'del(.chosen)' "$1.json") <(jq 'del(.chosen)' "$2.json")
    done
    jq -e '.objects == 7 and .hidden == [3]' 1.json
    # the whole was hidden, so both halves are: Top_L, Top_R, four left halves, four right ones
    jq -e '.objects == 10 and .hidden == [3, 7]' 2.json
    jq -e '.hidden == [2, 3, 7, 8, 9, 10]' 3.json
    jq -e '.objects == 6 and .opened.options[-1] == "--labels=\(.opened.folder)/names.tsv"' 3d.json
}

@test "files that are added and other hemispheres leave each other alone" {
    need_window
    bands
    poses
    python3 "$BATS_TEST_DIRNAME/tck.py" arc.tck -9,-9,3 9,-9,3 -- -9,9,3 9,9,3
    # a file is added to the split atlas and is there when it is merged; it is removed and added when merged, and is
    # there as is
    { printf '%s\n' 'angle 25' 'ask --layers=all' 'key f8' 'drop arc.tck'; aims split
      printf '%s\n' 'choose "Five left"' 'key h' 'choose arc' 'key h' 'opacity arc 0.5' 'orbit 33 12' 'save split.json' \
          'key f8' 'save merged.json' 'take-out arc.tck'; aims without
      printf '%s\n' 'drop arc.tck'; aims merged
      printf '%s\n' 'key f8'; aims asis
      printf '%s\n' 'key ctrl+z' 'save back.json'; } | view bands.nii --labels names.tsv
    answers_are split --layers all --hemispheres split --streamlines arc.tck
    grep -q arc split1.tsv
    answers_are without --layers all --hemispheres merged
    answers_are merged --layers all --hemispheres merged --streamlines arc.tck
    answers_are asis --layers all --streamlines arc.tck
    jq -e '.objects == 11 and .hidden == [5, 11] and .look.opacities == [[11, 0.5]]' split.json
    jq -e '.objects == 8 and .hidden == [8] and .look.opacities == [[8, 0.5]] and .opened.added[0].objects == [8]' merged.json
    diff <(jq .orbit split.json) <(jq .orbit back.json)
    jq -e '[.opened.options[] | split("/")[-1]] == ["names.tsv", "arc.tck", "--hemispheres=merged"]' back.json
}

# The load stops after the window has opened the file once.
@test "Escape while it loads leaves all as it was" {
    bands
    poses
    touch released
    hold_file bands.nii
    live bands.nii --labels names.tsv 2>said
    tell 'angle 25' "aim $(sed -n 2p poses.tsv)" 'results old.tsv' 'save old.json'
    look '.objects == 6'
    rm released begun
    tell 'key f8'
    wait_until "$child" test -e begun
    xdotool key --window "$window" Escape
    touch released
    tell 'results new.tsv' 'save new.json'
    look '.objects == 6'
    leave
    diff old.tsv new.tsv
    diff old.json new.json
    [ ! -s said ]
}

@test "files that changed or are gone are no reason to lose what is open" {
    need_window
    bands
    mv names.tsv bands.tsv
    cp -p bands.nii kept.nii
    printf '%s\n' $'angle 25\naim 3 90 2 3 0 2' 'results 0.tsv' 'until go1' 'hemispheres split' 'results 1.tsv' \
        'until go2' 'hemispheres split' 'results 2.tsv' 'until go3' 'hemispheres split' 'results 3.tsv' \
        'until go4' 'hemispheres split' 'results 4.tsv' >script
    cp -p bands.tsv kept.tsv
    background timeout $HANG "$CONUS" view bands.nii --script script --quiet --size 400x256 2>said
    wait_until "$child" test -e 0.tsv
    touch -d 2020-01-01 bands.nii # it may be another file
    touch go1
    wait_until "$child" test -e 1.tsv
    rm bands.nii
    touch go2
    wait_until "$child" test -e 2.tsv
    cp -p kept.nii bands.nii # the file is back, but the table beside it is another one
    sed -i 's/Four/Fourth/' bands.tsv
    touch go3
    wait_until "$child" test -e 3.tsv
    cp -p kept.tsv bands.tsv # everything is back
    touch go4
    wait "$child"
    diff 0.tsv 1.tsv
    diff 0.tsv 2.tsv
    diff 0.tsv 3.tsv
    conus query bands.nii --origin 3,90,2 --toward 3,0,2 --angle 25 --hemispheres split --format tsv -q | diff 4.tsv -
    diff said - <<'END'
conus: bands.nii: not as when it was opened, so all stays as it is; open the atlas anew
conus: bands.nii: cannot open: No such file or directory, and no installed atlas has that name ('conus atlases' lists them)
conus: bands.tsv: not as when it was opened, so all stays as it is; open the atlas anew
END
}

@test "what the atlas was opened with stays: a manifest, pathways, streamlines, a context, a second atlas, a space" {
    need_window
    bands
    conus phantom sphere -o . --size 20
    conus phantom bundle -o .
    printf '{"conus_atlas": 1, "parcellation": {"file": "bands.nii", "labels": "names.tsv"}, "context": "sphere.nii.gz"}' >bands.atlas.json
    cp bands.nii other.nii
    cp names.tsv other.tsv
    local with=(bands.atlas.json --pathway sphere.nii.gz,threshold=1,name=Ball --streamlines bundle.tck --space lps)
    local aim=(--origin 3,90,2 --toward 3,0,2 --angle 40 --layers all)
    printf '%s\n' 'ask --layers=all' 'angle 40' 'aim 3 90 2 3 0 2' 'grey 0 2' 'haze Ball own' 'hemispheres split' \
        'results one.tsv' 'save one.json' | view "${with[@]}" --atlas other.nii
    conus query "${with[@]}" --atlas other.nii "${aim[@]}" --hemispheres split --format tsv -q | diff one.tsv -
    grep -q Ball one.tsv
    jq -e '.look.grey == [0, 2] and .look.pathways == [[11, "own"]] and .drawn == 1' one.json
    # a level that does not exist any more is dropped
    printf 'index\tname\tparent_id\n1\tTop_L\t9\n2\tTop_R\t9\n3\tThree\t9\n4\tFour\t9\n5\tFive\t9\n6\tSix\t9\n9\tAll\tn/a\n' >tree.tsv
    printf '%s\n' 'ask --layers=all --level=All' 'angle 40' 'aim 3 90 2 3 0 2' 'hemispheres split' 'results kept.tsv' \
        'ask "--level=All left" --layers=all' 'hemispheres as-is' 'results gone.tsv' | view bands.nii --labels tree.tsv
    conus query bands.nii --labels tree.tsv "${aim[@]}" --hemispheres split --level All --format tsv -q | diff kept.tsv -
    conus query bands.nii --labels tree.tsv "${aim[@]}" --format tsv -q | diff gone.tsv -
}
