#!/usr/bin/env bats
# SPDX-License-Identifier: BSD-3-Clause
# The cache of atlases: answers are the same with it, and --no-cache, $CONUS_CACHE and conus cache do what they say.

load helpers

AIM=(--origin=-90,20,20 --toward=0,-10,10 --angle 20)

own_cache() {
    export XDG_CACHE_HOME=$PWD/cache
    unset CONUS_CACHE
}

entries() {
    find cache -name '*.atlas' 2>/dev/null | wc -l
}

# Files that changed within the last two seconds are not kept.
is_kept() {
    "$CONUS" query "$@" > /dev/null
    [ "$(entries)" -gt 0 ]
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
    # What is done to it afterwards: the voxels are copied then.
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
    [[ $output == *"$atlas"* ]]
    [[ $output == *"1 entry, $(stat -c %s cache/conus/*.atlas) bytes, in $PWD/cache/conus"* ]]
    [ "$("$CONUS" cache list --format tsv | cut -f 1,4 | tail -n 1)" = "atlas	$atlas" ]
    run -0 "$CONUS" cache clear
    [ "$(entries)" = 0 ]
    CONUS_CACHE=off run -0 "$CONUS" cache list
    [[ $output == *"no atlas is kept"* ]]
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
}

@test "what is neither off nor a size is refused, but not where no cache is asked for" {
    own_cache
    "$CONUS" phantom sphere -o phantom
    export CONUS_CACHE=12x
    fails 2 'CONUS_CACHE: "12x"; allowed is off, or a number of bytes with K, M, G, T or nothing behind it' \
        query phantom/sphere.nii.gz "${AIM[@]}"
    run -0 "$CONUS" query phantom/sphere.nii.gz "${AIM[@]}" --no-cache
}
