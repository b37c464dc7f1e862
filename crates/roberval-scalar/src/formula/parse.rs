//! The grammar, a literal's with joint variables and functions:
//!
//! ```text
//! sum     = product { ("+" | "-") product }
//! product = signed { ("*" | "/") signed }
//! signed  = { "+" | "-" } atom
//! atom    = number | constant | "pi" | joint | "(" sum ")"
//!         | ("sin" | "cos" | "sqrt") "(" sum ")" | "atan2" "(" sum "," sum ")"
//! joint   = "q." name | "q[" quoted name "]"
//! ```

use super::Formula;
use crate::{
    Constants, LiteralError, LiteralFault, MAX_LITERAL_BYTES, MAX_LITERAL_DEPTH, Quantity,
};

type Parsed = Result<Formula<String>, LiteralError>;

pub(super) fn formula(text: &str, constants: &Constants) -> Parsed {
    let mut parser = Parser {
        text,
        at: 0,
        depth: 0,
        constants,
    };
    if text.len() > MAX_LITERAL_BYTES {
        let message = format!("the expression is longer than {MAX_LITERAL_BYTES} bytes");
        return Err(parser.error(
            LiteralFault::TooLarge,
            message,
            "name its parts as constants",
        ));
    }
    parser.skip_space();
    let formula = parser.sum()?;
    if parser.rest().is_empty() {
        return Ok(formula);
    }
    Err(parser.unexpected("expected + - * / or the end"))
}

struct Parser<'a> {
    text: &'a str,
    at: usize,
    depth: usize,
    constants: &'a Constants,
}

impl<'a> Parser<'a> {
    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    fn skip_space(&mut self) {
        self.at = self.text.len() - self.rest().trim_start().len();
    }

    fn take(&mut self, wanted: char) -> bool {
        let found = self.rest().starts_with(wanted);
        if found {
            self.at += wanted.len_utf8();
            self.skip_space();
        }
        found
    }

    fn expect(&mut self, wanted: char) -> Result<(), LiteralError> {
        if self.take(wanted) {
            return Ok(());
        }
        Err(self.unexpected(&format!("expected {wanted}")))
    }

    /// The length of the longest beginning of these characters.
    fn span(&self, of: impl Fn(char) -> bool) -> usize {
        self.rest().find(|c| !of(c)).unwrap_or(self.rest().len())
    }

    fn error(&self, fault: LiteralFault, message: String, hint: &str) -> LiteralError {
        LiteralError {
            fault,
            message,
            hint: Some(hint.to_owned()),
            offset: Some(self.at),
        }
    }

    fn unexpected(&self, hint: &str) -> LiteralError {
        let word = &self.rest()[..self.span(is_word)];
        let found = match (word, self.rest().chars().next()) {
            (_, None) => "the end".to_owned(),
            ("", Some(c)) => format!("{:?}", c.to_string()),
            (word, _) => format!("{word:?}"),
        };
        let message = format!("unexpected {found} in the expression");
        self.error(LiteralFault::Syntax, message, hint)
    }

    fn nested(&mut self, read: impl FnOnce(&mut Self) -> Parsed) -> Parsed {
        self.depth += 1;
        if self.depth > MAX_LITERAL_DEPTH {
            let hint = format!("at most {MAX_LITERAL_DEPTH} levels");
            let message = "the expression is nested too deeply".to_owned();
            return Err(self.error(LiteralFault::TooLarge, message, &hint));
        }
        let result = read(self);
        self.depth -= 1;
        result
    }

    fn sum(&mut self) -> Parsed {
        let mut left = self.product()?;
        loop {
            if self.take('+') {
                left = Formula::Add(Box::new(left), Box::new(self.product()?));
            } else if self.take('-') {
                left = Formula::Sub(Box::new(left), Box::new(self.product()?));
            } else {
                return Ok(left);
            }
        }
    }

    fn product(&mut self) -> Parsed {
        let mut left = self.signed()?;
        loop {
            if self.rest().starts_with("**") || self.rest().starts_with('^') {
                return Err(self.unexpected("there are no powers: write a*a"));
            } else if self.take('*') {
                left = Formula::Mul(Box::new(left), Box::new(self.signed()?));
            } else if self.take('/') {
                left = Formula::Div(Box::new(left), Box::new(self.signed()?));
            } else {
                return Ok(left);
            }
        }
    }

    fn signed(&mut self) -> Parsed {
        self.nested(|parser| {
            if parser.take('+') {
                parser.signed()
            } else if parser.take('-') {
                Ok(Formula::Neg(Box::new(parser.signed()?)))
            } else {
                parser.atom()
            }
        })
    }

