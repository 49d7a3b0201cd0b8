#!/usr/bin/env bats
# conus view under a display without a screen (Xvfb) and Mesa's software renderer, driven by scripts and by xdotool.
load helpers
load window

# bats test_tags=main
@test "it starts, shows four panes and panels, and ends" {
    conus phantom u-shape -o .
    view u-shape.nii.gz --size 1000x640 <<'END'
aim 60 0 6 0 0 6
shot window
END
    # the 3-D pane and the panels are the dark theme's, the flat panes black at their corners
    pixels <<'END'
pixels = oiio.ImageBuf("window.png").get_pixels(oiio.UINT8)
assert pixels.shape[:2] == (640, 1000), pixels.shape
assert tuple(pixels[560, 80][:3]) == (0x14, 0x17, 0x1b), pixels[560, 80]
assert pixels[600, 575][:3].max() == 0, pixels[600, 575]
assert 20 < pixels[600, 30][:3].mean() < 60, pixels[600, 30]
END
}

@test "the lists of two tools are what conus query answers" {
    conus phantom nested -o .
    awk 'BEGIN { srand(7); for (i = 0; i < 10; i++) {
        a = 6.2831853 * rand(); z = 80 * rand() - 40
        printf "%.3f %.3f %.3f %.3f %.3f %.3f\n", 70 * cos(a), 70 * sin(a), z, 20 * rand() - 10, 20 * rand() - 10, 20 * rand() - 10
    } }' >poses
    i=0
    while read -r pose; do
        printf 'aim %s\nresults view%02d.tsv\n' "$pose" $i
        [ $i -gt 4 ] || printf 'second aim %s\n' "$pose"
        [ $i -gt 8 ] || printf 'second results second%02d.tsv\n' $i
        i=$((i + 1))
    done <poses | { printf 'angle 14\nsecond on\nsecond angle 9\n'; cat; } >commands
    view nested.nii.gz <commands
    i=0
    while read -r x y z tx ty tz; do
        conus query nested.nii.gz --origin="$x,$y,$z" --toward="$tx,$ty,$tz" --angle 14 --format tsv >wanted
        diff "$(printf 'view%02d.tsv' $i)" wanted
        [ $i -gt 4 ] || conus query nested.nii.gz --origin="$x,$y,$z" --toward="$tx,$ty,$tz" --angle 9 --format tsv >second
        [ $i -gt 8 ] || diff "$(printf 'second%02d.tsv' $i)" second # it stays in the fifth pose
        i=$((i + 1))
    done <poses
    [ $i -eq 10 ]
}

# bats test_tags=main
@test "exported files are those of conus query -o, sidecars included" {
    need_window
    conus phantom nested -o .
    conus phantom u-shape -o .
    mkdir view query
    view nested.nii.gz --atlas u-shape.nii.gz --hide ShO <<'END'
aim 60 10 6 0 0 6
angle 30
export view/a.tsv
key l
export view/b.csv
export view/c.json
key ctrl+e
key enter
wait 2
key ctrl+e
key enter
wait 2
END
    [ "$(find . -name 'conus-*-hits*.tsv' | wc -l)" -eq 2 ]
    for file in conus-*-hits*.tsv; do
        conus diff "$file" view/b.csv
        jq -e '.Outputs[0].path == "'"$PWD/$file"'"' "${file%.tsv}.json"
    done
    for file in a.tsv b.csv c.json; do
        layers=$([ $file = a.tsv ] && echo visible || echo all)
        conus query nested.nii.gz --atlas u-shape.nii.gz --hide ShO --origin=60,10,6 --toward=0,0,6 --angle 30 \
            --layers "$layers" -o query/$file
        cmp view/$file query/$file || [ $file = c.json ]
    done
    # a window has no command line, and so no question and another checksum; files have their names
    for file in a b c; do
        for from in view query; do
            jq 'del(.GeneratedBy[].CommandLine, .Question, .Checksum, .Outputs[].path)' $from/$file.json >$from.$file
            [ -s $from.$file ]
        done
        cmp view.$file query.$file
    done
}

@test "positions are those of the mouse, in scripts, lists and poses" {
    python3 "$BATS_TEST_DIRNAME/ccf.py"
    printf 'name,ap,ml,dv,dap,dml,ddv,time_s\n1,-1,2,2,0,0,-1,0\n' >poses.csv
    view ras.nii --space bregma --poses poses.csv <<'END'
angle 4
results replayed.tsv
aim 0 -1 2 0.5 -1 -3
crosshair -0.1 -1.639 -1.768
results aimed.tsv
shot window
END
    conus query ras.nii --space bregma --pose poses.csv --angle 4 --format tsv --quiet >wanted
    printf 'x,y,z,dx,dy,dz,far\n0,0,90,0,0,-1,9\n' >ranged.csv
    fails 3 'ranged.csv: near and far: the window has one range for all poses' view ras.nii --poses ranged.csv
    diff replayed.tsv <(cut -f 1,4- wanted) # without row and time_s
    conus query ras.nii --space bregma --origin=0,-1,2 --toward=0.5,-1,-3 --angle 4 --format tsv --quiet >wanted
    diff aimed.tsv wanted
    export ASAN_OPTIONS=detect_leaks=0 # Mesa forgets 128 bytes of a driver that is unloaded before anything was drawn
    echo 'aim 0 2000 0 0 0 0' >um
    run -3 --separate-stderr timeout $HANG "$CONUS" view ras.nii --space bregma --script um --quiet --size 400x256
    [[ $stderr == *'positions there are in mm, not micrometres'* ]]
    conus phantom nested -o .
    run -3 --separate-stderr timeout $HANG "$CONUS" view nested.nii.gz --space ccf --script um --quiet --size 400x256
    [[ $stderr == *'not known to be the Allen CCF'* ]]
}

# in_columns ATLAS OPTION...: the answer of conus query for one atlas, with the atlas's column.
in_columns() {
    conus query "$1.nii.gz" "${@:2}" --format tsv --quiet | awk -v name="$1" 'BEGIN { FS = OFS = "\t" }
        { $1 = $1 OFS (NR == 1 ? "atlas" : name); print }'
}

