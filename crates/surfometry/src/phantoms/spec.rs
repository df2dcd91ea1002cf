//! The text form of a phantom: `phantom:NAME?key=value&...`.

use super::{Ball, Bone, Capsule, Ellipsoid, Genus, MinimalSurface, Periodic, Phantom, Pose, RoundedBox};
use super::{Shape, Shell, Torus, TwoBalls};
use crate::text::did_you_mean;
use crate::volume::VolumeError;
use std::collections::BTreeMap;
use thiserror::Error;

/// The shapes that a spec can name.
pub const NAMES: [&str; 12] = [
    "ball",
    "ellipsoid",
    "capsule",
    "torus",
    "rounded-box",
    "shell",
    "two-balls",
    "genus",
    "gyroid",
    "schwarz-p",
    "femur",
    "vertebra",
];

const POSE_KEYS: [&str; 5] = ["spacing", "rotate", "shift", "jitter", "flips"];

/// Why a phantom spec cannot be used.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ParsePhantomError {
    /// No shape of that name.
    #[error(
        "no phantom is called `{0}`; {near}there are {list}",
        near = did_you_mean(.0, &NAMES),
        list = NAMES.join(", ")
    )]
    UnknownName(String),
    /// The shape does not take that key.
    #[error("phantom `{name}` has no key `{key}`; {near}it takes {keys}", near = near_key(key, keys))]
    UnknownKey {
        /// Shape.
        name: String,
        /// Key.
        key: String,
        /// What it does take.
        keys: String,
    },
    /// A value is no number, or not the right count of numbers.
    #[error("`{key}={value}` in the phantom: expected {expected}")]
    BadValue {
        /// Key.
        key: String,
        /// Value as typed.
        value: String,
        /// What is wanted.
        expected: &'static str,
    },
    /// Numbers that make no such shape.
    #[error("phantom `{name}`: {reason}")]
    Impossible {
        /// Shape.
        name: String,
        /// Which condition is not met.
        reason: &'static str,
    },
    /// The grid is impossible.
    #[error(transparent)]
    Volume(#[from] VolumeError),
}

fn near_key(key: &str, keys: &str) -> String {
    did_you_mean(key, &keys.split(", ").collect::<Vec<_>>())
}

impl Phantom {
    /// Whether an input names a phantom and not a file.
    pub fn is_spec(input: &str) -> bool {
        input.starts_with("phantom:")
    }

    /// Reads `phantom:NAME?key=value&...`; docs/contract.md has the keys. All keys are optional; lengths in
    /// mm.
    ///
    /// # Errors
    /// [`ParsePhantomError`], which says what is accepted instead.
    pub fn from_spec(text: &str) -> Result<Self, ParsePhantomError> {
        Self::from_spec_at(text, None)
    }

    /// The same on a lattice of another spacing than the spec's, mm.
    ///
    /// # Errors
    /// As of [`Phantom::from_spec`].
    pub fn from_spec_at(text: &str, spacing: Option<[f64; 3]>) -> Result<Self, ParsePhantomError> {
        let spec = text.strip_prefix("phantom:").unwrap_or(text);
        let (name, query) = spec.split_once('?').unwrap_or((spec, ""));
        let mut values = Values::parse(name, query)?;
        let shape = shape(&mut values)?;
        let pose = Pose::new(values.triple("rotate", [0.0; 3])?, values.triple("shift", [0.0; 3])?);
        let own = values.triple("spacing", [1.0; 3])?;
        let jitter = values.take("jitter", 0.0, "a standard deviation in mm, 0 or more", |text| {
            finite(text).filter(|&v| v >= 0.0)
        })?;
        let flips =
            values.take("flips", 0.0, "a share of the voxels beside the boundary, 0 to 1", |text| {
                finite(text).filter(|v| (0.0..=1.0).contains(v))
            })?;
        values.finish()?;
        Ok(Self::new(shape, pose, spacing.unwrap_or(own))?.with_jitter(jitter).with_flips(flips))
    }
}

fn shape(v: &mut Values) -> Result<Box<dyn Shape>, ParsePhantomError> {
    Ok(match v.name.as_str() {
        "ball" => Box::new(Ball { radius: v.length("radius", 20.0)? }),
        "ellipsoid" => Box::new(Ellipsoid { radii: v.lengths("radii", [30.0, 20.0, 15.0])? }),
        "capsule" => {
            Box::new(Capsule { radius: v.length("radius", 12.0)?, length: v.length("length", 40.0)? })
        }
        "torus" => {
            let torus = Torus { major: v.length("major", 30.0)?, minor: v.length("minor", 10.0)? };
            v.require(torus.minor < torus.major, "minor must be less than major")?;
            Box::new(torus)
        }
        "rounded-box" => {
            let shape = RoundedBox {
                radii: v.lengths("radii", [30.0, 20.0, 15.0])?,
                radius: v.length("radius", 8.0)?,
            };
            v.require(shape.radii.iter().all(|&r| r > shape.radius), "each of radii must exceed radius")?;
            Box::new(shape)
        }
        "shell" => {
            let shell = Shell { radius: v.length("radius", 25.0)?, inner: v.length("inner", 15.0)? };
            v.require(shell.inner < shell.radius, "inner must be less than radius")?;
            Box::new(shell)
        }
        "two-balls" => {
            let balls = TwoBalls { radius: v.length("radius", 15.0)?, length: v.length("length", 45.0)? };
            v.require(
                balls.length != 2.0 * balls.radius,
                "length must not be two radii: balls that touch have no surface",
            )?;
            Box::new(balls)
        }
        "genus" => Box::new(Genus {
            genus: v.count("genus", 3)?,
            major: v.length("major", 12.0)?,
            minor: v.length("minor", 8.0)?,
        }),
        "gyroid" => periodic(v, MinimalSurface::Gyroid)?,
        "schwarz-p" => periodic(v, MinimalSurface::SchwarzP)?,
        "femur" => Box::new(Bone::proximal_femur(v.count("individual", 1)?)),
        "vertebra" => {
            let (individual, holes) = (v.count("individual", 1)?, v.count("holes", 1)?);
            v.require(holes == 1 || holes == 2, "holes must be 1, or 2 for another one in a process")?;
            Box::new(Bone::lumbar_vertebra(individual, holes == 2))
        }
        _ => return Err(ParsePhantomError::UnknownName(v.name.clone())),
    })
}

