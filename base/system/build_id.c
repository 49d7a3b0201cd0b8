/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the build's identity in the head of the program or library that this file is a part of. The linker computes it
 * from all that it writes: of ELF's it is a note (--build-id), of macOS's LC_UUID, of Windows's, by lld's --build-id,
 * the GUID that a file of debugging symbols would have, too. A web page has none: nothing is cached there. */
#include "base/system/build_id.h"

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#ifdef __ELF__
#include <elf.h>
#include <link.h>
#elif defined __APPLE__
#include <dlfcn.h>
#include <mach-o/loader.h>
#elif defined _WIN32
#include <windows.h>
#endif

static void write_id(char out[BUILD_ID_SIZE], const uint8_t *id, size_t size)
{
    for (size_t i = 0; i < size && 2 * i + 2 < BUILD_ID_SIZE; i++) {
        snprintf(out + 2 * i, 3, "%02x", id[i]);
    }
}

#ifdef __ELF__
/* The name of the note, "GNU" and its NUL. */
static const char owner[4] = "GNU";

static size_t round_to(size_t size, size_t step)
{
    return (size + step - 1) / step * step;
}

static void read_notes(char out[BUILD_ID_SIZE], const uint8_t *at, size_t size, size_t step)
{
    ElfW(Nhdr) note;
    while (size >= sizeof note) {
        memcpy(&note, at, sizeof note);
        size_t name = round_to(note.n_namesz, step);
        size_t whole = sizeof note + name + round_to(note.n_descsz, step);
        if (whole > size) {
            return;
        }
        if (note.n_type == NT_GNU_BUILD_ID && note.n_namesz == sizeof owner &&
            memcmp(at + sizeof note, owner, sizeof owner) == 0) {
            write_id(out, at + sizeof note + name, note.n_descsz);
        }
        at += whole;
        size -= whole;
    }
}

static int read_build_id(struct dl_phdr_info *info, size_t size, void *out)
{
    (void)size;
    uintptr_t here = (uintptr_t)owner;
    bool is_own = false; /* whether it is the object that this file is a part of */
    for (size_t i = 0; i < info->dlpi_phnum; i++) {
        const ElfW(Phdr) *part = &info->dlpi_phdr[i];
        is_own = is_own || (part->p_type == PT_LOAD && here - (info->dlpi_addr + part->p_vaddr) < part->p_memsz);
    }
    if (!is_own) {
        return 0;
    }
    for (size_t i = 0; i < info->dlpi_phnum; i++) {
        const ElfW(Phdr) *part = &info->dlpi_phdr[i];
        if (part->p_type == PT_NOTE) {
            const uint8_t *notes = (const uint8_t *)(info->dlpi_addr + part->p_vaddr); // NOLINT: where it is mapped
            read_notes(out, notes, part->p_memsz, part->p_align == 8 ? 8 : 4);
        }
    }
    return 1;
}

static void read_own(char out[BUILD_ID_SIZE])
{
    dl_iterate_phdr(read_build_id, out);
}
#elif defined __APPLE__
static void read_own(char out[BUILD_ID_SIZE])
{
    Dl_info own;
    const struct mach_header_64 *head = dladdr((const void *)write_id, &own) ? own.dli_fbase : NULL;
    const uint8_t *at = (const uint8_t *)(head + 1);
    for (size_t i = 0; head && i < head->ncmds; i++) {
        struct uuid_command command;
        memcpy(&command, at, sizeof(struct load_command));
        if (command.cmd == LC_UUID) {
            memcpy(&command, at, sizeof command);
            write_id(out, command.uuid, sizeof command.uuid);
        }
        at += command.cmdsize;
    }
}
#elif defined _WIN32
extern const uint8_t __ImageBase[]; /* of the linker: where the program or library begins */

static void read_own(char out[BUILD_ID_SIZE])
{
    enum { KIND = 4, GUID = 16 };
    const IMAGE_DOS_HEADER *dos = (const IMAGE_DOS_HEADER *)(const void *)__ImageBase;
    const IMAGE_NT_HEADERS *head = (const IMAGE_NT_HEADERS *)(const void *)(__ImageBase + dos->e_lfanew);
    IMAGE_DATA_DIRECTORY notes = head->OptionalHeader.DataDirectory[IMAGE_DIRECTORY_ENTRY_DEBUG];
    for (size_t at = 0; at + sizeof(IMAGE_DEBUG_DIRECTORY) <= notes.Size; at += sizeof(IMAGE_DEBUG_DIRECTORY)) {
        IMAGE_DEBUG_DIRECTORY note;
        memcpy(&note, __ImageBase + notes.VirtualAddress + at, sizeof note);
        const uint8_t *data = __ImageBase + note.AddressOfRawData;
        if (note.Type == IMAGE_DEBUG_TYPE_CODEVIEW && note.SizeOfData >= KIND + GUID &&
            memcmp(data, "RSDS", KIND) == 0) {
            write_id(out, data + KIND, GUID);
        }
    }
}
#else
static void read_own(char out[BUILD_ID_SIZE])
{
    (void)write_id;
    (void)out;
}
#endif

bool build_id_find(char out[BUILD_ID_SIZE])
{
    out[0] = '\0';
    read_own(out);
    return out[0];
}
