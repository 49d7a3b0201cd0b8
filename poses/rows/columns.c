/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the roles of columns by their names; or points without a header. */
#include "poses/rows/columns.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/status.h"
#include "conus/own.h"
#include "poses/rows/columns_head.h"
#include "sources/names.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SHOWN = 20 };

enum measure { NO_MEASURE, LENGTH, ANGLE, TIME }; /* mm, degrees, seconds */

static const char *const measures[] = {"", "a length", "an angle", "a time"};

/* Columns of one number or text, by exact names, perhaps with a unit behind, and by others; of the same role the first
 * name that is there. */
static const struct {
    enum column_role role;
    enum measure measure;
    const char *names; /* normalised, see normalise(); in the order of preference */
} roles[] = {
    {ROLE_QW, NO_MEASURE, "qw/q w/quat w/quaternion w/q0"},
    {ROLE_ANGLE, ANGLE, "angle/opening angle/opening/cone angle"},
    {ROLE_TIME, TIME, "time s/times/timestamp s"},
    {ROLE_TRIGGER, NO_MEASURE, "trigger"},
    {ROLE_ERROR_DEG, NO_MEASURE, "error deg"},
    {ROLE_ERROR_MM, NO_MEASURE, "error mm"},
    {ROLE_NEAR, LENGTH, "near"},
    {ROLE_FAR, LENGTH, "far"},
    {ROLE_DEPTH, LENGTH, "depth"},
    {ROLE_RADIUS, LENGTH, "radius"},
    {ROLE_TILT_ML, ANGLE, "tilt ml/ml tilt"},
    {ROLE_TILT_AP, ANGLE, "tilt ap/ap tilt"},
    {ROLE_PHI, ANGLE, "phi"},
    {ROLE_THETA, ANGLE, "theta"},
    {ROLE_NAME, NO_MEASURE,
     "query id/query/id/name/label/channel/electrode/contact/site/roi/region/sensor/optode/marker/area/structure/"
     "probe/trajectory/cluster/cluster id/cluster index/index"},
};

/* Other units than lengths. */
static const struct {
    enum measure measure;
    const char *names;
    double factor;
} units[] = {
    {ANGLE, "deg/degree/degrees/\xc2\xb0", 1},
    {ANGLE, "rad/radian/radians", 180 / MATH3_PI},
    {TIME, "s/sec/second/seconds", 1},
    {TIME, "ms/msec/millisecond/milliseconds", 0.001},
};

/* The third list: what a column says that makes a row no mere point. */
static const char turned[] = "normal/normals/nrm/vec/vector/orient/orientation/ori/rot/rotation/roll/pitch/yaw/azimuth/"
                             "elevation/tilt/twist/arc/ring/collar/handle/euler/axis";

/* And beside a depth alone, which would be straight down. */
static const char inclined[] = "angle/angles/inclination/winkel/theta/phi/coronal/sagittal";

/* Columns that make balls or cones of rows in other tables than those of BIDS. */
static const char read_in_tables[] = "radius/near/far/phi/theta";

static const struct {
    enum family_kind kind;
    const char *words;
} words_of[] = {
    {NEUTRAL, "pos/position/positions/coord/coords/coordinate/coordinates/centroid/centre/center/peak/peaks/loc/"
              "location/contact/ras/lps/world/point/max/in/mm/ccf"},
    {CENTRE, "cog/cm/com/mean"},
    {OF_SPACE, "mni/mni152/icbm/icbm152/mnispace"},
    {OTHER_SPACE, "tal/talairach/native/scanner/acpc/mcp/tk/tkr/tkras/fs/surf/surface/vox/voxel/voxels/ijk/t1/ct/orig/"
                  "subject/subj/individual/leksell/ctf/head/mni305/fsaverage/rai/lpi/las/lai/rpi/rps/ral/lar"},
    {STATISTIC, "sd/se/err/error/size/std/sem/var/stdev"},
    {ENTRY, "entry/from/start/coil/transducer/device"},
    {TARGET, "target/tgt/to/tip/end/focus/t"},
    {AIM, "aim"},
    {DIRECTION, "d/dir/direction"},
    {UP, "u/up"},
    {QUATERNION, "q/quat/quaternion"},
    {TURNED, "n/r"},
};

size_t conus_pose_path_length(const char *path)
{
    return keys_file_length(path, KEYS_POSES);
}

/* mm of the unit that a key names; 0 where it is not given. */
static conus_status read_unit(double *out, const struct source_keys *keys, enum source_key_id id)
{
    const struct key_value *unit = keys_value(keys, id);
    *out = unit->text.size ? space_unit_mm(text_trim(unit->text)) : 0;
    return !unit->text.size || *out > 0 ? CONUS_OK
                                        : fail(CONUS_ERROR_ARGUMENT, "%s: found \"%.*s\", %s", keys_name(unit),
                                               POSE_QUOTE(unit->text), keys_allowed(unit));
}

conus_status columns_words_parse(struct columns_words *out, const char *text)
{
    *out = (struct columns_words){0};
    struct source_keys keys = {0};
    if (text && *text && !keys_read_alone(&keys, text, KEYS_POSES)) {
        return fail(CONUS_ERROR_ARGUMENT, "%s", keys.why);
    }
    int count = 0;
    for (int k = 0; k < 3; k++) {
        out->at[k] = text_trim(keys_value(&keys, (enum source_key_id)(KEY_X + k))->text);
        count += out->at[k].size > 0;
    }
    out->name = text_trim(keys_value(&keys, KEY_NAME)->text);
    out->place = text_trim(keys_value(&keys, KEY_PLACE)->text);
    out->any_sides = keys.given & KEY_BIT(KEY_SIDES);
    out->tilt[0] = text_trim(keys_value(&keys, KEY_TILT_ML)->text);
    out->tilt[1] = text_trim(keys_value(&keys, KEY_TILT_AP)->text);
    conus_status status = read_unit(&out->unit, &keys, KEY_UNIT);
    status = status ? status : read_unit(&out->length[0], &keys, KEY_DEPTH);
    status = status ? status : read_unit(&out->length[1], &keys, KEY_RADIUS);
    return status || count == 0 || count == 3 ? status
                                              : fail(CONUS_ERROR_ARGUMENT, "only some of x=, y= and z= are given");
}

struct text columns_word_of_axes(const struct columns_words *words)
{
    const struct text unit = text_from(words->length[0] > 0 ? "depth" : words->length[1] > 0 ? "radius" : "");
    return words->tilt[0].size ? words->tilt[0] : words->tilt[1].size ? words->tilt[1] : unit;
}

/* Where a column of x, y or z says that its numbers grow: 'L' of "X (L)" and "Pos X [L+]"; 0 = it does not. @p open:
 * the name without that. */
static char direction_of(struct text *open, struct text cell)
{
    *open = cell;
    const size_t closed = cell.size && memchr(")]", cell.data[cell.size - 1], 2) ? cell.size - 1 : 0;
    const size_t size = closed && cell.data[closed - 1] == '+' ? closed - 1 : closed;
    const struct text name = text_trim((struct text){cell.data, size > 2 ? size - 2 : 0});
    bool is_one = name.size && memchr("([", cell.data[size - 2], 2) && memchr("RLAPSI", cell.data[size - 1], 6) &&
                  memchr("xyzXYZ", name.data[name.size - 1], 6);
    *open = is_one ? name : cell;
    return is_one ? cell.data[size - 1] : '\0';
}

/* The name in small letters, with one blank for what stands between words, and without a unit in brackets or behind:
 * "MNI_X (mm)" is "mni x". Other brackets are words. */
static double normalise(char out[COLUMN_NAME_SIZE], struct text cell)
{
    double unit = 0;
    struct text open = cell;
    char last = cell.size ? cell.data[cell.size - 1] : 0;
    const char *bracket = last == ')'   ? text_last(cell, '(')
                          : last == ']' ? text_last(cell, '[')
                          : last == '}' ? text_last(cell, '{')
                                        : NULL;
    if (bracket) {
        const char *end = cell.data + cell.size - 1;
        unit = space_unit_mm(text_trim((struct text){bracket + 1, (size_t)(end - bracket - 1)}));
        open.size = unit != 0 ? (size_t)(bracket - cell.data) : cell.size;
    }
    open = text_trim(open);
    size_t size = 0;
    for (size_t i = 0; i < open.size && size + 1 < COLUMN_NAME_SIZE; i++) {
        char c = open.data[i];
        bool is_gap = strchr(" _-.,/:()[]{}\"'\t", c) != NULL;
        if (!is_gap || (size && out[size - 1] != ' ')) {
            out[size++] = is_gap ? ' ' : c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
        }
    }
    size -= size && out[size - 1] == ' ';
    out[size] = '\0';
    const char *behind = unit == 0 ? strrchr(out, ' ') : NULL;
    if (behind && text_is_one_of(text_from(behind + 1), "mm/um/in/inch/inches/px/pixel/pixels/ft", true) &&
        strcmp(out, "error mm") != 0) {
        unit = space_unit_mm(text_from(behind + 1));
        out[behind - out] = '\0';
        char *in = strrchr(out, ' ');
        if (in && strcmp(in, " in") == 0) { /* "x in mm" */
            *in = '\0';
        }
    }
    return unit;
}

static size_t find_text(const struct head *head, struct text name, size_t first)
{
    size_t i = first;
    while (i < head->line.count && !text_equal(name, head->names[i])) {
        i++;
    }
    return i < head->line.count ? i : COLUMN_NONE;
}

static size_t find_name(const struct head *head, const char *name, size_t first)
{
    return find_text(head, text_from(name), first);
}

/* Whether each of the names is that of a column. */
static bool has_names(const struct head *head, const char *names)
{
    struct text rest = text_from(names);
    struct text name;
    bool all = true;
    for (bool more = true; all && text_field(&rest, '/', &more, &name);) {
        all = find_text(head, name, 0) != COLUMN_NONE;
    }
    return all;
}

/* The unit that a text is. Its factor is below 0 where it is not taken, 0 where there is none. */
static enum measure find_unit(double *factor, struct text text)
{
    *factor = space_unit_mm(text);
    enum measure measure = *factor != 0 ? LENGTH : NO_MEASURE;
    for (size_t i = 0; i < sizeof units / sizeof units[0] && !measure; i++) {
        bool is_one = text_is_one_of(text, units[i].names, true);
        measure = is_one ? units[i].measure : NO_MEASURE;
        *factor = is_one ? units[i].factor : 0;
    }
    return measure;
}

/* The same as find_name(), with the unit behind the name, if the column has one. */
static size_t find_measured(enum measure *measure, double *factor, const struct head *head, struct text name,
                            size_t first)
{
    for (size_t i = first; i < head->line.count; i++) {
        const char *rest = head->names[i] + name.size;
        bool begins = strncmp(head->names[i], name.data, name.size) == 0;
        *factor = head->unit[i];
        *measure = *factor != 0 ? LENGTH : NO_MEASURE;
        if (begins && rest[0] == ' ') {
            rest += strncmp(rest, " in ", 4) == 0 ? 4 : 1;
            *measure = find_unit(factor, text_from(rest));
            rest += *measure ? strlen(rest) : 0;
        }
        if (begins && !rest[0]) {
            return i;
        }
    }
    return COLUMN_NONE;
}

static bool is_capital(const struct head *head, size_t column)
{
    struct text cell = head->line.cells[column];
    size_t i = 0;
    while (i < cell.size && !(cell.data[i] >= 'A' && cell.data[i] <= 'Z')) {
        i++;
    }
    return i < cell.size;
}

