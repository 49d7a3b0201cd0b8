/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file mesh.h
 * Surfaces of areas, and numbers of vertices, as files.
 */
#ifndef CONUS_PUBLIC_MESH_H
#define CONUS_PUBLIC_MESH_H

#include <conus/atlas.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** The format of a surface. */
typedef enum conus_mesh_format {
    CONUS_MESH_GIFTI = 0, /**< GIFTI, .gii. */
    CONUS_MESH_VTP,       /**< VTK's XML poly data, .vtp. */
    CONUS_MESH_OBJ,       /**< Wavefront, .obj. */
    CONUS_MESH_PLY,       /**< Stanford, .ply. */
    CONUS_MESH_STL        /**< Stereolithography, .stl. */
} conus_mesh_format;

/** How conus_atlas_write_meshes() makes surfaces. */
typedef struct conus_mesh_options {
    size_t struct_size;       /**< Its size, as #CONUS_MESH_OPTIONS_INIT sets it; 0 = that of this version. */
    conus_mesh_format format; /**< Format of the files. */
    uint32_t smooth;          /**< Iterations of windowed-sinc smoothing, 1 to 1000; 0 = 5. */
    double pass_band;         /**< Pass band of the smoothing, up to 2; less is smoother; 0 = 0.7. */
    bool no_smoothing;        /**< Leave the voxels' steps as they are. */
    double decimate;          /**< Part of the triangles that decimation removes, in [0, 1). */
    uint64_t max_memory;      /**< Limit for the program that makes the surfaces, bytes; 0 = 8 GiB. */
    conus_progress progress;  /**< NULL = no callback. */
    void *progress_user;      /**< Passed to @p progress. */
    conus_log log;            /**< Notes about the surfaces; NULL = silent. */
    void *log_user;           /**< Passed to @p log. */
} conus_mesh_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_MESH_OPTIONS_INIT CONUS_INIT_(conus_mesh_options)

/**
 * Writes a closed surface of each area, LABEL_Name.gii and so on, in world mm. Areas that are meshes already are
 * written as they are. Needs the program conus-mesh, beside this one, in PATH or named by CONUS_MESH.
 * @param atlas The atlas.
 * @param folder Made if missing.
 * @param options NULL = defaults.
 * @return #CONUS_OK; #CONUS_ERROR_UNSUPPORTED without conus-mesh; #CONUS_ERROR_ARGUMENT for an option out of its range;
 * #CONUS_ERROR_IO where the system refuses.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_atlas_write_meshes(const conus_atlas *atlas, const char *folder,
                                                    const conus_mesh_options *options);

/** A number for each vertex of a surface. */
typedef struct conus_vertex_map {
    const char *name;        /**< UTF-8, such as "leeway_mm". */
    const float *values;     /**< [vertices] NaN = none. */
    const uint64_t *numbers; /**< [vertices] In their place, values is NULL: whole numbers, 0 = none. Up to 2^24 they
                                are float32, exactly; where one is larger, this array has the numbers modulo 1000000,
                                and one more, NAME_millions, has the millions. */
} conus_vertex_map;

/**
 * Writes numbers of vertices as a GIFTI file of float32 arrays. The same numbers give the same bytes.
 * @param path Ends in .func.gii or .shape.gii.
 * @param maps [count] An array of the file each.
 * @param count At least 1.
 * @param vertices The surface's, 1 or more.
 * @param structure What the surface is, "CortexLeft": the file's AnatomicalStructurePrimary, by which Workbench finds
 * the surface; NULL = the file does not say.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for another ending, and for no numbers; #CONUS_ERROR_IO where the system
 * refuses.
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_vertex_maps_write(const char *path, const conus_vertex_map *maps, size_t count,
                                                   size_t vertices, const char *structure);

#ifdef __cplusplus
}
#endif

#endif
