//! Relations in symbols against the paper, the exact engine and the numbers.

mod common;

use common::{exact, relations, texts, with_random_lengths, with_random_values};
use roberval_base::{ExactNumber, Model, Options, base_parameters, decide_exactly};
use roberval_formats::{load, parse_toml};
use roberval_mechanism::{Mechanism, RobotDescription, SourceFormat};
use roberval_scalar::SplitMix64;
use roberval_symbolic::{
    Coefficient, Naming, Open, Origin, Route, SymbolicError, SymbolicOptions, SymbolicRelations,
    Variable, symbolic_relations,
};
use roberval_testkit::{Angles, Family, coupled};

/// Values of polynomials in doubles against beta in doubles.
const TOLERANCE: f64 = 1e-9;

fn built_in(name: &str) -> RobotDescription {
    load(name).expect("a built-in robot")
}

/// Table V of Gautier 1991, with the corrections of its misprints.
#[test]
fn table_v_is_the_papers() {
    let answer = relations(&built_in("puma560"), &SymbolicOptions::default());
    let sum = |links: [u8; 3], factor: &str, sign: &str| {
        links.map(|j| format!(" {sign} {factor} M_{j}")).concat()
    };
    let outer = |factor: &str, sign: &str| sum([4, 5, 6], factor, sign);
    let expected = [
        "ZZ_1 + Ia_1 + YY_2 + YY_3 + 2 R3 MZ_3 + (D3^2 + R3^2) M_3".to_owned()
            + &outer("(D3^2 + D4^2 + R3^2)", "+"),
        "XX_2 - YY_2 - D3^2 M_3".to_owned() + &outer("D3^2", "-"),
        "XZ_2 - D3 MZ_3 - D3 R3 M_3".to_owned() + &outer("D3 R3", "-"),
        "ZZ_2 + Ia_2 + D3^2 M_3".to_owned() + &outer("D3^2", "+"),
        "MX_2 + D3 M_3".to_owned() + &outer("D3", "+"),
        "XX_3 - YY_3 + YY_4 + 2 R4 MZ_4".to_owned() + &outer("(R4^2 - D4^2)", "+"),
        "XY_3 - D4 MZ_4".to_owned() + &outer("D4 R4", "-"),
        "ZZ_3 + YY_4 + 2 R4 MZ_4".to_owned() + &outer("(D4^2 + R4^2)", "+"),
        "MX_3".to_owned() + &outer("D4", "+"),
        "MY_3 + MZ_4".to_owned() + &outer("R4", "+"),
        "XX_4 - YY_4 + YY_5".to_owned(),
        "ZZ_4 + YY_5".to_owned(),
        "MY_4 - MZ_5".to_owned(),
        "XX_5 - YY_5 + YY_6".to_owned(),
        "ZZ_5 + YY_6".to_owned(),
        "MY_5 + MZ_6".to_owned(),
        "XX_6 - YY_6".to_owned(),
    ];
    assert_eq!(texts(&answer), expected);
    assert_eq!(answer.base.len(), 40);
    assert!(answer.special.is_empty());
    assert!(answer.verification.failure_probability < 1e-15);
}

/// beta of the exact engine at random rational lengths.
fn agrees_with_exact_beta(name: &str, geometries: usize) {
    agree_with_exact_beta(
        &relations(&built_in(name), &SymbolicOptions::default()),
        geometries,
    );
}

fn agree_with_exact_beta(answer: &SymbolicRelations, geometries: usize) {
    let name = &answer.mechanism.name;
    let order: Vec<usize> = (0..answer.parameters.len()).collect();
    let mut random = SplitMix64::new(1991);
    for _ in 0..geometries {
        let (robot, at) = with_random_lengths(answer, &mut random);
        let mechanism = Mechanism::new(&robot).expect("a valid robot");
        let decision = decide_exactly(&mechanism, Model::D, &order, 0).expect("a decision");
        assert_eq!(decision.kept, answer.base, "{name}");
        assert_eq!(decision.deleted, answer.regrouped, "{name}");
        for (row, expected) in answer.beta.iter().zip(&decision.beta) {
            for (coefficient, expected) in row.iter().zip(expected) {
                let ExactNumber::Rational(expected) = expected else {
                    panic!("{name}: {expected:?} is no fraction");
                };
                match coefficient {
                    None => assert_eq!(*expected.numer(), 0.into(), "{name}"),
                    Some(c) => assert_eq!(exact(c, &at), *expected, "{name}"),
                }
            }
        }
    }
}

#[test]
fn the_pumas_relations_are_exact_beta_at_a_hundred_random_geometries() {
    agrees_with_exact_beta("puma560", 100);
}

