/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads options by the tables that conus query has. */
#include "viewer/model/ask.h"

#include "options/messages.h"
#include "options/options.h"
#include "settings/axis_options.h"
#include "settings/settings.h"
#include "viewer/model/question.h"

#include <string.h>

struct ask_settings {
    struct engine_settings engine;
    struct axis_settings axis;
    struct common_settings common;
};

static const struct option_group groups[] = {
    {"", shape_options, offsetof(struct ask_settings, engine)},
    {"", engine_options, offsetof(struct ask_settings, engine)},
    {"", slices_options, offsetof(struct ask_settings, engine)},
    {"", axis_options, offsetof(struct ask_settings, axis)},
    {"", plain_options, offsetof(struct ask_settings, common)},
    {0},
};

static const struct command command = {
    .program = "conus view", .name = "ask", .groups = groups, .settings_size = sizeof(struct ask_settings)};

/* The name that the library has; NULL for a formula, which a session cannot keep. */
static const char *find_score(const char *name)
{
    const conus_score_info *info = NULL;
    for (size_t i = 0; (info = conus_score(i)) && strcmp(info->name, name) != 0; i++) {
    }
    return info ? info->name : NULL;
}

static bool check(const struct ask_settings *settings, const struct arguments *arguments)
{
    if (option_given(arguments, "segments") || option_given(arguments, "contacts")) {
        print_error_line("ask: --segments and --contacts are of files, not of the window");
        return false;
    }
    return settings_check_score(&settings->engine, false);
}

static bool use(struct viewer *viewer, const struct ask_settings *settings)
{
    conus_selector_options options = settings_engine(&settings->engine, &settings->common);
    const char *score = settings->engine.score;
    options.level = NULL;
    options.score = score ? find_score(score) : NULL;
    options.log = viewer->cone.options.log;
    if (score && !options.score) {
        print_error_line("ask: --score: \"%s\" is no name of a score", score);
        return false;
    }
    viewer->cone.order = (conus_order)settings->axis.order;
    bool fine = question_use(viewer, &options, settings->engine.level ? settings->engine.level : "");
    if (!fine) {
        print_error_line("ask: %s", viewer->message);
    }
    return fine;
}

bool ask_words(struct viewer *viewer, char **words, int count)
{
    struct ask_settings settings = {0};
    struct arguments arguments;
    bool fine = options_parse(&arguments, &settings, &command, count, words, 1) < 0 && check(&settings, &arguments);
    conus_order before = viewer->cone.order;
    if (fine && !use(viewer, &settings)) {
        viewer->cone.order = before;
        fine = false;
    }
    options_finish(&settings, &arguments);
    return fine;
}
