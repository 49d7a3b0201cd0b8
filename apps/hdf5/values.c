/* SPDX-License-Identifier: BSD-3-Clause */
/* From datasets and attributes to frames: what they are, whether they may be read, and their elements. */
#include "conus_hdf5.h"

#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A dataset or an attribute that is open. */
struct source {
    struct description what;
    const char *path; /* of the object */
    hid_t object, type, space;
    bool is_attribute;
    size_t count;
};

/* How the elements come into memory. */
enum form { FORM_NUMBERS, FORM_FIXED, FORM_VARIABLE, FORM_LETTERS, FORM_NONE };

static _Noreturn void refuse_source(const struct source *source, const char *action)
{
    char where[600];
    snprintf(where, sizeof where, source->is_attribute ? "%.400s, attribute %.150s" : "%.400s", source->path,
             source->what.name);
    refuse_damaged(where, action);
}

static void *allocate(const struct source *source, size_t count, size_t size)
{
    bool fits = count <= stream_left() / size;
    memory_allow(fits ? count * size : 0);
    void *memory = fits ? calloc(count ? count : 1, size) : NULL;
    if (!memory) {
        refuse(true, "%s: %zu elements of %zu bytes, allowed are %llu bytes (--max-memory)", source->path, count, size,
               (unsigned long long)stream_left());
    }
    return memory;
}

/* Whole numbers of 1, 2, 4 and 8 bytes. */
static hid_t whole_type(size_t size, bool is_signed)
{
    switch (size) {
    case 1:
        return is_signed ? H5T_STD_I8LE : H5T_STD_U8LE;
    case 2:
        return is_signed ? H5T_STD_I16LE : H5T_STD_U16LE;
    case 4:
        return is_signed ? H5T_STD_I32LE : H5T_STD_U32LE;
    case 8:
        return is_signed ? H5T_STD_I64LE : H5T_STD_U64LE;
    default:
        return -1;
    }
}

/* Sets class and size by a type of whole numbers, or of their enumeration. */
static hid_t describe_whole(struct description *what, hid_t type)
{
    size_t size = H5Tget_size(type);
    hid_t base = H5Tget_class(type) == H5T_ENUM ? H5Tget_super(type) : type;
    bool is_signed = H5Tget_sign(base) == H5T_SGN_2;
    hid_t memory = whole_type(size, is_signed);
    what->class = memory < 0 ? HDF5_OTHER : is_signed ? HDF5_SIGNED : HDF5_UNSIGNED;
    what->size = memory < 0 ? 0 : (uint32_t)size;
    return memory;
}

/* Strings of one letter each, in sequences: MATLAB writes names of fields so. */
static bool is_letters(hid_t type)
{
    hid_t letter = H5Tget_super(type);
    return H5Tget_class(letter) == H5T_STRING && H5Tis_variable_str(letter) == 0 && H5Tget_size(letter) == 1;
}

/* Sets class and size, and the type in memory where there is one. */
static enum form describe_type(struct description *what, hid_t *memory, hid_t type)
{
    size_t size = H5Tget_size(type);
    what->class = HDF5_OTHER;
    switch (H5Tget_class(type)) {
    case H5T_INTEGER:
    case H5T_ENUM:
        *memory = describe_whole(what, type);
        return what->class == HDF5_OTHER ? FORM_NONE : FORM_NUMBERS;
    case H5T_FLOAT:
        what->class = HDF5_FLOAT;
        what->size = size <= 4 ? 4 : 8;
        *memory = size <= 4 ? H5T_IEEE_F32LE : H5T_IEEE_F64LE;
        return FORM_NUMBERS;
    case H5T_STRING:
        what->class = HDF5_STRING;
        *memory = type;
        return H5Tis_variable_str(type) > 0 ? FORM_VARIABLE : FORM_FIXED;
    case H5T_VLEN:
        what->class = is_letters(type) ? HDF5_STRING : HDF5_OTHER;
        *memory = type;
        return what->class == HDF5_STRING ? FORM_LETTERS : FORM_NONE;
    case H5T_REFERENCE:
        if (H5Tequal(type, H5T_STD_REF_OBJ) > 0) {
            what->class = HDF5_REFERENCE;
            what->size = 8;
            *memory = type;
            return FORM_NUMBERS;
        }
        return FORM_NONE;
    default:
        return FORM_NONE;
    }
}

