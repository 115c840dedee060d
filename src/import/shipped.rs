//! Frames of other programs that are built into this one: they can be examined without RenderDoc.

use super::read::read_from;
use super::{ConvertedFrame, ImportError, convert};
use crate::capture::disk::WholeFrame;
use std::io::Cursor;

/// A frame that another program drew, built in.
#[derive(Debug, Clone, Copy)]
pub struct ShippedFrame {
    /// The name that opens it.
    pub name: &'static str,
    /// What it shows, in a sentence.
    pub lesson: &'static str,
    document: &'static [u8],
    data: &'static [u8],
}

macro_rules! shipped {
    ($name:literal, $lesson:literal) => {
        ShippedFrame {
            name: $name,
            lesson: $lesson,
            document: include_bytes!(concat!("../../assets/recordings/", $name, "/frame.json")),
            data: include_bytes!(concat!("../../assets/recordings/", $name, "/data.bin")),
        }
    };
}

/// The recorded frames that are built into the program.
pub const SHIPPED: &[ShippedFrame] = &[
    shipped!("ogre", "OGRE's stencil shadows as they should be: three volumes, counted in front of surfaces"),
    shipped!("ogre-inside", "the eye in a shadow: OGRE counts that volume behind surfaces"),
    shipped!("ogre-short", "volumes that end at the light's reach: beyond it, shadow is not counted"),
    shipped!(
        "irrlicht-inside",
        "the eye in a shadow: Irrlicht counts in front of surfaces, and darkens what should be lit"
    ),
    shipped!(
        "blender",
        "Blender's viewport: surfaces first, then light by draws of the whole screen that the stencil lets through"
    ),
    shipped!("pygfx", "pygfx's shadow map as it should be: back faces alone are in it, which needs no bias"),
    shipped!("pygfx-acne", "the same map with front faces and no bias: surfaces shadow themselves in stripes"),
];

impl ShippedFrame {
    /// Returns the built-in recorded frame of exactly this name; `None` where there is none.
    pub fn named(name: &str) -> Option<&'static ShippedFrame> {
        SHIPPED.iter().find(|shipped| shipped.name == name)
    }

    /// Reads the built-in recording and converts it to a frame with this name; nothing is cached.
    pub fn open(&self) -> Result<WholeFrame, ImportError> {
        let frame = read_from(self.document, Cursor::new(self.data))?;
        let ConvertedFrame { plan, capture, scene, .. } = convert(&frame, self.name)?;
        Ok(WholeFrame { capture, plan: Some(plan), scene })
    }
}
