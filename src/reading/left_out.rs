//! What a frame left out, by reason.

use crate::plan::LeftOut;

/// Returns each reason with what was left out for it, in the order of the frame. The same decision is often made for
/// every light and for many objects with one reason: it is listed once.
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
