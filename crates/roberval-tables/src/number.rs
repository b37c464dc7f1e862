//! Numbers for people.

/// Twelve significant digits round away what floats add to decimals
/// (0.29039999999999994 is 0.2904) and keep every digit that a robot file has.
const DIGITS: usize = 12;

/// `x` rounded to twelve significant digits.
pub(crate) fn rounded(x: f64) -> f64 {
    let text = format!("{x:.*e}", DIGITS - 1);
    text.parse().unwrap_or(x)
}

/// The shortest decimal of `x` rounded to twelve significant digits.
pub(crate) fn shortest(x: f64) -> String {
    let x = rounded(x) + 0.0; // no negative zero
    if x != 0.0 && !(1e-4..1e9).contains(&x.abs()) {
        format!("{x:e}")
    } else {
        format!("{x}")
    }
}

/// A sum, or 0 where all that its terms have left of it is their rounding.
pub(crate) fn without_dust(sum: f64, largest_term: f64) -> f64 {
    /// Half a unit of the last of the twelve digits.
    const DUST: f64 = 0.5e-12;
    if sum.abs() <= DUST * largest_term {
        0.0
    } else {
        sum
    }
}

/// `1.2345e-05`: numbers of a column have the same width.
pub(crate) fn scientific(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return shortest(x);
    }
    let text = format!("{x:.4e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    format!("{mantissa}e{exponent:+03}")
}

/// The shortest text that reads back as `x`; nothing for what is no number.
pub(crate) fn exact(x: f64) -> String {
    if x.is_finite() {
        format!("{:?}", x + 0.0)
    } else {
        String::new()
    }
}

/// A size at a glance: `93.2`, `3.1e13`.
pub(crate) fn size(x: f64) -> String {
    if (0.01..10_000.0).contains(&x.abs()) {
        let text = format!("{x:.2e}");
        return shortest(text.parse().unwrap_or(x));
    }
    if x == 0.0 || !x.is_finite() {
        return shortest(x);
    }
    format!("{x:.1e}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_lose_their_float_noise() {
        assert_eq!(shortest(0.29039999999999994), "0.2904");
        assert_eq!(shortest(-0.1 - 0.2), "-0.3");
        assert_eq!(shortest(1.0), "1");
        assert_eq!(shortest(-0.0), "0");
        assert_eq!(shortest(1.0 / 3.0), "0.333333333333");
        assert_eq!(shortest(1.5e-7), "1.5e-7");
        assert_eq!(shortest(2.5e300), "2.5e300");
        assert_eq!(shortest(f64::NAN), "NaN");
        assert_eq!(shortest(f64::MAX), "1.79769313486e308");
    }

    #[test]
    fn sizes_are_short() {
        assert_eq!(
            [93.17, 0.25, 3.14e13, 0.0].map(size),
            ["93.2", "0.25", "3.1e13", "0"]
        );
        assert_eq!(size(f64::INFINITY), "inf");
    }

    #[test]
    fn numbers_in_columns_have_two_digit_exponents() {
        assert_eq!(scientific(68.553), "6.8553e+01");
        assert_eq!(scientific(1.2e-15), "1.2000e-15");
        assert_eq!(scientific(0.0), "0");
        assert_eq!(scientific(f64::INFINITY), "inf");
    }
}
