//! The grammar:
//!
//! ```text
//! angle   = sum | product "deg"
//! sum     = product { ("+" | "-") product }
//! product = signed { ("*" | "/") signed }
//! signed  = { "+" | "-" } atom
//! atom    = number | name | "pi" | "sqrt" "(" sum ")" | "(" sum ")"
//! ```

use super::decimal::{Decimal, scan, too_long};
use super::{Expr, LiteralError, LiteralFault, MAX_LITERAL_BYTES, MAX_LITERAL_DEPTH, quoted};

/// Whether a trailing `deg` is part of the grammar.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Degrees {
    Allowed,
    Refused,
}

/// Reads a whole text as one expression.
pub(super) fn expression(text: &str, degrees: Degrees) -> Result<Expr, LiteralError> {
    if text.len() > MAX_LITERAL_BYTES {
        return Err(too_long(text));
    }
    let mut parser = Parser {
        text,
        at: 0,
        depth: 0,
    };
    parser.skip_space();
    if parser.rest().is_empty() {
        return Err(LiteralError::syntax(0, "the text is empty")
            .hint("write a number or an expression such as 0.25 or pi/2"));
    }
    let first = parser.product()?;
    let expr = if parser.word() == "deg" {
        parser.in_degrees(first, degrees)?
    } else {
        parser.sum_from(first)?
    };
    if parser.rest().is_empty() {
        return Ok(expr);
    }
    Err(parser.unexpected(match (parser.word(), degrees) {
        ("deg", Degrees::Allowed) => "deg applies to all before it: write (a + b) deg",
        ("deg", Degrees::Refused) => "only an angle may be in degrees",
        ("degree" | "degrees", Degrees::Allowed) => "write degrees as deg",
        ("rad" | "radians", Degrees::Allowed) => "an angle without a unit is in radians",
        _ => "expected + - * / or the end",
    }))
}

struct Parser<'a> {
    text: &'a str,
    at: usize,
    depth: usize,
}

impl<'a> Parser<'a> {
    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    fn skip_space(&mut self) {
        self.at = self.text.len() - self.rest().trim_start().len();
    }

    /// Takes one character and the space behind it.
    fn take(&mut self, wanted: char) -> bool {
        let found = self.rest().starts_with(wanted);
        if found {
            self.at += wanted.len_utf8();
            self.skip_space();
        }
        found
    }

