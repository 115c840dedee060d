//! The state of the Diagnosis tab.

use crate::accuracy::{WrongRegion, wrong_regions};
use crate::capture::Capture;
use crate::diagnosis::Diagnosis;
use crate::diagnosis::frame_causes::FrameDiagnosis;
use std::rc::Rc;
use std::sync::Arc;

/// The state of the tab Diagnosis: the selected region, and the diagnosis that it belongs to.
#[derive(Debug, Default)]
pub struct DiagnosisPanel {
    /// Index of the selected region.
    pub selected: usize,
    /// Both lists are to be scrolled to their beginning: they are of another diagnosis than before.
    pub goes_to_top: bool,
    of: Option<Arc<Diagnosis>>,
    /// The wrong regions of another program's frame: that frame's number, whether its truth was known, and the regions.
    of_frame: Option<(u64, bool, Rc<Vec<FrameRegion>>)>,
}

/// A region of wrong pixels in another program's frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameRegion {
    /// Index of the light under which they are wrong.
    pub light: usize,
    /// The region.
    pub region: WrongRegion,
}

impl DiagnosisPanel {
    /// Returns the wrong regions of another program's frame, the largest first, found once for each frame: all of them
    /// where the truth is known, otherwise each light's largest. Lights of which too little is compared have none.
    pub fn frame_regions(
        &mut self,
        number: u64,
        capture: &Capture,
        diagnosis: &FrameDiagnosis,
    ) -> Rc<Vec<FrameRegion>> {
        let has_truth = capture.lights.iter().any(|light| light.truth.is_some());
        if let Some((of, with_truth, regions)) = &self.of_frame
            && (*of, *with_truth) == (number, has_truth)
        {
            return Rc::clone(regions);
        }
        let mut regions = Vec::new();
        for (light, found) in diagnosis.lights.iter().enumerate().filter(|(_, found)| found.worst.is_some()) {
            let truth = capture.lights.get(light).and_then(|light| light.truth.as_ref());
            let all = match truth {
                Some(truth) => {
                    let rows: Vec<u8> = truth.findings.rows().flatten().copied().collect();
                    wrong_regions(rows, truth.findings.size())
                }
                None => found.worst.into_iter().collect(),
            };
            regions.extend(all.into_iter().map(|region| FrameRegion { light, region }));
        }
        regions.sort_by_key(|one| std::cmp::Reverse(one.region.pixels));
        let regions = Rc::new(regions);
        self.of_frame = Some((number, has_truth, Rc::clone(&regions)));
        regions
    }

    /// Clears the selected region where the diagnosis is another one than before, by content. Returns whether it is.
    pub fn follow(&mut self, diagnosis: &Arc<Diagnosis>) -> bool {
        let is_shown = |of: &Arc<Diagnosis>| Arc::ptr_eq(of, diagnosis) || of == diagnosis;
        let is_another = !self.of.as_ref().is_some_and(is_shown);
        if is_another {
            (self.selected, self.goes_to_top) = (0, true);
        }
        self.of = Some(Arc::clone(diagnosis));
        is_another
    }
}
