#!/usr/bin/env bats
# conus render, as a user types it.
load helpers
SMALL='--size 160x120 --slices 60'

# png_size FILE: its width and height, from the header.
png_size() {
    [ "$(head -c 8 "$1" | od -An -tx1 | tr -d ' ')" = 89504e470d0a1a0a ]
    head -c 24 "$1" | tail -c 8 | od -An -tu1 | awk '{ print $3 * 256 + $4 "x" $7 * 256 + $8 }'
}

# bats test_tags=main
@test "an atlas becomes a picture of the size asked for" {
    sphere --size 32
    gl render sphere.nii.gz -o ball.png $SMALL
    [ "$(png_size ball.png)" = 160x120 ]
    gl render sphere.nii.gz -o ball.exr $SMALL
    [ "$(head -c 4 ball.exr | od -An -tx1 | tr -d ' ')" = 762f3101 ]
    [ -z "$output" ]
}

@test "a cone, a camera and the legend change it" {
    sphere --size 32
    gl render sphere.nii.gz -o plain.exr $SMALL
    gl render sphere.nii.gz -o cone.exr $SMALL --origin 0,0,60 --toward 0,0,0 --angle 20
    gl render sphere.nii.gz -o bare.exr $SMALL --origin 0,0,60 --toward 0,0,0 --angle 20 --no-legend
    gl render sphere.nii.gz -o top.exr $SMALL --camera-origin 0,0,300 --camera-toward 0,0,0 --camera-up 0,1,0
    for other in cone bare top; do
        run -1 conus diff plain.exr $other.exr
    done
    run -1 conus diff cone.exr bare.exr
}

@test "the camera's and the cone's pose may come from files" {
    sphere --size 32
    printf 'x,y,z,tx,ty,tz,ux,uy,uz\n0,0,300,0,0,0,0,1,0\n' >camera.csv
    gl render sphere.nii.gz -o a.exr $SMALL --camera-origin 0,0,300 --camera-toward 0,0,0 --camera-up 0,1,0
    gl render sphere.nii.gz -o b.exr $SMALL --camera camera.csv
    answers diff a.exr b.exr
    printf 'x,y,z,tx,ty,tz,angle\n0,0,60,0,0,0,20\n' >cone.csv
    gl render sphere.nii.gz -o a.exr $SMALL --origin 0,0,60 --toward 0,0,0 --angle 20
    gl render sphere.nii.gz -o b.exr $SMALL --pose cone.csv
    answers diff a.exr b.exr
    fails 2 '--angle has no effect: the pose in cone.csv has its own' \
        render sphere.nii.gz -o c.png --pose cone.csv --angle 5
    printf '0,0,60,0,0,0,20\n' >>cone.csv
    printf 'x,y,z,tx,ty,tz\n0,0,60,0,0,60\n' >bad.csv
    fails 3 'bad.csv:2: toward: is the origin itself' render sphere.nii.gz -o c.png --camera bad.csv
    [ ! -e c.png ]
}

# session: six poses on a sphere; one is broken and one has a name that no file can have.
session() {
    printf 'query_id,x,y,z,tx,ty,tz,angle\n' >session.csv
    printf '%s\n' 'left,-60,0,0,0,0,0,20' 'top,0,0,60,0,0,0,20' 'broken,0,0,60,0,0,60,20' \
        '../a/b:c,60,0,0,0,0,0,20' 'left,-60,0,5,0,0,0,20' ',0,60,0,0,0,0,20' >>session.csv
}

