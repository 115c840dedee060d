//! Frames and their pages.

use serde_json::Value;
use std::path::PathBuf;
use std::sync::Arc;
use stencilscope::capture::disk::WholeFrame;
use stencilscope::capture::{Image, PixelFormat, Snapshot};
use stencilscope::history::PixelDocument;
use stencilscope::page;
use stencilscope::progress::Progress;
use stencilscope::scene::{OpenSpec, Scene, TechniqueRequest, open};
use stencilscope::session::{CaptureRequest, RunFrame, Session, SnapshotInterval};
use stencilscope::technique::Choice;
use tempfile::TempDir;

/// A frame and its page.
pub struct Made {
    pub frame: RunFrame,
    pub folder: TempDir,
    session: Session,
}

impl Made {
    fn new(frame: RunFrame, session: Session) -> Made {
        let folder = tempfile::tempdir().expect("a folder");
        page::write(&frame.capture, &frame.plan, None, &folder.path().join("page.html")).expect("a page");
        Made { frame, session, folder }
    }

    /// The page of a scene's frame, with a state after every draw.
    pub fn of_scene(scene: Scene, technique: &str, settings: &[(&str, &str)], size: [u32; 2]) -> Made {
        let settings = settings.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        let choice = Choice::parse(&TechniqueRequest { name: technique.to_owned(), settings }).expect("a choice");
        let mut session = Session::new(None).expect("the reference adapter");
        let request = CaptureRequest { every: SnapshotInterval::Draw, ..CaptureRequest::new(choice, size) };
        Made::new(session.render(scene, request).expect("a frame"), session)
    }

    /// The page of a frame that was captured, here or by another program.
    pub fn of_folder(whole: WholeFrame) -> Made {
        let frame = RunFrame::from_folder(whole).expect("a whole frame");
        Made::new(frame, Session::new(None).expect("the reference adapter"))
    }

    /// The page of the same frame with its ground truth.
    pub fn judged(mut self) -> Made {
        let scene = self.frame.scene().expect("a scene").clone();
        let judged = self.session.judged(&scene, &self.frame.capture, &Progress::default()).expect("the truth");
        self.frame.capture = Arc::new(judged);
        Made::new(self.frame, self.session)
    }

    /// Turns over the lowest bit of the stencil that was stored at a pixel after the second pass.
    pub fn change_stencil(&mut self, pixel: [u32; 2]) {
        let mut capture = (*self.frame.capture).clone();
        let Snapshot::Frame(frame) = &mut capture.steps[1].snapshot else { panic!("a frame") };
        let stencil = frame.stencil.as_mut().expect("a stencil");
        let mut bytes: Vec<u8> = stencil.image.rows().flatten().copied().collect();
        let size = stencil.image.size();
        bytes[(pixel[1] * size[0] + pixel[0]) as usize] ^= 1;
        stencil.image = Arc::new(Image::packed(PixelFormat::U8, size, bytes));
        page::write(&capture, &self.frame.plan, None, &self.page()).expect("a page");
    }

    pub fn page(&self) -> PathBuf {
        self.folder.path().join("page.html")
    }

    /// What `pixel --json` prints of a pixel.
    pub fn document(&mut self, pixel: [u32; 2]) -> Value {
        let history = self.session.history(&self.frame.plan, &self.frame.capture, pixel).expect("a history");
        serde_json::to_value(PixelDocument::new(&history, 0.0)).expect("JSON")
    }
}

pub fn scene(name: &str) -> Scene {
    open(&OpenSpec::new(name)).expect("a scene")
}

pub fn tori() -> Made {
    Made::of_scene(scene("tori"), "z-fail", &[], [640, 480])
}

/// Spread over a picture: the same on every machine.
pub fn pixels(count: u32, size: [u32; 2]) -> Vec<[u32; 2]> {
    // Steps that fill a square evenly (Roberts 2018, "The unreasonable effectiveness of quasirandom sequences").
    let place = |index: u32, step: f64, side: u32| ((0.5 + f64::from(index) * step).fract() * f64::from(side)) as u32;
    (0..count).map(|index| [place(index, 0.754_877_666_2, size[0]), place(index, 0.569_840_291, size[1])]).collect()
}
