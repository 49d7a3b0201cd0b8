#!/usr/bin/env bats
# --atlas-transform with deformation fields: of ITK, SPM and FSL, in chains, and files that are no such field.

load helpers

aim='--origin -8,-100,0 --toward -8,0,10 --angle 20'

# field KIND [MM]: KIND.nii.gz, in which points go 8 mm to the right, or MM, on the grid of the phantom.
field() {
    [ -e nested.nii.gz ] || "$CONUS" phantom nested -o . >/dev/null
    python3 "$BATS_TEST_DIRNAME/fields.py" "$1" nested.nii.gz "$1.nii.gz" "${2:-8}"
}

# coarse.nii: voxels of 2 mm around the origin.
coarse() {
    python3 -c "import sys; sys.path.insert(0, '$BATS_TEST_DIRNAME'); import nifti
nifti.write('coarse.nii', (32, 32, 32), 'B', lambda i, j, k: 0, 2)"
}

images=,from=nested.nii.gz,to=nested.nii.gz

@test "a shift is the same as an affine and as a field of each program" {
    field itk
    printf '1 0 0 8\n0 1 0 0\n0 0 1 0\n0 0 0 1\n' >right.txt
    answers query nested.nii.gz --atlas-transform right.txt $aim --layers all --format tsv --quiet
    affine=$output
    [ -n "$(cell atlas_x 1)" ]
    for kind in spm rel abs; do
        field $kind
    done
    for file in itk.nii.gz spm.nii.gz rel.nii.gz$images abs.nii.gz$images itk.nii.gz,relative spm.nii.gz,absolute \
        abs.nii.gz$images,absolute; do
        run -0 --separate-stderr "$CONUS" query nested.nii.gz --atlas-transform $file $aim --layers all --format tsv
        [[ "$stderr" == "conus: note: warped by ${file%%,*}: voxels are those"*" 64 x 64 x 64 voxels of 1 x 1 x 1 mm" ]]
        [ "$output" = "$affine" ]
    done
}

# After a ball of radius R was shifted by d, the part 1 - 3 d / (4 R) + d^3 / (16 R^3) of it is where it was: with 20
# mm, 0.8505 for 4 mm and 0.704 for 8 mm.
@test "an atlas that a field leaves with less than four fifths in the head has a note" {
    sphere
    for mm in 4 8; do
        python3 "$BATS_TEST_DIRNAME/fields.py" itk sphere.nii.gz itk.nii.gz $mm
        run -0 --separate-stderr "$CONUS" info sphere.nii.gz --atlas-transform itk.nii.gz --context sphere.nii.gz
        [ $mm = 4 ] || has '70 % of the atlas is in the head of sphere.nii.gz: is the transform of the other direction, '
        [ $mm = 8 ] || [[ "$output$stderr" != *'of the atlas is in the head'* ]]
    done
}

@test "a manifest has a field as the option has it" {
    field abs
    coarse
    echo '{"conus_atlas": 1, "parcellation": "nested.nii.gz"}' >plain.atlas.json
    echo '{"conus_atlas": 1, "parcellation": "nested.nii.gz", "transform": {"file": "abs.nii.gz",
        "from": "nested.nii.gz", "to": "nested.nii.gz", "vectors": "absolute", "grid": "coarse.nii"}}' >moved.atlas.json
    answers query plain.atlas.json --atlas-transform abs.nii.gz$images,absolute,grid=coarse.nii $aim --layers all \
        --format tsv --quiet
    wanted=$output
    [ -n "$(cell atlas_x 1)" ]
    answers query moved.atlas.json $aim --layers all --format tsv --quiet
    [ "$output" = "$wanted" ]
    sed -i 's/"absolute"/"other"/' moved.atlas.json
    fails 3 'transform.vectors: found "other"' query moved.atlas.json $aim
    sed -i 's/"other"/"relative"/' moved.atlas.json
    run -0 --separate-stderr "$CONUS" query moved.atlas.json $aim
    [[ "$stderr" == *"the vectors are taken for displacements, but look like positions"* ]]
    fails 3 'transform: abs.nii.gz' query moved.atlas.json $aim --max-memory 2M # the voxels, 1 MB, fit
}

