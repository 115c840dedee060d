//! What a light sees, in layers: the faces of its shadow map, the textures of receivers, or the
//! silhouettes of casters; what each is called, and the picture of one or all.

use crate::capture::{Capture, Snapshot};
use crate::plan::DecidedBy;

/// Names of a cube map's faces in wgpu's order.
pub const CUBE_FACES: [&str; 6] = ["+x", "−x", "+y", "−y", "+z", "−z"];

named_enum! {
    /// What the layers of a light's map store. Its name is the text on the button of
    /// [`PictureKind::Map`](super::picture_view::PictureKind::Map).
    pub enum MapContent(
        /// What the picture shows.
        meaning,
        /// What a layer is called in the Pixel panel.
        one,
        /// What a light's map is called as a whole, in a sentence.
        whole
    ) {
        /// How far the casters are, seen from the light.
        Depth = "Shadow map" ("Depth as the light sees it", "map", "shadow map"),
        /// How much light arrives on each flat receiver.
        Textures = "Textures" ("How much of the light arrives on each flat receiver", "texture", "textures"),
        /// How much light each caster lets through.
        Silhouettes = "Silhouettes" ("How much of the light each caster lets through", "silhouette", "silhouettes"),
    }
}

/// The names of one layer of a light's map, and why it is empty if no pass drew it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MapLayer {
    /// Short name: `−x`, `floor, flat piece 1`.
    pub name: String,
    /// Full name: `face −x`, `texture of floor, flat piece 1`.
    pub full_name: String,
    /// Why no pass drew the layer; `None` where one did.
    pub note: Option<&'static str>,
}

impl MapContent {
    /// Returns what the map of the light with this index stores; `None` where it has no map.
    pub fn of(capture: &Capture, light: usize) -> Option<MapContent> {
        let light = capture.lights.get(light)?;
        let map = light.map.as_ref()?;
        Some(match light.decided_by {
            DecidedBy::Silhouettes => MapContent::Silhouettes,
            _ if map.holds_colors() => MapContent::Textures,
            _ => MapContent::Depth,
        })
    }

    /// Returns what the map of the first light that has one stores; `None` where no light has one.
    pub fn of_capture(capture: &Capture) -> Option<MapContent> {
        (0..capture.lights.len()).find_map(|light| MapContent::of(capture, light))
    }
}

/// Returns the names of the layers of a light's map, in order; empty where the light has no map or does not exist.
pub fn layers(capture: &Capture, light: usize) -> Vec<MapLayer> {
    let map = capture.lights.get(light).and_then(|light| light.map.as_ref());
    let count = map.map_or(0, |map| map.faces.len());
    let Some(content) = MapContent::of(capture, light) else { return Vec::new() };
    (0..count).map(|index| layer(capture, light, content, index, count)).collect()
}

fn layer(capture: &Capture, light: usize, content: MapContent, index: usize, count: usize) -> MapLayer {
    if content == MapContent::Depth {
        let name = match (count, CUBE_FACES.get(index)) {
            (6, Some(name)) => (*name).to_owned(),
            _ => (index + 1).to_string(),
        };
        return MapLayer { full_name: format!("face {name}"), name, note: None };
    }
    let drew = Snapshot::Map { light, face: index };
    match capture.steps.iter().find(|step| step.snapshot == drew) {
        Some(step) => {
            let map = capture.lights.get(light).and_then(|light| light.map.as_ref());
            let name = map.and_then(|map| map.layer_names.get(index)).unwrap_or(&step.name);
            MapLayer { name: name.clone(), full_name: step.name.clone(), note: None }
        }
        None => {
            let name = format!("layer {}", index + 1);
            MapLayer { full_name: name.clone(), name, note: Some("not drawn: all light arrives") }
        }
    }
}
