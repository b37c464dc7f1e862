use super::{Constants, Expr, LiteralError, LiteralFault, quoted};

impl Expr {
    /// The value in doubles. Each operation rounds once, names take their values from
    /// `constants`.
    ///
    /// # Errors
    /// When a name is unknown or an operation has no finite real result.
    pub fn to_f64(&self, constants: &Constants) -> Result<f64, LiteralError> {
        let value = match self {
            Self::Number(x) => x.to_f64(),
            Self::Name(name) => constant(name, constants)?,
            Self::Pi => std::f64::consts::PI,
            Self::Neg(a) => -a.to_f64(constants)?,
            Self::Add(a, b) => a.to_f64(constants)? + b.to_f64(constants)?,
            Self::Sub(a, b) => a.to_f64(constants)? - b.to_f64(constants)?,
            Self::Mul(a, b) => a.to_f64(constants)? * b.to_f64(constants)?,
            Self::Div(a, b) => quotient(self, a.to_f64(constants)?, b.to_f64(constants)?)?,
            Self::Sqrt(a) => root(a, a.to_f64(constants)?)?,
        };
        if value.is_finite() {
            Ok(value)
        } else {
            Err(overflow(&self.to_string()))
        }
    }
}

fn quotient(whole: &Expr, a: f64, b: f64) -> Result<f64, LiteralError> {
    if b == 0.0 {
        let text = quoted(&whole.to_string());
        return Err(LiteralError::not_finite(format!(
            "division by zero in {text}"
        )));
    }
    Ok(a / b)
}

fn root(argument: &Expr, a: f64) -> Result<f64, LiteralError> {
    if a < 0.0 {
        let text = quoted(&argument.to_string());
        return Err(LiteralError::not_finite(format!(
            "square root of the negative number {text} = {a}"
        )));
    }
    Ok(a.sqrt())
}

fn constant(name: &str, constants: &Constants) -> Result<f64, LiteralError> {
    if let Some((_, quantity)) = constants.iter().find(|(known, _)| known == name) {
        return Ok(quantity.value);
    }
    let message = format!("unknown name {}", quoted(name));
    let error = LiteralError::new(LiteralFault::UnknownName, message);
    if constants.is_empty() {
        return Err(error.hint("no constants are defined here"));
    }
    let known: Vec<&str> = constants.iter().take(20).map(|c| c.0.as_str()).collect();
    let dots = if constants.len() > 20 { ", ..." } else { "" };
    Err(error.hint(format!("known constants: {}{dots}", known.join(", "))))
}

pub(super) fn overflow(text: &str) -> LiteralError {
    let message = format!("the value of {} is too large for a double", quoted(text));
    LiteralError::not_finite(message).hint("at most 1.797e308")
}
