/* SPDX-License-Identifier: BSD-3-Clause */
/* NRRD volumes against the closed form of their placement, and files of every encoding, with every field changed. */
#include "loaders/volumes/text/text_volume.h"

#include "base/memory.h"
#include "builders/bent_text.h"
#include "builders/nifti_builder.h"
#include "label_list.h"
#include "loaders/volumes/volume_file.h"
#include "loaders/volumes/volume_values.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

/* 2 x 3 x 2 voxels: i to the left by 2 mm, j to the back by 3 mm, k up by 4 mm in LPS; first voxel at LPS (10, 20, 30).
 */
static const char plain[] = "NRRD0004\n# a comment\ntype: uchar\ndimension: 3\nspace: left-posterior-superior\n"
                            "sizes: 2 3 2\nspace directions: (2,0,0) (0,3,0) (0,0,4)\nkinds: domain domain domain\n"
                            "endian: little\nencoding: raw\nspace origin: (10,20,30)\n\n";

static void append_counting(struct buffer *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        append_ordered(bytes, i, 1, false);
    }
}

static conus_status parse_bent(struct text_volume *out, const char *text, const char *from, const char *to)
{
    struct buffer bytes = {0};
    struct notes notes = {0};
    append_bent(&bytes, text, from, to);
    conus_status status = parse_header(out, nrrd_parse, &bytes, &notes);
    buffer_finish(&bytes);
    notes_finish(&notes);
    return status;
}

static void check_labels(struct volume_file *file, size_t count, size_t first, size_t step)
{
    uint32_t *labels;
    assert_ok(label_list_read(&labels, file));
    for (size_t v = 0; v < count; v++) {
        assert_int_equal(labels[v], first + step * v);
    }
    memory_free(labels);
}

static void placement_follows_the_space(void **state)
{
    (void)state;
    const struct {
        const char *space;
        double x, y;
    } cases[] = {{"left-posterior-superior", -1, -1}, {"LPS", -1, -1},
                 {"left-anterior-superior", -1, 1},   {"las", -1, 1},
                 {"right-anterior-superior", 1, 1},   {"RAS", 1, 1}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct text_volume volume;
        assert_ok(parse_bent(&volume, plain, "left-posterior-superior", cases[i].space));
        const double wanted[16] = {2 * cases[i].x,  0,  0, 0, 0, 3 * cases[i].y, 0, 0, 0, 0, 4, 0, 10 * cases[i].x,
                                   20 * cases[i].y, 30, 1};
        for (int k = 0; k < 16; k++) {
            assert_near(volume.world_from_voxel[k], wanted[k], 1e-12);
        }
        end_header();
    }
}

static void units_scale_the_matrix(void **state)
{
    (void)state;
    struct text_volume volume;
    assert_ok(parse_bent(&volume, plain, "endian", "space units: \"um\" \"um\" \"um\"\nendian"));
    assert_near(volume.world_from_voxel[0], -0.002, 1e-12);
    assert_near(volume.world_from_voxel[14], 0.03, 1e-12);
    end_header();
}

static void a_grid_of_metres_is_noted(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    struct notes notes = {0};
    struct text_volume volume;
    append_bent(&bytes, plain, "(2,0,0)", "(501,0,0)");
    assert_ok(parse_header(&volume, nrrd_parse, &bytes, &notes));
    assert_int_equal(notes.count, 1);
    assert_non_null(strstr(notes.lines[0], "the grid is 1002 mm long: are they micrometres?"));
    end_header();
    notes_finish(&notes);
    buffer_finish(&bytes);
}

/* The Allen Institute's header of 200 um calls AP, DV and ML left, posterior and superior, and does not name
 * micrometres. The first voxel's centre is 100 um from the corner, to the right, backward and downward. With other
 * sizes, a unit or another origin the header is taken literally. */
