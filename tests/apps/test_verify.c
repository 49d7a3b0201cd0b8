/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of the parts of conus verify: command lines, sidecars, places of files, rows and settings. */
#include "cli/verify/differ.h"
#include "cli/verify/find_file.h"
#include "cli/verify/record.h"
#include "cli/verify/replay.h"
#include "options/messages.h"
#include "options/options.h"
#include "options/provenance.h"
#include "test.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void command_lines_come_back_as_they_were(void **state)
{
    (void)state;
    uint64_t random = 7;
    static const char letters[] = "a-/'\" \\$`\n=é%;*";
    for (int n = 0; n < 500; n++) {
        char texts[6][9];
        char program[] = "conus";
        char *words[7] = {program};
        const struct command command = {.name = "query"};
        struct arguments arguments = {
            .command = &command, .count = 1 + (int)test_random(&random, 0, 6), .words = words};
        for (int i = 1; i < arguments.count; i++) {
            size_t length = (size_t)test_random(&random, 0, 9);
            for (size_t k = 0; k < length; k++) {
                texts[i - 1][k] = letters[(size_t)test_random(&random, 0, sizeof letters - 1)];
            }
            texts[i - 1][length] = '\0';
            words[i] = texts[i - 1];
        }
        char *text = arguments_text(&arguments);
        struct command_line line;
        assert_null(command_line_parse(&line, text));
        assert_int_equal(line.count, arguments.count);
        for (int i = 0; i < arguments.count; i++) {
            assert_string_equal(line.words[i], words[i]);
        }
        assert_null(line.words[line.count]);
        command_line_finish(&line);
        free(text);
    }
}

static void shell_syntax_is_refused(void **state)
{
    (void)state;
    static const char *const bad[] = {
        "",           "conus ",      " conus",     "conus  query", "conus;ls",   "conus $HOME",
        "conus `ls`", "conus \"a\"", "conus 'a",   "conus 'a'b",   "conus a'b'", "conus 'a''b'",
        "conus\ta",   "conus\nls",   "conus a\\b", "conus a>b",    "conus a&",   "conus é"};
    struct command_line line;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_non_null(command_line_parse(&line, bad[i]));
        assert_null(line.words);
    }
    char many[2 * COMMAND_WORDS + 2];
    memset(many, 'a', sizeof many);
    for (size_t i = 1; i < sizeof many; i += 2) {
        many[i] = ' ';
    }
    many[2 * COMMAND_WORDS - 1] = '\0';
    assert_null(command_line_parse(&line, many)); /* 4096 words */
    command_line_finish(&line);
    many[2 * COMMAND_WORDS - 1] = ' ';
    many[2 * COMMAND_WORDS + 1] = '\0';
    assert_non_null(strstr(command_line_parse(&line, many), "4096"));
}

#define SUM(digit) digit digit digit digit digit digit digit digit
#define SHA(digit) SUM(digit) SUM(digit) SUM(digit) SUM(digit) SUM(digit) SUM(digit) SUM(digit) SUM(digit)

static const char good[] =
    "{\"GeneratedBy\": [{\"Name\": \"conus\", \"Version\": \"0.1.0\", \"CommandLine\": \"conus query 'a b.nii' -q\"}],"
    "\"Atlas\": {\"path\": \"a b.nii\", \"volumes\": [{\"path\": \"a b.nii\", \"sha256\": \"" SHA(
        "0") "\", \"bytes\": 12}],"
             "\"files\": [{\"path\": \"t.tsv\", \"sha256\": \"" SHA(
                 "a") "\"}, {\"path\": \"a b.nii\", \"sha256\": \"" SHA("0") "\"}]},"
                                                                             "\"Batch\": {\"shard\": [1, 3], "
                                                                             "\"bytes\": 7, \"crc32\": \"00c0ffee\", "
                                                                             "\"pose_file\": \"p.tsv\", "
                                                                             "\"pose_file_sha256\": \"" SHA(
                                                                                 "b") "\"},"
                                                                                      "\"Inputs\": [{\"path\": \"-\", "
                                                                                      "\"sha256\": null}],"
                                                                                      "\"Outputs\": [{\"option\": "
                                                                                      "\"output\", \"path\": "
                                                                                      "\"r.tsv\", \"bytes\": 3, "
                                                                                      "\"sha256\": \"" SHA("c") "\"}]}";

