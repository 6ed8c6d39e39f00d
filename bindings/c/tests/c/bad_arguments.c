/* Every function with every bad argument: the answer, and that nothing has changed. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "robots.h"
#include "twb.h"

static unsigned checks, failures;

static void expect(int holds, const char *claim, int line) {
    checks++;
    if (!holds) {
        failures++;
        printf("line %d: %s\n", line, claim);
    }
}
#define EXPECT(claim) expect((claim) != 0, #claim, __LINE__)

static twb_base base, before;
static twb_order order;
static twb_sensed sensed;
static twb_action action, action_before;
static twb_report report, report_before;
static twb_pose pose;
static twb_wheels torque;
static uint32_t period, period_before;

static void remember(void) {
    memset(&action, 0xA5, sizeof action);
    memset(&report, 0xA5, sizeof report);
    period = 0xA5A5A5A5u;
    before = base;
    action_before = action;
    report_before = report;
    period_before = period;
}

static int unchanged(void) {
    return memcmp(&base, &before, sizeof base) == 0 && memcmp(&action, &action_before, sizeof action) == 0 &&
           memcmp(&report, &report_before, sizeof report) == 0 && period == period_before;
}

/* The call answers this, and has changed nothing. */
#define ANSWERS(call, status)            \
    do {                                 \
        remember();                      \
        EXPECT((call) == (status));      \
        EXPECT(unchanged());             \
    } while (0)

/* One byte beside where a type belongs. */
#define BESIDE(type, object) ((type *)(void *)((uint8_t *)(object) + 1))

/* Every call on memory that is no base. */
static void refuses_all(twb_base *to, int32_t status) {
    ANSWERS(twb_arm(to), status);
    ANSWERS(twb_disarm(to), status);
    ANSWERS(twb_reset(to), status);
    ANSWERS(twb_emergency_stop(to, 0, &action), status);
    ANSWERS(twb_emergency_stop(to, 1, &action), status);
    ANSWERS(twb_tick(to, 10000, &order, &sensed, &action), status);
    ANSWERS(twb_note_exerted(to, &torque), status);
    ANSWERS(twb_set_pose(to, &pose), status);
    ANSWERS(twb_host_seen(to), status);
    ANSWERS(twb_watch_host(to, 10000), status);
    ANSWERS(twb_period_us(to, &period), status);
    ANSWERS(twb_get_report(to, &report), status);
}

static void bad_pointers(void) {
    ANSWERS(twb_tick(&base, 10000, NULL, &sensed, &action), TWB_NULL);
    ANSWERS(twb_tick(&base, 10000, &order, NULL, &action), TWB_NULL);
    ANSWERS(twb_tick(&base, 10000, &order, &sensed, NULL), TWB_NULL);
    ANSWERS(twb_tick(&base, 10000, BESIDE(twb_order, &order), &sensed, &action), TWB_MISALIGNED);
    ANSWERS(twb_tick(&base, 10000, &order, BESIDE(twb_sensed, &sensed), &action), TWB_MISALIGNED);
    ANSWERS(twb_tick(&base, 10000, &order, &sensed, BESIDE(twb_action, &action)), TWB_MISALIGNED);
    ANSWERS(twb_note_exerted(&base, NULL), TWB_NULL);
    ANSWERS(twb_note_exerted(&base, BESIDE(twb_wheels, &torque)), TWB_MISALIGNED);
    ANSWERS(twb_set_pose(&base, NULL), TWB_NULL);
    ANSWERS(twb_set_pose(&base, BESIDE(twb_pose, &pose)), TWB_MISALIGNED);
    ANSWERS(twb_period_us(&base, NULL), TWB_NULL);
    ANSWERS(twb_period_us(&base, BESIDE(uint32_t, &period)), TWB_MISALIGNED);
    ANSWERS(twb_get_report(&base, NULL), TWB_NULL);
    ANSWERS(twb_get_report(&base, BESIDE(twb_report, &report)), TWB_MISALIGNED);
}