    fn atom(&mut self) -> Parsed {
        if self.take('(') {
            let inner = self.nested(Self::sum)?;
            self.expect(')')?;
            return Ok(inner);
        }
        if self
            .rest()
            .starts_with(|c: char| c.is_ascii_digit() || c == '.')
        {
            return self.number();
        }
        let (start, length) = (self.at, self.span(is_word));
        let word = &self.rest()[..length];
        self.at += length;
        match word {
            "q" => self.joint(),
            "sin" => Ok(Formula::Sin(self.argument()?)),
            "cos" => Ok(Formula::Cos(self.argument()?)),
            "sqrt" => Ok(Formula::Sqrt(self.argument()?)),
            "atan2" => self.atan2(),
            "" => Err(self.unexpected("expected a number, a joint q.NAME, a function or (")),
            _ => self.constant(start, word),
        }
    }

    /// Digits, a point and an exponent.
    fn number(&mut self) -> Parsed {
        let digits = self.span(|c| c.is_ascii_digit() || c == '.');
        let rest = &self.rest()[digits..];
        let mut length = digits;
        if let Some(power) = rest.strip_prefix(['e', 'E']) {
            let sign = usize::from(power.starts_with(['+', '-']));
            let power = &power[sign..];
            let count = power
                .find(|c: char| !c.is_ascii_digit())
                .unwrap_or(power.len());
            length += if count > 0 { 1 + sign + count } else { 0 };
        }
        let (start, text) = (self.at, &self.rest()[..length]);
        let number = Quantity::parse_decimal(text).map_err(|e| placed(e, start))?;
        self.at += length;
        if self.span(is_word) > 0 {
            return Err(self.unexpected("write a product with *; angles are in rad"));
        }
        self.skip_space();
        Ok(Formula::Constant(number))
    }

    fn constant(&mut self, start: usize, word: &str) -> Parsed {
        self.skip_space();
        if self.rest().starts_with('(') {
            self.at = start;
            let message = format!("unknown function {word:?}");
            let hint = "the functions are sin, cos, atan2 and sqrt";
            return Err(self.error(LiteralFault::Syntax, message, hint));
        }
        let value = Quantity::parse_number(word, self.constants);
        Ok(Formula::Constant(value.map_err(|e| placed(e, start))?))
    }

    fn argument(&mut self) -> Result<Box<Formula<String>>, LiteralError> {
        self.skip_space();
        self.expect('(')?;
        let inner = self.nested(Self::sum)?;
        self.expect(')')?;
        Ok(Box::new(inner))
    }

    fn atan2(&mut self) -> Parsed {
        self.skip_space();
        self.expect('(')?;
        let y = self.nested(Self::sum)?;
        self.expect(',')?;
        let x = self.nested(Self::sum)?;
        self.expect(')')?;
        Ok(Formula::Atan2(Box::new(y), Box::new(x)))
    }

    /// What follows `q`.
    fn joint(&mut self) -> Parsed {
        let hint = "write a joint as q.NAME or q[\"NAME\"]";
        let name = if self.rest().starts_with('.') {
            self.at += 1;
            let length = self.span(is_word);
            let name = &self.rest()[..length];
            self.at += length;
            name
        } else {
            let quoted = self.rest().strip_prefix("[\"").map(|r| (r, "\"]"));
            let quoted = quoted.or_else(|| self.rest().strip_prefix("['").map(|r| (r, "']")));
            let Some((rest, end)) = quoted else {
                return Err(self.unexpected(hint));
            };
            let Some(length) = rest.find(end) else {
                return Err(self.unexpected(hint));
            };
            self.at += length + 4;
            &rest[..length]
        };
        if name.is_empty() {
            return Err(self.unexpected(hint));
        }
        self.skip_space();
        Ok(Formula::Joint(name.to_owned()))
    }
}

fn is_word(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

fn placed(error: LiteralError, start: usize) -> LiteralError {
    LiteralError {
        offset: Some(start + error.offset.unwrap_or(0)),
        ..error
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_functions_and_constants_are_read() {
        let constants = [(
            "L".to_owned(),
            Quantity::parse_number("0.5", &[]).expect("a number"),
        )];
        let text = "2*L - atan2(sin(q.2), -1.5e-1 + cos(q[\"left arm\"]))/pi";
        let read = formula(text, &constants).expect("an expression");
        assert_eq!(read.joints(), ["2", "left arm"]);
        assert!(matches!(read, Formula::Sub(..)));
    }

    #[test]
    fn faults_are_told_with_their_place() {
        for (text, place, word) in [
            ("", 0, "the end"),
            ("q.2 +", 5, "the end"),
            ("tan(q.2)", 0, "tan"),
            ("q 2", 1, "\" \""),
            ("q.", 2, "the end"),
            ("q[2]", 1, "\"[\""),
            ("atan2(q.1)", 9, "\")\""),
            ("q.1 ** 2", 4, "\"*\""),
            ("1.2.3", 0, "1.2.3"),
            ("2 K", 2, "\"K\""),
            ("K", 0, "unknown name"),
            ("90 deg", 3, "deg"),
        ] {
            let error = formula(text, &[]).expect_err(text);
            assert!(error.message.contains(word), "{text}: {error}");
            assert!(error.offset.unwrap_or(0) >= place, "{text}: {error:?}");
        }
        assert!(formula(&"(".repeat(5000), &[]).is_err());
        assert!(formula(&"-(".repeat(400), &[]).is_err());
    }
}
