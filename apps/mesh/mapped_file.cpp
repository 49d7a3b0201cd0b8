// SPDX-License-Identifier: BSD-3-Clause
// A file in memory, by mmap().
#include "mapped_file.hpp"

#include "failure.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

MappedFile::MappedFile(const std::string &path)
{
    const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    struct stat info;
    bool fine = descriptor >= 0 && !fstat(descriptor, &info);
    if (fine && info.st_size) {
        count = static_cast<size_t>(info.st_size);
        bytes = mmap(nullptr, count, PROT_READ, MAP_PRIVATE, descriptor, 0);
        fine = bytes != MAP_FAILED;
    }
    const int error = errno;
    if (descriptor >= 0) {
        close(descriptor);
    }
    if (!fine) {
        throw Failure(path + ": " + std::strerror(error));
    }
}

MappedFile::~MappedFile()
{
    if (count) {
        munmap(bytes, count);
    }
}
