/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses VTK's legacy format: polygons and strips of triangles, and lines for who wants them. */
#include "loaders/surfaces/foreign/foreign.h"

#include "loaders/surfaces/foreign/vtk_stream.h"

static conus_status read_points(struct vtk *vtk)
{
    const struct vtk_type *type = NULL;
    size_t count = 0;
    conus_status status = vtk->has_points ? fail(CONUS_ERROR_DATA, "POINTS: twice") : CONUS_OK;
    status = status ? status : words_count(&count, &vtk->words, 3, "POINTS");
    status = status ? status : vtk_need_type(&type, vtk);
    status = status ? status : vtk_end_line(vtk);
    if (!status && type->bits < 8) {
        status = fail(CONUS_ERROR_UNSUPPORTED, "POINTS: of type bit");
    }
    size_t least = status || vtk->is_text ? 6 : 3 * type->bits / 8; /* in text a digit and a space each */
    if (!status && count > vtk->words.rest.size / least + 1) {
        status = fail(CONUS_ERROR_DATA, "POINTS: %zu, more than the %zu bytes that follow can hold", count,
                      vtk->words.rest.size);
    }
    status = status ? status : foreign_reserve_vertices(vtk->mesh, count);
    for (size_t i = 0; !status && i < count; i++) {
        float position[3] = {0};
        for (int a = 0; !status && a < 3; a++) {
            status = vtk_next_number(&position[a], vtk, type, "POINTS");
        }
        status = status ? status : foreign_add_vertex(vtk->mesh, position);
    }
    vtk->has_points = true;
    return status;
}

enum cells { CELLS_VERTICES, CELLS_LINES, CELLS_POLYGONS, CELLS_STRIPS };

static conus_status end_cell(struct foreign_mesh *mesh, enum cells cells)
{
    if (mesh->lines) {
        mesh->lines->before += cells == CELLS_VERTICES;
        mesh->lines->behind += cells > CELLS_LINES;
    }
    return cells == CELLS_POLYGONS ? foreign_end_polygon(mesh)
           : cells == CELLS_STRIPS ? foreign_end_strip(mesh)
           : cells == CELLS_LINES  ? foreign_end_line(mesh)
                                   : CONUS_OK;
}

/* Corners of lines that nobody wants are passed over unseen. */
static bool are_wanted(const struct foreign_mesh *mesh, enum cells cells)
{
    return cells > CELLS_LINES || (cells == CELLS_LINES && mesh->lines);
}

static conus_status take_corners(struct vtk *vtk, int64_t count, const struct vtk_type *type, enum cells cells,
                                 const char *what)
{
    conus_status status = CONUS_OK;
    for (int64_t k = 0; !status && k < count; k++) {
        int64_t index;
        status = vtk_next_whole(&index, vtk, type, what);
        if (!status && are_wanted(vtk->mesh, cells)) {
            status = foreign_add_corner(vtk->mesh, index);
        }
    }
    return status ? status : end_cell(vtk->mesh, cells);
}

/* `count` cells, each as the number of its corners and the corners; `size` numbers in all. */
static conus_status read_counted(struct vtk *vtk, size_t count, size_t size, enum cells cells, const char *what)
{
    static const struct vtk_type number = {"int", 32, VTK_INTEGER};
    conus_status status = vtk_end_line(vtk);
    for (size_t i = 0; !status && i < count; i++) {
        int64_t corners;
        status = vtk_next_whole(&corners, vtk, &number, what);
        if (!status && (size == 0 || corners < 0 || (uint64_t)corners > size - 1)) {
            status = fail(CONUS_ERROR_DATA, "%s: cell %zu has %lld corners, %zu numbers are left", what, i,
                          (long long)corners, size);
        }
        status = status ? status : take_corners(vtk, corners, &number, cells, what);
        size -= status ? 0 : 1 + (size_t)corners;
    }
    if (!status && size) {
        status = fail(CONUS_ERROR_DATA, "%s: %zu numbers more than its %zu cells have", what, size, count);
    }
    return status;
}

static conus_status begin_array(const struct vtk_type **type, struct vtk *vtk, const char *name)
{
    struct text word;
    if (!words_next(&vtk->words, &word) || !text_equal_ignoring_case(word, name)) {
        return words_fail(&vtk->words, word, name);
    }
    conus_status status = vtk_need_type(type, vtk);
    if (!status && ((*type)->bits < 8 || (*type)->kind == VTK_REAL)) {
        status = fail(CONUS_ERROR_DATA, "%s: of type %s, a whole number is needed", name, (*type)->name);
    }
    return status ? status : vtk_end_line(vtk);
}

/* Version 5: `count` offsets, of which the first is 0 and the last `size`, then `size` corners. Both are read side by
 * side. */
