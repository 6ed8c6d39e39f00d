//! The caller's memory.

#![allow(unsafe_code)]

use core::mem::MaybeUninit;
use core::ptr::{self, NonNull};
use core::sync::atomic::{AtomicU32, Ordering};

use controller_core::base::{BaseController, WheelAction};

use crate::abi::{Pose, Status};

/// Bytes of `twb_base`: room for [`Base`] on every target. The header has the same number.
pub const SIZE: usize = 4096;
/// Alignment of `twb_base`.
pub const ALIGN: usize = 8;

/// Marks of memory that is a base: neither is what erased, painted or counted memory holds.
const READY: u32 = 0x7762_A5C3;
const BUSY: u32 = READY ^ 0x80;

/// Stops that came while a call was under way.
const NO_STOP: u32 = 0;
const STOP_RELEASE: u32 = 1;
const STOP_BRAKE: u32 = 2;

/// Between marks and what they guard: an interrupt on the same core sees both in this order.
#[inline]
fn fence() {
    // WebAssembly has no such fence, and the C compiler that portable C is for would see none.
    #[cfg(all(feature = "archive", target_arch = "wasm32"))]
    {
        // SAFETY: of the portable C, which defines it.
        unsafe extern "C" {
            safe fn twb_fence();
        }
        twb_fence();
    }
    #[cfg(not(all(feature = "archive", target_arch = "wasm32")))]
    core::sync::atomic::compiler_fence(Ordering::SeqCst);
}

/// What `twb_base` holds.
#[repr(C, align(8))]
pub struct Base {
    mark: AtomicU32,
    stop: AtomicU32,
    body: MaybeUninit<Body>,
    /// Constant while there is a base: read within any call, without the body.
    period_us: AtomicU32,
}

const _: () = assert!(size_of::<Base>() <= SIZE && align_of::<Base>() == ALIGN);

/// The base proper. What is small comes first: RV32 reaches the first 2 kB of it in one instruction.
#[repr(C)]
pub(crate) struct Body {
    /// Ticks so far.
    pub ticks: u32,
    /// The [`device`](crate::abi::device) code that a driver would have answered the last duties with, until a tick was told.
    pub answer: u32,
    pub controller: BaseController,
    /// Where the base was put, which its report says until the encoders gave a first reading.
    pub start: Pose,
}

impl Body {
    /// Apart, so that a tick does not carry it along.
    #[cold]
    #[inline(never)]
    fn stop(&mut self, asked: u32) -> WheelAction<f32> {
        self.controller.emergency_stop_by(asked == STOP_BRAKE)
    }
}

/// A pointer of the caller that is neither NULL nor misaligned.
#[inline]
pub(crate) fn checked<T>(pointer: *const T) -> Result<NonNull<T>, Status> {
    match NonNull::new(pointer.cast_mut()) {
        Some(sound) if sound.is_aligned() => Ok(sound),
        refused => Err(unsound(refused.is_none())),
    }
}

/// Apart, so that a tick does not carry it along.
#[cold]
#[inline(never)]
const fn unsound(null: bool) -> Status {
    if null {
        Status::Null
    } else {
        Status::Misaligned
    }
}

/// Why a base with this mark is not to be worked on: it is not [`READY`].
#[cold]
#[inline(never)]
const fn unready(mark: u32) -> Status {
    if mark == BUSY {
        Status::Busy
    } else {
        Status::NotInitialised
    }
}

/// What the caller's pointer refers to, copied: it may change while a call is under way.
///
/// # Safety
/// If neither NULL nor misaligned, it points to a readable `T`, of which any bits are a value.
pub(crate) unsafe fn read<T: Copy>(pointer: *const T) -> Result<T, Status> {
    let pointer = checked(pointer)?;
    // SAFETY: aligned and not NULL, and the caller of this function vouches for the rest.
    Ok(unsafe { pointer.read() })
}

/// A handle on the caller's memory.
#[derive(Clone, Copy)]
pub(crate) struct Handle(NonNull<Base>);

impl Handle {
    /// # Safety
    /// If neither NULL nor misaligned, it points to [`SIZE`] bytes that are the caller's and are accessed by these calls only,
    /// from one thread, or from interrupts above it on the same core.
    pub unsafe fn new(base: *const Base) -> Result<Self, Status> {
        checked(base).map(Self)
    }

    /// # Safety
    /// As [`new`](Self::new), and neither NULL nor misaligned.
    pub unsafe fn new_unchecked(base: *mut Base) -> Self {
        // SAFETY: of the caller.
        Self(unsafe { NonNull::new_unchecked(base) })
    }

    fn mark(&self) -> &AtomicU32 {
        // SAFETY: points to a `Base` by the promise at `new`; any bits are an `AtomicU32`, and only its atomic operations
        // reach it.
        unsafe { &*ptr::addr_of!((*self.0.as_ptr()).mark) }
    }

