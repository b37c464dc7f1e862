//! The robot at joint variables 0, seen from the side that shows most of it.

mod camera;

use std::fmt::Write;

use nalgebra::{Matrix3, Vector3};
use roberval_base::BaseParameters;
use roberval_mechanism::{JointKind, Mechanism};

use super::html::{figure, kept, short, text};
use super::tree;
use camera::{Camera, HEIGHT, WIDTH};

/// Robots of more links have small signs and no names beside them.
const FEW: usize = 16;

/// Signs and names keep this far from the drawing's edge, in pixels.
const EDGE: f64 = 18.0;

/// A link's frame in the base frame.
struct Frame {
    rotation: Matrix3<f64>,
    origin: Vector3<f64>,
}

/// Sizes of the signs, in pixels: radius and half length of a joint, length of an axis.
struct Sizes {
    radius: f64,
    half: f64,
    axis: f64,
    bone: f64,
}

pub(super) fn section(answer: &BaseParameters) -> String {
    let steps: Vec<String> = (0..=11)
        .map(|n| format!("<i class=\"n{n}\"></i>"))
        .collect();
    let caption = format!(
        "The robot with all joint variables at 0. Cylinders turn, boxes slide; x, y and z of each \
         link's frame are red, green and blue. <span class=\"scale\">Parameters kept of a link: 0 \
         <span>{}</span> 11</span>",
        steps.concat()
    );
    format!(
        "<section><h2>The robot</h2>{}</section>",
        figure("Drawing of the robot", &drawing(answer), &caption)
    )
}

fn drawing(answer: &BaseParameters) -> String {
    let mechanism = &answer.mechanism;
    let frames = frames(mechanism);
    let few = frames.len() <= FEW;
    let sizes = if few {
        Sizes {
            radius: 10.0,
            half: 17.0,
            axis: 26.0,
            bone: 9.0,
        }
    } else {
        Sizes {
            radius: 5.0,
            half: 8.0,
            axis: 12.0,
            bone: 5.0,
        }
    };
    let origins: Vec<Vector3<f64>> = frames.iter().map(|f| f.origin).collect();
    let camera = Camera::of(&origins, &mechanism.gravity);
    let kept = kept(answer);
    let mut svg = format!("<svg class=\"fit\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" width=\"100%\">");
    base(&camera, &mut svg);
    for (j, link) in mechanism.links.iter().enumerate() {
        let (class, from) = match link.antecedent {
            None => ("base".to_owned(), Vector3::zeros()),
            Some(a) => (format!("n{}", kept[a].0), origins[a]),
        };
        let ([x1, y1], [x2, y2]) = (camera.point(&from), camera.point(&origins[j]));
        // Writing to a string does not fail.
        let _ = write!(
            svg,
            "<path class=\"bone {class}\" stroke-width=\"{}\" d=\"M{x1:.1},{y1:.1}L{x2:.1},{y2:.1}\"/>",
            sizes.bone
        );
    }
    let places = slide(mechanism, &frames, &camera, &sizes);
    let mut order: Vec<usize> = (0..frames.len()).collect();
    order.sort_by(|&a, &b| {
        camera
            .depth(&origins[a])
            .total_cmp(&camera.depth(&origins[b]))
    });
    for &j in &order {
        joint(
            mechanism, &frames[j], &camera, &sizes, j, places[j], kept[j], &mut svg,
        );
    }
    for &j in &order {
        triad(&frames[j], &camera, &sizes, &mut svg);
    }
    if few {
        labels(mechanism, &places, &sizes, &mut svg);
    }
    gravity(mechanism, &camera, &mut svg);
    svg + "</svg>"
}

