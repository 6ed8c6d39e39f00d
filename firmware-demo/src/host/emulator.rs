//! An emulator with firmware in it, from start to exit code.

use std::boxed::Box;
use std::error::Error;
use std::fmt::{self, Display, Formatter};
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::string::{String, ToString};
use std::sync::atomic::{AtomicU32, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};
use std::{env, format, fs, process};

use super::{AnyLink, FifoLink, UartLink};

/// The emulated machines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Machine {
    /// `mps2-an386`, Cortex-M4F.
    CortexM4F,
    /// `virt`, riscv32imafc.
    Riscv32,
}

impl Machine {
    /// Target triple of its images.
    pub const fn target(self) -> &'static str {
        match self {
            Self::CortexM4F => "thumbv7em-none-eabihf",
            Self::Riscv32 => "riscv32imafc-unknown-none-elf",
        }
    }

    /// The program that emulates it.
    pub const fn emulator(self) -> &'static str {
        match self {
            Self::CortexM4F => "qemu-system-arm",
            Self::Riscv32 => "qemu-system-riscv32",
        }
    }

    const fn arguments(self) -> &'static [&'static str] {
        match self {
            Self::CortexM4F => &["-M", "mps2-an386"],
            Self::Riscv32 => &["-M", "virt", "-bios", "none"],
        }
    }

    /// The shift at which the firmware's counter counts instructions.
    const fn icount(self) -> &'static str {
        match self {
            Self::CortexM4F => "shift=10",
            Self::Riscv32 => "shift=0",
        }
    }
}

/// How to talk to the firmware.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkKind {
    /// Not at all.
    None,
    /// By the emulated serial port.
    Uart,
    /// By semihosting and two FIFOs.
    Fifo,
}

/// How to start the emulator.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Which machine.
    pub machine: Machine,
    /// Which link.
    pub link: LinkKind,
    /// Count instructions; slower.
    pub icount: bool,
    /// Core of the host to pin the emulator to, by `taskset`.
    pub core: Option<u8>,
    /// Longest silence of the link.
    pub silence: Duration,
}

/// Why there is no emulator, or no end of it.
#[derive(Debug)]
#[non_exhaustive]
pub enum EmulatorError {
    /// The program could not be started.
    Start(&'static str, io::Error),
    /// The link could not be made; with what the emulator printed.
    Link(io::Error, String),
    /// It did not end in time and was killed; with what it printed.
    Timeout(String),
}

impl Display for EmulatorError {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Start(program, error) => write!(f, "{program} does not start: {error}"),
            Self::Link(error, console) => write!(f, "no link to the emulator: {error}\n{console}"),
            Self::Timeout(console) => write!(f, "the emulator did not end in time\n{console}"),
        }
    }
}

impl Error for EmulatorError {}

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EmulatorOutcome {
    /// Exit code, `None` after a signal.
    pub code: Option<i32>,
    /// What firmware and emulator printed.
    pub console: String,
}

/// A running emulator; dropping it kills it and removes its directory.
#[derive(Debug)]
pub struct Emulator {
    child: Child,
    console: Option<JoinHandle<String>>,
    directory: PathBuf,
}

impl Emulator {
    /// Starts `image`; the link is there for every kind but [`LinkKind::None`].
    ///
    /// # Errors
    ///
    /// When the program or the link cannot be had.
    pub fn start(
        image: &Path,
        options: &Options,
    ) -> Result<(Self, Option<AnyLink>), EmulatorError> {
        Self::start_with(image, options, &[])
    }

    /// As [`start`](Self::start), with more arguments for the emulator.
    ///
    /// # Errors
    ///
    /// As `start`.
    pub fn start_with(
        image: &Path,
        options: &Options,
        arguments: &[&str],
    ) -> Result<(Self, Option<AnyLink>), EmulatorError> {
        let program = options.machine.emulator();
        let directory = make_directory().map_err(|error| EmulatorError::Start(program, error))?;
        let fifo = match options.link {
            LinkKind::Fifo => Some(FifoLink::create(&directory, options.silence)),
            _ => None,
        };
        let mut command = command_line(image, options);
        command.args(arguments).current_dir(&directory);
        let mut child = match command.spawn() {
            Ok(child) => child,
            Err(error) => {
                // Nobody else knows the directory; if it stays, the system's temporary store keeps it.
                let _ = fs::remove_dir_all(&directory);
                return Err(EmulatorError::Start(program, error));
            }
        };
        let pipe = child.stderr.take();
        let console = thread::spawn(move || gather(pipe));
        let mut emulator = Self {
            child,
            console: Some(console),
            directory,
        };
        let link: io::Result<Option<AnyLink>> = match (options.link, fifo) {
            (_, Some(link)) => link.map(|link| Some(Box::new(link) as AnyLink)),
            (LinkKind::Uart, _) => {
                UartLink::connect(&emulator.directory.join("uart"), options.silence)
                    .map(|link| Some(Box::new(link) as AnyLink))
            }
            _ => Ok(None),
        };
        match link {
            Ok(link) => Ok((emulator, link)),
            Err(error) => Err(EmulatorError::Link(error, emulator.kill())),
        }
    }

