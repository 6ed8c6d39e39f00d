/* A two-wheeled base: follow a trajectory, park at a pose, drive by velocity, from encoder counts to wheels.
 *
 *     static twb_base base;
 *     twb_init(&base, sizeof base, TWB_API, lab_10kg, sizeof lab_10kg, &start);
 *     twb_arm(&base);
 *     every period: twb_tick(&base, dt_us, &order, &sensed, &action);
 *
 * SI units and radians; x forward, y left, counter-clockwise positive, right before left. No heap, no globals, no I/O. One
 * thread at a time for each base. Every call returns TWB_OK or an error, after which nothing has changed: neither the base
 * nor what the pointers point to (twb_emergency_stop alone stops all the same). NULL and misaligned pointers are such errors;
 * unknown kinds, flags and device states too. A number that is NaN or infinite in an order or a measurement is a fault that the
 * base reacts to, not an error.
 *
 * On a Cortex-M4F twb_init takes 5,112, twb_tick 2,424 and twb_get_report 232 bytes of stack; as portable C 5,520, 3,304 and 276.
 * No other call takes more than twb_tick.
 */
#ifndef TWB_H
#define TWB_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Version of what stands here; twb_api() is that of the archive. */
#define TWB_API 6u

/* What a call answers. */
#define TWB_OK 0
#define TWB_NULL (-1)            /* a pointer is NULL */
#define TWB_MISALIGNED (-2)      /* a pointer is not aligned for its type */
#define TWB_NOT_INITIALISED (-3) /* there is no base in this memory */
#define TWB_BUSY (-4)            /* from an interrupt within another call on the same base */
#define TWB_MISMATCH (-5)        /* header and archive are of different versions, or the memory is too small */
#define TWB_ROBOT_MAGIC (-6)     /* the bytes are no robot */
#define TWB_ROBOT_LENGTH (-7)    /* more or fewer bytes than the robot states */
#define TWB_ROBOT_CHECK (-8)     /* a bit of the robot is wrong */
#define TWB_ROBOT_VERSION (-9)   /* the robot is of another version: write it again */
#define TWB_ROBOT_CONTENT (-10)  /* parameters out of range */
#define TWB_NOT_FINITE (-11)     /* a pose or torque is NaN or infinite, or a torque that no wheel has */
#define TWB_BAD_VALUE (-12)      /* a kind, flag or device state that is not below */
#define TWB_REFUSED (-13)        /* the base's state does not allow it */

/* Bytes of a base. */
#define TWB_BASE_SIZE 4096

/* A base. Yours to place: static, on a stack, in a struct. What is in it is not for reading; it may be copied between calls. */
typedef union twb_base {
    uint8_t bytes[TWB_BASE_SIZE];
    uint64_t alignment;
} twb_base;

typedef struct twb_pose {
    float x;     /* m */
    float y;     /* m */
    float theta; /* rad, need not be wrapped */
} twb_pose;

typedef struct twb_twist {
    float v; /* m/s; of an acceleration m/s^2 */
    float w; /* rad/s; rad/s^2 */
} twb_twist;

typedef struct twb_wheels {
    float right;
    float left;
} twb_wheels;

/* Kinds of orders. */
#define TWB_ORDER_NONE 0u     /* nothing new: what was ordered last goes on, while the host is heard (twb_watch_host) */
#define TWB_ORDER_FOLLOW 1u   /* be at pose with twist and accel, now */
#define TWB_ORDER_PARK 2u     /* go to pose and stay */
#define TWB_ORDER_VELOCITY 3u /* drive with twist until the next order, which is due in time */

/* What this tick is asked. Fields that the kind does not name are not looked at. What is beyond the base's limits is driven at
 * the limits; a velocity of more than 100 m/s or rad/s, or a goal or a reference from 10 km off on, is TWB_FAULT_STEP_REFUSED: a latched brake. */
typedef struct twb_order {
    uint32_t kind;
    uint32_t hold_heading; /* velocity: 1 keeps the heading that the turn rates lead to, else 0 */
    twb_pose pose;
    twb_twist twist;
    twb_twist accel;
    float left; /* follow: m until the path comes to rest, all forward or all backward; 0 where that is not so or not known. A base
                 * that is beside its path is led to the end by it. NaN is as 0 */
} twb_order;

/* What of twb_sensed is there beside the encoders. */
#define TWB_SENSED_FIX 1u
#define TWB_SENSED_GYRO 2u
#define TWB_SENSED_GYRO_HEADING 4u /* with TWB_SENSED_GYRO only */
#define TWB_SENSED_SUPPLY 8u
#define TWB_SENSED_CURRENTS 16u