fn frames(mechanism: &Mechanism) -> Vec<Frame> {
    let mut frames: Vec<Frame> = Vec::with_capacity(mechanism.links.len());
    for link in &mechanism.links {
        let frame = match link.antecedent {
            None => Frame {
                rotation: link.rotation,
                origin: link.origin,
            },
            Some(a) => Frame {
                rotation: frames[a].rotation * link.rotation,
                origin: frames[a].origin + frames[a].rotation * link.origin,
            },
        };
        frames.push(frame);
    }
    frames
}

/// Where the signs of the joints stand: at their origins, or moved along their own axis,
/// which changes nothing of the motion, where another sign is in the way.
fn slide(mechanism: &Mechanism, frames: &[Frame], camera: &Camera, sizes: &Sizes) -> Vec<[f64; 2]> {
    let mut places: Vec<[f64; 2]> = Vec::with_capacity(frames.len());
    for (link, frame) in mechanism.links.iter().zip(frames) {
        let [x, y] = camera.point(&frame.origin);
        let (dx, dy, _) = camera.direction(&(frame.rotation * link.axis));
        let step = 2.0 * sizes.half + 4.0;
        let free = |p: &[f64; 2]| {
            let far = |q: &[f64; 2]| (p[0] - q[0]).hypot(p[1] - q[1]) > 1.5 * sizes.half;
            let inside = |at: f64, size: f64| (EDGE..size - EDGE).contains(&at);
            inside(p[0], WIDTH) && inside(p[1], HEIGHT) && places.iter().all(far)
        };
        let along =
            [0.0, 1.0, -1.0, 2.0, -2.0, 3.0].map(|k| [x + k * step * dx, y + k * step * dy]);
        places.push(along.into_iter().find(free).unwrap_or([x, y]));
    }
    places
}

#[allow(clippy::too_many_arguments)] // one joint's sign needs all it is made of
fn joint(
    mechanism: &Mechanism,
    frame: &Frame,
    camera: &Camera,
    sizes: &Sizes,
    j: usize,
    place: [f64; 2],
    (count, all): (usize, usize),
    svg: &mut String,
) {
    let link = &mechanism.links[j];
    let (dx, dy, depth) = camera.direction(&(frame.rotation * link.axis));
    let (length, turn) = (dx.hypot(dy), dy.atan2(dx).to_degrees());
    let [x, y] = place;
    let [ox, oy] = camera.point(&frame.origin);
    if (x - ox).hypot(y - oy) > 1.0 {
        let _ = write!(
            svg,
            "<path class=\"gravity\" stroke-dasharray=\"2 3\" d=\"M{ox:.1},{oy:.1}L{x:.1},{y:.1}\"/>"
        );
    }
    let _ = write!(
        svg,
        "<g class=\"m n{count}\"><title>{}. {}, {}: {count} of {all} parameters kept</title><g transform=\"translate({x:.1} {y:.1}) rotate({turn:.1})\">",
        j + 1,
        text(&link.name),
        tree::joint(mechanism, j)
    );
    svg.push_str(&sign(link.joint, sizes, length, depth));
    svg.push_str("</g></g>");
}

/// A joint's sign along the horizontal: its axis has this length in the picture, and this depth.
fn sign(kind: JointKind, sizes: &Sizes, length: f64, depth: f64) -> String {
    let half = sizes.half * length;
    // The end that faces the viewer.
    let end = if depth < 0.0 { -half } else { half };
    let minor = sizes.radius * depth.abs();
    let r = sizes.radius;
    match kind {
        JointKind::Revolute => format!(
            "<path class=\"fill edge\" d=\"M{0:.1},{1:.1}H{2:.1}A{minor:.1},{r:.1} 0 0 1 {2:.1},{r:.1}H{0:.1}A{minor:.1},{r:.1} 0 0 1 {0:.1},{1:.1}Z\"/>\
             <ellipse class=\"cap edge\" cx=\"{end:.1}\" rx=\"{minor:.1}\" ry=\"{r:.1}\"/>",
            -half, -r, half
        ),
        JointKind::Prismatic => format!(
            "<rect class=\"fill edge\" x=\"{0:.1}\" y=\"{1:.1}\" width=\"{2:.1}\" height=\"{3:.1}\" rx=\"2\"/>\
             <path class=\"ax cap\" stroke=\"currentColor\" d=\"M{4:.1},0H{5:.1}\"/>",
            -half.max(r),
            -r,
            2.0 * half.max(r),
            2.0 * r,
            -1.7 * half,
            1.7 * half
        ),
        JointKind::Fixed => format!(
            "<path class=\"fill edge\" d=\"M{0:.1},0L0,{0:.1}L{1:.1},0L0,{1:.1}Z\"/>",
            -r, r
        ),
        JointKind::Floating => format!(
            "<circle class=\"fill edge\" r=\"{r:.1}\"/><circle class=\"cap edge\" r=\"{:.1}\"/>",
            0.5 * r
        ),
    }
}

