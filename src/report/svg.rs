//! The plot as SVG: for papers, web pages and READMEs, and what the PNG is made from.

use super::plot::{
    LegendKey, MarkShape, Plot, PlotInk, PlotLine, PlotPoint, PlotRect, PlotText, SceneChart, TechniqueStyle,
    TextAnchor,
};
use crate::picture::svg::escaped;
use std::fmt::Write;

/// The CSS font list: faces that are installed on common systems; the first is the one that PNGs are drawn with.
const FONTS: &str = "Ubuntu, 'Segoe UI', 'Helvetica Neue', Helvetica, Arial, 'DejaVu Sans', sans-serif";
const PAPER: [u8; 3] = [0xff, 0xff, 0xff];
const TEXT: [u8; 3] = [0x1b, 0x1e, 0x25];
const DIM: [u8; 3] = [0x5d, 0x64, 0x73];
const GRID: [u8; 3] = [0xe2, 0xe4, 0xe9];
const BAND: [u8; 3] = [0xf1, 0xf3, 0xf6];
/// Width of the halo behind texts that cross a line, points.
const HALO: f64 = 3.0;

/// Returns the plot as an SVG file, in the paper colours of `plot::STYLES` on white.
pub fn svg(plot: &Plot) -> String {
    let [width, height] = plot.size.map(number);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
         height=\"{height}\" role=\"img\" aria-labelledby=\"title desc\" font-family=\"{FONTS}\">\n\
         <title id=\"title\">{}</title>\n<desc id=\"desc\">{}</desc>\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"{}\"/>\n",
        escaped(&plot.title),
        escaped(&plot.summary),
        hex(PAPER),
    );
    for chart in &plot.charts {
        out += &chart_group(chart);
    }
    out.extend(plot.lines.iter().map(line));
    out.extend(plot.keys.iter().map(key));
    out.extend(plot.texts.iter().map(|words| text(words, false)));
    out + "</svg>\n"
}

fn chart_group(chart: &SceneChart) -> String {
    let mut out = format!("<g>\n<title>{}</title>\n", escaped(&chart.title));
    out += &band(&chart.band);
    out.extend(chart.lines.iter().map(line));
    out.extend(chart.spots.iter().map(whisker));
    out.extend(chart.labels.iter().map(|words| text(words, true)));
    out.extend(chart.spots.iter().map(spot));
    out.extend(chart.texts.iter().map(|words| text(words, false)));
    out + "</g>\n"
}

fn band(rect: &PlotRect) -> String {
    let [x, y] = rect.min.map(number);
    let [width, height] = [rect.width(), rect.height()].map(number);
    format!("<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" fill=\"{}\"/>\n", hex(BAND))
}

fn line(line: &PlotLine) -> String {
    let opacity = if line.faint { " stroke-opacity=\"0.45\"" } else { "" };
    format!(
        "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"{opacity}/>\n",
        points(&line.points),
        color(line.ink),
        number(line.width),
    )
}

fn whisker(spot: &PlotPoint) -> String {
    let [left, right] = spot.whisker.map(number);
    let (y, color) = (number(spot.at[1]), hex(spot.style.paper));
    format!("<line x1=\"{left}\" y1=\"{y}\" x2=\"{right}\" y2=\"{y}\" stroke=\"{color}\"/>\n")
}

fn spot(spot: &PlotPoint) -> String {
    let mark = mark(spot.at, spot.style, spot.filled);
    format!("<g>\n<title>{}</title>\n{mark}</g>\n", escaped(&spot.details))
}

fn key(key: &LegendKey) -> String {
    mark(key.at, key.style, key.filled)
}

fn mark([x, y]: [f64; 2], style: &TechniqueStyle, filled: bool) -> String {
    let color = hex(style.paper);
    let fill = if filled { color.clone() } else { hex(PAPER) };
    let shape = match style.mark {
        MarkShape::Circle => {
            format!("<circle cx=\"{}\" cy=\"{}\" r=\"{}\"", number(x), number(y), number(super::plot::RADIUS))
        }
        shape => {
            let outline = shape.outline(super::plot::RADIUS).into_iter().map(|[dx, dy]| [x + dx, y + dy]);
            format!("<polygon points=\"{}\"", points(&outline.collect::<Vec<_>>()))
        }
    };
    format!("{shape} fill=\"{fill}\" stroke=\"{color}\" stroke-width=\"1.3\" stroke-linejoin=\"round\"/>\n")
}

