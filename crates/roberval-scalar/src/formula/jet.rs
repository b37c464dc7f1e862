use crate::{Formula, Quantity, Real};

/// A quantity on its way: its value, its first and second derivative by time, and its
/// gradient by the independent coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct Jet<T> {
    /// q
    pub value: T,
    /// qd
    pub rate: T,
    /// qdd
    pub second: T,
    /// The row of G.
    pub gradient: Vec<T>,
}

impl<T: Real> Jet<T> {
    fn constant(value: T, width: usize) -> Self {
        let zero = T::from(0.0);
        Self {
            value,
            rate: zero,
            second: zero,
            gradient: vec![zero; width],
        }
    }

    /// f of it, from the values of f, f' and f''.
    fn chain(&self, [f, df, ddf]: [T; 3]) -> Self {
        Self {
            value: f,
            rate: df * self.rate,
            second: ddf * self.rate * self.rate + df * self.second,
            gradient: self.gradient.iter().map(|&g| df * g).collect(),
        }
    }

    /// a self + b other
    fn combined(&self, a: T, other: &Self, b: T) -> Self {
        let sum = |x: T, y: T| a * x + b * y;
        let gradients = self.gradient.iter().zip(&other.gradient);
        Self {
            value: sum(self.value, other.value),
            rate: sum(self.rate, other.rate),
            second: sum(self.second, other.second),
            gradient: gradients.map(|(&x, &y)| sum(x, y)).collect(),
        }
    }

    fn times(&self, other: &Self) -> Self {
        let mut product = self.combined(other.value, other, self.value);
        product.value = self.value * other.value;
        let cross = self.rate * other.rate;
        product.second = product.second + cross + cross;
        product
    }

    fn reciprocal(&self) -> Self {
        let one = T::from(1.0);
        let inverse = one / self.value;
        let square = inverse * inverse;
        self.chain([inverse, -square, (square + square) * inverse])
    }

    fn sqrt(&self) -> Self {
        let root = self.value.sqrt();
        let half = T::from(0.5) / root;
        self.chain([root, half, -half / (self.value + self.value)])
    }

    /// The angle of the point (x, self): its differential is (x dy - y dx) / (x x + y y).
    fn atan2(&self, x: &Self) -> Self {
        let y = self;
        let square = x.value * x.value + y.value * y.value;
        let inverse = T::from(1.0) / square;
        let mut angle = y.combined(x.value * inverse, x, -y.value * inverse);
        angle.value = y.value.atan2(x.value);
        let growth = (x.value * x.rate + y.value * y.rate) * inverse;
        angle.second = angle.second - (growth + growth) * angle.rate;
        angle
    }
}

impl Formula<usize> {
    /// The expression where the variables move as `joints` says; `value` gives the value of
    /// a number, `width` is the number of independent coordinates. Not finite where the
    /// expression has no value or no derivatives.
    pub fn jet<T: Real>(
        &self,
        joints: &[Jet<T>],
        value: &impl Fn(&Quantity) -> Option<T>,
        width: usize,
    ) -> Jet<T> {
        let jet = |a: &Self| a.jet(joints, value, width);
        let one = T::from(1.0);
        match self {
            Self::Constant(x) => {
                let x = value(x).unwrap_or_else(|| T::from(f64::NAN));
                Jet::constant(x, width)
            }
            Self::Joint(variable) => joints[*variable].clone(),
            Self::Neg(a) => {
                let a = jet(a);
                a.chain([-a.value, -one, T::from(0.0)])
            }
            Self::Add(a, b) => jet(a).combined(one, &jet(b), one),
            Self::Sub(a, b) => jet(a).combined(one, &jet(b), -one),
            Self::Mul(a, b) => jet(a).times(&jet(b)),
            Self::Div(a, b) => jet(a).times(&jet(b).reciprocal()),
            Self::Sin(a) => {
                let a = jet(a);
                let (cos, sin) = a.value.cos_sin();
                a.chain([sin, cos, -sin])
            }
            Self::Cos(a) => {
                let a = jet(a);
                let (cos, sin) = a.value.cos_sin();
                a.chain([cos, -sin, -cos])
            }
            Self::Sqrt(a) => jet(a).sqrt(),
            Self::Atan2(y, x) => jet(y).atan2(&jet(x)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DoubleDouble;

    const TEXT: &str =
        "atan2(sin(q.0) - 0.3, 2 + cos(q.1)*q.0) / (1.5 + q.1*q.1) - sqrt(3 + q.0)*-q.1";

    fn formula() -> Formula<usize> {
        let read = Formula::parse(TEXT, &[]).expect("an expression");
        read.rename(&mut |name: &String| name.parse::<usize>())
            .expect("numbers")
    }

    /// On q = (0.4 + 0.7 t + 0.1 t t, -0.8 + 0.2 t - 0.45 t t).
    fn at<T: Real>(t: f64) -> Jet<T> {
        let joint = |k: usize, a: f64, b: f64, c: f64| Jet {
            value: T::from(a) + T::from(t) * T::from(b) + T::from(t) * T::from(t) * T::from(c),
            rate: T::from(b) + T::from(2.0 * t) * T::from(c),
            second: T::from(2.0) * T::from(c),
            gradient: (0..2)
                .map(|i| T::from(f64::from(u8::from(i == k))))
                .collect(),
        };
        let joints = [joint(0, 0.4, 0.7, 0.1), joint(1, -0.8, 0.2, -0.45)];
        formula().jet(&joints, &|x| T::of_quantity(x, &[]), 2)
    }

    #[test]
    fn derivatives_are_those_of_central_differences_in_pairs_of_doubles() {
        // Truncation h^2, rounding 1e-32 / h^2: both below 1e-14.
        let h = 1e-8;
        let [before, now, after] = [-h, 0.0, h].map(at::<DoubleDouble>);
        let rate = (after.value - before.value) / DoubleDouble::from(2.0 * h);
        assert!((rate - now.rate).abs().to_f64() < 1e-14);
        let second = (after.rate - before.rate) / DoubleDouble::from(2.0 * h);
        assert!((second - now.second).abs().to_f64() < 1e-14);
        let along =
            now.gradient[0] * DoubleDouble::from(0.7) + now.gradient[1] * DoubleDouble::from(0.2);
        assert!((along - now.rate).abs().to_f64() < 1e-30);
    }

    #[test]
    fn doubles_give_the_same_to_their_precision() {
        let (float, pair) = (at::<f64>(0.3), at::<DoubleDouble>(0.3));
        let close = |a: f64, b: DoubleDouble| (a - b.to_f64()).abs() < 1e-14;
        assert!(close(float.value, pair.value) && close(float.rate, pair.rate));
        assert!(close(float.second, pair.second));
    }

    #[test]
    fn an_expression_without_a_value_is_not_finite() {
        let formula = Formula::parse("sqrt(0 - 1) + 1/0", &[]).expect("an expression");
        let formula = formula
            .rename(&mut |n: &String| n.parse::<usize>())
            .expect("none");
        let jet = formula.jet::<f64>(&[], &|x| Some(x.value), 1);
        assert!(!jet.value.is_finite());
    }
}
