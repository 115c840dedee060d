//! `stencilscope pictures`: the README's pictures of the window, its animated tour and the scenes' thumbnails, made without
//! a display.

use super::CliError;
use super::options::picture_size;
use clap::Args;

#[derive(Debug, Args)]
pub struct PicturesArguments {
    /// Where they go: PNG files named after what they show
    #[arg(short = 'o', long = "output", value_name = "DIR", default_value = "assets/pictures")]
    output: String,
    /// Part of the name of the GPU to use
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Only pictures whose name has this word; `tour` is the animated one, `thumbnails` those of the scenes
    #[arg(long, value_name = "WORD", default_value = "")]
    only: String,
    /// The window, points
    #[arg(long, value_name = "WxH", default_value = "1440x900", value_parser = picture_size)]
    window: [u32; 2],
    /// Pixels a point
    #[arg(long, value_name = "N", default_value_t = 1.0, value_parser = parse_scale)]
    scale: f32,
}

fn parse_scale(text: &str) -> Result<f32, String> {
    let scale = text.parse().ok().filter(|scale| (0.5..=4.0).contains(scale));
    scale.ok_or_else(|| format!("`{text}` is no number from 0.5 to 4"))
}

/// Returns an error, always: a build without a window can't take pictures of it.
#[cfg(not(feature = "inspector"))]
pub fn run(arguments: &PicturesArguments) -> Result<(), CliError> {
    let PicturesArguments { output, adapter, only, window, scale } = arguments;
    let _ = (output, adapter, only, window, scale);
    Err(CliError::Window("this build has no window to take pictures of".to_owned()))
}

/// Runs the command `pictures`: draws the inspector's pictures, the animated tour and the scenes' thumbnails, whose names
/// contain the word of `--only` (empty: all), and writes them as PNG files.
#[cfg(feature = "inspector")]
pub fn run(arguments: &PicturesArguments) -> Result<(), CliError> {
    let window = arguments.window.map(|side| side as f32);
    shots::run(&arguments.output, arguments.adapter.as_deref(), &arguments.only, window, arguments.scale)
}

#[cfg(feature = "inspector")]
mod shots {
    use crate::app::headless::Headless;
    use crate::app::{ViewRequest, ViewSource};
    use crate::ask::{FaultsOf, ReportOf, StressOf};
    use crate::cli::options::open_session;
    use crate::cli::{CliError, output};
    use crate::import::ShippedFrame;
    use crate::inspector::{Inspector, Overlay, PanelKind, THUMBNAIL, ThemeChoice};
    use crate::picture::Picture;
    use crate::picture::apng::{AnimatedPng, AnimationError, AnimationFormat, ColorDepth};
    use crate::reading::picture_view::PictureKind;
    use crate::scene::{OpenSpec, builtin, open};
    use crate::session::{CaptureRequest, SnapshotInterval};
    use crate::technique::{Choice, Technique};
    use egui::{Key, Modifiers};
    use std::path::Path;

    /// Size of the picture in the window, pixels.
    const SIZE: [u32; 2] = [640, 480];
    /// Name of the animated tour.
    const TOUR: &str = "tour";
    /// Name of the picture that has a thumbnail of each built-in scene.
    const THUMBNAILS: &str = "thumbnails";
    /// How long a stop of the animated tour is shown, milliseconds.
    const STOP_MS: u16 = 3500;
    /// The animated tour's window, points.
    const TOUR_WINDOW: [f32; 2] = [1120.0, 700.0];
    /// In `tori`: a pixel in two shadows, so that its history and ladder show several events.
    const IN_TWO_SHADOWS: [u32; 2] = [322, 92];
    /// In `table`: a pixel on the slab, in the torus's shadow.
    const UNDER_THE_TORUS: [u32; 2] = [398, 268];
    /// In `inside`: the eye is in a shadow, so z-pass misses another one here.
    const MISSING: [u32; 2] = [330, 300];

    /// In `blender`: on the floor, in a shadow.
    const IN_BLENDERS_SHADOW: [u32; 2] = [94, 243];
    /// In `pygfx-acne`: on the floor, which shadows itself in stripes.
    const IN_STRIPES: [u32; 2] = [80, 150];

    /// Stress cases, in each of which some technique breaks; the first is the one whose rows are shown.
    const STRESSED: [&str; 3] = ["near-far", "world-offset", "nested"];

    /// One of the pictures that the command draws: its name, and what the window shows in it.
    struct PictureSubject {
        name: &'static str,
        scene: &'static str,
        technique: Technique,
        /// Part of the step's name; the last step where it is empty.
        step: &'static str,
        kind: PictureKind,
        pick: Option<[u32; 2]>,
        panels: &'static [PanelKind],
        theme: ThemeChoice,
        /// Keys that are pressed once all is shown.
        keys: &'static [Key],
        /// An overlay of the picture.
        overlay: Option<Overlay>,
        /// The technique that is compared with, under the divider.
        compared: Option<Technique>,
        /// Asks the questions whose answers are waited for.
        asks: Option<fn(&mut Inspector)>,
    }

