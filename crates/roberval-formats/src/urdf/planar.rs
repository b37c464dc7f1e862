//! A planar joint as three joints with an axis.

use roberval_mechanism::{Geometry, JointKind, LinkDescription, Origin};
use roberval_scalar::Quantity;

type Axis = [Quantity; 3];

/// The link on a planar joint, given as one that turns about the plane's normal, after two
/// links without bodies that slide along the plane: joints `J.x`, `J.y` and `J`. Nothing
/// drives them.
pub(super) fn chain(link: LinkDescription, normal: &Axis) -> [LinkDescription; 3] {
    let [u, v] = in_plane(normal);
    let joint = link.joint_name.clone().unwrap_or_default();
    let (link_name, origins) = (link.name.clone(), origins(&link));
    let slide = |along: &str, antecedent, origins, axis| LinkDescription {
        name: format!("{link_name}.{along}"),
        joint_name: Some(format!("{joint}.{along}")),
        antecedent,
        joint: JointKind::Prismatic,
        active: false,
        rotor: false,
        massless: true,
        geometry: Geometry::Placed { origins, axis },
        inertia: Default::default(),
        limits: None,
    };
    let x = slide("x", link.antecedent.clone(), origins, u);
    let here = || vec![Origin::here(&joint)];
    let y = slide("y", Some(x.name.clone()), here(), v);
    let turn = LinkDescription {
        antecedent: Some(y.name.clone()),
        active: false,
        rotor: false,
        geometry: Geometry::Placed {
            origins: here(),
            axis: normal.clone(),
        },
        ..link
    };
    [x, y, turn]
}

fn origins(link: &LinkDescription) -> Vec<Origin> {
    match &link.geometry {
        Geometry::Placed { origins, .. } => origins.clone(),
        Geometry::Mdh(_) => Vec::new(),
    }
}

/// Two directions at right angles in the plane: with the largest component n_k of the
/// normal, `u = n_k e_k+1 - n_k+1 e_k` and `v = n x u`. For z they are x and y.
fn in_plane(normal: &Axis) -> [Axis; 2] {
    let size = |k: &usize| normal[*k].value.abs();
    let k = (0..3).rev().max_by(|a, b| size(a).total_cmp(&size(b)));
    let (k, zero) = (k.unwrap_or(2), Quantity::zero);
    let (next, last) = ((k + 1) % 3, (k + 2) % 3);
    let mut u = [zero(), zero(), zero()];
    let mut v = u.clone();
    if normal[next].value == 0.0 && normal[last].value == 0.0 {
        u[next] = expression("1");
        v[last] = expression(if normal[k].value > 0.0 { "1" } else { "-1" });
        return [u, v];
    }
    u[next] = normal[k].clone();
    u[k] = expression(&format!("-({})", normal[next].text));
    for i in 0..3 {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let [a, b, c, d] = [&normal[j], &u[k], &normal[k], &u[j]].map(|x| &x.text);
        v[i] = expression(&format!("({a})*({b}) - ({c})*({d})"));
    }
    [u, v]
}

/// An expression of decimals, which is one by its making (zero if it overflows: the
/// mechanism then refuses the axis).
fn expression(text: &str) -> Quantity {
    Quantity::parse_number(text, &[]).unwrap_or_else(|_| Quantity::zero())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axes(normal: [&str; 3]) -> [[f64; 3]; 2] {
        in_plane(&normal.map(expression)).map(|axis| axis.map(|x| x.value))
    }

    #[test]
    fn the_plane_of_an_axis_has_the_other_two() {
        assert_eq!(axes(["0", "0", "1"]), [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        assert_eq!(axes(["0", "0", "-2"]), [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]);
        assert_eq!(axes(["1", "0", "0"]), [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    }

    #[test]
    fn directions_in_the_plane_and_its_normal_are_at_right_angles() {
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        for normal in [["1", "2", "-4"], ["-3", "0.5", "0"], ["0", "-1", "-1"]] {
            let [u, v] = axes(normal);
            let n = normal.map(|x| x.parse::<f64>().expect("a number"));
            assert_eq!((dot(u, v), dot(u, n), dot(v, n)), (0.0, 0.0, 0.0));
            assert!(dot(u, u) > 0.0 && dot(v, v) > 0.0);
            let turned = [
                u[1] * v[2] - u[2] * v[1],
                u[2] * v[0] - u[0] * v[2],
                u[0] * v[1] - u[1] * v[0],
            ];
            assert!(dot(turned, n) > 0.0, "a positive angle turns u to v");
        }
    }
}
