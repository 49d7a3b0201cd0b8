#!/usr/bin/env bats
# --space ccf and --space bregma: positions of the Allen CCF, given and reported.

load helpers

# ccf.py's files are made once; the tests only read them.
setup_file() {
    (cd "$BATS_FILE_TMPDIR" && python3 "$BATS_TEST_DIRNAME/ccf.py")
}

setup() {
    cd "$BATS_FILE_TMPDIR" || return
}

forms='allen.nrrd ras.nii globe'

# ask: writes the label at each point, and the position reported for it, to the files labels and places.
ask() {
    run -0 --separate-stderr "$CONUS" query "$@" --radius 0.001 --format tsv --quiet
    awk -F '\t' 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i }
                 $at["kind"] == "area" { print $at["index"] > labels
                     print $at["contact_x"], $at["contact_y"], $at["contact_z"] > places }' \
        labels="$BATS_TEST_TMPDIR/labels" places="$BATS_TEST_TMPDIR/places" <<<"$output"
}

@test "a position in CCF is one voxel in each form of the atlas, and comes out as it went in" {
    for form in $forms; do
        ask $form --space ccf --pose points.txt
        diff expected.txt "$BATS_TEST_TMPDIR/labels"
        paste -d ' ' points.txt "$BATS_TEST_TMPDIR/places" | awk '{ for (i = 1; i < 4; i++)
            if (($i - $(i + 3))^2 > 1e-6) { print; bad = 1 } } END { exit bad }'
    done
}

@test "a stack is counted from its first column, whatever side that is called" {
    for sides in asr asl; do
        ask globe/annotation.tiff,resolution=200,orientation=$sides --space ccf --pose points.txt
        diff expected.txt "$BATS_TEST_TMPDIR/labels"
    done
}

@test "NWB: electrodes are points in CCF, of micrometres; what AllenSDK wrote lacks a side" {
    [ -x "${CONUS_HDF5:-${CONUS%/*}/conus-hdf5}" ] || skip 'no conus-hdf5'
    /usr/bin/python3 "$BATS_TEST_DIRNAME/hdf5.py" nwb "$BATS_TEST_TMPDIR/e.nwb" || skip 'no python3-h5py'
    /usr/bin/python3 "$BATS_TEST_DIRNAME/hdf5.py" allensdk "$BATS_TEST_TMPDIR/allen.nwb"
    ask ras.nii --space ccf --pose "$BATS_TEST_TMPDIR/e.nwb"
    diff expected.txt "$BATS_TEST_TMPDIR/labels"
    [ "$(sed -n '2s/\t.*//p' <<<"$output")" = probe-0 ]
    /usr/bin/python3 "$BATS_TEST_DIRNAME/hdf5.py" localized "$BATS_TEST_TMPDIR/places.nwb"
    ask ras.nii --space ccf --pose "$BATS_TEST_TMPDIR/places.nwb"
    diff <(tac expected.txt) "$BATS_TEST_TMPDIR/labels"
    [ "$(sed -n '$s/\t.*//p' <<<"$output")" = probe-0 ]
    fails 3 'e.nwb: electrodes of NWB lie in the CCF or count from bregma: space ccf or bregma is needed' \
        query ras.nii --pose "$BATS_TEST_TMPDIR/e.nwb" --radius 1
    fails 3 'allen.nwb: columns y and z are equal in every row' \
        query ras.nii --space ccf --pose "$BATS_TEST_TMPDIR/allen.nwb" --radius 1 --quiet
    head -c 3000 "$BATS_TEST_TMPDIR/e.nwb" >"$BATS_TEST_TMPDIR/cut.nwb"
    fails 3 'cut.nwb: HDF5: cannot open it' \
        query ras.nii --space ccf --pose "$BATS_TEST_TMPDIR/cut.nwb" --radius 1 --quiet
}

