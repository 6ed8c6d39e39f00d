//! ROS 2: its messages, and bags of them, [`read`].

pub(crate) mod messages;
pub mod read;
