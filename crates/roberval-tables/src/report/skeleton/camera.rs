//! From metres in the base frame to pixels.

use nalgebra::Vector3;

/// The drawing's size, in pixels.
pub(super) const WIDTH: f64 = 720.0;
pub(super) const HEIGHT: f64 = 470.0;

/// Room for signs and names around the joints.
const MARGIN: f64 = 62.0;

/// How far the viewer stands above the horizon, rad.
const ELEVATION: f64 = 0.38;

/// A parallel projection.
pub(super) struct Camera {
    right: Vector3<f64>,
    up: Vector3<f64>,
    towards: Vector3<f64>,
    scale: f64,
    centre: [f64; 2],
}

impl Camera {
    /// Gravity points down; of some directions, the one in which the joints fill the
    /// largest part of the drawing.
    pub fn of(origins: &[Vector3<f64>], gravity: &Vector3<f64>) -> Self {
        let up = (-gravity).try_normalize(0.0).unwrap_or_else(Vector3::z);
        let start = [Vector3::x(), Vector3::y()]
            .into_iter()
            .map(|axis| axis - up * up.dot(&axis))
            .find(|rest| rest.norm() > 0.5)
            .unwrap_or_else(Vector3::x)
            .normalize();
        let side = up.cross(&start);
        let mut points = origins.to_vec();
        points.push(Vector3::zeros());
        // Never along an axis of the base frame.
        let cameras = (-6..6).map(|step| {
            let azimuth = (f64::from(step) + 0.5) * std::f64::consts::PI / 6.0;
            let level = start * azimuth.cos() + side * azimuth.sin();
            let towards = level * ELEVATION.cos() + up * ELEVATION.sin();
            let right = up.cross(&towards).normalize();
            Self::fitted(right, towards.cross(&right), towards, &points)
        });
        let best = cameras.reduce(|best, other| {
            // A view as good as an earlier one is not taken for it: rounding decides nothing.
            if other.scale_and_spread(&points) > best.scale_and_spread(&points) * 1.000_001 {
                other
            } else {
                best
            }
        });
        best.unwrap_or_else(|| Self::fitted(Vector3::x(), Vector3::z(), -Vector3::y(), &points))
    }

    fn fitted(
        right: Vector3<f64>,
        up: Vector3<f64>,
        towards: Vector3<f64>,
        points: &[Vector3<f64>],
    ) -> Self {
        let range = |axis: &Vector3<f64>| {
            let along = points.iter().map(|p| p.dot(axis));
            along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                (low.min(x), high.max(x))
            })
        };
        let ((left, right_end), (bottom, top)) = (range(&right), range(&up));
        let fit = |room: f64, size: f64| {
            if size > 0.0 {
                room / size
            } else {
                f64::INFINITY
            }
        };
        let scale = fit(WIDTH - 2.0 * MARGIN, right_end - left)
            .min(fit(HEIGHT - 2.0 * MARGIN, top - bottom));
        Self {
            right,
            up,
            towards,
            scale: if scale.is_finite() { scale } else { 1.0 },
            centre: [(left + right_end) / 2.0, (bottom + top) / 2.0],
        }
    }

    /// How far apart the joints come to lie, in pixels.
    fn scale_and_spread(&self, points: &[Vector3<f64>]) -> f64 {
        let pairs = points.windows(2);
        let apart = |pair: &[Vector3<f64>]| {
            let ([a, b], [c, d]) = (self.point(&pair[0]), self.point(&pair[1]));
            (a - c).hypot(b - d)
        };
        pairs.map(apart).sum()
    }

    pub fn point(&self, p: &Vector3<f64>) -> [f64; 2] {
        [
            WIDTH / 2.0 + (p.dot(&self.right) - self.centre[0]) * self.scale,
            HEIGHT / 2.0 - (p.dot(&self.up) - self.centre[1]) * self.scale,
        ]
    }

    /// A unit direction on the page, and how much of it points at the viewer.
    pub fn direction(&self, d: &Vector3<f64>) -> (f64, f64, f64) {
        (d.dot(&self.right), -d.dot(&self.up), d.dot(&self.towards))
    }

    pub fn depth(&self, p: &Vector3<f64>) -> f64 {
        p.dot(&self.towards)
    }

    /// What a level circle's height is of its width.
    pub fn tilt(&self) -> f64 {
        ELEVATION.sin()
    }
}
