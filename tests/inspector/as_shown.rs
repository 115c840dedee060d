//! The shown picture with overlays and the compared half as a file, read back.

use super::by_hand::layered;
use super::*;
use stencilscope::ask::TestsOf;
use stencilscope::capture::StepTests;
use stencilscope::inspector::{DialogKind, Overlay, ThemeChoice};
use stencilscope::reading::TestOutcomes;

type Rgb = [u8; 3];
const PASSED: Rgb = [0x2f, 0xb5, 0x8a];
const LIT: Rgb = [0xf2, 0xd1, 0x6b];
/// Counts of 0 and 1.
const COUNTS: [Rgb; 2] = [[0x14, 0x17, 0x1d], [0x56, 0xb4, 0xe9]];

/// A PNG that was read.
struct Read {
    size: [u32; 2],
    bytes: Vec<u8>,
}

impl Read {
    fn at(&self, [x, y]: [u32; 2]) -> Rgb {
        let first = (y * self.size[0] + x) as usize * 3;
        [0, 1, 2].map(|channel| self.bytes[first + channel])
    }

    fn pixels(&self) -> impl Iterator<Item = Rgb> {
        self.bytes.chunks_exact(3).map(|pixel| [pixel[0], pixel[1], pixel[2]])
    }
}

/// What an export writes.
fn exported(harness: &mut Harness<Seen>, kind: ExportKind) -> Read {
    let picture = match harness.state_mut().inspector.export(kind) {
        Some(ExportData::Picture(picture)) => picture,
        Some(ExportData::AsShown(drawing)) => drawing.finish(),
        Some(ExportData::BothSides(both)) => both.finish().expect("captions"),
        other => panic!("a picture, not {other:?}"),
    };
    let file = picture.to_png().expect("a PNG");
    let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().expect("a header");
    let mut bytes = vec![0; reader.output_buffer_size().expect("a size")];
    let info = reader.next_frame(&mut bytes).expect("a picture");
    Read { size: [info.width, info.height], bytes }
}

fn is_near(a: Rgb, b: Rgb, by: u8) -> bool {
    a.iter().zip(b).all(|(a, b)| a.abs_diff(b) <= by)
}

fn at_volumes() -> Harness<'static, Seen> {
    let mut inspector = inspector(z_fail(SIZE));
    inspector.model.select_step(1);
    inspector.model.choose_picture(PictureKind::Stencil);
    harness_of(inspector)
}

#[test]
fn without_anything_over_it_it_is_the_plain_picture() {
    let mut harness = at_volumes();
    let [plain, shown] = [ExportKind::Picture, ExportKind::AsShown].map(|kind| exported(&mut harness, kind));
    assert_eq!((plain.size, &plain.bytes), (SIZE, &shown.bytes));
    assert_eq!([shown.at([30, 4]), shown.at([3, 4])], COUNTS);
}

/// A large picture has its legend, unless that is not wished.
#[test]
fn the_legend_is_in_it_where_it_fits_and_is_wished() {
    let mut inspector = inspector(z_fail([640, 480]));
    inspector.model.select_step(1);
    inspector.model.choose_picture(PictureKind::Stencil);
    let mut harness = harness_of(inspector);
    let plain = exported(&mut harness, ExportKind::Picture);
    let differing = |harness: &mut Harness<Seen>| {
        let shown = exported(harness, ExportKind::AsShown);
        let places = plain.pixels().zip(shown.pixels()).enumerate().filter(|(_, (a, b))| a != b);
        places.map(|(place, _)| [place as u32 % 640, place as u32 / 640]).collect::<Vec<_>>()
    };
    let legend = differing(&mut harness);
    assert!(legend.len() > 3_000 && legend.iter().all(|[x, y]| *x > 440 && *y < 320), "{}", legend.len());
    change(&mut harness, |inspector| inspector.model.dialog = Some(DialogKind::Export(ExportKind::AsShown)));
    click(&mut harness, "With the legend");
    press(&mut harness, Key::Escape);
    assert_eq!(differing(&mut harness).len(), 0);
}

