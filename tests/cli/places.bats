#!/usr/bin/env bats
# Places: points by numbers as people paste them, by areas and by positions of a cap, as a user types them.
load helpers

AAL=/usr/share/mricron/templates/aal.nii.gz

# first_line ARGUMENT...: the first line of the answer.
first_line() {
    "$CONUS" query "$@" -q 2>/dev/null | grep -v "^warning: " | grep -m 1 .
}

@test "numbers are read as they are pasted, and give the same answer" {
    conus phantom sphere -o .
    local plain
    plain=$(conus query sphere.nii.gz --point=-5,3,7 --radius 4 --format tsv -q)
    for place in '-5 3 7' '(-5, 3, 7)' '−5; 3; 7 mm' 'x = -5, y = 3, z = 7' '5L 3A 7S' 'MNI -5.0, 3, 7' '-5,0 3,0 7,0'; do
        [ "$(conus query sphere.nii.gz --point="$place" --radius 4 --format tsv -q)" = "$plain" ] || { echo "$place"; return 1; }
    done
    [ "$(conus query sphere.nii.gz --point -5 3 7 --radius 4 --format tsv -q)" = "$plain" ]
    [ "$(first_line sphere.nii.gz --point=-5,3,7)" = "$(first_line sphere.nii.gz --point -5,3,7)" ]
    [[ $(first_line sphere.nii.gz --point=-5,3,7) == "point ("* ]]
    [ "$(conus query sphere.nii.gz --origin 0 -90 0 --toward 0,0,0 --format tsv -q)" = \
        "$(conus query sphere.nii.gz --origin=0,-90,0 --toward 0 0 0 --format tsv -q)" ]
    [ "$(first_line sphere.nii.gz --origin 0 -90 0 --toward 0,0,0)" = 'origin (0.0, -90.0, 0.0)' ]
}

@test "a place that means nothing, or several things, is refused before anything is written" {
    conus phantom sphere -o .
    printf '1 2 3\n' >points.txt
    fails 2 '--point: "1 2 3 4": "4" is a number too many' query sphere.nii.gz --point '1 2 3 4' -o a.tsv
    fails 2 '"-42,5,12,0,30,1": "0" is a number too many; where commas are decimal, blanks or semicolons stand between' \
        query sphere.nii.gz --point '-42,5,12,0,30,1'
    fails 2 '"-1,250" has a comma before three digits' query sphere.nii.gz --point '-1,250 2 3' -o a.tsv
    fails 2 '"foo" is no number, sign or known word' query sphere.nii.gz --point 'foo 1 2 3' -o a.tsv
    fails 2 'it has two numbers, a point has three' query sphere.nii.gz --point 1,2
    fails 2 '"1L 2P 3S": letters L R A P S I are RAS, but numbers are lps here' \
        query sphere.nii.gz --point '1L 2P 3S' --space lps
    fails 2 '--origin: no area has the name, abbreviation or label "Sphera"; did you mean "Sphere"?' \
        query sphere.nii.gz --origin Sphera --toward 0,0,0
    fails 2 '--toward: Sphere lies on both sides: 16.78 cm3 left, 16.78 cm3 right; type --hemispheres split, and as the name "Sphere left" or "Sphere right"' \
        query sphere.nii.gz --origin 0,-90,0 --toward Sphere
    fails 2 'near: is nearest to the other end, which is no near: then' \
        query sphere.nii.gz --origin near:Sphere --toward near:Sphere
    fails 2 'the other end of an axis, which is a place of its own; there is none' query sphere.nii.gz --point near:Sphere
    fails 2 'points.txt is a file; --pose points.txt asks about its points and poses' query sphere.nii.gz --point points.txt
    fails 2 'unknown option --points; did you mean --pose?' query sphere.nii.gz --points points.txt
    fails 2 'the place is empty' query sphere.nii.gz --point ' '
    fails 2 'C3 is a position on the head of MNI 152, and it is not known whether the atlas lies there; 1020:C3 says' \
        query sphere.nii.gz --point C3
    [ ! -e a.tsv ]
}