static conus_status read_offset_cells(struct vtk *vtk, size_t count, size_t size, enum cells cells, const char *what)
{
    const struct vtk_type *offset_type = NULL;
    const struct vtk_type *corner_type = NULL;
    int64_t offset = 0;
    conus_status status = begin_array(&offset_type, vtk, "OFFSETS");
    struct vtk offsets = *vtk;
    for (size_t i = 0; !status && i < count; i++) { /* to where the corners begin */
        int64_t next;
        status = vtk_next_whole(&next, vtk, offset_type, "OFFSETS");
        if (!status && (next < offset || (uint64_t)next > size || (i == 0 && next) ||
                        (i + 1 == count && (uint64_t)next != size))) {
            status = fail(CONUS_ERROR_DATA, "OFFSETS: number %zu is %lld, they rise from 0 to %zu", i, (long long)next,
                          size);
        }
        offset = status ? 0 : next;
    }
    status = status ? status : begin_array(&corner_type, vtk, "CONNECTIVITY");
    offset = 0;
    for (size_t i = 0; !status && i < count; i++) {
        int64_t next;
        status = vtk_next_whole(&next, &offsets, offset_type, "OFFSETS");
        if (!status && i > 0) {
            status = take_corners(vtk, next - offset, corner_type, cells, what);
        }
        offset = status ? 0 : next;
    }
    return status;
}

static conus_status read_cells(struct vtk *vtk, enum cells cells, const char *what)
{
    size_t count = 0;
    size_t size = 0;
    conus_status status = words_count(&count, &vtk->words, 1, what);
    status = status ? status : words_count(&size, &vtk->words, 1, what);
    if (status || !vtk->has_offsets) {
        return status ? status : read_counted(vtk, count, size, cells, what);
    }
    return count  ? read_offset_cells(vtk, count, size, cells, what)
           : size ? fail(CONUS_ERROR_DATA, "%s: %zu corners without a cell", what, size)
                  : CONUS_OK;
}

/* What belongs to points and cells, from there to the end, is read for who wants lines. */
static conus_status read_section(struct vtk *vtk, bool *done)
{
    static const struct {
        const char *word;
        enum cells cells;
    } sections[] = {{"VERTICES", CELLS_VERTICES},
                    {"LINES", CELLS_LINES},
                    {"POLYGONS", CELLS_POLYGONS},
                    {"TRIANGLE_STRIPS", CELLS_STRIPS}};
    struct text word;
    vtk->place = words_take(&vtk->words, "POINT_DATA")  ? VTK_OF_POINTS
                 : words_take(&vtk->words, "CELL_DATA") ? VTK_OF_CELLS
                                                        : VTK_OF_NOTHING;
    *done = vtk->place != VTK_OF_NOTHING;
    if (*done) {
        return vtk->mesh->lines ? vtk_read_numbers(vtk) : CONUS_OK;
    }
    for (size_t i = 0; i < sizeof sections / sizeof sections[0]; i++) {
        if (words_take(&vtk->words, sections[i].word)) {
            return read_cells(vtk, sections[i].cells, sections[i].word);
        }
    }
    if (words_take(&vtk->words, "POINTS")) {
        return read_points(vtk);
    }
    if (words_take(&vtk->words, "FIELD")) {
        return vtk_take_field(vtk);
    }
    if (words_take(&vtk->words, "METADATA")) {
        return vtk_skip_metadata(vtk);
    }
    *done = !words_next(&vtk->words, &word);
    return *done ? CONUS_OK : words_fail(&vtk->words, word, "POINTS, POLYGONS, TRIANGLE_STRIPS or another section");
}

static conus_status read_dataset(struct vtk *vtk)
{
    struct text word;
    conus_status status = CONUS_OK;
    if (words_take(&vtk->words, "FIELD")) {
        status = vtk_take_field(vtk);
    }
    if (!status && (!words_next(&vtk->words, &word) || !text_equal_ignoring_case(word, "DATASET"))) {
        status = words_fail(&vtk->words, word, "DATASET");
    }
    if (!status && !words_take(&vtk->words, "POLYDATA")) {
        (void)words_next(&vtk->words, &word);
        status = fail(CONUS_ERROR_UNSUPPORTED, "DATASET: found \"%.*s\", only POLYDATA is a surface or lines",
                      (int)(word.size < 60 ? word.size : 60), word.data);
    }
    return status;
}

static conus_status read_header(struct vtk *vtk)
{
    static const char magic[] = "# vtk DataFile Version ";
    struct text line = {0};
    double version = 0;
    bool there = words_line(&vtk->words, &line) && text_starts(line, magic);
    struct text number = there ? text_trim((struct text){line.data + sizeof magic - 1, line.size - (sizeof magic - 1)})
                               : (struct text){0};
    if (!text_to_double(number, &version) || !(version >= 1 && version < 6)) {
        return fail(CONUS_ERROR_UNSUPPORTED, "header: version \"%.*s\", allowed are 1.0 to 5.1",
                    (int)(number.size < 60 ? number.size : 60), number.size ? number.data : "");
    }
    vtk->has_offsets = version >= 5;
    if (words_line(&vtk->words, &line)) {
        vtk->mesh->space = foreign_space_in(line);
    }
    vtk->is_text = words_take(&vtk->words, "ASCII");
    if (!vtk->is_text && !words_take(&vtk->words, "BINARY")) {
        (void)words_next(&vtk->words, &line);
        return words_fail(&vtk->words, line, "ASCII or BINARY");
    }
    return read_dataset(vtk);
}

conus_status vtk_parse(struct foreign_mesh *out, const uint8_t *data, size_t size)
{
    struct vtk vtk = {.words = {.rest = {(const char *)data, size}, .line = 1}, .mesh = out};
    bool done = false;
    conus_status status = read_header(&vtk);
    while (!status && !done) {
        status = read_section(&vtk, &done);
    }
    return status;
}
