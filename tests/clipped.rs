//! What is clipped before the rasteriser sees it shows what it showed before.

use crate::common::{opened, request};
use stencilscope::plan::{DrawPieces, ExactRange, FramePlan};
use stencilscope::progress::Progress;
use stencilscope::scene::Scene;
use stencilscope::session::InjectedFault;
use stencilscope::technique::Technique;

/// Nothing beyond the picture is drawn exactly.
const NOTHING: ExactRange = ExactRange { far: 0.0, behind_eye: false, infinity: false, coarse_step: None };

/// The plan with pieces as its own triangles, so that they are drawn whatever the adapter needs.
fn of_pieces(mut plan: FramePlan) -> FramePlan {
    for pass in &mut plan.passes {
        for draw in &mut pass.draws {
            if let Some(DrawPieces { mesh, triangles, .. }) = draw.pieces.take() {
                (draw.mesh, draw.base_vertex, draw.triangles) = (mesh, 0, triangles);
            }
        }
        pass.draws.retain(|draw| !draw.triangles.is_empty());
    }
    plan.meshes.iter_mut().for_each(|mesh| mesh.pieces_of = None);
    plan
}

/// From within scenes, so that surfaces and volumes reach behind the eye, triangles are cut, and no pixel is wrong; on a
/// grid, which edges reach at other places, next to none.
#[test]
fn a_clipped_frame_has_the_same_shadows() {
    let mut session = crate::common::session();
    let on_grid = ExactRange { coarse_step: Some(1.0 / 256.0), ..NOTHING };
    let (mut cut, mut wrong_on_grid) = (0, 0);
    for name in ["tori", "rings", "inside", "two-lights", "table"] {
        let scene = opened(name);
        for seed in 0..3 {
            let scene = Scene { camera: scene.camera.anywhere(seed), ..scene.clone() };
            for technique in [Technique::ZFail, Technique::Planar] {
                let request = request(technique, [160, 120]);
                let plan = session.plan(&scene, &request).expect("a plan");
                cut += u32::from(plan.clone().clipped(&NOTHING) != plan);
                let mut wrong = |exact: ExactRange| {
                    let clip = move |plan: &mut FramePlan| *plan = of_pieces(plan.clone().clipped(&exact));
                    let fault = InjectedFault::Plan(&clip);
                    let found = session.diagnose(&scene, &request, fault, &Progress::default()).expect("a diagnosis");
                    found.error.wrong()
                };
                let as_it_is =
                    wrong(ExactRange { far: f64::INFINITY, behind_eye: true, infinity: true, coarse_step: None });
                assert_eq!(wrong(NOTHING), as_it_is, "{name} from {seed}, {}", technique.name());
                wrong_on_grid += wrong(on_grid).abs_diff(as_it_is);
            }
        }
    }
    assert!(cut > 20, "{cut}");
    assert!(wrong_on_grid <= 5, "{wrong_on_grid}");
}
