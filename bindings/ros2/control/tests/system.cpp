// BaseSystem as a controller manager calls it, on wheels that push a mass. Exit code 0, or the number of the line that failed.
#include "robots.h"
#include "twb_ros2_control.hpp"

#include <cmath>
#include <cstdio>

namespace {

constexpr double MASS = 10.0, INERTIA = 0.3, RADIUS = 0.075, TRACK = 0.35, COUNTS = 2048.0, TAU = 6.283185307179586, DT = 0.01;

#define REQUIRE(what)                                                                                                           \
    do {                                                                                                                        \
        if (!(what)) {                                                                                                          \
            std::printf("line %d: %s\n", __LINE__, #what);                                                                      \
            return __LINE__ % 256 == 0 ? 255 : __LINE__ % 256;                                                                  \
        }                                                                                                                       \
    } while (false)

// Torques of the action move it without friction; braked it comes to rest within tenths of a second, released it rolls on. Counters begin anywhere, here where they wrap around.
class Simulated : public twb::BaseSystem {
public:
    Simulated() : BaseSystem(TWB_ROS2_CONTROL_ROBOT(lab_10kg, LAB_10KG)) {}

    double v = 0, w = 0, x = 0, y = 0, theta = 0, right = 0, left = 0;
    bool encoders = true, driver = true;
    twb_action last{};

    std::uint32_t state() const {
        twb_report report{};
        return base().report(report) == twb::Error::ok ? report.state : 99u;
    }

protected:
    bool sense(twb_sensed &sensed) override {
        const auto counted = [](double angle) {
            return static_cast<std::int32_t>(static_cast<std::uint32_t>(2147483600u + static_cast<std::int64_t>(std::floor(angle / TAU * COUNTS))));
        };
        sensed.right = counted(right);
        sensed.left = counted(left);
        sensed.flags = TWB_SENSED_FIX;
        sensed.fix = {static_cast<float>(x), static_cast<float>(y), static_cast<float>(theta)};
        sensed.fix_age_s = 0.0f;
        return encoders;
    }

    bool act(const twb_action &action) override {
        last = action;
        if (!driver) {
            return false;
        }
        const bool drives = action.kind == TWB_ACTION_DRIVE;
        const double r = drives ? static_cast<double>(action.torque.right) : 0.0;
        const double l = drives ? static_cast<double>(action.torque.left) : 0.0;
        if (action.kind == TWB_ACTION_BRAKE) {
            v -= DT * v / 0.1;
            w -= DT * w / 0.1;
        }
        v += DT * (r + l) / RADIUS / MASS;
        w += DT * (r - l) / RADIUS * TRACK / 2 / INERTIA;
        x += DT * v * std::cos(theta);
        y += DT * v * std::sin(theta);
        theta += DT * w;
        right += DT * (v + w * TRACK / 2) / RADIUS;
        left += DT * (v - w * TRACK / 2) / RADIUS;
        return true;
    }
};

using hardware_interface::CallbackReturn;
using hardware_interface::return_type;

hardware_interface::HardwareComponentInterfaceParams urdf(const char *right, const char *left, const char *command) {
    const auto joint = [command](const char *name) {
        hardware_interface::ComponentInfo info;
        info.name = name;
        info.command_interfaces.resize(1);
        info.command_interfaces[0].name = command;
        info.state_interfaces.resize(2);
        info.state_interfaces[0].name = "position";
        info.state_interfaces[1].name = "velocity";
        return info;
    };
    hardware_interface::HardwareComponentInterfaceParams params;
    params.hardware_info.joints = {joint(right), joint(left)};
    return params;
}

const rclcpp_lifecycle::State ANY{};
const rclcpp::Duration PERIOD(10'000'000);

// What a controller manager does in a cycle: `write` of active hardware only.
return_type cycle(Simulated &system, bool active) {
    const auto result = system.read({}, PERIOD);
    return result == return_type::OK && active ? system.write({}, PERIOD) : result;
}

// At these wheel speeds for so long; whether no cycle failed.
bool drive(Simulated &system, double right, double left, double seconds) {
    for (int n = 0; n < static_cast<int>(seconds / DT); n++) {
        system.set_command("right_wheel_joint/velocity", right);
        system.set_command("left_wheel_joint/velocity", left);
        if (cycle(system, true) != return_type::OK) {
            return false;
        }
    }
    return true;
}

bool near(double a, double b, double within) { return std::fabs(a - b) <= within; }

int refusals() {
    Simulated effort, names;
    REQUIRE(effort.on_init(urdf("right_wheel_joint", "left_wheel_joint", "effort")) == CallbackReturn::ERROR);
    REQUIRE(names.on_init(urdf("a", "b", "velocity")) == CallbackReturn::ERROR);
    auto named = urdf("a", "b", "velocity");
    named.hardware_info.hardware_parameters = {{"right_joint", "a"}, {"left_joint", "b"}};
    Simulated other, dead;
    REQUIRE(other.on_init(named) == CallbackReturn::SUCCESS);
    REQUIRE(dead.on_init(urdf("right_wheel_joint", "left_wheel_joint", "velocity")) == CallbackReturn::SUCCESS);
    dead.encoders = false;
    REQUIRE(dead.on_configure(ANY) == CallbackReturn::ERROR);
    return 0;
}

int drives() {
    Simulated system;
    REQUIRE(system.on_init(urdf("right_wheel_joint", "left_wheel_joint", "velocity")) == CallbackReturn::SUCCESS);
    REQUIRE(system.on_configure(ANY) == CallbackReturn::SUCCESS);
    REQUIRE(system.get_state("right_wheel_joint/position") == 0.0 && system.get_state("left_wheel_joint/velocity") == 0.0);
    // Inactive: it watches, and moves nothing.
    for (int n = 0; n < 20; n++) {
        REQUIRE(cycle(system, false) == return_type::OK && system.last.kind == TWB_ACTION_RELEASE);
    }
    REQUIRE(system.on_activate(ANY) == CallbackReturn::SUCCESS);
    // 4 rad/s: 0.3 m/s. A servo without steady error, after three seconds.
    REQUIRE(drive(system, 4.0, 4.0, 3.0));
    REQUIRE(near(system.v, 0.3, 0.003) && near(system.get_state("right_wheel_joint/velocity"), 4.0, 0.04));
    // Counters have wrapped around on the way; states are of the beginning of the cycle.
    REQUIRE(near(system.get_state("right_wheel_joint/position"), system.right, 4.0 * DT + TAU / COUNTS));
    REQUIRE(system.right > 10.0);
    REQUIRE(drive(system, 2.0, -2.0, 3.0));
    REQUIRE(near(system.w, 2 * 2.0 * RADIUS / TRACK, 0.02) && near(system.v, 0.0, 0.005));
    REQUIRE(near(system.get_state("left_wheel_joint/velocity"), -2.0, 0.05));
    // Limits are the base's, whatever is asked: 1.2 m/s and 1 m/s^2.
    const double before = system.v;
    REQUIRE(drive(system, 100.0, 100.0, 0.5));
    REQUIRE(system.v - before < 0.52);
    REQUIRE(drive(system, 100.0, 100.0, 3.0));
    REQUIRE(near(system.v, 1.2, 0.02));
    // Commands that nobody has given: to rest within the limits, and ready to go on.
    REQUIRE(drive(system, NAN, NAN, 0.2) && system.v > 0.8);
    REQUIRE(drive(system, NAN, NAN, 3.0) && near(system.v, 0.0, 0.002));
    REQUIRE(drive(system, 4.0, 4.0, 2.0) && near(system.v, 0.3, 0.01));
    // Deactivated on the way: a controlled stop by the ticks of `read`, then released.
    REQUIRE(system.on_deactivate(ANY) == CallbackReturn::SUCCESS);
    REQUIRE(cycle(system, false) == return_type::OK && system.last.kind == TWB_ACTION_DRIVE && system.v > 0.25);
    REQUIRE(system.on_activate(ANY) == CallbackReturn::FAILURE);
    for (int n = 0; n < 150; n++) {
        REQUIRE(cycle(system, false) == return_type::OK);
        // As older managers do: without effect.
        REQUIRE(system.write({}, PERIOD) == return_type::OK);
    }
    REQUIRE(near(system.v, 0.0, 0.005) && system.last.kind == TWB_ACTION_RELEASE && system.state() == TWB_STATE_STOPPED);
    REQUIRE(system.on_activate(ANY) == CallbackReturn::SUCCESS && drive(system, 4.0, 4.0, 1.0) && system.v > 0.2);
    // An error elsewhere: released at once.
    REQUIRE(system.on_error(ANY) == CallbackReturn::SUCCESS && system.last.kind == TWB_ACTION_RELEASE);
    return 0;
}

int faults(bool of_encoders) {
    Simulated system;
    REQUIRE(system.on_init(urdf("right_wheel_joint", "left_wheel_joint", "velocity")) == CallbackReturn::SUCCESS);
    REQUIRE(system.on_configure(ANY) == CallbackReturn::SUCCESS && system.on_activate(ANY) == CallbackReturn::SUCCESS);
    REQUIRE(drive(system, 4.0, 4.0, 2.0));
    (of_encoders ? system.encoders : system.driver) = false;
    // No torque from the next tick on; without encoders from when they have been missing for five. It says so when it stands, or
    // when it should: without encoders it cannot see that it does.
    (void)drive(system, 4.0, 4.0, of_encoders ? 0.06 : 0.02);
    REQUIRE(system.last.kind != TWB_ACTION_DRIVE);
    REQUIRE(!drive(system, 4.0, 4.0, 10.0) && system.state() == TWB_STATE_FAULT);
    REQUIRE(system.last.kind == (of_encoders ? TWB_ACTION_BRAKE : TWB_ACTION_RELEASE));
    REQUIRE(!of_encoders || near(system.v, 0.0, 0.002));
    system.encoders = system.driver = true;
    REQUIRE(system.on_error(ANY) == CallbackReturn::SUCCESS);
    // An operator begins anew.
    system.v = system.w = 0;
    REQUIRE(system.on_configure(ANY) == CallbackReturn::SUCCESS && system.on_activate(ANY) == CallbackReturn::SUCCESS);
    REQUIRE(drive(system, 4.0, 4.0, 2.0) && near(system.v, 0.3, 0.01));
    return 0;
}

} // namespace

int main() {
    for (const int failed : {refusals(), drives(), faults(true), faults(false)}) {
        if (failed != 0) {
            return failed;
        }
    }
    std::printf("a base under ros2_control drives, stops and says why not\n");
    return 0;
}
