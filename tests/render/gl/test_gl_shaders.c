/* SPDX-License-Identifier: BSD-3-Clause */
/* Every shader in every variant, as the driver gets it, by glslang: Mesa takes what other compilers refuse. */
#include "base/memory.h"
#include "gl_pair.h"
#include "mesh_scene.h"
#include "picture_scene.h"
#include "render/colour/colour_gl.h"
#include "render/gl/gl.h"
#include "scene.h"
#include "shader_check.h"
#include "test.h"
#include "test_gl.h"
#include "tract_scene.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Without this a check that finds nothing would look like shaders that are right. */
static void glslang_finds_what_is_wrong(void **state)
{
    static const char vertex[] = "#version 450 core\nout float slope;\n"
                                 "void main() { slope = 1.0; gl_Position = vec4(0.0); }\n";
    static const struct {
        const char *fragment;
        bool taken;
    } cases[] = {
        {"in float slope; out vec4 c; void main() { c = vec4(slope); }", true},
        {"in float slope; out vec4 c; void main() { c = vec4(slope + missing); }", false},
        {"in float slope; out vec4 c; void main() { int i = 1.5; c = vec4(slope * i); }", false},
        {"in float slope; out vec4 c; void main() { float a__b = slope; c = vec4(a__b); }", false}, /* a warning */
        {"in vec2 slope; out vec4 c; void main() { c = vec4(slope, slope); }", false},              /* does not link */
        {"in float slope; out vec4 c; float f(float x) { return f(x); } void main() { c = vec4(f(slope)); }", false},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[256];
        snprintf(text, sizeof text, "#version 450 core\n%s\n", cases[i].fragment);
        assert_int_equal(shader_check_takes(vertex, text), cases[i].taken);
    }
}

/* The programs of the gl engine: volumes by cells and on planes, first hits and all layers. */
static void make_engine_programs(const conus_atlas *atlas)
{
    for (int sampling = CONUS_SAMPLING_EXACT; sampling <= CONUS_SAMPLING_SLICES; sampling++) {
        struct gl_pair pair = gl_pair_create(atlas, (conus_sampling)sampling);
        struct cone cone = mesh_scene_cone((double[]){-200, 1, 30}, (double[]){0, 2, 3}, 40, 4);
        struct evidence evidence = gl_pair_trace(pair.gl, &cone);
        evidence_finish(&evidence);
        if (sampling == CONUS_SAMPLING_EXACT) {
            struct layers layers = gl_pair_pierce(pair.gl, &cone);
            layers_finish(&layers);
        }
        gl_pair_destroy(&pair);
    }
}

/* Those of pictures. Each part may be missing from an atlas; `slice` is what the bench's vertex shader hands on. */
static void make_picture_programs(void)
{
    struct test_gl gl;
    test_gl_enter(&gl);
    const struct program_shader screen = {"screen.vert.glsl", shader_screen_vert};
    const struct program_shader planes = {"planes", "layout(location = 0) flat out float slice;\n"
                                                    "void main() { slice = 0.0; gl_Position = vec4(0.0); }\n"};
    for (unsigned variant = 0; variant < 8; variant++) {
        const struct colour_pass pass = {.may_have_areas = variant & 1U,
                                         .may_have_context = variant & 2U,
                                         .hazy.transfers = variant & 4U ? (void *)&gl : NULL};
        for (int kind = COLOUR_RAYS; kind <= COLOUR_SLICES; kind++) {
            GLuint program = 0;
            assert_ok(colour_program_create(&program, kind == COLOUR_SLICES ? &planes : &screen,
                                            (enum colour_program)kind, &pass, variant & 2U));
            glDeleteProgram(program);
        }
    }
    test_gl_leave(&gl);
}

/* A picture of the atlas, with smooth edges: those, too. */
static void draw(const conus_atlas *atlas)
{
    conus_renderer *renderer = picture_renderer(atlas, NULL);
    const struct camera camera = picture_camera((double[]){0, 1, 0}, 150, 0.5);
    memory_free(picture_draw(renderer, &camera, NULL, true));
    conus_renderer_destroy(renderer);
}

/* Every line `#if NAME`, `#if !NAME` or `#elif NAME` of a shader was seen with 0 and with 1. */
static void assert_both_values(const char *text, const char *name)
{
    for (const char *line = text; line; line = strchr(line, '\n')) {
        line += *line == '\n';
        const char *word = strncmp(line, "#if ", 4) == 0 ? line + 4 : strncmp(line, "#elif ", 6) == 0 ? line + 6 : NULL;
        for (int value = 0; word && value < 2; value++) {
            char define[64];
            word += *word == '!';
            snprintf(define, sizeof define, "#define %.*s %d\n", (int)strcspn(word, "\n"), word, value);
            if (!shader_check_saw(define, text)) {
                fail_msg("%s was never compiled with %s", name, define);
            }
        }
    }
}

/* Each file of the folder was seen, whoever lists it. */
static void assert_all_were_seen(void)
{
    DIR *folder = opendir(CONUS_SOURCE_DIR "/render/shaders");
    assert_non_null(folder);
    size_t files = 0;
    for (const struct dirent *entry; (entry = readdir(folder));) {
        static char text[1 << 16];
        char path[512];
        if (!strstr(entry->d_name, ".glsl")) {
            continue;
        }
        snprintf(path, sizeof path, "%s/render/shaders/%s", CONUS_SOURCE_DIR, entry->d_name);
        FILE *file = fopen(path, "r");
        assert_non_null(file);
        text[fread(text, 1, sizeof text - 1, file)] = 0;
        assert_int_equal(fclose(file), 0);
        if (!shader_check_saw("", text)) {
            fail_msg("%s was never compiled", entry->d_name);
        }
        assert_both_values(text, entry->d_name);
        files++;
    }
    assert_int_equal(closedir(folder), 0);
    assert_true(files >= 12);
}

static void glslang_takes_every_program(void **state)
{
    (void)state;
    uint64_t random = 3;
    shader_check_begin();
    struct mesh box = mesh_scene_box((double[]){-9, -9, -9}, (double[]){9, 9, 9});
    conus_atlas *atlases[] = {scene_atlas(&random, 12, 1), mesh_scene_atlas(), tract_lines_atlas()};
    mesh_scene_add(atlases[1], &box);
    for (size_t i = 0; i < sizeof atlases / sizeof atlases[0]; i++) {
        make_engine_programs(atlases[i]);
        draw(atlases[i]);
        conus_atlas_destroy(atlases[i]);
    }
    make_picture_programs();
    assert_all_were_seen();
    assert_true(shader_check_end() >= 40);
}

TEST_GROUP(gl_shaders)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(glslang_finds_what_is_wrong),
        cmocka_unit_test(glslang_takes_every_program),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