@test "with several atlases the lists are what conus query answers in each, whichever is drawn" {
    need_window
    conus phantom nested -o .
    conus phantom slabs -o .
    sphere --size 16
    local poses=('3 90 2 3 0 2' '-80 10 20 4 0 0' '10 -70 -40 0 -9 3' '5 6 90 0 8 0')
    local i
    {
        printf 'angle 14\nkey n\nchoose "Slab anterior"\nkey h\n'
        for i in "${!poses[@]}"; do
            printf 'aim %s\nresults view%d.tsv\nkey n\n' "${poses[i]}" "$i"
        done
        printf 'key l\nsave left.json\nresults view4.tsv\nkey v\nkey n\nkey n\nkey v\nopen left.json\n'
        printf 'results opened.tsv\nsave opened.json\n'
    } | view nested.nii.gz --atlas slabs.nii.gz --atlas sphere.nii.gz --hide 'Shell outer'
    poses+=("${poses[3]}") # in all layers
    for i in "${!poses[@]}"; do
        read -r x y z tx ty tz <<<"${poses[i]}"
        local cone=(--origin="$x,$y,$z" --toward="$tx,$ty,$tz" --angle 14)
        [ "$i" -lt 4 ] || cone+=(--layers all)
        { in_columns nested "${cone[@]}" --hide 'Shell outer'
            in_columns slabs "${cone[@]}" --hide 'Slab anterior' | tail -n +2
            in_columns sphere "${cone[@]}" | tail -n +2; } | diff "view$i.tsv" -
    done
    diff view4.tsv opened.tsv
    diff left.json opened.json
    [ "$(jq -c '[.drawn, .hidden, .further_atlases[].hidden]' left.json)" = '[3,[1],[1],[]]' ]
    # an atlas that cannot be loaded fails like ATLAS itself
    echo nonsense >none.nii
    export ASAN_OPTIONS=detect_leaks=0 # Mesa forgets 128 bytes of a driver that is unloaded before anything was drawn
    run -3 --separate-stderr timeout $HANG "$CONUS" view nested.nii.gz --atlas none.nii --script /dev/null --quiet --size 400x256
    check_message 'none.nii'
}

# bats test_tags=main
@test "a session is left and opened as it was" {
    conus phantom slabs -o .
    view slabs.nii.gz <<'END'
aim 3 90 2 3 0 2
angle 23
key l
key ctrl+r
crosshair 1 2 3
orbit 40 20
choose "Slab anterior"
key h
key enter
choose "Slab posterior"
crosshair 1 2 3
save one.json
key v
choose "Slab anterior"
angle 5
aim 0 0 90 0 0 0
open one.json
save two.json
END
    diff one.json two.json
    view slabs.nii.gz --session one.json <<'END'
save three.json
results left.tsv
END
    diff one.json three.json
    conus query slabs.nii.gz --origin 3,90,2 --toward 3,0,2 --angle 23 --layers all --hide 'Slab anterior' --format tsv |
        diff left.tsv - # the session hides it
    # the label table has the anterior one first; what is chosen is no change to be taken back; Escape chooses nothing
    [ "$(jq '.chosen, .hidden[]' one.json | paste -sd ' ')" = '2 1' ]
    view slabs.nii.gz --session one.json <<'END'
key v
wait 1
choose "Slab anterior"
wait 1
key ctrl+z
save undone.json
key escape
save none.json
END
    [ "$(jq '.chosen, .hidden[]' undone.json | paste -sd ' ')" = '1 1' ]
    [ "$(jq .chosen none.json)" = 0 ]
}

# scene: scene.atlas.json, two slabs across y with a context and the pathway Arc, which are one map: a ball, 46000 in its
# middle, 0 from 30 mm on.
scene() {
    command -v python3 >/dev/null || skip 'no python3'
    conus phantom slabs -o . --size 32
    PYTHONPATH="$BATS_TEST_DIRNAME" python3 -B - <<'END'
import math, nifti
nifti.write("ball.nii", (30, 30, 30), "H", lambda *at: int(max(0, 46000 * (1 - math.dist(at, [14.5] * 3) / 15))), 2)
END
    printf '%s' '{"conus_atlas": 1, "parcellation": {"file": "slabs.nii.gz"}, "pathways": [{"file": "ball.nii",
        "name": "Arc"}], "context": {"file": "ball.nii", "transfer": "brain"}}' >scene.atlas.json
}

@test "a moved atlas in the window, and its session" {
    conus phantom nested -o .
    printf '1 0 0 7\n0 1 0 0\n0 0 1 0\n0 0 0 1\n' >right.txt
    echo '{"conus_atlas": 1, "parcellation": "nested.nii.gz", "transform": "right.txt"}' >one.atlas.json
    conus query nested.nii.gz --atlas-transform right.txt --origin=-70,9,2 --toward=-7,0,2 --angle 14 --format tsv \
        --quiet >wanted
    grep -q atlas_x wanted
    printf 'angle 14\naim -70 9 2 -7 0 2\nresults view.tsv\n' >commands
    view nested.nii.gz --atlas-transform right.txt <commands
    diff view.tsv wanted
    echo 'save left.json' >>commands
    view one.atlas.json <commands
    diff view.tsv wanted
    echo 'results opened.tsv' | view one.atlas.json --session left.json
    diff opened.tsv wanted
}

@test "a session keeps thresholds, the context's transfer function and colours" {
    scene
    local aim='--origin 0,150,0 --toward 0,0,0 --angle 30 --layers all'
    view scene.atlas.json <<'END'
aim 0 150 0 0 0 0
angle 30
key l
results before.tsv
save before.json
threshold Arc 32000.5
results changed.tsv
key c
save one.json
open before.json
results again.tsv
save again.json
END
    sed 's/"name": "Arc"/"name": "Arc", "threshold": 32000.5/' scene.atlas.json >higher.atlas.json
    conus query scene.atlas.json $aim --format tsv --quiet | diff before.tsv -
    conus query higher.atlas.json $aim --format tsv --quiet | diff changed.tsv -
    run -1 cmp -s before.tsv changed.tsv
    diff before.tsv again.tsv
    diff before.json again.json
    [ "$(jq -c '[.thresholds, .transfer, .safe_colours]' one.json)" = \
        '[[{"pathway":"Arc","threshold":32000.5}],null,true]' ]
    sed 's/"transfer": null/"transfer": [[0, 0, 0, 0, 0], [100.5, 1, 0.5, 0.25, 0.3]]/' one.json >edited.json
    # edited points stay when other settings of the view change, and go with a session without any
    view scene.atlas.json --session edited.json <<'END'
results left.tsv
save two.json
picture edited.png 120 90
key c
key c
picture again.png 120 90
threshold Arc 20000
open one.json
save three.json
picture one.png 120 90
END
    diff changed.tsv left.tsv
    diff <(jq -S . edited.json) <(jq -S . two.json)
    diff one.json three.json
    cmp edited.png again.png
    run -1 cmp -s edited.png one.png
}

