//! A controller on an emulated chip, as if it were a local one.

use std::error::Error;
use std::fmt::{self, Display, Formatter};
use std::format;
use std::path::{Path, PathBuf};
use std::string::String;
use std::time::Duration;
use std::vec::Vec;

use controller_core::base::{BaseParams, Sensed};
use controller_core::paper::demand::Demand;
use controller_core::paper::params::Params;
use controller_core::reference::Reference;
use controller_core::types::{Measured, Pose};
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::{
    AnyLink, BuildError, Emulator, EmulatorError, EmulatorOutcome, Image, Options, Session,
    SessionError, build_image,
};
use protocol::pil::{
    Answer, BaseAnswer, BaseInput, BasePart, BaseQuestion, BaseTicked, BoardAnswer, BoardQuestion,
    LineBytes, Question, Refusal, Ticked, WheelOutput,
};
use protocol::{Command, Counters, RejectReason};

/// Why the chip did not answer as it should.
#[derive(Debug)]
#[non_exhaustive]
pub enum ChipError {
    /// The firmware does not build.
    Build(BuildError),
    /// The emulator does not start or end.
    Emulator(EmulatorError),
    /// The link failed.
    Session(SessionError),
    /// The controller refused the start or the tick; its state is unchanged.
    Refused(Refusal),
    /// The firmware refused the command; nothing changed.
    Rejected(RejectReason),
    /// The options name no link.
    NoLink,
    /// An answer to another question than was asked.
    Unexpected(String),
}

impl Display for ChipError {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Build(error) => error.fmt(f),
            Self::Emulator(error) => error.fmt(f),
            Self::Session(error) => error.fmt(f),
            Self::Refused(refusal) => write!(f, "the controller on the chip refused: {refusal}"),
            Self::Rejected(reason) => write!(f, "the firmware refused the command: {reason}"),
            Self::NoLink => f.write_str("the emulator was started without a link"),
            Self::Unexpected(answer) => write!(f, "unexpected answer of the chip: {answer}"),
        }
    }
}

impl Error for ChipError {}

impl From<BuildError> for ChipError {
    fn from(error: BuildError) -> Self {
        Self::Build(error)
    }
}

impl From<EmulatorError> for ChipError {
    fn from(error: EmulatorError) -> Self {
        Self::Emulator(error)
    }
}

impl From<SessionError> for ChipError {
    fn from(error: SessionError) -> Self {
        Self::Session(error)
    }
}

/// An emulated chip that runs the processor-in-the-loop firmware. Dropping it ends the emulator.
///
/// ```no_run
/// use std::time::Duration;
/// use controller_core::paper::demand::Demand;
/// use controller_core::maths::Single;
/// use controller_core::paper::params::Params;
/// use controller_core::reference::Reference;
/// use controller_core::types::{Measured, Pose};
/// use firmware_demo::host::{Chip, LinkKind, Machine, Options};
///
/// let mut chip = Chip::start(&Options {
///     machine: Machine::CortexM4F,
///     link: LinkKind::Fifo,
///     icount: true,
///     core: None,
///     silence: Duration::from_secs(5),
/// })?;
/// let reference = Reference::at_rest(Pose::default());
/// let measured = Measured::default();
/// chip.configure(&Params::paper())?;
/// chip.begin(&reference, &measured)?;
/// let ticked = chip.tick(0.001, &Demand::Track(reference), &measured)?;
/// println!("{} N m, {} instructions", ticked.report.torques.right, ticked.instructions);
/// println!("{} bytes of stack", chip.counters()?.stack_bytes);
/// chip.finish()?;
/// # Ok::<(), firmware_demo::host::ChipError>(())
/// ```
pub struct ChipLink<A> {
    session: Session<AnyLink, A>,
    emulator: Emulator,
    image: PathBuf,
    patience: Duration,
}

/// An emulated chip that has the paper's law.
pub type Chip = ChipLink<Answer>;

/// An emulated chip that has the whole base.
pub type BaseChip = ChipLink<BaseAnswer>;

/// An emulated chip that has the whole firmware, its line included.
pub type BoardChip = ChipLink<BoardAnswer>;

impl<A: DeserializeOwned + fmt::Debug> ChipLink<A> {
    /// The image that runs.
    pub fn image(&self) -> &Path {
        &self.image
    }

    /// Builds a program of the firmware, with the proof that it cannot panic, and starts it.
    fn build(bin: &str, options: &Options) -> Result<Self, ChipError> {
        let image = build_image(&Image {
            machine: options.machine,
            bin,
            features: "panic-proof",
        })?;
        Self::launch(&image, options)
    }

    fn launch(image: &Path, options: &Options) -> Result<Self, ChipError> {
        let (emulator, link) = Emulator::start(image, options)?;
        Ok(Self {
            session: Session::new(link.ok_or(ChipError::NoLink)?),
            emulator,
            image: image.to_path_buf(),
            patience: options.silence,
        })
    }

