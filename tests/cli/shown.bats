#!/usr/bin/env bats
# --only and --hide, as a user types them.
load helpers

# nested.nii.gz: a ball of three shells, with a tree over them. Outer reaches to 24 mm, Inner to 16, Core to 8.
nested() {
    conus phantom nested -o .
    printf 'index\tname\tabbreviation\tparent_id\n' >tree.tsv
    printf '1\tOuter, the\tO\t20\n300\tInner\tI\t20\n20\tShell\tS\t40\n4000000001\tCore\tC\t40\n40\tBall\tB\tn/a\n' >>tree.tsv
    atlas=(nested.nii.gz --labels tree.tsv)
    cone=(--origin 0,-100,0 --toward 0,0,0 --angle 4)
    view=(query "${atlas[@]}" "${cone[@]}" --format tsv -q)
}

# near VALUE WANTED: within a voxel of 1 mm.
near() {
    awk -v a="$1" -v b="$2" 'BEGIN { exit !(a - b < 1 && b - a < 1) }' || { echo "$1, wanted $2"; return 1; }
}

@test "a hidden area is not hit and blocks nothing" {
    nested
    answers "${view[@]}"
    [ "$(cell name 1)" = "Outer, the" ]
    near "$(cell distance_mm 1)" 76
    answers "${view[@]}" --hide '"Outer, the"'
    [ "$(cell name 1)" = Inner ]
    near "$(cell distance_mm 1)" 84
    answers "${view[@]}" --hide Shell
    [ "$(cell name 1)" = Core ]
    near "$(cell distance_mm 1)" 92
    core=$output
    for names in core C 4000000001; do
        answers "${view[@]}" --only "$names"
        [ "$output" = "$core" ]
    done
    answers "${view[@]}" --hide O --hide I
    [ "$output" = "$core" ]
    answers "${view[@]}" --only Ball --hide O,I
    [ "$output" = "$core" ]
    printf '# shells\n\nOuter, the\nInner\n' >list.txt
    answers "${view[@]}" --hide @list.txt
    [ "$output" = "$core" ]
}

@test "volumes and fractions of shown areas stay" {
    nested
    view=(query "${atlas[@]}" --origin 0,-100,0 --toward 0,0,0 --angle 60 --layers all --format tsv -q)
    answers "${view[@]}"
    local volume fraction
    volume=$(cell volume_mm3 3) fraction=$(cell fraction 3)
    [ "$(cell name 3)" = Core ]
    answers "${view[@]}" --only Core
    [ "$(cell volume_mm3 1)/$(cell fraction 1)/$(cell cone_fraction 1)" = "$volume/$fraction/1" ]
    [ "$(cell name 2)" = unassigned ]
}

@test "what cannot be shown or hidden is explained" {
    nested
    fails 2 'only: no area has the name, abbreviation or label "Cor"; did you mean "Core"?' "${view[@]}" --only Cor
    fails 2 'hide: no area has the name, abbreviation or label "Outer"; did you mean "Outer, the"? Names with commas are put in double quotes' \
        "${view[@]}" --hide 'Outer, the'
    fails 2 'everything is hidden: nothing is left' "${view[@]}" --hide Ball
    fails 2 'everything is hidden: nothing is left' "${view[@]}" --only Core --hide Ball
    fails 3 nowhere.txt "${view[@]}" --only @nowhere.txt
    echo Core >list.txt
    fails 2 "--output list.txt would overwrite the input list.txt" "${view[@]}" --only @list.txt -o list.txt
}

@test "tables, sidecars and pictures say what is hidden" {
    nested
    answers query "${atlas[@]}" "${cone[@]}" -q --hide Shell
    has 'shown: only Core'
    answers "${view[@]}" -o rows.tsv --image seen.exr
    not grep -q '"hidden"' rows.json
    not grep -aq conus:hidden seen.exr
    answers "${view[@]}" --hide Inner --force -o rows.tsv --image seen.exr --layers all
    grep -q '"hidden": "areas 300"' rows.json
    grep -aq 'conus:hidden' seen.exr
    grep -aq 'areas 300' seen.exr
}