    fn shot(
        name: &'static str,
        scene: &'static str,
        technique: Technique,
        panels: &'static [PanelKind],
    ) -> PictureSubject {
        PictureSubject {
            name,
            scene,
            technique,
            step: "",
            kind: PictureKind::Color,
            pick: Some(match scene {
                "table" => UNDER_THE_TORUS,
                "inside" => MISSING,
                "blender" => IN_BLENDERS_SHADOW,
                "pygfx-acne" => IN_STRIPES,
                _ => IN_TWO_SHADOWS,
            }),
            panels,
            theme: ThemeChoice::Dark,
            keys: &[],
            overlay: None,
            compared: None,
            asks: None,
        }
    }

    fn shots() -> Vec<PictureSubject> {
        use PanelKind::{
            Diagnosis, Explain, Picture, Pixel, Report, Scene, Settings, ShadowMap as MapTab, State, Stress,
        };
        use PictureKind::{Error, Stencil};
        use Technique::{Auto, ShadowMap, ZFail, ZPass};
        let volumes = |shot: PictureSubject| PictureSubject { step: "volumes", kind: Stencil, ..shot };
        vec![
            volumes(shot("blender", "blender", ZPass, &[Picture, Pixel])),
            volumes(shot("inspector", "tori", ZFail, &[Picture, Pixel])),
            volumes(shot("state", "tori", ZFail, &[Picture, State])),
            volumes(shot("explain", "tori", Auto, &[Picture, Explain])),
            shot("settings", "tori", ShadowMap, &[Picture, Settings, Pixel]),
            shot("scene", "tori", ZFail, &[Scene, Pixel]),
            shot("shadow-map", "table", ShadowMap, &[MapTab, Pixel]),
            PictureSubject { kind: Error, ..shot("error", "inside", ZPass, &[Picture, Pixel]) },
            PictureSubject { keys: &[Key::D], ..volumes(shot("diff", "tori", ZFail, &[Picture, Pixel])) },
            PictureSubject {
                step: "volumes",
                overlay: Some(Overlay::Tests),
                ..shot("overlay", "tori", ZFail, &[Picture, Pixel])
            },
            PictureSubject { compared: Some(ShadowMap), ..shot("compare", "table", ZFail, &[Picture, Pixel]) },
            PictureSubject {
                kind: Error,
                asks: Some(|panels| panels.model.start_diagnosis()),
                ..shot("diagnosis", "inside", ZPass, &[Picture, Pixel, Diagnosis])
            },
            PictureSubject {
                asks: Some(|panels| panels.model.answers.start(FaultsOf {})),
                ..shot("engine", "pygfx-acne", ShadowMap, &[Picture, MapTab, Pixel, Diagnosis])
            },
            PictureSubject {
                asks: Some(|panels| ReportOf::grid().into_iter().for_each(|report| panels.model.answers.start(report))),
                ..shot("report-tab", "table", ShadowMap, &[Picture, Pixel, Report])
            },
            PictureSubject {
                asks: Some(|panels| panels.model.answers.start(StressOf { cases: STRESSED.to_vec() })),
                ..shot("stress-tab", "tori", ZFail, &[Picture, Pixel, Stress])
            },
            PictureSubject {
                theme: ThemeChoice::Light,
                ..volumes(shot("light-theme", "tori", ZFail, &[Picture, Pixel]))
            },
        ]
    }

    /// Writes a PNG of each picture whose name contains `only` (the animated tour and the thumbnails too) to `folder`,
    /// which is created. `window` is in points, `scale` in pixels a point; the tour has a size of its own. Fails where
    /// no name matches.
    pub fn run(folder: &str, adapter: Option<&str>, only: &str, window: [f32; 2], scale: f32) -> Result<(), CliError> {
        let wanted: Vec<PictureSubject> = shots().into_iter().filter(|shot| shot.name.contains(only)).collect();
        let [wants_tour, wants_thumbnails] = [TOUR, THUMBNAILS].map(|name| name.contains(only));
        if wanted.is_empty() && !wants_tour && !wants_thumbnails {
            return Err(CliError::Usage(nothing_named(only)));
        }
        let folder = Path::new(folder);
        std::fs::create_dir_all(folder)
            .map_err(|source| CliError::Output { path: folder.display().to_string(), source })?;
        for shot in &wanted {
            let picture = take(shot, adapter, window, scale)?;
            write(folder, &format!("{}.png", shot.name), &picture.to_png().map_err(encoding)?)?;
        }
        if wants_tour {
            write(folder, &format!("{TOUR}.png"), &tour(adapter)?)?;
        }
        if wants_thumbnails {
            write(folder, &format!("{THUMBNAILS}.png"), &thumbnails(adapter)?.to_png().map_err(encoding)?)?;
        }
        Ok(())
    }