@test "a list of areas is asked where each of them would be, wherever points are read" {
    [ -e "$AAL" ] || skip "no $AAL"
    printf 'area,value\nHippocampus_L,3\nleft amygdala,4\nHippocampus,5\nHipocampus_R,6\n' >areas.csv
    printf 'Hippocampus_L\nC3\n' >areas.txt
    run -1 --separate-stderr conus query $AAL --pose areas.csv --format tsv --keep value
    [[ $stderr == *'note: areas.csv: column "area" names places: each row is the point that --point NAME means'* ]]
    [[ $stderr == *'areas.csv:4: "Hippocampus" may be any of 2: "Hippocampus_L" (37), "Hippocampus_R" (38)'* ]]
    [[ $stderr == *'areas.csv:5: no area has the name, abbreviation or label "Hipocampus_R"; did you mean "Hippocampus_R"'* ]]
    for name in Hippocampus_L 'left amygdala'; do
        [ "$(grep "^$name" <<<"$output" | cut -f 2-22)" = \
            "$(conus query $AAL --point "$name" --format tsv -q | sed -n 2p | cut -f 2-22)" ]
    done
    [ "$(cut -f 28 <<<"$output" | paste -sd ' ')" = 'value 3 4 5 6' ]
    conus query $AAL --pose areas.csv --format tsv -q --keep value >query.tsv || [ $? = 1 ]
    conus batch $AAL --poses areas.csv --keep value -q >batch.tsv || [ $? = 1 ]
    cmp query.tsv batch.tsv
    [ "$(conus query $AAL --pose areas.txt --format tsv -q | cut -f 1,4,25-27 | sed 1d | tr '\t' ' ')" = \
        $'Hippocampus_L Hippocampus_L -27 -13 -15\nC3 Postcentral_L -67.7 -11.3 61.2' ]
    conus render $AAL --pose areas.txt --size 32x32 -o a.png -q
    # An area on both sides has no point until a side is said.
    printf 'area\tside\nSphere\tleft\nSphere\tn/a\nSphere right\tleft\n' >sides.tsv
    conus phantom sphere -o .
    run -1 --separate-stderr conus query sphere.nii.gz --pose sides.tsv --hemispheres split --format tsv
    [ "$(cut -f 5 <<<"${lines[1]}")" = 'Sphere left' ]
    [[ ${lines[2]} == *'"Sphere" is cut in two: "Sphere left", label 11, and "Sphere right", label 21'* ]]
    [[ ${lines[3]} == *'"Sphere right" is on the other side than "left"'* ]]
    # Coordinates win; numbers that may be some are asked about.
    printf 'name,x,y,z\nHippocampus_L,-42,-20,50\n' >both.csv
    [ "$(conus query $AAL --pose both.csv --format tsv -q | sed -n 2p | cut -f 4)" = Postcentral_L ]
    printf 'area,mean,sd,n\nHippocampus_L,1,2,3\n' >means.csv
    fails 3 "to ask at the areas of these names instead, type 'means.csv,place=area'" query $AAL --pose means.csv
    [ "$(conus query $AAL --pose means.csv,place=area --format tsv -q | sed -n 2p | cut -f 4)" = Hippocampus_L ]
}

@test "a row has a radius of its own, and points look into the head" {
    [ -e "$AAL" ] || skip "no $AAL"
    printf 'name,x,y,z,radius (cm)\na,-42,-20,50,0.3\nb,-42,-20,50,0\nc,-42,-20,50,\n' >radii.csv
    run -0 --separate-stderr conus query $AAL --pose radii.csv --radius 5 --format tsv
    [ "$(cut -f 1,4,28 <<<"$output" | sed 1d | grep -v unassigned | tr '\t' ' ' | paste -sd ';')" = \
        'a Postcentral_L 3;a Precentral_L 3;b Postcentral_L 0;c Postcentral_L 5;c Precentral_L 5' ]
    [ "$(conus batch $AAL --poses radii.csv --radius 5 -q)" = "$output" ]
    for radius in 3 5; do
        grep -P "^[ac]\t.*\t$radius$" <<<"$output" | cut -f 2-22 >own.tsv
        conus query $AAL --point=-42,-20,50 --radius $radius --format tsv -q | sed 1d | cut -f 2-22 | cmp - own.tsv
    done
    conus query $AAL --pose radii.csv --format json -q |
        jq -e '.Understood == "asked as points in the atlas'"'"'s space: what is within each row'"'"'s radius of it"' >/dev/null
    fails 2 '--angle' batch $AAL --poses radii.csv --radius 5 --angle 5
    fails 3 'column "radius (cm)" is that of a ball, but rows point into the head' batch $AAL --poses radii.csv --inward
    # Each as by --origin.
    printf 'Cz\nC3\nNz\n' >cap.txt
    printf 'name,x,y,z\nside,-90,0,0\n' >side.csv
    run -1 --separate-stderr conus batch $AAL --poses cap.txt --inward --angle 20
    [[ $stderr == *'2 rows point into the head, by positions of a cap'* ]]
    [ "$(grep -P '^C3\t' <<<"$output" | cut -f 2-)" = \
        "$(conus query $AAL --origin C3 --inward --angle 20 --format tsv -q | sed 1d | cut -f 2-)" ]
    [[ $(grep -P '^Nz\t' <<<"$output") == *'the table of positions has no normal for it'* ]]
    run -0 --separate-stderr conus query $AAL --pose side.csv --inward --angle 20 --format tsv
    [[ $stderr == *"1 row points into the head, by the atlas's convex hull"* ]]
    [ "$(sed 1d <<<"$output" | cut -f 2-)" = \
        "$(conus query $AAL --origin=-90,0,0 --inward --angle 20 --format tsv -q | sed 1d | cut -f 2-)" ]
}

