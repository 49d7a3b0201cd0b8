/* SPDX-License-Identifier: BSD-3-Clause */
/* Text files with one changed place. */
#include "builders/bent_text.h"

#include "conus/status.h"
#include "test.h"

#include <string.h>

void append_bent(struct buffer *out, const char *text, const char *from, const char *to)
{
    const char *at = from ? strstr(text, from) : NULL;
    if (!from) {
        buffer_text(out, text);
        return;
    }
    assert_non_null(at);
    buffer_append(out, text, (size_t)(at - text));
    buffer_text(out, to);
    buffer_text(out, at + strlen(from));
}

void assert_said(const char *part)
{
    if (!strstr(conus_message(), part) || strchr(conus_message(), '\n')) {
        fail_msg("\"%s\" does not say \"%s\"", conus_message(), part);
    }
}

static struct job header_job;

void end_header(void)
{
    job_end(&header_job);
}

conus_status parse_header(struct text_volume *out, void (*parse)(struct job *, struct text_volume *, struct text),
                          const struct buffer *bytes, struct notes *notes)
{
    end_header();
    parse(&header_job, out, (struct text){bytes->data, bytes->size});
    if (notes && header_job.notes.count) {
        assert_ok(notes_move(notes, &header_job.notes));
    }
    return header_job.status ? job_close(&header_job, NULL, NULL) : CONUS_OK;
}
