#!/usr/bin/env bats
# Files of poses: those of other programs, and ten hostile ones.
load helpers
SAMPLES=$BATS_TEST_DIRNAME/../fuzz/corpus/poses
HEADER='query_id\tx\ty\tz\tdx\tdy\tdz\n'
FIRST='first\t0\t0\t100\t0\t0\t-1\n'
LAST='last\t100\t0\t0\t-1\t0\t0\n'

# answered FILE CODE [OPTION...]: the answers to the good poses, whatever lies between them.
answered() {
    local file=$1 code=$2
    shift 2
    [ -e sphere.nii.gz ] || sphere --size 16
    printf %b "$HEADER$FIRST$LAST" >clean.tsv
    answers query sphere.nii.gz --pose clean.tsv --format tsv
    local wanted=$output
    run -"$code" --separate-stderr "$CONUS" query sphere.nii.gz --pose "$file" --format tsv "$@"
    [ ! -f "$file" ] || conus batch sphere.nii.gz --poses "$file" "$@" | diff - <(echo "$output")
    [ "$(grep -cP '\terror\tn/a\tline ' <<<"$output")" -eq "${#stderr_lines[@]}" ]
    diff <(grep -vP '\terror\t' <<<"$output") - <<<"$wanted"
}

@test "hostile: NaN and infinity" {
    printf %b "$HEADER$FIRST"'nan\tnan\t0\t100\t0\t0\t-1\ninf\t0\t0\t100\t0\tinf\t-1\n'"$LAST" >poses.tsv
    answered poses.tsv 1
    [ "${#stderr_lines[@]}" -eq 2 ]
    [[ "${stderr_lines[0]}" == *'poses.tsv:3: column x: "nan" is not a finite number' ]]
    [[ "${stderr_lines[1]}" == *'poses.tsv:4: column dy: "inf" is not a finite number' ]]
}

@test "hostile: a line of a million characters" {
    { printf %b "$HEADER$FIRST"; head -c 1000000 /dev/zero | tr '\0' 1; printf %b '\n'"$LAST"; } >poses.tsv
    answered poses.tsv 1
    check_message 'poses.tsv:3: a line of more than 65535 bytes'
}

@test "hostile: columns that are missing" {
    sphere --size 16
    printf 'query_id\tx\ty\tdx\tdy\tdz\na\t0\t0\t0\t0\t-1\n' >poses.tsv
    fails 3 'poses.tsv: header: only some of the columns x y z: x y, without z; columns found' \
        query sphere.nii.gz --pose poses.tsv
    printf 'dx\tdy\tdz\n0\t0\t100\n' >poses.tsv
    fails 3 'poses.tsv: header: x y z, the positions, are missing' query sphere.nii.gz --pose poses.tsv
}

@test "hostile: wrong counts of fields" {
    printf %b "$HEADER$FIRST"'short\t0\t0\nlong\t0\t0\t100\t0\t0\t-1\t7\n'"$LAST" >poses.tsv
    answered poses.tsv 1
    [[ "${stderr_lines[0]}" == *'poses.tsv:3: 3 fields, the header has 7' ]]
    [[ "${stderr_lines[1]}" == *'poses.tsv:4: 8 fields, the header has 7' ]]
}

@test "hostile: binary" {
    sphere --size 16
    fails 3 'sphere.nii.gz: is an atlas by its name, not a file of poses' query sphere.nii.gz --pose sphere.nii.gz
    printf 'v 1 2 3\nv 4 5 6\nv 7 8 9\nf 1 2 3\n' >mesh.obj # lines of a word and three numbers, as points have them
    fails 3 'mesh.obj: is an atlas by its name, not a file of poses' query sphere.nii.gz --pose mesh.obj
    printf %b "$HEADER$FIRST" | gzip >poses.tsv.gz
    fails 3 'poses.tsv.gz: packed by gzip' query sphere.nii.gz --pose poses.tsv.gz
    head -c 100000 /dev/zero | tr '\0' '\377' >poses.bin
    fails 3 'poses.bin: header: a line of more than 65535 bytes' query sphere.nii.gz --pose poses.bin
    printf %b "$HEADER$FIRST"'\0\1\2\n\0\xff\xfe\n'"$LAST" >poses.tsv
    answered poses.tsv 1
    [[ "${stderr_lines[0]}" == *'poses.tsv:3: a zero byte: not text' ]]
}

@test "hostile: CR LF, and CR alone" {
    printf %b "$HEADER$FIRST$LAST" | sed 's/$/\r/' >poses.tsv
    answered poses.tsv 0
    printf %b "$HEADER$FIRST$LAST" | tr '\n' '\r' >poses.tsv
    answered poses.tsv 0
}

@test "hostile: a byte order mark, and UTF-16" {
    printf %b '\xef\xbb\xbf'"$HEADER$FIRST$LAST" >poses.tsv
    answered poses.tsv 0
    # As Excel writes "Unicode text", and the other way round.
    printf %b "\ufeff$HEADER$FIRST$LAST" | iconv -t UTF-16LE >poses.tsv
    answered poses.tsv 0
    printf %b "\ufeff$HEADER$FIRST$LAST" | iconv -t UTF-16BE >poses.tsv
    answered poses.tsv 0
    answered - 0 <poses.tsv
}

@test "hostile: names that repeat" {
    printf %b "$HEADER$FIRST${FIRST/100/-100}$LAST" | sed 's/-1$/1/;2s/1$/-1/' >poses.tsv
    sphere --size 16
    run -0 --separate-stderr "$CONUS" query sphere.nii.gz --pose poses.tsv --format tsv
    local said='conus: note: poses.tsv: poses 1 and 2 are both called "first"; 1 of 3 have'
    [[ "$stderr" == "$said"* ]]
    [[ "$(conus batch sphere.nii.gz --poses poses.tsv 2>&1 >/dev/null)" == *" rays"$'\n'"$said"* ]]
    [[ "$(conus plan sphere.nii.gz --poses poses.tsv --reach Sphere --depth 100 2>&1 >/dev/null)" == "$said"* ]]
    [ "$(cut -f1 <<<"$output" | uniq -c | awk '{ print $1, $2 }' | paste -sd,)" = '1 query,4 first,2 last' ]
}

