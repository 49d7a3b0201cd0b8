#!/usr/bin/env bats
# conus plan: poses against constraints.
#
# The U of u-shape: an axis from x = 40 along -x at z = 5 passes its one arm at the depths 18 to 28 and the ball at 35 to
# 45, in voxels of 1 mm whose faces are at whole numbers (segments.bats). So of needles of radius 1 mm, by their far ends:
#   far  in U  ball is away   tip
#    30    10   5 at 30       in none
#    26     8   9 at 26       in U
#    36    10   0 from 35 on  in the ball
#    20     2  15 at 20       in U

load helpers

needles() {
    conus phantom u-shape -o .
    printf '%s\t40\t0\t5\t-1\t0\t0\t%s\n' query_id far a 30 b 26 c 36 d 20 |
        sed '1s/.*/query_id\tx\ty\tz\tdx\tdy\tdz\tfar/' >needles.tsv
    U='plan u-shape.nii.gz --poses needles.tsv --radius 1'
}

# columns NAME...: these cells of the TSV in $output, numbers with 4 digits behind the point.
columns() {
    awk -F '\t' -v names="$*" '
        NR == 1 { n = split(names, name, " "); for (i = 1; i <= NF; i++) at[$i] = i; next }
        { for (i = 1; i <= n; i++) {
              cell = $at[name[i]]
              printf "%s%s", cell ~ /^-?[0-9.]+$/ ? sprintf("%.4f", cell) + 0 : cell, i < n ? " " : ";" } }' <<<"$output"
}

# With a margin of 3 mm the slack of a is 5 - 1 - 3 = 1 mm, that of b 5 mm. The reach of 5 mm has the leeway d with 10 -
# 2 d = 5, where both ends of the arm count, which is 2.5 mm for a and b.
@test "feasible poses are listed, the largest leeway first" {
    needles
    answers $U --reach U,length=5 --avoid Ball,margin=3 --format tsv -q
    [ "$(head -1 <<<"$output" | tr '\t' ' ')" = "query rank feasible broken entry target x y z dx dy dz tip_x tip_y tip_z far_mm entry_angle_deg leeway_mm leeway_of slack_mm clearance_mm clearance_of clearance_at_mm score p_ok reach1_mm avoid1_mm avoid1_at_mm" ]
    [ "$(columns query rank feasible broken tip_x far_mm leeway_mm leeway_of)" = "b 1 1 n/a 14 26 2.5 U;a 2 1 n/a 10 30 1 Ball;" ]
    [ "$(columns slack_mm clearance_mm clearance_of clearance_at_mm)" = "5 8 Ball 26;1 4 Ball 30;" ]
    [ "$(columns reach1_mm avoid1_mm avoid1_at_mm)" = "8 9 26;10 5 30;" ]
}

@test "for people: the funnel, and that it is a list to be checked" {
    needles
    run -0 --separate-stderr conus $U --reach U,length=5 --avoid Ball,margin=3
    [[ "$stderr" == *"conus: 4 candidates: 3 have at least 5 mm of the axis in U; 2 of these have more than 3 mm of clearance from Ball"* ]]
    [[ "$stderr" == *"a plan is a list to be checked"* ]]
    [[ "${lines[0]}" == "rank  candidate "*"depth  leeway  clearance  from  at depth  reach1" ]]
    [[ "${lines[2]}" == "   1  b  "*" 26.00    2.50       8.00  Ball     26.00    8.00" ]]
    [[ "$output" != *score* && "$output" != *breaks* ]]
}

@test "poses that break something come behind, by candidate" {
    needles
    answers $U --reach U,length=5 --avoid Ball,margin=3 --infeasible --format tsv -q
    [ "$(columns query rank feasible broken leeway_mm clearance_mm)" = "b 1 1 n/a 2.5 8;a 2 1 n/a 1 4;c n/a 0 Ball 0 -1;d n/a 0 U 0 14;" ]
    answers $U --reach U,length=5 --avoid Ball,margin=3 --infeasible --top 3 --format tsv -q
    [ "$(columns query)" = "b;a;c;" ]
}

