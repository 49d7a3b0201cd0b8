/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads the events of spacenavd and turns them into moves. */
#include "viewer/devices/devices.h"

#ifdef CONUS_SPACEMOUSE

#include <errno.h>
#include <math.h>
#include <spnav.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

static const double retry_s = 2;
static const double full = 350;       /* value of a cap pushed as far as it goes */
static const double let_go_s = 0.25;  /* a cap that is held sends more often; so an unplugged one does not drive on */
static const double longest_s = 0.05; /* between two questions, as far as moves count */

/* spnav_open() leaks a socket when nobody answers, so a probe connects first. */
static bool answers(const char *path)
{
    struct sockaddr_un place = {.sun_family = AF_UNIX};
    int probe = strlen(path) < sizeof place.sun_path ? socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0) : -1;
    if (probe < 0) {
        return false;
    }
    memcpy(place.sun_path, path, strlen(path));
    bool fine = connect(probe, (const struct sockaddr *)&place, sizeof place) == 0;
    close(probe);
    return fine;
}

static bool is_there(void)
{
    const char *given = getenv("SPNAV_SOCKET");
    return (given && answers(given)) || answers("/var/run/spnav.sock") || access("/etc/spnavrc", F_OK) == 0;
}

static void close_it(struct spacemouse *mouse, double now_s)
{
    spnav_close();
    mouse->is_open = mouse->has_event = mouse->is_unplugged = false;
    memset(mouse->axes, 0, sizeof mouse->axes);
    mouse->tried_s = now_s;
}

static void keep_open(struct spacemouse *mouse, double now_s)
{
    if (mouse->is_open) { /* to libspnav an end is the same as nothing to read */
        char byte;
        ssize_t size = recv(spnav_fd(), &byte, 1, MSG_PEEK | MSG_DONTWAIT);
        if (size == 0 || (size < 0 && errno != EAGAIN && errno != EINTR)) {
            close_it(mouse, now_s);
        }
    }
    if (!mouse->is_open && now_s - mouse->tried_s >= retry_s) {
        mouse->tried_s = now_s;
        mouse->is_open = is_there() && spnav_open() != -1;
    }
}

static unsigned meaning_of(const struct spnav_event_button *button)
{
    static const unsigned meanings[] = {SOURCE_HOLD, SOURCE_RESET, SOURCE_CONFIRM};
    bool is_known = button->press && button->bnum >= 0 && button->bnum < 3;
    return is_known ? meanings[button->bnum] : 0;
}

static void take_events(struct spacemouse *mouse, double now_s, struct source_update *out)
{
    spnav_event event;
    for (int i = 0; i < 1000 && spnav_poll_event(&event); i++) {
        if (event.type == SPNAV_EVENT_MOTION) {
            const int axes[6] = {event.motion.x,  event.motion.y,  event.motion.z,
                                 event.motion.rx, event.motion.ry, event.motion.rz};
            memcpy(mouse->axes, axes, sizeof axes);
            mouse->moved_s = now_s;
            mouse->has_event = true;
            mouse->is_unplugged = false;
        } else if (event.type == SPNAV_EVENT_BUTTON) {
            mouse->has_event = true;
            out->pressed |= meaning_of(&event.button);
        } else if (event.type == SPNAV_EVENT_DEV) {
            mouse->is_unplugged = event.dev.op == SPNAV_DEV_RM;
            memset(mouse->axes, 0, sizeof mouse->axes);
        }
    }
}

/* Changes the sign of z and of turns about it: the device's axes are left-handed, with +z away from the user. */
static void move(const struct spacemouse *mouse, double seconds, struct source_update *out)
{
    static const double signs[3] = {1, 1, -1};
    double way = source_speed(&mouse->source) * seconds / full;
    for (int a = 0; a < 3; a++) {
        out->move[a] = signs[a] * way * mouse->axes[a];
        out->turn[a] = signs[a] * way * mouse->axes[3 + a] * M_PI / 180;
    }
}

static void say(const struct spacemouse *mouse, struct source_update *out)
{
    if (!mouse->is_open) {
        out->state = SOURCE_ABSENT;
        out->text = "SpaceMouse: no spacenavd answers";
    } else if (mouse->is_unplugged) {
        out->state = SOURCE_ABSENT;
        out->text = "the SpaceMouse is unplugged";
    } else if (!mouse->has_event) {
        out->state = SOURCE_SILENT;
        out->text = "move the SpaceMouse's cap";
    } else {
        out->state = SOURCE_WELL;
    }
}

static bool ask(struct source *source, double now_s, struct source_update *out, double said[SOURCE_VALUES])
{
    struct spacemouse *mouse = (struct spacemouse *)source;
    double seconds = fmin(fmax(now_s - mouse->asked_s, 0), longest_s);
    bool moves = false;
    keep_open(mouse, now_s);
    mouse->asked_s = now_s;
    if (mouse->is_open) {
        take_events(mouse, now_s, out);
    }
    for (int i = 0; i < 6; i++) {
        said[i] = mouse->axes[i];
        moves = moves || mouse->axes[i];
    }
    moves = moves && now_s - mouse->moved_s < let_go_s;
    if (moves) {
        move(mouse, seconds, out);
    }
    say(mouse, out);
    return moves;
}

void spacemouse_finish(struct spacemouse *mouse)
{
    if (mouse->is_open) {
        close_it(mouse, 0);
    }
}

void spacemouse_init(struct spacemouse *out)
{
    *out = (struct spacemouse){.source.ask = ask, .tried_s = -retry_s};
}

#else

static bool ask(struct source *source, double now_s, struct source_update *out, double said[SOURCE_VALUES])
{
    (void)source;
    (void)now_s;
    (void)said;
    out->text = "SpaceMouse: built without libspnav";
    return false;
}

void spacemouse_finish(struct spacemouse *mouse)
{
    (void)mouse;
}

void spacemouse_init(struct spacemouse *out)
{
    *out = (struct spacemouse){.source.ask = ask};
}

#endif
