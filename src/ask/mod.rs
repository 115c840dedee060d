//! Questions about a frame or a scene, and their answers: as data.
//!
//! A capture never changes. What is learned of it later, its truth, the history of a pixel, why it is wrong, is the
//! answer to a question, and all questions go one way:
//!
//! ```text
//! panel ─ want(History { at }) ─► Answers ─ take_asked ─► Asked ─► queue, by priority ─► Session::answer
//!   ▲                                │ ▲                                                      │
//!   └── Reply: ready, older, how far ┘ └───────────── answer(ticket, Result<Answer, String>) ─┘
//! ```
//!
//! A new question is an entry in the table below, an arm of [`Session::answer`](crate::session::Session::answer), and
//! the panel that wants it. [`QuestionKind`] says how it is treated, by default as most are.

mod answers;
mod run_request;

pub use answers::{Answers, PendingQuestion, Reply};
pub use run_request::{CarriedOver, ObjectChanges, RunRequest, without};

use crate::anatomy::Anatomy;
use crate::capture::{Capture, FrameTruth, StepDraws, Timing};
use crate::diagnosis::Diagnosis;
use crate::diagnosis::frame_causes::FrameDiagnosis;
use crate::history::PixelHistory;
use crate::plan::{FramePlan, LightChannel};
use crate::reading::light_rays::LightRay;
use crate::reading::{MapReaders, ObjectMesh, TestOutcomes};
use crate::report::MeasuredReport;
use crate::scene::{Mesh, Walls};
use crate::stress::StressRows;
use crate::technique::{Choice, ChoiceError};
use std::collections::BTreeSet;
use std::sync::Arc;

/// A question of one kind, with the type of its answer.
pub trait Question: Clone + Into<Ask> {
    /// The type of the question's answer.
    type Answer;
    /// The kind of questions of this type.
    const KIND: QuestionKind;
    /// Returns the question in `ask`; `None` where it is of another kind.
    fn of(ask: &Ask) -> Option<&Self>;
    /// Returns the content of `answer`; `None` where it answers another kind of question.
    fn answer(answer: &Answer) -> Option<&Arc<Self::Answer>>;
    /// Wraps an answer to this kind of question as an [`Answer`].
    fn into_answer(answer: Arc<Self::Answer>) -> Answer;
}