fn periodic(v: &mut Values, surface: MinimalSurface) -> Result<Box<dyn Shape>, ParsePhantomError> {
    let shape = Periodic { surface, period: v.length("period", 40.0)?, size: v.length("size", 60.0)? };
    v.require(shape.size >= shape.period, "size must be at least one period")?;
    Ok(Box::new(shape))
}

/// Key-value pairs of which each must be asked for.
struct Values {
    name: String,
    given: BTreeMap<String, String>,
    known: Vec<&'static str>,
}

impl Values {
    fn parse(name: &str, query: &str) -> Result<Self, ParsePhantomError> {
        let mut given = BTreeMap::new();
        for pair in query.split('&').filter(|pair| !pair.is_empty()) {
            let (key, value) = pair.split_once('=').unwrap_or((pair, ""));
            if given.insert(key.to_owned(), value.to_owned()).is_some() {
                let expected = "each key once";
                return Err(ParsePhantomError::BadValue {
                    key: key.to_owned(),
                    value: value.to_owned(),
                    expected,
                });
            }
        }
        Ok(Self { name: name.to_owned(), given, known: Vec::new() })
    }

    fn take<T>(
        &mut self,
        key: &'static str,
        default: T,
        expected: &'static str,
        parse: impl Fn(&str) -> Option<T>,
    ) -> Result<T, ParsePhantomError> {
        self.known.push(key);
        match self.given.remove(key) {
            None => Ok(default),
            Some(value) => {
                parse(&value).ok_or(ParsePhantomError::BadValue { key: key.to_owned(), value, expected })
            }
        }
    }

    fn length(&mut self, key: &'static str, default: f64) -> Result<f64, ParsePhantomError> {
        self.take(key, default, "a positive length in mm", positive)
    }

    fn lengths(&mut self, key: &'static str, default: [f64; 3]) -> Result<[f64; 3], ParsePhantomError> {
        self.take(key, default, "three positive lengths in mm, a,b,c", |text| three(text, positive))
    }

    fn triple(&mut self, key: &'static str, default: [f64; 3]) -> Result<[f64; 3], ParsePhantomError> {
        self.take(key, default, "three numbers, x,y,z", |text| three(text, finite))
    }

    fn count(&mut self, key: &'static str, default: u32) -> Result<u32, ParsePhantomError> {
        self.take(key, default, "a whole number from 0 to 1000", |t| t.parse().ok().filter(|&n| n <= 1000))
    }

    fn require(&self, met: bool, reason: &'static str) -> Result<(), ParsePhantomError> {
        if met { Ok(()) } else { Err(ParsePhantomError::Impossible { name: self.name.clone(), reason }) }
    }

    fn finish(self) -> Result<(), ParsePhantomError> {
        match self.given.into_keys().next() {
            None => Ok(()),
            Some(key) => {
                let keys: Vec<_> =
                    self.known.into_iter().filter(|k| !POSE_KEYS.contains(k)).chain(POSE_KEYS).collect();
                Err(ParsePhantomError::UnknownKey { name: self.name, key, keys: keys.join(", ") })
            }
        }
    }
}

fn finite(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|v: &f64| v.is_finite())
}

fn positive(text: &str) -> Option<f64> {
    finite(text).filter(|&v| v > 0.0)
}

fn three(text: &str, parse: impl Fn(&str) -> Option<f64>) -> Option<[f64; 3]> {
    let parts: Vec<f64> = text.split(',').map(parse).collect::<Option<_>>()?;
    parts.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_has_defaults() {
        for name in NAMES {
            let phantom = Phantom::from_spec(&format!("phantom:{name}")).unwrap();
            assert!(phantom.grid().voxel_count() > 10_000, "{name}");
        }
    }

    #[test]
    fn refusals_say_what_is_accepted() {
        let message = |spec: &str| Phantom::from_spec(spec).err().expect(spec).to_string();
        assert!(message("phantom:cube").contains("ball, ellipsoid"));
        assert!(message("phantom:bal").contains("did you mean ball"));
        assert!(message("phantom:ball?raduis=10").contains("no key `raduis`; did you mean radius? it takes"));
        assert!(
            message("phantom:ball?radii=1,2,3").contains("it takes radius, spacing, rotate, shift, jitter")
        );
        assert!(message("phantom:ball?radius=-1").contains("a positive length"));
        assert!(message("phantom:ball?spacing=1,1").contains("three numbers"));
        assert!(message("phantom:ball?spacing=1,0,1").contains("spacing along axis 1 is 0"));
        assert!(message("phantom:torus?major=5&minor=6").contains("minor must be less"));
        for huge in ["radius=1e9", "radius=1e300", "shift=1e300,0,0"] {
            assert!(message(&format!("phantom:ball?{huge}")).contains("voxels would take days"), "{huge}");
        }
        assert!(message("phantom:ball?radius=5&radius=6").contains("each key once"));
    }
}
