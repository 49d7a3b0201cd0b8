#!/usr/bin/env bats
# The tables of options, which are also JSON: what they say of an option is so.
load helpers

@test "a default that is given is as good as none, of every option of every command" {
    run -0 python3 "$BATS_TEST_DIRNAME/rows.py" "$CONUS"
    [[ $output =~ ^1[0-9][0-9]\ defaults\ given$ ]] || { echo "$output"; return 1; }
}

@test "a default that contradicts what is given is said, and changes no row" {
    conus phantom nested -o . --size 24
    beside() { # WARNED OTHER WORD...: the default warned of, beside --OTHER, with the words
        local warning="conus: warning: --$1 is the default, and has no effect beside --$2" words=(--"${1% *}" "${1#* }")
        shift 2
        run -0 --separate-stderr conus query nested.nii.gz -q --format tsv "$@"
        local rows=$output said=$stderr
        run -0 --separate-stderr conus query nested.nii.gz -q --format tsv "$@" "${words[@]}"
        [ "$output" = "$rows" ]
        [ "$stderr" = "$warning${said:+$'\n'$said}" ] || { echo "said: $stderr"; return 1; }
    }
    beside 'angle 10' radius --origin 0,0,90 --toward 0,0,0 --radius 3
    beside 'angle 10' point --point 0,0,0
    beside 'angle 10' focus --focus 0,0,0 --transducer 0,0,90 --aperture-diameter 20
    beside 'layers visible' focus --focus 0,0,0 --transducer 0,0,90 --aperture-diameter 20

    printf 'x,y,z,dx,dy,dz,angle\n0,0,90,0,0,-1,5\n' >own.csv
    for angle in 10 12; do
        run -2 conus query nested.nii.gz --pose own.csv --angle $angle
        [ "$output" = 'conus: --angle has no effect: every pose in own.csv has its own' ]
        run -2 conus render nested.nii.gz --pose own.csv --angle $angle --engine rays -o a.png
        [ "$output" = 'conus: --angle has no effect: the pose in own.csv has its own' ]
    done

    printf 'time_s,x,y,z,dx,dy,dz\n0,0,0,90,0,0,-1\n' >steps.csv
    conus track nested.nii.gz --poses steps.csv --window 0.1 -q >/dev/null # the default is cut to the window
    run -2 conus track nested.nii.gz --poses steps.csv --window 0.1 --delay 0.15
    [ "$output" = 'conus: delay: 0.15 s, allowed is at most the window, 0.1 s' ]
}

@test "no file has a sidecar where there is to be none, and none is left that describes another answer" {
    conus phantom nested -o . --size 24
    aim=(--origin 0,0,90 --toward 0,0,0)
    conus query nested.nii.gz "${aim[@]}" -o a.tsv -q
    run -2 conus query nested.nii.gz "${aim[@]}" -o a.tsv --force --sidecar none
    [ "$output" = "conus: --sidecar none: a.json is there, and would describe another answer" ]
    cp a.tsv wanted.tsv
    rm a.tsv
    mv a.json m.json
    run -2 conus query nested.nii.gz "${aim[@]}" --mask m.nii.gz --sidecar none
    [ "$output" = "conus: --sidecar none: m.json is there, and would describe another answer" ]
    [ ! -e m.nii.gz ]
    rm m.json
    mkdir none
    conus query nested.nii.gz "${aim[@]}" -q --sidecar none -o none/a.tsv --segments none/s.tsv --clearance none/c.tsv \
        --mask none/m.nii.gz
    [ "$(ls none)" = "$(printf '%s\n' a.tsv c.tsv m.nii.gz s.tsv)" ]
    cmp wanted.tsv none/a.tsv
    conus overlap nested.nii.gz nested.nii.gz --threshold 1 -q --sidecar none -o none/o.tsv --clusters none/l.tsv
    conus sweep nested.nii.gz "${aim[@]}" -q --sidecar none -o none/w.tsv
    conus query nested.nii.gz "${aim[@]}" -q --sidecar none -o none/a.json
    [ "$(find none -name '*.json')" = none/a.json ]
}

@test "JSON has every option of every help, and the help all that JSON says" {
    conus help --json >rows.json
    for command in $(conus help | sed -n 's/^  \([a-z]*\)  .*/\1/p' | grep -vx -e help -e view); do
        conus "$command" --help | sed -n 's/^  \(-., \|    \)--\([a-z0-9-]*\).*/\2/p' >wanted
        python3 -c 'import json, sys
rows = next(c["options"] for c in json.load(open("rows.json"))["commands"] if c["name"] == sys.argv[1])
print(*(row["name"] for row in rows), sep="\n")' "$command" | diff wanted -
    done
}
