//! The report as comma-separated values (RFC 4180), for spreadsheets and data frames.

use super::{Report, ReportRow};

const COLUMNS: &str = "scene,technique,label,settings,width,height,compared,false_shadow,missing_shadow,\
wrong_surface,edge_band,wrong_fraction,wrong_color,frame_ms_median,frame_ms_min,frame_ms_max,frame_runs,gpu_ms,setup_ms,\
triangles,bytes,pareto,adapter,sweep,sweep_value,visibility_error";

/// Returns a report as CSV: a heading line, then one line for each row in the report's order, each ended by CR LF as
/// RFC 4180 requires.
pub fn csv(report: &Report) -> String {
    let lines = report.rows.iter().map(|row| line(row, &report.adapter.name));
    std::iter::once(COLUMNS.to_owned()).chain(lines).map(|line| line + "\r\n").collect()
}

fn line(row: &ReportRow, adapter: &str) -> String {
    let settings: Vec<String> = row.settings.iter().map(|(key, value)| format!("{key}={value}")).collect();
    let fields = [
        field(&row.scene),
        field(&row.technique),
        field(&row.label),
        field(&settings.join(";")),
        row.size[0].to_string(),
        row.size[1].to_string(),
        row.error.compared.to_string(),
        row.error.false_shadow.to_string(),
        row.error.missing_shadow.to_string(),
        row.error.wrong_surface.to_string(),
        row.error.edge_band.to_string(),
        row.wrong_fraction.to_string(),
        row.wrong_color.map_or_else(String::new, |pixels| pixels.to_string()),
        row.frame_ms.median.to_string(),
        row.frame_ms.min.to_string(),
        row.frame_ms.max.to_string(),
        row.frame_ms.runs.to_string(),
        row.gpu_ms.map_or_else(String::new, |ms| ms.to_string()),
        row.setup_ms.to_string(),
        row.triangles.to_string(),
        row.bytes.to_string(),
        row.pareto.to_string(),
        field(adapter),
        field(row.sweep.as_ref().map_or("", |swept| &swept.name)),
        row.sweep.as_ref().map_or_else(String::new, |swept| swept.value.to_string()),
        row.visibility_error.map_or_else(String::new, |error| error.mean().to_string()),
    ];
    fields.join(",")
}

/// Returns a CSV field: `text`, in quotes where it needs them, with quotes in it doubled.
fn field(text: &str) -> String {
    if text.contains([',', '"', '\r', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{adapter, row};
    use super::*;
    use std::collections::BTreeMap;

    #[test]
    fn fields_are_quoted_where_they_need_it() {
        assert_eq!(field("tori"), "tori");
        assert_eq!(field("a, b"), "\"a, b\"");
        assert_eq!(field("say \"hi\""), "\"say \"\"hi\"\"\"");
        assert_eq!(field("two\nlines"), "\"two\nlines\"");
    }

    #[test]
    fn a_row_is_a_line() {
        let mut row = row("tori", "shadow-map", "1024, slope 0", 20, 3.5);
        row.settings =
            BTreeMap::from([("size".to_owned(), "1024".to_owned()), ("bias-slope".to_owned(), "0".to_owned())]);
        let text = csv(&Report::new(adapter(), vec![row]));
        let lines: Vec<&str> = text.split("\r\n").collect();
        assert_eq!(lines[0].split(',').count(), 26);
        assert_eq!(
            lines[1],
            "tori,shadow-map,\"1024, slope 0\",bias-slope=0;size=1024,100,10,1000,20,0,0,7,0.02,20,3.5,3.4,3.8,9,,12.5,5000,2097152,true,hand,,,"
        );
        assert_eq!(lines[2], "", "the last line ends too");
    }
}