@test "fields and affines are a chain, and the rows say where the contact is in the atlas" {
    field itk
    printf '1 0 0 5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n' >five.txt
    printf '1 0 0 -5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n' >back.txt
    answers query nested.nii.gz --atlas-transform itk.nii.gz $aim --layers all --format tsv --quiet
    plain=$output
    answers query nested.nii.gz --atlas-transform five.txt --atlas-transform itk.nii.gz --atlas-transform back.txt $aim \
        --layers all --format tsv --quiet
    [ "$output" = "$plain" ]
    [ "$(cell atlas_y 1)" = "$(cell contact_y 1)" ]
    awk -v moved="$(cell contact_x 1)" -v own="$(cell atlas_x 1)" 'BEGIN { exit (moved + 8 - own) ^ 2 > 1e-12 }'
    # two fields of 4 mm, also moved back through both: searched once, nothing is lost
    field itk 4
    answers query nested.nii.gz --atlas-transform itk.nii.gz --atlas-transform itk.nii.gz $aim --layers all \
        --format tsv --quiet
    [ "$output" = "$plain" ]
    answers query nested.nii.gz --atlas-transform itk.nii.gz $aim --format json --quiet
    [ "$(jq -r .Atlas.files[-1].path <<<"$output")" = itk.nii.gz ]
    [ "$(jq -r .Atlas.files[-1].sha256 <<<"$output")" = "$(sha256sum itk.nii.gz | cut -d' ' -f1)" ]
    [ "$(jq -r .Atlas.volumes[0].transform <<<"$output")" = "sform, code 1 (scanner), warped" ]
    [ "$(jq '.Atlas | has("atlas_from_world")' <<<"$output")" = false ]
    answers query nested.nii.gz --atlas-transform five.txt --atlas-transform itk.nii.gz $aim --format json --quiet
    [ "$(jq -c '[.Atlas.way_to_atlas[] | keys[0]]' <<<"$output")" = '["matrix","field","matrix"]' ]
    [ "$(jq '.Atlas.way_to_atlas[0].matrix[0] == [1, 0, 0, 5]' <<<"$output")" = true ]
    [ "$(jq '.Atlas.way_to_atlas[1].field.linear[0] == [-1, 0, 0, 0]' <<<"$output")" = true ]
    [ "$(jq '.Atlas.way_to_atlas[1].field.dim == [64, 64, 64]' <<<"$output")" = true ]
}

# All points go 8 mm to the right, whoever wrote the field: no other word has the same answer.
@test "a field of four dimensions in mm of the world" {
    field itk
    answers query nested.nii.gz --atlas-transform itk.nii.gz $aim --layers all --format tsv --quiet
    wanted=$output
    field ras
    field mrtrix
    for file in ras.nii.gz,space=ras,relative mrtrix.nii.gz,space=ras,absolute itk.nii.gz,relative,space=lps; do
        answers query nested.nii.gz --atlas-transform $file $aim --layers all --format tsv --quiet
        [ "$output" = "$wanted" ]
    done
    echo '{"conus_atlas": 1, "parcellation": "nested.nii.gz", "transform": {"file": "mrtrix.nii.gz",
        "vectors": "absolute", "space": "ras"}}' >moved.atlas.json
    answers query moved.atlas.json $aim --layers all --format tsv --quiet
    [ "$output" = "$wanted" ]
    run -0 --separate-stderr "$CONUS" query nested.nii.gz --atlas-transform ras.nii.gz$images $aim
    [[ "$stderr" == *"taken for FSL's; for displacements in RAS mm (MRtrix, SynthMorph, VoxelMorph)"* ]]
    run -0 --separate-stderr "$CONUS" query nested.nii.gz --atlas-transform mrtrix.nii.gz,absolute$images $aim
    [[ "$stderr" == *"look like those in RAS mm, as MRtrix has them, and not like FSL's"* ]]
}

