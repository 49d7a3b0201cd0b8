/* SPDX-License-Identifier: BSD-3-Clause */
/* Areas of a manifest that are one surface a file: single files and the files that match a pattern. */
#include "loaders/scene/plan_files.h"

#include "base/buffer.h"
#include "base/files/folder.h"
#include "base/memory.h"
#include "loaders/labels/label_file.h"

#include <fnmatch.h>
#include <string.h>

/* The first whole number in the name of the file; false if there is none. */
static conus_status number_in_name(uint32_t *number, bool *found, const char *path)
{
    const char *name = path_base(path);
    size_t start = strcspn(name, "0123456789");
    size_t length = strspn(name + start, "0123456789");
    uint64_t value = 0;
    *found = length > 0;
    if (*found && (!text_to_uint((struct text){name + start, length}, UINT32_MAX, &value) || !value)) {
        return fail(CONUS_ERROR_DATA, "%s: the number in its name is %.*s, labels are 1 to 4294967295", name,
                    (int)length, name + start);
    }
    *number = (uint32_t)value;
    return CONUS_OK;
}

conus_status plan_file(struct area_plan *plan, size_t entry, const struct manifest_area *area, const char *path)
{
    struct label label = area->label;
    bool found = true;
    conus_status status = area->has_label ? CONUS_OK : number_in_name(&label.number, &found, area->file);
    if (!status && !found) {
        status = fail(CONUS_ERROR_DATA, "label is missing (there is no number in the name %s either)", area->file);
    }
    char *file = status ? NULL : file_beside(path, area->file);
    status = status || file ? status : CONUS_ERROR_MEMORY;
    return status ? status : area_plan_add(plan, entry, file, &label);
}

/* Which names of a folder match a pattern, and how they give labels. */
struct matches {
    struct names names;
    char *folder;
    bool numbered;
    struct label_table table;
};

static void matches_finish(struct matches *matches)
{
    names_finish(&matches->names);
    memory_free(matches->folder);
    label_table_finish(&matches->table);
}

/* Keeps the names that match; all of them or none must hold a number. */
static conus_status sift_names(struct matches *matches, const char *pattern)
{
    struct names *names = &matches->names;
    size_t kept = 0;
    size_t numbered = 0;
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < names->count; i++) {
        char *name = names->names[i];
        if (fnmatch(pattern, name, FNM_PERIOD) != 0) {
            memory_free(name);
            continue;
        }
        uint32_t number;
        bool found = false;
        names->names[kept++] = name;
        status = status ? status : number_in_name(&number, &found, name);
        numbered += found;
    }
    names->count = kept;
    matches->numbered = numbered > 0;
    if (!status && !kept) {
        return fail(CONUS_ERROR_DATA, "files: no file matches %s", pattern);
    }
    if (!status && numbered && numbered < kept) {
        return fail(CONUS_ERROR_DATA,
                    "files: %zu of the %zu names hold a number, which gives the label: all or none must", numbered,
                    kept);
    }
    return status;
}

/* The end of a pattern that every name that matches ends in. */
static const char *plain_ending(const char *pattern)
{
    const char *ending = pattern + strlen(pattern);
    while (ending > pattern && !strchr("*?[]\\/", ending[-1])) {
        ending--;
    }
    return ending;
}

static conus_status find_matches(struct matches *matches, struct area_plan *plan, const struct manifest_area *area,
                                 const char *path, struct notes *notes)
{
    const struct label_use use = {.max_memory = plan->max_memory, .read = &plan->read};
    const char *format;
    char *pattern = file_beside(path, area->files);
    matches->folder = pattern ? path_folder(pattern) : NULL;
    conus_status status =
        matches->folder ? names_list(&matches->names, matches->folder, plain_ending(area->files)) : CONUS_ERROR_MEMORY;
    status = status ? status : sift_names(matches, path_base(area->files));
    memory_free(pattern);
    if (!status && area->labels) {
        char *labels = file_beside(path, area->labels);
        status = labels ? label_file_read(&matches->table, &format, labels, &use, notes) : CONUS_ERROR_MEMORY;
        memory_free(labels);
    }
    return status;
}

/* The label of a file: its number, what the table says of that, what the entry says of all. */
static conus_status label_of_match(struct label *label, const struct matches *matches, size_t index,
                                   const struct manifest_area *area)
{
    bool found;
    uint32_t number = (uint32_t)index + 1;
    uint32_t offset = area->label_offset;
    conus_status status = matches->numbered ? number_in_name(&number, &found, matches->names.names[index]) : CONUS_OK;
    if (!status && number > UINT32_MAX - offset) {
        status = fail(CONUS_ERROR_DATA, "label_offset: %u + %u is above 4294967295", offset, number);
    }
    const struct label *known = label_table_find(&matches->table, number);
    *label = known ? *known : (struct label){0};
    label->number = number + offset;
    label->hemisphere = area->label.hemisphere ? area->label.hemisphere : label->hemisphere;
    label->parent = label->has_parent ? label->parent + offset : area->label.parent;
    label->has_parent = label->has_parent || area->label.has_parent;
    return status;
}

conus_status plan_pattern(struct area_plan *plan, size_t entry, const struct manifest_area *area, const char *path,
                          struct notes *notes)
{
    struct matches matches = {0};
    conus_status status = find_matches(&matches, plan, area, path, notes);
    for (size_t i = 0; !status && i < matches.names.count; i++) {
        struct label label;
        struct buffer file = {0};
        status = label_of_match(&label, &matches, i, area);
        buffer_format(&file, "%s%s", matches.folder, matches.names.names[i]);
        status = status ? status : buffer_status(&file);
        if (status) {
            buffer_finish(&file);
        } else {
            status = area_plan_add(plan, entry, file.data, &label);
        }
    }
    matches_finish(&matches);
    return status;
}
