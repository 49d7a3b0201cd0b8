/* SPDX-License-Identifier: BSD-3-Clause */
/* Files of deformation fields, and atlases that they move, by shifts whose effect follows by hand. tests/cli/warp.bats
 * has FSL's, tests/oracles/compare_warps.py fields that are not constant. */
#include "atlas/deformation/deformation.h"
#include "atlas/warp/warp.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "builders/nifti_builder.h"
#include "conus/own.h"
#include "loaders/transform/transform.h"
#include "mesh_scene.h"
#include "scene.h"
#include "test.h"
#include "value_maps.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NX = 20, NY = 10, NZ = 11 };

/* A field on nodes 1 mm apart, the first at (-4, -3, -3). */
struct file {
    int version;
    bool big;
    int datatype;
    bool positions; /* SPM's, else ITK's */
    double shift;   /* all points go so far along x */
    double nothing; /* nodes with x from there on have no value */
};

static const struct file itk = {1, false, 16, false, 1.25, INFINITY};
static const struct file spm = {1, false, 16, true, 1.25, INFINITY};

static void begin(struct nifti_builder *builder, const struct file *file)
{
    const int64_t dim[3] = {NX, NY, NZ};
    const double srow[12] = {1, 0, 0, -4, 0, 1, 0, -3, 0, 0, 1, -3};
    nifti_begin(builder, file->version, file->big, file->datatype, dim);
    for (size_t i = 0; i < 12; i++) {
        nifti_set(builder, "srow", i, srow[i]);
    }
    nifti_set(builder, "dim", 0, 5);
    nifti_set(builder, "dim", 4, 1);
    nifti_set(builder, "dim", 5, 3);
    nifti_set(builder, "intent_code", 0, 1007);
    if (file->positions) {
        memcpy(builder->bytes.data + (file->version == 1 ? 328 : 508), "Mapping", sizeof "Mapping");
    }
}

static double value(const struct file *file, int component, const double p[3])
{
    const double there[3] = {p[0] + file->shift, p[1], p[2]};
    double displacement = component == 0 ? -file->shift : 0; /* LPS */
    return p[0] >= file->nothing ? NAN : file->positions ? there[component] : displacement;
}

static void build(struct buffer *out, const struct file *file)
{
    struct nifti_builder builder;
    begin(&builder, file);
    for (int component = 0; component < 3; component++) {
        for (int n = 0; n < NX * NY * NZ; n++) {
            const double p[3] = {n % NX - 4, n / NX % NY - 3, n / NX / NY - 3}; /* NOLINT: whole numbers */
            nifti_voxel(&builder, value(file, component, p));
        }
    }
    *out = builder.bytes;
}

/* Writes a file, packed or not; the path is valid until a few more files were written. */
static const char *write_field(const struct file *file, bool packed)
{
    struct buffer bytes;
    build(&bytes, file);
    const char *path = packed ? write_packed("field.nii.gz", &bytes) : write_bytes("field.nii", &bytes);
    buffer_finish(&bytes);
    return path;
}

static void check_file(const struct file *file, bool packed)
{
    struct transform_chain chain;
    struct file_sums read = {0};
    struct notes notes = {0};
    struct job job = {0};
    const char *path = write_field(file, packed);
    double p[3] = {1, 2, 3};
    transform_read(&job, &chain, source_open(&job, path), &(conus_transform_options){0});
    assert_ok(job_close(&job, &notes, &read));
    assert_int_equal(chain.count, 1);
    assert_int_equal(chain.fields->dim[0], NX);
    assert_true(deformation_point(p, chain.fields, p));
    assert_near(p[0], 1 + file->shift, 1e-6);
    assert_near(p[1], 2, 1e-6);
    assert_near(p[2], 3, 1e-6);
    assert_int_equal(chain.fields->stays_outside, !file->positions);
    assert_int_equal(read.count, 1);
    assert_string_equal(read.items[0].path, path);
    transform_chain_finish(&chain);
    file_sums_finish(&read);
    notes_finish(&notes);
}

static void both_headers_and_byte_orders_are_read(void **state)
{
    (void)state;
    for (int n = 0; n < 16; n++) {
        const struct file file = {n & 1 ? 2 : 1, (n & 2) != 0, n & 4 ? 64 : 16, (n & 8) != 0, 1.25, INFINITY};
        check_file(&file, (n & 1) != 0);
    }
}

static conus_status find_kind(enum field_kind *out, const struct field_header *header, bool images,
                              conus_vectors vectors, conus_file_space space)
{
    struct job job = {0};
    enum field_kind kind = field_header_kind(&job, header, images, vectors, space);
    *out = job_ok(&job) ? kind : *out;
    return job_close(&job, NULL, NULL);
}