# bats test_tags=main
@test "every pose of a file becomes a picture with a name of its own" {
    sphere --size 32
    session
    run --separate-stderr "$CONUS" render sphere.nii.gz --poses session.csv -o 'fig-{row}-{query}.exr' $SMALL -q
    [ "$status" -ne 4 ] || need_gl
    [ "$status" -eq 1 ]
    check_message 'session.csv:4: toward: is the origin itself'
    [ "$(echo ./*.exr)" = './fig-1-left.exr ./fig-2-top.exr ./fig-4-_._a_b_c.exr ./fig-5-left.exr ./fig-6-6.exr' ]
    gl render sphere.nii.gz --origin 0,0,60 --toward 0,0,0 --angle 20 -o alone.exr $SMALL
    answers diff alone.exr fig-2-top.exr
    gl render sphere.nii.gz --pose session.csv --row 5 -o fifth.exr $SMALL -q
    answers diff fifth.exr fig-5-left.exr
    gl render sphere.nii.gz --poses session.csv --query-id top -o 'x-{query}.exr' $SMALL -q
    cmp x-top.exr fig-2-top.exr
    run -1 conus diff fig-1-left.exr fig-5-left.exr
}

@test "poses that cannot all be drawn are refused before any is" {
    sphere --size 16
    session
    local render=(render sphere.nii.gz --poses session.csv)
    fails 2 'the poses in lines 2 and 6 would both be drawn into left.png' "${render[@]}" -o '{query}.png'
    fails 2 '--output: "{name}" stands for nothing, allowed are {query}, {row} and {frame}' "${render[@]}" -o '{row}{name}.png'
    fails 2 '--output: "{row.png" stands for nothing' "${render[@]}" -o '{row.png'
    fails 2 '--output: {query} and {row} stand for poses of a file' render sphere.nii.gz -o '{query}.png'
    fails 2 '--row 7: session.csv has 6 poses' "${render[@]}" -o a.png --row 7
    fails 2 '--angle has no effect: a picture of several poses, or of points, shows them as balls' \
        "${render[@]}" -o a.png --angle 5
    fails 2 '--query-id: session.csv has no pose "tp", did you mean "top"?' "${render[@]}" -o a.png --query-id tp
    cp "$BATS_TEST_DIRNAME/../fuzz/corpus/poses/brainsight.txt" .
    fails 2 '--query-id: brainsight.txt has no pose "M1 left", did you mean "target/M1 left"?' \
        render sphere.nii.gz --poses brainsight.txt -o a.png --query-id 'M1 left'
    fails 2 '--row and --query-id exclude each other' "${render[@]}" -o a.png --row 1 --query-id top
    fails 2 '--row has no effect without --poses' render sphere.nii.gz -o a.png --row 1
    fails 2 '--pose and --poses exclude each other' "${render[@]}" --pose session.csv -o a.png
    fails 2 '--angle has no effect: every pose in session.csv has its own' "${render[@]}" -o '{row}.png' --angle 5
    cp session.csv session.png
    fails 2 '--output session.png would overwrite the input session.png' \
        render sphere.nii.gz --poses session.png --query-id top -o 'session.png' -q
    fails 3 'session.csv:4: toward: is the origin itself' "${render[@]}" -o a.png --row 3 -q
    [ ! -e a.png ] && [ ! -e 1.png ] && [ ! -e left.png ]
}

# 85 mm at 300 pixels per 25.4 mm are 1003.94 pixels, three quarters of it 752.95.
@test "a figure for a paper has its width in mm, and says so" {
    sphere --size 16
    gl render sphere.nii.gz -o a.png --width-mm 85 --slices 4
    [ "$(png_size a.png)" = 1004x753 ]
    # 300 / 0.0254 = 11811.02 per metre
    [ "$(grep -abo pHYs a.png | head -1 | cut -d : -f 1)" -gt 0 ]
    [ "$(grep -ao 'pHYs........' a.png | head -c 12 | tail -c 4 | od -An -tx1 | tr -d ' ')" = 00002e23 ]
    gl render sphere.nii.gz -o b.png --width-mm 50 --height-mm 20 --dpi 127 --slices 20
    [ "$(png_size b.png)" = 250x100 ]
    local cone=(--origin=-60,0,0 --toward=0,0,0 --angle 20 --size 320x240 --slices 20)
    gl render sphere.nii.gz -o c.png "${cone[@]}" --legend below --background white --view left
    [[ "$(png_size c.png)" = 320x* ]] && [ "$(png_size c.png)" != 320x240 ]
    gl render sphere.nii.gz -o d.png "${cone[@]}" --legend right --background '#102030' --view top --safe-colours
    [ "$(png_size d.png)" = 320x240 ]
}

