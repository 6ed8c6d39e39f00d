//! Cycles of a Cortex-M4F, modelled: every executed instruction of an emulated run, and what the manual of the processor says it takes.
//!
//! The emulator counts instructions, not cycles. Arm's "Cortex-M4 Technical Reference Manual" (DDI 0439, tables 3-1 and 7-1) states the
//! cycles of each instruction with memory that never waits. What depends on its neighbours is given as a range: the least if all that can
//! overlap does, the most if nothing does. Flash that waits comes on top.

use std::collections::BTreeMap;
use std::ops::{AddAssign, RangeInclusive};
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use firmware_demo::host::{LinkKind, Machine, Options, trace};

use super::budget_image::succeed;

/// Refill of the pipeline after a branch that is taken, P of table 3-1.
const REFILL: RangeInclusive<u64> = 1..=3;

/// Least and most.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cycles {
    /// All that can overlap does.
    pub least: u64,
    /// Nothing does.
    pub most: u64,
}

impl Cycles {
    const fn exactly(cycles: u64) -> Self {
        Self::between(cycles, cycles)
    }

    const fn between(least: u64, most: u64) -> Self {
        Self { least, most }
    }

    const fn refilled(self) -> Self {
        Self::between(self.least + *REFILL.start(), self.most + *REFILL.end())
    }
}

impl AddAssign for Cycles {
    fn add_assign(&mut self, other: Self) {
        self.least += other.least;
        self.most += other.most;
    }
}

/// Ticks of a kind.
#[derive(Clone, Copy, Debug, Default)]
pub struct Traced {
    /// How many.
    pub ticks: u64,
    /// Executed in all of them.
    pub instructions: u64,
    /// Modelled for them.
    pub cycles: Cycles,
}

impl Traced {
    /// The mean, rounded.
    pub fn per_tick(&self) -> Cycles {
        let mean = |sum: u64| (sum as f64 / self.ticks as f64).round() as u64;
        Cycles::between(mean(self.cycles.least), mean(self.cycles.most))
    }
}

/// What the image `trace` executes between its marks: while following, while parking; and what it prints.
pub fn traced(image: &Path) -> ([Traced; 2], String) {
    let code = Code::of(image);
    let [follow, park, ends] =
        ["follow_begins", "park_begins", "tick_ends"].map(|mark| code.marks[mark]);
    let mut all = [Traced::default(); 2];
    // Of which kind the tick under way is, and its last instruction.
    let mut under_way: Option<(usize, Option<u32>)> = None;
    let options = Options {
        machine: Machine::CortexM4F,
        link: LinkKind::None,
        icount: true,
        core: None,
        silence: Duration::from_secs(120),
    };
    let outcome = trace(image, &options, |address| {
        if let Some((kind, Some(last))) = under_way {
            all[kind].cycles += code.cycles(last, address);
        }
        if let Some(kind) = [follow, park].iter().position(|mark| *mark == address) {
            all[kind].ticks += 1;
            under_way = Some((kind, None));
        } else if address == ends {
            under_way = None;
        } else if let Some((kind, last)) = &mut under_way {
            all[*kind].instructions += 1;
            *last = Some(address);
        }
    })
    .expect("the emulator runs");
    assert_eq!(outcome.code, Some(0), "{}", outcome.console);
    (all, outcome.console)
}

/// The instructions of an image by their addresses, and where its marks are.
struct Code {
    instructions: BTreeMap<u32, Instruction>,
    marks: BTreeMap<String, u32>,
}

/// As a disassembler writes it.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Instruction {
    size: u32,
    mnemonic: String,
    operands: String,
}

impl Code {
    fn of(image: &Path) -> Self {
        let mut command = Command::new("arm-none-eabi-objdump");
        let output = succeed(command.arg("-d").arg(image));
        let text = String::from_utf8_lossy(&output.stdout);
        let (mut instructions, mut marks) = (BTreeMap::new(), BTreeMap::new());
        for line in text.lines() {
            if let Some((address, name)) = line.split_once(" <")
                && let Some(name) = name.strip_suffix(">:")
                && let Ok(address) = u32::from_str_radix(address, 16)
            {
                marks.insert(name.to_owned(), address);
            }
            let mut fields = line.split('\t');
            let (Some(address), Some(bytes), Some(mnemonic)) =
                (fields.next(), fields.next(), fields.next())
            else {
                continue;
            };
            let address = address.trim().trim_end_matches(':');
            let address = u32::from_str_radix(address, 16).expect("an address");
            let digits = bytes.chars().filter(char::is_ascii_hexdigit).count();
            let instruction = Instruction {
                size: digits as u32 / 2,
                mnemonic: mnemonic.to_owned(),
                operands: fields.next().unwrap_or_default().to_owned(),
            };
            instructions.insert(address, instruction);
        }
        Self {
            instructions,
            marks,
        }
    }

    /// Of the instruction at an address, when the one at `next` is executed after it.
    fn cycles(&self, address: u32, next: u32) -> Cycles {
        let instruction = &self.instructions[&address];
        let taken = next != address + instruction.size;
        instruction.cycles(taken, self.instructions.get(&next))
    }
}

