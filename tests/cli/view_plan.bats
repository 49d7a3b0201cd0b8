#!/usr/bin/env bats
# Plans in the window: its list is that of conus plan, and a session restores the plan.
load helpers
load window

# Needles of plan.bats: b is the best one, then a. The device's first shank is far from everything.
needles() {
    conus phantom u-shape -o .
    printf '%s\t40\t0\t5\t-1\t0\t0\t%s\n' query_id far a 30 b 26 c 36 d 20 |
        sed '1s/.*/query_id\tx\ty\tz\tdx\tdy\tdz\tfar/' >needles.tsv
    plan=(--shanks '30,0;0,0' --reach 'U,length=5,shank=2' --avoid 'Ball,margin=3' --radius 1)
}

@test "constraints and candidates that cannot be are refused before there is a window" {
    [ -x "${CONUS%/*}/conus-view" ] || skip "conus-view is not built"
    needles
    fails 2 'did you mean length?' view u-shape.nii.gz --reach U,lenght=5
    fails 2 '--avoid: margin: found "200", allowed is a number from 0 to 100' view u-shape.nii.gz --avoid U,margin=200
    fails 2 'they have to be a file' view u-shape.nii.gz "${plan[@]}" --poses -
    fails 3 'absent.tsv' view u-shape.nii.gz "${plan[@]}" --poses absent.tsv
}

@test "positions of another space than the atlas are refused" {
    need_window
    needles
    positions_of_a_scan u-shape.nii.gz
    : >script
    local words='scan.txt: positions are in "NIfTI:Scanner", the atlas in another space'
    fails 3 "$words" view mni.nii --poses scan.txt --script script --quiet
    [[ "$stderr" != *--any-space* ]]
    fails 3 "$words" view mni.nii --reach 1 --apart scan.txt,1 --depth 9 --script script --quiet
}

@test "the list is that of conus plan, its rows are gone to, and a session keeps it all" {
    needles
    touch Ball # a file of that name is not the structure
    view u-shape.nii.gz "${plan[@]}" --poses needles.tsv <<'END'
settle
plan list.tsv
planned 2
save row.json
key ;
save first.json
key ctrl+z
save back.json
END
    conus plan u-shape.nii.gz "${plan[@]}" --poses needles.tsv --format tsv -q >wanted.tsv
    diff wanted.tsv list.tsv
    # a ends at 30 mm, b at 26; both are held at x = 40
    [ "$(jq -c '[.range_mm, .frozen, .world_from_device[12], .crosshair[0]]' row.json)" = '[[0,30],true,40,10]' ]
    [ "$(jq -c '[.range_mm, .frozen, .crosshair[0]]' first.json)" = '[[0,26],true,14]' ]
    diff <(jq -c 'del(.crosshair)' row.json) <(jq -c 'del(.crosshair)' back.json)
    mkdir elsewhere
    cd elsewhere
    printf '%s\n' settle 'plan again.tsv' 'save again.json' >script
    run -0 --separate-stderr timeout $HANG "$CONUS" view ../row.json --script script --quiet --size 1000x640
    [ -z "$stderr" ]
    diff ../wanted.tsv again.tsv
    diff <(jq -c "del(.atlas, .opened.folder)" ../row.json) <(jq -c "del(.atlas, .opened.folder)" again.json)
}

# The needle lies along x at z = 5, from x = 40 to 10. The axial cut is as high as the window, whose middle is x = 0: in
# the columns that are looked at, where the needle ends, it lies over black, and nothing else has its colour.
@test "a needle is drawn firmly in the cut that it lies in, thin beside it, and not far from it" {
    needles
    view u-shape.nii.gz --reach U --radius 1 --depth 30 <<'END'
size 900 500
key tab
aim 40 0 5 0 0 5
crosshair 0 0 5
shot in
crosshair 0 0 -5
shot beside
crosshair 0 0 -25
shot far
END
    pixels <<'END'

def amber(name):
    rgb = oiio.ImageBuf(name).get_pixels(oiio.UINT8).astype(int)[:, 455:487]
    red, green, blue = rgb[..., 0], rgb[..., 1], rgb[..., 2]
    found = (red > 1.2 * green) & (green > 2 * blue) & (red > 60)
    return found.sum(), red[found].max(initial=0)

firm, thin, none = (amber(f"{name}.png") for name in ("in", "beside", "far"))
assert firm[0] > 2 * thin[0] and firm[1] == 255, (firm, thin)
assert 15 < thin[0] < 40 and thin[1] < 200, thin
assert none[0] == 0, none
END
}

