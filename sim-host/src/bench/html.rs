//! The benchmark as a page: one file that asks for no other.

use super::table::classes;
use super::{HEADER, Row, better, cells, label, verdict};
use std::fmt::Write as _;

/// What pages look like.
const STYLE: &str = "\
body{font:15px/1.45 sans-serif;margin:2em auto;max-width:1720px;padding:0 1em;color:#222}\
table{border-collapse:collapse;margin:1em 0;font-size:13px}\
th,td{border-bottom:1px solid #ddd;padding:.25em .7em;text-align:right;white-space:nowrap}\
th:first-child,td:first-child{text-align:left}\
th{border-bottom:2px solid #444}\
tr.ours td{background:#fdf3ec}\
b{color:#0072b2}\
figure{margin:1em 0}\
svg{max-width:100%;height:auto}\
pre{background:#f6f6f6;padding:.7em 1em;overflow:auto}\
nav a{margin-right:1em}";

/// The page: what was run, and for each class its table, its figure, and what is asked.
///
/// `figures` are SVGs in the order of classes.
pub fn html(rows: &[Row], bases: &[String], settings: &str, figures: &[String]) -> String {
    let mut page = String::new();
    let _ = write!(
        page,
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Benchmark</title><style>{STYLE}</style></head>\n\
         <body><h1>Benchmark</h1>\n<pre>{}</pre>\n<nav>",
        escaped(settings)
    );
    let classes = classes(rows);
    for (at, class) in classes.iter().enumerate() {
        let _ = write!(page, "<a href=\"#c{at}\">{}</a>", escaped(&class.name()));
    }
    page.push_str("</nav>\n");
    for (at, class) in classes.iter().enumerate() {
        let _ = write!(
            page,
            "<section id=\"c{at}\"><h2>{}</h2>\n<table><thead><tr><th>law</th>",
            escaped(&class.name())
        );
        for title in HEADER {
            let _ = write!(page, "<th>{}</th>", escaped(title));
        }
        page.push_str("</tr></thead><tbody>\n");
        for row in better(rows, *class) {
            let ours = if row.law.kind == super::LawKind::Default {
                " class=\"ours\""
            } else {
                ""
            };
            let _ = write!(page, "<tr{ours}><td>{}</td>", escaped(&label(row)));
            for cell in cells(row) {
                let texts = cell.0.iter().map(|(text, wins)| match wins {
                    true => format!("<b>{}</b>", escaped(text)),
                    false => escaped(text),
                });
                let _ = write!(page, "<td>{}</td>", texts.collect::<Vec<_>>().join(" · "));
            }
            page.push_str("</tr>\n");
        }
        let _ = write!(
            page,
            "</tbody></table>\n<pre>{}</pre>\n",
            escaped(&verdict(rows, *class, bases))
        );
        if let Some(figure) = figures.get(at) {
            let drawing = figure
                .find("<svg")
                .and_then(|from| figure.get(from..))
                .unwrap_or_default();
            let _ = write!(page, "<figure>{drawing}</figure>");
        }
        page.push_str("</section>\n");
    }
    page.push_str("</body></html>\n");
    page
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}
