//! Sweeps: a scene measured at several values of one number, to see how cost and error grow with it.

use super::Measurement;
use crate::numbers;
use crate::report::SweepValue;
use crate::scene::{Scene, VaryError};
use crate::technique::Choice;
use std::str::FromStr;

/// The most values of a sweep that are given as a range.
const MOST_OF_RANGE: usize = 7;
/// Limit on the number of values that a sweep has.
const MOST: usize = 64;
/// Limits on the lights, casters and triangles of a swept scene.
const MOST_LIGHTS: f64 = 64.0;
const MOST_CASTERS: f64 = 65_536.0;
const MOST_TRIANGLES: f64 = 1e7;
/// The largest picture and map, texels a side.
const LARGEST: f64 = 16_384.0;
/// The setting that `map-size` sweeps over.
const SIZE: &str = "size";

/// What changes in a sweep, and its values.
#[derive(Debug, Clone, PartialEq)]
pub enum Sweep {
    /// Width and height of the picture in pixels.
    Size(Vec<[u32; 2]>),
    /// How many lights there are.
    Lights(Vec<usize>),
    /// How many objects cast shadows.
    Casters(Vec<usize>),
    /// Triangles of all casters together.
    Triangles(Vec<usize>),
    /// Texels a side, for the techniques that have the setting `size`.
    MapSize(Vec<usize>),
}

impl FromStr for Sweep {
    type Err = String;

    /// Parses `size=640x360,1280x720`, `lights=1..4`, `triangles=1e3..1e6`.
    fn from_str(text: &str) -> Result<Sweep, String> {
        let (name, values) = text.split_once('=').ok_or("give a name and values, as `lights=1..4`")?;
        let whole = |most: f64| -> Result<Vec<usize>, String> {
            let values = values_of(values, |text| {
                let value = text.parse::<f64>().ok().filter(|value| (1.0..=most).contains(value))?;
                Some(vec![value])
            });
            let values = values.ok_or_else(|| {
                let most = numbers::count(most as u64);
                format!("give whole numbers from 1 to {most}, as `a,b,c` or `a..b`; ranges from low to high")
            })?;
            Ok(values.into_iter().map(|value| value[0].round() as usize).collect())
        };
        match name {
            "size" => {
                let sides = values_of(values, |text| {
                    let (width, height) = text.split_once(['x', 'X'])?;
                    let sides = [width.parse().ok()?, height.parse().ok()?];
                    sides.iter().all(|side| (1.0..=LARGEST).contains(side)).then(|| sides.to_vec())
                });
                let sides = sides.ok_or("give sizes, as `640x360,1280x720` or `320x180..1920x1080`")?;
                Ok(Sweep::Size(sides.iter().map(|side| [side[0].round() as u32, side[1].round() as u32]).collect()))
            }
            "lights" => whole(MOST_LIGHTS).map(Sweep::Lights),
            "casters" => whole(MOST_CASTERS).map(Sweep::Casters),
            "triangles" => whole(MOST_TRIANGLES).map(Sweep::Triangles),
            "map-size" => whole(LARGEST).map(Sweep::MapSize),
            _ => Err("sweep over `size`, `lights`, `casters`, `triangles` or `map-size`".to_owned()),
        }
    }
}

/// Returns the values of `a,b,c`, or of `a..b` whole numbers from `a` to `b`: even steps where few are between, else
/// even ratios; each distinct. `None` where a value can't be read, `b` is less than `a`, or they are too many.
fn values_of(text: &str, read: impl Fn(&str) -> Option<Vec<f64>>) -> Option<Vec<Vec<f64>>> {
    let mut values = match text.split_once("..") {
        None => text.split(',').map(|value| read(value.trim())).collect::<Option<Vec<_>>>()?,
        Some((from, to)) => {
            let (from, to) = (read(from.trim())?, read(to.trim())?);
            let span = from.iter().zip(&to).map(|(from, to)| (to - from, to / from)).collect::<Vec<_>>();
            if span.iter().any(|(by, _)| *by < 0.0) {
                return None;
            }
            let by = span.iter().map(|(by, _)| *by).fold(0.0, f64::max);
            let ratio = span.iter().map(|(_, ratio)| *ratio).fold(1.0, f64::max);
            if by < MOST_OF_RANGE as f64 {
                let steps = by.round() as usize;
                let at = |step: usize| {
                    let share = step as f64 / steps.max(1) as f64;
                    from.iter().zip(&span).map(|(from, (by, _))| (from + by * share).round()).collect()
                };
                (0..=steps).map(at).collect()
            } else {
                let steps = (ratio.log2().round() as usize).clamp(1, MOST_OF_RANGE - 1);
                let at = |step: usize| {
                    let share = step as f64 / steps as f64;
                    from.iter().zip(&span).map(|(from, (_, ratio))| (from * ratio.powf(share)).round()).collect()
                };
                (0..=steps).map(at).collect()
            }
        }
    };
    let mut seen: Vec<Vec<f64>> = Vec::new();
    values.retain(|value| {
        !seen.contains(value) && {
            seen.push(value.clone());
            true
        }
    });
    (values.len() <= MOST).then_some(values)
}

