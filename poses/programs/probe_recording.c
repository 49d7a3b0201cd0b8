/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds where the contacts of a Neuropixels probe are that SpikeGLX or Open Ephys recorded from. */
#include "poses/programs/pose_programs.h"

#include "base/formats/xml.h"
#include "base/memory.h"
#include "poses/rows/pose_row.h"

#include <math.h>
#include <string.h>

/* What an entry of an .imro says, in this order; the others follow or are not needed. */
enum form {
    BY_MAP,      /* only ~snsGeomMap says where its contacts are */
    BY_BANK,     /* channel, bank: electrode = 384 bank + channel */
    BY_ELECTRODE /* channel, [shank,] ..., electrode at the end */
};

/* Probes of two columns, micrometres: rows of a shank, from column to column, from row to row, from the shank's left
 * edge to the first column of even rows and of odd ones, the shank's width, and from the tip to the middle of the
 * lowest row. Facts of Bill Karsh's ProbeTable 1.8 (SpikeGLX), as probeinterface 0.4.2 has them; that the last of them
 * ends at the middle of row 0 is how SpikeGLX reads it (SVAnatomy.cpp). */
static const struct kind {
    const char *parts;
    enum form form;
    size_t rows;
    double across, along, even, odd, width, tip;
    size_t shanks;
    double pitch;
} kinds[] = {
    {"NP1000/NP1001/NP1010/NP1011/NP1012/NP1013/NP1014/PRB_1_2_0480_2/PRB_1_4_0480_1/PRB_1_4_0480_1_C", BY_BANK, 480,
     32, 20, 27, 11, 70, 209, 1, 0},
    {"NP1015/NP1016/NP1017", BY_BANK, 480, 32, 20, 27, 27, 70, 209, 1, 0},
    {"NP1020/NP1021", BY_BANK, 1248, 87, 20, 27, 11, 125, 373, 1, 0},
    {"NP1022", BY_BANK, 1248, 103, 20, 11, 11, 125, 373, 1, 0},
    {"NP1030/NP1031", BY_BANK, 2208, 87, 20, 27, 11, 125, 373, 1, 0},
    {"NP1032/NP1033/NP1040/NP1041/NP1042/NP1050/NP1051", BY_BANK, 2208, 103, 20, 11, 11, 125, 373, 1, 0},
    {"NP1300/NP1400", BY_BANK, 480, 48, 20, 11, 11, 70, 209, 1, 0},
    {"NP2000/NP2003/NP2004/NP2005/PRB2_1_2_0640_0", BY_ELECTRODE, 640, 32, 15, 27, 27, 70, 206, 1, 0},
    {"NP2006", BY_ELECTRODE, 640, 32, 15, 27, 11, 70, 206, 1, 0},
    {"NP2300", BY_ELECTRODE, 640, 48, 15, 11, 11, 70, 206, 1, 0},
    {"NP3010/NP3011/NP3012", BY_ELECTRODE, 640, 32, 15, 27, 27, 70, 203, 1, 0},
    {"NP2010/NP2013/NP2014/NP2020/NP2021/PRB2_4_2_0640_0", BY_ELECTRODE, 640, 32, 15, 27, 27, 70, 206, 4, 250},
    {"NP2022", BY_ELECTRODE, 640, 20, 15, 27, 11, 70, 206, 4, 2141.45},
    {"NP3020/NP3021/NP3022/NP3023/NP3024", BY_ELECTRODE, 640, 32, 15, 27, 27, 70, 204, 4, 250},
    /* of other layouts */
    {"NP1100", .form = BY_MAP, .tip = 206.5},
    {"NP1110", .form = BY_MAP, .tip = 203.5},
    {"NP1120/NP1123", .form = BY_MAP, .tip = 205.75},
    {"NP1121/NP1122", .form = BY_MAP, .tip = 205.25},
    {"NP1200/NP1210", .form = BY_MAP, .tip = 372},
    {"NP3000", .form = BY_MAP, .tip = 206},
};

enum { NUMBERS = 8, CONTACTS_MOST = 20000, CHANNELS_OF_BANK = 384 };

struct contact {
    size_t channel; /* of the probe */
    size_t trace;   /* of the file; of an .imro the channel */
    size_t shank;
    double x, y; /* micrometres from the left edge of the first shank, and from the lowest row */
    bool has_x, has_y;
};

