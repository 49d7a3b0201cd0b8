#!/usr/bin/env bats
# Input that is no atlas: one clear line, exit code 3, and no file left behind.
load helpers

# ball: ball.nii, a good volume of 16^3 bytes at offset 352, to be damaged.
ball() {
    sphere --size 16
    gunzip -c sphere.nii.gz >ball.nii
    rm sphere.*
}

# poke FILE OFFSET BYTE...: overwrites bytes, given in hexadecimal.
poke() {
    local file=$1 offset=$2
    shift 2
    printf '%b' "$(printf '\\x%s' "$@")" | dd of="$file" bs=1 seek="$offset" conv=notrunc status=none
}

# refuses TEXT FILE: asserts that info and query of FILE as an atlas end in code 3 with a line that begins with its name
# and has TEXT in it, and leave no output.
refuses() {
    fails 3 "$2: $1" info "$2"
    fails 3 "$2: $1" query "$2" --origin 0,0,90 --toward 0,0,0 -o out.tsv --voxels voxels.tsv --voxels-of all
    [ ! -e out.tsv ] && [ ! -e out.json ] && [ ! -e voxels.tsv ]
    [ -z "$(find . -name '*.part')" ]
}

@test "the volume that the others are made from is good" {
    ball
    run -0 --separate-stderr "$CONUS" query ball.nii --origin 0,0,90 --toward 0,0,0 --angle 2 --quiet --format tsv
    [ "$(cell pixels 1)" = 3228 ]
}

@test "a file that is not there, a folder, a device" {
    refuses 'cannot open: No such file or directory' none.nii
    refuses 'no surfaces in this folder' .
    refuses 'cannot read: is a device or pipe, a regular file is needed' /dev/null
}

@test "a named pipe is refused at once, whatever it is to be; only poses and tables to compare wait for it" {
    ball
    mkfifo pipe.nii pipe.tsv pipe.obj pipe.tck pipe.txt pipe.atlas.json
    local aim=(--origin 0,0,90 --toward 0,0,0)
    for file in pipe.nii pipe.obj pipe.atlas.json; do
        refuses 'cannot read: is a device or pipe, a regular file is needed' $file
    done
    fails 3 'is a device or pipe' query ball.nii "${aim[@]}" --labels pipe.tsv
    fails 3 'is a device or pipe' query ball.nii "${aim[@]}" --pathway pipe.nii
    fails 3 'is a device or pipe' query ball.nii "${aim[@]}" --streamlines pipe.tck
    fails 3 'is a device or pipe' query ball.nii "${aim[@]}" --atlas-transform pipe.txt
    fails 3 'is a device or pipe' query ball.nii "${aim[@]}" --only @pipe.txt
    fails 3 'is a device or pipe' overlap ball.nii pipe.nii
}

# The limit on the stack is permanent for a shell's children, so each command runs in another shell.
@test "64 KB of stack are enough, and change no answer" {
    ball
    gzip -k ball.nii
    printf 'x\ty\tz\ttx\tty\ttz\n0\t0\t90\t0\t0\t0\n0\t9\t90\t0\t0\t0\n' >poses.tsv
    printf 'v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 2 0\nf 1 2 3 4 5\n' >polygon.obj
    for words in 'batch ball.nii --poses poses.tsv --angle 5 --threads 2' 'query ball.nii --pose poses.tsv --angle 5' \
        'query ball.nii.gz --pose poses.tsv --angle 5 --layers all' 'query polygon.obj --pose poses.tsv --angle 5'; do
        # shellcheck disable=SC2086 # words
        "$CONUS" $words --quiet -o wide.tsv
        # shellcheck disable=SC2086 # words
        (ulimit -s 64 && "$CONUS" $words --quiet -o narrow.tsv)
        cmp wide.tsv narrow.tsv
        rm wide.* narrow.*
    done
}

