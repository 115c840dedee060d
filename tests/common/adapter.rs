//! What the adapter that tests run on does with triangles. A test that holds by a property of the rasteriser asks for that
//! property here, and nowhere else.

use super::session;
use std::fmt::Display;
use std::sync::OnceLock;
use stencilscope::accuracy::ErrorCounts;
use stencilscope::capture::{AdapterProfile, Capture};
use stencilscope::diagnosis::{Cause, Diagnosis, Proof, RegionKind};
use stencilscope::progress::Progress;
use stencilscope::scene::Scene;
use stencilscope::session::{CaptureRequest, InjectedFault, Session};
use stencilscope::technique::Technique;
use stencilscope::wgpu;

/// The adapter's profile, measured once.
pub fn profile() -> &'static AdapterProfile {
    static PROFILE: OnceLock<AdapterProfile> = OnceLock::new();
    PROFILE.get_or_init(|| session().profile().expect("a profile"))
}

/// Are triangles drawn as they are given, with their own depth? Else corners are put on the adapter's grid first.
pub fn draws_as_given() -> bool {
    profile().exact_range().coarse_step.is_none()
}

/// Can fragment shaders tell which triangle they are of? Else nobody knows which fragments another program's shader
/// discards.
pub fn tells_triangles() -> bool {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()));
    adapter.expect("an adapter").features().contains(wgpu::Features::PRIMITIVE_INDEX)
}

/// The wrong pixels of a diagnosed frame whose first cause is not proven to be the adapter's precision: that the same
/// is rounded otherwise in another pass, or that corners are moved.
pub fn beyond_precision(diagnosis: &Diagnosis) -> u64 {
    let by_precision = diagnosis.regions.iter().filter(|region| {
        let is_near_plane = diagnosis.technique == Technique::ZPassPlus;
        let is_so = |cause: Cause| match cause {
            Cause::RasteriserPrecision | Cause::SubpixelEdges => true,
            Cause::NearPlaneCrack => is_near_plane,
            _ => false,
        };
        matches!(region.kind, RegionKind::Wrong(_))
            && region.causes.first().is_some_and(|found| is_so(found.cause) && found.proof == Proof::Proven)
    });
    diagnosis.error.wrong() - by_precision.map(|region| region.pixels).sum::<u64>()
}

/// Asserts that a frame has no wrong pixel; where corners are not drawn as given, none but those that are proven to be
/// wrong for that, a few.
pub fn assert_right(
    session: &mut Session,
    scene: &Scene,
    request: &CaptureRequest,
    judged: &Capture,
    of: &dyn Display,
) {
    assert_counts_right(session, scene, request, judged.error().expect("judged"), of);
}

/// The same, of a frame whose wrong pixels are counted already.
pub fn assert_counts_right(
    session: &mut Session,
    scene: &Scene,
    request: &CaptureRequest,
    error: ErrorCounts,
    of: &dyn Display,
) {
    if draws_as_given() || error.wrong() == 0 {
        assert_eq!(error.wrong(), 0, "{}, {of}: {error:?} {:?}", scene.name, scene.camera);
        return;
    }
    assert!(error.wrong() <= 2 + error.compared / 2000, "{}, {of}: {error:?} {:?}", scene.name, scene.camera);
    let found = session.diagnose(scene, request, InjectedFault::None, &Progress::default()).expect("a diagnosis");
    assert_eq!(beyond_precision(&found), 0, "{}, {of}: {:#?}", scene.name, found.regions);
}
