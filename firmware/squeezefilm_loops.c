/* See squeezefilm_loops.h; the equations are in src/squeezefilm/instruments/control/plate_loop.py. */
#include "squeezefilm_loops.h"

#define QUARTER ((int64_t)1 << 30)
#define ONE ((int64_t)1 << 16)
#define MOST_PICKUP ((int64_t)1 << 24)
#define MOST (MOST_PICKUP * 16)
#define FINE 8
#define WHOLE (1 << 24)
#define ANY 0x7FFFFFFF
#define LARGEST_LOAD (64 * ONE)
#define LEAST_LOAD (-(ONE / 2))

/* --- arithmetic -------------------------------------------------------------------------- */

/* value / 2^bits, to the nearest, halves away from zero. */
static int64_t scaled(int64_t value, int bits)
{
    int64_t half = (int64_t)1 << (bits - 1);
    return value >= 0 ? (value + half) >> bits : -((half - value) >> bits);
}

static int64_t clamped(int64_t value, int64_t lowest, int64_t highest)
{
    return value < lowest ? lowest : value > highest ? highest : value;
}

static int64_t size_of(int64_t value) { return value < 0 ? -value : value; }

/* 2^30 times the sine of turn / 2^32 turns. All but `factor` is at least 0 where it is shifted. */
static int64_t sine(int64_t angle)
{
    uint32_t turn = (uint32_t)angle;
    int64_t part = turn & (QUARTER - 1), square, factor, value;
    if (turn & QUARTER)
        part = QUARTER - part;
    square = (part * part) >> 30;
    factor = 85291978 - ((4652625 * square) >> 30);
    factor = ((factor * square) >> 30) - 693522166;
    factor = 1686624005 + scaled(factor * square, 30);
    value = (part * factor) >> 30;
    return turn & (2 * QUARTER) ? -value : value;
}

/* --- what a step shows -------------------------------------------------------------------- */

/* Load and detuning of the last step, 2^16. */
static void departures(
    const sf_loop_gains *g, const sf_loop_state *s, int64_t re, int64_t im, int64_t free,
    int64_t size, int64_t *extra, int64_t *detuning)
{
    const int64_t wide = (int64_t)1 << 38, narrow = (int64_t)1 << 28;
    int64_t x = re - scaled(g->keep * s->re, 24) - scaled(g->take * free, 24);
    int64_t y = im - scaled(g->keep * s->im, 24);
    int64_t along = -(x * s->re + y * s->im), across = -(y * s->re - x * s->im);
    while (size >= (int64_t)1 << 30) {
        size >>= 2;
        along /= 4;
        across /= 4;
    }
    along = clamped(along, -wide, wide) * ((int64_t)1 << 24) / size;
    across = clamped(across, -wide, wide) * ((int64_t)1 << 24) / size;
    along = scaled(clamped(along, -narrow, narrow) * g->turnover, 24);
    across = scaled(clamped(across, -narrow, narrow) * g->turnover, 24);
    *extra = clamped(along, -LARGEST_LOAD, LARGEST_LOAD);
    *detuning = clamped(across, -LARGEST_LOAD, LARGEST_LOAD);
}

/* size / (size + soft^2), 2^16. */
static int64_t belief(int64_t size, int64_t soft)
{
    int64_t whole = size + soft * soft;
    while (whole >= (int64_t)1 << 46) {
        whole >>= 2;
        size >>= 2;
    }
    return size * ONE / whole;
}

/* Follows what was seen; returns a flag for a limit of the frequency. */
static int64_t track(const sf_loop_gains *g, sf_loop_state *s, int64_t re, int64_t im, int64_t free)
{
    int64_t floor = g->floor * 16, size = s->re * s->re + s->im * s->im;
    int64_t low = g->lowest_frequency * 256, high = g->highest_frequency * 256;
    int64_t extra, error, share;
    if (size >= floor * floor) {
        departures(g, s, re, im, free, size, &extra, &s->detuning);
        share = belief(size, g->soft * 16);
        error = scaled(scaled(g->half_bandwidth * s->detuning, 8) * share, 16);
        s->rate -= scaled(scaled(g->rate_share * share, 16) * error, 24);
        s->frequency += s->rate - scaled(g->track_share * error, 24);
        s->load += scaled(scaled(g->load_share * share, 16) * (extra * 16 - s->load), 24);
    }
    if (low <= s->frequency && s->frequency <= high)
        return 0;
    s->frequency = clamped(s->frequency, low, high);
    s->rate = 0;
    return SF_FREQUENCY_HELD;
}