static void bad_values(void) {
    const float nan = NAN, infinite = HUGE_VALF;
    float *const numbers[] = {&pose.x, &pose.y, &pose.theta};
    const uint32_t flags[] = {TWB_SENSED_GYRO_HEADING, 32u, 0x80000000u};
    size_t at;
    for (at = 0; at < 3; at++) {
        *numbers[at] = nan;
        ANSWERS(twb_set_pose(&base, &pose), TWB_NOT_FINITE);
        ANSWERS(twb_init(&base, sizeof base, TWB_API, lab_10kg, sizeof lab_10kg, &pose), TWB_NOT_FINITE);
        *numbers[at] = -infinite;
        ANSWERS(twb_set_pose(&base, &pose), TWB_NOT_FINITE);
        *numbers[at] = 0.0f;
    }
    torque.left = nan;
    ANSWERS(twb_note_exerted(&base, &torque), TWB_NOT_FINITE);
    torque.left = 0.0f;
    torque.right = infinite;
    ANSWERS(twb_note_exerted(&base, &torque), TWB_NOT_FINITE);
    torque.right = 0.0f;
    order.kind = 4;
    ANSWERS(twb_tick(&base, 10000, &order, &sensed, &action), TWB_BAD_VALUE);
    order.kind = 0xFFFFFFFFu;
    ANSWERS(twb_tick(&base, 10000, &order, &sensed, &action), TWB_BAD_VALUE);
    order.kind = TWB_ORDER_VELOCITY;
    order.hold_heading = 2;
    ANSWERS(twb_tick(&base, 10000, &order, &sensed, &action), TWB_BAD_VALUE);
    memset(&order, 0, sizeof order);
    for (at = 0; at < sizeof flags / sizeof *flags; at++) {
        sensed.flags = flags[at];
        ANSWERS(twb_tick(&base, 10000, &order, &sensed, &action), TWB_BAD_VALUE);
    }
    sensed.flags = 0;
    sensed.encoders = 6;
    ANSWERS(twb_tick(&base, 10000, &order, &sensed, &action), TWB_BAD_VALUE);
    sensed.encoders = 0;
    sensed.driver = 6;
    ANSWERS(twb_tick(&base, 10000, &order, &sensed, &action), TWB_BAD_VALUE);
    sensed.driver = 0;
}

static void bad_robots(void) {
    uint8_t robot[sizeof lab_10kg + 1];
    size_t at;
    ANSWERS(twb_init(NULL, sizeof base, TWB_API, lab_10kg, sizeof lab_10kg, &pose), TWB_NULL);
    ANSWERS(twb_init(&base, sizeof base, TWB_API, NULL, sizeof lab_10kg, &pose), TWB_NULL);
    ANSWERS(twb_init(&base, sizeof base, TWB_API, lab_10kg, sizeof lab_10kg, NULL), TWB_NULL);
    ANSWERS(twb_init(BESIDE(twb_base, &base), sizeof base, TWB_API, lab_10kg, sizeof lab_10kg, &pose), TWB_MISALIGNED);
    ANSWERS(twb_init(&base, sizeof base, TWB_API, lab_10kg, sizeof lab_10kg, BESIDE(twb_pose, &pose)), TWB_MISALIGNED);
    ANSWERS(twb_init(&base, sizeof base - 1, TWB_API, lab_10kg, sizeof lab_10kg, &pose), TWB_MISMATCH);
    ANSWERS(twb_init(&base, 0, TWB_API, lab_10kg, sizeof lab_10kg, &pose), TWB_MISMATCH);
    ANSWERS(twb_init(&base, sizeof base, TWB_API + 1u, lab_10kg, sizeof lab_10kg, &pose), TWB_MISMATCH);
    ANSWERS(twb_init(&base, sizeof base, TWB_API, lab_10kg, (size_t)-1, &pose), TWB_ROBOT_LENGTH);
    for (at = 0; at < sizeof lab_10kg; at++) {
        ANSWERS(twb_init(&base, sizeof base, TWB_API, lab_10kg, at, &pose), TWB_ROBOT_LENGTH);
    }
    memcpy(robot, lab_10kg, sizeof lab_10kg);
    robot[sizeof lab_10kg] = 0;
    ANSWERS(twb_init(&base, sizeof base, TWB_API, robot, sizeof robot, &pose), TWB_ROBOT_LENGTH);
    /* Any damaged byte: of the magic, of the length, and of what the check is over. */
    for (at = 0; at < sizeof lab_10kg; at++) {
        int32_t status = at < 4 ? TWB_ROBOT_MAGIC : at == 6 || at == 7 ? TWB_ROBOT_LENGTH : TWB_ROBOT_CHECK;
        robot[at] ^= 0x10;
        ANSWERS(twb_init(&base, sizeof base, TWB_API, robot, sizeof lab_10kg, &pose), status);
        robot[at] ^= 0x10;
    }
    ANSWERS(twb_init(&base, sizeof base, TWB_API, other_version, sizeof other_version, &pose), TWB_ROBOT_VERSION);
    ANSWERS(twb_init(&base, sizeof base, TWB_API, out_of_range, sizeof out_of_range, &pose), TWB_ROBOT_CONTENT);
    ANSWERS(twb_init(&base, sizeof base, TWB_API, no_parameters, sizeof no_parameters, &pose), TWB_ROBOT_CONTENT);
}