@test "a list whose names are areas elsewhere is warned of, by file and pipe" {
    [ -e "$AAL" ] || skip "no $AAL"
    local warned='3 points are called as areas of the atlas, and half of them lie 57 mm or more from there (Insula_L in'
    printf 'name,x,y,z\nHippocampus_L,-27,-13,-15\nPrecentral_L,-40,-5,50\nInsula_L,-36,6,2\n' >good.csv
    sed 's/,-/,/' good.csv >far.csv
    run -0 --separate-stderr conus query "$AAL" --pose good.csv
    [[ $stderr != *warning* ]]
    run -0 --separate-stderr conus batch "$AAL" --poses good.csv
    [[ $stderr != *warning* ]]
    run -0 --separate-stderr conus query "$AAL" --pose far.csv,sides=anyway -q --format json
    [[ $stderr == "conus: warning: far.csv,sides=anyway: $warned"* ]]
    [[ $(jq -r '.Warnings[0]' <<<"$output") == *"$warned"* ]]
    run -0 --separate-stderr conus batch "$AAL" --poses far.csv,sides=anyway -q -o far.tsv
    [[ $stderr == "conus: warning: far.csv,sides=anyway: $warned"* ]]
    [[ $(jq -r '.Warnings[0]' far.json) == *"$warned"* ]]
    run -0 --separate-stderr conus batch "$AAL" --poses - -q < <(
        printf 'name,x,y,z\nHippocampus_L,-20,60,30\nPrecentral_L,-20,-80,-20\nInsula_L,-30,-70,40\n'
    )
    [[ $stderr == *'warning: standard input: 3 points are called as areas'* ]]
}

@test "a file called left whose points lie on the right is warned of" {
    [ -e "$AAL" ] || skip "no $AAL"
    local warned='its name says left, and 3 of 4 points lie on the right; is x mirrored?'
    printf 'x,y,z\n40,1,2\n42,-20,3\n38,5,6\n-30,5,6\n' >e8_LEFT.csv
    sed 's/^40/-40/' e8_LEFT.csv >half-left.csv
    cp e8_LEFT.csv script_L.csv
    run -0 --separate-stderr conus query "$AAL" --pose e8_LEFT.csv -q --format json
    [[ $stderr == "conus: warning: e8_LEFT.csv: $warned"* ]]
    [[ $(jq -r '.Warnings[0]' <<<"$output") == *"$warned"* ]]
    sed '1d; s/,/ /g; s/.*/(&)/; s/ /, /g' e8_LEFT.csv >lh.txt
    run -0 --separate-stderr conus batch "$AAL" --poses lh.txt -q
    [[ $stderr == "conus: warning: lh.txt: $warned"* ]]
    for fine in e8_LEFT.csv,sides=anyway half-left.csv script_L.csv; do
        run -0 --separate-stderr conus query "$AAL" --pose "$fine" -q
        [ -z "$stderr" ]
    done
}