#[test]
fn the_compared_half_is_in_it_up_to_the_texel_under_the_divider() {
    let mut harness = at_volumes();
    click_button(&mut harness, "Compare");
    // The step before has counted nothing yet; it is on the left.
    let shown = exported(&mut harness, ExportKind::AsShown);
    assert_eq!((shown.size, shown.at([3, 4])), (SIZE, COUNTS[0]));
    press(&mut harness, Key::X);
    let flipped = exported(&mut harness, ExportKind::AsShown);
    assert_eq!([flipped.at([3, 4]), flipped.at([36, 4])], [COUNTS[1], COUNTS[0]]);
    assert!(is_near(flipped.at([19, 10]), [255; 3], 120), "a light line between: {:?}", flipped.at([19, 10]));
    // Zoomed to the left quarter, the divider stands over column 10.
    change(&mut harness, |inspector| inspector.set_zoom(TexelZoom::Pixels(40.0), [10.0, 15.0]));
    let zoomed = exported(&mut harness, ExportKind::AsShown);
    assert_eq!(zoomed.size, SIZE, "the whole picture all the same");
    assert_eq!([zoomed.at([3, 4]), zoomed.at([15, 4])], [COUNTS[1], COUNTS[0]]);
    let plain = exported(&mut harness, ExportKind::Picture);
    let second = SIZE[0] + 8;
    let [own, other] = [0, second].map(|left| [plain.at([left + 3, 4]), plain.at([left + 15, 4])]);
    assert_eq!([own, other], [[COUNTS[1]; 2], [COUNTS[0]; 2]], "the plain one has both, whole");
}

#[test]
fn tints_of_overlays_are_in_it() {
    let mut harness = at_volumes();
    change(&mut harness, |inspector| inspector.model.modes.overlays.extend([Overlay::Tests]));
    let image = |value| Arc::new(Image::uniform(PixelFormat::U8, SIZE, &[value]));
    let tests = StepTests { step: 1, draw: None, fragments: image(1), depth_passes: image(1), stencil: image(0) };
    change(&mut harness, |inspector| {
        inspector.take_in(TestsOf { step: 1, draw: None }, Ok(Arc::new(TestOutcomes::new(tests))))
    });
    let shown = exported(&mut harness, ExportKind::AsShown);
    for (x, count) in [(3, COUNTS[1]), (30, COUNTS[0])] {
        let mixed: Rgb = [0, 1, 2]
            .map(|channel| (0.62 * f32::from(PASSED[channel]) + 0.38 * f32::from(count[channel])).round() as u8);
        assert!(is_near(shown.at([x, 4]), mixed, 2), "{:?} is not {mixed:?}", shown.at([x, 4]));
    }
}

/// Overlays lie over one picture; of all layers of a map side by side there is nothing to export so.
#[test]
fn all_layers_of_a_map_have_none() {
    let mut harness = harness(layered("projective", "silhouette"));
    click_button(&mut harness, "Silhouettes");
    let exported = |harness: &mut Harness<Seen>, kind| harness.state_mut().inspector.export(kind);
    assert!(exported(&mut harness, ExportKind::AsShown).is_none());
    assert!(exported(&mut harness, ExportKind::Picture).is_some());
    click_button(&mut harness, "Export");
    let entry = harness.get_by_role_and_label(Role::Button, "Picture with overlays (PNG)…");
    assert!(entry.accesskit_node().is_disabled());
    press(&mut harness, Key::Escape);
    click_button(&mut harness, "Layer 3");
    assert!(exported(&mut harness, ExportKind::AsShown).is_some());
}

#[test]
fn it_is_chosen_in_the_menu_of_exports() {
    let mut harness = harness(z_fail(SIZE));
    click_button(&mut harness, "Export");
    click_button(&mut harness, "Picture with overlays (PNG)…");
    click_button(&mut harness, "Save");
    let Some(Action::Export { kind, path, replace }) = harness.state().actions.last() else { panic!("an export") };
    assert_eq!((*kind, *replace), (ExportKind::AsShown, false));
    assert!(path.ends_with("-as-shown.png"), "{path}");
}

