// SPDX-License-Identifier: BSD-3-Clause
// Mesh files of other programs, by VTK's readers, as triangles.
#include "conus_mesh.hpp"

#include <vtkAbstractArray.h>
#include <vtkAlgorithm.h>
#include <vtkCellArray.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkOBJReader.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkPLYReader.h>
#include <vtkPolyData.h>
#include <vtkPolyDataReader.h>
#include <vtkSTLReader.h>
#include <vtkSmartPointer.h>
#include <vtkStringArray.h>
#include <vtkTriangleFilter.h>
#include <vtkVariant.h>
#include <vtkXMLPolyDataReader.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <fstream>
#include <limits>
#include <map>
#include <new>
#include <sstream>
#include <sys/stat.h>
#include <utility>

namespace
{

/* What VTK has to say: the first line is kept instead of printed. */
class Listener : public vtkOutputWindow
{
  public:
    static Listener *New();
    vtkTypeMacro(Listener, vtkOutputWindow);

    void DisplayText(const char *text) override
    {
        if (!first.empty()) {
            return;
        }
        /* "ERROR: In file, line n\nvtkThing (0x123): what it is about\n", or without vtkThing */
        first = text;
        const size_t object = first.find("): ");
        const size_t line = first.find('\n');
        if (object != std::string::npos) {
            first.erase(0, object + 3);
        } else if (line != std::string::npos && line + 1 < first.size()) {
            first.erase(0, line + 1);
        }
        first.erase(std::find(first.begin(), first.end(), '\n'), first.end());
        for (size_t at; (at = first.find("(0x")) != std::string::npos && first.find(')', at) != std::string::npos;) {
            first.erase(at, first.find(')', at) - at + 1); /* where in memory an object is, says nothing */
        }
        first = first.empty() ? "an error without a description" : first;
    }

    /* What was said since the last time, "" for nothing. */
    std::string take()
    {
        return std::exchange(first, std::string());
    }

