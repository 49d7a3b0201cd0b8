#!/usr/bin/env bats
# conus plan --from --toward: candidates from entries and targets.
#
# A box of 8 x 6 x 4 mm round the origin is a surface; its 8 corners are its vertices, and the normal of a corner points
# along its three faces, weighted by their areas in the triangles there.

load helpers

# box NAME [REVERSED]: a closed box as PLY, its triangles counter-clockwise from outside, or from inside.
box() {
    local order='{print 3, $1, $2, $3}'
    [ -z "${2-}" ] || order='{print 3, $1, $3, $2}'
    {
        printf 'ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n'
        printf 'element face 12\nproperty list uchar int vertex_indices\nend_header\n'
        printf '%s\n' '-40 -30 -20' '40 -30 -20' '40 30 -20' '-40 30 -20' '-40 -30 20' '40 -30 20' '40 30 20' '-40 30 20'
        printf '%s\n' '0 2 1' '0 3 2' '4 5 6' '4 6 7' '0 1 5' '0 5 4' '3 6 2' '3 7 6' '0 4 7' '0 7 3' '1 2 6' '1 6 5' | awk "$order"
    } >"$1"
}

needles() {
    conus phantom u-shape -o .
    printf '%s\n' '40 0 5' '40 10 5' '40 0 15' >entries.txt
    printf '%s\n' '18 0 5' '-18 0 5' >targets.txt
    box box.ply
    U='plan u-shape.nii.gz --reach U'
    P="$U --from entries.txt --toward targets.txt"
}

cells() {
    awk -F '\t' -v names="$*" '
        NR == 1 { n = split(names, name, " "); for (i = 1; i <= NF; i++) at[$i] = i; next }
        { for (i = 1; i <= n; i++) {
              cell = $at[name[i]]
              printf "%s%s", cell ~ /^-?[0-9.]+$/ ? sprintf("%.4f", cell) + 0 : cell, i < n ? " " : ";" } }' <<<"$output"
}

# From (40, 0, 5) to (18, 0, 5) and 4 mm on are 26 mm.
@test "every entry goes to every target" {
    needles
    answers $P --depth target+4 --format tsv -q --rank=-depth --top all
    [ "$(cells query | tr ';' '\n' | sort | tr '\n' ';')" = "e1-t1;e1-t2;e2-t1;e2-t2;e3-t1;e3-t2;" ]
    [ "$(cells query entry target far_mm entry_angle_deg | cut -d ';' -f 1)" = "e1-t1 1 1 26 n/a" ]
    run -0 --separate-stderr conus $P --depth target-4
    [[ "$stderr" == *"conus: 6 candidates: "* ]]
}

@test "points of a file keep their names, unless two are equal or one begins with a digit" {
    needles
    printf '%s\n' '40 0 5 F3' '40 10 5 left door' '40 0 15 C3' >entries.txt
    answers $P --depth target+4 --format tsv -q --rank=-depth --top all
    [ "$(cells query | tr ';' '\n' | sort | tr '\n' ';')" = "C3-t1;C3-t2;F3-t1;F3-t2;left door-t1;left door-t2;" ]
    [ "$(cells query entry target far_mm | cut -d ';' -f 1)" = "F3-t1 1 1 26" ]
    for name in F3 7th; do
        printf '%s\n' '40 0 5 F3' "40 10 5 $name" '40 0 15' >entries.txt
        answers $P --depth target+4 --format tsv -q --top all
        [[ "$(cells query)" == *'e3-t2'* ]]
    done
}

# "a-b" to "c" and "a" to "b-c" would have one name.
@test "names that could be of two needles are numbers" {
    needles
    printf '%s\n' '40 0 5 a-b' '40 10 5 a' >entries.txt
    printf '%s\n' '10 0 5 c' '10 5 5 b-c' >targets.txt
    answers $P --depth target+4 --infeasible --format tsv -q --top all
    [ "$(cells query | tr ';' '\n' | sort -u | grep -c .)" = 4 ]
    [[ "$(cells query)" == *'e2-t2'* ]]
    sed -i s/b-c/b_c/ targets.txt
    answers $P --depth target+4 --infeasible --format tsv -q --top all
    [ "$(cells query | tr ';' '\n' | sort | tr '\n' ';')" = "a-b-b_c;a-b-c;a-b_c;a-c;" ]
}

