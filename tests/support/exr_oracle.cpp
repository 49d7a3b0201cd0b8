/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads images and encodes manifests with OpenEXR's C++ library. */
#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineInputFile.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIDManifest.h>
#include <ImfInputFile.h>
#include <ImfIntAttribute.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <string>
#include <vector>

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

struct exr_deep {
    explicit exr_deep(const char *path) : file(path)
    {
    }

    Imf::DeepScanLineInputFile file;
    uint32_t width = 0;
    uint32_t height = 0;
    std::vector<uint32_t> counts;
    struct Channel {
        std::vector<uint32_t> bits; /* of all samples, pixel by pixel */
        std::vector<char *> pixels;
    };
    std::vector<size_t> first; /* [width * height] the pixel's first sample */
    std::map<std::string, Channel> channels;
    std::unique_ptr<Imf::IDManifest> manifest;
};

static void read_pixels(exr_deep &deep)
{
    const Imath::Box2i window = deep.file.header().dataWindow();
    deep.width = static_cast<uint32_t>(window.max.x - window.min.x + 1);
    deep.height = static_cast<uint32_t>(window.max.y - window.min.y + 1);
    const size_t pixels = static_cast<size_t>(deep.width) * deep.height;
    deep.counts.resize(pixels);
    Imf::DeepFrameBuffer frame;
    frame.insertSampleCountSlice(Imf::Slice(Imf::UINT, reinterpret_cast<char *>(deep.counts.data()), sizeof(uint32_t),
                                            sizeof(uint32_t) * deep.width));
    const Imf::ChannelList &list = deep.file.header().channels();
    for (auto at = list.begin(); at != list.end(); ++at) {
        exr_deep::Channel &channel = deep.channels[at.name()];
        channel.pixels.resize(pixels);
        frame.insert(at.name(), Imf::DeepSlice(at.channel().type, reinterpret_cast<char *>(channel.pixels.data()),
                                               sizeof(char *), sizeof(char *) * deep.width, sizeof(uint32_t)));
    }
    deep.file.setFrameBuffer(frame);
    deep.file.readPixelSampleCounts(0, static_cast<int>(deep.height) - 1);
    size_t total = 0;
    for (uint32_t count : deep.counts) {
        deep.first.push_back(total);
        total += count;
    }
    for (auto &entry : deep.channels) {
        entry.second.bits.resize(total + 1);
        for (size_t i = 0; i < pixels; i++) {
            entry.second.pixels[i] = reinterpret_cast<char *>(&entry.second.bits[deep.first[i]]);
        }
    }
    deep.file.readPixels(0, static_cast<int>(deep.height) - 1);
}

exr_deep *exr_deep_read(const char *path)
{
    try {
        auto deep = std::make_unique<exr_deep>(path);
        read_pixels(*deep);
        if (Imf::hasIDManifest(deep->file.header())) {
            deep->manifest = std::make_unique<Imf::IDManifest>(Imf::idManifest(deep->file.header()));
        }
        return deep.release();
    } catch (const std::exception &problem) {
        std::fprintf(stderr, "%s: %s\n", path, problem.what());
        return nullptr;
    }
}

void exr_deep_close(exr_deep *deep)
{
    delete deep;
}

uint32_t exr_deep_side(const exr_deep *deep, int axis)
{
    return axis ? deep->height : deep->width;
}

uint32_t exr_deep_count(const exr_deep *deep, uint32_t x, uint32_t y)
{
    return deep->counts.at(static_cast<size_t>(y) * deep->width + x);
}

static uint32_t bits_of(const exr_deep *deep, const char *name, Imf::PixelType type, uint32_t x, uint32_t y, uint32_t s)
{
    const Imf::Channel *listed = deep->file.header().channels().findChannel(name);
    if (!listed || listed->type != type || s >= exr_deep_count(deep, x, y)) {
        std::fprintf(stderr, "no sample %u of %s at %u, %u\n", s, name, x, y);
        std::abort();
    }
    return deep->channels.at(name).bits[deep->first[static_cast<size_t>(y) * deep->width + x] + s];
}

uint32_t exr_deep_uint(const exr_deep *deep, const char *channel, uint32_t x, uint32_t y, uint32_t s)
{
    return bits_of(deep, channel, Imf::UINT, x, y, s);
}

float exr_deep_float(const exr_deep *deep, const char *channel, uint32_t x, uint32_t y, uint32_t s)
{
    const uint32_t bits = bits_of(deep, channel, Imf::FLOAT, x, y, s);
    float value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
}

const char *exr_deep_text(const exr_deep *deep, const char *attribute)
{
    const auto *found = deep->file.header().findTypedAttribute<Imf::StringAttribute>(attribute);
    return found ? found->value().c_str() : nullptr;
}

int exr_deep_number(const exr_deep *deep, const char *attribute)
{
    const auto *found = deep->file.header().findTypedAttribute<Imf::IntAttribute>(attribute);
    return found ? found->value() : -1;
}

static const Imf::IDManifest::ChannelGroupManifest *group_of(const exr_deep *deep, const char *channel)
{
    for (size_t i = 0; deep->manifest && i < deep->manifest->size(); i++) {
        if ((*deep->manifest)[i].getChannels().count(channel)) {
            return &(*deep->manifest)[i];
        }
    }
    return nullptr;
}

size_t exr_deep_names(const exr_deep *deep, const char *channel)
{
    const auto *group = group_of(deep, channel);
    return group ? group->size() : 0;
}

const char *exr_deep_name(const exr_deep *deep, const char *channel, uint32_t id, const char *component)
{
    const auto *group = group_of(deep, channel);
    if (!group || group->getLifetime() != Imf::IDManifest::LIFETIME_STABLE ||
        group->getHashScheme() != Imf::IDManifest::NOTHASHED ||
        group->getEncodingScheme() != Imf::IDManifest::ID_SCHEME || group->find(id) == group->end()) {
        return nullptr;
    }
    for (size_t i = 0; i < group->getComponents().size(); i++) {
        if (group->getComponents()[i] == component) {
            return group->find(id).text()[i].c_str();
        }
    }
    return nullptr;
}

uint8_t *exr_manifest(size_t *size, const id_manifest_group *groups, size_t group_count)
{
    Imf::IDManifest manifest;
    for (size_t g = 0; g < group_count; g++) {
        const id_manifest_group &from = groups[g];
        Imf::IDManifest::ChannelGroupManifest group;
        group.setChannel(from.channel);
        group.setComponents({from.components, from.components + from.component_count});
        group.setLifetime(Imf::IDManifest::LIFETIME_STABLE);
        group.setHashScheme(Imf::IDManifest::NOTHASHED);
        group.setEncodingScheme(Imf::IDManifest::ID_SCHEME);
        for (size_t i = 0; i < from.count; i++) {
            const char *const *texts = from.texts + i * from.component_count;
            group.insert(from.ids[i], std::vector<std::string>(texts, texts + from.component_count));
        }
        manifest.add(group);
    }
    const Imf::CompressedIDManifest packed(manifest);
    const auto whole = static_cast<uint64_t>(packed._uncompressedDataSize);
    *size = sizeof whole + static_cast<size_t>(packed._compressedDataSize);
    auto *bytes = static_cast<uint8_t *>(std::malloc(*size));
    for (size_t i = 0; i < sizeof whole; i++) {
        bytes[i] = static_cast<uint8_t>(whole >> 8 * i);
    }
    std::memcpy(bytes + sizeof whole, packed._data, static_cast<size_t>(packed._compressedDataSize));
    return bytes;
}
