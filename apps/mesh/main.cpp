// SPDX-License-Identifier: BSD-3-Clause
// The program conus-mesh: answers the request in a file by a stream of meshes on stdout.
#include "conus_mesh.hpp"

#include <conus/version.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <new>
#include <string>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

/* The bytes of a file, as they lie on the disk. They are there as long as it lives. Throws Failure with the path where
 * they cannot be read. */
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

static const char help[] =
    "usage: conus-mesh REQUEST\n\nMakes meshes with VTK for conus; see loaders/extraction/mesh_protocol.h for the file "
    "REQUEST.\nThe command for people is conus mesh.\n";

// Answers --version and --help; false where the word is neither.
static bool is_answered(const std::string &word)
{
    if (word == "--version") {
        std::puts("conus " CONUS_VERSION);
        return true;
    }
    if (word == "--help" || word == "-h") {
        std::fputs(help, stdout);
        return true;
    }
    return false;
}

int main(int argc, char **argv)
{
    std::signal(SIGXFSZ, SIG_IGN); // it writes to no file, and an output that may not grow is an error of writing
    if (argc == 2 && is_answered(argv[1])) {
        return std::fflush(stdout) ? 1 : 0;
    }
    if (argc != 2 || argv[1][0] == '-') {
        std::fputs(help, stderr);
        return 2;
    }
    try {
        const MappedFile file(argv[1]);
        const SurfacesRequest request = parse_request(file.data(), file.size());
        Stream stream;
        make_surfaces(stream, request);
        stream.end();
    } catch (const std::bad_alloc &) {
        std::fputs("not enough memory\n", stderr);
        return 3;
    } catch (const std::exception &failure) {
        std::fprintf(stderr, "%s\n", failure.what());
        return 1;
    }
    return 0;
}
