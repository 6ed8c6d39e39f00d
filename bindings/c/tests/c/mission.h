/* A mission of a simple base, the same in C and in `tests/support/mission.rs`: both have to give the same bits. */
#ifndef MISSION_H
#define MISSION_H

#include "twb.h"

struct mission_result {
    uint64_t hash;    /* of every number of every action and report */
    uint32_t parked;  /* ticks in which the base was parked */
    uint32_t states;  /* bit n: state n was seen */
    uint32_t faults;  /* bit n - 1: the fault with code n was found */
    uint32_t refused; /* calls that the base refused */
    int32_t error;    /* the first other answer than TWB_OK and TWB_REFUSED */
};

/* Makes a base at the mission's begin. */
int32_t mission_begin(twb_base *base, const uint8_t *robot, size_t length);

void mission_run(twb_base *base, uint32_t ticks, struct mission_result *result);

#endif