static void the_ccf_is_placed_from_its_corner(void **state)
{
    (void)state;
    static const char allen[] = "NRRD0004\ntype: uchar\ndimension: 3\nspace: left-posterior-superior\n"
                                "sizes: 66 40 57\nspace directions: (200,0,0) (0,200,0) (0,0,200)\n"
                                "encoding: raw\nspace origin: (0,0,0)\n\n";
    static const double wanted[16] = {0, -0.2, 0, 0, 0, 0, -0.2, 0, 0.2, 0, 0, 0, 0.1, -0.1, -0.1, 1};
    static const char *const others[][2] = {{"66", "65"},
                                            {"(0,0,0)", "(0,0,1)"},
                                            {"(200,0,0)", "(0,0,200)"},
                                            {"encoding", "space units: \"um\" \"um\" \"um\"\nencoding"}};
    struct text_volume volume;
    assert_ok(parse_bent(&volume, allen, "66", "66"));
    for (int i = 0; i < 16; i++) {
        assert_near(volume.world_from_voxel[i], wanted[i], 1e-12);
    }
    end_header();
    /* the same grid with correct anatomical axes, but without the unit */
    assert_ok(parse_bent(&volume, allen, "(200,0,0) (0,200,0) (0,0,200)", "(0,200,0) (0,0,-200) (-200,0,0)"));
    for (int i = 0; i < 16; i++) {
        assert_near(volume.world_from_voxel[i], wanted[i], 1e-12);
    }
    end_header();
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        if (parse_bent(&volume, allen, others[i][0], others[i][1]) == CONUS_OK) {
            assert_int_equal(volume.world_from_voxel[9] == 0 && volume.world_from_voxel[8] == 0.2, false);
            end_header();
        }
    }
}

/* Every type in both byte orders, raw and packed; numbers and digits as text. Voxel v is v. */
static void append_voxels(struct buffer *bytes, char kind, size_t size, bool big)
{
    for (size_t v = 0; v < 12; v++) {
        double real = (double)v;
        uint64_t bits;
        memcpy(&bits, &real, sizeof bits);
        if (kind == 'f' && size == 4) {
            append_float(bytes, real, big);
        } else {
            append_ordered(bytes, kind == 'f' ? bits : v, size, big);
        }
    }
}

static void append_coded(struct buffer *bytes, const char *encoding, const struct buffer *voxels)
{
    if (strcmp(encoding, "gzip") == 0) {
        append_gzip(bytes, voxels->data, voxels->size);
    } else if (strcmp(encoding, "ascii") == 0) {
        buffer_text(bytes, "0 1 2 3\n4 5 6 7 8\r\n9 10 11 \n");
    } else if (strcmp(encoding, "hex") == 0) {
        for (size_t i = 0; i < voxels->size; i++) {
            buffer_format(bytes, i % 3 ? "%02x" : "%02X\n", (unsigned)(uint8_t)voxels->data[i]);
        }
    } else {
        buffer_append(bytes, voxels->data, voxels->size);
    }
}

