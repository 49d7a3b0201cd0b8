#!/usr/bin/env bats
# The examples of the documents are run and their output compared; the lists of docs/commands.md are compared with the help.
load helpers
DOCS=$BATS_TEST_DIRNAME/../../docs/commands.md

# The one thing in the examples that differs between machines.
same_engine() {
    sed -E 's/engine rays, [a-z0-9]+/engine rays, any/'
}

# script TRANSCRIPT: prints a script that echoes each command of the transcript and runs it. A command begins with "$ "
# and goes on behind a backslash at the end of a line.
script() {
    local line shown=() command
    while IFS= read -r line; do
        [ ${#shown[@]} -gt 0 ] || [[ $line == '$ '* ]] || continue
        shown+=("$line")
        [[ $line != *\\ ]] || continue
        printf -v command '%s\n' "${shown[@]}"
        printf "printf '%%s\\n'" && printf ' %q' "${shown[@]}" && echo
        printf '%s' "${command#\$ }"
        shown=()
    done <"$1"
}

# examples PAGE LEAST: runs the page's examples, of which there are LEAST or more, and compares what they print.
examples() {
    awk '/^```console/ { on = 1; next } /^```/ { on = 0 } on' "$1" >transcript
    [ "$(grep -c '^\$ ' transcript)" -ge "$2" ]
    {
        echo 'exec 2>&1'
        printf 'conus() { %q "$@"; }\n' "$CONUS"
        script transcript
    } >examples.sh
    mkdir folder
    (cd folder && bash ../examples.sh) | same_engine >got || true
    same_engine <transcript >wanted
    diff wanted got
}

# need_templates: the brains of mricron-data are where the pages say, and pictures can be drawn; or the test is skipped.
need_templates() {
    need_aal
    [ "$TEMPLATES" = /usr/share/mricron/templates ] || skip "the pages name /usr/share/mricron/templates"
    conus phantom sphere -o gl --size 16
    gl render gl/sphere.nii.gz --size 16x16 -o gl/sphere.png -q
}

@test "the examples print what they are said to print" {
    examples "$DOCS" 8
}

@test "so do those of the tour of scenes" {
    examples "${DOCS%/*}/scenes.md" 2
}

@test "so do those of the tutorial" {
    need_templates
    examples "${DOCS%/*}/tutorial.md" 14
}

@test "so do those of the recipes" {
    need_templates
    examples "${DOCS%/*}/recipes.md" 20
}

# section NAME: the part of the page under that command's heading.
section() {
    awk -v name="$1" '/^## / { on = index($0, "## conus " name " ") == 1 } on' "$DOCS"
}

@test "every option of the help is in the page, and the other way round" {
    for command in query track sweep info render view mesh manifest phantom diff; do
        [ $command != view ] || [ -x "${CONUS%/*}/conus-view" ] || continue
        section $command | grep -oE '`--[a-z-]+' | tr -d '`' >said
        conus $command --help | grep -oE '^ +(-[a-z], )?--[a-z-]+' | grep -oE -- '--[a-z-]+' >there
        for list in said there; do
            grep -vxE -- '--(help|version)' $list | sort -u -o $list
        done
        diff there said
    done
}

@test "the columns of the page are those of the TSV, in their order" {
    sphere --size 16
    conus query sphere.nii.gz --origin 0,0,90 --toward 0,0,0 --layers all --format tsv | head -1 | tr '\t' '\n' >there
    awk '/^### Columns/ { on = 1 } /^## conus diff/ { on = 0 } on' "$DOCS" |
        sed -nE 's/^\| `([a-z0-9_]+)` .*/\1/p' >said
    diff there said
}

@test "the scores of the page are those of the help" {
    for command in query track; do
        conus $command --help | sed -n '/^Scores/,/^$/p' | awk 'NR > 1 && NF { print $1 }' >there
        awk '/^### Scores/ { on = 1 } /^### Columns/ { on = 0 } on' "$DOCS" | sed -nE 's/^\| `([a-z_]+)` .*/\1/p' >said
        diff there said
        [ "$(wc -l <said)" -eq 13 ]
    done
}

@test "exit codes of the page are those of the help" {
    conus --help >help
    for code in 0 1 2 3 4; do
        grep -q "^| $code | " "$DOCS"
        grep -qE "\b$code (done|some queries|usage|bad input|no usable)" help
    done
}
