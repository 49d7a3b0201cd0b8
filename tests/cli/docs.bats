#!/usr/bin/env bats
# The documents show what the programs do: the examples of every page are run, and the lists of docs/commands.md are
# compared with the program's own.
load helpers
ROOT=$BATS_TEST_DIRNAME/../..
DOCS=$ROOT/docs/commands.md

# same_engine: replaces the only part of the examples' output that differs between machines.
same_engine() {
    sed -E 's/engine rays, [a-z0-9]+/engine rays, any/'
}

# examples PAGE: runs the page's examples in a separate folder, which has the atlases of mricron-data if they are
# installed, and compares their output. scripts/check-docs --help says which blocks are examples.
examples() {
    local folder
    folder=$(basename "$1" .md)
    [ ! -e "$folder" ] || folder+=-$(basename "$(dirname "$1")") # a README
    "$ROOT/scripts/check-docs" --examples "$1" >"$folder.sh"
    mkdir "$folder"
    for file in "$TEMPLATES"/{aal,ch2,ch2bet}.*; do
        [ ! -e "$file" ] || ln -s "$file" "$folder/"
    done
    (cd "$folder" && PATH=${CONUS%/*}:$PATH XDG_CACHE_HOME=$PWD bash "../$folder.sh" 3>"../$folder.said") >"$folder.got" || true
    diff <(same_engine <"$folder.said") <(same_engine <"$folder.got")
}

# need_walk: skips the test without what the pages that draw need from their first command on: the brains of
# mricron-data, and OpenGL.
need_walk() {
    need_aal
    [ "$TEMPLATES" = /usr/share/mricron/templates ] || skip "the pages name /usr/share/mricron/templates"
    sphere --size 16
    gl render sphere.nii.gz --size 16x16 -o gl.png -q
}

@test "the examples of every other page print what they are said to print" {
    while IFS= read -r page; do
        [[ " tutorial recipes " == *" $(basename "$page" .md) "* ]] || examples "$ROOT/$page"
    done < <("$ROOT/scripts/check-docs" --list | sed -n 's/:[0-9]*: .*commands.*//p' | sort -u)
    [ "$(grep -c '^\$ ' commands.said)" -ge 8 ]
    [ "$(grep -c '^\$ ' scenes.said)" -ge 2 ]
}

@test "so do those of the tutorial" {
    need_walk
    examples "$ROOT/docs/tutorial.md"
    [ "$(grep -c '^\$ ' tutorial.said)" -ge 14 ]
}

@test "so do those of the recipes" {
    need_walk
    examples "$ROOT/docs/recipes.md"
    [ "$(grep -c '^\$ ' recipes.said)" -ge 45 ]
}

# parses COMMAND...: runs conus commands of lines of stdin without their files: none is a mistake of usage (2).
parses() {
    local command code
    while IFS= read -r command; do
        [[ $command != "conus view "* || -x ${CONUS%/*}/conus-view ]] || continue
        code=0
        (PATH=${CONUS%/*}:$PATH DISPLAY='' XDG_CACHE_HOME=$PWD bash -c "$command" >log 2>&1 </dev/null) || code=$?
        case $code in 0 | 3 | 4) ;; *) echo "$command: exit code $code: $(cat log)"; return 1 ;; esac
    done
}

@test "commands of the documents that need other files have the right options" {
    "$ROOT/scripts/check-docs" --unrun >commands
    sed -n 's/^    conus /conus /p' "$ROOT/packaging/programs/README.txt" >>commands
    [ "$(wc -l <commands)" -ge 40 ]
    parses <commands
}

@test "so have the examples of every help, which are those of the man pages" {
    for command in $(conus --help | sed -n 's/^  \([a-z]*\)  *[a-z].*/\1/p'); do
        [ $command != view ] || [ -x "${CONUS%/*}/conus-view" ] || continue
        conus $command --help | sed -n '/^Examples/,/^$/p' | sed -n 's/^  \(tracker | \)\?\(conus .*\)/\2/p'
    done >commands
    [ "$(wc -l <commands)" -ge 40 ]
    parses <commands
}

@test "a word with two entries in the glossary has the thing of which each is" {
    sed -nE 's/^\* \*\*([^*]+)\*\*( of [a-z ]+)?:.*/\1\2/p' "$ROOT/docs/glossary.md" | sort >words
    [ "$(wc -l <words)" -ge 100 ]
    [ -z "$(uniq -d words)" ] || { uniq -d words; return 1; }
}

# A pipe of Linux holds 64 KiB: an answer below that is written, even though nobody reads it.
@test "a reader that leaves early ends a long answer with 3 and no message, and a short one with 0" {
    sphere --size 16
    { echo 'x y z dx dy dz' && yes '0 0 90 0 0 -1' | head -4000 || true; } | tr ' ' '\t' >poses.tsv
    set +o pipefail
    { conus query sphere.nii.gz --pose poses.tsv --angle 5 -q 2>said || echo $? >code; } | head -n 1 >first
    [ "$(cat code)" -eq 3 ]
    { conus info sphere.nii.gz 2>>said && echo 0 >short; } | wait_until $$ test -s short
    [ ! -s said ]
}

# scripts/option-lists leaves the section of conus-view where that is not built. Each line is put wrong alone.
@test "the lists of options are those of the rows, also when a form, a default, or an item is wrong" {
    run -0 "$ROOT/scripts/option-lists" --check
    mkdir docs
    cp "$ROOT"/docs/*.md docs
    for wrong in 's/`--size N`: vox/`--size M`: vox/' 's/(1 to 1024; default) 64/\1 63/' 's/`--top N/`--top K/' '/^\* `--smooth/d' \
        's/^\* as for `query`: `--labels`,/& `--rank`,/'; do
        sed -i -E "$wrong" docs/commands.md
        run ! cmp -s docs/commands.md "$DOCS"
        run -1 "$ROOT/scripts/option-lists" --check docs/commands.md
        run -0 "$ROOT/scripts/option-lists" docs/commands.md
        cmp docs/commands.md "$DOCS"
    done
    sed -i 's/^SIGINT (Ctrl-C)/`--sigint` &/' docs/commands.md
    run -1 "$ROOT/scripts/option-lists" --check docs/commands.md
    [ "$output" = "batch: --sigint is no option" ]
}

@test "the columns of the page are those of the TSV, in their order" {
    sphere --size 16
    conus query sphere.nii.gz --origin 0,0,90 --toward 0,0,0 --layers all --weight hard --prior size --format tsv | head -1 | tr '\t' '\n' >there
    awk '/^##/ { on = /^### Columns/ } on' "$DOCS" |
        sed -nE 's/^\| `([a-z0-9_` ]+)` \|.*/\1/p' | tr -d '`' | tr ' ' '\n' >said
    diff there said
}

@test "the methods of a tolerance have one name in the documents and in the program" {
    local said
    said=$(grep -oh 'method `[a-z]*`' "$ROOT"/docs/*.md | sort -u | tr -d '`')
    [ "$(grep -c . <<<"$said")" -ge 2 ]
    while read -r _ word; do
        grep -A 2 '^static struct cell get_method' "$ROOT/selection/report/report_columns.c" | grep -q "\"$word\"" ||
            { echo "$word"; return 1; }
    done <<<"$said"
}

@test "the scores of Eq. 12 are those of the help, in their order" {
    for command in query track; do
        conus $command --help | sed -n '/^Scores/,/^$/p' | awk 'NR > 1 && NF { print $1 }' >there
        awk '/^#/ { on = /^## Eq. 12 / } on' "$ROOT/docs/model.md" | sed -nE 's/^\| ([a-z_]+) \|.*/\1/p' | grep -v '^name$' >said
        diff there said
        [ "$(wc -l <said)" -ge 18 ]
    done
}

@test "exit codes of the page are those of the help" {
    conus --help >help
    for code in 0 1 2 3 4; do
        grep -q "^| $code | " "$DOCS"
        grep -qE "\b$code (done|some queries|usage|bad input|no usable)" help
    done
}
