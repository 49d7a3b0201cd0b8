# Loaded by every file here. CONUS is the program under test; CTest sets it.
bats_require_minimum_version 1.5.0
: "${CONUS:?is the path of the conus program}"
TEMPLATES=${CONUS_TEMPLATES:-/usr/share/mricron/templates}

# It says whether there is OpenGL; scripts/check-docs asks it, too.
export CONUS_HAS_GL=${CONUS_HAS_GL:-${CONUS%/apps/cli/conus}/tests/has_gl}

# Seconds after which a hanging command is ended: nothing else takes so long, however busy the machine is.
HANG=900

# Otherwise mpirun's hwloc opens the X display :0, which may be that of another test, and ends with it.
export HWLOC_COMPONENTS=-gl
# Without /sys, as in a bare chroot, hwloc complains on stderr, which may be a pipe that a test has filled.
export HWLOC_HIDE_ERRORS=2

# A pipe that nobody writes to: waiting for it starts no process. It is made here, since that changes $!.
exec {never}<> <(:)

setup() {
    mkdir "$BATS_TEST_TMPDIR/work"
    cd "$BATS_TEST_TMPDIR/work" || return
}

teardown() {
    end_children
}

# background COMMAND...: starts it as process $child, which does not outlive the test.
background() {
    "$@" <&0 3>&- &
    child=$!
    children+=("$child")
}

end_children() {
    for child in "${children[@]}"; do
        ! runs "$child" || kill "$child" || true
        wait "$child" 2>/dev/null || true
    done
    children=()
}

# runs PID: whether the process runs, and is not only waiting to be reaped.
runs() {
    grep -q '^State:[[:space:]]*[^Z]' "/proc/$1/status" 2>/dev/null
}

# wait_until PID COMMAND...: repeats COMMAND until it succeeds; fails if process PID ends before.
wait_until() {
    local pid=$1 begun=$SECONDS
    shift
    until "$@"; do
        runs "$pid" || "$@" || { echo "process $pid ended before: $*"; return 1; }
        [ $((SECONDS - begun)) -lt $HANG ] || { echo "process $pid hangs before: $*"; return 1; }
        read -rt 0.04 -u "$never" || true
    done
}

# not COMMAND...: asserts that it fails. bats ignores a failing `! COMMAND` unless it comes last in a test.
not() {
    ! "$@"
}

# has_lines N FILE
has_lines() {
    [ -e "$2" ] && [ "$(wc -l <"$2")" -ge "$1" ]
}

# is_conus PID [PROGRAM]: whether the process has become that program.
is_conus() {
    local program=${2:-$CONUS}
    [ "$(cat "/proc/$1/comm")" = "${program##*/}" ]
}

# catches_signals PID [PROGRAM]: whether the process is conus and handles SIGINT and SIGTERM. Its name is asked first:
# before it is conus it is a bash, which handles both, too.
catches_signals() {
    local mask
    is_conus "$@" || return 1
    mask=$(sed -n 's/^SigCgt:[[:space:]]*/0x/p' "/proc/$1/status")
    [ $((mask >> 1 & mask >> 14 & 1)) -eq 1 ]
}

# fill_progress: makes the pipe progress, which stays full as long as file descriptor 6 is open.
fill_progress() {
    rm -f progress
    mkfifo progress
    exec 6<>progress
    ! dd if=/dev/zero of=progress bs=4096 oflag=nonblock 2>filled
}

# hold batch ARGUMENT...: starts it in the background, as process $pid, and stops it after its first block: it waits to
# write its progress into a pipe that is full.
hold() {
    fill_progress
    env --default-signal=INT "$CONUS" "$@" -q --progress json 2>progress 3>&- 6>&- &
    pid=$!
}

# let_go CODE: lets the stopped process run to its end, with this exit code; its messages are in the file said.
let_go() {
    local code=0
    exec 7<progress 6>&-
    tr -d '\0' <&7 >said
    exec 7<&-
    wait "$pid" || code=$?
    [ "$code" -eq "$1" ] || { echo "ended with $code"; return 1; }
}

# took_signal PID: whether no signal is pending for it, or it has ended.
took_signal() {
    ! runs "$1" || grep -qs '^ShdPnd:[[:space:]]*0*$' "/proc/$1/status"
}

