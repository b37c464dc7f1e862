//! Programs around the generated functions, which print their results.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use roberval_code::{Code, Language, Op};

use crate::cases::{Case, SAMPLES};

/// How a language's code is run.
pub struct Driver {
    language: Language,
    ending: &'static str,
    /// Whether what it needs is there.
    available: fn() -> Result<(), String>,
    /// The program that calls all functions.
    main: fn(&[Case], &Path) -> PathBuf,
    /// Builds it where needed and runs it.
    run: fn(&Path) -> Command,
}

pub const C: Driver = Driver {
    language: Language::C,
    ending: "c",
    available: || there("gcc", &["--version"]),
    main: c_main,
    run: |main| command(main.with_extension("").as_os_str(), &[]),
};

pub const RUST: Driver = Driver {
    language: Language::Rust,
    ending: "rs",
    available: || there("rustc", &["--version"]),
    main: rust_main,
    run: |main| command(main.with_extension("").as_os_str(), &[]),
};

pub const PYTHON: Driver = Driver {
    language: Language::Python,
    ending: "py",
    available: || there("python3", &["-c", "import numpy"]),
    main: python_main,
    run: |main| command("python3".as_ref(), &[main]),
};

pub const OCTAVE: Driver = Driver {
    language: Language::Matlab,
    ending: "m",
    available: || there("octave", &["--version"]),
    main: octave_main,
    run: |main| command("octave".as_ref(), &["--no-gui".as_ref(), main]),
};

fn command(program: &std::ffi::OsStr, arguments: &[&Path]) -> Command {
    let mut command = Command::new(program);
    command.args(arguments);
    command
}

fn there(program: &str, arguments: &[&str]) -> Result<(), String> {
    match Command::new(program).args(arguments).output() {
        Ok(output) if output.status.success() => Ok(()),
        _ => Err(format!(
            "{program} {} does not run here",
            arguments.join(" ")
        )),
    }
}

impl Driver {
    /// What the program prints; `None`, with the reason told, where it cannot be run.
    pub fn run(&self, cases: &[Case]) -> Option<String> {
        if let Err(reason) = (self.available)() {
            println!("skipped: {reason}");
            return None;
        }
        let name = format!("languages-{}-{}", self.language.name(), std::process::id());
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        fs::create_dir_all(&folder).expect("a folder");
        for case in cases {
            let path = folder.join(format!("{}.{}", case.code.function(), self.ending));
            fs::write(path, case.code.text(self.language, "0")).expect("a file");
        }
        let main = (self.main)(cases, &folder);
        let output = done((self.run)(&main).current_dir(&folder));
        fs::remove_dir_all(&folder).expect("the folder goes");
        Some(output)
    }
}

/// Runs a command that must succeed.
fn done(command: &mut Command) -> String {
    let output = command.output().expect("it runs");
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}: {error}");
    String::from_utf8(output.stdout).expect("text")
}

fn numbers(values: &[f64]) -> String {
    let values: Vec<String> = values.iter().map(|x| format!("{x:?}")).collect();
    values.join(", ")
}

/// An array of states: its name, and its numbers sample after sample.
struct Array<'a> {
    name: &'static str,
    values: &'a [f64],
}

impl Array<'_> {
    /// Numbers of a sample.
    fn width(&self) -> usize {
        self.values.len() / SAMPLES
    }
}

/// The states that a function takes, with their values.
fn states(case: &Case) -> Vec<Array<'_>> {
    let value = |name: &&'static str| Array {
        name,
        values: match *name {
            "q" => &case.q,
            "qd" => &case.qd,
            _ => &case.qdd,
        },
    };
    let mut arrays: Vec<Array<'_>> = case.code.what.states().iter().map(value).collect();
    if case.code.takes_transmission() {
        arrays.push(Array {
            name: "g",
            values: &case.g,
        });
    }
    arrays
}

/// An array's name and its shape at one state.
fn shaped(case: &Case, array: &Array<'_>) -> (&'static str, Vec<usize>) {
    match array.name {
        "g" => ("g", vec![case.code.velocities(), case.code.independent]),
        name => (name, vec![array.width()]),
    }
}