/* Whether these are the names of three columns that stand side by side from this one on, all of one case. */
static bool is_triple(const struct head *head, size_t first, const char *const names[3])
{
    bool is_one = first + 2 < head->line.count;
    for (size_t k = 0; is_one && k < 3; k++) {
        is_one =
            strcmp(head->names[first + k], names[k]) == 0 && is_capital(head, first + k) == is_capital(head, first);
    }
    return is_one;
}

static enum family_kind kind_of(const char *stem, bool *is_peak)
{
    enum family_kind kind = NEUTRAL;
    struct text rest = text_from(stem);
    struct text word;
    while (text_word(&rest, &word)) {
        enum family_kind own = text_has_only(word, "0123456789") ? NEUTRAL : UNKNOWN;
        for (size_t i = 0; i < sizeof words_of / sizeof words_of[0]; i++) {
            own = text_is_one_of(word, words_of[i].words, true) ? words_of[i].kind : own;
        }
        own = text_is_one_of(word, turned, true) ? TURNED : own;
        *is_peak = *is_peak || text_is_one_of(word, "peak/max", true);
        kind = own > kind ? own : kind;
    }
    return kind;
}

static void add_family(struct head *head, const size_t at[3], const char *name, size_t from, size_t size)
{
    if (head->family_count == COLUMN_FAMILIES) {
        return;
    }
    struct family *family = &head->families[head->family_count];
    *family = (struct family){.at = {at[0], at[1], at[2]}};
    char stem[COLUMN_NAME_SIZE];
    snprintf(stem, sizeof stem, "%.*s %s", (int)from, name, name + from + size);
    struct text trimmed = text_trim(text_from(stem));
    snprintf(family->stem, sizeof family->stem, "%.*s", (int)trimmed.size, trimmed.data);
    family->kind = kind_of(family->stem, &family->is_peak);
    for (size_t i = 0; i < head->family_count; i++) { /* found by another of its letters */
        if (memcmp(head->families[i].at, at, sizeof family->at) == 0) {
            return;
        }
    }
    head->family_count++;
}

/* Of a name that stands twice the one whose column makes three that stand side by side, of one case; else a fault. */
static void settle_twice(struct head *head, size_t at[3], const char *const names[3])
{
    size_t settled = COLUMN_NONE;
    size_t found = 0;
    bool is_twice[3];
    for (int k = 0; k < 3; k++) {
        is_twice[k] = at[k] != COLUMN_NONE && find_name(head, names[k], at[k] + 1) != COLUMN_NONE;
    }
    if (!is_twice[0] && !is_twice[1] && !is_twice[2]) {
        return;
    }
    for (size_t i = 0; i < head->line.count; i++) {
        bool is_one = is_triple(head, i, names);
        settled = is_one ? i : settled;
        found += is_one;
    }
    for (size_t k = 0; found == 1 && k < 3; k++) { /* the other one must differ in its case */
        for (size_t i = find_name(head, names[k], 0); i != COLUMN_NONE; i = find_name(head, names[k], i + 1)) {
            found += i != settled + k && text_compare(head->line.cells[i], head->line.cells[settled + k]) == 0;
        }
    }
    const bool all = found != 1 && is_twice[0] && is_twice[1] && is_twice[2];
    FAULT_IF(all, head,
             "columns %s %s %s twice: if they are the ends of an axis, call them entry_x entry_y entry_z and target_x "
             "target_y target_z, in one header line; else keep three",
             names[0], names[1], names[2]);
    for (size_t k = 0; k < 3; k++) {
        FAULT_IF(found != 1 && is_twice[k] && !all, head, "column \"%s\" twice", names[k]);
        at[k] = found == 1 ? settled + k : at[k];
    }
}

/* Families of the letters, each a name of an axis. */
static void find_families(struct head *head, const char *const letters[3])
{
    const size_t size = strlen(letters[0]);
    for (size_t i = 0; i < head->line.count; i++) {
        for (int letter = 0; letter < 2; letter++) { /* two of the three are needed */
            const char *name = head->names[i];
            for (const char *at = strstr(name, letters[letter]); at; at = strstr(at + 1, letters[letter])) {
                size_t from = (size_t)(at - name);
                bool before = from && isalpha((unsigned char)name[from - 1]);
                bool after = isalpha((unsigned char)name[from + size]);
                char found[3][COLUMN_NAME_SIZE];
                size_t columns[3];
                size_t count = 0;
                for (int k = 0; k < 3; k++) {
                    snprintf(found[k], sizeof found[k], "%.*s%s%s", (int)from, name, letters[k], name + from + size);
                    columns[k] = find_name(head, found[k], 0);
                    count += columns[k] != COLUMN_NONE;
                }
                bool is_first = columns[letter] == i && (!letter || columns[0] == COLUMN_NONE);
                if ((before && after) || count < 2 || !is_first) {
                    continue;
                }
                settle_twice(head, columns, (const char *const[]){found[0], found[1], found[2]});
                add_family(head, columns, name, from, size);
            }
        }
    }
}

/* R A S, L P S: only three neighbours of one case, where there is no x y z. */
static void find_letters(struct head *head)
{
    static const char *const sets[2][3] = {{"r", "a", "s"}, {"l", "p", "s"}};
    for (size_t i = 0; i < 2 * head->line.count; i++) {
        if (is_triple(head, i / 2, sets[i % 2]) && head->family_count < COLUMN_FAMILIES) {
            head->families[head->family_count++] =
                (struct family){.at = {i / 2, i / 2 + 1, i / 2 + 2}, .has_letters = true, .is_lps = i % 2};
        }
    }
}

static bool is_whole(const struct family *family)
{
    return family->at[0] != COLUMN_NONE && family->at[1] != COLUMN_NONE && family->at[2] != COLUMN_NONE;
}

static void set_role(struct head *head, size_t column, enum column_role role)
{
    struct columns *out = head->out;
    const uint8_t before = out->role_of[column];
    out->role_of[column] = (uint8_t)role;
    if (before != ROLES && !memchr(out->role_of, before, sizeof out->role_of)) {
        out->has[before] = false;
    }
    out->has[role] = true;
    snprintf(out->shown[role], COLUMN_NAME_SIZE, "%.*s", TEXT_SHOW(head->line.cells[column], COLUMN_NAME_SIZE - 1));
}

static size_t count_roles(const struct columns *columns, enum column_role first, size_t count)
{
    size_t found = 0;
    for (size_t i = 0; i < count; i++) {
        found += columns->has[first + i];
    }
    return found;
}

/* The columns of a family as the header has them: "MNI_X MNI_Y MNI_Z". */
static const char *show_family(char out[3 * COLUMN_NAME_SIZE], const struct head *head, const struct family *family)
{
    size_t size = 0;
    out[0] = '\0';
    for (int k = 0; k < 3; k++) {
        if (family->at[k] != COLUMN_NONE) {
            struct text cell = head->line.cells[family->at[k]];
            size += (size_t)snprintf(out + size, COLUMN_NAME_SIZE, "%s%.*s", size ? " " : "", TEXT_SHOW(cell, 30));
        }
    }
    return out;
}

#define FAMILY_SHOWN(head, family) show_family((char[3 *COLUMN_NAME_SIZE]){0}, head, family)

/* What a column of positions is called in --space, or where the table lacks that. */
static const char *axis_shown(const struct head *head, size_t axis)
{
    static const char *const plain[2][3] = {{"x", "y", "z"}, {"AP", "ML", "DV"}};
    const conus_space space = head->options->space;
    bool is_plain = has_names(head, "x") || has_names(head, "y");
    return is_plain || space < CONUS_SPACE_CCF ? plain[head->lacks_space][axis] : conus_space_axis(space, axis);
}

/* Says where a column counts from that would be the axis which is missing: "DV (dura)". */
static void say_origin(struct head *head)
{
    for (size_t i = 0; i < head->line.given; i++) {
        bool is_of_dura = false;
        struct text rest = text_from(head->names[i]);
        for (struct text word; text_word(&rest, &word);) {
            is_of_dura = is_of_dura || text_is_one_of(word, "dura/pia/skull/surface", true);
        }
        FAULT_IF(is_of_dura, head, "column \"%.*s\" is %s", POSE_QUOTE(head->line.cells[i]), space_why_dura);
    }
}

/* Gives the columns of a family their roles, or says what it lacks. */
static void take_family(struct head *head, const struct family *family, enum column_role first, const char *what)
{
    struct columns *out = head->out;
    double unit = 0; /* mm */
    if (!family) {
        return;
    }
    for (size_t k = 0; k < 3; k++) {
        if (family->at[k] == COLUMN_NONE) {
            FAULT(head, "only some of the columns %s: %s, without %s", what, FAMILY_SHOWN(head, family),
                  axis_shown(head, k));
            say_origin(head);
            continue;
        }
        const struct text cell = head->line.cells[family->at[k]];
        FAULT_IF(text_starts(cell, "-") && !head->is_named, head,
                 "column \"%.*s\" says that its numbers have the other sign: turn them, and call it %.*s",
                 POSE_QUOTE(cell), (int)cell.size - 1, cell.data + 1);
        const char grows = head->has_axes ? direction_of(&(struct text){0}, cell) : '\0';
        const int side = k == 2 || !grows ? 0 : grows == "RA"[k] ? 1 : grows == "LP"[k] ? -1 : 0;
        FAULT_IF((grows && !side && (k < 2 || grows != 'S')) || side * head->side < 0, head,
                 "column \"%.*s\" says another axis or sign than %c%s: turn the columns to RAS", POSE_QUOTE(cell),
                 (head->side < 0 ? "LPS" : "RAS")[k], head->side ? " of other columns or --space" : "");
        head->side = side ? side : head->side;
        out->said.may_be_lps |= side < 0;
        double own = head->unit[family->at[k]];
        FAULT_IF(own != 0 && unit != 0 && own != unit, head, "%s: two units, %s", what, FAMILY_SHOWN(head, family));
        unit = own != 0 ? own : unit;
        set_role(head, family->at[k], first + (enum column_role)k);
    }
    const char *behind = family->at[0] != COLUMN_NONE ? strrchr(head->names[family->at[0]], ' ') : NULL;
    FAULT_IF(
        first < ROLE_DX && behind && text_is_one_of(text_from(behind + 1), "cm/m", true) && unit == 0 &&
            !(head->words.unit > 0),
        head,
        "%s: is %s a unit or, as in centre of mass, a word? brackets make it a unit; if it is a word, type %s,unit=mm",
        FAMILY_SHOWN(head, family), behind ? behind + 1 : "", out->file);
    double scale = unit / columns_space_mm(out->space);
    FAULT_IF(unit == SPACE_UNIT_REFUSED && !(head->words.unit > 0), head,
             "%s: %s; only if they are mm, type %s,unit=mm", FAMILY_SHOWN(head, family), space_why_unit, out->file);
    if (unit > 0 && first < ROLE_DX) {
        FAULT_IF(out->scale > 0 && out->scale != scale, head, "two units: positions and targets have different ones");
        out->scale = scale;
    }
    if (family->has_letters) {
        out->said.has_signs = true;
        out->said.signs = family->is_lps ? CONUS_SPACE_LPS : CONUS_SPACE_RAS;
    }
    if (first == ROLE_X && family->at[0] != COLUMN_NONE) {
        struct space_words said = out->said;
        space_words_hear_of(&said, text_from(head->names[family->at[0]]));
        space_words_hear_of(&said, text_from(family->stem)); /* of "TalX", one word, "tal" */
        out->said = head->options->any_space ? (struct space_words){.has_signs = said.has_signs, .signs = said.signs}
                                             /* x_lps is x_lps */
                                             : said;
    }
}

