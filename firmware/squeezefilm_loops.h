/* The loops that hold a plate: resonance tracked, amplitude held, a finger's load seen. C99, integers
 * alone, no state of its own. The twin of src/squeezefilm/instruments/control/plate_loop.py, which
 * states the equations, the fields and their units; a test compares the two, number for number.
 *
 * squeezefilm_held.c steps them in the state machine's tick, so that its limits hold of what they ask.
 */
#ifndef SQUEEZEFILM_LOOPS_H
#define SQUEEZEFILM_LOOPS_H

#include <stdint.h>

enum { SF_SEARCHING, SF_PROBING, SF_LOCKED, SF_NOT_FOUND, SF_WRONG_SIGN };
enum { SF_LEVEL_HELD = 1, SF_FREQUENCY_HELD = 2 };

/* How many gains there are; each fits 32 bits. */
#define SF_GAINS 23

typedef struct {
    int64_t keep, take, turnover, ratio, inverse, correction;
    int64_t half_bandwidth, track_share, rate_share, load_share;
    int64_t lowest_frequency, highest_frequency, sweep;
    int64_t turn, reference, turn_per_mhz;
    int64_t lowest_level, highest_level, search_level, floor, soft, heaviest, patience;
} sf_loop_gains;

typedef struct {
    int64_t mode, frequency, rate, load, detuning, re, im, ready, wrong, lost, false_locks, held;
} sf_loop_state;

/* uV (below zero: a turned phase), mHz, SF_..._HELD. */
typedef struct {
    int64_t level, frequency, flags;
} sf_loop_command;

/* Whether no step with these gains can overflow, turns the phase, or leaves these frequencies (mHz)
 * and this level (uV). */
int sf_loop_allowed(
    const sf_loop_gains *g, int64_t lowest_frequency, int64_t highest_frequency, int64_t highest_level);
/* A search that begins, at the highest frequency. */
void sf_loop_begin(sf_loop_state *s, const sf_loop_gains *g);
/* `p` and `q` are the pickup in phase with the drive and 90 degrees ahead, `wanted` and `applied` the
 * level that would hold the amplitude on a free plate and the one that was on the plate; all uV. */
sf_loop_command sf_loop_step(
    const sf_loop_gains *g, sf_loop_state *s, int32_t p, int32_t q, int64_t wanted, int64_t applied);

/* A loop that holds friction: see tests/friction_loop.py. All uN and uV. */
#define SF_FRICTION_POINTS 33
enum { SF_OUT_OF_REACH = 1, SF_CORRECTION_HELD = 2 };

typedef struct {
    int64_t lowest, pitch, proportional, integral, lag, correction;
} sf_friction_gains;

typedef struct {
    int64_t expected, error, sum;
} sf_friction_state;

/* Returns the level, and the flags where they are asked for. */
int64_t sf_friction_step(
    const sf_friction_gains *g, const int64_t levels[SF_FRICTION_POINTS], sf_friction_state *s,
    int64_t wanted, int64_t measured, int fresh, int64_t *flags);

#endif
