#!/usr/bin/env bats
# Widgets that take the keyboard, the pages for files, and the values that a session restores.
load helpers
load window

@test "a whole path that is pasted takes the place of the folder in the line" {
    conus phantom slabs -o "$PWD/else where"
    conus phantom sphere -o .
    live sphere.nii.gz
    press ctrl+o
    typed "$PWD/else where/slabs.nii.gz"
    enter
    xdotool key --window "$window" r # the answer of the dialog
    look '.objects == 2 and (.atlas | endswith("/else where/slabs.nii.gz"))'
    leave
}

# bats test_tags=main
@test "what cannot be opened leaves the page with its path, no letter acts, and a second path takes its place" {
    conus phantom sphere -o .
    conus phantom slabs -o .
    echo 'no atlas' >bad.nii
    live sphere.nii.gz
    for path in "$PWD/bad.nii" "$PWD/none.nii"; do
        press ctrl+o
        typed "$path"
        enter
        xdotool type --window "$window" lhop
        look '.objects == 1 and .layers == "visible" and .hidden == []'
        [ -z "$(ls conus-* 2>/dev/null)" ]
        hold_key Escape
    done
    press ctrl+o
    typed "$PWD/bad.nii"
    enter
    typed "$PWD/slabs.nii.gz" # it replaces the one that failed
    enter
    xdotool key --window "$window" r
    look '.objects == 2'
    leave
}

@test "escape ends a search before it clears the cone" {
    conus phantom slabs -o .
    view slabs.nii.gz <<'END'
aim 60 3 2 0 0 0
search slab
choose "Slab anterior"
key escape
save searched.json
key escape
save cleared.json
END
    jq -e '.has_pose == true' searched.json
    jq -e '.has_pose == false' cleared.json
}

@test "no key writes a file before its place is chosen" {
    conus phantom slabs -o .
    view slabs.nii.gz <<'END'
aim 60 3 2 0 0 0
key ctrl+s
key escape
key o
key escape
key p
key escape
key ctrl+e
key escape
sweep 2 10 4
settle
key ctrl+j
key escape
wait 4
END
    run ls conus-* slabs-session.json
    [ "$status" -ne 0 ]
    mkdir here
    view slabs.nii.gz <<END
key p
type $PWD/here/shot
key enter
wait 2
key o
key enter
wait 2
END
    [ -e here/shot.png ]
    [ "$(ls here/conus-2*.json | wc -l)" -eq 1 ] # the chosen folder is proposed
}

@test "cuts are where they were when a session is opened again, though they follow the tip" {
    conus phantom slabs -o .
    view slabs.nii.gz <<'END'
key g
aim 60 3 2 0 0 0
key space
crosshair 5 1 2
save left.json
crosshair 9 9 9
open left.json
save again.json
END
    jq -e '.follow == "tip" and .crosshair == [5, 1, 2]' left.json
    diff left.json again.json
    view slabs.nii.gz --session left.json <<<'save started.json'
    jq -e '.crosshair == [5, 1, 2]' started.json
}

@test "an open list of choices takes all keys, and a tab shows what is its own" {
    conus phantom slabs -o .
    live slabs.nii.gz --size 1280x800
    tell 'aim 60 3 2 0 0 0' 'key space' 'orbit 10 0'
    look '.frozen == true and .layers == "visible"'
    orbit=$(jq -c .orbit "look$looks.json")
    click_at 1150 369 # Point with
    press Escape
    look '.has_pose == true and .frozen == true'
    click_at 1150 369
    xdotool key --window "$window" h
    press Down
    press Return
    look ".pointer == \"wand\" and .confirmed == [] and .hidden == [] and .orbit == $orbit"
    xdotool key --window "$window" l # the list is closed: keys belong to the brain again
    look '.layers == "all"'
    click_at 1093 423 # first hits: of the wand's question, which has no start
    look '.layers == "visible"'
    click_at 1123 481 # the tab Look
    click_at 919 562  # Outlines
    look '.outlines == false'
    leave
}

