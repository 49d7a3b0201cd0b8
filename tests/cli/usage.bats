#!/usr/bin/env bats
# Help, and command lines as people mistype them.
load helpers

@test "--version names the program and its version" {
    answers --version
    [ "$output" = "conus 0.1.0" ]
    for command in query track info render phantom diff; do
        answers $command --version
        [ "$output" = "conus 0.1.0" ]
    done
}

@test "--help lists the commands, and each explains itself" {
    answers --help
    for command in query track info render phantom diff; do
        has "  $command "
        answers $command --help
        has "usage: conus $command "
        local explained=$output
        answers help $command
        [ "$output" = "$explained" ]
        answers --help
    done
}

@test "no command at all shows the list on stderr" {
    run -2 --separate-stderr conus
    [ -z "$output" ]
    [[ "$stderr" == "usage: conus COMMAND"* ]]
}

@test "--help wins over what is wrong behind it" {
    answers query --help --nonsense
    has "usage: conus query ATLAS"
}

@test "every option in the help is accepted by the parser" {
    for command in query track info render phantom diff; do
        answers $command --help
        grep -oE '^ +(-[a-z], )?--[a-z-]+' <<<"$output" | grep -oE -- '--[a-z-]+' >options
        [ "$(wc -l <options)" -ge 3 ]
        while read -r option; do
            run --separate-stderr conus $command "$option" </dev/null
            [[ "$stderr" != *"unknown option"* ]] || { echo "$command $option: $stderr"; return 1; }
        done <options
    done
}

@test "unknown commands and options get the closest suggested" {
    fails 2 'unknown command "qeury"; did you mean query?' qeury
    fails 2 'unknown command "select"; conus help lists them' select
    fails 2 'unknown command "select"; conus help lists them' help select
    fails 2 'unknown option --angel; did you mean --angle?' query a.nii --angel 20
    fails 2 'unknown option --orig=1,2,3; did you mean --origin?' query a.nii --orig=1,2,3
    fails 2 'unknown option --prune; conus query --help lists them' query a.nii --prune all
    fails 2 'unknown option -x; conus query --help lists them' query a.nii -x
}

@test "operands are counted" {
    fails 2 'ATLAS is missing; conus query --help shows how' query --origin 1,2,3
    fails 2 'unexpected argument "b.nii"' info a.nii b.nii
    fails 2 'B is missing' diff a.tsv
    fails 2 'ATLAS is empty' info ''
    fails 2 'unexpected argument "20,"; a vector is one word' query a.nii --up 1,2,3 20, 20
}

@test "an option is given once, with a value" {
    fails 2 '--angle is given twice' query a.nii --angle 20 --angle=30
    fails 2 '--help takes no value, found "yes"' query --help=yes
    fails 2 '--angle needs a value: --angle DEGREES' query a.nii --angle
    fails 2 '--labels needs a value before --format: --labels FILE' query a.nii --labels --format tsv
    fails 2 '--labels: "" is not FILE' query a.nii --labels=
}

@test "numbers are strict" {
    local start='query a.nii --origin 0,0,90 --toward 0,0,0'
    fails 2 '--angle: "20deg" is not a number' $start --angle 20deg
    fails 2 '--angle: "nan" is not a number' $start --angle nan
    fails 2 '--angle: "0x14" is not a number' $start --angle 0x14
    fails 2 '--angle: "1,5" is not a number' $start --angle 1,5
    fails 2 '--angle: 0 is out of range, allowed is more than 0 and less than 180' $start --angle 0
    fails 2 '--angle: -5 is out of range' $start --angle -5
    fails 2 '--angle: 180 is out of range' $start --angle=180
    fails 2 '--origin: "1,2" is not three numbers X,Y,Z' query a.nii --origin 1,2
    fails 2 '--origin: "0,inf,0" is not three numbers X,Y,Z' query a.nii --origin=0,inf,0
    fails 2 '--origin: "1e999,0,0" is not three numbers X,Y,Z' query a.nii --origin=1e999,0,0
    fails 2 '--resolution: 0 is out of range, allowed is 1 to 1024' $start --resolution 0
    fails 2 '--resolution: 99999999999 is out of range' $start --resolution 99999999999
    fails 2 '--resolution: "16.5" is not a whole number' $start --resolution 16.5
    fails 2 '--max-memory: "2GB" is not a number of bytes above 0, like 512M or 2G' $start --max-memory 2GB
}

