/* SPDX-License-Identifier: BSD-3-Clause */
/* The page for choosing a file, without a window: its list, and the answer to Enter. */
#include "viewer/window/start.h"

#include "conus/own.h"
#include "sources/names.h"
#include "test.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* A folder of this run with: .hidden.nii, b.nii.gz, C.json, notes.docx and the folders A, z. */
static void make_folder(char out[SYSTEM_PATH])
{
    static const char *const files[] = {".hidden.nii", "b.nii.gz", "C.json", "notes.docx"};
    char here[512];
    char path[SYSTEM_PATH];
    assert_non_null(getcwd(here, sizeof here));
    assert_true(snprintf(out, SYSTEM_PATH, "%s/%s", here, test_scratch("folder")) < SYSTEM_PATH);
    mkdir(out, 0700);
    for (size_t i = 0; i < 6; i++) {
        bool is_folder = i >= 4;
        assert_true(snprintf(path, sizeof path, "%s/%s", out, is_folder ? (i == 4 ? "z" : "A") : files[i]) <
                    SYSTEM_PATH);
        if (is_folder) {
            mkdir(path, 0700);
        } else {
            assert_ok(conus_write_file(path, "", 0));
        }
    }
}

static void assert_lists(const struct folder *folder, const char *names)
{
    char found[256] = "";
    for (size_t i = 0; i < folder->count; i++) {
        size_t used = strlen(found);
        snprintf(found + used, sizeof found - used, "%s%s ", folder->entries[i].name,
                 folder->entries[i].is_folder ? "/" : "");
    }
    assert_string_equal(found, names);
}

static void a_folder_lists_what_can_be_opened(void **state)
{
    struct folder folder = {.count = 0};
    char path[SYSTEM_PATH];
    (void)state;
    make_folder(path);
    folder_read(&folder, path, FOLDER_OPENABLE);
    assert_lists(&folder, "A/ z/ b.nii.gz C.json ");
    folder_read(&folder, path, FOLDER_SESSIONS);
    assert_lists(&folder, "A/ z/ C.json ");
    folder_read(&folder, path, FOLDER_ALL);
    assert_lists(&folder, "A/ z/ b.nii.gz C.json notes.docx ");
    assert_false(folder.failed || folder.missing);
    folder_read(&folder, "/no such folder", FOLDER_ALL);
    assert_true(folder.failed && folder.missing);
    assert_lists(&folder, "");
    folder_finish(&folder);
    assert_true(folder_can_open("x.SURF.GII") && folder_can_open("a.obj.gz") && !folder_can_open("x.gz"));
    assert_true(folder_can_open("a.trk.gz") && folder_can_open("a.tck") && folder_can_open("a.TRX"));
    assert_true(folder_can_open("a.tt.gz") && !folder_can_open("a.btt"));
    for (const char *ending = NULL; (ending = ending_next(ending, ROLE_POSES));) { /* contacts, needles, coils */
        char name[32];
        snprintf(name, sizeof name, "needles%s", ending);
        assert_true(folder_can_open(name));
    }
    assert_true(folder_can_open("contacts.csv") && folder_can_open("COILS.TSV") && folder_can_open("coils.xml"));
    assert_true(folder_fits("Brodmann.nii", "bro") && !folder_fits("aal", "bro") && folder_fits("aal", ""));
}

static void show(struct dialog *dialog, enum dialog_purpose purpose, const char *folder, const char *name)
{
    static const struct start start = {.on = true};
    char text[SYSTEM_PATH];
    assert_true(snprintf(text, sizeof text, "%s/%s", folder, name) < SYSTEM_PATH);
    dialog_show(dialog, purpose, text, &start);
}

/* Asserts that Enter answers with that file of the folder. */
static void assert_answers(struct dialog *dialog, const char *folder, const char *name)
{
    char path[SYSTEM_PATH];
    assert_true(dialog_enter(path, dialog));
    assert_memory_equal(path, folder, strlen(folder));
    assert_string_equal(path + strlen(folder) + 1, name);
}

static void the_arrow_keys_go_into_a_folder_and_take_a_file(void **state)
{
    struct dialog dialog = {.on = false};
    char folder[SYSTEM_PATH];
    char path[SYSTEM_PATH];
    (void)state;
    make_folder(folder);
    show(&dialog, DIALOG_OPEN, folder, "");
    dialog_move(&dialog, 1); /* A */
    assert_false(dialog_enter(path, &dialog));
    assert_string_equal(dialog.text + strlen(folder), "/A/");
    assert_int_equal(dialog.folder.count, 0);
    dialog_leave(&dialog);
    assert_string_equal(dialog.text + strlen(folder), "/");
    dialog_move(&dialog, -1); /* C.json, the last */
    dialog_move(&dialog, -1);
    dialog_move(&dialog, 1);
    dialog_move(&dialog, 1); /* the list ends here */
    assert_answers(&dialog, folder, "C.json");
    show(&dialog, DIALOG_OPEN, folder, "nii");
    dialog_move(&dialog, 1); /* the first that fits */
    assert_answers(&dialog, folder, "b.nii.gz");
    dialog_finish(&dialog);
}