@test "an area is its inner point, which is said, recorded and asked again" {
    conus phantom brain -o .
    [ "$(first_line brain.atlas.json --point 'left anterior' --radius 3)" = \
        'point Anterior left: (-15.0, 25.0, 15.0), 15.3 mm inside' ]
    [ "$(first_line brain.atlas.json --point 'left anterior' --radius 3 --only Core)" = \
        'point Anterior left: (-15.0, 25.0, 15.0), 15.3 mm inside' ]
    [ "$(first_line brain.atlas.json --point 'left anterior' --radius 3 --space lps)" = \
        'point Anterior left: (15.0, -25.0, 15.0), 15.3 mm inside' ]
    run -0 --separate-stderr conus query brain.atlas.json --origin=-90,30,20 --toward 'left anterior' -o a.tsv
    [[ $stderr == *'note: toward Anterior left: (-15.0, 25.0, 15.0), 15.3 mm inside'* ]]
    [ "$(jq -c '.Places[0] | [.option, .words, .is, .name, (.at | map(round))]' a.json)" = \
        '["toward","left anterior","inner point","Anterior left",[-15,25,15]]' ]
    conus verify a.tsv
    sed 's/"inner point"/"own point"/' a.json >b.json
    cp a.tsv b.tsv
    run -1 --separate-stderr conus verify b.tsv
    [[ "$output$stderr" == *'Checksum does not fit'* ]]
    sed -i 's/"left anterior"/"left lateral"/' a.json
    run --separate-stderr conus verify a.tsv
    [ "$status" -ne 0 ]
    # As if its point had been typed.
    diff <(conus query brain.atlas.json --origin=-90,30,20 --toward=-15,25,15 --format csv -q) \
        <(conus query brain.atlas.json --origin=-90,30,20 --toward 'Anterior (left)' --format csv -q)
}

@test "--point may be repeated, and is answered in order" {
    conus phantom sphere -o .
    run -0 conus query sphere.nii.gz --point 0,-23,0 --point 30,0,0 --radius 5 --format csv -q
    [ "$(cut -d, -f1 <<<"$output" | uniq | paste -sd' ')" = 'query 1 2' ]
    fails 2 '--mask shows one pose, --point is given 2 times' \
        query sphere.nii.gz --point 0,-23,0 --point 30,0,0 --radius 5 --mask m.nii
}

@test "positions of a cap, and areas of a real atlas" {
    [ -f $AAL ] || skip 'no mricron-data'
    [ "$(first_line $AAL --point C3)" = 'point position C3: (-67.7, -11.3, 61.2)' ]
    [ "$(first_line $AAL --point T3)" = 'point position T7: (-82.4, -16.9, -9.3)' ]
    [ "$(first_line $AAL --origin C3 --toward Hippocampus_L)" = 'origin position C3: (-67.7, -11.3, 61.2)' ]
    [ "$(conus query $AAL --origin C3 --toward Hippocampus_L -q | sed -n 2p)" = \
        'toward Hippocampus_L: (-27.0, -13.0, -15.0), 6.0 mm inside' ]
    [[ $(conus query $AAL --origin C3 --toward near:Precentral_L -q | sed -n 2p) == 'toward nearest in Precentral_L: '* ]]
    [ "$(conus query $AAL --origin C3 --toward Hippocampus_L --segments - -q | head -n 1)" = \
        'origin position C3: (-67.7, -11.3, 61.2)' ]
    fails 2 '"hippocampus" may be any of 2: "Hippocampus_L" (37), "Hippocampus_R" (38)' query $AAL --point hippocampus
    fails 2 'Or a 10-20 position, as C3' query $AAL --point Hippo
    # Inwards from C3, whose normal in the table is (-0.815, 0.177, 0.552).
    local inward=$(conus query $AAL --origin C3 --inward --angle 20 --format tsv -q)
    [ "$inward" = "$(conus query $AAL --origin C3 --direction 0.815,-0.177,-0.552 --angle 20 --format tsv -q)" ]
    conus render $AAL --origin C3 --inward --size 64x64 -q -o a.png
    fails 2 'the table of positions has no normal for Nz' query $AAL --origin Nz --inward
    fails 2 '--inward: (-27.0, -13.0, -15.0): it lies in the hull of the atlas' query $AAL --origin Hippocampus_L --inward
    fails 2 '--context has no effect without --context-blocks' query $AAL --context ch2 --origin 0,0,90 \
        --direction 0,0,-1
    fails 2 '--inward and --toward exclude each other' query $AAL --origin C3 --inward --toward C4
    fails 2 '--inward has no effect without --origin' query $AAL --inward
    # A beam, too, has places, and so has a range that ends at one.
    run -0 --separate-stderr conus query $AAL --focus Thalamus_L --transducer C3 --aperture-diameter 60 -q
    [ "${lines[0]}" = 'focus Thalamus_L: (-11.0, -17.0, 8.0), 9.1 mm inside' ]
    [ "${lines[1]}" = 'transducer position C3: (-67.7, -11.3, 61.2)' ]
    [[ ${lines[3]} == 'cone of 42.1 degrees, 0 to 77.96 mm deep, from (-11.00, -17.00, 8.00) along '* ]]
    run -0 conus query $AAL --origin C3 --toward Hippocampus_L --range 0,target --radius 1 --segments - --format tsv -q
    [ "$(tail -1 <<<"$output" | cut -f 5,13-15 | tr '\t' ' ')" = 'Hippocampus_L -27 -13 -15' ]
}