@test "none is feasible: the funnel, and the nearest misses" {
    needles
    run -0 --separate-stderr conus $U --reach U,length=5 --avoid Ball,margin=9 -o plan.tsv
    [ "$(wc -l <plan.tsv)" -eq 1 ]
    [ -z "$output" ]
    [[ "$stderr" == *"; none of these has more than 9 mm of clearance from Ball"* ]]
    [[ "$stderr" == *"d breaks only one of them, at least 5 mm of the axis in U: it has 2"* ]]
    [[ "$stderr" == *"b breaks only one of them, more than 9 mm of clearance from Ball: it has 8"* ]]
    [ "$(jq -c '.Plan | [.candidates, .funnel, .nearest_misses]' plan.json)" = \
        '[4,[3,0],[{"query":"d","value":2,"slack":-3},{"query":"b","value":9,"slack":-1}]]' ]
    run -0 --separate-stderr conus $U --reach U,length=50 --avoid Ball,margin=20
    [ "${lines[0]}" = "(no pose holds all constraints)" ]
    [[ "$stderr" == *"every candidate breaks more than one of them"* ]]
}

# The needle of other.tsv is 6 mm beside those here. The axes are at 45 degrees to (-1, 0, 1).
@test "all kinds of constraints, in the order of the command line" {
    needles
    printf 'x\ty\tz\tdx\tdy\tdz\tfar\n40\t6\t5\t-1\t0\t0\t30\n' >other.tsv
    answers $U --lean=-1,0,1,46 --length 22,40 --apart other.tsv,5 --first U --reach U,length=1,part=0:3 --format tsv -q
    [ "$(head -1 <<<"$output" | tr '\t' ' ' | sed 's/.* p_ok //')" = "lean1_deg length1_mm apart1_mm first1 reach1_mm" ]
    [ "$(columns query lean1_deg length1_mm apart1_mm first1 reach1_mm leeway_of)" = "b 45 26 6 1 3 apart;a 45 30 6 1 1 U;" ]
    answers $U --reach U,tip --format tsv -q --rank depth
    [ "$(columns query reach1_tip)" = "b 1;d 1;" ]
    answers $U --reach Ball,crossed --format tsv -q
    [ "$(columns query reach1_crossed)" = "c 1;" ]
    for none in --lean=-1,0,1,44 '--apart other.tsv,6' '--first Ball' '--length 37,40' '--reach Ball,tip,part=0:1'; do
        run --separate-stderr conus $U $none --format tsv -q
        [ "${#lines[@]}" -le 1 ] || { echo "$none: $output"; false; }
    done
}

@test "the rank and scores" {
    needles
    answers $U --avoid Ball --reach U --rank reach/3,-depth --format tsv -q # steps 3, 2, 0
    [ "$(columns query)" = "a;b;d;" ]
    answers $U --avoid Ball --reach U --rank clearance --format tsv -q
    [ "$(columns query)" = "d;b;a;" ]
    answers $U --avoid Ball --reach U --score 'reach*10-clearance' --rank score --format tsv -q
    [ "$(columns query score)" = "a 96;b 72;d 6;" ]
}

