#!/usr/bin/env bats
# --atlas-transform: moves the atlas to the poses.

load helpers

aim='--origin 0,-100,0 --toward 0,0,10 --angle 20'

# shifts: a shift of 7 mm to the right in each format: the transform takes points of the poses 7 mm less far to the
# right.
shifts() {
    conus phantom nested -o .
    printf '1 0 0 7\n0 1 0 0\n0 0 1 0\n0 0 0 1\n' >right.txt
    printf '#Insight Transform File V1.0\n#Transform 0\nTransform: TranslationTransform_double_3_3\n%s\n%s\n' \
        'Parameters: -7 0 0' 'FixedParameters:' >right.tfm
    cp right.txt right.mat
}

@test "a moved atlas answers a moved pose as before, and says where that is in its own space" {
    shifts
    answers query nested.nii.gz $aim --layers all --format tsv --quiet
    cut -f 2-15 <<<"$output" >plain
    x=$(cell contact_x 1)
    for file in right.txt right.tfm; do
        run -0 --separate-stderr "$CONUS" query nested.nii.gz --atlas-transform $file --origin -7,-100,0 \
            --toward -7,0,10 --angle 20 --layers all --format tsv
        [[ "$stderr" == *"moved by $file"* ]]
        cut -f 2-13,15 <<<"$output" >moved
        diff <(cut -f 1-12,14 plain) moved
        [ "$(cell atlas_x 1)" = "$x" ]
        awk -v moved="$(cell contact_x 1)" -v x="$x" 'BEGIN { exit (moved + 7 - x) ^ 2 > 1e-12 }'
        [ "$(cell atlas_y 1)" = "$(cell contact_y 1)" ]
    done
    answers query nested.nii.gz --atlas-transform right.txt --atlas-transform right.txt,inverse $aim --layers all \
        --format tsv --quiet
    diff plain <(cut -f 2-15 <<<"$output")
    answers query nested.nii.gz --atlas-transform right.txt $aim --format json --quiet
    [ "$(jq '.Atlas.atlas_from_world[0] == [1, 0, 0, 7]' <<<"$output")" = true ]
    [ "$(jq -r .Atlas.files[-1].path <<<"$output")" = right.txt ]
    answers info nested.nii.gz --atlas-transform right.txt
}

# All coefficients of LPS x are -7 on 6 x 6 x 6 nodes 60 mm apart: within 90 mm of the middle it is right.txt. The atlas's
# voxels are where the grid's are, so that none is another one.
@test "a B-spline of ITK moves the atlas, and one of a list is chosen" {
    need_all
    shifts
    coefficients=$(printf ' -7%.0s' {1..216}; printf ' 0%.0s' {1..432})
    spline=$(printf 'Transform: BSplineTransform_double_3_3\nParameters:%s\nFixedParameters: 6 6 6 %s\n' "$coefficients" \
        '150 150 -150 60 60 60 -1 0 0 0 -1 0 0 0 1')
    { cat right.tfm | head -1; echo "$spline"; } >ffd.tfm
    { cat right.tfm; echo "$spline"; } >list.tfm
    fails 3 'list.tfm: Transform: a list of 2' query nested.nii.gz $aim --atlas-transform list.tfm
    fails 2 'list.tfm: transform=2: there are fewer' query nested.nii.gz $aim --atlas-transform list.tfm,transform=2
    fails 2 'transform: found "x", allowed are whole numbers from 0' query nested.nii.gz $aim --atlas-transform right.tfm,transform=x
    fails 2 'transform is for lists' query nested.nii.gz $aim --atlas-transform right.txt,transform=0
    fails 3 'ffd.tfm: a B-spline is not inverted' query nested.nii.gz $aim --atlas-transform ffd.tfm,inverse
    answers query nested.nii.gz $aim --atlas-transform list.tfm,transform=0 --format tsv --quiet
    cut -f 1-12,14,16-18 <<<"$output" >moved
    for file in ffd.tfm list.tfm,transform=1; do
        answers query nested.nii.gz $aim --atlas-transform $file,grid=nested.nii.gz --format tsv --quiet
        cut -f 1-12,14,16-18 <<<"$output" | diff moved -
    done
    answers query nested.nii.gz $aim --atlas-transform ffd.tfm --format json --quiet
    [ "$(jq -c '[.Atlas.way_to_atlas[] | keys[0]]' <<<"$output")" = '["matrix","spline","matrix"]' ]
    echo '{"conus_atlas": 1, "parcellation": "nested.nii.gz", "transform": {"file": "list.tfm", "transform": 1}}' \
        >one.atlas.json
    answers query one.atlas.json $aim --format tsv --quiet
    head -c 500 ffd.tfm >cut.tfm
    fails 3 'cut.tfm: BSplineTransform_double_3_3: FixedParameters is missing' query nested.nii.gz $aim \
        --atlas-transform cut.tfm
}

