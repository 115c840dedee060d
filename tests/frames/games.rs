//! Games, whose frames are read as they are drawn, with nothing to hold their lights against.

use super::read_frame::ReadFrame;
use std::process::Command;
use stencilscope::diagnosis::Proof;
use stencilscope::diagnosis::frame_causes::FrameCauseFound;
use stencilscope::reading::format::count;
use stencilscope::recorded::LightEvidence;

/// A game, which says nowhere where its lights are.
pub struct Game {
    pub name: &'static str,
    /// The Debian package that has it.
    package: &'static str,
    what: &'static str,
    /// The program and its options; `{home}` is a folder for what it writes.
    pub command: &'static str,
    pub frame: u32,
    pub seconds: u64,
    most_wrong: u64,
}

pub const GAMES: [Game; 1] = [Game {
    name: "OpenArena",
    package: "openarena",
    what: "a light for each model, a draw for each edge, darkening",
    command: "/usr/lib/ioquake3/ioquake3 +set com_basegame baseoa +set fs_basepath /usr/lib/openarena \
              +set com_homepath .openarena +set fs_homepath {home} +set com_standalone 1 +set cl_renderer opengl1 \
              +set cg_shadows 2 +set videoflags 0 +set g_videoflags 0 +set r_stencilbits 8 +set r_ext_multisample 0 +set cg_thirdPerson 1 +set r_mode 3 \
              +set r_fullscreen 0 +set s_initsound 0 +devmap oa_dm1",
    frame: 120,
    seconds: 240,
    most_wrong: 40,
}];

/// Numbers of a game's frame, as a row of the page; adds to `wrong` what does not hold.
pub fn game_row(game: &Game, read: &ReadFrame, wrong: &mut Vec<String>) -> String {
    println!("{}", read.diagnosis.to_text());
    let mut holds = |what: &str, holds: bool| {
        if !holds {
            wrong.push(format!("{}: {what}", game.name));
        }
    };
    let draws: Vec<_> = read.frame.capture.steps.iter().flat_map(|step| &step.draws).collect();
    let differs = draws.iter().filter_map(|draw| draw.differs);
    let differs: Vec<u64> = differs.map(|differs| differs.depth.max(differs.stencil)).collect();
    // An edge of a volume a draw: RenderDoc is not asked about each of them.
    let of_runs = "of draws that follow each other with the same states, only what the last left is known";
    let limits = read.frame.capture.origin.as_ref().map_or(&[][..], |origin| &origin.limits);
    holds(&format!("{limits:?}"), limits.iter().any(|limit| limit == of_runs));
    holds(&format!("{} of {} draws are held against", differs.len(), draws.len()), differs.len() < draws.len());
    let (all, same) = (differs.len(), differs.iter().filter(|pixels| **pixels == 0).count());
    // A run of draws counts once, and is held against what its last left.
    let is_same = all > 0 && (all - same) * 100 <= draws.len();
    holds(&format!("{same} of {all} draws and runs of {} leave what was stored", draws.len()), is_same);
    let coverage = &read.diagnosis.coverage[0];
    holds(
        &format!("{} of {} pixels", coverage.compared, coverage.pixels),
        coverage.compared * 10 >= coverage.pixels * 9,
    );
    let wrong_pixels = read.diagnosis.lights.first().map(|light| light.error.wrong());
    // Where its player starts is chance, and with it how much is wrong: a changed plan makes each pixel right.
    let is_proven = |first: &&FrameCauseFound| (first.proof, first.pixels_left) == (Proof::Proven, 0);
    let proven = read.diagnosis.causes.first().filter(is_proven);
    let is_explained = wrong_pixels.is_some_and(|wrong| wrong == 0 || (wrong <= game.most_wrong && proven.is_some()));
    holds(&format!("{wrong_pixels:?} pixels wrong"), is_explained);
    let evidence = read.lights.first().copied().flatten().map(|found| found.evidence);
    let Some(LightEvidence::EdgesOfCasters { casters, unseen, .. }) = evidence else {
        holds(&format!("no light for each model, but {evidence:?}"), false);
        return String::new();
    };
    let version = Command::new("dpkg-query").args(["-W", "-f", "${Version}", game.package]).output();
    format!(
        "| {} | {} | {} | {} | {} | {same} of {all} | {} of {} | {} | {} | {} | {:.0} |\n",
        game.name,
        String::from_utf8(version.expect("dpkg-query").stdout).expect("a version"),
        game.what,
        read.api(),
        draws.len(),
        count(coverage.compared),
        count(coverage.pixels),
        wrong_pixels.map_or_else(String::new, count),
        proven.map_or_else(String::new, FrameCauseFound::names),
        casters + unseen,
        read.seconds,
    )
}
