#!/usr/bin/env bats
# conus cite: the paragraph describes the query that was asked, and nothing else.
load helpers

# cites RESULT [OPTION...]: the paragraph about it, on one line.
cites() {
    answers cite "$@"
    output=$(tr '\n' ' ' <<<"$output")
}

scene() {
    conus phantom nested -o . --size 24 --spacing 3,3,3
    conus phantom slabs -o . --size 16 --spacing 4,4,4
    printf 'query_id\tx\ty\tz\ttx\tty\ttz\tangle\n1\t0\t100\t0\t0\t0\t0\t5\n2\t0\t0\t0\t0\t0\t0\tn/a\n3\t-90\t9\t9\t0\t0\t0\tn/a\n' >poses.tsv
}
aim='--origin 0,-100,0 --toward 0,0,0 --angle 30 -q'
METHOD='T. Rick, A. von Kapri, T. Kuhlen: GPU Implementation of 3D Object Selection by Conic Volume Techniques in Virtual Environments. IEEE Virtual Reality 2010, pp. 243–246.'

@test "the method is the one of README.md, and so is its DOI" {
    scene
    conus query nested.nii.gz $aim -o a.tsv
    cites a.tsv
    has "$METHOD https://doi.org/10.1109/VR.2010.5444783"
    tr -d '>\n' <"$BATS_TEST_DIRNAME/../../README.md" | tr -s ' ' | grep -qF "$METHOD"
    answers cite a.tsv --format bibtex
    has 'doi = {10.1109/VR.2010.5444783}'
    grep -qF 'https://doi.org/10.1109/VR.2010.5444783' "$BATS_TEST_DIRNAME/../../README.md"
    has "version = {$(conus --version | cut -d ' ' -f 2)}"
    has "SHA-256 $(sha256sum nested.nii.gz | cut -d ' ' -f 1)}"
}

@test "cones, cylinders, balls, layers, scores" {
    scene
    conus query nested.nii.gz $aim --range 70,95 -o a.tsv
    cites a.tsv
    has 'a cone about the device'"'"'s axis, with its apex at the device'"'"'s position and a full opening angle of 30°, were determined for one pose'
    has 'filled with 3228 rays, one through the centre of each pixel in the round aperture of 64 × 64 pixels'
    has 'two depths along the axis counted: 70 mm and 95 mm'
    has 'to the first object that it hits'
    has 'ranked by their share.'
    [[ "$output" != *Occluded* && "$output" != *cylinder* && "$output" != *Sobol* && "$output" != *pathway* && "$output" != *120°* ]]
    conus query nested.nii.gz $aim --aperture square --resolution 40 --score centre --layers all --hide Core -o b.tsv
    cites b.tsv
    has 'a square pyramid'
    has '1600 rays, one through the centre of each pixel of 40 × 40.'
    has 'through all objects'
    has 'Occluded objects counted'
    has 'by the score centre (Eq. 12'
    has 'as if they were not there, by label: areas 4000000001.'
    conus query nested.nii.gz --origin 0,-100,0 --toward 0,0,0 -q --radius 4 --layers all -o c.json
    cites c.json
    has 'a cylinder with a radius of 4 mm'
    has 'parallel rays'
    has 'cross-section'
    [[ "$output" != *cone* && "$output" != *"opening angle"* ]]
    conus query nested.nii.gz --point 0,-23,0 --radius 5 -q -o d.tsv
    cites d.tsv
    has 'a ball with a radius of 5 mm were determined for one point'
    [[ "$output" != *ray* && "$output" != *Rick* && "$output" != *cone* ]]
    printf 'x\ty\tz\tdx\tdy\tdz\tfar\n0\t-100\t0\t0\t1\t0\t95\n' >far.tsv
    conus query nested.nii.gz --pose far.tsv -q -o far.rows.tsv
    cites far.rows.tsv
    has 'two depths along the axis counted: 0 mm and 95 mm from the apex.'
    conus query nested.nii.gz --origin 0,-100,0 --toward 0,0,0 --angle 150 -q -o e.tsv
    cites e.tsv
    has 'evenly spread in angle where it opens beyond 120°'
    conus query nested.nii.gz $aim --sampling slices --slices 90 --slice-fraction 0.29 -o f.tsv
    cites f.tsv
    has 'planes across the view: 26 of 90; thinner objects can be missed'
    [[ "$output" != *exactly* ]]
}

