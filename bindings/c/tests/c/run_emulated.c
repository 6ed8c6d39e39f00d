/* The mission on an emulated board: prints what `tests/support/mission.rs` prints, and bytes of the stack that were needed: to
 * begin, for the mission with all that it calls, and for a report. */
#include <stdio.h>

#include "mission.h"
#include "robots.h"

#define PAINTED 0x4000
/* Room for main's own frame, which is not painted. */
#define BESIDE 128

static void paint(volatile uint8_t *end) {
    uint32_t below;
    for (below = 1; below <= PAINTED; below++) {
        *(end - below) = 0xA5;
    }
}

static unsigned needed(const volatile uint8_t *end) {
    uint32_t below = PAINTED;
    while (below > 0 && *(end - below) == 0xA5) {
        below--;
    }
    return (unsigned)below + BESIDE;
}

int main(void) {
    static twb_base base;
    static struct mission_result result;
    static twb_report report;
    volatile uint8_t *const end = (volatile uint8_t *)__builtin_frame_address(0) - BESIDE;
    unsigned begin, mission;
    paint(end);
    if (mission_begin(&base, lab_10kg, sizeof lab_10kg) != TWB_OK) {
        return 2;
    }
    begin = needed(end);
    paint(end);
    mission_run(&base, TICKS, &result);
    mission = needed(end);
    paint(end);
    if (twb_get_report(&base, &report) != TWB_OK) {
        return 2;
    }
    printf("hash %X parked %u states %x faults %x refused %u error %s\nstack %u %u %u\n", result.hash, (unsigned)result.parked,
           (unsigned)result.states, (unsigned)result.faults, (unsigned)result.refused,
           result.error == TWB_OK ? "0" : twb_status_text(result.error), begin, mission, needed(end));
    return result.error != TWB_OK;
}
