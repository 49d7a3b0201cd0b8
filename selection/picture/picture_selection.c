/* SPDX-License-Identifier: BSD-3-Clause */
/* The evidence as an image, and a picture of it with a legend. */
#include "selection/picture/picture.h"

#include "base/geometry/math3.h"
#include "base/look.h"
#include "base/memory.h"
#include "base/text.h"
#include "conus/own.h"
#include "render/draw/draw.h"
#include "render/image/image.h"
#include "selection/selection.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum {
    PICTURE_SIDE = 512, /* pixels of the device's are magnified until they fill at least this */
    LEGEND_WIDTH = 420,
    LETTERS = 15,
    GRID = 8, /* from this magnification on, lines between the device's pixels */
};

static const uint8_t NOTHING[3] = {LOOK_RGB(LOOK_SEEN_NOTHING)};
static const uint8_t BACKGROUND[3] = {LOOK_RGB(LOOK_SEEN_AROUND)};
static const float LETTER_INK[4] = {LOOK_LEGEND_TEXT, 1};
static const float HIDDEN_SHADE = 0.15F; /* for pixels that the aperture hides: linear light */
static const float LINE_SHADE = 0.72F;

static uint32_t label_of(const conus_atlas *atlas, uint32_t number)
{
    const conus_object *object = conus_atlas_object(atlas, number);
    return object ? object->label : 0;
}

/* To an image without channels. */
static conus_status add_channels(conus_image *image, const conus_selection *selection)
{
    enum { ID, OBJECT, X, T = X + 3, COUNT };
    static const char *const names[COUNT] = {"id", "object", "X", "Y", "Z", "t"};
    const struct evidence *evidence = &selection->evidence;
    conus_status status = CONUS_OK;
    for (int c = 0; !status && c < COUNT; c++) {
        status = image_add_channel(image, names[c], c < X ? IMAGE_UINT : IMAGE_FLOAT, NULL);
    }
    const struct image_channel *channels = image->channels;
    for (size_t to = 0; !status && to < (size_t)image->width * image->height; to++) {
        size_t from = picture_flipped(evidence->resolution, to);
        double position[3];
        conus_selection_position(position, selection, from);
        channels[ID].uints[to] = label_of(selection->atlas, evidence->object[from]);
        channels[OBJECT].uints[to] = evidence->object[from];
        for (int c = 0; c < 3; c++) {
            channels[X + c].floats[to] = (float)position[c];
        }
        channels[T].floats[to] = (float)evidence->distance[from];
    }
    return status;
}

/* Adds a volume as "conus:NAME" with its SHA-256; without its path, if that is there already. */
static conus_status add_volume(conus_image *image, const conus_volume_info *info, const char *name, bool said)
{
    char sum_name[64];
    snprintf(sum_name, sizeof sum_name, "%sSha256", name);
    conus_status status = said ? CONUS_OK : image_add_text(image, name, info->path);
    return status ? status : image_add_text(image, sum_name, info->sha256);
}

/* "n/a" where a band has no end. */
static const char *end_text(char out[TEXT_NUMBER_SIZE], double end)
{
    return isfinite(end) ? text_number(out, end) : "n/a";
}

/* Adds the limits of the values that make voxels belong to the objects of the volume. */
static conus_status add_ends(conus_image *image, const conus_atlas *atlas, size_t index)
{
    char name[48];
    char number[2][TEXT_NUMBER_SIZE];
    struct buffer bands = {0};
    const conus_volume_info *info = conus_atlas_volume(atlas, index);
    for (size_t i = atlas->area_count; i < atlas->object_count; i++) {
        const conus_object *band = &atlas->objects[i];
        if (band->is_band && band->volume == index) {
            buffer_format(&bands, "%s%s\t%s\t%s\n", bands.size ? "" : "low\thigh\tname\n",
                          end_text(number[0], band->low), end_text(number[1], band->high), band->name);
        }
    }
    conus_status status = buffer_status(&bands);
    bool has_bands = bands.size > 0;
    snprintf(name, sizeof name, "conus:volume%zu%s", index, has_bands ? "Bands" : "Threshold");
    if (!status && (has_bands || info->threshold > 0)) {
        status = image_add_text(image, name, has_bands ? bands.data : text_number(number[0], info->threshold));
    }
    buffer_finish(&bands);
    return status;
}

/* The parcellation is the atlas itself, or what a manifest or an XML names. */
static conus_status add_any_volume(conus_image *image, const conus_atlas *atlas, size_t index)
{
    char name[40];
    const conus_volume_info *info = conus_atlas_volume(atlas, index);
    bool is_atlas = info->role == CONUS_ROLE_PARCELLATION && strcmp(info->path, atlas_path(atlas)) == 0;
    if (info->role == CONUS_ROLE_PARCELLATION && index == 0) {
        return add_volume(image, info, is_atlas ? "conus:atlas" : "conus:parcellation", is_atlas);
    }
    snprintf(name, sizeof name, info->role == CONUS_ROLE_PARCELLATION ? "conus:parcellation%zu" : "conus:volume%zu",
             index);
    conus_status status = add_volume(image, info, name, false);
    return status ? status : add_ends(image, atlas, index);
}

