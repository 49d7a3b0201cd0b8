/* SPDX-License-Identifier: BSD-3-Clause */
/* The table of endings. */
#include "sources/names.h"

#include "base/path.h"

#include <string.h>

#define OF_VOLUME(ending)                                                                                              \
    ,                                                                                                                  \
    {                                                                                                                  \
        ending, ROLE_VOLUME                                                                                            \
    }
#define OF_FORMAT(id, name, endings) endings
/* In the order in which folders are searched: of two that fit a name the longer one counts. */
static const struct {
    const char *ending;
    unsigned roles;
} rows[] = {
    {".atlas.json", ROLE_SCENE},
    {".conus", ROLE_SCENE},
    {".dlabel.nii", ROLE_VERTEX_LABELS | ROLE_SCENE} VOLUME_FORMATS(OF_FORMAT, OF_VOLUME),
    {".surf.gii", ROLE_SURFACE},
    {".label.gii", ROLE_VERTEX_LABELS},
    {".gii", ROLE_SURFACE | ROLE_VERTEX_LABELS},
    {".annot", ROLE_VERTEX_LABELS},
    {".label", ROLE_VERTEX_LABELS | ROLE_POSES},
    {".obj", ROLE_SURFACE},
    {".ply", ROLE_SURFACE},
    {".stl", ROLE_SURFACE},
    {".off", ROLE_SURFACE},
    {".mz3", ROLE_SURFACE},
    {".vtk", ROLE_SURFACE | ROLE_TRACTS},
    {".vtp", ROLE_SURFACE | ROLE_TRACTS},
    {".trk", ROLE_TRACTS},
    {".tck", ROLE_TRACTS},
    {".trx", ROLE_TRACTS},
    {".tt", ROLE_TRACTS},
    {".xml", ROLE_SCENE | ROLE_POSES},
    {".mrk.json", ROLE_POSES},
    {".json", ROLE_SCENE | ROLE_POSES},
    {".csv", ROLE_POSES},
    {".tsv", ROLE_POSES},
    {".txt", ROLE_POSES},
    {".fcsv", ROLE_POSES},
    {".elc", ROLE_POSES},
    {".sfp", ROLE_POSES},
    {".pos", ROLE_POSES},
    {".dat", ROLE_POSES},
};
enum { ROWS = sizeof rows / sizeof rows[0] };

size_t ending_length(const char *name, size_t length, unsigned roles)
{
    const size_t packed = path_ending_within(name, length, ".gz");
    size_t longest = 0;
    for (size_t i = 0; i < ROWS; i++) {
        const size_t ending = rows[i].roles & roles ? path_ending_within(name, length - packed, rows[i].ending) : 0;
        longest = ending > longest ? ending : longest;
    }
    return longest ? longest + packed : 0;
}

size_t stem_length(const char *name, size_t length, unsigned roles)
{
    const size_t ending = ending_length(name, length, roles);
    return length - (ending ? ending : path_ending_within(name, length, ".gz"));
}

size_t volume_stem_length(const char *path)
{
    const size_t length = strlen(path);
    return length - ending_length(path, length, ROLE_VOLUME);
}

const char *ending_next(const char *ending, unsigned roles)
{
    size_t i = 0;
    for (bool is_behind = !ending; i < ROWS && !(is_behind && rows[i].roles & roles); i++) {
        is_behind = is_behind || rows[i].ending == ending;
    }
    return i < ROWS ? rows[i].ending : NULL;
}
