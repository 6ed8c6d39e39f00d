// A two-wheeled base for C++17: twb.h with a class, values for pointers, and errors that cannot be ignored.
#ifndef TWB_HPP
#define TWB_HPP

#include <cstddef>
#include <cstdint>

#include "twb.h"

namespace twb {

enum class Error : std::int32_t {
    ok = TWB_OK,
    null = TWB_NULL,
    misaligned = TWB_MISALIGNED,
    not_initialised = TWB_NOT_INITIALISED,
    busy = TWB_BUSY,
    mismatch = TWB_MISMATCH,
    robot_magic = TWB_ROBOT_MAGIC,
    robot_length = TWB_ROBOT_LENGTH,
    robot_check = TWB_ROBOT_CHECK,
    robot_version = TWB_ROBOT_VERSION,
    robot_content = TWB_ROBOT_CONTENT,
    not_finite = TWB_NOT_FINITE,
    bad_value = TWB_BAD_VALUE,
    refused = TWB_REFUSED,
};

inline const char *text(Error error) { return twb_status_text(static_cast<std::int32_t>(error)); }

// Orders.
inline twb_order none() { return {}; }
inline twb_order follow(const twb_pose &pose, const twb_twist &twist, const twb_twist &accel, float left = 0.0f) {
    return {TWB_ORDER_FOLLOW, 0, pose, twist, accel, left};
}
inline twb_order park(const twb_pose &goal) { return {TWB_ORDER_PARK, 0, goal, {}, {}, 0.0f}; }
inline twb_order velocity(const twb_twist &twist, bool hold_heading = false) {
    return {TWB_ORDER_VELOCITY, hold_heading ? 1u : 0u, {}, twist, {}, 0.0f};
}

// What both encoders counted, and nothing else.
inline twb_sensed counts(std::int32_t right, std::int32_t left) {
    twb_sensed sensed{};
    sensed.right = right;
    sensed.left = left;
    return sensed;
}

class Base {
public:
    template <std::size_t N>
    [[nodiscard]] Error init(const std::uint8_t (&robot)[N], const twb_pose &start = {}) {
        return init(robot, N, start);
    }
    [[nodiscard]] Error init(const std::uint8_t *robot, std::size_t length, const twb_pose &start = {}) {
        return of(twb_init(&base_, sizeof base_, TWB_API, robot, length, &start));
    }
    [[nodiscard]] Error arm() { return of(twb_arm(&base_)); }
    [[nodiscard]] Error disarm() { return of(twb_disarm(&base_)); }
    [[nodiscard]] Error reset() { return of(twb_reset(&base_)); }
    [[nodiscard]] Error emergency_stop(bool brake, twb_action &action) {
        return of(twb_emergency_stop(&base_, brake ? 1u : 0u, &action));
    }
    [[nodiscard]] Error tick(std::uint32_t dt_us, const twb_order &order, const twb_sensed &sensed, twb_action &action) {
        return of(twb_tick(&base_, dt_us, &order, &sensed, &action));
    }
    [[nodiscard]] Error note_exerted(const twb_wheels &torque) { return of(twb_note_exerted(&base_, &torque)); }
    [[nodiscard]] Error set_pose(const twb_pose &pose) { return of(twb_set_pose(&base_, &pose)); }
    [[nodiscard]] Error host_seen() { return of(twb_host_seen(&base_)); }
    [[nodiscard]] Error watch_host(std::uint32_t dt_us) { return of(twb_watch_host(&base_, dt_us)); }
    [[nodiscard]] Error period_us(std::uint32_t &out) const { return of(twb_period_us(&base_, &out)); }
    [[nodiscard]] Error report(twb_report &out) const { return of(twb_get_report(&base_, &out)); }

private:
    static Error of(std::int32_t status) { return static_cast<Error>(status); }
    // Zeros are no base: every call before init says so.
    twb_base base_{};
};

} // namespace twb

#endif