static void a_sidecar_is_read_whole(void **state)
{
    (void)state;
    struct record record;
    assert_null(record_parse(&record, good, strlen(good)));
    assert_string_equal(record.version, "0.1.0");
    assert_int_equal(record.line.count, 4);
    assert_string_equal(record.line.words[2], "a b.nii");
    assert_int_equal(record.input_count, 4); /* sorted, each once */
    assert_string_equal(record.inputs[0].path, "-");
    assert_null(record.inputs[0].sha256);
    assert_string_equal(record.inputs[1].path, "a b.nii");
    assert_int_equal(record.inputs[1].bytes, 12);
    assert_string_equal(record.inputs[2].path, "p.tsv");
    assert_string_equal(record.inputs[2].sha256, SHA("b"));
    assert_int_equal(record.inputs[3].bytes, -1);
    assert_int_equal(record.output_count, 2);
    assert_string_equal(record.outputs[0].path, "r.tsv");
    assert_int_equal(record.outputs[1].crc32, 0xc0ffee);
    assert_int_equal(record.outputs[1].bytes, 7);
    assert_int_equal(record.shard[0], 1);
    assert_int_equal(record.shard[1], 3);
    assert_true(record.has_inputs && !record.is_sealed);
    assert_string_equal(record_atlas(&record, 0), "a b.nii");
    assert_null(record_atlas(&record, 1));
    record_finish(&record);
}

/* Every prefix but the whole text is refused. */
static void no_prefix_of_a_sidecar_is_one(void **state)
{
    (void)state;
    struct record record;
    for (size_t size = 0; size < strlen(good); size++) {
        char *exact = malloc(size + 1); /* exact, so that reading past it is noticed */
        memcpy(exact, good, size);
        assert_non_null(record_parse(&record, exact, size));
        assert_null(record.root);
        free(exact);
    }
}

static void wrong_values_of_a_sidecar_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *from, *to, *why;
    } bad[] = {
        {"\"conus\"", "\"other\"", "not a sidecar"},
        {"\"Version\": \"0.1.0\"", "\"Version\": 1", "not a sidecar"},
        {"\"CommandLine\"", "\"commandLine\"", "the library or its Python package"},
        {"conus query", "conus;query", "is not quoted"},
        {SHA("a"), SHA("A"), "sha256: is not 64 digits"},
        {SHA("a"), "abc", "sha256: is not 64 digits"},
        {"\"bytes\": 12", "\"bytes\": -1", "bytes: is not a whole number"},
        {"\"bytes\": 12", "\"bytes\": 1.5", "bytes: is not a whole number"},
        {"\"path\": \"t.tsv\"", "\"path\": \"\"", "path: is no file's"},
        {"\"path\": \"t.tsv\"", "\"path\": 7", "path: is no file's"},
        {"{\"path\": \"t.tsv\", \"sha256\": \"" SHA("a"), "{\"path\": \"a b.nii\", \"sha256\": \"" SHA("a"),
         "two different SHA-256"},
        {"\"option\": \"output\", ", "", "option: is missing"},
        {"[1, 3]", "[3, 3]", "Batch: no shard"},
        {"[1, 3]", "[-1, 3]", "Batch: no shard"},
        {"00c0ffee", "00c0ffe", "Batch: no shard"},
        {SHA("b"), "b", "Batch: pose_file"},
        {"\"Inputs\":", "\"Atlas\":", "duplicate"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        char text[2 * sizeof good];
        const char *at = strstr(good, bad[i].from);
        struct record record;
        assert_non_null(at);
        snprintf(text, sizeof text, "%.*s%s%s", (int)(at - good), good, bad[i].to, at + strlen(bad[i].from));
        const char *why = record_parse(&record, text, strlen(text));
        if (!why || !strstr(why, bad[i].why)) {
            fail_msg("%s -> %s: %s", bad[i].from, bad[i].to, why ? why : "taken");
        }
    }
}

static void *take(size_t size)
{
    return malloc(size);
}

