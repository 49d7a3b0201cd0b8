/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses lists of programs whose columns are known by their place: one row of a table each. Those that hold no
 * positions of a brain have a row, too, with the reason. */
#include "poses/programs/pose_programs.h"

#include "conus/own.h"
#include "poses/rows/pose_row.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

enum flags {
    IS_LPS = 1,          /* x grows to the left, y to the back */
    IS_CAP = 2,          /* names no space */
    NEEDS_MINUS = 8,     /* voxels, unless a number is negative, or the name has _std */
    NEEDS_LPS = 16,      /* the caller must say so */
    BEGINS_AT_ONCE = 64, /* the first line is a row, or it is no such list */
    FOLLOWS_SPACE = 128, /* x and y are as the caller says */
    ENDS_EARLY = 32      /* rows end at the line "info" */
};

#define SAVE_IN_MNI "bring its positions to the atlas's space (MNI), and save name,x,y,z in mm"
#define SAVE_NO_ANGLES "angles are not positions: save the cap's name,x,y,z in MNI, in mm"

/* A list is of the first row whose `ending` is that of the file's name and whose `mark` stands in its head. */
static const struct layout {
    const char *ending;  /* "" = any */
    const char *mark;    /* "" = none; "^": only where the text begins, "\n": where a line does */
    const char *refused; /* why it is not read; NULL = it is, by these: */
    const char *rows;    /* what lines of points begin with; "" = all, but comments and titles */
    const char *count;   /* the number behind it says how many points there are; NULL = none does */
    const char *space;   /* NULL = it names none */
    enum pose_brain brain;
    char separator;      /* 0: white space */
    signed char x, name; /* fields of x and of the name, -1 = none */
    unsigned flags;
} layouts[] = {
    /* AFNI: letters say which way a column grows. */
    {"", "MI RL  MI AP  MI IS", .x = 13, .name = -1, .flags = IS_LPS},
    {"", "MI LR  MI PA  MI IS", .x = 13, .name = -1},
    {"", "Coordinate order = RAI\n#Voxels  CM x   CM y   CM z  Peak x", .x = 4, .name = -1, .flags = IS_LPS},
    {"", "Coordinate order = LPI\n#Voxels  CM x   CM y   CM z  Peak x", .x = 4, .name = -1},
    {"", "Focus point (LPI)",
     .refused =
         "AFNI's whereami says one point in several spaces: put the x y z of {MNI}, not {TLRC}, into a line of their "
         "own"},
    /* FreeSurfer */
    {"", "Size(mm^2)  MNIX   MNIY   MNIZ", .space = "MNI 305", .brain = POSE_BRAIN_MNI305, .x = 4, .name = -1},
    {"", "Size(mm^2)  TalX   TalY   TalZ",
     .refused = "clusters in Talairach's space (FixMNI = 1): run mri_surfcluster again with --nofixmni"},
    {"", "vox2ras=scanner", .count = "\n", .space = "FreeSurfer scanner RAS", .brain = POSE_BRAIN_SUBJECT, .x = 1},
    {"", "^#!ascii label", .count = "\n", .space = "FreeSurfer tkRAS", .brain = POSE_BRAIN_OTHER, .x = 1},
    {"", "\nuseRealRAS 1", .count = "numpoints ", .space = "FreeSurfer scanner RAS", .brain = POSE_BRAIN_SUBJECT,
     .name = -1, .flags = ENDS_EARLY},
    {"", "\nuseRealRAS 0", .count = "numpoints ", .space = "FreeSurfer tkRAS", .brain = POSE_BRAIN_OTHER, .name = -1,
     .flags = ENDS_EARLY},
    {".LEPTO", "", .space = "FreeSurfer tkRAS", .brain = POSE_BRAIN_OTHER, .name = -1},
    /* FSL */
    {"", "^Cluster Index\tValue\tx\ty\tz", .x = 2, .flags = NEEDS_MINUS},
    {"", "^Cluster Index\tZ\tx\ty\tz", .x = 2, .flags = NEEDS_MINUS},
    {"", "MAX X (vox)",
     .refused = "clusters of FSL in voxels: take FEAT's cluster_*_std.txt, or run cluster with --mm on a map in the "
                "atlas's space"},
    {"", "\tZ-MAX\tZ-MAX X (mm)\t", .separator = '\t', .x = 5}, /* FEAT: before COPE-MAX */
    /* Peaks and foci */
    {"", "\nPeak MNI coordinate:", .rows = "Peak MNI coordinate:", .space = "MNI (xjView)", .brain = POSE_BRAIN_MNI152,
     .x = 3, .name = -1},
    {"", "Reference=Talairach", .refused = "foci in Talairach's space, some or all: GingerALE converts them to MNI"},
    {"", "\n//Reference=MNI", .space = "MNI (Sleuth)", .brain = POSE_BRAIN_MNI152, .name = -1},
    {"", "\n// Reference=MNI", .space = "MNI (Sleuth)", .brain = POSE_BRAIN_MNI152, .name = -1},
    {".node", "", .name = 5, .flags = FOLLOWS_SPACE}, /* BrainNet Viewer */
    /* Caps */
    {".sfp", "", .x = 1, .flags = IS_CAP},
    {"", "^FidNz", .x = 1, .flags = IS_CAP},
    {"", "^Number\tlabels\ttheta\tradius\tX\tY\tZ", .separator = '\t', .x = 4, .name = 1, .flags = IS_CAP},
    {"", "^Electrode,", .separator = ',', .x = 1, .name = 4, .flags = IS_CAP | BEGINS_AT_ONCE}, /* SimNIBS */
    {"", "^Fiducial,", .separator = ',', .x = 1, .name = 4, .flags = IS_CAP | BEGINS_AT_ONCE},
    {"", "^ReferenceElectrode,", .separator = ',', .x = 1, .name = 4, .flags = IS_CAP | BEGINS_AT_ONCE},
    {".hpts", "", .refused = "points of a head (.hpts) are in its own space: " SAVE_IN_MNI},
    {".pos", "", .refused = "points of a head by a Polhemus tracker (.pos) are in its own space: " SAVE_IN_MNI},
    {".elp", "", .refused = SAVE_NO_ANGLES},
    {".locs", "", .refused = SAVE_NO_ANGLES},
    {".loc", "", .refused = SAVE_NO_ANGLES},
    {"", "EF max. loc. (x)",
     .refused = "an export of Nexstim has the axes of its own image, which are no atlas's: bring the places to RAS mm "
                "of the scan, or to MNI, and save them as name,x,y,z"},
    {".fif", "", .refused = "a file of MNE's (.fif): " SAVE_IN_MNI},
    {".snirf", "", .refused = "a recording (SNIRF) has positions in a head's own space: " SAVE_IN_MNI},
    /* Others */
    {"", "^x,y,z,t,label", .separator = ',', .name = 4, .flags = NEEDS_LPS}, /* ANTs */
    {"", "; InputIndex = [",
     .refused =
         "elastix's outputpoints.txt has each point before and after a transform, in LPS: where the moving image is in "
         "the atlas's space, put the three numbers of OutputPoint into lines of their own, and type --space lps"},
    {"", "ITK-SNAP Annotation File", .refused = "landmarks of ITK-SNAP are voxels of an image, not positions in mm"},
    {"", "\\begin{tabular}", .refused = "a table of LaTeX: take its commands and & out, or save it as CSV"},
    {"", "\\toprule", .refused = "a table of LaTeX: take its commands and & out, or save it as CSV"},
};