# bats test_tags=main
@test "what is hidden is not hit: the window's answers are those of --hide" {
    need_window
    conus phantom nested -o .
    printf 'angle 20\naim 3 90 2 3 0 2\nresults all.tsv\nchoose "Shell outer"\nkey h\nresults less.tsv\nkey u\nresults again.tsv\n' |
        view nested.nii.gz
    local of=(query nested.nii.gz --origin 3,90,2 --toward 3,0,2 --angle 20 --format tsv -q)
    diff <(conus "${of[@]}") all.tsv
    diff <(conus "${of[@]}" --hide 'Shell outer') less.tsv
    cmp all.tsv again.tsv
}

@test "pins without a contact or a share are not lost" {
    conus phantom slabs -o . --size 16
    view slabs.nii.gz <<<$'aim 3 90 2 3 0 2\nkey enter\nsave one.json'
    jq '.confirmed[0] |= (.contact = [null, null, null] | .distance_mm = null | del(.share))' one.json >poor.json
    view slabs.nii.gz <<<$'open poor.json\nsave two.json\nopen two.json\nsave three.json'
    diff <(jq -S '.confirmed[0].share = null | .confirmed' poor.json) <(jq -S .confirmed two.json)
    [ "$(jq -c '.confirmed[0].contact' two.json)" = '[null,null,null]' ]
    diff two.json three.json # null is read back, too
}

# On a screen of 1280 x 800 pixels and mm, as Xvfb's here; the 3-D pane of a window of 1000 x 640 at its corner is 468 x
# 616 pixels at (48, 0), so its middle is at (282, 308).
@test "the mouse points through the eye of a tracked head" {
    conus phantom nested -o .
    view nested.nii.gz --size 1000x640 <<'END'
key x
screen -318 200 -85.5 -318 0 -85.5 1280 800
head 30 900 60
angle 6
point 0.5 0.5
results head.tsv
point 0.52 0.46
results other.tsv
save one.json
picture seen.png 468 616
head lost
picture lost.png 468 616
head 30 100 60
picture behind.png 468 616
orbit 10 20
picture turned.png 468 616
key t
picture orbit.png 468 616
save two.json
open one.json
save three.json
picture opened.png 468 616
END
    # the screen's right is -x, since the scene behind it lies towards -y: -318 + 640 - 282, -85.5 + 400 - 308
    conus query nested.nii.gz --origin 30,900,60 --toward 40,200,6.5 --angle 6 --format tsv | diff head.tsv -
    conus query nested.nii.gz --origin 30,900,60 --toward=30.64,200,31.14 --angle 6 --format tsv | diff other.tsv -
    grep -q area head.tsv
    grep -q area other.tsv
    run -1 diff head.tsv other.tsv
    for kept in lost behind turned opened; do
        conus diff seen.png $kept.png || { echo $kept; return 1; }
    done
    run -1 conus diff seen.png orbit.png
    diff one.json three.json
    [ "$(jq -c '[.eye, .screen_mm]' one.json)" = '[[30,900,60],[1280,800]]' ]
    [ "$(jq .by_head two.json)" = null ]
}

@test "3-D alone fills the screen, and goes back" {
    conus phantom nested -o .
    view nested.nii.gz --size 1000x640 <<'END'
key x
screen 0 200 0 0 0 0 1280 800
head 300 900 60
angle 6
key f11
wait 5
shot full
point 0.5 0.5
results middle.tsv
save full.json
key F11
wait 5
shot back
END
    conus query nested.nii.gz --origin 300,900,60 --toward 0,200,0 --angle 6 --format tsv | diff middle.tsv -
    printf 'key f11\nwait 5\nsettle\nscreenshot back2.png\n' >script
    run -0 timeout $HANG "$CONUS" view nested.nii.gz --script script --quiet --size 1000x640 --full-screen
    pixels <<'END'
full, back, again = (oiio.ImageBuf(f"{name}.png").get_pixels(oiio.UINT8) for name in ("full", "back", "back2"))
assert full.shape[:2] == (800, 1280), full.shape
assert all(tuple(full[400, x][:3]) == (0x14, 0x17, 0x1b) for x in (5, 1275)) # no panels
assert back.shape[:2] == again.shape[:2] == (640, 1000), back.shape
assert 20 < back[600, 30][:3].mean() < 60
END
}

# The same eye and screen, twice as large and 10 mm lower in the tracker's frame.
@test "a tracker moves the head, and loses it" {
    need_window
    conus phantom nested -o .
    printf '%s\n' '-1 0 0 -636' '0 0 1 400' '0 1 0 -181' '0 0 0 1' >screen.txt
    printf '%s\n' '1 0 0 0' '0 1 0 0' '0 0 1 10' '0 0 0 1' >world.txt
    cat >send.py <<'END'
# A tracker that sees the glasses until left.json is there.
import os, socket, sys, time
from openigtlink import transform
seen, lost = (transform(b"GlassesToTracker", *place) for place in ((53, 1800, 110), (0, 0, 0)))
conus = socket.create_connection(("127.0.0.1", int(sys.argv[1])))
while not os.path.exists("left.json"):
    conus.sendall(seen)
    time.sleep(0.02)
conus.sendall(lost)
conus.shutdown(socket.SHUT_WR)
while conus.recv(65536): # until the other side has read everything, and closes the connection
    pass
open("lost", "w")
END
    port=$(free_port)
    live nested.nii.gz --listen "$port" --head Glasses --eye 7,0,0 --screen-mm 2560x1600 --screen-pose screen.txt \
        --enlarge 2 --world-from-tracker world.txt --size 1000x640
    local view=$child
    background env PYTHONPATH="$BATS_TEST_DIRNAME" /usr/bin/python3 -B send.py "$port" 4>&-
    local sender=$child
    child=$view
    until look '.eye == [30, 900, 60]'; do
        runs "$sender"
    done
    tell 'angle 6' 'key x' 'point 0.5 0.5' 'results head.tsv' 'picture seen.png 468 616' 'save left.json'
    wait_until "$sender" test -e lost
    tell 'wait 2' 'picture lost.png 468 616' 'save lost.json'
    leave
    conus query nested.nii.gz --origin 30,900,60 --toward 40,200,6.5 --angle 6 --format tsv | cut -f 1-9 >wanted
    cut -f 1-9 head.tsv | diff - wanted
    conus diff seen.png lost.png
    diff left.json lost.json
    [ "$(jq -c '[.eye, .screen_mm]' left.json)" = '[[30,900,60],[1280,800]]' ]
}