static void voxels_of_every_type_and_encoding(void **state)
{
    (void)state;
    static const struct {
        const char *name, *datatype;
        char kind;
        size_t size;
    } types[] = {{"int8", "int8", 'i', 1},       {"unsigned char", "uint8", 'u', 1}, {"short", "int16", 'i', 2},
                 {"uint16_t", "uint16", 'u', 2}, {"int", "int32", 'i', 4},           {"unsigned int", "uint32", 'u', 4},
                 {"longlong", "int64", 'i', 8},  {"uint64", "uint64", 'u', 8},       {"float", "float32", 'f', 4},
                 {"double", "float64", 'f', 8}};
    static const char *const encodings[] = {"raw", "gzip", "ascii", "hex"};
    for (size_t i = 0; i < 10 * 4 * 2; i++) {
        struct buffer bytes = {0};
        struct buffer voxels = {0};
        struct volume_file file;
        struct notes notes = {0};
        char fields[100];
        bool big = i & 1;
        snprintf(fields, sizeof fields, "endian: %s\nencoding: %s\ntype: %s\n", big ? "big" : "little",
                 encodings[i / 2 % 4], types[i / 8].name);
        append_voxels(&voxels, types[i / 8].kind, types[i / 8].size, big);
        struct buffer text = {0};
        append_bent(&text, plain, "type: uchar\n", fields);
        append_bent(&bytes, text.data, "endian: little\nencoding: raw\n", "");
        append_coded(&bytes, encodings[i / 2 % 4], &voxels);
        assert_ok(volume_file_open(&file, write_bytes("x.nrrd", &bytes), 0, &notes));
        assert_string_equal(file.info.datatype, types[i / 8].datatype);
        assert_int_equal(notes.count, 0);
        check_labels(&file, 12, 0, 1);
        volume_file_finish(&file);
        buffer_finish(&text);
        buffer_finish(&voxels);
        buffer_finish(&bytes);
    }
}

/* 4-D: volumes one behind the other, or together, with a spacing of their own axis; alone and as a series. */
static void volumes_come_apart(void **state)
{
    (void)state;
    const struct {
        const char *sizes, *directions;
        size_t first, step;
    } cases[] = {{"sizes: 2 3 2 4", "(2,0,0) (0,3,0) (0,0,4) none", 12, 1},
                 {"sizes: 4 2 3 2", "none (2,0,0) (0,3,0) (0,0,4)", 1, 4}};
    for (size_t i = 0; i < 2; i++) {
        struct buffer bytes = {0};
        struct buffer text = {0};
        struct volume_file file;
        struct notes notes = {0};
        char head[120];
        snprintf(head, sizeof head, "%s\nspace directions: %s\n", cases[i].sizes, cases[i].directions);
        append_bent(&text, plain, "dimension: 3", i ? "dimension: 4\nspacings: 0.7 2 3 4" : "dimension: 4");
        append_bent(&bytes, text.data,
                    "sizes: 2 3 2\nspace directions: (2,0,0) (0,3,0) (0,0,4)\nkinds: domain domain domain\n", head);
        append_counting(&bytes, 48);
        const char *path = write_bytes("four.nrrd", &bytes);
        assert_fails(volume_file_open(&file, path, 0, &notes), CONUS_ERROR_ARGUMENT);
        assert_said("volume: the file has 4, choose one");
        char chosen[300];
        snprintf(chosen, sizeof chosen, "%s,volume=3,volume=2", path);
        assert_fails(volume_file_open(&file, chosen, 0, &notes), CONUS_ERROR_ARGUMENT);
        assert_said("volume is given twice");
        snprintf(chosen, sizeof chosen, "%s,volume=2", path);
        assert_ok(volume_file_open(&file, chosen, 0, &notes));
        assert_near(file.info.world_from_voxel[0], -2, 0);
        assert_int_equal(file.info.dim[1], 3);
        check_labels(&file, 12, 2 * cases[i].first, cases[i].step);
        volume_file_finish(&file);
        assert_ok(volume_file_open_series(&file, path, &(conus_load_options){.max_memory = 0}, &notes));
        assert_non_null(file.series.data);
        for (size_t k = 0; k < 4; k++) {
            assert_ok(volume_file_select(&file, k));
            check_labels(&file, 12, k * cases[i].first, cases[i].step);
        }
        volume_file_finish(&file);
        buffer_finish(&bytes);
        buffer_finish(&text);
    }
}

static conus_status open_detached(struct volume_file *file, const char *fields, struct notes *notes)
{
    struct buffer bytes = {0};
    append_bent(&bytes, plain, "encoding: raw\n", fields);
    bytes.size--; /* no empty line: the end will do */
    conus_status status = volume_file_open(file, write_bytes("x.nhdr", &bytes), 0, notes);
    buffer_finish(&bytes);
    return status;
}

