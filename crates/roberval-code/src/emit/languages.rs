//! What the languages call things.

use std::fmt::Write as _;

use super::expression::{Statement, Words};
use super::{Function, Language, statements};
use crate::graph::Op;

/// The words of a language around expressions, which are alike in all of them.
#[derive(Clone, Copy)]
pub(super) struct Frame(pub Language);

impl Frame {
    /// Joint variable k (from 0) in an array of states.
    pub fn element(self, array: &str, k: usize) -> String {
        match self.0 {
            Language::C | Language::Rust => format!("{array}[{k}]"),
            Language::Python => format!("{array}[..., {k}]"),
            Language::Matlab => format!("{array}(:, {})", k + 1),
        }
    }

    /// Element (i, k) (from 0) of a matrix with so many columns.
    pub fn matrix_element(self, array: &str, i: usize, k: usize, columns: usize) -> String {
        match self.0 {
            Language::C | Language::Rust => format!("{array}[{}]", i * columns + k),
            Language::Python => format!("{array}[..., {i}, {k}]"),
            Language::Matlab => format!("{array}(:, {}, {})", i + 1, k + 1),
        }
    }

    /// Element k (from 0) of an array that is the same at all states.
    pub fn constant_element(self, array: &str, k: usize) -> String {
        match self.0 {
            Language::Matlab => format!("{array}({})", k + 1),
            _ => format!("{array}[{k}]"),
        }
    }

    /// What operations are called.
    pub fn words(self) -> Words {
        let plain = Words {
            times: "*",
            over: "/",
            sign: "sign",
            sqrt: "sqrt",
            atan2: "atan2",
        };
        match self.0 {
            Language::C | Language::Rust => plain,
            Language::Python => Words {
                sign: "np.sign",
                sqrt: "np.sqrt",
                atan2: "np.arctan2",
                ..plain
            },
            Language::Matlab => Words {
                times: ".*",
                over: "./",
                ..plain
            },
        }
    }

    /// A file: what it is, then the functions.
    pub fn file(self, notes: &[String], functions: &[String]) -> String {
        let comment = |prefix: &str| {
            let line = |note: &String| format!("{prefix} {note}").trim_end().to_owned() + "\n";
            notes.iter().map(line).collect::<String>()
        };
        let functions = functions.join("\n");
        match self.0 {
            Language::C => format!("/*\n{} */\n#include <math.h>\n\n{functions}", comment(" *")),
            Language::Rust => format!("{}\n{functions}", comment("//")),
            Language::Python => format!("{}\nimport numpy as np\n\n\n{functions}", comment("#")),
            Language::Matlab => format!("{}\n{functions}", comment("%")),
        }
    }

    /// A function, from its first line to its last.
    pub fn function(self, function: &Function<'_>) -> String {
        let (lines, outputs) = statements(function.program, function.columns, self.0);
        let mut text = self.head(function);
        for line in &lines {
            let line = match line {
                Statement::Let(name, value) => self.binding(name, value),
                Statement::Turn(sine, cosine, angle) => self.turn(sine, cosine, angle),
            };
            let _ = writeln!(text, "    {line}");
        }
        let semicolon = if self.0 == Language::Python { "" } else { ";" };
        for (at, value) in outputs.iter().enumerate() {
            let place = self.place(function, at);
            let _ = writeln!(text, "    {place} = {value}{semicolon}");
        }
        text + &match self.0 {
            Language::C | Language::Rust => "}\n".to_owned(),
            Language::Python => format!("    return {}\n", function.output.0),
            Language::Matlab => "end\n".to_owned(),
        }
    }

    fn binding(self, name: &str, value: &str) -> String {
        match self.0 {
            Language::C => format!("const double {name} = {value};"),
            Language::Rust => format!("let {name} = {value};"),
            Language::Python => format!("{name} = {value}"),
            Language::Matlab => format!("{name} = {value};"),
        }
    }

    fn turn(self, sine: &Option<String>, cosine: &Option<String>, angle: &str) -> String {
        if self.0 == Language::Rust {
            let name = |x: &Option<String>| x.clone().unwrap_or_else(|| "_".to_owned());
            return format!("let ({}, {}) = sin_cos({angle});", name(sine), name(cosine));
        }
        let prefix = if self.0 == Language::Python {
            "np."
        } else {
            ""
        };
        let line = |(name, function): (&String, &str)| {
            self.binding(name, &format!("{prefix}{function}({angle})"))
        };
        let both = [
            sine.as_ref().zip(Some("sin")),
            cosine.as_ref().zip(Some("cos")),
        ];
        both.into_iter()
            .flatten()
            .map(line)
            .collect::<Vec<_>>()
            .join("\n    ")
    }

