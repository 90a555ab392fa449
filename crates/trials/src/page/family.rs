//! Families of kinds, with their headings and the outcome that they should have.

/// Results that a family has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Demand {
    /// A mesh that both checkers accept, or a documented refusal.
    Mesh,
    /// A refusal.
    Refusal,
    /// Complete files, and a second run that gives the bytes of an undisturbed one.
    Files,
}

/// Family of kinds.
#[derive(Debug)]
pub struct Family {
    /// Begin of the names of its kinds.
    pub prefix: &'static str,
    pub title: &'static str,
    pub note: &'static str,
    pub demand: Demand,
}

/// Networks without options.
pub const NETWORKS: Family = Family {
    prefix: "networks/",
    title: "Networks",
    note: "Each network is meshed without options.",
    demand: Demand::Mesh,
};

/// Networks whose overlapping vessels are moved apart.
pub const REFINED: Family = Family {
    prefix: "refined/",
    title: "Networks with `--refine`",
    note: "The kinds are those above, with the option `--refine`.",
    demand: Demand::Mesh,
};

/// Valid surfaces.
pub const SURFACES: Family = Family {
    prefix: "surfaces/",
    title: "Surfaces",
    note: "Each surface is valid by construction, so a refusal is a finding.",
    demand: Demand::Mesh,
};

/// Facet complexes.
pub const COMPLEXES: Family = Family {
    prefix: "complexes/",
    title: "Complexes with regions",
    note: "Complexes are valid by construction, except those with dangling triangles.",
    demand: Demand::Mesh,
};

/// Options at random.
pub const OPTIONS: Family = Family {
    prefix: "options/",
    title: "Options at random",
    note: "Moderate input with options drawn at random.",
    demand: Demand::Mesh,
};

/// Input that must be refused.
pub const FAULTY: Family = Family {
    prefix: "soups/",
    title: "Faulty input",
    note: "The input is faulty by construction, so a mesh that is called valid is a finding. Refused as expected: a documented exit code \
           with\na message.",
    demand: Demand::Refusal,
};

/// Kills, full disks and failing system calls.
pub const FAULTS: Family = Family {
    prefix: "faults/",
    title: "Kills and faults",
    note: "Nothing lost: each file is complete, of the earlier run or of this one. A second run then gives the bytes of an undisturbed \
           one.\nA run that stopped ended by the signal, or with a message.",
    demand: Demand::Files,
};

/// All families, in the order of the page.
pub const FAMILIES: [&Family; 7] = [&NETWORKS, &REFINED, &SURFACES, &COMPLEXES, &OPTIONS, &FAULTY, &FAULTS];