@test "what a head needs is said" {
    [ -x "${CONUS%/*}/conus-view" ] || skip "conus-view is not built"
    fails 2 '--head needs --listen or --connect' view a.nii --head Glasses --screen-mm 400x300
    fails 2 '--head has no effect without --screen-mm' view a.nii --head Glasses --listen 18944
    fails 2 '--eye has no effect without --head' view a.nii --eye 1,2,3 --listen 18944
    fails 2 '--screen-pose has no effect without --head' view a.nii --screen-pose a.txt --listen 18944
    fails 2 '--head: Glasses is the --tool' \
        view a.nii --head Glasses --tool Glasses --screen-mm 400x300 --listen 18944
    fails 2 'is not a size WxH' view a.nii --head Glasses --screen-mm 400 --listen 18944
    fails 2 '--enlarge needs --listen or --connect' view a.nii --enlarge 2
    fails 2 '--second-tool needs --listen' view a.nii --second-tool Left
    fails 2 '--second-tool: Left is the --tool' view a.nii --listen 18944 --tool Left --second-tool Left
    fails 2 '--second-world-from-tracker needs' view a.nii --listen 18944 --second-world-from-tracker a.txt
    fails 2 '--tool needs --listen or --connect' view a.nii --second-listen 18944 --tool Right
    fails 2 scale view a.nii --scale 0.1
    export DISPLAY=:no.display # before any window
    fails 2 '--second-connect: "a:b" is no address and port' view a.nii --second-connect a:b
    fails 2 '--second-listen: "0" is no address and port' view a.nii --listen 18944 --second-listen 0
    fails 2 '--connect: "a:b" is no address and port' view a.nii --connect a:b
    fails 2 '--listen: "70000" is no address and port' view a.nii --listen 70000 --second-connect a
}

# bats test_tags=main
@test "searching, hiding, isolating and taking it back" {
    conus phantom slabs -o .
    view slabs.nii.gz <<'END'
orbit 0 0
shot all
choose "Slab anterior"
key i
shot only
key u
shot again
search poster
shot found
END
    run -1 conus diff all.png only.png
    run -1 conus diff again.png found.png
}

@test "the chosen area is outlined in all panes, and through others in 3-D" {
    conus phantom nested -o .
    # the innermost of three balls is chosen, hidden and shown again; then none is chosen, and the crosshair stays in
    # its middle
    view nested.nii.gz --size 1000x640 <<'END'
shot none
choose "Core"
shot chosen
key h
shot hidden
key h
shot again
key escape
shot escaped
END
    pixels <<'END'
boxes = {"3-D": (60, 0, 511, 615), "axial": (572, 0, 127, 204), "coronal": (572, 205, 127, 204),
         "sagittal": (572, 410, 127, 205)}
def panes(name):
    pixels = oiio.ImageBuf(name + ".png").get_pixels(oiio.UINT8)[..., :3].astype(int)
    return {pane: pixels[y:y + high, x:x + wide] for pane, (x, y, wide, high) in boxes.items()}
none, chosen, hidden, again, escaped = map(panes, ("none", "chosen", "hidden", "again", "escaped"))
for pane in boxes:
    white = chosen[pane].min(axis=2) > 180 # nearly the colour of the outline and the name
    changed = (chosen[pane] != none[pane]).any(axis=2)
    assert (white & changed).sum() > 100, pane
    assert (again[pane] == chosen[pane]).all() and (escaped[pane] == none[pane]).all(), pane
assert (hidden["3-D"] == none["3-D"]).all() # where the ball was not visible before
END
}

# bats test_tags=main
@test "the mouse points, turns and confirms" {
    conus phantom sphere -o .
    live sphere.nii.gz
    local step=0
    look '.has_pose == false and .confirmed == []'
    until look '.has_pose == true'; do # over the middle of the 3-D pane
        step=$((step + 1))
        xdotool mousemove --window "$window" $((170 + step % 10)) 148
    done
    tell 'results mouse.tsv'
    until look '.confirmed[0].object == 1'; do # two clicks count as a double one if the frames between are quick enough
        xdotool click --repeat 2 --delay 10 1
    done
    local before
    before=$(jq '.orbit[4]' "look$looks.json")
    xdotool mousedown 1
    until look ".orbit[4] != $before"; do
        step=$((step + 1))
        xdotool mousemove --window "$window" $((170 + 2 * (step % 10))) 148
    done
    xdotool mouseup 1
    leave
    grep -q Sphere mouse.tsv
}

@test "keys reach the panels, their lists and the views" {
    conus phantom nested -o .
    live nested.nii.gz
    tap() { for key; do xdotool key --window "$window" "$key"; pass; done; }
    tell 'aim 60 10 6 0 0 6' 'crosshair 1 2 3' 'orbit 10 0'
    look '.results.order == "rank" and .has_pose == true'
    distance=$(jq '.orbit[3]' look$looks.json)
    tap F6 F6 Down space space # the hits, from the columns' button to their list, its first heading
    look '.results.order == "name" and .frozen == false'
    tap Escape Escape # leave the list, and return to the panes
    look '.has_pose == true'
    tap shift+Right shift+Down shift+Prior ctrl+Prior Left Prior
    look '.crosshair == [2, 1, 4] and .magnification > 1.09 and .magnification < 1.11'
    # 0.025 of a pane's height turns by 3.5 times as much in radians, 5 degrees; a click of the wheel is a tenth
    look "(.orbit[4] * 180 / 3.14159265 - 10 + 5.0134 | fabs) < 0.001 and .orbit[3] < 0.91 * $distance"
    tap Escape
    look '.has_pose == false'
    leave
}

@test "an answer whose tracker is gone is pale, and said to be old" {
    conus phantom sphere -o .
    view sphere.nii.gz --size 1000x640 <<'END'
pointer wand
aim 0 90 0 0 0 0
shot fresh
pointer tracker
shot old
END
    pixels <<'END'
def count(name, x, y, width, height, low, high):
    "How many pixels are between two colours."
    pixels = oiio.ImageBuf(name).get_pixels(oiio.UINT8)[y:y + height, x:x + width, :3]
    return ((pixels >= low) & (pixels <= high)).all(axis=2).sum()
white = (210, 210, 210), (255, 255, 255) # texts have 242, pale ones 0.8 * 242 + 0.2 * 30 = 200
orange = (200, 120, 20), (255, 190, 90)
the_list, pane = (704, 34, 290, 186), (60, 540, 459, 75) # and its text at the lower edge
assert count("fresh.png", *the_list, *white) > 100
assert count("old.png", *the_list, *white) == 0
for place in the_list, pane:
    assert count("fresh.png", *place, *orange) == 0 < 50 < count("old.png", *place, *orange), place
# what is hit, in the colour of the first rank, 0xD2246C, is pale in 3-D and in the axial cut
for place in (60, 60, 459, 460), (525, 30, 170, 170):
    reds = [(oiio.ImageBuf(name).get_pixels(oiio.UINT8).astype(int) @ ((1, -1, 0, 0)))[place[1]:place[1] + place[3],
            place[0]:place[0] + place[2]] > 70 for name in ("fresh.png", "old.png")]
    assert reds[0].sum() > 100 and not reds[1].any(), [red.sum() for red in reds]
# the text is that of headings, where a capital has 22 * 0.71 = 16 pixels, and 11 in lists
high = lambda name, x, y, wide: sum(count(name, x, row, wide, 1, *orange) > 8 for row in range(y, y + 40))
assert high("old.png", 704, 24, 290) >= 14 and high("old.png", 60, 535, 300) >= 14
END
}

