#!/usr/bin/env bats
# --level, as a user types it.
load helpers

# nested.nii.gz: a ball of three shells, with a tree over them.
nested() {
    conus phantom nested -o .
    printf 'index\tname\tabbreviation\tparent_id\n' >tree.tsv
    printf '1\tOuter, the\tO\t20\n300\tInner\tI\t20\n20\tShell\tS\t40\n4000000001\tCore\tC\t40\n40\tBall\tB\tn/a\n' >>tree.tsv
    view=(query nested.nii.gz --labels tree.tsv --origin 0,-100,0 --toward 0,0,0 --angle 30 --resolution 16 --format tsv -q)
}

@test "a depth and a list give the same union" {
    nested
    answers "${view[@]}" --layers all --level 2
    [ "$(cell name 1)/$(cell index 1)/$(cell pixels 1)/$(cell pierced 1)" = Shell/20/180/180 ]
    [ "$(cell name 2)/$(cell pierced 2)" = Core/16 ]
    depth=$output
    answers "${view[@]}" --layers all --level Shell
    [ "$output" = "$depth" ]
    answers "${view[@]}" --layers all --level '"20"'
    [ "$output" = "$depth" ]
    printf '# my areas\n\nshell\r\n' >list.txt
    answers "${view[@]}" --layers all --level @list.txt
    [ "$output" = "$depth" ]
    answers "${view[@]}" --level 1
    [ "$(cell name 1)/$(cell name 2)" = Ball/unassigned ]
}

@test "names with commas are quoted" {
    nested
    answers "${view[@]}" --level '"Outer, the",B'
    [ "$(cell name 1)" = "Outer, the" ]
    fails 2 '"Outer"; did you mean "Outer, the"? Names with commas are put in double quotes' "${view[@]}" --level 'Outer, the'
    fails 2 'the closing quote is missing' "${view[@]}" --level '"Outer, the'
}

@test "a prior is of areas that have rows" {
    nested
    printf 'name,prior\nShell,5\n' >prior.csv
    fails 3 'prior.csv: line 2: Shell has no row of its own at this level' "${view[@]}" --weight hard --prior prior.csv
    fails 3 'Shell has no row of its own at this level' "${view[@]}" --weight hard --prior prior.csv --level 1
    answers "${view[@]}" --weight hard --prior prior.csv --level 2
    [ "$(cell name 1)" = Shell ]
    printf 'name,prior\nBall,5\n' >prior.csv
    fails 3 'Ball has no row of its own at this level' "${view[@]}" --weight hard --prior prior.csv --level 2
    printf 'name,prior\n"Outer, the",5\n' >prior.csv
    answers "${view[@]}" --weight hard --prior prior.csv
    fails 3 'Outer, the has no row of its own' "${view[@]}" --weight hard --prior prior.csv --level 2
}

@test "a mistyped level is explained" {
    nested
    fails 2 'level: no area has the name, abbreviation or label "Shel"; did you mean "Shell"?' "${view[@]}" --level Shel
    fails 2 'level: depth 4, the area tree has depths 1 to 3' "${view[@]}" --level 4
    fails 2 'level: depth 0, the area tree has depths 1 to 3' "${view[@]}" --level 0
    fails 2 'an area is missing' "${view[@]}" --level Shell,
    fails 3 'nowhere.txt' "${view[@]}" --level @nowhere.txt
    printf 'Shell\nCoree\n' >list.txt
    fails 2 'list.txt: line 2: no area has the name, abbreviation or label "Coree"; did you mean "Core"?' \
        "${view[@]}" --level @list.txt
    fails 2 '--level' render nested.nii.gz -o view.png --level 2
    nothing_left nested.json nested.nii.gz nested.tsv tree.tsv list.txt
}

