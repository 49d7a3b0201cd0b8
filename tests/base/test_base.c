/* SPDX-License-Identifier: BSD-3-Clause */
/* Text, numbers, arrays, files and 3-D maths of base/. */
#include "base/files/file.h"
#include "base/formats/encoding.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "base/text.h"
#include "base/threads.h"
#include "conus/own.h"
#include "test.h"

#include <fcntl.h>
#include <locale.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void lines_end_in_any_way(void **state)
{
    (void)state;
    struct text rest = text_from("a\nb\rc\r\n\nd");
    const char *const wanted[] = {"a", "b", "c", "", "d"};
    struct text line;
    for (size_t i = 0; i < 5; i++) {
        assert_true(text_line(&rest, &line));
        assert_true(text_equal(line, wanted[i]));
    }
    assert_false(text_line(&rest, &line));
}

static void empty_fields_are_fields(void **state)
{
    (void)state;
    struct text rest = text_from("a\t\tb\t");
    const char *const wanted[] = {"a", "", "b", ""};
    struct text field;
    bool more = true;
    for (size_t i = 0; i < 4; i++) {
        assert_true(text_field(&rest, '\t', &more, &field));
        assert_true(text_equal(field, wanted[i]));
    }
    assert_false(text_field(&rest, '\t', &more, &field));
}

/* Fields between quotation marks may hold separators and doubled marks. Wrong marks are reported, and no byte is
 * lost. */
static void quoted_fields_are_fields(void **state)
{
    (void)state;
    static const struct {
        const char *field;
        enum text_quotes quotes;
    } wanted[] = {{"a", TEXT_PLAIN},    {"b,c", TEXT_QUOTED}, {"", TEXT_QUOTED}, {"d \"\"e\"\"", TEXT_QUOTED},
                  {"f", TEXT_FOLLOWED}, {"5\"", TEXT_PLAIN},  {"", TEXT_PLAIN},  {"open, to the end", TEXT_UNCLOSED}};
    struct text rest = text_from(" a ,\"b,c\",  \"\"  ,\"d \"\"e\"\"\",\"f\"g,5\",,\"open, to the end");
    struct text field;
    enum text_quotes quotes;
    bool more = true;
    for (size_t i = 0; i < sizeof wanted / sizeof wanted[0]; i++) {
        assert_true(text_quoted_field(&rest, ',', &more, &field, &quotes));
        assert_true(text_equal(field, wanted[i].field));
        assert_int_equal(quotes, wanted[i].quotes);
    }
    assert_false(text_quoted_field(&rest, ',', &more, &field, &quotes));
    rest = text_from("\"\"\""); /* a doubled mark, and none that closes */
    more = true;
    assert_true(text_quoted_field(&rest, ',', &more, &field, &quotes));
    assert_int_equal(quotes, TEXT_UNCLOSED);
}

static void distances_ignore_case(void **state)
{
    (void)state;
    assert_int_equal(text_distance(text_from("thalmus"), text_from("Thalamus")), 1);
    assert_int_equal(text_distance(text_from("kitten"), text_from("SITTING")), 3);
    assert_int_equal(text_distance(text_from(""), text_from("abc")), 3);
    assert_int_equal(text_distance(text_from("abc"), text_from("")), 3);
    static const char many[300];
    assert_int_equal(text_distance((struct text){many, 255}, (struct text){many, 250}), 5);
    assert_int_equal(text_distance((struct text){many, 256}, (struct text){many, 1}), SIZE_MAX);
    assert_int_equal(text_distance((struct text){many, 1}, (struct text){many, 256}), SIZE_MAX);
    assert_true(text_contains(text_from("Frontal_Inf"), text_from("inf")));
    assert_true(text_contains(text_from("inf"), text_from("")));
    assert_false(text_contains(text_from("in"), text_from("inf")));
}

