// A stand-in for hardware_interface of ros2_control, which no registry here has: the declarations that twb_ros2_control.hpp uses,
// by the names, types and meanings of version 6.8.0, and of what they need of rclcpp. Interfaces are plain numbers; there are no
// threads, limits, nodes or plugins. Not for any robot.
#ifndef STUB_SYSTEM_INTERFACE_HPP
#define STUB_SYSTEM_INTERFACE_HPP

#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <vector>

namespace rclcpp {
class Time {};
class Duration {
public:
    explicit Duration(std::int64_t nanoseconds) : nanoseconds_(nanoseconds) {}
    std::int64_t nanoseconds() const { return nanoseconds_; }

private:
    std::int64_t nanoseconds_;
};
} // namespace rclcpp

namespace rclcpp_lifecycle {
class State {};
namespace node_interfaces {
class LifecycleNodeInterface {
public:
    enum class CallbackReturn : std::uint8_t { SUCCESS = 97, FAILURE = 98, ERROR = 99 };
    virtual CallbackReturn on_configure(const State &) { return CallbackReturn::SUCCESS; }
    virtual CallbackReturn on_cleanup(const State &) { return CallbackReturn::SUCCESS; }
    virtual CallbackReturn on_shutdown(const State &) { return CallbackReturn::SUCCESS; }
    virtual CallbackReturn on_activate(const State &) { return CallbackReturn::SUCCESS; }
    virtual CallbackReturn on_deactivate(const State &) { return CallbackReturn::SUCCESS; }
    virtual CallbackReturn on_error(const State &) { return CallbackReturn::SUCCESS; }
    virtual ~LifecycleNodeInterface() = default;
};
} // namespace node_interfaces
} // namespace rclcpp_lifecycle

namespace hardware_interface {
using CallbackReturn = rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface::CallbackReturn;

enum class return_type : std::uint8_t { OK = 0, ERROR = 1, DEACTIVATE = 2 };

struct InterfaceInfo {
    std::string name;
};

struct ComponentInfo {
    std::string name;
    std::string type;
    std::vector<InterfaceInfo> command_interfaces;
    std::vector<InterfaceInfo> state_interfaces;
    std::unordered_map<std::string, std::string> parameters;
};

struct HardwareInfo {
    std::string name;
    std::unordered_map<std::string, std::string> hardware_parameters;
    std::vector<ComponentInfo> joints;
};

struct HardwareComponentInterfaceParams {
    HardwareInfo hardware_info;
};

class SystemInterface : public rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface {
public:
    SystemInterface() = default;
    SystemInterface(const SystemInterface &) = delete;

    virtual CallbackReturn on_init(const HardwareComponentInterfaceParams &params) {
        info_ = params.hardware_info;
        for (const auto &joint : info_.joints) {
            for (const auto &interface : joint.command_interfaces) {
                commands_[joint.name + "/" + interface.name] = std::numeric_limits<double>::quiet_NaN();
            }
            for (const auto &interface : joint.state_interfaces) {
                states_[joint.name + "/" + interface.name] = std::numeric_limits<double>::quiet_NaN();
            }
        }
        return CallbackReturn::SUCCESS;
    }
    virtual return_type read(const rclcpp::Time &time, const rclcpp::Duration &period) = 0;
    virtual return_type write(const rclcpp::Time &time, const rclcpp::Duration &period) = 0;

    template <typename T> void set_state(const std::string &name, const T &value) { find(states_, name) = value; }
    template <typename T = double> T get_state(const std::string &name) { return find(states_, name); }
    template <typename T> void set_command(const std::string &name, const T &value) { find(commands_, name) = value; }
    template <typename T = double> T get_command(const std::string &name) { return find(commands_, name); }

protected:
    HardwareInfo info_;

private:
    static double &find(std::unordered_map<std::string, double> &values, const std::string &name) {
        const auto found = values.find(name);
        if (found == values.end()) {
            throw std::runtime_error("no interface " + name);
        }
        return found->second;
    }

    std::unordered_map<std::string, double> commands_, states_;
};
} // namespace hardware_interface

#endif
