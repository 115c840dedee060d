//! What a pass that counts shadow volumes is for, in sentences.

use super::counting::{CountingMode, FaceSelection};
use crate::plan::{CountBits, LightId};
use crate::technique::settings::{CountOperations, VolumeSettings};

/// The number that a count begins at, by its reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CountStart {
    /// The number of volumes around the eye.
    Eye(u32),
    /// The number of volumes in which parallel view rays end.
    FarEnd(u32),
}

/// The facts from which the sentences about a counting pass are written.
pub struct CountingPurpose<'a> {
    /// How all volumes are counted; `None` where they are counted in different ways.
    pub by: Option<CountingMode>,
    pub light: LightId,
    pub options: &'a VolumeSettings,
    /// What the count begins at, and why; `None` for 0.
    pub start: Option<CountStart>,
    /// Whether each volume's side is chosen (`auto`): in front only where neither the eye nor the near plane is in it.
    pub chooses_side: bool,
    /// The name of the place that [`CountStart::Eye`] is counted around.
    pub place: &'static str,
    /// Whether view rays are parallel, and so begin at the near plane and not at an eye.
    pub is_parallel: bool,
    /// Whether light caps and dark caps are left out though they would count, in this order.
    pub lacks: [bool; 2],
}

impl CountingPurpose<'_> {
    /// Returns sentences that say what a counting pass does and what is left in the count.
    pub fn purpose(&self, step: FaceSelection) -> String {
        let what = self.what();
        let is_inverting = self.options.operations == CountOperations::Inverting && !self.options.counts_in_float;
        if is_inverting {
            let counts = if self.by == Some(CountingMode::Behind) { "hidden by the surface" } else { "nearer than it" };
            let own = if step == FaceSelection::BothFaces { "" } else { ", those of one side in this pass" };
            return format!(
                "Counts {what}, odd or even: every face {counts} turns one bit over{own}. {}1 is left where an odd \
                 number of volumes contains the surface, and an even one reads as none{}.",
                self.begins(),
                self.condition()
            );
        }
        let [adds, takes] = match self.by {
            Some(CountingMode::InFront | CountingMode::InFrontPlus) => {
                ["a front face nearer than the surface adds 1", "a back face nearer than it takes 1 away"]
            }
            Some(CountingMode::Behind) => {
                ["a back face hidden by the surface adds 1", "a hidden front face takes 1 away"]
            }
            None => ["in front, a front face adds 1 and a back face takes 1 away", "behind, it is the other way round"],
        };
        let is_last = match step {
            FaceSelection::BothFaces => return format!("Counts {what}: {adds}, {takes}. {}", self.left()),
            FaceSelection::Adding => self.options.takes_away_first,
            FaceSelection::TakingAway => !self.options.takes_away_first,
        };
        let does = if step == FaceSelection::Adding { adds } else { takes };
        match is_last {
            false => format!("Counts {what}, first half: {does}. The other faces follow in a pass of their own."),
            true => format!("Counts {what}, second half: {does}. {}", self.left()),
        }
    }

    fn what(&self) -> String {
        let light = self.light.name();
        match self.by {
            Some(CountingMode::InFront | CountingMode::InFrontPlus) => {
                format!("the shadow volumes of {light} in front of each surface")
            }
            Some(CountingMode::Behind) => format!("the shadow volumes of {light} behind each surface"),
            None => format!(
                "the shadow volumes of {light}, behind each surface where they may hold {}, else in front of it",
                if self.is_parallel { "the near plane" } else { "the eye" }
            ),
        }
    }

    /// Returns the sentences that say what the count begins at, if that is worth saying, and what it means when all
    /// faces are counted.
    fn left(&self) -> String {
        let begins = self.begins();
        let what = match self.by {
            Some(CountingMode::InFrontPlus) => {
                "With what the near plane began with, if anything, what is left is the number of volumes that contain"
            }
            None => "Either way, what is left is the number of volumes that contain",
            Some(_) => "What is left is the number of volumes that contain",
        };
        format!("{begins}{what} the surface{}.", self.condition())
    }

    /// Returns the bits that the count is stored in; eight, so not worth mentioning, for a float.
    fn bits(&self) -> CountBits {
        if self.options.counts_in_float { CountBits::EIGHT } else { CountBits::of_mask(self.options.mask().into()) }
    }

    fn begins(&self) -> String {
        match self.start {
            None => String::new(),
            Some(CountStart::Eye(start)) => format!("It begins at {start}, for the volumes around {}. ", self.place),
            Some(CountStart::FarEnd(start)) => format!(
                "It begins at {start}{}: parallel lines of sight all end at one point at infinity, in the volumes of \
                 so many casting triangles, those that a ray from {} along them meets. ",
                match self.bits() {
                    CountBits::EIGHT => String::new(),
                    bits => format!(" in {bits}"),
                },
                self.light.name()
            ),
        }
    }

    /// Returns the end of a sentence that says under which condition the count is right: where eye and near plane may
    /// be, and which caps are lacking.
    fn condition(&self) -> String {
        let eye = match (self.by, self.start) {
            (Some(CountingMode::InFront), _) if self.chooses_side && self.is_parallel => {
                ", as the near plane is in none"
            }
            (Some(CountingMode::InFront), _) if self.chooses_side => {
                ", as neither the eye nor the near plane is in any"
            }
            (Some(CountingMode::InFront), None | Some(CountStart::FarEnd(_))) if self.is_parallel => {
                ", if the near plane is in none"
            }
            (Some(CountingMode::InFront), None | Some(CountStart::FarEnd(_))) => ", if the eye itself is in none",
            (Some(CountingMode::InFront), Some(CountStart::Eye(_))) => ", if the near plane cuts none",
            _ => ", wherever the eye is",
        };
        let caps = match self.lacks {
            [false, false] => "",
            [true, false] => "; but no light cap is drawn, and where one lies on that side the count is wrong",
            [false, true] => "; but no dark cap is drawn, and where one lies on that side the count is wrong",
            [true, true] => "; but no cap is drawn, and where one lies on that side the count is wrong",
        };
        format!("{eye}{caps}")
    }
}
