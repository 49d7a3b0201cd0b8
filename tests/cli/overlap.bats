#!/usr/bin/env bats
# conus overlap: the areas that regions of interest cover.

load helpers

# An atlas, and the mask of the voxels in a cone into it.
scene() {
    conus phantom nested -o .
    conus query --force nested.nii.gz --origin 0,-100,0 --toward 0,0,10 --angle 20 --layers all --mask cone.nii.gz \
        -o query.tsv
}

@test "the mask of a cone covers what the cone's census counts" {
    scene
    answers overlap nested.nii.gz cone.nii.gz --format tsv
    has $'query\tkind\tindex\tname\tabbreviation\trank\tvolume_mm3\tfraction\tregion_fraction\tpeak\tpeak_x\tpeak_y\tpeak_z'
    for label in 1 300 4000000001; do
        wanted=$(awk -F'\t' -v label=$label 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i }
            $at["index"] == label { print $at["volume_mm3"], $at["fraction"] }' query.tsv)
        [ "$(awk -F'\t' -v label=$label '$3 == label { print $7, $8 }' <<<"$output")" = "$wanted" ]
    done
    awk -F'\t' 'NR > 1 { sum += $9 } END { exit (sum - 1) ^ 2 > 1e-12 }' <<<"$output"
}

@test "several regions are answered one after the other, and the sidecar names them" {
    scene
    answers overlap nested.nii.gz cone.nii.gz cone.nii.gz -o both.tsv
    [ "$(grep -c ^cone both.tsv)" -eq $(($(grep -c area both.tsv))) ]
    [ "$(wc -l <both.tsv)" -eq 7 ]
    [ "$(jq -r '.Queries | length' both.json)" -eq 2 ]
    [ "$(jq -r '.Queries[0].sha256' both.json)" = "$(sha256sum cone.nii.gz | cut -d ' ' -f 1)" ]
    [ "$(jq -r '.Queries[0].threshold' both.json)" = null ]
    [ "$(jq -r '.Settings | has("engine")' both.json)" = false ]
    answers overlap nested.nii.gz cone.nii.gz --threshold 1 --format json
    [ "$(jq -r '.Queries[0].threshold == 1' <<<"$output")" = true ]
    [ "$(jq -r '.Rows | length' <<<"$output")" -eq 3 ]
}

@test "spaces, hidden areas and levels hold" {
    scene
    answers overlap nested.nii.gz cone.nii.gz --format tsv
    y=$(cell peak_y 1)
    core=$(cell volume_mm3 3)
    answers overlap nested.nii.gz cone.nii.gz --format tsv --space lps
    [ "$(cell peak_y 1)" = "-$y" ]
    answers overlap nested.nii.gz cone.nii.gz --format tsv --hide Core
    [ "$(cell kind 3)" = unassigned ]
    [ "$(cell volume_mm3 3)" = "$core" ]
    [ "$(cell rank 3)" = n/a ]
    fails 2 "no area tree" overlap nested.nii.gz cone.nii.gz --level 1
}

@test "several atlases answer as each does by itself" {
    scene
    conus phantom slabs -o .
    answers overlap nested.nii.gz cone.nii.gz cone.nii.gz --atlas slabs.nii.gz --format tsv
    cp <(printf '%s\n' "$output") both.tsv
    for atlas in nested slabs; do
        conus overlap $atlas.nii.gz cone.nii.gz cone.nii.gz --format tsv >one.tsv
        diff one.tsv <(awk -F'\t' -v atlas=$atlas 'NR == 1 || $2 == atlas' both.tsv | cut -f 1,3-)
    done
    [ "$(cut -f 2 both.tsv | uniq | tr '\n' ' ')" = "atlas nested slabs nested slabs " ]
    answers overlap nested.nii.gz cone.nii.gz --atlas slabs.nii.gz
    has "atlas slabs"
}

@test "a region that covers nothing is said" {
    scene
    conus query nested.nii.gz --origin 0,-100,20 --direction 0,1,0 --radius 1 --layers all --mask rim.nii.gz -o along.tsv
    run -0 --separate-stderr "$CONUS" overlap nested.nii.gz rim.nii.gz --only Core --format tsv
    check_message "rim.nii.gz: covers no area and no pathway"
    run --separate-stderr "$CONUS" overlap nested.nii.gz rim.nii.gz --only Core --format tsv --quiet
    [ -z "$stderr" ]
    [ "${#lines[@]}" -eq 2 ]
    [ "$(cell region_fraction 1)" = 1 ]
}

