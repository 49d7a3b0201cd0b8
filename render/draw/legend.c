/* SPDX-License-Identifier: BSD-3-Clause */
/* Lays a legend out in columns and draws it. */
#include "render/draw/draw.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Lengths in em. */
static const double MARGIN = 1.2;
static const double LINE = 1.45;
static const double TITLE = 1.1; /* size of its letters */
static const double CHIP = 0.78;
static const double CHIP_GAP = 0.5;
static const double DETAIL_GAP = 1.0;
static const double COLUMN_GAP = 2.2;
static const double SHORTEST_NAME = 5;
static const double BELOW_BASELINE = 0.45; /* the part of a line below its baseline */

static const float FAINT = 0.87F;

/* A legend with its measures. */
struct layout {
    const struct legend *legend;
    struct font *font;
    struct draw_list *list;
    double em;
    size_t shown;           /* lines: rows, and one that counts those that are left out */
    size_t head;            /* those above that one */
    size_t key;             /* those of the legend's tail */
    struct legend_row more; /* that one */
    char text[64];
    size_t columns, lines;                                           /* columns, and lines of each at most */
    int details;                                                     /* shown */
    double name_width[LEGEND_COLUMNS], detail_width[LEGEND_DETAILS]; /* names: in each column */
    bool has_header;
    double left, top; /* without the margin */
    float dim[4];
};

/* Where a line stands. */
struct place {
    size_t column, line;
};

static double width_of(const struct layout *layout, double size, const char *text)
{
    return text ? font_width(layout->font, size, text) : 0;
}

static const struct legend_row *line_at(const struct layout *layout, size_t i)
{
    const struct legend *legend = layout->legend;
    return i < layout->head                         ? &legend->rows[i]
           : i == layout->head && layout->more.name ? &layout->more
                                                    : &legend->rows[legend->count - layout->shown + i];
}

/* A layout of all rows. */
static struct layout lay_out(const struct legend *legend, struct font *font, double em)
{
    struct layout layout = {.legend = legend,
                            .font = font,
                            .em = em,
                            .shown = legend->count,
                            .head = legend->count,
                            .key = legend->tail,
                            .columns = legend->columns < 1                ? 1
                                       : legend->columns < LEGEND_COLUMNS ? legend->columns
                                                                          : LEGEND_COLUMNS,
                            .details = LEGEND_DETAILS};
    for (int d = 0; d < LEGEND_DETAILS; d++) {
        layout.has_header = layout.has_header || legend->header[d];
    }
    return layout;
}

/* Whether a line must stand below the one before: in a key below its heading, a mark with the bar that leads to it. */
static bool is_joined(const struct layout *layout, size_t i)
{
    const struct legend_row *row = line_at(layout, i);
    return row->bar || (i + layout->key > layout->shown && !row->heading);
}

/* Moves from the place of the line before to that of line `i`, which may begin the next column. */
static void step_to(struct place *place, const struct layout *layout, size_t i)
{
    size_t block = 1;
    while (i + block < layout->shown && is_joined(layout, i + block)) {
        block++;
    }
    bool is_whole = !is_joined(layout, i) && block <= layout->lines;
    place->line += i > 0;
    if (place->line >= layout->lines || (is_whole && place->line + block > layout->lines)) {
        place->column++;
        place->line = 0;
    }
}

static bool fits_into_columns(const struct layout *layout)
{
    struct place place = {0, 0};
    bool is_broken = false; /* a bar, of which another column has the marks before */
    for (size_t i = 0; i < layout->shown; i++) {
        step_to(&place, layout, i);
        is_broken = is_broken || (line_at(layout, i)->bar && place.line == 0);
    }
    return place.column < layout->columns && !is_broken;
}

/* The least number of lines with which all stand in the columns. */
static void balance(struct layout *layout)
{
    layout->lines = layout->shown ? (layout->shown + layout->columns - 1) / layout->columns : 1;
    while (!fits_into_columns(layout)) {
        layout->lines++;
    }
}

static double details_width(const struct layout *layout)
{
    double width = 0;
    for (int d = 0; d < layout->details; d++) {
        width += layout->detail_width[d];
    }
    return width;
}

/* Lines that are no rows, and the height they take. */
static double head_height(const struct layout *layout)
{
    double height = layout->legend->title ? TITLE * LINE : 0;
    for (int n = 0; n < LEGEND_SUBTITLES; n++) {
        height += layout->legend->subtitle[n] ? LINE : 0;
    }
    height += layout->has_header ? LINE : 0;
    return height * layout->em;
}

/* How many lines a column has room for. */
static size_t count_lines(const struct layout *layout, double height)
{
    double space = height - 2 * MARGIN * layout->em - head_height(layout);
    return space > 0 ? (size_t)fmin(space / (LINE * layout->em), INT32_MAX) : 0;
}

