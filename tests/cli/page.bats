#!/usr/bin/env bats
# conus page: the page contains the atlas, the query and the rows unchanged. scripts/web, which needs a browser, tests
# the page itself.
load helpers

setup() {
    cd "$BATS_TEST_TMPDIR" || return
    conus phantom slabs -o . --size 16
    printf '<html>\n<!-- atlas -->\n<p>end</p>\n' >template.html
}

# page [ARGUMENT...]: a page of the slabs by the template above.
page() {
    conus page slabs.nii.gz --template template.html -o page.html "$@"
}

# inside NAME: the bytes of a file in the page.
inside() {
    sed -n "s|^<script type=\"application/octet-stream\" data-file=\"$1\"[^>]*>\\(.*\\)</script>\$|\\1|p" page.html | base64 -d
}

@test "the files of the atlas are in the page, byte for byte, between the template's halves" {
    page
    [ "$(sed -n 1,2p page.html)" = $'<html>\n<!-- atlas -->' ]
    [ "$(tail -n 1 page.html)" = '<p>end</p>' ]
    [ "$(grep -c data-file page.html)" -eq 2 ]
    inside slabs.nii.gz | cmp - slabs.nii.gz
    inside slabs.tsv | cmp - slabs.tsv
    [[ $(grep -m1 data-file page.html) == *'"slabs.nii.gz"'* ]] # the atlas comes first
    run ! grep -q 'id="question"' page.html
}

@test "the rows in the page are those of conus query" {
    page --origin 3,4,40 --toward 3,4,0 --angle 30 --layers all
    conus query slabs.nii.gz --origin 3,4,40 --toward 3,4,0 --angle 30 --layers all --format ndjson --quiet >rows
    sed -n 's|^<script type="application/json" id="question">\(.*\)</script>$|\1|p' page.html >question
    jq -j .rows question | cmp - rows
    [ "$(jq -r .fragment question)" = "v=1&origin=3,4,40&toward=3,4,0&angle=30&layers=all&resolution=64" ]
    [ "conus $(jq -r .version question)" = "$(conus --version | head -n 1)" ]
}

@test "a weight opens the cone, ranks by posteriors, and is a normal one alone" {
    page --origin 3,4,40 --toward 3,4,0 --weight gauss=2
    conus query slabs.nii.gz --origin 3,4,40 --toward 3,4,0 --weight gauss=2 --score posterior --format ndjson --quiet >rows
    sed -n 's|^<script type="application/json" id="question">\(.*\)</script>$|\1|p' page.html >question
    jq -j .rows question | cmp - rows
    grep -q '"posterior":[01]' rows
    [ "$(jq -r .fragment question)" = "v=1&origin=3,4,40&toward=3,4,0&angle=16&layers=visible&weight=gauss=2&resolution=64" ]
    local weight
    for weight in hard coil=20:18 gauss=1,bias=1:1 gauss=30 gauss=; do
        run -2 page --origin 3,4,40 --toward 3,4,0 --weight $weight --force
        [[ $output == *'--weight: '* ]]
    done
}

@test "an image below the areas is in the page and marked" {
    conus phantom sphere -o other --size 16
    page --context other/sphere.nii.gz 2>notes
    grep -q 'face can be recognised' notes
    [ "$(grep -c data-context page.html)" -eq 1 ]
    inside sphere.nii.gz | cmp - other/sphere.nii.gz
    page --context other/sphere.nii.gz --force --quiet 2>notes
    [ ! -s notes ]
}

@test "names that would end a tag or an attribute do not" {
    cp slabs.nii.gz 'a"b<c&d.nii.gz'
    conus page 'a"b<c&d.nii.gz' --template template.html -o page.html --quiet
    grep -qF 'data-file="a&quot;b&lt;c&amp;d.nii.gz"' page.html
}

@test "a manifest's files keep their places below it" {
    mkdir deep
    cp slabs.* deep
    echo '{"conus_atlas": 1, "parcellation": {"file": "deep/slabs.nii.gz"}}' >whole.atlas.json
    conus page whole.atlas.json --template template.html -o page.html --quiet
    [[ $(grep -m1 data-file page.html) == *'"whole.atlas.json"'* ]]
    inside 'deep/slabs.nii.gz' | cmp - deep/slabs.nii.gz
    inside 'deep/slabs.tsv' | cmp - slabs.tsv
}