/* Whether `a` is a better position than `b`, +1, a worse one, -1, or neither. */
static int compare_positions(const struct family *a, const struct family *b)
{
    int by_space = (a->kind == OF_SPACE) - (b->kind == OF_SPACE);
    int by_centre = (b->kind == CENTRE) - (a->kind == CENTRE);
    return by_space ? by_space : by_centre ? by_centre : a->is_peak - b->is_peak;
}

/* The family that says where rows are; of two that say it alike neither, with a fault. */
static const struct family *find_position(struct head *head)
{
    const struct family *best = NULL;
    const struct family *tied = NULL;
    for (size_t i = 0; i < head->family_count; i++) {
        const struct family *family = &head->families[i];
        if (family->kind > OF_SPACE || (best && is_whole(best) && !is_whole(family))) {
            continue;
        }
        int order = !best || (!is_whole(best) && is_whole(family)) ? 1 : compare_positions(family, best);
        tied = order > 0 ? NULL : order == 0 ? family : tied;
        best = order > 0 ? family : best;
    }
    FAULT_IF(
        tied, head,
        "positions in %s or in %s: rename those that are not meant; the ends of an axis are called entry_x entry_y "
        "entry_z and target_x target_y target_z",
        FAMILY_SHOWN(head, best), FAMILY_SHOWN(head, tied));
    return best;
}

/* The only family of this kind. */
static const struct family *find_kind(struct head *head, enum family_kind kind)
{
    const struct family *found = NULL;
    for (size_t i = 0; i < head->family_count; i++) {
        const struct family *family = &head->families[i];
        bool is_better = family->kind == kind && (!found || (!is_whole(found) && is_whole(family)));
        FAULT_IF(family->kind == kind && found && is_whole(found) && is_whole(family), head, "%s and %s: which is it?",
                 FAMILY_SHOWN(head, found), FAMILY_SHOWN(head, family));
        found = is_better ? family : found;
    }
    return found;
}

static void drop_role(struct head *head, enum column_role role)
{
    for (size_t i = 0; i < head->line.count && head->out->has[role]; i++) {
        head->out->role_of[i] = head->out->role_of[i] == role ? ROLES : head->out->role_of[i];
    }
    head->out->has[role] = false;
}

/* Columns of one number or text each. */
static void find_roles(struct head *head)
{
    for (size_t r = 0; r < sizeof roles / sizeof roles[0]; r++) {
        struct text rest = text_from(roles[r].names);
        struct text name;
        enum column_role role = roles[r].role;
        for (bool more = true; !head->out->has[role] && text_field(&rest, '/', &more, &name);) {
            enum measure measure = NO_MEASURE;
            double factor = 0;
            bool has_unit = roles[r].measure;
            size_t column = has_unit ? find_measured(&measure, &factor, head, name, 0) : find_text(head, name, 0);
            if (column == COLUMN_NONE || head->out->role_of[column] != ROLES) {
                continue;
            }
            const struct text cell = head->line.cells[column];
            bool is_loose = role == ROLE_NAME && !text_is_one_of(name, "query id/query/id/name", true);
            size_t again = has_unit ? find_measured(&(enum measure){0}, &(double){0}, head, name, column + 1)
                                    : find_text(head, name, column + 1);
            FAULT_IF(!is_loose && again != COLUMN_NONE, head, "column \"%.*s\" twice", POSE_QUOTE(cell));
            FAULT_IF(measure && measure != roles[r].measure, head, "column \"%.*s\": the unit of %s, and it is %s",
                     POSE_QUOTE(cell), measures[measure], measures[roles[r].measure]);
            FAULT_IF(measure == roles[r].measure && factor < 0, head, "column \"%.*s\": %s", POSE_QUOTE(cell),
                     space_why_unit);
            if (has_unit) {
                head->out->factor[role] = factor;
            }
            set_role(head, column, role);
        }
    }
    size_t electrode = find_name(head, "electrode", 0);
    size_t contact = find_name(head, "contact", 0);
    if (electrode != COLUMN_NONE && contact != COLUMN_NONE && head->out->role_of[electrode] == ROLE_NAME) {
        bool is_empty = head->row_count && !head->cells[electrode].filled;
        if (is_empty) {
            drop_role(head, ROLE_NAME);
        }
        set_role(head, contact, is_empty ? ROLE_NAME : ROLE_CONTACT);
    }
    for (size_t i = 0; i < MATRIX_NUMBERS; i++) {
        char name[8];
        snprintf(name, sizeof name, "m%zu%zu", i / 4, i % 4);
        size_t column = find_name(head, name, 0);
        if (column != COLUMN_NONE && head->out->role_of[column] == ROLES) {
            set_role(head, column, ROLE_M00 + (enum column_role)i);
        }
    }
}

static const char angles[] = "are angles, whose order programs do not agree on: export a matrix (m00...m33) or a "
                             "quaternion (qw qx qy qz); without them the rows are points";

/* A column beside a position, without a role, that says that rows are more than points, or no axis straight down. */
static void refuse_turned(struct head *head, const struct family *position)
{
    const bool is_straight = !head->out->is_of_points;
    bool is_other = false; /* ex_x ey_x ez_x are also ex_x ex_y ex_z */
    for (size_t i = 0; i < head->family_count && !is_other; i++) {
        const struct family *family = &head->families[i];
        bool is_beside = family->kind == UNKNOWN && position->kind != OF_SPACE && is_whole(family);
        bool is_end = head->out->is_bids && family->kind >= TARGET && family->kind <= QUATERNION && is_whole(family);
        for (size_t k = 0; k < 3 && is_end; k++) { /* of nothing but n/a it is none */
            is_end = head->cells[family->at[k]].numbers > 0;
        }
        FAULT_IF(is_end, head, "%s beside x y z: --poses-format table reads them; without them the rows are points",
                 FAMILY_SHOWN(head, family));
        is_other = family != position && (family->kind == TURNED || is_beside || family->kind == ENTRY);
        const bool is_of_sensor = is_other && has_names(head, "ex x/ey x/ez x");
        FAULT_IF(is_of_sensor, head,
                 "ex ey ez beside %s are axes of a sensor: bring positions and axes from its space to the atlas's, and "
                 "call the axis into the head dx dy dz (turn its signs where it points out)",
                 FAMILY_SHOWN(head, position));
        bool are_angles = is_other && (text_starts(text_from(family->stem), "rot") || strstr(family->stem, " rot") ||
                                       strstr(family->stem, "euler"));
        FAULT_IF(are_angles, head, "%s beside %s %s", FAMILY_SHOWN(head, family), FAMILY_SHOWN(head, position), angles);
        FAULT_IF(is_other && !is_of_sensor && !are_angles, head,
                 "%s beside %s: if they are a direction into the head, call them dx dy dz (turn the signs of one out "
                 "of it); a point to look at is tx ty tz, an axis entry_x entry_y entry_z and target_x target_y "
                 "target_z; without %s the rows are points",
                 FAMILY_SHOWN(head, family), FAMILY_SHOWN(head, position), FAMILY_SHOWN(head, family));
    }
    struct buffer list = {0};
    bool is_of_frame = false;
    bool are_angles = has_names(head, "yaw/pitch/roll");
    for (size_t i = 0; i < head->line.count; i++) {
        struct text rest = text_from(head->names[i]);
        struct text word;
        bool is_one = false;
        while (head->out->role_of[i] == ROLES && text_word(&rest, &word)) {
            is_of_frame = is_of_frame || text_is_one_of(word, "arc/ring/collar", true);
            is_one = is_one || text_is_one_of(word, turned, true) ||
                     (is_straight && text_is_one_of(word, inclined, true) && strcmp(head->names[i], "angle") != 0);
        }
        is_one =
            is_one || (is_straight && head->out->role_of[i] == ROLES && head->cells[i].numbers &&
                       (text_mentions(head->line.cells[i], "deg") || text_mentions(head->line.cells[i], "\xc2\xb0")));
        is_one = is_one && (!head->out->is_bids || head->cells[i].numbers); /* else names of shafts */
        for (size_t k = 0; is_one && k < head->family_count; k++) {
            const size_t *at = head->families[k].at;
            is_one = !is_whole(&head->families[k]) || (at[0] != i && at[1] != i && at[2] != i);
        }
        const bool is_read = head->out->is_bids && text_is_one_of(text_from(head->names[i]), read_in_tables, true);
        FAULT_IF(is_read && !is_one && head->cells[i].numbers, head,
                 "column \"%.*s\" beside %s: --poses-format table reads it; without it the rows are points",
                 POSE_QUOTE(head->line.cells[i]), FAMILY_SHOWN(head, position));
        if (is_one) {
            buffer_format(&list, "%s\"%.*s\"", list.size ? ", " : "", POSE_QUOTE(head->line.cells[i]));
        }
    }
    (void)JOB_CALL(head->job, buffer_status(&list));
    FAULT_IF(list.size && is_of_frame, head,
             "column %s beside %s is of a stereotactic frame, and so are these: bring them to the atlas's space (to "
             "take it out is not enough); an axis is entry_x entry_y entry_z and target_x target_y target_z",
             list.data, FAMILY_SHOWN(head, position));
    FAULT_IF(list.size && are_angles, head, "%s beside %s %s", list.data, FAMILY_SHOWN(head, position), angles);
    FAULT_IF(list.size && !is_of_frame && !are_angles, head,
             "column %s beside %s is not read: take it out if the rows are %s; a direction is dx dy dz, a target tx ty "
             "tz%s, a rotation qw qx qy qz or m00...m33%s",
             list.data, FAMILY_SHOWN(head, position), is_straight ? "straight down" : "points",
             head->options->space < CONUS_SPACE_CCF ? "" : ", a tilt tilt_ml and tilt_ap or phi and theta",
             head->out->is_bids ? ", with --poses-format table here" : "");
    buffer_finish(&list);
}

/* Whether the column is 0 in all rows of the head. */
static bool is_all_zero(const struct head *head, size_t column)
{
    return head->cells[column].zeros == head->row_count;
}

/* The column that the user calls so; a fault where there is none, or where it stands twice. */
static size_t find_word(struct head *head, struct text word)
{
    size_t found = COLUMN_NONE;
    size_t count = 0;
    for (size_t i = 0; i < head->line.count; i++) {
        struct text cell = head->line.cells[i];
        bool is_it = cell.size && cell.size == word.size &&
                     (head->out->is_bids ? text_compare(cell, word) == 0 : text_contains(cell, word));
        found = is_it && !count ? i : found;
        count += is_it;
    }
    FAULT_IF(count != 1, head, "column \"%.*s\" %s", POSE_QUOTE(word), count ? "twice" : "is not there");
    return found;
}

/* The position that the user names; NULL: none. */
static const struct family *find_named(struct head *head)
{
    if (!head->words.at[0].size) {
        return NULL;
    }
    head->named = (struct family){.kind = OF_SPACE};
    for (int k = 0; k < 3; k++) {
        head->named.at[k] = find_word(head, head->words.at[k]);
    }
    const size_t *at = head->named.at;
    bool are_three = at[0] != at[1] && at[0] != at[2] && at[1] != at[2];
    FAULT_IF(is_whole(&head->named) && !are_three, head, "one column is named twice as x, y or z");
    return is_whole(&head->named) && are_three ? &head->named : NULL;
}

