#!/usr/bin/env bats
# conus info, as a user types it.
load helpers

@test "AAL: format, size, orientation, transform, labels, areas" {
    need_aal
    answers info "$aal"
    has 'format       NIfTI-1, gzip'
    has 'size         181 x 217 x 181 voxels of 1 x 1 x 1 mm'
    has 'orientation  RAS: sform, code 4'
    has 'aal.nii.txt'
    has 'covers       x -90.5 to 90.5, y -125.5 to 91.5, z -71.5 to 109.5 mm'
    has '116 areas (0 without a name, 0 without a shape), 0 pathways'
    grep -qE '^ +area +11 +Frontal_Inf_Oper_L +#[0-9a-f]{6} +8271 +8271$' <<<"$output"
}

@test "TSV has one line per area" {
    need_aal
    answers info "$aal" --format tsv
    [ "${#lines[@]}" -eq 117 ]
    [ "$(cell index 11)/$(cell name 11)/$(cell voxels 11)/$(cell volume_mm3 11)" = 11/Frontal_Inf_Oper_L/8271/8271 ]
    [ "$(cell hemisphere 11)/$(cell parent 11)" = n/a/n/a ]
}

@test "JSON has it all" {
    need_aal
    answers info "$aal" --format json
    has '"conus": "0.1.0"'
    has '"role": "parcellation"'
    has '"dim": ['
    has '"orientation": "RAS"'
    has '"name": "Frontal_Inf_Oper_L"'
    if command -v python3 >/dev/null; then
        python3 -c 'import json, sys; a = json.load(sys.stdin); assert len(a["objects"]) == 116' <<<"$output"
    fi
}

@test "a phantom's voxels and spacing" {
    sphere --size 32 --spacing 2,2,2
    answers info sphere.nii.gz --format tsv
    awk -v v="$(cell voxels 1)" -v mm="$(cell volume_mm3 1)" 'BEGIN { exit !(mm == 8 * v && mm > 30000 && mm < 37000) }'
    [ "$(cell name 1)/$(cell abbreviation 1)" = Sphere/Sph ]
}

@test "--labels replaces the table, and notes are shown" {
    sphere --size 16
    printf '1 My ball\n7 Elsewhere\n' >mine.txt
    answers info sphere.nii.gz --labels mine.txt
    has 'mine.txt'
    has 'My ball'
    has '2 areas (0 without a name, 1 without a shape)'
    rm sphere.tsv sphere.json
    answers info sphere.nii.gz
    has 'Notes'
    has 'no label table found'
    fails 3 'none.txt: cannot open' info sphere.nii.gz --labels none.txt
}

@test "rows and trees leave their notes to stderr" {
    sphere --size 32
    printf '1\tBall\n9\tNowhere\n' >names.txt
    for format in tsv tree; do
        run -0 --separate-stderr "$CONUS" info sphere.nii.gz --labels names.txt --format $format
        check_message 'areas of the label table without a voxel: 1 (9)'
        has Ball
        not grep -q 'without a voxel' <<<"$output"
    done
}

@test "a pipe that closes early is an exit code, and no message" {
    need_aal
    run -3 --separate-stderr bash -c "exec 3> >(:); wait \$!; '$CONUS' info '$aal' --format json >&3"
    [ -z "$stderr" ]
}

# Names may contain ESC, CSI of 8 bits, a line separator, or an override of the direction.
@test "control characters in names of areas and files do not reach the terminal" {
    local odd=$'\x1b]0;t\x07\xc2\x9b31m\xe2\x80\xa8\xe2\x80\xae'
    sphere --size 16
    rm sphere.json
    mv sphere.nii.gz "a$odd.nii.gz"
    printf 'index\tname\n1\tBall%s\n' "${odd#*$'\x07'}" >"a$odd.tsv" # a text with ESC in it is no table
    for arguments in 'info' 'info --format tsv' 'info --format json' 'info --format tree' \
        'query --origin 0,0,90 --toward 0,0,0' 'query --origin 0,0,90 --toward 0,0,0 --format csv' \
        'query --origin 0,0,90 --toward 0,0,0 --format json' 'sweep --origin 0,0,90 --toward 0,0,0' \
        'query --origin 0,0,90'; do
        # shellcheck disable=SC2046,SC2086 # words
        "$CONUS" ${arguments%% *} "a$odd.nii.gz" $(cut -s -d' ' -f 2- <<<"$arguments") >out 2>&1 || true
        [ -s out ]
        if LC_ALL=C grep -q $'\x1b\|\xc2\x9b\|\xe2\x80\xa8\|\xe2\x80\xae' out; then
            echo "$arguments:"
            cat -v out
            return 1
        fi
    done
    "$CONUS" query "a$odd.nii.gz" --origin 0,0,90 --toward 0,0,0 | grep -q 'Ball›31m  '
    fails 3 '31m' info "$odd.nii.gz"
}

