use roberval_mechanism::{Couple, Geometry, LinkDescription, Mechanism, SourceFormat};
use roberval_scalar::Quantity;
use serde_json::{Map, Value, json};

use super::described;
use crate::json::pretty;
use crate::{couples, robot};

/// The robot for programs; numbers as written stand beside their values.
pub(crate) fn json(mechanism: &Mechanism) -> String {
    let description = &mechanism.description;
    let space = mechanism.parameters();
    let constants: Map<String, Value> = description
        .constants
        .iter()
        .map(|(name, x)| (name.clone(), quantity(x)))
        .collect();
    let couples = &description.couples;
    let couple = |link: &LinkDescription| couples.iter().find(|c| c.joint == link.name);
    let geometry: Vec<Value> = described(mechanism)
        .map(|(_, link)| geometry(link, couple(link)))
        .collect();
    pretty(&json!({
        "schema": 1,
        "robot": robot::json(mechanism),
        "source": match description.format {
            SourceFormat::Mdh => "mdh",
            SourceFormat::Placed => "placed",
            SourceFormat::Urdf => "urdf",
        },
        "counts": {
            "links": mechanism.links.len(),
            "joint_variables": mechanism.dof(),
            "independent": mechanism.independent(),
            "positions": mechanism.positions(),
            "standard": space.len(),
        },
        "rows": mechanism.row_names(),
        "constants": constants,
        "geometry": geometry,
        "constraints": couples::json(mechanism),
        "parameters": robot::parameters(mechanism, &space),
        "inertia": inertia(mechanism),
        "warnings": description.warnings,
    }))
}

fn quantity(x: &Quantity) -> Value {
    json!({"text": x.text, "value": x.value})
}

fn geometry(link: &LinkDescription, couple: Option<&Couple>) -> Value {
    let three = |xs: &[Quantity; 3]| xs.each_ref().map(quantity).to_vec();
    let mut value = match &link.geometry {
        Geometry::Mdh(g) => json!({
            "link": link.name,
            "gamma": quantity(&g.gamma),
            "b": quantity(&g.b),
            "alpha": quantity(&g.alpha),
            "d": quantity(&g.d),
            "theta": quantity(&g.theta),
            "r": quantity(&g.r),
        }),
        Geometry::Placed { origins, axis } => {
            let origins = origins.iter().map(|origin| {
                json!({
                    "joint": origin.joint,
                    "xyz": three(&origin.xyz),
                    "rpy": three(&origin.rpy),
                })
            });
            json!({
                "link": link.name,
                "origins": origins.collect::<Vec<_>>(),
                "axis": three(axis),
            })
        }
    };
    value["active"] = link.active.into();
    value["rotor"] = link.rotor.into();
    value["massless"] = link.massless.into();
    value["limits"] = json!(link.limits.map(|(lower, upper)| [lower, upper]));
    value["couple"] = match couple {
        None => Value::Null,
        Some(couple) => {
            let terms = couple.terms.iter();
            let terms = terms.map(|t| (t.joint.clone(), quantity(&t.multiplier)));
            json!({
                "equals": Value::Object(terms.collect()),
                "offset": quantity(&couple.offset),
                "expression": couple.expression.as_ref().map(|e| &e.text),
            })
        }
    };
    value
}

/// What the robot file gives: {label: value}.
fn inertia(mechanism: &Mechanism) -> Value {
    let space = mechanism.parameters();
    let known = space
        .ids()
        .iter()
        .zip(space.labels())
        .filter_map(|(id, label)| {
            let value = mechanism.links[id.link].inertia[id.kind as usize]?;
            Some((label.clone(), Value::from(value)))
        });
    Value::Object(known.collect())
}