fn triad(frame: &Frame, camera: &Camera, sizes: &Sizes, svg: &mut String) {
    let [x, y] = camera.point(&frame.origin);
    for (k, class) in ["x", "y", "z"].into_iter().enumerate() {
        let (dx, dy, _) = camera.direction(&frame.rotation.column(k).into_owned());
        let (dx, dy) = (dx * sizes.axis, dy * sizes.axis);
        let _ = write!(
            svg,
            "<path class=\"ax {class}\" d=\"M{x:.1},{y:.1}l{dx:.1},{dy:.1}\"/>"
        );
    }
}

/// Numbers beside the joints, and short names where there are names.
fn labels(mechanism: &Mechanism, places: &[[f64; 2]], sizes: &Sizes, svg: &mut String) {
    /// Longer names would cover the drawing.
    const LONGEST: usize = 16;
    let mut taken: Vec<[f64; 2]> = Vec::new();
    for (j, ([x, y], link)) in places.iter().zip(&mechanism.links).enumerate() {
        let number = (j + 1).to_string();
        let name = match &link.name {
            name if *name == number => number,
            name => format!("{number} {}", short(name, LONGEST)),
        };
        let left = *x > WIDTH * 0.62;
        let x = if left {
            x - sizes.radius - 9.0
        } else {
            x + sizes.radius + 9.0
        };
        let mut y = (y - sizes.radius).max(EDGE);
        let step = if y < 3.0 * EDGE { 6.0 } else { -6.0 };
        while taken
            .iter()
            .any(|t| (t[0] - x).abs() < 90.0 && (t[1] - y).abs() < 17.0)
        {
            y += step;
        }
        taken.push([x, y]);
        let _ = write!(
            svg,
            "<text class=\"halo\" text-anchor=\"{}\" x=\"{x:.1}\" y=\"{y:.1}\">{}</text>",
            if left { "end" } else { "start" },
            text(&name)
        );
    }
}

/// The ground under the base, square to gravity.
fn base(camera: &Camera, svg: &mut String) {
    let [x, y] = camera.point(&Vector3::zeros());
    let _ = write!(
        svg,
        "<ellipse class=\"fill base m\" cx=\"{x:.1}\" cy=\"{y:.1}\" rx=\"30\" ry=\"{:.1}\"><title>the base</title></ellipse>",
        30.0 * camera.tilt()
    );
}

fn gravity(mechanism: &Mechanism, camera: &Camera, svg: &mut String) {
    let g = mechanism.gravity;
    if g.norm() == 0.0 {
        return;
    }
    let (dx, dy, _) = camera.direction(&g.normalize());
    let (x, y) = (26.0, 34.0);
    let (ex, ey) = (x + 46.0 * dx, y + 46.0 * dy);
    let _ = write!(
        svg,
        "<path class=\"gravity\" d=\"M{x},{y}L{ex:.1},{ey:.1}m-4,-7l4,7l4,-7\"/><text x=\"{:.1}\" y=\"{:.1}\">g</text>",
        x + 9.0,
        y + 14.0
    );
}
