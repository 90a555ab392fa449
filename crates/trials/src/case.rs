//! A case: input file, options and output of one run of the program.

use crate::network::Network;
use crate::surface::Surface;

/// Input of a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Input {
    /// Network for `mesh`.
    Network(Network),
    /// Closed surface for `tetrahedralize`.
    Surface(Surface),
    /// Facet complex for `tetrahedralize`.
    Complex(Surface),
    /// Text of a surface file for `tetrahedralize`.
    Text(String),
}

/// Outcome that the kind of a case demands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expect {
    /// A valid mesh, or a typed error.
    Any,
    /// A valid mesh: the input is valid by construction.
    Valid,
    /// A typed error: the input is not valid by construction.
    Refused,
}

/// One run of the program.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Input.
    pub input: Input,
    /// Options, each with its values.
    pub options: Vec<Vec<String>>,
    /// Name of the output file.
    pub output: &'static str,
    /// Demanded outcome.
    pub expect: Expect,
}

impl Case {
    /// Case without options that writes a VTU file.
    pub fn new(input: Input, expect: Expect) -> Self {
        Self { input, options: Vec::new(), output: "out.vtu", expect }
    }

    /// Adds an option with values, separated by spaces.
    #[must_use]
    pub fn with(mut self, option: &str) -> Self {
        self.options.push(option.split_whitespace().map(str::to_owned).collect());
        self
    }

    /// Name of the input file.
    pub fn file(&self) -> &'static str {
        match self.input {
            Input::Network(_) => "in.vtp",
            Input::Surface(_) | Input::Text(_) => "in.off",
            Input::Complex(_) => "in.poly",
        }
    }

    /// Content of the input file.
    pub fn text(&self) -> String {
        match &self.input {
            Input::Network(network) => network.vtp(),
            Input::Surface(surface) => surface.off(),
            Input::Complex(complex) => complex.poly(),
            Input::Text(text) => text.clone(),
        }
    }

    /// Arguments of the program, run in the folder of the input.
    pub fn arguments(&self) -> Vec<String> {
        let verb = if matches!(self.input, Input::Network(_)) { "mesh" } else { "tetrahedralize" };
        let mut words: Vec<String> = [verb, self.file(), "-o", self.output].map(str::to_owned).into();
        // Equal bytes for any number of threads; one thread leaves the other cores to other trials.
        if !self.has("-j") {
            words.extend(["-j".to_owned(), "1".to_owned()]);
        }
        words.extend(self.options.iter().flatten().cloned());
        words.push("-q".to_owned());
        words
    }

    /// True if an option is given.
    pub fn has(&self, name: &str) -> bool {
        self.options.iter().any(|option| option[0] == name || option[0].starts_with(&format!("{name}=")))
    }

    /// Number of nodes, triangles or lines of the input.
    pub fn size(&self) -> usize {
        match &self.input {
            Input::Network(network) => network.edges.len(),
            Input::Surface(surface) | Input::Complex(surface) => surface.triangles.len(),
            Input::Text(text) => text.lines().count(),
        }
    }
}