@test "a row for each constraint, and how far the needle is depth by depth" {
    needles
    answers $U --reach U,length=5 --avoid Ball,margin=3 -q -o plan.tsv --constraints rows.tsv --profile profile.tsv,step=20
    output=$(<rows.tsv)
    [ "$(head -1 rows.tsv | tr '\t' ' ')" = "query constraint kind index name value limit slack holds leeway_mm p_holds shank" ]
    [ "$(columns query constraint kind index name value limit slack holds leeway_mm)" = \
        "b 1 reach 1 U 8 5 3 1 2.5;b 2 avoid 1 Ball 9 3 5 1 5;a 1 reach 1 U 10 5 5 1 2.5;a 2 avoid 1 Ball 5 3 1 1 1;" ]
    output=$(<profile.tsv)
    [ "$(columns query order depth_mm x name distance_mm clearance_mm)" = \
        "b 1 0 40 Ball 35 34;b 2 20 20 Ball 15 14;b 3 26 14 Ball 9 8;a 1 0 40 Ball 35 34;a 2 20 20 Ball 15 14;a 3 30 10 Ball 5 4;" ]
    answers $U --reach U,length=5 --avoid Ball,margin=3 -q --constraints - --format tsv
    [ "$output" = "$(<rows.tsv)" ]
    for file in plan rows profile; do
        answers verify $file.tsv
        has identical
        answers diff $file.tsv $file.tsv
    done
    answers cite rows.tsv
    output=$(tr '\n' ' ' <<<"$output")
    has 'A needle with a radius of 1 mm was tried at 4 candidate poses with conus'
    has 'constraints were: at least 5 mm of the axis in U; more than 3 mm of clearance from Ball. Of these poses 2 held all of them'
}

@test "every format, and the sidecar" {
    needles
    for ending in csv txt ndjson tsv; do
        answers $U --reach U,length=5 --avoid Ball,margin=3 -q -o plan.$ending --force
    done
    answers $U --reach U,length=5 --avoid Ball,margin=3 -q -o whole.json
    [ "$(jq -c '[.Rows[] | [.query, .rank, .avoid1_mm]]' whole.json)" = '[["b",1,9],["a",2,5]]' ]
    [ "$(jq -c '[.query, .clearance_of]' plan.ndjson | tr '\n' ' ')" = '["b","Ball"] ["a","Ball"] ' ]
    [ "$(tr ',' '\t' <plan.csv | tr -d '\r')" = "$(<plan.tsv)" ]
    [ "$(jq -r '.Plan.constraints[1] | [.kind, .index, .measure, .limit, .name, .asked] | join("|")' plan.json)" = \
        'avoid|1|clearance|3|Ball|more than 3 mm of clearance from Ball' ]
    [ "$(jq -c '.Question.options | [.reach, .avoid, .radius]' plan.json)" = '[["U,length=5"],["Ball,margin=3"],"1"]' ]
}

@test "what is no candidate is counted; without any there is no plan" {
    needles
    printf 'e\t40\t0\t5\t0\t0\t0\t20\n' >>needles.tsv
    run -1 --separate-stderr conus $U --reach U --format tsv -q -o plan.tsv
    check_message "needles.tsv: 1 of 5 rows are no candidates, the first in line 6: "
    [ "$(wc -l <plan.tsv)" -eq 5 ]
    [ "$(jq -c '.Plan | [.candidates, .no_candidates]' plan.json)" = '[4,1]' ]
    sed 1q needles.tsv >none.tsv
    fails 2 "none.tsv: no candidate" plan u-shape.nii.gz --poses none.tsv --reach U
    cut -f 1-7 needles.tsv | sed 6d >ends.tsv
    fails 2 "ends.tsv: no candidate: line 2: " plan u-shape.nii.gz --poses ends.tsv --reach U
    answers plan u-shape.nii.gz --poses - --reach U --depth 30 --format tsv -q <ends.tsv
    [ "$(columns query far_mm | tr ';' '\n' | wc -l)" -eq 4 ]
}

