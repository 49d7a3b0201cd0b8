#!/usr/bin/env bats
# conus pack: the same answers from one file, and what it says of itself.

load helpers

AIM='--origin 0,-100,5 --toward 0,0,10 --angle 20'

# same_answers PACK ATLAS [OPTION...]: packs ATLAS with the options, and asks both.
same_answers() {
    local pack=$1
    shift
    answers pack "$@" -o "$pack" --quiet
    printf 'query_id\tx\ty\tz\ttx\tty\ttz\na\t0\t-100\t5\t0\t0\t10\nb\t90\t1\t2\t0\t3\t4\n' >poses.tsv
    for ask in "query $AIM --layers all --format tsv" "query $AIM --format table" "batch --poses poses.tsv" 'info --format tsv' \
        'info --format tree'; do
        read -ra words <<<"$ask"
        run --separate-stderr "$CONUS" "${words[0]}" "$@" "${words[@]:1}"
        local code=$status from_files=$output said=$stderr
        [ "$code" -le 1 ]
        run -"$code" --separate-stderr "$CONUS" "${words[0]}" "$pack" "${words[@]:1}"
        diff <(echo "$from_files") <(echo "$output")
        [ "${words[0]}" != query ] || diff <(echo "$said") <(echo "$stderr")
    done
}

@test "answers from a pack are those from the files: labels, maps, surfaces, bundles, contexts" {
    "$CONUS" phantom nested -o .
    "$CONUS" phantom sphere -o sphere --size 24
    "$CONUS" phantom brain -o brain
    "$CONUS" phantom bundle -o bundle
    same_answers a.conus nested.nii.gz
    same_answers b.conus nested.nii.gz --pathway sphere/sphere.nii.gz,threshold=0.5,name=S \
        --streamlines bundle/bundle.tck
    same_answers c.conus brain/brain.atlas.json
    same_answers d.conus bundle/bundle.atlas.json
    printf '1 0 0 7\n0 1 0 0\n0 0 1 0\n0 0 0 1\n' >right.txt
    same_answers e.conus nested.nii.gz --atlas-transform right.txt
    /usr/bin/python3 - <<'EOF'
import nibabel, numpy
field = numpy.zeros((9, 9, 9, 1, 3), "f4")
field[..., 0, 0] = 3 * numpy.sin(numpy.arange(9))[:, None, None]
image = nibabel.Nifti1Image(field, numpy.array([[16, 0, 0, -64], [0, 16, 0, -64], [0, 0, 16, -64], [0, 0, 0, 1.]]))
image.header.set_intent(1007)
nibabel.save(image, "field.nii.gz")
EOF
    same_answers h.conus nested.nii.gz --atlas-transform field.nii.gz
    printf 'index\tname\tparent\n1\tOuter\t9\n2\tInner\t9\n9\tAll\t0\n' >tree.tsv
    same_answers f.conus nested.nii.gz --labels tree.tsv
    # What is asked of an atlas is asked of a pack.
    answers pack sphere/sphere.nii.gz -o g.conus
    for words in '--only 1' '--hemispheres split' '--sides exchanged'; do
        answers query sphere/sphere.nii.gz $AIM $words --format tsv --quiet
        was=$output
        answers query g.conus $AIM $words --format tsv --quiet
        [ "$output" = "$was" ]
    done
    run -0 --separate-stderr "$CONUS" query b.conus --atlas a.conus $AIM --format tsv
}

@test "info says what a pack is, and what became of its sources" {
    "$CONUS" phantom sphere -o . --size 24
    answers pack sphere.nii.gz -o s.conus
    sum=$(tail -c +4097 s.conus | sha256sum | cut -d ' ' -f 1)
    answers info s.conus
    [[ "$output" == *"file         s.conus"*"size         $(wc -c <s.conus) bytes"*"sha256       $sum"* ]]
    [[ "$output" == *"conus pack sphere.nii.gz -o s.conus"*'same         sphere.nii.gz'* ]]
    answers info s.conus --format json
    [ "$(jq -c '.pack | [.path, .sha256, .words, [.sources[].state]]' <<<"$output")" = \
        "[\"s.conus\",\"$sum\",\"conus pack sphere.nii.gz -o s.conus\",[\"same\",\"same\"]]" ]
    mkdir other
    mv s.conus sphere.* other
    answers info other/s.conus --format json
    [ "$(jq -c '[.pack.sources[].state]' <<<"$output")" = '["same","same"]' ]
    echo '# more' >>other/sphere.tsv
    run -0 --separate-stderr "$CONUS" query other/s.conus $AIM --format tsv
    [[ "$stderr" == *'warning: other/s.conus was packed from sphere.tsv, which has changed since; pack it again: conus pack sphere.nii.gz -o s.conus'* ]]
    rm other/sphere.nii.gz
    answers info other/s.conus --format json
    [ "$(jq -c '[.pack.sources[].state] | sort' <<<"$output")" = '["changed","not there"]' ]
}

