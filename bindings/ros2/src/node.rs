//! The node: topics and services with their qualities of service.

use crate::args::Args;
use crate::lifecycle::{
    ChangeState, Changed, CurrentState, Nothing, States, TransitionEvent, Transitions, Triggered,
};
use ros2_client::dds::rustdds::DomainParticipantBuilder;
use ros2_client::qos::{Durability, History, WhenFull};
use ros2_client::ros2::{CreateError, WriteError};
use ros2_client::{
    Context, Message, MessageTypeName, Name, Node, NodeName, NodeOptions, Publisher, QosProfile,
    Server, ServiceMapping, ServiceTypeName, Subscription,
};
use serde::Serialize;
use serde::de::DeserializeOwned;
use sim_host::ros::messages::{
    DiagnosticArray, JointState, Odometry, Path, Pose, Stamped, TfMessage, Twist,
};
use std::error::Error;
use std::net::Ipv4Addr;
use std::thread;

/// Reliable, volatile, the last `depth`: what Nav2 and ros2_control have on all of these topics. A full window refuses the
/// message at once: a subscriber that hangs must not keep the base from being heard.
fn keep_last(depth: usize) -> QosProfile {
    QosProfile::default()
        .reliability_reliable(WhenFull::Fail)
        .durability(Durability::Volatile)
        .history(History::KeepLast { depth })
}

/// Of the newest order only: an old velocity is none.
const ORDERS: usize = 1;
/// `rclcpp::SystemDefaultsQoS`.
const DEFAULT: usize = 10;
/// `tf2_ros::DynamicBroadcasterQoS`.
const TF: usize = 100;

/// Everything that it has in ROS.
pub struct Ros {
    pub cmd_vel: CmdVel,
    pub goal_pose: Subscription<Stamped<Pose>>,
    pub trajectory: Subscription<Path>,
    pub odom: Publisher<Odometry>,
    pub tf: Publisher<TfMessage>,
    pub joint_states: Publisher<JointState>,
    pub diagnostics: Publisher<DiagnosticArray>,
    pub transition_event: Publisher<TransitionEvent>,
    pub change_state: Server<ChangeState, Changed>,
    pub get_state: Server<Nothing, CurrentState>,
    pub get_available_states: Server<Nothing, States>,
    pub get_available_transitions: Server<Nothing, Transitions>,
    pub get_transition_graph: Server<Nothing, Transitions>,
    pub reset_fault: Server<Nothing, Triggered>,
    /// Last, as it is the first to be made.
    _node: Node,
}

/// Velocities, as the rest of the robot sends them.
pub enum CmdVel {
    Plain(Subscription<Twist>),
    Stamped(Subscription<Stamped<Twist>>),
}

impl CmdVel {
    /// The newest that has come.
    pub fn newest(&self) -> Option<Twist> {
        match self {
            Self::Plain(from) => newest(from),
            // Its stamp is of another machine's clock, maybe: it is as old as its coming.
            Self::Stamped(from) => newest(from).map(|stamped| stamped.value),
        }
    }
}

/// How requests and answers are distinguished on the wire; the two sides have to agree.
fn mapping() -> ServiceMapping {
    match std::env::var("RMW_IMPLEMENTATION").as_deref() {
        Ok("rmw_cyclonedds_cpp") => ServiceMapping::Cyclone,
        _ => ServiceMapping::Enhanced,
    }
}

/// Whether ROS is ordered to keep to this machine.
fn is_local() -> bool {
    let is = |name: &str, value: &str| std::env::var(name).is_ok_and(|found| found == value);
    is("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST") || is("ROS_LOCALHOST_ONLY", "1")
}

