// A two-wheeled base under ros2_control: wheel speeds ordered by its controllers become velocity orders of the base, whose limits,
// friction, odometry and safety stand between them and the motors.
//
//     class MyBase : public twb::BaseSystem {
//     public:
//         MyBase() : BaseSystem(TWB_ROS2_CONTROL_ROBOT(lab_10kg, LAB_10KG)) {}
//     protected:
//         bool sense(twb_sensed &sensed) override;        // counts; a pose, the supply, currents where there are
//         bool act(const twb_action &action) override;    // duties or torques to both wheels at once; or brake, or release
//     };
//     PLUGINLIB_EXPORT_CLASS(MyBase, hardware_interface::SystemInterface)
//
// For ros2_control of Jazzy and later, whose `on_init` takes HardwareComponentInterfaceParams.
#ifndef TWB_ROS2_CONTROL_HPP
#define TWB_ROS2_CONTROL_HPP

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "hardware_interface/system_interface.hpp"
#include "hardware_interface/types/hardware_interface_type_values.hpp"
#include "twb.hpp"

namespace twb {

// A robot and its wheels, as `sim-host constants FILE --c` writes them.
struct Robot {
    const std::uint8_t *bytes;
    std::size_t length;
    std::uint32_t period_us;
    double radius_right_m;
    double radius_left_m;
    double track_m;
    double counts_per_turn;
};

#define TWB_ROS2_CONTROL_ROBOT(bytes, NAME)                                                                                     \
    (twb::Robot{bytes, sizeof bytes, NAME##_PERIOD_US, NAME##_RADIUS_RIGHT_M, NAME##_RADIUS_LEFT_M, NAME##_TRACK_M,             \
                NAME##_COUNTS_PER_TURN})

// Two joints, each with the command interface `velocity` and the state interfaces `position` and `velocity`. Their names are
// `right_wheel_joint` and `left_wheel_joint`, unless the parameters `right_joint` and `left_joint` of the hardware say others.
class BaseSystem : public hardware_interface::SystemInterface {
public:
    using CallbackReturn = hardware_interface::CallbackReturn;
    using return_type = hardware_interface::return_type;

    explicit BaseSystem(const Robot &robot) : robot_(robot) {}

    CallbackReturn on_init(const hardware_interface::HardwareComponentInterfaceParams &params) override {
        if (SystemInterface::on_init(params) != CallbackReturn::SUCCESS) {
            return CallbackReturn::ERROR;
        }
        const auto named = [this](const char *key, const char *otherwise) {
            const auto found = info_.hardware_parameters.find(key);
            return found == info_.hardware_parameters.end() ? std::string(otherwise) : found->second;
        };
        right_ = Joint(named("right_joint", "right_wheel_joint"));
        left_ = Joint(named("left_joint", "left_wheel_joint"));
        const bool known = info_.joints.size() == 2 && right_.is_whole(info_) && left_.is_whole(info_);
        return known ? CallbackReturn::SUCCESS : CallbackReturn::ERROR;
    }

    CallbackReturn on_configure(const rclcpp_lifecycle::State &) override {
        sensed_ = {};
        if (!open() || !sense(sensed_)) {
            return CallbackReturn::ERROR;
        }
        if (base_.init(robot_.bytes, robot_.length) != Error::ok) {
            close();
            return CallbackReturn::ERROR;
        }
        right_.start(sensed_.right);
        left_.start(sensed_.left);
        show({});
        return CallbackReturn::SUCCESS;
    }

    CallbackReturn on_cleanup(const rclcpp_lifecycle::State &) override {
        close();
        return CallbackReturn::SUCCESS;
    }

    // A base in a fault is reset by this: activating it is an operator's decision.
    CallbackReturn on_activate(const rclcpp_lifecycle::State &) override {
        twb_report report{};
        if (base_.report(report) != Error::ok) {
            return CallbackReturn::ERROR;
        }
        if (report.state == TWB_STATE_FAULT && base_.reset() != Error::ok) {
            return CallbackReturn::ERROR;
        }
        set_command(right_.velocity, 0.0);
        set_command(left_.velocity, 0.0);
        // Refused while it still comes to rest.
        if (base_.arm() != Error::ok) {
            return CallbackReturn::FAILURE;
        }
        active_ = true;
        return CallbackReturn::SUCCESS;
    }

    // A controlled stop, which the ticks of `read` carry out: `write` is not called any more.
    CallbackReturn on_deactivate(const rclcpp_lifecycle::State &) override {
        active_ = false;
        return base_.disarm() == Error::ok ? CallbackReturn::SUCCESS : CallbackReturn::ERROR;
    }

    CallbackReturn on_shutdown(const rclcpp_lifecycle::State &) override { return release(); }
    CallbackReturn on_error(const rclcpp_lifecycle::State &) override { return release(); }

    // A sensor that does not answer is no error here but a fault of the base, which has its time limits for it.
    return_type read(const rclcpp::Time &, const rclcpp::Duration &period) override {
        sensed_.flags = 0;
        sensed_.encoders = TWB_DEVICE_OK;
        if (sense(sensed_)) {
            if (sensed_.encoders == TWB_DEVICE_OK) {
                right_.count(sensed_.right);
                left_.count(sensed_.left);
            }
        } else {
            sensed_.flags = 0;
            sensed_.encoders = TWB_DEVICE_BUS;
        }
        return active_ ? show() : tick(period, none());
    }

    // An error when the base has stopped by a fault: the controller manager then takes it out of service.
    return_type write(const rclcpp::Time &, const rclcpp::Duration &period) override {
        // Some managers call it for inactive hardware as well, whose ticks are those of `read`.
        if (!active_) {
            return return_type::OK;
        }
        // Commands that nobody has given are NaN: no speed.
        const auto speed = [](double command) { return std::isfinite(command) ? command : 0.0; };
        const double right = robot_.radius_right_m * speed(get_command(right_.velocity));
        const double left = robot_.radius_left_m * speed(get_command(left_.velocity));
        const auto result = tick(period, velocity({static_cast<float>(0.5 * (right + left)),
                                                    static_cast<float>((right - left) / robot_.track_m)}));
        return result == return_type::OK && has_stopped() ? return_type::ERROR : result;
    }

protected:
    // The way to the hardware.
    virtual bool open() { return true; }
    virtual void close() {}
    // What was measured since the last call; whether the encoders answered. `sensed` has the counts of the last call.
    virtual bool sense(twb_sensed &sensed) = 0;
    // Both wheels at once; whether the driver took it.
    virtual bool act(const twb_action &action) = 0;

    const Base &base() const { return base_; }

private:
    struct Joint {
        Joint() = default;
        explicit Joint(const std::string &name)
            : position(name + "/" + hardware_interface::HW_IF_POSITION), velocity(name + "/" + hardware_interface::HW_IF_VELOCITY),
              name(name) {}

        bool is_whole(const hardware_interface::HardwareInfo &info) const {
            const auto has = [](const std::vector<hardware_interface::InterfaceInfo> &interfaces, const char *name) {
                return std::any_of(interfaces.begin(), interfaces.end(),
                                   [name](const hardware_interface::InterfaceInfo &found) { return found.name == name; });
            };
            return std::any_of(info.joints.begin(), info.joints.end(), [&](const hardware_interface::ComponentInfo &joint) {
                return joint.name == name && joint.command_interfaces.size() == 1 &&
                       has(joint.command_interfaces, hardware_interface::HW_IF_VELOCITY) &&
                       has(joint.state_interfaces, hardware_interface::HW_IF_POSITION) &&
                       has(joint.state_interfaces, hardware_interface::HW_IF_VELOCITY);
            });
        }

        void start(std::int32_t counts) {
            last = counts;
            sum = 0;
        }

        // Counters wrap around.
        void count(std::int32_t counts) {
            sum += static_cast<std::int32_t>(static_cast<std::uint32_t>(counts) - static_cast<std::uint32_t>(last));
            last = counts;
        }

        std::string position, velocity, name;
        std::int32_t last = 0;
        std::int64_t sum = 0;
    };

    return_type tick(const rclcpp::Duration &period, const twb_order &order) {
        // The first cycle of a controller manager may have none.
        const auto us = period.nanoseconds() / 1000;
        const auto dt_us = us > 0 && us <= 1'000'000'000 ? static_cast<std::uint32_t>(us) : robot_.period_us;
        twb_action action{};
        if (base_.tick(dt_us, order, sensed_, action) != Error::ok) {
            return return_type::ERROR;
        }
        sensed_.driver = act(action) ? TWB_DEVICE_OK : TWB_DEVICE_BUS;
        return show();
    }

    // Speeds are the base's of its last tick.
    return_type show() {
        twb_report report{};
        if (base_.report(report) != Error::ok) {
            return return_type::ERROR;
        }
        show(report.twist);
        return return_type::OK;
    }

    void show(const twb_twist &twist) {
        const double turn = 2.0 * 3.14159265358979323846 / robot_.counts_per_turn;
        const double across = 0.5 * robot_.track_m * static_cast<double>(twist.w), along = static_cast<double>(twist.v);
        set_state(right_.position, turn * static_cast<double>(right_.sum));
        set_state(left_.position, turn * static_cast<double>(left_.sum));
        set_state(right_.velocity, (along + across) / robot_.radius_right_m);
        set_state(left_.velocity, (along - across) / robot_.radius_left_m);
    }

    bool has_stopped() const {
        twb_report report{};
        return base_.report(report) != Error::ok || report.state == TWB_STATE_STOPPED || report.state == TWB_STATE_FAULT;
    }

    CallbackReturn release() {
        active_ = false;
        twb_action action{};
        const bool stopped = base_.emergency_stop(false, action) == Error::ok && act(action);
        close();
        return stopped ? CallbackReturn::SUCCESS : CallbackReturn::ERROR;
    }

    Robot robot_;
    Base base_;
    twb_sensed sensed_{};
    Joint right_, left_;
    bool active_ = false;
};

} // namespace twb

#endif