# The phantom's header says scanner, on no grid that is known: on a template it is refused, as a coil is.
@test "a region of somebody's own scan on a template's atlas is refused" {
    scene
    run -0 --separate-stderr "$CONUS" overlap nested.nii.gz,template=mni152 cone.nii.gz -q --format tsv
    [ -z "$stderr" ] # the same space: nothing is known to differ
    /usr/bin/python3 - <<'EOF'
import gzip, struct
data = bytearray(gzip.open("nested.nii.gz").read())
struct.pack_into("<hh", data, 252, 4, 4)
gzip.open("mni.nii.gz", "wb").write(data)
EOF
    fails 3 'cone.nii.gz: is of another brain (sform, code 1 (scanner)) than the atlas (' overlap mni.nii.gz cone.nii.gz
    run -0 --separate-stderr "$CONUS" overlap mni.nii.gz cone.nii.gz --any-space -q --format tsv -o any.tsv
    [ -z "$stderr" ]
    conus verify any.tsv
}

@test "a bundle has no row, and that is said" {
    scene
    python3 "$BATS_TEST_DIRNAME/tck.py" line.tck 0,-90,0 0,90,0
    run -0 --separate-stderr "$CONUS" overlap nested.nii.gz cone.nii.gz --streamlines line.tck --format tsv
    [ "$(grep -c bundle <<<"$output" || true)" -eq 0 ]
    check_message "line: a bundle has no inside, and no row; a map of where its streamlines are has one, as --pathway"
    run -0 --separate-stderr "$CONUS" overlap nested.nii.gz cone.nii.gz --streamlines line.tck --hide line --format tsv
    [[ "$stderr" != *"no row"* ]]
}

# Voxels of 2.7e-5 mm^3.
@test "volumes below 0.1 mm^3 have digits" {
    conus phantom nested --size 16 --spacing 0.03,0.03,0.03 -o .
    conus overlap nested.nii.gz nested.nii.gz --threshold 300 -q --format tsv >small.tsv
    answers overlap nested.nii.gz nested.nii.gz --threshold 300 -q
    for volume in $(awk -F'\t' '$2 == "area" { printf "%.3g ", $7 }' small.tsv); do
        [[ "$volume" == 0.0* ]]
        has " $volume "
    done
    answers query nested.nii.gz --point=0,0,0 --radius 0.06
    has " $(conus query nested.nii.gz --point=0,0,0 --radius 0.06 --format tsv | awk -F'\t' 'NR == 1 {
        for (i = 1; i <= NF; i++) at[$i] = i } NR == 2 { printf "%.3g", $at["volume_mm3"] }') "
}