@test "batches, sweeps and overlaps are of the moved atlas" {
    shifts
    printf 'x\ty\tz\ttx\tty\ttz\n-7\t-100\t0\t-7\t0\t10\n' >poses.tsv
    answers batch nested.nii.gz --poses poses.tsv --angle 20 --atlas-transform right.txt -q
    awk -v moved="$(cell contact_x 1)" -v own="$(cell atlas_x 1)" 'BEGIN { exit (moved + 7 - own) ^ 2 > 1e-12 }'
    answers sweep nested.nii.gz --origin -7,-100,0 --toward -7,0,10 --angle 60 --format tsv --quiet \
        --atlas-transform right.txt
    cut -f 2-10 <<<"$output" >moved
    answers sweep nested.nii.gz --origin 0,-100,0 --toward 0,0,10 --angle 60 --format tsv --quiet
    diff <(cut -f 2-10 <<<"$output") moved
}

@test "tracks, overlaps and pictures are of the moved atlas" {
    shifts
    sed -i s/7/32/ right.txt # a power of two, so that no number is rounded otherwise
    printf 'time_s\tx\ty\tz\ttx\tty\ttz\n0\t0\t-100\t0\t0\t0\t10\n1\t0\t-90\t0\t20\t0\t10\n' >hand.tsv
    awk 'BEGIN { FS = OFS = "\t" } NR > 1 { $2 -= 32; $5 -= 32 } 1' hand.tsv >moved.tsv
    answers track nested.nii.gz --poses hand.tsv --angle 20 --format tsv --quiet
    cut -f 1-13 <<<"$output" >plain
    answers track nested.nii.gz --poses moved.tsv --angle 20 --format tsv --quiet --atlas-transform right.txt
    diff <(cut -f 1-13 <<<"$output") plain
    local aim='--toward 0,0,10 --angle 20 --size 96x96 --legend none --quiet'
    local moved=${aim/0,0,10/-32,0,10}
    answers render nested.nii.gz -o plain.png --origin 0,-100,0 $aim
    answers render nested.nii.gz -o moved.png --origin -32,-100,0 $moved --atlas-transform right.txt
    cmp plain.png moved.png
    answers render nested.nii.gz -o away.png --origin 0,-100,0 $aim --atlas-transform right.txt
    run -1 cmp -s plain.png away.png
    # the whole atlas as a region covers all of each area, until the atlas is moved
    answers overlap nested.nii.gz nested.nii.gz --threshold 1 --format tsv --quiet
    [ "$(cell fraction 1)" = 1 ]
    sed -i s/32/8/ right.txt
    answers overlap nested.nii.gz nested.nii.gz --threshold 1 --format tsv --quiet --atlas-transform right.txt
    awk -v part="$(cell fraction 1)" 'BEGIN { exit !(part > 0 && part < 1) }'
}

