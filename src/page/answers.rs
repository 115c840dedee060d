//! What a page asks about its frame, answered by the code that the program itself uses.
//!
//! A page contains the files of its capture folder and this module as WebAssembly (`page.wasm`, made of
//! `src/page/module.rs`). Questions and answers are JSON.

use crate::capture::disk::{self, CaptureError, MemoryFiles};
use crate::capture::{Capture, Step};
use crate::history::{FragmentOutcome, Ladder, PixelDocument, PixelEvent, PixelHistory, TestResult, Verdict};
use crate::plan::{DecidedBy, FramePlan};
use crate::reading::capture_point::CapturePoint;
use crate::reading::history_row::{EventOutcome, HistoryCells, short};
use crate::reading::map_decision::{ComparedTexel, MapDecision};
use crate::reading::map_readers::{MapReaders, MapTexel};
use crate::reading::{moment, projected, shadow_casters};
use serde::{Deserialize, Serialize};
use std::cell::OnceCell;
use std::sync::Arc;

/// The frame of a page, read from its files.
#[derive(Debug)]
pub struct PageFrame {
    capture: Capture,
    plan: Arc<FramePlan>,
    /// For each light, which texels of its shadow map the pixels read; found when it is first asked for.
    readers: Vec<OnceCell<Option<MapReaders>>>,
}

/// Why a question has no answer.
#[derive(Debug, thiserror::Error)]
pub enum PageQuestionError {
    /// It is not one of the questions.
    #[error("no such question: {0}")]
    Question(#[from] serde_json::Error),
    /// The pixel is not in the picture.
    #[error("no pixel {}, {} in a picture of {}x{}", .pixel[0], .pixel[1], .size[0], .size[1])]
    NoSuchPixel {
        /// Column and row.
        pixel: [u32; 2],
        /// Width and height of the picture.
        size: [u32; 2],
    },
}

/// A question of the page: `{"pixel": [3, 4]}`.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum PageQuestion {
    /// What happened to a pixel, and why each light arrives or not.
    Pixel([u32; 2]),
    /// Which pixels read a texel of a light's shadow map.
    Readers { light: usize, face: usize, at: [u32; 2] },
}

/// A pixel's history and what follows for each light.
#[derive(Debug, Serialize)]
struct PagePixel {
    /// What `pixel --json` prints.
    history: PixelDocument,
    /// The events as the window's table shows them.
    rows: Vec<PageRow>,
    lights: Vec<PageLightAnswer>,
}

/// A row of the table of events.
#[derive(Debug, Serialize)]
struct PageRow {
    pass: usize,
    part: Option<&'static str>,
    what: String,
    side: &'static str,
    #[serde(flatten)]
    outcome: PageOutcome,
    change: String,
    /// It changes nothing and adds nothing to the picture.
    is_idle: bool,
    /// The triangle's outline in pixels.
    outline: Vec<[f64; 2]>,
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "kebab-case", tag = "outcome")]
enum PageOutcome {
    Cleared,
    Tested { depth: &'static str, stencil: &'static str, operation: &'static str },
    Nothing { why: &'static str, note: Option<&'static str> },
}

#[derive(Debug, Serialize)]
struct PageLightAnswer {
    /// In whose shadow the pixel is; null where it is in none, or its history does not tell.
    whose: Option<String>,
    /// For each step, the verdict as it is read beside the values after each of its draws, and last after all of them.
    titles: Vec<Vec<String>>,
    reason: String,
    ladder: Option<PageLadder>,
    /// The texels of its shadow map that the pixel is compared with; null where none decides.
    compared: Option<PageCompared>,
}

/// The faces of a light's volumes along the view ray; distances in the scene's unit, null at infinity.
#[derive(Debug, Serialize)]
struct PageLadder {
    surface: Option<f64>,
    is_from_infinity: bool,
    start: i32,
    count: i32,
    rungs: Vec<PageRung>,
}

#[derive(Debug, Serialize)]
struct PageRung {
    event: usize,
    distance: Option<f64>,
    added: i32,
    running: i32,
}

#[derive(Debug, Serialize)]
struct PageCompared {
    face: usize,
    texels: Vec<PageTexel>,
}

#[derive(Debug, Serialize)]
struct PageTexel {
    at: [u32; 2],
    /// The stored depth; null where no caster was drawn.
    stored: Option<f32>,
    surface: f32,
    is_lit: bool,
}

impl PageFrame {
    /// Reads a frame from the files of a capture folder. Fails where they are not whole or contradict each other, and
    /// where there is no plan.
    pub fn read(files: &MemoryFiles) -> Result<PageFrame, CaptureError> {
        let (capture, plan) = disk::read_memory(files)?;
        let lacks_plan = || CaptureError::Read { file: "frame.json".into(), reason: "it is not there".to_owned() };
        let plan = plan.ok_or_else(lacks_plan)?;
        let readers = capture.lights.iter().map(|_| OnceCell::new()).collect();
        Ok(PageFrame { capture, plan: Arc::new(plan), readers })
    }

