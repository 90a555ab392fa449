//! Kinds of difficult input: names, and functions that make a case from random numbers.

mod complexes;
mod make;
mod networks;
mod options;
mod repeated;
mod soups;
mod surfaces;
mod walks;

use crate::case::{Case, Expect, Input};
use crate::random::Random;
use make::{MakeCase, MakeNetwork};

#[derive(Clone, Copy)]
enum Make {
    Network(MakeNetwork),
    Refined(MakeNetwork),
    Case(MakeCase),
}

/// Kind of input.
#[derive(Clone, Copy)]
pub struct Kind {
    /// Family: `networks`, `refined` (the same networks with `--refine`), `surfaces`, `soups`, `complexes` or `options`.
    pub family: &'static str,
    /// Name within the family.
    pub name: &'static str,
    make: Make,
}

impl Kind {
    /// Family and name.
    pub fn id(&self) -> String {
        format!("{}/{}", self.family, self.name)
    }

    /// Returns the case of a seed.
    pub fn case(&self, seed: u64) -> Case {
        let mut random = Random::of_case(self.name, seed);
        match self.make {
            Make::Network(make) => Case::new(Input::Network(make(&mut random)), Expect::Any),
            Make::Refined(make) => Case::new(Input::Network(make(&mut random)), Expect::Any).with("--refine"),
            Make::Case(make) => make(&mut random),
        }
    }
}

/// All kinds, by family.
pub fn all() -> Vec<Kind> {
    let lists = [&repeated::KINDS[..], &networks::KINDS, &walks::KINDS];
    let networks = || lists.into_iter().flatten().copied();
    let mut kinds: Vec<Kind> =
        networks().map(|(name, make)| Kind { family: "networks", name, make: Make::Network(make) }).collect();
    kinds.extend(networks().map(|(name, make)| Kind { family: "refined", name, make: Make::Refined(make) }));
    let families: [(&str, &[(&str, MakeCase)]); 4] = [
        ("surfaces", &surfaces::KINDS),
        ("soups", &soups::KINDS),
        ("complexes", &complexes::KINDS),
        ("options", &options::KINDS),
    ];
    for (family, list) in families {
        kinds.extend(list.iter().map(|&(name, make)| Kind { family, name, make: Make::Case(make) }));
    }
    kinds
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn equal_seeds_give_equal_cases() {
        for kind in all() {
            for seed in 0..3 {
                let (case, again) = (kind.case(seed), kind.case(seed));
                assert_eq!(case.text(), again.text(), "{}", kind.id());
                assert_eq!(case.arguments(), again.arguments(), "{}", kind.id());
            }
        }
    }

    #[test]
    fn names_are_unique_and_numbers_are_finite() {
        let kinds = all();
        let names: BTreeSet<String> = kinds.iter().map(Kind::id).collect();
        assert_eq!(names.len(), kinds.len());
        for kind in kinds {
            for seed in 0..5 {
                let case = kind.case(seed);
                assert!(case.size() > 0, "{}", kind.id());
                if let Input::Network(network) = case.input {
                    assert!(network.points.iter().flatten().all(|x| x.is_finite()), "{}", kind.id());
                    assert!(network.radii.iter().all(|r| *r > 0.0), "{}", kind.id());
                }
            }
        }
    }
}
