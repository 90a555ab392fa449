//! HTML page of sections with escaped text.

use super::escape::escaped;
use super::legend::Legend;
use super::pictures::Picture;
use crate::report::plot::{Panel, svg};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use std::fmt::{Display, Write as _};
use std::io;

const STYLE: &str = include_str!("style.css");

/// Part of a page under a heading.
#[derive(Clone, Debug, Default)]
pub struct Section {
    title: &'static str,
    body: String,
}

impl Section {
    pub fn new(title: &'static str) -> Self {
        Self { title, body: String::new() }
    }

    /// Adds a paragraph.
    pub fn text(mut self, text: &str) -> Self {
        let _ = writeln!(self.body, "<p>{}</p>", escaped(text));
        self
    }

    /// Adds a command line.
    pub fn command(mut self, text: &str) -> Self {
        let _ = writeln!(self.body, "<pre><code>{}</code></pre>", escaped(text));
        self
    }

    /// Adds terminal output in a collapsed block.
    pub fn folded(mut self, label: &str, text: &str) -> Self {
        let _ = writeln!(
            self.body,
            "<details><summary>{}</summary><pre>{}</pre></details>",
            escaped(label),
            escaped(text.trim_end())
        );
        self
    }

    /// Adds figures side by side, each with a label.
    pub fn tiles(mut self, tiles: &[(&str, String)]) -> Self {
        self.body.push_str("<dl class=\"tiles\">");
        for (what, value) in tiles {
            let _ = write!(self.body, "<div><dt>{}</dt><dd>{}</dd></div>", escaped(what), escaped(value));
        }
        self.body.push_str("</dl>\n");
        self
    }

    /// Adds a table of text cells; numbers are right-aligned.
    pub fn table(mut self, head: &[&str], rows: &[Vec<String>]) -> Self {
        self.body.push_str("<div class=\"wide\"><table><thead><tr>");
        for cell in head {
            let _ = write!(self.body, "<th>{}</th>", escaped(cell));
        }
        self.body.push_str("</tr></thead><tbody>\n");
        for row in rows {
            self.body.push_str("<tr>");
            for cell in row {
                let is_number = cell.trim_start_matches(['-', '−']).starts_with(|c: char| c.is_ascii_digit())
                    && !cell.starts_with("--");
                let class = if is_number { " class=\"n\"" } else { "" };
                let _ = write!(self.body, "<td{class}>{}</td>", escaped(cell));
            }
            self.body.push_str("</tr>\n");
        }
        self.body.push_str("</tbody></table></div>\n");
        self
    }

    /// Adds plots.
    pub fn plots(mut self, panels: &[Panel]) -> Self {
        if !panels.is_empty() {
            let drawn = svg(panels).replacen("<svg ", "<svg class=\"plot\" role=\"img\" ", 1);
            self.body.push_str(&drawn);
        }
        self
    }

    /// Adds pictures side by side, with captions and legends; with `aimed`, a ring marks the centre.
    ///
    /// # Errors
    /// A picture cannot be compressed, which happens only if memory is insufficient.
    pub fn pictures(mut self, pictures: &[Picture], aimed: bool) -> io::Result<Self> {
        let class = if aimed { "pictures aimed" } else { "pictures" };
        let _ = writeln!(self.body, "<div class=\"{class}\">");
        for Picture { image, caption, legend } in pictures {
            let mut png = Vec::new();
            image.write_png(&mut png)?;
            let caption = escaped(caption);
            let _ = writeln!(
                self.body,
                "<figure><span><img alt=\"{caption}\" width=\"{}\" height=\"{}\" src=\"data:image/png;base64,{}\"></span>\
                 {}<figcaption>{caption}</figcaption></figure>",
                image.width,
                image.height,
                STANDARD.encode(png),
                legend.as_ref().map_or_else(String::new, Legend::html)
            );
        }
        self.body.push_str("</div>\n");
        Ok(self)
    }

    /// Adds a list whose items are good, bad or neutral.
    pub fn list(mut self, items: &[(Mark, String)]) -> Self {
        self.body.push_str("<ul class=\"lines\">");
        for (mark, text) in items {
            let (class, sign) = match mark {
                Mark::Good => ("good", "✓"),
                Mark::Bad => ("bad", "✗"),
                Mark::Neither => ("none", "–"),
                Mark::Below => ("below", ""),
            };
            let _ = writeln!(self.body, "<li class=\"{class}\"><b>{sign}</b>{}</li>", escaped(text));
        }
        self.body.push_str("</ul>\n");
        self
    }

    fn is_empty(&self) -> bool {
        self.body.is_empty()
    }
}

/// Mark of a list item.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    Good,
    Bad,
    Neither,
    /// Continuation of the item above.
    Below,
}

/// Complete page.
#[derive(Clone, Debug)]
pub struct Page {
    title: String,
    /// Verdict as mark and text.
    verdict: Option<(Mark, String)>,
    sections: Vec<Section>,
}

impl Page {
    pub fn new(title: impl Display, verdict: Option<(Mark, String)>) -> Self {
        Self { title: title.to_string(), verdict, sections: Vec::new() }
    }

    /// Adds a section, unless it is empty.
    pub fn add(&mut self, section: Section) {
        if !section.is_empty() {
            self.sections.push(section);
        }
    }

    /// Returns the HTML document.
    pub fn html(&self) -> String {
        let title = escaped(&self.title);
        let verdict = self.verdict.as_ref().map_or_else(String::new, |(mark, words)| {
            let class = match mark {
                Mark::Good => "good",
                Mark::Bad => "bad",
                Mark::Neither | Mark::Below => "none",
            };
            format!("<p class=\"verdict {class}\">{}</p>", escaped(words))
        });
        let mut out = format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
             content=\"width=device-width\">\n<title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
             <header><h1>{title}</h1>{verdict}</header>\n<main>\n"
        );
        for section in &self.sections {
            let _ = writeln!(out, "<section><h2>{}</h2>\n{}</section>", escaped(section.title), section.body);
        }
        let _ = writeln!(
            out,
            "</main>\n<footer>anastomesh {}</footer>\n</body>\n</html>",
            escaped(env!("CARGO_PKG_VERSION"))
        );
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_comes_from_outside_means_itself() {
        let evil = "<script>alert('1')</script>\u{1b}\"&";
        let mut page = Page::new(evil, Some((Mark::Bad, evil.into())));
        page.add(
            Section::new("A")
                .text(evil)
                .folded(evil, evil)
                .tiles(&[(evil, evil.into())])
                .table(&[evil], &[vec![evil.into()]])
                .list(&[(Mark::Below, evil.into())]),
        );
        page.add(Section::new("nothing"));
        let html = page.html();
        assert!(!html.contains("<script") && !html.contains('\u{1b}') && !html.contains("nothing"), "{html}");
        assert_eq!(html.matches("&lt;script&gt;alert(&#39;1&#39;)").count(), 11);
        for outside in ["http:", "https:", "src=\"/", "@import"] {
            assert!(!html.contains(outside), "{outside}");
        }
    }
}
