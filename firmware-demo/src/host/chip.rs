//! A controller on an emulated chip, as if it were a local one.

use std::boxed::Box;
use std::error::Error;
use std::fmt::{self, Display, Formatter};
use std::path::{Path, PathBuf};
use std::time::Duration;

use controller_core::paper::demand::Demand;
use controller_core::paper::params::Params;
use controller_core::reference::Reference;
use controller_core::types::Measured;

use super::{
    AnyLink, BuildError, Emulator, EmulatorError, EmulatorOutcome, Image, Options, Session,
    SessionError, build_image,
};
use protocol::pil::{Answer, Question, Refusal, Ticked};
use protocol::{Counters, RejectReason};

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
    Unexpected(Box<Answer>),
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
            Self::Unexpected(answer) => write!(f, "unexpected answer of the chip: {answer:?}"),
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
pub struct Chip {
    session: Session<AnyLink, Answer>,
    emulator: Emulator,
    image: PathBuf,
    patience: Duration,
}

impl Chip {
    /// Builds the firmware, with the proof that it cannot panic, and starts it.
    ///
    /// # Errors
    ///
    /// When the build, the emulator or the link fails.
    pub fn start(options: &Options) -> Result<Self, ChipError> {
        let image = build_image(&Image {
            machine: options.machine,
            bin: "pil",
            features: "panic-proof",
        })?;
        Self::start_image(&image, options)
    }

    /// Starts an image that was built before, and greets it.
    ///
    /// # Errors
    ///
    /// When the emulator or the link fails.
    pub fn start_image(image: &Path, options: &Options) -> Result<Self, ChipError> {
        let (emulator, link) = Emulator::start(image, options)?;
        let mut chip = Self {
            session: Session::new(link.ok_or(ChipError::NoLink)?),
            emulator,
            image: image.to_path_buf(),
            patience: options.silence,
        };
        match chip.ask(&Question::Hello)? {
            Answer::Hello(_) => Ok(chip),
            other => Err(unexpected(other)),
        }
    }

    /// The image that runs.
    pub fn image(&self) -> &Path {
        &self.image
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

    fn ask(&mut self, question: &Question) -> Result<Answer, ChipError> {
        Ok(self.session.ask(question)?)
    }
}

#[cold]
fn unexpected(answer: Answer) -> ChipError {
    match answer {
        Answer::Refused(refusal) => ChipError::Refused(refusal),
        Answer::Nack(reason) => ChipError::Rejected(reason),
        other => ChipError::Unexpected(Box::new(other)),
    }
}
