//! Sequences of colours that the colour-blind can read as well.

use super::color_scale::ScaleKind;
use super::cool_warm::cool_warm;
use crate::choice::choices;

/// A sequence of colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Palette {
    /// Blue, light grey, red: Moreland's cool-warm (ISVC 2009).
    CoolWarm,
    /// Purple, near white, orange: ColorBrewer's PuOr, which also print in grey keeps apart from its middle.
    PurpleOrange,
    /// Dark violet to yellow (van der Walt and Smith 2015).
    Viridis,
    /// Dark blue to yellow, nearly the same to all kinds of colour vision (Nunez, Anderton and Renslow 2018).
    Cividis,
    /// Black over red to pale yellow (van der Walt and Smith 2015).
    Magma,
}

choices!(Palette, "colour scale": {
    CoolWarm = "cool-warm": "blue, grey at 0, red",
    PurpleOrange = "purple-orange": "purple, near white at 0, orange",
    Viridis = "viridis": "dark violet to yellow",
    Cividis = "cividis": "dark blue to yellow",
    Magma = "magma": "black over red to pale yellow",
});

impl Palette {
    /// Whether its colours run from the middle to both sides.
    pub fn kind(self) -> ScaleKind {
        match self {
            Self::CoolWarm | Self::PurpleOrange => ScaleKind::Diverging,
            Self::Viridis | Self::Cividis | Self::Magma => ScaleKind::Sequential,
        }
    }

    /// Colour at a position from 0 to 1, sRGB.
    pub(crate) fn color(self, position: f64) -> [u8; 3] {
        let gradient: &colorous::Gradient = match self {
            Self::CoolWarm => return cool_warm(2.0 * position - 1.0),
            Self::PurpleOrange => &colorous::PURPLE_ORANGE,
            Self::Viridis => &colorous::VIRIDIS,
            Self::Cividis => &colorous::CIVIDIS,
            Self::Magma => &colorous::MAGMA,
        };
        let color = gradient.eval_continuous(position);
        [color.r, color.g, color.b]
    }
}
