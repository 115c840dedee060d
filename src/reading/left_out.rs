//! What a frame left out, by reason.

use crate::numbers;
use crate::plan::{Decision, LeftOut};
use std::collections::BTreeSet;

/// What was left out for one reason.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LeftOutReason<'a> {
    /// Why nothing changes without it.
    pub because: &'a str,
    /// The things, in the order of the frame.
    pub things: Vec<LeftOutThing>,
}

/// Something that was left out once, several times, or of several objects.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LeftOutThing {
    /// What it is, with how much of it.
    pub title: String,
    /// What each object has of it, where there are several.
    pub each: Vec<String>,
}

/// Groups what a plan left out by reason, in the order of the frame. A thing that is left out several times with one reason
/// is listed once, with a count; what several objects do without is summed up.
pub fn by_reason(left_out: &[LeftOut]) -> Vec<LeftOutReason<'_>> {
    let mut reasons: Vec<(&str, Vec<Vec<&LeftOut>>)> = Vec::new();
    for entry in left_out {
        let place = reasons.iter().position(|(because, _)| *because == entry.because).unwrap_or(reasons.len());
        if place == reasons.len() {
            reasons.push((&entry.because, Vec::new()));
        }
        let things = &mut reasons[place].1;
        match things.iter_mut().find(|others| belong_together(others[0], entry)) {
            Some(others) => others.push(entry),
            None => things.push(vec![entry]),
        }
    }
    let reason = |(because, things): (_, Vec<Vec<&LeftOut>>)| LeftOutReason {
        because,
        things: things.iter().map(|entries| thing(entries)).collect(),
    };
    reasons.into_iter().map(reason).collect()
}

fn belong_together(one: &LeftOut, other: &LeftOut) -> bool {
    let sums_up = || kind(one).is_some() && kind(one) == kind(other);
    (one.decision == other.decision && sums_up()) || one.to_string() == other.to_string()
}

/// Decisions on a part of an object or of its volume.
const OF_OBJECTS: [Decision; 8] = [
    Decision::AwayTriangles,
    Decision::HiddenTriangles,
    Decision::InnerDarkCap,
    Decision::DarkCap,
    Decision::LightCap,
    Decision::Caps,
    Decision::View,
    Decision::Surfaces,
];

/// Returns which part of an object is left out, and whether a number comes before that; `None` for anything else.
fn kind(entry: &LeftOut) -> Option<(&str, bool)> {
    if !OF_OBJECTS.contains(&entry.decision?) || entry.name.is_some() {
        return None;
    }
    let counted = entry.count.and_then(|count| entry.what.strip_prefix(&numbers::count(count)));
    Some(counted.map_or((entry.what.as_str(), false), |which| (which, true)))
}

fn thing(entries: &[&LeftOut]) -> LeftOutThing {
    let titles: Vec<String> = entries.iter().map(ToString::to_string).collect();
    let objects: BTreeSet<&str> = entries.iter().map(|entry| entry.of.as_str()).collect();
    match (entries, kind(entries[0])) {
        ([_], _) => LeftOutThing { title: titles.into_iter().collect(), each: Vec::new() },
        // Several objects may have one name.
        (_, Some((which, has_number))) if objects.len() > 1 || titles.iter().any(|title| *title != titles[0]) => {
            let sum = numbers::count(entries.iter().filter_map(|entry| entry.count).sum());
            let of = match objects.len() {
                1 => entries[0].of.clone(),
                many => numbers::counted(many as u64, "object"),
            };
            let all =
                LeftOut { what: if has_number { sum + which } else { which.to_owned() }, of, ..entries[0].clone() };
            LeftOutThing { title: all.to_string(), each: titles }
        }
        _ => LeftOutThing { title: format!("{} ×{}", titles[0], titles.len()), each: Vec::new() },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_of_several_objects_are_summed_up_and_what_repeats_is_counted() {
        let because = "the mesh is closed";
        let hidden = |count, of: &str| LeftOut::counted(Decision::HiddenTriangles, count, of, because);
        let other = LeftOut::counted(Decision::HiddenTriangles, 3, "ball", "another reason");
        let left_out =
            [hidden(1200, "ring"), LeftOut::new(Decision::DarkCap, "ring", because), hidden(34, "ball"), other];
        let found = by_reason(&left_out);
        assert_eq!(found.iter().map(|reason| reason.because).collect::<Vec<_>>(), [because, "another reason"]);
        let [all, cap] = &found[0].things[..] else { panic!("{found:?}") };
        assert!(all.title.starts_with("1\u{a0}234 triangles of 2 objects"), "{}", all.title);
        assert_eq!(all.each, [left_out[0].to_string(), left_out[2].to_string()]);
        assert_eq!((cap.title.as_str(), cap.each.len()), (left_out[1].to_string().as_str(), 0));
        assert_eq!(found[1].things[0].title, left_out[3].to_string());
        // Whose number is not said.
        let away = ["ring", "ball"].map(|of| LeftOut::new(Decision::AwayTriangles, of, because));
        assert_eq!(by_reason(&away)[0].things[0].title, "triangles of 2 objects that face away");
        // Twice the same, and twice of one object.
        let [cap, none] = [LeftOut::new(Decision::DarkCap, "ring", because), hidden(5, "ring")];
        assert_eq!(by_reason(&[cap.clone(), cap.clone()])[0].things[0].title, format!("{cap} ×2"));
        assert_eq!(by_reason(&[none.clone(), none.clone()])[0].things[0].title, format!("{none} ×2"));
        // Of two objects of one name.
        let same = [hidden(5, "ring"), hidden(7, "ring")];
        let [sum] = &by_reason(&same)[0].things[..] else { panic!("one thing") };
        assert_eq!(
            (&sum.title, &sum.each[..]),
            (&hidden(12, "ring").to_string(), &same.each_ref().map(ToString::to_string)[..])
        );
    }
}
