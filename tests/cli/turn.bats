#!/usr/bin/env bats
# conus render --frames: a turntable.
load helpers
SMALL='--size 120x100 --slices 60 --legend none -q'

@test "frames are numbered, the same each time, and those of a camera that goes around" {
    sphere --size 32
    camera='--camera-origin=30,200,40 --camera-toward=0,0,0 --camera-up=0,0,1'
    # shellcheck disable=SC2086 # several words
    gl render sphere.nii.gz -o 'f{frame}.exr' --frames 12 $camera $SMALL
    [ "$(echo f*.exr)" = "$(printf 'f%02d.exr ' {1..12} | sed 's/ $//')" ]
    # shellcheck disable=SC2086
    gl render sphere.nii.gz -o 'g{frame}.exr' --frames 12 $camera $SMALL
    cmp f07.exr g07.exr
    # a quarter turn from (30, 200) over the left is (-200, 30), a half (-30, -200)
    for pair in '01 30,200,40' '04 -200,30,40' '07 -30,-200,40' '10 200,-30,40'; do
        # shellcheck disable=SC2086
        answers render sphere.nii.gz -o at.exr --camera-origin="${pair#* }" --camera-toward=0,0,0 --camera-up=0,0,1 $SMALL
        answers diff at.exr "f${pair% *}.exr" --tolerance 0.02
    done
    # shellcheck disable=SC2086
    gl render sphere.nii.gz -o 'h{frame}.exr' --frames 3 --turn -90 $camera $SMALL
    # shellcheck disable=SC2086
    answers render sphere.nii.gz -o at.exr --camera-toward=0,0,0 --camera-up=0,0,1 $SMALL \
        --camera-origin="$(awk 'BEGIN { a = -60 * atan2(0, -1) / 180
            printf "%.9f,%.9f,40", 30 * cos(a) - 200 * sin(a), 30 * sin(a) + 200 * cos(a) }')"
    answers diff at.exr h3.exr --tolerance 0.02
}

@test "without a camera the first frame is from the front, the next quarter from the left" {
    sphere --size 32
    gl render sphere.nii.gz -o '{frame}.svg' --frames 4 --size 300x200 --slices 60
    # x FRAME LETTER
    x() { sed -n "s/.*<text x=\"\([0-9.]*\)\".*>$2<.*/\1/p" "$1.svg"; }
    awk "BEGIN { exit !($(x 1 R) < $(x 1 L) && $(x 2 A) < $(x 2 P) && $(x 3 L) < $(x 3 R) && $(x 4 P) < $(x 4 A)) }"
}

# A box whose corners turn: from one of the sides what is farthest from the middle is at 92 % of the way to the edge, or
# up to a pixel of 160 nearer, which is 2 / 120 of the height's half. A field of view that is given stays.
@test "a turntable fills the picture, and cuts nothing off" {
    PYTHONPATH=$BATS_TEST_DIRNAME /usr/bin/python3 -B - <<'END'
import nifti
nifti.write("box.nii", (20, 30, 16), "B", lambda i, j, k: int(2 < i < 17 and 2 < j < 27 and 2 < k < 13))
END
    for size in 400x300 200x400; do
        for view in '' '--field-of-view 30'; do
            # shellcheck disable=SC2086
            gl render box.nii -o "$size${view:+w}-{frame}.png" --frames 16 --size $size --no-legend -q $view \
                --background transparent
        done
    done
    /usr/bin/python3 - <<'END'
import OpenImageIO as oiio
import numpy
def reach(name):
    alpha = oiio.ImageBuf(name).get_pixels(oiio.FLOAT)[..., 3]
    rows, columns = numpy.nonzero(alpha > 0.5)
    return max(abs(2 * n.astype(float) + 1 - size).max() / size for n, size in zip((rows, columns), alpha.shape))
for size in "400x300", "200x400":
    fitted, wide = (max(reach(f"{size}{kind}-{n:02}.png") for n in range(1, 17)) for kind in ("", "w"))
    assert 0.88 < fitted <= 0.925, (size, fitted)
    assert wide < fitted - 0.05, (size, wide, fitted)
END
}

@test "a turntable needs {frame}, and {frame} a turntable" {
    sphere --size 16
    fails 2 '--output: {frame} is missing' render sphere.nii.gz -o x.png --frames 3
    fails 2 '--output: {frame} stands for the pictures of a turntable' render sphere.nii.gz -o 'x{frame}.png'
    fails 2 '--turn has no effect without --frames' render sphere.nii.gz -o x.png --turn 90
    fails 2 '--turn: 0 turns nothing' render sphere.nii.gz -o 'x{frame}.png' --frames 2 --turn 0
    fails 2 '--frames and --view exclude' render sphere.nii.gz -o 'x{frame}.png' --frames 2 --view left
    fails 2 '--frames: 0 is out of range' render sphere.nii.gz -o 'x{frame}.png' --frames 0
    fails 2 '--frames has no effect on cuts' render sphere.nii.gz -o 'x{frame}.png' --frames 2 --cuts axial
    nothing_left sphere.nii.gz sphere.json sphere.tsv
}

@test "each pose of a file has its frames" {
    sphere --size 32
    printf 'query_id,x,y,z,tx,ty,tz,angle\na,60,0,8,0,0,8,5\nb,-60,0,0,0,0,0,5\n' >two.csv
    # shellcheck disable=SC2086
    gl render sphere.nii.gz --poses two.csv -o '{query}-{frame}.png' --frames 2 $SMALL
    nothing_left sphere.nii.gz sphere.json sphere.tsv two.csv a-1.png a-2.png b-1.png b-2.png
}
