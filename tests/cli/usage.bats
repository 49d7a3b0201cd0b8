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

@test "the start loads nothing that only pictures and the triangles of surfaces need" {
    run -0 --separate-stderr env LD_DEBUG=files "$CONUS" --version
    [[ $stderr == *libjansson* ]] # it names the loaded libraries
    for library in libcairo libembree libepoxy libfontconfig libfreetype libOpenEXR libpng; do
        [[ $stderr != *"$library"* ]]
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

@test "-h of every command is at most 20 lines of 100 columns, with the commonest options and two examples" {
    for command in $(conus --help | sed -n 's/^  \([a-z]*\)  *[a-z].*/\1/p' | grep -vx -e view -e help); do
        answers $command --help
        local all=$output
        answers $command -h
        [ "${#lines[@]}" -le 20 ] && [ "$(wc -l <<<"$output")" -le 20 ]
        [ "$(grep -v '^usage: ' <<<"$output" | wc -L)" -le 100 ]
        has "usage: conus $command "
        has "conus $command --help has all options."
        [ "$(sed -n '/^Examples/,/^$/p' <<<"$output" | grep -c conus)" -ge 1 ]
        # Each option is in the whole help, which begins with the text of the short one.
        options=$(grep -oE '^ {2,6}(-[a-z], )?--[a-z-]+' <<<"$output")
        [ "$(wc -l <<<"$options")" -le 7 ]
        while IFS= read -r option; do
            grep -qF -- "$option" <<<"$all"
        done <<<"$options"
    done
    answers query -h
    has '  -o, --output FILE           write the answer to FILE'
    has '      --angle DEGREES         full opening angle of the cone'
    answers -h
    has 'usage: conus COMMAND'
}

@test "words that people search find their option, in the help and as a hint" {
    while read -r command word option; do
        conus "$command" --help | tr -s ' \n' '  ' | grep -qiE -- "--$option [^()]*(\([^()]*\)[^()]*)*\(also: [^)]*\b$word\b" ||
            { echo "$command: $word is not at --$option"; return 1; }
        [ "$command" != query ] || conus query --help | grep -qi -- "$word"
        run -2 --separate-stderr conus "$command" "--$word"
        [[ $stderr == "conus: unknown option --$word; did you mean "*"--$option?" ]] || { echo "said: $stderr"; return 1; }
    done <<'END'
query save output
query export output
query excel output
query warp atlas-transform
query registration atlas-transform
query ROI only
query region only
query sort score
query fibre streamlines
query figure image
batch parallel threads
batch save output
sweep uncertain jitter
render colour background
render color background
END
    for word in colour color uncertain parallel; do # those options of query belong to other commands
        conus query --help | grep -qi -- "$word"
    done
    fails 2 'unknown option --save; did you mean -o, --output?' query a.nii --save
}

@test "an option of another command, a file of poses without its option, and files that are no poses" {
    sphere --size 16 --spacing 4,4,4
    conus phantom bundle -o . --size 16 2>/dev/null || conus phantom bundle -o .
    printf 'x\ty\tz\ttx\tty\ttz\n0\t0\t90\t0\t0\t0\n' >poses.tsv
    fails 2 'unknown option --poses; did you mean --pose?' query sphere.nii.gz --poses poses.tsv
    fails 2 'unknown option --pose; did you mean --poses?' batch sphere.nii.gz --pose poses.tsv
    fails 2 'unknown option --threads of conus query; conus batch has it' query sphere.nii.gz --threads 2
    fails 2 'unknown option --jitter of conus query; conus sweep has it' query sphere.nii.gz --jitter 1,1
    fails 2 'unexpected argument "poses.tsv"; a file of poses is given as --poses poses.tsv' batch sphere.nii.gz poses.tsv
    fails 2 'unexpected argument "poses.tsv"; a file of poses is given as --pose poses.tsv' query sphere.nii.gz poses.tsv
    fails 2 'unexpected argument "more.tsv"' batch sphere.nii.gz --poses poses.tsv more.tsv
    [[ $stderr != *'given as'* ]]
    for command in 'query --pose' 'batch --poses' 'track --poses' 'sweep --pose'; do
        read -r name option <<<"$command"
        fails 3 "sphere.nii.gz: is an atlas, not a file of poses; the atlas comes first: conus $name sphere.nii.gz $option poses.tsv" \
            "$name" poses.tsv $option sphere.nii.gz
        fails 3 "bundle.tck: is a tractogram, not a file of poses; --streamlines bundle.tck adds it to the atlas" \
            "$name" sphere.nii.gz $option bundle.tck
    done
    mkdir own
    cp sphere.nii.gz own/ball_atlas.nii.gz
    CONUS_ATLAS_PATH=$PWD/own fails 3 'ball_atlas: is an atlas, not a file of poses; the atlas comes first: conus query ball_atlas --pose poses.tsv' \
        query poses.tsv --pose ball_atlas
    fails 3 'none.tsv: cannot' query sphere.nii.gz --pose none.tsv
}

@test "choices may be written in any case" {
    sphere --size 16 --spacing 4,4,4
    aim=(--origin 0,0,90 --direction 0,0,-1)
    conus query sphere.nii.gz "${aim[@]}" --space lps --aperture square --format tsv >wanted
    conus query sphere.nii.gz "${aim[@]}" --space LPS --aperture Square --format TSV | cmp - wanted
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
    fails 2 'unknown option --zebra; conus query --help lists them' query a.nii --zebra all
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
    fails 2 '--slice-fraction has no effect without --sampling slices' render a.nii -o p.png --slice-fraction 1
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

@test "a full disk and a closed pipe are errors, the latter without a message" {
    [ -c /dev/full ] || skip "no /dev/full"
    run -3 --separate-stderr bash -c "'$CONUS' query --help >/dev/full"
    check_message 'standard output: cannot write: No space left on device'
    run -3 --separate-stderr bash -c "'$CONUS' --help >&-"
    check_message 'standard output: cannot write: Bad file descriptor'
    run -3 --separate-stderr bash -c "exec 3> >(:); wait \$!; '$CONUS' --help >&3"
    [ -z "$stderr" ]
}
