#!/usr/bin/env bats
# conus render with points, or several poses, in one picture: balls, their lines, names and groups.
#
# An oracle in Python computes by the pinhole camera where each ball is, and how large.
load helpers
SMALL="--size 160x120 --slices 60"

# contacts: two electrodes with three contacts each, by mm.
contacts() {
    printf 'name,x,y,z,lab\nA1,-20,10,5,x\nA2,-10,10,5,y\nA3,0,10,5,x\nB1,5,-20,-30,x\nB2,15,-20,-30,y\nB3,25,-20,-30,z\n' >contacts.csv
}

# discs FILE.svg: prints x, y, diameter and colour of each disc, a line each, below the edges that are drawn first.
discs() {
    /usr/bin/python3 - "$1" <<'END'
import re, sys
for width, x, y, to_x, to_y, colour in (
    (found[2], *found.group(3, 4, 5, 6), found[1])
    for found in re.finditer(r'stroke="(#\w+)" stroke-width="([\d.]+)" stroke-linecap="round" d="M([-\d.]+) ([-\d.]+)L([-\d.]+) ([-\d.]+)"', open(sys.argv[1]).read())
):
    if (x, y) == (to_x, to_y):
        print(x, y, width, colour)
END
}

# bats test_tags=main
@test "a ball is where a camera sees its point, as large as its radius, in the colour of its group" {
    sphere --size 32
    contacts
    gl render sphere.nii.gz --pose contacts.csv --radius 4 --size 400x300 --opacity 0 -q -o balls.svg \
        --camera-origin 0,0,300 --camera-toward 0,0,0 --camera-up 0,1,0
    discs balls.svg >discs.txt
    /usr/bin/python3 - <<'END'
import csv, math, re
found = [line.split() for line in open("discs.txt")]
found = found[1::2]  # each one's edge is drawn first
text = open("balls.svg").read()
rows = list(csv.DictReader(open("contacts.csv")))
assert len(found) == 6, found
legend = float(re.search(r'<text x="([\d.]+)"[^>]*>Points</text>', text)[1])
left = {}
for x, y, width, colour in found:
    left[float(x), float(y)] = float(width), colour
scales = set()
for row in rows:  # the drawing is as high as the picture: f = 150 / tan 15 deg; its middle is that of what the legend leaves
    f, away = 150 / math.tan(math.radians(15)), 300 - float(row["z"])
    y = 150 - f * float(row["y"]) / away
    near = [at for at in left if abs(at[1] - y) < 0.02]
    assert len(near) == 3, (row, left)
    middle = {round(at[0] - f * float(other["x"]) / away, 1) for at in near for other in rows if other["name"] == row["name"]}
    scales.add(frozenset(middle))
    width = {left[at][0] for at in near}
    assert all(abs(value - 2 * f * 4 / away) < 0.02 for value in width), (row, width, 2 * f * 4 / away)
groups = {}
for row in rows:
    f, away = 150 / math.tan(math.radians(15)), 300 - float(row["z"])
    y = 150 - f * float(row["y"]) / away
    groups.setdefault(row["name"][0], set()).update(left[at][1] for at in left if abs(at[1] - y) < 0.02)
shared = frozenset.intersection(*map(frozenset, scales))
assert len(shared) == 1 and 0 < list(shared)[0] < legend, scales  # one middle fits all balls
assert all(len(colours) == 1 for colours in groups.values()) and groups["A"] != groups["B"], groups
assert re.search(r">A</text>.*>3</text>.*>B</text>.*>3</text>", text, re.S)
END
    sed -i s/-30/5/ contacts.csv && gl render sphere.nii.gz --pose contacts.csv --colour-by lab --size 400x300 --opacity 0 --view top -q -o lab.svg
    [ "$(grep -oE '>(x|y|z|[0-9])<' lab.svg | tr -d '<>\n')" = x3y2z1 ]
    [ "$(discs lab.svg | awk 'NR % 2 == 0 {print $4}' | sort -u | wc -l)" -eq 3 ]
}