@test "the brain alone and back, panels that fold, and standard views" {
    conus phantom slabs -o .
    view slabs.nii.gz --size 1000x640 <<'END'
key ctrl+1
save left.json
key ctrl+2
save right.json
key ctrl+3
save front.json
key ctrl+5
save top.json
background white
key f
settle
save alone.json
screenshot alone.png
key f
shot back
save back.json
END
    close_to() { jq -e ".orbit[4:6] | (.[0] - $2 | fabs) < 1e-9 and (.[1] - $3 | fabs) < 0.1" "$1.json"; }
    close_to left 1.5707963267948966 0 # towards the head's left
    close_to right -1.5707963267948966 0
    close_to front 0 0
    close_to top 3.141592653589793 1.5
    jq -e .layout.brain_alone alone.json
    jq -e '.layout.brain_alone == false and .layout.left == "as-at-first"' back.json
    pixels <<'END'
alone, back = (oiio.ImageBuf(f"{name}.png").get_pixels(oiio.UINT8)[..., :3].astype(int) for name in ("alone", "back"))
for y, x in (320, 3), (320, 984), (636, 500): # no panels, no cuts, no line below
    assert alone[y, x].min() > 200 and back[y, x].max() < 60, (y, x)
END
}

@test "at 1280 x 800 the brain has nearly half of the window" {
    conus phantom sphere -o .
    view sphere.nii.gz --size 1280x800 <<'END'
background white
shot window
END
    pixels <<'END'
row = oiio.ImageBuf("window.png").get_pixels(oiio.UINT8)[740, :658, :3].astype(int) # up to the cuts
column = oiio.ImageBuf("window.png").get_pixels(oiio.UINT8)[:, 51, :3].astype(int)
wide, high = ((line.min(axis=1) > 100).sum() for line in (row, column)) # beside the ball and all words
assert wide * high > 0.45 * 1280 * 800, (wide, high)
END
}

# At scale 2 the rail takes 96 pixels and the panel 480; of the 704 between them the cuts have 704 - 506 = 198. A ball's
# box is a cube of 40 voxels: it fills 0.92 of the shorter side, 182. Five voxels off its middle it has 38 across: 173.
@test "a cut fills its pane to 92 %, and letters at its sides can be read on the brain" {
    conus phantom sphere -o .
    view sphere.nii.gz --size 1280x800 --scale 2 <<'END'
crosshair 0 0 0
shot window
END
    pixels <<'END'
pixels = oiio.ImageBuf("window.png").get_pixels(oiio.UINT8)[..., :3].astype(int)
for top in 0, 251, 502:
    pane = pixels[top:top + 248, 603:603 + 196]
    middle = pane[124 - 12:124 + 12] # the rows of the letters
    for letter in middle[:, 6:30], middle[:, -30:-6]:
        assert letter.max() > 200 and letter.min() < 40, "no letter on its shade"
    row = pane[99] # above the letters and the crosshair's line
    ball = numpy.flatnonzero(row.max(axis=1) > 60)
    assert abs(ball.ptp() - 173) < 4, (top, ball.ptp())
END
}

@test "a session that is opened again says so, and no more what was said before" {
    conus phantom slabs -o .
    view slabs.nii.gz <<'END'
save slabs.json
key escape
shot cleared
open slabs.json
shot opened
END
    pixels <<'END'
cleared, opened = (oiio.ImageBuf(f"{name}.png").get_pixels(oiio.UINT8)[-24:, :, :3].astype(int)
                   for name in ("cleared", "opened"))
said = [(abs(line - (156, 199, 255)).max(axis=2) < 40).any(axis=0).sum() for line in (cleared, opened)]
assert 0 < said[0] < said[1], said # the longer words
END
}

@test "keys are listed in groups, and a search leaves those that fit" {
    conus phantom slabs -o .
    live slabs.nii.gz --size 1280x800
    press F1
    tell 'screenshot all.png'
    press slash
    xdotool type --window "$window" 'under another name'
    look '.layers == "visible" and .angle_deg == 5'
    tell 'screenshot found.png'
    look true
    leave
    pixels <<'END'
def rows(name):
    "Rows of the left half where something is written in the colour of keys."
    pixels = oiio.ImageBuf(name).get_pixels(oiio.UINT8)[60:780, 25:120, :3].astype(int)
    return ((abs(pixels - (156, 199, 255)).max(axis=2) < 40).any(axis=1)).sum()
assert 0 < rows("found.png") < 20 and rows("all.png") > 100, (rows("found.png"), rows("all.png"))
END
}

