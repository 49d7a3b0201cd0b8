#!/usr/bin/env bats
# Files added to an atlas that is open in the window: tractograms, pathways and contexts.
load helpers
load window

AIM=$'angle 30\naim 3 4 40 3 4 0'

# Two slabs across y as the atlas; three streamlines on them; an image; a pathway.
scene() {
    export XDG_STATE_HOME=$PWD/state XDG_DATA_DIRS=$PWD/data HOME=$PWD/home
    conus phantom slabs -o . --size 32
    conus phantom sphere -o . --size 32
    python3 "$BATS_TEST_DIRNAME/tck.py" two.tck -5,1,9.9 5,1,9.9 -- 0,0,9.9 3,0,9.9 3,4,9.9
    python3 "$BATS_TEST_DIRNAME/tck.py" more.tck 4,-5,9.9 4,5,9.8
    image t1 f 16
}

# image NAME TYPE SIZE: SIZE^3 random numbers in the box of the slabs: B whole ones up to 255, f others.
image() {
    python3 -c '
import random, struct, sys
random.seed(4)
name, type, side = sys.argv[1], sys.argv[2], int(sys.argv[3])
step = 60 / side
head = bytearray(352)
struct.pack_into("<i", head, 0, 348)
struct.pack_into("<8h", head, 40, 3, side, side, side, 1, 1, 1, 1)
struct.pack_into("<2h", head, 70, *{"B": (2, 8), "f": (16, 32)}[type])
struct.pack_into("<8f", head, 76, 1, step, step, step, 1, 1, 1, 1)
struct.pack_into("<f", head, 108, 352)
struct.pack_into("<h", head, 254, 4)
struct.pack_into("<12f", head, 280, step, 0, 0, -30, 0, step, 0, -30, 0, 0, step, -30)
head[344:348] = b"n+1\0"
values = [random.randrange(256) + (0.5 if type == "f" else 0) for _ in range(side ** 3)]
open(name + ".nii", "wb").write(bytes(head) + struct.pack("<%d%s" % (side ** 3, type), *values))' "$@"
}

# queried [OPTION...]: the answer of conus for the pose of the tests.
queried() {
    conus query slabs.nii.gz "$@" --origin 3,4,40 --toward 3,4,0 --angle 30 --format tsv --quiet
}

# said [ARGUMENT...] <SCRIPT: runs view, which ends with $CODE or 0; $stderr is what the window prints besides.
said() {
    cat >script
    run "-${CODE:-0}" --separate-stderr timeout $HANG "$CONUS" view "$@" --script script --quiet --size 400x256
}

# says TEXT: a line of the last run's messages has TEXT.
says() {
    [ "$(grep -cF -e "$1" <<<"$stderr")" = 1 ] || { echo "said: $stderr"; echo "wanted: $1"; return 1; }
}

# bats test_tags=main
@test "a tractogram that is dropped, opened, typed or added by a script is asked as by conus query" {
    scene
    view slabs.nii.gz <<END
$AIM
drop two.tck
results dropped.tsv
key ctrl+o
type $PWD/more.tck
wait 2
key enter
wait 2
results opened.tsv
take-out two.tck
results less.tsv
key ctrl+n
type $PWD/two.tck
key enter
results typed.tsv
take-out two.tck
take-out more.tck
results none.tsv
streamlines two.tck,radius=3,name=Arc
pathway sphere.nii.gz,threshold=0.5
context t1.nii
results last.tsv
save last.json
END
    queried --streamlines two.tck | diff dropped.tsv -
    queried --streamlines two.tck --streamlines more.tck | diff opened.tsv -
    queried --streamlines more.tck | diff less.tsv -
    queried --streamlines more.tck --streamlines two.tck | diff typed.tsv -
    queried | diff none.tsv -
    queried --pathway sphere.nii.gz,threshold=0.5 --streamlines two.tck,radius=3,name=Arc | diff last.tsv -
    # each differs from the others, so that nothing is compared with itself
    [ "$(sha256sum dropped.tsv opened.tsv less.tsv none.tsv last.tsv | cut -d' ' -f1 | sort -u | wc -l)" = 5 ]
    # the session has the option, file and numbers of each; numbers of pathways come before those of bundles
    jq -e --arg here "$PWD" --arg sum "$(sha256sum two.tck | cut -d' ' -f1)" --argjson bytes "$(stat -c %s two.tck)" '
        .opened.added[0] == {option: "--streamlines=\($here)/two.tck,radius=3,name=Arc", path: "\($here)/two.tck",
            sha256: $sum, bytes: $bytes, objects: [4]} and
        .opened.options == ["--streamlines=\($here)/two.tck,radius=3,name=Arc",
            "--pathway=\($here)/sphere.nii.gz,threshold=0.5", "--context=\($here)/t1.nii"] and
        [.opened.added[] | .objects] == [[4], [3], []] and all(.opened.added[]; .sha256 | length == 64)' last.json
}