@test "an empty file, text, HTML" {
    : >empty.nii
    refuses 'content: the file is empty; needed is a labelled volume (NIfTI, MGH, NRRD, MetaImage, AFNI, TIFF, MINC, OME-Zarr), a surface, a folder' empty.nii
    : >empty.nii.gz
    refuses 'content: the file is empty; needed is a labelled volume (NIfTI, MGH, NRRD, MetaImage, AFNI, TIFF, MINC, OME-Zarr), a surface, a folder' empty.nii.gz
    gzip -c empty.nii >packed.nii.gz
    refuses 'content: the file unpacks to nothing: it is empty or cut off; needed is' packed.nii.gz
    echo 'just some text' >text.nii
    refuses 'content: found plain text, "just some text."; needed is a labelled volume' text.nii
    gzip -c text.nii >text.nii.gz
    refuses 'content: found plain text, packed by gzip; needed is a labelled volume' text.nii.gz
    echo '<!DOCTYPE html><html><body>404 Not Found</body></html>' >page.nii.gz
    refuses 'this is a web page; needed is a labelled volume' page.nii.gz
}

@test "a truncated file, plain and packed" {
    ball
    head -c 100 ball.nii >short.nii
    refuses 'header: found 100 bytes, NIfTI-1 needs 348' short.nii
    head -c 1000 ball.nii >short.nii
    refuses 'voxels: the file has 1000 bytes, the header asks for 4448' short.nii
    gzip -c ball.nii >whole.nii.gz
    head -c 150 whole.nii.gz >short.nii.gz
    refuses 'gzip: ' short.nii.gz
    gzip -c short.nii >short2.nii.gz
    refuses 'gzip: ' short2.nii.gz
}

@test "a damaged gzip stream" {
    ball
    gzip -c ball.nii >damaged.nii.gz
    poke damaged.nii.gz 120 ff ff ff ff
    refuses 'gzip: ' damaged.nii.gz
}

@test "impossible dimensions" {
    ball
    poke ball.nii 42 00 00
    refuses 'dim[1]: found 0, allowed is 1 or more' ball.nii
    poke ball.nii 42 ff ff
    refuses 'dim[1]: found -1, allowed is 1 or more' ball.nii
    poke ball.nii 40 08 00
    refuses 'dim[0]: found 8, allowed are 1 to 7' ball.nii
    poke ball.nii 40 03 00 ff 7f ff 7f ff 7f
    fails 3 'ball.nii: ' info ball.nii
}

@test "NIfTI-2 with 2^62 voxels along an edge" {
    head -c 544 /dev/zero >huge.nii
    poke huge.nii 0 1c 02 00 00 6e 2b 32 00 0d 0a 1a 0a 02 00 08 00
    poke huge.nii 16 03 00 00 00 00 00 00 00 00 00 00 00 00 00 00 40
    poke huge.nii 32 01 00 00 00 00 00 00 00 01 00 00 00 00 00 00 00
    poke huge.nii 168 20 02 00 00 00 00 00 00
    fails 3 'huge.nii: ' info huge.nii
}

@test "matrices that are singular or not finite" {
    ball
    poke ball.nii 280 00 00 00 00
    refuses 'sform, code 1 (scanner): the matrix is singular' ball.nii
    poke ball.nii 280 00 00 c0 7f
    refuses 'sform' ball.nii
    poke ball.nii 280 00 00 80 7f
    refuses 'sform' ball.nii
}

@test "datatypes that contradict themselves or mean no labels" {
    ball
    poke ball.nii 72 10 00
    refuses 'bitpix: found 16, datatype uint8 needs 8' ball.nii
    poke ball.nii 70 20 00 40 00
    refuses 'datatype: found 32 (complex64)' ball.nii
    poke ball.nii 70 d2 04
    refuses 'datatype: found 1234' ball.nii
}

@test "a voxel offset inside the header" {
    ball
    poke ball.nii 108 00 00 c8 42
    refuses 'vox_offset: found 100, allowed are whole numbers from' ball.nii
}

@test "labels with fractions, by value or by scale" {
    ball
    poke ball.nii 112 00 00 00 3f
    refuses 'voxel ' ball.nii
    head -c 352 ball.nii >float.nii
    head -c 16384 /dev/zero >>float.nii
    poke float.nii 70 10 00 20 00
    poke float.nii 112 00 00 80 3f
    poke float.nii 356 00 00 60 40
    refuses 'voxel (1, 0, 0): found 3.5' float.nii
}

