#!/usr/bin/env bats
# --engine gl, as a user types it.
load helpers

@test "both engines give one answer, exactly and by slices" {
    need_aal
    local aim='--origin=-90,20,20 --toward=0,-10,10 --angle 20'
    for how in '--sampling exact' '--sampling slices' '--sampling slices --slices 900' \
        '--sampling slices --slice-fraction 1' '--sampling slices --slices 300 --slice-fraction 0.55' '--resolution 33'; do
        gl query "$aal" $aim $how --engine gl --force -o gl.tsv
        answers query "$aal" $aim $how --engine rays --force -o rays.tsv
        answers diff gl.tsv rays.tsv --tolerance 1e-3
    done
}

@test "both engines give one answer in all layers, in cones, cylinders and ranges" {
    need_all
    need_aal
    local aim='--origin=-90,20,20 --toward=0,-10,10'
    for how in '--angle 20 --layers all' '--radius 4 --layers all' '--angle 12 --layers all --range 40,70' \
        '--radius 2.5' '--angle 20 --range 90,140 --resolution 40' '--angle 8 --layers all --aperture square' \
        '--angle 150 --layers all' '--angle 179 --range 20,70' '--angle 140 --aperture square'; do
        gl query "$aal" $aim $how --engine gl --force -o gl.tsv
        answers query "$aal" $aim $how --engine rays --force -o rays.tsv
        cmp gl.tsv rays.tsv
        [ "$(wc -l <gl.tsv)" -gt 2 ]
    done
}

@test "both engines give one answer about a bundle, from within it, too, and in batches" {
    conus phantom bundle -o .
    for how in '--origin 60,0,0 --toward 0,0,0 --angle 30' '--origin 0,0,0 --toward 3,9,40 --angle 90 --layers all' \
        '--origin 30,30,30 --toward 0,0,0 --radius 12 --layers all' '--origin 5,0,0 --toward 0,0,20 --angle 150' \
        '--origin 0,0,-90 --toward 1,2,0 --angle 25 --range 65,80 --aperture square --resolution 33'; do
        gl query bundle.atlas.json $how --engine gl --force -o gl.tsv
        answers query bundle.atlas.json $how --force -o rays.tsv
        cmp gl.tsv rays.tsv
        grep -q Bundle gl.tsv
    done
    awk 'BEGIN { print "x\ty\tz\tdx\tdy\tdz"; for (i = 0; i < 90; i++) print i % 13 - 6, i % 15 - 7, i % 25, sin(i), cos(i), -1 }' |
        tr ' ' '\t' >poses.tsv
    conus batch bundle.atlas.json --poses poses.tsv --angle 40 -o rays.tsv --force
    gl batch bundle.atlas.json --poses poses.tsv --angle 40 --engine gl --block 32 -o gl.tsv --force
    cmp gl.tsv rays.tsv
    [ "$(grep -c Bundle gl.tsv)" -gt 30 ]
}

@test "batches by OpenGL are those of the rays, whatever the block, with rows that are no poses" {
    need_all
    sphere --size 32
    awk 'BEGIN {
        print "x\ty\tz\tdx\tdy\tdz\tangle"
        for (i = 0; i < 300; i++) {
            printf "%d\t%d\t60\t%g\t%g\t%d\t%s\n", i % 31 - 15, i % 17 - 8, sin(i) / 4, cos(i) / 4, i % 13 == 5 ? 0 : -1,
                i % 19 == 2 ? "wide" : i % 7 ? 3 + i % 40 : 118 + i % 61
        }
    }' >poses.tsv
    run ! conus batch sphere.nii.gz --poses poses.tsv -o rays.tsv
    for block in 1 7 64 1000; do
        run --separate-stderr "$CONUS" batch sphere.nii.gz --poses poses.tsv --engine gl --block "$block" -o gl.tsv --force
        [ "$status" -ne 4 ] || need_gl
        [ "$status" -eq 1 ]
        cmp gl.tsv rays.tsv
    done
    [ "$(grep -c error gl.tsv)" -gt 10 ]
}

# Mesa says that it has OpenGL 4.5, but its compiler knows GLSL 3.30 only.
@test "where there is OpenGL, shaders that a driver refuses fail tests, and skip none" {
    need_all
    need_gl
    export MESA_GL_VERSION_OVERRIDE=4.5 MESA_GLSL_VERSION_OVERRIDE=330
    sphere --size 16
    run --separate-stderr "$CONUS" query sphere.nii.gz --origin 0,0,50 --toward 0,0,0 --engine gl
    [ "$status" -ne 0 ] || skip "this driver is not Mesa's"
    [ "$status" -eq 4 ]
    [[ "$stderr" == *"conus: shader "* ]]
    not lacks_gl
    local tests=${CONUS_HAS_GL%/*} group
    for group in gl_context gl_list gl_pass colour tubes shading context_blocks renderer_changes; do
        check_refused "$tests/render/test_render" "$group"
    done
    for group in gl_batch gl_id gl_layers bands contact_value contact sampling share segments picture_view; do
        check_refused "$tests/selection/test_selection" "$group"
    done
}

# check_refused PROGRAM GROUP: asserts that tests of the group fail, and that none is skipped.
check_refused() {
    local code=0
    (cd "$BATS_TEST_TMPDIR" && "$1" "$2") >said 2>&1 || code=$?
    [ $code -ne 0 ] || { echo "$2 passed"; return 1; }
    not grep '\[  SKIPPED' said
}

@test "slices have no layers with OpenGL either" {
    sphere --size 16
    fails 2 'layers: needs exact sampling' query sphere.nii.gz --origin 0,0,50 --toward 0,0,0 --engine gl \
        --sampling slices --layers all
}

@test "the engine in use is said" {
    sphere --size 16
    gl query sphere.nii.gz --origin 0,0,50 --toward 0,0,0 --engine gl
    has 'engine gl, '
}

@test "no OpenGL is exit code 4 where it is asked for, and no matter where it is not" {
    sphere --size 16
    local aim='--origin 0,0,50 --toward 0,0,0'
    export __EGL_VENDOR_LIBRARY_DIRS=/nonexistent
    run --separate-stderr "$CONUS" query sphere.nii.gz $aim --engine gl -o out.tsv
    [ "$status" -ne 0 ] || skip "this EGL is found all the same"
    [ "$status" -eq 4 ]
    check_message 'no OpenGL 4.5 core context'
    [ ! -e out.tsv ]
    answers query sphere.nii.gz $aim
    has 'engine rays, '
}

@test "leaks are looked for, and drivers' memory is not taken for an old glibc's" {
    local program
    for program in "$CONUS" "${CONUS%/*}/conus-view"; do
        [ -x "$program" ] || continue
        grep -aq __asan_init "$program" || skip "built without AddressSanitizer"
        ASAN_OPTIONS=help=1 "$program" --version 2>flags >/dev/null
        [ "$(grep -A 1 -x '[[:space:]]*intercept_tls_get_addr' flags | grep -c 'Current Value: false')" -eq 1 ]
        [ "$(grep -A 1 -x '[[:space:]]*detect_leaks' flags | grep -c 'Current Value: true')" -eq 1 ]
    done
}