@test "info says where the atlas lies, and all say once when another reading of the transform fits better" {
    conus phantom sphere -o . --size 24
    printf '1 0 0 300\n0 1 0 0\n0 0 -2 0\n0 0 0 1\n' >far.txt
    answers info sphere.nii.gz
    [[ "$output" != *Moved* ]]
    answers info sphere.nii.gz --format json
    [ "$(jq .moved <<<"$output")" = null ]
    low=$(conus info sphere.nii.gz | sed -n 's/.*covers  *x \([^ ]*\) .*/\1/p')
    run -0 --separate-stderr "$CONUS" info sphere.nii.gz --atlas-transform far.txt --context sphere.nii.gz
    has '  volume       1 mm^3 of the atlas is 0.5 mm^3 here'
    has '  sides        left and right are exchanged'
    has '  centre       -300.0, 0.0, 0.0 mm, 300.0 mm from where its files have it'
    has '  in context   0.0 % of its voxels in the grid, 0.0 % in the head'
    has '0 % of the atlas is in the head of sphere.nii.gz; without the transform it would be 100 %'
    run -0 --separate-stderr "$CONUS" info sphere.nii.gz --atlas-transform far.txt --context sphere.nii.gz --format json
    [ "$(jq -c '[.moved.growth, .moved.mirrors, .moved.distance_mm, .moved.context.in_grid]' <<<"$output")" = \
        '[0.5,true,300,0]' ]
    [ "$(jq '.moved.low[0] == .moved.own_low[0] - 300' <<<"$output")" = true ]
    [ -n "$low" ]
    printf 'time_s\tx\ty\tz\ttx\tty\ttz\n0\t-300\t-100\t0\t-300\t0\t10\n' >hand.tsv
    local place='sphere.nii.gz --atlas-transform far.txt --context sphere.nii.gz' cone='--angle 20 --context-blocks 1'
    local aim='--origin -300,-100,0 --toward -300,0,10'
    for command in "query $place $cone $aim" "sweep $place $cone $aim --jitter 2,1" "batch $place $cone --poses hand.tsv" \
        "track $place $cone --poses hand.tsv" "render $place -o picture.png --size 32x32"; do
        run -0 --separate-stderr "$CONUS" $command
        [ "$(grep -c 'warning: 0 % of the atlas is in the head of sphere.nii.gz; without the transform' <<<"$stderr")" -eq 1 ]
        not grep -q 'in the head' <(grep -v '^warning: ' <<<"$output") # those stand above a table
    done
    echo '{"conus_atlas": 1, "parcellation": "sphere.nii.gz", "transform": "far.txt", "context": "sphere.nii.gz"}' \
        >far.atlas.json
    run -0 --separate-stderr "$CONUS" query far.atlas.json --angle 20 $aim
    [[ "$stderr" == *'in the head of'*'; without the transform it would be 100 %'* ]]
    sed -i 's/"context": /&{"moves": true, "file": /; s/}$/}}/' far.atlas.json # it is moved along
    run -0 --separate-stderr "$CONUS" query far.atlas.json --angle 20 $aim
    not grep -q 'in the head of' <<<"$stderr"
}

@test "a manifest keeps the transform with the files" {
    shifts
    mkdir lab
    cp nested.nii.gz nested.tsv right.txt right.tfm lab
    echo '{"conus_atlas": 1, "parcellation": "nested.nii.gz", "transform": "right.txt"}' >lab/one.atlas.json
    echo '{"conus_atlas": 1, "parcellation": "nested.nii.gz", "context": "nested.nii.gz",
        "transform": ["right.tfm", {"file": "right.txt"}, {"file": "right.txt", "inverse": true}]}' >lab/list.atlas.json
    local ask='--origin -7,-100,0 --toward -7,0,10 --angle 20 --layers all --format tsv --quiet'
    answers query nested.nii.gz --atlas-transform right.txt $ask
    echo "$output" >wanted
    for manifest in one list; do
        run -0 --separate-stderr "$CONUS" query lab/$manifest.atlas.json $ask # the context does not fit
        diff wanted - <<<"$output"
    done
    # on a point's way the option comes first
    printf '0 -1 0 0\n1 0 0 0\n0 0 1 0\n0 0 0 1\n' >turn.txt
    answers query nested.nii.gz $ask --atlas-transform turn.txt --atlas-transform right.txt
    echo "$output" >wanted
    answers query lab/one.atlas.json $ask --atlas-transform turn.txt
    diff wanted - <<<"$output"
    answers query lab/one.atlas.json --origin -7,-100,0 --toward -7,0,10 --angle 20 --format json --quiet
    [ "$(jq '.Atlas.atlas_from_world[0] == [1, 0, 0, 7]' <<<"$output")" = true ]
    [ "$(jq -r .Atlas.files[-1].path <<<"$output")" = lab/right.txt ]
    sed -i 's/right.txt/none.txt/' lab/one.atlas.json
    fails 3 'one.atlas.json: transform: lab/none.txt: ' query lab/one.atlas.json $ask
}