fn size(code: &Code) -> usize {
    code.shape().iter().product()
}

/// One translation unit a function, all compiled strictly.
fn c_main(cases: &[Case], folder: &Path) -> PathBuf {
    let (mut declarations, mut calls) = (String::new(), String::new());
    for case in cases {
        let (name, size) = (case.code.function(), size(&case.code));
        let mut parameters: Vec<String> = Vec::new();
        let mut arguments: Vec<String> = Vec::new();
        let _ = writeln!(calls, "  {{ double out[{size}]; int i, s;");
        for array in states(case) {
            let (array, n, values) = (array.name, array.width(), numbers(array.values));
            let _ = writeln!(calls, "    const double {array}[] = {{{values}}};");
            parameters.push(format!("const double {array}[{n}]"));
            arguments.push(format!("{array} + s * {n}"));
        }
        if case.code.what.takes_parameters() {
            let _ = writeln!(calls, "    const double x[] = {{{}}};", numbers(&case.x));
            let (width, count) = (case.x.len(), case.code.prepare.as_ref());
            match count.map(|p| p.outputs.len()) {
                Some(count) => {
                    let _ = writeln!(
                        declarations,
                        "void {name}_prepare(const double x[{width}], double k[{count}]);"
                    );
                    let _ = writeln!(calls, "    double k[{count}]; {name}_prepare(x, k);");
                    parameters.push(format!("const double k[{count}]"));
                    arguments.push("k".to_owned());
                }
                None => {
                    parameters.push(format!("const double x[{width}]"));
                    arguments.push("x".to_owned());
                }
            }
        }
        let _ = writeln!(
            declarations,
            "void {name}({}, double out[{size}]);",
            parameters.join(", ")
        );
        let _ = writeln!(
            calls,
            "    for (s = 0; s < {SAMPLES}; s++) {{ {name}({}, out);\n      \
             for (i = 0; i < {size}; i++) printf(\"%.17g\\n\", out[i]); }} }}",
            arguments.join(", ")
        );
    }
    let main = folder.join("main.c");
    let text =
        format!("#include <stdio.h>\n{declarations}int main(void) {{\n{calls}  return 0;\n}}\n");
    fs::write(&main, text).expect("a file");
    let sources = cases
        .iter()
        .map(|c| folder.join(format!("{}.c", c.code.function())));
    let strict = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror"];
    let mut gcc = Command::new("gcc");
    gcc.args(strict)
        .args(["-O0", "-o"])
        .arg(folder.join("main"))
        .arg(&main)
        .args(sources)
        .arg("-lm");
    done(&mut gcc);
    main
}

/// The functions of the standard library that Rust code takes.
fn functions(code: &Code) -> String {
    let has = |such: fn(&Op) -> bool| code.main.nodes.iter().any(such);
    let all = [
        (
            has(|op| matches!(op, Op::Cos(_) | Op::Sin(_))),
            "f64::sin_cos, ",
        ),
        (has(|op| matches!(op, Op::Sqrt(_))), "f64::sqrt, "),
        (has(|op| matches!(op, Op::Atan2(..))), "f64::atan2, "),
    ];
    all.iter().filter(|f| f.0).map(|f| f.1).collect()
}