# 60 voxels of 0.00001 to 0.0006, of which 31 have 0.0003 and more, and 40 even ones. Maps of probabilities have few in
# some tenth from 0.1 to 0.9.
@test "a map of p values at a p takes the large ones, and a warning says so" {
    conus phantom nested -o .
    map() { # VALUES
        printf '%s\n' NRRD0004 'type: float' 'dimension: 3' 'sizes: 8 1 1' 'space: RAS' \
            'space directions: (1,0,0) (0,1,0) (0,0,1)' 'space origin: (0,0,0)' 'encoding: text' '' "$1" >map.nrrd
        sed -i "s/sizes: 8/sizes: $(wc -w <<<"$1")/" map.nrrd
    }
    map "$(awk 'BEGIN { for (i = 0; i < 100; i++) printf "%g ", i < 40 ? (i + 0.5) / 40 : (i - 39) * 1e-5 }')"
    run -0 --separate-stderr "$CONUS" overlap nested.nii.gz map.nrrd --threshold 0.0003
    [[ "$stderr" == *"map.nrrd: the region is 71 % of the voxels that are not 0, and all values are from 0 to 1: of a map of p values it has \
the large ones; such a map is asked as 1 - p, or as its z values"* ]]
    run -0 --separate-stderr "$CONUS" overlap nested.nii.gz map.nrrd --threshold 0.0003 -q
    [[ "$stderr" == 'conus: warning: '*'of a map of p values'* ]]
    answers overlap nested.nii.gz map.nrrd --threshold 0.6
    map '0 0.01 0.06 0.07 0.1 0.15 0.2 0.2 0.3 0.6 0' # a tract's
    answers overlap nested.nii.gz map.nrrd --threshold 0.05
    map '0 0.0005 0.2 0.3 0.5 0.7 2.25 0' # no p
    answers overlap nested.nii.gz map.nrrd --threshold 0.001
    map '0 1 1 1 1 1 1 0' # a mask
    answers overlap nested.nii.gz map.nrrd --threshold 0.05
    even=$(awk 'BEGIN { for (i = 0; i < 40; i++) printf "%g ", (i + 0.5) / 40 }') # as p is without an effect
    map "$even"
    run -0 --separate-stderr "$CONUS" overlap nested.nii.gz map.nrrd --threshold 0.25
    [[ "$stderr" == *"map.nrrd: the region is 75 % of the voxels"*"of a map of p values it has the large ones"* ]]
    answers overlap nested.nii.gz map.nrrd --threshold 0.6 # 1 - p is asked so
    map "$(awk 'BEGIN { for (i = 0; i < 40; i++) printf "%g ", i < 30 ? 0.9 + i / 300 : (i - 30) / 40 + 0.01 }')" # a tissue's
    answers overlap nested.nii.gz map.nrrd --threshold 0.25
    map '0 0.0001 0.0002 0.0003 0.0004 0.02 0.0499 0 0' # cut at 0.05: at 0.01 a third are the large ones
    run -0 --separate-stderr "$CONUS" overlap nested.nii.gz map.nrrd --threshold 0.01
    [[ "$stderr" == *"map.nrrd: the region is 33.3 % of the voxels"*"of a map of p values it has the large ones"* ]]
    map '0 0.0001 0.0049 0.996 0.999 0 0 0' # of both tails, at 0.005
    run -0 --separate-stderr "$CONUS" overlap nested.nii.gz map.nrrd --threshold 0.99
    [[ "$stderr" == *"map.nrrd: the region is 50 % of the voxels"* ]]
    map "0.001 0.02 0.0499 $(awk 'BEGIN { for (i = 0; i < 400; i++) printf "1 " }')" # cut at 0.05, 1 elsewhere
    run -0 --separate-stderr "$CONUS" overlap nested.nii.gz map.nrrd --threshold 0.25
    [[ "$stderr" == *"map.nrrd: the region is 99.3 % of the voxels"* ]]
    map '0 0.95 0.96 0.99 0.999 0 0 0' # 1 - p, cut: the large ones are meant
    answers overlap nested.nii.gz map.nrrd --threshold 0.95
    map '0 0.0001 0.01 0.03 0.08 0 0 0' # small values that end at no p
    answers overlap nested.nii.gz map.nrrd --threshold 0.05
    map "$(awk 'BEGIN { for (i = 0; i < 300; i++) printf "%g ", 0.001 * exp(-i / 10) }')" # a field: 2 near its largest
    answers overlap nested.nii.gz map.nrrd --threshold 0.0005
}

# Of 4 voxels with values beyond 3 two are in the region.
@test "values of the other sign are noted, and a p as a threshold has its z" {
    conus phantom nested -o .
    printf '%s\n' NRRD0004 'type: float' 'dimension: 3' 'sizes: 6 1 1' 'space: RAS' \
        'space directions: (1,0,0) (0,1,0) (0,0,1)' 'space origin: (0,0,0)' 'encoding: text' '' '1 4 5 -3 -6 -1' >z.nrrd
    run -0 --separate-stderr "$CONUS" overlap nested.nii.gz z.nrrd --threshold 3
    [[ "$stderr" == *"note: 2 voxels have values of -3 and less, and are not in the region: a threshold of -3 takes them"* ]]
    run -0 --separate-stderr "$CONUS" overlap nested.nii.gz z.nrrd --threshold 7.5e-1 -q
    [ -z "$stderr" ]
    run -0 --separate-stderr "$CONUS" overlap nested.nii.gz z.nrrd --threshold -3
    [[ "$stderr" != *"are not in the region"* ]]
    fails 2 '"p<0.001" is not a number; for a one-sided p of 0.05, 0.01 or 0.001 type 1.64, 2.33 or 3.09' \
        overlap nested.nii.gz z.nrrd --threshold 'p<0.001'
    printf '0 0.2 0.9 1 1 0.1' >values
    sed "\$s/.*/$(cat values)/" z.nrrd >mask.nrrd
    fails 2 'and is no mask, or was resampled (then take 0.5): a threshold is needed' overlap nested.nii.gz mask.nrrd
}

