//! The panels' accessibility tree, as text for whoever drives the page: a canvas has no elements that could be found.

use egui::accesskit::{Affine, Node, NodeId, Point, Rect, Role, TreeUpdate};
use egui::{Context, FullOutput, Plugin};
use serde::Serialize;
use std::collections::HashMap;

/// Keeps the tree of the last frame, once it was asked for.
#[derive(Debug, Default)]
pub struct TreeKeeper {
    tree: Option<TreeUpdate>,
}

/// A widget: what it is, what it says, and where it is.
#[derive(Debug, Serialize)]
struct TreeWidget<'a> {
    role: String,
    label: Option<&'a str>,
    value: Option<&'a str>,
    /// Left, top, right and bottom, points of the page.
    bounds: Option<[f64; 4]>,
    is_disabled: bool,
    is_selected: Option<bool>,
}

impl Plugin for TreeKeeper {
    fn debug_name(&self) -> &'static str {
        "accessibility tree"
    }

    fn output_hook(&mut self, _: &Context, output: &mut FullOutput) {
        if let Some(tree) = output.platform_output.accesskit_update.take() {
            self.tree = Some(tree);
        }
    }
}

impl TreeKeeper {
    /// Returns the widgets of the last frame as JSON; an empty list where none was asked for before that frame.
    pub fn to_json(&self, pixels_per_point: f32) -> String {
        let nodes: HashMap<NodeId, &Node> =
            self.tree.iter().flat_map(|tree| &tree.nodes).map(|(id, node)| (*id, node)).collect();
        let mut widgets = Vec::new();
        if let Some(root) = self.tree.as_ref().and_then(|tree| tree.tree.as_ref()).map(|tree| tree.root) {
            collect(root, &nodes, Affine::scale(1.0 / f64::from(pixels_per_point)), &mut widgets);
        }
        // Nothing here can't be written as JSON.
        serde_json::to_string(&widgets).unwrap_or_default()
    }
}

/// Adds a node and all below it, in order; `at` is the transform of its parent.
fn collect<'a>(id: NodeId, nodes: &HashMap<NodeId, &'a Node>, at: Affine, widgets: &mut Vec<TreeWidget<'a>>) {
    let Some(node) = nodes.get(&id) else { return };
    let at = node.transform().map_or(at, |transform| at * *transform);
    if node.role() != Role::GenericContainer {
        let bounds = node.bounds().map(|Rect { x0, y0, x1, y1 }| {
            let [start, end] = [Point::new(x0, y0), Point::new(x1, y1)].map(|corner| at * corner);
            [start.x, start.y, end.x, end.y]
        });
        widgets.push(TreeWidget {
            role: format!("{:?}", node.role()),
            label: node.label(),
            value: node.value(),
            bounds,
            is_disabled: node.is_disabled(),
            is_selected: node.is_selected(),
        });
    }
    node.children().iter().for_each(|child| collect(*child, nodes, at, widgets));
}
