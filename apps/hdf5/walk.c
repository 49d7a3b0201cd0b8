/* SPDX-License-Identifier: BSD-3-Clause */
/* From patterns to objects. Links are followed here, one by one, so that libhdf5 follows none on its own. */
#include "conus_hdf5.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SOFT_LIMIT = 8, DEPTH_LIMIT = 64 };

/* Where the walk is: the path of the object that is open, and the groups that lead to it. */
struct walk {
    hid_t file;
    char path[HDF5_NAME_LIMIT + 1];
    size_t length;
    haddr_t above[DEPTH_LIMIT];
    size_t depth;
};

static void write_object(const struct walk *walk, hid_t object, const H5O_info_t *info);
static void visit(struct walk *walk, hid_t object, const char *pattern);
static hid_t open_path(const struct walk *walk, hid_t group, const char *path, int *soft);

/* The object at a link, whatever its kind; negative where a soft link leads nowhere. */
static hid_t open_link(const struct walk *walk, hid_t group, const char *name, int *soft)
{
    H5L_info_t link;
    char target[HDF5_NAME_LIMIT + 1] = "";
    if (H5Lget_info(group, name, &link, H5P_DEFAULT) < 0) {
        refuse_damaged(walk->path, "read a link");
    }
    if (link.type == H5L_TYPE_HARD) {
        hid_t object = H5Oopen(group, name, H5P_DEFAULT);
        if (object < 0) {
            refuse_damaged(walk->path, "open it");
        }
        return object;
    }
    if (link.type != H5L_TYPE_SOFT) {
        refuse(false, "%s: a link to another file, which is not followed", walk->path);
    }
    if (++*soft > SOFT_LIMIT) {
        refuse(false, "%s: more than %d soft links lead to it, or they run in a circle", walk->path, SOFT_LIMIT);
    }
    if (link.u.val_size >= sizeof target || H5Lget_val(group, name, target, sizeof target - 1, H5P_DEFAULT) < 0) {
        refuse(false, "%s: a soft link of more than %d bytes, or a damaged one", walk->path, HDF5_NAME_LIMIT);
    }
    return open_path(walk, target[0] == '/' ? walk->file : group, target, soft);
}

/* Takes the next name off a path; false at its end. "." and empty names are passed over. */
static bool take_name(char name[HDF5_NAME_LIMIT + 1], const char **path)
{
    size_t length;
    do {
        *path += strspn(*path, "/");
        length = strcspn(*path, "/");
        memcpy(name, *path, length);
        name[length] = '\0';
        *path += length;
    } while (strcmp(name, ".") == 0);
    return length > 0;
}

/* The object where a soft link leads; negative if there is none. */
static hid_t open_path(const struct walk *walk, hid_t group, const char *path, int *soft)
{
    char name[HDF5_NAME_LIMIT + 1];
    hid_t object = H5Oopen(group, ".", H5P_DEFAULT);
    while (object >= 0 && take_name(name, &path)) {
        bool has = H5Iget_type(object) == H5I_GROUP && H5Lexists(object, name, H5P_DEFAULT) > 0;
        hid_t next = has ? open_link(walk, object, name, soft) : -1;
        H5Oclose(object);
        object = next;
    }
    return object;
}

/* Visits the object at a link of the group that is open. */
static void enter(struct walk *walk, hid_t group, const char *name, const char *pattern)
{
    size_t length = walk->length;
    int soft = 0;
    int size = snprintf(walk->path + length, sizeof walk->path - length, "/%s", name);
    if (size < 0 || (size_t)size >= sizeof walk->path - length) {
        refuse(false, "a path of more than %d bytes", HDF5_NAME_LIMIT);
    }
    walk->length += (size_t)size;
    hid_t object = open_link(walk, group, name, &soft);
    if (object >= 0) {
        visit(walk, object, pattern);
        H5Oclose(object);
    }
    walk->length = length;
    walk->path[length] = '\0';
}

/* The links of a group, and with what they are entered. */
struct names {
    struct walk *walk;
    const char *pattern;
};

static herr_t enter_each(hid_t group, const char *name, const H5L_info_t *link, void *user)
{
    const struct names *names = user;
    (void)link;
    enter(names->walk, group, name, names->pattern);
    return 0;
}

static void enter_all(struct walk *walk, hid_t group, const char *pattern)
{
    struct names names = {walk, pattern};
    if (H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, NULL, enter_each, &names) < 0) {
        refuse_damaged(walk->path, "list it");
    }
}

static void visit_group(struct walk *walk, hid_t group, const H5O_info_t *info, const char *pattern)
{
    char name[HDF5_NAME_LIMIT + 1];
    const char *rest = pattern;
    for (size_t i = 0; i < walk->depth; i++) {
        if (walk->above[i] == info->addr) {
            refuse(false, "%s: a group that lies within itself", walk->path);
        }
    }
    if (walk->depth == DEPTH_LIMIT) {
        refuse(false, "%s: groups more than %d deep", walk->path, DEPTH_LIMIT);
    }
    walk->above[walk->depth++] = info->addr;
    (void)take_name(name, &rest);
    if (strcmp(name, "**") == 0) {
        enter_all(walk, group, pattern);
    } else if (strcmp(name, "*") == 0) {
        enter_all(walk, group, rest);
    } else if (H5Lexists(group, name, H5P_DEFAULT) > 0) {
        enter(walk, group, name, rest);
    }
    walk->depth--;
}

/* Writes the object if the pattern ends here, and goes on into groups where it does not. */
static void visit(struct walk *walk, hid_t object, const char *pattern)
{
    H5O_info_t info;
    if (H5Oget_info2(object, &info, H5O_INFO_BASIC) < 0) {
        refuse_damaged(walk->path, "read it");
    }
    if (!*pattern || strcmp(pattern, "/**") == 0) {
        write_object(walk, object, &info);
    }
    if (info.type == H5O_TYPE_GROUP && *pattern) {
        visit_group(walk, object, &info, pattern);
    }
}

/* An object and the path of it. */
struct owner {
    const char *path;
};

static herr_t write_each(hid_t object, const char *name, const H5A_info_t *info, void *user)
{
    const struct owner *owner = user;
    (void)info;
    write_attribute(owner->path, object, name);
    return 0;
}

static void write_object(const struct walk *walk, hid_t object, const H5O_info_t *info)
{
    struct owner owner = {walk->length ? walk->path : "/"};
    struct description what = {.kind = HDF5_FRAME_OBJECT, .address = info->addr, .name = owner.path};
    if (info->type == H5O_TYPE_DATASET) {
        write_dataset(&what, object);
    } else {
        what.class = info->type == H5O_TYPE_GROUP ? HDF5_GROUP : HDF5_OTHER;
        stream_frame(&what, 0);
    }
    if (H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, NULL, write_each, &owner) < 0) {
        refuse_damaged(owner.path, "read its attributes");
    }
}

void write_objects(hid_t file, const char *pattern)
{
    struct walk walk = {.file = file};
    if (pattern[0] != '/' || strlen(pattern) > HDF5_NAME_LIMIT) {
        refuse(false, "a pattern is an absolute path");
    }
    hid_t root = H5Oopen(file, "/", H5P_DEFAULT);
    if (root < 0) {
        refuse_damaged("/", "open it");
    }
    visit(&walk, root, pattern[1] ? pattern : "");
    H5Oclose(root);
}
