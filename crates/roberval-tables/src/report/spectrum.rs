//! The spectra that the float engines decide on, on a logarithmic scale.

use std::fmt::Write;

use roberval_base::{BaseParameters, Engine, Witness};

use super::html::{figure, text};
use crate::number::{scientific, size};

const WIDTH: f64 = 720.0;
const HEIGHT: f64 = 300.0;
const LEFT: f64 = 74.0;
const BOTTOM: f64 = 262.0;
const TOP: f64 = 16.0;
const RIGHT: f64 = 706.0;

/// Decades below the largest value that are drawn: zeros lie on the floor.
const MOST_DECADES: f64 = 24.0;

pub(super) fn section(answer: &BaseParameters) -> String {
    let diagnosis = &answer.diagnosis;
    let mut figures: Vec<String> = diagnosis
        .witnesses
        .iter()
        .filter(|w| matches!(w.engine, Engine::Qrii | Engine::Svd))
        .map(|w| spectrum(answer, w))
        .collect();
    if figures.is_empty() {
        let mut values = diagnosis.spectrum.clone();
        values.sort_by(|a, b| b.total_cmp(a));
        let own = Witness {
            engine: answer.engine,
            rank: answer.rank(),
            gap: diagnosis.gap,
            gap_at_structural: diagnosis.gap,
            spectrum: values,
            tolerance: diagnosis.tolerance,
        };
        figures.push(spectrum(answer, &own));
    }
    let lead = match diagnosis.structure {
        Some(_) => {
            "The count was decided without these numbers, in whole numbers modulo primes. \
                    They are the paper's own routes in floating point, as witnesses: what motion \
                    tells stays high, what it cannot tell falls to rounding."
        }
        None => {
            "What motion tells stays high, what it cannot tell falls to rounding; the count is \
                 where the values fall below the tolerance."
        }
    };
    format!(
        "<section><h2>How clear the count is</h2><p>{lead}</p>{}</section>",
        figures.concat()
    )
}

fn spectrum(answer: &BaseParameters, witness: &Witness) -> String {
    let name = match witness.engine {
        Engine::Svd => "Singular values \u{3c3}_i",
        Engine::Qr => "What the columns before leave of each column (QR)",
        _ => "Diagonal |T_ii| of QR with column pivoting (QRII)",
    };
    let gap = match witness.gap_at_structural {
        Some(gap) => format!(
            "The values fall by a factor of {} after number {}.",
            size(gap),
            answer.rank()
        ),
        None => "No value falls to zero.".to_owned(),
    };
    let agrees = if witness.rank == answer.rank() {
        String::new()
    } else {
        format!(" With its tolerance this engine counts {}.", witness.rank)
    };
    let caption = format!(
        "{gap} The dashed line is the tolerance, {}: below it a value counts as zero.{agrees}",
        size(witness.tolerance)
    );
    format!(
        "<h3>{}</h3>{}",
        text(name),
        figure(name, &plot(answer, witness), &caption)
    )
}

/// The axes of one plot: from value to pixel.
struct Axes {
    top: f64,
    floor: f64,
    count: usize,
}

impl Axes {
    fn of(witness: &Witness) -> Self {
        let logs = || {
            let tolerance = std::iter::once(&witness.tolerance);
            let values = witness.spectrum.iter().chain(tolerance);
            values
                .filter(|x| x.is_finite() && **x > 0.0)
                .map(|x| x.log10())
        };
        let top = logs().fold(f64::NEG_INFINITY, f64::max);
        let top = if top.is_finite() { top.ceil() } else { 0.0 };
        let floor = logs().fold(top - 1.0, f64::min).floor();
        Self {
            top,
            floor: floor.max(top - MOST_DECADES),
            count: witness.spectrum.len(),
        }
    }

    fn x(&self, place: f64) -> f64 {
        LEFT + (place + 0.5) / self.count.max(1) as f64 * (RIGHT - LEFT)
    }

    fn y(&self, value: f64) -> f64 {
        let log = if value > 0.0 {
            value.log10()
        } else {
            self.floor
        };
        let part = (self.top - log.clamp(self.floor, self.top)) / (self.top - self.floor);
        TOP + part * (BOTTOM - TOP)
    }
}

fn plot(answer: &BaseParameters, witness: &Witness) -> String {
    let axes = Axes::of(witness);
    let mut svg = format!("<svg class=\"fit\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" width=\"100%\">");
    let (b, values) = (answer.rank(), &witness.spectrum);
    if (1..values.len()).contains(&b) {
        // Writing to a string does not fail.
        let (above, below) = (axes.y(values[b - 1]), axes.y(values[b]));
        let _ = write!(
            svg,
            "<rect class=\"gap\" x=\"{LEFT}\" y=\"{above:.1}\" width=\"{:.1}\" height=\"{:.1}\"/>",
            RIGHT - LEFT,
            (below - above).max(0.0)
        );
    }
    ticks(&axes, &mut svg);
    let y = axes.y(witness.tolerance);
    let _ = write!(svg, "<path class=\"tol\" d=\"M{LEFT},{y:.1}H{RIGHT}\"/>");
    points(&axes, values, b, &mut svg);
    if let Some(gap) = witness.gap_at_structural {
        let x = axes.x(b as f64 - 0.5);
        let left = x > (LEFT + RIGHT) / 2.0;
        let _ = write!(
            svg,
            "<text class=\"strong\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"{}\">gap {}</text>",
            if left { x - 14.0 } else { x + 14.0 },
            (axes.y(values[b - 1]) + axes.y(values[b])) / 2.0 + 4.0,
            if left { "end" } else { "start" },
            size(gap)
        );
    }
    svg + "</svg>"
}

fn points(axes: &Axes, values: &[f64], b: usize, svg: &mut String) {
    let radius = (160.0 / values.len().max(1) as f64).clamp(1.6, 4.5);
    for (i, &value) in values.iter().enumerate() {
        let class = if i < b { "big" } else { "small" };
        let _ = write!(
            svg,
            "<circle class=\"m {class}\" cx=\"{:.1}\" cy=\"{:.1}\" r=\"{radius:.1}\" data-v=\"{}\"/>",
            axes.x(i as f64),
            axes.y(value),
            scientific(value)
        );
    }
}

fn ticks(axes: &Axes, svg: &mut String) {
    let step = ((axes.top - axes.floor) / 5.0).ceil().max(1.0);
    let mut decade = axes.top;
    while decade >= axes.floor {
        let y = axes.y(10.0_f64.powf(decade));
        let _ = write!(
            svg,
            "<path class=\"tick\" d=\"M{LEFT},{y:.1}H{RIGHT}\"/><text text-anchor=\"end\" x=\"{}\" y=\"{:.1}\">1e{decade}</text>",
            LEFT - 7.0,
            y + 4.5
        );
        decade -= step;
    }
    for (place, anchor) in [(0, "start"), (axes.count.saturating_sub(1), "end")] {
        let _ = write!(
            svg,
            "<text text-anchor=\"{anchor}\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            axes.x(place as f64),
            BOTTOM + 24.0,
            place + 1
        );
    }
}
