//! The blob that carries a robot to programs that are not written in Rust.

use controller_core::base::BaseParams;
use controller_core::gyro::GyroParams;
use controller_core::motor::{DriverParams, SpeedParams};
use firmware_demo::robots::{HOBBY_1KG, LAB_10KG, PAPER_30KG, RobotConstants};
use protocol::{
    CRC, MAX_ROBOT_BLOB, ROBOT_BLOB_VERSION, RobotBlobError, decode_robot, encode_robot,
};

const ROBOTS: [RobotConstants; 3] = [HOBBY_1KG, LAB_10KG, PAPER_30KG];

fn blob(params: &BaseParams<f32>) -> Vec<u8> {
    let mut bytes = [0; MAX_ROBOT_BLOB];
    encode_robot(params, &mut bytes)
        .expect("a blob has room")
        .to_vec()
}

#[test]
fn robots_come_back_with_the_same_bits() {
    for robot in ROBOTS {
        let bytes = blob(&robot.base);
        let back = decode_robot(&bytes).expect("a robot");
        // Bytes compare bits, numbers do not: -0 is 0.
        assert_eq!(blob(&back), bytes);
        assert_eq!(back, robot.base);
        assert!(bytes.len() < MAX_ROBOT_BLOB / 3 * 2, "{}", bytes.len());
    }
}

#[test]
fn every_wrong_bit_and_every_other_length_is_found() {
    let good = blob(&LAB_10KG.base);
    for bit in 0..8 * good.len() {
        let mut bad = good.clone();
        bad[bit / 8] ^= 1 << (bit % 8);
        let error = decode_robot(&bad).expect_err("a wrong bit");
        let expected = match bit / 8 {
            0..4 => RobotBlobError::Magic,
            6 | 7 => RobotBlobError::Length,
            _ => RobotBlobError::Check,
        };
        assert_eq!(error, expected, "bit {bit}");
    }
    for length in 0..good.len() {
        assert_eq!(decode_robot(&good[..length]), Err(RobotBlobError::Length));
    }
    let longer = [good.as_slice(), &[0]].concat();
    assert_eq!(decode_robot(&longer), Err(RobotBlobError::Length));
}

/// A blob of an old version must never be read as one of this: other fields, another version.
#[test]
fn other_fields_have_another_version() {
    let mut other = LAB_10KG.base;
    other.driver = DriverParams::Speeds(SpeedParams {
        max_speed_rad_s: 20.0,
        min_speed_rad_s: 0.0,
        lag_s: 0.02,
        breakaway_nm: 0.5,
    });
    other.localiser.gyro = Some(GyroParams::icm_42688_p());
    let bases = ROBOTS.iter().map(|robot| &robot.base).chain([&other]);
    let names: Vec<String> = bases
        .flat_map(|base| {
            let text = format!("{base:?}");
            let words = text.split(|c: char| !c.is_alphanumeric() && c != '_');
            let names = words.filter(|word| {
                word.starts_with(char::is_alphabetic) && !["inf", "NaN"].contains(word)
            });
            names.map(str::to_owned).collect::<Vec<_>>()
        })
        .collect();
    let fingerprint = CRC.checksum(names.join(" ").as_bytes());
    assert_eq!(
        (ROBOT_BLOB_VERSION, fingerprint),
        (6, 289_262_486),
        "fields of the parameters have changed: raise ROBOT_BLOB_VERSION, then state both here, and write \
         bindings/c/examples/lab_10kg.h anew"
    );
}
