//! ROS 2: its [`messages`], and bags of them, [`read`].

mod container;
pub mod messages;
pub mod read;