@test "a display that does not answer is given up with a message" {
    need_window
    conus phantom sphere -o . --size 16
    local screen
    screen=$(cat "$BATS_FILE_TMPDIR/screen")
    kill -STOP "$screen"
    background timeout $HANG "$CONUS" view sphere.nii.gz --quiet 2>said
    local code=0
    wait "$child" || code=$?
    kill -CONT "$screen"
    [ $code -eq 4 ]
    grep -q 'the display or its window manager has not answered for 30 s' said
}

@test "a window that a starting window manager overlooks is shown all the same" {
    need_window
    conus phantom sphere -o . --size 16
    background timeout $HANG /usr/bin/python3 -B "$BATS_TEST_DIRNAME/x11_client.py" overlook listens
    wait_until "$child" test -e listens
    local manager=$child
    echo settle >script
    run -0 --separate-stderr timeout $HANG "$CONUS" view sphere.nii.gz --script script --quiet
    [ -z "$stderr" ]
    wait "$manager"
}

# bats test_tags=main
@test "two clicks measure a distance, which sessions keep and figures show" {
    conus phantom slabs -o .
    live slabs.nii.gz
    local at places=()
    for at in '312 40' '328 62'; do # in the axial cut: where the crosshair goes
        # shellcheck disable=SC2086
        click_at $at
        look true
        places+=("$(jq -c .crosshair "look$looks.json")")
    done
    tell 'sheet pixels 280 210' 'crosshair 0 0 0' # the same cut
    xdotool key --window "$window" ctrl+m
    look '.measure.on'
    click_at 312 40
    look '.measure.count == 1 and .crosshair == [0, 0, 0]'
    click_at 328 62
    look ".measure.count == 2 and .measure.points == ${places[0]} + ${places[1]}"
    cp "look$looks.json" measured.json
    tell 'figure measured.png' 'figure measured-axial.png axial'
    click_at 312 40 # anew
    look '.measure.count == 1'
    tell 'figure one.png' 'figure one-axial.png axial'
    tell 'open measured.json'
    look ".measure.count == 2 and .measure.points == ${places[0]} + ${places[1]}"
    tell 'figure again.png' 'figure again-axial.png axial'
    pass
    for pane in '' -axial; do # figures have the line
        cmp "measured$pane.png" "again$pane.png"
        not cmp "measured$pane.png" "one$pane.png"
    done
    leave
}

