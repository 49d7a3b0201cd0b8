#!/usr/bin/env bats
# conus query --engine gl, as a user types it.
load helpers

@test "both engines give one answer, exactly and by slices" {
    need_aal
    local aim='--origin=-90,20,20 --toward=0,-10,10 --angle 20'
    for how in '--sampling exact' '--sampling slices' '--sampling slices --slices 900' '--resolution 33'; do
        gl query "$aal" $aim $how --engine gl -o gl.tsv
        answers query "$aal" $aim $how --engine rays -o rays.tsv
        answers diff gl.tsv rays.tsv --tolerance 1e-3
    done
}

@test "both engines give one answer in all layers, in cones, cylinders and ranges" {
    need_aal
    local aim='--origin=-90,20,20 --toward=0,-10,10'
    for how in '--angle 20 --layers all' '--radius 4 --layers all' '--angle 12 --layers all --range 40,70' \
        '--radius 2.5' '--angle 20 --range 90,140 --resolution 40' '--angle 8 --layers all --aperture square'; do
        gl query "$aal" $aim $how --engine gl -o gl.tsv
        answers query "$aal" $aim $how --engine rays -o rays.tsv
        cmp gl.tsv rays.tsv
        [ "$(wc -l <gl.tsv)" -gt 2 ]
    done
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
