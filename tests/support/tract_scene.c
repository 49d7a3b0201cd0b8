/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes tractograms, of arrays or streamline by streamline. */
#include "tract_scene.h"

#include "atlas/atlas.h"
#include "base/memory.h"
#include "loaders/tracts/tracts.h"
#include "test.h"

#include <string.h>

struct tractogram tract_of(const char *path, const float *points, const uint64_t *first, size_t streamlines,
                           double radius)
{
    struct tractogram made = {.path = memory_text(path, strlen(path)),
                              .points = memory_copy(points, 3 * first[streamlines], sizeof *points),
                              .first = memory_copy(first, streamlines + 1, sizeof *first),
                              .point_count = first[streamlines],
                              .streamline_count = streamlines,
                              .radius = radius};
    assert_true(made.path && made.points && made.first);
    return made;
}

void tract_begin(struct tract_builder *builder)
{
    *builder = (struct tract_builder){.made = {.path = memory_text("made", 4), .radius = 0.5}};
    assert_true(memory_reserve(&builder->made.first, &builder->first_capacity, 1, sizeof(uint64_t)));
    builder->made.first[0] = 0;
}

void tract_add_point(struct tract_builder *builder, const double point[3])
{
    struct tractogram *made = &builder->made;
    size_t count = made->point_count + 1;
    assert_true(memory_reserve(&made->points, &builder->point_capacity, count, 3 * sizeof(float)));
    for (size_t a = 0; a < 3; a++) {
        made->points[3 * made->point_count + a] = (float)point[a];
    }
    made->point_count = count;
}

void tract_end_streamline(struct tract_builder *builder)
{
    struct tractogram *made = &builder->made;
    assert_true(memory_reserve(&made->first, &builder->first_capacity, made->streamline_count + 2, sizeof(uint64_t)));
    made->first[++made->streamline_count] = made->point_count;
}

static void add_streamline(struct tract_builder *builder, const double (*points)[3], size_t count)
{
    for (size_t i = 0; i < count; i++) {
        tract_add_point(builder, points[i]);
    }
    tract_end_streamline(builder);
}

void tract_add_group(struct tractogram *to, const char *name, const uint32_t *members, size_t count)
{
    to->groups = memory_resize(to->groups, to->group_count + 1, sizeof *to->groups);
    assert_non_null(to->groups);
    to->groups[to->group_count++] = (struct tract_group){.name = memory_text(name, strlen(name)),
                                                         .members = memory_copy(members, count, sizeof *members),
                                                         .count = count};
}

conus_atlas *tract_lines_atlas(void)
{
    static const double lines[3][2][3] = {
        {{-50, 0, 30}, {50, 0, 30}}, {{70, 3, 30}, {-30, 3, 30}}, {{-50, 100, 30}, {50, 100, 30}}};
    static const double bent[4][3] = {{-90, 200, 0}, {0, 200, 0}, {0, 210, 0}, {90, 210, 0}};
    static const uint32_t members[] = {0, 1, 3};
    static const uint32_t others[] = {2};
    conus_atlas *atlas = NULL;
    struct tract_builder builder;
    tract_begin(&builder);
    for (size_t k = 0; k < 3; k++) {
        add_streamline(&builder, lines[k], 2);
    }
    add_streamline(&builder, bent, 4);
    tract_add_group(&builder.made, "near", members, 3);
    tract_add_group(&builder.made, "far", others, 1);
    assert_ok(atlas_create_empty(&atlas, "none"));
    assert_ok(atlas_add_tractogram(atlas, &builder.made, "rest"));
    return atlas;
}

conus_status tract_read(struct tractogram *out, const char *path, uint64_t max_memory, struct notes *notes)
{
    struct job job = {.max_memory = max_memory};
    tract_file_read(&job, out, path, CONUS_FILE_SPACE_AS_STATED);
    return job_close(&job, notes, NULL);
}

conus_status tract_parse(struct tractogram *out, const struct buffer *bytes, uint64_t max_memory, struct notes *notes)
{
    struct job job = {.max_memory = max_memory};
    tract_file_parse(&job, out, (struct text){bytes->data, bytes->size});
    return job_close(&job, notes, NULL);
}
