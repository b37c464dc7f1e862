//! One lane: a plain float, where there is nothing better.

use super::Lanes;

impl Lanes for f64 {
    const COUNT: usize = 1;

    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        from[0]
    }

    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        to[0] = self;
    }

    #[inline(always)]
    fn numbers(lanes: &mut [Self]) -> &mut [f64] {
        lanes
    }

    #[inline(always)]
    fn divide(self, by: Self) -> Self {
        self / by
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn with_sign_of(self, sign: Self) -> Self {
        self.copysign(sign)
    }

    #[inline(always)]
    fn where_nonzero(self, test: Self) -> Self {
        if test == 0.0 { 0.0 } else { self }
    }

    #[inline(always)]
    fn is_zero(self) -> bool {
        self == 0.0
    }

    #[inline(always)]
    fn sin_cos<const N: usize>(x: [Self; N]) -> [(Self, Self); N] {
        x.map(f64::sin_cos)
    }
}
