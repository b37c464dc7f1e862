# Recipes for work on roberval; `just` lists them.

# List the recipes.
default:
    @just --list

# Build the extension into the active virtual environment, with what the tests need.
develop:
    maturin develop --release --extras test,peers

# Rust's tests.
test-rust *arguments:
    cargo test --workspace {{arguments}}

# The lanes of 64-bit ARM, under emulation: needs that target of Rust, gcc-aarch64-linux-gnu, qemu-user.
test-arm *arguments:
    CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER=aarch64-linux-gnu-gcc \
    CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_RUNNER="qemu-aarch64 -L /usr/aarch64-linux-gnu" \
    cargo test --target aarch64-unknown-linux-gnu -p roberval-scalar -p roberval-regressor \
        -p roberval-reduce -p roberval-linalg {{arguments}}

# Python's tests, against what `just develop` built.
test-python *arguments:
    python -m pytest tests README.md docs --pyargs roberval {{arguments}}

# Format everything.
format:
    cargo fmt --all
    ruff check --fix .
    ruff format .

# The lints.
lint:
    cargo clippy --workspace --all-targets -- -D warnings
    ruff check .
    mypy

# Everything, as CI does.
check:
    ./check
