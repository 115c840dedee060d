//! Techniques on scenes whose answers are known in closed form.

mod common;

use common::{cuboid, from_above, label_counts, request, session, square};
use stencilscope::technique::Technique;

const SHADOWING: [Technique; 4] = [Technique::Planar, Technique::ZPass, Technique::ZFail, Technique::ShadowMap];

/// The eye 10 above sees 20 × 20 units on 200 × 200 pixels. A square of half-width 1 at height 2,
/// halfway to the light, throws a square of half-width 2: 40 × 40 pixels, of which the square
/// itself, 8 from the eye, hides 25 × 25.
#[test]
fn a_square_halfway_to_the_light_throws_a_square_twice_its_size() {
    let mut session = session();
    let scene = from_above(vec![square("caster", 2.0, 1.0)]);
    for technique in SHADOWING {
        let capture = session.capture(&scene, &request(technique, [200, 200])).expect("a capture");
        let [lit, shadow, background, away] = label_counts(&capture);
        println!("{technique:?}: {lit} {shadow} {background} {away}");
        assert_eq!(shadow, 40 * 40 - 25 * 25, "{technique:?}");
    }
}
