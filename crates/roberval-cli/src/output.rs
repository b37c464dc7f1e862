//! Where a result goes: the standard output, or a file that is replaced as a whole.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process;

use crate::error::CliError;

/// Names that other drafts may have taken are tried this often.
const MOST_DRAFTS: u32 = 1000;

/// Where a result goes.
#[derive(Debug)]
pub(crate) enum Target {
    /// The standard output: no `-o`, or `-o -`.
    Stdout,
    /// A file, new or to be replaced. Like a compiler, `-o` replaces a file that exists;
    /// a failure leaves the old one as it was.
    File(PathBuf),
    /// A device or pipe that exists: written to directly.
    Device(PathBuf),
}

impl Target {
    /// The target of an `-o` option. Looks at it now, so that a long computation is not
    /// in vain.
    pub fn new(path: Option<&Path>) -> Result<Self, CliError> {
        let Some(path) = path.filter(|path| *path != Path::new("-")) else {
            return Ok(Self::Stdout);
        };
        let refuse = |what: &str| {
            Err(CliError::Output {
                path: path.to_owned(),
                what: what.to_owned(),
            })
        };
        // A link is followed, so that it stays a link.
        let path = &fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        match fs::metadata(path) {
            Ok(meta) if meta.is_dir() => refuse("this is a folder; -o needs a file"),
            Ok(meta) if !meta.is_file() => Ok(Self::Device(path.to_owned())),
            Ok(meta) if meta.permissions().readonly() => refuse("the file is read-only"),
            _ if !folder(path).is_dir() => refuse("its folder does not exist"),
            _ => Ok(Self::File(path.to_owned())),
        }
    }

    /// Writes the result by `fill`, to a file as a whole or not at all.
    pub fn write(
        &self,
        out: &mut dyn Write,
        fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), CliError> {
        match self {
            Self::Stdout => fill(out)
                .and_then(|()| out.flush())
                .map_err(CliError::Stdout),
            Self::File(path) => Draft::write(path, fill).map_err(|e| fault(path, &e)),
            Self::Device(path) => OpenOptions::new()
                .write(true)
                .open(path)
                .and_then(|mut device| fill(&mut device))
                .map_err(|e| fault(path, &e)),
        }
    }
}

fn fault(path: &Path, error: &io::Error) -> CliError {
    CliError::Output {
        path: path.to_owned(),
        what: format!("cannot be written: {error}"),
    }
}

fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

/// A file in the target's folder that becomes the target, or goes away.
struct Draft {
    path: PathBuf,
    renamed: bool,
}

impl Draft {
    fn write(target: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
        let (mut draft, file) = Self::create(folder(target))?;
        let mut writer = BufWriter::new(file);
        fill(&mut writer)?;
        writer.flush()?;
        let file = writer
            .into_inner()
            .map_err(io::IntoInnerError::into_error)?;
        if let Ok(old) = fs::metadata(target) {
            file.set_permissions(old.permissions())?;
        }
        file.sync_all()?;
        drop(file);
        fs::rename(&draft.path, target)?;
        draft.renamed = true;
        Ok(())
    }

    fn create(folder: &Path) -> io::Result<(Self, File)> {
        let mut last = io::Error::from(io::ErrorKind::AlreadyExists);
        for n in 0..MOST_DRAFTS {
            let path = folder.join(format!(".roberval-{}-{n}.tmp", process::id()));
            match OpenOptions::new().write(true).create_new(true).open(&path) {
                Ok(file) => {
                    let renamed = false;
                    return Ok((Self { path, renamed }, file));
                }
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => last = error,
                Err(error) => return Err(error),
            }
        }
        Err(last)
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
        if !self.renamed {
            let _ = fs::remove_file(&self.path);
        }
    }
}