static void a_sidecar_is_read_or_refused_with_any_allocation_failing(void **state)
{
    (void)state;
    const char *bad = "";
    json_set_alloc_funcs(take, free); /* else jansson's would not fail */
    for (long n = 0; bad; n++) {
        struct record record;
        test_fail_allocation(n);
        bad = record_parse(&record, good, strlen(good));
        bool failed = test_allocation_failed();
        test_fail_allocation(-1);
        assert_true(bad ? failed && !record.root : !failed);
        if (!bad) {
            record_finish(&record);
        }
    }
    json_set_alloc_funcs(malloc, free);
}

/* A seal stays intact when foreign keys are added, and breaks when one of conus's is changed. */
static void a_seal_covers_the_keys_of_conus(void **state)
{
    (void)state;
    static const char *const changes[] = {"{\"TaskName\": \"rest\", \"rank\": 1}",
                                          "{\"Settings\": {\"layers\": \"all\"}}"};
    for (size_t i = 0; i < 2; i++) {
        struct record record;
        json_t *root = json_loads(good, 0, NULL);
        json_t *change = json_loads(changes[i], 0, NULL);
        assert_true(provenance_seal(root));
        json_object_update(root, change);
        char *text = json_dumps(root, JSON_INDENT(1));
        assert_null(record_parse(&record, text, strlen(text)));
        assert_true(record.is_sealed);
        assert_int_equal(record.is_intact, i == 0);
        record_finish(&record);
        free(text);
        json_decref(change);
        json_decref(root);
    }
}

