//! The record of something that this scene does not need.

use super::{Decision, LightId, Pass};
use crate::numbers;
use serde::{Deserialize, Deserializer, Serialize};

/// Something that the plan leaves out, with the decision and the reason, to be shown to the user.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct LeftOut {
    /// The decision; `None` in a folder that does not state it, or states one that this version does not know.
    #[serde(default, deserialize_with = "known", skip_serializing_if = "Option::is_none")]
    pub decision: Option<Decision>,
    /// Which of several things it is: the name of a face, a receiver, a caster or a draw.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// What is left out, in words, for example `dark cap`, `stencil buffer`, `map +x`.
    pub what: String,
    /// The object, light or pass it would have belonged to.
    pub of: String,
    /// How many triangles or things are left out, where that is counted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub count: Option<u64>,
    /// Why nothing changes without it.
    pub because: String,
}

impl LeftOut {
    /// Records that `decision` leaves something of `of` (an object, light or pass) out, for the reason `because`.
    pub fn new(decision: Decision, of: impl Into<String>, because: impl Into<String>) -> LeftOut {
        LeftOut::made(decision, None, None, of.into(), because.into())
    }

    /// Records that `count` triangles or things of `of` are left out.
    pub fn counted(decision: Decision, count: u64, of: impl Into<String>, because: impl Into<String>) -> LeftOut {
        LeftOut::made(decision, None, Some(count), of.into(), because.into())
    }

    /// Records that one thing of several in `of`, called `name`, is left out.
    pub fn named(decision: Decision, name: &str, of: impl Into<String>, because: impl Into<String>) -> LeftOut {
        LeftOut::made(decision, Some(name), None, of.into(), because.into())
    }

    /// Records that `count` flat pieces of the object `name` get no shadow of `of`.
    pub fn pieces(count: u64, name: &str, of: &str, because: &str) -> LeftOut {
        LeftOut::made(Decision::SmallReceivers, Some(name), Some(count), of.to_owned(), because.to_owned())
    }

    /// Returns an entry that says that a pass did not run, since its result is cached from the frame before.
    pub fn cached(pass: &Pass) -> LeftOut {
        let of = pass.light.map_or_else(|| "the frame".to_owned(), LightId::name);
        LeftOut::named(Decision::Cached, &pass.name, of, "nothing that makes it has changed since")
    }

    /// Returns an entry that says that `count` triangles are left out of a light's pass, as they face away from the
    /// light or, if it has a range, lie beyond that.
    pub fn unlit(count: u64, light: LightId, has_range: bool) -> LeftOut {
        let of = format!("the pass of {}", light.name());
        let mut left_out = LeftOut::counted(Decision::UnlitTriangles, count, of, "it adds nothing to them");
        left_out.what += if has_range { " or are out of range" } else { "" };
        left_out
    }

    /// Records that `count` triangles of a caster with holes need not cast, as they face away from the light, and the caster
    /// itself lies before them.
    pub fn behind_no_hole(count: u64, of: &str, because: String) -> LeftOut {
        let mut left_out = LeftOut::counted(Decision::AwayTriangles, count, of, because);
        left_out.what = format!("{} {} behind no hole", numbers::count(count), left_out.what);
        left_out
    }

    /// Returns whether this is the record of `decision` about that object, light or pass.
    pub fn is(&self, decision: Decision, of: &str) -> bool {
        self.decision == Some(decision) && self.of == of
    }

    /// Returns whether this is the record of `decision` about the thing called `name`.
    pub fn names(&self, decision: Decision, name: &str) -> bool {
        self.decision == Some(decision) && self.name.as_deref() == Some(name)
    }

    fn made(decision: Decision, name: Option<&str>, count: Option<u64>, of: String, because: String) -> LeftOut {
        let (what, name) = (decision.what(name, count), name.map(str::to_owned));
        LeftOut { decision: Some(decision), name, what, of, count, because }
    }
}

impl std::fmt::Display for LeftOut {
    /// Written as `dark cap of box`; of triangles that face away, whose they are comes before what they do: `triangles of
    /// box that face away`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let LeftOut { decision, what, of, .. } = self;
        let what = match self.count {
            Some(1) => &what.replacen("1 triangles that face", "1 triangle that faces", 1),
            _ => what,
        };
        match decision {
            Some(Decision::AwayTriangles | Decision::HiddenTriangles) => {
                let noun = if what.starts_with("1 triangle ") { "triangle" } else { "triangles" };
                f.write_str(&what.replacen(noun, &format!("{noun} of {of}"), 1))
            }
            Some(Decision::UnlitTriangles) => write!(f, "{what}, in {of}"),
            Some(Decision::Cached) => write!(f, "{what}, for {of}"),
            _ => write!(f, "{what} of {of}"),
        }
    }
}

fn known<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Decision>, D::Error> {
    Ok(Decision::from_name(&String::deserialize(deserializer)?))
}
