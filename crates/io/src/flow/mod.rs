//! Flow through a mesh or network: rates at inlets, models at outlets, and time. Solver cases are written from these data.
//!
//! ```
//! use anastomesh_io::flow::{OutletModel, Waveform};
//!
//! let pulse = Waveform::new(vec![0.0, 0.25, 0.75], vec![1.0, 3.0, 1.0])?;
//! assert_eq!((pulse.period(), pulse.mean(), pulse.at(0.875)), (0.75, 2.0, 2.0));
//! let outlet = OutletModel::Resistance { resistance: 5.0, distal_pressure: 0.0 };
//! assert_eq!(outlet.mean_pressure(pulse.mean()), 10.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod conditions;
mod outlet;
mod structured_tree;
mod table;
mod transient;
mod waveform;
mod womersley;

pub use conditions::{BLOOD_DENSITY, BLOOD_VISCOSITY, CapFlow, Flow, USUAL_REYNOLDS, flow_of_reynolds};
pub(crate) use conditions::{Role, plain};
pub use outlet::OutletModel;
pub use structured_tree::StructuredTree;
pub use table::{FlowTable, FlowTableError, FlowTableFault};
pub use transient::{Profile, Transient};
pub use waveform::{Waveform, WaveformFault};
pub(crate) use womersley::{Harmonic, poiseuille, womersley};