@test "labels that a threshold makes one region are noted" {
    conus phantom nested -o .
    map() { # VALUES OF SIX VOXELS, which are 0 elsewhere
        printf '%s\n' NRRD0004 'type: float' 'dimension: 3' 'sizes: 6 1 1' 'space: RAS' 'encoding: text' \
            'space directions: (1,0,0) (0,1,0) (0,0,1)' 'space origin: (0,0,0)' '' "$1" >labels.nrrd
    }
    map '1 1 2 2 0 0'
    run -0 "$CONUS" overlap nested.nii.gz labels.nrrd --threshold 1
    has 'note: all values are whole numbers, 1 to 2, and those of 1 and more are one region'
    for values in '1 1 1 1 0 0' '1 1.5 2 2 0 0' '1 1 2 2 -1 0'; do # a mask, a field, and what has a sign
        map "$values"
        run -0 "$CONUS" overlap nested.nii.gz labels.nrrd --threshold 0.5
        [[ "$output" != *'whole numbers'* ]]
    done
    map '1 1 2 2 0 0'
    run -0 "$CONUS" overlap nested.nii.gz labels.nrrd --threshold 2 # one label
    [[ "$output" != *'whole numbers'* ]]
}

# 64,000 of 125,000 voxels are half of the grid, all of them are no mask of a lesion's.
@test "a region of nearly the whole grid, and a fraction of per cents, are warned of" {
    conus phantom nested -o .
    image() { # VALUE OF THE FIRST VOXELS, THEIR NUMBER
        printf '%s\n' NRRD0004 'type: uint8' 'dimension: 3' 'sizes: 50 50 50' 'space: RAS' 'encoding: raw' \
            'space directions: (1,0,0) (0,1,0) (0,0,1)' 'space origin: (-25,-25,-25)' '' >image.nrrd
        { head -c "$2" /dev/zero | tr '\0' "\\$1" && head -c "$((125000 - $2))" /dev/zero; } >>image.nrrd
    }
    image 001 124000
    run -0 --separate-stderr "$CONUS" overlap nested.nii.gz image.nrrd -q
    [[ "$stderr" == *"image.nrrd: the region is 99.2 % of the whole grid: is a mask inverted, or a map of p values meant?"* ]]
    image 001 64000
    run -0 --separate-stderr "$CONUS" overlap nested.nii.gz image.nrrd
    [[ "$stderr" != *'whole grid'* ]]
    image 144 1000 # 100
    run -0 --separate-stderr "$CONUS" overlap nested.nii.gz image.nrrd --threshold 0.5 -q
    [[ "$stderr" == *'image.nrrd: values from 0 to 100, and a threshold of 0.5: if the values are per cent, that is 0.5 %'* ]]
    run -0 --separate-stderr "$CONUS" query nested.nii.gz --point 0,0,0 --pathway image.nrrd,threshold=0.5 -q
    [[ "$stderr" == *'image.nrrd: values from 0 to 100, and a threshold of 0.5'* ]]
    for threshold in 50 2; do
        run -0 --separate-stderr "$CONUS" overlap nested.nii.gz image.nrrd --threshold "$threshold"
        [[ "$stderr" != *'per cent'* ]]
    done
}