@test "a point, a mask, a sweep and a track do without what is hidden" {
    nested
    answers query "${atlas[@]}" --point 0,-12,0 --radius 1 --format tsv -q
    [ "$(cell name 1)/$(cell distance_mm 1)" = Inner/0 ]
    answers query "${atlas[@]}" --point 0,-12,0 --radius 1 --format tsv -q --hide Inner
    [ "$(cell name 1)" = unassigned ]
    fails 2 'Inner is hidden' "${view[@]}" --hide Inner --mask part.nii.gz --mask-object Inner
    answers sweep "${atlas[@]}" "${cone[@]}" --format tsv -q --hide Shell
    [ "$(cell name 1)/$(cell name 2)" = Core/ ]
    answers sweep "${atlas[@]}" "${cone[@]}" --jitter 1,1 --samples 16 --format tsv -q --only Core
    [ "$(cell name 1)/$(cell name 2)" = Core/unassigned ]
    printf 'time_s\tx\ty\tz\ttx\tty\ttz\n0\t0\t-100\t0\t0\t0\t0\n' >hand.tsv
    answers track "${atlas[@]}" --poses hand.tsv --format tsv -q --only Core
    [ "$(cell name 1)/$(cell name 2)" = Core/unassigned ]
}

@test "a batch answers and joins only what hides the same" {
    nested
    printf 'x\ty\tz\ttx\tty\ttz\n' >poses.tsv
    printf '0\t-100\t0\t0\t0\t0\n0\t0\t100\t0\t0\t0\n' >>poses.tsv
    local of=(batch "${atlas[@]}" --poses poses.tsv --angle 4 -q)
    answers "${of[@]}" --hide Shell --force -o rows.tsv
    output=$(cat rows.tsv)
    [ "$(cell name 1)/$(cell name 3)" = Core/Core ]
    answers "${of[@]}" --shard 1/2 --only Core -o joined.tsv
    fails 3 'joined.1-of-2.tsv: there is a file already, of other' "${of[@]}" --shard all/2 --hide Inner -o joined.tsv
    answers "${of[@]}" --shard all/2 --hide Shell -o joined.tsv
    cmp joined.tsv rows.tsv
}

@test "pathways are shown and hidden, too" {
    conus phantom tubes -o .
    conus phantom sphere -o .
    answers query sphere.nii.gz --pathway tubes.nii.gz,name=Tract,threshold=1 --origin 0,-100,0 --toward 0,0,0 --format tsv -q
    [ "$(awk -F'\t' '$2 == "pathway"' <<<"$output" | wc -l)" -eq 1 ]
    answers query sphere.nii.gz --pathway tubes.nii.gz,name=Tract,threshold=1 --origin 0,-100,0 --toward 0,0,0 --format tsv -q --hide tract
    with=$output
    answers query sphere.nii.gz --origin 0,-100,0 --toward 0,0,0 --format tsv -q
    [ "$output" = "$with" ]
    answers query sphere.nii.gz --pathway tubes.nii.gz,name=Tract,threshold=1 --origin 0,-100,0 --toward 0,0,0 -q --only Sphere
    [[ "$output" != *"pathway Tract"* ]]
}

@test "a picture does without what is hidden, as if it were not in the file" {
    nested
    gl render "${atlas[@]}" -o all.exr --size 160x120 --slices 60 -q
    gl render "${atlas[@]}" -o core.exr --size 160x120 --slices 60 --only Core -q
    gl render "${atlas[@]}" -o shells.exr --size 160x120 --slices 60 --hide Shell -q
    answers diff core.exr shells.exr
    run -1 conus diff all.exr core.exr
    grep -aq 'areas 1,300' core.exr
    gl render "${atlas[@]}" -o cone.png --size 160x120 --slices 60 --only Core -q --origin 0,-100,0 --toward 0,0,0
    fails 2 'everything is hidden' render "${atlas[@]}" -o none.png --hide Ball
}
