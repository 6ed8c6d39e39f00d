// A base parks 1 m ahead. Pins and encoders are yours; the robot is `lab_10kg.h`, as `sim-host constants` writes it.
#include <twb.hpp>

#include "lab_10kg.h"

static twb::Base base;
static volatile int32_t right_counts, left_counts; // of your encoders' interrupts
static uint32_t last_us;

static void motor(int pwm, int direction, float duty) {
    digitalWrite(direction, duty < 0.0f ? HIGH : LOW);
    analogWrite(pwm, static_cast<int>((duty < 0.0f ? -duty : duty) * 255.0f));
}

void setup() {
    Serial.begin(115200);
    auto error = base.init(lab_10kg);
    if (error == twb::Error::ok) {
        error = base.arm();
    }
    Serial.println(twb::text(error));
    last_us = micros();
}

void loop() {
    const uint32_t now_us = micros();
    if (now_us - last_us < LAB_10KG_PERIOD_US) {
        return;
    }
    twb_action action{};
    const auto sensed = twb::counts(right_counts, left_counts);
    if (base.tick(now_us - last_us, twb::park({1.0f, 0.0f, 0.0f}), sensed, action) != twb::Error::ok) {
        action = {};
    }
    last_us = now_us;
    // Released where the action is not to drive; a bridge that can brake does so for TWB_ACTION_BRAKE.
    motor(5, 4, action.duty.right);
    motor(6, 7, action.duty.left);
}