static enum field_kind kind_of(int code, const char *name, conus_vectors vectors, conus_file_space space,
                               double parameter)
{
    struct field_header header = {.dim = {5, 9, 9, 9, 1, 3}, .intent_code = code, .parameter = parameter};
    enum field_kind kind = FIELD_FSL;
    strncpy(header.intent_name, name, sizeof header.intent_name - 1);
    assert_ok(find_kind(&kind, &header, false, vectors, space));
    return kind;
}

static void headers_say_whose_field_it_is(void **state)
{
    (void)state;
    assert_int_equal(kind_of(1007, "", 0, 0, 0), FIELD_VECTORS);
    assert_int_equal(kind_of(1006, "", 0, 0, 0), FIELD_RAS); /* of NIfTI's own axes */
    assert_int_equal(kind_of(1006, "", CONUS_VECTORS_RELATIVE, 0, 0), FIELD_RAS);
    assert_int_equal(kind_of(1006, "", 0, CONUS_FILE_SPACE_LPS, 0), FIELD_ITK);
    assert_int_equal(kind_of(1007, "Mapping", 0, 0, 0), FIELD_SPM);
    assert_int_equal(kind_of(1007, "", CONUS_VECTORS_RELATIVE, 0, 0), FIELD_ITK);
    assert_int_equal(kind_of(0, "", CONUS_VECTORS_ABSOLUTE, 0, 0), FIELD_SPM);
    assert_int_equal(kind_of(1007, "NREG_TRANS", CONUS_VECTORS_ABSOLUTE, 0, 0), FIELD_SPM);
    /* NiftyReg's DEF_FIELD and DISP_FIELD (reg_transform -def, -disp), in mm of NIfTI's world */
    assert_int_equal(kind_of(1007, "NREG_TRANS", 0, 0, 0), FIELD_SPM);
    assert_int_equal(kind_of(1007, "NREG_TRANS", 0, 0, 1), FIELD_RAS);
    static const enum field_kind stated[2][2] = {{FIELD_RAS, FIELD_SPM}, {FIELD_ITK, FIELD_LPS}};
    for (int n = 0; n < 4; n++) {
        conus_file_space space = n / 2 ? CONUS_FILE_SPACE_LPS : CONUS_FILE_SPACE_RAS;
        conus_vectors vectors = n % 2 ? CONUS_VECTORS_ABSOLUTE : CONUS_VECTORS_RELATIVE;
        assert_int_equal(kind_of(n ? 1007 : 0, "", vectors, space, 0), stated[n / 2][n % 2]);
        const struct field_header four = {.dim = {4, 9, 9, 9, 3}, .intent_code = n ? 0 : 1007};
        enum field_kind of_four = FIELD_FSL;
        assert_ok(find_kind(&of_four, &four, false, vectors, space));
        assert_int_equal(of_four, stated[n / 2][n % 2]);
    }
    assert_int_equal(kind_of(1006, "", 0, CONUS_FILE_SPACE_RAS, 0), FIELD_RAS); /* nifti1.h: displacements */
    struct field_header header = {.dim = {4, 9, 9, 9, 3, 0}, .intent_code = 2006};
    enum field_kind kind;
    assert_ok(find_kind(&kind, &header, true, 0, 0));
    assert_int_equal(kind, FIELD_FNIRT);
    assert_ok(find_kind(&kind, &header, true, CONUS_VECTORS_ABSOLUTE, 0));
    assert_int_equal(kind, FIELD_FSL);
    header.intent_code = 0;
    assert_ok(find_kind(&kind, &header, true, 0, 0));
    assert_int_equal(kind, FIELD_FSL);
}

static void check_refused(struct field_header header, bool images, conus_vectors vectors, conus_status wanted,
                          const char *words)
{
    enum field_kind kind = FIELD_FSL;
    conus_status status = find_kind(&kind, &header, images, vectors, 0);
    if (status != wanted || !strstr(conus_message(), words) || kind != FIELD_FSL) {
        fail_msg("status %d, \"%s\", wanted: %s", (int)status, conus_message(), words);
    }
}