/* Roles and units that the user names; columns of tilts, or COLUMN_NONE, to `tilted`. */
static void take_words(struct head *head, size_t tilted[2])
{
    struct columns *out = head->out;
    for (size_t k = 0; k < 2; k++) {
        const enum column_role role = ROLE_TILT_ML + (enum column_role)k;
        const struct text word = head->words.tilt[k];
        const size_t column = word.size ? find_word(head, word) : COLUMN_NONE;
        const double unit = head->words.length[k];
        tilted[k] = column;
        if (column != COLUMN_NONE && out->role_of[column] >= ROLE_ANGLE) {
            const char *behind = strrchr(head->names[column], ' ');
            double factor = 0;
            drop_role(head, role); /* of a column that is called so */
            set_role(head, column, role);
            out->factor[role] = behind && find_unit(&factor, text_from(behind + 1)) == ANGLE ? factor : 0;
        }
        FAULT_IF(unit > 0 && !out->has[ROLE_DEPTH + k], head, "a unit of %s, and no such column",
                 k ? "radius" : "depth");
        out->factor[ROLE_DEPTH + k] = unit > 0 ? unit : out->factor[ROLE_DEPTH + k];
    }
}

/* Columns that the user calls x, y and z are nothing else. */
static void take_named(struct head *head)
{
    const struct family *named = find_named(head);
    for (size_t i = 0; named && i < head->family_count; i++) {
        struct family *family = &head->families[i];
        for (size_t k = 0; k < 9; k++) {
            family->kind = family->at[k / 3] == named->at[k % 3] ? STATISTIC : family->kind;
        }
    }
    take_family(head, named, ROLE_X, "x y z");
}

static const char on_its_side[] = "a table on its side, whose rows are called x, y and z: exchange rows and columns";

/* Whether rows are called x, y and z, each once, perhaps with a word in front and a unit. */
static bool is_on_its_side(const struct head *head)
{
    struct text rest = head->text;
    struct text text;
    struct text cell;
    struct table_line line;
    size_t called[3] = {0};
    while (text_line(&rest, &text)) {
        char name[COLUMN_NAME_SIZE];
        if (!table_split(&line, &head->out->table, text) || line.count < 2) {
            continue;
        }
        (void)direction_of(&cell, line.cells[0]);
        (void)normalise(name, cell);
        const char *letter = strrchr(name, ' ') ? strrchr(name, ' ') + 1 : name;
        called[0] += strcmp(letter, "x") == 0;
        called[1] += strcmp(letter, "y") == 0;
        called[2] += strcmp(letter, "z") == 0;
    }
    return called[0] == 1 && called[1] == 1 && called[2] == 1;
}

/* Coordinates whose header names another image, which space words do not know: of those that they know the brain is
 * compared with the atlas's. */
static void refuse_other_space(struct head *head, const struct family *position)
{
    struct space_words words = {0};
    const size_t column = position->at[position->at[0] == COLUMN_NONE]; /* one of the three may be missing */
    space_words_hear_of(&words, text_from(head->names[column]));
    space_words_hear_of(&words, text_from(position->stem));
    FAULT_IF(!words.space.brain && !words.why && !words.has_signs && !head->options->any_space, head,
             "%s are named after another image or space: convert them to the atlas's, or bring the atlas to them "
             "(--atlas-transform); then %s",
             FAMILY_SHOWN(head, position), space_any(head->options->space));
}

/* A beam begins at its focus, whichever of its ends the table has first. */
static void find_beam(struct head *head, const struct family **position, const struct family **target)
{
    const struct family *ends[] = {*position, *target};
    bool is_focus[2];
    for (int i = 0; i < 2; i++) {
        is_focus[i] = strstr(ends[i]->stem, "focus") || (ends[i]->kind == TARGET && strcmp(ends[i]->stem, "t") != 0);
    }
    FAULT_IF(is_focus[0] == is_focus[1], head,
             "a beam has a focus and a transducer, and %s or %s may be either: call them focus_x focus_y focus_z and "
             "transducer_x transducer_y transducer_z",
             FAMILY_SHOWN(head, ends[0]), FAMILY_SHOWN(head, ends[1]));
    *position = ends[is_focus[1]];
    *target = ends[!is_focus[1]];
}

/* Whether columns are called as places in an array: i j k, row column slice, ix iy iz. */
static bool are_indices(const struct head *head)
{
    bool found = has_names(head, "i/j") || has_names(head, "row/col/slice") || has_names(head, "row/column/slice") ||
                 has_names(head, "dim0/dim1/dim2") || has_names(head, "dim1/dim2/dim3");
    for (size_t i = 0; i < head->family_count; i++) {
        found = found || text_is_one_of(text_from(head->families[i].stem), "i/ind/idx/index/indices/array", true);
    }
    return found;
}

static void choose_families(struct head *head)
{
    struct columns *out = head->out;
    const struct family *named = out->has[ROLE_X] ? &head->named : NULL;
    const struct family place = {.kind = OF_SPACE, .at = {out->place - 1, COLUMN_NONE, COLUMN_NONE}};
    const struct family *position = out->place ? &place : named ? named : find_position(head);
    const struct family *entry = find_kind(head, ENTRY);
    const struct family *target = find_kind(head, TARGET);
    const struct family *direction = find_kind(head, DIRECTION);
    const struct family *up = find_kind(head, UP);
    const struct family *quaternion = find_kind(head, QUATERNION);
    bool has_matrix = count_roles(out, ROLE_M00, MATRIX_NUMBERS) > 0;
    bool has_quaternion = quaternion || out->has[ROLE_QW];
    if (!position) {
        bool is_log = !entry && has_quaternion && target && strcmp(target->stem, "t") == 0; /* of a tracker */
        bool is_of_target = !entry && !direction && !has_quaternion && !has_matrix;
        position = entry ? entry : is_log || is_of_target ? target : NULL;
        position = position ? position : find_kind(head, OTHER_SPACE);
        target = position == target ? NULL : target;
    }
    if (direction && strcmp(direction->stem, "d") == 0 && target && strcmp(target->stem, "tip") == 0) {
        target = NULL; /* rows of conus plan say where the tip is, on the axis */
    }
    if (position && position->kind == OTHER_SPACE && !named) {
        refuse_other_space(head, position);
    }
    if (head->options->aperture > 0 && position && target) {
        find_beam(head, &position, &target);
    }
    take_family(head, named || out->place ? NULL : position, ROLE_X, "x y z");
    take_family(head, target, ROLE_TX, "tx ty tz");
    take_family(head, find_kind(head, AIM), ROLE_AIM, "aim_x aim_y aim_z");
    take_family(head, direction, ROLE_DX, "dx dy dz");
    take_family(head, up, ROLE_UX, "ux uy uz");
    take_family(head, quaternion, ROLE_QX, "qw qx qy qz");
    out->ends_at_target = target && strcmp(target->stem, "t") != 0;
    bool has_tilt = out->has[ROLE_TILT_ML] || out->has[ROLE_TILT_AP];
    bool has_angles = out->has[ROLE_PHI] && out->has[ROLE_THETA];
    bool is_of_rodents = head->options->space >= CONUS_SPACE_CCF || head->lacks_space;
    int directions = (target != NULL) + (direction != NULL) + has_quaternion + has_matrix + has_tilt + has_angles;
    out->is_straight = directions == 0 && out->has[ROLE_DEPTH] && is_of_rodents;
    out->is_of_points = directions == 0 && !out->is_straight;
    FAULT_IF(out->place && !out->is_of_points && (is_of_rodents || !has_angles), head,
             "a direction or a depth beside names of places, which are points");
    bool are_xyz_of_bregma = head->options->space == CONUS_SPACE_BREGMA && position && is_whole(position) &&
                             position->stem[0] == '\0' && find_name(head, "x", 0) == position->at[0];
    out->is_mlapdv = has_angles && are_xyz_of_bregma;
    FAULT_IF(are_xyz_of_bregma && out->is_of_points && !head->is_named, head,
             "x y z from bregma: if x is AP and y is ML, type %s,x=x,y=y,z=z; if x is ML and y is AP, as IBL has it, "
             "type %s,x=y,y=x,z=z",
             out->file, out->file);
    if (out->has[ROLE_THETA] || has_names(head, "sph radius")) { /* of a sphere or a drawing */
        drop_role(head, ROLE_RADIUS);
    }
    FAULT_IF(out->has[ROLE_RADIUS] && !out->is_of_points, head,
             "column \"%s\" is that of a ball around a point, beside a direction; --radius MM makes cylinders",
             out->shown[ROLE_RADIUS]);
    if (!has_angles) { /* alone they are statistics */
        drop_role(head, ROLE_PHI);
        drop_role(head, ROLE_THETA);
    }
    FAULT_IF(
        has_angles && !is_of_rodents, head,
        "phi and theta are angles; those of a cap are not positions: save its name,x,y,z in MNI, in mm; those of a "
        "probe need --space bregma and an atlas of the Allen CCF");
    if (head->lacks_space && position && !named) {
        FAULT(head,
              "%s: from AC, PC or MCP, bring them to the atlas's space (a shift is not enough), and call them x y z "
              "(right, front, top); from bregma (mm) or in the CCF (um) they need an atlas of the Allen CCF, with "
              "--space bregma or --space ccf",
              FAMILY_SHOWN(head, position));
    }
    FAULT_IF(has_tilt && out->has[ROLE_TILT_ML] != out->has[ROLE_TILT_AP] && !head->words.tilt[0].size &&
                 !head->words.tilt[1].size,
             head, "only one of the columns tilt_ml and tilt_ap: is the other one 0?");
    const uint8_t *angle = memchr(out->role_of, ROLE_ANGLE, sizeof out->role_of);
    if (angle && (out->is_of_points || out->has[ROLE_DEPTH]) && is_all_zero(head, (size_t)(angle - out->role_of))) {
        drop_role(head, ROLE_ANGLE); /* whichever it is, it says nothing */
    }
    FAULT_IF(out->has[ROLE_ANGLE] && out->has[ROLE_DEPTH] && !strstr(out->shown[ROLE_ANGLE], "pening"), head,
             "\"%s\" beside depth: the opening of a cone (call it opening), or the tilt of the probe?",
             out->shown[ROLE_ANGLE]);
    FAULT_IF(has_quaternion && !(quaternion && out->has[ROLE_QW]), head, "only some of the columns qw qx qy qz");
    FAULT_IF(has_matrix && count_roles(out, ROLE_M00, MATRIX_NUMBERS) < MATRIX_NUMBERS, head,
             "only some of the columns m00...m33");
    FAULT_IF(directions > 1, head,
             "several directions; needed is one of tx ty tz (a target), dx dy dz, qw qx qy qz, or m00...m33 alone");
    FAULT_IF(has_matrix && position, head, "x y z are needed, and only, without m00...m33");
    if (!has_matrix && !position) {
        FAULT_IF(head->is_on_its_side, head, "%s", on_its_side);
        bool are_voxels = are_indices(head);
        bool are_others = false;
        FAULT_IF(!head->is_on_its_side, head, "%s %s %s, the positions, are missing%s", axis_shown(head, 0),
                 axis_shown(head, 1), axis_shown(head, 2), head->row_count ? "" : ", and no row has three numbers");
        FAULT_IF(are_voxels, head, "i j k are %s", space_why_voxels);
        FAULT_IF(!head->is_on_its_side && !head->row_count && head->out->has[ROLE_NAME], head,
                 "a list of places has names of areas or of positions (C3)");
        for (size_t i = 0; i < head->family_count; i++) {
            const struct family *family = &head->families[i];
            bool is_other = !are_voxels && (family->kind == UNKNOWN || family->kind == TURNED);
            FAULT_IF(is_other, head, "only if %s are positions, and no direction, call them x y z",
                     FAMILY_SHOWN(head, family));
            are_others = are_others || is_other;
        }
        FAULT_IF(head->row_count && !head->is_on_its_side && !are_voxels && !are_others && !head->words.at[0].size,
                 head, "if three do, type '%s,x=COLUMN,y=COLUMN,z=COLUMN'", out->file);
    }
    FAULT_IF(up && !target && !direction, head, "ux uy uz go with tx ty tz or dx dy dz");
    if (out->is_straight && position && !named) {
        refuse_turned(head, position);
    }
    if (!out->is_of_points || !position) {
        return;
    }
    size_t t = find_name(head, "t", 0);
    bool is_of_ants = t == 3 && find_name(head, "x", 0) == 0 && find_name(head, "y", 0) == 1 &&
                      find_name(head, "z", 0) == 2 && head->row_count && is_all_zero(head, t);
    FAULT_IF(is_of_ants && out->space == CONUS_SPACE_RAS && !head->options->any_space, head,
             "x,y,z,t with t 0 in all rows is how ANTs has points, which are LPS: --space lps reads them so; if these "
             "are RAS, take the column t out");
    FAULT_IF(out->has[ROLE_ANGLE], head,
             "column \"%s\" is the opening of a cone, which needs a direction: tx ty tz, dx dy dz or qw qx qy qz; of "
             "points, and of those asked inward, whose opening is --angle, take it out",
             out->shown[ROLE_ANGLE]);
    if (out->has[ROLE_DEPTH] && named) {
        drop_role(head, ROLE_DEPTH);
    }
    FAULT_IF(out->has[ROLE_DEPTH], head,
             "depth needs a direction: add dx dy dz, a target tx ty tz, or tilt_ml tilt_ap; take depth out only if x y "
             "z are the tips");
    FAULT_IF(out->has[ROLE_NEAR] || out->has[ROLE_FAR], head,
             "near and far are depths along a direction: tx ty tz, dx dy dz or qw qx qy qz");
    if (!named) { /* the user's word is enough */
        FAULT_IF(has_names(head, "m0n0/m2n2"), head,
                 "m0n0...m2n2 are Brainsight's, whose comments are missing: put its line \"# Coordinate system: ...\" "
                 "above, and \"# \" in front of the names of columns");
        refuse_turned(head, position);
    }
}

