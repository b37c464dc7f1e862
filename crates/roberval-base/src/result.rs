use roberval_linalg::{Matrix, relations_qr};
use roberval_mechanism::{Mechanism, ParameterSpace};
use roberval_regressor::{Model, Regressor, States};

use crate::certificate::{CertificateError, CertificateNotes, certificate, certificate_text};
use crate::{BaseError, Choice, Diagnosis, Engine, ExactDecision, ExactNumber, Options};

/// The base inertial parameters of a robot and how the others regroup onto them.
///
/// Columns are numbered as in [`BaseParameters::parameters`].
#[derive(Debug, Clone)]
pub struct BaseParameters {
    /// The robot analysed.
    pub mechanism: Mechanism,
    /// The linear model used.
    pub model: Model,
    /// The engine used.
    pub engine: Engine,
    /// The rule of choice used.
    pub choice: Choice,
    /// The seed of the samples.
    pub seed: u64,
    /// The rows r of W.
    pub rows: usize,
    /// The standard parameters, C columns.
    pub parameters: ParameterSpace,
    /// Parameters without effect, ascending.
    pub no_effect: Vec<usize>,
    /// The b kept parameters X1, ascending.
    pub base: Vec<usize>,
    /// The c - b regrouped parameters X2, ascending.
    pub regrouped: Vec<usize>,
    /// Base parameters that stay as they are (zero rows of beta).
    pub unchanged: Vec<usize>,
    /// Base parameters that others regroup into.
    pub regrouped_into: Vec<usize>,
    /// beta, b x (c - b): W2 = W1 beta and XB1 = X1 + beta X2 (Gautier 1991, eq. (17), (20)).
    pub beta: Matrix,
    /// beta's entries exactly, by the exact engine.
    pub beta_exact: Option<Vec<Vec<ExactNumber>>>,
    /// The exact engine's decision, in the order in which it was made.
    pub decision: Option<ExactDecision>,
    /// How sure the answer is.
    pub diagnosis: Diagnosis,
}

/// How the columns divide.
pub(crate) struct Classes {
    pub no_effect: Vec<usize>,
    pub base: Vec<usize>,
    pub regrouped: Vec<usize>,
    pub unchanged: Vec<usize>,
    pub regrouped_into: Vec<usize>,
}

/// One base parameter as a sum: XB_i = X_i + sum of beta_ij X_j.
#[derive(Debug, Clone, PartialEq)]
pub struct Relation {
    /// The kept parameter's column.
    pub base: usize,
    /// The regrouped parameters' columns and coefficients, nonzero ones only.
    pub terms: Vec<(usize, f64)>,
}

/// The counts of an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tally {
    /// Standard parameters C.
    pub standard: usize,
    /// Parameters without effect.
    pub no_effect: usize,
    /// Base parameters b.
    pub base: usize,
    /// Parameters regrouped, c - b.
    pub regrouped: usize,
    /// Base parameters that stay as they are.
    pub unchanged: usize,
    /// Base parameters that others regroup into.
    pub regrouped_into: usize,
}

impl BaseParameters {
    pub(crate) fn new(
        mechanism: &Mechanism,
        options: &Options,
        rows: usize,
        classes: Classes,
        beta: Matrix,
        exact: Option<(ExactDecision, Vec<Vec<ExactNumber>>)>,
        diagnosis: Diagnosis,
    ) -> Self {
        let (decision, beta_exact) = exact.unzip();
        Self {
            mechanism: mechanism.clone(),
            model: options.model,
            engine: options.engine,
            choice: options.choice.clone(),
            seed: options.seed,
            rows,
            parameters: mechanism.parameters(),
            no_effect: classes.no_effect,
            base: classes.base,
            regrouped: classes.regrouped,
            unchanged: classes.unchanged,
            regrouped_into: classes.regrouped_into,
            beta,
            beta_exact,
            decision,
            diagnosis,
        }
    }

