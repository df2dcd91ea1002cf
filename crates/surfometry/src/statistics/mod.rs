//! Agreement of two methods on the same objects: regression, Bland-Altman, concordance, intraclass
//! correlation, bootstrap, confusion of topology.
//!
//! Intervals are of 95 %. Bias is method minus standard; the paper's tables have it the other way round.
//!
//! ```
//! use surfometry::statistics::{Agreement, Bootstrap, Paired};
//! let pairs = Paired::new(vec![10.1, 20.3, 29.9, 40.5], vec![10.0, 20.0, 30.0, 40.0])?;
//! let agreement = Agreement::of(&pairs, Bootstrap::default());
//! assert!((agreement.bland_altman.bias.value - 0.2).abs() < 1e-9);
//! # Ok::<(), surfometry::statistics::PairError>(())
//! ```

mod agreement;
mod bland_altman;
mod bootstrap;
mod concordance;
mod confusion;
mod distributions;
mod estimate;
mod intraclass;
mod paired;
mod regression;
mod spatial_correlation;

pub use agreement::{Agreement, Spread};
pub use bland_altman::{BlandAltman, bland_altman};
pub use bootstrap::{Bootstrap, bootstrap};
pub use concordance::concordance;
pub use confusion::{ConfusionMatrix, EulerRounding, RareClasses};
pub use distributions::{f_quantile, normal_cdf, normal_quantile, student_quantile, student_tails};
pub use estimate::Estimate;
pub use intraclass::{Intraclass, intraclass};
pub use paired::{PairError, Paired};
pub use regression::{LinearFit, least_squares};
pub use spatial_correlation::{Places, SpatialCorrelation};