@test "what cannot be written is refused, and nothing is left" {
    refused() { # MESSAGE ARGUMENT...
        local words=$1
        shift
        run -"$status_wanted" conus page "$@"
        [[ $output == *"$words"* ]]
        [ ! -e page.html ]
    }
    status_wanted=3 refused 'Debian package conus-page' slabs.nii.gz -o page.html
    status_wanted=3 refused 'nothing.html' slabs.nii.gz -o page.html --template nothing.html
    status_wanted=3 refused 'atlas -->' slabs.nii.gz -o page.html --template slabs.nii.gz
    TMPDIR=$PWD/none status_wanted=3 refused 'cannot make' slabs.nii.gz -o page.html --template template.html
    status_wanted=2 refused 'toward' slabs.nii.gz -o page.html --template template.html --origin 0,0,0
    status_wanted=2 refused '.html' slabs.nii.gz -o page.txt --template template.html
    status_wanted=2 refused 'toward' slabs.nii.gz -o page.html --template template.html --origin 1,1,1 --toward 1,1,1
    status_wanted=3 refused 'template.html' slabs.nii.gz -o page.html --template template.html --context template.html
    truncate -s 101M large.bin
    gzip -dc slabs.nii.gz >large.nii
    truncate -s 101M large.nii
    status_wanted=3 refused '--large' large.nii -o page.html --template template.html
    page
    run -2 conus page slabs.nii.gz --template template.html -o page.html
    [[ $output == *--force* ]]
}

# packs NAME...: these files are in the page, in this order, and the page's loader opens them where nothing else is.
packs() {
    [ "$(grep -o 'data-file="[^"]*"' page.html | cut -d'"' -f2)" = "$(printf '%s\n' "$@")" ] || { grep -o 'data-file="[^"]*"' page.html; return 1; }
    rm -rf unpacked
    for name; do
        mkdir -p "unpacked/$(dirname "$name")"
        inside "$name" >"unpacked/$name"
    done
    CONUS_HDF5=/dev/null conus info "unpacked/$1" >opened.txt
}

# refuses WORDS ATLAS: no page, and one line with these words.
refuses() {
    rm -f page.html
    run -3 --separate-stderr conus page "$2" --template template.html -o page.html --quiet
    check_message "$1"
    [ ! -e page.html ]
}

@test "a page has what was read, and nothing that is only called so" {
    local word
    for word in BIDS table in; do # words of "BIDS label table in slabs.tsv"
        echo SECRET >$word
    done
    mkdir label # such as FreeSurfer's
    printf 'index\tname\n1\tSECRET\n' | tee slabs-other.tsv participants.tsv >x.tsv
    cp slabs.nii.gz slabs-7T.nii.gz
    page 2>notes
    packs slabs.nii.gz slabs.tsv
    run ! grep -q "$(echo SECRET | base64)" page.html
    grep -q '^conus: note: the page has inside: slabs.nii.gz, slabs.tsv$' notes
    page --quiet --force 2>notes
    [ ! -s notes ]
}

@test "a manifest's page opens by itself: context, streamlines, meshes, pathways" {
    conus phantom bundle -o .
    conus page bundle.atlas.json --template template.html -o page.html --quiet
    packs bundle.atlas.json bundle.tck
    conus phantom brain -o .
    conus page brain.atlas.json --template template.html -o page.html --force 2>notes
    grep -q 'brain-context.nii.gz: a face can be recognised' notes
    packs brain.atlas.json brain-{01-AntL,02-AntR,03-SupL,04-SupR,05-PosL,06-PosR,07-LatL,08-LatR,09-InfL,10-InfR,11-Cor}.surf.gii \
        brain-pathway.nii.gz brain-context.nii.gz
    conus info unpacked/brain.atlas.json | grep -q context
    mkdir -p deep/one other
    cp slabs.nii.gz deep/one
    conus phantom sphere -o other --size 16
    mv other/sphere.nii.gz other/slabs.nii.gz # two files of one name
    echo '{"conus_atlas": 1, "allow_outside": true, "parcellation": {"file": "one/slabs.nii.gz"},
        "context": {"file": "../other/slabs.nii.gz"}}' >deep/up.atlas.json
    ln -s deep linked
    conus page linked/up.atlas.json --template template.html -o page.html --quiet --force
    packs linked/up.atlas.json linked/one/slabs.nii.gz other/slabs.nii.gz
    conus page slabs.nii.gz --context other/slabs.nii.gz --template template.html -o page.html --quiet --force
    packs slabs.nii.gz slabs.tsv context/slabs.nii.gz
    grep -q 'data-file="context/slabs.nii.gz" data-context' page.html
}