@test "a position from bregma is the same voxel, and --bregma puts it elsewhere" {
    for form in $forms; do
        ask $form --space bregma --pose bregma.txt
        diff expected.txt "$BATS_TEST_TMPDIR/labels"
        paste -d ' ' bregma.txt "$BATS_TEST_TMPDIR/places" | awk '{ for (i = 1; i < 4; i++)
            if (($i - $(i + 3))^2 > 1e-12) { print; bad = 1 } } END { exit bad }'
    done
    # AP 1000, DV 2000, ML 3000 um are voxel 5, 10, 15: 1 + 0 + 11 + 0
    ask ras.nii --space bregma --bregma 1000,2000,3000 --point 0,0,0
    [ "$(cat "$BATS_TEST_TMPDIR/labels")" = 12 ]
}

# BrainGlobe calls the side right on which ML starts, the Allen Institute left.
@test "a contact is in the hemisphere that the space of its position says" {
    local probe="$BATS_TEST_TMPDIR/probe.json"
    printf '%s' '{"specification": "probeinterface", "probes": [{"ndim": 2, "si_units": "um", "contact_positions": [[0, 9]],' \
        '"probe_planar_contour": [[0, 0], [9, 99], [-9, 99]]}]}' >"$probe"
    side() {
        "$CONUS" query "$@" --probe "$probe" --format bep032 -q | sed -n 2p | cut -f 6
    }
    for form in $forms; do
        [ "$(side $form --space ccf --origin 6600,4000,2000 --direction 0,1,0)" = L ]
        [ "$(side $form --space bregma --origin=-1,3,-4 --direction 0,0,-1)" = R ]
    done
    [ "$(side globe --origin=-2,-6.6,-4 --direction 0,0,-1)" = R ]
    [ "$(side globe --origin=-9,-6.6,-4 --direction 0,0,-1)" = L ]
}

# Contacts by closed form in ML, AP, DV (ccf.py): not what any form of the atlas calls right.
@test "a probe of four shanks has the same contacts in each form of the atlas" {
    local form
    contacts() {
        "$CONUS" query "$@" --probe probe.json --format tsv --quiet | awk -F '\t' '
            NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i } $at["kind"] == "area" { print $at["index"] }'
    }
    for form in $forms left.nii plain.nii turned.nii third/atlases/allen_mouse_200um/1_0 \
        globe/annotation.tiff,resolution=200,orientation=as{r,l}; do
        diff contacts.txt <(contacts $form --space bregma --pose devices.tsv)
        diff contacts_30.txt <(contacts $form --space bregma --pose devices.tsv --probe-roll 30)
        diff contacts.txt <(contacts $form --space ccf --pose devices_ccf.tsv)
        diff bare.txt <(contacts $form --space bregma --pose bare.tsv)
    done
}

# plan DIGITS FORM ARGUMENT...: a table with numbers of so many decimals.
plan() {
    "$CONUS" plan "${@:2}" --space bregma --format tsv --quiet | awk -F '\t' -v OFS='\t' -v form="%.$1f" '
        { for (i = 1; i <= NF; i++) if ($i ~ /^-?[0-9.]+(e-?[0-9]+)?$/) $i = sprintf(form, $i) + 0; print }'
}