#[test]
fn those_of_the_stanford_arm_too() {
    agrees_with_exact_beta("stanford", 100);
}

#[test]
fn those_of_the_scara_too() {
    agrees_with_exact_beta("scara", 100);
}

#[test]
fn those_of_a_tree_too() {
    agrees_with_exact_beta("torso", 100);
}

#[test]
fn those_of_the_parallelogram_of_the_sr400_too() {
    agrees_with_exact_beta("sr400", 100);
}

/// A SCARA whose second joint stands on the first: two parameters fewer act.
#[test]
fn special_values_are_told_with_what_they_do() {
    let mut robot = built_in("scara");
    let generic = relations(&robot, &SymbolicOptions::default());
    assert!(generic.special.is_empty());
    robot.constants[0].1 = roberval_scalar::Quantity::zero();
    let answer = relations(&robot, &SymbolicOptions::default());
    // The relations are those of generic lengths all the same.
    assert_eq!(answer.base, generic.base);
    let mechanism = Mechanism::new(&robot).expect("a valid robot");
    let order: Vec<usize> = (0..answer.parameters.len()).collect();
    let decision = decide_exactly(&mechanism, Model::D, &order, 0).expect("a decision");
    let [special] = &answer.special[..] else {
        panic!("{:?}", answer.special);
    };
    assert_eq!(special.values, ["D2 = 0"]);
    let mut left = answer.base.clone();
    left.retain(|c| !special.gone.contains(c));
    assert_eq!(left, decision.kept);
    assert!(special.fewer > 0);
    assert_eq!(special.fewer, answer.base.len() - decision.kept.len());
}

/// Compares formulas with beta in doubles at other values of the symbols; gives the number of
/// entries that are compared and of those that are open.
fn compared_at_random_values(
    answer: &SymbolicRelations,
    random: &mut SplitMix64,
) -> (usize, usize) {
    let (robot, values) = with_random_values(answer, random);
    let name = &answer.mechanism.name;
    let mechanism = Mechanism::new(&robot).expect("a valid robot");
    let numbers = base_parameters(&mechanism, &Options::default()).expect("an answer");
    assert_eq!(answer.base, numbers.base, "{name}");
    let at: Vec<f64> = answer
        .variables
        .iter()
        .map(|variable| match variable {
            Variable::Length(name) => values[name],
            Variable::Cos(name) => values[name].cos(),
            Variable::Sin(name) => values[name].sin(),
        })
        .collect();
    let (mut compared, mut open) = (0, 0);
    for (i, row) in answer.beta.iter().enumerate() {
        for (j, coefficient) in row.iter().enumerate() {
            let value = match coefficient {
                None => 0.0,
                Some(Coefficient::Open { .. }) => {
                    open += 1;
                    continue;
                }
                Some(Coefficient::Quotient {
                    numerator,
                    denominator,
                }) => {
                    let powers = denominator.iter().zip(&at);
                    let below: f64 = powers.map(|(e, x)| x.powi(i32::from(*e))).product();
                    numerator.to_f64(&at) / below
                }
            };
            compared += 1;
            let error = (value - numbers.beta[(i, j)]).abs();
            let allowed = TOLERANCE * (1.0 + value.abs());
            assert!(error < allowed, "{name}: {value} {}", numbers.beta[(i, j)]);
        }
    }
    (compared, open)
}

/// The k-th kind of robots: angles and format in turn.
fn family(k: u64, angles: &[Angles]) -> Family {
    Family {
        links: (2, 6),
        angles: angles[k as usize % angles.len()],
        format: [SourceFormat::Mdh, SourceFormat::Urdf][k as usize / angles.len() % 2],
        ..Family::default()
    }
}

/// Generated chains and trees with made names.
#[test]
fn relations_of_chains_and_trees_are_beta_at_random_lengths_and_angles() {
    let (mut compared, mut with_angles) = (0, 0);
    let mut random = SplitMix64::new(1);
    for seed in 0..60 {
        let robot = family(seed, &[Angles::Right, Angles::Mixed, Angles::Oblique]).robot(seed);
        let answer = relations(&robot, &SymbolicOptions::default());
        let mut variables = answer.variables.iter();
        with_angles += usize::from(variables.any(|v| matches!(v, Variable::Cos(_))));
        for _ in 0..2 {
            compared += compared_at_random_values(&answer, &mut random).0;
        }
    }
    let enough = compared > 5000 && with_angles > 20;
    assert!(enough, "{compared} {with_angles}");
}

