//! Programs in the words of a language.

mod expression;
mod languages;

use std::fmt;
use std::str::FromStr;

use crate::names::comment;
use crate::{Code, Input, Program};
use expression::Statement;
use languages::Frame;

/// A language that code is written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Language {
    /// C99.
    #[default]
    C,
    /// Rust without its standard library.
    Rust,
    /// Python with NumPy, over any number of samples at once.
    Python,
    /// MATLAB or Octave, over any number of samples at once.
    Matlab,
}

impl Language {
    /// All languages.
    pub const ALL: [Self; 4] = [Self::C, Self::Rust, Self::Python, Self::Matlab];

    /// `c`, `rust`, `python` or `matlab`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::C => "c",
            Self::Rust => "rust",
            Self::Python => "python",
            Self::Matlab => "matlab",
        }
    }
}

/// A word that is no [`Language`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnknownLanguage;

impl fmt::Display for UnknownLanguage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "languages are {}",
            Language::ALL.map(Language::name).join(", ")
        )
    }
}

impl std::error::Error for UnknownLanguage {}

impl FromStr for Language {
    type Err = UnknownLanguage;

    fn from_str(name: &str) -> Result<Self, UnknownLanguage> {
        let mut all = Self::ALL.into_iter();
        all.find(|language| language.name() == name)
            .ok_or(UnknownLanguage)
    }
}

