/* SPDX-License-Identifier: BSD-3-Clause */
/* Collects lines, and numbers of points and cells. */
#include "loaders/surfaces/foreign/foreign_lines.h"

#include "base/memory.h"

#include <string.h>

void foreign_lines_finish(struct foreign_lines *lines)
{
    for (size_t i = 0; i < lines->array_count; i++) {
        memory_free(lines->arrays[i].name);
        memory_free(lines->arrays[i].values);
    }
    memory_free(lines->arrays);
    memory_free(lines->corners.indices);
    memory_free(lines->ends);
    *lines = (struct foreign_lines){0};
}

conus_status foreign_end_line(struct foreign_mesh *mesh)
{
    struct foreign_lines *lines = mesh->lines;
    const struct corners *face = &mesh->face;
    if (lines) {
        struct corners *all = &lines->corners;
        if (!memory_reserve(&all->indices, &all->capacity, all->count + face->count, sizeof *all->indices) ||
            !memory_reserve(&lines->ends, &lines->capacity, lines->count + 1, sizeof *lines->ends)) {
            return CONUS_ERROR_MEMORY;
        }
        if (face->count) {
            memcpy(&all->indices[all->count], face->indices, face->count * sizeof *face->indices);
        }
        all->count += face->count;
        lines->ends[lines->count++] = all->count;
    }
    foreign_drop_face(mesh);
    return CONUS_OK;
}

static struct foreign_array *find_array(const struct foreign_lines *lines, const char *name, bool per_point)
{
    for (size_t i = 0; i < lines->array_count; i++) {
        if (lines->arrays[i].per_point == per_point && strcmp(lines->arrays[i].name, name) == 0) {
            return &lines->arrays[i];
        }
    }
    return NULL;
}

/* Takes @p name, or frees it. */
static conus_status add_array(struct foreign_array **out, struct foreign_lines *lines, char *name, bool per_point,
                              uint32_t components)
{
    conus_status status = lines->array_count < FOREIGN_ARRAY_LIMIT
                              ? CONUS_OK
                              : fail(CONUS_ERROR_DATA, "%s: allowed are up to %d arrays", name, FOREIGN_ARRAY_LIMIT);
    if (!status &&
        !memory_reserve(&lines->arrays, &lines->array_capacity, lines->array_count + 1, sizeof *lines->arrays)) {
        status = CONUS_ERROR_MEMORY;
    }
    if (status) {
        memory_free(name);
        return status;
    }
    *out = &lines->arrays[lines->array_count++];
    **out = (struct foreign_array){.name = name, .per_point = per_point, .components = components};
    return CONUS_OK;
}

conus_status foreign_lines_array(struct foreign_array **out, struct foreign_lines *lines, struct text name,
                                 bool per_point, uint64_t components)
{
    char *words = text_to_utf8(name);
    if (!words) {
        return CONUS_ERROR_MEMORY;
    }
    struct foreign_array *found = find_array(lines, words, per_point);
    bool fits = components >= 1 && components <= FOREIGN_COMPONENT_LIMIT;
    if (fits && !found) {
        return add_array(out, lines, words, per_point, (uint32_t)components);
    }
    conus_status status = CONUS_OK;
    if (!fits || found->components != components) {
        status = fail(CONUS_ERROR_DATA, "%s: %llu numbers for each point or cell, allowed are 1 to %d, the same in all",
                      words, (unsigned long long)components, FOREIGN_COMPONENT_LIMIT);
    }
    memory_free(words);
    *out = found;
    return status;
}

conus_status foreign_array_reserve(struct foreign_lines *lines, struct foreign_array *array, size_t more)
{
    if (more > lines->max_memory / sizeof *array->values) {
        return fail(CONUS_ERROR_MEMORY, "%s: %zu numbers, allowed are %llu bytes more (--max-memory)", array->name,
                    more, (unsigned long long)lines->max_memory);
    }
    lines->max_memory -= more * sizeof *array->values;
    return memory_reserve(&array->values, &array->capacity, array->count + more, sizeof *array->values)
               ? CONUS_OK
               : CONUS_ERROR_MEMORY;
}
