/* SPDX-License-Identifier: BSD-3-Clause */
/* The references, as text and as BibTeX. */
#include "cli/cite/citation.h"

#include "base/system/system.h"
#include "options/messages.h"
#include "options/output.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The method that conus implements, as README.md has it. */
static const char method_text[] =
    "T. Rick, A. von Kapri, T. Kuhlen: GPU Implementation of 3D Object Selection by Conic Volume Techniques in Virtual "
    "Environments. IEEE Virtual Reality 2010, pp. 243–246. https://doi.org/10.1109/VR.2010.5444783";

static const char method_bibtex[] = "@inproceedings{rick2010conic,\n"
                                    "  author = {Rick, T. and von Kapri, A. and Kuhlen, T.},\n"
                                    "  title = {{GPU} Implementation of {3D} Object Selection by Conic Volume "
                                    "Techniques in Virtual Environments},\n"
                                    "  booktitle = {{IEEE} Virtual Reality 2010},\n"
                                    "  pages = {243--246},\n"
                                    "  year = {2010},\n"
                                    "  doi = {10.1109/VR.2010.5444783}\n"
                                    "}\n";

/* Writes the references, a line each. */
static void put_list(FILE *out, const struct citation *citation)
{
    if (citation_has_rays(citation)) {
        fprintf(out, "%s\n", method_text);
    }
    fprintf(out, "The conus authors: conus, version %s.\n", citation->version);
    const char *error = citation_error(citation, "name");
    if (error) {
        fprintf(out, "Errors of the pose, %s: %s\n", error, citation_error(citation, "source"));
    }
    for (size_t i = 0; i < citation->atlas_count; i++) {
        const struct cited_atlas *atlas = &citation->atlases[i];
        fprintf(out, "%s: ", atlas->name);
        for (size_t k = 0; k < atlas->references.count; k++) {
            fprintf(out, "%s%s", k ? "; " : "", atlas->references.items[k]);
        }
        if (!atlas->references.count) {
            fputs(atlas->is_here ? "its files carry no reference; cite it as its authors ask"
                                 : "its files are not here as they were, to look for a reference",
                  out);
        }
        /* Where no reference is known, a file name at least says which atlas it was. */
        fprintf(out, " (file %s%s%s)\n", atlas->file, atlas->sha256 ? ", SHA-256 " : "",
                atlas->sha256 ? atlas->sha256 : "");
    }
}

/* Escapes the characters that TeX gives a meaning. */
static void put_escaped(FILE *out, const char *text)
{
    for (; *text; text++) {
        switch (*text) {
        case '\\':
            fputs("\\textbackslash{}", out);
            break;
        case '~':
            fputs("\\textasciitilde{}", out);
            break;
        case '^':
            fputs("\\textasciicircum{}", out);
            break;
        case '{':
        case '}': /* which would count as braces even behind a backslash */
            fputs(*text == '{' ? "(" : ")", out);
            break;
        default:
            fprintf(out, "%s%c", strchr("&%$#_", *text) ? "\\" : "", *text);
        }
    }
}

void citation_bibtex(FILE *out, const struct citation *citation)
{
    if (citation_has_rays(citation)) {
        fprintf(out, "%s\n", method_bibtex);
    }
    fprintf(out,
            "@misc{conus,\n  author = {{The conus authors}},\n  title = {{conus}},\n  version = {%s},\n"
            "  howpublished = {Software, version %s}\n}\n", /* digits and dots */
            citation->version, citation->version);
    const char *error = citation_error(citation, "name");
    if (error) {
        fprintf(out, "\n@misc{error,\n  title = {{Errors of the pose, %s}},\n  note = {", error);
        put_escaped(out, citation_error(citation, "source"));
        fputs("}\n}\n", out);
    }
    for (size_t i = 0; i < citation->atlas_count; i++) {
        const struct cited_atlas *atlas = &citation->atlases[i];
        fprintf(out, "\n@misc{atlas%zu,\n  title = {{", i + 1);
        put_escaped(out, atlas->name);
        fputs("}},\n  howpublished = {file ", out);
        put_escaped(out, atlas->file);
        if (atlas->sha256) {
            fprintf(out, ", SHA-256 %s", atlas->sha256);
        }
        fputs("}", out);
        for (size_t k = 0; k < atlas->references.count; k++) {
            fputs(k ? "; " : ",\n  note = {", out);
            put_escaped(out, atlas->references.items[k]);
        }
        fputs(atlas->references.count ? "}\n}\n" : "\n}\n", out);
    }
}

/* Breaks a line at spaces. */
static void put_wrapped(FILE *out, const char *text)
{
    enum { WIDTH = 100 };
    size_t column = 0;
    for (const char *word = text; *word;) {
        size_t length = strcspn(word, " ");
        size_t shown = 0;
        for (size_t i = 0; i < length; i++) {
            shown += ((unsigned char)word[i] & 0xc0) != 0x80;
        }
        bool breaks = column && column + 1 + shown > WIDTH;
        fprintf(out, "%s%.*s", breaks ? "\n" : column ? " " : "", (int)length, word);
        column = breaks ? shown : column + (column > 0) + shown;
        word += length;
        word += strspn(word, " ");
    }
    fputc('\n', out);
}

int citation_text(FILE *out, const struct citation *citation)
{
    struct system_text text;
    if (system_text_open(&text)) {
        citation_methods(text.stream, citation);
    }
    if (!system_text_close(&text)) {
        return print_no_memory();
    }
    put_wrapped(out, text.data);
    fputc('\n', out);
    put_list(out, citation);
    free(text.data);
    return EXIT_DONE;
}

void citation_finish(struct citation *citation)
{
    for (size_t i = 0; i < citation->atlas_count; i++) {
        references_finish(&citation->atlases[i].references);
        free(citation->atlases[i].name);
    }
    free(citation->atlases);
    json_decref(citation->facts);
    json_decref(citation->atlases_asked);
}