@test "invalid options are refused with a line" {
    needles
    fails 2 'did you mean "Ball"' $U --reach Bal1
    fails 2 'did you mean length' $U --reach U,lenght=5
    fails 2 'length: found "x", allowed is a number' $U --reach U,length=x
    fails 2 'has a comma in it' $U --reach U,length=0,5
    fails 2 'tip: no value is allowed' $U --reach U,tip=3
    fails 2 'has 2 measures, an option has one' $U --reach U,tip,length=3
    fails 2 '",length=3" names no structure' $U --reach ,length=3
    fails 2 'part: found "3:1", allowed is A:B' $U --reach U,part=3:1
    fails 2 'margin: found "101", allowed is a number from 0 to 100' $U --avoid U,margin=101
    fails 2 'margin: found "nan", allowed is a number' $U --avoid U,margin=nan
    fails 2 'found "length=3", allowed are share, pierced, margin, shank' $U --avoid U,length=3
    fails 2 '--avoid: "Ball,2" ends in a number: margin=2 is in mm' $U --reach U --avoid Ball,2
    fails 2 '--reach: "U, 0.5" ends in a number: length=0.5 is in mm' $U --reach 'U, 0.5'
    run -0 conus $U --reach 'U,"2"' -q
    run -0 conus $U --reach 1,2 -q
    run -0 conus $U --reach U --first U,2 -q
    fails 2 'is not four numbers' $U --lean 0,0,1
    fails 2 'has no length' $U --lean 0,0,0,30
    fails 2 'allowed are 0 to 180' $U --lean 0,0,1,190
    fails 2 'lower one first' $U --length 90,3
    fails 2 'is not FILE,MM' $U --apart needles.tsv
    fails 3 'nobody.tsv' $U --apart nobody.tsv,3
    fails 2 'avoids all that constraint' $U --reach U --avoid U
    fails 2 'no constraint given' $U
    fails 2 'no candidates given: --poses FILE' plan u-shape.nii.gz --reach U
    fails 2 'neither a whole number above 0 nor all' $U --reach U --top 0
    fails 2 'exclude each other' $U --reach U --depth 3 --range 0,3
    fails 2 'no effect without --avoid' $U --reach U --profile -
    fails 2 'both on standard output' $U --avoid U --profile - --constraints -
    fails 2 'leewy' $U --reach U --rank leewy
    fails 2 'not two numbers DEGREES,MM' $U --reach U --jitter 2
    fails 2 'a tilt of 91 degrees' $U --reach U --jitter 91,1
    fails 2 'is not entry=MM,target=MM' $U --reach U --jitter entry=1
    fails 2 'is not entry=MM,target=MM' $U --reach U --jitter entry=1,target=-2
    fails 2 'is not entry=MM,target=MM' $U --reach U --jitter entry=1,target=2,entry=3
    fails 2 'no power of two' $U --reach U --jitter 2,1 --samples 100
    fails 2 'no effect without --jitter' $U --reach U --samples 64
    fails 2 'p_ok: without errors' $U --reach U --rank p_ok
    fails 2 'no effect without --contacts' $U --reach U,contacts=3
    fails 2 'no effect without --reach' $U --reach U --contacts 8,1,1,0
    fails 2 'is not COUNT,COLUMNS' $U --reach U,contacts=3 --contacts 8,1,1
    fails 2 'has no probabilities' $U --reach U,probability=0.5
    fails 2 'U has no streamlines' $U --reach U,streamlines=1
    fails 2 'probability: found "2", allowed is a number from 0 to 1' $U --reach U,probability=2
    nothing_left needles.tsv u-shape.nii.gz u-shape.tsv u-shape.json
}

