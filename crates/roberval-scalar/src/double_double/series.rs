//! Cosine and sine of pairs of doubles, to about 1e-31: a hundred times faster than in
//! integers.

use std::sync::LazyLock;

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Zero};

use super::{DoubleDouble, exact_product};
use crate::{LinearInPi, Scalar};

/// Angles of more quarter turns than this are left to integers.
const MOST_QUARTERS: f64 = 1e6;

/// Terms of either series: (pi/4)^29/29! is 1e-34.
const TERMS: usize = 14;

/// pi/2 in three doubles, and 1/k!.
struct Table {
    quarter: [f64; 3],
    inverse_factorials: [DoubleDouble; 2 * TERMS],
}

static TABLE: LazyLock<Table> = LazyLock::new(|| {
    let quarter = LinearInPi {
        rational: BigRational::zero(),
        half_turns: BigRational::new(BigInt::one(), 2.into()),
    };
    // The third double from a multiple whose pair of doubles begins where the pair ends.
    let pair = DoubleDouble::of_linear(&quarter);
    let rest = LinearInPi {
        rational: -pair.to_rational(),
        ..quarter
    };
    let mut factorial = BigInt::one();
    let inverse_factorials = std::array::from_fn(|k| {
        factorial *= BigInt::from(k.max(1));
        DoubleDouble::nearest(&BigRational::new(BigInt::one(), factorial.clone()))
    });
    Table {
        quarter: [pair.high, pair.low, DoubleDouble::of_linear(&rest).high],
        inverse_factorials,
    }
});

impl DoubleDouble {
    /// Cosine and sine by their series; `None` for angles of very many turns.
    pub(crate) fn cos_sin_by_series(self) -> Option<(Self, Self)> {
        let table = &*TABLE;
        let quarters = (self.high / table.quarter[0]).round();
        if quarters.abs() > MOST_QUARTERS {
            return None;
        }
        let x = table
            .quarter
            .iter()
            .fold(self, |x, &part| x - exact_product(quarters, part));
        let square = x * x;
        let series = |first: usize| {
            let terms = (0..TERMS)
                .rev()
                .map(|k| (k, table.inverse_factorials[2 * k + first]));
            terms.fold(Self::ZERO, |sum, (k, term)| {
                let term = if k % 2 == 0 { term } else { -term };
                sum.mul_add(square, term)
            })
        };
        let (cos, sin) = (series(0), x * series(1));
        Some(match quarters.rem_euclid(4.0) as u8 {
            0 => (cos, sin),
            1 => (-sin, cos),
            2 => (-cos, -sin),
            _ => (sin, -cos),
        })
    }
}
