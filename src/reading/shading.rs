//! What each light adds to a pixel's surface if it arrives, term by term, as `surface.wgsl` and `light.wgsl` compute
//! it: light = colour of the light × fading × (colour of the surface × diffuse + highlight).

use super::shading_channels::{ArrivingLight, ShadingChannels, shares};
pub use super::shading_channels::{digits, three};
use crate::capture::{Capture, PixelUnprojection};
use crate::history::{PixelHistory, TriangleEvent};
use crate::numbers;
use crate::plan::{Draw, FramePlan, PlanLight, Program, SurfaceData};
use crate::reading::pick_ray::ray_at;
use crate::scene::Shading;
use crate::truth::PixelLabel;
use glam::{DVec2, DVec3, DVec4};
use serde::Serialize;
use std::fmt::Write;

/// The factor by which dark checks multiply the surface's colour.
const DARK_CHECK: f64 = 1.0 / 3.0;

/// The terms of the shading equation at a pixel: normal, colour, and what each light adds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SurfaceShading {
    /// Name of the draw that shows it.
    pub surface: String,
    /// The shading model: `flat`, `gouraud`, `phong`.
    pub shading: &'static str,
    /// The diffuse model: `lambert`, `wrapped`.
    pub diffuse: &'static str,
    /// The unit shading normal, world space, towards the side that the eye sees; Gouraud shading uses those of the
    /// corners.
    pub normal: [f64; 3],
    /// Linear RGB reflectance, checks and texture included.
    pub color: [f64; 3],
    /// What was read from its texture; `None` where it has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub texture: Option<TextureTerm>,
    /// Strength of the specular highlight.
    pub specular: f64,
    /// Blinn-Phong exponent of the highlight.
    pub shininess: f64,
    /// Linear RGB without any light source: what it reflects of ambient light, and what it emits.
    pub unlit: [f64; 3],
    /// The share of each light's diffuse light that arrives whatever stands between.
    pub ambient_diffuse: f64,
    /// The terms of each light, in the scene's order.
    pub lights: Vec<LightTerms>,
    /// All that arrives by what it is; they add up to the total. `None` where that is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channels: Option<ShadingChannels>,
    /// Linear RGB of all that arrives, as the technique labels it: the picture has this, and 1 where it is more. `None`
    /// where something is blended over the lit picture afterwards.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub total: Option<[f64; 3]>,
}

/// A texture lookup at a pixel's centre.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TextureTerm {
    /// Name of the texture's file.
    pub name: String,
    /// Texture coordinates: (0, 0) is the picture's lower left, (1, 1) its upper right; beyond, it repeats or is
    /// clamped.
    pub uv: [f64; 2],
    /// Column and row of the nearest texel, from the upper left of the largest mip level.
    pub texel: [u32; 2],
    /// The mip level: on level k a texel is 2^k texels large, and the four nearest texels on the two levels beside are
    /// mixed.
    pub level: f64,
    /// The resulting linear RGB: a factor of the surface's colour.
    pub color: [f64; 3],
}

/// The terms of the shading equation for one light.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LightTerms {
    /// The light's linear RGB times its intensity.
    pub color: [f64; 3],
    /// N·L: cosine of the angle between the normal and the direction to the light.
    pub cosine: f64,
    /// N·L at the triangle's corners, where Gouraud shading computes light; else `None`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub corner_cosines: Option<[f64; 3]>,
    /// Whether its triangle faces away from the light, so that Lambert's light is 0 whatever the cosine.
    pub is_turned_away: bool,
    /// Lambert's max(0, N·L), or wrapped (N·L + 1) / 2; with Gouraud shading interpolated from the corners.
    pub diffuse: f64,
    /// Blinn-Phong's strength × max(0, N·H)^exponent, 0 where N·L is; with Gouraud shading interpolated from the
    /// corners.
    pub highlight: f64,
    /// The falloff: the share of the light that is left at this distance, 0 to 1.
    pub fading: f64,
    /// Linear RGB that the light adds where it is not blocked.
    pub adds: [f64; 3],
    /// The technique's label: `lit`, `in shadow`, `faces away`; `None` where it has no mask.
    pub label: Option<PixelLabel>,
}