@test "a sidecar names the pack, and verify asks it again" {
    "$CONUS" phantom sphere -o . --size 24
    answers pack sphere.nii.gz -o s.conus
    answers query s.conus $AIM -o rows.tsv
    sum=$(tail -c +4097 s.conus | sha256sum | cut -d ' ' -f 1)
    [ "$(jq -c .Atlas.pack rows.json)" = "{\"path\":\"s.conus\",\"sha256\":\"$sum\",\"bytes\":$(wc -c <s.conus)}" ]
    [ "$(jq -r '.Atlas.volumes[0].path' rows.json)" = sphere.nii.gz ]
    rm sphere.nii.gz sphere.tsv # a pack needs none
    run -0 --separate-stderr "$CONUS" verify rows.tsv
    mv s.conus data # a link's name says what it is
    ln -s data s.conus
    run -0 --separate-stderr "$CONUS" verify rows.tsv
    printf 'x' | dd of=s.conus bs=1 seek=30000 conv=notrunc status=none
    run --separate-stderr "$CONUS" verify rows.tsv
    [ "$status" -ne 0 ]
    [[ "$output$stderr" == *s.conus* ]]
}

@test "a pack is refused where it cannot be, with the way on; a damaged one with the place" {
    "$CONUS" phantom sphere -o . --size 24
    answers pack sphere.nii.gz -o s.conus
    for words in '--pathway s.conus' '--streamlines s.conus' '--context s.conus --context-blocks 1' '--atlas-transform s.conus'; do
        run -3 --separate-stderr "$CONUS" query sphere.nii.gz $AIM $words
        [[ "$stderr" == *'s.conus'*'a pack'*'give it as ATLAS'* ]]
    done
    echo '{"conus_atlas": 1, "parcellation": {"file": "s.conus"}}' >m.atlas.json
    run -3 --separate-stderr "$CONUS" info m.atlas.json
    [[ "$stderr" == *'a pack'* ]]
    run -2 --separate-stderr "$CONUS" pack s.conus -o t.conus
    [[ "$stderr" == *'is a pack already: pack what it was packed from'* ]]
    run -2 --separate-stderr "$CONUS" pack sphere.nii.gz -o s.nii
    run -2 --separate-stderr "$CONUS" pack sphere.nii.gz -o s.conus
    [[ "$stderr" == *--force* ]]
    run -2 --separate-stderr "$CONUS" query s.conus --labels sphere.tsv $AIM
    [[ "$stderr" == *'give it when packing'* ]]
    printf '<html>\n<!-- atlas -->\n' >page.html
    run -3 --separate-stderr "$CONUS" page s.conus --template page.html -o p.html
    [[ "$stderr" == *'needs the files that it was packed from: sphere'* ]]
    head -c 5000 s.conus >cut.conus
    run -3 --separate-stderr "$CONUS" info cut.conus
    [[ "$stderr" == *'cut.conus: found 5000 bytes, its head says'* ]]
    printf 'x' | dd of=s.conus bs=1 seek=30000 conv=notrunc status=none
    run -3 --separate-stderr "$CONUS" info s.conus
    [[ "$stderr" == *'s.conus: is damaged between the bytes 4096 and'*'pack it again: conus pack sphere.nii.gz -o s.conus'* ]]
}

@test "conus atlases lists packs, and their names stand for them" {
    "$CONUS" phantom sphere -o . --size 24
    mkdir places
    answers pack sphere.nii.gz -o places/mine.conus
    export CONUS_ATLAS_PATH=$PWD/places
    answers atlases --format tsv
    grep -qP '^mine\town\tpack\t' <<<"$output"
    answers query mine $AIM --format tsv --quiet
    was=$output
    answers query sphere.nii.gz $AIM --format tsv --quiet
    [ "$output" = "$was" ]
}
