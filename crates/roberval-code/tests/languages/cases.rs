//! What is compiled, with the inputs and what the library makes of them.

use std::sync::OnceLock;

use roberval_base::{Options, base_parameters};
use roberval_code::{Code, Request, What};
use roberval_formats::parse_toml;
use roberval_mechanism::{JointKind, Mechanism, RobotDescription, SourceFormat};
use roberval_regressor::{Expansion, Model, Regressor, States};
use roberval_scalar::SplitMix64;
use roberval_testkit::{Angles, Family};

/// Samples of each function.
pub const SAMPLES: usize = 3;

/// One function and what it should give.
pub struct Case {
    pub code: Code,
    mechanism: Mechanism,
    /// Row-major, one row a sample.
    pub q: Vec<f64>,
    pub qd: Vec<f64>,
    pub qdd: Vec<f64>,
    /// G, where there are loops.
    pub g: Vec<f64>,
    /// The independent coordinates and their rates: those above, but for loops.
    independent: [Vec<f64>; 3],
    pub x: Vec<f64>,
    /// The results, sample by sample.
    pub expected: Vec<Vec<f64>>,
}

impl Case {
    pub fn new(
        mechanism: &Mechanism,
        what: What,
        (columns, no_effect): (&[usize], &[usize]),
        seed: u64,
    ) -> Self {
        let friction = what == What::Tau && seed.is_multiple_of(2) && mechanism.closure.is_none();
        let request = Request {
            what,
            columns,
            no_effect,
            friction,
        };
        let code = Code::new(mechanism, &request).expect("code");
        let mut random = SplitMix64::new(seed);
        let mut draw =
            |count: usize| -> Vec<f64> { (0..count).map(|_| random.uniform(-1.0, 1.0)).collect() };
        let n = mechanism.independent();
        let mut independent = [0; 3].map(|_| draw(SAMPLES * n));
        if mechanism.is_floating() {
            independent[0] = draw(SAMPLES * (n + 1));
            independent[0].chunks_exact_mut(n + 1).for_each(|q| {
                let length = q[3..7].iter().map(|x| x * x).sum::<f64>().sqrt();
                q[3..7].iter_mut().for_each(|x| *x /= length);
            });
        }
        let x = draw(code.parameters.len());
        let [q, qd, qdd, g] = match code.loops {
            true => expanded(mechanism, &independent),
            false => {
                let [q, qd, qdd] = independent.clone();
                [q, qd, qdd, Vec::new()]
            }
        };
        let mut case = Self {
            code,
            mechanism: mechanism.clone(),
            q,
            qd,
            qdd,
            g,
            independent,
            x,
            expected: Vec::new(),
        };
        case.expected = (0..SAMPLES)
            .map(|sample| case.expect(what, columns, friction, sample))
            .collect();
        case
    }

    /// The library's answer at one sample.
    fn expect(&self, what: What, columns: &[usize], friction: bool, sample: usize) -> Vec<f64> {
        let n = self.mechanism.independent();
        let states = self.independent.each_ref();
        let [q, qd, qdd] = states.map(|x| {
            let width = x.len() / SAMPLES;
            &x[sample * width..(sample + 1) * width]
        });
        let zero = vec![0.0; n];
        match what {
            What::Tau => {
                let mut tau = self.torques(&self.mechanism, columns, [q, qd, qdd]);
                let joints = tau.iter_mut().skip(self.mechanism.base_variables());
                for (k, tau) in joints.enumerate().filter(|_| friction) {
                    let f = &self.x[columns.len() + 2 * k..];
                    let qd = qd[self.mechanism.base_variables() + k];
                    *tau += f[0] * qd + f[1] * qd.signum();
                }
                tau
            }
            What::Gravity => self.torques(&self.mechanism, columns, [q, &zero, &zero]),
            What::MassMatrix => {
                let mut weightless = self.mechanism.clone();
                weightless.gravity.fill(0.0);
                let mut matrix = vec![0.0; n * n];
                for k in 0..n {
                    let mut unit = zero.clone();
                    unit[k] = 1.0;
                    let column = self.torques(&weightless, columns, [q, &zero, &unit]);
                    (0..n).for_each(|i| matrix[i * n + k] = column[i]);
                }
                matrix
            }
            What::Regressor => self.rows(Model::D, columns, [q, qd, qdd]),
            What::Energy => self.rows(Model::H, columns, [q, qd, qdd]),
        }
    }

    fn torques(&self, mechanism: &Mechanism, columns: &[usize], state: [&[f64]; 3]) -> Vec<f64> {
        let mut x = vec![0.0; mechanism.parameters().len()];
        for (&column, value) in columns.iter().zip(&self.x) {
            x[column] = *value;
        }
        let mut tau = vec![0.0; mechanism.independent()];
        let [q, qd, qdd] = state;
        Regressor::new(mechanism)
            .torques(&x, States { q, qd, qdd }, &mut tau)
            .expect("torques");
        tau
    }