@test "hostile: matrices that are not rigid, and left-handed ones" {
    sphere --size 16
    header=$(printf 'm%s\t' 00 01 02 03 10 11 12 13 20 21 22 23 30 31 32 33)
    {
        printf '%squery_id\n' "$header"
        printf '1\t0\t0\t0\t0\t1\t0\t0\t0\t0\t1\t100\t0\t0\t0\t1\tfirst\n'
        printf '2\t0\t0\t0\t0\t2\t0\t0\t0\t0\t2\t100\t0\t0\t0\t1\tscaled\n'
        printf '1\t0.2\t0\t0\t0\t1\t0\t0\t0\t0\t1\t100\t0\t0\t0\t1\tskewed\n'
        printf '1\t0\t0\t0\t0\t1\t0\t0\t0\t0\t1\t100\t0\t0\t1\t1\tprojective\n'
        printf -- '-1\t0\t0\t0\t0\t1\t0\t0\t0\t0\t1\t100\t0\t0\t0\t1\tleft\n'
        printf '0\t0\t1\t100\t0\t1\t0\t0\t-1\t0\t0\t0\t0\t0\t0\t1\tlast\n'
    } >poses.tsv
    run -1 --separate-stderr "$CONUS" query sphere.nii.gz --pose poses.tsv --format tsv
    [ "$(cell query 1)/$(cell name 1)/$(cell query 7)/$(cell name 7)" = first/Sphere/last/Sphere ]
    [ "$(cut -f 1,2 <<<"${lines[*]:3:4}" | cut -f 2 | sort -u)" = error ]
    [ "${#lines[@]}" -eq 9 ]
    [ "${#stderr_lines[@]}" -eq 4 ]
    [[ "${stderr_lines[0]}" == *'poses.tsv:3: pose matrix: column 1 is 2 long, not 1 within 0.001'* ]]
    [[ "${stderr_lines[1]}" == *'poses.tsv:4: pose matrix: columns 1 and 2 are not at a right angle'* ]]
    [[ "${stderr_lines[2]}" == *'poses.tsv:5: pose matrix: last row 0 0 1 1'* ]]
    [[ "${stderr_lines[3]}" == *'poses.tsv:6: pose matrix: left-handed'* ]]
}

@test "hostile: quotation marks, as spreadsheets and R write them" {
    {
        printf '"query_id","x","y","z","dx","dy","dz"\n"first",0,"0","100",0,0,"-1"\n'
        printf '"open,0,0,100,0,0,-1\n'
        printf 'broken",0,0,100,0,0,-1\n'
        printf '"a"b,0,0,100,0,0,-1\n"last",100,0,0,-1,0,0\n'
    } >poses.csv
    answered poses.csv 1
    [[ "${stderr_lines[0]}" == *'poses.csv:3: a quotation mark that is not closed in its line: "open,0'* ]]
    [[ "${stderr_lines[1]}" == *'poses.csv:4: a quotation mark inside a field: broken"' ]]
    [[ "${stderr_lines[2]}" == *'poses.csv:5: a quotation mark inside a field: a' ]]
    printf 'query_id;x;y;z;dx;dy;dz\n"a;b ""c""";0;0;100;0;0;-1\n' >poses.csv
    answers query sphere.nii.gz --pose poses.csv --format tsv
    [ "$(cell query 1)/$(cell name 1)" = 'a;b "c"/Sphere' ]
    printf %b "$HEADER"'5" left\t0\t0\t100\t0\t0\t-1\n' >poses.tsv
    answers query sphere.nii.gz --pose poses.tsv --format tsv
    [ "$(cell query 1)/$(cell name 1)" = '5" left/Sphere' ]
}

@test "hostile: numbers as other programs and countries write them" {
    local pair number
    for pair in '1e;0x10' '1e400;1.5 mm' '1_000;−−' '--1;' 'n/a;1,5,2'; do # of more than half of the rows it would refuse the file
        {
            printf %b "$HEADER$FIRST"
            for number in "${pair%;*}" "${pair#*;}"; do
                printf 'bad %s\t%s\t0\t100\t0\t0\t-1\n' "$number" "$number"
            done
            printf 'last\t+100.\t 0 \t-0\t-1e0\t.0\t1e-400\n'
        } >poses.tsv
        answered poses.tsv 1
        [ "${#stderr_lines[@]}" -eq 2 ]
    done
    [[ "${stderr_lines[1]}" == *'poses.tsv:4: column x: "1,5,2" is not a finite number; decimals are written with a point' ]]
    printf 'query_id;x;y;z;dx;dy;dz\nfirst;0,0;−0,00;100;0;0;-1\nlast;1,0e2;0;0;-1;0;0\n' >poses.csv
    answered poses.csv 0
    printf 'query_id;x;y;z;dx;dy;dz\nfirst;0;0;1,100;0;0;-1\n' >poses.csv
    fails 3 'a comma before three digits, or commas of two kinds: 1,250 may be 1250 or 1.25' \
        query sphere.nii.gz --pose poses.csv
}

@test "hostile: angles, directions and rotations that are none, and lengths at the end of what numbers can be" {
    sphere --size 16
    {
        printf 'query_id\tx\ty\tz\tqw\tqx\tqy\tqz\tangle\n'
        printf 'first\t0\t0\t100\t1e-8\t0\t0\t0\t5\n'
        for rest in '0\t0\t0\t0\t5' '1e-200\t0\t0\t0\t5' '1e300\t1e300\t0\t0\t5' '1\t0\t0\t0\t-5' '1\t0\t0\t0\t180' '1\t0\t0\t0\t0' '1\t0\t0\t0\t1e9'; do
            printf "bad $rest\t0\t0\t100\t$rest\n" | sed 's/\t/ /;s/\t/ /;s/\t/ /;s/\t/ /'
        done
        printf 'last\t0\t0\t100\t1e150\t0\t0\t0\tn/a\n'
    } >poses.tsv
    run -1 --separate-stderr "$CONUS" query sphere.nii.gz --pose poses.tsv --angle 5 --format tsv
    conus batch sphere.nii.gz --poses poses.tsv --angle 5 | diff - <(echo "$output")
    [ "$(awk -F'\t' '$1 ~ /^bad/ { print $2 }' <<<"$output" | uniq -c | tr -d ' ')" = 7error ]
    diff <(grep ^first <<<"$output") <(grep ^last <<<"$output" | sed 's/^last/first/')
    [[ "${stderr_lines[1]}" == *'poses.tsv:4: quaternion: 1e-200,0,0,0, allowed are finite numbers of a length from 1e-9 to 1e154' ]]
    printf %b "$HEADER"'bad\t0\t0\t100\t0\t-0\t0\n' >poses.tsv
    run -1 --separate-stderr "$CONUS" query sphere.nii.gz --pose poses.tsv --format tsv
    [[ "$stderr" == *'not all 0'* ]]
}