@test "a batch of another transform is another one" {
    shifts
    printf 'x\ty\tz\ttx\tty\ttz\n-7\t-100\t0\t-7\t0\t10\n' >poses.tsv
    echo '{"conus_atlas": 1, "parcellation": "nested.nii.gz", "transform": "right.txt"}' >one.atlas.json
    cp right.txt kept.txt
    for atlas in 'nested.nii.gz --atlas-transform right.txt' one.atlas.json; do
        local batch="batch $atlas --poses poses.tsv --angle 20 -o rows.tsv --quiet"
        conus $batch --force
        answers $batch # it is finished already
        sed -i 's/7/8/' right.txt
        fails 2 'there is a file already' $batch
        cp kept.txt right.txt
        answers $batch
    done
}

@test "what is no affine is refused" {
    shifts
    fails 2 "from=IMAGE and to=IMAGE are needed" query nested.nii.gz $aim --atlas-transform right.mat
    fails 2 "to=IMAGE is needed, too" query nested.nii.gz $aim --atlas-transform right.mat,from=nested.nii.gz
    fails 2 "are for FSL's matrices" query nested.nii.gz $aim \
        --atlas-transform right.tfm,from=nested.nii.gz,to=nested.nii.gz
    printf 'bert\n1\n1\n0.15\n1 0 0 7\n0 1 0 0\n0 0 1 0\n0 0 0 1\nround\n' >register.dat
    fails 2 "FreeSurfer's register.dat, whose numbers mean nothing without its two images: from=IMAGE" query \
        nested.nii.gz $aim --atlas-transform register.dat
    answers query nested.nii.gz $aim --atlas-transform register.dat,from=nested.nii.gz,to=nested.nii.gz --quiet
    fails 2 "names no file" query nested.nii.gz $aim --atlas-transform ,inverse
    fails 3 "this is a volume, but no deformation field" query nested.nii.gz $aim --atlas-transform nested.nii.gz
    printf '1 0 0 7\n0 1 0 0\n0 0 0 0\n0 0 0 1\n' >flat.txt
    fails 3 "flat.txt: the matrix is singular" query nested.nii.gz $aim --atlas-transform flat.txt
    answers query nested.nii.gz $aim --atlas-transform right.mat,from=nested.nii.gz,to=nested.nii.gz --quiet
    printf '1 0 0 7\n0 nan 0 0\n0 0 1 0\n0 0 0 1\n' >nan.txt
    fails 3 'nan.txt: matrix: row 2: "nan", four finite numbers are needed' query nested.nii.gz $aim \
        --atlas-transform nan.txt
    printf -- '-1 0 0 7\n0 1 0 0\n0 0 1 0\n0 0 0 1\n' >mirror.txt
    run -0 --separate-stderr "$CONUS" query nested.nii.gz $aim --atlas-transform mirror.txt
    [[ "$stderr" == *'mirror.txt mirrors: left areas of the atlas are right ones where poses are'* ]]
}

