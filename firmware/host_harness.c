/* The firmware on a host, for tests: one machine, driven through a shared library. */
#include "squeezefilm_fw.h"

#include <string.h>

static sf_machine machine;
static uint8_t answers[1 << 20];
static size_t answer_count;
static uint32_t carrier_level, carrier_frequency;
static int carrier_enabled;

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

void host_boot(const uint32_t *own, uint32_t seed);
size_t host_receive(const uint8_t *bytes, size_t count, uint32_t now);
const uint8_t *host_answers(void);
uint32_t host_tick(uint32_t now);
void host_trip(void);
void host_snapshot(int64_t *out);

void host_boot(const uint32_t *own, uint32_t seed)
{
    sf_limits limits = {own[0], own[1], own[2], own[3], own[4], own[5], own[6], own[7]};
    sf_boot(&machine, &limits, seed, carrier, send, NULL);
}

size_t host_receive(const uint8_t *bytes, size_t count, uint32_t now)
{
    answer_count = 0;
    for (size_t i = 0; i < count; i++)
        sf_receive(&machine, bytes[i], now);
    return answer_count;
}

const uint8_t *host_answers(void) { return answers; }

uint32_t host_tick(uint32_t now) { return sf_tick(&machine, now); }

void host_trip(void) { sf_trip(&machine); }

void host_snapshot(int64_t *out)
{
    const int64_t values[] = {
        machine.state, machine.fault, machine.level, machine.frequency, machine.heat,
        machine.used, machine.token, machine.session, machine.accepted, machine.refused,
        machine.damaged, carrier_enabled, carrier_level, carrier_frequency,
    };
    memcpy(out, values, sizeof values);
}
