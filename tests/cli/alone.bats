#!/usr/bin/env bats
# The window as used by somebody without a shell: started without arguments, driven by keys and mouse alone, which
# xdotool sends, without a script, and read by its title.
load helpers
load window

# start: the window without arguments, as $window.
start() {
    background timeout $HANG "$CONUS" view --quiet
    wait_until "$child" find_window
}

# titled TEXT: whether the window has this title.
titled() {
    [ "$(xdotool getwindowname "$window" 2>/dev/null)" = "$1" ]
}

# tries_until CONDITION COMMAND...: repeats commands that may come before the window is ready for them, until the
# condition, a command as text, holds. Each command must be harmless when it is repeated.
tries_until() {
    local condition=$1 looks
    shift
    until eval "$condition"; do
        "$@"
        for ((looks = 0; looks < 500; looks++)); do # longer than a window takes to open, however busy the machine is
            ! eval "$condition" || break
            runs "$child"
            sleep 0.02
        done
        xdotool keyup --window "$window" Return
    done
}

# shows TITLE COMMAND...: repeats commands until the window has this title.
shows() {
    tries_until "titled '$1'" "${@:2}"
}

# enter: the key has to be down when a frame is drawn.
enter() {
    xdotool keydown --window "$window" Return
}

open_slabs() {
    xdotool key --window "$window" Tab ctrl+a
    xdotool type --window "$window" slabs
    enter
}

search_300() {
    xdotool key --window "$window" slash ctrl+a
    xdotool type --window "$window" 300
    enter
}

# settle_keys: waits until the window has taken all events that were sent: it takes them in order, and the last one saves
# the session anew.
settle_keys() {
    rm slabs-session.json
    xdotool key --window "$window" ctrl+s
    wait_until "$child" is_there slabs-session.json
}

# becomes TITLE: whether the window has this title within a second.
becomes() {
    local looks
    for ((looks = 0; looks < 50; looks++)); do
        ! titled "$1" || return 0
        sleep 0.02
    done
    return 1
}

# hold_on TITLE: points at an area and holds the cone there; TITLE is the window's before the brackets. The 3-D pane is
# the first of the middle; the place of the area in it is found by trying. A click more lets the cone go again.
hold_on() {
    local across=0
    while runs "$child"; do
        across=$(((across + 37) % 300))
        xdotool mousemove --window "$window" $((270 + across)) $((120 + 2 * across / 3))
        settle_keys
        becomes "$1 (hit)" || continue
        xdotool click 1
        settle_keys
        ! becomes "$1 (held)" || return 0
        ! jq -e '.frozen == true' slabs-session.json || xdotool click 1
        settle_keys
    done
    return 1
}

open_first() {
    xdotool key --window "$window" 1
}

# save_as: accepts the proposed name.
save_as() {
    xdotool key --window "$window" ctrl+shift+s
    enter
}

# save_figure: accepts the proposed name.
save_figure() {
    xdotool key --window "$window" ctrl+p
    enter
}

# quit: presses Ctrl+Q. On a busy machine the form of figures may have been requested twice and be open again: its field
# takes all keys but Escape, which closes the form.
quit() {
    local looks
    while runs "$child"; do
        xdotool key --window "$window" ctrl+q || : # the window may be gone before the key is released
        for ((looks = 0; looks < 100; looks++)); do
            runs "$child" || break 2
            sleep 0.02
        done
        xdotool keydown --window "$window" Escape || :
        sleep 0.2
        xdotool keyup --window "$window" Escape || :
    done
    wait "$child"
}

# is_whole FILE.png: whether the file is there to its last chunk.
is_whole() {
    tail -c 12 "$1" 2>/dev/null | grep -q IEND
}

is_there() {
    jq -e .objects "$1" >/dev/null 2>&1
}

# seen FILE: a picture of the window once it is fine, with the mouse at its upper edge.
seen() {
    xdotool mousemove --window "$window" 900 5
    tell 'wait 8' settle "screenshot $1"
    wait_until "$child" test -e "$1"
}