@test "poses, batches, sweeps, tracks and regions" {
    scene
    run -1 conus query nested.nii.gz --pose poses.tsv --angle 7 -q -o a.tsv
    cites a.tsv
    has 'of 5° to 7°, depending on the pose, were determined for each of 3 poses of the device (1 of them had no answer)'
    run -1 conus batch nested.nii.gz --poses poses.tsv --summary -q -o b.tsv
    cites b.tsv
    has 'of 10°, or the pose'"'"'s own where the file gives one, were determined for each of 3 poses of the device (1 of them'
    has 'the object that ranks first, the runner-up and the difference of their scores'
    conus sweep nested.nii.gz $aim -o c.tsv
    cites c.tsv
    has 'The least full opening angle at which a cone'
    has 'was determined, up to 30°, for one pose'
    [[ "$output" != *Rick* && "$output" != *rays* && "$output" != *share* ]]
    conus sweep nested.nii.gz --origin 0,-100,0 --toward 0,0,20 --angles 5:15:5 -q -o d.tsv
    cites d.tsv
    has 'the full opening angles of 5°, 10° and 15°, were determined for one pose'
    conus sweep nested.nii.gz $aim --jitter 3,2 --samples 64 -o e.tsv
    cites e.tsv
    has 'from 64 poses about each given one, drawn from a Sobol sequence'
    has '3° of tilt about each of two axes and 2 mm of position along each of three'
    printf 'time_s\tx\ty\tz\ttx\tty\ttz\n0\t0\t0\t90\t0\t0\t0\n' >hand.tsv
    conus track nested.nii.gz --poses hand.tsv --score intenselect --growth 3 --delay 0.1 -q -o f.tsv
    cites f.tsv
    has 'each step of a moving device'
    has 'intenselect (Eq. 12 of conus'"'"'s documentation), with a window of 2 s'
    has 'growth 3/s'
    has 'selected 0.1 s before'
    conus overlap nested.nii.gz slabs.nii.gz --threshold 1 -q -o g.tsv
    cites g.tsv
    has 'The volume that a region of interest has in common with each area was determined'
    has 'values of at least 1'
    has 'Volumes are exact for the voxels and closed surfaces as they are'
    [[ "$output" != *cone* && "$output" != *Rick* ]]
}

@test "objects that could be hit" {
    scene
    conus query nested.nii.gz $aim --pathway slabs.nii.gz,threshold=1 --atlas slabs.nii.gz --context slabs.nii.gz \
        --context-blocks 200 -o a.tsv
    cites a.tsv
    has 'The areas and pathways in'
    has 'Voxels of slabs.nii.gz with values of at least 1 counted as a pathway.'
    has 'Voxels of slabs.nii.gz with values of at least 200 blocked the rays.'
    has 'The atlas was nested (file nested.nii.gz, SHA-256 '
    has 'Another atlas, asked by itself, was slabs'
    conus phantom bundle -o bundle
    conus query slabs.nii.gz $aim --streamlines bundle/bundle.tck -o lines.tsv
    cites lines.tsv
    has 'The areas and bundles in'
    conus overlap nested.nii.gz slabs.nii.gz --threshold 1 --streamlines bundle/bundle.tck -q -o common.tsv
    cites common.tsv
    has 'in common with each area was determined'
    printf '1 0 0 7\n0 1 0 0\n0 0 1 0\n0 0 0 1\n' >right.txt
    conus query slabs.nii.gz $aim --atlas-transform right.txt --hemispheres split -o b.tsv
    cites b.tsv
    has 'brought into the space of the positions by an affine transform'
    has 'cut in two at x = 0'
    python3 "$BATS_TEST_DIRNAME/fields.py" itk slabs.nii.gz field.nii.gz 2
    conus query slabs.nii.gz $aim --atlas-transform field.nii.gz -o c.tsv
    cites c.tsv
    has 'space of the positions by a deformation field. Its voxels were resampled by the nearest neighbour.'
    conus query slabs.nii.gz $aim --atlas-transform right.txt --atlas-transform field.nii.gz \
        --atlas-transform field.nii.gz -o d.tsv
    cites d.tsv
    has 'by several deformation fields and affine transforms. Its voxels'
    # the atlas's own header, not that of the field
    python3 - <<'END'
import gzip
head = bytearray(gzip.open("field.nii.gz").read())
head[252:256] = b"\2\0\2\0"  # qform_code and sform_code: aligned
gzip.open("aligned.nii.gz", "wb").write(head)
END
    conus query slabs.nii.gz $aim --atlas-transform right.txt,grid=nested.nii.gz --atlas-transform aligned.nii.gz -o e.tsv
    cites e.tsv
    has 'placed by its sform, code 1 (scanner), warped)'
}

