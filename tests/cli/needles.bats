#!/usr/bin/env bats
# conus plan --needles: several needles together.
#
# In u-shape needles along -x at z = 5 pass the U between x = 34 and x = 24 or so; their distances follow from their y.

load helpers

# poses NAME Y...: needles along -x, called NAME-Y, which end at x = 14.
poses() {
    local name=$1
    shift
    printf 'query_id\tx\ty\tz\tdx\tdy\tdz\tfar\n' >"$name.tsv"
    for y; do
        printf '%s-%s\t40\t%s\t5\t-1\t0\t0\t26\n' "$name" "$y" "$y" >>"$name.tsv"
    done
}

needles() {
    conus phantom u-shape -o .
    poses a 0 1
    poses b 1 2 4
    poses c -3 -4 -6
    printf 'needle\tposes\tradius\nA\ta.tsv\t1\nB\tb.tsv\t0.5\nC\tc.tsv\t\n' >needles.tsv
    N='plan u-shape.nii.gz --needles needles.tsv --reach U,length=2'
}

# column NAME [FILE]: the cells of a column, blanks between them.
column() {
    awk -F '\t' -v name="$1" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) at = i; next }
        { printf "%s%s", (NR > 2 ? " " : ""), $at }' ${2:+"$2"}
}

@test "the needles that leave the most room are chosen together, and proven" {
    needles
    answers $N --between 1 -q --format tsv --pairs pairs.tsv --poses-out best.tsv
    [ "$(column needle <<<"$output")" = "A B C" ]
    [ "$(column query <<<"$output")" = "a-0 b-4 c--4" ] # c--6 is at the edge of the U, without leeway
    [ "$(column combination <<<"$output")" = "1 1 1" ]
    [ "$(column proven <<<"$output")" = "1 1 1" ]
    [ "$(column rank <<<"$output")" = "n/a n/a n/a" ]
    [ "$(column needle pairs.tsv)" = "A A B" ]
    [ "$(column other pairs.tsv)" = "B C C" ]
    # 4 - 1 - 0.5, 4 - 1, 8 - 0.5
    [ "$(column distance_mm pairs.tsv)" = "2.5 3 7.5" ]
    [ "$(column slack_mm pairs.tsv)" = "1.5 2 6.5" ]
    [ "$(column leeway_mm pairs.tsv)" = "0.75 1 3.25" ]
    [ "$(column entry_distance_mm pairs.tsv)" = "4 4 8" ]
    [ "$(cut -f 1 best.tsv | tr -d '"\n')" = "query_idABC" ]
}

@test "each needle asked alone has the same text" {
    needles
    conus $N --between 1 -q -o plan.tsv --poses-out best.tsv
    for row in 2 3 4; do
        name=$(sed -n "${row}p" plan.tsv | cut -f 8)
        radius=$(sed -n "${row}p" needles.tsv | cut -f 3)
        { head -n 1 best.tsv; grep "^\"$name\"" best.tsv; } >alone.tsv
        conus plan u-shape.nii.gz --poses alone.tsv --reach U,length=2 ${radius:+--radius $radius} -q --force -o alone-plan.tsv
        head -n 1 plan.tsv | tr '\t' '\n' | sed -n '12,$p' >names
        [ "$(wc -l <names)" -gt 15 ]
        while read -r column; do
            [ "$(column "$column" alone-plan.tsv)" = "$(column "$column" plan.tsv | cut -d ' ' -f $((row - 1)))" ]
        done <names
    done
}

# 4, 4 and 8 mm between the axes: the same distances as those of needles that are chosen.
@test "needles that are all given need no candidates" {
    needles
    printf 'needle\tradius\nA\t1\nB\t0.5\nC\t\n' >alone.tsv
    { cat a.tsv; sed -n 4p b.tsv; sed -n 3p c.tsv; } | sed '/^a-1/d; s/^a-0/A/; s/^b-4/B/; s/^c--4/C/' >given.tsv
    run -0 --separate-stderr conus plan u-shape.nii.gz --needles alone.tsv --reach U,length=2 --between 1 \
        --given given.tsv --format tsv --pairs pairs.tsv
    [ "$(column query <<<"$output")" = "A B C" ]
    [ "$(column distance_mm pairs.tsv)" = "2.5 3 7.5" ]
    [ "$stderr" = "conus: note: a plan is a list to be checked; conus is no medical device" ]
    sed -i '/^C/d' given.tsv
    fails 2 'alone.tsv: line 4: no candidates given for C: --poses FILE, or --from FILE --toward WHAT, or a pose of that name in given.tsv' \
        plan u-shape.nii.gz --needles alone.tsv --reach U,length=2 --given given.tsv
}

@test "answers do not depend on threads, and are verified" {
    needles
    for threads in 1 2 7; do
        conus $N --between 1 --entry-distance 2 -q --threads $threads -o threads-$threads.tsv
        cmp threads-1.tsv threads-$threads.tsv
        [ "$(jq -c .Plan threads-$threads.json)" = "$(jq -c .Plan threads-1.json)" ]
    done
    run -0 conus verify threads-2.tsv
    jq -e '.Plan.conflict == null and .Plan.combinations[0].proven and .Plan.rows[0].candidates == 2' threads-1.json
    jq -e '.Plan.needles | map(.name) == ["A", "B", "C"]' threads-1.json
    jq -e '[.Inputs[].path] | index("a.tsv") and index("needles.tsv")' threads-1.json
}

# What combinations differ in: of A 1 mm, of B 2 and 3 mm, of C 1 and 2 mm. The leeway of each is that of its nearest
# pair: (4 - 1.5 - 0.1) / 2, (4 - 1 - 1 - 0.1) / 2, (3 - 1.5 - 0.1) / 2.
@test "further combinations differ from those before, and are proven" {
    needles
    answers $N --between 0.1 --top 3 --diverse 1 -q --format tsv --pairs pairs.tsv --poses-out best.tsv
    [ "$(column combination <<<"$output")" = "1 1 1 2 2 2 3 3 3" ]
    [ "$(column query <<<"$output")" = "a-0 b-4 c--4 a-0 b-4 c--3 a-1 b-4 c--3" ]
    [ "$(column proven <<<"$output")" = "1 1 1 1 1 1 1 1 1" ]
    [ "$(column all_leeway_mm <<<"$output")" = "1.2 1.2 1.2 0.95 0.95 0.95 0.7 0.7 0.7" ]
    [ "$(column all_leeway_of <<<"$output" | cut -d ' ' -f 1,4,7)" = "A/B A/C A/B" ]
    [ "$(column combination pairs.tsv)" = "1 1 1 2 2 2 3 3 3" ]
    [ "$(cut -f 1 best.tsv | tr -d '"\n')" = "query_id1-A1-B1-C2-A2-B2-C3-A3-B3-C" ]
    run -0 --separate-stderr conus $N --between 0.1 --top 9 --diverse 1,2 -o few.tsv
    [ "$(column query few.tsv)" = "a-0 b-4 c--4 a-1 b-4 c--3 a-0 b-2 c--3" ] # 1.2, 0.7, 0.2
    [[ "$stderr" == *"conus: note: 3 of 9 combinations: no other one differs by so much"* ]]
    jq -e '.Plan | .top == 9 and .diverse == {apart_mm: 1, needles: 2} and .needles[0].cut_mm == 0' few.json
    jq -e '.Plan.combinations | map(.last) == [false, false, true]' few.json
    conus verify few.tsv
    conus cite few.tsv | tr '\n' ' ' >cited
    grep -qF 'differ from all before it in 2 or more needles, by 1 mm or more' cited
    grep -qF 'constraints: A (radius 1 mm): at least 2 mm of the axis in U (2 of 2 hold); B (radius 0.5 mm): ' cited
    # 1 mm is not 1.5 mm: B moves by 2 mm, C by 2 and 3 mm to where it has no leeway
    answers $N --between 0.1 --top 3 --diverse 1.5 -q --format tsv
    [ "$(column query <<<"$output")" = "a-0 b-4 c--4 a-0 b-2 c--3 a-0 b-2 c--6" ]
}

# P and Q are alike: the one with the smaller number comes first. R has two rows, and both are its alternatives; the rows
# of b.tsv are answered once. Of a-0 and a-1 the distance is 1 mm, no more than b-1 from these.
@test "needles may have alternatives, be alike, and answer a row once" {
    needles
    printf 'needle\tposes\nQ,P\tall.tsv\n' >alike.tsv
    poses all 0 1 4
    answers plan u-shape.nii.gz --needles alike.tsv --reach U,length=2 -q --format tsv --poses-out best.tsv
    [ "$(column needle <<<"$output")" = "Q P" ]
    [ "$(column query <<<"$output")" = "all-0 all-4" ] # leeways of 4 and 2, the pair's is 2
    [ "$(column row <<<"$output")" = "1 1" ]
    # the same two places the other way round are no other combination
    answers plan u-shape.nii.gz --needles alike.tsv --reach U,length=2 -q --format tsv --top 3 --diverse 0
    [ "$(column query <<<"$output")" = "all-0 all-4 all-1 all-4 all-0 all-1" ]
    run -0 --separate-stderr conus plan u-shape.nii.gz --needles alike.tsv --reach U,length=2 --top 3 --diverse 0,2
    [[ "$stderr" == *"conus: note: 1 of 3 combinations: no other one differs by so much"* ]]
    printf 'needle\tposes\tonce\tradius\nR\ta.tsv\t\t0.5\nR, S\tb.tsv\t1\t0.25\nS\tc.tsv\t0\tn/a\n' >several.tsv
    conus plan u-shape.nii.gz --needles several.tsv --reach U,length=2 -q -o plan.tsv --pairs pairs.tsv
    [ "$(column needle plan.tsv)" = "R S" ]
    [ "$(column proven plan.tsv)" = "1 1" ]
    # R at a-1: 3.5 of its own; S at c--3: 3; 4 mm apart, 0.5 mm thick: 1.75. At b-2, 2.75 of its own, 5 mm: 2.375
    [ "$(column query plan.tsv)" = "b-2 c--3" ]
    [ "$(column row plan.tsv)" = "2 3" ]
    [ "$(column all_leeway_mm plan.tsv)" = "2.375 2.375" ]
    jq -e '.Plan.rows | map(.needles) == [["R"], ["R", "S"], ["S"]] and map(.once) == [false, true, false]' plan.json
    conus verify plan.tsv
    conus cite plan.tsv | tr '\n' ' ' >said
    grep -qF 'constraints: R (radius 0.5 mm): at least 2 mm of the axis in U (2 of 2 hold); R, S (radius 0.25 mm), for one needle only: at least' said
    # with b.tsv alone, once, there is no place for both
    printf 'needle\tposes\tonce\nR,S\tb.tsv\t1\n' >once.tsv
    run -0 --separate-stderr conus plan u-shape.nii.gz --needles once.tsv --reach U,length=2
    [[ "$stderr" == *"conus: R, S: no combination: neither another margin"* ]]
    sed -i 's/\t1$/\t0/' once.tsv
    answers plan u-shape.nii.gz --needles once.tsv --reach U,length=2 -q --format tsv
    [ "$(column query <<<"$output")" = "b-1 b-4" ]
    # a given needle is of its first row
    printf 'query_id\tx\ty\tz\tdx\tdy\tdz\tfar\nS\t40\t3\t5\t-1\t0\t0\t26\n' >given.tsv
    answers plan u-shape.nii.gz --needles several.tsv --reach U,length=2 -q --format tsv --given given.tsv
    [ "$(column row <<<"$output")" = "1 2" ]
    [ "$(column query <<<"$output")" = "a-0 S" ]
}

@test "without a combination the needles are named that are in each other's way" {
    needles
    run -0 --separate-stderr conus $N --between 3 --format tsv
    [ "$(wc -l <<<"$output")" -eq 1 ]
    [[ "$stderr" == *"conus: A, B: no combination: at most 2.5 of 3 mm between them"* ]]
    run -0 --separate-stderr conus $N --entry-distance 5
    [[ "$stderr" == *"conus: A, B: no combination: entries 4 of 5 mm apart"* ]]
    [[ "$output" == "(no combination)"* ]]
    run -0 --separate-stderr conus $N --between 3 --entry-distance 5
    [[ "$stderr" == *"conus: A, B: no combination: neither another margin of shafts nor another distance"* ]]
    run -0 --separate-stderr conus $N --length 30,40
    [[ "$stderr" == *"conus: A: no combination"*"2 candidates: "*"none of these has a length of 30 to 40 mm"* ]]
}

# 599 candidates at y = 2.2 have more leeway of their own than the one at y = -3, so that the first 500 of the list are
# of these; but B at y = 3 is 0.8 mm from them and 6 mm from that one: leeway 0.4 against 3.
@test "a candidate behind the first of its list is found where it leaves more room" {
    conus phantom u-shape -o .
    # shellcheck disable=SC2046 # words
    poses a $(yes 2.2 | head -n 599)
    awk -F '\t' -v OFS='\t' 'NR > 1 { $1 = "n" NR } { print }' a.tsv >a2.tsv
    printf 'best\t40\t-3\t5\t-1\t0\t0\t26\n' >>a2.tsv
    poses b 3
    printf 'needle\tposes\nA\ta2.tsv\nB\tb.tsv\n' >needles.tsv
    answers plan u-shape.nii.gz --needles needles.tsv --reach U,length=2 -q --format tsv
    [ "$(column query <<<"$output")" = "best b-3" ]
    [ "$(column all_leeway_mm <<<"$output")" = "3 3" ]
    [ "$(column proven <<<"$output")" = "1 1" ]
}

@test "one needle without a leeway is proven, a given one that breaks something says what, and files have their notes" {
    needles
    printf 'needle\tposes\nA\ta.tsv\n' >one.tsv
    answers plan u-shape.nii.gz --needles one.tsv --length 10,40 -q --format tsv
    [ "$(column proven <<<"$output")" = 1 ]
    poses given 30
    sed -i 's/^given-30/A/' given.tsv
    run -0 --separate-stderr conus $N --given given.tsv
    [[ "$stderr" == *"conus: A is given, and breaks at least 2 mm of the axis in U"* ]]
    run -0 --separate-stderr conus plan u-shape.nii.gz --needles one.tsv --given given.tsv --length 1,100 --contacts 4,1,2,1 \
        --cover U,contacts=4 -q # it breaks nothing
    [ "$stderr" = "conus: A: no combination: at most 0 of 4 contacts in U" ]
    sed -i 's/^a-1/a-0/' a.tsv
    run -0 --separate-stderr conus $N
    [[ "$stderr" == *'a.tsv: poses 1 and 2 are both called "a-0"'* ]]
    printf 'needle\tposes\ttilt\nA\ta.tsv\t10,5\n' >tilt.tsv
    fails 2 'tilt.tsv: line 2: --tilt has no effect without --from' plan u-shape.nii.gz --needles tilt.tsv --reach U
    fails 2 '--cover: "U,3" ends in a number: contacts=3 is how many' plan u-shape.nii.gz --needles one.tsv --reach U \
        --contacts 4,1,2,1 --cover U,3
}

# A distance of entries that is named has a combination: 4.0000007 mm apart are 4 mm and not 4.000001 mm.
@test "the distance of entries that would do does" {
    conus phantom u-shape -o .
    poses a 0
    poses b 4.0000007
    printf 'needle\tposes\nA\ta.tsv\nB\tb.tsv\n' >needles.tsv
    run -0 --separate-stderr conus plan u-shape.nii.gz --needles needles.tsv --reach U,length=2 --entry-distance 5
    [[ "$stderr" == *"entries 4 of 5 mm apart"* ]]
    answers plan u-shape.nii.gz --needles needles.tsv --reach U,length=2 --entry-distance 4 -q --format tsv
    [ "$(column needle <<<"$output")" = "A B" ]
}

# A bolt of 1 mm on each needle of a line of 10 mm from its position on: where shafts have room, bolts may have none.
@test "parts keep a margin of their own" {
    needles
    answers $N --between 1,parts=1.9 --part 1,0:10 -q --format tsv --pairs pairs.tsv
    [ "$(column query <<<"$output" | cut -d ' ' -f 2)" = b-4 ]
    # A's shaft is as thick as its part, and comes first; 4 - 1 - 1 of 1.9
    head -n 2 pairs.tsv | cut -f 4,6-8 >first
    printf '%s\t%s\t%s\t%s\n' slack_mm distance_mm body other_body 0.1 2 shaft 'part 1' | cmp - first
    run -0 --separate-stderr conus $N --between 1,parts=2 --part 1,0:10
    [[ "$stderr" == *"conus: A, B: no combination"* ]]
}

@test "given needles stay where they are, and a plan that is given whole is checked" {
    needles
    printf 'query_id\tx\ty\tz\tdx\tdy\tdz\tfar\nB\t40\t3\t5\t-1\t0\t0\t26\n' >given.tsv
    answers $N --between 1 --given given.tsv -q --format tsv
    [ "$(column query <<<"$output" | cut -d ' ' -f 2)" = B ]
    [ "$(column y <<<"$output" | cut -d ' ' -f 2)" = 3 ]
    conus $N --between 1 -q --poses-out best.tsv -o plan.tsv
    answers $N --between 1 --given best.tsv -q --format tsv
    [ "$(column proven <<<"$output")" = "1 1 1" ]
    sed -E 's/^"B"\t40\t4/"B"\t40\t1/' best.tsv >near.tsv
    conus $N --between 1 --given near.tsv -q -o near-plan.tsv --pairs near-pairs.tsv
    [ "$(column combination near-plan.tsv)" = "0 0 0" ]
    [ "$(column proven near-plan.tsv)" = "n/a n/a n/a" ]
    [ "$(column slack_mm near-pairs.tsv | cut -d ' ' -f 1)" = "-1.5" ]
    [ "$(jq -c .Plan.conflict.needles near-plan.json)" = '["A","B"]' ]
}

@test "a cell takes the place of an option, or is added to those that may be repeated" {
    needles
    printf 'needle;poses;reach;first;reach.1\nA;a.tsv;"U,length=3";;\nB;b.tsv;n/a;U;Ball\n' >needles.tsv
    run -0 --separate-stderr conus plan u-shape.nii.gz --needles needles.tsv --radius 0.5 -q --format tsv
    [ "$(wc -l <<<"$output")" -eq 1 ]
    [[ "$stderr" == *"B: no combination"* ]] # it reaches no Ball
    printf 'needle,poses,avoid,radius\nA,a.tsv,"Ball,margin=3",0.25\nB,b.tsv,,\n' >needles.tsv
    conus $N --radius 0.5 -q -o plan.tsv
    jq -e '.Plan.rows | map(.radius_mm) == [0.25, 0.5]' plan.json
    jq -e '.Plan.rows | map(.constraints | length) == [2, 1]' plan.json
    mkdir far
    mv needles.tsv a.tsv b.tsv far
    conus plan u-shape.nii.gz --needles far/needles.tsv --reach U,length=2 --radius 0.5 -q -o far.tsv
    cmp plan.tsv far.tsv
}

@test "candidates may be made from entries and targets in rows" {
    needles
    printf '%s\n' '40 0 5' '40 1 5' >left.txt
    printf '%s\n' '40 4 5' '40 6 5' >right.txt
    printf '%s\n' '18 0 5' >target.txt
    printf '%s\n' '18 4 5' >other.txt
    printf 'needle\tfrom\ttoward\nA\tleft.txt\ttarget.txt\nB\tright.txt\tother.txt\n' >needles.tsv
    answers $N --depth target+4 --between 0.5 -q --format tsv
    [ "$(column query <<<"$output")" = "e1 e1" ] # 4 mm apart all the way
    [ "$(column all_leeway_mm <<<"$output")" = "1.75 1.75" ]
}

refused() { # MESSAGE ARGUMENT...
    local message=$1
    shift
    run -2 --separate-stderr conus "$@"
    [[ "$stderr" == *"$message"* ]] || { echo "said: $stderr"; return 1; }
    [ -z "$output" ]
}

table() { # LINE...
    printf '%b\n' "$@" >needles.tsv
}

# Arc angles of 0, 0 and 20 degrees, slider angles of 0, 10 and 0, around the ball's outside.
@test "needles share arcs as a rig has them, and without a combination it says how many arcs it takes" {
    conus phantom sphere -o .
    for needle in 'A 0 0 1' 'B 0.17364817766693033 0 0.984807753012208' 'C 0 0.3420201433256687 0.9396926207859084'; do
        # shellcheck disable=SC2086 # words
        set -- $needle
        printf 'query_id\tx\ty\tz\tdx\tdy\tdz\tfar\n%s\t%s\t%s\t%s\t-%s\t-%s\t-%s\t20\n' "$1" \
            "$(bc <<<"60*$2")" "$(bc <<<"60*$3")" "$(bc <<<"60*$4")" "$2" "$3" "$4" >"$1.tsv"
    done
    printf 'needle\tposes\tarc\nA\tA.tsv\t\nB\tB.tsv\t\nC\tC.tsv\t\n' >needles.tsv
    N='plan sphere.nii.gz --needles needles.tsv --avoid Sphere'
    answers $N --arcs 20,slider=10,most=2,each=2 -q --format tsv --pairs pairs.tsv
    [ "$(column proven <<<"$output")" = "1 1 1" ]
    [ "$(column arc_deg pairs.tsv | cut -c 1-8)" = "0 20 20" ]
    [ "$(column slider_deg pairs.tsv)" = "10 0 10" ]
    run -0 --separate-stderr conus $N --arcs 20,slider=10,most=1
    [[ "$stderr" == *"conus: A, B, C: no combination: 2 arcs are needed, 1 allowed"* ]]
    run -0 --separate-stderr conus $N --arcs 20,slider=10,each=1
    [[ "$stderr" == *"conus: A, B, C: no combination: 2 needles on an arc are needed, 1 allowed"* ]]
    run -0 --separate-stderr conus $N --arcs 20,slider=10,most=1,each=1
    [[ "$stderr" == *"conus: A, B, C: no combination: on so few arcs, with so few on each; no other limit"* ]]
    run -0 --separate-stderr conus $N --arcs 20,slider=10.1
    [[ "$stderr" == *"conus: A, B: no combination: neither another margin"* ]]
    run -0 --separate-stderr conus $N --arcs 20.1,slider=1
    [[ "$stderr" == *"conus: A, C: no combination: neither another margin"* ]]
    sed -i 's/A.tsv\t/A.tsv\t1/; s/B.tsv\t/B.tsv\t2/' needles.tsv
    run -0 --separate-stderr conus $N --arcs 20,slider=10
    [[ "$stderr" == *"conus: A, B: no combination: "* ]]
    sed -i 's/B.tsv\t2/B.tsv\t1/' needles.tsv
    answers $N --arcs 20,slider=10 -q --format tsv
    [ "$(column proven <<<"$output")" = "1 1 1" ]
    conus $N --arcs 20,slider=10,most=3 -q -o plan.tsv
    jq -e '.Plan.arcs == {spacing_deg: 20, slider_deg: 10, same_deg: 0.5, most: 3, each: null, pitch_deg: 0}' plan.json
    jq -e '.Plan.rows | map(.arc) == ["1", "1", null]' plan.json
    conus verify plan.tsv
    # of people's table each number is that of the rows, and it fits a terminal; the rig is pitched by 14 degrees
    conus $N --arcs 20,slider=10,pitch=14 -q -o plan.tsv --force
    not grep -q all_contacts plan.tsv
    awk -F '\t' -v OFS='  ' 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
        { printf "%s", $at["needle"]; split("arc_deg slider_deg x y z tip_x tip_y tip_z", names, " ")
          for (i = 1; i <= 8; i++) { v = sprintf("%.2f", $at[names[i]]); printf " %s", v == "-0.00" ? "0.00" : v }
          print "" }' plan.tsv >wanted
    conus $N --arcs 20,slider=10,pitch=14 -q >people
    grep -E '^[ABC] ' people | head -n 3 | tr -s ' ' | cmp - wanted
    [ "$(head -n 3 wanted | cut -d ' ' -f 2,3 | tr '\n' ' ')" = "14.00 0.00 14.00 10.00 34.00 0.00 " ]
    [ "$(wc -L <people)" -le 80 ]
    # only candidates are cut: names of needles differ at their ends
    long='Trajectory to the left anterior hippocampus'
    sed -i "s/^\([ABC]\)\t/$long \1\t/" needles.tsv
    sed -i 's/^[ABC]\t/a candidate with a name as long as this &/' ?.tsv
    conus $N --arcs 20,slider=10 -q >people
    for name in A B C; do [ "$(grep -c "^$long $name  " people)" = 2 ]; done
    [ "$(grep -c "^$long [ABC]  a candida\.\.\.  .*  Sphere  " people)" = 3 ]
}

@test "a plan that is given whole says what is amiss with it, and no more" {
    needles
    poses given 0 3 -3
    sed -i 's/^given-0/A/; s/^given-3/B/; s/^given--3/C/' given.tsv
    given="$N --given given.tsv -q"
    run -0 --separate-stderr conus $given --contacts 4,1,2,1 --cover U,contacts=400
    [[ "$output" == "these needles have too few contacts in covers"$'\n'"needle "* ]]
    run -0 --separate-stderr conus $given --arcs 20,slider=1e-9,same=5,each=2
    [[ "$output" == "these needles are on too many arcs, or too many on one arc"$'\n'* ]]
    run -0 --separate-stderr conus $given --between 3
    [[ "$output" == "these needles do not go together"$'\n'* ]]
    run -0 --separate-stderr conus $given --length 30,40
    [[ "$output" == "some needle breaks a constraint of its own"$'\n'* ]]
}

# Contacts of 2 mm, 1.5 mm apart, from the tip on: 10 of D08-10AM as 10 of 3.5 mm, the first at 1 mm.
@test "electrodes are known by their names" {
    needles
    for electrode in D08-10AM=10,1,3.5,1 d08-18am=18,1,3.5,1 2102-16-091=16,1,3.5,1 2102-16-093=16,1,4.43,1; do
        for contacts in ${electrode/=/ }; do
            conus $N --contacts $contacts --cover U -q --force -o $contacts.tsv
        done
        cmp "${electrode%=*}.tsv" "${electrode#*=}.tsv"
    done
    fails 2 '--contacts: "D08-11AM" is not COUNT,COLUMNS,PITCH,TIP: two whole numbers from 1 on and two lengths in mm, nor an electrode' \
        $N --contacts D08-11AM --cover U
}

@test "bad tables and options are refused with what is wrong" {
    needles
    refused 'needles.tsv: no needles in it' $N <<<"$(table 'needle\tposes')"
    table 'needle\traech' 'A\tU'
    refused 'column raech: did you mean reach?' $N
    table 'needle\tformat' 'A\ttsv'
    refused 'column format: that is an option of all needles together' $N
    table 'needle\txyzzyplugh' 'A\tU'
    refused 'column xyzzyplugh is neither needle' $N
    table 'poses' 'a.tsv'
    refused 'needles.tsv: no column needle' $N
    table 'needle\tneedle\tposes' 'A\tB\ta.tsv'
    refused 'needles.tsv: two columns needle' $N
    table 'needle\tposes\tonce\tonce.1' 'A,B\ta.tsv\t1\t0'
    refused 'needles.tsv: two columns once' $N
    table 'needle\tposes' '\ta.tsv'
    refused 'needles.tsv: line 2: no needle' $N
    table 'needle\tposes' 'n/a\ta.tsv'
    refused 'needles.tsv: line 2: no needle' $N
    for names in 'A,' ',A' 'A,,B' ' ' 'A,n/a'; do
        table 'needle\tposes' "$names\ta.tsv"
        refused 'needles.tsv: line 2: no needle' $N
    done
    table 'needle\tposes' 'A/B\ta.tsv'
    refused 'line 2: needle A/B: a name without "/"' $N
    table 'needle\tposes' 'A, B,A\ta.tsv'
    refused 'line 2: needle A is named twice' $N
    table 'needle\tposes\tonce' 'A,B\ta.tsv\tyes'
    refused 'needles.tsv: line 2: once: yes is neither 0 nor 1' $N
    table 'needle\tposes\tonce' 'A,B\ta.tsv\t2'
    refused 'needles.tsv: line 2: once: 2 is neither 0 nor 1' $N
    table 'needle\tposes\tonces' 'A,B\ta.tsv\t1'
    refused 'column onces: did you mean once?' $N
    table 'needle\tposes' 'A,B,C,D,E,F,G,H,I\ta.tsv' 'J,K,L,M,N,O,P,Q\tb.tsv'
    refused 'needles.tsv: more than 16 needles' $N
    { echo -e 'needle\tposes'; for i in {1..65}; do echo -e "A\ta.tsv"; done; } >needles.tsv
    refused 'needles.tsv: more than 64 rows' $N
    table 'needle\tposes' 'A'
    refused 'needles.tsv: line 2: no candidates given' $N
    table 'needle\tposes' 'A\ta.tsv\tb.tsv'
    refused 'line 2: 3 cells, the header has 2' $N
    table 'needle\tposes' 'A\t"a.tsv'
    refused 'line 2: a quotation mark is not closed' $N
    table 'needle\tposes\tradius' 'A\ta.tsv\tthick'
    refused 'needles.tsv: line 2: --radius: ' $N
    table 'needle\treach' 'A\tU'
    refused 'needles.tsv: line 2: no candidates given' $N
    table 'needle\tfrom' 'A\ta.tsv'
    refused 'needles.tsv: line 2: no targets given' $N
    table 'needle\tposes\tfrom' 'A\ta.tsv\ta.tsv'
    refused 'needles.tsv: line 2: --from and --poses exclude each other' $N --toward centroid --depth target
    table 'needle\tposes' 'A\ta.tsv'
    refused 'needles.tsv: line 2: no constraint given' plan u-shape.nii.gz --needles needles.tsv
    table 'needle\tposes\tpart' 'A\ta.tsv\tthick'
    refused 'line 2: --part: "thick" is not RADIUS' $N
    table 'needle\tposes\tpart' 'A\ta.tsv\t1,2'
    refused 'line 2: --part: "1,2" is not RADIUS' $N
    table 'needle\tposes\tpart' 'A\ta.tsv\t0,2:2'
    refused 'A: part 1: a point without a radius has no extent' $N
    table 'needle\tposes\treach' 'A\ta.tsv\tNowhere'
    refused 'A: ' $N
    table 'needle\tposes' 'A\t-'
    refused 'line 2: --poses needs a file, which is read several times' $N
    { echo -e 'needle\tposes'; for i in {1..17}; do echo -e "N$i\ta.tsv"; done; } >needles.tsv
    refused 'needles.tsv: more than 16 needles' $N
    table 'needle\tposes' 'A\ta.tsv'
    refused '--between: "near" is not MM[,parts=MM]' $N --between near
    refused '--between: "5,part=1" is not MM[,parts=MM]' $N --between 5,part=1
    refused '--between: 101: allowed are 0 to 100 mm' $N --between 101
    refused '--entry-distance' $N --entry-distance 101
    for arcs in x 0 -1 181 nan 10:20; do
        refused "--arcs: \"$arcs\": the degrees between two arcs are to be above 0, up to 180" $N --arcs="$arcs"
    done
    refused '--arcs: same: 5 degrees, allowed is less than half of the 10 between two arcs' $N --arcs 10,same=5
    refused '--arcs: same: 0.5 degrees, allowed is less than half of the 0.9 between two arcs' $N --arcs 0.9
    for key in slider=0 slider=181 same=0 most=0 most=17 most=1.5 each=0 each=x; do
        refused "${key%=*}: found \"${key#*=}\"" $N --arcs "16,$key"
    done
    table 'needle' 'A'
    for grid in 'slider=0:0:1,back=3' 'arc=0:10:0,slider=0:0:1,back=3' 'arc=10:0:1,slider=0:0:1,back=3'; do
        refused '--from angles: arc=FIRST:LAST:STEP is needed' $N --from "angles,$grid" --toward centroid --depth target
    done
    refused '--from angles: slider=FIRST:LAST:STEP' $N --from angles,arc=0:9:1,back=3 --toward centroid --depth target
    refused '--from angles: back=MM is needed' $N --from angles,arc=0:9:1,slider=0:0:1 --toward centroid --depth target
    refused 'allowed is a number above 0, up to 500 mm' $N --from angles,arc=0:9:1,slider=0:0:1,back=12000 --toward centroid --depth target
    refused 'more than 1000000 directions' $N --from angles,arc=0:9:0.001,slider=0:9:0.01,back=3 --toward centroid --depth target
    refused '--entry-distance has no effect with --from angles' $N --from angles,arc=0:9:1,slider=0:0:1,back=3 --toward centroid \
        --depth target --entry-distance 3
    refused 'three numbers of degrees FIRST:LAST:STEP are needed' $N --from angles,arc=0:9,back=3 --toward centroid --depth target
    refused '--arcs has no effect without --needles' plan u-shape.nii.gz --poses a.tsv --reach U --arcs 16
    table 'needle\tposes\tarc' 'A\ta.tsv\tfirst'
    refused 'needles.tsv: line 2: arc first has no effect without --arcs' $N
    table 'needle\tposes\tarc\tarc' 'A\ta.tsv\tfirst\tfirst'
    refused 'needles.tsv: two columns arc' $N --arcs 16
    table 'needle\tposes' 'A\ta.tsv'
    refused '--between has no effect without --needles' plan u-shape.nii.gz --poses a.tsv --reach U --between 5
    refused '--part has no effect without --needles' plan u-shape.nii.gz --poses a.tsv --reach U --part 1,0:5
    refused '--top 3 of combinations: say by how much they have to differ: --diverse MM' $N --top 3
    refused '--diverse has no effect without --top above 1' $N --diverse 3
    refused '--diverse has no effect without --top above 1' $N --diverse 3 --top 1
    refused '--diverse has no effect without --needles' plan u-shape.nii.gz --poses a.tsv --reach U --top 2 --diverse 3
    for top in all 0 101 2.5 -1; do
        refused "--top: \"$top\": of combinations 1 to 100 can be listed" $N --top=$top --diverse 1
    done
    for diverse in x 1,0 1,17 1,1.5 1,2,3 nan 1, ,1; do
        refused "--diverse: \"$diverse\" is not MM[,COUNT], with a COUNT of 1 to 16 needles" $N --top 2 --diverse "$diverse"
    done
    refused '--diverse: -1: allowed are 0 to 100 mm' $N --top 2 --diverse=-1
    refused '--diverse: 101: allowed are 0 to 100 mm' $N --top 2 --diverse 101
    refused '--diverse: in 2 needles, but there are 1' $N --top 2 --diverse 1,2
    for option in '--rank depth' '--infeasible' '--constraints c.tsv' '--tolerance t.tsv' '--jitter 1,1' '--score depth'; do
        refused "--needles and ${option%% *} exclude each other: combinations have the one order that is proven, " $N $option
    done
    printf 'query_id\tx\ty\tz\tdx\tdy\tdz\tfar\nZ\t40\t3\t5\t-1\t0\t0\t26\n' >given.tsv
    refused 'given.tsv:2: Z is no needle of needles.tsv' $N --given given.tsv
    sed -i 's/^Z/A/; $p' given.tsv
    refused 'given.tsv:3: A is given twice' $N --given given.tsv
    run -3 --separate-stderr conus plan u-shape.nii.gz --needles nowhere.tsv --reach U
}

@test "a run that is ended before there is a combination leaves nothing" {
    needles
    awk 'BEGIN { OFS = "\t"; print "query_id\tx\ty\tz\tdx\tdy\tdz\tfar"
        for (i = 1; i <= 2000; i++) print "n" i, 40, i % 13 - 6, 5, -1, 0, 0, 20 + i % 7 }' >a.tsv
    for signal in INT TERM; do
        hold $N --threads 1 -o cut.tsv
        wait_until "$pid" catches_signals "$pid"
        code=130
        [ $signal = INT ] || code=143
        stop_held $signal $code
        grep -q '^conus: interrupted before a combination was found$' said
        [ ! -e cut.tsv ] && [ ! -e cut.json ]
    done
}
