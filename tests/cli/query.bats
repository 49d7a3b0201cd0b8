#!/usr/bin/env bats
# conus query, as a user types it.
load helpers

# The same pixels and distance by numpy: the label of the nearest voxel along each of the 208 rays, in steps of 0.002
# mm.
@test "AAL from the left, by 16 x 16 rays" {
    need_aal
    answers query "$aal" --origin=-90,20,20 --toward=0,-10,10 --angle 20 --resolution 16 --format tsv
    [ "${#lines[@]}" -eq 5 ]
    [ "$(cell name 1)/$(cell pixels 1)/$(cell index 1)" = Frontal_Inf_Oper_L/188/11 ]
    [[ "$(cell distance_mm 1)" == 25.5313* ]]
    [ "$(cell name 2)/$(cell pixels 2)" = Precentral_L/16 ]
    [ "$(cell name 3)/$(cell pixels 3)" = Postcentral_L/4 ]
    [ "$(cell kind 4)/$(cell pixels 4)" = unassigned/0 ]
    awk -F'\t' 'NR > 1 { sum += $9 } END { exit !(sum > 1 - 1e-6 && sum < 1 + 1e-6) }' <<<"$output"
}

@test "vectors may begin with a minus, after a space or an equals sign" {
    need_aal
    answers query "$aal" --origin=-90,20,20 --toward=0,-10,10 --angle=20 --format=tsv
    local equals=$output
    answers query --toward 0,-10,10 --angle 20 "$aal" --format tsv --origin -90,20,20
    [ "$output" = "$equals" ]
    answers query "$aal" --origin -90,20,20 --direction 9,-3,-1 --angle 20 --format tsv
    [ "$(cell pixels 1)" = 2921 ]
}

@test "LPS positions are the mirrored RAS ones, given and reported" {
    need_aal
    answers query "$aal" --origin -90,20,20 --toward 0,-10,10 --angle 20 --format tsv
    local x=$(cell contact_x 1) y=$(cell contact_y 1) z=$(cell contact_z 1)
    answers query "$aal" --origin 90,-20,20 --toward 0,10,10 --angle 20 --format tsv --space lps
    [ "$(cell contact_x 1)/$(cell contact_y 1)/$(cell contact_z 1)" = "${x#-}/-$y/$z" ]
    answers query "$aal" --origin 90,0,10 --direction -1,0,0 --space lps
    has 'from (90.00, 0.00, 10.00) along (-1.0000, 0.0000, 0.0000), LPS mm'
    printf 'x\ty\tz\ttx\tty\ttz\tangle\n90\t-20\t20\t0\t10\t10\t20\n' >poses.tsv
    answers query "$aal" --pose poses.tsv --format tsv --space lps
    [ "$(cell contact_x 1)/$(cell pixels 1)" = "${x#-}/2921" ]
}

@test "a ball of 20 mm is hit at 80 mm from 100 mm away" {
    sphere --size 64
    answers query sphere.nii.gz --origin 0,0,100 --direction 0,0,-1 --angle 5 --format tsv
    [ "$(cell name 1)/$(cell pixels 1)/$(cell share 1)" = Sphere/3228/1 ]
    awk -v d="$(cell distance_mm 1)" 'BEGIN { exit !(d > 79 && d < 81) }'
}

@test "the table for people has units, an unassigned row and its settings" {
    sphere --size 32 --spacing 2,2,2
    answers query sphere.nii.gz --origin 0,0,100 --toward 0,0,0 --angle 40
    has 'cone of 40 degrees from (0.00, 0.00, 100.00)'
    has 'Sphere'
    has '(nothing hit)'
    has '3228 pixels in the cone'
    has 'atlas sphere.nii.gz, placed by sform, code 1'
}

@test "JSON and NDJSON hold the same rows" {
    sphere --size 32 --spacing 2,2,2
    local aim='--origin 0,0,100 --toward 0,0,0 --angle 40'
    answers query sphere.nii.gz $aim --format json
    has '"name": "Sphere"'
    answers query sphere.nii.gz $aim --format ndjson
    [ "${#lines[@]}" -eq 2 ]
    [[ "${lines[0]}" == '{"query":'*'"name":"Sphere"'* ]]
}