static void bad_headers_say_what_is_wrong(void **state)
{
    (void)state;
    const struct field_header good = {.dim = {5, 9, 9, 9, 1, 3}, .intent_code = 1007};
    struct field_header bad = good;
    bad.dim[0] = 3;
    check_refused(bad, false, 0, CONUS_ERROR_DATA, "found 3: 9 x 9 x 9 x 1 x 1: this is a volume");
    bad = good;
    bad.dim[5] = 2;
    check_refused(bad, false, 0, CONUS_ERROR_DATA, "no deformation field");
    bad = good;
    bad.dim[4] = 2;
    check_refused(bad, false, 0, CONUS_ERROR_DATA, "no deformation field");
    bad = good;
    bad.dim[2] = 1;
    check_refused(bad, false, 0, CONUS_ERROR_DATA, "dim[2]: found 1, a field has 2 or more");
    bad = good;
    bad.intent_code = 0;
    check_refused(bad, false, 0, CONUS_ERROR_DATA, "intent_code: found 0");
    check_refused(good, true, 0, CONUS_ERROR_ARGUMENT, "are for FSL's fields");
    memcpy(bad.intent_name, "Mapping", sizeof "Mapping");
    check_refused(bad, false, CONUS_VECTORS_RELATIVE, CONUS_ERROR_ARGUMENT, "positions in RAS, not relative");
    bad.intent_code = 1006;
    check_refused(bad, false, 0, CONUS_ERROR_ARGUMENT, "found 1006 (displacements), and intent_name \"Mapping\"");
    memcpy(bad.intent_name, "NREG_TRANS", sizeof "NREG_TRANS");
    check_refused(bad, false, CONUS_VECTORS_RELATIVE, CONUS_ERROR_ARGUMENT,
                  "intent_p1 0: positions in RAS, not relative");
    static const struct {
        const char *name;
        double parameter;
    } kinds[] = {{"NREG_TRANS", 2}, {"NREG_TRANS", 3}, {"NREG_TRANS", 4},   {"NREG_TRANS", 5},
                 {"NREG_TRANS", 6}, {"NREG_TRANS", 7}, {"NREG_TRANS", NAN}, {"NREG_CPP_FILE", 0}};
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        bad.parameter = kinds[i].parameter;
        snprintf(bad.intent_name, sizeof bad.intent_name, "%s", kinds[i].name);
        check_refused(bad, false, 0, CONUS_ERROR_UNSUPPORTED, "a grid or velocities of NiftyReg");
        check_refused(bad, false, CONUS_VECTORS_ABSOLUTE, CONUS_ERROR_UNSUPPORTED, "of NiftyReg");
    }
    bad = good;
    bad.dim[4] = 3; /* MRtrix's warp of both ways */
    bad.dim[5] = 4;
    check_refused(bad, false, 0, CONUS_ERROR_UNSUPPORTED, "warpfull2deformation");
    bad = (struct field_header){.dim = {4, 9, 9, 9, 3}};
    for (int vectors = 0; vectors < 3; vectors++) { /* nobody says whose it is */
        check_refused(bad, false, (conus_vectors)vectors, CONUS_ERROR_ARGUMENT, "MRtrix");
        check_refused(bad, false, (conus_vectors)vectors, CONUS_ERROR_ARGUMENT, "SynthMorph");
    }
    const struct field_header fsl = {.dim = {4, 9, 9, 9, 3}, .intent_code = 2006};
    check_refused(fsl, false, 0, CONUS_ERROR_ARGUMENT, "from=IMAGE and to=IMAGE are needed");
    static const int others[] = {2007, 2008, 2009, 2016, 2017, 2018};
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        bad = fsl;
        bad.intent_code = others[i];
        check_refused(bad, true, 0, CONUS_ERROR_UNSUPPORTED, i < 3 ? "invwarp" : "topup");
    }
}

static void headers_that_end_early_say_where(void **state)
{
    (void)state;
    static const uint8_t sizes[2][4] = {{0x5c, 1}, {0x1c, 2}}; /* 348, 540 */
    for (size_t i = 0; i < 2; i++) {
        uint8_t data[539] = {0};
        struct job job = {0};
        struct field_header header;
        memcpy(data, sizes[i], 4);
        field_header_parse(&job, &header, (struct text){(const char *)data, i ? 539 : 347});
        assert_fails(job_close(&job, NULL, NULL), CONUS_ERROR_DATA);
        assert_non_null(
            strstr(conus_message(), i ? "found 539 bytes, 540 are needed" : "found 347 bytes, 348 are needed"));
    }
}

static void no_prefix_is_a_field(void **state)
{
    (void)state;
    struct buffer bytes;
    conus_atlas *atlas = mesh_scene_atlas();
    const struct file file = {2, false, 16, false, 1.25, INFINITY};
    build(&bytes, &file);
    size_t size = bytes.size;
    for (size_t cut = 0; cut < size; cut += cut < 560 ? 1 : 997) {
        bytes.size = cut;
        const char *path = write_bytes("cut.nii", &bytes);
        assert_true(conus_atlas_transform(atlas, path, NULL) != CONUS_OK);
        assert_non_null(strstr(conus_message(), "cut.nii"));
    }
    buffer_finish(&bytes);
    conus_atlas_destroy(atlas);
}

