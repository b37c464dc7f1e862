//! What is compiled, with the inputs and what the library makes of them.

use roberval_base::{Options, base_parameters};
use roberval_code::{Code, Request, What};
use roberval_mechanism::{JointKind, Mechanism, SourceFormat};
use roberval_regressor::{Model, Regressor, States};
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
    pub x: Vec<f64>,
    /// The results, sample by sample.
    pub expected: Vec<Vec<f64>>,
}

impl Case {
    fn new(mechanism: &Mechanism, what: What, columns: &[usize], seed: u64) -> Self {
        let friction = what == What::Tau && seed.is_multiple_of(2) && mechanism.closure.is_none();
        let request = Request {
            what,
            columns,
            friction,
        };
        let code = Code::new(mechanism, &request).expect("code");
        let mut random = SplitMix64::new(seed);
        let mut draw =
            |count: usize| -> Vec<f64> { (0..count).map(|_| random.uniform(-1.0, 1.0)).collect() };
        let n = mechanism.independent();
        let (q, qd, qdd) = (draw(SAMPLES * n), draw(SAMPLES * n), draw(SAMPLES * n));
        let x = draw(code.parameters.len());
        let mut case = Self {
            code,
            mechanism: mechanism.clone(),
            q,
            qd,
            qdd,
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
        let at = sample * n..(sample + 1) * n;
        let (q, qd, qdd) = (&self.q[at.clone()], &self.qd[at.clone()], &self.qdd[at]);
        let zero = vec![0.0; n];
        match what {
            What::Tau => {
                let mut tau = self.torques(&self.mechanism, columns, [q, qd, qdd]);
                for (k, tau) in tau.iter_mut().enumerate().filter(|_| friction) {
                    let f = &self.x[columns.len() + 2 * k..];
                    *tau += f[0] * qd[k] + f[1] * qd[k].signum();
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

    /// Whether two links stand on one.
    pub fn branches(&self) -> bool {
        let stands = |link: &roberval_mechanism::Link| link.antecedent;
        let mut on: Vec<_> = self.mechanism.links.iter().map(stands).collect();
        on.sort_unstable();
        on.windows(2).any(|pair| pair[0] == pair[1])
    }

    /// Whether joints depend on others.
    pub fn is_coupled(&self) -> bool {
        self.mechanism.closure.is_some()
    }

    /// Whether a joint is prismatic.
    pub fn slides(&self) -> bool {
        let kinds = self.mechanism.links.iter().map(|link| link.joint);
        kinds.into_iter().any(|kind| kind == JointKind::Prismatic)
    }
}

/// All functions of the catalogue's robots and of generated ones.
pub fn cases() -> Vec<Case> {
    let catalogue = roberval_formats::catalogue().iter();
    let mut robots: Vec<_> = catalogue
        .map(|entry| roberval_formats::load(entry.name).expect("a built-in robot"))
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
    let of_robot = |(index, robot): (usize, &roberval_mechanism::RobotDescription)| {
        let mechanism = Mechanism::new(robot).expect("a valid robot");
        let answer = base_parameters(&mechanism, &Options::default()).expect("an answer");
        let all: Vec<usize> = (0..mechanism.parameters().len()).collect();
        let seed = index as u64;
        // Every third robot with its standard parameters.
        let columns = if index % 3 == 2 { &all } else { &answer.base };
        What::ALL.map(|what| Case::new(&mechanism, what, columns, seed))
    };
    robots.iter().enumerate().flat_map(of_robot).collect()
}
