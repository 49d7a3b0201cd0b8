#!/usr/bin/env bats
# conus render --cuts: flat cuts on one sheet.
load helpers

@test "each pixel of a cut has the label that the affine says, left is left, and the bar is as long as it says" {
    /usr/bin/python3 "$BATS_TEST_DIRNAME/cuts.py" "$CONUS"
}

# bats test_tags=main
@test "planes that are none, and places outside of the atlas, are refused in one line" {
    sphere --size 16
    local spoken
    while IFS='|' read -r cuts spoken; do
        fails 2 "$spoken" render sphere.nii.gz -o x.png --cuts "$cuts"
    done <<'END'
axal|"axal"; allowed are axial, coronal and sagittal
axial:|"axial:"; wanted is axial or axial:NUMBER
axial:1x|wanted is axial or axial:NUMBER
axial,5|"5" does not follow a plane with a place
axial,|""; allowed are axial
axial:500|z = 500 mm is outside of the atlas, which is from
axial:0,nan|"nan"; allowed are
mosaic:0|mosaic:0; allowed is 1 to 400
mosaic:10000|mosaic:10000; allowed is 1 to 400
mosaic:-1|"mosaic:-1"; wanted is mosaic or mosaic:N
mosaic:400,axial|more than 400 cuts
3d|3d alone is the picture without --cuts
3d,3d,axial|3d stands there twice
END
    fails 2 'are too few for 400 cuts' render sphere.nii.gz -o x.png --cuts mosaic:400 --size 100x100
    fails 2 'z = 500 mm is outside' render sphere.nii.gz -o x.png --cuts axial --at 0,0,500
    fails 2 '--at has no effect: every cut' render sphere.nii.gz -o x.png --cuts axial:0 --at 0,0,0
    fails 2 '--at has no effect without --cuts' render sphere.nii.gz -o x.png --at 0,0,0
    fails 2 '--opacity has no effect on cuts' render sphere.nii.gz -o x.png --cuts axial --opacity 0.5
    fails 2 '--slices has no effect on cuts' render sphere.nii.gz -o x.png --cuts axial --slices 9
    fails 3 'cannot write' render sphere.nii.gz -o none/x.png --cuts axial
    nothing_left sphere.nii.gz sphere.json sphere.tsv
}

# height FILE: height of a PNG, pixels.
height() {
    head -c 24 "$1" | tail -c 4 | od -An -tu1 | awk '{ print $3 * 256 + $4 }'
}

# bats test_tags=main
@test "a sheet is as high as its cuts need, unless a height is asked for" {
    sphere --size 16
    answers render sphere.nii.gz -o one.png --cuts axial,coronal,sagittal
    answers render sphere.nii.gz -o two.png --cuts mosaic:12
    [ "$(height one.png)" -lt "$(height two.png)" ]
    [ "$(height two.png)" -le 1050 ]
    answers render sphere.nii.gz -o three.png --cuts mosaic:6 --size 600x500
    [ "$(height three.png)" -eq 500 ]
}

# bats test_tags=main
@test "cuts go through the best hit's middle, and each row of a file has its own" {
    sphere --size 32
    printf 'query_id,x,y,z,tx,ty,tz,angle\n1,60,0,8,0,0,8,5\n2,-60,0,0,0,0,0,5\n' >two.csv # no names: their legends would have them
    answers render sphere.nii.gz --poses two.csv -o '{query}.exr' --cuts sagittal,axial -q --size 300x200
    run -0 --separate-stderr "$CONUS" query sphere.nii.gz --pose two.csv --format tsv
    awk -F '\t' 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i }
        $at["kind"] == "area" { print $at["contact_x"] "," $at["contact_y"] "," $at["contact_z"] }' <<<"$output" >ends
    [ "$(wc -l <ends)" -eq 2 ]
    local n=0 end
    while read -r end; do # the middle of what a ray through the contact passes
        n=$((n + 1))
        run -0 --separate-stderr "$CONUS" query sphere.nii.gz --origin=$([ $n = 1 ] && echo 60,0,8 || echo -60,0,0) \
            --toward="$end" --segments - --format tsv -q
        awk -F '\t' -v n=$n -v CONVFMT=%.12g 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i }
            $at["kind"] == "area" { print n, ($at["entry_x"] + $at["exit_x"]) / 2 "," \
                ($at["entry_y"] + $at["exit_y"]) / 2 "," ($at["entry_z"] + $at["exit_z"]) / 2 }' <<<"$output"
    done <ends >contacts
    while read -r name contact; do
        [ "$name" = 1 ] && aim='--origin=60,0,8 --toward=0,0,8' || aim='--origin=-60,0,0 --toward=0,0,0'
        # shellcheck disable=SC2086 # several words
        answers render sphere.nii.gz $aim --angle 5 -o at.exr --cuts sagittal,axial --at="$contact" --size 300x200
        answers diff at.exr "$name.exr" --tolerance 0.001
    done <contacts
    answers render sphere.nii.gz --origin=60,0,8 --toward=0,0,8 --angle 5 -o at.exr --cuts sagittal,axial --at=0,0,0 \
        --size 300x200
    run -1 conus diff at.exr 1.exr
}

