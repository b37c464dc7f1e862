//! Running the command line in the test's own process.
#![allow(dead_code)]

use std::ffi::OsString;
use std::path::PathBuf;

/// What a command line did.
pub struct Run {
    pub code: i32,
    pub out: String,
    pub err: String,
}

/// Runs `roberval` with these arguments.
pub fn roberval<S: AsRef<str>>(args: &[S]) -> Run {
    let (code, out, err) = roberval_bytes(args);
    Run {
        code,
        out: String::from_utf8(out).expect("stdout is UTF-8"),
        err,
    }
}

/// Runs `roberval`; its standard output may be binary.
pub fn roberval_bytes<S: AsRef<str>>(args: &[S]) -> (i32, Vec<u8>, String) {
    let args = std::iter::once("roberval").chain(args.iter().map(AsRef::as_ref));
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let code = roberval_cli::run(
        args.map(OsString::from),
        &mut out,
        &mut err,
        roberval_cli::Look::default(),
    );
    (code, out, String::from_utf8(err).expect("stderr is UTF-8"))
}

/// A file of the specification, where it is at hand.
pub fn spec(name: &str) -> Option<String> {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..");
    let path = root.join("../shared/spec").join(name);
    let text = std::fs::read_to_string(path).ok();
    if text.is_none() {
        println!("skipped: {name} of the specification is not here");
    }
    text
}

/// A folder of one test, removed at the end.
pub struct Folder(pub PathBuf);

impl Folder {
    pub fn new(test: &str) -> Self {
        let path = std::env::temp_dir().join(format!("roberval-{test}-{}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a temporary folder");
        Self(path)
    }

    /// The path of a file in it.
    pub fn path(&self, name: &str) -> String {
        self.0.join(name).to_string_lossy().into_owned()
    }

    /// Writes a file and gives its path.
    pub fn file(&self, name: &str, content: impl AsRef<[u8]>) -> String {
        std::fs::write(self.0.join(name), content).expect("a temporary file");
        self.path(name)
    }

    /// The names of the files in it.
    pub fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(&self.0).expect("the folder exists");
        let name = |e: std::io::Result<std::fs::DirEntry>| {
            e.expect("an entry")
                .file_name()
                .to_string_lossy()
                .into_owned()
        };
        let mut names: Vec<String> = entries.map(name).collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
