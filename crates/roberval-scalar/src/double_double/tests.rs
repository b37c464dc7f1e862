use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};

use super::*;
use crate::{LinearInPi, Quantity, Real, SplitMix64};

/// The proven bounds (Joldes, Muller, Popescu 2017) are 3, 5 and 10 times 2^-106, up to
/// terms of third order; the same for all three here.
const BOUND: f64 = 4.0 / (1_u128 << 104) as f64;

/// Bits of the series in fractions that check the trigonometry.
const REFERENCE_BITS: u32 = 400;

fn random_double(random: &mut SplitMix64) -> f64 {
    random.uniform(-1.0, 1.0) * 2_f64.powi(random.below(200) as i32 - 100)
}

/// Pairs whose low part is full, small, of either sign, or zero.
fn random_pair(random: &mut SplitMix64) -> DoubleDouble {
    let high = random_double(random);
    let gap = 2_f64.powi(-54 - random.below(60) as i32);
    match random.below(4) {
        0 => high.into(),
        _ => exact_sum(high, high * gap * random.uniform(-1.0, 1.0)),
    }
}

fn relative_error(found: DoubleDouble, exact: &BigRational) -> f64 {
    let error = found.to_rational() - exact;
    if error.is_zero() {
        return 0.0;
    }
    nearest_double(&(error.abs() / exact.abs()))
}

#[test]
fn sums_products_and_quotients_are_right_to_a_few_times_two_to_minus_104() {
    let mut random = SplitMix64::new(1);
    let mut worst = [0.0_f64; 4];
    for _ in 0..20_000 {
        let a = random_pair(&mut random);
        let mut b = random_pair(&mut random);
        if random.below(4) == 0 {
            b = exact_sum(-a.high, a.high * random.uniform(-1e-10, 1e-10));
        }
        let (x, y) = (a.to_rational(), b.to_rational());
        let errors = [
            relative_error(a + b, &(&x + &y)),
            relative_error(a - b, &(&x - &y)),
            relative_error(a * b, &(&x * &y)),
            relative_error(a / b, &(&x / &y)),
        ];
        for (worst, error) in worst.iter_mut().zip(errors) {
            *worst = worst.max(error);
        }
    }
    assert!(worst.iter().all(|e| *e < BOUND), "{worst:?}");
}

#[test]
fn results_are_pairs_without_overlap() {
    let mut random = SplitMix64::new(2);
    for _ in 0..20_000 {
        let (a, b) = (random_pair(&mut random), random_pair(&mut random));
        for x in [a + b, a - b, a * b, a / b, a.abs().sqrt()] {
            assert_eq!(x.high + x.low, x.high, "{x:?}");
        }
    }
}

#[test]
fn the_fused_and_the_split_product_are_the_same_and_exact() {
    let mut random = SplitMix64::new(3);
    for _ in 0..20_000 {
        let (a, b) = (random_double(&mut random), random_double(&mut random));
        let product = split_product(a, b);
        assert_eq!(product, fused_product(a, b));
        let exact = DoubleDouble::from(a).to_rational() * DoubleDouble::from(b).to_rational();
        assert_eq!(product.to_rational(), exact);
    }
}

#[test]
fn the_square_of_a_square_root_is_the_number() {
    let mut random = SplitMix64::new(4);
    for _ in 0..5000 {
        let x = random_pair(&mut random).abs();
        let root = x.sqrt().to_rational();
        // The relative error of the square is twice that of the root.
        let error = (&root * &root / x.to_rational()) - BigRational::one();
        assert!(nearest_double(&error.abs()) < 2.0 * BOUND, "{x:?}");
    }
    assert_eq!(DoubleDouble::ZERO.sqrt(), DoubleDouble::ZERO);
    assert_eq!(DoubleDouble::from(6.25).sqrt(), 2.5.into());
}

/// pi as a fraction: Euler's `20 atan(1/7) + 8 atan(3/79)`, not the formula of the code.
fn pi() -> BigRational {
    let atan = |n: i64, d: i64| {
        let x = BigRational::new(n.into(), d.into());
        let (mut power, mut sum) = (x.clone(), BigRational::zero());
        for k in 0..REFERENCE_BITS as i64 / 5 {
            let term = &power / BigInt::from(2 * k + 1);
            sum = if k % 2 == 0 { sum + term } else { sum - term };
            power = power * &x * &x;
        }
        sum
    };
    atan(1, 7) * BigInt::from(20) + atan(3, 79) * BigInt::from(8)
}

/// cos + i sin by the exponential series of i x/2^8, squared eight times, in fractions
/// cut to a common denominator: nothing is shared with the code.
fn reference(x: &BigRational) -> (BigRational, BigRational) {
    let scale = BigInt::one() << REFERENCE_BITS;
    let cut = |x: BigRational| BigRational::new((x * &scale).to_integer(), scale.clone());
    let halvings = 8 + x.abs().to_integer().bits() as u32;
    let small = x / (BigInt::one() << halvings);
    let (mut re, mut im) = (BigRational::one(), BigRational::zero());
    let (mut tre, mut tim) = (BigRational::one(), BigRational::zero());
    for k in 1..60 {
        let divisor = BigInt::from(k);
        (tre, tim) = (
            cut(-&tim * &small / &divisor),
            cut(&tre * &small / &divisor),
        );
        re += &tre;
        im += &tim;
    }
    for _ in 0..halvings {
        (re, im) = (cut(&re * &re - &im * &im), cut(&re * &im * BigInt::from(2)));
    }
    (re, im)
}