# Down from DV 500 um: 1.6 mm of the second layer of blocks. The axis is at ML 2800 um in the first column of blocks, the
# second shank at 5300 in the next one; on the other side it would be at 300.
@test "plan: shanks, tilts, turns, errors and tolerances are those of one device in each form of the atlas" {
    local form
    cd "$BATS_TEST_TMPDIR"
    printf 'ap\tml\tdv\tdap\tdml\tddv\tuap\tuml\tudv\n-1\t-2.939\t-0.168\t0\t0\t-1\t1\t0\t0\n' >down.tsv
    printf -- '-1 -2.939 -0.168\n' >from.txt
    printf -- '-1.2 -2.4 -3.1\n' >to.txt
    # AP 6400 um is voxel 32, block 5: 1 + 5 + 11 + 55 in the next column, 1 + 5 + 11 in the first
    local reach='--reach 72,length=0.5,shank=2 --shanks 0,0;2.5,0 --depth 3'
    for form in allen.nrrd ras.nii globe left.nii plain.nii turned.nii third/atlases/allen_mouse_200um/1_0; do
        local atlas=$BATS_FILE_TMPDIR/$form
        "$CONUS" plan "$atlas" --space bregma --poses down.tsv $reach --constraints values.tsv -o list.tsv -q --force
        awk -F '\t' 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i } NR == 2 { exit !(($at["value"] - 1.6)^2 < 1e-12) }
            END { if (NR != 2) exit 1 }' values.tsv
        plan 5 "$atlas" --poses down.tsv $reach --tolerance - >tolerance.now
        plan 5 "$atlas" --from from.txt --toward to.txt --tilt 20,5 --roll 45 $reach --constraints - >tilts.now
        plan 6 "$atlas" --poses down.tsv $reach --jitter entry=0.3,target=0.6 --samples 256 >jitter.now
        for table in tolerance tilts jitter; do
            sed -E 's/\tarea ([0-9]+)/\t\1/' $table.now >$table.plain
            [ -e $table ] || cp $table.plain $table
            diff $table $table.plain
        done
    done
    [ "$(wc -l <tilts)" -gt 5 ]
    [ "$(wc -l <tolerance)" -gt 20 ]
}

@test "a cone from bregma goes down, and the table, the JSON and the sidecar say the space" {
    run -0 --separate-stderr "$CONUS" query ras.nii --space bregma --origin 0,0,2 --direction 0,0,-1 --angle 2 --quiet
    [[ $output == 'cone of 2 degrees from (0.00, 0.00, 2.00) along (0.0000, 0.0000, -1.0000), AP, ML, DV mm from bregma'* ]]
    [[ $output == *'contact AP, ML, DV'* ]]
    [[ $output == *' 60 '* ]] # AP 5400, DV 0, ML 5739: voxel 27, 0, 28
    run -0 --separate-stderr "$CONUS" query ras.nii --space ccf --origin 5400,-1000,5739 --toward 5400,4000,5739 \
        --angle 2 --quiet -o "$BATS_TEST_TMPDIR/answer.tsv"
    sidecar=$(cat "$BATS_TEST_TMPDIR/answer.json")
    python3 - "$BATS_TEST_TMPDIR/answer.json" <<'END'
import json, sys
sidecar = json.load(open(sys.argv[1]))
assert sidecar["Space"]["orientation"] == "CCF" and sidecar["Space"]["axes"] == ["AP", "DV", "ML"], sidecar["Space"]
assert sidecar["contact_x"]["Units"] == "um" and sidecar["distance_mm"]["Units"] == "mm"
END
    # mm stay mm: from 1 mm above the grid to its top
    awk -F '\t' 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i }
                 NR == 2 { exit !(($at["distance_mm"] - 1)^2 < 1e-5 && ($at["contact_y"])^2 < 1e-3) }' \
        "$BATS_TEST_TMPDIR/answer.tsv"
}

@test "batch, sweep, track, overlap and render know the spaces" {
    printf 'name\tap\tdv\tml\ttap\ttdv\ttml\n1\t5400\t-1000\t5739\t5400\t4000\t5739\n' >"$BATS_TEST_TMPDIR/poses.tsv"
    run -0 --separate-stderr "$CONUS" batch ras.nii --poses "$BATS_TEST_TMPDIR/poses.tsv" --space ccf --angle 2 --quiet
    [[ $output == *$'1\tarea\t60\t60\t'* ]]
    run -0 --separate-stderr "$CONUS" sweep ras.nii --pose "$BATS_TEST_TMPDIR/poses.tsv" --space ccf --angles 2,4 \
        --quiet --format tsv
    [[ $output == *$'\tarea\t60\t60\t'* ]]
    printf 'time_s,ap,ml,dv,dap,dml,ddv\n0,0,0,2,0,0,-1\n1,0,0,2,0,0,-1\n' >"$BATS_TEST_TMPDIR/track.csv"
    run -0 --separate-stderr "$CONUS" track ras.nii --poses "$BATS_TEST_TMPDIR/track.csv" --space bregma --angle 2 \
        --quiet --format tsv
    [[ $output == *$'\tarea\t60\t60\t'* ]]
    run -0 --separate-stderr "$CONUS" overlap ras.nii ras.nii --threshold 165 --space ccf --quiet --format tsv
    # label 165 is voxels 60 to 65, 32 to 39, 38 to 56: the first one in the file has the last AP and DV
    awk -F '\t' 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i }
                 NR == 2 { x = $at["peak_x"]; y = $at["peak_y"]; z = $at["peak_z"]
                     exit !(x > 12000 && x < 13200 && y > 6400 && y < 8000 && z > 7600 && z < 11400) }' <<<"$output"
}

