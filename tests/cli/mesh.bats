#!/usr/bin/env bats
# conus mesh, as a user types it.
load helpers

# need_mesh: the program that makes the meshes.
need_mesh() {
    [ -x "$(dirname "$CONUS")/conus-mesh" ] || skip "no conus-mesh: built without VTK"
}

@test "a phantom's surface in every format" {
    need_mesh
    sphere --size 24
    for format in gii vtp obj ply stl; do
        answers mesh sphere.nii.gz -o out --format $format
        [ -s out/1_Sphere.$format ]
    done
}

# volume_of FILE.obj: the signed volume of its triangles, above 0 where they face outwards.
volume_of() {
    awk '/^v / { x[++n] = $2; y[n] = $3; z[n] = $4 }
        /^f / { split($2, p, "/"); split($3, q, "/"); split($4, r, "/"); a = p[1]; b = q[1]; c = r[1]
            sum += x[a] * (y[b] * z[c] - y[c] * z[b]) - y[a] * (x[b] * z[c] - x[c] * z[b]) + z[a] * (x[b] * y[c] - x[c] * y[b]) }
        END { print sum / 6 }' "$1"
}

# The atlas's vertices follow from those of the moved one by the matrix in the file: x = 7 - 2 y, y = 2 x, z = 2 z.
@test "surfaces lie where --atlas-transform brings the atlas" {
    need_mesh
    sphere --size 24
    printf '0 -2 0 7\n2 0 0 0\n0 0 2 0\n0 0 0 1\n' >turn.txt
    printf -- '-1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n' >mirror.txt
    conus mesh sphere.nii.gz -o plain --format obj
    conus mesh sphere.nii.gz -o turned --format obj --atlas-transform turn.txt --quiet
    conus mesh sphere.nii.gz -o mirrored --format obj --atlas-transform mirror.txt --quiet
    paste -d ' ' <(grep '^v ' plain/1_Sphere.obj) <(grep '^v ' turned/1_Sphere.obj) |
        awk '{ d = ($2 - 7 + 2 * $7) ^ 2 + ($3 - 2 * $6) ^ 2 + ($4 - 2 * $8) ^ 2; if (d > 1e-9) exit 1 }'
    [ "$(grep -c '^v ' turned/1_Sphere.obj)" -gt 100 ]
    volume=$(volume_of plain/1_Sphere.obj)
    awk -v a="$volume" -v b="$(volume_of turned/1_Sphere.obj)" 'BEGIN { exit !(b > 0 && (8 * b / a - 1) ^ 2 < 1e-8) }'
    awk -v a="$volume" -v b="$(volume_of mirrored/1_Sphere.obj)" 'BEGIN { exit !(b > 0 && (b / a - 1) ^ 2 < 1e-4) }'
    echo '{"conus_atlas": 1, "parcellation": "sphere.nii.gz", "transform": "turn.txt"}' >one.atlas.json
    conus mesh one.atlas.json -o kept --format obj --quiet
    cmp kept/1_Sphere.obj turned/1_Sphere.obj
    # a surface in a file is moved, too
    conus mesh plain/1_Sphere.obj -o file --format obj --atlas-transform turn.txt --quiet
    awk -v a="$volume" -v b="$(volume_of file/1_Sphere.obj)" 'BEGIN { exit !(b > 0 && (8 * b / a - 1) ^ 2 < 1e-8) }'
}

# In both scenes the first of the files on one grid has the same bytes and the same labels.
@test "surfaces of joined parcellations are those of all files" {
    need_mesh
    for second in sphere torus; do
        mkdir "$second"
        conus phantom slabs -o "$second" --size 24
        conus phantom "$second" -o "$second" --size 24
        printf '{"conus_atlas": 1, "parcellations": ["slabs.nii.gz", {"file": "%s.nii.gz", "label_offset": 1000}]}' \
            "$second" >"$second/two.atlas.json"
        conus mesh "$second/two.atlas.json" -o "$second/out" --format obj --quiet
        [ "$(find "$second/out" -name '*.obj' | wc -l)" -eq 3 ]
        grep -h '^v ' "$second"/out/1001_*.obj >"$second.txt"
    done
    run -1 cmp -s sphere.txt torus.txt
    conus phantom nested -o sphere --size 40 # another grid
    sed -i 's/]/, {"file": "nested.nii.gz", "label_offset": 2000}]/' sphere/two.atlas.json
    conus mesh sphere/two.atlas.json -o sphere/three --format obj --quiet
    find sphere/three -name '200*.obj' | grep -q .
    for mesh in sphere/out/*; do
        cmp "$mesh" "sphere/three/${mesh##*/}"
    done
}

