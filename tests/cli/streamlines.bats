#!/usr/bin/env bats
# --streamlines: tractograms beside areas and pathways, as a user types them.
load helpers

tck() {
    python3 "$BATS_TEST_DIRNAME/tck.py" "$@"
}

# Two slabs across y as the atlas; two streamlines, of 20 and of 3 + 4 mm.
scene() {
    conus phantom slabs -o . --size 32
    tck two.tck -10,10,0 10,10,0 -- 0,0,0 3,0,0 3,4,0
}
AIM='--origin 0,0,100 --toward 0,0,0 --angle 20 -q'

# bats test_tags=main
@test "info tells of a tractogram, its bundle and its length" {
    scene
    answers info slabs.nii.gz --streamlines two.tck
    has 'file         two.tck'
    has 'format       MRtrix Float32LE'
    has 'streamlines  2 with 5 points, 27 mm long together'
    has 'bundles      1, of radius 0.5 mm'
    has 'reaches      x -10 to 10, y 0 to 10, z 0 to 0 mm'
    has "sha256       $(sha256sum two.tck | cut -d' ' -f1)"
    has '0 pathways, 1 bundle'
    answers info slabs.nii.gz --streamlines two.tck,radius=0.25,name=Arc --format tsv
    [ "$(cell kind 3)/$(cell index 3)/$(cell name 3)/$(cell voxels 3)/$(cell streamlines 3)" = bundle/1/Arc/n/a/2 ]
    [ "$(cell streamlines 1)" = n/a ]
}

@test "what is shown of places is neither rounding nor less than 0" {
    scene
    tck near.tck -1e-9,-0.0,-0.0 10,0,-0.0
    answers info slabs.nii.gz --streamlines near.tck
    has 'reaches      x 0 to 10, y 0 to 0, z 0 to 0 mm'
    tck zero.tck -0.0,-0.0,-0.0
    answers info slabs.nii.gz --streamlines zero.tck
    has 'reaches      x 0 to 0, y 0 to 0, z 0 to 0 mm'
    printf '1 0 0 0.04\n0 1 0 -6.04\n0 0 1 0.04\n0 0 0 1\n' >little.txt # the centre and one end come to -0.04 mm
    answers info slabs.nii.gz --atlas-transform little.txt
    has 'centre       0.0, 6.0, 0.0 mm, 6.0 mm from'
    has 'areas are    x -10.0 to 10.0, y 0.0 to 12.0, z -10.0 to 10.0 mm'
    printf '1 0 0 0\n0 1 0 6.04\n0 0 1 0\n0 0 0 1\n' >little.txt
    answers info slabs.nii.gz --atlas-transform little.txt
    has 'y -12.0 to 0.0,'
}

@test "info's JSON has all of it" {
    scene
    answers info slabs.nii.gz --streamlines two.tck,radius=0.25 --format json
    python3 -c '
import json, sys
info = json.load(sys.stdin)
(tract,) = info["tractograms"]
assert (tract["streamlines"], tract["points"], tract["length_mm"], tract["radius_mm"]) == (2, 5, 27, 0.25), tract
assert (tract["low"], tract["high"]) == ([-10, 0, 0], [10, 10, 0]), tract
assert (tract["bundles"], tract["scalars"], tract["half"]) == (["two"], [], False), tract
bundle = info["objects"][-1]
assert (bundle["kind"], bundle["streamlines"], bundle["length_mm"]) == ("bundle", 2, 27), bundle
' <<<"$output"
    answers info slabs.nii.gz --format json
    [ "$(python3 -c 'import json, sys; print(json.load(sys.stdin)["tractograms"])' <<<"$output")" = '[]' ]
}

@test "several tractograms are bundles with ordinals, beside pathways" {
    scene
    tck more.tck 0,0,20 0,0,10
    sphere --size 32
    answers info slabs.nii.gz --pathway sphere.nii.gz,threshold=0.5 --streamlines two.tck --streamlines more.tck \
        --format tsv
    [ "$(cell kind 3)/$(cell index 3)" = pathway/1 ]
    [ "$(cell kind 4)/$(cell index 4)/$(cell name 4)" = bundle/1/two ]
    [ "$(cell kind 5)/$(cell index 5)/$(cell name 5)/$(cell streamlines 5)" = bundle/2/more/1 ]
    fails 2 'bundle two: another bundle has that name; name= gives it one of its own' info slabs.nii.gz --streamlines two.tck \
        --streamlines more.tck,name=two
}

