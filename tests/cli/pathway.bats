#!/usr/bin/env bats
# --pathway, --context and volumes of 4-D files, as a user types them.
load helpers

# Two slabs across y as the atlas, and a ball in front of them as a pathway.
scene() {
    conus phantom slabs -o . --size 32
    sphere --size 32
}
AIM='--origin 0,0,100 --toward 0,0,0 --angle 2 --quiet --format tsv'

@test "a pathway is an object like an area, named after its file" {
    scene
    answers query slabs.nii.gz $AIM --pathway sphere.nii.gz
    [ "$(cell kind 1)/$(cell index 1)/$(cell name 1)/$(cell pixels 1)" = pathway/1/sphere/3228 ]
}

@test "a pathway's default threshold is said in a note" {
    scene
    run -0 --separate-stderr "$CONUS" query slabs.nii.gz --origin 0,0,100 --toward 0,0,0 --pathway sphere.nii.gz
    check_message 'note: pathway sphere: 0 and one other value, taken as a mask; threshold 0.25'
    answers query slabs.nii.gz --origin 0,0,100 --toward 0,0,0 --pathway sphere.nii.gz,threshold=0.5
}

# scaled SLOPE FILE: the ball with its values times a number, given as the bytes of a float.
scaled() {
    gunzip -c sphere.nii.gz >"$2"
    printf "$1" | dd of="$2" bs=1 seek=112 conv=notrunc status=none # scl_slope of NIfTI-1
}

# The bar of a map says what its values are: by its header's intent, its name, or unit=; else only that they are values.
@test "a map's bar has the map's own quantity" {
    scene
    local file wanted
    scaled '\000\000\010\101' act.nii # 8.5
    cp act.nii zstat1.nii
    cp act.nii header.nii
    printf '\005\000' | dd of=header.nii bs=1 seek=68 conv=notrunc status=none # intent_code: z score
    cp header.nii tstat.nii # the header before the name
    while IFS=: read -r file wanted; do
        answers render slabs.nii.gz --pathway "$file,threshold=3.1,name=M" --pathway-transfer heat --size 300x200 -q -o m.svg
        grep -qF ">M by $wanted<" m.svg
    done <<'END'
act.nii:value
zstat1.nii:z
header.nii:z
tstat.nii:z
tstat.nii,unit=% signal change:% signal change
END
    answers render slabs.nii.gz --pathway sphere.nii.gz --pathway-transfer heat --size 300x200 -q -o m.svg
    grep -qF '>sphere by probability, %<' m.svg
    fails 2 'unit: found "", a unit is needed' render slabs.nii.gz --pathway act.nii,unit= -o m.svg
    fails 2 'allowed are up to 23 bytes' render slabs.nii.gz --pathway act.nii,unit=123456789012345678901234 -o m.svg
}

@test "what many pathways share is said once, and no threshold is lost" {
    scene
    cp sphere.nii.gz two.nii.gz
    scaled '\000\000\110\103' a.nii # 200
    scaled '\000\000\310\103' b.nii # 400
    local aim='--origin 0,0,100 --toward 0,0,0' share='0 and one other value, taken as a mask; threshold 0.25'
    # shellcheck disable=SC2086 # words
    run -0 --separate-stderr "$CONUS" query slabs.nii.gz $aim --pathway a.nii --pathway sphere.nii.gz --pathway b.nii \
        --pathway two.nii.gz
    [ "${#stderr_lines[@]}" -eq 2 ]
    [ "${stderr_lines[0]}" = 'conus: note: 2 pathways: values of no usual scale, measured by the largest; thresholds 50, 100' ]
    [ "${stderr_lines[1]}" = "conus: note: 2 pathways: $share" ]
    [ "${lines[-1]}" = '4 pathways: values from 50 on (a), from 0.25 on (sphere, two), from 100 on (b) in 4 files' ]
    run -0 "$CONUS" info slabs.nii.gz --pathway sphere.nii.gz --pathway two.nii.gz # one note for all
    has "pathway sphere: $share"
    has "pathway two: $share"
    # shellcheck disable=SC2086
    run -0 --separate-stderr "$CONUS" query slabs.nii.gz $aim --pathway sphere.nii.gz --pathway a.nii
    [ "${#stderr_lines[@]}" -eq 2 ]
    [ "${stderr_lines[0]}" = "conus: note: pathway sphere: $share" ]
    # A quarter of 100, 101 ... 110 times 2; the first eight are listed.
    local many=()
    for i in 0 1 2 3 4 5 6 7 8 9; do
        scaled "\\000\\000\\$(printf %03o $((72 + i)))\\103" "m$i.nii" # 200, 201 ...
        many+=(--pathway "m$i.nii")
    done
    # shellcheck disable=SC2086
    run -0 --separate-stderr "$CONUS" query slabs.nii.gz $aim "${many[@]}"
    check_message 'largest; thresholds 50, 50.25, 50.5, 50.75, 51, 51.25, 51.5, 51.75 and 2 more (conus info says which)'
}