@test "the table of what an axis passes is in the space that it says" {
    # 1 mm above DV 0; then layers of 8 voxels of 200 um, 1.6 mm each
    run -0 --separate-stderr "$CONUS" query allen.nrrd --space ccf --origin 5433,-1000,2739 --toward 5433,4000,2739 \
        --segments - --quiet
    [[ ${lines[0]} == 'axis from (5433.0, -1000.0, 2739.0) along (0.0000, 1.0000, 0.0000), AP, DV, ML um in CCF' ]]
    [[ ${lines[1]} == *'enters at AP, DV, ML' && ${lines[2]} == *' mm '*' um' ]]
    [[ ${lines[4]} == *' 1.00 '*' 2.60 '*' 1.60 '*' 5433.0 '*' 0.0 '*' 2739.0' ]]
    run -0 --separate-stderr "$CONUS" query allen.nrrd --space bregma --origin 0,-3,1.332 --toward 0,-3,-1 \
        --segments - --range 0,2 --quiet
    [[ ${lines[0]} == 'axis from (0.00, -3.00, 1.33) along (0.0000, 0.0000, -1.0000), 0 to 2 mm deep, AP, ML, DV mm from bregma' ]]
    [[ ${lines[1]} == *'enters at AP, ML, DV' && ${lines[2]} == *' mm' ]]
}

@test "a mask of an NRRD file lies where the file lies" {
    conus query allen.nrrd --space ccf --origin 5400,-1000,5739 --toward 5400,4000,5739 -q \
        --mask "$BATS_TEST_TMPDIR/mask.nii.gz" >"$BATS_TEST_TMPDIR/answer"
    run -0 --separate-stderr "$CONUS" overlap allen.nrrd "$BATS_TEST_TMPDIR/mask.nii.gz" --format tsv --quiet
    [[ $output == *$'\tarea\t60\t'* && $output != *unassigned* ]]
}

# Area 60 is AP 4800 to 6000, DV 0 to 1600, ML 3800 to 7600 um: it lies on both sides of ML 5700, on which there are
# centres of voxels, which are right.
@test "an area on both sides of the CCF's midline is refused, and cut there: left is where ML is less" {
    local form
    cd "$BATS_TEST_TMPDIR"
    printf '5500 100 4100\n5500 100 5500\n5500 100 5700\n5500 100 7300\n' >cut.txt
    for form in allen.nrrd ras.nii left.nii plain.nii turned.nii; do
        fails 2 'type --hemispheres split, and as the name' query "$BATS_FILE_TMPDIR/$form" --point index:60 --radius 1
        ask "$BATS_FILE_TMPDIR/$form" --space ccf --pose cut.txt --hemispheres split
        diff <(printf '1060\n1060\n2060\n2060\n') labels
        ask "$BATS_FILE_TMPDIR/$form" --space bregma --point -0.1,-1,-0.5 --hemispheres split
        [ "$(cat labels)" = 1060 ]
    done
    "$CONUS" query "$BATS_FILE_TMPDIR/allen.nrrd" --point 5,-5,-1 --radius 1 --hemispheres split -q -o cited.tsv
    [[ $("$CONUS" cite cited.tsv | tr '\n' ' ') == *'cut in two at ML 5700 µm of the Allen CCF.'* ]]
    # x and ML contradict each other
    fails 2 'right; choose one by a point of it; near:' query "$BATS_FILE_TMPDIR/globe" -q --space bregma \
        --origin 0,-1,2 --toward index:60
    fails 3 'a half could be either' query "$BATS_FILE_TMPDIR/globe" --hemispheres split --space bregma --point 0,1,-1 \
        --radius 1
    # a field moves the voxels to another grid, of any size
    python3 "$BATS_TEST_DIRNAME/fields.py" itk <(gzip -c "$BATS_FILE_TMPDIR/plain.nii") field.nii.gz 1
    fails 2 'lies on both sides' query "$BATS_FILE_TMPDIR/plain.nii" --point index:60 --radius 1 \
        --atlas-transform field.nii.gz
}

