#!/usr/bin/env bats
# A surface as ATLAS, as a user types it.
load helpers

# array INTENT TYPE DIMS NUMBERS: a DataArray in text.
array() {
    echo "<DataArray Intent=\"NIFTI_INTENT_$1\" DataType=\"NIFTI_TYPE_$2\" Encoding=\"ASCII\" Endian=\"LittleEndian\"" \
        "ArrayIndexingOrder=\"RowMajorOrder\" $3>"
    [ "$1" != POINTSET ] || echo "<CoordinateSystemTransformMatrix><DataSpace>NIFTI_XFORM_MNI_152</DataSpace>" \
        "<TransformedSpace>NIFTI_XFORM_MNI_152</TransformedSpace></CoordinateSystemTransformMatrix>"
    echo "<Data>$4</Data></DataArray>"
}

gifti() {
    printf '<?xml version="1.0"?>\n<!DOCTYPE GIFTI SYSTEM "gifti.dtd">\n<GIFTI Version="1.0">\n'
    cat
    echo "</GIFTI>"
}

# Two squares side by side at z = 0, x from -20 to 20, y from -10 to 10.
square() {
    array POINTSET FLOAT32 'Dimensionality="2" Dim0="6" Dim1="3"' "-20 -10 0 0 -10 0 20 -10 0 -20 10 0 0 10 0 20 10 0" |
        sed "s/Dim0=\"6\"/Dim0=\"${1:-6}\"/"
    array TRIANGLE INT32 'Dimensionality="2" Dim0="4" Dim1="3"' "0 1 4 0 4 3 1 2 5 1 5 4"
}

# labels: 7 on the left, 3 on the right and 7 between.
labels() {
    echo '<LabelTable><Label Key="7">west</Label><Label Key="3" Red="1" Green="0" Blue="0">east</Label></LabelTable>'
    array LABEL INT32 "Dimensionality=\"1\" Dim0=\"$1\"" "7 7 3 7 7 3 ${2:-}"
}

# 208 of 16 x 16 pixels have their centre in the disc. With t = tan(2.5 degrees), the nearest rays are t/16 off to the
# side twice, and meet the plane at 30 sqrt(1 + 2 (t/16)^2) = 30.0002234, 30 t/16 = 0.0818643 from 5; the farthest on
# the disc, 7.5 and 2.5 pixels off the middle, at 30 sqrt(1 + t^2 62.5/64) = 30.027911.
@test "a surface is one area, called as its file" {
    square | gifti >lh.pial.surf.gii
    run -0 --separate-stderr "$CONUS" query lh.pial.surf.gii --origin 5,5,30 --toward 5,5,0 --angle 5 --resolution 16 --format tsv
    # shellcheck disable=SC2154 # bats sets stderr
    [ "$stderr" = "conus: note: lh.pial.surf.gii: the surface is not closed" ]
    [ "$(cut -f 2-4,8,13-16 <<<"${lines[1]}")" = "area	1	lh.pial	208	30.0002234	4.91813573	4.91813573	0" ]
}

@test "in all layers an open surface is pierced, and said to have no inside" {
    square | gifti >lh.pial.surf.gii
    run -0 --separate-stderr "$CONUS" query lh.pial.surf.gii --origin 5,5,30 --toward 5,5,0 --angle 5 --resolution 16 --format tsv --layers all
    # shellcheck disable=SC2154 # bats sets stderr
    [[ "$stderr" = *"note: 1 of 1 surfaces are not closed: paths count only where a ray goes in and comes out"* ]]
    # pierced, entry, exit, path, volume, fraction
    [ "$(cut -f 10,17-21 <<<"${lines[1]}")" = "208	30.0002234	30.027911	0	n/a	n/a" ]
}

