//! A record of something that this scene does not need.

/// Something the plan leaves out, with the reason: absence is a lesson too.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct LeftOut {
    /// For example `dark cap`, `stencil`, `map face +x`.
    pub what: String,
    /// The object, light or pass it would have belonged to.
    pub of: String,
    /// Why nothing changes without it.
    pub because: String,
}

impl LeftOut {
    /// `what` of `of` is not needed because of `because`.
    pub fn new(what: impl Into<String>, of: impl Into<String>, because: impl Into<String>) -> LeftOut {
        LeftOut { what: what.into(), of: of.into(), because: because.into() }
    }
}
