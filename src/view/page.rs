//! Assembly of the HTML page.

use super::chunk::pack_wall;
use super::faults::FaultGroup;
use super::pack::Pack;
use super::scale::Scale;
use super::wall::Wall;
use anastomesh_mesh::check::CheckReport;
use anastomesh_mesh::check::text::verdict;
use anastomesh_mesh::{NamedRegion, Patch};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Map, Value, json};
use std::io;

const FRAME: &str = include_str!("page.html");
const STYLE: &str = include_str!("style.css");
/// Scripts in the order of their dependencies.
const SCRIPTS: [&str; 9] = [
    include_str!("data.js"),
    include_str!("gl.js"),
    include_str!("camera.js"),
    include_str!("scene.js"),
    include_str!("cut.js"),
    include_str!("overlay.js"),
    include_str!("input.js"),
    include_str!("panel.js"),
    include_str!("main.js"),
];

/// Page during assembly.
pub struct ViewerPage {
    pub pack: Pack,
    facts: Map<String, Value>,
}

impl ViewerPage {
    /// Creates a page with this title.
    pub fn new(title: &str) -> Self {
        let mut facts = Map::new();
        facts.insert("title".into(), json!(title));
        facts.insert("version".into(), json!(env!("CARGO_PKG_VERSION")));
        Self { pack: Pack::default(), facts }
    }

    /// Adds metadata under a name.
    pub fn know(&mut self, name: &str, fact: Value) {
        self.facts.insert(name.into(), fact);
    }

    /// Adds the wall of a mesh, with its regions and the scale of its values. Regions are blocks; an interface belongs to
    /// the region with the smaller id.
    pub fn add_wall(&mut self, wall: Wall, patches: &[Patch], regions: &[NamedRegion], values: Option<Scale>) {
        let fact = pack_wall(wall, values, &mut self.pack);
        self.know("wall", fact);
        let patch = |p: &Patch| {
            let beyond = NamedRegion::pair_of(regions, &p.name).map(|[_, beyond]| beyond);
            json!({ "id": p.id, "name": p.name, "node": p.cap.map(|cap| cap.node), "beyond": beyond })
        };
        self.know("patches", patches.iter().map(patch).collect());
        if !regions.is_empty() {
            self.know("regions", json!(regions));
        }
    }

    /// Adds faults that the viewer can navigate to.
    pub fn add_faults(&mut self, faults: &[FaultGroup]) {
        self.know("faults", json!(faults));
    }

    /// Adds the verdict of a check; without a report the mesh was not checked, for this reason.
    pub fn add_check(&mut self, check: Result<&CheckReport, &str>) {
        let fact = match check {
            Ok(check) => json!({ "verdict": check.verdict, "text": verdict(check.verdict) }),
            Err(reason) => json!({ "verdict": "not_checked", "text": format!("Not checked: {reason}") }),
        };
        self.know("check", fact);
    }

    /// Returns the HTML document.
    ///
    /// # Errors
    /// Memory is insufficient.
    pub fn html(mut self) -> io::Result<String> {
        let entries = self.pack.entries();
        self.know("arrays", entries);
        // Escaped, so that no input text can close its element.
        let facts = Value::Object(self.facts).to_string().replace('<', "\\u003c");
        let data = STANDARD.encode(self.pack.compressed()?);
        let parts = [("/*style*/", STYLE.to_owned()), ("/*facts*/", facts), ("/*data*/", data)];
        let mut rest = FRAME.replace("/*scripts*/", &SCRIPTS.join("\n"));
        let mut out = String::new();
        for (mark, text) in parts {
            if let Some((before, after)) = rest.split_once(mark) {
                out.push_str(before);
                out.push_str(&text);
                rest = after.to_owned();
            }
        }
        out.push_str(&rest);
        Ok(out)
    }
}