# shown PICTURE COLOUR: takes a picture of the window once the cone has this colour. A tool that moves never settles.
shown() {
    until /usr/bin/python3 -B "$BATS_TEST_DIRNAME/cone_colour.py" "$1" "$2"; do
        runs "$child"
        tell 'wait 8' "screenshot $1"
        pass
    done
}

@test "a tracker is connected from inside the window, and a lost tool is grey" {
    need_window
    need_pixels
    conus phantom sphere -o .
    background env PYTHONPATH="$BATS_TEST_DIRNAME" /usr/bin/python3 -B - <<'END'
import os, socket, time
from openigtlink import transform
server = socket.create_server(("127.0.0.1", 0))
with open("port.new", "w") as file:
    print(server.getsockname()[1], file=file)
os.rename("port.new", "port")
conus = server.accept()[0]
try:
    while True:
        conus.sendall(transform(b"PointerToTracker", *((0, 0, 0) if os.path.exists("lose") else (0, 0, 90))))
        time.sleep(0.02)
except OSError:
    pass
END
    local tracker=$child
    wait_until "$tracker" test -e port
    live sphere.nii.gz --size 1280x800 2>said
    tell 'pointer tracker'
    click_at 1150 389 # the field below Point with, in which Enter connects
    xdotool key --window "$window" ctrl+a
    typed "127.0.0.1:$(<port)"
    xdotool keydown --window "$window" Return
    until look '.has_pose == true'; do
        runs "$child"
    done
    xdotool keyup --window "$window" Return
    look '.pointer == "tracker" and .world_from_device[12:15] == [0, 0, 90]'
    shown live.png orange
    touch lose
    shown lost.png grey
    rm lose
    shown back.png orange
    tell 'results live.tsv'
    tell 'tracker off' 'results old.tsv' 'tracker here:there'
    local code=0
    leave || code=$?
    [ $code -eq 3 ]
    diff live.tsv old.tsv # the answer stays
    has_lines 2 said
    grep -q '"here:there" is no address and port' said
}

# at_apex FILE.json: the cone of a session as options of conus query.
at_apex() {
    jq -r '.world_from_device | "--origin=\(.[12]),\(.[13]),\(.[14]) --direction=\(-.[8]),\(-.[9]),\(-.[10])"' "$1"
}

@test "the mouse's cone and ray are asked as by conus query, beside the brain from the eye, and kept" {
    conus phantom nested -o .
    view nested.nii.gz <<'END'
angle 20
point 0.5 0.5
point 0.01 0.01
results cone.tsv
save cone.json
key l
key 1
results ray.tsv
save ray.json
key 1
key l
key x
open ray.json
results opened.tsv
save opened.json
key x
point 0.01 0.01
results eye.tsv
key escape
results none.tsv
save none.json
END
    # shellcheck disable=SC2046 # several words
    conus query nested.nii.gz $(at_apex cone.json) --angle 20 --format tsv -q | diff cone.tsv -
    # shellcheck disable=SC2046
    conus query nested.nii.gz $(at_apex ray.json) --angle 0.1 --resolution 1 --format tsv -q | diff ray.tsv -
    diff ray.tsv opened.tsv
    diff ray.json opened.json
    [ "$(jq -c '[.one_ray, .layers, .start]' ray.json)" = '[true,"all","before"]' ]
    [ "$(grep -c area ray.tsv)" -eq 1 ]
    run -1 grep -q area eye.tsv # past the ball, at a corner of the pane
    grep -q unassigned eye.tsv
    [ "$(wc -l <none.tsv)" -eq 1 ]
    [ "$(jq -c '[.has_pose, .frozen]' none.json)" = '[false,false]' ]
}

@test "a session is saved where it was opened or saved last" {
    conus phantom slabs -o .
    view slabs.nii.gz <<'END'
save one.json
angle 9
key ctrl+s
angle 11
key o
key enter
wait 2
angle 13
key ctrl+s
angle 15
key ctrl+shift+s
type two
key enter
wait 1
angle 16
key ctrl+s
END
    [ "$(jq .angle_deg one.json)" = 9 ]
    [ "$(jq .angle_deg conus-2*.json)" = 13 ] # one file
    [ "$(jq .angle_deg two.json)" = 16 ]
    printf 'angle 17\nkey ctrl+s\n' | view slabs.nii.gz --session one.json
    [ "$(jq .angle_deg one.json)" = 17 ]
}

@test "a click holds the cone, another lets it go, panels do not move it, Escape clears it" {
    conus phantom sphere -o .
    live sphere.nii.gz
    local step=0 pose
    until look '.has_pose == true'; do # over the middle of the 3-D pane
        step=$((step + 1))
        xdotool mousemove --window "$window" $((170 + step % 10)) 148
    done
    pose=$(jq -c .world_from_device "look$looks.json")
    until look ".world_from_device != $pose"; do # the cone follows the mouse
        step=$((step + 1))
        xdotool mousemove --window "$window" $((170 + step % 10)) 148
    done
    xdotool click 1
    until look '.frozen == true'; do :; done
    pose=$(jq -c .world_from_device "look$looks.json")
    xdotool mousemove --window "$window" 177 146 mousemove --window "$window" 172 151 mousemove --window "$window" 30 150
    look ".frozen == true and .world_from_device == $pose"
    xdotool mousedown 1 # a press on a panel is no click on the pane
    look true
    xdotool mousemove --window "$window" 177 148
    look true
    xdotool mouseup 1
    look ".frozen == true and .world_from_device == $pose"
    xdotool click 1
    until look '.frozen == false'; do :; done
    until look ".world_from_device != $pose"; do
        step=$((step + 1))
        xdotool mousemove --window "$window" $((170 + step % 10)) 148
    done
    xdotool mousemove --window "$window" 66 288 # to the pane's corner, beside the ball, then to the panels
    look true
    pose=$(jq -c .world_from_device "look$looks.json")
    xdotool mousemove --window "$window" 30 150 mousemove --window "$window" 450 150 mousemove --window "$window" 450 300
    look ".frozen == false and .world_from_device == $pose"
    xdotool key --window "$window" Escape
    until look '.has_pose == false'; do :; done
    leave
}

