/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the build's identity among the notes of the object that this file is a part of. */
#include "base/system/build_id.h"

#include <elf.h>
#include <link.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

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
            const uint8_t *id = at + sizeof note + name;
            for (size_t i = 0; i < note.n_descsz && 2 * i + 2 < BUILD_ID_SIZE; i++) {
                snprintf(out + 2 * i, 3, "%02x", id[i]);
            }
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

bool build_id_find(char out[BUILD_ID_SIZE])
{
    out[0] = '\0';
    dl_iterate_phdr(read_build_id, out);
    return out[0];
}
