//! Single or double precision.

use serde::{Deserialize, Serialize};

/// The number type of the controller. The plant is always `f64`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Precision {
    /// Single, as on a chip.
    F32,
    /// Double.
    #[default]
    F64,
}