# enter_line TEXT: types it into the line that has the keyboard.
enter_line() {
    typed "$1"
    enter
}

@test "the list of what was added adds, changes and takes out" {
    scene
    live slabs.nii.gz --size 1000x640
    tell "$AIM" 'key ctrl+l'
    pass
    enter_line "$PWD/two.tck,radius=2"
    look '.opened.added[0].objects == [3] and (.opened.options[0] | endswith("/two.tck,radius=2"))'
    # the list stays open for the next one
    tell 'results one.tsv' 'key ctrl+l' 'key ctrl+l'
    pass
    enter_line "$PWD/more.tck"
    look '.objects == 4'
    tell 'results two.tsv'
    # Change and Remove of the first one: the list is 620 x 400 pixels in the middle of 1000 x 640
    click_at 294 154
    enter_line ,name=Arc
    look '[.opened.options[] | split("/")[-1]] == ["more.tck", "two.tck,radius=2,name=Arc"]'
    tell 'results changed.tsv'
    click_at 228 154
    look '[.opened.options[] | split("/")[-1]] == ["two.tck,radius=2,name=Arc"] and .objects == 3'
    # a file, its radius, that it moves, and not, and Add
    tell 'key ctrl+l' 'key ctrl+l'
    pass
    typed "$PWD/more.tck"
    click_at 606 360
    typed 1.5
    click_at 203 414
    click_at 203 414
    click_at 217 441
    look '.opened.options[1] | endswith("/more.tck,radius=1.5")'
    leave
    queried --streamlines two.tck,radius=2 | diff one.tsv -
    queried --streamlines two.tck,radius=2 --streamlines more.tck | diff two.tsv -
    queried --streamlines more.tck --streamlines two.tck,radius=2,name=Arc | diff changed.tsv -
}

@test "settings stay while files are added and removed, and can be undone" {
    scene
    view slabs.nii.gz <<END
$AIM
streamlines two.tck,radius=2
key enter
drop more.tck
choose more
key h
opacity more 0.5
orbit 33 12
wait 2
angle 20
wait 2
save before.json
take-out two.tck
wait 2
save less.json
pathway sphere.nii.gz
wait 2
save other.json
key ctrl+z
wait 2
save undone.json
streamlines two.tck
wait 2
save back.json
results back.tsv
END
    # more.tck is object 4, then 3, then 4 again behind the pathway
    [ "$(jq -c '.hidden, .look.opacities, .angle_deg, .objects' before.json | tr '\n' ' ')" = '[4] [[4,0.5]] 20 4 ' ]
    [ "$(jq -c '.hidden, .look.opacities, .angle_deg, .objects' less.json | tr '\n' ' ')" = '[3] [[3,0.5]] 20 3 ' ]
    [ "$(jq -c '.hidden, .look.opacities, .angle_deg, .objects' other.json | tr '\n' ' ')" = '[4] [[4,0.5]] 20 4 ' ]
    # one step: adding and removing files is no step
    [ "$(jq -c '.hidden, .look.opacities, .angle_deg, .objects' undone.json | tr '\n' ' ')" = '[4] [[4,0.5]] 30 4 ' ]
    [ "$(jq -c '.hidden, .objects' back.json | tr '\n' ' ')" = '[4] 5 ' ]
    diff <(jq -c .orbit before.json) <(jq -c .orbit back.json)
    # a confirmed object keeps its name when its file is gone, also in an earlier state
    jq -e '[.confirmed[].object] == [3]' before.json
    for file in less other undone; do
        jq -e '[.confirmed[] | [.object, .name]] == [[0, "two"]]' $file.json
    done
    queried --pathway sphere.nii.gz --streamlines more.tck --streamlines two.tck --hide more | diff back.tsv -
}

