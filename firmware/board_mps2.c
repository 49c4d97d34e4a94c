/* The firmware as a program on QEMU's mps2-an385 (Cortex-M3, 25 MHz): one page of hardware, and a plate
 * in integers in place of amplifier and ADC, which no emulator has. It was never on a board.
 *
 * For a board of your own replace this file: UART, clock, watchdog, the carrier with its enable line,
 * and what the ADC shows of the pickup.
 */
#include "squeezefilm_fw.h"

#define REGISTER(address) (*(volatile uint32_t *)(address))
#define UART 0x40004000u
#define UART_DATA REGISTER(UART)
#define UART_STATE REGISTER(UART + 4)
#define UART_CONTROL REGISTER(UART + 8)
#define UART_INTERRUPTS REGISTER(UART + 12)
#define UART_DIVIDER REGISTER(UART + 16)
#define TICKING 0x40000000u /* a timer that wakes the core every tick, and one that only counts */
#define COUNTING 0x40001000u
#define COUNTED REGISTER(COUNTING + 4)
#define WOKEN_BY ((1u << 0) | (1u << 8)) /* interrupts: the UART's byte, the ticking timer */
#define NVIC_ENABLE REGISTER(0xE000E100u)
#define NVIC_CLEAR REGISTER(0xE000E280u)
#define WATCHDOG 0x40008000u
#define CLOCKS_PER_US 25u
#define TICK 200u      /* us */
#define PATIENCE 500u  /* ms; a computer that emulates is held up longer than a board is */
#define OUT_SIZE 4096u
/* A plate of Q 300 at 29.98 kHz and 2 mV/V: pickup over drive and a tick over its time constant (2^24),
 * mHz, and a loss with a finger of half its own on it (2^16). */
#define PLATE_RATIO 33554
#define PLATE_TAKE 1021710
#define PLATE_HALF_BANDWIDTH 50000
#define PLATE_FREQUENCY 29980000
#define PLATE_LOSS 0x18000
/* A finger that goes 40 mm to and fro at 80 mm/s and is in the air for a fifth of a second of each; its
 * sensor takes 500 samples a second. */
#define FINGER_CYCLE 1000000u
#define FINGER_AIR 200000u
#define FINGER_SAMPLE 2000u

static sf_machine machine;
static uint8_t out[OUT_SIZE];
static uint32_t out_first, out_count;
static int64_t re, im; /* of the plate, uV/16 */

/* --- hardware ----------------------------------------------------------------------------- */

static uint32_t microseconds(void)
{
    static uint32_t before, rest, now;
    uint32_t value = ~COUNTED; /* it counts down */
    rest += value - before;
    before = value;
    now += rest / CLOCKS_PER_US;
    rest %= CLOCKS_PER_US;
    return now;
}

static void feed_watchdog(void) { REGISTER(WATCHDOG + 12) = 1; }

static void begin_hardware(void)
{
    UART_DIVIDER = 16;
    UART_CONTROL = 1u | 2u | 8u; /* sends, receives, and says when a byte came */
    REGISTER(COUNTING + 8) = COUNTED = 0xFFFFFFFFu;
    REGISTER(COUNTING) = 1;
    REGISTER(TICKING + 8) = REGISTER(TICKING + 4) = TICK * CLOCKS_PER_US - 1;
    REGISTER(TICKING) = 1u | 8u;
    REGISTER(WATCHDOG) = PATIENCE * 1000u * CLOCKS_PER_US;
    REGISTER(WATCHDOG + 8) = 3;
    NVIC_ENABLE = WOKEN_BY;
    __asm__ volatile("cpsid i"); /* interrupts only wake the core: nothing here is reentrant */
}

static void sleep(void)
{
    __asm__ volatile("wfi");
    REGISTER(TICKING + 12) = 1;
    NVIC_CLEAR = WOKEN_BY;
}

static void send(void *board, const uint8_t *bytes, size_t count)
{
    (void)board;
    if (out_count + count > OUT_SIZE)
        return;
    for (size_t i = 0; i < count; i++)
        out[(out_first + out_count++) % OUT_SIZE] = bytes[i];
}

static void serve_uart(uint32_t now)
{
    while (UART_STATE & 2u) {
        UART_INTERRUPTS = 2u; /* before DATA is read: that lets the next byte in */
        sf_receive(&machine, (uint8_t)UART_DATA, now);
    }
    while (out_count && !(UART_STATE & 1u)) {
        UART_DATA = out[out_first];
        out_first = (out_first + 1) % OUT_SIZE;
        out_count--;
    }
}

/* --- plate -------------------------------------------------------------------------------- */

/* A step of Euler. */
static void move_plate(int64_t level, int64_t frequency)
{
    int64_t off = (frequency - PLATE_FREQUENCY) * 65536 / PLATE_HALF_BANDWIDTH;
    int64_t driven = PLATE_RATIO * level / (1 << 20);
    int64_t x = driven - PLATE_LOSS * re / 65536 + off * im / 65536;
    int64_t y = -PLATE_LOSS * im / 65536 - off * re / 65536;
    re += PLATE_TAKE * x / (1 << 24);
    im += PLATE_TAKE * y / (1 << 24);
}

static void carrier(void *board, int enabled, uint32_t level, uint32_t frequency)
{
    (void)board;
    move_plate(enabled ? level : 0, frequency);
}

static void phases(void *board, int32_t *in_phase, int32_t *ahead)
{
    (void)board;
    *in_phase = (int32_t)(re / 16);
    *ahead = (int32_t)(im / 16);
}

static uint32_t pickup(void *board)
{
    (void)board;
    return (uint32_t)((re < 0 ? -re : re) / 16);
}

static sf_finger sensor(void *board)
{
    uint32_t at = microseconds() % FINGER_CYCLE, half = FINGER_CYCLE / 2;
    sf_finger finger = {0, 0, at < FINGER_CYCLE - FINGER_AIR};
    (void)board;
    at -= at % FINGER_SAMPLE;
    finger.x = (int32_t)((at < half ? at : FINGER_CYCLE - at) * 2 / 25);
    return finger;
}

/* --- program ------------------------------------------------------------------------------ */

void reset(void);
extern uint32_t bss_begin, bss_end, stack_top;

static void main_loop(void)
{
    static const sf_limits own = {
        200000000, 1000000000, 200000000, 4000000000, 1000, 1000000000, 1000, 3600000};
    static sf_loops loops = {&sf_held, phases, NULL, {0}, {0}, {0}, 0};
    const sf_board board = {NULL, carrier, send, sensor, pickup, TICK, &loops};
    uint32_t now, ticked;
    begin_hardware();
    sf_boot(&machine, &own, 51, &board);
    ticked = now = microseconds();
    for (;;) {
        sleep();
        now = microseconds();
        serve_uart(now);
        if (now - ticked >= TICK) {
            ticked = now;
            sf_tick(&machine, now);
            feed_watchdog();
        }
    }
}

void reset(void)
{
    for (uint32_t *word = &bss_begin; word < &bss_end; word++)
        *word = 0;
    main_loop();
}

static void stuck(void)
{
    for (;;)
        ;
}

/* Its own watchdog interrupts first (as NMI) and resets at the second; both stop the output. */
__attribute__((section(".vectors"), used)) static const uintptr_t vectors[16] = {
    (uintptr_t)&stack_top, (uintptr_t)reset, (uintptr_t)stuck, (uintptr_t)stuck,
    (uintptr_t)stuck, (uintptr_t)stuck, (uintptr_t)stuck,
};