/* ASA's .elc. */
static bool is_elc(struct text text)
{
    return text_starts(text, "# ASA electrode file") || text_starts(text, "# ASA optode file") ||
           text_starts(text, "ReferenceLabel") || text_starts(text, "NumberPositions=");
}

/* The point and the name of a line; false if its three fields are no numbers, with a message. */
static bool read_line(double point[3], struct text *name, const struct layout *layout, struct text line)
{
    struct text fields[3] = {{"", 0}, {"", 0}, {"", 0}};
    struct text field;
    bool more = true;
    *name = (struct text){"", 0};
    for (size_t at = 0;
         layout->separator ? text_field(&line, layout->separator, &more, &field) : text_word(&line, &field); at++) {
        size_t i = at - (size_t)layout->x;
        *name = (int)at == layout->name ? text_trim(field) : *name;
        if (i < 3) {
            fields[i] = text_trim(field);
        }
    }
    bool fine = layout->name < layout->x || name->size;
    if (!fine) {
        (void)fail(CONUS_ERROR_DATA, "fewer than %d fields", layout->name + 1);
    }
    for (size_t i = 0; fine && i < 3; i++) {
        fine = text_to_double(fields[i], &point[i]) && isfinite(point[i]);
        if (!fine) {
            (void)pose_no_number((const char[]){"xyz"[i], '\0'}, fields[i]);
        }
    }
    return fine;
}