/// A point of a surface, relative to the eye, with its unit normal.
#[derive(Debug, Clone, Copy)]
struct ShadingPoint {
    relative: DVec3,
    normal: DVec3,
}

#[derive(Debug, Clone, Copy)]
struct ShadingTerms {
    cosine: f64,
    diffuse: f64,
    highlight: f64,
    fading: f64,
}

impl SurfaceShading {
    /// Computes the shading of the surface that a pixel's history ends with; `None` where it shows none, its triangle
    /// or normals are not in the plan, or another program drew the frame.
    pub fn of(capture: &Capture, plan: &FramePlan, history: &PixelHistory) -> Option<SurfaceShading> {
        if capture.origin.is_some() {
            return None;
        }
        let (eye, draw, one) = seen(plan, history)?;
        // What the rasteriser is given is what it interpolates in.
        let (triangle, mesh) = (one.piece? as usize, plan.meshes.get(draw.rasterised().mesh.0)?);
        let surface = mesh.surface.as_ref()?;
        let first = triangle * 3;
        let indices = mesh.corners(triangle as u32, 0)?;
        let corners = mesh.places(indices)?.map(|place| wide(place).truncate());
        let sides = *surface.sides.data().get(triangle)?;
        let normals = normals_seen(surface.normals.of_triangle(triangle, indices)?, sides);
        let world = PixelUnprojection::new(capture).at(history.pixel, history.computed.depth)?;
        let relative = world - capture.camera.eye;
        let weights = weights(corners, relative);
        let mixed = (0..3).map(|corner| normals[corner] * weights[corner]).sum::<DVec3>();
        let at = ShadingPoint { relative, normal: mixed.try_normalize()? };
        let material = &draw.constants.material;
        let seen = SeenTriangle {
            capture,
            pixel: history.pixel,
            corners,
            normal: (corners[1] - corners[0]).cross(corners[2] - corners[0]),
        };
        let texture = texture(plan, draw, surface, first, &seen);
        let share =
            texture.as_ref().map_or([1.0; 3], |texture| texture.color).map(|part| part * checks(draw, relative));
        let color = [0, 1, 2].map(|channel| f64::from(material.color[channel]) * share[channel]);
        let ambient = plan.ambient.map(f64::from);
        let emissive = material.emission.map(f64::from);
        let ambient = [0, 1, 2].map(|channel| color[channel] * ambient[channel]);
        let unasked = f64::from(plan.ambient_diffuse);
        let unlit = [0, 1, 2].map(|channel| ambient[channel] + emissive[channel]);
        let lit = |(index, light): (usize, &PlanLight)| {
            let is_turned_away = sides & (1 << index) != 0;
            let here = terms(at, eye, light, draw, plan.wraps_diffuse);
            let of_corners = (material.shading == Shading::Gouraud).then(|| {
                [0, 1, 2].map(|corner| {
                    let point = ShadingPoint { relative: corners[corner], normal: normals[corner] };
                    terms(point, eye, light, draw, plan.wraps_diffuse)
                })
            });
            let mut found = of_corners.map_or(here, |corners| mix(corners, weights, here.cosine));
            if is_turned_away && !plan.wraps_diffuse {
                (found.diffuse, found.highlight) = (0.0, 0.0);
            }
            let light_color = light.color.map(f64::from);
            let adds = [0, 1, 2].map(|channel| {
                light_color[channel] * found.fading * (color[channel] * found.diffuse + found.highlight)
            });
            let label = capture.lights.get(index).and_then(|light| light.shadow.as_ref()?.byte_at(history.pixel));
            LightTerms {
                color: light_color,
                cosine: here.cosine,
                corner_cosines: of_corners.map(|corners| corners.map(|corner| corner.cosine)),
                is_turned_away,
                diffuse: found.diffuse,
                highlight: found.highlight,
                fading: found.fading,
                adds,
                label: label.and_then(PixelLabel::from_byte),
            }
        };
        let lights: Vec<LightTerms> = plan.lights.iter().enumerate().map(lit).collect();
        let labels: Vec<Option<PixelLabel>> = lights.iter().map(|light| light.label).collect();
        let channels = shares(capture, plan, history, world, &labels).map(|shares| {
            let arriving = shares.into_iter().zip(&lights).map(|(share, light)| ArrivingLight {
                color: light.color.map(|channel| channel * light.fading),
                share,
                diffuse: light.diffuse,
                highlight: light.highlight,
            });
            ShadingChannels::new([ambient, emissive], color, unasked, &arriving.collect::<Vec<_>>())
        });
        Some(SurfaceShading {
            total: channels.map(|channels| channels.sum()),
            channels,
            surface: draw.name.clone(),
            shading: material.shading.name(),
            diffuse: if plan.wraps_diffuse { "wrapped" } else { "lambert" },
            normal: at.normal.to_array(),
            color,
            texture,
            specular: material.specular.into(),
            shininess: material.shininess.into(),
            unlit,
            ambient_diffuse: unasked,
            lights,
        })
    }

