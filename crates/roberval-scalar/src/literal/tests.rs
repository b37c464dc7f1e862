use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{ToPrimitive, Zero};
use proptest::prelude::*;

use super::*;

fn number(text: &str) -> Quantity {
    Quantity::parse_number(text, &[]).unwrap_or_else(|e| panic!("{text}: {e}"))
}

fn angle(text: &str) -> f64 {
    Quantity::parse_angle(text, &[])
        .unwrap_or_else(|e| panic!("{text}: {e}"))
        .value
}

fn constants(pairs: &[(&str, &str)]) -> Vec<(String, Quantity)> {
    let mut known: Vec<(String, Quantity)> = Vec::new();
    for (name, text) in pairs {
        let value = Quantity::parse_number(text, &known).unwrap();
        known.push(((*name).to_owned(), value));
    }
    known
}

#[test]
fn a_decimal_is_exactly_its_text() {
    let fraction = |p: i64, q: i64| BigRational::new(p.into(), q.into());
    for (text, value) in [
        ("0.29", fraction(29, 100)),
        ("-0.5", fraction(-1, 2)),
        (".5", fraction(1, 2)),
        ("5.", fraction(5, 1)),
        ("+5.00", fraction(5, 1)),
        ("1e-3", fraction(1, 1000)),
        ("2.5E+2", fraction(250, 1)),
        ("-0.0", fraction(0, 1)),
        ("000", fraction(0, 1)),
        (
            "1.5707963267948966",
            fraction(15_707_963_267_948_966, 10_000_000_000_000_000),
        ),
    ] {
        assert_eq!(Decimal::parse(text).unwrap().to_rational(), value, "{text}");
    }
}

#[test]
fn equal_decimals_have_one_form() {
    let one = Decimal::parse("1").unwrap();
    for text in ["1.0", "01", "0.1e1", "100e-2", "+1.000"] {
        assert_eq!(Decimal::parse(text).unwrap(), one, "{text}");
    }
    assert_eq!(Decimal::parse("0e500").unwrap(), Decimal::zero());
}

#[test]
fn a_decimal_at_the_end_of_the_range_reads_back_or_is_refused() {
    // Found by fuzzing: the digits moved the exponent beyond the range.
    for text in [".1e-9999", "10e9999", "1.5e-9999"] {
        let error = Decimal::parse(text).unwrap_err();
        assert_eq!(error.fault, LiteralFault::NotFinite, "{text}");
    }
    for text in ["1e-9999", "10e-9999", "-.5e9999"] {
        let decimal = Decimal::parse(text).unwrap();
        assert_eq!(Decimal::parse(&decimal.to_string()), Ok(decimal), "{text}");
    }
}

#[test]
fn degrees_equal_the_fractions_of_pi() {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_8, PI};
    assert_eq!(angle("-90 deg"), -FRAC_PI_2);
    assert_eq!(angle("180deg"), PI);
    assert_eq!(angle("(45/2) deg"), FRAC_PI_8);
    assert_eq!(angle("45/2 deg"), FRAC_PI_8);
    assert_eq!(angle("-pi/2"), -FRAC_PI_2);
    assert_eq!(angle("3*pi/4"), 3.0 * PI / 4.0);
    assert_eq!(angle("-1.25"), -1.25);
}

#[test]
fn operators_bind_as_in_school() {
    for (text, value) in [
        ("1 + 2*3", 7.0),
        ("10 - 4 - 3", 3.0),
        ("24/4/3", 2.0),
        ("-2*-3", 6.0),
        ("--2", 2.0),
        ("-(1 + 2)", -3.0),
        ("2*(3 + 4)", 14.0),
        ("sqrt(16)/2", 2.0),
        ("+7", 7.0),
        ("-sqrt(9)", -3.0),
    ] {
        assert_eq!(number(text).value, value, "{text}");
    }
}

