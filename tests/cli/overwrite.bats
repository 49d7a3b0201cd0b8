#!/usr/bin/env bats
# No output takes the place of a file that is read, with --force and by whatever name; what is only looked at is none.
load helpers

@test "no output of any command over any file that it reads" {
    run -0 python3 "$BATS_TEST_DIRNAME/overwrite.py" "$CONUS"
    [[ "$output" =~ ^[0-9]+\ tries$ ]]
}

@test "atlases of many files keep them all: chunks, detached voxels, XML, meshes, a table of the environment" {
    conus phantom u-shape -o . --size 16
    local aim="--origin 40,0,0 --toward 0,0,0" file
    gzip -dc u-shape.nii.gz | tail -c +353 >voxels.raw
    printf '%s\n' NRRD0004 'type: uint8' 'dimension: 3' 'sizes: 16 16 16' 'space: RAS' 'space directions: (1,0,0) (0,1,0) (0,0,1)' \
        'space origin: (-8,-8,-8)' 'encoding: raw' 'data file: voxels.raw' >u.nhdr
    mkdir two.zarr home
    echo '{"zarr_format": 2, "shape": [2, 2, 2], "chunks": [1, 2, 2], "dtype": "|u1", "order": "C", "compressor": null,
        "fill_value": 0}' >two.zarr/.zarray
    printf 1111 >two.zarr/0.0.0
    # shellcheck disable=SC2086 # words
    for file in voxels.raw u.nhdr; do
        fails 2 "would overwrite the input $file" query u.nhdr $aim --quiet --format tsv -o $file --force
    done
    for file in two.zarr/.zarray two.zarr/0.0.0; do
        # shellcheck disable=SC2086
        fails 2 "would overwrite the input $file" query two.zarr,resolution=1000,orientation=asr $aim --quiet --format tsv -o $file --force
    done
    # where the environment says
    conus phantom u-shape -o aseg --size 16
    mv aseg/u-shape.nii.gz aparc+aseg.nii.gz
    printf '1 U 1 2 3 0\n2 Ball 4 5 6 0\n' >home/FreeSurferColorLUT.txt
    # shellcheck disable=SC2086
    FREESURFER_HOME=$PWD/home run -2 "$CONUS" query u-shape.nii.gz --labels home/FreeSurferColorLUT.txt $aim --quiet -o home/./FreeSurferColorLUT.txt \
        --format tsv --force
    # by a descriptor, and written into a folder
    # shellcheck disable=SC2086
    fails 2 'would overwrite the input u-shape.nii.gz' query u-shape.nii.gz $aim --quiet --format tsv -o /proc/self/fd/7 --force 7<>u-shape.nii.gz
    printf 'solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n' >t.stl
    sha256sum u-shape.* voxels.raw u.nhdr two.zarr/.z* two.zarr/0* >after
    sha256sum -c --quiet after
}

@test "poses that a file gives to standard input keep it" {
    conus phantom u-shape -o . --size 16
    printf 'x\ty\tz\tdx\tdy\tdz\tfar\n40\t0\t0\t-1\t0\t0\t45\n' | tee poses.tsv >before
    local command
    for command in 'batch --poses -' 'plan --reach Ball --poses -' 'query --pose -'; do
        # shellcheck disable=SC2086 # words
        run -2 "$CONUS" ${command%% *} u-shape.nii.gz ${command#* } -o poses.tsv --force <poses.tsv
        [[ "$output" == *'--output poses.tsv would overwrite the input /dev/stdin'* ]]
        cmp poses.tsv before
    done
}

@test "standard output that is sent back into a file that is read keeps it" {
    conus phantom u-shape -o . --size 16
    printf 'x\ty\tz\tdx\tdy\tdz\tfar\n40\t0\t0\t-1\t0\t0\t45\n' | tee poses.tsv >before
    local command
    for command in 'batch --poses' 'plan --reach Ball --poses' 'query --pose' 'sweep --pose'; do
        # shellcheck disable=SC2086,SC2094 # words, and this is what is refused
        "$CONUS" ${command%% *} u-shape.nii.gz ${command#* } poses.tsv >>poses.tsv 2>message && false
        [ "$(cat message)" = 'conus: standard output /dev/stdout would overwrite the input poses.tsv' ]
        cmp poses.tsv before
    done
    # what is no file may be both
    "$CONUS" query u-shape.nii.gz --pose - <poses.tsv >/dev/null
}

@test "a table beside the atlas that is not its own may be replaced" {
    conus phantom u-shape -o . --size 16
    rm u-shape.tsv u-shape.json
    local aim="--origin 40,0,0 --toward 0,0,0 --quiet"
    # shellcheck disable=SC2086 # words
    for i in 1 2 3; do # the second time the loader looks into it, for labels
        conus query u-shape.nii.gz $aim -o u-shape.txt --force
    done
    conus info u-shape.nii.gz | grep -q 'u-shape.txt is not a label table of a known format: passed over'
}
