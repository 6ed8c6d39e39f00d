//! ROS 2: its [`messages`], and bags of them, [`read`].

pub mod messages;
pub mod read;