static const struct layout *find_layout(struct text head, const char *path)
{
    const struct layout *found = NULL;
    const size_t size = path ? strlen(path) : 0;
    for (size_t i = 0; !found && i < sizeof layouts / sizeof layouts[0]; i++) {
        const struct layout *layout = &layouts[i];
        const char *mark = layout->mark;
        const size_t ending = strlen(layout->ending);
        bool is_named = ending <= size && strcasecmp((path ? path : "") + size - ending, layout->ending) == 0;
        bool is_first = (mark[0] == '\n' || mark[0] == '^') && text_starts(head, mark + 1);
        struct text rest = head;
        struct text line = {"", 0};
        struct text name;
        double point[3];
        (void)text_line(&rest, &line);
        found = is_named && (is_first || (mark[0] != '^' && text_find(head, mark))) ? layout : NULL;
        bool begins = !(layout->flags & BEGINS_AT_ONCE) || read_line(point, &name, layout, line);
        found = begins ? found : NULL;
    }
    return found;
}

bool pose_lists_know(struct text head, const char *path)
{
    struct text begin = pose_brackets_behind_comments(head);
    bool is_json = begin.size && begin.data[0] == '[' && text_find(begin, "{");
    return is_elc(head) || is_json || pose_brackets_are_rows(head) || find_layout(head, path) ||
           pose_brackets_in_cells(head);
}

static bool is_passed_over(const struct layout *layout, struct text line)
{
    line = text_trim(line);
    return !line.size || line.data[0] == '#' || text_starts(line, "//") ||
           (layout->rows && !text_starts(line, layout->rows));
}

static void read_points(const struct pose_reading *to, const struct layout *layout, struct text text, bool is_lps)
{
    struct text line;
    for (size_t number = 1; job_ok(to->job) && text_line(&text, &line); number++) {
        double point[3];
        struct text name = {"", 0};
        if ((layout->flags & ENDS_EARLY) && text_equal(text_trim(line), "info")) {
            break;
        }
        bool is_read = !is_passed_over(layout, line) && read_line(point, &name, layout, line);
        if (is_passed_over(layout, line) || (!is_read && !to->list->count)) { /* or a title, or names of columns */
            continue;
        }
        bool is_none = name.size && name.data[0] == '-'; /* as a vertex -1 */
        pose_add_point(to, number, point, is_lps, is_none ? text_from("") : name, is_read ? NULL : conus_message());
    }
}

static void check_count(const struct pose_reading *to, const struct layout *layout, struct text text)
{
    const char *at = layout->count ? text_find(text, layout->count) : NULL;
    struct text line = {"", 0};
    uint64_t stated;
    if (!at) {
        return;
    }
    at += strlen(layout->count);
    (void)text_line(&(struct text){at, text.size - (size_t)(at - text.data)}, &line);
    line = text_trim(line);
    if (!text_to_uint(line, UINT64_MAX, &stated) || stated != to->list->count) {
        job_bad(to->job, "%s: it says \"%.*s\" points, there are %zu: the file is not whole",
                layout->count[0] == 'N' ? "NumberPositions" : "numpoints", POSE_QUOTE(line), to->list->count);
    }
}

/* FSL's maxima: numbers of voxels count from 0. */
static void check_minus(const struct pose_reading *to)
{
    const conus_pose_list *list = to->list;
    bool is_mm = list->sink.path && strstr(list->sink.path, "_std");
    for (size_t i = 0; !is_mm && i < list->count; i++) {
        const double *p = list->rows[i].pose.world_from_device + 12;
        is_mm = !list->rows[i].error && (p[0] < 0 || p[1] < 0 || p[2] < 0);
    }
    if (!is_mm) {
        job_bad(to->job, "local maxima of FSL's cluster without a unit, none of them negative: these "
                         "are voxels; run cluster with --mm, or take FEAT's lmax_*_std.txt; if they are mm, call the "
                         "columns x (mm), y (mm), z (mm)");
    }
}

/* The first word of @p text behind the line that begins with @p key; "" where there is no such line. */
static struct text section(struct text text, const char *key)
{
    struct text line;
    bool found = false;
    while (!found && text_line(&text, &line)) {
        found = text_starts(line, key);
    }
    return found ? text : (struct text){"", 0};
}

/* "x y z" or "name : x y z"; false for a line that is neither. */
static bool read_electrode(double point[3], struct text *name, struct text line)
{
    const char *colon = memchr(line.data, ':', line.size);
    *name = colon ? text_trim((struct text){line.data, (size_t)(colon - line.data)}) : (struct text){"", 0};
    struct text rest = colon ? (struct text){colon + 1, line.size - (size_t)(colon + 1 - line.data)} : line;
    return read_line(point, &(struct text){"", 0}, &(const struct layout){.name = -1}, rest);
}