/// Offsets of couples are symbols as angles of the geometry are, in chains of couples too.
#[test]
fn relations_of_couples_with_offsets_are_beta_at_random_lengths_and_angles() {
    let (mut compared, mut open, mut offsets) = (0, 0, 0);
    let mut random = SplitMix64::new(2);
    for seed in 0..60 {
        let robot = family(seed, &[Angles::Right, Angles::Mixed]).robot(seed);
        let answer = relations(&coupled(robot, seed), &SymbolicOptions::default());
        let mut symbols = answer.named.symbols.iter();
        offsets += usize::from(symbols.any(|s| s.name.starts_with("offset")));
        let (more, left) = compared_at_random_values(&answer, &mut random);
        compared += more;
        open += left;
    }
    // Where axes are oblique and couples tie joints far apart, some are quotients by sums.
    assert!(compared > 2000 && offsets > 20, "{compared} {offsets}");
    assert!(open * 10 < compared, "{open} of {compared}");
}

/// The third joint follows the second at an angle: relations in its cosine and sine.
#[test]
fn the_offset_of_a_couple_is_an_angle() {
    let text = |offset: &str| {
        format!(
            "name = \"offset\"\n[constants]\nA = \"30 deg\"\nL = 0.5\n\
             [[link]]\nname = \"1\"\nalpha = 0\nd = 0\nr = 0\n\
             [[link]]\nname = \"2\"\nalpha = \"90 deg\"\nd = \"L\"\nr = 0\n\
             [[link]]\nname = \"3\"\nalpha = 0\nd = \"L\"\nr = 0.1\n\
             [[couple]]\njoint = \"3\"\nequals = {{ 2 = -1 }}\noffset = {offset}\n"
        )
    };
    for (offset, name) in [("\"A\"", "A"), ("0.3", "offset3"), ("\"pi/7\"", "offset3")] {
        let robot = parse_toml(&text(offset), "offset.toml").expect("a robot");
        let answer = relations(&robot, &SymbolicOptions::default());
        let first = format!(
            "ZZ_1 + Ia_1 + YY_2 + L^2 M_2 + sin({name})^2 XX_3 + 2 cos({name}) sin({name}) XY_3 \
             + cos({name})^2 YY_3 + 0.2 MZ_3 + (2 L^2 + 0.01) M_3"
        );
        assert_eq!(answer.named.notes.len(), 0, "{:?}", answer.named.notes);
        let mut found: Vec<String> = texts(&answer)[0].split(" + ").map(str::to_owned).collect();
        let mut wanted: Vec<String> = first.split(" + ").map(str::to_owned).collect();
        found.sort();
        wanted.sort();
        assert_eq!(found, wanted);
    }
}

/// Chains of general angles: a coefficient of many terms in the cosines and sines of all.
#[test]
fn long_coefficients_are_found_one_symbol_after_another() {
    let robot = parse_toml(GENERAL, "general.toml").expect("a robot");
    let answer = relations(&robot, &SymbolicOptions::default());
    let terms = |c: &Coefficient| match c {
        Coefficient::Quotient { numerator, .. } => numerator.terms.len(),
        Coefficient::Open { why, .. } => panic!("{why:?}"),
    };
    let longest = answer.beta.iter().flatten().flatten().map(terms).max();
    assert!(longest > Some(20), "{longest:?}");
    compared_at_random_values(&answer, &mut SplitMix64::new(3));
}

/// A link on two fixed ones, each placed by two general angles.
const GENERAL: &str = "name = \"general\"\n\
    [[link]]\nname = \"1\"\nalpha = 0.4\nd = 0.1\nr = 0.2\n\
    [[link]]\nname = \"2\"\nalpha = 0.7\nd = 0.3\nr = 0.2\n\
    [[link]]\nname = \"3\"\njoint = \"fixed\"\nalpha = 0.3\nd = 0.1\ntheta = 0.9\nr = 0.2\n\
    [[link]]\nname = \"4\"\njoint = \"fixed\"\nalpha = 0.5\nd = 0.1\ntheta = 0.6\nr = 0.2\n";

/// What stays open says why.
#[test]
fn what_has_no_formula_says_why() {
    let mut reasons = Vec::new();
    for seed in 0..30 {
        let robot = family(seed, &[Angles::Oblique]).robot(seed);
        let answer = relations(&coupled(robot, seed), &SymbolicOptions::default());
        let entries = answer.beta.iter().flatten().flatten();
        reasons.extend(entries.filter_map(|c| match c {
            Coefficient::Open { why, symbols } => Some((*why, symbols.is_empty())),
            Coefficient::Quotient { .. } => None,
        }));
    }
    assert!(reasons.iter().any(|(why, _)| *why == Open::NotPolynomial));
    let constant = |(why, alone): &(Open, bool)| !alone || *why == Open::NotRational;
    assert!(reasons.iter().all(constant), "{reasons:?}");
}