    /// Returns a line for the surface, one for its texture if any, and one for each light.
    pub fn text(&self) -> String {
        let mut text = format!(
            "  {}, {} shading: normal {}, colour {}; without light {}\n",
            self.surface,
            self.shading,
            three(self.normal),
            three(self.color),
            three(self.unlit)
        );
        if let Some(TextureTerm { name, uv: [u, v], texel: [column, row], level, color }) = &self.texture {
            // Writing to a string can't fail.
            let _ = writeln!(
                text,
                "    its colour is times ({}) of {name}, at u {}, v {}: texel {column},{row}, level {}",
                three(*color),
                digits(*u),
                digits(*v),
                digits(*level)
            );
        }
        for (index, light) in self.lights.iter().enumerate() {
            // Writing to a string can't fail.
            let _ = writeln!(text, "    {}: {}", numbers::light(index), light.text(self));
        }
        let _ = writeln!(text, "    together {}", self.total_words());
        if let Some(channels) = &self.channels {
            let _ = writeln!(text, "    which is {}", channels.words());
        }
        text
    }

    /// Returns the sum of all light that arrives, and which channels saturate, or why there is none.
    pub fn total_words(&self) -> String {
        let Some(total) = self.total else {
            return "not a sum: a pass blends its shadow over the lit picture".to_owned();
        };
        let channels = ["red", "green", "blue"].iter().zip(total).filter(|(_, value)| *value > 1.0);
        let over: Vec<&str> = channels.map(|(name, _)| *name).collect();
        match over[..] {
            [] => format!("({})", three(total)),
            [_] => format!("({}): {} saturates, as a picture has no more than 1", three(total), over[0]),
            _ => format!("({}): {} saturate, as a picture has no more than 1", three(total), over.join(" and ")),
        }
    }
}

impl LightTerms {
    /// Returns whether the technique says that something lies between the surface and the light, so that what it would add
    /// is kept away.
    pub fn is_in_shadow(&self) -> bool {
        self.label == Some(PixelLabel::Shadow)
    }