# Published maps of probabilities have a tail, or most at both ends.
@test "a pathway of a map of p values is warned of" {
    conus phantom nested -o .
    map() { # VALUES
        printf '%s\n' NRRD0004 'type: float' 'dimension: 3' 'sizes: 8 1 1' 'space: RAS' \
            'space directions: (1,0,0) (0,1,0) (0,0,1)' 'space origin: (0,0,0)' 'encoding: text' '' "$1" >map.nrrd
        sed -i "s/sizes: 8/sizes: $(wc -w <<<"$1")/" map.nrrd
    }
    map "0 $(awk 'BEGIN { for (i = 0; i < 40; i++) printf "%g ", (i + 0.5) / 40 }')"
    for words in '' ,threshold=0.05; do
        run -0 --separate-stderr "$CONUS" query nested.nii.gz --point 0,0,0 --pathway "map.nrrd$words" -q
        [[ "$stderr" == *"map.nrrd: the pathway is "*"of a map of p values it has the large ones"* ]]
    done
    run -0 --separate-stderr "$CONUS" query nested.nii.gz --point 0,0,0 --pathway map.nrrd,threshold=0.6 -q
    [ -z "$stderr" ]
    run -0 --separate-stderr "$CONUS" query nested.nii.gz --point 0,0,0 --pathway map.nrrd,unit=probability -q
    [ -z "$stderr" ]
    map "0 0.0002 0.0003 0.0004 0.02 0.0499"
    run -0 --separate-stderr "$CONUS" query nested.nii.gz --point 0,0,0 --pathway map.nrrd,threshold=0.01 -q
    [[ "$stderr" == *"map.nrrd: the pathway is 40 % of the voxels"* ]]
    map "0 $(awk 'BEGIN { for (i = 1; i <= 200; i++) printf "%g ", (i / 200) ^ 3 }')" # a probability's tail
    run -0 --separate-stderr "$CONUS" query nested.nii.gz --point 0,0,0 --pathway map.nrrd,threshold=0.05 -q
    [ -z "$stderr" ]
    map "0 $(awk 'BEGIN { split("23 19 11 7 6 6 6 5 6 10", n); # the callosal body of Juelich'"'"'s pathways
        for (t = 1; t <= 10; t++) for (i = 0; i < n[t]; i++) printf "%g ", (t - 1 + (i + 0.5) / n[t]) / 10 }')"
    run -0 --separate-stderr "$CONUS" query nested.nii.gz --point 0,0,0 --pathway map.nrrd -q
    [ -z "$stderr" ]
}

@test "a message says where atlas and region have changed places" {
    scene
    fails 2 "no mask: a threshold is needed, from which on a voxel belongs to the region (below 0: down from which); \
nested.nii.gz is an atlas: ATLAS comes first, then ROI" overlap cone.nii.gz nested.nii.gz
    printf '%s\n' NRRD0004 'type: float' 'dimension: 3' 'sizes: 2 1 1' 'space: RAS' \
        'space directions: (1,0,0) (0,1,0) (0,0,1)' 'space origin: (0,0,0)' 'encoding: text' '' '0.5 2.25' >map.nrrd
    fails 3 "selects what is bright in it, 'conus overlap ATLAS MAP' lists the areas under a map; \
nested.nii.gz is an atlas: ATLAS comes first, then ROI" overlap map.nrrd nested.nii.gz --threshold 1
    fails 2 "is needed, from which on a voxel belongs to the region (below 0: down from which): --threshold T" \
        overlap nested.nii.gz map.nrrd
    [[ "$stderr" != *"comes first"* ]]
    fails 3 "found 0.5" overlap map.nrrd cone.nii.gz
    [[ "$stderr" != *"comes first"* ]]
    fails 2 ": --threshold T; if these are labels, save the one that is meant as a mask (the largest as T is taken alone); if it is an atlas, --atlas nested.nii.gz lists" overlap nested.nii.gz nested.nii.gz
    fails 3 "cannot open" overlap cone.nii.gz nothing.nii.gz
    [[ "$stderr" != *"comes first"* ]]
}

@test "files that are no regions, and overwriting, are refused" {
    scene
    fails 3 "cannot open" overlap nested.nii.gz nothing.nii.gz
    [ ! -e /usr/share/mricron/templates/aal.nii.gz ] || fails 3 "; aal is an atlas, and no region: ROI is a mask or a map" overlap nested.nii.gz aal
    fails 2 "is no mask: a threshold is needed" overlap cone.nii.gz nested.nii.gz
    fails 2 "threshold 5000000000, but its values are from 0 to 4000000001" \
        overlap cone.nii.gz nested.nii.gz --threshold 5e9
    fails 2 "would take the whole volume" overlap nested.nii.gz cone.nii.gz --threshold 0
    fails 2 "would overwrite the input cone.nii.gz" overlap nested.nii.gz cone.nii.gz --format tsv -o cone.nii.gz --force
    fails 2 "would overwrite the input" overlap nested.nii.gz cone.nii.gz --format tsv -o nested.nii.gz
    fails 2 "ROI is missing" overlap nested.nii.gz
    fails 3 "is a folder" overlap nested.nii.gz .
}