@test "areas let light through, and pathways are haze" {
    conus phantom slabs -o . --size 24
    sphere --size 24
    local scene=(render slabs.nii.gz --pathway "sphere.nii.gz,threshold=0.5,name=tract" $SMALL -q)
    gl "${scene[@]}" -o plain.exr
    gl "${scene[@]}" -o half.exr --opacity 0.5
    gl "${scene[@]}" -o one.exr --opacity 1=0.5
    gl "${scene[@]}" -o haze.exr --pathway-transfer heat
    gl "${scene[@]}" -o named.exr --pathway-transfer tract=heat
    answers diff haze.exr named.exr
    for other in half one haze; do
        run -1 conus diff plain.exr $other.exr
    done
    fails 2 '--opacity: "2"; wanted is AREA=A or A, A from 0 to 1' "${scene[@]}" -o a.png --opacity 2
    fails 2 '--opacity: "1=x"; wanted is' "${scene[@]}" -o a.png --opacity 1=x
    gl "${scene[@]}" -o zero.exr --opacity 0 --opacity 1=1
    gl "${scene[@]}" -o all.exr --opacity 1=1 --opacity 300=0 --opacity tract=0
    answers diff zero.exr all.exr
    run -1 conus diff plain.exr zero.exr
    fails 2 '--legend-area: ' "${scene[@]}" -o a.png --legend-area nowhere
    fails 2 '--legend-rows: 0 is out of range' "${scene[@]}" -o a.png --legend-rows 0
    fails 2 '--opacity: ' "${scene[@]}" -o a.png --opacity nowhere=0.5
    fails 2 '--pathway-transfer: 1 is no pathway' "${scene[@]}" -o a.png --pathway-transfer 1=heat
    fails 2 'transfer function "warm" is neither' "${scene[@]}" -o a.png --pathway-transfer warm
    fails 2 '--opacity has no effect on a pathway' "${scene[@]}" -o a.png --pathway-transfer tract=own --opacity tract=1
    fails 2 'transfer function of pathways: the atlas has none' render slabs.nii.gz -o a.png --pathway-transfer heat
    [ ! -e a.png ]
}

@test "a surface around the areas is drawn, more or less" {
    sphere --size 24
    printf 'v -90 -60 -90\nv 90 -60 -90\nv 0 -60 90\nf 1 2 3\n' >sheet.obj
    gl render sphere.nii.gz $SMALL -q --view front -o plain.exr
    for opacity in 0.25 0.5; do
        gl render sphere.nii.gz $SMALL -q --view front -o $opacity.exr --context sheet.obj --context-opacity $opacity
        run -1 conus diff plain.exr $opacity.exr
    done
    gl render sphere.nii.gz $SMALL -q --view front -o default.exr --context sheet.obj
    answers diff 0.25.exr default.exr
    run -1 conus diff 0.25.exr 0.5.exr
    fails 2 '--transfer has no effect: sheet.obj is a surface' render sphere.nii.gz --context sheet.obj \
        --transfer brain -o a.png
    [ ! -e a.png ]
}

# A ball of glass whose outline has a contrast of at least 3 to white (WCAG 2.2, 1.4.11): the darkest of its first
# pixels in the middle row. Before it all is white.
@test "glass on white has an outline" {
    sphere --size 24
    awk 'BEGIN { for (j = 0; j <= 24; j++) for (i = 0; i < 48; i++) { t = j * 3.14159265 / 24; p = i * 3.14159265 / 24
        print "v", 80 * sin(t) * cos(p), 80 * sin(t) * sin(p), 80 * cos(t) }
        for (j = 0; j < 24; j++) for (i = 0; i < 48; i++) { a = 48 * j + i + 1; b = 48 * j + (i + 1) % 48 + 1
        print "f", a, a + 48, b + 48; print "f", a, b + 48, b } }' >ball.obj
    gl render sphere.nii.gz -q --view front --background white --no-legend --size 240x180 --context ball.obj -o glass.png
    /usr/bin/python3 - <<'END'
