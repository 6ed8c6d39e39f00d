/* The mission on an emulated board: prints what `tests/support/mission.rs` prints, and bytes of the stack that were needed. */
#include <stdio.h>

#include "mission.h"
#include "robots.h"

#define PAINTED 0x4000

int main(void) {
    static twb_base base;
    volatile uint8_t *const end = (volatile uint8_t *)__builtin_frame_address(0) - 256;
    uint32_t below;
    struct mission_result result;
    for (below = 1; below <= PAINTED; below++) {
        *(end - below) = 0xA5;
    }
    mission_run(&base, lab_10kg, sizeof lab_10kg, TICKS, &result);
    printf("hash %X parked %u states %x faults %x refused %u error %s\n", result.hash, (unsigned)result.parked,
           (unsigned)result.states, (unsigned)result.faults, (unsigned)result.refused,
           result.error == TWB_OK ? "0" : twb_status_text(result.error));
    for (below = PAINTED; below > 0 && *(end - below) == 0xA5; below--) {
    }
    printf("stack %u\n", (unsigned)below + 256);
    return result.error != TWB_OK;
}
