//! The tree of links as lanes beside a table: each row a link, a branch a lane.

use roberval_mechanism::{JointKind, Mechanism};

use super::html::text;

/// Height of a row and width of a lane, in pixels.
const ROW: usize = 26;
const LANE: usize = 18;

/// More lanes than these run into one another.
const MOST_LANES: usize = 12;

/// A row of the table.
pub(super) struct Row {
    /// The link; `None` is the base.
    pub link: Option<usize>,
    lane: usize,
    /// The lane it comes from, where that is another one.
    from: usize,
    /// Lanes with a rail above and below this row.
    above: Vec<usize>,
    below: Vec<usize>,
}

/// The links depth first, the base before them.
pub(super) fn rows(mechanism: &Mechanism) -> Vec<Row> {
    let mut children = vec![Vec::new(); mechanism.links.len() + 1];
    for (j, link) in mechanism.links.iter().enumerate() {
        children[link.antecedent.map_or(0, |a| a + 1)].push(j + 1);
    }
    // The last child stays in its parent's lane, the others stand beside it.
    let mut order = Vec::new();
    let mut open = vec![(0, 0, 0)];
    while let Some((node, lane, from)) = open.pop() {
        order.push((node, lane, from));
        let count = children[node].len();
        for (i, &child) in children[node].iter().enumerate().rev() {
            let beside = usize::from(i + 1 < count);
            open.push((child, (lane + beside).min(MOST_LANES), lane));
        }
    }
    let place: Vec<usize> = {
        let mut place = vec![0; order.len()];
        order
            .iter()
            .enumerate()
            .for_each(|(row, o)| place[o.0] = row);
        place
    };
    let mut rows: Vec<Row> = order
        .iter()
        .map(|&(node, lane, from)| Row {
            link: node.checked_sub(1),
            lane,
            from,
            above: Vec::new(),
            below: Vec::new(),
        })
        .collect();
    for (node, children) in children.iter().enumerate() {
        let (top, lane) = (place[node], order[place[node]].1);
        // The rail of a link ends where its last child stands or branches off.
        let Some(bottom) = children.iter().map(|&c| place[c]).max() else {
            continue;
        };
        for row in top..bottom {
            rows[row].below.push(lane);
            rows[row + 1].above.push(lane);
        }
    }
    rows
}

/// The lanes of a row, its joint's sign in the colour of what its link keeps.
pub(super) fn lanes(mechanism: &Mechanism, row: &Row, widest: usize, class: &str) -> String {
    let x = |lane: usize| lane * LANE + LANE / 2 + 1;
    let (middle, mut rails) = (ROW / 2, String::new());
    let mut rail = |d: String| rails.push_str(&format!("<path class=\"rail\" d=\"{d}\"/>"));
    for &lane in &row.above {
        // A branch leaves the lane above its row, the last one ends it.
        if lane != row.lane || row.from == row.lane {
            rail(format!("M{0},0V{middle}", x(lane)));
        }
    }
    for &lane in &row.below {
        rail(format!("M{0},{middle}V{ROW}", x(lane)));
    }
    if row.from != row.lane {
        rail(format!(
            "M{0},0Q{0},{middle} {1},{middle}",
            x(row.from),
            x(row.lane)
        ));
    }
    let (x, width) = (x(row.lane), (widest + 1) * LANE + 2);
    format!(
        "<svg width=\"{width}\" height=\"{ROW}\" aria-hidden=\"true\">{rails}<g class=\"{class}\">{}</g></svg>",
        sign(mechanism, row.link, x, middle)
    )
}

/// A disc turns, a square slides, a rhomb is fixed, a ring floats, a bar is the base.
fn sign(mechanism: &Mechanism, link: Option<usize>, x: usize, y: usize) -> String {
    let Some(link) = link else {
        return format!(
            "<rect class=\"fill\" x=\"{}\" y=\"{}\" width=\"16\" height=\"7\" rx=\"2\"/>",
            x - 8,
            y - 3
        );
    };
    match mechanism.links[link].joint {
        JointKind::Revolute => {
            format!("<circle class=\"fill edge\" cx=\"{x}\" cy=\"{y}\" r=\"7.5\"/>")
        }
        JointKind::Prismatic => format!(
            "<rect class=\"fill edge\" x=\"{}\" y=\"{}\" width=\"13\" height=\"13\"/>",
            x - 6,
            y - 6
        ),
        JointKind::Fixed => format!(
            "<path class=\"fill edge\" d=\"M{x},{}l7,7l-7,7l-7,-7z\"/>",
            y - 7
        ),
        JointKind::Floating => format!(
            "<circle class=\"fill edge\" cx=\"{x}\" cy=\"{y}\" r=\"8\"/><circle class=\"cap edge\" cx=\"{x}\" cy=\"{y}\" r=\"4\"/>"
        ),
    }
}

/// The last lane of the tree.
pub(super) fn widest(rows: &[Row]) -> usize {
    rows.iter().map(|row| row.lane).max().unwrap_or(0)
}

/// `revolute joint elbow`, as text of the page.
pub(super) fn joint(mechanism: &Mechanism, link: usize) -> String {
    let link = &mechanism.links[link];
    let kind = link.joint.name();
    match &link.joint_name {
        Some(name) => format!("{kind} joint {}", text(name)),
        None => format!("{kind} joint"),
    }
}
