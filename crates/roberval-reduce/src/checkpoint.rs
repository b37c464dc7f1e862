//! The accumulator as bytes: from them it goes on with the same bits.

use std::sync::Arc;

use roberval_regressor::Regressor;
use sha2::{Digest, Sha256};

use crate::factor::Factor;
use crate::plan::Friction;
use crate::stream::Reduction;

/// What a checkpoint begins with, before the form's version.
const MAGIC: &[u8; 7] = b"RBVLQR\0";

/// What checkpoints with a list of files once began with.
const ONCE: &[u8; 7] = b"RBVLIN\0";

/// The form's version.
const VERSION: u8 = b'3';

/// What finished tiles are counted in: tiles have held more samples than they once did.
const UNIT: usize = 64;

/// A checksum's bytes.
const CHECKSUM: usize = 32;

/// Why bytes are no checkpoint of this accumulator.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CheckpointError {
    /// Another file.
    #[error("this is not a checkpoint of roberval")]
    Kind,
    /// A checkpoint of another version.
    #[error(
        "this checkpoint is of another version of roberval: reduce the samples anew, or go on with that version"
    )]
    Version,
    /// The checksum does not fit.
    #[error("the checkpoint is damaged: its checksum does not fit")]
    Damaged,
    /// Another robot.
    #[error("the checkpoint is of another robot")]
    Model,
}

impl Reduction {
    /// A digest of the robot: accumulators of another cannot be merged.
    #[must_use]
    pub fn identity(&self) -> Vec<u8> {
        identity(&self.regressor)
    }

    /// Everything the accumulator knows and a note of the caller's, with a checksum over
    /// all bytes.
    #[must_use]
    pub fn to_bytes(&self, note: &[u8]) -> Vec<u8> {
        let mut out = Writer(MAGIC.to_vec());
        out.bytes(&[VERSION]);
        out.integer(note.len() as u64);
        out.bytes(note);
        out.bytes(&self.identity());
        let Friction {
            viscous,
            coulomb,
            offset,
        } = self.friction;
        out.bytes(&[viscous, coulomb, offset].map(u8::from));
        out.integer(self.choice.len() as u64);
        for &column in &*self.choice {
            out.integer(column as u64);
        }
        out.integer(self.samples);
        out.integer((self.tiles * self.plan.samples() / UNIT) as u64);
        out.numbers(&self.block);
        out.integer(self.levels.len() as u64);
        for level in &self.levels {
            out.numbers(level);
        }
        for rest in &self.rest {
            out.numbers(rest);
        }
        match &self.merged {
            Some(factor) => {
                out.integer(factor.samples());
                out.numbers(factor.packed());
            }
            None => out.integer(0),
        }
        let checksum = Sha256::digest(&out.0);
        out.bytes(&checksum);
        out.0
    }