# bats test_tags=main
@test "a table names the bundles and their files, a sidecar their sums" {
    scene
    # shellcheck disable=SC2086 # words
    answers query slabs.nii.gz $AIM --streamlines two.tck,radius=0.25
    [ "${lines[-1]}" = 'bundle two: 2 streamlines of radius 0.25 mm in two.tck' ]
    tck more.tck 0,0,20 0,0,10
    # shellcheck disable=SC2086
    answers query slabs.nii.gz $AIM --streamlines two.tck,radius=0.25 --streamlines more.tck
    [ "${lines[-1]}" = '2 bundles: 3 streamlines of radius 0.25 to 0.5 mm in 2 files' ]
    # shellcheck disable=SC2086
    answers query slabs.nii.gz $AIM --streamlines more.tck
    [ "${lines[-1]}" = 'bundle more: 1 streamline of radius 0.5 mm in more.tck' ]
    # shellcheck disable=SC2086
    answers query slabs.nii.gz $AIM --streamlines two.tck -o rows.tsv
    [ "$(python3 -c '
import json
(tract,) = json.load(open("rows.json"))["Atlas"]["tractograms"]
print(tract["path"], tract["streamlines"], tract["radius_mm"], tract["sha256"])')" = \
        "two.tck 2 0.5 $(sha256sum two.tck | cut -d' ' -f1)" ]
}

# From above: the streamline at y = 4 lies in the slab from 3 to 6 mm.
@test "a bundle with the name of an area is told from it by the label" {
    scene
    tck more.tck -1,4,0 1,4,0
    answers query slabs.nii.gz --origin 0,4,100 --toward 0,4,0 --angle 2 --layers all \
        --streamlines "more.tck,name=Slab anterior"
    grep -Eq '^ +1  Slab anterior +area 1 ' <<<"$output"
    grep -Eq '^ +2  Slab anterior +bundle 1 ' <<<"$output"
    answers query slabs.nii.gz --origin 0,4,100 --toward 0,4,0 --angle 2 --layers all --streamlines more.tck
    grep -Eq '^ +1  Slab anterior +1 ' <<<"$output"
    grep -Eq '^ +2  more +1 ' <<<"$output"
}

# bats test_tags=main
@test "a TRX inside gzip is refused with a word" {
    scene
    printf 'PK\3\4' | gzip >lines.trx.gz
    fails 3 'lines.trx.gz: a TRX inside gzip' info slabs.nii.gz --streamlines lines.trx.gz
}

@test "a bundle that areas hide has a note" {
    conus phantom nested -o . --size 32 --spacing 2,2,2
    tck in.tck -2,0,0 2,0,0
    run -0 --separate-stderr "$CONUS" query nested.nii.gz --origin 0,0,100 --toward 0,0,0 --streamlines in.tck
    [ "$stderr" = 'conus: note: no bundle or pathway is seen; areas may hide them: --layers all has all that a cone passes' ]
    run -0 --separate-stderr "$CONUS" query nested.nii.gz --origin 0,0,100 --toward 0,0,0 --streamlines in.tck --layers all
    [ -z "$stderr" ]
    for aim in '0,0,0 hidden.tck 1' '0,0,200 no.tck 0'; do
        read -r toward file count <<<"$aim"
        run -0 --separate-stderr "$CONUS" query nested.nii.gz --origin 0,0,100 --toward "$toward" --streamlines in.tck --streamlines-out "$file"
        grep -qx "conus: note: $file: $count of 1 streamlines written: all that come in, also behind areas" <<<"$stderr"
    done
}

@test "bundles are hidden like areas, and then no line tells of them" {
    scene
    # shellcheck disable=SC2086
    answers query slabs.nii.gz $AIM --streamlines two.tck --hide two
    not grep -q 'streamlines' <<<"$output"
    has 'shown: all but two'
    # shellcheck disable=SC2086
    fails 2 'no area, pathway or bundle' query slabs.nii.gz $AIM --streamlines two.tck --hide tow
}

@test "verify answers again, and tells that a tractogram has changed" {
    scene
    # shellcheck disable=SC2086
    conus query slabs.nii.gz $AIM --streamlines two.tck,radius=0.25,name=Arc -o rows.tsv
    run -0 "$CONUS" verify rows.tsv
    has identical
    tck two.tck 0,0,1 0,0,2
    run -1 "$CONUS" verify rows.tsv
    has two.tck
}

@test "verify answers again from the files of a TRX folder" {
    conus phantom slabs -o . --size 32
    mkdir -p arc.trx/groups
    python3 -c '
import struct
def put(path, format, *numbers):
    open("arc.trx/" + path, "wb").write(struct.pack(format, *numbers))
put("positions.3.float32", "<12f", -10, 10, 0, 10, 10, 0, 0, 0, 0, 3, 0, 0)
put("offsets.uint64", "<2Q", 0, 2)
put("groups/arc.long.uint32", "<I", 0)
open("arc.trx/header.json", "w").write("{\"NB_STREAMLINES\": 2, \"NB_VERTICES\": 4}")'
    # shellcheck disable=SC2086 # words
    answers query slabs.nii.gz $AIM --streamlines arc.trx -o rows.tsv
    answers verify rows.tsv
    has 'rows.tsv: identical'
    answers cite rows.tsv
    printf '\101' | dd of=arc.trx/positions.3.float32 bs=1 seek=3 conv=notrunc
    run -1 conus verify rows.tsv
    has 'arc.trx/positions.3.float32 changed'
    # shellcheck disable=SC2086
    fails 2 'arc.trx/header.json' query slabs.nii.gz $AIM --streamlines arc.trx -o arc.trx/header.json
}

@test "verify tells rows of a batch that have bundles from its segments" {
    scene
    printf '%s\t' query_id x y z tx ty tz | sed 's/\t$/\n/' >poses.tsv
    printf 'a\t0\t0\t100\t0\t0\t0\n' >>poses.tsv
    conus batch slabs.nii.gz --poses poses.tsv --angle 20 --layers all -q --streamlines two.tck -o rows.tsv \
        --segments parts.tsv
    grep -q length_mm rows.json
    answers verify rows.tsv
    has 'rows.tsv: identical'
    answers verify parts.tsv
    has 'parts.tsv: identical'
    conus batch slabs.nii.gz --poses poses.tsv --angle 20 --layers all -q --streamlines two.tck -o alone.tsv
    answers verify alone.tsv
    has 'alone.tsv: identical'
}

@test "cite tells of streamlines as of pathways" {
    scene
    # shellcheck disable=SC2086
    conus query slabs.nii.gz $AIM --streamlines two.tck,radius=0.25 -o rows.tsv
    answers cite rows.tsv
    [[ "${output//$'\n'/ }" == *'The 2 streamlines of two.tck counted as lines; rays hit them as tubes of radius 0.25 mm.'* ]]
}

@test "an option that is none, and a file that is none, are refused" {
    scene
    fails 2 'radius: found "0", allowed is a number above 0' info slabs.nii.gz --streamlines two.tck,radius=0
    fails 2 'radius: found "thin", allowed is a number' info slabs.nii.gz --streamlines two.tck,radius=thin
    fails 2 '"radius=0,5" has a comma in it' info slabs.nii.gz --streamlines two.tck,radius=0,5
    fails 2 '"name=A,B" has a comma in it' info slabs.nii.gz --streamlines two.tck,name=A,B,radius=1
    fails 2 'found "threshold=1", allowed are space, name, radius, moves' info slabs.nii.gz --streamlines two.tck,threshold=1
    fails 2 'name: found "", a name is needed' info slabs.nii.gz --streamlines two.tck,name=
    fails 2 'names no file' info slabs.nii.gz --streamlines ,name=S
    fails 2 'radius 101 mm, allowed is above 0 to 100' info slabs.nii.gz --streamlines two.tck,radius=101
    fails 3 'none.tck' info slabs.nii.gz --streamlines none.tck
    fails 3 'this is a volume' info slabs.nii.gz --streamlines slabs.nii.gz
    fails 3 'give it as --streamlines' info two.tck
    fails 3 'give it as --streamlines' info slabs.nii.gz --pathway two.tck
    head -c 100 two.tck >cut.tck
    fails 3 'cut.tck' info slabs.nii.gz --streamlines cut.tck
    cp two.tck 'a,b.tck'
    answers info slabs.nii.gz --streamlines a,b.tck --format tsv
    [ "$(cell name 3)" = a,b ]
}

# x 1 to 4 and y 2 to 6 in the file are -4 to -1 and -6 to -2 where these are LPS.
@test "a user states the space of a tractogram" {
    scene
    printf '# vtk DataFile Version 3.0\nnone\nASCII\nDATASET POLYDATA\nPOINTS 2 float\n1 2 3 4 6 8\nLINES 1 3 2 0 1\n' \
        >dipy.vtk
    tck dipy.tck 1,2,3 4,6,8
    local as_is='x 1 to 4, y 2 to 6, z 3 to 8 mm' turned='x -4 to -1, y -6 to -2, z 3 to 8 mm'
    for file in dipy.vtk dipy.tck; do
        answers info slabs.nii.gz --streamlines $file,space=lps
        has "$turned"
        [ $file = dipy.vtk ] || has 'points are taken for LPS, as is stated, but the format says RAS'
        [[ $file = dipy.tck || "$output" != *'does not state its space'* ]]
        answers info slabs.nii.gz --streamlines $file
        has "$as_is"
        [ $file = dipy.tck ] || has 'the file does not state its space; RAS was taken (,space=lps states LPS'
        answers info slabs.nii.gz --streamlines $file,name=a,space=ras,radius=1
        has "$as_is"
        [[ "$output" != *'space'* ]]
    done
    echo '{"conus_atlas": 1, "parcellation": "slabs.nii.gz", "streamlines": [{"file": "dipy.vtk", "space": "lps"}]}' \
        >scene.atlas.json
    answers info scene.atlas.json
    has "$turned"
    sed -i 's/"lps"/"xyz"/' scene.atlas.json
    fails 3 'streamlines[0].space: found "xyz"' info scene.atlas.json
    fails 2 'space: found "up", allowed are ras and lps' info slabs.nii.gz --streamlines dipy.vtk,space=up
    conus query slabs.nii.gz $AIM --streamlines dipy.vtk,space=lps -o a.tsv
    answers verify a.tsv
    cp "$BATS_TEST_DIRNAME/../fuzz/corpus/tract/plain.trk" placed.trk
    fails 2 'space: found lps, but the header of this format places its points' info slabs.nii.gz \
        --streamlines placed.trk,space=lps
    conus info slabs.nii.gz --streamlines placed.trk,space=ras >/dev/null
}

# bats test_tags=main
@test "no output overwrites a tractogram" {
    scene
    # shellcheck disable=SC2086
    fails 2 'the input two.tck' query slabs.nii.gz $AIM --streamlines two.tck --format tsv -o two.tck
}

@test "what is in another space is noted, with its name" {
    scene
    tck far.tck 500,0,0 510,0,0
    run -0 --separate-stderr "$CONUS" query slabs.nii.gz --origin 0,0,100 --toward 0,0,0 --streamlines far.tck -q
    check_message 'warning: bundle far: none of 2 points is in the box around the areas: is it in their space?'
    # all coordinates are from 0 to 31, as indices of the 32 voxels would be; a TCK is in mm
    tck positive.tck 0,0,0 9,9,9 20,20,20
    printf '# vtk DataFile Version 3.0\nSPACE=RAS\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n%s\nLINES 1 4\n3 0 1 2\n' \
        '0 0 0 9 9 9 20 20 20' >positive.vtk
    run -0 --separate-stderr "$CONUS" query slabs.nii.gz --origin 0,0,100 --toward 0,0,0 --streamlines positive.tck
    [[ $stderr != *indices* ]]
    run -0 --separate-stderr "$CONUS" query slabs.nii.gz --origin 0,0,100 --toward 0,0,0 --streamlines positive.vtk
    [[ $stderr == *'bundle positive: all coordinates are from 0 to the 32 x 32 x 32 voxels of the atlas'* ]]
    tck far.tck -5000,0,0 5000,0,0
    run -0 --separate-stderr "$CONUS" query slabs.nii.gz --origin 0,0,100 --toward 0,0,0 --streamlines far.tck
    [[ $stderr == *'bundle far: 1e+04 mm long, beside areas of '*' mm: is one of the two in micrometres, not mm?'* ]]
    tck one.tck 0,0,0 -- 0,0,0 1,0,0
    run -0 --separate-stderr "$CONUS" query slabs.nii.gz --origin 0,0,100 --toward 0,0,0 --streamlines one.tck
    check_message 'note: one.tck: streamlines: of 2, 0 have no point and 1 have one'
}

@test "--atlas-transform leaves what the command line adds where it is, and says where it lay better" {
    scene
    printf '1 0 0 500\n0 1 0 0\n0 0 1 0\n0 0 0 1\n' >away.txt # the space of the poses is 500 mm to the left
    run -0 --separate-stderr "$CONUS" info slabs.nii.gz --streamlines two.tck --atlas-transform away.txt
    has 'reaches      x -10 to 10, y 0 to 10, z 0 to 0 mm'
    has 'bundle two: 0 % of its points are in the box around the areas, 60 % were before these were moved'
    has ',moves behind the file'
    run -0 --separate-stderr "$CONUS" info slabs.nii.gz --streamlines two.tck,moves --atlas-transform away.txt
    has 'reaches      x -510 to -490, y 0 to 10, z 0 to 0 mm'
    not grep -q 'bundle two:' <<<"$output"
}

# A point p of the atlas goes to 2 R (p - (1, 2, 3)), where R turns (x, y, z) to (y, -x, z): all numbers are exact. So
# (0, 0, 100) goes to (-4, 2, 194), (0, 0, 0) to (-4, 2, -6), and tubes are twice as thick. Neither the cone nor shares
# and counts change; lengths double.
@test "what moves is hit as it would be in the atlas's space" {
    scene
    tck own.tck 0,-10,20 0,4,20
    printf '0 -0.5 0 1\n0.5 0 0 2\n0 0 0.5 3\n0 0 0 1\n' >turn.txt
    local bundles='--layers all --angle 20 -q --format tsv'
    # shellcheck disable=SC2086 # words
    conus query slabs.nii.gz --origin 0,0,100 --toward 0,0,0 $bundles --streamlines two.tck --streamlines own.tck >still
    # shellcheck disable=SC2086
    conus query slabs.nii.gz --origin=-4,2,194 --toward=-4,2,-6 $bundles --streamlines two.tck,radius=1,moves \
        --streamlines own.tck,moves,radius=1 --atlas-transform turn.txt >moved
    python3 - <<'END'
import csv
still, moved = (list(csv.DictReader(open(name), delimiter="\t")) for name in ("still", "moved"))
assert [row["name"] for row in still] == [row["name"] for row in moved]
assert {"two", "own"} < {row["name"] for row in still}
for a, b in zip(still, moved):
    for column in ("pixels", "share", "pierced", "voxels", "cone_fraction", "streamlines", "along"):
        assert a[column] == b[column], (column, a, b)
    if a["kind"] == "bundle":
        assert abs(2 * float(a["length_mm"]) - float(b["length_mm"])) < 1e-6, (a, b)
END
}

@test "what cannot move is refused, and a scene's own move is another one" {
    scene
    fails 2 'two.tck,moves: there is no --atlas-transform that could move it' info slabs.nii.gz \
        --streamlines two.tck,moves
    printf '1 0 0 -5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n' >shift.txt
    fails 2 'moves is given twice' info slabs.nii.gz --streamlines two.tck,moves,moves --atlas-transform shift.txt
    tck more.tck 0,0,20 0,0,10
    run -0 --separate-stderr "$CONUS" info slabs.nii.gz --streamlines two.tck --streamlines more.tck,moves --atlas-transform shift.txt --format tsv
    [ "$(cell name 3)/$(cell index 3)/$(cell name 4)/$(cell index 4)" = more/1/two/2 ]
}

# A scene with two tractograms, one of which is brought to the poses with the areas, 5 mm along x.
manifest_scene() {
    scene
    tck more.tck 0,0,20 0,0,10
    printf '1 0 0 -5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n' >shift.txt
    echo '{"conus_atlas": 1, "parcellation": "slabs.nii.gz", "transform": "shift.txt", "streamlines": [
        {"file": "two.tck", "name": "Arc", "radius": 0.25, "moves": true, "comment": "of the template"}, "more.tck"]}' \
        >scene.atlas.json
}