# A tetrahedron of 500 / 3 mm^3 and the mirror image of one of 400 / 3 beside it, whose triangles were not turned
# around: their signed volumes sum to 100 / 3, and the solids to 300.
@test "a surface with parts that face different ways is closed, but has no fraction" {
    { array POINTSET FLOAT32 'Dimensionality="2" Dim0="8" Dim1="3"' "1 0 0 11 0 0 1 10 0 1 0 10 -1 0 0 -9 0 0 -1 10 0 -1 0 10"
      array TRIANGLE INT32 'Dimensionality="2" Dim0="8" Dim1="3"' "0 2 1 0 1 3 0 3 2 1 2 3 4 6 5 4 5 7 4 7 6 5 6 7"; } | gifti >halves.gii
    run -0 --separate-stderr "$CONUS" info halves.gii --format tsv
    [ "$(cut -f 10,11 <<<"${lines[1]}")" = "yes	n/a" ]
    run -0 --separate-stderr "$CONUS" query halves.gii --origin 2,2,30 --toward 2,2,0 --angle 2 --format tsv --layers all
    # shellcheck disable=SC2154 # bats sets stderr
    [[ "$stderr" = *"note: 1 of 1 surfaces overlap themselves, or have parts that face inwards and are no cavities"* ]]
    [ "$(cut -f 21 <<<"${lines[1]}")" = n/a ]
    # Along z at (2, 2) it is solid from 0 to 10 - 1 - 2 = 7.
    run -0 --separate-stderr "$CONUS" query halves.gii --origin 2,2,30 --toward 2,2,0 --angle 0.001 --format json --layers all -q
    [ "$(jq '.Rows[0].path_mm * 1000 | round' <<<"$output")" = 7000 ]
}

@test "labels of the vertices cut it, in its own file or another" {
    { square; labels 6; } | gifti >both.gii
    square | gifti >surface.gii
    labels 6 | gifti | gzip >labels.gii.gz
    for atlas in both.gii "surface.gii --labels labels.gii.gz"; do
        # shellcheck disable=SC2086 # words
        run -0 --separate-stderr "$CONUS" info $atlas --format tsv
            [ "$(cut -f 2,3,7 <<<"${lines[1]}")" = "3	east	#ff0000" ]
        [ "$(cut -f 2,3 <<<"${lines[2]}")" = "7	west" ]
        # shellcheck disable=SC2086
        run -0 --separate-stderr "$CONUS" query $atlas --origin 15,0,30 --toward 15,0,0 --angle 5 --format tsv
        [ "$(cut -f 3,4 <<<"${lines[1]}")" = "3	east" ]
        # shellcheck disable=SC2086
        run -0 --separate-stderr "$CONUS" query $atlas --origin=-10,0,30 --toward=-10,0,0 --angle 5 --format tsv
        [ "$(cut -f 3,4 <<<"${lines[1]}")" = "7	west" ]
    done
}

