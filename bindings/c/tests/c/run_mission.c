/* The mission on a machine with a C library: prints what `tests/support/mission.rs` prints. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "mission.h"
#include "robots.h"

int main(int count, char **arguments) {
    static twb_base base;
    struct mission_result result;
    uint32_t ticks = count > 1 ? (uint32_t)strtoul(arguments[1], NULL, 10) : 0;
    if (mission_begin(&base, lab_10kg, sizeof lab_10kg) != TWB_OK) {
        return 2;
    }
    mission_run(&base, ticks, &result);
    printf("hash %016" PRIx64 " parked %" PRIu32 " states %" PRIx32 " faults %" PRIx32 " refused %" PRIu32 " error %" PRId32 "\n",
           result.hash, result.parked, result.states, result.faults, result.refused, result.error);
    return result.error == TWB_OK ? 0 : 1;
}
