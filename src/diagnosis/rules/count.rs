//! Faults of counting in eight bits.

use crate::diagnosis::cause::Cause;
use crate::diagnosis::evidence::Quantity;
use crate::diagnosis::facts::{CauseRule, FrameFacts, PixelSample, RegionSamples, SuspectedCause, amount};
use crate::diagnosis::fix::Fix;
use crate::history::{LightDecision, VolumeCount};
use crate::plan::{CountBits, CountOf};
use crate::technique::CountOperations;

pub(crate) const RULES: &[CauseRule] = &[clamped, wrap_256, few_bits, parity, operation_order];

/// Returns the count before the first step that was lost at a limit, and how many steps were lost; `None` where none
/// was.
fn first_lost(sample: &PixelSample, light: usize) -> Option<(u8, u64)> {
    let is_lost = |(event, _): &(&crate::history::PixelEvent, _)| event.step() != 0 && event.counted() == 0;
    let mut lost = sample.volume_events(light).filter(is_lost);
    let first = lost.next()?.0.before.stencil;
    Some((first, 1 + lost.count() as u64))
}

/// Returns a light's count at a sample as if counts had no limits: the clear value plus all steps.
fn true_count(sample: &PixelSample, light: usize) -> i32 {
    let start = sample.history.as_ref().map_or(0, |history| history.cleared_to(light));
    start + sample.volume_events(light).map(|(event, _)| event.step()).sum::<i32>()
}

fn stored(sample: &PixelSample, light: usize) -> Option<u8> {
    match sample.history.as_ref()?.why(light)? {
        LightDecision::Counted(counted, _) => match counted.count {
            VolumeCount::Stencil(byte) => Some(byte),
            VolumeCount::Float(_) => None,
        },
        _ => None,
    }
}

fn clamped(_: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let light = case.light();
    let ((lost, count, stored), shown_by) = case.shown(|sample| {
        let (limit, lost) = first_lost(sample, light)?;
        (limit == u8::MAX).then_some((lost, true_count(sample, light), stored(sample, light)?))
    })?;
    let sentence = format!(
        "{} found the count at 255 and {} lost: in truth {count} are left, stored are {stored}",
        amount(lost, "face"),
        if lost == 1 { "was" } else { "were" },
    );
    let fixes = vec![Fix::setting("operations", "wrap"), Fix::setting("counter", "float")];
    let quantities = lost_steps(lost, count, stored);
    Some(SuspectedCause::new(Cause::Clamped, case.evidence(sentence, shown_by, quantities), fixes))
}

/// Returns the numbers of a count that stopped: how many steps were lost, and how far what is stored is off for that.
fn lost_steps(lost: u64, count: i32, stored: u8) -> [Quantity; 2] {
    [
        Quantity::at_least("steps that a limit of the count swallowed", lost as f64, 1.0),
        Quantity::at_least("how far the stored count is off", count.abs_diff(stored.into()).into(), 1.0),
    ]
}

fn operation_order(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let light = case.light();
    let ((lost, count, stored), shown_by) = case.shown(|sample| {
        let (limit, lost) = first_lost(sample, light)?;
        (limit == 0).then_some((lost, true_count(sample, light), stored(sample, light)?))
    })?;
    let sentence = format!(
        "{} that {} away came while the count was 0 and {} lost: in truth {count} are left, stored are {stored}",
        amount(lost, "face"),
        if lost == 1 { "takes" } else { "take" },
        if lost == 1 { "was" } else { "were" },
    );
    let mut fixes = vec![Fix::setting("operations", "wrap")];
    // Where passes are in the wrong order, only their order is to be changed.
    if facts.volumes().is_some_and(|settings| settings.two_pass && settings.takes_away_first) {
        fixes.push(Fix::setting("order", "add-first"));
    }
    let quantities = lost_steps(lost, count, stored);
    Some(SuspectedCause::new(Cause::OperationOrder, case.evidence(sentence, shown_by, quantities), fixes))
}

fn wrap_256(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let is_whole = facts.volumes().is_none_or(|settings| settings.mask() == u8::MAX);
    let light = case.light();
    let (count, shown_by) = case.shown(|sample| {
        let count = true_count(sample, light);
        let reads_none = stored(sample, light)? == 0 && first_lost(sample, light).is_none();
        (count != 0 && count % 256 == 0 && is_whole && reads_none).then_some(count)
    })?;
    let of = facts.capture.lights.get(light).and_then(|light| light.count_of);
    let what = of.map_or("volumes", CountOf::what);
    let sentence = format!("{count} {what} are counted here, a multiple of 256: eight bits hold 0");
    let quantities = reads_as_none(count, 256);
    let evidence = case.evidence(sentence, shown_by, quantities);
    Some(SuspectedCause::new(Cause::Wrap256, evidence, vec![Fix::setting("counter", "float")]))
}

/// Returns the numbers of a count that reads as none: how large it is, and what is left of it modulo `modulus`.
fn reads_as_none(count: i32, modulus: i32) -> [Quantity; 2] {
    [
        Quantity::at_least("the count, whatever its sign", count.unsigned_abs().into(), modulus.into()),
        Quantity::at_most("what the bits of the count hold", count.rem_euclid(modulus).into(), 0.0),
    ]
}

/// Looks for counts in fewer than eight stencil bits that are a multiple of their modulus other than 0 and read as 0,
/// though no step was lost. `None` with eight bits, with inverting operations, or where no sample shows it.
fn few_bits(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let settings = facts.volumes().filter(|settings| settings.operations != CountOperations::Inverting)?;
    let bits = CountBits::of_mask(settings.mask().into());
    if bits == CountBits::EIGHT {
        return None;
    }
    let light = case.light();
    let (count, shown_by) = case.shown(|sample| {
        let count = true_count(sample, light);
        let reads_none = stored(sample, light)? == 0 && first_lost(sample, light).is_none();
        (count != 0 && count % bits.modulus() == 0 && reads_none).then_some(count)
    })?;
    let sentence = format!(
        "a count of {count} is left here, a multiple of {}: {bits} {} 0",
        bits.modulus(),
        if bits.modulus() == 2 { "holds" } else { "hold" }
    );
    let fixes = vec![Fix::setting("stencil-bits", "8"), Fix::setting("counter", "float")];
    let evidence = case.evidence(sentence, shown_by, reads_as_none(count, bits.modulus()));
    Some(SuspectedCause::new(Cause::FewBits, evidence, fixes))
}

fn parity(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    facts.volumes().filter(|settings| settings.operations == CountOperations::Inverting)?;
    let light = case.light();
    let (count, shown_by) = case.shown(|sample| {
        let count = sample.between.iter().filter(|hit| facts.casts(light, hit)).count();
        (count != 0 && count % 2 == 0 && stored(sample, light)? == 0).then_some(count)
    })?;
    let sentence =
        format!("{count} volumes contain the surface, an even number, and the one bit that faces turn over ends at 0");
    let fixes = vec![Fix::setting("operations", "wrap")];
    let evidence = case.evidence(sentence, shown_by, reads_as_none(count as i32, 2));
    Some(SuspectedCause::new(Cause::Parity, evidence, fixes))
}