# The depth has a normal error of 2 mm. b and a end 3 and 7 mm behind 23, where the reach is just long enough, and 5 and
# 1 mm before 31, where the ball's margin begins. So b is feasible with the probability of an error from -3 to 5 mm, a
# of one from -7 to 1.
@test "the probability that a pose with errors is feasible" {
    needles
    local ask="$U --reach U,length=5 --avoid Ball,margin=3 --jitter entry=0,target=0,depth=2 --samples 4096 -q"
    answers $ask --format tsv --rank p_ok
    [ "$(columns query rank)" = "b 1;a 2;" ]
    [ "$(head -1 <<<"$output" | tr '\t' ' ' | sed 's/.* score //')" = "p_ok reach1_mm p_reach1 avoid1_mm avoid1_at_mm p_avoid1" ]
    awk -F '\t' 'function near(a, b) { return a > b - 0.002 && a < b + 0.002 }
        NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
        $1 == "b" { fine += near($at["p_ok"], 0.9270) + near($at["p_reach1"], 0.9332) + near($at["p_avoid1"], 0.9938) }
        $1 == "a" { fine += near($at["p_ok"], 0.6912) + near($at["p_reach1"], 0.9998) + near($at["p_avoid1"], 0.6915) }
        END { exit fine != 6 }' <<<"$output"
    answers $ask -o plan.tsv --constraints rows.tsv --threads 1
    answers $ask -o again.tsv --constraints again-rows.tsv --threads 3
    cmp plan.tsv again.tsv
    cmp rows.tsv again-rows.tsv
    jq -e '.Plan.jitter == {"samples": 4096, "entry_mm": 0, "target_mm": 0, "depth_mm": 2}' plan.json
    answers verify plan.tsv
    answers $U --reach U --jitter 3,1 --samples 64 -q
    [[ "${lines[0]}" == *"p ok"* ]]
}

# Contacts every 2 mm from the tip on; the U is from 18 to before 28. Of a and b the contacts at 26, 24, 22, 20 and 18
# are in it, of c, whose last one is at 22, three, of d those at 20 and 18.
@test "contacts in a structure" {
    needles
    answers $U --reach U,contacts=5 --contacts 8,1,2,0 --format tsv -q --infeasible
    [ "$(columns query feasible reach1_contacts)" = "b 1 5;a 1 5;c 0 3;d 0 2;" ]
    answers $U --reach U,contacts=10 --contacts 16,2,2,0 -q -o plan.tsv
    [ "$(wc -l <plan.tsv)" -eq 3 ]
    jq -e '.Plan.constraints[0] | .measure == "contacts" and .contacts == {"count": 16, "columns": 2, "pitch_mm": 2,
        "tip_mm": 0}' plan.json
}