@test "a field of SimNIBS: tetrahedra by volume, of tissues; what is not in it is said" {
    [ -x "${CONUS_HDF5:-${CONUS%/*}/conus-hdf5}" ] || skip 'no conus-hdf5'
    local make=(/usr/bin/python3 "$BATS_TEST_DIRNAME/hdf5.py")
    "${make[@]}" field field.hdf5 || skip 'no python3-h5py'
    scene
    answers overlap nested.nii.gz field.hdf5 --threshold 1 -q -o field.tsv
    jq -e '.Queries[0] | [.tetrahedra, .volume_mm3, .threshold] == [2, 108, 1]' field.json
    [ "$(jq -r '.Queries[0].sha256' field.json)" = "$(sha256sum field.hdf5 | cut -d ' ' -f 1)" ]
    awk -F'\t' 'NR > 1 { sum += $7 } END { exit (sum - 108) ^ 2 > 1e-9 }' field.tsv
    answers cite field.tsv
    has 'A region consisted of the tetrahedra with values of at least 1. Volumes are exact for the'
    answers verify field.tsv
    run -0 --separate-stderr "$CONUS" overlap nested.nii.gz field.hdf5 --threshold 1 --format tsv
    check_message 'field.hdf5: length of E of tetrahedra of all tissues: tag1 2, 1; ",tissue=1:2" takes white'
    answers overlap nested.nii.gz field.hdf5,tissue=2,field=J --threshold 10 -q --format json
    jq -e '.Queries[0] | [.tetrahedra, .volume_mm3] == [1, 36]' <<<"$output"
    answers overlap nested.nii.gz field.hdf5 --threshold 1.5 -q
    has 'region field.hdf5: values of 1.5 and more, 72.0 mm^3'
    fails 2 'field.hdf5: field: no magnJ of elements (elmdata); there are E, J' \
        overlap nested.nii.gz field.hdf5,field=magnJ --threshold 1
    fails 2 'field.hdf5: tissue: no tetrahedron has it (tag1); there are 2, 1' \
        overlap nested.nii.gz field.hdf5,tissue=5 --threshold 1
    fails 2 'tissue: found "GM", allowed are up to 16 whole numbers from 0, as in 1:2' \
        overlap nested.nii.gz field.hdf5,tissue=GM --threshold 1
    local key
    for key in map=x orientation=asr volume=7 level=3 resolution=3; do
        fails 2 "field.hdf5: ${key%=*} is " overlap nested.nii.gz "field.hdf5,$key" --threshold 1
    done
    fails 2 'field.hdf5: has values from 1 to 2 and is no mask: a threshold is needed, from which on a tetrahedron' \
        overlap nested.nii.gz field.hdf5 -q
    fails 2 'cone.nii.gz: tissue is for results of SimNIBS (.hdf5) as a region of interest, this file has none' \
        overlap nested.nii.gz cone.nii.gz,tissue=1
    "${make[@]}" minc mask.mnc # HDF5, too, and a volume
    answers overlap nested.nii.gz mask.mnc --threshold 2 -q --format json
    jq -e '.Queries[0] | [.tetrahedra, .volume_mm3] == [null, 1000]' <<<"$output"
    starts_once overlap nested.nii.gz mask.mnc --threshold 2
    head -c 5000 field.hdf5 >cut.hdf5
    fails 3 'cut.hdf5: HDF5: cannot open it: ' overlap nested.nii.gz cut.hdf5 --threshold 1
    CONUS_HDF5=$PWD/none fails 3 'field.hdf5: CONUS_HDF5: ' overlap nested.nii.gz field.hdf5 --threshold 1
}

# A map of 1 mm voxels in a row along x, from -3 to 12, through the middle of the nested phantom's core.
map() {
    conus phantom nested -o .
    printf '%s\n' NRRD0004 'type: float' 'dimension: 3' 'sizes: 16 1 1' 'space: RAS' \
        'space directions: (1,0,0) (0,1,0) (0,0,1)' 'space origin: (-3,0,0)' 'encoding: text' '' \
        '5 4 4 0 9 0 -7 -7 0 4 4 4 4 4 4 6' >map.nrrd
}

# rows FILE: the columns cluster, kind, volume_mm3, cluster_fraction, peak, peak_x, voxels and centre_x.
rows() {
    cut -f 2,3,6,8,9,10,13,14 "$1" | sed 1d | tr '\t\n' ' ;'
}

