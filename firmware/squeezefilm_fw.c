/* See squeezefilm_fw.h, and docs/development/protocol.md for the rules and the layout of every frame. */
#include "squeezefilm_fw.h"

#include <string.h>

#define SILENCE 50000u
#define LATE_TICK 10000u
#define LONGEST_RISE 1000u
#define MOST ((int64_t)1 << 62)
#define RAMP 10000u
#define TOUCH_LEVEL 42000000
#define MOST_AHEAD 1000000
#define SHORTEST_REPORT 200u
#define LONGEST_REPORT 1000000000u
#define CRC_START 0xFFFFFFFFu
#define CRC_RESIDUE 0xDEBB20E3u /* what a frame with its own CRC behind it leaves */
#define MINUS_ZERO 0x80000000u
#define HIGHEST_VOLTS 0x44FA0000u /* 2000 V */
#define HEADER 4
#define OVERHEAD 8

enum {
    HELLO = 0x01, STOP, SET_LIMITS, ARM, START, SET_FREQUENCY, ENVELOPE, TILE_BEGIN, TILE_DATA,
    POSITION, KEEP_ALIVE, CLEAR_FAULT, REPORT, FOLLOW, ASK_INFO, TIMED_ENVELOPE, NEGOTIATE, SET_LOOPS,
    SWITCH_LOOPS, ASK_LOOPS,
    STATUS = 0x81, READING, INFO, CAPABILITIES, LOOPS
};

/* --- bytes ------------------------------------------------------------------------------- */

static uint16_t get16(const uint8_t *p) { return (uint16_t)(p[0] | (uint16_t)(p[1] << 8)); }

