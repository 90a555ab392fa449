//! Floor 5: pictures of meshes and networks, drawn by the processor alone.
//!
//! What is drawn becomes facets, a batch at a time, so that a mesh of any size is drawn in passes: `mesh` and `network` make
//! them, `canvas` keeps of each sample the facet that is nearest to the viewer, and `shade` lights the samples once all is
//! drawn. The same input and options give the same bytes for any number of threads.

mod camera;
mod canvas;
mod colours;
mod image;
mod mesh;
mod network;
mod outline;
mod plane;
mod shade;

pub use camera::{Camera, Direction};
pub use canvas::Canvas;
pub use colours::{Background, Colour, Legend};
pub use image::Image;
pub use mesh::{MeshPicture, Opening};
pub use network::{NetworkPicture, Shown};
pub use outline::Outline;
pub use plane::{Plane, PlaneWish};
