/* The loops in tests, on this computer and built for Arm: gains, then steps of four numbers (the
 * pickup's two, wanted, applied), all of 64 bits. Written after each is state and command. */
#include "squeezefilm_loops.h"

#include <stdio.h>

typedef struct {
    sf_loop_state state;
    sf_loop_command command;
} row;

static sf_loop_gains gains;
static sf_loop_state state;

static row step(const int64_t *given)
{
    row done;
    done.command =
        sf_loop_step(&gains, &state, (int32_t)given[0], (int32_t)given[1], given[2], given[3]);
    done.state = state;
    return done;
}

/* For an emulator, which hands over memory and reads memory. Returns the bytes written. */
size_t host_loops(const uint8_t *given, size_t count, row *out);

size_t host_loops(const uint8_t *given, size_t count, row *out)
{
    const int64_t *steps = (const int64_t *)(const void *)(given + sizeof gains);
    size_t rows = (count - sizeof gains) / (4 * sizeof *steps);
    gains = *(const sf_loop_gains *)(const void *)given;
    sf_loop_begin(&state, &gains);
    for (size_t i = 0; i < rows; i++)
        out[i] = step(steps + 4 * i);
    return rows * sizeof *out;
}

int main(void)
{
    int64_t given[4];
    if (fread(&gains, sizeof gains, 1, stdin) != 1)
        return 2;
    sf_loop_begin(&state, &gains);
    while (fread(given, sizeof given, 1, stdin) == 1) {
        row done = step(given);
        if (fwrite(&done, sizeof done, 1, stdout) != 1)
            return 2;
    }
    return 0;
}
