//! A difference in words: the first pass that differs, then every pass, then the lights.

use super::{
    AspectChange, AspectDifference, AspectKind, Difference, DifferenceNote, LightDifference, PassDifference,
    PixelDifference, Texel, TexelDifference,
};
use crate::numbers;
use crate::truth::PixelLabel;

impl Difference {
    /// Returns the difference as text: what was asked for differently, the first difference in detail, a line for each
    /// pass and light. Passes and lights count from 1, pixels from 0 as in `pixel --at`.
    pub fn to_text(&self) -> String {
        let mut out = String::new();
        self.asked.iter().chain(&self.conditions).for_each(|one| out += &note(one));
        if self.is_none() {
            let passes = self.passes.len();
            out += &format!("the same: all {passes} passes, every pixel\n");
            return out;
        }
        if let Some(first) = self.first() {
            out += &format!("first difference: {}\n", title(first));
            out += &details(first);
        }
        if let Some(first) = self.first_in_pixels()
            && self.first().is_some_and(PassDifference::has_no_pixels)
        {
            out += &format!("first pass of both whose pixels differ: {}\n", title(first));
            out += &details(first);
        }
        out += "passes\n";
        self.passes.iter().for_each(|pass| out += &row(pass));
        self.lights.iter().for_each(|light| out += &of_light(light));
        out
    }

    /// Returns where the first difference is, in a few words: `pass 2, light 1: volumes`; where no pass differs a
    /// light's, else the first differing condition. `None` where nothing of these differs.
    pub fn first_place(&self) -> Option<String> {
        let of_light = |light: &LightDifference| {
            let aspect = light.aspects.first()?.aspect.title();
            Some(format!("{}: {aspect}", numbers::light(light.light)))
        };
        let of_pass = self.first().map(title);
        let of_lights = || self.lights.iter().find_map(of_light);
        of_pass.or_else(of_lights).or_else(|| self.conditions.first().map(|note| note.what.clone()))
    }
}

impl PassDifference {
    fn has_no_pixels(&self) -> bool {
        self.states().flatten().all(|aspect| aspect.pixels().is_none())
    }
}

impl AspectKind {
    /// Returns the aspect's name in words for people; faces and layers count from 1.
    pub fn title(self) -> String {
        match self {
            AspectKind::Map(face) => format!("face {} of the map", face + 1),
            AspectKind::Textures(layer) => format!("layer {} of the textures", layer + 1),
            AspectKind::Truth => "ground truth".to_owned(),
            AspectKind::TruthVisibility => "true visibility".to_owned(),
            AspectKind::Findings => "error picture".to_owned(),
            plain => plain.name().to_owned(),
        }
    }
}

fn note(DifferenceNote { what, a, b }: &DifferenceNote) -> String {
    /// The longest text that is printed on one line.
    const LONGEST: usize = 60;
    let short = |text: &str| match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    };
    format!("{what}: {} in A, {} in B\n", short(a), short(b))
}

/// Writes `pass 2, light 1: volumes`; both numbers where they differ.
fn title(pass: &PassDifference) -> String {
    format!("pass {}, {}", number(pass), name(pass))
}

fn number(pass: &PassDifference) -> String {
    match pass.index {
        [Some(a), Some(b)] if a != b => format!("{} in A, {} in B", a + 1, b + 1),
        [Some(a), Some(_)] => (a + 1).to_string(),
        [Some(a), None] => format!("{} in A alone", a + 1),
        [None, Some(b)] => format!("{} in B alone", b + 1),
        [None, None] => String::new(),
    }
}

fn name(pass: &PassDifference) -> String {
    pass.light.map_or_else(|| pass.name.clone(), |light| format!("{}: {}", numbers::light(light), pass.name))
}

fn details(pass: &PassDifference) -> String {
    let mut out: String = pass.aspects.iter().map(|aspect| aspect_lines(aspect, "  ")).collect();
    if let Some(draw) = pass.draws.first() {
        let [a, b] = draw.index.map(|index| index + 1);
        let number = if a == b { a.to_string() } else { format!("{a} in A, {b} in B") };
        out += &format!("  first draw that differs: {number}: {}\n", draw.name);
        out.extend(draw.aspects.iter().map(|aspect| aspect_lines(aspect, "    ")));
    }
    out
}

fn aspect_lines(difference: &AspectDifference, indent: &str) -> String {
    let AspectDifference { aspect, found, carried } = difference;
    let title = aspect.title();
    let carried = if *carried { ", as before" } else { "" };
    match found {
        AspectChange::OnlyIn(side) => format!("{indent}{title}: only in {}{carried}\n", side.name()),
        AspectChange::Sizes([a, b]) => format!("{indent}{title}: {}x{} in A, {}x{} in B\n", a[0], a[1], b[0], b[1]),
        AspectChange::Pixels(PixelDifference { pixels, largest, region }) => {
            let [left, top, right, bottom] = region.bounds;
            let mut out = format!("{indent}{title}: {}{carried}\n", pixel_count(*pixels));
            out += &format!("{indent}  {}\n", texel(*aspect, largest));
            if *pixels > 1 {
                out += &format!(
                    "{indent}  largest region: {}, columns {left} to {right}, rows {top} to {bottom}\n{indent}    {}\n",
                    pixel_count(region.pixels),
                    texel(*aspect, &region.largest),
                );
            }
            out
        }
    }
}