# An axis has no rays: neither their method nor a share or score is described.
@test "segments and shanks" {
    scene
    conus query nested.nii.gz $aim --range 10,90 --segments rows.tsv -o cone.tsv
    conus query nested.nii.gz $aim --segments other.json -o other-cone.tsv
    conus query nested.nii.gz $aim --range 10,90 --format spikeglx -o shank
    run -1 conus batch nested.nii.gz --poses poses.tsv -q --range 10,90 --segments batch.tsv
    printf 'x\ty\tz\ttx\tty\ttz\n0\t100\t0\t0\t0\t0\n' >pose.tsv
    conus batch nested.nii.gz --poses pose.tsv -q --range 10,90 --format open-ephys --contacts 9,1,2,4 -o batch-shank
    for result in rows.tsv other.json shank batch.tsv batch-shank; do
        cites $result
        has "The areas along the device's axis, a straight line from the device's position on, were determined in order"
        has 'The axis is a geometric model'
        [[ $result == other.json || "$output" == *"counted: 10 mm and 90 mm from the device's position."* ]]
        [[ "$output" != *Rick* && "$output" != *cone* && "$output" != *ray* && "$output" != *share* && "$output" != *score* ]]
    done
    cites cone.tsv
    has Rick
    conus query nested.nii.gz --origin 0,-100,0 --toward 0,0,0 --radius 0.5 --clearance near.tsv,within=3 -o tube.tsv
    cites near.tsv
    has "The distance of the device's axis, a straight line from the device's position on, from each area, less the needle's radius of 0.5 mm (the clearance), was determined for one pose"
    has 'Eq. 21'
    has 'Objects that are farther than 3 mm away are not reported'
    printf '0 0 0 A1\n0 0 2 A2\n' >points.txt
    conus batch nested.nii.gz --poses points.txt --radius 2 --format spikeglx -q -o contacts
    cites contacts
    has 'a ball of that radius where the file gives a point'
}

@test "positions of the CCF" {
    python3 "$BATS_TEST_DIRNAME/ccf.py"
    conus query allen.nrrd --space bregma --origin 0,0,2 --direction 0,0,-1 -q -o a.tsv
    cites a.tsv
    has 'in mm from bregma, which was taken to be at the landmark of the International Brain Laboratory in the Allen CCF.'
    has "placed by the Allen CCF's grid)"
    conus query allen.nrrd --space bregma --bregma 5000,300,5700 --origin 0,0,2 --direction 0,0,-1 -q -o b.tsv
    cites b.tsv
    has 'taken to be at AP,DV,ML 5000,300,5700 µm of the Allen CCF.'
    conus overlap allen.nrrd allen.nrrd --threshold 165 --space ccf -q -o c.tsv
    cites c.tsv
    has 'Positions were those of the Allen CCF, AP, DV and ML in µm from its corner.'
}

