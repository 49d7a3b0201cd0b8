// SPDX-License-Identifier: BSD-3-Clause
/** @file The bytes of a file, as they lie on the disk. */
#ifndef CONUS_MESH_MAPPED_FILE_HPP
#define CONUS_MESH_MAPPED_FILE_HPP

#include <cstddef>
#include <string>

/** They are there as long as it lives. Throws Failure with the path where they cannot be read. */
class MappedFile
{
  public:
    explicit MappedFile(const std::string &path);
    ~MappedFile();
    MappedFile(const MappedFile &) = delete;
    MappedFile &operator=(const MappedFile &) = delete;

    const unsigned char *data() const
    {
        return static_cast<const unsigned char *>(bytes);
    }

    size_t size() const
    {
        return count;
    }

  private:
    void *bytes = nullptr;
    size_t count = 0;
};

#endif
