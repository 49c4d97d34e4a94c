/* The loops inside the state machine's tick: see squeezefilm_fw.h. The twin of
 * src/squeezefilm/instruments/device/machine/held.py. */
#include "squeezefilm_fw.h"

/* A lock, and a verdict, outlast a pause; what the plate did before it says nothing after it. */
static void begin(sf_machine *m, int how)
{
    sf_loops *l = m->board.loops;
    l->state.re = l->state.im = 0;
    if (how == SF_SKIP) /* a step of another length, which says nothing of the plate */
        return;
    if (how == SF_SEARCH || l->state.mode < SF_LOCKED)
        sf_loop_begin(&l->state, &l->gains);
    l->state.rate = l->state.wrong = 0;
    l->command.level = l->command.flags = 0;
    l->command.frequency = (l->state.frequency + 128) >> 8;
}

static int read(sf_machine *m, const uint8_t *payload)
{
    sf_loop_gains asked;
    int64_t *number = (int64_t *)(void *)&asked; /* as many, all alike */
    for (int i = 0; i < SF_GAINS; i++)
        number[i] = (int32_t)sf_get32(payload + 4 * i);
    if (!sf_loop_allowed(&asked, m->limits.lowest_frequency, m->limits.highest_frequency,
                         m->limits.voltage))
        return SF_BAD_VALUE;
    m->board.loops->gains = asked;
    m->has_gains = 1;
    m->holding = 0;
    begin(m, SF_SEARCH);
    return SF_ACCEPTED;
}

static int take(sf_machine *m, int set, const uint8_t *payload)
{
    if (set)
        return m->state == SF_OFF && m->level == 0 ? read(m, payload) : SF_BAD_STATE;
    if (!m->has_gains)
        return SF_NO_LOOPS;
    if (m->state == SF_FAULT)
        return SF_BAD_STATE;
    if (payload[0] > 1)
        return SF_BAD_VALUE;
    m->holding = payload[0];
    if (m->holding)
        begin(m, SF_SEARCH);
    return SF_ACCEPTED;
}

/* The level that they want on the plate. They step with ticks alone, since their gains know no other
 * interval. A plate that is not found yet rests while nothing is asked for. */
static uint32_t level(sf_machine *m, uint32_t asked, int ticked)
{
    sf_loops *l = m->board.loops;
    int32_t in_phase, ahead;
    int resting = asked == 0 && l->state.mode != SF_LOCKED;
    l->wanted = asked;
    if (ticked && !resting) {
        l->phases(m->board.board, &in_phase, &ahead);
        l->command = sf_loop_step(&l->gains, &l->state, in_phase, ahead, asked, m->level);
    }
    m->frequency = (uint32_t)l->command.frequency;
    return resting ? 0 : (uint32_t)l->command.level;
}

static void report(const sf_machine *m, uint8_t *payload)
{
    const sf_loops *l = m->board.loops;
    const int64_t most = (int64_t)1 << 24;
    int64_t target = (l->gains.ratio * l->wanted) >> 24;
    if (target > most)
        target = most;
    sf_put32(payload, m->now);
    payload[4] = (uint8_t)l->state.mode;
    payload[5] = (uint8_t)(m->holding | l->command.flags << 1 | (l->temperature ? 8 : 0));
    payload[6] = (uint8_t)l->state.lost;
    payload[7] = (uint8_t)l->state.false_locks;
    sf_put32(payload + 8, (uint32_t)l->command.frequency);
    sf_put32(payload + 12, (uint32_t)l->state.detuning);
    sf_put32(payload + 16, (uint32_t)target);
    sf_put32(payload + 20, (uint32_t)(l->state.re / 16 - target));
    sf_put32(payload + 24, (uint32_t)(l->gains.highest_level - l->command.level));
    sf_put32(payload + 28, (uint32_t)(l->state.load / 16));
    sf_put32(payload + 32, l->temperature ? (uint32_t)l->temperature(m->board.board) : 0);
}

const sf_loop_code sf_held = {take, begin, level, report};
