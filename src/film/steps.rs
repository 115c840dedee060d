//! A picture of a pass in a film: what the pass writes, as in its thumbnail, over a bar with its technique, number and name.

use crate::capture::Capture;
use crate::numbers;
use crate::picture::Picture;
use crate::picture::caption;
use crate::picture::colors;
use crate::picture::svg::SvgError;
use crate::reading::both_sides::SidePoint;
use crate::reading::steps;
use crate::reading::written::WrittenAspects;

/// The text for a pass that writes nothing.
const NOTHING: &str = "writes nothing";

/// Returns the picture of what a side of a film shows: what a pass wrote, with a bar for the side's name, the pass, light
/// and kind of picture below. A frame's pixels are shown one to one; a map of another size is fitted into the frame's
/// size, in the middle; in the others the `pick` is marked. Without anything written, or before the first pass, the picture is empty; a side that has no such
/// pass as the other stays as it was, and says so.
pub fn side_picture(capture: &Capture, name: &str, at: SidePoint, pick: Option<[u32; 2]>) -> Result<Picture, SvgError> {
    let mut picture = Picture::filled(capture.size, colors::BACKGROUND);
    let (SidePoint::At(index) | SidePoint::StaysAt(index)) = at else {
        return caption::captioned(&picture, [&format!("{name} · not begun"), ""]);
    };
    let written = WrittenAspects::by_step(capture, index);
    if let Some(written) = &written {
        let mut shown = written.picture();
        // In a map a pixel of the frame is none.
        if shown.size() == capture.size {
            super::mark(&mut shown, pick);
        }
        let shown = shown.fitted(capture.size);
        let [left, top] = [0, 1].map(|side| (capture.size[side] - shown.size()[side]) / 2);
        picture.paste(&shown, [left, top]);
    }
    let title = format!("{name} · {}", steps::title(capture, index));
    let right = match at {
        SidePoint::StaysAt(_) => "has no such pass: stays".to_owned(),
        _ => {
            let light = capture.steps.get(index).and_then(|step| step.light);
            let light = light.map(|light| format!("{} · ", numbers::light(light)));
            light.unwrap_or_default() + written.map_or(NOTHING, |written| written.name)
        }
    };
    caption::captioned(&picture, [&title, &right])
}
