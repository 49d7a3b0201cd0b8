/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the font of the system, measures text and draws it. */
#include "render/flat/font.h"

#include "base/library.h"
#include "base/memory.h"
#include "render/flat/draw.h"
#include "render/image/shapes.h"

#include <fontconfig/fontconfig.h>
#include <ft2build.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include FT_FREETYPE_H
#include FT_MODULE_H
#include FT_OUTLINE_H

#define ELLIPSIS "\xe2\x80\xa6"

/* clang-format off */
#define FREETYPE_FUNCTIONS(F)                                                                                          \
    F(FT_, Add_Default_Modules) F(FT_, Done_Library) F(FT_, Get_Char_Index) F(FT_, Load_Glyph) F(FT_, New_Face)        \
    F(FT_, New_Library) F(FT_, Outline_Translate) F(FT_, Render_Glyph) F(FT_, Set_Char_Size)
#define FONTCONFIG_FUNCTIONS(F)                                                                                        \
    F(Fc, ConfigDestroy) F(Fc, ConfigSubstitute) F(Fc, DefaultSubstitute) F(Fc, FontMatch)                             \
    F(Fc, InitLoadConfigAndFonts) F(Fc, NameParse) F(Fc, PatternDestroy) F(Fc, PatternGetInteger)                      \
    F(Fc, PatternGetString)
/* clang-format on */

static struct {
    FREETYPE_FUNCTIONS(LIBRARY_MEMBER)
} freetype;
static struct {
    FONTCONFIG_FUNCTIONS(LIBRARY_MEMBER)
} fontconfig;

struct font {
    struct FT_MemoryRec_ memory;
    FT_Library library;
    FT_Face face;
};

static void *allocate(FT_Memory memory, long size)
{
    (void)memory;
    return memory_raw((size_t)size, 1);
}

static void *resize(FT_Memory memory, long old_size, long size, void *block)
{
    (void)memory;
    (void)old_size;
    return memory_resize(block, (size_t)size, 1);
}

static void release(FT_Memory memory, void *block)
{
    (void)memory;
    memory_free(block);
}

static conus_status fail_font(FT_Error error, const char *what)
{
    return FT_ERROR_BASE(error) == FT_Err_Out_Of_Memory
               ? fail(CONUS_ERROR_MEMORY, "no memory for a font")
               : fail(CONUS_ERROR_UNSUPPORTED, "%s: FreeType error %d", what, error);
}

static conus_status open_match(struct font *font, FcPattern *match)
{
    FcChar8 *path = NULL;
    int index = 0;
    if (!match || fontconfig.PatternGetString(match, FC_FILE, 0, &path) != FcResultMatch) {
        return fail(CONUS_ERROR_UNSUPPORTED, "no text in pictures: no scalable font is installed (see fc-match sans)");
    }
    fontconfig.PatternGetInteger(match, FC_INDEX, 0, &index);
    const char *file = (const char *)path;
    FT_Error error = freetype.New_Library(&font->memory, &font->library);
    if (!error) {
        freetype.Add_Default_Modules(font->library);
        error = freetype.New_Face(font->library, file, index, &font->face);
    }
    if (error) {
        return fail_font(error, file);
    }
    return FT_IS_SCALABLE(font->face) ? CONUS_OK : fail(CONUS_ERROR_UNSUPPORTED, "%s: not a scalable font", file);
}

static conus_status open_sans(struct font *font)
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
    conus_status status = open_match(font, match);
    if (match) {
        fontconfig.PatternDestroy(match);
    }
    if (pattern) {
        fontconfig.PatternDestroy(pattern);
    }
    fontconfig.ConfigDestroy(config);
    return status;
}

conus_status font_create(struct font **out)
{
    struct font *font = memory_zeroed(1, sizeof *font);
    if (!font) {
        return CONUS_ERROR_MEMORY;
    }
    font->memory = (struct FT_MemoryRec_){NULL, allocate, release, resize};
    conus_status status =
        library_load(&freetype, FREETYPE_FUNCTIONS(LIBRARY_NAME), CONUS_FREETYPE_FILE, "libfreetype6");
    status =
        status ? status
               : library_load(&fontconfig, FONTCONFIG_FUNCTIONS(LIBRARY_NAME), CONUS_FONTCONFIG_FILE, "libfontconfig1");
    status = status ? status : open_sans(font);
    if (status) {
        font_destroy(font);
        return status;
    }
    *out = font;
    return CONUS_OK;
}