@test "pathways have one line below the table, with names where thresholds differ" {
    scene
    local aim='--origin 0,0,100 --toward 0,0,0' five=()
    for i in 1 2 3 4 5; do
        five+=(--pathway "sphere.nii.gz,threshold=1,name=p$i")
    done
    # shellcheck disable=SC2086 # words
    answers query slabs.nii.gz $aim "${five[@]:0:2}"
    [ "${lines[-1]}" = 'pathway p1: values from 1 on in sphere.nii.gz' ]
    # shellcheck disable=SC2086
    answers query slabs.nii.gz $aim "${five[@]}" --quiet
    [ "${lines[-1]}" = '5 pathways: values from 1 on in sphere.nii.gz' ]
    [[ "${lines[-2]}" == 'atlas slabs.nii.gz, placed by '* ]]
    # shellcheck disable=SC2086
    answers query slabs.nii.gz $aim "${five[@]}" --hide p1,p3
    [ "${lines[-1]}" = '3 pathways: values from 1 on in sphere.nii.gz' ]
    # shellcheck disable=SC2086
    answers query slabs.nii.gz $aim "${five[@]}" --pathway sphere.nii.gz,threshold=0.5,name=q
    [ "${lines[-1]}" = '6 pathways: values from 1 on (p1, p2, p3 and 2 more), from 0.5 on (q) in sphere.nii.gz' ]
}

@test "pathways have names, thresholds and volumes, and may be many" {
    scene
    answers query slabs.nii.gz $AIM --pathway sphere.nii.gz,name='left tract',threshold=1 --pathway=sphere.nii.gz
    [ "$(cell name 1)" = 'left tract' ]
    run -0 --separate-stderr "$CONUS" info slabs.nii.gz --format tsv --pathway sphere.nii.gz,name=a --pathway sphere.nii.gz,threshold=1,name=b
    [ "$(cell name 3)/$(cell index 3)/$(cell kind 3)" = a/1/pathway ]
    [ "$(cell name 4)/$(cell index 4)/$(cell kind 4)" = b/2/pathway ]
}

@test "a file's name may have commas" {
    scene
    cp sphere.nii.gz 'tract, left.nii.gz'
    answers query slabs.nii.gz $AIM --pathway 'tract, left.nii.gz'
    [ "$(cell name 1)" = 'tract, left' ]
    answers query slabs.nii.gz $AIM --pathway 'tract, left.nii.gz,name=t'
    [ "$(cell name 1)" = t ]
}

@test "mistakes in --pathway are named" {
    scene
    local start="query slabs.nii.gz $AIM"
    fails 2 '--pathway: found "treshold=3", allowed are volume, resolution, orientation, level, name, threshold, unit, band; did you mean threshold?' $start --pathway sphere.nii.gz,treshold=3
    fails 2 '--pathway: threshold: found "0", allowed is a number above 0' $start --pathway sphere.nii.gz,threshold=0
    fails 2 '--pathway: "threshold=0,5" has a comma in it' $start --pathway sphere.nii.gz,threshold=0,5
    fails 2 '--pathway: "band=0,5:1:x" has a comma in it' $start --pathway sphere.nii.gz,band=0,5:1:x
    fails 2 '--pathway: threshold: found "nan", allowed is a number above 0' $start --pathway sphere.nii.gz,threshold=nan
    fails 2 '--pathway: volume: found "-1", allowed are whole numbers from 0' $start --pathway sphere.nii.gz,volume=-1
    fails 2 '--pathway: name: found "", a name is needed' $start --pathway sphere.nii.gz,name=
    fails 2 '--pathway: name is given twice' $start --pathway sphere.nii.gz,name=a,name=b
    fails 2 'names no file' $start --pathway ,name=a
    fails 2 'threshold 2, allowed is above 0 to 1' $start --pathway sphere.nii.gz,threshold=2
    fails 3 'none.nii: cannot open' $start --pathway none.nii
}

@test "--voxels lists a pathway's voxels with their values" {
    scene
    fails 2 '--voxels lists the voxels of pathways, and there is none' query slabs.nii.gz $AIM --voxels v.tsv
    answers query slabs.nii.gz $AIM --pathway sphere.nii.gz --voxels v.tsv
    output=$(cat v.tsv)
    [ "$(cell pathway 1)/$(cell kind 1)/$(cell value 1)" = sphere/pathway/1 ]
}

