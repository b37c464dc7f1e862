use std::f64::consts::PI;

use roberval_mechanism::{Assembly, JointKind, Mechanism, Motion, VariableLaw, Walk};
use roberval_regressor::{CouplePowers, Expansion, JointStates, States};
use roberval_scalar::SplitMix64;

/// Configurations drawn for one sample before a mechanism counts as immovable.
const MOST_REDRAWN: usize = 200;

/// Loops stand in at least so many configurations (or one for three parameters); more
/// samples than that differ in their velocities and accelerations.
const FEWEST_CONFIGURATIONS: usize = 64;

/// Random states of the robot, N samples of the m independent coordinates, row-major, as
/// [`States`] has them.
///
/// Revolute joints turn anywhere; prismatic ones move by the robot's own length L, and
/// time runs in units of sqrt(L/g), so that weights and inertia forces are comparable
/// and the answer does not depend on the unit of length. A floating base moves likewise.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    /// Positions, rad or m; an attitude as a quaternion.
    pub q: Vec<f64>,
    /// Velocities, per s.
    pub qd: Vec<f64>,
    /// Accelerations, per s^2.
    pub qdd: Vec<f64>,
    /// Number of samples N.
    pub count: usize,
    /// Configurations of loops that were redrawn, being singular or out of reach.
    pub redrawn: usize,
}

/// No samples of a mechanism with loops, or with couples by expressions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "only {found} of {count} configurations were found in which the loops close, or the \
     couples' expressions have values, and that are not singular: give near values on a branch \
     that moves farther, or expressions that have values nearly everywhere"
)]
pub struct SampleError {
    /// Configurations found.
    pub found: usize,
    /// Configurations asked for.
    pub count: usize,
}

impl Samples {
    /// `count` samples for this robot; the same seed gives the same samples. Loops are
    /// closed on one branch: each sample can be reached from the one before by moving the
    /// independent joints straight there.
    ///
    /// # Errors
    /// [`SampleError`] if a mechanism with loops has no such configurations.
    pub fn draw(mechanism: &Mechanism, count: usize, seed: u64) -> Result<Self, SampleError> {
        let reaches = Reaches::of(mechanism);
        let mut random = SplitMix64::new(seed);
        let mut samples = Self::with_capacity(count * mechanism.positions());
        let mut regular = Regular::of(mechanism);
        for found in 0..count {
            for _ in 0..MOST_REDRAWN {
                let unit = |_| std::array::from_fn(|_| random.uniform(-1.0, 1.0));
                let state: Vec<[f64; 3]> = (0..mechanism.independent()).map(unit).collect();
                samples.push(&reaches, &state);
                if regular.last_is(&samples) {
                    break;
                }
                samples.pop();
                samples.redrawn += 1;
            }
            if samples.count == found {
                return Err(SampleError { found, count });
            }
        }
        if let Some(assembly) = &mechanism.assembly {
            let configurations = FEWEST_CONFIGURATIONS.max(mechanism.parameters().len() / 3);
            samples.close(assembly, count.div_ceil(configurations), seed)?;
        }
        Ok(samples)
    }

    /// Replaces the positions by those of closed configurations, each used for `each`
    /// samples.
    fn close(&mut self, assembly: &Assembly, each: usize, seed: u64) -> Result<(), SampleError> {
        let mut walk = Walk::new(assembly, seed);
        let mut last = assembly.start.clone();
        self.q.clear();
        for found in 0..self.count {
            if found % each > 0 {
                self.q.extend(assembly.independent.iter().map(|&k| last[k]));
                continue;
            }
            let next = (0..MOST_REDRAWN).find_map(|_| {
                let next = walk.next_configuration()?;
                let qa: Vec<f64> = assembly.independent.iter().map(|&k| next[k]).collect();
                let reached = assembly.reach(&last, &qa).ok();
                let same = reached.filter(|r| is_same(r, &next));
                if same.is_none() {
                    walk.go_back(&last);
                    self.redrawn += 1;
                }
                same
            });
            let none = SampleError {
                found,
                count: self.count,
            };
            last = next.ok_or(none)?;
            self.q.extend(assembly.independent.iter().map(|&k| last[k]));
        }
        self.redrawn += walk.redrawn;
        Ok(())
    }

    /// No samples yet, room for `size` numbers of each kind.
    pub(crate) fn with_capacity(size: usize) -> Self {
        Self {
            q: Vec::with_capacity(size),
            qd: Vec::with_capacity(size),
            qdd: Vec::with_capacity(size),
            count: 0,
            redrawn: 0,
        }
    }

    /// Adds the sample whose (q, qd, qdd), coordinate by coordinate of the velocity, are
    /// `state` in units of `reaches`; the three of an attitude are a rotation vector.
    pub(crate) fn push(&mut self, reaches: &Reaches, state: &[[f64; 3]]) {
        let first = self.q.len();
        for (reach, state) in reaches.each.iter().zip(state) {
            self.q.push(reach[0] * state[0]);
            self.qd.push(reach[1] * state[1]);
            self.qdd.push(reach[2] * state[2]);
        }
        if reaches.floating {
            let attitude = first + 3..first + 6;
            let vector = [0, 1, 2].map(|k| self.q[attitude.start + k]);
            self.q.splice(attitude, quaternion(vector));
        }
        self.count += 1;
    }

