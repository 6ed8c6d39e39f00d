//! A robot for the C interface: the blob of `protocol::encode_robot` as a header.

use std::fmt::Write as _;

use protocol::{MAX_ROBOT_BLOB, ROBOT_BLOB_VERSION, encode_robot};

use super::{ConstantsError, module_name, period_us};
use crate::closed_loop;
use crate::mission::BaseSpec;

/// Bytes in a line of 120 columns.
const A_LINE: usize = 19;

/// The header: `NAME_period_us` and the bytes `NAME`, for `twb_init`. `source` is the name of the robot's file, `name` as
/// [`module_name`] makes it.
///
/// # Errors
/// Parameters that the core refuses.
pub fn c_header(source: &str, name: &str, base: &BaseSpec) -> Result<String, ConstantsError> {
    let name = module_name(name);
    let period_us = period_us(base);
    let params = closed_loop::params(base, period_us)?;
    let mut bytes = [0; MAX_ROBOT_BLOB];
    let blob = encode_robot(&params, &mut bytes).ok_or(ConstantsError::TooLong)?;
    let guard = name.to_ascii_uppercase();
    // It goes into a comment, which nothing in it may end or begin anew.
    let plain = |text: &str| {
        text.replace(['\n', '\r'], " ")
            .replace("*/", "* /")
            .replace("/*", "/ *")
    };
    let wheels = &params.localiser.odometry.wheels;
    let mut text = format!(
        "\
/* Robot for twb_init: {}
 *
 * Made by `sim-host constants --c` from `{}`: change that file, not this one. Version {ROBOT_BLOB_VERSION}.
 */
#ifndef {guard}_H
#define {guard}_H

#include <stdint.h>

/* Time between ticks, in us. */
#define {guard}_PERIOD_US {period_us}u

/* Wheels, for programs that have speeds of wheels to convert: m, and counts of a whole turn. */
#define {guard}_RADIUS_RIGHT_M {:?}f
#define {guard}_RADIUS_LEFT_M {:?}f
#define {guard}_TRACK_M {:?}f
#define {guard}_COUNTS_PER_TURN {:?}f

static const uint8_t {name}[{}] = {{
",
        plain(&base.name),
        plain(source),
        wheels.radius_right_m,
        wheels.radius_left_m,
        wheels.track_m,
        params.localiser.odometry.counts_per_turn,
        blob.len()
    );
    for line in blob.chunks(A_LINE) {
        let mut bytes = String::new();
        for byte in line {
            // Writing to a string does not fail.
            let _ = write!(bytes, " 0x{byte:02X},");
        }
        text.push_str("   ");
        text.push_str(&bytes);
        text.push('\n');
    }
    text.push_str("};\n\n#endif\n");
    Ok(text)
}
