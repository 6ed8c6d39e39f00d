#include "mission.h"

/* Declared here: a cross compiler may come without a C library. */
void *memcpy(void *to, const void *from, size_t bytes);
void *memset(void *to, int value, size_t bytes);

/* The plant: a rigid base of the robot's nominal mass on wheels that roll, in single precision. Nothing here may be contracted
 * to fused operations (-ffp-contract=off): Rust does not. */
#define DT 0.01f
#define MASS 10.0f
#define INERTIA 0.3f
#define RADIUS 0.075f
#define HALF_TRACK 0.175f
#define COUNTS_PER_RAD 325.9493f

struct plant {
    twb_twist twist;
    twb_wheels part; /* of a count */
    uint32_t right, left;
};

static void count(float *part, uint32_t *counts, float speed) {
    float moved = *part + speed * DT * COUNTS_PER_RAD;
    int32_t whole = (int32_t)moved;
    *part = moved - (float)whole;
    *counts += (uint32_t)whole;
}

static void plant_advance(struct plant *plant, const twb_action *action) {
    twb_twist *twist = &plant->twist;
    if (action->kind == TWB_ACTION_DRIVE) {
        float force = (action->torque.right + action->torque.left) / RADIUS;
        float moment = (action->torque.right - action->torque.left) * HALF_TRACK / RADIUS;
        twist->v = twist->v + force / MASS * DT;
        twist->w = twist->w + moment / INERTIA * DT;
    } else {
        float kept = action->kind == TWB_ACTION_BRAKE ? 0.8f : 0.97f;
        twist->v = twist->v * kept;
        twist->w = twist->w * kept;
    }
    count(&plant->part.right, &plant->right, (twist->v + twist->w * HALF_TRACK) / RADIUS);
    count(&plant->part.left, &plant->left, (twist->v - twist->w * HALF_TRACK) / RADIUS);
}

static uint32_t draw(uint32_t *seed) {
    *seed = *seed * 1664525u + 1013904223u;
    return *seed >> 8;
}

/* -1 to 1. */
static float noise(uint32_t *seed) {
    return (float)draw(seed) / 8388608.0f - 1.0f;
}

static uint64_t mix(uint64_t hash, const void *words, size_t bytes) {
    const uint8_t *from = (const uint8_t *)words;
    size_t at;
    for (at = 0; at < bytes; at += 4) {
        uint32_t word;
        memcpy(&word, from + at, 4);
        hash = (hash ^ word) * 0x100000001B3u;
    }
    return hash;
}

#define CYCLE 6000u

static void order_at(uint32_t cycle, uint32_t at, twb_order *order) {
    static const twb_pose goals[4] = {{1.0f, 0.3f, 0.5f}, {-0.5f, 1.0f, 3.0f}, {0.2f, -0.7f, -1.5f}, {1.5f, 1.5f, 0.0f}};
    memset(order, 0, sizeof *order);
    if (at < 12u) {
        return;
    }
    if (at < 2000u) {
        order->kind = TWB_ORDER_PARK;
        order->pose = goals[cycle % 4u];
    } else if (at < 2600u) {
        order->kind = TWB_ORDER_VELOCITY;
        order->hold_heading = cycle % 2u;
        order->twist.v = 0.4f;
        order->twist.w = 0.001f * ((float)at - 2300.0f);
    } else if (at < 4000u) {
        order->kind = TWB_ORDER_PARK;
    } else if (at < 5000u) {
        float t = ((float)at - 4000.0f) * DT, rest = 4.0f - t;
        order->kind = TWB_ORDER_FOLLOW;
        order->pose.y = 0.03f;
        if (t < 2.0f) {
            order->pose.x = 0.125f * t * t;
            order->twist.v = 0.25f * t;
            order->accel.v = 0.25f;
        } else if (t < 4.0f) {
            order->pose.x = 1.0f - 0.125f * rest * rest;
            order->twist.v = 0.25f * rest;
            order->accel.v = -0.25f;
        } else {
            order->pose.x = 1.0f;
        }
        order->left = 1.0f - order->pose.x;
    } else if (at < 5400u) {
        order->kind = TWB_ORDER_PARK;
        order->pose.x = 4.5f;
    } else if (at >= 5460u && at < 5800u) {
        order->kind = TWB_ORDER_VELOCITY;
        order->twist.v = -0.3f;
    }
}

