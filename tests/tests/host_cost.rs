//! What a simulated tick takes on the host, as tests are built; `sh tests/host-cost` counts the program that is released.

use std::path::Path;

use tests::host_cost::compare;

#[test]
fn ticks_take_the_instructions_that_are_stated() {
    compare(Path::new(env!("CARGO_BIN_EXE_host-cost")));
}