    /// Where the result of index `at` goes.
    fn place(self, function: &Function<'_>, at: usize) -> String {
        let (name, shape) = &function.output;
        let once = function.name.ends_with("_prepare");
        let both = |first: usize| match shape[..] {
            [_, columns] => format!("{}, {}", at / columns + first, at % columns + first),
            _ => (at + first).to_string(),
        };
        match self.0 {
            Language::C | Language::Rust => format!("{name}[{at}]"),
            _ if once => self.constant_element(name, at),
            Language::Python => format!("{name}[..., {}]", both(0)),
            Language::Matlab => format!("{name}(:, {})", both(1)),
        }
    }

    /// The lines before the first statement.
    fn head(self, function: &Function<'_>) -> String {
        match self.0 {
            Language::C => c_head(function),
            Language::Rust => rust_head(function),
            Language::Python => python_head(function),
            Language::Matlab => matlab_head(function),
        }
    }
}

fn has(function: &Function<'_>, which: impl Fn(&Op) -> bool) -> bool {
    function.program.nodes.iter().any(which)
}

fn has_sign(function: &Function<'_>) -> bool {
    has(function, |op| matches!(op, Op::Sign(_)))
}

/// The input arrays of which nothing is needed.
fn unread(function: &Function<'_>) -> Vec<&'static str> {
    let inputs = &function.program.inputs;
    let read = |name: &str| {
        has(
            function,
            |op| matches!(op, Op::Input(k) if inputs[*k as usize].array() == name),
        )
    };
    let names = function.inputs.iter().map(|(name, _)| *name);
    names.filter(|name| !read(name)).collect()
}

fn names(function: &Function<'_>) -> String {
    let names: Vec<&str> = function.inputs.iter().map(|(name, _)| *name).collect();
    names.join(", ")
}

fn c_head(function: &Function<'_>) -> String {
    let inputs = function.inputs.iter();
    let inputs: Vec<String> = inputs
        .map(|(name, n)| format!("const double {name}[{n}]"))
        .collect();
    let (output, shape) = &function.output;
    let size: usize = shape.iter().product();
    let sign = match has_sign(function) {
        true => "static double sign(double x)\n{\n    return (x > 0.0) - (x < 0.0);\n}\n\n",
        false => "",
    };
    let unread: String = unread(function)
        .iter()
        .map(|name| format!("    (void){name};\n"))
        .collect();
    format!(
        "{sign}void {}({}, double {output}[{size}])\n{{\n{unread}",
        function.name,
        inputs.join(", ")
    )
}

fn rust_head(function: &Function<'_>) -> String {
    let inputs = function.inputs.iter();
    let inputs: Vec<String> = inputs
        .map(|(name, n)| format!("{name}: &[f64; {n}]"))
        .collect();
    let (output, shape) = &function.output;
    let size: usize = shape.iter().product();
    let given = [
        (
            has(function, |op| matches!(op, Op::Cos(_) | Op::Sin(_))),
            "sin_cos: impl Fn(f64) -> (f64, f64), ",
        ),
        (
            has(function, |op| matches!(op, Op::Sqrt(_))),
            "sqrt: impl Fn(f64) -> f64, ",
        ),
        (
            has(function, |op| matches!(op, Op::Atan2(..))),
            "atan2: impl Fn(f64, f64) -> f64, ",
        ),
    ];
    let given: String = given.iter().filter(|g| g.0).map(|g| g.1).collect();
    let unread: String = unread(function)
        .iter()
        .map(|name| format!("    let _ = {name};\n"))
        .collect();
    let sign = match has_sign(function) {
        true => {
            "    let sign = |x: f64| if x > 0.0 { 1.0 } else if x < 0.0 { -1.0 } else { 0.0 };\n"
        }
        false => "",
    };
    format!(
        "#[allow(clippy::all)]\n#[rustfmt::skip]\n\
         pub fn {}({given}{}, {output}: &mut [f64; {size}]) {{\n{unread}{sign}",
        function.name,
        inputs.join(", ")
    )
}

fn python_head(function: &Function<'_>) -> String {
    let (output, shape) = &function.output;
    let mut text = format!("def {}({}):\n", function.name, names(function));
    for (name, _) in &function.inputs {
        let _ = writeln!(text, "    {name} = np.asarray({name}, dtype=float)");
    }
    let shape: String = shape.iter().map(|n| format!("{n},")).collect();
    let samples = match function.inputs[0].0 {
        "q" => "q.shape[:-1] + ",
        _ => "",
    };
    text + &format!("    {output} = np.empty({samples}({shape}))\n")
}

fn matlab_head(function: &Function<'_>) -> String {
    let (output, shape) = &function.output;
    let mut text = format!(
        "function {output} = {}({})\n",
        function.name,
        names(function)
    );
    if function.prepares {
        let _ = writeln!(
            text,
            "    if nargin == 1\n        {output} = {}_prepare(q);\n        return\n    end",
            function.name
        );
    }
    let shape: String = shape.iter().map(|n| format!(", {n}")).collect();
    let samples = match function.inputs[0].0 {
        "q" => "size(q, 1)",
        _ => "1",
    };
    text + &format!("    {output} = zeros({samples}{shape});\n")
}