fn linear(rational: BigRational, half_turns: BigRational) -> LinearInPi {
    LinearInPi {
        rational,
        half_turns,
    }
}

fn random_fraction(random: &mut SplitMix64) -> BigRational {
    let digits = random.next_u64() as i64 >> (1 + random.below(60));
    let exponent = random.below(18) as u32;
    BigRational::new(digits.into(), BigInt::from(10).pow(exponent))
}

#[test]
fn cosines_and_sines_are_those_of_the_series() {
    let (pi, mut random) = (pi(), SplitMix64::new(5));
    for round in 0..400 {
        let mut rational = random_fraction(&mut random);
        let mut half_turns = random_fraction(&mut random);
        match round % 4 {
            0 => rational = BigRational::zero(),
            1 => half_turns = BigRational::zero(),
            _ => {}
        }
        let right = (&half_turns * BigInt::from(2)).is_integer();
        if right && rational.is_zero() {
            continue; // exact, where the reference has noise: see below
        }
        let (cos, sin) = reference(&(&rational + &half_turns * &pi));
        let (c, s) = DoubleDouble::cos_sin(&linear(rational.clone(), half_turns.clone()));
        let errors = (relative_error(c, &cos), relative_error(s, &sin));
        assert!(
            errors.0 < BOUND && errors.1 < BOUND,
            "{rational} + {half_turns} pi: {errors:?}"
        );
    }
}

#[test]
fn angles_next_to_a_multiple_of_a_right_angle_lose_no_digit() {
    let pi = pi();
    for digits in [5, 10, 16, 30, 60] {
        // pi/2 and 100 pi cut after some decimals: the cosine or sine is the rest.
        for (factor, is_cosine) in [((1, 2), true), ((100, 1), false)] {
            let exact = &pi * BigRational::new(factor.0.into(), factor.1.into());
            let scale = BigInt::from(10).pow(digits);
            let cut = BigRational::new((&exact * &scale).to_integer(), scale);
            let (cos, sin) = DoubleDouble::cos_sin(&linear(cut.clone(), BigRational::zero()));
            let rest = exact - cut;
            let cube = &rest * &rest * &rest / BigInt::from(6);
            let fifth = &cube * &rest * &rest / BigInt::from(20);
            let seventh = &fifth * &rest * &rest / BigInt::from(42);
            let sine = rest - cube + fifth - seventh;
            let found = if is_cosine { cos } else { -sin };
            assert!(relative_error(found, &sine) < BOUND, "{digits} digits");
        }
    }
}

#[test]
fn right_angles_are_exact_and_a_huge_angle_is_reduced_exactly() {
    let quarter = |k: i64| linear(BigRational::zero(), BigRational::new(k.into(), 2.into()));
    let exact = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)];
    for k in -9_i64..9 {
        let (c, s) = DoubleDouble::cos_sin(&quarter(k));
        let expected = exact[k.rem_euclid(4) as usize];
        assert_eq!((c.to_f64(), s.to_f64()), expected, "{k} quarter turns");
        assert_eq!((c.low(), s.low()), (0.0, 0.0));
    }
    // Payne and Hanek's example: the double nearest to a multiple of pi/2.
    let hard = BigRational::from_float(6381956970095103.0 * 2_f64.powi(797)).expect("finite");
    let (cos, _) = DoubleDouble::cos_sin(&linear(hard, BigRational::zero()));
    assert_eq!(cos.to_f64(), -4.687_165_924_254_628e-19);
}

#[test]
fn expressions_have_the_value_of_their_exact_form() {
    let value = |text: &str| {
        let quantity = Quantity::parse_number(text, &[]).expect("an expression");
        DoubleDouble::of_quantity(&quantity, &[]).expect("finite")
    };
    let third = BigRational::new(1.into(), 3.into());
    assert!(relative_error(value("1/3"), &third) < BOUND);
    assert!(relative_error(value("pi/3"), &(pi() / BigInt::from(3))) < BOUND);
    // Nearly nothing is left, and that with all digits.
    let rest = pi() - BigRational::new(314_159_265_358_979_i64.into(), BigInt::from(10).pow(14));
    assert!(relative_error(value("pi - 3.14159265358979"), &rest) < BOUND);
    let square = value("sqrt(2)*sqrt(5)").to_rational().pow(2);
    assert!(relative_error(DoubleDouble::nearest(&square), &BigInt::from(10).into()) < 4.0 * BOUND);
    assert!(relative_error(value("pi*pi"), &(pi() * pi())) < 2.0 * BOUND);
    let zero = Quantity::parse_number("1/(0.1+0.2-0.3)", &[]).expect("finite in doubles");
    assert_eq!(
        DoubleDouble::of_quantity(&zero, &[]),
        None,
        "divides by zero"
    );
}
