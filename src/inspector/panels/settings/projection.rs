//! The camera's projection: its kind and its numbers. Numbers that it does not have are listed too, with the reason.

use super::row::row;
use crate::inspector::look::number_field::number_field;
use crate::scene::{Camera, Projection};
use egui::Ui;

/// Draws the camera's rows for the projection, its field of view, and the numbers that the projection has, each with a
/// reset to `before`; returns true when one changed. `aspect` is the width of what is drawn into over its height.
pub fn rows(ui: &mut Ui, camera: &mut Camera, before: &Camera, aspect: f64) -> bool {
    let half_height = camera.half_height_at_target();
    let frustum = camera.to_frustum(aspect);
    let mut changed =
        row(ui, "camera projection", "projection", &mut camera.projection, &before.projection, |ui, projection| {
            kind(ui, projection, half_height, frustum)
        });
    changed |= field_of_view(ui, camera, before);
    let (half_before, oblique_before) = numbers(before.projection);
    let near = camera.near;
    if let Projection::Frustum { left, right, bottom, top } = &mut camera.projection {
        let before = before.projection.edges().unwrap_or([*left, *right, *bottom, *top]);
        let (mut across, mut up) = ([*left, *right], [*bottom, *top]);
        changed |= row(ui, "frustum across", "left, right", &mut across, &[before[0], before[1]], |ui, ends| {
            edges(ui, ["Frustum left", "Frustum right"], ends, near)
        });
        changed |= row(ui, "frustum up", "bottom, top", &mut up, &[before[2], before[3]], |ui, ends| {
            edges(ui, ["Frustum bottom", "Frustum top"], ends, near)
        });
        ([*left, *right], [*bottom, *top]) = (across, up);
    }
    if let Projection::Orthographic { half_height } | Projection::Oblique { half_height, .. } = &mut camera.projection {
        let before = half_before.unwrap_or(*half_height);
        changed |= row(ui, "half height", "half height", half_height, &before, |ui, half_height| {
            let widget =
                number_field(half_height, 1e-30..=1e30, |widget| widget.speed(0.01).max_decimals(4).suffix(" m"));
            let shown = ui.add(widget).accessible_name("Half height");
            shown.on_hover_text("From the picture's middle to its upper edge").changed()
        });
    }
    if let Projection::Oblique { angle_degrees, factor, .. } = &mut camera.projection {
        let before = oblique_before.unwrap_or([*angle_degrees, *factor]);
        changed |= row(ui, "oblique angle", "angle", angle_degrees, &before[0], |ui, angle| {
            let widget = number_field(angle, -360.0..=360.0, |widget| widget.speed(0.2).suffix("°"));
            let shown = ui.add(widget).accessible_name("Oblique angle");
            shown.on_hover_text("Of the line along which things recede, from the right and counter-clockwise").changed()
        });
        changed |= row(ui, "oblique factor", "depth factor", factor, &before[1], |ui, factor| {
            let widget = number_field(factor, 0.0..=100.0, |widget| widget.speed(0.01).max_decimals(3));
            let shown = ui.add(widget).accessible_name("Oblique depth factor");
            shown.on_hover_text("Of a metre of depth in the picture: 1 is cavalier, 0.5 cabinet").changed()
        });
    }
    changed
}

/// Returns a projection's half height in metres, and its angle in degrees with the depth factor; `None` where it has no
/// such number.
fn numbers(projection: Projection) -> (Option<f64>, Option<[f64; 2]>) {
    match projection {
        Projection::Perspective | Projection::Frustum { .. } => (None, None),
        Projection::Orthographic { half_height } => (Some(half_height), None),
        Projection::Oblique { half_height, angle_degrees, factor } => {
            (Some(half_height), Some([angle_degrees, factor]))
        }
    }
}

/// Draws the part of a picture of `size` pixels that the camera draws into, where it begins and how large it is across and
/// down, each with a reset to `before`; returns true when one changed. All of the picture is no viewport.
pub fn viewport_rows(ui: &mut Ui, camera: &mut Camera, before: &Camera, size: [u32; 2]) -> bool {
    let [left, top, width, height] = camera.viewport.unwrap_or(Camera::WHOLE_PICTURE);
    let before = before.viewport.unwrap_or(Camera::WHOLE_PICTURE);
    let (mut across, mut down) = ([left, width], [top, height]);
    let rows = [
        (
            "viewport across",
            "viewport x, w",
            &mut across,
            [before[0], before[2]],
            ["Viewport left", "Viewport width"],
            0,
        ),
        ("viewport down", "viewport y, h", &mut down, [before[1], before[3]], ["Viewport top", "Viewport height"], 1),
    ];
    let mut changed = false;
    for (name, label, values, before, names, axis) in rows {
        changed |= row(ui, name, label, values, &before, |ui, values| span(ui, names, values, size[axis]));
    }
    if changed {
        let part = [across[0], down[0], across[1], down[1]];
        camera.viewport = Some(part).filter(|part| *part != Camera::WHOLE_PICTURE);
    }
    changed
}

