//! Places a frame's contents: objects in world space, lights, the camera, and the pictures that passes draw into.

use super::{FrameBuilder, FrameObject, SurfacePiece};
use crate::geometry::{ViewVolume, relative};
use crate::math::depth::DepthCurve;
use crate::plan::{Attachment, AttachmentRole, DecidedBy, Decision, LeftOut, MeshId, PlanLight, PlanView};
use crate::scene::{Material, MeshGroup, Object, Scene, Unsupported};
use crate::technique::{PlanError, outside, surfaces};
use glam::{DMat4, DVec2, DVec3, DVec4};
use wgpu_types::TextureFormat;

/// The largest coordinate relative to the eye, metres: beyond it, products of single-precision coordinates overflow.
const MOST_DISTANCE: f64 = 1e18;
/// Where the scene gives no far plane, it is placed at the farthest surface's distance times this.
const FAR_MARGIN: f64 = 1.01;

impl FrameBuilder<'_> {
    pub(super) fn add_attachments(&mut self) {
        let size = self.job.size;
        self.color = self.add_attachment(Attachment {
            name: "color".to_owned(),
            role: AttachmentRole::Color,
            format: TextureFormat::Rgba8UnormSrgb,
            size,
            layers: 1,
            depth_bits: None,
        });
        let (name, format) = match self.has_stencil {
            true => ("depth and stencil", TextureFormat::Depth32FloatStencil8),
            false => ("depth", TextureFormat::Depth32Float),
        };
        if !self.has_stencil {
            let because = "this technique counts and marks nothing, and no two triangles have the same corners";
            self.leave_out(Decision::Stencil, "the frame", because);
        }
        let role = AttachmentRole::DepthStencil;
        self.depth_stencil =
            self.add_attachment(Attachment { name: name.to_owned(), role, format, size, layers: 1, depth_bits: None });
    }

    pub(super) fn add_lights(&mut self) -> Result<(), PlanError> {
        for (light, id) in self.job.scene.lights.iter().zip(self.light_ids()) {
            light.check().map_err(|problem| PlanError::Unusable { problem: problem.to_owned() })?;
            let labels = self.add_attachment(Attachment {
                name: format!("{} labels", id.name()),
                role: AttachmentRole::Labels(id),
                format: TextureFormat::R8Uint,
                size: self.job.size,
                layers: 1,
                depth_bits: None,
            });
            let relative_position = relative::homogeneous(light.homogeneous(), self.eye());
            if !relative_position.iter().all(|component| component.is_finite()) {
                let problem = format!("{} is too far from the eye for single precision", id.name());
                return Err(PlanError::Unusable { problem });
            }
            let color = light.emitted();
            let range = light.range.map(|range| range as f32);
            self.plan.lights.push(PlanLight {
                relative_position,
                color,
                range,
                decided_by: DecidedBy::Nothing,
                count_of: None,
                map: None,
                count: None,
                labels,
                visibility: None,
            });
        }
        Ok(())
    }

    pub(super) fn place_objects(&mut self) -> Result<(), PlanError> {
        let scene = self.job.scene;
        self.name_not_taken(Decision::SceneFile, &scene.name, &scene.not_taken);
        for object in &self.job.scene.objects {
            let mut world = object.world_positions();
            if self.common.rounds_world {
                world.iter_mut().for_each(|position| *position = relative::rounded(*position));
            }
            let is_usable = |position: &DVec3| (*position - self.eye()).abs().max_element() <= MOST_DISTANCE;
            if !world.iter().all(is_usable) {
                let problem = format!("{} is too large or too far from the eye for single precision", object.name);
                return Err(PlanError::Unusable { problem });
            }
            let drawn = object.visible && !object.mesh.triangles().is_empty();
            let (scene, shading) = (self.job.scene, self.common.shading);
            let mesh = drawn.then(|| surfaces::draw_mesh(object, &world, scene, shading, self.job.cache));
            let surface = mesh.map(|mesh| self.add_mesh(mesh));
            self.name_not_taken(Decision::Material, &object.name, object.mesh.not_taken());
            if let Some(mesh) = surface {
                let pieces = self.pieces_of(object, mesh);
                self.pieces.extend(pieces);
            }
            self.placed.push(FrameObject { object, world, surface });
        }
        Ok(())
    }

    /// Adds to the plan's left-out list, under the name `name`, what a file contains and this program does not support.
    fn name_not_taken(&mut self, decision: Decision, name: &str, list: &[Unsupported]) {
        let named = |one: &Unsupported| LeftOut::named(decision, &one.what, name, one.because.as_str());
        self.plan.left_out.extend(list.iter().map(named));
    }

    /// Returns a piece for each group of the object that is placed next, in the groups' order, with its material (the
    /// object's where the group has none) and texture; textures that are new are added to the plan. The common setting
    /// `shading` replaces only the materials' shading model.
    fn pieces_of(&mut self, object: &Object, mesh: MeshId) -> Vec<SurfacePiece> {
        let (shading, index) = (self.common.shading, self.placed.len());
        let piece = |group: &MeshGroup| SurfacePiece {
            name: match group.name.as_str() {
                "" => object.name.clone(),
                group => format!("{} · {group}", object.name),
            },
            object: index,
            material: {
                let material = group.material.unwrap_or(object.material);
                Material { shading: shading.unwrap_or(material.shading), ..material }
            },
            mesh,
            triangles: group.triangles.start as u32..group.triangles.end as u32,
            layer: None,
            texture: object.texture_of(group).map(|texture| self.add_texture(texture)),
        };
        object.mesh.groups().iter().map(piece).collect()
    }

    /// Returns the mapping from distance to depth that the settings ask for. Where the camera has no far plane, one is
    /// placed behind the farthest surface; a parallel camera's depth ends behind all that is drawn or casts within the
    /// view's sides.
    pub(super) fn depth_curve(&self) -> DepthCurve {
        let camera = &self.job.scene.camera;
        let ahead = (camera.target - camera.eye).normalize_or_zero();
        let drawn = self.placed.iter().filter(|placed| placed.surface.is_some()).flat_map(|placed| &placed.world);
        let distance = |position: &DVec3| (*position - camera.eye).dot(ahead);
        let farthest = drawn.map(distance).fold(camera.near * 2.0, f64::max);
        let far = camera.far.unwrap_or(farthest * FAR_MARGIN);
        match (camera.is_parallel(), self.common.depth.is_finite()) {
            (false, _) => self.common.depth.curve(camera.near, far, self.common.epsilon),
            (true, true) => self.common.depth.linear_curve(camera.near, far),
            (true, false) => {
                let end =
                    self.in_view().flat_map(|placed| &placed.world).map(distance).fold(camera.near * 2.0, f64::max);
                self.common.depth.linear_curve(camera.near, camera.near + (end - camera.near) * FAR_MARGIN)
            }
        }
    }

    /// Returns the volume that the camera sees, relative to the eye.
    pub fn view_volume(&self) -> ViewVolume {
        let camera = &self.job.scene.camera;
        ViewVolume::new(camera, camera.aspect_in(self.job.size))
    }

    /// Returns the corners of what the camera sees that maps are fitted to, world space: those of the near rectangle, then those of a rectangle
    /// as far away as the farthest corner that is drawn, whichever way it lies, or at the camera's far plane where it has one.
    pub fn view_corners(&self) -> [DVec3; 8] {
        let camera = self.job.map_camera.unwrap_or(&self.job.scene.camera);
        let rays = camera.rays(camera.aspect_in(self.job.size));
        let drawn = self.placed.iter().filter(|placed| placed.surface.is_some()).flat_map(|placed| &placed.world);
        let farthest = drawn.map(|position| position.distance(camera.eye)).fold(camera.near * 2.0, f64::max);
        let distances = [camera.near, camera.far.unwrap_or(farthest)];
        let corner = |index: usize| {
            let at = DVec2::new(if index & 1 == 0 { -1.0 } else { 1.0 }, if index & 2 == 0 { -1.0 } else { 1.0 });
            camera.eye + rays.through(at).at(distances[index / 4])
        };
        std::array::from_fn(corner)
    }

    /// Returns the placed objects that are drawn or cast, without those that lie wholly outside one plane of the view.
    fn in_view(&self) -> impl Iterator<Item = &FrameObject<'_>> {
        let view = self.view_volume();
        self.placed.iter().filter(move |placed| {
            let relative: Vec<DVec4> =
                outside::outline(&placed.world).iter().map(|point| (point - self.eye()).extend(1.0)).collect();
            let takes_part = placed.surface.is_some() || placed.object.casts;
            takes_part && view.outside(&relative).is_none()
        })
    }
}

pub(super) fn camera_view(scene: &Scene, size: [u32; 2], depth: &DepthCurve) -> PlanView {
    let camera = &scene.camera;
    let view_from_relative = DMat4::from_mat3(camera.world_from_view().transpose());
    let clip_from_relative = (camera.clip_from_view(camera.aspect_in(size), depth) * view_from_relative).as_mat4();
    let eye = camera.relative_eye().as_vec4();
    PlanView { name: "camera".to_owned(), origin: camera.eye, eye, clip_from_relative }
}