@test "lists: sides by ML, and positions above bregma have a way on" {
    cd "$BATS_TEST_TMPDIR"
    printf 'name\tap\tdv\tml\nleft a\t5500\t100\t4100\nleft b\t5500\t300\t4100\nright c\t5500\t100\t7300\n' >sides.tsv
    ask "$BATS_FILE_TMPDIR/ras.nii" --space ccf --pose sides.tsv
    sed 's/left/right/' sides.tsv >wrong.tsv
    fails 3 '2 of 3 called right on the left' query "$BATS_FILE_TMPDIR/ras.nii" --space ccf --pose wrong.tsv --radius 1
    printf -- '-1 1 0.2\n-1 2 0.2\n-1 3 0.2\n' >skull.txt
    fails 3 '--space ccf takes them: AP 5400 - 1000 AP, DV 332 - 1000 DV, ML 5739 + 1000 ML, um' \
        query "$BATS_FILE_TMPDIR/ras.nii" --space bregma --pose skull.txt --radius 1
    printf -- '0.14 0.15 -0.1\n-0.35 0.25 -0.06\n-0.21 0.15 -0.13\n' >cm.txt # the grid is 13.2 mm long
    run -0 --separate-stderr "$CONUS" query "$BATS_FILE_TMPDIR/ras.nii" --space bregma --pose cm.txt -q
    [[ $stderr == 'conus: warning: cm.txt: all positions lie within 0.'*' mm of bregma: are they in centimetres? Then type cm.txt,unit=cm; else cm.txt,unit=mm' ]]
    printf '6400 132 6739\n6400 132 7739\n6400 132 8739\n' >ccf.txt
    run -0 "$CONUS" query "$BATS_FILE_TMPDIR/ras.nii" --space ccf --pose ccf.txt --radius 1
}

@test "where ML grows to the left by what the atlas says, a note says so" {
    run -0 --separate-stderr "$CONUS" query globe --space bregma --point 0,0,-1 --radius 0.1
    [[ $stderr == *'note: --space bregma: ML grows to the right, as the Allen Institute counts; the atlas says'* ]]
    run -0 --separate-stderr "$CONUS" query allen.nrrd --space bregma --point 0,0,-1 --radius 0.1
    [[ $stderr != *'ML grows to the right'* ]]
}

@test "info says where the CCF lies" {
    run -0 "$CONUS" info allen.nrrd
    [[ $output == *'bregma       x 5.739, y -5.4, z -0.332 mm: AP 5400, DV 332, ML 5739 um'* ]]
    [[ $output == *'ML grows     to the right'* ]]
    run -0 "$CONUS" info globe
    [[ $output == *'bregma       x -5.739, y -5.4, z -0.332 mm'* ]]
    [[ $output == *'ML grows     to the left'* ]]
}

