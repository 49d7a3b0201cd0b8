#!/usr/bin/env bats
# SPDX-License-Identifier: BSD-3-Clause
# The cache of atlases: it changes no answer, and --no-cache, $CONUS_CACHE and conus cache work as documented.

load helpers

AIM=(--origin=-90,20,20 --toward=0,-10,10 --angle 20)

own_cache() {
    export XDG_CACHE_HOME=$PWD/cache
    unset CONUS_CACHE
}

entries() {
    find cache -name '*.atlas' 2>/dev/null | wc -l
}

# is_kept: files that changed within the last two seconds are not kept.
is_kept() {
    are_kept 1 "$@"
}

# are_kept N ARGUMENT...: asserts that there are at least N entries.
are_kept() {
    "$CONUS" query "${@:2}" > /dev/null
    [ "$(entries)" -ge "$1" ]
}

@test "a page is the same with and without the cache" {
    local atlas=$TEMPLATES/aal.nii.gz
    [ -e "$atlas" ] || skip "no $atlas"
    own_cache
    echo '<!-- atlas -->' >template.html
    "$CONUS" page "$atlas" --template template.html -o first.html -q
    is_kept "$atlas" "${AIM[@]}"
    "$CONUS" page "$atlas" --template template.html -o second.html -q
    cmp first.html second.html
}

@test "answers are the same from the cache" {
    local atlas=$TEMPLATES/aal.nii.gz
    [ -e "$atlas" ] || skip "no $atlas"
    own_cache
    CONUS_CACHE=off "$CONUS" query "$atlas" "${AIM[@]}" --layers all --format json > without
    [ "$(entries)" = 0 ]
    "$CONUS" query "$atlas" "${AIM[@]}" --layers all --format json > first
    [ "$(entries)" = 1 ]
    "$CONUS" query "$atlas" "${AIM[@]}" --layers all --format json > second
    [ "$(entries)" = 1 ]
    cmp without first
    cmp without second
    CONUS_CACHE=off "$CONUS" info "$atlas" --format json > without
    "$CONUS" info "$atlas" --format json > second
    cmp without second
    # Options that change the atlas after it was attached: the voxels are copied then.
    for how in "--hemispheres merged" "--hide Precentral_L" "--level 1" "--context $TEMPLATES/ch2.nii.gz --context-blocks 90" \
        "--pathway $TEMPLATES/ch2.nii.gz,threshold=100"; do
        # shellcheck disable=SC2086
        CONUS_CACHE=off "$CONUS" query "$atlas" "${AIM[@]}" $how > without 2>&1 || true
        # shellcheck disable=SC2086
        "$CONUS" query "$atlas" "${AIM[@]}" $how > second 2>&1 || true
        cmp without second
    done
}