# An image 500 mm away from the atlas cannot be one of its space; the direction of the matrix decides which of the two
# it is.
@test "the images of an FSL matrix are held against the atlas" {
    shifts
    conus phantom nested -o far
    /usr/bin/python3 -B - <<'END'
import gzip, struct
data = bytearray(gzip.open("far/nested.nii.gz").read())
for row in range(3):  # srow_x, srow_y, srow_z of nifti1.h, and qoffset
    at = 280 + 16 * row + 12
    struct.pack_into("<f", data, at, struct.unpack_from("<f", data, at)[0] + 500)
    struct.pack_into("<f", data, 268 + 4 * row, struct.unpack_from("<f", data, 268 + 4 * row)[0] + 500)
open("far.nii", "wb").write(data)
END
    local ask="query nested.nii.gz $aim --atlas-transform right.mat"
    run -0 --separate-stderr "$CONUS" $ask,from=far.nii,to=nested.nii.gz
    not grep -q 'in the grid of' <<<"$stderr"
    run -0 --separate-stderr "$CONUS" $ask,from=nested.nii.gz,to=far.nii
    [[ "$stderr" == *'warning: 0 % of the atlas is in the grid of far.nii: is to= the image of its space?'* ]]
    run -0 --separate-stderr "$CONUS" $ask,from=far.nii,to=nested.nii.gz,inverse
    [[ "$stderr" == *'warning: 0 % of the atlas is in the grid of far.nii: is from= the image of its space?'* ]]
}

# The grid's box, -32 to 32 mm, turned by 180 degrees about z and moved by (32, 32.00001, 0): the sums of +-63 mm leave
# some 1e-15 of x, which is 0, and 1e-5 of y, which is more than 1e-7 of 63 mm.
@test "info prints 0 for what rounding left, but not in JSON" {
    conus phantom sphere -o . --size 32 --spacing 2,2,2
    printf '%s\n' '-1 1.2246467991473532e-16 0 32' '-1.2246467991473532e-16 -1 0 32.00001' '0 0 1 0' '0 0 0 1' >turn.txt
    answers info sphere.nii.gz --atlas-transform turn.txt
    has '  covers       x 0 to 64, y 1e-05 to 64, z -32 to 32 mm'
    answers info sphere.nii.gz --atlas-transform turn.txt --format json
    [ "$(jq '.moved.atlas_from_world[0][1] | . != 0 and . > -1e-15 and . < 1e-15' <<<"$output")" = true ]
}

# right.h5 shifts like right.txt, in two steps; field.h5 by a field; linked.h5 refers to another file.
composites() {
    shifts
    [ -x "$(dirname "$CONUS")/conus-hdf5" ] || skip "no conus-hdf5"
    /usr/bin/python3 -c 'import h5py' || skip "no python3-h5py"
    /usr/bin/python3 -B - <<'END'
import h5py
import numpy as np

def write(name, *steps):
    file = h5py.File(name, "w")
    for i, (kind, numbers, fixed) in enumerate(steps):
        group = file.create_group(f"TransformGroup/{i}")
        group.create_dataset("TransformType", data=[f"{kind}_double_3_3"], dtype=h5py.string_dtype())
        if fixed is not None:
            group["TransformParameters"] = np.array(numbers, "f8")
            group["TransformFixedParameters"] = np.array(fixed, "f8")
    return file

chain = ("CompositeTransform", [], None)
write("right.h5", chain, ("TranslationTransform", [-3, 5, 0], []), ("TranslationTransform", [-4, -5, 0], []))
grid = [9, 9, 9, -200, -200, -200, 50, 50, 50, 1, 0, 0, 0, 1, 0, 0, 0, 1]
write("field.h5", chain, ("DisplacementFieldTransform", np.tile([-7.0, 0, 0], 729), grid))
file = write("linked.h5", chain)
file["TransformGroup/1"] = h5py.ExternalLink("right.h5", "/TransformGroup/1")
END
}