/* Adds the text, unless it is empty, and releases it. */
static conus_status add_buffer(conus_image *image, const char *name, struct buffer *text)
{
    conus_status status = buffer_status(text);
    if (!status && text->size) {
        status = image_add_text(image, name, text->data);
    }
    buffer_finish(text);
    return status;
}

conus_status picture_add_volumes(conus_image *image, const conus_atlas *atlas, bool context)
{
    const char *path = atlas_path(atlas);
    conus_status status = path[0] ? image_add_text(image, "conus:atlas", path) : CONUS_OK;
    for (size_t i = 0; !status && i < conus_atlas_volume_count(atlas); i++) {
        if (conus_atlas_volume(atlas, i)->role != CONUS_ROLE_CONTEXT || context) {
            status = add_any_volume(image, atlas, i);
        }
    }
    if (status) {
        return status;
    }
    struct buffer files = {0}; /* the manifest, surfaces and the like, a line each */
    for (size_t i = 0; i < atlas->files.count; i++) {
        buffer_format(&files, "%s  %s\n", atlas->files.items[i].sha256, atlas->files.items[i].path);
    }
    status = add_buffer(image, "conus:files", &files);
    if (status) {
        return status;
    }
    struct buffer hidden = {0};
    atlas_list_hidden(&hidden, atlas);
    return add_buffer(image, "conus:hidden", &hidden);
}

/* The names of the objects in the cone, so that the numbers in the image can be read without the atlas. */
static conus_status add_names(conus_image *image, const conus_selection *selection)
{
    struct buffer text = {0};
    buffer_text(&text, "object\tid\tkind\tname\n");
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        uint32_t number = conus_selection_result(selection, i)->object;
        const conus_object *object = conus_atlas_object(selection->atlas, number);
        if (object) {
            buffer_format(&text, "%u\t%u\t%s\t%s\n", number, object->label, atlas_kind_word(object->kind),
                          object->name);
        }
    }
    return add_buffer(image, "conus:objects", &text);
}

/* How the selection came about, the atlas's files, and what is in the cone. */
static conus_status add_attributes(conus_image *image, const conus_selection *selection)
{
    const struct cone *cone = &selection->cone;
    char angle[TEXT_NUMBER_SIZE];
    char fraction[TEXT_NUMBER_SIZE];
    char radius[TEXT_NUMBER_SIZE];
    char near[TEXT_NUMBER_SIZE];
    char far[TEXT_NUMBER_SIZE];
    char range[2 * TEXT_NUMBER_SIZE];
    text_number(angle, cone->degrees);
    text_number(fraction, selection->slice_fraction);
    text_number(radius, cone->radius);
    snprintf(range, sizeof range, "%s %s", text_number(near, cone->range[0]), text_number(far, cone->range[1]));
    const char *const pairs[][2] = {
        {"conus:version", CONUS_VERSION},
        {"conus:space", "RAS mm"},
        {"conus:angleDegrees", angle},
        {"conus:radiusMm", cone->radius > 0 ? radius : NULL},
        {"conus:rangeMm", cone_has_range(cone) ? range : NULL},
        {"conus:aperture", cone->aperture == CONUS_APERTURE_SQUARE ? "square" : "circle"},
        {"conus:spread", cone_is_wide(cone) ? "even" : NULL},
        {"conus:sampling", selection->sampling == CONUS_SAMPLING_SLICES ? "slices" : "exact"},
        {"conus:sliceFraction", selection->slice_fraction > 0 ? fraction : NULL},
        {"conus:engine", selection->engine},
    };
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < sizeof pairs / sizeof pairs[0]; i++) {
        status = pairs[i][1] ? image_add_text(image, pairs[i][0], pairs[i][1]) : CONUS_OK;
    }
    status = status ? status : image_add_matrix(image, "conus:worldFromDevice", cone->pose.world_from_device);
    status = status ? status : picture_add_volumes(image, selection->atlas, false);
    return status ? status : add_names(image, selection);
}

static void shade(float colour[4], float factor)
{
    for (int c = 0; c < 3; c++) {
        colour[c] *= factor;
    }
}