# A has 0.08 k in the slices k = 0 to 11, which lie from z = -6 to 6. From z = -8 to 6 the mean is 0.08 (0 + ... + 11)
# over 14 mm; contacts at 5.5, 3.5 and 1.5 are in the slices 11, 9 and 7.
@test "probabilities along the axis and of contacts" {
    /usr/bin/python3 - <<'END'
import struct
dim = (8, 8, 12)
head = bytearray(352)
struct.pack_into("<i", head, 0, 348)
struct.pack_into("<8h", head, 40, 3, *dim, 1, 1, 1, 1)
struct.pack_into("<2h", head, 70, 2, 8)
struct.pack_into("<8f", head, 76, 1, 1, 1, 1, 1, 1, 1, 1)
struct.pack_into("<3f", head, 108, 352, 0.01, 0)
struct.pack_into("<2h", head, 252, 0, 1)
for row in range(3):
    line = [0.0] * 4
    line[row], line[3] = 1, -(dim[row] - 1) / 2
    struct.pack_into("<4f", head, 280 + 16 * row, *line)
head[344:348] = b"n+1\0"
open("map.nii", "wb").write(bytes(head) + bytes(8 * (n // 64) for n in range(64 * 12)))
END
    needles
    printf 'x\ty\tz\tdx\tdy\tdz\tfar\n0.2\t0.3\t-8\t0\t0\t1\t14\n' >up.tsv
    local ask='plan u-shape.nii.gz --pathway map.nii,threshold=0.25,name=A --poses up.tsv --format tsv -q'
    answers $ask --reach A,probability=0.3
    [ "$(columns reach1_probability)" = "0.3771;" ]
    answers $ask --reach A,probability=0.3 --contacts 3,1,2,0.5
    [ "$(columns reach1_probability)" = "0.72;" ]
}

# b ends 5 mm before the margin of the ball, and has 8 of 5 mm in U, 3 mm more than needed.
@test "how far each pose may be off" {
    needles
    answers $U --reach U,length=5 --avoid Ball,margin=3 --tolerance - --format tsv -q
    [ "$(head -1 <<<"$output" | tr '\t' ' ')" = "query freedom side unit holds_to fails_at breaks object depth_mm x y z method" ]
    [ "$(wc -l <<<"$output")" -eq 41 ]
    output=$(awk -F '\t' 'NR == 1 || (($2 == "x" || $2 == "depth") && $1 == "b")' <<<"$output")
    [ "$(columns query freedom side unit holds_to fails_at breaks object depth_mm method)" = \
        "b x + mm 3 3 U n/a 21 exact;b x - mm 5 5 Ball Ball 26 exact;b depth + mm 5 5 Ball Ball 31 exact;b depth - mm 3 3 U n/a 18 exact;" ]
    answers $U --reach U,length=5 --tolerance tips.tsv --pivot tip -o plan.tsv -q
    answers $U --reach U,length=5 --tolerance depths.tsv --pivot 26 -o again.tsv -q
    cmp plan.tsv again.tsv
    cmp <(grep ^b tips.tsv) <(grep ^b depths.tsv) # 26 is b's tip
    [ "$(grep ^c tips.tsv)" != "$(grep ^c depths.tsv)" ] # 36 is c's tip: its yaw is 25.6 and 30 degrees
    answers verify tips.tsv
    fails 2 'neither a number nor entry nor tip' $U --reach U --tolerance - --pivot middle
    fails 2 'pivot' $U --reach U --pivot tip
    fails 2 'both on standard output' $U --reach U --tolerance - --constraints -
}

# For a needle along -x the device's y is the world's z, its x the world's y. Shanks are at y = 0 and 30: the second
# passes nothing.
@test "several shanks: any of them reaches, all keep clear, or one is asked" {
    needles
    local two='--shanks 0,0;30,0'
    answers $U --reach U,length=5 --avoid Ball,margin=3 $two -q --format tsv -o one.tsv --constraints rows.tsv
    answers $U --reach U,length=5 --avoid Ball,margin=3 -q --format tsv -o none.tsv
    cmp one.tsv none.tsv # the axis has the best value of the reach, and the worst of the avoided structure
    [ "$(cut -f 12 rows.tsv | sort | uniq -c | tr -s ' \n' ' ')" = " 4 1 1 shank " ]
    answers $U --reach U,shank=2 $two -q --infeasible --constraints - --format tsv
    [ "$(columns query holds value shank)" = "a 0 0 2;b 0 0 2;c 0 0 2;d 0 0 2;" ]
    answers $U --avoid Ball,shank=2 --reach U,shank=1,length=5 --first U,shank=any $two -q --format tsv --rank depth
    [ "$(columns query)" = "c;a;b;" ]
    run -0 --separate-stderr conus $U --reach U,length=5,shank=all $two
    [[ "$stderr" == *"none has at least 5 mm of the axis in U, all shanks"* ]]
    answers $U --reach U,shank=1 --avoid U,shank=2 $two -q --format tsv
    [ "$(columns query | tr ';' '\n' | wc -l)" -eq 4 ]
    conus $U --reach U $two -q -o plan.tsv --poses-out lines.mrk.json --force
    [ "$(jq -r '[.markups[].controlPoints[1].label] | sort | join(" ")' lines.mrk.json)" = "a-s1 a-s2 b-s1 b-s2 c-s1 c-s2 d-s1 d-s2" ]
    [ "$(jq '.markups | length' lines.mrk.json)" -eq 8 ]
    [ "$(jq -r '[.markups[].controlPoints[0].position[1] | fabs] | unique | join(" ")' lines.mrk.json)" = "0 30" ]
    answers verify plan.tsv
    fails 2 '"1" is not two numbers X,Y' $U --reach U --shanks '0,0;1'
    fails 2 'is not two numbers X,Y' $U --reach U --shanks '0,0;'
    fails 2 'is not two numbers X,Y' $U --reach U --shanks 0,nan
    fails 2 'is at 0,1001, allowed are up to 1000 mm' $U --reach U --shanks 0,1001
    fails 2 'shank: 3, allowed are any, all and 1 to 2' $U --reach U,shank=3 $two
    fails 2 'shank: 2, but the device has one shank' $U --reach U,shank=2
    fails 2 'shank: a value is needed' $U --reach U,shank $two
    fails 2 'shank=0 is neither any nor all' $U --reach U,shank=0 $two
    fails 2 'shank is given twice' $U --reach U,shank=1,shank=any $two
    fails 2 'is not four numbers' $U --reach U --lean 0,0,1,3,shank=1
    fails 2 'avoids all that' $U --reach U --avoid U $two
}

# Rows of other commands about the same needles have the same numbers, byte for byte. A reach of several segments is
# their sum, and is not compared here.
@test "poses of the list, asked by batch, have the same answers" {
    [ -e "$TEMPLATES/aal.nii.gz" ] || skip "mricron-data is not installed"
    python3 - >needles.tsv <<END
import math
print("query_id", *"x y z tx ty tz far".split(), sep="\t")
for i in range(60):
    a, b = 0.2 + 0.045 * i, 2.4 * i
    print(f"n{i}", -28 - 60 * math.sin(a) * math.cos(b) ** 2, -20 + 60 * math.sin(a) * math.sin(b), -12 + 60 * math.cos(a), -28, -20, -12, 64, sep="\t")
END
    local ask="$TEMPLATES/aal.nii.gz --poses needles.tsv --radius 0.65"
    answers plan $ask --reach Hippocampus_L,length=5 --avoid Insula_L,margin=2 --top all --infeasible -q -o plan.tsv
    answers plan $ask --reach Hippocampus_L,length=5 --avoid Insula_L,margin=2 --top all --infeasible -q -o again.tsv --threads 3
    cmp plan.tsv again.tsv
    [ "$(awk -F '\t' '$3 == 1' plan.tsv | wc -l)" -gt 3 ]
    answers batch $ask -q --segments segments.tsv
    awk -F '\t' '$5 == "Hippocampus_L" { n[$1]++; mm[$1] = $9 } END { for (q in n) if (n[q] == 1) print q, mm[q] }' segments.tsv |
        sort >wanted
    awk -F '\t' 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next } { print $1, $at["reach1_mm"] }' plan.tsv | sort >found
    [ "$(wc -l <wanted)" -gt 20 ]
    [ "$(comm -23 wanted found)" = "" ]
    answers batch $ask -q --clearance near.tsv,within=100
    awk -F '\t' '$4 == "Insula_L" { print $1, $5, $7 }' near.tsv | sort >wanted
    awk -F '\t' 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next } { print $1, $at["avoid1_mm"], $at["avoid1_at_mm"] }' plan.tsv |
        sort >found
    cmp wanted found
}

# The same for the rows of a cone; pierced is the part of its 3228 pixels. Needles from the side towards the ball at (0,
# 0, 5); the fourth misses it.
@test "measures of a cone or cylinder are those of batch" {
    needles
    printf 'e\t0\t40\t5\t0\t-1\t0\t45\nf\t0\t40\t6\t0\t-1\t0\t38\n' >>needles.tsv
    for shape in '--radius 2' '--angle 20'; do
        answers plan u-shape.nii.gz --poses needles.tsv $shape --reach Ball,share=0.01 --reach Ball,pierced=0.1 \
            --reach Ball,volume=1 --reach Ball,fraction=0.001 --avoid U,share=0.5 --avoid U,pierced=0.5 --infeasible \
            --top all -q --format tsv
        echo "$output" >plan.tsv
        answers batch u-shape.nii.gz --poses needles.tsv $shape --layers all -q -o all.tsv --force
        awk -F '\t' 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
            $at["name"] == "Ball" && $at["pierced"] { printf "%s %s %.9g %s %s\n", $1, $at["share"], $at["pierced"] / 3228, $at["volume_mm3"], $at["fraction"] }' all.tsv |
            sort >wanted
        awk -F '\t' 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
            $at["reach2_pierced"] > 0 { print $1, $at["reach1_share"], $at["reach2_pierced"], $at["reach3_mm3"], $at["reach4_fraction"] }' plan.tsv |
            sort >found
        [ -s wanted ]
        cmp wanted found
    done
    fails 2 'no effect without a measure of the cone' $U --reach U --resolution 32
    fails 2 'share: found "2", allowed is a number from 0 to 1' $U --reach U,share=2
    fails 2 'found "volume=2", allowed are share, pierced, margin, shank' $U --avoid U,volume=2
}

# many_needles: needles.tsv with 2000 candidates of which every other one is no pose.
many_needles() {
    awk 'BEGIN {
        print "query_id\tx\ty\tz\tdx\tdy\tdz\tfar"
        for (i = 1; i <= 2000; i++)
            printf "n%d\t40\t%.3f\t5\t%d\t0\t0\t%.3f\n", i, i % 13 - 6, i % 2 - 1, 20 + i % 17 }' >needles.tsv
}