/* Voxels of 1 mm with centres 0 to 3, whose label is 1 and the number along x; a pathway of values x + 1, from 3 on; a
 * box from (10, 0, 0) to (12, 3, 4). */
static conus_atlas *make_atlas(void)
{
    uint32_t labels[64];
    float *values = memory_raw(64, sizeof *values);
    for (uint32_t i = 0; i < 64; i++) {
        labels[i] = 1 + i % 4;
        values[i] = (float)(1 + i % 4);
    }
    conus_volume_info grid = scene_plain_grid((const size_t[]){4, 4, 4}, NULL);
    conus_atlas *atlas = scene_parcellation(&grid, labels);
    struct mesh box = mesh_scene_box((const double[]){10, 0, 0}, (const double[]){12, 3, 4});
    mesh_scene_add(atlas, &box);
    grid.role = CONUS_ROLE_SCALAR;
    grid.threshold = 3;
    grid.minimum = 1;
    grid.maximum = 4;
    assert_ok(pathway_of_values(atlas, &grid, values, "tract"));
    return atlas;
}

/* The label at a world point, 0 = none. */
static uint32_t label_at(const conus_atlas *atlas, size_t volume, double x, double y, double z)
{
    size_t voxel;
    const double point[3] = {x, y, z};
    uint32_t object =
        volume_find_voxel(&voxel, &atlas->volumes[volume], point) ? volume_object(&atlas->volumes[volume], voxel) : 0;
    return object ? atlas->objects[object - 1].label : 0;
}

/* A shift of 1.25: node p is label floor(p + 1.25 + 0.5) + 1, so -1 is 1, and 2 is 4; the box goes to 8.75 to 10.75. */
static void check_shifted(const conus_atlas *atlas)
{
    double own[3] = {2, 1, 1};
    assert_int_equal(label_at(atlas, 0, -2, 1, 1), 0);
    for (uint32_t label = 1; label <= 4; label++) {
        assert_int_equal(label_at(atlas, 0, (double)label - 2, 1, 3), label);
        assert_int_equal(atlas->objects[label - 1].voxels, 16);
        assert_near(atlas->objects[label - 1].volume_mm3, 16, 1e-9);
    }
    assert_int_equal(label_at(atlas, 0, 3, 1, 1), 0);
    assert_int_equal(label_at(atlas, 0, 1, 4, 1), 0);
    assert_near(atlas->meshes[0].shape.low[0], 8.75, 1e-5);
    assert_near(atlas->meshes[0].shape.high[0], 10.75, 1e-5);
    assert_near(atlas->objects[4].volume_mm3, 24, 1e-3);
    assert_int_equal(label_at(atlas, 1, 0, 1, 1), 0);
    assert_int_equal(label_at(atlas, 1, 1, 1, 1), 1); /* the first pathway */
    assert_int_equal(atlas->objects[5].voxels, 32);
    conus_atlas_own_point(own, atlas, own);
    assert_near(own[0], 3.25, 1e-6);
    assert_near(own[1], 1, 1e-6);
}

static void an_atlas_goes_where_the_field_has_it(void **state)
{
    (void)state;
    for (int n = 0; n < 2; n++) {
        conus_atlas *atlas = make_atlas();
        const char *path = write_field(n ? &spm : &itk, true);
        assert_ok(conus_atlas_transform(atlas, path, NULL));
        check_shifted(atlas);
        assert_int_equal(conus_atlas_note_count(atlas), 1);
        assert_true(test_has_note(atlas, "on a grid of 20 x 10 x 11 voxels of 1 x 1 x 1 mm"));
        assert_string_equal(conus_atlas_file(atlas, conus_atlas_file_count(atlas) - 1), path);
        assert_non_null(strstr(conus_atlas_volume(atlas, 0)->transform, ", warped"));
        double far[3] = {90, 0, 0};
        conus_atlas_own_point(far, atlas, far);
        assert_true(n ? isnan(far[0]) : far[0] == 90.0); /* SPM does not say; ITK's points stay */
        conus_atlas_destroy(atlas);
    }
}

/* The same shift to the right as displacements in RAS, +1.25: only with the right word does x = 2 go to 3.25. */
static void the_axes_of_vectors_are_stated(void **state)
{
    (void)state;
    const struct file ras = {1, false, 16, false, -1.25, INFINITY}; /* +1.25 in the file */
    conus_atlas *atlas = make_atlas();
    const char *path = write_field(&ras, false);
    assert_fails(conus_atlas_transform(atlas, path, &(conus_transform_options){.space = CONUS_FILE_SPACE_RAS}),
                 CONUS_ERROR_ARGUMENT);
    assert_ok(conus_atlas_transform(
        atlas, path, &(conus_transform_options){.space = CONUS_FILE_SPACE_RAS, .vectors = CONUS_VECTORS_RELATIVE}));
    check_shifted(atlas);
    conus_atlas_destroy(atlas);
}