import OpenImageIO as oiio
row = oiio.ImageBuf("glass.png").get_pixels(oiio.UINT8)[90, :, :3] / 255.0
linear = ((row + 0.055) / 1.055) ** 2.4
light = linear @ [0.2126, 0.7152, 0.0722]
first = next(x for x in range(240) if light[x] < 0.99)
assert 5 < first < 80, first
contrast = 1.05 / (light[first:first + 6].min() + 0.05)
assert contrast >= 3, contrast
assert 1.05 / (light[first + 25] + 0.05) < 2 # and the rest is clear
END
}

# Six voxels along x, each an area: the three on the left are named right, or, with the names of the table, left.
@test "a legend says that left and right are exchanged" {
    PYTHONPATH="$BATS_TEST_DIRNAME" python3 -B -c 'import nifti; nifti.write("six.nii", (6, 6, 6), "B",
        lambda i, j, k: i + 1, edge=2)'
    printf '%s\n' 'index	name' '1	A_R' '2	B_R' '3	C_R' '4	A_L' '5	B_L' '6	C_L' >wrong.tsv
    tr LR RL <wrong.tsv >right.tsv
    for names in wrong right; do
        "$CONUS" render six.nii --labels $names.tsv --cuts axial --origin=-30,0,0 --toward 0,0,0 --angle 9 --layers all \
            --legend below -q -o $names.svg
    done
    grep -q '>B_R<' wrong.svg # names of such an atlas stay as they are
    grep -q '>B right<' right.svg
    grep -q '>left and right are exchanged<' wrong.svg
    run ! grep -q 'exchanged' right.svg
}

@test "figures that cannot be are refused before anything is loaded" {
    fails 2 '--size and --width-mm exclude each other' render a.nii -o a.png --size 10x10 --width-mm 85
    fails 2 '--height-mm has no effect without --width-mm' render a.nii -o a.png --height-mm 85
    fails 2 '--width-mm: 39370 x 29528 pixels at 10000 dpi, allowed is up to 16384' \
        render a.nii -o a.png --width-mm 100 --dpi 10000
    fails 2 '--width-mm: 0 is out of range' render a.nii -o a.png --width-mm 0
    fails 2 '--size: 0x0 is out of range' render a.nii -o a.png --size 0x0
    fails 2 '--dpi: 1 is out of range' render a.nii -o a.png --dpi 1
    fails 2 '--view: "above" is none of' render a.nii -o a.png --view above
    fails 2 '--legend: "top" is none of' render a.nii -o a.png --legend top
    fails 2 '--legend: "inside" is none of its choices: auto, right, below, none' render a.nii -o a.png --legend inside
    fails 2 '--background: "green"; allowed are light, white, black, transparent and #RRGGBB' \
        render a.nii -o a.png --background green
    fails 2 '--background: "#12345"' render a.nii -o a.png --background '#12345'
    fails 2 '--view and --camera exclude each other' render a.nii -o a.png --view top --camera c.csv
    fails 2 '--legend and --no-legend exclude each other' render a.nii -o a.png --legend below --no-legend
    sphere --size 16
    run --separate-stderr "$CONUS" render sphere.nii.gz -o a.png --size 4000x4000 --max-memory 100M
    [ "$status" -ne 4 ] || need_gl
    [ "$status" -eq 3 ]
    check_message 'picture of 4000 x 4000 pixels: 512000000 bytes, allowed are'
    [ ! -e a.png ]
}

