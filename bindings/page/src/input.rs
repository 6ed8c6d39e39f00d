//! What somebody does on the page, as bytes. Lengths are whole millimetres, angles tenths of milliradians, so that what is
//! written into a link is what has been done.

use controller_core::types::Pose;
use sim_host::world::{PlantFault, Side};

/// Something that changes a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Input {
    /// Everything anew.
    Begin(Setting),
    /// Everything anew with the robot of this file.
    Robot {
        /// As for a robot of the list.
        setting: Setting,
        /// The file's name.
        name: String,
        /// TOML.
        text: String,
    },
    /// Which of the paper's laws drive beside the default one: bit 0 with neurons, bit 1 without.
    Laws(u8),
    /// The robot is to park here.
    Goal(At),
    /// The robot is put here; whether the base is informed.
    Place(At, bool),
    /// The robot is to follow this line and to park at its end: points \[mm\].
    Line(Vec<[i16; 2]>),
    /// The robot is to follow this trajectory file, from its start.
    File {
        /// Its name.
        name: String,
        /// Whatever it is.
        bytes: Vec<u8>,
    },
    /// The robot is to drive with this speed \[mm/s\] and turn rate \[mrad/s\].
    Drive {
        /// Forward.
        speed: i16,
        /// Counter-clockwise.
        turn_rate: i16,
    },
    /// A stop within the limits.
    Stop,
    /// The button.
    EmergencyStop,
    /// Out of whatever it stopped for, and ready to drive.
    Arm,
    /// A push at the centre of mass.
    Push {
        /// In the world's x and y \[0.1 N\].
        force: [i16; 2],
        /// \[0.01 N m\].
        moment: i16,
        /// \[ms\].
        duration: u16,
    },
    /// Another grip within a rectangle: from and to in x, from and to in y \[mm\], grip \[1/100\].
    Ice([i16; 4], u8),
    /// No such rectangle any more.
    Thaw,
    /// The fault with this index in [`FAULTS`], put in or taken out.
    Fault(u8, bool),
    /// Whether the host lives.
    Host(bool),
}

/// What a run begins with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setting {
    /// Index in the built-in bases; not looked at where the robot is a file's.
    pub base: u8,
    /// With the gyro of the parts list.
    pub gyro: bool,
    /// The world around it.
    pub floor: Floor,
    /// Of all noise.
    pub seed: u16,
}

/// How kind the world is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Floor {
    /// As the file has it, but external poses are a motion capture's.
    Fine,
    /// Motors, battery, encoders and external poses as the robot's file has them.
    #[default]
    File,
    /// And a bad floor for it, drawn by the seed.
    Bad,
}

/// A pose: x, y \[mm\], heading \[0.1 mrad\].
pub type At = [i16; 3];

/// Faults to put in, and their names for people.
pub const FAULTS: [(PlantFault, &str); 12] = [
    (PlantFault::EncoderStuck(Side::Left), "left encoder dead"),
    (PlantFault::EncoderStuck(Side::Right), "right encoder dead"),
    (
        PlantFault::EncoderReversed(Side::Left),
        "left encoder reversed",
    ),
    (PlantFault::EncoderFails, "encoders unreadable"),
    (PlantFault::WheelBlocked(Side::Left), "left wheel blocked"),
    (PlantFault::WheelBlocked(Side::Right), "right wheel blocked"),
    (
        PlantFault::WheelOnIce {
            side: Side::Left,
            mu: 0.03,
        },
        "left wheel on ice",
    ),
    (PlantFault::PoseSilent, "no external poses"),
    (
        PlantFault::PoseJump {
            dx: 0.3,
            dy: 0.2,
            dtheta: 0.0,
        },
        "external poses off by 0.36 m",
    ),
    (PlantFault::DriveFails { coast: true }, "driver dead"),
    (PlantFault::BatterySag { volts: 4.0 }, "battery at 4 V"),
    (PlantFault::GyroBias { rad_s: 0.3 }, "gyro off by 0.3 rad/s"),
];

/// A pose in metres and radians.
pub fn pose([x, y, theta]: At) -> Pose<f64> {
    Pose::new(
        1.0e-3 * f64::from(x),
        1.0e-3 * f64::from(y),
        1.0e-4 * f64::from(theta),
    )
}

