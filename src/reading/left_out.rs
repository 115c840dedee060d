//! What a frame left out, by reason.

use crate::plan::LeftOut;

/// Groups what a plan left out by reason, in the order of the frame: returns each reason with the things it was given
/// for. A thing that is left out several times with one reason is listed once, with a count.
pub fn by_reason(left_out: &[LeftOut]) -> Vec<(&str, Vec<String>)> {
    let mut reasons: Vec<(&str, Vec<(String, u32)>)> = Vec::new();
    for entry in left_out {
        let title = entry.to_string();
        let place = reasons.iter().position(|(because, _)| *because == entry.because).unwrap_or(reasons.len());
        if place == reasons.len() {
            reasons.push((&entry.because, Vec::new()));
        }
        let titles = &mut reasons[place].1;
        match titles.iter_mut().find(|(known, _)| *known == title) {
            Some((_, times)) => *times += 1,
            None => titles.push((title, 1)),
        }
    }
    let named = |(title, times)| if times > 1 { format!("{title} ×{times}") } else { title };
    reasons.into_iter().map(|(because, titles)| (because, titles.into_iter().map(named).collect())).collect()
}