@test "smoothing and decimation change the mesh" {
    need_mesh
    sphere --size 24
    conus mesh sphere.nii.gz -o plain --format obj
    conus mesh sphere.nii.gz -o steps --format obj --smooth 0
    conus mesh sphere.nii.gz -o round --format obj --smooth 15 --pass-band 0.1
    conus mesh sphere.nii.gz -o few --format obj --decimate 0.5
    [ "$(grep -c ^f plain/1_Sphere.obj)" -eq "$(grep -c ^f steps/1_Sphere.obj)" ]
    run ! cmp -s plain/1_Sphere.obj steps/1_Sphere.obj
    run ! cmp -s plain/1_Sphere.obj round/1_Sphere.obj
    [ "$(grep -c ^v few/1_Sphere.obj)" -lt "$(($(grep -c ^v plain/1_Sphere.obj) * 6 / 10))" ]
}

@test "without conus-mesh, one line says where it was looked for" {
    sphere --size 16
    CONUS_MESH=$PWD/none fails 3 'CONUS_MESH: ' mesh sphere.nii.gz -o out
}

@test "options out of their range" {
    sphere --size 16
    fails 2 '--decimate' mesh sphere.nii.gz -o out --decimate 1
    fails 2 '--smooth' mesh sphere.nii.gz -o out --smooth 1001
    fails 2 '--pass-band' mesh sphere.nii.gz -o out --pass-band 2.1
    fails 2 '--pass-band' mesh sphere.nii.gz -o out --pass-band 0
    fails 2 '--pass-band has no effect' mesh sphere.nii.gz -o out --smooth 0 --pass-band 1
    fails 2 '--format' mesh sphere.nii.gz -o out --format xyz
    [ ! -e out ]
}

@test "AAL: a file for each area" {
    need_mesh
    need_aal
    answers mesh "$aal" -o out
    [ "$(find out -name '*.gii' | wc -l)" -eq 116 ]
    [ -s out/37_Hippocampus_L.gii ]
}

@test "mesh files that break readers are one line each" {
    local header='ply\nformat binary_little_endian 1.0\nelement vertex %s\nproperty float x\nproperty float y\nproperty float z\n'
    # shellcheck disable=SC2059 # a format
    printf "${header}element face 2\nproperty list uchar int vertex_indices\nend_header\nxxxx" 4 >short.ply
    # shellcheck disable=SC2059
    printf "${header}end_header\n" 2000000000 >claims.ply
    printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 999999\n' >far.obj
    printf 'P 0.3 0.3 0.4 10 1 3\n 0 0 0\n' >mni.obj
    : >empty.obj
    fails 3 'short.ply: header: 4 elements of 12 bytes or more, 4 bytes follow' info short.ply
    fails 3 'claims.ply: header: element vertex 2000000000: more than the ' info claims.ply
    fails 3 'far.obj: line 4: vertex 999999, allowed are 1 to 3' info far.obj
    fails 3 'mni.obj: content: an MNI object file' info mni.obj
    fails 3 'empty.obj: content: the file is empty' info empty.obj
}

@test "a mesh that conus wrote is an atlas again" {
    need_mesh
    sphere --size 24
    for format in gii vtp obj ply stl; do
        conus mesh sphere.nii.gz -o out --format $format
        run -0 "$CONUS" query out/1_Sphere.$format --origin 0,0,90 --toward 0,0,0 --angle 2 --quiet --format tsv
        [ "$(cell pixels 1)" = 3228 ]
    done
}