impl Ros {
    /// Joins a domain.
    ///
    /// # Errors
    /// No sockets, or a name that is none.
    pub fn new(args: &Args) -> Result<Self, Box<dyn Error>> {
        let mut participant = DomainParticipantBuilder::new(args.domain);
        if is_local() {
            participant = participant.with_only_networks([Ipv4Addr::LOCALHOST]);
        }
        let context = Context::from_domain_participant(participant.build()?)?;
        let name = NodeName::new(&args.namespace, &args.name)?;
        let options = NodeOptions::new()
            .enable_rosout(false)
            .start_parameter_services(false);
        let mut node = context.new_node(name, options)?;
        let spinner = node.spinner()?;
        thread::spawn(move || {
            if let Err(error) = futures::executor::block_on(spinner.spin()) {
                eprintln!("discovery ended: {error}");
            }
        });
        let in_space = |topic: &str| Name::new(&args.namespace, topic);
        let mut make = Make { node: &mut node };
        let (package, name) = ("geometry_msgs", in_space("cmd_vel")?);
        let cmd_vel = if args.stamped {
            CmdVel::Stamped(make.subscription(&name, (package, "TwistStamped"), ORDERS)?)
        } else {
            CmdVel::Plain(make.subscription(&name, (package, "Twist"), ORDERS)?)
        };
        let pose = ("geometry_msgs", "PoseStamped");
        let diagnostics = ("diagnostic_msgs", "DiagnosticArray");
        let event = ("lifecycle_msgs", "TransitionEvent");
        Ok(Self {
            cmd_vel,
            goal_pose: make.subscription(&in_space("goal_pose")?, pose, ORDERS)?,
            trajectory: make.subscription(
                &in_space("trajectory")?,
                ("nav_msgs", "Path"),
                ORDERS,
            )?,
            odom: make.publisher(&in_space("odom")?, ("nav_msgs", "Odometry"), DEFAULT)?,
            // These two are the whole machine's, whatever the namespace.
            tf: make.publisher(&Name::new("/", "tf")?, ("tf2_msgs", "TFMessage"), TF)?,
            diagnostics: make.publisher(&Name::new("/", "diagnostics")?, diagnostics, DEFAULT)?,
            joint_states: make.publisher(
                &in_space("joint_states")?,
                ("sensor_msgs", "JointState"),
                DEFAULT,
            )?,
            transition_event: make.publisher(
                &make.own(args, "transition_event")?,
                event,
                DEFAULT,
            )?,
            change_state: make.server(args, "change_state", ("lifecycle_msgs", "ChangeState"))?,
            get_state: make.server(args, "get_state", ("lifecycle_msgs", "GetState"))?,
            get_available_states: make.server(
                args,
                "get_available_states",
                ("lifecycle_msgs", "GetAvailableStates"),
            )?,
            get_available_transitions: make.server(
                args,
                "get_available_transitions",
                ("lifecycle_msgs", "GetAvailableTransitions"),
            )?,
            get_transition_graph: make.server(
                args,
                "get_transition_graph",
                ("lifecycle_msgs", "GetAvailableTransitions"),
            )?,
            reset_fault: make.server(args, "reset_fault", ("std_srvs", "Trigger"))?,
            _node: node,
        })
    }
}

/// A package and a type of it.
type Type = (&'static str, &'static str);

struct Make<'a> {
    node: &'a mut Node,
}

impl Make<'_> {
    /// A name below that of the node.
    fn own(&self, args: &Args, name: &str) -> Result<Name, Box<dyn Error>> {
        let space = format!("{}/{}", args.namespace.trim_end_matches('/'), args.name);
        Ok(Name::new(&space, name)?)
    }

    fn subscription<M: DeserializeOwned + 'static>(
        &mut self,
        name: &Name,
        (package, kind): Type,
        depth: usize,
    ) -> Result<Subscription<M>, CreateError> {
        let kind = MessageTypeName::new(package, kind);
        let topic = self.node.create_topic(name, kind, &keep_last(depth))?;
        self.node.create_subscription(&topic, None)
    }

    fn publisher<M: Serialize>(
        &mut self,
        name: &Name,
        (package, kind): Type,
        depth: usize,
    ) -> Result<Publisher<M>, CreateError> {
        let kind = MessageTypeName::new(package, kind);
        let topic = self.node.create_topic(name, kind, &keep_last(depth))?;
        self.node.create_publisher(&topic, None)
    }

    fn server<Req, Resp>(
        &mut self,
        args: &Args,
        name: &str,
        (package, kind): Type,
    ) -> Result<Server<Req, Resp>, Box<dyn Error>>
    where
        Req: Message + Clone + 'static,
        Resp: Message + Clone + 'static,
    {
        let kind = ServiceTypeName::new(package, kind);
        let (name, qos) = (self.own(args, name)?, keep_last(DEFAULT));
        let server = self
            .node
            .create_server(mapping(), &name, &kind, qos.clone(), qos)?;
        Ok(server)
    }
}

/// The newest message that has come.
pub fn newest<M: DeserializeOwned + 'static>(from: &Subscription<M>) -> Option<M> {
    std::iter::from_fn(|| next(from)).last()
}

/// The next message. What is not of its type is somebody else's mistake, and left out.
fn next<M: DeserializeOwned + 'static>(from: &Subscription<M>) -> Option<M> {
    loop {
        match from.take() {
            Ok(taken) => return taken.map(|(message, _)| message),
            Err(error) => eprintln!("a message that cannot be read: {error}"),
        }
    }
}

/// Sends a message, or counts it as lost.
pub fn publish<M: Serialize>(to: &Publisher<M>, message: M, lost: &mut u64) {
    match to.publish(message) {
        Ok(()) => {}
        Err(WriteError::WouldBlock { .. }) => *lost += 1,
        Err(error) => {
            *lost += 1;
            eprintln!("a message that cannot be sent: {error}");
        }
    }
}