# The mean of the voxels of a ball of 4 mm, whose middle is at a voxel's centre, is that centre.
@test "without a pose cuts go through the middle of the only pathway, or of the atlas" {
    sphere --size 32
    answers query sphere.nii.gz --point=5.5,-2.5,2.5 --radius 4 --mask lesion.nii.gz --mask-of all -q -o ball.tsv
    local show='sphere.nii.gz --cuts axial,coronal --size 300x200'
    answers render $show --pathway lesion.nii.gz -q -o own.exr --caption own.txt
    grep -qx 'lesion: values of at least 0.25.' own.txt # a quarter of the largest value, as conus info says of a mask
    answers render $show --pathway lesion.nii.gz -q --at=5.5,-2.5,2.5 -o at.exr
    answers diff own.exr at.exr
    answers render $show --pathway lesion.nii.gz --pathway lesion.nii.gz,name=other -q -o two.exr
    answers render $show --pathway lesion.nii.gz --pathway lesion.nii.gz,name=other -q --at=0,0,0 -o middle.exr
    answers diff two.exr middle.exr
}

@test "all text of a sheet is in it, and no text lies on another, however small the cuts are" {
    sphere --size 32
    local cuts size
    while read -r cuts size; do
        answers render sphere.nii.gz -o cuts.svg --cuts "$cuts" --size "$size" --background white -q
        /usr/bin/python3 - "$cuts" <<'END'
import itertools
import sys
import xml.etree.ElementTree as tree
svg = tree.parse("cuts.svg").getroot()
width, height = (float(n) for n in svg.get("viewBox").split()[2:])
boxes = []
for text in svg.iter("{http://www.w3.org/2000/svg}text"):
    x, y, size, length = (float(text.get(name)) for name in ("x", "y", "font-size", "textLength"))
    boxes.append((x, y - 0.7 * size, x + length, y, text.text))
for left, top, right, bottom, text in boxes:
    assert left >= 0 and top >= 0 and right <= width and bottom <= height, (sys.argv, text)
for a, b in itertools.combinations(boxes, 2):
    assert a[0] >= b[2] or b[0] >= a[2] or a[1] >= b[3] or b[1] >= a[3], (sys.argv, a, b)
if sys.argv[1] != "mosaic:100":
    assert len([1 for box in boxes if box[4].lstrip("xyz =\u2212").rstrip(" m").replace(".", "").isdigit()]) > 3
END
    done <<'END'
axial,coronal,sagittal 600x400
axial:0,coronal:0.125,sagittal:-7.25 300x120
mosaic:12 600x400
mosaic:30 600x400
mosaic:60 600x400
mosaic:100 800x600
END
}

# A box 60 mm high: N cuts in equal steps about the middle, to half a mm, so that from the first to the last
# there are N - 1; in whole numbers where there are some that cover nine tenths. 30 layers of 60 / 30 = 2 mm are whole; 25
# of 2.4 mm would be 2 mm, 83 %, and are not. Letters stand beside one cut of those that are seen from one side.
@test "a mosaic has equal steps, and its letters once" {
    PYTHONPATH=$BATS_TEST_DIRNAME /usr/bin/python3 -B - <<'END'
import nifti
nifti.write("box.nii", (20, 20, 60), "B", lambda i, j, k: 1)
END
    for count in 6 7 16 25 30; do
        answers render box.nii --cuts "mosaic:$count,coronal,coronal" --size 1800x1200 -q -o "$count.svg"
    done
    /usr/bin/python3 - <<'END'
import re
for count, wanted in (6, 10), (7, 9), (16, 3.75), (25, 2.4), (30, 2):
    texts = re.findall("<text[^>]*>([^<]*)<", open(f"{count}.svg").read().replace("\u2212", "-"))
    z = [float(text.split()[-2 if text.endswith("mm") else -1]) for text in texts if re.match("z|-?[0-9.]+$", text)]
    assert len(z) == count, (count, texts)
    steps = [b - a for a, b in zip(z, z[1:])]
    assert all(abs(step - wanted) < 0.11 for step in steps), (count, z)
    assert abs(z[0] + z[-1]) <= 1, (count, z)
    assert not re.search(r"\.[0-9]{2}", " ".join(texts)), (count, texts) # at most one digit
    assert texts.count("R") == 2 and texts.count("L") == 2, (count, texts)
END
}