    /// Answers a question, both as JSON: `{"pixel": [column, row]}`, or `{"readers": {"light": 0, "face": 0, "at":
    /// [column, row]}}`, whose answer is a list of pixels.
    pub fn answer(&self, question: &str) -> Result<String, PageQuestionError> {
        let answer = match serde_json::from_str(question)? {
            PageQuestion::Pixel(pixel) => serde_json::to_string(&self.pixel(pixel)?),
            PageQuestion::Readers { light, face, at } => {
                let texel = MapTexel { face, at };
                let pixels = self.readers(light).map(|readers| readers.of_texel(texel));
                serde_json::to_string(&pixels)
            }
        };
        Ok(answer?)
    }

    fn pixel(&self, pixel: [u32; 2]) -> Result<PagePixel, PageQuestionError> {
        let size = self.capture.size;
        if pixel[0] >= size[0] || pixel[1] >= size[1] {
            return Err(PageQuestionError::NoSuchPixel { pixel, size });
        }
        let history = PixelHistory::without_gpu(&self.plan, &self.capture, pixel);
        Ok(PagePixel {
            rows: history.events.iter().map(|event| self.row(&history, event)).collect(),
            lights: (0..self.capture.lights.len()).map(|light| self.light(&history, light)).collect(),
            history: PixelDocument::new(&history, 0.0),
        })
    }

    fn row(&self, history: &PixelHistory, event: &PixelEvent) -> PageRow {
        let cells = HistoryCells::of(history, event, &self.capture);
        let HistoryCells { part, what, of, side, outcome, change, .. } = cells;
        let outline = projected::outline(&self.plan, event);
        PageRow {
            pass: event.pass,
            part: part.map(|part| part.name()),
            what: if of.is_empty() { what } else { format!("{what} of {of}") },
            side,
            outcome: outcome_of(outcome, event.triangle().map(|one| one.outcome)),
            change,
            is_idle: !event.does_something(),
            outline: outline.into_iter().map(|at| at.to_array().map(to_hundredths)).collect(),
        }
    }

    fn light(&self, history: &PixelHistory, light: usize) -> PageLightAnswer {
        let readers = self.readers(light);
        let decision = readers.and_then(|readers| MapDecision::of(&self.capture, readers, light, history.pixel));
        let mut verdict = Verdict::of(&self.capture, light, history.pixel).with_history(history);
        if let Some(decision) = &decision {
            verdict = verdict.with_texels(light, || decision.sentence());
        }
        let casters = match verdict.is_in_shadow() && history.agrees() {
            true => shadow_casters::casters(history, light, &self.capture.depth),
            false => Vec::new(),
        };
        let titles = |(index, step): (usize, &Step)| {
            let draws = (0..step.draws.len()).map(Some).chain([None]);
            let points = draws.map(|draw| CapturePoint { step: index, draw });
            points.map(|point| moment::title(&verdict, &self.capture, point, history.pixel)).collect()
        };
        PageLightAnswer {
            whose: shadow_casters::sentence(&casters, self.capture.finding_at(light, history.pixel)),
            titles: self.capture.steps.iter().enumerate().map(titles).collect(),
            reason: verdict.reason(),
            ladder: history.ladder(light, &self.capture.depth).as_ref().map(ladder),
            compared: decision.map(|decision| PageCompared {
                face: decision.middle.texel.face,
                texels: decision.compared.iter().map(texel).collect(),
            }),
        }
    }

    /// Returns which texels of a light's shadow map the pixels read; `None` where no map decides, or another program
    /// drew the frame.
    fn readers(&self, light: usize) -> Option<&MapReaders> {
        let find = || {
            let is_known = self.capture.origin.is_none() && self.capture.decided_by(light) == DecidedBy::Map;
            is_known.then(|| MapReaders::of_own(&self.capture, Some(&self.plan), light)).flatten()
        };
        self.readers.get(light)?.get_or_init(find).as_ref()
    }
}

fn outcome_of(outcome: EventOutcome, of_triangle: Option<FragmentOutcome>) -> PageOutcome {
    match outcome {
        EventOutcome::Cleared => PageOutcome::Cleared,
        EventOutcome::Tested { depth, stencil, operation } => {
            PageOutcome::Tested { depth: word(depth), stencil: word(stencil), operation: operation.map_or("", short) }
        }
        EventOutcome::Nothing(why) => PageOutcome::Nothing { why, note: of_triangle.and_then(FragmentOutcome::note) },
    }
}

fn word(test: TestResult) -> &'static str {
    match test {
        TestResult::Passed => "passed",
        TestResult::Failed => "failed",
        TestResult::Always => "always",
        TestResult::NotReached => "not-reached",
    }
}

fn ladder(ladder: &Ladder) -> PageLadder {
    let rung = |rung: &crate::history::Rung| PageRung {
        event: rung.event,
        distance: rung.distance.is_finite().then_some(rung.distance),
        added: rung.added,
        running: rung.running,
    };
    PageLadder {
        surface: ladder.surface,
        is_from_infinity: ladder.is_from_infinity(),
        start: ladder.start,
        count: ladder.count,
        rungs: ladder.rungs.iter().map(rung).collect(),
    }
}

fn texel(one: &ComparedTexel) -> PageTexel {
    let stored = one.is_caster.then_some(one.stored);
    PageTexel { at: one.texel.at, stored, surface: one.depth, is_lit: one.is_lit }
}

/// Returns a place in pixels in as many digits as can be seen.
fn to_hundredths(place: f64) -> f64 {
    (place * 100.0).round() / 100.0
}