@test "a symmetric frustum is a field of view, another one is off-axis" {
    sphere --size 32
    local camera=(--camera-origin 0,300,0 --camera-toward 0,0,0 --no-legend)
    gl render sphere.nii.gz -o same.exr --size 100x100 "${camera[@]}" --frustum=-1,1,-1,1
    gl render sphere.nii.gz -o square.exr --size 100x100 "${camera[@]}" --field-of-view 90
    gl render sphere.nii.gz -o side.exr --size 100x100 "${camera[@]}" --frustum=-0.5,1.5,-1,1
    answers diff same.exr square.exr
    run -1 conus diff same.exr side.exr
    fails 2 '--frustum has no effect without a camera' render sphere.nii.gz -o a.png --frustum=-1,1,-1,1
    fails 2 '--frustum and --field-of-view exclude each other' \
        render sphere.nii.gz -o a.png "${camera[@]}" --frustum=-1,1,-1,1 --field-of-view 31
    fails 2 'left before right' render sphere.nii.gz -o a.png "${camera[@]}" --frustum=1,-1,-1,1
    fails 2 'is not four numbers' render sphere.nii.gz -o a.png "${camera[@]}" --frustum=-1,1,-1
    fails 2 'out of range' render sphere.nii.gz -o a.png "${camera[@]}" --frustum=-1,1,-1,2000
}

@test "LPS is the mirrored RAS, for the camera, too" {
    sphere --size 32
    gl render sphere.nii.gz -o a.exr $SMALL --camera-origin 200,100,0 --camera-toward 0,0,0
    gl render sphere.nii.gz -o b.exr $SMALL --camera-origin -200,-100,0 --camera-toward 0,0,0 --space lps
    answers diff a.exr b.exr
}

# bats test_tags=main
@test "AAL around its contacts, in a context" {
    need_aal
    gl render "$aal" --context "$TEMPLATES/ch2bet.nii.gz" -o aal.png $SMALL \
        --origin=-90,20,20 --toward=0,-10,10 --angle 20 --legend right
    [ "$(png_size aal.png)" = 160x120 ]
}

@test "presets of the help are accepted, others are not" {
    conus phantom slabs -o . --size 16
    sphere --size 16
    conus render --help | sed -n 's/^Presets of --transfer: *//p' | tr ' ' '\n' >presets
    [ "$(wc -l <presets)" -ge 2 ]
    while read -r preset; do
        gl render slabs.nii.gz -o a.png $SMALL --context sphere.nii.gz --transfer "$preset"
    done <presets
    fails 2 'nothing' render slabs.nii.gz -o b.png --context sphere.nii.gz --transfer nothing
    [ ! -e b.png ]
}

# bats test_tags=main
@test "mistakes are named before anything is loaded" {
    fails 2 '--output FILE is missing' render a.nii
    fails 2 '--output: "a.jpg" does not end in .png, .svg, .pdf or .exr' render a.nii -o a.jpg
    fails 2 '--size: "100" is not a size WxH' render a.nii -o a.png --size 100
    fails 2 '--size: 0x10 is out of range, allowed is 1 to 16384' render a.nii -o a.png --size 0x10
    fails 2 '--transfer has no effect without --context' render a.nii -o a.png --transfer brain
    fails 2 '--camera-toward has no effect without --camera-origin' render a.nii -o a.png --camera-toward 0,0,0
    fails 2 '--camera-origin has no effect without --camera-toward' render a.nii -o a.png --camera-origin 0,0,0
    fails 2 '--camera and --camera-origin exclude each other' \
        render a.nii -o a.png --camera c.csv --camera-origin 0,0,9 --camera-toward 0,0,0
    fails 2 '--angle has no effect without a cone: --origin or --pose' render a.nii -o a.png --angle 5
    fails 2 '--engine has no effect on cuts without a cone: --cuts 3d' render a.nii -o a.png --engine gl --cuts axial
    fails 2 '--field-of-view: 180 is out of range' render a.nii -o a.png --field-of-view 180
    fails 3 'a.nii: cannot open' render a.nii -o a.png
    nothing_left
}