# colours FILE: number of pixels of the five most frequent colours that are no grey.
colours() {
    /usr/bin/python3 - "$1" <<'END'
import sys
import numpy
import OpenImageIO as oiio
rgb = oiio.ImageBuf(sys.argv[1]).get_pixels(oiio.UINT8)[..., :3].reshape(-1, 3)
rgb = rgb[numpy.ptp(rgb, axis=1) > 20]
print(*sorted(numpy.unique(rgb, axis=0, return_counts=True)[1])[:-6:-1])
END
}

# bats test_tags=main
@test "closed surfaces are filled, as labels are" {
    answers phantom brain -o brain
    local look=(--cuts axial --palette file --no-legend --size 300x300 -q)
    answers render brain/brain.atlas.json "${look[@]}" --fill 1 -o full.png
    answers render brain/brain.atlas.json "${look[@]}" --fill 0 -o lines.png
    read -r -a full < <(colours full.png)
    read -r -a lines < <(colours lines.png)
    [ "${full[4]}" -gt 1000 ] && [ "${lines[0]}" -lt $((full[4] / 2)) ]
}

# bats test_tags=main
@test "3d adds the view in space before the cuts, which is the one that render draws" {
    sphere --size 32
    gl render sphere.nii.gz -o both.png --cuts 3d,axial --size 400x200 --no-legend --background white
    answers render sphere.nii.gz -o cut.png --cuts axial --size 200x200 --no-legend --background white
    /usr/bin/python3 - <<'END'
import numpy
import OpenImageIO as oiio
both, cut = (oiio.ImageBuf(name).get_pixels(oiio.UINT8)[..., :3].astype(int) for name in ("both.png", "cut.png"))
area = numpy.ptp(both, axis=2) > 20
assert area[:, :200].sum() > 2000 and area[:, 200:].sum() > 2000
assert len(numpy.unique(both[:, :200][area[:, :200]], axis=0)) > 50  # shaded
assert len(numpy.unique(both[:, 200:][area[:, 200:]], axis=0)) < 5
END
}

@test "a title has the digits of its place, and a legend those of the cone's" {
    sphere --size 160
    while read -r given shown; do
        answers render sphere.nii.gz --cuts "axial:$given" --legend none -q -o title.svg
        grep -qF ">z = $shown mm<" title.svg || { echo "$given: $(grep -o '>z = [^<]*<' title.svg)"; return 1; }
    done <<'END'
-10.26 −10.26
10.2 10.2
7 7
0.0625 0.0625
-1e-13 0
12.345678 12.345678
12.34567891 12.3
0.50000001 0.5
END
    answers render sphere.nii.gz --cuts axial --origin=-90.125,0.0625,-12 --toward 0,0,0 -q -o title.svg
    grep -qF ' from -90.125, 0.0625, -12, RAS mm along 0.99, 0, 0.13<' title.svg # 12 / 90.92 = 0.132
    grep -qF '>First hits of the cone<' title.svg
    answers render sphere.nii.gz --cuts axial --origin=-90,0,0 --toward 0,0,0 --radius 2 --layers all -q -o title.svg
    grep -qF '>The needle passes<' title.svg
    printf 'name,x,y,z,tx,ty,tz\nM1 <left>,-90,0,0,0,0,0\n7,90,0,0,0,0,0\n' >named.csv
    answers render sphere.nii.gz --cuts axial --poses named.csv -q -o 'named-{row}.svg'
    grep -qF '>M1 &lt;left&gt;: first hits of the cone<' named-1.svg
    grep -qF '>First hits of the cone<' named-2.svg
}

# The cone hits the U and the ball behind its opening.
@test "a legend beside cuts has as many rows as it is asked for" {
    answers phantom u-shape -o .
    for cuts in axial axial,sagittal 3d,axial; do
        answers render u-shape.nii.gz --cuts "$cuts" --origin=-90,20,20 --toward 0,0,0 --angle 30 -q -o all.svg
        grep -qF '>U<' all.svg
        grep -qF '>Ball<' all.svg
        answers render u-shape.nii.gz --cuts "$cuts" --origin=-90,20,20 --toward 0,0,0 --angle 30 --legend-rows 1 -q \
            -o one.svg
        grep -qF '>U<' one.svg
        grep -qF '>and 1 other<' one.svg
        [ "$(grep -cF '>Ball<' one.svg)" -eq 0 ]
    done
}