struct reading {
    struct buffer *out;
    double tip_mm;           /* as the caller says; 0 = by the part number */
    const char *prefix;      /* of contacts' names */
    const struct kind *kind; /* NULL: the part number is not known */
    char part[POSE_QUOTE_LIMIT + 1];
    size_t shanks;
    double width, pitch;
    struct contact *contacts;
    size_t count, capacity;
    size_t probes;
    /* settings.xml */
    bool is_in_probe;
    unsigned version; /* of Open Ephys, 600 of 0.6.4; 0 = it names none */
};

static void set_part(struct reading *reading, struct text part)
{
    snprintf(reading->part, sizeof reading->part, "%.*s", POSE_QUOTE(part));
    reading->kind = NULL;
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        reading->kind = text_is_one_of(part, kinds[i].parts, true) ? &kinds[i] : reading->kind;
    }
    reading->shanks = reading->kind ? reading->kind->shanks : 0;
    reading->width = reading->kind ? reading->kind->width : 0;
    reading->pitch = reading->kind ? reading->kind->pitch : 0;
}

static conus_status add_contact(struct reading *reading, const struct contact *contact)
{
    if (reading->count == CONTACTS_MOST) {
        return fail(CONUS_ERROR_DATA, "more than %d contacts", CONTACTS_MOST);
    }
    if (!memory_reserve(&reading->contacts, &reading->capacity, reading->count + 1, sizeof *reading->contacts)) {
        return CONUS_ERROR_MEMORY;
    }
    reading->contacts[reading->count++] = *contact;
    return CONUS_OK;
}

/* Takes the inside of the next "(...)". */
static bool take_group(struct text *inside, struct text *rest)
{
    const char *open = rest->size ? memchr(rest->data, '(', rest->size) : NULL;
    const char *end = rest->data + rest->size;
    const char *close = open ? memchr(open, ')', (size_t)(end - open)) : NULL;
    if (!close) {
        return false;
    }
    *inside = (struct text){open + 1, (size_t)(close - open - 1)};
    *rest = (struct text){close + 1, (size_t)(end - close - 1)};
    return true;
}

/* The numbers between `mark`s; 0 where one is none, or there are more than NUMBERS. */
static size_t read_numbers(double out[NUMBERS], struct text inside, char mark)
{
    struct text field;
    size_t count = 0;
    for (bool more = true; text_field(&inside, mark, &more, &field); count++) {
        if (count == NUMBERS || !text_to_double(text_trim(field), &out[count]) || !isfinite(out[count])) {
            return 0;
        }
    }
    return count;
}

/* The value behind "KEY=" at the beginning of a line; false where there is none. */
static bool find_value(struct text *out, struct text text, const char *key)
{
    struct text line;
    size_t size = strlen(key);
    while (text_line(&text, &line)) {
        if (text_starts(line, key) && line.size > size && line.data[size] == '=') {
            *out = text_trim((struct text){line.data + size + 1, line.size - size - 1});
            return true;
        }
    }
    return false;
}

static bool is_index(double number, double below)
{
    return number >= 0 && number < below && number == floor(number);
}

/* Where the table has an electrode of a shank. */
static conus_status put_electrode(struct contact *contact, const struct reading *reading, double shank,
                                  double electrode)
{
    const struct kind *kind = reading->kind;
    if (!is_index(electrode, (double)(2 * kind->rows)) || !is_index(shank, (double)kind->shanks)) {
        return fail(CONUS_ERROR_DATA, "channel %zu: electrode %g of shank %g, which a probe %s does not have",
                    contact->channel, electrode, shank, reading->part);
    }
    size_t row = (size_t)electrode / 2;
    contact->shank = (size_t)shank;
    contact->x = shank * kind->pitch + (row % 2 ? kind->odd : kind->even) + ((size_t)electrode % 2 ? kind->across : 0);
    contact->y = (double)row * kind->along;
    return CONUS_OK;
}