void font_destroy(struct font *font)
{
    if (!font) {
        return;
    }
    if (font->library) {
        freetype.Done_Library(font->library); /* and its faces */
    }
    memory_free(font);
}

/* The character at *text, which moves on; U+FFFD for a byte that starts none. */
static FT_ULong next_character(const unsigned char **text)
{
    unsigned first = *(*text)++;
    int more = first >= 0xf0 && first < 0xf8 ? 3 : first >= 0xe0 && first < 0xf0 ? 2 : first >= 0xc2 && first < 0xe0;
    if (first < 0x80 || !more) {
        return first < 0x80 ? first : 0xfffd;
    }
    FT_ULong character = first & (0x3fU >> more);
    for (int i = 0; i < more; i++) {
        if (((*text)[i] & 0xc0) != 0x80) {
            return 0xfffd;
        }
        character = character << 6 | ((*text)[i] & 0x3f);
    }
    *text += more;
    return character;
}

/* Light hinting snaps heights to pixels and leaves widths alone. */
static FT_Error load_glyph(struct font *font, double size, FT_ULong character)
{
    FT_Error error = freetype.Set_Char_Size(font->face, 0, lrint(size * 64), 72, 72);
    return error ? error
                 : freetype.Load_Glyph(font->face, freetype.Get_Char_Index(font->face, character),
                                       FT_LOAD_TARGET_LIGHT | FT_LOAD_NO_BITMAP);
}

static double advance(const struct font *font)
{
    return (double)font->face->glyph->linearHoriAdvance / 65536;
}

double font_width(struct font *font, double size, const char *text)
{
    double width = 0;
    for (const unsigned char *rest = (const unsigned char *)text; *rest;) {
        if (load_glyph(font, size, next_character(&rest)) == 0) {
            width += advance(font);
        }
    }
    return width;
}

/* Lays the glyph in the face's slot over the image, its origin at pixel (x, y). */
static void paint_glyph(const struct font *font, conus_image *image, long x, long y, const float rgba[4])
{
    const struct image_rgba planes = image_rgba(image);
    const FT_Bitmap *bitmap = &font->face->glyph->bitmap;
    long left = x + font->face->glyph->bitmap_left;
    long top = y - font->face->glyph->bitmap_top;
    for (long j = 0; j < (long)bitmap->rows; j++) {
        for (long i = 0; i < (long)bitmap->width; i++) {
            uint8_t coverage = bitmap->buffer[j * bitmap->pitch + i];
            bool inside =
                left + i >= 0 && left + i < (long)image->width && top + j >= 0 && top + j < (long)image->height;
            if (inside && coverage) {
                draw_over(&planes, (size_t)(top + j) * image->width + (size_t)(left + i), rgba, (float)coverage / 255);
            }
        }
    }
}

conus_status font_draw(struct font *font, conus_image *image, const double at[2], double size, const float rgba[4],
                       const char *text)
{
    if (image->shapes) {
        const struct image_shape shape = {.kind = SHAPE_TEXT,
                                          .from = {at[0], at[1]},
                                          .width = size,
                                          .length = font_width(font, size, text),
                                          .rgba = {rgba[0], rgba[1], rgba[2], rgba[3]},
                                          .text = (char *)text};
        snprintf(image->shapes->family, sizeof image->shapes->family, "%s", font->face->family_name);
        shapes_add(image->shapes, &shape);
        return CONUS_OK;
    }
    double x = at[0];
    for (const unsigned char *rest = (const unsigned char *)text; *rest;) {
        FT_Error error = load_glyph(font, size, next_character(&rest));
        if (!error) {
            freetype.Outline_Translate(&font->face->glyph->outline, lrint((x - floor(x)) * 64), 0);
            error = freetype.Render_Glyph(font->face->glyph, FT_RENDER_MODE_NORMAL);
        }
        if (error) {
            return fail_font(error, "text in a picture");
        }
        paint_glyph(font, image, lrint(floor(x)), lrint(at[1]), rgba);
        x += advance(font);
    }
    return CONUS_OK;
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