@test "the reference of an atlas is what its files say, and only if they are as they were" {
    scene
    cites nested.nii.gz
    has 'nested: its files carry no reference; cite it as its authors ask (file nested.nii.gz, SHA-256 '
    jq -n '{conus_atlas: 1, parcellation: "nested.nii.gz", references: ["A. Author: An atlas & more. 50% {x}_1", "doi:10.1/x"]}' >x.atlas.json
    cites x.atlas.json
    has 'x: A. Author: An atlas & more. 50% {x}_1; doi:10.1/x (file x.atlas.json)'
    answers cite x.atlas.json --format bibtex
    has 'note = {A. Author: An atlas \& more. 50\% (x)\_1; doi:10.1/x}'
    conus query x.atlas.json $aim -o a.tsv
    cites a.tsv
    has 'x: A. Author: An atlas & more.'
    mkdir moved study
    mv a.tsv a.json moved/
    cd study
    cites ../moved/a.tsv
    has 'x: its files are not here as they were, to look for a reference (file x.atlas.json, SHA-256 '
    cites ../moved/a.tsv --folder ..
    has 'x: A. Author'
    cd ..
    sed -i 's/Author/Outher/' x.atlas.json
    cites moved/a.tsv --folder .
    has 'are not here as they were'
    jq '.references = [1]' x.atlas.json >y.atlas.json
    fails 3 'references[0]: ' info y.atlas.json
    # BIDS and TemplateFlow: the nearest description counts, but not that of a study with an atlas of another name.
    mkdir -p study/tpl-X/anat
    cp nested.nii.gz study/tpl-X/anat/tpl-X_atlas-N_dseg.nii.gz
    cp nested.nii.gz study/nested.nii.gz
    printf '{"Name": "S", "HowToAcknowledge": "Cite the study."}' >study/dataset_description.json
    cites study/nested.nii.gz
    has 'carry no reference'
    cites study/tpl-X/anat/tpl-X_atlas-N_dseg.nii.gz
    has 'Cite the study.'
    printf '{"Name": "X", "ReferencesAndLinks": ["https://doi.org/10.1/tpl", "B"]}' >study/tpl-X/template_description.json
    cites study/tpl-X/anat/tpl-X_atlas-N_dseg.nii.gz
    has ': https://doi.org/10.1/tpl; B (file tpl-X_atlas-N_dseg.nii.gz, SHA-256 '
    printf '{"HowToAcknowledge": "Cite N.\\u001b[31m"}' >study/tpl-X/anat/atlas-N_description.json
    cites study/tpl-X/anat/tpl-X_atlas-N_dseg.nii.gz
    has ': Cite N. [31m (file'
    printf '[1, {"ReferencesAndLinks": 7}' >study/tpl-X/anat/atlas-N_description.json
    cites study/tpl-X/anat/tpl-X_atlas-N_dseg.nii.gz
    has '10.1/tpl'
}

@test "results that cannot be cited are refused" {
    printf 'x\ty\tz\n1\t2\t3\n' >mine.tsv
    fails 3 'mine.tsv: no .json of conus is beside it, which says how it was made' cite mine.tsv
    scene
    sealed() { # sealed FILTER: b.json is a.json through jq, with a checksum that fits
        jq "$1" a.json >b.json
        jq --arg sum "$(python3 "$BATS_TEST_DIRNAME/leaves.py" --seal b.json)" '.Checksum = $sum' b.json >sealed.json
        mv sealed.json b.json
    }
    fails 3 'cannot open' cite none/none.nii.gz
    conus query nested.nii.gz $aim -o a.tsv
    jq 'del(.GeneratedBy[0].CommandLine)' a.json >b.json
    cp a.tsv b.tsv
    fails 3 'written by the library, its Python package or a page' cite b.tsv
    sealed 'del(.Atlas.path)'
    fails 3 'Atlas: path: is missing' cite b.tsv
    sealed 'del(.Question)'
    fails 3 'b.json: Question: names no rows that this conus' cite b.tsv
    sealed '.Question.rows = "x"'
    fails 3 'b.json: Question: names no rows that this conus' cite b.tsv
    jq '.GeneratedBy[0].Name = "other"' a.json >b.json
    fails 3 'not a sidecar of conus' cite b.tsv
}

# Whoever cites a result says what conus warned of it, too.
@test "every warning of the sidecar is in the paragraph" {
    scene
    conus query nested.nii.gz --origin 0,-100,0 --direction 0,-1,0 -q -o a.tsv
    cites a.tsv
    has 'conus warned: "the cone points away from the atlas; looking the other way it would hit Shell outer first".'
    [[ "${output%%T. Rick*}" == *'conus warned'*'The cone is a geometric model'* ]]
    conus query nested.nii.gz $aim --sides exchanged -o b.tsv
    cites b.tsv
    has 'Left and right of its places were exchanged, about x = 0.'
    [[ "$output" != *warned* && "$output" != *'affine transform'* ]]
}