/// One measurement of a sweep: the scene at one value, and what to measure on it.
#[derive(Debug, Clone)]
pub struct SweepBlock {
    /// The scene at that value.
    pub scene: Scene,
    /// What to measure on it.
    pub what: Measurement,
    /// The value; `None` without a sweep.
    pub swept: Option<SweepValue>,
}

impl Sweep {
    /// Returns the name of the swept quantity, as the command line has it.
    pub fn name(&self) -> &'static str {
        match self {
            Sweep::Size(_) => "size",
            Sweep::Lights(_) => "lights",
            Sweep::Casters(_) => "casters",
            Sweep::Triangles(_) => "triangles",
            Sweep::MapSize(_) => "map-size",
        }
    }

    /// Returns a scene with its measurement for each value. Over map sizes, techniques without maps are left out, as
    /// nothing changes for them; an error where none is left, or the scene can't be varied so.
    pub fn blocks(&self, scene: &Scene, what: &Measurement) -> Result<Vec<SweepBlock>, VaryError> {
        let swept = |value: f64, text: String| Some(SweepValue { name: self.name().to_owned(), value, text });
        let counted = |value: &usize| swept(*value as f64, numbers::count(*value as u64));
        let varied = |values: &[usize], scene_at: &dyn Fn(usize) -> Result<Scene, VaryError>| {
            let block =
                |value: &usize| Ok(SweepBlock { scene: scene_at(*value)?, what: what.clone(), swept: counted(value) });
            values.iter().map(block).collect()
        };
        match self {
            Sweep::Size(sizes) => {
                let block = |size: &[u32; 2]| {
                    let pixels = f64::from(size[0]) * f64::from(size[1]);
                    let swept = swept(pixels, format!("{}×{}", size[0], size[1]));
                    SweepBlock { scene: scene.clone(), what: Measurement { size: *size, ..what.clone() }, swept }
                };
                Ok(sizes.iter().map(block).collect())
            }
            Sweep::Lights(values) => varied(values, &|value| scene.with_lights(value)),
            Sweep::Casters(values) => varied(values, &|value| scene.with_casters(value)),
            Sweep::Triangles(values) => varied(values, &|value| scene.with_triangles(value)),
            Sweep::MapSize(values) => {
                let block = |value: &usize| SweepBlock {
                    scene: scene.clone(),
                    what: Measurement { choices: with_map_size(&what.choices, *value), ..what.clone() },
                    swept: counted(value),
                };
                let blocks: Vec<SweepBlock> = values.iter().map(block).collect();
                let is_empty = blocks.iter().any(|block| block.what.choices.is_empty());
                if is_empty { Err(VaryError::None("technique whose maps have such a size")) } else { Ok(blocks) }
            }
        }
    }
}

/// Returns the choices whose technique has a map size that may be `size`, with that size, each once; others are left
/// out.
fn with_map_size(choices: &[Choice], size: usize) -> Vec<Choice> {
    let mut sized: Vec<Choice> = Vec::new();
    for choice in choices {
        let mut choice = choice.clone();
        let has_map = choice.settings().contains_key(SIZE) && choice.set(SIZE, &size.to_string()).is_ok();
        if has_map && !sized.contains(&choice) {
            sized.push(choice);
        }
    }
    sized
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sweep(text: &str) -> Sweep {
        text.parse().expect("a sweep")
    }

    #[test]
    fn values_are_listed_or_stepped_through() {
        assert_eq!(sweep("lights=1..4"), Sweep::Lights(vec![1, 2, 3, 4]));
        assert_eq!(sweep("lights=3"), Sweep::Lights(vec![3]));
        assert_eq!(sweep("casters=1,8,8,2"), Sweep::Casters(vec![1, 8, 2]));
        assert_eq!(
            sweep("triangles=1e3..1e6"),
            Sweep::Triangles(vec![1000, 3162, 10_000, 31_623, 100_000, 316_228, 1_000_000])
        );
        assert_eq!(sweep("map-size=256..2048"), Sweep::MapSize(vec![256, 512, 1024, 2048]));
        assert_eq!(sweep("size=320x180,640x360"), Sweep::Size(vec![[320, 180], [640, 360]]));
        assert_eq!(sweep("size=320x180..1280x720"), Sweep::Size(vec![[320, 180], [640, 360], [1280, 720]]));
    }

    #[test]
    fn what_is_no_sweep_is_refused() {
        for wrong in [
            "lights",
            "lights=",
            "lights=0",
            "lights=nan",
            "lights=4..1",
            "lights=65",
            "shadows=1",
            "size=640",
            "size=0x1",
            "triangles=1e9",
            "casters=1,,2",
            "map-size=1e6",
        ] {
            assert!(wrong.parse::<Sweep>().is_err(), "{wrong}");
        }
    }
}