@test "an output that cannot be, and one that would hurt" {
    sphere --size 16
    gl render sphere.nii.gz -o a.png $SMALL
    fails 3 'no/a.png: cannot write' render sphere.nii.gz -o no/a.png $SMALL
    cp sphere.nii.gz atlas.png
    fails 2 '--output atlas.png would overwrite the input atlas.png' render atlas.png -o atlas.png
    printf '1 0 0 0\n0 1 0 0\n0 0 1 200\n0 0 0 1\n' >camera.png
    fails 2 "--output camera.png would overwrite the input camera.png" render atlas.png -o camera.png --camera camera.png
    printf '0 1 1 1 0\n1 1 1 1 1\n' >transfer.png
    fails 2 '--output transfer.png would overwrite the input transfer.png' \
        render atlas.png -o transfer.png --context sphere.nii.gz --transfer transfer.png
}

# bats test_tags=main
@test "without OpenGL pictures are drawn by rays; exit code 4 where OpenGL is asked for" {
    sphere --size 16
    answers render sphere.nii.gz -o rays.png $SMALL --engine rays --origin 0,0,50 --toward 0,0,0
    export __EGL_VENDOR_LIBRARY_DIRS=/nonexistent
    run --separate-stderr "$CONUS" render sphere.nii.gz -o out.png $SMALL --engine gl
    [ "$status" -ne 0 ] || skip "this EGL is found all the same"
    [ "$status" -eq 4 ]
    check_message 'no OpenGL 4.5 core context'
    [ ! -e out.png ]
    run -0 --separate-stderr "$CONUS" render sphere.nii.gz -o auto.png $SMALL --origin 0,0,50 --toward 0,0,0 --verbose
    [[ $stderr == *'no OpenGL 4.5 core context'*'drawn by rays'* ]]
    cmp auto.png rays.png
}

@test "pictures by rays have the same bytes by one thread and by several" {
    "$CONUS" phantom brain -o brain
    for threads in 0 0-15; do
        run -0 taskset -c "$threads" "$CONUS" render brain/brain.atlas.json -o "by-$threads.png" $SMALL --engine rays -q \
            --origin -120,60,60 --toward 0,0,0 --opacity 0.5 --pathway-transfer own
    done
    cmp by-0.png by-0-15.png
}

# bats test_tags=main
@test "an atlas of surfaces without a volume: rows and picture into files" {
    "$CONUS" phantom brain -o brain
    cp brain/brain-01-AntL.surf.gii ant.gii
    "$CONUS" query ant.gii --origin -200,100,60 --toward -20,40,10 --format tsv -q -o rows.tsv
    [ -s rows.tsv ]
    gl render ant.gii -o ant.png $SMALL
    [ -s ant.png ]
}

# counts FILE RRGGBB...: how many pixels of a PNG have each colour.
counts() {
    /usr/bin/python3 - "$@" <<'END'
import sys
import OpenImageIO as oiio
rgb = oiio.ImageInput.open(sys.argv[1]).read_image(oiio.UINT8)[..., :3]
print(*((rgb == list(bytes.fromhex(colour))).all(-1).sum() for colour in sys.argv[2:]))
END
}

