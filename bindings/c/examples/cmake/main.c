/* A base parks 1 m ahead. The plant is as simple as it can be: torque on a mass that moves straight. On a robot the two lines
 * with a comment are yours. */
#include <stdio.h>

#include "lab_10kg.h"
#include "twb.h"

int main(void) {
    static twb_base base;
    const twb_pose start = {0.0f, 0.0f, 0.0f};
    twb_order order = {TWB_ORDER_PARK, 0, {1.0f, 0.0f, 0.0f}, {0.0f, 0.0f}, {0.0f, 0.0f}, 0.0f};
    twb_sensed sensed = {0};
    twb_action action;
    twb_report report;
    float speed = 0.0f, way = 0.0f;
    uint32_t tick;
    int32_t status = twb_init(&base, sizeof base, TWB_API, lab_10kg, sizeof lab_10kg, &start);
    if (status == TWB_OK) {
        status = twb_arm(&base);
    }
    for (tick = 0; tick < 1500 && status == TWB_OK; tick++) {
        sensed.right = sensed.left = (int32_t)(way / 0.075f * 325.9493f); /* read both encoders */
        sensed.flags = TWB_SENSED_FIX;
        sensed.fix.x = way;
        status = twb_tick(&base, LAB_10KG_PERIOD_US, &order, &sensed, &action);
        speed += (action.torque.right + action.torque.left) / 0.075f / 10.0f * 0.01f; /* set both motors to action.duty */
        way += speed * 0.01f;
    }
    if (status == TWB_OK) {
        status = twb_get_report(&base, &report);
    }
    if (status != TWB_OK) {
        printf("%s\n", twb_status_text(status));
        return 1;
    }
    printf("%s at %.3f m\n", twb_state_name(report.state), (double)way);
    return report.state == TWB_STATE_PARKED ? 0 : 1;
}