/* Leaves rows out until the others stand in the columns, the last ones above the key first; where there are hardly
 * lines for the key, that, too. */
static void leave_out(struct layout *layout, size_t lines)
{
    const struct legend *legend = layout->legend;
    layout->lines = lines;
    layout->shown++;
    do {
        layout->shown--;
        layout->key = layout->shown > legend->tail + 1 ? legend->tail : 0;
        layout->head = layout->shown ? layout->shown - 1 - layout->key : 0;
        layout->more = (struct legend_row){.plain = true, .name = layout->text};
    } while (layout->shown && !fits_into_columns(layout));
    const size_t others = legend->count - layout->shown + 1;
    snprintf(layout->text, sizeof layout->text, others == 1 ? "and %zu other" : "and %zu others", others);
}

/* Puts the rows into the columns, or those that have place in so many lines of each. Measures the details, and the
 * names of each column. */
static void arrange(struct layout *layout, size_t lines)
{
    struct place place = {0, 0};
    balance(layout);
    if (layout->lines > lines) {
        leave_out(layout, lines);
    }
    for (int d = 0; d < LEGEND_DETAILS; d++) {
        double width = width_of(layout, layout->em, layout->legend->header[d]);
        for (size_t i = 0; i < layout->shown; i++) {
            width = fmax(width, width_of(layout, layout->em, line_at(layout, i)->detail[d]));
        }
        layout->detail_width[d] = width > 0 ? width + DETAIL_GAP * layout->em : 0;
    }
    for (size_t i = 0; i < layout->shown; i++) {
        const struct legend_row *row = line_at(layout, i);
        bool is_long = row == &layout->more && details_width(layout) > 0; /* it has the place of details, too */
        step_to(&place, layout, i);
        double *width = &layout->name_width[place.column];
        *width = fmax(*width, is_long ? 0 : width_of(layout, layout->em, row->name));
    }
}

static double column_width(const struct layout *layout, size_t column)
{
    return (CHIP + CHIP_GAP) * layout->em + layout->name_width[column] + details_width(layout);
}

static double columns_width(const struct layout *layout)
{
    double width = (double)(layout->columns - 1) * COLUMN_GAP * layout->em;
    for (size_t column = 0; column < layout->columns; column++) {
        width += column_width(layout, column);
    }
    return width;
}

/* The width of the columns, or of the lines above them. */
static double content_width(const struct layout *layout)
{
    double width = fmax(columns_width(layout), width_of(layout, TITLE * layout->em, layout->legend->title));
    for (int n = 0; n < LEGEND_SUBTITLES; n++) {
        width = fmax(width, width_of(layout, layout->em, layout->legend->subtitle[n]));
    }
    return width;
}

void legend_fit(double size[2], struct legend *legend, struct font *font, const double limit[2], double largest,
                double smallest)
{
    static const double step = 0.96;
    struct layout layout;
    double em = largest / step;
    do {
        em = fmax(em * step, smallest);
        size_t columns = lay_out(legend, font, em).columns + 1;
        do {
            layout = lay_out(legend, font, em);
            layout.columns = --columns;
            balance(&layout);
            size[1] = head_height(&layout) + (LINE * (double)layout.lines + 2 * MARGIN) * em + 1;
            arrange(&layout, count_lines(&layout, limit[1]));
            size[0] = content_width(&layout) + 2 * MARGIN * em + 1; /* lines begin at whole pixels */
        } while (columns > 1 && size[0] > limit[0]);
    } while (em > smallest && (size[0] > limit[0] || size[1] > limit[1]));
    legend->size = em;
    legend->columns = layout.columns;
}

size_t legend_capacity(const struct legend *legend, double height)
{
    const struct layout layout = lay_out(legend, NULL, legend->size);
    return layout.columns * count_lines(&layout, height);
}

/* Chooses the details and the width of names: their full width, or in equal columns what is left beside details. False
 * where nothing fits. */
static bool measure_layout(struct layout *layout)
{
    const struct legend *legend = layout->legend;
    const double em = layout->em;
    const double columns = (double)layout->columns;
    layout->left = rint(legend->at[0] + MARGIN * em);
    layout->top = rint(legend->at[1] + MARGIN * em);
    const double width = layout->list->width - layout->left - MARGIN * em;
    const double space = (width - (columns - 1) * COLUMN_GAP * em) / columns - (CHIP + CHIP_GAP) * em;
    arrange(layout, count_lines(layout, layout->list->height - legend->at[1]));
    if (columns_width(layout) > width) {
        double widest = 0;
        for (size_t column = 0; column < layout->columns; column++) {
            widest = fmax(widest, layout->name_width[column]);
        }
        while (layout->details > 0 && space - details_width(layout) < fmin(widest, SHORTEST_NAME * em)) {
            layout->details--;
        }
        for (size_t column = 0; column < layout->columns; column++) {
            layout->name_width[column] = fmin(layout->name_width[column], space - details_width(layout));
        }
    }
    return (layout->shown > 1 || layout->shown == legend->count) && layout->name_width[0] >= 0;
}