/* Where nothing else names the rows: the first column if it has no name of its own, or the first one of texts; all of
 * its cells differ. */
static void find_row_names(struct head *head)
{
    struct columns *out = head->out;
    enum { COMPARED = 500 };
    for (size_t column = 0; !out->has[ROLE_NAME] && column < out->count; column++) {
        struct text seen[COMPARED];
        size_t rows = 0;
        bool fits = out->role_of[column] == ROLES;
        bool is_index = column == 0 && !head->line.cells[0].size;
        for (size_t r = 0; fits && rows < COMPARED && r < head->row_count; r++) {
            double value;
            struct text cell = columns_cell(head, r, column);
            bool is_number = table_number(&value, &out->table, cell);
            fits = cell.size && (is_index ? !is_number || (value == floor(value) && fabs(value) < 1e9) : !is_number);
            for (size_t i = 0; fits && i < rows; i++) {
                fits = text_compare(seen[i], cell) != 0;
            }
            seen[rows++] = cell;
        }
        if (fits && rows) {
            set_role(head, column, ROLE_NAME);
            if (!is_index) {
                job_note(head->job, "rows are called by column \"%.*s\"", POSE_QUOTE(head->line.cells[column]));
            }
        }
    }
}

/* The known column that was perhaps meant: it is not there, and little is to be changed; "" if there is none. */
static struct text column_meant(const struct columns *columns, const char *field)
{
    struct text axes = text_from("tx/ty/tz/dx/dy/dz/qw/qx/qy/qz"); /* in the order of the roles; "x" is like all */
    struct text meant = {"", 0};
    size_t length = strlen(field);
    size_t least = (length + 1) / 3;
    for (enum column_role role = ROLE_TX; role < ROLE_NAME; role++) {
        struct text names = text_from(role == ROLE_SPACE ? "space" : "");
        struct text name = {"", 0};
        for (size_t r = 0; role >= ROLE_ANGLE && r < sizeof roles / sizeof roles[0]; r++) {
            names = roles[r].role == role ? text_from(roles[r].names) : names;
        }
        (void)text_field(role < ROLE_M00 ? &axes : &names, '/', &(bool){true}, &name);
        size_t distance = text_distance(text_from(field), name);
        if (!columns->has[role] && distance > 0 && distance <= least && distance < name.size &&
            (name.size > 2 || length > name.size)) {
            meant = name;
            least = distance;
        }
    }
    return meant;
}

/* Whether something is read from a column. */
static bool is_read(const struct columns *out, size_t column)
{
    bool is_known = out->role_of[column] != ROLES || out->pairs == column + 1 || out->place == column + 1 ||
                    (out->place && out->place_side == column + 1);
    for (size_t k = 0; k < out->kept_count; k++) {
        is_known = is_known || out->kept[k] == column;
    }
    return is_known;
}

/* The columns, or only those that are not read, with suggestions for these, as a text of the job. */
static const char *shown_columns(const struct head *head, bool all)
{
    struct buffer list = {0};
    size_t count = 0;
    for (size_t i = 0; i < head->line.given; i++) {
        const bool is_known = is_read(head->out, i);
        if ((is_known && !all) || count++ >= SHOWN) {
            continue;
        }
        const struct text meant = is_known ? (struct text){"", 0} : column_meant(head->out, head->names[i]);
        buffer_format(&list, "%s\"%.*s\"", count > 1 ? ", " : "", POSE_QUOTE(head->line.cells[i]));
        if (meant.size) {
            buffer_format(&list, " (did you mean %.*s?)", TEXT_SHOW(meant, COLUMN_NAME_SIZE));
        }
    }
    if (count > SHOWN) {
        buffer_format(&list, " and %zu more", count - SHOWN);
    }
    const char *shown =
        JOB_CALL(head->job, buffer_status(&list)) ? job_copy(head->job, (struct text){list.data, list.size}) : "";
    buffer_finish(&list);
    return shown;
}

/* Whether depths without a unit are longer in all rows than the atlas, which they were not in um. */
static bool are_depths_long(const struct head *head)
{
    const struct columns *out = head->out;
    const uint8_t *depth = memchr(out->role_of, ROLE_DEPTH, sizeof out->role_of);
    return depth && head->row_count && head->cells[depth - out->role_of].longs == head->row_count &&
           out->space != CONUS_SPACE_CCF && out->factor[ROLE_DEPTH] == 0 && out->scale == 0 && head->words.unit == 0;
}

/* The words that answer all that is asked of a table of probes: its space, the angle, the unit of depths. */
static void settle_probes(struct head *head)
{
    const struct columns *out = head->out;
    const enum column_role tilt = out->has[ROLE_TILT_ML]   ? ROLE_TILT_ML
                                  : out->has[ROLE_TILT_AP] ? ROLE_TILT_AP
                                                           : ROLE_ANGLE;
    const char *own = tilt == ROLE_TILT_ML ? "ml" : "ap";
    bool is_one = tilt != ROLE_ANGLE ? out->has[ROLE_TILT_ML] != out->has[ROLE_TILT_AP] : out->is_straight;
    bool is_tilted = out->has[tilt] && is_one && !head->words.tilt[0].size && !head->words.tilt[1].size;
    bool are_long = are_depths_long(head);
    if (!out->has[ROLE_DEPTH] || !(is_tilted || (are_long && head->lacks_space)) || out->is_of_points ||
        count_roles(out, ROLE_X, 3) < 3) {
        return;
    }
    FAULT_IF(are_long, head, "depths are longer than the atlas in mm: are they in um?");
    const char *depth = are_long ? ",depth=um" : "";
    FAULT(head, "to say all at once, type %s'%s", head->lacks_space ? "--space bregma, and " : "", out->file);
    if (is_tilted && tilt == ROLE_ANGLE) {
        buffer_format(&head->faults, ",tilt_ml=%s%s' (the tip goes to the side) or '%s,tilt_ap=%s%s' (to the front)",
                      out->shown[tilt], depth, out->file, out->shown[tilt], depth);
    } else if (is_tilted) {
        buffer_format(&head->faults, ",tilt_%s=%s%s' (the other tilt is 0)", own, out->shown[tilt], depth);
    } else {
        buffer_format(&head->faults, "%s'", depth);
    }
}

/* A column "target" or "entry" of names beside points may be the other end of an axis, or a word about the row. */
static void refuse_lone_end(struct head *head)
{
    struct columns *out = head->out;
    for (size_t i = 0; out->is_of_points && !head->is_named && i < head->line.given; i++) {
        const char *s = head->names[i];
        bool has_name = head->cells[i].given > head->cells[i].numbers && out->role_of[i] == ROLES &&
                        text_is_one_of(text_from(s), "target/entry", true);
        if (has_name && out->has[ROLE_NAME] && out->has[ROLE_X]) {
            FAULT(head,
                  "column \"%.*s\": if it only names each point, type '%s,x=%s,y=%s,z=%s'; if the axis %s there, add "
                  "%s_x %s_y %s_z",
                  POSE_QUOTE(head->line.cells[i]), out->file, out->shown[ROLE_X], out->shown[ROLE_X + 1],
                  out->shown[ROLE_X + 2], s[0] == 't' ? "ends" : "begins", s, s, s);
        }
    }
}

/* A column whose cells are all entry, target and the like makes one axis of two rows with one name. */
static void find_pairs(struct head *head)
{
    struct columns *out = head->out;
    for (size_t column = 0; out->is_of_points && !head->is_named && column < out->count; column++) {
        const size_t *ends = head->cells[column].ends;
        if (out->role_of[column] < ROLE_NAME || !ends[END_ENTRY] || !ends[END_TARGET] ||
            ends[END_ENTRY] + ends[END_TARGET] < head->row_count) {
            continue;
        }
        if (out->role_of[column] == ROLE_CONTACT) {
            drop_role(head, ROLE_CONTACT);
        }
        FAULT_IF(out->role_of[column] == ROLE_NAME || !out->has[ROLE_NAME], head,
                 "column \"%.*s\" has an entry and a target in two rows, and no column says by a name which two belong "
                 "together",
                 POSE_QUOTE(head->line.cells[column]));
        out->pairs = column + 1;
    }
}

/* Whether the cells of a column are words of a space: all of them; in one that is `named` so at least one. */
static bool is_of_spaces(const struct head *head, size_t column, bool named, bool strong)
{
    const struct column_cells *cells = &head->cells[column];
    const size_t heard = strong ? cells->strong : cells->spaces;
    return heard && (named || heard == cells->given);
}

