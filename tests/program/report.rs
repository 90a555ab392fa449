//! Command line tests of `--report`: one readable, self-contained page.

use crate::common::fixture;
use crate::common::program::*;
use std::fs;
use std::path::Path;

/// Page of a run, asserted to be well-formed and self-contained.
#[track_caller]
fn page(path: &Path) -> String {
    let html = fs::read_to_string(path).expect("a page");
    for outside in ["http://", "https://", "<script", "<link", "@import", "url("] {
        let found = html.matches(outside).count();
        // The SVG namespace is an address that is never requested.
        let names = if outside == "http://" { html.matches("http://www.w3.org/2000/svg").count() } else { 0 };
        assert_eq!(found, names, "{outside}");
    }
    for tag in ["section", "table", "svg", "figure", "ul", "li", "dl", "div", "td", "p"] {
        let open = html.matches(&format!("<{tag}>")).count() + html.matches(&format!("<{tag} ")).count();
        assert_eq!(open, html.matches(&format!("</{tag}>")).count(), "{tag}");
    }
    assert!(html.contains("prefers-color-scheme: dark") && html.contains("@media print"));
    // Base64 pictures may contain any letters.
    let text: String = html.split("base64,").map(|part| part.split_once('"').map_or(part, |(_, rest)| rest)).collect();
    assert!(!text.contains("NaN"));
    html
}

#[track_caller]
fn holds(html: &str, words: &[&str]) {
    for word in words {
        assert!(html.contains(word), "'{word}' is not in the page");
    }
}

/// Two vessels that cross.
const CROSSING: &str = "1 0 -20 0 0 1 -1\n2 0 20 0 0 1 1\n3 0 0 -20 0.5 1 -1\n4 0 0 20 0.5 1 3\n";

#[test]
fn a_mesh_and_its_check() {
    let folder = folder();
    let [tree, made, checked] = ["a<b>'\"&.vtu", "r.html", "c.html"].map(|name| folder.path().join(name));
    let options = ["-q", "--refine", "--report", made.to_str().expect("a path")];
    assert_code(&mesh(&fixture("tree_30.vtp"), &tree, &options), FINE);
    let html = page(&made);
    let headings = [
        "Summary",
        "Overview",
        "Validity",
        "Shape of the tetrahedra",
        "Accuracy against the network",
        "Blocks and times",
        "Inlets and outlets",
        "Command and options",
    ];
    holds(&html, &headings.map(|h| format!("<h2>{h}</h2>")).each_ref().map(String::as_str));
    holds(
        &html,
        &[
            "class=\"verdict good\">valid<",
            "a&lt;b&gt;&#39;&quot;&amp;.vtu",
            "outlet_0",
            "Radius ratio",
            "&quot;rho&quot;",
            "<td>--refine</td><td class=\"n\">200</td><td>given</td>",
            "<td>--rho</td><td class=\"n\">3</td><td>default</td>",
            "<td>--dump-dir</td><td>none</td><td>default</td>",
            "Radius ratio (1: regular)</p><div class=\"bar\"",
            "Vessel radius, logarithmic</p><div class=\"bar\"",
            "</i>outlet</span>",
        ],
    );
    assert!(html.matches("data:image/png;base64,").count() == 3 && !html.contains("a<b>"));
    assert_code(&run("check", &[&tree], &["--report", checked.to_str().expect("a path")]), FINE);
    let html = page(&checked);
    holds(&html, &["class=\"verdict good\">valid<", "<h2>Patches</h2>", "Dihedral angles", "inlet"]);
}

#[test]
fn what_is_wrong_is_shown_where_it_is() {
    let folder = folder();
    let [tree, broken, out] = ["tree.mesh", "broken.mesh", "r.html"].map(|name| folder.path().join(name));
    assert_code(&mesh(&fixture("tree_30.vtp"), &tree, &["-q"]), FINE);
    let text = fs::read_to_string(&tree).expect("a mesh");
    // Inverts the first tetrahedron.
    let mut lines: Vec<String> = text.lines().map(Into::into).collect();
    let at = lines.iter().position(|l| l.trim() == "Tetrahedra").expect("tetrahedra") + 2;
    let mut words: Vec<&str> = lines[at].split_whitespace().collect();
    words.swap(0, 1);
    lines[at] = words.join(" ");
    fs::write(&broken, lines.join("\n")).expect("written");
    assert_code(&run("check", &[&broken], &["--report", out.to_str().expect("a path")]), GATE_NOT_MET);
    let html = page(&out);
    holds(
        &html,
        &[
            "class=\"verdict bad\">NOT valid: 1 tetrahedron",
            "pictures aimed",
            "1 tetrahedron is inverted or flat",
            "(circled)",
        ],
    );
}

#[test]
fn refined_networks_filled_surfaces_and_blocks_that_fail() {
    let folder = folder();
    let out = folder.path().join("r.html");
    let report = ["-q", "--report", out.to_str().expect("a path")];
    let crossing = folder.path().join("crossing.swc");
    fs::write(&crossing, CROSSING).expect("written");
    let refines = ["-q", "--refine", "--report", out.to_str().expect("a path")];
    assert_code(&mesh(&crossing, &folder.path().join("c.vtu"), &refines), FINE);
    holds(&page(&out), &["Displacement of the nodes", "<h2>Refinement</h2>"]);
    let network = folder.path().join("n.vtp");
    assert_code(&run("refine", &[&fixture("tree_30.vtp"), Path::new("-o"), &network], &report), FINE);
    holds(&page(&out), &["no vessels overlap", "Displacement of the nodes", "<h2>Refinement</h2>"]);
    assert_code(&fill(&fixture("torus.off"), &folder.path().join("t.vtu"), &report), FINE);
    holds(&page(&out), &["Shape of the tetrahedra", "boundary"]);
    let hopeless = folder.path().join("hopeless.vtp");
    fs::write(&hopeless, HOPELESS).expect("written");
    assert_code(&mesh(&hopeless, &folder.path().join("h.vtu"), &report), STAGE_FAILED);
    holds(
        &page(&out),
        &[
            "class=\"verdict bad\">",
            "Failed blocks",
            "<h2>What may help</h2>",
            "try a smaller --rho",
            "could not be meshed",
            "cluster",
        ],
    );
    let nowhere = folder.path().join("none/r.html");
    let refused =
        mesh(&fixture("tree_30.vtp"), &folder.path().join("m.vtu"), &["--report", nowhere.to_str().expect("a path")]);
    assert_says(&refused, BAD_INPUT, &["r.html", "cannot be written"]);
}