/* How encoders and wheel driver are. */
#define TWB_DEVICE_OK 0u
#define TWB_DEVICE_BUS 1u /* no answer, or nonsense */
#define TWB_DEVICE_OVER_CURRENT 2u
#define TWB_DEVICE_UNDER_VOLTAGE 3u
#define TWB_DEVICE_OUT_OF_RANGE 4u
#define TWB_DEVICE_OTHER 5u

/* What was measured since the last tick. All zero: both encoders at 0 and well, nothing else. */
typedef struct twb_sensed {
    uint32_t flags;
    int32_t right; /* counts, wrapping around; positive drives forward */
    int32_t left;
    uint32_t encoders; /* TWB_DEVICE_...; counts are not looked at unless it is OK */
    uint32_t driver;   /* TWB_DEVICE_...: what the driver answered to the last action */
    twb_pose fix;      /* external pose, in the ticks in which one arrived. One that is NaN or infinite is TWB_FLAG_FIX_REFUSED, and
                        * TWB_FAULT_POSE_STALE once that lasts */
    float fix_age_s;   /* how long ago it was valid */
    float gyro_rate;   /* rad/s about the vertical: mean since the last reading. Of a robot without a gyro none is looked at */
    float gyro_heading; /* rad, where the sensor fuses one */
    float gyro_age_s;
    float supply_v;      /* of the motors. Duties are for the nominal one where this is below half of it, above twice, or NaN */
    twb_wheels currents; /* A */
} twb_sensed;

/* Kinds of actions. */
#define TWB_ACTION_RELEASE 0u /* no torque, free to coast */
#define TWB_ACTION_BRAKE 1u   /* windings shorted */
#define TWB_ACTION_DRIVE 2u

/* What of twb_action is there. */
#define TWB_ACTION_DUTY 1u           /* the robot has motors on bridges */
#define TWB_ACTION_LIMITED 2u        /* current or supply limit a torque; the base knows */
#define TWB_ACTION_BEYOND_COULOMB 4u /* while it creeps, by velocity or beside a goal */
#define TWB_ACTION_SPEEDS 8u         /* the robot's drivers close their own speed loop: give them desired */

/* What the wheels are to do until the next tick. Unless kind is TWB_ACTION_DRIVE all of both wheels is 0, speed too. */
typedef struct twb_action {
    uint32_t kind;
    uint32_t flags;
    twb_wheels torque;         /* N m at the wheels, without friction */
    twb_wheels duty;           /* -1 to 1 of the supply; negative drives backward */
    twb_wheels desired;        /* commanded, rad/s; with TWB_ACTION_SPEEDS led by the drivers' lag, and within what they do */
    twb_wheels speed;          /* measured, rad/s */
    twb_wheels beyond_coulomb; /* friction beyond the Coulomb part, N m */
} twb_action;

/* States. */
#define TWB_STATE_IDLE 0u
#define TWB_STATE_ARMED 1u
#define TWB_STATE_TRACKING 2u /* following, or driving by velocity */
#define TWB_STATE_PARKING 3u
#define TWB_STATE_PARKED 4u
#define TWB_STATE_STOPPING 5u
#define TWB_STATE_STOPPING_FAULT 6u /* a reset will be due */
#define TWB_STATE_BRAKING 7u
#define TWB_STATE_BRAKING_FAULT 8u
#define TWB_STATE_STOPPED 9u /* arm again */
#define TWB_STATE_FAULT 10u  /* reset, then arm again */

/* Bits of twb_report.flags. */
#define TWB_FLAG_SPEED_LIMITED 0x1u
#define TWB_FLAG_ACCEL_LIMITED 0x2u
#define TWB_FLAG_JERK_LIMITED 0x4u
#define TWB_FLAG_TORQUE_LIMITED 0x8u
#define TWB_FLAG_DISTURBANCE_LIMITED 0x10u
#define TWB_FLAG_JUMPED 0x20u  /* pose or goal */
#define TWB_FLAG_BACKING 0x40u /* parking, backward */
#define TWB_FLAG_BLIND 0x80u   /* the encoders gave nothing */
#define TWB_FLAG_PARKING 0x100u
#define TWB_FLAG_LAW 0x200u /* a law is at work: error, command and load mean something */
#define TWB_FLAG_FIX_USED 0x400u
#define TWB_FLAG_FIX_REFUSED 0x800u
#define TWB_FLAG_DRIVING 0x1000u /* by velocity */
#define TWB_FLAG_GYRO_USED 0x2000u
#define TWB_FLAG_SLIDING 0x4000u
#define TWB_FLAG_GRIP_LIMITED 0x8000u   /* wheels slid on the way to this goal: half the accelerations */
#define TWB_FLAG_ORDER_REFUSED 0x10000u /* the order did not fit the state */

