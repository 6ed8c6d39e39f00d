//! Semihosting: system calls to the emulator (ARM semihosting 2.0, which RISC-V shares).
//!
//! Without an emulator or debugger a call traps. So this is for emulated boards only.

use core::arch::asm;
use core::ffi::CStr;

const SYS_OPEN: usize = 0x01;
const SYS_WRITE0: usize = 0x04;
const SYS_WRITE: usize = 0x05;
const SYS_READ: usize = 0x06;
const SYS_GET_CMDLINE: usize = 0x15;
const SYS_EXIT_EXTENDED: usize = 0x20;
const APPLICATION_EXIT: usize = 0x2_0026;

/// How to open a file of the host: the number of the `fopen` mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// `rb`.
    Read = 1,
    /// `wb`.
    Write = 5,
}

/// An open file of the host.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct File(usize);

/// Opens a file of the host; relative paths start in the emulator's working directory.
pub fn open(path: &CStr, mode: Mode) -> Option<File> {
    let block = [path.as_ptr() as usize, mode as usize, path.count_bytes()];
    // SAFETY: SYS_OPEN reads three words and the string of the stated length, all alive here.
    let handle = unsafe { call(SYS_OPEN, block.as_ptr() as usize) };
    (handle != usize::MAX).then_some(File(handle))
}

impl File {
    /// Reads at least one byte, waiting for it; 0 at the end of the file, `None` on failure.
    pub fn read(self, into: &mut [u8]) -> Option<usize> {
        let block = [self.0, into.as_mut_ptr() as usize, into.len()];
        // SAFETY: SYS_READ writes at most the stated length into `into`, borrowed for the call.
        let missing = unsafe { call(SYS_READ, block.as_ptr() as usize) };
        into.len().checked_sub(missing)
    }

    /// Writes and returns how much was taken, `None` on failure.
    pub fn write(self, bytes: &[u8]) -> Option<usize> {
        let block = [self.0, bytes.as_ptr() as usize, bytes.len()];
        // SAFETY: SYS_WRITE reads the stated length of `bytes`.
        let left = unsafe { call(SYS_WRITE, block.as_ptr() as usize) };
        bytes.len().checked_sub(left)
    }
}

/// Prints on the emulator's console.
pub fn write0(text: &CStr) {
    // SAFETY: SYS_WRITE0 reads up to the terminating zero.
    unsafe { call(SYS_WRITE0, text.as_ptr() as usize) };
}

/// The arguments of `-semihosting-config arg=...`, separated by blanks; empty when they do not fit `into`.
pub fn command_line(into: &mut [u8]) -> &[u8] {
    let mut block = [into.as_mut_ptr() as usize, into.len()];
    // SAFETY: SYS_GET_CMDLINE writes at most the stated length into `into` and the length into the block.
    let failed = unsafe { call(SYS_GET_CMDLINE, block.as_mut_ptr() as usize) };
    let [_, len] = block;
    if failed == 0 {
        into.get(..len).unwrap_or_default()
    } else {
        &[]
    }
}

/// Ends the emulator with an exit code.
pub fn exit(code: u32) -> ! {
    let block = [APPLICATION_EXIT, code as usize];
    loop {
        // SAFETY: SYS_EXIT_EXTENDED reads two words; it does not return under an emulator.
        unsafe { call(SYS_EXIT_EXTENDED, block.as_ptr() as usize) };
    }
}

/// # Safety
///
/// `argument` must point to what `operation` reads and writes, valid for the whole call.
#[cfg(target_arch = "arm")]
unsafe fn call(operation: usize, argument: usize) -> usize {
    let result;
    // SAFETY: BKPT 0xAB is the semihosting trap of M-profile; it changes r0 and memory named by `argument`.
    unsafe {
        asm!("bkpt #0xab", inlateout("r0") operation => result, in("r1") argument, options(nostack));
    }
    result
}

/// # Safety
///
/// `argument` must point to what `operation` reads and writes, valid for the whole call.
#[cfg(target_arch = "riscv32")]
unsafe fn call(operation: usize, argument: usize) -> usize {
    let result;
    // SAFETY: the three uncompressed instructions, on one page, are the semihosting trap of RISC-V; it changes
    // a0 and memory named by `argument`.
    unsafe {
        asm!(
            ".balign 16",
            ".option push",
            ".option norvc",
            "slli x0, x0, 0x1f",
            "ebreak",
            "srai x0, x0, 7",
            ".option pop",
            inlateout("a0") operation => result,
            in("a1") argument,
            options(nostack),
        );
    }
    result
}
