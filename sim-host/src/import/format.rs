//! The formats that are recognised.

use std::fmt;

/// A format that is recognised.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// WPILib trajectory JSON: an array of states, or since 2027 an object of `samples`.
    WpilibJson,
    /// Choreo `.traj`, schema 0 (2025 beta) to 3.
    ChoreoTraj,
    /// TUM poses: `t x y z qx qy qz qw`.
    TumPoses,
    /// CSV with a header of `t,x,y,theta[,v,w[,a,alpha]]`.
    Csv,
    /// PathWeaver `.path`; recognised, never driven.
    PathWeaver,
    /// PathPlanner `.path`; recognised, never driven.
    PathPlanner,
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::WpilibJson => "WPILib trajectory JSON",
            Self::ChoreoTraj => "Choreo trajectory",
            Self::TumPoses => "TUM poses",
            Self::Csv => "CSV",
            Self::PathWeaver => "PathWeaver path",
            Self::PathPlanner => "PathPlanner path",
        })
    }
}