    /// Numbers of the robot's file that look like roundings (1.57, 3.14) and were left as
    /// written, in sentences; by the exact and the precise engine with what they would change.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let told = self.diagnosis.warnings();
        let near = self.mechanism.cleaning.iter();
        match told.as_slice() {
            [] => near
                .flat_map(|cleaning| &cleaning.cleaned.near_misses)
                .map(ToString::to_string)
                .collect(),
            _ => told,
        }
    }

    /// The certificate of this answer, as the text of a file: what was decided and how, for
    /// a checker that shares nothing with this program. Only the exact engine can give one.
    ///
    /// # Errors
    /// [`CertificateError`] if there is no exact decision, a number is too long to be
    /// written, or a coefficient is not known well enough.
    pub fn certificate(&self) -> Result<String, CertificateError> {
        let decision = self.decision.as_ref().ok_or(CertificateError::NotExact)?;
        let cleaning = self.mechanism.cleaning.iter();
        let changes: Vec<String> = cleaning
            .flat_map(|c| c.cleaned.changes.iter().map(ToString::to_string))
            .collect();
        let notes = CertificateNotes {
            changes: &changes,
            witnesses: &self.diagnosis.witnesses,
        };
        let content = certificate(&self.mechanism, self.model, decision, notes)?;
        Ok(certificate_text(&content))
    }

    /// The number of base parameters b.
    #[must_use]
    pub fn rank(&self) -> usize {
        self.base.len()
    }

    /// The counts.
    #[must_use]
    pub fn tally(&self) -> Tally {
        Tally {
            standard: self.parameters.len(),
            no_effect: self.no_effect.len(),
            base: self.base.len(),
            regrouped: self.regrouped.len(),
            unchanged: self.unchanged.len(),
            regrouped_into: self.regrouped_into.len(),
        }
    }

    /// The labels of some columns.
    #[must_use]
    pub fn labels(&self, columns: &[usize]) -> Vec<&str> {
        let labels = self.parameters.labels();
        columns.iter().map(|&c| labels[c].as_str()).collect()
    }

    /// All b relations, the trivial ones included, in the order of `base`.
    #[must_use]
    pub fn relations(&self) -> Vec<Relation> {
        (0..self.base.len())
            .map(|i| Relation {
                base: self.base[i],
                terms: (0..self.regrouped.len())
                    .map(|j| (self.regrouped[j], self.beta[(i, j)]))
                    .filter(|(_, coefficient)| *coefficient != 0.0)
                    .collect(),
            })
            .collect()
    }

    /// XB1 = X1 + beta X2 from C standard parameters (Gautier 1991, eq. (20)).
    ///
    /// # Errors
    /// [`BaseError::Length`] if `x` does not have C values.
    pub fn values(&self, x: &[f64]) -> Result<Vec<f64>, BaseError> {
        self.regrouped_values(x, &vec![0.0; self.regrouped.len()])
    }

    /// XR1 = X1 + beta (X2 - XR2): the member of the family of equivalent solutions with
    /// regrouped parameters XR2 (Gautier 1991, eq. (19)).
    ///
    /// # Errors
    /// [`BaseError::Length`] if `x` does not have C values or `xr2` not c - b.
    pub fn regrouped_values(&self, x: &[f64], xr2: &[f64]) -> Result<Vec<f64>, BaseError> {
        self.check_x(x)?;
        check_length(
            "XR2",
            "one value a regrouped parameter",
            self.regrouped.len(),
            xr2,
        )?;
        let change: Vec<f64> = self
            .regrouped
            .iter()
            .zip(xr2)
            .map(|(&c, r)| x[c] - r)
            .collect();
        let row = |i: usize| {
            (0..change.len())
                .map(|j| self.beta[(i, j)] * change[j])
                .sum::<f64>()
        };
        Ok((0..self.base.len())
            .map(|i| x[self.base[i]] + row(i))
            .collect())
    }

    /// The solution of minimum norm XM = V1 V1' X, C values, zero for parameters without
    /// effect. It keeps all c components: it simplifies nothing.
    ///
    /// Found as X - V2 V2' X from the null space [-beta; I].
    ///
    /// # Errors
    /// [`BaseError::Length`] if `x` does not have C values; [`BaseError::Linalg`] if the
    /// orthogonalisation of the null space fails.
    pub fn minimum_norm(&self, x: &[f64]) -> Result<Vec<f64>, BaseError> {
        self.check_x(x)?;
        let (b, k) = (self.base.len(), self.regrouped.len());
        let columns: Vec<usize> = self.base.iter().chain(&self.regrouped).copied().collect();
        let x: Vec<f64> = columns.iter().map(|&c| x[c]).collect();
        // [V2 x] with V2 = [-beta; I]: the least squares solution is what V2 explains of x.
        let v2_x = Matrix::from_fn(b + k, k + 1, |i, j| match i.checked_sub(b) {
            _ if j == k => x[i],
            None => -self.beta[(i, j)],
            Some(i) => f64::from(u8::from(i == j)),
        });
        let v2: Vec<usize> = (0..k).collect();
        let explained = relations_qr(&v2_x, &v2, &[k])?.beta;
        let part = v2_x.select_columns(&v2).matmul(&explained)?;
        let mut xm = vec![0.0; self.parameters.len()];
        for ((&column, x), part) in columns.iter().zip(&x).zip(part.col(0)) {
            xm[column] = x - part;
        }
        Ok(xm)
    }

    /// The rows of the reduced model d1 (or d0, h1) at N states: N x rows x b numbers
    /// into `out`; Gamma = d1 XB1.
    ///
    /// # Errors
    /// [`BaseError::Regressor`] if an array has the wrong length or is not finite.
    pub fn fill_rows(
        &self,
        model: Model,
        states: States<'_>,
        out: &mut [f64],
    ) -> Result<(), BaseError> {
        Ok(Regressor::new(&self.mechanism).fill_columns(model, &self.base, states, out)?)
    }

    fn check_x(&self, x: &[f64]) -> Result<(), BaseError> {
        check_length(
            "X",
            "one value a standard parameter",
            self.parameters.len(),
            x,
        )
    }
}

fn check_length(
    array: &'static str,
    meaning: &str,
    expected: usize,
    found: &[f64],
) -> Result<(), BaseError> {
    if found.len() == expected {
        return Ok(());
    }
    Err(BaseError::Length {
        array,
        meaning: meaning.to_owned(),
        expected,
        found: found.len(),
    })
}