    /// Describes what this light adds to the surface `of`: N·L, the shading sum with its numbers, and whether the light
    /// arrives. Where the light is black, or adds nothing as the surface faces away, says so in place of the sum.
    fn text(&self, of: &SurfaceShading) -> String {
        let cosines = self.corner_cosines.map_or_else(String::new, |cosines| {
            format!(" (at the corners, where light is computed and then mixed: {})", three(cosines))
        });
        let cosine = format!("cosine N·L {}{cosines}", digits(self.cosine));
        if self.label == Some(PixelLabel::FacesAway) && self.adds == [0.0; 3] {
            return format!("{cosine}: it adds nothing, as the surface faces away or is out of its range");
        }
        let sum = format!(
            "({}) × fading {} × (({}) × diffuse {} + highlight {}) = ({})",
            three(self.color),
            digits(self.fading),
            three(of.color),
            digits(self.diffuse),
            digits(self.highlight),
            three(self.adds)
        );
        if self.color == [0.0; 3] {
            return format!("{cosine}; it sends out nothing: it is off, or black");
        }
        let arrives = match self.label {
            Some(PixelLabel::Lit) => "it arrives",
            Some(PixelLabel::Shadow) if of.ambient_diffuse > 0.0 => {
                return format!(
                    "{cosine}; {sum}; this is in shadow, and {} of the diffuse light is added all the same",
                    digits(of.ambient_diffuse)
                );
            }
            Some(PixelLabel::Shadow) => "it would be added, but this is in shadow",
            Some(PixelLabel::FacesAway) => "the surface faces away from it",
            _ => "nobody says whether it arrives",
        };
        format!("{cosine}; {sum}; {arrives}")
    }
}

/// Returns the view position that highlights use (homogeneous, relative to the eye), the draw, and the triangle that a
/// pixel shows: the last one that passed its tests in the ambient pass, where all surfaces
/// are drawn first. `None` where none did.
pub(super) fn seen<'a>(plan: &'a FramePlan, history: &'a PixelHistory) -> Option<(DVec4, &'a Draw, &'a TriangleEvent)> {
    history.events.iter().rev().find_map(|event| {
        let one = event.triangle().filter(|one| one.outcome.passed())?;
        let pass = plan.passes.get(event.pass)?;
        let draw = pass.draws.get(one.draw)?;
        let eye = plan.views.get(pass.view.0)?.eye.as_dvec4();
        matches!(draw.program, Program::Ambient { .. }).then_some((eye, draw, one))
    })
}

/// Returns the normals of a triangle's corners towards the side that the eye sees, by the triangle's side flags.
fn normals_seen(normals: [[f32; 3]; 3], sides: u32) -> [DVec3; 3] {
    const SEES_BACK: u32 = 1 << 31;
    let sign = if sides & SEES_BACK == 0 { 1.0 } else { -1.0 };
    normals.map(|normal| DVec3::from_array(normal.map(f64::from)) * sign)
}

/// Returns the barycentric weights of a triangle's corners a, b, c at a point of its plane; not finite for a triangle
/// without area.
fn weights([a, b, c]: [DVec3; 3], point: DVec3) -> [f64; 3] {
    let across = (b - a).cross(c - a);
    let area = across.length_squared();
    [(b, c), (c, a), (a, b)].map(|(from, to)| across.dot((to - from).cross(point - from)) / area)
}

fn terms(at: ShadingPoint, eye: DVec4, light: &PlanLight, draw: &Draw, wraps: bool) -> ShadingTerms {
    let position = wide(light.relative_position);
    let to_light = position.truncate() - at.relative * position.w;
    let direction = to_light.normalize_or_zero();
    let cosine = at.normal.dot(direction);
    let to_eye = (eye.truncate() - at.relative * eye.w).normalize_or_zero();
    let halfway = (direction + to_eye).normalize_or_zero();
    let material = &draw.constants.material;
    let gloss = f64::from(material.specular) * at.normal.dot(halfway).max(0.0).powf(material.shininess.into());
    let fading = match light.range.filter(|_| position.w != 0.0) {
        None => 1.0,
        Some(range) => (1.0 - to_light.length_squared() / f64::from(range).powi(2)).max(0.0).powi(2),
    };
    ShadingTerms {
        cosine,
        diffuse: if wraps { 0.5 * cosine + 0.5 } else { cosine.max(0.0) },
        highlight: if cosine > 0.0 { gloss } else { 0.0 },
        fading,
    }
}

