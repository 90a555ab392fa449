//! Floor 3: readers and writers, one file per format.

pub mod vtk_xml;
