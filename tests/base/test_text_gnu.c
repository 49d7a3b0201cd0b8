/* SPDX-License-Identifier: BSD-3-Clause */
/* Our own functions for text against those of GNU's C library, which are the references, on random cases. */
#include "base/text.h"
#include "test.h"

#include <fnmatch.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CASES = 200000, LENGTH = 12 };

static unsigned next_random(uint64_t *state) /* Knuth's MMIX */
{
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (unsigned)(*state >> 33);
}

/* Up to LENGTH - 1 bytes of `letters`. */
static size_t make_text(char out[LENGTH], uint64_t *state, const char *letters)
{
    size_t length = next_random(state) % LENGTH;
    for (size_t i = 0; i < length; i++) {
        out[i] = letters[next_random(state) % strlen(letters)];
    }
    out[length] = '\0';
    return length;
}

static void parts_are_found_as_by_memmem(void **state)
{
    (void)state;
    uint64_t seed = 1;
    size_t found = 0;
    for (size_t i = 0; i < CASES; i++) {
        char text[LENGTH];
        char part[LENGTH];
        size_t length = make_text(text, &seed, "aab");
        size_t size = next_random(&seed) % 4;
        (void)make_text(part, &seed, "ab");
        part[size] = '\0';
        size = strlen(part);
        const char *at = text_find((struct text){text, length}, part);
        assert_ptr_equal(at, memmem(text, length, part, size));
        found += at != NULL;
        assert_ptr_equal(text_last((struct text){text, length}, 'b'), memrchr(text, 'b', length));
    }
    assert_in_range(found, CASES / 4, CASES - CASES / 8);
    assert_null(text_find((struct text){0}, "a"));
    assert_null(text_last((struct text){0}, 'a'));
}

static void words_are_taken_as_by_strsep(void **state)
{
    (void)state;
    uint64_t seed = 2;
    for (size_t i = 0; i < CASES; i++) {
        char ours[LENGTH];
        char theirs[LENGTH];
        char *rest = ours;
        char *other = theirs;
        (void)make_text(ours, &seed, "ab ;");
        memcpy(theirs, ours, sizeof ours);
        for (char *word = ours; word;) {
            word = text_next(&rest, " ;");
            const char *wanted = strsep(&other, " ;");
            assert_int_equal(word == NULL, wanted == NULL);
            assert_true(!word || (word - ours == wanted - theirs && strcmp(word, wanted) == 0));
            assert_int_equal(rest == NULL, other == NULL);
        }
    }
}

static void copies_are_those_of_strndup(void **state)
{
    (void)state;
    uint64_t seed = 3;
    for (size_t i = 0; i < CASES; i++) {
        char text[LENGTH];
        (void)make_text(text, &seed, "abc");
        size_t most = next_random(&seed) % (2 * LENGTH);
        char *copy = text_copy(text, most);
        char *wanted = strndup(text, most);
        assert_string_equal(copy, wanted);
        free(copy);
        free(wanted);
    }
}

/* Patterns of all forms, whole and not: sets that have no end, and backslashes before anything. Those of collation,
 * "[." and "[=", are left out. */
static void names_match_as_by_fnmatch(void **state)
{
    (void)state;
    uint64_t seed = 4;
    size_t matched = 0;
    for (size_t i = 0; i < 5 * CASES; i++) {
        char name[LENGTH];
        char pattern[LENGTH];
        (void)make_text(name, &seed, "aAbBz-.!x^\\[]");
        name[next_random(&seed) % 7] = '\0';
        (void)make_text(pattern, &seed, "aAbz[]]!^-\\**?x");
        pattern[0] = pattern[0] && next_random(&seed) % 16 == 0 ? '.' : pattern[0];
        unsigned how = next_random(&seed) % 4;
        int flags = (how & TEXT_ANY_CASE ? FNM_CASEFOLD : 0) | (how & TEXT_NO_DOT ? FNM_PERIOD : 0);
        bool matches = text_matches(name, pattern, how);
        if (matches != (fnmatch(pattern, name, flags) == 0)) {
            fail_msg("\"%s\", pattern \"%s\", how %u", name, pattern, how);
        }
        matched += matches;
    }
    assert_true(matched > CASES / 20);
    for (int c = 1; c < 0x80; c++) { /* the classes of the C locale */
        static const char *const patterns[] = {
            "[[:alnum:]]", "[[:alpha:]]", "[[:blank:]]", "[[:cntrl:]]", "[[:digit:]]",  "[[:graph:]_]",  "[[:lower:]]",
            "[[:print:]]", "[[:punct:]]", "[[:space:]]", "[[:upper:]]", "[[:xdigit:]]", "[![:alpha:]-.]"};
        const char name[] = {(char)c, '\0'};
        for (size_t k = 0; k < sizeof patterns / sizeof patterns[0]; k++) {
            assert_int_equal(text_matches(name, patterns[k], 0), fnmatch(patterns[k], name, 0) == 0);
        }
    }
}

static void errors_have_the_words_of_strerror(void **state)
{
    (void)state;
    for (int error = 0; error < 140; error++) { /* Linux has 133 */
        char wanted[64];
        snprintf(wanted, sizeof wanted, "%s", strerror(error));
        assert_string_equal(text_error(error), wanted);
    }
}

TEST_GROUP(text_gnu)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_are_found_as_by_memmem),      cmocka_unit_test(words_are_taken_as_by_strsep),
        cmocka_unit_test(copies_are_those_of_strndup),       cmocka_unit_test(names_match_as_by_fnmatch),
        cmocka_unit_test(errors_have_the_words_of_strerror),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