@test "an atlas of several files, and a table of FreeSurfer's folder" {
    gzip -dc slabs.nii.gz >slabs.nii
    tail -c +353 slabs.nii >v.raw
    printf '%s\n' NRRD0004 'type: uint8' 'dimension: 3' 'sizes: 16 16 16' 'space: RAS' 'space directions: (1,0,0) (0,1,0) (0,0,1)' \
        'space origin: (-8,-8,-8)' 'encoding: raw' 'data file: v.raw' >v.nhdr
    conus page v.nhdr --template template.html -o page.html --quiet
    packs v.nhdr v.raw
    mkdir home
    printf 'p = 2\n' >aseg.awk
    conus phantom u-shape -o . --size 16
    # left and right Cerebral-White-Matter, Cortex and Ventricle, each on its side, which FreeSurfer's own labels are known by
    python3 - <<'END'
import gzip, struct
head = bytearray(gzip.open("u-shape.nii.gz").read()[:352])
labels = bytes(((2, 41), (3, 42), (4, 43))[z // 6][x > 7] for z in range(16) for y in range(16) for x in range(16))
gzip.open("aseg.nii.gz", "wb").write(head + labels)
END
    printf '2 LWM 1 1 1 0\n41 RWM 1 1 2 0\n3 LC 1 1 3 0\n42 RC 1 1 4 0\n4 LV 1 1 5 0\n43 RV 1 1 6 0\n' >home/FreeSurferColorLUT.txt
    export FREESURFER_HOME=$PWD/home
    rm slabs.tsv u-shape.tsv
    conus page aseg.nii.gz --template template.html -o page.html --quiet --force
    FREESURFER_HOME='' packs aseg.nii.gz FreeSurferColorLUT.txt
    FREESURFER_HOME='' conus info unpacked/aseg.nii.gz | grep -q LWM
    mkdir deep # where that table would not be beside it
    mv aseg.nii.gz deep
    echo '{"conus_atlas": 1, "parcellation": {"file": "deep/aseg.nii.gz"}}' >deep.atlas.json
    refuses 'deep.atlas.json: a page would call its areas otherwise: their names come from FreeSurfer' deep.atlas.json
}

@test "what no page opens is refused by its name" {
    mkdir two.zarr folder
    echo '{"zarr_format": 2, "shape": [2, 2, 2], "chunks": [2, 2, 2], "dtype": "|u1", "order": "C", "compressor": null,
        "fill_value": 1}' >two.zarr/.zarray
    printf 11111111 >two.zarr/0.0.0
    cp slabs.* folder
    refuses 'slabs.nii.gz,volume=0: a page opens one file' slabs.nii.gz,volume=0
    refuses 'two.zarr,resolution=1000,orientation=asr: a page opens one file' two.zarr,resolution=1000,orientation=asr
    printf '{"conus_atlas": 1, "allow_outside": true, "parcellation": {"file": "%s"}}' "$PWD/slabs.nii.gz" >root.atlas.json
    refuses "root.atlas.json: a page cannot open it: $PWD/slabs.nii.gz is named by its path from the root on" root.atlas.json
}

@test "a page refuses HDF5, which needs another program" {
    /usr/bin/python3 "$BATS_TEST_DIRNAME/hdf5.py" minc m.mnc 8 || skip 'no python3-h5py'
    refuses 'm.mnc: a page cannot open it: no page reads HDF5' m.mnc
}

# A folder with conus and the template alone, without a window, as a wheel or a release has it, and a desktop whose
# xdg-open writes its words and input to the file "shown".
alone() {
    mkdir -p alone desktop tmp
    cp "$CONUS" template.html alone
    mv alone/template.html alone/page.html
    printf '#!/bin/sh\nprintf "%%s\\n" "$@" >"%s/shown"\ncat >>"%s/shown"\necho noise\n%s\n' "$PWD" "$PWD" "$1" >desktop/xdg-open
    chmod +x desktop/xdg-open
    export LD_LIBRARY_PATH=${CONUS%/apps/cli/conus} TMPDIR=$PWD/tmp DISPLAY=:none PATH=$PWD/desktop:/usr/bin:/bin
    ! command -v conus-view || skip 'a window is installed'
}

# view ARGUMENT...: without a window; the page is then the one that was shown.
view() {
    rm -f shown
    run -0 --separate-stderr alone/conus view "$@"
    [ -z "$output" ]
    [ "$(wc -l <shown)" -eq 1 ]
    shown=$(cat shown)
}

@test "without a window conus view has the browser show what conus page writes" {
    alone true
    view slabs.nii.gz
    [ "${#stderr_lines[@]}" -eq 2 ]
    [ "${stderr_lines[0]}" = 'conus: note: the page has inside: slabs.nii.gz, slabs.tsv' ]
    [[ "${stderr_lines[1]}" == "conus: note: opened in the browser: $shown, which stays "*' package conus-view)' ]]
    [[ $shown == "$TMPDIR"/conus-view-??????/slabs.html ]]
    [ "$(stat -c %a "${shown%/*}")" = 700 ]
    page --quiet
    cmp page.html "$shown"
    local first=$shown
    view slabs.nii.gz --origin 3,4,40 --toward 3,4,0 --angle 30 --layers all --quiet
    [ -z "$stderr" ]
    page --origin 3,4,40 --toward 3,4,0 --angle 30 --layers all --quiet --force
    cmp page.html "$shown"
    [ "$first" != "$shown" ] && [ -e "$first" ] # no page takes the place of another
    # its options are those of conus page, but for the two about the file
    alone/conus view --help | sed -n '/^Options/,$s/^.* --\([a-z]*\).*/\1/p' >options
    alone/conus page --help | sed -n '/^Options/,$s/^.* --\([a-z]*\).*/\1/p' | grep -vxE 'output|force' >wanted
    diff wanted options
    alone/conus help view --long | diff - <(alone/conus view --help)
}

@test "any name of an atlas gives the page a name that no program misreads" {
    alone true
    local odd=$'-a b\'c"d%20#?é;$x'
    mkdir -- "$odd"
    cp slabs.nii.gz "./$odd/$odd.nii.gz"
    view "./$odd/$odd.nii.gz" --quiet
    [ "${shown##*/}" = '_a_b_c_d_20__é__x.html' ]
    grep -qF 'data-file="-a b' "$shown"
    # 100 bytes of a name, and no half of the letter of 2 bytes that would be the 100th and the next
    local long
    printf -v long '%099dé' 0
    cp slabs.nii.gz "$long.nii.gz"
    view "$long.nii.gz" --quiet
    [ "${shown##*/}" = "${long%é}.html" ]
}

@test "a browser that cannot be started leaves the page, its name and success" {
    unshown() {
        run -0 --separate-stderr "$@" alone/conus view slabs.nii.gz --quiet
        [ -z "$output" ]
        check_message 'no browser could be started here: open '
        local path=${stderr#*open }
        [ -s "${path%% in one*}" ]
    }
    alone 'exit 4'
    unshown env
    rm shown
    unshown env -u DISPLAY -u WAYLAND_DISPLAY -u BROWSER
    [ ! -e shown ] # which would be a browser in the terminal
    rm desktop/xdg-open
    command -v xdg-open || unshown env
}

@test "conus view does not wait for the browser" {
    mkfifo held
    alone "read line <'$PWD/held'" # as a browser that runs until it is closed
    view slabs.nii.gz --quiet 3>&-
    echo >held # ends it: it was still there
}

@test "what a page has not is refused, and nothing is left" {
    alone true
    left_nothing() { # STATUS WORDS ARGUMENT...
        run "-$1" --separate-stderr alone/conus view "${@:3}"
        check_message "$2"
        [ -z "$(ls -A tmp)" ] && [ ! -e shown ]
    }
    for option in --script --atlas --output --force --full-screen; do
        left_nothing 2 "unknown option $option of conus view where conus-view is not installed" slabs.nii.gz $option x
    done
    left_nothing 2 'ATLAS is missing'
    left_nothing 3 'none.nii.gz' none.nii.gz
    conus pack slabs.nii.gz -o slabs.conus
    left_nothing 3 'slabs.conus: a page needs the files that it was packed from: slabs.tsv, ...' slabs.conus
    left_nothing 2 'toward' slabs.nii.gz --origin 1,1,1
    TMPDIR=$PWD/slabs.tsv left_nothing 3 'slabs.tsv/conus-view-' slabs.nii.gz
    rm alone/page.html
    left_nothing 3 'the window, conus-view, is not installed (Debian package conus-view), and the page' slabs.nii.gz
    # an installation's template
    mkdir -p share/conus
    cp template.html share/conus/page.html
    view slabs.nii.gz --quiet
    cmp <(page --quiet && cat page.html) "$shown"
}
