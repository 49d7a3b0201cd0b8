#!/usr/bin/env bats
# Trackers that speak OpenIGTLink: conus against the example programs of the protocol's own library.
load helpers

EXAMPLES=/usr/share/doc/openigtlink-examples/examples

setup_file() {
    [ -d "$EXAMPLES" ] && [ -d /usr/include/openigtlink ] && command -v g++ >/dev/null || return 0
    for program in Tracker/TrackerClient Tracker/TrackerServer TrackingData/TrackingDataServer \
        QuaternionTrackingData/QuaternionTrackingDataServer Receiver/ReceiveServer; do
        g++ -I/usr/include/openigtlink "$EXAMPLES/$program.cxx" -o "$BATS_FILE_TMPDIR/${program##*/}" -lOpenIGTLink
    done
}

# example NAME ARGUMENT...: starts one of them, or skips the test.
example() {
    local name=$1
    shift
    [ -x "$BATS_FILE_TMPDIR/$name" ] || skip "no openigtlink-examples"
    background timeout $HANG "$BATS_FILE_TMPDIR/$name" "$@" >"$name.out" 2>&1
    peer=$child
}

end_peer() {
    kill "$peer" 2>/dev/null || true
    wait "$peer" 2>/dev/null || true
}

# start_track OPTION...: starts conus track in the background, process $track, and waits until a signal would end it
# and, if the first option is --listen PORT, until it accepts connections.
start_track() {
    background env --default-signal=INT "$CONUS" track sphere.nii.gz "$@" >steps.tsv
    track=$child
    wait_until "$track" catches_signals "$track"
    [ "$1" != --listen ] || wait_until "$track" listens "$2"
}

end_track() {
    kill -INT "$track"
    wait "$track"
}

# followed: steps.tsv has more than five steps, each with its time after the one before.
followed() {
    awk -F'\t' 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == "time_s") t = i; next }
        { if ($t < last) exit 1; last = $t; n++ } END { exit !(n > 5) }' steps.tsv
}

@test "the protocol's own client drives conus track" {
    sphere
    port=$(free_port)
    start_track --listen "$port" --selected --format tsv --quiet
    example TrackerClient 127.0.0.1 "$port" 30
    wait_until "$peer" has_lines 8 steps.tsv
    end_track
    end_peer
    followed
}

@test "conus track asks the protocol's own servers" {
    sphere
    for server in TrackerServer TrackingDataServer QuaternionTrackingDataServer; do
        port=$(free_port)
        case $server in
        TrackerServer) example $server "$port" 30 ;;
        *) example $server "$port" ;;
        esac
        start_track --connect "127.0.0.1:$port" --selected --format tsv --quiet
        wait_until "$peer" has_lines 8 steps.tsv
        end_track
        end_peer
        followed || { echo "$server"; cat steps.tsv "$server.out"; return 1; }
    done
}

@test "what was selected arrives at the protocol's own receiver" {
    sphere
    port=$(free_port)
    cat >send.py <<'END'
# A tracker that points at the sphere, and forwards what it receives to the protocol's own receiver.
import select, socket, struct, sys
from openigtlink import transform
conus = socket.create_connection(("127.0.0.1", int(sys.argv[1])))
receiver = socket.create_connection(("127.0.0.1", int(sys.argv[2])))
received = b""
passed_on = set()
while not passed_on >= {b"STRING", b"POINT"}:
    conus.sendall(transform(b"Pointer", 0, 0, 90))
    while select.select([conus], [], [], 0.02)[0]:
        received += conus.recv(65536)
    while len(received) >= 58 and len(received) >= 58 + struct.unpack(">Q", received[42:50])[0]: # whole messages
        size = 58 + struct.unpack(">Q", received[42:50])[0]
        receiver.sendall(received[:size])
        passed_on.add(received[2:14].rstrip(b"\0"))
        received = received[size:]
receiver.close()
END
    other=$(free_port)
    example ReceiveServer "$other"
    wait_until "$peer" listens "$other"
    start_track --listen "$port" --quiet --format tsv
    timeout $HANG env PYTHONPATH="$BATS_TEST_DIRNAME" /usr/bin/python3 -B send.py "$port" "$other"
    for word in STRING Sphere POINT; do
        wait_until "$peer" grep -aq "$word" ReceiveServer.out
    done
    end_track
    end_peer
}

@test "what does not go together is said" {
    sphere --size 16
    fails 2 'no poses: --poses FILE, or a tracker' track sphere.nii.gz
    fails 2 'from a file or from a tracker, not from both' track sphere.nii.gz --poses x.tsv --listen 18944
    fails 2 '--tool needs --listen or --connect' track sphere.nii.gz --poses x.tsv --tool Pointer
    fails 2 'is no address and port' track sphere.nii.gz --listen 0
    fails 2 'is no address and port' track sphere.nii.gz --listen 70000
    fails 2 'is no address and port' track sphere.nii.gz --connect here:there
    fails 2 '--connect: ":18944" is no address and port' track sphere.nii.gz --connect :18944
    fails 3 'is no IPv4 address to wait on' track sphere.nii.gz --listen nowhere:18944 --seconds 1
    fails 3 'none.txt' track sphere.nii.gz --listen 18944 --world-from-tracker none.txt
}

@test "Ctrl-C ends it in order" {
    sphere --size 16
    port=$(free_port)
    for signal in INT TERM; do
        start_track --listen "$port" -o $signal.tsv --quiet
        kill -$signal "$track"
        wait "$track"
        head -1 $signal.tsv | grep -q time_s
    done
}

@test "--seconds ends it without a signal" {
    sphere --size 16
    port=$(free_port)
    answers track sphere.nii.gz --listen "$port" --seconds 0.2 -o steps.tsv --quiet
    [ "$(wc -l <steps.tsv)" -eq 1 ]
}