/* "(type,channels)(channel bank ...)...": the contacts of all channels. */
static conus_status read_imro(struct reading *reading, struct text value)
{
    static const struct {
        const char *type, *part;
    } types[] = {{"0", "NP1000"}, {"21", "NP2000"}, {"24", "NP2010"}};
    struct text inside = {"", 0};
    struct text part;
    double n[NUMBERS];
    bool more = true;
    if (!take_group(&inside, &value) || !text_field(&inside, ',', &more, &part)) {
        return fail(CONUS_ERROR_DATA, "no table of sites, (TYPE,CHANNELS)(CHANNEL ...)...");
    }
    size_t stated = read_numbers(n, inside, ',');
    if (!reading->part[0]) { /* the part number of a .meta is more than the type of its table */
        char name[POSE_QUOTE_LIMIT + 1];
        snprintf(name, sizeof name, "%s%.*s", text_starts(part, "NP") || text_starts(part, "PRB") ? "" : "NP",
                 POSE_QUOTE(part));
        set_part(reading, text_from(name));
        for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
            if (text_equal(part, types[i].type)) {
                set_part(reading, text_from(types[i].part));
            }
        }
    }
    if (!reading->kind || reading->kind->form == BY_MAP || stated != 1) {
        return fail(CONUS_ERROR_DATA,
                    "a table of sites of a probe \"%s\": its positions are not known; a .ap.meta of "
                    "SpikeGLX 2023 and later, with ~snsGeomMap, has them",
                    reading->part);
    }
    bool by_bank = reading->kind->form == BY_BANK;
    conus_status status = CONUS_OK;
    while (!status && take_group(&inside, &value)) {
        double e[NUMBERS];
        size_t count = read_numbers(e, inside, ' ');
        if (count < (reading->kind->shanks > 1 ? 5
                     : by_bank                 ? 2
                                               : 4) ||
            !is_index(e[0], n[0]) || !is_index(e[1], CHANNELS_OF_BANK)) {
            return fail(CONUS_ERROR_DATA,
                        "table of sites: \"(%.*s)\", an entry of a probe %s is needed, its channel "
                        "below %g",
                        POSE_QUOTE(inside), reading->part, n[0]);
        }
        struct contact contact = {.channel = (size_t)e[0], .trace = (size_t)e[0]};
        status = by_bank ? put_electrode(&contact, reading, 0, e[0] + CHANNELS_OF_BANK * e[1])
                         : put_electrode(&contact, reading, reading->kind->shanks > 1 ? e[1] : 0, e[count - 1]);
        status = status ? status : add_contact(reading, &contact);
    }
    return status || (double)reading->count == n[0]
               ? status
               : fail(CONUS_ERROR_DATA, "table of sites: %zu entries, it says %g", reading->count, n[0]);
}

/* "(part,shanks,pitch,width)(shank:x:z:used)...", a contact for each saved channel. */
static conus_status read_geom_map(struct reading *reading, struct text value)
{
    struct text inside = {"", 0};
    struct text part;
    double n[NUMBERS];
    bool more = true;
    if (!take_group(&inside, &value) || !text_field(&inside, ',', &more, &part) || read_numbers(n, inside, ',') != 3 ||
        !(n[0] >= 1) || !(n[2] > 0)) {
        return fail(CONUS_ERROR_DATA, "~snsGeomMap: (PART,SHANKS,PITCH,WIDTH) is needed first");
    }
    if (!reading->part[0]) {
        set_part(reading, part);
    }
    reading->shanks = (size_t)n[0];
    reading->pitch = n[1];
    reading->width = n[2];
    conus_status status = CONUS_OK;
    while (!status && take_group(&inside, &value)) {
        double e[NUMBERS];
        if (read_numbers(e, inside, ':') != 4 || !is_index(e[0], n[0])) {
            return fail(CONUS_ERROR_DATA, "~snsGeomMap: \"(%.*s)\", SHANK:X:Z:USED is needed, of %g shanks",
                        POSE_QUOTE(inside), n[0]);
        }
        const struct contact contact = {
            .trace = reading->count, .shank = (size_t)e[0], .x = e[0] * reading->pitch + e[1], .y = e[2]};
        status = add_contact(reading, &contact);
    }
    return status;
}

/* Lets the contacts be those of the channels that are saved, "0:383,768", in this order. @p by_file: they are already,
 * and get only the channels' numbers. */