/// One function to be written.
struct Function<'a> {
    name: String,
    /// Input arrays: name and length.
    inputs: Vec<(&'static str, usize)>,
    /// The result's name and shape.
    output: (&'static str, Vec<usize>),
    program: &'a Program,
    /// The columns of G.
    columns: usize,
    /// Whether the parameters alone, in place of all, give what is done once: MATLAB shows
    /// only the first function of a file.
    prepares: bool,
}

impl Code {
    /// The code as the text of a file. `hash` names the robot it was made for.
    #[must_use]
    pub fn text(&self, language: Language, hash: &str) -> String {
        let frame = Frame(language);
        let mut functions = vec![self.main_function()];
        functions.extend(self.prepare_function());
        // MATLAB names a file by its first function; elsewhere the order means nothing.
        let texts = functions.iter().map(|f| frame.function(f));
        frame.file(&self.notes(language, hash), &texts.collect::<Vec<_>>())
    }

    fn main_function(&self) -> Function<'_> {
        let width = |state: &&'static str| match *state {
            "q" => ("q", self.positions()),
            rate => (rate, self.velocities()),
        };
        let mut inputs: Vec<(&str, usize)> = self.what.states().iter().map(width).collect();
        if self.takes_transmission() {
            inputs.push(("g", self.velocities() * self.independent));
        }
        match &self.prepare {
            _ if !self.what.takes_parameters() => {}
            Some(prepare) => inputs.push(("k", prepare.outputs.len())),
            None => inputs.push(("x", self.parameters.len())),
        }
        Function {
            name: self.function(),
            inputs,
            output: (self.output(), self.shape()),
            program: &self.main,
            columns: self.independent,
            prepares: self.prepare.is_some(),
        }
    }

    fn prepare_function(&self) -> Option<Function<'_>> {
        let program = self.prepare.as_ref()?;
        Some(Function {
            name: format!("{}_prepare", self.function()),
            inputs: vec![("x", self.parameters.len())],
            output: ("k", vec![program.outputs.len()]),
            program,
            columns: self.independent,
            prepares: false,
        })
    }

    fn output(&self) -> &'static str {
        match self.what {
            crate::What::Tau | crate::What::Gravity => "tau",
            crate::What::Regressor => "d1",
            crate::What::Energy => "h1",
            crate::What::MassMatrix => "mass",
        }
    }

    /// What the reader of the code needs to know, a line each.
    fn notes(&self, language: Language, hash: &str) -> Vec<String> {
        let (count, once) = (self.count(), self.count_once());
        let hash: String = hash.chars().filter(char::is_ascii_alphanumeric).collect();
        let mut notes = vec![
            format!("{} of the robot {}", self.title(), comment(&self.robot)),
            format!("made by roberval {}", env!("CARGO_PKG_VERSION")),
            format!("robot sha256 {hash}"),
            format!(
                "{} multiplications, {} additions, {} sines and cosines a state",
                count.mul, count.add, count.trig
            ),
        ];
        if self.prepare.is_some() {
            let name = self.function();
            let call = match language {
                Language::Matlab => format!("k = {name}(x)"),
                _ => format!("{name}_prepare"),
            };
            notes.push(format!(
                "call {call} once for a set of parameters x: it makes k ({} multiplications, {} additions)",
                once.mul, once.add
            ));
        }
        notes.push(String::new());
        notes.extend(self.state_notes());
        notes.push(self.parameters_title().to_owned());
        for (at, label) in self.parameters.iter().enumerate() {
            notes.push(format!("  {} {} [{}]", at + 1, comment(label), unit(label)));
        }
        notes
    }

    /// What the numbers of a state are, and of the results.
    fn state_notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if let Some(base) = &self.floating {
            let base = comment(base);
            notes.extend([
                format!("link {base} floats. Before the joints stand"),
                "  in q: place of its origin [m], attitude as a quaternion x y z w,".to_owned(),
                "  both in the frame in which it floats;".to_owned(),
                "  in qd: velocity v of its origin [m/s], angular velocity w [rad/s],".to_owned(),
                "  both in its own frame;".to_owned(),
                "  in qdd: the rates of these six numbers (the origin accelerates by".to_owned(),
                "  dv + w x v);".to_owned(),
                "  among results: force [N], then moment [Nm] on it, in its own frame".to_owned(),
            ]);
        }
        notes.push("joint variables q, in rad or m; qd and qdd a s and a s^2:".to_owned());
        for (at, (name, kind)) in self.joints.iter().enumerate() {
            let unit = match kind {
                roberval_mechanism::JointKind::Prismatic => "m",
                _ => "rad",
            };
            notes.push(format!("  {} link {} [{unit}]", at + 1, comment(name)));
        }
        if self.takes_transmission() {
            let n = self.velocities();
            notes.push(format!(
                "loops: q, qd and qdd are those of all {n} joints; g is G with qd = G qda, {n} x {},",
                self.independent
            ));
            notes.push("row after row; results are those of the independent joints".to_owned());
        }
        notes
    }

    fn title(&self) -> &'static str {
        match self.what {
            crate::What::Tau => "inverse dynamics tau(q, qd, qdd), in Nm or N,",
            crate::What::Regressor => "regressor d1, with tau = d1 x, row after row,",
            crate::What::Energy => "energy row h1, with energy = h1 x up to a constant, in J,",
            crate::What::Gravity => "torques of gravity, in Nm or N,",
            crate::What::MassMatrix => "mass matrix, symmetric, row after row,",
        }
    }

    fn parameters_title(&self) -> &'static str {
        match self.what.takes_parameters() {
            true => "parameters x, about the origins of the links' frames:",
            false => "columns, by the parameters x that they belong to:",
        }
    }
}

/// The unit of a parameter by its kind.
fn unit(label: &str) -> &'static str {
    match label.split('_').next() {
        Some("MX" | "MY" | "MZ") => "kg m",
        Some("M") => "kg",
        Some("Fv") => "Nm s or N s",
        Some("Fc") => "Nm or N",
        Some("Ia") => "kg m^2 or kg",
        _ => "kg m^2",
    }
}

/// The statements of a program, its inputs named as arrays' elements; G has so many columns.
fn statements(
    program: &Program,
    columns: usize,
    language: Language,
) -> (Vec<Statement>, Vec<String>) {
    let frame = Frame(language);
    let input = |input: Input| {
        let array = input.array();
        match input {
            Input::Q(k) | Input::Qd(k) | Input::Qdd(k) => frame.element(array, k),
            Input::G(i, k) => frame.matrix_element(array, i, k, columns),
            Input::Parameter(k) | Input::Prepared(k) => frame.constant_element(array, k),
        }
    };
    expression::statements(program, &frame.words(), input)
}
