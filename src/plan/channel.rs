//! A frame's light by what it is: ambient, emissive, diffuse, specular, each as a frame of its own.
//!
//! Light adds up. A plan in one channel is the whole plan in which all that makes the others is black: the pictures of all
//! four, added in linear light, are the whole picture, as far as that is not cut off at 1 and but for the rounding of eight
//! bits.

use super::{AttachmentRole, ColorTarget, FramePlan, Program};

named_enum! {
    /// A part of the light that a picture shows.
    pub enum LightChannel(
        /// What it is.
        meaning
    ) {
        /// What surfaces reflect of the ambient light.
        Ambient = "ambient" ("What surfaces reflect of the light that is everywhere"),
        /// What surfaces send out by themselves.
        Emissive = "emissive" ("What surfaces send out by themselves, and the background"),
        /// What surfaces scatter of the lights.
        Diffuse = "diffuse" ("What surfaces scatter of the lights: the same to every eye"),
        /// Highlights.
        Specular = "specular" ("Highlights of the lights: others from every eye"),
    }
}

impl FramePlan {
    /// Returns the plan that draws one channel of the light: the same draws, whose materials, lights and ambient light are
    /// black where they make another channel. What is in shadow stays so. The background counts as sent out.
    #[must_use]
    pub fn in_channel(&self, channel: LightChannel) -> FramePlan {
        let mut plan = self.clone();
        if channel != LightChannel::Ambient {
            plan.ambient = [0.0; 3];
        }
        if matches!(channel, LightChannel::Ambient | LightChannel::Emissive) {
            plan.lights.iter_mut().for_each(|light| light.color = [0.0; 3]);
        }
        if channel != LightChannel::Emissive {
            let is_picture = |target: &ColorTarget| self.attachment(target.attachment).role == AttachmentRole::Color;
            let pictures = plan.passes.iter_mut().filter_map(|pass| pass.color.as_mut()).filter(|to| is_picture(to));
            pictures.filter_map(|target| target.clear.as_mut()).for_each(|clear| *clear = [0.0, 0.0, 0.0, 1.0]);
        }
        for draw in plan.passes.iter_mut().flat_map(|pass| &mut pass.draws) {
            let material = &mut draw.constants.material;
            match (draw.program, channel) {
                (Program::Ambient { .. }, LightChannel::Emissive) => {}
                (Program::Ambient { .. }, _) => material.emission = [0.0; 3],
                (Program::Light(_) | Program::AmbientDiffuse, LightChannel::Diffuse) => material.specular = 0.0,
                (Program::Light(_) | Program::AmbientDiffuse, LightChannel::Specular) => material.color = [0.0; 3],
                _ => {}
            }
        }
        plan
    }
}