    /// Takes the last sample out.
    fn pop(&mut self) {
        for array in [&mut self.q, &mut self.qd, &mut self.qdd] {
            array.truncate(array.len() / self.count * (self.count - 1));
        }
        self.count -= 1;
    }

    /// The samples as the regressor takes them.
    #[must_use]
    pub fn states(&self) -> States<'_> {
        States {
            q: &self.q,
            qd: &self.qd,
            qdd: &self.qdd,
        }
    }
}

/// Whether expressions of joints have values: others are drawn again.
struct Regular(Option<(Expansion<f64>, JointStates<f64>)>);

impl Regular {
    fn of(mechanism: &Mechanism) -> Self {
        let by_formulas = !mechanism.is_affine() && mechanism.assembly.is_none();
        let expansion = Expansion::in_floats(mechanism).filter(|_| by_formulas);
        Self(expansion.map(|expansion| {
            let states = expansion.states();
            (expansion, states)
        }))
    }

    /// Whether the joints can stand as in the last of the samples, and follow without
    /// being far faster.
    fn last_is(&mut self, samples: &Samples) -> bool {
        let Some((expansion, states)) = &mut self.0 else {
            return true;
        };
        let last = |x: &'_ Vec<f64>| x.len() / samples.count * (samples.count - 1);
        let state = [&samples.q, &samples.qd, &samples.qdd].map(|x| &x[last(x)..]);
        let rows = 0..states.q.len();
        expansion.expand(state, states).is_ok()
            && rows
                .flat_map(|i| states.transmission.row(i))
                .all(|(_, g)| g.abs() < FASTEST)
    }
}

/// Near a singularity of an expression joints run away: beyond this many rad per rad a
/// configuration is drawn again.
const FASTEST: f64 = 100.0;

/// Whether two configurations are one: what moves them apart is another branch, and far
/// more than rounding.
fn is_same(a: &[f64], b: &[f64]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6)
}

/// A joint that others follow at half its angle is drawn over two turns, and so on up to
/// here: then all of them turn anywhere.
const MOST_TURNS: i64 = 60;

/// The largest (q, qd, qdd) drawn for each independent coordinate of the velocity: those that
/// follow it are not much faster, and slides go not much farther, than they would by
/// themselves.
pub(crate) struct Reaches {
    pub each: Vec<[f64; 3]>,
    floating: bool,
}

impl Reaches {
    pub fn of(mechanism: &Mechanism) -> Self {
        let length = mechanism.characteristic_length();
        let gravity = mechanism.gravity.norm();
        let rate = if gravity > 0.0 {
            (gravity / length).sqrt()
        } else {
            1.0
        };
        let reach = |motion| match motion {
            Motion::Translation => [length, rate * length, rate * rate * length],
            Motion::Rotation => [PI, rate, rate * rate],
        };
        let independent = mechanism.independent_motions().into_iter();
        let mut each: Vec<_> = independent.map(reach).collect();
        follow(mechanism, reach, &mut each);
        Self {
            each,
            floating: mechanism.is_floating(),
        }
    }
}

/// Sets coordinates that others follow to where and how fast these can go.
fn follow(mechanism: &Mechanism, reach: impl Fn(Motion) -> [f64; 3], reaches: &mut [[f64; 3]]) {
    let joints = mechanism.independent_joints();
    let laws = mechanism.closure.iter().flat_map(|c| &c.laws);
    let roots = CouplePowers::of(mechanism).map_or_else(Vec::new, |p| p.roots);
    let mut slow = vec![[1.0_f64; 2]; reaches.len()];
    for ((reach, root), link) in reaches.iter_mut().zip(roots).zip(&joints) {
        if link.joint == JointKind::Revolute {
            reach[0] *= root.min(MOST_TURNS) as f64;
        }
    }
    for (motion, law) in mechanism.motions().zip(laws) {
        if let VariableLaw::Affine(law) = law {
            for (place, multiplier) in &law.terms {
                let faster = multiplier.value.abs() * reaches[*place][1] / reach(motion)[1];
                let [far, fast] = &mut slow[*place];
                *fast = fast.max(faster);
                if motion == Motion::Translation {
                    let farther = multiplier.value.abs() * reaches[*place][0];
                    *far = far.max(farther / reach(motion)[0]);
                }
            }
        }
    }
    for (reach, [far, fast]) in reaches.iter_mut().zip(slow) {
        reach[0] /= far;
        reach[1] /= fast;
        reach[2] /= fast;
    }
}

/// The quaternion (x, y, z, w) of a rotation about a vector by its length.
fn quaternion(vector: [f64; 3]) -> [f64; 4] {
    let angle = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
    let (sin, cos) = (0.5 * angle).sin_cos();
    let factor = if angle > 0.0 { sin / angle } else { 0.5 };
    let [x, y, z] = vector.map(|x| factor * x);
    [x, y, z, cos]
}