@test "more than six numbers of --colour-by have a scale, six or fewer are groups" {
    sphere --size 32
    # The ends and the middle of the scale of docs/commands.md, dark blue over green to yellow; grey where there is no number.
    { echo x,y,z,uV && for n in 0 1 2 3 4 5 6 7 8; do echo "$((n * 3 - 12)),0,0,$((n * 5 - 20))"; done && echo 0,8,0,n/a; } >scale.csv
    gl render sphere.nii.gz --pose scale.csv --colour-by uV --size 400x300 --opacity 0 --view top -q -o scale.svg --caption scale.txt
    discs scale.svg | awk 'NR % 2 == 0 {print $4}' | sort >found.txt
    [ "$(sort -u found.txt | wc -l)" -eq 10 ]
    for colour in '#222e6e' '#289c80' '#fae650' '#808080'; do grep -qix -- "$colour" found.txt; done
    grep -q '>uV<' scale.svg && grep -q '>not known<' scale.svg && ! grep -q 'other groups' scale.svg
    grep -q '^uV$' scale.txt
    sed -i '8,$d' scale.csv
    gl render sphere.nii.gz --pose scale.csv --colour-by uV --size 400x300 --opacity 0 --view top -q -o six.svg
    ! grep -q '>uV<' six.svg && [ "$(grep -oE '>-?[0-9]+<' six.svg | grep -c 1)" -ge 6 ]
}

@test "names neither overlap nor hide a ball, and the others are counted" {
    sphere --size 32
    { echo name,x,y,z && for n in {1..60}; do echo "Contact $n,$((n % 10 * 4 - 18)),$((n / 10 * 5 - 12)),0"; done; } >many.csv
    gl render sphere.nii.gz --pose many.csv --size 300x240 --opacity 0 --view top -q -o many.svg
    discs many.svg >discs.txt
    /usr/bin/python3 - <<'END'
import re
text = open("many.svg").read()
names = [(float(x), float(y) - 0.8 * float(em), float(x) + float(wide), float(y))
         for x, y, em, wide in re.findall(r'<text x="([\d.]+)" y="([\d.]+)" font-size="([\d.]+)" textLength="([\d.]+)"[^>]*>Contact \d+</text>', text)]
left, all_ = map(int, re.search(r">(\d+) of (\d+) names have no room<", text).groups())
assert all_ == 60 and 0 < left < 60 and len(names) == 60 - left, (left, len(names))
balls = [tuple(map(float, line.split()[:3])) for line in open("discs.txt")][1::2]
assert len(balls) == 60
boxes = names + [(x - wide / 2 + 0.5, y - wide / 2 + 0.5, x + wide / 2 - 0.5, y + wide / 2 - 0.5) for x, y, wide in balls]
for i, a in enumerate(names):
    for b in boxes[i + 1:]:
        assert not (a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]), (a, b)
END
}

# A ball of 6 mm whose middle is 3.6 mm off has a circle of 4.8 mm; one of 1 mm is drawn up to 2 mm off.
@test "cuts show the balls that they go through, or that are near" {
    sphere --size 32
    printf 'name,x,y,z\nP,0,0,3.6\n' >far.csv
    answers render sphere.nii.gz --pose far.csv --radius 6 --cuts axial:0 --size 400x300 -o large.svg
    answers render sphere.nii.gz --pose far.csv --radius 6 --cuts axial:3.6 --size 400x300 -o largest.svg
    discs large.svg | awk 'NR == 2 {print $3}' >a
    discs largest.svg | awk 'NR == 2 {print $3}' >b
    awk -v a="$(cat a)" -v b="$(cat b)" 'BEGIN {exit !(a / b > 0.799 && a / b < 0.801)}'
    answers render sphere.nii.gz --pose far.csv --cuts axial:1.7 --size 400x300 -o near.svg
    [ "$(discs near.svg | wc -l)" -eq 2 ]
    answers render sphere.nii.gz --pose far.csv --cuts axial:1.5 --size 400x300 -o none.svg
    [ "$(discs none.svg | wc -l)" -eq 0 ]
    answers render sphere.nii.gz --pose far.csv --cuts axial,coronal --size 400x300 -o through.svg # its own cuts
    [ "$(discs through.svg | wc -l)" -eq 4 ]
    printf 'name,x,y,z\nA,-5,1,-8\nB,5,1,4\nC,3,7,5\nD,4,-9,-7.5\nE,4.5,0,5.5\n' >five.csv # x 3 to 5, y 0 to 1, z 4 to 5.5
    answers render sphere.nii.gz --pose five.csv --cuts axial,coronal,sagittal --size 600x300 -q -o five.svg
    has_text() { grep -qF ">$1<" five.svg; }
    has_text 'z = 4 mm'
    has_text 'y = 0 mm'
    has_text 'x = 3 mm'
    not grep -q 'in no cut' five.svg
    answers render sphere.nii.gz --pose five.csv --cuts axial --size 400x300 -q -o five.svg
    has_text '2 of 5 points are in no cut'
}