    /// The accumulator and the note from [`Reduction::to_bytes`], for the same robot.
    ///
    /// # Errors
    /// [`CheckpointError`] if the bytes are damaged or of something else.
    pub fn from_bytes(
        bytes: &[u8],
        regressor: Regressor,
    ) -> Result<(Self, Vec<u8>), CheckpointError> {
        let mut body = unsealed(bytes)?;
        let size = body.integer()?;
        let size = usize::try_from(size).map_err(|_| CheckpointError::Damaged)?;
        let note = body.take(size)?.to_vec();
        if body.take(CHECKSUM)? != identity(&regressor) {
            return Err(CheckpointError::Model);
        }
        let kinds = body.take(3)?;
        let friction = Friction {
            viscous: kinds[0] == 1,
            coulomb: kinds[1] == 1,
            offset: kinds[2] == 1,
        };
        let columns = (0..body.integer()?)
            .map(|_| body.integer().map(|column| column as usize))
            .collect::<Result<Vec<_>, _>>()?;
        let mut new =
            Self::new(regressor, &columns, friction).map_err(|_| CheckpointError::Model)?;
        new.samples = body.integer()?;
        new.tiles = body.integer()? as usize * UNIT / new.plan.samples();
        new.block = Arc::new(body.numbers()?);
        new.levels = (0..body.integer()?)
            .map(|_| body.numbers().map(Arc::new))
            .collect::<Result<_, _>>()?;
        for rest in &mut new.rest {
            *rest = body.numbers()?;
        }
        let merged = body.integer()?;
        if merged > 0 {
            let factor = Factor::from_parts(new.plan.columns, body.numbers()?, merged);
            new.merged = Some(Arc::new(factor.ok_or(CheckpointError::Damaged)?));
        }
        let fits = |r: &Arc<Vec<f64>>| r.is_empty() || r.len() == new.plan.factor();
        let [positions, n] = new.plan.widths;
        let held = new.rest[3].len() / n;
        let of_rest = |(rest, width): (&Vec<f64>, usize)| rest.len() == held * width;
        let widths = [positions, n, n, n];
        let whole = new.rest.iter().zip(widths).all(of_rest)
            && (new.rest[4].is_empty() || new.rest[4].len() == held * n)
            && held < new.plan.samples()
            && new.block.len() == new.plan.factor()
            && new.levels.iter().all(fits);
        if whole && body.0.is_empty() {
            Ok((new, note))
        } else {
            Err(CheckpointError::Damaged)
        }
    }
}

/// What stands between a checkpoint's first bytes and its checksum, which fits.
fn unsealed(bytes: &[u8]) -> Result<Reader<'_>, CheckpointError> {
    let Some(body) = bytes.strip_prefix(MAGIC) else {
        return Err(match bytes.starts_with(ONCE) {
            true => CheckpointError::Version,
            false => CheckpointError::Kind,
        });
    };
    let (version, body) = body.split_first().ok_or(CheckpointError::Damaged)?;
    if *version != VERSION {
        return Err(CheckpointError::Version);
    }
    let size = body
        .len()
        .checked_sub(CHECKSUM)
        .ok_or(CheckpointError::Damaged)?;
    let (signed, checksum) = bytes.split_at(bytes.len() - CHECKSUM);
    if Sha256::digest(signed).as_slice() != checksum {
        return Err(CheckpointError::Damaged);
    }
    Ok(Reader(&body[..size]))
}

/// A digest of the robot: its geometry as the recursion knows it, and its columns.
fn identity(regressor: &Regressor) -> Vec<u8> {
    let mut digest = Sha256::new();
    digest.update(format!("{:?}", regressor.tree()));
    if let Some(expansion) = regressor.expansion() {
        digest.update(expansion.description());
    }
    for label in regressor.parameters().labels() {
        digest.update(label);
        digest.update([0]);
    }
    digest.finalize().to_vec()
}

struct Writer(Vec<u8>);

impl Writer {
    fn bytes(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(bytes);
    }

    fn integer(&mut self, x: u64) {
        self.bytes(&x.to_le_bytes());
    }

    fn numbers(&mut self, numbers: &[f64]) {
        self.integer(numbers.len() as u64);
        self.0.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
    }
}

struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], CheckpointError> {
        let (taken, rest) = self
            .0
            .split_at_checked(count)
            .ok_or(CheckpointError::Damaged)?;
        self.0 = rest;
        Ok(taken)
    }

    fn integer(&mut self) -> Result<u64, CheckpointError> {
        let mut word = [0; 8];
        word.copy_from_slice(self.take(8)?);
        Ok(u64::from_le_bytes(word))
    }

    fn numbers(&mut self) -> Result<Vec<f64>, CheckpointError> {
        let count = usize::try_from(self.integer()?).map_err(|_| CheckpointError::Damaged)?;
        let bytes = self.take(count.checked_mul(8).ok_or(CheckpointError::Damaged)?)?;
        let number = |b: &[u8]| f64::from_le_bytes(b.try_into().unwrap_or_default());
        Ok(bytes.chunks_exact(8).map(number).collect())
    }
}
