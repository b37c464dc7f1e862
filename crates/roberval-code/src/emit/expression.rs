//! Nodes as expressions: what is used once stands where it is used, if that stays short.

use crate::graph::{Op, Signed};
use crate::program::{Input, Program};

/// Longer expressions get a name.
const LONGEST: usize = 72;

/// One line of code.
pub(super) enum Statement {
    /// `name = text`
    Let(String, String),
    /// Sine and cosine of one angle: their names and the angle. Either may be unused.
    Turn(Option<String>, Option<String>, String),
}

/// An expression, and how tightly it binds: 0 sums, 1 products, 2 all the rest.
#[derive(Clone)]
struct Text {
    text: String,
    level: u8,
}

impl Text {
    fn atom(text: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            level: 2,
        }
    }

    /// As an operand of something that binds this tightly.
    fn at(&self, level: u8) -> String {
        match self.level < level {
            true => format!("({})", self.text),
            false => self.text.clone(),
        }
    }
}

/// What operations are called.
pub(super) struct Words {
    pub times: &'static str,
    pub over: &'static str,
    pub sign: &'static str,
    pub sqrt: &'static str,
    pub atan2: &'static str,
}

/// The statements of a program, then its outputs as expressions.
pub(super) fn statements(
    program: &Program,
    words: &Words,
    input: impl Fn(Input) -> String,
) -> (Vec<Statement>, Vec<String>) {
    let uses = program.uses();
    let mut lines = Vec::new();
    let mut texts: Vec<Text> = Vec::with_capacity(program.nodes.len());
    let mut turns = Turns::of(program);
    for (at, op) in program.nodes.iter().enumerate() {
        let new = match *op {
            Op::Input(k) => Text::atom(input(program.inputs[k as usize])),
            Op::Cos(x) | Op::Sin(x) => {
                let angle = texts[x as usize].text.clone();
                Text::atom(turns.name(x, matches!(op, Op::Cos(_)), angle, &mut lines))
            }
            op => expression(op, words, &texts),
        };
        let computed = op.operands().count() == 2 || matches!(op, Op::Sqrt(_));
        let named = computed && (uses[at] > 1 || new.text.len() > LONGEST);
        texts.push(match named {
            true => {
                let name = format!("t{at}");
                lines.push(Statement::Let(name.clone(), new.text));
                Text::atom(name)
            }
            false => new,
        });
    }
    let output = |x: &Signed| {
        let text = &texts[x.node as usize];
        match x.negative {
            true => format!("-{}", text.at(2)),
            false => text.text.clone(),
        }
    };
    let outputs = program.outputs.iter().map(output).collect();
    (lines, outputs)
}

/// An operation on expressions.
fn expression(op: Op, words: &Words, texts: &[Text]) -> Text {
    let at = |x: u32, level: u8| texts[x as usize].at(level);
    let call = |function: &str, operands: &[u32]| {
        let operands: Vec<String> = operands.iter().map(|&x| at(x, 0)).collect();
        Text::atom(format!("{function}({})", operands.join(", ")))
    };
    let between = |x: String, sign: &str, y: String, level| Text {
        text: format!("{x} {sign} {y}"),
        level,
    };
    match op {
        Op::Constant(bits) => Text::atom(format!("{:?}", f64::from_bits(bits))),
        Op::Sign(x) => call(words.sign, &[x]),
        Op::Sqrt(x) => call(words.sqrt, &[x]),
        Op::Atan2(y, x) => call(words.atan2, &[y, x]),
        Op::Add(x, y) => between(at(x, 0), "+", at(y, 1), 0),
        Op::Sub(x, y) => between(at(x, 0), "-", at(y, 1), 0),
        Op::Mul(x, y) => between(at(x, 1), words.times, at(y, 2), 1),
        Op::Div(x, y) => between(at(x, 1), words.over, at(y, 2), 1),
        Op::Input(_) | Op::Cos(_) | Op::Sin(_) => unreachable!("named before"),
    }
}

/// Sines and cosines, both of an angle at once.
struct Turns {
    /// Angles, with whether their sine and cosine are needed, and whether that is done.
    angles: Vec<(u32, [bool; 2], bool)>,
}

impl Turns {
    fn of(program: &Program) -> Self {
        let mut angles: Vec<(u32, [bool; 2], bool)> = Vec::new();
        for op in &program.nodes {
            let (Op::Cos(x) | Op::Sin(x)) = *op else {
                continue;
            };
            let at = angles.iter().position(|(angle, ..)| *angle == x);
            let at = at.unwrap_or_else(|| {
                angles.push((x, [false; 2], false));
                angles.len() - 1
            });
            angles[at].1[usize::from(matches!(op, Op::Cos(_)))] = true;
        }
        Self { angles }
    }

    /// The name of a sine or cosine; the first one of an angle writes both.
    fn name(
        &mut self,
        angle: u32,
        cosine: bool,
        text: String,
        lines: &mut Vec<Statement>,
    ) -> String {
        let at = self.angles.iter().position(|(x, ..)| *x == angle);
        let at = at.expect("every angle was seen before");
        let names = [format!("s{}", at + 1), format!("c{}", at + 1)];
        let (_, needed, done) = &mut self.angles[at];
        if !*done {
            *done = true;
            let [s, c] = names.clone();
            lines.push(Statement::Turn(
                needed[0].then_some(s),
                needed[1].then_some(c),
                text,
            ));
        }
        names[usize::from(cosine)].clone()
    }
}