static conus_status take_saved(struct reading *reading, struct text ranges, double acquired, bool by_file)
{
    struct contact *all = reading->contacts;
    const size_t count = reading->count;
    size_t trace = 0;
    struct text range;
    bool is_all = text_equal(ranges, "all");
    conus_status status = CONUS_OK;
    reading->contacts = NULL;
    reading->count = reading->capacity = 0;
    for (bool more = true; !status && text_field(&ranges, ',', &more, &range);) {
        double ends[NUMBERS] = {0, acquired - 1};
        size_t found = is_all ? 2 : read_numbers(ends, range, ':');
        ends[1] = found == 1 ? ends[0] : ends[1];
        if (found < 1 || found > 2 || !is_index(ends[0], 1e6) || !is_index(ends[1], 1e6) || ends[1] < ends[0]) {
            status = fail(CONUS_ERROR_DATA, "snsSaveChanSubset: \"%.*s\" is no range of channels", POSE_QUOTE(range));
        }
        for (double channel = ends[0]; !status && channel <= ends[1] && channel < acquired; channel++, trace++) {
            size_t i = by_file ? trace : 0;
            while (!by_file && i < count && (double)all[i].channel != channel) {
                i++;
            }
            if (i >= count) {
                status = fail(CONUS_ERROR_DATA, "saved channel %g has no entry in the table of sites", channel);
            } else {
                struct contact contact = all[i];
                contact.channel = (size_t)channel;
                contact.trace = trace;
                status = add_contact(reading, &contact);
            }
        }
    }
    if (!status && by_file && trace != count) {
        status = fail(CONUS_ERROR_DATA, "~snsGeomMap: %zu contacts, %zu channels are saved", count, trace);
    }
    memory_free(all);
    return status;
}

static conus_status read_meta(struct reading *reading, struct text text)
{
    struct text value = {"", 0};
    struct text saved = text_from("all");
    double acquired[NUMBERS];
    double of_file[NUMBERS];
    if (find_value(&value, text, "imDatPrb_pn") && value.size) {
        set_part(reading, value);
    }
    if (find_value(&value, text, "imProbeOpt")) {
        return fail(CONUS_ERROR_DATA, "a probe of phase 3A, whose geometry is not known");
    }
    if (!find_value(&value, text, "acqApLfSy") || read_numbers(acquired, value, ',') < 1 ||
        !find_value(&value, text, "snsApLfSy") || read_numbers(of_file, value, ',') < 1) {
        return fail(CONUS_ERROR_DATA, "acqApLfSy and snsApLfSy are needed: a .ap.meta of SpikeGLX says with them which "
                                      "channels are of a probe");
    }
    if (!(of_file[0] > 0)) {
        return fail(CONUS_ERROR_DATA, "no AP channels (snsApLfSy): the .ap.meta of the recording has them");
    }
    (void)find_value(&saved, text, "snsSaveChanSubset");
    bool by_file = find_value(&value, text, "~snsGeomMap");
    if (!by_file && !find_value(&value, text, "~imroTbl")) {
        return fail(CONUS_ERROR_DATA, "neither ~snsGeomMap nor ~imroTbl: not known where contacts are");
    }
    conus_status status = by_file ? read_geom_map(reading, value) : read_imro(reading, value);
    status = status ? status : take_saved(reading, saved, acquired[0], by_file);
    return status || (double)reading->count == of_file[0]
               ? status
               : fail(CONUS_ERROR_DATA, "snsApLfSy: %g AP channels, snsSaveChanSubset has %zu", of_file[0],
                      reading->count);
}

/* A list with an entry for each contact. */
#define EACH(reading, key, ...)                                                                                        \
    do {                                                                                                               \
        buffer_text((reading)->out, ", \"" key "\": [");                                                               \
        for (size_t i = 0; i < (reading)->count; i++) {                                                                \
            const struct contact *c = &(reading)->contacts[i];                                                         \
            buffer_text((reading)->out, i ? ", " : "");                                                                \
            buffer_format((reading)->out, __VA_ARGS__);                                                                \
        }                                                                                                              \
        buffer_text((reading)->out, "]");                                                                              \
    } while (0)

