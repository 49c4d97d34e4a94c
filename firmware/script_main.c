/* Runs the script on standard input and writes its record to standard output: the firmware as a
 * program, which is how compilers' sanitizers want it. */
#include "host_harness.h"

#include <stdio.h>

static uint8_t script[16 << 20], record[64 << 20];

int main(void)
{
    size_t count = fread(script, 1, sizeof script, stdin);
    size_t recorded = host_run(script, count, record, sizeof record);
    if (!feof(stdin) || recorded > sizeof record)
        return 2;
    return fwrite(record, 1, recorded, stdout) == recorded ? 0 : 2;
}