/* Whatever else is wrong, a base stops: what it says afterwards, and what its next tick does. */
static void stops(uint32_t brake, twb_action *to, int32_t status, uint32_t kind) {
    static twb_base driving;
    driving = base;
    remember();
    EXPECT(twb_emergency_stop(&driving, brake, to) == status);
    EXPECT(to == &action ? action.kind == kind : memcmp(&action, &action_before, sizeof action) == 0);
    EXPECT(twb_get_report(&driving, &report) == TWB_OK && report.cause == TWB_CAUSE_EMERGENCY_STOP);
    EXPECT(twb_tick(&driving, 10000, &order, &sensed, &action) == TWB_OK && action.kind == kind);
    EXPECT(twb_arm(&driving) == TWB_REFUSED);
}

static void stops_all_the_same(void) {
    stops(1, &action, TWB_OK, TWB_ACTION_BRAKE);
    stops(0, &action, TWB_OK, TWB_ACTION_RELEASE);
    stops(1, NULL, TWB_NULL, TWB_ACTION_BRAKE);
    stops(0, NULL, TWB_NULL, TWB_ACTION_RELEASE);
    stops(1, BESIDE(twb_action, &action), TWB_MISALIGNED, TWB_ACTION_BRAKE);
    stops(2, &action, TWB_BAD_VALUE, TWB_ACTION_BRAKE);
    stops(2, NULL, TWB_NULL, TWB_ACTION_BRAKE);
}

/* Before the encoders gave anything a base is where it was put. */
static void placed(void) {
    static twb_base other;
    const twb_pose here = {3.0f, 4.0f, 0.5f}, there = {5.0f, 6.0f, -0.5f};
    twb_sensed silent;
    memset(&silent, 0, sizeof silent);
    silent.encoders = TWB_DEVICE_BUS;
    EXPECT(twb_init(&other, sizeof other, TWB_API, lab_10kg, sizeof lab_10kg, &here) == TWB_OK);
    EXPECT(twb_get_report(&other, &report) == TWB_OK && memcmp(&report.pose, &here, sizeof here) == 0);
    EXPECT(twb_set_pose(&other, &there) == TWB_OK);
    EXPECT(twb_get_report(&other, &report) == TWB_OK && memcmp(&report.pose, &there, sizeof there) == 0);
    EXPECT(twb_tick(&other, 10000, &order, &silent, &action) == TWB_OK);
    EXPECT(twb_get_report(&other, &report) == TWB_OK && memcmp(&report.pose, &there, sizeof there) == 0);
    EXPECT(twb_tick(&other, 10000, &order, &sensed, &action) == TWB_OK);
    EXPECT(twb_get_report(&other, &report) == TWB_OK && memcmp(&report.pose, &there, sizeof there) == 0);
    /* Afterwards its report is that of the last tick. */
    EXPECT(twb_set_pose(&other, &here) == TWB_OK);
    EXPECT(twb_get_report(&other, &report) == TWB_OK && memcmp(&report.pose, &there, sizeof there) == 0);
    EXPECT(twb_tick(&other, 10000, &order, &sensed, &action) == TWB_OK);
    EXPECT(twb_get_report(&other, &report) == TWB_OK && memcmp(&report.pose, &here, sizeof here) == 0);
}

static void texts(void) {
    int32_t status;
    uint32_t code;
    for (status = TWB_OK; status >= TWB_REFUSED; status--) {
        EXPECT(strcmp(twb_status_text(status), "unknown") != 0);
    }
    EXPECT(strcmp(twb_status_text(1), "unknown") == 0);
    EXPECT(strcmp(twb_status_text(TWB_REFUSED - 1), "unknown") == 0);
    EXPECT(strcmp(twb_status_text((int32_t)0x80000000u), "unknown") == 0);
    for (code = 0; code <= TWB_STATE_FAULT; code++) {
        EXPECT(strcmp(twb_state_name(code), "unknown") != 0);
    }
    EXPECT(strcmp(twb_state_name(TWB_STATE_FAULT + 1u), "unknown") == 0);
    EXPECT(strcmp(twb_state_name(0xFFFFFFFFu), "unknown") == 0);
    EXPECT(strcmp(twb_cause_name(TWB_CAUSE_FAULT), "fault") == 0);
    EXPECT(strcmp(twb_cause_name(TWB_CAUSE_FAULT + 1u), "unknown") == 0);
    EXPECT(strcmp(twb_fault_name(0), "unknown") == 0);
    EXPECT(strcmp(twb_fault_name(TWB_FAULT_MEASUREMENT_STALE), "measurement_stale") == 0);
    EXPECT(strcmp(twb_fault_name(TWB_FAULT_GYRO), "gyro") == 0);
    EXPECT(strcmp(twb_fault_name(TWB_FAULT_OVER_SPEED), "over_speed") == 0);
    EXPECT(strcmp(twb_fault_name(TWB_FAULT_OVER_SPEED + 1u), "unknown") == 0);
    EXPECT(strcmp(twb_fault_name(33), "unknown") == 0);
    EXPECT(strcmp(twb_fault_name(0xFFFFFFFFu), "unknown") == 0);
}

