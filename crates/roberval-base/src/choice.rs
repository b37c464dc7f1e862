use roberval_mechanism::ParameterSpace;

use crate::BaseError;

/// Which parameters to keep: the number b is the robot's, the choice is the user's.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Choice {
    /// The paper's: the parameters of largest subscript are regrouped, so that those of
    /// link j go onto links nearer the base.
    #[default]
    Paper,
    /// The best conditioned columns, in the order of QR with column pivoting.
    Pivoted,
    /// The paper's rule after moving some parameters to the front and others to the
    /// back: as many of `keep` as are independent stay, as many of `drop` as can go, go.
    Prefer {
        /// Labels to keep, the most important first.
        keep: Vec<String>,
        /// Labels to drop, the least wanted first.
        drop: Vec<String>,
    },
}

impl Choice {
    /// `paper`, `pivoted` or `prefer`.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Pivoted => "pivoted",
            Self::Prefer { .. } => "prefer",
        }
    }

    /// `columns` in the order in which independent ones are kept.
    pub(crate) fn order(
        &self,
        space: &ParameterSpace,
        columns: &[usize],
    ) -> Result<Vec<usize>, BaseError> {
        let Self::Prefer { keep, drop } = self else {
            return Ok(columns.to_vec());
        };
        if let Some(label) = keep.iter().find(|label| drop.contains(label)) {
            return Err(BaseError::KeptAndDropped {
                label: label.clone(),
            });
        }
        let front = find(space, keep)?;
        let mut back = find(space, drop)?;
        back.reverse();
        let middle = columns
            .iter()
            .filter(|c| !front.contains(c) && !back.contains(c));
        let wanted = |c: &&usize| columns.contains(c);
        Ok(front
            .iter()
            .filter(wanted)
            .chain(middle)
            .chain(back.iter().filter(wanted))
            .copied()
            .collect())
    }
}

fn find(space: &ParameterSpace, labels: &[String]) -> Result<Vec<usize>, BaseError> {
    let mut columns = Vec::with_capacity(labels.len());
    for label in labels {
        let column = space
            .column(label)
            .ok_or_else(|| BaseError::UnknownParameter {
                label: label.clone(),
                nearest: nearest(space, label),
            })?;
        if !columns.contains(&column) {
            columns.push(column);
        }
    }
    Ok(columns)
}

/// Labels that differ by case or by separator, or share the kind.
fn nearest(space: &ParameterSpace, label: &str) -> Vec<String> {
    let plain = |s: &str| s.to_lowercase().replace(['_', ' ', '-'], "");
    let same: Vec<String> = space
        .labels()
        .iter()
        .filter(|l| plain(l) == plain(label))
        .cloned()
        .collect();
    if !same.is_empty() {
        return same;
    }
    let kind = label.split('_').next().unwrap_or_default();
    space
        .labels()
        .iter()
        .filter(|l| {
            l.split('_')
                .next()
                .is_some_and(|k| k.eq_ignore_ascii_case(kind))
        })
        .take(3)
        .cloned()
        .collect()
}
