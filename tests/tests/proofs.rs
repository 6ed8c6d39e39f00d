//! The programs behind `docs/proofs.md`: what is left of each proof once monotone rounding has done its part is tried for every number
//! there is, or for every number at which a float changes its kind.

#[path = "proofs/neuron.rs"]
mod neuron;
#[path = "proofs/queue.rs"]
mod queue;
#[path = "proofs/saturation.rs"]
mod saturation;
#[path = "proofs/storage.rs"]
mod storage;
#[path = "proofs/wire.rs"]
mod wire;

/// Positive floats at which something may change: in every `stride`th binade the first, the second, the middle and the last one;
/// both ends of the subnormals, the largest number.
fn corners(stride: usize) -> Vec<f32> {
    let mut bits = vec![1, 2, 0x007F_FFFE, 0x007F_FFFF, 0x7F7F_FFFF];
    for exponent in (1..=254_u32).step_by(stride) {
        for mantissa in [0, 1, 0x0040_0000, 0x007F_FFFF] {
            bits.push(exponent << 23 | mantissa);
        }
    }
    bits.into_iter().map(f32::from_bits).collect()
}