/* Intent 1006 is displacements in RAS: +1.25 along x. Positions under that code are refused until the caller says so.
 */
static void displacements_that_look_like_positions_are_refused(void **state)
{
    (void)state;
    enum { INTENT_CODE = 68, INTENT_NAME = 328 };
    const struct file ras = {1, false, 16, false, -1.25, INFINITY}; /* +1.25 in the file */
    for (int positions = 0; positions < 2; positions++) {
        struct buffer bytes;
        build(&bytes, positions ? &spm : &ras);
        memcpy(bytes.data + INTENT_CODE, "\xee\x03", 2); /* 1006 */
        memset(bytes.data + INTENT_NAME, 0, sizeof "Mapping");
        const char *path = write_bytes("code.nii", &bytes);
        const conus_transform_options stated = {.vectors = CONUS_VECTORS_ABSOLUTE};
        conus_atlas *atlas = make_atlas();
        if (positions) {
            assert_fails(conus_atlas_transform(atlas, path, NULL), CONUS_ERROR_ARGUMENT);
            assert_non_null(strstr(conus_message(), "look like positions: ',relative' or ',absolute'"));
        }
        assert_ok(conus_atlas_transform(atlas, path, positions ? &stated : NULL));
        check_shifted(atlas);
        conus_atlas_destroy(atlas);
        buffer_finish(&bytes);
    }
}

/* A field of nodes 2 or 3 mm apart that moves nothing, over an atlas of 1 mm whose label is 1 and the number along x:
 * on the nodes' own grid half of the labels or more would be gone. Parted, with nodes as centres of voxels still, from
 * -13 to 13 mm, each label keeps its 16 voxels where they were. */
static void a_coarse_field_leaves_the_atlas_as_fine(void **state)
{
    (void)state;
    for (int step = 2; step <= 3; step++) {
        struct nifti_builder builder;
        const int64_t nodes = step == 2 ? 13 : 9;
        const double apart = step;
        const double srow[12] = {apart, 0, 0, -12, 0, apart, 0, -12, 0, 0, apart, -12};
        nifti_begin(&builder, 1, false, 16, (const int64_t[]){nodes, nodes, nodes});
        for (size_t i = 0; i < 12; i++) {
            nifti_set(&builder, "srow", i, srow[i]);
        }
        nifti_set(&builder, "dim", 0, 5);
        nifti_set(&builder, "dim", 4, 1);
        nifti_set(&builder, "dim", 5, 3);
        nifti_set(&builder, "intent_code", 0, 1007);
        for (int64_t i = 0; i < 3 * nodes * nodes * nodes; i++) {
            nifti_voxel(&builder, 0);
        }
        const char *path = write_bytes("coarse.nii", &builder.bytes);
        conus_atlas *atlas = make_atlas();
        char *words = atlas->volumes[0].info.transform;
        snprintf(words, sizeof atlas->volumes[0].info.transform, "sform, code 9");
        assert_ok(conus_atlas_transform(atlas, path, NULL));
        assert_true(test_has_note(atlas, "on a grid of 27 x 27 x 27 voxels of 1 x 1 x 1 mm"));
        for (uint32_t label = 1; label <= 4; label++) {
            assert_int_equal(label_at(atlas, 0, (double)label - 1, 1, 3), label);
            assert_int_equal(label_at(atlas, 0, (double)label - 1.4, 0.6, 2.6), label); /* within its voxel */
            assert_int_equal(atlas->objects[label - 1].voxels, 16);
        }
        assert_string_equal(conus_atlas_volume(atlas, 0)->transform, "sform, code 9, warped"); /* not the field's */
        conus_atlas_destroy(atlas);
        atlas = make_atlas(); /* who asks for the nodes gets them, and hears of it */
        assert_ok(conus_atlas_transform(atlas, path, &(conus_transform_options){.grid = path}));
        assert_true(test_has_note(atlas, step == 2 ? "up to 2 times as long as" : "up to 3 times as long as"));
        conus_atlas_destroy(atlas);
        buffer_finish(&builder.bytes);
    }
}

/* Two shifts of 1.25 in one search: node p is floor(p + 2.5 + 0.5) + 1, -3 to 0. In two searches it would be
 * floor(floor(p + 1.75) + 1.75), -2 to 1. With an affine by 0.5 between them it is floor(p + 3.5) + 1: -3 to 0 again,
 * for whole p. */
