/* SPDX-License-Identifier: BSD-3-Clause */
/* What base/system and base/path promise, asked on Windows: a program of its own, as there is no cmocka there.
 * tests/cli/windows.bats builds it and runs it in wine, in an empty folder. What is wanted is written by hand, from
 * system.h and from what Linux does. */
#include "base/path.h"
#include "base/system/system.h"
#include "base/text.h"

#include <errno.h>
#include <fcntl.h>
#include <io.h>
#include <string.h>

static int failures;

static void check(bool fine, const char *what, int line)
{
    if (!fine) {
        printf("line %d: %s (errno: %s)\n", line, what, text_error(errno));
        failures++;
    }
}
#define CHECK(fine) check(fine, #fine, __LINE__)

static bool note(void *user, const char *name)
{
    char *text = user;
    strncat(text, name, 200);
    strncat(text, " ", 2);
    return true;
}

static void check_paths(void)
{
    static const struct {
        const char *path, *base, *joint;
        size_t folder, plain;
        bool is_whole, is_name;
    } rows[] = {{"a\\b.nii", "b.nii", "/", 2, 7, false, false},
                {"C:\\a", "a", "/", 3, 4, true, false},
                {"C:/a/", "", "", 5, 4, true, false},
                {"C:a", "a", "/", 2, 3, true, false},
                {"C:", "", "", 2, 2, true, false},
                {"C:\\", "", "", 3, 3, true, false},
                {"\\\\s\\t\\a", "a", "/", 6, 7, true, false},
                {"a:b\\c", "c", "/", 4, 5, true, false},
                {"\\a\\", "", "", 3, 2, true, false},
                {"ab", "ab", "/", 0, 2, false, true}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const char *path = rows[i].path;
        bool fine = strcmp(path_base(path), rows[i].base) == 0 && path_folder_length(path) == rows[i].folder &&
                    path_plain_length(path, strlen(path)) == rows[i].plain &&
                    strcmp(path_joint(path, strlen(path)), rows[i].joint) == 0 &&
                    path_is_whole(path) == rows[i].is_whole && path_is_name(path) == rows[i].is_name;
        check(fine, path, __LINE__);
    }
    char folders[256] = "";
    char path[] = "C:\\a\\b/c";
    CHECK(path_each_folder(path, 1, note, folders) && strcmp(folders, "C:\\a C:\\a\\b ") == 0);
    CHECK(strcmp(path, "C:\\a\\b/c") == 0);
}

static void check_names_of_devices(void)
{
    static const char *const devices[] = {"NUL",  "nul",       "a/con",       "C:\\x\\aux", "COM1",
                                          "lpt9", "/dev/null", "/dev/stdout", "\\\\.\\NUL"};
    static const char *const files[] = {"null", "cone.tsv", "COM0", "COM", "com12", "conus", "/dev/x", "a\\nulls"};
    for (size_t i = 0; i < sizeof devices / sizeof devices[0]; i++) {
        check(system_is_open_name(devices[i]), devices[i], __LINE__);
    }
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        check(!system_is_open_name(files[i]), files[i], __LINE__);
    }
}

static void check_order_of_names(void)
{
    CHECK(system_name_order("rows.TSV", "ROWS.tsv") == 0);
    CHECK(system_name_order("\xc3\xa4", "\xc3\x84") == 0); /* ä, Ä */
    CHECK(system_name_order("a", "B") < 0 && system_name_order("b", "A") > 0 && system_name_order("a", "ab") < 0);
    CHECK(system_name_order("a", "\xff") < 0); /* no text, and no name */
}

static bool write_text(const char *path, const char *text, unsigned how)
{
    int file = system_open(path, SYSTEM_WRITE | how);
    bool written = file >= 0 && system_write(file, text, strlen(text));
    return (file < 0 || close(file) == 0) && written;
}

static bool has_text(int file, const char *text)
{
    char data[64] = "";
    ptrdiff_t size = system_read_at(file, data, sizeof data - 1, 0);
    return size == (ptrdiff_t)strlen(text) && strcmp(data, text) == 0;
}

static bool file_has(const char *path, const char *text)
{
    int file = system_open(path, SYSTEM_READ);
    bool same = file >= 0 && has_text(file, text);
    return (file < 0 || close(file) == 0) && same;
}

