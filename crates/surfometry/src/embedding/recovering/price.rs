//! What a correction may cost.

/// The most that one correction may do, as the distance in geometric mean spacings by which it alone would
/// move a flat face at its own voxel.
///
/// A mask is not always right. Noise that is recovered makes curvature useless; as multipliers in a
/// classifier with a soft margin are, corrections are capped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Price {
    /// Any price: the mask is right.
    Strict,
    /// At most this.
    Capped(f64),
    /// As the violations look, by a rule that was found on clean and noisy shapes and held on others
    /// (`experiments/recovering_embedding`): those with company that wants the surface moved the same way are
    /// detail or thin parts and corrected at up to 1; deep ones that stand alone look like noise. Where there is
    /// little of that they are corrected too, at up to 0.4, and all else at up to 1; where there is much, they
    /// are left to the blur, and what has no company is corrected at up to 0.4.
    FromEvidence,
}
