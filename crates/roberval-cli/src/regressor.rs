//! `roberval regressor`: W as a NumPy array, in blocks.

use std::io::{self, Write};

use roberval_base::{BaseError, BaseParameters, Engine, Model, base_parameters};
use roberval_mechanism::Mechanism;
use roberval_regressor::{Regressor, RegressorError};

use crate::arguments::RegressorArgs;
use crate::error::CliError;
use crate::output::Target;
use crate::robot::load;
use crate::states::{self, StateTable};
use crate::{CLEAR, DOUBTFUL, say};

/// Numbers of W that are in memory at a time.
const BLOCK: usize = 1 << 18;

/// Writes W, shape (N, n, C) for d and d0 and (N, C) for h, or with b columns.
pub(crate) fn run(
    args: &RegressorArgs,
    out: &mut dyn Write,
    err: &mut dyn Write,
) -> Result<i32, CliError> {
    let options = args.method.options(&args.choice)?;
    let decides = options.engine != Engine::default() || options.rows.is_some();
    if !args.base && (decides || args.choice.is_asked() || args.choice.paper_tolerance.is_some()) {
        let what = "--engine, --rows, --choice, --keep, --drop and --paper-tolerance find base \
                    parameters: they go with --base";
        return Err(CliError::Usage(what.to_owned()));
    }
    let target = Target::new(Some(&args.output))?;
    let mechanism = load(&args.robot.robot, &args.robot.reading)?;
    for warning in &mechanism.description.warnings {
        say(err, "warning", warning);
    }
    let model = args.method.model;
    let states = states::read(&args.states, &mechanism, model, &mut |what| {
        say(err, "note", &what);
    })?;
    let base = match args.base {
        true => Some(base_parameters(&mechanism, &options)?),
        false => None,
    };
    let columns = match &base {
        Some(answer) => answer.base.clone(),
        None => (0..mechanism.parameters().len()).collect(),
    };
    let w = Rows {
        mechanism: &mechanism,
        regressor: Regressor::new(&mechanism),
        model,
        columns,
        states: &states,
    };
    w.check()?;
    target.write(out, |sink| w.write(sink))?;
    say(err, "note", &format!("{} of float64", w.describe()));
    Ok(doubt(base.as_ref(), err))
}

fn doubt(base: Option<&BaseParameters>, err: &mut dyn Write) -> i32 {
    let Some(answer) = base else { return CLEAR };
    for message in &answer.diagnosis.messages {
        say(err, "doubt", message);
    }
    if answer.diagnosis.clear {
        CLEAR
    } else {
        DOUBTFUL
    }
}

/// The rows of W at some states.
struct Rows<'a> {
    mechanism: &'a Mechanism,
    regressor: Regressor,
    model: Model,
    columns: Vec<usize>,
    states: &'a StateTable,
}

impl Rows<'_> {
    fn shape(&self) -> Vec<usize> {
        let (count, width) = (self.states.count, self.columns.len());
        match self.model {
            Model::D | Model::D0 => vec![count, self.mechanism.independent(), width],
            Model::H => vec![count, width],
        }
    }

    /// Refuses bad states before anything is written.
    fn check(&self) -> Result<(), BaseError> {
        let states = self.states.slice(0, self.states.count, self.mechanism);
        self.regressor.check(self.model, states)?;
        Ok(())
    }

    fn describe(&self) -> String {
        let lengths: Vec<String> = self.shape().iter().map(ToString::to_string).collect();
        format!("wrote an array of {}", lengths.join(" x "))
    }

    /// NPY, version 1.0, C order.
    fn write(&self, sink: &mut dyn Write) -> io::Result<()> {
        sink.write_all(&header(&self.shape()))?;
        let dof = self.mechanism.independent();
        let row = self.model.rows(dof) * self.columns.len();
        let block = (BLOCK / row.max(1)).max(1);
        let mut numbers = Vec::new();
        let mut bytes = Vec::new();
        for from in (0..self.states.count).step_by(block) {
            let to = (from + block).min(self.states.count);
            numbers.resize((to - from) * row, 0.0);
            self.fill(from, to, &mut numbers)
                .map_err(io::Error::other)?;
            bytes.clear();
            bytes.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
            sink.write_all(&bytes)?;
        }
        Ok(())
    }

    fn fill(&self, from: usize, to: usize, numbers: &mut [f64]) -> Result<(), RegressorError> {
        let states = self.states.slice(from, to, self.mechanism);
        if self.columns.len() == self.regressor.parameters().len() {
            return self.regressor.fill(self.model, states, numbers);
        }
        self.regressor
            .fill_columns(self.model, &self.columns, states, numbers)
    }
}

/// Magic, version and a header that ends on a multiple of 64 bytes.
fn header(shape: &[usize]) -> Vec<u8> {
    let lengths: Vec<String> = shape.iter().map(ToString::to_string).collect();
    let lengths = lengths.join(", ");
    let mut text =
        format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({lengths}), }}").into_bytes();
    while (10 + text.len() + 1) % 64 != 0 {
        text.push(b' ');
    }
    text.push(b'\n');
    // Four lengths of 20 digits fit into 128 bytes.
    let size = u16::try_from(text.len()).unwrap_or(u16::MAX);
    let mut header = b"\x93NUMPY\x01\x00".to_vec();
    header.extend(size.to_le_bytes());
    header.extend(text);
    header
}
