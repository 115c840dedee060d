//! Single extremes: places where a rule of thumb, a tolerance or a sign goes wrong.

use crate::stress::Case;

/// All of them.
pub const ALL: &[Case] = &[];
