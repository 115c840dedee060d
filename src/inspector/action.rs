//! The actions that panels ask the app for, and the names that occur in them. Panels change nothing outside the
//! inspector.

use crate::ask::{PendingQuestion, RunRequest};
use crate::stress::Entrant;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A request of the panels that needs files, windows or the GPU, carried out by the owner of the inspector.
#[derive(Debug, Clone, PartialEq)]
pub enum Action {
    /// Open a built-in scene by name, or a scene file, model or capture folder by path.
    Open(String),
    /// Ask for a file with the system's dialog.
    Browse,
    /// Ask for a capture folder with the system's dialog, which shows files or folders, not both.
    BrowseFolder,
    /// Render again with this request.
    Run(Arc<RunRequest>),
    /// Run whole what is shown as a preview: what was dragged has been let go.
    CompletePreview,
    /// Answer a question, with [`Inspector::answer`](super::Inspector::answer).
    Ask(PendingQuestion),
    /// Load the open scene again from its file, which changed.
    Reload,
    /// Copy a link to what is shown.
    Share,
    /// Write what is shown into a file.
    Export {
        /// What is to be exported.
        kind: ExportKind,
        /// Path of the file or folder.
        path: String,
        /// An existing file may be replaced.
        replace: bool,
    },
    /// Ask with the system's dialog where to export to.
    BrowseExport {
        /// The path so far.
        path: String,
    },
    /// Open the scene of a stress case.
    OpenStress {
        /// Name of the case.
        case: &'static str,
        /// The value of the case's number.
        value: f64,
        /// The technique and settings to use; `None`: those in use now.
        entrant: Option<Entrant>,
    },
    /// Render the open scene as for a row of the report.
    OpenReportRow {
        /// Name of the technique.
        technique: String,
        /// The row's settings.
        settings: BTreeMap<String, String>,
    },
}

/// A dialog window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DialogKind {
    /// Opens a scene.
    Open,
    /// Asks where to export to.
    Export(ExportKind),
    /// Lists all keys.
    Help,
}

named_enum! {
    /// A tab. Its name is the one in stored layouts.
    pub enum PanelKind(
        /// The text on its tab.
        title
    ) {
        /// The frame, step by step.
        Passes = "Passes" ("Passes"),
        /// The settings of technique and scene.
        Settings = "Settings" ("Scene settings"),
        /// The selected picture.
        Picture = "Picture" ("Picture"),
        /// A second camera that sees the first.
        Scene = "Scene" ("Scene"),
        /// A light's map, linked with the picture.
        ShadowMap = "ShadowMap" ("Shadow map"),
        /// Everything about the picked pixel.
        Pixel = "Pixel" ("Pixel"),
        /// The raster state of the selected draw.
        State = "State" ("State"),
        /// What the step is for, and tours.
        Explain = "Explain" ("Explain"),
        /// The stencil test by itself. The command `bench` is something else: it measures time.
        Bench = "Bench" ("Stencil test"),
        /// Error against time.
        Report = "Report" ("Report"),
        /// What is wrong, and how to fix it.
        Diagnosis = "Diagnosis" ("Diagnosis"),
        /// The stress cases.
        Stress = "Stress" ("Stress"),
    }
}

named_enum! {
    /// A layout of the panels, in the order of the menu View.
    pub enum LayoutPreset(
        /// What it is for.
        explanation
    ) {
        /// As the window opens when it was never changed.
        First = "Reset layout" ("Every panel to its first place, and everything of its usual size"),
        /// Picture and scene side by side.
        PictureAndScene = "Picture | Scene" (
            "The picture, and beside it the scene, in which a second camera sees camera, light and volumes"
        ),
        /// The picture and what it is compared with side by side.
        CompareTwo = "Compare two" (
            "Two pictures side by side, of two techniques, settings or steps, with the same pixel picked in both"
        ),
        /// For a projector.
        Teach = "Teach" ("Large type, with the picture, the picked pixel and the passes: for a projector"),
    }
}