    fn asked(&self) -> &AtomicU32 {
        // SAFETY: as `mark`.
        unsafe { &*ptr::addr_of!((*self.0.as_ptr()).stop) }
    }

    fn period(&self) -> &AtomicU32 {
        // SAFETY: as `mark`.
        unsafe { &*ptr::addr_of!((*self.0.as_ptr()).period_us) }
    }

    /// Makes a base of the memory, whatever its mark says: that of a call which a reset of the chip cut short would stay for ever.
    /// `period_us` is the base's, a number of its own here. `write` makes the body where it stays: moved, it would be on the stack as well.
    ///
    /// # Safety
    /// Not from within another call on the same base. Calls from within this one are as from within any other.
    pub unsafe fn put(self, period_us: u32, write: impl FnOnce(&mut MaybeUninit<Body>)) {
        self.period().store(period_us, Ordering::Relaxed);
        // Before the mark: a stop that sees it is for the new base.
        self.asked().store(NO_STOP, Ordering::Relaxed);
        fence();
        self.mark().store(BUSY, Ordering::Relaxed);
        fence();
        // SAFETY: room for a `Base` by the promise at `new`; no other call has the body by the caller's, and the mark keeps every one
        // from an interrupt away from it.
        write(unsafe { &mut *ptr::addr_of_mut!((*self.0.as_ptr()).body) });
        self.close_apart();
    }

    /// What every call may read, also within another one.
    pub fn period_us(self) -> Result<u32, Status> {
        match self.mark().load(Ordering::Relaxed) {
            READY | BUSY => Ok(self.period().load(Ordering::Relaxed)),
            _ => Err(Status::NotInitialised),
        }
    }

    /// Works on an initialised base that no other call is under way on. What is done before and after the work is in flash once, which
    /// takes a few instructions longer than [`open`](Self::open) and [`close`](Self::close).
    pub fn with_apart<R>(
        self,
        work: impl FnOnce(&mut Body) -> Result<R, Status>,
    ) -> Result<R, Status> {
        let result = work(self.open_apart()?);
        self.close_apart();
        result
    }

    #[inline(never)]
    fn open_apart<'a>(self) -> Result<&'a mut Body, Status> {
        self.open()
    }

    #[inline(never)]
    fn close_apart(self) {
        self.close(|_| ());
    }

    /// The body of an initialised base that no other call is under way on, which is this call's until [`close`](Self::close).
    #[inline]
    pub fn open<'a>(self) -> Result<&'a mut Body, Status> {
        let mark = self.mark();
        let found = mark.load(Ordering::Relaxed);
        if found != READY {
            return Err(unready(found));
        }
        mark.store(BUSY, Ordering::Relaxed);
        fence();
        // SAFETY: READY says that `put` wrote the body; BUSY now keeps every other call away from it until it is given back.
        Ok(unsafe { (*ptr::addr_of_mut!((*self.0.as_ptr()).body)).assume_init_mut() })
    }

    /// Gives the body back. `stopped` gets what an emergency stop that came meanwhile asks of the wheels.
    #[inline]
    pub fn close(self, stopped: impl Fn(&WheelAction<f32>)) {
        self.give_back();
        // Looked for once the mark is off: an interrupt that stopped before it saw a base in a call, one after it does it itself.
        if self.asked().load(Ordering::Relaxed) != NO_STOP {
            self.catch_up(stopped);
        }
    }

    #[inline]
    fn give_back(self) {
        fence();
        self.mark().store(READY, Ordering::Relaxed);
        fence();
    }

    /// Does what was asked during a call. Apart, so that a tick does not carry it along.
    #[cold]
    #[inline(never)]
    fn catch_up(self, stopped: impl Fn(&WheelAction<f32>)) {
        // Another call that took the body meanwhile does it when it gives it back.
        while let Ok(body) = self.open() {
            let asked = self.asked().load(Ordering::Relaxed);
            self.asked().store(NO_STOP, Ordering::Relaxed);
            if asked != NO_STOP {
                stopped(&body.stop(asked));
            }
            self.give_back();
            if self.asked().load(Ordering::Relaxed) == NO_STOP {
                return;
            }
        }
    }

    /// Stops, now or at the end of the call that is under way.
    pub fn stop(self, brake: bool) -> Result<WheelAction<f32>, Status> {
        let (asked, action) = if brake {
            (STOP_BRAKE, WheelAction::Brake)
        } else {
            (STOP_RELEASE, WheelAction::Release)
        };
        match self.with_apart(|body| Ok(body.stop(asked))) {
            Err(Status::Busy) => {
                self.asked().store(asked, Ordering::Relaxed);
                Ok(action)
            }
            result => result,
        }
    }
}