static void parse_elc(const struct pose_reading *to, struct text text)
{
    static const char unit_key[] = "UnitPosition";
    const char *unit_at = text_find(text, unit_key);
    struct text unit =
        unit_at ? (struct text){unit_at, text.size - (size_t)(unit_at - text.data)} : (struct text){"", 0};
    (void)text_line(&unit, &unit);
    unit =
        text_trim(unit.size ? (struct text){unit.data + sizeof unit_key - 1, unit.size - sizeof unit_key + 1} : unit);
    double scale = space_unit_mm(unit);
    struct text labels = section(text, "Labels");
    struct text positions = section(text, "Positions");
    struct text line;
    struct text label = {"", 0};
    size_t named = 0;
    if (!(scale > 0)) {
        job_bad(to->job, "UnitPosition \"%.*s\", allowed are mm, cm and m", POSE_QUOTE(unit));
    }
    for (size_t i = 0; job_ok(to->job) && text_line(&positions, &line) && !text_starts(line, "Labels"); i++) {
        struct text name = {"", 0};
        double point[3];
        bool is_read = read_electrode(point, &name, line);
        if (!text_trim(line).size) {
            continue;
        }
        label = (struct text){"", 0};
        named += text_word(&labels, &label) && !name.size; /* in the order of the positions */
        bool is_other = name.size != label.size || memcmp(name.data, label.data, name.size) != 0;
        if (name.size && label.size && is_other && !memchr(name.data, ' ', name.size)) {
            job_bad(to->job, "line %zu of Positions is of \"%.*s\", its word of Labels is \"%.*s\": which is it?",
                    i + 1, POSE_QUOTE(name), POSE_QUOTE(label));
        }
        pose_add_point(to, i + 1, point, false, name.size ? name : label, is_read ? NULL : "x y z are needed");
    }
    if (named && named + text_word(&labels, &label) != to->list->count) {
        job_bad(to->job, "%zu positions, and another number of Labels", to->list->count);
    }
    check_count(to, &(const struct layout){.count = "NumberPositions="}, text);
    to->list->is_cap = true;
    to->list->space.scale = scale;
}

static void parse_layout(const struct pose_reading *to, const struct layout *layout, struct text text)
{
    const conus_pose_options *options = to->options;
    bool follows = layout->flags & FOLLOWS_SPACE;
    bool is_lps = (layout->flags & (IS_LPS | NEEDS_LPS)) || (follows && options->space == CONUS_SPACE_LPS);
    if (layout->refused) {
        job_bad(to->job, "%s", layout->refused);
    }
    if ((layout->flags & NEEDS_LPS) && options->space != CONUS_SPACE_LPS) {
        job_bad(to->job, "x,y,z,t,label is how ANTs has points, which are LPS: --space lps reads them so; "
                         "if these are RAS, take the column t out");
    }
    if (layout->space) {
        to->list->space = pose_space_named(text_from(layout->space), layout->brain);
    }
    pose_note_space(to->job, to->options, is_lps);
    read_points(to, layout, text, is_lps);
    check_count(to, layout, text);
    if (layout->flags & NEEDS_MINUS) {
        check_minus(to);
    }
    to->list->is_cap = layout->flags & IS_CAP;
}

/* Points of programs whose lists have their columns in known places (pose_lists.c), FreeSurfer's and caps among them.
 * A list that is known, but holds no positions of a brain, is refused. */
void pose_lists_parse(struct pose_reading *to, struct text text)
{
    struct text begin = pose_brackets_behind_comments(text);
    const struct layout *layout = is_elc(text) ? NULL : find_layout(text, to->list->sink.path);
    bool is_in_brackets = pose_brackets_are_rows(text) || (begin.size && memchr("{[", begin.data[0], 2)) ||
                          (!layout && !is_elc(text) && pose_brackets_in_cells(text));
    if (is_in_brackets) {
        pose_brackets_parse(to, text);
        return;
    }
    if (to->options->space >= CONUS_SPACE_CCF) {
        job_bad(to->job, "lists of other programs are of people, and not in space %s",
                conus_space_name((size_t)to->options->space));
    }
    pose_refuse_axis(to, "points");
    if (is_elc(text)) {
        parse_elc(to, text);
    } else if (layout) {
        parse_layout(to, layout, text);
    } else {
        job_bad(to->job, "a list of an unknown program");
    }
}