@test "more memory than is allowed" {
    ball
    poke ball.nii 40 03 00 00 04 00 04 00 04
    { head -c 352 ball.nii; head -c 8M /dev/zero; } | gzip -1 >bomb.nii.gz
    fails 3 'bomb.nii.gz: ' info bomb.nii.gz
    fails 3 '536870912' info bomb.nii.gz --max-memory 512M
    ball
    fails 3 'ball.nii: file of 4448 bytes, allowed are 1024 (--max-memory)' info ball.nii --max-memory 1K
    # a label takes 2 bytes, whatever it takes in the file
    fails 3 'ball.nii: labels: found 4096 voxels, which take 2 bytes each, allowed are 5000 bytes (--max-memory)' \
        info ball.nii --max-memory 5000
}

@test "a small file that unpacks to 130 MB where the header asks for 4 kB" {
    ball
    { cat ball.nii; head -c 130M /dev/zero; } | gzip -1 >bomb.nii.gz
    refuses 'gzip: unpacks to more than the 4448 bytes that the header asks for' bomb.nii.gz
}

@test "label tables with garbage" {
    ball
    head -c 3000 /dev/zero | tr '\0' '\377' >garbage.txt
    fails 3 'garbage.txt: ' info ball.nii --labels garbage.txt
    echo 'nothing here' >garbage.txt
    fails 3 'garbage.txt: ' info ball.nii --labels garbage.txt
}

@test "poses that are none" {
    ball
    fails 3 'none.tsv: cannot open' query ball.nii --pose none.tsv
    : >poses.tsv
    fails 3 'poses.tsv: no poses' query ball.nii --pose poses.tsv
    printf 'a\tb\n1\t2\n' >poses.tsv
    fails 3 'poses.tsv: ' query ball.nii --pose poses.tsv
    printf 'x\ty\tz\ttx\tty\ttz\n0\t0\tnan\t0\t0\t0\n' >poses.tsv
    run -1 --separate-stderr "$CONUS" query ball.nii --pose poses.tsv --quiet --format tsv
    check_message 'poses.tsv:2: '
    printf '1 0 0 0\n0 1 0 0\n0 0 -1 0\n0 0 0 1\n' >matrix.txt
    run -1 --separate-stderr "$CONUS" query ball.nii --pose matrix.txt --quiet --format tsv
    check_message 'matrix.txt:1: pose matrix: left-handed'
}

@test "cones that are none" {
    ball
    fails 2 'direction: 0,0,0, allowed are finite numbers that are not all 0' \
        query ball.nii --quiet --origin 0,0,90 --direction 0,0,0
    fails 2 'toward: is the origin itself' query ball.nii --quiet --origin 0,0,90 --toward 0,0,90
    fails 2 'parallel to the direction' query ball.nii --quiet --origin 0,0,90 --toward 0,0,0 --up 0,0,1
    fails 2 'up: 0,0,0' query ball.nii --quiet --origin 0,0,90 --toward 0,0,0 --up 0,0,0
}

