//! UART0: 8 bits, no parity, one stop bit, with its queues of 32 bytes.

use board_common::BAUD;
use rp_pac as pac;

use crate::clocks::SYSTEM_HZ;
use crate::pins::{Function, connect};

/// Bytes that the receiver's queue holds.
const QUEUE: usize = 32;
/// The clock over 16 times the baud rate, in 64ths and rounded (PL011, integer and fractional divisor).
const DIVISOR: u32 = (8 * SYSTEM_HZ / BAUD).div_ceil(2);

/// Both directions.
pub struct Port(());

impl Port {
    /// Starts it on its two pins.
    pub fn start<const OUT: usize, const IN: usize>() -> Self {
        const { assert!(OUT == 0 && IN == 1) };
        connect::<OUT>(Function::Uart, false);
        connect::<IN>(Function::Uart, true);
        let uart = pac::UART0;
        uart.uartibrd().write(|w| w.0 = DIVISOR >> 6);
        uart.uartfbrd().write(|w| w.0 = DIVISOR & 0x3f);
        // The divisor is taken over by this write.
        uart.uartlcr_h().write(|w| {
            w.set_wlen(0b11);
            w.set_fen(true);
        });
        uart.uartcr().write(|w| {
            w.set_uarten(true);
            w.set_rxe(true);
            w.set_txe(true);
        });
        Self(())
    }

    /// Takes what has arrived, no more than the queue holds. A byte with an error is left out; its frame fails the check
    /// sum.
    pub fn receive(&mut self, mut take: impl FnMut(u8)) {
        for _ in 0..QUEUE {
            if pac::UART0.uartfr().read().rxfe() {
                return;
            }
            let byte = pac::UART0.uartdr().read();
            if !(byte.fe() || byte.pe() || byte.be() || byte.oe()) {
                take(byte.data());
            }
        }
    }

    /// Sends a byte if the transmitter has room.
    pub fn send(&mut self, byte: u8) -> bool {
        let room = !pac::UART0.uartfr().read().txff();
        if room {
            pac::UART0.uartdr().write(|w| w.set_data(byte));
        }
        room
    }
}