# The cone of 20 degrees comes from 100 mm to the left and is 35 mm wide where it passes the middle of the ball: it
# leaves what is hit, and the hollow in it, as they are above and below it.
@test "a cone changes neither the colour of an area in a cut nor the background" {
    PYTHONPATH=$BATS_TEST_DIRNAME /usr/bin/python3 -B - <<'END'
import nifti
at = lambda i, j, k: (i - 24.5) ** 2 + (j - 24.5) ** 2 + (k - 24.5) ** 2
nifti.write("hollow.nii", (50, 50, 50), "B", lambda i, j, k: int(12 ** 2 < at(i, j, k) < 22 ** 2))
END
    answers render hollow.nii --cuts axial --no-legend --background white --size 200x200 --layers all \
        --origin=-100,0,0 --toward 0,0,0 --angle 20 -q -o cone.png
    /usr/bin/python3 - <<'END'
import OpenImageIO as oiio
rgb = oiio.ImageBuf("cone.png").get_pixels(oiio.UINT8).astype(int)[..., :3]
cone = (abs(rgb - [255, 176, 0]).max(-1) < 40).any(0)
assert cone[:20].any() and cone[-20:].any() # its lines go through the picture
assert (rgb[100, 100] == 255).all(), rgb[100, 100]
assert (rgb[100, 30] == rgb[30, 100]).all() and (rgb[100, 30] != 255).any(), (rgb[100, 30], rgb[30, 100])
END
}

# 85 mm are 1004 pixels. A letter is 1.1 em high; an R on the right of a cut and the L on the left of the next one are
# farther apart than three em, so that they are no word.
@test "cuts of a narrow figure have all letters, each near its own" {
    answers phantom sphere -o .
    answers render sphere.nii.gz --cuts axial,coronal,sagittal --width-mm 85 -q -o narrow.svg
    /usr/bin/python3 - narrow.svg <<'END'
import re, sys
texts = [(float(x), float(size), word) for x, size, word in
         re.findall(r'<text x="([-\d.]+)"[^>]*font-size="([\d.]+)"[^>]*>([^<]*)<', open(sys.argv[1]).read())]
words = [word for *_, word in texts]
assert all(words.count(letter) == 2 for letter in "LRAPSI"), words
right = min(x for x, _, word in texts if word == "R")
left = max(x for x, _, word in texts if word == "L")
size = next(size for _, size, word in texts if word == "L")
assert left - right > 3 * size / 1.1, (left, right, size)
END
}

# Half a point has 2.08 pixels at 300 dpi.
@test "outlines over an image have light edges" {
    answers phantom sphere -o .
    PYTHONPATH=$BATS_TEST_DIRNAME /usr/bin/python3 -B -c 'import nifti
nifti.write("ramp.nii", (50, 50, 50), "B", lambda i, j, k: 5 * i)'
    for context in "" "--context ramp.nii"; do
        # shellcheck disable=SC2086 # words
        answers render sphere.nii.gz $context --cuts axial --width-mm 85 --legend none -q -o edges.svg
        /usr/bin/python3 - edges.svg "$context" <<'END'
import re, sys
text = open(sys.argv[1]).read()
lines = [(colour.lower(), float(width)) for colour, width in
         re.findall(r'stroke="(#[0-9a-fA-F]{6})"[^>]*stroke-width="([\d.]+)"', text)]
grey = [width for colour, width in lines if colour == "#69737d"]
white = [width for colour, width in lines if colour == "#ffffff"]
assert grey and bool(white) == bool(sys.argv[2]), lines
assert all(width > 1.5 * grey[0] for width in white), lines
assert not white or lines.index(("#ffffff", white[0])) < lines.index(("#69737d", grey[0])), lines
END
    done
}

# A ball with a hollow of 12 mm: the hollow, and what is around the ball, is the background, whatever that is. A cone
# beside it leaves it pale: 0.6 x 40 % of its colour over a grey of 144, in each channel at least 40 from black and white.
@test "without a context a cut has one background, and pale areas are seen on it" {
    PYTHONPATH=$BATS_TEST_DIRNAME /usr/bin/python3 -B - <<'END'
import nifti
at = lambda i, j, k: (i - 24.5) ** 2 + (j - 24.5) ** 2 + (k - 24.5) ** 2
nifti.write("hollow.nii", (50, 50, 50), "B", lambda i, j, k: int(12 ** 2 < at(i, j, k) < 22 ** 2))
END
    for background in white black '#336699' transparent; do
        for fill in 0.6 0; do
            answers render hollow.nii --cuts axial --no-legend --background "$background" --fill $fill --size 200x200 \
                --origin 100,0,0 --toward 200,0,0 --angle 1 -q -o "hollow$background$fill.png"
        done
    done
    /usr/bin/python3 - <<'END'
import OpenImageIO as oiio
for background in "white", "black", "#336699", "transparent":
    for fill in 0.6, 0:
        rgb = oiio.ImageBuf(f"hollow{background}{fill}.png").get_pixels(oiio.UINT8).astype(int)
        corner, hollow, area = rgb[2, 2], rgb[100, 100], rgb[100, 100 + int(200 / 50 * 17)]
        assert (corner == hollow).all(), (background, fill, corner, hollow)
        if fill == 0:
            assert (area == corner).all(), (background, area)
        else:
            assert 40 <= area[:3].min() and area[:3].max() <= 215, (background, area)
END
}
