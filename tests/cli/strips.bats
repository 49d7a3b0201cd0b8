#!/usr/bin/env bats
# conus render --strips: several probes in one picture, with a strip beside it for what each passes.
#
# The U of u-shape has arms of 10 mm and a ball between them (segments.bats).
load helpers

probes() {
    conus phantom u-shape -o .
    printf 'query_id\tx\ty\tz\ttx\tty\ttz\nlevel\t40\t0\t5\t0\t0\t5\ntilted\t40\t2\t16\t0\t0\t5\n' >two.tsv
}

@test "each strip has the segments of query at their depths, with their names as text" {
    probes
    gl render u-shape.nii.gz --poses two.tsv --range 0,80 --strips --size 700x400 --background white -o two.svg
    answers query u-shape.nii.gz --pose two.tsv --range 0,80 -q --segments - --format tsv
    printf '%s\n' "$output" >rows.tsv
    /usr/bin/python3 - <<'END'
import csv
import xml.etree.ElementTree as tree
rows = [row for row in csv.DictReader(open("rows.tsv"), delimiter="\t")]
areas = [row for row in rows if row["kind"] == "area"]
first = min(float(row["entry_mm"]) for row in areas)  # the strips begin here, and end at 80 mm
svg = tree.parse("two.svg").getroot()
space = "{http://www.w3.org/2000/svg}"
boxes = [box for box in svg.iter(space + "rect") if box.get("fill") != "none"]
frames = [box for box in svg.iter(space + "rect") if box.get("fill") == "none"]
assert len(boxes) == len(areas) == 6, (len(boxes), len(areas))
longest = max(float(frame.get("height")) for frame in frames)
for x in {float(box.get("x")) for box in boxes}:  # each strip is whole, also before the probe's first area
    assert longest == max(float(frame.get("height")) for frame in frames if abs(float(frame.get("x")) - x) < 3), x
for name in "level", "tilted":
    own = [row for row in areas if row["query"] == name]
    column = boxes[: len(own)]
    del boxes[: len(own)]
    assert len({box.get("x") for box in column}) == 1
    scale = float(column[0].get("height")) / (float(own[0]["exit_mm"]) - float(own[0]["entry_mm"]))
    top = float(column[0].get("y")) - scale * (float(own[0]["entry_mm"]) - first)
    for row, box in zip(own, column):
        entry, exit = float(row["entry_mm"]), float(row["exit_mm"])
        assert abs(float(box.get("y")) - top - scale * (entry - first)) < 0.02, (row, box.attrib)
        assert abs(float(box.get("height")) - scale * (exit - entry)) < 0.02, (row, box.attrib)
    assert abs(longest - scale * (80 - first)) < 2, (longest, scale)
    assert 0 < top and top + scale * (80 - first) < 400, (top, scale)  # all is in the picture
words = [text.text for text in svg.iter(space + "text")]
for row in areas:
    words.remove(row["name"])
for word in "level", "tilted", "level", "tilted", "mm", "20", "80":  # beside the line and above the strip
    words.remove(word)
END
    fails 2 'are too few for the strips of 2 probes' render u-shape.nii.gz --poses two.tsv --strips -o x.png --size 200x300 -q
    [ ! -e x.png ]
}

# The label of each area of u-shape is its only name without the table.
@test "an area without a name has the file's name before its number, in strips and in legends" {
    probes
    rm u-shape.tsv
    gl render u-shape.nii.gz --poses two.tsv --range 0,80 --strips --size 700x400 -q -o strips.svg
    gl render u-shape.nii.gz --origin 40,0,5 --toward 0,0,5 -q -o hits.svg
    answers render u-shape.nii.gz --cuts axial --origin 40,0,5 --toward 0,0,5 -q -o cut.svg
    for file in strips hits cut; do
        grep -q '>U-shape [12]<' $file.svg
        [ "$(grep -c '>[12]<' $file.svg)" -eq 0 ]
    done
}

# At 460 to 560 pixels letters of 62 to 90 % have room for all: no name is cut.
@test "names are whole in letters that are smaller" {
    probes
    awk -F'\t' 'BEGIN { OFS = FS } NR > 1 { $2 = "Long name of " $2; $3 = "" } 1' u-shape.tsv >long.tsv
    for width in 460 481 500 520 541 560; do
        gl render u-shape.nii.gz --labels long.tsv --poses two.tsv --range 0,80 --strips --size ${width}x300 -q -o long.svg
        [ "$(grep -c '>Long name of \(U\|Ball\)<' long.svg)" -eq 6 ]
    done
    gl render u-shape.nii.gz --labels long.tsv --poses two.tsv --range 0,80 --strips --size 420x300 -q -o long.svg
    grep -q '>Long .*…<' long.svg # in the smallest ones they are cut
}

