/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of the parts of conus verify: command lines, sidecars, places of files, and values. */
#include "cli/verify/verify.h"
#include "conus/version.h"
#include "options/messages.h"
#include "options/options.h"
#include "options/output.h"
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
    assert_true(!record.is_sealed);
    assert_string_equal(record_atlas(&record, 0), "a b.nii");
    assert_null(record_atlas(&record, 1));
    record_finish(&record);
}

/* Of a pack, not the files that it was made of: these need not be there. Of two entries, that with a checksum. */
static void a_sidecar_names_each_file_once_and_no_file_in_a_pack(void **state)
{
    (void)state;
    static const char text[] = "{\"GeneratedBy\": [{\"Name\": \"conus\", \"Version\": \"0.1.0\", \"CommandLine\": "
                               "\"conus query p.conus\"}],"
                               "\"Atlas\": {\"path\": \"gone.nii\", \"pack\": {\"path\": \"p.conus\", \"sha256\": "
                               "\"" SHA("0") "\"}, \"volumes\": [{\"role\": \"parcellation\", \"path\": \"gone.nii\", "
                                             "\"sha256\": \"" SHA("1") "\"}, {\"role\": \"context\", \"path\": "
                                                                       "\"t1.nii\", \"sha256\": \"" SHA(
                                                                           "2") "\"}]}, \"Inputs\": [{\"path\": \"a\", "
                                                                                "\"sha256\": null}, {\"path\": \"a\", "
                                                                                "\"sha256\": \"" SHA("3") "\"}]}";
    struct record record;
    assert_null(record_parse(&record, text, strlen(text)));
    assert_int_equal(record.input_count, 2);
    assert_string_equal(record.inputs[0].sha256, SHA("3"));
    assert_string_equal(record.inputs[1].path, "p.conus");
    assert_string_equal(record_context(&record), "t1.nii");
    assert_int_equal(record.output_count, 0);
    record_finish(&record);
    assert_null(record_parse(&record, good, strlen(good)));
    assert_null(record_context(&record));
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
        {"\"Version\": \"0.1.0\"", "\"Version\": \"0.1-x\"", "Version: \"0.1-x\" is none of conus's"},
        {"\"Version\": \"0.1.0\"", "\"Version\": \"\"", "Version: \"\" is none of conus's"},
        {"\"CommandLine\"", "\"commandLine\"", "the library, its Python package or a page"},
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
        const char *recorded, *actual, *folder;
    } cases[] = {{"r.tsv", "r.tsv", ""},
                 {"r.tsv", "x/r.tsv", "x/"},
                 {"out/r.tsv", "out/r.tsv", ""},
                 {"out/r.tsv", "/a/out/r.tsv", "/a/"},
                 {"out/r.tsv", "/a/out/renamed.tsv", "/a/"},
                 {"out/r.tsv", "/a/b/r.tsv", ""},
                 {"out/r.tsv", "/a/xout/r.tsv", ""},
                 {"a/out/r.tsv", "out/r.tsv", ""},
                 {"/abs/r.tsv", "/abs/r.tsv", ""},
                 {NULL, "x/r.tsv", ""}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char *folder = recorded_folder(cases[i].recorded, cases[i].actual);
        assert_string_equal(folder, cases[i].folder);
        free(folder);
    }
}