# Asked again, the listed poses are the same text, but for the numbers of entry and target; their lengths are those of
# the segments, and their distances those of the clearances.
@test "a pose that is written is the same pose again" {
    needles
    conus $P --avoid Ball --depth target+4 --tilt 6,3 --radius 1 --top 40 -q -o plan.tsv --poses-out poses.tsv
    conus $U --avoid Ball --poses poses.tsv --radius 1 --top 40 -q -o again.tsv
    cut -f 1-4,7- plan.tsv >a
    cut -f 1-4,7- again.tsv >b
    [ "$(wc -l <a)" -eq 41 ]
    cmp a b
    conus batch u-shape.nii.gz --poses poses.tsv --clearance near.tsv,within=99 --segments segments.tsv --radius 1 -q -o all.tsv
    awk -F '\t' 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next } { print $at["query"], $at["avoid1_mm"], $at["avoid1_at_mm"] }' plan.tsv | sort >a
    awk -F '\t' 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next } $at["name"] == "Ball" { print $at["query"], $at["distance_mm"], $at["depth_mm"] }' near.tsv | sort >b
    cmp a b
    awk -F '\t' 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next } { print $at["query"], $at["reach1_mm"] }' plan.tsv | sort >a
    awk -F '\t' 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next } $at["name"] == "U" { n[$at["query"]]++; mm[$at["query"]] = $at["length_mm"] }
        END { for (id in n) if (n[id] == 1) print id, mm[id] }' segments.tsv | sort >b
    [ -s b ]
    [ "$(join a b | awk '$2 != $3' | wc -l)" -eq 0 ]
}