uint32_t sf_get32(const uint8_t *p)
{
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static int32_t get_signed(const uint8_t *p)
{
    uint32_t bits = sf_get32(p);
    int32_t value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static void put16(uint8_t *p, uint32_t value)
{
    p[0] = (uint8_t)value;
    p[1] = (uint8_t)(value >> 8);
}

void sf_put32(uint8_t *p, uint32_t value)
{
    put16(p, value);
    put16(p + 2, value >> 16);
}

/* Four bits at a time: 64 bytes of table, where eight bits would take 1 KiB of a small flash and of
 * its cache. */
static uint32_t crc_step(uint32_t crc, uint8_t byte)
{
    static const uint32_t table[16] = {
        0x00000000u, 0x1DB71064u, 0x3B6E20C8u, 0x26D930ACu,
        0x76DC4190u, 0x6B6B51F4u, 0x4DB26158u, 0x5005713Cu,
        0xEDB88320u, 0xF00F9344u, 0xD6D6A3E8u, 0xCB61B38Cu,
        0x9B64C2B0u, 0x86D3D2D4u, 0xA00AE278u, 0xBDBDF21Cu,
    };
    crc ^= byte;
    crc = (crc >> 4) ^ table[crc & 15u];
    return (crc >> 4) ^ table[crc & 15u];
}

uint32_t sf_crc32(const uint8_t *bytes, size_t count)
{
    uint32_t crc = CRC_START;
    for (size_t i = 0; i < count; i++)
        crc = crc_step(crc, bytes[i]);
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

/* In integers, since most small processors have no binary64. A positive binary32 is
 * mantissa * 2^-places, and such numbers, infinity and NaN among them, are ordered as their bits. */
int32_t sf_level(uint32_t bits)
{
    uint32_t places = 150u - (bits >> 23), mantissa = (bits & 0x7FFFFFu) | 0x800000u;
    if (bits == MINUS_ZERO)
        return 0;
    if (bits > HIGHEST_VOLTS)
        return -1;
    /* mantissa * 10^6 is below 2^44: with more places it is less than half. At 2000 V there are 13. */
    if (places > 45)
        return 0;
    return (int32_t)(((uint64_t)mantissa * 1000000u + ((uint64_t)1 << (places - 1))) >> places);
}

/* --- output ------------------------------------------------------------------------------ */

static void play_nothing(sf_machine *m)
{
    m->playing = SF_PLAY_NOTHING;
    m->queue_count = 0;
}

/* us from now to time, negative if it has passed; within 35 min. */
static int64_t until(uint32_t time, uint32_t now)
{
    return (int64_t)(uint32_t)(time - now + 0x80000000u) - 0x80000000ll;
}

static void fail(sf_machine *m, int fault)
{
    if (m->state != SF_FAULT) {
        m->state = SF_FAULT;
        m->fault = fault;
        play_nothing(m);
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

static uint32_t of_envelope(sf_machine *m)
{
    uint32_t index = (m->now - m->began) / m->period;
    if (index >= m->envelope_count - 1) {
        /* Only the last one is kept, so that the clock may wrap while it holds. */
        m->envelope[0] = m->envelope[m->envelope_count - 1];
        m->envelope_count = 1;
        return m->envelope[0];
    }
    return m->envelope[index];
}

/* How many queued amplitudes are due before `time`. Their times rise, so it takes 10 looks and not
 * 512, which would be longer than a tick may take. */
static uint32_t queued_before(const sf_machine *m, uint32_t time)
{
    uint32_t least = 0, most = m->queue_count;
    while (least < most) {
        uint32_t middle = (least + most) / 2;
        if (until(m->queue_time[(m->queue_first + middle) % SF_LONGEST_QUEUE], time) < 0)
            least = middle + 1;
        else
            most = middle;
    }
    return least;
}

static uint32_t of_queue(sf_machine *m)
{
    uint32_t due = queued_before(m, m->now + 1);
    if (due) {
        uint32_t newest = (m->queue_first + due - 1) % SF_LONGEST_QUEUE;
        m->played = m->queue_time[newest];
        m->held = m->queue_level[newest];
        m->has_played = 1;
        m->queue_first = (newest + 1) % SF_LONGEST_QUEUE;
        m->queue_count -= due;
    }
    if (m->queue_count == 0 && m->has_played) {
        uint32_t held = m->now - m->played;
        if (held >= m->period)
            m->dry = 1;
        /* No amplitude that old is taken any more; so the clock may wrap while it holds. */
        if (held > 2 * MOST_AHEAD)
            m->has_played = 0;
    }
    return m->held;
}

static uint32_t wanted(sf_machine *m, const sf_finger *finger)
{
    switch (m->playing) {
    case SF_PLAY_ENVELOPE: return of_envelope(m);
    case SF_PLAY_TIMED: return of_queue(m);
    case SF_PLAY_PLACE: return tile_level(m, m->place);
    case SF_PLAY_FINGER: return finger->touching ? tile_level(m, finger->x) : 0;
    default: return 0;
    }
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

static void move(sf_machine *m, uint32_t elapsed, const sf_finger *finger, int ticked)
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
    if (m->state == SF_PLAYING) {
        uint32_t asked = wanted(m, finger);
        target = m->holding ? m->board.loops->code->level(m, asked, ticked) : asked;
    }
    if (target > level) {
        step = (int64_t)m->limits.slew * (elapsed < LONGEST_RISE ? elapsed : LONGEST_RISE);
        level = target < level + step ? target : level + step;
    } else {
        step = (int64_t)m->limits.slew * falling;
        level = target > level - step ? target : level - step;
    }
    m->level = (uint32_t)level;
}

/* --- what is sent ------------------------------------------------------------------------ */

/* `frame` holds `payload` bytes after its header, and room for the CRC. */
static void send(sf_machine *m, uint8_t type, uint8_t *frame, size_t payload)
{
    uint8_t out[64 + 2];
    size_t count = HEADER + payload;
    frame[0] = SF_VERSION;
    frame[1] = type;
    put16(frame + 2, ++m->sent);
    sf_put32(frame + count, sf_crc32(frame, count));
    count = sf_cobs_encode(frame, count + 4, out);
    out[count++] = 0;
    if (m->board.send)
        m->board.send(m->board.board, out, count);
}

static void send_reading(sf_machine *m, const sf_finger *finger)
{
    uint8_t frame[HEADER + 28 + 4];
    uint32_t pickup = m->board.pickup ? m->board.pickup(m->board.board) : 0;
    sf_put32(frame + 4, m->now);
    sf_put32(frame + 8, (uint32_t)finger->x);
    sf_put32(frame + 12, (uint32_t)finger->y);
    frame[16] = finger->touching ? 1 : 0;
    frame[17] = (uint8_t)m->state;
    frame[18] = (uint8_t)m->fault;
    frame[19] = (uint8_t)((m->board.sensor ? 1 : 0) | (m->board.pickup ? 2 : 0) |
                          (m->dry ? 4 : 0) | (m->late ? 8 : 0));
    m->dry = m->late = 0;
    sf_put32(frame + 20, m->level);
    sf_put32(frame + 24, pickup);
    sf_put32(frame + 28, m->late_ticks);
    send(m, READING, frame, 28);
}

/* Whether a reading is due. One that was missed is not made up; the phase is kept. */
static int take_report(sf_machine *m)
{
    int64_t late = -until(m->report_due, m->now);
    if (m->report_period == 0 || late < 0)
        return 0;
    m->report_due += ((uint32_t)late / m->report_period + 1) * m->report_period;
    return 1;
}

/* --- time -------------------------------------------------------------------------------- */

/* `ticked`: by the timer, and not by a frame; the loops step with ticks alone. */
static void advance(sf_machine *m, uint32_t now, int ticked)
{
    uint32_t elapsed = now - m->now;
    sf_finger finger = {0, 0, 0};
    int due;
    m->now = now;
    due = take_report(m);
    if (m->board.sensor && (due || m->playing == SF_PLAY_FINGER))
        finger = m->board.sensor(m->board.board);
    if (m->has_limits && (elapsed != 0 || (ticked && m->holding)))
        move(m, elapsed, &finger, ticked);
    if (m->board.carrier)
        m->board.carrier(m->board.board,
                         m->state == SF_ARMED || m->state == SF_PLAYING || m->level > 0,
                         m->level, m->frequency);
    if (due)
        send_reading(m, &finger);
}

uint32_t sf_tick(sf_machine *m, uint32_t now)
{
    if (m->state == SF_PLAYING && now - m->ticked > m->board.tick_period + m->board.tick_period / 2) {
        m->late_ticks++;
        if (m->holding)
            m->board.loops->code->begin(m, SF_SKIP);
    }
    m->ticked = now;
    advance(m, now, 1);
    return m->level;
}

void sf_trip(sf_machine *m) { fail(m, SF_TRIPPED); }

/* --- commands ---------------------------------------------------------------------------- */

static int set_limits(sf_machine *m, const uint8_t *p)
{
    const sf_limits *own = &m->own;
    int64_t voltage = sf_level(sf_get32(p)), continuous = sf_level(sf_get32(p + 8));
    sf_limits asked;
    if (m->state != SF_OFF || m->level > 0)
        return SF_BAD_STATE;
    asked.slew = sf_get32(p + 4);
    asked.heat = sf_get32(p + 12);
    asked.lowest_frequency = sf_get32(p + 16);
    asked.highest_frequency = sf_get32(p + 20);
    asked.duty = get16(p + 24);
    asked.duty_window = sf_get32(p + 26);
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
    m->has_gains = m->holding = 0;
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
    if (m->state == SF_ARMED) {
        m->ticked = m->now;
        if (m->holding)
            m->board.loops->code->begin(m, SF_RESUME);
    }
    m->frequency = frequency;
    m->state = SF_PLAYING;
    return SF_ACCEPTED;
}

/* Writes nothing unless every amplitude is within the limits: one bad one refuses all. */
static int take_levels(const sf_machine *m, const uint8_t *p, uint32_t count, uint32_t *out)
{
    uint32_t levels[SF_MOST_LEVELS];
    for (uint32_t i = 0; i < count; i++) {
        int32_t level = sf_level(sf_get32(p + 4 * i));
        if (level < 0 || (uint32_t)level > m->limits.voltage)
            return 0;
        levels[i] = (uint32_t)level;
    }
    memcpy(out, levels, count * sizeof *levels);
    return 1;
}

static int play(sf_machine *m, const uint8_t *p)
{
    uint32_t period = get16(p);
    if (m->state != SF_PLAYING)
        return SF_BAD_STATE;
    if (period == 0 || !take_levels(m, p + 3, p[2], m->envelope))
        return SF_BAD_VALUE;
    play_nothing(m);
    m->playing = SF_PLAY_ENVELOPE;
    m->envelope_count = p[2];
    m->period = period;
    m->began = m->now;
    return SF_ACCEPTED;
}

/* In place of what was queued from `start` on. What is at or before the newest amplitude that was
 * played is left out: nothing is played twice, or backwards. */
static int play_timed(sf_machine *m, const uint8_t *p)
{
    uint32_t start = sf_get32(p), period = get16(p + 4), count = p[6], kept = 0, skip = 0, time;
    uint32_t levels[SF_MOST_LEVELS];
    int timed = m->playing == SF_PLAY_TIMED;
    int64_t ahead = until(start, m->now);
    if (m->state != SF_PLAYING)
        return SF_BAD_STATE;
    if (!take_levels(m, p + 7, count, levels) || period == 0 || ahead > MOST_AHEAD ||
        ahead < -MOST_AHEAD)
        return SF_BAD_VALUE;
    if (timed)
        kept = queued_before(m, start);
    while (timed && m->has_played && skip < count && until(start + skip * period, m->played) <= 0)
        skip++;
    if (kept + count - skip > SF_LONGEST_QUEUE)
        return SF_FULL;
    if (!timed) {
        play_nothing(m);
        m->playing = SF_PLAY_TIMED;
        m->held = m->level;
        m->has_played = 0;
    }
    m->queue_count = kept;
    if (skip < count && until(start + skip * period, m->now) < 0)
        m->late = 1;
    for (time = start + skip * period; skip < count; skip++, time += period) {
        uint32_t at = (m->queue_first + m->queue_count++) % SF_LONGEST_QUEUE;
        m->queue_time[at] = time;
        m->queue_level[at] = levels[skip];
    }
    m->period = period;
    return SF_ACCEPTED;
}

static int begin_tile(sf_machine *m, const uint8_t *p)
{
    uint32_t pitch = sf_get32(p + 4), size = get16(p + 8);
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
    play_nothing(m);
    m->playing = SF_PLAY_PLACE;
    m->place = x;
    return SF_ACCEPTED;
}

static int follow(sf_machine *m)
{
    if (m->state != SF_PLAYING)
        return SF_BAD_STATE;
    if (!tile_ready(m))
        return SF_BAD_TILE;
    if (!m->board.sensor)
        return SF_BAD_VALUE;
    play_nothing(m);
    m->playing = SF_PLAY_FINGER;
    return SF_ACCEPTED;
}

static int report(sf_machine *m, uint32_t period)
{
    if (period != 0 && (period < SHORTEST_REPORT || period > LONGEST_REPORT))
        return SF_BAD_VALUE;
    m->report_period = period;
    m->report_due = m->now + period;
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

static int negotiate(sf_machine *m, uint32_t revision)
{
    if (revision == 0)
        return SF_BAD_VALUE;
    m->revision = revision < SF_REVISION ? revision : SF_REVISION;
    return SF_ACCEPTED;
}

static int length_fits(uint8_t type, const uint8_t *p, size_t count)
{
    static const uint8_t lengths[] = {0, 4, 0, 31, 4, 4, 4, 0, 10, 0, 4,
                                      0, 1, 4, 0, 0, 0, 2, 4 * SF_GAINS, 1, 0};
    if (type == TIMED_ENVELOPE) {
        p += 4;
        count = count < 4 ? 0 : count - 4;
    }
    if (type == ENVELOPE || type == TILE_DATA || type == TIMED_ENVELOPE)
        return count >= 3 && p[2] >= 1 && p[2] <= SF_MOST_LEVELS && count == 3u + 4u * p[2];
    return count == lengths[type];
}

static int obey(sf_machine *m, uint8_t type, const uint8_t *p)
{
    switch (type) {
    case KEEP_ALIVE: return SF_ACCEPTED;
    case ASK_INFO: return SF_ACCEPTED;
    case REPORT: return report(m, sf_get32(p));
    case CLEAR_FAULT: return clear_fault(m, p[0]);
    case SET_LIMITS: return set_limits(m, p);
    case NEGOTIATE: return negotiate(m, get16(p));
    case ASK_LOOPS: return m->has_gains ? SF_ACCEPTED : SF_NO_LOOPS;
    default: break;
    }
    if (!m->has_limits)
        return SF_NO_LIMITS;
    switch (type) {
    case ARM: return arm(m, sf_get32(p));
    case START: return tune(m, sf_get32(p), SF_ARMED);
    case SET_FREQUENCY: return tune(m, sf_get32(p), SF_PLAYING);
    case ENVELOPE: return play(m, p);
    case TILE_BEGIN: return begin_tile(m, p);
    case TILE_DATA: return fill_tile(m, p);
    case POSITION: return go_to(m, get_signed(p));
    case FOLLOW: return follow(m);
    case TIMED_ENVELOPE: return play_timed(m, p);
    case SET_LOOPS:
    case SWITCH_LOOPS:
        return m->board.loops ? m->board.loops->code->take(m, type == SET_LOOPS, p)
                              : SF_NO_LOOPS;
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
    if (type < HELLO || type > ASK_LOOPS || (type > NEGOTIATE && m->revision < 2))
        return SF_BAD_TYPE;
    if (!length_fits(type, p, payload))
        return SF_BAD_LENGTH;
    if (type == HELLO) {
        if (m->state != SF_OFF && m->state != SF_FAULT)
            return SF_BAD_STATE;
        m->opened = 1;
        m->last = sequence;
        m->session = sf_get32(p);
        m->report_period = 0;
        m->revision = 1;
        m->has_gains = m->holding = 0;
        return SF_ACCEPTED;
    }
    if (fresh)
        m->last = sequence;
    if (type == STOP) {
        if (m->state != SF_FAULT) {
            m->state = SF_OFF;
            play_nothing(m);
        }
        return SF_ACCEPTED;
    }
    return fresh ? obey(m, type, p) : SF_BAD_SEQUENCE;
}

static void answer(sf_machine *m, uint16_t sequence, int reason)
{
    uint8_t frame[HEADER + 34 + 4];
    put16(frame + 4, sequence);
    frame[6] = (uint8_t)reason;
    frame[7] = (uint8_t)m->state;
    frame[8] = (uint8_t)m->fault;
    frame[9] = 0;
    sf_put32(frame + 10, m->token);
    sf_put32(frame + 14, m->level);
    sf_put32(frame + 18, m->accepted);
    sf_put32(frame + 22, m->refused);
    sf_put32(frame + 26, m->damaged);
    sf_put32(frame + 30, m->session);
    sf_put32(frame + 34, m->now);
    send(m, STATUS, frame, 34);
}

static void send_info(sf_machine *m)
{
    uint8_t frame[HEADER + 44 + 4];
    const sf_limits *own = &m->own;
    sf_put32(frame + 4, own->voltage);
    sf_put32(frame + 8, own->slew);
    sf_put32(frame + 12, own->continuous_voltage);
    sf_put32(frame + 16, own->heat);
    sf_put32(frame + 20, own->lowest_frequency);
    sf_put32(frame + 24, own->highest_frequency);
    sf_put32(frame + 28, own->duty);
    sf_put32(frame + 32, own->duty_window);
    sf_put32(frame + 36, m->board.tick_period);
    frame[40] = m->board.sensor ? 1 : 0;
    frame[41] = m->board.pickup ? 1 : 0;
    put16(frame + 42, SF_LONGEST_TILE);
    sf_put32(frame + 44, SF_FIRMWARE_VERSION);
    send(m, INFO, frame, 44);
}

/* What follows the status of a question that has an answer of its own. */
static void send_more(sf_machine *m, uint8_t asked)
{
    uint8_t frame[HEADER + 36 + 4];
    if (asked == ASK_INFO) {
        send_info(m);
    } else if (asked == NEGOTIATE) {
        put16(frame + 4, m->revision);
        frame[6] = m->board.loops ? 1 : 0;
        send(m, CAPABILITIES, frame, 3);
    } else if (asked == ASK_LOOPS) {
        m->board.loops->code->report(m, frame + HEADER);
        send(m, LOOPS, frame, 36);
    }
}

static void keep(sf_machine *m, uint8_t byte)
{
    m->crc = crc_step(m->crc, byte);
    m->frame[m->frame_count++] = byte;
}

/* Undoes COBS and goes on with the CRC byte by byte, so that the byte that ends a frame finds little
 * left to do. A frame that fits is one byte shorter than what it was stuffed to. */
static void unstuff(sf_machine *m, uint8_t byte)
{
    int first = m->stuffed == 0;
    if (m->stuffed <= SF_LONGEST_FRAME + 1)
        m->stuffed++;
    if (m->stuffed > SF_LONGEST_FRAME + 1)
        return;
    if (m->block_left) {
        m->block_left--;
        keep(m, byte);
    } else {
        m->block_left = byte - 1u;
        if (!first)
            keep(m, 0);
    }
}

void sf_receive(sf_machine *m, uint8_t byte, uint32_t now)
{
    uint32_t count = m->frame_count;
    int whole, reason;
    if (byte) {
        unstuff(m, byte);
        return;
    }
    if (m->stuffed == 0)
        return;
    whole = m->stuffed <= SF_LONGEST_FRAME + 1 && m->block_left == 0 && count >= OVERHEAD &&
            m->crc == CRC_RESIDUE;
    m->stuffed = m->block_left = m->frame_count = 0;
    m->crc = CRC_START;
    if (!whole)
        m->damaged++;
    advance(m, now, 0);
    if (!whole)
        return;
    reason = take(m, m->frame, count - OVERHEAD);
    if (reason == SF_ACCEPTED) {
        m->accepted++;
        m->heard = m->now;
    } else {
        m->refused++;
    }
    answer(m, get16(m->frame + 2), reason);
    if (reason == SF_ACCEPTED)
        send_more(m, m->frame[1]);
}

void sf_boot(sf_machine *m, const sf_limits *own, uint32_t seed, const sf_board *board)
{
    memset(m, 0, sizeof *m);
    m->own = *own;
    m->token = seed ? seed : 0x9E3779B9u;
    m->period = m->revision = 1;
    m->tile_pitch = 1;
    m->crc = CRC_START;
    m->board = *board;
}
