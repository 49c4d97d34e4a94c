/* Counts what an emulator executes, as its hook for every instruction: the longest call of each of two
 * functions, what it calls included. In C, since millions of instructions are counted. */
#include <stdint.h>

struct counter {
    uint64_t caller, caller_end; /* addresses of the function that makes the calls */
    uint64_t entry[2];
    uint64_t longest[2], calls[2], total;
    uint64_t count, inside; /* of the call that runs, and which it is, from 1; 0 for none */
};

void count_instruction(void *emulator, uint64_t address, uint32_t size, void *user);

void count_instruction(void *emulator, uint64_t address, uint32_t size, void *user)
{
    struct counter *c = user;
    (void)emulator;
    (void)size;
    c->total++;
    if (c->inside) {
        if (address < c->caller || address >= c->caller_end) {
            c->count++;
            return;
        }
        if (c->count > c->longest[c->inside - 1])
            c->longest[c->inside - 1] = c->count;
        c->inside = 0;
    } else {
        for (int i = 0; i < 2; i++) {
            if (address == c->entry[i]) {
                c->inside = (uint64_t)i + 1;
                c->count = 1;
                c->calls[i]++;
            }
        }
    }
}