@test "a palette is a name, a list or a file, and cuts have its colours" {
    need_pixels
    conus phantom nested -o .
    echo 'no colour' >none.txt
    printf 'name,colour\nfirst,#102030\nsecond,"#E0C010"\n' >two.csv
    cut=(--cuts axial --fill 1 --size 300x300 --background white --no-legend -q)
    for palette in '#102030,#E0C010' two.csv; do
        answers render nested.nii.gz -o p.png "${cut[@]}" --palette "$palette"
        read -r first second < <(counts p.png 102030 E0C010)
        [ "$first" -gt 100 ] && [ "$second" -gt 100 ]
    done
    answers render nested.nii.gz -o safe.png "${cut[@]}" --palette safe
    answers render nested.nii.gz -o old.png "${cut[@]}" --safe-colours
    answers diff safe.png old.png
    answers render nested.nii.gz -o tab.png "${cut[@]}" --palette tab10
    read -r first < <(counts tab.png 1F77B4)
    [ "$first" -gt 100 ]
    # With a cone: what is hit by its place in the answer, all else grey; or those of the atlas or of a palette.
    cone=(--origin=90,0,0 --toward=0,0,0 --angle 4)
    answers render nested.nii.gz -o rank.png "${cut[@]}" "${cone[@]}"
    read -r first second < <(counts rank.png D2246C C9CDD3)
    [ "$first" -gt 100 ] && [ "$second" -gt 100 ]
    answers render nested.nii.gz -o named.png "${cut[@]}" "${cone[@]}" --palette rank
    cmp rank.png named.png
    for palette in file tab10; do
        answers render nested.nii.gz -o other.png "${cut[@]}" "${cone[@]}" --palette $palette
        read -r first second < <(counts other.png D2246C C9CDD3)
        [ "$first" -eq 0 ] && [ "$second" -eq 0 ]
    done
    answers render nested.nii.gz -o other.png "${cut[@]}" "${cone[@]}" --safe-colours # which those by rank are, too
    cmp rank.png other.png
    fails 2 '--palette: "tab11" is neither rank, file, safe' render nested.nii.gz -o x.png "${cut[@]}" --palette tab11
    fails 3 'no #RRGGBB in it' render nested.nii.gz -o x.png "${cut[@]}" --palette none.txt
    fails 2 '#12345: no #RRGGBB in it' render nested.nii.gz -o x.png "${cut[@]}" --palette '#12345'
}

@test "what is not hit has one tone, and only with a cone" {
    need_pixels
    conus phantom u-shape -o .
    cone=(--origin=40,0,5 --toward=0,0,5 --angle 6)
    look=(--view front --size 300x200 --background white --no-legend -q)
    gl render u-shape.nii.gz -o grey.png "${cone[@]}" "${look[@]}" --palette file --unselected '#808080'
    gl render u-shape.nii.gz -o own.png "${cone[@]}" "${look[@]}" --palette file
    /usr/bin/python3 - <<'END'
import numpy
import OpenImageIO as oiio
grey, own = (oiio.ImageInput.open(name).read_image(oiio.UINT8)[..., :3].astype(int) for name in ("grey.png", "own.png"))
tone = (grey != own).any(-1) & (numpy.ptp(grey, axis=-1) <= 2) & (grey.max(-1) < 200)  # the ball, which the arm hides
assert tone.sum() > 1000, tone.sum()
assert numpy.median(numpy.ptp(own[tone], axis=1)) > 10
END
    fails 2 '--unselected has no effect without a cone' render u-shape.nii.gz -o x.png --unselected white
    fails 2 '--unselected: "grey"; allowed are' render u-shape.nii.gz -o x.png "${cone[@]}" --unselected grey
    fails 2 '--unselected has no effect on cuts' render u-shape.nii.gz -o x.png "${cone[@]}" --cuts axial --unselected white
}

# Two slabs across y, 20 mm apart: from the front the anterior one hides the other, which the cone hits from behind. So
# it is glass: 0.1 of it and 0.9 of the red one behind it, and from elsewhere and with a choice of opacity it is not.
@test "what hides a hit is glass, and the legend says what the camera does not see where somebody chose otherwise" {
    conus phantom slabs -o .
    local cone=(--origin=0,-60,0 --toward=0,0,0 --angle 20 --size 400x300 -q)
    for side in front back left; do
        gl render slabs.nii.gz "${cone[@]}" --view "$side" -o "$side.svg"
        grep -q '>Slab posterior</text>' "$side.svg"
    done
    for opacity in 1 0.1; do
        gl render slabs.nii.gz "${cone[@]}" --view front --opacity "$opacity" -o "$opacity.png"
        gl render slabs.nii.gz "${cone[@]}" --view left --opacity "$opacity" -o "left$opacity.png"
    done
    gl render slabs.nii.gz "${cone[@]}" --view front -o front.png
    gl render slabs.nii.gz "${cone[@]}" --view left -o left.png
    cmp front.png 0.1.png
    cmp left.png left1.png
    run ! cmp left.png left0.1.png
    gl render slabs.nii.gz "${cone[@]}" --view front --opacity 1 -o opaque.svg
    grep -q '>Slab posterior (not seen)</text>' opaque.svg
    gl render slabs.nii.gz "${cone[@]}" --camera-origin 0,300,0 --camera-toward 0,0,0 -o camera.svg
    grep -q '>Slab posterior (not seen)</text>' camera.svg
    gl render slabs.nii.gz "${cone[@]}" --view front --opacity 0.5 -o half.svg
    grep -q '>Slab posterior</text>' half.svg
}

