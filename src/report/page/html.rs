//! The page itself: sections of escaped text.

use crate::picture::Image;
use crate::report::plot::{Panel, svg};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use std::fmt::{Display, Write as _};
use std::io;

const STYLE: &str = include_str!("style.css");

/// Text that means itself in HTML, in attributes as well.
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            // Control characters have no place in a page.
            c if c.is_control() && c != '\n' => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// A part of a page under a heading.
#[derive(Clone, Debug, Default)]
pub struct Section {
    title: &'static str,
    body: String,
}

impl Section {
    pub fn new(title: &'static str) -> Self {
        Self { title, body: String::new() }
    }

    /// A paragraph.
    pub fn text(mut self, text: &str) -> Self {
        let _ = writeln!(self.body, "<p>{}</p>", escaped(text));
        self
    }

    /// Text as a terminal shows it, folded away.
    pub fn folded(mut self, label: &str, text: &str) -> Self {
        let _ = writeln!(
            self.body,
            "<details><summary>{}</summary><pre>{}</pre></details>",
            escaped(label),
            escaped(text.trim_end())
        );
        self
    }

    /// Figures side by side, each with what it is.
    pub fn tiles(mut self, tiles: &[(&str, String)]) -> Self {
        self.body.push_str("<dl class=\"tiles\">");
        for (what, value) in tiles {
            let _ = write!(self.body, "<div><dt>{}</dt><dd>{}</dd></div>", escaped(what), escaped(value));
        }
        self.body.push_str("</dl>\n");
        self
    }

    /// A table; cells are text, those that are numbers stand to the right.
    pub fn table(mut self, head: &[&str], rows: &[Vec<String>]) -> Self {
        self.body.push_str("<div class=\"wide\"><table><thead><tr>");
        for cell in head {
            let _ = write!(self.body, "<th>{}</th>", escaped(cell));
        }
        self.body.push_str("</tr></thead><tbody>\n");
        for row in rows {
            self.body.push_str("<tr>");
            for cell in row {
                let class =
                    if cell.starts_with(|c: char| c.is_ascii_digit() || c == '-') { " class=\"n\"" } else { "" };
                let _ = write!(self.body, "<td{class}>{}</td>", escaped(cell));
            }
            self.body.push_str("</tr>\n");
        }
        self.body.push_str("</tbody></table></div>\n");
        self
    }

    /// Plots.
    pub fn plots(mut self, panels: &[Panel]) -> Self {
        if !panels.is_empty() {
            let drawn = svg(panels).replacen("<svg ", "<svg class=\"plot\" role=\"img\" ", 1);
            self.body.push_str(&drawn);
        }
        self
    }

    /// Pictures side by side, each with what it shows; those that are aimed have a ring in the middle.
    ///
    /// # Errors
    /// When a picture cannot be compressed, which memory alone can be the reason of.
    pub fn pictures(mut self, pictures: &[(Image, String)], aimed: bool) -> io::Result<Self> {
        let class = if aimed { "pictures aimed" } else { "pictures" };
        let _ = writeln!(self.body, "<div class=\"{class}\">");
        for (image, caption) in pictures {
            let mut png = Vec::new();
            image.write_png(&mut png)?;
            let caption = escaped(caption);
            let _ = writeln!(
                self.body,
                "<figure><span><img alt=\"{caption}\" width=\"{}\" height=\"{}\" src=\"data:image/png;base64,{}\"></span>\
                 <figcaption>{caption}</figcaption></figure>",
                image.width,
                image.height,
                STANDARD.encode(png)
            );
        }
        self.body.push_str("</div>\n");
        Ok(self)
    }

    /// A list whose items are good, bad or neither.
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

/// How an item of a list is marked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    Good,
    Bad,
    Neither,
    /// Belongs to the item above.
    Below,
}

/// A whole page.
#[derive(Clone, Debug)]
pub struct Page {
    title: String,
    /// Good, bad or undecided, and in words.
    verdict: Option<(Mark, String)>,
    sections: Vec<Section>,
}

impl Page {
    pub fn new(title: impl Display, verdict: Option<(Mark, String)>) -> Self {
        Self { title: title.to_string(), verdict, sections: Vec::new() }
    }

    /// Adds a section, unless there is nothing in it.
    pub fn add(&mut self, section: Section) {
        if !section.is_empty() {
            self.sections.push(section);
        }
    }

    /// The file.
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
