#!/usr/bin/env bats
# conus connect, query --endpoints and --connectivity: which areas streamlines connect.

load helpers

@test "without streamlines there is nothing to connect" {
    conus phantom u-shape -o .
    fails 2 "no streamlines" connect u-shape.nii.gz
    fails 2 "no streamlines" query u-shape.nii.gz --point 0,0,0 --radius 9 --endpoints rows.tsv
    fails 2 "no streamlines" query u-shape.nii.gz --point 0,0,0 --radius 9 --connectivity rows.tsv
    [ ! -e rows.tsv ]
}

@test "options that cannot be are refused" {
    conus phantom u-shape -o .
    fails 2 "allowed are 0 to 100" connect u-shape.nii.gz --endpoint-radius 101
    fails 2 "allowed are 0 to 100" connect u-shape.nii.gz --endpoint-radius=-1
    fails 2 "no effect without" query u-shape.nii.gz --point 0,0,0 --radius 9 --endpoint-radius 1
    fails 2 "ends in none of .tsv, .csv and .json" connect u-shape.nii.gz --connectivity matrix.txt
    fails 2 "needs a file" query u-shape.nii.gz --point 0,0,0 --radius 9 --endpoints -
    fails 2 "are the same file" connect u-shape.nii.gz -o rows.tsv --connectivity rows.tsv
    fails 2 "would overwrite" connect u-shape.nii.gz --connectivity u-shape.tsv
    fails 2 "--connectivity" connect u-shape.nii.gz --atlas u-shape.nii.gz --connectivity matrix.tsv
}