/* --- modes -------------------------------------------------------------------------------- */

static int64_t search(const sf_loop_gains *g, sf_loop_state *s, int64_t re, int64_t im, int64_t free)
{
    int on_axis = size_of(re) > size_of(im);
    int strong = size_of(re) >= g->floor * 16 && size_of(re) * (ONE + g->heaviest) >= free * ONE;
    int64_t level = g->search_level;
    s->rate = s->load = s->detuning = 0;
    if (!on_axis)
        s->ready = 1;
    s->wrong = on_axis && strong ? s->wrong + 1 : 0;
    if (re > 0 && s->ready == 1 && s->wrong > g->patience >> 2) {
        s->mode = SF_PROBING;
        s->wrong = 0;
    } else if (re < 0 && s->wrong > g->patience) {
        s->mode = SF_WRONG_SIGN;
        level = 0;
    }
    if (s->mode == SF_SEARCHING) {
        s->frequency -= g->sweep;
        if (s->frequency < g->lowest_frequency * 256) {
            s->mode = SF_NOT_FOUND;
            s->frequency = g->lowest_frequency * 256;
            level = 0;
        }
    }
    return level;
}

static void probe(const sf_loop_gains *g, sf_loop_state *s, int64_t re, int64_t im, int64_t free)
{
    const sf_loop_state before = *s;
    int64_t shift = g->half_bandwidth * (1 << (FINE - 1)), last = 2 * g->patience, seen;
    track(g, s, re, im, free);
    s->ready = 0;
    s->wrong++;
    if (s->wrong == g->patience) {
        s->frequency += shift;
        s->rate = 0;
    } else if (s->wrong > g->patience) {
        s->frequency = before.frequency;
        s->load = before.load;
        s->rate = before.rate;
        if (s->wrong > last - (g->patience >> 2))
            s->rate += s->detuning;
        if (s->wrong == last) {
            seen = s->rate / (g->patience >> 2);
            s->frequency -= shift;
            s->rate = s->wrong = 0;
            s->mode = ONE >> 3 < seen && seen < ONE ? SF_LOCKED : SF_SEARCHING;
            if (s->mode != SF_LOCKED)
                s->false_locks++;
        }
    }
}

static int64_t hold(
    const sf_loop_gains *g, sf_loop_state *s, int64_t re, int64_t im, int64_t wanted, int64_t free,
    int64_t *flags)
{
    int64_t floor = g->floor * 16, target, need, asked, level;
    int missing, strange;
    *flags = track(g, s, re, im, free);
    target = clamped(scaled(g->ratio * wanted, 20), 0, MOST);
    need = target + scaled(g->correction * (target - re), 16) + scaled(s->load * re, 20);
    asked = scaled(clamped(need, -4 * MOST, 4 * MOST) * g->inverse, 20);
    level = clamped(asked, g->lowest_level, g->highest_level);
    if (level < asked)
        *flags |= SF_LEVEL_HELD;
    missing = free * ONE > (ONE + g->heaviest) * floor && (re <= size_of(im) || re < floor);
    strange = s->load > g->heaviest * 16 || s->load < LEAST_LOAD * 16;
    s->wrong = missing || strange || *flags & SF_FREQUENCY_HELD ? s->wrong + 1 : 0;
    s->ready = 0;
    if (*flags)
        s->held++;
    if (s->wrong > g->patience) {
        s->mode = SF_SEARCHING;
        s->frequency = g->highest_frequency * 256;
        s->rate = s->load = s->wrong = 0;
        s->ready = 1;
        level = g->search_level;
        if (strange && !missing)
            s->false_locks++;
        else
            s->lost++;
    }
    return level;
}