/* Columns whose cells say in which space or unit the positions of their rows are. */
static void find_spaces(struct head *head)
{
    static const char named[] = "space/coordinate space/coord space/coordspace/coordinate system/coord system/"
                                "coordsystem/coordsys/template/template space/standard space/stereotaxic space/"
                                "coordinate type/coord type";
    static const char loose[] = "frame/reference/reference frame/reference space/system/brain/atlas/normalization/"
                                "normalisation/orientation/axes/convention";
    static const char typed[] = "type/kind/coord/coords/coordinate/coordinates/position/positions";
    static const char of_units[] = "unit/units/coordinate unit/coordinate units/coord unit/coord units/position unit/"
                                   "position units/xyz unit/xyz units";
    struct columns *out = head->out;
    for (size_t i = 0; i < head->line.given; i++) {
        const struct text name = text_from(head->names[i]);
        bool is_space = strcmp(head->names[i], "space") == 0 && !out->is_bids;
        bool is_named = text_is_one_of(name, named, true);
        bool is_unit = text_is_one_of(name, of_units, true);
        bool are_voxels = head->row_count && head->cells[i].voxels == head->row_count;
        if (out->role_of[i] != ROLES) {
            continue;
        }
        if (is_unit && head->cells[i].units) {
            set_role(head, i, ROLE_UNIT);
        } else if (is_space || (text_is_one_of(name, typed, true) && are_voxels) ||
                   is_of_spaces(head, i, (is_named || is_unit) && !out->is_bids,
                                !is_named && !is_unit && !text_is_one_of(name, loose, true))) {
            set_role(head, i, ROLE_SPACE);
        }
    }
}

/* Whether it has AP, ML and DV, called so, in no space of theirs, where nothing else may say what rows are: then these
 * are a family, for a refusal that asks for the space. */
static bool lacks_space(struct head *head)
{
    static const char *const names[3] = {"ap", "ml", "dv"};
    size_t at[3];
    size_t count = 0;
    for (size_t k = 0; k < 3; k++) {
        at[k] = find_name(head, names[k], 0);
        count += at[k] != COLUMN_NONE;
    }
    bool is_said = head->out->place || head->words.place.size || head->words.at[0].size || head->family_count;
    bool is_one =
        count > 1 && !is_said && head->options->space < CONUS_SPACE_CCF && find_name(head, "m00", 0) == COLUMN_NONE;
    if (is_one) {
        settle_twice(head, at, names);
        add_family(head, at, names[0], 0, strlen(names[0]));
    }
    return is_one;
}

/* Roles of a line that may be a header. Faults say what is wrong with it. */
static void find_columns(struct head *head)
{
    static const char *const xyz[3] = {"x", "y", "z"};
    struct columns *out = head->out;
    head->family_count = 0;
    head->faults.size = 0;
    memset(out->role_of, ROLES, sizeof out->role_of);
    memset(out->has, 0, sizeof out->has);
    memset(out->factor, 0, sizeof out->factor);
    out->scale = 0;
    out->said = (struct space_words){0};
    out->pairs = 0;
    out->space = head->options->space;
    struct text open;
    head->side = out->space == CONUS_SPACE_LPS ? -1 : 0;
    head->has_axes = false; /* (L) and (R) alone may be of hemispheres */
    for (size_t i = 0; i < head->line.count; i++) {
        const char grows = direction_of(&open, head->line.cells[i]);
        head->has_axes = head->has_axes || (grows && grows != 'L' && grows != 'R');
    }
    for (size_t i = 0; i < head->line.count; i++) {
        (void)direction_of(&open, head->line.cells[i]);
        head->unit[i] = normalise(head->names[i], head->has_axes ? open : head->line.cells[i]);
    }
    for (size_t i = 2; i < head->line.count; i++) { /* SPM's spreadsheet calls each of the three so */
        bool is_triad = strcmp(head->names[i - 2], "x y z") == 0 && strcmp(head->names[i - 1], "x y z") == 0 &&
                        strcmp(head->names[i], "x y z") == 0;
        for (size_t k = 0; k < 3 && is_triad; k++) {
            snprintf(head->names[i - 2 + k], COLUMN_NAME_SIZE, "%c", "xyz"[k]);
        }
    }
    out->count = head->line.given;
    if (out->space >= CONUS_SPACE_CCF) {
        char axes[3][COLUMN_NAME_SIZE];
        for (size_t k = 0; k < 3; k++) {
            (void)normalise(axes[k], text_from(conus_space_axis(out->space, k)));
        }
        find_families(head, (const char *const[]){axes[0], axes[1], axes[2]});
    }
    if (out->space == CONUS_SPACE_CCF) { /* AllenSDK */
        find_families(head, (const char *const[]){"anterior posterior", "dorsal ventral", "left right"});
    }
    find_families(head, xyz);
    if (!has_names(head, "x")) {
        find_letters(head);
    }
    head->lacks_space = lacks_space(head);
    size_t column = head->words.name.size ? find_word(head, head->words.name) : COLUMN_NONE;
    if (column != COLUMN_NONE) {
        set_role(head, column, ROLE_NAME);
    }
    size_t tilted[2] = {COLUMN_NONE, COLUMN_NONE};
    take_named(head);
    if (out->is_bids) { /* other columns are of others, unless they say that rows are more than points */
        out->is_of_points = true;
        if (!head->is_named) {
            refuse_turned(head, &head->named);
        }
        FAULT_IF(columns_word_of_axes(&head->words).size, head,
                 "tilt_ml=, tilt_ap=, depth= and radius= are for tables, as --poses-format table reads them");
        find_spaces(head);
        find_pairs(head);
    } else {
        find_roles(head);
        take_words(head, tilted);
        if (out->place && !out->has[ROLE_NAME]) {
            set_role(head, out->place - 1, ROLE_NAME);
        }
        find_spaces(head);
        choose_families(head);
        find_pairs(head);
        refuse_lone_end(head);
    }
    FAULT_IF(column != COLUMN_NONE && out->role_of[column] != ROLE_NAME, head,
             "column \"%.*s\" is called a name, but it is one of a position or direction",
             POSE_QUOTE(head->line.cells[column]));
    for (size_t k = 0; k < 2; k++) {
        FAULT_IF(tilted[k] != COLUMN_NONE && out->role_of[tilted[k]] != ROLE_TILT_ML + k, head,
                 "column \"%.*s\" is called a tilt, but it is one of a position or direction, or the other tilt",
                 POSE_QUOTE(head->line.cells[tilted[k]]));
    }
}

/* Whether some of the columns of a line belong together as coordinates, so that it is a header. */
static bool has_triad(const struct head *head)
{
    bool has = count_roles(head->out, ROLE_M00, MATRIX_NUMBERS) == MATRIX_NUMBERS ||
               (head->words.at[0].size && is_whole(&head->named));
    for (size_t i = 0; i < head->family_count; i++) {
        has = has || is_whole(&head->families[i]);
    }
    return has;
}

static void take_cells(struct table_line *line, size_t at, size_t count)
{
    line->given -= count;
    memmove(line->cells + at, line->cells + at + count, (line->given - at) * sizeof line->cells[0]);
    line->count = line->given;
}

static struct text join_cells(struct text first, struct text last)
{
    return (struct text){first.data, (size_t)(last.data + last.size - first.data)};
}

/* Whether nothing but the words of spaces and units and the like that a header has more than rows have cells is taken
 * from it, in front and behind: "columns: x (mm) y (mm) z (mm)". What was taken is head->beside. */
static bool shorten(struct head *head, size_t cells)
{
    struct table_line *line = &head->line;
    bool has_units = false; /* behind each name */
    for (size_t i = 1; i < line->given && line->given > cells; i++) {
        const struct text cell = line->cells[i];
        if (strchr("([", cell.data[0]) && space_words_are_beside(cell) && (has_units || i + 1 < line->given)) {
            line->cells[i - 1] = join_cells(line->cells[i - 1], cell);
            take_cells(line, i--, 1);
            has_units = true;
        }
    }
    size_t last = line->given;
    while (last > cells && space_words_are_beside(line->cells[last - 1])) {
        last--;
    }
    size_t first = 0;
    while (last - first > cells && space_words_are_beside(line->cells[first])) {
        first++;
    }
    if (last - first != cells) {
        return false;
    }
    head->beside[0] = first ? join_cells(line->cells[0], line->cells[first - 1]) : text_from("");
    head->beside[1] = last < line->given ? join_cells(line->cells[last], line->cells[line->given - 1]) : text_from("");
    take_cells(line, last, line->given - last);
    take_cells(line, 0, first);
    return true;
}

/* A header split as the rows are; between blanks also by two, or by one. */
static bool split_header(struct head *head, struct text text, size_t cells)
{
    struct table table = head->out->table;
    bool of_blanks = table.separator == TABLE_BLANKS || table.separator == TABLE_SPACES;
    bool found = table_split(&head->line, &table, text);
    head->beside[0] = head->beside[1] = text_from("");
    for (int i = 0; of_blanks && cells && head->line.given != cells && i < 2; i++) {
        table.separator = i ? TABLE_SPACES : TABLE_BLANKS;
        found = table_split(&head->line, &table, text);
    }
    if (found && cells && head->line.given > cells && !shorten(head, cells)) {
        found = table_split(&head->line, &table, text);
    }
    return found;
}

/* Puts a column without a name into the header, as its column `at`. */
static void put_nameless(struct table_line *line, size_t at)
{
    memmove(line->cells + at + 1, line->cells + at, (line->given - at) * sizeof line->cells[0]);
    line->cells[at] = (struct text){"", 0};
    line->count = ++line->given;
}

/* Whether most rows have numbers where this header has them. */
static bool fits_rows(const struct head *head)
{
    size_t fits = 0;
    for (size_t r = 0; r < head->row_count; r++) {
        bool all = true;
        for (size_t i = 0; i < head->out->count; i++) {
            double value;
            const enum column_role role = head->out->role_of[i];
            const struct text cell = columns_cell(head, r, i);
            all = all && (role >= ROLE_SPACE || role == ROLE_TRIGGER || table_number(&value, &head->out->table, cell) ||
                          (role >= ROLE_ANGLE && columns_is_absent(cell)));
        }
        fits += all;
    }
    return 2 * fits > head->row_count && (count_roles(head->out, ROLE_X, 3) == 3 || head->out->has[ROLE_M00]);
}

/* Whether the first cells are in quotation marks, and no number is: a program's names of rows. */
static bool begins_with_quoted(const struct head *head)
{
    bool all = true;
    for (size_t r = 0; r < head->row_count && all; r++) {
        const struct head_row *row = &head->rows[r];
        for (size_t i = 0; i < row->count && all; i++) {
            double value;
            const struct text cell = row->cells[i];
            bool is_quoted = cell.size && cell.data > head->text.data && cell.data[-1] == '"';
            all = i ? !is_quoted || !table_number(&value, &head->out->table, cell) : is_quoted;
        }
    }
    return all;
}

/* How far a cell is from the beginning of its line; with *is_first whether blanks alone are before it. */
static size_t offset_of(bool *is_first, const struct head *head, struct text cell)
{
    const char *at = cell.data;
    *is_first = true;
    while (at > head->text.data && !strchr("\r\n", at[-1])) {
        at--;
        *is_first = *is_first && strchr(" \t", *at);
    }
    return (size_t)(cell.data - at);
}

/* Whether the header begins behind the first cells, as R and pandas print a table. */
static bool begins_behind(const struct head *head, struct text first_name)
{
    bool all = head->out->table.separator >= TABLE_BLANKS;
    size_t begin = all ? offset_of(&all, head, first_name) : 0;
    for (size_t r = 0; r < head->row_count && all; r++) {
        const struct text cell = head->rows[r].cells[0];
        all = offset_of(&(bool){false}, head, cell) + cell.size <= begin;
    }
    return all;
}