@test "hostile: files that are no text, or no table, are told by what they are" {
    sphere --size 16
    printf %b "$HEADER$FIRST" >poses.tsv
    { printf '\xff\xfe'; sed 's/./&\x00/g' poses.tsv; } >utf16.tsv
    fails 3 'utf16.tsv: header: ' query sphere.nii.gz --pose utf16.tsv # whose lines end in a byte of its own
    sed 's/./&\x00/g' poses.tsv >bare16.tsv
    fails 3 'bare16.tsv: a zero byte' query sphere.nii.gz --pose bare16.tsv
    printf '\xfd7zXZ\0' >file.xz
    fails 3 'file.xz: packed by xz: unpack it' batch sphere.nii.gz --poses file.xz
    printf 'BZh91AY&SY' >file.bz2
    fails 3 'packed by bzip2' sweep sphere.nii.gz --pose file.bz2
    printf '(\xb5/\xfd' >file.zst
    fails 3 'standard input: packed by zstd' track sphere.nii.gz --poses - <file.zst
    printf 'PK\003\004' >file.xlsx
    fails 3 'a zip file or a spreadsheet: unpack it, or export it as text' query sphere.nii.gz --pose file.xlsx
    printf '\320\317\021\340' >file.xls
    fails 3 'a spreadsheet: export it as text' query sphere.nii.gz --pose file.xls
    tail -n 1 poses.tsv | cut -f 2- >headless.tsv
    fails 3 'no header, and 6 numbers in a line, neither the 16 of a matrix nor the x y z of a point' \
        query sphere.nii.gz --pose headless.tsv
    fails 3 'no names of columns, but the first line of a table has names' \
        query sphere.nii.gz --pose headless.tsv --poses-format table
    printf 'x\tX\ty\tz\tdx\tdy\tdz\n0\t1\t0\t100\t0\t0\t-1\n' >twice.tsv
    fails 3 'header: column "x" twice' query sphere.nii.gz --pose twice.tsv
    printf 'name\tx\ty\tz\tx\nA1\t0\t0\t0\t50\n' >twice_electrodes.tsv
    fails 3 'header: column "x" twice' query sphere.nii.gz --pose twice_electrodes.tsv --radius 2 --quiet
    sed 's/Loc. Y/Loc. X/' "$SAMPLES/brainsight.txt" >twice.txt
    fails 3 'a column Loc. X twice' query sphere.nii.gz --pose twice.txt
}

@test "a header again in the middle, as of files that were joined, is passed over; another one is refused" {
    { printf %b "$HEADER$FIRST"; printf %b "$HEADER"; printf %b "$LAST"; } >poses.tsv
    answered poses.tsv 0 --quiet
    run -0 --separate-stderr "$CONUS" query sphere.nii.gz --pose poses.tsv
    check_message '1 lines that are the header again passed over, the first in line 3'
    { printf %b "$HEADER$FIRST"; printf 'name\tx\ty\tz\n'; printf %b "$LAST"; } >poses.tsv
    fails 3 'line 3: "name' query sphere.nii.gz --pose poses.tsv
}

@test "separators, trailing ones, rules and comments of other programs change nothing" {
    printf 'query_id x y z dx dy dz\nfirst 0 0 100 0 0 -1\nlast 100 0 0 -1 0 0\n' >poses.txt
    answered poses.txt 0
    sed 's/ /   /g' poses.txt >wide.txt
    answered wide.txt 0
    sed 's/ /\t/g; s/$/\t/' poses.txt >trailing.tsv
    answered trailing.tsv 0
    { echo 'sep=;'; echo '// made by hand'; sed 's/ /;/g' poses.txt; echo ';;;;;;'; } >said.csv
    answered said.csv 0
    sed 's/ / | /g; s/^/| /; s/$/ |/; 1a|---|---|---|---|---|---|---|' poses.txt >poses.md
    answered poses.md 0
    { echo 'Poses of Monday'; echo; sed 's/^query_id x/% query_id x/; s/^\(last\|first\)/\1/' poses.txt; echo '% end'; } >comment.txt
    answered comment.txt 0
}

@test "a file without poses is answered, without rows; one that says nothing is an error" {
    sphere --size 16
    printf 'time_s\tx\ty\tz\tdx\tdy\tdz\n# none today\n' >none.tsv
    for command in "query --pose" "batch --poses" "sweep --pose" "sweep --angles 2,4 --pose" "sweep --jitter 1,1 --pose" "track --poses"; do
        for format in tsv ndjson json table; do
            [ "${command%% *}" != batch ] || case $format in json|table) continue ;; esac
            # shellcheck disable=SC2086 # words
            run -0 --separate-stderr "$CONUS" $command none.tsv sphere.nii.gz --format $format
            check_message 'note: none.tsv: no poses in it'
            case $format in
                tsv) [ "${#lines[@]}" -eq 1 ] && [[ "$output" == query$'\t'* ]] ;;
                ndjson) [ -z "$output" ] ;;
                json) [ "$(jq -c '.Rows, .Queries' <<<"$output" | paste -sd/)" = '[]/[]' ] ;;
            esac
            # shellcheck disable=SC2086
            answers $command none.tsv sphere.nii.gz --format $format --quiet --force -o "answer.$format"
        done
        : >empty.tsv
        # shellcheck disable=SC2086
        fails 3 'empty.tsv: no poses: ' $command empty.tsv sphere.nii.gz
        # shellcheck disable=SC2086
        fails 3 'standard input: no poses: ' $command - sphere.nii.gz <empty.tsv
        rm answer.*
    done
    answers batch sphere.nii.gz --poses none.tsv --shard 1/2
    printf 'name\tx\ty\tz\tsize\n' >none_electrodes.tsv
    answers query sphere.nii.gz --pose none_electrodes.tsv --radius 2 --format bids --quiet
    [[ "$output" == $'name\tx\ty\tz\tsize\tarea\t'* ]]
    fails 2 'none.tsv has 0' query sphere.nii.gz --pose none.tsv --image seen.png
    fails 2 'none.tsv has 0 poses, a picture takes one' render sphere.nii.gz --pose none.tsv -o view.png
}