@test "of a 4-D file, volume=K chooses one" {
    sphere --size 16
    gunzip -c sphere.nii.gz >four.nii
    head -c 4096 /dev/zero >>four.nii
    printf '\004\000\020\000\020\000\020\000\002\000' | dd of=four.nii bs=1 seek=40 conv=notrunc status=none
    fails 2 'four.nii: ' info four.nii
    run -0 --separate-stderr "$CONUS" info four.nii,volume=0 --labels sphere.tsv --format tsv
    [ "$(cell name 1)" = Sphere ]
    [ "$(cell voxels 1)" -gt 0 ]
    run -0 --separate-stderr "$CONUS" info four.nii,volume=1 --labels sphere.tsv --format tsv
    [ "$(cell voxels 1)" = 0 ]
    fails 2 'four.nii: volume: found 2, allowed are 0 to 1' info four.nii,volume=2
    run -0 --separate-stderr "$CONUS" info sphere.nii.gz --pathway four.nii,volume=0,name=p --format tsv
    [ "$(cell name 2)/$(cell kind 2)" = p/pathway ]
    fails 3 'four.nii: its largest value is 0, a pathway needs values above 0' info sphere.nii.gz --pathway four.nii,volume=1
}

@test "--context is shown by info and is no object" {
    scene
    answers info slabs.nii.gz --context sphere.nii.gz
    has 'Context'
    has '2 areas (0 without a name, 0 without a shape), 0 pathways'
    fails 3 'none.nii: cannot open' info slabs.nii.gz --context none.nii
}

@test "a context that blocks hides what is behind it" {
    scene
    answers query slabs.nii.gz $AIM --context sphere.nii.gz --context-blocks 0.5
    [ "$(cell kind 1)/$(cell pixels 1)/$(cell share 1)" = unassigned/3228/1 ]
    answers query slabs.nii.gz $AIM --pathway sphere.nii.gz --context sphere.nii.gz --context-blocks 0.5
    [ "$(cell kind 1)/$(cell pixels 1)" = pathway/3228 ]
    printf '{"conus_atlas": 1, "parcellation": "slabs.nii.gz",
             "context": {"file": "sphere.nii.gz", "blocks": 0.5}}' >m.atlas.json
    answers query m.atlas.json $AIM
    [ "$(cell kind 1)/$(cell pixels 1)" = unassigned/3228 ]
    answers info m.atlas.json
    has 'blocks       from 0.5 on'
    answers query slabs.nii.gz ${AIM/tsv/json} --context sphere.nii.gz --context-blocks 0.5
    has '"threshold": 0.5'
}

@test "mistakes in --context-blocks are named" {
    scene
    local start="query slabs.nii.gz $AIM"
    fails 2 '--context has no effect without --context-blocks' $start --context sphere.nii.gz
    fails 2 '--context-blocks has no effect without --context' $start --context-blocks 1
    fails 2 '--context-blocks: 0 is out of range' $start --context sphere.nii.gz --context-blocks 0
    fails 2 'blocks from 2 on, allowed is above 0 to 1' $start --context sphere.nii.gz --context-blocks 2
    fails 3 'none.nii: cannot open' $start --context none.nii --context-blocks 1
    fails 2 'would overwrite the input' $start --context sphere.nii.gz --context-blocks 1 -o sphere.nii.gz
}

@test "a Jülich fibre pathway in AAL" {
    need_aal
    local pathway=${CONUS_SHARED_DATA:-$BATS_TEST_DIRNAME/../../../shared/data}/prob/juelich-fibre-pathways-u16
    [ -d "$pathway" ] || skip "no shared data ($pathway)"
    answers query "$aal" --origin=-90,-20,20 --toward=0,-10,0 --angle 40 --quiet --format tsv \
        --pathway "$pathway/Corticospinal_tract_L.nii.gz"
    has Postcentral_L
    answers info "$aal" --pathway "$pathway/Corticospinal_tract_L.nii.gz"
    has 'Pathway 1'
    has '1 pathway'
}

@test "a mask that needs one pathway says how to name it, and nothing is written" {
    scene
    local two='--pathway sphere.nii.gz,threshold=1,name=a --pathway sphere.nii.gz,threshold=1,name=b'
    local aim='--origin 0,0,100 --toward 0,0,0 --angle 20 --quiet'
    # shellcheck disable=SC2086 # words
    fails 2 'map of values: found 2 pathways, name one of them (--mask-object)' \
        query slabs.nii.gz $aim $two -o rows.tsv --mask values.nii.gz --mask-of values
    [ ! -e rows.tsv ] && [ ! -e rows.json ] && [ ! -e values.nii.gz ]
    # shellcheck disable=SC2086
    answers query slabs.nii.gz $aim $two -o rows.tsv --mask values.nii.gz --mask-of values --mask-object b
    [ -e rows.tsv ] && [ -e values.nii.gz ]
}
