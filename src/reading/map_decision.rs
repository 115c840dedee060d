//! Which texels of a light's shadow map decided a pixel: the depth that each stores against the pixel's own, as
//! `arriving_by_map.wgsl` compares them, and the decision in words.

use crate::capture::Capture;
use crate::numbers;
use crate::reading::depth::DepthMeasure;
use crate::reading::format;
use crate::reading::layers;
use crate::reading::map_readers::{MapReaders, MapTexel};
use crate::truth::{LIT, SHADOW};

/// A shadow map texel that is compared with a pixel's surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ComparedTexel {
    /// The texel.
    pub texel: MapTexel,
    /// The depth that the map stores there, bias included.
    pub stored: f32,
    /// The depth of the pixel's surface in the map, at this texel.
    pub depth: f32,
    /// Whether a caster was drawn there; otherwise the texel has the clear value.
    pub is_caster: bool,
    /// Whether the comparison lets the light pass: nothing nearer to the light is stored.
    pub is_lit: bool,
}

/// How a light's shadow map decides whether a pixel is lit, computed on the CPU.
#[derive(Debug, Clone, PartialEq)]
pub struct MapDecision {
    /// Index of the light.
    pub light: usize,
    /// The texels that are compared, row by row: one, or K × K of a filter.
    pub compared: Vec<ComparedTexel>,
    /// The texel in the middle of `compared`.
    pub middle: ComparedTexel,
    /// Name of the map's face, such as `−x`; empty where there is only one.
    pub face: String,
    /// Converts depths of this face to metres; `None` where its matrix is not known.
    pub measure: Option<DepthMeasure>,
    /// Whether another program made the map: what its shader does with it is not known.
    pub is_recorded: bool,
    /// Whether it is lit only by a bias: its texel stores its own surface as nearer.
    pub needs_bias: bool,
    /// Whether the light sends out nothing, so that nothing is added wherever it is lit.
    pub is_off: bool,
    /// The GPU's answer, `lit` or `in shadow`, where this computation gives another one: the depths are too close.
    pub gpu_says: Option<&'static str>,
}

impl MapDecision {
    /// Computes how the depth map of the light with this index decides a pixel: each texel of its filter compared again
    /// here; notes where the GPU's label says otherwise. `None` where there is no map or the pixel reads no texel.
    pub fn of(capture: &Capture, readers: &MapReaders, light: usize, pixel: [u32; 2]) -> Option<MapDecision> {
        let map = capture.lights.get(light)?.map.as_ref()?;
        let compare = |(texel, depth): (MapTexel, f64)| {
            let stored = map.faces.get(texel.face)?.depth_at(texel.at)?;
            let depth = depth as f32;
            let (projection, is_lit) = (readers.projection(), readers.projection().is_lit(stored, depth));
            let is_caster = stored != projection.lookup().clear_depth;
            Some(ComparedTexel { texel, stored, depth, is_caster, is_lit })
        };
        let compared: Vec<ComparedTexel> = readers.compared(pixel).into_iter().filter_map(compare).collect();
        let at = readers.texel_of(pixel)?;
        let middle = *compared.iter().find(|one| one.texel == at)?;
        let layers = layers::layers(capture, light);
        let face = layers.get(at.face).filter(|_| layers.len() > 1).map_or_else(String::new, |face| face.name.clone());
        let measure = DepthMeasure::of_map(capture, light, at.face);
        let mut decision = MapDecision {
            light,
            compared,
            middle,
            face,
            measure,
            is_recorded: capture.origin.is_some(),
            needs_bias: false,
            is_off: readers.is_off(),
            gpu_says: None,
        };
        let unbiased = readers.depth_of(pixel).map(|depth| depth as f32);
        let is_dark_unbiased = unbiased.is_some_and(|depth| !readers.projection().is_lit(middle.stored, depth));
        decision.needs_bias = decision.is_recorded && middle.is_lit && is_dark_unbiased;
        let is_lit = 2 * decision.lit() >= decision.compared.len();
        decision.gpu_says = match capture.lights.get(light)?.shadow.as_ref().and_then(|mask| mask.byte_at(pixel)) {
            Some(LIT) if !is_lit => Some("lit"),
            Some(SHADOW) if is_lit => Some("in shadow"),
            _ => None,
        };
        Some(decision)
    }

