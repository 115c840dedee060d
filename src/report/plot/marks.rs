//! Shape and colour of each technique: the one table that paper and screen share.
//!
//! Hues are Okabe and Ito's (2008), darkened for paper and lightened for the dark panels until texts in them pass a
//! contrast of 4.5 : 1. No two techniques share a shape, so a grey print distinguishes them too.

use crate::technique::Technique;

/// The shape of a technique's mark in plots.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MarkShape {
    /// A disc.
    Circle,
    /// A square with horizontal sides.
    Square,
    /// A square that stands on a corner.
    Diamond,
    /// A triangle that points up.
    TriangleUp,
    /// A triangle that points down.
    TriangleDown,
    /// A triangle that points right.
    TriangleRight,
    /// A triangle that points left.
    TriangleLeft,
    /// A star of five points.
    Star,
    /// A plus sign of two thick bars.
    Plus,
    /// A slanted cross of two thick bars.
    Cross,
    /// A hexagon.
    Hexagon,
}

/// The shape and colours of a technique's mark in every plot.
#[derive(Debug, PartialEq)]
pub struct TechniqueStyle {
    /// Name of the technique.
    pub technique: &'static str,
    /// The mark's shape.
    pub mark: MarkShape,
    /// Colour on white paper, sRGB.
    pub paper: [u8; 3],
    /// Colour on the inspector's panels, sRGB.
    pub screen: [u8; 3],
}

const fn style(technique: &'static str, mark: MarkShape, paper: [u8; 3], screen: [u8; 3]) -> TechniqueStyle {
    TechniqueStyle { technique, mark, paper, screen }
}

/// The styles of all techniques, in the order of [`Technique::ALL`].
pub static STYLES: [TechniqueStyle; Technique::ALL.len()] = {
    let mut styles = [const { style("", MarkShape::Hexagon, [0; 3], [0; 3]) }; Technique::ALL.len()];
    let mut index = 0;
    while index < styles.len() {
        styles[index] = look(Technique::ALL[index]);
        index += 1;
    }
    styles
};

const fn look(technique: Technique) -> TechniqueStyle {
    let (mark, paper, screen) = match technique {
        Technique::None => (MarkShape::Cross, [0x5d, 0x64, 0x73], [0xa3, 0xa9, 0xb6]),
        Technique::Planar => (MarkShape::Square, [0x1b, 0x74, 0xa8], [0x56, 0xb4, 0xe9]),
        Technique::PlanarTexture => (MarkShape::TriangleRight, [0x00, 0x55, 0xa0], [0x8f, 0xb8, 0xe8]),
        Technique::ZPass => (MarkShape::TriangleUp, [0x7d, 0x72, 0x00], [0xf0, 0xe4, 0x42]),
        Technique::ZPassPlus => (MarkShape::Plus, [0x94, 0x63, 0x00], [0xe6, 0x9f, 0x00]),
        Technique::ZFail => (MarkShape::TriangleDown, [0x00, 0x7d, 0x5b], [0x2f, 0xb5, 0x8a]),
        Technique::Auto => (MarkShape::Star, [0xa8, 0x4c, 0x80], [0xcc, 0x79, 0xa7]),
        Technique::ShadowMap => (MarkShape::Diamond, [0xb8, 0x4f, 0x00], [0xe8, 0x7f, 0x3a]),
        Technique::Projective => (MarkShape::TriangleLeft, [0x6c, 0x4b, 0xb8], [0xa8, 0x8e, 0xe6]),
        Technique::RayTraced => (MarkShape::Circle, [0x1b, 0x1e, 0x25], [0xd9, 0xdc, 0xe3]),
    };
    style(technique.name(), mark, paper, screen)
}

/// The style of a technique that this version does not know: a grey hexagon.
pub static UNKNOWN: TechniqueStyle = style("", MarkShape::Hexagon, [0x5d, 0x64, 0x73], [0xa3, 0xa9, 0xb6]);

/// Returns the style of a technique; a neutral one for a name that is not known.
pub fn style_of(technique: &str) -> &'static TechniqueStyle {
    STYLES.iter().find(|style| style.technique == technique).unwrap_or(&UNKNOWN)
}