  private:
    std::string first;
};
vtkStandardNewMacro(Listener);

enum class Format { Vtk, Vtp, Ply, Stl, Obj };

bool starts(const std::string &text, const char *prefix)
{
    return text.compare(0, std::strlen(prefix), prefix) == 0;
}

std::string ending_of(const std::string &path)
{
    const size_t dot = path.rfind('.');
    std::string ending = dot == std::string::npos ? "" : path.substr(dot + 1);
    for (char &c : ending) {
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    return ending;
}

/* The content decides where a format has a signature, the name for STL and OBJ. */
Format format_of(const std::string &path, const std::string &head)
{
    const std::string ending = ending_of(path);
    if (head.empty()) {
        throw Failure("content: the file is empty");
    }
    if (starts(head, "\xff\xff\xfe")) {
        throw Failure("content: a FreeSurfer surface, which VTK does not read, whatever its name ends in");
    }
    if (starts(head, "# vtk DataFile")) {
        return Format::Vtk;
    }
    if (starts(head, "ply\n") || starts(head, "ply\r")) {
        return Format::Ply;
    }
    if (head.find("<VTKFile") != std::string::npos) {
        return Format::Vtp;
    }
    if (ending == "stl") {
        return Format::Stl;
    }
    if (ending != "obj") {
        throw Failure("content: neither VTK, VTP, PLY nor, by its name, STL or OBJ");
    }
    if (head.size() > 1 && std::strchr("PpLlMmFfXxQqTtBb", head[0]) && head[1] == ' ' && !starts(head, "f ") &&
        !starts(head, "l ") && !starts(head, "p ")) {
        throw Failure("content: an MNI object file, not Wavefront's OBJ");
    }
    if (head.find('\0') != std::string::npos) {
        throw Failure("content: binary data, an OBJ file is text");
    }
    return Format::Obj;
}

std::string read_head(const std::string &path, size_t limit)
{
    std::ifstream file(path, std::ios::binary);
    if (!file) {
        throw Failure(std::string("cannot open: ") + std::strerror(errno));
    }
    std::string head(limit, '\0');
    file.read(head.data(), static_cast<std::streamsize>(limit));
    head.resize(static_cast<size_t>(file.gcount()));
    return head;
}

uint64_t size_of(const std::string &path)
{
    struct stat info;
    return stat(path.c_str(), &info) ? 0 : static_cast<uint64_t>(info.st_size);
}

/* VTK's STL reader takes of a binary file what is there, whatever its count says. */
void check_stl_size(const std::string &path, const std::string &head)
{
    enum { HEADER = 84, TRIANGLE = 50 };
    const size_t first = head.find_first_not_of(" \t\r\n");
    const bool is_text = first != std::string::npos && head.compare(first, 5, "solid") == 0 &&
                         head.find('\0') == std::string::npos; /* VTK says where that ends too early */
    const uint64_t size = size_of(path);
    uint32_t count = 0;
    if (head.size() >= HEADER) {
        std::memcpy(&count, head.data() + HEADER - sizeof count, sizeof count);
    }
    if (!is_text && size != HEADER + TRIANGLE * static_cast<uint64_t>(count)) {
        throw Failure("content: " + std::to_string(size) + " bytes, a binary STL file of " + std::to_string(count) +
                      " triangles has " + std::to_string(HEADER + TRIANGLE * static_cast<uint64_t>(count)));
    }
}

/* VTK's PLY reader believes the counts, and a loop over 2e9 vertices that are not there takes minutes. */
void check_ply_counts(const std::string &path, const std::string &head)
{
    const uint64_t size = size_of(path);
    std::istringstream lines(head);
    for (std::string line; std::getline(lines, line) && !starts(line, "end_header");) {
        std::istringstream words(line);
        std::string word, name;
        uint64_t count = 0;
        if (!(words >> word) || word != "element") {
            continue;
        }
        if (!(words >> name >> count)) {
            throw Failure("header: \"" + line.substr(0, 60) + "\", an element has a name and a count");
        }
        if (count > size) {
            throw Failure("header: " + line.substr(0, 60) + ": more than the " + std::to_string(size) +
                          " bytes of the file can hold");
        }
    }
}

bool is_number(const std::string &word)
{
    return word.find_first_not_of("0123456789+-.eE") == std::string::npos &&
           word.find_first_of("0123456789") != std::string::npos;
}

/* Where VTK's OBJ reader finds no number, it takes 0. */
void check_obj_vertices(const std::string &path)
{
    std::ifstream file(path);
    std::string line;
    for (size_t n = 1; std::getline(file, line); n++) {
        if (!starts(line, "v ") && !starts(line, "v\t")) {
            continue;
        }
        std::istringstream words(line.substr(1));
        std::string word;
        int numbers = 0;
        while (numbers < 3 && words >> word && is_number(word)) {
            numbers++;
        }
        if (numbers < 3) {
            throw Failure("line " + std::to_string(n) + ": \"" + line.substr(0, 60) + "\", a vertex is three numbers");
        }
    }
}

mesh_space space_in(const std::string &text)
{
    for (size_t at = 0; (at = text.find("SPACE", at)) != std::string::npos; at += 5) {
        const size_t value = text.find_first_not_of("= \t", at + 5);
        if (value == std::string::npos || value == at + 5) {
            continue;
        }
        if (text.compare(value, 3, "RAS") == 0) {
            return MESH_SPACE_RAS;
        }
        if (text.compare(value, 3, "LPS") == 0) {
            return MESH_SPACE_LPS;
        }
    }
    return MESH_SPACE_UNSTATED;
}

/* The lines of the file in which 3D Slicer states the space. */
std::string remarks_of(Format format, const std::string &head)
{
    std::istringstream lines(head);
    std::string remarks;
    std::string line;
    for (int n = 1; std::getline(lines, line); n++) {
        const bool ply_end = format == Format::Ply && starts(line, "end_header");
        if (ply_end || (format == Format::Vtk && n > 2) || (format == Format::Stl && n > 1)) {
            break;
        }
        if ((format == Format::Vtk && n == 2) || (format == Format::Ply && starts(line, "comment")) ||
            (format == Format::Obj && starts(line, "#")) || format == Format::Stl) {
            remarks += line.substr(0, format == Format::Stl ? 80 : std::string::npos) + "\n";
        }
    }
    return remarks;
}

mesh_space space_of_field(vtkPolyData *poly)
{
    vtkAbstractArray *field = poly->GetFieldData()->GetAbstractArray("SPACE");
    if (!field || field->GetNumberOfValues() < 1) {
        return MESH_SPACE_UNSTATED;
    }
    return space_in("SPACE=" + field->GetVariantValue(0).ToString());
}

template <typename Reader> vtkSmartPointer<vtkPolyData> read_as(const std::string &path)
{
    vtkNew<Reader> reader;
    reader->SetFileName(path.c_str());
    reader->Update();
    if (reader->GetErrorCode()) {
        throw Failure("VTK's reader failed (code " + std::to_string(reader->GetErrorCode()) + ")");
    }
    return reader->GetOutput();
}

/* VTK would leave out triangles that have two corners at the same position; conus counts what is left out. */
vtkSmartPointer<vtkPolyData> read_stl(const std::string &path)
{
    vtkNew<vtkSTLReader> reader;
    reader->SetFileName(path.c_str());
    reader->MergingOff();
    reader->Update();
    if (reader->GetErrorCode()) {
        throw Failure("VTK's reader failed (code " + std::to_string(reader->GetErrorCode()) + ")");
    }
    vtkSmartPointer<vtkPolyData> poly = reader->GetOutput();
    std::map<std::array<double, 3>, vtkIdType> first;
    vtkNew<vtkCellArray> merged;
    vtkIdType size;
    const vtkIdType *ids;
    for (poly->GetPolys()->InitTraversal(); poly->GetPolys()->GetNextCell(size, ids);) {
        merged->InsertNextCell(static_cast<int>(size));
        for (vtkIdType i = 0; i < size; i++) {
            std::array<double, 3> position;
            poly->GetPoint(ids[i], position.data());
            merged->InsertCellPoint(first.emplace(position, ids[i]).first->second);
        }
    }
    poly->SetPolys(merged);
    return poly;
}

vtkSmartPointer<vtkPolyData> read_with(Format format, const std::string &path)
{
    switch (format) {
    case Format::Vtk:
        return read_as<vtkPolyDataReader>(path);
    case Format::Vtp:
        return read_as<vtkXMLPolyDataReader>(path);
    case Format::Ply:
        return read_as<vtkPLYReader>(path);
    case Format::Stl:
        return read_stl(path);
    case Format::Obj:
        break;
    }
    return read_as<vtkOBJReader>(path);
}

void check_indices(vtkCellArray *cells, vtkIdType points)
{
    vtkIdType size;
    const vtkIdType *ids;
    for (cells->InitTraversal(); cells->GetNextCell(size, ids);) {
        for (vtkIdType i = 0; i < size; i++) {
            if (ids[i] < 0 || ids[i] >= points) {
                throw Failure("vertex index " + std::to_string(ids[i]) + ", allowed are 0 to " +
                              std::to_string(points - 1));
            }
        }
    }
}

/* What a file holds, as VTK reads it. */
struct Content {
    Format format;
    mesh_space space;
    vtkSmartPointer<vtkPolyData> poly;
};

Content read_content(const std::string &path, Listener *listener)
{
    const std::string head = read_head(path, 65536);
    Content content = {format_of(path, head), MESH_SPACE_UNSTATED, nullptr};
    if (content.format == Format::Ply) {
        check_ply_counts(path, head);
    }
    if (content.format == Format::Stl) {
        check_stl_size(path, head);
    }
    if (content.format == Format::Obj) {
        check_obj_vertices(path);
    }
    try {
        content.poly = read_with(content.format, path);
    } catch (const Failure &failure) {
        const std::string said = listener->take();
        throw Failure(said.empty() ? failure.what() : "VTK's reader: " + said);
    }
    const std::string said = listener->take();
    if (!said.empty()) {
        throw Failure("VTK's reader: " + said);
    }
    check_indices(content.poly->GetPolys(), content.poly->GetNumberOfPoints());
    check_indices(content.poly->GetStrips(), content.poly->GetNumberOfPoints());
    content.space =
        content.format == Format::Vtp ? space_of_field(content.poly) : space_in(remarks_of(content.format, head));
    return content;
}

Surface surface_of(vtkPolyData *poly, mesh_space space, uint32_t id)
{
    vtkNew<vtkTriangleFilter> triangles;
    triangles->SetInputData(poly);
    triangles->PassVertsOff();
    triangles->PassLinesOff();
    triangles->Update();
    Surface surface = surface_from(triangles->GetOutput());
    surface.space = space;
    surface.id = id;
    return surface;
}

/* The objects of an OBJ file: their names, and the object of each face. */
struct Objects {
    std::vector<std::string> names;
    std::vector<uint32_t> of_face;
};

/* What is before the first object, or in none with a name, is an object "". Lines that have the same name are one. */
Objects find_objects(const std::string &path)
{
    Objects objects;
    std::map<std::string, uint32_t> numbers;
    std::string name;
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        const size_t first = std::min(line.find_first_not_of(" \t"), line.size());
        const bool is_word = line.size() > first + 1 && std::isspace(static_cast<unsigned char>(line[first + 1]));
        if (line.size() > first && line[first] == 'o' && (is_word || line.size() == first + 1)) {
            const size_t begin = line.find_first_not_of(" \t\r", first + 1);
            const size_t end = line.find_last_not_of(" \t\r");
            name = begin == std::string::npos ? "" : line.substr(begin, end + 1 - begin);
        } else if (is_word && line[first] == 'f') {
            const auto number = numbers.emplace(name, static_cast<uint32_t>(objects.names.size()));
            if (number.second) {
                objects.names.push_back(name);
            }
            objects.of_face.push_back(number.first->second);
        }
    }
    return objects;
}

/* The faces of every object. */
std::vector<vtkSmartPointer<vtkCellArray>> deal_faces(vtkCellArray *faces, const Objects &objects)
{
    std::vector<vtkSmartPointer<vtkCellArray>> dealt(objects.names.size());
    vtkIdType size;
    const vtkIdType *ids;
    if (static_cast<size_t>(faces->GetNumberOfCells()) != objects.of_face.size()) {
        throw Failure("objects: " + std::to_string(objects.of_face.size()) + " faces, VTK's reader found " +
                      std::to_string(faces->GetNumberOfCells()));
    }
    for (vtkSmartPointer<vtkCellArray> &some : dealt) {
        some = vtkSmartPointer<vtkCellArray>::New();
    }
    size_t face = 0;
    for (faces->InitTraversal(); faces->GetNextCell(size, ids);) {
        dealt[objects.of_face[face++]]->InsertNextCell(size, ids);
    }
    return dealt;
}

void write_objects(Stream &stream, const std::string &path, Listener *listener)
{
    const Content content = read_content(path, listener);
    const Objects objects = content.format == Format::Obj ? find_objects(path) : Objects();
    if (objects.names.size() < 2) {
        stream.mesh(surface_of(content.poly, content.space, 0), objects.names.empty() ? "" : objects.names[0]);
        return;
    }
    const std::vector<vtkSmartPointer<vtkCellArray>> dealt = deal_faces(content.poly->GetPolys(), objects);
    for (uint32_t i = 0; i < dealt.size(); i++) {
        vtkNew<vtkPolyData> part;
        part->SetPoints(content.poly->GetPoints());
        part->SetPolys(dealt[i]);
        stream.mesh(surface_of(part, content.space, i), objects.names[i]);
    }
}

std::string take_path(Request &request)
{
    const uint32_t length = request.number<uint32_t>();
    return std::string(reinterpret_cast<const char *>(request.take(length)), length);
}

/* Calls `read`; what it throws becomes the failure of file `id`. */
template <typename Read> void try_file(Stream &stream, uint32_t id, Read read)
{
    try {
        read();
    } catch (const std::bad_alloc &) {
        stream.failure(id, "VTK's reader needs more memory than a file of this size is allowed");
    } catch (const Failure &failure) {
        stream.failure(id, failure.what());
    }
}

} // namespace

void read_files(Stream &stream, Request &request, uint32_t count)
{
    vtkNew<Listener> listener;
    vtkOutputWindow::SetInstance(listener);
    for (uint32_t i = 0; i < count; i++) {
        const std::string path = take_path(request);
        listener->take();
        try_file(stream, i, [&] {
            const Content content = read_content(path, listener);
            stream.mesh(surface_of(content.poly, content.space, i));
        });
    }
    vtkOutputWindow::SetInstance(nullptr);
}

void read_objects(Stream &stream, Request &request, uint32_t count)
{
    if (count != 1) {
        throw Failure("request: objects of " + std::to_string(count) + " files, allowed is 1");
    }
    vtkNew<Listener> listener;
    vtkOutputWindow::SetInstance(listener);
    const std::string path = take_path(request);
    try_file(stream, 0, [&] { write_objects(stream, path, listener); });
    vtkOutputWindow::SetInstance(nullptr);
}