/* What came of the task. */
#define TWB_OUTCOME_DRIVING 0u
#define TWB_OUTCOME_PARKED 1u
#define TWB_OUTCOME_STALLED 2u
#define TWB_OUTCOME_OUT_OF_TOLERANCE 3u

/* Why the state is what it is. */
#define TWB_CAUSE_POWER_ON 0u
#define TWB_CAUSE_HOST 1u
#define TWB_CAUSE_REFERENCES 2u
#define TWB_CAUSE_TRAJECTORY_ENDED 3u
#define TWB_CAUSE_REACHED 4u
#define TWB_CAUSE_GOAL_UNREACHABLE 5u
#define TWB_CAUSE_LINK_LOST 6u
#define TWB_CAUSE_EMERGENCY_STOP 7u
#define TWB_CAUSE_DEMANDED 8u
#define TWB_CAUSE_FAULT 9u /* cause_fault says which */

/* Faults: docs/faults.md says what finds each. What is done is as there and here unless the robot's file says otherwise. */
#define TWB_FAULT_MEASUREMENT_STALE 1u
#define TWB_FAULT_POSE_STALE 2u
#define TWB_FAULT_COMMAND_STALE 3u
#define TWB_FAULT_NOT_FINITE 4u
#define TWB_FAULT_TICK_JITTER 5u
#define TWB_FAULT_TICK_TOO_LONG 6u
#define TWB_FAULT_POSE_JUMP 7u
#define TWB_FAULT_ENCODER_STUCK 8u
#define TWB_FAULT_ENCODER_REVERSED 9u
#define TWB_FAULT_WHEEL_SLIP 10u
#define TWB_FAULT_DRIVER 11u
#define TWB_FAULT_OVER_CURRENT 12u
#define TWB_FAULT_UNDER_VOLTAGE 13u
#define TWB_FAULT_STEP_REFUSED 14u
#define TWB_FAULT_STALLED 15u
#define TWB_FAULT_GOAL_UNREACHABLE 16u
#define TWB_FAULT_GYRO 17u
#define TWB_FAULT_OVER_SPEED 18u

/* Everything about the last tick; state and cause are those of this instant. */
typedef struct twb_report {
    uint32_t tick;
    uint32_t state;         /* TWB_STATE_... */
    uint32_t cause;         /* TWB_CAUSE_... */
    uint32_t cause_fault;   /* TWB_FAULT_... that is the cause, or 0 */
    uint32_t latched_fault; /* TWB_FAULT_... that a reset acknowledges, or 0 */
    uint32_t active_faults; /* bit n - 1: the fault with code n was found in the last tick */
    uint32_t ignored;       /* faults ignored so far */
    uint32_t changes;       /* of state so far */
    uint32_t late_ticks;
    uint32_t flags;   /* TWB_FLAG_... */
    uint32_t outcome; /* TWB_OUTCOME_... */
    uint32_t retries; /* new approaches to the goal */
    uint32_t action;  /* TWB_ACTION_... */
    twb_pose pose; /* before the encoders gave anything, where the base was put */
    twb_twist twist;
    twb_pose error; /* in the body frame */
    twb_twist command;
    twb_twist velocity_error; /* measured minus commanded */
    float load_force;         /* N, that acts on the base beside its wheels */
    float load_moment;        /* N m */
    twb_wheels torque;        /* N m */
    float curvature_bias;     /* rad/m that odometry adds, as external poses taught it */
    float turn_bias;          /* rad/rad, likewise */
    float tyre_slip;          /* s^2/m that the tyres slip per acceleration, likewise */
    float motor_bias;         /* share by which the right motor's constant is above, the left one's below what is stated */
    float gyro_bias;          /* rad/s; 0 without a gyro */
    float gyro_slid;          /* rad; 0 without a gyro */
} twb_report;