@test "poses come from standard input, too" {
    printf %b "$HEADER$FIRST$LAST" >poses.tsv
    answered - 0 <poses.tsv
    answered - 0 < <(cat poses.tsv)
    answered <(cat poses.tsv) 0
}

# same_answers A OPTION... -- B OPTION...: both files have the same answers, but for the names of the poses.
same_answers() {
    local first=()
    while [ "$1" != -- ]; do first+=("$1"); shift; done
    shift
    run --separate-stderr "$CONUS" query sphere.nii.gz --quiet --format tsv --any-space --pose "${first[@]}"
    local wanted
    wanted=$(cut -f2- <<<"$output")
    [ "$(wc -l <<<"$wanted")" -gt 2 ]
    run --separate-stderr "$CONUS" query sphere.nii.gz --quiet --format tsv --any-space --pose "$@"
    [ "$(cut -f2- <<<"$output")" = "$wanted" ] || { echo "got: $output"; echo "wanted: $wanted"; return 1; }
}

@test "a device is the same in every format that can say it" {
    sphere --size 16
    printf 'x,y,z,tx,ty,tz\n80,0,0,0,0,0\n' >table.csv
    printf '# Coordinate system: NIfTI:Scanner\n# Target Name\tLoc. X\tLoc. Y\tLoc. Z' >brainsight.txt
    printf '\tm%s' 0n0 0n1 0n2 1n0 1n1 1n2 2n0 2n1 2n2 >>brainsight.txt
    printf '\nside\t80\t0\t0\t0\t1\t0\t0\t0\t1\t1\t0\t0\n' >>brainsight.txt
    {
        printf '<InstrumentMarkerList coordinateSpace="LPS"><InstrumentMarker><Marker description="side" set="true">'
        printf '<Matrix4D data00="1" data01="0" data02="0" data03="-80" data10="0" data11="0" data12="-1" data13="0"'
        printf ' data20="0" data21="1" data22="0" data23="0" data30="0" data31="0" data32="0" data33="1"/>'
        printf '</Marker></InstrumentMarker></InstrumentMarkerList>\n'
    } >markers.xml
    printf '{"markups":[{"type":"Line","coordinateSystem":"LPS","name":"side","controlPoints":[%s,%s]}]}' \
        '{"position":[-80,0,0]}' '{"position":[0,0,0]}' >line.mrk.json
    printf '0 0 1 80\n1 0 0 0\n0 1 0 0\n0 0 0 1\n' >matrix.txt
    printf '1 0 0 80\n0 0 -1 0\n0 1 0 0\n0 0 0 1\n' >turned.txt
    printf 'name\tx\ty\tz\tsize\nR1\t80\t0\t0\t1\nR2\t70\t0\t0\t1\n' >electrodes.tsv
    same_answers table.csv -- brainsight.txt
    same_answers table.csv -- markers.xml
    same_answers table.csv -- line.mrk.json
    same_answers table.csv -- matrix.txt
    same_answers table.csv -- turned.txt --axis -x
    same_answers table.csv -- turned.txt --axis=-x --poses-format matrix
    printf 'x,y,z,tx,ty,tz\n80,0,0,0,0,0\n70,0,0,0,0,0\n' >table.csv
    same_answers table.csv -- electrodes.tsv --along-shafts
}

@test "a file that names another space than the atlas is refused, or taken by --any-space" {
    need_aal
    fails 3 'brainsight.txt: positions are in "NIfTI:Scanner", the atlas in another space' \
        query "$aal" --pose "$SAMPLES/brainsight.txt"
    run -1 --separate-stderr "$CONUS" query "$aal" --pose "$SAMPLES/brainsight.txt" --any-space --format tsv
    [[ "$stderr" == *'note: '*'landmarks and other sections were passed over'* ]]
    [ "$(cell query 1)" = 'target/M1 left' ]
}

@test "poses of a person's own scan are refused on templates, warned of on unknown brains, and taken on that person's" {
    need_all
    need_aal
    sphere --size 16
    local places='<InstrumentMarker><Marker description="a"><Matrix4D data00="0" data01="0" data02="1" data03="-90"
data10="0" data11="1" data12="0" data13="0" data20="-1" data21="0" data22="0" data23="10" data30="0" data31="0"
data32="0" data33="1"/></Marker></InstrumentMarker>'
    local space list words
    for space in ' coordinateSpace="RAS"' ' coordinateSpace="LPS"' ''; do
        list="<InstrumentMarkerList$space>$places</InstrumentMarkerList>"
        printf '%s\n' "$list" >list.xml
        words=$(sed -n 's/.*="\(.*\)"/Localite \1/p' <<<"$space")
        words="positions are in \"${words:-Localite, no coordinateSpace}\""
        for atlas in "$aal" HarvardOxford-cort-maxprob-thr0-1mm JHU-WhiteMatter-labels-1mm; do
            fails 3 "list.xml: $words, the atlas in another space (" query "$atlas" --pose list.xml -q
            fails 3 "list.xml: $words, the atlas in another space (" batch "$atlas" --poses list.xml -q
        done
        run -0 --separate-stderr "$CONUS" query "$aal" --pose list.xml --any-space -q
        run -0 --separate-stderr "$CONUS" query sphere.nii.gz --pose list.xml
        [[ "$stderr" == *"$words; it is not known whether the atlas"*"',template=none' behind ATLAS says"* ]]
        run -0 --separate-stderr "$CONUS" query sphere.nii.gz,template=none --pose list.xml
        [[ "$stderr" != *"$words"* ]]
        run -0 --separate-stderr "$CONUS" query aal,template=none --pose list.xml
        [[ "$stderr" != *"$words"* ]]
        fails 3 'the atlas in another space (MNI 305, as stated)' query sphere.nii.gz,template=mni305 --pose list.xml
    done
    printf '<InstrumentMarkerList coordinateSpace="MNI">%s</InstrumentMarkerList>\n' "$places" >list.xml
    fails 3 "the atlas in another space (one person's own, as stated)" query aal,template=none --pose list.xml
    run -0 --separate-stderr "$CONUS" query "$aal" --pose list.xml
    [[ "$stderr" == *'note: list.xml: positions are in "Localite MNI", the atlas is Colin 27, by its grid'* ]]
    fails 2 'template: found "MNI", allowed are mni152, colin27, mni305, and none' info aal,template=MNI
}