    /// Returns the error message where no picture's name contains `only`: it lists all names.
    fn nothing_named(only: &str) -> String {
        let names: Vec<&str> = shots().iter().map(|shot| shot.name).chain([TOUR, THUMBNAILS]).collect();
        format!("no picture's name has `{only}`: give `--only` a part of one of {}", names.join(", "))
    }

    fn write(folder: &Path, name: &str, bytes: &[u8]) -> Result<(), CliError> {
        let file = folder.join(name).display().to_string();
        output::write(&file, bytes)?;
        output::note(&format!("wrote {file}"));
        Ok(())
    }

    fn encoding(error: impl Into<AnimationError>) -> CliError {
        let error = error.into();
        CliError::Window(format!("a picture can't be encoded ({error})"))
    }

    fn opened(
        scene: &str,
        technique: Technique,
        adapter: Option<&str>,
        window: [f32; 2],
        scale: f32,
    ) -> Result<Headless, CliError> {
        let spec = OpenSpec::new(scene);
        let source = match ShippedFrame::named(scene) {
            Some(shipped) => ViewSource::Folder(Box::new(shipped.open()?)),
            None => ViewSource::Scene(Box::new(open(&spec)?)),
        };
        let request = ViewRequest {
            source,
            name: spec,
            capture: CaptureRequest {
                every: SnapshotInterval::Pass,
                ..CaptureRequest::new(Choice::new(technique), SIZE)
            },
            time: 0.0,
            adapter: adapter.map(str::to_owned),
            step: None,
            pick: None,
            truth: false,
        };
        let mut panels = Headless::new(request, window, scale)?;
        panels.settle()?;
        Ok(panels)
    }

    fn take(shot: &PictureSubject, adapter: Option<&str>, window: [f32; 2], scale: f32) -> Result<Picture, CliError> {
        let mut panels = opened(shot.scene, shot.technique, adapter, window, scale)?;
        let inspector = panels.inspector();
        inspector.model.theme = shot.theme;
        let steps = inspector.model.frame.capture.as_ref().map_or_else(Vec::new, |capture| capture.steps.clone());
        if let Some(step) = steps.iter().position(|step| !shot.step.is_empty() && step.name.contains(shot.step)) {
            inspector.model.select_step(step);
        }
        inspector.model.choose_picture(shot.kind);
        if let Some(pick) = shot.pick {
            inspector.model.selection.pick = Some(pick);
        }
        shot.panels.iter().for_each(|panel| inspector.model.requests.panels.push(*panel));
        if let Some(overlay) = shot.overlay {
            inspector.model.modes.overlays.insert(overlay);
        }
        if let Some(technique) = shot.compared {
            inspector.compare_with(technique);
        }
        panels.settle()?;
        for key in shot.keys {
            panels.key(Modifiers::NONE, *key);
        }
        if let Some(asks) = shot.asks {
            asks(panels.inspector());
        }
        panels.settle()?;
        Ok(panels.picture()?)
    }

    /// Returns the built-in scenes as `auto` draws them, small, one below the other.
    fn thumbnails(adapter: Option<&str>) -> Result<Picture, CliError> {
        let mut session = open_session(adapter)?;
        let [width, height] = THUMBNAIL;
        let mut all = Picture::filled([width, height * builtin::ALL.len() as u32], [0; 3]);
        for (of, top) in builtin::ALL.iter().zip((0..).step_by(height as usize)) {
            let capture = session.capture(&of.scene()?, &CaptureRequest::new(Choice::new(Technique::Auto), SIZE))?;
            let last = capture.frame_at(capture.steps.len().saturating_sub(1));
            let color = |at: [u32; 2]| {
                let [red, green, blue, _] = last.and_then(|frame| frame.color.image.rgba_at(at)).unwrap_or_default();
                [red, green, blue]
            };
            all.paste(&Picture::drawn(SIZE, color).fitted(THUMBNAIL), [0, top]);
        }
        Ok(all)
    }

    /// Returns the tour of z-fail as an animated PNG, one picture for each stop.
    fn tour(adapter: Option<&str>) -> Result<Vec<u8>, CliError> {
        let mut panels = opened("tori", Technique::ZFail, adapter, TOUR_WINDOW, 1.0)?;
        let stops = Inspector::stops_of(Technique::ZFail);
        let size = TOUR_WINDOW.map(|side| side as u32);
        let format = AnimationFormat { size, pictures: stops as u32, milliseconds: STOP_MS, colors: ColorDepth::Exact };
        let mut file = Vec::new();
        let mut film = AnimatedPng::new(&mut file, format).map_err(encoding)?;
        for stop in 0..stops {
            let actions = panels.inspector().go_to_stop(Technique::ZFail, stop);
            panels.act(actions);
            panels.settle()?;
            film.add(&panels.picture()?).map_err(encoding)?;
        }
        film.finish().map_err(encoding)?;
        Ok(file)
    }
}