@test "the list of areas is not overwritten" {
    nested
    echo Shell >list.txt
    printf 'time_s\tx\ty\tz\ttx\tty\ttz\n0\t0\t-100\t0\t0\t0\t0\n' >hand.tsv
    local said='--output list.txt would overwrite the input list.txt'
    local of=(nested.nii.gz --labels tree.tsv --level @list.txt)
    fails 2 "$said" "${view[@]}" --level @list.txt -o list.txt
    fails 2 "$said" batch "${of[@]}" --poses hand.tsv --format tsv -o list.txt --force
    fails 2 "$said" sweep "${of[@]}" --origin 0,-100,0 --toward 0,0,0 --angles 10 -o list.txt
    fails 2 "$said" track "${of[@]}" --poses hand.tsv -o list.txt
    ln -s list.txt listed.json
    fails 2 'the .json beside --output listed.json would overwrite the input list.txt' \
        sweep "${of[@]}" --origin 0,-100,0 --toward 0,0,0 -o listed.tsv
    [ "$(cat list.txt)" = Shell ]
}

@test "info shows the tree" {
    nested
    answers info nested.nii.gz --labels tree.tsv
    has 'area tree of 3 depths; --format tree shows it'
    answers info nested.nii.gz --labels tree.tsv --format json
    tr -d ' \n' <<<"$output" | grep -q '"index":1,"name":"Outer,the","named":true,"abbreviation":"O","hemisphere":null,"parent":20,"depth":3'
    run -0 --separate-stderr "$CONUS" info nested.nii.gz --labels tree.tsv --format tree
    [ "${#lines[@]}" -eq 6 ]
    grep -qE '^ +1 +40 +4 +57856  Ball \(B\)$' <<<"$output"
    grep -qE '^ +2 +20 +2 +[0-9]+    Shell \(S\)$' <<<"$output"
    grep -qE '^ +3 +1 +0 +[0-9]+      Outer, the \(O\)$' <<<"$output"
    need_aal
    run -0 --separate-stderr "$CONUS" info "$aal" --format tree --hemispheres merged
    [ "${#lines[@]}" -eq 171 ]
    grep -qE '^ +1 +3001 +2 +55232  Precentral$' <<<"$output"
    grep -qE '^ +1 +1 +0 +28174    Precentral_L$' <<<"$output"
}

@test "an atlas without a tree says so" {
    need_aal
    fails 2 'level: the atlas has no area tree: none of its 116 areas is part of another' \
        query "$aal" --origin -90,20,20 --toward 0,-10,10 --level 2
}

@test "the sidecar tells the level" {
    nested
    answers "${view[@]}" --level 2 -o answer.tsv
    grep -q '"level": "2"' answer.json
    printf 'Shell\nC\n' >list.txt
    answers query nested.nii.gz --labels tree.tsv --origin 0,-100,0 --toward 0,0,0 -q --level @list.txt --format json
    tr -d ' \n' <<<"$output" | grep -q '"level":"@list.txt","level_areas":\[20,4000000001\]'
    answers query nested.nii.gz --labels tree.tsv --origin 0,-100,0 --toward 0,0,0 --level Shell -q
    has 'areas at level Shell'
}

