//! Materials and their textures.
//!
//! Metal and roughness become the strength and the exponent of a highlight: the exponent whose lobe is as wide as that
//! of the microfacets (2/α² − 2 with α = roughness², Walter et al. 2007), the strength the share of light that is
//! reflected straight on (4 % for a dielectric, the metal's colour for a metal).

use super::document::{GltfDocument, GltfResult};
use super::named;
use crate::scene::files::read_text::quoted;
use crate::scene::not_taken::UnsupportedList;
use crate::scene::picture::{ImageLoader, MOST_FILE};
use crate::scene::{Material, MaterialTexture};
use glam::{Vec2, Vec3};
use gltf::json::material::AlphaMode;
use gltf::json::texture::{Info, WrappingMode};
use gltf::json::validation::Checked;
use gltf::json::{Index, material};

/// Share of light that a dielectric surface reflects straight on.
const PLAIN_REFLECTANCE: f32 = 0.04;

/// The material of a glTF primitive, with its name and texture.
#[derive(Debug, Clone, Default)]
pub struct PrimitiveMaterial {
    /// The material's name, or one that stands for it.
    pub name: String,
    /// The material without its shading; `None` where the file names none.
    pub material: Option<Material>,
    /// The texture that its colour is multiplied with.
    pub map: Option<GltfTexture>,
}

/// A texture, and which texture coordinates are used for it and how they are transformed.
#[derive(Debug, Clone)]
pub struct GltfTexture {
    /// The texture.
    pub texture: MaterialTexture,
    /// Which set of the vertices' texture coordinates is used.
    pub set: u32,
    scale: Vec2,
    turn: f32,
    offset: Vec2,
}

impl GltfTexture {
    /// Converts a vertex's texture coordinates, from the picture's upper left corner, to ones from its lower left
    /// corner.
    pub fn place(&self, uv: Vec2) -> Vec2 {
        let scaled = uv * self.scale;
        let (sin, cos) = libm::sincosf(self.turn);
        let rotated = Vec2::new(cos * scaled.x + sin * scaled.y, cos * scaled.y - sin * scaled.x);
        let Vec2 { x, y } = rotated + self.offset;
        Vec2::new(x, 1.0 - y)
    }
}

/// A glTF file's materials, each read on first use.
#[derive(Debug)]
pub struct GltfMaterials<'a> {
    document: &'a GltfDocument,
    pictures: &'a mut ImageLoader,
    known: Vec<Option<(PrimitiveMaterial, UnsupportedList)>>,
}