impl Instruction {
    /// Tables 3-1 and 7-1. One whose condition does not hold counts as if it did.
    fn cycles(&self, taken: bool, next: Option<&Self>) -> Cycles {
        let is = |names: &[&str]| names.iter().any(|name| self.mnemonic.starts_with(name));
        let one = Cycles::exactly(1);
        let words = self.words();
        let cycles = if is(&["it"]) {
            // May be folded into the instruction before it.
            Cycles::between(0, 1)
        } else if is(&["tbb", "tbh"]) {
            Cycles::exactly(2)
        } else if is(&[
            "ldrd", "strd", "ldm", "stm", "push", "pop", "vldm", "vstm", "vpush", "vpop",
        ]) {
            Cycles::exactly(1 + words)
        } else if is(&["ldr", "str", "vldr", "vstr"]) {
            // In a row with others each takes the second cycle together with the next one's first.
            Cycles::between(words, 1 + words)
        } else if is(&["sdiv", "udiv"]) {
            Cycles::between(2, 12)
        } else if is(&["mla", "mls"]) {
            Cycles::exactly(2)
        } else if is(&["vdiv", "vsqrt"]) {
            Cycles::exactly(14)
        } else if is(&[
            "vmla", "vmls", "vnmla", "vnmls", "vfma", "vfms", "vfnma", "vfnms",
        ]) {
            Cycles::exactly(3)
        } else if is(&["vmov"]) && self.operands.matches(',').count() >= 2 {
            Cycles::exactly(2)
        } else if is(&["dmb", "dsb", "isb"]) {
            Cycles::between(1, 4)
        } else {
            one
        };
        let late = next.is_some_and(|next| self.computes() && next.reads(self.target()));
        let cycles = Cycles::between(cycles.least, cycles.most + u64::from(late));
        if taken { cycles.refilled() } else { cycles }
    }

    /// Arithmetic of the floating-point unit: its result is there a cycle later for the instruction that follows.
    fn computes(&self) -> bool {
        let moves = [
            "vmov", "vmrs", "vmsr", "vldr", "vstr", "vldm", "vstm", "vpush", "vpop",
        ];
        self.mnemonic.starts_with('v') && !moves.iter().any(|name| self.mnemonic.starts_with(name))
    }

    fn target(&self) -> &str {
        let end = self.operands.find(',').unwrap_or(self.operands.len());
        &self.operands[..end]
    }

    /// Whether a register is among the operands, the target itself where it is accumulated into or stored.
    fn reads(&self, register: &str) -> bool {
        let mut operands = self.operands.split([',', ' ', '[', ']', '{', '}']);
        let keeps = ["vmla", "vmls", "vnm", "vf", "vcmp", "vstr", "vmrs"];
        if !keeps.iter().any(|name| self.mnemonic.starts_with(name)) {
            operands.next();
        }
        operands.any(|operand| operand == register)
    }

    /// How many words a load or a store moves.
    fn words(&self) -> u64 {
        let list = match (self.operands.find('{'), self.operands.find('}')) {
            (Some(from), Some(to)) => &self.operands[from + 1..to],
            _ if self.mnemonic.contains("rd") => return 2,
            _ => self.target(),
        };
        let of = |name: &str| if name.starts_with('d') { 2 } else { 1 };
        let number = |name: &str| name[1..].parse::<u64>().expect("a register");
        list.split(',')
            .map(|part| match part.trim().split_once('-') {
                Some((from, to)) => of(from) * (number(to) - number(from) + 1),
                None => of(part.trim()),
            })
            .sum()
    }
}

#[test]
fn the_model_has_the_manuals_cycles() {
    let instruction = |text: &str| {
        let (mnemonic, operands) = text.split_once(' ').unwrap_or((text, ""));
        Instruction {
            size: 4,
            mnemonic: mnemonic.to_owned(),
            operands: operands.to_owned(),
        }
    };
    let next = instruction("vadd.f32 s4, s1, s2");
    for (text, taken, least, most) in [
        ("add.w r0, r1, r2", false, 1, 1),
        ("ldr.w r0, [r1, #4]", false, 1, 2),
        ("strd r0, r1, [sp, #8]", false, 3, 3),
        ("ldrd r0, r1, [sp, #8]", false, 3, 3),
        ("ldrb.w r0, [r1, #4]", false, 1, 2),
        ("vldr d8, [sp, #8]", false, 2, 3),
        ("pop {r4, r5, r7, pc}", true, 6, 8),
        ("vpush {d8-d15}", false, 17, 17),
        ("vldmia r0, {s0-s3}", false, 5, 5),
        ("ldmia.w r0, {r1, r2, ip}", false, 4, 4),
        ("bne.n 1234 <x+0x2>", true, 2, 4),
        ("bne.n 1234 <x+0x2>", false, 1, 1),
        ("bic.w r0, r1, r2", false, 1, 1),
        ("bl 1234 <x>", true, 2, 4),
        ("vmul.f32 s1, s2, s3", false, 1, 2),
        ("vmul.f32 s7, s2, s3", false, 1, 1),
        ("vmla.f32 s7, s2, s3", false, 3, 3),
        ("vsqrt.f32 s2, s3", false, 14, 15),
        ("vmov r0, r1, d0", false, 2, 2),
        ("vmov.f32 s1, s2", false, 1, 1),
        ("udiv r0, r1, r2", false, 2, 12),
        ("itt eq", false, 0, 1),
    ] {
        let cycles = instruction(text).cycles(taken, Some(&next));
        assert_eq!(cycles, Cycles::between(least, most), "{text}");
    }
}