# A tetrahedron with corners at 0 and at 100 mm of each axis.
@test "a surface around the areas is told of" {
    sphere --size 16
    printf 'v 0 0 0\nv 100 0 0\nv 0 100 0\nv 0 0 100\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n' >skin.obj
    printf 'v 0 0 0\nv 100 0 0\nv 0 100 0\nf 1 2 3\n' >sheet.obj
    run -0 --separate-stderr "$CONUS" info sphere.nii.gz --context skin.obj --context-opacity 0.5
    has $'Context, a surface\n  file         skin.obj\n  triangles    4, closed\n'
    has $'  reaches      x 0 to 100, y 0 to 100, z 0 to 100 mm\n  opacity      0.5\n'
    run -0 --separate-stderr "$CONUS" info sphere.nii.gz --context skin.obj --context-opacity 1
    has $'\n  opacity      1\n'
    fails 2 '--context-opacity: 0 is out of range, allowed is more than 0 to 1' \
        info sphere.nii.gz --context skin.obj --context-opacity 0
    run -0 --separate-stderr "$CONUS" info sphere.nii.gz --context sheet.obj --context skin.obj --format json
    python3 -c 'import json, sys
a, b = json.load(sys.stdin)["context_surfaces"]
assert (a["path"], a["closed"], a["triangles"], a["opacity"]) == ("sheet.obj", False, 1, 0.25), a
assert (b["path"], b["closed"], b["vertices"], b["high"]) == ("skin.obj", True, 4, [100, 100, 100]), b' <<<"$output"
    printf '1 0 0 500\n0 1 0 0\n0 0 1 0\n0 0 0 1\n' >far.txt
    run -0 --separate-stderr "$CONUS" info sphere.nii.gz --atlas-transform far.txt --context skin.obj
    has '0.0 % of its voxels in the box around the closed surfaces, 0.0 % in the head (in them, and what they enclose)'
    has '0 % of the atlas is in the head of skin.obj: is the transform of another image?'
    has 'x 0 to 100, y 0 to 100, z 0 to 100 mm'
    fails 2 '--context: sphere.nii.gz and sphere.nii.gz are no surfaces, one volume is allowed' \
        info sphere.nii.gz --context sphere.nii.gz --context skin.obj --context sphere.nii.gz
    fails 2 '--context-opacity has no effect: sphere.nii.gz is no surface' \
        info sphere.nii.gz --context sphere.nii.gz --context-opacity 0.5
    fails 2 '--context-opacity has no effect without --context' info sphere.nii.gz --context-opacity 0.5
    fails 2 'skin.obj: a surface does not block rays' query sphere.nii.gz --context skin.obj --context-blocks 1 \
        --origin 0,0,90 --toward 0,0,0
}

# 4 MiB are 4,194,304 bytes.
@test "an atlas XML of more than 4 MiB is no ATLAS, but a table of labels" {
    sphere --size 16
    { echo '<atlas><header><name>a</name><type>Label</type></header><data><label index="1" x="0" y="0" z="0">Ball</label>'
      head -c 4194304 /dev/zero | tr '\0' ' '
      echo '</data></atlas>'; } >large.xml
    fails 3 'allowed are 4194304' info large.xml
    conus info sphere.nii.gz --labels large.xml --format tsv | grep -qP '^area\t1\tBall\t'
}

# sum_of FILE: the sum of the voxels of a NIfTI-1 file of uint8 with a sform, as docs/spaces.md defines it.
sum_of() {
    python3 - "$1" <<'PYTHON'
import gzip, hashlib, struct, sys

raw = open(sys.argv[1], "rb").read()
raw = gzip.decompress(raw) if raw[:2] == b"\x1f\x8b" else raw
dim, kind = struct.unpack_from("<8h", raw, 40)[1:4], struct.unpack_from("<h", raw, 70)[0]
assert (kind, struct.unpack_from("<h", raw, 254)[0] > 0) == (2, True)
first = int(struct.unpack_from("<f", raw, 108)[0])
affine = struct.unpack_from("<12f", raw, 280)
labels = raw[first:first + dim[0] * dim[1] * dim[2]]
whole = struct.pack("<3i", *dim) + struct.pack("<12f", *(a + 0.0 for a in affine)) + b"".join(
    bytes((label, 0, 0, 0)) for label in labels)
print(hashlib.sha256(whole).hexdigest())
PYTHON
}