    fn rows(&self, model: Model, columns: &[usize], [q, qd, qdd]: [&[f64]; 3]) -> Vec<f64> {
        let mut rows = vec![0.0; model.rows(self.mechanism.independent()) * columns.len()];
        Regressor::new(&self.mechanism)
            .fill_columns(model, columns, States { q, qd, qdd }, &mut rows)
            .expect("rows");
        rows
    }

    /// Whether the base floats.
    pub fn floats(&self) -> bool {
        self.code.floating.is_some()
    }

    /// Whether two links stand on one.
    pub fn branches(&self) -> bool {
        let stands = |link: &roberval_mechanism::Link| link.antecedent;
        let mut on: Vec<_> = self.mechanism.links.iter().map(stands).collect();
        on.sort_unstable();
        on.windows(2).any(|pair| pair[0] == pair[1])
    }

    /// Whether loops relate joints.
    pub fn has_loops(&self) -> bool {
        self.code.loops
    }

    /// Whether joints depend on others.
    pub fn is_coupled(&self) -> bool {
        self.mechanism.closure.is_some() && !self.code.loops
    }

    /// Whether joints follow others by expressions.
    pub fn follows_expressions(&self) -> bool {
        self.is_coupled() && !self.mechanism.is_affine()
    }

    /// Whether a joint is prismatic.
    pub fn slides(&self) -> bool {
        let kinds = self.mechanism.links.iter().map(|link| link.joint);
        kinds.into_iter().any(|kind| kind == JointKind::Prismatic)
    }
}

/// The state of all joints, and G, sample after sample.
fn expanded(mechanism: &Mechanism, [q, qd, qdd]: &[Vec<f64>; 3]) -> [Vec<f64>; 4] {
    let (n, m) = (mechanism.dof(), mechanism.independent());
    let expansion = Expansion::in_floats(mechanism).expect("loops");
    let (more, base) = (mechanism.positions() - m, mechanism.base_variables());
    let mut all = [const { Vec::new() }; 4];
    for sample in 0..SAMPLES {
        let mut states = expansion.states();
        let at = sample * m..(sample + 1) * m;
        // Joints stand one place further in q if the base floats.
        let q = &q[sample * (m + more)..(sample + 1) * (m + more)];
        let state = [&q[more..], &qd[at.clone()], &qdd[at]];
        expansion
            .expand(state, &mut states)
            .expect("the loops close");
        states.q.splice(..base, q[..base + more].iter().copied());
        let mut g = vec![0.0; n * m];
        for i in 0..n {
            states
                .transmission
                .row(i)
                .for_each(|(k, value)| g[i * m + k] = value);
        }
        for (all, new) in all.iter_mut().zip([states.q, states.qd, states.qdd, g]) {
            all.extend(new);
        }
    }
    all
}

/// Five links of a plane that close a loop, standing on a base that they may turn.
const LOOPS: [&str; 2] = [
    "name = \"five-bar\"\ngravity = [0, -9.81, 0]\n\
     link = [\n\
     { name = \"1\", alpha = 0, d = 0, r = 0 },\n\
     { name = \"2\", alpha = 0, d = 1, r = 0, active = false },\n\
     { name = \"3\", antecedent = \"base\", alpha = 0, d = 0.5, r = 0 },\n\
     { name = \"4\", alpha = 0, d = 1, r = 0, active = false },\n\
     ]\n\
     [[loop]]\nbetween = [\"2\", \"4\"]\nat = [[1.5, 0, 0], [1.5, 0, 0]]\ncut = \"revolute\"\n",
    "name = \"four-bar on a turning base\"\ngravity = [0, 0, -9.81]\n\
     link = [\n\
     { name = \"1\", alpha = 0, d = 0, r = 0 },\n\
     { name = \"2\", alpha = \"90 deg\", d = 0.1, r = 0 },\n\
     { name = \"3\", antecedent = \"2\", alpha = 0, d = 0.3, r = 0, active = false },\n\
     { name = \"4\", antecedent = \"1\", alpha = \"90 deg\", d = 1.1, r = 0, active = false },\n\
     ]\n\
     [[loop]]\nbetween = [\"3\", \"4\"]\nat = [[0.9, 0, 0], [0.7, 0, 0]]\ncut = \"revolute\"\n",
];

/// A slider crank and a wrist whose fingers follow, by expressions.
const EXPRESSIONS: [&str; 2] = [
    "name = \"slider crank\"\ngravity = [0, -9.81, 0]\n\
     link = [\n\
     { name = \"crank\", alpha = 0, d = 0, r = 0 },\n\
     { name = \"rod\", alpha = 0, d = 0.2, r = 0 },\n\
     { name = \"slide\", joint = \"prismatic\", antecedent = \"base\", alpha = \"90 deg\", d = 0, theta = 0 },\n\
     ]\n\
     [[couple]]\njoint = \"slide\"\n\
     expression = \"0.2*cos(q.crank) + sqrt(0.49 - 0.04*sin(q.crank)*sin(q.crank))\"\n\
     [[couple]]\njoint = \"rod\"\n\
     expression = \"-q.crank - atan2(0.2*sin(q.crank), q.slide - 0.2*cos(q.crank))\"\n",
    "name = \"wrist\"\ngravity = [0, 0, -9.81]\n\
     link = [\n\
     { name = \"1\", alpha = 0, d = 0, r = 0 },\n\
     { name = \"2\", alpha = \"90 deg\", d = 0.1, r = 0.3 },\n\
     { name = \"3\", alpha = \"30 deg\", d = 0.2, r = 0 },\n\
     { name = \"4\", antecedent = \"2\", alpha = \"-90 deg\", d = 0.2, r = 0.1 },\n\
     ]\n\
     [[couple]]\njoint = \"3\"\n\
     expression = \"sqrt(2 - sin(q.1)) / (3 - q.2*q.1) - atan2(-q.2, -1 - q.1*q.1)\"\n\
     [[couple]]\njoint = \"4\"\nequals = { \"3\" = -2, \"1\" = \"1/3\" }\noffset = 0.25\n",
];