static void write_raw(const char *name, size_t skip, bool packed)
{
    struct buffer bytes = {0};
    for (size_t i = 0; i < skip; i++) {
        buffer_text(&bytes, "\n");
    }
    append_counting(&bytes, 12);
    packed ? write_packed(name, &bytes) : write_bytes(name, &bytes);
    buffer_finish(&bytes);
}

static void detached_voxels_are_found(void **state)
{
    (void)state;
    static const char *const good[] = {"encoding: raw\ndata file: three.raw\nbyte skip: 3\n",
                                       "encoding: raw\ndatafile: ./three.raw\nlineskip: 3\n",
                                       "encoding: raw\ndata file: three.raw\nline skip: 1\nbyteskip: 2\n",
                                       "encoding: raw\ndata file: three.raw\nbyte skip: -1\n",
                                       "encoding: gzip\ndata file: three.raw.gz\nbyte skip: 3\n"};
    write_raw("three.raw", 3, false);
    write_raw("three.raw.gz", 3, true);
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
        struct volume_file file;
        struct notes notes = {0};
        assert_ok(open_detached(&file, good[i], &notes));
        assert_int_equal(notes.count, 0);
        assert_non_null(strstr(file.path, "x.nhdr"));
        check_labels(&file, 12, 0, 1);
        volume_file_finish(&file);
    }
}

static void detached_voxels_that_are_not_right(void **state)
{
    (void)state;
    static const struct {
        const char *fields, *part;
    } bad[] = {
        {"encoding: raw\ndata file: none.raw\n", "x.nhdr: the file of the voxels is missing: "},
        {"encoding: raw\ndata file: /etc/passwd\n",
         "data file: found \"/etc/passwd\", allowed is the name of a file in"},
        {"encoding: raw\ndata file: a/../../b\n", "data file: found \"a/../../b\""},
        {"encoding: raw\ndata file:  \n", "data file: found \"\""},
        {"encoding: raw\ndata file: LIST\n", "data file: found \"LIST\", allowed is one file"},
        {"encoding: raw\ndata file: s%02d.raw 1 9 1\n", "data file: found \"s%02d.raw 1 9 1\""},
        {"encoding: raw\ndata file: three.raw\nbyte skip: 4\n", "three.raw: voxels: the file has 15 bytes"},
        {"encoding: raw\ndata file: three.raw\nline skip: 5\n", "line skip: found 5, the file has 4 lines"},
        {"encoding: raw\ndata file: three.raw\nbyte skip: -2\n", "byte skip: found \"-2\""},
        {"encoding: gzip\ndata file: three.raw\n", "three.raw: encoding: found gzip in the header"},
        {"encoding: gzip\ndata file: three.raw.gz\nbyte skip: -1\n", "which only the encoding raw allows"},
        {"encoding: gzip\ndata file: three.raw.gz\nbyte skip: 4000000\n", "gzip: "},
        {"encoding: raw\ndata file: three.raw\nbyte skip: 4611686018427387904\n", "byte skip: found"},
        {"encoding: ascii\ndata file: three.raw\nbyte skip: 99\n", "byte skip: found 99"},
    };
    write_raw("three.raw", 3, false);
    write_raw("three.raw.gz", 3, true);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct volume_file file;
        struct notes notes = {0};
        assert_true(open_detached(&file, bad[i].fields, &notes) != CONUS_OK);
        assert_said(bad[i].part);
    }
}

/* A header and its voxels both make the checksum; the second file alone does not. */
static void the_checksum_is_of_both_files(void **state)
{
    (void)state;
    struct volume_file a;
    struct volume_file b;
    struct notes notes = {0};
    write_raw("a.raw", 0, false);
    assert_ok(open_detached(&a, "encoding: raw\ndata file: a.raw\n", &notes));
    assert_ok(open_detached(&b, "encoding: raw\n#\ndata file: a.raw\n", &notes));
    assert_string_not_equal(a.info.sha256, b.info.sha256);
    volume_file_finish(&a);
    volume_file_finish(&b);
}