/// Interpolates the light of the corners (Gouraud shading): falloff, and diffuse light and highlight weighted by it;
/// both are 0 where the falloff is. `cosine` is returned as it is.
fn mix(corners: [ShadingTerms; 3], weights: [f64; 3], cosine: f64) -> ShadingTerms {
    let sum = |of: fn(&ShadingTerms) -> f64| {
        corners.iter().zip(weights).map(|(corner, weight)| weight * of(corner)).sum::<f64>()
    };
    let fading = sum(|corner| corner.fading);
    let part = |sum: f64| if fading == 0.0 { 0.0 } else { sum / fading };
    let diffuse = part(sum(|corner| corner.fading * corner.diffuse));
    let highlight = part(sum(|corner| corner.fading * corner.highlight));
    ShadingTerms { cosine, diffuse, highlight, fading }
}

/// A triangle, relative to the eye, with the pixel that shows it.
struct SeenTriangle<'a> {
    capture: &'a Capture,
    pixel: [u32; 2],
    corners: [DVec3; 3],
    /// Normal of its plane, of any length.
    normal: DVec3,
}

impl SeenTriangle<'_> {
    /// Returns where the view ray through a pixel's centre hits the triangle's plane, relative to the eye.
    fn point(&self, [x, y]: [u32; 2]) -> DVec3 {
        let ray = ray_at(self.capture, [f64::from(x) + 0.5, f64::from(y) + 0.5]);
        ray.at(self.normal.dot(self.corners[0] - ray.from) / self.normal.dot(ray.along))
    }
}

/// Samples the draw's texture where the pixel's ray meets the triangle, as `texture.wgsl` does: UV, nearest texel, mip
/// level and linear RGB. `first` is the index of the triangle's first corner (3 × its number) in the surface's
/// per-corner UVs. Returns `None` where the draw has no texture, or the UVs are missing or not finite.
fn texture(
    plan: &FramePlan,
    draw: &Draw,
    surface: &SurfaceData,
    first: usize,
    seen: &SeenTriangle,
) -> Option<TextureTerm> {
    let shown = plan.textures.get(draw.constants.texture?.0)?;
    let of_corners: [[f32; 2]; 3] = surface.uvs.as_ref()?.data().get(first..first + 3)?.try_into().ok()?;
    let place = |pixel: [u32; 2]| {
        let weights = weights(seen.corners, seen.point(pixel));
        (0..3).map(|corner| DVec2::from_array(of_corners[corner].map(f64::from)) * weights[corner]).sum::<DVec2>()
    };
    let uv = place(seen.pixel);
    let [x, y] = seen.pixel;
    // The GPU takes derivatives in blocks of two by two pixels.
    let size = DVec2::from_array(shown.picture.size().map(f64::from));
    let across = (place([x | 1, y]) - place([x & !1, y])) * size;
    let down = (place([x, y | 1]) - place([x, y & !1])) * size;
    let longest = across.length().max(down.length());
    let last = f64::from(shown.picture.level_count() - 1);
    let level = if longest.is_finite() { longest.max(1.0).log2().min(last) } else { last };
    let uv = uv.is_finite().then(|| uv.to_array())?;
    Some(TextureTerm {
        name: shown.picture.name().to_owned(),
        uv,
        texel: shown.picture.texel_at(uv, shown.clamps),
        level,
        color: shown.picture.linear_at(uv, level, shown.clamps),
    })
}

/// Returns the factor of a surface's colour at a point relative to the eye: [`DARK_CHECK`] on the dark squares of a
/// checkered surface, along world X and Z, otherwise 1.
fn checks(draw: &Draw, relative: DVec3) -> f64 {
    let side = f64::from(draw.constants.material.checks);
    if side == 0.0 {
        return 1.0;
    }
    let [x, z] = draw.constants.checks_from.map(f64::from);
    let place = ((relative.x + x) / side).floor() + ((relative.z + z) / side).floor();
    if place.rem_euclid(2.0) == 0.0 { 1.0 } else { DARK_CHECK }
}

fn wide(value: [f32; 4]) -> DVec4 {
    DVec4::from_array(value.map(f64::from))
}
