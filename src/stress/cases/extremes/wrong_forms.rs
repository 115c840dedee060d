//! Famous wrong variants of volumes and silhouettes: settings that the sources warn of.

use crate::scene::{Light, Object, shapes};
use crate::stress::cases::stage::{carried, floor, scene, still_life};
use crate::stress::cases::who::*;
use crate::stress::{CaseNumber, Entrant, StressCase};
use crate::technique::Technique;

/// The stress cases of techniques in forms that are known to be wrong.
pub const ALL: &[StressCase] = &[CAPS, LIGHT_AND_ORIGIN, SILHOUETTE_PICTURE];

const LIGHT_CAP_ALONE: Entrant = Entrant::with(Technique::ZFail, &[("caps", "light")]);
const DARK_CAP_ALONE: Entrant = Entrant::with(Technique::ZFail, &[("caps", "dark")]);
const NO_CAPS: Entrant = Entrant::with(Technique::ZFail, &[("caps", "none")]);

const CAPS: StressCase = StressCase {
    name: "caps",
    lesson: "z-fail without a cap: the volume is open where the view ray leaves it, and what is behind is miscounted",
    also: &[LIGHT_CAP_ALONE, DARK_CAP_ALONE, NO_CAPS],
    failures: &[
        fails(
            LIGHT_CAP_ALONE,
            "missing-dark-cap",
            "a ray to infinity leaves the volume through a cap that is not there",
        )
        .is_false()
        .at_most(0.4),
        fails(DARK_CAP_ALONE, "missing-light-cap", "a ray that enters the volume through its caster is not counted")
            .is_false()
            .at_most(0.99),
        fails(NO_CAPS, "missing-caps", "volumes are open at both ends").is_false().at_most(0.7),
    ],
    ..PLAIN
};

const FROM_LIGHT: Entrant = Entrant::with(Technique::ZFail, &[("extrusion", "finite:100")]);
const FROM_ORIGIN: Entrant =
    Entrant::with(Technique::ZFail, &[("extrusion", "finite:100"), ("far-vertices", "from-origin")]);

const LIGHT_AND_ORIGIN: StressCase = StressCase {
    name: "light-and-origin",
    lesson: "far vertices that the light is not added back to: right while the light is the origin, then the farther the worse",
    parameter: "from light to origin in metres",
    values: &[0.0, 1.0, 3.0, 1e1, 1e2, 1e3, 1e4],
    drives: CaseNumber::Scene(|distance| {
        let scene = still_life()?;
        let light = scene.lights[0].position.truncate();
        Ok(carried(scene, light.normalize() * distance - light))
    }),
    also: &[FROM_LIGHT, FROM_ORIGIN],
    failures: &[fails(
        FROM_ORIGIN,
        "light-not-added",
        "volumes lean towards the origin, by as much as the light is from it",
    )
    .at(|distance| distance >= 1e1)
    .at_most(0.01)],
    ..PLAIN
};

const UNFITTED: Entrant = Entrant::with(Technique::Projective, &[("fit", "off")]);
const BORDERLESS: Entrant = Entrant::with(Technique::Projective, &[("border", "off")]);

const SILHOUETTE_PICTURE: StressCase = StressCase {
    name: "silhouette-picture",
    lesson: "the lamp comes to a board: a picture of 90 degrees no longer holds its silhouette, and one without a border smears",
    parameter: "height of the lamp over the board in its half widths",
    values: &[4.0, 2.0, 1.5, 0.8, 0.6, 0.5],
    drives: CaseNumber::Scene(|height| {
        let board = Object { receives: false, ..Object::of("board", shapes::quad([0.8; 2])?).at([0.0, 0.6, 0.0]) };
        let lamp = Light::point([0.002, 0.6 + 0.4 * height, 0.003]);
        Ok(scene([1.5, 4.0, 5.0], [0.0, 0.3, 0.0], lamp, vec![floor(3.0)?, board]))
    }),
    also: &[UNFITTED, BORDERLESS],
    failures: &[
        fails(
            UNFITTED,
            "no-fit",
            "the silhouette is cut off where its picture ends, and beyond it all of the light arrives",
        )
        .at(|height| height < 0.9)
        .is_missing(),
        fails(BORDERLESS, "edge-smear", "the last texels are the silhouette's own, and go on for ever")
            .is_false()
            .at_most(0.97),
    ],
    ..PLAIN
};