static void bad_fields_are_named(void **state)
{
    (void)state;
    static const char *const cases[][3] = {
        {"NRRD0004", "NRRD0006", "magic: found \"NRRD0006\", allowed are NRRD0001 to NRRD0005"},
        {"uchar", "block", "type: found \"block\""},
        {"type: uchar\n", "", "type: missing"},
        {"type: uchar\n", "type: uchar\ntype: uchar\n", "type: found twice, allowed is once"},
        {"dimension: 3", "dimension: 2", "dimension: found 2, allowed are 3 and 4"},
        {"dimension: 3", "dimension: 4", "sizes: found 3 numbers, the dimension is 4"},
        {"sizes: 2 3 2", "sizes: 2 0 2", "sizes: found \"0\""},
        {"sizes: 2 3 2", "sizes: 2 -3 2", "sizes: found \"-3\""},
        {"sizes: 2 3 2", "sizes: 2 3", "sizes: found 2 numbers"},
        {"sizes: 2 3 2", "sizes: 2 3 2 2 2", "sizes: found more than 4 numbers"},
        {"sizes: 2 3 2", "sizes: 2 3 2x", "sizes: found \"2x\""},
        {"space: left-posterior-superior\n", "", "space: missing, so it is not known which side is left"},
        {"left-posterior-superior", "scanner-xyz", "space: found \"scanner-xyz\""},
        {"endian:", "space dimension: 3\nendian:", "space dimension: found beside \"space\""},
        {"(2,0,0)", "none", "space directions: found"},
        {"(2,0,0)", "(2,0)", "space directions: found"},
        {"(2,0,0)", "(2,0,0,0)", "space directions: found"},
        {"(0,0,4)", "(0,0,4) (1,1,1)", "space directions: found more than the 3 axes have"},
        {"space directions", "axis mins: 0 0 0\n#", "space directions: missing"},
        {"(10,20,30)", "none", "space origin: found \"none\""},
        {"(10,20,30)", "(10,20)", "space origin: found \"(10,20)\""},
        {"space origin: (10,20,30)\n", "", "space origin: missing"},
        {"domain domain domain", "domain domain", "kinds: found 2, the dimension is 3"},
        {"domain domain domain", "RGB-color domain domain", "kinds: found \"RGB-color\""},
        {"domain domain domain", "list domain domain", "kinds: found \"list\""},
        {"endian:", "spacings: 2 3 5\nendian:", "spacings: found 5 of axis 2, whose space direction has length 4"},
        {"endian:", "space units: \"mm\" \"um\" \"mm\"\nendian:", "space units: needed are three times the same"},
        {"endian: little", "endian: middle", "endian: found \"middle\", allowed are little and big"},
        {"encoding: raw", "encoding: bzip2", "encoding: found \"bzip2\", allowed are raw, gzip, text and hex"},
        {"encoding: raw\n", "", "encoding: missing"},
        {"encoding: raw", "encodin: raw", "header: found the field \"encodin\""},
        {"encoding: raw", "encoding=raw", "header: found the line \"encoding=raw\""},
        {"(10,20,30)\n\n", "(10,20,30)\n", "header: found no empty line at its end"},
        {"endian:", "line skip: x\nendian:", "line skip: found \"x\""},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct text_volume volume;
        conus_status status = parse_bent(&volume, plain, cases[i][0], cases[i][1]);
        assert_true(status == CONUS_ERROR_DATA || status == CONUS_ERROR_UNSUPPORTED);
        assert_said(cases[i][2]);
    }
    struct text_volume volume;
    struct buffer text = {0};
    append_bent(&text, plain, "uchar", "short");
    assert_fails(parse_bent(&volume, text.data, "endian: little\n", ""), CONUS_ERROR_DATA);
    assert_said("endian: missing");
    buffer_finish(&text);
}

