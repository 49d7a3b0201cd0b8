/* At which opening, degrees, does a growing cone reach each area? Reads two columns of a table. C99 and C++17. */
#include <conus/conus.h>

#include <stdio.h>

int main(int argc, char **argv)
{
    const double origin[3] = {0, 0, 60}, target[3] = {0, 0, 0}, widest = 179;
    conus_atlas *atlas = NULL;
    conus_selector *selector = NULL;
    conus_table *table = NULL;
    conus_pose pose;
    conus_status status = conus_atlas_load(&atlas, argc > 1 ? argv[1] : "data-samples/u-shape.nii.gz", NULL);
    status = status ? status : conus_selector_create(&selector, atlas, NULL);
    status = status ? status : conus_pose_toward(&pose, origin, target, NULL);
    status = status ? status : conus_sweep(&table, selector, &pose, widest);
    fprintf(stderr, "%s%s", status ? conus_message() : "", status ? "\n" : "");
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
    for (size_t row = 0; row < conus_table_rows(table); row++) { /* the table outlives the atlas */
        printf("%s: %.3f\n", conus_table_texts(table, "name")[row], conus_table_numbers(table, "angle_deg")[row]);
    }
    conus_table_destroy(table);
    return status ? 1 : 0;
}