#[test]
fn constants_may_use_earlier_ones() {
    let known = constants(&[("L", "0.5"), ("L2", "2*L"), ("H_1", "L2 + L")]);
    let length = Quantity::parse_length("H_1/3", &known).unwrap();
    assert_eq!(length.value, 0.5);
    assert_eq!(length.text, "H_1/3");
    assert_eq!(
        length.expr,
        Expr::Div(
            Box::new(Expr::Name("H_1".into())),
            Box::new(Expr::Number(Decimal::parse("3").unwrap()))
        )
    );
}

#[test]
fn a_quantity_keeps_its_text() {
    for text in ["0.290", "-90 deg", "1.5707963267948966", "5.", "1E-3"] {
        let quantity = Quantity::parse_angle(&format!("  {text} "), &[]).unwrap();
        assert_eq!(quantity.to_string(), text);
    }
}

/// What is wrong: the text, the kind of fault, the byte, words of the message.
const FAULTS: &[(&str, LiteralFault, Option<usize>, &[&str])] = &[
    ("", LiteralFault::Syntax, Some(0), &["empty"]),
    ("   ", LiteralFault::Syntax, Some(0), &["empty"]),
    ("1 +", LiteralFault::Syntax, Some(3), &["ends too early"]),
    (
        "(1",
        LiteralFault::Syntax,
        Some(2),
        &["ends too early", ")"],
    ),
    ("1)", LiteralFault::Syntax, Some(1), &["unexpected \")\""]),
    ("1,5", LiteralFault::Syntax, Some(1), &["decimal point"]),
    ("0x10", LiteralFault::Syntax, Some(1), &["hexadecimal"]),
    ("1_000", LiteralFault::Syntax, Some(1), &["without _"]),
    ("2pi", LiteralFault::Syntax, Some(1), &["product with *"]),
    (
        "0.5 m",
        LiteralFault::Syntax,
        Some(4),
        &["unexpected \"m\""],
    ),
    ("5m", LiteralFault::Syntax, Some(1), &["lengths are in m"]),
    ("2**3", LiteralFault::Syntax, Some(1), &["no powers"]),
    ("2^3", LiteralFault::Syntax, Some(1), &["no powers"]),
    ("\u{2212}1", LiteralFault::Syntax, Some(0), &["minus sign"]),
    (
        "\u{ff11}",
        LiteralFault::Syntax,
        Some(0),
        &["expected a number"],
    ),
    ("1e", LiteralFault::Syntax, Some(1), &["exponent"]),
    (
        "1.2.3",
        LiteralFault::Syntax,
        Some(3),
        &["unexpected \".\""],
    ),
    (".", LiteralFault::Syntax, Some(0), &["unexpected \".\""]),
    (
        "sin(1)",
        LiteralFault::Syntax,
        Some(0),
        &["unknown function \"sin\"", "sqrt"],
    ),
    (
        "sqrt 2",
        LiteralFault::Syntax,
        Some(5),
        &["expected ( after sqrt"],
    ),
    (
        "sqrt()",
        LiteralFault::Syntax,
        Some(5),
        &["expected a number"],
    ),
    (
        "deg",
        LiteralFault::Syntax,
        Some(0),
        &["unexpected \"deg\""],
    ),
    (
        "90\u{b0}",
        LiteralFault::Syntax,
        Some(2),
        &["write degrees as deg"],
    ),
    (
        "pi/2 + 45 deg",
        LiteralFault::Syntax,
        Some(10),
        &["(a + b) deg"],
    ),
    (
        "(1)+(2) deg",
        LiteralFault::Syntax,
        Some(8),
        &["(a + b) deg"],
    ),
    (
        "90 deg + 1",
        LiteralFault::Syntax,
        Some(7),
        &["stands at the end"],
    ),
    (
        "1/0",
        LiteralFault::NotFinite,
        None,
        &["division by zero", "1 / 0"],
    ),
    (
        "sqrt(-2)",
        LiteralFault::NotFinite,
        None,
        &["negative", "-2"],
    ),
    (
        "1e999",
        LiteralFault::NotFinite,
        None,
        &["too large for a double"],
    ),
    ("1e300*1e300", LiteralFault::NotFinite, None, &["too large"]),
    (
        "1e99999999999",
        LiteralFault::NotFinite,
        Some(0),
        &["exponent"],
    ),
    ("nan", LiteralFault::NotFinite, Some(0), &["finite"]),
    ("-inf", LiteralFault::NotFinite, Some(1), &["finite"]),
    (
        "D3",
        LiteralFault::UnknownName,
        None,
        &["\"D3\"", "no constants"],
    ),
    ("PI", LiteralFault::UnknownName, None, &["\"PI\""]),
];

