//! What the panels ask of the app, and what is named in it. Panels change nothing outside the inspector.

use crate::ask::{PendingQuestion, RunRequest};
use crate::stress::Entrant;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A wish that needs files, windows or the GPU.
#[derive(Debug, Clone, PartialEq)]
pub enum Action {
    /// Open a built-in scene by name, or a scene file, model or capture folder by path.
    Open(String),
    /// Ask for a file with the system's dialog.
    Browse,
    /// Ask for a capture folder with the system's dialog, which shows files or folders, not both.
    BrowseFolder,
    /// Render again, with this changed.
    Run(Box<RunRequest>),
    /// Answer a question: with [`Inspector::answer`](super::Inspector::answer).
    Ask(PendingQuestion),
    /// Load the open scene again from its file, which changed.
    Reload,
    /// Write what is shown into a file.
    Export {
        /// What of it.
        kind: ExportKind,
        /// Where to.
        path: String,
        /// What is there may be replaced.
        replace: bool,
    },
    /// Ask with the system's dialog where to export to.
    BrowseExport {
        /// The place so far.
        path: String,
    },
    /// Open the scene of a stress case.
    OpenStress {
        /// Its name.
        case: &'static str,
        /// The value of its number.
        value: f64,
        /// How its shadows are made; `None`: as before.
        entrant: Option<Entrant>,
    },
    /// Render the open scene as a row of the report was.
    OpenReportRow {
        /// Name of the technique.
        technique: String,
        /// The row's settings.
        settings: BTreeMap<String, String>,
    },
}

/// A dialog.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DialogKind {
    /// Opens a scene.
    Open,
    /// Asks where to export to.
    Export(ExportKind),
    /// Lists all keys.
    Help,
}

/// A tab.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum PanelKind {
    /// The frame, step by step.
    Passes,
    /// What can be changed.
    Settings,
    /// The selected buffer.
    Picture,
    /// A second camera that sees the first.
    Scene,
    /// A light's map, linked with the picture.
    ShadowMap,
    /// Everything about the picked pixel.
    Pixel,
    /// The raster state of the selected draw.
    State,
    /// What the step is for, and tours.
    Explain,
    /// The stencil test by itself.
    Bench,
    /// Error against time.
    Report,
    /// What is wrong, and what mends it.
    Diagnosis,
    /// Extreme cases.
    Stress,
}

impl PanelKind {
    /// On its tab.
    pub fn title(self) -> &'static str {
        match self {
            PanelKind::Passes => "Passes",
            PanelKind::Settings => "Scene settings",
            PanelKind::Picture => "Picture",
            PanelKind::Scene => "Scene",
            PanelKind::ShadowMap => "Shadow map",
            PanelKind::Pixel => "Pixel",
            PanelKind::State => "State",
            PanelKind::Explain => "Explain",
            PanelKind::Bench => "Bench",
            PanelKind::Report => "Report",
            PanelKind::Diagnosis => "Diagnosis",
            PanelKind::Stress => "Stress",
        }
    }

    /// In the order of their declaration.
    pub const ALL: [PanelKind; 12] = [
        PanelKind::Passes,
        PanelKind::Settings,
        PanelKind::Picture,
        PanelKind::Scene,
        PanelKind::ShadowMap,
        PanelKind::Pixel,
        PanelKind::State,
        PanelKind::Explain,
        PanelKind::Bench,
        PanelKind::Report,
        PanelKind::Diagnosis,
        PanelKind::Stress,
    ];
}

/// Something drawn over the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Overlay {
    /// The edges that bound the shadows of the shown light.
    Silhouettes,
    /// The edges of its shadow volumes.
    Volumes,
    /// How the step's fragments fared in depth and stencil test.
    Tests,
    /// Where objects receive shadows.
    Receivers,
    /// What throws shadows is called.
    Names,
}

impl Overlay {
    /// In the order of the menu.
    pub const ALL: [Overlay; 5] =
        [Overlay::Silhouettes, Overlay::Volumes, Overlay::Tests, Overlay::Receivers, Overlay::Names];