@test "several files that are dropped at once are told apart, in any order" {
    need_window
    scene
    for order in 't1.nii slabs.nii.gz two.tck' 'two.tck slabs.nii.gz t1.nii'; do
        said <<END
drop $order
$AIM
results all.tsv
save all.json
END
        queried --streamlines two.tck | diff all.tsv -
        jq -e '[.opened.options[] | split("/")[-1]] == ["t1.nii", "two.tck"]' all.json
    done
    said slabs.nii.gz <<END
drop t1.nii two.tck
save both.json
END
    [ -z "$stderr" ]
    jq -e '[.opened.options[] | split("/")[-1]] == ["t1.nii", "two.tck"]' both.json
    # voxels may be whole numbers, too, and another volume replaces the first
    conus phantom brain -o brain
    conus phantom nested -o .
    said slabs.nii.gz <<END
drop t1.nii
drop brain/brain-context.nii.gz
save grey.json
take-out brain/brain-context.nii.gz
drop nested.nii.gz two.tck slabs.nii.gz
drop t1.nii two.tck brain/brain-context.nii.gz
save same.json
END
    jq -e '[.opened.options[] | split("/")[-1]] == ["brain-context.nii.gz"]' grey.json
    says 'nested.nii.gz and slabs.nii.gz are two atlases or sessions: open one of them'
    says 't1.nii and brain/brain-context.nii.gz are two images: open one of them'
    jq -e '.atlas == "slabs.nii.gz" and .opened.options == []' same.json
}

@test "files that cannot be added are refused in one line and change nothing" {
    need_window
    scene
    head -c 70 two.tck >cut.tck
    python3 "$BATS_TEST_DIRNAME/tck.py" far.tck 500,0,0 500,9,0
    printf '# vtk DataFile Version 3.0\nSPACE=RAS\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n%s\nLINES 1 4\n3 0 1 2\n' \
        '0 0 0 9 9 9 20 20 20' >voxels.vtk
    head -c 400 t1.nii >cut.nii
    said slabs.nii.gz <<END
$AIM
streamlines two.tck
save first.json
results first.tsv
drop cut.tck
drop two.tck
drop gone.tck
drop cut.nii
drop voxels.vtk
drop far.tck
results last.tsv
save last.json
drop far.tck
results far.tsv
END
    diff first.tsv last.tsv
    diff <(jq -S . first.json) <(jq -S . last.json)
    queried --streamlines two.tck --streamlines far.tck | diff far.tsv -
    [ "$(wc -l <<<"$stderr")" = 6 ]
    says 'cut.tck: file: found offset 80, the file has 70 bytes'
    says 'two.tck: bundle two: another bundle has that name'
    says 'gone.tck: cannot open'
    says 'cut.nii: '
    says 'are they voxel indices, not mm? If all is well, add it once more.'
    says 'none of 2 points is in the box around the areas: is it in their space?'
    # a script ends where what it adds is refused
    local line
    for line in 'more.tck,name=two bundle two: another bundle has that name' \
        'more.tck,radius=-1 radius: found "-1", allowed is a number above 0' \
        'more.tck,moves there is no --atlas-transform that could move it'; do
        rm -f last.tsv
        CODE=3 said slabs.nii.gz <<END
$AIM
streamlines two.tck
streamlines ${line%% *}
results last.tsv
END
        says "${line#* }"
        [ ! -e last.tsv ]
    done
    # without an atlas nothing can be added
    printf 'drop two.tck\nwait 2\n' >script
    ASAN_OPTIONS=detect_leaks=0 run -0 --separate-stderr timeout $HANG "$CONUS" view --script script --quiet
    check_message 'two.tck: a tractogram: open the atlas that it belongs to first'
}