#[test]
fn every_fault_says_what_where_and_what_would_be_right() {
    for (text, fault, offset, words) in FAULTS {
        let error = Quantity::parse_angle(text, &[]).unwrap_err();
        assert_eq!(
            (error.fault, error.offset),
            (*fault, *offset),
            "{text}: {error}"
        );
        for word in *words {
            assert!(error.to_string().contains(word), "{text}: {error}");
        }
    }
}

#[test]
fn an_unknown_name_lists_the_known_ones() {
    let known = constants(&[("D3", "0.5"), ("R3", "0.2")]);
    let error = Quantity::parse_length("2*D4", &known).unwrap_err();
    assert_eq!(
        error.to_string(),
        "unknown name \"D4\"; known constants: D3, R3"
    );
}

#[test]
fn only_angles_have_degrees() {
    let error = Quantity::parse_length("90 deg", &[]).unwrap_err();
    assert!(error.to_string().contains("only an angle"), "{error}");
}

#[test]
fn plain_decimals_are_no_expressions() {
    for text in [
        "1+1",
        "pi",
        "1,5",
        "1.5707963,",
        "0x10",
        "1 2",
        "",
        "--1",
        "nan",
        "1e999",
    ] {
        assert!(Quantity::parse_decimal(text).is_err(), "{text}");
    }
    assert_eq!(Quantity::parse_decimal(" -1e-3\n").unwrap().value, -1e-3);
}

#[test]
fn hostile_texts_end_in_a_limit() {
    for text in [
        "(".repeat(900),
        "-".repeat(900),
        "sqrt(".repeat(190),
        "1+".repeat(50_000) + "1",
        "9".repeat(10_000_000),
    ] {
        let error = Quantity::parse_number(&text, &[]).unwrap_err();
        assert_eq!(error.fault, LiteralFault::TooLarge);
        assert!(error.to_string().len() < 200);
    }
    assert_eq!(number(&("1+".repeat(499) + "1")).value, 500.0);
}

#[test]
fn constant_names_are_no_words_of_the_grammar() {
    for name in ["D3", "_x", "Pi", "degree"] {
        assert!(is_constant_name(name), "{name}");
    }
    for name in [
        "", "3D", "a b", "pi", "sqrt", "deg", "NaN", "inf", "a-b", "\u{e9}",
    ] {
        assert!(!is_constant_name(name), "{name}");
    }
}

fn decimal() -> impl Strategy<Value = Decimal> {
    (any::<i64>(), -25i32..25)
        .prop_map(|(digits, power)| Decimal::parse(&format!("{digits}e{power}")).unwrap())
}

/// Trees as the parser makes them: no minus in front of a bare number.
fn tree() -> impl Strategy<Value = Expr> {
    let leaf = prop_oneof![
        4 => decimal().prop_map(Expr::Number),
        1 => Just(Expr::Pi),
        1 => prop_oneof!["[A-Z][a-z0-9_]{0,3}", Just("x".to_owned())].prop_map(Expr::Name),
    ];
    leaf.prop_recursive(6, 40, 2, |inner| {
        let pair = (inner.clone(), inner.clone());
        let boxed = |(a, b): (Expr, Expr)| (Box::new(a), Box::new(b));
        prop_oneof![
            inner
                .clone()
                .prop_filter_map("a sign before a number belongs to it", |a| {
                    (!matches!(a, Expr::Number(_))).then(|| Expr::Neg(Box::new(a)))
                }),
            inner.prop_map(|a| Expr::Sqrt(Box::new(a))),
            pair.clone().prop_map(move |p| {
                let (a, b) = boxed(p);
                Expr::Add(a, b)
            }),
            pair.clone().prop_map(move |p| {
                let (a, b) = boxed(p);
                Expr::Sub(a, b)
            }),
            pair.clone().prop_map(move |p| {
                let (a, b) = boxed(p);
                Expr::Mul(a, b)
            }),
            pair.prop_map(move |p| {
                let (a, b) = boxed(p);
                Expr::Div(a, b)
            }),
        ]
    })
}

