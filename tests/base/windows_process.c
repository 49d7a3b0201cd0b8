/* SPDX-License-Identifier: BSD-3-Clause */
/* What base/child/child.h promises, asked on Windows by a program that starts itself. tests/cli/windows.bats builds
 * it and runs it in wine, which knows no limits of memory and time. What is wanted is what tests/loaders/extraction and
 * tests/base/test_hdf5_child.c want on Linux. */
#include "base/child/child.h"
#include "base/system/system.h"

#include <errno.h>
#include <math.h>
#include <string.h>

enum { MUCH = 600000 };

static int failures;

static void check(bool fine, const char *what, int line)
{
    if (!fine) {
        printf("line %d: %s (errno: %d)\n", line, what, errno);
        failures++;
    }
}
#define CHECK(fine) check(fine, #fine, __LINE__)

/* What the program is when it is started by itself. */
static int play(int count, char **words)
{
    char text[SYSTEM_PATH] = "";
    if (strcmp(words[1], "say") == 0) {
        for (int i = 2; i < count; i++) {
            printf("[%s]", words[i]);
        }
        ptrdiff_t given = read(3, text, 64);
        ptrdiff_t empty = read(0, text + 64, 64);
        printf(" %d %s %d", (int)given, text, (int)empty);
        fputs("words", stderr);
        return 7;
    }
    if (strcmp(words[1], "much") == 0) {
        setvbuf(stderr, NULL, _IOFBF, BUFSIZ);
        for (size_t i = 0; i < MUCH; i++) {
            fputc('x', i % 3 ? stdout : stderr);
        }
    }
    if (strcmp(words[1], "wait") == 0) {
        const struct timespec minute = {.tv_sec = 60};
        nanosleep(&minute, NULL);
    }
    if (strcmp(words[1], "crash") == 0) {
        *(volatile int *)(uintptr_t)(count - 2) = 1; /* at 0 */
    }
    return 0;
}

struct answer {
    char text[2][200]; /* the beginnings */
    size_t sizes[2];
    enum process_reading reading;
    struct process_end end;
    bool begun;
};

static const struct process_limits limits = {.space = UINT64_MAX, .seconds = 60};

static struct answer ask(char *const *words, int given, double seconds)
{
    struct answer answer = {0};
    char program[SYSTEM_PATH];
    char data[2][1000];
    struct process process;
    struct process_part parts[2] = {{data[0], sizeof data[0], 0}, {data[1], sizeof data[1], 0}};
    const struct process_start start = {.path = program, .words = words, .given = given, .limits = &limits};
    answer.begun = system_program(program) && process_begin(&process, &start);
    while (answer.begun && process_writes(&process) &&
           (answer.reading = process_read(parts, &process, seconds)) == PROCESS_CAME) {
        for (int i = 0; i < 2; i++) {
            for (size_t k = 0; k < parts[i].got; k++) {
                if (answer.sizes[i]++ < sizeof answer.text[i] - 1) {
                    answer.text[i][answer.sizes[i] - 1] = data[i][k];
                }
            }
        }
    }
    if (answer.begun && answer.reading == PROCESS_CAME) {
        CHECK(process_wait(&answer.end, &process, seconds));
    }
    if (answer.begun) {
        process_finish(&process);
    }
    return answer;
}

static char self[] = "conus";

static void check_words(void)
{
    char *words[] = {self, "say", "", "a b", "q\"u\"", "b\\s\\", "e\\\\\"x", "t \\", "\xc3\xa4\xe8\x84\xb3", NULL};
    int file = system_open_scratch("input");
    CHECK(file >= 0 && system_write(file, "given", 5) && lseek(file, 0, SEEK_SET) == 0);
    struct answer answer = ask(words, file, INFINITY);
    CHECK(answer.begun && answer.end.kind == PROCESS_EXITED && answer.end.code == 7);
    CHECK(strcmp(answer.text[0], "[][a b][q\"u\"][b\\s\\][e\\\\\"x][t \\][\xc3\xa4\xe8\x84\xb3] 5 given 0") == 0);
    CHECK(strcmp(answer.text[1], "words") == 0);
    CHECK(close(file) == 0);
    answer = ask((char *[]){self, "say", NULL}, SYSTEM_NO_FILE, INFINITY);
    CHECK(answer.begun && strcmp(answer.text[0], " -1  0") == 0);
}

int main(int count, char **words)
{
    struct process process;
    char *none[] = {self, NULL};
    system_begin(&count, &words, true);
    if (count > 1) {
        return play(count, words);
    }
    check_words();
    struct answer answer = ask((char *[]){self, "much", NULL}, SYSTEM_NO_FILE, INFINITY);
    CHECK(answer.end.kind == PROCESS_EXITED && answer.sizes[0] == MUCH / 3 * 2 && answer.sizes[1] == MUCH / 3);
    answer = ask((char *[]){self, "wait", NULL}, SYSTEM_NO_FILE, 0.1);
    CHECK(answer.begun && answer.reading == PROCESS_LATE);
    answer = ask((char *[]){self, "crash", NULL}, SYSTEM_NO_FILE, INFINITY);
    CHECK(answer.end.kind == PROCESS_CRASHED && strcmp(answer.end.how, "exception c0000005") == 0);
    CHECK(strncmp(answer.text[1], "conus: ended by exception c0000005\n", 35) == 0); /* then wine's own words */
    CHECK(!process_begin(&process,
                         &(struct process_start){.path = "none.exe", .words = none, .given = -1, .limits = &limits}) &&
          errno == ENOENT);
    printf("%d failures\n", failures);
    return failures ? 1 : 0;
}