@test "a session finds what was added, and opens without what is gone" {
    need_window
    scene
    image map B 16
    mkdir made
    (cd made && cp ../slabs.* ../two.tck ../more.tck ../map.nii ../t1.nii . &&
        printf '%s\n' "$AIM" 'drop t1.nii' 'streamlines two.tck,radius=2' 'pathway map.nii,threshold=50' \
            'streamlines more.tck' 'threshold map 250' 'choose more' 'key h' 'results made.tsv' 'save made.json' >script &&
        timeout $HANG "$CONUS" view slabs.nii.gz --script script --quiet --size 400x256)
    queried --pathway map.nii,threshold=250 --streamlines two.tck,radius=2 --streamlines more.tck --hide more |
        diff made/made.tsv -
    grep -q $'\tmap\t' made/made.tsv
    # the file is elsewhere, and has another name, which its bundle has then
    mv made moved
    mv moved/two.tck moved/renamed.tck
    printf 'results found.tsv\nsave found.json\n' | view moved/made.json
    sed 's/\tbundle\t1\ttwo\t/\tbundle\t1\trenamed\t/' moved/made.tsv | diff found.tsv -
    jq -e '[.opened.options[] | split("/")[-1]] ==
        ["t1.nii", "renamed.tck,radius=2", "map.nii,threshold=50", "more.tck"] and .hidden == [5]' found.json
    # more.tck was hidden, and stays hidden whichever other file is gone
    mkdir gone
    mv moved/renamed.tck moved/map.nii gone
    said moved/made.json <<<$'results less.tsv\nsave less.json'
    check_message 'made.json is opened; not found: two.tck, map.nii'
    [ "$(wc -l <<<"$stderr")" = 1 ]
    queried --streamlines more.tck --hide more | diff less.tsv -
    # the file keeps what was not found, with numbers behind those of all others
    jq -e '.hidden == [3] and .chosen == 3 and .objects == 5 and
        [.opened.options[] | split("/")[-1]] == ["t1.nii", "more.tck", "two.tck,radius=2", "map.nii,threshold=50"] and
        [.opened.added[] | select(.lost) | .objects] == [[4], [5]]' less.json
    # what was chosen in a file that is gone, too: slabs, two.tck, map.nii, more.tck
    mv moved/more.tck gone
    said moved/made.json <<<'save fewer.json'
    jq -e '.hidden == [5] and .chosen == 5' fewer.json
    mv gone/more.tck moved
    # so what is there again later is opened, with what was set for it, beside an atlas that was just found, too
    mkdir back
    cp moved/* back
    cp gone/* back
    mv moved away
    printf 'drop back/slabs.nii.gz\nresults back.tsv\nkey ctrl+s\n' >script
    mkdir own
    cp less.json own/elsewhere.json
    run -0 --separate-stderr timeout $HANG "$CONUS" view own/elsewhere.json --script script --quiet --size 400x256
    [[ $stderr == *'elsewhere.json: its atlas is not found'* ]]
    [ "$(wc -l <<<"$stderr")" = 1 ]
    queried --pathway map.nii,threshold=250 --streamlines more.tck --streamlines gone/renamed.tck,radius=2 --hide more |
        diff back.tsv -
    jq -e '.objects == 5 and all(.opened.added[]; .lost == null)' own/elsewhere.json
    mv away moved
    # another file in its place is reported in the window only
    python3 "$BATS_TEST_DIRNAME/tck.py" moved/more.tck 4,-5,9.9 4,6,9.8
    said moved/made.json <<<'results other.tsv'
    queried --streamlines moved/more.tck --hide more | diff other.tsv -
}

# Numbers of objects mean nothing where a file is another one.
@test "what a session says of an object is said of that object, or refused" {
    need_window
    scene
    printf '%s\n' "$AIM" 'choose "Slab anterior"' 'key h' 'key enter' 'save one.json' | view slabs.nii.gz
    jq -e '.hidden == [1] and .confirmed[0].name == "Slab posterior" and
        .named == [[1, 1, "Slab anterior"], [2, 300, "Slab posterior"]]' one.json
    # the names in the table are exchanged
    sed -i 's/anterior/X/; s/posterior/anterior/; s/X/posterior/' slabs.tsv
    CODE=3 said slabs.nii.gz --session one.json </dev/null
    says 'one.json: number 1 was "Slab anterior", here it is "Slab posterior": the file, or its label table, is another one'
    # what two areas of one name would be told apart by
    jq '.named[0][1] = 7' one.json >label.json
    sed -i 's/anterior/X/; s/posterior/anterior/; s/X/posterior/' slabs.tsv
    CODE=3 said slabs.nii.gz --session label.json </dev/null
    says 'label.json: "Slab anterior" had label 7, here it has 1: the file, or its label table, is another one'
    # a session of an earlier conus has no names but those of what was kept, which stay
    jq 'del(.named)' one.json >old.json
    sed -i 's/posterior/caudal/' slabs.tsv
    view slabs.nii.gz --session old.json <<<'save new.json'
    jq -e '.hidden == [1] and [.confirmed[] | [.object, .name]] == [[0, "Slab posterior"]]' new.json
}

@test "settings of a group stay with its name, and with its file where that has another name" {
    need_window
    scene
    python3 - <<'END'
import json, os, struct
identity = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
head = {"DIMENSIONS": [9, 9, 9], "VOXEL_TO_RASMM": identity, "NB_VERTICES": 4, "NB_STREAMLINES": 2}
points = [-5, 1, 9.9, 5, 1, 9.9, 0, 0, 9.9, 3, 4, 9.9]
os.makedirs("two.trx/groups")
for name, data in {"header.json": json.dumps(head).encode(), "positions.3.float32": struct.pack("<12f", *points),
                   "offsets.uint64": struct.pack("<3Q", 0, 2, 4), "groups/arc.uint32": struct.pack("<I", 0),
                   "groups/line.uint32": struct.pack("<I", 1)}.items():
    open("two.trx/" + name, "wb").write(data)
END
    printf '%s\n' 'streamlines two.trx' 'streamlines more.tck' 'choose arc' 'key h' 'choose more' 'key h' 'save one.json' |
        view slabs.nii.gz
    jq -e '.hidden == [3, 5] and [.named[] | .[2]] == ["arc", "more"]' one.json
    mv two.trx/groups/arc.uint32 two.trx/groups/zone.uint32 # which is the second one then
    mv more.tck other.tck
    said one.json <<<'save two.json'
    [ -z "$stderr" ] || { echo "said: $stderr"; return 1; }
    jq -e '.hidden == [5] and [.named[] | .[2]] == ["other"]' two.json
}

# The atlases share the image, and so the grey values of the cuts.
@test "what was set of a context that is not found stays in the session" {
    need_window
    scene
    local of_context='[.transfer, .preset, .look.grey, .further_atlases[].look.grey]'
    printf '%s\n' 'preset bright' 'grey 20 210' 'save set.json' |
        view slabs.nii.gz --atlas sphere.nii.gz --context t1.nii
    jq '.transfer = [[10, 1, 0, 0, 0.25], [200, 0, 1, 0, 0.5]]' set.json >edited.json
    jq -e "$of_context"' == [[[10, 1, 0, 0, 0.25], [200, 0, 1, 0, 0.5]], "bright", [20, 210], [20, 210]]' edited.json
    mkdir gone
    mv t1.nii gone
    said edited.json <<<'save without.json'
    says 'edited.json is opened; not found: t1.nii'
    diff <(jq "$of_context" edited.json) <(jq "$of_context" without.json)
    mv gone/t1.nii .
    view without.json <<<'save again.json'
    diff <(jq "$of_context" edited.json) <(jq "$of_context" again.json)
}

@test "escape ends the reading of a tractogram, and the atlas stays" {
    scene
    hold_file slabs.nii.gz
    touch released # the first load
    live slabs.nii.gz 2>said
    tell "$AIM" 'save before.json'
    look true
    rm begun released
    drop "$PWD/two.tck" # the atlas is read again before it is added
    wait_until "$child" test -e begun
    xdotool key --window "$window" Escape
    touch released
    tell 'save after.json' 'results after.tsv'
    look '.opened.options == []'
    diff before.json after.json
    queried | diff after.tsv -
    # a dropped file is read while the window does other things
    rm begun released
    drop "$PWD/slabs.nii.gz"
    wait_until "$child" test -e begun
    close_window "$window"
    is_hidden() { ! find_window; }
    wait_until "$child" is_hidden
    touch released
    leave
    [ ! -s said ]
}
