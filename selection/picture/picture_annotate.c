/* SPDX-License-Identifier: BSD-3-Clause */
/* Adds the legend and the other annotations to a picture. */
#include "selection/picture/picture.h"

#include "base/math3.h"
#include "base/memory.h"
#include "render/colour/pathways.h"
#include "render/flat/draw.h"
#include "render/flat/font.h"
#include "render/flat/legend.h"

#include <stdio.h>

enum { TEXT_SIZE = 128, CELL_SIZE = 24, PATHWAY_ROWS = 5 };

static const float ink[4] = {0.02F, 0.02F, 0.025F, 1};
static const float faint[4] = {0.02F, 0.02F, 0.025F, 0.45F};

/* ---- Legend --------------------------------------------------------------------------------------------------- */

/* The words of one row, which legend_row points to. */
struct cells {
    char share[CELL_SIZE], distance[CELL_SIZE];
};

static void fill_row(struct legend_row *row, struct cells *cells, const conus_atlas *atlas, const conus_result *result)
{
    snprintf(cells->share, sizeof cells->share, "%.1f %%", 100 * result->share);
    snprintf(cells->distance, sizeof cells->distance, "%.1f mm", result->distance);
    row->detail[0] = cells->share;
    row->hollow = !result->object;
    row->name = "unassigned";
    if (result->object) {
        const conus_object *object = &atlas->objects[result->object - 1];
        row->name = object->name;
        memcpy(row->rgb, object->rgb, sizeof row->rgb);
        row->detail[1] = cells->distance;
    }
}

/* What of an atlas with pathways the picture shows beside what is hit: pathways that are not, each while they are few,
 * and that the other areas are left out. */
static size_t add_pathways(struct legend_row rows[PATHWAY_ROWS], char words[TEXT_SIZE], const struct picture *picture)
{
    const conus_atlas *atlas = picture->atlas;
    size_t count = 0;
    size_t others = 0;
    for (size_t number = atlas->area_count + 1; number <= atlas->object_count; number++) {
        if (!conus_atlas_is_hidden(atlas, number) && picture->emphasis[number] == EMPHASIS_PALE) {
            const conus_object *pathway = &atlas->objects[number - 1];
            if (others++ < PATHWAY_ROWS - 1) {
                rows[count++] = (struct legend_row){.name = pathway->name, .detail = {"not hit"}};
                memcpy(rows[count - 1].rgb, pathway->rgb, sizeof pathway->rgb);
            }
        }
    }
    if (others > count) {
        snprintf(words, TEXT_SIZE, "%zu pathways", others);
        rows[0] = (struct legend_row){.name = words, .hollow = true, .detail = {"not hit"}};
        count = 1;
    }
    if (pathways_first(atlas) && atlas_parcellation_count(atlas)) {
        rows[count++] = (struct legend_row){.name = "other areas", .hollow = true, .detail = {"not drawn"}};
    }
    return count;
}

static void describe_cone(char out[TEXT_SIZE], const struct cone *cone)
{
    const double *apex = cone->pose.world_from_device + 12;
    bool rod = cone->radius > 0;
    snprintf(out, TEXT_SIZE, "%s%.4g%s from %.4g, %.4g, %.4g, RAS mm", rod ? "radius " : "",
             rod ? cone->radius : degrees_from_radians(cone->angle), rod ? " mm" : "\u00b0", apex[0], apex[1], apex[2]);
}

/* Opacity that was drawn under a legend of about that size in a corner, top left first. */
static double covered(const conus_image *image, const struct picture *picture, enum legend_corner corner, size_t rows)
{
    uint32_t width = image->width / 3;
    uint32_t height = (uint32_t)fmin(image->height, 1.5 * ((double)rows + 4) * legend_size(image));
    uint32_t left = corner == LEGEND_TOP_RIGHT ? image->width - width : 0;
    uint32_t bottom = corner == LEGEND_BOTTOM_LEFT ? 0 : image->height - height;
    double sum = 0;
    for (uint32_t y = bottom; y < bottom + height; y++) {
        for (uint32_t x = left; x < left + width; x++) {
            sum += (double)picture->rgba[4 * ((size_t)y * image->width + x) + 3];
        }
    }
    return sum;
}

/* The corner in which the legend hides least; the fourth one is taken by the directions. */
static enum legend_corner free_corner(const conus_image *image, const struct picture *picture, size_t rows)
{
    static const enum legend_corner corners[] = {LEGEND_TOP_LEFT, LEGEND_TOP_RIGHT, LEGEND_BOTTOM_LEFT};
    enum legend_corner best = LEGEND_TOP_LEFT;
    double least = INFINITY;
    for (size_t i = 0; i < sizeof corners / sizeof *corners; i++) {
        double hidden = covered(image, picture, corners[i], rows);
        if (hidden < 0.8 * least) {
            least = hidden;
            best = corners[i];
        }
    }
    return best;
}

