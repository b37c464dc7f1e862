//! Where numbers stand in a description.

use roberval_mechanism::{
    Couple, Geometry, JointKind, Mechanism, RobotDescription, Term, VariableLaw,
};
use roberval_scalar::Quantity;

/// Where a quantity of the geometry stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    Length,
    Angle,
    Other,
}

/// The couples of a robot with all chains of them resolved: each follows joints that follow
/// none.
pub(super) fn flat_couples(robot: &Mechanism) -> Option<Vec<Couple>> {
    let closure = robot.closure.as_ref().filter(|_| robot.is_affine())?;
    let joints: Vec<&String> = robot.moving().map(|link| &link.name).collect();
    let laws = closure.laws.iter().zip(&joints);
    let couple = |(law, joint): (&VariableLaw, &&String)| {
        let VariableLaw::Affine(law) = law else {
            return None;
        };
        let term = |(place, multiplier): &(usize, Quantity)| Term {
            joint: joints[closure.independent[*place]].clone(),
            multiplier: multiplier.clone(),
        };
        Some(Couple {
            joint: (*joint).clone(),
            terms: law.terms.iter().map(term).collect(),
            offset: law.offset.clone(),
            expression: None,
        })
    };
    Some(laws.filter_map(couple).collect())
}

/// The quantities of a link's geometry with the letters that name them.
fn geometry(geometry: &mut Geometry) -> Vec<(&'static str, Place, &mut Quantity)> {
    match geometry {
        Geometry::Mdh(g) => vec![
            ("gamma", Place::Angle, &mut g.gamma),
            ("b", Place::Length, &mut g.b),
            ("alpha", Place::Angle, &mut g.alpha),
            ("d", Place::Length, &mut g.d),
            ("theta", Place::Angle, &mut g.theta),
            ("r", Place::Length, &mut g.r),
        ],
        Geometry::Placed { origins, axis } => {
            let mut all = Vec::new();
            for origin in origins {
                let letters = ["x", "y", "z"].into_iter();
                all.extend(
                    letters
                        .zip(&mut origin.xyz)
                        .map(|(l, q)| (l, Place::Length, q)),
                );
                let letters = ["roll", "pitch", "yaw"].into_iter();
                all.extend(
                    letters
                        .zip(&mut origin.rpy)
                        .map(|(l, q)| (l, Place::Angle, q)),
                );
            }
            all.extend(axis.iter_mut().map(|q| ("axis", Place::Other, q)));
            all
        }
    }
}

/// The quantities of the geometry and the offsets of couples, with a name for each: `d3`.
pub(super) fn nameable(robot: &mut RobotDescription) -> Vec<(String, Place, &mut Quantity)> {
    let joint = |couple: &Couple| robot.links.iter().position(|l| l.name == couple.joint);
    let dependent: Vec<Option<(usize, JointKind)>> = robot
        .couples
        .iter()
        .map(|c| joint(c).map(|link| (link, robot.links[link].joint)))
        .collect();
    let links = robot.links.iter_mut().enumerate();
    let of_links = links.flat_map(|(link, description)| {
        let all = geometry(&mut description.geometry).into_iter();
        all.map(move |(letter, place, q)| (format!("{letter}{}", link + 1), place, q))
    });
    let couples = robot.couples.iter_mut().zip(dependent);
    let offsets = couples.filter_map(|(couple, joint)| {
        let (link, kind) = joint?;
        let place = match kind {
            JointKind::Revolute => Place::Angle,
            JointKind::Prismatic => Place::Length,
            JointKind::Fixed | JointKind::Floating => Place::Other,
        };
        Some((format!("offset{}", link + 1), place, &mut couple.offset))
    });
    of_links.chain(offsets).collect()
}

/// All quantities that the analysis depends on.
pub(super) fn places(robot: &RobotDescription) -> Vec<(Place, Quantity)> {
    let terms = robot.couples.iter().flat_map(|couple| &couple.terms);
    let multipliers = terms.map(|term| &term.multiplier);
    let others = robot.gravity.iter().chain(multipliers);
    let mut places: Vec<(Place, Quantity)> = others.map(|q| (Place::Other, q.clone())).collect();
    let mut robot = robot.clone();
    places.extend(
        nameable(&mut robot)
            .into_iter()
            .map(|(_, place, q)| (place, q.clone())),
    );
    places
}