/* A number is the double that the C library reads, whatever its digits. */
static void numbers_are_read_to_the_bit(void **state)
{
    (void)state;
    uint64_t seed = 11;
    for (int k = 0; k < 200000; k++) {
        char text[64];
        double number;
        double value = test_random(&seed, -1, 1) * pow(10, floor(test_random(&seed, -3, 13)));
        snprintf(text, sizeof text, k % 3 ? "%.*f" : "%.*g", (int)test_random(&seed, 0, 18), value);
        assert_true(text_to_double(text_from(text), &number));
        double wanted = strtod(text, NULL);
        assert_memory_equal(&number, &wanted, sizeof number);
    }
    static const char *const forms[] = {
        "-0", "+5", ".5", "5.", "-.25", "007", "000000000000000000001", "0.1", "123456789012345"};
    for (size_t i = 0; i < sizeof forms / sizeof forms[0]; i++) {
        double number;
        double wanted = strtod(forms[i], NULL);
        assert_true(text_to_double(text_from(forms[i]), &number));
        assert_memory_equal(&number, &wanted, sizeof number);
    }
}

static void numbers_are_read_whole_or_not(void **state)
{
    (void)state;
    double number;
    uint64_t natural;
    int64_t integer;
    assert_true(text_to_double(text_from("-2.5e3"), &number));
    assert_near(number, -2500, 0);
    const char *const none[] = {"", ".", "-", "-.", " 1", "1 ", "1,5", "x", "1.5mm", "--1", "0x10", "0X1p3"};
    for (size_t i = 0; i < sizeof none / sizeof none[0]; i++) {
        assert_false(text_to_double(text_from(none[i]), &number));
    }
    assert_true(text_to_uint(text_from("4294967295"), UINT32_MAX, &natural));
    assert_false(text_to_uint(text_from("4294967296"), UINT32_MAX, &natural));
    assert_false(text_to_uint(text_from("18446744073709551616"), UINT64_MAX, &natural));
    assert_false(text_to_uint(text_from("-1"), 10, &natural));
    assert_true(text_to_int(text_from("-17"), &integer));
    assert_int_equal(integer, -17);
}

static void numbers_are_written_short_and_without_locale(void **state)
{
    (void)state;
    char out[TEXT_NUMBER_SIZE];
    setlocale(LC_ALL, "de_DE.UTF-8"); /* where installed, printf would write a comma */
    assert_string_equal(text_number(out, 0.1), "0.1");
    assert_string_equal(text_share(out, 0, 1), "0.0"); /* what is not nothing is not said to be */
    assert_string_equal(text_share(out, 0.0004, 1), "<0.1");
    assert_string_equal(text_share(out, 0.0006, 1), "0.1");
    assert_string_equal(text_share(out, 0.004, 0), "<1");
    assert_string_equal(text_share(out, 1, 1), "100.0");
    assert_string_equal(text_number(out, -0.0), "0");
    assert_string_equal(text_number(out, 25.5314207153), "25.5314207");
    assert_string_equal(text_number(out, 3e-20), "3e-20");
    assert_string_equal(text_number(out, 4294967295.0), "4294967295"); /* a label */
    assert_string_equal(text_number(out, 4294967295.5), "4.2949673e+09");
    assert_string_equal(text_number(out, 1e20), "1e+20");
    assert_string_equal(text_number(out, INFINITY), "inf");
    setlocale(LC_ALL, "C");
    uint64_t seed = 1;
    for (int i = 0; i < 1000; i++) {
        double value = exp(test_random(&seed, -40, 40));
        assert_near(strtod(text_number(out, value), NULL), value, 5e-9 * value);
    }
}

static void check_as_printf(double value)
{
    char wanted[TEXT_NUMBER_SIZE];
    char out[TEXT_NUMBER_SIZE];
    bool whole = fabs(value) < 0x1p53 && value == floor(value);
    int length = snprintf(wanted, sizeof wanted, "%.*g", whole ? 17 : 9, value == 0 ? 0.0 : value);
    assert_int_equal(text_number_length(out, value), length);
    assert_string_equal(out, wanted);
}

static void times_keep_15_digits(void **state)
{
    (void)state;
    char out[TEXT_NUMBER_SIZE];
    assert_string_equal(text_time(out, 1763619041.000125), "1763619041.00012"); /* the nearest double is below it */
    assert_string_equal(text_time(out, 0.1), "0.1");
    assert_string_equal(text_time(out, -0.0), "0");
    assert_string_equal(text_time(out, 1763619041), "1763619041");
    assert_string_equal(text_time(out, -2.5e-7), "-2.5e-07");
}