/* The device's pixels on the left, the background beside them. */
static void draw_pixels(conus_image *picture, const conus_selection *selection, uint32_t factor)
{
    const struct image_rgba planes = image_rgba(picture);
    uint32_t n = selection->evidence.resolution;
    float colour[4];
    draw_colour(colour, BACKGROUND, 1);
    for (size_t pixel = 0; pixel < (size_t)picture->width * picture->height; pixel++) {
        image_lay(&planes, pixel, colour);
    }
    for (uint32_t y = 0; y < n; y++) {
        for (uint32_t x = 0; x < n; x++) {
            size_t pixel = picture_flipped(n, (size_t)y * n + x);
            const conus_object *object = conus_atlas_object(selection->atlas, selection->evidence.object[pixel]);
            draw_colour(colour, object ? object->rgb : NOTHING, 1);
            shade(colour, selection->in_cone[pixel] ? 1 : HIDDEN_SHADE);
            /* A pixel of the device is `factor` pixels wide; its first row and column are darker, to make a grid. */
            float shaded[4] = {colour[0], colour[1], colour[2], 1};
            shade(shaded, LINE_SHADE);
            for (uint32_t j = 0; j < factor; j++) {
                for (uint32_t i = 0; i < factor; i++) {
                    size_t to = ((size_t)y * factor + j) * picture->width + (size_t)x * factor + i;
                    image_lay(&planes, to, factor >= GRID && (i == 0 || j == 0) ? shaded : colour);
                }
            }
        }
    }
}

struct details {
    char pixels[24], share[24], distance[24];
};

static conus_status draw_legend(struct draw_list *panel, const conus_selection *selection, struct font *font)
{
    size_t results = conus_selection_count(selection);
    size_t count = 0;
    struct legend_row *rows = memory_zeroed(results, sizeof *rows);
    struct details *details = memory_zeroed(results, sizeof *details);
    conus_status status = rows && details ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < results; i++) {
        const conus_result *result = conus_selection_result(selection, i);
        if (result->object && !result->pixels) { /* behind others */
            continue;
        }
        const conus_object *object = conus_atlas_object(selection->atlas, result->object);
        struct details *text = &details[count];
        struct legend_row *row = &rows[count++];
        *row = (struct legend_row){.plain = !object,
                                   .name = object ? object->name : "unassigned",
                                   .detail = {text->pixels, text->share, text->distance}};
        memcpy(row->rgb, object ? object->rgb : (const uint8_t[]){LOOK_RGB(LOOK_NO_OBJECT)}, sizeof row->rgb);
        snprintf(text->pixels, sizeof text->pixels, "%u", result->pixels);
        char share[TEXT_SHARE_SIZE];
        snprintf(text->share, sizeof text->share, "%s %%", text_share(share, result->share, 1));
        if (isfinite(result->distance)) {
            snprintf(text->distance, sizeof text->distance, "%.1f mm", result->distance);
        }
    }
    if (!status) {
        char title[96];
        bool rod = selection->cone.radius > 0;
        snprintf(title, sizeof title, "What the device saw, %.4g%s",
                 rod ? selection->cone.radius : selection->cone.degrees, rod ? " mm" : "\xc2\xb0");
        const struct legend legend = {.title = title,
                                      .header = {"pixels", "share", "distance"},
                                      .rows = rows,
                                      .count = count,
                                      .ink = LETTER_INK,
                                      .size = LETTERS};
        legend_draw(panel, font, &legend);
    }
    memory_free(rows);
    memory_free(details);
    return status;
}

/* With the legend on the right; without it where no font is installed. */
static conus_status create_picture(conus_image **out, const conus_selection *selection)
{
    uint32_t n = selection->evidence.resolution;
    uint32_t factor = (PICTURE_SIDE + n - 1) / n;
    uint32_t side = factor * n;
    struct font *font = NULL;
    struct draw_list *panel = NULL;
    conus_image *picture = NULL;
    conus_status status = font_create(&font);
    status = status == CONUS_ERROR_UNSUPPORTED ? CONUS_OK : status;
    status = status ? status : image_create_listed(&picture, side + (font ? LEGEND_WIDTH : 0), side);
    status = status ? status : draw_list_create(&panel, LEGEND_WIDTH, side);
    if (!status) {
        draw_pixels(picture, selection, factor);
    }
    if (!status && font) {
        status = draw_legend(panel, selection, font);
        draw_take(picture->list, panel, (double[]){side, 0});
    }
    status = status ? status : image_paint(picture);
    draw_list_destroy(panel);
    font_destroy(font);
    if (status) {
        conus_image_destroy(picture);
        return status;
    }
    *out = picture;
    return CONUS_OK;
}

conus_status conus_selection_image(conus_image **out, const conus_selection *selection)
{
    conus_image *image = NULL;
    conus_image *picture = NULL;
    if (selection->region.shape == REGION_BALL) {
        return fail(CONUS_ERROR_ARGUMENT, "image of a ball: it has no pixels, a cone is needed");
    }
    conus_status status = image_create(&image, selection->evidence.resolution, selection->evidence.resolution);
    status = status ? status : add_channels(image, selection);
    status = status ? status : add_attributes(image, selection);
    status = status ? status : create_picture(&picture, selection);
    if (!status) {
        status = image_srgb_bytes(&image->png_rgba, picture);
        image->png_width = picture->width;
        image->png_height = picture->height;
    }
    conus_image_destroy(picture);
    if (status) {
        conus_image_destroy(image);
        return status;
    }
    *out = image;
    return CONUS_OK;
}
