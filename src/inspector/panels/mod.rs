//! The tabs, one file or folder each: a struct with its state, and a function that draws the tab from that and the
//! model. A new one is a file here, a field and an arm below, and its name among [`PanelKind`]s.

pub mod bench;
pub mod diagnosis;
pub mod explain;
pub mod passes;
pub mod picture;
pub mod pixel;
pub mod raster_state;
pub mod report;
pub mod scene;
pub mod settings;
pub mod shadow_map;
pub mod stress;
pub mod tour_mark;

use crate::inspector::action::{Action, PanelKind};
use crate::inspector::model::Model;
use crate::reading::bench::TestBench;
use diagnosis::DiagnosisPanel;
use egui::Ui;
use explain::ExplainPanel;
use passes::PassesPanel;
use picture::PicturePanel;
use pixel::PixelPanel;
use raster_state::RasterStatePanel;
use report::ReportPanel;
use scene::SceneView;
use shadow_map::ShadowMapPanel;
use stress::StressPanel;

/// The state of the panels that have one of their own, by tab.
#[derive(Debug, Default)]
pub struct Panels {
    /// The frame, step by step.
    pub passes: PassesPanel,
    /// The selected picture.
    pub picture: PicturePanel,
    scene: SceneView,
    /// A light's map, linked with the picture.
    pub shadow_map: ShadowMapPanel,
    pixel: PixelPanel,
    raster_state: RasterStatePanel,
    explain: ExplainPanel,
    bench: TestBench,
    report: ReportPanel,
    diagnosis: DiagnosisPanel,
    stress: StressPanel,
}

impl Panels {
    /// Drops what was computed for a frame that is no longer shown, also in hidden tabs.
    pub fn follow(&mut self, model: &Model) {
        self.picture.follow(model.frame.number);
        self.scene.follow(model.scenes_opened);
    }

    /// Draws a tab.
    pub fn ui(&mut self, panel: PanelKind, ui: &mut Ui, model: &mut Model, actions: &mut Vec<Action>) {
        match panel {
            PanelKind::Passes => passes::ui(ui, &mut self.passes, model),
            PanelKind::Settings => settings::ui(ui, model, actions),
            PanelKind::Picture => picture::ui(ui, &mut self.picture, model, actions),
            PanelKind::Scene => scene::ui(ui, &mut self.scene, model, actions),
            PanelKind::ShadowMap => shadow_map::ui(ui, &mut self.shadow_map, model, actions),
            PanelKind::Pixel => pixel::ui(ui, &mut self.pixel, model),
            PanelKind::State => raster_state::ui(ui, &mut self.raster_state, model),
            PanelKind::Explain => explain::ui(ui, &mut self.explain, model),
            PanelKind::Bench => bench::ui(ui, &mut self.bench, model),
            PanelKind::Report => report::ui(ui, &mut self.report, model, actions),
            PanelKind::Diagnosis => diagnosis::ui(ui, &mut self.diagnosis, model, actions),
            PanelKind::Stress => stress::ui(ui, &mut self.stress, model, actions),
        }
    }
}
