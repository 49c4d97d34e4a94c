#ifndef HOST_HARNESS_H
#define HOST_HARNESS_H

#include "squeezefilm_fw.h"

/* Runs a script of calls and records what they did. Returns the bytes that the record takes; what is
 * past the room is not written. */
size_t host_run(const uint8_t *calls, size_t count, uint8_t *out, size_t room);
/* sf_level of every element. */
void host_levels(const uint32_t *bits, size_t count, int32_t *out);

#endif
