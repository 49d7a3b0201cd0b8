#!/usr/bin/env bats
# Man pages and completions, which scripts/pages makes of a program's rows, agree with its --help.
load helpers

# write_pages [PROGRAM]: its pages, in the folder pages.
write_pages() {
    CONUS=${1:-$CONUS} write_pages_to pages
}

write_pages_to() {
    "$BATS_TEST_DIRNAME/../../scripts/pages" "$1"
}

# view_program: sets $VIEW to conus-view, or skips the test.
view_program() {
    VIEW=${CONUS%/*}/conus-view
    [ -x "$VIEW" ] || skip "conus-view is not built"
}

# commands: prints the commands that conus lists.
commands() {
    conus help | sed -n 's/^  \([a-z]*\)  .*/\1/p' | grep -vx -e help -e view
}

# help_options COMMAND...: prints the long options in its --help, in order.
help_options() {
    "$@" --help | sed -n 's/^  \(-., \|    \)--\([a-z0-9-]*\).*/\2/p'
}

# man_options PAGE: prints the long options that it explains, in order.
man_options() {
    sed -n 's/^\(\\fB\\-.\\fR, \)\?\\fB\\-\\-\([a-z0-9\\-]*\)\\fR.*/\2/p' "$1" | tr -d '\\'
}

# complete_bash FILE WORD...: prints what bash offers for the last word.
complete_bash() {
    env -i HOME="$HOME" PATH="$PATH" bash --norc --noprofile -c '
        source "$1"
        shift
        COMP_WORDS=("$@")
        COMP_CWORD=$(($# - 1))
        function_name=_${1//-/_}
        $function_name
        printf "%s\n" "${COMPREPLY[@]}"' bash "$@"
}

# complete_fish FILE LINE: prints the words that fish offers at the end of the line.
complete_fish() {
    HOME=$PWD XDG_CONFIG_HOME=$PWD XDG_DATA_HOME=$PWD fish --no-config -c "source $1; complete -C '$2'" | cut -f 1
}

@test "every command has a man page with the options of its help" {
    write_pages
    for command in $(commands); do
        help_options conus "$command" >wanted
        [ "$(wc -l <wanted)" -ge 3 ]
        man_options "pages/conus-$command.1" | diff wanted -
        grep -qx ".BR conus\\\\-$command (1)" pages/conus.1
    done
    grep -qx '.BR conus\\-view (1)' pages/conus.1
    [ "$(find pages -name '*.1' | wc -l)" -eq $(($(commands | wc -l) + 1)) ]
}

@test "conus-view has one man page" {
    view_program
    write_pages "$VIEW"
    help_options "$VIEW" >wanted
    man_options pages/conus-view.1 | diff wanted -
}

@test "man pages are good roff, and show the text as it is" {
    command -v mandoc || skip "there is no mandoc"
    write_pages
    [ ! -x "${CONUS%/*}/conus-view" ] || write_pages "${CONUS%/*}/conus-view"
    # An empty date is on purpose: a page is the same whenever it is built.
    mandoc -T lint -W warning pages/*.1 | grep -v 'missing date' | tee lint
    [ ! -s lint ]
    mandoc -T utf8 -O width=100 pages/conus-query.1 | col -bx >text
    grep -q -- '--origin PLACE' text
    grep -qF -- 'conus query ATLAS (--origin PLACE' text
    grep -qF -- '--pathway FILE[,KEY=VALUE]...' text
    # A choice is explained as in the help.
    for text in <(conus query --help) text; do
        tr -s ' \n' '  ' <"$text" | grep -qF 'volumes and values: visible (default), all'
    done
    # The lines of the notes and examples stay lines, as in the help.
    conus query --help | sed -n '/^Examples/,/^$/p' | sed '1d; $d; s/^ *//' >wanted
    [ -s wanted ]
    while read -r line; do
        grep -qF -- "$line" text || { echo "not in the page: $line"; return 1; }
    done <wanted
}

@test "bash completes commands, options, choices and files" {
    write_pages
    [ "$(complete_bash pages/conus.bash conus qu)" = query ]
    complete_bash pages/conus.bash conus '' >offered
    { commands; printf '%s\n' view help --help --version; } | sort >wanted
    sort offered | diff wanted -
    for command in $(commands); do
        complete_bash pages/conus.bash conus "$command" -- >offered
        help_options conus "$command" | sed 's/^/--/' | diff - offered
    done
    [ "$(complete_bash pages/conus.bash conus query --layers '' | xargs)" = "visible all" ]
    [ "$(complete_bash pages/conus.bash conus query --layers = a)" = all ]
    [ "$(complete_bash pages/conus.bash conus help swe)" = sweep ]
    touch 'my atlas.nii.gz'
    mkdir 'my folder'
    [ "$(complete_bash pages/conus.bash conus query my | sort)" = "$(printf 'my atlas.nii.gz\nmy folder')" ]
    [ "$(complete_bash pages/conus.bash conus query --labels my | wc -l)" -eq 2 ]
    [ "$(complete_bash pages/conus.bash conus mesh a -o my)" = "my folder" ]
    [ -z "$(complete_bash pages/conus.bash conus query --angle my)" ]
}

# installed: some atlases, one of which has a name that a shell would run.
installed() {
    mkdir -p own
    conus phantom sphere -o own --size 16
    cp own/sphere.nii.gz own/ball_atlas.nii.gz
    cp own/sphere.nii.gz 'own/ball $(touch ran) atlas.nii.gz'
    export CONUS_ATLAS_PATH=$PWD/own XDG_DATA_DIRS=$PWD HOME=$PWD PATH=${CONUS%/*}:$PATH
}

@test "shells offer the names of installed atlases" {
    installed
    write_pages
    # complete_bash runs with env -i, without $CONUS_ATLAS_PATH: so a program of conus's name sets it.
    mkdir bin
    printf '#!/bin/sh\nCONUS_ATLAS_PATH="%s" XDG_DATA_DIRS="%s" exec "%s" "$@"\n' "$PWD/own" "$PWD" "$CONUS" >bin/conus
    chmod +x bin/conus
    PATH=$PWD/bin:$PATH
    [ "$(complete_bash pages/conus.bash conus query ball | sort)" = "$(printf 'ball $(touch ran) atlas\nball_atlas')" ]
    [ "$(complete_bash pages/conus.bash conus info sph)" = sphere ]
    [ "$(complete_bash pages/conus.bash conus query a --atlas sph)" = sphere ]
    [ "$(complete_bash pages/conus.bash conus query a --atlas = sph)" = sphere ]
    [ -z "$(complete_bash pages/conus.bash conus diff ball)" ]
    [ -z "$(complete_bash pages/conus.bash conus query a --angle ball)" ]
    # bash passes "own:ball" as three words and completes the last one.
    cp -r own other
    sed -i "s|$PWD/own|$PWD/own:$PWD/other|" bin/conus
    [ "$(complete_bash pages/conus.bash conus query own : sph | sort -u)" = sphere ]
    if command -v fish; then
        complete_fish pages/conus.fish 'conus query own:sph' | sort -u | grep -qx own:sphere
        complete_fish pages/conus.fish 'conus query a --atlas own:sph' | sort -u | grep -qx own:sphere
    fi
    if command -v zsh; then
        zsh -n pages/_conus
        grep -qF 'conus atlases --quiet --format names' pages/_conus
    fi
    [ ! -e ran ]
}

@test "bash completes conus view as it does conus-view" {
    view_program
    write_pages
    write_pages "$VIEW"
    complete_bash pages/conus-view.bash conus-view -- >wanted
    help_options "$VIEW" | sed 's/^/--/' | diff - wanted
    cat pages/conus.bash pages/conus-view.bash >both.bash
    complete_bash both.bash conus view -- | diff wanted -
}

@test "fish completes commands, options and choices" {
    command -v fish || skip "there is no fish"
    write_pages
    { commands; printf '%s\n' view help; } | sort >wanted
    complete_fish pages/conus.fish 'conus ' | sort | diff wanted -
    for command in $(commands); do
        complete_fish pages/conus.fish "conus $command --" | sort >offered
        help_options conus "$command" | sed 's/^/--/' | sort | diff - offered
    done
    [ "$(complete_fish pages/conus.fish 'conus query --layers ' | xargs)" = "all visible" ]
}

@test "zsh is given commands, options and choices" {
    command -v zsh || skip "there is no zsh"
    write_pages
    # zsh completes only in its line editor: here its two functions print their arguments.
    complete_zsh() {
        zsh -fc '
            _arguments() { [[ $1 == -C ]] && { state=rest line=($chosen); return } ; shift; printf "%s\n" "$@" }
            _describe() { print -rl -- $names }
            chosen=$2
            source $1' zsh "$@"
    }
    for command in $(commands); do
        complete_zsh pages/_conus "$command" >given
        # "(-o --output)--output=[text]:FILE:_files" or "*--pathway=[..."
        sed -n 's/^\(([^)]*)\|\*\)\?--\([a-z0-9-]*\)=\?\[.*/\2/p' given >offered
        help_options conus "$command" | diff - offered
    done
    grep -qx 'query:.*' <(complete_zsh pages/_conus help)
    complete_zsh pages/_conus query | grep -q '^--layers=.*:WHICH:(visible all)$'
    [ "$(head -n 1 pages/_conus)" = "#compdef conus" ]
}

@test "pages that cannot be written are an error" {
    touch file
    run ! write_pages_to file
    [[ $output == *FileExistsError* ]]
    run ! write_pages_to missing/folder
    [[ $output == *FileNotFoundError* ]]
    fails 2 "unknown command" --write-pages file
}