# Turned by 90 degrees, the second shank is above, beside, below and on the other side of the first.
@test "turned candidates, written and read again, and the opening of a row" {
    needles
    local shanks='--shanks 0,0;0,20'
    conus $P --depth target+4 --roll 90 $shanks --avoid Ball,shank=2 -q --top all -o plan.tsv --poses-out poses.tsv
    [ "$(cut -f 1 plan.tsv | grep -c '^e1-t1-r[1-4]$')" -eq 4 ]
    conus $U --avoid Ball,shank=2 --poses poses.tsv $shanks -q --top all -o again.tsv
    cut -f 1-4,7- plan.tsv >a
    cut -f 1-4,7- again.tsv >b
    cmp a b
    printf 'query_id x y z dx dy dz far angle\na 40 0 5 -1 0 0 30 12.3\nb 40 0 5 -1 0 0 30 n/a\n' | tr ' ' '\t' >open.tsv
    conus plan u-shape.nii.gz --reach U,share=0.01 --poses open.tsv --angle 20 -q -o plan.tsv --force --poses-out poses.tsv
    [ "$(awk -F '\t' 'NR > 1 { print $1, $10 }' poses.tsv | tr -d '"' | sort | tr '\n' ';')" = "a 12.300000000000001;b n/a;" ]
    fails 2 '--roll has no effect without --from' $U --poses targets.txt --depth 9 --roll 9
    fails 2 '--roll' $P --depth 9 --roll 0.001
    [ "$(conus $P --depth 26 --roll 180 -q --top all --format tsv --infeasible | grep -c -- '^e[1-3]-t[12]-r[12]')" -eq 12 ]
    fails 2 '--roll' $P --depth 9 --roll 181
}

@test "poses for 3D Slicer, and the first as a matrix" {
    needles
    conus $P --depth target+4 -q -o plan.tsv --poses-out lines.mrk.json
    conus $U --poses lines.mrk.json --depth 30 --infeasible -q --format tsv -o again.tsv
    output=$(sort plan.tsv) && a=$(cut -f 7-9 plan.tsv | sort)
    [ "$(cut -f 7-9 again.tsv | sort)" = "$a" ]
    [ "$(jq '.markups | length' lines.mrk.json)" -eq 6 ]
    conus $P --depth target+4 -q -o plan.tsv --force --poses-out lines.vtk
    [ "$(sed -n '6,/LINES/p' lines.vtk | awk 'NF == 3 && $1 != "LINES" { printf "%.5f %.5f %.5f%s", $1, $2, $3, NR % 2 ? " " : "\n" }')" = \
        "$(awk -F '\t' 'NR > 1 { for (i = 7; i < 16; i += i == 9 ? 4 : 1) printf "%.5f%s", $i, i < 15 ? " " : "\n" }' plan.tsv)" ]
    [ "$(sed -n '/LOOKUP/,$p' lines.vtk | tail -n +2)" = "$(awk -F '\t' 'NR > 1 { print $18 }' plan.tsv)" ]
    conus info u-shape.nii.gz --streamlines lines.vtk,name=Needles | grep -q 'streamlines  6 with 12 points'
    conus $P --depth target+4 -q -o best.tsv --force --poses-out best.txt
    conus $U --poses best.txt --depth 30 --infeasible -q --format tsv >again.tsv
    [ "$(sed -n 2p best.tsv | cut -f 7-12)" = "$(sed -n 2p again.tsv | cut -f 7-12)" ]
    fails 2 'does not end in .tsv, .mrk.json, .vtk or .txt' $P --depth 30 --poses-out best.csv
}

# The normal of a corner of the box has the signs of the corner: inward it leads towards the middle.
@test "a surface: its normals lead in, also where its triangles are wound the other way" {
    needles
    box inside.ply reversed
    for file in box.ply inside.ply; do
        answers plan u-shape.nii.gz --length 1,99 --from $file --toward normal --depth 9 --format tsv -q --top all
        [ "$(cells query entry_angle_deg | tr ';' '\n' | sort | tr '\n' ';')" = "e1 0;e2 0;e3 0;e4 0;e5 0;e6 0;e7 0;e8 0;" ]
        awk -F '\t' 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
            $at["x"] * $at["dx"] >= 0 || $at["y"] * $at["dy"] >= 0 || $at["z"] * $at["dz"] >= 0 { exit 1 }' <<<"$output"
        answers plan u-shape.nii.gz --length 1,99 --from $file,flip --toward normal --depth 9 --format tsv -q
        [ "$(awk -F '\t' 'NR > 1 && $8 * $11 > 0' <<<"$output" | wc -l)" -eq 8 ]
    done
    sed -e '/^3 1 /d' -e 's/face 12/face 10/' box.ply >open.ply
    run -0 --separate-stderr conus plan u-shape.nii.gz --length 1,99 --from open.ply --toward normal --depth 9
    [[ "$stderr" == *"open.ply: the surface is not closed: its normals are as its triangles are wound"* ]]
    fails 2 '--toward normal: entries.txt has no normals' $U --from entries.txt --toward normal --depth 9
    fails 2 'flip is for surfaces' $U --from entries.txt,flip --toward targets.txt --depth 9
}

@test "the angle at the entry is a constraint, a key and a column" {
    needles
    answers $U --from box.ply --toward targets.txt --depth target+9 --entry-angle 20 --infeasible --top all --format tsv -q
    [ "$(awk -F '\t' 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
        $at["entry_angle_deg"] != $at["angle1_deg"] || ($at["angle1_deg"] > 20) != ($at["broken"] == "angle" || $at["broken"] == "U") && $at["angle1_deg"] > 20' <<<"$output" | wc -l)" -eq 0 ]
    answers $U --from box.ply --toward targets.txt --depth target+9 --rank entry_angle --top 2 --format tsv -q
    [ "$(cells entry_angle_deg | tr ';' '\n' | sort -rnc && echo falls)" = falls ]
    fails 2 '--entry-angle has no effect without --from' $U --poses targets.txt --depth 9 --entry-angle 3
}

# Entries are voxels at the border of the ball, the target is its centre; those of the ball's right half are not within
# the U.
@test "targets of a structure, and entries of a mask" {
    needles
    run -0 --separate-stderr conus plan u-shape.nii.gz --reach Ball --from entries.txt --toward centroid --depth target --top all
    [[ "$stderr" == *"conus: 3 candidates: 3 have some of the axis in Ball"* ]]
    run -0 --separate-stderr conus $U --from entries.txt --toward centroid,of=Ball --depth target
    [[ "$stderr" == *"conus: 3 candidates: "* ]]
    run -0 --separate-stderr conus $U --from entries.txt --toward centroid --depth target
    [[ "$stderr" == *"warning: the centroid of U, "*", is not in it"* ]]
    fails 2 '--toward: U lies on both sides: ' $U --from entries.txt --toward deepest --depth target
    run -0 --separate-stderr conus $U --hemispheres split --from entries.txt --toward 'deepest,of=U left' --depth target
    [[ "$stderr" == *"conus: 3 candidates: 3 have"* ]]
    run -0 --separate-stderr conus $U --from entries.txt --toward voxels,spacing=5,of=Ball --depth target
    few=$(grep -o 'conus: [0-9]* candidates' <<<"$stderr" | grep -o '[0-9]*')
    run -0 --separate-stderr conus $U --from entries.txt --toward voxels,of=Ball --depth target
    [[ "$stderr" == *"conus: 1,"*" candidates"* ]]
    [ "$few" -gt 3 ] && [ "$few" -lt 60 ]
    conus query u-shape.nii.gz --origin 40,0,5 --toward 0,0,5 -q --mask mask.nii.gz >/dev/null
    run -0 --separate-stderr conus $U --from mask.nii.gz,spacing=8 --toward targets.txt --depth target
    [[ "$stderr" == *" candidates: "* ]]
    conus phantom sphere -o . -q 2>/dev/null || conus phantom sphere -o .
    run -0 --separate-stderr conus $U --from sphere.nii.gz,spacing=8,within=sphere.nii.gz --toward targets.txt --depth target
    [[ "$stderr" == *" candidates: "* ]]
}

@test "entries within and without labels, a mask, an area" {
    needles
    conus phantom sphere -o .
    printf '0 0 5\n99 0 0\n-18 0 5\n' >some.txt
    run -0 --separate-stderr conus $U --from some.txt,within=sphere.nii.gz --toward targets.txt --depth 9
    [[ "$stderr" == *"conus: 4 candidates"* || "$stderr" == *"conus: 3 candidates"* ]]
    run -0 --separate-stderr conus $U --from some.txt,without=U,Ball --toward targets.txt --depth 9
    [[ "$stderr" == *"conus: 2 candidates"* ]]
    printf '#!ascii label\n2\n0 0 0 0 0\n7 0 0 0 0\n' >lh.some.label
    answers plan u-shape.nii.gz --length 1,99 --from box.ply,within=lh.some.label --toward normal --depth 9 --format tsv -q
    [ "$(cells query x)" = "e1 -40;e2 -40;" ]
    answers plan u-shape.nii.gz --length 1,99 --from box.ply,without=lh.some.label,spacing=50 --toward normal --depth 9 --format tsv -q
    [ "$(cells query x | cut -d ';' -f 1)" = "e1 40" ]
    fails 2 'without=lh.some.label leaves no entry' $U --from box.ply,without=lh.some.label,within=lh.some.label \
        --toward normal --depth 9
}

@test "invalid candidates are refused" {
    needles
    fails 2 'no candidates given: --poses FILE, or --from FILE --toward WHAT' $U --depth 9
    fails 2 '--from and --poses' $P --depth 9 --poses targets.txt
    fails 2 '--from has no effect without --toward' $U --from entries.txt --depth 9
    fails 2 'found "spasing=2", allowed are spacing, within, without, flip; did you mean spacing?' $U --from entries.txt,spasing=2 --toward targets.txt --depth 9
    fails 2 'spacing: found "0", allowed is a number from 0.001' $U --from entries.txt,spacing=0 --toward targets.txt --depth 9
    fails 2 'found "within=U", allowed are spacing, of' $U --from entries.txt --toward targets.txt,within=U --depth 9
    fails 2 'did you mean "Ball"?' $U --from entries.txt --toward voxels,of=Balll --depth 9
    fails 2 'did you mean' $U --from entries.txt,without=Balll --toward targets.txt --depth 9
    fails 2 'of which structure?' plan u-shape.nii.gz --length 1,9 --from entries.txt --toward voxels --depth 9
    fails 2 'neither a number above 0 nor target[+MM]' $P --depth tip
    fails 2 'neither a number above 0 nor target[+MM]' $P --depth target3
    fails 2 'neither a number above 0 nor target[+MM]' $P --depth -3
    fails 2 'has no effect without --toward' $U --poses targets.txt --depth target
    fails 2 'there is none' $U --from box.ply --toward normal --depth target
    fails 2 '--tilt: "5" is not two numbers MAX,STEP' $P --depth 9 --tilt 5
    fails 2 'tilt: up to 5 degrees in steps of 6' $P --depth 9 --tilt 5,6
    fails 2 'no far end: --depth target, or target+MM, MM, or --range NEAR,FAR' $P
    fails 2 '"voxel" is neither centroid, deepest, voxels nor normal' $U --from entries.txt --toward voxel --depth 9
    fails 2 '"1,-2,3": points are rows of a file, behind a first line x,y,z' $U --from entries.txt --toward 1,-2,3 --depth 9
    fails 2 'deepest,of=Ball is in the structure of that name' $U --from entries.txt --toward Ball --depth 9
    fails 2 '--from takes a mask, which has one value beside 0' $U --from u-shape.nii.gz --toward targets.txt --depth 9
    fails 2 '--from takes a mask' $U --from entries.txt,within=u-shape.nii.gz --toward targets.txt --depth 9
    printf '0 0 0\nnan 0 0\n' >nan.txt
    fails 2 'nan.txt:2: ' $U --from nan.txt --toward targets.txt --depth 9
    : >none.txt
    fails 3 'none.txt' $U --from none.txt --toward targets.txt --depth 9
    printf '1000 0 0\n' >away.txt
    fails 2 'all targets lie outside of the atlas' $U --from entries.txt --toward away.txt --depth 9
    printf '1000 0 0\n0 0 0\n' >away.txt
    run -0 --separate-stderr conus $U --from entries.txt --toward away.txt --depth 9
    [[ "$stderr" == *"note: away.txt: 1 of 2 targets lie outside of the atlas"* ]]
    run -0 --separate-stderr conus $U --from targets.txt --toward targets.txt --depth 9
    [[ "$stderr" == *"note: targets.txt: 2 of 4 poses are no candidates, the first is number 1: toward: is the origin itself"* ]]
    awk 'BEGIN { for (i = 0; i < 20000; i++) print 5 + i / 1e4, 0, 0 }' >many.txt
    fails 2 'candidates, allowed are 1.1e+12' $U --from many.txt --toward many.txt --depth 9 --tilt 90,1
}

@test "entries, targets and other needles are of the atlas's space" {
    needles
    positions_of_a_scan u-shape.nii.gz
    local asked="plan mni.nii --length 1,99 --depth 9" words='positions are in "NIfTI:Scanner", the atlas in another space'
    fails 3 "scan.txt: $words" $asked --from scan.txt --toward targets.txt
    fails 3 "scan.txt: $words" $asked --from entries.txt --toward scan.txt
    fails 3 "scan.txt: $words" $asked --from entries.txt --toward targets.txt --apart scan.txt,1
    run -0 conus $asked --from entries.txt --toward scan.txt --any-space -q
    printf '0.04 0 0.005\n0.03 0 0.005\n' >metres.txt
    run -0 --separate-stderr conus $asked --from metres.txt --toward targets.txt
    [[ "$stderr" == *"warning: metres.txt: all positions lie within 1 mm of the origin, as if they were in metres"* ]]
}

@test "a plan from entries can be verified, and knows its files" {
    needles
    conus $P --depth target+4 --tilt 6,3 -q -o plan.tsv
    conus verify plan.tsv
    grep -q entries.txt plan.json
    grep -q targets.txt plan.json
}

# The best pose of each vertex is its first in the list of all, with whatever turn; the box has 8 vertices. Without
# nibabel only the bytes are compared.
@test "a map has the best pose of each vertex" {
    needles
    local asked=($U --toward voxels,spacing=9 --depth target+4 --avoid Ball --radius 1 -q --force
        --shanks '0,0;6,2' --roll 120)
    local scene=("${asked[@]}" --from box.ply)
    conus "${scene[@]}" --top all -o all.tsv --map a.func.gii --structure CortexLeft
    conus "${scene[@]}" --top 1 -o one.tsv --map b.func.gii --structure CortexLeft --threads 1
    conus "${scene[@]}" --top 1 -o one.tsv --map c.func.gii --structure CortexLeft --threads 3
    cmp a.func.gii b.func.gii
    cmp a.func.gii c.func.gii
    conus "${asked[@]}" --from box.ply,spacing=50 --top 1 -o one.tsv --map thin.shape.gii
    conus "${asked[@]}" --from box.ply,spacing=50 --top 1 -o one.tsv --map full.shape.gii,fill=nearest
    fails 2 '--map: fill: found "all", allowed is nearest' "${scene[@]}" -o x.tsv --map x.func.gii,fill=all
    fails 2 '--map: fill has no effect without spacing=MM of --from' "${scene[@]}" -o x.tsv --map x.func.gii,fill=nearest
    fails 2 '--map: entries.txt is no surface' $P --depth target -o x.tsv --map x.func.gii
    fails 2 '--map' "${scene[@]}" -o x.tsv --map x.txt
    [ ! -e x.func.gii ]
    /usr/bin/python3 -c 'import nibabel' || return 0
    /usr/bin/python3 - <<'END'
import csv, nibabel, numpy
def read(path):
    image = nibabel.load(path)
    return dict(image.meta), {array.meta["Name"]: array.data for array in image.darrays}
meta, a = read("a.func.gii")
assert meta["AnatomicalStructurePrimary"] == "CortexLeft"
columns = {"leeway_mm": "leeway_mm", "slack_mm": "slack_mm", "depth_mm": "far_mm", "entry_angle_deg": "entry_angle_deg", "reach1_mm": "reach1_mm"}
rows = list(csv.DictReader(open("all.tsv"), delimiter="\t"))
assert len(rows) > 8
for vertex in range(8):
    own = [row for row in rows if row["entry"] == str(vertex + 1)]
    assert a["feasible"][vertex] == len(own)
    for name, column in columns.items():
        wanted = float(own[0][column]) if own else numpy.nan
        assert numpy.isclose(a[name][vertex], wanted, rtol=1e-6, equal_nan=True), (vertex, name)
thin, full = read("thin.shape.gii")[1], read("full.shape.gii")[1]
points = numpy.array([[x, y, z] for z in (-20, 20) for x, y in ((-40, -30), (40, -30), (40, 30), (-40, 30))], float)
taken = []
for i, point in enumerate(points):
    if all(numpy.linalg.norm(point - points[j]) >= 50 for j in taken):
        taken.append(i)
assert numpy.array_equal(numpy.flatnonzero(~numpy.isnan(thin["feasible"])), taken) and len(taken) < 8
for i, point in enumerate(points):
    nearest = taken[int(numpy.argmin([numpy.linalg.norm(point - points[j]) for j in taken]))]
    assert full["feasible"][i] == thin["feasible"][nearest]
END
}

# Entries are the border of a mask, targets voxels: each has the best of its rows in the list of all. Voxels without a
# pose are NaN, and a comment names the volumes. Without nibabel only the bytes are compared.
@test "maps of voxels have the best pose of each entry and of each target" {
    needles
    conus query u-shape.nii.gz --origin 40,0,5 --toward 0,0,5 --radius 6 --range 9,12 -q -o rows.tsv \
        --mask skin.nii.gz --mask-of all
    local scene=($U --from skin.nii.gz,spacing=3 --toward voxels,spacing=9 --depth target+4 --avoid Ball --radius 1
        --length 0,50 -q --force)
    conus "${scene[@]}" --top all -o all.tsv --map a.nii.gz --target-map t.nii.gz
    conus "${scene[@]}" --top 1 -o one.tsv --map b.nii.gz --target-map u.nii.gz --threads 1
    conus "${scene[@]}" --top 1 -o one.tsv --map c.nii.gz --target-map v.nii.gz --threads 3
    cmp a.nii.gz b.nii.gz
    cmp a.nii.gz c.nii.gz
    cmp t.nii.gz u.nii.gz
    cmp t.nii.gz v.nii.gz
    fails 2 '--map: skin.nii.gz is no surface: a map of voxels ends in .nii.gz' "${scene[@]}" -o x.tsv --map x.func.gii
    fails 2 '--map: fill is for surfaces' "${scene[@]}" -o x.tsv --map x.nii.gz,fill=nearest
    fails 2 '--map: entries.txt is no mask' $P --depth target -o x.tsv --map x.nii.gz
    fails 2 '--target-map: the targets of --toward targets.txt are not voxels of one volume' $P --depth target -o x.tsv \
        --target-map x.nii.gz
    fails 2 '--target-map: the targets of --toward normal are not voxels of one volume' $U --from box.ply \
        --toward normal --depth 30 -o x.tsv --target-map x.nii.gz
    fails 2 '--target-map' $P --depth target -o x.tsv --target-map x.func.gii
    [ ! -e x.nii.gz ]
    /usr/bin/python3 -c 'import nibabel' || return 0
    /usr/bin/python3 - <<'END'
import csv, nibabel, numpy
rows = list(csv.DictReader(open("all.tsv"), delimiter="\t"))
assert len(rows) > 100
columns = {"leeway_mm": "leeway_mm", "slack_mm": "slack_mm", "depth_mm": "far_mm", "entry_angle_deg": "entry_angle_deg",
           "reach1_mm": "reach1_mm"}
def check(path, site, names):
    image, grid = nibabel.load(path), nibabel.load("u-shape.nii.gz")
    assert image.shape == grid.shape + (len(names),) and numpy.array_equal(image.affine, grid.affine)
    assert image.header.extensions[0].get_content().decode().rstrip("\0").split("\n") == names
    maps = dict(zip(names, numpy.moveaxis(image.get_fdata(), 3, 0)))
    voxels = numpy.argwhere(numpy.isfinite(maps["feasible"].T))[:, ::-1]  # in the order of the file
    best, count = {}, {}
    for row in rows:
        best.setdefault(int(row[site]), row)
        count[int(row[site])] = count.get(int(row[site]), 0) + 1
    assert len(best) > 3 and len(voxels) >= max(best)
    for number, voxel in enumerate(voxels, 1):
        at = tuple(voxel)
        assert maps["feasible"][at] == count.get(number, 0)
        for name in set(names) & set(columns):
            wanted = best[number][columns[name]] if number in best else "n/a"
            wanted = numpy.nan if wanted == "n/a" else float(wanted)
            assert numpy.isclose(maps[name][at], wanted, rtol=1e-6, equal_nan=True), (number, name)
        if number in best and site == "entry":
            point = nibabel.affines.apply_affine(image.affine, voxel)
            assert numpy.allclose(point, [float(best[number][a]) for a in "xyz"], atol=1e-4)
            assert maps["candidate"][at] > 0
check("a.nii.gz", "entry", [*columns, "feasible", "candidate"])
check("t.nii.gz", "target", ["leeway_mm", "feasible"])
END
}
