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
    [ "$(jq -r .fragment question)" = "v=1&origin=3,4,40&toward=3,4,0&angle=30&layers=all&resolution=16&cut=3,4,0" ]
    [ "conus $(jq -r .version question)" = "$(conus --version | head -n 1)" ]
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
