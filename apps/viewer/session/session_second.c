/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes and reads the second tool of a session. */
#include "viewer/session/session_second.h"

#include <string.h>

void session_second_add(json_t *root, const struct window *window)
{
    const struct second *second = &window->second;
    json_t *pose = json_array();
    for (int i = 0; i < 16; i++) {
        json_array_append_new(pose, json_real(second->pose.world_from_device[i]));
    }
    json_object_set_new(root, "second",
                        json_pack("{s: b, s: i, s: b, s: b, s: f, s: o}", "on", second->on, "pointer",
                                  (int)second->pointer, "has_pose", second->has_pose, "held", second->held, "angle_deg",
                                  second_angle(second), "world_from_device", pose));
    json_object_set_new(root, "device_speed", json_real(devices_speed(&window->inputs.devices)));
}

static bool read_flag(bool *out, const json_t *object, const char *key)
{
    const json_t *value = json_object_get(object, key);
    *out = json_is_true(value);
    return json_is_boolean(value);
}

static bool read_pose(conus_pose *out, const json_t *list)
{
    bool fine = json_array_size(list) == 16;
    for (size_t i = 0; i < 16 && fine; i++) {
        const json_t *value = json_array_get(list, i);
        out->world_from_device[i] = json_number_value(value);
        fine = json_is_number(value) && out->world_from_device[i] >= -1e6 && out->world_from_device[i] <= 1e6;
    }
    return fine;
}

static bool read_second(struct second *out, const json_t *root, char why[SESSION_REASON])
{
    const json_t *object = json_object_get(root, "second");
    const json_t *pointer = json_object_get(object, "pointer");
    const json_t *angle = json_object_get(object, "angle_deg");
    if (!object) {
        return true;
    }
    out->pointer = (enum pointer)json_integer_value(pointer);
    out->angle = json_number_value(angle);
    bool fine = read_flag(&out->on, object, "on") && read_flag(&out->has_pose, object, "has_pose") &&
                read_flag(&out->held, object, "held") && json_is_integer(pointer) && json_integer_value(pointer) >= 0 &&
                json_integer_value(pointer) < POINTER_COUNT && json_integer_value(pointer) != POINT_BY_REPLAY &&
                json_is_number(angle) && out->angle >= 0.01 && out->angle <= 179.99 &&
                read_pose(&out->pose, json_object_get(object, "world_from_device"));
    return fine ||
           session_refuse(why,
                          "session: second: on, has_pose and held (true or false), pointer (a number of what moves it, "
                          "not 2), angle_deg (0.01 to 179.99) and world_from_device (16 numbers) are needed");
}

bool session_second_read(struct session_tools *out, const struct window *window, const json_t *root,
                         char why[SESSION_REASON])
{
    const json_t *speed = json_object_get(root, "device_speed");
    *out = (struct session_tools){.second = window->second, .speed = devices_speed(&window->inputs.devices)};
    out->speed = speed ? json_number_value(speed) : out->speed;
    if (speed && (!json_is_number(speed) || !(out->speed >= SOURCE_LEAST_SPEED) || out->speed > SOURCE_MOST_SPEED)) {
        return session_refuse(why, "session: device_speed: a number from %d to %d is needed", SOURCE_LEAST_SPEED,
                              SOURCE_MOST_SPEED);
    }
    return read_second(&out->second, root, why);
}

void session_second_put(struct window *window, const struct session_tools *tools)
{
    struct second *second = &window->second;
    const struct second *read = &tools->second;
    devices_set_speed(&window->inputs.devices, tools->speed);
    second->pose = read->pose;
    second->has_pose = read->has_pose;
    second->held = read->held;
    second->angle = read->angle;
    second_use(second, window->viewer, read->on);
    second->pointer = read->pointer; /* whatever moves the first */
}
