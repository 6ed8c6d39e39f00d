// The class: a base arms, parks and says so; the plant is the wheels' torque on a mass that moves straight.
#include "robots.h"
#include "twb.hpp"

#include <cstdio>
#include <cstring>

static_assert(sizeof(twb::Base) == TWB_BASE_SIZE, "a base is nothing but its memory");

int main() {
    twb::Base base;
    twb_action action{};
    twb_report report{};
    if (base.arm() != twb::Error::not_initialised || base.init(lab_10kg) != twb::Error::ok) {
        return 1;
    }
    std::uint32_t period_us = 0;
    if (base.period_us(period_us) != twb::Error::ok || period_us != LAB_10KG_PERIOD_US) {
        return 2;
    }
    float speed = 0.0f, way = 0.0f;
    for (int tick = 0; tick < 1500; tick++) {
        const auto counted = static_cast<std::int32_t>(way / 0.075f * 325.9493f);
        auto sensed = twb::counts(counted, counted);
        sensed.flags = TWB_SENSED_FIX;
        sensed.fix = {way, 0.0f, 0.0f};
        if (tick == 10 && base.arm() != twb::Error::ok) {
            return 3;
        }
        const auto order = tick < 10 ? twb::none() : twb::park({1.0f, 0.0f, 0.0f});
        if (base.tick(period_us, order, sensed, action) != twb::Error::ok) {
            return 4;
        }
        speed += (action.torque.right + action.torque.left) / 0.075f / 10.0f * 0.01f;
        way += speed * 0.01f;
    }
    if (base.report(report) != twb::Error::ok) {
        return 5;
    }
    std::printf("%s at %.4f m; %s\n", twb_state_name(report.state), static_cast<double>(way), twb::text(twb::Error::ok));
    return report.state == TWB_STATE_PARKED && way > 0.99f && way < 1.01f ? 0 : 6;
}