@test "the ball before the brain turns the cone about where it enters, and is no click" {
    need_pixels
    conus phantom sphere -o .
    live sphere.nii.gz --size 1000x640
    # the axis enters the sphere of 20 mm at y = 20, 50 mm from its apex
    tell 'aim 0 70 0 0 0 0' 'key space' 'orbit 270 10' settle 'screenshot ball.png'
    look '.frozen == true and .orbit[4] != 0'
    local x y orbit
    read -r x y < <(pixels <<'END'
pixels = oiio.ImageBuf("ball.png").get_pixels(oiio.UINT8)[60:520, 60:519, :3].astype(int) # of the 3-D pane
amber = abs(pixels - (255, 176, 0)).max(axis=2) < 10
inside = numpy.lib.stride_tricks.sliding_window_view(amber, (5, 5)).all(axis=(2, 3)) # of no line
y, x = numpy.argwhere(inside).mean(axis=0).round().astype(int) + 2
print(x + 60, y + 60)
END
    )
    orbit=$(jq -c .orbit "look$looks.json")
    xdotool mousemove --window "$window" "$x" "$y" mousedown 1 mousemove --window "$window" $((x + 20)) $((y + 40))
    pass
    xdotool mouseup 1
    look ".frozen == true and .orbit == $orbit and .crosshair == [0, 0, 0]"
    # the entry is where it was on the axis, at the same depth, and the axis has turned
    jq -e '.world_from_device as $m | [range(3) | $m[12 + .] - 50 * $m[8 + .]] as $entry
        | ($entry[0] | fabs) < 0.5 and ($entry[1] - 20 | fabs) < 0.5 and ($entry[2] | fabs) < 0.5 and $m[9] < 0.97' \
        "look$looks.json"
    leave
}

@test "nothing is drawn while nothing changes" {
    need_window
    command -v xdotool >/dev/null || skip "no xdotool"
    conus phantom sphere -o .
    printf '%s\n' 'pointer mouse' 'aim 0 90 0 0 180 0' settle 'times start.json' 'pause 2' 'times still.json' \
        'screenshot ready.png' 'until moved' >script
    port=$(free_port)
    background timeout $HANG "$CONUS" view sphere.nii.gz --script script --size 1000x640 --listen "$port" --quiet
    local view=$child step=0
    wait_until "$view" test -e ready.png
    find_window
    # a connected program receives what the cone hits: the sphere, once the mouse is over it and a frame was drawn
    exec 5<>"/dev/tcp/127.0.0.1/$port"
    background cat <&5 >told
    until grep -aq Sphere told; do
        runs "$view"
        step=$((step + 1))
        xdotool mousemove --window "$window" $((300 + step % 20)) 300
        sleep 0.05
    done
    exec 5>&-
    touch moved
    wait "$view"
    # the frames of the script's own commands, and events of the new window; 2 s of continuous drawing would be dozens
    [ "$(jq .frame_ms.count still.json)" -lt 15 ]
}

@test "keys pressed while the atlas is being loaded do no harm" {
    export ASAN_OPTIONS=detect_leaks=0 # Mesa forgets 128 bytes of a driver that is unloaded before anything was drawn
    need_window
    command -v xdotool >/dev/null || skip "no xdotool"
    conus phantom nested -o .
    export XDG_STATE_HOME=$PWD/state
    hold_file nested.nii.gz
    background timeout $HANG "$CONUS" view nested.nii.gz --quiet
    wait_until "$child" test -e begun
    wait_until "$child" find_window
    xdotool key --window "$window" --delay 5 plus h u plus h u plus h u plus h u plus h u plus h u
    close_window "$window"
    wait_until "$child" not find_window # so the earlier keys were handled
    touch released
    wait "$child"
}

@test "closed while the atlas is being loaded, it reads no more files" {
    export ASAN_OPTIONS=detect_leaks=0 # Mesa forgets 128 bytes of a driver that is unloaded before anything was drawn
    need_window
    command -v xdotool >/dev/null || skip "no xdotool"
    hold_mesh
    export XDG_STATE_HOME=$PWD/state
    local then code
    for then in close go; do
        rm -f begun released
        background timeout $HANG "$CONUS" view two.atlas.json --quiet 2>said
        wait_until "$child" test -e begun
        wait_until "$child" find_window
        if [ $then = close ]; then
            close_window "$window"
            wait_until "$child" not find_window
            touch released
            wait "$child"
            [ ! -s said ] || { cat said; return 1; }
        else
            touch released
            wait_until "$child" grep -q 'second.surf.gii' said
            close_window "$window"
            code=0
            wait "$child" || code=$?
            [ $code -eq 3 ]
        fi
    done
}

@test "closed, the window remembers its size and place" {
    need_window
    command -v xdotool >/dev/null || skip "no xdotool"
    conus phantom sphere -o .
    export XDG_STATE_HOME=$PWD/state
    background timeout $HANG "$CONUS" view sphere.nii.gz --quiet >said 2>&1
    wait_until "$child" find_window
    wait_until "$child" is_drawn # until then it places itself
    xdotool windowsize "$window" 801 602 windowmove "$window" 31 22
    close_window "$window" # events come in the order of the requests to the display
    wait "$child"
    [ ! -s said ] || { cat said; return 1; }
    [ "$(jq -c '[.width, .height, .x, .y]' state/conus/window.json)" = '[801,602,31,22]' ]
    background timeout $HANG "$CONUS" view sphere.nii.gz --quiet >said 2>&1
    wait_until "$child" find_window
    wait_until "$child" is_at '801x602+31+22'
    close_window "$window"
    wait "$child"
    [ ! -s said ] || { cat said; return 1; }
}