static conus_status open_bent(const char *from, const char *to, const char *voxels, uint64_t max_memory)
{
    struct buffer bytes = {0};
    struct volume_file file;
    struct notes notes = {0};
    append_bent(&bytes, plain, from, to);
    buffer_text(&bytes, voxels);
    conus_status status = volume_file_open(&file, write_bytes("bent.nrrd", &bytes), max_memory, &notes);
    if (!status) {
        volume_file_finish(&file);
    }
    notes_finish(&notes);
    buffer_finish(&bytes);
    return status;
}

static void bad_voxels_are_named(void **state)
{
    (void)state;
    static const char *const cases[][4] = {
        {"(2,0,0)", "(nan,0,0)", "123456789012", "the matrix is singular or not finite"},
        {"(2,0,0)", "(0,3,0)", "123456789012", "the matrix is singular or not finite"},
        {"(10,20,30)", "(inf,0,0)", "123456789012", "the matrix is singular or not finite"},
        {"sizes: 2 3 2", "sizes: 4611686018427387903 3 2", "1", "allowed are as many as fit in 2^62 bytes"},
        {"sizes: 2 3 2", "sizes: 2147483647 1000 2", "1", "--max-memory"},
        {"encoding: raw", "encoding: raw", "12345678901", "voxels: the file has"},
        {"encoding: raw", "encoding: text", "1 2 3 4 5 6 7 8 9 10 11",
         "voxels: found 11 numbers, the header asks for 12"},
        {"encoding: raw", "encoding: text", "1 2 3 4 5 6 7 8 9 10 11 12 13", "voxels: found 13 numbers"},
        {"encoding: raw", "encoding: text", "1 2 3 256 5 6 7 8 9 10 11 12", "voxels: number 3: found \"256\""},
        {"encoding: raw", "encoding: text", "1 2 3 -1 5 6 7 8 9 10 11 12", "voxels: number 3: found \"-1\""},
        {"encoding: raw", "encoding: text", "1 2", "voxels: found 3 bytes of numbers, the header asks for 12"},
        {"encoding: raw", "encoding: hex", "0102030405060708090a0b0", "hexadecimal digits at most"},
        {"encoding: raw", "encoding: hex", "0102030405060708090a0b0 ", "voxels: found 23 hexadecimal digits"},
        {"encoding: raw", "encoding: hex", "0102030405060708090a0b0c0d", "voxels: found 26 hexadecimal digits"},
        {"encoding: raw", "encoding: hex", "0102030405060708090a0b0x", "voxels: byte 23 is no hexadecimal digit"},
        {"encoding: raw", "encoding: gzip", "0102030405060708", "encoding: found gzip in the header, but"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_true(open_bent(cases[i][0], cases[i][1], cases[i][2], 0) != CONUS_OK);
        assert_said(cases[i][3]);
    }
    assert_ok(open_bent(NULL, NULL, "123456789012", 0));
    assert_fails(open_bent(NULL, NULL, "123456789012", 100), CONUS_ERROR_MEMORY);
    assert_said("--max-memory");
}

/* A file of a few packed bytes may not ask for more memory than they can fill. */
static void bombs_are_refused(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    struct volume_file file;
    struct notes notes = {0};
    append_bent(&bytes, plain, "sizes: 2 3 2\n", "sizes: 1000 1000 1000\n");
    struct buffer text = {0};
    append_bent(&text, bytes.data, "raw", "gzip");
    append_gzip(&text, "123456789012", 12);
    test_limit_allocations(1 << 20);
    conus_status status = volume_file_open(&file, write_bytes("bomb.nrrd", &text), 0, &notes);
    test_limit_allocations(0);
    assert_fails(status, CONUS_ERROR_DATA);
    assert_said("gzip: ");
    assert_said("cannot unpack to the 1000000000 that the header asks for");
    notes_finish(&notes);
    buffer_finish(&text);
    buffer_finish(&bytes);
}

static void a_million_lines_are_refused(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    struct text_volume volume;
    struct notes notes = {0};
    buffer_text(&bytes, "NRRD0005\n");
    for (int i = 0; i < 1000000; i++) {
        buffer_text(&bytes, "k:=v\n");
    }
    assert_fails(parse_header(&volume, nrrd_parse, &bytes, &notes), CONUS_ERROR_DATA);
    assert_said("header: found more than 65536 lines");
    buffer_finish(&bytes);
}

/* CR LF ends lines as LF does, and a file that is packed as a whole is unpacked. */
static void line_ends_and_packing(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    struct volume_file file;
    struct notes notes = {0};
    for (const char *at = plain; *at; at++) {
        buffer_append(&bytes, *at == '\n' ? "\r\n" : at, *at == '\n' ? 2 : 1);
    }
    append_counting(&bytes, 12);
    assert_ok(volume_file_open(&file, write_packed("x.nrrd.gz", &bytes), 0, &notes));
    assert_string_equal(file.info.format, "NRRD, gzip, little-endian");
    check_labels(&file, 12, 0, 1);
    volume_file_finish(&file);
    buffer_finish(&bytes);
}

static void every_prefix_is_refused(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    buffer_text(&bytes, plain);
    append_counting(&bytes, 12);
    for (size_t size = 0; size < bytes.size; size++) {
        const struct buffer prefix = {.data = bytes.data, .size = size};
        struct volume_file file;
        struct notes notes = {0};
        assert_fails(volume_file_open(&file, write_bytes("prefix.nrrd", &prefix), 0, &notes), CONUS_ERROR_DATA);
    }
    buffer_finish(&bytes);
}

static void every_failing_allocation(void **state)
{
    (void)state;
    struct buffer text = {0};
    char path[300];
    append_bent(&text, plain, "encoding: raw", "encoding: gzip\ndata file: all.raw.gz");
    write_raw("all.raw.gz", 0, true);
    snprintf(path, sizeof path, "%s", write_bytes("all.nhdr", &text));
    test_every_allocation(open_and_close, path);
    assert_true(test_every_primitive(open_and_close, path) > 0);
    buffer_finish(&text);
    append_bent(&text, plain, "encoding: raw", "encoding: text");
    buffer_text(&text, "1 2 3 4 5 6 7 8 9 10 11 12");
    snprintf(path, sizeof path, "%s", write_packed("text.nrrd.gz", &text));
    struct volume_file file;
    struct notes notes = {0};
    assert_fails(volume_file_open(&file, path, 0, &notes), CONUS_ERROR_UNSUPPORTED);
    assert_said("allowed there are raw voxels");
    snprintf(path, sizeof path, "%s", write_bytes("text.nrrd", &text));
    test_every_allocation(open_and_close, path);
    assert_true(test_every_primitive(open_and_close, path) > 0);
    buffer_finish(&text);
}

TEST_GROUP(nrrd)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(placement_follows_the_space),
        cmocka_unit_test(units_scale_the_matrix),
        cmocka_unit_test(a_grid_of_metres_is_noted),
        cmocka_unit_test(the_ccf_is_placed_from_its_corner),
        cmocka_unit_test(voxels_of_every_type_and_encoding),
        cmocka_unit_test(volumes_come_apart),
        cmocka_unit_test(detached_voxels_are_found),
        cmocka_unit_test(detached_voxels_that_are_not_right),
        cmocka_unit_test(the_checksum_is_of_both_files),
        cmocka_unit_test(bad_fields_are_named),
        cmocka_unit_test(bad_voxels_are_named),
        cmocka_unit_test(bombs_are_refused),
        cmocka_unit_test(a_million_lines_are_refused),
        cmocka_unit_test(line_ends_and_packing),
        cmocka_unit_test(every_prefix_is_refused),
        cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