static void put_file(const char *path, const char *text)
{
    FILE *file = fopen(path, "we");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

/* By its path, its name, and as any file with its bytes; nothing below the folder, and no link out of it, is looked at.
 */
static void files_are_found_by_their_path_name_and_checksum(void **state)
{
    (void)state;
    char sum[SHA256_TEXT];
    struct found_file found;
    test_folder("places");
    mkdir(test_in("a"), 0700);
    mkdir(test_in("a/deep"), 0700);
    mkdir(test_in("none"), 0700);
    provenance_hash(sum, "abc", 3);
    const struct recorded_file wanted = {.path = "/no/a/wanted", .sha256 = sum, .bytes = 3, .crc32 = -1};
    const struct recorded_file here = {.path = "a/wanted", .sha256 = sum, .bytes = 3, .crc32 = -1};
    const struct {
        const char *put;
        const char *text;
        const struct recorded_file *file;
        enum file_state state;
    } cases[] = {
        {"a/deep/wanted", "abc", &wanted, FILE_MISSING}, {"renamed", "abc", &wanted, FILE_MOVED},
        {"wanted", "abc", &wanted, FILE_MOVED},          {"wanted", "xyz", &wanted, FILE_MISSING},
        {"a/wanted", "abc", &wanted, FILE_MOVED},        {"a/wanted", "abc", &here, FILE_SAME},
        {"a/wanted", "xyz", &here, FILE_CHANGED},        {"none/wanted", "abc", &here, FILE_MISSING},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char folder[8192];
        snprintf(folder, sizeof folder, "%s/", test_in("."));
        put_file(test_in(cases[i].put), cases[i].text);
        assert_true(file_find(&found, cases[i].file, i % 2 ? folder : "none/", folder));
        assert_int_equal(found.state, cases[i].state);
        if (found.state < FILE_CHANGED) {
            assert_string_equal(found.path + strlen(found.path) - strlen(cases[i].put), cases[i].put);
        }
        free(found.path);
        unlink(test_in(cases[i].put));
    }
    /* That of another file of its length stays in mind, while one with its bytes is taken. */
    put_file(test_in("a/wanted"), "xyz");
    put_file(test_in("copy"), "abc");
    char folder[8192];
    snprintf(folder, sizeof folder, "%s/", test_in("."));
    assert_true(file_find(&found, &here, folder, NULL));
    assert_int_equal(found.state, FILE_MOVED);
    free(found.path);
}

/* The sidecar of "a.tsv" is "a.tsv.json", else "a.json"; JSON is its own. */
static void a_sidecar_is_found_beside_its_result(void **state)
{
    (void)state;
    static const struct {
        const char *put, *result, *found;
    } cases[] = {{NULL, "a.tsv", NULL},      {NULL, "b.json", NULL},       {"a.json", "a.tsv", "a.json"},
                 {NULL, "a.json", "a.json"}, {NULL, "a.nii.gz", "a.json"}, {NULL, "a.func.gii", "a.json"},
                 {NULL, "a.b.tsv", NULL},    {NULL, "a", "a.json"},        {"a.tsv.json", "a.tsv", "a.tsv.json"},
                 {NULL, "a.csv", "a.json"}};
    test_folder("beside");
    unlink(test_in("a.json"));
    unlink(test_in("a.tsv.json"));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        if (cases[i].put) {
            put_file(test_in(cases[i].put), good);
        }
        char *found = sidecar_find(test_in(cases[i].result));
        assert_true((found == NULL) == (cases[i].found == NULL));
        assert_string_equal(found ? found : "", cases[i].found ? test_in(cases[i].found) : "");
        free(found);
    }
    struct record record;
    assert_int_equal(record_read(&record, test_in("a.json")), EXIT_DONE);
    assert_string_equal(record.version, "0.1.0");
    record_finish(&record);
    put_file(test_in("a.json"), "[]");
    messages_hold(true);
    assert_int_equal(record_read(&record, test_in("a.json")), EXIT_DATA);
    assert_non_null(strstr(error_line(), "a.json: is no JSON object"));
    assert_int_equal(record_read(&record, test_in("none.json")), EXIT_DATA);
    assert_non_null(strstr(error_line(), "none.json: cannot open"));
    messages_hold(false);
}

/* A store of Zarr, recorded with a slash behind its name: the folder of the result, which has none such, is not it. */
static void a_folder_is_not_found_by_the_slash_behind_it(void **state)
{
    (void)state;
    char sum[SHA256_TEXT];
    struct found_file found;
    char folder[8192];
    test_folder("slash");
    provenance_hash(sum, "abc", 3);
    snprintf(folder, sizeof folder, "%s/", test_in("."));
    const struct recorded_file store = {.path = "none/store.zarr/", .sha256 = sum, .bytes = -1, .crc32 = -1};
    assert_true(file_find(&found, &store, folder, NULL));
    assert_int_equal(found.state, FILE_MISSING);
    mkdir(test_in("store.zarr"), 0700);
    assert_true(file_find(&found, &store, folder, NULL));
    assert_int_equal(found.state, FILE_MOVED);
    free(found.path);
}

