#!/usr/bin/env bats
# Several atlases in one query: query, sweep, track, batch and diff with --atlas.
load helpers

# atlases: two phantoms in one space, ball.nii.gz and slabs.nii.gz, and poses.tsv that point at both; one row is no
# pose.
atlases() {
    conus phantom sphere -o . --size 24 --spacing 3,3,3
    conus phantom slabs -o . --size 16
    mv sphere.nii.gz ball.nii.gz
    mv sphere.tsv ball.tsv
    awk -v n="${1:-12}" 'BEGIN {
        print "query_id\tx\ty\tz\ttx\tty\ttz"
        for (i = 0; i < n; i++)
            printf "p%d\t%.3f\t%.3f\t%.3f\t%s\t%.3f\t0\n", i, 90 * cos(i), 90 * sin(i), i % 60 - 30, i == 4 ? "x" : i % 3 * 9, i % 7
    }' >poses.tsv
}

# put_together NAME FILE NAME FILE...: for each query of the first TSV its rows in each file, with a column for the
# name. It relies only on the rows of a query being together in a file.
put_together() {
    local arguments=()
    while [ $# -gt 0 ]; do
        arguments+=("atlas=$1" "$2")
        shift 2
    done
    awk -F '\t' -v OFS='\t' '
        function with(cell) { sub(/\t/, "\t" cell "\t"); return $0 }
        FNR == 1 { files++; name[files] = atlas; if (files == 1) print with("atlas"); next }
        !($1 in seen) { seen[$1]; order[++queries] = $1 }
        { id = $1; rows[id, files] = rows[id, files] with(atlas) "\n" }
        END { for (q = 1; q <= queries; q++) for (f = 1; f <= files; f++) printf "%s", rows[order[q], f] }
    ' "${arguments[@]}"
}

# same_rows COMMAND ARGUMENT...: asserts that the rows of `conus COMMAND ball --atlas slabs` are those of each, put
# together.
same_rows() {
    local command=$1
    shift
    conus "$command" ball.nii.gz "$@" --format tsv >ball.rows 2>ball.said || [ $? -eq 1 ]
    conus "$command" slabs.nii.gz "$@" --format tsv >slabs.rows 2>slabs.said || [ $? -eq 1 ]
    conus "$command" ball.nii.gz --atlas slabs.nii.gz "$@" --format tsv >both.rows 2>both.said || [ $? -eq 1 ]
    [ "$(wc -l <ball.rows)" -gt 1 ] && [ "$(wc -l <slabs.rows)" -gt 1 ]
    put_together ball ball.rows slabs slabs.rows | diff - both.rows
}

@test "the rows are those of each atlas: query" {
    atlases
    same_rows query --pose poses.tsv --angle 15
    [ "$(grep -c 'line 6: ' both.rows)" -eq 2 ] # of each atlas
    [ "$(grep -c 'poses.tsv:6: ' both.said)" -eq 1 ]
    same_rows query --origin 0,0,90 --toward 0,0,0 --layers all --space lps
    same_rows query --point 1,2,3 --radius 9
    same_rows query --pose poses.tsv --radius 2 --score centre
}

@test "the rows are those of each atlas: sweep" {
    atlases 5
    same_rows sweep --pose poses.tsv --angle 40
    same_rows sweep --pose poses.tsv --jitter 2,1 --samples 16
    same_rows sweep --pose poses.tsv --angles 7,9,30
}

@test "the rows are those of each atlas: track" {
    atlases
    {
        printf 'time_s\tx\ty\tz\ttx\tty\ttz\ttrigger\n'
        for i in 0 1 2 3 4 5; do
            printf '%s\t0\t0\t90\t%s\t0\t0\t%s\n' "0.$i" "$((i * 9))" "$((i == 4))"
        done
    } >hand.tsv
    same_rows track --poses hand.tsv --score intenselect
    same_rows track --poses hand.tsv --selected
    conus track ball.nii.gz --atlas slabs.nii.gz --poses hand.tsv -o steps.tsv
    conus track ball.nii.gz --atlas slabs.nii.gz --poses - --format tsv <hand.tsv | cmp - steps.tsv
    answers track ball.nii.gz --atlas slabs.nii.gz --poses hand.tsv
    [[ "${lines[1]}" =~ ^\ *time\ \ atlas\ \ rank\ \ name ]]
    [[ "${lines[3]}" =~ ^\ *0.000\ \ ball\ \ \ \ \ \ 1\ \ Sphere ]]
}

@test "a batch writes the rows of query, whatever the threads, blocks, parts and formats" {
    atlases 60
    both=(ball.nii.gz --atlas slabs.nii.gz --poses poses.tsv --angle 15)
    conus query ball.nii.gz --atlas slabs.nii.gz --pose poses.tsv --angle 15 -o query.tsv 2>said || [ $? -eq 1 ]
    for settings in "1 1" "2 7" "3 256"; do
        run -1 conus batch "${both[@]}" --threads "${settings% *}" --block "${settings#* }" -o rows.tsv --force
        cmp query.tsv rows.tsv
    done
    for format in tsv csv ndjson; do
        run -1 conus batch "${both[@]}" -o "rows.$format" --force
        for part in 1/3 all/3; do
            conus batch "${both[@]}" --shard $part -o "joined.$format" || [ $? -eq 1 ]
        done
        cmp "rows.$format" "joined.$format"
        rm -f ./*.json
    done
    run -1 conus batch "${both[@]}" --summary -o summary.tsv
    [ "$(tail -n +2 summary.tsv | cut -f 1,2 | head -4 | tr '\n\t' ' /')" = "p0/ball p0/slabs p1/ball p1/slabs " ]
    [ "$(wc -l <summary.tsv)" -eq 121 ]
}

@test "a file and its parts are known by their atlases" {
    atlases 400
    both=(ball.nii.gz --atlas slabs.nii.gz --poses poses.tsv)
    run -1 conus batch "${both[@]}" -o rows.tsv
    run conus batch "${both[@]}" --shard 1/2 -o joined.tsv
    for how in "-o rows.tsv:2" "-o joined.tsv --shard 1/2:2" "-o joined.tsv --shard all/2:3"; do
        # shellcheck disable=SC2086 # words
        for atlases in ball.nii.gz "ball.nii.gz --atlas slabs.nii.gz --atlas ball.nii.gz" "slabs.nii.gz --atlas ball.nii.gz"; do
            fails ${how#*:} 'of other poses, atlases, settings' batch $atlases --poses poses.tsv -q ${how%:*}
        done
    done
    run -1 conus batch "${both[@]}" --threads 3 -o joined.tsv --shard all/2
    cmp rows.tsv joined.tsv
    diff <(grep -Ev 'CommandLine|Checksum' rows.json) <(grep -Ev 'CommandLine|Checksum' joined.json)
}

@test "what belongs to the answer names every atlas" {
    atlases 2
    conus query ball.nii.gz --atlas slabs.nii.gz --pose poses.tsv -o rows.tsv
    conus query ball.nii.gz --atlas slabs.nii.gz --pose poses.tsv -o rows.json.json --format json
    conus query ball.nii.gz --atlas slabs.nii.gz --pose poses.tsv --voxels voxels.tsv --voxels-of all -o table.txt
    for file in rows.json rows.json.json; do
        python3 - "$file" ball.nii.gz slabs.nii.gz <<'END'
import hashlib, json, sys
root = json.load(open(sys.argv[1]))
assert "Atlas" not in root and [atlas["name"] for atlas in root["Atlases"]] == ["ball", "slabs"], root.keys()
for atlas, path in zip(root["Atlases"], sys.argv[2:]):
    assert atlas["volumes"][0]["sha256"] == hashlib.sha256(open(path, "rb").read()).hexdigest()
assert "Description" in root.get("atlas", {"Description"}) and len(root.get("Queries", [1, 2])) == 2
END
    done
    # one array, in the order of the rows of the table
    python3 -c 'import json; [print(row["query"], row["atlas"], row["kind"], sep="\t") for row in
        json.load(open("rows.json.json"))["Rows"]]' | diff <(tail -n +2 rows.tsv | cut -f 1-3) -
    for atlas in ball slabs; do
        conus query "$atlas.nii.gz" --pose poses.tsv --voxels "$atlas.voxels.tsv" --voxels-of all --format tsv >rows
    done
    put_together ball ball.voxels.tsv slabs slabs.voxels.tsv | diff - voxels.tsv
    [ "$(grep -c '^query p[01]: cone of ' table.txt)" -eq 2 ] && [ "$(grep -cx 'atlas ball' table.txt)" -eq 2 ]
    [ "$(tail -2 table.txt)" = "$(printf 'atlas ball: ball.nii.gz, placed by %s\natlas slabs: slabs.nii.gz, placed by %s' \
        'sform, code 1 (scanner)' 'sform, code 1 (scanner)')" ]
}

@test "some options are of the first atlas only, and one atlas may be asked in two ways" {
    atlases
    answers query slabs.nii.gz --only 'Slab posterior' --atlas slabs.nii.gz --origin 0,0,90 --toward 0,0,0 \
        --layers all --format tsv
    [ "$(awk -F '\t' '$3 == "area" { print $2 "/" $5 }' <<<"$output" | sort | tr '\n' '.')" = \
        "slabs-2/Slab anterior.slabs-2/Slab posterior.slabs/Slab posterior." ]
    # the ball becomes a part of a group, and the slabs have no tree
    printf 'index\tname\tparent_id\n1\tSphere\t7\n7\tGroup\tn/a\n' >ball.tsv
    answers query ball.nii.gz --level 1 --atlas slabs.nii.gz --origin 0,0,90 --toward 0,0,0 -q
    has 'areas at level 1'
    has '  Group '
    answers batch ball.nii.gz --level 1 --atlas slabs.nii.gz --poses <(head -2 poses.tsv) -q
    # the ball as a context blocks all rays of the cone, for the slabs, the second atlas, too
    same_rows query --origin 0,0,90 --toward 0,0,0 --context ball.nii.gz --context-blocks 1
    [ "$(awk -F '\t' '$2 == "slabs" { print $3 "/" $10 }' both.rows)" = unassigned/1 ]
}

@test "diff matches rows by their atlas" {
    atlases 3
    conus query ball.nii.gz --atlas slabs.nii.gz --pose poses.tsv -o rows.tsv
    { head -1 rows.tsv; tail -n +2 rows.tsv | tac; } >turned.tsv
    answers diff rows.tsv turned.tsv
    awk -F '\t' -v OFS='\t' '$2 == "slabs" && $1 == "p1" && $3 == "unassigned" { $10 = 7 } 1' rows.tsv >other.tsv
    run -1 conus diff rows.tsv other.tsv
    [[ "${lines[0]}" == "changed   query p1, slabs: unassigned: "*" -> 7" ]]
    [ "${#lines[@]}" -eq 2 ]
    conus query ball.nii.gz --pose poses.tsv -o alone.tsv
    run -1 conus diff alone.tsv rows.tsv
    has 'column    atlas is only in the second'
    has ' 0 changed, '
}

@test "notes say which atlas they are of, and what is the same is said once" {
    atlases
    run --separate-stderr conus query ball.nii.gz --atlas slabs.nii.gz --origin 900,0,0 --direction 1,0,0 --format tsv
    [ "$(grep -c 'the cone points away from the atlas' <<<"$stderr")" -eq 2 ]
    [[ "$stderr" == *"it would hit Sphere first (ball)"* && "$stderr" == *"Slab anterior first (slabs)"* ]]
    run --separate-stderr conus query ball.nii.gz --atlas ball.nii.gz --origin 0,0,0 --direction 1,0,0 --format tsv
    [ "$stderr" = "conus: note: the device lies inside Sphere" ]
    run --separate-stderr conus query ball.nii.gz --atlas slabs.nii.gz --origin 0,0,19 --direction 1,0,0 --format tsv -q
    [ "$stderr" = "conus: warning: the cone points away from the atlas (slabs)" ]
    printf 'name\tx\ty\tz\nA1\t0\t0\t0\n' >sub-01_electrodes.tsv
    printf '{"iEEGCoordinateSystem": "MNI305", "iEEGCoordinateUnits": "mm"}' >sub-01_coordsystem.json
    run --separate-stderr conus query ball.nii.gz --atlas ball.nii.gz --pose sub-01_electrodes.tsv --radius 3 --format tsv
    [ "$(grep -c 'positions are in "MNI305"' <<<"$stderr")" -eq 1 ]
    python3 - <<'END' # slabs far away: the origin of the sform's rows, bytes 280 to 327, is 900 mm further
import gzip, struct
bytes = bytearray(gzip.open("slabs.nii.gz").read())
struct.pack_into("<f", bytes, 292, struct.unpack_from("<f", bytes, 292)[0] + 900)
struct.pack_into("<h", bytes, 252, 0)
gzip.open("far.nii.gz", "wb").write(bytes)
END
    run --separate-stderr conus batch ball.nii.gz --atlas far.nii.gz --poses poses.tsv
    [[ "$stderr" == *"conus: warning: ball and far do not overlap: are they in one space?"* ]]
}

@test "bad input is one line" {
    atlases
    aim=(--origin '0,0,90' --toward '0,0,0')
    fails 3 'none.nii.gz: cannot open' query ball.nii.gz --atlas ./none.nii.gz "${aim[@]}"
    fails 3 'none: cannot open: No such file or directory, and no installed atlas has that name' query ball.nii.gz --atlas none "${aim[@]}"
    fails 2 '--atlas' query ball.nii.gz --atlas "" "${aim[@]}"
    fails 2 '--atlas needs a value' query ball.nii.gz --atlas
    echo hello >text.nii
    fails 3 'text.nii: ' batch ball.nii.gz --atlas text.nii --poses poses.tsv
    # 16^3 voxels of two bytes are 8 KiB, 24^3 of one 13.5
    fails 3 'ball.nii.gz: dim: ' sweep slabs.nii.gz --atlas ball.nii.gz --max-memory 10K "${aim[@]}"
    cp slabs.nii.gz sides.nii.gz
    printf 'index\tname\n1\tArea_L\n300\tArea_R\n' >sides.tsv
    fails 3 'ball.nii.gz: hemispheres: merged: ' query sides.nii.gz --atlas ball.nii.gz --hemispheres merged "${aim[@]}"
    for output in image=seen.png mask=mask.nii.gz; do
        fails 2 "--atlas and --${output%=*} exclude each other" query ball.nii.gz --atlas slabs.nii.gz "${aim[@]}" "--$output"
    done
    for format in afni bids spikeglx open-ephys; do
        fails 2 "--format: formats of other programs have no column for the atlas" \
            query ball.nii.gz --atlas slabs.nii.gz --pose poses.tsv --format "$format"
        fails 2 "--format: formats of other programs have no column for the atlas" \
            batch ball.nii.gz --atlas slabs.nii.gz --poses poses.tsv --format "$format"
    done
    fails 2 '--output slabs.nii.gz would overwrite the input slabs.nii.gz' \
        query ball.nii.gz --atlas slabs.nii.gz "${aim[@]}" --format tsv -o slabs.nii.gz
    fails 2 'unknown option --atlas' render ball.nii.gz --atlas slabs.nii.gz
    mkdir one other
    cp ball.nii.gz one/twin.nii.gz
    cp slabs.nii.gz other/twin.nii.gz
    export CONUS_ATLAS_PATH=$PWD/one:$PWD/other
    fails 2 'twin: 2 atlases have that name' query ball.nii.gz --atlas twin "${aim[@]}"
}

@test "ten atlases, by name and by path, have ten names" {
    atlases
    mkdir own
    cp ball.nii.gz own/my_ball.nii.gz
    cp ball.tsv own/my_ball.tsv
    export CONUS_ATLAS_PATH=$PWD/own
    more=()
    for _ in 1 2 3 4 5 6 7 8; do
        more+=(--atlas own/my_ball.nii.gz)
    done
    answers query MY-BALL --atlas slabs.nii.gz "${more[@]}" --origin 0,0,90 --toward 0,0,0 --format tsv
    [ "$(tail -n +2 <<<"$output" | cut -f 2 | uniq | tr '\n' ' ')" = \
        "my_ball slabs my_ball-2 my_ball-3 my_ball-4 my_ball-5 my_ball-6 my_ball-7 my_ball-8 my_ball-9 " ]
}

# --sides is about the first atlas: the answer would have left and right of one atlas only exchanged.
@test "sides of one of several atlases are not exchanged" {
    atlases
    fails 2 '--sides exchanged mirrors ATLAS alone, and not slabs.nii.gz: ask the two one after the other' \
        query ball.nii.gz --atlas slabs.nii.gz --sides exchanged --origin 0,0,90 --toward 0,0,0
}