@test "-o writes the answer whole, in the form that its ending says, with a sidecar" {
    sphere --size 32
    local aim='--origin 0,0,100 --toward 0,0,0'
    answers query sphere.nii.gz $aim -o a.tsv
    [ -z "$output" ]
    grep -q '"pixels"' a.json
    grep -q "conus query sphere.nii.gz --origin 0,0,100 --toward 0,0,0 -o a.tsv" a.json
    answers query sphere.nii.gz $aim --format tsv
    [ "$output" = "$(cat a.tsv)" ]
    answers query sphere.nii.gz $aim -o b.json
    grep -q Sphere b.json
    answers query sphere.nii.gz $aim -o c.txt
    grep -q 'pixels in the cone' c.txt
    answers query sphere.nii.gz $aim -o - --format ndjson
    has '"Sphere"'
    jq -e '.Outputs[0].path == "c.txt" and .Outputs[0].sha256 == $sum' c.txt.json \
        --arg sum "$(sha256sum c.txt | cut -d ' ' -f 1)"
    nothing_left sphere.{nii.gz,tsv,json} a.{tsv,json} b.json c.txt{,.json}
}

# checksum SIDECAR: computed as docs/formats.md describes; numbers are as in the file, with 9 digits.
checksum() {
    python3 - "$1" <<'END'
import hashlib, json, re, sys
text = json.load(open(sys.argv[1], encoding="utf-8"), parse_float=lambda digits: f"@{digits}@")
keys = "Space GeneratedBy Atlas Atlases Settings Queries Batch Inputs Outputs Sources Question".split()
part = json.dumps({key: text[key] for key in keys if key in text}, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
print(hashlib.sha256(re.sub('"@([^@]*)@"', r"\1", part).encode()).hexdigest())
END
}

@test "a sidecar says what was read and written, and an answer on standard output has one, too" {
    sphere --size 16
    printf 'query_id\tx\ty\tz\ttx\tty\ttz\n1\t0\t0\t90\t0\t0\t0\n' >poses.tsv
    local sums=()
    conus query sphere.nii.gz --pose poses.tsv --format tsv --sidecar one.json --mask in.nii.gz >rows.tsv
    for file in poses.tsv in.nii.gz rows.tsv; do
        sums+=("$(sha256sum $file | cut -d ' ' -f 1)")
    done
    [ "$(jq -r '.Inputs[], .Outputs[] | .sha256' one.json)" = "$(printf '%s\n' "${sums[@]}")" ]
    [ "$(jq -c '[.Outputs[].path]' one.json)" = '["in.nii.gz",null]' ]
    [ "$(jq '[.Inputs[], .Outputs[], .Atlas.volumes[], .Atlas.files[] | .bytes] | add' one.json)" -eq \
        "$(cat poses.tsv in.nii.gz rows.tsv sphere.nii.gz sphere.tsv | wc -c)" ]
    # As docs/formats.md describes, by another program.
    [ "$(jq -r .Checksum one.json)" = "$(checksum one.json)" ]
    fails 2 'does not end in .json' query sphere.nii.gz --pose poses.tsv --sidecar rows.tsv
    fails 2 'has no effect with JSON' query sphere.nii.gz --pose poses.tsv --sidecar a.json --format json
    fails 2 'are the same file' query sphere.nii.gz --pose poses.tsv -o b.tsv --sidecar in.json --mask in.nii.gz
    mv sphere.tsv t.json
    fails 2 'would overwrite the input t.json' query sphere.nii.gz --pose poses.tsv --sidecar t.json --labels t.json
}

@test "outputs keep off the inputs and each other" {
    sphere --size 32
    cp sphere.nii.gz tract.png
    local aim='--origin 0,0,100 --toward 0,0,0'
    fails 2 'would overwrite the input' query sphere.nii.gz $aim --format table -o ./sphere.nii.gz
    fails 2 '--output and --voxels are the same file' query sphere.nii.gz $aim -o a.tsv --voxels a.tsv --voxels-of all
    fails 2 '--output and --voxels are the same file' query sphere.nii.gz $aim -o ./a.tsv --voxels a.tsv --voxels-of all
    fails 2 '--output and the .json beside --mask are the same file' query sphere.nii.gz $aim -o "$PWD/a.json" --mask a.nii
    fails 2 '--output sphere.tsv would overwrite the input sphere.tsv' query sphere.nii.gz $aim -o sphere.tsv
    fails 2 '--image tract.png would overwrite the input tract.png' \
        query sphere.nii.gz $aim --pathway tract.png,threshold=1 --image tract.png
    printf 'x,y,z,dx,dy,dz\n0,0,100,0,0,-1\n' >poses.json
    fails 2 'the .json beside --output poses.json would overwrite the input poses.json' \
        query sphere.nii.gz --pose poses.json -o poses.tsv
    mkdir volumes
    cp sphere.nii.gz volumes
    printf '<atlas><header><name>a</name><type>Label</type><images><imagefile>/volumes/sphere</imagefile>%s' \
        '</images></header><data><label index="1" x="0" y="0" z="0">Ball</label></data></atlas>' >atlas.xml
    answers query atlas.xml $aim --format tsv
    [ "$(cell name 1)" = Ball ]
    fails 2 '--output atlas.xml would overwrite the input atlas.xml' query atlas.xml $aim --format table -o atlas.xml
    fails 3 'no/such/a.tsv: cannot write: No such file' query sphere.nii.gz $aim -o no/such/a.tsv
    fails 3 '.: cannot write: is a folder' query sphere.nii.gz $aim -o .
    nothing_left sphere.{nii.gz,tsv,json} tract.png poses.json atlas.xml volumes/sphere.nii.gz
}

@test "--voxels lists the voxels hit first" {
    sphere --size 32
    answers query sphere.nii.gz --origin 0,0,100 --toward 0,0,0 --angle 5 -o a.tsv --voxels v.tsv --voxels-of all
    head -1 v.tsv | grep -q $'^query\tpathway\ti\tj\tk\tx\ty\tz\tvalue\tdistance_mm'
    [ "$(wc -l <v.tsv)" -gt 5 ]
    [ "$(sort v.tsv | uniq -d | wc -l)" -eq 0 ]
}

@test "a file of poses is answered row by row; bad rows are named and end in exit code 1" {
    sphere --size 32
    printf 'query_id\tx\ty\tz\ttx\tty\ttz\tangle\n' >poses.tsv
    printf 'top\t0\t0\t100\t0\t0\t0\t5\nbad\t0\t0\tx\t0\t0\t0\t5\nside\t100\t0\t0\t0\t0\t0\t5\n' >>poses.tsv
    run -1 --separate-stderr "$CONUS" query sphere.nii.gz --pose poses.tsv --format tsv
    check_message 'poses.tsv:3: '
    [ "$(cell query 1)/$(cell name 1)" = top/Sphere ]
    [ "$(cell query 3)/$(cell kind 3)/$(cell name 3)" = 'bad/error/line 3: column z: "x" is not a finite number' ]
    [ "$(cell query 4)/$(cell name 4)" = side/Sphere ]
    [ "${#lines[@]}" -eq 6 ]
    run -1 --separate-stderr "$CONUS" query sphere.nii.gz --pose poses.tsv --format ndjson
    [[ "${lines[2]}" == '{"query":"bad","kind":"error","index":null,"name":"line 3: column z'* ]]
    diff <(printf '%s\n' "${lines[@]}") <(conus batch sphere.nii.gz --poses poses.tsv --format ndjson)
    run -1 --separate-stderr "$CONUS" query sphere.nii.gz --pose poses.tsv --format json
    [ "$(jq -r '.Rows[2] | .query, .kind, .pixels' <<<"$output" | paste -sd/)" = bad/error/null ]
    [ "$(jq -r '.Queries[1].error' <<<"$output")" = 'line 3: column z: "x" is not a finite number' ]
    run -1 --separate-stderr "$CONUS" query sphere.nii.gz --pose poses.tsv
    has 'query bad: no answer: line 3: column z: "x" is not a finite number'
    printf 'query_id\tx\ty\tz\ttx\tty\ttz\nbad\t0\t0\tx\t0\t0\t0\n' >poses.tsv
    run -1 --separate-stderr "$CONUS" query sphere.nii.gz --pose poses.tsv --image seen.png --mask mask.nii.gz -o all.tsv --voxels v.tsv --voxels-of all
    [ "$(wc -l <all.tsv)/$(wc -l <v.tsv)" = 2/1 ]
    [ ! -e seen.png ] && [ ! -e mask.nii.gz ]
}

@test "a pose's angle wins, and --angle serves those without one" {
    sphere --size 32
    printf 'x,y,z,dx,dy,dz,angle\n0,0,100,0,0,-1,5\n0,0,100,0,0,-1,200\n' >poses.csv
    fails 2 '--angle has no effect: every pose in poses.csv has its own' query sphere.nii.gz --pose poses.csv --angle 4
    printf 'x,y,z,dx,dy,dz\n0,0,100,0,0,-1\n' >poses.csv
    answers query sphere.nii.gz --pose poses.csv --angle 60 --format tsv
    [ "$(cell share 1)" != 1 ]
    answers query sphere.nii.gz --pose poses.csv --format tsv
    [ "$(cell share 1)" = 1 ]
}

@test "a cone that misses everything is an answer" {
    sphere --size 32
    run -0 --separate-stderr "$CONUS" query sphere.nii.gz --origin 0,0,100 --direction 0,0,1 --format tsv --quiet
    check_message 'warning: the cone points away from the atlas; looking the other way it would hit Sphere first'
    [ "$(cell kind 1)/$(cell share 1)/$(cell distance_mm 1)" = unassigned/1/n/a ]
}

@test "an apex inside an area hits it at once" {
    sphere --size 32
    answers query sphere.nii.gz --origin 0,0,0 --direction 0,0,1 --format tsv --quiet
    [ "$(cell name 1)/$(cell share 1)/$(cell distance_mm 1)" = Sphere/1/0 ]
}

# The phantom is a ball of 10 mm around 0; every suggested correction was tried.
@test "poses that lie or look where they hardly should are told of, once, beside the answer" {
    sphere --size 32
    local answer
    says() { # says TEXT ARGUMENT...: an answer, and one line, which is TEXT
        local text=$1
        shift
        run -0 --separate-stderr "$CONUS" "$@"
        drop_question
        [ "$stderr" = "conus: $text" ] || { echo "said: $stderr"; echo "wanted: $text"; return 1; }
    }
    says 'note: the device lies inside Sphere' query sphere.nii.gz --origin 0,0,5 --direction 0,0,1 --format tsv
    answer=$output
    answers query sphere.nii.gz --origin 0,0,5 --direction 0,0,1 --format tsv --quiet
    [ "$output" = "$answer" ]
    answers query sphere.nii.gz --origin 0,0,5 --direction 0,0,1 --radius 2 --format tsv # a needle begins there
    says 'warning: the cone points away from the atlas; looking the other way it would hit Sphere first' \
        query sphere.nii.gz --origin 0,0,100 --direction 0,0,1 --format tsv
    says 'warning: the cone points away from the atlas; with x and y of its position negated (LPS for RAS) it would hit Sphere first' \
        query sphere.nii.gz --origin 100,0,30 --direction 0.957826,0,-0.287348 --format tsv
    says 'warning: the cone points away from the atlas; with its position divided by 1000 (micrometres for mm) it would hit Sphere first' \
        query sphere.nii.gz --origin 100000,0,30000 --direction -100,0,-25 --angle 1 --format tsv
    says 'warning: the cone points away from the atlas' query sphere.nii.gz --origin 0,100,0 --direction 1,0,0 --format tsv
    says 'warning: the device lies within 1 mm of the world'"'"'s origin; with its position times 1000 (metres for mm) it would hit Sphere first' \
        query sphere.nii.gz --origin 0.1,0,0.03 --toward 0,0,0 --format tsv
    says 'warning: the cylinder points away from the atlas; looking the other way it would hit Sphere first' \
        query sphere.nii.gz --origin 0,0,100 --direction 0,0,1 --radius 2 --format tsv
    says 'warning: the cone points away from the atlas; looking the other way it would hit Sphere first' \
        sweep sphere.nii.gz --origin 0,0,100 --direction 0,0,1 --angles 40,10 --format tsv
    printf 'x\ty\tz\tdx\tdy\tdz\n0\t0\t90\t0\t0\t-1\n0\t0\t90\t0\t0\t1\n90\t0\t0\t0\t1\t0\n' >poses.tsv
    local away='warning: poses.tsv: 2 of 3 cones point away from the atlas, the first in line 3; looking the other way (--axis, or the signs of dx dy dz) it would hit Sphere first'
    says "$away" query sphere.nii.gz --pose poses.tsv --format tsv
    answer=$output
    says "$away" batch sphere.nii.gz --poses poses.tsv -o rows.tsv
    [ "$(cat rows.tsv)" = "$answer" ]
    says "$away" batch sphere.nii.gz --poses poses.tsv -o rows.tsv --force --threads 3 --block 1
    says "$away" batch sphere.nii.gz --poses poses.tsv -o rows.tsv --force --quiet
    # The first begins in a corner of the box around the sphere, and looks out of it.
    printf 'x\ty\tz\tdx\tdy\tdz\n18\t18\t18\t0\t0\t1\n0\t0\t90\t0\t0\t1\n' >poses.tsv
    says 'warning: poses.tsv: 2 of 2 cones point away from the atlas, the first in line 2' \
        query sphere.nii.gz --pose poses.tsv --format tsv
    printf 'x\ty\tz\tdx\tdy\tdz\n0\t0\t5\t0\t0\t-1\n' >poses.tsv
    says 'note: poses.tsv: 1 of 1 devices lie inside an area, the first in line 2, inside Sphere' \
        query sphere.nii.gz --pose poses.tsv --format tsv
    printf 'x\ty\tz\tdx\tdy\tdz\ttime_s\n0\t0\t90\t0\t0\t1\t0\n' >hand.tsv
    says 'warning: hand.tsv: 1 of 1 cones point away from the atlas, the first in line 2; looking the other way (--axis, or the signs of dx dy dz) it would hit Sphere first' \
        track sphere.nii.gz --poses hand.tsv --format tsv
    printf '0\t0\t90\t0\t0\t-1\t1\n' >>hand.tsv
    answers track sphere.nii.gz --poses hand.tsv --format tsv # a device in the hand points here and there
}

@test "the default ranking is by share" {
    need_aal
    local aim='--origin=-90,20,20 --toward=0,-10,10 --angle 20 --format tsv'
    answers query "$aal" $aim
    local default=$output
    answers query "$aal" $aim --score share
    [ "$output" = "$default" ]
    answers query "$aal" $aim --score distance
    [ "$(cell rank 1)" = 1 ]
    [ "$output" != "$default" ]
}

@test "the aperture and the resolution decide how many pixels there are" {
    sphere --size 32
    local aim='--origin 0,0,100 --toward 0,0,0 --angle 2 --format tsv'
    answers query sphere.nii.gz $aim --aperture square
    [ "$(cell pixels 1)" = 4096 ]
    answers query sphere.nii.gz $aim --resolution 1
    [ "$(cell pixels 1)" = 1 ]
    answers query sphere.nii.gz $aim --resolution 16 --aperture square
    [ "$(cell pixels 1)" = 256 ]
}

# Eq. 15: beyond 120 degrees. The corners of the buffer are not in the pyramid of 170 degrees.
@test "the answer says where rays are spread evenly in angle" {
    sphere --size 32
    local aim='--origin 0,0,100 --toward 0,0,0'
    answers query sphere.nii.gz $aim --angle 120
    [[ "$output" == "cone of 120 degrees from "* ]]
    answers query sphere.nii.gz $aim --angle 120.1
    [[ "$output" == "cone of 120.1 degrees, rays spread evenly, from "* ]]
    answers query sphere.nii.gz $aim --angle 120 --format json
    [[ "$output" != *'"spread"'* ]]
    answers query sphere.nii.gz $aim --angle 150 --format json
    [ "$(jq -r '.Queries[0].spread' <<<"$output")" = even ]
    answers query sphere.nii.gz $aim --angle 170 --aperture square --resolution 16 --format json
    [ "$(jq '.Queries[0].cone_pixels' <<<"$output")" -lt 230 ]
    answers query sphere.nii.gz $aim --angle 150 -o wide.tsv --image wide.exr
    [ "$(jq -r '.Queries[0].spread' wide.json)" = even ]
    grep -aq 'conus:spread' wide.exr
    answers query sphere.nii.gz $aim --angle 120 --image narrow.exr -o narrow.tsv
    run ! grep -aq 'conus:spread' narrow.exr
    printf 'x\ty\tz\ttx\tty\ttz\tangle\n0\t0\t100\t0\t0\t0\t20\n0\t0\t30\t0\t0\t0\t150\n' >poses.tsv
    answers batch sphere.nii.gz --poses poses.tsv -o rows.tsv
    [ "$(jq -r '.Settings.spread' rows.json)" = 'even beyond 120 degrees' ]
    answers query sphere.nii.gz --pose poses.tsv -o rows2.tsv
    cmp rows.tsv rows2.tsv
}

@test "notes about the atlas go to stderr once, unless --quiet" {
    sphere --size 32
    rm sphere.tsv sphere.json
    run -0 --separate-stderr "$CONUS" query sphere.nii.gz --origin 0,0,100 --toward 0,0,0 --format tsv
    check_message 'note: no label table found'
    [ "$(cell name 1)" = 1 ]
    answers query sphere.nii.gz --origin 0,0,100 --toward 0,0,0 --quiet
    run -0 --separate-stderr "$CONUS" query sphere.nii.gz --origin 0,0,100 --toward 0,0,0 --verbose --quiet
    check_message 'engine: rays'
}

@test "--image writes what the device saw" {
    sphere --size 32
    local aim='--origin 0,0,100 --toward 0,0,0'
    fails 2 '--image: "seen.jpg" does not end in .exr or .png' query sphere.nii.gz $aim --image seen.jpg
    answers query sphere.nii.gz $aim --image seen.exr -o a.tsv
    [ "$(head -c 4 seen.exr | od -An -tx1 | tr -d ' ')" = 762f3101 ]
    answers query sphere.nii.gz $aim --image seen.png --resolution 64
    [ "$(head -c 8 seen.png | od -An -tx1 | tr -d ' ')" = 89504e470d0a1a0a ]
    fails 3 'no/seen.png: cannot write' query sphere.nii.gz $aim --image no/seen.png -o b.txt
    [ ! -e b.txt ]
    printf 'x,y,z,dx,dy,dz\n0,0,100,0,0,-1\n0,0,90,0,0,-1\n' >poses.csv
    fails 2 '--image shows one pose, poses.csv has 2' query sphere.nii.gz --pose poses.csv --image seen.png
    fails 2 '--output and --image are the same file' query sphere.nii.gz $aim --image x.png --format table -o x.png
}

@test "paths and names of any bytes stay whole, as UTF-8 and on one line" {
    sphere --size 32
    local place=$'caf\xe9'
    mkdir "$place"
    mv sphere.* "$place"
    local aim="--origin 0,0,100 --toward 0,0,0 --quiet"
    answers query "$place/sphere.nii.gz" $aim --format json
    has $'"path": "caf\xc3\xa9/sphere.nii.gz"'
    has $'"CommandLine": "conus query \'caf\xc3\xa9/sphere.nii.gz\''
    answers info "$place/sphere.nii.gz" --format json
    has $'"path": "caf\xc3\xa9/sphere.nii.gz"'
    cp "$place/sphere.nii.gz" tract.nii.gz
    answers query "$place/sphere.nii.gz" $aim --pathway $'tract.nii.gz,threshold=1,name=a\tb\nc\xe9' \
        --voxels v.tsv --format tsv
    [ "$(awk -F'\t' '{ print NF }' v.tsv | sort -u)" = 12 ]
    answers info "$place/sphere.nii.gz" --pathway $'tract.nii.gz,threshold=1,name=a\tb\nc\xe9' --format tsv
    has $'pathway\t1\ta b c\xc3\xa9\t'
}

@test "labels beyond 2^31 keep all their digits" {
    conus phantom nested -o . --size 32
    answers query nested.nii.gz --origin 0,0,0 --direction 0,0,1 -o a.tsv --voxels v.tsv --voxels-of all --quiet
    [ "$(awk -F'\t' 'NR == 2 { print $9 "/" $12 }' v.tsv)" = 4000000001/4000000001 ]
    answers info nested.nii.gz
    has 'values       0 to 4000000001'
    answers info nested.nii.gz --format json
    has '"maximum": 4000000001'
}

@test "an answer beside the atlas, under its name, is not taken for its label table" {
    sphere --size 32
    rm sphere.tsv sphere.json
    local aim='--origin 0,0,100 --toward 0,0,0'
    answers query sphere.nii.gz $aim --quiet -o sphere.tsv --voxels sphere.txt --voxels-of all
    run -0 --separate-stderr "$CONUS" query sphere.nii.gz $aim --format tsv
    [ "$output" = "$(cat sphere.tsv)" ]
    [[ "${stderr_lines[0]}" == *'sphere.txt is not a label table of a known format: passed over' ]]
    [[ "${stderr_lines[1]}" == *'sphere.tsv is not a label table of a known format: passed over' ]]
}

# refuses TEXT COMMAND ARGUMENT...: asserts that it is refused, and that no file here is changed or made.
refuses() {
    local text=$1 before
    shift
    before=$(find . -type f -exec sha256sum {} + | sort)
    fails 2 "$text" "$@"
    [ "$(find . -type f -exec sha256sum {} + | sort)" = "$before" ]
}

# The same rule for every command and every option that names a file.
@test "no file is replaced without --force, and no sidecar replaces what is none" {
    conus phantom nested -o . --size 24 --spacing 3,3,3
    python3 "$BATS_TEST_DIRNAME/tck.py" lines.tck -30,0,0 30,0,0 -- 0,-20,0 0,0,9
    printf 'time_s\tx\ty\tz\ttx\tty\ttz\n0\t0\t0\t90\t0\t0\t0\n' >hand.tsv
    local aim='--origin 0,-100,0 --toward 0,0,0 --angle 30 -q' N=nested.nii.gz option file
    local outputs=(output=o.tsv voxels=v.tsv\ --voxels-of=all image=i.png mask=m.nii.gz segments=s.tsv endpoints=e.tsv
        connectivity=c.tsv streamlines-out=l.tck)
    for option in "${outputs[@]}"; do
        file=${option#*=}
        file=${file% *}
        echo mine >"$file"
        refuses "$file: there is a file already (--${option%%=*}); --force replaces it" \
            query $N $aim --layers all --streamlines lines.tck --$option
        grep -qx mine "$file"
        conus query $N $aim --layers all --streamlines lines.tck --$option --force >seen
        ! grep -qx mine "$file" || return 1
        rm "$file"
    done
    for file in o.json m.json s.json e.json; do # beside them
        rm -f [omse].*
        echo '{"GeneratedBy": [{"Name": "fMRIPrep"}]}' >$file
        for force in '' --force; do
            refuses "$file: there is a file" query $N $aim --streamlines lines.tck --layers all -o o.tsv --mask m.nii.gz \
                --segments s.tsv --endpoints e.tsv $force
        done
    done
    rm [omse].*
    local asks=("query $N $aim" "sweep $N $aim" "track $N --poses hand.tsv -q" "overlap $N $N --threshold 300 -q"
        "connect $N --streamlines lines.tck -q")
    for ask in "${asks[@]}"; do
        conus $ask -o a.tsv
        refuses 'a.tsv: there is a file already (--output)' $ask -o a.tsv
        answers $ask -o a.tsv --force
        rm a.tsv
        refuses 'a.json: there is a file already (the .json beside --output)' $ask -o a.csv
        answers $ask -o a.csv --force # it is a sidecar
        refuses 'a.json: there is a file already (--output)' $ask -o a.json
        answers $ask -o a.json --force # which is an answer now
        refuses 'a.json: there is a file that is no sidecar, which a sidecar does not replace' $ask -o a.tsv --force
        answers $ask -o a.tsv --sidecar b.json
        refuses 'b.json: there is a file already (--sidecar)' $ask --sidecar b.json
        refuses '--force has no effect without a file' $ask --force
        rm a.tsv a.csv a.json b.json
    done
    printf 'x\ty\tz\ttx\tty\ttz\n0\t-100\t0\t0\t0\t0\n' >poses.tsv
    echo '{}' >rows.json
    refuses 'rows.json: there is a file that is no sidecar' batch $N --poses poses.tsv -o rows.tsv --force
    conus query $N $aim --format tsv -o /dev/stdout >redirected
    conus query $N $aim --format tsv -o /dev/stdout >>redirected # what is open is written to
    [ "$(wc -l <redirected)" -eq "$((2 * $(conus query $N $aim --format tsv | wc -l)))" ]
    answers query $N $aim --format tsv -o /dev/null
}

@test "a folder that is not there is named by the file that was asked for" {
    conus phantom nested -o . --size 24 --spacing 3,3,3
    fails 3 'none/x.tsv: cannot write: No such file or directory' query nested.nii.gz --origin 0,-100,0 --toward 0,0,0 -o none/x.tsv
    fails 3 'none/m.nii: cannot write: No such file' query nested.nii.gz --origin 0,-100,0 --toward 0,0,0 --mask none/m.nii
    fails 3 'none/x.tsv: cannot write: No such file' overlap nested.nii.gz nested.nii.gz --threshold 300 -o none/x.tsv
}

# Otherwise the output could not be verified: the sidecar cannot hold such a name.
@test "names that no sidecar can hold are refused where they would be recorded" {
    conus phantom nested -o . --size 24 --spacing 3,3,3
    local odd aim='--origin 0,-100,0 --toward 0,0,0 -q' ball
    mkdir lists
    for odd in $'a\nb' $'a\tb' $'a\xe9b' $'a\e[1mb' $'a\u202eb'; do
        cp nested.nii.gz "$odd.nii.gz"
        refuses 'which no sidecar can name; rename the file' query "$odd.nii.gz" $aim -o rows.tsv
        refuses 'which no sidecar can name' query nested.nii.gz $aim -o "$odd.tsv"
        refuses 'which no sidecar can name' query nested.nii.gz $aim -o rows.json --atlas "$odd.nii.gz"
        refuses 'which no sidecar can name' sweep nested.nii.gz $aim --sidecar "$odd.json"
        refuses 'which no sidecar can name' overlap nested.nii.gz "$odd.nii.gz" --threshold 1 -o rows.tsv
        printf 'x\ty\tz\ttx\tty\ttz\n0\t-100\t0\t0\t0\t0\n' >"$odd.poses.tsv"
        refuses 'which no sidecar can name' batch nested.nii.gz --poses "$odd.poses.tsv" -o rows.tsv
        conus query "$odd.nii.gz" $aim >seen # nothing is recorded
        conus batch nested.nii.gz --poses "$odd.poses.tsv" >seen
        rm "$odd".*
    done
    ball=$(printf 'n\u00e9 \u00fcb\u00e8r'"'"'s "b" $HOME \\')
    mkdir "$ball"
    cp nested.nii.gz "$ball/$ball.nii.gz"
    answers query "$ball/$ball.nii.gz" $aim -o "$ball/rows.tsv"
    answers verify "$ball/rows.tsv"
}
