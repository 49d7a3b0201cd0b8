#!/usr/bin/env bats
# conus render -o fig.svg and fig.pdf: text stays text, and lines stay lines.
load helpers

need_readers() {
    for program in rsvg-convert pdftotext; do
        command -v $program >/dev/null || skip "there is no $program (scripts/packages test)"
    done
}

# shellcheck disable=SC2034 # used by the tests
BOX='blocks.nii.gz --labels blocks.txt --cuts axial:0 --origin=-90,0,0 --toward=0,0,0 --angle 20 --background white
    --legend right --width-mm 120 --height-mm 80 --dpi 200 --quiet'

@test "SVG and PDF have the text, the size in mm, the outlines, and look as the PNG does" {
    need_readers
    /usr/bin/python3 "$BATS_TEST_DIRNAME/vectors.py" write
    for ending in png svg pdf; do
        # shellcheck disable=SC2086 # several words
        answers render $BOX -o fig.$ending
    done
    /usr/bin/python3 "$BATS_TEST_DIRNAME/vectors.py" check
    for ending in svg pdf; do # always the same bytes
        # shellcheck disable=SC2086
        answers render $BOX -o again.$ending
        cmp fig.$ending again.$ending
    done
    # shellcheck disable=SC2086
    answers render $BOX -o other.svg --radiological
    x() { sed -n "s/.*<text x=\"\([0-9.]*\)\".*>$1<.*/\1/p" other.svg; }
    awk "BEGIN { exit !($(x R) < $(x L)) }"
}

@test "on paper every text has 6 to 8 points, of a column and of a page, in SVG, PDF and PNG" {
    need_readers
    conus phantom brain -o .
    local cone='--origin=-90,0,0 --toward=0,0,0 --angle 30 --layers all --quiet --dpi 100'
    for mm in 85 180; do
        for ending in png svg pdf; do
            # shellcheck disable=SC2086
            gl render brain.atlas.json $cone --width-mm $mm -o space.$ending
            # shellcheck disable=SC2086
            gl render brain.atlas.json $cone --width-mm $mm --cuts 3d,axial,coronal,sagittal -o cuts.$ending
            gl render brain.atlas.json --view left --legend right --width-mm $mm --dpi 100 -q -o areas.$ending
        done
        for name in space cuts areas; do
            /usr/bin/python3 "$BATS_TEST_DIRNAME/vectors.py" sizes $name $mm
        done
        for letter in a b c d; do
            grep -q "<text.*>$letter</text>" cuts.svg
        done
    done
    not grep -q '<text.*>a</text>' space.svg
}

@test "what is said counts before a style, and a style before the screen's" {
    sphere --size 16
    white() { /usr/bin/python3 "$BATS_TEST_DIRNAME/vectors.py" white "$1"; }
    for style in '--width-mm 30 --dpi 100' '--style print' '--style print --size 200x200'; do
        # shellcheck disable=SC2086
        answers render sphere.nii.gz --cuts axial -q $style -o print.png
        white print.png
    done
    for style in '--width-mm 30 --dpi 100 --style screen' '--width-mm 30 --background light' '--size 200x200'; do
        # shellcheck disable=SC2086
        answers render sphere.nii.gz --cuts axial -q $style -o screen.png
        not white screen.png
    done
    answers render sphere.nii.gz --cuts axial -q --style print -o print.png
    file print.png | grep -q '2126 x' # 180 mm at 300 dpi
    fails 2 '--style: "paper" is none of its choices: auto, screen, print' render sphere.nii.gz -o x.png --style paper
}

@test "the view in space has its text beside the pixels, too" {
    need_readers
    sphere --size 32
    gl render sphere.nii.gz -o ball.svg --size 300x200 --view left --slices 60
    for letter in A P S I; do
        grep -q "<text.*>$letter</text>" ball.svg
    done
    rsvg-convert ball.svg -o ball.png
    gl render sphere.nii.gz -o ball.pdf --size 300x200 --view left --slices 60
    pdfinfo ball.pdf | grep -q 'Page size: *225 x 150 pts' # a pixel is a 96th inch
}

@test "a picture is the same whatever fonts are installed" {
    sphere --size 16
    printf '<fontconfig></fontconfig>' >none.conf
    for ending in png svg pdf; do
        answers render sphere.nii.gz --cuts axial -o here.$ending
        FONTCONFIG_FILE=$PWD/none.conf answers render sphere.nii.gz --cuts axial -o there.$ending
        cmp {here,there}.$ending
    done
    [ "$(pdffonts here.pdf | sed -n '3s/^[A-Z]*+\([A-Za-z]*\) .*/\1/p')" = LiberationSans ]
}

@test "without cairo there is no text, and what lacks is said in one line" {
    sphere --size 16
    mkdir library
    : >library/libcairo.so.2 # an empty library
    for ending in pdf png; do
        LD_LIBRARY_PATH=$PWD/library fails 3 'libcairo.so.2 cannot be loaded (Debian: libcairo2)' \
            render sphere.nii.gz --cuts axial -o x.$ending
        [ ! -e x.$ending ]
    done
    LD_LIBRARY_PATH=$PWD/library answers render sphere.nii.gz --cuts axial -o bare.svg
    xmllint --noout bare.svg
    not grep -q '<text' bare.svg
    fails 3 'cannot write' render sphere.nii.gz --cuts axial -o none/x.svg
    fails 2 'x.eps' render sphere.nii.gz --cuts axial -o x.eps
}
