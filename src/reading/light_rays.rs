//! What the ray from each light to the surface at a pixel meets, by the truth: it knows the scene, and no technique.

use crate::numbers;
use crate::scene::Scene;
use crate::truth::{OccluderHit, PixelLabel, Tracer, TruthError};
use serde::Serialize;

/// The ray from a light to the surface at a pixel's centre.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LightRay {
    /// Index of the light.
    pub light: usize,
    /// What the light does there in truth.
    pub label: PixelLabel,
    /// The casting triangles between light and surface, the nearest to the surface first; the label counts none where the
    /// surface faces away, is out of the light's range or receives no shadow.
    pub occluders: Vec<Occluder>,
}

/// A casting triangle between a light and a surface.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Occluder {
    /// Name of its object.
    pub object: String,
    /// Index of the triangle in the object's mesh.
    pub triangle: usize,
    /// Distance from the surface along the ray, metres.
    pub from_surface: f64,
    /// Distance from the light, metres; `None` for a directional one, which is at infinity.
    pub from_light: Option<f64>,
}

/// A scene prepared for following rays from its lights.
#[derive(Debug)]
pub struct RayFollower(Tracer);

impl RayFollower {
    /// Prepares a scene for a picture of `size` pixels.
    ///
    /// # Errors
    /// A camera, a light or an object that can't be traced.
    pub fn new(scene: &Scene, size: [u32; 2]) -> Result<RayFollower, TruthError> {
        Tracer::new(scene, size).map(RayFollower)
    }

    /// Follows a ray from every light to what a pixel shows; none where it shows nothing.
    pub fn at(&self, pixel: [u32; 2]) -> Vec<LightRay> {
        let tracer = &self.0;
        let center = pixel.map(|at| f64::from(at) + 0.5);
        let Some(seen) = tracer.seen_at(center) else { return Vec::new() };
        let of_light = |light: usize| {
            let distance = tracer.light_distance(light, seen.point);
            let occluder = |hit: OccluderHit| Occluder {
                object: tracer.name(hit.place).to_owned(),
                triangle: hit.place.triangle,
                from_surface: hit.towards_light,
                from_light: distance.is_finite().then_some(distance - hit.towards_light),
            };
            let [byte] = tracer.labels_at(light, [center]);
            let label = PixelLabel::from_byte(byte)?;
            let occluders = tracer.between(light, &seen).into_iter().map(occluder).collect();
            Some(LightRay { light, label, occluders })
        };
        tracer.lights().into_iter().filter_map(of_light).collect()
    }
}

impl LightRay {
    /// Returns the names of the objects that keep the light away, the nearest to the surface first; none where it is not
    /// kept away by anything.
    pub fn casters(&self) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        for occluder in self.occluders.iter().filter(|_| self.label == PixelLabel::Shadow) {
            if !names.contains(&occluder.object) {
                names.push(occluder.object.clone());
            }
        }
        names
    }

    /// Returns a line that says what the ray meets; triangles count from 1.
    pub fn text(&self) -> String {
        format!("  {}, by its ray: {}\n", numbers::light(self.light), self.words())
    }

    /// Returns in a few words what the ray meets; triangles count from 1.
    pub fn words(&self) -> String {
        match (self.label, &self.occluders[..]) {
            (PixelLabel::FacesAway, _) => "the surface faces away from it, or is out of its range".to_owned(),
            (PixelLabel::Shadow, [first, others @ ..]) => {
                let more = match others.len() {
                    0 => String::new(),
                    count => format!("; {} behind it", numbers::counted(count as u64, "more triangle")),
                };
                format!("kept away by {}{more}", first.text())
            }
            (_, [first, ..]) => format!("the surface receives no shadow, though {} is between", first.text()),
            (_, []) => "nothing is between it and the surface".to_owned(),
        }
    }
}

impl Occluder {
    fn text(&self) -> String {
        let from_light = self.from_light.map_or_else(
            || "the light is at infinity".to_owned(),
            |metres| format!("{} from the light", numbers::metres(metres)),
        );
        let Occluder { object, triangle, from_surface, .. } = self;
        format!(
            "triangle {} of {object}, {} from the surface, {from_light}",
            triangle + 1,
            numbers::metres(*from_surface)
        )
    }
}