static void arrays_double(void **state)
{
    (void)state;
    void *array = NULL;
    size_t capacity = 0;
    size_t moves = 0;
    for (size_t count = 1; count <= 1000; count++) {
        size_t before = capacity;
        assert_true(memory_reserve(&array, &capacity, count, sizeof(int)));
        assert_true(capacity >= count);
        moves += capacity != before;
    }
    assert_true(moves <= 11);
    assert_false(memory_reserve(&array, &capacity, SIZE_MAX / 2, sizeof(int)));
    assert_true(array && capacity < 2000);
    memory_free(array);
}

static void numbers_are_written_as_printf_does(void **state)
{
    (void)state;
    uint64_t seed = 2;
    for (int i = 0; i < 200000; i++) {
        double value = exp(test_random(&seed, -12, 24));
        check_as_printf(value);
        check_as_printf(-value);
        check_as_printf(floor(value) / 1024); /* many are ties */
        check_as_printf(floor(value * 1e4) / 1e4);
    }
    for (int exponent = -6; exponent < 18; exponent++) {
        double power = pow(10, exponent);
        for (int i = -40; i <= 40; i++) {
            check_as_printf(power * (1 + i * 0x1p-52));
            check_as_printf(power * (1 + i * 1.25e-10)); /* 9 digits are rounded up to the next power */
        }
    }
    for (uint64_t n = 1; n < UINT64_MAX / 10; n *= 7) {
        struct buffer buffer = {0};
        char wanted[TEXT_NUMBER_SIZE];
        snprintf(wanted, sizeof wanted, "%llu", (unsigned long long)n);
        buffer_whole(&buffer, n);
        assert_string_equal(buffer.data, wanted);
        buffer_finish(&buffer);
    }
}

static void utf8_is_told_from_latin1(void **state)
{
    (void)state;
    assert_true(text_is_utf8(text_from("Gyrus \xc3\xa9 \xe2\x82\xac \xf0\x9f\xa7\xa0")));
    const char *const not [] = {"\xe9", "\xc3", "\xc0\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xe0\x80\x80"};
    for (size_t i = 0; i < sizeof not / sizeof not [0]; i++) {
        assert_false(text_is_utf8(text_from(not [i])));
    }
    for (size_t i = 0; i < 20; i++) { /* eight bytes are looked at together: a wrong one at each place */
        char text[] = "abcdefghijklmnopqrst";
        text[i] = '\xff';
        assert_false(text_is_utf8((struct text){text, 20}));
        assert_int_equal(text_is_utf8((struct text){text, i}), true);
    }
}

static void any_bytes_become_clean_utf8(void **state)
{
    (void)state;
    static const char *const pairs[][2] = {
        {"Br\xfc"
         "cke\t1\n",
         "Br\xc3\xbc"
         "cke 1 "},
        {"\xc3\xa9\x1b[31m", "\xc3\xa9 [31m"},
        /* Python's bytes.decode("cp1252").encode(): quotation mark, en dash, euro, and letters of ISO-8859-1. */
        {"Broca\x92s \x96 \x80\xe9\xff", "Broca\xe2\x80\x99s \xe2\x80\x93 \xe2\x82\xac\xc3\xa9\xc3\xbf"},
        {"\x8a\x9a\x8e\x9e\x8c\x9c\x9f", "\xc5\xa0\xc5\xa1\xc5\xbd\xc5\xbe\xc5\x92\xc5\x93\xc5\xb8"},
        {"a\x81", "a\xef\xbf\xbd"}, /* one of five bytes without a letter */
        /* U+009B is CSI of 8 bits, or what became of byte 0x9B, which is U+203A. U+202E, U+2066, U+2028: each turns or
           ends the line. Their neighbours U+00A0, U+2027, U+202F, U+2065 and U+206A do not. */
        {"a\xc2\x9b"
         "31m",
         "a\xe2\x80\xba"
         "31m"},
        {"\xe2\x80\xae\xe2\x81\xa6\xe2\x80\xa8\xe2\x81\xa9\xe2\x80\xac", "     "},
        {"\xc2\xa0\xe2\x80\xa7\xe2\x80\xaf\xe2\x81\xa5\xe2\x81\xaa",
         "\xc2\xa0\xe2\x80\xa7\xe2\x80\xaf\xe2\x81\xa5\xe2\x81\xaa"},
        {"", ""}};
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
        char *clean = text_to_utf8(text_from(pairs[i][0]));
        assert_string_equal(clean, pairs[i][1]);
        memory_free(clean);
    }
}

