//! Flat pieces that no caster is flattened onto.

use super::planar::settings;
use super::texels::texture_layer;
use crate::diagnosis::cause::Cause;
use crate::diagnosis::evidence::Quantity;
use crate::diagnosis::facts::{CauseRule, FrameFacts, RegionSamples, SuspectedCause, amount, listed};
use crate::diagnosis::fix::Fix;
use crate::geometry::EdgeList;
use crate::geometry::planar::{self, Receiver};
use crate::math::clip::near_plane;
use crate::math::{Sign, side_of_triangle};
use crate::numbers;
use crate::plan::{Decision, LeftOut, LightId};
use crate::scene::Object;
use crate::technique::{ReceiverChoice, Technique};
use crate::truth::SeenSurface;
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};

pub(crate) const RULES: &[CauseRule] = &[not_planar, receiver_left_out];

/// A flat piece of an object's surface that no caster is flattened onto.
struct UnservedPiece<'f> {
    object: &'f str,
    /// How many flat pieces the object has.
    of: usize,
    /// The part of the picture that it covers where nothing hides it, 0 to 1.
    share: f64,
}

/// The flat pieces of one object, found once for all examined pixels of a region.
struct ObjectPieces {
    world: Vec<DVec3>,
    pieces: Vec<Receiver>,
    /// For each piece, whether it is a facet of a curved surface.
    are_facets: Vec<bool>,
}

impl ObjectPieces {
    fn of(object: &Object) -> ObjectPieces {
        let (mesh, world) = (&object.mesh, object.world_positions());
        let edges = EdgeList::new(mesh.triangles(), mesh.positions().len());
        let pieces = planar::receivers(mesh.positions(), &world, mesh.triangles(), &edges);
        let are_facets = planar::facets(&pieces, mesh.triangles().len(), &edges);
        ObjectPieces { world, pieces, are_facets }
    }
}

/// Returns whether no caster is flattened onto the flat piece at a seen point, though the light is not in its plane.
fn is_unserved(facts: &FrameFacts, light: usize, seen: &SeenSurface) -> bool {
    let serves = match facts.technique() {
        Technique::PlanarTexture => texture_layer(facts, light, seen).is_some(),
        _ => is_served(facts, light, seen),
    };
    !serves && side_of_triangle(seen.corners, facts.tracer.light_position(light)) != Sign::Zero
}

/// Returns whether the plan draws a light's shadows on the flat piece that the visible triangle lies in.
fn is_served(facts: &FrameFacts, light: usize, seen: &SeenSurface) -> bool {
    let normal = (seen.corners[1] - seen.corners[0]).cross(seen.corners[2] - seen.corners[0]).normalize_or_zero();
    facts.plan.planar_shadows_on(LightId(light), facts.tracer.name(seen.place), seen.point, normal).is_some()
}

/// Returns the planar technique's missing shadow on a piece that is a facet of a curved surface or not, as `is_facet` says:
/// the piece, how many of the examined pixels show one, and what the plan records of such pieces of its object.
fn without_shadow<'f>(
    facts: &FrameFacts<'f>,
    case: &RegionSamples,
    is_facet: bool,
) -> Option<(UnservedPiece<'f>, usize, &'f LeftOut)> {
    let light = case.light();
    let is_planar = [Technique::Planar, Technique::PlanarTexture].contains(&facts.technique());
    if !case.is_missing() || !is_planar {
        return None;
    }
    let mut known: BTreeMap<usize, ObjectPieces> = BTreeMap::new();
    let (piece, shown_by) = case.shown(|sample| {
        let seen = sample.seen.filter(|seen| is_unserved(facts, light, seen))?;
        let object = facts.scene.objects.get(seen.place.object)?;
        let of = known.entry(seen.place.object).or_insert_with(|| ObjectPieces::of(object));
        let triangle = seen.place.triangle as u32;
        let index = of.pieces.iter().position(|piece| piece.triangles.binary_search(&triangle).is_ok())?;
        let view = facts.plan.views.first()?;
        let clip = |point: DVec3| view.clip_from_relative.as_dmat4() * (point - view.origin).extend(1.0);
        let near = near_plane(&facts.plan.depth);
        let share = of.pieces[index].picture_share(&of.world, object.mesh.triangles(), near, clip);
        let piece = UnservedPiece { object: &object.name, of: of.pieces.len(), share };
        (of.are_facets[index] == is_facet).then_some(piece)
    })?;
    let of_light = LightId(light).name();
    let is_of = |left: &&LeftOut| left.of == of_light || left.of == "the frame";
    let mut left_out = facts.plan.left_out.iter().filter(is_of);
    let left = left_out.find(|left| left.names(Decision::SmallReceivers, piece.object))?;
    Some((piece, shown_by, left))
}

/// Returns the fixes by which flat pieces get shadows that the plan leaves out; z-fail is the last.
fn with_all_receivers(facts: &FrameFacts) -> Vec<Fix> {
    let mut fixes = vec![Fix::technique(Technique::ZFail)];
    if let Some(settings) = settings(facts) {
        let mut all = Fix::setting("receivers", "all");
        // Without marks, pieces get no shadows that are too small for them.
        if !settings.marks {
            all.settings.insert("stencil".to_owned(), "on".to_owned());
        }
        fixes.insert(0, all);
    }
    fixes
}

fn not_planar(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let (piece, shown_by, left) = without_shadow(facts, case, true)?;
    let casters = case.samples.iter().flat_map(|sample| facts.names(&sample.between)).collect::<BTreeSet<_>>();
    let count = left.count.unwrap_or(0);
    let sentence = format!(
        "{} is no plane but {}, and none of {} is flattened onto the one here: {} of them get no shadow ({})",
        piece.object,
        amount(piece.of as u64, "flat piece"),
        listed(&casters),
        numbers::count(count),
        left.because
    );
    let without = Quantity::at_least("flat pieces that get no shadow", count as f64, 1.0);
    let fixes = match settings(facts) {
        // With marks, pieces get shadows that are too small for them without.
        Some(settings) if !settings.marks => with_all_receivers(facts),
        _ => vec![Fix::technique(Technique::ZFail)],
    };
    Some(SuspectedCause::new(Cause::NotPlanar, case.evidence(sentence, shown_by, [without]), fixes))
}

fn receiver_left_out(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let (piece, shown_by, left) = without_shadow(facts, case, false)?;
    let share = numbers::percent(piece.share);
    let sentence = format!("{} is flat here and covers {share} of the picture: {left}, {}", piece.object, left.because);
    let without = Quantity::at_least("flat pieces that get no shadow", left.count.unwrap_or(0) as f64, 1.0);
    let mut quantities = vec![without];
    let choice = (facts.technique() == Technique::Planar).then(|| ReceiverChoice::read(facts.choice.settings()));
    if let Some(ReceiverChoice::Share(least)) = choice {
        quantities.push(Quantity::less_than("the piece's share of the picture, per cent", piece.share * 100.0, least));
    }
    let evidence = case.evidence(sentence, shown_by, quantities);
    Some(SuspectedCause::new(Cause::ReceiverLeftOut, evidence, with_all_receivers(facts)))
}
