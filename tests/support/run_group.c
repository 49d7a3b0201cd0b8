/* SPDX-License-Identifier: BSD-3-Clause */
/* The program of one room's tests: test_ROOM --list | GROUP [PATTERN]. It runs the tests of a group whose names match
 * the pattern, in which * and ? stand for any text and any character. One process runs one group: groups change the
 * environment. */
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define GROUP(name) int test_group_##name(void);
#include "groups.h"
#undef GROUP

static const struct {
    const char *name;
    int (*run)(void);
} groups[] = {
#define GROUP(name) {#name, test_group_##name},
#include "groups.h"
};

int main(int argc, char **argv)
{
    const size_t count = sizeof groups / sizeof groups[0];
    if (argc == 2 && strcmp(argv[1], "--list") == 0) {
        for (size_t i = 0; i < count; i++) {
            puts(groups[i].name);
        }
        return EXIT_SUCCESS;
    }
    if (argc == 3) {
        cmocka_set_test_filter(argv[2]);
    }
    for (size_t i = 0; (argc == 2 || argc == 3) && i < count; i++) {
        if (strcmp(argv[1], groups[i].name) == 0) {
            return groups[i].run();
        }
    }
    fprintf(stderr, "usage: %s --list | GROUP [PATTERN]\n", argv[0]);
    return 2;
}