# A plan waits to write its progress behind the first blocks, so the signal comes while it tries poses.
@test "an interrupted plan lists the best of the poses that it tried, and says so in its table, JSON and sidecar" {
    needles
    many_needles
    local ask=(--reach U --radius 1 --top 7 --threads 1)
    for signal in INT TERM; do
        hold plan u-shape.nii.gz --poses needles.tsv "${ask[@]}" -o cut.tsv --force
        wait_for_block
        stop_held $signal 1
        grep -q '^conus: warning: interrupted: tried [1-9][0-9]* of 2000 poses; the list has the best of these$' said
        tried=$(sed -n 's/^conus: warning: interrupted: tried \([0-9]*\) of.*/\1/p' said)
        [ "$tried" -lt 2000 ]
        head -n $((tried + 1)) needles.tsv >tried.tsv
        run -1 conus plan u-shape.nii.gz --poses tried.tsv "${ask[@]}" -o wanted.tsv -q --force
        cmp cut.tsv wanted.tsv
        [ "$(jq -r '.Warnings[-1]' cut.json)" = "interrupted: tried $tried of 2000 poses; the list has the best of these" ]
        [ "$(jq -c .Plan cut.json)" = "$(jq -c .Plan wanted.json)" ]
    done
    run -3 conus verify cut.tsv
    [[ "$output" == *"its run was interrupted, and another one would not end at the same pose"* ]]
    hold plan u-shape.nii.gz --poses needles.tsv "${ask[@]}" --format json >cut.json
    wait_for_block
    stop_held INT 1
    jq -e '.Warnings[-1] | startswith("interrupted: tried ")' cut.json
    hold plan u-shape.nii.gz --poses needles.tsv "${ask[@]}" >cut.txt
    wait_for_block
    stop_held INT 1
    grep -q 'interrupted: tried' cut.txt
}

@test "the best of parts, planned once more, are the best of all" {
    needles
    many_needles
    local ask=(--reach U,length=2 --radius 1 --top 40 -q)
    run -1 conus plan u-shape.nii.gz --poses needles.tsv "${ask[@]}" -o whole.tsv
    head -n 1 needles.tsv >head
    tail -n +2 needles.tsv | split -l 700 - part.
    for part in part.a?; do
        cat head $part >part.tsv
        run -1 conus plan u-shape.nii.gz --poses part.tsv "${ask[@]}" --poses-out $part.tsv -o list.tsv --force
    done
    { cat part.aa.tsv; tail -qn +2 part.ab.tsv part.ac.tsv; } >best.tsv
    conus plan u-shape.nii.gz --poses best.tsv "${ask[@]}" -o again.tsv
    [ "$(wc -l <whole.tsv)" -eq 41 ]
    cmp whole.tsv again.tsv
}