@test "it is no larger than the screen, and keys make texts larger, which is remembered" {
    need_window
    command -v xdotool >/dev/null || skip "no xdotool"
    export XDG_STATE_HOME=$PWD/state
    open_it() {
        background timeout $HANG "$CONUS" view --quiet # on the start page
        wait_until "$child" find_window
    }
    close_it() {
        close_window "$window"
        wait "$child"
    }
    export ASAN_OPTIONS=detect_leaks=0 # Mesa forgets 128 bytes of a driver that is unloaded before anything was drawn
    open_it # 1500 x 940 would be larger than the screen of 1280 x 800
    wait_until "$child" is_at '1280x800+0+0'
    xdotool key --window "$window" ctrl+plus ctrl+plus ctrl+plus ctrl+minus
    close_it
    [ "$(jq -c '[.width, .height, .zoom]' state/conus/window.json)" = '[1280,800,1.21]' ]
    echo '{"width": 600, "height": 3000, "x": 900, "y": -40, "zoom": 1.5, "panels": [300, 0], "division": [0, 0.25]}' \
        >state/conus/window.json
    open_it
    wait_until "$child" is_at '600x800+680+0'
    close_it
    jq -e '. == {width: 600, height: 800, x: 680, y: 0, zoom: 1.5, panels: [300, 0], division: [0, 0.25], folds: [0, 0]}' \
        state/conus/window.json
    open_it
    xdotool key --window "$window" ctrl+0
    close_it
    [ "$(jq .zoom state/conus/window.json)" = 1 ]
    # scripts see the size that they ask for
    need_pixels
    view --size 1400x900 <<<$'wait 4\nscreenshot large.png'
    [[ "$(file large.png)" == *'1400 x 900'* ]]
}

# is_drawn: whether $window has drawn an atlas, whose name is in its title then.
is_drawn() {
    xdotool getwindowname "$window" | grep -q '^conus - '
}

# is_at WxH+X+Y: whether $window is there, and of that size.
is_at() {
    local WIDTH HEIGHT X Y
    eval "$(xdotool getwindowgeometry --shell "$window" | grep -E '^(WIDTH|HEIGHT|X|Y)=')"
    [ "${WIDTH}x$HEIGHT+$X+$Y" = "$1" ]
}

@test "a session has absolute paths, whatever commas are in the names of files" {
    conus phantom slabs -o . --size 16
    mkdir made
    cp slabs.nii.gz made/a,b.nii.gz
    cp slabs.* made
    python3 "$BATS_TEST_DIRNAME/tck.py" made/c,d.tck -5,1,9.9 5,1,9.9
    printf '1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n' >made/flirt.mat
    cd made
    view slabs.nii.gz --atlas-transform flirt.mat,from=a,b.nii.gz,to=slabs.nii.gz,inverse --streamlines c,d.tck,radius=2 \
        --labels slabs.tsv <<<'save one.json'
    jq -e --arg here "$PWD/" '[.opened.options[] | split($here)] ==
        [["--atlas-transform=", "flirt.mat,from=", "a,b.nii.gz,to=", "slabs.nii.gz,inverse"],
         ["--streamlines=", "c,d.tck,radius=2"], ["--labels=", "slabs.tsv"]]' one.json
    cd ..
    view made/one.json <<<'save two.json'
    diff <(jq .opened.options made/one.json) <(jq .opened.options two.json)
    cd made
    printf 'name,x,y,z\nA,1,2,3\n' >points,1.csv
    printf 'x,y,z,tx,ty,tz\n-40,0,0,5,1,1\n' >needle.csv
    view slabs.nii.gz --pose points,1.csv,unit=mm --poses needle.csv --apart needle.csv,3 --depth 40 --reach 1 \
        <<<'save one.json'
    jq -e --arg here "$PWD/" '[.opened.options[] | split($here)] == [["--pose=", "points,1.csv,unit=mm"],
        ["--poses=", "needle.csv"], ["--apart=", "needle.csv,3"], ["--depth=40"], ["--reach=1"]]' one.json
}