/* Drivers that close their own speed loop get speeds and no duties; a base that is only armed lets them go. */
static void by_speeds(void) {
    twb_base other;
    twb_order go;
    int tick;
    memset(&go, 0, sizeof go);
    EXPECT(twb_init(&other, sizeof other, TWB_API, with_speed_drivers, sizeof with_speed_drivers, &pose) == TWB_OK);
    EXPECT(twb_tick(&other, 10000, &go, &sensed, &action) == TWB_OK && action.kind == TWB_ACTION_RELEASE);
    EXPECT(twb_arm(&other) == TWB_OK);
    EXPECT(twb_tick(&other, 10000, &go, &sensed, &action) == TWB_OK && action.kind == TWB_ACTION_RELEASE);
    go.kind = TWB_ORDER_VELOCITY;
    go.twist.v = 0.3f;
    for (tick = 0; tick < 10; ++tick) {
        EXPECT(twb_tick(&other, 10000, &go, &sensed, &action) == TWB_OK && action.kind == TWB_ACTION_DRIVE);
        EXPECT((action.flags & (TWB_ACTION_SPEEDS | TWB_ACTION_DUTY)) == TWB_ACTION_SPEEDS);
    }
    EXPECT(action.desired.right > 0.0f && action.desired.right <= 20.0f && action.duty.right == 0.0f);
}

int main(void) {
    EXPECT(twb_api() == TWB_API);
    refuses_all(NULL, TWB_NULL);
    refuses_all(BESIDE(twb_base, &base), TWB_MISALIGNED);
    /* Zeroed, erased and painted memory is no base, and no bad robot makes one of it. */
    refuses_all(&base, TWB_NOT_INITIALISED);
    memset(&base, 0xFF, sizeof base);
    refuses_all(&base, TWB_NOT_INITIALISED);
    memset(&base, 0xA5, sizeof base);
    refuses_all(&base, TWB_NOT_INITIALISED);
    bad_robots();
    refuses_all(&base, TWB_NOT_INITIALISED);
    /* Neither does any of it touch a base that drives. */
    EXPECT(twb_init(&base, sizeof base, TWB_API, lab_10kg, sizeof lab_10kg, &pose) == TWB_OK);
    EXPECT(twb_reset(&base) == TWB_REFUSED);
    EXPECT(twb_period_us(&base, &period) == TWB_OK && period == LAB_10KG_PERIOD_US);
    EXPECT(twb_tick(&base, 10000, &order, &sensed, &action) == TWB_OK && action.kind == TWB_ACTION_RELEASE);
    EXPECT(twb_arm(&base) == TWB_OK);
    order.kind = TWB_ORDER_PARK;
    order.pose.x = 1.0f;
    EXPECT(twb_tick(&base, 10000, &order, &sensed, &action) == TWB_OK && action.kind == TWB_ACTION_DRIVE);
    EXPECT(action.flags & TWB_ACTION_DUTY);
    EXPECT(twb_get_report(&base, &report) == TWB_OK && report.state == TWB_STATE_PARKING && report.tick == 2);
    memset(&order, 0, sizeof order);
    bad_pointers();
    bad_values();
    bad_robots();
    stops_all_the_same();
    placed();
    EXPECT(twb_arm(&base) == TWB_REFUSED);
    /* A base is a value: its copy goes on where it was. */
    before = base;
    EXPECT(twb_tick(&before, 10000, &order, &sensed, &action_before) == TWB_OK);
    EXPECT(twb_tick(&base, 10000, &order, &sensed, &action) == TWB_OK);
    EXPECT(memcmp(&action, &action_before, sizeof action) == 0);
    /* The button holds until a reset. */
    EXPECT(twb_emergency_stop(&base, 1, &action) == TWB_OK && action.kind == TWB_ACTION_BRAKE);
    EXPECT(twb_get_report(&base, &report) == TWB_OK && report.state == TWB_STATE_BRAKING_FAULT);
    EXPECT(twb_tick(&base, 10000, &order, &sensed, &action) == TWB_OK && action.kind == TWB_ACTION_BRAKE);
    EXPECT(twb_emergency_stop(&base, 0, &action) == TWB_OK && action.kind == TWB_ACTION_RELEASE);
    EXPECT(twb_get_report(&base, &report) == TWB_OK && report.state == TWB_STATE_FAULT);
    EXPECT(twb_arm(&base) == TWB_REFUSED);
    EXPECT(twb_reset(&base) == TWB_OK && twb_arm(&base) == TWB_OK && twb_disarm(&base) == TWB_OK);
    by_speeds();
    texts();
    printf("%u checks, %u failed\n", checks, failures);
    return failures != 0;
}
