#!/usr/bin/env bats
# conus view without ATLAS: the start page, and the ways from it to an atlas and from one atlas to the next.
load helpers
load window

# No test finds atlases of this computer or of its user.
own_folders() {
    export XDG_STATE_HOME=$PWD/state XDG_DATA_DIRS=$PWD/data HOME=$PWD/home
}

# page COMMAND...: runs the page alone. Mesa does not free 240 bytes of a driver that is unloaded before anything was
# drawn.
page() {
    ASAN_OPTIONS=detect_leaks=0 timeout $HANG "$CONUS" view --quiet "$@"
}

# remembers PATH...: whether these are the recent files.
remembers() {
    [ -e state/conus/recent.json ] || return 1
    [ "$(jq -c . state/conus/recent.json)" = "$(jq -cn '{conus_recent: 1, atlases: $ARGS.positional}' --args "$@")" ]
}

# left_open PATH...: writes the list of recent files.
left_open() {
    mkdir -p state/conus
    jq -n '{conus_recent: 1, atlases: $ARGS.positional}' --args "$@" >state/conus/recent.json
}

# queried ATLAS [OPTION...]: the answer of conus for the pose of the tests.
queried() {
    conus query "$@" --origin 3,90,2 --toward 3,0,2 --angle 20 --format tsv --quiet
}

AIM=$'angle 20\naim 3 90 2 3 0 2'

# bats test_tags=main
@test "a path that is typed opens as if it had been given" {
    own_folders
    conus phantom nested -o .
    conus phantom slabs -o home
    view <<END
type nested.nii.gz
key enter
$AIM
results typed.tsv
save typed.json
END
    queried nested.nii.gz | diff typed.tsv -
    [ "$(jq -r .atlas typed.json)" = nested.nii.gz ]
    view <<END
type ~/slabs.nii.gz
key enter
$AIM
results home.tsv
END
    queried home/slabs.nii.gz | diff home.tsv -
}

@test "the name of an installed atlas opens it, and its path is remembered" {
    own_folders
    conus phantom nested -o .
    mkdir -p data/mricron/templates
    mv nested.nii.gz data/mricron/templates/nest_atlas.nii.gz
    mv nested.tsv data/mricron/templates/nest_atlas.tsv
    view nest-atlas <<END
$AIM
results first.tsv
save first.json
END
    queried nest_atlas | diff first.tsv -
    [ "$(jq -r .atlas first.json)" = "$PWD/data/mricron/templates/nest_atlas.nii.gz" ]
}

@test "options hold for the first atlas that is opened, and for no other" {
    own_folders
    conus phantom nested -o .
    conus phantom slabs -o .
    conus phantom sphere -o .
    printf 'index\tname\n1\tone\n2\ttwo\n3\tthree\n' >names.tsv
    view --labels names.tsv --hide one --context sphere.nii.gz --atlas sphere.nii.gz <<END
drop nested.nii.gz
$AIM
results first.tsv
key c
key ctrl+r
drop slabs.nii.gz
key r
$AIM
results second.tsv
save second.json
picture second.png 64 64
END
    diff <(queried nested.nii.gz --labels names.tsv --hide one | tail -n +2) \
        <(awk -F '\t' '$2 == "nested"' first.tsv | cut -f 1,3-)
    diff <(queried sphere.nii.gz | tail -n +2) <(awk -F '\t' '$2 == "sphere"' first.tsv | cut -f 1,3-)
    queried slabs.nii.gz | diff second.tsv -
    # other settings of the view stay: colours, and which side is shown where
    jq -e '.safe_colours and .radiological == true' second.json
    printf '%s\npicture alone.png 64 64\n' "$AIM" | view slabs.nii.gz --safe-colours
    conus diff second.png alone.png
}

