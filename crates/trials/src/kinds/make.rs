//! Functions that make input from random numbers.

use crate::case::Case;
use crate::network::Network;
use crate::random::Random;

/// Function that makes a network.
pub type MakeNetwork = fn(&mut Random) -> Network;

/// Function that makes a case.
pub type MakeCase = fn(&mut Random) -> Case;
