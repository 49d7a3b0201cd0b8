/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads images with OpenEXR's C++ library. */
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>

#include <cstdio>
#include <cstdlib>

extern "C" {
#include "exr_oracle.h" // last: its fail() is a macro, and streams have a function of that name
}

uint32_t *exr_flat_read(const char *path, const char *channel, uint32_t width, uint32_t height)
{
    try {
        Imf::InputFile file(path);
        const Imath::Box2i window = file.header().dataWindow();
        const Imf::Channel *listed = file.header().channels().findChannel(channel);
        if (!listed || window.min != Imath::V2i(0, 0) ||
            window.max != Imath::V2i(static_cast<int>(width) - 1, static_cast<int>(height) - 1)) {
            return nullptr;
        }
        auto *bits = static_cast<uint32_t *>(std::calloc(static_cast<size_t>(width) * height, sizeof(uint32_t)));
        Imf::FrameBuffer frame;
        frame.insert(channel, Imf::Slice(listed->type, reinterpret_cast<char *>(bits), sizeof(uint32_t),
                                         sizeof(uint32_t) * width));
        file.setFrameBuffer(frame);
        file.readPixels(0, static_cast<int>(height) - 1);
        return bits;
    } catch (const std::exception &problem) {
        std::fprintf(stderr, "%s: %s\n", path, problem.what());
        return nullptr;
    }
}