# A page has no program to ask: it says the same itself, but for where its cone is, and the atlas's file.
@test "the sentences of a page are those of conus cite" {
    type node >/dev/null || skip 'no node'
    scene
    local angle layers resolution weight weighed sentence rows
    rows=$(conus help --json | jq -c '[.commands[] | select(.name == "page").options[] | select(.name | IN("angle", "layers", "resolution", "range", "weight"))]')
    for angle in 30 150; do
        for layers in visible all; do
            for resolution in 64 33; do
                weight=$([ $resolution = 64 ] || echo gauss=4)
                weighed=$([ -z "$weight" ] && echo 0 || { [ $layers = all ] && echo 3 || echo 2; })
                conus query nested.nii.gz --origin 0,-100,0 --toward 0,0,0 -q --force --layers $layers --resolution $resolution \
                    --angle $angle --range 40,1e5 ${weight:+--weight $weight --score posterior} -o a.tsv
                cites a.tsv
                node --input-type=module -e "globalThis.CONUS_ROWS = $rows;
                    const { toMethods } = await import('$BATS_TEST_DIRNAME/../../apps/web/page/state.js');
                    const said = toMethods({ origin: [0, -100, 0], toward: [0, 0, 0], angle: $angle, layers: '$layers', resolution: $resolution, range: [40, 1e5], weight: '$weight' },
                        { name: 'nested', version: '0', sha256: '', transform: '' }).split(/(?<=\.) (?=[A-Z])/);
                    console.log(said.filter((sentence) => !/RAS mm|^The atlas was/.test(sentence)).join('\n'));" >said
                [ "$(wc -l <said)" -eq $(($([ $layers = all ] && echo 7 || echo 6) + weighed)) ]
                while IFS= read -r sentence; do
                    has "$sentence"
                done <said
            done
        done
    done
}

# A changed sidecar that is cited would put a wrong statement into a paper.
@test "a sidecar that was changed is not cited" {
    scene
    conus query nested.nii.gz $aim -o a.tsv
    cp a.json kept.json
    cites a.json # beside the result
    has 'a full opening angle of 30°'
    jq '.Atlas.volumes[0].transform = "sform, code 4 (MNI 152)"' kept.json >a.json
    fails 1 'a.json: was changed after conus wrote it: its Checksum does not fit; conus verify says where' cite a.tsv
    jq 'del(.Checksum)' kept.json >a.json
    fails 1 'a.json: was changed after conus wrote it' cite a.tsv
    fails 1 'a.json: was changed after conus wrote it' cite kept.tsv --sidecar a.json
}

# The batch records the options that its file of poses used, not the poses: the paragraph describes only those options.
@test "a batch and a track are described by what applies to them" {
    scene
    local header='x\ty\tz\ttx\tty\ttz' row='0\t100\t0\t0\t0\t0'
    printf "$header\n$row\n" >plain.tsv
    printf "$header\tangle\n$row\t5\n" >angles.tsv
    printf "time_s\t$header\n0\t$row\n" >steps.tsv
    printf "time_s\t$header\tangle\n0\t$row\t5\n" >step-angles.tsv
    printf '0 -23 0 A1\n' >points.txt
    conus batch nested.nii.gz --poses plain.tsv --angle 30 -q -o a.tsv
    [ "$(jq -c '.Batch | [.own_angles, .points]' a.json)" = '[false,false]' ]
    cites a.tsv
    has 'a full opening angle of 30°, were determined'
    [[ "$output" != *own* && "$output" != *120°* ]]
    conus batch nested.nii.gz --poses plain.tsv --angle 130 -q -o b.tsv
    cites b.tsv
    has 'a full opening angle of 130°, were determined'
    has '(evenly spread in angle where it opens beyond 120°)'
    conus batch nested.nii.gz --poses angles.tsv --angle 30 -q -o c.tsv
    [ "$(jq -c '.Batch | [.own_angles, .points]' c.json)" = '[true,false]' ]
    cites c.tsv
    has "a full opening angle of 30°, or the pose's own where the file gives one, were determined"
    has 'beyond 120°'
    conus batch nested.nii.gz --poses plain.tsv --radius 3 -q -o d.tsv
    cites d.tsv
    [[ "$output" != *'a ball of that radius'* ]]
    conus batch nested.nii.gz --poses points.txt --radius 3 -q -o e.tsv
    [ "$(jq -c '.Batch | [.own_angles, .points]' e.json)" = '[false,true]' ]
    cites e.tsv
    has '(a ball of that radius where the file gives a point without a direction)'
    conus batch nested.nii.gz --poses plain.tsv --angle 30 --shard all/2 -q -o s.tsv
    cites s.tsv
    [[ "$output" != *own* ]]
    printf "$header\town\n$row\tx\n" >kept.tsv # the name of a column is no fact
    conus batch nested.nii.gz --poses kept.tsv --keep own --angle 30 -q -o k.tsv
    cites k.tsv
    [[ "$output" != *depths* ]]
    conus track nested.nii.gz --poses steps.tsv --angle 30 -q -o f.tsv
    cites f.tsv
    has 'a full opening angle of 30°, were determined for each step'
    [[ "$output" != *own* && "$output" != *120°* ]]
    conus track nested.nii.gz --poses step-angles.tsv --angle 30 -q -o g.json
    cites g.json
    has "a full opening angle of 30°, or the step's own where the file gives one,"
}

