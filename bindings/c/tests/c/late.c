/* A tick that comes late: from ten periods on a latched stop, which goes on with torques along its plan. */
#include <stdio.h>
#include <string.h>

#include "robots.h"
#include "twb.h"

static void count(twb_sensed *sensed, double way_m) {
    sensed->right = sensed->left = (int32_t)(way_m * LAB_10KG_COUNTS_PER_TURN / (6.283185307 * LAB_10KG_RADIUS_RIGHT_M));
}

int main(void) {
    static const twb_pose start = {0.0f, 0.0f, 0.0f};
    static const uint32_t late_us[] = {9 * LAB_10KG_PERIOD_US, 10 * LAB_10KG_PERIOD_US, 500000, 600000, 2000000};
    unsigned number;
    for (number = 0; number < sizeof late_us / sizeof *late_us; number++) {
        static twb_base base;
        twb_order order;
        twb_sensed sensed;
        twb_action action;
        twb_report report;
        double way_m = 0.0, speed = 0.0;
        int tick;
        memset(&order, 0, sizeof order);
        memset(&sensed, 0, sizeof sensed);
        order.kind = TWB_ORDER_VELOCITY;
        order.twist.v = 0.5f;
        if (twb_init(&base, sizeof base, TWB_API, lab_10kg, sizeof lab_10kg, &start) != TWB_OK || twb_arm(&base) != TWB_OK) {
            return 1;
        }
        /* Poses are not late yet. */
        for (tick = 0; tick < 95; tick++) {
            count(&sensed, way_m);
            if (twb_tick(&base, LAB_10KG_PERIOD_US, &order, &sensed, &action) != TWB_OK) {
                return 1;
            }
            speed = LAB_10KG_RADIUS_RIGHT_M * (double)action.desired.right;
            way_m += 1e-6 * LAB_10KG_PERIOD_US * speed;
        }
        count(&sensed, way_m + 1e-6 * late_us[number] * speed);
        if (twb_tick(&base, late_us[number], &order, &sensed, &action) != TWB_OK || twb_get_report(&base, &report) != TWB_OK) {
            return 1;
        }
        printf("%u %s, %s, %s, %.3f rad/s\n", (unsigned)late_us[number], twb_state_name(report.state),
               twb_fault_name(report.cause_fault), action.kind == TWB_ACTION_DRIVE ? "driven" : "not driven",
               (double)action.desired.right);
    }
    return 0;
}