/* The right texts are Python's .decode("cp1252"), and where it is mixed .decode() of the rest. */
static void texts_are_utf8_or_windows_1252(void **state)
{
    (void)state;
    static const struct {
        const char *text, *decoded, *note;
    } texts[] = {
        {"1 a\n2 \xc3\xbc\n", NULL, NULL},
        {"1 Broca\x92s\n", "1 Broca\xe2\x80\x99s\n", "it is read as Windows-1252"},
        {"\n1 \xc3\xbc\n2 \xfc\x96\n", "\n1 \xc3\xbc\n2 \xc3\xbc\xe2\x80\x93\n", "line 3: a byte that is not UTF-8"},
        {"1 a\n2 \x8d\n", NULL, "line 2: byte 0x8D is of neither"},
        {"<?xml version=\"1.0\" encoding=\"windows-1252\"?><a>\x92</a>",
         "<?xml version=\"1.0\" encoding=\"UTF-8\"       ?><a>\xe2\x80\x99</a>", NULL},
        /* what it declares holds for letters that would be one of UTF-8, too */
        {" <?xml version='1.0' encoding='ISO-8859-1' ?><a>\xc3\xbc</a>",
         "<?xml version='1.0' encoding='UTF-8'      ?><a>\xc3\x83\xc2\xbc</a>", "letters are those of UTF-8, too"},
        {"<?xml encoding=\"latin1\"?><a>a</a>", "<?xml encoding=\"UTF-8\" ?><a>a</a>", NULL},
        {"<?xml encoding=\"UTF-8\"?><a>\xfc</a>", NULL, NULL}, /* expat's to refuse */
        {"<a>\x80</a>", "<a>\xe2\x82\xac</a>", "it is read as Windows-1252"},
        {"\xff\xfe<", NULL, NULL},
        {"", NULL, NULL},
    };
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        struct text text = text_from(texts[i].text);
        struct notes notes = {0};
        char *owned = NULL;
        bool refused = texts[i].note && !texts[i].decoded;
        conus_status status = encoding_decode(&owned, &text, &notes);
        assert_int_equal(status, refused ? CONUS_ERROR_DATA : CONUS_OK);
        assert_int_equal(!owned, !texts[i].decoded);
        if (owned) {
            assert_string_equal(owned, texts[i].decoded);
            assert_int_equal(text.size, strlen(owned));
        }
        assert_int_equal(notes.count, texts[i].note && !refused);
        const char *said = refused ? conus_message() : notes.count ? notes.lines[0] : NULL;
        assert_true(!said || strstr(said, texts[i].note));
        notes_finish(&notes);
        memory_free(owned);
    }
}

/* XML 1.0 has no characters below a space but tab and ends of lines, and neither U+FFFE nor U+FFFF. */
static void text_of_xml_has_what_xml_has(void **state)
{
    (void)state;
    struct buffer out = {0};
    buffer_xml(&out, "a<b>&\"\xc3\xbc\"\t\x01\x1b|\xef\xbf\xbe|\xef\xbf\xbf|\xef\xbf\xbd");
    assert_string_equal(out.data, "a&lt;b&gt;&amp;&quot;\xc3\xbc&quot;\t\xef\xbf\xbd\xef\xbf\xbd|\xef\xbf\xbd|"
                                  "\xef\xbf\xbd|\xef\xbf\xbd");
    buffer_finish(&out);
}

static void plain_text_steers_no_terminal(void **state)
{
    (void)state;
    char text[] = "one\ttwo\x1b]0;x\x07\n\xc2\x85three\xff\x80 \xe2\x80";
    conus_plain_text(text);
    assert_string_equal(text, "one\ttwo ]0;x \n three?? ??");
    char name[] = "a\tb\nc";
    text_make_plain(name, "");
    assert_string_equal(name, "a b c");
}

