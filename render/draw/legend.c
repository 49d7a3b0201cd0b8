/* SPDX-License-Identifier: BSD-3-Clause */
/* Lays a legend out in columns and draws it. */
#include "render/draw/legend.h"

#include "base/look.h"
#include "base/look_sizes.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Lengths in em. */
static const double MARGIN = 0.9;
static const double PADDING = 0.8;
static const double LINE = 1.45;
static const double TITLE = 1.15; /* size of its letters */
static const double CHIP = 0.78;
static const double CHIP_GAP = 0.5;
static const double COLUMN_GAP = 1.0;
static const double SHORTEST_NAME = 5;
static const double BELOW_BASELINE = 0.45; /* the part of a line below its baseline */

static const double WIDEST = 0.42;

static const float PANEL[4] = {LOOK_LEGEND_PANEL, 0.96F};
static const float RIM[4] = {LOOK_LEGEND_RIM, 0.25F};
static const float BRIGHT[4] = {LOOK_LEGEND_TEXT, 1};
static const float DIM[4] = {LOOK_LEGEND_SOFT, 1};

/* A legend with its measures. */
struct layout {
    const struct legend *legend;
    struct font *font;
    struct draw_list *list;
    double em;
    size_t shown; /* rows that are shown, without the line that counts the others */
    size_t head;  /* those of them that are above that line */
    int columns;  /* details shown */
    double name_width, column_width[LEGEND_DETAILS];
    bool has_header;
    struct draw_box panel;
    float bright[4], dim[4];
};

double legend_size(const struct draw_list *list)
{
    return fmax(LOOK_FIGURE_LEAST, fmin(list->width, list->height) / (double)LOOK_FIGURE_PART);
}

static double width_of(const struct layout *layout, double size, const char *text)
{
    return text ? font_width(layout->font, size, text) : 0;
}

/* Row number `i` of those shown. */
static const struct legend_row *shown_row(const struct layout *layout, size_t i)
{
    size_t left_out = i < layout->head ? 0 : layout->legend->count - layout->shown;
    return &layout->legend->rows[i + left_out];
}

static double column_width(const struct layout *layout, int column)
{
    double width = width_of(layout, layout->em, layout->legend->header[column]);
    for (size_t i = 0; i < layout->shown; i++) {
        width = fmax(width, width_of(layout, layout->em, shown_row(layout, i)->detail[column]));
    }
    return width > 0 ? width + COLUMN_GAP * layout->em : 0;
}

/* Lines that are no rows, and the height they take. */
static double head_height(const struct layout *layout)
{
    double height = layout->legend->title ? TITLE * LINE : 0;
    height += layout->legend->subtitle ? LINE : 0;
    height += layout->has_header ? LINE : 0;
    return height * layout->em;
}

static void find_header(struct layout *layout)
{
    for (int c = 0; c < LEGEND_DETAILS; c++) {
        layout->has_header = layout->has_header || layout->legend->header[c];
    }
}

/* Measures columns and names of the rows that are shown. Returns the width of all columns but the names. */
static double measure_columns(struct layout *layout)
{
    double details = 0;
    for (int c = 0; c < LEGEND_DETAILS; c++) {
        layout->column_width[c] = column_width(layout, c);
        details += layout->column_width[c];
    }
    for (size_t i = 0; i < layout->shown; i++) {
        double width = width_of(layout, layout->em, shown_row(layout, i)->name);
        layout->name_width = fmax(layout->name_width, width);
    }
    return details;
}

/* The width of the columns, or of the lines above them. */
static double content_width(const struct layout *layout, double details)
{
    const struct legend *legend = layout->legend;
    double width = (CHIP + CHIP_GAP) * layout->em + layout->name_width + details;
    width = fmax(width, width_of(layout, TITLE * layout->em, legend->title));
    return fmax(width, width_of(layout, layout->em, legend->subtitle));
}

double legend_fit(double size[2], struct font *font, const struct legend *legend, const double limit[2], double largest,
                  double smallest)
{
    static const double step = 0.96;
    double em = largest / step;
    do {
        em = fmax(em * step, smallest);
        struct layout layout = {
            .legend = legend, .font = font, .em = em, .shown = legend->count, .head = legend->count};
        find_header(&layout);
        double details = measure_columns(&layout);
        size[0] = content_width(&layout, details) + 2 * (MARGIN + PADDING) * em + 1; /* the panel is of whole pixels */
        size[1] = head_height(&layout) + (LINE * (double)legend->count + 2 * (MARGIN + PADDING)) * em + 1;
    } while (em > smallest && (size[0] > limit[0] || size[1] > limit[1]));
    return em;
}

size_t legend_capacity(const struct legend *legend, double size, double height)
{
    struct layout layout = {.legend = legend, .em = size};
    find_header(&layout);
    double space = height - 2 * (MARGIN + PADDING) * size - head_height(&layout);
    return space > 0 ? (size_t)(space / (LINE * size)) : 0;
}