/// The largest text or file that fits in a link or a call.
pub const MAX_FILE: usize = 1 << 20;

impl Input {
    /// Appends its bytes.
    pub fn encode(&self, out: &mut Vec<u8>) {
        match self {
            Self::Begin(setting) => {
                out.push(0);
                setting.encode(out);
            }
            Self::Robot {
                setting,
                name,
                text,
            } => {
                out.push(1);
                setting.encode(out);
                block(out, name.as_bytes());
                block(out, text.as_bytes());
            }
            Self::Laws(mask) => out.extend([2, *mask]),
            Self::Goal(at) => {
                out.push(3);
                words(out, at);
            }
            Self::Place(at, announced) => {
                out.extend([4, u8::from(*announced)]);
                words(out, at);
            }
            Self::Line(points) => {
                out.push(5);
                let count = u16::try_from(points.len()).unwrap_or(u16::MAX);
                out.extend(count.to_le_bytes());
                for point in points.iter().take(count.into()) {
                    words(out, point);
                }
            }
            Self::File { name, bytes } => {
                out.push(6);
                block(out, name.as_bytes());
                block(out, bytes);
            }
            Self::Drive { speed, turn_rate } => {
                out.push(7);
                words(out, &[*speed, *turn_rate]);
            }
            Self::Stop => out.push(8),
            Self::EmergencyStop => out.push(9),
            Self::Arm => out.push(10),
            Self::Push {
                force: [x, y],
                moment,
                duration,
            } => {
                out.push(11);
                words(out, &[*x, *y, *moment]);
                out.extend(duration.to_le_bytes());
            }
            Self::Ice(edges, grip) => {
                out.extend([12, *grip]);
                words(out, edges);
            }
            Self::Thaw => out.push(13),
            Self::Fault(index, there) => out.extend([14, *index, u8::from(*there)]),
            Self::Host(alive) => out.extend([15, u8::from(*alive)]),
        }
    }

    /// Takes one off the front of `bytes`; none if they begin with none.
    pub fn decode(bytes: &mut &[u8]) -> Option<Self> {
        Some(match byte(bytes)? {
            0 => Self::Begin(Setting::decode(bytes)?),
            1 => Self::Robot {
                setting: Setting::decode(bytes)?,
                name: text(bytes)?,
                text: text(bytes)?,
            },
            2 => Self::Laws(byte(bytes)?),
            3 => Self::Goal(words_of(bytes)?),
            4 => {
                let announced = flag(bytes)?;
                Self::Place(words_of(bytes)?, announced)
            }
            5 => {
                let count = u16::from_le_bytes(take(bytes)?);
                let points = (0..count).map(|_| words_of(bytes));
                Self::Line(points.collect::<Option<_>>()?)
            }
            6 => Self::File {
                name: text(bytes)?,
                bytes: block_of(bytes)?.to_vec(),
            },
            7 => {
                let [speed, turn_rate] = words_of(bytes)?;
                Self::Drive { speed, turn_rate }
            }
            8 => Self::Stop,
            9 => Self::EmergencyStop,
            10 => Self::Arm,
            11 => {
                let [x, y, moment] = words_of(bytes)?;
                Self::Push {
                    force: [x, y],
                    moment,
                    duration: u16::from_le_bytes(take(bytes)?),
                }
            }
            12 => {
                let grip = byte(bytes)?;
                Self::Ice(words_of(bytes)?, grip)
            }
            13 => Self::Thaw,
            14 => Self::Fault(byte(bytes)?, flag(bytes)?),
            15 => Self::Host(flag(bytes)?),
            _ => return None,
        })
    }
}

impl Setting {
    fn encode(&self, out: &mut Vec<u8>) {
        out.extend([self.base, u8::from(self.gyro), self.floor as u8]);
        out.extend(self.seed.to_le_bytes());
    }

    fn decode(bytes: &mut &[u8]) -> Option<Self> {
        Some(Self {
            base: byte(bytes)?,
            gyro: flag(bytes)?,
            floor: match byte(bytes)? {
                0 => Floor::Fine,
                1 => Floor::File,
                2 => Floor::Bad,
                _ => return None,
            },
            seed: u16::from_le_bytes(take(bytes)?),
        })
    }
}