static void check_errors(void)
{
    struct system_stat info;
    CHECK(write_text("there", "12", SYSTEM_NEW));
    CHECK(system_make_folder("folder", false));
    CHECK(system_open("missing", SYSTEM_READ) < 0 && errno == ENOENT);
    CHECK(system_open("missing/a", SYSTEM_READ) < 0 && errno == ENOENT);
    CHECK(system_open("there/a", SYSTEM_READ) < 0 && errno == ENOTDIR);
    CHECK(!system_stat(&info, "there/a") && errno == ENOTDIR);
    CHECK(system_open("folder", SYSTEM_WRITE | SYSTEM_MAKE) < 0 && errno == EISDIR);
    CHECK(system_open("there", SYSTEM_WRITE | SYSTEM_NEW) < 0 && errno == EEXIST);
    CHECK(!system_make_folder("folder", true) && errno == EEXIST);
    CHECK(!system_rename("missing", "x", true) && errno == ENOENT);
    CHECK(!system_rename("there", "folder", true));
    CHECK(!system_remove("missing") && errno == ENOENT);
    CHECK(!system_list("missing", note, (char[8]){0}) && errno == ENOENT);
    /* Windows drops what ends a name, and a colon names a stream of a file; on Linux these are other names. */
    static const char *const others[] = {"there ", "there.", "./there..", "there:a", "folder\\a:b", "there::$DATA"};
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        bool is_refused = system_open(others[i], SYSTEM_READ) < 0 && errno == ENOENT &&
                          !write_text(others[i], "a", SYSTEM_NEW) && errno == ENOENT && !system_stat(&info, others[i]);
        check(is_refused, others[i], __LINE__);
    }
    CHECK(system_stat(&info, ".") && system_stat(&info, "folder/..") && file_has("./there", "12"));
    char name[300];
    snprintf(name, sizeof name, "folder/%0256d", 0);
    CHECK(system_open(name, SYSTEM_READ) < 0 && errno == ENAMETOOLONG);
    CHECK(system_open(name, SYSTEM_WRITE | SYSTEM_NEW) < 0 && errno == ENAMETOOLONG);
    CHECK(!system_stat(&info, name) && errno == ENAMETOOLONG);
    name[strlen(name) - 1] = '\0'; /* 255 characters are the most */
    CHECK(!system_stat(&info, name) && errno == ENOENT);
}

static void check_files(void)
{
    static const char name[] = "\xc3\xa4\xe8\x84\xb3.txt"; /* ä脳.txt */
    struct system_stat info;
    struct system_stat other;
    char names[256] = "";
    char real[SYSTEM_PATH];
    char here[SYSTEM_PATH];
    FILE *stream = system_stream(name, "wx");
    CHECK(stream && fputs("a\n", stream) >= 0 && fclose(stream) == 0);
    CHECK(system_list(".", note, names) && strstr(names, name) && strstr(names, ".. "));
    CHECK(system_stat_link(&info, name) && info.size == 2 && info.kind == SYSTEM_FILE);
    CHECK(system_stat(&other, name) && other.inode == info.inode && other.device == info.device && info.inode);
    CHECK(system_real_path(real, name) && system_here(here) && strncmp(real, here, strlen(here)) == 0);
    CHECK(strcmp(path_base(real), name) == 0 && !strchr(real, '\\'));
    CHECK(write_text(name, "b", SYSTEM_APPEND) && file_has(name, "a\nb"));
    CHECK(write_text(name, "c", SYSTEM_EMPTY) && file_has(name, "c"));

    int file = system_open(name, SYSTEM_READ | SYSTEM_WRITE);
    CHECK(system_write_at(file, "xyz", 3, 2) && lseek(file, 0, SEEK_CUR) == 0);
    CHECK(system_read_at(file, here, 10, 3) == 2 && memcmp(here, "yz", 2) == 0 && lseek(file, 0, SEEK_CUR) == 0);
    CHECK(system_read_at(file, here, 10, 9) == 0);
    int again = system_open(name, SYSTEM_READ);
    CHECK(system_write_at(file, "C", 1, 0));
    CHECK(system_read_at(again, here, 1, 0) == 1 && here[0] == 'C' && close(file) == 0);
    const char *memory = system_map(again, 5);
    CHECK(memory && memory[0] == 'C' && memory[4] == 'z');
    system_unmap(memory, 5);

    CHECK(write_text("new", "new", SYSTEM_NEW));
    CHECK(!system_rename("new", name, false) && errno == EEXIST);
    if (system_function("ntdll.dll", "wine_get_version")) { /* wine 8 does not rename over a file that is open */
        CHECK(!system_rename("new", name, true) && errno == EACCES && close(again) == 0);
        again = system_open("new", SYSTEM_READ);
        CHECK(system_rename("new", name, true) && file_has(name, "new"));
    } else {
        CHECK(system_rename("new", name, true) && file_has(name, "new"));
        CHECK(system_read_at(again, here, 1, 0) == 1 && here[0] == 'C'); /* which has what it had */
    }
    CHECK(close(again) == 0 && system_remove(name) && !system_stat(&info, name));

    char temporary[] = "t-XXXXXX.tsv";
    char second[] = "t-XXXXXX.tsv";
    CHECK((file = system_open_temporary(temporary, 4, true)) >= 0 && close(file) == 0);
    CHECK((file = system_open_temporary(second, 4, false)) >= 0 && close(file) == 0 && strcmp(temporary, second) != 0);
    CHECK(system_make_folder("private", true) && system_stat(&info, "private") && info.kind == SYSTEM_FOLDER);
}