static void inverse_undoes_an_affine(void **state)
{
    (void)state;
    uint64_t seed = 2;
    for (int k = 0; k < 100; k++) {
        double m[16] = {0};
        double inverse[16] = {0};
        double product[16];
        for (int i = 0; i < 12; i++) {
            m[i / 3 * 4 + i % 3] = test_random(&seed, -3, 3);
        }
        m[15] = 1;
        if (fabs(mat4_determinant3(m)) < 0.1) {
            continue;
        }
        assert_true(mat4_invert_affine(inverse, m));
        mat4_multiply(product, inverse, m);
        for (int i = 0; i < 16; i++) {
            assert_near(product[i], i % 5 == 0, 1e-10);
        }
    }
    double flat[16] = {1, 0, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 0, 1};
    assert_false(mat4_invert_affine(flat, flat));
    flat[0] = NAN;
    assert_false(mat4_invert_affine(flat, flat));
    const double tiny[16] = {1e-310, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}; /* its inverse is infinite */
    assert_false(mat4_invert_affine(flat, tiny));
}

static void files_appear_whole(void **state)
{
    (void)state;
    const char *path = test_scratch("whole.txt");
    struct bytes bytes = {0};
    assert_ok(file_write(path, "one", 3));
    assert_ok(file_write(path, "three", 5));
    assert_ok(file_read(&bytes, path, 100));
    assert_int_equal(bytes.size, 5);
    assert_memory_equal(bytes.data, "three", 5);
    bytes_finish(&bytes);
    assert_fails(file_read(&bytes, path, 4), CONUS_ERROR_MEMORY);
    assert_fails(file_read(&bytes, "/nowhere/at all", 4), CONUS_ERROR_IO);
    assert_fails(file_read(&bytes, "/", 4), CONUS_ERROR_IO);
    assert_fails(file_write("/nowhere/at all", "x", 1), CONUS_ERROR_IO);
}

/* Called once, after the reader's next read(): it changes the file while it is being read. */
static void (*behind)(void);

ssize_t __real_pread(int descriptor, void *data, size_t size, off_t at);
ssize_t __wrap_pread(int descriptor, void *data, size_t size, off_t at);

ssize_t __wrap_pread(int descriptor, void *data, size_t size, off_t at)
{
    ssize_t got = __real_pread(descriptor, data, size, at);
    if (behind) {
        void (*now)(void) = behind;
        behind = NULL;
        now();
    }
    return got;
}

static char changed[256];

static void append_a_byte(void)
{
    FILE *file = fopen(changed, "a");
    assert_non_null(file);
    fputc('!', file);
    assert_int_equal(fclose(file), 0);
}

static void put_another_in_its_place(void)
{
    assert_ok(file_write(changed, "four!", 5));
}

static void changes_are_noticed(void **state)
{
    (void)state;
    struct bytes bytes = {0};
    struct file_state before;
    snprintf(changed, sizeof changed, "%s", test_scratch("changed.txt"));
    assert_ok(file_write(changed, "three", 5));
    assert_ok(file_state_find(&before, changed));
    assert_ok(file_state_check(&before, changed));
    behind = append_a_byte;
    assert_fails(file_read(&bytes, changed, 100), CONUS_ERROR_IO);
    assert_null(bytes.data);
    assert_non_null(strstr(conus_message(), "changed while it was read"));
    assert_fails(file_state_check(&before, changed), CONUS_ERROR_IO);
    assert_ok(file_state_find(&before, changed));
    behind = put_another_in_its_place; /* the file that was opened is read whole, or reading fails */
    if (!file_read(&bytes, changed, 100)) {
        assert_memory_equal(bytes.data, "three!", 6);
        bytes_finish(&bytes);
    }
    assert_fails(file_state_check(&before, changed), CONUS_ERROR_IO);
    assert_fails(file_state_find(&(struct file_state){0}, "/nowhere/at all"), CONUS_ERROR_IO);
}

enum { WRITERS = 8, WRITES = 50 };

static void *write_again_and_again(void *path)
{
    for (size_t i = 0; i < WRITES; i++) {
        if (file_write_soon(path, "whole", 5)) {
            return path;
        }
    }
    return NULL;
}

/* Leftovers with the names that this process or older versions would use, and other threads that write at the same
 * time, do no harm. */
