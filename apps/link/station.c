/* SPDX-License-Identifier: BSD-3-Clause */
/* The station's thread: its sockets, its peers, the newest poses. */
#include "link/station.h"

#include "base/system/system.h"
#include "options/progress.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <netdb.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

enum { PEERS = 4, CHUNK = 16 * 1024, OUTGOING = 128 * 1024, REQUEST_MS = 20, RETRY_MS = 1000, CONNECT_MS = 2000 };

static const double stale_after_s = 0.5;

enum { THREAD, WAITER, WAKES }; /* whom the station wakes: its own thread; who waits for a pose */

/* One that is connected. */
struct peer {
    int socket;      /* -1 = none */
    double heard_ms; /* when it last ended a valid message, or came: bytes alone are no sign of life */
    struct igtl_reader reader;
    uint8_t out[OUTGOING]; /* what is being sent, */
    size_t out_size, sent;
    unsigned sent_number; /* of the newest outgoing message that was begun */
};

struct station {
    struct station_options options; /* strings are owned */
    pthread_t thread;
    int listener;
    struct system_wake wakes[WAKES];
    size_t wake_count; /* of those that are open */
    uint16_t port;
    struct peer peers[PEERS];
    double next_try_ms; /* of a connection that we make */

    pthread_mutex_t lock; /* guards what follows */
    bool stop;
    struct igtl_pose tool, second, reference, head; /* newest of each; name "" = none yet */
    double arrived_ms, second_arrived_ms, head_arrived_ms, time_s;
    uint64_t number, second_number;
    void (*on_pose)(void);   /* NULL = none */
    struct igtl_counts past; /* of peers that left */
    struct igtl_counts counts;
    uint64_t dropped;
    const char *trouble; /* as in station_update */
    unsigned clients;
    uint8_t outgoing[OUTGOING];
    size_t outgoing_size;
    unsigned outgoing_number;
};

static void multiply(double out[16], const double a[16], const double b[16])
{
    double product[16];
    for (int column = 0; column < 4; column++) {
        for (int row = 0; row < 4; row++) {
            product[4 * column + row] = 0;
            for (int k = 0; k < 4; k++) {
                product[4 * column + row] += a[4 * k + row] * b[4 * column + k];
            }
        }
    }
    memcpy(out, product, sizeof product);
}

static void invert_rigid(double out[16], const double m[16])
{
    double inverse[16] = {m[0], m[4], m[8], 0, m[1], m[5], m[9], 0, m[2], m[6], m[10], 0, 0, 0, 0, 1};
    for (int row = 0; row < 3; row++) {
        for (int k = 0; k < 3; k++) {
            inverse[12 + row] -= m[4 * row + k] * m[12 + k];
        }
    }
    memcpy(out, inverse, sizeof inverse);
}

/* Turns the tool so that its axis becomes the device's -z. */
static void axis_matrix(double out[16], conus_axis axis)
{
    static const signed char turns[7][9] = {
        {1, 0, 0, 0, 1, 0, 0, 0, 1},                                 /* columns: x, y, z of the device in the tool */
        {0, -1, 0, 0, 0, 1, -1, 0, 0}, {0, 1, 0, 0, 0, 1, 1, 0, 0},  /* +x, -x */
        {1, 0, 0, 0, 0, 1, 0, -1, 0},  {-1, 0, 0, 0, 0, 1, 0, 1, 0}, /* +y, -y */
        {-1, 0, 0, 0, 1, 0, 0, 0, -1}, {1, 0, 0, 0, 1, 0, 0, 0, 1},  /* +z, -z */
    };
    memset(out, 0, 16 * sizeof *out);
    for (int column = 0; column < 3; column++) {
        for (int row = 0; row < 3; row++) {
            out[4 * column + row] = turns[axis][3 * column + row];
        }
    }
    out[15] = 1;
}

