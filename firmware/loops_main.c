/* Runs the loops on standard input: the gains, then steps of four numbers (the pickup's two, wanted,
 * applied), all of 64 bits; writes state and command after each. For tests. */
#include "squeezefilm_loops.h"

#include <stdio.h>

int main(void)
{
    sf_loop_gains gains;
    sf_loop_state state;
    int64_t step[4];
    if (fread(&gains, sizeof gains, 1, stdin) != 1)
        return 2;
    sf_loop_begin(&state, &gains);
    while (fread(step, sizeof step, 1, stdin) == 1) {
        sf_loop_command command =
            sf_loop_step(&gains, &state, (int32_t)step[0], (int32_t)step[1], step[2], step[3]);
        if (fwrite(&state, sizeof state, 1, stdout) != 1 ||
            fwrite(&command, sizeof command, 1, stdout) != 1)
            return 2;
    }
    return 0;
}
