//! Software rendering of meshes and networks to images.
//!
//! Objects become facets in batches, so meshes of any size are rendered in passes. `mesh` and `network` create the
//! facets, `canvas` is the depth buffer, and `shade` computes the lighting at the end. Equal input and options give
//! identical bytes for any number of threads.

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
pub use colours::{Background, Colour, Legend, PATCH_COLOURS, Rgb, of_quality};
pub use image::Image;
pub use mesh::{MeshPicture, Opening};
pub use network::{NetworkPicture, Shown};
pub use outline::Outline;
pub use plane::{Plane, PlaneWish};