@test "the way into the head is against the context's, or to the atlas" {
    [ -f $AAL ] || skip 'no mricron-data'
    run -0 --separate-stderr conus query $AAL --origin=-90,0,0 --inward --format json -q
    [ "$(jq -r .Understood <<<"$output")" = "inward to the nearest point of the atlas's convex hull" ]
    run -0 --separate-stderr conus query $AAL --origin=-67.7,-11.3,61.2 --inward --context ch2 --angle 20
    [ "${lines[0]}" = "inward against the normal of the head in the context's image within 5 mm" ]
    [[ ${lines[1]} == 'cone of 20 degrees from (-67.70, -11.30, 61.20) along (0.8'*', -0.'*', -0.'*'), RAS mm' ]]
    # It blocks no rays.
    local ask="$AAL --origin=-67.7,-11.3,61.2 --angle 20 -q"
    local along=$(conus query $ask --inward --context ch2 --format json |
        jq -r '[.Queries[0].world_from_device_ras[:3][][2] | -.] | map(tostring) | join(",")')
    [ "$(conus query $ask --inward --context ch2 --format tsv | cut -f 2-9)" = \
        "$(conus query $ask --direction="$along" --format tsv | cut -f 2-9)" ]
    run -0 --separate-stderr conus query $AAL --origin=-67.7,-11.3,61.2 --inward --format tsv
    [[ $stderr == *"note: inward to the nearest point of the atlas's convex hull"* ]]
    run -0 --separate-stderr conus render $AAL --origin=-90,0,0 --inward --size 64x64 -o a.png
    [[ $stderr == *"note: inward to the nearest point of the atlas's convex hull"* ]]
}

@test "pictures and pages take places, and say how they were understood" {
    conus phantom brain -o .
    run -0 --separate-stderr conus render brain.atlas.json --origin=-90,30,20 --toward 'left anterior' \
        --camera-origin 0,0,300 --camera-toward Core --size 64x64 -o a.png
    [[ $stderr == *'note: toward Anterior left: (-15.0, 25.0, 15.0), 15.3 mm inside'* ]]
    [[ $stderr == *'note: camera-toward Core: '* ]]
    conus render brain.atlas.json --cuts axial --at Core -o cut.png -q
    conus render brain.atlas.json --cuts axial --at 3,-14,10 -o same.png -q
    /usr/bin/python3 - <<'END'
import OpenImageIO as oiio
import numpy as np
a, b = (np.array(oiio.ImageBuf(name).get_pixels(oiio.UINT8)) for name in ("cut.png", "same.png"))
assert a.shape == b.shape and (a == b).all()
END
    printf '<html>\n<!-- atlas -->\n</html>\n' >template.html
    run -0 --separate-stderr conus page brain.atlas.json --origin=-90,30,20 --toward 'left anterior' \
        --template template.html -o page.html
    [[ $stderr == *'note: toward Anterior left: (-15.0, 25.0, 15.0), 15.3 mm inside'* ]]
    grep -q 'origin=-90,30,20&toward=-15,25,15&' <(sed 's/\\u0026/\&/g; s/&amp;/\&/g' page.html)
    fails 2 '--camera-toward: no area' render brain.atlas.json --camera-origin 0,0,300 --camera-toward Xyz -o b.png
}
