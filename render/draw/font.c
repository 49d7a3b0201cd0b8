/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the font of the system and measures text. */
#include "render/draw/font.h"

#include "base/library.h"
#include "base/memory.h"
#include "base/text.h"

#include <cairo-ft.h>
#include <fontconfig/fontconfig.h>
#include <math.h>
#include <string.h>

#define ELLIPSIS "\xe2\x80\xa6"

/* clang-format off */
#define FREETYPE_FUNCTIONS(F) F(FT_, Done_FreeType) F(FT_, Init_FreeType) F(FT_, New_Face)
#define CAIRO_FUNCTIONS(F)                                                                                             \
    F(cairo_, font_face_destroy) F(cairo_, font_face_set_user_data) F(cairo_, font_options_create)                     \
    F(cairo_, font_options_destroy) F(cairo_, font_options_set_hint_metrics)                                           \
    F(cairo_, font_options_set_hint_style) F(cairo_, ft_font_face_create_for_ft_face) F(cairo_, scaled_font_create)    \
    F(cairo_, scaled_font_destroy) F(cairo_, scaled_font_text_extents) F(cairo_, set_font_face)                        \
    F(cairo_, set_font_options)
#define FONTCONFIG_FUNCTIONS(F)                                                                                        \
    F(Fc, ConfigDestroy) F(Fc, ConfigSubstitute) F(Fc, DefaultSubstitute) F(Fc, FontMatch)                             \
    F(Fc, InitLoadConfigAndFonts) F(Fc, NameParse) F(Fc, PatternDestroy) F(Fc, PatternGetInteger)                      \
    F(Fc, PatternGetString)
/* clang-format on */

static struct {
    FREETYPE_FUNCTIONS(LIBRARY_MEMBER)
} freetype;
static struct {
    CAIRO_FUNCTIONS(LIBRARY_MEMBER)
} cairo;
static struct {
    FONTCONFIG_FUNCTIONS(LIBRARY_MEMBER)
} fontconfig;

struct font {
    cairo_font_face_t *face; /* which holds FreeType's */
    cairo_font_options_t *options;
};

/* Ends FreeType once cairo, which keeps faces for a while, has let go. */
static void release_library(void *library)
{
    freetype.Done_FreeType(library); /* and its faces */
}

static conus_status open_match(FT_Library library, FT_Face *face, FcPattern *match)
{
    FcChar8 *path = NULL;
    int index = 0;
    if (!match || fontconfig.PatternGetString(match, FC_FILE, 0, &path) != FcResultMatch) {
        return fail(CONUS_ERROR_UNSUPPORTED, "no text in pictures: no scalable font is installed (see fc-match sans)");
    }
    fontconfig.PatternGetInteger(match, FC_INDEX, 0, &index);
    const char *file = (const char *)path;
    FT_Error error = freetype.New_Face(library, file, index, face);
    return error ? fail(CONUS_ERROR_UNSUPPORTED, "%s: FreeType error %d", file, error) : CONUS_OK;
}

static conus_status open_sans(FT_Library library, FT_Face *face)
{
    FcConfig *config = fontconfig.InitLoadConfigAndFonts(); /* our own, so that it can be destroyed */
    if (!config) {
        return fail(CONUS_ERROR_UNSUPPORTED, "no text in pictures: fontconfig cannot read its settings");
    }
    FcPattern *pattern = fontconfig.NameParse((const FcChar8 *)"sans:scalable=true");
    FcPattern *match = NULL;
    if (pattern && fontconfig.ConfigSubstitute(config, pattern, FcMatchPattern)) {
        FcResult result;
        fontconfig.DefaultSubstitute(pattern);
        match = fontconfig.FontMatch(config, pattern, &result);
    }
    conus_status status = open_match(library, face, match);
    if (match) {
        fontconfig.PatternDestroy(match);
    }
    if (pattern) {
        fontconfig.PatternDestroy(pattern);
    }
    fontconfig.ConfigDestroy(config);
    return status;
}

static conus_status open_face(struct font *font)
{
    static const cairo_user_data_key_t owned;
    FT_Library library = NULL;
    FT_Face face = NULL;
    if (freetype.Init_FreeType(&library)) {
        return fail(CONUS_ERROR_MEMORY, "no memory for a font");
    }
    conus_status status = open_sans(library, &face);
    if (status) {
        freetype.Done_FreeType(library);
        return status;
    }
    font->face = cairo.ft_font_face_create_for_ft_face(face, 0);
    if (cairo.font_face_set_user_data(font->face, &owned, library, release_library)) {
        cairo.font_face_destroy(font->face);
        font->face = NULL;
        freetype.Done_FreeType(library);
        return fail(CONUS_ERROR_MEMORY, "no memory for a font");
    }
    font->options = cairo.font_options_create();
    cairo.font_options_set_hint_style(font->options, CAIRO_HINT_STYLE_SLIGHT);
    cairo.font_options_set_hint_metrics(font->options, CAIRO_HINT_METRICS_OFF); /* widths are the same everywhere */
    return CONUS_OK;
}

conus_status font_create(struct font **out)
{
    struct font *font = memory_zeroed(1, sizeof *font);
    if (!font) {
        return CONUS_ERROR_MEMORY;
    }
    conus_status status =
        library_load(&freetype, FREETYPE_FUNCTIONS(LIBRARY_NAME), CONUS_FREETYPE_FILE, "libfreetype6");
    status =
        status ? status
               : library_load(&fontconfig, FONTCONFIG_FUNCTIONS(LIBRARY_NAME), CONUS_FONTCONFIG_FILE, "libfontconfig1");
    status = status ? status : library_load(&cairo, CAIRO_FUNCTIONS(LIBRARY_NAME), CONUS_CAIRO_FILE, "libcairo2");
    status = status ? status : open_face(font);
    if (status) {
        font_destroy(font);
        return status;
    }
    *out = font;
    return CONUS_OK;
}

void font_destroy(struct font *font)
{
    if (font && font->face) {
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