named_enum! {
    /// Something drawn over the picture, in the order of the menu.
    pub enum Overlay(
        /// What it shows.
        meaning
    ) {
        /// The edges that bound the shadows of the shown light.
        Silhouettes = "Silhouettes" ("The edges of casters that bound their shadow, of the shown light"),
        /// The edges of its shadow volumes.
        Volumes = "Wireframe of volumes" (
            "Sides and caps of the shadow volumes that the frame draws, of the shown light"
        ),
        /// The results of the depth and stencil tests on the step's fragments.
        Tests = "Depth and stencil tests" (
            "Where fragments of the selected step pass or fail; hits of z-fail stay visible"
        ),
        /// Where objects receive shadows.
        Receivers = "Receivers" ("Where objects are darkened by shadows"),
        /// The names of casters.
        Names = "Casters' names" ("The name of each caster at the middle of what is seen of it"),
        /// Where lines along the axes of the world meet.
        Vanishing = "Vanishing points" (
            "Lines along the world's x, y and z, and the points in which they meet: 1-, 2- or 3-point perspective"
        ),
    }
}

impl Overlay {
    /// Returns whether it is drawn from the frame's geometry in space, so that the anatomy has to be known.
    pub fn needs_anatomy(self) -> bool {
        !matches!(self, Overlay::Tests | Overlay::Vanishing)
    }
}

named_enum! {
    /// What can be exported, in the order of the menu.
    pub enum ExportKind(
        /// The explanation in the menu.
        explanation
    ) {
        /// The shown picture in its colours, or what the step changed, a pixel for each texel, and beside it the one that
        /// it is compared with: PNG. Overlays are left out.
        Picture = "Shown picture (PNG)…" (
            "The shown picture in its colours, pixel by pixel; while comparing, both sides over their names"
        ),
        /// The shown picture with overlays and the compared one, at the capture's resolution: PNG.
        AsShown = "Picture with overlays (PNG)…" (
            "The shown picture with overlays, pick, legend and the compared one, whole and pixel by pixel, not as zoomed here"
        ),
        /// The shown picture's values: NumPy.
        Data = "Shown values (.npy)…" ("The shown picture's values as an array that NumPy reads"),
        /// The frame pass by pass: animated PNG.
        Steps = "Frame pass by pass (animated PNG)…" (
            "Each pass with what it writes, one after the other, over its technique and name; while comparing with \
             another technique or setting, both frames side by side"
        ),
        /// A light moving once round the scene: animated PNG.
        LightRound = "Light going round (animated PNG)…" (
            "The shown light once round the scene's vertical axis, as the scene is run now, over the technique's name; \
             while comparing, in both side by side. Colours are rounded by at most 1 of 255"
        ),
        /// The frame in one file for a browser: HTML.
        Page = "Page (HTML)…" (
            "The frame in one file that any browser opens, at this pass and pixel: steps, values, the history of every pixel"
        ),
        /// The whole capture: a folder.
        Capture = "Capture folder…" (
            "Every buffer after every pass, with a manifest, to be opened again or scripted against"
        ),
        /// The scene as it is now, with its technique: a scene file.
        Scene = "Scene file (TOML)…" ("The scene with its lights, camera and technique as they are now"),
        /// What the Diagnosis tab found, as text or JSON, by the file's extension.
        Diagnosis = "Diagnosis (text or JSON)…" (
            "Where the frame is wrong, why, and the proven fix, as the Diagnosis tab found it: .txt to read, .json for scripts, \
             as `stencilscope diagnose` writes them"
        ),
        /// The rows of the Report tab, or their plot, by the file's extension.
        Report = "Report (table or plot)…" (
            "Error against run time, as measured in the Report tab: .csv, .md or .json for the rows, .svg or .png for \
             the plot"
        ),
    }
}

impl ExportKind {
    /// Returns whether an export of this kind carries both sides of a comparison of two frames.
    pub fn carries_both(self) -> bool {
        matches!(self, ExportKind::Picture | ExportKind::AsShown | ExportKind::Steps | ExportKind::LightRound)
    }
}

named_enum! {
    /// A part of a panel that a stop of a tour speaks of, named as in a sentence.
    pub enum TourSubject {
        /// The sentence on the picked pixel.
        Answer = "the answer",
        /// The picked pixel's history.
        History = "the history",
        /// The ladder of the picked pixel's view ray.
        Ladder = "the ladder",
        /// The texel of the shadow map that decided the picked pixel.
        Texel = "the texel",
        /// The formulas of the selected step.
        Formula = "the formula",
        /// The list of what the frame left out.
        LeftOut = "what was left out",
        /// The state of the selected draw in an API's words.
        State = "the state",
        /// The legend of the picture or of its overlays.
        Legend = "the legend",
        /// The parts of the volumes in the legend of the scene's view.
        Volumes = "the parts of the volumes",
        /// The button that measures all techniques.
        Measure = "the button",
    }
}