@test "a manifest says that surfaces are of the CCF" {
    local folder=$BATS_TEST_TMPDIR
    conus phantom nested -o "$folder"
    printf '{"conus_atlas": 1, "parcellation": "nested.nii.gz", "ccf": "asl"}' >"$folder/said.atlas.json"
    run -0 --separate-stderr "$CONUS" query "$folder/said.atlas.json" --space ccf --point 1000,2000,3000 --radius 1 \
        --format json --quiet
    [[ $output == *'"CCF"'* ]]
    printf '{"conus_atlas": 1, "parcellation": "nested.nii.gz", "ccf": "ras"}' >"$folder/bad.atlas.json"
    fails 3 'ccf: found "ras", "asr" or "asl" is needed' info "$folder/bad.atlas.json"
    cp ras.nii "$folder"
    printf '{"conus_atlas": 1, "parcellation": "ras.nii", "ccf": "asl"}' >"$folder/two.atlas.json"
    fails 3 "ccf: the volume's grid is the CCF's already" info "$folder/two.atlas.json"
}

@test "the CCF goes along with an atlas that an affine moves, and a note says so" {
    # a matrix from the space of the poses to the atlas's: half as large, and shifted
    printf '0.5 0 0 3\n0 0.5 0 4\n0 0 0.5 5\n0 0 0 1\n' >"$BATS_TEST_TMPDIR/half.txt"
    run -0 --separate-stderr "$CONUS" query ras.nii --space ccf --point 5433,341,5761 --radius 0.001 --format tsv \
        --atlas-transform "$BATS_TEST_TMPDIR/half.txt"
    [[ $output == *$'\tarea\t60\t'* ]] # voxel 27, 1, 28: 1 + 4 + 0 + 55
    [[ $stderr == *'note: --space ccf: the atlas was moved, and the CCF with it'* ]]
    run -0 --separate-stderr "$CONUS" query ras.nii --space ccf --point 5433,341,5761 --radius 0.001
    [[ $stderr != *'was moved'* ]]
    python3 "$BATS_TEST_DIRNAME/fields.py" itk <(gzip -c ras.nii) "$BATS_TEST_TMPDIR/field.nii.gz" 1
    conus phantom nested -o "$BATS_TEST_TMPDIR"
    python3 "$BATS_TEST_DIRNAME/fields.py" itk "$BATS_TEST_TMPDIR/nested.nii.gz" "$BATS_TEST_TMPDIR/other.nii.gz" 1
    for field in field other; do # on the grid of the CCF, and on another one
        fails 3 'a deformation field moved it' query ras.nii --space ccf --point 5433,341,5761 --radius 1 \
            --atlas-transform "$BATS_TEST_TMPDIR/$field.nii.gz"
    done
}

