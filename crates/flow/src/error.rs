//! Errors of flow plans.

use anastomesh_mesh::units::counted;
use anastomesh_network::flow::NotConverged;

/// Largest Reynolds number (peak flow rate, mean velocity, diameter) of an inlet. Aortic peaks are about 6,000.
pub(super) const MAX_REYNOLDS: f64 = 10_000.0;

/// Reason why a flow cannot be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FlowError {
    /// A number of the plan is out of range.
    #[error("{what} is {value}; give {range}")]
    OutOfRange {
        /// Name of the number.
        what: &'static str,
        /// Its value.
        value: f64,
        /// Permitted values.
        range: &'static str,
    },
    /// The outlet model needs a resistance or a pressure.
    #[error("the outlet model '{model}' has no reference; give a total resistance or a mean pressure at the inlets")]
    NoReference {
        /// Name of the model.
        model: &'static str,
    },
    /// A column of the table is not the name of an inlet.
    #[error("column '{column}' is not an inlet; inlets (patch or node): {}", inlets.join(", "))]
    UnknownInlet {
        /// Name of the column.
        column: String,
        /// Names of the first inlets.
        inlets: Vec<String>,
    },
    /// An inlet has no column, or two.
    #[error("{inlet} has {} in the table; give one per inlet, or a single one for all", counted(*columns, "column"))]
    Columns {
        /// Name of the inlet.
        inlet: String,
        /// Number of its columns.
        columns: usize,
    },
    /// The mean flow rate of an inlet is not inwards.
    #[error("{inlet} has a mean flow rate of {mean:e}; give a waveform with a mean above 0, positive into the inlet")]
    NotInwards {
        /// Name of the inlet.
        inlet: String,
        /// Mean flow rate.
        mean: f64,
    },
    /// The flow rate of an inlet has too large a Reynolds number.
    #[error(
        "{inlet} has a Reynolds number of {reynolds:.0} (limit {MAX_REYNOLDS}): flow rate {flow:e}, radius {radius:e}; \
         give flow rate, viscosity and density in units that fit the lengths of the mesh"
    )]
    TooFast {
        /// Name of the inlet.
        inlet: String,
        /// Reynolds number of the largest rate.
        reynolds: f64,
        /// Largest flow rate.
        flow: f64,
        /// Radius of the inlet.
        radius: f64,
    },
    /// The wanted mean pressure leaves nothing for the outlets.
    #[error(
        "a mean pressure of {wanted:e} at the inlets leaves nothing for the outlets: the network takes {drop:e} above the \
         pressure {distal:e} beyond the outlets; give a larger mean pressure"
    )]
    PressureTooLow {
        /// Wanted mean pressure.
        wanted: f64,
        /// Pressure drop of the network.
        drop: f64,
        /// Pressure beyond the outlets.
        distal: f64,
    },
    /// An outlet is thinner than the vessels beyond it.
    #[error(
        "the outlet at node {node} has radius {radius:e}, below the minimum radius {minimum:e} of the structured tree; give a smaller one"
    )]
    OutletTooThin {
        /// Name of the node in the file.
        node: String,
        /// Radius of the outlet.
        radius: f64,
        /// Minimum radius of the tree.
        minimum: f64,
    },
    /// The pressures cannot be found.
    #[error(transparent)]
    NotConverged(#[from] NotConverged),
}
