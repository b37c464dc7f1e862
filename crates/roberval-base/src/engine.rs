use roberval_linalg::{
    LinalgError, Matrix, RankDecision, Relations, Svd, Tolerance, deleted_from_null_space, qrii,
    relations_qr, staircase_qr, svd,
};

use crate::BaseError;

/// How rank, choice and relations are found. All engines follow the same rule and must
/// agree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Engine {
    /// Elimination modulo primes: rank, choice and beta without a tolerance.
    #[default]
    Exact,
    /// Pairs of doubles: a tolerance far from rounding and from all that is not zero.
    /// [`Engine::Exact`] becomes this where a mechanism has constraints that it cannot
    /// decide.
    Precise,
    /// QR without pivoting (Gautier 1991, eq. (13)), as a staircase: rank and choice in
    /// one pass, beta = R1^-1 R2.
    Qr,
    /// QR with column pivoting (eq. (14)): rank from T, choice from T's columns, beta =
    /// R1^-1 R2.
    Qrii,
    /// SVD (eq. (21) to (27)): rank from the singular values, choice from V2 upward,
    /// beta = -V21 V22^-1.
    Svd,
}

/// What an engine finds: positions are columns of the matrix it was given.
pub(crate) struct Finding {
    pub judgement: Judgement,
    pub kept: Vec<usize>,
    pub relations: Relations,
}

/// The rank of W and what it was decided on.
pub(crate) struct Judgement {
    pub decision: RankDecision,
    /// For each entry of the spectrum the column of W that it belongs to; of a singular
    /// value, which belongs to none, the one that weighs most in its vector.
    pub columns: Vec<usize>,
}

impl Engine {
    /// All engines.
    pub const ALL: [Self; 5] = [Self::Exact, Self::Precise, Self::Qr, Self::Qrii, Self::Svd];

    /// The engines that compute in floats and need a tolerance.
    pub const FLOAT: [Self; 3] = [Self::Qr, Self::Qrii, Self::Svd];

    /// `exact`, `precise`, `qr`, `qrii` or `svd`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Precise => "precise",
            Self::Qr => "qr",
            Self::Qrii => "qrii",
            Self::Svd => "svd",
        }
    }

    /// Rank, choice and relations of W; `pivoted` asks for QRII's own columns.
    pub(crate) fn analyse(
        self,
        w: &Matrix,
        tolerance: &Tolerance,
        pivoted: bool,
    ) -> Result<Finding, BaseError> {
        let (judgement, leftmost, svd) = self.decide(w, tolerance)?;
        let rank = judgement.decision.rank;
        let kept = if pivoted {
            let mut kept = qrii(w)?.permutation[..rank].to_vec();
            kept.sort_unstable();
            kept
        } else {
            leftmost
        };
        let deleted = complement(&kept, w.cols());
        let relations = match svd {
            Some(svd) => svd.relations(rank, &kept, &deleted)?,
            None => relations_qr(w, &kept, &deleted)?,
        };
        Ok(Finding {
            judgement,
            kept,
            relations,
        })
    }

    /// The rank of W alone.
    pub(crate) fn rank(self, w: &Matrix, tolerance: &Tolerance) -> Result<Judgement, BaseError> {
        Ok(match self {
            Self::Exact | Self::Precise | Self::Qr => Judgement {
                decision: staircase_qr(w, tolerance)?.decision,
                columns: (0..w.cols()).collect(),
            },
            Self::Qrii => {
                let factors = qrii(w)?;
                Judgement {
                    decision: factors.decide(tolerance)?,
                    columns: factors.permutation,
                }
            }
            Self::Svd => {
                let factors = svd(w)?;
                Judgement {
                    decision: factors.decide(tolerance)?,
                    columns: main_columns(&factors),
                }
            }
        })
    }

    /// The rank, the leftmost independent columns and, for the SVD, its factors. The exact
    /// and the precise engine need no W; asked for their opinion of one, they lend the
    /// staircase's.
    fn decide(
        self,
        w: &Matrix,
        tolerance: &Tolerance,
    ) -> Result<(Judgement, Vec<usize>, Option<Svd>), BaseError> {
        Ok(match self {
            Self::Exact | Self::Precise | Self::Qr => {
                let staircase = staircase_qr(w, tolerance)?;
                let judgement = Judgement {
                    decision: staircase.decision,
                    columns: (0..w.cols()).collect(),
                };
                (judgement, staircase.kept, None)
            }
            Self::Qrii => {
                let factors = qrii(w)?;
                let mut decision = factors.decide(tolerance)?;
                let kept = or_fewer(&mut decision, |rank| factors.leftmost(rank))?;
                let columns = factors.permutation;
                (Judgement { decision, columns }, kept, None)
            }
            Self::Svd => {
                let factors = svd(w)?;
                let mut decision = factors.decide(tolerance)?;
                let kept = or_fewer(&mut decision, |rank| {
                    let deleted = deleted_from_null_space(&factors.null_space(rank))?;
                    Ok(complement(&deleted, w.cols()))
                })?;
                let columns = main_columns(&factors);
                (Judgement { decision, columns }, kept, Some(factors))
            }
        })
    }
}

/// For each singular value the column that weighs most in its vector.
fn main_columns(svd: &Svd) -> Vec<usize> {
    let largest = |k: usize| {
        let weights = svd.v.col(k).iter().map(|x| x.abs()).enumerate();
        weights.max_by(|(_, a), (_, b)| a.total_cmp(b))
    };
    (0..svd.v.cols())
        .filter_map(|k| largest(k).map(|(column, _)| column))
        .collect()
}

/// The choice of as many columns as the rank says; where so many are not independent, as
/// happens when a tolerance lets rounding noise count, of the most that are. The rest of
/// the rank is then in doubt.
fn or_fewer(
    decision: &mut RankDecision,
    choose: impl Fn(usize) -> Result<Vec<usize>, LinalgError>,
) -> Result<Vec<usize>, BaseError> {
    let asked = decision.rank;
    loop {
        match choose(decision.rank) {
            Ok(kept) => {
                decision.ambiguous.extend(decision.rank..asked);
                return Ok(kept);
            }
            Err(LinalgError::Singular { .. }) if decision.rank > 0 => decision.rank -= 1,
            Err(error) => return Err(error.into()),
        }
    }
}

/// The numbers below `n` that are not in the list.
pub(crate) fn complement(list: &[usize], n: usize) -> Vec<usize> {
    let mut listed = vec![false; n];
    for &i in list {
        listed[i] = true;
    }
    (0..n).filter(|&i| !listed[i]).collect()
}