/// The functions as modules; and as a library without std.
fn rust_main(cases: &[Case], folder: &Path) -> PathBuf {
    let (mut modules, mut calls) = (String::new(), String::new());
    for (at, case) in cases.iter().enumerate() {
        let (name, size) = (case.code.function(), size(&case.code));
        let _ = writeln!(modules, "pub mod m{at} {{ include!(\"{name}.rs\"); }}");
        let mut arguments = functions(&case.code);
        let _ = writeln!(calls, "    {{ let mut out = [0.0; {size}];");
        for array in states(case) {
            let (array, n, values) = (array.name, array.width(), numbers(array.values));
            let _ = writeln!(calls, "      let {array} = [{values}];");
            let _ = write!(arguments, "{array}[s * {n}..][..{n}].try_into().unwrap(), ");
        }
        if case.code.what.takes_parameters() {
            let _ = writeln!(calls, "      let x = [{}];", numbers(&case.x));
            match &case.code.prepare {
                Some(prepare) => {
                    let count = prepare.outputs.len();
                    let _ = writeln!(calls, "      let mut k = [0.0; {count}];");
                    let _ = writeln!(calls, "      m{at}::{name}_prepare(&x, &mut k);");
                    arguments += "&k, ";
                }
                None => arguments += "&x, ",
            }
        }
        let _ = writeln!(
            calls,
            "      for s in 0..{SAMPLES} {{ m{at}::{name}({arguments}&mut out); \
             for x in out {{ println!(\"{{x:?}}\"); }} }} }}"
        );
    }
    let main = folder.join("main.rs");
    fs::write(&main, format!("{modules}fn main() {{\n{calls}}}\n")).expect("a file");
    let library = folder.join("library.rs");
    fs::write(&library, format!("#![no_std]\n{modules}")).expect("a file");
    let rustc = |arguments: &[&str], source: &Path| {
        let mut rustc = Command::new("rustc");
        rustc.args(["--edition=2021", "-Dwarnings"]).args(arguments);
        done(rustc.arg(source).current_dir(folder));
    };
    rustc(&["--crate-type=lib", "--emit=metadata"], &library);
    rustc(&["-o", "main"], &main);
    main
}

/// All samples at once, and the first alone as well.
fn python_main(cases: &[Case], folder: &Path) -> PathBuf {
    let mut text = "import numpy as np\n".to_owned();
    for case in cases {
        let name = case.code.function();
        let _ = writeln!(text, "from {name} import *");
        let mut arguments: Vec<String> = Vec::new();
        for array in states(case) {
            let (values, array) = (numbers(array.values), shaped(case, &array));
            let (array, shape) = array;
            let shape: Vec<String> = shape.iter().map(usize::to_string).collect();
            let shape = shape.join(", ");
            let _ = writeln!(text, "{array} = np.array([{values}]).reshape(-1, {shape})");
            arguments.push(array.to_owned());
        }
        if case.code.what.takes_parameters() {
            let _ = writeln!(text, "x = [{}]", numbers(&case.x));
            arguments.push(match case.code.prepare {
                Some(_) => format!("{name}_prepare(x)"),
                None => "x".to_owned(),
            });
        }
        let _ = writeln!(text, "out = {name}({})", arguments.join(", "));
        let first = arguments
            .iter()
            .map(|a| match ["q", "qd", "qdd", "g"].contains(&a.as_str()) {
                true => format!("{a}[0]"),
                false => a.clone(),
            });
        let first: Vec<String> = first.collect();
        let _ = writeln!(
            text,
            "assert np.array_equal(out[0], {name}({}))",
            first.join(", ")
        );
        let _ = writeln!(text, "for value in out.ravel(): print(repr(float(value)))");
    }
    let main = folder.join("main.py");
    fs::write(&main, text).expect("a file");
    main
}

fn octave_main(cases: &[Case], folder: &Path) -> PathBuf {
    let mut text = String::new();
    for case in cases {
        let name = case.code.function();
        let mut arguments: Vec<String> = Vec::new();
        for array in states(case) {
            let (values, array) = (numbers(array.values), shaped(case, &array));
            let (array, shape) = array;
            let reversed: Vec<String> = shape.iter().rev().map(usize::to_string).collect();
            let (reversed, last) = (reversed.join(", "), shape.len() + 1);
            let _ = writeln!(text, "{array} = reshape([{values}], {reversed}, []);");
            let _ = writeln!(text, "{array} = permute({array}, [{last}:-1:1]);");
            arguments.push(array.to_owned());
        }
        if case.code.what.takes_parameters() {
            let _ = writeln!(text, "x = [{}];", numbers(&case.x));
            arguments.push(match case.code.prepare {
                Some(_) => format!("{name}(x)"),
                None => "x".to_owned(),
            });
        }
        let _ = writeln!(text, "out = {name}({});", arguments.join(", "));
        // Row-major, sample after sample.
        let _ = writeln!(text, "out = permute(out, [ndims(out):-1:1]);");
        let _ = writeln!(text, "printf('%.17g\\n', out);");
    }
    let main = folder.join("main.m");
    fs::write(&main, text).expect("a file");
    main
}