@test "a composite in HDF5 moves the atlas as its steps do" {
    composites
    answers query nested.nii.gz $aim --atlas-transform right.txt --layers all --format tsv --quiet
    cut -f 2-15 <<<"$output" >plain
    answers query nested.nii.gz $aim --atlas-transform right.h5 --layers all --format tsv --quiet
    diff plain <(cut -f 2-15 <<<"$output")
    answers query nested.nii.gz $aim --layers all --format tsv --quiet
    cut -f 2-15 <<<"$output" >plain
    answers query nested.nii.gz $aim --atlas-transform right.h5 --atlas-transform right.h5,inverse --layers all \
        --format tsv --quiet
    diff plain <(cut -f 2-15 <<<"$output")
    run -0 --separate-stderr "$CONUS" query nested.nii.gz --atlas-transform field.h5,grid=nested.nii.gz $aim --format tsv
    [[ "$stderr" == *'field.h5: of ITK, points go through DisplacementFieldTransform_double_3_3'* ]]
    awk -v own="$(cell atlas_x 1)" -v x="$(cell contact_x 1)" 'BEGIN { exit (own - x - 7) ^ 2 > 1e-14 }'
    answers query nested.nii.gz --atlas-transform field.h5,grid=nested.nii.gz $aim --format json --quiet
    [ "$(jq -r '.Atlas.files[].path' <<<"$output" | grep -c field.h5)" = 1 ]
    [ "$(jq -r '.Atlas.files[] | select(.path == "field.h5").sha256' <<<"$output")" = "$(sha256sum <field.h5 | cut -c 1-64)" ]
}

@test "a composite that conus must not read is refused in one line" {
    composites
    local ask="query nested.nii.gz $aim --atlas-transform"
    fails 3 'linked.h5: /TransformGroup/1: a link to another file, which is not followed' $ask linked.h5
    fails 3 'field.h5: a chain with a deformation field is not inverted' $ask field.h5,inverse
    fails 2 'right.h5: from, to, relative and absolute are for files' $ask right.h5,relative
    fails 2 'right.h5: transform is for lists in ITK' $ask right.h5,transform=1
    fails 3 '(--max-memory)' $ask field.h5 --max-memory 20K
    CONUS_HDF5=$PWD/none fails 3 'right.h5: CONUS_HDF5: ' $ask right.h5
    printf '\211HDF\r\n\032\n' >cut.h5
    fails 3 'cut.h5: HDF5: cannot open it' $ask cut.h5
}

@test "the name of a transform of fMRIPrep says for which poses it is" {
    composites
    local ask="query nested.nii.gz $aim --atlas-transform" name=sub-01_from-T1w_to-MNI152_mode-image_xfm.h5
    cp right.h5 $name
    run -0 --separate-stderr "$CONUS" $ask $name
    [[ "$stderr" == *"$name: by its name it moves points of MNI152 to T1w: it is for poses in the first"* ]]
    cp nested.nii.gz MNI_nested.nii.gz
    cp nested.tsv MNI_nested.tsv
    run -0 --separate-stderr "$CONUS" query MNI_nested.nii.gz $aim --atlas-transform $name
    [[ "$stderr" == *'but the atlas is in the MNI'*'for poses in T1w the file of the other direction is needed'* ]]
    run -0 --separate-stderr "$CONUS" query MNI_nested.nii.gz $aim --atlas-transform $name,inverse
    [[ "$stderr" == *"by its name it moves points of T1w to MNI152: it is for poses in the first"* ]]
}

# What the file calls left lies on the right of poses then, halves as well as names (by hand: x becomes -x).
@test "a transform with a determinant below 0 turns sides, and it is said" {
    conus phantom sphere -o .
    printf -- '-1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n' >mirror.txt
    for side in left right; do
        local x=$([ $side = left ] && echo -8 || echo 8) other=$([ $side = left ] && echo right || echo left)
        local ask="query sphere.nii.gz --point $x,5,5 --radius 1 --hemispheres split --format tsv"
        answers $ask --quiet
        [ "$(cell name 1)" = "Sphere $side" ]
        run -0 --separate-stderr "$CONUS" $ask --atlas-transform mirror.txt
        [ "$(cell name 1)" = "Sphere $other" ]
        [[ "$stderr" == *'mirror.txt mirrors: left areas of the atlas are right ones where poses are'* ]]
    done
}
