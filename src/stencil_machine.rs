//! The depth and stencil tests of one fragment as a pure function.
//!
//! The stencil test comes first; if it fails, the fail operation runs and the fragment is discarded. Then the depth
//! test; if it fails, the depth-fail operation runs. Else the pass operation runs and depth is stored where writing is
//! on. Comparisons see `(reference & read mask) ? (stored & read mask)`, operations change only the bits of the write
//! mask (WebGPU, section 23.2.7, "Fragment processing"; OpenGL and Direct3D agree). A test compares it with the GPU.

use crate::plan::{FaceMasks, RasterState};
use wgpu_types::{CompareFunction, StencilOperation};

/// The stored depth and stencil of a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DepthStencil {
    /// Depth as stored in the buffer.
    pub depth: f32,
    /// Stencil of eight bits.
    pub stencil: u8,
}

/// A fragment that arrives at a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IncomingFragment {
    /// Its depth, bias included.
    pub depth: f32,
    /// True for a fragment of the front of its triangle.
    pub front_facing: bool,
}

/// The result of a fragment's stencil and depth tests: which of them passed, the stencil operation that ran, and the
/// depth and stencil that the pixel stores after it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TestOutcome {
    /// True where the stencil test passed.
    pub stencil_passed: bool,
    /// Whether the depth test passed; `None` where the stencil test failed before it.
    pub depth_passed: Option<bool>,
    /// The operation that ran.
    pub operation: StencilOperation,
    /// What the pixel stores now.
    pub after: DepthStencil,
}

impl TestOutcome {
    /// Returns whether the fragment reaches the colour target.
    pub fn passed(&self) -> bool {
        self.depth_passed == Some(true)
    }
}

/// Returns whether the stencil test of a face passes where `stored` is the stored value.
pub fn stencil_passes(state: &RasterState, front_facing: bool, stored: u8) -> bool {
    let (face, FaceMasks { reference, read, .. }) = state.face(front_facing);
    compare(face.compare, reference & read, stored & read)
}

/// Tests a fragment against the stored values as WebGPU does: stencil first, then depth; returns the results and what
/// the pixel stores then. Masks and depth writes are respected, culling is not: culled faces have no fragments.
pub fn test(state: &RasterState, fragment: IncomingFragment, stored: DepthStencil) -> TestOutcome {
    let (face, FaceMasks { reference, write, .. }) = state.face(fragment.front_facing);
    let stencil_passed = stencil_passes(state, fragment.front_facing, stored.stencil);
    let depth_passed = stencil_passed.then(|| compare(state.depth_compare, fragment.depth, stored.depth));
    let operation = match depth_passed {
        None => face.fail_op,
        Some(false) => face.depth_fail_op,
        Some(true) => face.pass_op,
    };
    let written = operate(operation, stored.stencil, reference);
    let stencil = (stored.stencil & !write) | (written & write);
    let writes_depth = depth_passed == Some(true) && state.depth_write;
    let depth = if writes_depth { fragment.depth } else { stored.depth };
    TestOutcome { stencil_passed, depth_passed, operation, after: DepthStencil { depth, stencil } }
}

/// Returns `new FUNCTION stored`, with the new value on the left, as all APIs define it: `Less` is true where `new` is
/// less.
fn compare<T: PartialOrd>(function: CompareFunction, new: T, stored: T) -> bool {
    match function {
        CompareFunction::Never => false,
        CompareFunction::Less => new < stored,
        CompareFunction::Equal => new == stored,
        CompareFunction::LessEqual => new <= stored,
        CompareFunction::Greater => new > stored,
        CompareFunction::NotEqual => new != stored,
        CompareFunction::GreaterEqual => new >= stored,
        CompareFunction::Always => true,
    }
}

fn operate(operation: StencilOperation, stored: u8, reference: u8) -> u8 {
    match operation {
        StencilOperation::Keep => stored,
        StencilOperation::Zero => 0,
        StencilOperation::Replace => reference,
        StencilOperation::Invert => !stored,
        StencilOperation::IncrementClamp => stored.saturating_add(1),
        StencilOperation::DecrementClamp => stored.saturating_sub(1),
        StencilOperation::IncrementWrap => stored.wrapping_add(1),
        StencilOperation::DecrementWrap => stored.wrapping_sub(1),
    }
}
