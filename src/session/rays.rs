//! The rays from the lights of a frame to a pixel's surface, followed in the scene that the frame shows.

use super::{AsyncSession, FrameSource, RunFrame, SessionError};
use crate::reading::light_rays::{LightRay, RayFollower};
use std::sync::Arc;

/// A frame's scene prepared for rays: from one pixel of it to the next nothing is prepared again.
#[derive(Debug)]
pub(super) struct FollowedScene {
    source: Arc<FrameSource>,
    size: [u32; 2],
    follower: RayFollower,
}

impl AsyncSession {
    /// As [`Session::light_rays`](super::Session::light_rays). Fails where another program drew the frame: rays in what it
    /// reveals of its scene prove nothing.
    pub fn light_rays(&mut self, frame: &RunFrame, pixel: [u32; 2]) -> Result<Vec<LightRay>, SessionError> {
        let size = frame.capture.size;
        if pixel[0] >= size[0] || pixel[1] >= size[1] {
            return Err(SessionError::NoSuchPixel { pixel, size });
        }
        let source = frame.source.as_ref().filter(|source| source.request.is_some()).ok_or(SessionError::NoScene)?;
        let is_same = |of: &FollowedScene| Arc::ptr_eq(&of.source, source) && of.size == size;
        let followed = match self.followed.take().filter(is_same) {
            Some(followed) => followed,
            None => {
                let follower = RayFollower::new(&source.scene, size)?;
                FollowedScene { source: Arc::clone(source), size, follower }
            }
        };
        Ok(self.followed.insert(followed).follower.at(pixel))
    }
}
