/* The reference firmware's state machine and framing: C99, no allocation, no libm, no clock.
 *
 * The twin of src/squeezefilm/instruments/device/machine/; docs/development/protocol.md states the rules.
 * Everything is integer (us, uV, mHz, um); the volts on the wire, IEEE binary32, are turned into uV in integers too,
 * exactly. Not reentrant: call it from one context, or mask interrupts around it.
 *
 * A board gives its hooks (sf_board) and three calls: sf_receive for every byte from the host,
 * sf_tick every tick_period from a hardware timer (at least every 1 ms), sf_trip from the
 * amplifier's fault line. The carrier hook must set the output; nothing else may. A board also
 * needs its own hardware watchdog: no program can vouch for itself when it hangs.
 */
#ifndef SQUEEZEFILM_FW_H
#define SQUEEZEFILM_FW_H

#include <stddef.h>
#include <stdint.h>

#include "squeezefilm_loops.h"

#define SF_VERSION 1
#define SF_REVISION 2 /* of the messages; a session has 1 until its host asks for more */
#define SF_LONGEST_FRAME 252
#define SF_MOST_LEVELS 56
#define SF_LONGEST_TILE 512
#define SF_LONGEST_QUEUE 512
#define SF_FIRMWARE_VERSION 1

enum { SF_OFF, SF_ARMED, SF_PLAYING, SF_FAULT };
enum { SF_NONE, SF_WATCHDOG, SF_HEAT, SF_DUTY, SF_LATE_TICK, SF_TRIPPED };
enum {
    SF_ACCEPTED, SF_BAD_VERSION, SF_BAD_TYPE, SF_BAD_LENGTH, SF_BAD_SEQUENCE, SF_BAD_STATE,
    SF_BAD_VALUE, SF_BAD_TOKEN, SF_NO_LIMITS, SF_BAD_TILE, SF_FULL, SF_NO_LOOPS
};
enum { SF_PLAY_NOTHING, SF_PLAY_ENVELOPE, SF_PLAY_TIMED, SF_PLAY_PLACE, SF_PLAY_FINGER };

/* uV, V/s (= uV/us), uV, V2*ms, mHz, mHz, permille, ms. */
typedef struct {
    uint32_t voltage, slew, continuous_voltage, heat;
    uint32_t lowest_frequency, highest_frequency, duty, duty_window;
} sf_limits;

/* Called at every tick: the enable line, the amplitude (uV, zero-to-peak), the carrier (mHz). */
typedef void (*sf_carrier)(void *board, int enabled, uint32_t level, uint32_t frequency);
/* Called with the bytes of one answer or reading. Must not wait: where they do not fit it drops
 * them, all or none. */
typedef void (*sf_send)(void *board, const uint8_t *bytes, size_t count);
typedef struct {
    int32_t x, y; /* um */
    int touching; /* 0 or 1 */
} sf_finger;
/* The newest converted position. Must not wait; called in a tick that needs it. */
typedef sf_finger (*sf_sensor)(void *board);
/* The amplitude at the pickup's input, uV zero-to-peak. Must not wait. */
typedef uint32_t (*sf_pickup)(void *board);

enum { SF_SEARCH, SF_RESUME, SF_SKIP };
struct sf_machine;
/* The loops' part of the state machine: squeezefilm_held.c, which only a board with loops links. */
typedef struct {
    /* Gains to set, or a switch; returns what became of it. */
    int (*take)(struct sf_machine *m, int set, const uint8_t *payload);
    void (*begin)(struct sf_machine *m, int how);
    uint32_t (*level)(struct sf_machine *m, uint32_t asked, int ticked);
    void (*report)(const struct sf_machine *m, uint8_t *payload);
} sf_loop_code;
extern const sf_loop_code sf_held;

/* The loops of a board. It fills in the first three: &sf_held, what the pickup showed over the last tick
 * (uV: in phase with the drive, and 90 degrees ahead), and the plate's temperature (1/1000 degree C;
 * NULL if unknown). */
typedef struct {
    const sf_loop_code *code;
    void (*phases)(void *board, int32_t *in_phase, int32_t *ahead);
    int32_t (*temperature)(void *board);
    sf_loop_gains gains;
    sf_loop_state state;
    sf_loop_command command;
    uint32_t wanted; /* uV, what the free plate would need */
} sf_loops;

/* What a board supplies. `sensor`, `pickup` and `loops` are NULL where there is none; `tick_period` is
 * how often it calls sf_tick, and the step of the loops (us). */
typedef struct {
    void *board;
    sf_carrier carrier;
    sf_send send;
    sf_sensor sensor;
    sf_pickup pickup;
    uint32_t tick_period;
    sf_loops *loops;
} sf_board;

typedef struct sf_machine {
    sf_board board;
    sf_limits own;      /* the firmware's own limits, which no message passes */
    sf_limits limits;   /* the session's; meaningless until has_limits */
    int has_limits;
    int state, fault;
    uint32_t level, frequency;
    int64_t heat, used;
    uint32_t now, ticked, heard, token, session, revision;
    uint32_t accepted, refused, damaged, late_ticks;
    int opened, has_gains, holding; /* gains: of the loops, which hold the plate or not */
    uint16_t last, sent;
    int playing; /* SF_PLAY_... */
    int dry, late;
    uint32_t envelope[SF_MOST_LEVELS];
    uint32_t envelope_count, period, began;
    int32_t place;
    uint32_t queue_time[SF_LONGEST_QUEUE], queue_level[SF_LONGEST_QUEUE];
    uint32_t queue_first, queue_count, held, played;
    int has_played;
    uint32_t report_period, report_due;
    uint32_t tile[SF_LONGEST_TILE];
    uint32_t tile_pitch, tile_size, tile_filled;
    int32_t tile_origin;
    uint8_t frame[SF_LONGEST_FRAME]; /* what has come of one, unstuffed, and its CRC up to there */
    uint32_t frame_count, stuffed, block_left, crc;
} sf_machine;

/* Boots off. `seed` is where tokens start: take a random number, or a counter of boots. A board that
 * keeps `heat` and `used` over a reset sets them in the machine afterwards. */
void sf_boot(sf_machine *m, const sf_limits *own, uint32_t seed, const sf_board *board);
void sf_receive(sf_machine *m, uint8_t byte, uint32_t now);
/* Returns the output, uV. */
uint32_t sf_tick(sf_machine *m, uint32_t now);
void sf_trip(sf_machine *m);

/* uV of the bits of a binary32 in V, to the nearest; -1 if NaN, infinite, negative or above 2000 V. */
int32_t sf_level(uint32_t bits);
uint32_t sf_get32(const uint8_t *p);
void sf_put32(uint8_t *p, uint32_t value);
uint32_t sf_crc32(const uint8_t *bytes, size_t count);
/* Returns the count written; the room needed is count + count/254 + 1. */
size_t sf_cobs_encode(const uint8_t *bytes, size_t count, uint8_t *out);

#endif
