//! What a noisy pose leaves of parking.
