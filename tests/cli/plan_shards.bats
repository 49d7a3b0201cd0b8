#!/usr/bin/env bats
# conus plan in parts: joined shards and resumed plans write the same as one run.

load helpers

needles() {
    conus phantom u-shape -o .
    printf '40 0 5\n40 5 5\n40 -6 8\n0 40 5\n' >entries.txt
    ask="plan u-shape.nii.gz --reach U,length=2 --from entries.txt --depth target+4 --radius 1"
    few="$ask --toward voxels,spacing=6 --avoid Ball,margin=0.5"
}

@test "shards that are joined are the plan of one run: list, rows, map, what is said" {
    needles
    for more in '--infeasible --avoid Ball,margin=2' '--length 1,2 --top 60 --shanks 0,0;0.5,0 --roll 180'; do
        rm -f shard.*
        conus $ask --toward voxels,spacing=6 $more -o whole.tsv --constraints rows.tsv \
            --target-map whole.nii.gz --force 2>said
        for i in 0 1 2; do
            conus $ask --toward voxels,spacing=6 $more --target-map part.nii.gz --shard $i/3 -o shard.$i.tsv -q --force
        done
        conus $ask --toward voxels,spacing=6 $more --merge shard.2.tsv --merge shard.0.tsv --merge shard.1.tsv \
            -o merged.tsv --constraints merged_rows.tsv --target-map merged.nii.gz --threads 2 --force 2>merged
        cmp whole.tsv merged.tsv
        cmp rows.tsv merged_rows.tsv
        cmp whole.nii.gz merged.nii.gz
        cmp said merged
    done
    [ ! -e merged.tsv.journal ]
    [ ! -e whole.tsv.journal ]
    answers verify shard.1.tsv
    answers verify merged.tsv
}

@test "a plan that is killed or interrupted is resumed, and may be resumed again" {
    needles
    printf '40 %s 5\n0 40 %s\n' {-11..11..2} >entries.txt # so many that it is not done before it is stopped
    local own="$ask --toward voxels --avoid Ball,margin=0.5 --top 30"
    conus $own -o whole.tsv -q
    for signal in KILL TERM; do # a shell has its background ignore SIGINT
        rm -f plan.*
        background "$CONUS" $own --threads 1 --resume -o plan.tsv -q
        wait_until "$child" grep -qs '^left [1-9]' plan.tsv.journal
        kill -STOP "$child"
        fails 3 'plan.tsv.journal: another conus is writing this file' $own --resume -o plan.tsv -q
        fails 3 'another conus is writing this file' $own --force -o plan.tsv -q
        kill -$signal "$child"
        kill -CONT "$child" || : # one that was killed is gone
        wait "$child" || :
        [ ! -e plan.tsv ]
        fails 2 'a plan has begun there; --resume continues it' $own -o plan.tsv -q
        fails 2 'other settings, poses, atlas' $own --rank depth --resume -o plan.tsv -q
        fails 3 'plan.tsv: this shard is not finished; --resume continues it' $own --merge plan.tsv -q
        conus $own --resume -o plan.tsv -q
        cmp plan.tsv whole.tsv
        conus $own --resume -o plan.tsv -q
        cmp plan.tsv whole.tsv
    done
}

@test "files that are no journal of this plan are refused with a line" {
    needles
    conus $few --shard 0/2 -o a.tsv -q
    conus $few --shard 1/2 -o b.tsv -q
    fails 3 'shard 1 of 2 is missing (a.tsv is one of them)' $few --merge a.tsv -q
    fails 3 'a.tsv and a.tsv are both shard 0 of 2' $few --merge a.tsv --merge a.tsv -q
    fails 2 'other settings, poses, atlas' $few --top 7 --merge a.tsv --merge b.tsv -q
    fails 3 'no.tsv.journal' $few --merge no.tsv -q
    fails 2 '--output a.tsv would overwrite the input a.tsv' $few --merge a.tsv --merge b.tsv -o a.tsv -q
    fails 2 '--merge FILE' merge a.tsv b.tsv -o c.tsv
    fails 2 'I from 0 to N - 1' $few --shard 2/2 -o c.tsv -q
    fails 2 '--shard has no effect without a file for --output' $few --shard 0/2 -q
    fails 2 '--resume has no effect without a file for --output' $few --resume -q
    fails 2 '--shard needs a file of poses, not standard input' plan u-shape.nii.gz --reach U --poses - --shard 0/2 -o c.tsv
    fails 2 'exclude each other' $few --merge a.tsv --shard 0/2 -o c.tsv
    fails 2 'a.tsv: its journal is of shard 0/2; --force begins anew' $few --shard 1/2 -o a.tsv --resume -q
    printf '40 0 5\n' >entries.txt # half as many entries: the shard belongs to other ones
    fails 2 'other settings, poses, atlas' $few --merge a.tsv --merge b.tsv -q
    needles
    head -c -1 a.tsv.journal >cut && mv cut a.tsv.journal
    fails 3 'a.tsv.journal: is no journal of a plan, or not whole' $few --merge a.tsv --merge b.tsv -q
    fails 3 'a.tsv.journal: is no journal of a plan, or not whole' $few --shard 0/2 -o a.tsv --resume -q
    conus $few --shard 0/2 -o a.tsv --force -q
    conus $few --merge a.tsv --merge b.tsv -o c.tsv -q
    fails 3 'a.tsv.journal: a state without the best poses: that part needs a map of targets, too; run it again with --target-map' \
        $few --merge a.tsv --merge b.tsv --target-map map.nii.gz -o e.tsv -q
    conus query u-shape.nii.gz --origin 40,0,5 --toward 0,0,5 -q --mask mask.nii.gz >/dev/null
    local masked='plan u-shape.nii.gz --reach U --from mask.nii.gz,spacing=8 --toward centroid --depth target'
    conus $masked --shard 0/1 -o m.tsv -q
    fails 3 'm.tsv.journal: a state without the best poses: that part needs a map of entries, too; run it again with --map' \
        $masked --merge m.tsv --map map.nii.gz -o e.tsv -q
    conus $few --shard 0/1 -o one.tsv -q
    conus $few --merge one.tsv -o d.tsv -q
    cmp c.tsv d.tsv
    rm d.*
    echo mine >d.tsv.journal
    fails 2 'd.tsv.journal: there is a file that is no journal of a plan' $few -o d.tsv -q --force
    [ "$(cat d.tsv.journal)" = mine ]
}

@test "a plan without any candidate leaves no journal that would be in the way" {
    needles
    for more in '' --resume '--shard 0/1'; do # points have no normals
        fails 2 'no candidate: number 1: no normal at its entry' $few --entry-angle 40 -o p.tsv $more
        [ ! -e p.tsv.journal ] && [ ! -e p.tsv ]
    done
    conus $few -o p.tsv -q
}
