//! Diagnosis: every cause is provoked, and named first and proven; what is right has none.

mod causes;
mod faults;
mod occasions;
mod provoke;
mod random;
mod scenes;

use crate::common::session;
use provoke::Provocation;
use stencilscope::diagnosis::{Cause, Diagnosis};
use stencilscope::progress::Progress;
use stencilscope::session::{CaptureRequest, InjectedFault, Session};

const SMALL: [u32; 2] = [160, 120];

fn diagnose(session: &mut Session, provoked: &Provocation) -> Diagnosis {
    // A pixel in 37 million is of one picture alone.
    let size = if provoked.cause == Cause::SubpixelEdges { [320, 240] } else { SMALL };
    let request = CaptureRequest::new(provoked.choice.clone(), size);
    let fault = provoked.fault.as_deref().map_or(InjectedFault::None, |change| InjectedFault::Plan(change));
    session.diagnose(&provoked.scene, &request, fault, &Progress::default()).expect("a diagnosis")
}

/// What is named first: the first cause of the first region.
fn first(diagnosis: &Diagnosis) -> Option<Cause> {
    diagnosis.regions.first()?.causes.first().map(|cause| cause.cause)
}

/// All regions with their causes, for failing tests.
fn summary(diagnosis: &Diagnosis) -> String {
    let mut text = format!("{} {:?}\n", diagnosis.technique.name(), diagnosis.error);
    for region in &diagnosis.regions {
        let (kind, at) = (region.kind.name(), region.at);
        text += &format!("  {} {kind} at {at:?} of {:?} on {:?}\n", region.pixels, region.casters, region.receivers);
        for cause in &region.causes {
            let fix = cause.fix.as_ref().map_or("nothing".to_owned(), ToString::to_string);
            let (proof, left) = (cause.proof.name(), cause.pixels_left);
            text += &format!(
                "    {} {proof} {left:?}: {}; {fix} {:?}\n",
                cause.cause, cause.evidence.sentence, cause.together_with
            );
        }
    }
    text
}