/* Sizes, asserted in C before C11 as well. */
#define TWB_ASSERT_SIZE(type, size) typedef char twb_size_of_##type[sizeof(type) == (size) ? 1 : -1]
TWB_ASSERT_SIZE(twb_base, TWB_BASE_SIZE);
TWB_ASSERT_SIZE(twb_pose, 12);
TWB_ASSERT_SIZE(twb_twist, 8);
TWB_ASSERT_SIZE(twb_wheels, 8);
TWB_ASSERT_SIZE(twb_order, 40);
TWB_ASSERT_SIZE(twb_sensed, 60);
TWB_ASSERT_SIZE(twb_action, 48);
TWB_ASSERT_SIZE(twb_report, 140);
#undef TWB_ASSERT_SIZE

/* TWB_API of the archive. */
uint32_t twb_api(void);

/* Makes a base of `size` bytes, disarmed, at `start`. `robot` is what `sim-host constants FILE --c` wrote; it is not needed
 * afterwards. A base that is there already begins anew, unless something is wrong: then it stays as it is. The memory is taken
 * as it is, also where a reset of the chip left a base within a call: that one answers TWB_BUSY until then, and stops of it are
 * lost. So this call alone is not to come from an interrupt within another one on the same base. */
int32_t twb_init(twb_base *base, size_t size, uint32_t api, const uint8_t *robot, size_t length, const twb_pose *start);

/* Enables the outputs at zero torque. TWB_REFUSED while driving, stopping or in a fault. */
int32_t twb_arm(twb_base *base);

/* A controlled stop: to rest within the limits, then released, or shorted if the robot's file says so ([stops]), until armed
 * again. Never refused. */
int32_t twb_disarm(twb_base *base);

/* Acknowledges a fault or an emergency stop: TWB_STATE_FAULT becomes TWB_STATE_IDLE. TWB_REFUSED in any other state. */
int32_t twb_reset(twb_base *base);

/* The button: brake (1) or release (0). *action is to reach the wheels at once, and the ticks that follow say the same until a
 * reset, at rest as well: on a slope nothing rolls away. What a fault released stays released. Never refused; also from an interrupt within another call on the same base, whose tick then has this action. A base
 * stops whatever else is wrong, and the answer says what: without a sound pointer there is no *action, and a `brake` that is
 * neither brakes. */
int32_t twb_emergency_stop(twb_base *base, uint32_t brake, twb_action *action);

/* One tick, dt_us after the last one that answered TWB_OK, as measured: of another time than was, speeds are wrong. From 1.5
 * periods on it is late, too often TWB_FAULT_TICK_JITTER; from 10 periods on, at least 50 ms and at most 0.5 s, it is
 * TWB_FAULT_TICK_TOO_LONG, a latched controlled stop, which goes on with torques along its plan. More than 0.5 s are taken for
 * 0.5 s. 0 is TWB_FAULT_STEP_REFUSED, a latched brake, but in the first tick. Orders are the host's sign of life: see
 * twb_watch_host. After an error *action is not of this tick: release the wheels. */
int32_t twb_tick(twb_base *base, uint32_t dt_us, const twb_order *order, const twb_sensed *sensed, twb_action *action);

/* What the wheels really exert until the next tick, N m at the wheel and positive forward as action.torque, where the driver could
 * not do what it was commanded. Not needed for duties: twb_tick knows what motors on bridges exert. It is believed: the base
 * drives by it. More than ten times the robot's wheel_torque, such as another unit's, is TWB_NOT_FINITE. */
int32_t twb_note_exerted(twb_base *base, const twb_wheels *torque);

/* Puts the base elsewhere on the map; command and torque go on without a step. */
int32_t twb_set_pose(twb_base *base, const twb_pose *pose);

/* With a link that shows whether the host is there: twb_host_seen for each sound frame, twb_watch_host before each tick. Then
 * orders are due only while following or driving by velocity, and a silent host brings a controlled stop. Without a link call
 * neither, and give an order in every tick. */
int32_t twb_host_seen(twb_base *base);
int32_t twb_watch_host(twb_base *base, uint32_t dt_us);

/* Time between ticks that the robot's file states, in us. At any time, also from an interrupt within another call. */
int32_t twb_period_us(const twb_base *base, uint32_t *period_us);

/* Everything about the last tick. Call it where twb_tick is called, right after it: a base is marked during this call as well, in
 * memory that therefore has to be writable, and a tick from an interrupt within it answers TWB_BUSY and is lost. */
int32_t twb_get_report(const twb_base *base, twb_report *report);

/* Texts, static and never NULL: "unknown" for what has none. A fault's name is that of robots' files. */
const char *twb_status_text(int32_t status);
const char *twb_state_name(uint32_t state);
const char *twb_cause_name(uint32_t cause);
const char *twb_fault_name(uint32_t fault);

#ifdef __cplusplus
}
#endif

#endif