/// An independent evaluation: exact fractions, no names, pi or roots.
fn exactly(expr: &Expr) -> Option<BigRational> {
    Some(match expr {
        Expr::Number(x) => x.to_rational(),
        Expr::Neg(a) => -exactly(a)?,
        Expr::Add(a, b) => exactly(a)? + exactly(b)?,
        Expr::Sub(a, b) => exactly(a)? - exactly(b)?,
        Expr::Mul(a, b) => exactly(a)? * exactly(b)?,
        Expr::Div(a, b) => {
            let b = exactly(b)?;
            if b.is_zero() {
                return None;
            }
            exactly(a)? / b
        }
        Expr::Name(_) | Expr::Pi | Expr::Sqrt(_) => return None,
    })
}

/// Small whole numbers: sums and products stay exact in doubles, so both evaluations
/// must agree to the last bit.
fn whole_tree() -> impl Strategy<Value = Expr> {
    let leaf = (-9i64..10).prop_map(|n| Expr::Number(Decimal::parse(&n.to_string()).unwrap()));
    leaf.prop_recursive(4, 16, 2, |inner| {
        (inner.clone(), inner, 0..3).prop_map(|(a, b, kind)| {
            let (a, b) = (Box::new(a), Box::new(b));
            match kind {
                0 => Expr::Add(a, b),
                1 => Expr::Sub(a, b),
                _ => Expr::Mul(a, b),
            }
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn an_expression_reads_back_from_its_text(expr in tree()) {
        let text = expr.to_string();
        prop_assume!(text.len() <= MAX_LITERAL_BYTES);
        prop_assert_eq!(parse::expression(&text, parse::Degrees::Refused).unwrap(), expr);
    }

    #[test]
    fn floats_and_fractions_evaluate_alike(expr in whole_tree()) {
        let exact = exactly(&expr).unwrap().to_f64().unwrap();
        prop_assert_eq!(expr.to_f64(&[]).unwrap(), exact);
        let text = expr.to_string();
        prop_assert_eq!(number(&text).value, exact);
    }

    #[test]
    fn a_decimal_rounds_as_the_standard_library_does(mantissa in any::<i64>(), places in 0usize..30) {
        let text = format!("{mantissa}e-{places}");
        let expected: f64 = text.parse().unwrap();
        prop_assert_eq!(Decimal::parse(&text).unwrap().to_f64(), expected);
        let shown = Decimal::parse(&text).unwrap().to_string();
        prop_assert_eq!(shown.parse::<f64>().unwrap(), expected);
        prop_assert_eq!(Decimal::parse(&shown).unwrap(), Decimal::parse(&text).unwrap());
    }

    #[test]
    fn a_float_becomes_text_and_comes_back(bits in any::<u64>()) {
        let x = f64::from_bits(bits);
        match Quantity::from_f64(x) {
            Ok(quantity) => prop_assert_eq!(quantity.value, x),
            Err(error) => prop_assert!(!x.is_finite() && error.fault == LiteralFault::NotFinite),
        }
    }

    #[test]
    fn no_text_makes_the_reader_panic(text in "[0-9a-z+*/(). ,eE_-]{0,40}|.{0,20}") {
        let _ = Quantity::parse_angle(&text, &[]);
        let _ = Quantity::parse_decimal(&text);
    }
}

#[test]
fn a_decimal_with_a_large_mantissa_keeps_all_its_digits() {
    let text = "0.1".to_owned() + &"7".repeat(300);
    let decimal = Decimal::parse(&text).unwrap();
    let digits: BigInt = ("1".to_owned() + &"7".repeat(300)).parse().unwrap();
    assert_eq!(decimal.mantissa, digits);
    assert_eq!(decimal.exponent, -301);
}