# The plane y = 0 cuts the surface along x, the east of which begins at 10: a cone at 15 hits it first.
@test "on paper, too, cuts of a surface have the colour of what is hit" {
    { square; labels 6; } | gifti >both.gii
    "$CONUS" render both.gii --cuts coronal:0 --origin 15,0,30 --toward 15,0,0 --angle 5 --width-mm 85 -q -o hit.svg
    [ "$(grep -ci 'stroke="#d2246c"' hit.svg)" = 1 ] # LOOK_RANK_1
    [ "$(grep -ci 'stroke="#69737d"' hit.svg)" = 1 ] # LOOK_OUTLINE, of the west
    "$CONUS" render both.gii --cuts coronal:0 --width-mm 85 -q -o all.svg
    [ "$(grep -ci 'stroke="#ff0000"' all.svg)" = 1 ] # the east's own, as the table says
    [ "$(grep -ci 'stroke="#69737d"' all.svg)" = 0 ]
}

@test "its answer and its picture go into files" {
    square | gifti >s.gii
    local aim="s.gii --origin 5,5,30 --toward 5,5,0"
    # shellcheck disable=SC2086 # words
    run -0 --separate-stderr "$CONUS" query $aim --angle 5 -o labels.tsv --image seen.exr --voxels v.tsv --voxels-of all
    [ "$(sed -n 2p labels.tsv | cut -f 2-4)" = "area	1	s" ]
    [ "$(wc -l <v.tsv)" = 1 ] # a surface has no voxels
    # shellcheck disable=SC2086
    run -0 --separate-stderr "$CONUS" query $aim -o the.txt
    # shellcheck disable=SC2086
    fails 2 "--voxels lists the voxels of pathways, and there is none" query $aim --voxels v.tsv
    # shellcheck disable=SC2086
    fails 2 "--output s.gii would overwrite the input s.gii" query $aim --format table -o s.gii
    labels 6 | gifti >two.gii
    # shellcheck disable=SC2086
    fails 2 "--output two.gii would overwrite the input two.gii" query $aim --labels two.gii --format table -o two.gii
    echo '{"conus_atlas": 1, "areas": [{"file": "s.gii", "label": 3}]}' >m.atlas.json
    fails 2 "--output s.gii would overwrite the input s.gii" query m.atlas.json --origin 0,0,9 --toward 0,0,0 --format table -o s.gii
    "$CONUS" render s.gii --size 16x16 -o s.png || lacks_gl
}

@test "labels without a name are called by their number, in a manifest, too" {
    square | gifti >s.gii
    { labels 6 | sed 's/<Label Key="7">west//; s/<.Label>//'; } | gifti >labels.gii
    echo '{"conus_atlas": 1, "areas": [{"file": "s.gii", "vertex_labels": "labels.gii"}]}' >m.atlas.json
    run -0 --separate-stderr "$CONUS" info m.atlas.json --format tsv
    [ "$(cut -f 2,3 <<<"${lines[1]}")" = "3	east" ]
    [ "$(cut -f 2,3 <<<"${lines[2]}")" = "7	7" ]
}

@test "pathways of a manifest have voxels to list" {
    "$CONUS" phantom sphere -o . --size 16
    echo '{"conus_atlas": 1, "pathways": [{"file": "sphere.nii.gz", "name": "way"}]}' >s.atlas.json
    run -0 --separate-stderr "$CONUS" query s.atlas.json --origin 0,0,60 --toward 0,0,0 --voxels v.tsv -o a.tsv
    [ "$(sed -n 2p v.tsv | cut -f 2,9,11)" = "way	1	pathway" ]
}

@test "what contradicts itself is refused with its line" {
    square 7 | gifti >dim.gii
    fails 3 "dim.gii: line 6, DataArray 0: Data: 18 numbers, the Dim attributes ask for 21" info dim.gii
    { square; labels 7 3; } | gifti >labels.gii
    fails 3 "labels.gii: labels of 7 vertices, the surface labels.gii has 6" info labels.gii
    square | sed 's/0 1 4/0 1 6/' | gifti >index.gii
    fails 3 "index.gii: triangle 0: vertex index 6, allowed are whole numbers from 0 to 5" info index.gii
    square | sed 's/-20 -10/nan -10/' | gifti >nan.gii
    fails 3 "nan.gii: vertex 0: a coordinate is nan mm" info nan.gii
    labels 6 | gifti >alone.gii
    fails 3 "alone.gii: no POINTSET array: not a surface" info alone.gii
    square | sed 's/ASCII/ExternalFileBinary/' | gifti >external.gii
    fails 3 "arrays in other files are not read unless that is allowed" info external.gii
    head -c 700 dim.gii >cut.gii
    fails 3 "cut.gii: line " info cut.gii
}

@test "labels of vertices fit every surface that numbers its vertices" {
    printf 'v -20 -10 0\nv 0 -10 0\nv 20 -10 0\nv -20 10 0\nv 0 10 0\nv 20 10 0\nf 1 2 5\nf 1 5 4\nf 2 3 6\nf 2 6 5\n' >s.obj
    labels 6 | gifti >labels.gii
    run -0 --separate-stderr "$CONUS" info s.obj --format tsv
    [ "$(cut -f 2,3 <<<"${lines[1]}")" = "1	s" ]
    square | gifti >s.gii
    run -0 --separate-stderr "$CONUS" info s.gii --labels labels.gii --format tsv
    wanted=$output
    run -0 --separate-stderr "$CONUS" info s.obj --labels labels.gii --format tsv
    [ "$output" = "$wanted" ]
    printf 'solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 9 0 0\nvertex 0 9 0\nendloop\nendfacet\nendsolid\n' >s.stl
    fails 3 "s.stl: labels of vertices need a surface that numbers its vertices" info s.stl --labels labels.gii
}

@test "surfaces in a folder keep their files' names, and answers name the folder and every file" {
    mkdir faces
    for name in lh.pial lh.white S.L.mid.32k_fs_LR S.R.mid.32k_fs_LR; do
        square | gifti >"faces/$name.surf.gii"
    done
    run -0 --separate-stderr "$CONUS" info faces --format tsv
    [ "$(cut -f 3 <<<"$output" | tail -n +2 | sort | paste -sd ' ')" = "S.L.mid.32k_fs_LR S.R.mid.32k_fs_LR lh.pial lh.white" ]
    for folder in faces faces/; do
        run -0 --separate-stderr "$CONUS" query --force $folder --origin 5,5,30 --toward 5,5,0 --angle 5 --image faces.exr -q
        grep -qF "atlas faces, placed by the coordinates in its mesh files" <<<"$output"
        run -0 --separate-stderr "$CONUS" query --force $folder --origin 5,5,30 --toward 5,5,0 --angle 5 -q -o rows.tsv
        grep -qF "\"path\": \"$folder\"" rows.json
        for file in faces/*; do
            sum=$(sha256sum <"$file" | cut -d ' ' -f 1)
            grep -qF "$sum" rows.json
            grep -qaF "$sum  $file" faces.exr
        done
    done
}

@test "an XML, a manifest and labels of their own are named as they were given, with every file" {
    "$CONUS" phantom slabs -o .
    printf '<atlas version="1.0"><header><name>S</name><type>Label</type><images><imagefile>/slabs</imagefile>%s' \
        '<summaryimagefile>/slabs</summaryimagefile></images></header><data>' >s.xml
    echo '<label index="0" x="0" y="0" z="0">One</label></data></atlas>' >>s.xml
    echo '{"conus_atlas": 1, "parcellation": "slabs.nii.gz"}' >s.atlas.json
    printf '1 One\n2 Two\n3 Three\n' >names.txt
    for atlas in s.xml s.atlas.json "slabs.nii.gz --labels names.txt"; do
        # shellcheck disable=SC2086 # words
        run -0 --separate-stderr "$CONUS" query --force $atlas --origin 0,0,100 --toward 0,0,0 --image s.exr -q
        grep -qF "atlas ${atlas%% *}, placed by" <<<"$output"
        # shellcheck disable=SC2086
        run -0 --separate-stderr "$CONUS" query --force $atlas --origin 0,0,100 --toward 0,0,0 -q -o s.tsv
        for file in slabs.nii.gz "${atlas##* }"; do
            sum=$(sha256sum <"$file" | cut -d ' ' -f 1)
            grep -qF "$sum" s.json
            grep -qaF "$sum" s.exr
        done
    done
}

# names_files FILE...: asserts that the JSON and EXR of a query of $atlas name exactly these files with sha256sum's
# sums; volumes have another list.
names_files() {
    local file sum words
    read -ra words <<<"$atlas"
    run -0 --separate-stderr "$CONUS" query --force "${words[@]}" --origin 0,0,100 --toward 0,0,0 -q -o p.tsv
    run -0 --separate-stderr "$CONUS" query --force "${words[@]}" --origin 0,0,100 --toward 0,0,0 -q --image p.exr
    for file in "$@"; do
        sum=$(sha256sum <"$file" | cut -d ' ' -f 1)
        grep -qF "$sum" p.json
        grep -qaF "$sum" p.exr
    done
    [ "$(jq -r 'del(.Outputs) | .. | objects | select(has("sha256")) | .path | ltrimstr("./")' p.json | sort -u | paste -sd ' ')" = \
        "$(printf '%s\n' "$@" | sort | paste -sd ' ')" ]
}

@test "a label table that is found beside a volume is named with its sum, one that is not used is not" {
    "$CONUS" phantom slabs -o . --size 16
    atlas=slabs.nii.gz names_files slabs.nii.gz slabs.tsv
    mv slabs.tsv kept
    printf '1 One\n2 Two\n' >slabs.nii.txt
    cp slabs.nii.txt slabs.txt # read, and not contradicted
    head -c 768 /dev/zero | tr '\0' '\1' >slabs.lut
    atlas=slabs.nii.gz names_files slabs.nii.gz slabs.lut slabs.nii.txt
    rm slabs.nii.txt slabs.txt slabs.lut
    printf '<atlas version="1.0"><header><name>S</name><type>Label</type><images><imagefile>/slabs</imagefile>%s' \
        '<summaryimagefile>/slabs</summaryimagefile></images></header><data>' >s.xml
    echo '<label index="1" x="0" y="0" z="0">One</label></data></atlas>' >>s.xml
    atlas=slabs.nii.gz names_files slabs.nii.gz s.xml
    echo '{"conus_atlas": 1, "parcellation": {"file": "slabs.nii.gz", "labels": "kept"}}' >s.atlas.json
    atlas=s.atlas.json names_files slabs.nii.gz s.atlas.json kept
}

@test "every pathway's file is named with its sum, alone and in a manifest" {
    for kind in slabs sphere torus; do
        "$CONUS" phantom $kind -o . --size 16
    done
    atlas="slabs.nii.gz --pathway sphere.nii.gz --pathway torus.nii.gz" names_files slabs.nii.gz slabs.tsv sphere.nii.gz torus.nii.gz
    cat >s.atlas.json <<'END'
{"conus_atlas": 1, "parcellation": "slabs.nii.gz",
 "pathways": [{"file": "sphere.nii.gz"}, {"file": "torus.nii.gz"}]}
END
    atlas=s.atlas.json names_files s.atlas.json slabs.nii.gz slabs.tsv sphere.nii.gz torus.nii.gz
}

# A tetrahedron with corners at 0 and 20 mm along each axis: inside is where x + y + z < 20 and none is below 0.
@test "a device inside a closed surface is told of, in a pose file and with both engines, too" {
    {
        array POINTSET FLOAT32 'Dimensionality="2" Dim0="4" Dim1="3"' "0 0 0 20 0 0 0 20 0 0 0 20"
        array TRIANGLE INT32 'Dimensionality="2" Dim0="4" Dim1="3"' "0 2 1 0 1 3 1 2 3 2 0 3"
    } | gifti >tetra.surf.gii
    local aim='--toward 1,1,1 --angle 5 --format tsv'
    # shellcheck disable=SC2086 # words
    run -0 --separate-stderr "$CONUS" query tetra.surf.gii --origin 2,3,4 $aim
    check_message 'note: the device lies inside tetra'
    # shellcheck disable=SC2086
    answers query tetra.surf.gii --origin 15,15,15 $aim # in its box
    printf 'x\ty\tz\ttx\tty\ttz\n9\t9\t9\t1\t1\t1\n9\t8\t2\t1\t1\t1\n9\t9\t1\t1\t1\t1\n' >poses.tsv
    local words='note: poses.tsv: 2 of 3 devices lie inside an area, the first in line 3, inside tetra'
    run -0 --separate-stderr "$CONUS" batch tetra.surf.gii --poses poses.tsv -o rows.tsv --threads 2 --block 1
    check_message "$words"
    run --separate-stderr "$CONUS" batch tetra.surf.gii --poses poses.tsv -o rows.tsv --force --engine gl
    [ "$status" -ne 4 ] || need_gl
    check_message "$words"
}

# numbers COUNT NUMBERS: an array called leeway_mm.
numbers() {
    array SHAPE FLOAT32 "Dimensionality=\"1\" Dim0=\"$1\"" "$2" |
        sed 's|<Data>|<MetaData><MD><Name>Name</Name><Value>leeway_mm</Value></MD></MetaData><Data>|'
}

@test "a map colours the surface of the context" {
    need_all
    square | gifti >skin.surf.gii
    numbers 6 "1 2 3 1 2 5" | gifti >m.shape.gii
    numbers 5 "1 2 3 1 2" | gifti >short.shape.gii
    sphere --size 24
    local scene=(render sphere.nii.gz --view top $SMALL --context skin.surf.gii)
    fails 2 'one is needed of 0 "leeway_mm"' "${scene[@]}" -o a.png --map m.shape.gii,array=leeway
    fails 2 'short.shape.gii: 5 numbers, but skin.surf.gii has 6 vertices' "${scene[@]}" -o a.png \
        --map short.shape.gii,array=leeway_mm
    fails 2 '--map: range: found "5:1", allowed are two numbers LOW:HIGH, the second larger' "${scene[@]}" -o a.png \
        --map m.shape.gii,array=leeway_mm,range=5:1
    fails 2 '--map: found "rage=1:5", allowed are array, range; did you mean range?' "${scene[@]}" -o a.png --map m.shape.gii,rage=1:5
    fails 2 '--map: m.shape.gii: which array? FILE,array=NAME' "${scene[@]}" -o a.png --map m.shape.gii
    fails 2 'm.shape.gii: 6 numbers: 0 surfaces of the context have so many vertices' render sphere.nii.gz -o a.png \
        --map m.shape.gii,array=leeway_mm
    [ ! -e a.png ]
    gl "${scene[@]}" -q -o map.exr --map m.shape.gii,array=leeway_mm
    gl "${scene[@]}" -q -o same.exr --map m.shape.gii,array=0,range=1:5 --context-opacity 1
    answers diff map.exr same.exr
    gl "${scene[@]}" -q -o wider.exr --map m.shape.gii,array=leeway_mm,range=0:5
    run -1 conus diff map.exr wider.exr
    gl "${scene[@]}" -q -o pale.exr --map m.shape.gii,array=leeway_mm --context-opacity 0.25
    run -1 conus diff map.exr pale.exr
}

@test "its space can be stated, and that it is in the mm of an image" {
    cd "$BATS_TEST_TMPDIR"
    printf 'OFF\n3 1 0\n10 1 0\n20 1 0\n10 9 0\n3 0 1 2\n' >t.off
    # voxels of 2 mm from (0, 0, 0), the first axis to the left: FSL counts as the voxels do
    printf 'NRRD0004\ntype: uchar\ndimension: 3\nspace: RAS\nsizes: 2 2 2\nspace directions: (-2,0,0) (0,2,0) (0,0,2)\n' >i.nrrd
    printf 'space origin: (0,0,0)\nencoding: text\n\n0 1 0 1 0 1 0 1\n' >>i.nrrd
    at() { "$CONUS" query "$1" --origin "$2,3,50" --direction 0,0,-1 --angle 1 --format tsv --quiet | cut -f 4 | sed -n 2p; }
    [ "$(at t.off 12)" = t ]
    [ "$(at t.off,space=i.nrrd -12)" = t ]
    [ "$(at t.off,space=i.nrrd,volume=0 -12)" = t ] # which is the image's
    run -2 "$CONUS" info t.off,space=i.nrrd,resolution=25
    [[ "$output" == *"i.nrrd: resolution is for TIFF stacks and OME-Zarr"* ]]
    run -2 "$CONUS" info t.off,space=i.nrrd,volume=1
    [[ "$output" == *"i.nrrd: volume: found 1, allowed are 0 to 0"* ]]
    "$CONUS" query t.off,space=lps --origin=-12,-3,50 --direction 0,0,-1 --angle 1 --format tsv 2>notes | grep -q t
    [ ! -s notes ] || ! grep -q "RAS was taken" notes
    # of a folder's surfaces, and in a manifest
    mkdir set
    cp t.off set/t.off
    [ "$(at set 12)" = t ]
    [ "$(at set,space=i.nrrd -12)" = t ]
    "$CONUS" query set,space=lps --origin=-12,-3,50 --direction 0,0,-1 --angle 1 --format tsv | grep -q t
    cp i.nrrd set/i.nrrd
    printf '{"conus_atlas": 1, "areas": [{"file": "t.off", "label": 1}], "space": "i.nrrd"}' >set/s.atlas.json
    [ "$(at set/s.atlas.json -12)" = t ]
    for none in i.nrrd set/s.atlas.json; do
        run -2 "$CONUS" info $none,space=lps
        [[ "$output" == *"space= is for surfaces, and this is none"* ]]
    done
}
