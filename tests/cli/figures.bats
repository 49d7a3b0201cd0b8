#!/usr/bin/env bats
# Figures of the window: a saved figure is the picture that conus render draws, and keys, a name and the clipboard lead
# to it.
load helpers
load window

# of_session FILE.json: the camera of the session's view as options of conus render, by the orbit's own definition.
of_session() {
    jq -r '.orbit as $o | [($o[5] | cos) * ($o[4] | sin) * -1, ($o[5] | cos) * ($o[4] | cos), ($o[5] | sin)] as $d |
        "--camera-origin=\([range(3)] | map($o[.] + $o[3] * $d[.] | tostring) | join(",")) " +
        "--camera-toward=\($o[:3] | map(tostring) | join(","))"' "$1"
}

# same A B: asserts that both have the same size, and that no byte of a pixel differs by more than one level.
same() {
    /usr/bin/python3 - "$@" <<'END'
import sys
import OpenImageIO as oiio
import numpy
a, b = (oiio.ImageBuf(name).get_pixels(oiio.UINT8).astype(int) for name in sys.argv[1:])
assert a.shape == b.shape, (a.shape, b.shape)
worst = numpy.abs(a - b).max()
assert worst <= 1, worst
assert numpy.ptp(a[..., :3]) > 100
END
}

# The cone, the ball and names, which the window lays over its picture, are added to that of conus render.
@test "a figure is what conus render draws with the same camera and options, and what lies over it" {
    need_pixels
    conus phantom nested -o . --size 32
    view nested.nii.gz <<'END'
size 900 200
key tab
key tab
key tab
key tab
wait 8
orbit 40 20
aim 60 10 6 0 0 0
angle 20
opacity "Shell outer" 0.4
opacity 0.7
background transparent
sheet pixels 300 200
sheet legend right
settle
figure right.svg
figure right.png
sheet mm 30 25
sheet dpi 200
sheet legend below
background white
figure below.svg 3d
save s.json
END
    [ "$(jq -r .enlarged s.json)" = 3d ] # the pane is wide, so its height is 0.5 radians
    # shellcheck disable=SC2046 # several words
    set -- $(of_session s.json)
    cone=(--origin=60,10,6 --toward=0,0,0 --angle 20 --opacity 0.7 --opacity 'Shell outer=0.4')
    for how in 'right --size 300x200 --legend right --background transparent' \
        'below --width-mm 30 --height-mm 25 --dpi 200 --legend below --background white'; do
        # shellcheck disable=SC2086
        conus render nested.nii.gz "$@" --field-of-view 28.64788975654116 "${cone[@]}" -o wanted.svg ${how#* } --quiet
        # with the same pixels, and all of its shapes
        diff wanted.svg "${how%% *}.svg" >changes || true
        not grep '^<' changes
        grep -q '^> .*#ffb000' changes # lines of the cone
        grep -q '^> .*>Shell outer<' changes # the name over the brain, beside that of the legend
    done
    # shellcheck disable=SC2086
    conus render nested.nii.gz "$@" --field-of-view 28.64788975654116 "${cone[@]}" -o wanted.png --size 300x200 \
        --legend right --background transparent --quiet
    run -1 cmp -s right.png wanted.png
}

# The mouse's cone lies in the opaque brain: only what lies over the picture shows it.
@test "a figure has the cone that begins on the surface, its beginning and its name" {
    need_pixels
    conus phantom nested -o . --size 32
    view nested.nii.gz --size 900x600 <<'END'
settle
point 0.45 0.45
settle
figure over.svg
END
    grep -q 'stroke="#ffb000"' over.svg
    [ "$(grep -c '>Shell outer<' over.svg)" = 2 ] # in the legend, and beside its contact
}

# In mm a figure is in print style, unless a background was chosen. The window fills areas by 0.45 at first.
@test "a figure of a cut is what conus render --cuts draws, with its place" {
    need_pixels
    conus phantom nested -o . --size 32
    view nested.nii.gz <<'END'
size 900 500
aim 60 10 6 0 0 0
angle 20
crosshair 3 4 5
sheet mm 40 30
figure cut.svg axial
background light
figure light.svg axial
END
    conus render nested.nii.gz --cuts axial:5 --fill 0.45 --origin=60,10,6 --toward=0,0,0 --angle 20 --width-mm 40 \
        --height-mm 30 -o wanted.svg --quiet
    cmp cut.svg wanted.svg
    grep -q '>z = 5 mm<' cut.svg
    run -1 cmp -s cut.svg light.svg
}

# The form, 520 x 357 pixels, is in the middle of the window, and its button Preview 117 to the right of its left edge and
# 315 below its top. Of a white sheet of 120 x 90 more than half is white; the window has no other white.
@test "the form shows a preview until something changes" {
    conus phantom nested -o . --size 32
    live nested.nii.gz --size 700x480 --scale 1
    tell 'sheet pixels 120 90' 'background white' 'orbit 90 0' 'zoom -20' settle
    press ctrl+p
    tell 'screenshot without.png'
    click_at 207 377
    pass
    tell 'screenshot with.png'
    pass
    tell 'background black' 'wait 4' 'screenshot again.png'
    pass
    leave
    pixels <<'PYTHON'
white = lambda name: int((oiio.ImageBuf(name).get_pixels()[60:420, 90:610, :3].min(2) > 0.95).sum())
before, shown, after = (white(name + '.png') for name in ('without', 'with', 'again'))
assert before + 5400 < shown < before + 10800 and after < shown - 5400, (before, shown, after)
PYTHON
}

@test "Ctrl+P asks for a name, Enter saves, and a file that is there is not replaced at once" {
    conus phantom nested -o . --size 32
    live nested.nii.gz
    look '.figure.pixels == [1400, 1050] and .figure.mm == [85, 64]'
    tell 'sheet pixels 120 90' 'sheet text off'
    xdotool key --window "$window" ctrl+p
    until look '.figure.text == false'; do :; done
    xdotool keydown --window "$window" Return # it has to be down when a frame is drawn
    until [ -s figure-1.png ]; do look true; done
    xdotool keyup --window "$window" Return
    look true
    before=$(stat -c %Y.%i figure-1.png)
    xdotool key --window "$window" ctrl+p # with the next free name
    look true
    xdotool key --window "$window" ctrl+a
    xdotool type --window "$window" figure-1.png
    look true
    xdotool keydown --window "$window" Return
    look true
    xdotool keyup --window "$window" Return
    look true
    [ ! -e figure-2.png ]
    [ "$(stat -c %Y.%i figure-1.png)" = "$before" ]
    xdotool key --window "$window" ctrl+shift+p
    look true
    look '.confirmed == []' # Enter answered the question
    if command -v xsel >/dev/null; then
        (while sleep 0.1; do tell 'wait 1'; done) & # the window answers between frames
        pid=$!
        copied=$(timeout 10 xsel -ob) || true
        kill $pid
        [ "$copied" = "$PWD/figure-1.png" ]
    fi
    leave
}