    fn ask(&mut self, question: &impl Serialize) -> Result<A, ChipError> {
        Ok(self.session.ask(question)?)
    }
}

impl Chip {
    /// Builds the firmware of the paper's law and starts it.
    ///
    /// # Errors
    ///
    /// When the build, the emulator or the link fails.
    pub fn start(options: &Options) -> Result<Self, ChipError> {
        Self::build("pil", options)?.greeted()
    }

    /// Starts an image that was built before, and greets it.
    ///
    /// # Errors
    ///
    /// When the emulator or the link fails.
    pub fn start_image(image: &Path, options: &Options) -> Result<Self, ChipError> {
        Self::launch(image, options)?.greeted()
    }

    fn greeted(mut self) -> Result<Self, ChipError> {
        match self.ask(&Question::Hello)? {
            Answer::Hello(_) => Ok(self),
            other => Err(unexpected(other)),
        }
    }

    /// Sets the parameters of the next controller; a running one keeps its own.
    ///
    /// # Errors
    ///
    /// [`ChipError::Rejected`] when the chip finds a parameter out of its range, or a failed link.
    pub fn configure(&mut self, params: &Params<f32>) -> Result<(), ChipError> {
        match self.ask(&Question::Configure(params.into()))? {
            Answer::Ack => Ok(()),
            other => Err(unexpected(other)),
        }
    }

    /// Starts a controller, as `NeuralController::start` does.
    ///
    /// # Errors
    ///
    /// [`ChipError::Refused`] as `start`, or a failed link.
    pub fn begin(
        &mut self,
        reference: &Reference<f32>,
        measured: &Measured<f32>,
    ) -> Result<Ticked, ChipError> {
        let (reference, measured) = (reference.into(), measured.into());
        self.ticked(&Question::Begin {
            reference,
            measured,
        })
    }

    /// One tick, as `NeuralController::step` does.
    ///
    /// # Errors
    ///
    /// [`ChipError::Refused`] as `step`, [`ChipError::Rejected`] when no controller was started, or a failed
    /// link.
    pub fn tick(
        &mut self,
        dt: f32,
        demand: &Demand<f32>,
        measured: &Measured<f32>,
    ) -> Result<Ticked, ChipError> {
        let (demand, measured) = (demand.into(), measured.into());
        self.ticked(&Question::Tick {
            dt,
            demand,
            measured,
        })
    }

    /// Frames, and the stack's high-water mark.
    ///
    /// # Errors
    ///
    /// A failed link.
    pub fn counters(&mut self) -> Result<Counters, ChipError> {
        match self.ask(&Question::GetCounters)? {
            Answer::Counters(counters) => Ok(counters),
            other => Err(unexpected(other)),
        }
    }

    /// Stops the firmware and waits for the emulator's end.
    ///
    /// # Errors
    ///
    /// A failed link, or an emulator that does not end.
    pub fn finish(mut self) -> Result<EmulatorOutcome, ChipError> {
        match self.ask(&Question::Stop)? {
            Answer::Ack => Ok(self.emulator.finish(self.patience)?),
            other => Err(unexpected(other)),
        }
    }

    fn ticked(&mut self, question: &Question) -> Result<Ticked, ChipError> {
        match self.ask(question)? {
            Answer::Report(report) => Ok((&report).into()),
            other => Err(unexpected(other)),
        }
    }
}

impl BaseChip {
    /// Builds the firmware of the whole base and starts it.
    ///
    /// # Errors
    ///
    /// When the build, the emulator or the link fails.
    pub fn start(options: &Options) -> Result<Self, ChipError> {
        let mut chip = Self::build("base_pil", options)?;
        match chip.ask(&BaseQuestion::Hello)? {
            BaseAnswer::Hello(_) => Ok(chip),
            other => Err(unexpected_base(other)),
        }
    }

    /// Puts a disarmed base with these parameters in the place of the one before.
    ///
    /// # Errors
    ///
    /// [`ChipError::Rejected`] when the chip refuses the parameters, or a failed link.
    pub fn begin(&mut self, params: &BaseParams<f32>, start: Pose<f32>) -> Result<(), ChipError> {
        for part in BasePart::all(params) {
            self.done(&BaseQuestion::Configure(part))?;
        }
        self.done(&BaseQuestion::Begin { start })
    }

    /// A command of the field protocol.
    ///
    /// # Errors
    ///
    /// [`ChipError::Rejected`] when the base refuses it, or a failed link.
    pub fn command(&mut self, command: &Command) -> Result<(), ChipError> {
        self.done(&BaseQuestion::Command(*command))
    }

