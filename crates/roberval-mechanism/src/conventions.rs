//! The ten parameters of a body as others order and place them.
//!
//! * paper: XX XY XZ YY YZ ZZ MX MY MZ M about the origin of the link's frame;
//! * Pinocchio: m mx my mz Ixx Ixy Iyy Ixz Iyz Izz about the same point, for a URDF the
//!   joint's frame (`pinocchio.Inertia.toDynamicParameters`);
//! * centre of mass, as in URDF: m, its place, Ixx Ixy Ixz Iyy Iyz Izz about it in the
//!   link's axes;
//! * principal, as in MuJoCo: m, `body_ipos`, `body_iquat` (w x y z), `body_inertia`.
//!
//! Products of inertia are entries of the tensor everywhere: XY = -(integral of x y dm).

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

/// Where each of Pinocchio's parameters stands among the paper's.
const PINOCCHIO: [usize; 10] = [9, 6, 7, 8, 0, 1, 3, 2, 4, 5];

/// The names of Pinocchio's parameters.
const PINOCCHIO_NAMES: [&str; 10] = [
    "m", "mx", "my", "mz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz",
];

/// The paper's ten parameters in Pinocchio's order.
fn to_pinocchio(paper: &[f64; 10]) -> [f64; 10] {
    PINOCCHIO.map(|k| paper[k])
}

/// Pinocchio's parameters in the paper's order.
fn from_pinocchio(pinocchio: &[f64; 10]) -> [f64; 10] {
    let mut paper = [0.0; 10];
    for (&k, &x) in PINOCCHIO.iter().zip(pinocchio) {
        paper[k] = x;
    }
    paper
}

/// A body about its centre of mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Central {
    /// Mass, kg.
    pub mass: f64,
    /// Centre of mass in the link's frame, m.
    pub centre: Vector3<f64>,
    /// Inertia about the centre of mass in the link's axes, kg m^2.
    pub tensor: Matrix3<f64>,
}

impl Central {
    /// The body with the paper's ten parameters; `None` for a first moment without mass,
    /// which has no centre.
    #[must_use]
    pub fn of(paper: &[f64; 10]) -> Option<Self> {
        let [xx, xy, xz, yy, yz, zz, mx, my, mz, mass] = *paper;
        let tensor = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        let first = Vector3::new(mx, my, mz);
        let centre = match mass {
            0.0 if first == Vector3::zeros() => Vector3::zeros(),
            0.0 => return None,
            _ => first / mass,
        };
        Some(Self {
            mass,
            centre,
            tensor: tensor - steiner(mass, &centre),
        })
    }

    /// The paper's ten parameters.
    #[must_use]
    pub fn paper(&self) -> [f64; 10] {
        let j = self.tensor + steiner(self.mass, &self.centre);
        let s = self.centre * self.mass;
        [
            j[(0, 0)],
            j[(0, 1)],
            j[(0, 2)],
            j[(1, 1)],
            j[(1, 2)],
            j[(2, 2)],
            s.x,
            s.y,
            s.z,
            self.mass,
        ]
    }

    /// Principal moments, the largest first, and the orientation (w x y z, w >= 0) of the
    /// principal axes in the link's frame.
    #[must_use]
    pub fn principal(&self) -> ([f64; 3], [f64; 4]) {
        let eigen = self.tensor.symmetric_eigen();
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        let [x, y, z] = order.map(|k| eigen.eigenvectors.column(k).into_owned());
        // Right-handed: an axis points either way.
        let z = if x.cross(&y).dot(&z) < 0.0 { -z } else { z };
        let axes = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, y, z]));
        let q = UnitQuaternion::from_rotation_matrix(&axes);
        let sign = if q.w < 0.0 { -1.0 } else { 1.0 };
        let quaternion = [q.w, q.i, q.j, q.k].map(|c| sign * c);
        (order.map(|k| eigen.eigenvalues[k]), quaternion)
    }

    /// The body of principal moments about axes of this orientation (w x y z, of any
    /// length but 0).
    #[must_use]
    pub fn of_principal(
        mass: f64,
        centre: [f64; 3],
        moments: [f64; 3],
        [w, x, y, z]: [f64; 4],
    ) -> Self {
        let quaternion = nalgebra::Quaternion::new(w, x, y, z);
        let axes = UnitQuaternion::from_quaternion(quaternion).to_rotation_matrix();
        let moments = Matrix3::from_diagonal(&Vector3::from(moments));
        Self {
            mass,
            centre: centre.into(),
            tensor: axes.matrix() * moments * axes.matrix().transpose(),
        }
    }
}

/// Whose order and place of the parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Convention {
    /// The paper's.
    #[default]
    Paper,
    /// Pinocchio's.
    Pinocchio,
    /// URDF's: about the centre of mass, in the link's axes.
    Urdf,
    /// MuJoCo's: about the centre of mass, principal axes.
    Mujoco,
}

impl Convention {
    /// All conventions.
    pub const ALL: [Self; 4] = [Self::Paper, Self::Pinocchio, Self::Urdf, Self::Mujoco];

