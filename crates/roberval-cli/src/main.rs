//! The `roberval` command: see the library beside it.

fn main() {
    let (mut out, mut err) = (std::io::stdout().lock(), std::io::stderr());
    let code = roberval_cli::run(
        std::env::args_os(),
        &mut out,
        &mut err,
        roberval_cli::Look::of_terminal(),
    );
    std::process::exit(code);
}
