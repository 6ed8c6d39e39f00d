//! Programs in the READMEs of what is published, which run as tests.

/// Of `controller-core`.
#[doc = include_str!("../../controller-core/README.md")]
pub struct ControllerCore;

/// Of `protocol`.
#[doc = include_str!("../../protocol/README.md")]
pub struct Protocol;
