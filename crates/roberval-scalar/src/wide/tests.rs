use num_traits::Signed;

use super::*;
use crate::{DoubleDouble, SplitMix64};

/// One unit in the last place, and the few that functions may miss by.
const UNIT: u64 = 448;

fn random_wide(random: &mut SplitMix64) -> Wide {
    let high = Wide::from(random.uniform(-1.0, 1.0) * 2_f64.powi(random.below(60) as i32 - 30));
    let low = (1..8).map(|k| Wide::from(random.uniform(-1.0, 1.0) * 2_f64.powi(-53 * k)));
    low.fold(high, |sum, x| sum + x)
}

/// |found - exact| in units in the last place.
fn units(found: Wide, exact: &BigRational) -> f64 {
    let error = (found.to_rational() - exact).abs();
    nearest_double(&(error * BigRational::from(BigInt::one() << UNIT)))
}

fn linear(rational: BigRational, half_turns: BigRational) -> LinearInPi {
    LinearInPi {
        rational,
        half_turns,
    }
}

#[test]
fn sums_are_exact_and_products_and_quotients_right_to_the_last_digit() {
    let mut random = SplitMix64::new(1);
    for _ in 0..400 {
        let [a, b] = [0; 2].map(|_| random_wide(&mut random));
        let [x, y] = [a, b].map(Wide::to_rational);
        assert_eq!(units(a + b, &(&x + &y)), 0.0);
        assert_eq!(units(a - b, &(&x - &y)), 0.0);
        assert!(units(a * b, &(&x * &y)) < 1.0);
        assert!(units(a / b, &(&x / &y)) < 1.0);
        assert_eq!((a - b).is_negative(), x < y);
        assert_eq!(a.abs().exceeds(&b.abs()), x.abs() > y.abs());
        let root = a.abs().sqrt();
        let next = root + Wide::units(0);
        let square = |r: Wide| r.to_rational() * r.to_rational();
        assert!(square(root) <= x.abs() && square(next) > x.abs());
    }
}

#[test]
fn doubles_go_in_and_come_out_as_they_are() {
    let mut random = SplitMix64::new(2);
    for _ in 0..300 {
        let x = random.uniform(-1.0, 1.0) * 2_f64.powi(random.below(300) as i32 - 200);
        assert_eq!(Wide::from(x).to_f64(), x);
    }
    assert_eq!(Wide::from(0.0), Wide::ZERO);
    assert!(Wide::ZERO.is_zero() && (Wide::from(1.0) / Wide::ZERO).is_zero());
    assert_eq!(Wide::units(UNIT).to_f64(), 1.0);
}

#[test]
fn cosines_and_sines_are_those_of_pairs_of_doubles_and_of_the_circle() {
    let mut random = SplitMix64::new(3);
    for k in 0..60 {
        let radians = BigRational::new(random.below(1 << 40).into(), BigInt::from(10).pow(9));
        let angle = linear(radians, BigRational::new((k - 30).into(), 12.into()));
        let (cos, sin) = Wide::cos_sin_of_linear(&angle);
        let (c, s) = DoubleDouble::cos_sin(&angle);
        assert_eq!((cos.to_f64(), sin.to_f64()), (c.to_f64(), s.to_f64()));
        let one = BigRational::one();
        assert!(units(cos * cos + sin * sin, &one) < 8.0, "{angle:?}");
        let half = (
            &angle.rational / BigInt::from(2),
            &angle.half_turns / BigInt::from(2),
        );
        let (c, s) = Wide::cos_sin_of_linear(&linear(half.0, half.1));
        assert!(units(c * c - s * s, &cos.to_rational()) < 16.0, "{angle:?}");
        assert!(units(s * c + s * c, &sin.to_rational()) < 16.0, "{angle:?}");
        let again = sin.atan2(cos);
        let (c, s) = again.cos_sin();
        assert!(units(c, &cos.to_rational()) < 16.0 && units(s, &sin.to_rational()) < 16.0);
    }
}

#[test]
fn right_angles_are_exact_and_their_roundings_are_not() {
    let right = |k: i64| linear(BigRational::zero(), BigRational::new(k.into(), 2.into()));
    let one = Wide::from(1.0);
    assert_eq!(Wide::cos_sin_of_linear(&right(1)), (Wide::ZERO, one));
    assert_eq!(Wide::cos_sin_of_linear(&right(-2)), (-one, Wide::ZERO));
    let rounded = Quantity::parse_angle("1.5707963267948966", &[]).expect("an angle");
    let (cos, _) = Wide::cos_sin_of_quantity(&rounded, &[]).expect("finite");
    // What the digits of pi/2 go on with.
    let rest: f64 = "1.923132169163975144209858469968755e-17"
        .parse()
        .expect("a float");
    assert_eq!(cos.to_f64(), rest);
}

#[test]
fn expressions_have_the_value_of_their_exact_form() {
    let value = |text: &str| {
        let quantity = Quantity::parse_number(text, &[]).expect("an expression");
        Wide::of_quantity(&quantity, &[])
    };
    let third = BigRational::new(1.into(), 3.into());
    assert!(units(value("1/3").expect("finite"), &third) < 1.0);
    let five = BigRational::from(BigInt::from(5));
    let root = value("sqrt(2)*sqrt(5)/sqrt(2)").expect("finite");
    assert!(units(root * root, &five) < 64.0);
    assert_eq!(value("1/(0.1+0.2-0.3)"), None, "divides by zero");
}