int sf_loop_allowed(
    const sf_loop_gains *g, int64_t lowest_frequency, int64_t highest_frequency, int64_t highest_level)
{
    static const struct { int32_t lowest, highest; } bounds[] = {
        {0, WHOLE}, {1, WHOLE}, {1 << 16, ANY}, {1, 1 << 26}, {1, ANY}, {-ANY - 1, ANY},
        {1, WHOLE}, {0, WHOLE}, {0, WHOLE}, {0, WHOLE},
        {1, ANY}, {1, ANY}, {1, ANY},
        {-ANY - 1, ANY}, {1, ANY}, {-ANY - 1, ANY},
        {0, 0}, {1, ANY}, {1, ANY}, {1, WHOLE}, {0, WHOLE}, {0, 1 << 22}, {4, 1 << 20},
    };
    const int64_t *number = (const int64_t *)(const void *)g; /* as many, all alike */
    for (int i = 0; i < SF_GAINS; i++)
        if (number[i] < bounds[i].lowest || number[i] > bounds[i].highest)
            return 0;
    return g->keep + g->take == WHOLE && lowest_frequency <= g->lowest_frequency &&
           g->lowest_frequency <= g->reference && g->reference <= g->highest_frequency &&
           g->highest_frequency <= highest_frequency && g->search_level <= g->highest_level &&
           g->highest_level <= highest_level;
}

void sf_loop_begin(sf_loop_state *s, const sf_loop_gains *g)
{
    const sf_loop_state first = {
        SF_SEARCHING, g->highest_frequency * 256, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0};
    *s = first;
}

sf_loop_command sf_loop_step(
    const sf_loop_gains *g, sf_loop_state *s, int32_t p, int32_t q, int64_t wanted, int64_t applied)
{
    sf_loop_command command = {0, scaled(s->frequency, FINE), 0};
    int64_t turn = g->turn + scaled((command.frequency - g->reference) * g->turn_per_mhz, 8);
    int64_t cosine = sine(turn + QUARTER), sinus = sine(turn), re, im;
    int64_t x = clamped(p, -MOST_PICKUP, MOST_PICKUP), y = clamped(q, -MOST_PICKUP, MOST_PICKUP);
    int64_t free = clamped(scaled(g->ratio * applied, 20), -MOST, MOST);
    re = clamped(scaled(x * cosine + y * sinus, 26), -MOST, MOST);
    im = clamped(scaled(y * cosine - x * sinus, 26), -MOST, MOST);
    if (s->mode == SF_SEARCHING) {
        command.level = search(g, s, re, im, free);
    } else if (s->mode == SF_PROBING) {
        command.level = g->search_level;
        probe(g, s, re, im, free);
    } else if (s->mode == SF_LOCKED) {
        command.level = hold(g, s, re, im, wanted, free, &command.flags);
    } else {
        return command;
    }
    s->re = re;
    s->im = im;
    command.frequency = scaled(s->frequency, FINE);
    return command;
}

/* --- friction ----------------------------------------------------------------------------- */

int64_t sf_friction_step(
    const sf_friction_gains *g, const int64_t levels[SF_FRICTION_POINTS], sf_friction_state *s,
    int64_t wanted, int64_t measured, int fresh, int64_t *flags)
{
    const int64_t far = (int64_t)1 << 30, most = g->correction * 256, before = s->sum;
    int64_t highest = g->lowest + (SF_FRICTION_POINTS - 1) * g->pitch, asked, held, place, number;
    *flags = 0;
    if (fresh) {
        s->error = clamped(scaled(s->expected, 8) - measured, -far, far);
        s->sum += scaled(g->integral * s->error, 16);
        if (s->sum > most || s->sum < -most)
            *flags = SF_CORRECTION_HELD;
        s->sum = clamped(s->sum, -most, most);
    }
    s->expected += scaled(g->lag * (wanted * 256 - s->expected), 24);
    asked = wanted + scaled(g->proportional * s->error, 16) + scaled(s->sum, 8);
    held = clamped(asked, g->lowest, highest);
    if (held != asked) {
        *flags |= SF_OUT_OF_REACH;
        if ((asked > highest) == (s->sum > before))
            s->sum = before;
    }
    place = held - g->lowest;
    number = clamped(place / g->pitch, 0, SF_FRICTION_POINTS - 2);
    place -= number * g->pitch;
    return levels[number] + (levels[number + 1] - levels[number]) * place / g->pitch;
}