@test "frames and units that cannot be right are refused" {
    printf 'ap\tdv\tml\ttap\ttdv\ttml\n5400\t-1000\t5739\t5400\t4000\t5739\n' >"$BATS_TEST_TMPDIR/mouse.tsv"
    fails 3 'from bregma (mm) or in the CCF (um) they need an atlas of the Allen CCF' query ras.nii --pose "$BATS_TEST_TMPDIR/mouse.tsv"
    conus phantom nested -o "$BATS_TEST_TMPDIR"
    fails 3 'not known to be the Allen CCF' query "$BATS_TEST_TMPDIR/nested.nii.gz" --space ccf --point 1,2,300 --radius 1
    fails 3 'positions there are in mm, not micrometres' query ras.nii --space bregma --point -3400,2000,-2500 --radius 1
    fails 3 'positions there are in micrometres, not mm' query ras.nii --space ccf --point 5.4,2.3,5.7 --radius 1
    printf 'name,ap,dv,ml\na,27,4,38\nb,27,5,38\nc,27,6,38\n' >"$BATS_TEST_TMPDIR/voxels.csv"
    fails 3 'are they voxels? space ccf is in micrometres' query ras.nii --space ccf --pose "$BATS_TEST_TMPDIR/voxels.csv"
    run -0 --separate-stderr "$CONUS" query ras.nii --space ccf --pose "$BATS_TEST_TMPDIR/voxels.csv,unit=um"
    run -0 --separate-stderr "$CONUS" query ras.nii --space bregma --point 0,2,0.5 -q
    [[ $stderr == *'warning: the point lies outside of the atlas'*'; DV is up from bregma, so that depths are negative' ]]
    run -0 --separate-stderr "$CONUS" query ras.nii --space bregma --point 0,2,-0.5 -q
    [ -z "$stderr" ]
    run -0 --separate-stderr "$CONUS" query ras.nii --point 5400,2300,5700 -q
    [[ $stderr == *'warning: '*'; --space ccf takes AP,DV,ML in micrometres, --space bregma AP,ML,DV in mm' ]]
    fails 3 'positions there are in mm' query ras.nii --space bregma --origin 0,0,2 --toward 0,0,-4000
    fails 2 '--bregma has no effect without --space bregma' query ras.nii --bregma 1,2,3 --point 1,2,3 --radius 1
    fails 2 '--bregma: 0,0,0 is the corner' query ras.nii --space bregma --bregma 0,0,0 --point 1,2,3 --radius 1
    fails 3 'bregma: found ML 20000 um, allowed is 0 to 11400' query ras.nii --space bregma --bregma 5400,332,20000 \
        --point 1,2,3 --radius 1
    fails 3 'the CCF lies elsewhere in atlas' query ras.nii --atlas allen.nrrd --space ccf --point 5400,2000,5739 \
        --radius 1
    printf 'x,y,z,qw,qx,qy,qz\n5400,0,5700,1,0,0,0\n' >"$BATS_TEST_TMPDIR/turned.csv"
    fails 3 'rotations (qw qx qy qz or m00...m33) are not read in space ccf' query ras.nii --space ccf \
        --pose "$BATS_TEST_TMPDIR/turned.csv"
    run -0 --separate-stderr "$CONUS" query ras.nii --space bregma --origin 0,2,-2 --toward 0,2,-1 --angle 3
    [[ $stderr == *'the device lies inside'* ]]
    run -0 --separate-stderr "$CONUS" query ras.nii --space bregma --origin 20,2,-2 --direction 1,0,0 --angle 3
    [[ $stderr == *'points away from the atlas'* ]]
    [[ $stderr != *'counted downward'* ]]
    # read so, it begins at AP 5400, DV 832, ML 7739 um, voxel 27, 4, 38: 1 + 4 + 0 + 110
    run -0 --separate-stderr "$CONUS" query ras.nii --space bregma --origin 0,2,0.5 --toward 0,2,3 --angle 3
    [[ $stderr == *'points away from the atlas; with DV counted downward it would hit 115 first'* ]]
}

@test "files of the International Brain Laboratory are points from bregma" {
    # ML -1639, AP -100, DV -468: CCF AP 5500, DV 800, ML 4100 um, which is voxel 27, 4, 20: 1 + 4 + 0 + 55
    printf '{"xyz_picks": [[-1639, -100, -468], [-1639, -100, -1768]]}' >"$BATS_TEST_TMPDIR/xyz_picks.json"
    for space in ccf bregma; do
        ask ras.nii --pose "$BATS_TEST_TMPDIR/xyz_picks.json" --space $space
        [ "$(cat "$BATS_TEST_TMPDIR/labels")" = $'60\n71' ]
    done
    fails 3 'only an atlas of the Allen CCF can place: space ccf or bregma is needed' query ras.nii \
        --pose "$BATS_TEST_TMPDIR/xyz_picks.json" --radius 1
    printf '{"xyz_picks": [[-1.639, -0.1, -0.468]]}' >"$BATS_TEST_TMPDIR/mm.json"
    fails 3 'micrometres are needed, not mm or m' query ras.nii --pose "$BATS_TEST_TMPDIR/mm.json" --radius 1 --space ccf
}

@test "ML without signs beside a column of sides is refused in words of ML" {
    printf 'site,side,AP,ML,DV\nM2,L,1.2,1.5,-.8\nS1,L,-1.1,3,-.6\nV1,R,-3.5,2.5,-.5\n' >"$BATS_TEST_TMPDIR/sites.csv"
    fails 3 'ML is to the right: where it has no signs, put a minus before those of the left' \
        query ras.nii --space bregma --pose "$BATS_TEST_TMPDIR/sites.csv"
}
