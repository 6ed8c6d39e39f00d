/* Emergency stops out of a timer's interrupt, here a signal, at any instant of a tick. */
#define _XOPEN_SOURCE 700
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/time.h>

#include "robots.h"
#include "twb.h"

static twb_base base;
static volatile sig_atomic_t within, failed;

static void interrupt(int number) {
    twb_action action;
    int32_t other = twb_host_seen(&base);
    (void)number;
    /* Any other call waits, a stop does not. */
    if (twb_emergency_stop(&base, 1, &action) != TWB_OK || action.kind == TWB_ACTION_DRIVE) {
        failed = 1;
    }
    if (other == TWB_BUSY) {
        within = 1;
    } else if (other != TWB_OK) {
        failed = 1;
    }
}

int main(void) {
    static const struct itimerval soon = {{0, 0}, {0, 30}};
    const twb_pose start = {0.0f, 0.0f, 0.0f};
    twb_order order;
    twb_sensed sensed;
    twb_action action;
    twb_report report;
    struct sigaction handler;
    unsigned stops = 0, tries;
    memset(&handler, 0, sizeof handler);
    memset(&order, 0, sizeof order);
    memset(&sensed, 0, sizeof sensed);
    handler.sa_handler = interrupt;
    order.kind = TWB_ORDER_PARK;
    order.pose.x = 1.0f;
    if (sigaction(SIGALRM, &handler, NULL) != 0) {
        return 2;
    }
    for (tries = 0; tries < 200000 && stops < 100 && !failed; tries++) {
        int32_t answer = TWB_OK;
        unsigned tick;
        if (twb_init(&base, sizeof base, TWB_API, lab_10kg, sizeof lab_10kg, &start) != TWB_OK || twb_arm(&base) != TWB_OK) {
            return 3;
        }
        within = 0;
        setitimer(ITIMER_REAL, &soon, NULL);
        for (tick = 0; tick < 100 && !within && answer == TWB_OK; tick++) {
            answer = twb_tick(&base, 10000, &order, &sensed, &action);
        }
        /* Whatever is still to come, comes before the next look. */
        sigset_t pending;
        while (sigpending(&pending) == 0 && sigismember(&pending, SIGALRM)) {
        }
        if (!within) {
            const struct itimerval off = {{0, 0}, {0, 0}};
            setitimer(ITIMER_REAL, &off, NULL);
            continue;
        }
        stops++;
        if (answer != TWB_OK || action.kind == TWB_ACTION_DRIVE || twb_get_report(&base, &report) != TWB_OK ||
            (report.state != TWB_STATE_BRAKING_FAULT && report.state != TWB_STATE_FAULT) ||
            twb_arm(&base) != TWB_REFUSED) {
            failed = 1;
        }
    }
    printf("%u stops within a tick, %s\n", stops, failed ? "failed" : "all obeyed");
    return failed || stops < 100;
}