/* Every path of a sidecar becomes a link below the stage's folder, or is refused. */
static void a_stage_has_every_path(void **state)
{
    (void)state;
    static const char *const paths[] = {"../../x/../y/a", "../../x/b", "c", "/no/such/d"};
    static const char *const bad[] = {"../../../a", "x/../../../../a", "/no/../a"};
    struct stage stage;
    test_folder("stage");
    put_file(test_in("file"), "abc");
    char *file = realpath(test_in("file"), NULL);
    assert_true(stage_begin(&stage, "verify", 4));
    for (size_t i = 0; i < sizeof paths / sizeof paths[0]; i++) {
        char path[8192];
        bool is_whole = paths[i][0] == '/';
        assert_true(stage_link(&stage, paths[i], file));
        char *word = stage_word(&stage, paths[i]);
        snprintf(path, sizeof path, "%s%s%s", is_whole ? "" : stage.cwd, is_whole ? "" : "/", word);
        char *real = realpath(path, NULL);
        assert_non_null(real);
        assert_string_equal(real, file);
        char *slash = strrchr(path, '/');
        *slash = '\0';
        char *folder = realpath(path, NULL);
        assert_int_equal(strncmp(folder, stage.folder, strlen(stage.folder)), 0);
        free(folder);
        free(real);
        free(word);
    }
    messages_hold(true);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_true(stage_link(&stage, bad[i], file) == (i == 0));
        assert_true(i == 0 || strstr(error_line(), "\"..\""));
    }
    messages_hold(false);
    char *output = stage_output(&stage, "output", "..");
    assert_non_null(strstr(output, "/out/output/rows"));
    free(output);
    char *word = stage_word(&stage, "FILE,from=/a,to=b");
    assert_non_null(strstr(word, "/root/a,to=b"));
    stage_leave(word, stage.folder);
    assert_string_equal(word, "FILE,from=/a,to=b");
    free(word);
    char drive[8192];
    snprintf(drive, sizeof drive, "in %s/drive/d/b, /t", stage.folder);
    stage_leave(drive, stage.folder);
    assert_string_equal(drive, "in d:/b, /t");
    char gone[4096];
    struct stat info;
    snprintf(gone, sizeof gone, "%s", stage.folder);
    assert_int_equal(stat(gone, &info), 0);
    assert_int_equal(info.st_mode & 0777, 0700);
    stage_end(&stage, false);
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
    static const char *const names[] = {"file", "store", "store/deep/chunk"};
    char inner[8192];
    char text[8] = "";
    struct stat info;
    struct stage stage;
    test_folder("copies");
    put_file(test_in("file"), "abc");
    assert_int_equal(mkdir(test_in("store"), 0755), 0);
    assert_int_equal(mkdir(test_in("store/deep"), 0755), 0);
    put_file(test_in("store/deep/chunk"), "of it");
    has_links = false;
    assert_true(stage_begin(&stage, "verify", 1));
    for (size_t i = 0; i < 3; i++) {
        char path[64];
        char *real = realpath(test_in(names[i]), NULL);
        snprintf(path, sizeof path, "x/%s", names[i]);
        assert_true(stage_link(&stage, path, real));
        free(real);
    }
    has_links = true;
    snprintf(inner, sizeof inner, "%s/x/store/deep/chunk", stage.cwd);
    assert_int_equal(lstat(inner, &info), 0);
    assert_true(S_ISREG(info.st_mode) && info.st_nlink == 1);
    FILE *chunk = fopen(inner, "r");
    assert_non_null(chunk);
    assert_int_equal(fread(text, 1, sizeof text, chunk), 5);
    assert_string_equal(text, "of it");
    fclose(chunk);
    stage_end(&stage, false);
    assert_int_equal(access(inner, F_OK), -1);
    for (size_t i = 0; i < 3; i++) {
        assert_int_equal(access(test_in(names[i]), F_OK), 0);
    }
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
        {"{\"Warnings\": [\"a\"]}", "{\"Warnings\": [\"b\"]}", "Warnings[0] is \"a\" there"},
        {"{\"Warnings\": [\"a\"]}", "{}", "Warnings is [\"a\"] there, and missing"},
        {"{}", "{\"Question\": {}}", "Question is missing there"},
        {"{\"Batch\": {\"fingerprint\": \"1\"}}", "{\"Batch\": {\"fingerprint\": \"2\"}}",
         "Batch.fingerprint is \"1\" there"},
        {"{\"Settings\": {}}", "{\"Settings\": {\"level\": \"1\"}}", "Settings.level is missing there"},
        {"{\"Question\": {\"options\": {\"angle\": \"10\"}}}", "{\"Question\": {\"options\": {}}}",
         "Question.options.angle is \"10\" there, and missing"}, /* a default is never recorded */
        {"{\"Settings\": {\"level\": \"1\"}}", "{}", "Settings is {\"level\":\"1\"} there, and missing"},
        {"{\"Checksum\": \"1\"}", "{}", NULL},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        json_t *a = json_loads(cases[i].a, 0, NULL);
        json_t *b = json_loads(cases[i].b, 0, NULL);
        char *said = NULL;
        struct record record = {.root = a, .version = CONUS_VERSION};
        assert_true(sidecars_differ(&said, b, &(struct replay){.record = &record, .arguments = arguments}));
        assert_true((said == NULL) == (cases[i].said == NULL));
        assert_true(!said || strstr(said, cases[i].said));
        free(said);
        json_decref(a);
        json_decref(b);
    }
}