static void writers_do_not_collide(void **state)
{
    (void)state;
    static char path[256];
    char left[300];
    pthread_t threads[WRITERS];
    snprintf(path, sizeof path, "%s", test_scratch("wanted.txt"));
    snprintf(left, sizeof left, "%s.%ld.part", path, (long)getpid());
    assert_ok(file_write(left, "left", 4));
    assert_ok(file_write(path, "one", 3));
    assert_int_equal(unlink(left), 0);
    for (size_t i = 0; i < WRITERS; i++) {
        assert_int_equal(pthread_create(&threads[i], NULL, write_again_and_again, path), 0);
    }
    for (size_t i = 0; i < WRITERS; i++) {
        void *failed = NULL;
        assert_int_equal(pthread_join(threads[i], &failed), 0);
        assert_null(failed);
    }
    struct bytes bytes = {0};
    assert_ok(file_read(&bytes, path, 100));
    assert_memory_equal(bytes.data, "whole", 5);
    bytes_finish(&bytes);
}

static void check_file(const char *path, const char *text)
{
    struct bytes bytes = {0};
    assert_ok(file_read(&bytes, path, 100));
    assert_int_equal(bytes.size, strlen(text));
    assert_memory_equal(bytes.data, text, bytes.size);
    bytes_finish(&bytes);
}

static void links_are_written_through(void **state)
{
    (void)state;
    const char *path = test_scratch("led-to.txt");
    const char *link = test_scratch("link.txt");
    struct stat info;
    assert_ok(file_write(path, "one", 3));
    assert_int_equal(symlink("led-to.txt", link), 0);
    assert_ok(file_write(link, "three", 5));
    check_file(path, "three");
    assert_fails(file_write_new(link, "four", 4), CONUS_ERROR_IO);
    assert_int_equal(unlink(path), 0);
    assert_fails(file_write(link, "two", 3), CONUS_ERROR_IO);
    assert_int_equal(lstat(link, &info), 0);
    assert_true(S_ISLNK(info.st_mode));
    assert_int_equal(unlink(link), 0);
}

static void open_files_are_written_to(void **state)
{
    (void)state;
    const char *path = test_scratch("open.txt");
    char open_file[64];
    assert_ok(file_write(path, "one, ", 5));
    int descriptor = open(path, O_WRONLY | O_CLOEXEC);
    assert_true(descriptor >= 0);
    snprintf(open_file, sizeof open_file, "/dev/fd/%d", descriptor);
    assert_ok(file_write(open_file, "two", 3));
    snprintf(open_file, sizeof open_file, "/proc/self/fd/%d", descriptor);
    assert_ok(file_write(open_file, ", three", 7)); /* it is appended, not written over the text before */
    close(descriptor);
    check_file(path, "one, two, three");
}