    /// Returns how many of the compared texels let the light pass.
    pub fn lit(&self) -> usize {
        self.compared.iter().filter(|one| one.is_lit).count()
    }

    /// Returns a stored depth as text, followed in parentheses by its distance from the light in metres where that is
    /// known.
    pub fn depth_words(&self, depth: f32) -> String {
        let metres = self.measure.and_then(|measure| measure.value(depth)).map(format::metres);
        metres.map_or_else(|| format::depth(depth), |metres| format!("{} ({metres})", format::depth(depth)))
    }

    /// Returns the depth that the middle texel stores as text, or `no caster`.
    pub fn stored_words(&self) -> String {
        if self.middle.is_caster { self.depth_words(self.middle.stored) } else { "no caster".to_owned() }
    }

    /// Returns the middle texel's column, row and face: `412, 300 of face −x`.
    pub fn place_words(&self) -> String {
        let [x, y] = self.middle.texel.at;
        if self.face.is_empty() { format!("{x}, {y}") } else { format!("{x}, {y} of face {}", self.face) }
    }

    /// Returns the result of the comparison in a few words: of one texel, what is stored and whether it is lit; of
    /// several, how many are lit; or that it is too close to be computed again where the GPU says otherwise.
    pub fn outcome(&self) -> String {
        let all = self.compared.len();
        match (all, self.lit()) {
            _ if self.gpu_says.is_some() => "too close to tell anew".to_owned(),
            (1, 0) => "stored is nearer to the light: shadow".to_owned(),
            (1, _) if self.middle.is_caster => "stored is not nearer: lit".to_owned(),
            (1, _) => "nothing is stored: lit".to_owned(),
            (_, lit) => format!("{lit} of {all} hold nothing nearer: {lit}/{all} lit"),
        }
    }

    /// Returns how far the stored depth and the surface's own are apart, metres; `None` where that is not known.
    fn apart(&self) -> Option<f64> {
        let away = |depth: f32| self.measure.and_then(|measure| measure.value(depth));
        Some((away(self.middle.stored)? - away(self.middle.depth)?).abs())
    }

    /// Returns a sentence that explains why the map makes the pixel dark or lit: what the middle texel stores, the
    /// surface's own distance or depth, and what follows; or that it is too close to be computed again where the GPU
    /// says otherwise.
    pub fn sentence(&self) -> String {
        let place = self.place_words();
        let distance = |depth: f32| self.measure.and_then(|measure| measure.value(depth)).map(format::metres);
        let both = (distance(self.middle.stored), distance(self.middle.depth));
        let facts = match (self.middle.is_caster, both.0, both.1) {
            (false, _, _) => format!("Texel {place} holds no caster"),
            (true, Some(stored), Some(own)) if stored == own => {
                let by =
                    self.apart().map_or_else(String::new, |by| format!(" but for {}", numbers::small_length(by, "m")));
                format!(
                    "Texel {place} holds a caster at a depth of {stored} along the map's axis, and this surface is at the same{by}"
                )
            }
            (true, Some(stored), Some(own)) => {
                format!(
                    "Texel {place} holds a caster at a depth of {stored} along the map's axis, and this surface is at {own}"
                )
            }
            (true, _, _) => {
                let [stored, own] = [self.middle.stored, self.middle.depth].map(format::depth);
                format!("Texel {place} holds depth {stored}, and this surface has {own}")
            }
        };
        let all = self.compared.len();
        if let Some(says) = self.gpu_says {
            return format!("{facts}: too close to tell by depths computed anew; the GPU's own say {says}.");
        }
        let follows = match self.lit() {
            lit if all > 1 => format!("of the {all} texels read, {lit} hold nothing nearer to the light"),
            0 if self.is_recorded => "a caster is nearer to the light, so by the map it is in shadow".to_owned(),
            _ if self.needs_bias => {
                "that is its own surface, so by the map it is lit, but without a bias it would be dark".to_owned()
            }
            _ if self.is_recorded => "nothing nearer is stored, so by the map it is lit".to_owned(),
            0 => "the caster is nearer, so the light pass adds nothing".to_owned(),
            _ if self.is_off => {
                "nothing nearer is stored, but the light is off, and the light pass adds nothing".to_owned()
            }
            _ => "nothing nearer is stored, so the light pass adds the light".to_owned(),
        };
        format!("{facts}: {follows}.")
    }
}