@test "a pose has a line to what its axis meets first, or is a ring, and a point has none" {
    sphere --size 32
    printf 'name,x,y,z,tx,ty,tz\nabove,0,0,30,0,0,0\naside,0,0,30,0,50,30\n' >two.csv
    run --separate-stderr "$CONUS" render sphere.nii.gz --pose two.csv --size 400x300 --opacity 0 -o two.svg --view front
    [ "$status" -ne 4 ] || need_gl
    [ "$status" -eq 0 ]
    check_message 'note: two.csv: 2 poses in one picture, as balls with lines to their ends, or what their axes meet first; {query} or {row} in'
    [ "$(discs two.svg | wc -l)" -eq 5 ] # each with its edge, and the hole of the one that points at nothing
    [ "$(grep -E 'd="M200 [0-9.]+L200 [0-9.]+"' two.svg | grep -cvE 'M(200 [0-9.]+)L\1"')" -eq 2 ] # straight down, with its edge
    printf 'x y z\n0 0 30\n0 0 900\n' >one.txt
    gl render sphere.nii.gz --pose one.txt --size 400x300 --opacity 0 -o one.svg
    [ "$(discs one.svg | wc -l)" -eq 2 ]
    grep -q '>1 of 2 points are outside of the picture<' one.svg
}

@test "a needle has a line to its target, also where it begins in an area" {
    sphere --size 32
    printf 'name,entry_x,entry_y,entry_z,target_x,target_y,target_z\nA,0,0,30,0,0,-10\nB,0,0,10,0,0,-10\n' >needles.csv
    gl render sphere.nii.gz --pose needles.csv --size 400x300 --opacity 0 -q -o needles.svg --view front
    # From z = 30, from 10, to -10: of the three heights the middle one is half way.
    grep -oE 'd="M200 [0-9.]+L200 [0-9.]+"' needles.svg | grep -oE ' [0-9.]+' | tr -d ' L' | sort -gu | awk '{ at[NR] = $1 }
        END { exit !(NR == 3 && at[3] - at[1] > 100 && (at[1] + at[3] - 2 * at[2]) ^ 2 < 4) }'
}

@test "rows that are none are named, and options without an effect refused" {
    sphere --size 16
    contacts
    printf 'bad,1,2\n' >>contacts.csv
    run --separate-stderr "$CONUS" render sphere.nii.gz --pose contacts.csv -o a.png $SMALL -q
    [ "$status" -ne 4 ] || need_gl
    [ "$status" -eq 1 ]
    [[ $stderr = *'contacts.csv:8: '* ]]
    contacts
    local render=(render sphere.nii.gz --pose contacts.csv -o b.png)
    fails 2 '--layers has no effect: a picture of several poses, or of points, shows them as balls' "${render[@]}" --layers all
    fails 2 '--resolution has no effect: a picture of several poses' "${render[@]}" --resolution 8
    fails 3 'contacts.csv: keep: no column is called "side"; columns found: "name", "x", "y", "z", "lab"' \
        "${render[@]}" --colour-by side
    fails 2 '--colour-by and --strips exclude each other' "${render[@]}" --colour-by lab --strips
    fails 2 '--colour-by has no effect without --poses' render sphere.nii.gz --colour-by lab -o b.png
    printf 'x,y,z,tx,ty,tz,lab\n0,0,60,0,0,0,a\n' >pose.csv
    fails 2 '--colour-by has no effect on the cone of one pose' render sphere.nii.gz --pose pose.csv --colour-by lab -o b.png
    [ ! -e b.png ]
}