@test "Allen's tree: each depth has all the pixels of the one below" {
    allen=${CONUS_SHARED_DATA:-$BATS_TEST_DIRNAME/../../../shared/data}/meshes/brainglobe-allen-ccf2017-subset
    [ -d "$allen" ] || skip "no BrainGlobe folder ($allen)"
    view=(query "$allen" --origin -9,5,-3 --toward -6,-7,-4 --angle 40 --format tsv -q)
    answers "${view[@]}"
    pixels=$(awk -F'\t' '$2 == "area" { sum += $8 } END { print sum }' <<<"$output")
    [ "$pixels" -gt 20 ]
    rows=1
    for depth in 1 2 3 4 5 6 7 8 9 10; do
        answers "${view[@]}" --level "$depth"
        [ "$(awk -F'\t' '$2 == "area" { sum += $8 } END { print sum }' <<<"$output")" -eq "$pixels" ]
        [ "${#lines[@]}" -ge "$rows" ]
        rows=${#lines[@]}
    done
    answers "${view[@]}" --level 'isocortex,TH'
    has Isocortex
    fails 2 'did you mean "Isocortex"?' "${view[@]}" --level Isocortx
    fails 2 'did you mean "Frontal pole, layer 1" or "Frontal pole, cerebral cortex"? Names with commas are put in double quotes' \
        "${view[@]}" --level 'Frontal pole, layer 1'
}

@test "hemispheres merged: AAL's pairs are one" {
    need_aal
    view=(query "$aal" --origin 0,20,120 --toward 0,-10,10 --format tsv -q)
    answers "${view[@]}"
    pixels=$(cell pixels 1)
    left=$(awk -F'\t' '$4 == "Supp_Motor_Area_L" { print $8 }' <<<"$output")
    right=$(awk -F'\t' '$4 == "Supp_Motor_Area_R" { print $8 }' <<<"$output")
    [ "$left" -gt 0 ] && [ "$right" -gt 0 ] && [ "$pixels" -gt 0 ]
    answers "${view[@]}" --hemispheres merged
    [ "$(cell name 1)/$(cell index 1)/$(cell pixels 1)" = "Supp_Motor_Area/3019/$((left + right))" ]
    answers "${view[@]}" --hemispheres merged -o merged.tsv --voxels voxels.tsv --voxels-of all
    grep -q '"hemispheres": "merged"' merged.json
    grep -q 'Supp_Motor_Area_L' voxels.tsv # the atlas's own areas
    run ! grep -q 'Supp_Motor_Area	' voxels.tsv
    run -0 --separate-stderr conus "${view[@]/-q/-v}" --hemispheres merged
    [[ "$stderr" == *"54 pairs are reported as one area each; without a counterpart: 8 (Vermis_1_2, "* ]]
    fails 3 'hemispheres: merged: no two of its 41 areas are left and right of one' \
        info "$TEMPLATES/brodmann.nii.gz" --hemispheres merged
    fails 2 '--hemispheres merged has no effect without a cone' render "$aal" -o view.png --hemispheres merged
}

@test "hemispheres split: Brodmann's areas have two halves" {
    need_aal
    run -0 --separate-stderr "$CONUS" info "$TEMPLATES/brodmann.nii.gz" --hemispheres split --format tsv
    [ "${#lines[@]}" -eq 83 ]
    [ "$(cell name 4)/$(cell index 4)/$(cell hemisphere 4)" = "4 left/104/L" ]
    [ "$(cell name 45)/$(cell index 45)/$(cell hemisphere 45)" = "4 right/204/R" ]
    answers info "$TEMPLATES/brodmann.nii.gz" --hemispheres split
    has 'hemispheres: 41 areas are cut in two at x = 0, which is taken as the midline: 668543 voxels lie left of it'
    nested
    fails 3 'hemispheres: label 4000000001 is too large to number new areas' info nested.nii.gz --hemispheres split
    allen=${CONUS_SHARED_DATA:-$BATS_TEST_DIRNAME/../../../shared/data}/meshes/brainglobe-allen-ccf2017-subset
    [ ! -d "$allen" ] || fails 3 '55 areas are surfaces, only areas of voxels can be cut' info "$allen" --hemispheres split
}

# Exchanged, what lay right of x = 0 in the file is left.
@test "halves of an atlas whose sides are exchanged are named by where they lie" {
    "$CONUS" phantom sphere -o .
    local sides x
    for sides in as-is exchanged; do
        for x in -5 5; do
            run -0 --separate-stderr "$CONUS" query sphere.nii.gz --sides $sides --hemispheres split --point=$x,0,0 -q --format tsv
            [[ "$output" == *"$([ $x = 5 ] && echo 'Sphere right' || echo 'Sphere left')"* ]]
        done
    done
}
