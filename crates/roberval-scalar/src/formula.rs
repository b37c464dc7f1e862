//! Expressions of joint variables: how a joint follows from others where it does so by
//! no sum of multiples.

mod jet;
mod parse;

use crate::{LiteralError, Quantity};

pub use jet::Jet;

/// An expression of joint variables with `+ - * /`, `sin`, `cos`, `atan2` and `sqrt`; V
/// names a variable.
#[derive(Debug, Clone, PartialEq)]
pub enum Formula<V> {
    /// A number.
    Constant(Quantity),
    /// The variable of a joint (rad or m).
    Joint(V),
    /// -a
    Neg(Box<Self>),
    /// a + b
    Add(Box<Self>, Box<Self>),
    /// a - b
    Sub(Box<Self>, Box<Self>),
    /// a b
    Mul(Box<Self>, Box<Self>),
    /// a / b
    Div(Box<Self>, Box<Self>),
    /// sin a
    Sin(Box<Self>),
    /// cos a
    Cos(Box<Self>),
    /// The square root of a.
    Sqrt(Box<Self>),
    /// The angle of the point (x, y), given as y, x.
    Atan2(Box<Self>, Box<Self>),
}

impl Formula<String> {
    /// Reads an expression such as `atan2(sin(q.2), 1 + cos(q["left arm"]))`; `constants` may
    /// be named in it.
    ///
    /// # Errors
    /// [`LiteralError`] with the place and what would be right.
    pub fn parse(text: &str, constants: &[(String, Quantity)]) -> Result<Self, LiteralError> {
        parse::formula(text, constants)
    }
}

impl<V> Formula<V> {
    /// The same with other names of its variables.
    ///
    /// # Errors
    /// The first error of `name`.
    pub fn rename<W, E>(&self, name: &mut impl FnMut(&V) -> Result<W, E>) -> Result<Formula<W>, E> {
        let mut one = |a: &Self| Ok::<_, E>(Box::new(a.rename(name)?));
        Ok(match self {
            Self::Constant(x) => Formula::Constant(x.clone()),
            Self::Neg(a) => Formula::Neg(one(a)?),
            Self::Sin(a) => Formula::Sin(one(a)?),
            Self::Cos(a) => Formula::Cos(one(a)?),
            Self::Sqrt(a) => Formula::Sqrt(one(a)?),
            Self::Add(a, b) => Formula::Add(one(a)?, one(b)?),
            Self::Sub(a, b) => Formula::Sub(one(a)?, one(b)?),
            Self::Mul(a, b) => Formula::Mul(one(a)?, one(b)?),
            Self::Div(a, b) => Formula::Div(one(a)?, one(b)?),
            Self::Atan2(a, b) => Formula::Atan2(one(a)?, one(b)?),
            Self::Joint(v) => Formula::Joint(name(v)?),
        })
    }

    /// The variables in it, each as often as it occurs.
    pub fn joints(&self) -> Vec<&V> {
        let leaves = self.leaves().into_iter();
        leaves
            .filter_map(|leaf| match leaf {
                Self::Joint(v) => Some(v),
                _ => None,
            })
            .collect()
    }

    /// The numbers in it, each as often as it occurs.
    pub fn constants(&self) -> Vec<&Quantity> {
        let leaves = self.leaves().into_iter();
        leaves
            .filter_map(|leaf| match leaf {
                Self::Constant(x) => Some(x),
                _ => None,
            })
            .collect()
    }

    fn leaves(&self) -> Vec<&Self> {
        match self {
            Self::Constant(_) | Self::Joint(_) => vec![self],
            Self::Neg(a) | Self::Sin(a) | Self::Cos(a) | Self::Sqrt(a) => a.leaves(),
            Self::Add(a, b)
            | Self::Sub(a, b)
            | Self::Mul(a, b)
            | Self::Div(a, b)
            | Self::Atan2(a, b) => [a.leaves(), b.leaves()].concat(),
        }
    }
}