/* From the sender's frame into the world. */
static void world_pose(double out[16], const struct station *station, const double tracker_from_tool[16])
{
    const struct station_options *options = &station->options;
    static const double ras_from_lps[16] = {-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    double matrix[16];
    memcpy(matrix, tracker_from_tool, sizeof matrix);
    if (options->reference) {
        double inverse[16];
        invert_rigid(inverse, station->reference.matrix);
        multiply(matrix, inverse, matrix);
    }
    if (options->lps) {
        multiply(matrix, ras_from_lps, matrix);
    }
    multiply(out, options->world_from_tracker, matrix);
    for (int a = 0; a < 3; a++) {
        out[12 + a] /= options->enlarged; /* Eq. 1 */
    }
}

static void device_pose(conus_pose *out, const struct station *station, const struct igtl_pose *tool)
{
    double turn[16];
    double matrix[16];
    world_pose(matrix, station, tool->matrix);
    axis_matrix(turn, station->options.axis);
    multiply(out->world_from_device, matrix, turn);
}

/* The eye is a place in the head's frame: moved there before anything is enlarged. */
static void head_pose(struct station_head *out, const struct station *station)
{
    const struct station_options *options = &station->options;
    double at_eye[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, options->eye[0], options->eye[1], options->eye[2], 1};
    multiply(at_eye, station->head.matrix, at_eye);
    world_pose(at_eye, station, at_eye);
    memcpy(out->eye, at_eye + 12, sizeof out->eye);
    world_pose(out->screen.world_from_device, station, options->tracker_from_screen);
}

/* NaviNIBS and PLUS name transforms ToolToFrame: "Pointer" is meant by "PointerToTracker", too. */
static bool is_named(const struct igtl_pose *pose, const char *name)
{
    size_t length = strlen(name);
    return strcmp(pose->name, name) == 0 ||
           (strncmp(pose->name, name, length) == 0 && strncmp(pose->name + length, "To", 2) == 0);
}

static void take_poses(void *user, const struct igtl_poses *poses)
{
    struct station *station = user;
    const struct station_options *options = &station->options;
    pthread_mutex_lock(&station->lock);
    bool has_pose = false;
    for (size_t i = 0; i < poses->count; i++) {
        const struct igtl_pose *pose = &poses->tools[i];
        if (options->reference && is_named(pose, options->reference)) {
            station->reference = *pose;
            has_pose = true;
        } else if (options->head && is_named(pose, options->head)) {
            station->head = *pose;
            has_pose = true;
            station->head_arrived_ms = clock_ms();
        } else if (options->second && is_named(pose, options->second)) {
            station->second = *pose;
            has_pose = true;
            station->second_arrived_ms = clock_ms();
            station->second_number++;
        } else if (options->tool ? is_named(pose, options->tool)
                                 : !station->tool.name[0] || strcmp(pose->name, station->tool.name) == 0) {
            station->tool = *pose;
            has_pose = true;
            station->arrived_ms = clock_ms();
            station->time_s = poses->time_s;
            station->number++;
            system_wake(&station->wakes[WAITER]);
        }
    }
    void (*call)(void) = has_pose ? station->on_pose : NULL;
    pthread_mutex_unlock(&station->lock);
    if (call) {
        call();
    }
}

static void add_counts(struct igtl_counts *sum, const struct igtl_counts *counts)
{
    sum->messages += counts->messages;
    sum->poses += counts->poses;
    sum->broken += counts->broken;
    sum->refused += counts->refused;
    sum->mirrored += counts->mirrored;
}

static void update_counts(struct station *station)
{
    pthread_mutex_lock(&station->lock);
    station->counts = station->past;
    station->clients = 0;
    for (int p = 0; p < PEERS; p++) {
        if (station->peers[p].socket >= 0) {
            add_counts(&station->counts, &station->peers[p].reader.counts);
            station->clients++;
        }
    }
    pthread_mutex_unlock(&station->lock);
}

static void drop_peer(struct station *station, struct peer *peer, bool was_nonsense)
{
    close(peer->socket);
    pthread_mutex_lock(&station->lock);
    add_counts(&station->past, &peer->reader.counts);
    station->dropped += was_nonsense;
    pthread_mutex_unlock(&station->lock);
    memset(peer, 0, sizeof *peer);
    peer->socket = -1;
    station->next_try_ms = clock_ms() + RETRY_MS;
}

static void receive(struct station *station, struct peer *peer)
{
    uint8_t bytes[CHUNK];
    ssize_t size = recv(peer->socket, bytes, sizeof bytes, MSG_DONTWAIT);
    if (size > 0) {
        if (!igtl_read(&peer->reader, bytes, (size_t)size, take_poses, station)) {
            drop_peer(station, peer, true);
        } else if (peer->reader.valid) {
            peer->heard_ms = clock_ms();
        }
    } else if (size == 0 || (errno != EAGAIN && errno != EINTR)) {
        drop_peer(station, peer, false);
    }
}

static void transmit(struct station *station, struct peer *peer)
{
    ssize_t size = send(peer->socket, peer->out + peer->sent, peer->out_size - peer->sent, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (size >= 0) {
        peer->sent += (size_t)size;
    } else if (errno != EAGAIN && errno != EINTR) {
        drop_peer(station, peer, false);
    }
}

/* Prepares the newest message, unless one is still being sent. */
static void prepare(struct station *station, struct peer *peer)
{
    pthread_mutex_lock(&station->lock);
    if (peer->sent == peer->out_size && peer->sent_number != station->outgoing_number) {
        memcpy(peer->out, station->outgoing, station->outgoing_size);
        peer->out_size = station->outgoing_size;
        peer->sent = 0;
        peer->sent_number = station->outgoing_number;
    }
    pthread_mutex_unlock(&station->lock);
}

/* Frees the place of the peer that has been silent longest; NULL where all have sent something lately. */
static struct peer *replace_silent(struct station *station)
{
    struct peer *silent = &station->peers[0];
    for (int p = 1; p < PEERS; p++) {
        silent = station->peers[p].heard_ms < silent->heard_ms ? &station->peers[p] : silent;
    }
    if (clock_ms() - silent->heard_ms <= 1e3 * stale_after_s) {
        return NULL;
    }
    drop_peer(station, silent, false);
    return silent;
}

static void welcome(struct station *station, int socket)
{
    int yes = 1;
    struct peer *peer = NULL;
    for (int p = 0; p < PEERS && !peer; p++) {
        peer = station->peers[p].socket < 0 ? &station->peers[p] : NULL;
    }
    peer = peer ? peer : replace_silent(station);
    if (!peer) {
        close(socket);
        return;
    }
    setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    peer->socket = socket;
    peer->heard_ms = clock_ms();
    if (station->options.host) { /* servers of tracking data send on request */
        size_t size = igtl_write_start(peer->out, sizeof peer->out, "STT_TDATA", REQUEST_MS);
        size += igtl_write_start(peer->out + size, sizeof peer->out - size, "STT_QTDATA", REQUEST_MS);
        peer->out_size = size;
    }
}

static void note_trouble(struct station *station, const char *trouble)
{
    pthread_mutex_lock(&station->lock);
    station->trouble = trouble;
    pthread_mutex_unlock(&station->lock);
}

/* Has programs that are started not get it, and its end be an error of send(); it never waits. */
static int keep(int socket)
{
    if (socket >= 0) {
        fcntl(socket, F_SETFD, FD_CLOEXEC);
        fcntl(socket, F_SETFL, O_NONBLOCK);
#ifdef SO_NOSIGPIPE /* where send() may not know MSG_NOSIGNAL */
        setsockopt(socket, SOL_SOCKET, SO_NOSIGPIPE, &(int){1}, sizeof(int));
#endif
    }
    return socket;
}

static bool connect_soon(int socket, const struct addrinfo *to)
{
    struct pollfd wanted = {.fd = socket, .events = POLLOUT};
    int error = 0;
    socklen_t size = sizeof error;
    if (connect(socket, to->ai_addr, to->ai_addrlen) == 0) {
        return true;
    }
    if (errno != EINPROGRESS || poll(&wanted, 1, CONNECT_MS) != 1) {
        return false;
    }
    getsockopt(socket, SOL_SOCKET, SO_ERROR, &error, &size);
    errno = error;
    return !error;
}

/* A connection that we make; waits a little at most, on the station's own thread. */
static void try_connection(struct station *station)
{
    const struct addrinfo hints = {.ai_socktype = SOCK_STREAM};
    struct addrinfo *found = NULL;
    char port[8];
    snprintf(port, sizeof port, "%u", station->port);
    station->next_try_ms = clock_ms() + RETRY_MS;
    int code = getaddrinfo(station->options.host, port, &hints, &found);
    if (code) {
        note_trouble(station, gai_strerror(code));
        return;
    }
    int socket_ = keep(socket(found->ai_family, SOCK_STREAM, 0));
    bool fine = socket_ >= 0 && connect_soon(socket_, found);
    note_trouble(station, fine ? NULL : strerror(errno));
    if (fine) {
        welcome(station, socket_);
    } else if (socket_ >= 0) {
        close(socket_);
    }
    freeaddrinfo(found);
}

static bool is_stopped(struct station *station)
{
    pthread_mutex_lock(&station->lock);
    bool stop = station->stop;
    pthread_mutex_unlock(&station->lock);
    return stop;
}

/* Has it wait for the next waking. */
static void forget(const struct system_wake *wake)
{
    char bytes[CHUNK];
    while (read((int)wake->file, bytes, sizeof bytes) > 0) {
    }
}

/* Reads from connected peers before it accepts a new one, which may take the place of a silent peer. */
static void serve(struct station *station)
{
    struct pollfd polled[PEERS + 2] = {{.fd = (int)station->wakes[THREAD].file, .events = POLLIN},
                                       {.fd = station->listener, .events = POLLIN}};
    for (int p = 0; p < PEERS; p++) {
        struct peer *peer = &station->peers[p];
        prepare(station, peer);
        polled[2 + p].fd = peer->socket;
        polled[2 + p].events = (short)(peer->sent < peer->out_size ? POLLIN | POLLOUT : POLLIN);
    }
    poll(polled, PEERS + 2, 100);
    if (polled[0].revents) {
        forget(&station->wakes[THREAD]);
    }
    for (int p = 0; p < PEERS; p++) {
        struct peer *peer = &station->peers[p];
        if (peer->socket >= 0 && peer->socket == polled[2 + p].fd && polled[2 + p].revents & POLLOUT) {
            transmit(station, peer);
        }
        if (peer->socket >= 0 && peer->socket == polled[2 + p].fd &&
            polled[2 + p].revents & (POLLIN | POLLHUP | POLLERR)) {
            receive(station, peer);
        }
    }
    if (polled[1].revents & POLLIN) {
        int socket = keep(accept(station->listener, NULL, NULL));
        if (socket >= 0) {
            welcome(station, socket);
        }
    }
}

static void *run(void *user)
{
    struct station *station = user;
    while (!is_stopped(station)) {
        if (station->options.host && station->peers[0].socket < 0 && clock_ms() >= station->next_try_ms) {
            try_connection(station);
        }
        serve(station);
        update_counts(station);
    }
    return NULL;
}

static bool open_listener(struct station *station, char *why, size_t size)
{
    const char *address = station->options.listen ? station->options.listen : "127.0.0.1";
    struct sockaddr_in place = {.sin_family = AF_INET, .sin_port = htons(station->port)};
    socklen_t length = sizeof place;
    int yes = 1;
    if (inet_pton(AF_INET, address, &place.sin_addr) != 1) {
        snprintf(why, size, "tracker: \"%s\" is no IPv4 address to wait on", address);
        return false;
    }
    station->listener = keep(socket(AF_INET, SOCK_STREAM, 0));
    if (station->listener >= 0) {
        setsockopt(station->listener, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    }
    if (station->listener < 0 || bind(station->listener, (struct sockaddr *)&place, sizeof place) ||
        listen(station->listener, PEERS) || getsockname(station->listener, (struct sockaddr *)&place, &length)) {
        snprintf(why, size, "tracker: cannot wait on %s:%u: %s", address, station->port, strerror(errno));
        return false;
    }
    station->port = ntohs(place.sin_port);
    return true;
}

static char *copied(const char *text)
{
    return text ? strdup(text) : NULL;
}

static void free_station(struct station *station)
{
    for (int p = 0; p < PEERS; p++) {
        if (station->peers[p].socket >= 0) {
            close(station->peers[p].socket);
        }
    }
    if (station->listener >= 0) {
        close(station->listener);
    }
    for (size_t i = 0; i < station->wake_count; i++) {
        system_wake_end(&station->wakes[i]);
    }
    pthread_mutex_destroy(&station->lock);
    free((char *)station->options.host);
    free((char *)station->options.listen);
    free((char *)station->options.tool);
    free((char *)station->options.second);
    free((char *)station->options.reference);
    free((char *)station->options.head);
    free(station);
}

static void set_options(struct station *station, const struct station_options *options)
{
    static const double identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    station->options = *options;
    station->options.host = copied(options->host);
    station->options.listen = copied(options->listen);
    station->options.tool = copied(options->tool);
    station->options.second = copied(options->second);
    station->options.reference = copied(options->reference);
    station->options.head = copied(options->head);
    station->options.enlarged = options->enlarged > 0 ? options->enlarged : 1;
    if (options->world_from_tracker[15] == 0) {
        memcpy(station->options.world_from_tracker, identity, sizeof identity);
    }
    if (options->tracker_from_screen[15] == 0) {
        memcpy(station->options.tracker_from_screen, identity, sizeof identity);
    }
    station->port = options->port || !options->host ? options->port : STATION_PORT;
}

bool station_start(struct station **out, const struct station_options *options, char *why, size_t size)
{
    struct station *station = calloc(1, sizeof *station);
    snprintf(why, size, "tracker: not enough memory");
    if (!station) {
        return false;
    }
    for (int p = 0; p < PEERS; p++) {
        station->peers[p].socket = -1;
    }
    pthread_mutex_init(&station->lock, NULL);
    set_options(station, options);
    station->listener = -1;
    while (station->wake_count < WAKES && system_wake_begin(&station->wakes[station->wake_count])) {
        station->wake_count++;
    }
    bool open = station->wake_count == WAKES && (options->host || open_listener(station, why, size));
    if (!open || pthread_create(&station->thread, NULL, run, station)) {
        free_station(station);
        return false;
    }
    *out = station;
    return true;
}

void station_stop(struct station *station)
{
    if (station) {
        pthread_mutex_lock(&station->lock);
        station->stop = true;
        pthread_mutex_unlock(&station->lock);
        system_wake(&station->wakes[THREAD]);
        pthread_join(station->thread, NULL);
        free_station(station);
    }
}

/* The state of a tool whose newest pose is age_s old. The caller holds the lock. */
static enum station_state state_of(const struct station *station, const struct igtl_pose *tool, double age_s)
{
    const struct station_options *options = &station->options;
    bool has_reference = !options->reference || station->reference.name[0];
    if (!station->clients && age_s > stale_after_s) {
        return STATION_WAITING;
    }
    if (!tool->name[0] || !has_reference) {
        return STATION_SILENT;
    }
    bool lost = tool->lost || (options->reference && station->reference.lost);
    return lost ? STATION_LOST : age_s > stale_after_s ? STATION_STALE : STATION_SEEN;
}

static void fill_update(struct station *station, struct station_update *out)
{
    *out = (struct station_update){.number = station->number,
                                   .time_s = station->time_s,
                                   .counts = station->counts,
                                   .dropped = station->dropped,
                                   .trouble = station->trouble,
                                   .clients = station->clients};
    out->age_s = station->number ? (clock_ms() - station->arrived_ms) / 1e3 : INFINITY;
    out->state = state_of(station, &station->tool, out->age_s);
    if (out->state == STATION_SEEN) {
        device_pose(&out->pose, station, &station->tool);
    }
    double second_age_s = station->second_number ? (clock_ms() - station->second_arrived_ms) / 1e3 : INFINITY;
    out->second = (struct station_tool){.state = state_of(station, &station->second, second_age_s),
                                        .number = station->second_number};
    if (out->second.state == STATION_SEEN) {
        device_pose(&out->second.pose, station, &station->second);
    }
    double head_age_s = station->head.name[0] ? (clock_ms() - station->head_arrived_ms) / 1e3 : INFINITY;
    out->head.state = state_of(station, &station->head, head_age_s);
    if (out->head.state == STATION_SEEN) {
        head_pose(&out->head, station);
    }
}

void station_on_pose(struct station *station, void (*call)(void))
{
    pthread_mutex_lock(&station->lock);
    station->on_pose = call;
    pthread_mutex_unlock(&station->lock);
}

void station_ask(struct station *station, struct station_update *out)
{
    pthread_mutex_lock(&station->lock);
    fill_update(station, out);
    pthread_mutex_unlock(&station->lock);
}

bool station_wait(struct station *station, uint64_t after, double seconds, struct station_update *out)
{
    struct pollfd arrived = {.fd = (int)station->wakes[WAITER].file, .events = POLLIN};
    const double end_ms = clock_ms() + 1e3 * seconds;
    double left_ms = 1e3 * seconds;
    station_ask(station, out);
    while (out->number <= after && left_ms > 0) {
        if (poll(&arrived, 1, (int)ceil(left_ms)) > 0) {
            forget(&station->wakes[WAITER]);
        }
        station_ask(station, out);
        left_ms = end_ms - clock_ms();
    }
    return out->number > after;
}

void station_send(struct station *station, const char *json, const struct igtl_point *points, size_t count)
{
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    double time_s = (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
    pthread_mutex_lock(&station->lock);
    size_t size = igtl_write_string(station->outgoing, OUTGOING, "conus", time_s, json);
    size += igtl_write_points(station->outgoing + size, OUTGOING - size, "conus", time_s, points, count);
    station->outgoing_size = size;
    station->outgoing_number++;
    pthread_mutex_unlock(&station->lock);
    system_wake(&station->wakes[THREAD]);
}

const char *station_host(const struct station *station)
{
    return station->options.host;
}

uint16_t station_port(struct station *station)
{
    return station->port;
}