@test "the page lists what was opened, and an atlas of this computer" {
    own_folders
    conus phantom nested -o .
    conus phantom slabs -o 'a folder'
    mkdir -p data/mricron/templates
    cp nested.nii.gz data/mricron/templates/aal.nii.gz
    left_open "$PWD/gone.nii.gz" "$PWD/a folder/slabs.nii.gz"
    view <<END
key 2
$AIM
results second.tsv
END
    queried 'a folder/slabs.nii.gz' | diff second.tsv -
    # scripts see the list, and leave it as it is
    remembers "$PWD/gone.nii.gz" "$PWD/a folder/slabs.nii.gz"
    printf 'key 3\nsave found.json\n' | view
    [ "$(jq -r .atlas found.json)" = "$PWD/data/mricron/templates/aal.nii.gz" ]
}

# open_from FOLDER ATLAS: opens a window, waits until the atlas is remembered, and closes it.
open_from() {
    background env -C "$1" timeout $HANG "$CONUS" view "$2" --quiet
    wait_until "$child" find_window
    wait_until "$child" remembers "${@:3}"
    close_window "$window"
    wait "$child"
}

@test "what is typed searches the installed atlases, and S writes and opens the sample" {
    own_folders
    export CONUS_ATLAS_PATH=$PWD/mine
    conus phantom slabs -o mine
    view <<<$'type sla\nkey enter\nsave found.json'
    [ "$(jq -r .atlas found.json)" = "$PWD/mine/slabs.nii.gz" ]
    view <<<$'key s\nsave found.json' # without the AAL atlas it is a phantom
    [ "$(jq -r '.atlas, .objects' found.json)" = "$PWD/state/conus/sample/brain.atlas.json"$'\n12' ]
}

@test "what is opened is remembered, newest first, eight of them; a damaged list is none" {
    need_window
    own_folders
    sphere --size 16
    left_open /1 /2 /3 /4 /5 /6 /7 /8
    mkdir below
    cp sphere.* below
    open_from below ./sphere.nii.gz "$PWD/below/sphere.nii.gz" /1 /2 /3 /4 /5 /6 /7
    printf '{"conus_recent": 1, "atlases": ["/1"' >state/conus/recent.json
    run -3 --separate-stderr page --script <(echo key 1)
    check_message 'key KEY is needed'
    open_from . sphere.nii.gz "$PWD/sphere.nii.gz"
}

@test "what cannot be opened is said on the page, and another can be tried" {
    need_window
    own_folders
    conus phantom slabs -o .
    echo nonsense >none.nii
    cat >script <<END
wait 3
screenshot before.png
type none.nii
wait 3
screenshot typed.png
key enter
wait 3
screenshot said.png
type slabs.nii.gz
key enter
$AIM
results after.tsv
END
    run -0 --separate-stderr timeout $HANG "$CONUS" view --script script --quiet --size 640x480
    check_message 'none.nii: '
    queried slabs.nii.gz | diff after.tsv -
    run -1 conus diff before.png typed.png
    run -1 conus diff typed.png said.png
}

@test "a session opens its atlas as it was opened" {
    own_folders
    conus phantom slabs -o elsewhere
    conus phantom sphere -o .
    conus phantom u-shape -o .
    printf 'index\tname\n1\tone\n300\ttwo\n' >names.tsv
    view elsewhere/slabs.nii.gz --labels names.tsv --context sphere.nii.gz --hemispheres split --atlas u-shape.nii.gz \
        --space lps <<END
$AIM
choose "two left"
key h
results left.tsv
save left.json
picture left.png 64 64
END
    jq -e --arg here "$PWD" '.opened.options == ["--labels=\($here)/names.tsv", "--context=\($here)/sphere.nii.gz",
        "--hemispheres=split", "--atlas=\($here)/u-shape.nii.gz", "--space=lps"] and .opened.folder == $here' left.json
    mkdir below
    printf 'results %s/again.tsv\npicture %s/again.png 64 64\n' "$PWD" "$PWD" >script # from another folder
    run -0 --separate-stderr env -C below timeout $HANG "$CONUS" view ../left.json --script ../script --quiet --size 400x256
    [ -z "$stderr" ]
    diff left.tsv again.tsv
    conus diff left.png again.png
    # a dropped session is opened as well, and is the same again
    printf 'drop left.json\nsave dropped.json\nresults again.tsv\n' | view elsewhere/slabs.nii.gz
    diff left.tsv again.tsv
    local names='(.atlas, .further_atlases[].atlas) |= sub(".*/"; "")' # which have paths now
    diff <(jq "$names" left.json) <(jq "$names" dropped.json)
    # the command line has priority over the session
    printf 'index\tname\n1\tuno\n300\tdue\n' >other.tsv
    printf 'results again.tsv\n' | view --session left.json --labels other.tsv
    grep -q uno again.tsv
    not grep -q one again.tsv
}

