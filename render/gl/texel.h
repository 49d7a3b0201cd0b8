/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What a texel of a volume is, in GL and on the CPU. */
#ifndef CONUS_RENDER_GL_TEXEL_H
#define CONUS_RENDER_GL_TEXEL_H

enum volume_texture_kind {
    VOLUME_TEXTURE_UINT8 = 1, /**< R8UI; integers are never filtered. */
    VOLUME_TEXTURE_UINT16,    /**< R16UI */
    VOLUME_TEXTURE_UINT32,    /**< R32UI */
    VOLUME_TEXTURE_FLOAT,     /**< R32F, trilinear between voxel centres, clamped to the edge. */
    VOLUME_TEXTURE_BYTE4,     /**< RGBA8, likewise.                                            */
    VOLUME_TEXTURE_HALF4,     /**< RGBA16F, likewise; its voxels are four floats each.         */
    VOLUME_TEXTURE_FLOAT4     /**< RGBA32F, never filtered: a table. */
};

#endif