/// Volumes of a slab on a floor, whose edges are long in the picture.
#[test]
fn edges_that_count_twice_have_their_number() {
    let mut session = common::session();
    let mut letters = |casters: &str| {
        let request = common::request_with(Technique::ZFail, &[("casters", casters)], [640, 360]);
        let frame = common::frame(&mut session, "table", request);
        let anatomy = pictures::anatomy(&mut session, &frame);
        let many = anatomy.silhouettes.iter().flat_map(|silhouette| &silhouette.edges);
        let many = many.filter(|edge| edge.multiplicity.unsigned_abs() > 1).count();
        let mut harness = harness_of(pictures::inspector(&frame, [10, 10]));
        change(&mut harness, |inspector| inspector.model.modes.overlays.extend([Overlay::Silhouettes]));
        change(&mut harness, |inspector| inspector.take_in(AnatomyOf {}, Ok(anatomy)));
        let [plain, shown] = [ExportKind::Picture, ExportKind::AsShown].map(|kind| exported(&mut harness, kind));
        if let Some(folder) = std::env::var_os("INSPECTOR_PICTURES") {
            let window = window_picture(&mut harness);
            save(&window, &Path::new(&folder).join(format!("numbers-{casters}.png")));
        }
        let is_letter = |pixel: Rgb| is_near(pixel, [0xd9, 0xdc, 0xe3], 24);
        let new = plain.pixels().zip(shown.pixels()).filter(|(before, now)| !is_letter(*before) && is_letter(*now));
        (many, new.count())
    };
    let (many, written) = letters("all");
    assert!(many > 0 && written > 10, "{many} edges, {written} pixels of letters");
    let (many, written) = letters("by-topology");
    assert!(many == 0 && written == 0, "{many} edges, {written} pixels of letters");
}

fn save(picture: &Picture, file: &Path) {
    std::fs::write(file, picture.to_png().expect("a PNG")).expect("written");
}

/// Over a real frame. `INSPECTOR_PICTURES=FOLDER cargo test --profile bench lines_numbers_and_names` keeps the file.
#[test]
fn lines_numbers_and_names_are_in_it_as_in_the_window() {
    let mut session = common::session();
    let size = [640, 360];
    // Every triangle casts, so edges of silhouettes count twice.
    let request = common::request_with(Technique::ZFail, &[("casters", "all")], size);
    let frame = common::frame(&mut session, "tori", request);
    let anatomy = pictures::anatomy(&mut session, &frame);
    let mut harness = harness_of(pictures::inspector(&frame, [10, 10]));
    for overlay in [Overlay::Silhouettes, Overlay::Names, Overlay::Receivers, Overlay::Volumes] {
        harness.state_mut().inspector.model.modes.overlays.insert(overlay);
    }
    harness.run_steps(2);
    change(&mut harness, |inspector| inspector.take_in(AnatomyOf {}, Ok(anatomy)));
    let [plain, shown] = [ExportKind::Picture, ExportKind::AsShown].map(|kind| exported(&mut harness, kind));
    assert_eq!((plain.size, shown.size), (size, size));
    let differing = plain.pixels().zip(shown.pixels()).filter(|(a, b)| a != b).count();
    assert!(differing > 20_000, "receivers are tinted: {differing} pixels");
    let lit = shown.pixels().filter(|pixel| is_near(*pixel, LIT, 40)).count();
    assert!(lit > 300, "silhouettes are drawn: {lit} pixels");
    // A name's plate is the panel's colour, its letters the text's.
    let plates = shown.pixels().filter(|pixel| is_near(*pixel, [0x1b, 0x1e, 0x25], 24)).count();
    let letters = shown.pixels().filter(|pixel| is_near(*pixel, [0xd9, 0xdc, 0xe3], 16)).count();
    assert!(plates > 400 && letters > 30, "names are written: {plates}, {letters}");
    let window = window_picture(&mut harness);
    change(&mut harness, |inspector| inspector.model.theme = ThemeChoice::Light);
    let light = exported(&mut harness, ExportKind::AsShown);
    assert_ne!(light.bytes, shown.bytes, "in the window's theme");
    if let Some(folder) = std::env::var_os("INSPECTOR_PICTURES") {
        let folder = Path::new(&folder);
        save(&window, &folder.join("as-shown-window.png"));
        change(&mut harness, |inspector| inspector.model.theme = ThemeChoice::Dark);
        let start = std::time::Instant::now();
        let Some(ExportData::AsShown(drawing)) = harness.state_mut().inspector.export(ExportKind::AsShown) else {
            panic!("a drawing")
        };
        let in_window = start.elapsed();
        let picture = drawing.finish();
        println!(
            "{:.0} ms in the window, then {:.0} ms",
            in_window.as_secs_f64() * 1e3,
            (start.elapsed() - in_window).as_secs_f64() * 1e3
        );
        std::fs::write(folder.join("as-shown-tori.png"), picture.to_png().expect("a PNG")).expect("written");
    }
}