@test "a border is dragged and put back, and the pane under the mouse enlarged" {
    conus phantom slabs -o .
    live slabs.nii.gz --size 1000x640
    tell 'pointer wand'
    seen before.png
    mouse_to 48 200
    mouse mousedown 1
    mouse_to 320 200
    mouse mouseup 1
    seen dragged.png
    run -1 conus diff before.png dragged.png
    tell 'panes 320 0 0 0' # the border that the mouse must find: at 320
    seen wanted.png
    conus diff dragged.png wanted.png
    xdotool key --window "$window" backslash
    seen back.png
    conus diff before.png back.png
    # the axial cut is the first of the strip
    mouse_to 630 100
    xdotool key --window "$window" z
    look '.enlarged == "axial"'
    xdotool key --window "$window" z
    look '.enlarged == "none"'
    leave
}

@test "what is searched next takes the place of what was, and Escape closes a form while its name is typed" {
    conus phantom slabs -o .
    live slabs.nii.gz --size 1000x640
    tell 'choose "Slab posterior"'
    look true
    posterior=$(jq -c .crosshair "look$looks.json")
    for word in anterior posterior; do
        press slash
        typed $word
        enter
        pass
        xdotool keyup --window "$window" Return
        look true
        [ $word = posterior ] || [ "$(jq -c .crosshair "look$looks.json")" != "$posterior" ]
    done
    [ "$(jq -c .crosshair "look$looks.json")" = "$posterior" ]
    press ctrl+p
    press Escape
    xdotool key --window "$window" l # for the brain again
    look '.layers == "all"'
    leave
}

@test "areas that pathways leave out are brought back as glass, by a button over the brain" {
    conus phantom slabs -o .
    conus phantom tubes -o .
    live slabs.nii.gz --pathway tubes.nii.gz,threshold=3 --size 1000x640
    click_at 110 39
    look '.look.opacity_of_the_rest == 0.15 and .look.opacities == [[3, 1]]' # the pathway is the third, after two areas
    xdotool key --window "$window" ctrl+z
    look '.look.opacity_of_the_rest == 1 and .look.opacities == []'
    leave
}

# bats test_tags=main
@test "start, open by name, search, save the session, isolate, point, hold, read the name, save a figure, close, start again: all is back" {
    need_window
    command -v xdotool >/dev/null || skip "no xdotool"
    export XDG_STATE_HOME=$PWD/state XDG_DATA_DIRS=$PWD/data HOME=$PWD CONUS_ATLAS_PATH=$PWD/mine
    conus phantom slabs -o mine
    conus phantom sphere -o mine
    mkdir -p data/mricron/templates # so that S, pressed too early, opens no sample
    cp mine/sphere.nii.gz data/mricron/templates/aal.nii.gz
    start
    titled conus
    shows 'conus - slabs.nii.gz' open_slabs
    shows 'conus - slabs.nii.gz - Slab posterior (chosen)' search_300
    tries_until 'is_there slabs-session.json' save_as
    xdotool key --window "$window" i greater # the panels are wider then
    hold_on 'conus - slabs.nii.gz [slabs-session.json] - Slab posterior'
    tries_until 'is_whole figure-1.png' save_figure
    settle_keys
    titled 'conus - slabs.nii.gz [slabs-session.json] - Slab posterior (held)'
    quit
    mv slabs-session.json before.json
    jq -e '.hidden == [1] and .frozen == true and .has_pose == true' before.json
    jq -e '.panels[1] > 384' state/conus/window.json
    # the area read from the title is the one that conus answers for that cone, without hidden areas
    jq -r '.world_from_device | "--origin=\(.[12]),\(.[13]),\(.[14]) --direction=\(-.[8]),\(-.[9]),\(-.[10])"' \
        before.json >axis
    read -ra cone <axis
    conus query slabs "${cone[@]}" --angle "$(jq .angle_deg before.json)" --hide 1 --format tsv --quiet >rows.tsv
    [ "$(awk -F '\t' 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i }
        NR == 2 { print $at["name"] }' rows.tsv)" = 'Slab posterior' ]
    # again, from the start
    cp before.json slabs-session.json
    start
    shows 'conus - slabs.nii.gz [slabs-session.json] - Slab posterior (held)' open_first
    rm slabs-session.json
    xdotool key --window "$window" ctrl+s
    wait_until "$child" is_there slabs-session.json
    quit
    diff before.json slabs-session.json
}