@test "MINC: its labels come through scales; a file that lies, an image, colours, MINC 1" {
    [ -x "${CONUS_HDF5:-${CONUS%/*}/conus-hdf5}" ] || skip 'no conus-hdf5'
    local make=(/usr/bin/python3 "$BATS_TEST_DIRNAME/hdf5.py")
    "${make[@]}" minc box.mnc || skip 'no python3-h5py'
    "${make[@]}" image image.mnc
    "${make[@]}" colour colour.mnc
    answers query box.mnc --origin 0,0,100 --radius 1 --toward 0,0,0 --format tsv -q
    output=$(conus info box.mnc --format tsv 2>err)
    [ "$(grep -c '^area' <<<"$output")" -eq 2 ]
    [ "$(cell index 1)/$(cell voxels 1)/$(cell index 2)/$(cell voxels 2)" = 1/7000/3/1000 ]
    output=$(conus info box.mnc --pathway image.mnc,threshold=5e-5 --format tsv 2>err)
    [ "$(cell kind 3)/$(cell voxels 3)" = pathway/4000 ]
    refuses 'dimorder: found vector_dimension of 20, allowed are xspace, yspace and zspace, and one time' colour.mnc
    gzip -k box.mnc
    refuses 'content: HDF5 packed with gzip: unpack it' box.mnc.gz
    printf 'CDF\1 and more' >one.mnc
    refuses 'this is a MINC-1 volume: convert it to MINC 2 (mincconvert -2); needed is' one.mnc
    "${make[@]}" simnibs coil.mat
    refuses 'HDF5, but no volume of MINC: there is no /minc-2.0/image/0/image' coil.mat
    head -c 9000 box.mnc >cut.mnc
    refuses 'HDF5: cannot open it: ' cut.mnc
    ball # an affine of FSL needs the volume for its placement only
    printf '1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n' >flirt.mat
    conus query ball.nii --atlas-transform flirt.mat,from=ball.nii,to=box.mnc --origin 0,0,90 --toward 0,0,0 \
        --angle 5 --quiet -o moved.tsv
    CONUS_HDF5=$PWD/none fails 3 'box.mnc: CONUS_HDF5: ' info box.mnc
    # 400 chunks of 20 MB of 8,000 elements of 2 bytes each, where none is stored; and a chunk that says that it has 3 GB,
    # for which libhdf5 asks before it looks whether the file has so much
    "${make[@]}" chunks chunks.mnc
    refuses '/minc-2.0/image/0/image: 400 chunks of 20000000 bytes, far larger than its 8000 elements' chunks.mnc
    "${make[@]}" heap heap.mnc
    refuses '/minc-2.0/image/0/image: cannot read it: memory allocation failed' heap.mnc
    fails 3 'box.mnc: ' info box.mnc --max-memory 10000
}

@test "truncated at every 97th byte, AAL is refused without a crash" {
    need_aal
    for size in $(seq 1 9700 160000) $(seq 1 97 1000); do
        head -c "$size" "$aal" >cut.nii.gz
        fails 3 'cut.nii.gz: ' info cut.nii.gz
    done
}

# store SHAPE CHUNK CODECS: store.zarr, an array of uint8 without chunks, of which c/0/0/0 is the first.
store() {
    rm -rf store.zarr
    mkdir -p store.zarr/c/0/0
    printf '{"zarr_format": 3, "node_type": "array", "shape": %s, "data_type": "uint8", "chunk_grid": {"name": "regular",
        "configuration": {"chunk_shape": %s}}, "chunk_key_encoding": {"name": "default"}, "fill_value": 0,
        "codecs": %s}' "$1" "$2" "$3" >store.zarr/zarr.json
}

PLACE=,resolution=1000,orientation=asr

# no_store TEXT: asserts that info of store.zarr ends in code 3 with one line that has TEXT in it.
no_store() {
    fails 3 "$1" info "store.zarr$PLACE"
}

@test "OME-Zarr: sizes that multiply beyond 2^63, and JSON of 16 MiB" {
    store '[2147483647, 2147483647, 2147483647]' '[2, 2, 2]' '["bytes"]'
    no_store 'chunk_shape: more than 2^31 chunks'
    store '[2147483647, 2147483647, 2147483647]' '[2147483647, 2147483647, 2147483647]' '["bytes"]'
    no_store 'or a chunk of more than 2^62 bytes'
    store '[1048576, 1048576, 1048576]' '[1048576, 1048576, 1048576]' '["bytes"]'
    no_store 'voxels'
    store '[1048576, 1048576, 1]' '[1048576, 1048576, 1]' '["bytes"]'
    no_store 'labels: found 1099511627776 voxels, which take 2 bytes each, allowed are 8589934592 bytes (--max-memory)'
    head -c 16777217 /dev/zero >store.zarr/zarr.json
    no_store 'zarr.json: file of 16777217 bytes, allowed are 16777216'
    head -c 16777216 /dev/zero | tr '\0' '[' >store.zarr/zarr.json
    no_store 'JSON text of 16777216 bytes that would take'
}

