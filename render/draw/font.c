/* SPDX-License-Identifier: BSD-3-Clause */
/* Opens the font and measures text. */
#include "render/draw/draw.h"

#include "base/formats/packed.h"
#include "base/library.h"
#include "base/memory.h"
#include "base/text.h"

#include <cairo-ft.h>
#include <math.h>
#include <string.h>

#define ELLIPSIS "\xe2\x80\xa6"

enum { FONT_LIMIT = 1 << 20 }; /* bytes, unpacked */

/* clang-format off */
#define FREETYPE_FUNCTIONS(F) F(FT_, Done_FreeType) F(FT_, Init_FreeType) F(FT_, New_Memory_Face)
#define CAIRO_FUNCTIONS(F)                                                                                             \
    F(cairo_, font_face_destroy) F(cairo_, font_face_set_user_data) F(cairo_, font_options_create)                     \
    F(cairo_, font_options_destroy) F(cairo_, font_options_set_hint_metrics)                                           \
    F(cairo_, font_options_set_hint_style) F(cairo_, ft_font_face_create_for_ft_face) F(cairo_, scaled_font_create)    \
    F(cairo_, scaled_font_destroy) F(cairo_, scaled_font_text_extents) F(cairo_, set_font_face)                        \
    F(cairo_, set_font_options)
/* clang-format on */

LIBRARY_TABLE(freetype, FREETYPE_FUNCTIONS);
LIBRARY_TABLE(cairo, CAIRO_FUNCTIONS);

struct font {
    cairo_font_face_t *face; /* which holds FreeType's */
    cairo_font_options_t *options;
};

/* What a face is of. */
struct font_file {
    FT_Library library;
    struct bytes bytes;
};

/* Ends FreeType once cairo, which keeps faces for a while, has let go. */
static void release_file(void *user)
{
    struct font_file *file = user;
    if (file && file->library) {
        freetype.Done_FreeType(file->library); /* and its faces */
    }
    memory_free(file ? file->bytes.data : NULL);
    memory_free(file);
}

static conus_status open_face(struct font *font)
{
    static const cairo_user_data_key_t owned;
    FT_Face face = NULL;
    struct font_file *file = memory_zeroed(1, sizeof *file);
    bool has_face = file && !gzip_unpack_all(&file->bytes, font_sans, font_sans_size, FONT_LIMIT) &&
                    !freetype.Init_FreeType(&file->library) &&
                    !freetype.New_Memory_Face(file->library, file->bytes.data, (FT_Long)file->bytes.size, 0, &face);
    font->face = has_face ? cairo.ft_font_face_create_for_ft_face(face, 0) : NULL;
    if (!has_face || cairo.font_face_set_user_data(font->face, &owned, file, release_file)) {
        cairo.font_face_destroy(font->face);
        font->face = NULL;
        release_file(file);
        return fail(CONUS_ERROR_MEMORY, "no memory for a font");
    }
    return CONUS_OK;
}

conus_status font_create(struct font **out)
{
    conus_status status =
        library_load(&freetype, FREETYPE_FUNCTIONS(LIBRARY_NAME), CONUS_FREETYPE_FILE, "libfreetype6");
    status = status ? status : library_load(&cairo, CAIRO_FUNCTIONS(LIBRARY_NAME), CONUS_CAIRO_FILE, "libcairo2");
    if (status) {
        return status;
    }
    struct font *font = memory_zeroed(1, sizeof *font);
    if (!font) {
        return CONUS_ERROR_MEMORY;
    }
    font->options = cairo.font_options_create();
    cairo.font_options_set_hint_metrics(font->options, CAIRO_HINT_METRICS_OFF); /* widths are the same everywhere */
    cairo.font_options_set_hint_style(font->options, CAIRO_HINT_STYLE_SLIGHT);
    status = open_face(font);
    if (status) {
        font_destroy(font);
        return status;
    }
    *out = font;
    return CONUS_OK;
}

void font_destroy(struct font *font)
{
    if (font) {
        cairo.font_face_destroy(font->face);
        cairo.font_options_destroy(font->options);
    }
    memory_free(font);
}

void font_select(const struct font *font, cairo_t *to, bool in_pixels)
{
    cairo.font_options_set_hint_style(font->options, in_pixels ? CAIRO_HINT_STYLE_SLIGHT : CAIRO_HINT_STYLE_NONE);
    cairo.set_font_face(to, font->face);
    cairo.set_font_options(to, font->options);
}

double font_width(struct font *font, double size, const char *text)
{
    const double whole = rint(size * 64) / 64; /* as FreeType has sizes */
    const cairo_matrix_t letters = {.xx = whole, .yy = whole};
    const cairo_matrix_t pixels = {.xx = 1, .yy = 1};
    cairo_text_extents_t extents = {0};
    char *plain = text_to_utf8(text_from(text));
    cairo_scaled_font_t *scaled = cairo.scaled_font_create(font->face, &letters, &pixels, font->options);
    if (plain) {
        cairo.scaled_font_text_extents(scaled, plain, &extents);
    }
    cairo.scaled_font_destroy(scaled);
    memory_free(plain);
    return extents.x_advance;
}

void draw_text(struct draw_list *list, struct font *font, const double at[2], double size, const float rgba[4],
               const char *text)
{
    double point[1][2] = {{at[0], at[1]}};
    struct draw_item item = {.kind = DRAW_TEXT,
                             .width = size,
                             .length = font_width(font, size, text),
                             .text = (char *)text,
                             .points = point,
                             .count = 1};
    memcpy(item.rgba, rgba, sizeof item.rgba);
    draw_item(list, &item);
}

void font_shorten(char *out, size_t out_size, struct font *font, double size, const char *text, double limit)
{
    size_t length = strlen(text);
    if (length < out_size && font_width(font, size, text) <= limit) {
        memcpy(out, text, length + 1);
        return;
    }
    length = length < out_size - sizeof ELLIPSIS ? length : out_size - sizeof ELLIPSIS;
    memcpy(out, text, length);
    do {
        while (length && ((unsigned char)text[length] & 0xc0) == 0x80) {
            length--; /* back to where a character starts */
        }
        memcpy(out + length, ELLIPSIS, sizeof ELLIPSIS);
    } while (font_width(font, size, out) > limit && length-- > 0);
    if (font_width(font, size, out) > limit) {
        out[0] = '\0';
    }
}