/* Chooses the columns and the width of the names: their full width, or what the columns leave. */
static double choose_columns(struct layout *layout)
{
    double em = layout->em;
    double details = measure_columns(layout);
    double widest = layout->legend->widest > 0 ? layout->legend->widest : WIDEST;
    double space = widest * layout->list->width - (MARGIN + 2 * PADDING + CHIP + CHIP_GAP) * em;
    double shortest = fmin(layout->name_width, SHORTEST_NAME * em);
    layout->columns = LEGEND_DETAILS;
    while (layout->columns > 0 && space - details < shortest) {
        details -= layout->column_width[--layout->columns];
    }
    layout->name_width = fmin(layout->name_width, space - details);
    return fmin(content_width(layout, details), space + (CHIP + CHIP_GAP) * em);
}

/* False where nothing fits. */
static bool measure_layout(struct layout *layout)
{
    const struct legend *legend = layout->legend;
    double em = layout->em;
    find_header(layout);
    double above = legend->at ? legend->at[1] : 0;
    size_t fitting = legend_capacity(layout->legend, layout->em, layout->list->height - above);
    size_t count = layout->legend->count;
    size_t tail = layout->legend->tail;
    layout->shown = count <= fitting ? count : fitting > 0 ? fitting - 1 : 0;
    layout->head = count <= fitting || layout->shown <= tail ? layout->shown : layout->shown - tail;
    double width = choose_columns(layout) + 2 * PADDING * em;
    size_t lines = layout->shown + (layout->shown < legend->count);
    double height = head_height(layout) + (LINE * (double)lines + 2 * PADDING) * em;
    bool right = legend->corner == LEGEND_TOP_RIGHT || legend->corner == LEGEND_BOTTOM_RIGHT;
    bool bottom = legend->corner == LEGEND_BOTTOM_LEFT || legend->corner == LEGEND_BOTTOM_RIGHT;
    double left = rint(right ? layout->list->width - MARGIN * em - width : MARGIN * em);
    double top = rint(bottom ? layout->list->height - MARGIN * em - height : MARGIN * em);
    left = legend->at ? rint(legend->at[0] + MARGIN * em) : left;
    top = legend->at ? rint(legend->at[1] + MARGIN * em) : top;
    layout->panel = (struct draw_box){left, top, left + ceil(width), top + rint(height)};
    return (layout->shown > 0 || legend->count == 0) && layout->name_width >= 0 && left >= 0 && top >= 0;
}

/* Draws `text`, shortened to `limit` pixels. */
static void write_text(const struct layout *layout, const double at[2], double size, double limit, const float rgba[4],
                       const char *text)
{
    char shorter[256];
    font_shorten(shorter, sizeof shorter, layout->font, size, text, limit);
    draw_text(layout->list, layout->font, at, size, rgba, shorter);
}

/* Draws the detail columns of one line, which end at the panel's right padding. */
static void write_details(const struct layout *layout, double baseline, const char *const *detail, const float rgba[4])
{
    double right = layout->panel.right - PADDING * layout->em;
    for (int c = layout->columns - 1; c >= 0; c--) {
        if (detail[c]) {
            double at[2] = {right - font_width(layout->font, layout->em, detail[c]), baseline};
            draw_text(layout->list, layout->font, at, layout->em, rgba, detail[c]);
        }
        right -= layout->column_width[c];
    }
}

static void write_head(const struct layout *layout, double *y)
{
    const struct legend *legend = layout->legend;
    double em = layout->em;
    double left = layout->panel.left + PADDING * em;
    double limit = layout->panel.right - PADDING * em - left;
    if (legend->title) {
        *y += TITLE * LINE * em;
        write_text(layout, (double[]){left, *y - BELOW_BASELINE * TITLE * em}, TITLE * em, limit, layout->bright,
                   legend->title);
    }
    if (legend->subtitle) {
        *y += LINE * em;
        write_text(layout, (double[]){left, *y - BELOW_BASELINE * em}, em, limit, layout->dim, legend->subtitle);
    }
    if (layout->has_header) {
        *y += LINE * em;
        write_details(layout, *y - BELOW_BASELINE * em, legend->header, layout->dim);
    }
}

