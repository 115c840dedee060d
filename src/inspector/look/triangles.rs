//! Triangles of egui filled on the CPU, for files.
//!
//! A pixel is filled where its middle lies in a triangle, row by row between the edges: the left border belongs to a
//! triangle and the right one does not, so that neighbours neither overlap nor leave a gap. Colours are mixed as egui's
//! own renderer mixes them: sRGB bytes, multiplied by their alpha.

use crate::inspector::look::texture::over;
use crate::picture::Picture;
use egui::epaint::{ImageData, Mesh, Vertex};
use egui::{Color32, ColorImage, Pos2, Rect, TextureId, TexturesDelta};

/// Returns the font texture, built from the texture changes of egui's first frame; a single white texel where they
/// contain none. Its first texel is white.
pub fn letters(textures: &TexturesDelta) -> ColorImage {
    let mut letters = ColorImage::filled([1, 1], Color32::WHITE);
    for delta in textures.set.get(&TextureId::default()).into_iter().flatten() {
        let ImageData::Color(image) = &delta.image;
        match delta.pos {
            None => letters = ColorImage::clone(image),
            Some([left, top]) => {
                for (row, texels) in image.pixels.chunks_exact(image.size[0].max(1)).enumerate() {
                    let first = (top + row) * letters.size[0] + left;
                    if let Some(place) = letters.pixels.get_mut(first..first + texels.len()) {
                        place.copy_from_slice(texels);
                    }
                }
            }
        }
    }
    letters
}

/// Blends the triangles of `mesh`, whose positions are pixels, over `picture` where a pixel's middle lies in them and
/// in `clip`. Colours are multiplied by `letters`; triangles of either winding are drawn, and those with a missing
/// vertex or no area are left out.
pub fn fill(picture: &mut Picture, mesh: &Mesh, clip: Rect, letters: &ColorImage) {
    let [width, height] = picture.size().map(|side| side as f32);
    let clip = clip.intersect(Rect::from_min_max(Pos2::ZERO, Pos2::new(width, height)));
    for triangle in mesh.indices.chunks_exact(3) {
        let corners = [0, 1, 2].map(|corner| mesh.vertices.get(triangle[corner] as usize).copied());
        if let [Some(a), Some(b), Some(c)] = corners {
            fill_triangle(picture, [a, b, c], clip, letters);
        }
    }
}

/// Returns the first pixel whose middle is not before `edge`.
fn first(edge: f32) -> u32 {
    (edge - 0.5).ceil().max(0.0) as u32
}

fn fill_triangle(picture: &mut Picture, corners: [Vertex; 3], clip: Rect, letters: &ColorImage) {
    let [a, b, c] = corners.map(|corner| corner.pos);
    let doubled = (b - a).x * (c - a).y - (b - a).y * (c - a).x;
    if doubled == 0.0 || !doubled.is_finite() {
        return;
    }
    let top = a.y.min(b.y).min(c.y).max(clip.top());
    let bottom = a.y.max(b.y).max(c.y).min(clip.bottom());
    for y in first(top)..first(bottom) {
        let middle = y as f32 + 0.5;
        let Some([left, right]) = between([a, b, c], middle) else { continue };
        for x in first(left.max(clip.left()))..first(right.min(clip.right())) {
            let at = Pos2::new(x as f32 + 0.5, middle);
            let share =
                |from: Pos2, to: Pos2| ((to - from).x * (at - from).y - (to - from).y * (at - from).x) / doubled;
            let shares = [share(b, c), share(c, a), share(a, b)];
            if let Some(under) = picture.at([x, y]) {
                picture.set([x, y], over(color(corners, shares, letters), under));
            }
        }
    }
}

/// Returns the smallest and largest x where the horizontal line at `y` crosses a triangle's edges; `None` where it
/// crosses none. An edge includes its upper end, and not its lower one.
fn between([a, b, c]: [Pos2; 3], y: f32) -> Option<[f32; 2]> {
    let crossing = |[p, q]: [Pos2; 2]| {
        let [upper, lower] = if p.y <= q.y { [p, q] } else { [q, p] };
        let is_crossed = upper.y <= y && y < lower.y;
        is_crossed.then(|| upper.x + (y - upper.y) / (lower.y - upper.y) * (lower.x - upper.x))
    };
    let crossings = [[a, b], [b, c], [c, a]].into_iter().filter_map(crossing);
    crossings.fold(None, |ends: Option<[f32; 2]>, x| Some(ends.map_or([x, x], |[low, high]| [low.min(x), high.max(x)])))
}

