//! The command line as clap sees it.

mod values;

use std::path::PathBuf;

use clap::builder::NonEmptyStringValueParser;
use clap::{Args, ColorChoice, Parser, Subcommand};
use clap_complete::Shell;
use roberval_base::{Choice, Engine, Model, Options, Tolerance};
use roberval_code::{Language, What};
use roberval_mechanism::{CleanMode, Convention};
use roberval_scalar::Quantity;
use roberval_tables::Format;

use crate::error::CliError;

use values::{
    convention, engine, eps, format, gravity, language, model, positive, rows, seed, snap, threads,
    weights, what,
};

const EXAMPLES: &str = "\
Examples:
  roberval show                               the built-in robots
  roberval base puma560                       the tables of Gautier's paper
  roberval base arm.urdf --format json        for programs
  roberval base arm.toml --keep MX_2,MY_2     prefer these parameters
  roberval compare arm.urdf                   all models, all engines
  roberval clean arm.urdf -o clean.urdf       1.5708 becomes pi/2
  roberval regressor arm.urdf states.csv -o W.npy
  roberval scale arm.urdf --format csv        well scaled samples
  roberval reduce arm.urdf log.csv -o R.npz   what least squares needs of long logs
  roberval lint arm.urdf                      what is wrong with a robot file
  roberval base puma560 --symbolic            relations in D3, R3, D4, R4
  roberval code puma560 --lang c -o puma.c    inverse dynamics as code
  roberval demo                               a tour, with a report to look at

Exit codes: 0 clear, 1 computed but doubtful or engines disagree, 2 bad input.";

const BASE: &str = "\
LABELS are KIND_LINK with commas between them, such as MX_2,YY_forearm; the kinds are XX XY XZ
YY YZ ZZ MX MY MZ M Ia. csv has a row for each standard parameter and a column for each base
parameter that others regroup into: its sum-product with X is XB.

Examples:
  roberval base puma560 --engine svd --model h
  roberval base arm.urdf --choice pivoted --format latex -o tables.tex
  roberval base arm.urdf --gravity 0,-9.81,0 --drop M_tool";

const SHOW: &str = "\
Examples:
  roberval show                                       the built-in robots
  roberval show arm.urdf                              links, joints, geometry, values
  roberval show arm.urdf --order pinocchio            values as toDynamicParameters()
  roberval show arm.urdf --order mujoco --format csv  body_mass, body_ipos, body_iquat, body_inertia

The orders: paper (XX XY XZ YY YZ ZZ MX MY MZ M about the link's frame), pinocchio (m mx my mz
Ixx Ixy Iyy Ixz Iyz Izz about the joint's frame), urdf (about the centre of mass, link's axes),
mujoco (about the centre of mass, principal axes).";

const LINT: &str = "\
Each finding is a line: file:line:column: severity: what is wrong [rule]; what to do.
Rules: errors have the code of what a reader refuses, such as E240; warnings are
inertia, missing-inertial, units, rounded-angle, dust, degrees, axis, mimic, limits, remark.