/* A new answer lies in the stage. Its path is compared with that of the command line, its length and checksum only
 * where neither the command line nor a path is in the file. */
static void an_output_is_compared_by_the_path_that_was_asked_for(void **state)
{
    (void)state;
    static const struct option options[] = {{.name = "output", .type = OPTION_TEXT, .role = OPTION_WRITES_ROWS}, {0}};
    static const struct option_group groups[] = {{"", options, 0}, {0}};
    static const struct command command = {.name = "query", .groups = groups};
    static const struct {
        const char *asked, *written, *recorded, *said;
    } cases[] = {
        {"out/r.tsv", "/t/out/r.tsv", "\"path\": \"out/r.tsv\", \"bytes\": 1, \"sha256\": \"1\"", NULL},
        {"r.tsv", "/t/out/r.tsv", "\"path\": \"r.tsv\", \"bytes\": 1, \"sha256\": \"1\"", NULL},
        {"out/r.tsv", "/t/out/r.tsv", "\"path\": \"out/s.tsv\", \"bytes\": 1, \"sha256\": \"1\"",
         "Outputs[0].path is \"out/s.tsv\" there, and \"out/r.tsv\""},
        {"out/r.tsv", "/t/out/r.tsv", "\"path\": \"out/r.tsv\", \"bytes\": 2, \"sha256\": \"1\"",
         "Outputs[0].bytes is 2 there, and 1"},
        {"out/r.json", "/t/out/r.json", "\"path\": \"out/r.json\", \"bytes\": 2, \"sha256\": \"2\"", NULL},
        {"out/r.json", "/t/out/r.json", "\"path\": \"out/s.json\", \"bytes\": 2, \"sha256\": \"2\"",
         "Outputs[0].path is \"out/s.json\" there"},
        {"-", "/t/out/rows", "\"path\": null, \"sha256\": null", NULL},
        {"-", "/t/out/rows", "\"path\": \"rows\", \"sha256\": null", "Outputs[0].path is \"rows\" there, and null"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char recorded[256];
        char written[256];
        char *said = NULL;
        snprintf(recorded, sizeof recorded, "{\"Outputs\": [{\"option\": \"output\", %s}]}", cases[i].recorded);
        snprintf(written, sizeof written,
                 "{\"Outputs\": [{\"option\": \"output\", \"path\": \"%s\", \"bytes\": 1, \"sha256\": \"1\"}]}",
                 cases[i].written);
        struct option_use use = {.option = options, .value = cases[i].asked};
        json_t *b = json_loads(written, 0, NULL);
        struct record record = {.root = json_loads(recorded, 0, NULL), .version = CONUS_VERSION};
        struct replay replay = {.record = &record, .arguments = {.command = &command, .uses = &use, .use_count = 1}};
        assert_true(sidecars_differ(&said, b, &replay));
        assert_true((said == NULL) == (cases[i].said == NULL));
        assert_true(!said || strstr(said, cases[i].said));
        free(said);
        json_decref(record.root);
        json_decref(b);
    }
}

/* Of another version the fingerprint is another; where whole paths moved, they are as recorded. */
static void another_version_or_place_makes_no_other_value(void **state)
{
    (void)state;
    static const struct {
        const char *a, *b, *version;
        bool is_moved, differs;
    } cases[] = {
        {"{\"Batch\": {\"fingerprint\": \"1\"}}", "{\"Batch\": {\"fingerprint\": \"2\"}}", "0.0.1", false, false},
        {"{\"Batch\": {\"fingerprint\": \"1\"}}", "{\"Batch\": {\"fingerprint\": \"2\"}}", CONUS_VERSION, true, false},
        {"{\"Batch\": {\"first\": 1}}", "{\"Batch\": {\"first\": 2}}", "0.0.1", true, true},
        {"{}", "{\"Inputs\": [], \"Outputs\": []}", "0.0.1", false, true},
        {"{\"a\": {\"Description\": \"1\"}}", "{\"a\": {\"Description\": \"2\"}}", "0.0.1", false, true},
        {"{\"Atlas\": {\"path\": \"/a/b\", \"notes\": [\"in /a/b, /a\"]}}",
         "{\"Atlas\": {\"path\": \"/t/root/a/b\", \"notes\": [\"in /t/root/a/b, /t/root/a\"]}}", CONUS_VERSION, true,
         false},
        {"{\"Atlas\": {\"path\": \"/a/b\"}}", "{\"Atlas\": {\"path\": \"/t/root/a/b\"}}", CONUS_VERSION, false, true},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char folder[] = "/t";
        json_t *b = json_loads(cases[i].b, 0, NULL);
        char *said = NULL;
        struct record record = {.root = json_loads(cases[i].a, 0, NULL), .version = cases[i].version};
        assert_true(sidecars_differ(
            &said, b, &(struct replay){.record = &record, .is_moved = cases[i].is_moved, .stage = {.folder = folder}}));
        assert_true((said != NULL) == cases[i].differs);
        free(said);
        json_decref(record.root);
        json_decref(b);
    }
}

TEST_GROUP(verify)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(command_lines_come_back_as_they_were),
        cmocka_unit_test(shell_syntax_is_refused),
        cmocka_unit_test(a_sidecar_is_read_whole),
        cmocka_unit_test(a_sidecar_names_each_file_once_and_no_file_in_a_pack),
        cmocka_unit_test(no_prefix_of_a_sidecar_is_one),
        cmocka_unit_test(wrong_values_of_a_sidecar_are_refused),
        cmocka_unit_test(a_sidecar_is_read_or_refused_with_any_allocation_failing),
        cmocka_unit_test(a_seal_covers_the_keys_of_conus),
        cmocka_unit_test(the_folder_of_a_run_follows_from_a_path),
        cmocka_unit_test(files_are_found_by_their_path_name_and_checksum),
        cmocka_unit_test(a_sidecar_is_found_beside_its_result),
        cmocka_unit_test(a_folder_is_not_found_by_the_slash_behind_it),
        cmocka_unit_test(a_stage_has_every_path),
        cmocka_unit_test(a_stage_without_links_has_copies),
        cmocka_unit_test(the_setting_that_differs_is_named),
        cmocka_unit_test(an_output_is_compared_by_the_path_that_was_asked_for),
        cmocka_unit_test(another_version_or_place_makes_no_other_value),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