    /// `paper`, `pinocchio`, `urdf` or `mujoco`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Pinocchio => "pinocchio",
            Self::Urdf => "urdf",
            Self::Mujoco => "mujoco",
        }
    }

    /// The names of the numbers.
    #[must_use]
    pub fn columns(self) -> &'static [&'static str] {
        match self {
            Self::Paper => &["XX", "XY", "XZ", "YY", "YZ", "ZZ", "MX", "MY", "MZ", "M"],
            Self::Pinocchio => &PINOCCHIO_NAMES,
            Self::Urdf => &[
                "mass", "x", "y", "z", "ixx", "ixy", "ixz", "iyy", "iyz", "izz",
            ],
            Self::Mujoco => &[
                "mass",
                "ipos x",
                "y",
                "z",
                "iquat w",
                "x",
                "y",
                "z",
                "inertia 1",
                "2",
                "3",
            ],
        }
    }

    /// Where the numbers are meant, in a sentence.
    #[must_use]
    pub fn place(self) -> &'static str {
        match self {
            Self::Paper => "about the origin of the link's frame and in that frame; first moments",
            Self::Pinocchio => {
                "Inertia.toDynamicParameters(), about the origin of the joint's frame (the link's \
                 frame of a URDF); first moments"
            }
            Self::Urdf => "about the centre of mass x y z, in the axes of the link's frame",
            Self::Mujoco => {
                "body_mass, body_ipos, body_iquat (w x y z), body_inertia: about the centre of \
                 mass, principal axes, the largest moment first"
            }
        }
    }

    /// The numbers of the paper's ten parameters; `None` for a first moment without mass
    /// where a centre of mass is asked for.
    #[must_use]
    pub fn of_paper(self, paper: &[f64; 10]) -> Option<Vec<f64>> {
        Some(match self {
            Self::Paper => paper.to_vec(),
            Self::Pinocchio => to_pinocchio(paper).to_vec(),
            Self::Urdf => {
                let Central {
                    mass,
                    centre,
                    tensor: j,
                } = Central::of(paper)?;
                let moments = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
                let numbers = [mass].into_iter().chain(centre.iter().copied());
                numbers.chain(moments.map(|at| j[at])).collect()
            }
            Self::Mujoco => {
                let body = Central::of(paper)?;
                let (moments, axes) = body.principal();
                let numbers = [body.mass].into_iter().chain(body.centre.iter().copied());
                numbers.chain(axes).chain(moments).collect()
            }
        })
    }

    /// The paper's ten parameters of as many numbers as there are columns; `None` for
    /// another count, or a quaternion of length 0.
    #[must_use]
    pub fn to_paper(self, numbers: &[f64]) -> Option<[f64; 10]> {
        if self == Self::Mujoco {
            let &[mass, x, y, z, qw, qx, qy, qz, a, b, c] = numbers else {
                return None;
            };
            let quaternion = [qw, qx, qy, qz];
            let turns = quaternion.iter().any(|q| *q != 0.0);
            let body = || Central::of_principal(mass, [x, y, z], [a, b, c], quaternion);
            return turns.then(|| body().paper());
        }
        let ten: [f64; 10] = numbers.try_into().ok()?;
        Some(match self {
            Self::Pinocchio => from_pinocchio(&ten),
            Self::Urdf => {
                let [mass, x, y, z, xx, xy, xz, yy, yz, zz] = ten;
                let centre = Vector3::new(x, y, z);
                let tensor = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
                Central {
                    mass,
                    centre,
                    tensor,
                }
                .paper()
            }
            Self::Paper | Self::Mujoco => ten,
        })
    }
}

/// M (c.c 1 - c c').
fn steiner(mass: f64, c: &Vector3<f64>) -> Matrix3<f64> {
    (Matrix3::identity() * c.norm_squared() - c * c.transpose()) * mass
}

#[cfg(test)]
mod tests {
    use super::*;
    use roberval_scalar::SplitMix64;

    #[test]
    fn every_form_leads_back() {
        /// Ten digits of values of about 1: roots and eigenvectors cost some.
        const EXACT: f64 = 1e-12;
        let mut random = SplitMix64::new(7);
        for _ in 0..500 {
            let mut paper: [f64; 10] = std::array::from_fn(|_| random.uniform(-1.0, 1.0));
            paper[9] = random.uniform(0.1, 3.0);
            assert_eq!(from_pinocchio(&to_pinocchio(&paper)), paper);
            for convention in Convention::ALL {
                let there = convention.of_paper(&paper).expect("it has mass");
                assert_eq!(there.len(), convention.columns().len());
                let back = convention.to_paper(&there).expect("as many");
                for (a, b) in back.iter().zip(&paper) {
                    assert!((a - b).abs() < EXACT, "{} {a} {b}", convention.name());
                }
            }
            let (moments, _) = Central::of(&paper).expect("it has mass").principal();
            assert!(moments[0] >= moments[1] && moments[1] >= moments[2]);
        }
    }

    #[test]
    fn a_ball_beside_the_origin_has_steiners_share() {
        let ball = Central {
            mass: 2.0,
            centre: Vector3::new(0.0, 0.0, 3.0),
            tensor: Matrix3::identity() * 0.5,
        };
        let expected = [18.5, 0.0, 0.0, 18.5, 0.0, 0.5, 0.0, 0.0, 6.0, 2.0];
        assert_eq!(ball.paper(), expected);
        assert_eq!(Central::of(&expected), Some(ball));
        let mut massless = expected;
        massless[9] = 0.0;
        assert_eq!(Central::of(&massless), None);
    }
}
