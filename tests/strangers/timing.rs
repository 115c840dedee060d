//! How long frames take that are not recorded.

use std::time::Instant;

/// Draws frames by turns, and says how long those of the second took, in parts of those of the first.
pub fn compare(turns: u32, mut draw: [impl FnMut(); 2]) {
    let mut milliseconds = [Vec::new(), Vec::new()];
    for turn in 0..turns + 1 {
        for which in 0..2 {
            let which = (which + turn as usize) % 2;
            let begin = Instant::now();
            draw[which]();
            // The first makes pipelines.
            if turn > 0 {
                milliseconds[which].push(begin.elapsed().as_secs_f64() * 1e3);
            }
        }
    }
    let mut ratios: Vec<f64> = milliseconds[0].iter().zip(&milliseconds[1]).map(|(plain, ours)| ours / plain).collect();
    let [plain, ours] = milliseconds.map(|mut of| middle(&mut of));
    println!(
        "{plain:.3} ms plain, {ours:.3} ms by an instance that could record: {:.4}; the middle ratio of {turns} pairs is {:.4}",
        ours / plain,
        middle(&mut ratios)
    );
}

fn middle(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