@test "conus cache lists, says where, and clears" {
    local atlas=$TEMPLATES/aal.nii.gz
    [ -e "$atlas" ] || skip "no $atlas"
    own_cache
    run -0 "$CONUS" cache where
    [ "$output" = "$PWD/cache/conus" ]
    run -0 "$CONUS" cache list
    [ "$output" = "0 entries, 0 bytes, in $PWD/cache/conus" ]
    "$CONUS" query "$atlas" "${AIM[@]}" --no-cache > /dev/null
    [ "$(entries)" = 0 ]
    "$CONUS" query "$atlas" "${AIM[@]}" > /dev/null
    run -0 "$CONUS" cache list
    [[ $output == *"$(realpath "$atlas")"* ]]
    [[ $output == *"1 entry, $(stat -c %s cache/conus/*.atlas) bytes, in $PWD/cache/conus"* ]]
    [ "$("$CONUS" cache list --format tsv | cut -f 1,4 | tail -n 1)" = "atlas	$(realpath "$atlas")" ]
    touch -a -d @1700000000 cache/conus/*.atlas # used then, and not by being listed
    "$CONUS" cache list >first
    "$CONUS" cache list | cmp - first
    [ "$(stat -c %X cache/conus/*.atlas)" = 1700000000 ]
    for word in clear where; do
        run -2 "$CONUS" cache $word --format tsv
        [[ $output == *"--format has no effect without list"* ]]
    done
    [ "$(entries)" = 1 ]
    # The entry is the same however the path was written.
    (cd "$TEMPLATES" && XDG_CACHE_HOME=$OLDPWD/cache "$CONUS" query ./aal.nii.gz "${AIM[@]}" > /dev/null)
    [ "$(entries)" = 2 ]
    [ "$("$CONUS" cache list --format tsv | cut -f 1,4 | tail -n +2 | sort -u)" = "atlas	$(realpath "$atlas")" ]
    run -0 "$CONUS" cache clear
    [ "$(entries)" = 0 ]
    CONUS_CACHE=off run -0 "$CONUS" cache list
    [[ $output == *"atlases are not kept, and not taken from here"* ]]
    CONUS_CACHE=12x run -0 --separate-stderr "$CONUS" cache list
    [[ $stderr == *'CONUS_CACHE is not off, or a number of bytes with K, M, G, T or nothing behind it' ]]
    CONUS_CACHE=12x run -0 "$CONUS" cache clear
    run -2 "$CONUS" cache
    run -2 "$CONUS" cache empty
    [[ $output == *"list, where or clear"* ]]
}

@test "a cache that others can write to is neither read nor cleared" {
    own_cache
    mkdir -p cache/conus
    chmod 777 cache/conus
    run -0 --separate-stderr "$CONUS" cache list
    [[ $stderr == *"others can write to the folder"* ]]
    run -3 "$CONUS" cache clear
    [[ $output == *"not cleared"* ]]
}

@test "a file that changes is read again; without a home nothing is said" {
    own_cache
    "$CONUS" phantom sphere -o phantom
    wait_until $$ is_kept phantom/sphere.nii.gz "${AIM[@]}"
    "$CONUS" query phantom/sphere.nii.gz "${AIM[@]}" > before
    printf '1\tRenamed\n' > phantom/other.tsv
    cp phantom/other.tsv phantom/sphere.tsv
    "$CONUS" query phantom/sphere.nii.gz "${AIM[@]}" > cached
    "$CONUS" query phantom/sphere.nii.gz "${AIM[@]}" --no-cache > without
    cmp cached without
    run -0 --separate-stderr env -u HOME XDG_CACHE_HOME=relative "$CONUS" query phantom/sphere.nii.gz "${AIM[@]}" --quiet
    [ -z "$stderr" ]
    [ ! -e relative ]
    run -3 --separate-stderr env -u HOME XDG_CACHE_HOME=relative "$CONUS" cache where
    [ "$output$stderr" = 'conus: there is no folder: neither XDG_CACHE_HOME nor HOME is an absolute path' ]
    run -0 --separate-stderr env -u HOME XDG_CACHE_HOME=relative "$CONUS" cache list
    [ "$output" = '0 entries, 0 bytes' ]
    [ "$stderr" = 'conus: note: nothing is kept, since neither XDG_CACHE_HOME nor HOME is an absolute path' ]
}

@test "a store of Zarr is kept, and read again when a chunk comes" {
    own_cache
    mkdir two.zarr
    echo '{"zarr_format": 2, "shape": [2, 2, 2], "chunks": [1, 2, 2], "dtype": "|u1", "order": "C", "compressor": null,
        "fill_value": 0}' > two.zarr/.zarray
    printf 1111 > two.zarr/0.0.0
    local store=two.zarr,resolution=1000,orientation=asr
    wait_until "$BASHPID" is_kept $store --origin=-1,-1,3 --direction=0,0,-1
    "$CONUS" info $store --format json > second
    CONUS_CACHE=off "$CONUS" info $store --format json > without
    cmp without second
    grep -q '1 of 2 chunks are there' second
    printf 2222 > two.zarr/1.0.0
    "$CONUS" info $store --format json > third
    grep -q '"index": 50' third
}

# A folder of TRX: four streamlines of two points, of which two are in a group.
make_trx() {
    /usr/bin/python3 - "$1" <<'END'
import array, os, sys
os.makedirs(sys.argv[1] + "/groups")
def put(name, kind, values):
    with open(sys.argv[1] + "/" + name, "wb") as file:
        array.array(kind, values).tofile(file)
with open(sys.argv[1] + "/header.json", "w") as file:
    file.write('{"NB_STREAMLINES": 4, "NB_VERTICES": 8, "DIMENSIONS": [9, 9, 9],'
               '"VOXEL_TO_RASMM": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}')
put("positions.3.float32", "f", [c for i in range(4) for p in ((-20, i, i), (20 + i, -i, 2 * i)) for c in p])
put("offsets.uint64", "Q", [0, 2, 4, 6, 8])
put("groups/Some.uint32", "I", [1, 3])
END
}

# same_answers OPTION...: rows and notes with the cache, without it, and with the entry that was made are the same.
same_answers() {
    local command
    for command in "query phantom/sphere.nii.gz ${AIM[*]} --layers all --format json" \
        "info phantom/sphere.nii.gz --format json" "connect phantom/sphere.nii.gz --format json"; do
        # shellcheck disable=SC2086
        CONUS_CACHE=off "$CONUS" $command "$@" > without 2> notes-without
        for round in first second; do
            # shellcheck disable=SC2086
            "$CONUS" $command "$@" > with 2> notes-with
            cmp with without
            cmp notes-with notes-without
        done
    done
}

@test "streamlines of the command line are kept, whatever their name and radius; answers and notes are the same" {
    own_cache
    "$CONUS" phantom sphere -o phantom
    python3 "$BATS_TEST_DIRNAME/tck.py" walk.tck -30,0,0 0,3,0 30,0,0 -- 5,5,5 -- 0,0,-40 1,0,40 # a streamline of one point
    make_trx lines.trx
    wait_until "$BASHPID" are_kept 3 phantom/sphere.nii.gz --streamlines walk.tck --streamlines lines.trx "${AIM[@]}"
    [ "$(entries)" = 3 ]
    same_answers --streamlines walk.tck
    same_answers --streamlines lines.trx,radius=2,name=Rest --streamlines walk.tck,radius=1,name=Lines
    same_answers --streamlines "$PWD/./lines.trx"
    printf '1 0 0 4\n0 1 0 0\n0 0 0.9 0\n0 0 0 1\n' > shear.txt
    same_answers --streamlines lines.trx,moves --streamlines walk.tck --atlas-transform shear.txt
    [ "$(entries)" = 5 ] # one entry is for another path, and one for info, which has a context
    [ "$("$CONUS" cache list --format tsv | cut -f 4 | sort -u | grep -Ec '(lines|walk)\.t')" -ge 2 ]
    fails 2 'radius 101 mm, allowed is above 0 to 100' \
        query phantom/sphere.nii.gz "${AIM[@]}" --streamlines walk.tck,radius=101
    python3 "$BATS_TEST_DIRNAME/tck.py" walk.tck -30,0,0 30,0,0
    same_answers --streamlines walk.tck
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

# An entry of far.tck has 1.7 MB, 1.2 of these for points; that is more than a quarter of 4 MiB.
@test "a sample of many points may show that they lie well; otherwise all are counted" {
    "$CONUS" phantom sphere -o phantom
    # rows: points inside, note. 59,000 are above the limit, a half, but no sample can tell that for sure.
    while read -r inside note; do
        far "$inside"
        run -0 --separate-stderr "$CONUS" query phantom/sphere.nii.gz "${AIM[@]}" --streamlines far.tck
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

@test "the environment must say off or a size, but only where the cache is used" {
    own_cache
    "$CONUS" phantom sphere -o phantom
    export CONUS_CACHE=12x
    fails 2 'CONUS_CACHE: "12x"; allowed is off, or a number of bytes with K, M, G, T or nothing behind it' \
        query phantom/sphere.nii.gz "${AIM[@]}"
    run -0 "$CONUS" query phantom/sphere.nii.gz "${AIM[@]}" --no-cache
}