impl<'a> GltfMaterials<'a> {
    /// Returns the materials of a file, none of them read yet.
    pub fn new(document: &'a GltfDocument, pictures: &'a mut ImageLoader) -> GltfMaterials<'a> {
        GltfMaterials { document, pictures, known: vec![None; document.root.materials.len()] }
    }

    /// Returns a material, with defaults where `index` is `None` or names none, and records in `refusals` what of it is
    /// not shown, also when it was read before.
    pub fn look(
        &mut self,
        index: Option<Index<material::Material>>,
        refusals: &mut UnsupportedList,
    ) -> PrimitiveMaterial {
        let Some((index, given)) = index.and_then(|index| Some((index.value(), self.document.root.get(index)?))) else {
            return PrimitiveMaterial::default();
        };
        if self.known[index].is_none() {
            let mut own = UnsupportedList::default();
            let look = self.read(index, given, &mut own);
            self.known[index] = Some((look, own));
        }
        let Some((look, own)) = &self.known[index] else { return PrimitiveMaterial::default() };
        refusals.add(own);
        look.clone()
    }

    fn read(&mut self, index: usize, given: &material::Material, refusals: &mut UnsupportedList) -> PrimitiveMaterial {
        let name = named(given.name.as_deref(), || format!("material {}", index + 1));
        let of = |what: &str| format!("{what} of {}", quoted(&name));
        let base = &given.pbr_metallic_roughness;
        let mut map = None;
        if let Some(info) = &base.base_color_texture {
            match self.map(info, refusals) {
                Ok(found) => map = Some(found),
                Err(because) => refusals.refuse(of("baseColorTexture"), because),
            }
        }
        let others = [
            ("metallicRoughnessTexture", base.metallic_roughness_texture.is_some()),
            ("normalTexture", given.normal_texture.is_some()),
            ("occlusionTexture", given.occlusion_texture.is_some()),
            ("emissiveTexture", given.emissive_texture.is_some()),
        ];
        for (what, _) in others.into_iter().filter(|(_, is_there)| *is_there) {
            refusals.refuse(of(what), "of pictures, only that of the base colour is shown");
        }
        let extensions = given.extensions.as_ref();
        if extensions.is_some_and(|known| known.unlit.is_some()) {
            refusals.refuse(of("KHR_materials_unlit"), "everything is lit here");
        }
        if given.alpha_mode == Checked::Valid(AlphaMode::Mask) {
            refusals.refuse(of("the alpha mask"), "holes are no geometry: it is shown, and casts, whole");
        }
        let strength = extensions.and_then(|known| known.emissive_strength.as_ref());
        let strength = strength.map_or(1.0, |strength| strength.emissive_strength.0);
        let within = |low: f32, value: f32, high: f32| if value.is_finite() { value.clamp(low, high) } else { low };
        let [red, green, blue, alpha] = base.base_color_factor.0;
        let color = [red, green, blue].map(|channel| within(0.0, channel, 1.0));
        let [metal, roughness] = [base.metallic_factor.0, base.roughness_factor.0].map(|of| within(0.0, of, 1.0));
        let reflected = PLAIN_REFLECTANCE + (Vec3::from_array(color).max_element() - PLAIN_REFLECTANCE) * metal;
        let width = (roughness * roughness).max(1e-3);
        let material = Material {
            color,
            specular: within(0.0, reflected, 1.0),
            shininess: within(1.0, 2.0 / (width * width) - 2.0, 1000.0),
            opacity: if given.alpha_mode == Checked::Valid(AlphaMode::Blend) { within(0.0, alpha, 1.0) } else { 1.0 },
            emission: given.emissive_factor.0.map(|channel| within(0.0, channel * strength, 1000.0)),
            ..Material::default()
        };
        PrimitiveMaterial { name, material: Some(material), map }
    }

    fn map(&mut self, info: &Info, refusals: &mut UnsupportedList) -> GltfResult<GltfTexture> {
        let root = &self.document.root;
        let texture = root.get(info.index).ok_or("the texture is missing")?;
        let image = texture.source;
        let given = root.get(image).ok_or("its picture is neither PNG nor JPEG: convert it")?;
        let of_file = given.uri.as_deref().filter(|uri| !uri.starts_with("data:"));
        let name = named(given.name.as_deref().or(of_file), || format!("image-{}", image.value() + 1));
        // Data within the file is identified by a path that no other has.
        let key = of_file.and_then(|uri| self.document.beside(uri));
        let key = key.unwrap_or_else(|| self.document.file.join(format!("\0{}", image.value())));
        let document = self.document;
        let bytes = || match (&given.uri, given.buffer_view) {
            (Some(uri), _) => document.resource(uri, MOST_FILE),
            (None, Some(view)) => document.view(view).map(<[u8]>::to_vec),
            (None, None) => Err("it names no picture".to_owned()),
        };
        let picture = self.pictures.load_bytes(&key, &name, &quoted(&name), bytes)?;
        if picture.has_alpha() {
            refusals.refuse(format!("the alpha of {}", quoted(&name)), "opacity is the material's (baseColorFactor)");
        }
        let sampler = texture.sampler.and_then(|sampler| root.get(sampler));
        let wraps = sampler.map(|sampler| [sampler.wrap_s, sampler.wrap_t]).unwrap_or_default();
        let is = |mode: WrappingMode| wraps.contains(&Checked::Valid(mode));
        if is(WrappingMode::MirroredRepeat) {
            refusals.refuse(
                format!("mirrors of {}", quoted(&name)),
                "beyond its edges a picture repeats or its last texels go on",
            );
        }
        let clamps = is(WrappingMode::ClampToEdge);
        if clamps && wraps[0] != wraps[1] {
            refusals.refuse(
                format!("the two edges of {}", quoted(&name)),
                "a picture is clamped along both sides or along none",
            );
        }
        let transform = info.extensions.as_ref().and_then(|known| known.texture_transform.as_ref());
        let texture = MaterialTexture { picture, side: None, clamps };
        Ok(match transform {
            Some(given) => GltfTexture {
                texture,
                set: given.tex_coord.unwrap_or(info.tex_coord),
                scale: Vec2::from_array(given.scale.0),
                turn: given.rotation.0,
                offset: Vec2::from_array(given.offset.0),
            },
            None => GltfTexture { texture, set: info.tex_coord, scale: Vec2::ONE, turn: 0.0, offset: Vec2::ZERO },
        })
    }
}