/* Longer than the 260 characters of old programs. */
static void check_long_paths(void)
{
    char path[1024] = "";
    char names[256] = "";
    for (int i = 0; i < 9; i++) {
        snprintf(path + strlen(path), 64, "%s%040d", i ? i % 2 ? "\\" : "/" : "", i);
        check(system_make_folder(path, false), path, __LINE__);
    }
    char other[1024];
    size_t length = strlen(path);
    snprintf(other, sizeof other, "%s/b", path);
    memcpy(path + length, "/a", sizeof "/a");
    CHECK(write_text(path, "long", SYSTEM_NEW) && file_has(path, "long"));
    CHECK(system_rename(path, other, true) && !file_has(path, "long"));
    path[length] = '\0';
    CHECK(system_list(path, note, names) && strstr(names, "b "));
    CHECK(file_has(other, "long") && system_remove(other) && !file_has(other, "long"));
}

static void *wake_it(void *wake)
{
    system_wake(wake);
    return NULL;
}

static void check_the_rest(void)
{
    struct system_text text;
    struct system_wake wake;
    bool silent;
    pthread_t thread = 0;
    uint8_t random[2][16] = {{0}};
    FILE *stream = system_text_open(&text);
    CHECK(stream && fprintf(stream, "%s\n", "line") == 5 && system_text_close(&text) && text.size == 5 &&
          strcmp(text.data, "line\n") == 0);
    free(text.data);
    system_set_variable("CONUS_X", "\xc3\xa4");
    CHECK(system_variable("CONUS_X") && strcmp(system_variable("CONUS_X"), "\xc3\xa4") == 0);
    system_set_variable("CONUS_X", "C:\\a\\b");
    CHECK(strcmp(system_variable("CONUS_X"), "C:/a/b") == 0);
    CHECK(!system_variable("CONUS_NONE") && system_variable("HOME") && system_variable("TMPDIR"));
    CHECK(system_random(random, sizeof random) && memcmp(random[0], random[1], 16) != 0);
    CHECK(system_processors() >= 1 && system_function("kernel32.dll", "GetTickCount") &&
          !system_function("kernel32.dll", "none") && !system_function("none.dll", NULL));
    CHECK(!system_is_terminal(1) && !system_columns(1));
    int nothing = system_open("/dev/null", SYSTEM_WRITE);
    CHECK(nothing >= 0 && system_write(nothing, "x", 1) && !system_is_terminal(nothing) && close(nothing) == 0);
    CHECK(system_wake_begin(&wake) && system_thread(&thread, 0, wake_it, &wake));
    int ends[2] = {-1, -1};
    CHECK(_pipe(ends, 64, _O_BINARY) == 0 && !system_wait(ends[0], &wake, -1, &silent)); /* which stays silent */
    pthread_join(thread, NULL);
    system_wake_end(&wake);
    char *end;
    CHECK(system_to_double("1.5e3,", &end) == 1500 && *end == ',');
    system_forget_variables(); /* at the end: HOME and TMPDIR are gone, too */
    CHECK(!getenv("CONUS_X") && !getenv("PATH"));
}

int main(int count, char **words)
{
    system_begin(&count, &words, true);
    CHECK(count == 2 && strcmp(words[1], "\xc3\xa4 b\"c") == 0); /* ä b"c */
    check_paths();
    check_names_of_devices();
    check_order_of_names();
    check_errors();
    check_files();
    check_long_paths();
    check_the_rest();
    printf("%d failures\n", failures);
    return failures ? 1 : 0;
}
