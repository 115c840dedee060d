//! An adapter's profile in words: every number with its unit.

use super::AdapterProfile;
use crate::numbers::digits;
use crate::plan::ExactRange;

impl AdapterProfile {
    /// Returns all that the profile says, in words, a sentence each.
    pub fn sentences(&self) -> Vec<String> {
        // Named one by one, so that a number that is added later can't be forgotten here.
        let AdapterProfile {
            subpixel_bits,
            depth_error,
            far_edge_error,
            behind_eye_error,
            draws_infinity,
            repeats_depth,
            largest_picture,
        } = *self;
        let far: Vec<String> = far_edge_error
            .iter()
            .zip(AdapterProfile::FAR)
            .map(|(error, far)| format!("{} pixels off at {far:e}", digits(*error)))
            .collect();
        let ExactRange { far: limit, behind_eye, infinity, coarse_step } = self.exact_range();
        let beyond = match limit {
            0.0 => "what reaches beyond the picture is clipped first".to_owned(),
            limit => {
                format!(
                    "corners up to {limit:e} pixels outside are drawn as they are, what lies beyond is clipped first"
                )
            }
        };
        let is_drawn = |is: bool| if is { "as it is" } else { "clipped first" };
        vec![
            format!("corners snap to 1/{} of a pixel ({subpixel_bits} bits)", 1_u64 << subpixel_bits.min(63)),
            format!("depth of ordinary triangles: {} pixels of slope off", digits(depth_error)),
            format!("edges whose ends lie so many pixels outside of the picture: {}", far.join(", ")),
            format!("depth on a floor with corners behind the eye: {} of itself off", digits(behind_eye_error)),
            format!("a corner at infinity (w = 0): {}", if draws_infinity { "drawn right" } else { "not drawn right" }),
            format!(
                "depth of the same triangles in two passes: {}",
                match repeats_depth {
                    true => "equal to the bit",
                    false => "not always equal",
                }
            ),
            format!("largest picture: {largest_picture} pixels a side"),
            format!("so {beyond}; behind the eye: {}; at infinity: {}", is_drawn(behind_eye), is_drawn(infinity)),
            match coarse_step {
                None => "corners are given as they are".to_owned(),
                Some(step) => {
                    format!("corners are put on the grid of {} pixels first, each with its plane's depth", digits(step))
                }
            },
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_has_its_unit() {
        let profile = AdapterProfile {
            subpixel_bits: 4,
            depth_error: 0.041,
            far_edge_error: [0.018, 0.017, 0.042, 0.26],
            behind_eye_error: 0.015,
            draws_infinity: false,
            repeats_depth: true,
            largest_picture: 8192,
        };
        let text = profile.sentences().join("\n");
        for words in [
            "1/16 of a pixel (4 bits)",
            "0.0410 pixels of slope",
            "0.0180 pixels off at 1e3, ",
            "0.2600 pixels off at 1e7",
            "0.0150 of itself",
            "not drawn right",
            "equal to the bit",
            "8192 pixels a side",
            "up to 1e6 pixels",
            "behind the eye: clipped first; at infinity: clipped first",
        ] {
            assert!(text.contains(words), "`{words}` is not in\n{text}");
        }
    }
}
