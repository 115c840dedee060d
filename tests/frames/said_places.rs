//! What the scripts of `assets/recordings` say of their light and camera, to hold against what is found.

use stencilscope::glam::{DVec3, DVec4};

/// Where a script says that its light and camera are.
#[derive(Debug)]
pub struct SaidPlaces {
    pub version: String,
    pub light: DVec4,
    eye: DVec3,
    target: DVec3,
    up: DVec3,
    /// The vertical field of view, in degrees.
    degrees: f64,
    /// What distances from the light are divided by, where its map holds them.
    pub far: Option<f64>,
}

impl SaidPlaces {
    pub fn read(text: &str) -> SaidPlaces {
        let words = |key: &str| {
            let line =
                text.lines().find_map(|line| line.strip_prefix(key)).unwrap_or_else(|| panic!("{key} in {text}"));
            line.split_whitespace().map(str::to_owned).collect::<Vec<_>>()
        };
        let values =
            |key: &str| -> Vec<f64> { words(key).iter().map(|word| word.parse().expect("a number")).collect() };
        let (light, camera) = (values("light "), values("camera "));
        let [eye, target, up] = [0, 3, 6].map(|first| DVec3::from_slice(&camera[first..]));
        SaidPlaces {
            version: words("version ")[0].clone(),
            light: DVec4::from_slice(&light),
            eye,
            target,
            up,
            degrees: camera[9],
            far: text.contains("distance ").then(|| values("distance ")[0]),
        }
    }

    /// A place as the camera sees it: x to the right, y up, z backwards.
    fn view(&self, place: DVec4) -> DVec4 {
        let ahead = (self.target - self.eye).normalize();
        let right = ahead.cross(self.up).normalize();
        let from = place.truncate() - self.eye * place.w;
        DVec3::new(from.dot(right), from.dot(right.cross(ahead)), -from.dot(ahead)).extend(place.w)
    }

    /// By how many degrees a light that was found is off, as seen from what the camera looks at. What is found is in the space
    /// of an eye that sees 90 degrees.
    pub fn degrees_off(&self, found: DVec4) -> f64 {
        let stretch = 1.0 / (self.degrees.to_radians() / 2.0).tan();
        let found = DVec4::new(found.x / stretch, found.y / stretch, found.z, found.w);
        let middle = self.view(self.target.extend(1.0)).truncate();
        let [found, said] = [found, self.view(self.light)].map(|light| light.truncate() - middle * light.w);
        found.angle_between(said).to_degrees()
    }
}