static void describe_space(struct source *source)
{
    hsize_t dims[H5S_MAX_RANK];
    H5S_class_t class = H5Sget_simple_extent_type(source->space);
    int rank = class == H5S_SCALAR ? 0 : class == H5S_NULL ? 1 : H5Sget_simple_extent_dims(source->space, dims, NULL);
    if (rank < 0) {
        refuse_source(source, "read its shape");
    }
    if (rank > HDF5_RANK_LIMIT) {
        refuse(false, "%s: %d dimensions, up to %d are read", source->path, rank, HDF5_RANK_LIMIT);
    }
    source->what.rank = (uint32_t)rank;
    source->count = 1;
    for (int i = 0; i < rank; i++) {
        source->what.dims[i] = class == H5S_NULL ? 0 : dims[i];
        if (__builtin_mul_overflow(source->count, source->what.dims[i], &source->count)) {
            refuse(true, "%s: more elements than a number of 64 bits counts", source->path);
        }
    }
}

static void read_into(const struct source *source, void *out, hid_t memory, hid_t transfer)
{
    herr_t read = !source->count         ? 0
                  : source->is_attribute ? H5Aread(source->object, memory, out)
                                         : H5Dread(source->object, memory, H5S_ALL, H5S_ALL, transfer, out);
    if (read < 0) {
        refuse_source(source, "read it");
    }
}

static void write_numbers(const struct source *source, hid_t memory)
{
    size_t size = source->what.size;
    void *data = allocate(source, source->count, size);
    read_into(source, data, memory, H5P_DEFAULT);
    stream_frame(&source->what, (uint64_t)source->count * size);
    stream_data(data, source->count * size);
    stream_pad((uint64_t)source->count * size);
    free(data);
}

/* A string that someone else owns. */
struct piece {
    const char *data;
    size_t size;
};

static void write_pieces(const struct source *source, const struct piece *pieces)
{
    uint64_t *begins = allocate(source, source->count + 1, sizeof *begins);
    for (size_t i = 0; i < source->count; i++) {
        begins[i + 1] = begins[i] + pieces[i].size;
    }
    uint64_t size = 8 * ((uint64_t)source->count + 1) + begins[source->count];
    stream_frame(&source->what, size);
    for (size_t i = 0; i <= source->count; i++) {
        uint8_t bytes[8];
        for (int b = 0; b < 8; b++) {
            bytes[b] = (uint8_t)(begins[i] >> 8 * b);
        }
        stream_data(bytes, sizeof bytes);
    }
    for (size_t i = 0; i < source->count; i++) {
        stream_data(pieces[i].data, pieces[i].size);
    }
    stream_pad(size);
    free(begins);
}

/* Strings of one length, which NULs or spaces fill. */
static void write_fixed(const struct source *source, struct piece *pieces)
{
    size_t length = H5Tget_size(source->type);
    bool has_spaces = H5Tget_strpad(source->type) == H5T_STR_SPACEPAD;
    char *data = allocate(source, source->count, length ? length : 1);
    read_into(source, data, source->type, H5P_DEFAULT);
    for (size_t i = 0; i < source->count; i++) {
        const char *text = data + i * length;
        size_t size = strnlen(text, length);
        while (has_spaces && size && text[size - 1] == ' ') {
            size--;
        }
        pieces[i] = (struct piece){text, size};
    }
    write_pieces(source, pieces);
    free(data);
}

/* libhdf5's memory for what has no length in the file's shape: no more than may be written. */
static void *take_some(size_t size, void *user)
{
    uint64_t *left = user;
    memory_allow(size <= *left ? size : 0);
    void *memory = size > *left ? NULL : malloc(size ? size : 1);
    *left -= memory ? size : 0;
    return memory;
}

static void give_back(void *memory, void *user)
{
    (void)user;
    free(memory);
}

/* Strings of any length, or sequences of letters. */
static void write_variable(const struct source *source, struct piece *pieces, bool is_letters_form)
{
    uint64_t left = stream_left();
    size_t size = is_letters_form ? sizeof(hvl_t) : sizeof(char *);
    void *data = allocate(source, source->count, size);
    hid_t transfer = H5Pcreate(H5P_DATASET_XFER);
    if (transfer < 0 || H5Pset_vlen_mem_manager(transfer, take_some, &left, give_back, &left) < 0) {
        refuse_source(source, "limit its memory");
    }
    read_into(source, data, source->type, transfer);
    for (size_t i = 0; i < source->count; i++) {
        const hvl_t *sequence = (const hvl_t *)data + (is_letters_form ? i : 0);
        const char *text = is_letters_form ? sequence->p : ((char **)data)[i];
        size_t length = !text ? 0 : is_letters_form ? sequence->len : strlen(text);
        pieces[i] = (struct piece){text, length};
    }
    write_pieces(source, pieces);
    H5Dvlen_reclaim(source->type, source->space, source->is_attribute ? H5P_DEFAULT : transfer, data);
    H5Pclose(transfer);
    free(data);
}