static conus_status write_probe(struct reading *reading)
{
    struct buffer *out = reading->out;
    double tip = reading->tip_mm > 0 ? 1000 * reading->tip_mm : reading->kind ? reading->kind->tip : 0;
    if (!(tip > 0)) {
        return fail(CONUS_ERROR_DATA,
                    "a probe \"%s\", whose tip is not known; --probe-tip says how many mm it is from the lowest row of "
                    "contacts that the probe has, recorded or not",
                    reading->part);
    }
    buffer_text(out, reading->probes++ ? ", " : "{\"specification\": \"probeinterface\", \"probes\": [");
    buffer_text(out, "{\"ndim\": 2, \"si_units\": \"um\"");
    EACH(reading, "contact_positions", "[%.17g, %.17g]", c->x, c->y);
    EACH(reading, "contact_ids", "\"%s%zu\"", reading->prefix, c->channel);
    EACH(reading, "shank_ids", "\"%zu\"", c->shank);
    EACH(reading, "device_channel_indices", "%zu", c->trace);
    buffer_format(out, ", \"probe_planar_contour\": [[0, 0], [%.17g, %.17g], [%.17g, 0]]}", reading->width / 2, -tip,
                  reading->width);
    reading->count = 0;
    reading->part[0] = '\0';
    return buffer_status(out);
}

/* Whether all contacts lie on the probe's rows and columns once x is less by this. */
static bool fits_columns(const struct reading *reading, double shift)
{
    const struct kind *kind = reading->kind;
    bool all = true;
    for (size_t i = 0; all && i < reading->count; i++) {
        const struct contact *c = &reading->contacts[i];
        double row = c->y / kind->along;
        double x = c->x - shift - (double)c->shank * kind->pitch - (fmod(row, 2) != 0 ? kind->odd : kind->even);
        all = is_index(row, (double)kind->rows) && (fabs(x) < 1e-6 || fabs(x - kind->across) < 1e-6);
    }
    return all;
}

/* Open Ephys counts x from the shank's edge, or older versions from elsewhere: which is found by the probe's columns.
 */
static conus_status settle_x(struct reading *reading)
{
    const struct kind *kind = reading->kind;
    const struct contact *c = reading->contacts;
    double first = c->x - (double)c->shank * kind->pitch - (fmod(c->y / kind->along, 2) != 0 ? kind->odd : kind->even);
    bool fits = fits_columns(reading, 0);
    bool is_left = !fits && fits_columns(reading, first);
    bool is_right = !fits && fits_columns(reading, first - kind->across);
    for (size_t i = 0; is_left != is_right && i < reading->count; i++) {
        reading->contacts[i].x -= is_left ? first : first - kind->across;
    }
    return fits || is_left != is_right
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA,
                      "ELECTRODE_XPOS and ELECTRODE_YPOS do not say on which rows and columns of a probe %s contacts "
                      "are",
                      reading->part);
}

/* CHANNELS, whose values are banks or BANK:SHANK, makes contacts; the others say where they are. */
static conus_status read_attributes(struct reading *reading, const struct xml_event *event)
{
    bool is_list = strcmp(event->name, "CHANNELS") == 0;
    bool is_x = strcmp(event->name, "ELECTRODE_XPOS") == 0;
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && event->attributes[i]; i += 2) {
        struct text name = text_from(event->attributes[i]);
        uint64_t channel;
        double n[NUMBERS];
        size_t count = read_numbers(n, text_from(event->attributes[i + 1]), ':');
        double shank = is_list && count == 2 ? n[1] : 0;
        bool is_one = text_starts(name, "CH") &&
                      text_to_uint((struct text){name.data + 2, name.size - 2}, CONTACTS_MOST, &channel);
        if (!is_one || count < 1 || count > (is_list ? 2 : 1) || !is_index(shank, NUMBERS)) {
            return fail(CONUS_ERROR_DATA, "line %zu: <%s %.20s=\"%.20s\">: CH and a number are needed, and its %s",
                        event->line, event->name, name.data, event->attributes[i + 1], is_list ? "bank" : "position");
        }
        if (is_list) {
            const struct contact contact = {
                .channel = (size_t)channel, .trace = (size_t)channel, .shank = (size_t)shank};
            status = add_contact(reading, &contact);
        }
        for (size_t k = 0; !is_list && k < reading->count; k++) {
            struct contact *contact = &reading->contacts[k];
            bool is_it = contact->channel == channel;
            *(is_x ? &contact->x : &contact->y) = is_it ? n[0] : is_x ? contact->x : contact->y;
            *(is_x ? &contact->has_x : &contact->has_y) |= is_it;
        }
    }
    return status;
}

