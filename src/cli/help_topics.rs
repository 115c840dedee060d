//! What `help` explains besides techniques, settings, pages and causes: words of shadows and pictures, and matrices.

use crate::technique::{Citation, Lesson, cited};

/// On projections and their vanishing points.
const CARLBOM: Citation = Citation {
    authors: "Carlbom and Paciorek",
    year: 1978,
    title: "Planar Geometric Projections and Viewing Transformations",
};
/// On penumbrae, by rays to places on a light.
const COOK: Citation = Citation { authors: "Cook, Porter and Carpenter", year: 1984, title: "Distributed Ray Tracing" };

/// A word or a matrix that `help` explains.
pub(super) struct HelpTopic {
    /// The key.
    pub name: &'static str,
    /// What it is, in a few words.
    pub meaning: &'static str,
    pub lesson: Lesson,
}

const fn topic(name: &'static str, meaning: &'static str, lesson: Lesson) -> HelpTopic {
    HelpTopic { name, meaning, lesson }
}

/// Words that are no technique, no setting and no cause.
pub(super) const TOPICS: [HelpTopic; 9] = [
    topic(
        "umbra",
        "where a light is wholly hidden, and penumbra, where it is hidden in part",
        Lesson {
            text: "Where a light is wholly hidden is its umbra; where a part of it is seen past the caster, its penumbra. The \
                 penumbra begins with no width at the caster, and widens with the distance behind it. All lights here are \
                 points or suns, which are seen or not: every shadow is umbra alone. `help filter` has what softens a map's \
                 edges, which is no penumbra: it is as wide everywhere. In window and files: the label of a pixel is `lit` or \
                 `in shadow`, and visibility lies between them only where a filter or a texture mixes texels.",
            formula: "behind an edge at the distance a from a light of width w, and b from the surface, the penumbra is w b / \
                 a wide: for w = 0, nothing",
            sources: &[cited::CROW, COOK],
        },
    ),
    topic(
        "penumbra",
        "where a light is hidden in part: nowhere here, as lights are points or suns",
        Lesson {
            text: "The part of a shadow in which some of the light is seen past the caster (`help umbra`). It takes a light with \
                 a size; lights here have none, so that no technique makes a penumbra and no truth has one. What `filter` and \
                 textures soften is an edge of constant width, which counts as an error where it is wide.",
            formula: "visibility = the seen share of the light's area, 0 in the umbra and 1 where it is lit; of a point 0 or 1",
            sources: &[cited::CROW, COOK],
        },
    ),
    topic(
        "channels",
        "the light of a picture by what it is: ambient, emissive, diffuse, specular",
        Lesson {
            text: "Light adds up, so that a picture is the sum of four: what surfaces reflect of the light that is everywhere \
                 (ambient), what they send out by themselves (emissive, with the background), what they scatter of the lights \
                 (diffuse), and highlights (specular). What is in shadow keeps the first two. `capture --channels` writes each as \
                 a picture, the window has them beside the picture's other kinds, and `pixel` says the four numbers of a pixel, \
                 their sum, and where it is more than the 1 that a picture holds. In a scene file: `ambient`, and of a material \
                 `emission`, `color`, `specular` and `shininess`. Where shadows are blended over the lit picture there is no sum.",
            formula: "with a colour C, ambient light A, lights L that arrive with the share V, and the unit vectors N normal, L to \
                 the light, H halfway to the eye: ambient C A; emissive E; diffuse the sum of V L C max(0, N . L); specular the \
                 sum of V L s max(0, N . H)^n",
            sources: &[cited::PHONG, cited::SEGAL_AKELEY],
        },
    ),
    topic(
        "vanishing-points",
        "where the picture has parallel lines meet: 1-, 2- and 3-point perspective",
        Lesson {
            text: "In a perspective picture parallel lines meet in one point, unless they are parallel to the picture. Of the three \
                 axes of the world one, two or three have such a point, by how the camera is turned: 1-point perspective looks \
                 along an axis, 2-point is turned about one, 3-point looks up or down as well. In a parallel projection none \
                 has. `pixel --coordinates` says which and where; in the window they are an overlay of the picture, *Vanishing \
                 points*. In a scene file: `eye`, `target`, `up` and `projection` of the camera.",
            formula: "of a direction d: clip = P V (d, 0), and the point clip.xy / clip.w; where clip.w = 0 lines stay parallel",
            sources: &[CARLBOM],
        },
    ),
    topic(
        "spherical-camera",
        "the eye by r, θ and φ about its target",
        Lesson {
            text: "A camera that goes round what it looks at is told by three numbers: its distance r from the target, its azimuth \
                 θ about the vertical, and its elevation φ over level, in degrees. The world's y is up here, and θ goes from +z \
                 towards +x; where z is up, as in much of the literature, it goes from +x towards +y: the same with the axes \
                 exchanged in turn. Moving the target takes the eye along. Right above or below the target the world's up is \
                 along the view, and the picture's up is the way in which φ grows. `--eye-spherical` has it, `eye_spherical` \
                 of a scene file's camera and the window's *Scene settings*; `pixel --coordinates` says r, θ and φ of every \
                 camera.",
            formula: "E = T + r (cos φ sin θ, sin φ, cos φ cos θ); the view's rows: right (cos θ, 0, -sin θ), up (-sin φ sin \
                 θ, cos φ, -sin φ cos θ), backward (cos φ sin θ, sin φ, cos φ cos θ), and T at z = -r; back by r = |E - T|, θ = \
                 atan2(x, z), φ = atan2(y, sqrt(x^2 + z^2)) of E - T",
            sources: &[CARLBOM, cited::SEGAL_AKELEY],
        },
    ),
    topic(
        "off-centre",
        "a perspective whose picture is not around the view's axis: a frustum by its edges",
        Lesson {
            text: "A perspective by its field of view has the view's axis in the middle of its picture. A frustum is told by where \
                 the edges of its picture meet the near plane, l, r, b and t, metres to the right of the axis and above it, and \
                 may lie to one side, or without the axis in it at all: for pictures side by side of one view, for two eyes, or \
                 for a façade without falling lines. What is far to the side is drawn out, as in any perspective. Moving the \
                 near plane alone changes how much is seen, and a picture whose sides have another ratio than r - l to t - b \
                 is stretched. No shadow depends on it: rays still begin at the eye. `--frustum L,R,B,T`, `projection = \
                 \"frustum\"` with `frustum` in a scene file, and the window's *Scene settings*, projection.",
            formula: "glFrustum(l, r, b, t, n, f): x' = (2 n x + (r + l) z) / (r - l), y' = (2 n y + (t + b) z) / (t - b), w' = \
                 -z; by the field of view t = -b = n tan(field of view / 2), r = -l = t aspect",
            sources: &[CARLBOM, cited::SEGAL_AKELEY],
        },
    ),
    topic(
        "viewport-offset",
        "the part of the picture that is drawn into: where the window's pixels begin",
        Lesson {
            text: "A viewport is the rectangle of the picture to which normalised device coordinates from -1 to 1 are mapped. What is \
                 drawn is cut at its edges, as they are the view's; clears are not, so that the rest of the picture stays as it \
                 was cleared, and no pixel of it shows a surface or counts. The projection takes the viewport's ratio of sides, \
                 and nothing is stretched. Given as shares of the picture, from its upper left; its edges go to the nearest \
                 pixel. Shadow maps have viewports of their own, and a light's scissor lies within the viewport. \
                 `--viewport LEFT,TOP,WIDTH,HEIGHT`, `viewport` in a scene file and in a link, and the window's *Scene settings*.",
            formula: "column = x0 + (x + 1) w / 2, row = y0 + (1 - y) h / 2; in a picture of W by H: x0 = left W, y0 = top H, w = width \
                 W, h = height H; OpenGL's glViewport(x0, H - y0 - h, w, h) counts rows from below",
            sources: &[cited::SEGAL_AKELEY],
        },
    ),
    topic(
        "normals",
        "which way a surface faces for its shading: of triangles, or averaged at vertices",
        Lesson {
            text: "Flat shading has one normal a triangle, perpendicular to it. Gouraud and Phong have one a vertex: the file's, or \
                 else the average of the triangles' there, each as much as its area. A normal decides how bright a surface is, and \
                 no shadow: shadow volumes and labels ask on which side of a triangle's own plane a light is. The window draws \
                 them in Scene, *Normals*; `pixel` says the one that a pixel is shaded by; `shading` of a material, or the \
                 setting, chooses. Mirrored objects keep theirs outwards.",
            formula: "of a triangle n = (b - a) x (c - a); at a vertex the sum of these over its triangles; both made unit length",
            sources: &[cited::GOURAUD, cited::PHONG],
        },
    ),
    topic(
        "rays",
        "who keeps the light away, by rays: the truth of each pixel, whatever the technique",
        Lesson {
            text: "From each light a ray goes to the surface that a pixel shows. `pixel` lists the casting triangles that it \
                 meets, by object and number, the nearest to the surface first, with the distances: who keeps the light away. It \
                 knows the scene alone, and no technique, so that it says the truth where a technique is wrong. In the window: \
                 tab Pixel, *Rays*, and tab Scene, *Rays of the pick*. A surface that faces away from the light, is out of its \
                 range or receives none asks nobody. Frames of other programs have no scene to follow rays in.",
            formula: "the segment from the light L to the surface S meets a triangle a, b, c where L and S lie on two sides of its \
                 plane, and the signs of orient(L, S, a, b), orient(L, S, b, c), orient(L, S, c, a) are one",
            sources: &[cited::APPEL, cited::SHEWCHUK],
        },
    ),
];