@test "the sum of voxels is the one of docs/spaces.md, however the file is written" {
    sphere --size 24 --spacing 2,2,2
    answers info sphere.nii.gz
    has "  voxels       $(sum_of sphere.nii.gz)"
    has '  identity     unknown'
    sum=$(sum_of sphere.nii.gz)
    gzip -dc sphere.nii.gz >other.nii
    answers info other.nii --format json
    has "\"voxels\": \"$sum\""
    printf '1 0 0 1\n0 1 0 0\n0 0 1 0\n0 0 0 1\n' >right.txt
    answers info other.nii --atlas-transform right.txt
    [[ "$output" != *"$sum"* ]] # a millimetre to the right
    answers info other.nii --hemispheres split
    [[ "$output" != *identity* ]]
}

@test "mricron-data's atlases are known, a changed one by its names alone" {
    need_aal
    for row in 'aal/AAL, 116 areas, 1 mm, on Colin 27' 'AICHAmc/AICHA, 192 pairs of areas, 2 mm, on MNI 152' \
        'HarvardOxford-cort-maxprob-thr0-1mm/Harvard-Oxford, cortical, largest probability of any size, 1 mm' \
        'JHU-WhiteMatter-labels-1mm/JHU ICBM-DTI-81 white matter, 48 areas, 1 mm' \
        'JHU-WhiteMatter-labels-2mm/JHU ICBM-DTI-81 white matter, 48 areas, 2 mm' \
        'brodmann/Brodmann' 'inia19-NeuroMaps/NeuroMaps on INIA19' 'jhu189/JHU, 189' 'natbrainlab/NatBrainLab'; do
        answers info "$TEMPLATES/${row%%/*}.nii.gz"
        has "  identity     ${row#*/}"
    done
    has '  brain        MNI 152'
    answers info "$TEMPLATES/inia19-NeuroMaps.nii.gz"
    has '  brain        the macaque INIA19, by its voxels'
    printf 'name,x,y,z\na,1,2,3\n' >mni.csv
    fails 3 'positions are in "MNI 152" (by the file'"'s name), the atlas in another space (the macaque INIA19, by its voxels)" \
        query "$TEMPLATES/inia19-NeuroMaps.nii.gz" --pose mni.csv
    conus pack "$TEMPLATES/inia19-NeuroMaps.nii.gz" -o packed.conus -q
    fails 3 'the macaque INIA19, by its voxels' query packed.conus --pose mni.csv --hide r_lateral_septal_nucleus
    gzip -dc "$TEMPLATES/inia19-NeuroMaps.nii.gz" >other.nii
    printf '1 One\n2 Two\n' >two.txt
    answers info other.nii --labels two.txt
    has '  brain        unknown'
    gzip -dc "$aal" >mine.nii
    cp "${aal%.gz}.txt" mine.nii.txt
    answers info mine.nii
    has 'identity     AAL, 116 areas'
    [[ "$output" != *published* ]]
    sed '1s/Precentral_L/Precentral_R/' mine.nii.txt >wrong.txt
    answers info mine.nii --labels wrong.txt
    has 'identity     AAL, 116 areas'
    has 'names        others than those that were published with these voxels'
    python3 -c 'f = open("mine.nii", "r+b"); f.seek(352 + 181 * (217 * 90 + 100) + 60); b = f.read(1); f.seek(-1, 1); f.write(b"\1")'
    answers info mine.nii
    has 'identity     AAL by its labels and names; not verified: its voxels or their place differ'
    answers info mine.nii --format json
    has '"verified": false'
    printf '1 One\n2 Two\n' >two.txt
    answers info mine.nii --labels two.txt
    has 'identity     unknown'
    answers cite "$aal"
    has 'aal: AAL, known by its voxels: N. Tzourio-Mazoyer et al.: '
    conus query "$aal" --origin -60,-20,30 --toward 0,-20,30 --angle 10 -q -o a.tsv
    answers cite a.tsv
    has 'https://doi.org/10.1006/nimg.2001.0978 (file aal.nii.gz'
}