    /// The timer's interrupt.
    ///
    /// # Errors
    ///
    /// A failed link, or no base was begun.
    pub fn tick(&mut self, input: &BaseInput) -> Result<BaseTicked, ChipError> {
        match self.ask(&BaseQuestion::Tick(*input))? {
            BaseAnswer::Ticked(ticked) => Ok(ticked),
            other => Err(unexpected_base(other)),
        }
    }

    /// Frames, and the stack's high-water mark.
    ///
    /// # Errors
    ///
    /// A failed link.
    pub fn counters(&mut self) -> Result<Counters, ChipError> {
        match self.ask(&BaseQuestion::GetCounters)? {
            BaseAnswer::Counters(counters) => Ok(counters),
            other => Err(unexpected_base(other)),
        }
    }

    /// Stops the firmware and waits for the emulator's end.
    ///
    /// # Errors
    ///
    /// A failed link, or an emulator that does not end.
    pub fn finish(mut self) -> Result<EmulatorOutcome, ChipError> {
        self.done(&BaseQuestion::Stop)?;
        Ok(self.emulator.finish(self.patience)?)
    }

    fn done(&mut self, question: &BaseQuestion) -> Result<(), ChipError> {
        match self.ask(question)? {
            BaseAnswer::Ack => Ok(()),
            other => Err(unexpected_base(other)),
        }
    }
}

impl BoardChip {
    /// Builds the whole firmware and starts it.
    ///
    /// # Errors
    ///
    /// When the build, the emulator or the link fails.
    pub fn start(options: &Options) -> Result<Self, ChipError> {
        Self::build("board_pil", options)
    }

    /// Starts the base with these parameters, disarmed; one report of `decimate` goes to its line. Once for each chip.
    ///
    /// # Errors
    ///
    /// [`ChipError::Rejected`] when the chip refuses the parameters, or a failed link.
    pub fn begin(
        &mut self,
        params: &BaseParams<f32>,
        start: Pose<f32>,
        decimate: u16,
    ) -> Result<(), ChipError> {
        for part in BasePart::all(params) {
            self.done(&BoardQuestion::Configure(part))?;
        }
        self.done(&BoardQuestion::Begin { start, decimate })
    }

    /// Bytes for its line.
    ///
    /// # Errors
    ///
    /// A failed link, or no base was begun.
    pub fn receive(&mut self, bytes: &[u8]) -> Result<(), ChipError> {
        for bytes in bytes.chunks(LineBytes::MOST) {
            let bytes = LineBytes::of(bytes.iter().copied());
            self.done(&BoardQuestion::Receive(bytes))?;
        }
        Ok(())
    }

    /// The timer's interrupt: what acts on the wheels from now on, and the bytes that came out of its line.
    ///
    /// # Errors
    ///
    /// A failed link, or no base was begun.
    pub fn tick(
        &mut self,
        now_us: u32,
        sensed: &Sensed<f32>,
    ) -> Result<(WheelOutput, Vec<u8>), ChipError> {
        let sensed = *sensed;
        let (output, waiting) = match self.ask(&BoardQuestion::Tick { now_us, sensed })? {
            BoardAnswer::Ticked { output, waiting } => (output, usize::from(waiting)),
            other => return Err(unexpected_board(other)),
        };
        let mut bytes = Vec::new();
        while bytes.len() < waiting {
            match self.ask(&BoardQuestion::Send)? {
                BoardAnswer::Sent(more) if !more.as_slice().is_empty() => {
                    bytes.extend(more.as_slice());
                }
                other => return Err(unexpected_board(other)),
            }
        }
        Ok((output, bytes))
    }

    /// Stops the firmware and waits for the emulator's end.
    ///
    /// # Errors
    ///
    /// A failed link, or an emulator that does not end.
    pub fn finish(mut self) -> Result<EmulatorOutcome, ChipError> {
        self.done(&BoardQuestion::Stop)?;
        Ok(self.emulator.finish(self.patience)?)
    }

    fn done(&mut self, question: &BoardQuestion) -> Result<(), ChipError> {
        match self.ask(question)? {
            BoardAnswer::Ack => Ok(()),
            other => Err(unexpected_board(other)),
        }
    }
}

#[cold]
fn unexpected_board(answer: BoardAnswer) -> ChipError {
    match answer {
        BoardAnswer::Nack(reason) => ChipError::Rejected(reason),
        other => ChipError::Unexpected(format!("{other:?}")),
    }
}

#[cold]
fn unexpected_base(answer: BaseAnswer) -> ChipError {
    match answer {
        BaseAnswer::Nack(reason) => ChipError::Rejected(reason),
        other => ChipError::Unexpected(format!("{other:?}")),
    }
}

#[cold]
fn unexpected(answer: Answer) -> ChipError {
    match answer {
        Answer::Refused(refusal) => ChipError::Refused(refusal),
        Answer::Nack(reason) => ChipError::Rejected(reason),
        other => ChipError::Unexpected(format!("{other:?}")),
    }
}
