#!/usr/bin/env bats
# Two tools in the window: of one tracker, each of its own tracker, and moved by keys.
load helpers
load window

# track PORT NAME X Y Z [NAME X Y Z]: starts a tracker that sees upright tools there until the window ends; $child
# stays.
track() {
    local view=$child
    background env PYTHONPATH="$BATS_TEST_DIRNAME" /usr/bin/python3 -B - "$@" 4>&- <<'END_OF_TRACKER'
import socket, sys, time
from openigtlink import transform
conus = socket.create_connection(("127.0.0.1", int(sys.argv[1])))
words = sys.argv[2:]
poses = b"".join(transform(words[i].encode(), *map(float, words[i + 1:i + 4])) for i in range(0, len(words), 4))
try:
    while True:
        conus.sendall(poses)
        time.sleep(0.02)
except OSError:
    pass
END_OF_TRACKER
    child=$view
}

# is_query FILE X Y Z OPTION...: asserts that FILE is the answer of conus query for an upright tool there.
is_query() {
    printf '1 0 0 %s\n0 1 0 %s\n0 0 1 %s\n0 0 0 1\n' "$2" "$3" "$4" >pose.txt
    conus query nested.nii.gz --pose pose.txt "${@:5}" --format tsv --quiet | diff "$1" -
}

@test "two tools of one tracker have a cone and a list each, and keys of their own" {
    need_window
    conus phantom nested -o .
    port=$(free_port)
    live nested.nii.gz --listen "$port" --second-tool Left
    track "$port" LeftToTracker -4 5 80 RightToTracker 9 2 90
    until look '.second.has_pose and .has_pose == true'; do
        runs "$child"
    done
    look '.second.on and .second.world_from_device[12:15] == [-4, 5, 80] and .world_from_device[12:15] == [9, 2, 90]'
    tell 'key 6' 'key 6' 'results right.tsv' 'second results left.tsv' 'save wide.json' 'key 4' 'save held.json' \
        'key 3' 'save other.json' 'key 7' 'key 2'
    look '.device_speed == 32 and (.second.on | not)'
    leave
    jq -e '.second.angle_deg > 6.04 and .second.angle_deg < 6.06 and .angle_deg == 5' wide.json # 5 times 1.1 squared
    jq -e '.second.held' held.json
    jq -e '.second.pointer == "spacemouse" and (.second.held | not)' other.json
    is_query right.tsv 9 2 90 --angle 5
    is_query left.tsv -4 5 80 --angle 6.05
}

@test "a tool that stands still leaves the picture fine" {
    need_window
    conus phantom nested -o .
    port=$(free_port)
    live nested.nii.gz --listen "$port"
    track "$port" RightToTracker 9 2 90
    until look '.has_pose == true'; do
        runs "$child"
    done
    tell settle 'results fine.tsv' # which it waits for as long as the pictures are coarse
    wait_until "$child" test -e fine.tsv
    leave
    is_query fine.tsv 9 2 90 --angle 5
}

@test "the second tool has a tracker of its own, elsewhere, and the mouse the first" {
    need_window
    conus phantom nested -o .
    port=$(free_port)
    printf '%s\n' '1 0 0 0' '0 1 0 -1' '0 0 1 10' '0 0 0 1' >world.txt
    live nested.nii.gz --second-listen "$port" --second-world-from-tracker world.txt
    track "$port" Any -4 5 70
    until look '.second.has_pose'; do
        runs "$child"
    done
    tell 'second results second.tsv'
    look '.pointer == "mouse" and .has_pose == false and .second.pointer == "tracker" and .second.world_from_device[12:15] == [-4, 4, 80]'
    is_query second.tsv -4 4 80 --angle 5
    leave
}