@test "the card's target is what the plan's needle has to reach, kept in sessions, and taken back" {
    needles
    view u-shape.nii.gz --length 1,40 --reach 'U,length=5' --radius 1 --poses needles.tsv <<'END'
settle
plan first.tsv
target Ball
settle
plan target.tsv
save target.json
key ctrl+z
settle
plan back.tsv
save back.json
key ctrl+y
settle
plan again.tsv
target
settle
plan none.tsv
END
    local rest=(u-shape.nii.gz --length 1,40 --radius 1 --poses needles.tsv --format tsv -q)
    conus plan "${rest[@]}" --reach U,length=5 >wanted.tsv
    conus plan "${rest[@]}" --reach '"Ball"' >other.tsv
    not diff wanted.tsv other.tsv
    diff wanted.tsv first.tsv
    diff other.tsv target.tsv
    diff wanted.tsv back.tsv
    diff other.tsv again.tsv
    conus plan "${rest[@]}" | diff - none.tsv
    jq -e '.opened.options | map(select(startswith("--reach"))) == ["--reach=\"Ball\""]' target.json
    jq -e '.opened.options | map(select(startswith("--reach"))) == ["--reach=U,length=5"]' back.json
    view target.json <<'END'
settle
plan opened.tsv
END
    diff other.tsv opened.tsv
    # invalid targets are refused, and an atlas without a plan gets one
    printf 'target Ball\nsave same.json\n' >script
    run -0 --separate-stderr timeout $HANG "$CONUS" view u-shape.nii.gz --avoid Ball --script script --quiet
    check_message 'constraint 1 avoids all that constraint 2 reaches'
    jq -e '.opened.options == ["--avoid=Ball"]' same.json
    view u-shape.nii.gz <<'END'
target U
save new.json
END
    jq -e '.opened.options == ["--reach=\"U\""]' new.json
}

# The words of the window are those of conus plan: so are its lists, byte for byte.
@test "what the needle is to avoid is chosen and let go in the window" {
    needles
    view u-shape.nii.gz --length 1,40 --reach 'U,length=5' --radius 1 --poses needles.tsv <<'END'
settle
plan first.tsv
avoid Ball
settle
plan avoids.tsv
save avoids.json
avoid Ball off
settle
plan none.tsv
key ctrl+z
settle
plan back.tsv
END
    local asked=(conus plan u-shape.nii.gz --length 1,40 --reach U,length=5 --radius 1 --poses needles.tsv -q --format tsv)
    "${asked[@]}" >wanted.tsv
    "${asked[@]}" --avoid Ball >other.tsv
    not diff wanted.tsv other.tsv
    diff wanted.tsv first.tsv
    diff other.tsv avoids.tsv
    diff wanted.tsv none.tsv
    diff other.tsv back.tsv
    jq -e '.opened.options | map(select(startswith("--avoid"))) == ["--avoid=\"Ball\""]' avoids.json
    # one with a margin goes, too, and others stay
    view u-shape.nii.gz --avoid Ball,margin=3 --avoid U,share=0.1 <<'END'
avoid Ball off
save off.json
avoid Ball
save on.json
END
    jq -e '.opened.options == ["--avoid=U,share=0.1"]' off.json
    jq -e '.opened.options == ["--avoid=U,share=0.1", "--avoid=\"Ball\""]' on.json
}
