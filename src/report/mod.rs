//! Floor 3: what the verbs say, as models with a text and a JSON form.

pub mod check;
pub mod info;
pub mod plot;
pub mod tetrahedralize;