@test "a manifest has streamlines, and moves those that say so" {
    manifest_scene
    answers info scene.atlas.json
    has 'bundles      1, of radius 0.25 mm'
    has 'reaches      x -5 to 15, y 0 to 10, z 0 to 0 mm'
    has 'reaches      x 0 to 0, y 0 to 0, z 10 to 20 mm'
    has '2 bundles'
    answers info scene.atlas.json --atlas-transform shift.txt # it moves everything in the scene
    has 'reaches      x 0 to 20, y 0 to 10, z 0 to 0 mm'
    has 'reaches      x 5 to 5, y 0 to 0, z 10 to 20 mm'
    echo '{"conus_atlas": 1, "streamlines": ["two.tck"]}' >only.atlas.json
    answers info only.atlas.json
    has '0 areas (0 without a name, 0 without a shape), 0 pathways, 1 bundle'
}

@test "a manifest's streamlines are refused by their key" {
    manifest_scene
    sed 's/0.25/0/' scene.atlas.json >bad.atlas.json
    fails 3 'streamlines[0].radius' info bad.atlas.json
    sed 's/more.tck/none.tck/' scene.atlas.json >bad.atlas.json
    fails 3 'streamlines[1]: ./none.tck' info ./bad.atlas.json
    sed 's/more.tck/two.tck/; s/"name": "Arc"/"name": "two"/' scene.atlas.json >bad.atlas.json
    fails 3 'streamlines[1]: two.tck: bundle two: another bundle has that name' info bad.atlas.json
    sed 's/"radius": 0.25/"threshold": 1/' scene.atlas.json >bad.atlas.json
    fails 3 'streamlines[0].threshold' info bad.atlas.json
    sed 's/"transform": "shift.txt", //' scene.atlas.json >bad.atlas.json
    fails 3 'streamlines[0].moves: there is no transform that could move it' info bad.atlas.json
}

