"""Messages of ROS 2 as CycloneDDS has them: written from their definitions, not from the bridge's."""

from dataclasses import dataclass, field

from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import array, float64, int32, int64, sequence, uint8, uint32, uint64


def dds(package: str, kind: str, folder: str = "msg") -> str:
    return f"{package}::{folder}::dds_::{kind}_"


@dataclass
class Time(IdlStruct, typename=dds("builtin_interfaces", "Time")):
    sec: int32 = 0
    nanosec: uint32 = 0

    def seconds(self) -> float:
        return self.sec + 1e-9 * self.nanosec


@dataclass
class Header(IdlStruct, typename=dds("std_msgs", "Header")):
    stamp: Time = field(default_factory=Time)
    frame_id: str = ""


@dataclass
class Point(IdlStruct, typename=dds("geometry_msgs", "Point")):
    x: float64 = 0.0
    y: float64 = 0.0
    z: float64 = 0.0


@dataclass
class Vector3(IdlStruct, typename=dds("geometry_msgs", "Vector3")):
    x: float64 = 0.0
    y: float64 = 0.0
    z: float64 = 0.0


@dataclass
class Quaternion(IdlStruct, typename=dds("geometry_msgs", "Quaternion")):
    x: float64 = 0.0
    y: float64 = 0.0
    z: float64 = 0.0
    w: float64 = 1.0


@dataclass
class Pose(IdlStruct, typename=dds("geometry_msgs", "Pose")):
    position: Point = field(default_factory=Point)
    orientation: Quaternion = field(default_factory=Quaternion)


@dataclass
class PoseStamped(IdlStruct, typename=dds("geometry_msgs", "PoseStamped")):
    header: Header = field(default_factory=Header)
    pose: Pose = field(default_factory=Pose)


@dataclass
class Path(IdlStruct, typename=dds("nav_msgs", "Path")):
    header: Header
    poses: sequence[PoseStamped]


@dataclass
class Twist(IdlStruct, typename=dds("geometry_msgs", "Twist")):
    linear: Vector3 = field(default_factory=Vector3)
    angular: Vector3 = field(default_factory=Vector3)


@dataclass
class TwistStamped(IdlStruct, typename=dds("geometry_msgs", "TwistStamped")):
    header: Header
    twist: Twist


@dataclass
class PoseWithCovariance(IdlStruct, typename=dds("geometry_msgs", "PoseWithCovariance")):
    pose: Pose
    covariance: array[float64, 36]


@dataclass
class TwistWithCovariance(IdlStruct, typename=dds("geometry_msgs", "TwistWithCovariance")):
    twist: Twist
    covariance: array[float64, 36]


@dataclass
class Odometry(IdlStruct, typename=dds("nav_msgs", "Odometry")):
    header: Header
    child_frame_id: str
    pose: PoseWithCovariance
    twist: TwistWithCovariance


@dataclass
class Transform(IdlStruct, typename=dds("geometry_msgs", "Transform")):
    translation: Vector3
    rotation: Quaternion


@dataclass
class TransformStamped(IdlStruct, typename=dds("geometry_msgs", "TransformStamped")):
    header: Header
    child_frame_id: str
    transform: Transform


@dataclass
class TFMessage(IdlStruct, typename=dds("tf2_msgs", "TFMessage")):
    transforms: sequence[TransformStamped]


@dataclass
class JointState(IdlStruct, typename=dds("sensor_msgs", "JointState")):
    header: Header
    name: sequence[str]
    position: sequence[float64]
    velocity: sequence[float64]
    effort: sequence[float64]


@dataclass
class KeyValue(IdlStruct, typename=dds("diagnostic_msgs", "KeyValue")):
    key: str
    value: str


@dataclass
class DiagnosticStatus(IdlStruct, typename=dds("diagnostic_msgs", "DiagnosticStatus")):
    level: uint8
    name: str
    message: str
    hardware_id: str
    values: sequence[KeyValue]

    def of(self, key: str) -> str:
        return next(value.value for value in self.values if value.key == key)


@dataclass
class DiagnosticArray(IdlStruct, typename=dds("diagnostic_msgs", "DiagnosticArray")):
    header: Header
    status: sequence[DiagnosticStatus]


@dataclass
class State(IdlStruct, typename=dds("lifecycle_msgs", "State")):
    id: uint8 = 0
    label: str = ""


@dataclass
class Transition(IdlStruct, typename=dds("lifecycle_msgs", "Transition")):
    id: uint8 = 0
    label: str = ""


@dataclass
class TransitionDescription(IdlStruct, typename=dds("lifecycle_msgs", "TransitionDescription")):
    transition: Transition
    start_state: State
    goal_state: State


@dataclass
class TransitionEvent(IdlStruct, typename=dds("lifecycle_msgs", "TransitionEvent")):
    timestamp: uint64
    transition: Transition
    start_state: State
    goal_state: State


# Services, as `rmw_cyclonedds_cpp` has them: who asks, and the number of the question, before what is asked.


@dataclass
class ChangeStateRequest(IdlStruct, typename=dds("lifecycle_msgs", "ChangeState_Request", "srv")):
    guid: uint64
    number: int64
    transition: Transition


@dataclass
class ChangeStateResponse(IdlStruct, typename=dds("lifecycle_msgs", "ChangeState_Response", "srv")):
    guid: uint64
    number: int64
    success: bool


@dataclass
class GetStateRequest(IdlStruct, typename=dds("lifecycle_msgs", "GetState_Request", "srv")):
    guid: uint64
    number: int64
    structure_needs_at_least_one_member: uint8


@dataclass
class GetStateResponse(IdlStruct, typename=dds("lifecycle_msgs", "GetState_Response", "srv")):
    guid: uint64
    number: int64
    current_state: State


@dataclass
class GetAvailableTransitionsRequest(
    IdlStruct, typename=dds("lifecycle_msgs", "GetAvailableTransitions_Request", "srv")
):
    guid: uint64
    number: int64
    structure_needs_at_least_one_member: uint8


@dataclass
class GetAvailableTransitionsResponse(
    IdlStruct, typename=dds("lifecycle_msgs", "GetAvailableTransitions_Response", "srv")
):
    guid: uint64
    number: int64
    available_transitions: sequence[TransitionDescription]


@dataclass
class TriggerRequest(IdlStruct, typename=dds("std_srvs", "Trigger_Request", "srv")):
    guid: uint64
    number: int64
    structure_needs_at_least_one_member: uint8


@dataclass
class TriggerResponse(IdlStruct, typename=dds("std_srvs", "Trigger_Response", "srv")):
    guid: uint64
    number: int64
    success: bool
    message: str
