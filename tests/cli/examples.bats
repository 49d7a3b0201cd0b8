#!/usr/bin/env bats
# The examples of the C interface that need files; ctest runs the others by themselves.
load helpers
: "${CONUS_EXAMPLES:?is the folder of the examples}"

# A ball of radius 20 mm in voxels of 2 mm: those at the axis have centres at z = 19 mm and end at z = 20 mm. From
# z = 90 mm a ray near the axis first hits them after 70 mm, from x = -60 mm after 40 mm.
ball() {
    sphere --size 32 --spacing 2,2,2
}

# answers_are LINE...: the file said has these lines, with any number of milliseconds.
answers_are() {
    sed -E 's/ [0-9]+\.[0-9]{3} ms$/ T ms/' said | diff <(printf '%s\n' "$@") -
}

@test "the example of docs/api.md is C99" {
    root=$BATS_TEST_DIRNAME/../..
    {
        printf '#include <conus/conus.h>\n#include <stdio.h>\nint main(void)\n{\n'
        awk '/^```$/ && on { exit } on { print } /^```c$/ { on = 1 }' "$root/docs/api.md"
        printf 'return 0;\n}\n'
    } >example.c
    grep -q conus_select example.c
    cc -std=c99 -Wall -Werror -fsyntax-only -I "$root/include" example.c
}

@test "the example of poses by the million is C99 without a warning" {
    root=$BATS_TEST_DIRNAME/../..
    awk '/^## / { here = /^## Poses by the million$/ } /^```$/ { on = 0 } here && on { print }
         here && /^```c$/ { on = 1; if (blocks++) print declarations } END { print "return (int)status;\n}" }' \
        declarations='int main(void) { static double origins[100000][3], directions[100000][3];
        conus_selector *selector = NULL; conus_status status;' "$root/docs/api.md" >example.c
    grep -q conus_select_many example.c
    cc -std=c99 -Wall -Werror -fsyntax-only -include stdbool.h -include conus/conus.h -I "$root/include" example.c
}

@test "live_pose answers each pose when it comes" {
    ball
    mkfifo poses
    "$CONUS_EXAMPLES/live_pose" sphere.nii.gz <poses >said 2>errors 3>&- &
    local pid=$!
    children+=("$pid")
    exec 6>poses
    printf 'x\ty\tz\ttx\tty\ttz\n0\t0\t90\t0\t0\t0\n' >&6
    wait_until "$pid" has_lines 1 said
    answers_are 'Sphere at 70.0 mm, T ms'
    printf '%s\t0\t0\t%s\t0\t0\n' -60 0 0 0 60 90 >&6 # towards the ball; no direction; away from it
    wait_until "$pid" has_lines 3 said
    exec 6>&-
    wait "$pid"
    answers_are 'Sphere at 70.0 mm, T ms' 'Sphere at 40.0 mm, T ms' 'nothing, T ms'
    [ "$(wc -l <errors)" -eq 1 ]
    grep -q '^line 4: ' errors
}

@test "live_pose takes a cone's angle from the table, and refuses points" {
    ball
    # From 90 mm, 40 mm beside the ball's middle and parallel to it: only a wide cone hits it.
    printf 'x\ty\tz\tdx\tdy\tdz\tangle\n40\t0\t90\t0\t0\t-1\t5\n40\t0\t90\t0\t0\t-1\t60\n' |
        "$CONUS_EXAMPLES/live_pose" sphere.nii.gz >said
    sed -i -E 's/ at [0-9.]+ mm/ at D mm/' said
    answers_are 'nothing, T ms' 'Sphere at D mm, T ms'
    printf '1 2 3\n' | "$CONUS_EXAMPLES/live_pose" sphere.nii.gz >said 2>errors
    [ ! -s said ]
    [ "$(cat errors)" = 'line 1: a point has no direction' ]
}

@test "live_pose says what is wrong with the atlas or the poses" {
    ball
    run -1 --separate-stderr "$CONUS_EXAMPLES/live_pose" none.nii.gz </dev/null
    [[ "$stderr" == 'none.nii.gz: '* ]]
    run -1 --separate-stderr "$CONUS_EXAMPLES/live_pose" sphere.nii.gz <<<'no poses'
    [ -z "$output" ] && [ "${#stderr_lines[@]}" -eq 1 ]
}

@test "render_to_memory writes the PNG that conus render writes" {
    ball
    unset DISPLAY WAYLAND_DISPLAY
    gl render sphere.nii.gz -o wanted.png --size 320x240
    run -0 --separate-stderr "$CONUS_EXAMPLES/render_to_memory" sphere.nii.gz picture.png
    [[ "$output" == "320 x 240 pixels, $(stat -c %s picture.png) bytes, drawn by "?* ]] || { echo "$output"; return 1; }
    cmp picture.png wanted.png
    [ "$(head -c 8 picture.png | od -An -tx1 | tr -d ' ')" = 89504e470d0a1a0a ]
    run -1 "$CONUS_EXAMPLES/render_to_memory" sphere.nii.gz no/such/folder.png
}

# The same poses in a file, asked by the program: the best row of each, and its distance.
@test "thousand_poses prints the column of conus batch, and is C++17, too" {
    ball
    run -0 --separate-stderr "$CONUS_EXAMPLES/thousand_poses" sphere.nii.gz
    [ -z "$stderr" ]
    echo "$output" >said
    awk 'BEGIN { print "x\ty\tz\ttx\tty\ttz"; for (i = 0; i < 1000; i++) {
        t = i * 6.283185307179586 / 1000; printf "%.17g\t%.17g\t0\t0\t0\t0\n", 100 * cos(t), 100 * sin(t) } }' >poses.tsv
    conus batch sphere.nii.gz --poses poses.tsv -q -o rows.tsv
    awk -F'\t' 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i }
        $at["rank"] == 1 { printf "%.2f\n", $at["distance_mm"] }' rows.tsv >wanted
    [ "$(wc -l <wanted)" -eq 1000 ]
    cmp said wanted
    run -1 --separate-stderr "$CONUS_EXAMPLES/thousand_poses" none.nii.gz
    [ -z "$output" ] && [[ "$stderr" == 'none.nii.gz: '* ]]
    c++ -std=c++17 -Wall -Werror -fsyntax-only -x c++ -I "$BATS_TEST_DIRNAME/../../include" \
        "$BATS_TEST_DIRNAME/../../examples/thousand_poses.c"
}

# The deepest voxels at the axis of a cone from z = 60 mm are the nearest to it: sqrt(2) mm beside it, at z = -19 mm.
@test "sweep_table prints two columns, and is C++17, too" {
    ball
    run -0 --separate-stderr "$CONUS_EXAMPLES/sweep_table" sphere.nii.gz
    [ "$output" = "$(awk 'BEGIN { printf "Sphere: %.3f", 2 * atan2(sqrt(2), 79) * 45 / atan2(1, 1) }')" ]
    [ -z "$stderr" ]
    run -1 --separate-stderr "$CONUS_EXAMPLES/sweep_table" none.nii.gz
    [ -z "$output" ] && [[ "$stderr" == 'none.nii.gz: '* ]]
    c++ -std=c++17 -Wall -Werror -fsyntax-only -x c++ -I "$BATS_TEST_DIRNAME/../../include" \
        "$BATS_TEST_DIRNAME/../../examples/sweep_table.c"
}