@test "an atlas from a pack is the file that was packed" {
    scene
    conus pack nested.nii.gz -o p.conus -q
    sum=$(sha256sum nested.nii.gz | cut -d ' ' -f 1)
    conus query p.conus $aim -o a.tsv
    cites a.tsv
    has "The atlas was nested (file nested.nii.gz, SHA-256 ${sum:0:8}…, read from the pack p.conus, placed by its sform"
    has "(file nested.nii.gz, SHA-256 $sum)"
    conus query slabs.nii.gz --atlas p.conus $aim -o b.tsv
    cites b.tsv
    has "(file nested.nii.gz, SHA-256 ${sum:0:8}…, read from the pack p.conus, placed by its sform"
}

# A cylinder has no apex; needles that are given have no candidates.
@test "a cylinder's depths, and a plan that is given whole" {
    scene
    conus query nested.nii.gz --origin 0,-100,0 --toward 0,0,0 --radius 3 --range 10,90 -o tube.tsv
    cites tube.tsv
    has "counted: 10 mm and 90 mm from the device's position."
    printf 'needle\nA\nB\n' >needles.tsv
    printf 'query_id\tx\ty\tz\tdx\tdy\tdz\tfar\nA\t0\t-100\t0\t0\t1\t0\t100\nB\t4\t-100\t0\t0\t1\t0\t100\n' >given.tsv
    conus plan nested.nii.gz --needles needles.tsv --given given.tsv --reach Core -q -o plan.tsv
    cites plan.tsv
    has 'A: some of the axis in Core; B: some of the axis in Core.'
    conus plan nested.nii.gz --needles needles.tsv --given given.tsv --reach Core --contacts 4,1,3,1.5 \
        --cover Core,contacts=1 --cover 'Shell inner' -q -o cover.tsv
    cites cover.tsv
    has 'Contacts of all needles together were counted in Core (at least 1); Shell inner. '
}

@test "where candidates come from, how a handle stands, and how wide a trial's cone is" {
    scene
    conus plan nested.nii.gz --from angles,arc=0:20:10,slider=0:0:1,back=60 --toward centroid --depth target --reach Core \
        -q -o plan.tsv
    cites plan.tsv
    has 'The candidates were those of the command "conus plan nested.nii.gz --from angles,arc=0:20:10,slider=0:0:1,back=60 --toward centroid --depth target --reach Core -q -o plan.tsv".'
    conus positions C3 --handle 45 -q -o coil.tsv
    cites coil.tsv
    has "The device's handle (its -y) pointed backwards, turned by 45° to the side of the position, on the midline to the left."
    conus positions C3 -q -o cap.tsv
    cites cap.tsv
    [[ "$output" != *handle* && "$output" != *off\ the\ scalp* ]]
    conus query nested.nii.gz --origin 1020:C3 --inward --out 5 -q -o out.tsv
    cites out.tsv
    has 'The device stood 5 mm off the scalp, along its normal.'
    has 'Places that were named: origin, the position C3 of the 10-10 system on the head of MNI 152 (the rule of Jurcak, Tsuzuki'
    conus query nested.nii.gz --origin=-60,0,0 --toward near:Core -q -o near.tsv
    cites near.tsv
    has 'Places that were named: toward, the nearest point of Core.'
    printf 'x\ty\tz\ttx\tty\ttz\tmeant\n0\t0\t100\t0\t0\t0\tShell outer\n' >meant.tsv
    for y in 3 6 9 12; do printf '0\t%s\t100\t0\t0\t0\tShell outer\n' $y; done >>meant.tsv
    conus calibrate nested.nii.gz --poses meant.tsv --weight gauss=1.5 -q -o rows.tsv
    cites rows.tsv
    has "A trial's cone had a full opening angle of 12°, or its own where the file gives one." # 8 times 1.5
    conus calibrate nested.nii.gz --poses meant.tsv --weight gauss=1.5 --angle 20 -q -o wide.tsv
    cites wide.tsv
    has "A trial's cone had a full opening angle of 20°, or its own"
}