/// Some of all kinds on a base that floats: an arm, couples by expressions, loops, trees.
fn floating(robots: &[RobotDescription]) -> Vec<RobotDescription> {
    let of = |name: &str| {
        let robot = robots.iter().find(|robot| robot.name == name);
        let mut robot = robot.expect("among them").clone().with_floating_base();
        robot.name += " floating";
        robot
    };
    let names = [
        "Stanford arm",
        "wrist",
        "four-bar on a turning base",
        "generated 2",
        "generated 7",
    ];
    names.map(of).into()
}

/// Names of other scripts, and such as would end a comment.
const SCRIPTS: &str = "name = '\u{8155} */ \"\"\" %{ \\'\ngravity = [0, 0, -9.81]\n\
     [[link]]\nname = '\u{80a9} \\'\nalpha = 0\nd = 0\nr = 0\n\
     [[link]]\nname = '\u{e9}paule ??/ */ \u{202e}'\nalpha = '90 deg'\nd = 0.5\nr = 0.1\n";

/// Robots and links whose names are those of the language or of generated code.
fn named() -> Vec<RobotDescription> {
    let names = [
        "sin", "t1", "q", "MX_2", "double", "fn", "lambda", "end", "x", "prepare",
    ];
    let robot = |name: &str| {
        let text = format!(
            "name = \"{name}\"\ngravity = [0, 0, -9.81]\n[constants]\n{name} = 0.5\nt2 = 0.25\n\
             [[link]]\nname = \"{name}\"\nalpha = 0\nd = 0\nr = 0\n\
             [[link]]\nname = \"MX_{name}\"\nalpha = \"90 deg\"\nd = \"{name}\"\nr = \"t2\"\n"
        );
        parse_toml(&text, "names.toml").expect("a robot")
    };
    names.map(robot).into()
}

/// All functions of all robots, made once.
pub fn cases() -> &'static [Case] {
    static CASES: OnceLock<Vec<Case>> = OnceLock::new();
    CASES.get_or_init(all_cases)
}

/// All functions of the catalogue's robots and of generated ones.
fn all_cases() -> Vec<Case> {
    let catalogue = roberval_formats::catalogue().iter();
    let mut robots: Vec<_> = catalogue
        .map(|entry| roberval_formats::load(entry.name).expect("a built-in robot"))
        .filter(|robot| robot.loops.is_empty()) // passive joints are found by iteration
        .collect();
    for (seed, format, angles) in [
        (1, SourceFormat::Mdh, Angles::Right),
        (2, SourceFormat::Mdh, Angles::Mixed),
        (3, SourceFormat::Mdh, Angles::Oblique),
        (4, SourceFormat::Mdh, Angles::Fifteens),
        (5, SourceFormat::Mdh, Angles::Right),
        (6, SourceFormat::Urdf, Angles::Right),
        (7, SourceFormat::Urdf, Angles::Mixed),
        (8, SourceFormat::Urdf, Angles::Oblique),
        (9, SourceFormat::Urdf, Angles::Right),
        (10, SourceFormat::Urdf, Angles::Mixed),
    ] {
        let family = Family {
            links: (2, 7),
            branch: 0.4,
            angles,
            format,
            ..Family::default()
        };
        robots.push(family.robot(seed));
    }
    robots.extend(LOOPS.map(|text| parse_toml(text, "loops.toml").expect("a robot")));
    robots.extend(EXPRESSIONS.map(|text| parse_toml(text, "couples.toml").expect("a robot")));
    robots.extend(floating(&robots));
    robots.extend(named());
    robots.push(parse_toml(SCRIPTS, "scripts.toml").expect("a robot"));
    let of_robot = |(index, robot): (usize, &roberval_mechanism::RobotDescription)| {
        let mechanism = Mechanism::new(robot).expect("a valid robot");
        let answer = base_parameters(&mechanism, &Options::default()).expect("an answer");
        let all: Vec<usize> = (0..mechanism.parameters().len()).collect();
        let seed = index as u64;
        // Every third robot with its standard parameters.
        let columns = if index % 3 == 2 { &all } else { &answer.base };
        let columns = (&columns[..], &answer.no_effect[..]);
        What::ALL.map(|what| Case::new(&mechanism, what, columns, seed))
    };
    robots.iter().enumerate().flat_map(of_robot).collect()
}