/// Returns a text as an SVG element, centred vertically on its position; `halo` adds a white outline behind it that
/// separates it from lines.
fn text(words: &PlotText, halo: bool) -> String {
    let anchor = match words.anchor {
        TextAnchor::Start => "start",
        TextAnchor::Middle => "middle",
        TextAnchor::End => "end",
    };
    let ink = color(words.ink);
    // A thin outline in place of a bold face: it looks the same in every one.
    let (stroke, width) = match (halo, words.strong) {
        (true, _) => (hex(PAPER), HALO),
        (false, true) => (ink.clone(), 0.45),
        // The face of the PNG is a light one.
        (false, false) => (ink.clone(), 0.15),
    };
    let at = [words.at[0], words.at[1] + words.size * 0.35].map(number);
    let mut out = format!(
        "<text x=\"{}\" y=\"{}\" font-size=\"{}\" text-anchor=\"{anchor}\" fill=\"{ink}\" stroke=\"{stroke}\" \
         stroke-width=\"{width}\" stroke-linejoin=\"round\"",
        at[0],
        at[1],
        number(words.size),
    );
    if halo {
        out += " paint-order=\"stroke\"";
    }
    // Writing to a string can't fail.
    let _ = writeln!(out, ">{}</text>", escaped(&words.text));
    out
}

fn color(ink: PlotInk) -> String {
    hex(match ink {
        PlotInk::Text => TEXT,
        PlotInk::Dim | PlotInk::Front => DIM,
        PlotInk::Grid => GRID,
        PlotInk::Technique(style) => style.paper,
    })
}

fn hex([red, green, blue]: [u8; 3]) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// Returns a number with at most two digits after the point, without trailing zeros.
fn number(value: f64) -> String {
    let text = format!("{value:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn points(points: &[[f64; 2]]) -> String {
    let pairs: Vec<String> = points.iter().map(|[x, y]| format!("{},{}", number(*x), number(*y))).collect();
    pairs.join(" ")
}

#[cfg(test)]
mod tests {
    use super::super::tests::{adapter, row};
    use super::super::{Report, plot};
    use super::*;
    use resvg::usvg::roxmltree::Document;

    #[test]
    fn it_is_xml_whatever_scenes_are_called() {
        let scene = "a <b> & \"c\" \u{1} 'd'";
        let report = Report::new(adapter(), vec![row(scene, "z-fail", "<&>", 0, 6.25), row(scene, "none", "", 9, 2.0)]);
        let text = svg(&plot::layout(&report, &plot::PlotPage::PAPER));
        let document = Document::parse(&text).expect("XML");
        let titles: Vec<&str> =
            document.descendants().filter(|node| node.has_tag_name("title")).filter_map(|node| node.text()).collect();
        assert_eq!(titles[0], "Wrong pixels against frame time");
        assert_eq!(titles[1], "a <b> & \"c\" \u{fffd} 'd'");
        assert!(titles.iter().any(|title| title.starts_with("z-fail <&>: none wrong, 6.2 ms\n0 wrong of 1\u{a0}000")));
        assert!(document.descendants().any(|node| node.has_tag_name("desc")));
    }

    #[test]
    fn an_empty_report_is_a_picture_too() {
        let text = svg(&plot::layout(&Report::new(adapter(), Vec::new()), &plot::PlotPage::PAPER));
        assert!(Document::parse(&text).is_ok());
        assert!(text.contains("Nothing was measured."));
    }

    #[test]
    fn coordinates_are_short() {
        assert_eq!([1.0, 0.5, 12.3456, -0.001].map(number), ["1", "0.5", "12.35", "-0"]);
    }
}