static void the_folder_of_a_run_follows_from_a_path(void **state)
{
    (void)state;
    static const struct {
        const char *recorded, *actual, *base;
    } cases[] = {{"r.tsv", "r.tsv", ""},
                 {"r.tsv", "x/r.tsv", "x/"},
                 {"out/r.tsv", "out/r.tsv", ""},
                 {"out/r.tsv", "/a/out/r.tsv", "/a/"},
                 {"out/r.tsv", "/a/out/renamed.tsv", "/a/"},
                 {"out/r.tsv", "/a/b/r.tsv", NULL},
                 {"out/r.tsv", "/a/xout/r.tsv", NULL},
                 {"a/out/r.tsv", "out/r.tsv", NULL},
                 {"/abs/r.tsv", "/abs/r.tsv", NULL},
                 {NULL, "x/r.tsv", "x/"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char *base = base_folder(cases[i].recorded, cases[i].actual);
        assert_true((base == NULL) == (cases[i].base == NULL));
        if (base) {
            assert_string_equal(base, cases[i].base);
        }
        free(base);
    }
}

static void put_file(const char *path, const char *text)
{
    FILE *file = fopen(path, "we");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

/* Candidates: a file of the right length and name, one of another length, and the right one under another name. Links
 * are not followed. */
static void files_are_found_by_length_and_checksum(void **state)
{
    (void)state;
    char sum[SHA256_TEXT];
    struct places places = {0};
    struct found_file found;
    test_folder("places");
    mkdir(test_in("deep"), 0700);
    put_file(test_in("wanted"), "xyz");
    put_file(test_in("other"), "abcd");
    put_file(test_in("deep/renamed"), "abc");
    provenance_hash(sum, "abc", 3);
    const struct recorded_file wanted = {.path = "none/wanted", .sha256 = sum, .bytes = 3, .crc32 = -1};
    assert_true(file_find(&found, &wanted, &places));
    assert_int_equal(found.state, FILE_MISSING);
    assert_int_equal(places_add(&places, test_in("")), EXIT_DONE);
    assert_int_equal(places.candidate_count, 3);
    assert_true(file_find(&found, &wanted, &places));
    assert_int_equal(found.state, FILE_MOVED);
    assert_non_null(strstr(found.path, "/deep/renamed"));
    free(found.path);
    places_finish(&places);
    unlink(test_in("deep/renamed"));
    assert_int_equal(symlink(test_in("."), test_in("deep/circle")), 0);
    assert_int_equal(places_add(&places, test_in("")), EXIT_DONE);
    assert_int_equal(places.candidate_count, 2);
    places_finish(&places);
    messages_hold(true);
    assert_int_equal(places_add(&places, test_in("wanted")), EXIT_USAGE);
    assert_int_equal(places_add(&places, test_in("missing")), EXIT_DATA);
    messages_hold(false);
    const struct recorded_file changed = {.path = test_in("wanted"), .sha256 = sum, .bytes = 3, .crc32 = -1};
    assert_true(file_find(&found, &changed, &places));
    assert_int_equal(found.state, FILE_CHANGED);
    free(found.path);
}

/* A store of Zarr, recorded with a slash behind its name: the folder of the result, which has none such, is not it. */
static void a_folder_is_not_found_by_the_slash_behind_it(void **state)
{
    (void)state;
    char sum[SHA256_TEXT];
    struct found_file found;
    test_folder("slash");
    provenance_hash(sum, "abc", 3);
    const struct recorded_file store = {.path = "none/store.zarr/", .sha256 = sum, .bytes = -1, .crc32 = -1};
    assert_true(file_find(&found, &store, &(struct places){.beside = {test_in("rows.tsv")}}));
    assert_int_equal(found.state, FILE_MISSING);
}

/* Every path of a sidecar becomes a link below the staging folder. */
static void a_staging_folder_has_every_path(void **state)
{
    (void)state;
    test_folder("stage");
    put_file(test_in("file"), "abc");
    struct recorded_file inputs[] = {
        {.path = "../../x/../y/a"}, {.path = "../../x/b"}, {.path = "c"}, {.path = "/no/such/d"}};
    char *file = realpath(test_in("file"), NULL);
    struct found_file found[] = {
        {file, FILE_SAME, false}, {file, FILE_SAME, false}, {file, FILE_SAME, false}, {file, FILE_MOVED, false}};
    struct record record = {.inputs = inputs, .input_count = 4};
    struct stage stage;
    assert_true(stage_make(&stage, &record, found));
    assert_true(stage.is_moved);
    for (size_t i = 0; i < 4; i++) {
        char path[8192];
        bool absolute = inputs[i].path[0] == '/';
        char *word = stage_word(&stage, inputs[i].path);
        snprintf(path, sizeof path, "%s%s%s", absolute ? "" : stage.cwd, absolute ? "" : "/", word);
        char *real = realpath(path, NULL);
        assert_non_null(real);
        assert_string_equal(real + strlen(real) - strlen("/stage/file"), "/stage/file");
        char *slash = strrchr(path, '/');
        *slash = '\0';
        char *folder = realpath(path, NULL);
        assert_int_equal(strncmp(folder, stage.folder, strlen(stage.folder)), 0);
        free(folder);
        free(real);
        free(word);
    }
    char *output = stage_output(&stage, "output", "..");
    assert_non_null(strstr(output, "/out/output/rows"));
    free(output);
    char *word = stage_word(&stage, "FILE,from=/a,to=b");
    assert_non_null(strstr(word, "/root/a,to=b"));
    free(word);
    char gone[4096];
    snprintf(gone, sizeof gone, "%s", stage.folder);
    stage_finish(&stage);
    stage_remove(stage.folder);
    assert_int_equal(access(gone, F_OK), -1);
    assert_int_equal(access(file, F_OK), 0);
    free(file);
}

static bool has_links = true;

int __real_symlink(const char *target, const char *path);
int __wrap_symlink(const char *target, const char *path);

int __wrap_symlink(const char *target, const char *path)
{
    errno = EPERM; /* as of a disk of FAT */
    return has_links ? __real_symlink(target, path) : -1;
}

static void a_stage_without_links_has_copies(void **state)
{
    (void)state;
    char inner[8192];
    char text[8] = "";
    struct stat info;
    test_folder("copies");
    put_file(test_in("file"), "abc");
    assert_int_equal(mkdir(test_in("store"), 0755), 0);
    assert_int_equal(mkdir(test_in("store/deep"), 0755), 0);
    put_file(test_in("store/deep/chunk"), "of it");
    struct recorded_file inputs[] = {{.path = "x/file"}, {.path = "x/store"}, {.path = "x/store/deep/chunk"}};
    char *paths[] = {realpath(test_in("file"), NULL), realpath(test_in("store"), NULL),
                     realpath(test_in("store/deep/chunk"), NULL)};
    struct found_file found[] = {
        {paths[0], FILE_SAME, false}, {paths[1], FILE_UNSUMMED, true}, {paths[2], FILE_SAME, false}};
    struct record record = {.inputs = inputs, .input_count = 3};
    struct stage stage;
    has_links = false;
    assert_true(stage_make(&stage, &record, found));
    has_links = true;
    snprintf(inner, sizeof inner, "%s/x/store/deep/chunk", stage.cwd);
    assert_int_equal(lstat(inner, &info), 0);
    assert_true(S_ISREG(info.st_mode) && info.st_nlink == 1);
    FILE *chunk = fopen(inner, "r");
    assert_non_null(chunk);
    assert_int_equal(fread(text, 1, sizeof text, chunk), 5);
    assert_string_equal(text, "of it");
    fclose(chunk);
    stage_finish(&stage);
    stage_remove(stage.folder);
    assert_int_equal(access(inner, F_OK), -1);
    for (size_t i = 0; i < 3; i++) {
        assert_int_equal(access(paths[i], F_OK), 0);
        free(paths[i]);
    }
}

static void find(struct differences *out, const char *a, const char *b)
{
    assert_true(differences_find(out, a, strlen(a), b, strlen(b), 1));
}

static void the_cell_that_differs_is_named(void **state)
{
    (void)state;
    struct differences found;
    find(&found, "query\tname\tpixels\n1\tA\t5\n1\tB\t6\n", "query\tname\tpixels\n1\tA\t5\n1\tB\t7\n");
    assert_int_equal(found.count, 1);
    assert_int_equal(found.lines, 3);
    assert_int_equal(found.items[0].line, 3);
    assert_string_equal(found.items[0].where, "query 1, B: pixels");
    assert_string_equal(found.items[0].before, "6");
    assert_string_equal(found.items[0].after, "7");
    differences_finish(&found);
    find(&found, "query,name\r\n1,\"a, b\"\r\n", "query,name\r\n1,\"a, c\"\r\n");
    assert_int_equal(found.count, 1);
    assert_string_equal(found.items[0].before, "\"a, b\"\r");
    differences_finish(&found);
    /* In a table with tabs a quotation mark is a letter: the next tab ends the cell. */
    find(&found, "query\tname\tpixels\n1\t5\" A\t5\n", "query\tname\tpixels\n1\t5\" A\t6\n");
    assert_string_equal(found.items[0].where, "query 1, 5\" A: pixels");
    assert_string_equal(found.items[0].before, "5");
    assert_string_equal(found.items[0].after, "6");
    differences_finish(&found);
    find(&found, "a b\nc\n", "a b\n");
    assert_string_equal(found.items[0].before, "c");
    assert_null(found.items[0].after);
    differences_finish(&found);
    find(&found, "a\nb", "a\nb\n");
    assert_int_equal(found.count, 1);
    assert_int_equal(found.items[0].line, 2);
    assert_string_equal(found.items[0].before, "no line end");
    differences_finish(&found);
    find(&found, "", "");
    assert_int_equal(found.count, 0);
}

static void more_differences_than_are_listed_are_counted(void **state)
{
    (void)state;
    char a[200] = "";
    char b[200] = "";
    struct differences found;
    for (size_t i = 0; i < 25; i++) {
        memcpy(a + 2 * i, "x\n", 2);
        memcpy(b + 2 * i, "y\n", 2);
    }
    find(&found, a, b);
    assert_int_equal(found.count, 25);
    assert_int_equal(found.listed, DIFFERENCES);
    differences_finish(&found);
}

static void the_setting_that_differs_is_named(void **state)
{
    static const struct option options[] = {{.name = "image", .type = OPTION_TEXT, .flags = OPTION_IS_PICTURE},
                                            {.name = "output", .type = OPTION_TEXT},
                                            {0}};
    static const struct option_group groups[] = {{"", options, 0}, {0}};
    static const struct command command = {.name = "query", .groups = groups};
    const struct arguments arguments = {.command = &command};
    (void)state;
    static const struct {
        const char *a, *b, *said;
    } cases[] = {
        {"{\"Settings\": {\"resolution\": 16}}", "{\"Settings\": {\"resolution\": 32}}",
         "Settings.resolution is 16 there, and 32"},
        {"{\"Settings\": {\"engine\": \"rays, sse2\"}}", "{\"Settings\": {\"engine\": \"rays, avx2\"}}", NULL},
        {"{\"Settings\": {\"engine\": \"rays\"}}", "{\"Settings\": {\"engine\": \"gl, llvmpipe\"}}",
         "Settings.engine is \"rays\" there"},
        {"{\"Atlas\": {\"path\": \"a\", \"files\": [{\"sha256\": \"1\"}]}}",
         "{\"Atlas\": {\"path\": \"a\", \"files\": [{\"sha256\": \"2\"}]}}", "Atlas.files[0].sha256 is \"1\" there"},
        {"{\"Atlas\": {\"path\": \"a\"}}", "{\"Atlas\": {\"path\": \"b\"}}", "Atlas.path is \"a\" there"},
        {"{\"Queries\": [30, 0.1]}", "{\"Queries\": [30.0, 0.1]}", NULL},
        {"{\"Queries\": [0.1]}", "{\"Queries\": [0.10000000001]}", "Queries[0] is 0.1"},
        {"{\"a\": {\"Description\": \"1\", \"Units\": \"mm\"}}", "{\"a\": {\"Description\": \"1\"}}",
         "a.Units is \"mm\" there, and missing"},
        {"{\"a\": {\"Description\": \"1\", \"LongName\": \"b\"}}", "{\"a\": {\"Description\": \"1\"}}", NULL},
        {"{\"Settings\": {\"engine\": \"rays, {x}\"}}", "{\"Settings\": {\"engine\": \"rays, avx2\"}}",
         "Settings.engine is \"rays, {x}\" there"},
        {"{\"Settings\": {\"engine\": \"gl, another driver\"}}", "{\"Settings\": {\"engine\": \"gl, llvmpipe\"}}",
         NULL},
        {"{\"a\": {\"Description\": \"1\"}}", "{\"a\": {\"Description\": \"1\", \"Units\": \"mm\"}}",
         "a.Units is missing there, and \"mm\""},
        {"{\"a\": {\"Description\": \"1\"}}", "{\"a\": {\"Description\": \"2\"}}", "a.Description is \"1\" there"},
        {"{\"Labels\": {\"1\": \"A\", \"2\": \"B\"}}", "{\"Labels\": {\"1\": \"A\"}}", "Labels.2 is \"B\" there"},
        {"{\"TaskName\": \"rest\"}", "{}", NULL},
        {"{\"Sources\": []}", "{}", "Sources is [] there, and missing"},
        {"{\"GeneratedBy\": [{\"Name\": \"conus\", \"Version\": \"1\", \"CommandLine\": \"a\"}]}",
         "{\"GeneratedBy\": [{\"Name\": \"conus\", \"Version\": \"2\", \"CommandLine\": \"b\"}]}", NULL},
        {"{\"GeneratedBy\": [{\"Name\": \"conus\", \"Host\": \"1\"}]}", "{\"GeneratedBy\": [{\"Name\": \"conus\"}]}",
         "GeneratedBy[0].Host is \"1\" there"},
        {"{\"Outputs\": [{\"option\": \"image\", \"path\": null, \"bytes\": 1},"
         " {\"option\": \"output\", \"path\": null, \"bytes\": 1}]}",
         "{\"Outputs\": [{\"option\": \"image\", \"path\": null, \"bytes\": 2},"
         " {\"option\": \"output\", \"path\": null, \"bytes\": 2}]}",
         "Outputs[1].bytes is 1 there"},
        {"{}", "{\"Inputs\": []}", "Inputs is missing there"},
        {"{\"Queries\": [1]}", "{\"Queries\": [1, 2]}", "Queries[1] is missing there, and 2"},
        {"{\"Settings\": {}}", "{\"Settings\": {\"level\": \"1\"}}", "Settings.level is missing there"},
        {"{\"Settings\": {\"level\": \"1\"}}", "{}", "Settings is {\"level\":\"1\"} there, and missing"},
        {"{\"Checksum\": \"1\"}", "{}", NULL},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        json_t *a = json_loads(cases[i].a, 0, NULL);
        json_t *b = json_loads(cases[i].b, 0, NULL);
        char *said = NULL;
        assert_true(sidecars_differ(&said, a, b, &(struct sidecar_terms){.arguments = &arguments}));
        assert_true((said == NULL) == (cases[i].said == NULL));
        assert_true(!said || strstr(said, cases[i].said));
        free(said);
        json_decref(a);
        json_decref(b);
    }
}

/* Each term lets certain values differ, and no others. */
static void only_values_allowed_by_the_terms_may_differ(void **state)
{
    (void)state;
    static const struct {
        const char *a, *b;
        struct sidecar_terms terms;
        bool differs, differs_else;
    } cases[] = {
        {"{\"Settings\": {\"engine\": \"gl\"}}",
         "{\"Settings\": {\"engine\": \"rays\"}}",
         {.other_engine = true},
         false,
         true},
        {"{\"Settings\": {\"layers\": \"all\"}}",
         "{\"Settings\": {\"layers\": \"visible\"}}",
         {.other_engine = true, .older = true, .root = "/x"},
         true,
         true},
        {"{\"Batch\": {\"fingerprint\": \"1\"}}", "{\"Batch\": {\"fingerprint\": \"2\"}}", {.root = "/x"}, false, true},
        {"{\"Batch\": {\"fingerprint\": \"1\"}}",
         "{\"Batch\": {\"fingerprint\": \"2\"}}",
         {.older = true},
         false,
         true},
        {"{\"Batch\": {\"first\": 1}}", "{\"Batch\": {\"first\": 2}}", {.older = true, .root = "/x"}, true, true},
        {"{}", "{\"Inputs\": [], \"Outputs\": []}", {.older = true}, true, true},
        {"{\"Inputs\": [1]}", "{\"Inputs\": []}", {.older = true}, true, true},
        {"{\"Atlas\": {}}", "{\"Atlas\": {\"bytes\": 1}}", {.older = true}, true, true},
        {"{\"Atlas\": {\"bytes\": 2}}", "{\"Atlas\": {\"bytes\": 1}}", {.older = true}, true, true},
        {"{\"a\": {\"Description\": \"1\"}}", "{\"a\": {\"Description\": \"2\"}}", {.older = true}, true, true},
        {"{\"Atlas\": {\"path\": \"/a/b\", \"notes\": [\"in /a/b, /a\"]}}",
         "{\"Atlas\": {\"path\": \"/t/root/a/b\", \"notes\": [\"in /t/root/a/b, /t/root/a\"]}}",
         {.root = "/t/root"},
         false,
         true},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        json_t *a = json_loads(cases[i].a, 0, NULL);
        json_t *b = json_loads(cases[i].b, 0, NULL);
        char *said = NULL;
        assert_true(sidecars_differ(&said, a, b, &cases[i].terms));
        assert_true((said != NULL) == cases[i].differs);
        free(said);
        said = NULL;
        assert_true(sidecars_differ(&said, a, b, &(struct sidecar_terms){0}));
        assert_true((said != NULL) == cases[i].differs_else);
        free(said);
        json_decref(a);
        json_decref(b);
    }
}

TEST_GROUP(verify)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(command_lines_come_back_as_they_were),
        cmocka_unit_test(shell_syntax_is_refused),
        cmocka_unit_test(a_sidecar_is_read_whole),
        cmocka_unit_test(no_prefix_of_a_sidecar_is_one),
        cmocka_unit_test(wrong_values_of_a_sidecar_are_refused),
        cmocka_unit_test(a_sidecar_is_read_or_refused_with_any_allocation_failing),
        cmocka_unit_test(a_seal_covers_the_keys_of_conus),
        cmocka_unit_test(the_folder_of_a_run_follows_from_a_path),
        cmocka_unit_test(files_are_found_by_length_and_checksum),
        cmocka_unit_test(a_folder_is_not_found_by_the_slash_behind_it),
        cmocka_unit_test(a_staging_folder_has_every_path),
        cmocka_unit_test(a_stage_without_links_has_copies),
        cmocka_unit_test(the_cell_that_differs_is_named),
        cmocka_unit_test(more_differences_than_are_listed_are_counted),
        cmocka_unit_test(the_setting_that_differs_is_named),
        cmocka_unit_test(only_values_allowed_by_the_terms_may_differ),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