@test "OME-Zarr: chunks that unpack to too much, are of another size, or no files" {
    store '[2, 2, 2]' '[2, 2, 2]' '["bytes", "zstd"]'
    head -c 67108864 /dev/zero | zstd -q -c >store.zarr/c/0/0/0
    no_store 'c/0/0/0: damaged, or not the 8 bytes of a chunk'
    store '[2, 2, 2]' '[2, 2, 2]' '["bytes", "gzip"]'
    head -c 67108864 /dev/zero | gzip -1 >store.zarr/c/0/0/0
    no_store 'c/0/0/0: damaged, or not the 8 bytes of a chunk'
    store '[2, 2, 2]' '[2, 2, 2]' '["bytes"]'
    truncate -s 9G store.zarr/c/0/0/0
    no_store 'c/0/0/0: file of 9663676416 bytes, allowed are 8589934592 (--max-memory)'
    printf 1234567 >store.zarr/c/0/0/0
    no_store 'c/0/0/0: damaged, or not the 8 bytes of a chunk'
    rm store.zarr/c/0/0/0
    no_store 'no chunk of this array is there: it was not downloaded'
    mkfifo store.zarr/c/0/0/0
    no_store 'c/0/0/0: cannot read: is a device or pipe'
    # a voxel a file: each would be looked for, 162 x 161 x 161 are just more than 2^22
    store '[162, 161, 161]' '[1, 1, 1]' '["bytes"]'
    no_store 'chunk_shape: 4199202 files of chunks, allowed are 4194304'
    # 8 chunks of 200 MB stand for 8 bytes: no more than 256 MB and 16 times the array are unpacked
    store '[2, 2, 2]' '[1, 1, 200000000]' '["bytes", "gzip"]'
    no_store 'chunk_shape: chunks of 200000000 bytes, 800000000 in all, far larger than the array of 8'
}

@test "OME-Zarr: chunks of a shard over each other, and outside of it" {
    local codecs='[{"name": "sharding_indexed", "configuration": {"chunk_shape": [1, 2, 2], "codecs": ["bytes"],
        "index_codecs": [{"name": "bytes", "configuration": {"endian": "little"}}]}}]'
    local zeros='\0\0\0\0\0\0\0'
    store '[2, 2, 2]' '[2, 2, 2]' "$codecs"
    shard() { # FROM SIZE FROM SIZE, in octal
        printf "1111%b\\$1$zeros\\$2$zeros\\$3$zeros\\$4$zeros" '\2\2\2\2' >store.zarr/c/0/0/0
    }
    shard 0 4 4 4
    run -0 --separate-stderr "$CONUS" info "store.zarr$PLACE" --format tsv
    shard 0 4 3 4
    no_store 'a chunk of 4 bytes from byte 0 on lies outside of the file, or over another or the index'
    shard 0 4 10 4 # reaches over the index
    no_store 'a chunk of 4 bytes from byte 8 on lies outside'
    shard 0 4 70 4 # 56 bytes, but the file has 40
    no_store 'a chunk of 4 bytes from byte 56 on lies outside'
}

@test "OME-Zarr: a missing chunk has the fill value, or is an error where there is none; others mean nothing" {
    mkdir two.zarr
    echo '{"zarr_format": 2, "shape": [2, 2, 2], "chunks": [1, 2, 2], "dtype": "|u1", "order": "C", "compressor": null,
        "fill_value": null}' >two.zarr/.zarray
    printf 1111 >two.zarr/0.0.0
    printf 9999 >two.zarr/2.0.0 # the array has no such row
    fails 3 'two.zarr/1.0.0: is not there, and fill_value does not say what it holds' info two.zarr$PLACE
    sed -i 's/"fill_value": null/"fill_value": 50/' two.zarr/.zarray
    run -0 --separate-stderr "$CONUS" info two.zarr$PLACE
    grep -q '1 of 2 chunks are there: the others count as the fill value' <<<"$output$stderr"
    grep -q '2 areas' <<<"$output"
}