# stop_held SIGNAL CODE: sends the signal to the stopped process, which must end with this exit code.
stop_held() {
    kill "-$1" "$pid"
    wait_until "$pid" took_signal "$pid"
    let_go "$2"
}

# waits_to_write PID: whether a thread of the process is in a call of the system about its stderr.
waits_to_write() {
    grep -qsE '^[0-9]+ 0x2 ' "/proc/$1"/task/*/syscall
}

# wait_for_block: waits until process $pid, which hold started, has answered its first block.
wait_for_block() {
    wait_until "$pid" waits_to_write "$pid"
}

# free_port: prints a port on which nobody listens and from which no connection starts by itself.
free_port() {
    /usr/bin/python3 - <<'END'
import random, socket
while True:
    port = random.SystemRandom().randrange(10000, 32000)
    try:
        socket.socket().bind(("", port))
    except OSError:
        continue
    print(port)
    break
END
}

# listens PORT: whether a process of this machine listens on it.
listens() {
    grep -qsE "^ *[0-9]+: [0-9A-F]+:$(printf %04X "$1") [0-9A-F]+:0000 0A " /proc/net/tcp /proc/net/tcp6
}

conus() {
    "$CONUS" "$@"
}

# fails CODE TEXT ARGUMENT...: asserts that conus ends with CODE, prints one line with TEXT on stderr, and nothing on
# stdout.
fails() {
    local code=$1 text=$2
    shift 2
    run -"$code" --separate-stderr "$CONUS" "$@"
    check_message "$text"
    [ -z "$output" ] || { echo "unexpected output: $output"; return 1; }
}

# drop_question: takes the line in which a batch says what it asks off the last run's messages; with "warnings" these,
# too, which a test of something else need not know.
drop_question() {
    local line kept=()
    for line in "${stderr_lines[@]}"; do
        [[ "$line" == "conus: note: "*"; "*" rays" || (-n "${1-}" && "$line" == "conus: warning: "*) ]] || kept+=("$line")
    done
    [ "${#kept[@]}" -eq "${#stderr_lines[@]}" ] || {
        stderr_lines=("${kept[@]}")
        stderr=
        [ "${#kept[@]}" -eq 0 ] || stderr=$(printf '%s\n' "${kept[@]}")
    }
}

# check_message TEXT: asserts that the last run's messages are one line, "conus: ..." with TEXT in it, beside warnings
# unless TEXT is one.
check_message() {
    local warnings=warnings
    [[ "$1" != *warning:* ]] || warnings=
    # shellcheck disable=SC2154 # bats sets stderr and stderr_lines
    drop_question $warnings
    [ "${#stderr_lines[@]}" -eq 1 ] || { echo "not one line: $stderr"; return 1; }
    [[ "$stderr" == "conus: "*"$1"* ]] || { echo "said: $stderr"; echo "wanted: $1"; return 1; }
}

# answers ARGUMENT...: asserts that conus succeeds and prints nothing on stderr, but what a batch asks and, with --quiet,
# warnings, which stay then.
answers() {
    local warnings=
    [[ " $* " != *" -q "* && " $* " != *" --quiet "* ]] || warnings=warnings
    run --separate-stderr "$CONUS" "$@"
    drop_question $warnings
    [ "$status" -eq 0 ] && [ -z "$stderr" ] || { echo "exit code $status, said: $stderr"; return 1; }
}

# lacks_gl: whether there is no OpenGL 4.5. Exit code 4 says less: a driver may refuse a shader.
lacks_gl() {
    local code=0
    without_gl=$("$CONUS_HAS_GL") || code=$?
    [ $code -eq 77 ]
}

# need_gl: skips the test where there is no OpenGL 4.5.
need_gl() {
    ! lacks_gl || skip "$without_gl"
}

# gl ARGUMENT...: answers, or skips the test without OpenGL.
gl() {
    run --separate-stderr "$CONUS" "$@"
    [ "$status" -ne 4 ] || need_gl
    drop_question warnings
    [ "$status" -eq 0 ] && [ -z "$stderr" ] || { echo "said: $stderr"; return 1; }
}

# has TEXT: asserts that the last run printed TEXT.
has() {
    [[ "$output" == *"$1"* ]] || { echo "wrote: $output"; echo "wanted: $1"; return 1; }
}

# nothing_left FILE...: asserts that only these files are here.
nothing_left() {
    local found wanted
    found=$(find . -type f | sort)
    wanted=$(printf './%s\n' "$@" | sort)
    [ "$#" -gt 0 ] || wanted=
    [ "$found" = "$wanted" ] || { echo "files: $found"; return 1; }
}

# cell NAME ROW: that column of a row (from 1) of the TSV in $output.
cell() {
    awk -F'\t' -v name="$1" -v row="$2" \
        'NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) column = i } NR == row + 1 { print $column }' <<<"$output"
}

# need_aal: aal is the path of the AAL atlas; skips the test without it.
need_aal() {
    aal=$TEMPLATES/aal.nii.gz
    [ -r "$aal" ] || skip "no mricron-data ($aal)"
}

# need_pixels: skips the test without Python's OpenImageIO. Looking for it takes a tenth of the time of loading it.
need_pixels() {
    /usr/bin/python3 -c 'import importlib.util, sys; sys.exit(not importlib.util.find_spec("OpenImageIO"))' ||
        skip "no python3-openimageio"
}

# need_all: only scripts/test --all runs the test.
need_all() {
    [ -n "${CONUS_TEST_ALL-}" ] || skip "scripts/test --all runs it"
}

# need_long: only scripts/test --long runs the test.
need_long() {
    [ -n "${CONUS_TEST_LONG-}" ] || skip "scripts/test --long runs it"
}

# sphere [OPTION...]: sphere.nii.gz, a ball of radius 20 mm around the origin.
sphere() {
    conus phantom sphere -o . "$@"
}

# start_screen WxH: starts a display without a screen for the tests of a file, if there is Xvfb. The display does not
# restart when its last window closes: a window that opens meanwhile would find no display.
start_screen() {
    command -v Xvfb >/dev/null || return 0
    Xvfb -displayfd 3 -screen 0 "$1x24" -noreset -nolisten tcp 3>"$BATS_FILE_TMPDIR/display" 2>/dev/null &
    echo $! >"$BATS_FILE_TMPDIR/screen"
    wait_until $! test -s "$BATS_FILE_TMPDIR/display"
    DISPLAY=:$(cat "$BATS_FILE_TMPDIR/display")
    export DISPLAY
}

stop_screen() {
    [ ! -f "$BATS_FILE_TMPDIR/screen" ] || kill "$(cat "$BATS_FILE_TMPDIR/screen")"
}

# need_window: skips the test if no window can be opened.
need_window() {
    [ -x "${CONUS%/*}/conus-view" ] || skip "conus-view is not built"
    [ -f "$BATS_FILE_TMPDIR/screen" ] || skip "no Xvfb"
}

# positions_of_a_scan PHANTOM: mni.nii, the phantom in MNI's space (code 4), and scan.txt, a target in somebody's scan, as
# Brainsight says.
positions_of_a_scan() {
    python3 - "$1" <<'EOF'
import gzip, struct, sys
volume = bytearray(gzip.decompress(open(sys.argv[1], "rb").read()))
struct.pack_into("<2h", volume, 252, 4, 4)
open("mni.nii", "wb").write(volume)
EOF
    { printf '# Version: 13\n# Coordinate system: NIfTI:Scanner\n# Target Name\tLoc. X\tLoc. Y\tLoc. Z'
      printf '\tm0n0\tm0n1\tm0n2\tm1n0\tm1n1\tm1n2\tm2n0\tm2n1\tm2n2\n'
      printf 'T\t0\t0\t5\t1\t0\t0\t0\t1\t0\t0\t0\t1\n'; } >scan.txt
}

# starts_once COMMAND ARGUMENT...: asserts that conus answers and starts conus-hdf5 once. conus-hdf5 may write no file,
# so each start makes a folder.
starts_once() {
    rm -rf starts
    mkdir starts
    printf '#!/bin/sh\nmkdir "%s/$$"\nexec "%s" "$@"\n' "$PWD/starts" "${CONUS_HDF5:-${CONUS%/*}/conus-hdf5}" >counting
    chmod +x counting
    CONUS_HDF5=$PWD/counting "$CONUS" "$@" -q >/dev/null || return 1
    [ "$(ls starts | wc -l)" -eq 1 ] || { echo "started $(ls starts | wc -l) times"; return 1; }
}