# texts FILE.svg: each text of the file with the place where it begins, one a line: x, a tab, the text.
texts() { grep -o '<text[^>]*>[^<]*' "$1" | sed -E 's/.* x="([^"]*)".*>(.*)/\1\t\2/'; }

@test "a legend without a cone names pathways and bundles first, and its title says which there are" {
    conus phantom brain -o .
    conus phantom bundle -o .
    gl render brain.atlas.json --opacity 0.3 --legend right --size 400x300 -o brain.svg -q
    texts brain.svg | cut -f 2 | grep -A1 -x 'Areas and pathways' | grep -x Arc
    gl render bundle.atlas.json --legend right --size 400x300 -o bundle.svg -q
    texts bundle.svg | cut -f 2 | grep -x Bundles
}

# Letters have 11 pixels here: the middles of two are 2.5 of these apart, where each is 0.55 from its own cut.
@test "the letters of two cuts side by side do not read as one word" {
    conus phantom nested -o .
    answers render nested.nii.gz --cuts coronal,sagittal --size 600x300 -o two.svg -q
    texts two.svg | awk -F '\t' '$2 == "R" { r = $1 } $2 == "P" { p = $1 } END { exit !(p - r > 22) }'
}

# The mask lies in areas that the shell is drawn in place of: it is there, and as round as where it lies in none.
@test "a shell has the pathways, and these are lit whole" {
    conus phantom nested -o .
    sphere --size 24
    gl render nested.nii.gz --shell --pathway sphere.nii.gz,name=M --view left --size 200x150 --no-legend -q -o in.png
    gl render nested.nii.gz --shell --view left --size 200x150 --no-legend -q -o none.png
    "$CONUS" render nested.nii.gz --shell --pathway sphere.nii.gz,name=M --view left --size 200x150 --no-legend -q \
        --engine rays -o rays.png
    /usr/bin/python3 - <<'END'
import OpenImageIO as oiio

read = lambda name: oiio.ImageBuf(name).get_pixels(oiio.UINT8)[..., :3].astype(int)
for name in "in.png", "rays.png":
    mask = abs(read(name) - read("none.png")).sum(axis=2) > 60
    shades = read(name)[mask].sum(axis=1)
    assert 500 < len(shades), len(shades)
    assert shades.max() > 1.5 * shades.min() and len(set(shades)) > 40, (shades.min(), shades.max(), len(set(shades)))
END
}

# The axis goes along x: the camera looks along y, from above, and the areas on the way let it through.
@test "a beam is seen from the side and above, in glass" {
    conus phantom u-shape -o .
    local beam=(--focus 0,0,0 --transducer 60,0,0 --aperture-diameter 40 --size 200x150 --no-legend -q)
    gl render u-shape.nii.gz "${beam[@]}" -o beam.exr
    gl render u-shape.nii.gz "${beam[@]}" --shell --view across -o across.exr
    /usr/bin/python3 - <<'END'
import OpenImageIO as oiio

camera = oiio.ImageBuf("beam.exr").spec().getattribute("conus:worldFromCamera")
rows = [camera[4 * r : 4 * r + 4] for r in range(4)]
back = [row[2] for row in rows] if abs(rows[0][0] ** 2 + rows[1][0] ** 2 + rows[2][0] ** 2 - 1) < 1e-3 else rows[2]
assert abs(back[0]) < 1e-4 and 0.40 < abs(back[2]) < 0.44, camera # sine of 25 degrees
same = abs(oiio.ImageBuf("beam.exr").get_pixels() - oiio.ImageBuf("across.exr").get_pixels()).max()
assert same == 0, same
END
}
