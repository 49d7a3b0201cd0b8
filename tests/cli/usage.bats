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
        answers help $command --long
        [ "$output" = "$explained" ]
        answers $command -h
        explained=$output
        answers help $command
        [ "$output" = "$explained" ]
        answers --help
    done
    run -2 "$CONUS" help query --long more
    [ "$output" = 'conus: unexpected argument "more"' ]
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
    for word in lesion mask roi; do # an operand is not an option
        fails 2 "unknown option --$word; ROI stands behind ATLAS, without an option: conus overlap ATLAS ROI" overlap a.nii --$word b.nii
    done
    fails 2 'unknown option --lesion of conus query; conus overlap takes it as its ROI' query a.nii --lesion b.nii
    fails 2 'unknown command "lesion"; did you mean overlap?' lesion a.nii b.nii
}

@test "an option of another command, a file of poses without its option, and files that are no poses" {
    sphere --size 16 --spacing 4,4,4
    conus phantom bundle -o . --size 16 2>/dev/null || conus phantom bundle -o .
    printf 'x\ty\tz\ttx\tty\ttz\n0\t0\t90\t0\t0\t0\n' >poses.tsv
    fails 2 'unknown option --poses; did you mean --pose?' query sphere.nii.gz --poses poses.tsv
    fails 2 'unknown option --pose; did you mean --poses?' batch sphere.nii.gz --pose poses.tsv
    fails 2 'unknown option --threads of conus query; conus batch has it' query sphere.nii.gz --threads 2
    fails 2 '--point and --slice-fraction exclude each other' query sphere.nii.gz --point 1,2,3 --slice_fraction 0.5
    fails 2 'unknown option --_point; did you mean --point?' query sphere.nii.gz --_point 1,2,3
    fails 2 'unknown option --jitter of conus query; conus sweep has it' query sphere.nii.gz --jitter 1,1
    fails 2 'unexpected argument "poses.tsv"; a file of poses is given as --poses poses.tsv' batch sphere.nii.gz poses.tsv
    fails 2 'unexpected argument "poses.tsv"; a file of poses is given as --pose poses.tsv' query sphere.nii.gz poses.tsv
    fails 2 'unexpected argument "Ball"; a place is given as --point Ball, a file of poses as --pose FILE' query sphere.nii.gz Ball
    fails 2 'unexpected argument "-26"; a point is given as --point X,Y,Z' query sphere.nii.gz -26 -20 -14
    fails 2 'unexpected argument "5"; a vector is one word: X,Y,Z without spaces' query sphere.nii.gz --point 1,2,3 5
    fails 2 '"Ball"; a place of several words is put in quotes' query sphere.nii.gz --point left Ball
    fails 2 '"map.nii.gz"; --pathway map.nii.gz adds what is bright in an image, and conus overlap asks which areas' \
        query sphere.nii.gz map.nii.gz
    fails 2 '; --pathway map.nii.gz --shell --style print draws what is bright' render sphere.nii.gz map.nii.gz -o a.png
    fails 2 '"bundle.tck"; a tractogram is given as --streamlines bundle.tck' query sphere.nii.gz bundle.tck
    fails 2 'unexpected argument "sphere"; conus info sphere describes it' atlases sphere
    fails 2 '"mni" is none of its choices: ras, lps, ccf, bregma; whose brain it is the atlas says' \
        query sphere.nii.gz --point 1,2,3 --space mni
    fails 2 '--origin needs --toward PLACE or --direction X,Y,Z, or --inward, with it' query sphere.nii.gz --origin 1,2,3
    fails 2 'or no point: --point PLACE' query sphere.nii.gz
    fails 2 'unexpected argument "more.tsv"' batch sphere.nii.gz --poses poses.tsv more.tsv
    [[ $stderr != *'given as'* ]]
    for command in 'query --pose' 'batch --poses' 'track --poses' 'sweep --pose'; do
        read -r name option <<<"$command"
        fails 3 "sphere.nii.gz: is an atlas by its name, not a file of poses; the atlas comes first: conus $name sphere.nii.gz $option poses.tsv; a table of points is called .csv or .tsv" \
            "$name" poses.tsv $option sphere.nii.gz
        fails 3 "bundle.tck: is a tractogram, not a file of poses; --streamlines bundle.tck adds it to the atlas" \
            "$name" sphere.nii.gz $option bundle.tck
    done
    mkdir own
    cp sphere.nii.gz own/ball_atlas.nii.gz
    CONUS_ATLAS_PATH=$PWD/own fails 3 'ball_atlas: is an atlas by its name, not a file of poses; the atlas comes first: conus query ball_atlas --pose poses.tsv; a table of points is called .csv or .tsv' \
        query poses.tsv --pose ball_atlas
    fails 3 'none.tsv: cannot' query sphere.nii.gz --pose none.tsv
}

@test "choices may be written in any case" {
    sphere --size 16 --spacing 4,4,4
    aim=(--origin 0,0,90 --direction 0,0,-1)
    conus query sphere.nii.gz "${aim[@]}" --space lps --aperture square --format tsv >wanted
    conus query sphere.nii.gz "${aim[@]}" --space LPS --aperture Square --format TSV | cmp - wanted
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

@test "hostile words are only words" {
    fails 2 'unknown command "--"' --
    fails 2 'unknown command ""' ''
    fails 2 "unknown command \"$(printf '%0300d' 0)\"" "$(printf '%0300d' 0)"
    fails 2 'unknown option --%s%n%s' query --%s%n%s
    fails 2 "unknown option --$(printf 'a%.0s' {1..200})" query "--$(printf 'a%.0s' {1..200})"
    fails 2 'unknown option ---angle' query ---angle 3
    fails 2 'unknown option --=' query --=5
    fails 2 'a b' query a.nii --angle $'a\nb'
    fails 2 'unexpected argument "-90,20,20"; a point is given as --point X,Y,Z' query a.nii -90,20,20
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