# From the fixed image to the moving one points go through 1Warp and then the affine, back through the inverse affine
# and then 1InverseWarp: of the eight pairs in which they may be given, two.
@test "pairs of ANTs's files that do not fit together have a note" {
    field itk 4
    cp itk.nii.gz o_1Warp.nii.gz
    cp itk.nii.gz o_1InverseWarp.nii.gz
    cp itk.nii.gz other_1Warp.nii.gz
    printf '#Insight Transform File V1.0\nTransform: TranslationTransform_double_3_3\nParameters: 1 0 0\nFixedParameters:\n' \
        >o_0GenericAffine.mat
    local affine warp order
    for affine in o_0GenericAffine.mat o_0GenericAffine.mat,inverse; do
        for warp in o_1Warp.nii.gz o_1InverseWarp.nii.gz; do
            for order in "$affine $warp" "$warp $affine"; do
                run -0 --separate-stderr "$CONUS" info nested.nii.gz --atlas-transform ${order% *} \
                    --atlas-transform ${order#* }
                case $order in
                "o_0GenericAffine.mat,inverse o_1InverseWarp.nii.gz" | "o_1Warp.nii.gz o_0GenericAffine.mat")
                    [[ "$output" != *'do not fit together'* ]] ;;
                *) has "points go through ${order% *} and then ${order#* }, which by their names do not fit together" ;;
                esac
            done
        done
    done
    run -0 "$CONUS" info nested.nii.gz --atlas-transform o_0GenericAffine.mat --atlas-transform other_1Warp.nii.gz
    [[ "$output" != *'do not fit together'* ]]
}

@test "a mask lies where the moved atlas lies" {
    field itk
    printf '1 0 0 5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n' >five.txt
    for file in five.txt itk.nii.gz; do
        conus query --force nested.nii.gz --atlas-transform $file $aim -q --mask mask.nii.gz >answer.txt
        # the region is in the areas that have its voxels: no part is in none
        answers overlap nested.nii.gz mask.nii.gz --atlas-transform $file --format tsv --quiet
        [[ $output == *$'\tarea\t'* && $output != *unassigned* ]]
    done
}

@test "labels are on the grid that is asked for" {
    field itk
    coarse
    run -0 --separate-stderr "$CONUS" query nested.nii.gz --atlas-transform itk.nii.gz,grid=coarse.nii $aim
    [[ "$stderr" == *"on a grid of 32 x 32 x 32 voxels of 2 x 2 x 2 mm"* ]]
    [[ "$stderr" == *"voxels of this grid are up to 2 times as long as the atlas's"*"grid=IMAGE takes a finer one" ]]
    # behind an affine there is one field still, and its voxels are taken anew once
    printf '1 0 0 5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n' >five.txt
    run -0 --separate-stderr "$CONUS" query nested.nii.gz --atlas-transform five.txt,grid=nested.nii.gz \
        --atlas-transform itk.nii.gz $aim
    [ "$(grep -c 'warped by' <<<"$stderr")" = 1 ]
    [[ "$stderr" == *"five.txt: voxels are taken anew from the atlas's own, once, on a grid of 64 x 64 x 64"* ]]
    printf '1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n' >same.txt
    fails 2 "grid: nothing is resampled" query nested.nii.gz --atlas-transform same.txt,grid=nested.nii.gz $aim
    fails 2 "--mask coarse.nii would overwrite the input coarse.nii" query nested.nii.gz $aim \
        --atlas-transform itk.nii.gz,grid=coarse.nii --mask coarse.nii
    fails 3 "no.nii" query nested.nii.gz --atlas-transform itk.nii.gz,grid=no.nii $aim
    fails 2 'grid: found "", an image is needed' query nested.nii.gz --atlas-transform itk.nii.gz,grid= $aim
}