@test "clusters by size, their areas and maxima, with a sidecar that is verified" {
    map
    run -0 conus overlap nested.nii.gz map.nrrd --threshold 3 -q -o areas.tsv --clusters clusters.tsv
    [ "$(head -1 clusters.tsv | tr '\t' ' ')" = "query cluster kind index name volume_mm3 fraction cluster_fraction peak \
peak_x peak_y peak_z voxels centre_x centre_y centre_z" ]
    # (6 + 7 + 8 + 9 + 10 + 11) 4 + 12 * 6 = 276 of 30; (-3 * 5 - 2 * 4 - 1 * 4) of 13
    # The core ends at x = 8.
    wanted='1 cluster 7 1 6 12 7 9.2;1 area 4.5 0.642857143 6 12 n/a n/a;1 area 2.5 0.357142857 4 6 n/a n/a;'
    wanted+='1 maximum n/a n/a 6 12 n/a n/a;'
    wanted+='2 cluster 3 1 5 -3 3 -2.07692308;2 area 3 1 5 -3 n/a n/a;2 maximum n/a n/a 5 -3 n/a n/a;'
    wanted+='3 cluster 1 1 9 1 1 1;3 area 1 1 9 1 n/a n/a;3 maximum n/a n/a 9 1 n/a n/a;'
    [ "$(rows clusters.tsv)" = "$wanted" ]
    [ "$(awk -F'\t' '$3 == "area" { sum += $6 } END { print sum }' clusters.tsv)" = \
        "$(awk -F'\t' 'NR > 1 { sum += $7 } END { print sum }' areas.tsv)" ]
    [ "$(jq -r '.Queries[0].threshold, .Question.rows' clusters.json | xargs)" = "3 clusters" ]
    for file in areas clusters; do
        run -0 conus verify $file.tsv
        has identical
    done
    answers cite clusters.tsv
    output=$(tr '\n' ' ' <<<"$output")
    has "Voxels with a face, an edge or a corner in common were one cluster; its local maxima were at least 8 mm apart."
}

@test "clusters below a negative threshold, of a mask, and in other formats" {
    map
    conus overlap nested.nii.gz map.nrrd --threshold=-3 -q -o areas.tsv --clusters low.csv
    [ "$(tr -d '\r' <low.csv | sed 1d | cut -d , -f 3,6,9,10 | xargs)" = "cluster,2,-7,3 area,2,-7,3 maximum,n/a,-7,3" ]
    conus overlap nested.nii.gz map.nrrd --threshold=-3 -q -o two.csv --clusters also.json
    [ "$(jq -c '[.Rows[] | [.kind, .peak]]' also.json)" = '[["cluster",-7],["area",-7],["maximum",-7]]' ]
    run -0 conus verify also.json
    has identical
    conus overlap nested.nii.gz map.nrrd --threshold=-3 -q -o three.csv --clusters low.txt
    run -0 cat low.txt
    has "cluster 1: 2 voxels, 2.0 mm^3, peak -7 at 3.00, 0.00, 0.00, centre of mass 3.50, 0.00, 0.00, RAS mm"
    scene
    conus overlap nested.nii.gz cone.nii.gz -q -o mask-areas.tsv --clusters mask.tsv
    [ "$(cut -f 3 mask.tsv | sort -u | xargs)" = "area cluster kind" ]
    conus overlap nested.nii.gz cone.nii.gz cone.nii.gz --atlas nested.nii.gz -q -o all.tsv --clusters all-clusters.tsv
    [ "$(cut -f 2 all-clusters.tsv | uniq | xargs)" = "atlas nested nested-2 nested nested-2" ]
    run -0 conus verify all-clusters.tsv
    has identical
}

@test "clusters that cannot be written are refused" {
    map
    fails 2 "--clusters needs a file" overlap nested.nii.gz map.nrrd --threshold 3 --clusters -
    fails 2 "--clusters ends in none of" overlap nested.nii.gz map.nrrd --threshold 3 --clusters clusters.xml
    fails 2 "are the same file" overlap nested.nii.gz map.nrrd --threshold 3 -o rows.tsv --clusters rows.tsv
    fails 2 "is no mask: a threshold is needed" overlap nested.nii.gz map.nrrd --clusters rows.tsv
    [ ! -e rows.tsv ]
}