@test "a session finds an atlas that was moved, or asks for it" {
    need_window
    own_folders
    conus phantom slabs -o .
    sphere --size 16
    printf '%s\nsave left.json\nresults left.tsv\n' "$AIM" | view slabs.nii.gz
    # a renamed file is found by its checksum; without a table beside it the names are others
    mkdir moved
    mv slabs.nii.gz moved/renamed.nii.gz
    mv slabs.tsv moved/renamed.tsv
    cp left.json moved
    printf 'results again.tsv\n' | view --session moved/left.json
    diff left.tsv again.tsv
    # nowhere: it says so, and the next atlas is the session's if it fits
    printf 'drop sphere.nii.gz\ndrop moved/renamed.nii.gz\nresults again.tsv\n' >script
    run -0 --separate-stderr timeout $HANG "$CONUS" view --session left.json --script script --quiet
    [[ ${stderr_lines[0]} == "conus: left.json: its atlas is not found: $PWD/slabs.nii.gz. "* ]]
    [ "${stderr_lines[1]}" = 'conus: left.json: of an atlas with 2 areas and pathways, this one has 1' ]
    [ ${#stderr_lines[@]} -eq 2 ]
    diff left.tsv again.tsv
    # a session that does not fit leaves the open atlas, with its name and its history
    printf 'save sphere.json\n' | view sphere.nii.gz
    jq '.objects = 7' left.json >moved/bad.json
    printf 'angle 9\nwait 1\nangle 11\nwait 1\ndrop moved/bad.json\nkey ctrl+z\nkey ctrl+s\n' >script
    run -0 --separate-stderr timeout $HANG "$CONUS" view --session sphere.json --script script --quiet
    check_message 'of an atlas with 7 areas and pathways, this one has 2'
    [ "$(jq .angle_deg sphere.json)" = 9 ]
}

# bats test_tags=main
@test "an ATLAS that cannot be opened leads to the page" {
    need_window
    own_folders
    command -v xdotool >/dev/null || skip "no xdotool"
    sphere --size 16
    echo nonsense >none.nii
    # --only applies to none.nii: the sphere would fail with it
    background timeout $HANG "$CONUS" view none.nii --only Nobody --quiet 2>said
    wait_until "$child" grep -q '^conus: none.nii: ' said
    wait_until "$child" find_window # files are read while the window opens
    local view=$child code=0
    timeout $HANG /usr/bin/python3 -B "$BATS_TEST_DIRNAME/x11_client.py" drop "$window" "$PWD/sphere.nii.gz"
    either() { has_lines 2 said || remembers "$PWD/sphere.nii.gz"; }
    wait_until "$view" either
    close_window "$window"
    wait "$view" || code=$?
    [ $code -eq 3 ]
    [ "$(wc -l <said)" -eq 1 ]
}

@test "what is dropped on the page opens" {
    own_folders
    conus phantom brain -o .
    mkdir 'surfaces of 100% ä'
    mv brain-0[12]-*.gii 'surfaces of 100% ä'
    conus phantom nested -o .
    live
    drop "$PWD/surfaces of 100% ä" # GIFTI surfaces, whose names are their labels
    tell "$AIM" 'results folder.tsv'
    look true
    [ "$(jq -r .atlas "look$looks.json")" = "$PWD/surfaces of 100% ä" ]
    queried 'surfaces of 100% ä' | diff folder.tsv -
    # also on an open atlas, which the new one replaces; several files at once are refused
    drop "$PWD/nested.nii.gz" "$PWD/nested.tsv"
    look '.objects == 2'
    drop "$PWD/nested.nii.gz"
    tell 'key r' "$AIM" 'results dropped.tsv'
    look '.objects == 3'
    leave
    queried nested.nii.gz | diff dropped.tsv -
}

@test "an atlas stays open when what is dropped on it is none" {
    own_folders
    conus phantom slabs -o .
    echo nonsense >none.nii
    live slabs.nii.gz 2>said
    tell "$AIM" 'choose "Slab anterior"' 'key h' 'save before.json'
    drop "$PWD/none.nii"
    tell 'save after.json' 'results after.tsv' 'picture after.png 64 64'
    leave
    diff before.json after.json
    queried slabs.nii.gz --hide 'Slab anterior' | diff after.tsv -
    [ "$(wc -l <said)" -eq 1 ]
    grep -q '^conus: .*/none.nii: ' said
}

@test "another atlas is added or replaces, once the question was answered" {
    own_folders
    conus phantom slabs -o .
    sphere --size 16
    view slabs.nii.gz <<END
$AIM
key enter
save before.json
drop sphere.nii.gz
save asked.json
key escape
save after.json
drop sphere.nii.gz
key a
results both.tsv
key n
save both.json
drop before.json
key escape
take-out sphere.nii.gz
results first.tsv
save first.json
drop sphere.nii.gz
key r
$AIM
results opened.tsv
save opened.json
END
    diff before.json asked.json
    diff before.json after.json
    queried slabs.nii.gz --atlas sphere.nii.gz | diff both.tsv -
    queried slabs.nii.gz | diff first.tsv -
    queried sphere.nii.gz | diff opened.tsv -
    # settings and confirmed objects stay, until another atlas replaces this one
    jq -e '.drawn == 2 and (.further_atlases | length) == 1 and (.opened.options | length) == 1' both.json
    jq -e --slurpfile was before.json '(.confirmed | map(del(.atlas))) == $was[0].confirmed and .world_from_device == $was[0].world_from_device' both.json
    jq -e 'has("drawn") or has("further_atlases") | not' first.json
    diff <(jq -S 'del(.confirmed)' before.json) <(jq -S 'del(.confirmed)' first.json)
    jq -e '(.confirmed | length) == 1' first.json
    jq -e '.objects == 1 and .confirmed == []' opened.json
    # a session of both opens both
    printf 'results again.tsv\n' | view both.json
    diff both.tsv again.tsv
}

@test "of several atlases each keeps what was set and confirmed in it when another one goes" {
    own_folders
    conus phantom slabs -o .
    conus phantom nested -o .
    sphere --size 16
    view slabs.nii.gz --atlas nested.nii.gz <<END
$AIM
key n
key enter
choose Outer
key h
atlas sphere.nii.gz
key n
save three.json
take-out nested.nii.gz
save two.json
results two.tsv
END
    jq -e '.drawn == 3 and .confirmed[0].atlas == 2 and .further_atlases[0].hidden == [1] and
        .further_atlases[1].hidden == []' three.json
    jq -e '.drawn == 2 and .confirmed == [] and .further_atlases[0].hidden == []' two.json
    queried slabs.nii.gz --atlas sphere.nii.gz | diff two.tsv -
}

@test "what is dropped while another is being loaded is opened instead" {
    own_folders
    conus phantom slabs -o .
    hold_mesh
    live 2>said
    drop "$PWD/two.atlas.json"
    wait_until "$child" test -e begun
    drop "$PWD/slabs.nii.gz"
    touch released
    look '.objects == 2 and (.atlas | endswith("/slabs.nii.gz"))'
    leave
    [ ! -s said ]
}

@test "keys and mouse: a path is typed, an entry clicked, and Ctrl+N comes back to the page" {
    own_folders
    conus phantom slabs -o .
    conus phantom nested -o .
    left_open "$PWD/nested.nii.gz"
    live --size 1000x640
    typed "$PWD/slabs.nii.gz" # without Tab: the first letter goes to the line, too
    xdotool keydown --window "$window" Return # it has to be down when a frame is drawn
    look '.objects == 2'
    xdotool keyup --window "$window" Return
    tell "$AIM" 'save before.json'
    press ctrl+n
    press v # typed, not a key of the brain
    hold_key Escape
    press Escape # and the page
    tell 'save after.json'
    pass
    diff before.json after.json
    [ -z "$(find . -name 'conus-2*')" ] # O alone saves the session
    press ctrl+n
    local down=100
    until look '.objects == 3'; do # click down the page until the entry is hit
        down=$((down + 12))
        [ $down -lt 400 ]
        mouse_to 200 $down
        mouse click 1
        xdotool key --window "$window" r # an answer, not a key of the page
    done
    leave
}

@test "Ctrl+O opens a file by keys and mouse, and Escape comes back" {
    own_folders
    conus phantom nested -o a
    conus phantom slabs -o 'a/b c'
    conus phantom sphere -o .
    mkdir only
    mv a/nested.nii.gz only
    rm a/nested.* # so that the key Down means the same when it repeats
    live sphere.nii.gz --size 1000x640
    press ctrl+o
    typed a/ # behind the folder in which conus was started
    for key in Down Return; do # b c
        hold_key $key
    done
    typed nii
    enter
    xdotool key --window "$window" r
    look '.objects == 2 and (.atlas | endswith("/a/b c/slabs.nii.gz"))'
    tell "$AIM" 'save before.json'
    press ctrl+o
    hold_key Escape
    tell 'save after.json'
    pass
    diff before.json after.json
    press ctrl+o
    # by the mouse: click down the list of one file until it is hit
    local down=140
    until look '.objects == 3'; do
        xdotool keyup --window "$window" Return
        down=$((down + 14))
        [ $down -lt 300 ]
        tell "type $PWD/only/"
        mouse_to 700 $down
        mouse click 1
        xdotool keydown --window "$window" Return
        pass
        xdotool key --window "$window" r
    done
    leave
}

@test "closed, the page ends without a word" {
    own_folders
    need_window
    command -v xdotool >/dev/null || skip "no xdotool"
    background page >said 2>&1
    wait_until "$child" find_window
    close_window "$window"
    wait "$child"
    [ ! -s said ] || { cat said; return 1; }
    [ -e state/conus/window.json ]
    [ ! -e state/conus/recent.json ]
}

@test "help and man page say that there may be no ATLAS" {
    local view=${CONUS%/*}/conus-view
    [ -x "$view" ] || skip "conus-view is not built"
    run -0 "$CONUS" view --help
    [ "${lines[0]}" = 'usage: conus view [ATLAS] [options]' ]
    CONUS=$view "$BATS_TEST_DIRNAME/../../scripts/pages" pages
    grep -qx 'conus\\-view \[ATLAS\] \[options\]' pages/conus-view.1
    run -0 "$CONUS" batch --help
    [[ "${lines[0]}" == 'usage: conus batch ATLAS --poses FILE'* ]]
}

# More of the page is light where there is a picture of the first atlas of the lists; of a script none is kept.
@test "the page shows the sample's brain" {
    own_folders
    mkdir -p data/mricron/templates
    conus phantom nested -o .
    printf 'shot without\n' | view --size 1000x640
    cp nested.nii.gz data/mricron/templates/aal.nii.gz
    printf 'shot with\n' | view --size 1000x640
    [ ! -e state/conus/pictures/aal.nii.gz ]
    pixels <<'PYTHON'
light = [(oiio.ImageBuf(name).get_pixels()[..., :3].min(2) > 0.35).mean() for name in ('without.png', 'with.png')]
assert light[0] + 0.004 < light[1] < 0.3, light
PYTHON
}