impl MarkShape {
    /// Returns corners of the shape around the origin, y downwards; all shapes have about the area of a disc of this
    /// radius, and every corner is visible from the centre.
    pub fn outline(self, radius: f64) -> Vec<[f64; 2]> {
        let regular = |corners: u32, turn: f64, size: f64| {
            let corner = move |index: u32| {
                let angle = (f64::from(index) / f64::from(corners) + turn) * std::f64::consts::TAU;
                [angle.sin() * size * radius, -angle.cos() * size * radius]
            };
            (0..corners).map(corner).collect::<Vec<_>>()
        };
        match self {
            MarkShape::Circle => regular(24, 0.0, 1.0),
            MarkShape::Square => regular(4, 0.125, 1.25),
            MarkShape::Diamond => regular(4, 0.0, 1.25),
            MarkShape::TriangleUp => regular(3, 0.0, 1.4),
            MarkShape::TriangleRight => regular(3, 0.25, 1.4),
            MarkShape::TriangleDown => regular(3, 0.5, 1.4),
            MarkShape::TriangleLeft => regular(3, 0.75, 1.4),
            MarkShape::Hexagon => regular(6, 0.0, 1.1),
            MarkShape::Star => {
                let outer = regular(5, 0.0, 1.5);
                let inner = regular(5, 0.1, 0.65);
                outer.into_iter().zip(inner).flat_map(|(outer, inner)| [outer, inner]).collect()
            }
            MarkShape::Plus => bars(radius),
            MarkShape::Cross => {
                bars(radius).into_iter().map(|[x, y]| [(x - y) * 0.5_f64.sqrt(), (x + y) * 0.5_f64.sqrt()]).collect()
            }
        }
    }
}

/// Returns the outline of an upright plus sign of two bars around the origin, a little larger than a circle of
/// `radius`.
fn bars(radius: f64) -> Vec<[f64; 2]> {
    let [short, long] = [0.4 * radius, 1.25 * radius];
    let arm = [[-short, -short], [-short, -long], [short, -long]];
    // The same corner and arm, rotated by quarters.
    let quarter = |turns: usize| arm.map(|point| (0..turns).fold(point, |[x, y], _| [-y, x]));
    (0..4).flat_map(quarter).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the contrast of two colours (WCAG 2.1).
    fn contrast(one: [u8; 3], other: [u8; 3]) -> f64 {
        let linear = |byte: u8| {
            let value = f64::from(byte) / 255.0;
            if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
        };
        let light = |[r, g, b]: [u8; 3]| 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
        let [one, other] = [light(one), light(other)];
        (one.max(other) + 0.05) / (one.min(other) + 0.05)
    }

    #[test]
    fn words_in_a_techniques_colour_can_be_read_on_paper_and_on_panels() {
        for style in STYLES.iter().chain([&UNKNOWN]) {
            let paper = contrast(style.paper, [255; 3]);
            let screen = contrast(style.screen, [0x1b, 0x1e, 0x25]);
            assert!(paper >= 4.5 && screen >= 4.5, "{}: {paper:.2}, {screen:.2}", style.technique);
        }
    }

    #[test]
    fn no_two_techniques_share_a_shape() {
        for (index, style) in STYLES.iter().enumerate() {
            assert!(STYLES[..index].iter().all(|other| other.mark != style.mark), "{}", style.technique);
            assert_ne!(style.mark, UNKNOWN.mark);
        }
    }

    #[test]
    fn shapes_are_about_as_large_as_a_disc() {
        for style in STYLES.iter().chain([&UNKNOWN]) {
            let outline = style.mark.outline(1.0);
            let next = outline.iter().cycle().skip(1);
            let area: f64 = outline.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>() / 2.0;
            assert!((2.3..3.6).contains(&area), "{}: {area}", style.technique);
        }
    }

    #[test]
    fn an_unknown_technique_has_a_neutral_mark() {
        assert_eq!(style_of("z-fail").mark, MarkShape::TriangleDown);
        assert_eq!(style_of("of the future"), &UNKNOWN);
    }
}