# Contacts of a head, 0.06 to 0.1 m from the origin, in a table in mm.
@test "a comment behind the head that names another space ends the answers" {
    sphere --size 16
    { printf 'name,x,y,z\n'; yes 'p,0,0,0' | head -9000; printf '# Talairach coordinates\nq,0,0,0\n'; } >late.csv
    fails 3 'late.csv: line 9002: "Talairach coordinates" says another space or unit' \
        batch sphere.nii.gz --poses late.csv --radius 1 --quiet -o late.tsv
    run -0 --separate-stderr "$CONUS" batch sphere.nii.gz --poses late.csv --radius 1 --quiet -o late.tsv --any-space --force
}

@test "positions of MNI 305 are moved, but not on an atlas that is stated to be of it" {
    sphere --size 16
    printf 'name,x,y,z,template\nA,10,20,30,fsaverage\n' >points.csv
    run -0 --separate-stderr "$CONUS" query sphere.nii.gz,template=mni305 --pose points.csv --format tsv
    [ "$(cell x 1)/$(cell y 1)/$(cell z 1)" = 10/20/30 ]
    [[ "$stderr" != *MNI* ]]
    run -0 --separate-stderr "$CONUS" query sphere.nii.gz,template=mni152 --pose points.csv --format tsv
    [ "$(cell x 1)/$(cell y 1)/$(cell z 1)" = 10.3141/21.6416/30.781 ]
    [[ "$stderr" == *'moved to MNI 152'* ]]
}

@test "electrodes in metres that are said to be in mm have a note, in query and in batch" {
    sphere --size 16
    printf 'name\tx\ty\tz\nA\t0.05\t0.03\t0.01\nB\t-0.05\t0.01\t0.09\n' >sub-01_electrodes.tsv
    printf '{"EEGCoordinateSystem":"individual","EEGCoordinateUnits":"mm"}' >sub-01_coordsystem.json
    note='warning: sub-01_electrodes.tsv: all positions lie within 1 mm of the origin, as if they were in metres; '
    note+='they are taken as mm, as sub-01_coordsystem.json says'
    run -0 --separate-stderr "$CONUS" query sphere.nii.gz --pose sub-01_electrodes.tsv --radius 2
    [[ "$stderr" == *"$note"* ]]
    run -0 --separate-stderr "$CONUS" batch sphere.nii.gz --poses sub-01_electrodes.tsv --radius 2
    [[ "$stderr" == *"$note"* ]]
    printf '{"EEGCoordinateSystem":"individual","EEGCoordinateUnits":"m"}' >sub-01_coordsystem.json
    run -0 --separate-stderr "$CONUS" query sphere.nii.gz --pose sub-01_electrodes.tsv --radius 2
    [[ "$stderr" != *'in metres'* ]]
}

@test "a table without a coordsystem.json has the space of its name, and the note says which" {
    sphere --size 16
    printf 'name\tx\ty\tz\nA\t5\t3\t1\n' | tee sub-1_electrodes.tsv >sub-1_space-MNI152Lin_electrodes.tsv
    note='no *_coordsystem.json beside it: positions are taken as mm, and'
    run -0 --separate-stderr "$CONUS" query sphere.nii.gz --pose sub-1_electrodes.tsv --radius 2
    [[ "$stderr" == *"sub-1_electrodes.tsv: $note no space is known"* ]]
    run -0 --separate-stderr "$CONUS" query sphere.nii.gz --pose sub-1_space-MNI152Lin_electrodes.tsv --radius 2
    [[ "$stderr" == *"sub-1_space-MNI152Lin_electrodes.tsv: $note the space is that of its name, \"MNI152Lin\""* ]]
}

# The ball of 20 mm reaches from x = -20 to 20. First two of five points are farther right than 25 mm, then one of five.
@test "points of which more than a fifth lie outside of the atlas have a note, in query and in batch" {
    sphere
    printf '%s 0 0 p%s\n' -1 a 26 b 2 c 27 d 3 e >points.txt
    note='note: points.txt: 2 of 5 points lie more than the radius outside of the atlas, the first in line 2; are they'
    run -0 --separate-stderr "$CONUS" query sphere.nii.gz --pose points.txt --radius 5
    [[ "$stderr" == *"$note"* ]]
    run -0 --separate-stderr "$CONUS" batch sphere.nii.gz --poses points.txt --radius 5
    [[ "$stderr" == *"$note"* ]]
    printf '%s 0 0 p%s\n' -1 a 26 b 2 c 24 d 3 e >points.txt
    run -0 --separate-stderr "$CONUS" query sphere.nii.gz --pose points.txt --radius 5
    [ -z "$stderr" ]
}

@test "batch answers every format as query does" {
    sphere --size 16
    for file in brainsight.txt localite-instrument.xml localite-trigger.xml lines.mrk.json; do
        run -1 --separate-stderr "$CONUS" query sphere.nii.gz --pose "$SAMPLES/$file" --format tsv --quiet --axis +z
        local wanted=$output
        [ "$(wc -l <<<"$wanted")" -gt 2 ]
        run -1 --separate-stderr "$CONUS" batch sphere.nii.gz --poses "$SAMPLES/$file" --format tsv --quiet --axis +z
        [ "$output" = "$wanted" ]
    done
    need_aal
    fails 3 ', or move the atlas there (--atlas-transform); only if they are in the atlas' \
        batch "$aal" --poses "$SAMPLES/brainsight.txt"
}

