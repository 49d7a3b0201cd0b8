# To be sourced by scripts that try conus in a Debian of its own. They set `results`, a folder for logs, and `fail`.
# shellcheck shell=bash disable=SC2154

# step NAME COMMAND...: what the command says goes to NAME.log; its last line says what came of it.
step() {
    local name=$1 begun=$SECONDS status log=$results/$1.log
    shift
    set +e
    (set -ex; "$@") >"$log" 2>&1 </dev/null
    status=$?
    set -e
    [ $status = 0 ] || fail "$name has failed: $(tail -n 1 "$log") (${log#"$PWD/"})"
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