static void several_fields_are_one_search(void **state)
{
    (void)state;
    const char *path = write_field(&itk, false);
    conus_atlas *atlas = make_atlas();
    double half[16];
    mat4_identity(half);
    half[12] = 0.25;
    assert_ok(conus_atlas_transform(atlas, path, NULL));
    assert_ok(conus_atlas_transform(atlas, path, NULL));
    for (uint32_t label = 1; label <= 4; label++) {
        assert_int_equal(label_at(atlas, 0, (double)label - 4, 1, 3), label);
    }
    assert_int_equal(label_at(atlas, 0, 1, 1, 1), 0);
    assert_near(atlas->meshes[0].shape.low[0], 7.5, 1e-5);
    conus_atlas_destroy(atlas);
    atlas = make_atlas();
    assert_ok(conus_atlas_transform(atlas, path, NULL));
    assert_ok(conus_atlas_move(atlas, half));
    assert_ok(conus_atlas_transform(atlas, path, NULL));
    double own[3] = {0, 0, 0};
    conus_atlas_own_point(own, atlas, own);
    assert_near(own[0], 2.75, 1e-6);
    assert_int_equal(label_at(atlas, 0, 0, 1, 1), 4);
    assert_int_equal(label_at(atlas, 0, -3, 1, 1), 1);
    conus_atlas_destroy(atlas);
}

/* The parcellation was moved twice, the pathway that was added in between only once. */
static void what_is_added_later_does_not_move_with_it(void **state)
{
    (void)state;
    const char *path = write_field(&itk, false);
    conus_atlas *atlas = make_atlas();
    float *values = memory_zeroed(64, sizeof *values);
    values[0] = 5;
    conus_volume_info grid = scene_plain_grid((const size_t[]){4, 4, 4}, NULL);
    grid.role = CONUS_ROLE_SCALAR;
    grid.threshold = 3;
    assert_ok(conus_atlas_transform(atlas, path, NULL));
    assert_ok(pathway_of_values(atlas, &grid, values, "later"));
    assert_ok(conus_atlas_transform(atlas, path, NULL));
    assert_int_equal(label_at(atlas, 2, -1, 0, 0), 2); /* 0.25 is nearest to 0 */
    assert_int_equal(label_at(atlas, 0, 0, 1, 1), 4);
    conus_atlas_destroy(atlas);
}

/* A threshold of 4 leaves the last layer, also when the voxels are found again. */
static void thresholds_last(void **state)
{
    (void)state;
    const char *path = write_field(&itk, false);
    conus_atlas *atlas = make_atlas();
    assert_ok(conus_atlas_transform(atlas, path, NULL));
    assert_ok(conus_atlas_set_threshold(atlas, 6, 4));
    assert_int_equal(atlas->objects[5].voxels, 16);
    assert_int_equal(label_at(atlas, 1, 1, 1, 1), 0);
    assert_int_equal(label_at(atlas, 1, 2, 1, 1), 1);
    assert_ok(conus_atlas_transform(atlas, path, NULL));
    assert_int_equal(atlas->objects[5].voxels, 16);
    assert_int_equal(label_at(atlas, 1, 0, 1, 1), 1);
    assert_int_equal(label_at(atlas, 1, -1, 1, 1), 0);
    conus_atlas_destroy(atlas);
}

/* Voxels of half the size: eight times as many, with the same volume. */
static void labels_are_on_the_grid_that_is_given(void **state)
{
    (void)state;
    struct nifti_builder builder;
    const int64_t dim[3] = {40, 20, 22};
    const double srow[12] = {0.5, 0, 0, -4.125, 0, 0.5, 0, -3.125, 0, 0, 0.5, -3.125};
    nifti_begin(&builder, 1, false, 2, dim);
    for (size_t i = 0; i < 12; i++) {
        nifti_set(&builder, "srow", i, srow[i]);
    }
    for (int i = 0; i < 40 * 20 * 22; i++) {
        nifti_voxel(&builder, 0);
    }
    const char *grid = write_bytes("grid.nii", &builder.bytes);
    buffer_finish(&builder.bytes);
    conus_atlas *atlas = make_atlas();
    assert_ok(conus_atlas_transform(atlas, write_field(&itk, false), &(conus_transform_options){.grid = grid}));
    assert_int_equal(conus_atlas_volume(atlas, 0)->dim[2], 22);
    for (size_t i = 0; i < 4; i++) {
        assert_int_equal(atlas->objects[i].voxels, 128);
        assert_near(atlas->objects[i].volume_mm3, 16, 1e-9);
    }
    double turn[16];
    mat4_identity(turn);
    assert_fails(conus_atlas_transform(atlas, "no such file", &(conus_transform_options){.grid = "none.nii"}),
                 CONUS_ERROR_IO);
    conus_atlas_destroy(atlas);
}