@test "--max-memory holds for poses that are read whole or kept with their answers" {
    sphere --size 16
    printf 'name\tx\ty\tz\tsize\n' >many_electrodes.tsv
    printf 'A%d\t0\t0\t0\t5\n' {1..3000} >>many_electrodes.tsv
    cp "$SAMPLES"/{brainsight.txt,localite-trigger.xml,lines.mrk.json} .
    for file in brainsight.txt localite-trigger.xml lines.mrk.json many_electrodes.tsv; do
        while [ "$(wc -c <$file)" -le 33000 ]; do echo >>$file; printf '%8191s' >>$file; done
        for command in "query --pose" "batch --poses" "sweep --pose" "track --poses" "render -o view.png --pose"; do
            # shellcheck disable=SC2086 # words
            fails 3 "$file: more than 32768 bytes, allowed of a format that is read whole (--max-memory)" \
                $command $file sphere.nii.gz --max-memory 32K
        done
    done
    fails 3 'standard input: more than 32768 bytes' query sphere.nii.gz --pose - --max-memory 32K <many_electrodes.tsv
    { printf %b "$HEADER"; yes "$(printf %b "$FIRST")" | head -2000; } >poses.tsv
    rm sphere.json # beside the volume it would be taken for a label table; those have less
    # 2 KiB each: 16 poses in 32 KiB, 2,000 in 4,000
    for command in "query --pose" "sweep --pose" "render -o view.png --strips --range 0,9 --poses" \
        "plan --depth 9 --reach 1 --toward centroid --from"; do
        # shellcheck disable=SC2086 # words
        fails 3 "poses.tsv: more than 16 poses, which take 2048 bytes each with their answers, allowed are 32768 bytes" \
            $command poses.tsv sphere.nii.gz --max-memory 32K --quiet
    done
    fails 3 'poses.tsv: more than 1999 poses' query sphere.nii.gz --pose poses.tsv --max-memory 4095999 --quiet
    answers query sphere.nii.gz --pose poses.tsv --max-memory 4000K --format tsv --quiet
    answers batch sphere.nii.gz --poses poses.tsv --max-memory 32K --quiet
    [ "$(cut -f 3 <<<"$output" | grep -c area)" -eq 2000 ]
}

@test "track follows the triggers that Localite noted" {
    sphere --size 16
    run -1 --separate-stderr "$CONUS" track sphere.nii.gz --poses "$SAMPLES/localite-trigger.xml" --format tsv --quiet
    check_message 'localite-trigger.xml:7: the matrix is the identity, as of a coil that was not tracked'
    [ "$(cut -f1 <<<"$output" | uniq | paste -sd,)" = 'query,TMS trigger 0,TMS trigger 2' ]
}

@test "points are balls, for query and batch" {
    sphere --size 16
    printf '0 -8 0 below\n0 0 0\n0 x 0 bad\n0 0 90 far\n' >points.txt
    run -1 --separate-stderr "$CONUS" query sphere.nii.gz --pose points.txt --radius 5 --layers all --format tsv
    [ "${stderr_lines[0]}" = 'conus: points.txt:3: y: "x" is not a finite number' ]
    [[ "${stderr_lines[1]}" == 'conus: warning: points.txt: 2 of 3 points lie farther from the atlas than a quarter of its length, '* ]]
    [ "$(cell query 1)/$(cell name 1)/$(cell distance_mm 1)" = below/Sphere/3 ]
    local wanted=$output
    run -1 --separate-stderr "$CONUS" batch sphere.nii.gz --poses points.txt --radius 5 --layers all
    [ "$output" = "$wanted" ]
    run -1 --separate-stderr "$CONUS" batch sphere.nii.gz --poses points.txt
    [ "$(grep -cP '\terror\t.*y: "x" is not a finite number' <<<"$output")" -eq 1 ]
    [ "$(cut -f 2 <<<"$output" | tail -n +2 | tr '\n' ' ')" = 'area area error area ' ]
}

@test "a batch read another way is another batch" {
    sphere --size 16
    printf '1 0 0 80\n0 0 -1 0\n0 1 0 0\n0 0 0 1\n' >matrix.txt
    answers batch sphere.nii.gz --poses matrix.txt --axis -x -o rows.tsv
    answers batch sphere.nii.gz --poses matrix.txt --axis -x -o rows.tsv -q
    fails 2 'rows.tsv' batch sphere.nii.gz --poses matrix.txt -o rows.tsv
}

@test "options about the file need one" {
    sphere --size 16
    fails 2 '--axis has no effect without --pose' query sphere.nii.gz --origin 0,0,9 --toward 0,0,0 --axis +x
    fails 2 '--any-space has no effect without --pose' query sphere.nii.gz --origin 0,0,9 --toward 0,0,0 --any-space
    fails 2 '--axis: ' query sphere.nii.gz --pose a --axis w
    printf %b "$HEADER$FIRST" >poses.tsv
    fails 3 'so that no axis (+x) is to be chosen' query sphere.nii.gz --pose poses.tsv --axis +x
    fails 3 'shafts are for electrodes (BIDS: name, x, y, z, size, with tabs, in *_electrodes.tsv), not for table' query sphere.nii.gz --pose poses.tsv --along-shafts
    fails 3 'poses.tsv: ' query sphere.nii.gz --pose poses.tsv --poses-format localite
}

@test "columns that are not known are passed over, with one note, and id or name is the row's name" {
    sphere --size 16
    printf ',subject,x,y,z,tx,ty,tz,name,angl,ID\n0,"s, 1",0,0,90,0,0,0,wrong,5,first\n1,s2,0,90,0,0,0,0,wrong,5,second\n' >odd.csv
    run -0 --separate-stderr "$CONUS" query sphere.nii.gz --pose odd.csv --format tsv
    check_message 'note: odd.csv: columns passed over: "", "subject", "name", "angl" (did you mean angle?)'
    [ "$(cut -f 1 <<<"$output" | uniq | tr '\n' ' ')" = 'query first second ' ]
    answers query sphere.nii.gz --pose odd.csv --quiet --format tsv
    run -0 --separate-stderr "$CONUS" batch sphere.nii.gz --poses odd.csv
    check_message 'columns passed over'
    [ "$(cut -f 1 <<<"$output" | uniq | tr '\n' ' ')" = 'query first second ' ]
    sed -i '1s/subject/query_id/' odd.csv
    run -0 --separate-stderr "$CONUS" query sphere.nii.gz --pose odd.csv --format tsv
    check_message 'columns passed over: "", "name", "angl" (did you mean angle?), "ID"'
    [ "$(cut -f 1 <<<"$output" | uniq | tr '\n' ' ')" = 'query s, 1 s2 ' ]
    printf 'name\tx\ty\tz\tdx\tdy\tdz\nhere\t0\t0\t90\t0\t0\t-1\n' >named.tsv
    answers query sphere.nii.gz --pose named.tsv --format tsv
    [ "$(cut -f 1 <<<"$output" | uniq | tr '\n' ' ')" = 'query here ' ]
}