@test "a first manifest of a folder takes its tractograms" {
    scene
    printf 'mrtrix tracks\nEND\n' >broken.tck
    cp two.tck two.x.tck
    gzip -k two.tck
    run -0 --separate-stderr "$CONUS" manifest .
    [[ "$stderr" == *'two.tck: streamlines'* ]]
    [[ "$stderr" == *'broken.tck'* ]]
    python3 -c '
import glob, json
(path,) = glob.glob("*.atlas.json")
assert json.load(open(path))["streamlines"] == [
    {"file": "two.tck", "name": "two"}, {"file": "two.tck.gz", "name": "two.tck.gz"}, {"file": "two.x.tck", "name": "two.x"}]'
    answers info ./*.atlas.json
    has '3 bundles'
}

# A TRX tractogram of two streamlines, the first one in the group left.
trx() {
    python3 - "$@" <<'END'
import json, os, struct, sys, zipfile
identity = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
head = {"DIMENSIONS": [9, 9, 9], "VOXEL_TO_RASMM": identity, "NB_VERTICES": 4, "NB_STREAMLINES": 2}
files = {"header.json": json.dumps(head).encode(), "positions.3.float32": struct.pack("<12f", *range(12)),
         "offsets.uint64": struct.pack("<3Q", 0, 2, 4), "groups/left.uint32": struct.pack("<I", 0)}
for path in sys.argv[1:]:
    archive = zipfile.ZipFile(path, "w") if path.endswith(".trx") else None
    for name, data in files.items():
        if archive:
            archive.writestr(name, data)
        else:
            os.makedirs(os.path.dirname(f"{path}/{name}"), exist_ok=True)
            open(f"{path}/{name}", "wb").write(data)
    if archive:
        archive.close()
END
}

@test "a first manifest takes TRX and lines of VTK once each, and loads" {
    scene
    trx one.trx two.trx folder
    printf '%s\n' '# vtk DataFile Version 3.0' x ASCII 'DATASET POLYDATA' 'POINTS 2 float' '0 0 0 1 1 1' 'LINES 1 3' \
        '2 0 1' >lines.vtk
    run -0 --separate-stderr "$CONUS" manifest .
    [ "$(grep -c ': streamlines$' <<<"$stderr")" = 5 ]
    not grep -q 'left out' <<<"$stderr"
    run -0 --separate-stderr "$CONUS" info ./*.atlas.json --format tsv
    local names=
    for row in {3..10}; do
        [ "$(cell kind "$row")" = bundle ]
        names+="$(cell name "$row"),"
    done
    [ "$names" = 'left,folder,lines,one left,one,two,two.trx left,two.trx,' ]
    [ "$(wc -l <<<"$output")" = 11 ]
}

# far COUNT: a tractogram of 100,000 points, COUNT of which lie in the sphere and the others far away, evenly mixed.
far() {
    /usr/bin/python3 -c '
import struct, sys
inside = int(sys.argv[1])
points = [0 if i * inside // 100000 != (i + 1) * inside // 100000 else 300 for i in range(100000)]
with open("far.tck", "wb") as file:
    file.write(b"mrtrix tracks\ndatatype: Float32LE\nfile: . 100\nEND\n".ljust(100, b"\0"))
    for i, x in enumerate(points):
        file.write(struct.pack("<3f", x, 0, 0) + (struct.pack("<3f", *[float("nan")] * 3) if i % 100 == 99 else b""))
    file.write(struct.pack("<3f", *[float("inf")] * 3))
' "$1"
}

@test "a sample of many points may show that they lie well; otherwise all are counted" {
    "$CONUS" phantom sphere -o phantom
    # rows: points inside, note. 59,000 are above the limit, a half, but no sample can tell that for sure.
    while read -r inside note; do
        far "$inside"
        run -0 --separate-stderr "$CONUS" query phantom/sphere.nii.gz --origin=-90,20,20 --toward=0,-10,10 --angle 20 --streamlines far.tck
        [[ ( -n $note && $stderr == *"bundle far: $note"* ) || ( -z $note && $stderr != *'bundle far'* ) ]]
    done <<'END'
100000
61000
59000
49999 50 % of its points are in the box around the areas: is it in their space?
30000 30 % of its points are in the box around the areas: is it in their space?
1 0.001 % of its points are in the box around the areas: is it in their space?
0 none of 100000 points is in the box around the areas: is it in their space?
END
}

# Three lines along x at z = 0, y = 0, 3 and 40; a cylinder of 5 mm along z holds 10 and 8 mm (3-4-5) of the first two.
lines() {
    conus phantom slabs -o . --size 32
    tck lines.tck -10,0,0 10,0,0 -- -10,3,0 10,3,0 -- -10,40,0 10,40,0
}
TUBE='--origin 0,0,100 --direction 0,0,-1 --radius 5 --layers all --streamlines lines.tck -q'

# bats test_tags=main
@test "what of a bundle is in the cone has columns, a score and a table" {
    lines
    # shellcheck disable=SC2086
    conus query slabs.nii.gz $TUBE --score streamlines --only lines --format tsv >rows.tsv
    [ "$(table_cell streamlines)/$(table_cell streamlines_total)/$(table_cell length_mm)" = 2/3/18 ]
    [ "$(table_cell near_x)/$(table_cell near_y)/$(table_cell near_z)/$(table_cell along)" = 0/0/0/0.5 ]
    [ "$(table_cell score)" = 0.666666667 ]
    # shellcheck disable=SC2086
    answers query slabs.nii.gz $TUBE --format table
    has 'streamlines     length'
    has '2 of 3       18.0'
    conus query slabs.nii.gz --point 0,4,0 --radius 5 --streamlines lines.tck --only lines --format tsv -q >rows.tsv
    [ "$(table_cell streamlines)/$(table_cell distance_mm)/$(table_cell near_y)" = 2/1/3 ]
}

# table_cell: a cell of the first row of rows.tsv.
table_cell() {
    awk -F '\t' -v name="$1" 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i } NR == 2 { print $at[name] }' rows.tsv
}

# bats test_tags=main
@test "the streamlines that come in are a tractogram again" {
    lines
    # shellcheck disable=SC2086
    conus query slabs.nii.gz $TUBE --streamlines-out in.tck -o rows.tsv
    answers info slabs.nii.gz --streamlines in.tck
    has 'streamlines  2 with 4 points, 40 mm long together'
    run -0 "$CONUS" verify rows.tsv
    has identical
    conus query slabs.nii.gz --point 0,40,0 --radius 1 --streamlines lines.tck --streamlines-out one.tck -q >answer
    tck third.tck -10,40,0 10,40,0
    answers info slabs.nii.gz --streamlines one.tck
    has 'streamlines  1 with 2 points'
    tail -c 48 one.tck | cmp - <(tail -c 48 third.tck)
}

@test "a query writes all the files that it has options for, and its sidecar names them" {
    lines
    # shellcheck disable=SC2086
    conus query slabs.nii.gz $TUBE --voxels voxels.tsv --voxels-of all --image image.png \
        --mask mask.nii.gz --segments segments.tsv --clearance near.tsv,within=4 --endpoints ends.tsv --connectivity table.tsv \
        --streamlines-out in.tck -o rows.tsv
    python3 -c '
import json, os
outputs = json.load(open("rows.json"))["Outputs"]
assert len(outputs) == 9 and all(os.path.getsize(o["path"]) == o["bytes"] for o in outputs), outputs
'
    run -0 "$CONUS" verify rows.tsv
    has identical
}

@test "--voxels lists the points of streamlines in the cone" {
    lines
    tck lines.tck -9,0,0 -4,0,0 1,0,0 6,0,0 -- -9,40,0 9,40,0 -- 0,3,0 20,3,0 -- -9,4,0 9,4,0 # the last one crosses
    # shellcheck disable=SC2086
    conus query slabs.nii.gz $TUBE --voxels points.tsv -o rows.tsv
    [ "$(tail -n +2 points.tsv | cut -f 2-8,9- | tr '\t' ' ')" = "\
lines 0 1 n/a -4 0 0 n/a 100.079968 bundle 1
lines 0 2 n/a 1 0 0 n/a 100.005 bundle 1
lines 2 0 n/a 0 3 0 n/a 100.04499 bundle 1" ]
    run -0 "$CONUS" verify rows.tsv
    run -0 "$CONUS" verify points.tsv --sidecar rows.json
    has identical
    conus query slabs.nii.gz --point 0,-3,0 --radius 3.5 --streamlines lines.tck --voxels b.tsv --space lps -q >answer
    [ "$(tail -n +2 b.tsv | cut -f 3,4,6-10 | tr '\t' ' ')" = "\
0 2 -1 0 0 n/a 3.16227766
2 0 0 -3 0 n/a 0" ]
    run -1 "$CONUS" diff points.tsv b.tsv
    has '0 rows the same, 2 changed, 1 removed, 0 added'
    # Areas come first, and their rows do not change; a pathway's are listed beside a bundle's.
    # shellcheck disable=SC2086
    conus query slabs.nii.gz $TUBE --voxels all.tsv --voxels-of all --hide lines >answer
    # shellcheck disable=SC2086
    conus query slabs.nii.gz $TUBE --voxels both.tsv --voxels-of all >answer
    cat all.tsv <(tail -n +2 points.tsv) | cmp - both.tsv
    sphere --size 32
    conus query slabs.nii.gz $AIM --pathway sphere.nii.gz --streamlines lines.tck --voxels v.tsv >answer
    [ "$(tail -n +2 v.tsv | cut -f 11 | uniq)" = pathway ]
    # shellcheck disable=SC2086
    fails 2 '--layers all the points of bundles' query slabs.nii.gz $AIM --streamlines lines.tck --voxels no.tsv
}

@test "where no streamlines can be written, nothing is" {
    lines
    # shellcheck disable=SC2086
    fails 2 'the input lines.tck' query slabs.nii.gz $TUBE --streamlines-out lines.tck
    # shellcheck disable=SC2086
    fails 2 '--streamlines-out' query slabs.nii.gz $TUBE --streamlines-out in.trk
    fails 2 '--streamlines-out: streamlines: there is no bundle' query slabs.nii.gz --point 0,0,0 --radius 5 \
        --streamlines-out in.tck
    # shellcheck disable=SC2086
    fails 2 '--streamlines-out' query slabs.nii.gz $TUBE --streamlines-out in.tck --atlas slabs.nii.gz
    printf 'x\ty\tz\tdx\tdy\tdz\n0\t0\t9\t0\t0\t1\n0\t0\t9\t0\t0\t1\n' >two.tsv
    fails 2 '--streamlines-out shows one pose' query slabs.nii.gz --pose two.tsv --radius 5 --streamlines lines.tck \
        --streamlines-out in.tck
    printf 'x\ty\tz\tdx\tdy\tdz\n0\t0\t9\t0\t0\t0\n' >none.tsv
    run -1 "$CONUS" query slabs.nii.gz --pose none.tsv --radius 5 --streamlines lines.tck --streamlines-out in.tck
    has 'no answer: line 2: direction: 0,0,0'
    [ ! -e in.tck ] && [ ! -e in.trk ]
}

@test "the bundle phantom is as long as its truth says" {
    answers phantom bundle -o .
    nothing_left bundle.tck bundle.json bundle.atlas.json
    answers info bundle.atlas.json --format json
    python3 -c '
import json, math, sys
(found,), truth = json.load(sys.stdin)["tractograms"], json.load(open("bundle.json"))
total = 12 * sum(60 * math.hypot(1, 2 * i * math.sin(math.pi / 60) * (i % 2 == 0)) for i in range(1, 13))
assert math.isclose(truth["length_mm"], total, rel_tol=1e-8), truth
assert math.isclose(found["length_mm"], total, rel_tol=1e-6), found # points are floats
assert (found["streamlines"], found["points"], found["bundles"]) == (144, 144 * 61, ["Bundle"]), found
assert (found["low"][2], found["high"][:1], found["high"][2]) == (-30, [12], 30), found
' <<<"$output"
    fails 2 'bundle: size, spacing, oblique and flip: it has no grid' phantom bundle -o . --size 32
    fails 2 'it has no grid' phantom bundle -o . --flip z
}

@test "a deformation field moves a scene's streamlines, and leaves out what has no place" {
    conus phantom nested -o .
    python3 "$BATS_TEST_DIRNAME/fields.py" spm nested.nii.gz spm.nii.gz 8 # points go 8 mm to the right
    tck two.tck 0,0,0 5,0,0 -- 0,0,0 500,0,0
    echo '{"conus_atlas": 1, "parcellation": "nested.nii.gz", "streamlines": ["two.tck"]}' >scene.atlas.json
    run -0 --separate-stderr "$CONUS" info scene.atlas.json --atlas-transform spm.nii.gz
    has 'streamlines  1 with 2 points, 5 mm long together'
    has 'reaches      x -8 to -3, y 0 to 0, z 0 to 0 mm'
    has 'warped by spm.nii.gz'
    has 'spm.nii.gz: 1 of 2 streamlines are left out, with a point that has no place'
    tck two.tck 500,0,0 501,0,0
    fails 3 'two.tck: no streamline is where the field leads to' info scene.atlas.json --atlas-transform spm.nii.gz
    tck edge.tck 20,0,0 22,0,0 # in the box of 24 mm, and outside of the one that ends at 16 mm
    run -0 --separate-stderr "$CONUS" info nested.nii.gz --streamlines edge.tck --atlas-transform spm.nii.gz
    has 'bundle edge: 0 % of its points are in the box around the areas, 100 % were before these were moved'
    run -0 --separate-stderr "$CONUS" info nested.nii.gz --streamlines edge.tck,moves --atlas-transform spm.nii.gz
    has 'reaches      x 12 to 14, y 0 to 0, z 0 to 0 mm'
    not grep -q 'bundle edge:' <<<"$output"
}