static conus_status on_start(void *user, const struct xml_event *event)
{
    struct reading *reading = user;
    const char *part = xml_attribute(event, "probe_part_number");
    const char *enabled = xml_attribute(event, "isEnabled");
    if (strcmp(event->name, "NP_PROBE") == 0) {
        set_part(reading, text_from(part ? part : ""));
        reading->is_in_probe = !enabled || strcmp(enabled, "0") != 0; /* else it recorded nothing */
    }
    bool is_read = text_is_one_of(text_from(event->name), "CHANNELS/ELECTRODE_XPOS/ELECTRODE_YPOS", true);
    return reading->is_in_probe && is_read ? read_attributes(reading, event) : CONUS_OK;
}

static conus_status end_probe(struct reading *reading)
{
    bool has_all = reading->count > 0;
    for (size_t i = 0; i < reading->count; i++) {
        const struct contact *c = &reading->contacts[i];
        has_all = has_all && c->has_x && c->has_y && c->shank < (reading->kind ? reading->kind->shanks : 1);
    }
    if (!reading->kind || reading->kind->form == BY_MAP) {
        return fail(CONUS_ERROR_DATA, "a probe \"%s\", whose geometry is not known", reading->part);
    }
    if (!has_all) {
        return fail(CONUS_ERROR_DATA,
                    "a probe %s without an ELECTRODE_XPOS and an ELECTRODE_YPOS for each of its "
                    "CHANNELS, on a shank that it has",
                    reading->part);
    }
    if (reading->kind->shanks > 1 && reading->version < 600) {
        return fail(CONUS_ERROR_DATA, "a probe %s by Open Ephys before 0.6, which wrote other positions of its shanks",
                    reading->part);
    }
    conus_status status = settle_x(reading);
    return status ? status : write_probe(reading);
}

static conus_status on_end(void *user, const struct xml_event *event)
{
    struct reading *reading = user;
    double n[NUMBERS];
    struct text rest = event->text; /* "1.0.0-alpha.1" */
    struct text version;
    bool more = true;
    if (strcmp(event->name, "VERSION") == 0 && !reading->version && text_field(&rest, '-', &more, &version) &&
        read_numbers(n, version, '.') == 3 && is_index(n[0], 100) && is_index(n[1], 100)) {
        reading->version = (unsigned)(10000 * n[0] + 100 * n[1]);
    }
    bool is_read = reading->is_in_probe && strcmp(event->name, "NP_PROBE") == 0;
    reading->is_in_probe = reading->is_in_probe && !is_read;
    return is_read ? end_probe(reading) : CONUS_OK;
}

static conus_status read_settings(struct reading *reading, struct text text)
{
    const struct xml_handler handler = {.start = on_start, .end = on_end, .user = reading};
    conus_status status = xml_parse(&handler, text);
    return status || reading->probes
               ? status
               : fail(CONUS_ERROR_DATA, "XML without a probe <NP_PROBE>: of Open Ephys's settings.xml those of its "
                                        "plugin Neuropix-PXI have positions");
}

bool probe_recording_is(struct text text)
{
    struct text value;
    text = text_trim(text);
    return text_starts(text, "<") || text_starts(text, "(") || find_value(&value, text, "~imroTbl") ||
           find_value(&value, text, "~snsGeomMap") || find_value(&value, text, "snsApLfSy");
}

conus_status probe_recording_write(struct buffer *out, struct text text, double tip)
{
    text = text_trim(text);
    bool is_xml = text_starts(text, "<");
    struct reading reading = {.out = out, .tip_mm = tip, .prefix = is_xml ? "CH" : "AP"};
    conus_status status = is_xml                   ? read_settings(&reading, text)
                          : text_starts(text, "(") ? read_imro(&reading, text)
                                                   : read_meta(&reading, text);
    status = status || is_xml ? status : write_probe(&reading);
    buffer_text(out, "]}");
    memory_free(reading.contacts);
    return status ? status : buffer_status(out);
}