/* The part of a bar that leads from the middle of the row above to this one, and the mark beside it. */
static void draw_bar(const struct layout *layout, double left, double baseline, const struct legend_row *row)
{
    const double em = layout->em;
    const double middle = rint(baseline + (0.04 - 0.5 * CHIP) * em);
    const double above = middle - rint(LINE * em);
    float colour[4];
    for (int k = 0; k < LEGEND_BAR && row->bar; k++) { /* a pixel over the row above, where lines are rounded apart */
        struct draw_box part = {rint(left), rint(above + (middle - above) * k / LEGEND_BAR) - (k == 0),
                                rint(left + CHIP * em), rint(above + (middle - above) * (k + 1) / LEGEND_BAR)};
        draw_colour(colour, row->bar[k], 1);
        draw_box(layout->list, &part, 0, colour);
    }
    double half = fmax(0.5, rint(0.06 * em) / 2);
    const struct draw_box mark = {rint(left + CHIP * em), middle - half, rint(left + (CHIP + 0.6 * CHIP_GAP) * em),
                                  middle + half};
    draw_box(layout->list, &mark, 0, layout->dim);
}

/* Between stripes of the chip's colour that of an area that does not stand out, as pictures have it. A stripe lies
 * between two values of x - y: three points at the upper and the left side of the box, three at the others. */
static void draw_stripes(const struct layout *layout, const struct draw_box *box, const float chip[4])
{
    const int period = (int)fmax(4, rint(0.45 * layout->em));
    const double width = box->right - box->left;
    const double height = box->bottom - box->top;
    double points[6][2];
    struct draw_item stripe = {.kind = DRAW_AREA, .points = points, .count = 6};
    for (int c = 0; c < 4; c++) {
        stripe.rgba[c] = c < 3 ? 0.16F * chip[c] + 0.30F : 1;
    }
    for (int n = 0; n * period < width + height; n++) {
        const double low = fmax(n * period - height - 0.5, -height);
        const double high = fmin(n * period - height - 0.5 + floor(0.5 * period), width);
        const double corners[2] = {fmin(fmax(0, low), high), fmin(fmax(width - height, low), high)};
        const double across[6] = {low, corners[0], high, high, corners[1], low};
        for (int k = 0; k < 6; k++) {
            points[k][0] = box->left + (k < 3 ? fmax(across[k], 0) : fmin(height + across[k], width));
            points[k][1] = box->top + (k < 3 ? fmax(-across[k], 0) : fmin(width - across[k], height));
        }
        draw_item(layout->list, &stripe);
    }
}

static void write_row(const struct layout *layout, double left, double baseline, const struct legend_row *row)
{
    double indent = row->heading ? 0 : (CHIP + CHIP_GAP) * layout->em;
    const float *colour = row->hollow || row->heading ? layout->dim : layout->bright;
    if (row->mark) {
        draw_bar(layout, left, baseline, row);
    } else if (!row->heading) {
        float chip[4];
        double bottom = baseline + 0.04 * layout->em;
        const struct draw_box box = {rint(left), rint(bottom - CHIP * layout->em), rint(left + CHIP * layout->em),
                                     rint(bottom)};
        draw_colour(chip, row->rgb, 1);
        if (row->hollow) {
            memcpy(chip, layout->dim, sizeof chip);
        }
        draw_frame(layout->list, &box, 0.18 * layout->em, row->hollow ? fmax(1, 0.08 * layout->em) : 0, chip);
        if (row->striped) {
            draw_stripes(layout, &box, chip);
        }
    }
    write_text(layout, (double[]){left + indent, baseline}, layout->em, layout->name_width + 0.01, colour, row->name);
    write_details(layout, baseline, row->detail, colour);
}

void legend_draw(struct draw_list *list, struct font *font, const struct legend *legend)
{
    struct layout layout = {.legend = legend, .font = font, .list = list};
    layout.em = legend->size > 0 ? legend->size : legend_size(list);
    const float *ink = layout.legend->ink;
    memcpy(layout.bright, ink ? ink : BRIGHT, sizeof layout.bright);
    memcpy(layout.dim, ink ? ink : DIM, sizeof layout.dim);
    layout.dim[3] *= !ink ? 1 : legend->faint > 0 ? (float)legend->faint : 0.87F;
    if (!measure_layout(&layout)) {
        return;
    }
    if (!legend->ink) {
        draw_box(list, &layout.panel, 0.45 * layout.em, PANEL);
        draw_frame(list, &layout.panel, 0.45 * layout.em, fmax(1, 0.06 * layout.em), RIM);
    }
    const double em = layout.em;
    const double left = layout.panel.left + PADDING * em;
    const bool is_short = layout.shown < legend->count;
    double y = layout.panel.top + PADDING * em;
    write_head(&layout, &y);
    for (size_t line = 0; line < layout.shown + is_short; line++) {
        y += LINE * em;
        double baseline = rint(y - BELOW_BASELINE * em);
        if (is_short && line == layout.head) {
            char text[64];
            snprintf(text, sizeof text, "\xe2\x80\xa6 and %zu more", legend->count - layout.shown);
            const double at[2] = {left + (CHIP + CHIP_GAP) * em, baseline};
            draw_text(list, font, at, em, layout.dim, text);
        } else {
            write_row(&layout, left, baseline, shown_row(&layout, line - (is_short && line > layout.head)));
        }
    }
}
