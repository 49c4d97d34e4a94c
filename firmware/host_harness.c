/* The firmware in tests: one machine, driven by a script of calls. It runs on this computer, with
 * sanitizers or without, and built for Arm in an emulator; tests/protocol/recording.py writes the
 * script and what the Python twin did.
 *
 * Every number in a script is 32 bits, little-endian. What is written after a call is what it sent
 * (its count, then its bytes), and after a tick its level.
 */
#include "host_harness.h"

#include <string.h>

static sf_machine machine;
static const uint8_t *script;
static uint8_t *record;
static size_t recorded, record_room;
static uint32_t carrier_level, carrier_frequency;
static int carrier_enabled;
static sf_finger finger;
static uint32_t pickup_level;
static int32_t in_phase, ahead, warmth;
static sf_loops loops;

static void put(const void *bytes, size_t count)
{
    if (recorded + count <= record_room)
        memcpy(record + recorded, bytes, count);
    recorded += count;
}

static uint32_t number(void)
{
    uint32_t value = (uint32_t)script[0] | (uint32_t)script[1] << 8 | (uint32_t)script[2] << 16 |
                     (uint32_t)script[3] << 24;
    script += 4;
    return value;
}

static void carrier(void *board, int enabled, uint32_t level, uint32_t frequency)
{
    (void)board;
    carrier_enabled = enabled;
    carrier_level = level;
    carrier_frequency = frequency;
}

static void send(void *board, const uint8_t *bytes, size_t count)
{
    (void)board;
    put(bytes, count);
}

static sf_finger sensor(void *board)
{
    (void)board;
    return finger;
}

static uint32_t pickup(void *board)
{
    (void)board;
    return pickup_level;
}

static void phases(void *board, int32_t *p, int32_t *q)
{
    (void)board;
    *p = in_phase;
    *q = ahead;
}

static int32_t temperature(void *board)
{
    (void)board;
    return warmth;
}

static void boot(void)
{
    static const sf_loops none = {&sf_held, phases, temperature, {0}, {0}, {0}, 0};
    sf_limits own = {number(), 0, 0, 0, 0, 0, 0, 0};
    sf_board board = {NULL, carrier, send, NULL, NULL, 0, NULL};
    uint32_t seed;
    own.slew = number();
    own.continuous_voltage = number();
    own.heat = number();
    own.lowest_frequency = number();
    own.highest_frequency = number();
    own.duty = number();
    own.duty_window = number();
    seed = number();
    if (number()) {
        board.sensor = sensor;
        board.pickup = pickup;
        board.loops = &loops;
    }
    loops = none;
    board.tick_period = number();
    sf_boot(&machine, &own, seed, &board);
}

static void feed(void)
{
    finger.x = (int32_t)number();
    finger.y = (int32_t)number();
    finger.touching = (int)number();
    pickup_level = number();
    in_phase = (int32_t)number();
    ahead = (int32_t)number();
    warmth = (int32_t)number();
}

static void snapshot(void)
{
    const int64_t values[] = {
        machine.state, machine.fault, machine.level, machine.frequency, machine.heat,
        machine.used, machine.token, machine.session, machine.accepted, machine.refused,
        machine.damaged, machine.late_ticks, machine.playing, machine.queue_count, machine.dry,
        machine.late, carrier_enabled, carrier_level, carrier_frequency, machine.revision,
        machine.has_gains, machine.holding, loops.wanted,
    };
    put(values, sizeof values);
    put(&loops.state, sizeof loops.state);
    put(&loops.command, sizeof loops.command);
}

/* Puts the count of what was sent since `from` in the room that was left for it. */
static void end_of_call(size_t from)
{
    uint32_t count = (uint32_t)(recorded - from - 4);
    if (recorded <= record_room)
        memcpy(record + from, &count, sizeof count);
}

static void none_sent_yet(void) { put("\0\0\0\0", 4); }

size_t host_run(const uint8_t *calls, size_t count, uint8_t *out, size_t room)
{
    const uint8_t *end = calls + count;
    script = calls;
    record = out;
    record_room = room;
    recorded = 0;
    while (script < end) {
        uint8_t call = *script++;
        size_t from = recorded;
        if (call == 'B') {
            boot();
        } else if (call == 'F') {
            feed();
        } else if (call == 'X') {
            sf_trip(&machine);
        } else if (call == 'S') {
            snapshot();
        } else if (call == 'T') {
            uint32_t level;
            none_sent_yet();
            level = sf_tick(&machine, number());
            end_of_call(from);
            put(&level, sizeof level);
        } else {
            uint32_t now = number(), left = number();
            none_sent_yet();
            for (; left; left--)
                sf_receive(&machine, *script++, now);
            end_of_call(from);
        }
    }
    return recorded;
}

void host_levels(const uint32_t *bits, size_t count, int32_t *out)
{
    for (size_t i = 0; i < count; i++)
        out[i] = sf_level(bits[i]);
}