@test "what has no effect is refused" {
    probes
    fails 2 '--strips has no effect without --poses' render u-shape.nii.gz --strips -o x.png
    fails 2 '--strips and --angle' render u-shape.nii.gz --poses two.tsv --strips --angle 9 -o x.png
    fails 2 '--resolution has no effect with --strips' render u-shape.nii.gz --poses two.tsv --strips --resolution 9 -o x.png
    fails 2 '--strips draws all in one picture' render u-shape.nii.gz --poses two.tsv --strips -o '{row}.png'
    nothing_left u-shape.nii.gz u-shape.json u-shape.tsv two.tsv
}

@test "one pose is one strip, and a row that is none is named" {
    probes
    gl render u-shape.nii.gz --origin=40,0,5 --toward=0,0,5 --strips -o one.svg -q
    [ "$(grep -c '<text.*>U</text>' one.svg)" -eq 2 ]
    printf 'bad\t1\t2\t3\t1\t2\t3\n' >>two.tsv
    run -1 --separate-stderr conus render u-shape.nii.gz --poses two.tsv --strips -o all.svg -q
    [[ $stderr == "conus: two.tsv:4: "* ]]
    [ "$(grep -c '>tilted</text>' all.svg)" -eq 2 ]
    run -3 --separate-stderr conus render u-shape.nii.gz --poses two.tsv --query-id bad --strips -o bad.svg -q
    [ ! -e bad.svg ]
}

# The atlas is about 30 mm wide: a bar of more than 20 mm would mean that it is a dot in its picture.
@test "a probe that passes nothing is noted, and what is shown is as large as without it" {
    probes
    printf 'far\t900\t0\t90\t900\t0\t95\n' >>two.tsv
    run -0 --separate-stderr conus render u-shape.nii.gz --poses two.tsv --range 0,80 --strips --size 900x400 -o all.svg
    [[ $stderr == *'note: two.tsv: 1 of 3 probes pass nothing of the atlas, the first in line 4'* ]]
    for distance in 3000 30000; do
        run -0 --separate-stderr conus render u-shape.nii.gz --origin="$distance,0,90" --toward="$distance,0,95" \
            --range 0,80 --strips --size 500x300 -o "$distance.svg"
        [[ $stderr == 'conus: warning: the probe passes nothing of the atlas' ]]
    done
    cmp 3000.svg 30000.svg
    grep -qE '>(5|10|20) mm</text>' 3000.svg
    run -0 --separate-stderr conus render u-shape.nii.gz --origin=300,0,5 --toward=400,0,5 --strips --size 500x300 -o x.svg
    [[ $stderr == *'the probe passes nothing of the atlas; looking the other way it would hit U first'* ]]
    run -0 --separate-stderr conus render u-shape.nii.gz --origin=300,0,5 --toward=400,0,5 --strips --size 500x300 -o x.svg -q
    check_message 'warning: the probe passes nothing of the atlas; looking the other way it would hit U first'
}

# letters_apart FILE.svg: asserts that no two of its texts touch, if a letter is 0.7 of their size high; and that there
# are the name "Probe" and the directions, except those along the view.
letters_apart() {
    /usr/bin/python3 - "$1" <<'END'
import sys
import xml.etree.ElementTree as tree
space = "{http://www.w3.org/2000/svg}"
boxes = []
for text in tree.parse(sys.argv[1]).getroot().iter(space + "text"):
    x, y, size = (float(text.get(name)) for name in ("x", "y", "font-size"))
    boxes.append((text.text, x, y - 0.7 * size, x + float(text.get("textLength")), y))
words = [box[0] for box in boxes]
assert words.count("Probe") == 2 and sum(words.count(letter) for letter in "LRPAIS") >= 4, words
for i, a in enumerate(boxes):
    for b in boxes[:i]:
        assert a[3] <= b[1] or b[3] <= a[1] or a[4] <= b[2] or b[4] <= a[2], (a, b)
END
}

@test "the name of a probe lies on no direction, and no direction on another" {
    conus phantom u-shape -o .
    printf 'query_id\tx\ty\tz\ttx\tty\ttz\nProbe\t5\t0\t40\t0\t0\t5\n' >high.tsv
    # seen from below, left and behind, the cross of directions is where the name would be
    printf 'query_id\tx\ty\tz\ttx\tty\ttz\nProbe\t-30\t-40\t-40\t0\t0\t5\n' >low.tsv
    for camera in -100,100,90 -100,100,10 -110,20,15 -110,-20,60 -30,-120,30 -20,30,120; do
        gl render u-shape.nii.gz --poses high.tsv --range 0,50 --strips --size 500x300 -o "./$camera.svg" --opacity 0 -q \
            --camera-origin="$camera" --camera-toward=0,0,0
        letters_apart "./$camera.svg"
    done
    run -0 "$CONUS" render u-shape.nii.gz --poses low.tsv --range 0,50 --strips --size 500x300 -o low.svg --opacity 0 -q
    letters_apart low.svg
}