/* The field ends at x = 9: the box, which goes to 8.75 to 10.75, loses the corners on its right side. */
static void what_the_field_does_not_reach_is_cut(void **state)
{
    (void)state;
    conus_atlas *atlas = make_atlas();
    const struct file part = {1, false, 16, true, 1.25, 10};
    assert_ok(conus_atlas_transform(atlas, write_field(&part, false), NULL));
    assert_int_equal(atlas->objects[4].triangles, 2); /* of 12: those of the left side */
    assert_int_equal(atlas->meshes[0].vertex_count, 4);
    for (size_t i = 0; i < 4; i++) { /* none is at the origin, where nothing was */
        assert_near(atlas->meshes[0].positions[3 * i], 8.75, 1e-5);
    }
    assert_false(atlas->objects[4].closed);
    assert_true(test_has_note(atlas, "10 of 12 triangles are left out"));
    assert_true(test_has_note(atlas, "4 of 8 vertices have no place"));
    assert_true(test_has_note(atlas, "no value at 30 % of its nodes")); /* 6 of 20 along x */
    conus_atlas_destroy(atlas);
    atlas = make_atlas();
    const struct file less = {1, false, 16, true, 1.25, 8};
    assert_fails(conus_atlas_transform(atlas, write_field(&less, false), NULL), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "is where the field leads to"));
    assert_false(atlas->is_moved);
    conus_atlas_destroy(atlas);
}

/* A context of CT, -1000 (air) to 200, on voxels 0 to 3. The rest of the field's grid, from (-4, -3, -3) on, is air and
 * not 0, which would be water. */
static void outside_of_a_warped_context_is_its_least_value(void **state)
{
    (void)state;
    conus_atlas *atlas = make_atlas();
    float *values = memory_raw(64, sizeof *values);
    for (size_t i = 0; i < 64; i++) {
        values[i] = i ? 200 : -1000;
    }
    conus_volume_info grid = scene_plain_grid((const size_t[]){4, 4, 4}, NULL);
    grid.role = CONUS_ROLE_CONTEXT;
    grid.minimum = -1000;
    grid.maximum = 200;
    assert_ok(atlas_set_context(atlas, &grid, values));
    assert_ok(conus_atlas_transform(atlas, write_field(&itk, false), NULL));
    const struct volume *context = atlas_context(atlas);
    size_t voxel;
    assert_true(volume_find_voxel(&voxel, context, (const double[]){-4, -3, -3}));
    assert_true(context->values[voxel] == -1000);
    assert_true(volume_find_voxel(&voxel, context, (const double[]){1, 1, 1}));
    assert_true(context->values[voxel] == 200);
    conus_atlas_destroy(atlas);
}

static void areas_that_are_lost_are_named(void **state)
{
    (void)state;
    conus_atlas *atlas = make_atlas();
    const struct file far = {1, false, 16, false, 5.25, INFINITY}; /* labels 1 and 2 would lie at -5 and -4 */
    assert_ok(conus_atlas_transform(atlas, write_field(&far, false), NULL));
    assert_int_equal(label_at(atlas, 0, -4, 1, 1), 2);
    assert_true(test_has_note(atlas, "no voxel is left of "));
    assert_true(test_has_note(atlas, "25 % of the atlas's voxels lie outside of the field"));
    assert_int_equal(atlas->objects[0].voxels, 0);
    conus_atlas_destroy(atlas);
}

static void what_cannot_be_warped_stays(void **state)
{
    (void)state;
    const char *path = write_field(&itk, false);
    conus_atlas *atlas = make_atlas();
    size_t notes = conus_atlas_note_count(atlas);
    bool hidden[7] = {[2] = true};
    const struct file nan = {1, false, 16, false, 1.25, 10};
    assert_fails(conus_atlas_transform(atlas, path, &(conus_transform_options){.inverse = true}),
                 CONUS_ERROR_UNSUPPORTED);
    assert_fails(conus_atlas_transform(atlas, path, &(conus_transform_options){.max_memory = 20000}),
                 CONUS_ERROR_MEMORY);
    assert_fails(conus_atlas_transform(atlas, write_field(&nan, true), NULL), CONUS_ERROR_DATA);
    assert_ok(conus_atlas_set_hidden(atlas, hidden));
    assert_fails(conus_atlas_transform(atlas, path, NULL), CONUS_ERROR_ARGUMENT);
    assert_ok(conus_atlas_set_hidden(atlas, NULL));
    assert_int_equal(conus_atlas_note_count(atlas), notes);
    assert_int_equal(conus_atlas_file_count(atlas), 0);
    assert_false(atlas->is_moved);
    assert_int_equal(label_at(atlas, 0, 3, 1, 1), 4);
    assert_ok(conus_atlas_transform(atlas, path, NULL));
    assert_fails(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_MERGED), CONUS_ERROR_ARGUMENT);
    conus_atlas_destroy(atlas);
}