/// A parallelogram given by its loop has the relations of the couples that it is.
#[test]
fn a_parallelogram_given_by_its_loop_has_relations() {
    let text = |side: f64| {
        format!(
            "name = \"loop\"\n[constants]\nL = 0.5\nH = 0.3\n\
             [[link]]\nname = \"1\"\nantecedent = \"base\"\nalpha = \"90 deg\"\nd = 0\nr = 0\n\
             [[link]]\nname = \"2\"\nalpha = 0\nd = \"L\"\nr = 0\n\
             [[link]]\nname = \"3\"\nantecedent = \"base\"\nalpha = \"90 deg\"\nd = 0.3\nr = 0\n\
             [[loop]]\nbetween = [\"2\", \"3\"]\nat = [[0.3, 0, 0], [{side}, 0, 0]]\n\
             cut = \"revolute\"\nnear = {{ 1 = 1, 2 = -1, 3 = 1 }}\n"
        )
    };
    let robot = parse_toml(&text(0.5), "loop.toml").expect("a robot");
    let answer = relations(&robot, &SymbolicOptions::default());
    assert_eq!(answer.loops.len(), 2);
    let mechanism = Mechanism::new(&robot).expect("a mechanism");
    let numbers = base_parameters(&mechanism, &Options::default()).expect("an answer");
    assert_eq!(answer.base.len(), numbers.base.len());
    let joined = texts(&answer).join("\n");
    assert!(joined.contains("L"), "{joined}");
    let other = parse_toml(&text(0.45), "loop.toml").expect("a robot");
    let mechanism = Mechanism::new(&other).expect("a mechanism");
    let refused = symbolic_relations(&mechanism, &SymbolicOptions::default());
    assert_eq!(refused.map(|_| ()), Err(SymbolicError::Loops));
}

/// Lengths that are products of constants: polynomials of a higher degree than the units say.
#[test]
fn products_of_constants_are_lengths_too() {
    for length in ["L1*H", "L1*L1", "3*L1*H + L1", "L1*H*H", "L1*H - H*H"] {
        let text = format!(
            "name = \"{length}\"\n[constants]\nL1 = 0.3\nH = 0.7\nL2 = 0.2\n\
             [[link]]\nname = \"1\"\nalpha = 0\nd = 0\ntheta = 0\nr = 0\n\
             [[link]]\nname = \"2\"\nalpha = \"90 deg\"\nd = \"L2\"\ntheta = 0\nr = \"{length}\"\n\
             [[link]]\nname = \"3\"\nalpha = 0\nd = \"{length}\"\ntheta = 0\nr = \"L2\"\n"
        );
        let robot = parse_toml(&text, "products.toml").expect("a robot");
        let answer = relations(&robot, &SymbolicOptions::default());
        assert!(!answer.variables.is_empty(), "{length}");
        // An open coefficient panics.
        agree_with_exact_beta(&answer, 5);
    }
}

#[test]
fn all_lengths_get_names_on_request_and_where_there_are_none() {
    let mut robot = built_in("puma560");
    robot.constants.clear();
    let mut number = 1;
    for link in &mut robot.links {
        if let roberval_mechanism::Geometry::Mdh(g) = &mut link.geometry {
            for length in [&mut g.d, &mut g.r] {
                if length.value != 0.0 {
                    *length = roberval_testkit::decimal(number, -1);
                    number += 1;
                }
            }
        }
    }
    let names = |naming| {
        let options = SymbolicOptions {
            naming,
            ..SymbolicOptions::default()
        };
        let symbols = relations(&robot, &options).named.symbols.into_iter();
        symbols.map(|s| s.name).collect::<Vec<_>>()
    };
    assert_eq!(names(Naming::All), ["d3", "r3", "d4", "r4"]);
    assert_eq!(names(Naming::Auto), ["d3", "r3", "d4", "r4"]);
}

/// Every removed parameter has an origin; on robots without couples of the catalogue the
/// rules alone do it.
#[test]
fn the_closed_form_rules_explain_the_catalogues_chains_and_trees() {
    for entry in roberval_formats::catalogue() {
        if !built_in(entry.name).loops.is_empty() {
            continue; // has no relations in symbols
        }
        let answer = relations(&built_in(entry.name), &SymbolicOptions::default());
        let removed = answer.no_effect.len() + answer.regrouped.len();
        assert_eq!(answer.origins.len(), removed, "{}", entry.name);
        if answer.mechanism.closure.is_none() {
            let left = answer
                .origins
                .iter()
                .filter(|(_, o)| *o == Origin::Elimination);
            assert_eq!(left.count(), 0, "{}", entry.name);
        }
    }
}

