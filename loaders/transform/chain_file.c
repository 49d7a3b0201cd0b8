/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads HDF5 files of transforms. */
#include "loaders/transform/chain_file.h"

static conus_status parse(struct transform_chain *out, const struct hdf5 *hdf5, uint64_t max_memory,
                          struct buffer *words)
{
    struct transform_chain chain;
    chain_begin(&chain);
    conus_status status = (x5_is(hdf5) ? x5_parse : itk_hdf5_parse)(&chain, hdf5, max_memory, words);
    status = status ? status : buffer_status(words);
    status = status ? status : chain_end(&chain);
    if (status) {
        transform_chain_finish(&chain);
        return status;
    }
    *out = chain;
    return CONUS_OK;
}

static conus_status read_open(struct transform_chain *out, const struct open_file *file, uint64_t max_memory,
                              struct notes *notes)
{
    static const char *const wanted[] = {"/",
                                         "/TransformGroup/*",
                                         "/TransformGroup/*/TransformType",
                                         "/TransformGroup/*/TransformParameters",
                                         "/TransformGroup/*/TranformParameters",
                                         "/TransformGroup/*/TransformFixedParameters",
                                         "/TransformGroup/*/TranformFixedParameters",
                                         "/TransformGroup/*/Transform",
                                         "/TransformGroup/*/Domain/*",
                                         "/TransformChain/*"};
    struct job job = {.max_memory = max_memory};
    struct buffer words = {0};
    job_in(&job, file->path, JOB_ALONE);
    const struct hdf5 *hdf5 = hdf5_open(&job, file, wanted, sizeof wanted / sizeof wanted[0]);
    if (JOB_CALL(&job, parse(out, hdf5, max_memory, &words))) {
        job_took(&job, notes_add(notes, "%s: %s", file->path, words.data));
    }
    buffer_finish(&words);
    return job_close(&job, NULL, NULL);
}

conus_status chain_file_read(struct transform_chain *out, const char *path, uint64_t max_memory, struct file_sums *read,
                             struct notes *notes)
{
    struct open_file file;
    struct transform_chain chain = {0};
    conus_status status = file_open(&file, path);
    if (status) {
        return status;
    }
    status = read_open(&chain, &file, max_memory, notes);
    status = status ? status : file_sums_add_open(read, &file);
    file_close(&file);
    if (status) {
        transform_chain_finish(&chain);
        return status;
    }
    *out = chain;
    return CONUS_OK;
}
