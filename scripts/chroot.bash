# To be sourced by scripts that try conus in a Debian of its own. They set `results`, a folder for logs, `fail`,
# `mirror`, and most of them `user`, the Debian that gets conus.
# shellcheck shell=bash disable=SC2154

# make_wheel: in a folder with the sources; what comes of it is in its folder dist. Times, owners and order of files in
# the source package are made the same for everyone.
make_wheel() {
    local name
    /usr/bin/python3 setup.py -q sdist --formats=tar
    name=$(basename dist/*.tar .tar)
    tar -xf "dist/$name.tar"
    rm "dist/$name.tar"
    tar --sort=name --mtime="@$SOURCE_DATE_EPOCH" --owner=0 --group=0 --numeric-owner --mode=u=rwX,go=rX -c "$name" |
        gzip -9n >"dist/$name.tar.gz"
    rm -r "$name"
    /usr/bin/python3 -m pip wheel --no-index --no-deps --no-build-isolation -w plain "dist/$name.tar.gz"
    /usr/bin/python3 packaging/wheel/complete.py plain/*.whl dist
}

# step NAME COMMAND...: what the command says goes to NAME.log; its last line says what came of it. Where it fails, its
# end is said, too: a machine that only shows this output may not keep the log.
step() {
    local name=$1 begun=$SECONDS status log=$results/$1.log
    shift
    set +e
    (set -ex; "$@") >"$log" 2>&1 </dev/null
    status=$?
    set -e
    [ $status = 0 ] || {
        tail -n 40 "$log" >&2
        fail "$name has failed (${log#"$PWD/"})"
    }
    printf '%-9s %4d s  %s\n' "$name" $((SECONDS - begun)) "$(tail -n 1 "$log")"
}

# in_root ROOT COMMAND...: in that Debian, from which no process and no variable of this one can be seen.
in_root() {
    local root=$1
    shift
    unshare --mount --pid --fork --kill-child --mount-proc="$root/proc" chroot "$root" \
        env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/tmp LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
        ${http_proxy+"http_proxy=$http_proxy"} "$@"
}

# make_bare SUITE ROOT: a Debian that debootstrap makes, from the mirror that `mirror` may have.
make_bare() {
    debootstrap --variant=minbase "$1" "$2" "${mirror[@]}"
    echo force-unsafe-io >"$2/etc/dpkg/dpkg.cfg.d/unsafe" # it need not outlive a power cut
    in_root "$2" apt-get update
}

# inside FUNCTION [FUNCTION...]: runs it in the Debian that gets conus; it may call the others.
inside() {
    in_root "$user" bash -euxo pipefail -c "$(declare -f "$@") && cd /tmp && PATH=/usr/local/bin:\$PATH $1"
}

# first_answer: README.md's question.
first_answer() {
    conus query /usr/share/mricron/templates/aal.nii.gz --origin=-90,20,20 --toward=0,-10,10 --angle 20 | tee rows
    [ "$(awk '$2 ~ /_[LR]$/ { print $2, $6 }' rows)" = $'Frontal_Inf_Oper_L 2921\nPrecentral_L 238\nPostcentral_L 69' ]
}

# first_answer_of_python PYTHON...: the same, by a wheel.
first_answer_of_python() {
    "$@" -c '
import conus
rows = [(hit.name, hit.pixels) for hit in conus.load("aal").select((-90, 20, 20), toward=(0, -10, 10), angle=20) if hit.pixels]
print(rows)
assert rows == [("Frontal_Inf_Oper_L", 2921), ("Precentral_L", 238), ("Postcentral_L", 69)], rows
'
}

# find_triangles: where there is no Embree, which one line says.
find_triangles() {
    conus phantom brain -o brain
    conus query brain/brain.atlas.json --origin=0,0,120 --toward=0,0,0 2>said >got
    cat said got
    grep 'Debian: libembree3-3' said
    grep -q ' share ' got
}

# draw_picture: by OpenGL, or by rays where there is none, without a word.
draw_picture() {
    conus phantom sphere --size 16 -o .
    conus render sphere.nii.gz --origin=0,0,90 --toward=0,0,0 -o sphere.png 2>said
    cat said
    [ ! -s said ]
    [ "$(head -c 4 sphere.png | tail -c 3)" = PNG ]
}