    /// Waits for the firmware to end.
    ///
    /// # Errors
    ///
    /// [`EmulatorError::Timeout`] when it is still running after `limit`.
    pub fn finish(mut self, limit: Duration) -> Result<EmulatorOutcome, EmulatorError> {
        let until = Instant::now() + limit;
        loop {
            match self.child.try_wait() {
                Ok(Some(status)) => {
                    return Ok(EmulatorOutcome {
                        code: status.code(),
                        console: self.kill(),
                    });
                }
                Ok(None) if Instant::now() < until => thread::sleep(Duration::from_millis(1)),
                _ => return Err(EmulatorError::Timeout(self.kill())),
            }
        }
    }

    /// Ends the emulator, if it still runs, and returns what was printed.
    fn kill(&mut self) -> String {
        // Failing means that it has ended already, which is what is wanted.
        let _ = self.child.kill();
        let _ = self.child.wait();
        self.console
            .take()
            .and_then(|console| console.join().ok())
            .unwrap_or_default()
    }
}

impl Drop for Emulator {
    fn drop(&mut self) {
        self.kill();
        // A directory that cannot be removed is left to the system's cleaning of its temporary store.
        let _ = fs::remove_dir_all(&self.directory);
    }
}

/// Runs an image to its end and gives the address of every instruction that it executes to `each`; of an instruction that jumps to
/// itself, once.
///
/// # Errors
///
/// [`EmulatorError::Start`] when the emulator does not start, or its trace cannot be read.
pub fn trace(
    image: &Path,
    options: &Options,
    mut each: impl FnMut(u32),
) -> Result<EmulatorOutcome, EmulatorError> {
    let program = options.machine.emulator();
    let failed = |error| EmulatorError::Start(program, error);
    let help = Command::new(program)
        .arg("-help")
        .output()
        .map_err(failed)?;
    // Which of the two an emulator knows depends on its age.
    let newer = String::from_utf8_lossy(&help.stdout).contains("one-insn-per-tb");
    let single: &[&str] = if newer {
        &["-accel", "tcg,one-insn-per-tb=on"]
    } else {
        &["-singlestep"]
    };
    let mut command = command_line(image, options);
    command.args(single).args(["-d", "exec,nochain"]);
    let mut child = command.spawn().map_err(failed)?;
    let (mut console, mut last) = (String::new(), None);
    // The trace goes where the firmware prints.
    for line in child
        .stderr
        .take()
        .map(BufReader::new)
        .into_iter()
        .flat_map(BufRead::lines)
    {
        let line = line.map_err(failed)?;
        // `Trace 0: 0x7f5d8c000100 [00400000/00000458/00000110/ff021000] name`: the second of four is where it is.
        let traced = line
            .strip_prefix("Trace ")
            .and_then(|rest| rest.split('/').nth(1));
        match traced.map(|address| u32::from_str_radix(address, 16)) {
            // Where its count of instructions runs out it begins one anew.
            Some(Ok(address)) if last == Some(address) => {}
            Some(Ok(address)) => {
                last = Some(address);
                each(address);
            }
            // About blocks of which it executes a part only, to count exactly.
            _ if line.starts_with("cpu_io_recompile:") || line.starts_with("Stopped execution") => {
            }
            _ => {
                console.push_str(&line);
                console.push('\n');
            }
        }
    }
    let code = child.wait().map_err(failed)?.code();
    Ok(EmulatorOutcome { code, console })
}

fn command_line(image: &Path, options: &Options) -> Command {
    let program = options.machine.emulator();
    let mut command = match options.core {
        Some(core) => {
            let mut command = Command::new("taskset");
            command.args(["-c", &core.to_string(), program]);
            command
        }
        None => Command::new(program),
    };
    let (serial, argument) = match options.link {
        LinkKind::Uart => ("unix:uart,server=on,wait=on", "uart"),
        LinkKind::Fifo => ("none", "fifo"),
        LinkKind::None => ("none", "none"),
    };
    command
        .args(options.machine.arguments())
        .args(["-display", "none", "-monitor", "none", "-serial", serial])
        .args([
            "-semihosting-config",
            &format!("enable=on,target=native,arg=firmware,arg={argument}"),
        ])
        .arg("-kernel")
        .arg(image)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    if options.icount {
        command.args(["-icount", options.machine.icount()]);
    }
    command
}

fn make_directory() -> io::Result<PathBuf> {
    static NEXT: AtomicU32 = AtomicU32::new(0);
    let number = NEXT.fetch_add(1, Ordering::Relaxed);
    let directory = env::temp_dir().join(format!("firmware-demo-{}-{number}", process::id()));
    fs::create_dir_all(&directory)?;
    Ok(directory)
}

/// Reads the console to its end; bounded, so that a firmware gone wild cannot fill the memory.
fn gather(pipe: Option<impl Read>) -> String {
    let mut bytes = std::vec::Vec::new();
    if let Some(pipe) = pipe {
        // What was read before a failure is still worth showing.
        let _ = pipe.take(1 << 20).read_to_end(&mut bytes);
    }
    String::from_utf8_lossy(&bytes).into_owned()
}
