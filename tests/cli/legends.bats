#!/usr/bin/env bats
# Legends and captions of pictures: what has a row, how names are written, and what stands out in cuts.
load helpers

@test "a legend names what has a colour, at most twelve, without a cone, in cuts and beside bundles, too" {
    conus phantom brain -o .
    conus phantom bundle -o .
    conus phantom sphere -o . --size 32
    gl render brain.atlas.json --opacity 0.3 --size 400x300 -o brain.svg -q
    grep -q '>Areas and pathways<' brain.svg
    gl render bundle.atlas.json --size 400x300 -o bundle.svg -q
    grep -q '>Bundle<' bundle.svg
    answers render bundle.atlas.json --cuts axial -o cut.svg -q
    grep -q '>Bundle<' cut.svg
    gl render sphere.nii.gz --size 400x300 -o one.svg -q # one area: a colour tells nothing apart
    [ "$(grep -c '<desc>' one.svg)" -eq 1 ]
    [ "$(grep -c 'font-weight\|>Ball<' one.svg)" -eq 0 ]
    PYTHONPATH=$BATS_TEST_DIRNAME /usr/bin/python3 -B -c 'import nifti
nifti.write("many.nii", (30, 10, 10), "B", lambda i, j, k: i // 2 + 1)'
    answers render many.nii --cuts axial -o many.svg -q
    grep -q '>and 3 others<' many.svg
    answers render many.nii --cuts axial --legend-rows 14 -o more.svg -q
    grep -q '>and 1 other<' more.svg
    answers render many.nii --cuts axial --legend none -o none.svg -q
    [ "$(grep -c '>and' none.svg)" -eq 0 ]
    answers render many.nii --cuts axial --fill 0 --width-mm 85 -o grey.svg -q # outlines of one grey
    [ "$(grep -c '>and' grey.svg)" -eq 0 ]
}

@test "where colours repeat, names stand on areas, and only those without room have a number and a row" {
    PYTHONPATH=$BATS_TEST_DIRNAME /usr/bin/python3 -B -c 'import nifti
nifti.write("stripes.nii", (62, 6, 30), "B", lambda i, j, k: 5 if i > 59 else i // 15 + 1)'
    printf '%s\n' 'index	name' '1	Alpha' '2	Beta' '3	Gamma_ray' '4	Delta' '5	Narrow_one' >names.tsv
    local look=(--labels names.tsv --view front --size 900x500 -q)
    gl render stripes.nii "${look[@]}" --palette '#102030,#E0C010' -o names.svg --caption names.txt
    /usr/bin/python3 -B - <<'CHECK'
import re
drawing = re.sub("<desc>.*</desc>", "", open("names.svg").read(), flags=re.S)
at = {}
for x, y, text in re.findall(r'<text x="([-0-9.]+)" y="([-0-9.]+)"[^>]*>([^<]*)<', drawing):
    at.setdefault(text, []).append((float(x), float(y)))
names = ["Alpha", "Beta", "Gamma ray", "Delta"]
places = [at[name] for name in names]  # on the stripes, and in no row
assert all(len(place) == 1 for place in places), at
columns = [place[0][0] for place in places]
assert columns in (sorted(columns), sorted(columns, reverse=True)), at
assert max(columns) - min(columns) > 300, at
assert len(at["1"]) == 1 and len(at["1  Narrow one"]) == 1, at
CHECK
    [ "$(grep -c '^\(Alpha\|Beta\|Gamma_ray\|Delta\|Narrow_one\) (#' names.txt)" -eq 5 ]
    gl render stripes.nii "${look[@]}" --palette bright -o rows.svg # each has a colour of its own
    grep -q '>Gamma ray<' rows.svg
    [ "$(grep -c '>1  ' rows.svg)" -eq 0 ]
}

@test "no number stands in a picture whose row the legend has left out" {
    PYTHONPATH=$BATS_TEST_DIRNAME /usr/bin/python3 -B -c 'import nifti
nifti.write("many.nii", (60, 10, 10), "B", lambda i, j, k: i // 4 + 1)'
    for sheet in '' '--cuts 3d,axial'; do
        gl render many.nii --origin 0,-60,0 --toward 0,0,0 --angle 60 $sheet -q -o many.svg
        grep -q '>and 3 others<' many.svg
        grep -q '>12<' many.svg
        [ "$(grep -c '>13<\|>14<\|>15<' many.svg)" -eq 0 ]
    done
}

@test "names in pictures have spaces and sides, and the very names stand in the description and the caption" {
    conus phantom slabs -o . --size 32
    printf '%s\n' 'index	name' '1	Slab_front_L' '300	Slab_front_R' >names.tsv
    answers render slabs.nii.gz --labels names.tsv --cuts axial --origin=0,-60,0 --toward 0,0,0 --angle 20 -q \
        -o named.svg --caption named.txt
    grep -q '>Slab front right<\|>Slab front left<' named.svg
    [ "$(sed '/<desc>/,/<\/desc>/d' named.svg | grep -c 'Slab_front')" -eq 0 ]
    grep -q '^Slab_front_[LR] (#[0-9A-F]*): share [0-9.]* %, distance [0-9.]* mm$' named.txt
    sed -n '/<desc>/,/<\/desc>/p' named.svg | grep -q 'Slab_front_[LR] (#'
}

# What conus query and conus cite say of the same question is what the caption says of the method.
@test "a caption says what is shown, what colours are, warnings, and the paragraph of conus cite" {
    conus phantom slabs -o . --size 32
    local cone=(--origin=0,-60,0 --toward 0,0,0 --angle 20)
    answers query slabs.nii.gz "${cone[@]}" -o answer.tsv -q
    answers cite answer.tsv
    printf '%s\n' "$output" >cited.txt
    answers render slabs.nii.gz "${cone[@]}" --cuts axial --width-mm 85 -q -o cut.svg --caption cut.txt
    [ "$(head -1 cut.txt)" = 'Cuts of the atlas slabs.nii.gz: axial, with a cone from the device.' ]
    grep -q '^First hits of the cone: 20° from 0, -60, 0, RAS mm, along 0, 1, 0$' cut.txt
    [ "$(grep -c ' from 0, -60' <(sed '/<desc>/,/<\/desc>/d' cut.svg))" -eq 0 ] # on paper coordinates are the caption's
    diff cited.txt <(tail -n "$(wc -l <cited.txt)" cut.txt)
    answers render slabs.nii.gz --cuts axial -q -o plain.png --caption plain.txt
    grep -q '^Areas are those of the atlas slabs ' plain.txt
    printf 'name,x,y,z\nA1,0,0,0\nA2,5,0,0\n' >points.csv
    answers render slabs.nii.gz --pose points.csv --cuts axial -q -o points.png --caption points.txt
    [ "$(head -1 points.txt)" = 'Cuts of the atlas slabs.nii.gz: axial, with 2 points of points.csv.' ]
    printf 'name,x,y,z\nA1,0,0,0\nA2,nan,0,0\nA3,5,400,0\n' >some.csv
    fails 1 'some.csv:3: ' render slabs.nii.gz --pose some.csv --cuts axial -q -o some.png --caption some.txt
    [ "$(head -1 some.txt)" = 'Cuts of the atlas slabs.nii.gz: axial, with 2 points of some.csv, 1 of them outside of the'\
' atlas; 1 of 3 rows could not be drawn.' ]
    printf '%s\n' 'index	name' '1	A_R' '2	B_R' '3	C_R' '4	A_L' '5	B_L' '6	C_L' >wrong.tsv
    PYTHONPATH=$BATS_TEST_DIRNAME /usr/bin/python3 -B -c 'import nifti
nifti.write("sides.nii", (12, 10, 10), "B", lambda i, j, k: i // 2 + 1)'
    answers render sides.nii --labels wrong.tsv --cuts axial -q -o sides.png --caption sides.txt
    grep -q '^Warning: .*left and right exchanged' sides.txt
    # 3 of 12,892 pixels are something, in the legend as in the list
    local edge=(slabs.nii.gz --origin=18,-60,18 --toward 18,0,18 --angle 20 --resolution 128 -q)
    conus query "${edge[@]}" | grep -q '^ *1  Slab anterior  *1  *<0\.1 %'
    answers render "${edge[@]}" --cuts axial -o edge.png --caption edge.txt
    grep -q '^Slab anterior (#[0-9A-F]*): <0\.1 %, distance' edge.txt
    printf '7\tD\n' >>wrong.tsv # a name of no area is a note, which --quiet leaves out
    not grep '^Note: ' sides.txt
    conus render sides.nii --labels wrong.tsv --cuts axial -o noted.png --caption noted.txt
    grep -q '^Note: areas of the label table without a voxel: 1 (7)$' noted.txt
    printf 'name,x,y,z,tx,ty,tz\nC1,0,-60,0,0,0,0\nC2,5,-60,0,5,0,0\n' >poses.csv
    answers render slabs.nii.gz --pose poses.csv --cuts axial -q -o poses.png --caption poses.txt
    [ "$(head -1 poses.txt)" = 'Cuts of the atlas slabs.nii.gz: axial, with 2 poses of poses.csv.' ]
    echo C3,0,-60,0,0,-120,0 >>poses.csv
    answers render slabs.nii.gz --pose poses.csv --cuts axial -q -o hollow.png --caption hollow.txt
    [ "$(head -1 hollow.txt)" = 'Cuts of the atlas slabs.nii.gz: axial, with 3 poses of poses.csv, 1 of them hollow, which point at'\
' nothing.' ]
    conus phantom bundle -o .
    gl render bundle.atlas.json --streamline-colour direction --size 300x200 -q -o fibres.png --caption fibres.txt
    grep -q '^Bundle (coloured as below)$' fibres.txt
    fails 2 '--caption: one file is for one picture' render slabs.nii.gz --pose points.csv -o '{row}.png' --caption c.txt
    fails 2 '--caption points.csv would overwrite the input points.csv' render slabs.nii.gz --pose points.csv \
        -o points.png --caption points.csv
}

@test "a needle passes areas, for so many mm, and has no share" {
    conus phantom slabs -o . --size 32
    local axis=(--origin=0,-60,0 --toward 0,0,0 --layers all --cuts axial -q)
    answers render slabs.nii.gz "${axis[@]}" --radius 1 -o needle.svg
    grep -q '>The needle passes<' needle.svg
    grep -q '>entered at<' needle.svg
    grep -q '>for<' needle.svg
    [ "$(grep -c ' %<\|>behind<' needle.svg)" -eq 0 ]
    answers render slabs.nii.gz "${axis[@]}" --radius 5 -o tube.svg
    grep -q '>The cylinder passes<' tube.svg
    grep -q ' %<' tube.svg
}

# The slab is from -6 to -3; a needle that begins in it at -5 has 2 mm of it, and all its contacts are at its start.
@test "cuts of a needle go through its axis, in the middle of what it passes of the best hit" {
    conus phantom slabs -o . --size 32
    answers render slabs.nii.gz --origin=2,-5,3 --toward 2,0,3 --radius 1 --cuts axial,coronal,sagittal -q -o inside.svg
    for title in 'x = 2' 'y = −4' 'z = 3'; do grep -q ">$title mm<" inside.svg; done
    answers render slabs.nii.gz --origin=2,-60,3 --toward 2,0,3 --radius 1 --cuts coronal,sagittal -q -o outside.svg
    for title in 'x = 2' 'y = −4.5'; do grep -q ">$title mm<" outside.svg; done
}

# colour_at FILE X Y: red, green and blue of a pixel, by parts of width and height.
colour_at() {
    /usr/bin/python3 - "$@" <<'END'
import sys
import OpenImageIO as oiio
rgb = oiio.ImageInput.open(sys.argv[1]).read_image(oiio.UINT8)
print(*rgb[int(float(sys.argv[3]) * rgb.shape[0]), int(float(sys.argv[2]) * rgb.shape[1]), :3])
END
}

# In the middle of the sphere's mask, where the nested areas are: the mask has its colour, areas none.
@test "what was added stands out from areas in cuts, and by its values where that is asked" {
    conus phantom nested -o . --size 32
    conus phantom sphere -o . --size 32
    local look=(--cuts axial:0 --legend none --background white --size 300x300 --fill 1 -q)
    answers render nested.nii.gz "${look[@]}" -o areas.png
    answers render nested.nii.gz "${look[@]}" --pathway sphere.nii.gz,name=M -o mask.png
    answers render nested.nii.gz "${look[@]}" --pathway sphere.nii.gz,name=M --palette file -o own.png
    answers render nested.nii.gz "${look[@]}" --pathway sphere.nii.gz,name=M --pathway-transfer heat -o heat.png
    [ "$(colour_at mask.png .5 .5)" != "$(colour_at areas.png .5 .5)" ]
    [ "$(colour_at heat.png .5 .5)" != "$(colour_at mask.png .5 .5)" ]
    PYTHONPATH=$BATS_TEST_DIRNAME /usr/bin/python3 -B -c 'import nifti
nifti.write("map.nii", (21, 21, 21), "B", lambda i, j, k: max(0, 200 - (i-10)**2 - (j-10)**2 - (k-10)**2), 2)'
    answers render nested.nii.gz --cuts axial:0 --pathway map.nii,name=M,threshold=150 --fill 0 -q -o own.svg
    answers render nested.nii.gz --cuts axial:0 --pathway map.nii,name=M,threshold=150 --pathway-transfer heat \
        --fill 0 -q -o bar.svg --caption bar.txt
    local own=$(sed -n 's/^M (\(#[0-9A-F]*\))$/\1/p' <(sed -n '/<desc>/,/<\/desc>/p' own.svg))
    grep -q '^M (coloured as below)$' bar.txt
    grep -qi "stroke=\"$own\"" own.svg
    grep -q 'stroke="#730508"' bar.svg # as heat begins
    [ "$(grep -ci "stroke=\"$own\"" bar.svg)" -eq 0 ]
    answers render nested.nii.gz --cuts axial:0 --pathway sphere.nii.gz,name=M -o mask.svg -q
    grep -q '>M<' mask.svg
    gl render nested.nii.gz --shell --pathway sphere.nii.gz,name=M --view left --size 300x200 -q -o shell.svg
    grep -q '>M<' shell.svg
}

# 85 mm are 1004 pixels; the four panels of a sheet take at least four fifths of the width, less the letters' bands.
@test "four panels of a column of print are two by two, and a sheet's sagittal cut goes through the middle of the hit" {
    conus phantom slabs -o . --size 32
    gl render slabs.nii.gz --cuts 3d,axial,coronal,sagittal --width-mm 85 --origin=0,-60,0 --toward 0,0,0 --angle 20 -q \
        -o sheet.svg
    /usr/bin/python3 - sheet.svg <<'END'
import re, sys
texts = {word: (float(x), float(y)) for x, y, word in
         re.findall(r'<text x="([-\d.]+)" y="([-\d.]+)"[^>]*>([a-d])<', open(sys.argv[1]).read())}
top, bottom = max(texts[p][1] for p in "ab"), min(texts[p][1] for p in "cd")
assert bottom > top + 300 and texts["b"][0] > texts["a"][0] + 400 and texts["d"][0] > texts["c"][0] + 400, texts
END
    answers render slabs.nii.gz --cuts coronal --origin=0,-60,0 --toward 0,0,0 --angle 20 -q -o middle.svg
    grep -q '>y = −4.5 mm<' middle.svg # the slab is from -6 to -3
}

# The image is as large as the area: opaque, it would leave a rim only.
@test "an image that opaque areas cover is left out of the view in space, and stays where they do not" {
    conus phantom sphere -o . --size 32
    local look=(--view left --size 200x150 --no-legend --background white -q)
    gl render sphere.nii.gz "${look[@]}" -o bare.png
    gl render sphere.nii.gz "${look[@]}" --context sphere.nii.gz -o covered.png
    cmp bare.png covered.png
    gl render sphere.nii.gz "${look[@]}" --context sphere.nii.gz --transfer brain -o asked.png
    run ! cmp -s bare.png asked.png
}