/* Counts what chunks unpack to, each once: they may be far larger than the dataset that is cut out of them. */
static void check_chunks(const struct source *source, hid_t plan)
{
    enum { BUFFERS = 3 };       /* of a chunk: as it is stored, unpacked, and shuffled */
    static double chunks, data; /* of all datasets */
    hsize_t dims[H5S_MAX_RANK];
    double element = (double)H5Tget_size(source->type);
    double bytes = element;
    double count = 1;
    int rank = H5Pget_layout(plan) == H5D_CHUNKED ? H5Pget_chunk(plan, H5S_MAX_RANK, dims) : 0;
    for (int i = 0; i < rank && i < (int)source->what.rank; i++) {
        bytes *= (double)dims[i];
        count *= ceil((double)source->what.dims[i] / (double)dims[i]);
    }
    data += element * (double)source->count;
    chunks += rank > 0 ? bytes * count : 0;
    if (!memory_chunks_fit(chunks, data)) {
        refuse(false, "%s: %.0f chunks of %.0f bytes, far larger than its %zu elements", source->path, count, bytes,
               source->count);
    }
    memory_allow(rank > 0 ? (uint64_t)((double)BUFFERS * bytes) : 0);
}

/* Writes what has been found to be harmless. */
static void write_source(struct source *source)
{
    hid_t memory = -1;
    enum form form = describe_type(&source->what, &memory, source->type);
    describe_space(source);
    if (!source->is_attribute) {
        hid_t plan = H5Dget_create_plist(source->object);
        check_chunks(source, plan);
        H5Pclose(plan);
    }
    if (form == FORM_NUMBERS) {
        write_numbers(source, memory);
    } else if (form == FORM_NONE) {
        stream_frame(&source->what, 0);
    } else {
        struct piece *pieces = allocate(source, source->count, sizeof *pieces);
        form == FORM_FIXED ? write_fixed(source, pieces) : write_variable(source, pieces, form == FORM_LETTERS);
        free(pieces);
    }
}

/* Refuses what is not stored in the file itself, or by something else than the three filters. */
static void check_storage(const char *path, hid_t dataset)
{
    hid_t plan = H5Dget_create_plist(dataset);
    if (plan < 0) {
        refuse_damaged(path, "read how it is stored");
    }
    H5D_layout_t layout = H5Pget_layout(plan);
    if (layout == H5D_VIRTUAL) {
        refuse(false, "%s: a virtual dataset, made of others and of other files, is not read", path);
    }
    if (layout < 0 || H5Pget_external_count(plan) != 0) {
        refuse(false, "%s: its data are stored in another file, which is not read", path);
    }
    int filters = H5Pget_nfilters(plan);
    for (int i = 0; i < filters; i++) {
        unsigned flags = 0;
        unsigned settings = 0;
        size_t count = 0;
        char name[64] = "";
        H5Z_filter_t filter = H5Pget_filter2(plan, (unsigned)i, &flags, &count, NULL, sizeof name, name, &settings);
        if (filter != H5Z_FILTER_DEFLATE && filter != H5Z_FILTER_SHUFFLE && filter != H5Z_FILTER_FLETCHER32) {
            refuse(false, "%s: filter %d (%.60s), deflate, shuffle and fletcher32 are read", path, (int)filter, name);
        }
    }
    if (filters < 0) {
        refuse_damaged(path, "read its filters");
    }
    H5Pclose(plan);
}

void write_dataset(const struct description *what, hid_t dataset)
{
    check_storage(what->name, dataset);
    struct source source = {.what = *what,
                            .path = what->name,
                            .object = dataset,
                            .type = H5Dget_type(dataset),
                            .space = H5Dget_space(dataset)};
    if (source.type < 0 || source.space < 0) {
        refuse_damaged(what->name, "read its type");
    }
    write_source(&source);
    H5Tclose(source.type);
    H5Sclose(source.space);
}

void write_attribute(const char *path, hid_t object, const char *name)
{
    struct source source = {.what = {.kind = HDF5_FRAME_ATTRIBUTE, .name = name}, .path = path, .is_attribute = true};
    source.object = H5Aopen(object, name, H5P_DEFAULT);
    source.type = source.object < 0 ? -1 : H5Aget_type(source.object);
    source.space = source.object < 0 ? -1 : H5Aget_space(source.object);
    if (source.type < 0 || source.space < 0 || strlen(name) > HDF5_NAME_LIMIT || !*name) {
        refuse_source(&source, "read it");
    }
    write_source(&source);
    H5Tclose(source.type);
    H5Sclose(source.space);
    H5Aclose(source.object);
}