@test "a column with its unit in the name is the column" {
    sphere --size 16
    printf 'x,y,z,tx,ty,tz\n0,0,90,0,0,0\n' >plain.csv
    answers query sphere.nii.gz --pose plain.csv --angle 40 --format tsv
    local wanted=$output
    for name in angle_deg 'Angle (deg)' 'angle[deg]' opening_angle; do
        printf 'x_mm,Y (mm),z [mm],tx,ty,tz,%s\n0,0,90,0,0,0,40\n' "$name" >unit.csv
        answers query sphere.nii.gz --pose unit.csv --format tsv
        [ "$output" = "$wanted" ]
    done
    for name in angles_of_day angleless rectangle; do
        printf 'x,y,z,tx,ty,tz,%s\n0,0,90,0,0,0,40\n' "$name" >unit.csv
        run -0 --separate-stderr "$CONUS" query sphere.nii.gz --pose unit.csv --format tsv
        check_message "note: unit.csv: columns passed over: \"$name\""
        [[ $stderr != *'did you mean'* ]]
    done
    printf 'x (cm),y (cm),z (cm)\n0,-.8,0\n' >unit.csv
    answers query sphere.nii.gz --pose unit.csv --radius 5 --format tsv -q
    wanted=$output
    printf '0 -8 0\n' >plain.txt
    answers query sphere.nii.gz --pose plain.txt --radius 5 --format tsv -q
    [ "$output" = "$wanted" ]
}

@test "layouts of probes are said to be that, and no poses" {
    sphere --size 16
    printf '(0,384)(0 0 0 500 250 1)(1 0 0 500 250 1)\n' >probe.imro
    fails 3 'probe.imro: a table of the sites of SpikeGLX' query sphere.nii.gz --pose probe.imro
    printf 'channel_groups = {\n    0: {"channels": [0, 1]}\n}\n' >probe.prb
    fails 3 "probe.prb: a layout of a probe's channels" query sphere.nii.gz --pose probe.prb
    printf '{"specification": "probeinterface", "probes": []}' >probe.json
    fails 3 'probe.json: a probe of ProbeInterface says where contacts are on it' query sphere.nii.gz --pose probe.json
}

@test "a refusal has the file as it is to be typed, with the words that were" {
    sphere --size 16
    printf 'a,b,c\n-0.04,-0.02,0.05\n0.03,0.01,0\n0,-0.09,0\n' >abc.csv
    fails 3 'else type abc.csv,x=a,y=b,z=c,unit=m; if they are mm, abc.csv,x=a,y=b,z=c,unit=mm' \
        query sphere.nii.gz --pose abc.csv,x=a,y=b,z=c
    printf 'name,x_lps,y_lps,z_lps\nleft A,-42,-20,50\nright B,38,14,-4\n' >lps.csv # --space cannot turn these
    fails 3 'right on the left; mend x, or correct the names; only if numbers and sides are both right, type lps.csv,sides=anyway' \
        query sphere.nii.gz --pose lps.csv
}

@test "a column that is needed and misspelt is asked for, not passed over" {
    sphere --size 16
    header() { printf '%s\n0,0,90,0,0,0\n' "$1" >bad.csv; }
    header xx,y,z,tx,ty,tz
    fails 3 'only some of the columns x y z: y z, without x; columns found' query sphere.nii.gz --pose bad.csv
    header orign_x,y,z,tx,ty,tz
    fails 3 'columns found: "orign_x", "y", "z", "tx", "ty", "tz"' query sphere.nii.gz --pose bad.csv
    header x,y,z,tx,ty,t__z
    fails 3 'only some of the columns tx ty tz: tx ty, without z' query sphere.nii.gz --pose bad.csv
    header x,y,z,qw,qx,notes
    fails 3 'only some of the columns qw qx qy qz' query sphere.nii.gz --pose bad.csv
    header x,y,z,a,b,roll
    fails 3 'column "roll" beside x y z is not read: take it out if the rows are points; a direction is dx dy dz' query sphere.nii.gz --pose bad.csv
    header coil_x,coil_y,coil_z,angle,a,b
    sed -i 's/0,0,0$/7,0,0/' bad.csv
    fails 3 'column "angle" is the opening of a cone, which needs a direction' query sphere.nii.gz --pose bad.csv
    header x,y,z,tx,ty,tz,dx,dy,dz
    fails 3 'header: several directions; needed is one of tx ty tz (a target), dx dy dz, qw qx qy qz, or' \
        query sphere.nii.gz --pose bad.csv
    header id,x,y,z,id,tx
    fails 3 'header: column "id" twice' query sphere.nii.gz --pose bad.csv
    header x,,y,z,tx,ty
    fails 3 'only some of the columns tx ty tz' query sphere.nii.gz --pose bad.csv
    # Every fault at once.
    header x,y,tx,ty,id,id
    fails 3 'column "id" twice; only some of the columns x y z: x y, without z; only some of the columns tx ty tz' \
        query sphere.nii.gz --pose bad.csv
}

# A coil of SimNIBS that faces downwards from 90 mm above (-40, -20, 0), its handle towards HANDLE: x = y cross z.
# matsimnibs HANDLE_X HANDLE_Y: y = (hx, hy, 0), z = (0, 0, -1), so x = (-hy, hx, 0).
matsimnibs() { printf '%s %s 0 -40\n%s %s 0 -20\n0 0 -1 90\n0 0 0 1\n' "-$2" "$1" "$1" "$2"; }

@test "a coil of SimNIBS over the precentral gyrus reaches it from outside, whichever way its handle goes" {
    need_aal
    printf 'x,y,z,dx,dy,dz\n-40,-20,90,0,0,-1\n' >down.csv
    answers query "$aal" --pose down.csv --angle 20 --format tsv
    [ "$(cell name 1)" = Precentral_L ]
    local wanted
    wanted=$(cut -f 1-8 <<<"$output")
    for handle in '0 1' '0.6 0.8' '0.8 0.6'; do
        # shellcheck disable=SC2086 # two numbers
        matsimnibs $handle >coil.txt
        answers query "$aal" --pose coil.txt --poses-format simnibs --any-space --angle 20 --format tsv
        [ "$(cut -f 1-8 <<<"$output")" = "$wanted" ]
    done
    # The same 16 numbers alone are a matrix, which points along -z: away from the brain.
    run -0 --separate-stderr "$CONUS" query "$aal" --pose coil.txt --angle 20 --format tsv
    [ "$(cell name 1)" = unassigned ]
    [[ "$stderr" == *'looking the other way (--axis, or the signs of dx dy dz) it would hit Precentral_L first' ]]
}

