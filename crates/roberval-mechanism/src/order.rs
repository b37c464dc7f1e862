//! Links in an order in which every antecedent comes first.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

use crate::{MechanismError, RobotDescription};

/// A link's index in the file and its antecedent's.
type Step = (usize, Option<usize>);

/// The links, antecedents first, otherwise in file order.
pub(crate) fn antecedents_first(robot: &RobotDescription) -> Result<Vec<Step>, MechanismError> {
    if robot.links.is_empty() {
        return Err(MechanismError::Empty {
            robot: robot.name.clone(),
        });
    }
    let antecedents = resolve(robot)?;
    let mut successors = vec![Vec::new(); antecedents.len()];
    let mut ready = BinaryHeap::new();
    for (link, antecedent) in antecedents.iter().enumerate() {
        match antecedent {
            Some(a) => successors[*a].push(link),
            None => ready.push(Reverse(link)),
        }
    }
    let mut order = Vec::with_capacity(antecedents.len());
    while let Some(Reverse(link)) = ready.pop() {
        order.push((link, antecedents[link]));
        ready.extend(successors[link].iter().map(|&s| Reverse(s)));
    }
    if order.len() < antecedents.len() {
        return Err(unreached(robot, &order));
    }
    Ok(order)
}

fn resolve(robot: &RobotDescription) -> Result<Vec<Option<usize>>, MechanismError> {
    let mut index = HashMap::new();
    for (i, link) in robot.links.iter().enumerate() {
        if index.insert(link.name.as_str(), i).is_some() {
            return Err(MechanismError::DuplicateLink {
                link: link.name.clone(),
            });
        }
    }
    robot
        .links
        .iter()
        .map(|link| match &link.antecedent {
            None => Ok(None),
            Some(name) => index.get(name.as_str()).copied().map(Some).ok_or_else(|| {
                MechanismError::UnknownAntecedent {
                    link: link.name.clone(),
                    antecedent: name.clone(),
                }
            }),
        })
        .collect()
}

fn unreached(robot: &RobotDescription, order: &[Step]) -> MechanismError {
    let mut reached = vec![false; robot.links.len()];
    for &(link, _) in order {
        reached[link] = true;
    }
    MechanismError::Cycle {
        links: robot
            .links
            .iter()
            .zip(reached)
            .filter(|(_, reached)| !reached)
            .map(|(link, _)| link.name.clone())
            .collect(),
    }
}