Examples:
  roberval lint arm.urdf
  roberval lint robots/*.urdf --ignore missing-inertial,dust
  roberval lint robots/*.urdf --errors-only                    what readers refuse, nothing else
  roberval lint arm.urdf --format json -o findings.json

Exit codes: 0 nothing found, 1 findings, 2 a file cannot be read as a robot file at all.";

const COMPARE: &str = "\
Examples:
  roberval compare puma560
  roberval compare arm.urdf --snap off                     the file as written
  roberval compare arm.urdf --paper-tolerance=1.4e-17      as on the paper's VAX

Exit codes: 0 all routes agree, 1 they do not or one is in doubt, 2 bad input.";

const CLEAN: &str = "\
Only the numbers change: comments, order and everything else stay byte for byte.

Examples:
  roberval clean arm.urdf -o clean.urdf
  roberval clean arm.urdf > /dev/null             only tell what would change
  roberval clean arm.urdf --aggressive            1.57 and 3.14 too";

const DEMO: &str = "\
Takes the built-in PUMA 560, shows its parameters, finds the base parameters and writes a
report to look at. Nothing is downloaded.";

const COMPLETIONS: &str = "\
Examples:
  roberval completions bash > ~/.local/share/bash-completion/completions/roberval
  roberval completions zsh > ~/.zfunc/_roberval
  roberval completions fish > ~/.config/fish/completions/roberval.fish";

const STATES: &str = "\
States are a CSV file with the columns q_1.., qd_1.. and qdd_1.. (or q_NAME with the name of
the joint or of its link) in any order, or an NPZ file with the arrays q, qd and qdd of shape
(N, n). Model d0 needs no qd, model h no qdd. For a floating link L, q begins with q_L.x, q_L.y,
q_L.z and the quaternion q_L.qx, q_L.qy, q_L.qz, q_L.qw, and qd with qd_L.vx .. qd_L.wz, the
velocity in L's frame (so qdd, its rates): n is 6 more than the joints, and q has n + 1 columns.

The array has the shape (N, n, C) for d and d0 and (N, C) for h, in C order, C being the
standard parameters in the order of `roberval show`, or the base parameters with --base.
Only differences of the rows of h mean anything.";

const CODE: &str = "\
The code is straight-line, without allocation, and takes its parameters in the order that its
comments list. --format is for --counts.

Examples:
  roberval code puma560 --lang c --what tau -o puma.c
  roberval code arm.urdf --lang python --what regressor -o arm_regressor.py
  roberval code arm.urdf --counts";

const REDUCE: &str = "\
Logs are files with the columns q_1.., qd_1.., qdd_1.. and tau_1.. (CSV, Parquet; joints by number
or name) or the arrays q, qd, qdd and tau (NPZ). R.npz has R, Q'tau (qt_tau), residual_norm,
samples and the columns' names; numpy.linalg.solve(R, qt_tau) are the parameters. The memory
it takes does not grow with the samples.

Examples:
  roberval reduce arm.urdf log1.csv log2.parquet -o R.npz --base --friction viscous,coulomb
  roberval reduce arm.urdf logs/*.npz -o R.npz --checkpoint progress      resumes where it was";

const SCALE: &str = "\
The table shows what the search gained over random samples. --format csv writes the samples
found, in the form that `roberval regressor` reads; --format json has both.";

/// Base inertial parameters of robots, after Gautier (1991).
#[derive(Debug, Parser)]
#[command(name = "roberval", version, about, after_help = EXAMPLES, color = ColorChoice::Never)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// A tour: a built-in arm, its base parameters, a report to look at
    #[command(after_help = DEMO)]
    Demo(DemoArgs),
    /// Show a robot as it is understood; without a robot, list the built-in ones
    #[command(after_help = SHOW)]
    Show(ShowArgs),
    /// Find the base parameters and how the others regroup onto them
    #[command(after_help = BASE)]
    Base(BaseArgs),
    /// Analyse all models by all engines and tell whether they agree
    #[command(after_help = COMPARE)]
    Compare(CompareArgs),
    /// Write a robot file with its rounded angles and dust set right
    #[command(after_help = CLEAN)]
    Clean(CleanArgs),
    /// List what is wrong or suspicious in robot files
    #[command(after_help = LINT)]
    Lint(LintArgs),
    /// Write the regressor at joint states from a file as a NumPy array
    #[command(after_help = STATES)]
    Regressor(RegressorArgs),
    /// Write the reduced model as code: C, Rust, NumPy or MATLAB
    #[command(after_help = CODE)]
    Code(CodeArgs),
    /// Search for samples that scale W (section 4 of the paper's method)
    #[command(after_help = SCALE)]
    Scale(ScaleArgs),
    /// Reduce logs of states and torques to what least squares needs (Python's wheel only)
    #[command(after_help = REDUCE)]
    Reduce(ReduceArgs),
    /// Write a shell's completions of this command
    #[command(after_help = COMPLETIONS)]
    Completions(CompletionsArgs),
}

#[derive(Debug, Args)]
pub(crate) struct ShowArgs {
    /// A built-in robot, or a file: robot TOML or URDF; from Python's wheel also MJCF or xacro
    #[arg(value_parser = NonEmptyStringValueParser::new())]
    pub robot: Option<String>,
    /// Show the known inertial parameters instead, in this order and frame
    #[arg(long, requires = "robot", value_parser = convention())]
    pub order: Option<Convention>,
    #[command(flatten)]
    pub reading: ReadingArgs,
    #[command(flatten)]
    pub output: OutputArgs,
}

#[derive(Debug, Args)]
pub(crate) struct DemoArgs {
    /// The report to write
    #[arg(short, long, value_name = "FILE", default_value = "roberval-demo.html")]
    pub output: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct LintArgs {
    /// Robot TOML or URDF files, or names of built-in robots
    #[arg(required = true, value_parser = NonEmptyStringValueParser::new())]
    pub files: Vec<String>,
    /// Rules to leave out, by their names
    #[arg(long, value_name = "RULES", value_delimiter = ',')]
    pub ignore: Vec<String>,
    /// List errors alone: warnings are neither shown nor count for the exit code
    #[arg(long)]
    pub errors_only: bool,
    #[command(flatten)]
    pub output: OutputArgs,
}

#[derive(Debug, Args)]
pub(crate) struct CompletionsArgs {
    /// The shell
    pub shell: Shell,
}

#[derive(Debug, Args)]
pub(crate) struct BaseArgs {
    #[command(flatten)]
    pub robot: RobotArgs,
    #[command(flatten)]
    pub method: MethodArgs,
    #[command(flatten)]
    pub choice: ChoiceArgs,
    /// Write also a certificate, which `python -m roberval.check_certificate FILE` checks
    /// without this program
    #[arg(long, value_name = "FILE")]
    pub certificate: Option<PathBuf>,
    /// Write also a report to look at: one HTML page, offline
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// Show the relations in symbols: named constants stay symbols, and where there are
    /// none all lengths get names (d3, r4, x5)
    #[arg(long)]
    pub symbolic: bool,
    /// The closed-form rules of Gautier and Khalil alone, in symbols: what they leave, and
    /// what the numerical method still removes of that
    #[arg(long)]
    pub rules: bool,
    /// With --symbolic or --rules: give names to all lengths that have none
    #[arg(long)]
    pub name_lengths: bool,
    /// With --symbolic or --rules: write the relations also as a Python module for SymPy
    #[arg(long, value_name = "FILE")]
    pub sympy: Option<PathBuf>,
    #[command(flatten)]
    pub output: OutputArgs,
}

#[derive(Debug, Args)]
pub(crate) struct CodeArgs {
    #[command(flatten)]
    pub robot: RobotArgs,
    /// The language [default: c]
    #[arg(long, value_parser = language())]
    pub lang: Option<Language>,
    /// What the code computes: inverse dynamics, the reduced regressor d1, the energy row
    /// h1, the torques of gravity, the mass matrix
    #[arg(long, default_value = What::Tau.name(), value_parser = what())]
    pub what: What,
    /// The parameters it takes: base parameters, or all standard ones [default: base]
    #[arg(long, value_parser = ["base", "standard"])]
    pub parameters: Option<String>,
    /// Add friction to tau, Fv qd + Fc sign(qd), two parameters a joint
    #[arg(long)]
    pub friction: bool,
    /// Show what the code costs in place of the code: operations with standard and with
    /// base parameters, link by link
    #[arg(long)]
    pub counts: bool,
    #[command(flatten)]
    pub choice: ChoiceArgs,
    #[command(flatten)]
    pub output: OutputArgs,
}

#[derive(Debug, Args)]
pub(crate) struct CompareArgs {
    #[command(flatten)]
    pub robot: RobotArgs,
    #[command(flatten)]
    pub choice: ChoiceArgs,
    #[command(flatten)]
    pub output: OutputArgs,
}

#[derive(Debug, Args)]
pub(crate) struct RegressorArgs {
    #[command(flatten)]
    pub robot: RobotArgs,
    /// Joint states: CSV or NPZ
    pub states: PathBuf,
    /// Only the columns of the base parameters: the reduced model
    #[arg(long)]
    pub base: bool,
    #[command(flatten)]
    pub method: MethodArgs,
    #[command(flatten)]
    pub choice: ChoiceArgs,
    /// The NPY file to write (replaced as a whole or not at all); - is the standard output
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct ScaleArgs {
    #[command(flatten)]
    pub robot: RobotArgs,
    /// The linear model: dynamic, dynamic at rest, energy
    #[arg(long, default_value = "h", value_parser = model())]
    pub model: Model,
    /// Names the random starts: the same seed, the same samples
    #[arg(long, default_value_t = 0, value_parser = seed, allow_negative_numbers = true)]
    pub seed: u64,
    /// Rows of W [default: its columns]
    #[arg(long, value_name = "R", value_parser = rows, allow_negative_numbers = true)]
    pub rows: Option<usize>,
    /// The S = max|Wij| / min|Wij| to stop at
    #[arg(long, value_name = "S", default_value = "100", value_parser = positive)]
    pub target: f64,
    #[command(flatten)]
    pub output: OutputArgs,
}

/// What `roberval reduce` of the Python package takes.
#[derive(Debug, Args)]
pub struct ReduceArgs {
    /// A built-in robot, or a robot file
    #[arg(value_parser = NonEmptyStringValueParser::new())]
    pub robot: String,
    /// Logs: CSV, NPZ or Parquet files
    #[arg(required = true)]
    pub samples: Vec<PathBuf>,
    /// The NPZ file to write; - is the standard output
    #[arg(short, long, value_name = "R.npz")]
    pub output: PathBuf,
    /// Only the columns of the base parameters
    #[arg(long)]
    pub base: bool,
    /// Columns of friction to add for each joint, with commas between them
    #[arg(
        long,
        value_name = "KINDS",
        value_delimiter = ',',
        value_parser = ["viscous", "coulomb", "offset"]
    )]
    pub friction: Vec<String>,
    /// How much squared residuals count: a number for each row of the torques (W1,W2,...), or
    /// `columns`, those called w_1.. of the logs (in NPZ the array w)
    #[arg(long, value_name = "WEIGHTS", value_parser = weights)]
    pub weights: Option<Weights>,
    /// Threads [default: one a core]
    #[arg(long, value_name = "T", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<usize>,
    /// Save progress in this file, and resume from it
    #[arg(long, value_name = "FILE")]
    pub checkpoint: Option<PathBuf>,
    /// No progress bar
    #[arg(long)]
    pub quiet: bool,
    /// How the robot is read
    #[command(flatten)]
    pub reading: ReadingArgs,
}

/// Where the weights of `roberval reduce` are.
#[derive(Debug, Clone, PartialEq)]
pub enum Weights {
    /// In columns of the logs.
    Columns,
    /// Here, one for each row of the torques.
    Rows(Vec<f64>),
}

#[derive(Debug, Args)]
pub(crate) struct CleanArgs {
    /// A robot TOML or URDF file, or the name of a built-in robot
    #[arg(value_parser = NonEmptyStringValueParser::new())]
    pub robot: String,
    /// Set coarse roundings such as 1.57 right too
    #[arg(long)]
    pub aggressive: bool,
    /// Write the cleaned text to this file (replaced as a whole or not at all)
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct RobotArgs {
    /// A built-in robot, or a file: robot TOML or URDF; from Python's wheel also MJCF or xacro
    #[arg(value_parser = NonEmptyStringValueParser::new())]
    pub robot: String,
    #[command(flatten)]
    pub reading: ReadingArgs,
}

/// How a robot file is read.
#[derive(Debug, Clone, Args)]
pub struct ReadingArgs {
    /// Keep links on fixed joints of a URDF as links of their own
    #[arg(long)]
    pub keep_fixed: bool,
    /// Let the base move freely: the root link of a URDF, a link "0" for others
    #[arg(long)]
    pub floating: bool,
    /// Leave rotor inertias Ia out: ten parameters a link, the rigid bodies' own
    #[arg(long)]
    pub no_rotors: bool,
    /// Rounded angles (1.5708) and dust of the robot file: set right (default), taken as
    /// written (off), or coarse roundings such as 1.57 set right too (aggressive)
    #[arg(long, default_value = "default", value_parser = snap())]
    pub snap: CleanMode,
    /// Gravity in the base frame, m/s^2, instead of the robot file's
    #[arg(long, value_name = "X,Y,Z", value_parser = gravity, allow_hyphen_values = true)]
    pub gravity: Option<Gravity>,
}

/// Three numbers as written.
#[derive(Debug, Clone)]
pub struct Gravity(pub [Quantity; 3]);

#[derive(Debug, Clone, Args)]
pub(crate) struct MethodArgs {
    /// The linear model: dynamic, dynamic at rest, energy
    #[arg(long, default_value = Model::default().name(), value_parser = model())]
    pub model: Model,
    /// The route to rank and relations
    #[arg(long, default_value = Engine::default().name(), value_parser = engine())]
    pub engine: Engine,
    /// Rows of W [default: at least twice its columns]
    #[arg(long, value_name = "R", value_parser = rows, allow_negative_numbers = true)]
    pub rows: Option<usize>,
}

#[derive(Debug, Clone, Args)]
pub(crate) struct ChoiceArgs {
    /// Names the random samples: the same seed, the same answer
    #[arg(long, default_value_t = 0, value_parser = seed, allow_negative_numbers = true)]
    pub seed: u64,
    /// Which parameters to keep: those of smallest subscript (paper), the best
    /// conditioned (pivoted), or those preferred by --keep and --drop [default: paper]
    #[arg(long, value_parser = ["paper", "pivoted", "prefer"])]
    pub choice: Option<String>,
    /// Parameters to keep if possible, the most important first
    #[arg(long, value_name = "LABELS", value_delimiter = ',')]
    pub keep: Vec<String>,
    /// Parameters to regroup away if possible, the least wanted first
    #[arg(long, value_name = "LABELS", value_delimiter = ',')]
    pub drop: Vec<String>,
    /// Judge the rank by the paper's tau = r |T11| EPS; EPS is that of doubles, 2.2e-16,
    /// unless given (the paper's VAX had 1.4e-17)
    #[arg(
        long,
        value_name = "EPS",
        num_args = 0..=1,
        require_equals = true,
        value_parser = eps,
        default_missing_value = "2.220446049250313e-16"
    )]
    pub paper_tolerance: Option<f64>,
}

#[derive(Debug, Clone, Args)]
pub(crate) struct OutputArgs {
    /// How the result is written
    #[arg(long, default_value = Format::default().name(), value_parser = format())]
    pub format: Format,
    /// Write the result to this file (replaced as a whole or not at all)
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

impl MethodArgs {
    /// The options of the method.
    pub fn options(&self, choice: &ChoiceArgs) -> Result<Options, CliError> {
        Ok(Options {
            model: self.model,
            engine: self.engine,
            choice: choice.choice()?,
            tolerance: choice.tolerance(),
            seed: choice.seed,
            rows: self.rows,
        })
    }
}

impl ChoiceArgs {
    /// The rule of choice; preferences imply `prefer`.
    pub fn choice(&self) -> Result<Choice, CliError> {
        let preferences = self.prefers();
        match self.choice.as_deref() {
            Some(rule @ ("paper" | "pivoted")) if preferences => Err(CliError::Usage(format!(
                "--choice {rule} and --keep or --drop contradict each other: leave --choice out, \
                 or say --choice prefer"
            ))),
            Some("prefer") if !preferences => Err(CliError::Usage(
                "--choice prefer needs --keep LABELS or --drop LABELS, such as --keep MX_2,MY_2"
                    .to_owned(),
            )),
            Some("pivoted") => Ok(Choice::Pivoted),
            _ if preferences => Ok(Choice::Prefer {
                keep: self.keep.clone(),
                drop: self.drop.clone(),
            }),
            _ => Ok(Choice::Paper),
        }
    }

    fn prefers(&self) -> bool {
        !(self.keep.is_empty() && self.drop.is_empty())
    }

    /// Whether a choice is asked for, be it the one that is made anyway.
    pub fn is_asked(&self) -> bool {
        self.choice.is_some() || self.prefers()
    }

    /// When a number counts as zero.
    pub fn tolerance(&self) -> Tolerance {
        match self.paper_tolerance {
            Some(eps) => Tolerance::Paper { eps },
            None => Tolerance::default(),
        }
    }
}