@test "coils and contacts of other labs pass through every command" {
    sphere --size 16
    for file in simnibs.mat invesalius.mkss markers.tsv; do
        run -1 --separate-stderr "$CONUS" query sphere.nii.gz --pose "$SAMPLES/$file" --format tsv --quiet
        local wanted=$output
        [ "$(wc -l <<<"$wanted")" -ge 4 ]
        run -1 --separate-stderr "$CONUS" batch sphere.nii.gz --poses "$SAMPLES/$file" --format tsv --quiet
        [ "$output" = "$wanted" ]
        run -1 --separate-stderr "$CONUS" batch sphere.nii.gz --poses - --format tsv --quiet <"$SAMPLES/$file"
        [ "$output" = "$wanted" ]
        run -1 --separate-stderr "$CONUS" sweep sphere.nii.gz --pose "$SAMPLES/$file" --angles 10,20 --format tsv --quiet
        [ "$(cell query 1)" = "$(cut -f 1 <<<"$wanted" | sed -n 2p)" ]
    done
    answers query sphere.nii.gz --pose "$SAMPLES/lead-dbs.mat" --radius 2 --format tsv -q
    [ "$(cut -f 1 <<<"$output" | tail -n +2 | uniq | paste -sd ' ')" = 'R1 R2 R3 R4 L1 L2' ]
    local wanted=$output
    run -0 --separate-stderr "$CONUS" batch sphere.nii.gz --poses "$SAMPLES/lead-dbs.mat" --radius 2
    [ "$output" = "$wanted" ]
    [[ "$stderr" == *'reco.mni'* ]]
}

@test "heads of subjects are refused for a template, contacts in MNI space are not" {
    need_aal
    fails 3 'simnibs.mat: positions are in "SimNIBS head model", the atlas in another space' \
        query "$aal" --pose "$SAMPLES/simnibs.mat"
    fails 3 'invesalius.mkss: positions are in "InVesalius world", the atlas in another space' \
        query "$aal" --pose "$SAMPLES/invesalius.mkss"
    fails 3 'lead-dbs.mat: positions are in "Lead-DBS scrf", the atlas in another space' \
        batch "$aal" --poses "$SAMPLES/lead-dbs.mat" --poses-format lead-dbs-native --radius 2
    answers query "$aal" --pose "$SAMPLES/lead-dbs.mat" --radius 2 --format tsv -q
    # ... unless the atlas was moved to the subject: here by 5 mm to the right.
    printf '1 0 0 5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n' >right.txt
    matsimnibs 0 1 >coil.txt
    answers query "$aal" --pose coil.txt --poses-format simnibs --atlas-transform right.txt --angle 20 --format tsv -q
    [ "$(cell name 1)" = Precentral_L ]
}

@test "MATLAB's level 7.3 is read as level 5, and says what it is not" {
    [ -x "${CONUS_HDF5:-${CONUS%/*}/conus-hdf5}" ] || skip 'no conus-hdf5'
    /usr/bin/python3 "$BATS_TEST_DIRNAME/hdf5.py" lead-dbs lead.mat || skip "no python3-h5py"
    /usr/bin/python3 "$BATS_TEST_DIRNAME/hdf5.py" simnibs coil.mat
    /usr/bin/python3 "$BATS_TEST_DIRNAME/hdf5.py" table table.mat
    sphere --size 16
    answers batch sphere.nii.gz --poses lead.mat --radius 1 --format tsv -q
    [ "$(cut -f 1 <<<"$output" | uniq)" = $'query\nR1\nR2\nR3\nR4' ]
    starts_once query sphere.nii.gz --pose lead.mat --radius 1
    answers batch sphere.nii.gz --poses - --radius 1 --format tsv -q --poses-format lead-dbs-native <lead.mat
    [ "$(cut -f 1 <<<"$output" | uniq)" = $'query\nR1\nR2\nR3\nR4' ]
    answers batch sphere.nii.gz --poses coil.mat --angle 20 --format tsv -q
    [ "$(cut -f 1 <<<"$output" | uniq)" = $'query\nM1 left\nhäufig' ]
    fails 3 'table.mat: reco: an object (table), a structure is needed' \
        query sphere.nii.gz --pose table.mat --poses-format lead-dbs --radius 1
    head -c 2000 coil.mat >cut.mat
    fails 3 'cut.mat: HDF5: cannot open it: ' query sphere.nii.gz --pose cut.mat --angle 20
    CONUS_HDF5=$PWD/none fails 3 'CONUS_HDF5' query sphere.nii.gz --pose coil.mat --angle 20
}

@test "lists of other programs: a cap on the head of MNI, tkRAS, and what is no list of positions" {
    local points=$BATS_TEST_DIRNAME/../corpus/points
    sphere --size 16
    answers query sphere.nii.gz --pose "$points/cap-mni.elc" --radius 200 --format tsv -q
    [ "$(cell query 1)" = LPA ]
    run -0 --separate-stderr "$CONUS" query sphere.nii.gz --pose "$points/cap-mni.elc" --radius 200 --format tsv
    [[ "$stderr" == *'a cap that names no space; taken as MNI 152'* ]]
    fails 3 'cap-nose.elc: a cap that names no space, and does not lie on the head of MNI 152' \
        query sphere.nii.gz --pose "$points/cap-nose.elc" --radius 200
    fails 3 'whereami.txt: AFNI' query sphere.nii.gz --pose "$points/whereami.txt" --radius 200
    answers query sphere.nii.gz --pose "$points/3dclust-rai.1D" --poses-format list --radius 200 --format tsv -q
    answers query sphere.nii.gz --pose - --radius 200 --format tsv -q <"$points/3dclust-rai.1D"
}

@test "a position without a normal has no place off the scalp, and no nan in the table" {
    run -0 "$CONUS" positions F9 C3 --out 10
    [[ "${lines[3]}" == F9* && "${lines[4]}" == C3* && "$output" != *nan* ]]
    run -0 "$CONUS" positions F9 --out 10 --format tsv
    [[ "${lines[1]}" == F9$'\t'n/a$'\t'n/a$'\t'n/a* ]]
}
