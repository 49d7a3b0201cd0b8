/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of stations over real sockets of this machine. */
#include "link/station.h"
#include "options/progress.h"
#include "test.h"

#include <arpa/inet.h>
#include <errno.h>
#include <math.h>
#include <poll.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { CAPACITY = 4096, PLACES = 4 /* for peers */ };

static const double turned[16] = {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 10, -20, 30, 1};
static const double identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

static struct station *start(const struct station_options *options)
{
    struct station *station = NULL;
    char why[200];
    if (!station_start(&station, options, why, sizeof why)) {
        fail_msg("%s", why);
    }
    return station;
}

static int connect_to(struct station *station)
{
    const struct sockaddr_in place = {
        .sin_family = AF_INET, .sin_port = htons(station_port(station)), .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    int peer = socket(AF_INET, SOCK_STREAM, 0);
    assert_int_equal(connect(peer, (const struct sockaddr *)&place, sizeof place), 0);
    return peer;
}

static void send_all(int peer, const uint8_t *bytes, size_t size)
{
    while (size > 0) {
        ssize_t sent = send(peer, bytes, size, MSG_NOSIGNAL);
        assert_true(sent > 0);
        bytes += sent;
        size -= (size_t)sent;
    }
}

static void send_pose(int peer, const char *tool, const double matrix[16])
{
    uint8_t bytes[CAPACITY];
    send_all(peer, bytes, igtl_write_transform(bytes, sizeof bytes, tool, 2, matrix));
}

static void moment(void)
{
    usleep(5000);
}

static struct station_update wait_for(struct station *station, uint64_t after)
{
    struct station_update update;
    assert_true(station_wait(station, after, 600, &update));
    return update;
}

static void a_pose_arrives(void **state)
{
    (void)state;
    struct station *station = start(&(struct station_options){0});
    struct station_update update;
    station_ask(station, &update);
    assert_int_equal(update.state, STATION_WAITING);
    int peer = connect_to(station);
    send_pose(peer, "Pointer", turned);
    update = wait_for(station, 0);
    assert_int_equal(update.state, STATION_SEEN);
    assert_int_equal(update.number, 1);
    for (int i = 0; i < 16; i++) {
        assert_near(update.pose.world_from_device[i], turned[i], 0);
    }
    close(peer);
    station_stop(station);
}

/* Whichever axis of the tool is chosen, the device's -z is that axis, and its frame stays right-handed. */
static void the_axis_becomes_the_devices(void **state)
{
    (void)state;
    for (int axis = CONUS_AXIS_PLUS_X; axis <= CONUS_AXIS_MINUS_Z; axis++) {
        struct station *station = start(&(struct station_options){.axis = (conus_axis)axis});
        int peer = connect_to(station);
        send_pose(peer, "Pointer", turned);
        struct station_update update = wait_for(station, 0);
        const double *m = update.pose.world_from_device;
        int of = (axis - CONUS_AXIS_PLUS_X) / 2;
        double sign = (axis - CONUS_AXIS_PLUS_X) % 2 ? -1 : 1;
        for (int a = 0; a < 3; a++) {
            assert_near(-m[8 + a], sign * turned[4 * of + a], 1e-12);
        }
        conus_pose exact;
        assert_ok(conus_pose_from_matrix(&exact, m));
        close(peer);
        station_stop(station);
    }
}

/* The pointer in the head's frame is inv(head) pointer; then from LPS, and in the world. */
static void frames_are_joined(void **state)
{
    (void)state;
    const double head[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 4, 5, 6, 1};
    struct station_options options = {.tool = "Pointer", .reference = "Head", .lps = true};
    memcpy(options.world_from_tracker, identity, sizeof identity);
    options.world_from_tracker[14] = 100;
    struct station *station = start(&options);
    int peer = connect_to(station);
    struct station_update update;
    send_pose(peer, "Other", turned);
    send_pose(peer, "PointerToTracker", turned);
    update = wait_for(station, 0);
    assert_int_equal(update.state, STATION_SILENT); /* without its reference there is no pose */
    send_pose(peer, "HeadToTracker", head);
    send_pose(peer, "PointerToTracker", turned);
    update = wait_for(station, 1);
    assert_int_equal(update.state, STATION_SEEN);
    assert_near(update.pose.world_from_device[12], -(10 - 4), 1e-6);
    assert_near(update.pose.world_from_device[13], -(-20 - 5), 1e-6);
    assert_near(update.pose.world_from_device[14], 30 - 6 + 100, 1e-6);
    send_pose(peer, "HeadToTracker", identity);
    send_pose(peer, "PointerToTracker", turned);
    update = wait_for(station, 2);
    assert_int_equal(update.state, STATION_LOST);
    close(peer);
    station_stop(station);
}

/* Polls until the head is in that state: a head does not wake anybody. */
static struct station_update wait_for_head(struct station *station, enum station_state state)
{
    struct station_update update;
    station_ask(station, &update);
    while (update.head.state != state) {
        moment();
        station_ask(station, &update);
    }
    return update;
}

/* Sends its pose until it is seen, however busy the machine. */
static struct station_update see_head(struct station *station, int peer, const double matrix[16])
{
    struct station_update update = {0};
    while (update.head.state != STATION_SEEN) {
        send_pose(peer, "Glasses", matrix);
        moment();
        station_ask(station, &update);
    }
    return update;
}

/* Eye, screen and tool are in one frame, and all come nearer where the brain is shown larger. A head never points. */
static void a_head_looks_at_the_screen(void **state)
{
    (void)state;
    const double head[16] = {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 100, 200, 600, 1};
    for (int enlarged = 0; enlarged < 3; enlarged++) { /* 0: as large as it is */
        struct station_options options = {.head = "Glasses", .eye = {10, 20, 30}, .lps = true, .enlarged = enlarged};
        memcpy(options.world_from_tracker, identity, sizeof identity);
        memcpy(options.tracker_from_screen, turned, sizeof turned);
        options.world_from_tracker[14] = 50;
        double s = enlarged ? enlarged : 1;
        struct station *station = start(&options);
        int peer = connect_to(station);
        struct station_update update = see_head(station, peer, head);
        assert_int_equal(update.state, STATION_SILENT);
        assert_near(update.head.eye[0], -(100 - 20) / s, 1e-4); /* the protocol's floats */
        assert_near(update.head.eye[1], -(200 + 10) / s, 1e-4);
        assert_near(update.head.eye[2], (600 + 30 + 50) / s, 1e-4);
        const double *m = update.head.screen.world_from_device;
        const double wanted[16] = {0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, -10 / s, 20 / s, 80 / s, 1};
        for (int i = 0; i < 16; i++) {
            assert_near(m[i], wanted[i], 1e-9);
        }
        send_pose(peer, "Pointer", turned);
        update = wait_for(station, 0);
        assert_near(update.pose.world_from_device[14], 80 / s, 1e-9);
        close(peer);
        station_stop(station);
    }
}

static void a_lost_head_has_no_pose(void **state)
{
    (void)state;
    const double cart[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 4, 5, 6, 1};
    struct station *station = start(&(struct station_options){.head = "Glasses", .reference = "Cart"});
    int peer = connect_to(station);
    send_pose(peer, "Glasses", turned);
    wait_for_head(station, STATION_SILENT); /* without its reference there is no pose */
    send_pose(peer, "Cart", cart);
    struct station_update update = see_head(station, peer, turned);
    assert_near(update.head.eye[0], 6, 1e-9);
    assert_near(update.head.screen.world_from_device[12], -4, 1e-9); /* the screen stands still: the cart moves */
    send_pose(peer, "GlassesToTracker", identity);
    wait_for_head(station, STATION_LOST);
    see_head(station, peer, turned);
    wait_for_head(station, STATION_STALE);
    send_pose(peer, "Cart", identity);
    send_pose(peer, "Glasses", turned);
    wait_for_head(station, STATION_LOST);
    close(peer);
    wait_for_head(station, STATION_WAITING);
    station_stop(station);
}

static void lost_and_stale_tools_are_no_poses(void **state)
{
    (void)state;
    struct station *station = start(&(struct station_options){0});
    int peer = connect_to(station);
    send_pose(peer, "Pointer", identity);
    assert_int_equal(wait_for(station, 0).state, STATION_LOST);
    send_pose(peer, "Pointer", turned);
    assert_int_equal(wait_for(station, 1).state, STATION_SEEN);
    struct station_update update;
    assert_false(station_wait(station, 2, 0.6, &update));
    assert_int_equal(update.state, STATION_STALE);
    close(peer);
    station_stop(station);
}

/* A peer that sends nonsense is disconnected. The other one is still heard, and the first may connect again. */
static void nonsense_ends_one_connection_only(void **state)
{
    (void)state;
    static const char nonsense[] = "GET / HTTP/1.1\r\nHost: localhost\r\nAccept: everything there is\r\n\r\n";
    struct station *station = start(&(struct station_options){0});
    int good = connect_to(station);
    send_pose(good, "Pointer", turned);
    wait_for(station, 0);
    for (unsigned round = 1; round <= 3; round++) {
        int bad = connect_to(station);
        uint8_t byte;
        send_all(bad, (const uint8_t *)nonsense, sizeof nonsense);
        assert_true(recv(bad, &byte, 1, 0) <= 0); /* closed by the other side */
        close(bad);
    }
    send_pose(good, "Pointer", turned);
    struct station_update update = wait_for(station, 1);
    assert_int_equal(update.dropped, 3);
    close(good);
    station_stop(station);
}

/* Whether the other side has closed it. */
static bool is_closed(int peer)
{
    uint8_t byte;
    ssize_t size = recv(peer, &byte, 1, MSG_DONTWAIT);
    return size == 0 || (size < 0 && errno != EAGAIN);
}

/* Sends a pose to a connection that may be closed. */
static void try_pose(int peer, const char *tool)
{
    uint8_t bytes[CAPACITY];
    ssize_t sent = send(peer, bytes, igtl_write_transform(bytes, sizeof bytes, tool, 2, turned), MSG_NOSIGNAL);
    (void)sent;
}

/* Connects again until it is let in and heard, while `talker` goes on sending. */
static int be_heard(struct station *station, int talker)
{
    struct station_update update = {0};
    int newcomer = connect_to(station);
    try_pose(newcomer, "Pointer");
    for (int i = 0; i < 10000 && !update.number; i++) {
        if (is_closed(newcomer)) {
            close(newcomer);
            newcomer = connect_to(station);
            try_pose(newcomer, "Pointer");
        }
        send_pose(talker, "Noise", turned);
        moment();
        station_ask(station, &update);
    }
    assert_int_equal(update.number, 1);
    return newcomer;
}

/* One connection for each place, in this order. */
static void connect_all(int peers[PLACES], struct station *station, struct station_update *update)
{
    for (unsigned p = 0; p < PLACES; p++) {
        peers[p] = connect_to(station);
        while (update->clients <= p) {
            moment();
            station_ask(station, update);
        }
    }
}

/* Four silent peers do not keep a tracker out: the one that was silent longest is disconnected, and no other. */
static void idle_peers_give_way(void **state)
{
    (void)state;
    struct station *station = start(&(struct station_options){.tool = "Pointer"});
    struct station_update update = {0};
    int peers[PLACES];
    connect_all(peers, station, &update);
    int newcomer = be_heard(station, peers[0]);
    while (!is_closed(peers[0]) && !is_closed(peers[1]) && !is_closed(peers[2]) && !is_closed(peers[3])) {
        moment();
    }
    assert_true(is_closed(peers[1]));
    assert_false(is_closed(peers[0]));
    assert_false(is_closed(peers[2]));
    assert_false(is_closed(peers[3]));
    assert_false(is_closed(newcomer));
    station_ask(station, &update);
    assert_int_equal(update.clients, PLACES);
    assert_int_equal(update.dropped, 0);
    for (int p = 0; p < PLACES; p++) {
        close(peers[p]);
    }
    close(newcomer);
    station_stop(station);
}

/* Sends a byte from each peer: two send a message with a wrong checksum, two a message of an unknown kind. None is ever
 * valid. */
static void drip(const int peers[PLACES], size_t n)
{
    uint8_t bytes[2][CAPACITY];
    size_t sizes[2] = {igtl_write_transform(bytes[0], CAPACITY, "Pointer", 2, turned),
                       igtl_write_transform(bytes[1], CAPACITY, "Pointer", 2, turned)};
    bytes[0][57] ^= 1; /* the last byte of the header, of the checksum */
    bytes[1][2] = 'X'; /* the first letter of the type */
    for (size_t p = 0; p < PLACES; p++) {
        (void)!send(peers[p], &bytes[p % 2][n % sizes[p % 2]], 1, MSG_NOSIGNAL);
    }
}

/* Four peers that send bytes, but never a valid message, do not keep a tracker out. */
static void peers_that_drip_bytes_give_way(void **state)
{
    (void)state;
    struct station *station = start(&(struct station_options){.tool = "Pointer"});
    struct station_update update = {0};
    int peers[PLACES];
    connect_all(peers, station, &update);
    int newcomer = connect_to(station);
    try_pose(newcomer, "Pointer");
    for (size_t n = 0; n < 10000 && !update.number; n++) {
        if (is_closed(newcomer)) {
            close(newcomer);
            newcomer = connect_to(station);
            try_pose(newcomer, "Pointer");
        }
        drip(peers, n);
        moment();
        station_ask(station, &update);
    }
    assert_int_equal(update.number, 1);
    for (int p = 0; p < PLACES; p++) {
        close(peers[p]);
    }
    close(newcomer);
    station_stop(station);
}

/* All peers send until one of them or the newcomer is disconnected; true if it is the newcomer. @p pause becomes the
 * longest time, s, in which nothing was sent. */
static bool newcomer_is_shown_out(const int peers[PLACES], int newcomer, double *pause)
{
    bool is_out = false;
    double sent = clock_ms();
    *pause = 0;
    for (;;) {
        for (int p = 0; p < PLACES; p++) {
            is_out = is_out || is_closed(peers[p]);
            try_pose(peers[p], "Pointer");
        }
        *pause = fmax(*pause, 1e-3 * (clock_ms() - sent));
        sent = clock_ms();
        if (is_out || is_closed(newcomer)) {
            return !is_out;
        }
        moment();
    }
}

/* All places are taken by peers that send, and none gives way to one more. The test repeats if this thread was paused
 * for longer than the time after which a silent peer gives way. */
static void peers_that_send_keep_their_places(void **state)
{
    (void)state;
    double pause;
    bool is_out = false;
    while (!is_out) {
        struct station *station = start(&(struct station_options){0});
        int peers[PLACES];
        for (int p = 0; p < PLACES; p++) {
            peers[p] = connect_to(station);
            send_pose(peers[p], "Pointer", turned);
        }
        wait_for(station, PLACES - 1);
        int newcomer = connect_to(station);
        is_out = newcomer_is_shown_out(peers, newcomer, &pause);
        assert_true(is_out || pause > 0.3);
        for (int p = 0; p < PLACES; p++) {
            close(peers[p]);
        }
        close(newcomer);
        station_stop(station);
    }
}

static void a_flood_leaves_the_newest_pose(void **state)
{
    (void)state;
    enum { COUNT = 20000 };
    struct station *station = start(&(struct station_options){0});
    int peers[2] = {connect_to(station), connect_to(station)};
    double matrix[16];
    memcpy(matrix, turned, sizeof matrix);
    for (int i = 1; i <= COUNT; i++) {
        matrix[12] = i;
        send_pose(peers[i % 2], i % 2 ? "Noise" : "Pointer", matrix);
    }
    struct station_update update = {0};
    while (update.counts.poses < COUNT) {
        station_wait(station, update.number, 0.05, &update);
    }
    assert_true(update.number == COUNT / 2);
    close(peers[0]);
    close(peers[1]);
    station_stop(station);
}

static void read_exactly(int peer, uint8_t *out, size_t size)
{
    size_t done = 0;
    while (done < size) {
        ssize_t got = recv(peer, out + done, size - done, 0);
        assert_true(got > 0);
        done += (size_t)got;
    }
}

static void sent_selection_arrives(void **state)
{
    (void)state;
    static const char json[] = "{\"best\": \"Insula_L\"}";
    const struct igtl_point point = {.name = "Insula_L", .rgb = {1, 2, 3}, .position = {4, 5, 6}};
    uint8_t bytes[CAPACITY];
    struct station *station = start(&(struct station_options){0});
    int peer = connect_to(station);
    send_pose(peer, "Pointer", turned);
    wait_for(station, 0);
    station_send(station, json, &point, 1);
    size_t text = IGTL_HEADER + 4 + sizeof json - 1;
    read_exactly(peer, bytes, text + IGTL_HEADER + 136);
    assert_memory_equal(bytes + 2, "STRING", 7);
    assert_memory_equal(bytes + IGTL_HEADER + 4, json, sizeof json - 1);
    assert_memory_equal(bytes + text + 2, "POINT", 6);
    assert_memory_equal(bytes + text + IGTL_HEADER, "Insula_L", 9);
    close(peer);
    station_stop(station);
}

/* A client asks for tracking data, and asks again after the server was gone. */
static void a_client_connects_again(void **state)
{
    (void)state;
    struct sockaddr_in place = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t length = sizeof place;
    int server = socket(AF_INET, SOCK_STREAM, 0);
    assert_int_equal(bind(server, (struct sockaddr *)&place, sizeof place), 0);
    assert_int_equal(listen(server, 1), 0);
    assert_int_equal(getsockname(server, (struct sockaddr *)&place, &length), 0);
    struct station *station = start(&(struct station_options){.host = "127.0.0.1", .port = ntohs(place.sin_port)});
    for (uint64_t round = 0; round < 2; round++) {
        uint8_t bytes[CAPACITY];
        int peer = accept(server, NULL, NULL);
        assert_true(peer >= 0);
        read_exactly(peer, bytes, IGTL_HEADER + 36);
        assert_memory_equal(bytes + 2, "STT_TDATA", 10);
        send_pose(peer, "Pointer", turned);
        assert_int_equal(wait_for(station, round).state, STATION_SEEN);
        close(peer);
    }
    close(server);
    station_stop(station);
}

static void a_bad_address_is_said(void **state)
{
    (void)state;
    struct station *station = NULL;
    char why[200];
    assert_false(station_start(&station, &(struct station_options){.listen = "nowhere"}, why, sizeof why));
    assert_non_null(strstr(why, "nowhere"));
    struct station *first = start(&(struct station_options){0});
    const struct station_options same = {.port = station_port(first)};
    assert_false(station_start(&station, &same, why, sizeof why));
    assert_non_null(strstr(why, "cannot wait on"));
    station_stop(first);
    station_stop(NULL);
}

TEST_GROUP(station)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_pose_arrives),
        cmocka_unit_test(the_axis_becomes_the_devices),
        cmocka_unit_test(frames_are_joined),
        cmocka_unit_test(a_head_looks_at_the_screen),
        cmocka_unit_test(a_lost_head_has_no_pose),
        cmocka_unit_test(lost_and_stale_tools_are_no_poses),
        cmocka_unit_test(nonsense_ends_one_connection_only),
        cmocka_unit_test(idle_peers_give_way),
        cmocka_unit_test(peers_that_drip_bytes_give_way),
        cmocka_unit_test(peers_that_send_keep_their_places),
        cmocka_unit_test(a_flood_leaves_the_newest_pose),
        cmocka_unit_test(sent_selection_arrives),
        cmocka_unit_test(a_client_connects_again),
        cmocka_unit_test(a_bad_address_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