fn pixel_count(pixels: u64) -> String {
    let noun = if pixels == 1 { "pixel" } else { "pixels" };
    format!("{} {noun}", numbers::count(pixels))
}

/// Returns `most at 160,120: 1 in A, 3 in B, 2 apart` for the texel that differs most; for labels `such as at …`
/// without a distance.
fn texel(aspect: AspectKind, TexelDifference { at, values, by }: &TexelDifference) -> String {
    let [a, b] = values.map(|value| value_text(aspect, value));
    let by = match (aspect, values) {
        _ if !aspect.has_distances() => String::new(),
        _ if *by == 0.0 => ": in bits alone".to_owned(),
        _ if by.is_infinite() => ": one is no number".to_owned(),
        (_, [Texel::Float(_), _]) => format!(", {} apart", numbers::digits(*by)),
        _ => format!(", {by} apart"),
    };
    let most = if aspect.has_distances() { "most at" } else { "such as at" };
    format!("{most} {},{}: {a} in A, {b} in B{by}", at[0], at[1])
}

fn value_text(aspect: AspectKind, value: Texel) -> String {
    match (aspect, value) {
        (AspectKind::Labels | AspectKind::Truth, Texel::Byte(label)) => {
            PixelLabel::from_byte(label).map_or_else(|| format!("label {label}"), |label| label.name().to_owned())
        }
        (AspectKind::Findings, Texel::Byte(byte)) => match crate::accuracy::Finding::from_byte(byte) {
            Some(finding) => finding.name().replace('_', " "),
            None => format!("finding {byte}"),
        },
        (_, Texel::Byte(count)) => numbers::signed(count),
        (_, Texel::Color([red, green, blue, 255])) => format!("#{red:02x}{green:02x}{blue:02x}"),
        (_, Texel::Color([red, green, blue, alpha])) => format!("#{red:02x}{green:02x}{blue:02x}{alpha:02x}"),
        (_, Texel::Float(value)) => format!("{value:?} (0x{:08x})", value.to_bits()),
    }
}

/// Returns one line for a pass: its number (from 1, both where they differ), its name and what differs, `the same` or
/// `only in A`.
fn row(pass: &PassDifference) -> String {
    let found = match pass.only_in() {
        Some(side) => format!("only in {}", side.name()),
        None if pass.differs() => {
            let aspects: Vec<String> = pass.aspects.iter().map(summary).collect();
            let draws = pass.draws.len();
            let of_draws = (draws > 0).then(|| format!("{draws} of its draws"));
            aspects.into_iter().chain(of_draws).collect::<Vec<_>>().join("; ")
        }
        None => "the same".to_owned(),
    };
    let number = match pass.index {
        [Some(a), Some(b)] if a != b => format!("{}/{}", a + 1, b + 1),
        [Some(index), _] | [_, Some(index)] => (index + 1).to_string(),
        [None, None] => String::new(),
    };
    format!("  {number:>5}  {:28} {found}\n", name(pass))
}

fn summary(AspectDifference { aspect, found, carried }: &AspectDifference) -> String {
    let found = match found {
        AspectChange::Pixels(pixels) => pixel_count(pixels.pixels),
        AspectChange::OnlyIn(side) => format!("only in {}", side.name()),
        AspectChange::Sizes(_) => "another size".to_owned(),
    };
    let carried = if *carried { " as before" } else { "" };
    format!("{}: {found}{carried}", aspect.title())
}

/// Returns lines on what differs for a light at the end of the frame, and how many pixels changed from which label to
/// which; empty where no aspect differs.
fn of_light(light: &LightDifference) -> String {
    if light.aspects.is_empty() {
        return String::new();
    }
    let mut summaries: Vec<String> = Vec::new();
    for difference in &light.aspects {
        let whole_map = matches!(difference.found, AspectChange::OnlyIn(_)) && difference.aspect.layer().is_some();
        let one = if whole_map { of_map(difference) } else { summary(difference) };
        if summaries.last() != Some(&one) {
            summaries.push(one);
        }
    }
    let mut out = format!("{} at the end: {}\n", numbers::light(light.light), summaries.join("; "));
    for ([a, b], pixels) in &light.labels {
        let [a, b] = [*a, *b].map(|label| value_text(AspectKind::Labels, Texel::Byte(label)));
        out += &format!("  {}: {a} in A, {b} in B\n", pixel_count(*pixels));
    }
    out
}

/// Returns words for a whole map or all textures that only one frame has, without the number of the face or layer.
fn of_map(AspectDifference { aspect, found, .. }: &AspectDifference) -> String {
    match found {
        AspectChange::OnlyIn(side) => format!("{}: only in {}", aspect.name(), side.name()),
        AspectChange::Pixels(_) | AspectChange::Sizes(_) => aspect.name().to_owned(),
    }
}
