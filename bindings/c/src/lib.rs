//! The whole base for C and C++: what `include/twb.h` declares.
//!
//! | module | what |
//! | --- | --- |
//! | [`abi`] | the structs of the header, field by field, their sizes asserted here and there |
//! | [`calls`] | the functions of the header: arguments checked, nothing changed where one is bad |
//! | [`memory`] | the caller's memory: initialised or not, in a call or not; the only place that follows its pointer |
//! | `convert` | between those structs and the core's types; no bit changes |
//! | [`names`] | texts of the codes |
//!
//! Nothing is computed here: a tick is `BaseController::tick`, and for motors on bridges what the control task of a board does
//! with its action. `docs/c.md` says how to build, link and use it.
#![no_std]

pub mod abi;
pub mod calls;
mod convert;
pub mod memory;
pub mod names;

#[cfg(feature = "archive")]
mod panic {
    #[allow(unsafe_code)]
    // SAFETY: nobody defines it, so what could call it does not link.
    unsafe extern "C" {
        safe fn a_panic_is_reachable() -> !;
    }

    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        a_panic_is_reachable()
    }
}
