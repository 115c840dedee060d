//! How each cause can be shown, and what is truly there beside it.

use crate::common::adapter;
use stencilscope::diagnosis::Cause;

/// How a cause can be shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Occasion {
    /// A scene with a setting, or with a plan made wrong. Other causes may be proven there too, each for a reason.
    Scene(&'static [AlsoThere]),
    /// A flag of the scene, which the truth honours: no pixel is wrong.
    Flag,
    /// The frame of another program alone.
    ForeignFrame,
    /// One pixel of tens of millions, in a mesh of others that is not kept here.
    InAStrangersMesh,
}

/// A cause that is truly there beside another one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AlsoThere {
    pub cause: Cause,
    /// Why it is there, for whoever reads the table.
    pub because: &'static str,
}

/// Returns how a cause can be shown. No cause is left out: a new one does not compile without a line here.
pub fn occasion(cause: Cause) -> Occasion {
    match cause {
        Cause::EyeInVolume
        | Cause::NearPlaneCut
        | Cause::NearPlaneCrack
        | Cause::MissingDarkCap
        | Cause::MissingLightCap
        | Cause::FarClip
        | Cause::FiniteExtrusion
        | Cause::LightNotAdded
        | Cause::OpenMesh
        | Cause::NonManifold
        | Cause::InconsistentWinding
        | Cause::SplitVertices
        | Cause::NearVertices
        | Cause::LightInside
        | Cause::Clamped
        | Cause::Wrap256
        | Cause::FewBits
        | Cause::Parity
        | Cause::OperationOrder
        | Cause::CapFighting
        | Cause::DoubleBlend
        | Cause::OpaqueShadow
        | Cause::DoubleLighting
        | Cause::ZFighting
        | Cause::AntiShadow
        | Cause::FalseShadow
        | Cause::ReceiverLeftOut
        | Cause::Acne
        | Cause::PeterPanning
        | Cause::MapFacesCulled
        | Cause::Aliasing
        | Cause::OutsideMap
        | Cause::MapNearPlane
        | Cause::MapFarPlane
        | Cause::MapSwims
        | Cause::TJunction
        | Cause::Mirrored
        | Cause::F32World
        | Cause::DepthPrecision
        | Cause::Between
        | Cause::EdgeSmear
        | Cause::SelfShadow
        | Cause::F32Limit
        | Cause::CarriedInF32 => Occasion::Scene(&[]),
        Cause::MapSeam => Occasion::Scene(&[
            AlsoThere {
                cause: Cause::Acne,
                because: "A filter so wide compares texels of the post's own lit side, too.",
            },
            AlsoThere {
                cause: Cause::PeterPanning,
                because: "The bias against that shows a little at the foot of a post.",
            },
        ]),
        Cause::SubpixelEdges => Occasion::Scene(&[AlsoThere {
            cause: Cause::RasteriserPrecision,
            because: "Of many short edges some have sides that are seen nearly edge-on.",
        }]),
        Cause::OffReceiver => Occasion::Scene(&[AlsoThere {
            cause: Cause::DoubleBlend,
            because: "Without the stencil nothing keeps overlapping triangles from darkening a pixel twice.",
        }]),
        Cause::NotPlanar => Occasion::Scene(&[AlsoThere {
            cause: Cause::Aliasing,
            because: "What is flat has a texture, and outlines run between its texels.",
        }]),
        Cause::ReverseProjection => Occasion::Scene(&[AlsoThere {
            cause: Cause::Aliasing,
            because: "The wall stands on the floor, where its outline runs through texels of any size.",
        }]),
        Cause::NotReceiving | Cause::NotCasting | Cause::Undrawn => Occasion::Flag,
        Cause::RasteriserPrecision => Occasion::InAStrangersMesh,
        Cause::FaceCulled
        | Cause::VolumesWriteDepth
        | Cause::StencilNotCleared
        | Cause::MapNotCleared
        | Cause::NotInMap
        | Cause::MapDepthCoarse
        | Cause::StencilMask
        | Cause::OpenVolume => Occasion::ForeignFrame,
    }
}

/// Returns the causes of wrong pixels that scenes can show on this adapter.
pub fn causes() -> Vec<Cause> {
    // Where corners are put on a coarse grid beforehand, no side tilts.
    let shows = |cause: &Cause| *cause != Cause::SubpixelEdges || adapter::draws_as_given();
    let causes = Cause::ALL.into_iter().filter(|cause| matches!(occasion(*cause), Occasion::Scene(_)));
    causes.filter(shows).collect()
}
