/* Emergency stops out of a timer's interrupt, here a signal, at any instant of a tick. */
#define _XOPEN_SOURCE 700
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/time.h>

#include "robots.h"
#include "twb.h"

static twb_base base, cut_short;
static volatile sig_atomic_t came, within, failed;

static void interrupt(int number) {
    twb_action action;
    uint32_t period;
    int32_t other = twb_host_seen(&base);
    (void)number;
    came = 1;
    if (other == TWB_BUSY) {
        within = 1;
        cut_short = base;
    } else if (other != TWB_OK) {
        failed = 1;
    }
    /* Any other call waits, but for a stop and what never changes. */
    if (twb_emergency_stop(&base, 1, &action) != TWB_OK || action.kind == TWB_ACTION_DRIVE ||
        twb_period_us(&base, &period) != TWB_OK || period != LAB_10KG_PERIOD_US) {
        failed = 1;
    }
}

static int32_t init(twb_base *to) {
    static const twb_pose start = {0.0f, 0.0f, 0.0f};
    return twb_init(to, sizeof *to, TWB_API, lab_10kg, sizeof lab_10kg, &start);
}

/* Memory as a reset of the chip within a call leaves it: a base in a call until it is one anew, and nothing is left of that call. */
static int begins_anew(twb_base *memory, const twb_order *order, const twb_sensed *sensed) {
    twb_action action;
    return twb_tick(memory, 10000, order, sensed, &action) == TWB_BUSY && twb_emergency_stop(memory, 1, &action) == TWB_OK &&
           init(memory) == TWB_OK && twb_arm(memory) == TWB_OK &&
           twb_tick(memory, 10000, order, sensed, &action) == TWB_OK && action.kind == TWB_ACTION_DRIVE;
}

int main(void) {
    static const struct itimerval soon = {{0, 0}, {0, 30}};
    twb_order order;
    twb_sensed sensed;
    twb_action action;
    twb_report report;
    struct sigaction handler;
    unsigned stops = 0, begun = 0, tries;
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
        if (init(&base) != TWB_OK || twb_arm(&base) != TWB_OK) {
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
            twb_arm(&base) != TWB_REFUSED || !begins_anew(&cut_short, &order, &sensed)) {
            failed = 1;
        }
    }
    /* A stop while a base begins anew is one of the new base. */
    for (tries = 0; tries < 200000 && begun < 10 && !failed; tries++) {
        came = within = 0;
        setitimer(ITIMER_REAL, &soon, NULL);
        while (!came) {
            failed |= init(&base) != TWB_OK;
        }
        if (within) {
            begun++;
            failed |= twb_arm(&base) != TWB_REFUSED;
        }
    }
    printf("%u stops within a tick, %u within a begin, %s\n", stops, begun, failed ? "failed" : "all obeyed");
    return failed || stops < 100 || begun < 10;
}