/* What the first row is by this header: "A" at -42, -20, 50. */
static void show_reading(char out[COLUMN_NAME_SIZE * 4], const struct head *head, size_t row)
{
    size_t used = 0;
    out[0] = '\0';
    for (size_t i = 0; i < head->out->count; i++) {
        const enum column_role role = head->out->role_of[i];
        const struct text cell = columns_cell(head, row, i);
        if (role == ROLE_NAME || role < ROLE_ANGLE) {
            used +=
                (size_t)snprintf(out + used, COLUMN_NAME_SIZE * 4 - used, role == ROLE_NAME ? "%s\"%.*s\"" : "%s%.*s",
                                 used ? ", " : "", TEXT_SHOW(cell, 12));
        }
        used = used < COLUMN_NAME_SIZE * 3 ? used : 0; /* of a matrix the end */
    }
}

/* Whether rows fit the header with a column without a name at `at`, or, of shorter rows, without that name. */
static bool fits_with(char reading[COLUMN_NAME_SIZE * 4], struct head *head, const struct table_line *given, size_t at,
                      bool is_longer, size_t row)
{
    struct table_line *line = &head->line;
    *line = *given;
    if (is_longer) {
        put_nameless(line, at);
    } else {
        take_cells(line, at, 1);
    }
    find_columns(head);
    show_reading(reading, head, row);
    return fits_rows(head);
}

/* Rows of one cell more than the header: the first column has no name (R), or the last one; or all of one less: one of
 * these is missing. Where both may be, neither is taken, with a fault. */
static void complete_header(struct head *head)
{
    struct table_line *line = &head->line;
    const size_t named = line->given;
    size_t row = 0; /* the first one of the longest */
    size_t cells = 0;
    size_t longest = 0;
    for (size_t r = 0; r < head->row_count; r++) {
        size_t own = head->rows[r].count == head->out->table.cells ? head->rows[r].count : 0;
        while (own && !head->rows[r].cells[own - 1].size) {
            own--;
        }
        row = own > cells ? r : row;
        cells = own > cells ? own : cells;
        longest = head->rows[r].count > longest ? head->rows[r].count : longest;
    }
    if (cells > named && line->count > named) { /* empty names at its end are those of columns */
        line->given = cells < line->count ? cells : line->count;
        find_columns(head);
        return;
    }
    const bool is_longer = named + 1 == cells && cells <= TABLE_CELLS;
    if (!is_longer && longest + 1 != named) {
        return;
    }
    const struct table_line given = *line;
    const char *what = is_longer ? "has no name" : "is missing";
    char readings[2][COLUMN_NAME_SIZE * 4];
    bool is_last = fits_with(readings[1], head, &given, named - !is_longer, is_longer, row);
    bool is_first = fits_with(readings[0], head, &given, 0, is_longer, row);
    if (!is_longer || (is_last && !is_first)) {
        *line = given;
        if (is_longer) {
            put_nameless(line, named);
        }
        find_columns(head);
    }
    bool is_printed = is_longer && (begins_with_quoted(head) || begins_behind(head, given.cells[0]));
    FAULT_IF(is_first && is_last && !is_printed, head,
             "%zu names above rows of %zu cells: the row is %s if the first column %s, and %s if the last one %s; name "
             "each column",
             named, is_longer ? cells : longest, readings[0], what, readings[1], what);
}

/* Looks for the header above the first row: a line of as many cells, with coordinates among them, or a comment of that
 * kind; else the first line of as many cells. Without a row any line with coordinates. */
static bool find_header(struct head *head)
{
    struct table *table = &head->out->table;
    struct text rest = head->text;
    struct text text;
    struct text inside;
    struct text best = {0};
    struct text fallback = {0};
    size_t line_of_best = 0;
    size_t line_of_fallback = 0;
    for (size_t number = 1; text_line(&rest, &text) && (!table->first || number < table->first); number++) {
        bool is_comment = table_is_comment(&inside, text);
        if (table_is_blank(text) || !split_header(head, inside, table->cells)) {
            continue;
        }
        size_t numbers = table_numbers(&head->line);
        bool fits = !table->cells || head->line.given == table->cells || head->line.given + 1 == table->cells ||
                    head->line.count == table->cells;
        find_columns(head);
        bool has = has_triad(head) && numbers < (table->cells ? 3 : 1);
        bool is_sentence = is_comment && !fits && space_words_are_axes(inside);
        if (has && (fits || !best.size) && !is_sentence && (!is_comment || fits || head->line.given >= 3)) {
            best = inside;
            line_of_best = number;
        }
        bool is_whole = !head->beside[0].size && !head->beside[1].size && !space_words_are_beside(inside);
        if (fits && is_whole && !is_comment && !fallback.size && numbers == 0 && head->line.given > 1) {
            fallback = inside;
            line_of_fallback = number;
        }
        if (!table->cells && (has || (fallback.size && !is_comment))) {
            break; /* no rows: the first line decides */
        }
    }
    if (!best.size) {
        best = fallback;
        line_of_best = line_of_fallback;
    }
    if (best.size) {
        head->out->head_lines = line_of_best;
        head->out->header_sum = columns_sum(best);
        (void)split_header(head, best, table->cells);
        find_columns(head);
        complete_header(head);
        for (int i = 0; i < 2 && !head->options->any_space; i++) {
            space_words_hear_of(&head->out->said, head->beside[i]);
        }
    }
    return best.size;
}

/* Whether the line below the header has nothing but units. */
static bool has_row_of_units(const struct head *head)
{
    struct text rest = head->text;
    struct text text = {"", 0};
    struct table_line line;
    size_t count = 0;
    for (size_t number = 0; number < head->out->head_lines && text_line(&rest, &text); number++) {
    }
    bool all = table_next_line(&rest, &text, NULL) && table_split(&line, &head->out->table, text);
    for (size_t i = 0; all && i < line.count; i++) {
        double factor;
        const struct text cell = line.cells[i];
        const size_t mark = cell.size && strchr("([", cell.data[0]) != NULL;
        bool is_one = find_unit(&factor, (struct text){cell.data + mark, cell.size - 2 * mark});
        all = is_one || i == 0 || !cell.size;
        count += is_one;
    }
    return all && count;
}

/* Without rows a header alone tells what separates its cells: what makes the most of them. */
static void decide_by_header(struct head *head)
{
    struct text rest = head->text;
    struct text text;
    bool found = table_next_line(&rest, &text, NULL);
    struct table best = head->out->table;
    size_t most = 0;
    for (enum table_separator separator = 0; found && separator < TABLE_SEPARATORS; separator++) {
        struct table table = head->out->table;
        table.separator = separator;
        if (table_split(&head->line, &table, text) && head->line.given > most) {
            most = head->line.given;
            best = table;
        }
    }
    head->out->table = best;
}

/* Finds the columns whose texts are kept, by their names as they stand in the header. */
static void find_kept(struct head *head)
{
    const conus_pose_options *options = head->options;
    for (size_t i = 0; i < options->keep_count; i++) {
        size_t found = 0;
        for (size_t k = 0; k < head->line.given; k++) {
            if (text_equal_ignoring_case(text_trim(head->line.cells[k]), options->keep[i])) {
                head->out->kept[i] = k;
                found++;
            }
        }
        if (found != 1) {
            job_bad(head->job, "keep: %s column is called \"%.60s\"; columns found: %s", found ? "more than one" : "no",
                    options->keep[i], shown_columns(head, true));
        }
    }
    head->out->kept_count = options->keep_count;
}

/* What is meant by columns that other programs mean otherwise. */
static void note_angles(const struct head *head)
{
    const struct columns *out = head->out;
    if (out->has[ROLE_PHI]) {
        job_note(head->job,
                 "phi and theta are IBL's, degrees: azimuth (0 to the right, 90 to anterior) and polar angle of "
                 "the way from the tip to the top; theta 0 is straight down%s",
                 out->is_mlapdv ? "; x y z are ML, AP, DV from bregma" : "");
    } else if (out->is_straight) {
        job_note(head->job, "depth without an angle: straight down");
    }
}

static void check_options(const struct head *head)
{
    const struct columns *out = head->out;
    const conus_pose_options *options = head->options;
    bool turns = out->has[ROLE_QW] || out->has[ROLE_M00];
    if (options->axis != CONUS_AXIS_OF_FORMAT && !turns) {
        job_bad(head->job,
                "header: it gives %s, so that no axis (%s) is to be chosen; qw qx qy qz or m00...m33 have axes",
                out->is_of_points ? "points" : "a direction", pose_axis_name(options->axis));
    }
    if (options->inward && out->has[ROLE_RADIUS]) {
        job_bad(head->job, "header: column \"%s\" is that of a ball, but rows point into the head",
                out->shown[ROLE_RADIUS]);
    }
    if (options->space >= CONUS_SPACE_CCF && turns) { /* the columns' names are of axes that these do not have */
        job_bad(head->job,
                "header: rotations (qw qx qy qz or m00...m33) are not read in space %s; tx ty tz or dx dy dz are",
                conus_space_name((size_t)options->space));
    }
}

/* What stands between cells, to be written into an example. */
static const char *separator_of(const struct table *table)
{
    static const char *const texts[TABLE_SEPARATORS] = {"\t", ";", " | ", ",", "  ", " "};
    return texts[table->separator];
}

/* A header for a line: its numbers are called by @p labels in turn, its first other cell is a name. */
static void name_cells(char *out, size_t size, const struct table *table, const struct table_line *line,
                       const char *labels)
{
    struct text rest = text_from(labels);
    bool more = true;
    *out = '\0';
    for (size_t i = 0; i < line->given; i++) {
        double value;
        char word[32];
        struct text label = {word, 0};
        if (!table_number(&value, table, line->cells[i]) || !text_field(&rest, '/', &more, &label)) {
            label.size = (size_t)snprintf(word, sizeof word, strstr(out, "name") ? "word%zu" : "name", i + 1);
        }
        const size_t used = strlen(out);
        snprintf(out + used, size - used, "%s%.*s", i ? separator_of(table) : "", TEXT_SHOW(label, sizeof word));
    }
}

/* A table without a header whose first row is no point: what it could be, and the line that says so. */
static void refuse_bare(const struct head *head)
{
    const struct table *table = &head->out->table;
    struct text rest = head->text;
    struct text text = {"", 0};
    struct table_line line;
    for (size_t number = 0; number < table->first && text_line(&rest, &text); number++) {
    }
    const size_t numbers = table_split(&line, table, text) ? table_numbers(&line) : 0;
    char last[160], first[160]; /* for a row whose point is in these three numbers */
    name_cells(last, sizeof last, table, &line, numbers == 4 ? "row/x/y/z" : "x/y/z");
    name_cells(first, sizeof first, table, &line, "x/y/z/value");
    const struct text shown = text_trim(text);
    const char *commas = table->separator == TABLE_COMMAS && numbers <= 6
                             ? "if commas are decimal, put a semicolon or a tab between numbers; else "
                             : "";
    if (numbers == 3) {
        job_bad(head->job,
                "no header, and other words beside the x y z of a point than a name: \"%.*s\"; keep a name and the "
                "three numbers alone, or put a line of names in front: \"%s\"",
                TEXT_SHOW(shown, 60), last);
    } else if (numbers == 4) {
        job_bad(head->job,
                "no header, and 4 numbers in a line: \"%.*s\"; %sput a line in front that says whether the point is in "
                "the first three (\"%s\") or in the last three (\"%s\")",
                TEXT_SHOW(shown, 60), commas, first, last);
    } else {
        const char *s = separator_of(table);
        job_bad(head->job,
                "no header, and %zu numbers in a line, neither the 16 of a matrix nor the x y z of a point: \"%.*s\"; "
                "%sput a line of names in front, a word for each column, x%sy%sz among them",
                numbers, TEXT_SHOW(shown, 60), commas, s, s);
    }
}

