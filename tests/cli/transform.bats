#!/usr/bin/env bats
# --atlas-transform: the atlas comes to the poses.

load helpers

aim='--origin 0,-100,0 --toward 0,0,10 --angle 20'

# A shift of 7 mm to the right as each file that says so: points of the poses, 7 mm less to the right.
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
        answers query lab/$manifest.atlas.json $ask
        diff wanted - <<<"$output"
    done
    # the option comes first on the way of a point
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

@test "a batch is not resumed under another transform" {
    shifts
    printf 'x\ty\tz\ttx\tty\ttz\n-7\t-100\t0\t-7\t0\t10\n' >poses.tsv
    echo '{"conus_atlas": 1, "parcellation": "nested.nii.gz", "transform": "right.txt"}' >one.atlas.json
    cp right.txt kept.txt
    for atlas in 'nested.nii.gz --atlas-transform right.txt' one.atlas.json; do
        local batch="batch $atlas --poses poses.tsv --angle 20 -o rows.tsv --quiet"
        conus $batch --force
        answers $batch --resume # it is finished
        sed -i 's/7/8/' right.txt
        fails 2 'there is a file already' $batch --resume
        cp kept.txt right.txt
        answers $batch --resume
    done
}

@test "what is no affine is refused" {
    shifts
    fails 2 "from=IMAGE and to=IMAGE are needed" query nested.nii.gz $aim --atlas-transform right.mat
    fails 2 "to=IMAGE is needed, too" query nested.nii.gz $aim --atlas-transform right.mat,from=nested.nii.gz
    fails 2 "are of FSL's matrices" query nested.nii.gz $aim \
        --atlas-transform right.tfm,from=nested.nii.gz,to=nested.nii.gz
    fails 2 "names no file" query nested.nii.gz $aim --atlas-transform ,inverse
    fails 3 "this is a volume, but no deformation field" query nested.nii.gz $aim --atlas-transform nested.nii.gz
    printf '1 0 0 7\n0 1 0 0\n0 0 0 0\n0 0 0 1\n' >flat.txt
    fails 3 "flat.txt: the matrix is singular" query nested.nii.gz $aim --atlas-transform flat.txt
    answers query nested.nii.gz $aim --atlas-transform right.mat,from=nested.nii.gz,to=nested.nii.gz --quiet
}