fn words(out: &mut Vec<u8>, words: &[i16]) {
    out.extend(words.iter().flat_map(|word| word.to_le_bytes()));
}

fn block(out: &mut Vec<u8>, bytes: &[u8]) {
    let length = u32::try_from(bytes.len()).unwrap_or(u32::MAX);
    out.extend(length.to_le_bytes());
    out.extend(bytes);
}

fn take<const N: usize>(bytes: &mut &[u8]) -> Option<[u8; N]> {
    let (first, rest) = bytes.split_first_chunk()?;
    *bytes = rest;
    Some(*first)
}

fn byte(bytes: &mut &[u8]) -> Option<u8> {
    take::<1>(bytes).map(|[byte]| byte)
}

fn flag(bytes: &mut &[u8]) -> Option<bool> {
    byte(bytes).map(|byte| byte != 0)
}

fn words_of<const N: usize>(bytes: &mut &[u8]) -> Option<[i16; N]> {
    let mut words = [0; N];
    for word in &mut words {
        *word = i16::from_le_bytes(take(bytes)?);
    }
    Some(words)
}

fn block_of<'a>(bytes: &mut &'a [u8]) -> Option<&'a [u8]> {
    let length = u32::from_le_bytes(take(bytes)?) as usize;
    if length > MAX_FILE {
        return None;
    }
    let (block, rest) = bytes.split_at_checked(length)?;
    *bytes = rest;
    Some(block)
}

fn text(bytes: &mut &[u8]) -> Option<String> {
    String::from_utf8(block_of(bytes)?.to_vec()).ok()
}

/// A number in as few bytes as it needs, seven bits each, the lowest first.
pub fn count(out: &mut Vec<u8>, mut value: u32) {
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

/// Takes one off the front.
pub fn count_of(bytes: &mut &[u8]) -> Option<u32> {
    let mut value = 0;
    for shift in (0..32).step_by(7) {
        let next = byte(bytes)?;
        value |= u32::from(next & 0x7f).checked_shl(shift)?;
        if next & 0x80 == 0 {
            return Some(value);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn every_kind() -> Vec<Input> {
        let setting = Setting {
            base: 2,
            gyro: true,
            floor: Floor::Bad,
            seed: 40_000,
        };
        vec![
            Input::Begin(setting),
            Input::Robot {
                setting,
                name: "my.toml".to_owned(),
                text: "[robot]\nm = 1\n".to_owned(),
            },
            Input::Laws(3),
            Input::Goal([-32_768, 32_767, -31_416]),
            Input::Place([1, -2, 3], true),
            Input::Line(vec![[0, 0], [1000, -1000]]),
            Input::File {
                name: String::new(),
                bytes: vec![0, 255, 10],
            },
            Input::Drive {
                speed: -500,
                turn_rate: 1200,
            },
            Input::Stop,
            Input::EmergencyStop,
            Input::Arm,
            Input::Push {
                force: [300, -300],
                moment: 5,
                duration: 250,
            },
            Input::Ice([-1, 2, -3, 4], 5),
            Input::Thaw,
            Input::Fault(3, true),
            Input::Host(false),
        ]
    }

    #[test]
    fn every_input_reads_back_and_none_reads_from_less() {
        for input in every_kind() {
            let mut bytes = Vec::new();
            input.encode(&mut bytes);
            let mut rest = bytes.as_slice();
            assert_eq!(Input::decode(&mut rest).as_ref(), Some(&input));
            assert!(rest.is_empty(), "{input:?} leaves {rest:?}");
            for cut in 0..bytes.len() {
                assert_eq!(Input::decode(&mut &bytes[..cut]), None, "{input:?}");
            }
        }
    }

    #[test]
    fn counts_read_back() {
        for value in [0, 1, 127, 128, 16_383, 16_384, u32::MAX] {
            let mut bytes = Vec::new();
            count(&mut bytes, value);
            assert_eq!(count_of(&mut bytes.as_slice()), Some(value));
        }
        assert_eq!(count_of(&mut [0x80].as_slice()), None);
    }
}