static void a_packed_atlas_knows_its_own_space(void **state)
{
    (void)state;
    const char *path = write_field(&spm, false);
    conus_atlas *atlas = make_atlas();
    conus_atlas *attached = NULL;
    assert_ok(conus_atlas_transform(atlas, path, NULL));
    size_t size = conus_atlas_packed_size(atlas);
    uint8_t *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    assert_ok(conus_atlas_pack(memory, size, atlas));
    conus_atlas_destroy(atlas);
    assert_ok(conus_atlas_attach(&attached, memory, size));
    check_shifted(attached);
    double half[16];
    mat4_identity(half);
    half[12] = 0.5;
    assert_ok(conus_atlas_move(attached, half));
    double own[3] = {0, 0, 0};
    conus_atlas_own_point(own, attached, own);
    assert_near(own[0], 1.75, 1e-6);
    assert_fails(conus_atlas_transform(attached, path, NULL), CONUS_ERROR_ARGUMENT);
    conus_atlas_destroy(attached);
    free(memory);
}

/* An attached atlas without a field can be moved by one, and its block stays as it is. */
static void an_attached_atlas_is_warped(void **state)
{
    (void)state;
    conus_atlas *atlas = make_atlas();
    conus_atlas *attached = NULL;
    size_t size = conus_atlas_packed_size(atlas);
    uint8_t *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    assert_ok(conus_atlas_pack(memory, size, atlas));
    conus_atlas_destroy(atlas);
    uint8_t *copy = malloc(size);
    memcpy(copy, memory, size);
    assert_ok(conus_atlas_attach(&attached, memory, size));
    assert_ok(conus_atlas_transform(attached, write_field(&itk, false), NULL));
    check_shifted(attached);
    assert_ok(conus_atlas_set_threshold(attached, 6, 4));
    assert_ok(conus_atlas_set_threshold(attached, 6, 3));
    assert_int_equal(attached->objects[5].voxels, 32);
    conus_atlas_destroy(attached);
    assert_memory_equal(copy, memory, size);
    free(copy);
    free(memory);
}

struct trial {
    conus_atlas *atlas;
    const char *path;
    bool done;
};

static conus_status transform(void *data)
{
    struct trial *attempt = data;
    conus_status status = conus_atlas_transform(attempt->atlas, attempt->path, NULL);
    assert_int_equal(attempt->atlas->warp_count, status == CONUS_OK);
    assert_int_equal(label_at(attempt->atlas, 0, 3, 1, 1), status ? 4 : 0);
    assert_int_equal(conus_atlas_file_count(attempt->atlas), status == CONUS_OK);
    return status;
}

static conus_status transform_anew(void *path)
{
    struct trial attempt = {.atlas = make_atlas(), .path = path};
    conus_status status = transform(&attempt);
    conus_atlas_destroy(attempt.atlas);
    return status;
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    struct trial attempt = {.atlas = make_atlas(), .path = write_field(&itk, true)};
    test_every_allocation(transform, &attempt);
    assert_true(test_every_primitive(transform_anew, (void *)attempt.path) > 5);
    conus_atlas_destroy(attempt.atlas);
}

TEST_GROUP(field)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(both_headers_and_byte_orders_are_read),
        cmocka_unit_test(headers_say_whose_field_it_is),
        cmocka_unit_test(bad_headers_say_what_is_wrong),
        cmocka_unit_test(headers_that_end_early_say_where),
        cmocka_unit_test(no_prefix_is_a_field),
        cmocka_unit_test(an_atlas_goes_where_the_field_has_it),
        cmocka_unit_test(the_axes_of_vectors_are_stated),
        cmocka_unit_test(displacements_that_look_like_positions_are_refused),
        cmocka_unit_test(a_coarse_field_leaves_the_atlas_as_fine),
        cmocka_unit_test(several_fields_are_one_search),
        cmocka_unit_test(what_is_added_later_does_not_move_with_it),
        cmocka_unit_test(thresholds_last),
        cmocka_unit_test(labels_are_on_the_grid_that_is_given),
        cmocka_unit_test(what_the_field_does_not_reach_is_cut),
        cmocka_unit_test(outside_of_a_warped_context_is_its_least_value),
        cmocka_unit_test(areas_that_are_lost_are_named),
        cmocka_unit_test(what_cannot_be_warped_stays),
        cmocka_unit_test(a_packed_atlas_knows_its_own_space),
        cmocka_unit_test(an_attached_atlas_is_warped),
        cmocka_unit_test(every_failing_allocation_is_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