@test "engines agree about a warped atlas" {
    field itk
    answers query nested.nii.gz --atlas-transform itk.nii.gz $aim --layers all --format tsv --quiet
    rays=$output
    gl query nested.nii.gz --atlas-transform itk.nii.gz $aim --layers all --format tsv --quiet --engine gl
    [ "$output" = "$rays" ]
}

@test "notes tell what is odd about a field" {
    field metres
    run -0 --separate-stderr "$CONUS" query nested.nii.gz --atlas-transform metres.nii.gz $aim
    [[ "$stderr" == *"the farthest way of a point is 0.008 mm: are the field's vectors in mm?"* ]]
    field lps
    run -0 --separate-stderr "$CONUS" query nested.nii.gz --atlas-transform lps.nii.gz $aim
    [[ "$stderr" == *"turns by half a circle about z, as positions in LPS would"* ]]
    field itk 20
    run -0 --separate-stderr "$CONUS" query nested.nii.gz --atlas-transform itk.nii.gz $aim
    [[ "$stderr" == *" % of the atlas's voxels lie outside of the field, and are lost"* ]]
    field fold 2
    run -0 --separate-stderr "$CONUS" query nested.nii.gz --atlas-transform fold.nii.gz $aim
    [[ "$stderr" == *"the field folds (Jacobian <= 0) in "*" of 250047 cells"* ]]
    field abs
    run -0 --separate-stderr "$CONUS" query nested.nii.gz --atlas-transform abs.nii.gz$images,relative $aim
    [[ "$stderr" == *"the vectors are taken for displacements, but look like positions"* ]]
}

@test "what is no field of points is refused" {
    move="query nested.nii.gz $aim --atlas-transform"
    for kind in itk spm rel nan unsaid spline reg two; do
        field $kind
    done
    fails 3 "no deformation field" $move nested.nii.gz
    fails 3 "no deformation field" $move two.nii.gz
    fails 3 "a deformation field is not inverted" $move itk.nii.gz,inverse
    fails 2 "from=IMAGE and to=IMAGE are needed" $move rel.nii.gz
    fails 2 "whose numbers mean nothing without its two images" $move rel.nii.gz,space=ras,relative
    fails 2 "one of them is needed" $move rel.nii.gz,space=ras$images
    field ras
    for key in '' ,relative ,absolute; do
        fails 2 "',space=ras,absolute' for positions in RAS mm (MRtrix's warpconvert, EasyReg)" $move ras.nii.gz$key
    done
    fails 2 "',relative' (displacements) or ',absolute' (positions) is needed, too" $move ras.nii.gz,space=ras
    fails 2 'space: found "RAS", allowed are ras and lps' $move ras.nii.gz,space=RAS,relative
    fails 2 "to=IMAGE is needed, too" $move rel.nii.gz,from=nested.nii.gz
    fails 2 "are for FSL's fields" $move itk.nii.gz$images
    fails 2 'itk.nii.gz: transform is for lists in ITK' $move itk.nii.gz,transform=0
    fails 3 "coefficients of fnirt; 'convertwarp" $move spline.nii.gz$images
    fails 3 "voxel (0, 0, 0): a vector that is not finite" $move nan.nii.gz
    fails 2 "look like positions, and the header does not say so" $move unsaid.nii.gz
    fails 2 "not relative" $move spm.nii.gz,relative
    fails 3 "intent_p1 2, a grid or velocities of NiftyReg" $move reg.nii.gz
    fails 3 "bytes" $move itk.nii.gz --max-memory 1M
    printf '1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n' >same.txt
    fails 2 "relative and absolute" $move same.txt,absolute
    gzip -dc itk.nii.gz | head -c 100000 >cut.nii
    fails 3 "cut.nii" $move cut.nii
    field itk 500
    fails 3 "nothing of the atlas is where the field leads to" $move itk.nii.gz
    coarse
    fails 2 "from: coarse.nii lies up to 0.866 mm from where the field does" $move \
        rel.nii.gz,from=coarse.nii,to=nested.nii.gz
}