/* Draws `text`, shortened to `limit` pixels. */
static void write_text(const struct layout *layout, const double at[2], double size, double limit, const float rgba[4],
                       const char *text)
{
    char shorter[256];
    font_shorten(shorter, sizeof shorter, layout->font, size, text, limit);
    draw_text(layout->list, layout->font, at, size, rgba, shorter);
}

/* Draws the details of a line, which end at the column's right edge. */
static void write_details(const struct layout *layout, size_t column, double left, double baseline,
                          const char *const *detail, const float rgba[4])
{
    double right = left + column_width(layout, column);
    for (int d = layout->details - 1; d >= 0; d--) {
        if (detail[d]) {
            const double at[2] = {right - font_width(layout->font, layout->em, detail[d]), baseline};
            draw_text(layout->list, layout->font, at, layout->em, rgba, detail[d]);
        }
        right -= layout->detail_width[d];
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

static void write_row(const struct layout *layout, size_t column, double left, double baseline,
                      const struct legend_row *row)
{
    double indent = row->heading ? 0 : (CHIP + CHIP_GAP) * layout->em;
    const float *ink = row->plain || row->heading ? layout->dim : layout->legend->ink;
    if (row->mark) {
        draw_bar(layout, left, baseline, row);
    } else if (!row->heading && !row->plain && !row->bare) {
        float chip[4];
        double bottom = baseline + 0.04 * layout->em;
        const struct draw_box box = {rint(left), rint(bottom - CHIP * layout->em), rint(left + CHIP * layout->em),
                                     rint(bottom)};
        draw_colour(chip, row->rgb, 1);
        draw_box(layout->list, &box, 0.18 * layout->em, chip);
        for (int k = 0; k < LEGEND_BAR && row->ramp; k++) {
            const double step = (box.right - box.left) / LEGEND_BAR;
            const struct draw_box part = {box.left + step * k, box.top, box.right, box.bottom};
            draw_colour(chip, row->ramp[k], 1);
            draw_box(layout->list, &part, 0, chip); /* up to the end: the next one lies over it */
        }
        if (row->striped) {
            draw_stripes(layout, &box, chip);
        }
    }
    double limit = row == &layout->more ? column_width(layout, column) - indent : layout->name_width[column] + 0.01;
    write_text(layout, (double[]){left + indent, baseline}, layout->em, limit, ink, row->name);
    write_details(layout, column, left, baseline, row->detail, ink);
}

/* The lines above the columns. */
static double write_head(const struct layout *layout)
{
    const struct legend *legend = layout->legend;
    const double limit = layout->list->width - layout->left - MARGIN * layout->em;
    double y = layout->top;
    for (int n = -1; n < LEGEND_SUBTITLES; n++) {
        const char *words = n < 0 ? legend->title : legend->subtitle[n];
        const double size = (n < 0 ? TITLE : 1) * layout->em;
        if (words) {
            y += LINE * size;
            write_text(layout, (double[]){layout->left, y - BELOW_BASELINE * size}, size, limit,
                       n < 0 ? legend->ink : layout->dim, words);
        }
    }
    return y;
}

void legend_draw(struct draw_list *list, struct font *font, const struct legend *legend)
{
    struct layout layout = lay_out(legend, font, legend->size);
    layout.list = list;
    memcpy(layout.dim, legend->ink, sizeof layout.dim);
    layout.dim[3] *= legend->faint > 0 ? (float)legend->faint : FAINT;
    if (!measure_layout(&layout)) {
        return;
    }
    const double top = write_head(&layout) + (layout.has_header ? LINE * layout.em : 0);
    double left = layout.left;
    struct place place = {0, 0};
    for (size_t i = 0; i < layout.shown; i++) {
        const size_t before = place.column;
        step_to(&place, &layout, i);
        const size_t column = place.column;
        left += column > before ? column_width(&layout, before) + COLUMN_GAP * layout.em : 0;
        const double y = top + LINE * layout.em * (double)(place.line + 1) - BELOW_BASELINE * layout.em;
        if (layout.has_header && place.line == 0) {
            write_details(&layout, column, left, top - BELOW_BASELINE * layout.em, legend->header, layout.dim);
        }
        write_row(&layout, column, left, rint(y), line_at(&layout, i));
    }
}