macro_rules! questions {
    ($($(#[$doc:meta])* $name:ident { $($(#[$field_doc:meta])* $field:ident: $type:ty),* } -> $answer:ty;)*) => {
        $(
            $(#[$doc])*
            #[derive(Debug, Clone, PartialEq)]
            pub struct $name { $($(#[$field_doc])* pub $field: $type),* }

            impl Question for $name {
                type Answer = $answer;
                const KIND: QuestionKind = QuestionKind::$name;

                fn of(ask: &Ask) -> Option<&$name> {
                    if let Ask::$name(question) = ask { Some(question) } else { None }
                }

                fn answer(answer: &Answer) -> Option<&Arc<$answer>> {
                    if let Answer::$name(answer) = answer { Some(answer) } else { None }
                }

                fn into_answer(answer: Arc<$answer>) -> Answer {
                    Answer::$name(answer)
                }
            }

            impl From<$name> for Ask {
                fn from(question: $name) -> Ask {
                    Ask::$name(question)
                }
            }
        )*

        /// A question of any kind, with what it asks about.
        #[derive(Debug, Clone, PartialEq)]
        pub enum Ask { $($(#[$doc])* $name($name)),* }

        /// An answer to a question of any kind, in the variant of the question's name.
        #[derive(Debug, Clone)]
        pub enum Answer { $($(#[$doc])* $name(Arc<$answer>)),* }

        /// The kinds of questions, the most urgent first.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
        pub enum QuestionKind { $($(#[$doc])* $name),* }

        impl QuestionKind {
            /// Lists all kinds in the order in which the worker answers waiting questions: the first is answered first.
            pub const ALL: &[QuestionKind] = &[$(QuestionKind::$name),*];
        }

        impl Ask {
            /// Returns the question's kind.
            pub fn kind(&self) -> QuestionKind {
                match self { $(Ask::$name(_) => QuestionKind::$name),* }
            }
        }
    };
}

questions! {
    /// The walls of the scene as it would be run, which can't be walked through.
    WallsOf { /// Objects that are switched off, by index.
        off: BTreeSet<usize>,
        /// Changes of the objects.
        objects: ObjectChanges,
        /// The time, seconds; 0 where nothing moves.
        time: f64 } -> Walls;
    /// The states after the draws of a step.
    DrawsOf { /// Index of the step.
        step: usize } -> StepDraws;
    /// The history of a pixel.
    HistoryOf { /// Column and row.
        at: [u32; 2] } -> PixelHistory;
    /// What the ray from each light to a pixel's surface meets, in truth.
    RaysOf { /// Column and row.
        at: [u32; 2] } -> Vec<LightRay>;
    /// The geometry of the frame in world space.
    AnatomyOf { } -> Anatomy;
    /// The results of the tests on the fragments of a step, or of one of its draws.
    TestsOf { /// Index of the step.
        step: usize,
        /// Index of the draw; `None`: all draws of the step.
        draw: Option<usize> } -> TestOutcomes;
    /// Which texel of a light's shadow map each pixel reads.
    ReadersOf { /// Index of the light.
        light: usize } -> MapReaders;
    /// The frame with one channel of its light alone.
    ChannelOf { /// The channel.
        channel: LightChannel } -> Capture;
    /// A capture of the open scene, run another way than the frame that is shown.
    CaptureOf { /// How it is run.
        request: Box<RunRequest>,
        /// Whether it is held against the truth.
        is_judged: bool,
        /// Index of the step whose states after draws are captured, too; `None`: of none.
        draws_of: Option<usize> } -> Capture;
    /// The topology of each object's mesh.
    MeshesOf { /// Objects that are new, after those of the scene, with their meshes.
        added: Vec<(String, Arc<Mesh>)> } -> Vec<ObjectMesh>;
    /// The ground truth, and how the technique differs from it.
    TruthOf { } -> FrameTruth;
    /// Where the frame is wrong, why, and how to fix it.
    DiagnosisOf { /// How the scene was to be run when it was asked: it is about no later state of it.
        request: Box<RunRequest> } -> Diagnosis;
    /// Where another program's frame is wrong and why, with the proof.
    FaultsOf { } -> FrameDiagnosis;
    /// Every technique measured on the open scene.
    ReportOf { /// Techniques with their settings.
        choices: Vec<Choice>,
        /// How many frames of each are timed.
        runs: usize } -> MeasuredReport;
    /// A film of the frame, written into a file that may be replaced.
    FilmOf { /// What it shows.
        subject: FilmSubject,
        /// The file.
        path: String,
        /// The pixel that is marked in each picture, if any.
        pick: Option<[u32; 2]> } -> Filmed;
    /// The results of stress cases.
    StressOf { /// Their names.
        cases: Vec<&'static str> } -> StressRows;
    /// How long the frame takes, with and without snapshots.
    TimingOf { } -> Timing;
}

/// The content of a film that the inspector asks for.
#[derive(Debug, Clone, PartialEq)]
pub enum FilmSubject {
    /// One frame or two side by side, from left to right, pass by pass.
    Steps(Vec<Arc<Capture>>),
    /// A light that moves once round the open scene.
    LightRound {
        /// How the scene is run: in one way, or in two side by side, of which technique and settings differ.
        sides: Vec<RunRequest>,
        /// Index of the light.
        light: usize,
    },
}

/// A film that was written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Filmed {
    /// How many pictures it has.
    pub pictures: u32,
    /// Size of the file, bytes.
    pub bytes: u64,
}

impl ReportOf {
    /// How many frames of each row of the default report are timed.
    const RUNS: usize = 3;

    /// Returns the question for a report of the default rows of techniques and settings, with three timed frames each.
    pub fn grid() -> Result<ReportOf, ChoiceError> {
        Ok(ReportOf { choices: Choice::report_grid()?, runs: ReportOf::RUNS })
    }
}

/// How long an answer is valid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AnswerLifetime {
    /// While its frame is shown.
    Frame,
    /// While its scene is open.
    Scene,
    /// Until another comes.
    Always,
}

impl QuestionKind {
    /// Returns how long an answer to a question of this kind is valid: while its scene is open for walls, captures to
    /// compare, meshes, diagnoses and reports; always for films and stress cases; otherwise only while its frame is
    /// shown.
    pub fn holds(self) -> AnswerLifetime {
        match self {
            QuestionKind::WallsOf
            | QuestionKind::CaptureOf
            | QuestionKind::MeshesOf
            | QuestionKind::DiagnosisOf
            | QuestionKind::ReportOf => AnswerLifetime::Scene,
            QuestionKind::FilmOf | QuestionKind::StressOf => AnswerLifetime::Always,
            _ => AnswerLifetime::Frame,
        }
    }

    /// Returns whether the answer about the previous frame is shown until that about the next is known. Others are
    /// dropped with their frame, and their memory is freed.
    pub fn outlives_frame(self) -> bool {
        matches!(self, QuestionKind::HistoryOf | QuestionKind::AnatomyOf)
    }

    /// Returns whether the answer about a frame is the same for one of fewer pixels: what lies in space, not what is seen of
    /// it.
    pub fn is_of_any_size(self) -> bool {
        self == QuestionKind::AnatomyOf
    }

    /// Returns whether a question of this kind takes long and is only asked when a button is pressed: diagnoses (also
    /// of other programs' frames), reports, films and stress cases.
    pub fn is_started_by_hand(self) -> bool {
        matches!(
            self,
            QuestionKind::DiagnosisOf
                | QuestionKind::FaultsOf
                | QuestionKind::ReportOf
                | QuestionKind::FilmOf
                | QuestionKind::StressOf
        )
    }

    /// Returns whether a question of this kind is about the shown frame and takes about as long as a frame: states
    /// after draws, history, rays, anatomy and test results. Long work is interrupted for it.
    pub fn is_short(self) -> bool {
        matches!(
            self,
            QuestionKind::DrawsOf
                | QuestionKind::HistoryOf
                | QuestionKind::RaysOf
                | QuestionKind::AnatomyOf
                | QuestionKind::TestsOf
        )
    }

    /// Returns whether the answer is computed from the capture and its plan, without running the frame. Frames opened
    /// from capture folders have such answers too, and no picture waits for it.
    pub fn is_read_from_capture(self) -> bool {
        self == QuestionKind::ReadersOf
    }

    /// Returns whether the question is answered only when no other question has been asked for a while.
    pub fn waits_for_quiet(self) -> bool {
        self == QuestionKind::TimingOf
    }

    /// Returns whether the next picture depends on the answer (walls, for walking): long work makes way for it. A truth
    /// that is being traced is traced again later; a diagnosis and a report are given up and must be started again by
    /// hand; films and stress cases go on after it.
    pub fn is_urgent(self) -> bool {
        self == QuestionKind::WallsOf
    }

    /// Returns whether even the tracing of a truth is interrupted for the question, and begun again after it.
    pub fn interrupts_truth(self) -> bool {
        matches!(self, QuestionKind::DrawsOf | QuestionKind::CaptureOf)
    }

    /// Returns the message for a diagnosis or a report that is stopped because another picture is asked for; `None` for
    /// the other kinds, which go on, or are asked again when they are wanted.
    pub fn stopped_by_picture(self) -> Option<&'static str> {
        match self {
            QuestionKind::DiagnosisOf => {
                Some("stopped for another picture: diagnose again when it is the one you want")
            }
            QuestionKind::ReportOf => Some("stopped for another picture: measure again when it is the one you want"),
            _ => None,
        }
    }
}

impl Ask {
    /// Describes the work on the question in a few words, for the status line; `None` where it is too quick to be shown
    /// or shows its progress itself.
    pub fn doing(&self) -> Option<String> {
        match self {
            Ask::DrawsOf(_) => Some("capturing the pass draw by draw".to_owned()),
            Ask::CaptureOf(CaptureOf { request, .. }) => {
                Some(format!("capturing {} to compare", request.choice.technique().name()))
            }
            Ask::ChannelOf(ChannelOf { channel }) => Some(format!("capturing {} light", channel.name())),
            Ask::MeshesOf(_) => Some("looking at meshes".to_owned()),
            Ask::TruthOf(_) => Some("tracing the truth".to_owned()),
            Ask::DiagnosisOf(_) | Ask::FaultsOf(_) => Some("diagnosing".to_owned()),
            Ask::ReportOf(_) => Some("measuring every technique".to_owned()),
            _ => None,
        }
    }

    /// Returns the answer, where it follows from the capture and its plan ([`QuestionKind::is_read_from_capture`]).
    ///
    /// # Errors
    /// There is none; the reason in a few words.
    pub fn read_from(&self, capture: &Capture, plan: Option<&Arc<FramePlan>>) -> Result<Answer, String> {
        match self {
            Ask::ReadersOf(ReadersOf { light }) => MapReaders::new(capture, plan, *light)
                .map(|readers| Answer::ReadersOf(Arc::new(readers)))
                .ok_or_else(|| format!("light {} has no shadow map in this frame", light + 1)),
            _ => Err("it takes a run of the frame: open its scene".to_owned()),
        }
    }
}

impl Answer {
    /// Returns the answer with the parts before it in front, for stress cases, the one kind that comes in parts; any
    /// other answer is returned as it is.
    #[must_use]
    fn after(self, before: Option<&Answer>) -> Answer {
        match (self, before) {
            (Answer::StressOf(rows), Some(Answer::StressOf(before))) => {
                Answer::StressOf(Arc::new(before.followed_by(&rows)))
            }
            (answer, _) => answer,
        }
    }
}