/// Interpolates the corners' colours with barycentric weights `shares`, times the nearest texel of the font texture.
/// Returns premultiplied sRGB.
fn color(corners: [Vertex; 3], shares: [f32; 3], letters: &ColorImage) -> Color32 {
    let mixed = |value: &dyn Fn(&Vertex) -> f32| -> f32 {
        corners.iter().zip(shares).map(|(corner, share)| value(corner) * share).sum()
    };
    let texel = |place: f32, side: usize| ((place * side as f32) as usize).min(side.saturating_sub(1));
    let column = texel(mixed(&|corner| corner.uv.x), letters.size[0]);
    let row = texel(mixed(&|corner| corner.uv.y), letters.size[1]);
    let letter = letters.pixels.get(row * letters.size[0] + column).copied().unwrap_or(Color32::WHITE).to_array();
    let [red, green, blue, alpha] = std::array::from_fn(|channel| {
        let value = mixed(&|corner| f32::from(corner.color.to_array()[channel]));
        (value * f32::from(letter[channel]) / 255.0).round().clamp(0.0, 255.0) as u8
    });
    Color32::from_rgba_premultiplied(red, green, blue, alpha)
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{pos2, vec2};

    const GROUND: [u8; 3] = [10, 20, 30];

    fn filled(mesh: &Mesh, clip: Rect) -> Picture {
        let mut picture = Picture::filled([8, 6], GROUND);
        fill(&mut picture, mesh, clip, &ColorImage::filled([1, 1], Color32::WHITE));
        picture
    }

    fn rectangle(rect: Rect, color: Color32) -> Mesh {
        let mut mesh = Mesh::default();
        mesh.add_colored_rect(rect, color);
        mesh
    }

    #[test]
    fn two_triangles_of_a_see_through_rectangle_cover_each_pixel_once() {
        let half = Color32::from_rgba_premultiplied(100, 0, 0, 128);
        let rect = Rect::from_min_size(pos2(1.0, 2.0), vec2(5.0, 3.0));
        let picture = filled(&rectangle(rect, half), Rect::EVERYTHING);
        for (x, y) in (0..6).flat_map(|y| (0..8).map(move |x| (x, y))) {
            let is_inside = (1..6).contains(&x) && (2..5).contains(&y);
            let expected = if is_inside { over(half, GROUND) } else { GROUND };
            assert_eq!(picture.at([x, y]), Some(expected), "{x}, {y}");
        }
    }

    #[test]
    fn what_lies_outside_of_the_clip_or_of_the_picture_is_left_away() {
        let all = rectangle(Rect::from_min_max(pos2(-1e4, -1e4), pos2(1e4, 1e4)), Color32::WHITE);
        let picture = filled(&all, Rect::from_min_max(pos2(3.0, 1.0), pos2(5.0, 99.0)));
        let white = (0..6).flat_map(|y| (0..8).map(move |x| [x, y])).filter(|at| picture.at(*at) == Some([255; 3]));
        assert_eq!(white.count(), 2 * 5);
    }

    #[test]
    fn colours_run_from_corner_to_corner() {
        let mut mesh = Mesh::default();
        for (x, y, value) in [(0.0, 0.0, 0), (8.0, 0.0, 160), (0.0, 6.0, 0), (8.0, 6.0, 160)] {
            mesh.colored_vertex(pos2(x, y), Color32::from_gray(value));
        }
        mesh.add_triangle(0, 1, 2);
        mesh.add_triangle(2, 1, 3);
        let picture = filled(&mesh, Rect::EVERYTHING);
        let row = |y| (0..8).map(|x| picture.at([x, y]).expect("a pixel")[0]).collect::<Vec<_>>();
        assert_eq!(row(0), [10, 30, 50, 70, 90, 110, 130, 150]);
        assert_eq!(row(5), row(0));
    }

    #[test]
    fn a_letter_is_written_as_its_texture_has_it() {
        let ctx = egui::Context::default();
        let at = pos2(2.0, 2.0);
        let mut output = ctx.run_ui(egui::RawInput::default(), |ui| {
            ui.painter().text(at, egui::Align2::LEFT_TOP, "I", egui::FontId::monospace(14.0), Color32::WHITE);
        });
        let letters = letters(&output.textures_delta);
        output.textures_delta.clear();
        assert_eq!(letters.pixels[0], Color32::WHITE);
        let mut picture = Picture::filled([16, 24], [0; 3]);
        for primitive in ctx.tessellate(output.shapes, 1.0) {
            if let egui::epaint::Primitive::Mesh(mesh) = &primitive.primitive {
                fill(&mut picture, mesh, primitive.clip_rect, &letters);
            }
        }
        let inked = (0..24).flat_map(|y| (0..16).map(move |x| [x, y]));
        let inked: Vec<[u32; 2]> = inked.filter(|at| picture.at(*at).is_some_and(|ink| ink[0] > 128)).collect();
        assert!((8..60).contains(&inked.len()), "{inked:?}");
        let [low, high] = [inked.iter().map(|at| at[1]).min(), inked.iter().map(|at| at[1]).max()];
        assert!(high > low.map(|low| low + 5), "as high as a letter: {inked:?}");
    }
}