/// Draws where a span of `pixels` begins and how long it is, as shares of them, which stays within them and a pixel long;
/// returns true when it changed. A number that would not is refused, and the field says why.
fn span(ui: &mut Ui, names: [&str; 2], [start, length]: &mut [f64; 2], pixels: u32) -> bool {
    let least = 1.0 / f64::from(pixels.max(1));
    let ranges = [0.0..=(1.0 - *length).max(0.0), least..=(1.0 - *start).max(least)];
    let limits = [
        "the viewport ends within the picture: make it smaller first (the number beside)",
        "the viewport ends within the picture: let it begin earlier first (the number beside)",
    ];
    let mut changed = false;
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        let shares = [start, length].into_iter().zip(limits);
        for ((name, range), (share, limit)) in names.into_iter().zip(ranges).zip(shares) {
            let hover = format!(
                "The part of the picture that is drawn into, as a share of its {pixels} pixels: here {}",
                (*share * f64::from(pixels)).round()
            );
            let widget = number_field(share, range, |widget| widget.speed(0.005).max_decimals(4));
            let field = ui.add(widget.because(limit));
            changed |= field.accessible_name(name).on_hover_text(hover).changed();
        }
    });
    changed
}

/// Draws two opposite edges of a frustum, the lesser first, which stay apart; returns true when one changed.
fn edges(ui: &mut Ui, names: [&str; 2], ends: &mut [f64; 2], near: f64) -> bool {
    let least = 1e-6 * near;
    let ranges = [-1e30..=ends[1] - least, ends[0] + least..=1e30];
    let mut changed = false;
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        for ((name, range), end) in names.into_iter().zip(ranges).zip(ends) {
            let widget = number_field(end, range, |widget| widget.speed(0.01 * near).max_decimals(5).suffix(" m"));
            let shown = ui.add(widget).accessible_name(name);
            let hover =
                "Where this edge of the picture meets the near plane, from the view's axis: to the right, or up";
            changed |= shown.on_hover_text(hover).changed();
        }
    });
    changed
}

/// Draws the choice between perspective, frustum, orthographic and oblique; returns true when it changed. A new frustum is
/// this one, which shows the same, a new parallel projection has `half_height`, so that the target stays at its size, and
/// an oblique one the cabinet's angle and factor.
fn kind(ui: &mut Ui, projection: &mut Projection, half_height: f64, frustum: Projection) -> bool {
    let before = projection.name();
    let (angle_degrees, factor) = (Projection::USUAL_ANGLE, Projection::CABINET);
    let oblique = Projection::Oblique { half_height, angle_degrees, factor };
    let kinds = [Projection::Perspective, frustum, Projection::Orthographic { half_height }, oblique];
    let combo = egui::ComboBox::from_id_salt("camera projection").selected_text(before).show_ui(ui, |ui| {
        for of in kinds {
            if ui.selectable_label(of.name() == before, of.name()).clicked() && of.name() != before {
                *projection = of;
            }
        }
    });
    combo.response.accessible_name("Projection");
    projection.name() != before
}

fn field_of_view(ui: &mut Ui, camera: &mut Camera, before: &Camera) -> bool {
    let is_given = camera.projection.is_usual();
    let why = match camera.projection.is_pinhole() {
        true => "No effect: the frustum's edges say how much the picture shows",
        false => "No effect: lines of sight are parallel, and the half height says how much they show",
    };
    row(ui, "field of view", "field of view", &mut camera.fov_y_degrees, &before.fov_y_degrees, |ui, fov| {
        let widget = number_field(fov, 1.0..=179.0, |widget| widget.speed(0.2).suffix("°"));
        let shown = ui.add_enabled(is_given, widget).accessible_name("Field of view");
        shown.on_disabled_hover_text(why).changed()
    })
}
