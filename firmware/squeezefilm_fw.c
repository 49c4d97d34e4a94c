/* See squeezefilm_fw.h, and docs/protocol.md for the rules and the layout of every frame. */
#include "squeezefilm_fw.h"

#include <string.h>

#define SILENCE 50000u
#define LATE_TICK 10000u
#define LONGEST_RISE 1000u
#define MOST ((int64_t)1 << 62)
#define RAMP 10000u
#define TOUCH_LEVEL 42000000
#define HEADER 4
#define OVERHEAD 8

enum {
    HELLO = 0x01, STOP, SET_LIMITS, ARM, START, SET_FREQUENCY, ENVELOPE, TILE_BEGIN, TILE_DATA,
    POSITION, KEEP_ALIVE, CLEAR_FAULT, STATUS = 0x81
};

/* --- bytes ------------------------------------------------------------------------------- */

static uint16_t get16(const uint8_t *p) { return (uint16_t)(p[0] | (uint16_t)(p[1] << 8)); }

static uint32_t get32(const uint8_t *p)
{
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static int32_t get_signed(const uint8_t *p)
{
    uint32_t bits = get32(p);
    int32_t value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static void put16(uint8_t *p, uint32_t value)
{
    p[0] = (uint8_t)value;
    p[1] = (uint8_t)(value >> 8);
}

static void put32(uint8_t *p, uint32_t value)
{
    put16(p, value);
    put16(p + 2, value >> 16);
}

uint32_t sf_crc32(const uint8_t *bytes, size_t count)
{
    uint32_t crc = 0xFFFFFFFFu;
    for (size_t i = 0; i < count; i++) {
        crc ^= bytes[i];
        for (int bit = 0; bit < 8; bit++)
            crc = (crc >> 1) ^ ((crc & 1u) ? 0xEDB88320u : 0u);
    }
    return ~crc;
}

size_t sf_cobs_encode(const uint8_t *bytes, size_t count, uint8_t *out)
{
    size_t code_at = 0, end = 1;
    for (size_t i = 0; i < count; i++) {
        if (bytes[i])
            out[end++] = bytes[i];
        if (!bytes[i] || (end - code_at == 255 && i + 1 < count)) {
            out[code_at] = (uint8_t)(end - code_at);
            code_at = end++;
        }
    }
    out[code_at] = (uint8_t)(end - code_at);
    return end;
}

int sf_cobs_decode(const uint8_t *bytes, size_t count, uint8_t *out)
{
    size_t at = 0;
    int length = 0;
    while (at < count) {
        size_t code = bytes[at], end = at + code;
        if (code == 0 || end > count)
            return -1;
        for (size_t i = at + 1; i < end; i++) {
            if (!bytes[i])
                return -1;
            out[length++] = bytes[i];
        }
        if (code < 255 && end < count)
            out[length++] = 0;
        at = end;
    }
    return length;
}

/* uV of a binary32 in V, to the nearest; -1 if NaN, infinite, negative or above 2000 V. */
static int64_t level_of(const uint8_t *p)
{
    uint32_t bits = get32(p);
    float volts;
    if ((bits & 0x7F800000u) == 0x7F800000u)
        return -1;
    memcpy(&volts, &bits, sizeof volts);
    if (!(volts >= 0.0f && volts <= 2000.0f))
        return -1;
    return (int64_t)((double)volts * 1e6 + 0.5);
}

/* --- output ------------------------------------------------------------------------------ */

static void forget_playing(sf_machine *m)
{
    m->envelope_count = 0;
    m->at_given = 0;
}

static void fail(sf_machine *m, int fault)
{
    if (m->state != SF_FAULT) {
        m->state = SF_FAULT;
        m->fault = fault;
        forget_playing(m);
    }
}

static int tile_ready(const sf_machine *m)
{
    return m->tile_size > 0 && m->tile_filled == m->tile_size;
}

static uint32_t tile_level(const sf_machine *m, int32_t x)
{
    int64_t along = (int64_t)x - m->tile_origin, index, rest, here, there;
    if (!tile_ready(m) || along < 0)
        return 0;
    index = along / m->tile_pitch;
    rest = along % m->tile_pitch;
    if (index >= (int64_t)m->tile_size - 1)
        return index == (int64_t)m->tile_size - 1 && rest == 0 ? m->tile[index] : 0;
    here = m->tile[index];
    there = m->tile[index + 1];
    if (there >= here)
        return (uint32_t)(here + (there - here) * rest / m->tile_pitch);
    return (uint32_t)(here - (here - there) * rest / m->tile_pitch);
}

static uint32_t wanted(sf_machine *m)
{
    uint32_t index;
    if (m->at_given)
        return tile_level(m, m->at);
    if (m->envelope_count == 0)
        return 0;
    index = (m->now - m->began) / m->period;
    if (index >= m->envelope_count - 1) {
        /* Only the last one is kept, so that the clock may wrap while it holds. */
        m->envelope[0] = m->envelope[m->envelope_count - 1];
        m->envelope_count = 1;
        return m->envelope[0];
    }
    return m->envelope[index];
}

/* total + rate * elapsed, held within 0 ... MOST without overflow. */
static int64_t moved(int64_t total, int64_t rate, uint32_t elapsed)
{
    if (rate > 0 && elapsed > (MOST - total) / rate)
        return MOST;
    if (rate < 0 && elapsed > total / -rate)
        return 0;
    return total + rate * (int64_t)elapsed;
}

static void count_loads(sf_machine *m, uint32_t elapsed)
{
    int64_t volts = ((int64_t)m->level + 999) / 1000;
    int64_t rating = m->limits.continuous_voltage / 1000;
    m->heat = moved(m->heat, volts * volts - rating * rating, elapsed);
    m->used = moved(m->used, (m->level > 0 ? 1000 : 0) - (int64_t)m->limits.duty, elapsed);
}

static void move(sf_machine *m, uint32_t elapsed)
{
    int64_t falling = elapsed, target = 0, level = m->level, step;
    count_loads(m, elapsed); /* the output was held since the last tick: count that, then move */
    if (m->state == SF_ARMED || m->state == SF_PLAYING) {
        uint32_t silent = m->now - m->heard;
        if (silent > SILENCE) {
            /* The ramp counts from the deadline, not from the tick that noticed it. */
            if (silent - SILENCE < elapsed)
                falling = silent - SILENCE;
            fail(m, SF_WATCHDOG);
        } else if (elapsed > LATE_TICK) {
            falling = 0;
            fail(m, SF_LATE_TICK);
        } else if (m->state == SF_PLAYING) {
            if (m->heat > (int64_t)m->limits.heat * 1000000000)
                fail(m, SF_HEAT);
            else if (m->used > (int64_t)m->limits.duty * m->limits.duty_window * 1000)
                fail(m, SF_DUTY);
        }
    }
    if (m->state == SF_PLAYING)
        target = wanted(m);
    if (target > level) {
        step = (int64_t)m->limits.slew * (elapsed < LONGEST_RISE ? elapsed : LONGEST_RISE);
        level = target < level + step ? target : level + step;
    } else {
        step = (int64_t)m->limits.slew * falling;
        level = target > level - step ? target : level - step;
    }
    m->level = (uint32_t)level;
}

uint32_t sf_tick(sf_machine *m, uint32_t now)
{
    uint32_t elapsed = now - m->now;
    m->now = now;
    if (elapsed != 0 && m->has_limits)
        move(m, elapsed);
    if (m->carrier)
        m->carrier(m->board, m->state == SF_ARMED || m->state == SF_PLAYING || m->level > 0,
                   m->level, m->frequency);
    return m->level;
}

void sf_trip(sf_machine *m) { fail(m, SF_TRIPPED); }

/* --- commands ---------------------------------------------------------------------------- */

static int set_limits(sf_machine *m, const uint8_t *p)
{
    const sf_limits *own = &m->own;
    int64_t voltage = level_of(p), continuous = level_of(p + 8);
    sf_limits asked;
    if (m->state != SF_OFF || m->level > 0)
        return SF_BAD_STATE;
    asked.slew = get32(p + 4);
    asked.heat = get32(p + 12);
    asked.lowest_frequency = get32(p + 16);
    asked.highest_frequency = get32(p + 20);
    asked.duty = get16(p + 24);
    asked.duty_window = get32(p + 26);
    if (voltage <= 0 || voltage > own->voltage || continuous < 0 || continuous > voltage ||
        continuous > own->continuous_voltage || asked.slew > own->slew ||
        (int64_t)asked.slew * RAMP < voltage || asked.heat > own->heat ||
        asked.lowest_frequency < own->lowest_frequency ||
        asked.highest_frequency < asked.lowest_frequency ||
        asked.highest_frequency > own->highest_frequency || asked.duty < 1 ||
        asked.duty > own->duty || asked.duty_window < 1 || asked.duty_window > own->duty_window ||
        p[30] > 1 || (voltage > TOUCH_LEVEL && p[30] != 1))
        return SF_BAD_VALUE;
    asked.voltage = (uint32_t)voltage;
    asked.continuous_voltage = (uint32_t)continuous;
    m->limits = asked;
    m->has_limits = 1;
    m->tile_size = m->tile_filled = 0;
    return SF_ACCEPTED;
}

static int arm(sf_machine *m, uint32_t token)
{
    if (m->state != SF_OFF || m->level > 0)
        return SF_BAD_STATE;
    if (token != m->token)
        return SF_BAD_TOKEN;
    m->token ^= m->token << 13;
    m->token ^= m->token >> 17;
    m->token ^= m->token << 5;
    m->state = SF_ARMED;
    return SF_ACCEPTED;
}

static int tune(sf_machine *m, uint32_t frequency, int state)
{
    if (m->state != state)
        return SF_BAD_STATE;
    if (frequency < m->limits.lowest_frequency || frequency > m->limits.highest_frequency)
        return SF_BAD_VALUE;
    m->frequency = frequency;
    m->state = SF_PLAYING;
    return SF_ACCEPTED;
}

/* Writes nothing unless every amplitude is within the limits: one bad one refuses all. */
static int take_levels(const sf_machine *m, const uint8_t *p, uint32_t count, uint32_t *out)
{
    for (uint32_t i = 0; i < count; i++) {
        int64_t level = level_of(p + 4 * i);
        if (level < 0 || level > m->limits.voltage)
            return 0;
    }
    for (uint32_t i = 0; i < count; i++)
        out[i] = (uint32_t)level_of(p + 4 * i);
    return 1;
}

static int play(sf_machine *m, const uint8_t *p)
{
    uint32_t period = get16(p);
    if (m->state != SF_PLAYING)
        return SF_BAD_STATE;
    if (period == 0 || !take_levels(m, p + 3, p[2], m->envelope))
        return SF_BAD_VALUE;
    m->envelope_count = p[2];
    m->period = period;
    m->began = m->now;
    m->at_given = 0;
    return SF_ACCEPTED;
}

static int begin_tile(sf_machine *m, const uint8_t *p)
{
    uint32_t pitch = get32(p + 4), size = get16(p + 8);
    if (m->state == SF_FAULT)
        return SF_BAD_STATE;
    if (pitch == 0 || size < 1 || size > SF_LONGEST_TILE)
        return SF_BAD_VALUE;
    m->tile_origin = get_signed(p);
    m->tile_pitch = pitch;
    m->tile_size = size;
    m->tile_filled = 0;
    return SF_ACCEPTED;
}

static int fill_tile(sf_machine *m, const uint8_t *p)
{
    uint32_t count = p[2];
    if (m->state == SF_FAULT)
        return SF_BAD_STATE;
    if (get16(p) != m->tile_filled || m->tile_filled + count > m->tile_size)
        return SF_BAD_TILE;
    if (!take_levels(m, p + 3, count, m->tile + m->tile_filled))
        return SF_BAD_VALUE;
    m->tile_filled += count;
    return SF_ACCEPTED;
}

static int go_to(sf_machine *m, int32_t x)
{
    if (m->state != SF_PLAYING)
        return SF_BAD_STATE;
    if (!tile_ready(m))
        return SF_BAD_TILE;
    forget_playing(m);
    m->at_given = 1;
    m->at = x;
    return SF_ACCEPTED;
}

static int clear_fault(sf_machine *m, int fault)
{
    if (m->state != SF_FAULT || m->level > 0)
        return SF_BAD_STATE;
    if (fault != m->fault)
        return SF_BAD_VALUE;
    m->state = SF_OFF;
    m->fault = SF_NONE;
    return SF_ACCEPTED;
}

static int length_fits(uint8_t type, const uint8_t *p, size_t count)
{
    static const uint8_t lengths[] = {0, 4, 0, 31, 4, 4, 4, 0, 10, 0, 4, 0, 1};
    if (type == ENVELOPE || type == TILE_DATA)
        return count >= 3 && p[2] >= 1 && p[2] <= SF_MOST_LEVELS && count == 3u + 4u * p[2];
    return count == lengths[type];
}

static int obey(sf_machine *m, uint8_t type, const uint8_t *p)
{
    switch (type) {
    case KEEP_ALIVE: return SF_ACCEPTED;
    case CLEAR_FAULT: return clear_fault(m, p[0]);
    case SET_LIMITS: return set_limits(m, p);
    default: break;
    }
    if (!m->has_limits)
        return SF_NO_LIMITS;
    switch (type) {
    case ARM: return arm(m, get32(p));
    case START: return tune(m, get32(p), SF_ARMED);
    case SET_FREQUENCY: return tune(m, get32(p), SF_PLAYING);
    case ENVELOPE: return play(m, p);
    case TILE_BEGIN: return begin_tile(m, p);
    case TILE_DATA: return fill_tile(m, p);
    case POSITION: return go_to(m, get_signed(p));
    default: return SF_BAD_TYPE;
    }
}

static int take(sf_machine *m, const uint8_t *frame, size_t payload)
{
    uint8_t type = frame[1];
    uint16_t sequence = get16(frame + 2), ahead = (uint16_t)(sequence - m->last);
    const uint8_t *p = frame + HEADER;
    int fresh = m->opened && ahead >= 1 && ahead < 0x8000;
    if (frame[0] != SF_VERSION)
        return SF_BAD_VERSION;
    if (type < HELLO || type > CLEAR_FAULT)
        return SF_BAD_TYPE;
    if (!length_fits(type, p, payload))
        return SF_BAD_LENGTH;
    if (type == HELLO) {
        if (m->state != SF_OFF && m->state != SF_FAULT)
            return SF_BAD_STATE;
        m->opened = 1;
        m->last = sequence;
        m->session = get32(p);
        return SF_ACCEPTED;
    }
    if (fresh)
        m->last = sequence;
    if (type == STOP) {
        if (m->state != SF_FAULT) {
            m->state = SF_OFF;
            forget_playing(m);
        }
        return SF_ACCEPTED;
    }
    return fresh ? obey(m, type, p) : SF_BAD_SEQUENCE;
}

static void answer(sf_machine *m, uint16_t sequence, int reason)
{
    uint8_t frame[HEADER + 30 + 4], out[sizeof frame + 2];
    size_t count;
    frame[0] = SF_VERSION;
    frame[1] = STATUS;
    put16(frame + 2, ++m->sent);
    put16(frame + 4, sequence);
    frame[6] = (uint8_t)reason;
    frame[7] = (uint8_t)m->state;
    frame[8] = (uint8_t)m->fault;
    frame[9] = 0;
    put32(frame + 10, m->token);
    put32(frame + 14, m->level);
    put32(frame + 18, m->accepted);
    put32(frame + 22, m->refused);
    put32(frame + 26, m->damaged);
    put32(frame + 30, m->session);
    put32(frame + 34, sf_crc32(frame, 34));
    count = sf_cobs_encode(frame, sizeof frame, out);
    out[count++] = 0;
    if (m->send)
        m->send(m->board, out, count);
}

void sf_receive(sf_machine *m, uint8_t byte, uint32_t now)
{
    uint8_t frame[SF_LONGEST_FRAME + 2];
    int count, reason;
    if (byte) {
        if (m->stuffed_count < sizeof m->stuffed)
            m->stuffed[m->stuffed_count++] = byte;
        return;
    }
    if (m->stuffed_count == 0)
        return;
    count = sf_cobs_decode(m->stuffed, m->stuffed_count, frame);
    m->stuffed_count = 0;
    if (count < OVERHEAD || count > SF_LONGEST_FRAME ||
        sf_crc32(frame, (size_t)count - 4) != get32(frame + count - 4)) {
        m->damaged++;
        sf_tick(m, now);
        return;
    }
    sf_tick(m, now);
    reason = take(m, frame, (size_t)count - OVERHEAD);
    if (reason == SF_ACCEPTED) {
        m->accepted++;
        m->heard = m->now;
    } else {
        m->refused++;
    }
    answer(m, get16(frame + 2), reason);
}

void sf_boot(sf_machine *m, const sf_limits *own, uint32_t seed, sf_carrier carrier, sf_send send,
             void *board)
{
    memset(m, 0, sizeof *m);
    m->own = *own;
    m->token = seed ? seed : 0x9E3779B9u;
    m->period = 1;
    m->tile_pitch = 1;
    m->carrier = carrier;
    m->send = send;
    m->board = board;
}