@test "sessions that do not fit are refused when they are given or dropped, and a script goes on" {
    conus phantom slabs -o . --size 16
    view slabs.nii.gz <<<'save slabs.json'
    sed 's/"angle_deg": [0-9.]*/"angle_deg": 1e9/' slabs.json >bad.json
    head -c 200 slabs.json >half.json
    echo '{}' >none.json
    run -3 --separate-stderr timeout $HANG "$CONUS" view slabs.nii.gz --session bad.json --script /dev/null --quiet --size 400x256
    check_message 'bad.json: angle_deg: a number from 0.01 to 179.99 is needed'
    printf 'drop %s.json\nwait 2\n' half bad none >script
    run -0 --separate-stderr timeout $HANG "$CONUS" view slabs.nii.gz --script script --quiet --size 400x256
    [[ ${stderr_lines[0]} == 'conus: half.json: line '*': a damaged session' ]]
    [ "${stderr_lines[1]}" = 'conus: bad.json: angle_deg: a number from 0.01 to 179.99 is needed' ]
    # JSON that is no session: which is found only where it is tried as an atlas first, and said on both ways
    [[ ${stderr_lines[2]} == 'conus: none.json: this is JSON of another kind; '* ]]
    [ "${stderr_lines[3]}" = 'conus: none.json: it is no session of conus view either' ]
    [ ${#stderr_lines[@]} -eq 4 ]
}

@test "without a display it names the way out" {
    [ -x "${CONUS%/*}/conus-view" ] || skip "conus-view is not built"
    sphere --size 16
    run -4 --separate-stderr env -u DISPLAY -u WAYLAND_DISPLAY "$CONUS" view sphere.nii.gz
    [[ "$stderr" == *'conus render draws pictures without a window'* ]]
}

# bats test_tags=main
@test "an atlas that is none ends it with a message" {
    need_window
    echo nonsense >none.nii
    export ASAN_OPTIONS=detect_leaks=0 # Mesa forgets 128 bytes of a driver that is unloaded before anything was drawn
    run -3 --separate-stderr timeout $HANG "$CONUS" view none.nii --script /dev/null
    check_message 'none.nii'
}

@test "a script that adds what cannot be read ends with its code" {
    need_window
    conus phantom u-shape -o .
    local command
    for command in 'context none.nii' 'pathway none.nii' 'pose none.csv'; do
        printf '%s\nsettle\nresults after.tsv\n' "$command" >script
        run -3 --separate-stderr timeout $HANG "$CONUS" view u-shape.nii.gz --script script --quiet --size 400x256
        check_message "${command#* }: cannot open"
        [ ! -e after.tsv ]
    done
}

@test "actions at random do no harm" {
    need_window
    conus phantom u-shape -o .
    conus phantom bundle -o .
    /usr/bin/python3 "${BATS_TEST_DIRNAME:?}"/random_actions 80 5 bundle.tck >script
    run -0 --separate-stderr timeout $HANG "$CONUS" view u-shape.nii.gz --script script --quiet --size 320x240
    # When a file is added again, its points do not have to be near the areas; no other note is allowed.
    not grep -vE 'not added: bundle|not as when it was opened|hemispheres: merged' <<<"$stderr"
}

@test "any size while it draws, pictures and the gl engine beside its own context" {
    conus phantom nested -o .
    view nested.nii.gz --size 1x1 <<'END'
results none.tsv
aim 0 90 3 0 0 0
wait 5
results tiny.tsv
save rays.json
size 1 1
wait 3
key l
size 700 500
wait 8
aim 60 0 6 0 0 6
size 1200 700
wait 2
size 90 600
orbit 10 20
wait 4
size 640 480
shot last
picture large.png 320 200
times times.json
END
    [ "$(wc -l <none.tsv)" -eq 1 ] # before there is a cone
    grep -q Shell tiny.tsv
    grep -q '"selection_ms": {"count": ' times.json
    grep -q '"first_picture_ms": [1-9]' times.json
    sed 's/"engine": "[a-z]*"/"engine": "gl"/' rays.json >gl.json
    echo 'results gl.tsv' | view nested.nii.gz --session gl.json
    sed 's/"engine": "[a-z]*"/"engine": "rays"/' rays.json >rays1.json
    echo 'results rays.tsv' | view nested.nii.gz --session rays1.json
    cut -f 1-8 gl.tsv >gl && cut -f 1-8 rays.tsv | diff gl -
}

@test "files that go away while it is open" {
    conus phantom slabs -o . --size 32
    live slabs.nii.gz 2>said
    rm slabs.*
    tell 'aim 3 90 2 3 0 2' 'choose "Slab anterior"' 'key i' settle 'results after.tsv' 'picture after.png 64 64'
    leave
    [ ! -s said ]
    grep -q 'Slab' after.tsv
}

@test "unmapped and made tiny from outside" {
    conus phantom sphere -o .
    live sphere.nii.gz
    for size in '1 1' '300 900' '3 500' '500 320'; do
        # shellcheck disable=SC2086 # two words
        xdotool windowunmap "$window" windowsize "$window" $size windowmap "$window"
        look true
    done
    tell 'aim 0 90 0 0 0 0' 'results outside.tsv'
    leave
    grep -q Sphere outside.tsv
}

@test "a wand needs no pose to start, and keys save" {
    conus phantom sphere -o .
    view sphere.nii.gz <<'END'
pointer wand
key w
results placed.tsv
save placed.json
key w
save moved.json
key o
key enter
wait 2
key p
key enter
wait 2
screenshot window.png
END
    grep -q Sphere placed.tsv
    run -1 diff placed.json moved.json
    diff moved.json conus-2*.json
    [ "$(ls conus-2*.png | wc -l)" -eq 1 ]
    need_pixels
    /usr/bin/python3 - conus-2*.png <<'END'
import sys
import OpenImageIO as oiio
assert oiio.ImageBuf(sys.argv[1]).get_pixels(oiio.UINT8).shape[:2] == (256, 400)
END
}

@test "the right button in a cut puts the wand there" {
    conus phantom sphere -o .
    live sphere.nii.gz
    tell 'pointer wand'
    xdotool mousemove --window "$window" 320 20 # in the axial pane, above its middle: in front of the sphere
    look '.has_pose == false'
    xdotool mousedown 3
    until look '.has_pose == true'; do :; done
    xdotool mouseup 3
    tell 'results wand.tsv'
    leave
    grep -q Sphere wand.tsv
}

# watched ATLAS [OPTION...]: starts a window for looking at its status line, with the mouse over its panels.
watched() {
    rm -f commands look*.json pass*.json
    xdotool mousemove 5 5
    live "$@" --size 1000x640 # its words need the width
    tell 'angle 5' 'pointer wand' 'wait 3' 'screenshot before.png'
    wait_until "$child" test -e before.png
}

# status_at X Y PNG: takes a picture once the window has noticed that the mouse, which was elsewhere, is there.
status_at() {
    rm -f "$3"
    xdotool mousemove --window "$window" "$1" "$2"
    until [ -e "$3" ] && not cmp -s before.png "$3"; do
        rm -f "$3"
        tell 'wait 3' "screenshot $3"
        wait_until "$child" test -e "$3"
    done
    cp "$3" before.png
}

@test "the status line names the place under the mouse and the area there" {
    need_window
    command -v xdotool >/dev/null || skip "no xdotool"
    sphere
    local name
    for name in Sphere Ball; do
        printf 'index\tname\n1\t%s\n' "$name" >sphere.tsv
        watched sphere.nii.gz
        cp before.png "$name-cross.png" # the mouse is over the panels
        status_at 640 110 "$name.png"
        status_at 655 110 beside.png
        status_at 640 110 "$name-again.png"
        leave
        rm before.png
    done
    # another atlas with a smaller ball, so that a point in 3-D is deeper; in a cut the place is the same
    conus phantom sphere -o small --size 16
    watched sphere.nii.gz --atlas small/sphere.nii.gz
    status_at 640 110 both.png
    status_at 316 300 space.png
    status_at 640 110 both-again.png
    leave
    pixels <<'END'
names = ("Sphere", "Sphere-again", "beside", "Ball", "Ball-again", "both", "space", "both-again", "Sphere-cross",
         "Ball-cross")
line = {name: oiio.ImageBuf(name + ".png").get_pixels(oiio.UINT8)[-24:] for name in names}
assert (line["Sphere"] == line["Sphere-again"]).all()
assert (line["Ball"] == line["Ball-again"]).all()
assert (line["Ball"] != line["beside"]).any()  # the place
assert (line["Sphere"] != line["Ball"]).any()  # the name
assert (line["Sphere-cross"] != line["Ball-cross"]).any()
assert (line["both"] != line["Ball"]).any()    # two names
assert (line["both"] != line["space"]).any()
assert (line["both"] == line["both-again"]).all()
END
}

@test "the window replaces no file that it has read, and its own as often as one likes" {
    need_window
    conus phantom u-shape -o .
    ln u-shape.tsv hard.tsv
    ln -s u-shape.nii.gz soft.png
    sha256sum u-shape.tsv u-shape.nii.gz >before
    local command
    for command in 'results hard.tsv' 'export u-shape.tsv' 'screenshot soft.png' 'figure soft.png'; do
        printf 'aim 60 0 6 0 0 6\nsettle\n%s\n' "$command" >script
        run -3 --separate-stderr timeout $HANG "$CONUS" view u-shape.nii.gz --script script --quiet --size 400x256
        [[ "$stderr" == *"would overwrite the input u-shape."* ]]
    done
    sha256sum -c --quiet before
    view u-shape.nii.gz <<'END'
aim 60 0 6 0 0 6
settle
save left.json
open left.json
settle
save left.json
export rows.tsv
export rows.tsv
END
}