/* Whether more than half of the rows of the head are points. */
static bool has_points(const struct head *head)
{
    struct text rest = head->text;
    struct text text;
    struct text name;
    double point[3];
    size_t rows = 0;
    size_t points = 0;
    for (; table_next_line(&rest, &text, NULL); rows++) {
        points += columns_point(point, &name, &head->out->table, text);
    }
    return points && 2 * points >= rows;
}

static void note_places(const struct head *head)
{
    const struct columns *out = head->out;
    const struct text column = out->has_header ? head->line.cells[out->place - 1] : text_from("");
    bool are_called_so = head->words.place.size && out->role_of[out->place - 1] == ROLE_NAME && out->count > 1;
    if (!head->options->atlas) {
        job_note(head->job, "names of the 10-10 system, taken as positions on the scalp of MNI 152");
        return;
    }
    job_note(head->job, "%s%.*s%s names places: each row is the point that --point NAME means%s",
             out->has_header ? "column \"" : "each line", POSE_QUOTE(column), out->has_header ? "\"" : "",
             are_called_so ? ", and is called so; FILE,name=COLUMN calls rows by another" : "");
}

/* Whether the options say this format. */
static bool is_asked(const conus_pose_options *options, const char *format)
{
    return strcmp(options->format ? options->format : "auto", format) == 0;
}

static void plan_bare(struct head *head)
{
    struct job *job = head->job;
    const conus_pose_options *options = head->options;
    struct columns *out = head->out;
    bool is_table = is_asked(options, "table");
    const struct text of_axes = columns_word_of_axes(&head->words);
    out->has_header = false;
    out->count = 0;
    out->is_of_points = true;
    if (head->is_on_its_side) {
        job_bad(job, "%s", on_its_side);
    } else if (of_axes.size) {
        job_bad(job, "no header, so that no column is called \"%.*s\"", POSE_QUOTE(of_axes));
    } else if (out->place) {
        note_places(head);
    } else if (is_table || (!has_points(head) && !out->table.cells)) {
        struct text line = {"", 0};
        struct text rest = head->text;
        while (table_is_blank(line) && text_line(&rest, &line)) {
        }
        job_bad(job,
                is_table ? "header: \"%.*s\": no names of columns, but the first line of a table has names"
                         : "\"%.*s\": neither names of columns nor three numbers in a line; needed are a header and "
                           "a line per pose, lines of x y z or of names (of areas, or C3; index:17 for a label), a 4 x "
                           "4 matrix, or another program's file",
                POSE_QUOTE(line));
    } else if (!has_points(head)) {
        refuse_bare(head);
    } else if (head->words.at[0].size || head->words.name.size) {
        struct text word = head->words.at[0].size ? head->words.at[0] : head->words.name;
        job_bad(job, "no header, so that no column is called \"%.*s\"", POSE_QUOTE(word));
    } else if (options->axis != CONUS_AXIS_OF_FORMAT) {
        job_bad(job, "points have no direction, so that no axis (%s) can be chosen", pose_axis_name(options->axis));
    }
}

static void count_cell(struct head *head, size_t column, struct text cell)
{
    static const char middles[] = "midline/mid/both/bilateral/m/b";
    struct column_cells *cells = &head->cells[column];
    struct space_words said;
    double value;
    bool is_number = table_number(&value, &head->out->table, cell);
    bool is_place = text_is_one_of(cell, "ccf/bregma", false);
    cells->filled += cell.size > 0;
    cells->given += !columns_is_absent(cell);
    cells->numbers += is_number;
    cells->zeros += is_number && value == 0;
    cells->longs += is_number && head->options->longest > 0 && value > head->options->longest &&
                    value <= 1000 * head->options->longest;
    if (!is_number) {
        bool is_space = space_words_hear_cell(&said, cell, false); /* also where it is so strongly */
        cells->voxels += said.why == space_why_voxels;
        cells->strong += (is_space && space_words_hear_cell(&said, cell, true)) || is_place;
        cells->spaces += is_space || is_place;
        cells->units += space_unit_mm(cell) != 0;
        cells->sides += sides_of_name(cell) != 0;
        cells->middles += text_is_one_of(cell, middles, false);
        cells->ends[columns_end_of(cell)]++;
    }
}

/* Takes the rows of the head to pieces, once. */
static void find_rows(struct head *head)
{
    struct text rest = head->text;
    struct text text;
    struct table_line line;
    while (job_ok(head->job) && head->text.size - rest.size < TABLE_HEAD && table_next_line(&rest, &text, NULL)) {
        if (!table_split(&line, &head->out->table, text) || table_numbers(&line) < 3) {
            continue;
        }
        struct text *cells = job_raw(head->job, line.count, sizeof *cells);
        struct head_row *row =
            list_add(head->job, &head->rows, &head->row_count, &head->row_capacity, sizeof *head->rows);
        *row = (struct head_row){cells, cells ? line.count : 0};
        for (size_t i = 0; cells && i < line.count; i++) {
            cells[i] = line.cells[i];
            count_cell(head, i, cells[i]);
        }
    }
    head->is_on_its_side = is_on_its_side(head);
}

static void finish_faults(void *head)
{
    buffer_finish(&((struct head *)head)->faults);
}

/* Whether the header of the names, or of a column without a role, says LPS. */
static bool says_lps(const struct head *head)
{
    const struct columns *out = head->out;
    bool found = out->has[ROLE_NAME] && text_mentions(text_from(out->shown[ROLE_NAME]), "LPS");
    for (size_t i = 0; i < head->line.given && !out->is_bids; i++) {
        struct text rest = text_from(head->names[i]);
        struct text word;
        while (out->role_of[i] == ROLES && text_word(&rest, &word)) {
            found = found || text_equal(word, "lps");
        }
    }
    return found;
}

static void plan(struct head *head, bool *is_short)
{
    struct columns *out = head->out;
    const conus_pose_options *options = head->options;
    (void)JOB_CALL(head->job, columns_words_parse(&head->words, options->columns));
    head->is_named = head->words.at[0].size;
    if (out->is_bids) {
        static const char *const xyz[3] = {"x", "y", "z"};
        for (int k = 0; k < 3; k++) {
            head->words.at[k] = head->words.at[k].size ? head->words.at[k] : text_from(xyz[k]);
        }
        head->words.name = head->words.name.size ? head->words.name : text_from("name");
    }
    table_decide(&out->table, head->text);
    *is_short = out->table.cells == 0;
    if (!out->table.cells) {
        decide_by_header(head);
    }
    find_rows(head);
    out->has_header = !is_asked(options, "points") && find_header(head);
    bool has_none = (!head->family_count || head->lacks_space) && !out->has[ROLE_M00] && !head->is_named;
    if (!out->is_bids && (head->words.place.size ? options->atlas != NULL : has_none) &&
        (is_asked(options, "auto") || is_asked(options, "table") || is_asked(options, "points"))) {
        columns_find_places(head, roles[sizeof roles / sizeof roles[0] - 1].names);
    }
    if (out->place && out->has_header) {
        find_columns(head);
    }
    FAULT_IF(out->has_header && out->table.comma == TABLE_COMMA_UNCLEAR, head,
             "a comma before three digits, or commas of two kinds: 1,250 may be 1250 or 1.25; write one of these");
    FAULT_IF(out->has_header && has_row_of_units(head), head,
             "a row of units below it: write them behind the names, as in x (mm)");
    (void)JOB_CALL(head->job, buffer_status(&head->faults));
    if (!out->has_header) {
        plan_bare(head);
    } else if (head->line.spoilt.data) {
        job_bad(head->job, "header: a quotation mark inside a name, or one that is not closed: \"%.*s",
                POSE_QUOTE(head->line.spoilt));
    } else if (head->faults.size) {
        settle_probes(head);
        job_bad(head->job, "header: %s; columns found: %s", head->faults.data, shown_columns(head, true));
    } else {
        check_options(head);
        if (out->place) {
            note_places(head);
        }
        note_angles(head);
        const size_t query = find_name(head, "query", 0);
        if (query != COLUMN_NONE && out->role_of[query] == ROLE_NAME && !head->words.name.size &&
            has_names(head, "peak x")) { /* of conus overlap: a region, the same in many rows */
            drop_role(head, ROLE_NAME);
        }
        find_row_names(head);
        out->said.may_be_lps |= says_lps(head);
        find_kept(head);
        const char *unread = out->is_bids ? "" : shown_columns(head, false);
        if (unread[0]) {
            job_note(head->job, "columns passed over: %s", unread);
        }
    }
}

/* The unit of positions and of lengths beside them. */
static void plan_units(struct head *head)
{
    struct columns *out = head->out;
    const double mm = columns_space_mm(head->options->space);
    const double unit = head->words.unit > 0 ? head->words.unit : head->options->unit; /* the user's word */
    const double beside = out->beside_mm / mm;
    out->is_own_unit = unit > 0;
    if (!out->is_own_unit && beside > 0 && out->scale > 0 && out->scale != beside) {
        job_bad(head->job, "its header names another unit than the *_coordsystem.json beside it");
    }
    out->scale = beside > 0 ? beside : out->scale;
    if (!out->place) { /* names have neither space nor unit */
        columns_hear_words(head);
        out->grows = out->said.has_signs ? (out->said.signs == CONUS_SPACE_LPS ? -1 : 1) : head->has_axes * head->side;
    } else if (!head->options->atlas) {
        out->said.space = pose_space_named(text_from("MNI 152 (10-10)"), POSE_BRAIN_MNI152);
    }
    bool is_of_brainsight =
        has_names(head, "loc x/loc y/loc z") && (has_names(head, "target name") || has_names(head, "sample name"));
    if (is_of_brainsight && out->has_header && !out->said.space.name[0] && !head->options->any_space) {
        job_warn(head->job, "columns as Brainsight's, without its line \"# Coordinate system\" that says whose brain "
                            "they are of: they are taken as being in the atlas's space");
    }
    out->scale = unit > 0 ? unit / mm : out->scale;
    out->has_unit = out->scale > 0;
    out->scale = out->has_unit ? out->scale : 1;
    for (enum column_role role = ROLE_DEPTH; role <= ROLE_RADIUS; role++) {
        out->factor[role] = out->factor[role] > 0 ? out->factor[role] : out->place ? 1 : out->scale * mm;
    }
}

void columns_plan(struct job *job, struct columns *out, bool *is_short, struct text text,
                  const conus_pose_options *options)
{
    const struct job_mark mark = job_mark(job);
    struct head *head = job_new(job, struct head);
    *out = (struct columns){.space = options->space,
                            .is_bids = out->is_bids,
                            .side = out->side,
                            .file = out->file ? out->file : "FILE",
                            .beside_mm = out->beside_mm,
                            .table.quotes_are_plain = out->is_bids};
    if (!head) {
        return;
    }
    head->job = job;
    head->out = out;
    head->options = options;
    head->text = text;
    job_own(job, finish_faults, head);
    plan(head, is_short);
    if (job_ok(job)) {
        plan_units(head);
    }
    if (job_ok(job) && !out->place) {
        columns_check_numbers(head);
    }
    job_release(job, mark);
}