@test "a choice is one of those listed" {
    fails 2 '--aperture: "circel" is none of its choices; did you mean circle?' query a.nii --aperture circel
    fails 2 '--format: "xml" is none of its choices: table, tsv, csv, json, ndjson' query a.nii --format xml
    fails 2 '--space: "mni" is none of its choices: ras, lps' query a.nii --space mni
    fails 2 '--score: "volume" is unknown, allowed are share, centre, distance' query a.nii --score volume
}

@test "options without effect are refused" {
    local start='query a.nii --origin 0,0,90 --toward 0,0,0'
    fails 2 '--slices has no effect without --sampling slices' $start --slices 100
    fails 2 '--slices has no effect without --sampling slices' $start --slices 100 --sampling exact
    fails 2 '--slice-fraction has no effect without --sampling slices' $start --slice-fraction 0.5
    fails 2 '--slice-fraction has no effect without --sampling slices' $start --slice-fraction 0.2 --sampling exact
    fails 2 '--slice-fraction has no effect without --sampling slices' batch a.nii --poses p.tsv --slice-fraction 1
    fails 2 '--slice-fraction has no effect without --sampling slices' sweep a.nii --origin 0,0,90 --toward 0,0,0 \
        --angles 5,10 --slice-fraction 1
    fails 2 '--slice-fraction has no effect without --sampling slices' track a.nii --poses p.tsv --slice-fraction 1
    fails 2 '--slice-fraction has no effect without --sampling slices' render a.nii -o p.png --origin 0,0,90 \
        --toward 0,0,0 --slice-fraction 1
    fails 2 '--slice-fraction has no effect without a cone' render a.nii -o p.png --slice-fraction 1
    for fraction in 0 -0.2 1.01 40; do
        fails 2 "--slice-fraction: $fraction is out of range, allowed is more than 0 to 1" $start --sampling slices \
            "--slice-fraction=$fraction"
    done
    fails 2 '--voxels-of has no effect without --voxels' $start --voxels-of all
    fails 2 '--toward and --direction exclude each other' $start --direction 0,0,1
    fails 2 '--origin and --pose exclude each other' $start --pose poses.tsv
    fails 2 '--up has no effect without --origin' query a.nii --up 0,0,1 --pose poses.tsv
    fails 2 '--toward has no effect without --origin' query a.nii --toward 0,0,1
    fails 2 '--origin needs --toward X,Y,Z or --direction X,Y,Z' query a.nii --origin 0,0,1
    fails 2 'no cone given: --origin X,Y,Z' query a.nii
}

@test "hostile words are only words" {
    fails 2 'unknown command "--"' --
    fails 2 'unknown command ""' ''
    fails 2 "unknown command \"$(printf '%0300d' 0)\"" "$(printf '%0300d' 0)"
    fails 2 'unknown option --%s%n%s' query --%s%n%s
    fails 2 "unknown option --$(printf 'a%.0s' {1..200})" query "--$(printf 'a%.0s' {1..200})"
    fails 2 'unknown option ---angle' query ---angle 3
    fails 2 'unknown option --=' query --=5
    fails 2 'a b' query a.nii --angle $'a\nb'
    fails 2 'unknown option -9' query a.nii -90,20,20
    fails 3 '-o' info -- -o
    fails 3 'file;rm -rf .nii: cannot open' info 'file;rm -rf .nii'
    nothing_left
}

@test "a full disk and a closed pipe are errors" {
    [ -c /dev/full ] || skip "no /dev/full"
    run -3 --separate-stderr bash -c "'$CONUS' query --help >/dev/full"
    check_message 'standard output: cannot write: No space left on device'
    run -3 --separate-stderr bash -c "'$CONUS' --help >&-"
    check_message 'standard output: cannot write: Bad file descriptor'
    run -3 --separate-stderr bash -c "exec 3> >(:); wait \$!; '$CONUS' --help >&3"
    check_message 'standard output: cannot write: Broken pipe'
}
