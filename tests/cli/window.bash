# Shared by the tests of the window: a display without a screen for each file, and a window that takes commands.
setup_file() {
    start_screen 1280x800
}

teardown_file() {
    stop_screen
}

# view ATLAS [OPTION...] <SCRIPT: asserts that it succeeds without a message. The window is small, and drawn in half the
# time of one of 1000x640, unless the test asks for another --size to look at pixels.
# `shot NAME` in a script takes the picture NAME.png of the window once it is fine.
view() {
    need_window
    sed 's/^shot \(.*\)/settle\nscreenshot \1.png/' >script
    [[ " $* " == *" --size "* ]] || set -- "$@" --size 400x256
    run -0 --separate-stderr timeout $HANG "$CONUS" view "$@" --script script --quiet
    ! grep -v '^conus: warning: ' <<<"$stderr" | grep . || { echo "said: $stderr"; return 1; } # --quiet keeps warnings
}

# pixels <<PYTHON: runs it, with numpy, and OpenImageIO as oiio.
pixels() {
    need_pixels
    { printf '%s\n' 'import numpy' 'import OpenImageIO as oiio' && cat; } | /usr/bin/python3 -
}

# live [ATLAS] [OPTION...]: starts a window that does what `tell` says, and waits in between. It is process $child, its
# window $window. Its frames are drawn in a third of the time of those of 1000x640, unless the test asks for another
# --size.
live() {
    need_window
    command -v xdotool >/dev/null || skip "no xdotool"
    [[ " $* " == *" --size "* ]] || set -- "$@" --size 500x320
    mkfifo commands
    exec 4<>commands # to read, too, so that opening it does not block
    background timeout $HANG "$CONUS" view "$@" --script commands --quiet 4>&-
    looks=0
    tell settle
    pass
    wait_until "$child" find_window
}

tell() {
    printf '%s\n' "$@" >&4
}

# leave: ends the script; asserts that all of it was done.
leave() {
    exec 4>&-
    wait "$child"
}

# pass: waits for as many frames as xdotool's events may take.
pass() {
    looks=$((looks + 1))
    tell 'wait 8' "times pass$looks.json"
    wait_until "$child" test -e "pass$looks.json"
}

# look FILTER: whether FILTER of jq is true of the window's session, after the frames that xdotool's events may take.
look() {
    looks=$((looks + 1))
    tell 'wait 8' "save look$looks.json"
    wait_until "$child" test -e "look$looks.json"
    jq -e "$1" "look$looks.json" >/dev/null
}

# find_window: finds the window of process $child.
find_window() {
    window=$(xdotool search --onlyvisible --name '^conus( - .*)?$' 2>/dev/null)
}

# close_window ID: closes it as a window manager does.
close_window() {
    /usr/bin/python3 -B "$BATS_TEST_DIRNAME/x11_client.py" close "$1"
}

# Events, each with the frames that it takes.
# press KEY... and hold_key KEY: a key that a list or a line of text takes has to be down when a frame is drawn.
press() {
    xdotool key --window "$window" "$@"
    pass
}

hold_key() {
    xdotool keydown --window "$window" "$1"
    pass
    xdotool keyup --window "$window" "$1"
    pass
}

enter() {
    hold_key Return
}

typed() {
    xdotool type --window "$window" "$1"
    pass
}

# mouse_to X Y: pixels of the window; mouse WORD...: of xdotool.
mouse_to() {
    xdotool mousemove --window "$window" "$1" "$2"
    pass
}

mouse() {
    xdotool "$@"
    pass
}

click_at() {
    mouse_to "$1" "$2"
    mouse mousedown 1
    mouse mouseup 1
}

# drop PATH...: drops files as a file manager does, on $window, which handles events meanwhile.
drop() {
    local view=$child
    background timeout $HANG /usr/bin/python3 -B "$BATS_TEST_DIRNAME/x11_client.py" drop "$window" "$@" 4>&-
    local dropping=$child
    child=$view
    touch seen.json
    while runs "$dropping"; do
        runs "$view"
        [ ! -e seen.json ] || { rm seen.json; tell 'wait 8' 'times seen.json'; }
        sleep 0.02
    done
    wait "$dropping"
}

# hold_file NAME: programs that open it make the file begun and wait for the file released (hold_open.c).
hold_file() {
    export HOLD_NAME=$1 HOLD_FOLDER=$PWD LD_PRELOAD=$CONUS_HOLD_OPEN
    export ASAN_OPTIONS=${ASAN_OPTIONS-}:verify_asan_link_order=0
}

# hold_mesh: two.atlas.json, an atlas of two files; opening the first waits, and the second is no surface.
hold_mesh() {
    printf 'v 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 9\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n' >first.obj
    echo '<?xml version="1.0"?><GIFTI Version="1.0">' >second.surf.gii
    echo '{"conus_atlas": 1, "areas": [{"file": "first.obj", "label": 1}, {"file": "second.surf.gii", "label": 2}]}' >two.atlas.json
    hold_file first.obj
}