    /// The name that starts here, possibly empty.
    fn word(&self) -> &'a str {
        let rest = self.rest();
        let end = rest
            .find(|c: char| !(c.is_ascii_alphanumeric() || c == '_'))
            .unwrap_or(rest.len());
        &rest[..end]
    }

    fn sum(&mut self) -> Result<Expr, LiteralError> {
        let first = self.product()?;
        self.sum_from(first)
    }

    /// The sum whose first term is read already.
    fn sum_from(&mut self, mut left: Expr) -> Result<Expr, LiteralError> {
        loop {
            if self.take('+') {
                left = Expr::Add(Box::new(left), Box::new(self.product()?));
            } else if self.take('-') {
                left = Expr::Sub(Box::new(left), Box::new(self.product()?));
            } else {
                return Ok(left);
            }
        }
    }

    fn product(&mut self) -> Result<Expr, LiteralError> {
        let mut left = self.signed()?;
        loop {
            if self.rest().starts_with("**") {
                return Err(self.unexpected("there are no powers: write a*a"));
            } else if self.take('*') {
                left = Expr::Mul(Box::new(left), Box::new(self.signed()?));
            } else if self.take('/') {
                left = Expr::Div(Box::new(left), Box::new(self.signed()?));
            } else {
                return Ok(left);
            }
        }
    }

    fn signed(&mut self) -> Result<Expr, LiteralError> {
        self.nested(|parser| {
            if parser.take('+') {
                parser.signed()
            } else if parser.rest().starts_with('-') {
                parser.take('-');
                let is_number = scan(parser.rest()) > 0;
                Ok(match parser.signed()? {
                    Expr::Number(x) if is_number => Expr::Number(x.negated()),
                    other => Expr::Neg(Box::new(other)),
                })
            } else {
                parser.atom()
            }
        })
    }

    fn atom(&mut self) -> Result<Expr, LiteralError> {
        let length = scan(self.rest());
        if length > 0 {
            return self.number(length);
        }
        if self.take('(') {
            return self.bracketed();
        }
        let (start, word) = (self.at, self.word());
        self.at += word.len();
        self.skip_space();
        let called = self.rest().starts_with('(');
        match word.to_ascii_lowercase().as_str() {
            "sqrt" if word == "sqrt" && called => {
                self.take('(');
                Ok(Expr::Sqrt(Box::new(self.bracketed()?)))
            }
            "nan" | "inf" | "infinity" => {
                let message = format!("{} is not a finite number", quoted(word));
                Err(LiteralError::not_finite(message).at(start))
            }
            _ if called && !word.is_empty() => Err(LiteralError::syntax(
                start,
                format!("unknown function {}", quoted(word)),
            )
            .hint("the only function is sqrt()")),
            "sqrt" if word == "sqrt" => Err(self.unexpected("expected ( after sqrt")),
            "pi" if word == "pi" => Ok(Expr::Pi),
            "" | "deg" => {
                self.at = start;
                Err(self.unexpected("expected a number, a name, pi, sqrt( or ("))
            }
            _ => Ok(Expr::Name(word.to_owned())),
        }
    }

    /// A number of `length` bytes, not glued to a name.
    fn number(&mut self, length: usize) -> Result<Expr, LiteralError> {
        let text = &self.rest()[..length];
        let number = Decimal::from_scanned(text).map_err(|e| e.at(self.at))?;
        self.at += length;
        let glued = self.word();
        if !glued.is_empty() && glued != "deg" {
            return Err(self.unexpected(match glued.as_bytes()[0] {
                b'x' | b'X' => "write it in decimal, not in hexadecimal",
                b'_' => "write the digits without _",
                b'e' | b'E' => "write an exponent as 1e-3",
                _ => "write a product with *, and no unit but deg (angles): lengths are in m",
            }));
        }
        self.skip_space();
        Ok(Expr::Number(number))
    }

    /// The sum after an opening bracket, up to and with the closing one.
    fn bracketed(&mut self) -> Result<Expr, LiteralError> {
        self.nested(|parser| {
            let inner = parser.sum()?;
            if parser.take(')') {
                Ok(inner)
            } else {
                Err(parser.unexpected("expected )"))
            }
        })
    }

    fn nested<T>(
        &mut self,
        read: impl FnOnce(&mut Self) -> Result<T, LiteralError>,
    ) -> Result<T, LiteralError> {
        self.depth += 1;
        if self.depth > MAX_LITERAL_DEPTH {
            return Err(LiteralError::new(
                LiteralFault::TooLarge,
                "the expression is nested too deeply",
            )
            .at(self.at)
            .hint(format!("at most {MAX_LITERAL_DEPTH} levels")));
        }
        let result = read(self);
        self.depth -= 1;
        result
    }

    /// `deg` after a product: nothing may follow. After a bare sum it is refused, since
    /// `a + 45 deg` could mean two things.
    fn in_degrees(&mut self, expr: Expr, degrees: Degrees) -> Result<Expr, LiteralError> {
        if degrees == Degrees::Refused {
            return Err(self.unexpected("only an angle may be in degrees"));
        }
        self.at += "deg".len();
        self.skip_space();
        if self.rest().is_empty() {
            Ok(expr.degrees())
        } else {
            Err(self.unexpected("deg stands at the end: write (a + b) deg, or a + b*pi/180"))
        }
    }

    fn unexpected(&self, hint: &str) -> LiteralError {
        let text = quoted(self.text.trim());
        let Some(found) = self.rest().chars().next() else {
            return LiteralError::syntax(self.at, format!("{text} ends too early")).hint(hint);
        };
        let word = self.word();
        let found = if word.is_empty() {
            quoted(&found.to_string())
        } else {
            quoted(word)
        };
        let hint = match self.rest().chars().next() {
            Some(',') => "write a decimal point, not a comma",
            Some('\u{2212}' | '\u{2013}') => "write the minus sign as -",
            Some('^') => "there are no powers: write a*a",
            Some('\u{b0}') => "write degrees as deg",
            _ => hint,
        };
        LiteralError::syntax(self.at, format!("unexpected {found} in {text}")).hint(hint)
    }
}