static void sha256_of_abc(void **state)
{
    (void)state;
    char hex[65];
    struct bytes abc = {(uint8_t *)"abc", 3}; /* FIPS 180-4 example */
    file_sha256(hex, &abc);
    assert_string_equal(hex, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

static conus_status build_text(void *data)
{
    (void)data;
    struct buffer buffer = {0};
    for (int i = 0; i < 100; i++) {
        buffer_format(&buffer, "%d,", i);
        buffer_number(&buffer, i / 7.0);
    }
    conus_status status = buffer_status(&buffer);
    if (!status) {
        assert_int_equal(strlen(buffer.data), buffer.size);
    }
    buffer_finish(&buffer);
    return status;
}

static void buffers_remember_failure(void **state)
{
    (void)state;
    test_every_allocation(build_text, NULL);
}

static void messages_are_one_line(void **state)
{
    (void)state;
    fail(CONUS_ERROR_DATA, "name \"%s\"", "a\nb\x1b[31m");
    fail_in(CONUS_ERROR_DATA, "file.nii");
    assert_string_equal(conus_message(), "file.nii: name \"a b [31m\"");
    fail(CONUS_ERROR_DATA, "%s",
         "\xc2\x9b"
         "2J\xe2\x80\xae"
         "fin.\xe2\x80\xac\xff");
    assert_string_equal(conus_message(), " 2J fin. ?");
    assert_null(memory_raw(SIZE_MAX, 2));
}

static void numbers_are_sorted_and_kept_once(void **state)
{
    (void)state;
    uint32_t numbers[] = {7, UINT32_MAX, 0, 7, 3, 0};
    const uint32_t wanted[] = {0, 3, 7, UINT32_MAX};
    assert_int_equal(u32_sort_unique(numbers, 6), 4);
    assert_memory_equal(numbers, wanted, sizeof wanted);
}

static void texts_are_compared_by_bytes(void **state)
{
    (void)state;
    assert_true(text_compare(text_from("a"), text_from("ab")) < 0);
    assert_true(text_compare(text_from("b"), text_from("ab")) > 0);
    assert_int_equal(text_compare(text_from("ab"), text_from("ab")), 0);
    assert_int_equal(text_compare((struct text){NULL, 0}, text_from("")), 0);
    assert_true(text_mentions(text_from("a label table"), "label"));
}

static void binary_bytes_are_not_readable(void **state)
{
    (void)state;
    assert_true(text_is_readable(text_from("a\tb\r\n\xe4")));
    assert_false(text_is_readable(text_from("a\x01")));
    assert_false(text_is_readable((struct text){"a\0b", 3}));
    assert_false(text_is_readable(text_from("")));
}

/* Each piece marks the items from its beginning to the next one's. */
struct dealt {
    size_t pieces, count, step;
    int marks[1000];
};

static void mark_piece(void *user, size_t piece)
{
    struct dealt *dealt = user;
    size_t begin = threads_begin(piece, dealt->pieces, dealt->count, dealt->step);
    size_t end = threads_begin(piece + 1, dealt->pieces, dealt->count, dealt->step);
    assert_true(begin % dealt->step == 0 || begin == dealt->count);
    for (size_t i = begin; i < end; i++) {
        dealt->marks[i]++;
    }
}

static void threads_do_each_item_once(void **state)
{
    (void)state;
    static const size_t counts[] = {0, 1, 7, 8, 9, 64, 999, 1000};
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
        for (size_t pieces = 1; pieces <= THREADS_MOST; pieces++) {
            for (size_t step = 1; step <= 64; step *= 8) {
                struct dealt dealt = {.pieces = pieces, .count = counts[i], .step = step};
                threads_run(mark_piece, &dealt, pieces);
                for (size_t k = 0; k < 1000; k++) {
                    assert_int_equal(dealt.marks[k], k < counts[i]);
                }
            }
        }
    }
    assert_int_equal(threads_for(0, 10), 1);
    assert_int_equal(threads_for(19, 10), 1);
    assert_in_range(threads_for(UINT64_MAX, 1), 1, THREADS_MOST);
    assert_in_range(threads_for(20, 10), 1, 2);
}

TEST_GROUP(base)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(threads_do_each_item_once),
        cmocka_unit_test(lines_end_in_any_way),
        cmocka_unit_test(empty_fields_are_fields),
        cmocka_unit_test(quoted_fields_are_fields),
        cmocka_unit_test(distances_ignore_case),
        cmocka_unit_test(numbers_are_read_to_the_bit),
        cmocka_unit_test(numbers_are_read_whole_or_not),
        cmocka_unit_test(numbers_are_written_short_and_without_locale),
        cmocka_unit_test(numbers_are_written_as_printf_does),
        cmocka_unit_test(times_keep_15_digits),
        cmocka_unit_test(arrays_double),
        cmocka_unit_test(utf8_is_told_from_latin1),
        cmocka_unit_test(any_bytes_become_clean_utf8),
        cmocka_unit_test(texts_are_utf8_or_windows_1252),
        cmocka_unit_test(text_of_xml_has_what_xml_has),
        cmocka_unit_test(plain_text_steers_no_terminal),
        cmocka_unit_test(inverse_undoes_an_affine),
        cmocka_unit_test(files_appear_whole),
        cmocka_unit_test(changes_are_noticed),
        cmocka_unit_test(writers_do_not_collide),
        cmocka_unit_test(links_are_written_through),
        cmocka_unit_test(open_files_are_written_to),
        cmocka_unit_test(sha256_of_abc),
        cmocka_unit_test(buffers_remember_failure),
        cmocka_unit_test(messages_are_one_line),
        cmocka_unit_test(numbers_are_sorted_and_kept_once),
        cmocka_unit_test(texts_are_compared_by_bytes),
        cmocka_unit_test(binary_bytes_are_not_readable),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
