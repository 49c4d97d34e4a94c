/* The firmware on a host, for tests: one machine, driven through a shared library. */
#include "squeezefilm_fw.h"

#include <string.h>

static sf_machine machine;
static uint8_t answers[1 << 20];
static size_t answer_count;
static uint32_t carrier_level, carrier_frequency;
static int carrier_enabled;
static sf_finger finger;
static uint32_t pickup_level;

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
    if (answer_count + count <= sizeof answers) {
        memcpy(answers + answer_count, bytes, count);
        answer_count += count;
    }
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

void host_boot(const uint32_t *own, uint32_t seed, int has_sensor, int has_pickup, uint32_t period);
void host_feed(int32_t x, int32_t y, int touching, uint32_t level);
void host_receive(const uint8_t *bytes, size_t count, uint32_t now);
size_t host_outgoing(void);
const uint8_t *host_answers(void);
uint32_t host_tick(uint32_t now);
void host_trip(void);
void host_snapshot(int64_t *out);

void host_boot(const uint32_t *own, uint32_t seed, int has_sensor, int has_pickup, uint32_t period)
{
    sf_limits limits = {own[0], own[1], own[2], own[3], own[4], own[5], own[6], own[7]};
    sf_board board = {NULL, carrier, send, has_sensor ? sensor : NULL, has_pickup ? pickup : NULL,
                      period};
    answer_count = 0;
    sf_boot(&machine, &limits, seed, &board);
}

void host_feed(int32_t x, int32_t y, int touching, uint32_t level)
{
    finger.x = x;
    finger.y = y;
    finger.touching = touching;
    pickup_level = level;
}

void host_receive(const uint8_t *bytes, size_t count, uint32_t now)
{
    for (size_t i = 0; i < count; i++)
        sf_receive(&machine, bytes[i], now);
}

/* How many bytes lie in host_answers since the last call. */
size_t host_outgoing(void)
{
    size_t count = answer_count;
    answer_count = 0;
    return count;
}

const uint8_t *host_answers(void) { return answers; }

uint32_t host_tick(uint32_t now) { return sf_tick(&machine, now); }

void host_trip(void) { sf_trip(&machine); }

void host_snapshot(int64_t *out)
{
    const int64_t values[] = {
        machine.state, machine.fault, machine.level, machine.frequency, machine.heat,
        machine.used, machine.token, machine.session, machine.accepted, machine.refused,
        machine.damaged, machine.late_ticks, machine.playing, machine.queue_count, machine.dry,
        machine.late, carrier_enabled, carrier_level, carrier_frequency,
    };
    memcpy(out, values, sizeof values);
}