# It lies over black, beside the ball, in the plane z = 0: only in that cut is it a line with a length, in figures, too.
@test "a measured line is firm in the cut that it lies in, and faint beside it" {
    conus phantom sphere -o .
    view sphere.nii.gz <<'END'
save at.json
END
    jq '.own_colours = true | .measure = {"on": false, "count": 2, "points": [-19, -18, 0, -10, -18, 0]}' at.json >measured.json
    for z in 0 5 40; do
        view sphere.nii.gz --session measured.json --size 900x500 <<END
key tab
crosshair 0 30 $z
shot window$z
figure figure$z.png axial
END
    done
    pixels <<'END'


def longest(name, least):
    """The longest row of pixels that are so light, in the lower left quarter."""
    rgb = oiio.ImageBuf(name).get_pixels(oiio.UINT8)[..., :3].min(axis=2)
    runs = [0]
    for row in rgb[rgb.shape[0] // 2 :, 60 : rgb.shape[1] // 2] >= least:
        for on in row:
            runs.append(runs[-1] + 1 if on else 0)
    return max(runs)


for of in "window", "figure":
    firm, beside = (longest(f"{of}{z}.png", 180) for z in (0, 5))
    faint, none = (longest(f"{of}{z}.png", 40) for z in (5, 40))
    assert firm > 40 > 20 > beside, (of, firm, beside)
    assert faint > 40 > 20 > none, (of, faint, none)
END
}

@test "the 3-D pane says that clicks measure, as long as they do" {
    conus phantom slabs -o .
    view slabs.nii.gz --size 1000x640 <<'END'
key ctrl+m
shot on
key ctrl+m
shot off
END
    pixels <<'END'
on, off = (oiio.ImageBuf(f"{name}.png").get_pixels(oiio.UINT8)[560:615, 60:300, :3].astype(int) for name in ("on", "off"))
green = [((lower[..., 1] > 150) & (lower[..., 1] > lower[..., 0] + 60)).sum() for lower in (on, off)]
assert green[0] > 100 and green[1] == 0, green
END
}

@test "a typed name takes the place of the proposed one, and stays on the page where it cannot be written" {
    conus phantom slabs -o .
    live slabs.nii.gz
    tell 'aim 60 3 2 0 0 0'
    press ctrl+s
    typed mine
    enter
    wait_until "$child" test -e mine.json
    [ ! -e slabs-session.json ]
    press ctrl+shift+s
    typed "$PWD/none/yours"
    enter
    pass
    mkdir none
    enter # the page is there still, with the name
    wait_until "$child" test -e none/yours.json
    leave
}

@test "at 1500x940 the icons stand beside the list of areas" {
    conus phantom slabs -o .
    live slabs.nii.gz --size 1500x940
    look '.measure.on | not'
    click_at 24 54 # the second icon: measure
    look '.measure.on'
    leave
}

@test "while it is asked whether to add or replace, nothing else is touched" {
    conus phantom slabs -o .
    conus phantom sphere -o .
    live slabs.nii.gz --size 1280x800
    click_at 1228 508 # the tab of the second tool
    tell 'drop sphere.nii.gz'
    click_at 919 535
    look '.second.on | not'
    press Escape
    click_at 919 535
    look '.second.on'
    leave
}

@test "closing asks, once, while something is confirmed that no session has" {
    conus phantom slabs -o .
    local aim='aim 3 90 2 3 0 2'
    # nothing confirmed: it closes at once, and the script's rest is not done
    view slabs.nii.gz <<<"$aim"$'\nkey ctrl+q\nwait 1\nresults closed.tsv'
    [ ! -e closed.tsv ]
    # Enter and Escape keep it open, and confirm and clear nothing; a second Ctrl+Q, as of a key held down, is no answer
    view slabs.nii.gz <<END
$aim
key enter
key ctrl+q
wait 2
key ctrl+q
wait 2
results asked.tsv
key enter
save kept.json
angle 20
key ctrl+q
wait 1
results saved.tsv
END
    [ -e asked.tsv ]
    jq -e '(.confirmed | length) == 1' kept.json
    [ ! -e saved.tsv ] # since the session has it, the angle alone is no reason to ask
    # what is confirmed after that is, also in a session that was opened; Escape, then Q
    view slabs.nii.gz --session kept.json <<'END'
aim 3 -90 2 3 0 2
key enter
key ctrl+q
wait 1
key escape
wait 1
save more.json
key ctrl+z
wait 1
key ctrl+q
wait 1
key q
wait 1
results answered.tsv
END
    jq -e '(.confirmed | length) == 2' more.json
    [ ! -e answered.tsv ]
    view kept.json <<<$'key ctrl+q\nwait 1\nresults opened.tsv'
    [ ! -e opened.tsv ]
}

# The sphere's values are 0 to 1, and the editor goes up to 0.3 a mm (panel_look.c): so the middle one of these points is
# in its middle, 110 pixels high. 22 of them up are a fifth of the way: 0.15 + 0.06.
@test "closing asks where a transfer function was drawn that no session has" {
    conus phantom slabs -o .
    sphere
    local brain=(slabs.nii.gz --context sphere.nii.gz --session drawn.json)
    view slabs.nii.gz --context sphere.nii.gz <<<'save plain.json'
    jq '.transfer = [[0, 0, 0, 0, 0], [0.5, 1, 0.5, 0.25, 0.15], [1, 1, 1, 1, 0.3]]' plain.json >drawn.json
    jq 'del(.transfer)' plain.json >older.json
    view "${brain[@]}" <<<$'key ctrl+q\nwait 1\nresults opened.tsv' # the session that was opened has it
    [ ! -e opened.tsv ]
    # it stays where a session says nothing of it, and that one does not have it, until it is saved
    view "${brain[@]}" <<'END'
open older.json
key ctrl+q
wait 1
results asked.tsv
key escape
save kept.json
key ctrl+q
wait 1
results saved.tsv
END
    [ -e asked.tsv ]
    jq -e --slurpfile drawn drawn.json '.transfer == $drawn[0].transfer' kept.json
    [ ! -e saved.tsv ]
    live "${brain[@]}" --size 1280x800
    click_at 1123 508 # the tab Look
    xdotool mousemove --window "$window" 1100 640 click --repeat 20 --delay 10 5
    click_at 1085 759 # Context, its last heading
    xdotool mousemove --window "$window" 1100 640 click --repeat 30 --delay 10 5
    pass
    mouse_to 1083 715
    mouse mousedown 1
    mouse_to 1083 693
    mouse mouseup 1
    close_window "$window"
    pass
    look '.transfer[1][4] > 0.2 and .transfer[1][4] < 0.22' # and saved, so that it may close
    close_window "$window"
    tell 'wait 8' 'save late.json'
    leave
    [ ! -e late.json ]
}

@test "a window manager that closes the window is asked, too" {
    conus phantom slabs -o .
    live slabs.nii.gz --size 640x480
    tell 'aim 3 90 2 3 0 2' 'key enter'
    close_window "$window"
    pass
    look '(.confirmed | length) == 1' # and saved, so that it may close
    close_window "$window"
    tell 'wait 8' 'save late.json' # commands are waited for, events are not
    leave
    [ ! -e late.json ]
}

# between_frames COMMAND...: what it sends to the window comes to it between two frames.
between_frames() {
    local pid
    pid=$(xdotool getwindowpid "$window")
    kill -STOP "$pid"
    "$@"
    kill -CONT "$pid"
}

# quick_mouse WORD...: runs it.
quick_mouse() {
    /usr/bin/python3 -B "$BATS_TEST_DIRNAME/quick_mouse.py" "$@"
}

@test "presses and drags between two frames are taken where and when they were" {
    local count=10 i=0
    [ -z "${CONUS_TEST_LONG-}" ] || count=100
    quick_mouse atlas octants.nii
    live octants.nii
    tell 'key f' 'key x' 'key x' settle 'save 0.json' # cones begin on the surface, where the mouse is
    quick_mouse actions $count >actions
    while read -r -u 5 -a action; do
        i=$((i + 1))
        between_frames xdotool search --onlyvisible --name '^conus( - .*)?$' "${action[@]}"
        tell 'wait 8' settle "save $i.json" 'key h' "save $i.h.json" 'key h' settle "times $i.times.json"
        wait_until "$child" test -e $i.times.json
    done 5<actions
    leave
    [ $i -eq $((2 * count)) ]
    quick_mouse check $count
}

# crosshair: sets $crosshair to where the window's is.
crosshair() {
    look true
    crosshair=$(jq -c .crosshair "look$looks.json")
}

@test "in a cut, too; the wheel before a press counts before it, and all its clicks" {
    conus phantom slabs -o .
    live slabs.nii.gz --size 1280x800
    for at in '835 100' '815 350' '850 640'; do # in the axial, the coronal and the sagittal cut
        read -r x y <<<"$at"
        tell 'crosshair 0 0 0'
        click_at "$x" "$y"
        crosshair
        slow=$crosshair
        [ "$slow" != '[0,0,0]' ]
        tell 'crosshair 0 0 0'
        pass
        xdotool mousemove --window "$window" 400 400
        between_frames xdotool mousemove --window "$window" "$x" "$y" click 1 mousemove --window "$window" 400 420
        crosshair
        [ "$crosshair" = "$slow" ]
        xdotool mousemove --window "$window" 400 400
        between_frames xdotool mousemove --window "$window" "$x" "$y" click 4 click 4 click 4 click 1 \
            mousemove --window "$window" 400 420
        crosshair
        jq -en --argjson a "$slow" --argjson b "$crosshair" '[range(3) | $b[.] - $a[.] | . * 1e6 | round / 1e6] | sort == [0, 0, 3]'
    done
    leave
}

@test "keys that are let go before the next frame are not lost" {
    conus phantom sphere -o .
    conus phantom slabs -o .
    live sphere.nii.gz
    press ctrl+o
    typed "$PWD/slabs.nii.gz$(printf 'x%.0s' {1..40})"
    between_frames xdotool key --window "$window" $(printf 'BackSpace %.0s' {1..40}) Return
    pass
    between_frames xdotool key --window "$window" r
    look '.objects == 2'
    tell 'aim 60 3 2 0 0 0' 'key space' 'choose "Slab anterior"'
    pass
    between_frames xdotool key --window "$window" slash h
    look '.hidden == []' # the h is of the search that the slash opens
    leave
}

# The bar at its left has the first rank's colour, and the name is in letters that a room can read.
@test "the brain alone has the answer on a card, and without an answer none" {
    conus phantom slabs -o .
    view slabs.nii.gz --size 1000x640 <<'END'
key f
shot none
aim 3 90 2 3 0 2
shot card
pointer tracker
shot old
END
    pixels <<'END'
none, card, old = (oiio.ImageBuf(f"{name}.png").get_pixels(oiio.UINT8)[..., :3].astype(int) for name in ("none", "card", "old"))
bar = lambda rgb: (abs(rgb[400:, :40] - (0xD2, 0x24, 0x6C)).max(axis=2) < 8).any(axis=1).sum()
assert bar(none) == bar(old) == 0 and bar(card) > 0.12 * 640, (bar(none), bar(old), bar(card))
rows = (card[400:, 40:300].min(axis=2) > 220).any(axis=1)
longest = run = 0
for on in rows:
    run = run + 1 if on else 0
    longest = max(longest, run)
assert longest >= 640 / 40, longest
END
}

@test "what lies over the 3-D picture belongs to it, and it keeps its shape while the pane changes" {
    conus phantom slabs -o .
    conus phantom sphere -o .
    view slabs.nii.gz --size 1000x640 <<'END'
choose "Slab anterior"
shot before
key ctrl+5
wait 1
screenshot after.png
END
    view sphere.nii.gz --size 1000x640 <<'END'
background white
settle
key f
wait 1
screenshot alone.png
END
    pixels <<'END'
before, after, alone = (oiio.ImageBuf(f"{name}.png").get_pixels(oiio.UINT8)[..., :3].astype(int) for name in ("before", "after", "alone"))
changed = (before != after).any(axis=2)[70:520, 60:440].mean() # of the 3-D pane, without buttons and words
assert changed == 0 or changed > 0.05, changed # nothing yet, or the picture of the view from above, too
ball = abs(alone - 255).max(axis=2) > 60
ball[:60] = ball[-60:] = ball[:, :150] = ball[:, -250:] = False # buttons, words, the cross of directions
high, wide = (numpy.flatnonzero(ball.any(axis=a)).ptp() for a in (1, 0))
assert abs(wide / high - 1) < 0.05, (wide, high)
END
}

@test "the chosen area has no colour of a hit: dashes where it is hidden, and its outline where it is not hit" {
    conus phantom nested -o .
    conus phantom slabs -o .
    view nested.nii.gz --size 1000x640 <<'END'
aim 0 60 0 0 0 0
shot before
choose Core
shot hidden
END
    view slabs.nii.gz --size 1000x640 <<'END'
aim 0 60 0 0 0 0
orbit 180 20
crosshair 0 -9 0
shot unchosen
choose "Slab posterior"
shot chosen
END
    pixels <<'END'
pixels = lambda name: oiio.ImageBuf(f"{name}.png").get_pixels(oiio.UINT8)[60:520, 60:440, :3].astype(int) # of the 3-D pane
before, hidden, unchosen, chosen = map(pixels, ("before", "hidden", "unchosen", "chosen"))
lines = (before != hidden).any(axis=2)
y, x = numpy.indices(lines.shape) - numpy.array((248, 229))[:, None, None] # from the pane's middle, and the ball's
radius = y[lines].max()
r = numpy.hypot(y, x)
assert radius > 40 and not lines[r < 0.7 * radius].any() # the outermost ball, as before
below = lines & (r > 0.7 * radius) & (y > 0) # the name is above
seen = numpy.unique(numpy.degrees(numpy.arctan2(y[below], x[below])).astype(int)).size
assert 40 < seen < 150, seen # dashes: of a whole line there are 180
change = abs(chosen - unchosen).max(axis=2) > 0
assert 0.001 < change.mean() < 0.1, change.mean() # an outline and a name, not the whole slab
END
}

# From behind, the contact of a cone from the front is behind the other slab.
@test "the name of a hit that another area hides is pale, and the second tool's hits are blue in list and picture" {
    conus phantom slabs -o .
    view slabs.nii.gz --size 1000x640 <<'END'
aim 0 90 0 0 0 0
orbit 20 10
shot seen
orbit 200 10
shot hidden
orbit 90 10
second on
second aim 90 0 0 0 0 0
shot second
END
    pixels <<'END'
pixels = lambda name, x, y, width, height: oiio.ImageBuf(name).get_pixels(oiio.UINT8)[y:y + height, x:x + width, :3]
pane, the_list = (60, 60, 340, 400), (704, 200, 290, 320) # of 3-D what has no letters of directions
white = lambda name: (pixels(name, *pane).min(axis=2) > 212).sum() # letters and ring; the grey slab has less
blue = lambda name, place: (pixels(name, *place) == (0, 0xBE, 0xFF)).all(axis=2).sum()
assert white("seen.png") > 20 and white("hidden.png") == 0, (white("seen.png"), white("hidden.png"))
assert blue("hidden.png", the_list) == 0
assert blue("second.png", the_list) > 100 and blue("second.png", pane) > 20
END
}

# The arms of the crosshair are lines of 24 pixels and more: in the middle of the ball of 20 mm each is two dashes, before
# it each is one piece.
@test "the crosshair is dashed where it is hidden" {
    conus phantom sphere -o .
    view sphere.nii.gz --size 1000x700 <<'END'
orbit 0 0
crosshair 0 0 0
shot hidden
crosshair 0 28 0
shot seen
END
    pixels <<'END'
for name, pieces in ("hidden", 4), ("seen", 2):
    pane = oiio.ImageBuf(f"{name}.png").get_pixels(oiio.UINT8)[:, :500, :3].astype(int)
    cross = abs(pane - [0xf2, 0xf2, 0x8a]).max(axis=2) < 40
    upright = numpy.flatnonzero(cross[:, cross.sum(axis=0).argmax()])
    assert (numpy.diff(upright) > 1).sum() + 1 == pieces, (name, upright)
END
}

# From x = 90 the axis leaves the ball of 20 mm at x = -20, 110 mm deep, where a cone of 10 degrees is 2 * 9.6 mm wide:
# between its sides there is nothing, but an end at 105 mm is one. Nothing else in the pane has the cone's colour.
@test "in a cut the cone is open where it leaves the brain, and closed where its depths end" {
    conus phantom sphere -o .
    view sphere.nii.gz --size 1000x700 <<'END'
crosshair 0 0 0
angle 10
aim 90 0 0 0 0 0
shot open
ask --range=0,105
shot closed
END
    pixels <<'END'
counts = []
for name in "open", "closed":
    pane = oiio.ImageBuf(f"{name}.png").get_pixels(oiio.UINT8)[:224, 517:570, :3].astype(int)
    amber = (pane[..., 0] > 200) & (abs(pane[..., 1] - 0xb0) < 40) & (pane[..., 2] < 60)
    counts.append((amber.sum(axis=0).max(), amber.any(axis=0).sum()))
assert counts[0][0] < 8 < 20 < counts[1][0], counts # of one column: two sides, or the end between them
assert counts[0][1] > 25, counts
END
}