static conus_status draw_legend(conus_image *image, struct font *font, const struct picture *picture)
{
    const conus_selection *selection = picture->options.selection;
    size_t results = conus_selection_count(selection);
    size_t count = 0;
    struct legend_row *rows = memory_zeroed(results + PATHWAY_ROWS, sizeof *rows);
    struct cells *cells = memory_zeroed(results, sizeof *cells);
    conus_status status = rows && cells ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status) {
        char subtitle[TEXT_SIZE];
        char words[TEXT_SIZE];
        describe_cone(subtitle, &selection->cone);
        for (size_t i = 0; i < results; i++) {
            const conus_result *result = conus_selection_result(selection, i);
            if (picture_lists(result)) {
                fill_row(&rows[count], &cells[count], picture->atlas, result);
                count++;
            }
        }
        count += add_pathways(rows + count, words, picture);
        const struct legend legend = {.title = "First hits of the cone",
                                      .subtitle = subtitle,
                                      .header = {"share", "distance"},
                                      .rows = rows,
                                      .count = count,
                                      .corner = free_corner(image, picture, count)};
        status = legend_draw(image, font, &legend);
    }
    memory_free(rows);
    memory_free(cells);
    return status;
}

/* ---- Directions ----------------------------------------------------------------------------------------------- */

static conus_status draw_letter(conus_image *image, struct font *font, const double at[2], const float rgba[4],
                                const char *letter)
{
    double size = legend_size(image);
    const double corner[2] = {at[0] - font_width(font, size, letter) / 2, at[1] + 0.36 * size};
    return font_draw(font, image, corner, size, rgba, letter);
}

/* Half an axis, from the middle of the cross towards `direction` (world). */
static conus_status draw_direction(conus_image *image, struct font *font, const struct picture *picture,
                                   const double direction[3], const char *letter)
{
    const double *m = picture->camera.world_from_camera;
    double size = legend_size(image);
    double length = 2.6 * size;
    const double centre[2] = {image->width - 1.9 * length, image->height - 1.8 * length};
    double x = vec3_dot(m, direction);
    double y = -vec3_dot(m + 4, direction);
    bool behind = vec3_dot(m + 8, direction) < 0;
    const float *rgba = behind ? faint : ink;
    const double end[2] = {centre[0] + length * x, centre[1] + length * y};
    double flat = sqrt(x * x + y * y);
    draw_line(image, centre, end, behind ? 1.2 : 2.2, rgba);
    double out = flat > 0.15 ? 0.75 * size / flat : 0;
    const double at[2] = {end[0] + out * x, end[1] + out * y};
    return flat > 0.15 ? draw_letter(image, font, at, rgba, letter) : CONUS_OK;
}

static conus_status draw_directions(conus_image *image, struct font *font, const struct picture *picture)
{
    static const char letters[6][2] = {"L", "R", "P", "A", "I", "S"};
    conus_status status = CONUS_OK;
    for (int n = 0; n < 6 && !status; n++) {
        double direction[3] = {0, 0, 0};
        direction[n / 2] = n % 2 ? 1 : -1;
        status = draw_direction(image, font, picture, direction, letters[n]);
    }
    return status;
}

/* ---- Scale ---------------------------------------------------------------------------------------------------- */

/* The largest of 1, 2, 5, 10, ... that is at most `limit`. */
static double round_length(double limit)
{
    double power = pow(10, floor(log10(limit)));
    return limit >= 5 * power ? 5 * power : limit >= 2 * power ? 2 * power : power;
}

/* A bar as long as so many mm are at the depth of the middle of what shows. */
static conus_status draw_scale(conus_image *image, struct font *font, const struct picture *picture)
{
    double x, y, depth;
    if (!camera_project(&x, &y, &depth, &picture->camera, &picture->frame, picture->centre)) {
        return CONUS_OK;
    }
    double size = legend_size(image);
    double pixels_per_mm = image->width / (2 * depth * picture->camera.slope[0]);
    double length = round_length(0.14 * image->width / pixels_per_mm);
    char text[CELL_SIZE];
    snprintf(text, sizeof text, "%g mm", length);
    double right = image->width - 10.5 * size;
    double left = right - length * pixels_per_mm;
    double base = image->height - 1.4 * size;
    draw_line(image, (double[]){left, base}, (double[]){right, base}, 2, ink);
    draw_line(image, (double[]){left, base - 0.3 * size}, (double[]){left, base + 0.3 * size}, 2, ink);
    draw_line(image, (double[]){right, base - 0.3 * size}, (double[]){right, base + 0.3 * size}, 2, ink);
    const double at[2] = {(left + right - font_width(font, size, text)) / 2, base - 0.55 * size};
    return font_draw(font, image, at, size, ink, text);
}

conus_status picture_annotate(conus_image *image, const struct picture *picture)
{
    struct font *font = NULL;
    conus_status status = font_create(&font);
    if (!status && picture->options.selection) {
        status = draw_legend(image, font, picture);
    }
    status = status ? status : draw_directions(image, font, picture);
    status = status ? status : draw_scale(image, font, picture);
    font_destroy(font);
    return status;
}
