//! The settings of volume techniques as types.

use super::{Casters, Extrusion, PlanError, SilhouetteBy};
use crate::geometry::MOST_TO_SEARCH;
use crate::plan::Decision;
use crate::scene::Scene;
use crate::technique::Choice;

/// A volume technique's settings.
pub struct Options {
    pub casters: WhoCasts,
    pub extrusion: Extrusion,
    /// Front and back faces in passes of their own.
    pub two_pass: bool,
    /// Counts stop at 0 and 255.
    pub clamp: bool,
    /// Light caps never pass the depth test, whatever is in front of them.
    pub light_caps_never_pass: bool,
    pub silhouette: SilhouetteBy,
    /// In a float target instead of the stencil.
    pub counts_in_float: bool,
}

/// Which triangles cast, or what decides it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WhoCasts {
    Always(Casters),
    /// Those that face the light where that is proven to be enough, else all.
    ByTopology,
}

impl WhoCasts {
    /// Without a look at any mesh: all where that would decide.
    pub fn fixed(self) -> Casters {
        match self {
            WhoCasts::Always(casters) => casters,
            WhoCasts::ByTopology => Casters::All,
        }
    }
}

impl Options {
    pub fn of(choice: &Choice) -> Options {
        Options {
            casters: match choice.word("casters") {
                "light-facing" => WhoCasts::Always(Casters::LightFacing),
                "light-back-facing" => WhoCasts::Always(Casters::LightBackFacing),
                "by-topology" => WhoCasts::ByTopology,
                "" if Decision::AwayTriangles.is_allowed(choice) => WhoCasts::ByTopology,
                _ => WhoCasts::Always(Casters::All),
            },
            extrusion: choice.number_after("extrusion", "finite:").map_or(Extrusion::Infinite, Extrusion::Finite),
            two_pass: choice.word("faces") == "two-pass",
            clamp: choice.word("operations") == "clamp",
            light_caps_never_pass: choice.word("light-caps") == "never",
            silhouette: match choice.word("silhouette") {
                "edge-list" => SilhouetteBy::Search,
                _ => SilhouetteBy::Adjacency,
            },
            counts_in_float: choice.word("counter") == "float",
        }
    }

    /// Refuses what would take minutes.
    pub fn check(&self, scene: &Scene) -> Result<(), PlanError> {
        let too_large = |triangles: usize| self.silhouette == SilhouetteBy::Search && triangles > MOST_TO_SEARCH;
        let casting = scene.objects.iter().filter(|object| object.casts);
        match casting.map(|object| (object, object.mesh.triangles().len())).find(|(_, count)| too_large(*count)) {
            None => Ok(()),
            Some((object, count)) => Err(PlanError::Unusable {
                problem: format!(
                    "silhouette = edge-list searches all edges for each one, and {} has {count} triangles: choose \
                     silhouette = adjacency, or a caster of at most {MOST_TO_SEARCH}",
                    object.name
                ),
            }),
        }
    }
}