static const twb_pose start = {0.0f, 0.0f, 0.0f};

int32_t mission_begin(twb_base *base, const uint8_t *robot, size_t length) {
    return twb_init(base, sizeof *base, TWB_API, robot, length, &start);
}

void mission_run(twb_base *base, uint32_t ticks, struct mission_result *result) {
    struct plant plant;
    twb_action action;
    twb_report report;
    uint32_t seed = 1, tick;
    memset(&plant, 0, sizeof plant);
    memset(&report, 0, sizeof report);
    memset(result, 0, sizeof *result);
    result->hash = 0xCBF29CE484222325u;
    for (tick = 0; tick < ticks && result->error == TWB_OK; tick++) {
        uint32_t cycle = tick / CYCLE, at = tick % CYCLE, dt_us = 10000;
        int32_t answer = TWB_OK;
        twb_order order;
        twb_sensed sensed;
        order_at(cycle, at, &order);
        memset(&sensed, 0, sizeof sensed);
        sensed.right = (int32_t)plant.right;
        sensed.left = (int32_t)plant.left;
        sensed.flags = TWB_SENSED_SUPPLY;
        sensed.supply_v = 23.0f + 0.5f * noise(&seed);
        dt_us += draw(&seed) % 400u;
        if (cycle % 3u == 2u) {
            sensed.flags |= TWB_SENSED_CURRENTS;
            sensed.currents.right = 2.0f * noise(&seed);
            sensed.currents.left = 2.0f * noise(&seed);
        }
        if (tick % 5u == 4u) {
            sensed.flags |= TWB_SENSED_FIX;
            sensed.fix.x = report.pose.x + 0.002f * noise(&seed);
            sensed.fix.y = report.pose.y + 0.002f * noise(&seed);
            sensed.fix.theta = report.pose.theta + 0.002f * noise(&seed);
            sensed.fix_age_s = 0.02f;
        }
        if (at == 5650u && cycle % 4u == 1u) {
            sensed.driver = TWB_DEVICE_OVER_CURRENT;
        }
        if (at >= 5650u && at < 5670u && cycle % 4u == 2u) {
            sensed.encoders = TWB_DEVICE_BUS;
        }
        if (at >= 5650u && at < 5780u && cycle % 4u == 3u) {
            sensed.flags &= ~(uint32_t)TWB_SENSED_FIX;
        }
        switch (at) {
        case 0:
        case 5450:
            answer = twb_reset(base);
            break;
        case 10:
        case 5460:
            answer = twb_arm(base);
            break;
        case 5400:
        case 5900:
            answer = twb_disarm(base);
            break;
        case 4500:
            if (cycle % 5u == 4u) {
                answer = twb_emergency_stop(base, cycle % 2u, &action);
                result->hash = mix(result->hash, &action, sizeof action);
            }
            break;
        case 5990:
            answer = twb_set_pose(base, &start);
            break;
        default:
            break;
        }
        if (answer == TWB_REFUSED) {
            result->refused++;
            answer = TWB_OK;
        }
        if (answer == TWB_OK) {
            answer = twb_tick(base, dt_us, &order, &sensed, &action);
        }
        if (answer == TWB_OK) {
            answer = twb_get_report(base, &report);
        }
        result->error = answer;
        result->hash = mix(result->hash, &action, sizeof action);
        result->hash = mix(result->hash, &report, sizeof report);
        result->states |= 1u << report.state;
        result->faults |= report.active_faults;
        result->parked += report.state == TWB_STATE_PARKED ? 1u : 0u;
        plant_advance(&plant, &action);
    }
}
