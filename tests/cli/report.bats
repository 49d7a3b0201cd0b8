#!/usr/bin/env bats
# conus report: every number of the page is one of the table, and every text one of conus cite.
load helpers

aim=(--origin 0,0,90.5 --toward 0,0,0 --angle 20)

# title: the headings of parts, a line each.
titles() {
    grep -o '<h1>[^/]*</h1>' "$1/report.html" | sed 's|</*h1>||g'
}

# has_all FOLDER RESULT: the parts that every report has.
has_all() {
    cmp "$2" "$1/$2"
    cmp "${2%.tsv}.json" "$1/${2%.tsv}.json"
    conus cite "$2" | cmp - "$1/methods.txt"
    conus cite "$2" --format bibtex | cmp - "$1/references.bib"
    run -0 conus verify "$1/$2" --folder .
    grep -qF "content=\"default-src 'none'; img-src data:; style-src 'unsafe-inline'\"" "$1/report.html"
    grep -qF "conus verify $2" "$1/report.html"
}

@test "one pose of query: what is said is what the table says, with pictures of the same question" {
    conus phantom nested -o . --size 24
    conus query nested.nii.gz "${aim[@]}" -q -o rows.tsv
    run -0 --separate-stderr conus report rows.tsv -o folder
    [ "${lines[0]}" = 'rows.tsv: identical' ] && [ -z "$stderr" ]
    has_all folder rows.tsv
    wanted=$(awk -F'\t' 'NR == 2 { printf "%s: %.1f %% of the cone", $4, 100 * $9 }
        $2 == "unassigned" && $9 > 0 { printf "; in no area: %.1f %% of the cone", 100 * $9 }' rows.tsv)
    [ "$(titles folder)" = "$wanted" ] || { echo "$(titles folder), not $wanted"; return 1; }
    conus render nested.nii.gz "${aim[@]}" --size 1600x1200 --style print -q -o own.png
    run -0 conus diff own.png folder/brain.png
    [ -s folder/cuts.png ]
    for picture in brain cuts; do
        grep -o 'base64,[^"]*' folder/report.html | sed 's/base64,//' | while read -r digits; do
            base64 -d <<<"$digits" | cmp -s - "folder/$picture.png" && echo "$picture"
        done >found || true
        [ "$(cat found)" = $picture ]
    done
    not grep -q '<script\|http-equiv="refresh"\|src="http' folder/report.html
}

@test "an overlap, several poses and several atlases have a part each, and no picture" {
    conus phantom nested -o . --size 24
    conus phantom sphere -o . --size 24
    conus overlap nested.nii.gz sphere.nii.gz --threshold 1 -q -o overlap.tsv
    run -0 conus report overlap.tsv -o over
    has_all over overlap.tsv
    [[ $(titles over) == Shell\ outer:*%\ of\ the\ region* ]] || { titles over; return 1; }
    printf 'query_id\tx\ty\tz\tdx\tdy\tdz\na\t0\t0\t60\t0\t0\t-1\nb\t60\t0\t0\t-1\t0\t0\n' >poses.tsv
    conus query nested.nii.gz --pose poses.tsv -q -o two.tsv
    run -0 conus report two.tsv -o poses
    [ "$(titles poses | cut -d: -f1 | xargs)" = 'a b' ]
    conus query nested.nii.gz --atlas sphere.nii.gz "${aim[@]}" -q -o several.tsv
    run -0 conus report several.tsv -o several
    [ "$(titles several | cut -d: -f2 | xargs)" = 'nested sphere' ] || { titles several; return 1; }
    for folder in over poses several; do
        [ ! -e $folder/brain.png ]
        grep -q 'No picture: ' $folder/report.html
    done
}

@test "names are no marks of the page" {
    conus phantom sphere -o . --size 24
    printf 'index\tname\n1\t<img src=x onerror="a()">&amp;\n' >names.tsv
    conus query sphere.nii.gz --labels names.tsv "${aim[@]}" -q -o rows.tsv
    run -0 conus report rows.tsv -o folder
    grep -qF '<td>&lt;img src=x onerror=&quot;a()&quot;>&amp;amp;</td>' folder/report.html
    not grep -q '<img src=x' folder/report.html
}

@test "what is not so, or no answer, has no report" {
    conus phantom nested -o . --size 24
    conus query nested.nii.gz "${aim[@]}" -q -o rows.tsv
    mkdir there
    fails 3 'there: is there already' report rows.tsv -o there
    sed 's/Shell/Shall/' rows.tsv >changed.tsv
    cp rows.json changed.json
    run -1 conus report changed.tsv -o folder
    [[ $output == *differ* ]]
    conus sweep nested.nii.gz "${aim[@]}" -q -o sweep.tsv
    fails 3 'a report is made of the answers of conus query, batch and overlap' report sweep.tsv -o folder
    conus query nested.nii.gz "${aim[@]}" -q --format tsv -o methods.txt
    fails 3 'methods.txt: a report has a file of its own of this name' report methods.txt -o folder
    printf 'query\tname\n' >alone.tsv
    fails 3 'alone.tsv' report alone.tsv -o folder
    [ ! -e folder ]
}
