#!/usr/bin/env bats
# conus-bench as a user types it: everything small, for its answers and its JSON, and never for its times.
load helpers

bench() {
    "${CONUS_BENCH:?is the path of conus-bench}" "$@"
}

@test "all --check: every scenario's answers are equal, and the JSON says everything" {
    run -0 --separate-stderr bench all --check --json all.json
    [[ "$stderr" == *"volume"* ]]
    not grep -q "check:" <<<"$stderr"
    for key in version machine versions load_start load_end settings runs ratios holds left_out; do
        jq -e "has(\"$key\")" all.json
    done
    jq -e '.settings.check and (.versions | has("embree") and has("gl") and has("vtk") and has("compiler") and has("kernel"))' \
        all.json
    jq -e '[.runs[] | has("scenario") and has("variant") and has("count") and has("angle_deg") and has("median_ms")
        and has("min_ms") and has("p90_ms") and has("repeats") and has("equal")] | all' all.json
    jq -e '[.runs[] | .equal or .other_by_design] | all' all.json
    jq -e '[.ratios[] | type == "number"] | all' all.json
    # With OpenGL and VTK only scenarios that draw to a display may be left out, and Python, which lacks the sanitizers'
    # runtime. The test bench.python covers that one.
    jq -e '(.versions.gl | startswith("none")) or .versions.vtk == "none" or
        ([.left_out | keys[] | test("^(vtk|peers_|the Python package)")] | all)' all.json
    # Every scenario of the help was run or is reported as left out.
    bench --help | sed -n '/^scenarios:/,/^$/p' | awk 'NR > 1 && NF { print $1 }' | grep -vx all >names
    [ "$(wc -l <names)" -ge 9 ]
    while read -r name; do
        jq -e --arg name "$name" '(.settings.scenarios | has($name)) or (.left_out | has($name))' all.json
    done <names
}

@test "scenarios that cannot run are left out with the reason, and the others go on" {
    need_long
    run -0 --separate-stderr env MESA_LOADER_DRIVER_OVERRIDE=none EGL_PLATFORM=none \
        __EGL_VENDOR_LIBRARY_DIRS=/nonexistent "$CONUS_BENCH" all --check --json all.json
    jq -e '.left_out | has("bonsai") and has("torus_frame") and has("torus by OpenGL")' all.json
    jq -e '.settings.scenarios | has("volume") and has("torus") and has("batch") and (has("torus_frame") | not)' all.json
    jq -e '.ratios | has("rays_200k_over_1k") and (has("naive_over_rays") | not)' all.json
    jq -e '.versions.gl_renderer | startswith("none")' all.json
}

@test "one scenario by itself has the same JSON" {
    run -0 bench volume --check --poses 3 --repeats 2 --json one.json
    [[ "$output" == *"dda_over_simd = "* ]]
    jq -e '.settings.scenarios.volume | .poses == 3 and .repeats == 2 and .clock == "CPU time of one thread"' one.json
    jq -e '.runs[0] | .count == 3 and .repeats == 2 and .scenario == "volume"' one.json
}

@test "growth: every curve has its points, slopes and exponent" {
    run -0 bench growth --check --json growth.json
    jq -e '[.runs[] | .curve] | unique == ["angle_tori", "objects", "objects_own", "voxels", "voxels_layers", "voxels_open"]' growth.json
    # An exponent of two points is their slope; a curve's lies between its least and its greatest.
    jq -e '.ratios as $ratios | [.runs | group_by(.curve)[] | . as $points | [$points[1:][] | .slope]
        | length >= 2 and $ratios["growth_\($points[0].curve)"] >= min - 1e-4 and $ratios["growth_\($points[0].curve)"] <= max + 1e-4] | all' growth.json
    jq -e '[.runs[] | .equal] | all' growth.json
}

@test "command lines as people mistype them" {
    for wrong in "" "volumes" "volume batch" "volume --poses 0" "volume --angle 180" "volume --seconds -1" \
        "volume --angles 5" "volume --json"; do
        # shellcheck disable=SC2086 # words
        run -2 --separate-stderr bench $wrong
        [ "${#stderr_lines[@]}" -eq 1 ]
        [[ "$stderr" == "conus-bench: "* ]]
    done
    run -3 --separate-stderr bench volume --atlas missing.nii.gz
    [[ "$stderr" == "conus-bench: "*"missing.nii.gz"* ]]
}

@test "figures and tables of a JSON" {
    local scripts=$BATS_TEST_DIRNAME/../../scripts
    jq -n '{version: "0", machine: "m", load_start: 1, load_end: 2, settings: {check: false, scenarios: {}},
        versions: {gl: "g", gl_renderer: "r", embree: "3", vtk: "none", compiler: "c", build: "b", kernel: "k"},
        ratios: {naive_over_gl: 30, dda_over_simd: null, dda_over_simd_null_because: "the answers differ"},
        holds: {naive_over_gl: {at_least: 25, met: true}}, left_out: {colour: "no file"},
        runs: [("colour frame", "all drawn, in a frame", "gl engine") as $what | (1000, 20000) as $tori
            | {scenario: "torus_frame", variant: "\($tori) tori, \($what)", count: 1, angle_deg: 5, median_ms: 0.5, min_ms: 0.25,
               equal: true, other_by_design: false}]}' >some.json
    run -0 "$scripts/bench-tables" some.json
    [[ "$output" == *'| `naive_over_gl` | 30 | ≥ 25 | met |'* ]]
    [[ "$output" == *'| `dda_over_simd` | the answers differ |  |  |'* ]]
    [[ "$output" == *"Left out: colour: no file"* ]]
    [[ "$output" == *"| 1000 tori, gl engine | 500 µs (250 µs) |"* ]]
    jq '.ratios.growth_objects = 0.5 | .runs = [(100, 10000) as $x | {scenario: "growth", curve: "objects", variant: "objects, \($x)",
        x: $x, angle_deg: 5, median_ms: ($x | sqrt), min_ms: 1, slope: 0.5, equal: true}]' some.json >growth.json
    run -0 "$scripts/bench-tables" growth.json growth
    [[ "$output" == *'| `objects` | 100: 10 ms (1 ms) | 1e4: 100 ms (1 ms) | 0.5 | 0.5 to 1e4 |'* ]]
    command -v gnuplot >/dev/null || skip "there is no gnuplot"
    run -0 "$scripts/bench-figures" some.json figures
    for name in torus share objects; do
        grep -q "</svg>" "figures/bench-$name.svg"
    done
    [[ "$output" == *"bench-bonsai.svg: left out, nothing was measured"* ]]
    [ ! -e figures/bench-bonsai.svg ]
    [[ "$output" == *"bench-growth.svg: left out, nothing was measured"* ]]
    run -0 "$scripts/bench-figures" growth.json figures
    grep -q "Objects (tori)" figures/bench-growth.svg
    not grep -q "Streamlines" figures/bench-growth.svg
    jq '.settings.check = true' some.json >check.json
    run -1 "$scripts/bench-figures" check.json figures
    [[ "$output" == *"is of a check"* ]]
}