    /// In the menu.
    pub fn name(self) -> &'static str {
        match self {
            Overlay::Silhouettes => "Silhouettes",
            Overlay::Volumes => "Wireframe of volumes",
            Overlay::Tests => "Depth and stencil tests",
            Overlay::Receivers => "Receivers",
            Overlay::Names => "Casters' names",
        }
    }

    /// What one sees.
    pub fn meaning(self) -> &'static str {
        match self {
            Overlay::Silhouettes => "The edges of casters that bound their shadow, of the shown light",
            Overlay::Volumes => "Sides and caps of the shadow volumes that the frame draws, of the shown light",
            Overlay::Tests => "Where fragments of the selected step pass or fail; hits of z-fail stay visible",
            Overlay::Receivers => "Where objects are darkened by shadows",
            Overlay::Names => "The name of each caster at the middle of what is seen of it",
        }
    }

    /// Does it follow from what the frame is made of in space?
    pub fn needs_anatomy(self) -> bool {
        self != Overlay::Tests
    }
}

/// What is exported.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExportKind {
    /// The shown picture in its colours, or what the step changed, a pixel a texel: PNG. What lies over it
    /// and what it is compared with is left out.
    Picture,
    /// The shown picture with overlays and the compared half, at the capture's resolution: PNG.
    AsShown,
    /// The shown picture's values: NumPy.
    Data,
    /// The frame pass by pass: animated PNG.
    Steps,
    /// A light once round the scene: animated PNG.
    LightRound,
    /// The frame in one file for a browser: HTML.
    Page,
    /// The whole capture: a folder.
    Capture,
    /// The scene as it is now, with its technique: a scene file.
    Scene,
    /// The rows of the Report tab, or their plot: what the file's ending says.
    Report,
}

impl ExportKind {
    /// All, in the order of the menu.
    pub const ALL: [ExportKind; 9] = [
        ExportKind::Picture,
        ExportKind::AsShown,
        ExportKind::Data,
        ExportKind::Steps,
        ExportKind::LightRound,
        ExportKind::Page,
        ExportKind::Capture,
        ExportKind::Scene,
        ExportKind::Report,
    ];

    /// In the menu.
    pub fn name(self) -> &'static str {
        match self {
            ExportKind::Picture => "Shown picture (PNG)…",
            ExportKind::AsShown => "Picture with overlays (PNG)…",
            ExportKind::Data => "Shown values (.npy)…",
            ExportKind::Steps => "Frame pass by pass (animated PNG)…",
            ExportKind::LightRound => "Light going round (animated PNG)…",
            ExportKind::Page => "Page (HTML)…",
            ExportKind::Capture => "Capture folder…",
            ExportKind::Scene => "Scene file (TOML)…",
            ExportKind::Report => "Report (table or plot)…",
        }
    }

    /// What is written.
    pub fn explanation(self) -> &'static str {
        match self {
            ExportKind::Picture => "The shown picture in its colours, a pixel a texel",
            ExportKind::AsShown => {
                "The shown picture with overlays and the compared half, whole and a pixel a texel, not as zoomed here"
            }
            ExportKind::Data => "The shown picture's values as an array that NumPy reads",
            ExportKind::Steps => "Each pass with what it writes, one after the other, over its name",
            ExportKind::LightRound => {
                "The shown light once round the scene's vertical axis, as the scene is run now; colours are rounded by \
                 at most 1 of 255"
            }
            ExportKind::Page => {
                "The frame in one file that any browser opens: steps, values, and the history of every pixel"
            }
            ExportKind::Capture => {
                "Every buffer after every pass, with a manifest, to be opened again or scripted against"
            }
            ExportKind::Scene => "The scene with its lights, camera and technique as they are now",
            ExportKind::Report => {
                "Error against run time, as measured in the Report tab: .csv, .md or .json for the rows, .svg or .png \
                 for the plot"
            }
        }
    }
}