/// A rule that removes what it should not, or that no sample confirms, would be found by the
/// rules' own check; what is counted here is how often elimination has to help.
#[test]
fn on_three_of_four_generated_chains_and_trees_the_rules_are_enough() {
    let mut enough = 0;
    for seed in 0..100 {
        let family = Family {
            links: (1, 7),
            angles: [Angles::Right, Angles::Mixed][seed as usize % 2],
            format: [SourceFormat::Mdh, SourceFormat::Urdf][seed as usize / 2 % 2],
            ..Family::default()
        };
        let answer = relations(&family.robot(seed), &SymbolicOptions::default());
        let by_rules = |(_, origin): &(usize, Origin)| *origin != Origin::Elimination;
        enough += usize::from(answer.origins.iter().all(by_rules));
    }
    assert!(enough >= 75, "{enough} of 100");
}

/// The rules alone, then the numerical method on what they leave: the same base parameters,
/// and where nothing is left to do the same relations.
#[test]
fn the_rules_alone_and_elimination_on_what_they_leave_give_the_whole_answer() {
    let catalogue = roberval_formats::catalogue().iter();
    let mut robots: Vec<_> = catalogue.map(|entry| built_in(entry.name)).collect();
    robots.retain(|robot| robot.loops.is_empty());
    robots.extend((0..40).map(|seed| {
        let family = Family {
            links: (1, 6),
            angles: [Angles::Right, Angles::Mixed][seed as usize % 2],
            format: [SourceFormat::Mdh, SourceFormat::Urdf][seed as usize / 2 % 2],
            ..Family::default()
        };
        family.robot(seed)
    }));
    let (mut enough, mut too_few) = (0, 0);
    for robot in &robots {
        let whole = relations(robot, &SymbolicOptions::default());
        let options = SymbolicOptions {
            route: Route::RulesAlone,
            ..SymbolicOptions::default()
        };
        let rules = relations(robot, &options);
        let mut base = rules.base.clone();
        base.retain(|c| !rules.left_over.contains(c));
        assert_eq!(base, whole.base, "{}", robot.name);
        assert!(rules.origins.iter().all(|(_, o)| *o != Origin::Elimination));
        match rules.left_over.is_empty() {
            true => {
                enough += 1;
                assert_eq!(rules.beta, whole.beta, "{}", robot.name);
            }
            false => too_few += 1,
        }
    }
    assert!(enough > 30 && too_few > 3, "{enough} {too_few}");
}

/// Everything regroups across the joints of a robot that floats: a rule removes each
/// parameter that goes.
#[test]
fn the_rules_are_always_enough_on_a_base_that_floats() {
    for seed in 0..20 {
        let family = Family {
            links: (3, 6),
            format: [SourceFormat::Mdh, SourceFormat::Urdf][seed as usize % 2],
            ..Family::default()
        };
        let robot = family.robot(seed).with_floating_base();
        let answer = relations(&robot, &SymbolicOptions::default());
        let by_rules = |(_, origin): &(usize, Origin)| *origin != Origin::Elimination;
        assert!(answer.origins.iter().all(by_rules), "robot {seed}");
    }
}
/// What is no polynomial over a monomial (or of very many terms) is left open: quotients by
/// sums, where a link that turns about one direction is turned by three angles against it.
#[test]
fn coefficients_stay_open_on_one_robot_of_ten_at_most() {
    let (mut open, mut quotients) = (0, 0);
    for seed in 0..60 {
        let family = Family {
            links: (1, 6),
            angles: [Angles::Right, Angles::Mixed, Angles::Oblique][seed as usize % 3],
            format: [SourceFormat::Mdh, SourceFormat::Urdf][seed as usize / 3 % 2],
            ..Family::default()
        };
        let answer = relations(&family.robot(seed), &SymbolicOptions::default());
        let entries: Vec<_> = answer.beta.iter().flatten().flatten().collect();
        let divided = |c: &&&Coefficient| match c {
            Coefficient::Quotient { denominator, .. } => denominator.iter().any(|e| *e > 0),
            Coefficient::Open { .. } => false,
        };
        let is_open = |c: &&Coefficient| matches!(c, Coefficient::Open { .. });
        open += usize::from(entries.iter().copied().any(|c| is_open(&c)));
        quotients += entries.iter().filter(divided).count();
    }
    assert!(open <= 6 && quotients > 0, "{open} {quotients}");
}