static void a_proposed_name_is_selected_and_no_folder(void **state)
{
    struct dialog dialog = {.on = false};
    char folder[SYSTEM_PATH];
    (void)state;
    make_folder(folder);
    show(&dialog, DIALOG_SAVE, folder, "aal-session.json");
    assert_true(dialog.is_set);
    assert_string_equal(dialog.text + dialog.selected, "aal-session.json");
    assert_int_equal(dialog.selected, strlen(folder) + 1);
    assert_string_equal(dialog.prefilled + strlen(folder), "/");
    dialog_complain(&dialog, "no");
    assert_int_equal(dialog.selected, 0); /* all of it */
    dialog_set(&dialog, folder);
    assert_true(dialog.selected > strlen(dialog.text)); /* nothing */
    dialog_finish(&dialog);
}

static void what_is_typed_is_a_path_or_a_part_of_one_name(void **state)
{
    struct dialog dialog = {.on = false};
    char folder[SYSTEM_PATH];
    char path[SYSTEM_PATH];
    (void)state;
    make_folder(folder);
    show(&dialog, DIALOG_OPEN, folder, "nii");
    assert_answers(&dialog, folder, "b.nii.gz"); /* the only one */
    show(&dialog, DIALOG_OPEN, folder, "notes.docx");
    assert_answers(&dialog, folder, "notes.docx"); /* whoever types it knows why */
    show(&dialog, DIALOG_OPEN, folder, "b.nii.gz,volume=2");
    assert_answers(&dialog, folder, "b.nii.gz,volume=2");
    show(&dialog, DIALOG_OPEN, folder, "none");
    assert_false(dialog_enter(path, &dialog));
    assert_non_null(strstr(dialog.why, "/none: there is no such file"));
    show(&dialog, DIALOG_OPEN, folder, "n"); /* b.nii.gz and C.json have one */
    assert_false(dialog_enter(path, &dialog));
    assert_non_null(strstr(dialog.why, "/n: there is no such file"));
    show(&dialog, DIALOG_OPEN, folder, "z"); /* a folder is gone to */
    assert_false(dialog_enter(path, &dialog));
    assert_string_equal(dialog.text + strlen(folder), "/z/");
    assert_string_equal(dialog.why, "");
    setenv("HOME", folder, 1);
    dialog_set(&dialog, "~/b.nii.gz");
    assert_answers(&dialog, folder, "b.nii.gz");
    dialog_finish(&dialog);
}

static void nothing_is_written_over_without_a_question(void **state)
{
    struct dialog dialog = {.on = false};
    char folder[SYSTEM_PATH];
    char path[SYSTEM_PATH];
    (void)state;
    make_folder(folder);
    show(&dialog, DIALOG_SAVE, folder, "new");
    assert_answers(&dialog, folder, "new.json");
    show(&dialog, DIALOG_SAVE, folder, "C");
    assert_false(dialog_enter(path, &dialog));
    assert_non_null(strstr(dialog.why, "/C.json: is there already"));
    show(&dialog, DIALOG_SAVE, folder, "C"); /* shown anew, it asks anew */
    assert_false(dialog_enter(path, &dialog));
    assert_answers(&dialog, folder, "C.json");
    show(&dialog, DIALOG_SAVE, folder, "C");
    assert_false(dialog_enter(path, &dialog));
    dialog_set(&dialog, dialog.folder.path); /* another text: the question is no longer answered */
    char again[SYSTEM_PATH + 8];
    snprintf(again, sizeof again, "%s/C.json", folder);
    dialog_set(&dialog, again);
    assert_false(dialog_enter(path, &dialog));
    show(&dialog, DIALOG_SAVE, folder, "");
    assert_false(dialog_enter(path, &dialog)); /* no name */
    dialog_finish(&dialog);
}

TEST_GROUP(dialog)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_folder_lists_what_can_be_opened),
        cmocka_unit_test(the_arrow_keys_go_into_a_folder_and_take_a_file),
        cmocka_unit_test(a_proposed_name_is_selected_and_no_folder),
        cmocka_unit_test(what_is_typed_is_a_path_or_a_part_of_one_name),
        cmocka_unit_test(nothing_is_written_over_without_a_question),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
