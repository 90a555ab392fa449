//! Floor 6 (under construction)
