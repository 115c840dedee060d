//! What eight bits do to counts.

use crate::diagnosis::cause::Cause;
use crate::diagnosis::facts::{Case, Facts, Rule, Sample, Suspicion, amount};
use crate::diagnosis::mend::Mend;
use crate::history::{Count, Why};
use crate::plan::CountOf;

pub(crate) const RULES: &[Rule] = &[clamped, wrap_256, operation_order];

/// The first step of a light's count that was lost at a limit: what the count was, and how many were lost.
fn first_lost(sample: &Sample, light: usize) -> Option<(u8, u64)> {
    let is_lost = |(event, _): &(&crate::history::Event, _)| event.step() != 0 && event.counted() == 0;
    let mut lost = sample.volume_events(light).filter(is_lost);
    let first = lost.next()?.0.before.stencil;
    Some((first, 1 + lost.count() as u64))
}

/// Of all steps together, as no limit would have them.
fn true_count(sample: &Sample, light: usize) -> i32 {
    sample.volume_events(light).map(|(event, _)| event.step()).sum()
}

fn stored(sample: &Sample, light: usize) -> Option<u8> {
    match sample.history.as_ref()?.why(light)? {
        Why::Counted(counted, _) => match counted.count {
            Count::Stencil(byte) => Some(byte),
            Count::Float(_) => None,
        },
        _ => None,
    }
}

fn clamped(_: &Facts, case: &Case) -> Option<Suspicion> {
    let light = case.light();
    let ((lost, count, stored), shown_by) = case.shown(|sample| {
        let (limit, lost) = first_lost(sample, light)?;
        (limit == u8::MAX).then_some((lost, true_count(sample, light), stored(sample, light)?))
    })?;
    let evidence = format!(
        "{} found the count at 255 and {} lost: in truth {count} are left, stored are {stored}",
        amount(lost, "face"),
        if lost == 1 { "was" } else { "were" },
    );
    let mends = vec![Mend::setting("operations", "wrap"), Mend::setting("counter", "float")];
    Suspicion::new(Cause::Clamped, evidence, mends, shown_by)
}

fn operation_order(_: &Facts, case: &Case) -> Option<Suspicion> {
    let light = case.light();
    let ((lost, count, stored), shown_by) = case.shown(|sample| {
        let (limit, lost) = first_lost(sample, light)?;
        (limit == 0).then_some((lost, true_count(sample, light), stored(sample, light)?))
    })?;
    let evidence = format!(
        "{} that {} away came while the count was 0 and {} lost: in truth {count} are left, stored are {stored}",
        amount(lost, "face"),
        if lost == 1 { "takes" } else { "take" },
        if lost == 1 { "was" } else { "were" },
    );
    Suspicion::new(Cause::OperationOrder, evidence, vec![Mend::setting("operations", "wrap")], shown_by)
}

fn wrap_256(facts: &Facts, case: &Case) -> Option<Suspicion> {
    let light = case.light();
    let (count, shown_by) = case.shown(|sample| {
        let count = true_count(sample, light);
        let reads_none = stored(sample, light)? == 0 && first_lost(sample, light).is_none();
        (count != 0 && count % 256 == 0 && reads_none).then_some(count)
    })?;
    let of = facts.capture.lights.get(light).and_then(|light| light.count_of);
    let what = of.map_or("volumes", CountOf::what);
    let evidence = format!("{count} {what} are counted here, a multiple of 256: eight bits hold 0");
    Suspicion::new(Cause::Wrap256, evidence, vec![Mend::setting("counter", "float")], shown_by)
}