/// The matrices that the program shows.
pub(super) const MATRICES: [HelpTopic; 7] = [
    topic(
        "eye_from_world",
        "world space to eye space",
        Lesson {
            text: "Carries a point of the world to where the camera sees it: the eye at the origin, x to its right, y up, and the view \
                 along -z (`pixel --coordinates`). It is a rotation after a move: nothing is scaled. Step by step: E to the origin \
                 takes E from each point; the backward axis goes from the target T to E; right is at a right angle to it and to \
                 the camera's up; and up is at right angles to both. As these are at right angles and of unit length, their \
                 rows are the inverse of the matrix that has them as columns. OpenGL's is the same (gluLookAt). By spherical \
                 coordinates it is a turn by -θ about y, then by φ about x, then r along -z (`help spherical-camera`).",
            formula: "p' = R (p - E), with the eye E, and as rows of R the camera's right = up x backward, up = backward x right \
                 and backward = (E - T) / |E - T|, unit vectors; the fourth column is -R E: (-E . right, -E . up, -E . backward)",
            sources: &[cited::SEGAL_AKELEY],
        },
    ),
    topic(
        "clip_from_eye",
        "eye space to clip space",
        Lesson {
            text: "Carries a point that the camera sees to clip space: the picture where |x| and |y| are at most w, before the division \
                 by w that makes far things small (`pixel --coordinates`). Step by step: the line from the eye through a point meets \
                 the near plane z = -n at x n / -z, by similar triangles; the picture's edges there, l and r, become -1 and 1 by \
                 A x + B with A l + B = -1 and A r + B = 1, so A = 2 / (r - l) and B = -(r + l) / (r - l); and multiplied by w = \
                 -z, which is divided by later, that is linear: the first row. The second is the same with b and t. For the \
                 third, z over w is A / z + B with 0 at -n and 1 at -f, in OpenGL -1 and 1. By the field of view r = -l and t = \
                 -b (`help off-centre` has others). The third row is the depth mapping's (`help depth`), which may be reversed \
                 or end at infinity. OpenGL's has z from -w to w: its third row is twice this one less the fourth.",
            formula: "frustum: x' = (2 n x + (r + l) z) / (r - l), y' = (2 n y + (t + b) z) / (t - b), z' = -(f z + n f) / (f - n), \
                 w' = -z; OpenGL's z' = -((f + n) z + 2 n f) / (f - n) = 2 z' - w'. By the field of view, with c = 1 / tan(field \
                 of view / 2): x' = c x / aspect, y' = c y. Parallel, with half the picture's height h: x' = x / (h aspect), y' \
                 = y / h, z' = -(z + n) / (f - n), w' = 1; OpenGL's z' = -(2 z + f + n) / (f - n)",
            sources: &[cited::SEGAL_AKELEY, CARLBOM],
        },
    ),
    topic(
        "window_from_ndc",
        "normalised device coordinates to pixels",
        Lesson {
            text: "Carries normalised device coordinates, clip space over w, to pixels of a picture of W by H, whose rows run down \
                 (`pixel --coordinates`). Step by step: -1 to 1 is moved to 0 to 2, halved, made as wide as the viewport and moved to \
                 where that begins. The viewport is the whole picture, x0 = y0 = 0, unless `--viewport`, a scene file's `viewport` or \
                 the window say another (`help viewport-offset`); that of another program's frame is as it was recorded. Depth goes from 0 and 1 to n_w and f_w (`help depth-range`). OpenGL counts rows \
                 from below, y0 too, and halves z first, which goes from -1 to 1 (glViewport, glDepthRange): the same number is \
                 stored. WebGPU takes no n_w above f_w.",
            formula: "whole picture: x' = (x + 1) W / 2, y' = (1 - y) H / 2, z' = z; viewport x0, y0, w, h, depths n_w, f_w: x' = x0 + (x + 1) w / 2, y' = y0 + (1 - y) h / 2, z' = n_w + (f_w - \
                 n_w) z; OpenGL's x' = x0 + w / 2 + x w / 2, y' = y0 + h / 2 + y h / 2, z' = (f_w + n_w) / 2 + z (f_w - n_w) / 2",
            sources: &[cited::SEGAL_AKELEY],
        },
    ),
    topic(
        "light_from_world",
        "world space to a light's eye space",
        Lesson {
            text: "Carries a point of the world to where a light's shadow map sees it: the light at the origin, of a sun the middle of \
                 what casts; `matrices` of a manifest, and the window's tab State. For receiver textures and silhouettes it is the \
                 identity, and clip_from_light does it all.",
            formula: "p' = R (p - L), with the light L and a rotation R",
            sources: &[cited::WILLIAMS],
        },
    ),
    topic(
        "clip_from_light",
        "a light's eye space to its clip space",
        Lesson {
            text: "Carries a point in light space to the clip space of a layer of the light's map or texture: x and y over w, from -1 to \
                 1, are the place in it, and what is compared in a shadow map is z over w (`matrices` of a manifest). What lies \
                 outside is compared with nothing, and is lit. `pixel --coordinates` has OpenGL's form, too.",
            formula: "column = (x / w + 1) N / 2, row = (1 - y / w) N / 2, with N texels a side",
            sources: &[cited::WILLIAMS, cited::HECKBERT_HERF],
        },
    ),
    topic(
        "bias_matrix",
        "a light's clip space to texture coordinates s, t, r, q",
        Lesson {
            text: "Carries a light's clip space, from -w to w, to texture coordinates, from 0 to q (`pixel --coordinates`): a map or a \
                 texture is read at s / q, t / q, and r / q is what is compared. Behind the light q is not positive: dividing \
                 by it would project backwards. Rows of texels run down here, so that t is turned, and depth is from 0 to 1 \
                 already; OpenGL's halves all three alike.",
            formula: "s = (x + w) / 2, t = (w - y) / 2, r = z, q = w; OpenGL's t = (y + w) / 2, r = (z + w) / 2",
            sources: &[cited::SEGAL],
        },
    ),
    topic(
        "shadow_matrix",
        "a caster's point to its shadow on a plane",
        Lesson {
            text: "Flattens casters onto a receiver's plane along the light's rays (`pixel --coordinates` under `planar`, with a vertex \
                 carried through). Its w is the light's height over the plane less the point's: beyond the light it is negative, \
                 and dividing by it carries the point back through the light, the anti-shadow (`help clip`). It has no inverse: \
                 all of a ray goes to one point.",
            formula: "M = (P . L) I - L P^T, with the plane P = (n, d) and the light L = (x, y, z, 1), of a sun (x, y, z, 0)",
            sources: &[cited::BLINN],
        },
    ),
];
